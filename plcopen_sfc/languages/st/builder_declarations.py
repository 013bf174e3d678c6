"""Makes the nodes of declarations while the parser recognises the rules of ``declarations.lark``."""

from __future__ import annotations

from typing import Any

from plcopen_sfc.languages.problems import Problem
from plcopen_sfc.languages.st import declaration_nodes as d
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.builder import Builder, Items, StatementList, name_of, over
from plcopen_sfc.languages.st.nodes import Expression, Span

_STRINGS = frozenset({"STRING", "WSTRING"})
_INTEGERS = frozenset("SINT INT DINT LINT USINT UINT UDINT ULINT BYTE WORD DWORD LWORD".split())


class DeclarationBuilder(Builder):
    """One method for each alias of ``declarations.lark``, beside those of ``st.lark``."""

    # -- lists

    def words(self, _: Items) -> Any:
        return []

    def nothing(self, _: Items) -> Any:
        return None

    absent = nothing

    def second(self, items: Items) -> Any:
        return items[1]

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

    def property(self, items: Items) -> Any:
        return d.Property(items[0].value.upper(), items[2].value, span=over(items))

    def title(self, items: Items) -> Any:
        text: str = items[0].value
        return d.Property("TITLE", text.partition("=")[2].strip(), span=over(items))

    def single_property(self, items: Items) -> Any:
        return d.Property(items[0].value.upper(), span=over(items))

    def program_instance(self, items: Items) -> Any:
        return d.ProgramInstance(items[2], name_of(items[4]), items[6], span=over(items))

    def task(self, items: Items) -> Any:
        return d.TaskNode(name_of(items[1]), tuple(items[3]), span=over(items))

    def end(self, items: Items) -> Any:
        return d.EndNode(items[0].value.upper(), span=over(items))

    def struct_body(self, items: Items) -> Any:
        return d.StructBody(items[0], span=over(items))

    # -- sections

    def section(self, items: Items) -> Any:
        qualifiers = tuple(word.value.upper() for word in items[1])
        return d.Section(items[0].value.upper(), qualifiers, tuple(items[2]), span=over(items))

    def access_section(self, items: Items) -> Any:
        return d.AccessSectionNode(tuple(items[1]), span=over(items))

    def config_section(self, items: Items) -> Any:
        return d.ConfigSectionNode(tuple(items[1]), span=over(items))

    def type_section(self, items: Items) -> Any:
        return d.TypeSection(tuple(items[1]), span=over(items))

    def first_name(self, items: Items) -> Any:
        return [name_of(items[0])]

    def further_name(self, items: Items) -> Any:
        items[0].append(name_of(items[2]))
        return items[0]

    def names_only(self, items: Items) -> Any:
        return _Declared(tuple(items[0]), None, over(items[0]))

    def names_at(self, items: Items) -> Any:
        return _Declared(tuple(items[0]), items[2], (items[0][0].span[0], items[2].span[1]))

    def address_only(self, items: Items) -> Any:
        return _Declared((), self.address(items[1:]), over(items))

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
        address = self.address(items[2:]) if len(items) > 1 else None
        return _Declared((items[0],), address, over(items))

    def config_entry(self, items: Items) -> Any:
        declared: _Declared = items[0]
        initial = _value(items[4]) if items[3].type == "ASSIGN" else None
        return d.ConfigEntry(declared.names[0], items[2], declared.address, initial, span=over(items))

    def type_name(self, items: Items) -> Any:
        return items

    def type_declaration(self, items: Items) -> Any:
        name, extends = items[0][0], items[0][2] if len(items[0]) > 1 else None
        initial = _value(items[4]) if len(items) > 4 else None
        span = (name.span[0], items[-1].span[1])
        return d.TypeDeclaration(name_of(name), items[2], initial, extends, span=span)

    def scl_type(self, items: Items) -> Any:
        return d.TypeDeclaration(name_of(items[0]), items[2], properties=tuple(items[1]), span=over(items))

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

    def array_type(self, items: Items) -> Any:
        return d.ArrayTypeNode(tuple(items[2]), items[5], span=over(items))

    def open_dimension(self, items: Items) -> Any:
        if items[0].value != "*":
            self.problems.append(Problem("a dimension is missing here", items[0].span))
        return d.OpenDimension(span=items[0].span)

    def pointer(self, items: Items) -> Any:
        return d.PointerTypeNode(items[0].value.upper(), items[2], span=over(items))

    def reference(self, items: Items) -> Any:
        return d.PointerTypeNode("REF_TO", items[1], span=over(items))

    def enum(self, items: Items) -> Any:
        return d.EnumTypeNode(tuple(items[1]), span=over(items))

    def enum_with_base(self, items: Items) -> Any:
        return d.EnumTypeNode(tuple(items[1]), d.NamedType(items[3], span=items[3].span), span=over(items))

    def enum_value(self, items: Items) -> Any:
        return d.EnumValueNode(name_of(items[0]), items[2] if len(items) > 1 else None, span=over(items))

    def struct(self, items: Items) -> Any:
        return d.StructTypeNode(tuple(items[1]), items[0].type == "UNION", span=over(items))

    # -- initial values

    def repetition(self, items: Items) -> Any:
        return d.Repetition(self.literal(items), items[2], span=over(items))

    def empty_repetition(self, items: Items) -> Any:
        return d.Repetition(self.literal(items), None, span=over(items))

    def empty_array(self, items: Items) -> Any:
        return d.ArrayValueNode((), span=over(items))

    def array_value(self, items: Items) -> Any:
        return d.ArrayValueNode(tuple(_item(item) for item in items[1]), span=over(items))

    def empty_struct(self, items: Items) -> Any:
        return d.StructValueNode((), span=over(items))

    def struct_value(self, items: Items) -> Any:
        return d.StructValueNode(tuple(items[1]), span=over(items))

    def struct_by_position(self, items: Items) -> Any:
        return d.StructValueNode((items[1], *items[3]), span=over(items))

    def struct_of_one(self, items: Items) -> Any:
        return d.StructValueNode((items[1],), span=over(items))

    def member_value(self, items: Items) -> Any:
        return d.MemberValueNode(name_of(items[0]), items[2], span=over(items))

    # -- the whole

    def whole(self, found: StatementList, end: int) -> n.Node:
        return d.Declarations(tuple(found), span=(0, end))


class _Declared:
    """The part of a variable before its colon."""

    __slots__ = ("address", "names", "span")

    def __init__(self, names: tuple[Any, ...], address: Expression | None, span: Span) -> None:
        self.names = names
        self.address = address
        self.span = span


def _item(value: Any) -> Any:
    """``N(0)`` in an array is no call but a repetition."""
    if isinstance(value, n.Call) and len(value.arguments) == 1 and value.arguments[0].name is None:
        return d.Repetition(value.callee, value.arguments[0].value, span=value.span)
    return value


def _value(items: Items) -> Any:
    """The initial value; several items without brackets are an array (CoDeSys V2.3)."""
    if len(items) == 1 and not isinstance(items[0], d.Repetition):
        return items[0]
    return d.ArrayValueNode(tuple(_item(item) for item in items), span=over(items))


def _enum_value(argument: n.Argument) -> d.EnumValueNode | None:
    if argument.name is not None and not argument.output and not argument.negated:
        return d.EnumValueNode(argument.name, argument.value, span=argument.span)
    if argument.name is None and isinstance(argument.value, n.Name):
        return d.EnumValueNode(argument.value, span=argument.span)
    return None
