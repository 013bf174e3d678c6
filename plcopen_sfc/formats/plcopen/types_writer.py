"""Writes data types, initial values and declarations of TC6 XML. The reader is `types_reader`."""

from __future__ import annotations

import json
from collections.abc import Iterable
from itertools import groupby

from lxml import etree

from plcopen_sfc.formats.plcopen.types_reader import SECTIONS
from plcopen_sfc.formats.plcopen.writing import WriteContext, finish, sub
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model.types import (
    ArrayType,
    ArrayValue,
    DataType,
    DataTypeDeclaration,
    DerivedType,
    Dimension,
    ElementaryType,
    EnumType,
    PointerType,
    SimpleValue,
    StringType,
    StructType,
    Value,
    Variable,
)
from plcopen_sfc.model.variables import AccessSection, ConfigSection, Interface, SectionKind, VariableSection
from plcopen_sfc.report import Outcome

_SECTION_ELEMENTS = {SectionKind(kind): name for name, kind in SECTIONS.items()}
_NEVER = frozenset({"kind"})


def write_data_type(ctx: WriteContext, parent: etree._Element, holder: str, kind: DataType) -> None:
    """Write a type inside a new element `holder`."""
    element = sub(ctx, parent, holder)
    if isinstance(kind, ElementaryType):
        _elementary(ctx, element, kind)
    elif isinstance(kind, StringType):
        _string(ctx, element, kind)
    elif isinstance(kind, DerivedType):
        finish(
            ctx, sub(ctx, element, "derived", {"name": kind.name}), kind, "derived", _NEVER | {"name"}, documents=False
        )
    elif isinstance(kind, ArrayType):
        array = sub(ctx, element, "array")
        for dimension in kind.dimensions:
            _bounds(ctx, array, "dimension", dimension)
        write_data_type(ctx, array, "baseType", kind.base)
    elif isinstance(kind, StructType):
        struct = sub(ctx, element, "struct")
        for member in kind.members:
            write_variable(ctx, struct, member)
        finish(ctx, struct, kind, "struct", _NEVER | {"members"})
    elif isinstance(kind, EnumType):
        _enum(ctx, element, kind)
    elif isinstance(kind, PointerType):
        write_data_type(ctx, sub(ctx, element, "pointer"), "baseType", kind.base)
    else:
        subrange = sub(ctx, element, "subrangeUnsigned" if kind.unsigned else "subrangeSigned")
        _bounds(ctx, subrange, "range", kind.bounds)
        write_data_type(ctx, subrange, "baseType", kind.base)


def _string(ctx: WriteContext, element: etree._Element, kind: StringType) -> None:
    string = sub(ctx, element, "wstring" if kind.wide else "string")
    length = kind.length
    if length is None:
        return
    if ctx.version.first_generation and not length.isdecimal():
        string.append(etree.Comment(COMMENT_MARK + json.dumps({"length": length}).replace("--", "-\\u002d")))
        number = _constant(ctx, length)
        if number is None:
            why = f"TC6 {ctx.version.name} takes a number only: the tool's own length is used"
            ctx.note(Outcome.NOT_EXECUTED, "length of a string", length, why)
            return
        why = f"its value {number}: TC6 {ctx.version.name} takes a number only"
        ctx.note(Outcome.TRANSLATED, "length of a string", length, why)
        length = number
    string.set("length", length)


def _constant(ctx: WriteContext, name: str) -> str | None:
    """The number that a global constant has as a decimal; None where there is no such one."""
    wanted = name.rpartition(".")[2].casefold()
    for section in ctx.project.global_sections():
        for variable in section.variables if section.constant else ():
            value = variable.initial
            if variable.name.casefold() == wanted and isinstance(value, SimpleValue) and (value.text or "").isdecimal():
                return value.text
    return None


def _elementary(ctx: WriteContext, element: etree._Element, kind: ElementaryType) -> None:
    name = kind.name.value
    if name not in ctx.version.elements:
        # TC6 does not list the 64 bit times and the characters, 1.01 no generic types either: named like a user type
        sub(ctx, element, "derived", {"name": name})
        ctx.note(
            Outcome.TRANSLATED, "data type", name, f"TC6 {ctx.version.name} does not list it; written as a derived type"
        )
    else:
        sub(ctx, element, name)


def _enum(ctx: WriteContext, element: etree._Element, kind: EnumType) -> None:
    enum = sub(ctx, element, "enum")
    values = sub(ctx, enum, "values")
    for value in kind.values:
        sub(ctx, values, "value", {"name": value.name} | ({"value": value.value} if value.value is not None else {}))
    if kind.base is not None:
        write_data_type(ctx, enum, "baseType", kind.base)


def _bounds(ctx: WriteContext, parent: etree._Element, name: str, bounds: Dimension) -> None:
    sub(ctx, parent, name, {"lower": bounds.lower, "upper": bounds.upper})


