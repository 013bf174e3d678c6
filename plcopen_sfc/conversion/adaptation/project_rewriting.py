"""Projects of other tools in terms that the target tool executes, before they are drawn and written.

What the tool has no element for becomes statements and conditions that do the same (`step_rewriting`), or is left out
and reported as not executed. The source is kept beside what was written (`source_marks`).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import chain

from plcopen_sfc.conversion.adaptation.chart_rewriting import (
    ChartRewriting,
    as_term,
    conjunction,
    does_something,
    is_network,
    is_supervised,
    taken_names,
)
from plcopen_sfc.conversion.adaptation.global_variables import (
    add_globals,
    declare_lists,
    has_globals,
    has_lists,
    report_types,
)
from plcopen_sfc.conversion.adaptation.sequencer_rewriting import OperatingInputs, PermanentRewriter, ShownState
from plcopen_sfc.conversion.adaptation.step_checks import ACKNOWLEDGING, StepChecks
from plcopen_sfc.conversion.adaptation.step_rewriting import (
    StepRewriter,
    has_special_rows,
    mixed_operands,
    overwritten_rows,
    timed_operands,
)
from plcopen_sfc.formats.format_interface import ChartHost, Format, Marks, WriteOptions
from plcopen_sfc.formats.plcopen.source_marks import (
    NO_RESULT_FIELD,
    REWRITTEN_FIELD,
    SYSTEM_DATA_FIELD,
    SourceMarks,
    rewritten_transition,
)
from plcopen_sfc.formats.provenance import is_untouched
from plcopen_sfc.languages.networks import is_empty_network
from plcopen_sfc.languages.networks.network_graph import Graph, is_memory_pin
from plcopen_sfc.languages.s7_programs import is_void
from plcopen_sfc.languages.syntax_problems import embedded_code
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.conditions import BodyCondition, Condition, Expression, WiredCondition
from plcopen_sfc.model.network import Block, Coil, Node, OutputVariable
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import SfcFlag, Step, Transition
from plcopen_sfc.model.types import DerivedType, Variable
from plcopen_sfc.model.variables import Interface
from plcopen_sfc.report import ConversionReport, Outcome


def rewrite_project(
    project: Project, kind: Format, options: WriteOptions, report: ConversionReport
) -> tuple[Project, Marks]:
    """Return a copy of `project` in terms that the tool of `kind` executes, and what to keep of the source where.

    `project` itself, which is changed, where nothing of the source changes.
    """
    host = kind.charts
    if host is None:
        return project, {}
    if host.is_codesys:
        for where in embedded_code(project):
            report.add(Outcome.NOT_EXECUTED, "code in C", where, f"{host.title} does not compile {{{{ .. }}}}")
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
        and not any(_with_system_data(project))
        and not has_globals(project)
        and not any(needs_rewriting(chart, host, options) for chart in project.charts())
    ):
        return project, {}
    copy = project.model_copy(deep=True)
    marks: SourceMarks = {}
    if lists:
        declare_lists(copy, report, marks)
    rewrite_charts(copy, project, host, options=options, report=report, marks=marks)
    add_globals(copy, host, report, marks)
    for interface in _without_result(copy):
        place, section = next((i, section) for i, section in enumerate(interface.sections) if is_void(section))
        marks[id(interface)] = {NO_RESULT_FIELD: [place, section.model_dump(mode="json", exclude_none=True)]}
        interface.sections = [other for other in interface.sections if other is not section]
    for pou in _with_system_data(copy):
        _leave_out_system_data(pou, host, report, marks)
    return copy, marks


def _with_system_data(project: Project) -> Iterator[Pou]:
    """Yield the blocks with variables that TIA Portal declares for a sequencer, its steps and its transitions."""
    for pou in project.pous:
        if any(_is_system_data(variable) for variable in pou.variables()):
            yield pou


def _is_system_data(variable: Variable) -> bool:
    return isinstance(variable.type, DerivedType) and variable.type.name.strip('"').upper().startswith("G7_")


def _leave_out_system_data(pou: Pou, host: ChartHost, report: ConversionReport, marks: SourceMarks) -> None:
    """Leave out the variables of TIA Portal: other tools have data of steps of their own, and not these types."""
    left_out: list[tuple[int, int, dict[str, object]]] = []
    assert pou.interface is not None  # noqa: S101  # it has variables
    for number, section in enumerate(pou.interface.sections):
        for place, variable in enumerate(section.variables):
            if _is_system_data(variable):
                left_out.append((number, place, variable.model_dump(mode="json", exclude_none=True)))
                why = f"left out: {host.title} has data of steps of its own"
                report.add(Outcome.TRANSLATED, "variable", f"{pou.report_path} / {variable.name}", why)
        section.variables = [variable for variable in section.variables if not _is_system_data(variable)]
    marks.setdefault(id(pou.interface), {})[SYSTEM_DATA_FIELD] = left_out


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
    """Yield the interfaces of functions of S7 whose result is of the type Void: others have no result then."""
    for pou in project.pous:
        if pou.interface is not None and any(is_void(section) for section in pou.interface.sections):
            yield pou.interface


def is_rewritten(project: Project, content: bytes, kind: Format) -> bool:
    """True if the file `content` holds what was rewritten, or an edit of `project` made that necessary."""
    host = kind.charts
    if host is None:
        return kind.codec().is_rewritten(project, content)
    if f'"{REWRITTEN_FIELD}"'.encode() in content or has_globals(project):
        return True
    if (
        any(_without_result(project))
        or any(_with_system_data(project))
        or (not host.is_codesys and project.global_variables)
    ):
        return True
    charts = (chart for chart in project.charts() if not is_untouched(chart.chart))
    return any(needs_rewriting(chart, host, WriteOptions()) for chart in charts)


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


def needs_rewriting(place: Chart, host: ChartHost, options: WriteOptions) -> bool:
    """True if `rewrite_charts` would change a chart, or report something of it."""
    chart = place.chart
    if has_special_rows(chart) or chart.graph_settings is not None or any(is_supervised(step) for step in chart.steps):
        return True
    if any(does_something(operation.body) for operation in (*chart.permanent_pre, *chart.permanent_post)):
        return True
    if any(row.qualifier is Qualifier.R0 for _, row in chart.associations()):
        return True
    if options.of_graph and (
        mixed_operands(chart) or timed_operands(chart) or any(overwritten_rows(step) for step in chart.steps)
    ):
        return True
    if host.is_codesys:
        bodies: list[object] = [row.body for _, row in chart.associations()]
        bodies += [action for s in chart.steps for action in (s.entry_action, s.main_action, s.exit_action)]
        own = ("P1", "P0") if options.final_scan else ("P1", "P0", "P", "N", "None")
        rows = any(row.negated or row.qualifier in own for _, row in chart.associations())
        conditions = any(_is_foreign(transition.condition, host) for transition in chart.transitions)
        return rows or conditions or any(isinstance(body, StBody) for body in bodies)
    if any(step.main_action is not None or step.min_time or step.max_time for step in chart.steps):
        return True
    excluded = any(s.exclude for s in chart.steps) or any(t.exclude for t in chart.transitions)
    if options.of_codesys and _flags_in_use(place):
        return True
    return excluded or chart.settings is not None or any(row.exclude for _, row in chart.associations())


def _flags_in_use(place: Chart) -> frozenset[SfcFlag]:
    project = place.pou.project
    shared = [section.variables for section in project.global_sections()] if project is not None else []
    declared = {variable.name.casefold() for variable in chain(place.pou.variables(), *shared)}
    return place.chart.flags_in_use(lambda name: name.casefold() in declared)


def _is_foreign(condition: Condition | None, host: ChartHost) -> bool:
    """True if CODESYS has no such condition: it takes expressions and names of transition objects."""
    is_il = isinstance(condition, BodyCondition) and isinstance(condition.body, IlBody) and not host.il_conditions
    return condition is not None and (condition.negated or is_network(condition) or condition.kind == "wired" or is_il)


def rewrite_charts(
    copy: Project,
    project: Project,
    host: ChartHost,
    *,
    options: WriteOptions,
    report: ConversionReport,
    marks: SourceMarks,
) -> None:
    """Change the charts of `copy` into what `host` executes, and add to `marks` what to keep of `project` where."""
    for chart, source in zip(list(copy.charts()), list(project.charts()), strict=True):
        if needs_rewriting(chart, host, options) or chart.chart != source.chart:
            taken = taken_names(copy, chart)
            _ChartRewriter(ChartRewriting(chart, source.chart, host, options, report, marks, taken)).rewrite()


class _ChartRewriter:
    def __init__(self, rewriting: ChartRewriting) -> None:
        self._rewriting = rewriting
        self._host = rewriting.host
        self._chart = rewriting.chart.chart
        self._note = rewriting.note
        self._checks = StepChecks(rewriting)

    def rewrite(self) -> None:
        """Change the chart. Conditions first: the supervisions that they need are those of the source."""
        steps = {step.id: step for step in self._chart.steps}
        for transition in self._chart.transitions:
            self._transition(transition, [steps[i] for i in transition.sources if i in steps])
        shown = ShownState(self._rewriting, self._checks)
        rewriter = StepRewriter(self._rewriting, self._checks)
        for step in self._chart.steps:
            rewriter.rewrite(step)
        OperatingInputs(self._rewriting, self._checks).execute()
        PermanentRewriter(self._rewriting, rewriter, self._checks, shown).rewrite()
        self._report_graph(shown.names)
        if not self._host.is_codesys:
            self._report_codesys()

    def _transition(self, transition: Transition, sources: list[Step]) -> None:
        source = self._rewriting.source_transitions[transition.id]
        held = self._rewrite_condition(transition, sources)
        if transition.condition != source.condition:
            uses = [name for step, field in held if field == "supervision" for name in self._checks.names(step)]
            self._rewriting.marks[id(transition)] = rewritten_transition(transition, source, uses, held)

    def _rewrite_condition(self, transition: Transition, sources: list[Step]) -> list[tuple[int, str]]:
        """Change a condition; the ids of steps and the fields of them that it executes now."""
        condition = transition.condition
        if not self._host.is_codesys and (transition.exclude or any(step.exclude for step in sources)):
            transition.condition = Expression(text="FALSE")
            place = f"transition {self._chart.label(transition)}"
            self._note(
                Outcome.TRANSLATED, "exclude", place, "the condition is FALSE: CODESYS leaves the transition out"
            )
            return []
        supervised = [step for step in sources if is_supervised(step)]
        timed = [step for step in sources if step.min_time] if not self._host.is_codesys else []
        foreign = self._host.is_codesys and _is_foreign(condition, self._host)
        if condition is None or not (supervised or timed or foreign):
            return []
        label = f"transition {self._chart.label(transition)}"
        text = self._rewriting.text(condition)
        if text is None:
            text = self._rewriting.new_name(f"Condition_of_{self._chart.label(transition)}_is_missing")
            why = f"it cannot be written as an expression; the undeclared name {text} is in its place"
            self._note(
                Outcome.NOT_EXECUTED, "condition", label, f"{why}, so that {self._host.title} does not compile it"
            )
        elif foreign:
            what = "a network" if is_network(condition) else "logic drawn in the chart"
            what = what if is_network(condition) or isinstance(condition, WiredCondition) else "a negated condition"
            self._note(Outcome.TRANSLATED, "condition", label, f"{what} in the source, here the expression {text}")
        if is_empty_network(condition) and not (supervised or timed):
            text = "TRUE"
        for step in supervised:
            text = self._held(step, text)
        for step in timed:
            text = conjunction(text, f"{self._host.elapsed(step)} >= {step.min_time}")
            why = f"the minimum time {step.min_time} of the step {step.name} is a part of the condition"
            self._note(Outcome.TRANSLATED, "minimum time", label, why)
        if supervised or timed:
            self._note(Outcome.TRANSLATED, "condition", label, f"with what holds the step: {text}")
        transition.condition = Expression(text=text)
        return [*((step.id, "supervision") for step in supervised), *((step.id, "min_time") for step in timed)]

    def _held(self, step: Step, text: str) -> str:
        """Return the condition of a transition with the supervision of a step that it leaves."""
        held = self._checks.held(step)
        place = f"step {step.name}"
        if held is None:
            why = f"it does not hold the step in {self._host.title}: it cannot be written as an expression"
            self._note(Outcome.NOT_EXECUTED, "supervision", place, why)
            return text
        self._note(Outcome.TRANSLATED, "supervision", place, f"NOT {as_term(held)} in the conditions that leave it")
        return conjunction(text, f"NOT {as_term(held)}")

    def _report_graph(self, shown: set[str]) -> None:
        """Report what surrounds a sequencer of S7-GRAPH and has no counterpart."""
        chart, title = self._chart, self._host.title
        for step in chart.steps:
            if self._rewriting.interlock(step) not in (None, "TRUE"):
                why = "rows and outputs that depend on it are statements; it does nothing else"
                self._note(Outcome.TRANSLATED, "interlock", f"step {step.name}", why)
        if chart.graph_settings is None:
            return
        if chart.graph_settings.skip_steps:
            self._note(Outcome.NOT_EXECUTED, "skip steps", "", f"each step is active for a scan at least in {title}")
        for variable in self._rewriting.chart.pou.variables():
            if variable.name in ACKNOWLEDGING:
                why = "statements compute its rising edges where something depends on them"
                self._note(Outcome.TRANSLATED, "operating input", variable.name, why)
        if shown:
            why = f"{', '.join(sorted(shown))}: statements set them as in the automatic mode"
            self._note(Outcome.TRANSLATED, "shown state", "", why)

    def _report_codesys(self) -> None:
        """Report what controls and watches a chart of CODESYS and has no counterpart in TC6."""
        chart = self._chart
        used = _flags_in_use(self._rewriting.chart)
        for flag in sorted(used):
            self._note(Outcome.NOT_EXECUTED, flag.variable, "", f"the flag has no effect in {self._host.title}")
        if SfcFlag.ERROR in used:
            for step in (step for step in chart.steps if step.max_time):
                why = f"{step.max_time} is not watched in {self._host.title}: SFCError is never set"
                self._note(Outcome.NOT_EXECUTED, "max time", f"step {step.name}", why)
