"""Execution profiles: what tools silently disagree on when they run the same chart.

A profile is a record of choices; every field documents its meaning and its source. `PROFILES` holds those of
the standards and tools. For one of your own, change the fields that differ: ``dataclasses.replace(PROFILES["iec"],
name="mine", final_scan=False)``.

Sources, by the short names used below:

- *IEC*: IEC 61131-3 ed. 3, 6.7 (sequential function chart elements), 6.7.4.6 (action control).
- *60848*: IEC 60848:2013 (GRAFCET), 4.2 (rules of evolution), 4.8 (actions), 7 (forcing, enclosing, macro-steps).
- *CODESYS*: CODESYS V3 online help, "SFC": processing order, qualifiers, flags, implicit variables; Beckhoff InfoSys
  TC3 PLC, the pages of the same names.
- *CoDeSys 2.3*: user manual and help of CoDeSys V2.3 ("SFC flags", "IEC steps", "simplified steps").
- *GRAPH*: S7-GRAPH V5.3 manual (C79000-G7076-C526), TIA Portal help "Programming GRAPH".
- *Beremiz*: the open converter from TC6 to text of Beremiz and OpenPLC Editor (2025), by the text that it writes.
- *matiec*: the C code that matiec generates for SFC (2024), and what it does when it runs (`tests/judges`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from types import MappingProxyType

from plcopen_sfc.errors import ModelError, check_argument, nearest
from plcopen_sfc.languages.grafcet_conditions import is_grafcet
from plcopen_sfc.model import Dialect, Project, Qualifier, SfcFlag
from plcopen_sfc.semantics.net import Competing


class Evolution(StrEnum):
    """Evolution of the situation in one scan.

    SINGLE: every transition that is enabled and true at its beginning is cleared once. UNTIL_STABLE: this is repeated
    with the same inputs until nothing can be cleared any more (60848, "search for stability").
    """

    SINGLE = "single"
    UNTIL_STABLE = "until_stable"


class ScanOrder(StrEnum):
    """Order of actions and transitions in a scan.

    ACTIONS_FIRST: actions of the steps that were active at its beginning, then transitions; a step that becomes active
    is executed in the next scan. TRANSITIONS_FIRST: the actions are those of the new situation. RETIMED: no tool's
    order, but ACTIONS_FIRST as a comparison sees it: the scans are cut behind the actions instead of before them, so
    that the transitions of one and the actions of the next have the same inputs and the same time.
    """

    ACTIONS_FIRST = "actions_first"
    RETIMED = "retimed"
    TRANSITIONS_FIRST = "transitions_first"


class ActionControl(StrEnum):
    """The rule that decides if an action is executed.

    PER_ACTION: one control for each action, its inputs are the OR over all its associations (IEC). SEQUENTIAL: the
    associations act one after the other in the order of the steps, each by the elapsed time and the edges of its own
    step, and the last one that decides counts: where a step is left and an earlier step in the chart entered with N on
    the same action, it is not executed in that scan (matiec).
    """

    PER_ACTION = "per_action"
    SEQUENTIAL = "sequential"


class ActionOrder(StrEnum):
    """The order in which actions are executed in a scan.

    FIRST_USE: that in which the chart first uses them. ALPHABETIC: that of their names (CODESYS). DECLARED: that of
    their declarations in the POU; bodies of associations come before them, in the order of the chart.
    """

    FIRST_USE = "first_use"
    ALPHABETIC = "alphabetic"
    DECLARED = "declared"


class BooleanTargets(StrEnum):
    """When a Boolean variable that is an action is written.

    ALWAYS: it equals the output of the action control in every scan. WHEN_EXECUTED: TRUE while the action is executed
    and FALSE in its last execution; in between a program may write it. WHEN_DECIDED: only in scans in which an
    association decides on it: N, L, D while their step is active and in the scan in which it is left (D not before its
    time), P, P1 and P0 in every scan, S and R while their step is active, SD, DS and SL at the end of their times.
    """

    ALWAYS = "always"
    WHEN_EXECUTED = "when_executed"
    WHEN_DECIDED = "when_decided"


class OverlappingAddresses(StrEnum):
    """Memory of variables at addresses that overlap, as ``%MX0.0`` and ``%MW0``.

    LOW_BYTE_FIRST: the first byte of a word is its low one, so that ``%MX0.0`` has the value 1. HIGH_BYTE_FIRST: it is
    the high one, and the bit has the value 256. APART: each variable has memory of its own.
    """

    LOW_BYTE_FIRST = "low_byte_first"
    HIGH_BYTE_FIRST = "high_byte_first"
    APART = "apart"


class DrawnBlocks(StrEnum):
    """Scans that execute the boxes drawn before the condition of a transition: blocks, functions and edges.

    WHEN_ENABLED: in a scan in which the transition is enabled, right before its condition is evaluated. A timer is not
    reset while its transition is not enabled. EVERY_SCAN: in every scan, whatever steps are active.
    """

    WHEN_ENABLED = "when_enabled"
    EVERY_SCAN = "every_scan"


class StepVariables(StrEnum):
    """The variables that programs see of a step.

    ELAPSED: ``Step.X`` and ``Step.T`` (IEC), which are also ``.x`` and ``.t`` of CODESYS; where actions come first also
    ``._x``, whether it is active in the next scan. FLAG: a BOOL of the step's name where the chart has no action
    associations (CoDeSys 2.3, "simplified steps"). GRAPH: also ``.U``, ``.S1``, ``.V1`` .. and ``.SNO`` of S7-GRAPH.
    GRAFCET: also ``X12`` for step 12.
    """

    ELAPSED = "elapsed"
    FLAG = "flag"
    GRAPH = "graph"
    GRAFCET = "grafcet"


_IEC_QUALIFIERS = frozenset(
    {
        Qualifier.NONE,
        Qualifier.N,
        Qualifier.R,
        Qualifier.R0,
        Qualifier.S,
        Qualifier.L,
        Qualifier.D,
        Qualifier.P,
        Qualifier.P0,
        Qualifier.P1,
        Qualifier.SD,
        Qualifier.DS,
        Qualifier.SL,
    }
)
_GRAPH_QUALIFIERS = frozenset(Qualifier) - {
    Qualifier.R0,
    Qualifier.P,
    Qualifier.P0,
    Qualifier.P1,
    Qualifier.SD,
    Qualifier.DS,
    Qualifier.SL,
    Qualifier.DL,
}
CODESYS_FLAGS = frozenset(
    {
        SfcFlag.INIT,
        SfcFlag.RESET,
        SfcFlag.ERROR,
        SfcFlag.ENABLE_LIMIT,
        SfcFlag.ERROR_STEP,
        SfcFlag.ERROR_POU,
        SfcFlag.QUIT_ERROR,
        SfcFlag.PAUSE,
        SfcFlag.TRANS,
        SfcFlag.CURRENT_STEP,
        SfcFlag.TIP,
        SfcFlag.TIP_MODE,
        SfcFlag.ERROR_ANALYZATION,
        SfcFlag.ERROR_ANALYZATION_TABLE,
    }
)
"""The SFC flags whose effect is documented. ``CurrentSteps``, ``MetaSteps`` and ``MaxFlags`` appear in files only."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """Rules by which charts are executed. See the fields; docs/semantics.md has them as a table."""

    name: str
    """Name of the profile."""

    evolution: Evolution = Evolution.SINGLE
    """Evolutions in one scan. Single: IEC leaves it to the implementation, and CODESYS ("Processing order"), GRAPH and
    matiec make one. Until stable: 60848, 4.2 and its annex on transient evolution."""

    max_evolutions: int = 1000
    """The bound of the search for stability; more of them are an `UnstableChartError`. 60848 calls such a chart totally
    unstable and gives no bound; run-times bound it by 50 (ClassicLadder) up to the number of transitions (AGRAFE)."""

    competing: Competing = Competing.PRIORITY
    """Rule for competing transitions that are true together. Priority from left to right: IEC 6.7.3 (table of
    selections, case 1), CODESYS, GRAPH. All: 60848 rule 4, and matiec."""

    numbered_first: bool = False
    """True if a transition with a priority number excludes later competing ones although all may fire together.

    matiec: such a transition resets its source steps at once, one without ``PRIORITY`` does not. Competing transitions
    with and without a number are tested in the order of matiec's list, see
    `plcopen_sfc.semantics.charts.transition_firing.testing_order`.
    """

    order: ScanOrder = ScanOrder.TRANSITIONS_FIRST
    """Actions or transitions first. CODESYS: "Processing order" steps 2 to 6, actions first. GRAPH: conditions, step
    change, actions, the old and the new step in the same cycle. matiec: transitions first. IEC does not say.

    It decides when a new step acts: in the scan that activates it where transitions come first, else in the next."""

    initial_situation_held: bool = False
    """True if the transitions are not yet tested in the scan that activates the initial steps. GRAPH: the first call
    and INIT_SQ activate them without looking at conditions. Without effect where actions come first."""

    initial_steps_entered: bool = True
    """True if the start counts as an activation of the initial steps (pulses, entry actions, stored actions). matiec:
    no, the step was active "before" its first scan."""

    entering_restarts_time: bool = False
    """True if a step that is active already, and that a transition enters without its being left, counts its time from
    zero again. This happens in charts that are not safe only; 60848 rule 5: it stays active. matiec: it sets the time
    of every step that it enters to zero."""

    leaving_restarts_time: bool = True
    """True if a step that transitions leave and enter at once counts its time from zero again. 60848 rule 5: it stays
    active, so that no time of its variable begins again, ``3s/X5`` and a delayed action alike. Without effect where
    actions come first."""

    final_scan: bool = True
    """True if an action is executed once more after it ended (IEC 6.7.4.6, output A: with or without, the implementer
    chooses). CODESYS: yes, hence a P action runs exactly twice. matiec, GRAPH: no."""

    action_order: ActionOrder = ActionOrder.FIRST_USE
    """The order in which actions are executed, those that ended first. By name: CODESYS, "Processing order" step 5. As
    declared: matiec, which writes the bodies of actions one after the other as the text has them. IEC does not say."""

    action_control: ActionControl = ActionControl.PER_ACTION
    """The rule that decides if an action is executed. IEC 6.7.4.6; matiec."""

    reset_cancels_delays: bool = True
    """True if R also ends the pending times of SD and SL (IEC 6.7.4.6: R1 of their flip-flops; the time of DS is that
    of its step). matiec: a pending SD or DS goes on and sets the action after R; only the time of SL ends."""

    boolean_targets: BooleanTargets = BooleanTargets.ALWAYS
    """When a Boolean variable that is an action is written. IEC: the variable is the output Q. CODESYS, "Action": its
    value is switched when the "action" is executed. matiec: when an association decides on it, seen in every scan of
    compiled charts."""

    qualifiers: frozenset[Qualifier] = _IEC_QUALIFIERS
    """The qualifiers that exist. Any other is an `UnknownBehaviourError` of the first scan, as it is not known what it
    does: TC6 lists DL, which no standard defines, and matiec does not take it. matiec of 2024 takes all others;
    versions before about 2017 made no code that compiles for P0, P1 and DS, and SL never started its action."""

    drawn_blocks: DrawnBlocks = DrawnBlocks.WHEN_ENABLED
    """When boxes before a condition are executed. IEC does not say: a condition is evaluated while its transition is
    enabled (6.7.3), and what is drawn is a part of it. The converter of Beremiz and OpenPLC puts all boxes into one
    action, which it associates with S to the initial step: they are executed in every scan from the first in which that
    is active, and what they give was read in compiled charts."""

    drawn_blocks_late: bool = False
    """True if they are executed after the transitions, so that conditions see what boxes gave one scan ago. Contacts
    and variables that are wired directly are read when the transition is tested. Beremiz: the action comes after the
    transitions. Only together with ``EVERY_SCAN``."""

    drawn_logic: bool = True
    """True if logic that is drawn beside the steps and leads to no condition is executed, as a variable that is wired
    to the output of a step. The converter of Beremiz leaves it out without a word."""

    order_of_flow: bool = False
    """True if steps, with their actions, and transitions count in the order in which they are reached from the initial
    step instead of that of the file. The converter of Beremiz writes them so."""

    skips_operands: bool = False
    """True if AND and OR of Booleans end with the operand that decides, so that a function behind it is not called. IEC
    allows both (ed. 2, 3.3.1). CODESYS evaluates all, but for AND_THEN and OR_ELSE. matiec: seen in its C code."""

    truncates_to_int: bool = False
    """True if TRUNC gives an INT. CoDeSys 2.3; in CODESYS V3, whose importer makes TRUNC_INT of it, it is a DINT."""

    for_asks_ahead: bool = False
    """True if each turn of a FOR, the first too, needs the next value of its variable to be within the end, which is
    evaluated again in each turn: a loop of one turn is left out, and its variable ends a turn earlier than in IEC
    61131-3, 7.3.3.4.2. matiec: seen in the C code of 2024."""

    matiec_library: bool = False
    """True if standard functions and blocks do what those in the library of matiec do (2024, compiled and run).

    Counters end at PV and at 0. Integers of 8 and 16 bits are calculated with as an int of C.

    TIME and numbers become each other in seconds, integers without the fraction: ``TIME_TO_DINT(T#2s5ms)`` is 2, where
    all others count milliseconds (IEC 61131-3 leaves it open). FIND and REPLACE, and texts from and to numbers and
    times, are in `plcopen_sfc.semantics.programs.matiec_runtime`."""

    overlapping_addresses: OverlappingAddresses = OverlappingAddresses.LOW_BYTE_FIRST
    """Memory of variables at addresses that overlap. IEC leaves it to the tool; most controllers of CODESYS have the
    low byte first. S7: help of TIA Portal, "Addressing". matiec declares a variable for each address. Runs refuse
    addresses that overlap; conversions report them."""

    minimum_times: bool = False
    """True if a step is left only after its minimum time. CODESYS, "Processing order" step 6."""

    maximum_times: bool = False
    """True if a step that is active longer than its maximum time raises ``SFCError``. CODESYS, "SFC flags"."""

    step_actions: bool = True
    """True if entry, main and exit actions of steps are executed: entry and exit once, the exit action in the scan
    after the transition was cleared (CODESYS, "Processing order" steps 2 to 4). Only CODESYS has them; where
    transitions come first they are executed in the scan of the change, so that a chart of CODESYS keeps its meaning. A
    profile without them refuses them with an `UnknownBehaviourError`."""

    flags: frozenset[SfcFlag] = frozenset()
    """The SFC flags that a chart obeys or sets where they are in use (by its settings, or declared). CODESYS."""

    init_ends_actions: bool = True
    """True if SFCInit also ends stored and timed actions: "steps, actions and other flags are reset" (CODESYS)."""

    reset_ends_actions: bool = True
    """The same for SFCReset. CoDeSys 2.3: for Boolean actions from compiler 2.3.7.0 on."""

    pause_stops_time: bool = False
    """True if the times of steps and actions stand still during SFCPause. Not documented; the step time is the
    difference between the clock and the start (``SFCStepType._t``), which a pause does not move."""

    step_variables: StepVariables = StepVariables.ELAPSED
    """The variables that programs see of a step. IEC 6.7.2; CODESYS "Implicit variables"; GRAPH "Step data"."""

    graph_parameters: bool = False
    """True if charts are sequencers of GRAPH: INIT_SQ, OFF_SQ, ACK_EF, S_SEL, S_ON, S_OFF, T_PUSH and the operating
    modes act on them, actions depend on events and interlocks, supervisions hold steps, and the operand of an action
    is a coil. The choices above on final scan, order of actions, action control and flags do not concern them."""

    grafcet_terms: bool = False
    """True if conditions may have the edges and times of 60848, 4.6: ``↑a``, ``3s/X5``. In program text ``a/3s`` could
    be a division. The kinds of actions, forcing orders and enclosing steps of 60848 are known to every profile that
    tests transitions first, for they cannot be mistaken for anything else."""

    def __repr__(self) -> str:
        return f"Profile({self.name!r})"

    def __post_init__(self) -> None:
        """Refuse choices that contradict each other. Raises `ModelError`."""
        if self.max_evolutions < 1:
            raise ModelError("a scan has at least one evolution: max_evolutions must be positive")
        if self.evolution is Evolution.UNTIL_STABLE and self.order is ScanOrder.ACTIONS_FIRST:
            raise ModelError("a search for stability ends before the actions: transitions must come first")
        sequential = self.action_control is ActionControl.SEQUENTIAL
        if sequential is not (self.boolean_targets is BooleanTargets.WHEN_DECIDED) or (sequential and self.final_scan):
            raise ModelError(
                "where associations act one after the other they also decide when a variable is written, and there is "
                "no final scan"
            )
        if self.drawn_blocks_late is not (self.drawn_blocks is DrawnBlocks.EVERY_SCAN):
            raise ModelError("boxes that are executed in every scan are so after the transitions, and others before")
        if self.graph_parameters and (
            self.evolution is not Evolution.SINGLE
            or self.order is not ScanOrder.TRANSITIONS_FIRST
            or not self.initial_situation_held
        ):
            raise ModelError(
                "a sequencer of S7-GRAPH makes one evolution, before the actions, and none in the cycle of its start"
            )


_CODESYS = Profile(
    name="codesys",
    order=ScanOrder.ACTIONS_FIRST,
    action_order=ActionOrder.ALPHABETIC,
    boolean_targets=BooleanTargets.WHEN_EXECUTED,
    minimum_times=True,
    maximum_times=True,
    flags=CODESYS_FLAGS,
)

_MATIEC = Profile(
    name="matiec",
    competing=Competing.ALL,
    numbered_first=True,
    initial_steps_entered=False,
    entering_restarts_time=True,
    final_scan=False,
    action_order=ActionOrder.DECLARED,
    action_control=ActionControl.SEQUENTIAL,
    reset_cancels_delays=False,
    boolean_targets=BooleanTargets.WHEN_DECIDED,
    skips_operands=True,
    for_asks_ahead=True,
    matiec_library=True,
    overlapping_addresses=OverlappingAddresses.APART,
)

PROFILES: Mapping[str, Profile] = MappingProxyType(
    {
        "iec": Profile(name="iec"),
        "codesys": _CODESYS,
        "codesys23": replace(_CODESYS, name="codesys23", step_variables=StepVariables.FLAG, truncates_to_int=True),
        "s7graph": Profile(
            name="s7graph",
            initial_situation_held=True,
            final_scan=False,
            qualifiers=_GRAPH_QUALIFIERS,
            step_actions=False,
            overlapping_addresses=OverlappingAddresses.HIGH_BYTE_FIRST,
            step_variables=StepVariables.GRAPH,
            graph_parameters=True,
        ),
        "grafcet": Profile(
            name="grafcet",
            evolution=Evolution.UNTIL_STABLE,
            competing=Competing.ALL,
            leaving_restarts_time=False,
            final_scan=False,
            step_variables=StepVariables.GRAFCET,
            grafcet_terms=True,
        ),
        "matiec": _MATIEC,
        "beremiz": replace(
            _MATIEC,
            name="beremiz",
            action_order=ActionOrder.FIRST_USE,
            drawn_blocks=DrawnBlocks.EVERY_SCAN,
            drawn_blocks_late=True,
            drawn_logic=False,
            order_of_flow=True,
        ),
    }
)
"""The profiles by name: iec, codesys (V3 and TwinCAT 3), codesys23, s7graph, grafcet, matiec (charts as text), beremiz
(TC6 files of Beremiz and OpenPLC Editor, which a converter makes text for matiec of)."""


def profile(choice: str | Profile) -> Profile:
    """Return the profile of this name, or the given one itself. Raises `ModelError` for an unknown name."""
    if isinstance(choice, Profile):
        return choice
    check_argument(choice, str, "a profile is a Profile or the name of one")
    found = PROFILES.get(choice.casefold())
    if found is None:
        near = nearest(choice, PROFILES)
        raise ModelError(f"there is no profile {choice!r}{near}", hint="There are: " + ", ".join(PROFILES))
    return found


_BY_FORMAT = {
    "codesys": "codesys",
    "twincat": "codesys",
    "codesys-export": "codesys",
    "codesys23": "codesys23",
    "simaticml": "s7graph",
    "scl": "s7graph",
    "grafcet": "grafcet",
    "grafcet-text": "grafcet",
}
_BY_DIALECT = {Dialect.CODESYS: "codesys", Dialect.TWINCAT: "codesys", Dialect.SCL: "s7graph"}


def default_profile(project: Project) -> Profile:
    """Return the profile of the tool that a project is for.

    The format it was read from decides, of a converted file that keeps its charts that of its origin; then the dialect
    of its texts. A TC6 file of Beremiz or OpenPLC Editor is told by its header. All others are ``iec``, but for
    projects whose charts have partial charts or actions of IEC 60848: those are ``grafcet``.
    """
    found = profile_as(project, project.tool_format)
    source, flag = project.source, StepVariables.FLAG
    if not project.is_converted or source is None or source.format == "json":  # which is all of a model
        return found
    notation = profile_of_format(source.format).step_variables
    is_other = flag in (found.step_variables, notation) and not found.graph_parameters  # which needs the data of steps
    return replace(found, step_variables=notation) if is_other else found


def profile_as(project: Project, format: str) -> Profile:
    """Return the profile of the tool that a project is for, were it read from a format and no converted file."""
    name = _BY_FORMAT.get(format)
    if name is None and format != project.origin:  # an origin without a tool of its own is none of the dialect
        name = _BY_DIALECT.get(project.dialect)
    if name is None and format.startswith("plcopen") and project.header.is_of_beremiz:
        name = "beremiz"
    if name is None:
        name = "grafcet" if any(is_grafcet(chart) for _, _, chart in project.charts()) else "iec"
    return PROFILES[name]


def profile_of_format(name: str) -> Profile:
    """Return the profile of the tools that read files of a format, as far as its name tells."""
    return PROFILES[_BY_FORMAT.get(name, "iec")]


def have_equal_rules(one: Profile, other: Profile) -> bool:
    """True if two profiles differ at most in their names, and in how texts name steps and functions."""
    texts = replace(one, step_variables=other.step_variables, truncates_to_int=other.truncates_to_int)
    return replace(texts, name=other.name) == other


def format_of_profile(name: str) -> str:
    """Return the format whose files have the profile of this name by their format alone; TC6 for what has none."""
    return next((format for format, profile in _BY_FORMAT.items() if profile == name), "plcopen")
