"""Texts for matiec: what they look like, that its compiler takes them, and that they do what the chart does."""

from __future__ import annotations

import random
import re
from dataclasses import replace
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.model.project import FileHeader
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.profile import PROFILES
from plcopen_sfc.semantics.programs import Controller
from plcopen_sfc.semantics.simulation import Simulation
from plcopen_sfc.semantics.subjects import resolve
from tests.judges.comparing import Compiled, differences
from tests.judges.matiec import MatiecError, require_matiec
from tests.samples import FIXTURES, accepting
from tests.sweeps import WHOLE

_IEC = replace(PROFILES["iec"], final_scan=False)
"""IEC 61131-3 leaves the last execution of an action to the tool; matiec has none."""

_HEAD = """PROGRAM Plant
VAR a : BOOL; b : BOOL; c : BOOL; END_VAR
VAR p : BOOL; q : BOOL; r : BOOL; n : INT; m : INT; t1 : TON; u : Pair; END_VAR
{body}
END_PROGRAM
TYPE Pair : STRUCT x : BOOL; y : BOOL; END_STRUCT; END_TYPE
"""

FILES = sorted(path for path in FIXTURES.rglob("*") if path.suffix in (".xml", ".st", ".scl", ".json"))
FILES = [path for path in FILES if "broken" not in path.parts]
SAMPLE = (
    "device_export.xml",
    "distribution_belt.st",
    "classic_flip-flops_codesys.xml",
    "plcopen_1.01.xml",
    "Station.xml",
)
CHARTS = {
    "selection": """
INITIAL_STEP S1: END_STEP
STEP S2: q(N); END_STEP
STEP S3: r(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S1 TO S3 := b; END_TRANSITION
TRANSITION FROM S2 TO S1 := c; END_TRANSITION
TRANSITION FROM S3 TO S1 := c AND NOT a; END_TRANSITION
""",
    "one variable of several steps": """
INITIAL_STEP S1: q(N); END_STEP
STEP S2: q(N); r(P); END_STEP
STEP S3: r(P); q(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S3 := b; END_TRANSITION
TRANSITION FROM S3 TO S2 := a AND c; END_TRANSITION
TRANSITION FROM S3 TO S1 := a; END_TRANSITION
""",
    "one action of several steps": """
INITIAL_STEP S1: END_STEP
STEP S2: Count(N); END_STEP
STEP S3: Count(P); END_STEP
STEP S4: Count(L, T#30ms); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S3 := b; END_TRANSITION
TRANSITION FROM S3 TO S4 := a AND c; END_TRANSITION
TRANSITION FROM S4 TO S2 := b; END_TRANSITION
ACTION Count: n := n + 1; END_ACTION
""",
    "stored and parallel": """
INITIAL_STEP S1: r(R); END_STEP
STEP S2: q(S); END_STEP
STEP S3: r(S); m := m; END_STEP
STEP S4: q(R); END_STEP
TRANSITION FROM S1 TO (S2, S3) := a; END_TRANSITION
TRANSITION FROM S2 TO S4 := b; END_TRANSITION
TRANSITION FROM (S4, S3) TO S1 := c; END_TRANSITION
""".replace(" m := m;", ""),
    "named transitions and an end": """
INITIAL_STEP S1: q(N); END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := Ready; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
TRANSITION FROM S2 := c; END_TRANSITION
TRANSITION Ready := a AND NOT b; END_TRANSITION
""",
    "pulses of the initial step": """
INITIAL_STEP S1: Count(P1); q(P); Leave(P0); END_STEP
STEP S2: r(P); Leave(P0); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
ACTION Count: n := n + 1; END_ACTION
ACTION Leave: m := m + 1; END_ACTION
""",
    "times": """
INITIAL_STEP S1: q(D, T#30ms); END_STEP
STEP S2: r(L, T#20ms); END_STEP
TRANSITION FROM S1 TO S2 := S1.T >= T#20ms AND a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
""",
    "members, comments and empty statements": """
INITIAL_STEP S1: u.x(N); END_STEP
STEP S2: u.x(N); u.y(S); Work(N); END_STEP
STEP S3: u.y(R); Look(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S3 := b; // until here
END_TRANSITION
TRANSITION FROM S3 TO S1 := TRUE; END_TRANSITION
ACTION Work:
    // a comment (* in it *)
    IF a THEN ; ELSE n := n + 1; END_IF
    p := u.x;
    r := u.y;
    CASE n OF 3: ; 4: n := 7; END_CASE
    ;
END_ACTION
ACTION Look: p := u.x; r := u.y; END_ACTION
""",
}


def _converted(text: str) -> tuple[sfc.Project, str, sfc.ConversionReport]:
    project = sfc.loads(_HEAD.format(body=text).encode(), format="iec-text")
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    return project, data.decode(), report


@pytest.mark.slow
@pytest.mark.parametrize("name", CHARTS)
def test_a_compiled_chart_does_what_the_simulated_one_does(name: str, tmp_path: Path) -> None:
    project, text, report = _converted(CHARTS[name])
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    machine = require_matiec().build(text, tmp_path, program="Plant")
    chart = project.pou("Plant").sfc
    watch = ["p", "q", "r", "n", "m", *(f"{step.name}.X" for step in chart.steps)]
    rng = random.Random(7)  # noqa: S311
    scans = [{name: rng.random() < 0.4 for name in ("a", "b", "c")} for _ in range(300)]
    found = machine.run(scans, watch, period=10_000_000)
    run = Simulation(resolve(project, "Plant", project=None), profile=_IEC, scan_time="10ms")
    for number, (values, row) in enumerate(zip(scans, found, strict=True)):
        for variable, value in values.items():
            run.set(variable, value)
        run.scan()
        assert {path: run.instance[path] for path in watch} == row, f"scan {number}"
    assert {row[f"{step.name}.X"] for row in found for step in chart.steps} == {True, False}


