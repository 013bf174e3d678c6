"""Our interpreter under the profile ``matiec`` against the code that matiec makes, scan by scan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.semantics.charts import compiler
from plcopen_sfc.semantics.profile import PROFILES
from plcopen_sfc.semantics.programs import Controller
from tests.judges.matiec import Value, require_matiec
from tests.judges.random_charts import random_chart, random_inputs
from tests.sweeps import some_of

SCANS = 60
PERIOD = 10_000_000
MATIEC = PROFILES["matiec"]


def ours(text: str, inputs: Sequence[Mapping[str, Value]], watch: Sequence[str]) -> list[dict[str, Value]]:
    """Return the run of the program ``Chart`` of a text in our interpreter."""
    controller = Controller(sfc.loads(text.encode(), format="iec-text"), MATIEC, chart_compiler=compiler(MATIEC))
    instance = controller.instance("Chart")
    found = []
    for scan, values in enumerate(inputs):
        controller.now = scan * PERIOD
        for name, value in values.items():
            instance[name] = value
        instance.scan()
        found.append({name: instance[name] for name in watch})
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", some_of(range(200), 20))
def test_random_charts_do_the_same(seed: int, tmp_path: Path) -> None:
    matiec = require_matiec()
    chart = random_chart(seed, 3 + seed % 12)
    inputs = random_inputs(seed, SCANS)
    assert ours(chart.text, inputs, chart.watch) == matiec.build(chart.text, tmp_path).run(inputs, chart.watch)


@pytest.mark.slow
@pytest.mark.parametrize("seed", some_of(range(200), 20))
@pytest.mark.parametrize("form", ["auto", "bits"])
def test_lowered_code_does_the_same(form: str, seed: int, tmp_path: Path) -> None:
    """The chart and its code, both compiled by matiec: our interpreter takes no part in the verdict."""
    matiec = require_matiec()
    chart = random_chart(seed, 3 + seed % 12)
    inputs = random_inputs(seed, SCANS)
    lowered = sfc.lower(
        sfc.loads(chart.text.encode(), format="iec-text").pou("Chart"),
        form,
        profile="matiec",
        target="iec-text",
        verify=False,
    )
    watch = [name for name in chart.watch if not name.endswith(".X")]
    text = sfc.dumps(lowered.project, format="iec-text").decode()  # it is what matiec takes without being adapted
    built = matiec.build(text, tmp_path / "code")
    theirs = matiec.build(chart.text, tmp_path / "chart").run(inputs, watch, period=PERIOD)
    assert built.run(inputs, watch, period=PERIOD) == theirs
