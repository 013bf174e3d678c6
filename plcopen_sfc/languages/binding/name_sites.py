"""The names in a text, and what each of them is there: a name on its own, a member, a parameter of a call."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from plcopen_sfc.languages.binding.text_sites import Role
from plcopen_sfc.languages.declarations.kept_texts import kept_entries
from plcopen_sfc.languages.declarations.type_names import ELEMENTARY
from plcopen_sfc.languages.grafcet_conditions import OVERLINE, program_parts
from plcopen_sfc.languages.il import CALLS, JUMPS, instructions
from plcopen_sfc.languages.networks.exported_networks import network_operands
from plcopen_sfc.languages.st import Parsed, parse_body, parse_condition, parse_expression
from plcopen_sfc.languages.st import declaration_nodes as d
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import CommentKind, tokenize
from plcopen_sfc.languages.st.nodes import Quoting, Span
from plcopen_sfc.languages.st.parsing import parse_declarations
from plcopen_sfc.languages.st.walking import children, walk
from plcopen_sfc.model.dialect import Dialect


@dataclass(frozen=True, slots=True)
class Reference:
    """A name in a text.

    `span` is that of the bare word, without quotes. `base`: it is a member of this (``base.name``); `callee`: it is a
    parameter in a call of this; `access`: the member of it that is meant (``name.access``); `expected`: it stands
    where a value of the type of this is expected (``expected := name``), or of the type that this names. `unread`: why
    the text around it cannot be read. `declares`: it is declared here, in the type of what
    `within` leads to. `overlined`: the name has a line over it, as a GRAFCET negates.
    """

    name: str
    span: Span
    role: Role = Role.VALUE
    quoting: Quoting = Quoting.NONE
    base: n.Expression | None = None
    callee: n.Expression | None = None
    access: str = ""
    expected: n.Expression | None = None
    unread: str = ""
    declares: bool = False
    within: tuple[str, ...] = ()
    overlined: bool = False


def in_statements(text: str, dialect: Dialect) -> Iterator[Reference]:
    """Yield every name in statements, or in the condition that the body of a transition may be."""
    parsed = parse_body(text, dialect)
    yield from in_tree(parsed.tree, dialect)
    yield from in_pragmas(parsed)


def in_pragmas(parsed: Parsed[Any]) -> Iterator[Reference]:
    """Yield the words of pragmas that ask for things by name: ``{IF defined (variable: x)}`` of CODESYS."""
    for comment in parsed.comments:
        if comment.kind is CommentKind.PRAGMA and _ASKING.match(comment.text):
            yield from unread(comment.text, comment.span[0], "it is in a pragma")


_ASKING = re.compile(r"\{\s*(?:ELS)?IF\b", re.IGNORECASE)


def moved(found: Iterator[Reference], start: int) -> Iterator[Reference]:
    """References from a text that begins at `start` of another."""
    for reference in found:
        yield replace(reference, span=(reference.span[0] + start, reference.span[1] + start))


def in_tree(node: n.Node, dialect: Dialect, access: str = "") -> Iterator[Reference]:
    """Yield every name in a tree. Labels and what GOTO names are none: they belong to their body alone.

    `access` is the member of it that is meant.
    """
    if isinstance(node, n.Name):
        yield named(node, access=access)
    elif isinstance(node, n.Member):
        if node.name.quoting is not Quoting.NONE or node.name.identifier[:1] not in "%0123456789":  # a bit of a word
            yield named(node.name, base=node.base, access=access)
        yield from in_tree(node.base, dialect, node.name.identifier)
    elif isinstance(node, n.CallStatement) and isinstance(node.call, n.Name):
        yield named(node.call, role=Role.ACTION)
    elif isinstance(node, n.Call):
        if isinstance(node.callee, n.Name):
            yield named(node.callee, role=Role.CALL)
        else:
            yield from in_tree(node.callee, dialect)
        for argument in node.arguments:
            if argument.name is not None:
                yield named(argument.name, callee=node.callee)
            if argument.value is not None and not (node.called.upper() in _OF_TYPES and _is_elementary(argument.value)):
                yield from in_tree(argument.value, dialect)
    elif isinstance(node, n.TypeOperand) and _is_elementary(node.base):
        for bound in node.bounds:
            yield from in_tree(bound, dialect)
    elif isinstance(node, n.Assignment | n.AssignmentExpression):
        yield from in_tree(node.target, dialect)
        yield from _expecting(node.target, node.value, dialect)
    elif isinstance(node, n.Operation) and node.operator in (n.Operator.EQUAL, n.Operator.UNEQUAL):
        # as in an assignment, a bare name may be a value of the enumeration on the other side
        left, right = node.operands
        yield from _expecting(right, left, dialect)
        yield from _expecting(left, right, dialect)
    elif isinstance(node, n.Case):
        yield from in_tree(node.selector, dialect)
        for branch in node.branches:
            for label in branch.labels:
                yield from _expecting(node.selector, label, dialect)
            for statement in branch.statements:
                yield from in_tree(statement, dialect)
        for statement in node.otherwise or ():
            yield from in_tree(statement, dialect)
    elif isinstance(node, n.Literal):
        yield from _in_literal(node)
    elif isinstance(node, n.Unreadable):
        start = node.span[0] if node.span is not None else 0
        yield from unread(node.text, start, "the text around it cannot be read", dialect)
    elif not isinstance(node, n.Goto | n.LabelStatement):
        for child in children(node):
            yield from in_tree(child, dialect)


def _expecting(expected: n.Expression, value: n.Node, dialect: Dialect) -> Iterator[Reference]:
    """Yield the names in a value; one on its own may be a value of the enumeration that is expected."""
    if isinstance(value, n.Name):
        yield named(value, expected=expected)
    else:
        yield from in_tree(value, dialect)


def named(name: n.Name, **what: Any) -> Reference:
    """Return the reference that a name is."""
    start, end = name.span or (0, 0)
    return Reference(
        name.identifier,
        (start + len(name.quoting), end - name.quoting.count('"')),
        quoting=name.quoting,
        **what,
    )


_ENUMERATED = re.compile(r"([^\W\d]\w*)#([^\W\d]\w*)")
_TIME_PREFIX = frozenset("T TIME LT LTIME S5T S5TIME D DATE TOD DT".split())


def _in_literal(literal: n.Literal) -> Iterator[Reference]:
    """``Color#red`` names a type and one of its values."""
    found = _ENUMERATED.fullmatch(literal.text)
    if found is None or literal.span is None or found[1].upper() in _TIME_PREFIX:
        return
    start = literal.span[0]
    type_ = n.Name(found[1], span=(start, start + found.end(1)))
    yield named(type_, access=found[2])
    yield named(n.Name(found[2], span=(start + found.start(2), start + found.end(2))), base=type_)


