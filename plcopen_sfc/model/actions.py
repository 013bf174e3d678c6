"""Actions of steps: action associations with their qualifiers, events and GRAFCET kinds."""

from __future__ import annotations

import re
from enum import StrEnum
from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import Field

from plcopen_sfc.errors import ModelError
from plcopen_sfc.model import times
from plcopen_sfc.model.base import Element, ElementId, Model
from plcopen_sfc.model.conditions import Condition

if TYPE_CHECKING:
    from plcopen_sfc.model.body import Body


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


_TIMED = frozenset({Qualifier.L, Qualifier.D, Qualifier.SD, Qualifier.DS, Qualifier.SL, Qualifier.DL})


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


class ActionAssociation(Element):
    """One line of an action block: what is done, when, for how long.

    `target` names a Boolean variable, an action of the POU, or an action of an instance (``Motor.ACT_Stop``); `body`
    is an action programmed in place; TC6 allows both at once. `value` is what is assigned to the target (S7-GRAPH ``A
    := B``, GRAFCET stored actions). `duration` is a time literal or a variable. `indicator` is the variable that
    reports that the step is done. `negated` (TC6 action block): it acts while the step is *not* active.
    `event` and `interlock` are S7-GRAPH's, `kind`, `condition` and `forcing` are GRAFCET's.
    """

    id: ElementId
    qualifier: Qualifier = Qualifier.N
    target: str | None = None
    body: Body | None = None
    value: str | None = None
    duration: str | None = None
    indicator: str | None = None
    negated: bool = False
    event: ActionEvent | None = None
    interlock: bool = False
    kind: ActionKind | None = None
    condition: Condition | None = None
    forcing: ForcingOrder | None = None
    exclude: bool = False
    symbol: SymbolAccess = SymbolAccess.UNSPECIFIED

    TIMES: ClassVar[tuple[str, ...]] = ("duration",)

    @classmethod
    def parse(cls, text: str, id: int) -> Self:
        """Return the association that a text describes, as people write it into an action block.

        ``N Valve``, ``D T#2s Lamp``, ``S Count := Count + 1``; with an event of S7-GRAPH ``S1 R Valve`` (``C``: it
        needs the interlock); ``Valve`` alone is N. Raises `ModelError` for a text that is no such line.
        """
        words = text.split(maxsplit=1)
        fields: dict[str, Any] = {}
        if len(words) == 2 and words[0].upper() in ActionEvent.__members__:
            event = ActionEvent(words[0].upper())
            fields |= {"interlock": True} if event is ActionEvent.C else {"event": event}
            words = words[1].split(maxsplit=1)
        if len(words) == 2 and words[0].upper() in Qualifier.__members__:
            qualifier = fields["qualifier"] = Qualifier(words[0].upper())
            words = words[1:]
            if qualifier.needs_duration:
                duration, _, target = words[0].partition(" ")
                fields["duration"], words = duration, [target]
        target, assigns, value = " ".join(words).partition(":=")
        wrong = not target.strip() or (assigns and not value.strip()) or len(_ENCLOSED.sub("", target).split()) > 1
        if wrong or ("duration" in fields and times.objection(fields["duration"])):
            raise ModelError(
                f"{text!r} is no action of a step",
                hint='Write qualifier, time and target: "N Valve", "D T#2s Lamp", "S Count := Count + 1".',
            )
        return cls(id=id, target=target.strip(), value=value.strip() or None, **fields)

    @property
    def text(self) -> str:
        """The association as `parse` takes it; of a body in place its language, of a GRAFCET its kind."""
        event = "C" if self.interlock and self.event is None else self.event
        when = self.kind if self.kind is not None else self.qualifier
        target = self.target or (f"({self.body.language})" if self.body is not None else str(self.forcing or ""))
        parts = (event, when if when is not Qualifier.NONE else None, self.duration, target)
        return " ".join(str(part) for part in parts if part) + (f" := {self.value}" if self.value else "")


_ENCLOSED = re.compile(r'"[^"]*"|\[[^\]]*\]')
"""Parts of a target that may have blanks in them: quoted names and indices."""


class Monitoring(StrEnum):
    """Monitoring of a transition in the online view (CODESYS V3.5 SP14 on)."""

    NONE = "none"
    VARIABLE = "variable"
    CALL = "call"
