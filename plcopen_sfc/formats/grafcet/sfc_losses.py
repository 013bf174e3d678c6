"""Behaviour of charts of IEC 61131-3: a GRAFCET has other terms for some of it, the rest is reported."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcopen_sfc.languages.binding import Names, names_in
from plcopen_sfc.languages.grafcet_conditions import has_parts_of_grafcet
from plcopen_sfc.languages.networks import is_empty_network
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, print_node, transform
from plcopen_sfc.languages.words import identifier
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.body import has_program
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.pou import DataBlockKind, Pou
from plcopen_sfc.model.project import Project, Tag, TagTable
from plcopen_sfc.model.sfc import ActionAssociation, SfcBody, SfcNetwork, Step
from plcopen_sfc.model.types import Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import SectionKind, sections_of
from plcopen_sfc.report import ConversionReport, Outcome


def report_unexpressed(project: Project, report: ConversionReport) -> None:
    """Report the behaviour of charts of IEC 61131-3 beside their actions, and the POUs that have no chart.

    These are times, supervisions, priorities, flags, exclusions, permanent instructions, macro-steps with a body, and
    declarations of types and parameters.
    Conditions get the brackets that tell what they compare.
    """
    flags = [flag.variable for flag in SfcFlag]
    for declared in project.data_types:
        report.add(Outcome.NOT_EXECUTED, "type", f"type {declared.name}", "a GRAFCET declares no types")
    for section in project.global_sections():
        place = f"global variables {section.name or ''}".rstrip()
        report.add(Outcome.NOT_EXECUTED, "global variables", place, _SHARED)
    for block in project.data_blocks:
        if block.kind is not DataBlockKind.INSTANCE:
            report.add(Outcome.NOT_EXECUTED, block.kind_in_reports, block.report_path, _SHARED)
    for table in project.tag_tables:
        _report_tags(project, table, report)
    named = [(each.text_site.site.pou, each.reference.name) for each in Names(project).occurrences(*flags)]
    for pou in project.pous:
        chart = pou.chart
        if chart is None:
            report.add(Outcome.NOT_EXECUTED, "POU", pou.report_path, "a GRAFCET is a chart, and executes no other POU")
            continue
        for section in sections_of(pou.interface):
            for variable in section.variables if section.kind not in _DECLARED else []:
                why = "a GRAFCET declares inputs, outputs and internal variables only"
                report.add(Outcome.NOT_EXECUTED, "variable", f"{pou.report_path} / {variable.name}", why)
            for variable in section.variables if section.retain and section.kind in _DECLARED else []:
                why = "variables of a GRAFCET do not keep their values over a power failure"
                report.add(Outcome.NOT_EXECUTED, "retain", f"{pou.report_path} / {variable.name}", why)
        for step in chart.steps:
            if step.macro is not None and step.macro.body is not None:
                why = "a GRAFCET gets no expansion for its steps: dissolve the macro-step"
                report.add(Outcome.NOT_EXECUTED, "macro-step", f"{pou.report_path} / step {step.name}", why)
        if has_parts_of_grafcet(chart):
            continue
        for transition in chart.transitions:
            if isinstance(transition.condition, Expression):
                transition.condition.text = _bracketed(transition.condition.text)
        lost = [*_of_steps(chart), *_of_transitions(chart)]
        for place, what, why in lost:
            report.add(Outcome.NOT_EXECUTED, what, f"{pou.report_path} / {place}", why)
        for flag in sorted({name for owner, name in named if owner is pou} | _declared(pou, flags)):
            why = "a GRAFCET has no flags that operate or watch it"
            report.add(Outcome.NOT_EXECUTED, "SFC flag", f"{pou.report_path} / {flag}", why)
        if any(has_program(each.body) for each in chart.permanent):
            why = "IEC 60848 has no instructions that are always executed"
            report.add(Outcome.NOT_EXECUTED, "permanent instruction", pou.report_path, why)
        for step in _competing(chart):
            why = "transitions of a GRAFCET have no order: two whose conditions are TRUE fire together (SEL01)"
            report.add(Outcome.APPROXIMATED, "selection", f"{pou.report_path} / step {step.name}", why)
        for body in pou.bodies:
            if not isinstance(body, SfcBody):
                report.add(Outcome.NOT_EXECUTED, "body", pou.report_path, "a GRAFCET has no program beside its charts")


def tags_of(project: Project, pou: Pou) -> dict[SectionKind, list[Variable]]:
    """Return the tags that a POU names, as variables that a GRAFCET can declare, by the kind of its tables."""
    tags = {identifier(tag.name).casefold(): tag for table in project.tag_tables for tag in table.tags}
    named = names_in(pou, project.dialect) - {each.name.casefold() for each in pou.variables()} if tags else set()
    found: dict[SectionKind, list[Variable]] = {}
    for tag in (tag for name, tag in tags.items() if name in named and _is_declarable(tag)):
        kind = _OF_AREAS.get((tag.address or "")[:2].upper(), SectionKind.LOCAL)
        type_ = ElementaryType(name=Elementary(tag.type.upper()))
        variable = Variable(name=identifier(tag.name), type=type_, address=tag.address, comment=tag.comment)
        found.setdefault(kind, []).append(variable)
    return dict(sorted(found.items(), key=lambda each: _DECLARED.index(each[0])))


_OF_AREAS = {
    "%I": SectionKind.INPUT,
    "%E": SectionKind.INPUT,
    "%Q": SectionKind.OUTPUT,
    "%A": SectionKind.OUTPUT,
}


def _is_declarable(tag: Tag) -> bool:
    return tag.type.upper() in list(Elementary)


def _report_tags(project: Project, table: TagTable, report: ConversionReport) -> None:
    named = {name for pou in project.pous for name in names_in(pou, project.dialect)}
    for constant in table.constants:
        why = "a GRAFCET declares no constants"
        report.add(Outcome.NOT_EXECUTED, "constant", f"{table.report_path} / {constant.name}", why)
    for tag in table.tags:
        if identifier(tag.name).casefold() in named and not _is_declarable(tag):
            why = f"a GRAFCET declares no variable of the type {tag.type}"
            report.add(Outcome.NOT_EXECUTED, "tag", f"{table.report_path} / {tag.name}", why)
    why = "the GRAFCET declares those that its chart names"
    report.add(Outcome.TRANSLATED, table.kind_in_reports, table.report_path, why)


_OF_SFC = {
    Qualifier.NONE: (ActionKind.CONTINUOUS, None),
    Qualifier.N: (ActionKind.CONTINUOUS, None),
    Qualifier.L: (ActionKind.LIMITED, None),
    Qualifier.D: (ActionKind.DELAYED, None),
    Qualifier.S: (ActionKind.ON_ACTIVATION, "TRUE"),
    Qualifier.R: (ActionKind.ON_ACTIVATION, "FALSE"),
    Qualifier.R0: (ActionKind.ON_ACTIVATION, "FALSE"),
    Qualifier.P: (ActionKind.ON_ACTIVATION, None),
    Qualifier.P1: (ActionKind.ON_ACTIVATION, None),
    Qualifier.P0: (ActionKind.ON_DEACTIVATION, None),
}
"""The actions of IEC 60848 that do what qualifiers do, and the value that they store."""


def action_of_sfc(
    action: ActionAssociation, path: str, report: ConversionReport, *, is_program: bool
) -> tuple[ActionKind, str | None] | None:
    """Return the kind of an action of IEC 60848 that does what a qualifier does, and its value; None where none does.

    `is_program`: statements are executed, no variable is written. The report tells what came of it.
    """
    kind, stored = _OF_SFC.get(action.qualifier, (None, None))
    is_same = kind is not None and action.event is None and not action.interlock and not action.negated
    if kind in (ActionKind.ON_ACTIVATION, ActionKind.ON_DEACTIVATION) and not action.value:
        # S executes a program until R ends it, a stored action executes it once; P gives a variable TRUE for
        # one scan, a stored action for good
        is_same = is_same and is_program is (stored is None)
    if kind is None or not is_same:
        shown = f"{action.qualifier}C" if action.interlock else action.qualifier
        why = f"IEC 60848 has no action that does the same as {shown}"
        report.add(Outcome.NOT_EXECUTED, "action", path, why)
        return None
    report.add(Outcome.TRANSLATED, "action", path, f"{action.qualifier} is {kind} in IEC 60848")
    return kind, action.value or stored


_SHARED = "a GRAFCET declares no variables of a project"
_DECLARED = (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.LOCAL)


def _bracketed(text: str) -> str:
    """Return a condition with brackets where NOT is of the first operand of a comparison, not of all of it."""
    parsed = parse_condition(text)
    if "NOT" not in text.upper() or parsed.problems:
        return text

    def changed(node: n.Node) -> n.Node:
        if isinstance(node, n.Operation) and node.operator in n.COMPARISONS and isinstance(node.operands[0], n.Unary):
            return replace(node, operands=(n.Parenthesized(node.operands[0]), *node.operands[1:]))
        return node

    tree = transform(parsed.tree, changed)
    return text if tree is parsed.tree else print_node(tree)


def _declared(pou: Pou, flags: list[str]) -> set[str]:
    return {variable.name for variable in pou.variables() if variable.name in flags}


def _of_steps(chart: SfcNetwork) -> Iterator[tuple[str, str, str]]:
    for step in chart.steps:
        place = f"step {step.name}"
        if step.min_time:
            why = f"IEC 60848 has none: write {step.min_time}/X{step.name} into the conditions that leave the step"
            yield place, "minimum time", why
        watched = step.conditions.get("supervision")
        if watched is not None and not is_empty_network(watched):
            yield place, "supervision", "no fault holds a step of a GRAFCET"
        if step.exclude or step.negated:
            yield place, "step", "it is excluded or negated, and a GRAFCET executes it as it is"
        for each in step.actions:
            if each.exclude:
                why = "it is excluded from the program, and a GRAFCET executes it"
                yield f"{place} / action {each.target or 'in place'}", "action", why


def _of_transitions(chart: SfcNetwork) -> Iterator[tuple[str, str, str]]:
    for transition in chart.transitions:
        if transition.exclude:
            why = "it is excluded from the program, and a GRAFCET executes it"
            yield f"transition {chart.label(transition)}", "transition", why


def _competing(chart: SfcNetwork) -> Iterator[Step]:
    """Yield the steps that several transitions leave."""
    for step in chart.steps:
        if len(chart.outgoing(step)) > 1:
            yield step
