"""Interfaces of blocks and data types: sections and members. `nested_start_values` has values in members."""

from __future__ import annotations

from collections.abc import Sequence, Set
from typing import Any

from lxml import etree

from plcopen_sfc.formats.simaticml.added_elements import add_system_parts, is_added, mark_added, write_result
from plcopen_sfc.formats.simaticml.declaration_spelling import (
    LAYOUT,
    SECTIONS,
    are_usual_sections,
    is_tia_type,
    merged_sections,
    read_type,
    restored_sections,
    section_name,
    struct_of,
    write_type,
)
from plcopen_sfc.formats.simaticml.element_reader import (
    DocumentReading,
    Fields,
    children,
    keep_attribute,
    keep_element,
    local,
    merge_fields,
    read_comments,
    read_languages,
)
from plcopen_sfc.formats.simaticml.element_writer import DocumentWriting, add_element, finish, sub, write_languages
from plcopen_sfc.formats.simaticml.nested_start_values import (
    has_nested,
    read_elements,
    read_nested,
    write_elements,
    write_nested,
)
from plcopen_sfc.formats.simaticml.replaced_elements import WRITTEN, counting_fields, member_digests, warn_of_edit
from plcopen_sfc.formats.xml.extension_data import attributes, attributes_of, elements_of, extension_data, legal_text
from plcopen_sfc.languages.s7_globals import open_address
from plcopen_sfc.languages.s7_types import NO_START
from plcopen_sfc.model import types as t
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import Outcome

MEMBER_ATTRIBUTES = ("Version", "Remanence", "Accessibility", "Informative")
"""Attributes of ``Member`` itself; all others in `Variable.attributes` are in its ``AttributeList``."""
_INFORMATIVE = frozenset({"UserVisible", "UserReadOnly", "UserDeletable", "Offset", "PaddedSize"})
_SPELLED = frozenset({"elementary", "string", "array", "struct", "derived"})
"""Kinds of types that TIA Portal spells; others are kept."""
_INTEGERS = frozenset({"Offset", "PaddedSize"})
_ADDABLE = frozenset({"Static", "Base", "Input", "Output", "Return"})
_ELEMENTARY_TYPES: dict[str, t.ElementaryType] = {}
_NAMES = {kind: name for name, kind in SECTIONS.items()}


def read_interface(ctx: DocumentReading, element: etree._Element) -> Fields:
    """Read ``Interface``, with its ``Sections``."""
    fields: Fields = {"sections": []}
    for name, value in attributes(element).items():
        keep_attribute(fields, name, value)
    for number, sections in enumerate(children(element)):
        if number or local(sections) != "Sections" or sections.attrib:
            keep_element(fields, sections)
            continue
        ctx.note_schema(sections)
        for section in children(sections):
            is_addable = section.get("Name") in _ADDABLE and not (
                ctx.edited_controls and section.get("Name") == "Static"
            )
            if is_addable and is_added(section) and _is_all_added(section):
                continue
            kind = SECTIONS.get(section.get("Name", ""))
            if local(section) != "Section" or kind is None or len(section.attrib) > 1:
                keep_element(fields, section)
                continue
            fields["sections"].append(_read_section(ctx, section, kind))
        kept: Fields = {}
        read_comments(ctx, sections, kept)
        if kept.get("return_type") is not None and any(s["kind"] is SectionKind.RETURN for s in fields["sections"]):
            warn_of_edit(ctx, "the result of the function", sections)
            del kept["return_type"]
        merge_fields(fields, kept)
    layout = fields.pop(LAYOUT, None)
    if layout is not None:
        fields["sections"] = restored_sections(fields["sections"], layout)
    return fields