def _text_for(project: sfc.Project) -> tuple[str, sfc.ConversionReport]:
    data, report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)
    return data.decode(), report


def test_variables_and_steps_get_names_of_their_own(tmp_path: Path) -> None:
    text = """FUNCTION_BLOCK Motor
VAR_INPUT on : BOOL; END_VAR
VAR_OUTPUT runs : BOOL; END_VAR
runs := on;
END_FUNCTION_BLOCK
PROGRAM Plant
VAR Motor : Motor; LEN : INT; go : BOOL; t1 : TON; END_VAR
INITIAL_STEP T: END_STEP
STEP Q: END_STEP
TRANSITION FROM T TO Q := go AND Motor.runs; END_TRANSITION
TRANSITION FROM Q TO T := LEN > 3 OR t1.Q OR Q.T > T#1s; END_TRANSITION
END_PROGRAM
"""
    text, report = _text_for(sfc.loads(text.encode(), format="iec-text"))
    assert not report.losses
    assert "Motor_1 : Motor;" in text
    assert "LEN_1 > 3 OR t1.Q OR Q_1.T > T#1s" in text
    renamed = {item.path for item in report.with_outcome(Outcome.TRANSLATED) if item.what == "name"}
    assert {"Plant.Motor", "Plant.LEN", "Plant.T", "Plant.Q"} <= renamed
    require_matiec().build(text, tmp_path)


@pytest.mark.parametrize("variable", ["Fill", "fill"])
def test_a_step_with_the_name_of_a_variable_gets_another(variable: str, tmp_path: Path) -> None:
    text = f"""PROGRAM Plant
VAR go, {variable} : BOOL; END_VAR
INITIAL_STEP Idle: END_STEP
STEP Fill: Count(N); END_STEP
TRANSITION FROM Idle TO Fill := go AND {variable}; END_TRANSITION
TRANSITION FROM Fill TO Idle := Fill.T > T#1s; END_TRANSITION
ACTION Count: {variable} := NOT {variable}; END_ACTION
END_PROGRAM
"""
    text, report = _text_for(sfc.loads(text.encode(), format="iec-text"))
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    assert f":= go AND {variable};" in text
    assert "Fill_1.T > T#1s" in text
    assert f"{variable} := NOT {variable};" in text
    require_matiec().build(text, tmp_path)


def test_what_nothing_declares_is_in_the_report() -> None:
    project = sfc.loads(_HEAD.format(body=CHARTS["selection"].replace("c AND", "cc AND")).encode(), format="iec-text")
    project.pou("Plant").interface.sections[0].variables.append(m.Variable(name="lamp", type=m.DerivedType(name="Led")))
    _, report = _text_for(project)
    found = [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)]
    assert found == ["nothing in the project declares `Led`", "nothing in the project declares `cc`"]


def test_main_actions_are_not_executed_once_more_and_initial_steps_act_first(tmp_path: Path) -> None:
    project = sfc.loads(_HEAD.format(body=CHARTS["selection"]).encode(), format="iec-text")
    chart = project.pou("Plant").sfc
    first, second, _ = chart.steps
    first.main_action = m.StBody(text="n := n + 1;")
    second.main_action = m.StBody(text="m := m + 1;")
    seen = sfc.loads(sfc.dumps(project, format="codesys"), format="codesys", as_tool=True)
    text, _ = _text_for(seen)
    machine = require_matiec().build(text, tmp_path, program="Plant")
    rows = machine.run([{"a": True}, {}, {}, {"c": True}, {}], ["n", "m"], period=10_000_000)
    assert [tuple(row.values()) for row in rows] == [(1, 0), (1, 1), (1, 2), (2, 2), (2, 3)]


