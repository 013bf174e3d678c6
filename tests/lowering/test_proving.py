"""Where there can be no proof, the error says why, and what to do about it."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import lower
from plcopen_sfc.lowering.proof import prove
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.charts import training_chain


def test_texts_that_are_wrong_in_their_types_are_no_error_of_the_lowering() -> None:
    pou = training_chain()
    assert pou.interface is not None
    number = next(variable for variable in pou.interface.variables() if variable.name == "B1")
    number.type = m.ElementaryType(name=m.Elementary.DINT)
    chart = pou.sfc
    assert chart is not None
    chart.transitions[0].condition = m.Expression(text="B1 + 1")
    with pytest.raises(LoweringError, match=r"both end with an error: .*BOOL") as caught:
        lower(pou, "bits", profile="iec")
    assert "check tells more" in str(caught.value)
    assert lower(pou, "bits", profile="iec", verify=False).proof is None


def test_functions_that_nobody_knows_are_named() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.transitions[0].condition = m.Expression(text="Weigh(B1) AND B2")
    lowered = lower(pou, "case", profile="iec")
    assert lowered.proof is not None
    assert lowered.proof.proven
    assert lowered.proof.unknown == ("Weigh",)
    assert "unknown, taken as functions of what they are given: Weigh" in str(lowered)
    assert isinstance(lowered.pou.body, m.StBody)
    assert "Weigh(B1) AND B2" in lowered.pou.body.text


@pytest.mark.parametrize("target", ["plcopen", "codesys"])
@pytest.mark.parametrize(("asked", "equal"), [("On", True), ("Off", False)])
def test_what_nobody_declares_may_have_another_name_in_the_dialect_of_the_code(
    target: str, asked: str, equal: bool
) -> None:
    """IEC 61131-3 takes neither umlauts and blanks nor its own words as names, and the data block is elsewhere."""
    chart = sfc.SfcNetwork()
    first, second = (chart.add_step(name, initial=name == "A") for name in ("A", "B"))
    chart.add_transition(first, second, '"DB_Füllung".Module.On OR "DB_Füllung"."Stufe 1"')
    back_again = chart.add_transition(second, first, 'NOT "DB_Füllung".Module.On')
    pou = m.Pou(name="Fill", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.SfcBody(chart=chart)])
    project = m.Project(dialect=m.Dialect.SCL, pous=[pou])
    lowered = lower(project, "bits", target=target, profile="iec", verify=False)
    written = sfc.loads(sfc.dumps(lowered.project, format=target), format=target, as_tool=True)
    back_again.condition = m.Expression(text=f'NOT "DB_Füllung".Module.{asked}')
    found = prove(
        resolve(project, "Fill"),
        resolve(written, "Fill"),
        lowered.profile,
        fixed={},
        left_out=None,
        step_flags=lowered.step_flags,
    )
    assert found.proven == equal
    assert found.equal == equal


def test_types_of_undeclared_names_do_not_depend_on_the_order_of_the_texts() -> None:
    """The chart compares the name first, its code assigns it first, which tells no type."""
    text = """FUNCTION_BLOCK Main
INITIAL_STEP Wait: END_STEP
STEP Run: Act(N); END_STEP
TRANSITION FROM Wait TO Run := Mode = Modes.Idle; END_TRANSITION
TRANSITION FROM Run TO Wait := Start; END_TRANSITION
ACTION Act:
  Mode := Modes.Idle;
END_ACTION
END_FUNCTION_BLOCK
"""
    chart = sfc.loads(text.encode(), format="iec-text")
    lowered = lower(chart, "case", profile="codesys")
    assert lowered.proof is not None
    assert lowered.proof.proven
    assert sfc.equivalent(lowered.project, chart, profile="codesys").proven


OVER_AT_ONCE = b"""PROGRAM Main VAR_INPUT x, y : BOOL; m : DINT; END_VAR VAR n, sum : DINT; END_VAR
INITIAL_STEP A: END_STEP
STEP B: Act(%s, T#0s); Sum(N); END_STEP
TRANSITION FROM A TO B := x; END_TRANSITION
TRANSITION FROM B TO A := y; END_TRANSITION
ACTION Sum: sum := sum + m / 3; END_ACTION
ACTION Act: n := n + 1; END_ACTION
END_PROGRAM"""


@pytest.mark.parametrize("qualifier", [b"L", b"SL"])
def test_an_action_whose_time_is_over_at_once_has_no_code(qualifier: bytes) -> None:
    """Its code was refused as not reached: a timer of no time kept it from being executed."""
    lowered = lower(sfc.loads(OVER_AT_ONCE % qualifier, format="iec-text"), "bits", cap=200, runs=3, scans=40)
    assert lowered.proof is not None
    assert lowered.proof.equal
    later = (OVER_AT_ONCE % qualifier).replace(b"T#0s", b"T#1s")
    acting = lower(sfc.loads(later, format="iec-text"), "bits", verify=False)
    bodies = [lowered.pou.body, acting.pou.body]
    assert [isinstance(body, m.StBody) and "n := n + 1" in body.text for body in bodies] == [False, True]
