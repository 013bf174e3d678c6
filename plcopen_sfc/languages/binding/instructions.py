"""Effects of instruction list."""

from __future__ import annotations

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.il import CALLS, JUMPS, STORING, instructions
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.effects import Effects, effects


def effects_of_instructions(text: str, dialect: Dialect) -> Effects:
    """Return what the instructions of a body read, write and call."""
    trees: list[n.Expression | n.Statement] = []
    for instruction in instructions(text, dialect):
        operator = instruction.operator.upper()
        operands = [operand.parsed.tree for operand in instruction.operands]
        if operator in STORING:
            trees += [n.Assignment(operand, n.Literal("TRUE")) for operand in operands]
        elif operator in CALLS:
            trees += [n.CallStatement(operand) for operand in operands]
        elif instruction.is_function:
            trees.append(n.Call(n.Name(instruction.operator), tuple(n.Argument(operand) for operand in operands)))
        elif operator not in JUMPS:
            trees += operands
    return effects(trees)
