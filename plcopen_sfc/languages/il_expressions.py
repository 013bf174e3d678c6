"""Instructions that only compute a value, such as the condition of a transition, as an expression."""

from __future__ import annotations

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.il import ARITHMETIC, COMPARISONS, LOGIC, Instruction, instructions, opens_parenthesis
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Operator

_OPERATORS = {**LOGIC, **ARITHMETIC, **COMPARISONS}


def result_expression(text: str, dialect: Dialect, *, stored_in: str = "") -> n.Expression | None:
    """Return the current result behind the last instruction; None where there are jumps, calls or stores.

    `stored_in`: the last instruction may store the result in this.
    """
    found = CurrentResult(text)
    *most, last = list(instructions(text, dialect)) or [Instruction("", (0, 0))]
    if last.operator.upper() != "ST" or not _names(last, stored_in):
        most.append(last)
    return found.current if all(found.take(each) for each in most) and not found.waiting else None


def _names(store: Instruction, name: str) -> bool:
    trees = [operand.parsed.tree for operand in store.operands]
    return len(trees) == 1 and isinstance(trees[0], n.Name) and trees[0].identifier.casefold() == name.casefold()


class CurrentResult:
    """The current result of instructions, and the operations whose operands in parentheses are not closed yet."""

    def __init__(self, text: str) -> None:
        self.current: n.Expression | None = None
        self.waiting: list[tuple[str, n.Expression]] = []
        self._text = text

    def take(self, instruction: Instruction) -> bool:
        """Follow an instruction; False if it is one that no expression has."""
        word = instruction.operator.upper()
        trees = [operand.parsed.tree for operand in instruction.operands]
        if instruction.label or any(operand.parsed.problems for operand in instruction.operands):
            return False
        if word in ("LD", "LDN") and len(trees) == 1:
            self.current = negated(trees[0]) if word == "LDN" else trees[0]
            return True
        if self.current is None:
            return False
        if word == "NOT" and not trees:
            self.current = negated(self.current)
        elif word == ")" and self.waiting:
            operator, before = self.waiting.pop()
            self.current = _combined(operator, before, self.current)
        elif word in _OPERATORS or word.removesuffix("N") in LOGIC:
            if opens_parenthesis(self._text, instruction):
                self.waiting.append((word, self.current))
                self.current = trees[0] if trees else None
            else:
                for tree in trees:
                    self.current = _combined(word, self.current, tree)
        elif instruction.is_function:
            arguments = tuple(n.Argument(tree) for tree in (self.current, *trees))
            self.current = n.Call(n.Name(instruction.operator), arguments)
        else:
            return False
        return True


def _combined(word: str, left: n.Expression, right: n.Expression) -> n.Expression:
    if word not in _OPERATORS:
        word, right = word.removesuffix("N"), negated(right)
    return n.Operation(_OPERATORS[word], (left, right))


def negated(tree: n.Expression) -> n.Expression:
    """Return ``NOT tree``."""
    return n.Unary(Operator.NOT, tree)
