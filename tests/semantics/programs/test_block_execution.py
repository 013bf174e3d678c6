"""Flip-flops, edges, counters and timers, at the times that matter."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as s

from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs import Instance
from tests.semantics.programs.running import MS, scan_at, start
from tests.sweeps import examples

TRUTH = [(False, False), (True, False), (True, True), (False, False), (False, True), (True, True), (False, False)]


def block(type_: str, call: str, inputs: str, dialect: Dialect = Dialect.IEC) -> Instance:
    text = f"PROGRAM Main\nVAR_INPUT {inputs} END_VAR\nVAR b : {type_}; END_VAR\n{call}\nEND_PROGRAM"
    return start(text, dialect)


@pytest.mark.parametrize(
    ("type_", "call", "expected"),
    [
        ("RS", "b(S := x, R1 := y);", [False, True, False, False, False, False, False]),
        ("SR", "b(S1 := x, R := y);", [False, True, True, True, False, True, True]),
    ],
)
def test_the_input_with_the_one_dominates(type_: str, call: str, expected: list[bool]) -> None:
    instance = block(type_, call, "x, y : BOOL;")
    seen = []
    for x, y in TRUTH:
        instance["x"], instance["y"] = x, y
        instance.scan()
        seen.append(instance["b.Q1"])
    assert seen == expected


def test_flip_flops_know_the_pins_of_codesys() -> None:
    instance = block("RS", "b(SET := x, RESET1 := y);", "x, y : BOOL;", Dialect.CODESYS)
    instance["x"] = instance["y"] = True
    instance.scan()
    assert instance["b.Q1"] is False


@pytest.mark.parametrize(
    ("type_", "dialect", "expected"),
    [
        ("R_TRIG", Dialect.IEC, [True, False, False, False, True]),
        ("F_TRIG", Dialect.IEC, [False, False, True, False, False]),
        ("F_TRIG", Dialect.SCL, [False, False, True, False, False]),
    ],
)
def test_edges(type_: str, dialect: Dialect, expected: list[bool]) -> None:
    instance = block(type_, "b(CLK := x);", "x : BOOL;", dialect)
    seen = []
    for value in (True, True, False, False, True):
        instance["x"] = value
        instance.scan()
        seen.append(instance["b.Q"])
    assert seen == expected


def test_the_first_call_of_a_falling_edge_with_false_is_one_but_in_s7() -> None:
    for dialect, expected in ((Dialect.IEC, True), (Dialect.CODESYS, True), (Dialect.SCL, False)):
        instance = block("F_TRIG", "b(CLK := x);", "x : BOOL;", dialect)
        instance.scan()
        assert instance["b.Q"] is expected


def test_on_delay_at_its_boundary() -> None:
    instance = block("TON", "b(IN := x, PT := T#100ms);", "x : BOOL;")
    instance["x"] = True
    seen = []
    for time in (0, 99, 100, 101, 5000):
        scan_at(instance, time)
        seen.append((instance["b.Q"], instance["b.ET"] // MS))
    assert seen == [(False, 0), (False, 99), (True, 100), (True, 100), (True, 100)]
    instance["x"] = False
    scan_at(instance, 5001)
    assert (instance["b.Q"], instance["b.ET"]) == (False, 0)


def test_on_delay_starts_anew_after_a_gap() -> None:
    instance = block("TON", "b(IN := x, PT := T#100ms);", "x : BOOL;")
    for time, value in ((0, True), (90, True), (95, False), (99, True), (198, True)):
        instance["x"] = value
        scan_at(instance, time)
        assert instance["b.Q"] is False
    scan_at(instance, 199)
    assert instance["b.Q"] is True


def test_off_delay_at_its_boundary() -> None:
    instance = block("TOF", "b(IN := x, PT := T#100ms);", "x : BOOL;")
    seen = []
    for time, value in ((0, False), (10, True), (20, False), (119, False), (120, False), (400, False)):
        instance["x"] = value
        scan_at(instance, time)
        seen.append((instance["b.Q"], instance["b.ET"] // MS))
    assert seen == [(False, 0), (True, 0), (True, 0), (True, 99), (False, 100), (False, 100)]


def test_a_pulse_lasts_its_time_whatever_the_input_does() -> None:
    instance = block("TP", "b(IN := x, PT := T#100ms);", "x : BOOL;")
    seen = []
    for time, value in ((0, True), (10, False), (20, True), (99, True), (100, True), (150, True), (160, False)):
        instance["x"] = value
        scan_at(instance, time)
        seen.append((instance["b.Q"], instance["b.ET"] // MS))
    assert seen == [(True, 0), (True, 10), (True, 20), (True, 99), (False, 100), (False, 100), (False, 0)]
    instance["x"] = True
    scan_at(instance, 170)
    assert instance["b.Q"] is True


def test_timers_without_a_time_act_at_once() -> None:
    instance = block("TON", "b(IN := x, PT := T#0s);", "x : BOOL;")
    instance["x"] = True
    instance.scan()
    assert instance["b.Q"] is True


def test_the_timers_of_s7() -> None:
    text = (
        "PROGRAM Main\nVAR_INPUT x, r : BOOL; END_VAR\n"
        "VAR a : TON_TIME; b : IEC_TIMER; c : TONR_TIME; q : BOOL; END_VAR\n"
        "a(IN := x, PT := T#100ms); b.TOF(IN := x, PT := T#50ms, Q => q);\n"
        "c(IN := x, R := r, PT := T#150ms);\nEND_PROGRAM"
    )
    instance = start(text, Dialect.SCL)
    instance["x"] = True
    scan_at(instance, 0)
    scan_at(instance, 100)
    assert (instance["a.Q"], instance["q"], instance["c.Q"]) == (True, True, False)
    instance["x"] = False
    scan_at(instance, 110)
    assert instance["c.ET"] == 100 * MS
    scan_at(instance, 160)
    assert instance["q"] is False
    instance["x"] = True
    scan_at(instance, 1000)
    scan_at(instance, 1050)
    assert (instance["c.ET"], instance["c.Q"]) == (150 * MS, True)
    instance["r"] = True
    scan_at(instance, 1060)
    assert (instance["c.ET"], instance["c.Q"]) == (0, False)


def test_timers_and_counters_of_s7_that_are_of_any_kind() -> None:
    text = (
        "PROGRAM Main\nVAR_INPUT x, r : BOOL; END_VAR\n"
        "VAR t : IEC_TIMER; u, d : IEC_COUNTER; pulse, up, down : BOOL; END_VAR\n"
        "t.TP(IN := x, PT := T#50ms, Q => pulse); u.CTU(CU := x, R := r, PV := 2, Q => up);\n"
        "d.CTD(CD := x, LD := r, PV := 2, Q => down);\nEND_PROGRAM"
    )
    instance = start(text, Dialect.SCL)
    seen = []
    for time, x, r in ((0, 0, 1), (10, 1, 0), (20, 0, 0), (30, 1, 0), (70, 0, 0), (80, 1, 0)):
        instance["x"], instance["r"] = bool(x), bool(r)
        scan_at(instance, time)
        seen.append((instance["pulse"], instance["up"], instance["u.CV"], instance["down"], instance["d.CV"]))
    off, on = False, True
    assert seen[:2] == [(off, off, 0, off, 2), (on, off, 1, off, 1)]
    assert seen[2:] == [(on, off, 1, off, 1), (on, on, 2, on, 0), (off, on, 2, on, 0), (on, on, 3, on, -1)]


@settings(deadline=None, max_examples=examples(50))
@given(s.lists(s.tuples(s.booleans(), s.integers(1, 60)), min_size=1, max_size=40))
def test_timers_follow_the_history_of_their_input(steps: list[tuple[bool, int]]) -> None:
    instance = TIMERS
    instance.restore(FRESH)
    instance.controller.now = 0
    now = rose = fell = None
    time, before = 0, False
    for value, pause in steps:
        time += pause
        now = time
        if value and not before:
            rose = now
        if before and not value:
            fell = now
        before = value
        instance["x"] = value
        scan_at(instance, time)
        assert instance["on.Q"] is (value and rose is not None and now - rose >= 50)
        assert instance["off.Q"] is (value or (fell is not None and now - fell < 50))


TIMERS = start(
    "PROGRAM Main\nVAR_INPUT x : BOOL; END_VAR\nVAR on : TON; off : TOF; END_VAR\n"
    "on(IN := x, PT := T#50ms); off(IN := x, PT := T#50ms);\nEND_PROGRAM"
)
FRESH = TIMERS.snapshot()


def test_counters() -> None:
    instance = start(
        "PROGRAM Main\nVAR_INPUT u, d, r, l : BOOL; END_VAR\nVAR a : CTU; b : CTD; c : CTUD; END_VAR\n"
        "a(CU := u, R := r, PV := 2); b(CD := d, LD := l, PV := 2); c(CU := u, CD := d, R := r, LD := l, PV := 2);\n"
        "END_PROGRAM"
    )

    def scan(**values: bool) -> tuple[int, int, int]:
        for name in "udrl":
            instance[name] = values.get(name, False)
        instance.scan()
        return instance["a.CV"], instance["b.CV"], instance["c.CV"]

    assert scan(u=True) == (1, 0, 1)
    assert scan(u=True) == (1, 0, 1)
    assert scan() == (1, 0, 1)
    assert scan(u=True, d=True) == (2, -1, 1)
    assert instance["a.Q"] is True
    assert instance["c.QU"] is False
    assert scan(l=True) == (2, 2, 2)
    assert instance["c.QU"] is True
    assert scan(d=True) == (2, 1, 1)
    assert scan(r=True, l=True, u=True) == (0, 2, 0)
    assert (instance["a.Q"], instance["b.Q"], instance["c.QD"]) == (False, False, True)


def test_counters_stop_at_the_end_of_their_type() -> None:
    instance = start(
        "PROGRAM Main\nVAR_INPUT u : BOOL; END_VAR\nVAR a : CTU_SINT; END_VAR\n"
        "a(CU := u, R := FALSE, PV := 5);\nEND_PROGRAM",
        Dialect.SCL,
    )
    for scan in range(300):
        instance["u"] = scan % 2 == 0
        instance.scan()
    assert instance["a.CV"] == 127
    assert instance["a.Q"] is True


@pytest.mark.parametrize("dialect", [Dialect.CODESYS, Dialect.SCL])
def test_blink_of_codesys(dialect: Dialect) -> None:
    """TRUE for TIMEHIGH first, then FALSE for TIMELOW; without ENABLE the output stays (CODESYS, Util, BLINK).

    Converted code is compared with it, so other dialects know it too.
    """
    call = "b(ENABLE := x, TIMELOW := T#20ms, TIMEHIGH := T#30ms);"
    instance = block("BLINK", call, "x : BOOL;", dialect)
    given = [0, 1, 1, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1]
    seen = []
    for number, x in enumerate(given):
        instance["x"] = bool(x)
        scan_at(instance, number * 10)
        seen.append(int(instance["b.OUT"]))
    assert seen == [0, 1, 1, 1, 0, 0, 1, 1, 1, 1, 1, 1, 0]


def test_a_block_of_the_project_is_no_block_of_a_library() -> None:
    own = "VAR_INPUT ENABLE : BOOL; END_VAR VAR_OUTPUT OUT : BOOL; END_VAR OUT := ENABLE;"
    own = f"FUNCTION_BLOCK BLINK {own} END_FUNCTION_BLOCK"
    text = f"PROGRAM Main VAR_INPUT x : BOOL; END_VAR VAR b : BLINK; END_VAR b(ENABLE := x); END_PROGRAM {own}"
    instance = start(text, Dialect.CODESYS)
    for x in (True, False):
        instance["x"] = x
        instance.scan()
        assert instance["b.OUT"] is x
