"""Every rule, the catalogue of them for people, their selection, and their application to charts.

A comment ``plcopen-sfc: ignore STR09`` suppresses a finding that somebody has accepted.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache

from plcopen_sfc import plugins
from plcopen_sfc.analysis.checks import (
    action_rules,
    grafcet_rules,
    limit_rules,
    name_rules,
    race_rules,
    reachability_rules,
    structure_rules,
    transition_rules,
)
from plcopen_sfc.analysis.checks.checked_chart import (
    FAMILIES,
    CheckedChart,
    CheckedProject,
    Finding,
    FindingPlace,
    Rule,
    charts_of,
    code_of,
)
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location, ModelError, PluginError, listed_names, nearest
from plcopen_sfc.grouping import grouped
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.network import CommentBox
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcBody, SfcNetwork
from plcopen_sfc.model.text import MarkupText, MultilingualText, Text
from plcopen_sfc.plugins import provided_by_plugins
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.semantics.profile import profile as profile_named

_MARK = re.compile(r"\bplcopen-sfc:\s*ignore\b[ \t]*([^\r\n]*)", re.IGNORECASE)
_CODES = re.compile(r"[ \t]*([A-Za-z]{2,4}\d{0,2})\b[ \t]*,?")


def suppressed(place: FindingPlace, code: str) -> bool:
    """Return True if a comment at `place`, or at something around it, suppresses findings of this code."""
    return any(code.startswith(listed) for element in place.elements for listed in codes_in(element))


def marks_in(element: Element) -> bool:
    """Return True if a comment of an object wants to let something be."""
    return any(_MARK.search(text) for text in comments_of(element))


def codes_in(element: Element) -> Iterator[str]:
    """Yield the codes, or starts of codes, that the comments of an object list, in capitals."""
    for text in comments_of(element):
        for mark in _MARK.finditer(text):
            position = 0
            rest = mark[1]
            while (code := _CODES.match(rest, position)) is not None:
                yield code[1].upper()
                position = code.end()


def comments_of(element: Element) -> Iterator[str]:
    """Yield the comments of an object as plain text; of a chart also those in its drawing."""
    yield from _plain(element.comment)
    if isinstance(element, SfcNetwork):
        for node in element.logic:
            if isinstance(node, CommentBox):
                yield from _plain(node.content)


def _plain(text: Text | None) -> Iterator[str]:
    if isinstance(text, MultilingualText):
        yield from text.texts.values()
    elif isinstance(text, MarkupText):
        yield text.text
    elif text is not None:
        yield text


def _places(chart: CheckedChart) -> Iterator[FindingPlace]:
    for sheet in chart.sheets:
        yield sheet.place
        for step in sheet.steps:
            yield sheet.at(step)
        for transition in sheet.transitions:
            yield sheet.at(transition)
        for step, association in sheet.actions():
            yield sheet.at(step, association)


def rule_on(codes: Iterable[str]) -> Rule:
    """Return the rule that comments name codes, of these."""
    known = tuple(codes)

    def check(chart: CheckedChart) -> Iterator[Finding]:
        for place in _places(chart):
            element = place.elements[0]
            listed = list(codes_in(element))
            for code in listed:
                if not any(each.startswith(code) for each in known):
                    yield Finding(place, f"the comment suppresses {code}, and there is no such rule")
            if marks_in(element) and not listed:
                yield Finding(place, "the comment suppresses nothing: it names no rule")

    return Rule(
        code="CHK01",
        title="Comments that suppress findings name rules",
        why="A misspelt code suppresses nothing.",
        hint="Write plcopen-sfc: ignore and the codes behind it, with commas between.",
        example="the comment plcopen-sfc: ignore STR99",
        check=check,
        severity=Severity.WARNING,
    )


def selected(rules: Sequence[Rule], select: Iterable[str], ignore: Iterable[str]) -> list[Rule]:
    """Return the rules that begin with one of `select` (all, where nothing is selected) and with none of `ignore`.

    Raises `ModelError` for a code that no rule begins with.
    """
    wanted = known(rules, select)
    unwanted = known(rules, ignore)
    return [
        rule for rule in rules if (not wanted or rule.code.startswith(wanted)) and not rule.code.startswith(unwanted)
    ]


def known(rules: Sequence[Rule], codes: Iterable[str]) -> tuple[str, ...]:
    """Return the codes in capitals. Raises `ModelError` where no rule begins with one of them."""
    found = tuple(code.strip().upper() for code in listed_names(codes, "rules are named by texts"))
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
    externals: Iterable[str] = (),
) -> list[Diagnostic]:
    """Return the findings in the charts of a project, of a POU, or in one chart: see `plcopen_sfc.api.check`."""
    rules = selected(all_rules(), select, ignore)
    project = subject if isinstance(subject, Project) else _home(subject)
    execution = profile_named(profile) if profile is not None else default_profile(project)
    found: list[Diagnostic] = []
    for chart in _charts(subject, CheckedProject(project, externals), execution):
        found += findings(chart, rules)
    return found


def findings(chart: CheckedChart, rules: Iterable[Rule]) -> Iterator[Diagnostic]:
    """Return the findings in one chart, without those excluded from the program or allowed by comments."""
    for rule in rules:
        severity = rule.severity_for(chart.family)
        if severity is None or (chart.is_code and not rule.on_code):
            continue
        hint = rule.hint_for(chart.family)
        for finding in rule.check(chart):
            if not finding.place.excluded and not suppressed(finding.place, rule.code):
                location = Location(path=finding.place.path or None)
                yield Diagnostic(rule.code, severity, finding.message, location, finding.hint or hint)


def _charts(subject: Project | Pou | SfcNetwork, around: CheckedProject, profile: Profile) -> Iterator[CheckedChart]:
    if isinstance(subject, SfcNetwork):
        everywhere = (chart for pou in around.project.pous if pou.name for chart in charts_of(around, pou, profile))
        alone = CheckedChart(around, None, FindingPlace("", (subject,)), subject, profile)
        yield next((chart for chart in everywhere if chart.chart is subject), alone)
        return
    for pou in [subject] if isinstance(subject, Pou) else around.project.pous:
        charts = charts_of(around, pou, profile)
        yield next(charts, None) or code_of(around, pou, profile)
        yield from charts


def _home(subject: Pou | SfcNetwork) -> Project:
    """Return the project that a POU or chart is in; an empty one where it is in none."""
    if subject.project is not None:
        return subject.project
    if isinstance(subject, SfcNetwork):
        subject = Pou(name="", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=subject)])
    return Project(pous=[subject])


_GROUPS = {
    "STR": "Structure",
    "NAM": "Names and numbers",
    "SEL": "Selections",
    "CND": "Conditions",
    "ACT": "Actions",
    "VAR": "Names in program text",
    "EVO": "Evolution",
    "TIM": "Times",
    "HIE": "Hierarchy",
    "LIM": "Limits of tools",
    "LOW": "Lowering",
    "CHK": "The check itself",
}
_MODULES = (
    structure_rules,
    reachability_rules,
    transition_rules,
    action_rules,
    race_rules,
    grafcet_rules,
    name_rules,
    limit_rules,
)


def _on_charts() -> list[Rule]:
    """Return the rules of the modules of this package, by group and number."""
    found = (each for module in _MODULES for each in vars(module).values() if isinstance(each, Rule))
    return sorted(found, key=lambda rule: ([*_GROUPS].index(rule.code[:3]), rule.code))


@cache
def all_rules() -> tuple[Rule, ...]:
    """Return every rule: those of this package by group and number, those of plugins, that on comments.

    Raises `PluginError`.
    """
    rules = _on_charts()
    for rule in provided_by_plugins(plugins.CHECKS, Rule):
        if not _CODE.fullmatch(rule.code) or any(rule.code == other.code for other in rules):
            raise PluginError(
                f"a plugin has a rule {rule.code!r}", hint="A code has letters and two digits, and is new."
            )
        rules.append(rule)
    return (*rules, rule_on([*(rule.code for rule in rules), "CHK01"]))


_CODE = re.compile(r"[A-Z]{2,4}\d\d")


_HEAD = """# Checks

