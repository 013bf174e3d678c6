"""The interpreter of charts: what happens in a scan, under any profile.

`compile_chart` is the chart compiler of a `Controller`. docs/semantics.md tells what a chart does in a scan.

`chart_program`       the scan of a chart; `running_chart` has what all kinds share, `step_state` the steps' data
`transition_firing`   which transitions fire, and competing ones
`chart_actions`       actions, and when they are executed; `qualifier_control` has the qualifiers
`sfc_flags`           SFCInit, SFCPause and the other flags of CODESYS
`graph`, `grafcet`    sequencers of S7-GRAPH, and GRAFCETs
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from plcopen_sfc.model import SfcNetwork
from plcopen_sfc.semantics.charts.chart_program import ChartProgram
from plcopen_sfc.semantics.charts.graph.graph_program import GraphProgram
from plcopen_sfc.semantics.charts.running_chart import RunningChart
from plcopen_sfc.semantics.profile import Profile

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope

__all__ = ["ChartProgram", "GraphProgram", "compile_chart", "compiler"]


def compile_chart(chart: SfcNetwork, scope: Scope, path: str) -> RunningChart:
    """Return a chart that the body `path` of a POU holds, under the profile of the controller.

    Declares the variables of its steps and its flags in `scope`.
    """
    return compiler(scope.library.profile)(chart, scope, path)


def compiler(profile: Profile) -> Callable[[SfcNetwork, Scope, str], RunningChart]:
    """Return a chart compiler for one profile."""

    def compile_(chart: SfcNetwork, scope: Scope, path: str) -> RunningChart:
        kind = GraphProgram if profile.graph_parameters else ChartProgram
        return kind(chart, scope, path, profile)

    return compile_
