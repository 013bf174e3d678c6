"""Declarations of TC6 XML, read and written: variables and their initial values, interfaces, and data types."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from itertools import groupby

from lxml import etree

from plcopen_sfc.formats.plcopen.source_marks import (
    restore_no_result,
    restore_retained,
    restore_system_data,
    restore_types_of_s5,
)
from plcopen_sfc.formats.plcopen.tc6_reading import (
    Fields,
    Tc6ReadContext,
    keep_attributes,
    keep_element,
    read_comment,
    read_common,
    read_foreign_data,
    take_choice,
    take_flag,
    take_required,
)
from plcopen_sfc.formats.plcopen.tc6_writing import Tc6WriteContext, add_child, finish_element
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK, attributes
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model import types as t
from plcopen_sfc.model.variables import (
    AccessSection,
    AccessVariable,
    ConfigSection,
    Interface,
    SectionKind,
    VariableSection,
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
    if local in t.Elementary.__members__:
        return {"kind": "elementary", "name": local}
    if local in ("string", "wstring"):
        fields: Fields = {"kind": "string", "wide": local == "wstring", "length": element.get("length")}
        for comment in element:
            read_comment(ctx, comment, fields, "string")
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
    if name in t.Elementary.__members__ and (name not in ctx.version.elements) and "extension_data" not in fields:
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
    _read_list(ctx, fields["members"], element, "variable", read_variable, fields=fields, what="struct")
    return fields


def _read_list(
    ctx: Tc6ReadContext,
    entries: list[Fields],
    element: etree._Element,
    name: str,
    read: Callable[[Tc6ReadContext, etree._Element], Fields],
    *,
    fields: Fields,
    what: str,
) -> None:
    """Add the elements `name` of a list to `entries`; `fields` get what else is in it."""
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == name:
            entries.append(read(ctx, child))
        else:
            read_common(ctx, fields, child, local, what)


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


def write_data_type(ctx: Tc6WriteContext, parent: etree._Element, holder: str, kind: t.DataType) -> None:
    """Write a type inside a new element `holder`."""
    element = add_child(ctx, parent, holder)
    if isinstance(kind, t.ElementaryType):
        _write_elementary(ctx, element, kind)
    elif isinstance(kind, t.StringType):
        _write_string(ctx, element, kind)
    elif isinstance(kind, t.DerivedType):
        derived = add_child(ctx, element, "derived", {"name": kind.name})
        finish_element(ctx, derived, kind, "derived", _NEVER | {"name"}, documents=False)
    elif isinstance(kind, t.ArrayType):
        array = add_child(ctx, element, "array")
        for dimension in kind.dimensions:
            _write_bounds(ctx, array, "dimension", dimension)
        write_data_type(ctx, array, "baseType", kind.base)
    elif isinstance(kind, t.StructType):
        struct = add_child(ctx, element, "struct")
        for member in kind.members:
            write_variable(ctx, struct, member)
        finish_element(ctx, struct, kind, "struct", _NEVER | {"members"})
    elif isinstance(kind, t.EnumType):
        _write_enum(ctx, element, kind)
    elif isinstance(kind, t.PointerType):
        write_data_type(ctx, add_child(ctx, element, "pointer"), "baseType", kind.base)
    else:
        subrange = add_child(ctx, element, "subrangeUnsigned" if kind.unsigned else "subrangeSigned")
        _write_bounds(ctx, subrange, "range", kind.bounds)
        write_data_type(ctx, subrange, "baseType", kind.base)


def _write_string(ctx: Tc6WriteContext, element: etree._Element, kind: t.StringType) -> None:
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
            if (
                variable.name.casefold() == wanted
                and isinstance(value, t.SimpleValue)
                and (value.text or "").isdecimal()
            ):
                return value.text
    return None


def _write_elementary(ctx: Tc6WriteContext, element: etree._Element, kind: t.ElementaryType) -> None:
    name = kind.name.value
    if name not in ctx.version.elements:
        # TC6 does not list the 64 bit times and the characters, 1.01 no generic types either: named like a user type
        add_child(ctx, element, "derived", {"name": name})
        ctx.note(
            Outcome.TRANSLATED, "data type", name, f"TC6 {ctx.version.name} does not list it; written as a derived type"
        )
    else:
        add_child(ctx, element, name)


def _write_enum(ctx: Tc6WriteContext, element: etree._Element, kind: t.EnumType) -> None:
    enum = add_child(ctx, element, "enum")
    values = add_child(ctx, enum, "values")
    for value in kind.values:
        add_child(ctx, values, "value", {"name": value.name, "value": value.value})
    if kind.base is not None:
        write_data_type(ctx, enum, "baseType", kind.base)


def _write_bounds(ctx: Tc6WriteContext, parent: etree._Element, name: str, bounds: t.Dimension) -> None:
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


def write_value(ctx: Tc6WriteContext, holder: etree._Element, value: t.Value) -> None:
    """Write a value into `holder`."""
    if isinstance(value, t.SimpleValue):
        add_child(ctx, holder, "simpleValue", {"value": value.text})
    elif isinstance(value, t.ArrayValue):
        array = add_child(ctx, holder, "arrayValue")
        for item in value.items:
            write_value(ctx, add_child(ctx, array, "value", {"repetitionValue": item.repetitions}), item.value)
    else:
        struct = add_child(ctx, holder, "structValue")
        for member in value.members:
            write_value(ctx, add_child(ctx, struct, "value", {"member": member.member}), member.value)


def read_variable(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    """Read ``variable`` of an interface, a list or a structure."""
    left = attributes(element)
    fields: Fields = {"name": take_required(ctx, element, left, "name")}
    if "address" in left:
        fields["address"] = left.pop("address")
    return _read_declared(ctx, element, fields, left, "variable")


def _read_declared(
    ctx: Tc6ReadContext, element: etree._Element, fields: Fields, left: dict[str, str], owner: str
) -> Fields:
    """Read the type and the initial value of what an element (`owner`) declares, and keep the rest of the element."""
    fields["type"] = {"kind": "derived", "name": ""}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == ("baseType" if owner == "dataType" else "type"):
            fields["type"] = read_data_type(ctx, child, fields)
        elif local == "initialValue" and owner != "accessVariable":
            fields["initial"] = read_value(ctx, child)
        else:
            read_common(ctx, fields, child, local, owner)
    keep_attributes(fields, left)
    return fields


def _write_declared(
    ctx: Tc6WriteContext, element: etree._Element, kind: t.DataType, initial: t.Value | None, holder: str = "type"
) -> None:
    write_data_type(ctx, element, holder, kind)
    if initial is not None:
        write_value(ctx, add_child(ctx, element, "initialValue"), initial)


def write_variable(ctx: Tc6WriteContext, parent: etree._Element, variable: t.Variable) -> None:
    """Write ``variable``."""
    element = add_child(ctx, parent, "variable", {"name": variable.name, "address": variable.address})
    _write_declared(ctx, element, variable.type, variable.initial)
    ctx.keep("variable", variable.name)
    finish_element(ctx, element, variable, "variable", frozenset({"name", "type", "address", "initial"}))


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


_SECTION_ELEMENTS = {SectionKind(kind): name for name, kind in SECTIONS.items()}


_FLAGS = ("constant", "retain", "nonretain", "persistent", "nonpersistent")


def read_section(ctx: Tc6ReadContext, element: etree._Element, kind: str) -> Fields:
    """Read a list of variables (``inputVars``, ``globalVars`` ..)."""
    left = attributes(element)
    fields: Fields = {"kind": kind, "variables": []}
    if "name" in left:
        fields["name"] = left.pop("name")
    for flag in _FLAGS:
        if left and take_flag(ctx, element, left, flag):
            fields[flag] = True
    _read_list(ctx, fields["variables"], element, "variable", read_variable, fields=fields, what="globalVars")
    keep_attributes(fields, left)
    return fields


def parts_of_list(section: Fields) -> list[Fields]:
    """Return a list of global variables as the sections that it is made of (`PARTS_FIELD`); alone where it is one."""
    parts = section.pop(PARTS_FIELD, None)
    if parts is None:
        return [section]
    shared = {name: section[name] for name in ("object_id",) if name in section}
    return [section | parts[0], *(part | shared for part in parts[1:])]


def write_lists(ctx: Tc6WriteContext, parent: etree._Element, sections: Iterable[VariableSection]) -> None:
    """Write lists of global variables. CODESYS has one list of what are sections of one name, side by side."""
    for _, group in groupby(enumerate(sections), lambda each: each[1].name or each[0]):
        found = [section for _, section in group]
        is_one = ctx.dialect.tool is not Tool.CODESYS or any(id(section) in ctx.marks for section in found)
        if is_one or len(found) == 1:
            for section in found:
                write_section(ctx, parent, section)
            continue
        plain: dict[str, object] = dict.fromkeys(_FLAGS, False)
        plain["declaration"] = ctx.texts.get(id(found[0]), found[0].declaration)
        variables = [variable for section in found for variable in section.variables]
        whole = found[0].model_copy(update={**plain, "variables": variables})
        ctx.parts[id(whole)] = found
        write_section(ctx, parent, whole)
        del ctx.parts[id(whole)]


def write_section(ctx: Tc6WriteContext, parent: etree._Element, section: VariableSection) -> None:
    """Write a list of variables. A kind that TC6 does not have is written as local variables, with extension data."""
    name = _SECTION_ELEMENTS.get(section.kind)
    native = frozenset({"name", "variables", *_FLAGS})
    flags = {flag: "true" for flag in _FLAGS if getattr(section, flag)}
    element = add_child(ctx, parent, name or "localVars", {"name": section.name} | flags)
    also: dict[str, bool] = {}
    if name is not None:
        native = native | {"kind"}
    elif section.kind is SectionKind.CONSTANT and not section.constant:
        element.set("constant", "true")  # TIA Portal has a section for constants, TC6 a flag
        also = {"constant": False}
    for variable in section.variables:
        write_variable(ctx, element, variable)
    finish_element(ctx, element, section, "globalVars", native, also=also)


def read_interface(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
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
    restore_retained(fields)
    restore_system_data(fields)
    restore_types_of_s5(fields)
    restore_no_result(fields)
    keep_attributes(fields, left)
    return fields


def write_interface(ctx: Tc6WriteContext, parent: etree._Element, interface: Interface) -> None:
    """Write ``interface`` of a POU or method. The declaration text belongs to the POU in the file."""
    element = add_child(ctx, parent, "interface")
    if interface.return_type is not None:
        write_data_type(ctx, element, "returnType", interface.return_type)
    for section in interface.sections:
        write_section(ctx, element, section)
    finish_element(ctx, element, interface, "interface", frozenset({"return_type", "sections"}))


LISTINGS = {"accessVars": "access_variables", "configVars": "config_variables"}
"""Lists of a configuration, and the fields with them."""


def read_listing(ctx: Tc6ReadContext, element: etree._Element, name: str) -> Fields:
    """Read ``accessVars`` or ``configVars`` (`name`) of a configuration."""
    fields: Fields = {"variables": []}
    entry, read = ("accessVariable", _read_access_variable) if name == "accessVars" else _CONFIG_VARIABLE
    _read_list(ctx, fields["variables"], element, entry, read, fields=fields, what=name)
    return fields


def _read_access_variable(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    left = attributes(element)
    fields: Fields = {
        "alias": take_required(ctx, element, left, "alias"),
        "path": take_required(ctx, element, left, "instancePathAndName"),
        "direction": take_choice(ctx, element, left, "direction", ("readOnly", "readWrite")),
    }
    return _read_declared(ctx, element, fields, left, "accessVariable")


def _read_config_variable(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    left = attributes(element)
    path = take_required(ctx, element, left, "instancePathAndName")
    fields: Fields = {"path": path, "address": left.pop("address", None)}
    return _read_declared(ctx, element, fields, left, "configVariable")


_CONFIG_VARIABLE = ("configVariable", _read_config_variable)


def write_listing(ctx: Tc6WriteContext, parent: etree._Element, section: AccessSection | ConfigSection) -> None:
    """Write ``accessVars`` or ``configVars`` of a configuration."""
    name, entry = "configVars", "configVariable"
    if isinstance(section, AccessSection):
        name, entry = "accessVars", "accessVariable"
    holder = add_child(ctx, parent, name)
    for variable in section.variables:
        path = {"instancePathAndName": variable.path}
        if isinstance(variable, AccessVariable):
            marks = {"alias": variable.alias} | path | {"direction": variable.direction}
            element, initial = add_child(ctx, holder, entry, marks), None
        else:
            element = add_child(ctx, holder, entry, path | {"address": variable.address})
            initial = variable.initial
        _write_declared(ctx, element, variable.type, initial)
        finish_element(ctx, element, variable, entry, _LISTED)
    finish_element(ctx, holder, section, name, frozenset({"variables"}))


_LISTED = frozenset({"alias", "path", "type", "direction", "address", "initial"})


def read_data_type_declaration(ctx: Tc6ReadContext, element: etree._Element, place: str) -> Fields:
    """Read ``dataType``."""
    left = attributes(element)
    fields: Fields = {"name": take_required(ctx, element, left, "name"), "place": place}
    ctx.place.append(f"type {fields['name']}")
    _read_declared(ctx, element, fields, left, "dataType")
    ctx.place.pop()
    return fields


def write_data_type_declaration(
    ctx: Tc6WriteContext, parent: etree._Element, declaration: t.DataTypeDeclaration, *, in_place: bool
) -> None:
    """Write ``dataType``. `in_place`: it is in its `place`, which then need not be kept."""
    element = add_child(ctx, parent, "dataType", {"name": declaration.name})
    ctx.place.append(f"type {declaration.name}")
    _write_declared(ctx, element, declaration.type, declaration.initial, "baseType")
    ctx.keep("data type")
    native = frozenset({"name", "type", "initial"}) | ({"place"} if in_place else frozenset())
    finish_element(ctx, element, declaration, "dataType", native)
    ctx.place.pop()