_COUNT = m.StBody(text="n := n + 1; m := m * 3 + 1;")
_STEP_ACTIONS = {
    "entry and exit": {"S2": ("Count", None, "Count")},
    "exit, then entry of the next": {"S2": (None, None, "Count"), "S3": ("Count", None, None)},
    "entry of two in a row": {"S2": ("Count", None, None), "S3": ("Count", None, None)},
    "entry and main": {"S2": ("Count", "Count", None), "S3": (None, "Other", None)},
    "main of two, and of an association": {"S2": (None, "Count", None), "S3": ("Other", "Count", None), "S4": ()},
    "all of the initial step": {"S1": ("Count", "Other", "Count"), "S2": (_COUNT, None, "Other")},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", _STEP_ACTIONS)
def test_step_actions_that_share_an_action_are_executed_as_often_as_in_codesys(name: str, tmp_path: Path) -> None:
    require_matiec()
    chart = CHARTS["one action of several steps"] + "ACTION Other: m := m * 3 + 2; END_ACTION\n"
    if "association" not in name:
        chart = re.sub(r"Count\(.*\);", "", chart)
    text = _HEAD.format(body=chart).replace("VAR a", "VAR_INPUT a")
    project = sfc.loads(text.encode(), format="iec-text")
    for step in project.pou("Plant").sfc.steps:
        actions = _STEP_ACTIONS[name].get(step.name, ())
        for field, action in zip(("entry_action", "main_action", "exit_action"), actions, strict=False):
            setattr(step, field, action)
        if step.initial and step.main_action is None:
            step.main_action = m.StBody(text="r := TRUE;")
    source = sfc.loads(sfc.dumps(project, format="codesys", partial=True), format="codesys", as_tool=True)
    data, report = sfc.convert(source, "iec-text", flavour="matiec")
    assert {item.what for item in report.losses} == {"start of the chart"}  # which no run has looked at
    assert not list(differences(source, source.pou("Plant"), Compiled.of(data, report), report, tmp_path))


@pytest.mark.slow
def test_maximum_times_are_statements_where_something_watches_them() -> None:
    project = sfc.loads(_HEAD.format(body=CHARTS["selection"]).encode(), format="iec-text")
    project.pou("Plant").sfc.steps[1].max_time = "T#2s"
    source = sfc.loads(sfc.dumps(project, format="codesys", partial=True), format="codesys", as_tool=True)
    for each in (project, source):
        assert not _text_for(each)[1].with_outcome(Outcome.NOT_EXECUTED)
    variables = source.pou("Plant").interface.sections[0].variables
    variables.append(m.Variable(name="SFCError", type=m.ElementaryType(name=m.Elementary.BOOL)))
    for target, flavour in (("iec-text", "matiec"), ("plcopen", "")):
        report = sfc.convert(source, target, flavour=flavour)[1]
        found = [item.path for item in report.with_outcome(Outcome.TRANSLATED) if item.what == "max time"]
        assert found == ["POU Plant / step S2"], target
    in_tia = sfc.convert(source, "simaticml", strict=True, limit=5).report  # a ladder sets the variable there
    assert in_tia.compared["POU Plant"].startswith("equal")


def test_a_loop_at_a_step_of_codesys_whose_time_is_read_is_approximated() -> None:
    project = sfc.loads(_HEAD.format(body=CHARTS["times"]).encode(), format="iec-text")
    chart = project.pou("Plant").sfc
    for step in chart.steps:
        chart.add_transition(step, step, "c")
    source = sfc.loads(sfc.dumps(project, format="codesys", partial=True), format="codesys", as_tool=True)
    found = [item.path for item in _text_for(source)[1].losses if item.what == "transition"]
    assert found == ["POU Plant / transition S1 -> S1"]


def test_a_block_that_feeds_two_conditions_is_called_once() -> None:
    project = sfc.loads(_HEAD.format(body=CHARTS["pulses of the initial step"]).encode(), format="iec-text")
    chart = project.pou("Plant").sfc
    source = m.InputVariable(id=50, expression="a", output=m.OutputPin())
    pins = m.BlockParameters(
        inputs=[m.BlockVariable(name="IN", input=m.InputPin(connections=[m.Connection(source=50)]))],
        outputs=[m.BlockVariable(name="Q", output=m.OutputPin())],
    )
    chart.logic = [source, m.Block(id=51, type_name="TON", instance="t1", parameters=pins)]
    for transition in chart.transitions:
        wire = m.Connection(source=51, pin="Q")
        transition.condition = m.WiredCondition(input=m.InputPin(connections=[wire]))
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    assert data.decode().count("t1(IN := a") == 1
    assert [item.what for item in report.with_outcome(Outcome.APPROXIMATED)].count("condition") == 2


@pytest.mark.slow
@pytest.mark.parametrize("path", [p for p in FILES if WHOLE or p.name in SAMPLE], ids=lambda path: path.name)
def test_fixtures_compile_but_where_they_cannot(path: Path, tmp_path: Path) -> None:
    """The report on a text that is refused tells what is in it for nothing, or is declared nowhere."""
    matiec = require_matiec()
    data, report = sfc.convert(accepting(sfc.load(path)), "iec-text", flavour="matiec", partial=True)
    text = data.decode()
    assert "{" not in text
    assert "//" not in text
    lost = report.with_outcome(Outcome.NOT_EXECUTED)
    assert ("NOT_EXECUTED" in text) <= bool(lost)
    if "NOT_EXECUTED" in text or "undeclared name" in {item.what for item in lost}:
        with pytest.raises(MatiecError):
            matiec.translate(text, tmp_path)
    else:
        matiec.translate(text, tmp_path)


LOOPS = {
    "one turn": "FOR i := 3 TO 3 DO k := k + 10 * i; END_FOR; k := k + i;",
    "no turn": "FOR i := 3 TO 2 DO k := k + 10 * i; END_FOR; k := k + i;",
    "the end is a variable": "FOR i := 1 TO n DO k := k + 10 * i; END_FOR; k := k + i;",
    "down by two": "FOR i := 5 TO 0 BY -2 DO k := k + 10 * i; END_FOR; k := k + i;",
    "a step beyond the end": "FOR i := n TO 4 BY 9 DO k := k + 10 * i; END_FOR; k := k + i;",
    "left early": "FOR i := 1 TO n DO k := k + 1; IF i = 2 THEN EXIT; END_IF; END_FOR; k := k + 100 * i;",
    "nested": "FOR i := 1 TO n DO FOR j := i TO n DO k := k + i * j; END_FOR; END_FOR; k := k + 100 * i + 1000 * j;",
    "literals": "FOR i := 0 TO 4 DO k := k + i; END_FOR;",
}


@pytest.mark.slow
@pytest.mark.parametrize("loop", LOOPS.values(), ids=LOOPS)
@pytest.mark.parametrize("n", [0, 1, 3])
def test_loops_do_the_same_in_matiec(loop: str, n: int, tmp_path: Path) -> None:
    text = f"PROGRAM Plant VAR_INPUT n : INT; END_VAR VAR i, j, k : INT; s : SINT; END_VAR {loop} END_PROGRAM"
    project = sfc.loads(text.encode(), format="iec-text")
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    assert report.losses == []
    instance = Controller(project, "iec").instance("Plant")
    instance["n"] = n
    instance.scan()
    machine = require_matiec().build(data.decode(), tmp_path, program="Plant")
    assert machine.run([{"n": n}], ["k"])[0]["k"] == instance["k"]


@pytest.mark.parametrize(
    "loop", ["FOR i := 1 TO n DO n := n - 1; END_FOR;", "FOR i := 1 TO n BY n DO k := 1; END_FOR;"]
)
def test_a_loop_that_matiec_may_leave_out_is_reported(loop: str) -> None:
    text = f"PROGRAM Plant VAR i, k, n : INT; END_VAR {loop}; END_PROGRAM"
    _, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "iec-text", flavour="matiec", partial=True)
    assert [item.what for item in report.losses] == ["loop"]


