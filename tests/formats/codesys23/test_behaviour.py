"""The distribution belt in simple steps does what the exercise asks for (textbook of the seeds, 11.5.1 and 11.5.3)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import Outcome
from tests.conversion.features import FEATURES, feature_project
from tests.formats.codesys23.test_reading import BELT

AT_PLACE_3 = 10
AT_THE_END = 15
SCAN = 100  # ms


class Plant:
    """A part on the belt: it moves by one in each scan in which a motor runs."""

    def __init__(self, **inputs: Callable[[int], bool]) -> None:
        self.position = 0
        self.inputs = {"S1_Start": lambda scan: scan == 2, **inputs}

    def __call__(self, scan: int, values: Mapping[str, Any]) -> dict[str, Any]:
        right, left = (values[f"Globale_Variablen.Band_{side}"] for side in ("Rechts", "Links"))
        self.position += int(right) - int(left)
        sensors = {
            "Platz1": self.position <= 0,
            "Platz3": self.position == AT_PLACE_3,
            "Lichtschranke": self.position >= AT_THE_END,
        }
        return sensors | {name: value(scan) for name, value in self.inputs.items()}


def run(scans: int, **inputs: Callable[[int], bool]) -> sfc.Trace:
    return sfc.simulate(sfc.load(BELT), pou="Ablauf", inputs=Plant(**inputs), scans=scans, scan_time=f"{SCAN}ms")


def test_the_part_waits_three_seconds_and_swings_twice() -> None:
    trace = run(150)
    steps = [(scan, names[0]) for scan, names in trace.situations()]
    order = [name for _, name in steps]
    swing = ["Pendel_Hin", "Pendel_Zurueck", "Pendel_Zaehlen", "Pruefen"]
    assert order == ["Bereit", "Zu_Platz3", "Warten", "Zurueck", "Pruefen", *swing, *swing, "Abtransport", "Bereit"]
    times = {name: scan for scan, name in reversed(steps)}
    assert abs((times["Zurueck"] - times["Warten"]) * SCAN - 3000) <= SCAN
    # the lamp shows that the belt is ready
    assert trace["Globale_Variablen.H1_Bereit"][1]
    assert not trace["Globale_Variablen.H1_Bereit"][times["Warten"]]


@pytest.mark.slow
def test_the_belt_does_the_same_in_codesys_v3() -> None:
    belt = sfc.load(BELT)
    data, report = sfc.convert(belt, "codesys", partial=True)
    told = [item.path for item in report.items if item.what == "condition" and "instruction list" in item.why]
    assert told == ["POU Ablauf / transition Bereit -> Zu_Platz3"]
    verdict = sfc.equivalent(
        belt.pou("Ablauf"), sfc.loads(data).pou("Ablauf"), profile=("codesys23", "codesys"), runs=10, cap=2000
    )
    assert verdict.equal, str(verdict)


@pytest.mark.parametrize(("flag", "executed"), [("SFCInit", False), ("SFCReset", True)])
def test_flags_set_the_chart_back(flag: str, executed: bool) -> None:
    """Both lead to the initial step; SFCInit does not execute it, SFCReset does."""
    trace = run(40, **{flag: lambda scan: scan >= 20})
    assert trace.active(30) == ("Bereit",)
    assert trace["Globale_Variablen.H1_Bereit"][30] is executed


def test_a_pause_holds_the_chart() -> None:
    trace = run(60, SFCPause=lambda scan: 16 <= scan < 55)
    assert trace.active(54) == ("Warten",)
    assert trace.active(16) == ("Warten",)


@pytest.mark.parametrize(("last", "lost"), [("7", 0), ("14", 2)])
def test_bits_that_a_controller_counts_in_words_are_other_terminals_elsewhere(last: str, lost: int) -> None:
    declared = f"PROGRAM Main\nVAR\n\tx AT %IX0.{last} : BOOL;\n\ty AT %QX1.2 : BOOL;\nEND_VAR\n"
    project = sfc.loads(f"(* @PATH := '' *)\n{declared}(* @END_DECLARATION := '0' *)\ny := x;\nEND_PROGRAM\n".encode())
    for target in ("codesys", "twincat", "codesys-export"):
        report = sfc.convert(project, target, partial=True).report
        assert len([each for each in report.losses if each.what == "address"]) == lost


MIXED = """PROGRAM Main
VAR
a, b, lamp, pump : BOOL;
n : INT;
END_VAR
INITIAL_STEP Wait:
lamp := Wait;
END_STEP
TRANSITION FROM Wait TO Run:=
a AND NOT Run.x
END_TRANSITION
STEP Run:
pump(N);
END_STEP
TRANSITION FROM Run TO Wait:=
b
END_TRANSITION
END_PROGRAM
ACTION Other:
IF Wait AND NOT Run.x THEN
n := n + 1;
END_IF;
END_ACTION
"""


def test_a_simple_step_beside_iec_steps_has_a_flag_of_its_name() -> None:
    project = sfc.loads(MIXED.replace("\n", "\r\n").encode(), format="codesys23")
    trace = sfc.simulate(project, inputs=lambda scan, _: {"a": scan == 1, "b": scan == 3}, scans=6)
    assert list(trace["lamp"]) == [True] * 6  # its action is executed while it is active, never once more
    assert list(trace["pump"]) == [False, False, True, True, False, False]
    lowered = sfc.lower(project, "bits", verify=True, free_inputs="all")
    assert lowered.proof is not None
    assert lowered.proof.proven
    # other tools have structures for all steps, and the way back gives the flag
    written = sfc.dumps(project, format="codesys").decode("utf-8-sig")
    assert "lamp := Wait.x" in written
    assert "IF Wait.x AND NOT Run.x THEN" in written
    back = sfc.dumps(sfc.loads(written.encode(), format="codesys"), format="codesys23").decode()
    assert "lamp := Wait;" in back
    assert "IF Wait AND NOT Run.x THEN" in back
    assert "a AND NOT Run.x" in back
    # the initial step, which takes no association, stays simple beside IEC steps
    with pytest.raises(sfc.ModelError, match="only Wait has an action"):
        project.edit().use_iec_steps(project.pou("Main").chart)


@pytest.mark.parametrize("association", ["", "q(N);"])
def test_the_time_of_a_simple_step_is_not_executed(association: str) -> None:
    text = f"""PROGRAM Main
    VAR a, q : BOOL; n : INT; END_VAR
    INITIAL_STEP S1: {association} END_STEP
    TRANSITION FROM S1 TO S2 := a; END_TRANSITION
    STEP S2:
    Work(N); {{plcopen_sfc step_action := 'main'}}
    END_STEP
    TRANSITION FROM S2 TO S1 := S2.t > T#1s; END_TRANSITION
    ACTION Work: n := n + 1; END_ACTION
    END_PROGRAM"""
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    told = [item for item in sfc.convert(project, "codesys23", partial=True).report.items if item.what == "step time"]
    assert [(item.outcome, item.path) for item in told] == [
        (sfc.Outcome.NOT_EXECUTED, "POU Main / transition S2 -> S1")
    ]
    # an IEC step has one
    other = sfc.loads(text.replace(" {plcopen_sfc step_action := 'main'}", "").encode(), format="iec-text")
    assert not [item for item in sfc.convert(other, "codesys23", partial=True).report.items if item.what == "step time"]


def test_a_step_that_another_switches_on_keeps_its_name() -> None:
    """Its name was taken for its flag, and became that of a member: `ON Side.x`, of which there is no step."""
    source = feature_project(next(each for each in FEATURES if each.name == "ON"), "simaticml")
    data, report = sfc.convert(source, "codesys23", limit=20)
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    assert report.compared["POU Main"].startswith("equal, second 1 scan later (proof")
    rows = sfc.loads(data, format="codesys23").pou("Main").chart.step("Work").actions
    assert [(row.qualifier.value, row.target) for row in rows if row.event is not None] == [("ON", "Side")]


@pytest.mark.parametrize("target", ["codesys", "codesys-export", "plcopen-2.01", "simaticml"])
def test_trunc_gives_an_int(target: str) -> None:
    """Help of CODESYS, operator TRUNC: an import from CoDeSys 2.3 makes TRUNC_INT of it."""
    text = """(* @NESTEDCOMMENTS := 'Yes' *)