def write_interface(
    ctx: DocumentWriting,
    parent: etree._Element,
    interface: Interface,
    renamed: dict[str, str] | None = None,
    *,
    graph: bool = False,
    static: bool = True,
    added: Sequence[t.Variable] = (),
    kept_inside: Set[str] = frozenset(),
) -> etree._Element:
    """Write ``Interface``. `renamed` are new names of members that the chart of the block names.

    `graph`: the block has a chart, and needs the system parts of every sequencer. `static`: it has static variables,
    which functions have not. `added` are static variables that only TIA Portal wants, `kept_inside` the names of
    inputs, in lower case, that are static variables there.
    """
    element = sub(parent, "Interface")
    for key, value in attributes_of(interface.extension_data).items():
        element.set(key, value)
    sections = ctx.root("Interface", "Sections", element)
    for content in elements_of(interface.extension_data):
        add_element(ctx, sections, content)
    left: dict[str, Any] = {}
    given = interface.sections
    if ctx.tags or kept_inside or (not ctx.keeps_sections and not are_usual_sections(given, static=static)):
        given, left[LAYOUT] = merged_sections(given, static=static, apart=ctx.tags, kept_inside=kept_inside)
        for name, tag in ctx.tags.items():
            ctx.note(Outcome.TRANSLATED, "address", name, f"a tag, {tag.name} at {tag.address}")
    for section in given:
        _write_section(ctx, sections, section, renamed or {}, static=static)
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
    if added:
        _add_static(ctx, sections, added)
    if interface.return_type is not None:
        write_result(sections, ctx.s7_types.type(interface.return_type))
        left["return_type"] = interface.return_type.model_dump(mode="json", exclude_none=True)
    finish(ctx, sections, interface, frozenset({"sections", "return_type"}), also=left)
    return element


def _add_static(ctx: DocumentWriting, sections: etree._Element, added: Sequence[t.Variable]) -> None:
    """Add static variables that a reader drops."""
    section = next((each for each in children(sections) if each.get("Name") == "Static"), None)
    if section is None:
        section = sub(sections, "Section", {"Name": "Static"})
        mark_added(section)
        behind = [each for each in children(sections) if each.get("Name") in ("Temp", "Constant")]
        if behind:
            behind[0].addprevious(section)
    for variable in added:
        write_member(ctx, section, variable)
        mark_added(section[-1])


def _read_section(ctx: DocumentReading, element: etree._Element, kind: SectionKind) -> Fields:
    fields: Fields = {"kind": kind, "variables": []}
    for child in children(element):
        if local(child) == "Member":
            if not is_added(child) or (ctx.edited_controls and element.get("Name") == "Static"):
                fields["variables"].append(read_member(ctx, child))
        else:
            keep_element(fields, child)
    read_comments(ctx, element, fields)
    return fields


def _write_section(
    ctx: DocumentWriting, parent: etree._Element, section: VariableSection, renamed: dict[str, str], *, static: bool
) -> None:
    name = section_name(section) or ""
    element = sub(parent, "Section", {"Name": name})
    for content in elements_of(section.extension_data):
        add_element(ctx, element, content)
    for variable in section.variables:
        write_member(
            ctx,
            element,
            variable,
            renamed.get(variable.name),
            starts=name == "Constant" or (static and name != "Temp"),
            is_passed=name in ("Input", "InOut"),
        )
    if _NAMES.get(section.kind) == name:
        finish(ctx, element, section, frozenset({"kind", "variables"}))
    else:
        also = {"kind": section.kind.value, "constant": True}
        finish(ctx, element, section, frozenset({"kind", "variables", "constant"}), also=also)


def _is_all_added(section: etree._Element) -> bool:
    """True if a section has nothing but the members that our writer added."""
    return section.get("Name") == "Base" or all(is_added(child) for child in children(section))


def read_members(ctx: DocumentReading, element: etree._Element) -> Fields | None:
    """Return the members of a data type, which are in the one section ``None``; None for any other structure."""
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


def write_members(ctx: DocumentWriting, parent: etree._Element, struct: t.StructType) -> None:
    """Write the ``Interface`` of a data type."""
    sections = ctx.root("Interface", "Sections", sub(parent, "Interface"))
    section = sub(sections, "Section", {"Name": "None"})
    for member in struct.members:
        write_member(ctx, section, member)


def read_member(ctx: DocumentReading, element: etree._Element) -> Fields:
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
            _keep_marks(fields, child, kind)
        elif kind == "StartValue" and "initial" not in fields:
            fields["initial"] = {"kind": "simple", "text": child.text}
            _keep_marks(fields, child, kind)
        elif kind == "Subelement":
            elements.append(child)
        else:
            keep_element(fields, child)
    if listed:
        fields["attributes"] = listed
    if left:
        extension_data(fields)["attributes"].update(left)
    fields["type"] = read_type(spelled, members)
    nested = read_nested(element) if "initial" not in fields and has_nested(element) else None
    if nested is not None:
        fields["initial"] = nested
    initial = read_elements(fields["type"], elements) if elements and "initial" not in fields else None
    if initial is not None:
        fields["initial"] = initial
    for child in elements if initial is None else ():
        keep_element(fields, child)
    if members and spelled.rpartition(" ")[2] != "Struct":  # a copy of the members of a named type
        for child in children(element):
            if local(child) == "Member":
                keep_element(fields, child)
    if fields["type"]["kind"] in _SPELLED and spelled_as(fields["type"]) != spelled:
        extension_data(fields)["attributes"]["Datatype"] = spelled
    kept: Fields = {}
    read_comments(ctx, element, kept)
    if kept:
        merge_fields(fields, counting_fields(ctx, kept, member_digests(element), element))
    return fields


