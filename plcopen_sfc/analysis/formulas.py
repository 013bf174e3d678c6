"""Conditions as formulas that z3 decides.

A formula knows Boolean operations, comparisons of values with constants and with each other, lengths of texts, and
nothing else. An unknown operation (arithmetic, a call) is an atom of its own: equal text, equal value. Such an atom may
take any value in the formula, so what z3 finds impossible is impossible; what it finds possible is then only a guess,
and `Formula.doubts` tells why. Where only guesses are wanted, arithmetic and standard functions are known, too.

The terms of z3 are without overflow and rounding errors.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date
from fractions import Fraction
from functools import reduce
from operator import add, eq, ge, gt, le, lt, mul, ne
from threading import local
from types import MappingProxyType
from typing import Any

from plcopen_sfc.analysis.knowledge import (
    KIND_OF_LITERAL,
    KIND_OF_NUMBER,
    Knowledge,
    ValueKind,
    VariableValues,
    constant_of,
)
from plcopen_sfc.errors import ModelError
from plcopen_sfc.languages.effects import is_standard_call, path_of
from plcopen_sfc.languages.expression_types import CALCULATING
from plcopen_sfc.languages.networks import normal_form
from plcopen_sfc.languages.st import names_of, print_node, walk
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import INTEGER_RANGES, LiteralKind, LiteralValue, write_literal
from plcopen_sfc.languages.st.nodes import Expression, Operator
from plcopen_sfc.languages.words import folded
from plcopen_sfc.model.dialect import Dialect

_MOST_FACTORS = 4

FIRST_IS_TEXT = {"LEN": 1, "LEFT": 1, "RIGHT": 1, "MID": 1, "FIND": 2, "CONCAT": 99}
"""Functions by how many of their first arguments are texts."""

TEXT_RESULT = frozenset({"LEFT", "RIGHT", "MID", "CONCAT"})
OF_NUMBERS = frozenset({"ABS", "MIN", "MAX", "LIMIT"})
"""Functions whose result has the type of their arguments."""


def calculated(z3: Any, operator: Operator, terms: Sequence[Any]) -> Any:
    """Return the value of an operation; None for one that is not known."""
    match operator:
        case Operator.ADD:
            return reduce(add, terms)
        case Operator.SUBTRACT:
            return terms[0] - terms[1]
        case Operator.MULTIPLY:
            return reduce(mul, terms)
        case Operator.DIVIDE:
            return _divided(z3, *terms)
        case Operator.MODULO if all(term.is_int() for term in terms):
            return terms[0] - _divided(z3, *terms) * terms[1]
        case Operator.POWER if z3.is_int_value(terms[1]) and 0 < terms[1].as_long() <= _MOST_FACTORS:
            return reduce(mul, [terms[0]] * terms[1].as_long())
    return None


def _divided(z3: Any, dividend: Any, divisor: Any) -> Any:
    """Return a quotient; of integers without its fraction."""
    if not (dividend.is_int() and divisor.is_int()):
        return dividend / divisor
    # z3 rounds so that the remainder is not negative: for a dividend that is not negative, towards zero
    return z3.If(dividend >= 0, dividend / divisor, -(-dividend / divisor))


def called(z3: Any, name: str, terms: Sequence[Any]) -> Any:
    """Return the value of a standard function; None for one that is not known, or that is not called so."""
    function = _FUNCTIONS.get(name)
    if function is None:
        return None
    try:
        return function(z3, *terms)
    except TypeError:  # too many or too few arguments: what is called so is refused elsewhere
        return None


def converted(z3: Any, term: Any, *, to_real: bool) -> Any:
    """Return a number as one of the other kind."""
    if term.is_int():
        return z3.ToReal(term) if to_real else term
    return term if to_real else z3.ToInt(term + z3.Q(1, 2, ctx=term.ctx))


def _cut(term: Any, name: str) -> Any:
    """Return what a conversion of integers by this name leaves of one: its last bits."""
    before, _, after = name.rpartition("TO_")
    least, greatest = INTEGER_RANGES[after]
    first, last = INTEGER_RANGES.get(before.removesuffix("_"), (least - 1, greatest))
    return term if least <= first and last <= greatest else (term - least) % (greatest - least + 1) + least


def _least(z3: Any, *terms: Any) -> Any:
    return reduce(lambda a, b: z3.If(a <= b, a, b), terms)


def _greatest(z3: Any, *terms: Any) -> Any:
    return reduce(lambda a, b: z3.If(a >= b, a, b), terms)


_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "LEN": lambda z3, text: z3.Length(text),
    "LEFT": lambda z3, text, count: z3.SubString(text, 0, count),
    "RIGHT": lambda z3, text, count: z3.SubString(text, _greatest(z3, z3.Length(text) - count, 0 * count), count),
    "MID": lambda z3, text, count, place: z3.SubString(text, place - 1, count),
    "FIND": lambda z3, text, part: z3.IndexOf(text, part, 0) + 1,
    "CONCAT": lambda z3, *texts: z3.Concat(*texts),
    "ABS": lambda z3, number: z3.If(number >= 0, number, -number),
    "MIN": _least,
    "MAX": _greatest,
    "LIMIT": lambda z3, low, number, high: _least(z3, _greatest(z3, low, number), high),
}


_CONTEXTS = local()


def z3_context() -> tuple[Any, Any]:
    """Return the module, loaded when it is first needed, and a context for this thread."""
    if not hasattr(_CONTEXTS, "context"):
        _CONTEXTS.context = new_context()
    return _z3_module(), _CONTEXTS.context


def _z3_module() -> Any:
    import z3  # noqa: PLC0415  # takes a tenth of a second

    return z3


def new_context() -> Any:
    """Return a z3 context of one's own, which takes two milliseconds and some megabytes.

    What z3 finds within a limit depends on what was asked in the same context before.
    """
    return _z3_module().Context()


_ESCAPED = re.compile(r"\\u\{([0-9a-fA-F]+)\}")


def text_term(text: str, context: Any) -> Any:
    """Return a text as a z3 term."""
    return _z3_module().StringVal(text.replace("\\", "\\u{5c}"), ctx=context)  # else z3 reads the text \u{41} as A


def plain_text(value: Any) -> str:
    """Return the text of a z3 value, which escapes what is not ASCII."""
    text = value.as_string() if hasattr(value, "as_string") else ""
    return _ESCAPED.sub(lambda found: chr(int(found[1], 16)), text)


def negation(term: Any) -> Any:
    """Return the opposite of a z3 term."""
    return _z3_module().Not(term)


@dataclass(frozen=True, slots=True)
class JudgedCondition:
    """A condition to be decided: its expression, and the names that may have another value in the other conditions.

    `own` are the variables that are written while the condition is evaluated, with case folded.
    """

    tree: Expression
    own: frozenset[str] = frozenset()


COMPARING: dict[Operator, Callable[[Any, Any], Any]] = {
    Operator.EQUAL: eq,
    Operator.UNEQUAL: ne,
    Operator.LESS: lt,
    Operator.GREATER: gt,
    Operator.LESS_OR_EQUAL: le,
    Operator.GREATER_OR_EQUAL: ge,
}
_JOINING = {
    Operator.AND: "And",
    Operator.AND_THEN: "And",
    Operator.OR: "Or",
    Operator.OR_ELSE: "Or",
}
_LITERALS = {
    ValueKind.DURATION: LiteralKind.DURATION,
    ValueKind.DATE: LiteralKind.DATE,
    ValueKind.TIME_OF_DAY: LiteralKind.TIME_OF_DAY,
    ValueKind.DATE_AND_TIME: LiteralKind.DATE_AND_TIME,
}
_NUMBERS = (ValueKind.INTEGER, ValueKind.REAL)
_TIMES = (ValueKind.DURATION, ValueKind.TIME_OF_DAY, ValueKind.DATE_AND_TIME)


@dataclass
class _Atom:
    """Something that takes a value: `term` in z3. `typed`: its kind is known, not only guessed from its use."""

    text: str
    kind: ValueKind
    term: Any
    typed: bool


@dataclass
class Formula:
    """Conditions in one formula, each a z3 term. `doubts`: why what z3 finds possible may still be impossible.

    `guessing`: only a `model` is wanted; what z3 finds impossible may be possible, as integers have no bounds between.
    `context`: that of the terms; None: the one of this thread.
    """

    dialect: Dialect
    knowledge: Knowledge | None
    guessing: bool = False
    context: Any = None
    doubts: list[str] = field(default_factory=list)
    _atoms: dict[str, _Atom] = field(default_factory=dict)
    _bounds: list[Any] = field(default_factory=list)
    _codes: dict[str, int] = field(default_factory=dict)
    _symbols: list[str] = field(default_factory=list)
    _boolean: set[str] = field(default_factory=set)
    _own: frozenset[str] = frozenset()
    _side: int = 0
    _common: Any = None

    def _z3(self) -> tuple[Any, Any]:
        """Return the module, and the context of all terms."""
        return z3_context() if self.context is None else (_z3_module(), self.context)

    def disjunction(self, terms: list[Any]) -> Any:
        """Return the formula that at least one of the terms is true."""
        z3, context = self._z3()
        return z3.Or(*terms) if terms else z3.BoolVal(False, ctx=context)

    def terms(self, readings: list[JudgedCondition]) -> list[Any]:
        """Return the z3 terms of conditions."""
        trees = [normal_form(reading.tree) for reading in readings]
        for tree in trees:
            self._find_booleans(tree)
        terms: list[Any] = []
        for self._side, (tree, reading) in enumerate(zip(trees, readings, strict=True)):
            self._own = reading.own
            terms.append(self._truth(tree))
        self._doubt_parts()
        return terms

    def check(self, terms: list[Any]) -> tuple[bool | None, dict[str, str], str]:
        """Decide if all terms can be true together, in which situation, and why that is unknown (None)."""
        solver = self._asker()
        possible, reason = self._judged(solver, terms)
        return possible, self._situation(solver.model()) if possible else {}, reason

    def can_be_true(self, terms: list[Any]) -> bool | None:
        """Decide if all terms can be true together, as `check` does, in a third of the time.

        One solver gets all questions about the terms that were made before the first. Which situation it finds would
        depend on the order of the questions.
        """
        if self._common is None:
            self._common = self._asker()
        self._common.push()
        try:
            return self._judged(self._common, terms)[0]
        finally:
            self._common.pop()

    def _asker(self) -> Any:
        z3, context = self._z3()
        solver = z3.SimpleSolver(ctx=context)
        solver.set("rlimit", _EFFORT)
        solver.add(*self._bounds)
        return solver

    def _judged(self, solver: Any, terms: list[Any]) -> tuple[bool | None, str]:
        z3, _ = self._z3()
        solver.add(*terms)
        found = solver.check()
        if found == z3.unsat:
            return False, ""
        if found != z3.sat:
            return None, f"it takes too long to decide ({solver.reason_unknown()})"
        if self.doubts:
            return None, self.doubts[0]
        guessed = [a for a in self._atoms.values() if a.kind in _NUMBERS and not a.typed]
        solver.add(*(z3.IsInt(a.term) for a in guessed if a.term.is_real()))
        if guessed and solver.check() != z3.sat:
            return None, f"it depends on whether {', '.join(a.text for a in guessed)} can be a fraction"
        return True, ""

    def names(self) -> list[str]:
        """Return the variables in the terms that were made."""
        return [atom.text for atom in self._atoms.values()]

    def model(
        self,
        terms: list[Any],
        known: Mapping[str, bool | int | float | str | date | None],
        avoided: Mapping[str, int] = MappingProxyType({}),
    ) -> dict[str, Any] | None:
        """Return values of variables with which all terms are true, or None.

        `known` are values that variables have; names of enumerations are texts. Values unknown to the formula may be
        anything, so the returned values are only a guess that has to be tried. `avoided` are numbers that variables are
        not to have.
        """
        z3, solver = self._solver(terms, known)
        numbers = [a for a in self._atoms.values() if a.kind is ValueKind.INTEGER]
        solver.add(*(z3.IsInt(a.term) for a in numbers if a.term.is_real()))
        others = [a for a in numbers if a.text in avoided]
        # far from them if that can be: what is calculated with a number beside them may be the same
        far = [z3.Or(a.term > avoided[a.text] + _FAR, a.term < avoided[a.text] - _FAR) for a in others]
        if not far or solver.check(*far) != z3.sat:
            solver.add(*(a.term != avoided[a.text] for a in others))
            if solver.check() != z3.sat:
                return None
        model = solver.model()
        found: dict[str, Any] = {}
        for atom in self._atoms.values():
            value = model.eval(atom.term, model_completion=False)
            if atom.kind is ValueKind.BOOL:
                if z3.is_true(value) or z3.is_false(value):
                    found[atom.text] = z3.is_true(value)
            elif atom.kind is ValueKind.TEXT:
                if z3.is_string_value(value):
                    found[atom.text] = plain_text(value)
            elif z3.is_rational_value(value):
                found[atom.text] = value.as_fraction()
            elif z3.is_int_value(value):
                number = value.as_long()
                is_symbol = atom.kind is ValueKind.SYMBOL and number in range(len(self._symbols))
                is_date = atom.kind is ValueKind.DATE and 0 < number <= date.max.toordinal()
                found[atom.text] = (
                    self._symbols[number] if is_symbol else date.fromordinal(number) if is_date else number
                )
        return found

    def is_impossible(self, terms: list[Any], known: Mapping[str, bool | int | float | str | date | None]) -> bool:
        """True if the terms cannot all be true while variables have these values."""
        z3, solver = self._solver(terms, known)
        return bool(solver.check() == z3.unsat)

    def _solver(self, terms: list[Any], known: Mapping[str, bool | int | float | str | date | None]) -> tuple[Any, Any]:
        z3, context = self._z3()
        solver = z3.SimpleSolver(ctx=context)
        solver.set("rlimit", _EFFORT_FOR_A_MODEL)
        solver.add(*terms, *self._bounds)
        for atom in self._atoms.values():
            value = known.get(atom.text)
            if value is not None:
                solver.add(*self._is(atom, value))
        return z3, solver

    def _is(self, atom: _Atom, value: bool | int | float | str | date) -> list[Any]:
        """Return the formula that an atom has a value, if its kind can have it."""
        z3, context = self._z3()
        if atom.kind is ValueKind.BOOL:
            return [atom.term == z3.BoolVal(bool(value), ctx=context)]
        if isinstance(value, str):
            if atom.kind is ValueKind.TEXT:
                return [atom.term == text_term(value, context)]
            if atom.kind is not ValueKind.SYMBOL:
                return []
            return [atom.term == self._code(LiteralValue(LiteralKind.ENUMERATED, value))]
        if isinstance(value, date):
            return [atom.term == value.toordinal()] if atom.kind is ValueKind.DATE else []
        if isinstance(value, bool) or atom.kind not in (*_NUMBERS, *_TIMES) or not math.isfinite(value):
            return []
        if isinstance(value, int):
            return [atom.term == value]
        return [atom.term == z3.RealVal(Fraction(value), ctx=context)] if atom.term.is_real() else []

    def _situation(self, model: Any) -> dict[str, str]:
        situation: dict[str, str] = {}
        for atom in self._atoms.values():
            value = model.eval(atom.term, model_completion=True)
            if atom.kind is ValueKind.BOOL:
                situation[atom.text] = "TRUE" if str(value) == "True" else "FALSE"
            elif atom.kind is ValueKind.TEXT:
                situation[atom.text] = write_literal(LiteralValue(LiteralKind.STRING, plain_text(value)), self.dialect)
            elif atom.kind is ValueKind.SYMBOL:
                known = range(len(self._symbols))
                situation[atom.text] = self._symbols[value.as_long()] if value.as_long() in known else "another value"
            elif atom.kind in _NUMBERS:
                number = value.as_fraction() if value.is_real() else Fraction(value.as_long())
                whole = number.denominator == 1
                situation[atom.text] = str(number.numerator) if whole else repr(float(number))
            else:
                situation[atom.text] = self._literal(atom.kind, value.as_long())
        return situation

    def _literal(self, kind: ValueKind, number: int) -> str:
        value = date.fromordinal(number) if kind is ValueKind.DATE and 0 < number <= date.max.toordinal() else number
        try:
            return write_literal(LiteralValue(_LITERALS[kind], value), self.dialect)
        except ModelError:  # no literal has it: a time between the milliseconds of CODESYS
            return f"{number} ns"

    # -- Boolean terms

    def _truth(self, tree: Expression) -> Any:
        z3, context = self._z3()
        match tree:
            case n.Parenthesized(inner):
                return self._truth(inner)
            case n.Unary(Operator.NOT, operand):
                return z3.Not(self._truth(operand))
            case n.Operation(operator, operands) if operator in _JOINING:
                return getattr(z3, _JOINING[operator])(*map(self._truth, operands))
            case n.Operation(Operator.XOR, operands):
                return reduce(z3.Xor, map(self._truth, operands))
            case n.Operation(operator, (left, right)) if operator in COMPARING:
                return self._comparison(tree, operator, left, right)
        constant = self._constant(tree)
        if constant is not None:
            if constant.kind is LiteralKind.BOOL or constant.value in (0, 1):
                return z3.BoolVal(bool(constant.value), ctx=context)
            return self._unknown(tree, "is no Boolean value")
        domain = self._domain(tree)
        if domain is not None and domain.kind is not ValueKind.BOOL:
            return self._unknown(tree, "is no Boolean value")
        return self._atom(tree, ValueKind.BOOL).term

    def _comparison(self, tree: n.Operation, operator: Operator, left: Expression, right: Expression) -> Any:
        kinds = [self._kind(side) for side in (left, right)]
        kind = kinds[0] or kinds[1]
        if kind is None:
            # two names of which nothing is known: that they are numbers is no more than a guess
            self._doubt(f"the type of {print_node(left)} and {print_node(right)} is not known")
            kind = ValueKind.REAL
        if ValueKind.BOOL in kinds:
            if operator in (Operator.EQUAL, Operator.UNEQUAL):
                return COMPARING[operator](self._truth(left), self._truth(right))
            return self._unknown(tree, "compares Boolean values by size")
        numbers = all(k is None or k in _NUMBERS for k in kinds)
        if None not in kinds and kinds[0] is not kinds[1] and not numbers:
            return self._unknown(tree, "compares values of different types")
        by_size = operator not in (Operator.EQUAL, Operator.UNEQUAL)
        if by_size and (kind is ValueKind.SYMBOL or (kind is ValueKind.TEXT and not self.guessing)):
            return self._unknown(tree, "compares texts or names by size")
        is_number = ValueKind.REAL in kinds or kinds == [None, None]
        is_name = isinstance(n.bare(left), n.Name | n.Member | n.Index)
        if is_number and is_name and not self.guessing and self._key(left) == self._key(right):
            # how programs ask for NaN, which no number of z3 is
            z3, _ = self._z3()
            differs = self._atom(n.Operation(Operator.UNEQUAL, (left, right)), ValueKind.BOOL).term
            return differs if operator is Operator.UNEQUAL else z3.Not(differs)
        return COMPARING[operator](self._value(left, kind), self._value(right, kind))

    # -- values

    def _kind(self, tree: Expression) -> ValueKind | None:
        """Return the kind of a value; None: unknown."""
        tree = n.bare(tree)
        constant = self._constant(tree)
        if constant is not None:
            return KIND_OF_LITERAL.get(constant.kind)
        domain = self._domain(tree)
        if domain is not None:
            return domain.kind
        match tree:
            case n.Operation(Operator.AND_THEN | Operator.OR_ELSE):
                return ValueKind.BOOL
            case n.Unary(Operator.NOT, operand):
                return self._kind(operand) or ValueKind.BOOL
            case n.Operation(operator) if operator in COMPARING:
                return ValueKind.BOOL
            case n.Operation(Operator.AND | Operator.OR | Operator.XOR, operands):
                # of BOOL or of bit strings, whichever its operands are
                kinds = [self._kind(operand) for operand in operands]
                return next((kind for kind in kinds if kind is not None), None)
            case n.Call(n.Name(name)) if name.upper() == "LEN":
                return ValueKind.INTEGER
        if self.guessing:
            kind = self._calculated_kind(tree)
            if kind is not None:
                return kind
        if self._key(tree) in self._boolean:
            return ValueKind.BOOL
        atom = self._atoms.get(self._key(tree))
        return atom.kind if atom is not None else None

    def _value(self, tree: Expression, kind: ValueKind) -> Any:
        z3, context = self._z3()
        tree = n.bare(tree)
        constant = self._constant(tree)
        if constant is None:
            made = self._calculation(tree, kind)
            return self._atom(tree, kind).term if made is None else made
        value = constant.value
        if isinstance(value, str) and constant.kind is LiteralKind.STRING:
            return text_term(value, context)
        if isinstance(value, str):
            return z3.IntVal(self._code(constant), ctx=context)
        if isinstance(value, date):
            return z3.IntVal(value.toordinal(), ctx=context)
        if isinstance(value, float):
            return z3.RealVal(Fraction(value), ctx=context)
        return z3.IntVal(int(value), ctx=context)

    def _calculated_kind(self, tree: Expression) -> ValueKind | None:
        """Return the kind of the result of an operation or a standard function; None: not known."""
        match tree:
            case n.Unary(Operator.NEGATE | Operator.PLUS, operand):
                return self._kind(operand)
            case n.Operation(_, operands):
                kinds = [self._kind(operand) for operand in operands]
            case n.Call(n.Name(name), arguments) if name.upper() in OF_NUMBERS:
                kinds = [self._kind(each.value) for each in arguments if each.value is not None]
            case n.Call(n.Name(name)) if name.upper() in TEXT_RESULT:
                return ValueKind.TEXT
            case n.Call(n.Name(name)) if name.upper() == "FIND":
                return ValueKind.INTEGER
            case n.Call(n.Name(name)) if is_standard_call(tree):
                return KIND_OF_NUMBER.get(name.upper().rpartition("TO_")[2]) if "TO_" in name.upper() else None
            case _:
                return None
        known = [kind for kind in kinds if kind is not None]
        return ValueKind.REAL if ValueKind.REAL in known else next(iter(known), None)

    def _calculation(self, tree: Expression, kind: ValueKind) -> Any:
        """Return the term of an operation or a standard function, where that is known and wanted; else None."""
        z3, _ = self._z3()
        if isinstance(tree, n.Call) and (name := tree.called.upper()):
            given = [each.value for each in tree.arguments if each.value is not None]
            if name != "LEN" and not self.guessing:
                return None
            texts = FIRST_IS_TEXT.get(name, 0)
            if texts or name in OF_NUMBERS:
                other = ValueKind.INTEGER if texts else kind
                terms = [self._value(a, ValueKind.TEXT if i < texts else other) for i, a in enumerate(given)]
                return called(z3, name, terms)
            source = self._kind(given[0]) if len(given) == 1 else None
            if source in _NUMBERS and self._calculated_kind(tree) in _NUMBERS:
                to_real = self._calculated_kind(tree) is ValueKind.REAL
                made = converted(z3, self._value(given[0], source), to_real=to_real)
                return made if to_real or source is ValueKind.REAL else _cut(made, name)
        if not self.guessing or kind not in (*_NUMBERS, ValueKind.DURATION):
            return None
        match tree:
            case n.Unary(Operator.NEGATE, operand):
                return -self._value(operand, kind)
            case n.Operation(operator, operands) if operator in CALCULATING | {Operator.POWER}:
                return calculated(z3, operator, [self._value(each, self._kind(each) or kind) for each in operands])
        return None

    def _constant(self, tree: Expression) -> LiteralValue | None:
        return constant_of(tree, self.dialect, self.knowledge)

    def _domain(self, tree: Expression) -> VariableValues | None:
        if self.knowledge is None or not isinstance(tree, n.Operand):
            return None
        known = self.knowledge(tree)
        return known if isinstance(known, VariableValues) else None

    def _code(self, symbol: LiteralValue) -> int:
        """Return a number for a text or the name of an enumeration's value: equal ones get the same."""
        named = symbol.kind is LiteralKind.ENUMERATED
        key = str(symbol.value).casefold() if named else f"'{symbol.value}'"
        if key not in self._codes:
            self._codes[key] = len(self._symbols)
            self._symbols.append(str(symbol.value) if named else write_literal(symbol, self.dialect))
        return self._codes[key]

    # -- atoms

    def _atom(self, tree: Expression, kind: ValueKind) -> _Atom:
        z3, context = self._z3()
        key = self._key(tree)
        domain = self._domain(tree)
        kind = domain.kind if domain is not None else kind
        found = self._atoms.get(key)
        if found is not None and (found.kind is kind or (found.kind in _NUMBERS and kind in _NUMBERS)):
            return found
        text = print_node(tree)
        # A name used in two types is two unrelated atoms: that only makes more possible, so no condition is called
        # impossible by mistake.
        if found is not None:
            key += f" as {kind}"
            self._doubt(f"{text} is used as {found.kind} and as {kind}")
        if kind is ValueKind.BOOL:
            term = z3.Bool(key, ctx=context)
        elif kind is ValueKind.TEXT:
            term = z3.Const(key, z3.StringSort(ctx=context))
        elif kind in _NUMBERS and (domain is None or kind is ValueKind.REAL):
            term = z3.Real(key, ctx=context)
        else:
            term = z3.Int(key, ctx=context)
            term = term * domain.unit if domain is not None and domain.unit > 1 else term
        if domain is not None:
            self._bounds += [term >= bound for bound in [domain.least] if bound is not None]
            self._bounds += [term <= bound for bound in [domain.greatest] if bound is not None]
            if domain.symbols:
                codes = [self._code(LiteralValue(LiteralKind.ENUMERATED, symbol)) for symbol in domain.symbols]
                self._bounds.append(z3.Or(*(term == code for code in codes)))
        if not _is_variable(tree):
            self._doubt(f"the value of {text} is not known")
        elif text.casefold() in self._own or self._own & set(path_of(tree)[:1]):
            self._doubt(f"{text} is written while the condition is evaluated")
        made = self._atoms[key] = _Atom(text, kind, term, domain is not None)
        return made

    def _key(self, tree: Expression) -> str:
        """Equal keys, equal values. Calls may answer differently each time, but for standard functions."""
        text = folded(print_node(tree))
        calls = [node for node in walk(tree) if isinstance(node, n.Call)]
        if any(not is_standard_call(call) for call in calls):
            return f"{text} at {id(tree)}"
        return f"{text} in condition {self._side}" if names_of(tree) & self._own else text

    def _unknown(self, tree: Expression, why: str) -> Any:
        z3, context = self._z3()
        self._doubt(f"{print_node(tree)} {why}")
        return z3.FreshBool(ctx=context)

    def _find_booleans(self, tree: Expression) -> None:
        """Note what must be Boolean by its place: then it is where it is compared, too."""
        match tree:
            case n.Parenthesized(inner) | n.Unary(Operator.NOT, inner):
                self._find_booleans(inner)
            case n.Operation(operator, operands) if operator in _JOINING or operator is Operator.XOR:
                for operand in operands:
                    self._find_booleans(operand)
            case n.Name() | n.Member() | n.Index() | n.Address():
                self._boolean.add(print_node(tree).casefold())

    def _doubt_parts(self) -> None:
        """A word and one of its bits, a structure and its member do not have values independent of each other."""
        for key, atom in self._atoms.items():
            for other in self._atoms:
                if other.startswith((f"{key}.", f"{key}[")):
                    self._doubt(f"{atom.text} and {self._atoms[other].text} depend on each other")

    def _doubt(self, reason: str) -> None:
        if reason not in self.doubts:
            self.doubts.append(reason)


_EFFORT = 20_000_000
"""z3's own measure of work, the same on every machine: some seconds. Conditions of real charts need a thousandth."""

_FAR = 100
"""How far from numbers that are avoided others are looked for first."""
_EFFORT_FOR_A_MODEL = 1_000_000


def _is_variable(tree: Expression) -> bool:
    match tree:
        case n.Name() | n.Address():
            return True
        case n.Member(base):
            return _is_variable(base)
        case n.Index(base, indices):
            return _is_variable(base) and all(isinstance(n.bare(i), n.Literal) for i in indices)
    return False


Situation = Mapping[str, str]
"""Values of variables, as literals of structured text."""
