"""Mistakes that no compiler takes: types of another kind, blocks without such a parameter, what cannot be read.

Kinds of types are compared, not types: whether INT fits into DINT is a matter of each tool. An unknown type,
such as that of a library, is never an error.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Set

from plcopen_sfc.languages.binding.bound_bodies import bind
from plcopen_sfc.languages.expression_types import ORDER, REALS, ExpressionTypes
from plcopen_sfc.languages.il import statements as il_statements
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7, StandardBlock, standard_block
from plcopen_sfc.model.body import IlBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import Body
from plcopen_sfc.model.types import DerivedType, ElementaryType

_JOINING = n.CONNECTIVES | n.COMPARISONS


def compile_mistakes(body: Body | None, pou: Pou, dialect: Dialect, names: Set[str]) -> Iterator[str]:
    """Yield mistakes in a body of a POU with variables of these `names`, in lower case, and what cannot be read."""
    if body is not None:
        yield from _Check(pou, dialect, names).mistakes(body)


def type_mistakes(tree: n.Node, dialect: Dialect, type_of: Callable[[Expression], str]) -> Iterator[str]:
    """Yield the misfits in statements: types of another kind. `type_of` is that of `ExpressionTypes`."""
    kinds = _Kinds(dialect, type_of)
    for node in walk(tree):
        for message, about in kinds.mistakes_in(node):
            yield f"{message}: {' '.join(print_node(about).split())}"


class _Kinds:
    """The kinds of values: numbers, BOOL and TIME are of different ones. Empty for all others."""

    def __init__(self, dialect: Dialect, type_of: Callable[[Expression], str]) -> None:
        self._types = ExpressionTypes(dialect, type_of)

    def mistakes_in(self, node: n.Node) -> Iterator[tuple[str, n.Node]]:
        """Yield the misfits at a node, and the node to show."""
        match node:
            case n.Assignment(target, value, n.AssignmentKind.ASSIGN) if self._differ([target, value]):
                yield f"{self.of(value)} is assigned to {self.of(target)}", node
            case n.Branch(condition) | n.While(condition) | n.Repeat(_, condition):
                if self.of(condition) not in ("", "BOOL"):
                    yield f"a condition is {self.of(condition)}", condition
            case n.Case(selector):
                kind = self._types.value(selector).type
                if kind not in ("", *ORDER):
                    yield f"a CASE asks for {kind}", selector
            case n.Operation(operator, operands) if operator in n.CONNECTIVES | n.COMPARISONS and self._differ(
                operands
            ):
                yield " and ".join(map(self.of, operands)), node
            case n.Operation(operator, operands) if operator in n.CONNECTIVES and self.of(operands[0]) == "TIME":
                yield f"{operator.value} of TIME", node

    def of(self, expression: Expression) -> str:
        """Return the kind of a value."""
        value = self._types.value(expression)
        if value.loose:  # 0 and 1 are values of BOOL too
            return "" if 0 <= value.low <= value.high <= 1 else "a number"
        return _kind_of(value.type)

    def _differ(self, operands: Collection[Expression]) -> bool:
        return len({kind for each in operands if (kind := self.of(each))}) > 1


class _Check:
    def __init__(self, pou: Pou, dialect: Dialect, names: Set[str]) -> None:
        self._dialect, self._names = dialect, names
        self._variables = {each.name.casefold(): each for each in pou.variables()}
        self._kinds = _Kinds(dialect, self._elementary)

    def mistakes(self, body: Body) -> Iterator[str]:
        bound = bind(body, self._dialect)
        yield from (f"it cannot be read: {each.reason}" for each in bound.unknown)
        trees = bound.trees
        if isinstance(body, IlBody):
            used = (each.name for each in bound.uses if each.base is None and each.callee is None)
            missing = self._names - self._variables.keys()
            yield from (f"nothing declares {name}" for name in dict.fromkeys(used) if name.casefold() in missing)
            whole = il_statements(body.text, self._dialect)
            trees = whole.statements if whole is not None else trees
        for node in (node for tree in trees for node in walk(tree)):
            for message, about in self._mistakes_in(node):
                named = {each.identifier.casefold() for each in walk(about) if isinstance(each, n.Name)}
                if named & self._names:
                    yield f"{message}: {print_node(about)}"

    def _mistakes_in(self, node: n.Node) -> Iterator[tuple[str, n.Node]]:
        """Yield mistakes, and the nodes with them."""
        yield from self._kinds.mistakes_in(node)
        match node:
            case n.Member(n.Name() as base, name) if name.identifier[:1].isalpha():
                block = self._block(base)
                if isinstance(block, str):
                    yield f"{block} has no {name.identifier}", node
                elif block is not None and not (
                    block.input_name(name.identifier) or block.output_name(name.identifier)
                ):
                    yield f"{block.name} has no {name.identifier}", node
            case n.CallStatement(n.Call(n.Name() as callee, arguments)):
                yield from self._parameters(callee, arguments)
            case n.Case(selector, ()):
                yield "a CASE has no branches", selector

    def _parameters(self, callee: n.Name, arguments: tuple[n.Argument, ...]) -> Iterator[tuple[str, n.Node]]:
        block = self._block(callee)
        if isinstance(block, str):
            yield f"{block} cannot be called", callee
            return
        if block is None:
            return
        pins = {pin.name: pin.type for pin in (*block.inputs, *block.outputs)}
        for each in arguments:
            name = each.name.identifier if each.name is not None else ""
            found = block.output_name(name) if each.output else block.input_name(name)
            if name and name.upper() not in ("EN", "ENO") and found is None:
                yield f"{block.name} has no {name}", callee
            elif each.value is not None and found is not None:
                wanted, kind = _kind_of(pins.get(found, "")), self._kinds.of(each.value)
                if wanted and kind and wanted != kind:
                    yield f"{name} of {block.name} is {wanted}, not {kind}", callee

    def _block(self, name: n.Name) -> StandardBlock | str | None:
        """Return the block that a variable is an instance of, the name of an elementary type, or None for others."""
        variable = self._variables.get(name.identifier.casefold())
        kind = variable.type if variable is not None else None
        if isinstance(kind, ElementaryType):
            return kind.name.value
        block = standard_block(BLOCKS_OF_S7.get(kind.name, kind.name)) if isinstance(kind, DerivedType) else None
        return block if block is not None and block.stateful else None

    def _elementary(self, expression: Expression) -> str:
        match expression:
            case n.Name(identifier):
                variable = self._variables.get(identifier.casefold())
                kind = variable.type if variable is not None else None
                return kind.name.value if isinstance(kind, ElementaryType) else ""
            case n.Member(n.Name() as base, name):
                block = self._block(base)
                pins = {pin.name: pin.type for pin in block.outputs} if isinstance(block, StandardBlock) else {}
                pin = block.output_name(name.identifier) if isinstance(block, StandardBlock) else None
                return pins.get(pin or "", "")
        return ""


def _kind_of(name: str) -> str:
    if name in ORDER or name in REALS:
        return "a number"
    return {"LTIME": "TIME"}.get(name, name if name in ("BOOL", "TIME") else "")
