"""Reads data types, initial values and declarations of TC6 XML. The writer is `types_writer`."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.plcopen.reading import (
    Fields,
    ReadContext,
    attributes,
    carry_attributes,
    carry_element,
    read_common,
    read_foreign_data,
    take_choice,
    take_flag,
    take_required,
)
from plcopen_sfc.formats.plcopen.rewritten import restore_no_result
from plcopen_sfc.model.types import Elementary

PARTS_FIELD = "parts"
"""At a list of global variables that is being read: its sections, where they have different attributes."""
SECTIONS = {
    "localVars": "local",
    "tempVars": "temp",
    "inputVars": "input",
    "outputVars": "output",
    "inOutVars": "inOut",
    "externalVars": "external",
    "globalVars": "global",
    "accessVars": "access",
}
"""TC6 elements of an interface and the sections that they are."""


def read_data_type(ctx: ReadContext, holder: etree._Element, fields: Fields) -> Fields:
    """Read the one type inside `holder` (``type``, ``baseType`` ..). `fields`: what carries the unknown."""
    found: Fields | None = None
    for child in holder:
        local = ctx.tags.get(child.tag)
        kind = _type(ctx, child, local) if local else None
        if kind is None or found is not None:
            carry_element(ctx, fields, child)
        else:
            found = kind
    if found is None:
        ctx.error("XML205", f"<{etree.QName(holder).localname}> names no type", holder)
        found = {"kind": "derived", "name": ""}
    return found


def _type(ctx: ReadContext, element: etree._Element, local: str) -> Fields | None:
    if local in Elementary.__members__:
        return {"kind": "elementary", "name": local}
    if local in ("string", "wstring"):
        fields: Fields = {"kind": "string", "wide": local == "wstring", "length": element.get("length")}
        for comment in element:
            if ctx.comment_reader is not None:
                ctx.comment_reader(ctx, comment, fields, "string")
        return fields
    reader = _TYPES.get(local)
    return reader(ctx, element) if reader else None


def _derived(ctx: ReadContext, element: etree._Element) -> Fields:
    name = element.get("name", "")
    fields: Fields = {"kind": "derived", "name": name}
    for child in element:
        if ctx.tags.get(child.tag) == "addData":
            read_foreign_data(ctx, fields, child, "derived")
        else:
            carry_element(ctx, fields, child)
    if name in Elementary.__members__ and (name not in ctx.version.elements) and "carried" not in fields:
        # an elementary type that this version of TC6 does not list
        return {"kind": "elementary", "name": name}
    return fields


def _bounds(element: etree._Element) -> Fields:
    return {"lower": element.get("lower", ""), "upper": element.get("upper", "")}


def _array(ctx: ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {"kind": "array", "dimensions": [], "base": {"kind": "derived", "name": ""}}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "dimension":
            fields["dimensions"].append(_bounds(child))
        elif local == "baseType":
            fields["base"] = read_data_type(ctx, child, {})
    return fields


def _struct(ctx: ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {"kind": "struct", "members": []}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "variable":
            fields["members"].append(read_variable(ctx, child))
        else:
            read_common(ctx, fields, child, local, "struct")
    return fields


def _enum(ctx: ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {"kind": "enum", "values": []}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "values":
            fields["values"] = [
                {"name": v.get("name", ""), "value": v.get("value")} for v in child if ctx.tags.get(v.tag) == "value"
            ]
        elif local == "baseType":
            fields["base"] = read_data_type(ctx, child, {})
    return fields


def _subrange(ctx: ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {
        "kind": "subrange",
        "bounds": {"lower": "", "upper": ""},
        "base": {"kind": "derived", "name": ""},
        "unsigned": ctx.tags[str(element.tag)] == "subrangeUnsigned",
    }
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "range":
            fields["bounds"] = _bounds(child)
        elif local == "baseType":
            fields["base"] = read_data_type(ctx, child, {})
    return fields


def _pointer(ctx: ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {"kind": "pointer", "base": {"kind": "derived", "name": ""}}
    for child in element:
        if ctx.tags.get(child.tag) == "baseType":
            fields["base"] = read_data_type(ctx, child, {})
    return fields


_TYPES = {
    "derived": _derived,
    "array": _array,
    "struct": _struct,
    "enum": _enum,
    "subrangeSigned": _subrange,
    "subrangeUnsigned": _subrange,
    "pointer": _pointer,
}


def read_value(ctx: ReadContext, holder: etree._Element) -> Fields | None:
    """Read the value inside `holder` (``initialValue`` or ``value``)."""
    for child in holder:
        local = ctx.tags.get(child.tag)
        if local == "simpleValue":
            return {"kind": "simple", "text": child.get("value")}
        if local == "arrayValue":
            items = [
                {"value": read_value(ctx, v) or {"kind": "simple"}, "repetitions": v.get("repetitionValue")}
                for v in child
                if ctx.tags.get(v.tag) == "value"
            ]
            return {"kind": "array", "items": items}
        if local == "structValue":
            members = [
                {"member": v.get("member", ""), "value": read_value(ctx, v) or {"kind": "simple"}}
                for v in child
                if ctx.tags.get(v.tag) == "value"
            ]
            return {"kind": "struct", "members": members}
    return None


def read_variable(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read ``variable`` of an interface, a list or a structure."""
    left = attributes(element)
    fields: Fields = {"name": take_required(ctx, element, left, "name"), "type": {"kind": "derived", "name": ""}}
    if "address" in left:
        fields["address"] = left.pop("address")
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "type":
            fields["type"] = read_data_type(ctx, child, fields)
        elif local == "initialValue":
            fields["initial"] = read_value(ctx, child)
        else:
            read_common(ctx, fields, child, local, "variable")
    carry_attributes(fields, left)
    return fields


