"""Random charts as other tools have them: the text for matiec, compiled, against the chart under the rules of its tool.

Each chart has every kind of association that its tool has, with actions that several steps share, and counts in which
order its actions are executed.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.report import INPUTS_OF_ACTIONS, START_OF_CHART, Outcome
from tests.judges.comparing import Compiled, differences
from tests.judges.matiec import require_matiec
from tests.judges.random_charts import (
    random_codesys_chart,
    random_codesys_model,
    random_model_chart,
    random_wired_chart,
)
from tests.sweeps import some_of

Make = Callable[[int, int], sfc.Project]
KINDS: dict[str, Make] = {
    "codesys": random_codesys_chart,
    "wired": random_wired_chart,
    "model": random_model_chart,
    "codesys model": random_codesys_model,
}


@pytest.mark.slow
@pytest.mark.parametrize("seed", some_of(range(100), 20))
@pytest.mark.parametrize("make", KINDS.values(), ids=KINDS)
def test_converted_random_charts_do_the_same(make: Make, seed: int, tmp_path: Path) -> None:
    require_matiec()
    project = make(seed, 3 + seed % 12)
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    approximated = {item.what for item in report.with_outcome(Outcome.APPROXIMATED)}
    # the last execution in IEC, the time of a loop at one step, and CODESYS executes actions first
    assert approximated <= {"action", "transition", INPUTS_OF_ACTIONS, START_OF_CHART}
    found = list(differences(project, project.pous[0], Compiled.of(data, report), report, tmp_path))
    assert not found or "transition" in approximated
