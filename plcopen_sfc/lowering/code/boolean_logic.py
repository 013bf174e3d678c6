"""Boolean expressions and statements, made as a person would write them: flat, without needless operands."""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Hashable, Iterable, Mapping, Sequence
from typing import TypeAlias, TypeVar

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform, walk
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement

N = TypeVar("N", bound=n.Node)
TRUE = n.Literal("TRUE")
FALSE = n.Literal("FALSE")
_EQUALITY = frozenset({Operator.EQUAL, Operator.UNEQUAL})


def conjunction(operands: Iterable[Expression]) -> Expression:
    """Return the conjunction, without operands that are TRUE or were there before; TRUE for no operand."""
    return _joined(Operator.AND, operands, neutral=TRUE, absorbing=FALSE)


def disjunction(operands: Iterable[Expression]) -> Expression:
    """Return the disjunction, without operands that are FALSE or were there before; FALSE for no operand."""
    return _joined(Operator.OR, operands, neutral=FALSE, absorbing=TRUE)


def negation(operand: Expression) -> Expression:
    """Return NOT of an expression: of an inverted one the operand, of ``a = b`` ``a <> b``."""
    inner = n.bare(operand)
    if isinstance(inner, n.Unary) and inner.operator is Operator.NOT:
        return inner.operand
    if isinstance(inner, n.Operation):
        # of other numbers that is not so: a REAL that is no number is neither less nor greater
        is_time = any(isinstance(each, n.Member) and each.name.identifier == "ET" for each in inner.operands)
        opposite = n.OPPOSITES.get(inner.operator) if is_time or inner.operator in _EQUALITY else None
        if opposite is not None:
            return n.Operation(opposite, inner.operands)
    if is_constant(inner, TRUE):
        return FALSE
    if is_constant(inner, FALSE):
        return TRUE
    return n.Unary(Operator.NOT, inner)


def not_all(value: Expression) -> Expression:
    """Return NOT of an expression; of a conjunction the disjunction of its inverted operands."""
    inner = n.bare(value)
    if isinstance(inner, n.Operation) and inner.operator is Operator.AND:
        return disjunction(map(negation, inner.operands))
    return negation(inner)


def equal(left: Expression, right: Expression) -> Expression:
    """Return ``left = right``."""
    return n.Operation(Operator.EQUAL, (left, right))


def operands_of(expression: Expression, operator: Operator) -> tuple[Expression, ...]:
    """Return the operands that an operator joins; an expression without it alone."""
    inner = n.bare(expression)
    return inner.operands if isinstance(inner, n.Operation) and inner.operator is operator else (inner,)


def without_constant(statement: Statement) -> Sequence[Statement]:
    """Return an IF without branches that are never executed, or what it always executes; others as they are."""
    if not isinstance(statement, n.If):
        return (statement,)
    kept: list[n.Branch] = []
    otherwise = statement.otherwise
    for branch in statement.branches:
        if is_constant(branch.condition, TRUE):
            otherwise = branch.statements
            break
        if not is_constant(branch.condition, FALSE):
            kept.append(branch)
    if not kept:
        return otherwise or ()
    return (n.If(tuple(kept), otherwise) if len(kept) < len(statement.branches) else statement,)


def simplified(tree: N) -> N:
    """Return the same without parentheses and without operands that are constant."""

    def simpler(node: n.Node) -> n.Node:
        match node:
            case n.Parenthesized(inner):
                return inner
            case n.Unary(Operator.NOT, inner):
                return negation(inner)
            case n.Operation(Operator.AND, operands):
                return conjunction(operands)
            case n.Operation(Operator.OR, operands):
                return disjunction(operands)
        return node

    return transform(tree, simpler)


def with_known(tree: N, selector: Expression, value: n.Node | None, values: Container[n.Node]) -> N:
    """Return the same without comparisons of `selector` with `values`, of which it is `value`; None: none of them."""

    def known(node: n.Node) -> n.Node:
        match node:
            case n.Operation(Operator.EQUAL | Operator.UNEQUAL as operator, (compared, other)):
                if compared == selector and other in values:
                    return TRUE if (other == value) is (operator is Operator.EQUAL) else FALSE
        return node

    return transform(tree, known)


