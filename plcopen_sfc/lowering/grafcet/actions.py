"""Stored actions of IEC 60848:2013, 4.8, as code: each is executed in the evolution of its event."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.grafcet.source import StoredAction
from plcopen_sfc.lowering.logic import conjunction, disjunction, negation
from plcopen_sfc.lowering.memory import Memory
from plcopen_sfc.model.actions import ActionKind

StepValue = Callable[[int], Expression]
"""Something of a step, given by its index in the net."""


class StoredActions:
    """`active` tells whether a step is active, `before` whether it was before the present evolution.

    `fresh` tells whether the evolution before this one has activated it.
    """

    def __init__(
        self,
        actions: Sequence[StoredAction],
        memory: Memory,
        active: StepValue,
        before: StepValue,
        fresh: StepValue,
    ) -> None:
        self._actions, self._memory = actions, memory
        self._active, self._before, self._fresh = active, before, fresh

    def on_events(self) -> list[Statement]:
        """What events execute: while the step is active, and not by the event that has activated it."""
        found: list[Statement] = []
        for action in self._actions:
            if action.event is not None:
                ready = [conjunction([self._active(i), negation(self._fresh(i))]) for i in action.steps]
                found += self._executed(conjunction([disjunction(ready), action.event]), action)
        return found

    def on_changes(self) -> list[Statement]:
        """What deactivations execute, then what activations do."""
        found: list[Statement] = []
        for kind, was, is_ in (
            (ActionKind.ON_DEACTIVATION, self._before, self._active),
            (ActionKind.ON_ACTIVATION, self._active, self._before),
        ):
            for action in self._actions:
                if action.kind is kind:
                    one = disjunction(was(i) for i in action.steps)
                    none = [negation(is_(i)) for i in action.steps]
                    found += self._executed(conjunction([one, *none]), action)
        return found

    def at_the_start(self, initial: Iterable[int]) -> list[Statement]:
        """What the activation of the initial steps executes."""
        started = set(initial)
        return [
            statement
            for action in self._actions
            if action.kind is ActionKind.ON_ACTIVATION and started.intersection(action.steps)
            for statement in action.statements
        ]

    def _executed(self, condition: Expression, action: StoredAction) -> list[Statement]:
        return self._memory.conditional("event", condition, action.statements)
