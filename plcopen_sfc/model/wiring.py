"""Meaning of the wires and bars of a drawing: from which steps to which steps each transition leads.

Every reader that meets a drawing and every writer that must know whether a drawing still fits its chart uses this one
interpretation. It accepts what tools really draw (evidence: 82 CODESYS and TwinCAT exports, 10 847 steps):

- a bar may follow a bar of the same kind directly (nested branches); both are seen through;
- a jump may be wired into a convergence, although it has no output: a branch that ended; it leads nowhere else;
- steps may meet in a selection convergence before one transition: that is one transition for each of them;
- several consumers of a transition without a bar between them are taken as a simultaneous divergence.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import NamedTuple

from plcopen_sfc.grouping import grouped
from plcopen_sfc.model.drawing import BARS, CONVERGENCES, DIVERGENCES, STEPS, Drawing, SymbolKind

_TRANSITION, _JUMP = SymbolKind.TRANSITION.value, SymbolKind.JUMP.value
FLOW = STEPS | BARS | {SymbolKind.TRANSITION, SymbolKind.JUMP}
"""Kinds of symbols that a situation runs through."""
_MAX_ALTERNATIVES = 4096
"""A convergence of convergences multiplies alternatives; a chart that needs more than this is damaged."""


class Link(NamedTuple):
    """From all `sources` to all `targets`, by the ids of steps."""

    sources: tuple[int, ...]
    targets: tuple[int, ...]


class WiringProblem(NamedTuple):
    """Something in the wires that cannot be executed: `code` of docs/diagnostics.md at the symbol `symbol`."""

    code: str
    symbol: int
    detail: str


@dataclass(slots=True)
class Wiring:
    """`links` of each transition symbol (several where steps meet before it) and what is wrong with the wires."""

    links: dict[int, list[Link]] = field(default_factory=dict)
    problems: list[WiringProblem] = field(default_factory=list)


def trace(
    kinds: Mapping[int, SymbolKind],
    inputs: Mapping[int, Iterable[int]],
    jumps: Mapping[int, int | None],
) -> Wiring:
    """Follow the wires of a chart.

    `kinds` gives the kind of each symbol by id in drawing order, `inputs` the ids wired to its inputs, `jumps` the id
    of the step or simultaneous divergence that each jump leads to (None: it exists nowhere).
    """
    return _Tracer(kinds, inputs, jumps).run()


def trace_drawing(drawing: Drawing) -> Wiring:
    """Follow the wires of `drawing`."""
    return trace(
        {s.id: s.kind for s in drawing.symbols},
        inputs_of(drawing),
        {s.id: s.target for s in drawing.symbols if s.kind is SymbolKind.JUMP},
    )


def inputs_of(drawing: Drawing) -> dict[int, list[int]]:
    """Return the ids wired to the inputs of each symbol, by its id."""
    return {s.id: [c.source for pin in s.inputs for c in pin.connections] for s in drawing.symbols}


class _Tracer:
    def __init__(
        self,
        kinds: Mapping[int, SymbolKind],
        inputs: Mapping[int, Iterable[int]],
        jumps: Mapping[int, int | None],
    ) -> None:
        self.kinds = kinds
        self.inputs = inputs
        self.jumps = jumps
        self.wiring = Wiring()
        self.consumers = grouped((source, consumer) for consumer, sources in inputs.items() for source in sources)

    def run(self) -> Wiring:
        for symbol, kind in self.kinds.items():
            if kind == _TRANSITION:
                alternatives = self._sources_of(symbol)
                targets = tuple(dict.fromkeys(self._downstream(symbol, frozenset({symbol}))))
                self.wiring.links[symbol] = [Link(sources, targets) for sources in alternatives]
            elif kind == _JUMP or kind in STEPS:
                self._check_predecessor(symbol)
        return self.wiring

    def _sources_of(self, transition: int) -> list[tuple[int, ...]]:
        alternatives = self._union(transition, frozenset({transition}))
        if not alternatives:
            self._problem("SFC104", transition, "no step leads to this transition")
        return alternatives or [()]

    def _union(self, symbol: int, seen: frozenset[int]) -> list[tuple[int, ...]]:
        """Return the alternatives at the inputs of `symbol`: any one of them enables it."""
        found: list[tuple[int, ...]] = []
        for source in self.inputs.get(symbol, ()):
            for alternative in self._upstream(source, seen):
                if alternative not in found:
                    found.append(alternative)
        return found

    def _upstream(self, symbol: int, seen: frozenset[int]) -> list[tuple[int, ...]]:
        kind = self.kinds.get(symbol)
        if kind in STEPS:
            return [(symbol,)]
        if kind not in BARS or symbol in seen:
            # A jump is a branch that ended; a transition or an element of logic before a transition leads from no step.
            return []
        seen = seen | {symbol}
        if kind != SymbolKind.SIMULTANEOUS_CONVERGENCE:
            return self._union(symbol, seen)
        branches = [self._upstream(source, seen) for source in self.inputs.get(symbol, ())]
        branches = [branch for branch in branches if branch]
        combined: list[tuple[int, ...]] = []
        for combination in product(*branches):
            combined.append(tuple(dict.fromkeys(step for branch in combination for step in branch)))
            if len(combined) > _MAX_ALTERNATIVES:
                self._problem("SFC105", symbol, "too many alternatives meet here")
                break
        return combined if branches else []

    def _downstream(self, symbol: int, seen: frozenset[int]) -> list[int]:
        found: list[int] = []
        for consumer in self.consumers.get(symbol, ()):
            kind = self.kinds.get(consumer)
            if kind in STEPS:
                found.append(consumer)
            elif kind == _JUMP:
                found.extend(self._jump(consumer, seen))
            elif kind in BARS and consumer not in seen:
                found.extend(self._downstream(consumer, seen | {consumer}))
        return found

    def _jump(self, symbol: int, seen: frozenset[int]) -> list[int]:
        target = self.jumps.get(symbol)
        if target is None:
            return []
        if self.kinds.get(target) in STEPS:
            return [target]
        return [] if target in seen else self._downstream(target, seen | {target})

    def _check_predecessor(self, symbol: int) -> None:
        for source in self.inputs.get(symbol, ()):
            if self.kinds.get(source) in STEPS:
                self._problem("SFC106", symbol, "a step leads here without a transition between")

    def _problem(self, code: str, symbol: int, detail: str) -> None:
        self.wiring.problems.append(WiringProblem(code, symbol, detail))


class Branches:
    """Nested branches of a drawing in which every divergence has its convergence.

    `kinds` gives the kind of each symbol by id, `inputs` the ids wired to its inputs.
    """

    def __init__(self, kinds: Mapping[int, SymbolKind], inputs: Mapping[int, Iterable[int]]) -> None:
        self._kinds = kinds
        self._inputs = inputs
        self._followers = grouped((source, number) for number, sources in inputs.items() for source in sources)

    @classmethod
    def of(cls, drawing: Drawing) -> Branches:
        """Return the branches of `drawing`."""
        return cls({symbol.id: symbol.kind for symbol in drawing.symbols}, inputs_of(drawing))

    def followers(self, symbol: int) -> list[int]:
        """Return the symbols of the flow that a symbol is wired to, in the order in which they are drawn."""
        return [each for each in self._followers.get(symbol, ()) if self._kinds.get(each) in FLOW]

    def end(self, divergence: int) -> int | None:
        """Return the convergence at which the branches below a divergence meet."""
        depth, seen = 0, {divergence}
        below = self.followers(divergence)
        while below and below[0] not in seen:
            seen.add(below[0])
            kind = self._kinds[below[0]]
            if kind in CONVERGENCES and depth == 0:
                return below[0]
            depth += (kind in DIVERGENCES) - (kind in CONVERGENCES)
            below = self.followers(below[0])
        return None

    def held_by(self, symbol: int) -> set[int]:
        """Return the steps and transitions in the branches of a divergence, or before a jump: those that lead to it."""
        end = self.end(symbol) if self._kinds[symbol] in DIVERGENCES else None
        found, pending = {symbol}, [symbol]
        for each in pending:  # grows while it is walked
            further = self._joined_before(each) if end is None else self.followers(each) if each != end else []
            pending += [other for other in further if other not in found]
            found.update(further)
        return {each for each in found if self._kinds.get(each) in STEPS or self._kinds.get(each) == _TRANSITION}

    def _joined_before(self, symbol: int) -> list[int]:
        kind = self._kinds.get(symbol)
        return [*self._inputs.get(symbol, ())] if kind in (_JUMP, SymbolKind.SELECTION_CONVERGENCE) else []
