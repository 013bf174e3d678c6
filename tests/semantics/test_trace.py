"""Traces: what they answer, and what their files say to others."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from vcd.reader import RealChange, ScalarChange, ScopeDecl, StringChange, TokenKind, VarDecl, VectorChange, tokenize

from plcopen_sfc.errors import ModelError
from plcopen_sfc.semantics.signals import Signal, Value
from plcopen_sfc.semantics.trace import Column, Trace, ValueChange
from tests.sweeps import examples

MS = 1_000_000
MODE = Signal.enumeration("E_Mode", {0: "Off", 1: "Auto", 5: "Manual"})
SIGNALS = {
    "Start": Signal.elementary("BOOL"),
    "Count": Signal.elementary("INT"),
    "Mask": Signal.elementary("WORD"),
    "Level": Signal.elementary("REAL"),
    "Fill.T": Signal.elementary("TIME"),
    "Text": Signal.elementary("STRING"),
    "Mode": MODE,
}


def trace_of(rows: list[list[Value]], markings: list[int] | None = None) -> Trace:
    columns = [Column(name, signal, "output") for name, signal in SIGNALS.items()]
    trace = Trace(columns, scan_time=10 * MS, steps=["Init", "Fill"], name="Plant")
    for number, row in enumerate(rows):
        trace.record(row, markings[number] if markings else 1)
    return trace


ROWS: list[list[Value]] = [
    [False, 0, 0, 0.0, 0, "", 0],
    [True, -3, 0xFFFF, 2.5, 0, "full", 1],
    [True, -3, 0xFFFF, 2.5, 10 * MS, "a b$'\n", 5],
]


def test_questions() -> None:
    trace = trace_of(ROWS, [1, 2, 3])
    assert len(trace) == 3
    assert trace["start"] == [False, True, True]
    assert trace["Count"][1] == trace["Count"][-1] == -3
    assert trace["Count"][1:] == [-3, -3]
    assert trace.active(0) == ("Init",)
    assert trace.active(-1) == ("Init", "Fill")
    assert trace.is_active("fill") == [False, True, True]
    assert trace.time(2) == 20 * MS
    assert trace.situations() == [(0, ("Init",)), (1, ("Fill",)), (2, ("Init", "Fill"))]
    assert trace.changes("Start", "Fill.T") == [
        ValueChange(0, "Start", False),
        ValueChange(0, "Fill.T", 0),
        ValueChange(1, "Start", True),
        ValueChange(2, "Fill.T", 10 * MS),
    ]
    assert trace.row(1)["Text"] == "full"
    assert "MODE" in trace
    assert "Missing" not in trace


def test_what_was_not_recorded_is_told() -> None:
    trace = trace_of(ROWS)
    with pytest.raises(ModelError, match="'Missing' was not recorded") as error:
        trace["Missing"]
    assert "Start" in error.value.hint
    with pytest.raises(ModelError, match="no step 'S9'"):
        trace.is_active("S9")
    for scan in (3, -4):
        with pytest.raises(IndexError, match="it has 3"):
            trace.active(scan)
        with pytest.raises(IndexError, match="it has 3"):
            trace.time(scan)


def test_prints_the_scans_in_which_something_happens() -> None:
    trace = trace_of([ROWS[0]] * 5 + [ROWS[1]] * 5)
    lines = str(trace).splitlines()
    assert [line.split()[0] for line in lines] == ["scan", "0", "5", "9"]
    assert "Auto" in lines[2]
    assert "50ms" in lines[2]


def test_memory_follows_what_happens() -> None:
    column = Column("Q", Signal.elementary("BOOL"))
    for scan in range(100_000):
        column.append(scan >= 50_000)
    assert len(list(column.runs())) == 2
    assert (column[49_999], column[50_000], len(column)) == (False, True, 100_000)


def test_a_long_time_is_no_multiple_of_a_scan_by_chance() -> None:
    trace = Trace([], scan_time=333_333, steps=[], name="x")
    for _ in range(3):
        trace.record([])
    assert [row.split(";") for row in trace.csv().split()[2:]] == [
        ["ms"],
        ["0", "0"],
        ["1", "0.333333"],
        ["2", "0.666666"],
    ]


def test_csv_can_be_read_by_others(tmp_path: Path) -> None:
    trace = trace_of(ROWS, [1, 2, 3])
    trace.save_csv(tmp_path / "t.csv")
    data = (tmp_path / "t.csv").read_bytes()
    assert data.startswith(b"\xef\xbb\xbf")
    table = list(csv.DictReader(io.StringIO(data.decode("utf-8-sig")), delimiter=";"))
    assert table[1]["Count"] == "-3"
    assert table[2]["active steps"] == "Init Fill"
    assert table[2]["Fill.T"] == "T#10ms"
    assert table[2]["time ms"] == "20"
    assert table[1]["Mode"] == "Auto"


def test_json_says_the_changes() -> None:
    data = trace_of([*ROWS, [True, 1, 1, float("inf"), 0, "", 0]]).as_dict()
    assert data["scans"] == 4
    by_name = {column["name"]: column for column in data["columns"]}
    assert by_name["Start"]["changes"] == [[0, False], [1, True]]
    assert by_name["Level"]["changes"][-1] == [3, "inf"]


# -- VCD, read by a library that is not ours


def read_vcd(text: str) -> tuple[dict[str, list[tuple[int, object]]], str]:
    """Every variable with its scopes and its changes by time; and the time scale."""
    names: dict[str, tuple[str, int]] = {}
    found: dict[str, list[tuple[int, object]]] = {}
    scopes: list[str] = []
    now, scale = 0, ""
    for token in tokenize(io.BytesIO(text.encode("ascii"))):
        data = token.data
        if token.kind is TokenKind.TIMESCALE:
            scale = str(token.timescale)
        elif isinstance(data, ScopeDecl):
            scopes.append(data.ident)
        elif token.kind is TokenKind.UPSCOPE:
            scopes.pop()
        elif isinstance(data, VarDecl):
            name = ".".join([*scopes, data.reference])
            assert name not in found
            names[data.id_code] = (name, data.size)
            found[name] = []
        elif token.kind is TokenKind.CHANGE_TIME:
            assert isinstance(data, int)
            assert data >= now
            now = data
        elif token.kind.name.startswith("CHANGE_"):
            assert isinstance(data, ScalarChange | VectorChange | RealChange | StringChange)
            name, size = names[data.id_code]
            value: object = data.value
            if isinstance(data, VectorChange) and isinstance(value, int) and size != 1 and value >> (size - 1):
                value -= 1 << size
            found[name].append((now, value))
    assert scopes == []
    return found, scale


def test_vcd_is_read_by_another_library(tmp_path: Path) -> None:
    trace = trace_of(ROWS, [1, 2, 3])
    trace.save_vcd(tmp_path / "t.vcd")
    found, scale = read_vcd((tmp_path / "t.vcd").read_text(encoding="utf-8"))
    assert scale == "1 ms"
    assert found["Plant.Start"] == [(0, "0"), (10, "1")]
    assert found["Plant.Count"] == [(0, 0), (10, -3)]
    assert found["Plant.Level"] == [(0, 0.0), (10, 2.5)]
    assert found["Plant.Fill.T"] == [(0, 0.0), (20, 0.01)]
    assert found["Plant.Text"][1:] == [(10, "full"), (20, "a\\x20b$'\\x0a")]
    assert found["Plant.Mode"] == [(0, "Off"), (10, "Auto"), (20, "Manual")]
    assert found["Plant.steps.Init"] == [(0, "1"), (10, "0"), (20, "1")]
    assert found["Plant.steps.Fill"] == [(0, "0"), (10, "1")]
    assert trace.vcd() == trace.vcd()


def test_vcd_of_many_and_odd_names() -> None:
    columns = [Column(f"a[{number}].Größe", Signal.elementary("DINT")) for number in range(200)]
    trace = Trace(columns, scan_time=1500, name="")
    trace.record(list(range(200)))
    found, scale = read_vcd(trace.vcd())
    assert scale == "1 ns"
    assert list(found.values()) == [[(0, number)] for number in range(200)]
    assert "_.a(7).Groesse" in found


VALUES = st.tuples(
    st.booleans(),
    st.integers(-(1 << 15), (1 << 15) - 1),
    st.integers(0, 0xFFFF),
    st.floats(width=32, allow_nan=False, allow_infinity=False),
    st.integers(-(10**15), 10**15),
    st.text(max_size=5),
    st.sampled_from([0, 1, 5]),
).map(list)


@settings(deadline=None, max_examples=examples(60))
@given(rows=st.lists(VALUES, min_size=1, max_size=8))
def test_every_cell_means_its_value(rows: list[list[Value]]) -> None:
    trace = trace_of(rows)
    for column in trace.columns:
        for value in column:
            assert column.signal.parse(column.signal.text(value)) == value
    assert [[column[scan] for column in trace.columns] for scan in range(len(rows))] == rows
    table = list(csv.reader(io.StringIO(trace.csv()), delimiter=";"))
    assert len(table) == len(rows) + 1


@settings(deadline=None, max_examples=examples(60))
@given(rows=st.lists(VALUES, min_size=1, max_size=8))
def test_vcd_says_every_change(rows: list[list[Value]]) -> None:
    trace = trace_of(rows)
    found, _ = read_vcd(trace.vcd())
    for name, column in (("Count", trace["Count"]), ("Level", trace["Level"])):
        assert found[f"Plant.{name}"] == [(scan * 10, value) for scan, value in column.runs()]
    assert len(found["Plant.Text"]) == len(list(trace["Text"].runs()))


def test_vcd_tells_names_apart_that_ascii_makes_equal() -> None:
    columns = [Column(name, Signal.elementary("BOOL")) for name in ("Größe", "Groesse", "é", "ж", "漢")]
    trace = Trace(columns, scan_time=MS, name="P")
    trace.record([True, False, True, False, True])
    assert list(read_vcd(trace.vcd())[0]) == ["P.Groesse", "P.Groesse_2", "P.e", "P._", "P.__2"]
