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


TABLE = (
    "Old;New;Why\r\nPLC_PRG.Measure;Identify;plant standard\r\n\r\nFB_Pusher.Jammed;Stuck\r\nPLC_PRG.Nowhere;Here\r\n"
)


def _workbook(path, rows):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    book.save(path)


@pytest.mark.parametrize("name", ["names.csv", "names.xlsx"])
def test_a_table_has_many_names(cli, belt, name):
    if name == "names.csv":
        (belt.parent / name).write_bytes(TABLE.encode("cp1252"))
    else:
        _workbook(belt.parent / name, [line.split(";") for line in TABLE.splitlines()])
    outcome = cli("rename", "belt.xml", "--table", name)
    assert outcome.code == 0
    assert [line for line in outcome.out.splitlines() if not line.startswith("  ")] == [
        "PLC_PRG.Measure is called Identify now, 1 place that names it changed too",
        "FB_Pusher.Jammed is called Stuck now, 0 places that name it changed too",
        "written: belt.xml",
    ]
    assert outcome.err.splitlines() == ["1 of 3 names of the table are not declared here:", "  PLC_PRG.Nowhere"]
    project = sfc.load(belt)
    assert project.pou("PLC_PRG").sfc.step("Identify")
    assert project.pou("FB_Pusher").sfc.step("Stuck")


def test_a_table_exchanges_names_in_many_files(cli, fixtures, belt):
    shutil.copy(fixtures / "codesys" / "device_export.xml", belt.parent / "pumps.xml")
    (belt.parent / "names.csv").write_text("PLC_PRG.Idle,WaitPart\nPLC_PRG.WaitPart,Idle\n", encoding="utf-8")
    before = [step.name for step in sfc.load(belt).pou("PLC_PRG").sfc.steps]
    outcome = cli("rename", "belt.xml", "pumps.xml", "--table", "names.csv", "--json")
    data = json.loads(outcome.out)
    assert [(each["outcome"], each["missing"]) for each in data["files"]] == [
        ("changed", []),
        ("unchanged", ["PLC_PRG.Idle", "PLC_PRG.WaitPart"]),
    ]
    assert [each["new"] for each in data["files"][0]["renamed"]] == ["WaitPart", "Idle"]
    assert outcome.code == 1  # none of its names is in the second file
    after = [step.name for step in sfc.load(belt).pou("PLC_PRG").sfc.steps]
    exchanged = {"Idle": "WaitPart", "WaitPart": "Idle"}
    assert after == [exchanged.get(name, name) for name in before]


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("Old;New\nPLC_PRG.Idle;\n", "names.csv:2: this row has no new name"),
        ("PLC_PRG.Idle;Rest\nPLC_PRG.Idle;Wait\n", "names.csv:2: PLC_PRG.Idle gets two names: Rest and Wait"),
        ("Old;New\n", "names.csv: this table has no names"),
        ("PLC_PRG.Idle;WaitPart\n", "WaitPart"),
        ("PLC_PRG.Idle;END_IF\n", "END_IF"),
    ],
)
def test_a_table_that_cannot_be_followed_changes_nothing(cli, fixtures, belt, rows, told):
    (belt.parent / "names.csv").write_text(rows, encoding="utf-8")
    outcome = cli("rename", "belt.xml", "--table", "names.csv")
    assert outcome.code == 2
    assert told in outcome.err
    assert belt.read_bytes() == (fixtures / BELT).read_bytes()


def test_what_to_rename_is_needed_without_a_table(cli, belt):
    outcome = cli("rename", "belt.xml", "PLC_PRG.Measure")
    assert outcome.code == 2
    assert "--table names.csv" in outcome.err
