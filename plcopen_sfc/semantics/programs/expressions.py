"""Translation of expressions: literals, operations and calls, on top of names and paths."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import SHORT_TYPES, LiteralError, LiteralKind, literal_value
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.calls import Calls
from plcopen_sfc.semantics.programs.code_generation import Writer
from plcopen_sfc.semantics.programs.operators import Operators
from plcopen_sfc.semantics.programs.paths import PathTranslator
from plcopen_sfc.semantics.programs.places import Place
from plcopen_sfc.semantics.programs.scopes import Scope
from plcopen_sfc.semantics.programs.value_code import Code, constant, settled

_EPOCH_ORDINAL = 719_163
_DAY = 86_400_000_000_000


class Translator(PathTranslator):
    """Translates expressions of a scope."""

    def __init__(self, scope: Scope, writer: Writer) -> None:
        super().__init__(scope, writer)
        self._operators = Operators(self)
        self._calls = Calls(self)
        self._remembered: dict[tuple[int, int], tuple[n.Expression, t.Type | None, Code]] | None = None

    @contextmanager
    def remembering(self) -> Iterator[None]:
        """Translate each tree once only: for conditions that are made of the same parts again and again."""
        self._remembered = {}
        try:
            yield
        finally:
            self._remembered = None

    def value(self, node: n.Expression, expected: t.Type | None = None) -> Code:
        """Return the value of an expression; see `PathTranslator.value`."""
        if self._remembered is None:
            return self._value(node, expected)
        key = id(node), id(expected)
        if key in self._remembered:
            return self._remembered[key][2]
        mark = self.writer.mark()
        code = self._value(node, expected)
        if not code.acts and self.writer.mark() == mark:  # else statements belong to it
            self._remembered[key] = node, expected, code  # with what the key is of, so that nothing else gets its id
        return code

    def _value(self, node: n.Expression, expected: t.Type | None) -> Code:
        match node:
            case n.Parenthesized(inner=inner):
                return self.value(inner, expected)
            case n.Literal():
                return self._literal(node, expected)
            case n.Unary() | n.Operation():
                return self._operators.value(node, expected)
            case n.Call():
                return self._calls.value(node, expected)
            case n.AssignmentExpression(target=target, value=value):
                place = self.place(target)
                code = settled(self.fitted(self.value(value, place.type), place.type))
                if place.bits is not None or not isinstance(place.type, t.ScalarType):
                    raise SimulationError("such an assignment inside an expression is not known to the simulator")
                self.note_write(place)
                return Code(
                    f"put({place.cells}, {place.index}, {code.text})", place.type, code.low, code.high, acts=True
                )
        meaning = self.meaning(node, expected)
        if isinstance(meaning, Place) and meaning.path == "THIS" and isinstance(expected, t.ReferenceType):
            return Code(f"Pointer({meaning.cells}, {meaning.index})", t.ReferenceType("POINTER", meaning.type))
        return self.read(meaning, node, expected)

    def _literal(self, node: n.Literal, expected: t.Type | None) -> Code:
        try:
            found = literal_value(node, self.library.dialect)
        except LiteralError as error:
            raise SimulationError(error.message, hint=error.hint) from None
        name = SHORT_TYPES.get(found.type, found.type)
        type_ = t.elementary(name, self.library.dialect) if name else None
        if found.kind is LiteralKind.ENUMERATED:
            owner = self.scope.resolve(n.Name(found.type))
            if isinstance(owner, t.ScalarType) and str(found.value).casefold() in owner.names:
                return constant(owner.names[str(found.value).casefold()], owner)
            raise SimulationError(f"{node.text} is no value of an enumeration")
        if found.kind is LiteralKind.BOOL:
            return Code(repr(found.value), t.BOOL, 0, 1, found.value, constant=True)
        if found.kind is LiteralKind.STRING:
            return Code(repr(found.value), t.string("STRING", 0), value=found.value, constant=True)
        if found.kind is LiteralKind.NULL:
            return Code("None", t.ReferenceType("NULL", t.ANY))
        if found.kind is LiteralKind.POINTER:
            raise SimulationError(f"{node.text}: pointers of this kind are not known to the simulator")
        if found.kind is LiteralKind.DATE:
            value: Any = (found.value.toordinal() - _EPOCH_ORDINAL) * _DAY  # type: ignore[union-attr]  # it is a date
            return constant(value, type_ or t.ELEMENTARY["DATE"])
        if found.kind is LiteralKind.REAL:
            if type_ is None:
                wanted = expected if isinstance(expected, t.ScalarType) else None
                single = wanted is not None and wanted.family is t.Family.REAL and wanted.bits == 32
                return Code(
                    repr(found.value), t.LREAL, value=found.value, constant=True, loose=single or wanted is None
                )
            return settled(self.library.converter.converted(constant(found.value, t.LREAL), type_))
        is_truth = isinstance(expected, t.ScalarType) and expected.family is t.Family.BOOL
        if type_ is None and is_truth and found.value in (0, 1):  # IEC 61131-3 ed. 2, table 5; Beremiz
            return Code(repr(bool(found.value)), t.BOOL, 0, 1, bool(found.value), constant=True)
        self.library.use.numbers.setdefault(int(found.value))  # type: ignore[arg-type]  # it is an integer
        if type_ is None:
            return constant(found.value, _least_integer(int(found.value)), loose=True)  # type: ignore[arg-type]
        return settled(constant(found.value, type_))


def _least_integer(value: int) -> t.ScalarType:
    """Return the type of a literal that names none."""
    for name in ("INT", "DINT", "LINT", "ULINT"):
        if t.ELEMENTARY[name].least <= value <= t.ELEMENTARY[name].greatest:
            return t.ELEMENTARY[name]
    raise SimulationError(f"{value} fits no integer type")
