"""In which order a chart is told: where its legs meet again, and which way leads back."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from plcopen_sfc.model.sfc import SfcNetwork, Transition

__all__ = ["Flow", "Path", "common"]

Path = tuple[tuple[int, int], ...]
"""Where something stands: inside which legs, outermost first, each as (number of the branch, number of the leg)."""


@dataclass
class Flow:
    """The chart as a walk from its initial steps.

    `roots` are the steps where the walk begins. `waits` says for each step how many transitions lead to it without
    leading back: its story goes on where the last of them has arrived.
    """

    chart: SfcNetwork
    leaving: dict[int, list[Transition]] = field(default_factory=dict)
    roots: list[int] = field(default_factory=list)
    waits: dict[int, set[int]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        ids = {step.id for step in self.chart.steps}
        self.leaving = {step: [] for step in ids}
        for transition in sorted(self.chart.transitions, key=lambda t: (t.priority is None, t.priority or 0)):
            for source in dict.fromkeys(transition.sources):
                if source in ids:
                    self.leaving[source].append(transition)
        self._walk(ids)

    def _starts(self) -> Iterable[int]:
        yield from (step.id for step in self.chart.steps if step.initial)
        for transition in self.chart.transitions:
            if not transition.sources:
                yield from transition.targets
        yield from (step.id for step in self.chart.steps)

    def _walk(self, ids: set[int]) -> None:
        """Depth first from every start that no earlier one reaches; a way to a step still being walked leads back."""
        group: dict[int, int] = {}
        for start in self._starts():
            if start in group or start not in ids:
                continue
            self.roots.append(start)
            group[start] = start
            active = {start}
            back: set[tuple[int, int]] = set()
            members = [start]
            stack = [(start, self._onward(start))]
            while stack:
                step, onward = stack[-1]
                if not onward:
                    active.discard(step)
                    stack.pop()
                    continue
                transition, target = onward.pop()
                if target in active:
                    back.add((transition, target))
                elif target in ids and target not in group:
                    group[target] = start
                    active.add(target)
                    members.append(target)
                    stack.append((target, self._onward(target)))
            for member in members:
                for transition, target in self._onward(member):
                    if group.get(target) == start and (transition, target) not in back:
                        self.waits.setdefault(target, set()).add(transition)

    def _onward(self, step: int) -> list[tuple[int, int]]:
        return [(t.id, target) for t in reversed(self.leaving[step]) for target in reversed(t.targets)]


def common(paths: Iterable[Path]) -> Path:
    """The innermost place that all `paths` lie in."""
    shared: Path | None = None
    for path in paths:
        if shared is None:
            shared = path
            continue
        length = next((i for i, (a, b) in enumerate(zip(shared, path, strict=False)) if a != b), None)
        shared = shared[: min(len(shared), len(path)) if length is None else length]
    return shared or ()
