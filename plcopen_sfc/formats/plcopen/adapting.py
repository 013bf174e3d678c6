"""What TC6 makes of a project of another tool, before it is written."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.plcopen.global_data import add_globals, has_globals, report_types
from plcopen_sfc.formats.plcopen.global_lists import declare_lists, has_lists
from plcopen_sfc.formats.plcopen.host import Host
from plcopen_sfc.formats.plcopen.rewriting import needs_rewriting, rewrite_charts
from plcopen_sfc.formats.plcopen.rewritten import NO_RESULT_FIELD, REWRITTEN_FIELD, Marks
from plcopen_sfc.formats.provenance import is_untouched
from plcopen_sfc.languages.networks.graph import Graph, is_memory_pin
from plcopen_sfc.languages.s7_results import is_void
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.conditions import BodyCondition
from plcopen_sfc.model.network import Block, Coil, Node, OutputVariable
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcFlag
from plcopen_sfc.model.variables import Interface
from plcopen_sfc.report import ConversionReport, Outcome


def rewrite(project: Project, host: Host, options: WriteOptions, report: ConversionReport) -> tuple[Project, Marks]:
    """A copy of `project` that says what the `host` is to execute in its terms, and what to keep of the source where.

    `project` itself, which is changed, where that changes nothing that the source says.
    """
    if not options.same:
        _adapt_coils(project, report)
        if host.is_codesys:
            _order_elements(project, report)
        report_types(project, host, report)
    if options.of_graph:
        _report_memories(project, host, report)
    if host.is_codesys and not options.of_codesys and not options.same:
        _report_flags(project, report)
    lists = has_lists(project) and not host.is_codesys
    if (
        not lists
        and not any(_without_result(project))
        and not has_globals(project)
        and not any(needs_rewriting(chart.chart, host, options) for chart in project.charts())
    ):
        return project, {}
    copy = project.model_copy(deep=True)
    marks: Marks = {}
    if lists:
        declare_lists(copy, report, marks)
    rewrite_charts(copy, project, host, options=options, report=report, marks=marks)
    add_globals(copy, host, report, marks)
    for interface in _without_result(copy):
        place, section = next((i, section) for i, section in enumerate(interface.sections) if is_void(section))
        marks[id(interface)] = {NO_RESULT_FIELD: [place, section.model_dump(mode="json", exclude_none=True)]}
        interface.sections = [other for other in interface.sections if other is not section]
    return copy, marks


def _report_flags(project: Project, report: ConversionReport) -> None:
    """Report variables of a source without SFC flags that are flags in CODESYS, as they have their names."""
    known = {variable.name.casefold() for section in project.global_sections() for variable in section.variables}
    for chart in project.charts():
        declared = known | {variable.name.casefold() for variable in chart.pou.variables()}
        for flag in sorted(chart.chart.flags_in_use(partial(_is_among, declared))):
            does = "is set by the chart" if flag in _SET_BY_CHARTS else "controls the chart"
            why = f"a variable of this name {does} in CODESYS, and has no such effect in the source"
            report.add(Outcome.APPROXIMATED, flag.variable, chart.report_path, why)


def _is_among(names: set[str], name: str) -> bool:
    return name.casefold() in names


_SET_BY_CHARTS = frozenset(
    {SfcFlag.ERROR, SfcFlag.TRANS, SfcFlag.ERROR_STEP, SfcFlag.ERROR_POU, SfcFlag.CURRENT_STEP}
    | {SfcFlag.ERROR_ANALYZATION, SfcFlag.ERROR_ANALYZATION_TABLE}
)


def _without_result(project: Project) -> Iterator[Interface]:
    """The interfaces of functions of S7 whose result is of the type Void: others have no result then."""
    for pou in project.pous:
        if pou.interface is not None and any(is_void(section) for section in pou.interface.sections):
            yield pou.interface


def is_rewritten(project: Project, content: bytes, host: Host) -> bool:
    """True if the file `content` holds what was rewritten, or an edit of `project` made that necessary."""
    if f'"{REWRITTEN_FIELD}"'.encode() in content or has_globals(project):
        return True
    if any(_without_result(project)) or (not host.is_codesys and project.global_variables):
        return True
    charts = (chart.chart for chart in project.charts() if not is_untouched(chart.chart))
    return any(needs_rewriting(chart, host, WriteOptions()) for chart in charts)


def _drawn(project: Project) -> Iterator[tuple[str, str, FbdBody | LdBody]]:
    """All networks of bodies and conditions, each with the path of what is around it and its own."""
    for name, pou, body in project.bodies():
        if isinstance(body, FbdBody | LdBody):
            yield pou.report_path_of(name), pou.report_path_of(name), body
    for chart in project.charts():
        for transition in chart.chart.transitions:
            condition = transition.condition
            if isinstance(condition, BodyCondition) and isinstance(condition.body, FbdBody | LdBody):
                path = f"{chart.report_path} / transition {chart.chart.label(transition)}"
                yield chart.report_path, path, condition.body


def _report_memories(project: Project, host: Host, report: ConversionReport) -> None:
    """Report boxes of S7 that have the operand of their memory at a pin: edges, and flip-flops that are no instances.

    Conditions become expressions in CODESYS, which has its own words for what none says.
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

    The elements of its exports all stand at (0, 0), in the order of the file and without numbers.
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
