"""The parameters of an S7-GRAPH block, and the mode they put the sequencer into."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple

from plcopen_sfc.errors import ModelError, listed_names
from plcopen_sfc.model.chart_settings import GRAPH_INPUTS, OPERATING_FLAGS
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime_types import BOOL, ELEMENTARY, Frame

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope


class Mode(IntEnum):
    """Operating mode of a sequencer (manual, "Operating modes")."""

    AUTOMATIC = 0
    MANUAL = 1
    INCHING = 2
    """SW_TAP: a transition switches when it is satisfied and T_PUSH rises."""
    AUTOMATIC_OR_STEP_BY_STEP = 3
    """SW_TOP: a transition switches when it is satisfied, or when T_PUSH rises."""


MODES = {
    "SW_AUTO": (Mode.AUTOMATIC, "AUTO_ON"),
    "SW_MAN": (Mode.MANUAL, "MAN_ON"),
    "SW_TAP": (Mode.INCHING, "TAP_ON"),
    "SW_TOP": (Mode.AUTOMATIC_OR_STEP_BY_STEP, "TOP_ON"),
}
"""The inputs that switch modes by a rising edge (the last of several counts), and the outputs that show them."""
_COMMANDS = "OFF_SQ INIT_SQ ACK_EF REG_EF REG_S S_ON S_OFF T_PUSH S_PREV S_NEXT".split()
_OUTPUTS = ("S_NO", "S_MORE", "S_ACTIVE", "ERR_FLT")
OPERATING = (*_COMMANDS, *MODES)
"""The inputs of which a rising edge does something."""
PARAMETERS = (*_COMMANDS, *MODES, "S_SEL", *_OUTPUTS, *(lamp for _, lamp in MODES.values()))
"""All parameters that are known."""


def operating_inputs(wanted: Iterable[str]) -> frozenset[str]:
    """Return the inputs that `wanted` names, in upper case; ``all`` are all of `GRAPH_INPUTS` and the SFC flags.

    Raises `ModelError` for a name that no such input has.
    """
    names = {name.upper() for name in listed_names(wanted, "inputs at rest are named by texts")}
    flags = [flag.variable.upper() for flag in sorted(OPERATING_FLAGS)]
    unknown = sorted(names - {*GRAPH_INPUTS, *flags, "ALL"})
    if unknown:
        hint = f"These do: {', '.join(GRAPH_INPUTS)}, and the SFC flags of CODESYS."
        raise ModelError(f"{unknown[0]} does not operate sequencers, so it cannot be an inactive input", hint=hint)
    return frozenset((*GRAPH_INPUTS, *flags) if "ALL" in names else names)


class Commands(NamedTuple):
    """Commands of this scan. All commands are rising edges of their parameters."""

    off: bool
    init: bool
    acknowledge: bool
    register: bool
    on_step: bool
    off_step: bool
    push: bool
    previous: bool
    next: bool
    selected: int
    mode: Mode


class Parameters:
    """The parameters that a block declares; those that it does not declare have no effect."""

    def __init__(self, scope: Scope, path: str, *, locked: bool) -> None:
        self._scope = scope
        self._locked = locked
        self._declared = {name for name in PARAMETERS if scope.lookup(name) is not None}
        self._edges = {
            name: scope.declare(f"{path}: {name} before", BOOL, hidden=True)
            for name in OPERATING
            if name in self._declared
        }
        self._mode = scope.declare(f"{path}: mode", ELEMENTARY["INT"], hidden=True)
        self._get: dict[str, Callable[[Frame], Any]] = {}
        self._set: dict[str, Callable[[Frame, Any], None]] = {}

    def translate(self) -> None:
        """Find the parameters."""
        mark = "#" if self._scope.library.dialect is Dialect.SCL else ""
        for name in sorted(self._declared):
            if name in self._edges or name == "S_SEL":
                self._get[name] = Routines(self._scope).getter(f"{mark}{name}")
            else:
                self._set[name] = Routines(self._scope).setter(f"{mark}{name}")

    def commands(self, frame: Frame) -> Commands:
        """Changes at the inputs."""
        rising = {name for name in self._edges if self._rises(name, frame)}
        if rising and not self._locked:
            for name, (mode, _) in MODES.items():
                if name in rising:
                    frame.v[self._mode] = int(mode)
        selected = self._get["S_SEL"](frame) if "S_SEL" in self._get else 0
        return Commands(
            off="OFF_SQ" in rising,
            init="INIT_SQ" in rising,
            acknowledge="ACK_EF" in rising,
            register="REG_EF" in rising or "REG_S" in rising,
            on_step="S_ON" in rising,
            off_step="S_OFF" in rising,
            push="T_PUSH" in rising,
            previous="S_PREV" in rising,
            next="S_NEXT" in rising,
            selected=selected,
            mode=Mode(frame.v[self._mode]),
        )

    def _rises(self, name: str, frame: Frame) -> bool:
        v, slot = frame.v, self._edges[name]
        value = bool(self._get[name](frame))
        rises = value and not v[slot]
        v[slot] = value
        return rises

    @property
    def has_outputs(self) -> bool:
        """True if there is anything to report to."""
        return bool(self._set)

    def report(self, frame: Frame, mode: Mode, values: dict[str, Any]) -> None:
        """Write the outputs."""
        for which, lamp in MODES.values():
            self._write(lamp, frame, which is mode)
        for name, value in values.items():
            self._write(name, frame, value)

    def _write(self, name: str, frame: Frame, value: Any) -> None:
        write = self._set.get(name)
        if write is not None:
            write(frame, value)
