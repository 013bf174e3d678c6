"""Upkeep of the drawings of a project: every chart gets a drawing that fits it before a writer needs it.

An edit of a chart changes what it concerns in the drawing, and nothing else. The chart is drawn a second time beside
its drawing, and both are cut into clusters of wires. Between steps and transitions lie bars and jumps; what hangs
together by wires, without passing through a step or transition, is a cluster: the outputs of some steps with the inputs
of the transitions they lead to, or the outputs of some transitions with the inputs of the steps they lead to. Where a
transition leads from depends on one cluster only, and where it leads to on one.

A cluster in which a transition leads from or to other steps than it did is *stale*, and with it every cluster of the
one drawing that shares a step or transition with a stale cluster of the other. Stale clusters are taken from the new
drawing, all others stay as they are, symbol by symbol. New steps, transitions, bars and jumps go behind the symbol they
follow in the new drawing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from plcopen_sfc.drawing.added_branches import with_added_branches
from plcopen_sfc.drawing.attached_symbols import AttachedSymbols, block_owner, draw_step_actions, erase_step_actions
from plcopen_sfc.drawing.drawing_style import (
    DrawingStyle,
    expressions_are_wired,
    fits,
    in_order,
    is_structured,
    link_fits,
)
from plcopen_sfc.drawing.new_drawing import Pen, draw, highest_id, sketch
from plcopen_sfc.drawing.symbol_layout import has_positions, layout, place_nearby
from plcopen_sfc.grouping import Clusters, grouped
from plcopen_sfc.model.drawing import BARS, DIVERGENCES, STEPS, Drawing, Places, Symbol, SymbolKind
from plcopen_sfc.model.network import InputPin, OutputPin
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, BodyCondition, Condition, SfcBody, SfcNetwork
from plcopen_sfc.model.wiring import trace_drawing
from plcopen_sfc.reachability import reached

_TWO_SIDED = STEPS | {SymbolKind.TRANSITION}


def input_side(number: int) -> int:
    """Return the input side of a symbol. A bar or jump has no other."""
    return 2 * number


def output_side(number: int) -> int:
    """Return the output side of a step or transition."""
    return 2 * number + 1


class WireClusters:
    """Clusters of a list of symbols. Sides of steps and transitions, bars and jumps are its members.

    `jumps_apart`: a wire from a jump joins nothing. CODESYS ends a branch that jumps at the convergence of the others.
    """

    def __init__(self, symbols: Iterable[Symbol], *, jumps_apart: bool) -> None:
        symbols = list(symbols)
        kinds = {symbol.id: symbol.kind for symbol in symbols}
        sides: list[int] = []
        for symbol in symbols:
            if symbol.kind in _TWO_SIDED:
                sides += [input_side(symbol.id), output_side(symbol.id)]
            elif symbol.kind in BARS or symbol.kind is SymbolKind.JUMP:
                sides.append(input_side(symbol.id))
        self._sides = Clusters(sides)
        for symbol in symbols:
            if input_side(symbol.id) not in self._sides:
                continue
            for pin in symbol.inputs:
                for connection in pin.connections:
                    kind = kinds.get(connection.source)
                    if kind is SymbolKind.JUMP and jumps_apart:
                        continue
                    side = output_side(connection.source) if kind in _TWO_SIDED else input_side(connection.source)
                    if side in self._sides:
                        self._sides.unite((input_side(symbol.id), side))
            if symbol.kind is SymbolKind.JUMP and symbol.target is not None and kinds.get(symbol.target) in BARS:
                self._sides.unite((input_side(symbol.target), input_side(symbol.id)))
        self._members = self._sides.members()

    def around(self, side: int) -> list[int]:
        """Return the cluster of `side`; nothing where the drawing has no such side."""
        return self._members[self._sides.root(side)] if side in self._sides else []


_FIELDS = (
    "position",
    "width",
    "height",
    "execution_order",
    "exclude",
    "local_id",
    "comment",
    "global_id",
    "extension_data",
)


def take_over(
    gone: list[Symbol], fresh: list[Symbol], old: Mapping[int, Symbol], new: Mapping[int, Symbol]
) -> dict[int, int]:
    """Give each of `fresh` what one of `gone` with the same role had, or with most of it. Returns the ids that changed.

    A branch that is drawn elsewhere is the same one: its name, its comment and its exclusion stay.
    """
    before, after = _Roles(old), _Roles(new)
    free = grouped((before.role(symbol), symbol) for symbol in gone)
    pairs: list[tuple[Symbol, Symbol]] = []
    others: list[Symbol] = []
    for symbol in fresh:
        candidates = free.get(after.role(symbol))
        if candidates:
            pairs.append((symbol, candidates.pop(0)))
        elif symbol.kind in DIVERGENCES:
            others.append(symbol)
    left = [symbol for each in free.values() for symbol in each if symbol.kind in DIVERGENCES]
    for symbol in others:
        begun = after.below(symbol)
        shared = [(len(begun & before.below(each)), i) for i, each in enumerate(left) if each.kind is symbol.kind]
        most, place = max(shared, default=(0, 0))
        if most:
            pairs.append((symbol, left.pop(place)))
    numbers = {symbol.id: other.id for symbol, other in pairs}
    for symbol, other in pairs:
        symbol.id = other.id
        for name in _FIELDS:
            setattr(symbol, name, getattr(other, name))
        if symbol.kind in BARS:
            symbol.name = other.name
            if len(symbol.outputs) == len(other.outputs):
                symbol.outputs = other.outputs
    for symbol in new.values():
        for pin in symbol.inputs:
            for connection in pin.connections:
                connection.source = numbers.get(connection.source, connection.source)
    for symbol, other in pairs:
        symbol.inputs = rewired(other.inputs, symbol.inputs)
    return numbers


def rewired(before: list[InputPin], after: list[InputPin]) -> list[InputPin]:
    """Pins `after`, but those of `before` that have the same wires. A pin that gets other wires keeps its place."""
    same = {_wires(pin): pin for pin in reversed(before)}
    pins: list[InputPin] = []
    for position, pin in enumerate(after):
        kept = same.get(_wires(pin))
        if kept is None and len(before) == len(after):
            kept = before[position].model_copy(update={"connections": pin.connections})
        pins.append(kept or pin)
    return pins


def _wires(pin: InputPin) -> tuple[int, ...]:
    return tuple(connection.source for connection in pin.connections)


class _Roles:
    """Roles of the bars and jumps of one drawing: from where or to where they lead."""

    def __init__(self, symbols: Mapping[int, Symbol]) -> None:
        self.symbols = symbols
        self.producers = {i: [c.source for pin in s.inputs for c in pin.connections] for i, s in symbols.items()}
        self.consumers: dict[int, list[int]] = {}
        for consumer, sources in self.producers.items():
            for source in sources:
                self.consumers.setdefault(source, []).append(consumer)

    def role(self, symbol: Symbol) -> object:
        if symbol.kind is SymbolKind.JUMP:
            return symbol.kind, symbol.target, self.reach(symbol.id, self.producers)
        if symbol.kind in DIVERGENCES:
            return symbol.kind, self.reach(symbol.id, self.producers)
        return symbol.kind, self.reach(symbol.id, self.consumers)

    def below(self, divergence: Symbol) -> frozenset[int]:
        """Return the steps and transitions at which the branches of a divergence begin."""
        return self.reach(divergence.id, self.consumers)

    def reach(self, number: int, neighbours: Mapping[int, Iterable[int]]) -> frozenset[int]:
        """Return the steps and transitions next to a bar or jump in one direction; to jumps, what they lead to."""

        def beyond(other: int) -> Iterable[int]:
            is_passed = other == number or self.symbols[other].kind in BARS
            return (each for each in neighbours.get(other, ()) if each in self.symbols) if is_passed else ()

        symbols = [self.symbols[other] for other in reached([number], beyond) if other != number]
        ends = (-1 if each.target is None else each.target for each in symbols if each.kind is SymbolKind.JUMP)
        return frozenset([*ends, *(each.id for each in symbols if each.kind not in BARS | {SymbolKind.JUMP})])


_FLOW = BARS | {SymbolKind.JUMP}


def redraw(chart: SfcNetwork, style: DrawingStyle) -> None:
    """Make the drawing of `chart` fit it, changing as little as possible. A chart without a drawing gets one."""
    old = chart.drawing
    if old is None or len({symbol.id for symbol in old.symbols}) != len(old.symbols):
        chart.drawing = draw(chart, style)
    elif not fits(chart, style) and (added := with_added_branches(chart, old, style)) is not None:
        chart.drawing = added
    elif not fits(chart, style):
        _Redrawing(chart, old, style).run()
        if not fits(chart, style):  # ids that the chart and its drawing use for different things
            chart.drawing = draw(chart, style)


class _Redrawing:
    def __init__(self, chart: SfcNetwork, old: Drawing, style: DrawingStyle) -> None:
        self.chart = chart
        self.drawing = old
        self.old = {symbol.id: symbol for symbol in old.symbols}
        self.wired = expressions_are_wired(old, chart, style)
        pen = Pen(style, highest_id(chart, drawn=True) + 1, wired=self.wired)
        together = {i: s.id for s in old.symbols if s.kind is SymbolKind.TRANSITION for i in s.transitions or ()}
        symbols = sketch(chart, pen, together)
        self.new = {symbol.id: symbol for symbol in symbols}
        self.reorder = style.structured and not in_order(chart, old)

    def run(self) -> None:
        """Put the drawing together from what stays and what is new."""
        for apart in (True, False):
            clusters = [WireClusters(each.values(), jumps_apart=apart) for each in (self.old, self.new)]
            stale = self.stale(*clusters)
            fresh = [s for i, s in self.new.items() if s.kind in _FLOW and input_side(i) in stale]
            if all(each.kind is SymbolKind.JUMP for each in fresh):
                break  # else branches may end together that did not, which must be drawn together
        kept = {i for i in self.old if self.keeps(i, stale)}
        gone = [s for i, s in self.old.items() if s.kind in _FLOW and i not in kept]
        unused = {i for i, s in self.new.items() if s.kind in _FLOW and input_side(i) not in stale}
        take_over(gone, fresh, self.old, self.new)
        self.new = {symbol.id: symbol for i, symbol in self.new.items() if i not in unused}
        symbols = {i: self.old[i] for i in kept}
        for number, symbol in self.new.items():
            if symbol.kind in _FLOW:
                symbols[number] = symbol
            elif symbol.kind in STEPS or symbol.kind is SymbolKind.TRANSITION:
                if number in kept:
                    self.update(self.old[number], symbol, rewire=input_side(number) in stale)
                else:
                    symbols[number] = symbol
        self.follow_jumps(symbols, [each for each in gone if each.kind is SymbolKind.JUMP])
        parts = AttachedSymbols(self.chart, self.old, self.new, symbols, wired=self.wired)
        parts.settle()
        self.arrange(symbols, parts.kept_for)

    def follow_jumps(self, symbols: Mapping[int, Symbol], gone: Iterable[Symbol]) -> None:
        """Lead wires from jumps that are gone to those that are drawn in their place, or take them out."""
        drawn = [each for i, each in symbols.items() if each.kind is SymbolKind.JUMP and i not in self.old]
        again: dict[int, int | None] = {}
        for jump in (each for each in gone if each.id not in symbols):
            found = next((each for each in drawn if each.target == jump.target and each.id not in again.values()), None)
            again[jump.id] = found.id if found is not None else None
        for symbol in symbols.values():
            wires = [connection for pin in symbol.inputs for connection in pin.connections]
            if again.keys().isdisjoint(each.source for each in wires):
                continue
            for each in wires:
                each.source = again.get(each.source, each.source) or each.source
            for pin in symbol.inputs:
                pin.connections = [each for each in pin.connections if each.source not in again]
            symbol.inputs = [pin for pin in symbol.inputs if pin.connections]

    def update(self, present: Symbol, symbol: Symbol, *, rewire: bool) -> None:
        """Let a step or transition that stays follow its chart."""
        if present.kind is not symbol.kind:
            present.kind = symbol.kind
        if present.transitions != symbol.transitions:
            present.transitions = symbol.transitions
        if rewire:
            present.inputs = rewired(present.inputs, symbol.inputs)

    def keeps(self, number: int, stale: set[int]) -> bool:
        """True if a symbol of the old drawing stays. Action blocks and expressions follow what they belong to."""
        symbol = self.old[number]
        if symbol.kind in _FLOW:
            return input_side(number) not in stale
        if symbol.kind in STEPS:
            return number in self.new and self.new[number].kind in STEPS
        if symbol.kind is SymbolKind.TRANSITION:
            return number in self.new and self.new[number].kind is SymbolKind.TRANSITION
        return False

    def stale(self, old: WireClusters, new: WireClusters) -> set[int]:
        """Return the sides of symbols in all stale clusters of both drawings."""
        return reached(self.changed(old), lambda side: [*old.around(side), *new.around(side)])

    def changed(self, old: WireClusters) -> list[int]:
        """Return the sides of steps and transitions at which the chart differs from the old drawing."""
        transitions = {t.id: t for t in self.chart.transitions}
        steps = {step.id for step in self.chart.steps}
        links = trace_drawing(self.drawing).links
        sides: list[int] = []
        for number, symbol in self.new.items():
            if symbol.kind in STEPS:
                before = self.old.get(number)
                if before is None or before.kind not in STEPS:
                    sides += (input_side(number), output_side(number))
            elif symbol.kind is SymbolKind.TRANSITION:
                before = self.old.get(number)
                members = [transitions[i] for i in symbol.transitions or [number]]
                # Links are compared, not wires: a wire with a detour that someone has drawn is as good as a straight
                # one.
                found = links.get(number, [])
                same = before is not None and (before.transitions or [number]) == [t.id for t in members]
                if not same or len(found) != len(members) or self.reorder:
                    sides += (input_side(number), output_side(number))
                elif not all(link_fits(t, link, steps) for t, link in zip(members, found, strict=True)):
                    # only the side that differs is drawn again; the wires of the other one stay where they are
                    if any({*t.sources} & steps != set(f.sources) for t, f in zip(members, found, strict=True)):
                        sides.append(input_side(number))
                    if any({*t.targets} & steps != set(f.targets) for t, f in zip(members, found, strict=True)):
                        sides.append(output_side(number))
        for number, symbol in self.old.items():
            if symbol.kind in STEPS or symbol.kind is SymbolKind.TRANSITION:
                if number not in self.new or (self.new[number].kind in STEPS) != (symbol.kind in STEPS):
                    sides += old.around(input_side(number)) + old.around(output_side(number))
            elif symbol.kind is SymbolKind.JUMP and symbol.target is not None and symbol.target not in self.new:
                target = self.old.get(symbol.target)
                if target is None or target.kind in STEPS:
                    sides.append(input_side(number))
        return sides

    def arrange(self, symbols: dict[int, Symbol], kept_for: dict[int, int]) -> None:
        """Put the symbols in order: old ones as they were, new ones behind those they follow in the new drawing."""
        names = [kept_for.get(i, i) for i in self.new]
        sequence = [i for i in (names if self.reorder else self.old) if i in symbols]
        present = set(sequence)
        owners = {c.source: s.id for s in symbols.values() if s.condition is not None for c in s.condition.connections}
        before: dict[int, list[int]] = {}
        after: dict[int | None, list[int]] = {}
        followed: dict[int, int | None] = {}
        anchor: int | None = None
        for number in names:
            if number not in symbols:
                continue
            if number not in present:
                symbol, ahead = symbols[number], anchor
                if symbol.kind is SymbolKind.EXPRESSION and owners.get(number) in present:
                    before.setdefault(owners[number], []).append(number)
                elif symbol.kind is SymbolKind.ACTION_BLOCK:
                    ahead = block_owner(symbol, symbols)
                    after.setdefault(ahead, []).insert(0, number)
                else:
                    after.setdefault(ahead, []).append(number)
                followed[number] = ahead
            anchor = number
        # a stack: old symbols in their order, behind each the new ones that follow it, and those that follow these
        order: dict[int, None] = {}
        pending: list[int | None] = [*reversed(sequence), None]
        while pending:
            one = pending.pop()
            if one is not None:
                order.update(dict.fromkeys(before.get(one, ())))
                order[one] = None
            pending += reversed(after.get(one, ()))
        order.update(dict.fromkeys(symbols))
        drawing = self.drawing
        placed = has_positions(drawing)
        drawing.symbols = [symbols[i] for i in order]
        if drawing.order is not None:
            nodes = {node.id for node in self.chart.logic}
            drawing.order = _merged(drawing.order, list(order), nodes)
        if placed:
            place_nearby(self.chart, {i: followed.get(i) for i in order if i not in self.old})


def _merged(before: list[int], symbols: list[int], nodes: set[int]) -> list[int]:
    """Return the order of symbols and logic: logic stays behind the symbol that it was behind."""
    place: dict[int | None, list[int]] = {}
    present = set(symbols)
    last: int | None = None
    for number in before:
        if number in present:
            last = number
        elif number in nodes:
            place.setdefault(last, []).append(number)
    order = list(place.get(None, ()))
    for number in symbols:
        order += (number, *place.get(number, ()))
    return order


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


def prepare(
    project: Project,
    style: DrawingStyle,
    *,
    positions: bool,
    replace: bool = False,
    foreign: bool = False,
) -> None:
    """Draw what is not drawn, and bring up to date what no longer fits, in every body of a project."""
    for _, _, body in project.bodies():
        prepare_body(body, style, positions=positions, replace=replace, foreign=foreign)


def prepare_body(
    body: Body,
    style: DrawingStyle,
    *,
    positions: bool,
    replace: bool = False,
    foreign: bool = False,
) -> None:
    """Draw what is not drawn, and bring up to date what no longer fits, in the charts of one body.

    `positions`: charts whose drawing has no places get them. `replace`: drawings that fit are replaced too.
    `foreign`: drawings in another style than a structured one that is asked for are replaced.
    """
    for chart in charts_in(body):
        if style.structured:
            erase_step_actions(chart)
            forget_places(chart)
        drawn = replace or chart.drawing is None or (style.structured and foreign and not is_structured(chart))
        if drawn:
            chart.drawing = draw(chart, style)
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
        inner += [a for a in step.step_actions.values() if not isinstance(a, str)]
        inner += [_body_of(part.condition) for part in (step.interlock, step.supervision) if part is not None]
        for association in step.actions:
            inner += [association.body, _body_of(association.condition)]
    inner += [_body_of(transition.condition) for transition in chart.transitions]
    inner += [operation.body for operation in (*chart.permanent_pre, *chart.permanent_post)]
    inner += [part.chart for part in chart.partial_charts]
    return inner


def _body_of(condition: Condition | None) -> Body | None:
    return condition.body if isinstance(condition, BodyCondition) else None
