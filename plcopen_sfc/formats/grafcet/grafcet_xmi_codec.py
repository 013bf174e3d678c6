"""``.grafcet`` files of the open editor for GRAFCETs (AGRAFE): EMF XMI, references by position.

``//@partialGrafcets.1/@steps.0`` is the first step of the second chart. References are resolved when a file is read,
and made of the positions when it is written. Arcs and synchronizations are the several steps of a transition.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeVar, cast

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location, StructureError
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.grafcet.grafcet_xmi_terms import (
    XSI_TYPE,
    ReadCondition,
    TermError,
    TermWriter,
    kind_of,
    term_text,
)
from plcopen_sfc.formats.remainder_comments import DAMAGED, OUTDATED, keys_of, put_back, read_entries
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK
from plcopen_sfc.formats.xml.xml_codec import XmlCodec, XmlStyle
from plcopen_sfc.formats.xml.xml_parsing import parse_xml
from plcopen_sfc.languages.pragmas import changes, plain_fields
from plcopen_sfc.languages.st.lexer import Comment, CommentKind
from plcopen_sfc.model.actions import ActionAssociation, ActionKind, ForcedSituation, ForcingOrder
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.compare import path_of
from plcopen_sfc.model.conditions import Condition, Expression
from plcopen_sfc.model.numbering import take_ids
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Enclosure, Macro, PartialChart, PartialChartKind, SfcNetwork, Step, Transition
from plcopen_sfc.model.types import Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome

_XMI = "http://www.omg.org/XMI"
_NAMESPACES = {
    "xmi": _XMI,
    "xsi": "http://www.w3.org/2001/XMLSchema-instance",
    "grafcet": "http://www.example.org/grafcet",
    "terms": "http://www.example.org/terms",
}
_SECTIONS = {"input": SectionKind.INPUT, "output": SectionKind.OUTPUT, "internal": SectionKind.LOCAL}
_TYPES = {"Bool": Elementary.BOOL, "Integer": Elementary.INT}
_STORED = {
    "activation": ActionKind.ON_ACTIVATION,
    "deactivation": ActionKind.ON_DEACTIVATION,
    "event": ActionKind.ON_EVENT,
}
_SITUATIONS = {
    "currentSituation": ForcedSituation.CURRENT,
    "emptySituation": ForcedSituation.EMPTY,
    "initialSituation": ForcedSituation.INITIAL,
    "explicitSituation": ForcedSituation.EXPLICIT,
}
_UNNAMED = "GRAFCETChart"
"""The name of a GRAFCET whose file has none."""
_OWN = re.compile(rf"(\{{{COMMENT_MARK}.*)", re.DOTALL)
_CODES = {DAMAGED: "GRF202", OUTDATED: "GRF203"}


class GrafcetXmiCodec(XmlCodec):
    """``.grafcet`` files."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file. Raises `FormatError` where a reference leads nowhere."""
        return _Reader(parse_xml(data, file=file), file).run()

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """Return the tree of the file for `project`; what it has no place for is in comments."""
        found = [pou for pou in project.pous if pou.chart is not None]
        order = _Order()
        if options.source:  # references are positions: what the file has stays in its order
            reader = _Reader(parse_xml(options.source), None)
            reader.run()
            order = reader.order
        root = _Writer(found[0] if found else None, report, order).run()
        for pou in found[1:]:
            report.add(Outcome.NOT_EXECUTED, "chart", f"POU {pou.name}", "a .grafcet file has one GRAFCET")
        back = _Reader(root, None).run().project
        meant = project.model_copy(deep=True)
        take_ids(meant, back)
        for change in changes(plain_fields(back), plain_fields(meant), guarded=True):
            path = path_of(meant, keys_of(meant, change))
            name = next(segment for segment in reversed(change.path) if isinstance(segment, str)).replace("_", " ")
            report.add(Outcome.EXTENSION_DATA, name, path, "a .grafcet file has no place for it; it is in a comment")
            # XML allows no two hyphens in a comment
            root.append(etree.Comment(f"{COMMENT_MARK}{change} ".replace("--", "-$2D").replace("--", "-$2D")))
        return root

    def style(self) -> XmlStyle:
        """As EMF writes: UTF-8 without a mark, LF, two blanks, ``<a/>``."""
        return XmlStyle(encoding="UTF-8", newline="\n", self_closing="/>", final_newline=True)

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        """Return the line of each object, by the path that a report gives it."""
        reader = _Reader(parse_xml(content), None)
        reader.run()
        return reader.lines


