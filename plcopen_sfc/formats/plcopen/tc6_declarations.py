"""Declarations of TC6 XML, read and written: lists of variables, interfaces, and data types."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby

from lxml import etree

from plcopen_sfc.formats.plcopen.source_marks import restore_no_result, restore_system_data
from plcopen_sfc.formats.plcopen.tc6_reading import (
    Fields,
    Tc6ReadContext,
    attributes,
    keep_attributes,
    read_common,
    take_choice,
    take_flag,
    take_required,
)
from plcopen_sfc.formats.plcopen.tc6_types import (
    read_data_type,
    read_value,
    read_variable,
    write_data_type,
    write_value,
    write_variable,
)
from plcopen_sfc.formats.plcopen.tc6_writing import Tc6WriteContext, add_child, finish_element
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.model.variables import AccessSection, ConfigSection, Interface, SectionKind, VariableSection

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
    for flag in ("constant", "retain", "nonretain", "persistent", "nonpersistent"):
        if left and take_flag(ctx, element, left, flag):
            fields[flag] = True
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "variable":
            fields["variables"].append(read_variable(ctx, child))
        else:
            read_common(ctx, fields, child, local, "globalVars")
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
        if id(found[0]) in ctx.stale:
            plain["declaration"] = None
        variables = [variable for section in found for variable in section.variables]
        whole = found[0].model_copy(update={**plain, "variables": variables})
        ctx.parts[id(whole)] = found
        write_section(ctx, parent, whole)
        del ctx.parts[id(whole)]


def write_section(ctx: Tc6WriteContext, parent: etree._Element, section: VariableSection) -> None:
    """Write a list of variables. A kind that TC6 does not have is written as local variables, and carried."""
    name = _SECTION_ELEMENTS.get(section.kind)
    native = frozenset({"name", "variables", *_FLAGS})
    attributes = {"name": section.name} if section.name is not None else {}
    attributes.update({flag: "true" for flag in _FLAGS if getattr(section, flag)})
    element = add_child(ctx, parent, name or "localVars", attributes)
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
    restore_system_data(fields)
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


def read_access_section(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    """Read ``accessVars`` of a configuration."""
    fields: Fields = {"variables": []}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "accessVariable":
            fields["variables"].append(_read_access_variable(ctx, child))
        else:
            read_common(ctx, fields, child, local, "accessVars")
    return fields


def _read_access_variable(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
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
    keep_attributes(fields, left)
    return fields


def write_access_section(ctx: Tc6WriteContext, parent: etree._Element, section: AccessSection) -> None:
    """Write ``accessVars`` of a configuration."""
    element = add_child(ctx, parent, "accessVars")
    for variable in section.variables:
        attributes = {"alias": variable.alias, "instancePathAndName": variable.path}
        if variable.direction is not None:
            attributes["direction"] = variable.direction.value
        entry = add_child(ctx, element, "accessVariable", attributes)
        write_data_type(ctx, entry, "type", variable.type)
        finish_element(ctx, entry, variable, "accessVariable", frozenset({"alias", "path", "type", "direction"}))
    finish_element(ctx, element, section, "accessVars", frozenset({"variables"}))


def read_config_section(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    """Read ``configVars`` of a configuration."""
    fields: Fields = {"variables": []}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "configVariable":
            fields["variables"].append(_read_config_variable(ctx, child))
        else:
            read_common(ctx, fields, child, local, "configVars")
    return fields


def _read_config_variable(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
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
    keep_attributes(fields, left)
    return fields


def write_config_section(ctx: Tc6WriteContext, parent: etree._Element, section: ConfigSection) -> None:
    """Write ``configVars`` of a configuration."""
    element = add_child(ctx, parent, "configVars")
    for variable in section.variables:
        attributes = {"instancePathAndName": variable.path}
        if variable.address is not None:
            attributes["address"] = variable.address
        entry = add_child(ctx, element, "configVariable", attributes)
        write_data_type(ctx, entry, "type", variable.type)
        if variable.initial is not None:
            write_value(ctx, add_child(ctx, entry, "initialValue"), variable.initial)
        finish_element(ctx, entry, variable, "configVariable", frozenset({"path", "type", "address", "initial"}))
    finish_element(ctx, element, section, "configVars", frozenset({"variables"}))


def read_data_type_declaration(ctx: Tc6ReadContext, element: etree._Element, place: str) -> Fields:
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
    keep_attributes(fields, left)
    ctx.place.pop()
    return fields


def write_data_type_declaration(
    ctx: Tc6WriteContext, parent: etree._Element, declaration: DataTypeDeclaration, *, in_place: bool
) -> None:
    """Write ``dataType``. `in_place`: it is in its `place`, which then need not be kept."""
    element = add_child(ctx, parent, "dataType", {"name": declaration.name})
    ctx.place.append(f"type {declaration.name}")
    write_data_type(ctx, element, "baseType", declaration.type)
    if declaration.initial is not None:
        write_value(ctx, add_child(ctx, element, "initialValue"), declaration.initial)
    ctx.keep("data type")
    native = frozenset({"name", "type", "initial"}) | ({"place"} if in_place else frozenset())
    finish_element(ctx, element, declaration, "dataType", native)
    ctx.place.pop()
