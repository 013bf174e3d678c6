"""Differences in the execution of texts and declarations that are written for a tool as they are."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from plcopen_sfc.formats.format_interface import Format, WriteOptions
from plcopen_sfc.formats.matiec.matiec_library import note_functions
from plcopen_sfc.formats.matiec.matiec_statements import note_loops
from plcopen_sfc.formats.registry import TIA_FORMAT
from plcopen_sfc.languages.binding import bind, told_step_actions
from plcopen_sfc.languages.binding.name_resolution import Resolver
from plcopen_sfc.languages.binding.text_sites import Site
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.networks.exported_networks import EXPORTS, KNOWN_SECTIONS
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, walk
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.types import Elementary, ElementaryType, used_types
from plcopen_sfc.report import ARITHMETIC, COUNTER, FALLING_EDGE, ORDER_OF_ACTIONS, ConversionReport, Outcome
from plcopen_sfc.semantics.profile import (
    PROFILES,
    ActionOrder,
    OverlappingAddresses,
    Profile,
    default_profile,
    profile_as,
    profile_of_format,
)

_SECTION = re.compile(r"(?:\s|\(\*.*?\*\))*(?P<word>\w+)", re.DOTALL)

_FALLING = re.compile("F_TRIG", re.IGNORECASE)
_COUNTS_DOWN = re.compile("CTU?D(_INT)?", re.IGNORECASE)
_COUNTS_UP = re.compile(r"CTUD?(_\w+)?", re.IGNORECASE)
_COUNTERS = re.compile(r"CT(U|D|UD)(_\w+)?", re.IGNORECASE)
_COUNTS_UNSIGNED = re.compile("CTU?D_UINT", re.IGNORECASE)

_SWITCHING = frozenset(Qualifier) - {Qualifier(name) for name in "CALL ON OFF CS CU CD CR TL TD TR TF".split()}
"""Qualifiers of actions that are Boolean variables."""


def note_differences(
    project: Project, kind: Format, options: WriteOptions, dialect: Dialect | None, report: ConversionReport
) -> None:
    """Report what the target executes otherwise, or not at all, in texts and declarations that it gets as they are."""
    if default_profile(project).for_asks_ahead and not options.flavour and not kind.name.startswith("plcopen"):
        note_loops(project, report, kind.tool)  # a TC6 file is one of Beremiz by its header still
        if kind.dialect is None:  # others get what counts seconds in them, too
            note_functions(project, report, kind.tool, with_texts=True)
    _note_wider_arithmetic(project, kind, dialect, options, report)
    _note_operands(project, kind, options, report)
    _note_sections(project, kind, report)
    _note_bodies(project, kind, options, report)
    for pou in project.pous:
        for word, thing, first in pou.declared_twice():
            why = f"a second {word} `{first}` does not compile in {kind.tool}, and no text tells which it means"
            report.add(Outcome.NOT_EXECUTED, word, f"{pou.report_path} / {word} {thing.name}", why)
    _note_initial_steps(project, kind, options, report)
    if project.tool_format == EXPORTS != kind.name and dialect is not Dialect.SCL:
        _note_bits_of_words(project, kind, report)
    flavour = PROFILES[options.flavour] if options.flavour else None
    as_it_is = flavour or profile_as(project, kind.name)
    _note_overlapping_words(project, as_it_is, options.flavour or kind.tool, report)
    _note_falling_edges(project, kind, dialect, report)
    target = as_it_is if dialect is None else flavour or profile_of_format(kind.name)
    if default_profile(project).matiec_library is target.matiec_library:
        _note_counters(project, kind, dialect, report)
    else:
        _note_ends_of_counters(project, target, options.flavour or kind.tool, report)
    if default_profile(project).flags and (kind.charts is None or not kind.charts.is_codesys):
        _note_step_actions(project, target, report)


def _note_bodies(project: Project, kind: Format, options: WriteOptions, report: ConversionReport) -> None:
    """Report all bodies of a POU but the first, where a POU has one: several are those of worksheets of TC6.

    In TIA Portal networks and text of several bodies are networks of one block, but not beside a sequencer.
    """
    if options.flavour or (kind.name.startswith("plcopen") and options.version != "1.01"):
        return
    for pou in project.pous:
        if len(pou.bodies) > 1 and (kind.name != TIA_FORMAT or pou.chart is not None):
            languages = ", ".join(body.language for body in pou.bodies[1:])
            why = f"a POU has one body in {kind.tool}: what is in the others ({languages}) is NOT executed"
            report.add(Outcome.NOT_EXECUTED, "body", pou.report_path, why)


def _note_initial_steps(project: Project, kind: Format, options: WriteOptions, report: ConversionReport) -> None:
    """Report charts without an initial step; partial charts of GRAFCETs, which others force, are no such.

    Those of S7-GRAPH begin with their first step, which has the mark of an initial step where a chart is rewritten.
    """
    profile = default_profile(project)
    is_marked = profile.graph_parameters and kind.charts is not None
    if options.flavour or profile.grafcet_terms or is_marked:
        return
    for place in project.charts():
        if place.chart.steps and not place.chart.partial_charts and not place.chart.initial_steps:
            why = f"it has no initial step, and IEC 61131-3 demands one: it is not known how it runs in {kind.tool}"
            report.add(Outcome.APPROXIMATED, "chart", place.report_path, why)


def _note_step_actions(project: Project, target: Profile, report: ConversionReport) -> None:
    """Report associations that CODESYS executes after the entry, main and exit actions of steps, and others before."""
    for place in project.charts():
        by_name = _order_of_names(target.action_order, place)
        exits_first = target.graph_parameters
        if told := told_step_actions(place.chart, place.pou, project.dialect, by_name, exits_first=exits_first):
            report.add(Outcome.APPROXIMATED, ORDER_OF_ACTIONS, place.report_path, told)


def _order_of_names(order: ActionOrder, place: Chart) -> Callable[[str], tuple[int, str]] | None:
    """Return the place of an action by its name, in a tool in which names tell it."""
    if order is ActionOrder.ALPHABETIC:
        return lambda name: (0, name.casefold())
    if order is ActionOrder.DECLARED:
        declared = {action.name.casefold(): number for number, action in enumerate(place.pou.actions)}
        return lambda name: (declared.get(name.casefold(), -1), "")
    return None


def _note_operands(project: Project, kind: Format, options: WriteOptions, report: ConversionReport) -> None:
    """Report actions on variables that are not Boolean: no tool compiles them, and some write another type."""
    if options.flavour:  # what fits a project to that tells so
        return
    resolver = Resolver(project, project.dialect)
    for chart in project.charts():
        names = {association.target for _, association in chart.chart.associations()} - {None}
        types = {name: _elementary_type(resolver, chart, name) for name in names if name is not None}
        for step, row in chart.chart.associations():
            type_ = types.get(row.target or "")
            switches = row.value is None and row.body is None and row.kind is None and row.qualifier in _SWITCHING
            if switches and type_ is not None and type_ is not Elementary.BOOL:
                why = f"`{row.target}` is of the type {type_.value}, and an action is a Boolean variable in {kind.tool}"
                path = f"{chart.report_path} / step {step.name} / action {row.target}"
                report.add(Outcome.NOT_EXECUTED, "action", path, why)


def has_task_configuration(project: Project) -> bool:
    """True if an export of CoDeSys 2.3 says which programs its controller executes; without that it is PLC_PRG."""
    sections = (text for name, text in kept(project.extension_data).items() if name.startswith("section"))
    return any(_holds_tasks(_word_of(text), text) for text in sections)


def _holds_tasks(word: str, text: str) -> bool:
    return "TASK" in word or (word == "RESOURCE" and "TASK" in text.upper())


def _word_of(section: str) -> str:
    found = _SECTION.match(section)
    return found["word"].upper() if found is not None else ""


def _is_comment(section: str) -> bool:
    return section.startswith("(*") and section.endswith("*)")


def _note_sections(project: Project, kind: Format, report: ConversionReport) -> None:
    """Report sections of an export of CoDeSys 2.3 that are kept as text, but for libraries, whose blocks have names."""
    for name, text in kept(project.extension_data).items():
        word = _word_of(text)
        if kind.name == EXPORTS or not name.startswith("section") or word == "LIBRARY":
            continue
        if word == "VAR_CONFIG" or _holds_tasks(word, text):
            outcome, why = Outcome.NOT_EXECUTED, f"it is kept as text: what it says has to be made in {kind.tool}"
        elif word in KNOWN_SECTIONS or word.startswith("_") or _is_comment(text):
            outcome = Outcome.EXTENSION_DATA if kind.extension_data else Outcome.DROPPED
            why = "it is of CoDeSys 2.3 alone, and no program" if word else "a comment between objects"
        else:
            outcome, why = Outcome.APPROXIMATED, "a section that is not known: the controller may execute what it says"
        report.add(outcome, "section", f"section {word}".rstrip(), why)


def _note_bits_of_words(project: Project, kind: Format, report: ConversionReport) -> None:
    """Report addresses of bits that a controller of CoDeSys 2.3 counts in words: they are other terminals elsewhere."""
    from plcopen_sfc.refactor.direct_addresses import bits_of_words  # noqa: PLC0415  # of CoDeSys 2.3 alone

    for path, text in bits_of_words(project):
        why = f"the controller counts the bits of `{text}` in words, {kind.tool} in bytes: give it that of its byte"
        report.add(Outcome.NOT_EXECUTED, "address", path, why)


def note_final_scans(project: Project, report: ConversionReport) -> None:
    """Report programs that are executed once more after their step was left: a GRAFCET has no such final scan."""
    for place in project.charts() if default_profile(project).final_scan else ():
        programs = {action.name.casefold() for action in place.pou.actions}
        for step, row in place.chart.associations():
            is_program = row.body is not None or (row.target or "").casefold() in programs
            if is_program and row.kind is None and row.qualifier in _WITH_FINAL_SCAN:
                why = "the source executes it once more after its step was left (final scan), a GRAFCET does not"
                path = f"{place.report_path} / step {step.name} / action {row.target or 'in place'}"
                report.add(Outcome.APPROXIMATED, "final scan", path, why)


_WITH_FINAL_SCAN = frozenset({Qualifier.NONE, Qualifier.N, Qualifier.L, Qualifier.D, Qualifier.P})


def _note_overlapping_words(project: Project, target: Profile, tool: str, report: ConversionReport) -> None:
    """Report words whose bits or bytes have addresses of their own, where the target takes others of them for these."""
    from plcopen_sfc.refactor.direct_addresses import overlapping_words  # noqa: PLC0415  # few projects have them

    here, there = default_profile(project).overlapping_addresses, target.overlapping_addresses
    if here is there:
        return
    apart = OverlappingAddresses.APART
    for path, text, parts, memory in overlapping_words(project):
        shown = ", ".join(f"`{part}`" for part in parts[:_SHOWN]) + (", .." if len(parts) > _SHOWN else "")
        if there is apart:
            why = f"{tool} keeps `{text}` apart from {shown}, with which it shares its memory in the source"
        elif here is apart:
            why = f"`{text}` shares its memory with {shown} in {tool}, and the source keeps them apart"
        elif memory.width > _BYTE:
            order = "low byte of a word first, the source the high one"
            if there is OverlappingAddresses.HIGH_BYTE_FIRST:
                order = "high byte of a word first, the source the low one"
            why = f"{shown} in `{text}` is another part of it: {tool} has the {order}"
        else:
            continue
        report.add(Outcome.APPROXIMATED, "address", path, why)


_SHOWN = 5
_BYTE = 8  # bits


def _note_falling_edges(project: Project, kind: Format, dialect: Dialect | None, report: ConversionReport) -> None:
    """Report blocks and lists with F_TRIG where only one of two tools sees an edge in its first call with FALSE.

    IEC 61131-3 ed. 3, table 44: it is one. TIA Portal help: F_TRIG compares with the last call, at first FALSE.
    """
    if dialect is None or (dialect is Dialect.SCL) is (project.dialect is Dialect.SCL):
        return
    sides = ("in the source", f"in {kind.tool}")
    here, there = sides if dialect is Dialect.SCL else sides[::-1]
    for path, name in _instances(project, _FALLING):
        why = f"the first call of {name} with FALSE is a falling edge {here} and none {there}"
        report.add(Outcome.APPROXIMATED, FALLING_EDGE, path, why)


def _note_counters(project: Project, kind: Format, dialect: Dialect | None, report: ConversionReport) -> None:
    """Report counters that count below zero in one of two tools: those of CODESYS are a WORD.

    From CODESYS to S7 they stay unsigned: `CTD_UINT`, which are not so in other tools.
    """
    here, there = (family(each) is Dialect.CODESYS for each in (project.dialect, dialect or Dialect.IEC))
    of_s7 = project.dialect is Dialect.SCL
    if dialect is Dialect.SCL or (here is there and not of_s7):
        return
    is_unsigned = here or (of_s7 and not there)
    tools = ("the source", kind.tool) if is_unsigned else (kind.tool, "the source")
    for path, name in _instances(project, _COUNTS_UNSIGNED if of_s7 and is_unsigned else _COUNTS_DOWN):
        why = f"{name} stops at 0 in {tools[0]}, and counts below it in {tools[1]}"
        report.add(Outcome.APPROXIMATED, COUNTER, path, why)


def _note_ends_of_counters(project: Project, target: Profile, tool: str, report: ConversionReport) -> None:
    """Report counters between matiec, where they end at PV and at 0, and others; those of CODESYS end at 0, too.

    Their outputs Q are the same as long as PV is.
    """
    if not any(_counts_matter(pou, project.dialect) for pou in project.pous):
        return
    tools = (tool, "the source") if target.matiec_library else ("the source", tool)
    is_codesys = family(project.dialect) is Dialect.CODESYS or bool(target.flags)
    for path, name in _instances(project, _COUNTS_UP if is_codesys else _COUNTERS):
        why = f"{name} counts to PV and to 0 at most in {tools[0]}, and on in {tools[1]}"
        report.add(Outcome.APPROXIMATED, COUNTER, path, why)


def _counts_matter(pou: Pou, dialect: Dialect) -> bool:
    """True if a POU may read the count of a counter, or have a preset that is no number."""
    for _, _, body in pou.named_bodies():
        bound = bind(body, dialect)
        if bound.unknown:
            return True
        for node in (each for tree in bound.trees for each in walk(tree)):
            if isinstance(node, n.Member) and node.name.identifier.upper() in ("CV", "PV"):
                return True
            if isinstance(node, n.CallStatement) and isinstance(node.call, n.Call):
                for argument in node.call.arguments:  # those without a name may be a preset
                    name = argument.name.identifier.upper() if argument.name is not None else "PV"
                    if name == "CV" or (name == "PV" and not isinstance(argument.value, n.Literal)):
                        return True
    return False


def _instances(project: Project, blocks: re.Pattern[str]) -> Iterator[tuple[str, str]]:
    """Yield the first instance of some standard blocks in each POU and list, unless the project has blocks so named."""
    own = {pou.name.casefold() for pou in project.pous}
    declared = [(pou.report_path, pou.variables()) for pou in project.pous]
    # CODESYS needs no VAR_EXTERNAL: a block that calls a global instance may not declare it
    for section in project.global_sections():
        declared.append((f"list of global variables {section.name or ''}".strip(), section.variables))
    for path, variables in declared:
        types = ((v.name, name) for v in variables for name in used_types(v.type) if blocks.fullmatch(name))
        found = next((name for name, type_ in types if type_.casefold() not in own), None)
        if found is not None:
            yield path, found


def _elementary_type(resolver: Resolver, chart: Chart, name: str) -> Elementary | None:
    """Return the type of the variable that an action writes; None for all else."""
    if chart.pou.find_action(name) is not None:
        return None
    found = resolver.type_of(parse_expression(name, resolver.dialect).tree, Site(pou=chart.pou, charts=(chart.chart,)))
    return found.name if isinstance(found, ElementaryType) else None


def _note_wider_arithmetic(
    project: Project, kind: Format, dialect: Dialect | None, options: WriteOptions, report: ConversionReport
) -> None:
    """Report the operations that stay as they are where CODESYS calculates in 32 bits, and other tools in the types.

    `dialect`: that of the file; None where it has the texts as they are. matiec calculates as CODESYS does.
    """
    sides = family(project.dialect), Dialect.CODESYS if options.flavour else family(dialect or Dialect.IEC)
    if default_profile(project).matiec_library and sides[1] is Dialect.CODESYS:
        return
    why = {
        (Dialect.CODESYS, Dialect.IEC): "CODESYS calculates with 32 bits where {tool} may do it in the types of the"
        " operands",
        (Dialect.IEC, Dialect.CODESYS): "{tool} calculates with 32 bits where the source does it in the types of the"
        " operands: a result that does not fit is not cut off",
    }.get(sides)
    if why is None:
        return
    from plcopen_sfc.refactor.dialect_translation import (  # noqa: PLC0415  # rarely needed
        boxes_that_calculate_otherwise,
        texts_that_calculate_otherwise,
    )

    is_translated = dialect is not None and sides[0] is Dialect.CODESYS
    texts = () if is_translated else texts_that_calculate_otherwise(project, sides[1])
    for path, other in (*texts, *boxes_that_calculate_otherwise(project, sides[1])):
        if other and options.flavour:
            continue  # of the times of CODESYS
        report.add(Outcome.APPROXIMATED, ARITHMETIC, path, other or why.format(tool=options.flavour or kind.tool))
