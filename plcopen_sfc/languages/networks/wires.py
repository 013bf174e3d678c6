"""The values on the wires of a network while it is executed, and the statements that this takes.

A value is written where it is used, as an expression. It goes through a variable of its own (a helper) only where it
must: where it is used more than once and evaluating it again may give something else, or would be long.

In a ladder, contacts behind each other are AND and wires that meet are OR. Two wires that meet have often passed the
same contacts before they parted; those must not be written twice. So a value is kept as the product of all it passed,
each factor with an identity, and where wires meet, what their products begin with in common stays outside the OR.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Sequence, Set
from functools import cached_property, lru_cache
from itertools import groupby, pairwise
from typing import NamedTuple, TypeVar

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.effects import (
    Path,
    is_impure,
    is_repeatable,
    is_variable,
    may_change,
    path_of,
    reads,
    writes,
)
from plcopen_sfc.languages.expression_types import ExpressionTypes
from plcopen_sfc.languages.networks.network_graph import Graph, Source
from plcopen_sfc.languages.networks.results import Helper, NetworkProblem
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import (
    AssignmentKind,
    Expression,
    Literal,
    Operation,
    Operator,
    Statement,
    Unary,
    bare,
)
from plcopen_sfc.languages.st.parsing import parse_expression, parse_statements
from plcopen_sfc.languages.st.walking import children, transform
from plcopen_sfc.languages.standard_blocks import StandardBlock, standard_block
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Edge

TRUE = Literal("TRUE")


class Factor(NamedTuple):
    """A factor of a product: what it is in the network (equal for the same element only), and its expression."""

    identity: Hashable
    expression: Expression


Product = tuple[Factor, ...]
"""A value as a product; the empty one is TRUE, the value of the left power rail."""


def is_true(expression: Expression) -> bool:
    """True if it is the literal TRUE."""
    inner = bare(expression)
    return isinstance(inner, Literal) and inner.text.upper() == "TRUE"


def expression_of(product: Product) -> Expression:
    """Return a product as an expression."""
    return joined(Operator.AND, [factor.expression for factor in product]) if product else TRUE


def joined(operator: Operator, operands: Sequence[Expression]) -> Expression:
    """Operands joined by an associative operator; those that are joined by the same one are taken apart."""
    flat: list[Expression] = []
    for operand in operands:
        inner = bare(operand)
        if isinstance(inner, Operation) and inner.operator is operator:
            flat.extend(inner.operands)
        else:
            flat.append(operand)
    return flat[0] if len(flat) == 1 else Operation(operator, tuple(flat))


def operation(operator: Operator, operands: Sequence[Expression]) -> Expression:
    """Operands with an operator between them, as one operation where it is read as one: ``a + b + c``."""
    if operator in _ASSOCIATIVE:
        return joined(operator, operands)
    first = bare(operands[0])
    if operator in (Operator.ADD, Operator.MULTIPLY) and isinstance(first, Operation) and first.operator is operator:
        operands = (*first.operands, *operands[1:])
    return Operation(operator, tuple(operands))


_ASSOCIATIVE = (Operator.AND, Operator.OR, Operator.XOR)


def inverted(expression: Expression) -> Expression:
    """NOT of an expression; of one that is inverted already, what is inside."""
    inner = bare(expression)
    if isinstance(inner, Unary) and inner.operator is Operator.NOT:
        return inner.operand
    return Unary(Operator.NOT, expression)


DUALS = {Operator.AND: Operator.OR, Operator.OR: Operator.AND}
"""By De Morgan NOT of one is the other one of what is inverted."""


def with_inner_negations(expression: Expression, *, negated: bool = False) -> Expression:
    """Return a Boolean value, or its NOT, with no NOT around AND or OR: a ladder has none around several contacts."""
    inner = bare(expression)
    if isinstance(inner, Unary) and inner.operator is Operator.NOT:
        return with_inner_negations(inner.operand, negated=not negated)
    if negated and isinstance(inner, Operation) and inner.operator in DUALS:
        inner = normal_form(inner)  # what is always TRUE is no contact
    if isinstance(inner, Operation) and inner.operator in DUALS:
        operator = DUALS[inner.operator] if negated else inner.operator
        return joined(operator, [with_inner_negations(each, negated=negated) for each in inner.operands])
    return Unary(Operator.NOT, inner) if negated else expression


EXTENSIBLE_COMPARISONS = n.COMPARISONS - {Operator.UNEQUAL}


def compared(operator: Operator, values: Sequence[Expression]) -> Expression:
    """Return a comparison of neighbours: GT of three values is `a > b AND b > c` (IEC 61131-3 ed. 3, table 33)."""
    return joined(Operator.AND, [Operation(operator, pair) for pair in pairwise(values)])


def product_of(products: Sequence[Product]) -> Product:
    """Return the product of products; what is in several of them counts once."""
    return tuple({factor.identity: factor for product in products for factor in product}.values())


def meeting(products: Sequence[Product], meetings: dict[Hashable, int]) -> Product:
    """Return the value where wires meet: TRUE if one of them is. `meetings` numbers the meetings of a network."""
    if len(products) == 1:
        return products[0]
    shared = _shared_start(products)
    start, rests = products[0][:shared], [product[shared:] for product in products]
    if not any(rests):
        return start
    alternatives = []
    # only neighbours are written with one beginning: branches stay in the order in which they are drawn
    for _, group in groupby(rests, key=lambda rest: rest[0].identity if rest else None):
        branch = list(group)
        alternatives.append(
            expression_of(branch[0] if len(branch) == 1 or not branch[0] else meeting(branch, meetings))
        )
    # a number stands for it: identities that held those of the meetings before them would grow along a rung
    identity = tuple(tuple(factor.identity for factor in rest) for rest in rests)
    number = meetings.setdefault(identity, len(meetings))
    return (*start, Factor(number, joined(Operator.OR, alternatives)))


def _shared_start(products: Sequence[Product]) -> int:
    shortest = min(len(product) for product in products)
    for index in range(shortest):
        if len({product[index].identity for product in products}) > 1:
            return index
    return shortest


AnyNode = TypeVar("AnyNode", bound=n.Node)


def normal_form(tree: AnyNode) -> AnyNode:
    """Return the normal form of an expression or of statements."""
    return transform(tree, _normal)


def _normal(node: n.Node) -> n.Node:
    match node:
        case n.Parenthesized(inner):
            return inner
        case n.Literal(text) if text.upper() in ("TRUE", "FALSE"):
            return n.Literal(text.upper())
        case n.Unary(Operator.NOT, operand):
            return inverted(operand)
        case n.Operation():
            return _operation(node.operator, node.operands)
        case n.Call(n.Name(identifier, n.Quoting.NONE)):
            block = standard_block(identifier)
            return _standard_call(node, block) if block is not None and not block.stateful else node
        case n.Statements(statements):
            return n.Statements(tuple(_statements(statements)))
        case n.Branch(condition, statements):
            return n.Branch(condition, tuple(_statements(statements)))
        case n.If():
            return _stored(node)
        case _:
            return node


def _operation(operator: Operator, operands: Sequence[Expression]) -> Expression:
    if operator is Operator.AND:
        operands = [operand for operand in operands if operand != TRUE]
        return joined(operator, operands) if operands else TRUE
    if operator is Operator.OR:
        return _or(joined(operator, operands))
    if operator is Operator.SUBTRACT and len(operands) == 2 and operands[0] == n.Literal("0"):
        return n.Unary(Operator.NEGATE, operands[1])
    return operation(operator, operands)


def _or(flat: Expression) -> Expression:
    if not isinstance(flat, n.Operation) or flat.operator is not Operator.OR:
        return flat
    always = [index for index, operand in enumerate(flat.operands) if operand == TRUE]
    return joined(Operator.OR, [o for index, o in enumerate(flat.operands) if index not in always[1:]])


def _standard_call(call: n.Call, block: StandardBlock) -> Expression:
    given = [(a.name.identifier if a.name is not None else "", a.value) for a in call.arguments]
    values = [value for _, value in given if value is not None]
    if len(values) < len(given) or any(a.output for a in call.arguments):
        return call
    pins = [pin.name for pin in block.input_pins(len(given))]
    # by position where that is the same: a drawn call has the names of all its pins, a written one mostly none
    names = [block.input_name(name) or name for name, _ in given]
    if any(names):
        by_name = dict(zip(names, values, strict=True))
        if sorted(pins) != sorted(names):
            arguments = (
                n.Argument(value, n.Name(name) if name else None) for name, value in zip(names, values, strict=True)
            )
            return n.Call(n.Name(block.name), tuple(arguments))
        values = [by_name[pin] for pin in pins]
    if len(values) != len(pins):
        return n.Call(n.Name(block.name), tuple(n.Argument(value) for value in values))
    return _by_position(block, values)


def _by_position(block: StandardBlock, values: Sequence[Expression]) -> Expression:
    operator = block.operator
    if block.name == "MOVE":
        return values[0]
    if operator is Operator.NOT:
        return inverted(values[0])
    if operator in EXTENSIBLE_COMPARISONS and len(values) > 2:
        return compared(operator, values)
    if operator is not None:
        return _operation(operator, values)
    return n.Call(n.Name(block.name), tuple(n.Argument(value) for value in values))


def _statements(statements: Iterable[Statement]) -> Iterator[Statement]:
    for statement in statements:
        if isinstance(statement, n.RegionBlock):
            yield from _statements(statement.statements)
        elif isinstance(statement, n.If) and statement.branches[0].condition == TRUE:
            yield from statement.branches[0].statements
        elif not isinstance(statement, n.Empty):
            yield statement


def _stored(statement: n.If) -> Statement:
    # ``IF a THEN q := TRUE; END_IF`` does what a coil S does: both are ``q S= a``
    branch = statement.branches[0]
    inner = branch.statements[0] if len(branch.statements) == 1 else None
    if len(statement.branches) == 1 and statement.otherwise is None and isinstance(inner, n.Assignment):
        stored = _STORED.get(inner.value.text) if isinstance(inner.value, n.Literal) else None
        if stored is not None and inner.kind is AssignmentKind.ASSIGN:
            return n.Assignment(inner.target, branch.condition, stored)
    return statement


_STORED = {"TRUE": AssignmentKind.SET, "FALSE": AssignmentKind.RESET}


MAX_DEPTH = 60
"""Depth to which a value may be nested before it goes through a helper."""
MAX_FACTORS = 200
"""Number of factors that a value may have that is used more than once."""


class Wires:
    """Values by the output they come from, and the statements executed so far."""

    def __init__(self, graph: Graph, dialect: Dialect, taken: Callable[[], Iterable[str]]) -> None:
        self.dialect = dialect
        self.statements: list[Statement] = []
        self.helpers: list[Helper] = []
        self.instances: dict[str, str] = {}
        self.problems: list[NetworkProblem] = []
        self.meetings: dict[object, int] = {}
        self._graph = graph
        self._types = ExpressionTypes(dialect)
        self._names = taken
        self._values: dict[Source, Product | None] = {}
        self._left: dict[Source, int] = {}
        self._standard: set[Path] = set()
        self._private: set[str] = set()
        self._feedback: dict[Source, Helper] = {}
        self._quoting = n.Quoting.LOCAL if dialect is Dialect.SCL else n.Quoting.NONE

    # -- texts

    def expression(self, text: str, node: int) -> Expression:
        """Return the expression in an element."""
        parsed = parse_expression(text, self.dialect)
        for problem in parsed.problems:
            self.problem(f"{text!r}: {problem.message}", node)
        return parsed.tree

    def code(self, text: str, node: int) -> tuple[Statement, ...]:
        """Return the statements in an element."""
        parsed = parse_statements(text, self.dialect)
        for problem in parsed.problems:
            line, column = parsed.place(problem.span[0])
            self.problem(f"line {line}, column {column} of its text: {problem.message}", node)
        return parsed.tree.statements

    def problem(self, message: str, node: int | None, severity: Severity = Severity.ERROR) -> None:
        """Note something that text cannot express."""
        self.problems.append(NetworkProblem(message, node, severity))

    # -- statements

    def execute(self, statement: Statement) -> None:
        """Append a statement; values that it may change and that are still needed go to helpers before it."""
        # mostly nothing is needed any more, and to find what a statement writes takes a walk through its tree
        if any(self._left.values()):
            self.prepare(writes(statement, self._standard))
        self.statements.append(statement)

    def prepare(self, written: frozenset[Path], using: Collection[Source] = ()) -> None:
        """Move values that are still needed to helpers if writing `written` may change them.

        Of the outputs in `using` one use does not count: it is that of the statement that will write.
        """
        for source, left in self._left.items():
            product = self._values[source]
            if product and left > (source in using) and any(_changes(f, written, self._private) for f in product):
                self.statements.append(self._kept(source, product))

    def instance(self, name: str, type_name: str) -> None:
        """Note an instance of a function block."""
        self.instances[name] = type_name
        path = path_of(parse_expression(name, self.dialect).tree)
        self._private.update(path[:1])
        if standard_block(type_name) is not None:
            self._standard.add(path)

    @cached_property
    def _taken(self) -> set[str]:
        """Names that a helper must not have, in lower case; few networks need one."""
        return {name.casefold() for name in self._names()}

    def helper(self, prefix: str, source: Source, type_name: str | None, *, retained: bool) -> n.Name:
        """Return a new variable."""
        name = take_name(f"{prefix}_{source[0]}", self._taken)
        self.helpers.append(Helper(name, type_name, retained))
        self._private.add(name.casefold())
        return n.Name(name, self._quoting)

    def edge(self, edge: Edge, value: Expression, source: Source) -> Expression:
        """The edge of a value: an instance of R_TRIG is called, or a variable keeps the value for a falling edge.

        A falling edge is a change from ON to OFF between two evaluations (ed. 3, 8.2.3), so the first has none. An
        F_TRIG of IEC 61131-3 would see one there, one of S7 none.
        """
        if edge is Edge.NONE:
            return value
        if edge is Edge.FALLING:
            return self.edge_since(self.helper("last", source, "BOOL", retained=True), value, source, rising=False)
        instance = self.helper("edge", source, "R_TRIG", retained=True)
        self.instance(instance.identifier, "R_TRIG")
        self.execute(n.CallStatement(n.Call(instance, (n.Argument(value, n.Name("CLK")),))))
        return n.Member(instance, n.Name("Q"))

    def edge_since(self, memory: Expression, value: Expression, source: Source, *, rising: bool) -> Expression:
        """Return the edge of a value since the last cycle, from which `memory` has it."""
        clock = value if is_variable(value) else self._flag(value, source)
        now, before = (clock, inverted(memory)) if rising else (inverted(clock), memory)
        result = self._flag(n.Operation(Operator.AND, (now, before)), source)
        self.execute(n.Assignment(memory, clock))
        return result

    def _flag(self, value: Expression, source: Source) -> n.Name:
        name = self.helper("value", source, "BOOL", retained=False)
        self.execute(n.Assignment(name, value))
        return name

    # -- values

    def store(self, source: Source, product: Product | None, *, lazy: bool = False) -> None:
        """Give an output its value, None where it has none. `lazy`: it is not evaluated before its first use."""
        uses = self._graph.uses[source]
        self._values[source] = product
        if product is not None:
            helper = self._feedback.get(source)
            if helper is not None:
                name = n.Name(helper.name, self._quoting)
                self.execute(n.Assignment(name, expression_of(product)))
                self._values[source] = (Factor(source, name),)
            elif _is_deep(product) or (uses > 1 and _is_costly(product)):
                self.execute(self._kept(source, product))
        if uses > 0 and not lazy:
            self._left[source] = uses

    def take(self, source: Source) -> Product | None:
        """Return the value of an output for one of its uses."""
        if source not in self._values:
            return self._of_last_cycle(source)
        product = self._values[source]
        left = self._left.get(source, self._graph.uses[source]) - 1
        if left > 0:
            self._left[source] = left
        else:
            self._left.pop(source, None)
        return product

    def value(self, source: Source) -> Product | None:
        """Return the value of an output, which is not one of its uses."""
        return self._values[source]

    def is_stored(self, source: Source) -> bool:
        """True if the output has its value, or has none for good."""
        return source in self._values

    def keep(self, source: Source) -> None:
        """Keep the value of an output in a variable from here on, also in the next cycle."""
        product = self._values.get(source)
        if product and not (len(product) == 1 and is_variable(n.bare(product[0].expression))):
            left = self._left.pop(source, 0)
            self.execute(self._kept(source, product, retained=True))
            self._left |= {source: left} if left else {}

    def _of_last_cycle(self, source: Source) -> Product:
        """Return the value of an output that is evaluated later: feedback."""
        helper = self._feedback.get(source)
        if helper is None:
            name = self.helper("last", source, self._graph.type_of(source), retained=True)
            helper = self._feedback[source] = self.helpers[-1]
            self.problem(
                f"its value feeds what it depends on; {name.identifier} keeps it from the last cycle",
                source[0],
                Severity.WARNING,
            )
        return (Factor(("last", source), n.Name(helper.name, self._quoting)),)

    def _kept(self, source: Source, product: Product, *, retained: bool = False) -> Statement:
        """Keep a value in a variable from here on; return the statement that assigns it."""
        value = expression_of(product)
        type_name = self._graph.type_of(source)
        if type_name is None and self._types.value(value).type == "BOOL":
            type_name = "BOOL"
        name = self.helper("value", source, type_name, retained=retained)
        self._values[source] = (Factor(source, name),)
        return n.Assignment(name, value)


def _changes(factor: Factor, written: frozenset[Path], private: Set[str]) -> bool:
    return is_impure(factor.expression) or may_change(reads(factor.expression), written, private)


def _is_deep(product: Product) -> bool:
    # of a long rung all factors but the last have been looked at before
    return any(_exceeds(factor.expression) for factor in product[-20:])


def _exceeds(expression: Expression) -> bool:
    level = 0
    while isinstance(expression, n.Member):  # most are paths, and to look them up would take longer than to count
        expression, level = expression.base, level + 1
    return level + (1 if isinstance(expression, n.Name) else _depth(expression)) > MAX_DEPTH


def _is_costly(product: Product) -> bool:
    return len(product) > MAX_FACTORS or not all(map(_is_repeatable, product))


def _is_repeatable(factor: Factor) -> bool:
    # who draws power that parts into branches asks the same of the normal form
    return is_repeatable(factor.expression) or is_repeatable(normal_form(factor.expression))


@lru_cache(maxsize=4096)
def _depth(expression: Expression) -> int:
    deepest = 0
    waiting: list[tuple[n.Node, int]] = [(expression, 1)]
    while waiting:
        node, level = waiting.pop()
        deepest = max(deepest, level)
        waiting += [(inner, level + 1) for inner in children(node)]
    return deepest
