"""Program text, conditions and values in a form that can be compared.

A text has the same meaning as another if both are the same, or have the same normal form
(`plcopen_sfc.languages.networks.wires`), or, of conditions, if z3 proves that one is TRUE whenever the other is. The
forms are made only where the texts differ: most texts of a conversion do not.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Hashable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from plcopen_sfc.languages.declarations.conditional_declarations import CONDITION
from plcopen_sfc.languages.declarations.declaration_writing import write_type
from plcopen_sfc.languages.memory_addresses import memory_address
from plcopen_sfc.languages.networks import NetworkExpression, NetworkText, body_statements, normal_form
from plcopen_sfc.languages.networks.wires import DUALS, with_inner_negations
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, print_node, transform, walk
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value
from plcopen_sfc.languages.words import folded
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import FbdBody, LdBody, StBody
from plcopen_sfc.model.dialect import COUNTING_BYTES, Dialect
from plcopen_sfc.model.sfc import Body
from plcopen_sfc.model.types import DataType

_NOT_EXECUTED = frozenset(
    {"extension_data", "comment", "global_id", "title", "markup", "worksheet", "attributes", "position", "points"}
    | {"width", "height", "local_id"}
)
"""Fields of types, values and networks that people and tools look at and no machine."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """Something that is executed: as people read it (`shown`), as it is written (`raw`), and in normal form.

    `normal` is None where what is written is in normal form. Charts have these by the ten thousand: no functions for
    plain values.
    `condition` is the expression of a condition, which z3 can compare with another; `text` gives a program as text with
    its lines, `statements` those of networks, None where they are no program.
    """

    shown: str | Callable[[], str]
    raw: Hashable
    normal: Callable[[], Hashable] | None = None
    condition: Callable[[], NetworkExpression] | None = None
    text: Callable[[], str] | None = None
    statements: Callable[[], Sequence[n.Statement] | None] | None = None

    @classmethod
    def of(cls, value: Hashable, shown: str | None = None) -> Meaning:
        """Return a plain value."""
        return cls(value.__str__ if shown is None else shown, value)

    def show(self) -> str:
        """Return it as people read it."""
        return self.shown if isinstance(self.shown, str) else self.shown()

    def form(self) -> Hashable:
        """Return its normal form."""
        return self.raw if self.normal is None else self.normal()


def same(left: Meaning | None, right: Meaning | None) -> bool:
    """True if both mean the same."""
    if left is None or right is None:
        return left is right
    if left.raw == right.raw or left.form() == right.form():
        return True
    return (is_stronger(left, right) and is_stronger(right, left)) or _same_networks(left, right)


def _same_networks(left: Meaning, right: Meaning) -> bool:
    """True if the statements of networks are the same, or assign what is equal by z3.

    A ladder has ``X AND (A OR B)`` as TIA Portal draws it: ``X AND A OR X AND B``.
    """
    if left.statements is None or right.statements is None:
        return False
    mine, theirs = left.statements(), right.statements()
    if mine is None or theirs is None or len(mine) != len(theirs):
        return False
    pairs = zip(mine, theirs, strict=True)
    return all(print_node(one) == print_node(other) or _assign_equal(one, other) for one, other in pairs)


def _assign_equal(one: n.Statement, other: n.Statement) -> bool:
    if not isinstance(one, n.Assignment) or not isinstance(other, n.Assignment) or one.kind is not other.kind:
        return False
    calls = any(isinstance(node, n.Call) for each in (one, other) for node in walk(each))
    if calls or print_node(one.target) != print_node(other.target):
        return False
    from plcopen_sfc.analysis.exclusivity import covered  # noqa: PLC0415  # z3 takes long to import

    return bool(covered(one.value, [other.value])) and bool(covered(other.value, [one.value]))


def is_stronger(one: Meaning | None, other: Meaning | None) -> bool:
    """True if z3 proves that the condition `other` is TRUE whenever `one` is."""
    if one is None or other is None or one.condition is None or other.condition is None:
        return False
    left, right = one.condition(), other.condition()
    if left.before or right.before or not left.complete or not right.complete:
        return False
    widths = [_widths(each.tree) for each in (left, right)]
    if all(widths) and widths[0] != widths[1]:
        return False  # z3 has one type for both
    from plcopen_sfc.analysis.exclusivity import covered  # noqa: PLC0415  # z3 takes long to import

    return bool(covered(left, [right]))


def _widths(tree: n.Node | None) -> set[bool]:
    """Return what texts an expression has literals for: True for a WSTRING, False for a STRING."""
    found: set[bool] = set()
    for node in walk(tree) if tree is not None else ():
        if isinstance(node, n.Literal) and ("'" in node.text or '"' in node.text):
            with suppress(LiteralError):
                found.add(literal_value(node.text).type[:1] == "W")
    return found


T = TypeVar("T")


class Once(Generic[T]):
    """A form that is calculated when it is asked for first; to make a `functools.cache` takes as long as most forms."""

    __slots__ = ("_calculate", "_known")
    _known: T

    def __init__(self, calculate: Callable[[], T]) -> None:
        self._calculate: Callable[[], T] | None = calculate

    def __call__(self) -> T:
        """Return the form."""
        if self._calculate is not None:
            self._known, self._calculate = self._calculate(), None
        return self._known


def condition_meaning(read: Callable[[], NetworkExpression], raw: Hashable) -> Meaning:
    """Return the meaning of a condition that `read` gives as an expression."""

    def form() -> Hashable:
        found = read()
        if found.tree is None or found.obstacles:
            return ("unreadable", raw)
        named = _with_helpers(found, lambda node: node)
        return tuple(program_form(each, named) for each in (*found.before, found.tree))

    return Meaning(lambda: _shown_condition(read), raw, Once(form), read)


def _shown_condition(read: Callable[[], NetworkExpression]) -> str:
    found = read()
    if found.tree is None:
        return UNREAD_CONDITION
    return print_node(found.tree)


UNREAD_CONDITION = "a condition that cannot be read"
"""The text that people read of a condition whose form belongs to a tool and is not known here."""


N = TypeVar("N", bound=n.Node)
Renaming = Callable[[n.Node], n.Node]
"""Change that puts the names in a text into a common form."""


def program_form(tree: n.Node, named: Renaming) -> str:
    """Program text in normal form, with its names in the common form of `named`; case of names does not matter."""
    return print_node(_common_form(tree, named))


def _common_form(tree: N, named: Renaming) -> N:

    def common(node: n.Node) -> n.Node:
        node = named(node)
        if not isinstance(node, n.Name):
            return node
        quoting = n.Quoting.LOCAL if node.quoting is n.Quoting.LOCAL_QUOTED else node.quoting  # #"a" is #a
        return replace(node, identifier=node.identifier.casefold(), quoting=quoting)

    tree = normal_form(tree)
    inner = transform(tree, _with_inner_negations)
    return transform(tree if inner is tree else normal_form(inner), common)


def _with_inner_negations(node: n.Node) -> n.Node:
    """Return NOT of AND or OR as ladders have it: they are drawn so, and mean the same."""
    match node:
        case n.Unary(n.Operator.NOT, n.Operation(operator)) if operator in DUALS:
            return with_inner_negations(node)
    return node


def code_meaning(body: Body | None, dialect: Dialect, named: Renaming) -> Meaning | None:
    """Return the meaning of a body that is no chart; None for one that does nothing."""
    if body is None or body.language == "SFC":
        return None
    if isinstance(body, StBody):
        return _text_meaning(body.text, dialect, named) if body.text.strip() else None
    if isinstance(body, FbdBody | LdBody):
        if not any(network.nodes for network in body.networks):
            return None
        return Meaning(
            lambda: _network_shown(body, dialect),
            plain(body),
            lambda: _network_form(body, dialect, named),
            text=lambda: print_node(body_statements(body, dialect).tree),
            statements=lambda: _network_statements(body, dialect, named),
        )
    text = body.content if body.language == "opaque" else body.text
    if not text.strip():
        return None
    return Meaning(
        lambda: f"a body in {body.language}",
        (body.language, text),
        lambda: " ".join(text.split()),
        text=lambda: text,
    )


def _text_meaning(text: str, dialect: Dialect, named: Renaming) -> Meaning:
    """Return the meaning of statements: their tree, and the pragmas that tell which CODESYS compiles."""

    def form() -> Hashable:
        parsed = parse_statements(text, dialect)
        if parsed.problems:
            return " ".join(text.split())
        found = program_form(parsed.tree, named)
        conditions = [each for each in parsed.comments if CONDITION.match(each.text)]
        if not conditions:
            return found
        ends = [token.span[1] for token in tokenize(text, dialect).tokens]
        return found, tuple((bisect_right(ends, each.span[0]), " ".join(each.text.split())) for each in conditions)

    return Meaning(lambda: " ".join(text.split()), text, Once(form), text=lambda: text)


UNREAD_NETWORK = "a network that cannot be executed: "


def _network_shown(body: FbdBody | LdBody, dialect: Dialect) -> str:
    """Return a network as its statements, or what is in the way of these."""
    found = body_statements(body, dialect)
    obstacles = _obstacles(found)
    return f"{UNREAD_NETWORK}{obstacles[0]}" if obstacles else " ".join(print_node(found.tree).split())


def _network_form(body: FbdBody | LdBody, dialect: Dialect, named: Renaming) -> Hashable:
    found = body_statements(body, dialect)
    if _obstacles(found):
        return plain(body)
    named = _with_helpers(found, named)
    ends = tuple(program_form(value, named) for _, value in found.open_ends)
    whole = program_form(found.tree, named)
    return (whole, *ends) if ends else whole


def _network_statements(body: FbdBody | LdBody, dialect: Dialect, named: Renaming) -> Sequence[n.Statement] | None:
    found = body_statements(body, dialect)
    if _obstacles(found) or found.open_ends:
        return None
    return _common_form(found.tree, _with_helpers(found, named)).statements


def _obstacles(found: NetworkText) -> list[str]:
    """Return the reason why a network cannot be executed.

    Titles and attributes are elements that other tools do not know; no machine executes them.
    """
    return [problem.message for problem in found.obstacles if "only its tool understands" not in problem.message]


def _with_helpers(found: NetworkText, named: Renaming) -> Renaming:
    """`named`, and the helpers of a network by their order: their names have the numbers of elements in the file."""
    names = {helper.name.casefold(): f"helper {number}" for number, helper in enumerate(found.helpers)}

    def rename(node: n.Node) -> n.Node:
        name = names.get(node.identifier.casefold()) if isinstance(node, n.Name) else None
        return named(node) if name is None else n.Name(name)

    return rename


def literal_meaning(text: str) -> Meaning:
    """Return the meaning of a literal, or of an expression in its place."""
    text = text.strip()
    return Meaning(lambda: text, text, lambda: literal_form(text))


def literal_form(text: str) -> Hashable:
    """Return a literal as it is compared: its value, or the expression in its place."""
    try:
        found = literal_value(text)
    except LiteralError:
        parsed = parse_expression(text)
        return folded(text if parsed.problems else print_node(normal_form(parsed.tree)))
    # no tool takes a STRING for a WSTRING
    return (found.value, "wide") if found.kind is LiteralKind.STRING and found.type[:1] == "W" else (found.value,)


def type_meaning(type_: DataType | None, dialect: Dialect) -> Meaning | None:
    """Return the meaning of a data type."""
    return None if type_ is None else Meaning(lambda: write_type(type_, dialect), plain(type_), lambda: plain(type_))


def address_meaning(address: str | None, dialect: Dialect) -> Meaning | None:
    """Return the bits that an address names: ``%MW2`` is byte 2 for S7 and TwinCAT, and word 2 for other tools.

    S7 has no addresses of 64 bits: one in its files is the text of another tool.
    """
    if not address:
        return None
    found = memory_address(address, by_bytes=dialect in COUNTING_BYTES)
    if found is not None and found.width == _LONG_WORD and dialect is Dialect.SCL:
        found = memory_address(address, by_bytes=False)
    bits = (found.area, found.start, found.width) if found is not None else address.strip().upper()
    return Meaning.of(bits, address)


_LONG_WORD = 64


def plain(thing: Any) -> Hashable:
    """Return a model object without what no machine executes, as nested tuples. Case of names does not matter."""
    if isinstance(thing, Model):
        names = [name for name in type(thing).model_fields if name not in _NOT_EXECUTED]
        fields = ((name, plain(getattr(thing, name))) for name in names)
        return type(thing).__name__, tuple((name, value) for name, value in fields if value not in (None, ()))
    if isinstance(thing, list):
        return tuple(map(plain, thing))
    if isinstance(thing, dict):
        return tuple(sorted((str(key), plain(value)) for key, value in thing.items()))
    return folded(thing) if isinstance(thing, str) else thing
