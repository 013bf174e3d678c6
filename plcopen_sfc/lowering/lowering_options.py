"""Options of a lowering: constructions, styles, languages, further rules, and the tools that code is for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from typing import TypedDict, TypeVar

from plcopen_sfc.errors import LoweringError, check_argument, listed_names, nearest
from plcopen_sfc.formats.format_interface import Format, NetworkForm
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.languages.networks.exported_networks import EXPORTS
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering.code_texts import TEXTS, Texts
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.semantics.profile import profile as profile_named

LOCAL = "local"
"""The place of step flags where none is asked for: among the variables of the block."""


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


class LoweringOptions(TypedDict, total=False):
    """Options of a lowering as a user writes them, but for the construction and the target.

    `style`: ``exact`` does what the chart does, ``classic`` is the textbook form. `language`: ``ST``, ``FBD``, ``LD``
    or ``IL``; usual are FBD for flip-flops and ST for all others, also where the target is text. `profile`: how the
    chart is executed; that of its tool if not given. `init`: the name of an input to add that restarts the sequence;
    None is the usual one, which textbook forms have and exact ones do not, an empty text is none for both. `stop`: a
    condition in the dialect of the project, or the name of an input to add; while it is TRUE initial steps are set and
    all others reset. `reset_actions`: `init` and `stop` end stored actions too. `states`: the form of the states of a
    CASE; None are names where the target takes them as labels (`usual_states`). `actions`: their place. `flags`: the
    place of step flags: ``local``, an address of the first one (``M20.0``), or the name of a data block. `flag_names`:
    the name of step 1's flag, such as ``SR01``, after which those of all numbered steps are called. `modes`: operating
    modes to add. `at_rest`: commands and mode switches of an S7-GRAPH block that are inactive inputs, ``all`` for all
    that it has: there is no code for them, and the code does what the chart does while they are FALSE. `lang`: of
    titles and comments, ``en`` or ``de``.
    """

    style: Style | str
    language: Language | str | None
    profile: Profile | str | None
    init: str | None
    stop: str | None
    reset_actions: bool
    states: States | str | None
    actions: ActionPlace | str
    flags: str
    flag_names: str
    modes: Iterable[OperatingMode | str]
    at_rest: Iterable[str]
    lang: str


@dataclass(frozen=True)
class LoweringRules:
    """Rules that a lowering keeps: the options of a user, checked (`checked`), and what was chosen without one.

    `texts` are in the language of `lang`, with `flag_names`. `target`: the format that the code is for, without its
    version. `flavour`: the family of readers of that format that it is for (``matiec``); empty: all. `part`: the action
    that the chart is in, for the names of its state variables; empty for that of the POU itself. All others are those
    of `LoweringOptions`.
    """

    profile: Profile
    texts: Texts = TEXTS["en"]
    construction: Construction = Construction.AUTO
    style: Style = Style.EXACT
    language: Language | None = None
    init: str | None = None
    stop: str | None = None
    reset_actions: bool = False
    states: States | None = None
    actions: ActionPlace = ActionPlace.INLINE
    flags: str = LOCAL
    modes: frozenset[OperatingMode] = frozenset()
    target: str | None = None
    at_rest: frozenset[str] = frozenset()
    flavour: str = ""
    part: str = ""

    @property
    def format(self) -> Format | None:
        """Record of the target; None for code without one."""
        return format_named(self.target)[0] if self.target is not None else None

    @property
    def networks(self) -> NetworkForm:
        """Form of networks in the target."""
        return self.format.networks if self.format is not None else NetworkForm.DRAWN

    @property
    def is_classic(self) -> bool:
        """True if the code is to have the textbook form."""
        return self.style is Style.CLASSIC


def checked(
    project: Project,
    options: LoweringOptions,
    *,
    construction: Construction | str,
    target: str | None,
    flavour: str = "",
) -> LoweringRules:
    """Return the rules for the charts of a project that a user asks for.

    Raises `LoweringError` for an unknown choice, `ArgumentError` for an option of a wrong type.
    """
    init, stop, flags = options.get("init"), options.get("stop"), options.get("flags", LOCAL)
    flag_names = options.get("flag_names", "")
    lang, language, states = options.get("lang", "en"), options.get("language"), options.get("states")
    for name, value in {"init": init, "stop": stop}.items():
        check_argument(value, (str, type(None)), f"{name} is a text")
    for name, value in {"flags": flags, "flag_names": flag_names, "lang": lang}.items():
        check_argument(value, str, f"{name} is a text")
    profile = options.get("profile")
    modes = listed_names(options.get("modes", ()), "modes are named by texts")
    return LoweringRules(
        default_profile(project) if profile is None else profile_named(profile),
        _texts(lang, flag_names),
        _chosen(Construction, construction),
        _chosen(Style, options.get("style", Style.EXACT)),
        _chosen(Language, language) if language is not None else None,
        init,
        stop,
        options.get("reset_actions", False),
        _chosen(States, states) if states is not None else None,
        _chosen(ActionPlace, options.get("actions", ActionPlace.INLINE)),
        flags,
        frozenset(_chosen(OperatingMode, mode) for mode in modes),
        format_named(target)[0].name if target is not None else None,
        frozenset(listed_names(options.get("at_rest", ()), "inputs at rest are named by texts")),
        flavour,
    )


def _texts(lang: str, flag_names: str) -> Texts:
    """Return the texts of a language, with the names of flags after that of step 1."""
    texts = TEXTS.get(lang)
    if texts is None:
        raise LoweringError(f"there are no texts in {lang!r}", hint="There are: " + ", ".join(TEXTS))
    try:
        return texts.with_flags(flag_names) if flag_names else texts
    except ValueError:
        raise LoweringError(
            f"{flag_names!r} is no name of the flag of step 1", hint="It ends with its number: SR01, Step_1."
        ) from None


_ALIASES: dict[type[StrEnum], dict[str, str]] = {
    Construction: {"fup": "flipflop"},
    Language: {"fup": "FBD", "kop": "LD", "awl": "IL", "scl": "ST"},
}
"""The names that German editors and users have for them."""
_NOUNS: dict[type[StrEnum], str] = {
    Construction: "construction",
    Style: "style",
    Language: "language for it",
    States: "kind of states",
    ActionPlace: "place for actions",
    OperatingMode: "operating mode",
}
Choice = TypeVar("Choice", Construction, Style, Language, States, ActionPlace, OperatingMode)


def _chosen(kind: type[Choice], name: str) -> Choice:
    check_argument(name, str, f"a {_NOUNS[kind]} is named by a text")
    folded = name.casefold()
    wanted = _ALIASES.get(kind, {}).get(folded, folded).casefold()
    for each in kind:
        if each.value.casefold() == wanted:
            return each
    known = [each.value for each in kind]
    message = f"there is no {_NOUNS[kind]} {name!r}{nearest(name, known)}"
    raise LoweringError(message, hint="There are: " + ", ".join(known))


_TOOL_OF_DIALECT = {Dialect.SCL: Tool.S7, Dialect.CODESYS: Tool.CODESYS, Dialect.TWINCAT: Tool.CODESYS}


def tool_of(target: str | None, dialect: Dialect) -> Tool | None:
    """Return the tool that a format is for; without a format that of the dialect of the project. None: IEC 61131-3."""
    own = format_named(target)[0].dialect if target is not None else dialect
    return _TOOL_OF_DIALECT.get(own) if own is not None else None


def has_line_comments(rules: LoweringRules, dialect: Dialect, project: Project) -> bool:
    """True if code may have ``//``: edition 2 of IEC 61131-3, as in matiec, and CoDeSys 2.3 have no such comments."""
    if (rules.target or project.tool_format) == EXPORTS:
        return False
    # the listings of textbooks have // in every other file
    return rules.is_classic or rules.target is None or tool_of(rules.target, dialect) is not None


def usual_states(rules: LoweringRules, dialect: Dialect) -> States:
    """Return the form of states where none is asked for: constants, or an enumeration where those are no labels.

    Numbers for textbook code; for no target in plain IEC 61131-3, where the code is a body without a project; and for
    code in SCL that another tool gets, as SCL has no enumerations and the other tool no constants as labels.
    """
    # IEC 61131-3 ed. 2, 3.3.2.3, has literals and values of enumerations as labels of a CASE, and matiec, which also
    # compiles for Beremiz and OpenPLC, refuses constants there. Textbooks have numbers
    if not rules.is_classic and tool_of(rules.target, dialect) is not None:
        return States.CONSTANTS
    if rules.is_classic or rules.target is None or dialect is Dialect.SCL:
        return States.NUMBERS
    return States.ENUMERATION
