"""Every chart of the corpus is lowered for every target that can hold it, or refused for a reason that is counted here.

What each form refuses is counted in every run, and a sample is written for a target and compared.
`PLCOPEN_SFC_SWEEP=all` takes every chart in every form for every target, which is about an hour;
`PLCOPEN_SFC_SWEEP=plcopen` those of one folder of the corpus.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence

import pytest

from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import lower
from tests.corpus import require_corpus
from tests.lowering.corpus_sweep import (
    FAMILIES,
    FORMS,
    LARGE,
    REASONS,
    TARGETS,
    Sweep,
    SweepEffort,
    SweepResult,
    corpus_charts,
    reason,
)
from tests.sweeps import some_of

pytestmark = [pytest.mark.corpus, pytest.mark.slow]

WANTED = set(os.environ.get("PLCOPEN_SFC_SWEEP", "").split(","))
PAIRS = [(form, target) for form in FORMS for target in TARGETS]
EVERY = 6
"""Of so many charts one is in the sample, in one form for one target; those of `LARGE` files are not."""
WHOLE = SweepEffort(cap=200, runs=2, scans=40)
SAMPLE = {
    "code only in a comment": (0, 0, 0, 0, 0, 0, 0, 1, 0),
    "older TIA Portal": (0, 0, 0, 0, 0, 0, 0, 0, 1),
    "several steps at a time": (0, 0, 0, 0, 0, 0, 0, 1, 1),
}
REFUSED = {
    "iectext": {
        "chart that fails when it runs": (7, 7, 7, 7, 7, 7, 5, 7, 2),
        "code only in a comment": (0, 0, 0, 0, 0, 0, 16, 50, 34),
        "no regions": (4, 4, 4, 4, 4, 4, 4, 4, 4),
        "older TIA Portal": (0, 0, 0, 0, 0, 0, 0, 0, 136),
        "several steps at a time": (5, 5, 5, 5, 5, 5, 5, 5, 5),
        "text without networks": (0, 0, 0, 0, 0, 0, 58, 0, 0),
    },
    "plcopen": {
        "broken connections": (7, 7, 7, 7, 7, 7, 7, 7, 7),
        "code only in a comment": (0, 0, 0, 2, 0, 0, 0, 0, 0),
        "condition that is no BOOL": (7, 7, 7, 7, 7, 7, 7, 7, 7),
        "no regions": (1, 1, 1, 1, 1, 1, 1, 1, 1),
        "nothing to compare": (5, 5, 5, 3, 5, 5, 3, 5, 5),
        "older TIA Portal": (0, 0, 0, 0, 0, 0, 0, 0, 25),
        "competing transitions that fire together": (2, 2, 2, 2, 2, 2, 2, 2, 2),
        "several steps at a time": (3, 3, 3, 3, 3, 3, 3, 3, 3),
        "text that does not parse": (7, 7, 7, 7, 7, 7, 7, 7, 7),
        "text without networks": (0, 0, 0, 0, 0, 0, 12, 0, 0),
    },
    "simaticml": {
        "broken connections": (7, 7, 7, 7, 7, 7, 7, 7, 7),
        "code only in a comment": (0, 0, 0, 5, 0, 0, 3, 0, 0),
        "no regions": (10, 10, 10, 10, 10, 10, 10, 10, 10),
        "older TIA Portal": (0, 0, 0, 0, 0, 0, 0, 18, 30),
        "several steps at a time": (10, 10, 10, 10, 10, 10, 10, 10, 10),
        "text that cannot be drawn": (2, 2, 2, 2, 2, 0, 0, 2, 2),
        "text without networks": (0, 0, 0, 0, 0, 0, 20, 0, 0),
    },
}
"""Charts that are refused, or cannot be compared: charts and forms for each target, by folder and reason.

Of the other folders the reasons are known, and not counted.
"""
CHARTS = 65
_EVERYWHERE = {
    "action that is no BOOL": 1,
    "action without its time": 1,
    "broken connections": 2,
    "condition that is no BOOL": 1,
    "text that does not parse": 1,
}
REFUSED_FORMS: dict[str, dict[str, int]] = {
    "auto ST": _EVERYWHERE,
    "case ST": {**_EVERYWHERE, "competing transitions that fire together": 1, "several steps at a time": 24},
    "regions ST": {
        **_EVERYWHERE,
        "no regions": 15,
        "competing transitions that fire together": 1,
    },
    "bits ST": _EVERYWHERE,
    "flipflop ST": _EVERYWHERE,
    "flipflop FBD": {**_EVERYWHERE, "text that cannot be drawn": 1},
    "flipflop LD": {**_EVERYWHERE, "text that cannot be drawn": 1},
}
"""How many charts of bodies each form refuses, whatever the target is."""


def refused(results: Sequence[SweepResult]) -> dict[str, tuple[int, ...]]:
    """Charts refused, or not comparable: by reason, for each of the `TARGETS`. Nothing may be wrong."""
    for result in results:
        assert not result.is_fault, str(result)
    left = [result for result in results if result.outcome in ("refused", "incomparable")]
    counts = Counter((result.why, result.target) for result in left)
    return {why: tuple(counts[why, target] for target in TARGETS) for why in sorted({each.why for each in left})}


def skip_unless(name: str) -> None:
    """Skip a test that takes too long, unless it is asked for by this name."""
    require_corpus()
    if not {"all", name} & WANTED:
        pytest.skip(f"asked for with PLCOPEN_SFC_SWEEP={name}")


@pytest.mark.slow
def test_a_sample_does_the_same_or_is_refused() -> None:
    require_corpus()
    results: list[SweepResult] = []
    number = 0
    for charts in corpus_charts():
        if charts.file in LARGE:
            continue
        sweep = Sweep(charts, SweepEffort(cap=100, runs=1, scans=30))
        for name in charts.names:
            number += 1
            if number % EVERY == 0:
                form, target = PAIRS[number // EVERY * 8 % len(PAIRS)]
                results += sweep.results([form], [target], [name])
    assert refused(results) == SAMPLE
    assert Counter(result.outcome for result in results)["proven"] >= 4


@pytest.mark.parametrize("family", FAMILIES)
def test_all_do_the_same_or_are_refused(family: str) -> None:
    skip_unless(family)
    results = [each for charts in corpus_charts([family]) for each in Sweep(charts, WHOLE).results()]
    found = refused(results)
    assert found == REFUSED[family] if family in REFUSED else not found.keys() - {*REASONS.values(), "older TIA Portal"}


def test_each_form_refuses_few() -> None:
    require_corpus()
    forms = some_of(FORMS, 4)
    found: dict[str, Counter[str]] = {f"{construction} {language}": Counter() for construction, language in forms}
    count = 0
    for charts in corpus_charts():
        for name in charts.names:
            if "." in name:
                continue  # the chart of an action
            count += 1
            for construction, language in forms:
                try:
                    lower(charts.project, construction, pou=name, language=language, verify=False)
                except LoweringError as error:
                    found[f"{construction} {language}"][reason(error)] += 1
    assert count == CHARTS
    assert {form: dict(counts) for form, counts in found.items()} == {form: REFUSED_FORMS[form] for form in found}
