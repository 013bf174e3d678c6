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
            left = memory.falling(texts.with_suffix(name, "exit"), active(step.step), edges)
            exits += memory.conditional(texts.with_suffix(name, "left"), left, step.exit)
        if step.entry:
            entered = memory.rising(texts.with_suffix(name, "entry"), active(step.step), edges)
            entries += memory.conditional(texts.with_suffix(name, "entered"), entered, step.entry)
    code.add(texts.step_actions, [*edges, *exits, *entries])


def add_main_actions(source: ChartSource, code: Code, memory: Memory, active: StepValue, texts: Texts) -> None:
    """Append what the active steps execute in every scan."""
    mains: list[Statement] = []
    for step in source.step_code:
        if step.main:
            name = texts.with_suffix(source.net.steps[step.step].step.name, "main")
            mains += memory.conditional(name, active(step.step), step.main)
    code.add(texts.main_actions, mains)
