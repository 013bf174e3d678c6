"""Writes interfaces: sections and members. The reader is `interface_reader`."""

from __future__ import annotations

from typing import Any

from lxml import etree

from plcopen_sfc.formats.simaticml.graph_parameters import add_system_parts
from plcopen_sfc.formats.simaticml.interface_reader import MEMBER_ATTRIBUTES, usual_form
from plcopen_sfc.formats.simaticml.nested_values import has_nested, write_nested
from plcopen_sfc.formats.simaticml.results import write_result
from plcopen_sfc.formats.simaticml.rewritten import WRITTEN, of_member
from plcopen_sfc.formats.simaticml.sections import LAYOUT, SECTIONS, is_usual, merged, section_name
from plcopen_sfc.formats.simaticml.start_values import write_elements
from plcopen_sfc.formats.simaticml.types import is_sayable, read_type, struct_of, write_type
from plcopen_sfc.formats.simaticml.writing import WriteContext, add_element, finish, sub, write_languages
from plcopen_sfc.formats.xml.extension_data import legal_text
from plcopen_sfc.languages.s7_types import NO_START
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.types import ArrayType, DataType, DerivedType, SimpleValue, StructType, StructValue, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import Outcome

_NAMES = {kind: name for name, kind in SECTIONS.items()}


def write_interface(
    ctx: WriteContext,
    parent: etree._Element,
    interface: Interface,
    renamed: dict[str, str] | None = None,
    *,
    graph: bool = False,
    static: bool = True,
) -> etree._Element:
    """Write ``Interface``. `renamed` are new names of members that the chart of the block names.

    `graph`: the block has a chart, and needs what every sequencer has. `static`: it has static variables, which
    functions have not.
    """
    element = sub(parent, "Interface")
    for key, value in (interface.carried.attributes if interface.carried is not None else {}).items():
        element.set(key, value)
    sections = ctx.root("Interface", "Sections", element)
    for content in interface.carried.elements if interface.carried is not None else ():
        add_element(ctx, sections, content)
    left: dict[str, Any] = {}
    given = interface.sections
    if not ctx.keeps_sections and not is_usual(given, static=static):
        given, left[LAYOUT] = merged(given, static=static)
    for section in given:
        _section(ctx, sections, section, renamed or {}, static=static)
    for section in interface.sections:
        if section.persistent:
            why = "its variables are kept when the power fails, and not when the block is loaded again"
            ctx.note(Outcome.APPROXIMATED, "section", f"{section.kind.value} persistent", why)
        if section_name(section) is None:
            external = section.kind is SectionKind.EXTERNAL  # names of global variables, which texts name as such
            outcome = Outcome.EXTENSION_DATA if external else Outcome.NOT_EXECUTED
            ctx.note(outcome, "section", section.kind.value, "TIA Portal has no such section")
    if graph:
        add_system_parts(ctx, sections)
    if interface.return_type is not None:
        write_result(sections, ctx.s7_types.type(interface.return_type))
        left["return_type"] = interface.return_type.model_dump(mode="json", exclude_none=True)
    finish(ctx, sections, interface, frozenset({"sections", "return_type"}), also=left)
    return element


def _section(
    ctx: WriteContext, parent: etree._Element, section: VariableSection, renamed: dict[str, str], *, static: bool
) -> None:
    name = section_name(section) or ""
    element = sub(parent, "Section", {"Name": name})
    for content in section.carried.elements if section.carried is not None else ():
        add_element(ctx, element, content)
    for variable in section.variables:
        write_member(
            ctx, element, variable, renamed.get(variable.name), starts=name == "Constant" or (static and name != "Temp")
        )
    if _NAMES.get(section.kind) == name:
        finish(ctx, element, section, frozenset({"kind", "variables"}))
    else:
        also = {"kind": section.kind.value, "constant": True}
        finish(ctx, element, section, frozenset({"kind", "variables", "constant"}), also=also)


def write_members(ctx: WriteContext, parent: etree._Element, struct: StructType) -> None:
    """Write the ``Interface`` of a data type."""
    sections = ctx.root("Interface", "Sections", sub(parent, "Interface"))
    section = sub(sections, "Section", {"Name": "None"})
    for member in struct.members:
        write_member(ctx, section, member)


