"""The outputs of an S7-GRAPH block as code: the mode, the step displayed, and whether there is an error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.logic import (
    FALSE,
    assignment,
    conjunction,
    disjunction,
    equal,
    is_constant,
    negation,
    when,
)
from plcopen_sfc.lowering.code.program import INT, Code
from plcopen_sfc.lowering.graph.checks import StepChecks
from plcopen_sfc.lowering.graph.commands import Commands
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.lowering.graph.texts import GraphTexts
from plcopen_sfc.semantics.charts.graph.parameters import MODES, Mode

_NONE = n.Literal("0")
_FEW = 6
"""Steps that one expression can ask for and still be read."""


def add_reports(
    source: GraphSource,
    code: Code,
    commands: Commands,
    steps: Sequence[tuple[Expression, StepChecks]],
    texts: GraphTexts,
    *,
    state: n.Name | None,
) -> None:
    """Append what writes the outputs that the block has. `steps`: what tells that they are active, and their checks.

    `state` is the number of the only active step, 0 where none is, if there is such a variable.
    """
    statements = [
        assignment(lamp, commands.is_on(mode))
        for mode, name in MODES.values()
        if (lamp := commands.variable(name)) is not None
    ]
    disturbance = commands.variable("ERR_FLT")
    if disturbance is not None:
        statements.append(assignment(disturbance, disjunction(check.disturbed() for _, check in steps)))
    code.add(texts.reports, statements)
    if not {"S_NO", "S_ACTIVE", "S_MORE"} & set(source.parameters):
        return
    if state is not None:
        code.add(texts.display, list(_one_displayed(commands, state)))
    else:
        code.add(texts.display, list(_Display(source, code, commands, [flag for flag, _ in steps], texts).statements()))


def _one_displayed(commands: Commands, state: n.Name) -> Iterator[Statement]:
    """Of one active step at most: the one selected by hand, else that one."""
    number, more, active = (commands.variable(name) for name in ("S_NO", "S_MORE", "S_ACTIVE"))
    selection, by_hand = commands.variable("S_SEL"), commands.is_on(Mode.MANUAL)
    some = negation(equal(state, _NONE))
    other: Expression = FALSE
    if number is not None:
        yield assignment(number, state)
    if selection is not None and not is_constant(by_hand, FALSE):
        selected = conjunction([by_hand, negation(equal(selection, _NONE))])
        other = conjunction([selected, negation(equal(selection, state))])
        if number is not None:
            yield when(selected, assignment(number, selection))
            other = negation(equal(number, state))
    if more is not None:
        yield assignment(more, FALSE)
    if active is not None:
        yield assignment(active, conjunction([some, negation(other)]))


class _Display:
    """The step displayed: the one selected by hand, else the one shown before while it is active, else the first."""

    def __init__(
        self, source: GraphSource, code: Code, commands: Commands, flags: Sequence[Expression], texts: GraphTexts
    ) -> None:
        self._commands, self._code, self._texts = commands, code, texts
        numbered = [(step.step.number or 0, flags[step.index]) for step in source.net.steps]
        self._steps = sorted(numbered, key=lambda item: item[0])
        self._active: n.Name | None = None
        self._shown = code.declare(texts.shown, INT, comment=texts.shown_comment)

    def statements(self) -> Iterator[Statement]:
        """In this order: which step, then what is told of it."""
        commands = self._commands
        yield from self._choice()
        number = commands.variable("S_NO")
        if number is not None:
            yield assignment(number, self._shown)
        more = commands.variable("S_MORE")
        if more is not None:
            yield from self._several(more)
        active = commands.variable("S_ACTIVE")
        if active is not None:
            statements, value = self._shown_is_active()
            yield from (*statements, assignment(active, value))

    def _choice(self) -> Iterator[Statement]:
        by_hand = self._commands.is_on(Mode.MANUAL)
        selection = self._commands.variable("S_SEL")
        branches: list[n.Branch] = []
        if selection is not None and not is_constant(by_hand, FALSE):
            selected = n.Operation(n.Operator.UNEQUAL, (selection, _NONE))
            branches.append(n.Branch(conjunction([by_hand, selected]), (assignment(self._shown, selection),)))
        statements, active = self._shown_is_active()
        yield from statements
        branches.append(n.Branch(negation(active), tuple(self._first())))
        for command, steps, beyond in (
            ("S_NEXT", self._steps, n.Operator.GREATER),
            ("S_PREV", self._steps[::-1], n.Operator.LESS),
        ):
            edge = self._commands.edge(command)
            if not is_constant(edge, FALSE) and steps:
                branches.append(n.Branch(edge, tuple(self._other(steps, beyond))))
        yield n.If(tuple(branches))

    def _shown_is_active(self) -> tuple[Sequence[Statement], Expression]:
        """Whether the step displayed is active, and what finds that out."""
        if len(self._steps) <= _FEW or self._code.drawn:
            return (), disjunction(
                conjunction([flag, equal(self._shown, n.Literal(str(number)))]) for number, flag in self._steps
            )
        if self._active is None:
            self._active = self._code.declare(self._texts.shown_active)
        flags: dict[int, list[Expression]] = {}
        for number, flag in self._steps:
            flags.setdefault(number, []).append(flag)
        branches = tuple(
            n.CaseBranch((n.Literal(str(number)),), (assignment(self._active, disjunction(found)),))
            for number, found in flags.items()
        )
        return (n.Case(self._shown, branches, (assignment(self._active, FALSE),)),), self._active

    def _first(self) -> list[Statement]:
        none = assignment(self._shown, _NONE)
        branches = [n.Branch(flag, (self._show(number),)) for number, flag in self._steps]
        return [n.If(tuple(branches), (none,)) if branches else none]

    def _other(self, steps: Sequence[tuple[int, Expression]], beyond: n.Operator) -> list[Statement]:
        """The next active step behind the one shown; behind the last one the first."""
        further = [
            n.Branch(
                conjunction([flag, n.Operation(beyond, (n.Literal(str(number)), self._shown))]), (self._show(number),)
            )
            for number, flag in steps
        ]
        again = [n.Branch(flag, (self._show(number),)) for number, flag in steps]
        return [n.If((*further, *again))]

    def _show(self, number: int) -> Statement:
        return assignment(self._shown, n.Literal(str(number)))

    def _several(self, more: n.Name) -> Iterator[Statement]:
        """Whether more than one step is active."""
        flags = [flag for _, flag in self._steps]
        if len(flags) <= _FEW:
            pairs = (conjunction([a, disjunction(flags[i + 1 :])]) for i, a in enumerate(flags[:-1]))
            yield assignment(more, disjunction(pairs))
            return
        any_ = self._code.declare(self._texts.any_active)
        yield assignment(more, FALSE)
        yield assignment(any_, FALSE)
        for flag in flags:
            yield assignment(more, disjunction([more, conjunction([any_, flag])]))
            yield assignment(any_, disjunction([any_, flag]))
