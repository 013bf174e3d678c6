"""Objects of an export of CODESYS V3, as elements of `formats.archives` and back.

A file is a flat list of entries. Each has the identity, the name and the kind of an object, the identity of the object
around it, and its content. Actions, methods and transition objects are entries of their own, with a POU as parent.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import cast
from uuid import UUID

from lxml import etree

from plcopen_sfc.errors import StructureError
from plcopen_sfc.formats.archives.object_archive import TYPES
from plcopen_sfc.formats.codesys_export.export_notation import (
    NONE,
    SINGLE,
    broken_texts,
    change_text,
    member,
    new_text,
    repeated_lines,
    shortened,
    spelled_out,
    take_line,
    text_of,
    value,
)
from plcopen_sfc.formats.xml.extension_data import markup
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.whole_numbers import whole_number

POU, TYPE, LIST, INTERFACE, TASK, APPLICATION = "POU", "DUT", "GVL", "Itf", "Task", "application"
ACTION, METHOD, TRANSITION, PROPERTY, ACCESSOR = "Action", "Method", "Transition", "Property", "accessor"
INTERFACE_METHOD, _FOLDER, _PERSISTENT = "interface method", "folder", "persistent variables"
PARTS = (ACTION, METHOD, TRANSITION)
INNER = frozenset({*PARTS, INTERFACE_METHOD, PROPERTY, ACCESSOR})
"""The kinds of objects inside others."""

_KINDS = {
    "6f9dac99-8de1-4efc-8465-68ac443b7d08": POU,
    "2db5746d-d284-4425-9f7f-2663a34b0ebc": TYPE,
    "ffbfa93a-b94d-45fc-a329-229860183b1d": LIST,
    "6654496c-404d-479a-aad2-8551054e5f1e": INTERFACE,
    "8ac092e5-3128-4e26-9e7e-11016c6684f2": ACTION,
    "f8a58466-d7f6-439f-bbb8-d4600e41d099": METHOD,
    "f89f7675-27f1-46b3-8abb-b7da8e774ffd": INTERFACE_METHOD,
    "a10c6218-cb94-436f-91c6-e1652575253d": TRANSITION,
    "5a3b8626-d3e9-4f37-98b5-66420063d91e": PROPERTY,
    "792f2eb6-721e-4e64-ba20-bc98351056db": ACCESSOR,
    "98a2708a-9b18-4f31-82ed-a1465b24fa2d": TASK,
    "639b491f-5557-464c-af91-1471bac9f549": APPLICATION,
    "738bea1e-99bb-4f04-90bb-a7a567e74e3a": _FOLDER,
    "225bfe47-7336-4dbc-9419-4105a7c831fa": "device",
    "40b404f9-e5dc-42c6-907f-c89f4a517386": "PLC logic",
    "adb5cb65-8e1d-4a00-b70a-375ea27582f3": "library manager",
    "ae1de277-a207-4a28-9efb-456c06bd52f3": "task configuration",
    "261bd6e6-249c-4232-bb6f-84c2fbeef430": _PERSISTENT,
    "085afe48-c5d8-4ea5-ab0d-b35701fa6009": "project information",
    "bb0b9044-714e-4614-ad3e-33cbdf34d16b": "image pool",
    "63784cbb-9ba0-45e6-9d69-babf3f040511": "text list",
    "2bef0454-1bd3-412a-ac2c-af0f31dbc40f": "text list",
    "f18bec89-9fef-401d-9953-2f11739a6808": "visualization",
}
_GUIDS = {kind: guid for guid, kind in reversed(_KINDS.items())}
TREE = frozenset({_FOLDER, "device", "PLC logic", APPLICATION, "task configuration", "project information"})
"""The kinds that only arrange or describe others."""
KNOWN = frozenset(_KINDS.values())
"""The kinds of objects that have a word of their own."""

TEXT, CHART = "{3b83b776-fb25-43b8-99f2-3c507c9143fc}", TYPES["SFCImplementationObject"]
_DRAWN = {"{25e509de-33d4-4447-93f8-c9e4ea381c8b}": "NWL", "{32d3375e-c010-41e2-9e43-b2fbf4f2b374}": "CFC"}
_DECLARED = "{a9ed5b7e-75c5-4651-af16-d2c27e98cb94}"
_SETTINGS = TYPES["SFCProperty"].strip("{}")
_ENTRY, _META = "{6198ad31-4b98-445c-927f-3258a0e82fe3}", "{81297157-7ec9-45ce-845e-84cab2b88ade}"
_PROPERTIES = "{2c41fa04-1834-41c1-816e-303c7aa2c05b}"
NOWHERE = str(UUID(int=0))
_SECTION_WORDS = frozenset({"VAR_GLOBAL", "CONSTANT", "RETAIN", "PERSISTENT", "END_VAR"})
_OF_PATHS = frozenset({"DOT", "LSQB"})
"""What is behind the first name of a path of an instance, as in ``Main.Valves[1].Count : INT;``."""


@dataclass(frozen=True, slots=True)
class Entry:
    """An entry of an export."""

    element: etree._Element

    @property
    def guid(self) -> str:
        """Identity of the object."""
        return value(self.element, "MetaObject", "Guid").casefold()

    @property
    def parent(self) -> str:
        """Identity of the object around it."""
        return value(self.element, "MetaObject", "ParentGuid").casefold()

    @property
    def name(self) -> str:
        """Name of the object."""
        return value(self.element, "MetaObject", "Name")

    @property
    def kind(self) -> str:
        """Kind of the object: a word for it, or the identity of its type where none is known.

        Persistent variables are a list of global variables, unless they name some of instances by their paths.
        """
        kind = _KINDS.get(self.type_guid, self.type_guid)
        return LIST if kind == _PERSISTENT and not _OF_PATHS & _behind_names(self) else kind

    @property
    def type_guid(self) -> str:
        """Identity of the type of the object."""
        return value(self.element, "MetaObject", "TypeGuid").casefold()

    @property
    def content(self) -> etree._Element | None:
        """The object itself."""
        return member(self.element, "Object")

    @property
    def has_code(self) -> bool:
        """True if the object has a declaration or a body."""
        parts = (member(self.content, name) for name in ("Interface", "Implementation"))
        return any(part is not None and part.tag != NONE for part in parts)


def _behind_names(entry: Entry) -> frozenset[str]:
    """Return the types of the tokens behind the names that a list of variables declares."""
    text = text_of(member(entry.content, "Interface"))
    tokens = tokenize(text[0], Dialect.CODESYS).tokens if text is not None else []
    begins = [each.type == "SEMICOLON" or each.value.upper() in _SECTION_WORDS for each in tokens]
    places = (place for place in range(1, len(tokens) - 1) if begins[place - 1] and not begins[place])
    return frozenset(tokens[place + 1].type for place in places)


def entry_lists(root: etree._Element) -> list[etree._Element]:
    """Return the lists of entries of a file: one for each tree of the project (POUs, devices)."""
    found = (member(archive, "EntryList") for archive in root.iterfind(f"StructuredView/{SINGLE}"))
    return [each for each in found if each is not None]


def entries(root: etree._Element) -> Iterator[Entry]:
    """Yield the entries of a file."""
    for held in entry_lists(root):
        for child in held.iterchildren(SINGLE):
            yield Entry(child)


_OBJECTS = etree.XPath("descendant::*[@Name='MetaObject']/..")


def unlisted(root: etree._Element) -> Iterator[Entry]:
    """Yield the objects of a file that are in no list of entries."""
    listed = {entry.element for entry in entries(root)}
    for each in cast("list[etree._Element]", _OBJECTS(root)):
        if each not in listed and listed.isdisjoint(each.iterancestors()):
            yield Entry(each)


def around(entry: Entry, known: Mapping[str, Entry]) -> Entry | None:
    """Return the object that an entry is in, not a folder of it; None where the file does not have it.

    `known` has the entries of the file by their identities.
    """
    found = known.get(entry.parent)
    passed = {entry.guid}
    while found is not None and found.kind == _FOLDER and found.guid not in passed:
        passed.add(found.guid)
        found = known.get(found.parent)
    return found


def inner_entries(found: Iterable[Entry]) -> dict[str, list[Entry]]:
    """Return the entries of objects in others, by the identity of these."""
    all_of_them = list(found)
    known = {entry.guid: entry for entry in all_of_them}
    inside = ((around(entry, known), entry) for entry in all_of_them if entry.kind in INNER)
    return grouped((owner.guid, entry) for owner, entry in inside if owner is not None)


def why_not_read(entry: Entry, known: Mapping[str, Entry], inner: Mapping[str, Sequence[Entry]]) -> str:
    """Return why an object is not read that is a part of the program, or may be; empty where nothing is lost.

    `known` has the entries of the file by their identities, `inner` those in others.
    """
    if not entry.kind:
        return "it does not tell its kind (TypeGuid)"
    if entry.kind not in KNOWN:
        names = ", ".join(each.name for each in inner.get(entry.guid, ()))
        held = f"holds {names}" if names else "has a declaration or a body" if entry.has_code else ""
        return f"its kind {entry.kind} is not known, and it {held}" if held else ""
    if entry.kind == _PERSISTENT and not _behind_names(entry) <= _OF_PATHS:
        return "it declares variables beside paths of instances"
    if entry.kind in INNER:
        owner = around(entry, known)
        if owner is None:
            return f"the object {entry.parent or '(none)'} around it is not in the file"
        if owner.kind in KNOWN and owner.kind not in ((PROPERTY,) if entry.kind == ACCESSOR else (POU, INTERFACE)):
            return f"{owner.name} around it is a {owner.kind}"
    return ""


_TO_TASKS = 2
"""The path to a task ends with the application and its task configuration."""
_IN_TASK = (
    ("Kindoftask",),
    ("Priority",),
    ("Watchdog", "Enabled"),
    ("Watchdog", "Time", "Time"),
    ("Watchdog", "Time", "Unit"),
    ("Watchdog", "Sensitivity"),
    ("Interval", "Time"),
    ("Interval", "Unit"),
    ("Event",),
    ("PouList",),
)


def damages(entry: Entry, known: Mapping[str, Entry]) -> Iterator[tuple[str, etree._Element]]:
    """Yield what an entry of an object that is read lacks, and the element that lacks it.

    `known` has the entries of the file by their identities.
    """
    element, content = entry.element, entry.content
    if content is not None and content.get("Type", "").strip("{}").casefold() != entry.type_guid:
        yield "Object of its kind (TypeGuid)", element
    for name in ("Guid", "Name"):
        if not value(element, "MetaObject", name):
            yield name, element
    is_declared = entry.kind in (INTERFACE, INTERFACE_METHOD) or "Interface" in _MEMBERS.get(entry.kind, ())
    needed = _IN_TASK if entry.kind == TASK else [("Interface",)] if is_declared else []
    for path in needed:
        if member(content, *path) is None:
            yield " ".join(path), element
    for name in ("Interface", "Implementation"):
        held = member(content, name)
        if held is not None and held.tag != NONE and held.get("Type", "").casefold() in (TEXT, _DECLARED):
            yield from (("the text", each) for each in broken_texts(held))
            yield from (("a number of its own for each line", each) for each in repeated_lines(held))
    if entry.kind == TASK:
        yield from ((what, element) for what in _damages_of_task(entry, known))
        calls = member(content, "PouList")
        yield from (("Name", call) for call in (calls if calls is not None else ()) if not value(call, "Name"))


def _damages_of_task(entry: Entry, known: Mapping[str, Entry]) -> Iterator[str]:
    if whole_number(value(entry.content, "Priority").strip()) is None:
        yield "a number as Priority"
    if value(entry.content, "Watchdog", "Enabled").casefold() not in ("true", "false"):
        yield "True or False as Watchdog Enabled"
    path, holder = ObjectPlace.of(entry).path, known.get(entry.parent)
    if len(path) < _TO_TASKS or (holder is not None and path != ObjectPlace.inside(holder).path):
        yield "the Path to it"


# -- reading ----------------------------------------------------------------------------------------------------------


def element_of(entry: Entry, inner: Mapping[str, Sequence[Entry]]) -> etree._Element:
    """Return an object, with those that `inner` has for it, as the element that files of TwinCAT hold.

    Raises `StructureError`.
    """
    return _element(entry.kind, entry, inner)


def _element(tag: str, entry: Entry, inner: Mapping[str, Sequence[Entry]]) -> etree._Element:
    written = etree.Element(tag, Name=entry.name, Id=f"{{{entry.guid}}}")
    take_line(written, entry.element)
    special = value(entry.content, "SpecialFunc")
    if entry.kind == POU and special not in ("", "None"):
        written.set("SpecialFunc", special)
    _add_code(written, entry)
    for child in inner.get(entry.guid, ()):
        if child.kind == ACCESSOR and child.name.capitalize() not in ("Get", "Set"):
            raise StructureError(f"the accessor {child.name or '(none)'} of {entry.name} is neither Get nor Set")
        if child.kind in INNER and child.guid != entry.guid:
            kind = METHOD if child.kind == INTERFACE_METHOD else child.kind
            written.append(_element(child.name.capitalize() if kind == ACCESSOR else kind, child, inner))
    return written


def _add_code(written: etree._Element, entry: Entry) -> None:
    """Add declaration, body and settings of an object."""
    declared = text_of(member(entry.content, "Interface"))
    if declared is not None:
        etree.SubElement(written, "Declaration").text = declared[0]
        take_line(written[-1], declared[1])
    body = member(entry.content, "Implementation")
    if body is not None:
        holder = etree.SubElement(written, "Implementation")
        take_line(holder, body)
        kind = body.get("Type", "").casefold()
        text = text_of(body) if kind == TEXT else None
        if text is not None:
            etree.SubElement(holder, "ST").text = text[0]
        elif kind == CHART:
            _archive(etree.SubElement(holder, "SFC"), body)
        elif body.tag != NONE:
            drawn = etree.SubElement(holder, _DRAWN.get(kind, "other"))
            drawn.append(etree.fromstring(etree.tostring(body, with_tail=False)))
        for each in holder.iterchildren():
            take_line(each, body)
    settings = _settings(entry.element)
    if settings is not None:
        _archive(etree.SubElement(written, "ObjectProperties"), settings)


def _archive(holder: etree._Element, thing: etree._Element) -> None:
    etree.SubElement(etree.SubElement(holder, "XmlArchive"), "Data").append(shortened(thing))


def _settings(entry: etree._Element) -> etree._Element | None:
    """Return the settings of a chart, which are a property of its object."""
    return next((held[0] for held in _settings_values(entry) if len(held)), None)


def _settings_values(entry: etree._Element) -> Iterator[etree._Element]:
    properties = member(entry, "MetaObject", "Properties")
    for each in properties.iterchildren("Entry") if properties is not None else ():
        if (each.findtext(f"Key/{SINGLE}") or "").casefold() == _SETTINGS:
            yield from each.iterchildren("Value")


# -- writing ----------------------------------------------------------------------------------------------------------


def put(entry: Entry, written: etree._Element, *, keep_body: bool = False) -> None:
    """Change an entry to the content of the element `written` of its object; `keep_body`: but for its body."""
    content = entry.content
    named = member(entry.element, "MetaObject", "Name")
    if content is None or named is None:
        return
    named.text = written.get("Name", "")
    declaration = written.find("Declaration")
    held = member(content, "Interface")
    if declaration is not None and held is not None and (text_of(held) or [None])[0] != (declaration.text or ""):
        change_text(held, declaration.text or "")
    if not keep_body:
        _put_body(entry, content, written)
    generator = member(content, "UniqueIdGenerator")
    greatest = whole_number(generator.text) if generator is not None else None
    if generator is not None and greatest is not None:
        used = (whole_number(each.text) for each in content.iter(SINGLE) if each.get("Name") == "Id")
        generator.text = str(max(greatest, *filter(None, used), 0))


def _put_body(entry: Entry, content: etree._Element, written: etree._Element) -> None:
    body = written.find("Implementation/*")
    old = member(content, "Implementation")
    if body is None or old is None:
        return
    if body.tag == "ST":
        if old.get("Type", "").casefold() != TEXT:
            _change_type(entry, old, TEXT)
        if (text_of(old) or [None])[0] != (body.text or ""):
            change_text(old, body.text or "")
    elif body.tag == "SFC":
        chart = spelled_out(body[0].find("Data")[0])  # type: ignore[index]  # our own writer made it
        if old.get("Type", "").casefold() != CHART:
            _change_type(entry, old, CHART)
        old[:] = list(chart)
    elif len(body) and markup(body[0]) != markup(old):
        _change_type(entry, old, body[0].get("Type", ""))
        old[:] = list(body[0])
    settings = written.find("ObjectProperties/XmlArchive/Data/o")
    if settings is not None:
        _put_settings(entry, spelled_out(settings))


def _change_type(entry: Entry, body: etree._Element, kind: str) -> None:
    """Make a body of another type of it, which has nothing yet."""
    before = body.get("Type", "").strip("{}")
    embedded = member(entry.element, "MetaObject", "EmbeddedTypeGuids")
    for each in embedded if embedded is not None else ():
        if (each.text or "").casefold() == before.casefold():
            each.text = kind.strip("{}")
    body.tag = SINGLE
    body.attrib.update({"Type": kind, "Method": "IArchivable"})
    body[:] = []


def _put_settings(entry: Entry, settings: etree._Element) -> None:
    held = next(_settings_values(entry.element), None)
    if held is not None:
        held[:] = [settings]
        return
    properties = member(entry.element, "MetaObject", "Properties")
    if properties is not None:
        added = etree.SubElement(properties, "Entry")
        etree.SubElement(etree.SubElement(added, "Key"), SINGLE, Type="System.Guid").text = _SETTINGS
        etree.SubElement(added, "Value").append(settings)


_MEMBERS = {
    POU: ("SpecialFunc", "Implementation", "Interface", "UniqueIdGenerator", "POULevel", "ChildObjectGuids", "Added"),
    TYPE: ("Interface", "UniqueIdGenerator"),
    LIST: ("Interface", "NetVarProperties", "ParameterList", "Added"),
    ACTION: ("Implementation", "UniqueIdGenerator"),
    METHOD: ("Implementation", "Interface"),
    TRANSITION: ("Implementation", "UniqueIdGenerator"),
    PROPERTY: ("Interface",),
    ACCESSOR: ("Implementation", "Interface"),
}
"""Members of an object of each kind in their order; those of a transition object are assumed: as an action."""


def new_entry(kind: str, guid: str, name: str, place: ObjectPlace) -> Entry:
    """Return an entry for a new object, still without its texts."""
    written = _object("", _ENTRY)
    _add(written, "IsRoot", "bool", str(place.guid == NOWHERE))
    meta = _object("MetaObject", _META)
    written.append(meta)
    _add(meta, "Guid", "System.Guid", guid)
    _add(meta, "ParentGuid", "System.Guid", place.guid)
    _add(meta, "Name", "string", name)
    etree.SubElement(meta, "Dictionary", Type=_PROPERTIES, Name="Properties")
    _add(meta, "TypeGuid", "System.Guid", _GUIDS[kind])
    members = _MEMBERS[kind]
    embedded = [guid for held, guid in (("Interface", _DECLARED), ("Implementation", TEXT)) if held in members]
    held = etree.SubElement(meta, "Array", Name="EmbeddedTypeGuids", Type="System.Guid")
    for each in embedded:
        etree.SubElement(held, SINGLE, Type="System.Guid").text = each.strip("{}")
    _add(meta, "Timestamp", "long", "0")
    content = _object("Object", f"{{{_GUIDS[kind]}}}")
    written.append(content)
    for each in members:
        _add_member(content, each)
    _add(written, "ParentSVNodeGuid", "System.Guid", place.guid)
    path = etree.SubElement(written, "Array", Name="Path", Type="string")
    for step in place.path:
        etree.SubElement(path, SINGLE, Type="string").text = step
    _add(written, "Index", "int", "-1")
    return Entry(written)


@dataclass(frozen=True, slots=True)
class ObjectPlace:
    """ObjectPlace of an object: the identity of that around it, and the names from the root of the tree to there."""

    guid: str = NOWHERE
    path: tuple[str, ...] = ()

    @classmethod
    def inside(cls, entry: Entry) -> ObjectPlace:
        """Return the place in the object of an entry."""
        return cls(entry.guid, (*cls.of(entry).path, entry.name))

    @classmethod
    def of(cls, entry: Entry) -> ObjectPlace:
        """Return the place at which an entry is."""
        path = member(entry.element, "Path")
        return cls(entry.parent, tuple(each.text or "" for each in path) if path is not None else ())


def move_inside(entry: Entry, around: Entry) -> None:
    """Give an entry the path of the object around it, which may have another name now."""
    path = member(entry.element, "Path")
    for each, name in zip(path if path is not None else (), ObjectPlace.inside(around).path, strict=False):
        each.text = name


def _add_member(content: etree._Element, name: str) -> None:
    match name:
        case "Implementation" | "Interface":
            held = _object(name, TEXT if name == "Implementation" else _DECLARED)
            content.append(held)
            new_text(held, "")
        case "UniqueIdGenerator":
            _add(content, name, "string", "1")
        case "SpecialFunc":
            _add(content, name, "{0db3d7bb-cde0-4416-9a7b-ce49a0124323}", "None")
        case "POULevel":
            _add(content, name, "{8e575c5b-1d37-49c6-941b-5c0ec7874787}", "Standard")
        case "ChildObjectGuids":
            etree.SubElement(content, "List", Name=name, Type=TYPES["ArrayList"])
        case "NetVarProperties":
            etree.SubElement(content, NONE, Name=name)
        case _:
            _add(content, "AddAttributeSubsequent" if name == "Added" else name, "bool", "False")


def _object(name: str, kind: str) -> etree._Element:
    named = {"Name": name} if name else {}
    return etree.Element(SINGLE, {**named, "Type": kind, "Method": "IArchivable"})


def _add(thing: etree._Element, name: str, kind: str, text: str) -> None:
    etree.SubElement(thing, SINGLE, Name=name, Type=kind).text = text


def new_file() -> etree._Element:
    """Return a file without entries, as the tool begins one."""
    root = etree.Element("ExportFile")
    view = etree.SubElement(root, "StructuredView", Guid="{21af5390-2942-461a-bf89-951aaf6999f1}")
    held = etree.SubElement(view, SINGLE, {"{http://www.w3.org/XML/1998/namespace}space": "preserve"})
    held.attrib.update({"Type": "{3daac5e4-660e-42e4-9cea-3711b98bfb63}", "Method": "IArchivable"})
    etree.SubElement(held, NONE, Name="Profile")
    etree.SubElement(held, "List2", Name="EntryList")
    etree.SubElement(held, NONE, Name="ProfileName")
    return root
