"""Name sites in declarations: those kept as text, and data of CODESYS that repeats a list of global variables."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from plcopen_sfc.languages.binding.name_sites import Reference, in_pragmas, in_tree, moved, named, unread
from plcopen_sfc.languages.binding.text_sites import Role
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import declaration_nodes as d
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.parsing import parse_declarations
from plcopen_sfc.languages.st.walking import children


def in_declarations(text: str, dialect: Dialect) -> Iterator[Reference]:
    """Every name in a text of declarations, those that it declares too."""
    parsed = parse_declarations(text, dialect)
    yield from _in(parsed.tree, dialect, ())
    yield from in_pragmas(parsed)


def _in(
    node: n.Node, dialect: Dialect, within: tuple[str, ...], type_: n.Expression | None = None
) -> Iterator[Reference]:
    """The names in `node`, which belongs to the type of what `within` leads to; `type_` is that of initial values."""
    if isinstance(node, d.PouHead):
        if isinstance(node.name, n.Name):
            yield replace(named(node.name), role=Role.HEAD)
        for base in (*node.extends, *node.implements):
            yield from _types(base, dialect)
        if node.type is not None:
            yield from _in(node.type, dialect, within)
    elif isinstance(node, d.TypeDeclaration):
        yield replace(named(node.name), role=Role.TYPE)
        if node.extends is not None:
            yield from _types(node.extends, dialect)
        yield from _in(node.type, dialect, (node.name.identifier,))
        if node.initial is not None:
            own = node.name if isinstance(node.type, d.EnumTypeNode) else _innermost(node.type)
            yield from _in(node.initial, dialect, within, own)
    elif isinstance(node, d.NamedType):
        yield from _types(node.name, dialect)
        for argument in node.arguments or ():
            yield from in_tree(argument, dialect)
    elif isinstance(node, d.VariableDeclaration):
        for name in node.names:
            yield named(name, declares=True, within=within)
        if node.address is not None:
            yield from in_tree(node.address, dialect)
        inside = (*within, node.names[0].identifier) if node.names else within
        yield from _in(node.type, dialect, inside)
        if node.initial is not None:
            yield from _in(node.initial, dialect, within, _innermost(node.type))
    elif isinstance(node, d.EnumValueNode):
        yield named(node.name, declares=True, within=within)
        if node.value is not None:
            yield from in_tree(node.value, dialect)
    elif isinstance(node, d.MemberValueNode):
        yield named(node.member, base=type_, unread="" if type_ is not None else "what it is a member of has no name")
        of = None if type_ is None else n.Member(type_, node.member, span=type_.span)
        yield from _in(node.value, dialect, within, of)
    elif isinstance(node, n.Name):
        yield named(node, expected=type_)
    elif isinstance(node, d.StringTypeNode):
        if node.length is not None:
            yield from in_tree(node.length, dialect)
    elif isinstance(node, d.AccessPath):
        yield from in_tree(node.path, dialect)
        yield from _in(node.type, dialect, within)
    elif type(node).__module__ == d.__name__:
        for child in children(node):
            yield from _in(child, dialect, within, type_)
    else:
        yield from in_tree(node, dialect)


def _types(name: n.Expression, dialect: Dialect) -> Iterator[Reference]:
    for reference in in_tree(name, dialect):
        yield replace(reference, role=Role.TYPE)


def _innermost(type_: d.TypeNode) -> n.Expression | None:
    """The name of a type, or of that which it is an array of."""
    while isinstance(type_, d.ArrayTypeNode | d.PointerTypeNode):
        type_ = type_.base
    return type_.name if isinstance(type_, d.NamedType) else None


_SAID = re.compile(
    r"<globalVars\b[^>]*?\bname=\"(?P<list>[^\"]*)\"|<variable\b[^>]*?\bname=\"(?P<variable>[^\"]*)\""
    r"|<derived\b[^>]*?\bname=\"(?P<type>[^\"]*)\"|<simpleValue\b[^>]*?\bvalue=\"(?P<value>[^\"]*)\""
    r"|<(?P<comment>documentation)\b.*?</documentation>",
    re.DOTALL,
)


def in_repeated_list(markup: str, dialect: Dialect) -> Iterator[Reference]:
    """The names in the parts of a list of global variables. Comments hold none; what else there is cannot be read."""
    done = 0
    for found in _SAID.finditer(markup):
        yield from _rest(markup, done, found.start())
        done = found.end()
        kind = found.lastgroup or ""
        text, (start, end) = found[kind], found.span(kind)
        if kind == "list":
            yield Reference(text, (start, end), Role.HEAD)
        elif kind == "variable":
            yield Reference(text, (start, end), declares=True)
        elif kind == "type":
            yield Reference(text, (start, end), Role.TYPE)
        elif kind == "value" and "&" not in text:
            yield from moved(in_tree(parse_expression(text, dialect).tree, dialect), start)
        elif kind == "value":
            yield from unread(text, start, "it is written with references of XML", dialect)
    yield from _rest(markup, done, len(markup))


def _rest(markup: str, start: int, end: int) -> Iterator[Reference]:
    """Texts and attributes of elements that are not known here."""
    for value in re.finditer(r"=\"([^\"]*)\"|>([^<]*)<", markup[start:end]):
        inner = value.lastindex or 0
        yield from unread(value[inner], start + value.start(inner), "it stands in data that only another tool reads")
