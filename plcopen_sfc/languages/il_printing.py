"""Statements of structured text as instruction list.

Operands that are no names or constants are in parentheses over several lines (``AND( a`` .. ``)``, IEC 61131-3 ed. 2,
3.2.2), as the editors of CoDeSys 2.3 and CODESYS have them. A condition becomes a jump, unless S and R express it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count

from plcopen_sfc.languages.il import ARITHMETIC, COMPARISONS, LOGIC
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Operator

_WORDS = {operator: word for word, operator in {**LOGIC, **ARITHMETIC, **COMPARISONS}.items() if word != "&"}
_NEGATABLE = frozenset({Operator.AND, Operator.OR, Operator.XOR})
_LEAVES = (n.Name, n.Member, n.Index, n.Literal, n.Address, n.Dereference, n.Peripheral)


class NoInstructionError(ValueError):
    """A part of structured text that instruction list has no words for."""


def statement_instructions(statements: Sequence[n.Statement], labels: Iterator[int] | None = None) -> str:
    """Return instructions that do what statements do. Raises `NoInstructionError`.

    `labels` has the numbers of the labels of jumps, which are those of the whole body.
    """
    writer = _Writer(labels)
    return "\n".join(line for each in statements for line in writer.statement(each))


class _Writer:
    def __init__(self, labels: Iterator[int] | None = None) -> None:
        self._labels = labels or count(1)

    # -- expressions

    def value(self, tree: n.Expression) -> Iterator[str]:
        """Yield the lines that load a value."""
        tree = _bare(tree)
        match tree:
            case n.Unary(operator=Operator.NOT, operand=operand):
                operand = _bare(operand)
                if isinstance(operand, _LEAVES):
                    yield f"LDN {self._text(operand)}"
                else:
                    yield from self.value(operand)
                    yield "NOT"
            case n.Unary(operator=Operator.NEGATE, operand=operand):
                yield "LD 0"
                yield from self._combine("SUB", operand)
            case n.Unary(operand=operand):
                yield from self.value(operand)
            case n.Operation(operator=Operator.POWER, operands=operands):
                yield from self._function("EXPT", operands)
            case n.Operation(operator=operator, operands=operands) if operator in _WORDS:
                yield from self.value(operands[0])
                for operand in operands[1:]:
                    yield from self._combine(_WORDS[operator], operand, may_negate=operator in _NEGATABLE)
            case n.Call(callee=n.Name(identifier=name), arguments=arguments):
                values = [each.value for each in arguments if each.name is None and not each.output]
                if len(values) != len(arguments) or not values or None in values:
                    raise NoInstructionError(f"a call of {name} with names of its inputs")
                yield from self._function(name, [each for each in values if each is not None])
            case _ if isinstance(tree, _LEAVES):
                yield f"LD {self._text(tree)}"
            case _:
                raise NoInstructionError(self._text(tree))

    def _combine(self, word: str, operand: n.Expression, *, may_negate: bool = False) -> Iterator[str]:
        """Yield the lines that combine the current result with an operand."""
        operand = _bare(operand)
        if isinstance(operand, n.Unary) and operand.operator is Operator.NOT and may_negate:
            word, operand = f"{word}N", _bare(operand.operand)
        if isinstance(operand, _LEAVES):
            yield f"{word} {self._text(operand)}"
            return
        first, *rest = self.value(operand)
        yield f"{word}( {first.removeprefix('LD ')}" if first.startswith("LD ") else f"{word}("
        yield from rest if first.startswith("LD ") else [first, *rest]
        yield ")"

    def _function(self, name: str, values: Sequence[n.Expression]) -> Iterator[str]:
        others = [_bare(each) for each in values[1:]]
        if not all(isinstance(each, _LEAVES) for each in others):
            raise NoInstructionError(f"a call of {name} with operands that are calculated")
        yield from self.value(values[0])
        yield " ".join(filter(None, [name, ", ".join(map(self._text, others))]))

    def _text(self, tree: n.Node) -> str:
        return print_node(tree)

    # -- statements

    def statement(self, statement: n.Statement) -> Iterator[str]:
        """Yield the lines of a statement."""
        match statement:
            case n.Assignment(target=target, value=value, kind=n.AssignmentKind.ASSIGN):
                yield from self.value(value)
                yield f"ST {self._text(target)}"
            case n.CallStatement(call=n.Call(callee=callee, arguments=arguments)):
                yield from self._call(callee, arguments)
            case n.ReturnStatement(value=None):
                yield "RET"
            case n.If(branches=(n.Branch(condition, (n.Assignment() as only,)),), otherwise=None) if _stored(only):
                yield from self.value(condition)
                yield f"{_stored(only)} {self._text(only.target)}"
            case n.If(branches=(n.Branch(condition, (n.Goto(label=label),)),), otherwise=None):
                yield from self.value(condition)
                yield f"JMPC {label.identifier}"
            case n.Goto(label=label):
                yield f"JMP {label.identifier}"
            case n.LabelStatement(label=label):
                yield f"{label.identifier}:"
            case n.If(branches=branches, otherwise=otherwise):
                yield from self._choice(branches, otherwise or ())
            case n.Empty():
                return
            case _:
                raise NoInstructionError(self._text(statement).partition("\n")[0])

    def _call(self, callee: n.Expression, arguments: Sequence[n.Argument]) -> Iterator[str]:
        """Yield the call of a block: what is calculated is stored in its inputs first."""
        given: list[n.Argument] = []
        for each in arguments:
            value = _bare(each.value) if each.value is not None else None
            if value is None or isinstance(value, _LEAVES):
                given.append(each)
            elif each.name is None or each.output:
                raise NoInstructionError("a call with operands that are calculated")
            else:
                yield from self.value(value)
                yield f"ST {self._text(n.Member(callee, each.name))}"
        yield f"CAL {self._text(n.Call(callee, tuple(given)) if given else callee)}"

    def _choice(self, branches: Sequence[n.Branch], otherwise: Sequence[n.Statement]) -> Iterator[str]:
        end = f"End{next(self._labels)}"
        for number, branch in enumerate(branches):
            is_last = number == len(branches) - 1 and not otherwise
            behind = end if is_last else f"Else{next(self._labels)}"
            yield from self.value(branch.condition)
            yield f"JMPCN {behind}"
            for each in branch.statements:
                yield from self.statement(each)
            if not is_last:
                yield f"JMP {end}"
                yield f"{behind}:"
        for each in otherwise:
            yield from self.statement(each)
        yield f"{end}:"


def _stored(assigned: n.Assignment) -> str:
    """Return S or R where a variable only gets TRUE or FALSE; else nothing."""
    if assigned.kind is not n.AssignmentKind.ASSIGN or not isinstance(assigned.value, n.Literal):
        return ""
    return {"TRUE": "S", "FALSE": "R"}.get(assigned.value.text.upper(), "")


def _bare(tree: n.Expression) -> n.Expression:
    while isinstance(tree, n.Parenthesized):
        tree = tree.inner
    return tree
