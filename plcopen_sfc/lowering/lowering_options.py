"""Options of a lowering: constructions, styles, languages, further rules, and the tools that code is for."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from plcopen_sfc.formats.format_interface import NetworkForm
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering.code_texts import Texts
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.profile import Profile


class Construction(StrEnum):
    """Form of the code of a chart.

    FLIPFLOP: a reset-dominant flip-flop for each step. CASE: one CASE on a state variable. REGIONS: one CASE for each
    part in which one step is active at a time. BITS: step bits in structured text. AUTO: the most readable of
    structured text that is exact.
    """

    FLIPFLOP = "flipflop"
    CASE = "case"
    REGIONS = "regions"
    BITS = "bits"
    AUTO = "auto"


class Style(StrEnum):
    """EXACT: the code does what the chart does. CLASSIC: the textbook form, which differs in known ways."""

    EXACT = "exact"
    CLASSIC = "classic"


class Language(StrEnum):
    """Language of the body that is made."""

    ST = "ST"
    FBD = "FBD"
    LD = "LD"
    IL = "IL"

    @property
    def is_drawn(self) -> bool:
        """True if bodies in it are networks."""
        return self in (Language.FBD, Language.LD)


class States(StrEnum):
    """Form of the states of a CASE.

    NUMBERS: the numbers of the steps. CONSTANTS: names of constants with these values. ENUMERATION: values of a type.
    """

    NUMBERS = "numbers"
    CONSTANTS = "constants"
    ENUMERATION = "enumeration"


class ActionPlace(StrEnum):
    """Place of the actions. INLINE: behind the sequence. BLOCK: in a block of their own, which the sequence calls."""

    INLINE = "inline"
    BLOCK = "block"


class OperatingMode(StrEnum):
    """Operating modes, for each of which lowered code gets inputs.

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
    """Rules that a lowering keeps.

    `profile`: how the chart is executed. `init`: the name of an input to add that restarts the sequence; None is the
    usual one, which textbook forms have and exact ones do not, an empty text is none for both. `stop`: a condition in
    the dialect of the project, or the name of an input to add; while it is TRUE initial steps are set and all others
    reset. `reset_actions`: `init` and `stop` end stored actions too. `flags`: the place of step flags: ``local``, an
    address of the first one (``M20.0``), or the name of a data block. `target`: the format that the code is for,
    without its version. `at_rest`: commands and mode switches of an S7-GRAPH block that are inactive inputs, ``all``
    for all that it has: there is no code for them, and the code does what the chart does while they are FALSE.
    `states`: None are names where the target takes them as labels of a CASE (`usual_states`). `part`: the action that
    the chart is in, for the names of its state variables; empty for that of the POU itself.
    """

    profile: Profile
    texts: Texts
    init: str | None = None
    stop: str | None = None
    reset_actions: bool = False
    states: States | None = None
    actions: ActionPlace = ActionPlace.INLINE
    flags: str = "local"
    modes: frozenset[OperatingMode] = frozenset()
    target: str | None = None
    at_rest: frozenset[str] = frozenset()
    part: str = ""


_TOOL_OF_DIALECT = {Dialect.SCL: Tool.S7, Dialect.CODESYS: Tool.CODESYS, Dialect.TWINCAT: Tool.CODESYS}


def tool_of(target: str | None, dialect: Dialect) -> Tool | None:
    """Return the tool that a format is for; without a format that of the dialect of the project. None: IEC 61131-3."""
    own = format_named(target)[0].dialect if target is not None else dialect
    return _TOOL_OF_DIALECT.get(own) if own is not None else None


def usual_states(style: Style, target: str | None, dialect: Dialect) -> States:
    """Return the form of states where none is asked for: constants, or an enumeration where those are no labels.

    Numbers for textbook code; for no target in plain IEC 61131-3, where the code is a body without a project; and for
    code in SCL that another tool gets, as SCL has no enumerations and the other tool no constants as labels.
    """
    # IEC 61131-3 ed. 2, 3.3.2.3, has literals and values of enumerations as labels of a CASE, and matiec, which also
    # compiles for Beremiz and OpenPLC, refuses constants there. Textbooks have numbers
    if style is Style.EXACT and tool_of(target, dialect) is not None:
        return States.CONSTANTS
    if style is Style.CLASSIC or target is None or dialect is Dialect.SCL:
        return States.NUMBERS
    return States.ENUMERATION


def has_one_sheet(target: str | None) -> bool:
    """Return True if a format has all networks of a body on one sheet, as TC6 does."""
    return target is not None and format_named(target)[0].one_sheet


def has_networks(target: str | None) -> bool:
    """Return True if a format can hold networks; in SCL they would only be comments."""
    return target is None or format_named(target)[0].networks is not NetworkForm.COMMENTS


def shows_networks(target: str | None) -> bool:
    """Return True if a file of a format shows networks: textual IEC 61131-3 holds them as statements of its own."""
    return target is None or format_named(target)[0].networks is NetworkForm.DRAWN


def has_instructions(target: str | None, dialect: Dialect) -> bool:
    """Return True if a format holds bodies in instruction list."""
    return format_named(target)[0].il_bodies if target is not None else dialect is not Dialect.SCL


def without_version(target: str) -> str:
    """Return the name of a format: ``simaticml`` of ``simaticml-V17``."""
    return format_named(target)[0].name
