"""Charts of blocks with VAR_IN_OUT, pointers, references, methods and EXTENDS together: they run, lowered as well."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import SimulationError
from plcopen_sfc.model import Project
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.inputs import RandomInputs

TEXT = """TYPE Pair : STRUCT a : INT; b : BOOL; END_STRUCT; END_TYPE
FUNCTION_BLOCK Inner
VAR_INPUT x : INT; go : BOOL; END_VAR VAR_OUTPUT y : INT; done : BOOL; END_VAR VAR_IN_OUT io : INT; END_VAR
METHOD Init : BOOL
VAR_INPUT a : INT; END_VAR
y := a; Init := TRUE;
END_METHOD
y := y + x; done := go; io := io + 1;
END_FUNCTION_BLOCK
FUNCTION_BLOCK Base
VAR_INPUT bi : BOOL; END_VAR VAR_IN_OUT bio : BOOL; bs : Pair; END_VAR VAR_OUTPUT bq : BOOL; END_VAR
VAR bn : INT; END_VAR
METHOD Count : BOOL
VAR_INPUT a : INT; END_VAR
bn := bn + a; bs.a := bn; Count := bio;
END_METHOD
bq := bi; bio := NOT bio;
END_FUNCTION_BLOCK
FUNCTION_BLOCK Main EXTENDS Base
VAR_INPUT go : BOOL; n : INT; END_VAR
VAR_IN_OUT io : INT; ib : BOOL; s : Pair; f : Inner; arr : ARRAY [0..3] OF INT; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
VAR p : POINTER TO INT; r : REFERENCE TO INT; ps : POINTER TO Pair; pf : POINTER TO Inner; rf : REFERENCE TO Inner;
own : Inner; here : Pair; loc : INT; END_VAR
INITIAL_STEP A: Act(P1); %(target)s(N); END_STEP
TRANSITION FROM A TO B := %(condition)s; END_TRANSITION
STEP B: Act(N); END_STEP
TRANSITION FROM B TO A := go; END_TRANSITION
ACTION Act: %(action)s END_ACTION
END_FUNCTION_BLOCK
PROGRAM User
VAR m : Main; v : INT; b, b2 : BOOL; s, s2 : Pair; f : Inner; a : ARRAY [0..3] OF INT; x : BOOL; END_VAR
m(go := x, io := v, ib := b, s := s, f := f, arr := a, bio := b2, bs := s2);
END_PROGRAM
"""
CONDITIONS = """ib|s.b|f.done|arr[1] > 2|io > 3|own.done|bio|bs.b|bi|THIS^.go|Count(a := 1)|THIS^.Count(a := 1)
SUPER^.Count(a := 1)|A.x|bn > 2""".replace("\n", "|").split("|")
ACTIONS = """io := io + 1;|ib := NOT ib;|s.a := s.a + 1; s.b := go;|f(x := n, go := go, io := io);|f.Init(a := n);
arr[1] := arr[1] + 1;|p := ADR(io); p^ := 4;|r REF= io; r := r + 1; q := r > 3;|ps := ADR(s); ps^.b := TRUE; ps^.a := 1;
pf := ADR(f); pf^.Init(a := 1);|rf REF= f; rf.Init(3);|own(x := 1, go := go, io := loc);|SUPER^();|SUPER^.Count(a := 2);
THIS^.Count(a := 2);|Count(a := 3);|bn := bn + 1;|bs := s;|s := bs;|here := s; s := here;
IF go THEN RETURN; END_IF; io := 1;
THIS^.io := 7;|f(io := arr[2]);""".replace("\n", "|").split("|")
TARGETS = "q ib s.b bio bq f.go bs.b own.go here.b".split()


def project_of(condition: str = "go", action: str = "q := TRUE;", target: str = "q") -> Project:
    text = TEXT % {"condition": condition, "action": action, "target": target}
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    return project


@pytest.mark.slow
@pytest.mark.parametrize(
    "options",
    [
        *({"condition": each} for each in CONDITIONS),
        *({"action": each} for each in ACTIONS),
        *({"target": each} for each in TARGETS),
    ],
    ids=lambda options: next(iter(options.values())),
)
def test_a_chart_runs_on_its_own_and_called_and_lowered(options: dict[str, str]) -> None:
    project = project_of(**options)
    run = RandomInputs(1)
    for pou in ("Main", "User"):
        assert len(sfc.simulate(project, pou=pou, inputs=run, scans=20)) == 20
    chart = sfc.simulate(project, pou="Main", inputs=run, scans=20, record=["q", "io", "bn"])
    # bits and flip-flops evaluate a condition in every scan, so one that calls what counts is for a CASE only
    acting = "Count(" in options.get("condition", "")
    for construction, language in [("case", "ST")] if acting else [("flipflop", "FBD"), ("bits", "ST")]:
        made = sfc.lower(project, construction, pou="Main", language=language, verify=False)
        code = sfc.simulate(made.project, pou="Main", inputs=run, scans=20, record=["q", "io", "bn"], profile="codesys")
        assert [list(code[name]) for name in ("q", "io", "bn")] == [list(chart[name]) for name in ("q", "io", "bn")]


@pytest.mark.parametrize("condition", ["p^ > 1", "ps^.b", "r > 1", "rf.done", "pf^.y > 2"])
def test_a_pointer_that_leads_nowhere_is_an_error_with_its_place(condition: str) -> None:
    with pytest.raises(SimulationError, match="leads to nothing") as caught:
        sfc.simulate(project_of(condition), pou="Main", scans=3)
    assert caught.value.location.path == "Main / transition A -> B"
