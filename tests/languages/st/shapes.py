"""Trees in a short form that tests can spell out."""

from __future__ import annotations

from typing import Any

from plcopen_sfc.languages.st.nodes import Address, Literal, Name, Node, Operation, Operator, Unary, Unreadable
from plcopen_sfc.languages.st.walking import parts


def shape(node: Any) -> Any:
    """Names, literals and addresses as text, operators by their sign, all else as ``(Kind, parts ..)``."""
    if isinstance(node, tuple):
        return [shape(item) for item in node]
    if isinstance(node, Name):
        return node.quoting.value + node.identifier
    if isinstance(node, Literal | Address):
        return node.text
    if isinstance(node, Unreadable):
        return ("Unreadable", node.text)
    if isinstance(node, Operation | Unary):
        operands = node.operands if isinstance(node, Operation) else (node.operand,)
        return (node.operator.value, *(shape(operand) for operand in operands))
    if isinstance(node, Node):
        return (type(node).__name__, *(shape(getattr(node, name)) for name in parts(type(node))))
    return node


NOT = Operator.NOT.value
MINUS = Operator.NEGATE.value
