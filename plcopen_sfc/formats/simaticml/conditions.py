"""Conditions that are text, as the networks that GRAPH wants: LAD for Boolean logic, else FBD."""

from __future__ import annotations

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.networks.drawing import draw_fbd_expression, draw_ld_expression
from plcopen_sfc.languages.networks.rules import DrawingRules
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import (
    Block,
    BlockParameters,
    BlockVariable,
    Coil,
    Connection,
    InputPin,
    LogicNetwork,
    OutputPin,
)

_LOGIC = frozenset({n.Operator.AND, n.Operator.OR})


def condition_body(condition: Expression, result: str) -> FbdBody | LdBody | None:
    """The network that ends in the coil `result`; None where there is none for the expression."""
    parsed = parse_expression(condition.text, Dialect.SCL)
    if parsed.tree is None or parsed.problems:
        return None
    tree: n.Expression = parsed.tree
    if condition.negated:
        tree = n.Unary(n.Operator.NOT, n.Parenthesized(tree))
    is_ladder = _is_logic(tree)
    drawn = (draw_ld_expression if is_ladder else draw_fbd_expression)(tree, DrawingRules(Dialect.SCL), first_id=1)
    if any(problem.severity is Severity.ERROR for problem in drawn.problems):
        return None
    nodes = list(drawn.network.nodes)
    outputs = list(drawn.outputs)
    following = max((node.id for node in nodes), default=0) + 1
    if drawn.negated:
        nodes.append(_inverter(following, outputs))
        outputs = [Connection(source=following, pin="OUT")]
        following += 1
    nodes.append(Coil(id=following, variable=result, input=InputPin(connections=outputs)))
    network = LogicNetwork(nodes=nodes)
    return LdBody(networks=[network]) if is_ladder else FbdBody(networks=[network])


def _inverter(number: int, sources: list[Connection]) -> Block:
    """An inverted value in FBD: an AND box with TRUE, whose first input is negated."""
    first = BlockVariable(name="IN1", input=InputPin(connections=sources), negated=True)
    second = BlockVariable(name="IN2", input=InputPin(expression="TRUE"))
    outputs = [BlockVariable(name="OUT", output=OutputPin())]
    return Block(id=number, type_name="AND", parameters=BlockParameters(inputs=[first, second], outputs=outputs))


def _is_logic(tree: n.Expression) -> bool:
    """Whether an expression is made of variables, AND, OR and NOT."""
    if isinstance(tree, n.Parenthesized):
        return _is_logic(tree.inner)
    if isinstance(tree, n.Unary):
        return tree.operator is n.Operator.NOT and _is_logic(tree.operand)
    if isinstance(tree, n.Operation):
        return tree.operator in _LOGIC and all(map(_is_logic, tree.operands))
    return isinstance(tree, n.Name | n.Member | n.Index)
