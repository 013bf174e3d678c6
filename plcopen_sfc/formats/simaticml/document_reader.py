"""Reads a document of TIA Portal Openness: its frame and the objects in it. The writer is `simaticml_codec`.

Objects are read when they are first looked at; see docs/decisions/0003.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.errors import Location, StructureError, UnknownVersionError
from plcopen_sfc.formats.format_interface import TIA_PORTAL
from plcopen_sfc.formats.provenance import Origin, file_digest, read_later, remember_body
from plcopen_sfc.formats.simaticml.added_elements import AddedMark, forget_mark, mark_of
from plcopen_sfc.formats.simaticml.element_reader import (
    DocumentReading,
    Fields,
    child_named,
    children,
    keep_attribute,
    keep_element,
    local,
    plain_text,
    read_comments,
    read_model,
)
from plcopen_sfc.formats.simaticml.openness_objects import DATA_BLOCKS, KINDS, POUS, ObjectKind
from plcopen_sfc.formats.simaticml.tia_versions import (
    DEFAULT,
    VERSIONS,
    TiaVersion,
    schema_of,
    version_like,
    version_named,
)
from plcopen_sfc.formats.xml.extension_data import Markup, attributes, exchange_markup
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse_xml
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.sfc import SfcBody
from plcopen_sfc.whole_numbers import canonical_number

_PARTS = {
    "FlgNet": "a network in LAD or FBD",
    "Graph": "a chart of S7-GRAPH",
    "StructuredText": "a network in SCL",
    "StatementList": "a network in STL",
    "Sections": "the interface of a block",
    "Interface": "the interface of a block",
    "NetworkSource": "the program of a network",
    "AttributeList": "the attributes of an object",
    "MultilingualText": "a text in several languages",
}
_KINDS = (
    ("Hmi.", "an object of an operator panel"),
    ("Siemens.Simatic.Hmi", "an object of an operator panel"),
    ("SW.TechnologicalObjects.", "a technology object"),
    ("SW.WatchAndForceTables.", "a watch or force table"),
    ("SW.Alarm", "alarms of a PLC"),
    ("SW.Blocks.", "a block of a kind that is not known"),
    ("SW.Types.", "a type of a kind that is not known"),
    ("SW.", "an object of a PLC of a kind that is not known"),
    ("HW.", "hardware"),
)
_HARDWARE = "CAEXFile"
_WHOLE = "Exports of Openness start with <Document>; parts of them cannot be loaded by themselves."


def no_document(root: etree._Element) -> tuple[str, str]:
    """Return the error for XML that is no document: the kind of its root, and what to do."""
    name = local(root)
    if name == _HARDWARE:
        return (
            "this is AutomationML: it describes hardware, and has no blocks",
            "Export the blocks of the PLC, with Openness or into a version control interface.",
        )
    what = _PARTS.get(name) or ("an object" if name.startswith("SW.") else "")
    if not what:
        return f"this is no document of TIA Portal Openness: the root element is <{name}>", _WHOLE
    message = f"this is a part of a document of TIA Portal Openness only: {what} (<{name}>)"
    return message, f"Export the whole block. {_WHOLE}"


def no_object(kind: str) -> str:
    """Return a description of an object of a document that is not read."""
    what = next((words for start, words in _KINDS if kind.startswith(start)), "none of the objects that can be read")
    return f"<{kind}> is {what}; it is kept as it is"


def look_at_object(ctx: DocumentReading, element: etree._Element) -> None:
    """Report of an object that its program is hidden (``XML211``), or was not compiled (``XML212``)."""
    name = element.findtext("AttributeList/Name", "")
    if (element.findtext("AttributeList/IsKnowHowProtected") or "").lower() == "true":
        message = f"{name} is know-how protected: what it does is not in the file"
        ctx.warn("XML211", message, element)
    if (element.findtext("AttributeList/IsConsistent") or "").lower() == "false":
        message = f"{name} was not consistent when it was exported: it may not fit the blocks and types that it uses"
        ctx.warn("XML212", message, element)


T = TypeVar("T", bound=ProjectObject)


class LateDocument:
    """A document whose objects are not read yet.

    It keeps the bytes, not the tree, which takes many times their memory: a folder may have thousands of documents.
    When the first object is read, the bytes are parsed again, which takes a fiftieth of the time of reading; that tree
    stays until the last object is read.
    """

    def __init__(self, data: bytes, ctx: DocumentReading) -> None:
        self._data = data
        self._ctx = ctx
        self._root: etree._Element | None = None
        self._waiting = 0

    def object(self, element: etree._Element, kind: ObjectKind, place: int, *, keep_id: bool) -> ProjectObject:
        """Return the object at `element`, which is child `place` of the root, unread."""
        return self._later(kind.model, kind.read, element, place, keep_id=keep_id)

    def _later(
        self,
        model: type[T],
        reader: Callable[[DocumentReading, etree._Element], Fields],
        element: etree._Element,
        place: int,
        *,
        keep_id: bool,
    ) -> T:
        holder = child_named(element, "AttributeList")
        values = {local(child): child for child in reversed(holder)} if holder is not None else {}
        name = values.get("Name")
        eager: Fields = {"name": (name.text or "") if name is not None else ""}
        plain = next(element.iterchildren(etree.Comment), None) is None  # a comment of this package may hold any field
        if plain:
            eager["folder"] = None
        if plain and model in (Pou, DataBlock):
            eager["number"] = canonical_number(plain_text(values.get("Number")))
            eager["kind"] = (POUS | DATA_BLOCKS)[local(element)]
        self._waiting += 1
        waiting = True

        def fields_of(ctx: DocumentReading, found: etree._Element) -> Fields:
            fields = reader(ctx, found)
            if keep_id:
                keep_attribute(fields, "ID", found.get("ID", ""))
            return fields

        def read() -> T:
            nonlocal waiting
            found = self._tree()[place]
            thing = read_model(self._context(), found, model, fields_of)
            if not self._ctx.of_tia:
                exchange_markup(thing, Markup.SIMATICML, Markup.TC6)
            if isinstance(thing, Pou):
                for name, _, body in thing.named_bodies():
                    if isinstance(body, SfcBody):
                        remember_body(body, Origin(name, self._data, file_digest(self._data)))
            if waiting:
                waiting = False
                self._done()
            return thing

        return read_later(model, eager, read)

    def _tree(self) -> etree._Element:
        if self._root is None:
            self._root = parse_xml(self._data, file=self._ctx.file)
            self._ctx.lines = SourceLines(self._root, self._data)
        return self._root

    def _context(self) -> DocumentReading:
        """Return a context of its own for each object; the findings about the document are in one list."""
        ctx = DocumentReading(self._ctx.version, file=self._ctx.file, lines=self._ctx.lines)
        ctx.of_tia, ctx.edited_copies = self._ctx.of_tia, self._ctx.edited_copies
        ctx.schemas, ctx.diagnostics = self._ctx.schemas, self._ctx.diagnostics
        return ctx

    def _done(self) -> None:
        self._waiting -= 1
        if not self._waiting:
            self._root = self._ctx.lines = None


PRODUCT = TIA_PORTAL
IDS = "IDs"
"""Extension attribute of a project: the ids of its objects, where they are no running numbers."""
SCHEMA = "schema "
"""Prefix of extension attributes of a project: the schema number of the file where its version has another."""


def find_version(root: etree._Element, *, file: str | None = None) -> TiaVersion:
    """Return the version of TIA Portal that wrote a document. Raises `StructureError` and `UnknownVersionError`."""
    place = Location(file, root.sourceline if isinstance(root.sourceline, int) else None, None, f"/{local(root)}")
    if root.tag != "Document":
        message, hint = no_document(root)
        raise StructureError(message, location=place, hint=hint)
    engineering = root.find("Engineering")
    name = engineering.get("version", "") if engineering is not None else ""
    version = version_like(name)
    if version is not None:
        return version
    if name:
        known = ", ".join(version.name for version in VERSIONS)
        raise UnknownVersionError(
            f"the document is of TIA Portal {name!r}, which is not known", location=place, hint=f"Known are: {known}"
        )
    return _version_by_schemas(root)


def _version_by_schemas(root: etree._Element) -> TiaVersion:
    """Return the first version with the schemas of a document that does not name its version."""
    used = dict(
        found for element in root.iter(etree.Element) if (found := schema_of(etree.QName(element).namespace or ""))
    )
    fitting = [v for v in VERSIONS if all(v.schema(kind) == number for kind, number in used.items())]
    return fitting[0] if fitting and used else DEFAULT


def read_project(
    root: etree._Element, version: TiaVersion, data: bytes, *, file: str | None = None
) -> tuple[Fields, list[Diagnostic]]:
    """Read a document into the fields of a `Project`, whose objects are read when they are first looked at.

    The findings about the document are added to the list returned, also later, when more is read.
    """
    ctx = DocumentReading(version, file=file, lines=SourceLines(root, data))
    if version_named(version.name) is None:
        ctx.warn("XML210", f"TIA Portal {version.name} is not known here; the document is read as one before it", root)
    late = LateDocument(data, ctx)
    header: Fields = {"product": PRODUCT, "version": version.name}
    fields: Fields = {"dialect": Dialect.SCL, "header": header, "pous": [], "data_blocks": [], "data_types": []}
    fields["tag_tables"] = []
    _find_schemas(ctx, root)
    in_usual_order = _is_in_usual_order(root)  # else ids tell in which order the objects of all kinds are
    seen: set[str] = set()
    for place, child in enumerate(root):
        kind = local(child)
        if not kind:
            continue
        if kind in _FRAME:
            if kind in seen:
                keep_element(fields, child)
                continue
            seen.add(kind)
        if kind == "DocumentInfo":
            _document_info(header, child)
        elif (known := KINDS.get(kind)) is not None:
            copied = mark_of(child)
            if copied is AddedMark.UNCHANGED:
                continue  # the project has the global variables in it
            if copied is AddedMark.EDITED:
                forget_mark(child)
                ctx.edited_copies.add((child.findtext("{*}AttributeList/{*}Name") or "").casefold())
                ctx.warn("XML213", f"an object added for {PRODUCT} was edited: it is one of the project now", child)
            look_at_object(ctx, child)
            fields[known.field].append(late.object(child, known, place, keep_id=not in_usual_order))
        elif kind != "Engineering":
            keep_element(fields, child)
            ctx.warn("XML201", no_object(kind), child)
        else:
            for name, value in attributes(child).items():
                if name != "version":
                    keep_attribute(header, name, value)
            if (child.text or "").strip():
                keep_attribute(header, "#text", child.text or "")
    for name, value in attributes(root).items():
        keep_attribute(fields, name, value)
    ids = [str(text) for text in _IDS_IN(root)]
    if ids != [format(number, "X") for number in range(len(ids))]:
        keep_attribute(fields, IDS, " ".join(ids))
    read_comments(ctx, root, fields)
    ctx.of_tia = header.get("product") == PRODUCT
    for kind, number in ctx.schemas.items():
        if number != version.schema(kind):
            keep_attribute(fields, SCHEMA + kind, str(number))
    ctx.lines = None  # it keeps the tree
    return fields, ctx.diagnostics


_IDS_IN: Any = etree.XPath("//@ID")  # quicker than asking every element of a large file


_FRAME = ("Engineering", "DocumentInfo")


def _is_in_usual_order(root: etree._Element) -> bool:
    """True if the objects of a document are in the order in which they are written: kind by kind."""
    order = [each.model for each in dict.fromkeys(KINDS.values())]
    kinds = [KINDS.get(local(child)) for child in children(root) if local(child) not in _FRAME]
    ranks = [order.index(kind.model) if kind is not None else len(order) for kind in kinds]
    return ranks == sorted(ranks)


def _find_schemas(ctx: DocumentReading, root: etree._Element) -> None:
    """Remember which schema versions the parts of the file have; 0 for no namespace."""
    for name, kind in (("Sections", "Interface"), ("Graph", "Graph"), ("FlgNet", "FlgNet")):
        element = next(root.iter(f"{{*}}{name}"), None)
        if element is not None and element.tag == name:
            ctx.schemas[kind] = 0
    element = next(root.iter("StructuredText"), None)
    if element is not None:
        ctx.schemas["StructuredText"] = 0
    for element in root.iter("{*}StructuredText", "{*}FlgNet", "{*}Graph", "{*}StatementList", "{*}Sections"):
        ctx.note_schema(element)
    for program in root.iterfind(".//{*}NetworkSource/{*}*"):
        ctx.note_schema(program)


def _document_info(header: Fields, element: etree._Element) -> None:
    for child in children(element):
        if local(child) == "Created" and not child.attrib and "created" not in header:
            header["created"] = child.text or ""
        elif local(child) == "ExportSetting" and not child.attrib and "description" not in header:
            header["description"] = child.text or ""
        else:
            keep_element(header, child)
    if not len(element):
        keep_attribute(header, "DocumentInfo", "")
    for name, value in attributes(element).items():
        keep_attribute(header, f"@{name}", value)
