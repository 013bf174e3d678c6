"""``plcopen-sfc simulate``."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.conftest import CommandRun
from tests.semantics.test_simulate import PLANT, SUM

Cli = Callable[..., CommandRun]


@pytest.fixture
def plant(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plant.st").write_text(PLANT, encoding="utf-8")
    (tmp_path / "sum.st").write_text(SUM, encoding="utf-8")
    lines = ["time ms;Start;Selected;Level", "0;0;Auto;0", "20;1;;", "30;0;;", "60;;;3.5", "150;;;"]
    (tmp_path / "in.csv").write_bytes("\r\n".join(lines).encode("utf-8-sig"))
    return tmp_path


def test_shows_the_scans_in_which_something_happens(cli: Cli, plant: Path) -> None:
    done = cli("simulate", "plant.st", "--inputs", "in.csv")
    assert done.code == 0
    rows = [line.split() for line in done.out.splitlines()]
    assert rows[0] == ["scan", "time", "active", "steps", "Start", "Level", "Valve", "Lamp"]
    assert [row[:3] for row in rows[1:]] == [
        ["0", "0s", "Wait"],
        ["2", "20ms", "Fill"],
        ["3", "30ms", "Fill"],
        ["6", "60ms", "Settle"],
        ["11", "110ms", "Wait"],
        ["15", "150ms", "Wait"],
    ]
    assert done.err.startswith("rules: execution profile iec\n")
    assert "unchanged: " in done.err
    assert "Selected = Auto, Count = 0, Total = 0" in done.err


def test_files_that_it_writes_are_inputs_again(cli: Cli, plant: Path) -> None:
    done = cli("simulate", "plant.st", "--seed", "3", "--scans", "80", "--csv", "out.csv", "--vcd", "out.vcd", "-q")
    assert (done.code, done.err) == (0, "")
    assert (plant / "out.vcd").read_text(encoding="ascii").startswith("$version plcopen_sfc")
    assert len((plant / "out.csv").read_text(encoding="utf-8-sig").splitlines()) == 81
    again = cli("simulate", "plant.st", "--inputs", "out.csv")
    assert again.out == done.out
    assert "no inputs, so left out: Valve" in again.err


def test_json(cli: Cli, plant: Path) -> None:
    done = cli("simulate", "plant.st", "--set", "Start=TRUE", "--set", "selected = Auto", "--scans", "4", "--json")
    data = json.loads(done.out)
    assert data["file"] == "plant.st"
    assert data["scans"] == 4
    assert data["situations"] == [[0, ["Fill"]]]
    assert data["profile"] == "iec"


def test_options(cli: Cli, plant: Path) -> None:
    done = cli(
        "simulate", "plant.st", "--scan-time", "5ms", "--scans", "3", "--profile", "codesys", "--record", "lamp", "-v"
    )
    assert done.out.split() == "scan time active steps Lamp 0 0s Wait 1 2 10ms Wait 1".split()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--inputs", "none.csv"], "none.csv: the file does not exist"),
        (["--inputs", "in.csv", "--seed", "1"], "not from both"),
        (["--pou", "Other"], "no POU 'Other'"),
        (["--profile", "other"], "no profile 'other'"),
        (["--scan-time", "soon"], "'soon' is no scan time"),
        (["--set", "Start"], "'Start' sets nothing"),
        (["--set", "Start=often"], "'often' is no BOOL"),
        (["--set", "Strat=1"], "Strat"),
        (["--record", "Nothing"], "Nothing"),
        (["--scans", "-1"], "--scans"),
    ],
)
def test_what_is_wrong_is_told(cli: Cli, plant: Path, arguments: list[str], message: str) -> None:
    done = cli("simulate", "plant.st", *arguments)
    assert done.code == 2
    assert message in done.err
    assert done.out == ""


def test_a_wrong_cell_is_named_by_its_line(cli: Cli, plant: Path) -> None:
    (plant / "wrong.csv").write_text("Start\n1\n\nyes\n", encoding="utf-8")
    done = cli("simulate", "plant.st", "--inputs", "wrong.csv")
    assert done.code == 2
    assert "wrong.csv:4: Start: 'yes' is no BOOL" in done.err


PLAN = """GRAFCET Plan
INPUTS
    C1 : INT
CHART G1
    INITIAL STEP 1
    1 -> M2 : 1
    MACRO M2
    M2 -> 1 : C1
EXPANSION M2
    STEP E2
        ON ACTIVATION C1 := C1 + TRUE
    E2 -> S2 : 1
    STEP S2
"""


def test_an_error_of_a_grafcet_has_its_line(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "plan.gct"
    path.write_text(PLAN.replace("+ TRUE", "+ 1"), encoding="utf-8")
    assert f"{path}:8 (POU Plan / transition G1.M2 -> 1): a INT is where a BOOL" in cli("simulate", path).err
    path.write_text(PLAN.replace(": C1\n", ": [C1>0]\n"), encoding="utf-8")
    assert f"{path}:10 (POU Plan / step G1.M2.E2 / line 1): + of INT and BOOL" in cli("simulate", path).err


def test_an_error_of_the_program_is_a_finding(cli: Cli, plant: Path) -> None:
    (plant / "b.csv").write_text("A;B\n4;2\n4;1\n4;0\n", encoding="utf-8")
    done = cli("simulate", "sum.st", "--inputs", "b.csv")
    assert done.code == 1
    assert "zero" in done.err
    assert len(done.out.splitlines()) == 3  # what happened before is shown
    data = json.loads(cli("simulate", "sum.st", "--inputs", "b.csv", "--json").out)
    assert data["scans"] == 2
    assert "zero" in data["error"]


def test_saves_a_timing_diagram_and_a_page(cli: Cli, plant: Path) -> None:
    done = cli("simulate", "plant.st", "--inputs", "in.csv", "--svg", "t.svg", "--html", "t.html", "--lang", "de")
    assert done.code == 0
    assert [line for line in done.err.splitlines() if "written" in line] == ["written: t.svg", "written: t.html"]
    assert "<title>Valve</title>" in Path("t.svg").read_text(encoding="ascii")
    page = Path("t.html").read_text(encoding="ascii")
    assert "16 Zyklen von T#10ms" in page
    assert 'id="player"' in page


@pytest.mark.slow
def test_a_converted_file_as_its_tool_reads_it(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The extension data have a qualifier that S7-GRAPH lacks, and the rules of its tool; TIA Portal does the same."""
    monkeypatch.chdir(tmp_path)
    source = """PROGRAM Main
VAR_INPUT go : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP A: q(DS, T#20ms); END_STEP
STEP B: END_STEP
TRANSITION FROM A TO B := go; END_TRANSITION
TRANSITION FROM B TO A := NOT go; END_TRANSITION
END_PROGRAM
"""
    (tmp_path / "a.st").write_text(source, encoding="utf-8")
    assert cli("convert", "a.st", "a.xml", "--to", "simaticml", "--limit", "3").code == 0
    assert cli("simulate", "a.xml", "--scans", "8").out == cli("simulate", "a.st", "--scans", "8").out
    assert cli("simulate", "a.xml", "--scans", "8", "--profile", "s7graph").code == 1
    assert cli("simulate", "a.xml", "--scans", "8", "--as-tool", "--csv", "trace.csv").code == 0
    rows = [row.split(";") for row in (tmp_path / "trace.csv").read_text(encoding="utf-8-sig").splitlines()]
    values = [row[rows[0].index("q")] for row in rows[1:]]
    assert values[0] == "0"
    assert values[-1] == "1"
