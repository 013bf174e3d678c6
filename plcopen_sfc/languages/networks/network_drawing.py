"""Text to networks: expressions and statements drawn as FBD or LD.

In ladder diagrams AND becomes contacts in series, OR parallel branches; all else becomes blocks between them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.languages.effects import is_repeatable, is_variable, path_of
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules, is_boolean_result
from plcopen_sfc.languages.networks.element_places import (
    GRID,
    ROW,
    Area,
    BlockDraft,
    DrawnItem,
    Slot,
    WireStart,
    connect,
    give_place,
    input_pin,
    output_pin,
    placed,
    text_width,
)
from plcopen_sfc.languages.networks.fbd_drafting import Drafter, Rung
from plcopen_sfc.languages.networks.results import NetworkProblem
from plcopen_sfc.languages.networks.wires import DUALS, TRUE, is_true, joined, normal_form, with_inner_negations
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.languages.standard_blocks import operator_block, standard_block
from plcopen_sfc.model import network as net
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.checked import unchecked

_GAP = 2 * GRID
RAIL_WIDTH = 10

Inflow = Sequence[WireStart] | None
"""Source of power: ends of wires, or None for the left power rail."""


class _Part(NamedTuple):
    """A part of a rung: `place` gives it a position, from where its power comes.

    `line` is how far its power line is below its top.
    """

    line: float
    place: Callable[[float, float, Inflow], Area]


class LadderDrafter(Drafter):
    """Makes the elements of one ladder diagram, between its power rails."""

    def __init__(self, rules: DrawingRules, first_id: int) -> None:
        super().__init__(rules, first_id)
        self._in_block_input = False
        """True while the value of an input pin of a block is drawn: it does not start at the left power rail."""
        self._rail = net.LeftPowerRail(id=0)

    def sink(self, target: Expression, value: Expression, storage: net.Storage) -> DrawnItem:
        """Return a coil where the value is Boolean, else a variable as in FBD."""
        if storage is net.Storage.NONE and not (self._is_boolean(value) or self._is_boolean(target)):
            return super().sink(target, value, storage)
        bare = n.bare(value)
        negated = isinstance(bare, n.Unary) and bare.operator is Operator.NOT and not self._is_contact(bare.operand)
        item = self.power(bare.operand if negated and isinstance(bare, n.Unary) else value)
        text = self._text(target)
        width = text_width(text)
        pin = input_pin(ROW / 2)
        coil = unchecked(
            net.Coil,
            id=self.new_id(),
            variable=text,
            negated=negated != item.negated,
            storage=storage,
            input=pin,
            output=output_pin(width, ROW / 2),
            execution_order=self.new_order(),
        )
        self.nodes.append(coil)
        return placed(coil, (width, ROW), [Slot(pin, ROW / 2, item)], [], ROW / 2)

    def power(self, expression: Expression) -> DrawnItem:
        """Return a Boolean value as contacts that start at the left power rail."""
        if self._in_block_input:
            return super().value(expression)
        part = self._part(with_inner_negations(expression), at_rail=True)
        return DrawnItem(part.line, lambda x, y: part.place(x, y, None))

    def value(self, expression: Expression) -> DrawnItem:
        """As in FBD, but that AND and OR of contacts come from the left power rail."""
        inner = n.bare(expression)
        value = n.bare(inner.operand) if isinstance(inner, n.Unary) and inner.operator is Operator.NOT else inner
        joins = isinstance(value, n.Operation) and value.operator in DUALS
        return self.power(inner) if joins and self._is_boolean(inner) else super().value(inner)

    # -- parts of a rung

    def _part(self, expression: Expression, *, at_rail: bool) -> _Part:
        """Return an expression as a part of a rung. `at_rail`: nothing is before it."""
        inner = n.bare(expression)
        if is_true(inner):
            return _Part(ROW / 2, self._through)
        if isinstance(inner, n.Operation) and inner.operator in DUALS and self._is_boolean(inner):
            flat = joined(inner.operator, inner.operands)
            operands = flat.operands if isinstance(flat, n.Operation) else (flat,)
            if inner.operator is Operator.OR:
                return _parallel([self._branch(operand, at_rail=at_rail) for operand in operands])
            parts = []
            for number, operand in enumerate(operands):
                # power that parts into branches is read once for each of them
                parts.append(
                    self._part(operand, at_rail=at_rail)
                    if not _branches(operand) or all(is_repeatable(normal_form(o)) for o in operands[:number])
                    else self._block_between(operand)
                )
                at_rail = at_rail and is_true(operand)
            return _series(parts)
        negated = isinstance(inner, n.Unary) and inner.operator is Operator.NOT
        variable = n.bare(inner.operand) if isinstance(inner, n.Unary) and negated else inner
        if self._is_contact(variable):
            return self._contact(variable, negated=negated)
        return self._block_at_rail(inner) if at_rail else self._block_between(inner)

    def _branch(self, expression: Expression, *, at_rail: bool) -> _Part:
        """Return an operand of OR. A plain wire would merge with the wires it starts from: it becomes an AND block."""
        if not at_rail and is_true(normal_form(expression)):
            return self._block_between(TRUE)
        return self._part(expression, at_rail=at_rail)

    def _contact(self, variable: Expression, *, negated: bool) -> _Part:
        self._note_reading(variable)
        text = self._text(variable)
        width = text_width(text)
        pin = input_pin(ROW / 2)
        contact = unchecked(
            net.Contact, id=self.new_id(), variable=text, negated=negated, input=pin, output=output_pin(width, ROW / 2)
        )
        self.nodes.append(contact)

        def place(x: float, y: float, inflow: Inflow) -> Area:
            give_place(contact, x, y, (width, ROW))
            row = y + ROW / 2
            connect(pin, (x, row), self._through(x, y, inflow).ends, x)
            return Area((WireStart(contact.id, None, (x + width, row)),), x + width, y + ROW)

        return _Part(ROW / 2, place)

    def _block_at_rail(self, expression: Expression) -> _Part:
        item = self._not_negated(self.value(expression))
        return _Part(item.line, lambda x, y, _inflow: item.place(x, y))

    def _block_between(self, expression: Expression) -> _Part:
        """Return a value that is no contact, joined by an AND block with what comes before it."""
        outside, self._in_block_input = self._in_block_input, True
        item = self.value(expression)
        self._in_block_input = outside
        block = operator_block(Operator.AND)
        assert block is not None  # noqa: S101
        inflow: list[Inflow] = []  # where the power comes from, known when the part is placed
        before = DrawnItem(ROW / 2, lambda x, y: self._through(x, y, inflow[-1]))
        draft = BlockDraft("AND", call=self._call_kind(net.BlockCall.OPERATOR))
        names = [self._pin(block, pin.name) for pin in block.inputs]
        draft.inputs = [(names[0], before), (names[1], item)]
        draft.outputs = [self._pin(block, block.result.name)]
        joint = self._block(draft, draft.outputs[0], acting=False)

        def place(x: float, y: float, ends: Inflow) -> Area:
            inflow.append(ends)
            return joint.place(x, y)

        return _Part(joint.line, place)

    def _through(self, x: float, y: float, inflow: Inflow) -> Area:
        """Return a plain wire."""
        row = y + ROW / 2
        if inflow is None:
            at = (float(RAIL_WIDTH), row - self._rail.position[1])
            self._rail.outputs.append(unchecked(net.OutputPin, name="", position=at))
            ends = [WireStart(self._rail.id, None, (self._rail.position[0] + RAIL_WIDTH, row))]
        else:
            ends = [end if end.at[1] == row else _extended(end, x, row) for end in inflow]
        return Area(tuple(ends), x, y + ROW)

    # -- what is Boolean

    def _is_contact(self, expression: Expression) -> bool:
        inner = n.bare(expression)
        if not is_variable(inner) or self._is_boolean(inner) is False:
            return False
        return not (
            isinstance(inner, n.Member) and path_of(inner.base) in self._pending_calls.keys() - self._started_calls
        )

    def _is_boolean(self, expression: Expression) -> bool | None:
        """True if a value is of type BOOL; None: unknown."""
        inner = n.bare(expression)
        if isinstance(inner, n.Operation | n.Unary) and inner.operator in _LOGIC:
            operands = inner.operands if isinstance(inner, n.Operation) else (inner.operand,)
            return all(self._is_boolean(operand) is not False for operand in operands)
        known = self.rules.booleans.get(self._text(inner).lower()) if is_variable(inner) else None
        if known is not None:
            return known
        if isinstance(inner, n.Member):
            return self._output_is_boolean(inner)
        return is_boolean_result(inner)

    def _output_is_boolean(self, member: n.Member) -> bool | None:
        type_name = self._types.get(path_of(member.base))
        block = standard_block(type_name) if type_name is not None else None
        name = block.output_name(member.name.identifier) if block is not None else None
        return next((pin.type == "BOOL" for pin in block.outputs if pin.name == name), None) if block else None

    # -- the rails

    def start(self) -> float:
        """Draw the left power rail for the rungs that are placed next; return where they may begin."""
        self._rail = unchecked(
            net.LeftPowerRail, id=self.new_id(), position=(float(_MARGIN), float(_MARGIN)), outputs=[]
        )
        return _MARGIN + RAIL_WIDTH + _GAP

    def with_rails(self, nodes: Sequence[net.Node], bottom: float, right: float | None = None) -> list[net.Node]:
        """Return elements, which have their places, behind the left power rail and before a right one at `right`."""
        left, top = self._rail.position
        give_place(self._rail, left, top, (RAIL_WIDTH, bottom - top))
        if right is None:
            return [self._rail, *nodes]
        pins = []
        for coil in (node for node in nodes if isinstance(node, net.Coil)):
            at = (coil.position[0] + (coil.width or 0), coil.position[1] + ROW / 2)
            wire = unchecked(net.Connection, source=coil.id, points=[(float(right), at[1]), at])
            pins.append(unchecked(net.InputPin, position=(0.0, at[1] - top), connections=[wire]))
        rail = unchecked(net.RightPowerRail, id=self.new_id(), inputs=pins)
        give_place(rail, right, top, (RAIL_WIDTH, bottom - top))
        return [self._rail, *nodes, rail]


_LOGIC = n.CONNECTIVES | {Operator.NOT}


def _branches(expression: Expression) -> bool:
    inner = n.bare(expression)
    return isinstance(inner, n.Operation) and inner.operator is Operator.OR


def _extended(end: WireStart, x: float, row: float) -> WireStart:
    """Return the end of a wire, extended to another row."""
    corner = x - GRID
    return end._replace(at=(x, row), route=((corner, row), (corner, end.at[1]), end.at, *end.route))


def _series(parts: Sequence[_Part]) -> _Part:
    line = max(part.line for part in parts)

    def place(x: float, y: float, inflow: Inflow) -> Area:
        bottom = y
        right = x
        for number, part in enumerate(parts):
            area = part.place(right + _GAP if number else x, y + line - part.line, inflow)
            right, bottom, inflow = area.right, max(bottom, area.bottom), area.ends
        return Area(tuple(inflow or ()), right, bottom)

    return _Part(line, place)


def _parallel(parts: Sequence[_Part]) -> _Part:
    def place(x: float, y: float, inflow: Inflow) -> Area:
        ends: list[WireStart] = []
        right, below = x, y
        for part in parts:
            area = part.place(x, below, inflow)
            ends += area.ends
            right, below = max(right, area.right), area.bottom + GRID
        return Area(tuple(ends), right, below - GRID)

    return _Part(parts[0].line, place)


_MARGIN = 20
_RUNG_GAP = 20


AnyBody = TypeVar("AnyBody", FbdBody, LdBody)


@dataclass(frozen=True, slots=True)
class DrawnBody(Generic[AnyBody]):
    """A function block diagram or a ladder diagram, and what could not be expressed in it."""

    body: AnyBody
    problems: tuple[NetworkProblem, ...]


@dataclass(frozen=True, slots=True)
class DrawnExpression:
    """The elements of an expression, the wires that have its value (more than one: it is their OR), and problems.

    `negated`: whoever takes the value must invert it.
    """

    network: net.LogicNetwork
    outputs: tuple[net.Connection, ...]
    negated: bool
    problems: tuple[NetworkProblem, ...]


def draw_fbd(
    statements: Iterable[Statement], rules: DrawingRules | None = None, *, first_id: int = 1, divided: bool = False
) -> DrawnBody[FbdBody]:
    """Return statements as a function block diagram.

    `divided`: each rung is a network of its own, as in most tools; else all are on one sheet, as in TC6. The ids of
    elements count from `first_id` and are unique in the body.
    """
    drafter = Drafter(rules or DrawingRules(), first_id)
    return DrawnBody(FbdBody(networks=_networks(drafter, statements, divided=divided)), tuple(drafter.problems))


def draw_ld(
    statements: Iterable[Statement], rules: DrawingRules | None = None, *, first_id: int = 1, divided: bool = False
) -> DrawnBody[LdBody]:
    """Return statements as a ladder diagram; see `draw_fbd`."""
    drafter = LadderDrafter(rules or DrawingRules(), first_id)
    return DrawnBody(LdBody(networks=_networks(drafter, statements, divided=divided)), tuple(drafter.problems))


def _networks(drafter: Drafter, statements: Iterable[Statement], *, divided: bool) -> list[net.LogicNetwork]:
    networks = []
    with collecting_rarely():
        for rungs in _sheets(drafter.statements(statements), divided=divided):
            ladder = drafter if isinstance(drafter, LadderDrafter) else None
            right, bottom = _stack(rungs, ladder.start() if ladder is not None else _MARGIN)
            nodes = [node for rung in rungs for node in rung.nodes]
            nodes = ladder.with_rails(nodes, bottom, right + _MARGIN) if ladder is not None else nodes
            networks.append(unchecked(net.LogicNetwork, nodes=nodes))
    return networks


def draw_fbd_expression(
    expression: Expression, rules: DrawingRules | None = None, *, first_id: int = 1
) -> DrawnExpression:
    """Return an expression as FBD elements whose value somebody else takes: the condition of a transition, a pin."""
    drafter = Drafter(rules or DrawingRules(), first_id)
    item = drafter.value(expression)
    return _drawn(drafter, item, item.place(_MARGIN, _MARGIN), drafter.nodes)


def draw_ld_expression(
    expression: Expression, rules: DrawingRules | None = None, *, first_id: int = 1
) -> DrawnExpression:
    """Return a Boolean expression as LD elements from a left power rail on; see `draw_fbd_expression`."""
    drafter = LadderDrafter(rules or DrawingRules(), first_id)
    item = drafter.power(expression)
    area = item.place(drafter.start(), _MARGIN)
    return _drawn(drafter, item, area, drafter.with_rails(drafter.nodes, area.bottom))


def _drawn(drafter: Drafter, item: DrawnItem, area: Area, nodes: list[net.Node]) -> DrawnExpression:
    outputs = tuple(net.Connection(source=end.source, pin=end.pin) for end in area.ends)
    return DrawnExpression(net.LogicNetwork(nodes=nodes), outputs, item.negated, tuple(drafter.problems))


def _sheets(rungs: list[Rung], *, divided: bool) -> list[list[Rung]]:
    """Return the rungs of each network: a label belongs to the network of the rung behind it, to which jumps lead."""
    if not divided:
        return [rungs]
    found: list[list[Rung]] = []
    labels: list[Rung] = []
    for rung in rungs:
        labels.append(rung)
        if not all(isinstance(node, net.Label) for node in rung.nodes):
            found.append(labels)
            labels = []
    return [*found, labels] if labels else found


def _stack(rungs: list[Rung], left: float) -> tuple[float, float]:
    """Place rungs below each other; return how far they reach to the right and down."""
    right: float = left
    top: float = _MARGIN
    for rung in rungs:
        area = rung.item.place(left, top)
        right, top = max(right, area.right), area.bottom + _RUNG_GAP
    return right, top
