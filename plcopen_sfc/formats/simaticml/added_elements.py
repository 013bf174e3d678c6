"""Elements that only TIA Portal wants, and objects that are copies of what the project holds elsewhere.

A comment marks them, with a digest of their content. A reader drops them unless they have been edited since: then they
are elements as all others, and no edit is lost.

Two of them are made here: the member ``Ret_Val`` of the section ``Return`` for the result of a function (other tools
give it the name of the function; that texts of the function call it ``#Ret_Val`` too is not confirmed by an export, but
the name of the member is what they can refer to), and the system part of the interface of a GRAPH block: its base, and
the parameters that operate the sequencer. TIA Portal itself adds the data of steps and transitions.
"""

from __future__ import annotations

import hashlib
import json
from enum import Enum
from typing import Any

from lxml import etree

from plcopen_sfc.formats.simaticml.declaration_spelling import write_type
from plcopen_sfc.formats.simaticml.element_reader import ADDED, Fields, children, local
from plcopen_sfc.formats.simaticml.element_writer import DocumentWriting, keep_fields, sub
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK, attributes
from plcopen_sfc.languages.s7_programs import OPERANDS, RESULT, rename_local, renamed_local
from plcopen_sfc.model.body import FbdBody, LdBody, StBody
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import Body
from plcopen_sfc.model.types import DataType
from plcopen_sfc.report import Outcome

_NUMBERED = frozenset({"ID", "UId"})
"""Attributes with running numbers, which change whenever a document is written."""


class AddedMark(Enum):
    """True if an element was added by us."""

    NO = "it is part of the project"
    UNCHANGED = "it was added"
    EDITED = "it was added, and edited since"


def mark_added(element: etree._Element) -> None:
    """Mark an element as added. `seal_marks` the document when all is written."""
    keep_fields(element, {ADDED: True})


def seal_marks(root: etree._Element) -> None:
    """Put the digest of its element into each mark."""
    for comment in [*root.iter(etree.Comment)]:
        element = comment.getparent()
        if element is not None and _mark(comment) is True:
            element.remove(comment)
            keep_fields(element, {ADDED: _digest(element)})


def mark_of(element: etree._Element) -> AddedMark:
    """Return the mark in the comments of an element; None without one."""
    for comment in element.iterchildren(etree.Comment):
        mark = _mark(comment)
        if mark is not None:
            return AddedMark.UNCHANGED if mark == _digest(element) else AddedMark.EDITED
    return AddedMark.NO


def is_added(element: etree._Element) -> bool:
    """True if an element is as we have added it."""
    return mark_of(element) is AddedMark.UNCHANGED


def forget_mark(element: etree._Element) -> None:
    """Take out the mark of an element that is part of the project now."""
    for comment in [*element.iterchildren(etree.Comment)]:
        if _mark(comment) is not None:
            element.remove(comment)


def _mark(comment: etree._Element) -> Any:
    text = comment.text or ""
    if not text.startswith(f'{COMMENT_MARK}{{"{ADDED}"'):
        return None
    try:
        return json.loads(text.removeprefix(COMMENT_MARK)).get(ADDED)
    except (ValueError, RecursionError):
        return None  # the reader of the element reports that it is damaged


def _digest(element: etree._Element) -> str:
    """Return a digest of the content of an element, whatever its indentation and numbers."""
    digest = hashlib.sha256()
    for each in element.iter(etree.Element):
        values = [(name, value) for name, value in sorted(attributes(each).items()) if name not in _NUMBERED]
        text = "" if len(children(each)) else each.text or ""
        digest.update(repr((local(each), len(children(each)), values, text)).encode())
    return digest.hexdigest()[:16]


RETURN = "Return"


def write_result(sections: etree._Element, type_: DataType) -> None:
    """Write the section with the result of a function."""
    section = sub(sections, "Section", {"Name": RETURN})
    mark_added(section)
    mark_added(sub(section, "Member", {"Name": RESULT, "Datatype": write_type(type_)}))


def bodies_with_result(pou: Pou) -> list[Body]:
    """Bodies of a block; where it is a function with a result, that has the name of SimaticML in their texts."""
    if pou.interface is None or pou.interface.return_type is None:
        return pou.bodies
    return [_with_result(body, pou.name) for body in pou.bodies]


def _with_result(body: Body, name: str) -> Body:
    body = body.model_copy(deep=True) if isinstance(body, StBody | FbdBody | LdBody) else body
    rename_local(body, name, RESULT)
    return body


def name_result(bodies: list[Any], name: str) -> None:
    """Give the result its name in the bodies of a function that were read."""
    for body in (body for body in bodies if isinstance(body, dict)):
        texts: list[tuple[Fields, str]] = [(body, "text")] if body.get("language") == "ST" else []
        texts += [(node, f) for network in body.get("networks", []) for node in network["nodes"] for f in OPERANDS]
        for holder, field in texts:
            if isinstance(holder.get(field), str):
                holder[field] = renamed_local(holder[field], RESULT, name)


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
"""Standard parameter set (S7-GRAPH V6, TIA Portal V14 SP1 to V21)."""
_OPERATING = frozenset({"off_sq", "init_sq"})
"""A block with one of these has a parameter set of its own."""
_RUNTIME_DATA = "rt_data"
"""The member in which TIA Portal keeps the state of the sequences."""
_BEHIND = {"Input": ("Base",), "Output": ("Base", "Input")}


def add_system_parts(ctx: DocumentWriting, sections: etree._Element) -> None:
    """Add the missing system parts to the ``Sections`` of a GRAPH block."""
    taken = {(member.get("Name") or "").casefold() for member in sections.iterfind("{*}Section/{*}Member")}
    if _section(sections, "Base") is None:
        _add_base(sections)
    if taken & _OPERATING:
        return
    for name, parameters in _PARAMETERS.items():
        section = _section(sections, name)
        if section is None:
            section = etree.Element(sections.tag.replace("Sections", "Section"), {"Name": name})
            mark_added(section)
            sections.insert(_place(sections, name), section)
        for at, (parameter, datatype) in enumerate(
            (parameter, datatype) for parameter, datatype in parameters.items() if parameter.casefold() not in taken
        ):
            member = sub(section, "Member", {"Name": parameter, "Datatype": datatype})
            mark_added(member)
            section.insert(at, member)
    ctx.note(Outcome.TRANSLATED, "interface", why="it got the standard parameters of S7-GRAPH")


def system_members(variables: set[str]) -> set[str]:
    """Return the casefolded names of what a GRAPH block has beside its `variables` and the members for its steps."""
    if variables & _OPERATING:
        return {_RUNTIME_DATA}
    return {_RUNTIME_DATA, *(name.casefold() for names in _PARAMETERS.values() for name in names)}


def _section(sections: etree._Element, name: str) -> etree._Element | None:
    return next((s for s in sections if local(s) == "Section" and s.get("Name") == name), None)


def _place(sections: etree._Element, name: str) -> int:
    before = [s for s in sections if local(s) == "Section" and s.get("Name") in _BEHIND[name]]
    return sections.index(before[-1]) + 1 if before else 0


def _add_base(sections: etree._Element) -> None:
    base = etree.Element(sections.tag.replace("Sections", "Section"), {"Name": "Base"})
    mark_added(base)
    inner = sub(base, "Sections", {"Datatype": "GRAPH_BASE", "Version": "1.0"})
    for name in ("Input", "Output", "InOut", "Static"):
        sub(inner, "Section", {"Name": name})
    sections.insert(0, base)
