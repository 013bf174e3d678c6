"""Named mistakes in lowered code and in converted charts of the fixtures: each is found."""

from __future__ import annotations

from functools import cache

import pytest

from benchmarks.mutation import FIXTURES, Effort, Result, converted_result, lowered_result
from plcopen_sfc.analysis import VerdictKind

EFFORT = Effort(cap=500, runs=30, scans=200)
PUSHER = ("codesys/sorting_conveyor.xml", "FB_Pusher")
HOME = ("codesys/sorting_conveyor.xml", "PLC_PRG.ACT_Home")
CAP = ("plcopen/filling_station_2.01.xml", "CapStation")

CHAIN = ("training-chain/codesys.xml", "Ablauf")
GRAPH = ("simaticml-training-chain/Ablauf.xml", "Ablauf")

LOWERED = [
    (*PUSHER, "case ST", "goes nowhere", "step_number := 3;"),
    (*PUSHER, "case ST", "goes elsewhere", "step_number := 3;"),
    (*PUSHER, "case ST", "counts by two", "uiJams + 1"),
    (*PUSHER, "case ST", "condition negated", "iHome"),
    (*PUSHER, "bits ST", "conjunct dropped", "NOT xInterlock"),
    (*PUSHER, "bits ST", "condition TRUE", "X_Jammed AND NOT Jammed_entry_old"),
    (*PUSHER, "bits ST", "statement removed", "X_Retracting := T_"),
    (*PUSHER, "flipflop LD", "time changed", "T#100ms"),
    (*PUSHER, "flipflop LD", "set not stored", "qValve"),
    (*CAP, "case ST", "assignment inverted", "yTurn :="),
    (*HOME, "bits ST", "statement removed", "fbPusher2("),  # of an instance that is all that the call changes
    (*GRAPH, "bits ST", "disjunct dropped", "#X3 AND #displayed_step = 3"),  # two steps active: by hand only
]
CONVERTED = [
    (*PUSHER, "plcopen-2.01", "transition rewired", "Jammed -> Release"),
    (*PUSHER, "plcopen-2.01", "condition dropped", "Jammed -> Release"),
    (*PUSHER, "plcopen-2.01", "condition negated", "Release -> Retracting"),
    (*PUSHER, "plcopen-2.01", "priority swapped", "Extending"),
    (*PUSHER, "plcopen-2.01", "step bypassed", "Extended"),
    (*PUSHER, "plcopen-2.01", "statement doubled", "uiJams := uiJams + 1;"),
    (*CHAIN, "plcopen-2.01", "qualifier changed", "S2: S Q2 as N"),
    (*CHAIN, "plcopen-2.01", "action removed", "S4: R Q2"),
    (*CHAIN, "plcopen-2.01", "step added", "S4 -> S1"),
]

_lowered, _converted = cache(lowered_result), cache(converted_result)


def verdict_of(result: Result, kind: str, place: str) -> VerdictKind:
    found = [mutant for mutant in result.mutants if mutant.kind == kind and place in mutant.place]
    assert found, [str(each) for each in result.mutants if each.kind == kind]
    return result.compare(found[0].made()).kind


@pytest.mark.slow
@pytest.mark.parametrize(("file", "chart", "form", "kind", "place"), LOWERED)
def test_a_mistake_in_lowered_code_is_found(file: str, chart: str, form: str, kind: str, place: str) -> None:
    result = _lowered(FIXTURES / file, chart, form, EFFORT)
    assert verdict_of(result, kind, place) is VerdictKind.DIFFERENT


@pytest.mark.slow
@pytest.mark.parametrize(("file", "chart", "target", "kind", "place"), CONVERTED)
def test_a_mistake_in_a_converted_chart_is_found(file: str, chart: str, target: str, kind: str, place: str) -> None:
    result = _converted(FIXTURES / file, chart, target, EFFORT)
    assert verdict_of(result, kind, place) is VerdictKind.DIFFERENT


@pytest.mark.slow
def test_without_a_mistake_no_difference_is_found() -> None:
    results = [_lowered(FIXTURES / each[0], *each[1:3], EFFORT) for each in LOWERED if each[0] != GRAPH[0]]
    results += [_converted(FIXTURES / each[0], *each[1:3], EFFORT) for each in CONVERTED]
    for result in {result.name: result for result in results}.values():
        assert result.compare(result.project).counterexample is None, result.name


@pytest.mark.slow
def test_mutants_are_copies_with_one_mistake_each() -> None:
    result = _lowered(FIXTURES / PUSHER[0], PUSHER[1], "bits ST", EFFORT)
    before = result.project.model_dump_json()
    some = result.mutants[::10]
    texts = {mutant.made().model_dump_json() for mutant in some}
    assert before not in texts
    assert len(texts) == len(some)
    assert result.project.model_dump_json() == before
