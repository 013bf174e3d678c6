"""Step times in texts: of a step that was left the time stays as it was, until it is active again."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.lowering import Construction, Language
from plcopen_sfc.lowering.code.code_declarations import Naming
from plcopen_sfc.lowering.code.lowered_code import LoweredCode
from plcopen_sfc.lowering.code_texts import Texts
from plcopen_sfc.lowering.construction import construct
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.lowering.reading.step_variables import StepTimers
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.profile import PROFILES
from tests.lowering.charts import act
from tests.lowering.test_executing import chain, chart

FORMS = [
    (Construction.CASE, Language.ST),
    (Construction.BITS, Language.ST),
    (Construction.FLIPFLOP, Language.FBD),
    (Construction.FLIPFLOP, Language.LD),
]


def proves(pou: m.Pou, profile: str) -> None:
    for construction, language in FORMS:
        rules = LoweringRules(PROFILES[profile], Texts())
        made = construct(pou, chart(pou), Dialect.IEC, rules, construction=construction, language=language)
        found = equivalent(pou, made.pou, profile, step_flags=made.step_flags, cap=600, runs=20, scans=60)
        assert not found.different, f"{construction} {language}: {found}"


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_conditions_of_other_steps(profile: str) -> None:
    pou = chain("S1>S2 S2>S1 S2>S3 S3>S1")
    chart(pou).transitions[1].condition = m.Expression(text="S1.T >= T#30ms AND c2")
    chart(pou).transitions[2].condition = m.Expression(text="S1.T < T#30ms AND c3")
    proves(pou, profile)


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_conditions_of_actions_and_what_actions_execute(profile: str) -> None:
    pou = chain("S1>S2 S2>S1 S2>S2", {"A": "r := S1.T > T#20ms;"})
    act(chart(pou), chart(pou).step("S2"), "q", condition="S1.T >= T#30ms OR S2.T >= T#20ms")
    act(chart(pou), chart(pou).step("S1"), "A")
    proves(pou, profile)


def test_nothing_is_kept_for_a_condition_of_the_step_itself() -> None:
    pou = chain("S1>S2 S2>S1")
    chart(pou).transitions[0].condition = m.Expression(text="S1.T >= T#30ms")
    rules = LoweringRules(PROFILES["iec"], Texts())
    made = construct(pou, chart(pou), Dialect.IEC, rules)
    assert made.pou.interface is not None
    assert [v.name for v in made.pou.interface.sections[-1].variables] == ["step_number", "X1_time"]


def test_what_was_said_of_a_time_holds_whatever_is_asked_later() -> None:
    times = StepTimers(LoweredCode(Naming(Dialect.IEC, ())), lambda _: n.Name("X1"), lambda _: "X1_time")
    short, long = n.Literal("T#20ms"), n.Literal("T#40ms")
    asked = [times.is_over(0, short), times.is_over(0, long), times.elapsed(0), times.is_over(0, short)]
    told = [print_node(value, Dialect.IEC) for value in asked]
    assert told == ["X1_time.Q", "X1_time_2.Q", "X1_time_3.ET", "X1_time_3.ET >= T#20ms"]
    assert [print_node(each, Dialect.IEC) for each in times.calls()] == [
        "X1_time(IN := X1, PT := T#20ms);",
        "X1_time_2(IN := X1, PT := T#40ms);",
        "X1_time_3(IN := X1, PT := T#24d);",
    ]
    assert len(times.ends()) == len(times.restarts(0, n.Name("again"))) == 3


def test_times_that_no_timer_reaches_are_refused() -> None:
    text = b"""PROGRAM Main
    VAR a : BOOL; END_VAR
    INITIAL_STEP S0: END_STEP
    STEP S1: END_STEP
    TRANSITION FROM S0 TO S1 := S0.T >= T#24d; END_TRANSITION
    TRANSITION FROM S1 TO S0 := a AND S1.T >= T#25d; END_TRANSITION
    END_PROGRAM"""
    with pytest.raises(LoweringError, match="a step time is compared with T#25d"):
        sfc.lower(sfc.loads(text, format="iec-text"), "case", language="ST")
