"""Random safe charts of every shape, lowered in every form, do what the charts do: proven one by one.

`PLCOPEN_SFC_CAMPAIGN=2000` runs so many of them; without it a sample.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from random import Random

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, Language
from plcopen_sfc.lowering.construction import construct
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import PROFILES
from tests.lowering.random_charts import QUALIFIERS, Shape, random_chart

CHARTS = int(os.environ.get("PLCOPEN_SFC_CAMPAIGN") or 4)
BATCH = 4
FORMS = [
    (Construction.FLIPFLOP, Language.ST),
    (Construction.FLIPFLOP, Language.FBD),
    (Construction.FLIPFLOP, Language.LD),
    (Construction.CASE, Language.ST),
    (Construction.REGIONS, Language.ST),
    (Construction.BITS, Language.ST),
]


def lowered(pou: m.Pou, profile: str) -> Iterator[tuple[str, m.Pou, dict[str, str]]]:
    """The chart in every form that can hold it: what it is, the program, and what tells of its steps."""
    chart = pou.sfc
    assert chart is not None
    for construction, language in FORMS:
        try:
            rules = LoweringRules(PROFILES[profile], construction=construction, language=language)
            made = construct(pou, chart, Dialect.IEC, rules)
        except LoweringError as error:
            refusing = construction in (Construction.CASE, Construction.REGIONS)
            if not refusing or "cannot hold the chart" not in error.message:
                raise
            continue
        yield f"{construction} {language}", made.pou, made.step_flags


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("first", range(0, CHARTS, BATCH))
def test_random_charts_are_proven(first: int, profile: str) -> None:
    outcomes: Counter[tuple[str, VerdictKind]] = Counter()
    for seed in range(first, first + BATCH):
        pou = random_chart(seed, codesys=profile == "codesys")
        for form, program, step_flags in lowered(pou, profile):
            found = equivalent(pou, program, profile, step_flags=step_flags or None, cap=1_500, runs=10, scans=100)
            assert found.kind is not VerdictKind.DIFFERENT, f"{pou.name} {profile} {form}: {found}"
            assert found.proven or "more than" in found.reason, f"{pou.name} {profile} {form}: {found}"
            outcomes[form, found.kind] += 1
    assert sum(outcomes.values()) >= 4 * BATCH  # step bits and flip-flops hold every chart
    assert sum(count for (_, outcome), count in outcomes.items() if outcome is VerdictKind.PROVEN) > 2 * BATCH


def test_random_charts_have_every_shape_and_every_action_and_are_safe() -> None:
    qualifiers: set[m.Qualifier] = set()
    loops = starts = joins = competing = 0
    for seed in range(64):
        chart = random_chart(seed).sfc
        assert chart is not None
        graph = marking_graph(chart, cap=20_000)
        assert graph.safe, f"chart {seed} is not safe"
        net = Net.of(chart)
        qualifiers |= {association.qualifier for _, association in chart.associations()}
        loops += any(set(t.sources) & set(t.targets) for t in net.transitions)
        starts += net.initial.bit_count() > 1
        joins += any(len(t.sources) > 1 for t in net.transitions)
        competing += any(t.competing for t in net.transitions)
    assert {str(qualifier) for qualifier in qualifiers} >= set(QUALIFIERS)
    assert min(loops, starts, joins, competing) >= 64 // len(Shape)


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_the_order_of_steps_in_the_chart_does_not_matter(seed: int) -> None:
    """Step by step they are networks of their own; only transitions and actions have an order that tells."""
    pou = random_chart(seed, size=7)
    shuffled = pou.model_copy(deep=True)
    assert shuffled.sfc is not None
    Random(seed).shuffle(shuffled.sfc.steps)  # noqa: S311
    for form, program, step_flags in lowered(shuffled, "iec"):
        found = equivalent(pou, program, "iec", step_flags=step_flags or None, cap=1_500, runs=10, scans=100)
        assert not found.different, f"{pou.name} {form}: {found}"
