"""The variables of two programs that are compared, and the inputs that they share."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.model import Project


def project(variables: str, *, action: str = "", target: str = "", name: str = "Main", go: str = "a") -> Project:
    """A chart of two steps, of which the second one has an action."""
    text = f"""
    PROGRAM {name} VAR_INPUT {"a, " if go == "a" else ""}b : BOOL; END_VAR VAR {variables} END_VAR
    INITIAL_STEP Rest: END_STEP
    TRANSITION FROM Rest TO Run := {go}; END_TRANSITION
    STEP Run: {target or "Fill(N)"}; END_STEP
    TRANSITION FROM Run TO Rest := b; END_TRANSITION
    ACTION Fill: {action or ";"} END_ACTION
    END_PROGRAM"""
    return sfc.loads(text.encode(), format="iec-text")


def compare(one: Project, other: Project) -> Verdict:
    return equivalent(one.pous[0], other.pous[0], "iec")


@pytest.mark.parametrize("area", ["Q", "M"])
def test_what_is_written_to_an_address_is_compared(area: str) -> None:
    address = f"%{area}X0.0"
    direct = project("", action=f"{address} := TRUE;")
    placed = project(f"q AT {address} : BOOL;", target="q(N)")
    renamed = project(f"valve AT {address} : BOOL;", target="valve(N)", name="Other")
    stored = project(f"valve AT {address} : BOOL;", target="valve(S)")
    idle = project(f"q AT {address} : BOOL;")
    assert compare(placed, renamed).proven
    assert compare(direct, direct).compared == (address, "Rest.X", "Run.X")
    for other in (stored, idle):
        verdict = compare(placed, other)
        assert verdict.different, str(verdict)
    assert compare(direct, project("", action=f"{address} := FALSE;")).different
    assert compare(direct, project(f"q AT {address} : BOOL;", action="q := TRUE;")).proven
    assert compare(direct, project(f"q AT {address} : BOOL;", action="q := FALSE;")).different


def test_what_is_wired_to_the_machine_counts_more_than_a_name() -> None:
    one = project("q AT %QX0.0 : BOOL; r AT %QX0.1 : BOOL;", target="q(N)")
    swapped = project("q AT %QX0.1 : BOOL; r AT %QX0.0 : BOOL;", target="q(N)")
    assert compare(one, swapped).different
    moved = project("q AT %QX7.0 : BOOL;", target="q(N)")
    assert compare(one, moved).uncompared == ("Main.r",)
    assert compare(one, project("q : BOOL;", target="q(S)")).different


def test_inputs_at_the_same_address_are_the_same() -> None:
    one = project("q AT %QX0.0 : BOOL; start AT %IX0.0 : BOOL;", target="q(N)", go="start")
    assert compare(one, project("q AT %QX0.0 : BOOL;", target="q(N)", go="%IX0.0")).proven
    other = project("r AT %QX0.0 : BOOL; go AT %IX0.0 : BOOL;", target="r(N)", go="go", name="Other")
    assert compare(one, other).proven
    moved = project("q AT %QX0.0 : BOOL; start AT %IX0.1 : BOOL; x AT %IX0.0 : BOOL;", target="q(N)", go="start AND x")
    assert compare(one, moved).different


def test_elements_of_arrays_are_compared() -> None:
    one = project("f : ARRAY[1..2, 0..1] OF INT;", action="f[2, 0] := 3;")
    verdict = compare(one, project("f : ARRAY[1..2, 0..1] OF INT;", action="f[2, 0] := 4;"))
    assert verdict.counterexample is not None
    assert [each.name for each in verdict.counterexample.differences] == ["f[2,0]"]
    large = project("f : ARRAY[0..999] OF INT;", action="f[0] := 3;")
    verdict = compare(large, project("f : ARRAY[0..999] OF INT;", action="f[0] := 4;"))
    assert (verdict.kind, verdict.uncompared) == (VerdictKind.UNTESTED, ("f",))
    assert verdict.gap == "arrays of more than 256 elements are not compared: f"
    assert "not compared: f" in str(verdict).splitlines()
    nested = project("f : ARRAY[0..19] OF ARRAY[0..19] OF INT;", action="f[0][0] := 3;")
    verdict = compare(nested, project("f : ARRAY[0..19] OF ARRAY[0..19] OF INT;", action="f[0][0] := 4;"))
    assert (verdict.kind, verdict.uncompared) == (VerdictKind.UNTESTED, ("f",))
    table = project("f : ARRAY[0..999] OF INT; i : INT;", action="i := f[3];")
    assert compare(table, table).proven  # nothing writes it


@pytest.mark.parametrize(
    ("inside", "body"),
    [
        ("s : Bag; f : Filler;", "s.a[k] := 1;"),
        ("s : Bag; f : Filler;", "s.bags[1].a[2] := 1;"),
        ("f : Filler; s : Bag;", "f(i := k);"),
    ],
)
def test_large_arrays_that_are_written_in_structures_and_instances_are_named(inside: str, body: str) -> None:
    text = f"""TYPE Bag : STRUCT a : ARRAY[0..299] OF INT; bags : ARRAY[0..299] OF Inner; END_STRUCT; END_TYPE
    TYPE Inner : STRUCT a : ARRAY[0..9] OF INT; END_STRUCT; END_TYPE
    FUNCTION_BLOCK Filler VAR_INPUT i : INT; END_VAR VAR a : ARRAY[0..299] OF INT; END_VAR a[2] := i; END_FUNCTION_BLOCK
    PROGRAM Main VAR_INPUT k : USINT; END_VAR VAR_OUTPUT q : INT; END_VAR VAR {inside} END_VAR
    q := k; {body} END_PROGRAM"""
    whole = sfc.loads(text.encode(), format="iec-text")
    main = whole.pou("Main")
    verdict = equivalent(main, main, "iec", runs=1, scans=20)
    assert verdict.kind is VerdictKind.UNTESTED
    assert verdict.gap.startswith("arrays of more than 256 elements are not compared: ")
    assert equivalent(main, main, "iec", outputs=["q"], runs=1, scans=20).gap == ""


def test_a_comparison_of_nothing_that_is_written_is_not_equal() -> None:
    def local(variable: str, value: str) -> Project:
        text = f"""PROGRAM Main VAR_INPUT n : INT; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR {variable} : INT; END_VAR
        {value} END_PROGRAM"""
        return sfc.loads(text.encode(), format="iec-text")

    verdict = compare(local("x", "x := n;"), local("y", "y := n + 1;"))
    assert (verdict.kind, verdict.gap) == (VerdictKind.UNTESTED, "nothing of what they write is compared")
    assert str(verdict).startswith("not all was compared, equal in ")
    assert compare(local("x", ""), local("y", "")).proven


def test_variables_of_global_lists_are_compared() -> None:
    made = [project("", action=f"q := {value};") for value in ("TRUE", "FALSE")]
    globals_ = sfc.loads(b"VAR_GLOBAL q : BOOL; END_VAR FUNCTION F : INT F := 1; END_FUNCTION", format="iec-text")
    for each in made:
        each.global_variables = [s.model_copy(deep=True, update={"name": "GVL"}) for s in globals_.global_variables]
    verdict = compare(*made)
    assert verdict.counterexample is not None
    assert "GVL.q is TRUE in the first and FALSE in the second" in str(verdict)


def test_a_variable_that_hides_a_global_one_is_another_input() -> None:
    """S7 has global variables of no list in a data block, which is named with them."""

    def block(condition: str) -> Project:
        text = f"""DATA_BLOCK "GlobalVariables" VAR Ready : Bool; END_VAR BEGIN END_DATA_BLOCK
        FUNCTION_BLOCK "Main" VAR_INPUT Ready : Bool; END_VAR VAR_OUTPUT Q : Bool; END_VAR
        BEGIN #Q := {condition}; END_FUNCTION_BLOCK"""
        return sfc.loads(text.encode(), format="scl")

    own, shared = block("#Ready"), block('"GlobalVariables".Ready')
    verdict = equivalent(own.pous[0], shared.pous[0], "iec")
    assert verdict.different, str(verdict)
    assert equivalent(shared.pous[0], shared.pous[0], "iec").proven


