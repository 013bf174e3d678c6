"""Timers and edges drawn before conditions as permanent instructions of S7-GRAPH, whose transitions have no such boxes.

IEC 61131-3 executes what is drawn before a condition while its transition is enabled. A permanent instruction is
executed in every cycle, and a timer in LAD has no EN. So the box gets its input while the transition is enabled, and
keeps the one that it has otherwise: TON, TOF, TP and edges do then what they do where nothing calls them::

    #t(IN := (#Fill.X AND #a) OR (NOT #Fill.X AND #t.IN), PT := T#5s);

Beremiz and OpenPLC execute all boxes in every scan, after the transitions, which read what they gave a scan ago. So
does a permanent instruction behind the sequence. What is drawn in the chart and feeds no condition is executed before
the transitions in every scan, but by Beremiz, which leaves it out.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from plcopen_sfc.conversion.adaptation.chart_rewriting import GRAPH_CHARTS, ChartRewriting, taken_names, type_of_helper
from plcopen_sfc.formats.format_interface import SOURCE_CHART_FIELD, WriteOptions
from plcopen_sfc.formats.plcopen.source_marks import SourceMarks
from plcopen_sfc.languages.networks import (
    Helper,
    chart_statements,
    condition_reader,
    draw_ld,
    feeding_nodes,
    kept_conditions,
)
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules, declared_rules
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, print_node
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model.body import LdBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Node, OutputVariable
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import PermanentOperation, SfcNetwork, Transition, by_priority
from plcopen_sfc.model.types import DataType, DerivedType, Variable
from plcopen_sfc.report import ConversionReport, Outcome

_INPUTS = {"TON": "IN", "TOF": "IN", "TP": "IN", "R_TRIG": "CLK", "F_TRIG": "CLK"}
"""The blocks that do nothing while their input stays, and this input."""
_WHY = "the boxes drawn before conditions are called there, as if enabled transitions alone called them"
_WHY_DRAWN = "what is drawn beside the steps is executed there"
_WHY_LEFT_OUT = "left out, as Beremiz and OpenPLC do not execute it"
_WHY_AFTER = "the boxes drawn before conditions are executed there in every scan, which conditions see a scan later"


class _MovedBoxes(NamedTuple):
    """Boxes before conditions as networks, and the conditions without them, by the ids of their transitions.

    `helpers`: instances of edges, which the source does not declare.
    """

    conditions: dict[int, str]
    networks: list[LdBody]
    helpers: list[Helper]


def has_boxes(project: Project, options: WriteOptions) -> bool:
    """True if `execute_boxes` changes a chart."""
    if options.same or options.of_graph:
        return False
    for chart in project.charts():
        taken = taken_names(project, chart)
        rewriting = ChartRewriting(chart, chart.chart, GRAPH_CHARTS, options, ConversionReport(), {}, taken)
        if _moved(rewriting) is not None or _acting(chart, options) is not None:
            return True
    return False


def execute_boxes(
    project: Project, source: Project, options: WriteOptions, report: ConversionReport, marks: SourceMarks
) -> None:
    """Put the boxes before conditions of `project`, a copy of `source` in SCL, into permanent instructions."""
    for chart, before in zip(list(project.charts()), list(source.charts()), strict=True):
        taken = taken_names(project, chart)
        rewriting = ChartRewriting(chart, before.chart, GRAPH_CHARTS, options, report, marks, taken)
        acting = _acting(chart, options)
        if acting is not None:
            _execute_drawn(chart, acting, report)
        moved = _moved(rewriting)
        if moved is not None:
            _execute_moved(rewriting, moved)
        if acting is not None or moved is not None:
            marks.setdefault(id(chart.chart), {})[SOURCE_CHART_FIELD] = before.chart


def _execute_moved(rewriting: ChartRewriting, moved: _MovedBoxes) -> None:
    """Let permanent instructions execute the boxes of a chart, and take out of its drawing what fed them alone."""
    network, is_after = rewriting.chart.chart, rewriting.options.of_matiec
    why, place = (_WHY_AFTER, "after") if is_after else (_WHY, "before")
    rewriting.declare_helpers(moved.helpers)
    transitions = {each.id: each for each in network.transitions}
    fed = {id(node) for number in moved.conditions for node in _feeding(network, transitions[number])}
    for number, condition in moved.conditions.items():
        transitions[number].condition = Expression(text=condition)
        label = network.label(transitions[number])
        rewriting.note(Outcome.TRANSLATED, "condition", f"transition {label}", why)
    others = {id(node) for each in network.transitions for node in _feeding(network, each)}
    network.logic = [node for node in network.logic if id(node) not in fed or id(node) in others]
    operations = network.permanent_post if is_after else network.permanent_pre
    operations += [PermanentOperation(body=body) for body in moved.networks]
    rewriting.note(Outcome.TRANSLATED, f"permanent instruction {place} the sequence", "", why)


def _acting(chart: Chart, options: WriteOptions) -> list[LdBody] | None:
    """Return networks for what is drawn in a chart and feeds no condition; None where it has nothing, or none do it."""
    if not chart.chart.logic or chart.chart is not chart.pou.chart:
        return None
    found = chart_statements(chart.chart, Dialect.SCL)
    if not found.tree.statements:
        return None
    if options.of_matiec:  # Beremiz does not execute it
        return []
    drawn = draw_ld(found.tree.statements, declared_rules(chart.pou.variables(), Dialect.SCL, Tool.S7))
    is_whole = not (found.obstacles or found.helpers or drawn.problems)
    nodes = [node for network in drawn.body.networks for node in network.nodes]
    is_whole = is_whole and not any(isinstance(node, OutputVariable) for node in nodes)  # which is no bit
    return [drawn.body] if is_whole else None


def _execute_drawn(chart: Chart, acting: list[LdBody], report: ConversionReport) -> None:
    """Let a permanent instruction before the sequence do what is drawn in a chart and feeds no condition."""
    network, what = chart.chart, "permanent instruction before the sequence"
    for body in acting:
        network.permanent_pre.append(PermanentOperation(body=body))
        report.add(Outcome.TRANSLATED, what, chart.report_path, _WHY_DRAWN)
    report.add(Outcome.TRANSLATED, "drawn logic", chart.report_path, _WHY_DRAWN if acting else _WHY_LEFT_OUT)
    fed = {id(node) for each in network.transitions for node in _feeding(network, each)}
    network.logic = [node for node in network.logic if id(node) in fed]


def _moved(rewriting: ChartRewriting) -> _MovedBoxes | None:
    """Return the boxes of a chart, executed as its tool does; None where it has none, or they cannot be elsewhere."""
    if rewriting.chart.chart is not rewriting.chart.pou.chart:
        return None
    return _boxes_after(rewriting.chart) if rewriting.options.of_matiec else _boxes_before(rewriting)


def _boxes_after(chart: Chart) -> _MovedBoxes | None:
    """Return the boxes of a chart of Beremiz, which are executed in every scan."""
    network = chart.chart
    read = condition_reader(network, Dialect.SCL, transitions=chart.pou.transitions)
    needed: list[Transition] = []
    for transition in network.transitions:
        found = read(transition.condition) if transition.condition is not None else None
        if found is not None and (found.before or found.helpers):
            needed.append(transition)
    if not needed:
        return None
    taken = {variable.name for variable in chart.pou.variables()} | {step.name for step in network.steps}
    part = network.model_copy(update={"transitions": needed})
    kept, trees = kept_conditions(part, Dialect.SCL, transitions=chart.pou.transitions, taken=taken)
    if len(trees) < len(needed):
        return None
    added = [Variable(name=each.name, type=type_of_helper(each)) for each in kept.helpers]
    rules = declared_rules([*chart.pou.variables(), *added], Dialect.SCL, Tool.S7)
    drawn = draw_ld(kept.tree.statements, rules)
    conditions = {number: print_node(tree) for number, tree in trees.items()}
    return _MovedBoxes(conditions, [drawn.body], [*kept.helpers]) if not drawn.problems else None


def _feeding(chart: SfcNetwork, transition: Transition) -> list[Node]:
    return feeding_nodes(chart, transition.condition, Dialect.SCL)


def _boxes_before(rewriting: ChartRewriting) -> _MovedBoxes | None:
    """Return the boxes of a chart that enabled transitions execute."""
    chart = rewriting.chart
    instances = {f"#{variable.name}": _block(variable.type) for variable in chart.pou.variables()}
    tried: list[tuple[Transition, str]] = []
    moved = _MovedBoxes({}, [], [])
    for transition in by_priority(chart.chart.transitions):
        found = rewriting.read(transition.condition) if transition.condition is not None else None
        if found is None or found.tree is None or found.obstacles or not found.complete:
            return None
        text = print_node(found.tree)
        if found.before:
            known = {f"#{each.name}": each.type_name or "" for each in found.helpers}
            instances |= known
            body = _networks(found.before, rewriting.enabled(transition, tried), instances)
            if body is None or not set(known.values()) <= _INPUTS.keys():
                return None
            moved.conditions[transition.id] = text
            moved.networks.append(body)
            moved.helpers.extend(found.helpers)
        tried.append((transition, text))
    return moved if moved.networks else None


def _networks(before: Sequence[n.Statement], enabled: str, instances: dict[str, str]) -> LdBody | None:
    """Return the networks that call boxes in every cycle as if only an enabled transition called them."""
    lines: list[str] = []
    for statement in before:
        call = statement.call if isinstance(statement, n.CallStatement) else None
        name = print_node(call.callee) if isinstance(call, n.Call) else ""
        held = _INPUTS.get(instances.get(name, ""))
        if not isinstance(call, n.Call) or held is None:
            return None
        passed: list[str] = []
        for argument in call.arguments:
            if argument.name is None or argument.value is None or argument.output:
                return None
            pin, value = argument.name.identifier.upper(), print_node(argument.value)
            if pin == held:
                value = f"({enabled} AND ({value})) OR (NOT ({enabled}) AND {name}.{held})"
            elif not isinstance(argument.value, n.Literal):  # another time would count while nothing calls the timer
                value = f"SEL(G := {enabled}, IN0 := {name}.{pin}, IN1 := {value})"
            passed.append(f"{pin} := {value}")
        lines.append(f"{name}({', '.join(passed)});")
    drawn = draw_ld(parse_statements("\n".join(lines), Dialect.SCL).tree.statements, _rules(instances))
    return drawn.body if not drawn.problems else None


def _rules(instances: dict[str, str]) -> DrawingRules:
    variables = [Variable(name=name, type=DerivedType(name=block)) for name, block in instances.items() if block]
    return declared_rules(variables, Dialect.SCL, Tool.S7)


def _block(kind: DataType) -> str:
    """Return the name of a block of `_INPUTS` that a type is; empty for any other."""
    name = kind.name.upper().removesuffix("_TIME") if isinstance(kind, DerivedType) else ""
    return name if name in _INPUTS else ""