def write_member(
    ctx: DocumentWriting,
    parent: etree._Element,
    variable: t.Variable,
    name: str | None = None,
    *,
    starts: bool = True,
    is_passed: bool = False,
) -> None:
    """Write ``Member``. `starts`: it can have a start value: it is not temporary, and of no function.

    `is_passed`: calls of a function give its value, so that the start value of its type is not that of the parameter.
    """
    kept = attributes_of(variable.extension_data)
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
    unknown = list(elements_of(variable.extension_data))
    for content in [content for content in unknown if content.startswith("<AttributeList")]:
        add_element(ctx, element, content)
        unknown.remove(content)
    write_languages(ctx, element, "Comment", variable.comment, _marks(kept, "Comment"))
    struct = struct_of(type_)
    for member in struct.members if struct is not None else ():
        write_member(ctx, element, member)
    for content in unknown:
        add_element(ctx, element, content)
    native, reported = {"name", "type", "comment", "attributes"}, set[str]()
    if (told := open_address(ctx.project, variable)) is not None:
        reported.add("address")
        ctx.note(Outcome.APPROXIMATED, "address", variable.name, told)
    start = ctx.s7_types.start(variable) if starts or ctx.options.same else None
    starts_itself = variable.initial is not None or not is_passed
    if not starts and starts_itself and not ctx.options.same and ctx.s7_types.start(variable) is not None:
        reported.add("initial")
        ctx.note(Outcome.NOT_EXECUTED, "initial", variable.name, NO_START)
    has_initial, told_of_start = _write_start(ctx, element, variable, type_, start)
    native |= {"initial"} if has_initial else set()
    reported |= told_of_start
    passed = ctx.action_calls.starts.of(ctx.pou) if ctx.pou is not None and isinstance(start, t.StructValue) else {}
    if (by_calls := passed.get(variable.name.casefold())) is not None and "initial" not in native:
        reported.add("initial")
        why = "calls pass it" if by_calls.values else "without effect: all calls pass these inputs"
        ctx.note(Outcome.TRANSLATED, "initial", variable.name, why)
    also: dict[str, Any] = {"initial": None} if start is not None and variable.initial is None else {}
    if _reports_type(ctx, variable, type_, spelled):
        reported.add("type")
    native -= reported
    # the comment keeps fields of the source beside what is written for them; the digest tells an edit of the latter
    if "type" not in native or also or (variable.initial is not None and "initial" not in native):
        also[WRITTEN] = member_digests(element)
    finish(ctx, element, variable, frozenset(native), also=also, reported=frozenset(reported))


def _write_start(
    ctx: DocumentWriting, element: etree._Element, variable: t.Variable, type_: t.DataType, start: t.Value | None
) -> tuple[bool, set[str]]:
    """Write the start value of a member; return whether the file has that of the variable, and the fields to report."""
    own = start == variable.initial, set[str]() if start == variable.initial else {"initial"}
    if isinstance(start, t.StructValue) and isinstance(type_, t.StructType):
        # read, the values are those of its members, which are a part of its type
        return False, {"type", "initial"} if write_nested(element, type_, start, ctx.s7_types.declared) else set()
    if has_nested(element) or (start is not None and _is_nested(type_)):
        if not write_nested(element, type_, start, ctx.s7_types.declared):
            return False, set()
        return (True, set()) if read_nested(element) == start else (False, {"initial"})  # as `2(x)` for `x, x`
    if isinstance(start, t.SimpleValue):
        marks = _marks(attributes_of(variable.extension_data), "StartValue")
        sub(element, "StartValue", marks).text = legal_text(start.text or "") or None
        return own
    if start is not None and write_elements(element, type_, start):
        return own
    if start is not None and variable.initial is None:
        why = "its elements do not start with the initial value of their type, which TIA Portal cannot express here"
        ctx.note(Outcome.NOT_EXECUTED, "initial", variable.name, why)
    return False, set()


