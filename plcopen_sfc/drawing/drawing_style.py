"""Two ways to draw a chart, and whether a drawing still means its chart in one of them."""

from __future__ import annotations

from collections.abc import Set
from enum import StrEnum

from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.drawing import CONVERGENCES, STEPS, Drawing, SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork, Transition, by_priority
from plcopen_sfc.model.wiring import Link, trace_drawing


class DrawingStyle(StrEnum):
    """A way to draw charts.

    PLAIN is what TC6 editors take: bars only where wires meet or part, bars of one kind not nested, conditions written
    at their transition. STRUCTURED is what CODESYS and TwinCAT export and import: every divergence has its convergence,
    branches that end in a jump are wired into it too, conditions are symbols of their own, and the order of the symbols
    is a depth-first walk through the nested branches.
    """

    PLAIN = "plain"
    STRUCTURED = "structured"

    @property
    def structured(self) -> bool:
        """True if every divergence has its convergence."""
        return self is DrawingStyle.STRUCTURED

    @property
    def output_name(self) -> str:
        """Name of the flow outputs of steps and divergences (TC6 requires the attribute)."""
        return "sfc" if self.structured else ""

    @property
    def action_output_name(self) -> str:
        """Name of the output of a step to its action block."""
        return "x" if self.structured else ""

    def wire_name(self, consumer: SymbolKind) -> str | None:
        """Return the output name that a wire into a symbol of this kind gives for where it starts."""
        if self.structured and (consumer is SymbolKind.TRANSITION or consumer in CONVERGENCES):
            return "sfc"
        return None


def fits(chart: SfcNetwork, style: DrawingStyle | None = None) -> bool:
    """True if the chart has a drawing that means exactly the chart.

    Every step, transition and association is drawn once and nothing else is; the wires lead from where to where the
    transitions lead; conditions are wired in the form that they have. Wires that come from nothing do not count: files
    have them, and they mean nothing. An expression inside its transition where most are symbols of their own
    does not fit. In `style` STRUCTURED competing transitions have to be in the order of their priority too.
    """
    drawing = chart.drawing
    if drawing is None or not _complete(chart, drawing) or not _linked(chart, drawing):
        return False
    return style is None or not style.structured or in_order(chart, drawing)


def in_order(chart: SfcNetwork, drawing: Drawing) -> bool:
    """True if competing transitions are drawn from left to right in the order in which they are tried.

    Transitions that wait for several steps are drawn where these come together, whatever they compete with.
    """
    place: dict[int, int] = {}
    for symbol in drawing.symbols:
        if symbol.kind is SymbolKind.TRANSITION:
            for member in symbol.transitions or [symbol.id]:
                place[member] = len(place)
    last: dict[int, int] = {}
    for transition in by_priority(chart.transitions):
        own = place.get(transition.id)
        if own is not None and len(transition.sources) == 1:
            source = transition.sources[0]
            if last.get(source, -1) > own:
                return False
            last[source] = own
    return True


def _complete(chart: SfcNetwork, drawing: Drawing) -> bool:
    """True if a drawing has each step, transition and association of its chart once, where it belongs.

    Files are written from the drawing: a symbol too few or too many, or wired otherwise, is a chart that does
    something else.
    """
    steps = {step.id: step for step in chart.steps}
    transitions = {t.id: t for t in chart.transitions}
    nodes = {node.id for node in chart.logic}
    symbols = {symbol.id: symbol for symbol in drawing.symbols}
    if len(symbols) != len(drawing.symbols) or not nodes.isdisjoint(symbols):
        return False
    drawn_steps = {s.id for s in drawing.symbols if s.kind in STEPS}
    if drawn_steps != steps.keys() or len(steps) != len(chart.steps) or len(transitions) != len(chart.transitions):
        return False
    drawn: list[int] = []
    entries: dict[int, list[int]] = {}
    expressions: list[int] = []
    inline = 0
    for symbol in drawing.symbols:
        if symbol.kind is SymbolKind.TRANSITION:
            members = symbol.transitions or [symbol.id]
            drawn += members
            if symbol.id not in members or not transitions.keys() >= set(members):
                return False
            first = transitions[members[0]]
            if not all(same_drawn(first, transitions[i]) for i in members):
                return False
            if isinstance(first.condition, Expression):
                wires = [c.source for c in symbol.condition.connections] if symbol.condition is not None else []
                expressions += wires
                inline += not wires
            elif symbol.condition is not None:
                return False
        elif symbol.kind is SymbolKind.ACTION_BLOCK:
            owners = {c.source for pin in symbol.inputs for c in pin.connections if c.source in steps}
            if len(owners) != 1:
                return False
            lines = [e.association for e in symbol.entries or () if e.step_action is None]
            entries.setdefault(owners.pop(), []).extend(lines)
        elif symbol.kind in STEPS:
            if (symbol.kind is SymbolKind.MACRO_STEP) != (steps[symbol.id].macro is not None):
                return False
        elif symbol.kind is SymbolKind.JUMP and symbol.target is not None and symbol.target not in symbols:
            return False
    if len(drawn) != len(transitions) or set(drawn) != transitions.keys():
        return False
    # conditions are drawn in one way: all beside their transitions, or all wired to symbols of their own
    if len(set(expressions)) != len(expressions) or 0 < inline < len(expressions):
        return False
    if any(i not in symbols or symbols[i].kind is not SymbolKind.EXPRESSION for i in expressions):
        return False
    return all(entries.get(step.id, []) == [a.id for a in step.actions] for step in chart.steps)


def same_drawn(one: Transition, other: Transition) -> bool:
    """True if one symbol can show both: they differ in nothing but their id and their sources."""
    if one is other:
        return True
    same = {"id": 0, "sources": []}
    return one.model_copy(update=same) == other.model_copy(update=same)


def _linked(chart: SfcNetwork, drawing: Drawing) -> bool:
    links = trace_drawing(drawing).links
    transitions = {t.id: t for t in chart.transitions}
    steps = {step.id for step in chart.steps}
    for symbol in drawing.symbols:
        if symbol.kind is SymbolKind.TRANSITION:
            members = symbol.transitions or [symbol.id]
            found = links[symbol.id]
            if len(found) != len(members):
                return False
            if not all(link_fits(transitions[i], link, steps) for i, link in zip(members, found, strict=True)):
                return False
    return True


def link_fits(transition: Transition, link: Link, steps: Set[int]) -> bool:
    """True if a transition leads from where to where the wires lead, as far as `steps` has these."""
    sources, targets = steps & set(transition.sources), steps & set(transition.targets)
    return sources == set(link.sources) and targets == set(link.targets)


def expressions_are_wired(drawing: Drawing, chart: SfcNetwork, style: DrawingStyle) -> bool:
    """True if most transitions of the drawing show their expressions as symbols of their own."""
    conditions = {t.id: t.condition for t in chart.transitions}
    votes = 0
    for symbol in drawing.symbols:
        if symbol.kind is SymbolKind.TRANSITION:
            condition = conditions.get(symbol.transitions[0] if symbol.transitions else symbol.id)
            if isinstance(condition, Expression):
                votes += 1 if symbol.condition is not None else -1
    return votes > 0 if votes else style.structured


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
