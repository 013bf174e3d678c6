"""Folders of documents on the command line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.documents.exports import block, changes, contents, export


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An export that may be changed, in the working folder."""
    monkeypatch.chdir(tmp_path)
    return export(tmp_path)


def test_info_tells_of_the_folder_as_one(cli: Any, folder: Path) -> None:
    outcome = cli("info", "export")
    assert outcome.code == 0
    assert "7 documents" in outcome.out
    assert "FB_Drill" in outcome.out
    data = json.loads(cli("info", "export", "--json").out)["files"][0]
    assert data["documents"] == 7
    assert data["size"] == sum(map(len, contents(folder).values()))


def test_a_bad_document_is_told_with_its_place(cli: Any, folder: Path) -> None:
    (folder / "cut.xml").write_bytes(block("A")[:300])
    for command in ("info", "validate"):
        outcome = cli(command, "export")
        assert outcome.code == 1
        assert "cut.xml:" in outcome.out + outcome.err
        assert "DIR101" in outcome.out + outcome.err


def test_validate_names_the_document(cli: Any, folder: Path) -> None:
    assert cli("validate", "export").code == 0
    path = folder / "Program blocks" / "FB_Motor.xml"
    text = path.read_text(encoding="utf-8-sig")
    assert '<Token Text=";"' in text
    path.write_text(text.replace('<Token Text=";"', '<Token Text="("', 1), encoding="utf-8-sig")
    outcome = cli("validate", "export")
    assert outcome.code == 1
    assert "FB_Motor.xml" in outcome.out


def test_rename_shows_and_makes_the_changes_of_all_files(cli: Any, folder: Path) -> None:
    before = contents(folder)
    outcome = cli("rename", "export", "FB_Drill", "FB_Bohren", "--dry-run")
    assert [line for line in outcome.out.splitlines() if line.startswith(("-  ", "+  "))] == [
        "-      <Name>FB_Drill</Name>",
        "+      <Name>FB_Bohren</Name>",
        "-      <InstanceOfName>FB_Drill</InstanceOfName>",
        "+      <InstanceOfName>FB_Bohren</InstanceOfName>",
    ]
    assert contents(folder) == before
    outcome = cli("rename", "export", "FB_Drill", "FB_Bohren")
    assert outcome.code == 0
    assert outcome.out.count("written: ") == 2
    assert len(changes(before, contents(folder))) == 2


def test_rename_tells_of_documents_that_it_cannot_look_into(cli: Any, folder: Path) -> None:
    (folder / "cut.xml").write_bytes(block("A")[:300])
    outcome = cli("rename", "export", "FB_Drill", "FB_Bohren")
    assert "cut.xml" in outcome.err
    assert "not read" in outcome.err


@pytest.mark.slow
def test_convert_from_and_to_folders(cli: Any, folder: Path) -> None:
    assert cli("convert", "export", "--to", "iec-text", "--partial", "--quiet", "--limit", "0").code == 0
    assert Path("export.iec-text.st").is_file()
    outcome = cli("convert", "export.iec-text.st", "back/", "--to", "simaticml-V18", "--quiet", "--limit", "0")
    assert (outcome.code, outcome.err) == (0, "")
    assert "Program blocks/Station Süd/FB_Drill.xml" in contents(Path("back"))
    Path("back/notes.txt").write_text("x", encoding="utf-8")
    outcome = cli("convert", "export", "back", "--to", "simaticml")
    assert "files" in outcome.out
    assert "other files in the folder are left" in outcome.err
    assert Path("back/notes.txt").is_file()


def test_a_folder_without_documents_is_unreadable(cli: Any, tmp_path: Path) -> None:
    outcome = cli("info", tmp_path)
    assert outcome.code == 2
    assert "no document of simaticml" in outcome.err


def test_an_empty_file_of_a_tool_is_not_passed_over(cli: Any, tmp_path: Path) -> None:
    """Other empty files, such as `.gitkeep` or `notes.xml`, are none of it."""
    text = "PROGRAM P\nVAR a : BOOL; END_VAR\na := TRUE;\nEND_PROGRAM\n"
    for name, content in {"P.st": text, "Q.st": "\ufeff\n", "notes.xml": "", "keep": ""}.items():
        (tmp_path / name).write_text(content, encoding="utf-8")
    outcome = cli("validate", tmp_path)
    assert outcome.code == 2
    assert "Q.st: no " in outcome.err
    assert "notes.xml" not in outcome.out + outcome.err
    (tmp_path / "Q.st").unlink()
    assert cli("validate", tmp_path).code == 0