Alternative: TypeAlias = "Callable[[Expression], tuple[Hashable, Hashable] | None]"
"""For an expression what it is one of several values of, only one of which there can be, and which; None for others."""


def one_of_values(values: Collection[Expression]) -> Alternative:
    """Return comparisons with `values` as alternatives: something equals no more than one of them."""

    def compared(operand: Expression) -> tuple[Hashable, Hashable] | None:
        match operand:
            case n.Operation(Operator.EQUAL, (left, right)) if right in values:
                return left, right
        return None

    return compared


def with_distinct(tree: Statement, alternative: Alternative) -> Statement:
    """Return a statement without terms that others decide, as no two values of an alternative are there at once.

    ``s = A AND s <> B`` is ``s = A``, ``s = A AND s = B`` is FALSE.
    """

    def simpler(node: n.Node) -> n.Node:
        if isinstance(node, n.Operation) and node.operator is Operator.OR:
            inside = [n.bare(each) for each in node.operands]
            changed = any(
                is_constant(each, FALSE) or (isinstance(each, n.Operation) and each.operator is Operator.OR)
                for each in inside
            )
            return disjunction(inside) if changed else node
        if not (isinstance(node, n.Operation) and node.operator is Operator.AND):
            return node
        # `s = A` and `(s = A OR s = B)` leave s these values, which decide all other comparisons of s beside them
        known: dict[Hashable, set[Hashable]] = {}
        for operand in node.operands:
            one_of = operands_of(operand, Operator.OR)
            pairs = [pair for each in one_of if (pair := alternative(n.bare(each))) is not None]
            if len(pairs) == len(one_of) and len({key for key, _ in pairs}) == 1:
                ((key, _), *_), values = pairs, {value for _, value in pairs}
                known[key] = known.get(key, values) & values

        def decided(operand: Expression) -> Expression:
            inner = n.bare(operand)
            pair = alternative(inner)
            if pair is not None:
                return operand if pair[1] in known.get(pair[0], {pair[1]}) else FALSE
            match inner:
                case n.Unary(Operator.NOT, negated):
                    choice = n.bare(negated)
                    if isinstance(choice, n.Operation) and choice.operator is Operator.OR:
                        return negation(disjunction(map(decided, choice.operands)))
                case n.Operation(Operator.UNEQUAL, _):
                    pass
                case _:
                    return operand
            excluded = alternative(n.bare(negation(inner)))
            if excluded is not None and excluded[0] in known:
                values = known[excluded[0]]
                if excluded[1] not in values:
                    return TRUE
                return FALSE if values == {excluded[1]} else operand
            return operand

        found = conjunction(map(decided, node.operands)) if known else node
        return found if found != node else node  # the same object: it keeps the text that it has

    return transform(tree, simpler)


def reduced(tree: Expression) -> Expression:
    """Return the same without terms that others decide: of ``a AND (b OR NOT a)`` remains ``a AND b``.

    Functions would be called less often, so nothing with a call is changed.
    """
    if any(isinstance(node, n.Call) for node in walk(tree)):
        return tree
    found, before = simplified(tree), None
    while found != before:  # what falls away lets others decide more; each turn leaves less
        before, found = found, _decided(found, {})
    return found


def _decided(node: Expression, known: Mapping[Expression, bool]) -> Expression:
    """Return an expression as it is where those in `known` have these values."""
    inner = n.bare(node)
    if inner in known:
        return TRUE if known[inner] else FALSE
    if isinstance(inner, n.Unary) and inner.operator is Operator.NOT:
        return negation(_decided(inner.operand, known))
    if not (isinstance(inner, n.Operation) and inner.operator in (Operator.AND, Operator.OR)):
        return node
    # an operand of AND counts while all others are TRUE, one of OR while all others are FALSE
    is_all = inner.operator is Operator.AND
    operands = [*inner.operands]
    # the longest come first, so that a short term remains and decides in them
    for place in sorted(range(len(operands)), key=lambda at: not _is_joined(operands[at])):
        others = (_valued(each, is_all) for at, each in enumerate(operands) if at != place)
        operands[place] = _decided(operands[place], {**known, **dict(others)})
    return _absorbed((conjunction if is_all else disjunction)(operands), is_all)


