"""Random charts with random options as networks: what comes back from the file does what the chart does."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import lower
from plcopen_sfc.semantics.subjects import resolve
from tests.analysis.nets import block_chart
from tests.lowering.charts import act, pou_with

TIMED = ("D", "L", "SD", "DS", "SL")
TARGETS = ("plcopen-1.01", "plcopen-2.01", "codesys", "simaticml")
MODES = ("enable", "single-step", "advance", "select")


def chart_of(random: Random, seed: int) -> m.SfcNetwork:
    chart = block_chart(seed, 6)
    for number, transition in enumerate(chart.transitions, 1):
        text = random.choice(
            [f"c{number}", f"c{number}", f"NOT c{number}", f"c{number} AND c1", f"c{number} OR NOT c1"]
        )
        transition.condition = m.Expression(text=text)
    for step in chart.steps:
        if random.random() < 0.7:
            qualifier = random.choice(["N", "S", "R", "P", "P1", "P0", *TIMED])
            duration = "T#20ms" if qualifier in TIMED else None
            condition = "c1" if random.random() < 0.2 else None
            target = random.choice(["q1", "q2", "q3"])
            act(chart, step, target, m.Qualifier(qualifier), duration=duration, condition=condition)
    return chart


def options_of(random: Random) -> dict[str, Any]:
    found: dict[str, Any] = {"profile": random.choice(["iec", "codesys"]), "target": random.choice(TARGETS)}
    found["language"] = random.choice(["FBD", "LD"])
    for name, value in (
        ("init", "Init"),
        ("stop", random.choice(["NOT c1", "HALT"])),
        ("reset_actions", True),
        ("modes", random.sample(MODES, random.randint(1, len(MODES)))),
        ("actions", "block"),
        ("flags", random.choice(["M10.5", "Steps"])),
    ):
        if random.random() < 0.35:
            found[name] = value
    return found


def check(seed: int) -> None:
    random = Random(seed)  # noqa: S311
    original = m.Project(pous=[pou_with(chart_of(random, seed))])
    options = options_of(random)
    try:
        lowered = lower(original, "flipflop", verify=False, **options)
    except LoweringError as error:
        if "several times for" not in error.message:
            raise
        return
    again = sfc.loads(sfc.dumps(lowered.project, format=options["target"], partial=True))
    flags = lowered.step_flags if "flags" in options else None
    found = equivalent(
        original,
        resolve(again, lowered.pou.name),
        options["profile"],
        fixed=lowered.at_rest,
        left_out=lowered.left_out,
        step_flags=flags or None,
        cap=2_000,
        runs=10,
        scans=60,
    )
    assert found.kind is not VerdictKind.DIFFERENT, f"{seed} {options}: {found}"


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(14))
def test_a_sample(seed: int) -> None:
    check(seed)


@pytest.mark.slow
def test_many() -> None:
    for seed in range(100, 110):
        check(seed)