The numbered rules on charts: `plcopen-sfc check` on the [command line](cli.md#check), `sfc.check` in Python. This page
is made from the rules (`plcopen-sfc rules --markdown > docs/checks.md`).

How severe a breach is depends on how the chart is executed: on the profile. Where a rule gives several severities,
those are for the profiles that they name; a dash means that the rule is not for them. Findings of elements that are
excluded from the program are left out, and so are those that a comment suppresses: `plcopen-sfc: ignore STR09` in the
comment of a step, a transition, a chart or a POU. Reachability is that of the chart with all conditions free: what is
found impossible is impossible, whatever the inputs do. Rules on
names look at the code of POUs without charts too: {on_code}.

"""


def in_profiles(rule: Rule) -> str:
    """Return the severity of a breach, profile by profile where they differ."""
    groups = grouped((_shown(rule.severity_for(name)), name) for name in FAMILIES)
    if len(groups) == 1:
        return next(iter(groups))
    usual = _shown(rule.severity)
    return ", ".join(
        [usual, *(f"{severity} ({', '.join(names)})" for severity, names in groups.items() if severity != usual)]
    )


def _shown(severity: Severity | None) -> str:
    return severity.value if severity is not None else "-"


def catalogue(rules: Iterable[Rule]) -> str:
    """Return the page in Markdown."""
    rules = list(rules)
    on_code = ", ".join(rule.code for rule in rules if rule.on_code)
    lines = [_HEAD.format(on_code=on_code).rstrip("\n"), "", "| rule | what | severity |", "|---|---|---|"]
    lines += [f"| [{r.code}](#{r.code.lower()}) | {r.title} | {in_profiles(r)} |" for r in rules]
    group = ""
    for rule in rules:
        if rule.code[:3] != group:
            group = rule.code[:3]
            lines += ["", f"## {_GROUPS.get(group, group)}"]
        lines += ["", f"### {rule.code}", "", f"**{rule.title}.** {rule.why}", ""]
        lines += [f"Severity: {in_profiles(rule)}. {rule.hints}", ""]
        lines += _example(rule.example)
    return "\n".join(lines) + "\n"


def _example(example: str) -> list[str]:
    if "\n" not in example:
        return [f"Example: {example}."]
    language = "text" if example.lstrip().startswith("GRAFCET ") else "iecst"
    return [f"```{language}", *example.strip().splitlines(), "```"]
