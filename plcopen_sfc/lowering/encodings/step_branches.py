"""Actions in the branches of their steps: statements that ask for a state move into the CASE behind them.

An actions-first profile executes what active steps do, then tries their transitions, as a textbook branch does. A
statement moves where it may be executed later: nothing that stays between reads or writes what it touches.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from plcopen_sfc.languages.effects import path_of
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.actions.action_execution import StepCode
from plcopen_sfc.lowering.actions.variable_access import Effect, UntouchedVariables
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    equal,
    is_constant,
    negation,
    not_all,
    operands_of,
    remark,
    when,
)
from plcopen_sfc.lowering.code.lowered_code import CodeNetwork
from plcopen_sfc.lowering.encodings.case_states import RegionState, StateVariables, branch_content


@dataclass(frozen=True)
class BranchCode:
    """Something that a step does, with its comment. `entering`: when it becomes active."""

    statements: tuple[Statement, ...]
    entering: bool = False
    comment: str = ""

    def written(self, entered: Expression | None) -> list[Statement]:
        """Return the statements; `entered` is TRUE in the scan in which the step becomes active."""
        done = self.statements
        if self.entering and entered is not None:
            done = (when(entered, *done),)
        return [*remark(self.comment), *done]


@dataclass(frozen=True)
class _Parts:
    """A statement divided into what may move into branches, by steps, and what stays; `stays` comes first."""

    stays: tuple[Statement, ...]
    moves: tuple[tuple[int, BranchCode], ...]


class StepBranches:
    """Code of one region in the branches of its steps.

    `last` is the variable with the state of the last scan. `whole`: only statements move that do nothing without a
    state of these steps, with their titles. `between`: what is executed before the CASE, behind what moves.
    """

    def __init__(
        self,
        states: StateVariables,
        machine: RegionState,
        last: Expression | None,
        scope: UntouchedVariables,
        *,
        whole: bool,
        between: Effect | None = None,
    ) -> None:
        self.state, self._states, self._last, self._whole = machine.state, states, last, whole
        self._steps = {states.state_of(step): step for step in states.steps_of(machine)}
        self._scope, self._passed = scope, between or Effect(scope)
        self._memories = {(name,) for name in scope.own}
        self.code: dict[int, list[BranchCode]] = {}

    def can_take(self, network: CodeNetwork) -> bool:
        """Return True if all of a network moves, if nothing is in between."""
        parts = [self._divided(statement) for statement in network.statements]
        return all(part is not None and not part.stays for part in parts)

    def case(self) -> n.Case:
        """Return the CASE that was taken on its own, and forget it."""
        entered = negation(equal(self.state, self._last)) if self._last is not None else None
        parts = [
            StepCode(step, "", [each for one in code for each in one.written(entered)])
            for step, code in sorted(self.code.items())
        ]
        self.code = {}
        return self._states.selection(self.state, parts)

    def take(self, networks: list[CodeNetwork]) -> list[CodeNetwork]:
        """Take from `networks`, which are before the CASE, what can move into it; return what stays."""
        # from the last one: what moves passes by all that stays behind it, which `_passed` collects
        stay: list[CodeNetwork] = []
        for network in reversed(networks):
            kept = self._taken(network)
            stay[:0] = [replace(network, statements=kept)] if kept else []
        for step, code in self.code.items():
            state = self._states.state_of(step)
            self.code[step] = [
                replace(each, statements=tuple(self._states.in_branch(self.state, state, each.statements)))
                for each in reversed(code)
            ]
        return stay

    @property
    def enters(self) -> bool:
        """True if something is done when a step becomes active."""
        return any(each.entering for code in self.code.values() for each in code)

    def _taken(self, network: CodeNetwork) -> tuple[Statement, ...]:
        kept: list[Statement] = []
        comment = "\n".join(filter(None, [network.title if self._whole else network.inside, network.comment]))
        alone = len(network.statements) == 1
        for statement in reversed(network.statements):
            parts = self._divided(statement)
            stays = list(parts.stays) if parts is not None else [statement]
            moving: list[tuple[int, BranchCode]] = []
            for step, code in reversed(parts.moves if parts is not None else ()):
                effect = Effect(self._scope)
                effect.add(code.statements)
                if effect.conflicts(self._passed):
                    moving = []
                    stays = [statement]
                    break
                moving.append((step, replace(code, comment=comment) if alone else code))
            for step, code in moving:
                self.code.setdefault(step, []).append(code)
            self._passed.add(stays)
            kept[:0] = stays
        return tuple(kept)

    # -- what asks for a state

    def _divided(self, statement: Statement) -> _Parts | None:
        match statement:
            case n.Case(state, branches, None) if state == self.state:
                return self._case(branches, entering=False)
            case n.If(
                (n.Branch(n.Operation(Operator.UNEQUAL, (left, right)), (n.Case(state, branches, None),)),), None
            ):
                if {left, right} == {self.state, self._last} and state == self.state:
                    return self._case(branches, entering=True)
            case n.If((first,), None):
                return self._if(first)
            case _ if self._whole:
                return None
            case n.If((first, n.Branch(condition, statements)), None):
                parts = self._if(first)
                if parts is None:
                    return None
                # the second branch: not while the first one is executed
                ended = when(conjunction([condition, not_all(first.condition)]), *statements)
                return _Parts((ended,), parts.moves)
            case n.Assignment(target, value, n.AssignmentKind.ASSIGN):
                stored = self._stored(target, value)
                if stored is not None:
                    return stored
                step, rest = self._asked(value)
                # a memory of the code is no output of the step: one line tells all about it
                if step is not None and path_of(target)[:1] not in self._memories:
                    on = BranchCode((assignment(target, rest),))
                    return _Parts((assignment(target, FALSE),), ((step, on),))
        return None

    def _case(self, branches: tuple[n.CaseBranch, ...], *, entering: bool) -> _Parts | None:
        found: list[tuple[int, BranchCode]] = []
        for branch in branches:
            for label in branch.labels:
                assert not isinstance(label, n.Range)  # noqa: S101  # our own code
                found.append((self._steps[label], BranchCode(branch_content(branch), entering)))
        return _Parts((), tuple(found))

    def _if(self, branch: n.Branch) -> _Parts | None:
        step, rest = self._asked(branch.condition)
        if step is None:
            return None
        entered = self._last is not None and rest in (
            negation(n.Operation(Operator.EQUAL, (self._last, state)))
            for state, at in self._steps.items()
            if at == step
        )
        if entered:
            return _Parts((), ((step, BranchCode(branch.statements, entering=True)),))
        statements = branch.statements if is_constant(rest, TRUE) else (when(rest, *branch.statements),)
        return _Parts((), ((step, BranchCode(statements)),))

    def _stored(self, target: Expression, value: Expression) -> _Parts | None:
        """Return ``Q := (state = 2 OR Q) AND state <> 4`` as what steps 2 and 4 do."""
        first, *others = operands_of(value, Operator.AND)
        sets = [each for each in operands_of(first, Operator.OR) if each != target]
        resets = [each for other in others for each in operands_of(negation(other), Operator.OR)]
        if len(sets) == len(operands_of(first, Operator.OR)):
            return None
        moves: list[tuple[int, BranchCode]] = []
        for asked, constant in [*((each, TRUE) for each in sets), *((each, FALSE) for each in resets)]:
            step, rest = self._asked(asked)
            if step is None or not is_constant(rest, TRUE) or any(step == other for other, _ in moves):
                return None
            moves.append((step, BranchCode((assignment(target, constant),))))
        return _Parts((), tuple(moves)) if moves else None

    def _asked(self, condition: Expression) -> tuple[int | None, Expression]:
        """Return the step that a condition asks for, and the rest of it."""
        operands = operands_of(condition, Operator.AND)
        for operand in operands:
            match n.bare(operand):
                case n.Operation(Operator.EQUAL, (state, value)) if state == self.state and value in self._steps:
                    return self._steps[value], conjunction(each for each in operands if each is not operand)
        return None, condition
