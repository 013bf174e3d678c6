"""Reader of charts in archives of TwinCAT 3.

A chart is a tree there: a segment is a column of steps, transitions, branches, macros and a jump at its end; a branch
holds segments side by side, which meet at its end without a word. The same chart in an export of PLCopen XML has the
wires and bars of this tree written out, so it becomes the same drawing, and `DrawnChart` finds what it means.
A macro only folds a part of its segment: its elements are those of the chart, and the chart keeps where it was.
"""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.formats.plcopen.tc6_chart_meaning import DrawnChart, Line
from plcopen_sfc.formats.plcopen.tc6_reading import Tc6ReadContext, extension_data
from plcopen_sfc.formats.twincat.chart_elements import (
    ASSOCIATION,
    BRANCH,
    JUMP,
    MACRO,
    SEGMENT,
    STEP,
    TRANSITION,
    Fields,
    read_attributes,
)
from plcopen_sfc.formats.twincat.kept_data import kept_data
from plcopen_sfc.formats.twincat.object_archive import entries, items, member, number_of, text_of, type_of
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.sfc import SfcFlag

VARIABLE_NAME = "VariableName"
"""The name of the implicit variable of a transition, which is nothing in the model."""

_EMBEDDED = {
    STEP: ("EmbeddedMainAction", "EmbeddedEntryAction", "EmbeddedExitAction"),
    TRANSITION: ("EmbeddedTransition",),
}
_BARS = {
    False: (SymbolKind.SELECTION_DIVERGENCE, SymbolKind.SELECTION_CONVERGENCE),
    True: (SymbolKind.SIMULTANEOUS_DIVERGENCE, SymbolKind.SIMULTANEOUS_CONVERGENCE),
}
_FLOW = "sfc"
"""Name of the output that exports of PLCopen XML give wires into transitions and convergences."""


