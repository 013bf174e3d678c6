"""A small machine for the tests: it executes networks directly, and the statements that they become."""

from __future__ import annotations

from functools import reduce
from operator import xor

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import AssignmentKind, Expression, Operator, Statement
from plcopen_sfc.model.network import (
    Block,
    Coil,
    Contact,
    InputPin,
    InputVariable,
    LeftPowerRail,
    LogicNetwork,
    Node,
    OutputVariable,
    Storage,
)

State = dict[str, bool]
Key = tuple[int, str | None]


def evaluate(expression: Expression, state: State) -> bool:
    """The value of a Boolean expression of variables."""
    match n.bare(expression):
        case n.Name(identifier):
            return state[identifier]
        case n.Literal(text):
            return text.upper() == "TRUE"
        case n.Unary(Operator.NOT, operand):
            return not evaluate(operand, state)
        case n.Operation(operator, operands):
            return combine(operator.value, [evaluate(operand, state) for operand in operands])
        case other:
            raise AssertionError(other)


def combine(operation: str, values: list[bool]) -> bool:
    if operation == "NOT":
        return not values[0]
    if operation == "AND":
        return all(values)
    return any(values) if operation == "OR" else reduce(xor, values)


def execute(statements: tuple[Statement, ...], state: State) -> State:
    """The state after statements."""
    for statement in statements:
        match statement:
            case n.Assignment(n.Name(target), value, kind):
                result = evaluate(value, state)
                if kind is AssignmentKind.ASSIGN:
                    state = state | {target: result}
                elif result:
                    state = state | {target: kind is AssignmentKind.SET}
            case n.If((n.Branch(condition, inner),), None):
                if evaluate(condition, state):
                    state = execute(inner, state)
            case other:
                raise AssertionError(other)
    return state


def run(network: LogicNetwork, order: list[int], state: State) -> State:
    """The state after a network whose elements are executed in `order`: each wire has its value from then on."""
    nodes = {node.id: node for node in network.nodes}
    wires: dict[Key, bool] = {}
    for number in order:
        state = _step(nodes[number], wires, state)
    return state


def _at(pin: InputPin | None, wires: dict[Key, bool]) -> bool:
    assert pin is not None
    return any(wires[c.source, c.pin] for c in pin.connections)


def _step(node: Node, wires: dict[Key, bool], state: State) -> State:
    if isinstance(node, LeftPowerRail):
        wires[node.id, None] = True
    elif isinstance(node, InputVariable):
        wires[node.id, None] = evaluate(n.Name(node.expression), state) != node.negated
    elif isinstance(node, Contact):
        wires[node.id, None] = _at(node.input, wires) and state[node.variable] != node.negated
    elif isinstance(node, Block):
        values = [_at(v.input, wires) != v.negated for v in node.parameters.inputs]
        wires[node.id, "OUT"] = combine(node.type_name, values) != node.parameters.outputs[0].negated
    elif isinstance(node, OutputVariable | Coil):
        flow = _at(node.input, wires)
        wires[node.id, None] = flow
        value = flow != node.negated
        name = node.expression if isinstance(node, OutputVariable) else node.variable
        if node.storage is Storage.NONE or value:
            state = state | {name: value if node.storage is Storage.NONE else node.storage is Storage.SET}
    else:
        raise AssertionError(node)
    return state
