"""Versions of TIA Portal: what is written for each validates against its official schemas."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.errors import StructureError, UnknownFormatError, UnknownVersionError
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.formats.simaticml.versions import VERSIONS, TiaVersion, concrete, namespace, neutral, schema_of
from plcopen_sfc.report import Fate
from tests.corpus import XSD
from tests.formats.simaticml.documents import ALL_PARAMS, FIXTURES, parsed

SCHEMAS = XSD / "simaticml"
FILES = {
    "Graph": "SW.PlcBlocks.Graph",
    "FlgNet": "SW.PlcBlocks.LADFBD",
    "StructuredText": "SW.PlcBlocks.SCL",
    "Sections": "SW.InterfaceSections",
}


def test_the_table_of_formats_has_every_version() -> None:
    assert format_named("simaticml")[0].versions == tuple(version.name for version in VERSIONS)


def test_namespaces() -> None:
    uri = namespace("Graph", 5)
    assert uri == "http://www.siemens.com/automation/Openness/SW/NetworkSource/Graph/v5"
    assert schema_of(uri) == ("Graph", 5)
    assert schema_of("http://example.org/v5") is None
    markup = f'<a xmlns="{uri}"/>'
    assert concrete(neutral(markup), {"Graph": 6}) == f'<a xmlns="{namespace("Graph", 6)}"/>'


class Official:
    """The official schemas, in one folder as their ``include`` want it here."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.schemas: dict[str, etree.XMLSchema] = {}
        for path in SCHEMAS.glob("*.xsd"):
            text = re.sub(r'schemaLocation="[^"]*/', 'schemaLocation="', path.read_text("utf-8"))
            # one of them has a type in a comment that the others use
            text = text.replace("<!--<xs:simpleType", "<xs:simpleType").replace(
                "</xs:simpleType>-->", "</xs:simpleType>"
            )
            (folder / path.name).write_text(text, encoding="utf-8")

    def check(self, element: etree._Element, kind: str, number: int) -> None:
        """Assert that an element is valid; skips the test where the schema is missing."""
        name = FILES[kind] + (f"_v{number}" if number > 1 else "") + ".xsd"
        if name not in self.schemas:
            if not (self.folder / name).is_file():
                pytest.skip(f"no official schema {name} at {SCHEMAS} (set PLCOPEN_SFC_XSD)")
            self.schemas[name] = etree.XMLSchema(etree.parse(str(self.folder / name)))
        self.schemas[name].assertValid(without_namespaces(element))


@pytest.fixture(scope="module")
def official(tmp_path_factory: pytest.TempPathFactory) -> Official:
    return Official(tmp_path_factory.mktemp("xsd"))


def without_namespaces(element: etree._Element) -> etree._Element:
    text = etree.tostring(element, encoding="unicode", with_tail=False)
    return etree.parse(io.StringIO(re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", text))).getroot()


def numbers(version: TiaVersion) -> dict[str, int]:
    return {
        "Graph": version.graph,
        "FlgNet": version.flg_net,
        "StructuredText": version.structured_text,
        "Sections": version.interface,
    }


@pytest.mark.parametrize("version", VERSIONS, ids=lambda version: version.name)
@pytest.mark.parametrize("path", sorted(FIXTURES.glob("*.xml")), ids=lambda path: path.name)
def test_what_is_written_is_valid(path: Path, version: TiaVersion, official: Official) -> None:
    project = sfc.load(path)
    data = sfc.dumps(project, format=f"simaticml-{version.name}", fresh=True)
    root = parsed(data)
    engineering = root.find("Engineering")
    assert engineering is not None
    assert engineering.get("version") == version.name
    checked = 0
    for kind, number in numbers(version).items():
        for element in root.iter(f"{{*}}{kind}"):
            uri = etree.QName(element).namespace
            parent = element.getparent()
            if uri is None or (parent is not None and etree.QName(parent).namespace == uri):
                continue  # a part of another part
            assert uri.endswith(f"/v{number}")
            official.check(element, kind, number)
            checked += 1
    assert checked or path.name == "tags.xml"


@pytest.mark.parametrize("version", [v for v in VERSIONS if v.graph > 1], ids=lambda version: version.name)
@pytest.mark.parametrize("path", sorted(FIXTURES.glob("*.xml")), ids=lambda path: path.name)
def test_another_version_and_back_is_the_same(path: Path, version: TiaVersion) -> None:
    project = sfc.load(path)
    data, report = sfc.api.convert(project, f"simaticml-{version.name}")
    assert not report.losses
    back = sfc.loads(sfc.dumps(sfc.loads(data), format="simaticml-V20"))
    assert back == project


def test_unknown_versions_are_refused() -> None:
    data = (FIXTURES / "tags.xml").read_bytes()
    with pytest.raises(UnknownVersionError, match="V99"):
        sfc.loads(data.replace(b'"V20"', b'"V99"'))
    with pytest.raises(UnknownFormatError):
        sfc.dumps(sfc.loads(data), format="simaticml-V13")


def test_what_is_no_document() -> None:
    with pytest.raises(StructureError, match=r"SW\.Blocks\.CompileUnit"):
        sfc.loads(b"<SW.Blocks.CompileUnit/>", format="simaticml")


def test_objects_that_are_no_blocks_are_kept() -> None:
    table = b'<Hmi.Tag.TagTable ID="0"><AttributeList /></Hmi.Tag.TagTable>'
    data = b'<Document><Engineering version="V16" />' + table + b"</Document>"
    project = sfc.loads(data)
    assert [d.code for d in project.diagnostics] == ["XML201"]
    assert sfc.dumps(project) == data
    assert b"<Hmi.Tag.TagTable" in sfc.dumps(project, fresh=True)


@pytest.mark.parametrize("path", ALL_PARAMS)
def test_versions_of_documents_are_those_of_the_table(path: Path) -> None:
    """The schema numbers of real exports; a document made by hand may say others, which are kept."""
    project = sfc.load(path)
    origin = project._origin
    assert origin is not None
    assert origin.version in {version.name for version in VERSIONS}
    kept = project.carried.attributes if project.carried is not None else {}
    other = [name for name in kept if name.startswith("schema ")]
    assert len(other) <= 2


def test_converted_charts_are_complete(official: Official) -> None:
    project = sfc.load(FIXTURES.parent / "codesys" / "distribution_belt.xml")
    data, report = sfc.api.convert(project, "simaticml-V16")
    assert [item for item in report.items if item.fate is Fate.DROPPED] == []
    again = sfc.loads(data)
    (mine,) = [c for c in project.charts() if c.name == "Ablauf_Band"]
    (theirs,) = [c for c in again.charts() if c.name == "Ablauf_Band"]
    assert [s.name for s in theirs.network.steps] == [s.name for s in mine.network.steps]
    for element in parsed(data).iter("{*}Graph"):
        official.check(element, "Graph", 5)