def _of_beremiz(loop: str) -> sfc.Project:
    """A file of Beremiz with a loop, as its editor leaves it: without a name of the product."""
    text = f"PROGRAM Plant VAR_INPUT n : INT; END_VAR VAR i, j, k : INT; END_VAR {loop} END_PROGRAM"
    project = sfc.loads(text.encode(), format="iec-text")
    project.header = FileHeader(company="Unknown", product="Unnamed", version="1")
    return sfc.loads(sfc.dumps(project, format="plcopen", fresh=True), format="plcopen")


JUDGED_LOOPS = {
    **LOOPS,
    "its end moves": "FOR i := 1 TO n DO k := k + 1; n := n - 1; END_FOR; k := k + 100 * i;",
    "its step is a variable": "FOR i := 0 TO 9 BY n + 1 DO k := k + 1; END_FOR; k := k + 100 * i;",
    "up to the greatest value": "FOR i := 32765 TO 32767 DO k := k + 1; END_FOR; k := k + i;",
}


@pytest.mark.parametrize("loop", JUDGED_LOOPS.values(), ids=JUDGED_LOOPS)
@pytest.mark.parametrize("n", [0, 1, 3])
def test_loops_of_beremiz_do_what_matiec_makes_of_them(loop: str, n: int, tmp_path: Path) -> None:
    project = _of_beremiz(loop)
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    assert report.losses == []
    instance = Controller(project).instance("Plant")
    instance["n"] = n
    instance.scan()
    text = f"PROGRAM Plant VAR n : INT; END_VAR VAR i, j, k : INT; END_VAR {loop} END_PROGRAM"
    for number, compiled in enumerate((text, data.decode())):
        machine = require_matiec().build(compiled, tmp_path / str(number), program="Plant")
        assert machine.run([{"n": n}], ["k"])[0]["k"] == instance["k"]


TIMES = """k := TIME_TO_INT(t); x := TIME_TO_REAL(t + T#250ms); w := TIME_TO_WORD(t);
    IF DINT_TO_TIME(TIME_TO_DINT(t) + 1) > t THEN u := u + 1; END_IF; IF REAL_TO_TIME(x) > t THEN u := u + 2; END_IF;
    IF WORD_TO_TIME(w) = t THEN u := u + 4; END_IF; IF INT_TO_TIME(k) = t THEN u := u + 8; END_IF;"""
_CALCULATED = ("k", "x", "w", "u")


def _with_times(statements: str) -> sfc.Project:
    text = f"PROGRAM Plant VAR t : TIME := T#2s250ms; k, u : INT; x : REAL; w : WORD; END_VAR {statements} END_PROGRAM"
    return sfc.loads(text.encode(), format="iec-text")


def _calculated(project: sfc.Project, profile: str) -> list[object]:
    instance = Controller(project, profile).instance("Plant")
    instance.scan()
    return [instance[name] for name in _CALCULATED]


def test_times_become_numbers_in_milliseconds_in_matiec(tmp_path: Path) -> None:
    project = _with_times(TIMES)
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    assert report.losses == []
    expected = [2250, 2500.0, 2250, 15]
    assert _calculated(project, "iec") == expected
    assert _calculated(sfc.loads(data, format="iec-text"), "matiec") == expected
    machine = require_matiec().build(data.decode(), tmp_path, program="Plant")
    assert list(machine.run([{}], _CALCULATED)[0].values()) == expected


def test_times_of_beremiz_become_numbers_in_seconds_as_in_matiec(tmp_path: Path) -> None:
    project = _with_times(TIMES)
    machine = require_matiec().build(sfc.dumps(project, format="iec-text").decode(), tmp_path, program="Plant")
    assert list(machine.run([{}], _CALCULATED)[0].values()) == _calculated(project, "matiec") == [2, 2.5, 2, 3]


@pytest.mark.parametrize(("target", "profile"), [("codesys", "codesys"), ("scl", "s7graph"), ("plcopen", "beremiz")])
def test_times_of_beremiz_count_seconds_in_other_tools(target: str, profile: str) -> None:
    project = _with_times(TIMES)
    project.header = FileHeader(company="Unknown", product="Unnamed", version="1")
    project = sfc.loads(sfc.dumps(project, format="plcopen", fresh=True), format="plcopen", as_tool=True)
    data, report = sfc.convert(project, target)
    assert [item.outcome for item in report.items if item.what == "time"] == [Outcome.TRANSLATED] * (
        target != "plcopen"
    )
    assert _calculated(sfc.loads(data, format=target), profile) == [2, 2.5, 2, 3]
    _, report = sfc.convert(project, "iec-text", partial=True)
    assert {item.outcome for item in report.items if item.what == "time"} == {Outcome.NOT_EXECUTED}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        ("FIND('hello', 'lo') = 4", False),
        ("FIND('hello', 'he') = 1", True),
        ("REPLACE('hello', 'YYYY', 1, 2) = 'hYYYYllo'", False),
        ("WORD_TO_STRING(w) = '16#8001'", True),
        ("LREAL_TO_STRING(1.0E10) = '1e+10'", True),
        ("REAL_TO_STRING(REAL#2.5) = '2.5'", True),
        ("TIME_TO_STRING(T#61s500ms) = 'T#0d0h1m1s500ms'", True),
        ("TIME_TO_STRING(T#1h) = 'T#0d1h'", True),
        ("STRING_TO_INT('12abc') = 12", True),
        ("STRING_TO_INT('-16#1') = 1", False),
        ("STRING_TO_REAL('2.5x') = 2.5", True),
    ],
)
def test_texts_and_numbers_of_matiec_are_those_of_its_library(condition: str, expected: bool, tmp_path: Path) -> None:
    text = (
        f"PROGRAM Plant VAR w : WORD := 16#8001; q : BOOL; END_VAR IF {condition} THEN q := TRUE; END_IF; END_PROGRAM"
    )
    project = sfc.loads(text.encode(), format="iec-text")
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    assert {(item.outcome, item.what) for item in report.losses} == {(Outcome.APPROXIMATED, "function")}
    instance = Controller(project, "matiec").instance("Plant")
    instance.scan()
    assert instance["q"] is expected
    assert require_matiec().build(data.decode(), tmp_path, program="Plant").run([{}], ["q"])[0]["q"] is expected


