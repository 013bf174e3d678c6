"""Instructions of a body as statements, for tools that have no instruction list.

The current result is an expression that is written where it is stored or asked for. So it must still mean the same
there: what it reads may not have been written since it was computed, unless it is what was stored last.
"""

from __future__ import annotations

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.il import CALLS, Instruction, instructions
from plcopen_sfc.languages.il_expressions import CurrentResult, negated
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk

_OF_BLOCKS = frozenset({"S1", "R1", "CLK", "CU", "CD", "PV", "IN", "PT"})
"""Operators that are inputs of a function block in IEC 61131-3 (ed. 2, table 54): another word is a function."""


def statements(text: str, dialect: Dialect) -> n.Statements | None:
    """Return the statements that do what the instructions do; None where there are jumps, or where none are known."""
    found = _Statements(text)
    if all(found.follow(each) for each in instructions(text, dialect)) and not found.result.waiting:
        return n.Statements(tuple(found.statements))
    return None


class _Statements:
    def __init__(self, text: str) -> None:
        self.result = CurrentResult(text)
        self.statements: list[n.Statement] = []

    def follow(self, instruction: Instruction) -> bool:
        """Follow an instruction; False if it is one that no statement has."""
        word = instruction.operator.upper()
        trees = [operand.parsed.tree for operand in instruction.operands]
        if instruction.label or any(operand.parsed.problems for operand in instruction.operands):
            return False
        if word in ("ST", "STN", "S", "R"):
            return len(trees) == 1 and self._store(word, trees[0])
        if word in CALLS:
            return len(trees) == 1 and self._call(word, trees[0])
        if word in ("RET", "RETC", "RETCN"):
            return self._when(word.removeprefix("RET"), n.Return())
        return word not in _OF_BLOCKS and self.result.take(instruction)

    def _store(self, word: str, target: n.Expression) -> bool:
        current = self.result.current
        if current is None:
            return False
        if word in ("S", "R"):
            value = n.Literal("TRUE" if word == "S" else "FALSE")
            stored = self._when("C", n.Assignment(target, value))
        else:
            self.statements.append(n.Assignment(target, negated(current) if word == "STN" else current))
            stored = True
        if _names(target) & _names(current):
            # what was stored is the result itself; after another write it would be computed from other values
            self.result.current = target if word == "ST" and isinstance(target, n.Name) else None
        return stored and self._outlives(_names(target))

    def _call(self, word: str, call: n.Expression) -> bool:
        done = self._when(word.removeprefix("CAL"), n.CallStatement(call))
        if self.result.current is not None and _names(call) & _names(self.result.current):
            self.result.current = None
        return done and self._outlives(_names(call))

    def _outlives(self, written: frozenset[str]) -> bool:
        """True if no operation that waits for its operand in parentheses reads what was written."""
        return not any(written & _names(before) for _, before in self.result.waiting)

    def _when(self, suffix: str, statement: n.Statement) -> bool:
        """Write what happens always, or only if the current result is TRUE (C) or FALSE (CN)."""
        current = self.result.current
        if not suffix:
            self.statements.append(statement)
            return True
        if current is None:
            return False
        condition = current if suffix == "C" else negated(current)
        self.statements.append(n.If((n.Branch(condition, (statement,)),)))
        return True


def _names(tree: n.Node) -> frozenset[str]:
    return frozenset(node.identifier.casefold() for node in walk(tree) if isinstance(node, n.Name))
