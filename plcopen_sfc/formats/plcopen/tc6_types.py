"""Data types, initial values and variables of TC6 XML, read and written."""

from __future__ import annotations

import json

from lxml import etree

from plcopen_sfc.formats.plcopen.tc6_reading import (
    Fields,
    Tc6ReadContext,
    attributes,
    keep_attributes,
    keep_element,
    read_common,
    read_foreign_data,
    take_required,
)
from plcopen_sfc.formats.plcopen.tc6_writing import Tc6WriteContext, add_child, finish_element
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK
from plcopen_sfc.model.types import (
    ArrayType,
    ArrayValue,
    DataType,
    DerivedType,
    Dimension,
    Elementary,
    ElementaryType,
    EnumType,
    PointerType,
    SimpleValue,
    StringType,
    StructType,
    Value,
    Variable,
)
from plcopen_sfc.report import Outcome


def read_data_type(ctx: Tc6ReadContext, holder: etree._Element, fields: Fields) -> Fields:
    """Read the one type inside `holder` (``type``, ``baseType`` ..). `fields` get unknown content as extension data."""
    found: Fields | None = None
    for child in holder:
        local = ctx.tags.get(child.tag)
        kind = _read_type(ctx, child, local) if local else None
        if kind is None or found is not None:
            keep_element(ctx, fields, child)
        else:
            found = kind
    if found is None:
        ctx.error("XML205", f"<{etree.QName(holder).localname}> names no type", holder)
        found = {"kind": "derived", "name": ""}
    return found


def _read_type(ctx: Tc6ReadContext, element: etree._Element, local: str) -> Fields | None:
    if local in Elementary.__members__:
        return {"kind": "elementary", "name": local}
    if local in ("string", "wstring"):
        fields: Fields = {"kind": "string", "wide": local == "wstring", "length": element.get("length")}
        for comment in element:
            if ctx.comment_reader is not None:
                ctx.comment_reader(ctx, comment, fields, "string")
        return fields
    reader = _TYPE_READERS.get(local)
    return reader(ctx, element) if reader else None


