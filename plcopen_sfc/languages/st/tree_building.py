"""Makes the nodes of the syntax tree while the parser recognises the rules of ``st.lark`` and ``declarations.lark``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Any, ClassVar

from lark.visitors import Transformer

from plcopen_sfc.languages.problems import Problem
from plcopen_sfc.languages.st import declaration_nodes as d
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import Token
from plcopen_sfc.languages.st.nodes import Expression, Operator, Span

_STRINGS = frozenset({"STRING", "WSTRING"})
_INTEGERS = frozenset("SINT INT DINT LINT USINT UINT UDINT ULINT BYTE WORD DWORD LWORD".split())


_LEVELS = (
    (Operator.OR, Operator.OR_ELSE),
    (Operator.XOR,),
    (Operator.AND, Operator.AND_THEN),
    (Operator.EQUAL, Operator.UNEQUAL),
    (Operator.LESS, Operator.GREATER, Operator.LESS_OR_EQUAL, Operator.GREATER_OR_EQUAL),
    (Operator.ADD, Operator.SUBTRACT),
    (Operator.MULTIPLY, Operator.DIVIDE, Operator.MODULO),
    (Operator.POWER,),
)
PRECEDENCE = {operator: strength for strength, level in enumerate(_LEVELS, 1) for operator in level}
"""Precedence of binary operators (IEC 61131-3 ed. 3, table 71; the same in CODESYS and SCL).