def in_expression(text: str, role: Role, dialect: Dialect) -> Iterable[Reference]:
    """Return every name in an expression; `role` is that of the last name of a path."""
    # a conversion asks for those of each condition several times, and equal ones repeat, as for the parser
    return _cached_in_expression(text, role, dialect) if len(text) <= _CACHED else _in_expression(text, role, dialect)


_CACHED = 1000


@lru_cache(maxsize=16384)
def _cached_in_expression(text: str, role: Role, dialect: Dialect) -> tuple[Reference, ...]:
    return tuple(_in_expression(text, role, dialect))


def _in_expression(text: str, role: Role, dialect: Dialect) -> Iterator[Reference]:
    if _DURATION.fullmatch(text):
        return
    if role is Role.TYPE and dialect is Dialect.SCL:  # a name with any characters in it
        quotes = len(text) - len(text.lstrip('"'))
        yield Reference(text.strip('"'), (quotes, len(text) - quotes), role)
        return
    parsed = parse_condition(text, dialect)
    is_grafcet = bool(parsed.problems) or (dialect is not Dialect.SCL and _DOT_BESIDE_BLANKS.search(text) is not None)
    if is_grafcet and role is Role.VALUE and (parts := program_parts(text)):
        for start, end in parts:
            if OVERLINE in text[start:end]:
                yield Reference(text[start:end].replace(OVERLINE, ""), (start, end), overlined=True)
                continue
            yield from moved(in_tree(parse_condition(text[start:end], dialect).tree, dialect), start)
        return
    tree = parsed.tree
    outermost = tree.name if isinstance(tree, n.Member) else tree
    for reference in in_tree(tree, dialect):
        whole = isinstance(outermost, n.Name) and outermost.span is not None and reference.span[0] >= outermost.span[0]
        yield replace(reference, role=role) if whole and role is not Role.VALUE else reference


