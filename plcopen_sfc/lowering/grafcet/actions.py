"""Stored actions of IEC 60848:2013, 4.8, as code: each is executed in the evolution of its event."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import NamedTuple

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    is_constant,
    negation,
    simplified,
)
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.program import StepValue
from plcopen_sfc.lowering.reading.grafcet_source import StoredAction
from plcopen_sfc.model.actions import ActionKind


class StepSights(NamedTuple):
    """What can be seen of a step: whether it is `active`, and was so `before` the present evolution.

    `fresh`: whether the evolution before this one has activated it.
    """

    active: StepValue
    before: StepValue
    fresh: StepValue


class Event(NamedTuple):
    """What tells that an event happens, and the action that it executes."""

    happens: Expression
    action: StoredAction

    def named(self, memory: Memory, wanted: str, into: list[Statement]) -> Event:
        """The same with a variable that says so."""
        return Event(memory.named(wanted, self.happens, into), self.action)


class StoredActions:
    """`bits`: names of BOOL variables, in lower case, that are assigned by logic and not under a condition."""

    def __init__(
        self, actions: Sequence[StoredAction], memory: Memory, sights: StepSights, bits: Collection[str] = ()
    ) -> None:
        self._actions, self._memory, self._bits = actions, memory, bits
        self._active, self._before, self._fresh = sights

    def events(self) -> list[Event]:
        """What happens to active steps, but for the event that has activated them, and what it executes."""
        found: list[Event] = []
        for action in self._actions:
            if action.event is not None:
                ready = [conjunction([self._active(i), negation(self._fresh(i))]) for i in action.steps]
                found.append(Event(conjunction([disjunction(ready), action.event]), action))
        return found

    def on_events(self, events: Iterable[Event]) -> list[Statement]:
        """What events execute."""
        return [statement for event in events for statement in self._executed(*event)]

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

    def ended(self, restart: Expression, initial: Iterable[int], booleans: Collection[str]) -> list[Statement]:
        """What makes the stored Boolean variables what they are at the start: FALSE, or what `initial` steps store.

        `booleans` are names of variables in lower case; others are known by what they get.
        """
        started = set(initial)
        values: dict[Expression, Expression] = {}
        for action in self._actions:
            starts = action.kind is ActionKind.ON_ACTIVATION and started.intersection(action.steps)
            for statement in action.statements:
                if not isinstance(statement, n.Assignment):
                    continue
                target, sets = statement.target, is_constant(statement.value, TRUE)
                named = isinstance(target, n.Name) and target.identifier.casefold() in booleans
                if named or sets or is_constant(statement.value, FALSE):
                    values.setdefault(target, FALSE)
                    values[target] = TRUE if starts and sets else values[target]
        done = [assignment(target, value) for target, value in values.items()]
        return self._memory.conditional("", restart, done)

    def at_the_start(self, initial: Iterable[int], starting: Expression) -> list[Statement]:
        """What the activation of the initial steps executes, in the scan that is `starting`."""
        started = set(initial)
        found: list[Statement] = []
        for action in self._actions:
            if action.kind is ActionKind.ON_ACTIVATION and started.intersection(action.steps):
                found += self._executed(starting, action)
        return found

    def _executed(self, condition: Expression, action: StoredAction) -> list[Statement]:
        if len(action.statements) == 1 and isinstance(single := action.statements[0], n.Assignment):
            value = simplified(single.value)
            is_bit = isinstance(single.target, n.Name) and single.target.identifier.casefold() in self._bits
            if is_bit and not is_constant(value, TRUE) and not is_constant(value, FALSE):
                return [written_if(condition, single.target, value)]
        return self._memory.conditional("event", condition, action.statements)


def written_if(condition: Expression, target: Expression, value: Expression) -> Statement:
    """The assignment of a BOOL variable under a condition, as plain logic."""
    kept = conjunction([target, negation(condition)])
    return assignment(target, disjunction([conjunction([condition, value]), kept]))
