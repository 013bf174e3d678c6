"""The official schemas of the parts of a document: interfaces, networks, charts, program text."""

from __future__ import annotations

import copy
import re
import tempfile
from functools import cache
from pathlib import Path

import pytest
from lxml import etree

from plcopen_sfc.formats.simaticml.tia_versions import schema_of
from tests.corpus import XSD

SCHEMAS = XSD / "simaticml"
FILES = {
    "Interface": "SW.InterfaceSections",
    "Graph": "SW.PlcBlocks.Graph",
    "FlgNet": "SW.PlcBlocks.LADFBD",
    "StructuredText": "SW.PlcBlocks.SCL",
    "StatementList": "SW.PlcBlocks.STL",
}
PUBLISHED = {
    "Interface": (2, 3, 4, 5),
    "Graph": (1, 2, 4, 5, 6),
    "FlgNet": (1, 2, 3, 4, 5),
    "StructuredText": (1, 2, 3, 4),
    "StatementList": (1, 2, 3, 4, 5),
}
ROOTS = {kind: "Sections" if kind == "Interface" else kind for kind in FILES}
KINDS_AND_NUMBERS = [(kind, number) for kind, numbers in PUBLISHED.items() for number in numbers]


@cache
def _folder() -> Path:
    """The official schemas in one folder, as their ``include`` want it here."""
    folder = Path(tempfile.mkdtemp(prefix="xsd"))
    for path in SCHEMAS.glob("*.xsd"):
        text = re.sub(r'schemaLocation="[^"]*/', 'schemaLocation="', path.read_text("utf-8"))
        # one of them has a type in a comment that the others use
        text = text.replace("<!--<xs:simpleType", "<xs:simpleType").replace("</xs:simpleType>-->", "</xs:simpleType>")
        (folder / path.name).write_text(text, encoding="utf-8")
    return folder


@cache
def official(kind: str, number: int) -> etree.XMLSchema:
    """The published schema of a kind of part; skips the test where it is missing. It knows no namespaces."""
    name = FILES[kind] + (f"_v{number}" if number > 1 else "") + ".xsd"
    if not (SCHEMAS / name).is_file():
        pytest.skip(f"no official schema {name} at {SCHEMAS} (set PLCOPEN_SFC_XSD)")
    return etree.XMLSchema(etree.parse(_folder() / name))


def without_namespace(part: etree._Element) -> etree._Element:
    """A copy of a part with its namespace taken off. Elements of no namespace or another one get one not heard of."""
    namespace = etree.QName(part).namespace
    copied = copy.deepcopy(part)
    for element in copied.iter(etree.Element):
        name = etree.QName(element)
        element.tag = name.localname if name.namespace == namespace else f"{{urn:other}}{name.localname}"
    return copied


def outer_parts(root: etree._Element) -> list[tuple[str, int, etree._Element]]:
    """The parts of a document that have a schema and stand in no other part: kind, number of the schema, element."""
    found = []
    for element in root.iter("{*}Sections", "{*}Graph", "{*}FlgNet", "{*}StructuredText", "{*}StatementList"):
        uri = etree.QName(element).namespace or ""
        parent = element.getparent()
        if parent is not None and etree.QName(parent).namespace == uri:
            continue
        schema = schema_of(uri)
        if schema is not None and element.tag == f"{{{uri}}}{ROOTS[schema[0]]}":
            found.append((*schema, element))
    return found
