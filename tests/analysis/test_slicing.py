"""Slices: the statements that the value of a variable depends on, as a program."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis.program_parts import NotDivisibleError, cone, parts_of
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.analysis.timers import clocking
from plcopen_sfc.model import ActionAssociation, Pou, Qualifier, SfcNetwork, StBody
from plcopen_sfc.semantics.profile import profile
from plcopen_sfc.semantics.programs.controller import Instance
from plcopen_sfc.semantics.subjects import resolve
from tests.analysis.schemes import program
from tests.lowering.sequencers import act as act_of_s7
from tests.lowering.sequencers import block, guarded


def instance(subject: Pou | SfcNetwork | sfc.Project, name: str = "iec") -> Instance:
    resolved = resolve(subject) if not isinstance(subject, sfc.Project) else resolve(subject, "Code")
    return ProgramSystem(resolved, profile(name), clocking([resolved], None)).instance


def taken(subject: Pou | SfcNetwork | sfc.Project, names: Iterable[str], *, under: str = "iec") -> Pou:
    parts = parts_of(instance(subject, under))
    return parts.taken(cone(parts.parts, names))


def text_of(pou: Pou) -> str:
    assert isinstance(pou.body, StBody)
    return " ".join(pou.body.text.split())


VARIABLES = ["a, b, c, d : BOOL", "n, m : INT", "t : TON", "e : R_TRIG", "f : ARRAY [0..3] OF BOOL"]


def body(text: str, names: Iterable[str]) -> str:
    return text_of(taken(program(text, ["i", "k"], VARIABLES), names))


@pytest.mark.parametrize(
    ("text", "name", "kept"),
    [
        ("a := i; b := k;", "a", "a := i;"),
        ("c := d; a := c; d := i; b := k;", "a", "c := d; a := c; d := i;"),
        ("IF c THEN a := i; b := k; END_IF; c := k; d := i;", "b", "IF c THEN b := k; END_IF; c := k;"),
        (
            "IF c THEN d := i; ELSIF d THEN a := k; ELSE b := i; END_IF;",
            "a",
            "IF c THEN d := i; ELSIF d THEN a := k; END_IF;",
        ),
        (
            "CASE n OF 1: a := i; 2..3: b := k; ELSE n := 1; END_CASE;",
            "b",
            "CASE n OF 1: ; 2..3: b := k; ELSE n := 1; END_CASE;",
        ),
        ("CASE m OF 1: a := i; 2: b := k; END_CASE;", "b", "CASE m OF 1: ; 2: b := k; END_CASE;"),
        ("t(IN := a, PT := T#1s); a := i; b := t.Q; c := k;", "b", "t(IN := a, PT := T#1s); a := i; b := t.Q;"),
        ("e(CLK := i, Q => a); b := a; c := k;", "b", "e(CLK := i, Q => a); b := a;"),
        ("a := i; b := k;", "unknown", ""),
    ],
)
def test_statements_that_a_variable_depends_on(text: str, name: str, kept: str) -> None:
    assert body(text, [name]) == kept


@pytest.mark.parametrize(
    "statement",
    [
        "n := m / n;",
        "n := m MOD 3;",
        "n := m * m;",
        "f[n] := k;",
        "n := REAL_TO_INT(1.5);",
        "IF k THEN RETURN; END_IF;",
        "WHILE k DO n := n + 1; END_WHILE;",
        "IF m / n > 3 THEN ; END_IF;",
    ],
)
def test_what_may_fail_or_ends_the_scan_is_always_kept(statement: str) -> None:
    assert body(f"a := i; {statement} b := k; m := 2;", ["a"]).startswith(f"a := i; {statement[:6]}")
    assert "b := k" not in body(f"a := i; {statement} b := k; m := 2;", ["a"])
    if "m " in statement:
        assert "m := 2" in body(f"a := i; {statement} b := k; m := 2;", ["a"])


def test_global_variables_have_two_names() -> None:
    text = """
    VAR_GLOBAL g : BOOL; h : BOOL; END_VAR
    PROGRAM Code VAR_INPUT i : BOOL; END_VAR VAR a, b : BOOL; END_VAR
    a := Globals.g; g := Globals.h; h := i; b := i;
    END_PROGRAM
    """
    project = sfc.loads(text.encode(), format="iec-text")
    project.global_variables[0].name = "Globals"
    assert text_of(taken(project, ["a"])) == "a := Globals.g; g := Globals.h; h := i;"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("p := ADR(a); a := i;", "references"),
        ("p^ := i;", "references"),
        ("%MX0.0 := i; a := %M0.0;", "addresses"),
        ("Other();", "not known"),
        ("a := i; JMP there; there: b := k;", "jumps"),
    ],
)
def test_what_is_not_known_is_not_divided(text: str, reason: str) -> None:
    source = f"""
    FUNCTION_BLOCK Inner VAR_EXTERNAL g : BOOL; END_VAR g := TRUE; END_FUNCTION_BLOCK
    PROGRAM Code VAR_INPUT i, k : BOOL; END_VAR VAR a, b : BOOL; p : POINTER TO BOOL; Other : Inner; END_VAR
    {text}
    END_PROGRAM
    """
    project = sfc.loads(source.encode(), format="iec-text")
    with pytest.raises(NotDivisibleError, match=f"{reason}|cannot be executed"):
        taken(project, ["a"])


def test_variables_at_one_address_are_not_divided() -> None:
    source = """
    PROGRAM Code VAR_INPUT i : BOOL; END_VAR VAR a AT %MX0.0 : BOOL; b AT %MX0.0 : BOOL; c : BOOL; END_VAR
    a := i; c := b;
    END_PROGRAM
    """
    with pytest.raises(NotDivisibleError, match="same address"):
        taken(sfc.loads(source.encode(), format="iec-text"), ["c"])


# -- charts


def two_rings() -> SfcNetwork:
    chart = SfcNetwork()
    for ring in "AB":
        steps = [chart.add_step(f"{ring}{number}", initial=number == 0) for number in range(2)]
        chart.add_transition(steps[0], steps[1], f"c{ring}")
        chart.add_transition(steps[1], steps[0], f"d{ring}")
    return chart


def act(chart: SfcNetwork, step: str, target: str, qualifier: Qualifier = Qualifier.N) -> ActionAssociation:
    association = ActionAssociation(id=chart.new_id(), qualifier=qualifier, target=target)
    chart.step(step).actions.append(association)
    return association


def steps_and_targets(pou: Pou) -> tuple[list[str], list[str | None]]:
    assert pou.sfc is not None
    return [step.name for step in pou.sfc.steps], [a.target for step in pou.sfc.steps for a in step.actions]


def test_nets_that_nothing_connects_are_parts() -> None:
    chart = two_rings()
    act(chart, "A1", "q")
    act(chart, "B1", "r")
    assert steps_and_targets(taken(chart, ["q"])) == (["A0", "A1"], ["q"])
    assert steps_and_targets(taken(chart, ["b0"])) == (["B0", "B1"], [])
    assert steps_and_targets(taken(chart, ["nothing"])) == (["A0", "A1"], [])  # a chart has at least one net
    chart.transitions[0].condition = sfc.model.Expression(text="cA AND B1.X")
    assert steps_and_targets(taken(chart, ["q"])) == (["A0", "A1", "B0", "B1"], ["q"])
    assert steps_and_targets(taken(chart, ["r"])) == (["B0", "B1"], ["r"])


def test_a_condition_that_reads_an_action_needs_all_that_write_it() -> None:
    chart = two_rings()
    act(chart, "A1", "q")
    act(chart, "B1", "q", Qualifier.R)
    act(chart, "B0", "r")
    chart.transitions[0].condition = sfc.model.Expression(text="NOT r")
    assert steps_and_targets(taken(chart, ["q"])) == (["A0", "A1", "B0", "B1"], ["q", "r", "q"])
    act(chart, "A0", "s").condition = sfc.model.Expression(text="q")
    assert steps_and_targets(taken(chart, ["s"]))[1] == ["s", "q", "r", "q"]
    assert steps_and_targets(taken(chart, ["r"])) == (["B0", "B1"], ["r"])


def test_step_actions_and_bodies_are_parts() -> None:
    chart = two_rings()
    step = chart.step("A1")
    step.entry_action = StBody(text="x := NOT x;")
    step.exit_action = StBody(text="y := x;")
    step.main_action = StBody(text="z := NOT z;")
    found = taken(chart, ["y"], under="codesys").sfc
    assert found is not None
    kept = found.step("A1")
    assert kept.entry_action is not None
    assert kept.exit_action is not None
    assert kept.main_action is None


def test_charts_that_act_as_a_whole_are_not_divided() -> None:
    chart = two_rings()
    act(chart, "A1", "q")
    with pytest.raises(NotDivisibleError, match="as a whole"):
        taken(chart, ["q"], under="grafcet")
    flagged = """
    PROGRAM Code VAR_INPUT i : BOOL; SFCInit : BOOL; END_VAR
    INITIAL_STEP S0: END_STEP STEP S1: END_STEP
    TRANSITION FROM S0 TO S1 := i; END_TRANSITION TRANSITION FROM S1 TO S0 := NOT i; END_TRANSITION
    END_PROGRAM
    """
    with pytest.raises(NotDivisibleError, match="as a whole"):
        taken(sfc.loads(flagged.encode(), format="iec-text"), ["s0"], under="codesys")


def test_the_actions_of_a_sequencer_are_parts_beside_one_net() -> None:
    """Interlocks and supervisions hold steps and release actions: they are in every part, as conditions are."""
    chart = guarded(act_of_s7("S", "Q", "L1"), act_of_s7("N", "P"), act_of_s7("CU", "n", "S1"))
    chart.permanent_post = [m.PermanentOperation(body=StBody(text="#R := #S2.X;"))]
    project = block(chart, "ok fault", "P Q R n:INT")

    def kept(*names: str) -> tuple[list[str | None], int, bool]:
        (pou,) = project.pous
        parts = parts_of(ProgramSystem(resolve(pou), profile("s7graph"), clocking([resolve(pou)], None)).instance)
        part = parts.taken(cone(parts.parts, names)).chart
        step = part.step("S2")
        checked = step.interlock is not None and step.supervision is not None
        return [each.target for each in step.actions], len(part.permanent_post), checked

    assert kept("q") == (["#Q"], 0, True)
    assert kept("n") == (["#n"], 0, True)
    assert kept("r") == ([], 1, True)
    assert kept("s2") == ([], 0, True)


@pytest.mark.parametrize("action", [act_of_s7("ON", "S3", "S1"), act_of_s7("TL", "t", "S1", duration="T#1s")])
def test_sequencers_whose_actions_switch_steps_or_run_timers_are_not_divided(action: ActionAssociation) -> None:
    (pou,) = block(guarded(action), "ok fault", "t").pous
    with pytest.raises(NotDivisibleError, match="switches steps, or a timer"):
        parts_of(ProgramSystem(resolve(pou), profile("s7graph"), clocking([resolve(pou)], None)).instance)
