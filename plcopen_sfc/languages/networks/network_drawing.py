"""Text to networks: expressions and statements drawn as FBD or LD."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.languages.networks.drafting import Drafter, Rung
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules
from plcopen_sfc.languages.networks.ladders import LadderDrafter
from plcopen_sfc.languages.networks.results import NetworkProblem
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.network import Connection, Label, LogicNetwork, Node

_MARGIN = 20
_RUNG_GAP = 20


@dataclass(frozen=True, slots=True)
class DrawnFbd:
    """A function block diagram, and what could not be said in it."""

    body: FbdBody
    problems: tuple[NetworkProblem, ...]


@dataclass(frozen=True, slots=True)
class DrawnLd:
    """A ladder diagram, and what could not be said in it."""

    body: LdBody
    problems: tuple[NetworkProblem, ...]


@dataclass(frozen=True, slots=True)
class DrawnExpression:
    """The elements of an expression, the wires that have its value (more than one: it is their OR), and problems.

    `negated`: whoever takes the value must invert it.
    """

    network: LogicNetwork
    outputs: tuple[Connection, ...]
    negated: bool
    problems: tuple[NetworkProblem, ...]


def draw_fbd(
    statements: Iterable[Statement], rules: DrawingRules | None = None, *, first_id: int = 1, divided: bool = False
) -> DrawnFbd:
    """Statements as a function block diagram.

    `divided`: each rung is a network of its own, as in most tools; else all stand on one sheet, as in TC6. The ids of
    elements count from `first_id` and are unique in the body.
    """
    drafter = Drafter(rules or DrawingRules(), first_id)
    with collecting_rarely():
        networks = _sheets(drafter.statements(statements), divided=divided)
        for rungs in networks:
            _stack(rungs, _MARGIN)
        bodies = [LogicNetwork(nodes=[node for rung in rungs for node in rung.nodes]) for rungs in networks]
    return DrawnFbd(FbdBody(networks=bodies), tuple(drafter.problems))


def draw_ld(
    statements: Iterable[Statement], rules: DrawingRules | None = None, *, first_id: int = 1, divided: bool = False
) -> DrawnLd:
    """Statements as a ladder diagram; see `draw_fbd`."""
    drafter = LadderDrafter(rules or DrawingRules(), first_id)
    bodies = []
    with collecting_rarely():
        for rungs in _sheets(drafter.statements(statements), divided=divided):
            left = drafter.start(_MARGIN, _MARGIN)
            right, bottom = _stack(rungs, left)
            nodes = [node for rung in rungs for node in rung.nodes]
            first, last = drafter.finish(nodes, right + _MARGIN, bottom)
            bodies.append(LogicNetwork(nodes=[first, *nodes, last]))
    return DrawnLd(LdBody(networks=bodies), tuple(drafter.problems))


def draw_fbd_expression(
    expression: Expression, rules: DrawingRules | None = None, *, first_id: int = 1
) -> DrawnExpression:
    """An expression as FBD elements whose value somebody else takes: the condition of a transition, a pin."""
    drafter = Drafter(rules or DrawingRules(), first_id)
    item = drafter.value(expression)
    area = item.place(_MARGIN, _MARGIN)
    outputs = tuple(Connection(source=end.source, pin=end.pin) for end in area.ends)
    network = LogicNetwork(nodes=drafter.nodes)
    return DrawnExpression(network, outputs, item.negated, tuple(drafter.problems))


def draw_ld_expression(
    expression: Expression, rules: DrawingRules | None = None, *, first_id: int = 1
) -> DrawnExpression:
    """A Boolean expression as LD elements from a left power rail on; see `draw_fbd_expression`."""
    drafter = LadderDrafter(rules or DrawingRules(), first_id)
    item = drafter.power(expression)
    area = item.place(drafter.start(_MARGIN, _MARGIN), _MARGIN)
    outputs = tuple(Connection(source=end.source, pin=end.pin) for end in area.ends)
    nodes: list[Node] = [drafter.rail(area.bottom), *drafter.nodes]
    return DrawnExpression(LogicNetwork(nodes=nodes), outputs, item.negated, tuple(drafter.problems))


def _sheets(rungs: list[Rung], *, divided: bool) -> list[list[Rung]]:
    """The rungs of each network: a label stands in that of the rung behind it, to which jumps lead."""
    if not divided:
        return [rungs]
    found: list[list[Rung]] = []
    labels: list[Rung] = []
    for rung in rungs:
        labels.append(rung)
        if not all(isinstance(node, Label) for node in rung.nodes):
            found.append(labels)
            labels = []
    return [*found, labels] if labels else found


def _stack(rungs: list[Rung], left: float) -> tuple[float, float]:
    """Place rungs below each other; returns how far they reach to the right and down."""
    right: float = left
    top: float = _MARGIN
    for rung in rungs:
        area = rung.item.place(left, top)
        right, top = max(right, area.right), area.bottom + _RUNG_GAP
    return right, top
