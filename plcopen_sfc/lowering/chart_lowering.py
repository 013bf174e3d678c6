"""Lowering of one chart, or of all charts of a project, with the proof that the code does the same."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import asdict, dataclass, replace
from inspect import signature
from typing import Any, Unpack, cast

from plcopen_sfc.analysis.equivalence import Searching
from plcopen_sfc.analysis.verdict import Verdict, VerdictKind
from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.errors import Location, LoweringError, refuse_unknown_options
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering.code.lowered_code import flags_of_part, flags_of_several
from plcopen_sfc.lowering.construction import Constructed, construct, errors_of
from plcopen_sfc.lowering.faults.fault_kinds import Fault
from plcopen_sfc.lowering.faults.fault_search import find_faults
from plcopen_sfc.lowering.grafcet.grafcet_reading import read_plain, stop_condition, without_emergency_stop
from plcopen_sfc.lowering.lowering_losses import losses
from plcopen_sfc.lowering.lowering_options import (
    Construction,
    LoweringOptions,
    LoweringRules,
    OperatingMode,
    Style,
    checked,
    tool_of,
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
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.subjects import Subject, resolve


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
    def style(self) -> Style:
        """Style of the code."""
        return self.rules.style

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


class _LowerOptions(LoweringOptions, Searching, total=False):
    """Options of `lower`: those of the code, and those of the search."""


def lower(
    subject: SfcNetwork | Pou | Project,
    construction: Construction | str = Construction.AUTO,
    *,
    pou: str | None = None,
    target: str | None = None,
    flavour: str = "",
    verify: bool = True,
    accept_untested: bool = False,
    **options: Unpack[_LowerOptions],
) -> LoweredPou:
    """Make program code of a chart: flip-flops (``flipflop``, ``fup``), a ``case``, step ``bits``, or what fits best.

    `subject` and `pou` as in `simulate`. `target`: the format that the code is for; None: that of the project.
    `flavour`: the family of its readers, as in `save`. `verify`: compare the code with the chart under the profile, all
    inputs that were added being inactive. `accept_untested`: take code of which not all was reached when it was
    compared. `options` are those of `LoweringOptions`, such as ``style="classic"``, and of the search (`equivalent`).

    Nothing is changed in `subject`. Raises `LoweringError` for what the target cannot express, and where exact code is
    found to be different; `UntestedError` where it is equal, but steps or transitions were not reached that may be
    reachable; `ModelError` for an unknown name.
    """
    code = LoweringOptions.__annotations__.keys()
    refuse_unknown_options(
        "lower", options, {*signature(lower).parameters, *signature(prove).parameters, *_LowerOptions.__annotations__}
    )
    searching = cast(Searching, {name: value for name, value in options.items() if name not in code})
    own = cast(LoweringOptions, {name: value for name, value in options.items() if name in code})
    found = resolve(subject, pou)
    rules = checked(found.project, own, construction=construction, target=target, flavour=flavour)
    return _lowered(found, rules, ProofOptions(accept_untested, searching) if verify else None)


def _lowered(chart: Subject, rules: LoweringRules, options: ProofOptions | None) -> LoweredPou:
    """Return the code in a copy of the project, compared with `chart` where there are `options`."""
    _refuse_what_was_not_read(chart)
    _refuse_ambiguous_names(chart)
    with collecting_rarely(), errors_of(chart.project, chart.pou, chart.name):
        made, meant = _constructed(chart, rules)
        project, pou = _with(chart, made.pou, made.blocks, made.data_types)
        if made.flags is not None:
            made.flags.put_into(project)
            if tool_of(rules.target, project.dialect) is Tool.S7:  # comments of tags have one
                project.language = project.language or rules.texts.culture or None
        proof = None
        if options is not None:
            proof = prove_code(chart, Subject(project, made.pou, chart.name), made, **options.searching)
            if proof.kind is VerdictKind.DIFFERENT and not rules.is_classic:
                raise LoweringError(
                    f"the code does not do what the chart does: {proof}",
                    hint="This is an error of plcopen_sfc: please report it with the chart.",
                )
            refuse_untested(chart.name, proof, accepted=options.accept_untested)
        lost = losses(chart, [pou, *made.blocks], rules.profile, rules.texts.language)
    lowered = LoweredPou(
        **(vars(made) | {"pou": pou}),
        project=project,
        proof=proof,
        name=chart.name,
        losses=lost,
        chart=chart,
        proof_options=options,
    )
    return replace(lowered, faults=faults_of(meant, lowered)) if options is not None else lowered


def _constructed(chart: Subject, rules: LoweringRules) -> tuple[Constructed, Subject]:
    """Return the code of `chart` and of the charts that it brings along, and the chart as it is executed."""
    dialect, whole = chart.project.dialect, _chart_of(chart)
    if rules.stop is not None:
        rules = replace(rules, stop=stop_condition(rules.stop, chart, rules.profile))
    meant, pressed = as_executed(chart, rules.profile), ""
    if rules.is_classic:
        meant, pressed = without_emergency_stop(meant, rules.profile)
    if pressed:
        flags = flags_of_part(rules.flags, whole, _chart_of(meant))
        rules = replace(rules, stop=rules.stop or pressed, init=rules.init or "", flags=flags)
    made = construct(meant.pou, _chart_of(meant), dialect, rules, meant.project)
    made = with_actions(made, dialect, rules, chart.project)
    is_for_s7 = rules.target is not None and tool_of(rules.target, dialect) is Tool.S7
    if is_for_s7 or rules.flavour:  # S7 has no actions, and compilers of IEC 61131-3 have those of charts only
        pou = with_actions_inside(made.pou, dialect)
        pou = without_external_declarations(pou, meant.project) if is_for_s7 else pou
        pou = without_uncalled_actions(pou, meant.project) if chart.name == chart.pou.name else pou
        made = replace(made, pou=pou)
    if chart.name == chart.pou.name:
        made = replace(made, pou=without_unused_parts(meant.pou, made.pou, dialect))
    return replace(made, step_flags=_by_original_path(made.step_flags, whole)) if pressed else made, meant


def _by_original_path(flags: Mapping[str, str], chart: SfcNetwork) -> dict[str, str]:
    """Return the flags of a chart by the paths in `chart`, where it may be one of several partial charts."""
    paths = {step.path for step in Net.of(chart).steps}
    inside = {path.partition(".")[2]: path for path in paths}
    return {path if path in paths else inside[path]: flag for path, flag in flags.items()}


def _chart_of(subject: Subject) -> SfcNetwork:
    if subject.pou.chart is None:
        raise LoweringError("there is no chart to be lowered", location=Location(path=subject.name))
    return subject.pou.chart


def prove_code(chart: Subject, code: Subject, made: Constructed, **searching: Unpack[Searching]) -> Verdict:
    """Compare `code`, as it was `made` or read again, with `chart`."""
    return prove(
        chart,
        code,
        made.rules.profile,
        fixed=made.at_rest,
        left_out=made.left_out,
        step_flags=made.step_flags or None,
        **searching,
    )


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


def _refuse_ambiguous_names(subject: Subject) -> None:
    """Raise `LoweringError` where two POUs, or two actions or transitions of the POU, have one name.

    The code would be that of one of them, each reader takes another one.
    """
    pou = subject.pou
    alike = [each.name for each in subject.project.pous if each.name.casefold() == pou.name.casefold()]
    for owner, kind, names in (
        ("the project", "POU", alike),
        (pou.name, "action", [action.name for action in pou.actions]),
        (pou.name, "transition", [transition.name for transition in pou.transitions]),
    ):
        times = Counter(map(str.casefold, names))
        twice = next((name for name in names if times[name.casefold()] > 1), None)
        if twice is not None:
            path = pou.report_path if kind == "POU" else f"{pou.report_path} / {kind} {twice}"
            raise LoweringError(
                f"{owner} has {times[twice.casefold()]} {kind}s called {twice}: nothing tells which of them is meant",
                location=subject.project.locations_of([path])[0],
                hint="Rename or delete all but one.",
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
        read_plain(subject.pou, chart, subject.project, lowered.profile),
        lowered.rules,
        situation=lowered.situation,
        at_rest=lowered.at_rest,
        left_out=lowered.left_out,
    )


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
    flavour: str = "",
    **options: Unpack[LoweringOptions],
) -> LoweredProject:
    """Lower all charts of a project, or the one called `pou`, but for those `without`; nothing is proven yet.

    `target` and `flavour` as in `lower`.

    Raises `LoweringError` where there is no chart, or an option is wrong for all of them.
    """
    charts = {chart.name: chart for chart in project.charts()}
    names = [pou] if pou is not None else [*charts]
    if not names:
        raise LoweringError("there is no chart to be lowered")
    refuse_unknown_options("lower", options, LoweringOptions.__annotations__)
    rules = checked(project, options, construction=construction, target=target, flavour=flavour)
    left = set(names) - set(without)
    found: list[LoweredPou] = []
    refused: dict[str, LoweringError] = {}
    current, following = project, ""
    while left:
        name = pou or next_chart(chart for chart in current.charts() if chart.name in left)
        if name is None:  # all others were lowered with those that call them
            break
        left.remove(name)
        flags = flags_of_several(rules.flags, charts[name], following) if len(names) > 1 else rules.flags
        try:
            lowered = _lowered(resolve(current, name), replace(rules, flags=flags), None)
        except LoweringError as error:
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
        used = [*(each.target for each in step.actions), *step.step_actions.values()]
        yield from (name for name in used if isinstance(name, str) and f"{chart.pou.name}.{name}" != chart.name)
