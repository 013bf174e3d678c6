"""Reads interfaces: sections and members. The writer is `interface_writer`."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.simaticml.added import is_added
from plcopen_sfc.formats.simaticml.nested_values import has_nested, read_nested
from plcopen_sfc.formats.simaticml.reading import (
    Fields,
    ReadContext,
    attributes,
    carried,
    carry_attribute,
    carry_element,
    children,
    local,
    merge,
    read_comments,
    read_languages,
)
from plcopen_sfc.formats.simaticml.rewritten import counting, of_member, warn_of_edit
from plcopen_sfc.formats.simaticml.sections import LAYOUT, SECTIONS, restored
from plcopen_sfc.formats.simaticml.start_values import read_elements
from plcopen_sfc.formats.simaticml.types import read_type, write_type
from plcopen_sfc.model.types import ArrayType, DataType, DerivedType, ElementaryType, StringType, StructType
from plcopen_sfc.model.variables import SectionKind

MEMBER_ATTRIBUTES = ("Version", "Remanence", "Accessibility", "Informative")
"""Attributes of ``Member`` itself; all others in `Variable.attributes` stand in its ``AttributeList``."""
_INFORMATIVE = frozenset({"UserVisible", "UserReadOnly", "UserDeletable", "Offset", "PaddedSize"})
_SPELLED = frozenset({"elementary", "string", "array", "struct", "derived"})
"""The kinds of types that TIA Portal spells; others are carried."""
_INTEGERS = frozenset({"Offset", "PaddedSize"})


def usual_form(name: str, value: str) -> tuple[str, dict[str, str]]:
    """The element that gives a member the attribute `name`, and its marks, where nothing else is known."""
    kind = "IntegerAttribute" if name in _INTEGERS else "BooleanAttribute"
    if kind == "BooleanAttribute" and value not in ("true", "false"):
        kind = "StringAttribute"
    marks = {"Informative": "true"} if name in _INFORMATIVE else {}
    return kind, {**marks, "SystemDefined": "true"}


_ADDABLE = frozenset({"Base", "Input", "Output", "Return"})


def read_interface(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read ``Interface``, with its ``Sections``."""
    fields: Fields = {"sections": []}
    for name, value in attributes(element).items():
        carry_attribute(fields, name, value)
    for number, sections in enumerate(children(element)):
        if number or local(sections) != "Sections" or sections.attrib:
            carry_element(fields, sections)
            continue
        ctx.note_schema(sections)
        for section in children(sections):
            if section.get("Name") in _ADDABLE and is_added(section) and _is_all_added(section):
                continue
            kind = SECTIONS.get(section.get("Name", ""))
            if local(section) != "Section" or kind is None or len(section.attrib) > 1:
                carry_element(fields, section)
                continue
            fields["sections"].append(_section(ctx, section, kind))
        kept: Fields = {}
        read_comments(ctx, sections, kept)
        if kept.get("return_type") is not None and any(s["kind"] is SectionKind.RETURN for s in fields["sections"]):
            warn_of_edit(ctx, "the result of the function", sections)
            del kept["return_type"]
        merge(fields, kept)
    layout = fields.pop(LAYOUT, None)
    if layout is not None:
        fields["sections"] = restored(fields["sections"], layout)
    return fields


def _section(ctx: ReadContext, element: etree._Element, kind: SectionKind) -> Fields:
    fields: Fields = {"kind": kind, "variables": []}
    for child in children(element):
        if local(child) == "Member":
            if not is_added(child):
                fields["variables"].append(read_member(ctx, child))
        else:
            carry_element(fields, child)
    read_comments(ctx, element, fields)
    return fields


def _is_all_added(section: etree._Element) -> bool:
    """Whether nobody has put anything into a section that our writer added."""
    return section.get("Name") == "Base" or all(is_added(child) for child in children(section))


