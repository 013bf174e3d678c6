"""The SFC flags of CODESYS in code: reset, pause and steps by hand, watched times, and reports.

`plcopen_sfc.semantics.charts.sfc_flags` has their effects and order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import string_literal
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.actions.action_execution import StepCode
from plcopen_sfc.lowering.actions.variable_access import OwnVariables
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    equal,
    negation,
    when,
)
from plcopen_sfc.lowering.code.code_memory import Memory
from plcopen_sfc.lowering.code.lowered_code import BOOL, INT, LoweredCode, StepValue
from plcopen_sfc.lowering.reading.chart_source import ChartSource, HoldingOperand, StepTimeLimit
from plcopen_sfc.lowering.reading.step_variables import StepTimers
from plcopen_sfc.model import types as t
from plcopen_sfc.model.chart_settings import SfcFlag

_TYPE = "ExpressionResult"
_LAST = n.Literal("15")
_EMPTY_ROW = n.Literal("''")
_VARIABLE = SfcFlag.ERROR_ANALYZATION_TABLE.variable


class ErrorTable:
    """SFCErrorAnalyzationTable: ``ARRAY [0..15] OF ExpressionResult`` with a row for each reason that holds a step.

    The type is that of the library Analyzation of CODESYS (name, address, comment and value). The project gets it where
    it has none of this name, so that the code needs no library. Address and comment stay empty, as in the simulator.
    Raises `LoweringError` where the POU declares the flag otherwise.
    """

    def __init__(self, source: ChartSource, code: LoweredCode) -> None:
        self._dialect = source.dialect
        declared = next((v for v in source.pou.variables() if v.name.casefold() == _VARIABLE.casefold()), None)
        kind = t.ArrayType(dimensions=[t.Dimension(lower="0", upper="15")], base=t.DerivedType(name=_TYPE))
        if SfcFlag.ERROR_ANALYZATION_TABLE in source.undeclared_flags:
            code.declare_as(_VARIABLE, kind)
        elif declared is not None and not _is_table(declared):
            message = f"{_VARIABLE} is declared with another type than ARRAY [0..15] OF {_TYPE}"
            source.refuse(message, "Declare it so, or not at all.")
        if _TYPE.casefold() not in code.known_types:
            members = [t.Variable(name=name, type=t.StringType()) for name in ("name", "address", "comment")]
            members.append(t.Variable(name="value", type=BOOL))
            code.data_types.append(
                t.DataTypeDeclaration(
                    name=_TYPE, folder=source.pou.folder, place=source.pou.place, type=t.StructType(members=members)
                )
            )
        self._table = code.naming.local(_VARIABLE)
        self._row = code.declare(code.texts.table_row, INT)

    def filled(self, reasons: Iterable[HoldingOperand]) -> list[Statement]:
        """Return a row for each reason that holds, up to the size of the table; all rows behind them are empty."""
        found: list[Statement] = [assignment(self._row, n.Literal("0"))]
        free = n.Operation(Operator.LESS_OR_EQUAL, (self._row, _LAST))
        for number, reason in enumerate(reasons):
            name = n.Literal(string_literal(reason.text, self._dialect))
            # the first 16 rows have a place in any case
            place = [free] if number > int(_LAST.text) else []
            found.append(when(conjunction([reason.holds, *place]), *self._written(name, reason.value)))
        return [*found, *self._rest()]

    def emptied(self) -> list[Statement]:
        """Return the statements that make all rows empty."""
        return [assignment(self._row, n.Literal("0")), *self._rest()]

    def _rest(self) -> Sequence[Statement]:
        free = n.Operation(Operator.LESS_OR_EQUAL, (self._row, _LAST))
        return [n.While(free, tuple(self._written(_EMPTY_ROW, value=False)))]

    def _written(self, name: Expression, value: bool) -> list[Statement]:
        row = n.Index(self._table, (self._row,))
        return [
            assignment(n.Member(row, n.Name("name")), name),
            assignment(n.Member(row, n.Name("value")), TRUE if value else FALSE),
            assignment(self._row, n.Operation(Operator.ADD, (self._row, n.Literal("1")))),
        ]


def _is_table(variable: t.Variable) -> bool:
    kind = variable.type
    base = kind.base if isinstance(kind, t.ArrayType) else None
    return isinstance(base, t.DerivedType) and base.name.casefold().rpartition(".")[2] == _TYPE.casefold()


_STRING = t.StringType()
_TEXTS = (SfcFlag.ERROR_STEP, SfcFlag.ERROR_POU, SfcFlag.ERROR_ANALYZATION, SfcFlag.CURRENT_STEP)
_EMPTY = n.Literal("''")
_USUAL_LENGTH = "80"
"""Characters of a STRING without a length in CODESYS; 254 in S7, where this is too careful."""


class SfcFlagCode:
    """Flags of one chart; without flags in use there is none of this code.

    `init`: the restart condition besides. A flag without declaration becomes a local variable, as the tool declares it.
    """

    def __init__(self, source: ChartSource, memory: Memory, init: Expression | None) -> None:
        code = memory.code
        self._source, self._code, self._memory, self._texts = source, code, memory, code.texts
        self._init = init
        self._table: ErrorTable | None = None
        if SfcFlag.ERROR_ANALYZATION_TABLE in source.flags:
            self._table = ErrorTable(source, code)
        for flag in sorted(source.undeclared_flags - {SfcFlag.ERROR_ANALYZATION_TABLE}):
            code.declare_as(flag.variable, _STRING if flag in _TEXTS else BOOL)
        flags = source.flags - {SfcFlag.ERROR_ANALYZATION_TABLE}
        self._flags = {flag: code.naming.local(flag.variable) for flag in sorted(flags)}
        self._sfc_init, self._sfc_reset = self._flags.get(SfcFlag.INIT), self._flags.get(SfcFlag.RESET)
        self._edges: list[Statement] = []
        self._back = self._going_back()
        self._tip = self._pushed()

    def _going_back(self) -> Expression:
        """Return an expression that is TRUE in a scan in which the flags set the chart back; FALSE if they never do."""
        causes: list[Expression] = [self._sfc_init] if self._sfc_init is not None else []
        if self._sfc_reset is not None:
            name = self._texts.with_suffix(self._sfc_reset.identifier, "edge")
            causes.append(self._memory.rising(name, self._sfc_reset, self._edges, kept=True))
        back = disjunction(causes)
        # read in many places: one variable instead of the disjunction
        if len(causes) > 1:
            return self._memory.named(self._texts.restart, back, self._edges)
        return back

    @property
    def set_back(self) -> bool:
        """True if flags set the chart back, which then ends all that its code remembers."""
        return self._back != FALSE

    @property
    def restart(self) -> Expression | None:
        """Condition that sets the chart back to its initial steps: the flags, or `init`; None without both."""
        causes = [each for each in (self._init, self._back) if each is not None and each != FALSE]
        return disjunction(causes) if causes else None

    @property
    def held(self) -> Expression:
        """Condition that is TRUE while the chart is held in its initial steps; FALSE if nothing holds it."""
        return disjunction(each for each in (self._init, self._sfc_init, self._sfc_reset) if each is not None)

    @property
    def blocking(self) -> list[Expression]:
        """Conditions of which each keeps all transitions from firing while it is TRUE."""
        return [each for each in (self._init, self._sfc_reset) if each is not None]

    # -- before anything else in a scan

    def begin(self, times: StepTimers, *, late_edges: bool) -> None:
        """Append the conditions that set the chart back and stop it. `late_edges`: `end` appends the edges."""
        self._late_edges = late_edges
        if not late_edges:
            self._code.add(self._texts.init, self._edges)
        # a restart overrides SFCPause and SFCQuitError, as in CODESYS
        stronger = [negation(each) for each in (self._init, self._sfc_init, self._sfc_reset) if each is not None]
        quit_ = self._flags.get(SfcFlag.QUIT_ERROR)
        if quit_ is not None:
            done = [*self._forgotten_error(), *times.ends(), n.ReturnStatement()]
            self._conditional(self._texts.quit_error, conjunction([quit_, *stronger]), done)
        pause = self._flags.get(SfcFlag.PAUSE)
        if pause is not None:
            self._conditional(self._texts.pause, conjunction([pause, *stronger]), [n.ReturnStatement()])

    # -- when the chart has gone back

    def forget(self, chosen: Sequence[n.Name]) -> bool:
        """Append what forgets the transitions that were chosen in the last scan. False: there is nothing to forget."""
        restart = self.restart
        if self._back == FALSE or restart is None or not chosen:
            return False
        # what was chosen in the last scan would move the chart away from its initial step
        forgotten = [assignment(each, FALSE) for each in chosen]
        self._conditional(self._texts.init, restart, forgotten)
        return True

    def end(self, place: int, times: StepTimers, calls: Sequence[Statement]) -> None:
        """Insert the end of all that times and actions remember, and the end of the scan of SFCInit.

        To be called when all actions have been lowered; `place` is the one before them. `calls` are those of blocks
        with actions, which end these themselves (`end_in_block`).
        """
        if self._back == FALSE:
            return
        done = [*times.ends(), *self._memory.ends, *self._forgotten_error()]
        if self._sfc_init is not None:  # else the initial step is executed now, and does all this
            done += [] if calls else self._ended_targets()
            done += self._assigned(SfcFlag.TRANS, FALSE) + self._assigned(SfcFlag.CURRENT_STEP, _EMPTY)
        statements = self._left(self._memory, list(dict.fromkeys(done)), calls)
        if self._late_edges and done:
            statements[:0] = self._edges
        self._code.add(self._texts.actions_end, statements, place=place)

    def end_in_block(self, memory: Memory) -> None:
        """Insert, before all else in a block with actions, the end of these, and of the scan of SFCInit."""
        if self._back == FALSE:
            return
        done = [*memory.ends, *(self._ended_targets() if self._sfc_init is not None else [])]
        memory.code.add(self._texts.actions_end, self._left(memory, done), place=0)

    def _left(self, memory: Memory, done: Sequence[Statement], calls: Sequence[Statement] = ()) -> list[Statement]:
        """Return the statements when the chart goes back, and those that end the scan while SFCInit is TRUE.

        While it is TRUE nothing else is executed; SFCReset executes the initial step.
        """
        if self._sfc_init is None:
            return memory.conditional("", self._back, done)
        leaving = [*calls, n.ReturnStatement()]
        if self._back == self._sfc_init:
            return memory.conditional("", self._sfc_init, [*done, *leaving])
        return [*memory.conditional("", self._back, done), *memory.conditional("", self._sfc_init, leaving)]

    def _ended_targets(self) -> list[Statement]:
        """Return the end of the variables that are written in every scan; those of the others is in `Memory.ends`."""
        # what the text of another action writes too is left alone while its own action is inactive
        bodies = (each for action in self._source.actions if action.target is None for each in action.statements)
        owned = OwnVariables(self._source, bodies)
        targets = (action.target for action in self._source.actions if action.target is not None)
        return [assignment(target, FALSE) for target in targets if owned.is_false_at_rest(target)]

    # -- transitions

    def may_fire(self, condition: Expression, waited: Expression) -> Expression:
        """Return the condition of a transition, `waited` for minimum times, under SFCTipMode and SFCTip."""
        mode = self._flags.get(SfcFlag.TIP_MODE)
        # minimum times hold a push of SFCTip too
        usual = conjunction([condition, negation(mode)]) if mode is not None else condition
        return conjunction([waited, disjunction([usual, self._tip]) if self._tip != FALSE else usual])

    def is_asked(self) -> Expression:
        """Return an expression that is TRUE if conditions of unblocked transitions are evaluated at all."""
        mode = self._flags.get(SfcFlag.TIP_MODE)
        usual = negation(mode) if mode is not None else TRUE
        return conjunction([usual, negation(self._tip)])

    def before_transitions(self) -> None:
        """Append the push of SFCTip."""
        self._code.add(self._texts.tip, self._tip_edge)

    def _pushed(self) -> Expression:
        self._tip_edge: list[Statement] = []
        tip = self._flags.get(SfcFlag.TIP)
        if tip is None:
            return FALSE
        return self._memory.rising(self._texts.with_suffix(tip.identifier, "edge"), tip, self._tip_edge, kept=True)

    # -- reports

    def report_step(self, while_active: Callable[[Sequence[StepCode], str], Sequence[Statement]]) -> None:
        """Append the name of the active step, of parallel ones the last in the chart."""
        if SfcFlag.CURRENT_STEP not in self._flags:
            return
        parts = [
            StepCode(each.index, each.step.name, self._assigned(SfcFlag.CURRENT_STEP, self._text(each.step.name)))
            for each in self._source.net.steps
        ]
        named = while_active(parts, "main")
        self._code.add(self._texts.current_step, [*self._assigned(SfcFlag.CURRENT_STEP, _EMPTY), *named])

    def report_transition(self, fired: Callable[[], Expression]) -> None:
        """Append the report that a transition has fired."""
        if SfcFlag.TRANS in self._flags:
            self._code.add(self._texts.transitions, self._assigned(SfcFlag.TRANS, fired()))

    def watch(self, watches: Iterable[StepTimeLimit], active: StepValue, times: StepTimers) -> None:
        """Append the report of the first step that is active longer than it may."""
        error, limit = (self._flags.get(flag) for flag in (SfcFlag.ERROR, SfcFlag.ENABLE_LIMIT))
        if error is None:
            return
        for watch in watches:
            step = self._source.net.steps[watch.step]
            longer = n.Operation(Operator.GREATER, (times.elapsed(watch.step), watch.time))
            allowed = [negation(error), *([limit] if limit is not None else [])]
            late = conjunction([active(watch.step), *allowed, longer])
            report = [  # the reasons first: transitions may ask for SFCError and the others themselves
                *self._analysis(watch),
                *(self._table.filled(watch.reasons) if self._table is not None else []),
                *self._assigned(SfcFlag.ERROR, TRUE),
                *self._assigned(SfcFlag.ERROR_STEP, self._text(step.step.name)),
                *self._assigned(SfcFlag.ERROR_POU, self._text(self._source.pou.name)),
            ]
            statements = self._memory.conditional(
                self._texts.with_suffix(self._texts.flag_name(step.step), "late"), late, report
            )
            title = self._texts.maximum_time(step.path)
            self._code.add(title, statements, inside=self._texts.maximum_time_inside)

    def _analysis(self, watch: StepTimeLimit) -> list[Statement]:
        """Return the operands that keep the step active, divided by vertical bars."""
        analyzation = self._flags.get(SfcFlag.ERROR_ANALYZATION)
        if analyzation is None:
            return []
        found: list[Statement] = [assignment(analyzation, _EMPTY)]
        # a bar before each of them, the first of which goes, unless the text has no room for one more character
        ahead = len(watch.reasons) > 1 and sum(len(each.text) + 1 for each in watch.reasons) <= self._room(analyzation)
        for number, reason in enumerate(watch.reasons):
            longer = self._text(f"|{reason.text}" if ahead else reason.text)
            if number and ahead:
                longer = _function("CONCAT", analyzation, longer)
            elif number:  # SEL instead of IF: drawn code has no IF
                bar = _function("SEL", equal(analyzation, _EMPTY), self._text("|"), _EMPTY)
                longer = _function("CONCAT", _function("CONCAT", analyzation, bar), longer)
            found += self._memory.conditional("", reason.holds, [assignment(analyzation, longer)])
        if ahead:
            rest = assignment(analyzation, _function("DELETE", analyzation, n.Literal("1"), n.Literal("1")))
            found += self._memory.conditional("", negation(equal(analyzation, _EMPTY)), [rest])
        return found

    def _room(self, text: n.Name) -> int:
        """Return how many characters a variable can have; 0 where that is a constant."""
        variables = (*self._source.pou.variables(), *self._code.variables)
        declared = next((each.type for each in variables if each.name == text.identifier), None)
        length = (declared.length or _USUAL_LENGTH) if isinstance(declared, t.StringType) else ""
        return int(length) if length.isdecimal() else 0

    # -- parts

    def _conditional(self, title: str, condition: Expression, statements: Sequence[Statement]) -> None:
        self._code.add(title, self._memory.conditional("", condition, statements))

    def _forgotten_error(self) -> list[Statement]:
        found = self._assigned(SfcFlag.ERROR, FALSE)
        for flag in (SfcFlag.ERROR_STEP, SfcFlag.ERROR_POU, SfcFlag.ERROR_ANALYZATION):
            found += self._assigned(flag, _EMPTY)
        return [*found, *(self._table.emptied() if self._table is not None else [])]

    def _assigned(self, flag: SfcFlag, value: Expression) -> list[Statement]:
        name = self._flags.get(flag)
        return [assignment(name, value)] if name is not None else []

    def _text(self, text: str) -> Expression:
        return n.Literal(string_literal(text, self._source.dialect))


def _function(name: str, *operands: Expression) -> Expression:
    return n.Call(n.Name(name), tuple(n.Argument(each) for each in operands))
