"""Projects of other tools in terms that the target tool executes, before they are drawn and written.

What the tool has no element for becomes statements and conditions that do the same (`step_rewriting`), or is left out
and reported as not executed. The source is kept beside what was written (`source_marks`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from plcopen_sfc.conversion.adaptation.boxes_before_conditions import execute_boxes, has_boxes
from plcopen_sfc.conversion.adaptation.chart_rewriting import flags_in_use
from plcopen_sfc.conversion.adaptation.chart_rules import CHART_RULES, needs_rewriting, report_orders, rewrite_charts
from plcopen_sfc.conversion.adaptation.flags_in_graph import execute_flags_in_graph, has_flags
from plcopen_sfc.conversion.adaptation.global_variables import (
    add_globals,
    declare_lists,
    has_globals,
    has_lists,
    report_types,
)
from plcopen_sfc.conversion.adaptation.main_programs import call_from_main, executes_without_tasks
from plcopen_sfc.conversion.adaptation.s5_operands import (
    declare_operands,
    declare_times,
    interfaces_with_operands,
    variables_with_times,
)
from plcopen_sfc.formats.format_interface import ChartHost, Format, Marks, WriteOptions, may_have
from plcopen_sfc.formats.plcopen.source_marks import (
    NO_RESULT_FIELD,
    RETAINED_FIELD,
    REWRITTEN_FIELD,
    SYSTEM_DATA_FIELD,
    SourceMarks,
    added_pou,
)
from plcopen_sfc.formats.provenance import is_untouched
from plcopen_sfc.languages.library_blocks import library_blocks
from plcopen_sfc.languages.networks.network_graph import Graph, is_memory_pin
from plcopen_sfc.languages.s7_globals import by_retention
from plcopen_sfc.languages.s7_programs import is_void
from plcopen_sfc.languages.s7_types import is_system_data
from plcopen_sfc.languages.syntax_problems import embedded_code
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.network import Block, Coil, Node, OutputVariable
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import BodyCondition
from plcopen_sfc.model.variables import Interface, VariableSection, sections_of
from plcopen_sfc.report import ConversionReport, Outcome


def rewrite_project(
    project: Project, kind: Format, options: WriteOptions, report: ConversionReport
) -> tuple[Project, Marks]:
    """Return a copy of `project` in terms that the tool of `kind` executes, and what to keep of the source where.

    `project` itself, which is changed, where nothing of the source changes.
    """
    host = kind.charts
    if host is None:
        return _in_terms_of_graph(project, options, report) if kind.flags_as_conditions else (project, {})
    adaptation = ProjectAdaptation(project, project, host, options, report)
    for rule in RULES:
        if not rule.keeps_source and rule.applies(adaptation):
            rule.apply(adaptation)
    needed = [rule for rule in RULES if rule.keeps_source and rule.applies(adaptation)]
    if needed:
        adaptation.project = project.model_copy(deep=True)
    for rule in needed:
        rule.apply(adaptation)
    return adaptation.project, adaptation.marks


def _in_terms_of_graph(project: Project, options: WriteOptions, report: ConversionReport) -> tuple[Project, Marks]:
    """Return a copy in which conditions obey SFC flags and have no boxes; `project` itself where it has neither."""
    flags, boxes = has_flags(project, options), has_boxes(project, options)
    if not flags and not boxes:
        return project, {}
    copy, marks = project.model_copy(deep=True), SourceMarks()
    if flags:
        execute_flags_in_graph(copy, project, options, report, marks)
    if boxes:
        execute_boxes(copy, project, options, report, marks)
    return copy, marks


@dataclass(slots=True)
class ProjectAdaptation:
    """A project on its way to the `host`: `project` is changed, `source` is what it was."""

    project: Project
    source: Project
    host: ChartHost
    options: WriteOptions
    report: ConversionReport
    marks: SourceMarks = field(default_factory=dict)


@dataclass(frozen=True)
class AdaptationRule:
    """A rule of the adaptation: what it applies to in which target, and what it makes of that.

    `of`, `where` and `makes` are for people. `keeps_source`: what was written keeps the source beside it, and a reader
    puts that back; what other rules make is read as it is.
    """

    of: str
    where: str
    makes: str
    applies: Callable[[ProjectAdaptation], bool]
    apply: Callable[[ProjectAdaptation], None]
    keeps_source: bool = False


def _code_in_c(this: ProjectAdaptation) -> None:
    for place in embedded_code(this.project):
        this.report.add(Outcome.NOT_EXECUTED, "code in C", place, f"{this.host.title} does not compile {{{{ .. }}}}")


def _has_foreign_lists(this: ProjectAdaptation) -> bool:
    return has_lists(this.project) and not (this.host.names_lists or this.options.same)


def _charts(this: ProjectAdaptation) -> None:
    rewrite_charts(this.project, this.source, this.host, options=this.options, report=this.report, marks=this.marks)


def _libraries(this: ProjectAdaptation) -> None:
    for block in library_blocks(this.project):
        this.project.pous = [*this.project.pous, block]
        this.marks[id(block)] = added_pou(block)
        why = f"{this.host.title} has no library with it: its statements are in the file"
        this.report.add(Outcome.TRANSLATED, "POU", block.report_path, why)


def _results(this: ProjectAdaptation) -> None:
    for interface in _without_result(this.project):
        place, section = next((i, section) for i, section in enumerate(interface.sections) if is_void(section))
        this.marks[id(interface)] = {NO_RESULT_FIELD: [place, section.model_dump(mode="json", exclude_none=True)]}
        interface.sections = [other for other in interface.sections if other is not section]


def _system_data(this: ProjectAdaptation) -> None:
    # other tools have data of steps of their own, and not these types
    for pou in _with_system_data(this.project):
        left_out: list[tuple[int, int, dict[str, object]]] = []
        for number, section in enumerate(sections_of(pou.interface)):
            for place, variable in enumerate(section.variables):
                if is_system_data(variable):
                    left_out.append((number, place, variable.model_dump(mode="json", exclude_none=True)))
                    why = f"left out: {this.host.title} has data of steps of its own"
                    this.report.add(Outcome.TRANSLATED, "variable", f"{pou.report_path} / {variable.name}", why)
            section.variables = [variable for variable in section.variables if not is_system_data(variable)]
        this.marks.setdefault(id(pou.interface), {})[SYSTEM_DATA_FIELD] = left_out


def _retained(this: ProjectAdaptation) -> None:
    for interface in _partly_retained(this.project):
        sections: list[VariableSection] = []
        split: list[tuple[int, int]] = []
        for section in interface.sections:
            parts = [*by_retention(section)]
            split += [(len(sections), len(parts))] if parts != [section] else []
            sections += parts if parts != [section] else [section]
        interface.sections = sections
        this.marks.setdefault(id(interface), {})[RETAINED_FIELD] = split


RULES = (
    AdaptationRule(
        "code in C, `{{ .. }}`",
        "CODESYS, TwinCAT, CoDeSys 2.3",
        "not executed: they do not compile it",
        lambda this: this.host.is_codesys,
        _code_in_c,
    ),
    AdaptationRule(
        "a coil in FBD, as TIA Portal draws it",
        "all",
        "an output variable",
        lambda this: not this.options.same,
        lambda this: _adapt_coils(this.project, this.report),
    ),
    AdaptationRule(
        "places that give the order of execution in a network",
        "CODESYS, TwinCAT, CoDeSys 2.3",
        "numbers of the order",
        lambda this: this.host.is_codesys and not this.options.same,
        lambda this: _order_elements(this.project, this.report),
    ),
    AdaptationRule(
        "a variable whose type is `S5TIME`",
        "all",
        "a TIME",
        lambda this: not this.options.same and any(variables_with_times(this.project)),
        lambda this: declare_times(this.project, this.report),
    ),
    AdaptationRule(
        "a variable of a type that the target does not have, such as `DTL`, in CODESYS `CHAR`",
        "all",
        "not executed: the declaration does not compile",
        lambda this: not this.options.same,
        lambda this: report_types(this.project, this.host, this.report),
    ),
    AdaptationRule(
        "a box of S7 with the operand of its memory at a pin",
        "all",
        "not executed",
        lambda this: this.options.of_graph and not this.options.flavour,  # which has logic in its place
        lambda this: _report_memories(this.project, this.host, this.report),
    ),
    AdaptationRule(
        "a variable that has the name of an SFC flag and is none",
        "CODESYS, TwinCAT, CoDeSys 2.3",
        "approximated: it controls the chart there",
        lambda this: this.host.is_codesys and not this.options.of_codesys and not this.options.same,
        lambda this: _report_flags(this.project, this.report),
    ),
    AdaptationRule(
        "actions of a chart that one scan executes and that have a variable in common",
        "all",
        "approximated where CODESYS executes them by their names, and the other tool in the order of their first use",
        lambda this: (
            this.options.of_codesys is not this.host.is_codesys
            and (this.options.of_codesys or this.options.final_scan)
            and not (this.options.of_graph or this.options.same)
        ),
        lambda this: report_orders(this.project, this.host, this.report),
    ),
    AdaptationRule(
        "a list of global variables, `GVL_IO.x`",
        "TC6, CoDeSys 2.3",
        "variables of the configuration, in CoDeSys 2.3 of the list, `x`",
        _has_foreign_lists,
        lambda this: declare_lists(this.project, this.host, this.report, this.marks),
        keeps_source=True,
    ),
    AdaptationRule(
        "a chart with something of the next table",
        "all",
        "a chart in the terms of the target",
        lambda this: (
            (_has_foreign_lists(this) and not this.host.is_codesys)  # their names are in texts of charts
            or any(needs_rewriting(chart, this.host, this.options) for chart in this.project.charts())
        ),
        _charts,
        keeps_source=True,
    ),
    AdaptationRule(
        "a `TIMER` or `COUNTER` of S5 of a block",
        "all",
        "a BOOL, the output, or an INT, the count; an input is an in-out",
        lambda this: not this.options.same and any(interfaces_with_operands(this.project)),
        lambda this: declare_operands(this.project, this.report, this.marks),
        keeps_source=True,
    ),
    AdaptationRule(
        "a task with the programs that it calls",
        "CoDeSys 2.3",
        "calls in the program PLC_PRG, which the controller executes in every cycle",
        lambda this: this.host.has_main and executes_without_tasks(this.project),
        lambda this: call_from_main(this.project, this.host, this.report, this.marks),
        keeps_source=True,
    ),
    AdaptationRule(
        "tags, data blocks, organization blocks",
        "all",
        "global variables at their addresses, lists or structures, programs of a task",
        lambda this: has_globals(this.project),
        lambda this: add_globals(this.project, this.host, this.report, this.marks),
        keeps_source=True,
    ),
    AdaptationRule(
        "`BLINK` of the library Util of CODESYS",
        "TC6, TwinCAT",
        "a function block with its name and its statements",
        lambda this: (not this.host.is_codesys or this.host.by_bytes) and bool(library_blocks(this.project)),
        _libraries,
        keeps_source=True,
    ),
    AdaptationRule(
        "a function of S7 with the result `Void`",
        "all",
        "a function without result",
        lambda this: any(_without_result(this.project)),
        _results,
        keeps_source=True,
    ),
    AdaptationRule(
        "variables of TIA Portal for steps and transitions (`G7_StepPlus_V6`)",
        "all",
        "left out: the target has such data itself",
        lambda this: any(_with_system_data(this.project)),
        _system_data,
        keeps_source=True,
    ),
    AdaptationRule(
        "a member of a block that TIA Portal retains",
        "all",
        "a variable in a section with `RETAIN`",
        lambda this: any(_partly_retained(this.project)),
        _retained,
        keeps_source=True,
    ),
)
"""The rules for projects, in the order in which they are applied."""


def _with_system_data(project: Project) -> Iterator[Pou]:
    """Yield the blocks with variables that TIA Portal declares for a sequencer, its steps and its transitions."""
    for pou in project.pous:
        if any(is_system_data(variable) for variable in pou.variables()):
            yield pou


def _partly_retained(project: Project) -> Iterator[Interface]:
    """Yield the interfaces of blocks with members that TIA Portal retains one by one."""
    for pou in project.pous:
        if any([*by_retention(section)] != [section] for section in sections_of(pou.interface)):
            assert pou.interface is not None  # noqa: S101  # it has sections
            yield pou.interface


def _report_flags(project: Project, report: ConversionReport) -> None:
    """Report variables of a source without SFC flags that are flags in CODESYS, as they have their names."""
    for chart in project.charts():
        for flag in sorted(flags_in_use(chart)):
            does = "is set by the chart" if flag in _SET_BY_CHARTS else "controls the chart"
            why = f"a variable of this name {does} in CODESYS, and has no such effect in the source"
            report.add(Outcome.APPROXIMATED, flag.variable, chart.report_path, why)


_SET_BY_CHARTS = frozenset(
    {SfcFlag.ERROR, SfcFlag.TRANS, SfcFlag.ERROR_STEP, SfcFlag.ERROR_POU, SfcFlag.CURRENT_STEP}
    | {SfcFlag.ERROR_ANALYZATION, SfcFlag.ERROR_ANALYZATION_TABLE}
)


def _without_result(project: Project) -> Iterator[Interface]:
    """Yield the interfaces of functions of S7 whose result is of the type Void: others have no result then."""
    for pou in project.pous:
        if pou.interface is not None and any(is_void(section) for section in pou.interface.sections):
            yield pou.interface


def has_rewritten_charts(project: Project, kind: Format) -> bool:
    """True if an edited chart of `project` is written in other terms."""
    host = kind.charts
    if host is None:
        return False
    charts = (chart for chart in project.charts() if not is_untouched(chart.chart))
    return any(needs_rewriting(chart, host, WriteOptions()) for chart in charts)


def is_rewritten_throughout(project: Project, content: bytes, kind: Format) -> bool:
    """True if the file `content` has what was rewritten, or `project` has such things, in more than its charts."""
    host = kind.charts
    if host is None:
        return kind.codec().is_rewritten(project, content)
    return (
        may_have(content, REWRITTEN_FIELD)
        or has_globals(project)
        or any(_without_result(project))
        or any(_with_system_data(project))
        or any(_partly_retained(project))
        or bool(not host.is_codesys and project.global_variables)
    )


def _drawn(project: Project) -> Iterator[tuple[str, str, FbdBody | LdBody]]:
    """Yield all networks of bodies and conditions, each with the path of what is around it and its own."""
    for name, pou, body in project.bodies():
        if isinstance(body, FbdBody | LdBody):
            yield pou.report_path_of(name), pou.report_path_of(name), body
    for chart in project.charts():
        for transition in chart.chart.transitions:
            condition = transition.condition
            if isinstance(condition, BodyCondition) and isinstance(condition.body, FbdBody | LdBody):
                path = f"{chart.report_path} / transition {chart.chart.label(transition)}"
                yield chart.report_path, path, condition.body


def _report_memories(project: Project, host: ChartHost, report: ConversionReport) -> None:
    """Report boxes of S7 that have the operand of their memory at a pin: edges, and flip-flops that are no instances.

    Conditions become expressions in CODESYS, which has its own words where there is none.
    """
    for around, place, body in _drawn(project):
        boxes = [node for network in body.networks for node in network.nodes if isinstance(node, Block)]
        names = [box.type_name for box in boxes if any(is_memory_pin(box, pin) for pin in box.parameters.inputs)]
        if names and (around == place or not host.is_codesys):
            why = f"{host.title} has no {' and '.join(dict.fromkeys(names))} with the operand of its memory at a pin"
            report.add(Outcome.NOT_EXECUTED, "box", place, f"{why}: it does not compile")


def _adapt_coils(project: Project, report: ConversionReport) -> None:
    """Write coils of FBD, which TIA Portal draws there, as output variables: TC6 knows coils in LD only."""
    for place, _, body in _drawn(project):
        if not isinstance(body, FbdBody):
            continue
        for network in body.networks:
            coils = sum(isinstance(node, Coil) for node in network.nodes)
            if coils:
                network.nodes = [_output(node) for node in network.nodes]
                report.add(Outcome.TRANSLATED, "coil", place, "an output variable: FBD of TC6 has no coils")


def _order_elements(project: Project, report: ConversionReport) -> None:
    """Put elements into the order in which the source executes them, and number them so: CODESYS knows no places.

    The elements of its exports are all at (0, 0), in the order of the file and without numbers.
    """
    for around, place, body in _drawn(project):
        if around != place:
            continue
        for network in body.networks:
            graph = Graph([network.nodes])
            roots = list(graph.roots())
            turns = {node.id: turn for turn, node in enumerate(roots)}
            if [node.id for node in network.nodes if node.id in turns] == list(turns):
                continue
            network.nodes = list(graph.execution())
            for number, node in enumerate(roots, start=1):
                node.execution_order = number
            report.add(Outcome.TRANSLATED, "order of execution", place, "numbers instead of places")


def _output(node: Node) -> Node:
    if not isinstance(node, Coil):
        return node
    shared = {field: getattr(node, field) for field in Coil.model_fields if field in OutputVariable.model_fields}
    return OutputVariable.model_validate({**shared, "kind": "output", "expression": node.variable})


def rule_tables() -> str:
    """Return the rules as tables in Markdown."""
    rows = ["| what | in | becomes | the way back |", "|---|---|---|---|"]
    for rule in RULES:
        back = "the source" if rule.keeps_source else "as it was written"
        rows.append(f"| {rule.of} | {rule.where} | {rule.makes} | {back} |")
    rows += ["", "| what of a chart | becomes |", "|---|---|"]
    rows += [f"| {each.of} | {each.makes} |" for each in CHART_RULES]
    return "\n".join(rows)