CODEC = GrafcetXmiCodec()


# -- reading ----------------------------------------------------------------------------------------------------------


@dataclass
class _Order:
    """The order in a file of what is referred to by position; bars and actions by the path of their chart."""

    variables: list[str] = field(default_factory=list)
    bars: dict[str, list[Hashable]] = field(default_factory=dict)
    actions: dict[str, list[Hashable]] = field(default_factory=dict)


@dataclass
class _Part:
    """The root, a partial chart or an expansion, with what its references lead to."""

    element: etree._Element
    network: SfcNetwork
    steps: dict[etree._Element, Step] = field(default_factory=dict)


class _Reader:
    def __init__(self, root: etree._Element, file: str | None) -> None:
        self._root = root
        self._file = file
        self._ids = 0
        self._parts: dict[etree._Element, _Part] = {}
        self._partials: dict[etree._Element, PartialChart] = {}
        self._names: dict[etree._Element, str] = {}
        self._diagnostics: list[Diagnostic] = []
        self.lines: dict[str, int] = {}
        self.order = _Order()

    def run(self) -> ReadResult:
        if etree.QName(self._root).localname != "Grafcet":
            raise self._wrong("the root of a .grafcet file is grafcet:Grafcet", self._root)
        name = self._root.get("name") or _UNNAMED
        network = SfcNetwork()
        pou = Pou(name=name, kind=PouKind.PROGRAM, bodies=[SfcBody(chart=network)])
        project = Project(name=name, pous=[pou])
        self._parts[self._root] = _Part(self._root, pou.chart or network)
        for element in self._root.findall("partialGrafcets"):
            is_expansion = kind_of(element) == "MacrostepExpansion"
            kind = PartialChartKind.EXPANSION if is_expansion else PartialChartKind.GLOBAL
            if element.get("enclosingStep"):
                kind = PartialChartKind.ENCLOSED
            partial = PartialChart(name=element.get("name", ""), kind=kind, chart=SfcNetwork())
            self._parts[self._root].network.partial_charts.append(partial)
            self._partials[element] = partial
            self._parts[element] = _Part(element, partial.chart)
        for part in self._parts.values():
            self._steps(part)
        pou.interface = self._interface(pou)
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
            step = Step(id=self._ids, name=f"M{name}" if macro else name, initial=element.get("initial") == "true")
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
        name = self._parts[self._root].element.get("name") or _UNNAMED
        partial = self._partials.get(part.element)
        return f"POU {name}" + (f" / {partial.name}" if partial is not None else "")

    def _line(self, path: str, element: etree._Element) -> None:
        if (line := _line_of(element)) is not None:
            self.lines.setdefault(path, line)

    def _interface(self, pou: Pou) -> Interface | None:
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
            type_ = _TYPES.get(kind_of(sort) if sort is not None else "Bool")
            if type_ is None or kind not in _SECTIONS:
                raise self._wrong(f"the variable {name} is of no known kind or sort", element)
            self._names[element] = name
            variable = Variable(name=name, type=ElementaryType(name=type_))
            declared.setdefault(_SECTIONS[kind], []).append(variable)
        if not declared:
            return None
        sections = [
            VariableSection(kind=kind, variables=declared[kind]) for kind in _SECTIONS.values() if kind in declared
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
                    step.encloses.append(Enclosure(chart=self._partials[target].name, activated_steps=marked))
            elif element.tag == "macrosteps":
                target = self._target(element.get("expansion", ""), element)
                if target not in self._partials:
                    raise self._wrong("the macro-step has no expansion", element)
                step.macro = Macro(expansion=self._partials[target].name)

    def _transitions(self, part: _Part, path: str) -> None:
        into: dict[etree._Element, list[etree._Element]] = {}
        out: dict[etree._Element, list[etree._Element]] = {}
        for arc in part.element.findall("arcs"):
            source, target = (self._target(arc.get(end, ""), arc) for end in ("source", "target"))
            self._check_alternation(part, source, target, arc)
            out.setdefault(source, []).append(target)
            into.setdefault(target, []).append(source)
        found: dict[etree._Element, Hashable] = {}
        for element in part.element.findall("transitions"):
            self._ids += 1
            number = element.get("id", "")
            transition = Transition(id=self._ids, number=int(number) if number.isdecimal() else None)
            transition.name = "" if number.isdecimal() else number
            bars: list[etree._Element] = []
            transition.sources = [part.steps[each].id for each in self._reached(part, into, element, bars)]
            joins = len(bars)
            transition.targets = [part.steps[each].id for each in self._reached(part, out, element, bars)]
            for index, bar in enumerate(bars):
                key = (tuple(transition.sources), tuple(transition.targets), index < joins)
                found.setdefault(bar, key)
            text = self._condition(element)
            transition.condition = Expression(text=text) if text is not None else None
            part.network.transitions.append(transition)
            self._line(f"{self._path(part)} / transition {part.network.label(transition)}", element)
        self.order.bars[path] = [found.get(bar) for bar in part.element.findall("synchronizations")]

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
        where = Location(self._file, _line_of(element))
        self._diagnostics.append(Diagnostic(code, Severity.WARNING, message, where))

    def _action(self, element: etree._Element) -> ActionAssociation:
        self._ids += 1
        kind = kind_of(element)
        action = ActionAssociation(id=self._ids)
        if kind == "ForcingOrder":
            chart = self._target(element.get("partialGrafcet", ""), element)
            if chart not in self._partials:
                raise self._wrong("a forcing order forces a partial chart", element)
            forced = [self._step(each, element).name for each in element.get("forcedSteps", "").split()]
            situation = _SITUATIONS.get(element.get("forcingOrderType", "currentSituation"))
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
            action.kind = _STORED.get(element.get("storedActionType", "activation"), ActionKind.ON_ACTIVATION)
            action.value = self._term(value) if value is not None else None
            return action
        action.kind = ActionKind.CONDITIONAL if condition is not None else ActionKind.CONTINUOUS
        timed = {"timeDelayed": ActionKind.DELAYED, "timeLimited": ActionKind.LIMITED}
        if (kind_of_time := element.get("timeConditionType", "none")) in timed:
            action.kind = timed[kind_of_time]
            action.duration = f"T#{element.get('delayTime', '0')}{'ms' if element.get('unit') == 'ms' else 's'}"
        return action

    def _step(self, reference: str, element: etree._Element) -> Step:
        target = self._target(reference, element)
        for part in self._parts.values():
            if target in part.steps:
                return part.steps[target]
        raise self._wrong(f"the reference {reference} leads to no step", element)

    def _target(self, reference: str, element: etree._Element) -> etree._Element:
        """Return the element that a reference leads to: ``//@partialGrafcets.1/@steps.0``."""
        found = self._root
        for segment in reference.removeprefix("//").split("/"):
            parts = re.fullmatch(r"@?(\w+)(?:\.(\d+))?", segment, re.ASCII)
            children = found.findall(parts[1]) if parts is not None else []
            index = int(parts[2] or 0) if parts is not None else 0
            if index >= len(children):
                raise self._wrong(f"the reference {reference!r} leads nowhere", element)
            found = children[index]
        return found

    def _wrong(self, message: str, element: etree._Element) -> StructureError:
        return StructureError(message, location=Location(self._file, _line_of(element)))

    def _note(self, kind: str, message: str, _offset: int) -> None:
        self._diagnostics.append(Diagnostic(_CODES[kind], Severity.WARNING, message, Location(self._file)))


def _line_of(element: etree._Element) -> int | None:
    return cast("int | None", element.sourceline)


_Item = TypeVar("_Item")

# -- writing ----------------------------------------------------------------------------------------------------------


class _Writer:
    def __init__(self, pou: Pou | None, report: ConversionReport, order: _Order) -> None:
        self._pou = pou
        self._order = order
        self._report = report
        self._root = etree.Element(f"{{{_NAMESPACES['grafcet']}}}Grafcet", nsmap=_NAMESPACES)
        self._root.set(f"{{{_XMI}}}version", "2.0")
        self._charts: dict[str, str] = {}
        self._steps: dict[str, str] = {}
        self._terms = TermWriter({})
        self._numbers: dict[int, str] = {}

    def run(self) -> etree._Element:
        pou = self._pou
        if pou is None or pou.chart is None:
            return self._root
        if pou.name != _UNNAMED:
            self._root.set("name", pou.name)
        self._report.add(Outcome.KEPT, "POU", f"POU {pou.name}")
        chart = pou.chart
        parts: list[tuple[str, SfcNetwork, PartialChart | None]] = [("/", chart, None)]
        for number, partial in enumerate(chart.partial_charts):
            path = f"//@partialGrafcets.{number}"
            self._charts[partial.name.casefold()] = path
            parts.append((path, partial.chart, partial))
        for path, network, found in parts:
            self._place_steps(path, network, found)
        self._variables(pou, [network for _, network, _ in parts])
        for path, network, found in parts:
            element = self._root
            if found is not None:
                element = etree.SubElement(self._root, "partialGrafcets")
                is_expansion = found.kind is PartialChartKind.EXPANSION
                element.set(XSI_TYPE, f"grafcet:{'MacrostepExpansion' if is_expansion else 'PartialGrafcet'}")
                element.set("name", found.name)
                self._enclosing(element, found, parts)
            self._chart(element, path, network, found)
        # the root's own elements come last where it has partial charts, as the metamodel lists them
        return self._root

    def _place_steps(self, path: str, network: SfcNetwork, partial: PartialChart | None) -> None:
        counts = {"steps": 0, "macrosteps": 0}
        for step in network.steps:
            tag = _tag(step, partial)
            reference = f"{path}/@{tag}"
            if tag in counts:
                reference += f".{counts[tag]}"
                counts[tag] += 1
            self._numbers[id(step)] = reference
            for name in (step.name, "" if step.number is None else str(step.number)):
                self._steps.setdefault(name.casefold(), reference)

    def _variables(self, pou: Pou, networks: Iterable[SfcNetwork]) -> None:
        container = etree.SubElement(self._root, "variableDeclarationContainer")
        positions: dict[str, str] = {}
        words = {kind: word for word, kind in _SECTIONS.items()}
        declared = [(v, s.kind) for s in (pou.interface.sections if pou.interface else []) for v in s.variables]
        texts = " ".join(_texts(networks))
        flags = {
            f"X{step.name}": self._numbers[id(step)]
            for network in networks
            for step in network.steps
            if f"X{step.name}" in self._order.variables
            or re.search(rf"(?<!\w)X{re.escape(step.name)}(?!\w)", texts, re.IGNORECASE)
        }

        def add(name: str, kind: str, sort: str) -> etree._Element:
            number = len(positions)
            positions.setdefault(name.casefold(), f"//@variableDeclarationContainer/@variableDeclarations.{number}")
            element = etree.SubElement(container, "variableDeclarations", name=name)
            if kind != "input":  # the first literal is the default, which EMF leaves out
                element.set("variableDeclarationType", kind)
            etree.SubElement(element, "sort", {XSI_TYPE: f"terms:{sort}", "id": f"9{number + 1:03d}"})
            return element

        entries: list[tuple[str, str, str]] = []
        for variable, kind in declared:
            sort = {_TYPES["Bool"]: "Bool"}.get(getattr(variable.type, "name", None), "Integer")  # type: ignore[arg-type]
            if kind not in words or getattr(variable.type, "name", None) not in _INTEGER_TYPES:
                self._lost(
                    "variable", f"POU {pou.name} / {variable.name}", "a .grafcet file has BOOL and integers only"
                )
            entries.append((variable.name, words.get(kind, "internal"), sort))
        entries += [(name, "step", "Bool") for name in flags]
        for name, word, sort in _arranged(entries, lambda entry: entry[0], self._order.variables):
            made = add(name, word, sort)
            if word == "step":
                made.set("step", flags[name])
        self._terms = TermWriter(positions)

    def _enclosing(
        self,
        element: etree._Element,
        partial: PartialChart,
        parts: Iterable[tuple[str, SfcNetwork, PartialChart | None]],
    ) -> None:
        for _, network, _ in parts:
            for step in network.steps:
                if any(each.chart.casefold() == partial.name.casefold() for each in step.encloses or ()):
                    element.set("enclosingStep", self._numbers[id(step)])

    def _chart(self, element: etree._Element, path: str, network: SfcNetwork, partial: PartialChart | None) -> None:
        where = f"POU {self._pou.name if self._pou else ''}" + (f" / {partial.name}" if partial is not None else "")
        linked = {
            name.casefold()
            for other in self._networks()
            for step in other.steps
            for each in step.encloses or ()
            if partial is not None and each.chart.casefold() == partial.name.casefold()
            for name in each.activated_steps
        }
        for step in sorted(network.steps, key=lambda s: list(_STEP_TAGS).index(_tag(s, partial))):
            tag = _tag(step, partial)
            made = etree.SubElement(element, tag)
            if tag == "steps":
                made.set(XSI_TYPE, f"grafcet:{'Step' if step.encloses is None else 'EnclosingStep'}")
            made.set("id", _id_of(step, tag))
            if step.initial:
                made.set("initial", "true")
            if step.name.casefold() in linked:
                made.set("activationLink", "true")
            if step.encloses:
                charts = [self._charts.get(each.chart.casefold(), "") for each in step.encloses]
                made.set("partialGrafcets", " ".join(charts))
            if tag == "macrosteps" and step.macro is not None:
                made.set("expansion", self._charts.get((step.macro.expansion or "").casefold(), ""))
        for number, transition in enumerate(network.transitions):
            made = etree.SubElement(element, "transitions")
            made.set("id", str(transition.number if transition.number is not None else number + 1))
            label = f"{where} / transition {network.label(transition)}"
            self._condition(made, "term", transition.condition, f"{path}/@transitions.{number}", label)
        self._arcs(element, path, network)
        self._actions(element, path, network, where)

    def _networks(self) -> Iterator[SfcNetwork]:
        chart = self._pou.chart if self._pou is not None else None
        if chart is not None:
            yield chart
            yield from (partial.chart for partial in chart.partial_charts)

    def _arcs(self, element: etree._Element, path: str, network: SfcNetwork) -> None:
        references = {step.id: self._numbers[id(step)] for step in network.steps}
        arcs: list[tuple[str, str]] = []
        bars: list[Hashable] = []
        for transition in network.transitions:
            sides = (tuple(transition.sources), tuple(transition.targets))
            bars += [(*sides, side is sides[0]) for side in sides if len(side) > 1]
        bars = _arranged(bars, lambda bar: bar, self._order.bars.get(path, []))
        for _ in bars:
            etree.SubElement(element, "synchronizations")
        for number, transition in enumerate(network.transitions):
            own = f"{path}/@transitions.{number}"
            for ids, before in ((transition.sources, True), (transition.targets, False)):
                ends = [references[each] for each in ids if each in references]
                bar = own
                if len(ends) > 1:
                    key = (tuple(transition.sources), tuple(transition.targets), before)
                    bar = f"{path}/@synchronizations.{bars.index(key)}"
                    arcs.append((bar, own) if before else (own, bar))
                arcs += [(end, bar) if before else (bar, end) for end in ends]
        for source, target in arcs:
            etree.SubElement(element, "arcs", source=source, target=target)

    def _actions(self, element: etree._Element, path: str, network: SfcNetwork, where: str) -> None:
        links: list[tuple[str, int]] = []
        found = [(step, index, action) for step in network.steps for index, action in enumerate(step.actions)]
        order = self._order.actions.get(path, [])
        for step, _, action in _arranged(found, lambda each: (each[0].name, each[1]), order):
            number = len(links)
            own = f"{path}/@actionTypes.{number}"
            label = f"{where} / step {step.name} / action {action.target or 'in place'}"
            made = etree.SubElement(element, "actionTypes")
            if self._action(made, action, own, label):
                made.set("id", str(number + 1))
                links.append((self._numbers[id(step)], number))
            else:
                element.remove(made)
        for reference, number in links:
            etree.SubElement(element, "actionLinks", step=reference, actionType=f"{path}/@actionTypes.{number}")

    def _action(self, made: etree._Element, action: ActionAssociation, own: str, label: str) -> bool:
        """Fill the element of an action; False where the format has none that does the same."""
        made.set("id", "1")
        if action.forcing is not None:
            made.set(XSI_TYPE, "grafcet:ForcingOrder")
            made.set("partialGrafcet", self._charts.get(action.forcing.chart.casefold(), ""))
            if action.forcing.steps:
                steps = [self._steps.get(name.casefold(), "") for name in action.forcing.steps]
                made.set("forcedSteps", " ".join(steps))
            word = next(word for word, each in _SITUATIONS.items() if each is action.forcing.situation)
            if word != "currentSituation":
                made.set("forcingOrderType", word)
            return True
        if action.kind is None or action.target is None or action.body is not None:
            self._lost("action", label, "a .grafcet file has actions of IEC 60848 on variables only")
            return False
        try:
            variable = etree.SubElement(made, "variable")
            self._terms.variable(variable, action.target, "11")
            stored = next((word for word, kind in _STORED.items() if kind is action.kind), None)
            made.set(XSI_TYPE, f"grafcet:{'StoredAction' if stored is not None else 'ContinuousAction'}")
            if stored is not None:
                if stored != "activation":
                    made.set("storedActionType", stored)
                value = ReadValue(action.value or "TRUE")
                self._terms.write(made, "value", value.tree, value, f"{own}/@value")
            elif action.value not in (None, "TRUE", "1"):
                raise TermError("a continuous action assigns TRUE")
            if action.kind is ActionKind.CONDITIONAL:
                made.set("continuousActionType", "assignationCondition")
            if action.kind in (ActionKind.DELAYED, ActionKind.LIMITED):
                _set_time(made, action.duration or "T#0s", "delayTime")
                word = "timeDelayed" if action.kind is ActionKind.DELAYED else "timeLimited"
                made.set("timeConditionType", word)
        except TermError as error:
            self._lost("action", label, str(error))
            return False
        self._condition(made, "term", action.condition, own, label)
        return True

    def _condition(self, made: etree._Element, tag: str, condition: Condition | None, own: str, label: str) -> None:
        if condition is None:
            return
        try:
            if not isinstance(condition, Expression):
                raise TermError("only an expression is a term")
            text = f"NOT ({condition.text})" if condition.negated else condition.text
            read = ReadCondition(text)
            if read.delay_of_all is not None:
                made.set("timeConditionType", "timeDependent")
                for time, name in ((read.delay_of_all.first, "delayTime"), (read.delay_of_all.last, "resetTime")):
                    if time is not None:
                        _set_time(made, time, name)
            self._terms.write(made, tag, read.tree, read, f"{own}/@{tag}")
        except TermError as error:
            self._lost("condition", label, str(error))
            for child in made.findall(tag):
                made.remove(child)

    def _lost(self, what: str, path: str, why: str) -> None:
        self._report.add(Outcome.NOT_EXECUTED, what, path, why)


class ReadValue(ReadCondition):
    """The value of a stored action: structured text, a number too."""

    def __init__(self, text: str) -> None:
        super().__init__("TRUE")
        self.tree = self._parsed(text)


def _arranged(items: Sequence[_Item], key: Callable[[_Item], Hashable], order: Sequence[Hashable]) -> list[_Item]:
    """Return `items` in the order of the file: new ones take the places of those that are gone, or come last."""
    waiting = {key(item): item for item in reversed(items)}
    new = [item for item in items if key(item) not in order]
    found: list[_Item] = []
    for each in dict.fromkeys(order):
        if each in waiting:
            found.append(waiting[each])
        elif new:
            found.append(new.pop(0))
    return found + new


_STEP_TAGS = ("steps", "macrosteps", "entryStep", "exitStep")
_INTEGER_TYPES = (Elementary.BOOL, Elementary.SINT, Elementary.INT, Elementary.DINT)


def _tag(step: Step, partial: PartialChart | None) -> str:
    if partial is not None and partial.kind is PartialChartKind.EXPANSION:
        if step.name == partial.entry_step:
            return "entryStep"
        if step.name == partial.exit_step:
            return "exitStep"
    return "macrosteps" if step.macro is not None and step.macro.expansion is not None else "steps"


def _id_of(step: Step, tag: str) -> str:
    letter = {"macrosteps": "M", "entryStep": "E", "exitStep": "S"}.get(tag, "")
    text = step.name.removeprefix(letter)
    return text if text.isdecimal() else str(step.number if step.number is not None else step.id)


def _texts(networks: Iterable[SfcNetwork]) -> Iterator[str]:
    for network in networks:
        conditions = [transition.condition for transition in network.transitions]
        for _, action in network.associations():
            conditions.append(action.condition)
            yield action.value or ""
            yield action.target or ""
        yield from (each.text for each in conditions if isinstance(each, Expression))


def _set_time(element: etree._Element, literal: str, name: str) -> None:
    """Set a time, in seconds where it and the one before are such. Raises `TermError`."""
    found = re.fullmatch(r"(?:L?T(?:IME)?#)?((?:\d+(?:\.\d+)?(?:ms|min|d|h|m|s))+)", literal, re.IGNORECASE)
    if found is None:
        raise TermError(f"{literal} is no time of a .grafcet file")
    factors = {"ms": 1, "s": 1000, "m": 60_000, "min": 60_000, "h": 3_600_000, "d": 86_400_000}
    parts = re.findall(r"(\d+(?:\.\d+)?)(ms|min|d|h|m|s)", found[1].lower())
    total = round(sum(float(amount) * factors[unit] for amount, unit in parts))
    if element.get("unit") == "ms" or total % 1000:
        for other in ("delayTime", "resetTime"):
            if element.get(other) is not None and element.get("unit") != "ms":
                element.set(other, str(int(element.get(other, "0")) * 1000))
        element.set("unit", "ms")
        element.set(name, str(total))
    else:
        element.set(name, str(total // 1000))
