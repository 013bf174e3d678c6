"""Writes a chart as ``Graph``, the program of an S7-GRAPH block. The reader is `graph_reader`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from lxml import etree

from plcopen_sfc.formats.simaticml.actions_reader import row_fields
from plcopen_sfc.formats.simaticml.actions_writer import AS_EVENTS, SAYABLE, write_row
from plcopen_sfc.formats.simaticml.added import keep_added
from plcopen_sfc.formats.simaticml.conditions import condition_body
from plcopen_sfc.formats.simaticml.graph_reader import CONNECTIONS, RESULT_OF, USUAL_CATEGORIES, carried_order
from plcopen_sfc.formats.simaticml.networks import write_flgnet_body
from plcopen_sfc.formats.simaticml.reading import children, local
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
from plcopen_sfc.model.actions import ActionAssociation, Qualifier
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.body import Body, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.conditions import BodyCondition, Condition, Expression
from plcopen_sfc.model.drawing import Symbol
from plcopen_sfc.model.network import Coil, InputPin, LeftPowerRail, LogicNetwork
from plcopen_sfc.model.network import Connection as Wire
from plcopen_sfc.model.sfc import (
    AlarmCategory,
    PermanentOperation,
    Sequence,
    SfcNetwork,
    Step,
    Supervised,
    Transition,
)
from plcopen_sfc.report import Fate

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
        finish(self.ctx, root, chart, frozenset(native))

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
        self._report(added, problems(links, types), dead_ends)
        return _Connections(links, branches, added)

    def _report(self, added: Added, refused: list[str], dead_ends: list[int]) -> None:
        for problem in dict.fromkeys(refused):
            self.ctx.note(Fate.APPROXIMATED, "branch", why=f"{problem}; TIA Portal may refuse it")
        for _ in added.steps:
            why = "S7-GRAPH wants a step and a transition before what comes next: it is active one cycle later"
            self.ctx.note(Fate.APPROXIMATED, "branch", why=why)
        for step in self.chart.steps:
            if self.step_numbers[step.id] in dead_ends:
                why = "S7-GRAPH wants a transition behind every step: one that is never TRUE"
                self.ctx.note(Fate.TRANSLATED, "step", f"step {step.name}", why)

    def _free_name(self, stem: str, number: int) -> str:
        """A name that no step, transition or variable of the block has."""
        name = f"{stem}{number}"
        while name.casefold() in self.names:
            name += "_"
        self.names.add(name.casefold())
        return name

    def _added_step(self, parent: etree._Element, number: int) -> None:
        name = self._free_name("Wait", number)
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
        if step.max_time is not None:
            attributes["MaximumStepTime"] = step.max_time
        if step.warning_time is not None:
            attributes["WarningTime"] = step.warning_time
        element = sub(parent, "Step", attributes)
        for name, value in _attributes(step.carried).items():
            if not name.startswith("@"):
                element.set(name, value)
        ctx.place.append(f"step {step.name}")
        native = {"id", "name", "number", "initial", "max_time", "warning_time", "actions", "interlock", "supervision"}
        native |= {"title"}
        write_languages(ctx, element, "StepName", step.title)
        write_languages(ctx, element, "Comment", step.comment)
        actions = sub(element, "Actions")
        self._fill_shell(actions, step.carried, "Actions")
        for action in step.actions:
            self._action(actions, action)
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
        finish(ctx, element, step, frozenset(native | {"comment"}))
        ctx.place.pop()

    def _action(self, parent: etree._Element, action: ActionAssociation) -> None:
        kept = verbatim(self.ctx, action.carried)
        target = action.target or (action.body.text if isinstance(action.body, StBody) else "")
        if kept is not None and _says(kept, action):
            parent.append(kept)
            self.ctx.keep("action", target)
            return
        if isinstance(action.body, OpaqueBody):
            add_element(self.ctx, parent, action.body.content)
            self.ctx.keep("action")
            return
        element = sub(parent, "Action")
        write_row(element, action, self.blocks)
        native = {"id", "qualifier", "target", "value", "duration", "event", "interlock"}
        if isinstance(action.body, StBody) or action.body is None:
            native.add("body")
        if action.qualifier in AS_EVENTS:
            self.ctx.note(Fate.TRANSLATED, "action", target, f"{action.qualifier} is said with an event")
            native -= {"qualifier", "event"}
        elif action.qualifier not in SAYABLE:
            same = action.qualifier is Qualifier.R0
            why = f"S7-GRAPH has no qualifier {action.qualifier}"
            self.ctx.note(Fate.TRANSLATED if same else Fate.APPROXIMATED, "action", target, why)
            native.discard("qualifier")
        else:
            self.ctx.keep("action", target)
        also = {"event": None} if "event" not in native and action.event is None else None
        finish(self.ctx, element, action, frozenset(native), also=also)

    def _supervised(self, parent: etree._Element, step: Step, kind: str, supervised: Supervised | None) -> None:
        holder = sub(parent, f"{kind}s")
        element = sub(holder, kind)
        supervised = supervised or Supervised()
        write_languages(self.ctx, element, "Title", supervised.title)
        write_languages(self.ctx, element, "AlarmText", supervised.alarm)
        self._condition(element, supervised.condition, kind)
        self._fill_shell(holder, step.carried, f"{kind}s")

    def _condition(self, element: etree._Element, condition: Condition | None, kind: str) -> None:
        name = RESULT_OF[kind]
        body: Body = empty_network(name)
        if isinstance(condition, BodyCondition) and not condition.negated and _is_flgnet(condition, name):
            body = condition.body
        elif isinstance(condition, Expression) and not _is_always(condition):
            drawn = condition_body(condition, name)
            if drawn is not None:
                body = drawn
                self.ctx.note(Fate.TRANSLATED, f"condition of the {kind.lower()}", why=f"a network of {drawn.language}")
            else:
                self.ctx.note(Fate.CARRIED, f"condition of the {kind.lower()}", why="it has no network")
            keep_fields(
                element,
                {"condition": {"kind": "expression", **condition.model_dump(mode="json", exclude_none=True)}},
            )
        elif condition is not None and not _is_always(condition):
            self.ctx.note(Fate.CARRIED, f"condition of the {kind.lower()}", why="it is no network of LAD or FBD")
            keep_fields(element, {"condition": condition.model_dump(mode="json", exclude_none=True)})
        write_flgnet_body(self.ctx, element, body)

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
        self._condition(element, transition.condition, "Transition")
        ctx.keep("transition")
        finish(ctx, element, transition, frozenset(native))
        ctx.place.pop()

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


def _is_always(condition: Condition) -> bool:
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
