"""Writes a chart as ``Graph``, the program of an S7-GRAPH block. The reader is `graph_reader`."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Sequence as Sequence_
from dataclasses import dataclass

from lxml import etree

from plcopen_sfc.formats.simaticml.actions_reader import row_fields
from plcopen_sfc.formats.simaticml.actions_writer import write_row
from plcopen_sfc.formats.simaticml.adapting import network_text, say_constants, user_constants
from plcopen_sfc.formats.simaticml.added import keep_added
from plcopen_sfc.formats.simaticml.box_types import give_types
from plcopen_sfc.formats.simaticml.conditions import (
    condition_body,
    drawn_condition,
    untranslated_body,
    untranslated_name,
)
from plcopen_sfc.formats.simaticml.graph_reader import CONNECTIONS, RESULT_OF, USUAL_CATEGORIES, carried_order
from plcopen_sfc.formats.simaticml.networks import is_sayable, write_flgnet_body
from plcopen_sfc.formats.simaticml.reading import ASSOCIATION, children, local
from plcopen_sfc.formats.simaticml.rewritten import INSTEAD, WRITTEN, of_condition, of_rows
from plcopen_sfc.formats.simaticml.rows import RowPlanner, Rows
from plcopen_sfc.formats.simaticml.topology import Link, Ref, write_link
from plcopen_sfc.formats.simaticml.topology_reader import usual_order
from plcopen_sfc.formats.simaticml.topology_rules import (
    Added,
    Legaliser,
    problems,
    with_rivals_behind_joins,
    without_joined_jumps,
)
from plcopen_sfc.formats.simaticml.topology_writer import TopologyWriter
from plcopen_sfc.formats.simaticml.writing import (
    WriteContext,
    add_element,
    finish,
    flag,
    keep_fields,
    sub,
    verbatim,
    write_languages,
)
from plcopen_sfc.formats.xml.extension_data import Markup, fields_left, markup_of
from plcopen_sfc.languages.networks import chart_statements, condition_reader
from plcopen_sfc.model.actions import ActionAssociation, ActionEvent
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.body import Body, FbdBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.conditions import BodyCondition, Condition, Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.drawing import Symbol
from plcopen_sfc.model.network import Coil, InputPin, LeftPowerRail, LogicNetwork
from plcopen_sfc.model.network import Connection as Wire
from plcopen_sfc.model.sfc import (
    AlarmCategory,
    PermanentOperation,
    Sequence,
    SfcFlag,
    SfcNetwork,
    Step,
    Supervised,
    Transition,
)
from plcopen_sfc.report import Outcome

_ALL_CATEGORIES = 4
"""The schema version from which on all categories are written."""


def write_graph(ctx: WriteContext, root: etree._Element, chart: SfcNetwork) -> None:
    """Fill the ``Graph`` element `root`. The chart must be drawn."""
    _ChartWriter(ctx, chart).write(root)


@dataclass
class _Connections:
    """What connects the steps and transitions of a sequence."""

    links: list[Link]
    branches: list[tuple[Symbol, dict[str, str]]]
    added: Added

    def write(self, ctx: WriteContext, parent: etree._Element) -> None:
        """Write ``Branches`` and ``Connections``."""
        holder = sub(parent, "Branches")
        for symbol, attributes in self.branches:
            finish(ctx, sub(holder, "Branch", attributes), symbol, frozenset(_SYMBOL))
        holder = sub(parent, CONNECTIONS)
        for link in self.links:
            write_link(holder, link)


class _ChartWriter:
    def __init__(self, ctx: WriteContext, chart: SfcNetwork) -> None:
        self.ctx = ctx
        self.chart = chart
        self.schema = ctx.schemas.get("Graph", ctx.version.graph)
        self.step_numbers = _numbers((step.id, step.number) for step in chart.steps)
        self.last_step = max(self.step_numbers.values(), default=0)
        self.names = {
            name.casefold() for name in (*(s.name for s in chart.steps), *(t.name for t in chart.transitions))
        }
        self.names |= {name.removeprefix("#") for name in ctx.types}
        self.blocks = {
            block.name.casefold(): f'"{block.type_name}"' for block in ctx.project.data_blocks if block.type_name
        }
        self.transition_numbers = _numbers((t.id, t.number) for t in chart.transitions)
        self._labels = chart.labels()
        self.last_transition = max(self.transition_numbers.values(), default=0)
        self.of_tia = markup_of(ctx.project) is Markup.SIMATICML
        pou = next((pou for pou in ctx.project.pous if pou.name == ctx.body_name), None)
        self.rows = RowPlanner(ctx.project, pou, of_tia=self.of_tia)
        transitions = pou.transitions if pou is not None else []
        self.declared = {variable.name.casefold() for variable in pou.variables()} if pou is not None else set()
        self.condition_of = condition_reader(chart, Dialect.SCL, transitions=transitions)
        self.steps = {step.id: step for step in chart.steps}
        self.constants = user_constants(ctx.project) if not self.of_tia else []

    def write(self, root: etree._Element) -> None:
        """Write the whole block."""
        chart = self.chart
        self._operations(root, "PreOperations", chart.permanent_pre)
        for sequence, transitions in self._sequences():
            self._sequence(root, sequence, transitions)
        self._operations(root, "PostOperations", chart.permanent_post)
        self._alarms(root)
        own = ("PreOperations", "PostOperations", "AlarmsSettings")
        for content in _unknown(chart.carried):
            if not _is_shell(content, *own):
                add_element(self.ctx, root, content)
        for name in ("Graph", "PreOperations", "PostOperations", "AlarmsSettings", "AlarmSupervisionCategories"):
            _set_attributes(root, name, chart.carried)
        native = {"steps", "transitions", "sequences", "permanent_pre", "permanent_post", "drawing", "graph_settings"}
        self._note_surroundings()
        finish(self.ctx, root, chart, frozenset(native))

    def _note_surroundings(self) -> None:
        """Report what the source executes around the steps, and TIA Portal does not."""
        chart = self.chart
        if not chart.steps and not self.of_tia:
            self.ctx.note(Outcome.NOT_EXECUTED, "chart", why="it has no steps: TIA Portal imports no such block")
        if chart.logic and chart_statements(chart, Dialect.SCL).tree.statements:
            self.ctx.note(Outcome.NOT_EXECUTED, "logic", why="what is drawn beside the steps acts, and is not written")
        for flag_, use in (chart.settings.flags if chart.settings is not None else {}).items():
            if use.use:
                why = f"S7-GRAPH has no {flag_.variable}: the chart neither obeys it nor sets it"
                self.ctx.note(Outcome.NOT_EXECUTED, "flag", flag_.variable, why)

    def _operations(self, parent: etree._Element, name: str, operations: list[PermanentOperation]) -> None:
        element = sub(parent, name)
        self._fill_shell(element, self.chart.carried, name)
        for operation in operations:
            child = sub(element, "PermanentOperation")
            write_languages(self.ctx, child, "Title", operation.title)
            for content in _unknown(operation.carried):
                add_element(self.ctx, child, content)
            write_flgnet_body(self.ctx, child, operation.body or LdBody())
            _set_attributes(child, "PermanentOperation", operation.carried)
            self.ctx.keep("permanent operation")
            finish(self.ctx, child, operation, frozenset({"title", "body"}))

    def _fill_shell(self, element: etree._Element, carried: Carried | None, name: str) -> None:
        """Add what was not understood of an element."""
        for content in _unknown(carried):
            if _is_shell(content, name):
                holder = etree.Element("holder")
                add_element(self.ctx, holder, content)
                element.extend(list(holder[0]))

    def _sequences(self) -> list[tuple[Sequence, list[Transition]]]:
        """The sequences with their transitions; what belongs to none stands in the last one."""
        sequences = list(self.chart.sequences) or [Sequence(steps=[step.id for step in self.chart.steps])]
        member = {number: index for index, sequence in enumerate(sequences) for number in sequence.steps}
        lost = [step.id for step in self.chart.steps if step.id not in member]
        if lost:
            sequences[-1] = sequences[-1].model_copy(update={"steps": [*sequences[-1].steps, *lost]})
            member.update(dict.fromkeys(lost, len(sequences) - 1))
        found: list[list[Transition]] = [[] for _ in sequences]
        for transition in self.chart.transitions:
            index = next((member[s] for s in (*transition.sources, *transition.targets) if s in member), -1)
            found[index].append(transition)
        return list(zip(sequences, found, strict=True))

    def _sequence(self, parent: etree._Element, sequence: Sequence, transitions: list[Transition]) -> None:
        ctx = self.ctx
        element = sub(parent, "Sequence")
        write_languages(ctx, element, "Title", sequence.title)
        write_languages(ctx, element, "Comment", sequence.comment)
        steps = {step.id: step for step in self.chart.steps}
        kept = _unknown(sequence.carried)
        is_kept = any(_is_shell(content, CONNECTIONS) for content in kept)
        connections = None if is_kept else self._connections(sequence, {t.id for t in transitions})
        added = connections.added if connections is not None else Added()
        holder = sub(element, "Steps")
        for number in sequence.steps:
            if number in steps:
                self._step(holder, steps[number])
        for number in added.steps:
            self._added_step(holder, number)
        self._fill_shell(holder, sequence.carried, "Steps")
        holder = sub(element, "Transitions")
        for transition in transitions:
            self._transition(holder, transition)
        for number in added.transitions:
            self._added_transition(holder, number, never=number in added.never)
        self._fill_shell(holder, sequence.carried, "Transitions")
        kept = [content for content in kept if not _is_shell(content, "Steps", "Transitions")]
        if connections is not None:
            connections.write(ctx, element)
            for content in kept:
                if _is_shell(content, "Branch"):
                    branches = next(child for child in element if str(child.tag).endswith("Branches"))
                    add_element(ctx, branches, content)
                else:
                    add_element(ctx, element, content)
        else:
            for content in reversed(kept):
                add_element(ctx, element, content)
        for name in ("Sequence", "Steps", "Transitions", "Branches", CONNECTIONS):
            _set_attributes(element, name, sequence.carried)
        finish(ctx, element, sequence, frozenset({"title", "comment", "steps"}))

    def _connections(self, sequence: Sequence, transitions: set[int]) -> _Connections | None:
        if self.chart.drawing is None:
            return None
        writer = TopologyWriter(self.chart, self.chart.drawing, self.step_numbers, self.transition_numbers)
        members = {("S", self.step_numbers[i]) for i in sequence.steps if i in self.step_numbers}
        members |= {("T", self.transition_numbers[i]) for i in transitions}
        links = [link for link in writer.links() if self._belongs(link.source, members, writer)]
        own = [Ref("S", self.step_numbers[number]) for number in sequence.steps if number in self.step_numbers]
        own += [Ref("T", number) for key, number in self.transition_numbers.items() if key in transitions]
        own += [Ref("B", int(attributes["Number"])) for _, attributes in writer.branches()]
        drawn = _branches_of(links)
        types = writer.types()
        links = usual_order(with_rivals_behind_joins(without_joined_jumps(links, types), types), own)
        order = carried_order(_attributes(sequence.carried).get(CONNECTIONS, ""))
        links.sort(key=lambda link: order.get(str(link), len(order)))
        used = _branches_of(links)
        alone = len(self.chart.sequences) < _TWO
        dissolved = drawn - used
        branches = [
            (symbol, marks)
            for symbol, marks in writer.branches()
            if int(marks["Number"]) in used or (alone and int(marks["Number"]) not in dissolved)
        ]
        left = {link.source for link in links}
        dead_ends = [ref.number for ref in own if ref.kind == "S" and ref not in left]
        legaliser = Legaliser(types, self.last_step, self.last_transition)
        links = legaliser.links(links, dead_ends)
        added = legaliser.added
        self.last_step = max(self.last_step, *added.steps, 0)
        self.last_transition = max(self.last_transition, *added.transitions, 0)
        self._report(problems(links, types), dead_ends)
        return _Connections(links, branches, added)

    def _report(self, refused: list[str], dead_ends: list[int]) -> None:
        for problem in dict.fromkeys(refused):
            self.ctx.note(Outcome.APPROXIMATED, "branch", why=f"{problem}; TIA Portal may refuse it")
        for step in self.chart.steps:
            if self.step_numbers[step.id] in dead_ends:
                why = "S7-GRAPH wants a transition behind every step: one that is never TRUE"
                self.ctx.note(Outcome.TRANSLATED, "end of the sequence", f"step {step.name}", why)

    def _free_name(self, stem: str, number: int) -> str:
        """A name that no step, transition or variable of the block has."""
        name = f"{stem}{number}"
        while name.casefold() in self.names:
            name += "_"
        self.names.add(name.casefold())
        return name

    def _added_step(self, parent: etree._Element, number: int) -> None:
        name = self._free_name("Wait", number)
        why = "S7-GRAPH wants it and a transition between two branches: what comes next is active one cycle later"
        self.ctx.note(Outcome.APPROXIMATED, "step", f"step {name}", why)
        element = sub(parent, "Step", {"Number": str(number), "Init": "false", "Name": name})
        sub(sub(element, "Actions"), "Action")
        step = Step(id=0, name=name)
        self._supervised(element, step, "Supervision", None)
        self._supervised(element, step, "Interlock", None)
        keep_added(element)

    def _added_transition(self, parent: etree._Element, number: int, *, never: bool) -> None:
        marks = {"IsMissing": "false", "Name": self._free_name("Trans", number), "Number": str(number)}
        element = sub(parent, "Transition", marks)
        body = condition_body(Expression(text="FALSE"), RESULT_OF["Transition"]) if never else None
        write_flgnet_body(self.ctx, element, body or empty_network(RESULT_OF["Transition"]))
        keep_added(element)

    def _belongs(self, source: Ref, members: set[tuple[str, int]], writer: TopologyWriter) -> bool:
        """Whether a connection that starts at a step, transition or branch is one of a sequence."""
        if source.kind != "B":
            return (source.kind, source.number) in members
        return len(self.chart.sequences) < _TWO or writer.leads_from(source.number, members)

    def _step(self, parent: etree._Element, step: Step) -> None:
        ctx = self.ctx
        attributes = {"Number": str(self.step_numbers[step.id]), "Init": flag(step.initial), "Name": step.name}
        if step.max_time is not None and not step.max_time.startswith(("#", '"')):
            attributes["MaximumStepTime"] = step.max_time
        if step.warning_time is not None:
            attributes["WarningTime"] = step.warning_time
        element = sub(parent, "Step", attributes)
        for name, value in _attributes(step.carried).items():
            if not name.startswith("@"):
                element.set(name, value)
        ctx.place.append(f"step {step.name}")
        native = {"id", "name", "number", "title", "initial", "actions", "interlock", "supervision"}
        native |= {"warning_time"} | ({"max_time"} if "MaximumStepTime" in attributes else set())
        write_languages(ctx, element, "StepName", step.title)
        write_languages(ctx, element, "Comment", step.comment)
        actions = sub(element, "Actions")
        self._fill_shell(actions, step.carried, "Actions")
        instead = self._actions(actions, step) or (["exclude"] if step.exclude else [])
        if instead:
            keep_fields(actions, {WRITTEN: of_rows(actions), INSTEAD: instead})
        sub(actions, "Action")
        self._supervised(element, step, "Supervision", step.supervision)
        self._supervised(element, step, "Interlock", step.interlock)
        own = ("Actions", "Supervisions", "Interlocks")
        for content in _unknown(step.carried):
            if not _is_shell(content, *own):
                add_element(ctx, element, content)
        for name in (*own, "Supervision", "Interlock"):
            _set_attributes(element, name, step.carried)
        ctx.keep("step")
        self._note_step(step)
        told = {"entry_action", "main_action", "exit_action", "min_time", "negated", "macro", "encloses", "exclude"}
        finish(ctx, element, step, frozenset(native | {"comment"}), told=frozenset(told))
        ctx.place.pop()

    def _note_step(self, step: Step) -> None:
        """Report what a step does in other tools, and not in S7-GRAPH."""
        note = self.ctx.note
        if step.min_time is not None:
            why = f"the transitions that leave the step wait for #{step.name}.T >= {step.min_time}"
            note(Outcome.TRANSLATED, "min time", why=why)
        if step.max_time is not None and self._watches_times():
            why = f"nothing happens when the step lasts longer than {step.max_time}: S7-GRAPH has no SFCError"
            note(Outcome.NOT_EXECUTED, "max time", why=why)
        if step.macro is not None:
            note(Outcome.NOT_EXECUTED, "macro", why="S7-GRAPH has no macro-steps: the chart in it is not executed")
        if step.encloses:
            note(Outcome.NOT_EXECUTED, "encloses", why="S7-GRAPH has no enclosing steps: its charts are not executed")
        if step.exclude:
            why = "it is excluded from the build: it has no actions there, and is not left"
            note(Outcome.TRANSLATED, "exclude", why=why)

    def _watches_times(self) -> bool:
        """True if the source tool reports steps that last too long."""
        return SfcFlag.ERROR in self.chart.flags_in_use(lambda name: name.casefold() in self.declared)

    def _actions(self, parent: etree._Element, step: Step) -> list[str]:
        """Write the rows of a step: what is done once on entry, while it is active, and once when it is left.

        Returns the fields of the step which rows say otherwise.
        """
        instead: list[str] = []
        if not step.exclude and self._step_action(parent, "entry action", step.entry_action, ActionEvent.S1):
            instead.append("entry_action")
        if not step.exclude and self._step_action(parent, "main action", step.main_action, None):
            instead.append("main_action")
        for action in step.actions:
            if self._action(parent, action, step) and "actions" not in instead:
                instead.append("actions")
        if not step.exclude and self._step_action(parent, "exit action", step.exit_action, ActionEvent.S0):
            instead.append("exit_action")
        return instead

    def _step_action(
        self, parent: etree._Element, what: str, code: str | Body | None, event: ActionEvent | None
    ) -> bool:
        """Write the rows of an entry, main or exit action. Returns True if there are any."""
        if code is None:
            return False
        planned = self.rows.step_action(code, event)
        for row in planned.rows:
            element = sub(parent, "Action")
            write_row(element, row, self.blocks)
            keep_added(element)
        self._note_rows(planned, what, what, f"`{_bare(code)}`" if isinstance(code, str) else "it")
        return bool(planned.rows)

    def _note_rows(self, planned: Rows, what: str, name: str, shown: str) -> None:
        if shown.startswith("`"):
            self.ctx.actions_told.add(shown.strip("`").casefold())
        lost = planned.outcome is Outcome.NOT_EXECUTED
        why = f"{shown} is not executed: {planned.why}" if lost else planned.why
        self.ctx.note(planned.outcome, what, name, why)

    def _action(self, parent: etree._Element, action: ActionAssociation, step: Step) -> bool:
        """Write the rows of an association. Returns True if they say otherwise what it does."""
        kept = verbatim(self.ctx, action.carried)
        target = action.target or (action.body.text if isinstance(action.body, StBody) else "")
        if kept is not None and _says(kept, action):
            parent.append(kept)
            self.ctx.keep("action", target)
            return False
        if isinstance(action.body, OpaqueBody) and action.body.source == "simaticml":
            add_element(self.ctx, parent, action.body.content)
            self.ctx.keep("action")
            return False
        planned = self.rows.association(action, inverted=step.negated)
        if step.exclude:
            planned = Rows((), Outcome.TRANSLATED, "its step is excluded from the build")
        if planned.rows == (action,):
            element = sub(parent, "Action")
            write_row(element, action, self.blocks)
            native = {"id", "qualifier", "target", "value", "duration", "event", "interlock", "body"}
            self.ctx.keep("action", target)
            finish(self.ctx, element, action, frozenset(native))
            return False
        said = {ASSOCIATION: fields_left(action, frozenset({"id"}))}
        if not planned.rows:
            keep_fields(parent, said)
        for number, row in enumerate(planned.rows):
            element = sub(parent, "Action")
            write_row(element, row, self.blocks)
            if number:
                keep_added(element)
            else:
                keep_fields(element, said)
        shown = _bare(action.target) if action.target is not None else "in place"
        qualifier = f" with the qualifier {action.qualifier}" if action.target is None else ""
        self._note_rows(
            planned, "action", f"action {shown}", f"`{shown}`" if not qualifier else f"what it does{qualifier}"
        )
        return bool(planned.rows)

    def _supervised(self, parent: etree._Element, step: Step, kind: str, supervised: Supervised | None) -> None:
        holder = sub(parent, f"{kind}s")
        element = sub(holder, kind)
        supervised = supervised or Supervised()
        write_languages(self.ctx, element, "Title", supervised.title)
        write_languages(self.ctx, element, "AlarmText", supervised.alarm)
        self._condition(element, supervised.condition, kind)
        self._fill_shell(holder, step.carried, f"{kind}s")

    def _condition(
        self, element: etree._Element, condition: Condition | None, kind: str, also: Sequence_[str] = ()
    ) -> None:
        """Write the network of a condition; `also`: what must be TRUE besides."""
        result, what = RESULT_OF[kind], f"condition of the {kind.lower()}"
        is_missing = condition is None and kind == "Transition" and not self.ctx.options.of_graph
        if (condition is None and not is_missing) or _is_always(condition):
            body: Body = empty_network(result)
            if also:
                body = condition_body(Expression(text=" AND ".join(also)), result) or body
        elif isinstance(condition, BodyCondition) and not condition.negated and _is_flgnet(condition, result):
            body = condition.body
            write_flgnet_body(self.ctx, element, body)
            return
        else:
            drawn = (
                drawn_condition(self.condition_of, condition, result, also)
                if condition is not None
                else "the transition has no condition"
            )
            if isinstance(drawn, FbdBody):
                reasons = [give_types(network, self.ctx.types) for network in drawn.networks]
                drawn = next((reason for reason in reasons if reason is not None), drawn)
            if not isinstance(drawn, str) and not is_sayable(self.ctx, drawn):
                drawn = "TIA Portal does not have all elements of its network"
            if isinstance(drawn, str):
                label = self.ctx.place[-1].partition(" ")[2] if self.ctx.place else ""
                body = untranslated_body(result, label)
                name = untranslated_name(label)
                why = f"the undeclared name {name} stands for it, and the block does not compile: {drawn}"
                self.ctx.note(Outcome.NOT_EXECUTED, what, why=why)
            else:
                body = drawn
                for network in drawn.networks:
                    say_constants(network, network_text(network), self.constants)
                self.ctx.note(Outcome.TRANSLATED, what, why=f"a network of {drawn.language}")
        plain = isinstance(condition, Expression) and condition.text == "TRUE" and condition.carried is None
        unsaid = condition is None and kind == "Transition" and not self.ctx.options.same
        if also or unsaid or (condition is not None and not plain):
            said = condition.model_dump(mode="json", exclude_none=True) if condition is not None else None
            self._write_instead(element, body, said)
        else:
            write_flgnet_body(self.ctx, element, body)

    def _write_instead(self, element: etree._Element, body: Body, said: object) -> None:
        """Write a network in place of a condition of the source, which a comment before it keeps."""
        place = len(element)
        write_flgnet_body(self.ctx, element, body)
        result = RESULT_OF[local(element)]
        keep_fields(element, {"condition": said, WRITTEN: of_condition(element, result)})
        element.insert(place, element[-1])

    def _transition(self, parent: etree._Element, transition: Transition) -> None:
        ctx = self.ctx
        number = self.transition_numbers[transition.id]
        name = transition.name or f"Trans{number}"
        element = sub(parent, "Transition", {"IsMissing": "false", "Name": name, "Number": str(number)})
        for key, value in _attributes(transition.carried).items():
            element.set(key, value)
        ctx.place.append(f"transition {self._labels[transition.id]}")
        native = {"id", "name", "number", "sources", "targets", "condition", "priority", "title", "comment"}
        write_languages(ctx, element, "TransitionName", transition.title)
        write_languages(ctx, element, "Comment", transition.comment)
        for content in _unknown(transition.carried):
            add_element(ctx, element, content)
        self._transition_condition(element, transition)
        ctx.keep("transition")
        finish(ctx, element, transition, frozenset(native), told=frozenset({"exclude"}))
        ctx.place.pop()

    def _transition_condition(self, element: etree._Element, transition: Transition) -> None:
        sources = [self.steps[number] for number in transition.sources if number in self.steps]
        if transition.exclude or any(step.exclude for step in sources):
            self.ctx.note(
                Outcome.TRANSLATED, "exclude", why="it is excluded from the build: a network that is never TRUE"
            )
            said = transition.condition.model_dump(mode="json", exclude_none=True) if transition.condition else None
            body = condition_body(Expression(text="FALSE"), RESULT_OF["Transition"])
            self._write_instead(element, body or untranslated_body(RESULT_OF["Transition"], "excluded"), said)
            return
        least = [f"#{step.name}.T >= {step.min_time}" for step in sources if step.min_time is not None]
        self._condition(element, transition.condition, "Transition", least)

    def _alarms(self, parent: etree._Element) -> None:
        settings = self.chart.graph_settings
        given = list(settings.alarm_categories) if settings is not None else []
        usual = USUAL_CATEGORIES[self.schema >= _ALL_CATEGORIES]
        categories = given or [
            AlarmCategory(name=name, id=number, display_class=display, text=text)
            for name, number, display, text in usual
        ]
        element = sub(parent, "AlarmsSettings")
        group = sub(element, "AlarmSupervisionCategories")
        for category in categories:
            owner = group if category.name == "AlarmSupervisionCategory" else element
            attributes = {"Id": str(category.id)}
            if category.display_class is not None:
                attributes["DisplayClass"] = str(category.display_class)
            child = sub(owner, category.name, attributes)
            if category.text is not None:
                sub(child, "Token", {"Text": category.text})
        self._fill_shell(element, self.chart.carried, "AlarmsSettings")


_TWO = 2
_SYMBOL = ("id", "kind", "inputs", "outputs", "local_id", "name", "position", "width", "height")


def empty_network(result: str) -> LdBody:
    """The network that LAD shows for no condition: the rail leads to the coil."""
    coil = Coil(id=1, variable=result, input=InputPin(connections=[Wire(source=0)]))
    return LdBody(networks=[LogicNetwork(nodes=[LeftPowerRail(id=0), coil])])


def _is_flgnet(condition: BodyCondition, result: str) -> bool:
    """Whether the body of a condition stands in the place of a network of GRAPH as it is."""
    body = condition.body
    if isinstance(body, OpaqueBody):
        return body.source == "simaticml"
    if body.language not in ("LD", "FBD"):
        return False
    return condition.name == result or any(
        isinstance(node, Coil) and node.variable in RESULT_OF.values()
        for network in getattr(body, "networks", [])
        for node in network.nodes
    )


def _bare(name: str) -> str:
    """A name as other tools write it."""
    return name.replace("#", "").replace('"', "")


def _is_always(condition: Condition | None) -> bool:
    return isinstance(condition, Expression) and not condition.negated and condition.text.strip().upper() == "TRUE"


def _says(kept: etree._Element, action: ActionAssociation) -> bool:
    """Whether a row of the file still says what the association says."""
    same = ActionAssociation.model_validate({"id": action.id, **row_fields(kept), "carried": None})
    return same == action.model_copy(update={"carried": None})


def _numbers(given: Iterable[tuple[int, int | None]]) -> dict[int, int]:
    """The number of each thing: its own where nothing before it has it, else the next free one."""
    pairs = list(given)
    numbers: dict[int, int] = {}
    taken: set[int] = set()
    for key, number in pairs:
        if number is not None and number not in taken:
            numbers[key] = number
            taken.add(number)
    following = max(taken, default=0)
    for key, _ in pairs:
        if key not in numbers:
            following += 1
            numbers[key] = following
    return {key: numbers[key] for key, _ in pairs}


def _branches_of(links: list[Link]) -> set[int]:
    """The numbers of the branches that connections name."""
    return {ref.number for link in links for ref in (link.source, link.target) if ref is not None and ref.kind == "B"}


def _unknown(carried: Carried | None) -> list[str]:
    return carried.elements if carried is not None else []


def _attributes(carried: Carried | None) -> dict[str, str]:
    return carried.attributes if carried is not None else {}


def _set_attributes(element: etree._Element, name: str, carried: Carried | None) -> None:
    """Write the attributes that were kept of `element` or of an element `name` close below it."""
    for key, value in _attributes(carried).items():
        owner, _, mark = key[1:].rpartition("@")
        if key.startswith("@") and owner == name:
            found = element if local(element) == name else _below(element, name)
            if found is not None:
                found.set(mark, value)


def _below(element: etree._Element, name: str) -> etree._Element | None:
    """The child or grandchild `name`."""
    inner = [*children(element), *(part for child in children(element) for part in children(child))]
    return next((child for child in inner if local(child) == name), None)


def _is_shell(content: str, *names: str) -> bool:
    """Whether carried markup is what was not understood of one of the elements `names`."""
    head = content[1:].partition(">")[0].partition(" ")[0].rstrip("/")
    return head in names
