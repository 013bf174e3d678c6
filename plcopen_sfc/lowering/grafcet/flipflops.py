"""Flip-flops for a GRAFCET: reset-dominant as always, although in GRAFCET the activation of a step dominates.

What is left and entered at once stays active (IEC 60848:2013, rule 5): where that can happen, the reset is locked.
Forcing orders set and reset the flip-flops of the charts below, as an emergency stop does: these stand behind those of
the charts above.
"""

from __future__ import annotations

from collections.abc import Sequence

from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.lowering.chains.flipflops import FlipFlopChain
from plcopen_sfc.lowering.code.logic import FALSE, conjunction, disjunction, is_constant, negation
from plcopen_sfc.lowering.grafcet.concurrency import Concurrency, leaving_and_entering
from plcopen_sfc.lowering.grafcet.hierarchy import Ruling
from plcopen_sfc.semantics.net import NetStep


class GrafcetFlipFlops(FlipFlopChain):
    """Lowers one chart into `code`. `ruled` are the charts that others rule, those above first.

    `first`: TRUE in the first evolution only, where a scan can have several of them.
    """

    ruled: Sequence[Ruling] = ()
    concurrency: Concurrency
    first: Expression | None = None

    def move(self) -> None:
        """Append a network for each step, those of ruled charts behind those of the charts that rule them."""
        below = {step: ruling for ruling in self.ruled for step in ruling.steps}
        for step in self.net.steps:
            if step.index not in below:
                self._add_ruled(step, None)
        for ruling in self.ruled:
            for index in ruling.steps:
                self._add_ruled(self.net.steps[index], ruling)

    def _add_ruled(self, step: NetStep, ruling: Ruling | None) -> None:
        leaving, entering = leaving_and_entering(self.net, step.index)
        set_: list[Expression] = [self.fired[t.index] for t in entering if t not in leaving]
        reset: list[Expression] = []
        for transition in leaving:
            if transition in entering:
                continue
            again = [t for t in entering if self.concurrency.both_fire(transition, t)]
            reset.append(conjunction([self.fired[transition.index], *(negation(self.fired[t.index]) for t in again)]))
        if ruling is not None:
            set_, reset = self._ruled(step.index, ruling, set_, reset)
        if self.net.initial & step.bit:
            set_.insert(0, self.first if self.first is not None else self.memory.starting())
        self._add_step(step, set_, reset)

    def _ruled(
        self, step: int, ruling: Ruling, set_: list[Expression], reset: list[Expression]
    ) -> tuple[list[Expression], list[Expression]]:
        """The inputs of a flip-flop with what orders and enclosing steps want; reset dominates."""
        earlier: list[Expression] = []
        sets: list[Expression] = []
        resets: list[Expression] = []
        locked: list[Expression] = []
        frozen: list[Expression] = []
        for when, situation in ruling.situations():
            acting = conjunction([when, *(negation(each) for each in earlier)])
            earlier.append(when)
            value = situation[step]
            if value is None:
                frozen.append(acting)
            elif is_constant(value, FALSE):
                resets.append(acting)
            else:
                sets.append(conjunction([acting, value]))
                resets.append(conjunction([acting, negation(value)]))
                locked.append(acting)
        free = [negation(each) for each in frozen]
        set_ = [conjunction([disjunction(set_), *free]), *sets]
        reset = [conjunction([disjunction(reset), *free, *(negation(each) for each in locked)]), *resets]
        return set_, reset
