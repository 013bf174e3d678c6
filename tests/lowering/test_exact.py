"""Exact lowerings do what their charts do: proven by search of both together."""

from __future__ import annotations

from random import Random

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, Language
from plcopen_sfc.lowering.construction import construct
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.profile import PROFILES
from tests.analysis.nets import block_chart
from tests.lowering.charts import act, boolean, pou_with, training_chain

FORMS = [
    (Construction.FLIPFLOP, Language.ST),
    (Construction.FLIPFLOP, Language.FBD),
    (Construction.FLIPFLOP, Language.LD),
    (Construction.CASE, Language.ST),
    (Construction.BITS, Language.ST),
]


def verdict(pou: m.Pou, construction: Construction, language: Language, profile: str = "iec") -> Verdict:
    chart = pou.sfc
    assert chart is not None
    rules = LoweringRules(PROFILES[profile], construction=construction, language=language)
    lowered = construct(pou, chart, Dialect.IEC, rules)
    return equivalent(pou, lowered.pou, profile, cap=2_000, runs=20)


@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_the_training_chain(construction: Construction, language: Language, profile: str) -> None:
    found = verdict(training_chain(), construction, language, profile)
    assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("seed", range(12))
def test_random_safe_charts(seed: int, profile: str) -> None:
    random = Random(seed)  # noqa: S311
    chart = block_chart(seed, 7)
    for number, transition in enumerate(chart.transitions, 1):
        transition.condition = m.Expression(text=f"c{number}")
    qualifiers = ["N", "S", "R", "P", "P1", "P0"]
    for step in chart.steps:
        if random.random() < 0.6:
            act(chart, step, random.choice(["q1", "q2"]), m.Qualifier(random.choice(qualifiers)))
    pou = pou_with(chart)
    for construction, language in FORMS:
        try:
            found = verdict(pou, construction, language, profile)
        except LoweringError:
            assert construction is Construction.CASE
            continue
        assert found.kind is VerdictKind.PROVEN, f"{construction} {language}: {found}"


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("qualifier", ["L", "D", "SD", "DS", "SL"])
def test_timed_actions(qualifier: str, profile: str) -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.steps[1].actions.clear()
    act(chart, chart.steps[1], "Q4", m.Qualifier(qualifier), duration="T#20ms")
    act(chart, chart.steps[3], "Q4", m.Qualifier.R)
    pou = pou_with(chart)
    for construction, language in FORMS:
        found = verdict(pou, construction, language, profile)
        assert found.kind is VerdictKind.PROVEN, f"{construction} {language}: {found}"


def test_minimum_times() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.steps[1].min_time = "T#30ms"
    for construction, language in FORMS:
        found = verdict(pou, construction, language, "codesys")
        assert found.kind is VerdictKind.PROVEN, f"{construction} {language}: {found}"


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_step_variables(profile: str) -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.transitions[2].condition = m.Expression(text="S3.T >= T#20ms AND NOT S1.X")
    for construction, language in FORMS:
        found = verdict(pou, construction, language, profile)
        assert found.kind is VerdictKind.PROVEN, f"{construction} {language}: {found}"


def test_step_actions() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    pou.interface.sections[1].variables += [boolean("e"), boolean("x")]
    chart.steps[1].entry_action = m.StBody(text="e := NOT e;")
    chart.steps[1].exit_action = m.StBody(text="x := NOT x;")
    for construction in (Construction.FLIPFLOP, Construction.CASE, Construction.BITS):
        for profile in ("iec", "codesys"):
            found = verdict(pou, construction, Language.ST, profile)
            assert found.kind is VerdictKind.PROVEN, f"{construction} {profile}: {found}"
