"""Archives of objects: the form in which TwinCAT 3 and CODESYS V3 store what has no text (``XmlArchive``).

An object is ``<o t="Type">``, its members stand in it in a fixed order: values (``v``), objects, lists (``l2``, ``l``),
dictionaries (``d2``: keys and values in turn), ``n`` for none. A list whose items are all of one type names that type
once, in ``cet``. ``TypeList`` gives the identity of each type that occurs. (14 files of TwinCAT 3.1.4024)

Data of objects that the model does not have is kept as one piece of extension data of the object.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import NamedTuple, cast
from uuid import UUID

from lxml import etree

from plcopen_sfc.formats.xml.extension_data import markup, parsed_markup
from plcopen_sfc.model.base import ExtensionData, ForeignData
from plcopen_sfc.whole_numbers import whole_number

_XML_SPACE = "{http://www.w3.org/XML/1998/namespace}space"

TYPES = {
    "ArrayList": "System.Collections.ArrayList",
    "Boolean": "System.Boolean",
    "Guid": "System.Guid",
    "Int64": "System.Int64",
    "String": "System.String",
    "BoolValue": "{89e1c7bb-c9f8-4be3-b8a7-019cdbb9f7e8}",
    "EnumEntry": "{4185e6da-1717-44c9-b705-102861764479}",
    "EnumValue": "{4dd7572b-4b9d-4d35-963e-6a34a4aaa5c1}",
    "EnumValueTemplate": "{d6bfe4f0-d62f-4b5f-9f95-2bbeb1950e28}",
    "Flags": "{27d8150b-ef58-4fff-8da1-1f7dd5f9ea51}",
    "SFCActionAssociation": "{a94bb75d-5fb3-40ad-9d01-41d5b980784d}",
    "SFCAttribute": "{21f3f16e-04fa-4637-b6b7-d84e4192e99f}",
    "SFCAttributeCategory": "{679adacf-f2a4-4167-a3f7-d21cfc5d451f}",
    "SFCAttributeDescription": "{d851789d-af2c-4990-9d48-a7bdc9181773}",
    "SFCBranch": "{e221b778-bb8f-44ba-8a6a-f796287d4e62}",
    "SFCElementList": "{587d6556-cfe6-4e76-9cc9-fc0daf0c8c29}",
    "SFCImplementationObject": "{74f81948-1328-492c-b6c1-a9ea72048b28}",
    "SFCJump": "{7e39ac27-154f-419a-a255-6a6cf37d5ed0}",
    "SFCMacro": "{ab40cf8e-1fe8-43b9-aac3-2242e32c7f9e}",
    "SFCProperty": "{58548d2c-f1b1-453d-9195-66c94e2a3ae0}",
    "SFCPropertyFlagData": "{24565a38-6368-4874-ab9a-0ef7ec269521}",
    "SFCSegment": "{f1db7f6f-4774-46a6-ad9b-a94414f875fc}",
    "SFCStep": "{86ee92a2-d863-4136-be27-82b36d84211c}",
    "SFCTransition": "{4ecb29e8-a90a-4646-84ac-2ff54215ab29}",
    "StringValue": "{778c8bac-3fa0-41e1-99d3-2b628d12d3e5}",
}
"""The types of objects in archives of charts and of their settings, and their identity."""


# -- reading ----------------------------------------------------------------------------------------------------------


def archived(archive: etree._Element) -> etree._Element | None:
    """Return the object in an ``XmlArchive``; None where there is none."""
    return archive.find("Data/o")


def unknown_type(archive: etree._Element) -> etree._Element | None:
    """Return the first entry of the ``TypeList`` that gives a known name another identity; None without any."""
    for entry in archive.iterfind("TypeList/Type"):
        known = TYPES.get(entry.get("n", ""))
        if known is not None and (entry.text or "").strip().casefold() != known.casefold():
            return entry
    return None


def has_types(archive: etree._Element) -> bool:
    """True if an archive lists the types of its objects."""
    return archive.find("TypeList/Type") is not None


def unlisted_type(archive: etree._Element) -> str:
    """Return the first type of the objects, by name, that the ``TypeList`` does not have; empty without any.

    Exports of CODESYS V3 have no list: there each object has the identity of its type.
    """
    if not has_types(archive):
        return ""
    used = {*cast("list[str]", _TYPES_OF_OBJECTS(archive)), *cast("list[str]", _TYPES_OF_ITEMS(archive))}
    listed = {entry.get("n", "") for entry in archive.iterfind("TypeList/Type")}
    return min((used & TYPES.keys()) - listed, default="")


# one path for both would put them into the order of the file, and strings that know their element take longer still
_TYPES_OF_OBJECTS = etree.XPath("Data//@t", smart_strings=False)
_TYPES_OF_ITEMS = etree.XPath("Data//@cet", smart_strings=False)


def type_of(item: etree._Element) -> str:
    """Return the type of an object: its own, or the one that the list around it gives all of its items."""
    own = item.get("t")
    return own if own is not None else type_of_items(item)


def type_of_items(item: etree._Element) -> str:
    """Return the type that the list around an object gives all of its items; empty where it gives none."""
    parent = item.getparent()
    return (parent.get("cet") or parent.get("cvt") or "") if parent is not None else ""


def member(thing: etree._Element, name: str) -> etree._Element | None:
    """Return the member of an object with this name."""
    for child in thing:
        if child.get("n") == name:
            return child
    return None


def items(thing: etree._Element, name: str) -> list[etree._Element]:
    """Return the items of the list `name` of an object."""
    found = member(thing, name)
    return [child for child in found if isinstance(child.tag, str)] if found is not None else []


def text_of(value: etree._Element | None) -> str | None:
    """Return the text of a value: without its quotes where it is a string; None where there is no value."""
    if value is None or value.tag != "v":
        return None
    text = value.text or ""
    return text[1:-1] if text[:1] == text[-1:] == '"' and len(text) > 1 else text


def number_of(value: etree._Element | None) -> int | None:
    """Return a whole number (``11L``); None where the value is none."""
    return whole_number((text_of(value) or "").removesuffix("L"))


def entries(thing: etree._Element, name: str) -> Iterator[tuple[str, etree._Element]]:
    """Yield keys and values of the dictionary `name` of an object."""
    found = items(thing, name)
    for key, value in zip(found[::2], found[1::2], strict=False):
        yield text_of(key) or "", value


# -- writing ----------------------------------------------------------------------------------------------------------


def archive_of(thing: etree._Element, also: Iterable[str]) -> etree._Element:
    """Return ``XmlArchive`` with the object `thing` and its type; `also`: types of values in it."""
    archive = etree.Element("XmlArchive")
    thing.set(_XML_SPACE, "preserve")
    # as the tools write it: before the type
    kind = thing.attrib.pop("t")
    thing.set("t", str(kind))
    etree.SubElement(archive, "Data").append(thing)
    used = {type_of(each) for each in thing.iter("o")} | {each.get("t", "") for each in thing.iter("l")}
    listed = etree.SubElement(archive, "TypeList")
    for name in sorted((used & TYPES.keys()) | set(also), key=str.casefold):
        etree.SubElement(listed, "Type", n=name).text = TYPES[name]
    return archive


def new_object(kind: str, name: str = "") -> etree._Element:
    """Return an object of a type, as the member `name` of another one or as an item."""
    attributes = {"n": name, "t": kind} if name else {"t": kind}
    return etree.Element("o", attributes)


def add_value(thing: etree._Element, name: str, text: str) -> None:
    """Append a value that is no string: a number, a truth, an identity."""
    etree.SubElement(thing, "v", n=name).text = text


def add_text(thing: etree._Element, name: str, text: str) -> None:
    """Append a string."""
    add_value(thing, name, f'"{text}"')


def add_none(thing: etree._Element, *names: str) -> None:
    """Append members without a value."""
    for name in names:
        etree.SubElement(thing, "n", n=name)


def add_list(thing: etree._Element, name: str, found: Iterable[etree._Element] = ()) -> None:
    """Append a list of objects."""
    _fill(etree.SubElement(thing, "l2", n=name), found)


def add_array(thing: etree._Element, name: str, found: Iterable[etree._Element]) -> None:
    """Append a list of the kind that values of enumerations are in."""
    _fill(etree.SubElement(thing, "l", n=name, t="ArrayList"), found)


def _fill(holder: etree._Element, found: Iterable[etree._Element]) -> None:
    holder.extend(found)
    kinds = {each.get("t", "") for each in holder}
    if len(kinds) == 1:
        holder.set("cet", kinds.pop())
        for each in holder:
            del each.attrib["t"]


def add_dictionary(
    thing: etree._Element, name: str, types: tuple[str, str], found: Mapping[str, etree._Element]
) -> None:
    """Append a dictionary of objects that are all of one type. `types` are those of its keys and of these objects."""
    key_type, kind = types
    holder = etree.SubElement(thing, "d2", n=name, ckt=key_type, cvt=kind)
    for key, value in found.items():
        etree.SubElement(holder, "v").text = key
        del value.attrib["t"]
        holder.append(value)


def identity(text: str) -> str:
    """Return an identity as values hold it."""
    return f"{{{UUID(text)}}}"


_NAME = "urn:plcopen-sfc:twincat"
_PLAIN = re.compile(r"[\w .\\/-]*", re.ASCII)


class Kept(NamedTuple):
    """Attributes and elements that were kept."""

    attributes: dict[str, str]
    elements: list[etree._Element]


def kept_data(attributes: dict[str, str], elements: Collection[etree._Element] = ()) -> list[ForeignData]:
    """Return the extension data that keeps attributes and elements; none where there are none."""
    if len(attributes) == 1 and not elements:
        [(name, value)] = attributes.items()
        if _PLAIN.fullmatch(value):  # at each transition: an element takes a twentieth of the reading
            return [ForeignData(name=_NAME, content=f'<twincat xmlns="" {name}="{value}"></twincat>')]
    if not attributes and not elements:
        return []
    holder = etree.Element("twincat", attributes)
    holder.extend(elements)
    return [ForeignData(name=_NAME, content=markup(holder))]


def kept_in(extension_data: ExtensionData | None) -> Kept:
    """Return the content of the extension data of an object."""
    for data in extension_data.data if extension_data is not None else ():
        if data.name == _NAME:
            holder = parsed_markup(data.content)
            return Kept({str(name): str(value) for name, value in holder.attrib.items()}, list(holder))
    return Kept({}, [])
