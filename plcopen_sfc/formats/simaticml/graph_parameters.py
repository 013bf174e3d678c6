"""What the interface of a GRAPH block has from the system: its base, and the parameters that operate the sequencer.

A block that was made in a script or comes from another tool has none of it. It gets the standard parameter set, marked
as added, so that it is gone again when the file is read. TIA Portal adds the data of steps and transitions itself.
"""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.simaticml.added import keep_added
from plcopen_sfc.formats.simaticml.reading import local
from plcopen_sfc.formats.simaticml.writing import WriteContext, sub
from plcopen_sfc.report import Outcome

_PARAMETERS = {
    "Input": {
        **dict.fromkeys(("OFF_SQ", "INIT_SQ", "ACK_EF", "S_PREV", "S_NEXT"), "Bool"),
        **dict.fromkeys(("SW_AUTO", "SW_TAP", "SW_TOP", "SW_MAN"), "Bool"),
        "S_SEL": "Int",
        **dict.fromkeys(("S_ON", "S_OFF", "T_PUSH"), "Bool"),
    },
    "Output": {
        "S_NO": "Int",
        **dict.fromkeys(("S_MORE", "S_ACTIVE", "ERR_FLT", "AUTO_ON", "TAP_ON", "TOP_ON", "MAN_ON"), "Bool"),
    },
}
"""The standard parameter set (S7-GRAPH V6, TIA Portal V14 SP1 to V21)."""
_OPERATING = frozenset({"off_sq", "init_sq"})
"""A block with one of these has a parameter set of its own."""
_BEHIND = {"Input": ("Base",), "Output": ("Base", "Input")}


def add_system_parts(ctx: WriteContext, sections: etree._Element) -> None:
    """Add what is missing to the ``Sections`` of a GRAPH block."""
    taken = {(member.get("Name") or "").casefold() for member in sections.iterfind("{*}Section/{*}Member")}
    if _section(sections, "Base") is None:
        _add_base(sections)
    if taken & _OPERATING:
        return
    for name, parameters in _PARAMETERS.items():
        section = _section(sections, name)
        if section is None:
            section = etree.Element(sections.tag.replace("Sections", "Section"), {"Name": name})
            keep_added(section)
            sections.insert(_place(sections, name), section)
        for at, (parameter, datatype) in enumerate(
            (parameter, datatype) for parameter, datatype in parameters.items() if parameter.casefold() not in taken
        ):
            member = sub(section, "Member", {"Name": parameter, "Datatype": datatype})
            keep_added(member)
            section.insert(at, member)
    ctx.note(Outcome.TRANSLATED, "interface", why="it got the standard parameters of S7-GRAPH")


def _section(sections: etree._Element, name: str) -> etree._Element | None:
    return next((s for s in sections if local(s) == "Section" and s.get("Name") == name), None)


def _place(sections: etree._Element, name: str) -> int:
    before = [s for s in sections if local(s) == "Section" and s.get("Name") in _BEHIND[name]]
    return sections.index(before[-1]) + 1 if before else 0


def _add_base(sections: etree._Element) -> None:
    base = etree.Element(sections.tag.replace("Sections", "Section"), {"Name": "Base"})
    keep_added(base)
    inner = sub(base, "Sections", {"Datatype": "GRAPH_BASE", "Version": "1.0"})
    for name in ("Input", "Output", "InOut", "Static"):
        sub(inner, "Section", {"Name": name})
    sections.insert(0, base)
