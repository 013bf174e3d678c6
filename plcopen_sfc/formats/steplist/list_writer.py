"""A project to the tables of a step list. `list_reader` reads them; what it does not read again is reported as lost."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count, zip_longest

from plcopen_sfc.formats.steplist.list_reader import COUNTED, KINDS, MEMORY, NOWHERE, SECTIONS
from plcopen_sfc.formats.steplist.list_tables import ListTable, TableKind, TableRow
from plcopen_sfc.languages.declarations import write_type, write_value
from plcopen_sfc.languages.networks.condition_reading import shown_condition
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project, TagTable
from plcopen_sfc.model.sfc import ActionAssociation, Condition, SfcNetwork, Step, Transition
from plcopen_sfc.model.text import plain
from plcopen_sfc.model.variables import VariableSection, sections_of
from plcopen_sfc.report import ConversionReport, Outcome

_KIND_WORDS = {kind: word for word, kind in KINDS.items()}
_SECTION_WORDS = {kind: word for word, kind in SECTIONS.items()}


_NO_PLACE = "a step list has no place for it; `plcopen-sfc merge` puts a list into the file that has it"


def tables_of(project: Project, report: ConversionReport) -> list[ListTable]:
    """Return the tables of a project; what a machine executes and no table holds is reported as not executed."""
    steps: list[TableRow] = []
    actions: list[TableRow] = []
    variables = [row for section in project.global_sections() for row in _section(section, section.name or "")]
    variables += [row for table in project.tag_tables for row in _tags(table)]
    for thing in project.objects():
        name = _KIND_WORDS.get(thing.kind) if isinstance(thing, Pou) else None
        if not isinstance(thing, Pou) or name is None or thing.chart is None:
            if not isinstance(thing, TagTable):  # whose tags are global variables here
                report.add(Outcome.NOT_EXECUTED, thing.kind_in_reports, thing.report_path, _NO_PLACE)
            continue
        report.add(Outcome.KEPT, "POU", thing.report_path)
        for step in thing.chart.steps:
            report.add(Outcome.KEPT, "step", f"{thing.report_path} / step {step.name}")
        _report_more(thing, thing.chart, report)
        called = thing.name if name == "PROGRAM" else f"{name} {thing.name}"
        steps += (TableRow({"Program": called, **row}) for row in _chart_rows(thing, thing.chart, report))
        for section in sections_of(thing.interface):
            variables += _section(section, called)
        for action in thing.actions:
            if isinstance(action.body, StBody):
                texts = {"Program": called, "Action": action.name, "Statements": action.body.text}
                actions.append(TableRow({**texts, "Comment": plain(action.comment)}))
            elif action.body is not None:
                path = f"{thing.report_path} / action {action.name}"
                report.add(Outcome.NOT_EXECUTED, "action", path, _NO_PLACE)
    return [
        ListTable(TableKind.STEPS, steps),
        ListTable(TableKind.ACTIONS, actions),
        ListTable(TableKind.VARIABLES, variables),
    ]


def _report_more(pou: Pou, chart: SfcNetwork, report: ConversionReport) -> None:
    """Report the parts of a program that are executed beside its steps, actions and transitions."""
    for what, parts in (
        ("method", pou.methods),
        ("body", pou.bodies[1:]),
        ("partial chart", chart.partial_charts),
        ("permanent instruction", chart.permanent),
    ):
        for part in parts:
            name = getattr(part, "name", "")
            report.add(
                Outcome.NOT_EXECUTED, what, f"{pou.report_path} / {name}" if name else pou.report_path, _NO_PLACE
            )
    for step in chart.steps:
        path = f"{pou.report_path} / step {step.name}"
        if step.macro is not None or step.encloses or step.exclude or step.negated:
            report.add(Outcome.NOT_EXECUTED, "step", path, _NO_PLACE)
        for word, condition in step.conditions.items():
            if not _expression(condition):
                report.add(Outcome.NOT_EXECUTED, word, path, "no expression has its meaning")
    for transition in chart.transitions:
        if transition.exclude or not transition.sources:
            path = f"{pou.report_path} / transition {chart.label(transition)}"
            report.add(Outcome.NOT_EXECUTED, "transition", path, _NO_PLACE)


def _chart_rows(pou: Pou, chart: SfcNetwork, report: ConversionReport) -> Iterator[dict[str, str]]:
    """Yield the rows of a chart: beside each step, below each other, its actions and the transitions that leave it."""
    names = {step.id: step.name for step in chart.steps}
    groups = {t.id: str(at) for at, t in enumerate((t for t in chart.transitions if len(t.sources) > 1), 1)}
    priorities = _priorities(chart)
    texts = {
        t.id: {**_transition(pou, chart, t, names, report), "Priority": priorities.get(t.id, "")}
        | {"Simultaneous": groups.get(t.id, "")}
        for t in chart.transitions
    }
    written: set[int] = set()
    for step in chart.steps:
        leaving: list[dict[str, str]] = []
        for transition in chart.transitions:
            if step.id in transition.sources:
                full = texts[transition.id]
                # the other steps that it waits for only name the group
                leaving.append(full if transition.id not in written else {"Simultaneous": full["Simultaneous"]})
                written.add(transition.id)
        head = _step(step)
        for action, transition_texts in zip_longest(_actions(step, pou, report), leaving or [{}]):
            yield {**head, **(action or {}), **(transition_texts or {})}
            head = {}


def _step(step: Step) -> dict[str, str]:
    return {
        "Step": step.name,
        "Number": "" if step.number is None else str(step.number),
        "Initial": "x" if step.initial else "",
        "Comment": plain(step.comment),
        "Min time": step.min_time or "",
        "Max time": step.max_time or "",
        "Warning time": step.warning_time or "",
        "Interlock": _expression(step.conditions.get("interlock")),
        "Supervision": _expression(step.conditions.get("supervision")),
    }


def _actions(step: Step, pou: Pou, report: ConversionReport) -> Iterator[dict[str, str]]:
    path = f"{pou.report_path} / step {step.name}"
    for word, action in step.step_actions.items():
        if isinstance(action, str | StBody):
            yield {"Qualifier": word, "Action": action.text if isinstance(action, StBody) else action}
        else:
            report.add(Outcome.NOT_EXECUTED, f"{word} action", path, _NO_PLACE)
    for association in step.actions:
        if not is_listed(association):
            named = f"{path} / action {association.target or 'in place'}"
            report.add(Outcome.NOT_EXECUTED, "action", named, _NO_PLACE)
            continue
        yield {
            "Qualifier": association.qualifier.value,
            "Action": _done(association),
            "Time": association.duration or "",
            "Event": association.event or "",
            "Interlocked": "x" if association.interlock else "",
        }


def is_listed(association: ActionAssociation) -> bool:
    """True if a step list has a row for an action."""
    other = (association.kind, association.condition, association.forcing)
    is_plain = all(each is None for each in other) and not association.negated and not association.exclude
    return is_plain and bool(_done(association))


def listed_transitions(chart: SfcNetwork) -> list[Transition]:
    """Return the transitions of a chart in the order of their rows: those that leave the first step, the second .."""
    leaving = [t for step in chart.steps for t in chart.transitions if step.id in t.sources]
    return [each for at, each in enumerate(leaving) if not any(each is other for other in leaving[:at])]


def _priorities(chart: SfcNetwork) -> dict[int, str]:
    """Return the priorities of transitions by their ids: of those that compete all have one, or none has.

    Those without come after all others, in their order, as they are tried.
    """
    competing = [[t.id for t in chart.transitions if step.id in t.sources] for step in chart.steps]
    found = {t.id: t.priority for t in chart.transitions if t.priority is not None}
    wanted = found.keys() | set()
    more = True
    while more:
        partly = [ids for ids in competing if not wanted.isdisjoint(ids) and not wanted.issuperset(ids)]
        wanted.update(*partly)
        more = bool(partly)
    last = count(max(found.values(), default=0) + 1)
    found |= {t.id: next(last) for t in chart.transitions if t.id in wanted - found.keys()}
    return {key: str(priority) for key, priority in found.items()}


def _done(association: ActionAssociation) -> str:
    """Return the text of an action; empty where it has none that is read as the same."""
    body = association.body
    if isinstance(body, StBody):
        text = body.text.rstrip()
        return text if text.endswith(";") and association.target is None and association.value is None else ""
    if body is not None or association.target is None:
        return ""
    return association.target + (f" := {association.value}" if association.value is not None else "")


def _transition(
    pou: Pou, chart: SfcNetwork, transition: Transition, names: dict[int, str], report: ConversionReport
) -> dict[str, str]:
    condition = _expression(transition.condition)
    if transition.condition is not None and not condition:
        shown = shown_condition(chart, transition, Dialect.IEC, pou.transitions)
        condition = shown[0] if shown is not None and not shown[1] else ""
        if not condition:
            path = f"{pou.report_path} / transition {chart.label(transition)}"
            report.add(Outcome.NOT_EXECUTED, "condition", path, "no expression has its meaning")
    return {
        "Transition": transition.name,
        "Condition": condition,
        "Next": ", ".join(names[each] for each in transition.targets if each in names) or NOWHERE,
        "Transition comment": plain(transition.comment),
    }


def _expression(condition: Condition | None) -> str:
    if not isinstance(condition, Expression):
        return ""
    return f"NOT ({condition.text})" if condition.negated else condition.text


def _section(section: VariableSection, program: str) -> Iterator[TableRow]:
    word = _SECTION_WORDS.get(section.kind)
    if word is None:  # access paths and results
        return
    memory = [name.upper() for name in MEMORY if getattr(section, name)]
    for variable in section.variables:
        yield TableRow(
            {
                "Program": program,
                "Variable": variable.name,
                "Section": " ".join([word, *memory]),
                "Type": write_type(variable.type),
                "Address": variable.address or "",
                "Initial value": write_value(variable.initial) if variable.initial is not None else "",
                "Comment": plain(variable.comment),
            }
        )


def _tags(table: TagTable) -> Iterator[TableRow]:
    for tag in table.tags:
        texts = {"Program": table.name, "Variable": tag.name, "Section": "VAR_GLOBAL", "Type": tag.type}
        address = tag.address or ""
        if COUNTED.match(address):  # in bytes: see `list_reader`
            address = address.removeprefix("%")
        yield TableRow({**texts, "Address": address, "Comment": plain(tag.comment)})
