"""Lowering of one chart, or of all charts of a project, with the proof that the code does the same."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from inspect import signature
from typing import Any, NamedTuple, TypedDict, TypeVar, Unpack

from plcopen_sfc.analysis.equivalence import Searching
from plcopen_sfc.analysis.verdict import Verdict, VerdictKind
from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.errors import ArgumentError, Location, LoweringError, check_argument, listed_names, nearest
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering.code.lowered_code import flags_of_part, flags_of_several
from plcopen_sfc.lowering.code_texts import TEXTS, Texts
from plcopen_sfc.lowering.construction import Constructed, construct, errors_of
from plcopen_sfc.lowering.faults.fault_kinds import Fault
from plcopen_sfc.lowering.faults.fault_search import find_faults
from plcopen_sfc.lowering.grafcet.grafcet_reading import read_plain, stop_condition, without_emergency_stop
from plcopen_sfc.lowering.lowering_losses import losses
from plcopen_sfc.lowering.lowering_options import (
    ActionPlace,
    Construction,
    Language,
    LoweringRules,
    OperatingMode,
    States,
    Style,
    tool_of,
    without_version,
)
from plcopen_sfc.lowering.other_bodies import (
    with_actions,
    with_actions_inside,
    without_external_declarations,
    without_uncalled_actions,
    without_unused_parts,
)
from plcopen_sfc.lowering.proof import ProofOptions, prove, refuse_untested
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import Body, SfcNetwork
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.report import Item
from plcopen_sfc.semantics.charts.graph.graph_parameters import OPERATING
from plcopen_sfc.semantics.drawn_charts import as_executed
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.semantics.profile import profile as profile_named
from plcopen_sfc.semantics.subjects import Subject, resolve

Choice = TypeVar("Choice", Construction, Style, Language, States, ActionPlace, OperatingMode)


@dataclass(frozen=True, kw_only=True, repr=False)
class LoweredPou(Constructed):
    """POU with code in the place of its chart, in a copy of its project, and what is known of that code.

    `proof` is the result of the comparison with the chart, None where none was wanted. `faults` are those of textbook
    code (`find_faults`), as far as it was compared. `name` is that of the chart: ``Main``, or ``Main.Fill`` for the
    chart of an action, which has the code now. `losses` are what the chart held and the code does not. `chart` is what
    was lowered. A file with the code is compared with it when the project is saved, as `proof_options` ask; None where
    no proof was wanted.
    """

    project: Project
    style: Style
    proof: Verdict | None
    faults: tuple[Fault, ...] = ()
    name: str
    losses: tuple[Item, ...] = ()
    chart: Subject
    proof_options: ProofOptions | None = None

    @property
    def code(self) -> Body | None:
        """Code that was made."""
        action = next((a for a in self.pou.actions if f"{self.pou.name}.{a.name}" == self.name), None)
        return action.body if action is not None else self.pou.body

    @property
    def profile(self) -> Profile:
        """Execution profile of the chart."""
        return self.rules.profile

    @property
    def language(self) -> str:
        """Language of the code: ``ST``, ``FBD``, ``LD`` or ``IL``."""
        return str(self.code.language) if self.code is not None else ""

    def __repr__(self) -> str:
        return f"LoweredPou({self.name}: {self.style} {self.construction} in {self.language}, {self.proof!r})"

    def __str__(self) -> str:
        """Return the construction and the reason for it, the comparison, and the faults, a line or more for each."""
        lines = [f"{self.name}: {self.style} {self.construction} in {self.language}: {self.why}"]
        if OperatingMode.SELECT in self.rules.modes:
            numbers = ", ".join(f"{number} {path}" for path, number in self.step_numbers.items())
            lines.append(f"steps are selected by their numbers: {numbers}")
        if self.rules.at_rest:
            resting = [name for name in self.at_rest if name.upper() in OPERATING]
            lines.append(f"at rest, without code: {', '.join(resting) or 'nothing'}")
        if self.proof is not None:
            verdict = str(self.proof).splitlines()
            lines.append(f"under the profile {self.profile.name}: {verdict[0]}")
            lines += [] if self.faults else verdict[1:]  # their traces show the same
        return "\n".join([*lines, *map(str, self.faults)])

    def as_dict(self) -> dict[str, Any]:
        """Return the content of `str` as plain data, for JSON."""
        return {
            "pou": self.name,
            "construction": self.construction.value,
            "style": self.style.value,
            "language": self.language,
            "profile": self.profile.name,
            "why": self.why,
            "proof": self.proof.as_dict() if self.proof is not None else None,
            "faults": [fault.as_dict() for fault in self.faults],
            "step_numbers": dict(self.step_numbers),
            "at_rest": dict(self.at_rest),
            "losses": [asdict(item) for item in self.losses],
        }


def lower(
    subject: SfcNetwork | Pou | Project,
    construction: Construction | str = Construction.AUTO,
    *,
    pou: str | None = None,
    style: Style | str = Style.EXACT,
    language: Language | str | None = None,
    profile: Profile | str | None = None,
    init: str | None = None,
    stop: str | None = None,
    reset_actions: bool = False,
    states: States | str | None = None,
    actions: ActionPlace | str = ActionPlace.INLINE,
    flags: str = "local",
    flag_names: str = "",
    modes: Iterable[OperatingMode | str] = (),
    target: str | None = None,
    at_rest: Iterable[str] = (),
    lang: str = "en",
    verify: bool = True,
    accept_untested: bool = False,
    **searching: Unpack[Searching],
) -> LoweredPou:
    """Make program code of a chart: flip-flops (``flipflop``, ``fup``), a ``case``, step ``bits``, or what fits best.

    `subject` and `pou` as in `simulate`. `style`: ``exact`` does what the chart does, ``classic`` is the textbook form.
    `language`: ``ST``, ``FBD`` or ``LD``; usual are FBD for flip-flops and ST for all others, also where `target` is
    text. `profile`: what the chart does; that of its tool if not given. `lang`: of titles and comments, ``en`` or
    ``de``. `verify`: compare the code with the chart under the profile, all inputs that were added being inactive;
    `flag_names`: the name of step 1's flag, such as ``SR01``, after which those of all numbered steps are called.
    `searching` are options of the search (`equivalent`). `accept_untested`: take code of which not all was reached when
    it was compared. All others are those of `LoweringRules`.

    Nothing is changed in `subject`. Raises `LoweringError` for what the target cannot express, and where exact code is
    found to be different; `UntestedError` where it is equal, but steps or transitions were not reached that may be
    reachable; `ModelError` for an unknown name.
    """
    known = {*signature(lower).parameters, *signature(prove).parameters, *Searching.__annotations__}
    for name in searching.keys() - known:
        raise ArgumentError(f"lower has no option {name!r}{nearest(name, known)}")
    wanted = _Wanted(
        _chosen(Construction, _ALIASES.get(str(construction), str(construction))),
        _chosen(Style, str(style)),
        _chosen(Language, str(language).upper()) if language is not None else None,
    )
    for name, value in {"init": init, "stop": stop, "flags": flags, "lang": lang}.items():
        check_argument(value, (str, type(None)), f"{name} is a text")
    found = resolve(subject, pou)
    _chart_of(found)
    _refuse_what_was_not_read(found)
    semantics = default_profile(found.project) if profile is None else profile_named(profile)
    rules = LoweringRules(
        semantics,
        _texts(lang, flag_names),
        init,
        stop_condition(stop, found, semantics) if stop is not None else None,
        reset_actions,
        _chosen(States, str(states)) if states is not None else None,
        _chosen(ActionPlace, str(actions)),
        flags,
        frozenset(_chosen(OperatingMode, mode) for mode in listed_names(modes, "modes are named by texts")),
        without_version(target) if target is not None else None,
        frozenset(listed_names(at_rest, "inputs at rest are named by texts")),
    )
    meant, pressed = as_executed(found, semantics), ""
    if wanted.style is Style.CLASSIC:
        meant, pressed = without_emergency_stop(meant, semantics)
        if pressed:
            flags_left = flags_of_part(flags, _chart_of(found), _chart_of(meant))
            rules = replace(rules, stop=rules.stop or pressed, init=rules.init or "", flags=flags_left)
    with collecting_rarely(), errors_of(found.project, found.pou, found.name):
        made = _constructed(found, meant, wanted, rules)
        if pressed:
            made = replace(made, step_flags=_by_original_path(made.step_flags, _chart_of(found)))
    options = ProofOptions(accept_untested, searching) if verify else None
    lowered = _lowered(found, made, rules, wanted.style, options, lang=lang)
    return replace(lowered, faults=faults_of(meant, lowered)) if verify else lowered


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


def _lowered(
    chart: Subject, made: Constructed, rules: LoweringRules, style: Style, options: ProofOptions | None, *, lang: str
) -> LoweredPou:
    """Return the code in a copy of the project, compared with `chart` where there are `options`."""
    project, pou = _with(chart, made.pou, made.blocks, made.data_types)
    if made.flags is not None:
        made.flags.put_into(project)
    proof = None
    if options is not None:
        code = Subject(project, made.pou, chart.name)
        proof = _proof(chart, code, made, rules.profile, style, **options.searching)
        with errors_of(chart.project, chart.pou, chart.name):
            refuse_untested(chart.name, proof, accepted=options.accept_untested)
    return LoweredPou(
        **(vars(made) | {"pou": pou}),
        project=project,
        style=style,
        proof=proof,
        name=chart.name,
        losses=losses(chart, [pou, *made.blocks], rules.profile, lang),
        chart=chart,
        proof_options=options,
    )


class _Wanted(NamedTuple):
    """Code that a user wants."""

    construction: Construction
    style: Style
    language: Language | None


def _constructed(chart: Subject, meant: Subject, wanted: _Wanted, rules: LoweringRules) -> Constructed:
    """Return the code of `chart` and of the charts that it brings along, made from what is executed (`meant`)."""
    dialect = chart.project.dialect

    made = construct(
        meant.pou,
        _chart_of(meant),
        dialect,
        rules,
        construction=wanted.construction,
        style=wanted.style,
        language=wanted.language,
        project=meant.project,
    )
    made = with_actions(made, dialect, rules, wanted.language, chart.project)
    if rules.target is not None and tool_of(rules.target, dialect) is Tool.S7:
        pou = without_external_declarations(with_actions_inside(made.pou, dialect), meant.project)
        pou = without_uncalled_actions(pou, meant.project) if chart.name == chart.pou.name else pou
        made = replace(made, pou=pou)
    if chart.name == chart.pou.name:
        made = replace(made, pou=without_unused_parts(meant.pou, made.pou, dialect))
    return made


def _by_original_path(flags: Mapping[str, str], chart: SfcNetwork) -> dict[str, str]:
    """Return the flags of a chart by the paths in `chart`, where it may be one of several partial charts."""
    paths = {step.path for step in Net.of(chart).steps}
    inside = {path.partition(".")[2]: path for path in paths}
    return {path if path in paths else inside[path]: flag for path, flag in flags.items()}


def _chart_of(subject: Subject) -> SfcNetwork:
    if subject.pou.chart is None:
        raise LoweringError("there is no chart to be lowered", location=Location(path=subject.name))
    return subject.pou.chart


def _proof(
    chart: Subject, code: Subject, made: Constructed, profile: Profile, style: Style, **searching: Unpack[Searching]
) -> Verdict:
    """Compare `code` with `chart`. Raises `LoweringError` where exact code is different."""
    with errors_of(chart.project, chart.pou, chart.name):
        found = prove(
            chart,
            code,
            profile,
            fixed=made.at_rest,
            left_out=made.left_out,
            step_flags=made.step_flags or None,
            **searching,
        )
        if found.kind is VerdictKind.DIFFERENT and style is Style.EXACT:
            raise LoweringError(
                f"the code does not do what the chart does: {found}",
                hint="This is an error of plcopen_sfc: please report it with the chart.",
            )
    return found


def _refuse_what_was_not_read(subject: Subject) -> None:
    """Raise `LoweringError` where the reader kept connections of the chart without understanding them."""
    for finding in subject.project.diagnostics:
        owner = (finding.location.path or "").partition(" / ")[0]
        if finding.code == "SFC102" and owner.endswith(f" {subject.pou.name}"):
            raise LoweringError(
                f"the chart was not read completely: {finding.message}",
                location=finding.location,
                hint="Repair it in its tool and export it again.",
            )


def faults_of(subject: Subject, lowered: LoweredPou) -> tuple[Fault, ...]:
    """Return the faults of textbook code that was made of a chart; exact code has none."""
    subject, _ = without_emergency_stop(subject, lowered.profile)
    chart = subject.pou.chart
    if lowered.style is Style.EXACT or chart is None:
        return ()
    return find_faults(
        subject,
        resolve(lowered.project, subject.name),
        read_plain(subject.pou, chart, subject.project.dialect, lowered.profile),
        lowered.construction,
        lowered.rules,
        situation=lowered.situation,
        at_rest=lowered.at_rest,
        left_out=lowered.left_out,
    )


_ALIASES = {"fup": "flipflop"}
_NOUNS: dict[type[StrEnum], str] = {
    Construction: "construction",
    Style: "style",
    Language: "language for it",
    States: "kind of states",
    ActionPlace: "place for actions",
    OperatingMode: "operating mode",
}


def _chosen(kind: type[Choice], name: str) -> Choice:
    try:
        return kind(name)
    except ValueError:
        known = [each.value for each in kind]
        message = f"there is no {_NOUNS[kind]} {name!r}{nearest(name, known)}"
        raise LoweringError(message, hint="There are: " + ", ".join(known)) from None


def _with(
    subject: Subject, pou: Pou, blocks: Sequence[Pou], data_types: Sequence[DataTypeDeclaration]
) -> tuple[Project, Pou]:
    """Return a copy of the project with `pou` instead of the one of the same name, new blocks behind it, and new types.

    The code of an action's chart becomes the body of the action.
    """
    names = [each.name for each in subject.project.pous]
    place = names.index(subject.pou.name) if subject.pou.name in names else None
    is_whole = subject.name == subject.pou.name
    # the code is in the copy from the start: the chart would be copied for nothing
    copies = {id(subject.project.pous[place]): pou} if is_whole and place is not None else {}
    project = deepcopy(subject.project, copies)
    if place is not None:
        if not is_whole:
            own, body = project.pous[place], pou.body
            pou = pou.model_copy(update={"bodies": own.bodies})
            for each in pou.actions:
                each.body = body if f"{own.name}.{each.name}" == subject.name else each.body
            project.pous[place] = pou
        project.pous[place + 1 : place + 1] = blocks
    project.data_types += data_types
    return project, pou


class LoweringOptions(TypedDict, total=False):
    """Options of `lower` but for the construction, the target and the proof."""

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
class LoweredProject:
    """A project with code instead of charts: `project` has that of all `pous`; `refused` has an error for each other.

    Charts that were lowered together with one that calls them are in neither.
    """

    project: Project
    pous: tuple[LoweredPou, ...]
    refused: dict[str, LoweringError]


def lower_project(
    project: Project,
    construction: Construction | str = Construction.AUTO,
    *,
    pou: str | None = None,
    without: Collection[str] = (),
    target: str | None = None,
    **options: Unpack[LoweringOptions],
) -> LoweredProject:
    """Lower all charts of a project, or the one called `pou`, but for those `without`; nothing is proven yet.

    Raises `LoweringError` where there is no chart, or an option is wrong for all of them.
    """
    charts = {chart.name: chart for chart in project.charts()}
    names = [pou] if pou is not None else [*charts]
    if not names:
        raise LoweringError("there is no chart to be lowered")
    flags = options.get("flags", "local")
    options["modes"], options["at_rest"] = tuple(options.get("modes", ())), options.get("at_rest", ())
    left = set(names) - set(without)
    found: list[LoweredPou] = []
    refused: dict[str, LoweringError] = {}
    current, following = project, ""
    while left:
        name = pou or next_chart(chart for chart in current.charts() if chart.name in left)
        if name is None:  # all others were lowered with those that call them
            break
        left.remove(name)
        if len(names) > 1:
            options["flags"] = flags_of_several(flags, charts[name], following)
        try:
            lowered = lower(current, construction, pou=name, target=target, verify=False, **options)
        except LoweringError as error:
            if error.location.path is None:  # an option that concerns all charts
                raise
            refused[name] = error
            continue
        found.append(replace(lowered, chart=resolve(project, name)))
        current, following = lowered.project, lowered.following or following
    return LoweredProject(current, tuple(found), refused)


def next_chart(charts: Iterable[Chart]) -> str | None:
    """Return the name of the chart to lower first: of a POU, else of an action that no other chart uses.

    Lowering a chart lowers those of the actions that it calls too. Code that an action has already would be taken for a
    part of the chart itself.
    """
    charts = list(charts)
    used = {f"{chart.pou.name}.{name}".casefold() for chart in charts for name in _actions_of(chart)}
    bodies = [chart.name for chart in charts if chart.name == chart.pou.name]
    outer = [chart.name for chart in charts if chart.name.casefold() not in used]
    return next(iter([*bodies, *outer, *(chart.name for chart in charts)]), None)


def _actions_of(chart: Chart) -> Iterator[str]:
    """Yield the names of the actions that the steps of a chart use, but for its own."""
    for step in chart.chart.steps:
        used = [*(each.target for each in step.actions), step.entry_action, step.main_action, step.exit_action]
        yield from (name for name in used if isinstance(name, str) and f"{chart.pou.name}.{name}" != chart.name)
