"""The actions of IEC 60848:2013, 4.8, as code: stored ones in the evolution of their event, continuous ones behind."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code import Code
from plcopen_sfc.lowering.grafcet.source import StoredAction
from plcopen_sfc.lowering.logic import assignment, conjunction, disjunction, negation
from plcopen_sfc.lowering.memory import Memory
from plcopen_sfc.lowering.source import ActionSource, Use
from plcopen_sfc.lowering.texts import Texts
from plcopen_sfc.lowering.times import StepTimes
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.types import DerivedType

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


class ContinuousActions:
    """The outputs of continuous actions in the situation that a scan ends with.

    `timers`: those of macro-steps, with what starts each and its time. Like those of steps (`times`) they are to be
    called behind the evolutions.
    """

    def __init__(
        self, actions: Sequence[ActionSource], code: Code, memory: Memory, active: StepValue, times: StepTimes
    ) -> None:
        self._code, self._memory, self._active, self._times = code, memory, active, times
        self.timers: list[tuple[n.Name, Expression, Expression]] = []
        self._driven = [(action, disjunction(self._of(use, action) for use in action.uses)) for action in actions]

    def add(self, texts: Texts) -> None:
        """Append a network for each action."""
        driven = self._driven
        if self._one_reads_another():
            values: list[Statement] = []
            driven = [(action, self._memory.named(f"{action.name}_on", value, values)) for action, value in driven]
            self._code.add(texts.actions, values)
        for action, value in driven:
            if action.target is not None:
                statements: list[Statement] = [assignment(action.target, value)]
            else:
                statements = self._memory.conditional(f"{action.name}_on", value, action.statements)
            self._code.add(texts.action(action.name), statements)

    def _one_reads_another(self) -> bool:
        """Whether an action depends on what one before it may have written: all are decided on before any acts."""
        written: set[str] = set()
        for action, value in self._driven:
            if written & _names([value]):
                return True
            written |= _names([action.target] if action.target is not None else action.statements)
        return False

    def _of(self, use: Use, action: ActionSource) -> Expression:
        active = disjunction(self._active(step) for step in use.steps)
        terms = [negation(active) if use.inverted else active, use.condition]
        if use.duration is not None:
            over = self._is_over(use, use.duration, active, action)
            terms.append(over if use.qualifier is Qualifier.D else negation(over))
        return conjunction(terms)

    def _is_over(self, use: Use, duration: Expression, active: Expression, action: ActionSource) -> Expression:
        """Whether the step, or any step of the macro-step, has been active for the time."""
        if len(use.steps) == 1:
            if isinstance(duration, n.Literal):
                return self._times.is_over(use.steps[0], duration)
            return n.Operation(n.Operator.GREATER_OR_EQUAL, (self._times.elapsed(use.steps[0]), duration))
        timer = self._code.declare(f"{action.name}_{use.qualifier}", DerivedType(name="TON"))
        self.timers.append((timer, active, duration))
        return n.Member(timer, n.Name("Q"))


def _names(trees: Iterable[n.Node]) -> set[str]:
    return {node.identifier.casefold() for tree in trees for node in walk(tree) if isinstance(node, n.Name)}
