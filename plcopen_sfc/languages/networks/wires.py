"""The values on the wires of a network while it is executed, and the statements that this takes.

A value is written where it is used, as an expression. It goes through a variable of its own (a helper) only where it
must: where it is used more than once and evaluating it again may give something else, or would be long.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Set
from functools import lru_cache

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.expression_types import ExpressionTypes
from plcopen_sfc.languages.networks.network_graph import Graph, Source
from plcopen_sfc.languages.networks.results import Helper, NetworkProblem
from plcopen_sfc.languages.networks.values import Factor, Product, expression_of, normal_form
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.effects import (
    Path,
    is_impure,
    is_repeatable,
    is_variable,
    may_change,
    path_of,
    reads,
    writes,
)
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.languages.st.parsing import parse_expression, parse_statements
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model.network import Edge

MAX_DEPTH = 60
"""How deep a value may be nested before it goes through a helper."""
MAX_FACTORS = 200
"""How many factors a value may have that is used more than once."""


class Wires:
    """Values by the output they come from, and the statements executed so far."""

    def __init__(self, graph: Graph, dialect: Dialect, taken: Iterable[str]) -> None:
        self.dialect = dialect
        self.statements: list[Statement] = []
        self.helpers: list[Helper] = []
        self.instances: dict[str, str] = {}
        self.problems: list[NetworkProblem] = []
        self.meetings: dict[object, int] = {}
        self._graph = graph
        self._types = ExpressionTypes(dialect)
        self._taken = {name.casefold() for name in taken}
        self._values: dict[Source, Product | None] = {}
        self._left: dict[Source, int] = {}
        self._standard: set[Path] = set()
        self._private: set[str] = set()
        self._feedback: dict[Source, Helper] = {}
        self._quoting = n.Quoting.LOCAL if dialect is Dialect.SCL else n.Quoting.NONE

    # -- texts

    def expression(self, text: str, node: int) -> Expression:
        """The expression that stands in an element."""
        parsed = parse_expression(text, self.dialect)
        for problem in parsed.problems:
            self.problem(f"{text!r}: {problem.message}", node)
        return parsed.tree

    def code(self, text: str, node: int) -> tuple[Statement, ...]:
        """The statements that stand in an element."""
        parsed = parse_statements(text, self.dialect)
        for problem in parsed.problems:
            line, column = parsed.place(problem.span[0])
            self.problem(f"line {line}, column {column} of its text: {problem.message}", node)
        return parsed.tree.statements

    def problem(self, message: str, node: int | None, severity: Severity = Severity.ERROR) -> None:
        """Note something that cannot be said."""
        self.problems.append(NetworkProblem(message, node, severity))

    # -- statements

    def execute(self, statement: Statement) -> None:
        """Append a statement; values that it may change and that are still needed go to helpers before it."""
        self.prepare(writes(statement, self._standard))
        self.statements.append(statement)

    def prepare(self, written: frozenset[Path], using: Collection[Source] = ()) -> None:
        """Let values that are still needed go to helpers if writing `written` may change them.

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

    def execute_all(self, statements: Iterable[Statement]) -> None:
        """Append statements."""
        for statement in statements:
            self.execute(statement)

    def helper(self, prefix: str, source: Source, type_name: str | None, *, retained: bool) -> n.Name:
        """A new variable."""
        stem = name = f"{prefix}_{source[0]}"
        number = 1
        while name.casefold() in self._taken:
            number += 1
            name = f"{stem}_{number}"
        self._taken.add(name.casefold())
        self.helpers.append(Helper(name, type_name, retained))
        self._private.add(name.casefold())
        return n.Name(name, self._quoting)

    def edge(self, edge: Edge, value: Expression, source: Source) -> Expression:
        """The edge of a value: an instance of R_TRIG or F_TRIG is called, the result is its output."""
        if edge is Edge.NONE:
            return value
        type_name = "R_TRIG" if edge is Edge.RISING else "F_TRIG"
        instance = self.helper("edge", source, type_name, retained=True)
        self.instance(instance.identifier, type_name)
        self.execute(n.CallStatement(n.Call(instance, (n.Argument(value, n.Name("CLK")),))))
        return n.Member(instance, n.Name("Q"))

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
        """The value of an output for one of its uses."""
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
        """The value of an output, which is not one of its uses."""
        return self._values[source]

    def is_stored(self, source: Source) -> bool:
        """True if the output has its value, or has none for good."""
        return source in self._values

    def keep(self, source: Source) -> None:
        """Let an output have its value in a variable from here on, also in the next cycle."""
        product = self._values.get(source)
        if product and not (len(product) == 1 and is_variable(n.bare(product[0].expression))):
            left = self._left.pop(source, 0)
            self.execute(self._kept(source, product, retained=True))
            self._left |= {source: left} if left else {}

    def _of_last_cycle(self, source: Source) -> Product:
        """The value of an output that is evaluated later: feedback."""
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
        """Let a value go through a variable from here on; the statement that gives it its value."""
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
    return any(_depth(factor.expression) > MAX_DEPTH for factor in product[-20:])


def _is_costly(product: Product) -> bool:
    return len(product) > MAX_FACTORS or not all(map(_is_repeatable, product))


def _is_repeatable(factor: Factor) -> bool:
    # who draws power that parts into branches asks the same of the normal form
    return is_repeatable(factor.expression) or is_repeatable(normal_form(factor.expression))


@lru_cache(maxsize=4096)
def _depth(expression: Expression) -> int:
    deepest = 0
    waiting: list[tuple[object, int]] = [(expression, 1)]
    while waiting:
        item, level = waiting.pop()
        if isinstance(item, tuple):
            waiting.extend((member, level) for member in item)
        elif isinstance(item, n.Node):
            deepest = max(deepest, level)
            waiting.extend((getattr(item, name), level + 1) for name in item.__dataclass_fields__ if name != "span")
    return deepest
