"""Edits of the text of a converted source win over what its comments keep."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.conversion import compare, executed

TEXT = """
TYPE
  Mode : (Off, Auto, Manual) := Auto;
  Rec : STRUCT
    m : Mode;
  END_STRUCT;
  Arr : ARRAY[1..3] OF Mode;
END_TYPE
FUNCTION_BLOCK Chart
  VAR_INPUT a : BOOL; mi : Mode; END_VAR
  VAR r : Rec; ar : Arr; ar2 : ARRAY[0..1] OF Mode; n : INT; END_VAR
  INITIAL_STEP S1: Act(N); END_STEP
  TRANSITION FROM S1 TO S2 := a AND mi = Auto; END_TRANSITION
  STEP S2: END_STEP
  TRANSITION FROM S2 TO S1 := NOT a; END_TRANSITION
  ACTION Act: n := 1; END_ACTION
END_FUNCTION_BLOCK
"""


def written() -> str:
    project = sfc.loads(TEXT.encode(), format="iec-text")
    return sfc.dumps(project, format="scl", partial=True).decode("utf-8-sig").replace("\r\n", "\n")


def test_nothing_is_outdated_as_it_was_written() -> None:
    project = sfc.loads(written().encode(), format="scl")
    assert not project.diagnostics
    assert next(iter(project.charts())).chart.steps[0].name == "S1"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("mi : Int := 1;", "mi : Int := 2;"),
        ("mi : Int := 1;", "mi : DInt := 1;"),
        ("mi : Int := 1;", "mi : Int;"),
        ("      m : Int := 1;", "      m : Int := 2;"),
        ("ar : Array[1..3] of Int", "ar : Array[1..4] of Int"),
        ("[3(1)]", "[3(2)]"),
        ("[2(1)]", "[1, 2]"),
        ("Value : Array[1..3] of Int;", "Value : Array[0..3] of Int;"),
        ("BEGIN\n", "BEGIN\n   #n := 7;\n"),
    ],
)
def test_what_the_text_executes_is_read(old: str, new: str) -> None:
    before, edited = written().encode(), written().replace(old, new).encode()
    assert before != edited
    seen = [*compare(*(executed(sfc.loads(each, format="scl", as_tool=True)) for each in (before, edited)))]
    read = [*compare(*(executed(sfc.loads(each, format="scl")) for each in (before, edited)))]
    assert seen
    assert {(each.path, each.right) for each in seen} <= {(each.path, each.right) for each in read} or any(
        each.aspect == "type" or each.kind == "chart" for each in read
    )
    findings = sfc.loads(edited, format="scl").diagnostics
    assert {finding.code for finding in findings} == {"SCL203"}
    assert all("left out" in finding.message for finding in findings)
