"""Inputs that operate a chart rest in random runs, unless they are asked for."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.semantics.inputs import RandomInputs, system_inputs
from plcopen_sfc.semantics.profile import PROFILES
from tests.lowering.sequencers import STANDARD_INPUTS, act, block, ring

SEQUENCER = block(ring(act("N")), STANDARD_INPUTS, "Q")
FLAGS = """PROGRAM Main
VAR_INPUT Go, SFCInit, SFCPause : BOOL; END_VAR
INITIAL_STEP A: END_STEP
TRANSITION FROM A TO B := Go; END_TRANSITION
STEP B: END_STEP
TRANSITION FROM B TO A := NOT Go; END_TRANSITION
END_PROGRAM"""


def changing(trace: sfc.Trace) -> set[str]:
    return {column.name for column in trace.columns if len(set(column)) > 1}


def test_a_sequencer_is_never_switched_off_at_random() -> None:
    trace = sfc.simulate(SEQUENCER, profile="s7graph", inputs=RandomInputs(1), scans=300)
    assert changing(trace) == {"c1", "c2", "c3", "Q"}
    assert all(trace.active(scan) for scan in range(300))
    operated = sfc.simulate(SEQUENCER, profile="s7graph", inputs=RandomInputs(1, system_inputs=True), scans=300)
    assert changing(operated) >= {name.partition(":")[0] for name in STANDARD_INPUTS.split()}


def test_a_lowered_sequencer_gets_the_same_random_inputs() -> None:
    lowered = sfc.lower(SEQUENCER, "bits", profile="s7graph", verify=False).project
    chart, code = (
        sfc.simulate(project, profile="s7graph", inputs=RandomInputs(5), scans=200) for project in (SEQUENCER, lowered)
    )
    assert [list(code[name]) for name in ("c1", "OFF_SQ", "Q")] == [list(chart[name]) for name in ("c1", "OFF_SQ", "Q")]


def test_flags_of_codesys_rest() -> None:
    project = sfc.loads(FLAGS.encode(), format="iec-text")
    trace = sfc.simulate(project, profile="codesys", inputs=RandomInputs(2), scans=100)
    assert changing(trace) == {"Go"}
    asked = sfc.simulate(project, profile="codesys", inputs=RandomInputs(2, values={"SFCPause": [True]}), scans=100)
    assert asked["SFCPause"][50] is True


@pytest.mark.parametrize(
    ("profile", "expected"), [("s7graph", {"INIT_SQ", "S_SEL"}), ("iec", set()), ("codesys", {"GVL.SFCReset"})]
)
def test_names_count_where_they_operate_something(profile: str, expected: set[str]) -> None:
    pou = block(m.SfcNetwork(), "INIT_SQ S_SEL:INT Go").pous[0]
    names = ["INIT_SQ", "S_SEL", "Go", "DB.OFF_SQ"] + (["GVL.SFCReset"] if profile == "codesys" else [])
    assert system_inputs(pou, PROFILES[profile], names) == expected


def test_local_flags_of_codesys_are_inputs() -> None:
    project = sfc.loads(FLAGS.replace("VAR_INPUT", "VAR", 1).encode(), format="iec-text")
    assert "SFCPause" in {v.name for v in project.pous[0].variables() if v.name.startswith("SFC")}
    paused = sfc.simulate(project, profile="codesys", inputs=lambda scan, _: {"SFCPause": scan > 2}, scans=5)
    assert list(paused["SFCPause"]) == [False, False, False, True, True]
    trace = sfc.simulate(project, profile="codesys", inputs=RandomInputs(2, system_inputs=True), scans=100)
    assert "SFCPause" in changing(trace)
    assert "SFCPause" not in changing(sfc.simulate(project, profile="codesys", inputs=RandomInputs(2), scans=100))