def _reports_type(ctx: DocumentWriting, variable: t.Variable, type_: t.DataType, spelled: str) -> bool:
    """Report the type of a variable that is written as `type_`, if that is another one or none of TIA Portal."""
    if type_ is not variable.type:
        why = f"it is a variable of the type {spelled}"
        if (bounds := ctx.s7_types.bounds(variable.type)) is None:
            ctx.note(Outcome.TRANSLATED, "data type", variable.name, why)
        else:
            why += f", and values outside of {bounds.lower}..{bounds.upper} are no error"
            ctx.note(Outcome.APPROXIMATED, "data type", variable.name, why)
    if not is_tia_type(type_):
        why = f"TIA Portal has no type like this one; written as {spelled}, which does not compile"
        ctx.note(Outcome.NOT_EXECUTED, "data type", variable.name, why)
    return type_ is not variable.type or not is_tia_type(type_)


def _is_nested(type_: t.DataType) -> bool:
    """True if members have the start values of a type: it is a PLC data type, or an array of structures."""
    base = t.element_type(type_)
    return isinstance(base, t.DerivedType) or (isinstance(base, t.StructType) and base is not type_)


def _keep_marks(fields: Fields, element: etree._Element, name: str) -> None:
    """Keep the attributes of a part of a member, such as ``Informative``."""
    for key, value in attributes(element).items():
        extension_data(fields)["attributes"][f"{name}/{key}"] = value


def _marks(kept: dict[str, str], part: str) -> dict[str, str]:
    start = f"{part}/"
    return {key.removeprefix(start): value for key, value in kept.items() if key.startswith(start)}


def _attribute_list(element: etree._Element, fields: Fields, listed: dict[str, str]) -> None:
    for child in children(element):
        marks = attributes(child)
        name = marks.pop("Name", "")
        if not name or name in listed or name in MEMBER_ATTRIBUTES or len(child):
            keep_element(fields, element)
            listed.clear()
            return
        value = child.text or ""
        listed[name] = value
        kind, usual = usual_form(name, value)
        if (local(child), marks) != (kind, usual):
            form = " ".join([local(child), *(f"{key}={mark}" for key, mark in sorted(marks.items()))])
            extension_data(fields)["attributes"][f"{name}/form"] = form


def usual_form(name: str, value: str) -> tuple[str, dict[str, str]]:
    """Return the element that gives a member the attribute `name`, and its marks, where nothing else is known."""
    kind = "IntegerAttribute" if name in _INTEGERS else "BooleanAttribute"
    if kind == "BooleanAttribute" and value not in ("true", "false"):
        kind = "StringAttribute"
    marks = {"Informative": "true"} if name in _INFORMATIVE else {}
    return kind, {**marks, "SystemDefined": "true"}


def _form(name: str, value: str, kept: dict[str, str]) -> tuple[str, dict[str, str]]:
    form = kept.get(f"{name}/form")
    if form is None:
        return usual_form(name, value)
    kind, *marks = form.split(" ")
    return kind, dict(mark.split("=", 1) for mark in marks)


def spelled_as(fields: Fields) -> str:
    """Return the spelling that `write_type` gives to a type that was just read."""
    return write_type(_light(fields))


def spelling(type: t.DataType, kept: dict[str, str]) -> str:
    """Return the spelling of the file as long as it is the same type, else that of TIA Portal."""
    spelled = kept.get("Datatype")
    if spelled is not None and _without_members(type) == read_type(spelled):
        return spelled
    return write_type(type)


def _light(fields: Fields) -> t.DataType:
    kind = fields["kind"]
    if kind == "elementary":
        return _ELEMENTARY_TYPES.setdefault(fields["name"], t.ElementaryType(name=fields["name"]))
    if kind == "string":
        return t.StringType(wide=fields["wide"], length=fields["length"])
    if kind == "struct":
        return t.StructType()
    if kind == "array":
        return t.ArrayType.model_validate({**fields, "base": _light(fields["base"])})
    return t.DerivedType(name=fields["name"])


def _without_members(type: t.DataType) -> object:
    if isinstance(type, t.ArrayType):
        return {"kind": "array", "dimensions": [d.model_dump() for d in type.dimensions]} | {
            "base": _without_members(type.base)
        }
    if isinstance(type, t.StructType):
        return {"kind": "struct", "members": []}
    if isinstance(type, t.DerivedType):
        return {"kind": "derived", "name": type.name}
    return type.model_dump()