def test_bits_that_are_read_are_conjunctions_in_matiec(tmp_path: Path) -> None:
    text = """PROGRAM Plant VAR w : WORD := 16#8008; i : INT := -2; b : BYTE; k : INT; END_VAR
        IF w.3 AND NOT w.4 AND w.15 THEN k := 1; END_IF; IF i.15 AND NOT i.0 THEN k := k + 2; END_IF;
        IF b.7 OR b.%X0 THEN k := 0; END_IF; END_PROGRAM"""
    project = sfc.loads(text.encode(), format="iec-text")
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    assert report.losses == []
    instance = Controller(project, "iec").instance("Plant")
    instance.scan()
    assert instance["k"] == 3
    assert require_matiec().build(data.decode(), tmp_path, program="Plant").run([{}], ["k"])[0]["k"] == 3


def test_bits_that_are_written_are_not_executed_in_matiec() -> None:
    text = "PROGRAM Plant VAR w : WORD; q : BOOL; END_VAR w.3 := q; q := w.3; END_PROGRAM"
    _, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "iec-text", flavour="matiec", partial=True)
    assert {(item.outcome, item.what) for item in report.losses} == {(Outcome.NOT_EXECUTED, "bit access")}


def test_strings_have_the_length_of_matiec(tmp_path: Path) -> None:
    text = "PROGRAM Plant VAR s : STRING; n : INT; END_VAR s := CONCAT(s, '1234567890'); n := LEN(s); END_PROGRAM"
    project = sfc.loads(text.encode(), format="iec-text")
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    assert [item.what for item in report.losses] == ["string"]
    instance = Controller(project, "matiec").instance("Plant")
    for _ in range(20):
        instance.scan()
    assert instance["n"] == 126
    assert require_matiec().build(data.decode(), tmp_path, program="Plant").run([{}] * 20, ["n"])[-1]["n"] == 126


def test_durations_and_times_of_day_that_matiec_calculates_otherwise_are_told() -> None:
    statements = "d := d + T#13h; t := t * k; t := t + t;"
    text = f"PROGRAM Plant VAR d : TOD; t : TIME; k : INT; END_VAR {statements} END_PROGRAM"
    _, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "iec-text", flavour="matiec")
    assert [item.what for item in report.losses] == ["operation"] * 2


def test_boxes_and_instructions_with_times_are_not_executed_in_matiec() -> None:
    project = _with_times("")
    project.pous[0].bodies = [m.IlBody(text="LD t\nTIME_TO_INT\nST k\n")]
    _, report = sfc.convert(project, "plcopen", flavour="beremiz", partial=True)
    assert [item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)] == ["time"]


@pytest.mark.parametrize("left_at_once", [False, True])
def test_a_box_of_beremiz_is_computed_where_its_converter_computes_it(left_at_once: bool, tmp_path: Path) -> None:
    """The first step starts all boxes: where that is left in the first scan, no box gives anything."""
    text = """PROGRAM Plant VAR a, b, q : BOOL; END_VAR
        INITIAL_STEP S1: END_STEP
        STEP S2: q(N); END_STEP
        TRANSITION FROM S1 TO S2 := a; END_TRANSITION
        TRANSITION FROM S2 TO S1 := Stop; END_TRANSITION
        END_PROGRAM"""
    project = sfc.loads(text.encode(), format="iec-text")
    chart = project.pous[0].chart
    assert chart is not None
    given = m.InputVariable(id=91, expression="b", output=m.OutputPin())
    wires = [m.InputPin(connections=[m.Connection(source=node, pin=pin)]) for node, pin in ((91, None), (92, "OUT"))]
    parameters = m.BlockParameters(
        inputs=[m.BlockVariable(name="IN", input=wires[0])],
        outputs=[m.BlockVariable(name="OUT", output=m.OutputPin())],
    )
    box = m.Block(id=92, type_name="NOT", parameters=parameters)
    stop = m.OutputVariable(id=93, expression="Stop", input=wires[1])
    network = m.LogicNetwork(nodes=[given, box, stop])
    project.pous[0].transitions.append(m.NamedTransition(name="Stop", body=m.FbdBody(networks=[network])))
    chart.transitions[1].condition = m.NamedCondition(name="Stop")
    project.header = FileHeader(company="Unknown", product="Unnamed", version="1")
    project = sfc.loads(sfc.dumps(project, format="plcopen", fresh=True), format="plcopen", as_tool=True)
    data, report = sfc.convert(project, "iec-text", flavour="matiec", limit=20)
    assert report.losses == []
    assert report.compared["POU Plant"].startswith("equal")
    scans = [{"a": left_at_once, "b": True}, {"a": True}, {"a": False, "b": False}, {}, {}, {}]
    run = Simulation(resolve(project), profile="beremiz", scan_time="10ms")
    shown = []
    for values in scans:
        for name, value in values.items():
            run.set(name, value)
        run.scan()
        shown.append(run.instance["q"])
    assert shown[-1] is left_at_once
    assert [row["q"] for row in require_matiec().build(data.decode(), tmp_path).run(scans, ["q"])] == shown