NOT and signs bind tighter than all of them, but that in SCL a power binds tighter than a sign: ``-2 ** 2`` is -4 there.
"""

ASSOCIATIVE = frozenset({Operator.OR, Operator.XOR, Operator.AND, Operator.ADD, Operator.MULTIPLY})
"""Operators whose operands in a row make one `Operation`."""

_OPERATORS: dict[str, Operator] = {operator.value: operator for operator in PRECEDENCE} | {"&": Operator.AND}
_SIGNS = {"+": Operator.PLUS, "-": Operator.NEGATE}

Items = list[Any]
"""Parts of a rule: tokens, nodes, and lists of nodes, in the order of the grammar."""


class StatementList(list[Any]):
    """Statements while they are read: the place where the parser goes on after an error."""

    __slots__ = ()


@dataclass(slots=True, eq=False)
class _Labels:
    """Labels of a branch of CASE, or the target of a jump, before it is known which."""

    labels: list[Expression | n.Range]
    span: Span


@dataclass(slots=True, eq=False)
class _Handler:
    """``__CATCH(error)`` with its statements."""

    error: Expression | None
    statements: StatementList
    span: Span


def over(items: Sequence[Any]) -> Span:
    """Return the span from the start of the first item to the end of the last."""
    return (items[0].span[0], items[-1].span[1])


def _literal(items: Items) -> n.Literal:
    return n.Literal(items[0].value, span=items[0].span)


def _address(items: Items) -> n.Address:
    return n.Address(items[0].value, span=items[0].span)


_NODES: dict[str, Callable[[Items], Any]] = {
    "only": itemgetter(0),
    "second": itemgetter(1),
    "finally_": itemgetter(1),
    "first": lambda items: [items[0]],
    "none": lambda _: StatementList(),
    # -- expressions
    "first_operand": lambda items: items,
    "name": lambda items: name_of(items[0]),
    "literal": _literal,
    "address": _address,
    "parenthesized": lambda items: n.Parenthesized(items[1], span=over(items)),
    "member": lambda items: n.Member(items[0], name_of(items[2]), span=over(items)),
    "index": lambda items: n.Index(items[0], tuple(items[2]), span=over(items)),
    "dereference": lambda items: n.Dereference(items[0], span=over(items)),
    "peripheral": lambda items: n.Peripheral(items[0], span=over(items)),
    "call_without_arguments": lambda items: n.Call(items[0], span=over(items)),
    "call": lambda items: n.Call(items[0], tuple(items[2]), span=over(items)),
    "reference_operand": lambda items: n.TypeOperand(
        f"{items[0].value} {items[1].value}", (), items[2], span=over(items)
    ),
    "array_operand": lambda items: n.TypeOperand("ARRAY", tuple(items[2]), items[5], span=over(items)),
    "assignment_expression": lambda items: n.AssignmentExpression(items[0], items[2], span=over(items)),
    "range": lambda items: n.Range(items[0], items[2], span=over(items)),
    # -- arguments
    "positional": lambda items: n.Argument(items[0], span=items[0].span),
    "input_argument": lambda items: n.Argument(items[2], name_of(items[0]), span=over(items)),
    "empty_input": lambda items: n.Argument(None, name_of(items[0]), span=over(items)),
    "output_argument": lambda items: n.Argument(items[2], name_of(items[0]), output=True, span=over(items)),
    "empty_output": lambda items: n.Argument(None, name_of(items[0]), output=True, span=over(items)),
    "negated_output": lambda items: n.Argument(
        items[3], name_of(items[1]), output=True, negated=True, span=over(items)
    ),
    # -- statements
    "assignment": lambda items: n.Assignment(
        items[0], items[2], n.AssignmentKind(items[1].value.upper()), span=over(items)
    ),
    "call_statement": lambda items: n.CallStatement(items[0], span=over(items)),
    "embedded_code": lambda items: n.EmbeddedCode(items[0].value, span=items[0].span),
    "exit": lambda items: n.Exit(span=over(items)),
    "continue_": lambda items: n.Continue(span=over(items)),
    "return_": lambda items: n.ReturnStatement(span=over(items)),
    "return_value": lambda items: n.ReturnStatement(items[1], span=over(items)),
    "goto": lambda items: n.Goto(name_of(items[1]), items[0].type, span=over(items)),
    "labels": lambda items: _Labels(items[0], (items[0][0].span[0], items[1].span[1])),
}
"""What makes the result of the rules that need nothing but their parts, by the aliases of ``st.lark``."""


class Builder(Transformer[Token, Any]):
    """One method, or entry of `RULES`, for each alias of the grammar; each is given what its rule consists of.

    `signs_below_power`: the sign of ``-2 ** 2`` is before the power, as in SCL.
    """

    RULES: ClassVar[Mapping[str, Callable[[Items], Any]]] = _NODES

    def __init__(self, *, signs_below_power: bool) -> None:
        super().__init__()
        vars(self).update(self.RULES)
        self._signs_below_power = signs_below_power
        self.problems: list[Problem] = []

    # -- lists

    def further(self, items: Items) -> Any:
        items[0].append(items[2])
        return items[0]

    def one_more(self, items: Items) -> Any:
        if items[1] is not None:
            items[0].append(items[1])
        return items[0]

    # -- expressions

    def next_operand(self, items: Items) -> Any:
        chain: Items = items[0]
        chain.append(items[1])
        chain.append(items[2])
        return chain

    def finish_chain(self, items: Items) -> Any:
        chain: Items = items[0]
        if len(chain) == 1:
            return chain[0]
        operands: list[Expression] = [chain[0]]
        waiting: list[Operator] = []
        for token, operand in zip(chain[1::2], chain[2::2], strict=True):
            operator = _OPERATORS[token.value.upper()]
            strength = PRECEDENCE[operator]
            while waiting and PRECEDENCE[waiting[-1]] >= strength:
                if waiting[-1] is operator and operator in ASSOCIATIVE:
                    break  # one more in the row
                self._join(operands, waiting)
            operands.append(operand)
            waiting.append(operator)
        while waiting:
            self._join(operands, waiting)
        return operands[0]

    def _join(self, operands: list[Expression], waiting: list[Operator]) -> None:
        """Join the last operands by the last operator, all of a row at once."""
        operator = waiting.pop()
        count = 2
        while waiting and waiting[-1] is operator:
            waiting.pop()
            count += 1
        members = tuple(operands[-count:])
        del operands[-count:]
        span = over(members)
        if self._signs_below_power and operator is Operator.POWER and isinstance(members[0], n.Unary):
            operands.append(_power_of_signed(members[0], members[1], span))
        else:
            operands.append(n.Operation(operator, members, span=span))

    def unary(self, items: Items) -> Any:
        token: Token = items[0]
        operator = Operator.NOT if token.type == "NOT" else _SIGNS[token.value]
        return n.Unary(operator, items[1], span=over(items))

    def operator_call(self, items: Items) -> Any:
        token: Token = items[0]
        if not token.value.isalpha():
            self.problems.append(Problem(f"found '{token.value}', expected an expression", token.span))
        return n.Call(n.Name(token.value, span=token.span), tuple(items[2]), span=over(items))

    # -- statements

    def empty(self, items: Items) -> Any:
        span: Span = items[0].span
        return n.Empty(span=span) if span[0] < span[1] else None  # no semicolon is there: see `parsing`

    def closed(self, items: Items) -> Any:
        # the semicolon after END_IF belongs to the statement
        statement: n.Node = items[0]
        object.__setattr__(statement, "span", over(items))
        return statement

    def elsif(self, items: Items) -> Any:
        branches: Items = items[0]
        span = (items[1].span[0], _end(items[4], items[3]))
        branches.append(n.Branch(items[2], self._statements(items[4]), span=span))
        return branches

    def if_(self, items: Items) -> Any:
        span = (items[0].span[0], _end(items[3], items[2]))
        first = n.Branch(items[1], self._statements(items[3]), span=span)
        return n.If((first, *items[4]), span=over(items))

    def if_else(self, items: Items) -> Any:
        span = (items[0].span[0], _end(items[3], items[2]))
        first = n.Branch(items[1], self._statements(items[3]), span=span)
        return n.If((first, *items[4]), self._statements(items[6]), span=over(items))

    def case(self, items: Items) -> Any:
        return n.Case(items[1], self._branches(items[3]), span=over(items))

    def case_else(self, items: Items) -> Any:
        return n.Case(items[1], self._branches(items[3]), self._statements(items[5]), span=over(items))

    def for_(self, items: Items) -> Any:
        statements = self._statements(items[7])
        return n.For(items[1], items[3], items[5], None, statements, span=over(items))

    def for_by(self, items: Items) -> Any:
        statements = self._statements(items[9])
        return n.For(items[1], items[3], items[5], items[7], statements, span=over(items))

    def while_(self, items: Items) -> Any:
        return n.While(items[1], self._statements(items[3]), span=over(items))

    def repeat(self, items: Items) -> Any:
        return n.Repeat(self._statements(items[1]), items[3], span=over(items))

    repeat_closed = repeat

    def region(self, items: Items) -> Any:
        title: str = items[0].value[len("REGION") :].strip()
        return n.RegionBlock(title, self._statements(items[1]), span=over(items))

    def try_(self, items: Items) -> Any:
        handler = next((i for i in items if isinstance(i, _Handler)), None)
        final = next((i for i in items[2:] if isinstance(i, StatementList)), None)
        statements = self._statements(items[1])
        return n.Try(
            statements,
            None if handler is None else handler.error,
            None if handler is None else self._statements(handler.statements),
            None if final is None else self._statements(final),
            span=over(items),
        )

    def catch(self, items: Items) -> Any:
        error = items[2] if len(items) > 2 else None  # in parentheses
        return _Handler(error, items[-1], items[0].span)

    def whole(self, found: StatementList, end: int) -> n.Node:
        """Return the tree of a text of length `end`, of what was found in it."""
        return n.Statements(self._statements(found), span=(0, end))

    def _statements(self, found: StatementList) -> tuple[n.Statement, ...]:
        """`found` outside of CASE, where a label is a place to jump to."""
        return tuple(self._jump_label(item) if isinstance(item, _Labels) else item for item in found)

    def _jump_label(self, labels: _Labels) -> n.Statement:
        only = labels.labels[0]
        if len(labels.labels) == 1 and isinstance(only, n.Name):
            return n.LabelStatement(only, span=labels.span)
        self.problems.append(Problem("labels of this form belong into a CASE", labels.span))
        return n.Unreadable("", span=labels.span)

    def _branches(self, found: StatementList) -> tuple[n.CaseBranch, ...]:
        """Return the branches of a CASE: each label starts one."""
        branches: list[n.CaseBranch] = []
        labels: _Labels | None = None
        statements = StatementList()

        def close() -> None:
            if labels is not None:
                end = statements[-1].span[1] if statements else labels.span[1]
                span = (labels.span[0], end)
                branches.append(n.CaseBranch(tuple(labels.labels), tuple(statements), span=span))

        for item in found:
            if isinstance(item, _Labels):
                close()
                labels, statements = item, StatementList()
            elif labels is None:
                if not isinstance(item, n.Empty | n.Unreadable):
                    self.problems.append(Problem("a label is missing before this statement", item.span))
            else:
                statements.append(item)
        close()
        return tuple(branches)


def _end(statements: StatementList, token: Token) -> int:
    end: int = statements[-1].span[1] if statements else token.span[1]
    return end


def name_of(token: Token) -> n.Name:
    """Return the name that a token is, without its quotes."""
    value = token.value
    if value[0] == '"':
        return n.Name(value[1:-1], n.Quoting.GLOBAL, span=token.span)
    if value[0] == "#":
        if value[1] == '"':
            return n.Name(value[2:-1], n.Quoting.LOCAL_QUOTED, span=token.span)
        return n.Name(value[1:], n.Quoting.LOCAL, span=token.span)
    return n.Name(value, span=token.span)


def _power_of_signed(left: n.Unary, right: Expression, span: Span) -> n.Unary:
    """``-a ** b`` as SCL reads it: the sign is before the power."""
    inner: Expression
    below = (left.operand.span[0] if left.operand.span else span[0], span[1])
    if isinstance(left.operand, n.Unary):
        inner = _power_of_signed(left.operand, right, below)
    else:
        inner = n.Operation(Operator.POWER, (left.operand, right), span=below)
    return n.Unary(left.operator, inner, span=span)


_DECLARATIONS: dict[str, Callable[[Items], Any]] = {
    "words": lambda _: [],
    "nothing": lambda _: None,
    "absent": lambda _: None,
    # -- heads
    "property": lambda items: d.Property(items[0].value.upper(), items[2].value, span=over(items)),
    "single_property": lambda items: d.Property(items[0].value.upper(), span=over(items)),
    "program_instance": lambda items: d.ProgramInstance(items[2], name_of(items[4]), items[6], span=over(items)),
    "task": lambda items: d.TaskNode(name_of(items[1]), tuple(items[3]), span=over(items)),
    "end": lambda items: d.EndNode(items[0].value.upper(), span=over(items)),
    "struct_body": lambda items: d.StructBody(items[0], span=over(items)),
    # -- sections
    "access_section": lambda items: d.AccessSectionNode(tuple(items[1]), span=over(items)),
    "config_section": lambda items: d.ConfigSectionNode(tuple(items[1]), span=over(items)),
    "type_section": lambda items: d.TypeSection(tuple(items[1]), span=over(items)),
    "first_name": lambda items: [name_of(items[0])],
    "names_only": lambda items: _Declared(tuple(items[0]), None, over(items[0])),
    "names_at": lambda items: _Declared(tuple(items[0]), items[2], (items[0][0].span[0], items[2].span[1])),
    "address_only": lambda items: _Declared((), _address(items[1:]), over(items)),
    "type_name": lambda items: items,
    "scl_type": lambda items: d.TypeDeclaration(
        name_of(items[0]), items[2], properties=tuple(items[1]), span=over(items)
    ),
    # -- types
    "array_type": lambda items: d.ArrayTypeNode(tuple(items[2]), items[5], span=over(items)),
    "pointer": lambda items: d.PointerTypeNode(items[0].value.upper(), items[2], span=over(items)),
    "reference": lambda items: d.PointerTypeNode("REF_TO", items[1], span=over(items)),
    "enum": lambda items: d.EnumTypeNode(tuple(items[1]), span=over(items)),
    "enum_with_base": lambda items: d.EnumTypeNode(
        tuple(items[1]), d.NamedType(items[3], span=items[3].span), span=over(items)
    ),
    "enum_value": lambda items: d.EnumValueNode(
        name_of(items[0]), items[2] if len(items) > 1 else None, span=over(items)
    ),
    "struct": lambda items: d.StructTypeNode(tuple(items[1]), items[0].type == "UNION", span=over(items)),
    # -- initial values
    "repetition": lambda items: d.Repetition(_literal(items), items[2], span=over(items)),
    "empty_repetition": lambda items: d.Repetition(_literal(items), None, span=over(items)),
    "empty_array": lambda items: d.ArrayValueNode((), span=over(items)),
    "array_value": lambda items: d.ArrayValueNode(tuple(map(_item, items[1])), span=over(items)),
    "empty_struct": lambda items: d.StructValueNode((), span=over(items)),
    "struct_value": lambda items: d.StructValueNode(tuple(items[1]), span=over(items)),
    "struct_by_position": lambda items: d.StructValueNode((items[1], *items[3]), span=over(items)),
    "struct_of_one": lambda items: d.StructValueNode((items[1],), span=over(items)),
    "member_value": lambda items: d.MemberValueNode(name_of(items[0]), _value([items[2]]), span=over(items)),
}
"""The same for the aliases of ``declarations.lark``."""


class DeclarationBuilder(Builder):
    """The builder for ``declarations.lark`` beside ``st.lark``."""

    RULES = _NODES | _DECLARATIONS

    # -- lists

    def one_more_type(self, items: Items) -> Any:
        types, further = items
        if further is not None:
            types.append(further)
        return types

    # -- heads

    def head(self, items: Items) -> Any:
        keyword, qualifiers, name, type_, clauses, properties = items[:6]
        type_ = items[6] if len(items) > 6 else type_
        extends = tuple(path for word, paths in clauses if word == "EXTENDS" for path in paths)
        implements = tuple(path for word, paths in clauses if word == "IMPLEMENTS" for path in paths)
        parts = [keyword, name, *([type_] if type_ is not None else []), *extends, *implements, *properties]
        span = (keyword.span[0], max(part.span[1] for part in parts))
        words = tuple(word.value.upper() for word in qualifiers)
        return d.PouHead(keyword.value.upper(), name, words, type_, extends, implements, tuple(properties), span=span)

    def data_block_of(self, items: Items) -> Any:
        if items[0].value.upper() != "DATA_BLOCK":
            self.problems.append(Problem("only a DATA_BLOCK has a name here", items[6].span))
        return self.head([*items[:6], d.NamedType(items[6], span=items[6].span)])

    def clause(self, items: Items) -> Any:
        items[0].append((items[1].type, items[2]))
        return items[0]

    def title(self, items: Items) -> Any:
        text: str = items[0].value
        return d.Property("TITLE", text.partition("=")[2].strip(), span=over(items))

    # -- sections

    def section(self, items: Items) -> Any:
        qualifiers = tuple(word.value.upper() for word in items[1])
        return d.Section(items[0].value.upper(), qualifiers, tuple(items[2]), span=over(items))

    def further_name(self, items: Items) -> Any:
        items[0].append(name_of(items[2]))
        return items[0]

    def variable(self, items: Items) -> Any:
        return d.VariableDeclaration(items[0].names, items[2], items[0].address, span=over(items))

    def edge_variable(self, items: Items) -> Any:
        edge = items[3].value.upper()
        return d.VariableDeclaration(items[0].names, items[2], items[0].address, edge=edge, span=over(items))

    def variable_with_value(self, items: Items) -> Any:
        declared: _Declared = items[0]
        return d.VariableDeclaration(declared.names, items[2], declared.address, _value(items[4]), span=over(items))

    def access_path(self, items: Items) -> Any:
        direction = items[5].value.upper() if items[5].type == "DIRECTION" else ""
        return d.AccessPath(name_of(items[0]), items[2], items[4], direction, span=over(items))

    def located(self, items: Items) -> Any:
        address = _address(items[2:]) if len(items) > 1 else None
        return _Declared((items[0],), address, over(items))

    def config_entry(self, items: Items) -> Any:
        declared: _Declared = items[0]
        initial = _value(items[4]) if items[3].type == "ASSIGN" else None
        return d.ConfigEntry(declared.names[0], items[2], declared.address, initial, span=over(items))

    def type_declaration(self, items: Items) -> Any:
        name, extends = items[0][0], items[0][2] if len(items[0]) > 1 else None
        initial = _value(items[4]) if len(items) > 4 else None
        span = (name.span[0], items[-1].span[1])
        return d.TypeDeclaration(name_of(name), items[2], initial, extends, span=span)

    # -- types

    def named_type(self, items: Items) -> Any:
        name: Expression = items[0]
        if isinstance(name, n.Name) and name.identifier.upper() in _STRINGS:
            return d.StringTypeNode(name, span=name.span)
        return d.NamedType(name, span=name.span)

    def type_with_arguments(self, items: Items) -> Any:
        name, arguments = items[0], tuple(items[2]) if len(items) > 3 else ()
        word = name.identifier.upper() if isinstance(name, n.Name) else ""
        if word in _STRINGS and len(arguments) == 1 and arguments[0].name is None:
            return d.StringTypeNode(name, arguments[0].value, span=over(items))
        if word in _INTEGERS:
            values = tuple(_enum_value(argument) for argument in arguments)
            if values and None not in values:
                return d.EnumTypeNode(values, d.NamedType(name, span=name.span), span=over(items))  # type: ignore[arg-type]  # no None among them
        return d.NamedType(name, arguments, span=over(items))

    def subrange(self, items: Items) -> Any:
        bounds = n.Range(items[2], items[4], span=over(items[2:5]))
        return d.SubrangeTypeNode(d.NamedType(items[0], span=items[0].span), bounds, span=over(items))

    def sized_type(self, items: Items) -> Any:
        name: Expression = items[0]
        if not isinstance(name, n.Name) or name.identifier.upper() not in _STRINGS:
            self.problems.append(Problem("only STRING and WSTRING have a length", over(items)))
            name = name if isinstance(name, n.Name) else n.Name("STRING", span=name.span)
        return d.StringTypeNode(name, items[2], span=over(items))

    def open_dimension(self, items: Items) -> Any:
        if items[0].value != "*":
            self.problems.append(Problem("a dimension is missing here", items[0].span))
        return d.OpenDimension(span=items[0].span)

    # -- initial values

    def further_element(self, items: Items) -> Any:
        """Another element of the array that is the last member: it has no brackets (CoDeSys V2.3)."""
        members, last = items[0], items[0][-1]
        value = last.value
        is_bare = isinstance(value, d.ArrayValueNode) and value.span == over(value.items)
        elements = (*value.items, _item(items[2])) if is_bare else (value, _item(items[2]))
        array = d.ArrayValueNode(elements, span=over(elements))
        members[-1] = d.MemberValueNode(last.member, array, span=over((last, items[2])))
        return members

    # -- the whole

    def whole(self, found: StatementList, end: int) -> n.Node:
        return d.Declarations(tuple(found), span=(0, end))


@dataclass(slots=True, eq=False)
class _Declared:
    """The part of a variable before its colon."""

    names: tuple[Any, ...]
    address: Expression | None
    span: Span


def _item(value: Any) -> Any:
    """``N(0)`` in an array is no call but a repetition."""
    if isinstance(value, n.Call) and len(value.arguments) == 1 and value.arguments[0].name is None:
        return d.Repetition(value.callee, value.arguments[0].value, span=value.span)
    return value


def _value(items: Items) -> Any:
    """Return the initial value; several items without brackets are an array (CoDeSys V2.3)."""
    if len(items) == 1 and not isinstance(items[0], d.Repetition):
        return items[0]
    return d.ArrayValueNode(tuple(_item(item) for item in items), span=over(items))


def _enum_value(argument: n.Argument) -> d.EnumValueNode | None:
    if argument.name is not None and not argument.output and not argument.negated:
        return d.EnumValueNode(argument.name, argument.value, span=argument.span)
    if argument.name is None and isinstance(argument.value, n.Name):
        return d.EnumValueNode(argument.value, span=argument.span)
    return None
