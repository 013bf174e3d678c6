"""The parameters of an S7-GRAPH block as code: its commands, its operating mode, and its reports."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    equal,
    is_constant,
    negation,
    when,
    without_constant,
)
from plcopen_sfc.lowering.code.code_memory import Memory
from plcopen_sfc.lowering.code.lowered_code import INT, LoweredCode
from plcopen_sfc.lowering.graph.sequencer_source import GraphSource
from plcopen_sfc.lowering.graph.step_supervision import SupervisionChecks
from plcopen_sfc.semantics.charts.graph.graph_parameters import MODES, Mode


class BlockCommands:
    """Commands and the mode of one cycle. Names are those of the parameters."""

    def __init__(self, source: GraphSource, memory: Memory) -> None:
        code = memory.code
        self._parameters, self._code, self._texts, self._memory = source.parameters, code, code.texts, memory
        self._edges: dict[str, Expression] = {}
        self._statements: list[Statement] = []
        switches = [name for name in MODES if name in source.parameters]
        self._modes = {MODES[name][0]: name for name in switches} if not source.locked else {}
        self._mode: n.Name | None = None
        if set(self._modes) - {Mode.AUTOMATIC}:
            self._mode = code.declare(
                code.texts.mode, INT, initial=str(int(Mode.AUTOMATIC)), comment=code.texts.mode_comment
            )
            # a switch acts by its rising edge, and the last one wins, as in S7-GRAPH
            for mode, name in self._modes.items():
                number = n.Literal(str(int(mode)))
                self._statements.append(when(self.edge(name), assignment(self._mode, number)))

    def variable(self, name: str) -> n.Name | None:
        """Return the variable of a parameter; None where the block does not have it."""
        declared = self._parameters.get(name)
        return self._code.naming.local(declared) if declared is not None else None

    def edge(self, name: str) -> Expression:
        """Return an expression that is TRUE if a parameter rises; FALSE where the block does not have it."""
        if name not in self._edges:
            variable = self.variable(name)
            wanted = self._code.texts.with_suffix(name, "edge")
            self._edges[name] = FALSE if variable is None else self._memory.rising(wanted, variable, self._statements)
        return self._edges[name]

    @property
    def mode_comment(self) -> str:
        """Return the comment on the mode, where there are several."""
        return self._texts.mode_comment if self._mode is not None else ""

    def statements(self) -> Sequence[Statement]:
        """Return the edges in use, and the mode, for a place before all code that reads them."""
        return self._statements

    def is_on(self, mode: Mode) -> Expression:
        """Return an expression that is TRUE if the sequencer is in this mode."""
        if self._mode is None:
            return TRUE if mode is Mode.AUTOMATIC else FALSE
        if mode is not Mode.AUTOMATIC and mode not in self._modes:
            return FALSE
        return equal(self._mode, n.Literal(str(int(mode))))

    def permitted(self) -> Expression:
        """Return an expression that is TRUE if transitions that are satisfied switch."""
        # step by step: a satisfied transition waits for a push of T_PUSH
        inching = negation(conjunction([self.is_on(Mode.INCHING), negation(self.edge("T_PUSH"))]))
        if Mode.INCHING not in self._modes:
            inching = TRUE
        return conjunction([negation(self.is_on(Mode.MANUAL)), inching])

    def pushed(self) -> Expression:
        """Return an expression that is TRUE if transitions switch although they are not satisfied."""
        if Mode.AUTOMATIC_OR_STEP_BY_STEP not in self._modes:
            return FALSE
        # in this mode the push switches whatever the condition is, and satisfied transitions switch by themselves too
        return conjunction([self.is_on(Mode.AUTOMATIC_OR_STEP_BY_STEP), self.edge("T_PUSH")])


_NONE = n.Literal("0")
_FEW = 6
"""Steps that one expression can ask for and still be read."""


def add_reports(
    source: GraphSource,
    code: LoweredCode,
    commands: BlockCommands,
    steps: Sequence[tuple[Expression, SupervisionChecks]],
    *,
    state: n.Name | None,
) -> None:
    """Append the outputs that the block has. `steps`: the flags of steps, and their checks.

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
    code.add(code.texts.reports, statements)
    if not {"S_NO", "S_ACTIVE", "S_MORE"} & set(source.parameters):
        return
    if state is not None:
        code.add(code.texts.display, list(_one_displayed(commands, state)))
    else:
        code.add(code.texts.display, list(_Display(source, code, commands, [flag for flag, _ in steps]).statements()))


def _one_displayed(commands: BlockCommands, state: n.Name) -> Iterator[Statement]:
    """Yield the display of at most one active step: the one selected by hand, else that one."""
    number, more, active = (commands.variable(name) for name in ("S_NO", "S_MORE", "S_ACTIVE"))
    selection, by_hand = commands.variable("S_SEL"), commands.is_on(Mode.MANUAL)
    some = negation(equal(state, _NONE))
    other: Expression = FALSE  # the step displayed is another one than the active one
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
    """Step displayed: the one selected by hand, else the one shown before while it is active, else the first."""

    def __init__(
        self,
        source: GraphSource,
        code: LoweredCode,
        commands: BlockCommands,
        flags: Sequence[Expression],
    ) -> None:
        self._commands, self._code, self._texts = commands, code, code.texts
        numbered = [(step.step.number or 0, flags[step.index]) for step in source.net.steps]
        self._steps = sorted(numbered, key=lambda item: item[0])
        self._active: n.Name | None = None
        self._shown = code.declare(self._texts.shown, INT, comment=self._texts.shown_comment)

    def statements(self) -> Iterator[Statement]:
        """Yield the choice of the step, then the outputs about it."""
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
        # a step that is no longer active is not shown: the first active one is
        branches.append(n.Branch(negation(active), tuple(self._first())))
        for command, steps, beyond in (
            ("S_NEXT", self._steps, n.Operator.GREATER),
            ("S_PREV", self._steps[::-1], n.Operator.LESS),
        ):
            edge = self._commands.edge(command)
            if not is_constant(edge, FALSE) and steps:
                branches.append(n.Branch(edge, tuple(self._other(steps, beyond))))
        yield from without_constant(n.If(tuple(branches)))

    def _shown_is_active(self) -> tuple[Sequence[Statement], Expression]:
        """Return an expression that is TRUE if the step displayed is active, and the statements that find that out."""
        # networks have no CASE; in text a CASE is easier to read from some steps on
        if len(self._steps) <= _FEW or self._code.drawn:
            return (), disjunction(
                conjunction([flag, equal(self._shown, n.Literal(str(number)))]) for number, flag in self._steps
            )
        if self._active is None:
            self._active = self._code.declare(self._texts.shown_active)
        flags = grouped((number, flag) for number, flag in self._steps)
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
        """Return the next active step behind the one shown; behind the last one the first."""
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
        """Yield the report that more than one step is active."""
        flags = [flag for _, flag in self._steps]
        if len(flags) <= _FEW:
            # more than one step is active if any is together with one behind it
            pairs = (conjunction([a, disjunction(flags[i + 1 :])]) for i, a in enumerate(flags[:-1]))
            yield assignment(more, disjunction(pairs))
            return
        any_ = self._code.declare(self._texts.any_active)
        yield assignment(more, FALSE)
        yield assignment(any_, FALSE)
        for flag in flags:
            yield assignment(more, disjunction([more, conjunction([any_, flag])]))
            yield assignment(any_, disjunction([any_, flag]))
