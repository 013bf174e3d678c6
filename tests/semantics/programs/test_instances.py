"""Instances: snapshots, free inputs, variables, errors with their place."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as s

from plcopen_sfc import loads, simulate
from plcopen_sfc.errors import ModelError, SimulationError
from plcopen_sfc.model import Expression, Project
from plcopen_sfc.semantics.programs import Controller, Direction, Instance
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime_types import Frame
from plcopen_sfc.semantics.programs.scopes import Scope
from tests.semantics.programs.running import MS, project_of, start
from tests.sweeps import examples

MIXED = """
TYPE P : STRUCT x : INT; t : TON; END_STRUCT; END_TYPE
PROGRAM Main
VAR_INPUT a, b : BOOL; END_VAR
VAR on : TON; off : TOF; p : P; ps : ARRAY[1..2] OF P; n : INT; edges : ARRAY[1..3] OF R_TRIG; END_VAR
VAR_TEMP tmp : INT; END_VAR
on(IN := a, PT := T#50ms); off(IN := b, PT := T#30ms); p.t(IN := a AND b, PT := T#20ms);
ps[1].t(IN := on.Q, PT := T#15ms); edges[2](CLK := a);
IF edges[2].Q THEN n := n + 1; p.x := n; END_IF
tmp := n; G := G + tmp;
END_PROGRAM
"""
SCANS = s.lists(s.tuples(s.booleans(), s.booleans(), s.integers(1, 40)), min_size=1, max_size=15)
OUTPUTS = ("on.Q", "on.ET", "off.Q", "off.ET", "p.t.Q", "ps[1].t.Q", "ps[1].t.ET", "n", "p.x", "G")


def drive(instance: Instance, scans: list[tuple[bool, bool, int]]) -> list[tuple[Any, ...]]:
    read = instance.reader(OUTPUTS)
    seen = []
    for a, b, pause in scans:
        instance["a"], instance["b"] = a, b
        instance.controller.now += pause * MS
        instance.scan()
        seen.append(read())
    return seen


@settings(deadline=None, max_examples=examples(40))
@given(SCANS, SCANS, s.integers(0, 10**6))
def test_a_snapshot_can_go_on_at_any_time(
    before: list[tuple[bool, bool, int]], after: list[tuple[bool, bool, int]], later: int
) -> None:
    one = start(MIXED)
    drive(one, before)
    stored = one.snapshot()
    hash(stored)
    expected = drive(one, after)
    one.controller.now += later
    one.restore(stored)
    assert one.snapshot() == stored
    assert drive(one, after) == expected


def test_equal_situations_at_different_times_have_equal_snapshots() -> None:
    one, other = start(MIXED), start(MIXED)
    other.controller.now = 12345
    script = [(True, False, 10), (True, True, 10)]
    drive(one, script)
    drive(other, script)
    assert one.snapshot() == other.snapshot()
    drive(other, [(True, True, 1)])
    assert one.snapshot() != other.snapshot()


def test_a_timer_that_has_run_out_does_not_grow_older() -> None:
    one = start(MIXED)
    drive(one, [(True, True, 1000)] * 5)
    before = one.snapshot()
    drive(one, [(True, True, 1000)])
    one["G"] = one["G"] - one["n"]
    assert one.snapshot() == before


def test_arrays_of_structures_and_of_blocks_are_in_snapshots() -> None:
    text = """TYPE Axis :
    STRUCT Place : INT; Delays : ARRAY[0..1] OF TON; Rows : ARRAY[1..2, 1..2] OF INT; END_STRUCT; END_TYPE
    PROGRAM Main
    VAR Start : BOOL; Axes : ARRAY[1..2] OF Axis; n : INT; END_VAR
    n := n + 1;
    Axes[1].Place := n; Axes[2].Rows[2, 1] := n;
    Axes[2].Delays[1](IN := Start, PT := T#30ms);
    END_PROGRAM"""
    one = start(text)
    one["Start"] = True
    one.scan()
    stored = one.snapshot()
    names = ["n", "Axes[1].Place", "Axes[2].Rows[2, 1]", "Axes[2].Delays[1].ET", "Axes[2].Delays[1].Q"]

    def seen() -> list[Any]:
        found = []
        for _ in range(4):
            one.controller.now += 10 * MS
            one.scan()
            found.append([one[name] for name in names])
        return found

    expected = seen()
    assert [row[-1] for row in expected] == [False, False, True, True]
    assert one.snapshot() != stored
    one.controller.now += 5000 * MS
    one.restore(stored)
    assert one.snapshot() == stored
    assert seen() == expected


class Recorder:
    """Gives inputs their values and remembers what was asked for."""

    def __init__(self, **values: Any) -> None:
        self.values = values
        self.asked: list[str] = []

    def __call__(self, path: str) -> Any:
        self.asked.append(path)
        return self.values[path]


def test_free_inputs_are_asked_for_when_they_are_needed() -> None:
    recorder = Recorder(a=False, b=True, Start=True)
    text = """PROGRAM Main
    VAR_INPUT a, b, c : BOOL; END_VAR VAR x, y : BOOL; END_VAR
    c := FALSE; x := a AND b; y := (Start OR b) AND NOT a AND NOT c; Out := y;
    END_PROGRAM"""
    instance = start(text, read_input=recorder)
    instance.scan()
    assert recorder.asked == ["a", "Start"]
    recorder.values["a"], recorder.asked = True, []
    instance.scan()
    assert recorder.asked == ["a", "b", "Start"]
    assert (instance["x"], instance["y"], instance["Out"]) == (True, False, False)
    assert instance["a"] is True


def test_free_inputs_are_not_in_snapshots() -> None:
    recorder = Recorder(a=False, Level=3)
    text = "PROGRAM Main\nVAR_INPUT a : BOOL; END_VAR VAR x : BOOL; END_VAR\nx := x OR (a AND Level > 5);\nEND_PROGRAM"
    instance = start(text, read_input=recorder)
    instance.scan()
    before = instance.snapshot()
    recorder.values.update(a=True, Level=4)
    instance.scan()
    assert instance.snapshot() == before
    recorder.values.update(Level=6)
    instance.scan()
    assert instance.snapshot() != before
    instance.restore(before)
    assert instance["x"] is False


def test_what_something_writes_is_no_free_input() -> None:
    recorder = Recorder(e=True)
    more = "FUNCTION_BLOCK Writer\nVAR_EXTERNAL d : BOOL; END_VAR\nd := TRUE;\nEND_FUNCTION_BLOCK\n"
    text = "PROGRAM Main\nVAR w : Writer; x : BOOL; END_VAR\nx := d AND e; w();\nEND_PROGRAM"
    instance = start(more + text, read_input=recorder)
    instance.scan()
    assert recorder.asked == []
    instance.scan()
    assert recorder.asked == ["e"]


class AnyNumber:
    """Stands for any number."""

    def __gt__(self, other: object) -> bool:
        return other == 5


def test_free_inputs_may_be_anything_that_can_be_compared() -> None:
    text = "PROGRAM Main\nVAR_INPUT n : INT; END_VAR VAR x, y : BOOL; END_VAR\nx := n > 5; y := n > 6;\nEND_PROGRAM"
    instance = start(text, read_input=lambda _: AnyNumber())
    instance.scan()
    assert (instance["x"], instance["y"]) == (True, False)


def test_variables_are_listed() -> None:
    instance = start(MIXED)
    found = {path: (v.type.name, v.direction) for path, v in instance.variables().items()}
    assert found["a"] == ("BOOL", Direction.INPUT)
    assert found["on.ET"] == ("TIME", Direction.LOCAL)
    assert found["G"] == ("INT", Direction.EXTERNAL)
    assert "tmp" in found
    assert not any("START" in path or "(" in path for path in found)


@pytest.mark.parametrize(
    ("body", "message", "line"),
    [
        ("x := 1;\nx := x / y;", "division by zero", 2),
        ("x := x MOD y;", "division by zero", 1),
        ("\n\nr := 1.0 / r;", "division by zero", 1),
        ("r := SQRT(r - 1.0);", "no real number", 1),
        ("x := 5;\nIF x = 5 THEN\n  x := a[x];\nEND_IF", "outside of 1..3", 3),
        ("x := ;", "found ';'", 1),
        ("x := 'a';", "STRING cannot become INT|STRING is assigned", 1),
        ("x := LEFT(x, 1);", "LEFT of INT", 1),
        ("x := MUX(x + 5, 1, 2);", "MUX has no input 5", 1),
        ("x.y := 1;", "has no y", 1),
        ("TON(IN := TRUE);", "TON is a function block", 1),
        ("x := t;", "TON is assigned to INT|TON cannot", 1),
        ("t(IM := TRUE);", "TON has no parameter IM", 1),
    ],
)
def test_errors_tell_the_scan_the_pou_and_the_line(body: str, message: str, line: int) -> None:
    variables = "x, y : INT; r : REAL; a : ARRAY[1..3] OF INT; t : TON;"
    text = f"PROGRAM Main\nVAR {variables} END_VAR\nQ := TRUE;\n{body}\nEND_PROGRAM"
    instance = Controller(project_of(text)).instance("Main")
    with pytest.raises(SimulationError, match=message) as caught:
        instance.scan()
    error = caught.value
    assert (error.scan, error.pou) == (1, "Main")
    first = text.split("END_VAR\n")[1].splitlines()
    assert error.location.line is not None
    assert first[error.location.line - 1].strip()


def test_the_line_of_an_error_in_a_called_block_is_its_own() -> None:
    text = """FUNCTION_BLOCK B
VAR_INPUT d : INT; END_VAR VAR x : INT; END_VAR
x := 1;
x := x / d;
END_FUNCTION_BLOCK
PROGRAM Main
VAR b : B; END_VAR
b(d := 0);
END_PROGRAM"""
    with pytest.raises(SimulationError, match=r"scan 1: line 2 \(B\): division by zero"):
        start(text).scan()


class Lamp:
    """A chart compiler that declares a step and switches it."""

    def __init__(self, chart: Any, scope: Scope, path: str) -> None:
        step = scope.structure("step", {"X": t.BOOL, "T": t.ELAPSED, "since": t.INSTANT})
        self.slot = scope.declare("Step1", step)
        self.scope = scope

    def translate(self) -> None:
        self.condition = Routines(self.scope).condition(_expression("Start AND NOT Step1.X"), "Main.T1")
        self.write = Routines(self.scope).setter("Lamp")
        self.time = Routines(self.scope).expression("T#5s", "Main", t.LTIME)
        self.late = Routines(self.scope).condition(_expression("Step1.T > T#20ms"), "Main.T2")

    def initialise(self, frame: Frame) -> None:
        frame.v[self.slot].v[2] = self.scope.clock.now

    def execute(self, frame: Frame) -> None:
        step = frame.v[self.slot].v
        step[1] = self.scope.clock.now - step[2]
        if self.condition(frame):
            step[0] = True
        self.write(frame, step[0] and self.late(frame))
        assert self.time(frame) == 5_000 * MS


def _expression(text: str) -> Any:
    return Expression(text=text)


def chart_project() -> Project:
    return project_of("PROGRAM Main\nVAR x : BOOL; END_VAR\nINITIAL_STEP S: END_STEP\nEND_PROGRAM")


def test_charts_are_compiled_by_whom_is_given() -> None:
    controller = Controller(chart_project(), chart_compiler=Lamp)
    controller.now = 100 * MS
    instance = controller.instance("Main")
    assert not controller.problems
    instance["Start"] = True
    instance.scan()
    assert (instance["Step1.X"], instance["Lamp"], instance["Step1.t"]) == (True, False, 0)
    controller.now += 21 * MS
    instance.scan()
    assert (instance["Lamp"], instance["Step1.T"]) == (True, 21 * MS)
    before = instance.snapshot()
    controller.now += 1000 * MS
    assert instance.snapshot() != before
    instance.restore(before)
    instance.scan()
    assert instance["Step1.T"] == 21 * MS
    assert [path for path, _, _ in instance.charts()] == [""]


def test_a_path_with_an_index_follows_the_index() -> None:
    instance = start(
        "PROGRAM Main VAR ar : ARRAY[0..2] OF INT := [10, 20, 30]; i : INT; seen : INT; END_VAR"
        " seen := ar[i]; i := i + 1; END_PROGRAM"
    )
    read = instance.reader(["ar[i]", "seen"])
    assert (instance["ar[i]"], read()) == (10, (10, 0))
    instance.scan()
    assert (instance["ar[i]"], read()) == (20, (20, 10))
    instance["ar[i]"] = 25
    assert [instance[f"ar[{place}]"] for place in range(3)] == [10, 25, 30]
    instance["i"] = 7
    assert "ar[i]" not in instance
    assert instance.type_of("ar[i]") is instance.type_of("ar[0]")
    with pytest.raises(ModelError, match="another variable whenever"):
        instance.cell("ar[i]")


BLOCK = "FUNCTION_BLOCK T{0} VAR a, b : T{1}; END_VAR a(); b(); END_FUNCTION_BLOCK\n"
STRUCTURE = "TYPE T{0} : STRUCT a, b : T{1}; END_STRUCT; END_TYPE\n"


@pytest.mark.parametrize("is_global", [False, True])
@pytest.mark.parametrize(
    ("first", "each"),
    [
        ("FUNCTION_BLOCK T0 VAR n : INT; END_VAR END_FUNCTION_BLOCK\n", BLOCK),
        ("TYPE T0 : STRUCT n : INT; END_STRUCT; END_TYPE\n", STRUCTURE),
    ],
    ids=["blocks", "structures"],
)
def test_instances_that_double_are_counted_and_not_made(first: str, each: str, is_global: bool) -> None:
    types = first + "".join(each.format(number, number - 1) for number in range(1, 41))
    outer = "VAR_GLOBAL x : T40; END_VAR\n" if is_global else ""
    inner = "VAR_EXTERNAL x : T40; END_VAR" if is_global else "VAR x : T40; END_VAR"
    text = f"{types}{outer}PROGRAM Main {inner} VAR n : INT; END_VAR n := x{'.a' * 40}.n; END_PROGRAM"
    with pytest.raises(SimulationError, match="more than 1000000 elements"):
        simulate(loads(text.encode(), format="iec-text"), pou="Main", scans=2)
