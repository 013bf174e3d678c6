"""From the text of declarations to the model. `declaration_writing` is the way back.

Units of a source text are POUs, types and data blocks; in each is found where its declarations end. Bodies are not
parsed here: a chart in textual form has words of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from plcopen_sfc.languages.declarations.declaration_comments import (
    LINE_END,
    Comments,
    comment_text,
    pragmas,
    read_attributes,
)
from plcopen_sfc.languages.declarations.kept_texts import keep
from plcopen_sfc.languages.declarations.type_names import ELEMENTARY, SECTIONS, UNSIGNED, bare_name, is_quoted_in_scl
from plcopen_sfc.languages.problems import Lines, Problem
from plcopen_sfc.languages.st import declaration_nodes as d
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import Comment, CommentKind, Token, tokenize
from plcopen_sfc.languages.st.nodes import Node, Span
from plcopen_sfc.languages.st.parsing import Parsed, parse_declarations
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model import types as t
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.variables import (
    AccessDirection,
    AccessSection,
    AccessVariable,
    ConfigSection,
    ConfigVariable,
    Interface,
    SectionKind,
    VariableSection,
)

_WITH_BODY = frozenset("PROGRAM FUNCTION_BLOCK FUNCTION CLASS ORGANIZATION_BLOCK DATA_BLOCK METHOD ACTION".split())
_DECLARATIONS = frozenset("TYPE INTERFACE CONFIGURATION".split())
_UNITS = _WITH_BODY | _DECLARATIONS
_POUS = frozenset("PROGRAM FUNCTION_BLOCK FUNCTION CLASS ORGANIZATION_BLOCK DATA_BLOCK".split())
"""Units that stand in no other."""
_SECTIONS = frozenset(
    """VAR VAR_INPUT VAR_OUTPUT VAR_IN_OUT VAR_TEMP VAR_EXTERNAL VAR_GLOBAL VAR_STAT VAR_INST VAR_ACCESS
    VAR_CONFIG VAR_GENERIC""".split()
)
_WORDS = _UNITS | _SECTIONS | {f"END_{word}" for word in _UNITS} | {"END_VAR"}
_SCL_WORDS = _WORDS | {"BEGIN", "STRUCT", "END_STRUCT", "TITLE"}


@dataclass(frozen=True, slots=True)
class DeclaredUnit:
    """A unit of a source text. All places are offsets into it.

    `head` declares: from the keyword up to the body; a unit without a body (a type) is all head. `body` is the text
    between it and the end; `end` is the place of ``END_FUNCTION_BLOCK``, None if it is missing. Lists of global
    variables are units with the keyword ``VAR_GLOBAL``.
    """

    keyword: str
    span: Span
    head: Span
    body: Span | None
    end: Span | None


@dataclass(frozen=True, slots=True)
class Units:
    """The units of a text; `comments` are all of its comments, `problems` what is outside of any unit."""

    units: tuple[DeclaredUnit, ...]
    comments: tuple[Comment, ...]
    problems: tuple[Problem, ...]


def split_units(text: str, dialect: Dialect = Dialect.IEC) -> Units:
    """Return the units of `text`, in their order."""
    found = tokenize(text, dialect, _SCL_WORDS if dialect is Dialect.SCL else _WORDS)
    tokens = found.tokens
    units: list[DeclaredUnit] = []
    problems: list[Problem] = []
    lines = Lines(text)
    position = 0
    while position < len(tokens):
        kind = tokens[position].type
        if kind in _UNITS:
            unit, position = _unit(text, tokens, position, dialect)
            if unit.end is None:
                line, _ = lines.place(unit.span[0])
                message = f"END_{unit.keyword} is missing for the {unit.keyword} in line {line}"
                problems.append(Problem(message, (unit.span[1], unit.span[1])))
            units.append(unit)
        elif kind in _SECTIONS:
            end = _end_of_section(tokens, position)
            span = (tokens[position].span[0], tokens[end - 1].span[1])
            units.append(DeclaredUnit(kind, span, span, None, None))
            position = end
        else:
            position = _stray(tokens, position, problems)
    return Units(tuple(units), tuple(found.comments), tuple(problems))


def _unit(text: str, tokens: list[Token], first: int, dialect: Dialect) -> tuple[DeclaredUnit, int]:
    keyword = tokens[first].type
    closing = f"END_{keyword}"
    stop_at = _POUS if keyword in _WITH_BODY else frozenset()
    index = first + 1
    while index < len(tokens) and tokens[index].type != closing:
        is_name = tokens[index + 1 : index + 2] and tokens[index + 1].type in ("COLON", "COMMA")
        if tokens[index].type in stop_at and not is_name and _begins_a_line(text, tokens, index):
            break
        index += 1
    last = index if index < len(tokens) and tokens[index].type == closing else None
    behind = last if last is not None else min(index, _next_unit(tokens, first + 1))
    start = tokens[first].span[0]
    end = tokens[last].span if last is not None else None
    stop = end[0] if end is not None else tokens[behind - 1].span[1]
    span = (start, end[1] if end is not None else stop)
    after = last + 1 if last is not None else behind
    if keyword in _DECLARATIONS:
        return DeclaredUnit(keyword, span, span, None, end), after
    head_end, split = _end_of_head(text, tokens, first, behind, dialect)
    return DeclaredUnit(keyword, span, (start, head_end), (split, stop), end), after


def _begins_a_line(text: str, tokens: list[Token], index: int) -> bool:
    between = text[tokens[index - 1].span[1] : tokens[index].span[0]]
    return "\n" in between or "\r" in between


def _next_unit(tokens: list[Token], position: int) -> int:
    """Return where the next unit starts, for one whose end is missing."""
    depth = 0
    for index in range(position, len(tokens)):
        kind = tokens[index].type
        depth += (kind in _SECTIONS) - (kind == "END_VAR")
        if depth <= 0 and kind in _UNITS:
            return index
    return len(tokens)


def _end_of_head(text: str, tokens: list[Token], first: int, behind: int, dialect: Dialect) -> Span:
    """Return where the head ends and the body starts: at BEGIN, else behind the last section, else the first line."""
    end = -1
    index = first + 1
    while index < behind:
        kind = tokens[index].type
        if kind == "BEGIN" and dialect is Dialect.SCL:
            return tokens[index].span
        if kind in _SECTIONS:
            index = _end_of_section(tokens, index)
            end = tokens[index - 1].span[1]
            continue
        if kind == "STRUCT" and dialect is Dialect.SCL:
            index = _end_of_struct(tokens, index)
            end = tokens[index - 1].span[1]
            continue
        if end >= 0 and dialect is not Dialect.SCL:
            break
        index += 1
    if end < 0:
        end = _end_of_line(text, tokens, first, behind)
    return end, end


def _end_of_section(tokens: list[Token], position: int) -> int:
    for index in range(position + 1, len(tokens)):
        if tokens[index].type == "END_VAR":
            return index + 1
    return len(tokens)


def _end_of_struct(tokens: list[Token], position: int) -> int:
    depth = 0
    for index in range(position, len(tokens)):
        depth += (tokens[index].type == "STRUCT") - (tokens[index].type == "END_STRUCT")
        if depth == 0:
            semicolon = index + 1 < len(tokens) and tokens[index + 1].type == "SEMICOLON"
            return index + (2 if semicolon else 1)
    return len(tokens)


def _end_of_line(text: str, tokens: list[Token], first: int, behind: int) -> int:
    """Return the end of the last token on the line of the name."""
    if first + 1 >= behind:
        return tokens[first].span[1]
    index = first + 1
    while index + 1 < behind:
        if _begins_a_line(text, tokens, index + 1):
            break
        index += 1
    return tokens[index].span[1]


def _stray(tokens: list[Token], position: int, problems: list[Problem]) -> int:
    """Skip what is outside of units."""
    end = position
    while end < len(tokens) and tokens[end].type not in _UNITS | _SECTIONS:
        end += 1
    if any(token.type != "SEMICOLON" for token in tokens[position:end]):
        span = (tokens[position].span[0], tokens[end - 1].span[1])
        problems.append(Problem("a POU, a type or a list of variables is expected here", span))
    return end


@dataclass(frozen=True)
class Head:
    """The head of a POU: its keyword in capitals, and what the model has for it.

    `extends` and `implements` are as written. `comment`, at `comment_span`, is before it; in SCL also between it
    and the sections, where TIA Portal has it. `attributes` are what is there in braces, `properties` belong to SCL.
    """

    keyword: str
    name: str
    return_type: t.DataType | None
    qualifiers: tuple[str, ...]
    extends: tuple[str, ...]
    implements: tuple[str, ...]
    properties: tuple[d.Property, ...]
    comment: str | None
    comment_span: Span | None
    attributes: str


@dataclass(frozen=True)
class Found:
    """A part of a text, at `span`: `thing` is of the model, a `Head`, or None for an end or a text that does not parse.

    The comments of a variable, type or section are in its span. The names of one declaration (``a, b : INT``) are parts
    with the same span. Parts of a type are the members of its structure.
    """

    thing: Any
    node: Node
    span: Span
    parts: tuple[Found, ...] = ()


@dataclass(frozen=True)
class Declared:
    """Declarations of a text in their order, and the problems in it."""

    parsed: Parsed[d.Declarations]
    items: tuple[Found, ...]

    @property
    def problems(self) -> tuple[Problem, ...]:
        """Parts that do not parse."""
        return self.parsed.problems

    @property
    def heads(self) -> list[Head]:
        """The heads of POUs."""
        return [item.thing for item in self.items if isinstance(item.thing, Head)]

    @property
    def sections(self) -> list[VariableSection]:
        """The sections of variables."""
        return [item.thing for item in self.items if isinstance(item.thing, VariableSection)]

    @property
    def types(self) -> list[t.DataTypeDeclaration]:
        """The declarations of types."""
        parts = (part for item in self.items for part in item.parts)
        return [part.thing for part in parts if isinstance(part.thing, t.DataTypeDeclaration)]


def read_declarations(text: str, dialect: Dialect = Dialect.IEC) -> Declared:
    """Return the declarations in `text`, which has no bodies (see `units`). Never raises: see `Declared.problems`."""
    parsed = parse_declarations(text, dialect)
    return Declared(parsed, tuple(_Reader(parsed).items()))


def read_interface(declared: Declared) -> Interface:
    """Return the interface that the sections and the first head make."""
    result = next((head.return_type for head in declared.heads), None)
    return Interface(return_type=result, sections=declared.sections)


class _Reader:
    def __init__(self, parsed: Parsed[d.Declarations]) -> None:
        self._text = parsed.text
        self._tree = parsed.tree
        self._scl = parsed.dialect is Dialect.SCL
        self._comments = Comments(parsed.text, parsed.comments)
        self._members_of: dict[int, tuple[Found, ...]] = {}  # the members of structures, by the `id()` of these

    def items(self) -> Iterator[Found]:
        starts = [_span(node)[0] for node in self._tree.items]
        for node, following in zip(self._tree.items, [*starts[1:], len(self._text)], strict=True):
            match node:
                case d.PouHead():
                    yield self._head(node, following)
                case d.Section():
                    yield self._section(node)
                case d.StructBody(type=struct):
                    yield self._declared(node, struct.members, {"keyword": "STRUCT"})
                case d.AccessSectionNode(paths):
                    yield self._list(AccessSection, node, paths, self._access_path)
                case d.ConfigSectionNode(entries):
                    yield self._list(ConfigSection, node, entries, self._config_entry)
                case d.TypeSection():
                    parts = tuple(self._members(node.types, self._type_declaration))
                    yield Found(None, node, _span(node), parts)
                case _:
                    yield Found(None, node, _span(node))

    # -- places and comments

    def _slice(self, node: Node) -> str:
        """Return the text of `node` unchanged, the comments in it too."""
        start, end = _span(node)
        self._comments.take(start, end)
        return self._text[start:end]

    def _around(self, node: Node) -> list[Comment]:
        """Return the comments before `node`, inside it, and behind it on its line, that are not taken yet."""
        return self._comments.take(0, self._comments.behind(_span(node)[1]))

    def _members(self, nodes: Sequence[Node], read: Any) -> Iterator[Found]:
        for node in nodes:
            if isinstance(node, n.Unreadable):
                self._comments.take(*_span(node))
                yield Found(None, node, _span(node))
            else:
                yield from read(node)

    def _braces(self, comments: list[Comment]) -> dict[str, str]:
        """Return the attributes of SCL, the pragmas of all others."""
        return _named("attributes" if self._scl else "pragmas", pragmas(comments))

    def _closing(self, comments: list[Comment]) -> dict[str, str]:
        """Return the pragmas behind the last variable, such as ``{END_IF}``; SCL has attributes before it alone."""
        return {} if self._scl else _named("closing", pragmas(comments))

    # -- heads

    def _head(self, node: d.PouHead, following: int) -> Found:
        start, end = _span(node)
        before = self._comments.take(0, start)
        behind = self._comments.take(start, following if self._scl else end)
        type_ = self._type(node.type) if node.type is not None else None
        head = Head(
            node.keyword,
            self._name(node.name),
            None if _is_void(type_) else type_,
            node.qualifiers,
            tuple(map(self._slice, node.extends)),
            tuple(map(self._slice, node.implements)),
            node.properties,
            comment_text([*before, *behind]),
            _comment_span(before) or _comment_span(behind),
            pragmas([*before, *behind]),
        )
        braces = [comment.span for comment in behind if comment.kind is CommentKind.PRAGMA]
        return Found(head, node, (start, max([end, *(stop for _, stop in braces)])))

    def _name(self, node: n.Expression) -> str:
        return bare_name(self._slice(node))

    # -- sections

    def _section(self, node: d.Section) -> Found:
        kind, extra = SECTIONS.get(node.keyword, (SectionKind.LOCAL, node.keyword))
        others = " ".join(word for word in node.qualifiers if word not in _FLAGS)
        flags = {_FLAGS[word]: True for word in node.qualifiers if word in _FLAGS}
        texts = _named("keyword", extra) | _named("qualifiers", others)
        return self._declared(node, node.variables, texts, kind=kind, **flags)

    def _declared(self, node: Node, variables: Sequence[Node], texts: dict[str, str], **fields: Any) -> Found:
        """Return a section of variables; `fields` are other ones of it."""
        start, end = _span(node)
        before = self._comments.take(0, start)
        parts = tuple(self._members(variables, self._variable))
        rest = self._comments.take(0, end)
        texts |= self._braces([*before, *rest] if self._scl else before) | self._closing(rest) | _unreadable(parts)
        section = VariableSection(
            variables=[part.thing for part in parts if part.thing is not None],
            comment=comment_text([*before, *rest]),
            extension_data=keep(texts),
            **fields,
        )
        return Found(section, node, _with_comments((start, end), before), parts)

    def _variable(self, node: d.VariableDeclaration) -> Iterator[Found]:
        before = self._comments.take(0, _span(node.type)[0])
        type_ = self._type(node.type)
        initial = self._value(node.initial) if node.initial is not None else None
        around = [*before, *self._around(node)]
        texts = self._braces(around) | _named("edge", node.edge)
        attributes = read_attributes(texts.get("attributes", ""))
        if attributes:
            del texts["attributes"]
        span = _with_comments(_span(node), around)
        single = len(node.names) < 2
        for name in [name.identifier for name in node.names] or [""]:
            variable = t.Variable(
                name=name,
                type=type_ if single else type_.model_copy(deep=True),
                address=bare_name(self._slice(node.address)) if node.address is not None else None,
                initial=initial if single or initial is None else initial.model_copy(deep=True),
                comment=comment_text(around),
                attributes=dict(attributes or {}),
                extension_data=keep(texts),
            )
            yield Found(variable, node, span)

    def _list(self, kind: type[AccessSection | ConfigSection], node: Node, entries: Sequence[Node], read: Any) -> Found:
        start, end = _span(node)
        before = self._comments.take(0, start)
        parts = tuple(self._members(entries, read))
        comment = comment_text([*before, *self._comments.take(0, end)])
        variables = [part.thing for part in parts if part.thing is not None]
        section = kind(variables=variables, comment=comment, extension_data=keep(_unreadable(parts)))
        return Found(section, node, (start, end), parts)

    def _access_path(self, node: d.AccessPath) -> Iterator[Found]:
        variable = AccessVariable(
            alias=node.alias.identifier,
            path=self._slice(node.path),
            type=self._type(node.type),
            direction=_DIRECTIONS.get(node.direction),
            comment=comment_text(self._around(node)),
        )
        yield Found(variable, node, _span(node))

    def _config_entry(self, node: d.ConfigEntry) -> Iterator[Found]:
        variable = ConfigVariable(
            path=self._slice(node.path),
            type=self._type(node.type),
            address=self._slice(node.address) if node.address is not None else None,
            initial=self._value(node.initial) if node.initial is not None else None,
            comment=comment_text(self._around(node)),
        )
        yield Found(variable, node, _span(node))

    # -- types

    def _type_declaration(self, node: d.TypeDeclaration) -> Iterator[Found]:
        before = self._comments.take(0, _span(node.type)[0])
        type_ = self._type(node.type)
        around = [*before, *self._around(node)]
        texts = self._braces(around)
        if node.extends is not None:
            texts["extends"] = self._slice(node.extends)
        texts |= {"properties": "\n".join(map(self._slice, node.properties))} if node.properties else {}
        declaration = t.DataTypeDeclaration(
            name=node.name.identifier,
            type=type_,
            initial=self._value(node.initial) if node.initial is not None else None,
            comment=comment_text(around),
            extension_data=keep(texts),
        )
        members = self._members_of.get(id(node.type), ())
        yield Found(declaration, node, _with_comments(_span(node), around), members)

    def _type(self, node: d.TypeNode) -> t.DataType:
        match node:
            case d.StringTypeNode(name, length):
                wide = name.identifier.upper() == "WSTRING"
                return t.StringType(wide=wide, length=self._slice(length) if length is not None else None)
            case d.SubrangeTypeNode(base, bounds):
                inner = self._type(base)
                unsigned = isinstance(inner, t.ElementaryType) and inner.name in UNSIGNED
                return t.SubrangeType(bounds=self._dimension(bounds), base=inner, unsigned=unsigned)
            case d.ArrayTypeNode(dimensions, base):
                return t.ArrayType(dimensions=list(map(self._dimension, dimensions)), base=self._type(base))
            case d.PointerTypeNode(keyword, base):
                return t.PointerType(base=self._type(base), reference=keyword != "POINTER")
            case d.EnumTypeNode(values, base):
                listed = [
                    t.EnumValue(name=v.name.identifier, value=self._slice(v.value) if v.value is not None else None)
                    for v in values
                ]
                return t.EnumType(values=listed, base=self._type(base) if base is not None else None)
            case d.StructTypeNode():
                return self._struct(node)
            case d.NamedType():
                return self._named_type(node)

    def _dimension(self, node: n.Range | d.OpenDimension) -> t.Dimension:
        if isinstance(node, d.OpenDimension):
            return t.Dimension(lower="*", upper="*")
        return t.Dimension(lower=self._slice(node.lower), upper=self._slice(node.upper))

    def _struct(self, node: d.StructTypeNode) -> t.StructType:
        parts = self._members_of[id(node)] = tuple(self._members(node.members, self._variable))
        members = [part.thing for part in parts if part.thing is not None]
        rest = self._comments.take(0, _span(node)[1])
        texts = ({"union": ""} if node.union else {}) | _unreadable(parts) | self._closing(rest)
        return t.StructType(members=members, comment=comment_text(rest), extension_data=keep(texts))

    def _named_type(self, node: d.NamedType) -> t.DataType:
        text = self._slice(node.name)
        upper = text.upper()
        if node.arguments is None and upper in ELEMENTARY:
            return t.ElementaryType(name=ELEMENTARY[upper])
        name = bare_name(text)
        texts = {}
        if node.arguments is not None:
            texts["constructor"] = self._text[_span(node.name)[1] : _span(node)[1]]
        if self._scl and (text != name) != is_quoted_in_scl(name):
            texts["quoted" if text != name else "unquoted"] = ""
        return t.DerivedType(name=name, extension_data=keep(texts))

    # -- values

    def _value(self, node: d.InitialValue | d.Repetition) -> t.Value:
        match node:
            case d.ArrayValueNode(items):
                return t.ArrayValue(items=list(map(self._repeated, items)))
            case d.StructValueNode(members) if all(isinstance(member, d.MemberValueNode) for member in members):
                named = [member for member in members if isinstance(member, d.MemberValueNode)]
                return t.StructValue(
                    members=[t.MemberValue(member=m.member.identifier, value=self._value(m.value)) for m in named]
                )
            case _:
                return t.SimpleValue(text=self._slice(node))

    def _repeated(self, node: d.InitialValue | d.Repetition) -> t.RepeatedValue:
        if isinstance(node, d.Repetition) and not _is_function(node.count):
            value = self._value(node.value) if node.value is not None else t.SimpleValue()
            return t.RepeatedValue(value=value, repetitions=self._slice(node.count))
        return t.RepeatedValue(value=self._value(node))


def _is_function(count: n.Expression) -> bool:
    """True for a name before parentheses that calls something: ``ADR(a)`` is no repetition."""
    name = count.identifier.upper() if isinstance(count, n.Name) else ""
    return name in _ADDRESSES or standard_block(name) is not None


_ADDRESSES = frozenset({"ADR", "BITADR", "SIZEOF", "XSIZEOF"})


_FLAGS = {"CONSTANT": "constant", "RETAIN": "retain", "NON_RETAIN": "nonretain", "PERSISTENT": "persistent"}
_DIRECTIONS = {"READ_ONLY": AccessDirection.READ_ONLY, "READ_WRITE": AccessDirection.READ_WRITE}


def _span(node: Node) -> Span:
    assert node.span is not None, "a node that was parsed has a place"  # noqa: S101  # for the type checker
    return node.span


def _with_comments(span: Span, comments: Sequence[Comment]) -> Span:
    starts = [comment.span[0] for comment in comments]
    ends = [comment.span[1] for comment in comments]
    return (min([span[0], *starts]), max([span[1], *ends]))


def _comment_span(comments: Sequence[Comment]) -> Span | None:
    spans = [comment.span for comment in comments if comment.kind is not CommentKind.PRAGMA]
    return (spans[0][0], spans[-1][1]) if spans else None


def _is_void(type_: t.DataType | None) -> bool:
    return isinstance(type_, t.DerivedType) and type_.name.upper() == "VOID"


def _named(name: str, text: str) -> dict[str, str]:
    return {name: text} if text else {}


def _unreadable(parts: Sequence[Found]) -> dict[str, str]:
    found = (part.node.text for part in parts if isinstance(part.node, n.Unreadable))
    return _named("unreadable", "\n".join(LINE_END.sub("\n", text) for text in found))
