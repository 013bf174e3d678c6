"""Conditions of other tools, as the networks that GRAPH wants: LAD for Boolean logic, else FBD.

An empty network is TRUE for TIA Portal. So a condition that no network expresses becomes a contact of an undeclared
variable: the block can be imported, and does not compile until the condition is programmed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from lxml import etree

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.formats.simaticml.box_types import give_condition_types
from plcopen_sfc.formats.simaticml.element_reader import local
from plcopen_sfc.formats.simaticml.element_writer import DocumentWriting, keep_fields
from plcopen_sfc.formats.simaticml.graph_reader import RESULT_OF
from plcopen_sfc.formats.simaticml.lad_fbd_networks import has_all_elements, write_flgnet_body
from plcopen_sfc.formats.simaticml.replaced_elements import WRITTEN, condition_digest
from plcopen_sfc.formats.simaticml.tia_adaptation import mark_constants, network_text, user_constants
from plcopen_sfc.formats.xml.extension_data import Markup, markup_of
from plcopen_sfc.languages.networks import NetworkExpression
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules
from plcopen_sfc.languages.networks.network_drawing import draw_fbd_expression, draw_ld_expression
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.languages.st.walking import transform
from plcopen_sfc.model import network as net
from plcopen_sfc.model.body import FbdBody, LdBody, OpaqueBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import Body, BodyCondition, Condition
from plcopen_sfc.report import Cause, CauseKind, Outcome

_LOGIC = frozenset({n.Operator.AND, n.Operator.OR})
NOT_TRANSLATED = "NOT_TRANSLATED"
"""Prefix of the undeclared variables in place of conditions that could not be written."""


def drawn_condition(
    read: Callable[[Condition], NetworkExpression], condition: Condition, result: str, also: Sequence[str] = ()
) -> FbdBody | LdBody | str:
    """Network that ends in the coil `result`, or why there is none. `also`: expressions that must be TRUE too."""
    found = read(condition)
    if found.tree is None or found.obstacles:
        return "; ".join(problem.message for problem in found.obstacles) or "it is no expression"
    if found.before:
        return "function blocks or edges are in it, which a transition of S7-GRAPH cannot have"
    tree = found.tree
    texts = [print_node(n.Parenthesized(tree) if also and isinstance(tree, n.Operation) else tree), *also]
    if isinstance(tree, n.Literal) and tree.text.upper() == "TRUE" and also:
        texts = [*also]
    text = " AND ".join(texts)
    return condition_body(Expression(text=text), result) or f"no network of LAD or FBD expresses {text}"


def untranslated_name(label: str) -> str:
    """Return the undeclared variable in place of the condition of the step or transition `label`."""
    return re.sub(r"\W+", "_", f"{NOT_TRANSLATED}_{label}").strip("_")


def untranslated_body(result: str, label: str) -> LdBody:
    """Return a network that does not compile: its contact is a variable that nothing declares."""
    contact = net.Contact(
        id=1, variable=f"#{untranslated_name(label)}", input=net.InputPin(connections=[net.Connection(source=0)])
    )
    coil = net.Coil(id=2, variable=result, input=net.InputPin(connections=[net.Connection(source=1)]))
    return LdBody(networks=[net.LogicNetwork(nodes=[net.LeftPowerRail(id=0), contact, coil])])


def condition_body(condition: Expression, result: str) -> FbdBody | LdBody | None:
    """Return the network that ends in the coil `result`; None where there is none for the expression."""
    parsed = parse_expression(condition.text, Dialect.SCL)
    if parsed.tree is None or parsed.problems:
        return None
    tree: n.Expression = parsed.tree
    if condition.negated:
        tree = n.Unary(n.Operator.NOT, n.Parenthesized(tree))
    tree = transform(tree, _without_sign)
    is_ladder = _is_logic(tree)
    drawn = (draw_ld_expression if is_ladder else draw_fbd_expression)(tree, DrawingRules(Dialect.SCL), first_id=1)
    if any(problem.severity is Severity.ERROR for problem in drawn.problems):
        return None
    nodes = list(drawn.network.nodes)
    outputs = list(drawn.outputs)
    following = max((node.id for node in nodes), default=0) + 1
    if drawn.negated:
        nodes.append(_inverter(following, outputs))
        outputs = [net.Connection(source=following, pin="OUT")]
        following += 1
    nodes.append(net.Coil(id=following, variable=result, input=net.InputPin(connections=outputs)))
    network = net.LogicNetwork(nodes=nodes)
    return LdBody(networks=[network]) if is_ladder else FbdBody(networks=[network])


def _without_sign(node: n.Node) -> n.Node:
    """``-x`` as ``0 - x``: there is no box that all versions have for the sign of a value."""
    if isinstance(node, n.Unary) and node.operator is n.Operator.NEGATE and not isinstance(node.operand, n.Literal):
        operand = n.Parenthesized(node.operand) if isinstance(node.operand, n.Operation) else node.operand
        return n.Parenthesized(n.Operation(n.Operator.SUBTRACT, (n.Literal("0"), operand)))
    return node


def _inverter(number: int, sources: list[net.Connection]) -> net.Block:
    """Return an inverted value in FBD: an AND box with TRUE, whose first input is negated."""
    first = net.BlockVariable(name="IN1", input=net.InputPin(connections=sources), negated=True)
    second = net.BlockVariable(name="IN2", input=net.InputPin(expression="TRUE"))
    outputs = [net.BlockVariable(name="OUT", output=net.OutputPin())]
    return net.Block(
        id=number, type_name="AND", parameters=net.BlockParameters(inputs=[first, second], outputs=outputs)
    )


def _is_logic(tree: n.Expression) -> bool:
    """True if an expression is made of variables, AND, OR and NOT."""
    if isinstance(tree, n.Parenthesized):
        return _is_logic(tree.inner)
    if isinstance(tree, n.Unary):
        return tree.operator is n.Operator.NOT and _is_logic(tree.operand)
    if isinstance(tree, n.Operation):
        return tree.operator in _LOGIC and all(map(_is_logic, tree.operands))
    return isinstance(tree, n.Name | n.Member | n.Index)


class ConditionWriter:
    """Writes the networks of conditions; those of other tools with a comment that keeps their source.

    `condition_of` reads the drawn conditions of the chart.
    """

    def __init__(self, ctx: DocumentWriting, condition_of: Callable[[Condition], NetworkExpression]) -> None:
        self.ctx = ctx
        self.condition_of = condition_of
        self.constants = user_constants(ctx.project) if markup_of(ctx.project) is not Markup.SIMATICML else []

    def write(self, element: etree._Element, condition: Condition | None, kind: str, also: Sequence[str] = ()) -> None:
        """Write the network of a condition; `also`: expressions that must be TRUE too."""
        result, what = RESULT_OF[kind], f"condition of the {kind.lower()}"
        is_missing = condition is None and kind == "Transition" and not self.ctx.options.of_graph
        if (condition is None and not is_missing) or _is_always(condition):
            body: Body = empty_network(result)
            if also:
                body = condition_body(Expression(text=" AND ".join(also)), result) or body
        elif isinstance(condition, BodyCondition) and not condition.negated and _is_flgnet(condition, result):
            body = condition.body
            write_flgnet_body(self.ctx, element, body)
            return
        else:
            drawn = (
                drawn_condition(self.condition_of, condition, result, also)
                if condition is not None
                else "the transition has no condition"
            )
            if isinstance(drawn, FbdBody):
                reasons = [give_condition_types(each, self.ctx.types) for each in drawn.networks]
                drawn = next((reason for reason in reasons if reason is not None), drawn)
            if not isinstance(drawn, str) and not has_all_elements(self.ctx, drawn):
                drawn = "TIA Portal does not have all elements of its network"
            if isinstance(drawn, str):
                label = self.ctx.place[-1].partition(" ")[2] if self.ctx.place else ""
                body = untranslated_body(result, label)
                name = untranslated_name(label)
                why = f"the undeclared name {name} is in its place, and the block does not compile: {drawn}"
                self.ctx.note(Outcome.NOT_EXECUTED, what, why=why, cause=Cause(CauseKind.PLACEHOLDER, name))
            else:
                body = drawn
                for network in drawn.networks:
                    mark_constants(network, network_text(network), self.constants)
                self.ctx.note(Outcome.TRANSLATED, what, why=f"a network of {drawn.language}")
        plain = isinstance(condition, Expression) and condition.text == "TRUE" and condition.extension_data is None
        is_without = condition is None and kind == "Transition" and not self.ctx.options.same
        if also or is_without or (condition is not None and not plain):
            source = condition.model_dump(mode="json", exclude_none=True) if condition is not None else None
            self.write_instead(element, body, source)
        else:
            write_flgnet_body(self.ctx, element, body)

    def write_instead(self, element: etree._Element, body: Body, source: object) -> None:
        """Write a network in place of a condition of the source, which a comment before it keeps."""
        place = len(element)
        write_flgnet_body(self.ctx, element, body)
        result = RESULT_OF[local(element)]
        keep_fields(element, {"condition": source, WRITTEN: condition_digest(element, result)})
        element.insert(place, element[-1])


def empty_network(result: str) -> LdBody:
    """Return the network that LAD shows for no condition: the rail leads to the coil."""
    coil = net.Coil(id=1, variable=result, input=net.InputPin(connections=[net.Connection(source=0)]))
    return LdBody(networks=[net.LogicNetwork(nodes=[net.LeftPowerRail(id=0), coil])])


def _is_flgnet(condition: BodyCondition, result: str) -> bool:
    """True if the body of a condition can be a network of GRAPH as it is."""
    body = condition.body
    if isinstance(body, OpaqueBody):
        return body.source == "simaticml"
    if body.language not in ("LD", "FBD"):
        return False
    return condition.name == result or any(
        isinstance(node, net.Coil) and node.variable in RESULT_OF.values()
        for network in getattr(body, "networks", [])
        for node in network.nodes
    )


def _is_always(condition: Condition | None) -> bool:
    return isinstance(condition, Expression) and not condition.negated and condition.text.strip().upper() == "TRUE"
