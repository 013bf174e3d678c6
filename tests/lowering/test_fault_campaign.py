"""Random safe charts in the forms of textbooks: where these differ from the chart a fault is named, and a right one.

`PLCOPEN_SFC_CAMPAIGN=2000` runs so many of them; without it a sample.
"""

from __future__ import annotations

import os

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Fault, FaultKind, lower
from plcopen_sfc.lowering.chart_lowering import faults_of
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.random_charts import random_chart

CHARTS = int(os.environ.get("PLCOPEN_SFC_CAMPAIGN") or 8)
BATCH = 8


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, CHARTS, BATCH))
def test_faults_are_named_where_textbook_code_differs(first: int) -> None:
    for seed in range(first, first + BATCH):
        pou = random_chart(seed)
        project = m.Project(pous=[pou])
        for construction, init in (("flipflop", None), ("flipflop", ""), ("case", None)):
            try:
                lowered = lower(
                    project, construction, style="classic", language="ST", profile="iec", init=init, verify=False
                )
            except LoweringError:
                assert construction == "case"
                continue
            found = faults_of(resolve(project), lowered)
            verdict = equivalent(
                pou,
                lowered.project,
                "iec",
                fixed=lowered.at_rest,
                step_flags=lowered.step_flags,
                cap=1_000,
                runs=5,
                scans=60,
            )
            if verdict.kind is VerdictKind.DIFFERENT:
                assert found, f"{pou.name} {construction}: {verdict}"
            for fault in found:
                possible = is_possible(fault, Net.of(chart_of(pou)), initialised=bool(lowered.at_rest))
                assert possible, f"{pou.name} {construction}: {fault}"


def chart_of(pou: m.Pou) -> m.SfcNetwork:
    assert pou.sfc is not None
    return pou.sfc


def is_possible(fault: Fault, net: Net, *, initialised: bool) -> bool:
    """True if the chart has what the fault needs, and the code an input that starts it again."""
    following = [{s for t in leaving for s in net.transitions[t].targets} for leaving in net.leaving]
    index = {step.path: step.index for step in net.steps}
    steps = [index[name] for name in fault.place if name in index]
    match fault.kind:
        case FaultKind.OVERLAP | FaultKind.GAP:
            return steps[1] in following[steps[0]]
        case FaultKind.RUN_THROUGH:
            return steps[-1] in following[steps[-2]]
        case FaultKind.BLOCKED_LOOP:
            return steps[0] in following[steps[1]] and steps[1] in following[steps[0]]
        case FaultKind.DUPLICATED:
            return {steps[1], steps[2]} <= following[steps[0]]
        case FaultKind.LOST:
            return steps[0] in following[steps[0]]
        case FaultKind.INIT_EMPTIES:
            return initialised and steps[1] in following[steps[0]]
        case FaultKind.NOT_STARTED | FaultKind.STUCK | FaultKind.INIT_IGNORED:
            return initialised
        case _:
            return True
