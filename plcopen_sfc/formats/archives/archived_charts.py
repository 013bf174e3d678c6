"""Charts as archives of TwinCAT 3, read and written.

When a chart is written, its drawing of a chart, in which every divergence has its convergence, is cut into the segments
and branches of the archive. Elements have the ids of the model as their numbers; segments and attributes, which are
nothing in the model, keep the numbers of the file that is patched, and get new ones behind all others where they have
none there.

A chart is a tree in the archive: a segment is a column of steps, transitions, branches, macros and a jump at its end; a
branch holds segments side by side, which meet at its end without a word. The same chart in an export of PLCopen XML has
the wires and bars of this tree written out, so it becomes the same drawing, and `DrawnChart` finds what it means. A
macro only folds a part of its segment: its elements are those of the chart, and the chart keeps where it was.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from lxml import etree

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.formats.archives.chart_elements import (
    ASSOCIATION,
    BRANCH,
    ELEMENTS,
    JUMP,
    MACRO,
    SEGMENT,
    STEP,
    TRANSITION,
    Fields,
    add_descriptions,
    attribute_numbers,
    missing_attributes,
    objection,
    read_attributes,
    written_attribute,
)
from plcopen_sfc.formats.archives.object_archive import (
    add_dictionary,
    add_list,
    add_none,
    add_text,
    add_value,
    archive_of,
    entries,
    items,
    kept_data,
    kept_in,
    member,
    new_object,
    number_of,
    text_of,
    type_of,
)
from plcopen_sfc.formats.codesys.codesys_codec import LACKS
from plcopen_sfc.formats.plcopen.tc6_chart_meaning import DrawnChart, Line
from plcopen_sfc.formats.plcopen.tc6_reading import Tc6ReadContext
from plcopen_sfc.formats.xml.extension_data import extension_data
from plcopen_sfc.grouping import grouped
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.chart_settings import RuntimeLibrary, SfcFlag, SfcSettings
from plcopen_sfc.model.conditions import Expression, NamedCondition
from plcopen_sfc.model.drawing import CONVERGENCES, DIVERGENCES, STEPS, Symbol, SymbolKind
from plcopen_sfc.model.exclusion import IS_EXECUTED, told_by_others
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Step, Transition
from plcopen_sfc.model.text import plain
from plcopen_sfc.report import Outcome
from plcopen_sfc.whole_numbers import whole_number

VARIABLE_NAME = "VariableName"
"""The name of the implicit variable of a transition, which is nothing in the model."""

_EMBEDDED = {
    STEP: ("EmbeddedMainAction", "EmbeddedEntryAction", "EmbeddedExitAction"),
    TRANSITION: ("EmbeddedTransition",),
}
_MEMBERS = frozenset({"Attributes", "Id", "IdParent", "ElementList", "Segment", VARIABLE_NAME}).union(
    *({name, f"{name}Properties"} for names in _EMBEDDED.values() for name in names)
)
"""Members that elements have in known files."""
_BARS = {
    False: (SymbolKind.SELECTION_DIVERGENCE, SymbolKind.SELECTION_CONVERGENCE),
    True: (SymbolKind.SIMULTANEOUS_DIVERGENCE, SymbolKind.SIMULTANEOUS_CONVERGENCE),
}
_IDS: Any = etree.XPath("descendant::v[@n='Id']/text()", smart_strings=False)
_FLOW_PIN = "sfc"
"""Name of the output that exports of PLCopen XML give wires into transitions and convergences."""


class ChartReader:
    """Reads one chart. `conditions` are the names of the transition objects of its POU, in lower case."""

    def __init__(self, ctx: Tc6ReadContext, conditions: frozenset[str]) -> None:
        self._ctx = ctx
        self._conditions = conditions
        self._drawn = DrawnChart(ctx)
        self._macros: list[etree._Element] = []
        self._associations: set[int] = set()
        self._next = 0

    def read(self, chart: etree._Element) -> Fields:
        """Return the fields of the chart in an ``SFCImplementationObject``."""
        texts = _IDS(chart)
        numbers = [whole_number(text.removesuffix("L")) for text in texts]
        self._next = max((number for number in numbers if number is not None), default=-1) + 1
        root = member(chart, "Root")
        if root is None:
            self._ctx.error("TWC101", "the chart has no segment", chart)
        else:
            if len(set(texts)) < len(texts):
                self._tell_numbers(root)
            self._segment(root, None)
        fields = self._drawn.interpret()
        if self._macros:
            extension_data(fields)["data"] += kept_data({}, self._macros)
        return fields

    def _tell_numbers(self, root: etree._Element) -> None:
        """Report attributes with the number of an element or of another attribute; `_symbol` reports elements."""
        found = grouped((value.text or "", value) for value in root.iter("v") if value.get("n") == "Id")
        for text, values in found.items():
            holders = [(each, each.getparent()) for each in values]
            own = [each for each, holder in holders if holder is not None and type_of(holder) == "SFCAttribute"]
            for value in own[0 if len(own) < len(values) else 1 :]:
                message = f"an attribute has the number {text.removesuffix('L')}, which another one has"
                self._ctx.warn("TWC105", message, value)

    def _segment(self, segment: etree._Element, above: int | None) -> int | None:
        """Read a segment below the symbol `above`; return the symbol at its end."""
        if type_of(segment) != SEGMENT:
            kind = type_of(segment) or "nothing"
            self._ctx.error("TWC102", f"a segment of the type {kind} is not understood", segment)
        left, unknown = self._attributes(segment, SEGMENT)
        if left or unknown:
            self._ctx.error("TWC102", "a segment has a name or a comment, or is excluded: not understood", segment)
        self._refuse(segment, SEGMENT, [])
        for element in self._elements(segment, "a segment"):
            kind = type_of(element)
            if kind == BRANCH:
                above = self._branch(element, above)
            elif kind == MACRO:
                above = self._macro(element, above)
            elif kind in _READERS:
                fields, unknown = self._attributes(element, kind)
                self._refuse(element, kind, unknown)
                above = _READERS[kind](self, element, fields, above)
            else:
                self._ctx.error("TWC102", f"an element of the type {kind or 'nothing'} is not understood", element)
        return above

    def _attributes(self, element: etree._Element, kind: str) -> tuple[Fields, list[etree._Element]]:
        """Return what `read_attributes` does; reports an element without a list for them."""
        if member(element, "Attributes") is None:
            self._ctx.error("TWC101", f"an element of the type {kind} has no list of attributes", element)
        else:
            for name in missing_attributes(element, kind):
                self._ctx.error("TWC102", f"an element of the type {kind} lacks the attribute {name}", element)
        return read_attributes(element, kind)

    def _elements(self, holder: etree._Element, what: str) -> list[etree._Element]:
        """Return what is in a segment, a branch or a step; reports one without a list for it."""
        held = member(holder, "ElementList")
        if held is None or member(held, "InnerList") is None:
            self._ctx.error("TWC101", f"{what} has no list of elements", holder)
            return []
        return items(held, "InnerList")

    def _refuse(self, element: etree._Element, kind: str, unknown: list[etree._Element]) -> None:
        """Report the content of an element that is not understood, and that the tool may execute."""
        for attribute in unknown:
            self._ctx.error("TWC102", objection(attribute, kind), attribute)
        embedded = _EMBEDDED.get(kind, ())
        seen: set[str] = set()
        for child in element:
            name = child.get("n") or ""
            if name in seen:
                self._ctx.error("TWC102", f"{name} is given twice in an element", child)
            seen.add(name)
            if name in embedded and child.tag != "n":
                self._ctx.error("TWC102", f"{name}: code that is embedded in an element is not understood", child)
            elif name not in _MEMBERS and isinstance(child.tag, str):
                self._ctx.error("TWC102", f"{name or child.tag}: no known file has it in an element", child)

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
        wire = {"source": above, "pin": _FLOW_PIN} if named else {"source": above}
        symbol.setdefault("inputs", []).append({"connections": [wire]})

    def _step(self, element: etree._Element, fields: Fields, above: int | None) -> int:
        symbol = self._symbol(element, SymbolKind.STEP, above)
        symbol["outputs"] = [{"name": _FLOW_PIN}]
        number: int = symbol["id"]
        step: Fields = {"name": "", "actions": [], **fields, "symbol_fields": symbol}
        if not step["name"]:
            self._ctx.error("TWC102", "a step has no name", element)
        self._drawn.steps.append(step)
        lines = [self._association(each) for each in self._elements(element, f"the step {step['name']}")]
        if lines:
            symbol["action_output"] = {"name": "x"}
            block = self._symbol(element, SymbolKind.ACTION_BLOCK, number, own=False)
            self._drawn.blocks.append((block, element, lines))
        return number

    def _association(self, element: etree._Element) -> Line:
        if type_of(element) != ASSOCIATION:
            kind = type_of(element) or "nothing"
            self._ctx.error("TWC102", f"an association of the type {kind} is not understood", element)
        fields, unknown = self._attributes(element, ASSOCIATION)
        self._refuse(element, ASSOCIATION, unknown)
        association: Fields = {"target": fields.pop("name", "")}
        if not association["target"]:
            self._ctx.error("TWC102", "an association names no action", element)
        word, _, duration = fields.pop("qualifier", "N").partition(" ")
        association["qualifier"] = _QUALIFIERS.get(word.upper())
        if association["qualifier"] is None:
            self._ctx.error("TWC102", f"{word or 'nothing'} is no qualifier", element)
            association["qualifier"] = Qualifier.NONE
        if duration.strip():
            association["duration"] = duration.strip()
        number = number_of(member(element, "Id"))
        if number is None or number in self._associations:
            problem = "has no number" if number is None else f"has the number {number}, which another one has"
            self._ctx.error("SFC101", f"an association {problem}", element)
        else:
            self._associations.add(number)
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
        fields, unknown = self._attributes(element, BRANCH)
        self._refuse(element, BRANCH, unknown)
        divergence, convergence = _BARS[fields.pop("parallel", False)]
        bar = self._symbol(element, divergence, above)
        bar.update(fields)
        segments = self._elements(element, "a branch")
        bar["outputs"] = [{"name": _FLOW_PIN} for _ in segments]
        ends = [self._segment(segment, bar["id"]) for segment in segments]
        closing = self._symbol(element, convergence, None, own=False)
        closing["outputs"] = [{}]
        for end in ends:
            if end is not None:
                self._wire(closing, end)
        return int(closing["id"])

    def _macro(self, element: etree._Element, above: int | None) -> int | None:
        fields, unknown = self._attributes(element, MACRO)
        self._refuse(element, MACRO, unknown)
        inside = member(element, "Segment")
        held = member(inside, "ElementList") if inside is not None else None
        found = items(held, "InnerList") if held is not None else []  # `_segment` reports one without
        if inside is None or not found:
            self._ctx.error("TWC102", "a macro has nothing in it", element)
            return above
        numbers = [number_of(member(each, "Id")) for each in found]
        kept = {"elements": " ".join(str(number) for number in numbers if number is not None)}
        kept |= {"id": str(number_of(member(element, "Id")) or 0)}
        kept |= {name: str(value) for name, value in fields.items()}
        before = len(self._drawn.steps), len(self._drawn.transitions)
        above = self._segment(inside, above)
        if "exclude" in fields:
            for thing in (*self._drawn.steps[before[0] :], *self._drawn.transitions[before[1] :]):
                thing["exclude"] = True
        self._macros.append(etree.Element("macro", kept))  # inner ones first
        return above


_NAMED_WIRES = frozenset({SymbolKind.TRANSITION, SymbolKind.SELECTION_CONVERGENCE, SymbolKind.SIMULTANEOUS_CONVERGENCE})
_QUALIFIERS = {qualifier.value.upper(): qualifier for qualifier in Qualifier}
_READERS = {STEP: ChartReader._step, TRANSITION: ChartReader._transition, JUMP: ChartReader._jump}


# -- settings ---------------------------------------------------------------------------------------------------------


def read_settings(ctx: Tc6ReadContext, settings: etree._Element) -> Fields | None:
    """Return the fields of the SFC settings in an ``SFCProperty``; None where it is none."""
    if type_of(settings) != "SFCProperty":
        ctx.error("TWC102", "properties of a chart that are not understood: the tool may execute them", settings)
        return None
    lacking = [name for name in (*LIBRARY.values(), *SWITCHES.values()) if text_of(member(settings, name)) is None]
    lacking += ["Flags"] if member(settings, "Flags") is None else []
    for name in lacking:
        ctx.error("TWC102", f"the settings of a chart lack {name}", settings)
    flags = items(settings, "Flags")
    names = [text_of(each) for each in flags[::2]]
    if len(flags) % 2 or not all(names) or len(set(names)) < len(names):
        ctx.error("TWC102", "the flags of a chart are no names with a value for each", settings)
    fields: Fields = {"flags": {}, "other_flags": {}}
    library = {name: text_of(member(settings, title)) for name, title in LIBRARY.items()}
    if any(value is not None for value in library.values()):
        fields["library"] = {name: value or "" for name, value in library.items()}
    for name, title in SWITCHES.items():
        if text_of(member(settings, title)) is not None:
            fields[name] = _truth(ctx, settings, title, title)
    for flag, data in entries(settings, "Flags"):
        use = {name: _truth(ctx, data, name.capitalize(), f"the flag {flag}") for name in ("use", "declare")}
        fields["flags" if flag in _FLAGS else "other_flags"][flag] = use
        if use["use"] and flag not in _FLAGS:
            ctx.report("TWC102", Severity.WARNING, f"{flag} is no SFC flag that any known file has", data)
    return fields


def _truth(ctx: Tc6ReadContext, holder: etree._Element, name: str, what: str) -> bool:
    """Return a member that is ``true`` or ``false``; reports one that is neither, and is taken for FALSE."""
    text = text_of(member(holder, name))
    if text not in ("true", "false"):
        ctx.error("TWC102", f"{what}: {name} is {text or 'without a value'}, and neither true nor false", holder)
    return text == "true"


LIBRARY = {"title": "Title", "company": "Company", "version": "Version", "namespace": "Namespace"}
SWITCHES = {"active_transitions_only": "CalcActiveTransOnly", "use_defaults": "UseDefaults"}
_FLAGS = {flag.value for flag in SfcFlag}


Note = Callable[[Outcome, str, str, str], None]
"""Reports what became of something at a place in the chart: outcome, what, place, why."""

_FLOW = STEPS | DIVERGENCES | CONVERGENCES | {SymbolKind.TRANSITION, SymbolKind.JUMP}
_NUMBERED = DIVERGENCES | {SymbolKind.JUMP}
"""The symbols that are elements of the archive, besides steps and transitions."""
_NO_PLACE = "charts of CODESYS are nested branches from one start on, and this is in none of them"


class ArchiveNumbers:
    """Numbers of what is nothing in the model: segments, by the first element in them, and attributes of elements.

    `archive` is that of the file which is patched, `chart` the one that is written.
    """

    def __init__(self, archive: etree._Element | None, chart: SfcNetwork) -> None:
        self._attributes: dict[tuple[int, str], int] = {}
        self._segments: dict[int, int] = {}
        self.bare: set[int] = set()
        """The elements that have no attributes in the file; older versions wrote segments so."""
        used = [step.id for step in chart.steps] + [transition.id for transition in chart.transitions]
        used += [association.id for _, association in chart.associations()]
        symbols = chart.drawing.symbols if chart.drawing is not None else []
        used += [symbol.id for symbol in symbols if symbol.kind in _NUMBERED]
        used += [whole_number(each.get("id")) or 0 for each in kept_in(chart.extension_data).elements]
        self._elements = frozenset(used)
        for element in archive.iter("o") if archive is not None else ():
            number = number_of(member(element, "Id"))
            if number is None:
                continue
            used.append(number)
            kind = type_of(element)
            if kind in ELEMENTS:
                own = dict(attribute_numbers(element))
                self._attributes |= {(number, guid): mine for guid, mine in own.items()}
                self.bare |= set() if own else {number}
            held = member(element, "ElementList") if kind == SEGMENT else None
            first = next(iter(items(held, "InnerList")), None) if held is not None else None
            if first is not None and (inner := number_of(member(first, "Id"))) is not None:
                self._segments[inner] = number
        self._next = max(used, default=-1) + 1

    def new(self) -> int:
        """Return a number that nothing has."""
        self._next += 1
        return self._next - 1

    def segment(self, first: int | None) -> int:
        """Return the number of the segment that begins with the element `first`."""
        known = self._segments.get(first) if first is not None else None
        return known if known is not None and known not in self._elements else self.new()

    def attribute(self, element: int, guid: str) -> int:
        """Return the number of an attribute of an element."""
        known = self._attributes.get((element, guid))
        # a new symbol may have the number that an attribute or a segment has in the file
        return known if known is not None and known not in self._elements else self.new()


@dataclass
class _Segment:
    """A segment that is to be written: its elements, with the branches and macros in it."""

    parts: list[Symbol | _Branch | _Macro] = field(default_factory=list)


@dataclass
class _Branch:
    bar: Symbol
    segments: list[_Segment] = field(default_factory=list)


@dataclass
class _Macro:
    number: int
    fields: dict[str, object]
    segment: _Segment


def _number(part: Symbol | _Branch | _Macro) -> int:
    match part:
        case _Branch(bar=bar):
            return bar.id
        case _Macro(number=number):
            return number
        case _:
            return part.id


class ChartWriter:
    """Writes one chart; `archive` is that of the file which is patched, if it has one."""

    def __init__(self, chart: SfcNetwork, archive: etree._Element | None, note: Note) -> None:
        self._chart = chart
        self._note = note
        self._numbers = ArchiveNumbers(archive, chart)
        self._steps = {step.id: step for step in chart.steps}
        self._transitions = {transition.id: transition for transition in chart.transitions}
        self._symbols = {symbol.id: symbol for symbol in chart.drawing.symbols} if chart.drawing is not None else {}
        flow = [symbol for symbol in self._symbols.values() if symbol.kind in _FLOW]
        self._followers = grouped(
            (connection.source, symbol.id) for symbol in flow for pin in symbol.inputs for connection in pin.connections
        )
        self._placed: set[int] = set()
        self._told = told_by_others(chart)

    def write(self) -> etree._Element:
        """Return the ``XmlArchive`` of the chart."""
        start = next((symbol for symbol in self._symbols.values() if symbol.kind in STEPS), None)
        root, _ = self._column(start.id if start is not None else None)
        self._report_missing()
        for macro in self._macros():
            self._fold(root, macro)
        self._exclude_macros(root)
        implementation = new_object("SFCImplementationObject")
        implementation.append(self._segment(root, -1, "Root"))
        add_descriptions(implementation)
        return archive_of(implementation, ("Boolean", "Guid", "Int64", "String"))

    def _report_missing(self) -> None:
        for step in self._chart.steps:
            if step.id not in self._placed:
                self._note(Outcome.NOT_EXECUTED, "step", f"step {step.name}", _NO_PLACE)
        drawn = {
            number
            for symbol in self._symbols.values()
            if symbol.id in self._placed
            for number in symbol.transitions or [symbol.id]
        }
        for number, label in self._chart.labels().items():
            if number not in drawn:
                self._note(Outcome.NOT_EXECUTED, "transition", f"transition {label}", _NO_PLACE)

    # -- from the drawing to segments -------------------------------------------------------------------------------

    def _column(self, start: int | None) -> tuple[_Segment, int | None]:
        """Return the segment from a symbol on, and the convergence that it ends at."""
        segment = _Segment()
        here = start
        while here is not None and here not in self._placed:
            symbol = self._symbols[here]
            if symbol.kind in CONVERGENCES:
                return segment, here
            self._placed.add(here)
            if symbol.kind not in DIVERGENCES:
                segment.parts.append(symbol)
                here = self._below(here)
                continue
            branch = _Branch(symbol)
            segment.parts.append(branch)
            ends: list[int] = []
            for follower in self._followers.get(here, ()):
                column, end = self._column(follower)
                branch.segments.append(column)
                ends += [end] if end is not None and end not in ends else []
            closing = ends[0] if ends else None
            if len(ends) > 1:
                why = "branches beside each other do not end together, which charts of CODESYS cannot say"
                self._note(Outcome.NOT_EXECUTED, "branch", "", why)
            if closing is not None:
                self._placed.add(closing)
            here = self._below(closing) if closing is not None else None
        return segment, None

    def _below(self, number: int) -> int | None:
        """Return the symbol below one; where several are, only the first is drawn below it."""
        followers = self._followers.get(number, [])
        return followers[0] if followers else None

    def _macros(self) -> Iterator[dict[str, str]]:
        """Yield the kept parts of the macros of the chart, inner ones first."""
        for macro in kept_in(self._chart.extension_data).elements:
            yield {str(name): str(value) for name, value in macro.attrib.items()}

    def _fold(self, segment: _Segment, macro: dict[str, str]) -> bool:
        """Fold the elements of a macro that still are there, with all between them; True if they were found here."""
        own = {*macro.get("elements", "").split()}
        places = [place for place, part in enumerate(segment.parts) if str(_number(part)) in own]
        if places:
            first, last = places[0], places[-1]
            inside = _Segment(segment.parts[first : last + 1])
            fields: dict[str, object] = {name: macro[name] for name in ("name", "comment") if name in macro}
            fields["exclude"] = "exclude" in macro
            segment.parts[first : last + 1] = [_Macro(whole_number(macro.get("id")) or 0, fields, inside)]
            return True
        inner = [one for part in segment.parts if isinstance(part, _Branch) for one in part.segments]
        inner += [part.segment for part in segment.parts if isinstance(part, _Macro)]
        return any(self._fold(one, macro) for one in inner)

    def _exclude_macros(self, segment: _Segment) -> set[int]:
        """Let excluded macros tell the exclusion of what is in them; return the steps and transitions of a segment."""
        held: set[int] = set()
        for part in segment.parts:
            match part:
                case _Branch(segments=segments):
                    held = held.union(*map(self._exclude_macros, segments))
                case _Macro(fields=fields, segment=inside):
                    own = self._exclude_macros(inside)
                    held |= own
                    if fields["exclude"]:
                        things = [self._steps.get(each) or self._transitions[each] for each in own]
                        fields["exclude"] = all(thing.exclude for thing in things)
                        self._told |= own if fields["exclude"] else set()
                case Symbol(id=number, kind=kind) if kind in STEPS or kind is SymbolKind.TRANSITION:
                    held.add(number)
        return held

    # -- from segments to the archive -------------------------------------------------------------------------------

    def _segment(self, segment: _Segment, parent: int, name: str = "") -> etree._Element:
        written = new_object(SEGMENT, name)
        number = self._numbers.segment(_number(segment.parts[0]) if segment.parts else None)
        held = new_object("SFCElementList", "ElementList")
        add_list(held, "InnerList", [self._part(part, number) for part in segment.parts])
        written.append(held)
        return self._finished(written, SEGMENT, number, parent, {})

    def _part(self, part: Symbol | _Branch | _Macro, parent: int) -> etree._Element:
        match part:
            case _Branch(bar=bar, segments=segments):
                written = new_object(BRANCH)
                held = new_object("SFCElementList", "ElementList")
                add_list(held, "InnerList", [self._segment(one, bar.id) for one in segments])
                written.append(held)
                values = {**self._drawn(bar), "parallel": bar.kind is SymbolKind.SIMULTANEOUS_DIVERGENCE}
                return self._finished(written, BRANCH, bar.id, parent, values)
            case _Macro(number=number, fields=fields, segment=segment):
                written = new_object(MACRO)
                written.append(self._segment(segment, number, "Segment"))
                return self._finished(written, MACRO, number, parent, fields)
        if part.kind in STEPS:
            return self._step(self._steps[part.id], parent)
        if part.kind is SymbolKind.TRANSITION:
            return self._transition(self._transitions[part.id], parent)
        target = self._symbols.get(part.target) if part.target is not None else None
        name = self._steps[target.id].name if target is not None and target.id in self._steps else None
        name = name or (target.name if target is not None else None) or part.name or ""
        return self._finished(new_object(JUMP), JUMP, part.id, parent, {**self._drawn(part), "name": name})

    def _step(self, step: Step, parent: int) -> etree._Element:
        for what, lacking in (("macro-step", step.macro), ("negated step output", step.negated or None)):
            if lacking is not None:
                self._note(Outcome.NOT_EXECUTED, what, f"step {step.name}", "charts of CODESYS have none")
        written = new_object(STEP)
        add_none(written, "EmbeddedMainAction", "EmbeddedEntryAction", "EmbeddedExitAction")
        for action in ("Main", "Entry", "Exit"):
            add_list(written, f"Embedded{action}ActionProperties")
        held = new_object("SFCElementList", "ElementList")
        add_list(held, "InnerList", [self._association(step, each) for each in step.actions])
        written.append(held)
        values = self._values(step, STEP)
        for action in ("main_action", "entry_action", "exit_action"):
            if values[action] is not None and not isinstance(values[action], str):
                why = "step actions in CODESYS are actions of the POU, not code in place"
                self._note(Outcome.NOT_EXECUTED, action.replace("_", " "), f"step {step.name}", why)
                values[action] = None
        self._note(Outcome.KEPT, "step", f"step {step.name}", "")
        return self._finished(written, STEP, step.id, parent, values)

    def _association(self, step: Step, association: ActionAssociation) -> etree._Element:
        qualifier = association.qualifier.value
        place = f"step {step.name} / action {association.target or 'inline'}"
        lacking = [name for name in ("body", "value", "event", "forcing") if getattr(association, name) is not None]
        lacking += [name for name in ("negated", "interlock") if getattr(association, name)]
        if f"qualifier {qualifier}" in LACKS:
            why = f"CODESYS offers {_OFFERED}, and may not read this"
            outcome = Outcome.APPROXIMATED if qualifier in _PULSES else Outcome.NOT_EXECUTED
            self._note(outcome, f"qualifier {qualifier}", place, why)
        for what in lacking:
            self._note(Outcome.NOT_EXECUTED, what, place, "associations of actions in CODESYS have none")
        self._note(Outcome.KEPT, "action", place, "")
        values = self._values(association, ASSOCIATION)
        values["name"] = association.target
        values["qualifier"] = " ".join(filter(None, (qualifier, association.duration)))
        return self._finished(new_object(ASSOCIATION), ASSOCIATION, association.id, step.id, values)

    def _transition(self, transition: Transition, parent: int) -> etree._Element:
        written = new_object(TRANSITION)
        variable = kept_in(transition.extension_data).attributes.get(VARIABLE_NAME)
        if variable is not None:
            add_text(written, VARIABLE_NAME, variable)
        else:
            add_none(written, VARIABLE_NAME)
        add_none(written, "EmbeddedTransition")
        add_list(written, "EmbeddedTransitionProperties")
        place = f"transition {self._chart.label(transition)}"
        condition = transition.condition
        text = transition.shown_condition
        if getattr(condition, "negated", False) or not isinstance(condition, Expression | NamedCondition | None):
            text = "condition_is_not_written"  # which does not compile
            why = "conditions in CODESYS are expressions and transition objects; nothing that is right can be written"
            self._note(Outcome.NOT_EXECUTED, "condition", place, why)
        self._note(Outcome.KEPT, "transition", place, "")
        values = {**self._values(transition, TRANSITION), "name": text}
        return self._finished(written, TRANSITION, transition.id, parent, values)

    def _values(self, thing: Step | Transition | ActionAssociation, kind: str) -> dict[str, Any]:
        """Return the values of the fields that an element has in the model."""
        values = {name: getattr(thing, name, None) for name in ELEMENTS[kind]}
        return {**values, "comment": plain(thing.comment), "exclude": thing.exclude and thing.id not in self._told}

    def _drawn(self, symbol: Symbol) -> dict[str, Any]:
        exclude = symbol.exclude and symbol.id not in self._told
        if symbol.exclude and not exclude:
            self._note(Outcome.TRANSLATED, "exclude", symbol.name or "", IS_EXECUTED)
        return {"name": symbol.name, "comment": plain(symbol.comment), "exclude": exclude}

    def _finished(
        self, written: etree._Element, kind: str, number: int, parent: int, values: dict[str, Any]
    ) -> etree._Element:
        """Append what every element ends with: its attributes, its number, and that of the element around it."""
        listed = [
            written_attribute(
                attribute,
                values.get(name),
                number=self._numbers.attribute(number, attribute.guid),
                parent=number,
            )
            for name, attribute in (ELEMENTS[kind].items() if number not in self._numbers.bare else ())
        ]
        add_list(written, "Attributes", listed)
        add_value(written, "Id", f"{number}L")
        add_value(written, "IdParent", f"{parent}L")
        return written


_OFFERED = "N R S L D P SD DS SL"
_PULSES = frozenset({"P0", "P1", "DL"})
"""Qualifiers of IEC 61131-3 and TC6 that an archive can hold; no file shows one."""


# -- settings ---------------------------------------------------------------------------------------------------------


def write_settings(settings: SfcSettings) -> etree._Element:
    """Return the ``XmlArchive`` of the SFC settings of a POU or an action."""
    written = new_object("SFCProperty")
    add_none(written, "SFCErrorAnalyzation", "SFCErrorAnalyzationTable")
    library = settings.library or RuntimeLibrary()
    for name, title in LIBRARY.items():
        add_text(written, title, getattr(library, name))
    flags = {}
    for flag, use in {**{flag.value: use for flag, use in settings.flags.items()}, **settings.other_flags}.items():
        flags[flag] = new_object("SFCPropertyFlagData")
        add_value(flags[flag], "Use", str(use.use).lower())
        add_value(flags[flag], "Declare", str(use.declare).lower())
    add_dictionary(written, "Flags", ("Flags", "SFCPropertyFlagData"), flags)
    for name, title in SWITCHES.items():
        value = getattr(settings, name)
        add_value(written, title, str(bool(value)).lower())
    return archive_of(written, ("Boolean", "Flags", "String"))
