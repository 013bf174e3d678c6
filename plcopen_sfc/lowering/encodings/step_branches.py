"""Actions in the branches of their steps: statements that ask for a state move into the CASE behind them.

An actions-first profile executes what active steps do, then tries their transitions, as a textbook branch does. A
statement moves where it may be executed later: nothing that stays between reads or writes what it touches.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.effects import ANYTHING, Path, calls, may_change, path_of, reads, writes
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.actions.action_execution import standard_instances
from plcopen_sfc.lowering.code.boolean_logic import FALSE, TRUE, assignment, conjunction, is_constant, negation, when
from plcopen_sfc.lowering.code.code_bodies import comment_lines, indented
from plcopen_sfc.lowering.code.lowered_code import CodeNetwork, TextNetwork
from plcopen_sfc.lowering.reading.chart_source import ChartSource
from plcopen_sfc.model.variables import SectionKind


class UntouchedVariables:
    """Variables of a POU that code outside of it cannot touch, and what a call of its own actions touches.

    `own`: names that only the lowered code knows, in lower case.
    """

    def __init__(self, source: ChartSource, own: Collection[str]) -> None:
        sections = source.pou.interface.sections if source.pou.interface is not None else ()
        local = (v.name.casefold() for each in sections if each.kind in _LOCAL for v in each.variables if not v.address)
        self.private = {*own, *local}
        self.blocks = standard_instances(source)
        self._bodies = {
            name.rpartition(".")[2].casefold(): set(_WORD.findall(body.model_dump_json().casefold()))
            for name, _, body in source.pou.named_bodies()
            if "." in name
        }

    def called(self, name: str) -> set[str]:
        """Return the words in all that a call of this name executes in the POU."""
        found: set[str] = set()
        waiting = [name]
        while waiting:
            words = self._bodies.get(waiting.pop(), set()) - found
            found |= words
            waiting += words & self._bodies.keys()
        return found


_LOCAL = (SectionKind.LOCAL, SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.TEMP)
_WORD = re.compile(r"\w+")


class Effect:
    """Variables that code reads and writes. What it calls may touch all that is not private."""

    def __init__(self, scope: UntouchedVariables) -> None:
        self._scope = scope
        self.reading: set[Path] = set()
        self.writing: set[Path] = set()
        self.is_open = False

    def add(self, trees: Iterable[Expression | Statement]) -> None:
        """Add the effects of expressions and statements."""
        for tree in trees:
            self.reading |= reads(tree)
            written = writes(tree, self._scope.blocks)
            self.writing |= written - {ANYTHING}
            if ANYTHING not in written:
                continue
            self.is_open = True
            # a pointer may lead to any variable, a name that is read at a call may be passed by reference
            if any(isinstance(node, n.Dereference | n.Unreadable) for node in walk(tree)):
                self.writing.add(ANYTHING)
            self.writing |= reads(tree)
            self.writing |= {(word,) for path in calls(tree) if len(path) == 1 for word in self._scope.called(path[0])}

    def conflicts(self, other: Effect) -> bool:
        """Return True if one of them touches what the other one writes."""
        return self._disturbs(other) or other._disturbs(self)

    def _disturbs(self, other: Effect) -> bool:
        if may_change(frozenset(other.reading | other.writing), frozenset(self.writing), frozenset()):
            return True
        touched = self.reading | self.writing
        return other.is_open and (
            self.is_open or any(path[:1] == () or path[0] not in self._scope.private for path in touched)
        )


@dataclass(frozen=True)
class BranchCode:
    """Something that a step does: statements, or a text with comments instead. `entering`: when it becomes active."""

    statements: tuple[Statement, ...]
    entering: bool = False
    comment: str = ""
    text: str = ""


@dataclass(frozen=True)
class _Parts:
    """A statement divided into what may move into branches, by steps, and what stays; `stays` comes first."""

    stays: tuple[Statement, ...]
    moves: tuple[tuple[int, BranchCode], ...]


class StepBranches:
    """Code of one region in the branches of its steps.

    `state` is the variable of its CASE, `last` the one with the state of the last scan, `steps` give the steps by the
    states that the code writes.
    """

    def __init__(
        self,
        state: Expression,
        last: Expression | None,
        steps: Mapping[Expression, int],
        scope: UntouchedVariables,
    ) -> None:
        self._state, self._last, self._steps = state, last, steps
        self._scope, self._passed = scope, Effect(scope)
        if last is not None:
            self._passed.writing.add(path_of(last))  # it is brought up to date before the CASE
        self.code: dict[int, list[BranchCode]] = {}

    def take(self, networks: list[CodeNetwork | TextNetwork]) -> list[CodeNetwork | TextNetwork]:
        """Take from `networks`, which stand before the CASE, what can move into it; return what stays."""
        stay: list[CodeNetwork | TextNetwork] = []
        for network in reversed(networks):
            kept = self._text_taken(network) if isinstance(network, TextNetwork) else self._taken(network)
            if kept is not None:
                stay.insert(0, kept)
        for code in self.code.values():
            code.reverse()
        return stay

    @property
    def enters(self) -> bool:
        """True if something is done when a step becomes active."""
        return any(each.entering for code in self.code.values() for each in code)

    def _text_taken(self, network: TextNetwork) -> TextNetwork | None:
        guarded = network.guarded
        if guarded is not None:
            step, rest = self._asked(guarded.condition)
            moving = Effect(self._scope)
            moving.add([guarded.condition, *guarded.statements])
            if step is not None and is_constant(rest, TRUE) and not moving.conflicts(self._passed):
                self.code.setdefault(step, []).append(BranchCode((), comment=network.comment, text=guarded.text))
                return None
            self._passed.add([guarded.condition, *guarded.statements])
        else:
            self._passed.writing.add(ANYTHING)
            self._passed.is_open = True
        return network

    def _taken(self, network: CodeNetwork) -> CodeNetwork | None:
        if network.remarks:
            self._passed.add(network.statements)
            return network
        kept: list[Statement] = []
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
                moving.append((step, replace(code, comment=network.comment) if alone else code))
            for step, code in moving:
                self.code.setdefault(step, []).append(code)
            self._passed.add(stays)
            kept[:0] = stays
        return replace(network, statements=tuple(kept)) if kept else None

    # -- what asks for a state

    def _divided(self, statement: Statement) -> _Parts | None:
        match statement:
            case n.Case(state, branches, None) if state == self._state:
                return self._case(branches, entering=False)
            case n.If(
                (n.Branch(n.Operation(Operator.UNEQUAL, (left, right)), (n.Case(state, branches, None),)),), None
            ):
                if {left, right} == {self._state, self._last} and state == self._state:
                    return self._case(branches, entering=True)
            case n.If((first,), None):
                return self._if(first)
            case n.If((first, n.Branch(condition, statements)), None):
                parts = self._if(first)
                if parts is None:
                    return None
                # the second branch: not while the first one is executed
                ended = when(conjunction([condition, negation(first.condition)]), *statements)
                return _Parts((ended,), parts.moves)
            case n.Assignment(target, value, n.AssignmentKind.ASSIGN):
                stored = self._stored(target, value)
                if stored is not None:
                    return stored
                step, rest = self._asked(value)
                if step is not None:
                    on = BranchCode((assignment(target, rest),))
                    return _Parts((assignment(target, FALSE),), ((step, on),))
        return None

    def _case(self, branches: tuple[n.CaseBranch, ...], *, entering: bool) -> _Parts | None:
        found: list[tuple[int, BranchCode]] = []
        for branch in branches:
            (label,) = branch.labels
            assert not isinstance(label, n.Range)  # noqa: S101  # our own code
            found.append((self._steps[label], BranchCode(branch.statements, entering)))
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
        first, *others = _operands(value, Operator.AND)
        sets = [each for each in _operands(first, Operator.OR) if each != target]
        resets = [each for other in others for each in _operands(negation(other), Operator.OR)]
        if len(sets) == len(_operands(first, Operator.OR)):
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
        operands = _operands(condition, Operator.AND)
        for operand in operands:
            match n.bare(operand):
                case n.Operation(Operator.EQUAL, (state, value)) if state == self._state and value in self._steps:
                    return self._steps[value], conjunction(each for each in operands if each is not operand)
        return None, condition


def _operands(expression: Expression, operator: Operator) -> tuple[Expression, ...]:
    inner = n.bare(expression)
    return inner.operands if isinstance(inner, n.Operation) and inner.operator is operator else (inner,)


def branch_lines(code: Iterable[BranchCode], entered: Expression | None, text: Callable[[n.Node], str]) -> list[str]:
    """Return what a step does as lines; `entered` is TRUE in the scan in which it becomes active."""
    lines: list[str] = []
    for each in code:
        done = (each.text or text(n.Statements(each.statements))).splitlines()
        if each.entering and entered is not None:
            done = [f"IF {text(entered)} THEN", *indented(done), "END_IF;"]
        lines += [*comment_lines(each.comment), *done]
    return lines