_DOT_BESIDE_BLANKS = re.compile(r"[ \t]\.|\.[ \t]")
"""``START . 1B1`` of a GRAFCET is START AND 1B1; a path in a program has no blanks beside its dots."""
_DURATION = re.compile(r"\s*(?:P[\dDT.]+[\dHMS.]*|[\d.]+ *(?:d|h|m|s|ms|us|ns))\s*", re.IGNORECASE)
"""Durations that are no literals of the language: ``PT0.02S`` of CODESYS exports, ``10s``."""


def in_instructions(text: str, dialect: Dialect) -> Iterator[Reference]:
    """Yield every name in instruction list, but for labels."""
    for instruction in instructions(text, dialect):
        if instruction.is_function:
            yield Reference(instruction.operator, instruction.operator_span, Role.CALL)
        if instruction.operator.upper() in JUMPS:
            continue
        calls = instruction.operator.upper() in CALLS
        for operand in instruction.operands:
            tree = operand.parsed.tree
            yield from moved(in_tree(n.CallStatement(tree) if calls else tree, dialect), operand.start)


_OF_TYPES = frozenset({"__NEW", "SIZEOF", "XSIZEOF"})


def _is_elementary(operand: n.Expression) -> bool:
    """True for the name of an elementary type: nothing that is declared can have it."""
    if not isinstance(operand, n.Name) or operand.quoting is not Quoting.NONE:
        return False
    return operand.identifier.upper() in ELEMENTARY.keys() | {"STRING", "WSTRING"}


def in_networks(text: str, dialect: Dialect) -> Iterator[Reference]:
    """Yield every name in networks of an export of CoDeSys 2.3; all words of those that are not understood."""
    operands = network_operands(text)
    if operands is None:
        yield from unread(text, 0, "it is in networks that are not understood")
    for start, tree in operands or ():
        yield from moved(in_tree(tree, dialect), start)


def unread(text: str, start: int, reason: str, dialect: Dialect | None = None) -> Iterator[Reference]:
    """Yield the words of a text that cannot be read; in program text those outside of comments and strings."""
    if dialect is None:
        for word in re.finditer(r"[^\W\d]\w*", text):
            yield Reference(word.group(), (start + word.start(), start + word.end()), unread=reason)
        return
    for token in tokenize(text, dialect).tokens:
        if token.type == "NAME":
            bare = token.value.strip('#"')
            begin = start + token.span[0] + token.value.index(bare)
            yield Reference(bare, (begin, begin + len(bare)), unread=reason)
        elif token.type == "BAD":
            yield from unread(token.value, start + token.span[0], reason)


def in_declarations(text: str, dialect: Dialect) -> Iterator[Reference]:
    """Yield every name in a text of declarations, those that it declares too."""
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
            # the start value of an enumeration is one of its own values, that of another type a value of what it is
            # made of
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
    """Return the name of a type, or of that which it is an array of."""
    while isinstance(type_, d.ArrayTypeNode | d.PointerTypeNode):
        type_ = type_.base
    return type_.name if isinstance(type_, d.NamedType) else None


