"""Selection of rules, and their application to charts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, CheckedProject, FindingPlace, charts_of
from plcopen_sfc.analysis.checks.rule import Rule
from plcopen_sfc.analysis.checks.rule_table import RULES
from plcopen_sfc.analysis.checks.suppression import suppressed
from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.errors import Location, ModelError, nearest
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.semantics.profile import profile as profile_named


def selected(rules: Sequence[Rule], select: Iterable[str], ignore: Iterable[str]) -> list[Rule]:
    """The rules that begin with one of `select` (all, where nothing is selected) and with none of `ignore`.

    Raises `ModelError` for a code that no rule begins with.
    """
    wanted = known(rules, select)
    unwanted = known(rules, ignore)
    return [
        rule for rule in rules if (not wanted or rule.code.startswith(wanted)) and not rule.code.startswith(unwanted)
    ]


def known(rules: Sequence[Rule], codes: Iterable[str]) -> tuple[str, ...]:
    """The codes in capitals. Raises `ModelError` where no rule begins with one of them."""
    found = tuple(code.strip().upper() for code in ([codes] if isinstance(codes, str) else codes))
    for code in found:
        if not code or not any(rule.code.startswith(code) for rule in rules):
            groups = sorted({rule.code[:3] for rule in rules})
            near = nearest(code, [rule.code for rule in rules])
            raise ModelError(
                f"there is no rule {code!r}{near}", hint=f"Rules begin with {', '.join(groups)}; see docs/checks.md."
            )
    return found


def check_charts(
    subject: Project | Pou | SfcNetwork,
    *,
    profile: str | Profile | None = None,
    select: Iterable[str] = (),
    ignore: Iterable[str] = (),
) -> list[Diagnostic]:
    """What is wrong with the charts of a project, of a POU, or with one chart: see `plcopen_sfc.api.check`."""
    rules = selected(RULES, select, ignore)
    project = subject if isinstance(subject, Project) else _home(subject)
    execution = profile_named(profile) if profile is not None else default_profile(project)
    found: list[Diagnostic] = []
    for chart in _charts(subject, CheckedProject(project), execution):
        found += findings(chart, rules)
    return found


def findings(chart: CheckedChart, rules: Iterable[Rule]) -> Iterator[Diagnostic]:
    """What the rules find in one chart, but for what is excluded from the program or what comments let be."""
    for rule in rules:
        severity = rule.severity_for(chart.family)
        if severity is None:
            continue
        for finding in rule.check(chart):
            if not finding.place.excluded and not suppressed(finding.place, rule.code):
                location = Location(path=finding.place.path or None)
                yield Diagnostic(rule.code, severity, finding.message, location, finding.hint or rule.hint)


def _charts(subject: Project | Pou | SfcNetwork, around: CheckedProject, profile: Profile) -> Iterator[CheckedChart]:
    if isinstance(subject, SfcNetwork):
        everywhere = (chart for pou in around.project.pous if pou.name for chart in charts_of(around, pou, profile))
        alone = CheckedChart(around, None, FindingPlace("", (subject,)), subject, profile)
        yield next((chart for chart in everywhere if chart.chart is subject), alone)
        return
    for pou in [subject] if isinstance(subject, Pou) else around.project.pous:
        yield from charts_of(around, pou, profile)


def _home(subject: Pou | SfcNetwork) -> Project:
    """The project that a POU or chart is in; an empty one where it is in none."""
    if subject.project is not None:
        return subject.project
    if isinstance(subject, SfcNetwork):
        subject = Pou(name="", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=subject)])
    return Project(pous=[subject])
