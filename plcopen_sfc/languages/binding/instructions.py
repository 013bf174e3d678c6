"""Instruction list as trees that have its effects."""

from __future__ import annotations

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.il import CALLS, JUMPS, STORING, instructions
from plcopen_sfc.languages.st import nodes as n

_RESULT = n.Literal("0")


def instruction_trees(text: str, dialect: Dialect) -> list[n.Expression | n.Statement]:
    """Return a tree for each operand: what writes it, calls it or reads it. Values that are written are not known."""
    trees: list[n.Expression | n.Statement] = []
    for instruction in instructions(text, dialect):
        operator = instruction.operator.upper()
        operands = [operand.parsed.tree for operand in instruction.operands]
        if operator in STORING:
            trees += [n.Assignment(operand, _RESULT) for operand in operands]
        elif operator in CALLS:
            trees += [n.CallStatement(operand) for operand in operands]
        elif instruction.is_function:
            trees.append(n.Call(n.Name(instruction.operator), tuple(n.Argument(operand) for operand in operands)))
        elif operator not in JUMPS:
            trees += operands
    return trees
