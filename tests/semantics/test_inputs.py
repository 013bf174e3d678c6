"""Inputs from files, traces and chance."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from plcopen_sfc.errors import FileAccessError, InputError
from plcopen_sfc.semantics.inputs import CsvInputs, RandomInputs, TraceInputs, Variables
from plcopen_sfc.semantics.signals import Signal, Value
from plcopen_sfc.semantics.trace import Column, Trace

MS = 1_000_000
VARIABLES = Variables(
    {
        "Start": Signal.elementary("BOOL"),
        "Level": Signal.elementary("REAL"),
        "Count": Signal.elementary("INT"),
        "Delay": Signal.elementary("TIME"),
        "Text": Signal.elementary("STRING"),
        "Mode": Signal.enumeration("E_Mode", {0: "Off", 1: "Auto"}),
    },
    others=["Q1"],
)


def rows(source: CsvInputs, count: int | None = None, scan_time: int = 10 * MS) -> list[dict[str, Value]]:
    bound = source.bind(VARIABLES, scan_time)
    return [dict(bound(scan)) for scan in range(count or source.scans(scan_time) or 0)]


@pytest.mark.parametrize("delimiter", [";", ",", "\t"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_files_of_any_tool(tmp_path: Path, delimiter: str, encoding: str, newline: str) -> None:
    lines = ["Start|LEVEL|count|Delay|Text|Mode", "TRUE|2.5|16#7F|T#1.5s|'grün'|Auto", "0|||||E_Mode#Off", ""]
    path = tmp_path / "in.csv"
    path.write_bytes(newline.join(lines).replace("|", delimiter).encode(encoding))
    assert rows(CsvInputs.load(path)) == [
        {"Start": True, "Level": 2.5, "Count": 127, "Delay": 1500 * MS, "Text": "grün", "Mode": 1},
        {"Start": False, "Mode": 0},
    ]


def test_rows_by_time_and_by_scan_hold() -> None:
    by_time = CsvInputs.parse("time ms;Start\n0;0\n20;1\n25;0\n")
    assert by_time.scans(10 * MS) == 4
    assert rows(by_time) == [{"Start": False}, {}, {"Start": True}, {"Start": False}]
    by_scan = CsvInputs.parse("Start,scan no\nTRUE,2\nFALSE,5")
    assert rows(by_scan, 7) == [{}, {}, {"Start": True}, {}, {}, {"Start": False}, {}]


def test_excel_says_its_separator_and_booleans_in_german() -> None:
    assert rows(CsvInputs.parse('sep=;\r\n\r\n"Start";Text;\r\nWAHR;"a;b";\r\nFALSCH;c;\r\n')) == [
        {"Start": True, "Text": "a;b"},
        {"Start": False, "Text": "c"},
    ]


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("", 1, "no header"),
        ("\n\n", 1, "no header"),
        ("Start;Strat\n1;1", 1, "no variable 'Strat'"),
        ("Start;start\n1;1", 1, "two columns are named 'start'"),
        ("Start;;Count\n1;;1", 1, "a column has no name"),
        ("Start\n1\nmaybe", 3, "Start: 'maybe' is no BOOL"),
        ("Start;Count\n1;1\n\n1", 4, "the row has 1 cells, the header 2"),
        ("Start,Level\n1,2,5", 2, "the row has 3 cells, the header 2"),
        ('Start;Level\n1;"2,5"', 2, "'2,5' is no REAL"),
        ("Count\n40000", 2, "40000 does not fit the type INT"),
        ("Delay\n5", 2, "'5' is no TIME"),
        ("Delay\nT#5", 2, "'T#5' is no TIME"),
        ("Count\nT#5s", 2, "'T#5s' is no INT"),
        ("Mode\n7", 2, "7 is no value of E_Mode"),
        ("Mode\nStop", 2, "'Stop' is no E_Mode"),
        ("Text\n'a", 2, "no string in quotes"),
        ('Start;Text\n1;"a\n', 2, "this is no CSV"),
        ("time ms;Start\nx;1", 2, "time ms: 'x' is no number"),
        ("scan no;Start\n1.5;1", 2, "scan no: '1.5' is no number"),
        ("scan no;Start\n3;1\n2;0", 3, "is behind a later row"),
        ("time ms;Start\n10;1\n5;0", 3, "is behind a later row"),
        ("Level\n1e99", 2, "does not fit the type REAL"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(text: str, line: int, message: str) -> None:
    with pytest.raises(InputError) as error:
        rows(CsvInputs.parse(text, file="in.csv"))
    assert message in error.value.message
    assert error.value.location.file == "in.csv"
    assert error.value.location.line == line


def test_what_is_at_an_address_is_found_by_its_name_alone() -> None:
    paths = ["Main.Start", "Main.Stop", "Other.Stop"]
    at_addresses = Variables({path: Signal.elementary("BOOL") for path in paths})
    assert [at_addresses.find(name) for name in ("start", "main.stop", "Stop")] == ["Main.Start", "Main.Stop", None]


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(FileAccessError, match="does not exist"):
        CsvInputs.load(tmp_path / "none.csv")


def recorded() -> Trace:
    columns = [Column(name, signal) for name, signal in VARIABLES.inputs.items()]
    trace = Trace([*columns, Column("Q1", Signal.elementary("BOOL"))], scan_time=10 * MS, steps=["S1"])
    trace.record([True, 1.5, 3, 10 * MS, "", 1, False], 1)
    trace.record([True, 0.1, 3, 20 * MS, "it's", 0, True], 0)
    trace.record([False, 0.1, -3, 20 * MS, '$;\n"', 0, True], 1)
    return trace


def test_a_trace_is_an_input_again() -> None:
    trace = recorded()
    from_file = CsvInputs.parse(trace.csv())
    bound = from_file.bind(VARIABLES, 10 * MS)
    assert from_file.ignored == ["Q1"]
    again = TraceInputs(trace).bind(VARIABLES, 10 * MS)
    state: dict[str, Value] = {}
    other: dict[str, Value] = {}
    for scan in range(3):
        state.update(bound(scan))
        other.update(again(scan))
        wanted = {name: value for name, value in trace.row(scan).items() if name != "Q1"}
        wanted["Level"] = VARIABLES.inputs["Level"].accept(wanted["Level"])
        assert state == wanted
        assert other == {**wanted, "Level": trace["Level"][scan]}


def random_rows(source: RandomInputs, variables: Variables = VARIABLES, scans: int = 300) -> list[dict[str, Value]]:
    bound = source.bind(variables, 10 * MS)
    state: dict[str, Value] = {}
    found = []
    for scan in range(scans):
        state = {**state, **bound(scan)}
        found.append(state)
    return found


def test_random_inputs_are_the_same_for_the_same_seed() -> None:
    assert random_rows(RandomInputs(7)) == random_rows(RandomInputs(7))
    assert random_rows(RandomInputs(7)) != random_rows(RandomInputs(8))
    alone = Variables({"Start": Signal.elementary("BOOL")})
    assert [row["Start"] for row in random_rows(RandomInputs(7))] == [
        row["Start"] for row in random_rows(RandomInputs(7), alone)
    ]
    # the same on every machine and with every version of Python
    assert (
        "".join(str(int(bool(row["Start"]))) for row in random_rows(RandomInputs(1, hold=(1, 3)), scans=20))
        == "11010001100011101100"
    )


def test_random_inputs_keep_to_their_bounds() -> None:
    source = RandomInputs(3, hold=(2, 5), ranges={"level": (-1, 1), "Count": (7, 9)}, values={"Delay": [5, 6]})
    found = random_rows(source)
    assert {row["Count"] for row in found} == {7, 8, 9}
    assert {row["Delay"] for row in found} == {5, 6}
    assert {row["Mode"] for row in found} == {0, 1}
    levels = {row["Level"] for row in found}
    assert len(levels) > 20
    assert all(isinstance(level, float) and -1 <= level <= 1 for level in levels)
    changes = [scan for scan in range(1, 300) if found[scan]["Start"] != found[scan - 1]["Start"]]
    gaps = {b - a for a, b in itertools.pairwise(changes)}
    assert gaps == {2, 3, 4, 5}
    only = random_rows(RandomInputs(3, holds=[4, 9]))
    changes = [scan for scan in range(1, 300) if only[scan]["Start"] != only[scan - 1]["Start"]]
    assert {b - a for a, b in itertools.pairwise(changes)} == {4, 9}


def test_random_inputs_leave_alone_what_operates_the_chart() -> None:
    signals = {name: Signal.elementary("BOOL") for name in ("Go", "SFCInit", "sfcPause")}
    variables = Variables(signals, system={"SFCInit", "sfcPause"})
    assert set(random_rows(RandomInputs(3), variables)[-1]) == {"Go"}
    assert set(random_rows(RandomInputs(3, values={"sfcinit": [True]}), variables)[-1]) == {"Go", "SFCInit"}
    assert len(random_rows(RandomInputs(3, system_inputs=True), variables)[-1]) == 3


def test_random_inputs_of_what_is_not_there() -> None:
    with pytest.raises(InputError, match="no input 'Nothing'"):
        random_rows(RandomInputs(1, ranges={"Nothing": (0, 1)}))