def _valued(operand: Expression, value: bool) -> tuple[Expression, bool]:
    """Return what an operand inverts, or itself, and the value of that where the operand has `value`."""
    inner = n.bare(operand)
    if isinstance(inner, n.Unary) and inner.operator is Operator.NOT:
        return _valued(inner.operand, not value)
    return inner, value


def _is_joined(operand: Expression) -> bool:
    found, _ = _valued(operand, True)
    return isinstance(found, n.Operation) and found.operator in (Operator.AND, Operator.OR)


def _absorbed(node: Expression, is_all: bool) -> Expression:
    """Return an expression without operands that others contain: ``a OR a AND b`` is ``a``."""
    if not (isinstance(node, n.Operation) and node.operator is (Operator.AND if is_all else Operator.OR)):
        return node
    other = Operator.OR if is_all else Operator.AND
    parts = [
        frozenset(o.operands) if isinstance(o, n.Operation) and o.operator is other else frozenset((o,))
        for o in map(n.bare, node.operands)
    ]
    kept = [o for at, o in enumerate(node.operands) if not any(each < parts[at] for each in parts)]
    return (conjunction if is_all else disjunction)(kept)


def absorbed(node: Expression) -> Expression:
    """Return an expression without operands that others contain, on its first level: ``a AND (a OR b)`` is ``a``.

    Functions would be called less often, so nothing with a call is changed.
    """
    if not isinstance(node, n.Operation) or any(isinstance(each, n.Call) for each in walk(node)):
        return node
    return _absorbed(node, node.operator is Operator.AND)


def names_in(*trees: n.Node) -> list[str]:
    """Return the names of variables in trees, in lower case, each as often as it occurs."""
    return [node.identifier.casefold() for tree in trees for node in walk(tree) if isinstance(node, n.Name)]


def is_constant(expression: Expression, constant: n.Literal) -> bool:
    """Return True if it is the literal TRUE or FALSE, however it is written."""
    inner = n.bare(expression)
    return isinstance(inner, n.Literal) and inner.text.upper().removeprefix("BOOL#") == constant.text


def assignment(target: Expression, value: Expression) -> n.Assignment:
    """Return ``target := value;``."""
    return n.Assignment(target, value)


def call(instance: Expression, **inputs: Expression) -> n.CallStatement:
    """Return the call of a function block instance with inputs by name."""
    arguments = tuple(n.Argument(value, n.Name(name)) for name, value in inputs.items())
    return n.CallStatement(n.Call(instance, arguments))


def when(condition: Expression, *statements: n.Statement) -> n.If:
    """Return ``IF condition THEN .. END_IF;``."""
    return n.If((n.Branch(condition, statements),))


def remark(text: str) -> tuple[n.Remark, ...]:
    """Return a comment without its empty lines; nothing where it has no text."""
    shown = "\n".join(line.rstrip() for line in text.splitlines() if line.strip())
    return (n.Remark(shown),) if shown else ()


def beside(text: str) -> n.Remark:
    """Return a comment at the end of the line before it; a line break in a name would end it."""
    return n.Remark(" ".join(text.split()), beside=True)


def _joined(
    operator: Operator, operands: Iterable[Expression], *, neutral: n.Literal, absorbing: n.Literal
) -> Expression:
    found: dict[Expression, None] = {}
    for operand in operands:
        for part in operands_of(operand, operator):
            if is_constant(part, absorbing):
                return absorbing
            if not is_constant(part, neutral):
                found[part] = None
    if not found:
        return neutral
    return next(iter(found)) if len(found) == 1 else n.Operation(operator, tuple(found))
