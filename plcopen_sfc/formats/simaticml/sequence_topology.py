"""Branches and connections of GRAPH sequences, read into a drawing and written from it.

Branches are bars, jumps are jump symbols; `plcopen_sfc.model.wiring` derives what they mean for transitions, as for
every other format with drawings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from lxml import etree

from plcopen_sfc.formats.simaticml.added_elements import is_added
from plcopen_sfc.formats.simaticml.element_reader import (
    DocumentReading,
    Fields,
    NotUnderstoodError,
    children,
    keep_attribute,
)
from plcopen_sfc.formats.simaticml.sequence_rules import (
    ElementRef,
    SequenceLink,
    is_contractible,
    read_link,
    without_inserted,
)
from plcopen_sfc.formats.xml.extension_data import attributes_of
from plcopen_sfc.model.drawing import CONVERGENCES, STEPS, Drawing, Symbol, SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.wiring import trace
from plcopen_sfc.whole_numbers import canonical_number, whole_number

BRANCHES = {
    "AltBegin": SymbolKind.SELECTION_DIVERGENCE,
    "AltEnd": SymbolKind.SELECTION_CONVERGENCE,
    "SimBegin": SymbolKind.SIMULTANEOUS_DIVERGENCE,
    "SimEnd": SymbolKind.SIMULTANEOUS_CONVERGENCE,
}


@dataclass
class Topology:
    """Structure of the sequences of a block; symbols by the elements that they show."""

    symbols: dict[ElementRef, Fields] = field(default_factory=dict)
    jumps: list[Fields] = field(default_factory=list)
    paths: dict[int, list[tuple[int, int]]] = field(default_factory=dict)
    """Paths of each divergence: index and id of the consumer."""
    blocks: list[Fields] = field(default_factory=list)


CARDINALITY = "Cardinality"
"""Extension attribute of a branch, followed by the number of its paths: the number that the file gives."""


def added_in(element: etree._Element) -> set[ElementRef]:
    """Return the steps and transitions of ``Sequence`` that our writer inserted; none if they have been built on."""
    found: set[ElementRef] = set()
    for owner in element.iterfind("{*}Steps/{*}Step"):
        bare = not any(len(row) or row.attrib for row in owner.iterfind("{*}Actions/{*}Action"))
        if bare and canonical_number(owner.get("Number")) is not None and is_added(owner):
            found.add(ElementRef("S", int(owner.get("Number", ""))))
    for owner in element.iterfind("{*}Transitions/{*}Transition"):
        if canonical_number(owner.get("Number")) is not None and is_added(owner):
            found.add(ElementRef("T", int(owner.get("Number", ""))))
    if not found:
        return found
    try:
        links = [read_link(link) for link in element.iterfind("{*}Connections/{*}Connection")]
    except NotUnderstoodError:
        return set()
    return found if is_contractible(links, frozenset(found)) else set()


def usual_order(links: list[SequenceLink], symbols: list[ElementRef]) -> list[SequenceLink]:
    """Links in the order of `TopologyWriter`: by their target; jumps, then ends behind the others."""
    place = {ref: index for index, ref in enumerate(symbols)}

    def rank(link: SequenceLink) -> tuple[int, int, int]:
        if link.target is None:
            return 2, place.get(ElementRef(link.source.kind, link.source.number), 0), 0
        if link.is_jump:
            return 1, 0, 0
        return 0, place.get(ElementRef(link.target.kind, link.target.number), 0), link.target.path or 0

    return sorted(links, key=rank)


class TopologyReader:
    """Collects the symbols of all sequences of a chart, then derives the links of the transitions."""

    def __init__(self, ctx: DocumentReading, new_id: Callable[[], int]) -> None:
        self.ctx = ctx
        self.new_id = new_id
        """Returns an id that nothing in the chart has."""
        self.found = Topology()
        self.added: set[ElementRef] = set()
        """Steps and transitions that are not in the chart: see `sequence_rules`."""
        self.counts: list[tuple[Fields, int, etree._Element]] = []
        """Number of paths that the file gives for each branch."""

    def add(self, ref: ElementRef, kind: SymbolKind, number: int, element: etree._Element) -> None:
        """Add the symbol of a step or transition."""
        if ref in self.found.symbols:
            name = "step" if ref.kind == "S" else "transition"
            self.ctx.error("SFC101", f"the number {ref.number} belongs to two {name}s", element)
            return
        self.found.symbols[ref] = {"id": number, "kind": kind, "inputs": []}

    def add_actions(self, step: int, associations: list[int]) -> None:
        """Add the action block of a step, which has no place of its own in GRAPH."""
        entries = [{"association": number} for number in associations]
        wires = [{"connections": [{"source": step}]}]
        self.found.blocks.append(
            {"id": self.new_id(), "kind": SymbolKind.ACTION_BLOCK, "inputs": wires, "entries": entries}
        )

    def branch(self, element: etree._Element) -> None:
        """Read ``Branch``. Raises `NotUnderstoodError`."""
        number, count = whole_number(element.get("Number")), whole_number(element.get("Cardinality"))
        kind = BRANCHES.get(element.get("Type", ""))
        ref = ElementRef("B", number) if number is not None else None
        if kind is None or ref is None or count is None or len(element.attrib) > _BRANCH or len(element):
            raise NotUnderstoodError("branch")
        if ref in self.found.symbols:
            raise NotUnderstoodError("two branches of one number")
        fields: Fields = {"id": self.new_id(), "kind": kind, "inputs": [], "name": str(ref.number)}
        self.found.symbols[ref] = fields
        self.counts.append((fields, count, element))

    def connections(self, element: etree._Element) -> list[SequenceLink]:
        """Read ``Connections``. Raises `NotUnderstoodError` where one of them cannot be expressed."""
        links = [read_link(child) for child in children(element)]
        if self.added:
            links = without_inserted(links, frozenset(self.added))
        for link in links:
            self._connect(link, element)
        return links

    def _connect(self, link: SequenceLink, element: etree._Element) -> None:
        source = self._symbol(link.source, element)
        if link.target is None:
            return
        if source is None:
            raise NotUnderstoodError("a connection from nothing")
        target = self._symbol(link.target, element)
        if target is None:
            raise NotUnderstoodError("a connection to nothing")
        wire: Fields = {"source": source["id"]}
        if link.source.path is not None:
            wire["pin"] = str(link.source.path)
        if link.is_jump:
            jump = {"id": self.new_id(), "kind": SymbolKind.JUMP, "target": target["id"]}
            self.found.jumps.append({**jump, "inputs": [{"connections": [wire]}]})
            target = self.found.jumps[-1]
        else:
            pins = target["inputs"]
            path = link.target.path or 0
            while len(pins) <= min(path, _MOST_PATHS):
                pins.append({"connections": []})
            pins[min(path, _MOST_PATHS)]["connections"].append(wire)
        self.found.paths.setdefault(source["id"], []).append((link.source.path or 0, target["id"]))

    def _symbol(self, ref: ElementRef, element: etree._Element) -> Fields | None:
        found = self.found.symbols.get(ElementRef(ref.kind, ref.number))
        if found is None:
            names = {"S": "step", "T": "transition", "B": "branch"}
            message = f"a connection names the {names[ref.kind]} {ref.number}, which is not there"
            self.ctx.error("SFC102", message, element)
        return found

    def finish(self, chart: Fields) -> None:
        """Put the drawing into the chart, and its links into the transitions."""
        for branch, count, element in self.counts:
            joins = branch["kind"] in (SymbolKind.SELECTION_CONVERGENCE, SymbolKind.SIMULTANEOUS_CONVERGENCE)
            found = len(branch["inputs"] if joins else self.found.paths.get(branch["id"], ()))
            if found != count:
                message = f"the branch {branch['name']} has {found} paths, but its Cardinality is {count}"
                self.ctx.error("SFC113", message, element)
                keep_attribute(branch, f"{CARDINALITY} of {found}", str(count))
        symbols = [*self.found.symbols.values(), *self.found.blocks, *self.found.jumps]
        chart["drawing"] = {"symbols": symbols}
        inputs = {s["id"]: [w["source"] for pin in s["inputs"] for w in pin["connections"]] for s in symbols}
        wiring = trace({s["id"]: s["kind"] for s in symbols}, inputs, {j["id"]: j["target"] for j in self.found.jumps})
        ranks: dict[int, int] = {}
        for paths in self.found.paths.values():
            if len(paths) > 1:
                ranks.update((consumer, rank + 1) for rank, (_, consumer) in enumerate(sorted(paths)))
        for transition in chart["transitions"]:
            links = wiring.links.get(transition["id"], [])
            if len(links) > 1:
                raise NotUnderstoodError("steps that meet before a transition in an alternative branch")
            if links:
                transition["sources"], transition["targets"] = list(links[0].sources), list(links[0].targets)
            if transition["id"] in ranks:
                transition["priority"] = ranks[transition["id"]]


_BRANCH = 3
_MOST_PATHS = 255
"""S7-GRAPH allows 249 paths; a number beyond that in a damaged file must not fill the memory."""


_TYPES = {kind: name for name, kind in BRANCHES.items()}


class TopologyWriter:
    """Branches and connections of a chart."""

    def __init__(self, chart: SfcNetwork, drawing: Drawing, steps: dict[int, int], transitions: dict[int, int]) -> None:
        self.symbols = {symbol.id: symbol for symbol in drawing.symbols}
        self.priorities = {t.id: t.priority for t in chart.transitions}
        self.numbers = self._branch_numbers()
        self.steps, self.transitions = steps, transitions
        self.paths: dict[int, dict[int, int]] = {}
        """Of each divergence the index of the path to each consumer."""
        self._owners: dict[int, tuple[str, int]] = {}
        for symbol in self.symbols.values():
            if symbol.kind in _TYPES and symbol.kind not in CONVERGENCES:
                self.paths[symbol.id] = self._paths(symbol)

    def _branch_numbers(self) -> dict[int, int]:
        branches = [symbol for symbol in self.symbols.values() if symbol.kind in _TYPES]
        named = {symbol.id: number for symbol in branches if (number := whole_number(symbol.name)) is not None}
        unique = len({*named.values()}) == len(named)
        numbers: dict[int, int] = {}
        following = max(named.values(), default=0) + 1 if unique else 1
        for symbol in branches:
            if unique and symbol.id in named:
                numbers[symbol.id] = named[symbol.id]
            else:
                numbers[symbol.id] = following
                following += 1
        return numbers

    def _paths(self, branch: Symbol) -> dict[int, int]:
        """Return the paths of a divergence: in the order of their priority, then as drawn."""
        found: list[tuple[int, int, int, int]] = []
        for place, symbol in enumerate(self.symbols.values()):
            for pin in symbol.inputs:
                for wire in pin.connections:
                    if wire.source == branch.id:
                        number = whole_number(wire.pin)
                        drawn = place if number is None else number
                        priority = self.priorities.get(symbol.id)
                        found.append((priority is None, priority or 0, drawn, symbol.id))
        if branch.kind is SymbolKind.SIMULTANEOUS_DIVERGENCE:  # its consumers are steps, which have no priority
            found.sort(key=lambda path: path[2])
        else:
            found.sort()
        return {number: index for index, (*_, number) in enumerate(found)}

    def branches(self) -> Iterator[tuple[Symbol, dict[str, str]]]:
        """Yield every branch with the attributes of its element."""
        for symbol in self.symbols.values():
            if symbol.kind in _TYPES:
                count = str(len(self.paths[symbol.id]) if symbol.id in self.paths else len(symbol.inputs))
                kept = attributes_of(symbol.extension_data)
                count = kept.get(f"{CARDINALITY} of {count}", count)
                attributes = {"Number": str(self.numbers[symbol.id]), "Type": _TYPES[symbol.kind], "Cardinality": count}
                yield symbol, attributes

    def types(self) -> dict[int, str]:
        """Return the type of each branch by its number."""
        return {
            self.numbers[symbol.id]: _TYPES[symbol.kind] for symbol in self.symbols.values() if symbol.kind in _TYPES
        }

    def links(self) -> list[SequenceLink]:
        """Return every connection, in the order of the symbols that they lead to."""
        found: list[SequenceLink] = []
        leaving: set[int] = set()
        for symbol in self.symbols.values():
            if symbol.kind in (SymbolKind.ACTION_BLOCK, SymbolKind.EXPRESSION):
                continue
            for index, pin in enumerate(symbol.inputs):
                for wire in pin.connections:
                    link = self._link(symbol, index, wire.source)
                    if link is not None:
                        found.append(link)
                        leaving.add(wire.source)
        for symbol in self.symbols.values():
            if symbol.kind is SymbolKind.TRANSITION and symbol.id not in leaving and symbol.id in self.transitions:
                found.append(SequenceLink(ElementRef("T", self.transitions[symbol.id]), None))
        return found

    def leads_from(self, branch: int, members: set[tuple[str, int]]) -> bool:
        """True if a branch belongs to a sequence: one of `members` is connected with it."""
        if not self._owners:
            for link in self.links():
                for one, other in ((link.source, link.target), (link.target, link.source)):
                    if one is not None and other is not None and one.kind == "B" and other.kind != "B":
                        self._owners.setdefault(one.number, (other.kind, other.number))
        return self._owners.get(branch) in members

    def _link(self, symbol: Symbol, index: int, source: int) -> SequenceLink | None:
        origin = self._ref(source)
        if origin is None:
            return None
        if source in self.paths:
            origin = ElementRef(origin.kind, origin.number, self.paths[source][symbol.id])
        elif origin.kind == "B":
            origin = ElementRef(origin.kind, origin.number, 0)
        is_jump = symbol.kind is SymbolKind.JUMP
        target = self._ref(symbol.target if is_jump else symbol.id)
        if target is None:
            return SequenceLink(origin, None)
        if target.kind == "B":
            target = ElementRef(target.kind, target.number, index if symbol.kind in CONVERGENCES else 0)
        return SequenceLink(origin, target, is_jump)

    def _ref(self, number: int | None) -> ElementRef | None:
        symbol = self.symbols.get(number) if number is not None else None
        if symbol is None:
            return None
        if symbol.kind in STEPS:
            return ElementRef("S", self.steps[symbol.id]) if symbol.id in self.steps else None
        if symbol.kind is SymbolKind.TRANSITION:
            return ElementRef("T", self.transitions[symbol.id]) if symbol.id in self.transitions else None
        return ElementRef("B", self.numbers[symbol.id]) if symbol.id in self.numbers else None
