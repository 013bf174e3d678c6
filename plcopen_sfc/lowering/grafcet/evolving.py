"""What an evolution changes, by the construction: what was before it, and whether a transition was cleared."""

from __future__ import annotations

from typing import Protocol

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.actions.drive import Signal
from plcopen_sfc.lowering.chains.steps import StepFlags
from plcopen_sfc.lowering.code.logic import FALSE, assignment, disjunction, equal, negation
from plcopen_sfc.lowering.grafcet.case import GrafcetCase


class Evolving(Protocol):
    """What the scan of a GRAFCET asks of a construction."""

    def before(self, step: int) -> Expression:
        """Whether a step was active before the present evolution."""

    def remembered(self) -> list[Statement]:
        """What keeps that: to be executed before anything changes. Complete when everything has been asked."""

    def signals(self) -> dict[Expression, Signal]:
        """What tells of steps before the evolution by more than a variable, as far as it has been asked."""

    def fired(self, transition: int) -> Expression:
        """Whether a transition was cleared in this evolution."""

    def moving(self) -> Expression:
        """Whether any was."""


class EvolvingFlags:
    """Step flags and bits of transitions."""

    def __init__(self, chain: StepFlags) -> None:
        self._chain = chain
        self._olds: dict[int, n.Name] = {}

    def before(self, step: int) -> Expression:
        """A copy of the flag."""
        if step not in self._olds:
            name = self._chain.texts.flag_name(self._chain.net.steps[step].step)
            self._olds[step] = self._chain.code.declare(self._chain.texts.with_suffix(name, "old"))
        return self._olds[step]

    def remembered(self) -> list[Statement]:
        """The flags that anyone asks for."""
        return [assignment(old, self._chain.flags[step]) for step, old in sorted(self._olds.items())]

    def signals(self) -> dict[Expression, Signal]:
        """None: all of them are variables."""
        return {}

    def fired(self, transition: int) -> Expression:
        """Its bit."""
        return self._chain.fired[transition]

    def moving(self) -> Expression:
        """Any of the bits."""
        return disjunction(self._chain.fired)


class EvolvingState:
    """The state of a CASE, in which no transition leads back to its own step."""

    def __init__(self, chain: GrafcetCase) -> None:
        self._chain = chain
        self._state = chain.machines[0].state
        self._old: n.Name | None = None

    def before(self, step: int) -> Expression:
        """A comparison of a copy of the state."""
        return equal(self._copy(), self._chain.names.step(step))

    def remembered(self) -> list[Statement]:
        """The state, if anyone asks for it."""
        return [assignment(self._old, self._state)] if self._old is not None else []

    def signals(self) -> dict[Expression, Signal]:
        """Comparisons of the copy."""
        if self._old is None:
            return {}
        flags = ((self.before(s.index), self._chain.texts.flag_name(s.step)) for s in self._chain.net.steps)
        return {before: Signal(self._chain.texts.with_suffix(flag, "old"), "") for before, flag in flags}

    def fired(self, transition: int) -> Expression:  # noqa: ARG002
        """Nothing tells, and nobody asks where steps are not left and entered at once."""
        return FALSE

    def moving(self) -> Expression:
        """The state is another one."""
        return negation(equal(self._state, self._copy()))

    def _copy(self) -> n.Name:
        if self._old is None:
            code = self._chain.code
            kind = next(v.type for v in code.variables if v.name == self._state.identifier)
            self._old = code.declare(code.texts.with_suffix(self._state.identifier, "old"), kind)
        return self._old