_SAID = re.compile(
    r"<globalVars\b[^>]*?\bname=\"(?P<list>[^\"]*)\"|<variable\b[^>]*?\bname=\"(?P<variable>[^\"]*)\""
    r"|<derived\b[^>]*?\bname=\"(?P<type>[^\"]*)\"|<simpleValue\b[^>]*?\bvalue=\"(?P<value>[^\"]*)\""
    r"|<(?P<comment>documentation)\b.*?</documentation>",
    re.DOTALL,
)


def in_kept_texts(markup: str, dialect: Dialect) -> Iterator[Reference]:
    """The names in parts of declarations that another dialect has: what something extends and implements is read."""
    for name, text, start in kept_entries(markup):
        if name in ("extends", "implements"):
            for part in re.finditer(r"[^,\s][^,]*", text):
                named_type = parse_expression(part[0].rstrip(), dialect).tree
                yield from moved(_types(named_type, dialect), start + part.start())
        else:
            yield from unread(text, start, "it is in a part of a declaration that is kept as text")


def in_property(markup: str, dialect: Dialect) -> Iterator[Reference]:
    """Yield the names in a property that is kept as text, but for those that it declares itself."""
    text = _ESCAPED.sub(lambda found: html.unescape(found[0]).rjust(len(found[0])), markup)  # places stay
    head = _PROPERTY.search(text)
    if head is None:
        yield from unread(text, 0, "it is in a property that cannot be read")
        return
    yield from _types_declared(head["type"], head.start("type"), dialect)
    for accessor in _ACCESSOR.finditer(text, head.end()):
        own, start = {head["name"].casefold()}, accessor.start("inside")
        for block in re.finditer(r"\bVAR\b.*?\bEND_VAR\b", accessor["inside"], re.DOTALL | re.IGNORECASE):
            declared = parse_declarations(block[0], dialect).tree
            names = (name for each in walk(declared) for name in getattr(each, "names", ()) if isinstance(name, n.Name))
            own |= {name.identifier.casefold() for name in names}
            yield from _types_declared(block[0], start + block.start(), dialect)
            start = accessor.start("inside") + block.end()
        for reference in moved(in_statements(text[start : accessor.end("inside")], dialect), start):
            first: n.Node | None = reference.base
            while isinstance(first, n.Member | n.Index | n.Dereference):
                first = first.base
            name = first.identifier if isinstance(first, n.Name) else reference.name if first is None else ""
            if name.casefold() not in own:
                yield reference


def _types_declared(text: str, start: int, dialect: Dialect) -> Iterator[Reference]:
    """Yield the names of types in declarations, or of one type alone."""
    alone = "VAR x : "
    whole = text if text[:3].upper() == "VAR" else f"{alone}{text}; END_VAR"
    offset = start if whole is text else start - len(alone)
    found = (each for each in in_declarations(whole, dialect) if each.role is Role.TYPE)
    yield from moved(found, offset)


_ESCAPED = re.compile(r"(?:&(?:lt|gt|amp);)+=?|=&gt;")
_PROPERTY = re.compile(r"\bPROPERTY\s+(?:\w+\s+)*?(?P<name>\w+)\s*:\s*(?P<type>[^;\n<]+)", re.IGNORECASE)
_ACCESSOR = re.compile(
    r"^[ \t]*(?P<kind>GET|SET)\b[^\n]*\n(?P<inside>.*?)^[ \t]*END_(?P=kind)\b", re.DOTALL | re.MULTILINE | re.IGNORECASE
)


def in_repeated_list(markup: str, dialect: Dialect) -> Iterator[Reference]:
    """Yield the names in the parts of a list of global variables.

    Comments hold none; what else there is cannot be read.
    """
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
    """Yield texts and attributes of elements that are not known here."""
    for value in re.finditer(r"=\"([^\"]*)\"|>([^<]*)<", markup[start:end]):
        inner = value.lastindex or 0
        yield from unread(value[inner], start + value.start(inner), "it is in data that only another tool reads")
