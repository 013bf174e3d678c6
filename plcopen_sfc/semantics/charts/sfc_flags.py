"""The SFC flags of CODESYS: variables that reset, stop, watch and step a chart, and report on it."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Any, NamedTuple

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.model import Expression, SfcFlag, SfcNetwork
from plcopen_sfc.model.chart_settings import OPERATING_FLAGS
from plcopen_sfc.semantics.charts.step_state import override
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime_types import BOOL, ELEMENTARY, ArrayOf, Frame

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope

_TEXTS = frozenset({SfcFlag.ERROR_STEP, SfcFlag.ERROR_POU, SfcFlag.CURRENT_STEP, SfcFlag.ERROR_ANALYZATION})
_REPORTS = _TEXTS | {SfcFlag.ERROR, SfcFlag.TRANS}
"""Flags that the chart writes."""

COMMANDS = OPERATING_FLAGS | {SfcFlag.ENABLE_LIMIT}
"""Flags that the chart obeys."""


class FlagEffect(Enum):
    """Effect of the flags in a scan: go on, stop, or go back to the initial step."""

    RUN = "run"
    STOP = "stop"
    INIT = "init"
    RESET = "reset"


class Tip(Enum):
    """Jogging: transitions as always, none, or the enabled ones whatever their conditions."""

    NONE = "none"
    LOCKED = "locked"
    FORCED = "forced"


class Flags:
    """The flags that a chart uses.

    A flag is used where the settings of the chart use it. Where they do not mention it, or leave it to the settings of
    the project, it is used if the POU or a list of global variables declares it, as in CoDeSys V2.3.
    """

    def __init__(self, chart: SfcNetwork, scope: Scope, path: str, profile: Profile) -> None:
        self._scope = scope
        self._get: dict[SfcFlag, Callable[[Frame], Any]] = {}
        self._set: dict[SfcFlag, Callable[[Frame, Any], None]] = {}
        self.used = flags_in_use(chart, profile, lambda name: Routines(scope).type_of(name) is not None)
        self._table: int | None = None
        if SfcFlag.ERROR_ANALYZATION_TABLE in self.used:
            self._table = _declare_table(scope)
            self.used -= {SfcFlag.ERROR_ANALYZATION_TABLE}
        for flag in sorted(self.used):
            if Routines(scope).type_of(flag.variable) is None:
                scope.declare(flag.variable, ELEMENTARY["STRING"] if flag in _TEXTS else BOOL)
        self._quitted = self._reserve(path, SfcFlag.QUIT_ERROR)
        self._reset = self._reserve(path, SfcFlag.RESET)
        self._tipped = self._reserve(path, SfcFlag.TIP)

    def _reserve(self, path: str, flag: SfcFlag) -> int:
        return self._scope.declare(f"{path}: {flag.variable} before", BOOL, hidden=True)

    def translate(self) -> None:
        """Find the variables."""
        for flag in sorted(self.used):
            self._get[flag] = Routines(self._scope).getter(flag.variable)
        for flag in sorted(self.used & _REPORTS):  # all others stay inputs, where they are
            self._set[flag] = Routines(self._scope).setter(flag.variable)

    def is_on(self, flag: SfcFlag, frame: Frame) -> bool:
        """True if a flag is in use and TRUE."""
        get = self._get.get(flag)
        return get is not None and bool(get(frame))

    def put(self, flag: SfcFlag, frame: Frame, value: bool | str) -> None:
        """Report something, where the flag is in use."""
        write = self._set.get(flag)
        if write is not None:
            write(frame, value)

    def order(self, frame: Frame) -> tuple[FlagEffect, bool]:
        """Effect in this scan, and True if it was not wanted in the one before.

        Whatever SFCInit finds it sets back, so that is new in every scan. Going on after SFCQuitError is new too: the
        times of active steps start again.
        """
        v = frame.v
        reset = self.is_on(SfcFlag.RESET, frame)
        new = reset and not v[self._reset]
        v[self._reset] = reset
        if self.is_on(SfcFlag.INIT, frame):
            self._clear(frame)
            return FlagEffect.INIT, True
        if reset:
            if new:
                self._clear(frame)
            return FlagEffect.RESET, new
        if self.is_on(SfcFlag.QUIT_ERROR, frame):
            self._forget_error(frame)
            v[self._quitted] = True
            return FlagEffect.STOP, False
        if self.is_on(SfcFlag.PAUSE, frame):
            return FlagEffect.STOP, False
        new = v[self._quitted]
        v[self._quitted] = False
        return FlagEffect.RUN, new

    def tip(self, frame: Frame) -> Tip:
        """Way of firing transitions. One rising edge of SFCTip is one step; there is none while SFCReset is TRUE."""
        pushed = False
        if SfcFlag.TIP in self.used:
            v = frame.v
            tip = self.is_on(SfcFlag.TIP, frame)
            pushed = tip and not v[self._tipped]
            v[self._tipped] = tip
        if self.is_on(SfcFlag.RESET, frame):
            return Tip.LOCKED
        if pushed:
            return Tip.FORCED
        return Tip.LOCKED if self.is_on(SfcFlag.TIP_MODE, frame) else Tip.NONE

    def can_time_out(self, frame: Frame) -> bool:
        """True if a step that is active too long is to be reported."""
        if self.is_on(SfcFlag.ERROR, frame):
            return False
        return SfcFlag.ENABLE_LIMIT not in self.used or self.is_on(SfcFlag.ENABLE_LIMIT, frame)

    def time_out(self, frame: Frame, step: str, reasons: list[Reason]) -> None:
        """Report a step that is active too long."""
        self.put(SfcFlag.ERROR, frame, True)
        self.put(SfcFlag.ERROR_STEP, frame, step)
        self.put(SfcFlag.ERROR_POU, frame, self._scope.path.partition(".")[0])
        self.put(SfcFlag.ERROR_ANALYZATION, frame, "|".join(reason.text for reason in reasons))
        self._fill_table(frame, reasons)

    def _fill_table(self, frame: Frame, reasons: list[Reason]) -> None:
        if self._table is None:
            return
        rows: list[Frame] = frame.v[self._table]
        for row, reason in zip(rows, [*reasons, *[Reason("", False)] * len(rows)], strict=False):
            row.v[:] = (reason.text, "", "", reason.value)

    def _forget_error(self, frame: Frame) -> None:
        self.put(SfcFlag.ERROR, frame, False)
        for flag in (SfcFlag.ERROR_STEP, SfcFlag.ERROR_POU, SfcFlag.ERROR_ANALYZATION):
            self.put(flag, frame, "")
        self._fill_table(frame, [])

    def _clear(self, frame: Frame) -> None:
        self._forget_error(frame)
        self.put(SfcFlag.TRANS, frame, False)
        self.put(SfcFlag.CURRENT_STEP, frame, "")
        frame.v[self._quitted] = False


def flags_in_use(chart: SfcNetwork, profile: Profile, declared: Callable[[str], bool]) -> frozenset[SfcFlag]:
    """Return the flags that a chart uses; `declared` is True for a variable that the POU or its project declares."""
    return profile.flags & chart.flags_in_use(declared) if profile.flags else frozenset()


def _declare_table(scope: Scope) -> int:
    """``ARRAY [0..15] OF ExpressionResult`` of the library Analyzation, whatever the POU declares of that type."""
    string = ELEMENTARY["STRING"]
    row = scope.structure("ExpressionResult", {"name": string, "address": string, "comment": string, "value": BOOL})
    return override(scope, SfcFlag.ERROR_ANALYZATION_TABLE.variable, ArrayOf("ARRAY", row, ((0, 15),)))


class Reason(NamedTuple):
    """An operand and the value that it has."""

    text: str
    value: bool


Analysis = Callable[[Frame], list[Reason]]
"""Operands that keep a condition from its value; none if it has it."""


def analysis(net: Net, step: int, scope: Scope, where: str) -> Analysis:
    """Return the analysis of all transitions that leave a step."""
    found: list[Analysis] = []
    for index in net.leaving[step]:
        condition = net.transitions[index].transition.condition
        if isinstance(condition, Expression):
            parsed = parse_expression(condition.text, scope.library.dialect)
            if not parsed.problems:
                found.append(_reasons_in(scope, condition.text, where)(parsed.tree, not condition.negated))
    return _all_of(found)


def _reasons_in(scope: Scope, condition: str, where: str) -> Callable[[n.Expression, bool], Analysis]:
    """Return what gives the operands of a condition that keep an expression in it from a value."""

    def of(node: n.Expression, wanted: bool) -> Analysis:
        match node:
            case n.Parenthesized():
                return of(node.inner, wanted)
            case n.Unary(operator=n.Operator.NOT):
                return of(node.operand, not wanted)
            case n.Operation(operator=n.Operator.AND | n.Operator.AND_THEN | n.Operator.OR | n.Operator.OR_ELSE):
                conjunction = node.operator in (n.Operator.AND, n.Operator.AND_THEN)
                operands = [of(operand, wanted) for operand in node.operands]
                return _all_of(operands) if conjunction is wanted else _any_of(operands)
        start, end = node.span or (0, len(condition))
        text = condition[start:end]
        value = Routines(scope).condition(Expression(text=text), where)
        return lambda frame: [] if bool(value(frame)) is wanted else [Reason(text, not wanted)]

    return of


def _all_of(operands: list[Analysis]) -> Analysis:
    """All operands must have their values: those that have not are the reasons."""
    return lambda frame: [reason for explain in operands for reason in explain(frame)]


def _any_of(operands: list[Analysis]) -> Analysis:
    """One operand would do: if there is none, all are the reasons."""

    def explain(frame: Frame) -> list[Reason]:
        reasons = [explain(frame) for explain in operands]
        return [reason for found in reasons for reason in found] if all(reasons) else []

    return explain
