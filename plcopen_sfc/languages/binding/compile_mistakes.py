"""Mistakes that no compiler takes: types of another kind, blocks without such a parameter, what cannot be read.

Kinds of types are compared, not types: whether INT fits into DINT is a matter of each tool. An unknown type,
such as that of a library, is never an error.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Set
from dataclasses import dataclass

from plcopen_sfc.languages.binding.bound_bodies import bind
from plcopen_sfc.languages.binding.name_resolution import Resolver, Type
from plcopen_sfc.languages.binding.name_scopes import every_chart
from plcopen_sfc.languages.binding.name_sites import named
from plcopen_sfc.languages.binding.text_sites import Site, TextSite
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.effects import target_of
from plcopen_sfc.languages.expression_types import CALCULATING, INSTANTS, OF_ONE_TYPE, ORDER, REALS, ExpressionTypes
from plcopen_sfc.languages.il import statements as il_statements
from plcopen_sfc.languages.st import names_of, print_node, walk
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Operator
from plcopen_sfc.languages.st.parsing import parse_condition
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7, BlockKind, StandardBlock, standard_block
from plcopen_sfc.model import types as t
from plcopen_sfc.model.body import IlBody
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.sfc import Body


def compile_mistakes(body: Body | None, pou: Pou, dialect: Dialect, names: Set[str]) -> Iterator[str]:
    """Yield mistakes in a body of a POU with variables of these `names`, in lower case, and what cannot be read."""
    if body is not None:
        yield from _Check(pou, dialect, names).mistakes(body)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of what is called: its name and the name of what has it, its type, empty where it is not known."""

    name: str
    owner: str
    type: str
    is_output: bool = False


def pin_of(block: StandardBlock, name: str, *, is_output: bool) -> Parameter | None:
    """Return the parameter of a standard block that an argument is for; None where it has no such."""
    found = block.output_name(name) if is_output else block.input_name(name)
    pins = {pin.name: pin.type for pin in (block.outputs if is_output else block.inputs)}
    return Parameter(name, block.name, pins.get(found, ""), is_output) if found is not None else None


def type_mistakes(tree: n.Node, resolver: Resolver, site: Site) -> Iterator[str]:
    """Yield the misfits in statements or in an expression at a site: types of another kind."""
    types = _TypesAt(resolver, site)
    kinds = _Kinds(resolver.dialect, types.type_of)
    for node in walk(tree):
        for message, about in kinds.mistakes_in(node):
            yield f"{message}: {' '.join(print_node(about).split())}"
        target = target_of(node)
        written = constant_written(target, resolver, site) if target is not None else ""
        if written:
            yield f"{written} is a constant, and written: {' '.join(print_node(node).split())}"
        if isinstance(node, n.Index):
            yield from (f"{message}: {' '.join(print_node(node).split())}" for message in kinds.outside(node, types))
        if isinstance(node, n.Call):
            yield from (f"{message}: {' '.join(print_node(node).split())}" for message in types.mistakes_of(node))
            for position, argument in enumerate(node.arguments):
                parameter = types.parameter_of(node, position) if argument.value is not None else None
                if parameter is not None and argument.value is not None:
                    yield from kinds.misfit(parameter, argument.value)


def constant_written(target: n.Node, resolver: Resolver, site: Site) -> str:
    """Return the constant that a target is, or is a part of; empty where it is none."""
    while isinstance(target, n.Name | n.Member | n.Index | n.Parenthesized):
        if isinstance(target, n.Parenthesized):
            target = target.inner
            continue
        found: Declaration | None = None
        if isinstance(target, n.Name):
            found = resolver.lookup(named(target), site).declaration
        elif isinstance(target, n.Member):
            found = resolver.called(target, site)
        if found is not None and id(found.holder) in resolver.constants:
            return found.name
        if isinstance(target, n.Name):
            break
        target = target.base
    return ""


def value_mistake(value: Expression, resolver: Resolver, text_site: TextSite) -> str:
    """Return what is wrong with an initial value at its site, in arrays with that of an item."""
    types = _TypesAt(resolver, text_site.site)
    kinds, wanted = _Kinds(resolver.dialect, types.type_of), types.type_of_value(text_site)
    kind = kinds.of(value)
    if kind in ("", kinds.named(wanted)) or not kinds.named(wanted):
        return ""
    return f"the initial value of {wanted} is {kind}: {print_node(value)}"


