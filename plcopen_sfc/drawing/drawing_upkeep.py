"""Upkeep of the drawings of a project: every chart gets a drawing that fits it before a writer needs it."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.drawing.attached_symbols import draw_step_actions, erase_step_actions
from plcopen_sfc.drawing.document_order import renumber
from plcopen_sfc.drawing.drawing_style import DrawingStyle, fits
from plcopen_sfc.drawing.new_drawing import draw
from plcopen_sfc.drawing.redrawing import redraw
from plcopen_sfc.drawing.symbol_layout import layout
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.conditions import BodyCondition, Condition, Expression
from plcopen_sfc.model.drawing import STEPS, Places, SymbolKind
from plcopen_sfc.model.network import InputPin, OutputPin
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork


def forget_places(chart: SfcNetwork) -> None:
    """Put everything in a drawing with computed places back to where CODESYS exports have it: at 0, 0, without size."""
    drawing = chart.drawing
    if drawing is None or drawing.places is not Places.COMPUTED:
        return
    drawing.places = Places.NONE
    for symbol in drawing.symbols:
        symbol.position = (0, 0)
        symbol.width = symbol.height = None
        _forget_pins([*symbol.inputs, symbol.condition], [*symbol.outputs, symbol.action_output])
        for entry in symbol.entries or ():
            entry.position = None
            entry.width = entry.height = None
            _forget_pins([], [entry.output])


def _forget_pins(inputs: list[InputPin | None], outputs: list[OutputPin | None]) -> None:
    for pin in inputs:
        if pin is not None:
            pin.position = None
            for connection in pin.connections:
                connection.points = []
    for output in outputs:
        if output is not None:
            output.position = None


def is_structured(chart: SfcNetwork) -> bool:
    """True if a chart is drawn as CODESYS draws: wires lead back to earlier symbols, conditions are symbols."""
    drawing = chart.drawing
    if drawing is None:
        return False
    seen: set[int] = {node.id for node in chart.logic}
    conditions = {transition.id: transition.condition for transition in chart.transitions}
    for symbol in drawing.symbols:
        wires = [connection.source for pin in symbol.inputs for connection in pin.connections]
        if symbol.kind is SymbolKind.TRANSITION:
            condition = conditions.get(symbol.transitions[0] if symbol.transitions else symbol.id)
            if isinstance(condition, Expression) and symbol.condition is None:
                return False
        if symbol.kind in STEPS and any(output.name == "" for output in symbol.outputs):
            return False
        if any(source not in seen for source in wires):
            return False
        seen.add(symbol.id)
    return True


def prepare(
    project: Project,
    style: DrawingStyle,
    *,
    positions: bool,
    replace: bool = False,
    renumbered: bool = False,
    foreign: bool = False,
) -> None:
    """Draw what is not drawn, and bring up to date what no longer fits, in every body of a project."""
    for _, _, body in project.bodies():
        prepare_body(body, style, positions=positions, replace=replace, renumbered=renumbered, foreign=foreign)


def prepare_body(
    body: Body,
    style: DrawingStyle,
    *,
    positions: bool,
    replace: bool = False,
    renumbered: bool = False,
    foreign: bool = False,
) -> None:
    """Draw what is not drawn, and bring up to date what no longer fits, in the charts of one body.

    `positions`: charts whose drawing has no places get them. `replace`: drawings that fit are replaced too.
    `renumbered`: charts that get a new drawing get new ids in document order, as CODESYS numbers them. `foreign`:
    drawings in another style than a structured one that is asked for are replaced.
    """
    for chart in charts_in(body):
        if style.structured:
            erase_step_actions(chart)
            forget_places(chart)
        drawn = replace or chart.drawing is None or (style.structured and foreign and not is_structured(chart))
        if drawn:
            chart.drawing = draw(chart, style)
            if renumbered:
                renumber(chart)
        elif not fits(chart, style):
            redraw(chart, style)
        if not style.structured:
            draw_step_actions(chart, style)
        if positions and chart.drawing is not None and chart.drawing.places is Places.NONE:
            layout(chart)
            chart.drawing.places = Places.COMPUTED


def all_charts(project: Project) -> Iterator[SfcNetwork]:
    """Yield every chart of a project: of its POUs and their parts, and those inside charts, outer ones first."""
    for _, _, body in project.bodies():
        yield from charts_in(body)


def charts_in(body: Body | None) -> Iterator[SfcNetwork]:
    """Chart of a body and the charts inside it: macro-steps, partial charts, and bodies programmed in place."""
    pending: list[Body | SfcNetwork | None] = [body]
    while pending:
        one = pending.pop()
        if isinstance(one, SfcBody):
            one = one.chart
        if isinstance(one, SfcNetwork):
            yield one
            pending += reversed(_inner(one))


def _inner(chart: SfcNetwork) -> list[Body | SfcNetwork | None]:
    inner: list[Body | SfcNetwork | None] = []
    for step in chart.steps:
        if step.macro is not None:
            inner.append(step.macro.body)
        inner += [a for a in (step.entry_action, step.main_action, step.exit_action) if not isinstance(a, str)]
        inner += [_body_of(part.condition) for part in (step.interlock, step.supervision) if part is not None]
        for association in step.actions:
            inner += [association.body, _body_of(association.condition)]
    inner += [_body_of(transition.condition) for transition in chart.transitions]
    inner += [operation.body for operation in (*chart.permanent_pre, *chart.permanent_post)]
    inner += [part.chart for part in chart.partial_charts]
    return inner


def _body_of(condition: Condition | None) -> Body | None:
    return condition.body if isinstance(condition, BodyCondition) else None
