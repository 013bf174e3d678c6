"""The actions of steps of S7-GRAPH as code, with their S5 timers.

Coils come first, then what is executed, first by the steps that were left.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.effects import writes
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.actions.action_execution import StepCode
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    call,
    conjunction,
    disjunction,
    equal,
    is_constant,
    negation,
    when,
)
from plcopen_sfc.lowering.code.lowered_code import INT, TIME, LoweredCode, StepValue
from plcopen_sfc.lowering.graph.sequencer_source import ActionRow, GraphSource, texts_of
from plcopen_sfc.model.actions import COUNTERS, TIMERS, ActionEvent, Qualifier
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.model.variables import SectionKind, sections_of
from plcopen_sfc.semantics.net import NetStep

_MODES = {Qualifier.TR: "0", Qualifier.TL: "1", Qualifier.TD: "2", Qualifier.TF: "3"}
"""What a timer does, as a variable of the code has it: stopped, extended pulse, on-delay, off-delay."""
_STOPPED, _DELAY = n.Literal(_MODES[Qualifier.TR]), n.Literal(_MODES[Qualifier.TD])


class S5Timer:
    """One timer, whose output is an operand."""

    def __init__(self, name: str, output: Expression, code: LoweredCode) -> None:
        self._output = output
        called = code.texts.with_suffix
        self._timer = code.declare(called(name, "timer"), DerivedType(name="TON"))
        self._mode = code.declare(called(name, "mode"), INT, comment=code.texts.timer_mode)
        self._runs = code.declare(called(name, "runs"))
        self._starts = code.declare(called(name, "starts"))
        self._time = code.declare(called(name, "time"), TIME)

    def started(self, qualifier: Qualifier, time: Expression | None) -> list[Statement]:
        """Return the statements of TL, TD and TR."""
        statements: list[Statement] = [assignment(self._mode, n.Literal(_MODES[qualifier]))]
        if time is not None and qualifier is not Qualifier.TR:
            statements.append(assignment(self._time, time))
            statements += [assignment(self._runs, TRUE), assignment(self._starts, TRUE)]
        return [*statements, assignment(self._output, FALSE)]

    def falls_off(self, time: Expression, *, active: bool) -> list[Statement]:
        """Return the statements of TF: its time begins when the step is left."""
        # while the step is active the TON rests, and the output is TRUE: NOT Q
        run = [assignment(self._runs, FALSE)] if active else [assignment(self._runs, TRUE)]
        mode = assignment(self._mode, n.Literal(_MODES[Qualifier.TF]))
        return [mode, assignment(self._time, time), *run]

    def runs(self) -> list[Statement]:
        """Return the statements at the end of each cycle."""
        # an S5 timer starts again with each event: a TON needs to see FALSE before. One TON serves all modes: a pulse
        # and an off-delay are TRUE until its time is over, and end the mode
        begins = when(self._starts, call(self._timer, IN=FALSE, PT=self._time), assignment(self._starts, FALSE))
        is_on = n.Operation(Operator.UNEQUAL, (self._mode, _STOPPED))
        over = n.Member(self._timer, n.Name("Q"))
        delays = equal(self._mode, _DELAY)
        value = n.If(
            (n.Branch(delays, (assignment(self._output, over),)),), (assignment(self._output, negation(over)),)
        )
        ends = when(conjunction([over, negation(delays)]), assignment(self._mode, _STOPPED))
        running = call(self._timer, IN=conjunction([self._runs, is_on]), PT=self._time)
        return [begins, running, when(is_on, value, ends)]


@dataclass(frozen=True)
class StepSignals:
    """Expressions about steps by their indexes: one is active, an event of one happens, its interlock is satisfied.

    `touched`: one is active or was left in this cycle, `gone`: it was left in the cycle before. `over`: one has been
    active for a time.
    """

    active: StepValue
    touched: StepValue
    event: Callable[[int, ActionEvent], Expression]
    released: StepValue
    over: Callable[[int, Expression], Expression]
    gone: StepValue


class SequencerActions:
    """Code of all actions of a sequencer."""

    def __init__(self, source: GraphSource, code: LoweredCode, signals: StepSignals) -> None:
        self._source, self._code, self._signals = source, code, signals
        self._own = _only_written_by_coils(source)
        self._timers: dict[str, S5Timer] = {}

    def leaving(self) -> list[StepCode]:
        """Return the code of steps that were left."""
        return self._steps(lambda row: row.event is ActionEvent.S0 or _falls_off(row), left=True)

    def acting(self) -> list[StepCode]:
        """Return the code of active steps."""
        return self._steps(lambda row: row.event is not ActionEvent.S0)

    def _steps(self, is_executed: Callable[[ActionRow], bool], *, left: bool = False) -> list[StepCode]:
        found: list[StepCode] = []
        for step in self._source.net.steps:
            rows = [row for row in self._executed(step) if is_executed(row)]
            found.append(StepCode(step.index, step.path, self._step(step, rows, left=left)))
        return [each for each in found if each.statements]

    def add_timers(self) -> None:
        """Append the timers that steps have started."""
        for name, timer in self._timers.items():
            self._code.add(self._code.texts.timer(name), timer.runs())

    def switched(self, qualifier: Qualifier, target: int) -> Expression:
        """Return an expression that is TRUE if an action switches a step on or off."""
        return disjunction(
            self._condition(step, row)
            for step in self._source.net.steps
            for row in self._source.rows[step.index]
            if row.qualifier is qualifier and target in row.switched
            # a step that switches all off stays itself
            if qualifier is Qualifier.ON or len(row.switched) == 1 or target != step.index
        )

    def _executed(self, step: NetStep) -> list[ActionRow]:
        return [row for row in self._source.rows[step.index] if not row.is_coil and not row.switched]

    def _condition(self, step: NetStep, row: ActionRow) -> Expression:
        """Return when an action acts."""
        what = self._signals.active(step.index) if row.event is None else self._signals.event(step.index, row.event)
        if not row.interlock:
            return what
        if row.event is ActionEvent.S0:
            return FALSE  # the interlock of a step that was left is not satisfied
        return conjunction([what, self._signals.released(step.index)])

    # -- coils

    def add_coils(self) -> None:
        """Append the assignments of the coils."""
        coils = grouped(
            (row.name.casefold(), (step, row))
            for step in self._source.net.steps
            for row in self._source.rows[step.index]
            if row.is_coil
        )
        for found in coils.values():
            row = found[0][1]
            assert row.target is not None  # noqa: S101  # a coil has an operand
            drive = assignment(row.target, disjunction(self._wanted(step, row) for step, row in found))
            # no other code writes the coil, so that it can be assigned in every cycle
            if row.name.casefold() in self._own:
                self._code.add(self._code.texts.action(row.name), [drive])
            else:
                self._code.add(self._code.texts.action(row.name), [when(self._written(found), drive)])

    def _wanted(self, step: NetStep, row: ActionRow) -> Expression:
        """Return an expression that is TRUE if a coil is to be TRUE."""
        condition = self._condition(step, row)
        if row.value is None or row.event is not None:
            return condition
        over = self._signals.over(step.index, row.value)
        return conjunction([condition, over if row.qualifier is Qualifier.D else negation(over)])

    def _written(self, found: Sequence[tuple[NetStep, ActionRow]]) -> Expression:
        """Return when any step drives a coil or was left; a coil of S0 is reset a cycle later."""
        steps = list(dict.fromkeys(step.index for step, _ in found))
        leaving = list(dict.fromkeys(step.index for step, row in found if row.event is ActionEvent.S0))
        return disjunction([*map(self._signals.touched, steps), *map(self._signals.gone, leaving)])

    # -- what is executed

    def _step(self, step: NetStep, rows: Sequence[ActionRow], *, left: bool = False) -> list[Statement]:
        """Return the code of a step, or of its end; actions with the same condition share it."""
        groups: list[tuple[Expression, list[Statement]]] = []
        for row in rows:
            condition = self._condition(step, replace(row, event=ActionEvent.S0) if left else row)
            if is_constant(condition, FALSE):
                continue
            # only neighbours share an IF: rows are executed in their order
            if not groups or groups[-1][0] != condition:
                groups.append((condition, []))
            groups[-1][1].extend(self._execution(row, left=left))
        return [when(condition, *statements) for condition, statements in groups]

    def _execution(self, row: ActionRow, *, left: bool) -> Iterator[Statement]:
        if row.target is None:
            yield from row.statements
        elif _falls_off(row) and row.value is not None:
            yield from self._timer(row).falls_off(row.value, active=not left)
        elif row.qualifier in TIMERS:
            yield from self._timer(row).started(row.qualifier, row.value)
        elif row.qualifier in COUNTERS:
            yield self._counted(row, row.target)
        else:
            yield assignment(row.target, TRUE if row.qualifier is Qualifier.S else FALSE)

    def _timer(self, row: ActionRow) -> S5Timer:
        key = row.name.casefold()
        if key not in self._timers:
            assert row.target is not None  # noqa: S101  # the caller has looked
            self._timers[key] = S5Timer(row.name.strip('#"'), row.target, self._code)
        return self._timers[key]

    def _counted(self, row: ActionRow, counter: Expression) -> Statement:
        if row.qualifier in _COUNTS:
            counts, before, end = _COUNTS[row.qualifier]
            counted = assignment(counter, n.Operation(counts, (counter, n.Literal("1"))))
            goes_on = n.Branch(n.Operation(before, (counter, end)), (counted,))
            return n.If((goes_on,), (assignment(counter, end),))
        return assignment(counter, row.value if row.qualifier is Qualifier.CS and row.value is not None else _ZERO)


_ZERO = n.Literal("0")
_COUNTS = {
    Qualifier.CU: (Operator.ADD, Operator.LESS, n.Literal("999")),
    Qualifier.CD: (Operator.SUBTRACT, Operator.GREATER, _ZERO),
}
"""Counting of S5: the operation, the comparison that tells that the end is not reached, and the end, 999 or 0."""


def _falls_off(row: ActionRow) -> bool:
    return row.qualifier is Qualifier.TF and row.target is not None


def _only_written_by_coils(source: GraphSource) -> set[str]:
    """Return the operands (lower case) of coils that are variables of the block and that no text writes."""
    interface = source.pou.interface
    own = {
        variable.name.casefold(): variable
        for section in sections_of(interface)
        if section.kind in (SectionKind.OUTPUT, SectionKind.LOCAL, SectionKind.TEMP)
        for variable in section.variables
    }
    rows = [row for rows in source.rows for row in rows]
    named = {row.name.casefold(): row.target for row in rows if row.is_coil and isinstance(row.target, n.Name)}
    written = {name.casefold() for name in _written_names(source, rows)}
    return {
        key
        for key, target in named.items()
        if target.identifier.casefold() in own
        and target.quoting is not n.Quoting.GLOBAL
        and target.identifier.casefold() not in written
        and own[target.identifier.casefold()].initial is None
    }


def _written_names(source: GraphSource, rows: Sequence[ActionRow]) -> Iterator[str]:
    """Yield the names of variables that anything but coils could write."""
    for row in rows:
        if not row.is_coil and isinstance(row.target, n.Name):
            yield row.target.identifier
    for text in texts_of(source):
        yield from (path[0] for path in writes(text.tree, frozenset()) if path)
        arguments = (node for node in walk(text.tree) if isinstance(node, n.Argument))
        yield from (a.value.identifier for a in arguments if isinstance(a.value, n.Name))  # it may be an in-out
    yield from source.parameters.values()
