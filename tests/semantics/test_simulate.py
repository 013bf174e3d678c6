"""`simulate`: charts, programs and projects, with inputs from everywhere."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import timedelta
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.errors import InputError, ModelError, SimulationError
from plcopen_sfc.model import Project, SfcNetwork
from plcopen_sfc.semantics.inputs import RandomInputs
from plcopen_sfc.semantics.simulation import Simulation, nanoseconds
from plcopen_sfc.semantics.subjects import resolve
from plcopen_sfc.semantics.trace import Trace
from tests.sweeps import examples

MS = 1_000_000
PLANT = """
TYPE Mode : (Off, Auto, Manual); END_TYPE
PROGRAM Plant
VAR_INPUT Start : BOOL; Level : REAL; Selected : Mode; Count : INT; END_VAR
VAR_OUTPUT Valve, Lamp : BOOL; Total : INT; END_VAR
VAR Timer : TON; END_VAR
INITIAL_STEP Wait: Lamp(N); END_STEP
TRANSITION FROM Wait TO Fill := Start AND Selected = Auto; END_TRANSITION
STEP Fill: Valve(N); END_STEP
TRANSITION FROM Fill TO Settle := Level >= 2.5; END_TRANSITION
STEP Settle: END_STEP
TRANSITION FROM Settle TO Wait := Settle.T >= T#50ms; END_TRANSITION
END_PROGRAM
"""
SUM = """
PROGRAM Adding
VAR_INPUT A, B : INT; END_VAR
VAR_OUTPUT Sum : INT; Ratio : INT; END_VAR
Sum := A + B;
Ratio := A / B;
END_PROGRAM
"""


def project(text: str = PLANT) -> Project:
    return sfc.loads(text.encode(), format="iec-text")


def drive(scan: int, values: Mapping[str, object]) -> Mapping[str, object]:
    return {"Start": scan == 2, "Selected": 1, "Level": 3.0 if values["Valve"] and scan > 5 else 0.0}


def test_a_chart_with_inputs_from_a_function() -> None:
    trace = sfc.simulate(project(), inputs=drive, scans=20, profile="iec")
    assert len(trace) == 20
    assert trace.situations() == [(0, ("Wait",)), (2, ("Fill",)), (6, ("Settle",)), (11, ("Wait",))]
    assert trace["Valve"] == [2 <= scan < 6 for scan in range(20)]
    assert trace.active(7) == ("Settle",)
    assert trace.time(11) - trace.time(6) == 50 * MS
    assert trace.name == "Plant"
    assert trace.profile == "iec"


def test_everything_simple_is_recorded_unless_names_are_given() -> None:
    trace = sfc.simulate(project(), scans=3)
    names = [column.name for column in trace.columns]
    assert {"Start", "Level", "Selected", "Valve", "Lamp", "Total"} <= set(names)
    assert not {"Timer", "Wait", "Fill"} & set(names)
    chosen = sfc.simulate(project(), inputs=drive, scans=12, record=["valve", "Settle.T", "Settle.X", "Timer.ET"])
    assert [column.name for column in chosen.columns] == ["Valve", "Settle.T", "Settle.X", "Timer.ET"]
    assert chosen["Settle.T"][8] == 20 * MS
    assert chosen["Settle.X"] == [6 <= scan < 11 for scan in range(12)]
    with pytest.raises(ModelError, match="Timer is no single value"):
        sfc.simulate(project(), record=["Timer"])
    with pytest.raises(ModelError):
        sfc.simulate(project(), record=["Nothing"])


def test_inputs_from_a_file_and_back(tmp_path: Path) -> None:
    path = tmp_path / "in.csv"
    path.write_text("time ms;Start;Selected;Level\n0;0;Auto;0\n20;1;;\n30;0;;\n60;;;3.5\n", encoding="utf-8")
    trace = sfc.simulate(project(), inputs=path, scans=12)
    assert [active for _, active in trace.situations()] == [("Wait",), ("Fill",), ("Settle",), ("Wait",)]
    assert len(sfc.simulate(project(), inputs=path)) == 7
    trace.save_csv(tmp_path / "out.csv")
    assert sfc.simulate(project(), inputs=tmp_path / "out.csv") == trace
    assert sfc.simulate(project(), inputs=trace) == trace


def test_scan_times_initial_values_and_profiles() -> None:
    for scan_time in ("25ms", "T#25ms", 25 * MS, timedelta(milliseconds=25)):
        trace = sfc.simulate(project(), inputs=drive, scans=12, scan_time=scan_time)
        assert trace.time(1) == 25 * MS
        assert trace.situations()[-1] == (8, ("Wait",))
    start = sfc.simulate(project(), scans=2, initial={"start": "TRUE", "Selected": "Auto", "Level": 9})
    assert start.situations() == [(0, ("Fill",)), (1, ("Settle",))]
    first = sfc.simulate(project(), scans=2, initial={"Start": True, "Selected": 1}, profile="codesys")
    assert first["Lamp"][0] is True  # actions before transitions
    assert sfc.simulate(project(), scans=1).profile == "iec"
    with pytest.raises(ModelError, match="no profile 'other'"):
        sfc.simulate(project(), profile="other")


@pytest.mark.parametrize("time", ["", "x", "10", "-5ms", "0s", 0, -1, timedelta(0), "D#2020-01-01"])
def test_scan_times_that_are_none(time: str | int | timedelta) -> None:
    with pytest.raises(InputError, match="scan time"):
        nanoseconds(time)


@settings(deadline=None, max_examples=examples(15))
@given(st.integers(0, 1000))
def test_random_inputs_give_the_same_trace_again(seed: int) -> None:
    source = RandomInputs(seed, hold=(1, 4), ranges={"Level": (0, 5)})
    trace = sfc.simulate(project(), inputs=source, scans=60)
    assert sfc.simulate(project(), inputs=source, scans=60) == trace
    assert sfc.simulate(project(), inputs=trace) == trace
    # one step is active at any time, and the outputs are those of the steps
    assert all(len(trace.active(scan)) == 1 for scan in range(60))
    assert list(trace["Valve"]) == trace.is_active("Fill")


def test_a_program_without_a_chart() -> None:
    trace = sfc.simulate(project(SUM), inputs=lambda scan, _: {"A": scan, "B": 2}, scans=5)
    assert trace.steps == ()
    assert trace["Sum"] == [2, 3, 4, 5, 6]
    assert "active" not in str(trace)


def test_what_a_program_does_wrong_is_told() -> None:
    with pytest.raises(SimulationError, match=r"(?i)zero") as error:
        sfc.simulate(project(SUM), inputs=lambda scan, _: {"A": 1, "B": 3 - scan}, scans=9)
    assert "Adding" in str(error.value)
    run = Simulation(resolve(project(SUM)))
    run.set("B", 1)
    run.scan()
    run.set("B", 0)
    with pytest.raises(SimulationError):
        run.scan()
    assert len(run.trace) == 1  # what was recorded before is kept


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"Strat": True}, "no variable 'Strat'"),
        ({"Start": 2}, "Start: 2 is no value of the type BOOL"),
        ({"Count": 1 << 15}, "does not fit the type INT"),
        ({"Count": 1.5}, "1.5 is no value"),
        ({"Selected": "Fast"}, "'Fast' is no"),
        ({"Level": None}, "None is no value"),
    ],
)
def test_values_that_do_not_fit(inputs: Mapping[str, object], message: str) -> None:
    with pytest.raises(InputError) as error:
        sfc.simulate(project(), inputs=lambda scan, values: inputs)
    assert message in error.value.message


def test_what_to_run() -> None:
    both = project(PLANT + SUM)
    assert sfc.simulate(both, scans=1).name == "Plant"  # the only chart
    assert sfc.simulate(both, pou="adding", scans=0).name == "Adding"
    assert sfc.simulate(both.pou("Plant"), scans=1).steps == ("Wait", "Fill", "Settle")
    chart = both.pou("Plant").sfc
    assert chart is not None
    assert sfc.simulate(chart, scans=1, initial={"Selected": "Auto"})["Selected"] == [1]
    with pytest.raises(ModelError, match="no POU 'Other'"):
        sfc.simulate(both, pou="Other")
    two = project(PLANT + PLANT.replace("Plant", "Second").split("END_TYPE")[1])
    with pytest.raises(ModelError, match="POU to run is not named") as error:
        sfc.simulate(two)
    assert error.value.hint == "Name one of them: Plant, Second"
    with pytest.raises(ModelError, match="nothing that could be run"):
        sfc.simulate(Project())


def test_a_chart_that_is_in_no_project() -> None:
    chart = SfcNetwork()
    first, second = chart.add_step("A", initial=True), chart.add_step("B")
    chart.add_transition(first, second, "Go AND Speed > 3")
    chart.add_transition(second, first, "NOT Go")
    trace = sfc.simulate(chart, inputs=lambda scan, _: {"Go": scan in (1, 2, 3), "Speed": 2 * scan}, scans=6)
    assert trace.situations() == [(0, ("A",)), (2, ("B",)), (4, ("A",))]


def test_the_chart_of_an_action_runs_on_its_own() -> None:
    loaded = sfc.load(Path(__file__).parents[2] / "fixtures" / "codesys" / "sorting_conveyor.xml")
    names = [name for name, pou, _ in loaded.charts() if name != pou.name]
    for name in names:
        trace = sfc.simulate(loaded, pou=name, scans=5)
        assert isinstance(trace, Trace)
        assert trace.name == name


def test_temporary_variables_of_a_chart_start_anew_in_each_scan() -> None:
    text = b"""PROGRAM Main
    VAR_TEMP t : INT := 5; END_VAR
    VAR n : INT; END_VAR
    INITIAL_STEP Work: Add(N); END_STEP
    ACTION Add: t := t + 1; n := t; END_ACTION
    END_PROGRAM"""
    trace = sfc.simulate(sfc.loads(text, format="iec-text"), scans=3, record=["n"])
    assert list(trace["n"]) == [6, 6, 6]