def _read_derived(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    name = element.get("name", "")
    fields: Fields = {"kind": "derived", "name": name}
    for child in element:
        if ctx.tags.get(child.tag) == "addData":
            read_foreign_data(ctx, fields, child, "derived")
        else:
            keep_element(ctx, fields, child)
    if name in Elementary.__members__ and (name not in ctx.version.elements) and "carried" not in fields:
        # an elementary type that this version of TC6 does not list
        return {"kind": "elementary", "name": name}
    return fields


def _read_bounds(element: etree._Element) -> Fields:
    return {"lower": element.get("lower", ""), "upper": element.get("upper", "")}


def _read_array(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {"kind": "array", "dimensions": [], "base": {"kind": "derived", "name": ""}}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "dimension":
            fields["dimensions"].append(_read_bounds(child))
        elif local == "baseType":
            fields["base"] = read_data_type(ctx, child, {})
    return fields


def _read_struct(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {"kind": "struct", "members": []}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "variable":
            fields["members"].append(read_variable(ctx, child))
        else:
            read_common(ctx, fields, child, local, "struct")
    return fields


def _read_enum(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
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


def _read_subrange(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {
        "kind": "subrange",
        "bounds": {"lower": "", "upper": ""},
        "base": {"kind": "derived", "name": ""},
        "unsigned": ctx.tags[str(element.tag)] == "subrangeUnsigned",
    }
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "range":
            fields["bounds"] = _read_bounds(child)
        elif local == "baseType":
            fields["base"] = read_data_type(ctx, child, {})
    return fields


def _read_pointer(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {"kind": "pointer", "base": {"kind": "derived", "name": ""}}
    for child in element:
        if ctx.tags.get(child.tag) == "baseType":
            fields["base"] = read_data_type(ctx, child, {})
    return fields


_TYPE_READERS = {
    "derived": _read_derived,
    "array": _read_array,
    "struct": _read_struct,
    "enum": _read_enum,
    "subrangeSigned": _read_subrange,
    "subrangeUnsigned": _read_subrange,
    "pointer": _read_pointer,
}


_NEVER = frozenset({"kind"})


def write_data_type(ctx: Tc6WriteContext, parent: etree._Element, holder: str, kind: DataType) -> None:
    """Write a type inside a new element `holder`."""
    element = add_child(ctx, parent, holder)
    if isinstance(kind, ElementaryType):
        _write_elementary(ctx, element, kind)
    elif isinstance(kind, StringType):
        _write_string(ctx, element, kind)
    elif isinstance(kind, DerivedType):
        finish_element(
            ctx,
            add_child(ctx, element, "derived", {"name": kind.name}),
            kind,
            "derived",
            _NEVER | {"name"},
            documents=False,
        )
    elif isinstance(kind, ArrayType):
        array = add_child(ctx, element, "array")
        for dimension in kind.dimensions:
            _write_bounds(ctx, array, "dimension", dimension)
        write_data_type(ctx, array, "baseType", kind.base)
    elif isinstance(kind, StructType):
        struct = add_child(ctx, element, "struct")
        for member in kind.members:
            write_variable(ctx, struct, member)
        finish_element(ctx, struct, kind, "struct", _NEVER | {"members"})
    elif isinstance(kind, EnumType):
        _write_enum(ctx, element, kind)
    elif isinstance(kind, PointerType):
        write_data_type(ctx, add_child(ctx, element, "pointer"), "baseType", kind.base)
    else:
        subrange = add_child(ctx, element, "subrangeUnsigned" if kind.unsigned else "subrangeSigned")
        _write_bounds(ctx, subrange, "range", kind.bounds)
        write_data_type(ctx, subrange, "baseType", kind.base)


def _write_string(ctx: Tc6WriteContext, element: etree._Element, kind: StringType) -> None:
    string = add_child(ctx, element, "wstring" if kind.wide else "string")
    length = kind.length
    if length is None:
        return
    if ctx.version.first_generation and not length.isdecimal():
        string.append(etree.Comment(COMMENT_MARK + json.dumps({"length": length}).replace("--", "-\\u002d")))
        number = _constant_number(ctx, length)
        if number is None:
            why = f"TC6 {ctx.version.name} takes a number only: the tool's own length is used"
            ctx.note(Outcome.NOT_EXECUTED, "length of a string", length, why)
            return
        why = f"its value {number}: TC6 {ctx.version.name} takes a number only"
        ctx.note(Outcome.TRANSLATED, "length of a string", length, why)
        length = number
    string.set("length", length)


def _constant_number(ctx: Tc6WriteContext, name: str) -> str | None:
    """Return the number that a global constant has as a decimal; None where there is no such one."""
    wanted = name.rpartition(".")[2].casefold()
    for section in ctx.project.global_sections():
        for variable in section.variables if section.constant else ():
            value = variable.initial
            if variable.name.casefold() == wanted and isinstance(value, SimpleValue) and (value.text or "").isdecimal():
                return value.text
    return None


def _write_elementary(ctx: Tc6WriteContext, element: etree._Element, kind: ElementaryType) -> None:
    name = kind.name.value
    if name not in ctx.version.elements:
        # TC6 does not list the 64 bit times and the characters, 1.01 no generic types either: named like a user type
        add_child(ctx, element, "derived", {"name": name})
        ctx.note(
            Outcome.TRANSLATED, "data type", name, f"TC6 {ctx.version.name} does not list it; written as a derived type"
        )
    else:
        add_child(ctx, element, name)


def _write_enum(ctx: Tc6WriteContext, element: etree._Element, kind: EnumType) -> None:
    enum = add_child(ctx, element, "enum")
    values = add_child(ctx, enum, "values")
    for value in kind.values:
        add_child(
            ctx, values, "value", {"name": value.name} | ({"value": value.value} if value.value is not None else {})
        )
    if kind.base is not None:
        write_data_type(ctx, enum, "baseType", kind.base)


def _write_bounds(ctx: Tc6WriteContext, parent: etree._Element, name: str, bounds: Dimension) -> None:
    add_child(ctx, parent, name, {"lower": bounds.lower, "upper": bounds.upper})


def read_value(ctx: Tc6ReadContext, holder: etree._Element) -> Fields | None:
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


def write_value(ctx: Tc6WriteContext, holder: etree._Element, value: Value) -> None:
    """Write a value into `holder`."""
    if isinstance(value, SimpleValue):
        add_child(ctx, holder, "simpleValue", {"value": value.text} if value.text is not None else {})
    elif isinstance(value, ArrayValue):
        array = add_child(ctx, holder, "arrayValue")
        for item in value.items:
            attributes = {"repetitionValue": item.repetitions} if item.repetitions is not None else {}
            write_value(ctx, add_child(ctx, array, "value", attributes), item.value)
    else:
        struct = add_child(ctx, holder, "structValue")
        for member in value.members:
            write_value(ctx, add_child(ctx, struct, "value", {"member": member.member}), member.value)


def read_variable(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
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
    keep_attributes(fields, left)
    return fields


def write_variable(ctx: Tc6WriteContext, parent: etree._Element, variable: Variable) -> None:
    """Write ``variable``."""
    attributes = {"name": variable.name}
    if variable.address is not None:
        attributes["address"] = variable.address
    element = add_child(ctx, parent, "variable", attributes)
    write_data_type(ctx, element, "type", variable.type)
    if variable.initial is not None:
        write_value(ctx, add_child(ctx, element, "initialValue"), variable.initial)
    ctx.keep("variable", variable.name)
    finish_element(ctx, element, variable, "variable", frozenset({"name", "type", "address", "initial"}))
