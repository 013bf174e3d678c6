"""What the states of a CASE are: a number for each step, for each wait for a join, and for no step at all."""

from __future__ import annotations

import re
from itertools import count

from plcopen_sfc.analysis.regions import ParallelBlock, Regions
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.lowering.code import Code
from plcopen_sfc.model.types import Elementary, ElementaryType
from plcopen_sfc.semantics.net import Net

_LARGEST_INT = 32_767
_LARGEST_DINT = 2_147_483_647


def step_numbers(net: Net) -> list[int]:
    """A number for each step: its own, else that which its name says (``S3``), else the next one that is free.

    Of steps that have the same number the first one keeps it.
    """
    wanted = [step.step.number if step.step.number is not None else _said(step.step.name) for step in net.steps]
    kept: dict[int, int] = {}
    for step, number in enumerate(wanted):
        if number is not None and 0 <= number <= _LARGEST_DINT:
            kept.setdefault(number, step)
    numbers = {step: number for number, step in kept.items()}
    free = (number for number in count(1) if number not in kept)
    return [numbers[step] if step in numbers else next(free) for step in range(len(wanted))]


def _said(name: str) -> int | None:
    found = re.fullmatch(r"(?i:(?:S|X|Step|Schritt)[ _]?)?(\d{1,9})", name)
    return int(found.group(1)) if found is not None else None


class StateNames:
    """The states of one chart, as its code writes them."""

    def __init__(self, net: Net, regions: Regions, code: Code) -> None:
        self._code = code
        numbers = step_numbers(net)
        # waiting has numbers of its own hundred: they stay when steps are added
        hundred = 100 * (max(numbers) // 100 + 1)
        waiting = [hundred + 1 + block.index for block in regions.blocks]
        used = [*numbers, *waiting]
        largest = max(used)
        self._type = ElementaryType(name=Elementary.INT if largest <= _LARGEST_INT else Elementary.DINT)
        self._steps = [n.Literal(str(number)) for number in numbers]
        self._waiting = [n.Literal(str(number)) for number in waiting]
        self.none = n.Literal("0" if 0 not in used else str(hundred))

    def step(self, step: int) -> n.Literal:
        """The state in which a step is active."""
        return self._steps[step]

    def waiting(self, block: ParallelBlock) -> n.Literal:
        """The state in which a region waits for the branches of a block."""
        return self._waiting[block.index]

    def declare(self, wanted: str, initial: int | None, comment: str) -> n.Name:
        """A state variable; `initial` is the step that is active at the start."""
        start = self.none if initial is None else self.step(initial)
        return self._code.declare(wanted, self._type, initial=start.text, comment=comment)