@pytest.mark.parametrize("target", ["iec-text", "codesys", "scl", "simaticml"])
def test_loops_of_beremiz_are_reported_in_tools_that_count_every_turn(target: str) -> None:
    loop = "FOR i := 1 TO n DO k := k + 1; END_FOR;"
    _, report = sfc.convert(_of_beremiz(loop), target, partial=True)
    assert [item.outcome for item in report.losses if item.what == "loop"] == [Outcome.APPROXIMATED]
    _, report = sfc.convert(_of_beremiz(LOOPS["literals"]), target, partial=True)
    assert not [item for item in report.losses if item.what == "loop"]


def test_loops_for_beremiz_are_written_so_that_it_counts_every_turn() -> None:
    text = f"PROGRAM Plant VAR_INPUT n : INT; END_VAR VAR i, k : INT; END_VAR {LOOPS['one turn']} END_PROGRAM"
    project = sfc.loads(text.encode(), format="iec-text")
    result = sfc.loads(sfc.dumps(project, format="plcopen", flavour="beremiz"), format="plcopen")
    found = [Controller(project, "iec").instance("Plant"), Controller(result, "beremiz").instance("Plant")]
    for instance in found:
        instance.scan()
    assert found[0]["k"] == found[1]["k"] == 34
    kept = sfc.loads(sfc.dumps(_of_beremiz(LOOPS["one turn"]), format="plcopen", flavour="beremiz"), format="plcopen")
    assert "FOR i := 3 TO 3" in kept.pou("Plant").bodies[0].text  # it is theirs: they execute it as before


@pytest.mark.parametrize(
    ("company", "product", "version"), [("Unbekannt", "Unbenannt", "1"), ("Nieznany", "Unnamed", "1"), ("A", "B", "2")]
)
def test_what_is_simulated_as_beremiz_is_written_as_it_is(company: str, product: str, version: str) -> None:
    project = sfc.loads(
        b"PROGRAM Plant VAR n : INT; END_VAR INITIAL_STEP A: W(N); END_STEP STEP B: END_STEP "
        b"TRANSITION FROM A TO B := n > 3; END_TRANSITION ACTION W: n := n + 1; END_ACTION END_PROGRAM",
        format="iec-text",
    )
    project.header = FileHeader(company=company, product=product, version=version)
    read = sfc.loads(sfc.dumps(project, format="plcopen"), format="plcopen")
    _, report = sfc.convert(read, "iec-text", flavour="matiec", partial=True)
    is_reported = "action" in {item.what for item in report.losses}  # the final scan of IEC, which Beremiz has not
    assert is_reported is Simulation(resolve(read, "Plant")).profile.final_scan


CHANGING = """FUNCTION F : BOOL VAR_IN_OUT k : INT; END_VAR k := k + 1; F := TRUE; END_FUNCTION
FUNCTION G : BOOL VAR_IN_OUT k : INT; END_VAR G := k > 2; END_FUNCTION
"""


@pytest.mark.parametrize("flavour", ["matiec", "beremiz"])
@pytest.mark.parametrize(
    ("statement", "told"),
    [
        ("IF a AND F(k) THEN q := TRUE; END_IF;", "does not call `F` behind an operand"),
        ("q := a OR (b AND F(k := k));", "does not call `F` behind an operand"),
        ("q := F(k) AND a;", ""),
        ("q := a AND G(k);", ""),
        ("q := a XOR F(k);", ""),
        ("IF a AND_THEN F(k) THEN q := TRUE; END_IF;", ""),
        ("q := a OR_ELSE F(k);", ""),
    ],
)
def test_functions_behind_an_operand_that_decides_are_called_alike(flavour: str, statement: str, told: str) -> None:
    """It writes && and || of C: a function that counts was called less often, and nothing told it."""
    text = f"{CHANGING}PROGRAM Main VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR k : INT; END_VAR "
    project = sfc.loads(f"{text}{statement} END_PROGRAM".encode(), format="iec-text")
    target = "iec-text" if flavour == "matiec" else "plcopen"
    data, report = sfc.convert(project, target, flavour=flavour)
    assert [told in item.why for item in report.losses] == [True] * bool(told)
    assert b"_THEN F" not in data
    assert b"OR_ELSE" not in data
    sides = (project.pou("Main"), "iec"), (sfc.loads(data, format=target).pou("Main"), flavour)
    traces = [sfc.simulate(pou, scans=8, inputs=lambda scan, _: {"a": scan % 3 == 1, "b": scan > 4}, profile=profile)
              for pou, profile in sides]  # fmt: skip
    counts = [[row["k"] for row in trace.to_records()] for trace in traces]
    assert (counts[0] == counts[1]) is not bool(told)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (f"{CHANGING}PROGRAM M VAR_INPUT a : BOOL; END_VAR VAR k : INT; END_VAR INITIAL_STEP A: END_STEP "
         "TRANSITION FROM A TO B := G(k); END_TRANSITION STEP B: END_STEP "
         "TRANSITION FROM B TO A := TRUE; END_TRANSITION END_PROGRAM", "condition"),
        ("FUNCTION_BLOCK E VAR_INPUT x : BOOL R_EDGE; END_VAR VAR n : INT; END_VAR IF x THEN n := n + 1; END_IF; "
         "END_FUNCTION_BLOCK", "variable"),
        ("PROGRAM M VAR n : INT; END_VAR INITIAL_STEP A: V(P1); END_STEP TRANSITION FROM A TO A := n > 3; "
         "END_TRANSITION ACTION V: W(); END_ACTION ACTION W: n := n + 1; END_ACTION END_PROGRAM", "call of an action"),
        ("FUNCTION_BLOCK T VAR_TEMP x : INT := 3; END_VAR VAR n : INT; END_VAR n := n + x; END_FUNCTION_BLOCK",
         "initial value"),
        ("PROGRAM L VAR_INPUT x : BOOL; END_VAR VAR n : INT; END_VAR n := n + 1; END_PROGRAM "
         "PROGRAM M VAR q : INT; END_VAR L(x := TRUE); q := L.n; END_PROGRAM", "call of a program"),
        ("PROGRAM M VAR i : USINT; n : INT; END_VAR FOR i := 3 TO 0 BY -1 DO n := n + 1; END_FOR; END_PROGRAM", "loop"),
        ("PROGRAM M VAR x, y : SINT; n : INT; END_VAR IF x + y > 150 THEN n := 1; END_IF; END_PROGRAM", "operation"),
        ("PROGRAM M VAR i, k : INT; END_VAR FOR i := 1 TO k DO k := 2; i := i + 1; END_FOR; END_PROGRAM", "loop"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("flavour", ["matiec", "beremiz"])
def test_what_matiec_does_not_compile_or_link_is_told(text: str, what: str, flavour: str) -> None:
    project = sfc.loads(text.encode(), format="iec-text")
    target = "iec-text" if flavour == "matiec" else "plcopen"
    _, report = sfc.convert(project, target, flavour=flavour, partial=True)
    assert what in {item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)}