def write_member(
    ctx: WriteContext, parent: etree._Element, variable: Variable, name: str | None = None, *, starts: bool = True
) -> None:
    """Write ``Member``. `starts`: it can have a start value: it is not temporary, and of no function."""
    kept = variable.carried.attributes if variable.carried is not None else {}
    own = {key: variable.attributes[key] for key in MEMBER_ATTRIBUTES if key in variable.attributes}
    type_ = ctx.s7_types.type(variable.type)
    spelled = spelling(type_, kept if type_ is variable.type else {})
    element = sub(parent, "Member", {"Name": name or variable.name, "Datatype": spelled, **own})
    for key, value in kept.items():
        if "/" not in key and key != "Datatype":
            element.set(key, value)
    listed = {key: value for key, value in variable.attributes.items() if key not in own}
    if listed:
        holder = sub(element, "AttributeList")
        for key, value in listed.items():
            kind, marks = _form(key, value, kept)
            sub(holder, kind, {"Name": key, **marks}).text = value or None
    unknown = list(variable.carried.elements) if variable.carried is not None else []
    for content in [content for content in unknown if content.startswith("<AttributeList")]:
        add_element(ctx, element, content)
        unknown.remove(content)
    write_languages(ctx, element, "Comment", variable.comment, _marks(kept, "Comment"))
    struct = struct_of(type_)
    for member in struct.members if struct is not None else ():
        write_member(ctx, element, member)
    for content in unknown:
        add_element(ctx, element, content)
    native = {"name", "type", "comment", "attributes"}
    told: set[str] = set()
    also: dict[str, Any] = {}
    start = ctx.s7_types.start(variable) if starts or ctx.options.same else None
    if not starts and not ctx.options.same and ctx.s7_types.start(variable) is not None:
        told.add("initial")
        ctx.note(Outcome.NOT_EXECUTED, "initial", variable.name, NO_START)
    if isinstance(start, StructValue) and isinstance(type_, StructType):
        if write_nested(element, type_, start, ctx.s7_types.declared):
            native.discard("type")  # read, the values are those of its members
            told |= {"type", "initial"}
    elif has_nested(element) or (start is not None and _is_nested(type_)):
        if write_nested(element, type_, start, ctx.s7_types.declared):
            native.add("initial")
    elif isinstance(start, SimpleValue):
        sub(element, "StartValue", _marks(kept, "StartValue")).text = legal_text(start.text or "") or None
        (native if start == variable.initial else told).add("initial")
    elif start is not None and write_elements(element, type_, start):
        (native if start == variable.initial else told).add("initial")
    elif start is not None and variable.initial is None:
        why = "its elements do not start with the initial value of their type, which TIA Portal cannot say here"
        ctx.note(Outcome.NOT_EXECUTED, "initial", variable.name, why)
    if start is not None and variable.initial is None:
        also = {"initial": None}
    if type_ is not variable.type:
        native.discard("type")
        told.add("type")
        ctx.note(Outcome.TRANSLATED, "data type", variable.name, f"it is a variable of the type {spelled}")
    if not is_sayable(type_):
        native.discard("type")
        told.add("type")
        why = f"TIA Portal has no type like this one; written as {spelled}, which does not compile"
        ctx.note(Outcome.NOT_EXECUTED, "data type", variable.name, why)
    if "type" not in native or also or (variable.initial is not None and "initial" not in native):
        also[WRITTEN] = of_member(element)
    finish(ctx, element, variable, frozenset(native), also=also, told=frozenset(told))


def _is_nested(type_: DataType) -> bool:
    """True if start values of a type stand in members: it is a PLC data type, or an array of structures."""
    base = type_
    while isinstance(base, ArrayType):
        base = base.base
    return isinstance(base, DerivedType) or (isinstance(base, StructType) and base is not type_)


def spelling(type: DataType, kept: dict[str, str]) -> str:
    """The spelling of the file as long as it is the same type, else that of TIA Portal."""
    spelled = kept.get("Datatype")
    if spelled is not None and _without_members(type) == read_type(spelled):
        return spelled
    return write_type(type)


def _without_members(type: DataType) -> object:
    if isinstance(type, ArrayType):
        return {"kind": "array", "dimensions": [d.model_dump() for d in type.dimensions]} | {
            "base": _without_members(type.base)
        }
    if isinstance(type, StructType):
        return {"kind": "struct", "members": []}
    if isinstance(type, DerivedType):
        return {"kind": "derived", "name": type.name}
    return type.model_dump()


def _form(name: str, value: str, kept: dict[str, str]) -> tuple[str, dict[str, str]]:
    form = kept.get(f"{name}/form")
    if form is None:
        return usual_form(name, value)
    kind, *marks = form.split(" ")
    return kind, dict(mark.split("=", 1) for mark in marks)


def _marks(kept: dict[str, str], part: str) -> dict[str, str]:
    start = f"{part}/"
    return {key.removeprefix(start): value for key, value in kept.items() if key.startswith(start)}


def section_kinds(interface: Interface | None) -> set[SectionKind]:
    """The kinds of sections that an interface has."""
    return {section.kind for section in interface.sections} if interface is not None else set()


def usable(carried: Carried | None) -> dict[str, str]:
    """The carried attributes of an object."""
    return carried.attributes if carried is not None else {}
