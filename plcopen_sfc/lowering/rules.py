"""How a chart is lowered: what the user chooses besides construction, style and language."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from plcopen_sfc.lowering.texts import Texts
from plcopen_sfc.semantics.profile import Profile


class States(StrEnum):
    """What the states of a CASE are written as.

    NUMBERS: the numbers of the steps. CONSTANTS: names of constants with these values. ENUMERATION: values of a type.
    """

    NUMBERS = "numbers"
    CONSTANTS = "constants"
    ENUMERATION = "enumeration"


class ActionPlace(StrEnum):
    """Where the actions stand. INLINE: behind the chain. BLOCK: in a block of their own, which the chain calls."""

    INLINE = "inline"
    BLOCK = "block"


class OperatingMode(StrEnum):
    """Inputs that lowered code can have besides those of the chart.

    ENABLE: transitions fire only while it is TRUE. SINGLE_STEP: while it is on, only a rising edge of the advance input
    lets transitions fire whose conditions are TRUE. ADVANCE: while it is on, that edge lets them fire whatever their
    conditions are. SELECT: a rising edge makes the step of a number the only active one.
    """

    ENABLE = "enable"
    SINGLE_STEP = "single-step"
    ADVANCE = "advance"
    SELECT = "select"


@dataclass(frozen=True)
class LoweringRules:
    """What a lowering obeys.

    `profile`: what the chart does. `init`: the name of an input to add that starts the chain anew; None is the usual
    one, which textbook forms have and exact ones have not, an empty text is none for both. `stop`: a condition
    in the dialect of the project, or the name of an input to add; while it is TRUE initial steps are set and all others
    reset. `reset_actions`: `init` and `stop` end stored actions too. `flags`: where step flags are: ``local``, an
    address of the first one (``M20.0``), or the name of a data block. `target`: the format that the code is for,
    without its version. `at_rest`: commands and mode switches of an S7-GRAPH block that nobody operates, ``all`` for
    all it has: there is no code for them, and it does what the chart does while they are FALSE.
    """

    profile: Profile
    texts: Texts
    init: str | None = None
    stop: str | None = None
    reset_actions: bool = False
    states: States = States.NUMBERS
    actions: ActionPlace = ActionPlace.INLINE
    flags: str = "local"
    modes: frozenset[OperatingMode] = frozenset()
    target: str | None = None
    at_rest: frozenset[str] = frozenset()