def test_names_of_types_and_arguments_without_names_are_written_as_matiec_takes_them(tmp_path: Path) -> None:
    text = (
        "TYPE P : STRUCT a : INT; END_STRUCT; END_TYPE FUNCTION F : BOOL VAR_INPUT x : INT; END_VAR "
        "VAR_OUTPUT o : INT; END_VAR o := x; F := x > 2; END_FUNCTION "
        "PROGRAM Plant VAR s : P; q : BOOL; n : INT; END_VAR s.a := 3; q := F(s.a, o => n); END_PROGRAM"
    )
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "iec-text", flavour="matiec")
    assert report.losses == []
    assert b"F(x := s.a, o => n)" in data
    assert require_matiec().build(data.decode(), tmp_path, program="Plant").run([{}], ["n"])[0]["n"] == 3


CALCULATED = [
    ("c(CU := a, R := FALSE, PV := 2); n := c.CV;", "VAR c : CTU; END_VAR"),
    ("c(CD := a, LD := FALSE, PV := 2); n := c.CV;", "VAR c : CTD; END_VAR"),
    ("c(CU := a, CD := b, R := FALSE, LD := FALSE, PV := 1); n := c.CV;", "VAR c : CTUD; END_VAR"),
    ("c(CU := a, R := FALSE, PV := n); IF c.Q THEN n := n + 1; END_IF;", "VAR c : CTU; END_VAR"),
    ("IF x + x > 0 THEN n := 1; END_IF;", "VAR x : INT := 30000; END_VAR"),
    ("n := (x + x) / 2;", "VAR x : INT := 30000; END_VAR"),
    ("IF NOT w = 16#F0 THEN n := 1; END_IF;", "VAR w : BYTE := 16#0F; END_VAR"),
]
"""Statements that matiec calculates otherwise (compiled with iec2c and run), and their variables."""


@pytest.mark.parametrize(("statements", "variables"), CALCULATED)
@pytest.mark.parametrize("flavour", ["matiec", "beremiz"])
def test_what_matiec_calculates_otherwise_is_told(statements: str, variables: str, flavour: str) -> None:
    head = "PROGRAM Main VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR"
    project = sfc.loads(f"{head} {variables} {statements} END_PROGRAM".encode(), format="iec-text")
    target = "iec-text" if flavour == "matiec" else "plcopen"
    data, report = sfc.convert(project, target, flavour=flavour)
    assert [item.outcome for item in report.losses] == [Outcome.APPROXIMATED]
    if "NOT" in statements or "PV := n" in statements:
        return
    sides = (project.pou("Main"), "iec"), (sfc.loads(data, format=target).pou("Main"), flavour)
    inputs = lambda scan, _: {"a": scan % 2 == 1, "b": scan % 3 == 1}  # noqa: E731
    ends = [sfc.simulate(pou, scans=12, inputs=inputs, profile=profile).to_records()[-1]["n"] for pou, profile in sides]
    assert ends[0] != ends[1]


@pytest.mark.parametrize(
    ("statements", "variables"),
    [
        ("c(CU := a, R := b, PV := 2); q := c.Q;", "VAR c : CTU; END_VAR"),
        ("c(CD := a, LD := b, PV := 2); q := c.Q;", "VAR c : CTD; END_VAR"),
        ("w := NOT w;", "VAR w : BYTE := 16#0F; END_VAR"),
        ("n := n + 1;", ""),
    ],
)
def test_what_matiec_calculates_alike_is_no_loss(statements: str, variables: str) -> None:
    head = "PROGRAM Main VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT n : INT; q : BOOL; END_VAR"
    project = sfc.loads(f"{head} {variables} {statements} END_PROGRAM".encode(), format="iec-text")
    assert sfc.convert(project, "iec-text", flavour="matiec")[1].losses == []


@pytest.mark.parametrize("flavour", ["matiec", "beremiz"])
def test_pulses_have_no_final_scan_anywhere(flavour: str) -> None:
    """P1 and P0 were called approximated, which `--strict` refused, though they are executed once in both tools."""
    text = (
        "PROGRAM M VAR_INPUT a : BOOL; END_VAR VAR n : INT; END_VAR INITIAL_STEP A: END_STEP "
        "TRANSITION FROM A TO B := a; END_TRANSITION STEP B: Up(P1); Off(P0); Continue(N); END_STEP "
        "TRANSITION FROM B TO A := NOT a; END_TRANSITION ACTION Up: n := n + 1; END_ACTION "
        "ACTION Off: n := n + 1; END_ACTION ACTION Continue: n := n + 2; END_ACTION END_PROGRAM"
    )
    target = "iec-text" if flavour == "matiec" else "plcopen"
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target, flavour=flavour)
    assert [item.path.rpartition(" ")[2] for item in report.losses if "once more" in item.why] == ["x_Continue"]
    assert b"ACTION Continue" not in data  # a statement of matiec


