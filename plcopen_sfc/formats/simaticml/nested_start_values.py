"""Start values of the parts of a member: elements of arrays, members of its structure or of its PLC data type.

The elements of an array have one ``Subelement`` each by their indices, in the model one value of the array. A member of
a PLC data type repeats the members of the type in ``Sections``, with the start values of this variable. Of an array of
structures the members have one ``Subelement`` for each element; its path has the indices of the array, then those of
the member itself, where it is an array too (seen in exports of V16: ``Path="62,13"``).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping

from lxml import etree
from pydantic import TypeAdapter

from plcopen_sfc.formats.simaticml.declaration_spelling import (
    read_type,
    write_type,
)
from plcopen_sfc.formats.simaticml.element_reader import (
    Fields,
    N,
    XmlNode,
    children,
    local,
)
from plcopen_sfc.formats.simaticml.element_writer import sub
from plcopen_sfc.formats.xml.extension_data import legal_text
from plcopen_sfc.languages.start_values import Path, ValuePathError, apart, assembled
from plcopen_sfc.model import types as t

_TYPES: TypeAdapter[t.DataType] = TypeAdapter(t.DataType)
_INDICES = re.compile(r"-?\d{1,9}(?:,-?\d{1,9})*")


def read_elements(type: Fields, elements: list[etree._Element]) -> t.Value | None:
    """Return the value of an array whose elements have these start values; None where they hold more, or do not fit.

    An element without a value of its own has the default of its type: it is a value without text.
    """
    entries: list[tuple[Path, str]] = []
    last: tuple[int, ...] = ()
    for element in elements:
        path, inner = element.get("Path", ""), children(element)
        plain = len(inner) == 1 and local(inner[0]) == "StartValue" and not inner[0].attrib and not len(inner[0])
        if not plain or not inner[0].text or set(element.attrib) != {"Path"} or not _INDICES.fullmatch(path):
            return None
        indices = tuple(map(int, path.split(",")))
        if indices <= last or _joined(indices) != path:  # they would be written in another order, or otherwise
            return None
        entries.append(((indices,), inner[0].text))
        last = indices
    try:
        return assembled(entries, _TYPES.validate_python(type), {}) if type["kind"] == "array" else None
    except ValuePathError:
        return None


def write_elements(parent: etree._Element, type: t.DataType, value: t.Value) -> bool:
    """Write the start values of an array; False where they are none that TIA Portal can have."""
    if not isinstance(type, t.ArrayType) or not isinstance(value, t.ArrayValue):
        return False
    for item in value.items:
        if not isinstance(item.value, t.SimpleValue) or (item.value.text is not None and not item.value.text.strip()):
            return False
    try:
        entries = list(apart(value, type, {}))
    except ValuePathError:
        return False
    for (indices,), text in entries:
        element = sub(parent, "Subelement", {"Path": _joined(indices)})
        sub(element, "StartValue").text = legal_text(text)
    return True


def _joined(indices: Iterable[object]) -> str:
    return ",".join(map(str, indices))


def has_nested(element: XmlNode) -> bool:
    """True if a member has start values in its parts, which are its own: those of structures belong to their members.

    Types of the system have start values that are of no effect or belong to their blocks.
    """
    spelled = element.get("Datatype", "")
    is_inside = spelled.endswith('"') or spelled.startswith("Array[")
    has_parts = is_inside and next(_inner(element), None) is not None
    return has_parts and any(local(each) == "StartValue" for each in element.iter())


def read_nested(element: XmlNode) -> t.Value | None:
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


def _type_of(element: XmlNode) -> t.DataType:
    """Return the type of a member, with the members that it lists in place of the name of a type."""
    type_: t.DataType = _TYPES.validate_python(read_type(element.get("Datatype", "")))
    members = [t.Variable(name=each.get("Name", ""), type=_type_of(each)) for each in _inner(element)]
    return _with_members(type_, members) if members else type_


def _with_members(type_: t.DataType, members: list[t.Variable]) -> t.DataType:
    if isinstance(type_, t.ArrayType):
        return t.ArrayType(dimensions=type_.dimensions, base=_with_members(type_.base, members))
    return t.StructType(members=members)


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


def write_nested(
    element: etree._Element, type_: t.DataType, value: t.Value | None, types: Mapping[str, t.DataType]
) -> bool:
    """Give the parts of a member that is written the start values of `value`; False where TIA Portal has none such.

    The members of a PLC data type are added where it is known.
    """
    if read_nested(element) == value:
        return True
    if next(_inner(element), None) is not None:
        type_ = _type_of(element)
    try:
        entries = [] if value is None else list(apart(value, type_, types))
        again = assembled(entries, type_, types)
        if again is not None and list(apart(again, type_, types)) != entries:
            return False  # what does not come back would be lost without a word
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


def _member(element: etree._Element, name: str) -> etree._Element | None:
    return next((each for each in _inner(element) if each.get("Name", "").casefold() == name.casefold()), None)


def _find(element: etree._Element, path: Path, types: Mapping[str, t.DataType]) -> tuple[etree._Element, str]:
    """Return the member at the end of a way, and the indices of its element."""
    indices: list[int] = []
    for part in path:
        if isinstance(part, tuple):
            indices += part
            continue
        found = _member(element, part)
        if found is None:
            _add_members(element, types)
            found = _member(element, part)
        if found is None:
            raise ValuePathError(f"there is no member {part}")
        element = found
    return element, _joined(indices)


def _add_members(element: etree._Element, types: Mapping[str, t.DataType]) -> None:
    """List the members of the PLC data type of a member."""
    type_ = t.element_type(_TYPES.validate_python(read_type(element.get("Datatype", ""))))
    struct = types.get(type_.name.casefold()) if isinstance(type_, t.DerivedType) else None
    if any(True for _ in _inner(element)) or not isinstance(struct, t.StructType):
        raise ValuePathError("its type is not known")
    _list_members(sub(sub(element, "Sections"), "Section", {"Name": "None"}), struct)


def _list_members(parent: etree._Element, struct: t.StructType) -> None:
    for member in struct.members:
        inner = sub(parent, "Member", {"Name": member.name, "Datatype": write_type(member.type)})
        base = t.element_type(member.type)
        if isinstance(base, t.StructType):
            _list_members(inner, base)
