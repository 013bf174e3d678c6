"""The data of steps and transitions in the instance of an S7-GRAPH block (manual, "Step data", "Transition data")."""

from __future__ import annotations

from plcopen_sfc.semantics.programs.runtime_types import BOOL, ELAPSED, ELEMENTARY, ScalarType

_BITS = "S1 S0 L1 L0 V1 V0 A1 R1 LA LS VA VS".split()
STEP: dict[str, ScalarType] = {
    "X": BOOL,
    "T": ELAPSED,
    "U": ELAPSED,
    "T_MAX": ELEMENTARY["TIME"],
    "T_WARN": ELEMENTARY["TIME"],
    "SNO": ELEMENTARY["INT"],
    **dict.fromkeys(_BITS, BOOL),
    "acknowledged": BOOL,
}
"""Data of a step: active, time, time without disturbance, limits, number, events, state of its conditions."""

TRANSITION: dict[str, ScalarType] = {"TV": BOOL, "TT": BOOL, "TS": BOOL, "TNO": ELEMENTARY["INT"]}
"""Data of a transition: its steps are active, its condition is satisfied, it switches; its number."""

_STEP_SLOTS = {name: slot for slot, name in enumerate(STEP)}
U, T_MAX, T_WARN, SNO = (_STEP_SLOTS[name] for name in ("U", "T_MAX", "T_WARN", "SNO"))
S1, S0, L1, L0, V1, V0, A1, R1, LA, LS, VA, VS = (_STEP_SLOTS[name] for name in _BITS)
ACKNOWLEDGED = _STEP_SLOTS["acknowledged"]
EVENT_NAMES = tuple(_BITS)
"""Names of the events, and of the state of conditions that they are made of."""

EVENTS = (S1, S0, L1, L0, V1, V0, A1, R1)
TV, TT, TS, TNO = range(4)
