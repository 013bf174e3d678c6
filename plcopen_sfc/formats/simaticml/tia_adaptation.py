"""Adaptation of a project of another tool before it is written: numbers, names, languages of texts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from plcopen_sfc.formats.simaticml.added_elements import system_members
from plcopen_sfc.formats.simaticml.coils_and_contacts import put_coils
from plcopen_sfc.formats.simaticml.declaration_spelling import version_of
from plcopen_sfc.formats.simaticml.network_boxes import mark_calls, put_operands, put_standard_blocks
from plcopen_sfc.formats.simaticml.network_operands import HINT
from plcopen_sfc.formats.simaticml.scl_tokens import CALL
from plcopen_sfc.formats.simaticml.sequence_rules import MOST_SEQUENCES, MOST_STEPS, MOST_TRANSITIONS
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.s7_globals import tag_tables_of
from plcopen_sfc.languages.s7_types import is_system_data, s7_types
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model import sfc
from plcopen_sfc.model.base import ExtensionData, Model
from plcopen_sfc.model.body import BodyBase, FbdBody, LdBody, StBody
from plcopen_sfc.model.conditions import WiredCondition
from plcopen_sfc.model.late import models_in
from plcopen_sfc.model.network import LogicNetwork
from plcopen_sfc.model.numbering import wires_in
from plcopen_sfc.model.pou import DataBlock, DataBlockKind, Pou
from plcopen_sfc.model.project import Project, Tag, TagTable
from plcopen_sfc.model.text import MultilingualText
from plcopen_sfc.model.types import DataTypeDeclaration, Variable
from plcopen_sfc.report import ConversionReport, Outcome

TAB = 4
_TEXTS = ("comment", "title", "alarm")
_WITH_TEXTS = (
    *(Pou, DataBlock, DataTypeDeclaration, TagTable, Tag, Variable, BodyBase, LogicNetwork),
    *(sfc.Sequence, sfc.Step, sfc.Transition, sfc.Supervised, sfc.PermanentOperation),
)


def adapt(project: Project, report: ConversionReport, *, foreign: bool) -> None:
    """Give steps and transitions the numbers and names that S7-GRAPH requires, and texts their language.

    `foreign`: the project comes from another tool or format.
    """
    # standard blocks come first: the others know flip-flops, coils and calls by the names and pins they get there
    put_standard_blocks(project)
    put_operands(project, report, of_charts=True)
    put_coils(project)
    mark_calls(project)
    _note_versions(project)
    language = project.language or "en-US"
    for pou in project.pous:
        _languages(pou, language)
    others: list[Model] = [*project.data_blocks, *project.data_types, *project.tag_tables]
    for thing in others:
        _languages(thing, language)
    _without_tabs(project, report)
    _mark_instances(project)
    _mark_constants(project)
    for chart in project.charts():
        _shift_logic(chart.chart)
        variables = {each.name.casefold() for each in chart.pou.variables() if not is_system_data(each)}
        if foreign:
            _report_names(chart.chart, chart.report_path, variables, report)
        _numbers(chart.chart, chart.report_path, variables, report, renames=foreign)


_APART = 1 << 20
"""Ids from which on no step, transition or action of a file gets one when it is read."""


def _shift_logic(chart: sfc.SfcNetwork) -> None:
    """Give logic beside the steps ids that do not collide with those of steps when the file is read."""
    old = {node.id for node in chart.logic}
    if not old or min(old) >= _APART:
        return
    for node in chart.logic:
        node.id += _APART
    symbols = chart.drawing.symbols if chart.drawing is not None else []
    wired = [t.condition for t in chart.transitions if isinstance(t.condition, WiredCondition)]
    for thing in (*chart.logic, *wired, *symbols):
        for wire in wires_in(thing):
            wire.source += _APART if wire.source in old else 0


def _without_tabs(project: Project, report: ConversionReport) -> None:
    """Blanks instead of tabs: tokens have no others between them."""
    for name, pou, body in project.bodies():
        if isinstance(body, StBody) and "\t" in body.text and body.markup is None:
            body.text = body.text.expandtabs(TAB)
            report.add(Outcome.TRANSLATED, "text", pou.report_path_of(name), "tabs are blanks")


def _mark_instances(project: Project) -> None:
    """Mark the calls in SCL that are those of instance data blocks: their names do not show it."""
    names = [block.name for block in project.data_blocks if block.kind is DataBlockKind.INSTANCE]
    for pou in project.pous:
        for body in pou.bodies:
            called = [name for name in names if isinstance(body, StBody) and f'"{name}"(' in body.text]
            if called:
                body.extension_data = body.extension_data or ExtensionData()
                body.extension_data.attributes |= {f'{CALL}"{name}"': "FB" for name in called}


def _mark_constants(project: Project) -> None:
    """Mark the names in texts and networks that are those of user constants."""
    names = user_constants(project)
    for pou in project.pous if names else ():
        for body in pou.bodies:
            if isinstance(body, StBody):
                mark_constants(body, body.text, names)
            elif isinstance(body, FbdBody | LdBody):
                for network in body.networks:
                    mark_constants(network, network_text(network), names)


def user_constants(project: Project) -> list[str]:
    """Return the names of the user constants that enumerations and constant global variables become."""
    tables = tag_tables_of(project)
    names = [each.name for each in s7_types(project).constants]
    return [*names, *(constant.name for table in tables for constant in table.constants)]


def mark_constants(thing: StBody | LogicNetwork, text: str, names: Iterable[str]) -> None:
    """Mark the operands in `text` of a program that are user constants."""
    found = {f'{HINT}"{name}"': "GlobalConstant" for name in names if f'"{name}"' in text}
    if found:
        thing.extension_data = thing.extension_data or ExtensionData()
        thing.extension_data.attributes |= found


def network_text(network: LogicNetwork) -> str:
    """Return the texts of a network, one after the other."""
    return str(network.model_dump(include={"nodes"}))


def _note_versions(project: Project) -> None:
    """Note the version of instances of timers, counters and edges."""
    interfaces = [pou.interface for pou in project.pous] + [block.interface for block in project.data_blocks]
    for variable in (v for interface in interfaces if interface is not None for v in interface.variables()):
        version = version_of(variable.type)
        if version is not None and "Version" not in variable.attributes:
            variable.attributes = {"Version": version} | variable.attributes


def _languages(thing: Model, language: str) -> None:
    """Give every text that people read its language."""
    for each in (each for each in models_in(thing) if isinstance(each, _WITH_TEXTS)):
        for name in _TEXTS:
            if isinstance(value := getattr(each, name, None), str):
                setattr(each, name, MultilingualText(texts={language: value}))


def _numbers(
    chart: sfc.SfcNetwork, place: str, variables: set[str], report: ConversionReport, *, renames: bool
) -> None:
    _number(chart.steps)
    _number(chart.transitions)
    used = {step.name.casefold() for step in chart.steps} | variables | system_members(variables)
    taken = used | {t.name.casefold() for t in chart.transitions}
    for transition in chart.transitions:
        if renames and transition.name and transition.name.casefold() in used:
            path = f"{place} / transition {transition.name}"
            transition.name = take_name(transition.name, taken)
            why = f"it is called {transition.name}: in TIA Portal another member of the block has its name"
            report.add(Outcome.TRANSLATED, "name", path, why)
        used.add(transition.name.casefold())
        if not transition.name:
            transition.name = take_name(f"Trans{transition.number}", taken)
            why = "it got a name, as S7-GRAPH requires"
            report.add(Outcome.TRANSLATED, "name", f"{place} / transition {transition.name}", why)
    if not chart.sequences and chart.steps:
        parts = sfc.connected_parts(chart.steps, chart.transitions)
        chart.sequences = [sfc.Sequence(steps=[step.id for step in part]) for part in parts]
    _limits(chart, place, report)
    competing = grouped((tuple(sorted(transition.sources)), transition) for transition in chart.transitions)
    for group in competing.values():
        if len(group) > 1:
            for rank, transition in enumerate(sfc.by_priority(group), 1):
                transition.priority = rank


def _report_names(chart: sfc.SfcNetwork, place: str, variables: set[str], report: ConversionReport) -> None:
    """Report steps with the name of a variable: all of these are members of the block."""
    called = variables | system_members(variables)
    for step in chart.steps:
        if step.name.casefold() in called:
            why = f"a variable of the block is called {step.name} too: TIA Portal does not compile it"
            report.add(Outcome.NOT_EXECUTED, "step", f"{place} / step {step.name}", why)


def _limits(chart: sfc.SfcNetwork, place: str, report: ConversionReport) -> None:
    """Report content beyond the limits of one block."""
    counts = (
        ("sequences", len(chart.sequences), MOST_SEQUENCES),
        ("steps", len(chart.steps), MOST_STEPS),
        ("transitions", len(chart.transitions), MOST_TRANSITIONS),
    )
    for what, count, most in counts:
        if count > most:
            why = f"an S7-GRAPH block has up to {most} {what}, this one {count}; TIA Portal may refuse it"
            report.add(Outcome.APPROXIMATED, "chart", place, why)


def _number(things: Iterable[Any]) -> None:
    """Number the elements without a number of their own."""
    taken: set[int] = set()
    for thing in things:
        if thing.number in taken:
            thing.number = None
        if thing.number is not None:
            taken.add(thing.number)
    following = 1
    for thing in things:
        if thing.number is None:
            while following in taken:
                following += 1
            thing.number = following
            taken.add(following)
