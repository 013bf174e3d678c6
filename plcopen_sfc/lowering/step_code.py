"""Entry, main and exit actions of steps, as code (CODESYS V3, "Processing order" steps 2 to 4)."""

from __future__ import annotations

from collections.abc import Callable

from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code import Code
from plcopen_sfc.lowering.logic import when
from plcopen_sfc.lowering.memory import Memory
from plcopen_sfc.lowering.source import ChartSource
from plcopen_sfc.lowering.texts import Texts


def add_step_code(
    source: ChartSource, code: Code, memory: Memory, active: Callable[[int], Expression], texts: Texts
) -> None:
    """Append the exit actions of all steps, then their entry actions, then their main actions."""
    edges: list[Statement] = []
    exits: list[Statement] = []
    entries: list[Statement] = []
    mains: list[Statement] = []
    for step in source.step_code:
        name = source.net.steps[step.step].step.name
        if step.exit:
            exits.append(when(memory.falling(f"{name}_exit", active(step.step), edges), *step.exit))
        if step.entry:
            entries.append(when(memory.rising(f"{name}_entry", active(step.step), edges), *step.entry))
        if step.main:
            mains.append(when(active(step.step), *step.main))
    code.add(texts.step_actions, [*edges, *exits, *entries, *mains])
