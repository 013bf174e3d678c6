"""What a text is for somebody who draws it: a constant, Boolean, a call with pins, harmless."""

from __future__ import annotations

from collections.abc import Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.effects import is_variable
from plcopen_sfc.languages.st.nodes import Expression, Operator
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.languages.standard_blocks import StandardBlock, operator_block, standard_block

_RISKY = frozenset({Operator.DIVIDE, Operator.MODULO, Operator.POWER})


def constant_of(expression: Expression) -> bool | None:
    """The value of TRUE and FALSE; None for what is neither."""
    text = n.bare(expression)
    if isinstance(text, n.Literal) and text.text.upper() in ("TRUE", "FALSE"):
        return text.text.upper() == "TRUE"
    return None


def is_boolean_result(expression: Expression) -> bool | None:
    """Whether what is no variable is of type BOOL; None: unknown."""
    if isinstance(expression, n.Literal):
        return expression.text.upper().removeprefix("BOOL#") in ("TRUE", "FALSE")
    block = None
    if isinstance(expression, n.Operation | n.Unary):
        block = operator_block(expression.operator)
    elif isinstance(expression, n.Call) and isinstance(expression.callee, n.Name):
        block = standard_block(expression.callee.identifier)
        if block is None:
            return None
    known = {"BOOL": True, "ANY": None, "ANY_BIT": None, "ANY_ELEMENTARY": None}
    return known.get(block.result.type, False) if block is not None else None


def by_name(call: n.Call, *, outputs: bool = False) -> bool:
    """Whether all its arguments have names, and so pins; are all inputs, or `outputs` that go to variables too."""
    return all(
        a.name is not None
        and a.value is not None
        and (not a.output or (outputs and not a.negated and is_variable(a.value)))
        for a in call.arguments
    )


def is_power(block: StandardBlock, name: str) -> bool:
    """Whether an input is of type BOOL."""
    iec = block.input_name(name)
    return any(pin.name == iec and pin.type == "BOOL" for pin in block.inputs)


def is_harmless(expression: Expression) -> bool:
    """Whether its operands may be evaluated though their operation is not enabled: none can fail or do anything."""
    inner = n.bare(expression)
    operands: Sequence[n.Node] = (inner,)
    if isinstance(inner, n.Operation):
        operands = inner.operands
    elif isinstance(inner, n.Call) and not is_variable(inner):
        operands = inner.arguments
    return not any(
        isinstance(node, n.Call | n.Index | n.Dereference | n.EmbeddedCode | n.Unreadable | n.AssignmentExpression)
        or (isinstance(node, n.Operation) and node.operator in _RISKY)
        for operand in operands
        for node in walk(operand)
    )