def read_section(ctx: ReadContext, element: etree._Element, kind: str) -> Fields:
    """Read a list of variables (``inputVars``, ``globalVars`` ..)."""
    left = attributes(element)
    fields: Fields = {"kind": kind, "variables": []}
    if "name" in left:
        fields["name"] = left.pop("name")
    for flag in ("constant", "retain", "nonretain", "persistent", "nonpersistent"):
        if left and take_flag(ctx, element, left, flag):
            fields[flag] = True
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "variable":
            fields["variables"].append(read_variable(ctx, child))
        else:
            read_common(ctx, fields, child, local, "globalVars")
    carry_attributes(fields, left)
    return fields


def parts_of_list(section: Fields) -> list[Fields]:
    """A list of global variables as the sections that it is made of (`PARTS_FIELD`); alone where it is one."""
    parts = section.pop(PARTS_FIELD, None)
    if parts is None:
        return [section]
    shared = {name: section[name] for name in ("object_id",) if name in section}
    return [section | parts[0], *(part | shared for part in parts[1:])]


def read_interface(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read ``interface`` of a POU or method."""
    left = attributes(element)
    fields: Fields = {"sections": []}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local in SECTIONS:
            fields["sections"].append(read_section(ctx, child, SECTIONS[local]))
        elif local == "returnType":
            fields["return_type"] = read_data_type(ctx, child, fields)
        else:
            read_common(ctx, fields, child, local, "interface")
    restore_no_result(fields)
    carry_attributes(fields, left)
    return fields


def read_access_section(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read ``accessVars`` of a configuration."""
    fields: Fields = {"variables": []}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "accessVariable":
            fields["variables"].append(_access_variable(ctx, child))
        else:
            read_common(ctx, fields, child, local, "accessVars")
    return fields


def _access_variable(ctx: ReadContext, element: etree._Element) -> Fields:
    left = attributes(element)
    fields: Fields = {
        "alias": take_required(ctx, element, left, "alias"),
        "path": take_required(ctx, element, left, "instancePathAndName"),
        "type": {"kind": "derived", "name": ""},
        "direction": take_choice(ctx, element, left, "direction", ("readOnly", "readWrite")),
    }
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "type":
            fields["type"] = read_data_type(ctx, child, fields)
        else:
            read_common(ctx, fields, child, local, "accessVariable")
    carry_attributes(fields, left)
    return fields


def read_config_section(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read ``configVars`` of a configuration."""
    fields: Fields = {"variables": []}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "configVariable":
            fields["variables"].append(_config_variable(ctx, child))
        else:
            read_common(ctx, fields, child, local, "configVars")
    return fields


def _config_variable(ctx: ReadContext, element: etree._Element) -> Fields:
    left = attributes(element)
    fields: Fields = {
        "path": take_required(ctx, element, left, "instancePathAndName"),
        "type": {"kind": "derived", "name": ""},
        "address": left.pop("address", None),
    }
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "type":
            fields["type"] = read_data_type(ctx, child, fields)
        elif local == "initialValue":
            fields["initial"] = read_value(ctx, child)
        else:
            read_common(ctx, fields, child, local, "configVariable")
    carry_attributes(fields, left)
    return fields


def read_data_type_declaration(ctx: ReadContext, element: etree._Element, place: str) -> Fields:
    """Read ``dataType``."""
    left = attributes(element)
    fields: Fields = {"name": take_required(ctx, element, left, "name"), "place": place}
    ctx.place.append(f"type {fields['name']}")
    fields["type"] = {"kind": "derived", "name": ""}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "baseType":
            fields["type"] = read_data_type(ctx, child, fields)
        elif local == "initialValue":
            fields["initial"] = read_value(ctx, child)
        else:
            read_common(ctx, fields, child, local, "dataType")
    carry_attributes(fields, left)
    ctx.place.pop()
    return fields
