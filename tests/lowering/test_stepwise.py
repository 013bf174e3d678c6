"""Charts as matiec executes them: each association acts on its own, competing transitions fire together.

Only priority numbers prevent that.
"""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import ActionPlace, Construction, Language
from plcopen_sfc.lowering.construction import Constructed, construct
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.profile import PROFILES, Profile
from tests.analysis.nets import block_chart
from tests.lowering.charts import act, pou_with
from tests.lowering.test_executing import chain, chart

MATIEC = PROFILES["matiec"]
FORMS = [
    (Construction.AUTO, Language.ST),
    (Construction.BITS, Language.ST),
    (Construction.FLIPFLOP, Language.FBD),
]


def lowered(
    pou: m.Pou,
    construction: Construction = Construction.AUTO,
    language: Language = Language.ST,
    profile: Profile = MATIEC,
    actions: ActionPlace = ActionPlace.INLINE,
) -> Constructed:
    rules = LoweringRules(profile, construction=construction, language=language, actions=actions)
    return construct(pou, chart(pou), Dialect.IEC, rules)


def verdict(pou: m.Pou, construction: Construction, language: Language, cap: int = 200) -> Verdict:
    made = lowered(pou, construction, language)
    return equivalent(pou, made.pou, MATIEC, step_flags=made.step_flags, cap=cap, runs=8, scans=40)


@pytest.mark.slow
@pytest.mark.parametrize(("construction", "language"), FORMS)
@pytest.mark.parametrize("qualifier", ["N", "S", "P", "P1", "P0", "L", "D", "SD", "DS", "SL"])
def test_every_qualifier(qualifier: str, construction: Construction, language: Language) -> None:
    pou = chain("S1>S2 S2>S3 S3>S1 S3>S2")
    chart(pou).transitions[2].priority = 1
    for name in ("S1", "S3"):  # S1 is active at the start, which is no activation
        act(chart(pou), chart(pou).step(name), "q", m.Qualifier(qualifier), duration="T#20ms", condition="r")
    act(chart(pou), chart(pou).step("S2"), "q", m.Qualifier.R)
    assert pou.interface is not None
    pou.interface.sections[0].variables.append(pou.interface.sections[1].variables.pop(-1))  # r is an input
    found = verdict(pou, construction, language)
    assert not found.different, str(found)


@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_competing_transitions_fire_together_unless_numbered(construction: Construction, language: Language) -> None:
    pou = chain("S1>S2 S1>S3 S1>S4 S2>S1 S3>S1 S4>S3")
    assert lowered(pou).construction is Construction.BITS
    assert verdict(pou, construction, language, 5_000).kind is VerdictKind.PROVEN
    chart(pou).transitions[1].priority = 1
    assert verdict(pou, construction, language, 5_000).kind is VerdictKind.PROVEN
    chart(pou).transitions[0].priority = 2  # before, it was tested first, and did not lock out the one with a number
    assert lowered(pou).construction is Construction.CASE
    assert verdict(pou, construction, language, 5_000).kind is VerdictKind.PROVEN


@pytest.mark.slow
@pytest.mark.parametrize(("construction", "language"), FORMS)
@pytest.mark.parametrize("seed", range(5))
def test_random_charts(seed: int, construction: Construction, language: Language) -> None:
    random = Random(seed)  # noqa: S311
    made = block_chart(seed, 6)
    for number, transition in enumerate(made.transitions, 1):
        transition.condition = m.Expression(text=f"c{number}")
        transition.priority = random.choice([None, 1, 2])
    for step in made.steps:
        qualifier = m.Qualifier(random.choice(["N", "S", "R", "P", "P1", "P0", "L", "D", "SD", "DS", "SL"]))
        act(made, step, random.choice(["q1", "q2"]), qualifier, duration="T#20ms")
    found = verdict(pou_with(made), construction, language)
    assert not found.different, str(found)


@pytest.mark.parametrize(("edges", "initial"), [("S1>S1 S1>S2 S2>S1", "S1"), ("S1>S2 S2>S3 S3>S2", "S1+S2")])
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_a_delayed_action_stays_when_the_time_of_its_step_begins_again(
    edges: str, initial: str, construction: Construction, language: Language
) -> None:
    """The association decides on nothing then: what it has written stays."""
    pou = chain(edges)
    for name in initial.split("+"):
        chart(pou).step(name).initial = True
        act(chart(pou), chart(pou).step(name), f"d{name}", m.Qualifier.D, duration="T#20ms")
    outputs = [m.Variable(name=f"d{name}", type="BOOL") for name in initial.split("+")]
    assert pou.interface is not None
    pou.interface.sections.append(m.VariableSection(kind=m.SectionKind.OUTPUT, variables=outputs))
    found = verdict(pou, construction, language, cap=5_000)
    assert found.kind is VerdictKind.PROVEN, str(found)
    assert {f"d{name}" for name in initial.split("+")} <= set(found.compared)


@pytest.mark.parametrize("language", list(Language))
def test_flip_flops_of_charts_that_are_not_safe(language: Language) -> None:
    """A step that is left and entered at once stays active although the reset dominates."""
    pou = chain("S1>S2 S2>S3 S3>S1")
    chart(pou).step("S2").initial = True
    made = lowered(pou, Construction.FLIPFLOP, language, PROFILES["iec"])
    found = equivalent(pou, made.pou, "iec", step_flags=made.step_flags)
    assert found.kind is VerdictKind.PROVEN, str(found)


def test_what_cannot_be_said_is_refused() -> None:
    pou = chain("S1>S2 S2>S1")
    act(chart(pou), chart(pou).step("S1"), "q", m.Qualifier.SL, duration="T#20ms")
    with pytest.raises(LoweringError, match="R does not end the times"):
        lowered(pou, profile=replace(PROFILES["iec"], name="ours", reset_cancels_delays=False))
    with pytest.raises(LoweringError, match="ours holds the initial situation"):
        lowered(pou, profile=replace(PROFILES["iec"], name="ours", initial_situation_held=True))
    chart(pou).step("S1").actions.clear()
    chart(pou).step("S1").entry_action = m.StBody(text="q := TRUE;")
    with pytest.raises(LoweringError, match="entry action of an initial step"):
        lowered(pou)
    chart(pou).step("S1").entry_action = None
    chart(pou).step("S1").negated = True
    act(chart(pou), chart(pou).step("S1"), "q", m.Qualifier.D, duration="T#20ms")
    with pytest.raises(LoweringError, match="by the time of one step"):
        lowered(pou)
