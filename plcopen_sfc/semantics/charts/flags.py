"""The SFC flags of CODESYS: variables that reset, stop, watch and step a chart, and report on it."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Any

from plcopen_sfc.model import SfcFlag, SfcNetwork
from plcopen_sfc.semantics.charts.analyzation import Reason
from plcopen_sfc.semantics.charts.declaring import override
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.layouts import Frame
from plcopen_sfc.semantics.programs.types import BOOL, ELEMENTARY, ArrayType, ElementaryType

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs import Scope

_TEXTS = frozenset({SfcFlag.ERROR_STEP, SfcFlag.ERROR_POU, SfcFlag.CURRENT_STEP, SfcFlag.ERROR_ANALYZATION})
_NEED_ERROR = frozenset(
    {
        SfcFlag.ENABLE_LIMIT,
        SfcFlag.ERROR_STEP,
        SfcFlag.ERROR_POU,
        SfcFlag.QUIT_ERROR,
        SfcFlag.ERROR_ANALYZATION,
        SfcFlag.ERROR_ANALYZATION_TABLE,
    }
)
"""Flags that only work together with SFCError."""


class Order(Enum):
    """What the flags want in a scan: go on, stand still, or go back to the initial step."""

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

    A flag is used where the settings of the chart say so. Where they do not mention it, or leave it to the settings of
    the project, it is used if the POU or a list of global variables declares it, as in CoDeSys V2.3.
    """

    def __init__(self, chart: SfcNetwork, scope: Scope, path: str, profile: Profile) -> None:
        self._scope = scope
        self._get: dict[SfcFlag, Callable[[Frame], Any]] = {}
        self._set: dict[SfcFlag, Callable[[Frame, Any], None]] = {}
        self.used = frozenset(flag for flag in profile.flags if _is_used(flag, chart, scope))
        if SfcFlag.ERROR not in self.used:
            self.used -= _NEED_ERROR
        self._table: int | None = None
        if SfcFlag.ERROR_ANALYZATION_TABLE in self.used:
            self._table = _declare_table(scope)
            self.used -= {SfcFlag.ERROR_ANALYZATION_TABLE}
        for flag in sorted(self.used):
            if scope.type_of(flag.variable) is None:
                scope.declare(flag.variable, _type(flag))
        self._quitted = self._reserve(path, SfcFlag.QUIT_ERROR)
        self._reset = self._reserve(path, SfcFlag.INIT)
        self._tipped = self._reserve(path, SfcFlag.TIP)

    def _reserve(self, path: str, flag: SfcFlag) -> int:
        return self._scope.declare(f"{path}: {flag.variable} before", BOOL, hidden=True)

    def translate(self) -> None:
        """Find the variables."""
        for flag in self.used:
            self._get[flag] = self._scope.getter(flag.variable)
            self._set[flag] = self._scope.setter(flag.variable)

    def is_on(self, flag: SfcFlag, frame: Frame) -> bool:
        """Whether a flag is in use and TRUE."""
        get = self._get.get(flag)
        return get is not None and bool(get(frame))

    def put(self, flag: SfcFlag, frame: Frame, value: bool | str) -> None:
        """Report something, where the flag is in use."""
        write = self._set.get(flag)
        if write is not None:
            write(frame, value)

    def order(self, frame: Frame) -> tuple[Order, bool]:
        """What is wanted in this scan, and whether it was not wanted in the one before.

        Going on after SFCQuitError is new too: the times of active steps start anew.
        """
        v = frame.v
        wanted = Order.RUN
        if self.is_on(SfcFlag.INIT, frame):
            wanted = Order.INIT
        elif self.is_on(SfcFlag.RESET, frame):
            wanted = Order.RESET
        new = wanted is not Order.RUN and not v[self._reset]
        v[self._reset] = wanted is not Order.RUN
        if wanted is not Order.RUN:
            if new:
                self._clear(frame)
            return wanted, new
        if self.is_on(SfcFlag.QUIT_ERROR, frame):
            if not v[self._quitted]:
                self._forget_error(frame)
            v[self._quitted] = True
            return Order.STOP, False
        new = v[self._quitted]
        v[self._quitted] = False
        return (Order.STOP if self.is_on(SfcFlag.PAUSE, frame) else Order.RUN), new

    def tip(self, frame: Frame) -> Tip:
        """How transitions are cleared. One rising edge of SFCTip is one step."""
        if SfcFlag.TIP not in self.used:
            return Tip.LOCKED if self.is_on(SfcFlag.TIP_MODE, frame) else Tip.NONE
        v = frame.v
        tip = self.is_on(SfcFlag.TIP, frame)
        rising = tip and not v[self._tipped]
        v[self._tipped] = tip
        if rising:
            return Tip.FORCED
        return Tip.LOCKED if self.is_on(SfcFlag.TIP_MODE, frame) else Tip.NONE

    def can_time_out(self, frame: Frame) -> bool:
        """Whether a step that is active too long is to be reported."""
        if self.is_on(SfcFlag.ERROR, frame):
            return False
        return SfcFlag.ENABLE_LIMIT not in self.used or self.is_on(SfcFlag.ENABLE_LIMIT, frame)

    def time_out(self, frame: Frame, step: str, reasons: list[Reason]) -> None:
        """A step is active too long."""
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


def _is_used(flag: SfcFlag, chart: SfcNetwork, scope: Scope) -> bool:
    settings = chart.settings
    stated = settings.flags.get(flag) if settings is not None else None
    if stated is not None and (stated.use or not (settings is not None and settings.use_defaults)):
        return stated.use
    return scope.type_of(flag.variable) is not None


def _declare_table(scope: Scope) -> int:
    """``ARRAY [0..15] OF ExpressionResult`` of the library Analyzation, whatever the POU says of that type."""
    string = ELEMENTARY["STRING"]
    row = scope.structure("ExpressionResult", {"name": string, "address": string, "comment": string, "value": BOOL})
    return override(scope, SfcFlag.ERROR_ANALYZATION_TABLE.variable, ArrayType("ARRAY", row, ((0, 15),)))


def _type(flag: SfcFlag) -> ElementaryType:
    return ELEMENTARY["STRING"] if flag in _TEXTS else BOOL