COUNTING = {
    "c(CU := a, PV := INT_TO_WORD(i));": ("c(CU := a, PV := i);", True),
    "c(CU := a, PV := w);": ("c(CU := a, PV := WORD_TO_INT(w));", True),
    "c.PV := w;": ("c.PV := WORD_TO_INT(w);", True),
    "c(CU := a, PV := s);": ("c(CU := a, PV := SINT_TO_INT(s));", False),
    "w := c.CV;": ("w := INT_TO_WORD(c.CV);", False),
    "r := INT_TO_REAL(s);": ("r := INT_TO_REAL(SINT_TO_INT(s));", False),
    "i := WORD_TO_INT(u);": ("i := WORD_TO_INT(UINT_TO_WORD(u));", False),
}


def _of_codesys(statements: str) -> sfc.Project:
    text = f"""PROGRAM Plant VAR a : BOOL; s : SINT; w : WORD; u : UINT; i : INT; r : REAL; c : CTU; END_VAR
{statements}
END_PROGRAM"""
    return sfc.loads(sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="codesys"), format="codesys")


@pytest.mark.parametrize("statement", COUNTING)
def test_arguments_have_the_types_of_their_parameters(statement: str, tmp_path: Path) -> None:
    """A counter of CODESYS has WORDs where that of matiec has INTs, and matiec converts no argument."""
    text, report = _text_for(_of_codesys(statement))
    written, told = COUNTING[statement]
    assert written in text
    losses = [item.outcome for item in report.losses if item.what != "counter"]  # it ends at PV in matiec
    assert losses == ([Outcome.APPROXIMATED] if told else [])
    require_matiec().translate(text, tmp_path)


@pytest.mark.parametrize("statement", ["c(CU := a, PV := DINT#7 * d);", "a := c.CV > w;"])
def test_arguments_of_other_types_are_told(statement: str) -> None:
    project = _of_codesys("")
    project.pou("Plant").variables()
    project.pou("Plant").interface.sections[0].variables.append(m.Variable(name="d", type="DINT"))
    project.pou("Plant").body.text = statement
    losses = [item.outcome for item in _text_for(project)[1].losses if item.what != "counter"]
    assert losses == [Outcome.NOT_EXECUTED]


def _compiled(text: str, folder: Path) -> tuple[str, sfc.ConversionReport]:
    written, report = _text_for(sfc.loads(text.encode(), format="iec-text"))
    require_matiec().translate(written, folder)
    return written, report


def test_subranges_are_types_with_a_name(tmp_path: Path) -> None:
    types = "TYPE Speed : STRUCT now : INT(0..10); END_STRUCT; END_TYPE"
    body = "VAR s : Speed; g : INT(0..9); i : INT; END_VAR i := s.now; END_PROGRAM"
    text, report = _compiled(f"{types} PROGRAM Plant {body}", tmp_path)
    assert report.losses == []
    assert "now : T_Speed_now;" in text


def test_a_second_name_of_a_structure_is_not_executed() -> None:
    types = "TYPE Part : STRUCT n : INT; END_STRUCT; END_TYPE TYPE Item : Part; END_TYPE"
    project = sfc.loads(
        f"{types} PROGRAM Plant VAR p : Item; END_VAR p.n := 1; END_PROGRAM".encode(), format="iec-text"
    )
    report = sfc.convert(project, "iec-text", flavour="matiec", partial=True).report
    assert [(item.path, item.why) for item in report.with_outcome(Outcome.NOT_EXECUTED)] == [
        ("type Item", "matiec compiles no second name of a structure: declare variables as Part")
    ]


def test_an_indicator_that_nothing_declares_is_left_out(tmp_path: Path) -> None:
    chart = """PROGRAM Plant VAR a : BOOL; q : BOOL; done : BOOL; END_VAR
INITIAL_STEP S1: q(L, T#1s, Done); END_STEP
STEP S2: q(L, T#2s, Missing); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := a; END_TRANSITION
END_PROGRAM"""
    written, report = _compiled(chart, tmp_path)
    assert "Missing" not in written
    assert [item.why for item in report.items if item.what == "indicator"] == [
        "Missing is left out: nothing declares it"
    ]


@pytest.mark.parametrize("declared", ["", "VAR_EXTERNAL on : BOOL; count : INT; END_VAR"])
def test_instructions_that_matiec_does_not_read_become_statements(declared: str, tmp_path: Path) -> None:
    """R is an operator of IL, and a global variable of instructions is declared as external, once."""
    body = "CAL c(\nCU := on,\nR := c.Q,\nPV := 11\n)\nLD c.CV\nST count\n"
    source = f"""CONFIGURATION Line VAR_GLOBAL on : BOOL; count : INT; END_VAR RESOURCE Cpu ON PLC
TASK T0(INTERVAL := T#20ms, PRIORITY := 0); PROGRAM Runs WITH T0 : Plant; END_RESOURCE END_CONFIGURATION
PROGRAM Plant {declared} VAR c : CTU; END_VAR
{body}END_PROGRAM"""
    project = sfc.loads(source.encode(), format="iec-text")
    assert isinstance(project.pou("Plant").body, m.IlBody)
    written, report = _text_for(project)
    require_matiec().translate(written, tmp_path)
    assert "c(CU := x_on, R := c.Q, PV := 11);" in written
    assert [item.what for item in report.losses] == ["counter"]


def test_blocks_of_the_library_of_codesys_are_in_the_text(tmp_path: Path) -> None:
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    text, report = _text_for(project)
    assert "FUNCTION_BLOCK BLINK" in text
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    require_matiec().translate(text, tmp_path)
