"""Conditions of other tools, as the networks that GRAPH wants: LAD for Boolean logic, else FBD.

An empty network is TRUE for TIA Portal. So a condition that no network says becomes a contact of a variable that
nothing declares: the block can be imported, and does not compile until somebody has programmed the condition.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.networks import NetworkExpression
from plcopen_sfc.languages.networks.drawing import draw_fbd_expression, draw_ld_expression
from plcopen_sfc.languages.networks.rules import DrawingRules
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.conditions import Condition, Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import (
    Block,
    BlockParameters,
    BlockVariable,
    Coil,
    Connection,
    Contact,
    InputPin,
    LeftPowerRail,
    LogicNetwork,
    OutputPin,
)

_LOGIC = frozenset({n.Operator.AND, n.Operator.OR})
NOT_TRANSLATED = "NOT_TRANSLATED"
"""How the variables begin that stand for conditions which could not be written; no block declares them."""


def drawn_condition(
    read: Callable[[Condition], NetworkExpression], condition: Condition, result: str, also: Sequence[str] = ()
) -> FbdBody | LdBody | str:
    """The network that ends in the coil `result`, or why there is none. `also`: what must be TRUE besides."""
    found = read(condition)
    if found.tree is None or found.obstacles:
        return "; ".join(problem.message for problem in found.obstacles) or "it is no expression"
    if found.before:
        return "function blocks or edges stand in it, which a transition of S7-GRAPH cannot have"
    tree = found.tree
    texts = [print_node(_operand_of(tree) if also else tree, Dialect.SCL), *also]
    if isinstance(tree, n.Literal) and tree.text.upper() == "TRUE" and also:
        texts = [*also]
    text = " AND ".join(texts)
    return condition_body(Expression(text=text), result) or f"no network of LAD or FBD says {text}"


def _operand_of(tree: n.Expression) -> n.Expression:
    return n.Parenthesized(tree) if isinstance(tree, n.Operation) else tree


def untranslated_name(label: str) -> str:
    """The variable that stands for the condition of the step or transition `label`; nothing declares it."""
    return re.sub(r"\W+", "_", f"{NOT_TRANSLATED}_{label}").strip("_")


def untranslated_body(result: str, label: str) -> LdBody:
    """A network that does not compile: its contact is a variable that nothing declares."""
    contact = Contact(id=1, variable=f"#{untranslated_name(label)}", input=InputPin(connections=[Connection(source=0)]))
    coil = Coil(id=2, variable=result, input=InputPin(connections=[Connection(source=1)]))
    return LdBody(networks=[LogicNetwork(nodes=[LeftPowerRail(id=0), contact, coil])])


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
