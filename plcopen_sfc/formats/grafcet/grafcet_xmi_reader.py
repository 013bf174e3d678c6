"""Reads ``.grafcet`` files: references by position become steps, variables and charts."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, field

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location, StructureError
from plcopen_sfc.formats.format_interface import ReadResult
from plcopen_sfc.formats.grafcet.grafcet_xmi_terms import (
    TermError,
    kind_of,
    term_text,
)
from plcopen_sfc.formats.remainder_comments import DAMAGED, OUTDATED, put_back, read_entries
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK
from plcopen_sfc.formats.xml.xml_parsing import line_of
from plcopen_sfc.languages.st.lexer import Comment, CommentKind
from plcopen_sfc.model import sfc
from plcopen_sfc.model.actions import ActionKind, ForcedSituation, ForcingOrder
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.whole_numbers import whole_number

SECTIONS = {"input": SectionKind.INPUT, "output": SectionKind.OUTPUT, "internal": SectionKind.LOCAL}
TYPES = {"Bool": Elementary.BOOL, "Integer": Elementary.INT}
STORED = {
    "activation": ActionKind.ON_ACTIVATION,
    "deactivation": ActionKind.ON_DEACTIVATION,
    "event": ActionKind.ON_EVENT,
}
SITUATIONS = {
    "currentSituation": ForcedSituation.CURRENT,
    "emptySituation": ForcedSituation.EMPTY,
    "initialSituation": ForcedSituation.INITIAL,
    "explicitSituation": ForcedSituation.EXPLICIT,
}
UNNAMED = "GRAFCETChart"
"""The name of a GRAFCET whose file has none."""
_OWN = re.compile(rf"(\{{{COMMENT_MARK}.*)", re.DOTALL)
_CODES = {DAMAGED: "GRF202", OUTDATED: "GRF203"}


@dataclass
class XmiOrder:
    """The order in a file of arcs and what is referred to by position; but for variables by the path of the chart.

    `namespaces` are those of the file by their prefixes: the program has written two spellings of them.
    """

    variables: list[str] = field(default_factory=list)
    bars: dict[str, list[Hashable]] = field(default_factory=dict)
    arcs: dict[str, list[Hashable]] = field(default_factory=dict)
    actions: dict[str, list[Hashable]] = field(default_factory=dict)
    namespaces: dict[str, str] = field(default_factory=dict)


def keys_in(network: sfc.SfcNetwork) -> tuple[dict[int, Hashable], dict[int, Hashable]]:
    """Return the keys of steps and transitions in an `XmiOrder`, by their ids: names, for ids change with edits."""
    names: Counter[str] = Counter()
    steps: dict[int, Hashable] = {}
    for step in network.steps:
        names[step.name] += 1
        steps[step.id] = step.name, names[step.name]
    return steps, {**network.labels()}


def bar_of(transition: sfc.Transition, steps: Mapping[int, Hashable], *, joins: bool) -> Hashable:
    """Return what the bar of a transition is known by: that of its sources if it `joins` them, else of its targets."""
    sides = (transition.sources, transition.targets)
    return (*(tuple(steps[each] for each in side if each in steps) for side in sides), joins)


@dataclass
class _Part:
    """The root, a partial chart or an expansion, with what its references lead to."""

    element: etree._Element
    network: sfc.SfcNetwork
    steps: dict[etree._Element, sfc.Step] = field(default_factory=dict)


class XmiReader:
    """Reads one file. `order` and `lines` are known when it has `run`."""

    def __init__(self, root: etree._Element, file: str | None) -> None:
        self._root = root
        self._file = file
        self._ids = 0
        self._parts: dict[etree._Element, _Part] = {}
        self._partials: dict[etree._Element, sfc.PartialChart] = {}
        self._names: dict[etree._Element, str] = {}
        self._diagnostics: list[Diagnostic] = []
        self.lines: dict[str, int] = {}
        self.order = XmiOrder(namespaces={str(prefix): uri for prefix, uri in root.nsmap.items() if prefix})

    def run(self) -> ReadResult:
        """Return the project in the file. Raises `StructureError` where a reference leads nowhere."""
        if etree.QName(self._root).localname != "Grafcet":
            raise self._wrong("the root of a .grafcet file is grafcet:Grafcet", self._root)
        name = self._root.get("name") or UNNAMED
        network = sfc.SfcNetwork()
        pou = Pou(name=name, kind=PouKind.PROGRAM, bodies=[sfc.SfcBody(chart=network)])
        project = Project(name=name, pous=[pou])
        self._parts[self._root] = _Part(self._root, pou.chart or network)
        for element in self._root.findall("partialGrafcets"):
            is_expansion = kind_of(element) == "MacrostepExpansion"
            kind = sfc.PartialChartKind.EXPANSION if is_expansion else sfc.PartialChartKind.GLOBAL
            if element.get("enclosingStep"):
                kind = sfc.PartialChartKind.ENCLOSED
            partial = sfc.PartialChart(name=element.get("name", ""), kind=kind, chart=sfc.SfcNetwork())
            self._parts[self._root].network.partial_charts.append(partial)
            self._partials[element] = partial
            self._parts[element] = _Part(element, partial.chart)
        for part in self._parts.values():
            self._steps(part)
        pou.interface = self._interface()
        for part in self._parts.values():
            self._ids = max([0, *(step.id for step in part.network.steps)])
            self._links(part)
            self._transitions(part, self._reference(part))
            self._actions(part)
        comments = [
            Comment(CommentKind.PRAGMA, f"{{{node.text.strip()}}}", (0, 0))
            for node in self._root.iterchildren(etree.Comment)
            if node.text is not None and node.text.startswith(COMMENT_MARK)
        ]
        entries = read_entries(comments, _OWN, self._note)
        return ReadResult(put_back(project, entries, self._note) if entries else project, self._diagnostics)

    def _steps(self, part: _Part) -> None:
        self._ids = 0
        wanted = ("steps", "macrosteps", "entryStep", "exitStep")
        elements = [child for child in part.element if child.tag in wanted]
        # an expansion begins with its entry step, wherever the file has it
        elements.sort(key=lambda child: {"entryStep": 0, "exitStep": 2}.get(str(child.tag), 1))
        for element in elements:
            self._ids += 1
            name = element.get("id", "0")
            macro = element.tag == "macrosteps"
            step = sfc.Step(id=self._ids, name=f"M{name}" if macro else name, initial=element.get("initial") == "true")
            if element.tag in ("entryStep", "exitStep"):
                step.name = f"{'E' if element.tag == 'entryStep' else 'S'}{name}"
                partial = self._partials[part.element]
                setattr(partial, "entry_step" if element.tag == "entryStep" else "exit_step", step.name)
            part.steps[element] = step
            part.network.steps.append(step)
            self._line(f"{self._path(part)} / step {step.name}", element)

    def _reference(self, part: _Part) -> str:
        charts = [*self._partials]
        return f"//@partialGrafcets.{charts.index(part.element)}" if part.element in self._partials else "/"

    def _path(self, part: _Part) -> str:
        name = self._parts[self._root].element.get("name") or UNNAMED
        partial = self._partials.get(part.element)
        return f"POU {name}" + (f" / {partial.name}" if partial is not None else "")

    def _line(self, path: str, element: etree._Element) -> None:
        if (line := line_of(element)) is not None:
            self.lines.setdefault(path, line)

    def _interface(self) -> Interface | None:
        declared: dict[SectionKind, list[Variable]] = {}
        for element in self._root.iterfind("variableDeclarationContainer/variableDeclarations"):
            name = element.get("name", "")
            kind = element.get("variableDeclarationType", "input")
            if kind == "step":
                self._names[element] = f"X{self._step(element.get('step', ''), element).name}"
                self.order.variables.append(self._names[element])
                continue
            self.order.variables.append(name)
            sort = element.find("sort")
            type_ = TYPES.get(kind_of(sort) if sort is not None else "Bool")
            if type_ is None or kind not in SECTIONS:
                raise self._wrong(f"the variable {name} is of no known kind or sort", element)
            self._names[element] = name
            variable = Variable(name=name, type=ElementaryType(name=type_))
            declared.setdefault(SECTIONS[kind], []).append(variable)
        if not declared:
            return None
        sections = [
            VariableSection(kind=kind, variables=declared[kind]) for kind in SECTIONS.values() if kind in declared
        ]
        return Interface(sections=sections)

    def _links(self, part: _Part) -> None:
        """Read what steps enclose and expand."""
        for element, step in part.steps.items():
            if kind_of(element) == "EnclosingStep":
                step.encloses = []
                for reference in element.get("partialGrafcets", "").split():
                    target = self._target(reference, element)
                    if target not in self._partials:
                        raise self._wrong(f"the reference {reference} leads to no partial chart", element)
                    marked = [s.name for e, s in self._parts[target].steps.items() if e.get("activationLink") == "true"]
                    step.encloses.append(sfc.Enclosure(chart=self._partials[target].name, activated_steps=marked))
            elif element.tag == "macrosteps":
                target = self._target(element.get("expansion", ""), element)
                if target not in self._partials:
                    raise self._wrong("the macro-step has no expansion", element)
                step.macro = sfc.Macro(expansion=self._partials[target].name)

    def _transitions(self, part: _Part, path: str) -> None:
        arcs: list[tuple[etree._Element, etree._Element]] = []
        into: dict[etree._Element, list[etree._Element]] = {}
        out: dict[etree._Element, list[etree._Element]] = {}
        for arc in part.element.findall("arcs"):
            source, target = (self._target(arc.get(end, ""), arc) for end in ("source", "target"))
            self._check_alternation(part, source, target, arc)
            arcs.append((source, target))
            out.setdefault(source, []).append(target)
            into.setdefault(target, []).append(source)
        found: dict[etree._Element, Hashable] = {}
        made: dict[etree._Element, int] = {}
        steps, _ = keys_in(part.network)
        for element in part.element.findall("transitions"):
            self._ids += 1
            number = element.get("id", "")
            transition = sfc.Transition(id=self._ids, number=whole_number(number))
            transition.name = number if transition.number is None else ""
            bars: list[etree._Element] = []
            transition.sources = [part.steps[each].id for each in self._reached(part, into, element, bars)]
            joins = len(bars)
            transition.targets = [part.steps[each].id for each in self._reached(part, out, element, bars)]
            for index, bar in enumerate(bars):
                found.setdefault(bar, bar_of(transition, steps, joins=index < joins))
            text = self._condition(element)
            transition.condition = Expression(text=text) if text is not None else None
            made[element] = transition.id
            part.network.transitions.append(transition)
        self.order.bars[path] = [found.get(bar) for bar in part.element.findall("synchronizations")]
        _, labels = keys_in(part.network)
        for element, made_id in made.items():
            self._line(f"{self._path(part)} / transition {labels[made_id]}", element)
        own = {element: steps[step.id] for element, step in part.steps.items()} | found
        own |= {element: labels[number] for element, number in made.items()}
        self.order.arcs[path] = [(own.get(source), own.get(target)) for source, target in arcs]

    def _check_alternation(
        self, part: _Part, source: etree._Element, target: etree._Element, arc: etree._Element
    ) -> None:
        both_steps = source in part.steps and target in part.steps
        if both_steps or (source.tag == target.tag == "transitions"):
            what = "steps" if both_steps else "transitions"
            raise self._wrong(f"an arc joins two {what}: steps and transitions alternate (IEC 60848, 4.4)", arc)
        for end in (source, target):
            if end not in part.steps and end.tag not in ("transitions", "synchronizations"):
                raise self._wrong("an arc leads to something that is neither step nor transition of its chart", arc)

    def _reached(
        self,
        part: _Part,
        arcs: dict[etree._Element, list[etree._Element]],
        start: etree._Element,
        bars: list[etree._Element],
    ) -> Iterator[etree._Element]:
        """Yield the steps on one side of a transition, in the order of the steps; `bars` gets those between."""
        found, waiting, seen = set(), [start], set()
        while waiting:
            for element in arcs.get(waiting.pop(), []):
                if element in part.steps:
                    found.add(element)
                elif element.tag == "synchronizations" and element not in seen:
                    seen.add(element)
                    bars.append(element)
                    waiting.append(element)
        return (element for element in part.steps if element in found)

    def _condition(self, element: etree._Element) -> str | None:
        """Return the term of an element with its times; None where it has none."""
        term = element.find("term")
        text = self._term(term) if term is not None else None
        if element.get("timeConditionType", "none") != "timeDependent":
            return text
        unit = "ms" if element.get("unit") == "ms" else "s"
        first, last = element.get("delayTime", "0"), element.get("resetTime", "0")
        parts = [f"{first}{unit}" if first != "0" or last == "0" else None, f"({text or 'TRUE'})"]
        parts.append(f"{last}{unit}" if last != "0" else None)
        return "/".join(part for part in parts if part is not None)

    def _term(self, term: etree._Element) -> str:
        try:
            return term_text(term, self._variable)
        except TermError as error:
            raise self._wrong(f"the term cannot be read: {error}", term) from error

    def _variable(self, element: etree._Element) -> str:
        target = self._target(element.get("variableDeclaration", ""), element)
        if target not in self._names:
            raise self._wrong("the reference leads to no variable", element)
        return self._names[target]

    def _actions(self, part: _Part) -> None:
        linked: dict[etree._Element, Hashable] = {}
        for link in part.element.findall("actionLinks"):
            if not (link.get("step") and link.get("actionType")):
                self._ignored("GRF111", "the link joins no step with an action", link)
                continue
            step = part.steps.get(self._target(link.get("step", ""), link))
            element = self._target(link.get("actionType", ""), link)
            if step is None or element.tag != "actionTypes":
                raise self._wrong("a link joins a step of its chart and an action", link)
            linked.setdefault(element, (step.name, len(step.actions)))
            step.actions.append(self._action(element))
        self.order.actions[self._reference(part)] = [linked.get(e) for e in part.element.findall("actionTypes")]
        for element in part.element.findall("actionTypes"):
            if element not in linked:
                self._ignored("GRF110", "the action belongs to no step", element)

    def _ignored(self, code: str, what: str, element: etree._Element) -> None:
        message = f"{what}: it is never executed, and left out where the file is written for another one"
        where = Location(self._file, line_of(element))
        self._diagnostics.append(Diagnostic(code, Severity.WARNING, message, where))

    def _action(self, element: etree._Element) -> sfc.ActionAssociation:
        self._ids += 1
        kind = kind_of(element)
        action = sfc.ActionAssociation(id=self._ids)
        if kind == "ForcingOrder":
            chart = self._target(element.get("partialGrafcet", ""), element)
            if chart not in self._partials:
                raise self._wrong("a forcing order forces a partial chart", element)
            forced = [self._step(each, element).name for each in element.get("forcedSteps", "").split()]
            situation = SITUATIONS.get(element.get("forcingOrderType", "currentSituation"))
            if situation is None:
                raise self._wrong("the kind of the forcing order is not known", element)
            action.kind = ActionKind.FORCING
            action.forcing = ForcingOrder(chart=self._partials[chart].name, situation=situation, steps=forced)
            return action
        variable = element.find("variable")
        if variable is None or kind not in ("StoredAction", "ContinuousAction"):
            raise self._wrong("an action has a variable, and is stored or continuous", element)
        action.target = self._variable(variable)
        condition = self._condition(element)
        action.condition = Expression(text=condition) if condition is not None else None
        if kind == "StoredAction":
            value = element.find("value")
            action.kind = STORED.get(element.get("storedActionType", "activation"), ActionKind.ON_ACTIVATION)
            action.value = self._term(value) if value is not None else None
            return action
        action.kind = ActionKind.CONDITIONAL if condition is not None else ActionKind.CONTINUOUS
        timed = {"timeDelayed": ActionKind.DELAYED, "timeLimited": ActionKind.LIMITED}
        if (kind_of_time := element.get("timeConditionType", "none")) in timed:
            action.kind = timed[kind_of_time]
            duration = f"T#{element.get('delayTime', '0')}{'ms' if element.get('unit') == 'ms' else 's'}"
            action = action.model_copy(update={"duration": duration})  # no assignment: a file may have any text
        return action

    def _step(self, reference: str, element: etree._Element) -> sfc.Step:
        target = self._target(reference, element)
        for part in self._parts.values():
            if target in part.steps:
                return part.steps[target]
        raise self._wrong(f"the reference {reference} leads to no step", element)

    def _target(self, reference: str, element: etree._Element) -> etree._Element:
        """Return the element that a reference leads to: ``//@partialGrafcets.1/@steps.0``."""
        found = self._root
        for segment in reference.removeprefix("//").split("/"):
            parts = re.fullmatch(r"@?(\w+)(?:\.(\d{1,9}))?", segment, re.ASCII)
            children = found.findall(parts[1]) if parts is not None else []
            index = int(parts[2] or 0) if parts is not None else 0
            if index >= len(children):
                raise self._wrong(f"the reference {reference!r} leads nowhere", element)
            found = children[index]
        return found

    def _wrong(self, message: str, element: etree._Element) -> StructureError:
        return StructureError(message, location=Location(self._file, line_of(element)))

    def _note(self, kind: str, message: str, _offset: int) -> None:
        self._diagnostics.append(Diagnostic(_CODES[kind], Severity.WARNING, message, Location(self._file)))
