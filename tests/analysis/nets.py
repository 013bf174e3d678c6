"""Charts for the tests of nets: written as text, drawn at random, and nested blocks of any size."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random

from hypothesis import strategies as st

from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition

Arcs = list[tuple[tuple[int, ...], tuple[int, ...]]]
"""Transitions as their sources and targets."""


def chart_of(text: str, initial: str = "1") -> SfcNetwork:
    """A chart like ``1>2+3 2>4 3>5 4+5>1``: transitions from steps to steps. Nothing stands for no step."""
    chart = SfcNetwork()
    arcs = [arc.split(">") for arc in text.split()]
    sides = [[name for name in side.split("+") if name] for arc in arcs for side in arc]
    starting = [name for name in initial.split("+") if name]
    for name in dict.fromkeys([*starting, *(name for side in sides for name in side)]):
        chart.add_step(name, initial=name in starting)
    for sources, targets in zip(sides[::2], sides[1::2], strict=True):
        chart.add_transition([chart.step(n) for n in sources], [chart.step(n) for n in targets], "TRUE")
    return chart


def chart_of_arcs(steps: int, initial: Iterable[int], arcs: Arcs) -> SfcNetwork:
    """A chart of steps ``S0``, ``S1`` and so on."""
    starting = set(initial)
    return SfcNetwork(
        steps=[Step(id=i, name=f"S{i}", initial=i in starting) for i in range(steps)],
        transitions=[
            Transition(id=steps + i, sources=list(sources), targets=list(targets), condition=Expression(text="TRUE"))
            for i, (sources, targets) in enumerate(arcs)
        ],
    )


@st.composite
def any_nets(draw: st.DrawFn, max_steps: int = 6, max_transitions: int = 7) -> tuple[int, tuple[int, ...], Arcs]:
    """Small nets of any kind, mostly broken: unsafe, blocked, dead."""
    steps = draw(st.integers(1, max_steps))
    index = st.integers(0, steps - 1)
    side = st.lists(index, min_size=1, max_size=3, unique=True).map(lambda s: tuple(sorted(s)))
    arcs = draw(st.lists(st.tuples(side, side), max_size=max_transitions))
    initial = draw(st.lists(index, min_size=1, max_size=2, unique=True))
    return steps, tuple(initial), arcs


def block_chart(seed: int, size: int, *, loops: bool = True) -> SfcNetwork:
    """A chart of nested selections, simultaneous branches, sequences and loops with about `size` steps: it is sound."""
    random = Random(seed)  # noqa: S311
    arcs: Arcs = []
    steps = 1

    def new() -> int:
        nonlocal steps
        steps += 1
        return steps - 1

    # a block is a piece between two steps that still has to be filled with so many steps
    waiting = [(0, 0, size)]
    while waiting:
        begin, end, left = waiting.pop()
        if left <= 0 and begin != end:
            arcs.append(((begin,), (end,)))
            continue
        kind = random.choice(("sequence", "sequence", "selection", "simultaneous", "loop"))
        if left < 4 or begin == end or kind == "sequence":
            middle = new()
            half = random.randint(0, max(0, left - 1))
            waiting += [(begin, middle, half), (middle, end, left - 1 - half)]
        elif kind == "selection":
            parts = random.randint(2, 3)
            waiting += [(begin, end, left // parts)] * parts
        elif kind == "loop" and loops:
            middle = new()
            waiting += [(begin, middle, left // 2), (middle, end, left // 4)]
            back = new()
            arcs += [((middle,), (back,)), ((back,), (middle,))]
        else:
            parts = random.randint(2, 4)
            starts = [new() for _ in range(parts)]
            ends = [new() for _ in range(parts)]
            arcs += [((begin,), tuple(starts)), (tuple(ends), (end,))]
            share = max(0, left - 2 * parts) // parts
            waiting += [(s, e, share) for s, e in zip(starts, ends, strict=True)]
    return chart_of_arcs(steps, [0], arcs)
