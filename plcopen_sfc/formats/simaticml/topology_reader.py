"""Reads the branches and connections of GRAPH sequences into a drawing. The writer is `topology_writer`.

Branches are bars, jumps are jump symbols; what they mean for transitions is said by `plcopen_sfc.model.wiring`, as for
every other format with drawings.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from lxml import etree

from plcopen_sfc.formats.simaticml.added import is_added
from plcopen_sfc.formats.simaticml.reading import (
    Fields,
    NotUnderstoodError,
    ReadContext,
    carry_attribute,
    children,
    whole_number,
)
from plcopen_sfc.formats.simaticml.topology import Link, Ref, read_link
from plcopen_sfc.formats.simaticml.topology_rules import contracted, is_contractible
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.wiring import trace

BRANCHES = {
    "AltBegin": SymbolKind.SELECTION_DIVERGENCE,
    "AltEnd": SymbolKind.SELECTION_CONVERGENCE,
    "SimBegin": SymbolKind.SIMULTANEOUS_DIVERGENCE,
    "SimEnd": SymbolKind.SIMULTANEOUS_CONVERGENCE,
}


@dataclass
class Topology:
    """What the sequences of a block say of their structure; symbols by what they stand for."""

    symbols: dict[Ref, Fields] = field(default_factory=dict)
    jumps: list[Fields] = field(default_factory=list)
    legs: dict[int, list[tuple[int, int]]] = field(default_factory=dict)
    """The legs of each divergence: index and id of the consumer."""
    blocks: list[Fields] = field(default_factory=list)


CARDINALITY = "Cardinality"
"""Carried attribute of a branch, with the number of its legs behind it: what the file says that number is."""


def added_in(element: etree._Element) -> set[Ref]:
    """The steps and transitions of ``Sequence`` that our writer put in; none where somebody has built on them."""
    found: set[Ref] = set()
    for owner in element.iterfind("{*}Steps/{*}Step"):
        bare = not any(len(row) or row.attrib for row in owner.iterfind("{*}Actions/{*}Action"))
        if bare and whole_number(owner.get("Number")) is not None and is_added(owner):
            found.add(Ref("S", int(owner.get("Number", ""))))
    for owner in element.iterfind("{*}Transitions/{*}Transition"):
        if whole_number(owner.get("Number")) is not None and is_added(owner):
            found.add(Ref("T", int(owner.get("Number", ""))))
    if not found:
        return found
    try:
        links = [read_link(link) for link in element.iterfind("{*}Connections/{*}Connection")]
    except NotUnderstoodError:
        return set()
    return found if is_contractible(links, frozenset(found)) else set()


def usual_order(links: list[Link], symbols: list[Ref]) -> list[Link]:
    """Links in the order of `topology_writer`: by their target; jumps, then ends behind the others."""
    place = {ref: index for index, ref in enumerate(symbols)}

    def rank(link: Link) -> tuple[int, int, int]:
        if link.target is None:
            return 2, place.get(Ref(link.source.kind, link.source.number), 0), 0
        if link.is_jump:
            return 1, 0, 0
        return 0, place.get(Ref(link.target.kind, link.target.number), 0), link.target.leg or 0

    return sorted(links, key=rank)


class TopologyReader:
    """Collects the symbols of all sequences of a chart, then says what the transitions mean."""

    def __init__(self, ctx: ReadContext, new_id: object) -> None:
        self.ctx = ctx
        self._new_id = new_id
        self.found = Topology()
        self.added: set[Ref] = set()
        """Steps and transitions that are none of the chart: see `topology_rules`."""
        self.counts: list[tuple[Fields, int, etree._Element]] = []
        """Of each branch how many legs it says to have."""

    def new_id(self) -> int:
        """An id that nothing in the chart has."""
        number: int = self._new_id()  # type: ignore[operator]  # a plain callable
        return number

    def add(self, ref: Ref, kind: SymbolKind, number: int, element: etree._Element) -> None:
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
        number, count = element.get("Number", ""), element.get("Cardinality", "")
        kind = BRANCHES.get(element.get("Type", ""))
        ref = Ref("B", int(number)) if number.isdigit() else None
        if kind is None or ref is None or not count.isdigit() or len(element.attrib) > _BRANCH or len(element):
            raise NotUnderstoodError("branch")
        if ref in self.found.symbols:
            raise NotUnderstoodError("two branches of one number")
        fields: Fields = {"id": self.new_id(), "kind": kind, "inputs": [], "name": str(ref.number)}
        self.found.symbols[ref] = fields
        self.counts.append((fields, int(count), element))

    def connections(self, element: etree._Element) -> list[Link]:
        """Read ``Connections``. Raises `NotUnderstoodError` where one of them cannot be said."""
        links = [read_link(child) for child in children(element)]
        if self.added:
            links = contracted(links, frozenset(self.added))
        for link in links:
            self._connect(link, element)
        return links

    def _connect(self, link: Link, element: etree._Element) -> None:
        source = self._symbol(link.source, element)
        if link.target is None:
            return
        if source is None:
            raise NotUnderstoodError("a connection from nothing")
        target = self._symbol(link.target, element)
        if target is None:
            raise NotUnderstoodError("a connection to nothing")
        wire: Fields = {"source": source["id"]}
        if link.source.leg is not None:
            wire["pin"] = str(link.source.leg)
        if link.is_jump:
            jump = {"id": self.new_id(), "kind": SymbolKind.JUMP, "target": target["id"]}
            self.found.jumps.append({**jump, "inputs": [{"connections": [wire]}]})
            target = self.found.jumps[-1]
        else:
            pins = target["inputs"]
            leg = link.target.leg or 0
            while len(pins) <= min(leg, _MOST_LEGS):
                pins.append({"connections": []})
            pins[min(leg, _MOST_LEGS)]["connections"].append(wire)
        self.found.legs.setdefault(source["id"], []).append((link.source.leg or 0, target["id"]))

    def _symbol(self, ref: Ref, element: etree._Element) -> Fields | None:
        found = self.found.symbols.get(Ref(ref.kind, ref.number))
        if found is None:
            names = {"S": "step", "T": "transition", "B": "branch"}
            message = f"a connection names the {names[ref.kind]} {ref.number}, which is not there"
            self.ctx.error("SFC102", message, element)
        return found

    def finish(self, chart: Fields) -> None:
        """Put the drawing into the chart, and what it means into its transitions."""
        for branch, count, element in self.counts:
            joins = branch["kind"] in (SymbolKind.SELECTION_CONVERGENCE, SymbolKind.SIMULTANEOUS_CONVERGENCE)
            found = len(branch["inputs"] if joins else self.found.legs.get(branch["id"], ()))
            if found != count:
                message = f"the branch {branch['name']} says to have {count} legs, and has {found}"
                self.ctx.error("SFC113", message, element)
                carry_attribute(branch, f"{CARDINALITY} of {found}", str(count))
        symbols = [*self.found.symbols.values(), *self.found.blocks, *self.found.jumps]
        chart["drawing"] = {"symbols": symbols}
        inputs = {s["id"]: [w["source"] for pin in s["inputs"] for w in pin["connections"]] for s in symbols}
        wiring = trace({s["id"]: s["kind"] for s in symbols}, inputs, {j["id"]: j["target"] for j in self.found.jumps})
        ranks: dict[int, int] = {}
        for legs in self.found.legs.values():
            if len(legs) > 1:
                ranks.update((consumer, rank + 1) for rank, (_, consumer) in enumerate(sorted(legs)))
        for transition in chart["transitions"]:
            links = wiring.links.get(transition["id"], [])
            if len(links) > 1:
                raise NotUnderstoodError("steps that meet before a transition in an alternative branch")
            if links:
                transition["sources"], transition["targets"] = list(links[0].sources), list(links[0].targets)
            if transition["id"] in ranks:
                transition["priority"] = ranks[transition["id"]]


_BRANCH = 3
_MOST_LEGS = 255
"""S7-GRAPH allows 249 paths; a number beyond that in a damaged file must not fill the memory."""
