"""Values of inputs that are tried: those that their types have, and those that programs tell apart."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, equivalent

PROFILES = {"iec": "iec", "codesys": "codesys", "scl": "s7graph"}


def compare(one: str, other: str, dialect: str = "iec", *, is_chart: bool = False) -> Verdict:
    pair = [
        sfc.loads(
            f"""{{plcopen_sfc project.dialect := '{dialect}'}}
PROGRAM Main
VAR_INPUT t : TIME; d : DATE; td : TOD; dt1 : DT; END_VAR
VAR_INPUT x : REAL; lx : LREAL; s : STRING; short : STRING[10]; a : BOOL; END_VAR
VAR_OUTPUT q : BOOL; r : DINT; y : REAL; z : LREAL; u : STRING; v : STRING[5]; END_VAR
{CHART.format(body) if is_chart else body}
END_PROGRAM
""".encode(),
            format="iec-text",
        )
        for body in (one, other)
    ]
    return equivalent(*pair, PROFILES[dialect])


CHART = """INITIAL_STEP S1: END_STEP
TRANSITION FROM S1 TO S2 := {}; END_TRANSITION
STEP S2: q(N); END_STEP
TRANSITION FROM S2 TO S1 := NOT a; END_TRANSITION"""

ALIKE = [
    ("codesys", "t > T#5s", "t >= T#5s1ms"),
    ("scl", "t > T#5s", "t >= T#5s1ms"),
    ("codesys", "t < T#0s", "FALSE"),
    ("iec", "d > D#2024-02-28", "d >= D#2024-02-29"),
    ("codesys", "d > D#2024-02-28", "d >= D#2024-02-29"),
    ("iec", "td > TOD#12:00:00", "td >= TOD#12:00:00.001"),
    ("codesys", "td > TOD#12:00:00", "td >= TOD#12:00:00.001"),
    ("codesys", "dt1 > DT#2024-02-28-12:00:00", "dt1 >= DT#2024-02-28-12:00:01"),
    ("scl", "dt1 > DT#2024-02-28-12:00:00", "dt1 >= DT#2024-02-28-12:00:00.001"),
]


@pytest.mark.slow
@pytest.mark.parametrize("is_chart", [True, False])
@pytest.mark.parametrize(("dialect", "one", "other"), ALIKE)
def test_times_have_the_resolution_of_their_type(dialect: str, one: str, other: str, *, is_chart: bool) -> None:
    pair = (one, other) if is_chart else (f"q := {one};", f"q := {other};")
    assert compare(*pair, dialect, is_chart=is_chart).proven
    if not is_chart:
        searched = compare(*(f"{each} y := x / 3.0; z := lx / 3.0; u := s;" for each in pair), dialect)
        assert not searched.different, str(searched)


@pytest.mark.parametrize(
    ("dialect", "one", "other", "shown"),
    [
        ("iec", "t > T#5s", "t >= T#5s1ms", "5s1ns"),
        ("codesys", "t > T#5s", "t >= T#5s2ms", "5s1ms"),
        ("iec", "d > D#2024-02-28", "d > D#2024-02-29", "D#2024-02-29"),
        ("iec", "td > TOD#12:00:00", "td > TOD#12:00:00.001", "TOD#12:00:00.001"),
        ("codesys", "dt1 > DT#2024-02-28-12:00:00", "dt1 > DT#2024-02-28-12:00:01", "DT#2024-02-28-12:00:01"),
    ],
)
def test_traces_show_times_as_literals(dialect: str, one: str, other: str, shown: str) -> None:
    verdict = compare(f"q := {one};", f"q := {other};", dialect)
    assert verdict.different
    assert shown in str(verdict)


DIFFERENT = [
    ("u := LEFT(s, 5);", "u := LEFT(s, 6);"),
    ("r := LEN(s);", "r := MIN(LEN(s), 100);"),
    ("r := LEN(s);", "r := MIN(LEN(s), 253);"),
    ("r := LEN(short);", "r := MIN(LEN(short), 9);"),
    ("u := s;", "v := s; u := v;"),
    ("u := MID(s, 3, 20);", "u := MID(s, 3, 46);"),
    ("u := RIGHT(s, 30);", "u := RIGHT(s, 31);"),
    ("r := REAL_TO_INT(x);", "r := TRUNC(x);"),
    ("z := lx;", "z := LREAL_TO_REAL(lx);"),
    ("y := x * 0.1;", "y := x / 10.0;"),
    ("y := x * 2.0 / 2.0;", "y := x;"),
    ("q := t - T#1s > T#10s;", "q := t > T#11s;"),
    ("q := x * 2.0 > 5.0;", "q := x * 2.0 >= 5.0;"),
    ("q := x + 1.0 > 3.5;", "q := x + 1.0 >= 3.5;"),
    ("IF lx * 4.0 - 1.0 < 0.5 THEN q := TRUE; END_IF;", "IF lx * 4.0 - 1.0 <= 0.5 THEN q := TRUE; END_IF;"),
]


@pytest.mark.parametrize(("one", "other"), DIFFERENT)
def test_values_that_programs_tell_apart_are_tried(one: str, other: str) -> None:
    assert compare(one, other).different


def test_bounds_of_real_numbers_are_solved_in_conditions_of_transitions() -> None:
    assert compare("x * 2.0 > 5.0", "x * 2.0 >= 5.0", is_chart=True).different


def test_random_inputs_have_the_resolution_of_their_type() -> None:
    project = sfc.loads(
        b"{plcopen_sfc project.dialect := 'codesys'} PROGRAM Main VAR_INPUT t : TIME; d : DATE; dt1 : DT; END_VAR "
        b"VAR_OUTPUT q : BOOL; END_VAR "
        b"q := t > T#1s AND d > D#2024-01-01 AND dt1 > DT#2024-01-01-00:00:00; END_PROGRAM",
        format="iec-text",
    )
    trace = sfc.simulate(project, inputs=sfc.RandomInputs(3), scans=200)
    day = 86_400 * 10**9
    for name, unit in (("t", 10**6), ("d", day), ("dt1", 10**9)):
        assert all(value % unit == 0 for value in trace[name])
        assert len({*trace[name]}) > 3


def test_a_proof_says_that_real_inputs_are_numbers() -> None:
    verdict = compare("q := x <> x;", "q := FALSE;")
    assert verdict.proven
    assert "REAL inputs are finite numbers" in str(verdict)


def test_differences_show_times_as_literals() -> None:
    pair = [
        sfc.loads(
            f"PROGRAM Main VAR_OUTPUT t : TIME; d : DATE; END_VAR {body} END_PROGRAM".encode(),
            format="iec-text",
        )
        for body in ("t := T#2s; d := D#2024-02-28;", "t := T#1s; d := D#2024-02-29;")
    ]
    shown = str(equivalent(*pair, "iec"))
    assert "t is T#2s in the first and T#1s in the second" in shown
    assert "d is D#2024-02-28 in the first and D#2024-02-29 in the second" in shown
