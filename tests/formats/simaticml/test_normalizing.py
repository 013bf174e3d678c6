"""Normalised documents: without what an import ignores, always the same bytes, and the same program."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.cli import main
from plcopen_sfc.documents.file_documents import normalized
from plcopen_sfc.errors import StructureError, UnknownFormatError
from plcopen_sfc.formats.simaticml.openness_schemas import validate
from plcopen_sfc.model.compare import differences
from tests.corpus import require_corpus
from tests.formats.simaticml.documents import ALL_PARAMS, FIXTURES, parsed, real_documents
from tests.formats.simaticml.drilling_plc import FOLDER

DRILL = FIXTURES / "FB_Drill.xml"
INFO = b"""<DocumentInfo>
    <Created>2025-09-15T14:47:00.0000000Z</Created>
    <ExportSetting>WithDefaults, WithReadOnly</ExportSetting>
    <InstalledProducts>
      <Product><DisplayName>Totally Integrated Automation</DisplayName><DisplayVersion>V20</DisplayVersion></Product>
    </InstalledProducts>
  </DocumentInfo>"""
READ_ONLY = b"""<CodeModifiedDate ReadOnly="true">2025-09-15T14:47:00Z</CodeModifiedDate>
      <IsConsistent ReadOnly="true">true</IsConsistent>
      <ISMultiInstanceCapable ReadOnly="true">false</ISMultiInstanceCapable>
      <GraphVersion>"""


def exported_again(data: bytes) -> bytes:
    """The same block as another export has it: at another time, with more attributes."""
    later = re.sub(rb"<DocumentInfo>.*?</DocumentInfo>", INFO, data, flags=re.DOTALL)
    assert later != data
    return later.replace(b"<GraphVersion>", READ_ONLY, 1)


def test_two_exports_of_a_block_are_the_same() -> None:
    data = DRILL.read_bytes()
    assert normalized(exported_again(data), "simaticml") == normalized(data, "simaticml")
    assert b"DocumentInfo" not in normalized(data, "simaticml")
    assert b"ReadOnly" not in normalized(exported_again(data), "simaticml")


@pytest.mark.parametrize("path", ALL_PARAMS[::3])
def test_normalising_twice_changes_nothing_and_keeps_documents_valid(path: Path) -> None:
    data = path.read_bytes()
    once = normalized(data, "simaticml")
    assert normalized(once, "simaticml") == once
    if not validate(data):
        assert validate(once) == []
    assert not [element for element in parsed(once).iter(etree.Element) if element.get("ReadOnly") == "true"]


LEFT_OUT = re.compile(r"^header\b|extension data|\b(comment|initial|attributes)(\W|$)")


@pytest.mark.slow
@pytest.mark.corpus
def test_the_program_is_the_same() -> None:
    """Only what was left out is missing: informative comments, start values and attributes, and what is kept."""
    require_corpus()
    compared = 0
    for path in real_documents()[::5]:
        data = path.read_bytes()
        before, after = sfc.loads(data), sfc.loads(normalized(data, "simaticml"))
        before.read_all()
        after.read_all()
        other = [found.path for found in differences(before, after) if not LEFT_OUT.search(found.path)]
        assert other == [], path
        compared += 1
    assert compared


def test_save_and_dumps_normalise(tmp_path: Path) -> None:
    project = sfc.load(DRILL)
    sfc.save(project, tmp_path / "a.xml", normalize=True)
    assert (
        (tmp_path / "a.xml").read_bytes()
        == sfc.dumps(project, normalize=True)
        == normalized(DRILL.read_bytes(), "simaticml")
    )
    sfc.save(project, (buffer := io.BytesIO()), tia="V16", normalize=True)
    assert b'version="V16"' in buffer.getvalue()
    assert b"DocumentInfo" not in buffer.getvalue()


def test_an_edit_of_a_normalised_document_is_one_line() -> None:
    project = sfc.loads(sfc.dumps(sfc.load(DRILL), normalize=True))
    before = sfc.dumps(project, normalize=True).splitlines()
    chart = project.pou("FB_Drill").sfc
    assert chart is not None
    chart.step("Drill").max_time = "T#99s"
    after = sfc.dumps(project, normalize=True).splitlines()
    assert [new for old, new in zip(before, after, strict=True) if old != new] != []
    assert sum(old != new for old, new in zip(before, after, strict=True)) == 1


def test_a_folder_is_normalised_document_by_document(tmp_path: Path) -> None:
    project = sfc.load(FOLDER)
    sfc.save(project, f"{tmp_path / 'plc'}/", normalize=True)
    for path in FOLDER.rglob("*.xml"):
        written = tmp_path / "plc" / path.relative_to(FOLDER)
        assert written.read_bytes() == normalized(path.read_bytes(), "simaticml")


def test_the_command_normalises(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "out.xml"
    assert main(["convert", str(DRILL), str(target), "--to", "simaticml", "--normalize", "--limit", "0"]) == 0
    assert target.read_bytes() == normalized(DRILL.read_bytes(), "simaticml")
    assert "as it was read" not in capsys.readouterr().out
    assert main(["convert", str(DRILL), str(target), "--to", "simaticml", "--tia", "v16", "--limit", "0"]) == 0
    assert b'<Engineering version="V16" />' in target.read_bytes()
    motor = FIXTURES / "FB_Motor.xml"
    assert main(["convert", str(motor), str(tmp_path / "no.xml"), "--to", "simaticml", "--tia", "V14SP1"]) == 2
    assert "a network in SCL needs TIA Portal V15" in capsys.readouterr().err
    assert not (tmp_path / "no.xml").exists()


def test_other_formats_have_nothing_to_normalise() -> None:
    with pytest.raises(UnknownFormatError, match="json"):
        sfc.dumps(sfc.load(DRILL), format="json", normalize=True)
    with pytest.raises(StructureError):
        normalized(b"<a/>", "simaticml")
