"""The connections of a GRAPH sequence, as records: what `topology_reader` reads and `topology_writer` writes."""

from __future__ import annotations

import re
from dataclasses import dataclass

from lxml import etree

from plcopen_sfc.formats.simaticml.reading import NotUnderstoodError, children, local
from plcopen_sfc.formats.simaticml.writing import sub

_LETTERS = {"StepRef": "S", "TransitionRef": "T", "BranchRef": "B"}
_NAMES = {letter: name for name, letter in _LETTERS.items()}
_NODE = re.compile(r"([STB])(-?\d+)(?:\.(-?\d+))?")
END = "end"
"""How the end of a sequence is written in the order of connections."""


@dataclass(frozen=True)
class Ref:
    """A step (``S``), a transition (``T``) or a branch (``B``) by its number; `leg`: the in or output of a branch."""

    kind: str
    number: int
    leg: int | None = None

    def __str__(self) -> str:
        return f"{self.kind}{self.number}" + (f".{self.leg}" if self.leg is not None else "")


@dataclass(frozen=True)
class Link:
    """A connection; `target` None: the sequence ends there."""

    source: Ref
    target: Ref | None
    is_jump: bool = False

    def __str__(self) -> str:
        return f"{self.source}{'~' if self.is_jump else '-'}{self.target if self.target is not None else END}"


def read_link(element: etree._Element) -> Link:
    """Read ``Connection``. Raises `NotUnderstoodError`."""
    parts = {local(child): child for child in children(element)}
    if element.attrib or any(part.attrib for part in parts.values()):
        raise NotUnderstoodError("connection")
    kind = (parts["LinkType"].text or "") if "LinkType" in parts else ""
    if (
        len(element) != len(parts)
        or parts.keys() != {"NodeFrom", "NodeTo", "LinkType"}
        or kind not in ("Direct", "Jump")
    ):
        raise NotUnderstoodError("connection")
    source = _node(parts["NodeFrom"], "Out")
    if source is None:
        raise NotUnderstoodError("connection")
    return Link(source, _node(parts["NodeTo"], "In"), kind == "Jump")


def _node(element: etree._Element, side: str) -> Ref | None:
    found = children(element)
    if len(found) == 1 and local(found[0]) == "EndConnection" and not found[0].attrib and not len(found[0]):
        return None
    letter = _LETTERS.get(local(found[0]), "") if len(found) == 1 else ""
    number, leg = (found[0].get("Number", ""), found[0].get(side)) if letter else ("", None)
    usual = {"Number", side} if leg is not None else {"Number"}
    if not number.isdigit() or (leg is not None and not leg.isdigit()) or set(found[0].attrib) != usual:
        raise NotUnderstoodError("a node of a connection")
    return Ref(letter, int(number), int(leg) if leg is not None else None)


def write_link(parent: etree._Element, link: Link) -> None:
    """Write ``Connection``."""
    element = sub(parent, "Connection")
    _write_node(sub(element, "NodeFrom"), link.source, "Out")
    _write_node(sub(element, "NodeTo"), link.target, "In")
    sub(element, "LinkType").text = "Jump" if link.is_jump else "Direct"


def _write_node(parent: etree._Element, ref: Ref | None, side: str) -> None:
    if ref is None:
        sub(parent, "EndConnection")
        return
    leg = {side: str(ref.leg)} if ref.leg is not None else {}
    sub(parent, _NAMES[ref.kind], {"Number": str(ref.number), **leg})