def read_members(ctx: ReadContext, element: etree._Element) -> Fields | None:
    """The members of a data type, which stand in the one section ``None``; None where it is built otherwise."""
    for sections in children(element) if len(children(element)) == 1 and not element.attrib else ():
        ctx.note_schema(sections)
        found = children(sections)
        if len(found) == 1 and attributes(found[0]) == {"Name": "None"} and not sections.attrib:
            if local(found[0]) != "Section" or local(sections) != "Sections":
                return None
            if any(local(child) != "Member" for child in children(found[0])):
                return None
            return {"kind": "struct", "members": [read_member(ctx, child) for child in children(found[0])]}
    return None


def read_member(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read ``Member``."""
    left = attributes(element)
    spelled = left.pop("Datatype", "")
    fields: Fields = {"name": left.pop("Name", "")}
    members: list[Fields] = []
    elements: list[etree._Element] = []
    listed: dict[str, str] = {name: left.pop(name) for name in MEMBER_ATTRIBUTES if name in left}
    for child in element:
        kind = local(child)
        if kind == "AttributeList":
            _attribute_list(child, fields, listed)
        elif kind == "Member":
            members.append(read_member(ctx, child))
        elif kind == "Comment" and "comment" not in fields and (text := read_languages(child)) is not None:
            fields["comment"] = text
            _marks(fields, child, kind)
        elif kind == "StartValue" and "initial" not in fields:
            fields["initial"] = {"kind": "simple", "text": child.text}
            _marks(fields, child, kind)
        elif kind == "Subelement":
            elements.append(child)
        else:
            carry_element(fields, child)
    if listed:
        fields["attributes"] = listed
    if left:
        carried(fields)["attributes"].update(left)
    fields["type"] = read_type(spelled, members)
    nested = read_nested(element) if "initial" not in fields and has_nested(element) else None
    if nested is not None:
        fields["initial"] = nested
    initial = read_elements(fields["type"], elements) if elements and "initial" not in fields else None
    if initial is not None:
        fields["initial"] = initial
    for child in elements if initial is None else ():
        carry_element(fields, child)
    if members and spelled.rpartition(" ")[2] != "Struct":
        for child in children(element):
            if local(child) == "Member":
                carry_element(fields, child)
    if fields["type"]["kind"] in _SPELLED and spelled_as(fields["type"]) != spelled:
        carried(fields)["attributes"]["Datatype"] = spelled
    kept: Fields = {}
    read_comments(ctx, element, kept)
    if kept:
        merge(fields, counting(ctx, kept, of_member(element), element))
    return fields


def _marks(fields: Fields, element: etree._Element, name: str) -> None:
    """Keep the attributes of a part of a member, such as ``Informative``."""
    for key, value in attributes(element).items():
        carried(fields)["attributes"][f"{name}/{key}"] = value


def _attribute_list(element: etree._Element, fields: Fields, listed: dict[str, str]) -> None:
    for child in children(element):
        marks = attributes(child)
        name = marks.pop("Name", "")
        if not name or name in listed or name in MEMBER_ATTRIBUTES or len(child):
            carry_element(fields, element)
            listed.clear()
            return
        value = child.text or ""
        listed[name] = value
        kind, usual = usual_form(name, value)
        if (local(child), marks) != (kind, usual):
            form = " ".join([local(child), *(f"{key}={mark}" for key, mark in sorted(marks.items()))])
            carried(fields)["attributes"][f"{name}/form"] = form


def spelled_as(fields: Fields) -> str:
    """How `write_type` would spell a type that was just read."""
    return write_type(_light(fields))


def _light(fields: Fields) -> DataType:
    kind = fields["kind"]
    if kind == "elementary":
        return _ELEMENTARY_TYPES.setdefault(fields["name"], ElementaryType(name=fields["name"]))
    if kind == "string":
        return StringType(wide=fields["wide"], length=fields["length"])
    if kind == "struct":
        return StructType()
    if kind == "array":
        return ArrayType.model_validate({**fields, "base": _light(fields["base"])})
    return DerivedType(name=fields["name"])


_ELEMENTARY_TYPES: dict[str, ElementaryType] = {}
