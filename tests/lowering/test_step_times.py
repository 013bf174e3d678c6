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
from plcopen_sfc.lowering.code.lowered_code import LoweredCode, Naming
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
        rules = LoweringRules(PROFILES[profile], construction=construction, language=language)
        made = construct(pou, chart(pou), Dialect.IEC, rules)
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
    rules = LoweringRules(PROFILES["iec"])
    made = construct(pou, chart(pou), Dialect.IEC, rules)
    assert made.pou.interface is not None
    assert [v.name for v in made.pou.interface.sections[-1].variables] == ["step_number", "X1_time"]


def test_what_was_said_of_a_time_holds_whatever_is_asked_later() -> None:
    times = StepTimers(LoweredCode(Naming(Dialect.IEC, ())), lambda _: n.Name("X1"), lambda _: "X1_time")
    short, long = n.Literal("T#20ms"), n.Literal("T#40ms")
    asked = [times.is_over(0, short), times.is_over(0, long), times.elapsed(0), times.is_over(0, short)]
    told = [print_node(value) for value in asked]
    assert told == ["X1_time.Q", "X1_time_40ms.Q", "X1_time_2.ET", "X1_time_2.ET >= T#20ms"]
    assert [print_node(each) for each in times.calls()] == [
        "X1_time(IN := X1, PT := T#20ms);",
        "X1_time_40ms(IN := X1, PT := T#40ms);",
        "X1_time_2(IN := X1, PT := T#24d);",
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


TIMED = """PROGRAM Main
VAR_INPUT a : BOOL; b : BOOL; {flags} END_VAR
VAR_OUTPUT q : BOOL; p : BOOL; n : INT; END_VAR
INITIAL_STEP S1: q (D, T#20ms); END_STEP
STEP S2: {second} END_STEP
STEP S3: p (L, T#30ms); END_STEP
TRANSITION FROM S1 TO S2 := a AND S1.T >= T#10ms; END_TRANSITION
TRANSITION FROM S2 TO S3 := S2.T >= T#20ms OR b; END_TRANSITION
TRANSITION FROM S3 TO S1 := a; END_TRANSITION
ACTION Count: n := (n + 1) MOD 3; END_ACTION
END_PROGRAM"""


def timed(profile: str, *, flags: str = "", second: str = "", construction: str = "case") -> sfc.LoweredPou:
    text = TIMED.format(flags=flags, second=second)
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS if flags else project.dialect  # which has flags
    made = sfc.lower(project, construction, profile=profile, scan_time="T#10ms")
    assert made.proof is not None
    assert made.proof.proven, str(made.proof)
    return made


def timers_of(made: sfc.LoweredPou) -> list[str]:
    return [v.name for v in made.pou.variables() if isinstance(v.type, m.DerivedType) and v.type.name == "TON"]


@pytest.mark.parametrize("profile", ["iec", "codesys", "matiec"])
def test_steps_of_a_case_have_one_timer_together(profile: str) -> None:
    assert timers_of(timed(profile)) == ["step_time"]


def test_quitting_an_error_leaves_times_of_actions() -> None:
    made = timed("codesys", flags="SFCQuitError : BOOL; SFCError : BOOL;")
    assert timers_of(made) == ["step_time", "p_L", "q_D"]


@pytest.mark.parametrize("qualifier", ["P", "S"])
def test_one_helper_remembers_a_final_scan(qualifier: str) -> None:
    made = timed("codesys", second=f"Count ({qualifier});")
    (helper,) = [v.name for v in made.pou.variables() if v.name.startswith("Count")]
    assert helper == {"P": "Count_before", "S": "Count_S"}[qualifier]
