"""One CASE for a GRAFCET of which one step is active at a time."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.lowering.chains.case import CaseChain, one_step_at_a_time
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.program import Code
from plcopen_sfc.lowering.grafcet.concurrency import exclude
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.rules import LoweringRules
from plcopen_sfc.semantics.net import Rivals
from plcopen_sfc.semantics.profile import Profile


def no_case(source: ChartSource, profile: Profile) -> str:
    """Why one CASE cannot hold a GRAFCET; empty if it can."""
    objection = one_step_at_a_time(source)
    if objection:
        return objection
    if source.grafcet is not None and source.grafcet.ruled:
        return "some of its charts rule others"
    for transition in source.net.transitions:
        if set(transition.sources) & set(transition.targets):
            return f"transition {transition.path} leads back to its own step"
        for rival in transition.rivals if profile.rivals is not Rivals.PRIORITY else ():
            if not exclude(source.conditions[rival], source.conditions[transition.index], source.dialect):
                first = source.net.transitions[rival].path
                return f"the conditions of {first} and {transition.path} do not exclude each other"
    return ""


class GrafcetCase(CaseChain):
    """Lowers one chart into `code`. Raises `LoweringError` for what one CASE cannot hold."""

    def __init__(
        self,
        source: ChartSource,
        code: Code,
        memory: Memory,
        rules: LoweringRules,
        surroundings: Collection[str] = (),
    ) -> None:
        objection = no_case(source, rules.profile)
        if objection:
            raise LoweringError(
                f"one CASE cannot hold the chart: {objection}",
                location=Location(path=source.pou.name),
                hint="Step bits can.",
            )
        # conditions exclude each other: the order in which they are tried makes no difference
        tried = replace(rules, profile=replace(rules.profile, rivals=Rivals.PRIORITY))
        super().__init__(source, code, memory, tried, surroundings)
