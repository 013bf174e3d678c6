"""Reads a document of TIA Portal Openness: its frame and the objects in it. The writer is `project_writer`."""

from __future__ import annotations

from typing import Any

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.errors import Location, StructureError, UnknownVersionError
from plcopen_sfc.formats.format_interface import TIA_PORTAL
from plcopen_sfc.formats.simaticml.added import Added, added, forget_mark
from plcopen_sfc.formats.simaticml.late_reading import LateDocument
from plcopen_sfc.formats.simaticml.objects_reader import DATA_BLOCKS, DATA_TYPE, POUS, TAG_TABLE
from plcopen_sfc.formats.simaticml.reading import (
    Fields,
    ReadContext,
    attributes,
    carry_attribute,
    carry_element,
    children,
    local,
    read_comments,
)
from plcopen_sfc.formats.simaticml.strangers import look_at_object, no_document, no_object
from plcopen_sfc.formats.simaticml.versions import DEFAULT, VERSIONS, TiaVersion, schema_of, version_like, version_named
from plcopen_sfc.formats.xml.xml_parsing import SourceLines
from plcopen_sfc.model.dialect import Dialect

PRODUCT = TIA_PORTAL
OBJECTS = "SW."
IDS = "IDs"
"""Carried attribute of a project: the ids of its objects, where they are no running numbers."""
SCHEMA = "schema "
"""Carried attributes of a project that begin so say which schema number the file has where its version has another."""


def find_version(root: etree._Element, *, file: str | None = None) -> TiaVersion:
    """The version of TIA Portal that wrote a document. Raises `StructureError` and `UnknownVersionError`."""
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
    """The first version with the schemas of a document that does not say its version."""
    used = dict(
        found for element in root.iter(etree.Element) if (found := schema_of(etree.QName(element).namespace or ""))
    )
    fitting = [v for v in VERSIONS if all(v.schema(kind) == number for kind, number in used.items())]
    return fitting[0] if fitting and used else DEFAULT


def read_project(
    root: etree._Element, version: TiaVersion, data: bytes, *, file: str | None = None
) -> tuple[Fields, list[Diagnostic]]:
    """Read a document into the fields of a `Project`, whose objects are read when somebody looks at them.

    What there is to say about the document is added to the list returned; to say more when more is read.
    """
    ctx = ReadContext(version, file=file, lines=SourceLines(root, data))
    if version_named(version.name) is None:
        ctx.warn("XML210", f"TIA Portal {version.name} is not known here; the document is read as one before it", root)
    late = LateDocument(root, data, ctx)
    header: Fields = {"product": PRODUCT, "version": version.name}
    fields: Fields = {"dialect": Dialect.SCL, "header": header, "pous": [], "data_blocks": [], "data_types": []}
    fields["tag_tables"] = []
    _find_schemas(ctx, root)
    ranks = [_rank(local(child)) for child in children(root) if local(child) not in ("Engineering", "DocumentInfo")]
    usual = ranks == sorted(ranks)
    frame: set[str] = set()
    for place, child in enumerate(root):
        kind = local(child)
        if not kind:
            continue
        if kind in ("Engineering", "DocumentInfo"):
            if kind in frame:
                carry_element(fields, child)
                continue
            frame.add(kind)
        if kind == "DocumentInfo":
            _document_info(header, child)
        elif (where := _list_for(kind)) is not None:
            copied = added(child)
            if copied is Added.UNCHANGED:
                continue  # the project has the global variables that it says
            if copied is Added.EDITED:
                forget_mark(child)
                ctx.edited_copies.add((child.findtext("{*}AttributeList/{*}Name") or "").casefold())
                ctx.warn("XML213", "a copy of global variables was edited: it is an object of its own now", child)
            look_at_object(ctx, child)
            fields[where].append(late.object(child, place, keep_id=not usual))
        elif kind != "Engineering":
            carry_element(fields, child)
            ctx.warn("XML201", no_object(kind), child)
        else:
            for name, value in attributes(child).items():
                if name != "version":
                    carry_attribute(header, name, value)
            if (child.text or "").strip():
                carry_attribute(header, "#text", child.text or "")
    for name, value in attributes(root).items():
        carry_attribute(fields, name, value)
    ids = [str(text) for text in _IDS_IN(root)]
    if ids != [format(number, "X") for number in range(len(ids))]:
        carry_attribute(fields, IDS, " ".join(ids))
    read_comments(ctx, root, fields)
    ctx.of_tia = header.get("product") == PRODUCT
    for kind, number in ctx.schemas.items():
        if number != version.schema(kind):
            carry_attribute(fields, SCHEMA + kind, str(number))
    ctx.lines = None  # it keeps the tree
    return fields, ctx.diagnostics


_IDS_IN: Any = etree.XPath("//@ID")  # quicker than asking every element of a large file


def _list_for(kind: str) -> str | None:
    """The field of `Project` in which objects of a kind are; None where it is no such object."""
    if kind in POUS:
        return "pous"
    if kind in DATA_BLOCKS:
        return "data_blocks"
    return {DATA_TYPE: "data_types", TAG_TABLE: "tag_tables"}.get(kind)


def _rank(kind: str) -> int:
    """The place of a kind of object among others: what others need stands first."""
    groups: tuple[tuple[str, ...], ...] = ((TAG_TABLE,), (DATA_TYPE,), tuple(DATA_BLOCKS), tuple(POUS))
    return next((rank for rank, group in enumerate(groups) if kind in group), len(groups))


def _find_schemas(ctx: ReadContext, root: etree._Element) -> None:
    """Remember which schema versions the parts of the file have; 0: it stands in no namespace."""
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
            carry_element(header, child)
    if not len(element):
        carry_attribute(header, "DocumentInfo", "")
    for name, value in attributes(element).items():
        carry_attribute(header, f"@{name}", value)
