"""Entry, main and exit actions of steps, as code (CODESYS V3, "Processing order" steps 2 to 4)."""

from __future__ import annotations

from plcopen_sfc.languages.st.nodes import Statement
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.program import Code, StepValue
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.texts import Texts


def add_changes(source: ChartSource, code: Code, memory: Memory, active: StepValue, texts: Texts) -> None:
    """Append the exit actions of all steps that were left, then the entry actions of those that were entered."""
    edges: list[Statement] = []
    exits: list[Statement] = []
    entries: list[Statement] = []
    for step in source.step_code:
        name = source.net.steps[step.step].step.name
        if step.exit:
            left = memory.falling(f"{name}_exit", active(step.step), edges)
            exits += memory.conditional(f"{name}_left", left, step.exit)
        if step.entry:
            entered = memory.rising(f"{name}_entry", active(step.step), edges)
            entries += memory.conditional(f"{name}_entered", entered, step.entry)
    code.add(texts.step_actions, [*edges, *exits, *entries])


def add_main_actions(source: ChartSource, code: Code, memory: Memory, active: StepValue, texts: Texts) -> None:
    """Append what the active steps execute in every scan."""
    mains: list[Statement] = []
    for step in source.step_code:
        if step.main:
            mains += memory.conditional(f"{source.net.steps[step.step].step.name}_main", active(step.step), step.main)
    code.add(texts.main_actions, mains)
