"""Random charts for property tests, and what a drawing of them says."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from plcopen_sfc.model.drawing import Drawing, SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition
from plcopen_sfc.model.wiring import trace_drawing


def links_of_drawing(drawing: Drawing) -> dict[int, tuple[frozenset[int], frozenset[int]]]:
    """The links that the wires give to each transition."""
    found: dict[int, tuple[frozenset[int], frozenset[int]]] = {}
    wiring = trace_drawing(drawing)
    for symbol in drawing.symbols:
        if symbol.kind is SymbolKind.TRANSITION:
            links = wiring.links[symbol.id]
            members = symbol.transitions or [symbol.id]
            assert len(links) == len(members), (symbol, links)
            for member, link in zip(members, links, strict=True):
                assert member not in found
                found[member] = (frozenset(link.sources), frozenset(link.targets))
    return found


def links_of_chart(chart: SfcNetwork) -> dict[int, tuple[frozenset[int], frozenset[int]]]:
    return {t.id: (frozenset(t.sources), frozenset(t.targets)) for t in chart.transitions}


def make(steps: int, edges: list[tuple[list[int], list[int]]], **changes: Any) -> SfcNetwork:
    """A chart of steps 0..n-1 and a transition for each pair of sources and targets."""
    return SfcNetwork(
        steps=[Step(id=i, name=f"S{i}", initial=i == 0) for i in range(steps)],
        transitions=[
            Transition(id=steps + i, sources=sources, targets=targets, condition=f"c{i}")
            for i, (sources, targets) in enumerate(edges)
        ],
        **changes,
    )


@st.composite
def any_net(draw: st.DrawFn, max_steps: int = 9) -> SfcNetwork:
    """Any net at all, most of them unsafe."""
    steps = draw(st.integers(0, max_steps))
    ids = st.lists(st.integers(0, steps - 1), max_size=3, unique=True) if steps else st.just([])
    edges = draw(st.lists(st.tuples(ids, ids), max_size=14))
    chart = make(steps, edges)
    for transition in chart.transitions:
        transition.condition = draw(st.sampled_from(["a", "b"]))
        transition.priority = draw(st.sampled_from([None, 1, 2]))
    for step in chart.steps:
        step.initial = draw(st.booleans())
    return chart


@st.composite
def nested_net(draw: st.DrawFn, *, jumps: bool = True) -> SfcNetwork:
    """A chart of nested branches, with jumps to any step, as editors make them."""
    kinds = ["step", "selection", "parallel", *(["jump"] if jumps else [])]
    steps: list[int] = []
    edges: list[tuple[list[int], list[int]]] = []

    def new() -> int:
        steps.append(len(steps))
        return steps[-1]

    def sequence(start: int, depth: int) -> int:
        """From the step `start` to the step that is returned."""
        now = start
        for _ in range(draw(st.integers(0, 2))):
            kind = draw(st.sampled_from(kinds)) if depth else "step"
            if kind == "step":
                after = new()
                edges.append(([now], [after]))
            elif kind == "jump":
                edges.append(([now], [draw(st.sampled_from(steps))]))
                after = new()
                edges.append(([now], [after]))
            else:
                branches = draw(st.integers(2, 3))
                if kind == "selection":
                    ends = []
                    for _ in range(branches):
                        first = new()
                        edges.append(([now], [first]))
                        ends.append(sequence(first, depth - 1))
                    after = new()
                    edges.extend(([end], [after]) for end in ends)
                else:
                    firsts = [new() for _ in range(branches)]
                    edges.append(([now], firsts))
                    ends = [sequence(first, depth - 1) for first in firsts]
                    after = new()
                    edges.append((ends, [after]))
            now = after
        return now

    end = sequence(new(), 3)
    edges.append(([end], [0]))
    return make(len(steps), edges)


@st.composite
def entered_net(draw: st.DrawFn) -> SfcNetwork:
    """A chart of nested branches with up to three jumps, from any place to any, also into branches from outside."""
    chart = draw(nested_net(jumps=False))
    edges = [(t.sources, t.targets) for t in chart.transitions]
    waited_for = {source for sources, _ in edges if len(sources) > 1 for source in sources}
    places = st.sampled_from([step.id for step in chart.steps if step.id not in waited_for])
    for _ in range(draw(st.integers(1, 3))):
        jump = ([draw(places)], [draw(st.integers(0, len(chart.steps) - 1))])
        edges.insert(draw(st.integers(0, len(edges))), jump)
    return make(len(chart.steps), edges)
