"""Interfaces of blocks and data types: sections and members with their start values, read and written.

The elements of an array have one ``Subelement`` each by their indices, in the model one value of the array. A member of
a PLC data type repeats the members of the type in ``Sections``, with the start values of this variable. Of an array of
structures the members have one ``Subelement`` for each element; its path has the indices of the array, then those of
the member itself, where it is an array too (seen in exports of V16: ``Path="62,13"``).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence, Set
from typing import Any

from lxml import etree
from pydantic import TypeAdapter

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
    N,
    XmlNode,
    attributes,
    children,
    extension_data,
    keep_attribute,
    keep_element,
    local,
    merge_fields,
    read_comments,
    read_languages,
)
from plcopen_sfc.formats.simaticml.element_writer import DocumentWriting, add_element, finish, sub, write_languages
from plcopen_sfc.formats.simaticml.replaced_elements import WRITTEN, counting_fields, member_digests, warn_of_edit
from plcopen_sfc.formats.xml.extension_data import legal_text
from plcopen_sfc.languages.s7_globals import open_address
from plcopen_sfc.languages.s7_types import NO_START
from plcopen_sfc.languages.start_values import Path, ValuePathError, apart, assembled
from plcopen_sfc.model.types import (
    ArrayType,
    ArrayValue,
    DataType,
    DerivedType,
    ElementaryType,
    SimpleValue,
    StringType,
    StructType,
    StructValue,
    Value,
    Variable,
)
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import Outcome

_BOUND = re.compile(r"[-+]?\d{1,9}")
_MOST = 100_000
"""More elements than that are not written one by one."""


def read_elements(type: Fields, elements: list[etree._Element]) -> Fields | None:
    """Return the value of an array whose elements have these start values; None where they hold more, or do not fit.

    An element without a value of its own has the default of its type: it is a value without text.
    """
    ranges = _ranges([(d["lower"], d["upper"]) for d in type["dimensions"]]) if type["kind"] == "array" else None
    if ranges is None:
        return None
    items: list[Fields] = []
    following = 0
    for element in elements:
        place = _place(element.get("Path", ""), ranges)
        inner = children(element)
        plain = len(inner) == 1 and local(inner[0]) == "StartValue" and not inner[0].attrib and not len(inner[0])
        if place is None or place < following or not plain or not inner[0].text or set(element.attrib) != {"Path"}:
            return None
        _add(items, None, place - following)
        _add(items, inner[0].text, 1)
        following = place + 1
    return {"kind": "array", "items": items}


def _add(items: list[Fields], text: str | None, count: int) -> None:
    if not count:
        return
    # equal neighbours are one item with repetitions, as texts write them: an array may have 10,000 zeros
    if items and items[-1]["value"]["text"] == text:
        count += int(items[-1]["repetitions"] or 1)
        items.pop()
    value = {"kind": "simple", "text": text}
    items.append({"value": value, "repetitions": str(count) if count > 1 else None})


def write_elements(parent: etree._Element, type: DataType, value: Value) -> bool:
    """Write the start values of an array; False where they are none that TIA Portal can have."""
    if not isinstance(type, ArrayType) or not isinstance(value, ArrayValue):
        return False
    ranges = _ranges([(dimension.lower, dimension.upper) for dimension in type.dimensions])
    texts = _texts(value)
    if ranges is None or texts is None:
        return False
    size = 1
    for lower, upper in ranges:
        size *= upper - lower + 1
    written = sum(count for text, count in texts if text is not None)
    if sum(count for _, count in texts) > size or written > _MOST:
        return False
    place = 0
    for text, count in texts:
        for number in range(place, place + count) if text is not None else ():
            element = sub(parent, "Subelement", {"Path": _path(number, ranges)})
            sub(element, "StartValue").text = legal_text(text or "")
        place += count
    return True


def _texts(value: ArrayValue) -> list[tuple[str | None, int]] | None:
    """Return the values of an array, each with its number of repetitions."""
    found: list[tuple[str | None, int]] = []
    for item in value.items:
        repetitions = item.repetitions or "1"
        if not isinstance(item.value, SimpleValue) or not _BOUND.fullmatch(repetitions) or int(repetitions) < 0:
            return None
        if item.value.text == "":
            return None
        found.append((item.value.text, int(repetitions)))
    return found


def _ranges(bounds: list[tuple[str, str]]) -> list[tuple[int, int]] | None:
    """Return the bounds of an array; None where they are not plain numbers."""
    found = [(int(lower), int(upper)) for lower, upper in bounds if _BOUND.fullmatch(lower) and _BOUND.fullmatch(upper)]
    return found if len(found) == len(bounds) and all(lower <= upper for lower, upper in found) else None


def _place(path: str, ranges: list[tuple[int, int]]) -> int | None:
    """Return the place of an element among all: the last index counts first."""
    indices = path.split(",")
    place = 0
    if len(indices) != len(ranges):
        return None
    for text, (lower, upper) in zip(indices, ranges, strict=True):
        if not _BOUND.fullmatch(text) or text != str(int(text)) or not lower <= int(text) <= upper:
            return None
        place = place * (upper - lower + 1) + int(text) - lower
    return place


def _path(place: int, ranges: list[tuple[int, int]]) -> str:
    return ",".join(reversed(list(_indices(place, ranges))))


def _indices(place: int, ranges: list[tuple[int, int]]) -> Iterator[str]:
    """Yield the indices of an element, the last first."""
    for lower, upper in reversed(ranges):
        place, rest = divmod(place, upper - lower + 1)
        yield str(lower + rest)


_TYPES: TypeAdapter[DataType] = TypeAdapter(DataType)
_INDICES = re.compile(r"-?\d{1,9}(?:,-?\d{1,9})*")


def has_nested(element: XmlNode) -> bool:
    """True if a member has start values in its parts, which are its own: those of structures belong to their members.

    Types of the system have start values that are of no effect or belong to their blocks.
    """
    spelled = element.get("Datatype", "")
    is_inside = spelled.endswith('"') or spelled.startswith("Array[")
    has_parts = is_inside and next(_inner(element), None) is not None
    return has_parts and any(local(each) == "StartValue" for each in element.iter())


def read_nested(element: XmlNode) -> Value | None:
    """Return the value of a member with its parts; None where it has none, or they do not fit."""
    try:
        return assembled(_entries(element, ()), _type_of(element), {})
    except ValuePathError:
        return None


def _inner(element: N) -> Iterator[N]:
    """Yield the members that a member lists, of its structure or of its type."""
    for child in children(element):
        if local(child) == "Member":
            yield child
        elif local(child) == "Sections":
            for section in children(child):
                yield from (member for member in children(section) if local(member) == "Member")


def _type_of(element: XmlNode) -> DataType:
    """Return the type of a member, with the members that it lists in place of the name of a type."""
    type_: DataType = _TYPES.validate_python(read_type(element.get("Datatype", "")))
    members = [Variable(name=each.get("Name", ""), type=_type_of(each)) for each in _inner(element)]
    return _with_members(type_, members) if members else type_


def _with_members(type_: DataType, members: list[Variable]) -> DataType:
    if isinstance(type_, ArrayType):
        return ArrayType(dimensions=type_.dimensions, base=_with_members(type_.base, members))
    return StructType(members=members)


def _entries(element: XmlNode, around: tuple[str | int, ...]) -> Iterator[tuple[Path, str]]:
    """Start values in a member. `around`: names on the way to it, and how many indices the arrays there have."""
    type_ = read_type(element.get("Datatype", ""))
    ranks: tuple[int, ...] = ()
    while type_["kind"] == "array":
        ranks += (len(type_["dimensions"]),)
        type_ = type_["base"]
    way = (*around, *ranks)
    for child in children(element):
        if local(child) == "StartValue" and child.text and child.get("Informative") != "true":
            if any(isinstance(part, int) for part in way):
                raise ValuePathError("one start value is given to all elements")
            yield tuple(part for part in way if isinstance(part, str)), child.text
        elif local(child) == "Subelement":
            texts = [value.text for value in children(child) if local(value) == "StartValue" and value.text]
            if len(texts) != 1:
                raise ValuePathError("an element has no start value, or several")
            yield _placed(way, child.get("Path", "")), texts[0] or ""
    for member in _inner(element):
        yield from _entries(member, (*way, member.get("Name", "")))


def _placed(way: tuple[str | int, ...], text: str) -> Path:
    """Return a way with the indices of a ``Subelement``."""
    if not _INDICES.fullmatch(text):
        raise ValuePathError("the path of an element is no list of indices")
    indices = [int(index) for index in text.split(",")]
    found: list[str | tuple[int, ...]] = []
    for part in way:
        if isinstance(part, str):
            found.append(part)
        else:
            found.append(tuple(indices[:part]))
            indices = indices[part:]
    if indices:
        raise ValuePathError("the path of an element has too many indices")
    return tuple(found)


def write_nested(element: etree._Element, type_: DataType, value: Value | None, types: Mapping[str, DataType]) -> bool:
    """Give the parts of a member that is written the start values of `value`; False where TIA Portal has none such.

    The members of a PLC data type are added where it is known.
    """
    if read_nested(element) == value:
        return True
    if next(_inner(element), None) is not None:
        type_ = _type_of(element)
    try:
        entries = [] if value is None else list(apart(value, type_, types))
        if value != assembled(entries, type_, types):  # what does not come back would be lost without a word
            return False
        places = [_find(element, path, types) for path, _ in entries]
    except ValuePathError:
        return False
    for old in list(element.iter("{*}StartValue", "{*}Subelement")):
        parent = old.getparent()
        if parent is not None:
            parent.remove(old)
    for (member, indices), (_, text) in zip(places, entries, strict=True):
        holder = sub(member, "Subelement", {"Path": indices}) if indices else member
        sub(holder, "StartValue").text = legal_text(text)
    return True


def _find(element: etree._Element, path: Path, types: Mapping[str, DataType]) -> tuple[etree._Element, str]:
    """Return the member at the end of a way, and the indices of its element."""
    indices: list[str] = []
    for part in path:
        if isinstance(part, tuple):
            indices += map(str, part)
            continue
        found = next((m for m in _inner(element) if m.get("Name", "").casefold() == part.casefold()), None)
        if found is None:
            _add_members(element, types)
            found = next((m for m in _inner(element) if m.get("Name", "").casefold() == part.casefold()), None)
        if found is None:
            raise ValuePathError(f"there is no member {part}")
        element = found
    return element, ",".join(indices)


def _add_members(element: etree._Element, types: Mapping[str, DataType]) -> None:
    """List the members of the PLC data type of a member."""
    type_: DataType = _TYPES.validate_python(read_type(element.get("Datatype", "")))
    while isinstance(type_, ArrayType):
        type_ = type_.base
    struct = types.get(type_.name.casefold()) if isinstance(type_, DerivedType) else None
    if any(True for _ in _inner(element)) or not isinstance(struct, StructType):
        raise ValuePathError("its type is not known")
    _list_members(sub(sub(element, "Sections"), "Section", {"Name": "None"}), struct)


def _list_members(parent: etree._Element, struct: StructType) -> None:
    for member in struct.members:
        inner = sub(parent, "Member", {"Name": member.name, "Datatype": write_type(member.type)})
        base = member.type
        while isinstance(base, ArrayType):
            base = base.base
        if isinstance(base, StructType):
            _list_members(inner, base)


MEMBER_ATTRIBUTES = ("Version", "Remanence", "Accessibility", "Informative")
"""Attributes of ``Member`` itself; all others in `Variable.attributes` are in its ``AttributeList``."""
_INFORMATIVE = frozenset({"UserVisible", "UserReadOnly", "UserDeletable", "Offset", "PaddedSize"})
_SPELLED = frozenset({"elementary", "string", "array", "struct", "derived"})
"""Kinds of types that TIA Portal spells; others are kept."""
_INTEGERS = frozenset({"Offset", "PaddedSize"})
_ADDABLE = frozenset({"Static", "Base", "Input", "Output", "Return"})
_ELEMENTARY_TYPES: dict[str, ElementaryType] = {}
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
    added: Sequence[Variable] = (),
    kept_inside: Set[str] = frozenset(),
) -> etree._Element:
    """Write ``Interface``. `renamed` are new names of members that the chart of the block names.

    `graph`: the block has a chart, and needs the system parts of every sequencer. `static`: it has static variables,
    which functions have not. `added` are static variables that only TIA Portal wants, `kept_inside` the names of
    inputs, in lower case, that are static variables there.
    """
    element = sub(parent, "Interface")
    for key, value in (interface.extension_data.attributes if interface.extension_data is not None else {}).items():
        element.set(key, value)
    sections = ctx.root("Interface", "Sections", element)
    for content in interface.extension_data.elements if interface.extension_data is not None else ():
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


def _add_static(ctx: DocumentWriting, sections: etree._Element, added: Sequence[Variable]) -> None:
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
    for content in section.extension_data.elements if section.extension_data is not None else ():
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


def write_members(ctx: DocumentWriting, parent: etree._Element, struct: StructType) -> None:
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
    variable: Variable,
    name: str | None = None,
    *,
    starts: bool = True,
    is_passed: bool = False,
) -> None:
    """Write ``Member``. `starts`: it can have a start value: it is not temporary, and of no function.

    `is_passed`: calls of a function give its value, so that the start value of its type is not that of the parameter.
    """
    kept = variable.extension_data.attributes if variable.extension_data is not None else {}
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
    unknown = list(variable.extension_data.elements) if variable.extension_data is not None else []
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
    reported: set[str] = set()
    also: dict[str, Any] = {}
    if (told := open_address(ctx.project, variable)) is not None:
        reported.add("address")
        ctx.note(Outcome.APPROXIMATED, "address", variable.name, told)
    start = ctx.s7_types.start(variable) if starts or ctx.options.same else None
    starts_itself = variable.initial is not None or not is_passed
    if not starts and starts_itself and not ctx.options.same and ctx.s7_types.start(variable) is not None:
        reported.add("initial")
        ctx.note(Outcome.NOT_EXECUTED, "initial", variable.name, NO_START)
    if isinstance(start, StructValue) and isinstance(type_, StructType):
        if write_nested(element, type_, start, ctx.s7_types.declared):
            native.discard("type")  # read, the values are those of its members
            reported |= {"type", "initial"}
    elif has_nested(element) or (start is not None and _is_nested(type_)):
        if write_nested(element, type_, start, ctx.s7_types.declared):
            native.add("initial")
    elif isinstance(start, SimpleValue):
        sub(element, "StartValue", _marks(kept, "StartValue")).text = legal_text(start.text or "") or None
        (native if start == variable.initial else reported).add("initial")
    elif start is not None and write_elements(element, type_, start):
        (native if start == variable.initial else reported).add("initial")
    elif start is not None and variable.initial is None:
        why = "its elements do not start with the initial value of their type, which TIA Portal cannot express here"
        ctx.note(Outcome.NOT_EXECUTED, "initial", variable.name, why)
    passed = ctx.action_calls.starts.of(ctx.pou) if ctx.pou is not None and isinstance(start, StructValue) else {}
    if (by_calls := passed.get(variable.name.casefold())) is not None and "initial" not in native:
        reported.add("initial")
        why = "calls pass it" if by_calls.values else "without effect: all calls pass these inputs"
        ctx.note(Outcome.TRANSLATED, "initial", variable.name, why)
    if start is not None and variable.initial is None:
        also = {"initial": None}
    if _reports_type(ctx, variable, type_, spelled):
        native.discard("type")
        reported.add("type")
    if "type" not in native or also or (variable.initial is not None and "initial" not in native):
        also[WRITTEN] = member_digests(element)
    finish(ctx, element, variable, frozenset(native), also=also, reported=frozenset(reported))


def _reports_type(ctx: DocumentWriting, variable: Variable, type_: DataType, spelled: str) -> bool:
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


def _is_nested(type_: DataType) -> bool:
    """True if members have the start values of a type: it is a PLC data type, or an array of structures."""
    base = type_
    while isinstance(base, ArrayType):
        base = base.base
    return isinstance(base, DerivedType) or (isinstance(base, StructType) and base is not type_)


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


def spelling(type: DataType, kept: dict[str, str]) -> str:
    """Return the spelling of the file as long as it is the same type, else that of TIA Portal."""
    spelled = kept.get("Datatype")
    if spelled is not None and _without_members(type) == read_type(spelled):
        return spelled
    return write_type(type)


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
