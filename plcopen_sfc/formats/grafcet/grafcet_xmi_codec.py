"""``.grafcet`` files of the open editor for GRAFCETs (AGRAFE): EMF XMI, references by position.

``//@partialGrafcets.1/@steps.0`` is the first step of the second chart. References are resolved when a file is read,
and made of the positions of steps, variables and charts when it is written. Arcs and synchronizations are the several
steps of a transition. `grafcet_xmi_reader` reads them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from typing import TypeVar

from lxml import etree

from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.grafcet.condition_notation import expression_of, with_condition
from plcopen_sfc.formats.grafcet.grafcet_xmi_reader import (
    SECTIONS,
    SITUATIONS,
    STORED,
    TYPES,
    UNNAMED,
    XmiOrder,
    XmiReader,
    bar_of,
    keys_in,
)
from plcopen_sfc.formats.grafcet.grafcet_xmi_terms import XSI_TYPE, ReadCondition, TermError, TermWriter
from plcopen_sfc.formats.grafcet.sfc_losses import action_of_sfc, report_unexpressed, tags_of
from plcopen_sfc.formats.remainder_comments import lacking
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK
from plcopen_sfc.formats.xml.xml_codec import XmlCodec, XmlStyle
from plcopen_sfc.formats.xml.xml_parsing import parse_xml
from plcopen_sfc.languages.grafcet_conditions import OVERLINE
from plcopen_sfc.model.actions import ActionKind
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Condition, PartialChart, PartialChartKind, SfcNetwork, Step
from plcopen_sfc.model.types import Elementary, SimpleValue
from plcopen_sfc.model.variables import sections_of
from plcopen_sfc.report import ConversionReport, Outcome

_XMI = "http://www.omg.org/XMI"
_NAMESPACES = {
    "xmi": _XMI,
    "xsi": "http://www.w3.org/2001/XMLSchema-instance",
    "grafcet": "http://www.example.org/grafcet",
    "terms": "http://www.example.org/terms",
}
_Item = TypeVar("_Item")


class XmiWriter:
    """Writes the GRAFCET of `pou`; what is referred to by position stays in the `order` of the file."""

    def __init__(self, project: Project, pou: Pou | None, report: ConversionReport, order: XmiOrder) -> None:
        self._pou = pou
        self._tags = tags_of(project, pou) if pou is not None else {}
        self._objects = pou.transitions if pou is not None else []
        self._order = order
        self._report = report
        namespaces = _NAMESPACES | order.namespaces
        self._root = etree.Element(f"{{{namespaces['grafcet']}}}Grafcet", nsmap=namespaces)
        self._root.set(f"{{{_XMI}}}version", "2.0")
        self._charts: dict[str, str] = {}
        self._steps: dict[str, str] = {}
        self._terms = TermWriter({})
        self._numbers: dict[int, str] = {}

    def run(self) -> etree._Element:
        """Return the root of the file."""
        pou = self._pou
        if pou is None or pou.chart is None:
            return self._root
        if pou.name != UNNAMED:
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

    def _variables(self, pou: Pou, networks: Sequence[SfcNetwork]) -> None:
        container = etree.SubElement(self._root, "variableDeclarationContainer")
        positions: dict[str, str] = {}
        words = {kind: word for word, kind in SECTIONS.items()}
        declared = [(v, s.kind) for s in sections_of(pou.interface) for v in s.variables]
        declared += [(v, kind) for kind, variables in self._tags.items() for v in variables]
        texts = " ".join(_texts(networks)).replace(OVERLINE, "")
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
            sort = {TYPES["Bool"]: "Bool"}.get(getattr(variable.type, "name", None), "Integer")  # type: ignore[arg-type]
            if kind not in words or getattr(variable.type, "name", None) not in _INTEGER_TYPES:
                self._lost(
                    "variable", f"POU {pou.name} / {variable.name}", "a .grafcet file has BOOL and integers only"
                )
            entries.append((variable.name, words.get(kind, "internal"), sort))
        known = {name.casefold() for name, _, _ in entries}
        times = dict.fromkeys(name for text in _conditions(networks) for name in _times_in(text))
        entries += [(name, "input", "Bool") for name in times if name.casefold() not in known]
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
        labels = network.labels()
        for number, transition in enumerate(network.transitions):
            made = etree.SubElement(element, "transitions")
            made.set("id", str(transition.number if transition.number is not None else number + 1))
            label = f"{where} / transition {labels[transition.id]}"
            condition = expression_of(network, transition.condition, self._objects) or transition.condition
            self._condition(made, condition, f"{path}/@transitions.{number}", label)
        self._arcs(element, path, network)
        self._actions(element, path, network, where)

    def _networks(self) -> Iterator[SfcNetwork]:
        chart = self._pou.chart if self._pou is not None else None
        if chart is not None:
            yield chart
            yield from (partial.chart for partial in chart.partial_charts)

    def _arcs(self, element: etree._Element, path: str, network: SfcNetwork) -> None:
        steps, labels = keys_in(network)
        references = {steps[step.id]: self._numbers[id(step)] for step in network.steps}
        arcs: list[tuple[Hashable, Hashable]] = []
        bars: list[Hashable] = []
        for number, transition in enumerate(network.transitions):
            own = labels[transition.id]
            references[own] = f"{path}/@transitions.{number}"
            for ids, before in ((transition.sources, True), (transition.targets, False)):
                ends = [steps[each] for each in ids if each in steps]
                bar = own
                if len(ends) > 1:
                    bar = bar_of(transition, steps, joins=before)
                    bars.append(bar)
                    arcs.append((bar, own) if before else (own, bar))
                arcs += [(end, bar) if before else (bar, end) for end in ends]
        for number, bar in enumerate(_arranged(bars, lambda bar: bar, self._order.bars.get(path, []))):
            references[bar] = f"{path}/@synchronizations.{number}"
            etree.SubElement(element, "synchronizations")
        for source, target in _arranged(arcs, lambda arc: arc, self._order.arcs.get(path, [])):
            etree.SubElement(element, "arcs", source=references[source], target=references[target])

    def _actions(self, element: etree._Element, path: str, network: SfcNetwork, where: str) -> None:
        links: list[tuple[str, int]] = []
        found = [(step, index, action) for step in network.steps for index, action in enumerate(step.actions)]
        order = self._order.actions.get(path, [])
        for step, _, action in _arranged(found, lambda each: (each[0].name, each[1]), order):
            number = len(links)
            own = f"{path}/@actionTypes.{number}"
            label = f"{where} / step {step.name} / action {action.target or 'in place'}"
            made = etree.SubElement(element, "actionTypes")
            if self._action(made, with_condition(network, step, action, self._objects), own, label):
                made.set("id", str(number + 1))
                links.append((self._numbers[id(step)], number))
            else:
                element.remove(made)
        for step in network.steps:
            for kind in ("entry", "main", "exit"):
                if getattr(step, f"{kind}_action") is not None:
                    self._lost("action", f"{where} / step {step.name} / {kind} action", _STATEMENTS)
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
            word = next(word for word, each in SITUATIONS.items() if each is action.forcing.situation)
            if word != "currentSituation":
                made.set("forcingOrderType", word)
            return True
        named = self._pou.find_action(action.target or "") if self._pou is not None else None
        if action.target is None or action.body is not None or named is not None:
            self._lost("action", label, _STATEMENTS)
            return False
        kind, value = action.kind, action.value
        if kind is None:
            translated = action_of_sfc(action, label, self._report, is_program=False)
            if translated is None:
                return False
            kind, value = translated
            if kind is ActionKind.CONTINUOUS and action.condition is not None:
                kind = ActionKind.CONDITIONAL
        try:
            variable = etree.SubElement(made, "variable")
            self._terms.variable(variable, action.target, "11")
            stored = next((word for word, each in STORED.items() if each is kind), None)
            made.set(XSI_TYPE, f"grafcet:{'StoredAction' if stored is not None else 'ContinuousAction'}")
            if stored is not None:
                if stored != "activation":
                    made.set("storedActionType", stored)
                read = ReadValue(value or "TRUE")
                self._terms.write(made, "value", read.tree, read, f"{own}/@value")
            elif value not in (None, "TRUE", "1"):
                raise TermError("a continuous action assigns TRUE")
            if kind is ActionKind.CONDITIONAL:
                made.set("continuousActionType", "assignationCondition")
            if kind in (ActionKind.DELAYED, ActionKind.LIMITED):
                _set_time(made, action.duration or "T#0s", "delayTime")
                word = "timeDelayed" if kind is ActionKind.DELAYED else "timeLimited"
                made.set("timeConditionType", word)
        except TermError as error:
            self._lost("action", label, str(error))
            return False
        self._condition(made, action.condition, own, label)
        return True

    def _condition(self, made: etree._Element, condition: Condition | None, own: str, label: str) -> None:
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
            self._terms.write(made, "term", read.tree, read, f"{own}/@term")
            for time in read.times():
                why = f"terms have no times: `{time}` is an input of this name there, as people declare it"
                self._report.add(Outcome.APPROXIMATED, "time", label, why)
        except TermError as error:
            self._lost("condition", label, str(error))
            for child in made.findall("term"):
                made.remove(child)

    def _lost(self, what: str, path: str, why: str) -> None:
        self._report.add(Outcome.NOT_EXECUTED, what, path, why)


_STATEMENTS = "a .grafcet file has actions on variables only, none with statements"


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


def _conditions(networks: Iterable[SfcNetwork]) -> Iterator[str]:
    for network in networks:
        conditions = [transition.condition for transition in network.transitions]
        conditions += [action.condition for _, action in network.associations()]
        yield from (each.text for each in conditions if isinstance(each, Expression))


def _times_in(text: str) -> list[str]:
    try:
        return ReadCondition(text).times()
    except TermError:
        return []  # it is not written


def _texts(networks: Sequence[SfcNetwork]) -> Iterator[str]:
    for network in networks:
        for _, action in network.associations():
            yield action.value or ""
            yield action.target or ""
    yield from _conditions(networks)


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


class GrafcetXmiCodec(XmlCodec):
    """``.grafcet`` files."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file. Raises `FormatError` where a reference leads nowhere."""
        return XmiReader(parse_xml(data, file=file), file).run()

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """Return the tree of the file for `project`; what it has no place for is in comments."""
        found = [pou for pou in project.pous if pou.chart is not None]
        order = XmiOrder()
        if options.source:  # references are positions: what the file has stays in its order
            reader = XmiReader(parse_xml(options.source), None)
            reader.run()
            order = reader.order
        root = XmiWriter(project, found[0] if found else None, report, order).run()
        for pou in found[1:]:
            report.add(Outcome.NOT_EXECUTED, "chart", f"POU {pou.name}", "a .grafcet file has one GRAFCET")
        for variable in found[0].variables() if found and not options.same else ():
            start = (variable.initial.text if isinstance(variable.initial, SimpleValue) else None) or "0"
            if start.upper() not in ("FALSE", "0"):
                why = f"variables of a .grafcet file have no start value: it does not begin with {start}"
                report.add(Outcome.NOT_EXECUTED, "initial value", f"POU {found[0].name} / {variable.name}", why)
        back = XmiReader(root, None).run().project
        for change, path in lacking(back, project):
            report.add(
                Outcome.EXTENSION_DATA, change.field, path, "a .grafcet file has no place for it; it is in a comment"
            )
            # XML allows no two hyphens in a comment
            root.append(etree.Comment(f"{COMMENT_MARK}{change} ".replace("--", "-$2D").replace("--", "-$2D")))
        return root

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Report the behaviour of charts of tools that a GRAFCET does not have."""
        report_unexpressed(project, report)

    def style(self) -> XmlStyle:
        """As EMF writes: UTF-8 without a mark, LF, two blanks, ``<a/>``."""
        return XmlStyle(encoding="UTF-8", newline="\n", self_closing="/>", final_newline=True)

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        reader = XmiReader(parse_xml(content), None)
        reader.run()
        return reader.lines


CODEC = GrafcetXmiCodec()