class ChartReader:
    """Reads one chart. `conditions` are the names of the transition objects of its POU, in lower case."""

    def __init__(self, ctx: Tc6ReadContext, conditions: frozenset[str]) -> None:
        self._ctx = ctx
        self._conditions = conditions
        self._drawn = DrawnChart(ctx)
        self._macros: list[etree._Element] = []
        self._next = 0

    def read(self, chart: etree._Element) -> Fields:
        """Return the fields of the chart in an ``SFCImplementationObject``."""
        numbers = [number_of(value) for value in chart.iter("v") if value.get("n") == "Id"]
        self._next = max((number for number in numbers if number is not None), default=-1) + 1
        root = member(chart, "Root")
        if root is None:
            self._ctx.error("TWC101", "the chart has no segment", chart)
        else:
            self._segment(root, None)
        fields = self._drawn.interpret()
        if self._macros:
            extension_data(fields)["data"] += kept_data({}, self._macros)
        return fields

    def _segment(self, segment: etree._Element, above: int | None) -> int | None:
        """Read a segment below the symbol `above`; returns the symbol at its end."""
        left, unknown = read_attributes(segment, SEGMENT)
        if left or unknown:
            self._ctx.error("TWC102", "a segment has a name or a comment, or is excluded: not understood", segment)
        held = member(segment, "ElementList")
        for element in items(held, "InnerList") if held is not None else ():
            kind = type_of(element)
            if kind == BRANCH:
                above = self._branch(element, above)
            elif kind == MACRO:
                above = self._macro(element, above)
            elif kind in _READERS:
                fields, unknown = read_attributes(element, kind)
                self._refuse(element, kind, unknown)
                above = _READERS[kind](self, element, fields, above)
            else:
                self._ctx.error("TWC102", f"an element of the type {kind or 'nothing'} is not understood", element)
        return above

    def _refuse(self, element: etree._Element, kind: str, unknown: list[etree._Element]) -> None:
        """Report what an element has that is not understood, and that the tool may execute."""
        for attribute in unknown:
            guid = text_of(member(attribute, "AttributeId"))
            self._ctx.error("TWC102", f"the attribute {guid} of an element is not understood", attribute)
        for name in _EMBEDDED.get(kind, ()):
            found = member(element, name)
            if found is not None and found.tag != "n":
                self._ctx.error("TWC102", f"{name}: code that is embedded in an element is not understood", found)

    def _symbol(self, element: etree._Element, kind: SymbolKind, above: int | None, *, own: bool = True) -> Fields:
        """Take in a symbol that the symbol `above` leads to; not `own`: it has no element and no number itself."""
        number = number_of(member(element, "Id")) if own else None
        if own and (number is None or number in self._drawn.ids.used):
            problem = "has no number" if number is None else f"has the number {number}, which another one has"
            self._ctx.error("SFC101", f"an element {problem}", element)
            number = None
        if number is None:
            number, self._next = self._next, self._next + 1
        symbol: Fields = {"kind": kind, "id": number}
        if above is not None:
            self._wire(symbol, above)
        self._drawn.take(element, symbol)
        return symbol

    def _wire(self, symbol: Fields, above: int) -> None:
        named = symbol["kind"] in _NAMED_WIRES
        wire = {"source": above, "pin": _FLOW} if named else {"source": above}
        symbol.setdefault("inputs", []).append({"connections": [wire]})

    def _step(self, element: etree._Element, fields: Fields, above: int | None) -> int:
        symbol = self._symbol(element, SymbolKind.STEP, above)
        symbol["outputs"] = [{"name": _FLOW}]
        number: int = symbol["id"]
        step: Fields = {"name": "", "actions": [], **fields, "symbol_fields": symbol}
        self._drawn.steps.append(step)
        held = member(element, "ElementList")
        lines = [self._association(each) for each in items(held, "InnerList")] if held is not None else []
        if lines:
            symbol["action_output"] = {"name": "x"}
            block = self._symbol(element, SymbolKind.ACTION_BLOCK, number, own=False)
            self._drawn.blocks.append((block, element, lines))
        return number

    def _association(self, element: etree._Element) -> Line:
        fields, unknown = read_attributes(element, ASSOCIATION)
        self._refuse(element, ASSOCIATION, unknown)
        association: Fields = {"target": fields.pop("name", "")}
        word, _, duration = fields.pop("qualifier", "N").partition(" ")
        association["qualifier"] = _QUALIFIERS.get(word.upper())
        if association["qualifier"] is None:
            self._ctx.error("TWC102", f"{word or 'nothing'} is no qualifier", element)
            association["qualifier"] = Qualifier.NONE
        if duration.strip():
            association["duration"] = duration.strip()
        number = number_of(member(element, "Id"))
        return {**association, **fields}, {"output": {}}, str(number) if number is not None else None

    def _transition(self, element: etree._Element, fields: Fields, above: int | None) -> int:
        text = fields.pop("name", "")
        condition: Fields | None = {"kind": "expression", "text": text} if text else None
        drawn: Fields = {}
        if text.casefold() in self._conditions:
            condition = {"kind": "named", "name": text}
        elif text:  # a symbol of its own, as in PLCopen XML
            expression = self._symbol(element, SymbolKind.EXPRESSION, None, own=False)
            expression["outputs"] = [{}]
            drawn["condition"] = {"connections": [{"source": expression["id"]}]}
        symbol = self._symbol(element, SymbolKind.TRANSITION, above)
        symbol.update(drawn)
        transition: Fields = {**fields, "symbol_fields": symbol}
        if condition is not None:
            transition["condition"] = condition
        name = text_of(member(element, VARIABLE_NAME))
        if name is not None:
            extension_data(transition)["data"] += kept_data({VARIABLE_NAME: name})
        self._drawn.transitions.append(transition)
        return int(symbol["id"])

    def _jump(self, element: etree._Element, fields: Fields, above: int | None) -> int:
        symbol = self._symbol(element, SymbolKind.JUMP, above)
        symbol.update({"name": "", **fields})
        return int(symbol["id"])

    def _branch(self, element: etree._Element, above: int | None) -> int | None:
        fields, unknown = read_attributes(element, BRANCH)
        self._refuse(element, BRANCH, unknown)
        divergence, convergence = _BARS[fields.pop("parallel", False)]
        bar = self._symbol(element, divergence, above)
        bar.update(fields)
        held = member(element, "ElementList")
        segments = items(held, "InnerList") if held is not None else []
        bar["outputs"] = [{"name": _FLOW} for _ in segments]
        ends = [self._segment(segment, bar["id"]) for segment in segments]
        closing = self._symbol(element, convergence, None, own=False)
        closing["outputs"] = [{}]
        for end in ends:
            if end is not None:
                self._wire(closing, end)
        return int(closing["id"])

    def _macro(self, element: etree._Element, above: int | None) -> int | None:
        fields, unknown = read_attributes(element, MACRO)
        self._refuse(element, MACRO, unknown)
        if "exclude" in fields:
            self._ctx.error("TWC102", "a macro is excluded, which is not understood", element)
        inside = member(element, "Segment")
        held = member(inside, "ElementList") if inside is not None else None
        found = items(held, "InnerList") if held is not None else []
        if inside is None or not found:
            self._ctx.error("TWC102", "a macro has nothing in it", element)
            return above
        ends = {"first": member(found[0], "Id"), "last": member(found[-1], "Id")}
        kept = {name: str(number) for name, value in ends.items() if (number := number_of(value)) is not None}
        kept |= {"id": str(number_of(member(element, "Id")) or 0)}
        kept |= {name: str(value) for name, value in fields.items() if name != "exclude"}
        above = self._segment(inside, above)
        self._macros.append(etree.Element("macro", kept))  # inner ones first
        return above


_NAMED_WIRES = frozenset({SymbolKind.TRANSITION, SymbolKind.SELECTION_CONVERGENCE, SymbolKind.SIMULTANEOUS_CONVERGENCE})
_QUALIFIERS = {qualifier.value.upper(): qualifier for qualifier in Qualifier}
_READERS = {STEP: ChartReader._step, TRANSITION: ChartReader._transition, JUMP: ChartReader._jump}


# -- settings ---------------------------------------------------------------------------------------------------------


def read_settings(ctx: Tc6ReadContext, settings: etree._Element) -> Fields | None:
    """Return the fields of the SFC settings in an ``SFCProperty``; None where it is none."""
    if type_of(settings) != "SFCProperty":
        ctx.report("TWC102", Severity.WARNING, "properties of an object that are not understood", settings)
        return None
    fields: Fields = {"flags": {}, "other_flags": {}}
    library = {name: text_of(member(settings, title)) for name, title in LIBRARY.items()}
    if any(value is not None for value in library.values()):
        fields["library"] = {name: value or "" for name, value in library.items()}
    for name, title in SWITCHES.items():
        text = text_of(member(settings, title))
        if text in ("true", "false"):
            fields[name] = text == "true"
    for flag, data in entries(settings, "Flags"):
        use = {name: text_of(member(data, name.capitalize())) == "true" for name in ("use", "declare")}
        fields["flags" if flag in _FLAGS else "other_flags"][flag] = use
    return fields


LIBRARY = {"title": "Title", "company": "Company", "version": "Version", "namespace": "Namespace"}
SWITCHES = {"active_transitions_only": "CalcActiveTransOnly", "use_defaults": "UseDefaults"}
_FLAGS = {flag.value for flag in SfcFlag}