FUNCTION_BLOCK Fb
VAR_INPUT r : REAL; END_VAR
VAR_OUTPUT d : DINT; END_VAR
(* @END_DECLARATION := '0' *)
d := TRUNC(r);
END_FUNCTION_BLOCK
"""
    source = sfc.loads(text.encode(), format="codesys23")
    data, report = sfc.convert(source, target)
    assert not report.losses
    for project in (source, sfc.loads(data, as_tool=True)):
        assert list(sfc.simulate(project, pou="Fb", scans=1, initial={"r": 40000.7})["d"]) == [40000 - 65536]
    if target.startswith("codesys"):
        back, _ = sfc.convert(sfc.loads(data, as_tool=True), "codesys23")
        assert b"d := TRUNC(r);" in back


def test_trunc_of_the_successor_is_told() -> None:
    project = sfc.loads(b"PROGRAM Main VAR r : REAL; d : DINT; END_VAR d := TRUNC(r); END_PROGRAM", format="iec-text")
    _, report = sfc.convert(sfc.loads(sfc.convert(project, "codesys").data, as_tool=True), "codesys23")
    assert [item.why for item in report.losses] == ["TRUNC gives an INT in CoDeSys 2.3, and a DINT in the source"]


def test_a_comment_between_objects_is_no_section_that_is_executed() -> None:
    data = BELT.read_bytes().replace(b"END_PROGRAM\r\n\r\n", b"END_PROGRAM\r\n(* end *)\r\n\r\n", 1)
    assert b"(* end *)" in data
    project = sfc.loads(data)
    assert sfc.dumps(project) == data
    _, report = sfc.convert(project, "codesys", partial=True)
    told = [item.outcome for item in report.items if item.why == "a comment between objects"]
    assert told == [Outcome.EXTENSION_DATA]
    assert not [item for item in report.losses if item.what == "section"]


def test_a_union_is_refused() -> None:
    types = b"TYPE U : UNION a : INT; b : REAL; END_UNION END_TYPE"
    project = sfc.loads(b"PROGRAM Main VAR u : U; END_VAR u.a := 1; END_PROGRAM " + types, format="iec-text")
    _, report = sfc.convert(project, "codesys23", partial=True)
    assert any("has no UNION" in item.why for item in report.with_outcome(Outcome.NOT_EXECUTED))


TWO_ACTIONS = """{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := 'codesys'}
FUNCTION_BLOCK Fb
VAR_INPUT go, back : BOOL; END_VAR
VAR_OUTPUT n : INT := 1; END_VAR
INITIAL_STEP Init: END_STEP
TRANSITION FROM Init TO (S2, S1) := go; END_TRANSITION
STEP S2: Foo(N); END_STEP
STEP S1: Aa(N); END_STEP
TRANSITION FROM (S2, S1) TO Init := back; END_TRANSITION
ACTION Foo: n := n * 2 MOD 1000; END_ACTION
ACTION Aa: n := n * 3 MOD 1000; END_ACTION
ACTION S2_active: n := 0; END_ACTION
END_FUNCTION_BLOCK
"""


def test_main_actions_in_place_come_before_associations() -> None:
    source = sfc.loads(sfc.convert(sfc.loads(TWO_ACTIONS.encode(), format="iec-text"), "codesys23", partial=True)[0])
    chart = source.pou("Fb").chart
    for name, text in (("S2", "n := n + 1;"), ("S1", "n := n * 5;")):
        chart.step(name).main_action = m.StBody(text=text)
    data, report = sfc.convert(source)
    assert not [each for each in report.losses if each.what in ("order of actions", "step action")]
    values = [
        [*sfc.simulate(each, pou="Fb", scans=6, inputs=lambda scan, _: {"go": scan == 1})["n"]]
        for each in (source, sfc.loads(data, as_tool=True))
    ]
    assert values[0] == values[1]
    assert len({*values[0]}) > 3


@pytest.mark.parametrize(("action", "is_told"), [("n := n + 1;", True), ("other := 1;", False)])
def test_a_main_action_behind_another_by_its_name_is_told(action: str, is_told: bool) -> None:
    text = TWO_ACTIONS.replace("S2_active: n := 0;", f"S2_active: {action}").replace("n : INT", "other, n : INT")
    source = sfc.loads(text.encode(), format="iec-text")
    source.pou("Fb").chart.step("S2").main_action = "S2_active"
    exported = sfc.loads(sfc.convert(source, "codesys", partial=True)[0], as_tool=True)
    _, report = sfc.convert(exported, "codesys23", partial=True)
    told = [(each.path, each.why) for each in report.losses if each.what == "order of actions"]
    by_names = "CoDeSys 2.3 executes the actions of a scan by their names: S2_active and"
    of_actions = [("POU Fb", f"{by_names} {name} would change places in a scan (n)") for name in ("Foo", "Aa")]
    assert told == (of_actions if is_told else [])