def value_kind(value: Expression, resolver: Resolver, site: Site) -> str:
    """Return the kind of a value at a site: BOOL, a number, TIME, an instance; empty where it is not known."""
    return _Kinds(resolver.dialect, _TypesAt(resolver, site).type_of).of(value)


class _TypesAt:
    """Types and parameters at a site; of what is not elementary `STRUCT`, `ARRAY` and `INSTANCE`."""

    def __init__(self, resolver: Resolver, site: Site) -> None:
        self._resolver, self._site = resolver, site

    def type_of(self, value: n.Expression) -> str:
        block = self._resolver.standard_block_of(value.base, self._site) if isinstance(value, n.Member) else None
        if block is not None and isinstance(value, n.Member):
            name = value.name.identifier
            pin = pin_of(block, name, is_output=True) or pin_of(block, name, is_output=False)
            return pin.type if pin is not None else ""
        if isinstance(value, n.Member) and isinstance(value.base, n.Name):
            member = value.name.identifier
            meaning = self._resolver.lookup(named(value.base, access=member), self._site).declaration
            if meaning is not None and meaning.kind is Kind.STEP:
                return _OF_STEPS.get(member.casefold(), "")
        if self._resolver.standard_block_of(value, self._site) is not None:
            return "INSTANCE"
        found = self._name(self._resolver.type_of(value, self._site))
        return "BOOL" if not found and isinstance(value, n.Name) and self._is_flag(value) else found

    def _is_flag(self, name: n.Name) -> bool:
        """Return True for the flag of a step in a GRAFCET (``X2``) that no declaration hides."""
        first, step, pou = name.identifier[:1], name.identifier[1:].casefold(), self._site.pou
        if first not in "Xx" or pou is None or self._resolver.lookup(named(name), self._site).declaration is not None:
            return False
        return any(each.name.casefold() == step for chart in every_chart(pou) for each in chart.steps)

    def dimensions_of(self, value: n.Expression) -> list[t.Dimension]:
        """Return the dimensions of an array; none where it is not known."""
        type_ = self._resolver.type_of(value, self._site)
        return type_.dimensions if isinstance(type_, t.ArrayType) else []

    def type_of_value(self, text_site: TextSite) -> str:
        """Return the type that an initial value is for, with arrays those of their items."""
        type_ = self._resolver.type_of_value(text_site.owner, self._site)
        while isinstance(type_, t.ArrayType):
            type_ = self._resolver.settled(type_.base, self._site.place)
        return self._name(type_)

    def parameter_of(self, call: n.Call, position: int) -> Parameter | None:
        """Return the parameter for an argument of a call, as far as it is known."""
        argument, callee = call.arguments[position], print_node(call.callee)
        name = argument.name.identifier if argument.name is not None else ""
        block = self._resolver.standard_block_of(call.callee, self._site)
        if block is not None:
            return pin_of(block, name, is_output=argument.output) if name else None
        function = self._standard_function(call.callee)
        if function is not None:
            pins = {pin.name: pin.type for pin in function.input_pins(len(call.arguments))}
            names = [function.input_name(name)] if name else [*pins][position : position + 1]
            return next((Parameter(each, function.name, pins.get(each, "")) for each in names if each), None)
        type_ = self._name(self._resolver.parameter_type(call, position, self._site))
        return Parameter(name or f"argument {position + 1}", callee, type_, argument.output) if type_ else None

    def mistakes_of(self, call: n.Call) -> Iterator[str]:
        """Yield why a call of a variable without statements, or with too many arguments, does not compile."""
        called = self._resolver.called(call.callee, self._site)
        if called is not None and isinstance(called.holder, t.Variable):
            type_ = self._resolver.type_of_declaration(called)
            if isinstance(type_, t.ElementaryType | t.StringType):
                yield f"{self._name(type_)} cannot be called"
        if isinstance(call.callee, n.Name):
            block = standard_block(call.callee.identifier) if called is None else None
            holder = called.holder if called is not None else None
            is_own = isinstance(holder, Pou) and holder.kind is PouKind.FUNCTION_BLOCK
            if is_own or (block is not None and block.stateful):
                yield f"{call.callee.identifier} is a type: an instance of it is called"
        function = self._standard_function(call.callee)
        given = [each for each in call.arguments if each.name is None]
        if function is not None and len(given) > len(function.input_pins(len(given))):
            yield f"{function.name} has no argument {len(given)}"

    def _standard_function(self, callee: n.Expression) -> StandardBlock | None:
        if not isinstance(callee, n.Name) or self._resolver.called(callee, self._site) is not None:
            return None
        block = standard_block(callee.identifier)
        return block if block is not None and block.kind is BlockKind.FUNCTION else None

    def _name(self, type_: Type) -> str:
        match type_:
            case t.ElementaryType(name=name):
                return name.value
            case t.StringType():
                return "STRING"
            case t.SubrangeType(base=base):
                return self._name(base)
            case t.ArrayType():
                return "ARRAY"
            case t.StructType() if "union" not in kept(type_.extension_data):
                return "STRUCT"
            case Pou(kind=PouKind.FUNCTION_BLOCK):
                return "INSTANCE"
        return ""


