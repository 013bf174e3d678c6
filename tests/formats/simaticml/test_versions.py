"""Versions of TIA Portal: what is written for each validates against its official schemas."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.errors import OldVersionError, StructureError, UnknownFormatError, UnknownVersionError
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.formats.simaticml.graph_reader import USUAL_CATEGORIES
from plcopen_sfc.formats.simaticml.openness_schemas import validate
from plcopen_sfc.formats.simaticml.tia_versions import (
    VERSIONS,
    TiaVersion,
    concrete,
    namespace,
    neutral,
    schema_of,
    version_named,
)
from plcopen_sfc.model.chart_settings import AlarmCategory
from plcopen_sfc.model.text import MultilingualText
from plcopen_sfc.report import Outcome
from tests.formats.simaticml.documents import CORPUS_PARAMS, FIXTURES, SOME_GRAPH_PARAMS, SOME_PARAMS, parsed
from tests.formats.simaticml.drilling_plc import FOLDER as PLC
from tests.formats.simaticml.official import official, outer_parts, without_namespace
from tests.samples import accepting
from tests.sweeps import WHOLE

LARGE = 300_000 if WHOLE else 50_000
"""Documents of more bytes are tried in one version."""
DISTINCT = [v for v in VERSIONS if v.name in {"V14 SP1", "V15", "V15.1", "V16", "V19", "V21"}]
"""The versions that differ in the schemas of programs."""


def test_the_table_of_formats_has_every_version() -> None:
    assert format_named("simaticml")[0].versions == tuple(version.name for version in VERSIONS)


def test_namespaces() -> None:
    uri = namespace("Graph", 5)
    assert uri == "http://www.siemens.com/automation/Openness/SW/NetworkSource/Graph/v5"
    assert schema_of(uri) == ("Graph", 5)
    assert schema_of("http://example.org/v5") is None
    markup = f'<a xmlns="{uri}"/>'
    assert concrete(neutral(markup), {"Graph": 6}) == f'<a xmlns="{namespace("Graph", 6)}"/>'


def the_chart(project: sfc.Project) -> sfc.SfcNetwork:
    chart = project.pou("FB_Drill").sfc
    assert chart is not None
    return chart


def check(element: etree._Element, kind: str, number: int) -> None:
    """Assert that an element is valid by the official schema; skips the test where the schema is missing."""
    official(kind, number).assertValid(without_namespace(element))


def says_scl(path: Path) -> bool:
    return b"StructuredText" in path.read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS, ids=lambda version: version.name)
@pytest.mark.parametrize("path", sorted(FIXTURES.rglob("*.xml")), ids=lambda path: path.name)
def test_what_is_written_is_valid(path: Path, version: TiaVersion) -> None:
    project = sfc.load(path)
    if says_scl(path) and not version.schema("StructuredText"):
        with pytest.raises(OldVersionError, match="SCL needs TIA Portal V15"):
            sfc.dumps(project, tia=version.name, fresh=True)
        return
    data = sfc.dumps(project, tia=version.name, fresh=True)
    root = parsed(data)
    engineering = root.find("Engineering")
    assert engineering is not None
    assert engineering.get("version") == version.name
    parts = outer_parts(root)
    for kind, number, element in parts:
        assert number == version.schema(kind)
        check(element, kind, number)
    assert parts or path.name == "tags.xml"
    assert validate(data) == []


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS, ids=lambda version: version.name)
@pytest.mark.parametrize("path", sorted(FIXTURES.rglob("*.xml")), ids=lambda path: path.name)
def test_another_version_and_back_is_the_same(path: Path, version: TiaVersion) -> None:
    project = sfc.load(path)
    if says_scl(path) and not version.schema("StructuredText"):
        return
    report = sfc.save(project, (there := io.BytesIO()), tia=version.name)
    assert not report.losses
    assert not report.with_outcome(Outcome.EXTENSION_DATA)
    assert sfc.loads(sfc.dumps(sfc.loads(there.getvalue()), tia="V20")) == project


@pytest.mark.slow
def test_a_plc_in_another_version_and_back_is_the_same(tmp_path: Path) -> None:
    project = sfc.load(PLC)
    report = sfc.save(project, f"{tmp_path / 'V16'}/", tia="V16")
    assert not report.losses
    older = sfc.load(tmp_path / "V16")
    assert older.header.version == "V16"
    sfc.save(older, f"{tmp_path / 'V21'}/", tia="V21")
    assert sfc.load(tmp_path / "V21") == project
    with pytest.raises(OldVersionError) as caught:
        sfc.save(project, f"{tmp_path / 'V14'}/", tia="V14 SP1")
    assert [need.path for need in caught.value.needs] == ["POU FB_Chips / network 1"]
    assert not (tmp_path / "V14").exists()


def sampled() -> list[Any]:
    """Real documents with a chart, and every twelfth of the others."""
    return [param for place, param in enumerate(CORPUS_PARAMS) if place % 12 == 0 or param in SOME_GRAPH_PARAMS]


@pytest.mark.slow
@pytest.mark.parametrize("path", sampled())
def test_real_documents_in_every_version(path: Path) -> None:
    """A valid document is written valid in every version or refused, and comes back equal."""
    data = path.read_bytes()
    if validate(data) or b"<Engineering" not in data:
        return
    project = sfc.loads(data)
    for version in DISTINCT if len(data) < LARGE else DISTINCT[1:2]:
        try:
            written = sfc.dumps(project, tia=version.name)
        except OldVersionError as error:
            needs = [version_named(need.version.removeprefix("TIA Portal ")) for need in error.needs]
            later = VERSIONS[VERSIONS.index(version) + 1 :]
        else:
            needs, later = [], VERSIONS
            assert validate(written) == [], version.name
            for kind, number, element in outer_parts(parsed(written)):
                check(element, kind, number)
            back = sfc.loads(sfc.dumps(sfc.loads(written), tia=project.header.version))
            assert canonical(back) == canonical(project), version.name
        assert all(need in later for need in needs)


def canonical(project: sfc.Project) -> sfc.Project:
    """Without the note of schema numbers that the version of the document does not have."""
    copied = project.model_copy(deep=True)
    if copied.extension_data is not None:
        kept = {
            name: value for name, value in copied.extension_data.attributes.items() if not name.startswith("schema ")
        }
        copied.extension_data.attributes = kept
        if not (kept or copied.extension_data.data or copied.extension_data.elements):
            copied.extension_data = None
    return copied


@pytest.mark.slow
def test_what_needs_a_newer_version_is_listed() -> None:
    project = sfc.load(FIXTURES / "FB_Drill.xml")
    chart = the_chart(project)
    chart.step("Drill").title = MultilingualText(texts={"de-DE": "Bohren"})
    chart.step("Drill").comment = MultilingualText(texts={"zh-Hans-CN": "Bohren"})
    with pytest.raises(OldVersionError) as caught:
        sfc.dumps(project, tia="V14 SP1")
    needs = [(need.path, need.version) for need in caught.value.needs]
    assert needs == [
        ("POU FB_Drill / step Drill", "TIA Portal V15"),
        ("POU FB_Drill / step Drill", "TIA Portal V16"),
    ]
    assert "the name of the step in several languages needs TIA Portal V15" in str(caught.value)
    with pytest.raises(OldVersionError, match="V16"):
        sfc.dumps(project, tia="V15.1")
    assert validate(sfc.dumps(project, tia="V16")) == []


def test_an_edit_that_the_version_of_the_file_cannot_say_is_refused() -> None:
    old = sfc.dumps(sfc.load(FIXTURES / "FB_Drill.xml"), tia="V14 SP1")
    project = sfc.loads(old)
    assert sfc.dumps(project) == old
    the_chart(project).step("Drill").title = MultilingualText(texts={"de-DE": "Bohren"})
    with pytest.raises(OldVersionError, match="step Drill"):
        sfc.dumps(project)


@pytest.mark.slow
def test_categories_of_alarms_follow_the_version() -> None:
    project = sfc.load(FIXTURES / "FB_Drill.xml")
    settings = the_chart(project).graph_settings
    assert settings is not None
    usual = [AlarmCategory(name=n, id=i, display_class=d, text=t) for n, i, d, t in USUAL_CATEGORIES[True]]
    usual[0].display_class = 3
    settings.alarm_categories = usual
    project = sfc.loads(sfc.dumps(project, fresh=True))
    old = sfc.dumps(project, tia="V15")
    assert b"AlarmSubcategory1Interlock" not in old
    assert sfc.loads(sfc.dumps(sfc.loads(old), tia="V20")) == project
    settings = the_chart(project).graph_settings
    assert settings is not None
    settings.alarm_categories[-1].id = 7
    with pytest.raises(OldVersionError, match="categories of alarms"):
        sfc.dumps(project, tia="V15")


@pytest.mark.parametrize("spelled", ["V16", "16", "v16", "V14SP1", "v14 sp1", "V15.1", "15.1"])
def test_versions_may_be_spelled_freely(spelled: str) -> None:
    data = sfc.dumps(sfc.load(FIXTURES / "tags.xml"), tia=spelled)
    name = sfc.loads(data).header.version
    assert name.replace(" ", "").upper().removeprefix("V") == spelled.replace(" ", "").upper().removeprefix("V")


def test_a_version_is_for_this_format_only() -> None:
    project = sfc.load(FIXTURES / "tags.xml")
    with pytest.raises(UnknownVersionError, match="V13"):
        sfc.dumps(project, tia="V13")
    with pytest.raises(UnknownFormatError, match="plcopen"):
        sfc.dumps(project, format="plcopen", tia="V16")
    with pytest.raises(UnknownFormatError, match="V17"):
        sfc.dumps(project, format="simaticml-V16", tia="V17")
    assert sfc.dumps(project, format="simaticml-V16", tia="V16") == sfc.dumps(project, tia="V16")


@pytest.mark.parametrize("name", ["V22", "V18.1", "V20 SP2"])
def test_a_newer_version_is_read_as_the_one_before_it(name: str) -> None:
    data = (FIXTURES / "FB_Drill.xml").read_bytes().replace(b'version="V20"', f'version="{name}"'.encode())
    project = sfc.loads(data)
    assert [d.code for d in project.diagnostics] == ["XML210"]
    assert name in project.diagnostics[0].message
    assert sfc.dumps(project) == data
    the_chart(project).step("Drill").max_time = "T#99s"
    edited = sfc.dumps(project)
    assert f'version="{name}"'.encode() in edited
    assert sum(a != b for a, b in zip(data.splitlines(), edited.splitlines(), strict=True)) == 1
    assert sfc.loads(sfc.dumps(sfc.loads(data), format="json")).pous == sfc.loads(data).pous


def test_unknown_versions_are_refused() -> None:
    data = (FIXTURES / "tags.xml").read_bytes()
    for name in ("V13", "V14", "20", "Vx"):
        with pytest.raises(UnknownVersionError, match=f"'{name}'"):
            sfc.loads(data.replace(b'"V20"', f'"{name}"'.encode()))
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


@pytest.mark.parametrize("path", SOME_PARAMS)
def test_versions_of_documents_are_those_of_the_table(path: Path) -> None:
    """The schema numbers of real exports; a document made by hand may say others, which are kept."""
    project = sfc.load(path)
    origin = project.source
    assert origin is not None
    assert origin.version in {version.name for version in VERSIONS}
    kept = project.extension_data.attributes if project.extension_data is not None else {}
    other = [name for name in kept if name.startswith("schema ")]
    assert len(other) <= 2


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["twincat/press_station.xml", "plcopen/every_element_2.01.xml", "scl/filling_line.scl"]
)
def test_files_of_other_tools_are_written_valid(name: str) -> None:
    project = accepting(sfc.load(FIXTURES.parent / name))
    for version in ("V15", "V21"):
        data = sfc.dumps(project, tia=version, partial=True)
        assert validate(data) == []
        for kind, number, element in outer_parts(parsed(data)):
            check(element, kind, number)


@pytest.mark.slow
def test_converted_charts_are_complete() -> None:
    project = sfc.load(FIXTURES.parent / "codesys" / "distribution_belt.xml")
    data, report = sfc.api.convert(project, "simaticml-V16", partial=True)
    assert [item for item in report.items if item.outcome is Outcome.DROPPED] == []
    again = sfc.loads(data)
    (mine,) = [c for c in project.charts() if c.name == "Ablauf_Band"]
    (theirs,) = [c for c in again.charts() if c.name == "Ablauf_Band"]
    assert [s.name for s in theirs.chart.steps] == [s.name for s in mine.chart.steps]
    for element in parsed(data).iter("{*}Graph"):
        check(element, "Graph", 5)
