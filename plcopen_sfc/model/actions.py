"""Terms of actions: qualifiers, events of S7-GRAPH, kinds of GRAFCET actions and forcing orders."""

from __future__ import annotations

import re
from enum import StrEnum

from pydantic import Field

from plcopen_sfc.model.base import Model

STEP_ACTION_ENDINGS = {"entry_action": "_entry", "exit_action": "_exit"}
"""Endings of the names of actions that a step of CoDeSys 2.3 executes when it is entered and left."""


class Qualifier(StrEnum):
    """Action qualifiers.

    IEC 61131-3 (ed. 3, table 59): N R S L D P P0 P1 SD DS SL; R0 is its alias for R. TC6 also lists DL. S7-GRAPH: N S
    R D L CALL, the step switches ON and OFF, counters CS CU CD CR and timers TL TD TR TF (used with an event). NONE:
    the association has no qualifier at all.

    In S7-GRAPH, ON and OFF activate and deactivate the step that is the target (``S_ALL``: all of them). CS sets a
    counter to the value, CU and CD count up and down, CR resets it. TL starts a timer as an extended pulse, TD as a
    retentive on-delay, TR stops and resets it; TF, an off-delay, is the one that needs no event. Their time is the
    duration. CALL calls the block in the body.
    """

    NONE = "None"
    N = "N"
    R = "R"
    R0 = "R0"
    S = "S"
    L = "L"
    D = "D"
    P = "P"
    P0 = "P0"
    P1 = "P1"
    SD = "SD"
    DS = "DS"
    SL = "SL"
    DL = "DL"
    CALL = "CALL"
    ON = "ON"
    OFF = "OFF"
    CS = "CS"
    CU = "CU"
    CD = "CD"
    CR = "CR"
    TL = "TL"
    TD = "TD"
    TR = "TR"
    TF = "TF"

    @property
    def needs_duration(self) -> bool:
        """True if IEC 61131-3 requires a duration with it."""
        return self in _TIMED


STEP_ACTIONS = {"entry": Qualifier.P1, "main": Qualifier.N, "exit": Qualifier.P0}
"""Step actions of CODESYS, each with the qualifier of an association that is executed at the same time."""
_TIMED = frozenset({Qualifier.L, Qualifier.D, Qualifier.SD, Qualifier.DS, Qualifier.SL, Qualifier.DL})


COILS = frozenset({Qualifier.N, Qualifier.D, Qualifier.L})
"""Qualifiers of S7-GRAPH whose targets are TRUE while a step is active, from a time on, or up to one."""

SWITCHES = frozenset({Qualifier.ON, Qualifier.OFF})
"""Qualifiers of S7-GRAPH that switch steps."""

COUNTERS = frozenset({Qualifier.CS, Qualifier.CU, Qualifier.CD, Qualifier.CR})
"""Qualifiers of S7-GRAPH that act on counters of S5."""

TIMERS = frozenset({Qualifier.TL, Qualifier.TD, Qualifier.TR, Qualifier.TF})
"""Qualifiers of S7-GRAPH that act on timers of S5."""

NEED_EVENT = (SWITCHES | COUNTERS | TIMERS) - {Qualifier.TF}
"""Qualifiers of S7-GRAPH that act on an event, and never without one."""

NEED_TIME = frozenset({Qualifier.D, Qualifier.L, Qualifier.TL, Qualifier.TD, Qualifier.TF})
"""Qualifiers of S7-GRAPH that have a time."""


class ActionEvent(StrEnum):
    """Events of S7-GRAPH that trigger an action once (S7-GRAPH V6: ``<Action Event=..>``).

    S1/S0 the step becomes active/inactive, V1/V0 a supervision error comes/goes, L1/L0 the interlock is lost/restored,
    A1 an error is acknowledged, R1 a registration comes. C: the action depends on the interlock (see
    `ActionAssociation.interlock`, where files state it). An action with an event is executed in one cycle, that
    in which the event comes, and not while the step is active; with an interlock it needs that in this cycle too.
    """

    S1 = "S1"
    S0 = "S0"
    V1 = "V1"
    V0 = "V0"
    L1 = "L1"
    L0 = "L0"
    A1 = "A1"
    R1 = "R1"
    C = "C"


class ActionKind(StrEnum):
    """The kinds of GRAFCET actions (IEC 60848:2013, 4.8 and 7)."""

    CONTINUOUS = "continuous"
    CONDITIONAL = "conditional"
    DELAYED = "delayed"
    LIMITED = "limited"
    ON_ACTIVATION = "onActivation"
    ON_DEACTIVATION = "onDeactivation"
    ON_EVENT = "onEvent"
    FORCING = "forcing"

    @property
    def words(self) -> str:
        """The kind as people write it: ``on activation``."""
        return re.sub("[A-Z]", lambda found: f" {found[0].lower()}", self.value)


class ForcedSituation(StrEnum):
    """The situations a forcing order can impose (IEC 60848:2013, 7.1)."""

    INITIAL = "INIT"
    EMPTY = "{}"
    CURRENT = "*"
    EXPLICIT = "explicit"


class ForcingOrder(Model):
    """Forces the partial chart `chart`: ``G2{INIT}``, ``G2{}``, ``G2{*}``, or ``G2{10,12}`` with `steps`."""

    chart: str
    situation: ForcedSituation
    steps: list[str] = Field(default_factory=list)

    def __str__(self) -> str:
        situation = ", ".join(self.steps) or self.situation.value.strip("{}")
        return f"{self.chart}{{{situation}}}"


class SymbolAccess(StrEnum):
    """Access to an element in the symbol configuration (CODESYS V3)."""

    UNSPECIFIED = "unspecified"
    NONE = "none"
    READ = "read"
    WRITE = "write"
    READ_WRITE = "readWrite"


class Monitoring(StrEnum):
    """Monitoring of a transition in the online view (CODESYS V3.5 SP14 on)."""

    NONE = "none"
    VARIABLE = "variable"
    CALL = "call"