class _Kinds:
    """The kinds of values: numbers, BOOL, TIME, strings, instants are of different ones. Empty for all others."""

    def __init__(self, dialect: Dialect, type_of: Callable[[Expression], str]) -> None:
        self._dialect = dialect
        self._type_of = type_of
        self._types = ExpressionTypes(dialect, type_of)

    def mistakes_in(self, node: n.Node) -> Iterator[tuple[str, n.Node]]:
        """Yield the misfits at a node, and the node to show."""
        match node:
            case n.Assignment(target, value, n.AssignmentKind.ASSIGN) if self._differ([target, value]):
                yield f"{self.of(value)} is assigned to {self.of(target)}", node
            case n.Branch(condition) | n.While(condition) | n.Repeat(_, condition):
                if self.of(condition) not in ("", "BOOL"):
                    yield f"a condition is {self.of(condition)}", condition
            case n.Case(selector, branches):
                kind = self._types.value(selector).type
                if kind not in ("", *ORDER):
                    yield f"a CASE asks for {kind}", selector
                for label in (label for branch in branches for label in branch.labels):
                    ends = (label.lower, label.upper) if isinstance(label, n.Range) else (label,)
                    yield from self._no_numbers("a label of a CASE", ends)
            case n.For(variable, start, end, step):
                yield from self._no_numbers("what a FOR counts", (variable, start, end, *((step,) if step else ())))
            case n.Index(base, indices):
                yield from self._no_numbers("an index", indices)
                if isinstance(base, n.Name | n.Member) and self.of(base) in ("BOOL", "a number", "TIME"):
                    yield f"{self.of(base)} has no index", node
            case n.Unary(Operator.NOT, operand) if kind := self._not_joined(operand):
                yield f"NOT of {kind}", node
            case n.Call(n.Name(name), arguments) if name.upper() in OF_ONE_TYPE and not self._type_of(node):
                chosen = arguments[OF_ONE_TYPE[name.upper()] :]
                values = [each.value for each in chosen if each.value is not None and each.name is None]
                if self._differ(values):
                    yield " and ".join(filter(None, map(self.of, values))), node
            case n.Operation(operator, operands) if operator in n.CONNECTIVES | n.COMPARISONS and self._differ(
                operands
            ):
                yield " and ".join(map(self.of, operands)), node
            case n.Operation(operator, operands) if operator in n.CONNECTIVES:
                kinds = list(filter(None, map(self._not_joined, operands)))
                if kinds:
                    yield f"{operator.value} of {kinds[0]}", node
            case n.Operation(operator, operands) if operator in CALCULATING:
                kinds = [self.of(each) for each in operands]
                if "BOOL" in kinds:
                    yield f"{operator.value} of {' and '.join(kind or '?' for kind in kinds)}", node
                elif self._differ(operands) and not _CALCULATED.issuperset(kinds):
                    yield " and ".join(filter(None, kinds)), node

    def misfit(self, parameter: Parameter, value: Expression) -> Iterator[str]:
        """Yield that a parameter is of another kind than the value that it gets or, an output, is assigned to."""
        wanted, kind = self.named(parameter.type), self.of(value)
        if wanted and kind and wanted != kind:
            yield f"{parameter.name} of {parameter.owner} is {wanted}, not {kind}"

    def of(self, expression: Expression) -> str:
        """Return the kind of a value."""
        value = self._types.value(expression)
        if value.type == "STRING" and self._dialect is Dialect.SCL and isinstance(n.bare(expression), n.Literal):
            return ""  # one character is a CHAR, and that a number without the IEC check
        if value.loose:  # 0 and 1 are values of BOOL too
            return "" if 0 <= value.low <= value.high <= 1 else "a number"
        return self.named(value.type)

    def outside(self, node: n.Index, types: _TypesAt) -> Iterator[str]:
        """Yield which indices are certainly not in their array."""
        dimensions = types.dimensions_of(node.base)
        for index, dimension in zip(node.indices, dimensions, strict=False):
            ends = (parse_condition(end, self._dialect).tree for end in (dimension.lower, dimension.upper))
            value, (lower, upper) = self._types.value(index), map(self._types.value, ends)
            is_known = value.is_whole and lower.loose and upper.loose
            if is_known and (value.high < lower.low or value.low > upper.high):
                yield f"the array goes from {dimension.lower} to {dimension.upper}"

    def named(self, name: str) -> str:
        """Return the kind of the values of a type."""
        if name in ORDER or name in REALS or name in _GENERIC_NUMBERS:
            return "a number"
        if name in INSTANTS and self._dialect is Dialect.SCL:
            return ""  # without the IEC check of a block they are numbers too
        return _KINDS.get(name, "")

    def _no_numbers(self, what: str, values: Iterable[Expression]) -> Iterator[tuple[str, n.Node]]:
        """Yield the values that are certainly no numbers, with a word for what they are."""
        for each in values:
            if self.of(each) not in ("", "a number"):
                yield f"{what} is {self.of(each)}", each

    def _not_joined(self, operand: Expression) -> str:
        """Return the kind or type of a value that AND, OR, XOR and NOT do not take; empty where they do."""
        name, kind = self._types.value(operand).type, self.of(operand)
        return name if name in REALS else "" if kind in ("BOOL", "a number") else kind

    def _differ(self, operands: Collection[Expression]) -> bool:
        kinds = {kind for each in operands if (kind := self.of(each))}
        if any(self._types.value(each).loose for each in operands) and not kinds.isdisjoint(_NEVER_NUMBERS):
            return True  # 0 and 1 too, which can be BOOL
        return len(kinds) > 1


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
                named = names_of(about)
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
                yield from ((message, callee) for message in self._parameters(callee, arguments))
            case n.Case(selector, ()):
                yield "a CASE has no branches", selector

    def _parameters(self, callee: n.Name, arguments: tuple[n.Argument, ...]) -> Iterator[str]:
        block = self._block(callee)
        if isinstance(block, str):
            yield f"{block} cannot be called"
            return
        if block is None:
            return
        for each in arguments:
            name = each.name.identifier if each.name is not None else ""
            parameter = pin_of(block, name, is_output=each.output)
            if name and name.upper() not in ("EN", "ENO") and parameter is None:
                yield f"{block.name} has no {name}"
            elif each.value is not None and parameter is not None:
                yield from self._kinds.misfit(parameter, each.value)

    def _block(self, name: n.Name) -> StandardBlock | str | None:
        """Return the block that a variable is an instance of, the name of an elementary type, or None for others."""
        variable = self._variables.get(name.identifier.casefold())
        kind = variable.type if variable is not None else None
        if isinstance(kind, t.ElementaryType):
            return kind.name.value
        block = standard_block(BLOCKS_OF_S7.get(kind.name, kind.name)) if isinstance(kind, t.DerivedType) else None
        return block if block is not None and block.stateful else None

    def _elementary(self, expression: Expression) -> str:
        match expression:
            case n.Name(identifier):
                variable = self._variables.get(identifier.casefold())
                kind = variable.type if variable is not None else None
                return kind.name.value if isinstance(kind, t.ElementaryType) else ""
            case n.Member(n.Name() as base, name):
                block = self._block(base)
                pins = {pin.name: pin.type for pin in block.outputs} if isinstance(block, StandardBlock) else {}
                pin = block.output_name(name.identifier) if isinstance(block, StandardBlock) else None
                return pins.get(pin or "", "")
        return ""


_KINDS = {
    **dict.fromkeys(("TIME", "LTIME"), "TIME"),
    **dict.fromkeys(("STRING", "WSTRING", "ANY_STRING"), "STRING"),
    **{name: name.removeprefix("L") for name in INSTANTS},
    "BOOL": "BOOL",
    "STRUCT": "a structure",
    "ARRAY": "an array",
    "INSTANCE": "an instance",
}
"""A character alone is a string in some tools and a number in others: it has no kind."""
_OF_STEPS = {"x": "BOOL", "t": "TIME"}
_NEVER_NUMBERS = frozenset({"STRING", "a structure", "an array", "an instance"})
_GENERIC_NUMBERS = frozenset({"ANY_NUM", "ANY_INT", "ANY_REAL"})
_CALCULATED = frozenset({"", "a number", "TIME", *INSTANTS})
"""Kinds that one tool or another calculates with together."""
