"""Conditions and actions in one line of text, as an engineer would note them."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.languages.networks import condition_expression
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.model.actions import ActionAssociation, Qualifier
from plcopen_sfc.model.body import Body, FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.conditions import BodyCondition, Condition, Expression, NamedCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import (
    Block,
    Contact,
    Edge,
    InOutVariable,
    InputPin,
    InputVariable,
    LeftPowerRail,
    Node,
)
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition

__all__ = ["Wording"]

_OPERATORS = frozenset({"AND", "OR", "XOR"})
_DEEPEST = 12


class Wording:
    """Words for the elements of one chart."""

    def __init__(self, chart: SfcNetwork, dialect: Dialect = Dialect.IEC) -> None:
        self._chart = chart
        self._dialect = dialect
        self._nodes: dict[int, Node] = {node.id: node for node in chart.logic}
        self._steps = {step.id: step.name for step in chart.steps}

    def condition(self, condition: Condition | None) -> str:
        """A condition; empty where there is none."""
        if condition is None:
            return ""
        if isinstance(condition, Expression):
            text = _one_line(condition.text)
        elif isinstance(condition, NamedCondition):
            text = condition.name
        elif isinstance(condition, BodyCondition):
            text = self._network(condition) or condition.name or _body(condition.body)
        else:
            text = self._wired(condition.input, 0)
        return _negated(text, condition.negated)

    def _network(self, condition: BodyCondition) -> str:
        """A condition in FBD or LD as an expression; empty where it takes more than one."""
        if not isinstance(condition.body, FbdBody | LdBody):
            return ""
        alone = Transition(id=0, condition=condition.model_copy(update={"negated": False}))
        read = condition_expression(self._chart, alone, self._dialect)
        return "" if read.tree is None or read.before else _one_line(print_node(read.tree, self._dialect))

    def actions(self, step: Step) -> Iterator[str]:
        """What a step does: step actions and associations, each as ``N Motor`` or ``D T#2s Lamp``."""
        named = (("entry", step.entry_action), ("main", step.main_action), ("exit", step.exit_action))
        for label, action in named:
            if action:
                yield f"{label} {action if isinstance(action, str) else _body(action)}"
        for association in step.actions:
            yield _association(association)
        if step.macro is not None:
            yield f"macro {step.macro.expansion or ''}".strip()

    def _wired(self, pin: InputPin, depth: int) -> str:
        """The expression that is drawn at a pin: wires that meet there are alternatives."""
        texts = [self._source(connection.source, connection.pin, depth) for connection in pin.connections]
        if not texts:
            return pin.expression or "(not wired)"
        return texts[0] if len(texts) == 1 else "(" + " OR ".join(texts) + ")"

    def _source(self, source: int, pin: str | None, depth: int) -> str:
        node = self._nodes.get(source)
        if depth > _DEEPEST:
            return "(logic)"
        if isinstance(node, Contact):
            own = _negated(_edge(node.variable, node.edge), node.negated)
            before = self._wired(node.input, depth + 1) if node.input is not None and node.input.connections else ""
            return own if before in {"", "TRUE"} else f"{before} AND {own}"
        if isinstance(node, InputVariable):
            return _negated(_edge(_one_line(node.expression), node.edge), node.negated)
        if isinstance(node, InOutVariable):
            return _one_line(node.expression)
        if isinstance(node, LeftPowerRail):
            return "TRUE"
        if isinstance(node, Block):
            return self._block(node, pin, depth)
        return f"{self._steps[source]}.X" if source in self._steps else "(logic)"

    def _block(self, block: Block, pin: str | None, depth: int) -> str:
        if block.instance:
            return f"{block.instance}.{pin}" if pin else block.instance
        inputs = [
            _negated(self._wired(each.input, depth + 1), each.negated)
            for each in block.parameters.inputs
            if each.input is not None
        ]
        if block.type_name.upper() in _OPERATORS:
            return "(" + f" {block.type_name.upper()} ".join(inputs) + ")"
        return f"{block.type_name}({', '.join(inputs)})"


def _association(association: ActionAssociation) -> str:
    qualifier = "" if association.qualifier is Qualifier.NONE else association.qualifier.value
    event = association.event.value if association.event is not None else ""
    what = association.target or (_body(association.body) if association.body is not None else "")
    if association.value is not None:
        what = f"{what} := {_one_line(association.value)}"
    if association.forcing is not None:
        order = association.forcing
        what = f"{order.chart}{{{', '.join(order.steps)}}}" if order.steps else f"{order.chart} {order.situation.value}"
    return " ".join(filter(None, (event, qualifier, association.duration, _negated(what, association.negated))))


def _body(body: Body) -> str:
    """A body: its text where that is short, else its language."""
    if isinstance(body, StBody | IlBody):
        text = _one_line(body.text)
        if text and len(text) <= 60:
            return f"{{{text}}}"
    return f"({body.language})"


def _negated(text: str, negated: bool) -> str:
    if not negated:
        return text
    simple = text.startswith("(") or text.replace("_", "").replace(".", "").isalnum()
    return f"NOT {text}" if simple else f"NOT ({text})"


def _edge(text: str, edge: Edge) -> str:
    return text if edge is Edge.NONE else f"{edge.value} edge of {text}"


def _one_line(text: str) -> str:
    return " ".join(text.split())