def write_value(ctx: WriteContext, holder: etree._Element, value: Value) -> None:
    """Write a value into `holder`."""
    if isinstance(value, SimpleValue):
        sub(ctx, holder, "simpleValue", {"value": value.text} if value.text is not None else {})
    elif isinstance(value, ArrayValue):
        array = sub(ctx, holder, "arrayValue")
        for item in value.items:
            attributes = {"repetitionValue": item.repetitions} if item.repetitions is not None else {}
            write_value(ctx, sub(ctx, array, "value", attributes), item.value)
    else:
        struct = sub(ctx, holder, "structValue")
        for member in value.members:
            write_value(ctx, sub(ctx, struct, "value", {"member": member.member}), member.value)


def write_variable(ctx: WriteContext, parent: etree._Element, variable: Variable) -> None:
    """Write ``variable``."""
    attributes = {"name": variable.name}
    if variable.address is not None:
        attributes["address"] = variable.address
    element = sub(ctx, parent, "variable", attributes)
    write_data_type(ctx, element, "type", variable.type)
    if variable.initial is not None:
        write_value(ctx, sub(ctx, element, "initialValue"), variable.initial)
    ctx.keep("variable", variable.name)
    finish(ctx, element, variable, "variable", frozenset({"name", "type", "address", "initial"}))


_FLAGS = ("constant", "retain", "nonretain", "persistent", "nonpersistent")


def write_lists(ctx: WriteContext, parent: etree._Element, sections: Iterable[VariableSection]) -> None:
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


def write_section(ctx: WriteContext, parent: etree._Element, section: VariableSection) -> None:
    """Write a list of variables. A kind that TC6 does not have is written as local variables, and carried."""
    name = _SECTION_ELEMENTS.get(section.kind)
    native = frozenset({"name", "variables", *_FLAGS})
    attributes = {"name": section.name} if section.name is not None else {}
    attributes.update({flag: "true" for flag in _FLAGS if getattr(section, flag)})
    element = sub(ctx, parent, name or "localVars", attributes)
    also: dict[str, bool] = {}
    if name is not None:
        native = native | {"kind"}
    elif section.kind is SectionKind.CONSTANT and not section.constant:
        element.set("constant", "true")  # TIA Portal has a section for constants, TC6 a flag
        also = {"constant": False}
    for variable in section.variables:
        write_variable(ctx, element, variable)
    finish(ctx, element, section, "globalVars", native, also=also)


def write_interface(ctx: WriteContext, parent: etree._Element, interface: Interface) -> None:
    """Write ``interface`` of a POU or method. The declaration text belongs to the POU in the file."""
    element = sub(ctx, parent, "interface")
    if interface.return_type is not None:
        write_data_type(ctx, element, "returnType", interface.return_type)
    for section in interface.sections:
        write_section(ctx, element, section)
    finish(ctx, element, interface, "interface", frozenset({"return_type", "sections"}))


def write_access_section(ctx: WriteContext, parent: etree._Element, section: AccessSection) -> None:
    """Write ``accessVars`` of a configuration."""
    element = sub(ctx, parent, "accessVars")
    for variable in section.variables:
        attributes = {"alias": variable.alias, "instancePathAndName": variable.path}
        if variable.direction is not None:
            attributes["direction"] = variable.direction.value
        entry = sub(ctx, element, "accessVariable", attributes)
        write_data_type(ctx, entry, "type", variable.type)
        finish(ctx, entry, variable, "accessVariable", frozenset({"alias", "path", "type", "direction"}))
    finish(ctx, element, section, "accessVars", frozenset({"variables"}))


def write_config_section(ctx: WriteContext, parent: etree._Element, section: ConfigSection) -> None:
    """Write ``configVars`` of a configuration."""
    element = sub(ctx, parent, "configVars")
    for variable in section.variables:
        attributes = {"instancePathAndName": variable.path}
        if variable.address is not None:
            attributes["address"] = variable.address
        entry = sub(ctx, element, "configVariable", attributes)
        write_data_type(ctx, entry, "type", variable.type)
        if variable.initial is not None:
            write_value(ctx, sub(ctx, entry, "initialValue"), variable.initial)
        finish(ctx, entry, variable, "configVariable", frozenset({"path", "type", "address", "initial"}))
    finish(ctx, element, section, "configVars", frozenset({"variables"}))


def write_data_type_declaration(
    ctx: WriteContext, parent: etree._Element, declaration: DataTypeDeclaration, *, in_place: bool
) -> None:
    """Write ``dataType``. `in_place`: it stands where its `place` says, which then need not be carried."""
    element = sub(ctx, parent, "dataType", {"name": declaration.name})
    ctx.place.append(f"type {declaration.name}")
    write_data_type(ctx, element, "baseType", declaration.type)
    if declaration.initial is not None:
        write_value(ctx, sub(ctx, element, "initialValue"), declaration.initial)
    ctx.keep("data type")
    native = frozenset({"name", "type", "initial"}) | ({"place"} if in_place else frozenset())
    finish(ctx, element, declaration, "dataType", native)
    ctx.place.pop()
