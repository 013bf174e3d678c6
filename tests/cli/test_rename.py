"""rename: what it writes, what it shows, and its exit codes."""

from __future__ import annotations

import json
import shutil

import pytest

import plcopen_sfc as sfc

BELT = "codesys/sorting_conveyor.xml"


@pytest.fixture
def belt(fixtures, tmp_path, monkeypatch):
    """A copy of an example file that may be changed, in the working folder."""
    shutil.copy(fixtures / BELT, tmp_path / "belt.xml")
    monkeypatch.chdir(tmp_path)
    return tmp_path / "belt.xml"


def test_it_changes_the_file_and_says_where(cli, fixtures, belt):
    outcome = cli("rename", "belt.xml", "PLC_PRG.Measure", "Identify")
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.splitlines() == [
        "PLC_PRG.Measure is called Identify now, 1 place that names it changed too",
        "  PLC_PRG / transition Measure -> NotIdentified:1:1: Measure.t > T#2s500ms AND eMaterial = E_Material.Unknown",
        "written: belt.xml",
    ]
    old = (fixtures / BELT).read_bytes().splitlines()
    new = belt.read_bytes().splitlines()
    changed = [(a, b) for a, b in zip(old, new, strict=True) if a != b]
    assert len(changed) == 4
    assert all(b == a.replace(b"Measure", b"Identify") for a, b in changed)
    assert sfc.load(belt).pou("PLC_PRG").sfc.step("Identify")


def test_a_dry_run_shows_the_lines_and_writes_nothing(cli, fixtures, belt):
    outcome = cli("rename", "belt.xml", "PLC_PRG.Measure", "Identify", "--dry-run")
    assert outcome.code == 0
    lines = outcome.out.splitlines()
    assert lines[:2] == ["--- belt.xml", "+++ belt.xml"]
    assert sum(line.startswith("-") for line in lines) == sum(line.startswith("+") for line in lines) == 5
    assert belt.read_bytes() == (fixtures / BELT).read_bytes()


@pytest.mark.parametrize("name", ["broken/umlauts_utf16.xml", "broken/umlauts_cp1252.xml", "broken/umlauts_utf8.xml"])
def test_a_dry_run_knows_encodings(cli, fixtures, name):
    outcome = cli("rename", name, "Rührkessel.Füllen", "Befüllen", "--dry-run")
    assert outcome.code == 0
    assert 'name="Befüllen"' in outcome.out
    assert "\ufffd" not in outcome.out


@pytest.mark.slow
def test_json(cli, belt):
    outcome = cli("rename", "belt.xml", "PLC_PRG.Measure", "Identify", "--json")
    data = json.loads(outcome.out)
    assert (data["old"], data["new"], data["path"], data["undecided"]) == ("Measure", "Identify", "PLC_PRG.Measure", [])
    assert data["written"] == ["belt.xml"]
    assert [(use["language"], use["line"], use["column"]) for use in data["changed"]] == [("SFC", 1, 1)]
    dry = json.loads(cli("rename", "belt.xml", "PLC_PRG.Identify", "Measure", "--json", "--dry-run").out)
    assert "written" not in dry
    assert any("Measure" in line for line in dry["diff"])


def test_places_that_nobody_can_tell_are_findings(cli, belt):
    project = sfc.load(belt)
    project.pou("FB_Pusher").action("Retracted_active").body.text = "Lib.Other.Measure := 1;"
    sfc.save(project, belt)
    outcome = cli("rename", "belt.xml", "PLC_PRG.Measure", "Identify")
    assert outcome.code == 1
    assert "FB_Pusher.Retracted_active:1:11" in outcome.err
    assert "Lib.Other.Measure" in outcome.err
    assert b"Lib.Other.Measure" in belt.read_bytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["PLC_PRG.Measure", "IF"], "keyword"),
        (["PLC_PRG.Measure", "a b"], "cannot be a name"),
        (["PLC_PRG.Measure", "Feed"], "already"),
        (["Measure", "Identify"], "PLC_PRG.Measure"),
        (["PLC_PRG.Meassure", "Identify"], "PLC_PRG.Measure"),
    ],
)
def test_what_cannot_be_done_is_2(cli, fixtures, belt, arguments, message):
    outcome = cli("rename", "belt.xml", *arguments)
    assert (outcome.code, outcome.out) == (2, "")
    assert message in outcome.err
    assert "Traceback" not in outcome.err
    assert belt.read_bytes() == (fixtures / BELT).read_bytes()


def test_a_file_that_is_none(cli, tmp_path):
    assert cli("rename", tmp_path / "none.xml", "a", "b").code == 2
