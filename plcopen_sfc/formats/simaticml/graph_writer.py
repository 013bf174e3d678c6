"""Writes a chart as ``Graph``, the program of an S7-GRAPH block. The reader is `graph_reader`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

from lxml import etree

from plcopen_sfc.formats.format_interface import SOURCE_CHART_FIELD
from plcopen_sfc.formats.simaticml.action_controls import watching_flags
from plcopen_sfc.formats.simaticml.action_rows import RowPlanner, RowsWriter, functions_of
from plcopen_sfc.formats.simaticml.added_elements import mark_added
from plcopen_sfc.formats.simaticml.element_reader import children, local
from plcopen_sfc.formats.simaticml.element_writer import (
    DocumentWriting,
    add_element,
    finish,
    keep_fields,
    sub,
    write_languages,
)
from plcopen_sfc.formats.simaticml.graph_conditions import (
    ConditionWriter,
    condition_body,
    empty_network,
    untranslated_body,
)
from plcopen_sfc.formats.simaticml.graph_reader import (
    CONNECTIONS,
    CONTROLLED,
    RESULT_OF,
    USUAL_CATEGORIES,
)
from plcopen_sfc.formats.simaticml.lad_fbd_networks import write_flgnet_body
from plcopen_sfc.formats.simaticml.replaced_elements import INSTEAD, WRITTEN, chart_digest, rows_digest
from plcopen_sfc.formats.simaticml.sequence_rules import (
    ElementRef,
    InsertedElements,
    Legaliser,
    SequenceLink,
    connection_problems,
    with_competing_transitions_joined,
    without_joined_jumps,
    write_link,
)
from plcopen_sfc.formats.simaticml.sequence_topology import TopologyWriter, usual_order
from plcopen_sfc.formats.xml.extension_data import Markup, attributes_of, boolean, elements_of, markup_of
from plcopen_sfc.languages.networks import chart_statements, condition_reader
from plcopen_sfc.languages.words import underscored_name
from plcopen_sfc.model.base import ExtensionData
from plcopen_sfc.model.body import LdBody
from plcopen_sfc.model.chart_settings import WATCHING_FLAGS, AlarmCategory, SfcFlag
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.drawing import Symbol
from plcopen_sfc.model.sfc import PermanentOperation, Sequence, SfcNetwork, Step, Supervised, Transition
from plcopen_sfc.model.text import plain
from plcopen_sfc.reachability import reached
from plcopen_sfc.report import Outcome

_WATCHED = "a network behind the sequence sets SFCError when a step is active longer than its maximum time"
_ALL_CATEGORIES = 4
"""Schema version from which on all categories are written."""


def write_graph(ctx: DocumentWriting, root: etree._Element, chart: SfcNetwork) -> None:
    """Fill the ``Graph`` element `root`. The chart must be drawn."""
    _ChartWriter(ctx, chart).write(root)


@dataclass
class _Connections:
    """Branches and connections of a sequence."""

    links: list[SequenceLink]
    branches: list[tuple[Symbol, dict[str, str]]]
    added: InsertedElements

    def write(self, ctx: DocumentWriting, parent: etree._Element) -> None:
        """Write ``Branches`` and ``Connections``."""
        holder = sub(parent, "Branches")
        for symbol, attributes in self.branches:
            finish(ctx, sub(holder, "Branch", attributes), symbol, frozenset(_SYMBOL))
        holder = sub(parent, CONNECTIONS)
        for link in self.links:
            write_link(holder, link)


class _ChartWriter:
    def __init__(self, ctx: DocumentWriting, chart: SfcNetwork) -> None:
        self.ctx = ctx
        self.chart = chart
        self.schema = ctx.schemas.get("Graph", ctx.version.schema("Graph"))
        self.step_numbers = _numbers((step.id, step.number) for step in chart.steps)
        self.last_step = max(self.step_numbers.values(), default=0)
        self.names = {
            name.casefold() for name in (*(s.name for s in chart.steps), *(t.name for t in chart.transitions))
        }
        # S7-GRAPH declares a variable for each step and transition: names of the block's variables are taken
        self.names |= {name.removeprefix("#") for name in ctx.types}
        self.transition_numbers = _numbers((t.id, t.number) for t in chart.transitions)
        self._labels = chart.labels()
        self._competing = Counter(tuple(sorted(each.sources)) for each in chart.transitions)
        self.last_transition = max(self.transition_numbers.values(), default=0)
        self.of_tia = markup_of(ctx.project) is Markup.SIMATICML
        pou = ctx.pou
        final = ctx.options.final_scan
        planner = RowPlanner(
            ctx.project, pou, functions_of(ctx), ctx.action_controls, of_tia=self.of_tia, final_scan=final
        )
        self.rows = RowsWriter(ctx, planner)
        transitions = pou.transitions if pou is not None else []
        self.declared = {variable.name.casefold() for variable in pou.variables()} if pou is not None else set()
        self._control_networks = ctx.action_controls.networks if ctx.action_controls is not None else []
        has_watch = SfcFlag.ERROR.variable in {network.label for network in self._control_networks}
        self._watching = watching_flags(pou, chart) if has_watch and pou is not None else frozenset()
        self.conditions = ConditionWriter(ctx, condition_reader(chart, Dialect.SCL, transitions=transitions))
        self.steps = {step.id: step for step in chart.steps}
        self.has_one_sequence = len(chart.sequences) <= 1

    def write(self, root: etree._Element) -> None:
        """Write the whole block."""
        chart = self.chart
        self._operations(root, "PreOperations", chart.permanent_pre)
        for sequence, transitions in self._sequences():
            self._sequence(root, sequence, transitions)
        self._operations(root, "PostOperations", chart.permanent_post)
        self._controls(root[-1])
        self._alarms(root)
        own = ("PreOperations", "PostOperations", "AlarmsSettings")
        for content in elements_of(chart.extension_data):
            if not _is_shell(content, *own):
                add_element(self.ctx, root, content)
        for name in ("Graph", "PreOperations", "PostOperations", "AlarmsSettings", "AlarmSupervisionCategories"):
            _set_attributes(root, name, chart.extension_data)
        native = {"steps", "transitions", "sequences", "permanent_pre", "permanent_post", "drawing", "graph_settings"}
        self._note_surroundings()
        source = self.ctx.options.marks.get(id(chart), {}).get(SOURCE_CHART_FIELD)
        if isinstance(source, SfcNetwork):
            fields = source.model_dump(mode="json", exclude_none=True, exclude={"drawing"})
            keep_fields(root, {SOURCE_CHART_FIELD: fields, WRITTEN: chart_digest(root)})
            native |= {"settings"}
        finish(self.ctx, root, chart, frozenset(native))

    def _note_surroundings(self) -> None:
        """Report code that the source executes around the steps, and TIA Portal does not."""
        chart = self.chart
        if not chart.steps and not self.of_tia:
            self.ctx.note(Outcome.NOT_EXECUTED, "chart", why="it has no steps: TIA Portal imports no such block")
        if chart.logic and chart_statements(chart, Dialect.SCL).tree.statements:
            self.ctx.note(Outcome.NOT_EXECUTED, "logic", why="what is drawn beside the steps acts, and is not written")
        for flag_ in sorted(self._watching):
            self.ctx.note(Outcome.TRANSLATED, flag_.variable, why=_WATCHED)
        for flag_, use in (chart.settings.flags if chart.settings is not None else {}).items():
            if use.use and flag_ in WATCHING_FLAGS - self._watching:
                why = f"S7-GRAPH has no {flag_.variable}: the chart neither obeys it nor sets it"
                self.ctx.note(Outcome.NOT_EXECUTED, "flag", flag_.variable, why)

    def _operations(self, parent: etree._Element, name: str, operations: list[PermanentOperation]) -> None:
        element = sub(parent, name)
        self._fill_shell(element, self.chart.extension_data, name)
        for operation in operations:
            child = sub(element, "PermanentOperation")
            write_languages(self.ctx, child, "Title", operation.title)
            for content in elements_of(operation.extension_data):
                add_element(self.ctx, child, content)
            write_flgnet_body(self.ctx, child, operation.body or LdBody())
            _set_attributes(child, "PermanentOperation", operation.extension_data)
            self.ctx.keep("permanent operation")
            finish(self.ctx, child, operation, frozenset({"title", "body"}))

    def _controls(self, parent: etree._Element) -> None:
        """Write the networks that control actions."""
        for network in self._control_networks:
            child = sub(parent, "PermanentOperation")
            write_languages(self.ctx, child, "Title", network.label)
            write_flgnet_body(self.ctx, child, network.body)
            keep_fields(child, {CONTROLLED: network.label})
            mark_added(child)
        if self._control_networks:
            why = "the networks that control actions"
            self.ctx.note(Outcome.TRANSLATED, "permanent instruction after the sequence", why=why)

    def _fill_shell(self, element: etree._Element, extension_data: ExtensionData | None, name: str) -> None:
        """Add the parts of an element that were not understood."""
        for content in elements_of(extension_data):
            if _is_shell(content, name):
                holder = etree.Element("holder")
                add_element(self.ctx, holder, content)
                element.extend(list(holder[0]))

    def _sequences(self) -> list[tuple[Sequence, list[Transition]]]:
        """Return the sequences with their transitions.

        Transitions connect steps of one sequence, but for jumps into another; what is connected with none goes into the
        last.
        """
        sequences = list(self.chart.sequences) or [Sequence()]
        sequence_of = self._sequence_of_steps(sequences)
        # in the order that the sequence has its steps in; those that came to it by connections follow
        steps = [dict.fromkeys(n for n in each.steps if n in sequence_of) for each in sequences]
        for number, index in sequence_of.items():
            steps[index].setdefault(number)
        found: list[list[Transition]] = [[] for _ in sequences]
        for transition in self.chart.transitions:
            index = next((sequence_of[n] for n in (*transition.sources, *transition.targets) if n in sequence_of), -1)
            found[index].append(transition)
        written: list[tuple[Sequence, list[Transition]]] = []
        for index, sequence in enumerate(sequences):
            own = [n for n in steps[index] if sequence_of[n] == index]
            if own or not steps[index]:
                written.append((sequence.model_copy(update={"steps": own}), found[index]))
                continue
            # an edit connected all its steps to an earlier sequence
            for what, text in (("title", plain(sequence.title)), ("comment", plain(sequence.comment))):
                if text:
                    why = f"its steps belong to another sequence now: {text}"
                    self.ctx.note(Outcome.DROPPED, what, f"sequence {index + 1}", why)
        return written

    def _sequence_of_steps(self, sequences: list[Sequence]) -> dict[int, int]:
        """Return the index of the sequence that each step is connected with; the last one for those with none."""
        near: dict[int, list[int]] = {step.id: [] for step in self.chart.steps}
        jumps = {transition.id for transition in self.chart.jumps_between_sequences()}
        for transition in self.chart.transitions:
            targets = transition.targets if transition.id not in jumps else []
            ends = [number for number in (*transition.sources, *targets) if number in near]
            for one, other in pairwise(ends):
                near[one].append(other)
                near[other].append(one)
        found: dict[int, int] = {}
        for index, sequence in enumerate(sequences):
            for number in reached((each for each in sequence.steps if each in near), near.__getitem__):
                found.setdefault(number, index)
        return {number: found.get(number, len(sequences) - 1) for number in near}

    def _sequence(self, parent: etree._Element, sequence: Sequence, transitions: list[Transition]) -> None:
        ctx = self.ctx
        element = sub(parent, "Sequence")
        write_languages(ctx, element, "Title", sequence.title)
        write_languages(ctx, element, "Comment", sequence.comment)
        kept = elements_of(sequence.extension_data)
        is_kept = any(_is_shell(content, CONNECTIONS) for content in kept)
        connections = None if is_kept else self._connections(sequence, {t.id for t in transitions})
        added = connections.added if connections is not None else InsertedElements()
        holder = sub(element, "Steps")
        for number in sequence.steps:
            if number in self.steps:
                self._step(holder, self.steps[number])
        for number in added.steps:
            self._added_step(holder, number)
        self._fill_shell(holder, sequence.extension_data, "Steps")
        holder = sub(element, "Transitions")
        for transition in transitions:
            self._transition(holder, transition)
        for number in added.transitions:
            self._added_transition(holder, number, never=number in added.never)
        self._fill_shell(holder, sequence.extension_data, "Transitions")
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
            _set_attributes(element, name, sequence.extension_data)
        finish(ctx, element, sequence, frozenset({"title", "comment", "steps"}))

    def _connections(self, sequence: Sequence, transitions: set[int]) -> _Connections | None:
        if self.chart.drawing is None:
            return None
        writer = TopologyWriter(self.chart, self.chart.drawing, self.step_numbers, self.transition_numbers)
        members = {("S", self.step_numbers[i]) for i in sequence.steps if i in self.step_numbers}
        members |= {("T", self.transition_numbers[i]) for i in transitions}
        links = [link for link in writer.links() if self._belongs(link.source, members, writer)]
        own = [ElementRef("S", self.step_numbers[number]) for number in sequence.steps if number in self.step_numbers]
        own += [ElementRef("T", number) for key, number in self.transition_numbers.items() if key in transitions]
        own += [ElementRef("B", int(attributes["Number"])) for _, attributes in writer.branches()]
        drawn = _branches_of(links)
        types = writer.types()
        links = usual_order(with_competing_transitions_joined(without_joined_jumps(links, types), types), own)
        links_of_file = attributes_of(sequence.extension_data).get(CONNECTIONS, "").split()
        order = {link: place for place, link in enumerate(links_of_file)}
        links.sort(key=lambda link: order.get(str(link), len(order)))  # stable: new connections stay in usual order
        used = _branches_of(links)
        # a branch that no connection names is one of the only sequence; of several it might be in any
        dissolved = drawn - used
        branches = [
            (symbol, marks)
            for symbol, marks in writer.branches()
            if int(marks["Number"]) in used or (self.has_one_sequence and int(marks["Number"]) not in dissolved)
        ]
        left = {link.source for link in links}
        dead_ends = [ref.number for ref in own if ref.kind == "S" and ref not in left]
        legaliser = Legaliser(types, self.last_step, self.last_transition)
        links = legaliser.links(links, dead_ends)
        added = legaliser.added
        self.last_step = max(self.last_step, *added.steps, 0)
        self.last_transition = max(self.last_transition, *added.transitions, 0)
        self._report(connection_problems(links, types), dead_ends)
        return _Connections(links, branches, added)

    def _report(self, refused: list[str], dead_ends: list[int]) -> None:
        for problem in dict.fromkeys(refused):
            self.ctx.note(Outcome.APPROXIMATED, "branch", why=f"{problem}; TIA Portal may refuse it")
        for step in self.chart.steps:
            if self.step_numbers[step.id] in dead_ends:
                why = "S7-GRAPH wants a transition behind every step: one that is never TRUE"
                self.ctx.note(Outcome.TRANSLATED, "end of the sequence", f"step {step.name}", why)

    def _added_step(self, parent: etree._Element, number: int) -> None:
        name = underscored_name(f"Wait{number}", self.names)
        why = "S7-GRAPH wants it and a transition between two branches: what comes next is active one cycle later"
        self.ctx.note(Outcome.APPROXIMATED, "step", f"step {name}", why)
        element = sub(parent, "Step", {"Number": str(number), "Init": "false", "Name": name})
        sub(sub(element, "Actions"), "Action")
        step = Step(id=0, name=name)
        self._supervised(element, step, "Supervision", None)
        self._supervised(element, step, "Interlock", None)
        mark_added(element)

    def _added_transition(self, parent: etree._Element, number: int, *, never: bool) -> None:
        marks = {"IsMissing": "false", "Name": underscored_name(f"Trans{number}", self.names), "Number": str(number)}
        element = sub(parent, "Transition", marks)
        body = condition_body(Expression(text="FALSE"), RESULT_OF["Transition"]) if never else None
        write_flgnet_body(self.ctx, element, body or empty_network(RESULT_OF["Transition"]))
        mark_added(element)

    def _belongs(self, source: ElementRef, members: set[tuple[str, int]], writer: TopologyWriter) -> bool:
        """True if a connection that starts at a step, transition or branch is one of a sequence."""
        if source.kind != "B":
            return (source.kind, source.number) in members
        return self.has_one_sequence or writer.leads_from(source.number, members)

    def _step(self, parent: etree._Element, step: Step) -> None:
        ctx = self.ctx
        attributes = {"Number": str(self.step_numbers[step.id]), "Init": boolean(step.initial), "Name": step.name}
        # the attribute takes a literal; what is calculated goes into the fields that are kept beside it
        if step.max_time is not None and not step.max_time.startswith(("#", '"')):
            attributes["MaximumStepTime"] = step.max_time
        if step.warning_time is not None:
            attributes["WarningTime"] = step.warning_time
        element = sub(parent, "Step", attributes)
        for name, value in attributes_of(step.extension_data).items():
            if not name.startswith("@"):
                element.set(name, value)
        ctx.place.append(f"step {step.name}")
        native = {"id", "name", "number", "title", "initial", "actions", "interlock", "supervision"}
        native |= {"warning_time"} | ({"max_time"} if "MaximumStepTime" in attributes else set())
        write_languages(ctx, element, "StepName", step.title)
        write_languages(ctx, element, "Comment", step.comment)
        actions = sub(element, "Actions")
        self._fill_shell(actions, step.extension_data, "Actions")
        instead = self.rows.write(actions, step) or (["exclude"] if step.exclude else [])
        if instead:
            keep_fields(actions, {WRITTEN: rows_digest(actions), INSTEAD: instead})
        sub(actions, "Action")  # the empty last row of the editor, which every export has
        self._supervised(element, step, "Supervision", step.supervision)
        self._supervised(element, step, "Interlock", step.interlock)
        own = ("Actions", "Supervisions", "Interlocks")
        for content in elements_of(step.extension_data):
            if not _is_shell(content, *own):
                add_element(ctx, element, content)
        for name in (*own, "Supervision", "Interlock"):
            _set_attributes(element, name, step.extension_data)
        ctx.keep("step")
        self._note_step(step)
        reported = {"entry_action", "main_action", "exit_action", "min_time", "negated", "macro", "encloses", "exclude"}
        finish(ctx, element, step, frozenset(native | {"comment"}), reported=frozenset(reported))
        ctx.place.pop()

    def _note_step(self, step: Step) -> None:
        """Report the behaviour of a step in other tools that it does not have in S7-GRAPH."""
        note = self.ctx.note
        if step.min_time is not None:
            why = f"the transitions that leave the step wait for #{step.name}.T >= {step.min_time}"
            note(Outcome.TRANSLATED, "min time", why=why)
        if step.max_time is not None and self._watching:
            note(Outcome.TRANSLATED, "max time", why=_WATCHED)
        elif step.max_time is not None and self._watches_times():
            why = f"nothing happens when the step lasts longer than {step.max_time}: S7-GRAPH has no SFCError"
            note(Outcome.NOT_EXECUTED, "max time", why=why)
        controls = self.ctx.action_controls
        rows = [row for row in step.actions if not row.exclude]
        if step.negated and controls is not None and all((step.id, row.id) in controls.controlled for row in rows):
            note(Outcome.TRANSLATED, "negation", why="networks behind the sequence control its actions")
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

    def _supervised(self, parent: etree._Element, step: Step, kind: str, supervised: Supervised | None) -> None:
        holder = sub(parent, f"{kind}s")
        element = sub(holder, kind)
        supervised = supervised or Supervised()
        write_languages(self.ctx, element, "Title", supervised.title)
        write_languages(self.ctx, element, "AlarmText", supervised.alarm)
        self.conditions.write(element, supervised.condition, kind)
        self._fill_shell(holder, step.extension_data, f"{kind}s")

    def _transition(self, parent: etree._Element, transition: Transition) -> None:
        ctx = self.ctx
        number = self.transition_numbers[transition.id]
        name = transition.name or f"Trans{number}"
        element = sub(parent, "Transition", {"IsMissing": "false", "Name": name, "Number": str(number)})
        for key, value in attributes_of(transition.extension_data).items():
            element.set(key, value)
        ctx.place.append(f"transition {self._labels[transition.id]}")
        native = {"id", "name", "number", "sources", "targets", "condition", "title", "comment"}
        if self._competing[tuple(sorted(transition.sources))] > 1:
            native.add("priority")  # it is the order of the branches
        write_languages(ctx, element, "TransitionName", transition.title)
        write_languages(ctx, element, "Comment", transition.comment)
        for content in elements_of(transition.extension_data):
            add_element(ctx, element, content)
        self._transition_condition(element, transition)
        ctx.keep("transition")
        finish(ctx, element, transition, frozenset(native), reported=frozenset({"exclude"}))
        ctx.place.pop()

    def _transition_condition(self, element: etree._Element, transition: Transition) -> None:
        sources = [self.steps[number] for number in transition.sources if number in self.steps]
        if transition.exclude or any(step.exclude for step in sources):
            why = "it is excluded from the build: a network that is never TRUE"
            self.ctx.note(Outcome.TRANSLATED, "exclude", why=why)
            source = transition.condition.model_dump(mode="json", exclude_none=True) if transition.condition else None
            body = condition_body(Expression(text="FALSE"), RESULT_OF["Transition"])
            self.conditions.write_instead(
                element, body or untranslated_body(RESULT_OF["Transition"], "excluded"), source
            )
            return
        least = [f"#{step.name}.T >= {step.min_time}" for step in sources if step.min_time is not None]
        self.conditions.write(element, transition.condition, "Transition", least)

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
        self._fill_shell(element, self.chart.extension_data, "AlarmsSettings")


_SYMBOL = ("id", "kind", "inputs", "outputs", "local_id", "name", "position", "width", "height")


def _numbers(given: Iterable[tuple[int, int | None]]) -> dict[int, int]:
    """Return the number of each thing: its own where nothing before it has it, else the next free one."""
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


def _branches_of(links: list[SequenceLink]) -> set[int]:
    """Return the numbers of the branches that connections name."""
    return {ref.number for link in links for ref in (link.source, link.target) if ref is not None and ref.kind == "B"}


def _set_attributes(element: etree._Element, name: str, extension_data: ExtensionData | None) -> None:
    """Write the attributes that were kept of `element` or of an element `name` close below it."""
    for key, value in attributes_of(extension_data).items():
        owner, _, mark = key[1:].rpartition("@")
        if key.startswith("@") and owner == name:
            found = element if local(element) == name else _below(element, name)
            if found is not None:
                found.set(mark, value)


def _below(element: etree._Element, name: str) -> etree._Element | None:
    """Return the child or grandchild `name`."""
    inner = [*children(element), *(part for child in children(element) for part in children(child))]
    return next((child for child in inner if local(child) == name), None)


def _is_shell(content: str, *names: str) -> bool:
    """True if kept markup is a shell of one of the elements `names`, with its parts that were not understood."""
    head = content[1:].partition(">")[0].partition(" ")[0].rstrip("/")
    return head in names
