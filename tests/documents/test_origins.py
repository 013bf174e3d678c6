"""A converted file that keeps the charts of its source is executed by the rules of that, unless asked otherwise."""

from __future__ import annotations

import io
from functools import cache

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.formats.registry import FORMATS
from plcopen_sfc.semantics.profile import default_profile

KEEPING = [kind.name for kind in FORMATS if kind.extension_data and kind.name != "json"]

IEC = b"""FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR_OUTPUT q, r, s : BOOL; n : INT; END_VAR
INITIAL_STEP S1: q(N); Count(P1); END_STEP
STEP S2: q(N); r(L, T#2s); Count(P0); Zz(N); Aa(N); END_STEP
TRANSITION FROM S1 TO S2 := a AND NOT b; END_TRANSITION
TRANSITION FROM S2 TO S1 := S2.T >= T#1s AND S2.X OR b; END_TRANSITION
ACTION Count: n := (n + 1) MOD 4; END_ACTION
ACTION Zz: s := TRUE; END_ACTION
ACTION Aa: s := n > 2; END_ACTION
END_FUNCTION_BLOCK
"""

FLAGS = b"""
(* @NESTEDCOMMENTS := 'Yes' *)
FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
(* @END_DECLARATION := '0' *)
INITIAL_STEP S1:
END_STEP
TRANSITION FROM S1 TO S2 := a
END_TRANSITION
STEP S2:
END_STEP
TRANSITION FROM S2 TO S1 := S2 AND b
END_TRANSITION
END_FUNCTION_BLOCK
"""


def saved(project: sfc.Project, target: str, *, as_tool: bool = False) -> sfc.Project:
    data = io.BytesIO()
    sfc.save(project, data, format=target, partial=True)
    return sfc.loads(data.getvalue(), format=target, as_tool=as_tool)


def of_s7() -> sfc.Project:
    project = saved(sfc.loads(IEC, format="iec-text"), "simaticml", as_tool=True)
    (first, *_) = project.pou("Main").chart.steps
    first.interlock = "#b"
    first.actions[0].interlock = True
    return project


SOURCES = {
    "iec": lambda: sfc.loads(IEC, format="iec-text"),
    "codesys": lambda: saved(sfc.loads(IEC, format="iec-text"), "codesys", as_tool=True),
    "codesys23": lambda: sfc.loads(FLAGS, format="codesys23"),
    "s7graph": of_s7,
}


@cache
def source_of(name: str) -> sfc.Project:
    return SOURCES[name]()


@pytest.mark.parametrize("target", KEEPING)
@pytest.mark.parametrize("name", SOURCES)
def test_what_is_read_back_does_the_same(name: str, target: str) -> None:
    source = source_of(name)
    back = saved(source, target)
    pou = back.pou("Main")
    rules = default_profile(back), default_profile(source)
    assert {each.name.removesuffix("23") for each in rules} == {name.removesuffix("23")}  # those differ in notation
    verdict = sfc.equivalent(source.pou("Main"), pou, cap=100, runs=2, scans=20, limit=2)
    assert not verdict.different if name == "s7graph" else verdict.proven  # that has the inputs of all its modes
    assert sfc.simulate(pou, scans=3).profile == rules[0].name


def test_a_converted_file_is_one_of_its_own_tool_where_that_is_asked_for() -> None:
    source = source_of("codesys")
    assert default_profile(saved(source, "simaticml", as_tool=True)).name == "s7graph"
    assert sfc.simulate(saved(source, "plcopen"), scans=1, profile="iec").profile == "iec"


def test_a_project_without_a_file_is_for_the_tool_that_it_is_saved_for() -> None:
    project = sfc.Project(pous=[source_of("iec").pou("Main").model_copy(deep=True)])
    assert default_profile(saved(project, "codesys")).name == "codesys"


GRAFCET = b"""GRAFCET Press

INPUTS
S1
B1

OUTPUTS
K1

INITIAL STEP 1

1 -> 2 : \xe2\x86\x91S1 * B1

STEP 2
    K1

2 -> 1 : /S1 * /B1
"""


@pytest.mark.parametrize("target", [name for name in KEEPING if name != "scl"])  # which executes no chart
def test_a_grafcet_is_a_chart_of_the_tool_that_it_is_written_for(target: str) -> None:
    """An edge lasts a scan: one that is formed in the order of another tool comes too late."""
    source = sfc.loads(GRAFCET, format="grafcet-text")
    s1, b1 = (0, 0, 1, 0, 1, 1, 0), (0, 0, 1, 1, 1, 0, 0)

    def pressed(scan: int, _values: object) -> dict[str, bool]:
        return {"S1": bool(s1[scan]), "B1": bool(b1[scan])}

    projects = [saved(source, target, as_tool=as_tool) for as_tool in (False, True)]
    traces = [sfc.simulate(each.pou("Press"), inputs=pressed, scans=len(s1)) for each in projects]
    runs = [[record["K1"] for record in trace.to_records()] for trace in traces]
    assert runs[0] == runs[1]
    assert True in runs[0]


@pytest.mark.parametrize("between", KEEPING)
def test_chains_of_conversions_keep_the_tool_of_the_first(between: str) -> None:
    source = source_of("codesys")
    there = saved(source, between)
    further, back = saved(there, "plcopen"), saved(there, "codesys")
    assert further.tool_format == ("codesys23" if between == "codesys23" else "codesys")
    assert (back.tool_format, back.origin) == ("codesys", None)
    for project in (further, back, saved(back, "simaticml")):
        assert sfc.equivalent(source.pou("Main"), project.pou("Main"), limit=2).equal


@pytest.mark.parametrize("between", KEEPING)
def test_a_text_is_one_of_its_own_dialect_when_it_is_back(between: str) -> None:
    source = source_of("iec")
    back = saved(saved(source, between), "iec-text")
    assert (back.dialect, back.origin) == (source.dialect, None)
    assert sfc.equivalent(source.pou("Main"), back.pou("Main"), limit=2).equal


def test_an_edit_keeps_the_origin() -> None:
    data = io.BytesIO()
    back = saved(source_of("codesys"), "simaticml")
    back.pou("Main").chart.rename_step("S2", "Wait")
    sfc.save(back, data)
    edited = sfc.loads(data.getvalue())
    assert edited.origin == "codesys"
    assert sfc.equivalent(back.pou("Main"), edited.pou("Main"), limit=2).equal