@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("condition", ["b", "FALSE"])
def test_steps_of_charts_that_are_actions_are_compared(profile: str, condition: str) -> None:
    def nested(inner: str) -> Project:
        made = project("", name="Main")
        sub = project("", go=inner, name="Sub").pous[0]
        made.pous[0].actions[0].body = sub.bodies[0].model_copy(deep=True)
        made.pous[0].actions[0].body.chart.steps[1].actions.clear()  # type: ignore[union-attr]
        return made

    one = nested("a AND NOT b")
    same = equivalent(one.pous[0], nested("a AND NOT b").pous[0], profile)
    assert same.proven
    assert {"Fill.Rest.X", "Fill.Run.X"} <= set(same.compared)
    assert equivalent(one.pous[0], nested(condition).pous[0], profile).different


def test_an_output_that_only_the_first_writes_is_not_called_equal() -> None:
    one = project("q AT %QX0.0 : BOOL; r AT %QX0.1 : BOOL;", target="q(N); r(N)")
    other = project("q AT %QX0.0 : BOOL;", target="q(N)")
    verdict = compare(one, other)
    assert (verdict.kind, verdict.gap, verdict.uncompared) == (
        VerdictKind.UNTESTED,
        "only the first has Main.r",
        ("Main.r",),
    )
    assert compare(other, one).proven  # what is added
    idle = project("q AT %QX0.0 : BOOL; r AT %QX0.1 : BOOL;", target="q(N)")
    assert compare(idle, other).proven  # nothing writes it
