"""Translation of operators: which type the result has, and where it wraps (ed. 3, 7.3.2)."""

from __future__ import annotations

import operator as operations
from dataclasses import replace

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.expression_types import ORDER, bounds, calculated_type, common_type
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Operator
from plcopen_sfc.semantics.programs import runtime
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.paths import PathTranslator
from plcopen_sfc.semantics.programs.places import Unknown
from plcopen_sfc.semantics.programs.value_code import Code, constant, settled, wrapping

_COMPARISONS = {
    Operator.EQUAL: ("==", operations.eq),
    Operator.UNEQUAL: ("!=", operations.ne),
    Operator.LESS: ("<", operations.lt),
    Operator.GREATER: (">", operations.gt),
    Operator.LESS_OR_EQUAL: ("<=", operations.le),
    Operator.GREATER_OR_EQUAL: (">=", operations.ge),
}
_LOGIC = {
    Operator.AND: ("and", "&", operations.and_),
    Operator.AND_THEN: ("and", "&", operations.and_),
    Operator.OR: ("or", "|", operations.or_),
    Operator.OR_ELSE: ("or", "|", operations.or_),
    Operator.XOR: ("!=", "^", operations.xor),
}
_ARITHMETIC = {Operator.ADD: "+", Operator.SUBTRACT: "-", Operator.MULTIPLY: "*"}
_OF_REALS = {"+": operations.add, "-": operations.sub, "*": operations.mul, "/": operations.truediv}
_LAZY = (Operator.AND_THEN, Operator.OR_ELSE)


class Operators:
    """Translates operations."""

    def __init__(self, translator: PathTranslator) -> None:
        self._translator = translator
        self._converter = translator.library.converter

    def value(self, node: n.Unary | n.Operation, expected: t.Type | None) -> Code:
        """Return the value of an operation."""
        if isinstance(node, n.Unary):
            return self._unary(node, expected)
        if node.operator in _LOGIC:
            return self.logic(node.operator, self._operands(node, _wanted_bits(expected)))
        if node.operator in _COMPARISONS:
            return self.comparison(node.operator, *self._operands(node, None))
        codes = self._operands(node, expected)
        result = codes[0]
        for code in codes[1:]:
            result = self.arithmetic(node.operator, result, code)
        return result

    def _operands(self, node: n.Operation, expected: t.Type | None) -> list[Code]:
        """Return the operands; an undeclared one takes the type of the first that has one."""
        if expected is None or not isinstance(expected, t.ScalarType):
            types = [self.known_type(operand) for operand in node.operands]
            expected = next((type_ for type_ in types if type_ is not None), t.DINT)
        return [self._translator.value(operand, expected) for operand in node.operands]

    def known_type(self, node: n.Expression) -> t.Type | None:
        """Return the type of an operand; None for an undeclared one."""
        node = n.bare(node)
        if isinstance(node, n.Name | n.Member | n.Index):
            found = self._translator.meaning(node)
            if isinstance(found, Unknown):
                return self._translator.library.implicit_type(found.path)
            type_: t.Type | None = getattr(found, "type", None)
            return type_.base if isinstance(type_, t.ReferenceType) and type_.automatic else type_
        if isinstance(node, n.Literal):
            code = self._translator.value(node)
            return t.DINT if code.loose and code.type in (t.INT, t.DINT) else code.type
        return None

    # -- one operand

    def _unary(self, node: n.Unary, expected: t.Type | None) -> Code:
        if node.operator is Operator.NOT:
            return self.inverted(self._translator.value(node.operand, _wanted_bits(expected)))
        code = self._translator.value(node.operand, expected if expected is not t.BOOL else None)
        if node.operator is Operator.PLUS:
            return code
        type_ = code.type
        if not isinstance(type_, t.ScalarType) or type_.family in (t.Family.BOOL, t.Family.STRING):
            raise SimulationError(f"a {type_.name} has no sign")
        if not code.loose:
            type_ = self._calculated(type_)
            code = replace(code, type=type_)
        if code.constant:
            low = -code.value if isinstance(code.value, int) else 0
            return replace(constant(-code.value, type_, loose=code.loose), low=low, high=low)
        return replace(code, text=f"(-{code.text})", low=-code.high, high=-code.low)

    def inverted(self, code: Code) -> Code:
        """NOT."""
        type_ = code.type
        if not isinstance(type_, t.ScalarType):
            raise SimulationError(f"NOT of a {type_.name}")
        if type_.family is t.Family.BOOL:
            if code.constant:
                return Code(repr(not code.value), t.BOOL, 0, 1, not code.value, constant=True)
            return replace(code, text=f"(not {code.text})")
        if type_.family in (t.Family.INTEGER, t.Family.BITS):
            code = settled(code)
            if code.constant:
                return settled(constant(~code.value, type_, loose=code.loose))
            if type_.least < 0:
                return replace(code, text=f"(~{code.text})", low=~code.high, high=~code.low)
            return replace(code, text=f"({code.text} ^ {type_.greatest})", low=0, high=type_.greatest)
        if type_.family is t.Family.SPECIAL:
            return replace(code, text=f"(not {code.text})", type=t.BOOL)
        raise SimulationError(f"NOT of a {type_.name}")

    # -- logic

    def logic(self, operator: Operator, codes: list[Code]) -> Code:
        """AND, OR, XOR of BOOLs and bit strings. Operands without calls are evaluated only while needed."""
        word, sign, joined = _LOGIC[operator]
        acts = any(code.acts for code in codes)
        if all(_is_truth(code) for code in codes):
            if operator is Operator.XOR:
                text = codes[0].text
                for code in codes[1:]:
                    text = f"({text} != {code.text})"
                return Code(text, t.BOOL, 0, 1, acts=acts)
            # `and` of Python would not call what is behind a FALSE operand: AND calls all of them, AND_THEN does not
            skips = operator in _LAZY or self._translator.library.profile.skips_operands
            if not skips and any(code.acts for code in codes[1:]):
                word = sign
            return Code(f"({f' {word} '.join(code.text for code in codes)})", t.BOOL, 0, 1, acts=acts)
        result = codes[0]
        for code in codes[1:]:
            type_ = self.common(result, code)
            if type_.family is t.Family.BOOL or not type_.is_ranged:
                other = next((each for each in codes if not _is_truth(each)), code)
                raise SimulationError(f"{operator} of {result.type.name} and {other.type.name}")
            left, right = (settled(self._converter.converted(c, type_)) for c in (result, code))
            if left.constant and right.constant:
                result = constant(joined(left.value, right.value), type_, loose=result.loose and code.loose)
            else:
                for each in (left, right):
                    if each.constant:
                        self._translator.library.use.masks.setdefault(each.value)
                low, high = (0, type_.greatest) if type_.least >= 0 else (type_.least, type_.greatest)
                result = Code(f"({left.text} {sign} {right.text})", type_, low, high, acts=acts)
        return result

    # -- comparisons

    def comparison(self, operator: Operator, left: Code, right: Code) -> Code:
        """Return a comparison of two values."""
        sign, compared = _COMPARISONS[operator]
        if isinstance(left.type, t.ReferenceType) or isinstance(right.type, t.ReferenceType):
            if operator not in (Operator.EQUAL, Operator.UNEQUAL):
                raise SimulationError("references have no order")
            return Code(f"({left.text} {sign} {right.text})", t.BOOL, 0, 1, acts=left.acts or right.acts)
        left, right = self._comparable(left, right)
        left, right = settled(left), settled(right)
        text = f"({left.text} {sign} {right.text})"
        if left.constant and right.constant:
            value = compared(left.value, right.value)
            return Code(repr(value), t.BOOL, 0, 1, value, constant=True)
        if t.BOOL not in (left.type, right.type):
            self._translator.comparisons += 1
        return Code(text, t.BOOL, 0, 1, acts=left.acts or right.acts)

    def _comparable(self, left: Code, right: Code) -> tuple[Code, Code]:
        """Return two values of types whose values can be compared as they are."""
        one, other = left.type, right.type
        if not isinstance(one, t.ScalarType) or not isinstance(other, t.ScalarType):
            raise SimulationError(f"{one.name} and {other.name} cannot be compared")
        if t.Family.SPECIAL in (one.family, other.family) or one.family is other.family:
            return self._rounded(left, right)
        if one.is_number and other.is_number:
            return self._rounded(left, right)
        if {one.family, other.family} <= {t.Family.BOOL, t.Family.INTEGER, t.Family.BITS}:
            return left, right
        type_ = self.common(left, right)
        return self._converter.converted(left, type_), self._converter.converted(right, type_)

    def _rounded(self, left: Code, right: Code) -> tuple[Code, Code]:
        """Return two values; a literal that is compared with a REAL is one."""
        for one, other in ((left, right), (right, left)):
            if one.type == t.REAL and other.constant and other.loose:
                rounded = self._converter.converted(other, t.REAL)
                return (left, rounded) if other is right else (rounded, right)
        return left, right

    # -- arithmetic

    def arithmetic(self, operator: Operator, left: Code, right: Code) -> Code:
        """Sum, difference, product, quotient, remainder or power of two values."""
        one, other = left.type, right.type
        if not isinstance(one, t.ScalarType) or not isinstance(other, t.ScalarType):
            raise SimulationError(f"{operator} of {one.name} and {other.name}")
        if operator is Operator.POWER:
            return self._power(left, right)
        timed = [type_ for type_ in (one, other) if type_.is_ranged and not type_.is_number]
        if timed:
            return self._timed(operator, left, right)
        type_ = self.common(left, right)
        if t.Family.BOOL in (one.family, other.family) or type_.family is t.Family.STRING:
            raise SimulationError(f"{operator} of {one.name} and {other.name}")
        if type_.family is t.Family.SPECIAL:
            return Code(f"({left.text} {_ARITHMETIC.get(operator, '/')} {right.text})", t.ANY, acts=True)
        type_ = self._calculated(type_)
        left, right = (self._converter.converted(c, type_) if c.type != type_ else c for c in (left, right))
        if type_.family is t.Family.REAL:
            return self._real(operator, left, right, type_)
        return self._integer(operator, left, right, type_)

    def _real(self, operator: Operator, left: Code, right: Code, type_: t.ScalarType) -> Code:
        if operator is Operator.MODULO:
            raise SimulationError("MOD of real numbers")
        sign = _ARITHMETIC.get(operator, "/")
        text = f"({left.text} {sign} {right.text})"
        acts = left.acts or right.acts
        if left.constant and right.constant and not (sign == "/" and right.value == 0):
            value = _OF_REALS[sign](left.value, right.value)
            loose = left.loose and right.loose
            return constant(runtime.single(value) if type_.bits == 32 and not loose else value, type_, loose=loose)
        return Code(f"single({text})" if type_.bits == 32 else text, type_, acts=acts)

    def _integer(self, operator: Operator, left: Code, right: Code, type_: t.ScalarType) -> Code:
        acts, loose = left.acts or right.acts, left.loose and right.loose
        if operator in (Operator.DIVIDE, Operator.MODULO):
            if operator is Operator.MODULO:
                self._translator.library.use.shifts.setdefault(0)
            return self._quotient(operator, settled(left), settled(right), type_)
        # no wrapping between operations: sums of sums are wrapped once, where they are stored, which gives the same
        if _is_big(left) or _is_big(right):
            left, right = settled(left), settled(right)
        sign = _ARITHMETIC[operator]
        low, high = bounds(operator, (left.low, left.high), (right.low, right.high))
        if left.constant and right.constant:
            if loose:
                type_ = _wide_enough(type_, low)
            return settled(replace(constant(low, type_, loose=loose), low=low, high=high))
        return Code(f"({left.text} {sign} {right.text})", type_, low, high, acts=acts)

    def _quotient(self, operator: Operator, left: Code, right: Code, type_: t.ScalarType) -> Code:
        acts, loose = left.acts or right.acts, left.loose and right.loose
        if right.constant and right.value == 0:
            raise SimulationError("division by zero")
        divides = operator is Operator.DIVIDE
        if left.constant and right.constant:
            found = runtime.divided(left.value, right.value) if divides else runtime.remainder(left.value, right.value)
            return settled(constant(found, type_, loose=loose))
        # Python rounds down, IEC 61131-3 towards zero: the same where nothing is negative, and its operators are faster
        if left.low >= 0 and right.low >= 0:
            text = f"({left.text} {'//' if divides else '%'} {right.text})"
            return Code(text, type_, 0, left.high, acts=acts)
        bound = max(abs(left.low), abs(left.high))
        name = "divided" if divides else "remainder"
        low, high = (-bound, bound) if divides else (max(type_.least, -bound), min(type_.greatest, bound))
        return Code(f"{name}({left.text}, {right.text})", type_, low, high, acts=acts)

    def _power(self, left: Code, right: Code) -> Code:
        """``**``: a real number (ed. 3, table 28: EXPT), also of integers."""
        type_ = left.type if isinstance(left.type, t.ScalarType) and left.type.family is t.Family.REAL else t.LREAL
        base = self._converter.converted(left, type_)
        exponent = right if right.type != t.BOOL else self._converter.converted(right, t.INT)
        text = f"power({base.text}, {settled(exponent).text})"
        acts = left.acts or right.acts
        return Code(f"single({text})" if type_.bits == 32 else text, type_, acts=acts)

    def _timed(self, operator: Operator, left: Code, right: Code) -> Code:
        """Durations, dates and times (ed. 3, table 35)."""
        one, other = left.type, right.type
        assert isinstance(one, t.ScalarType) and isinstance(other, t.ScalarType)  # noqa: S101, PT018
        acts = left.acts or right.acts
        if operator in (Operator.MULTIPLY, Operator.DIVIDE):
            return self._scaled(operator, left, right)
        if operator not in (Operator.ADD, Operator.SUBTRACT):
            raise SimulationError(f"{operator} of {one.name} and {other.name}")
        if one.is_number or other.is_number:
            timed = other if one.is_number else one
            if timed.family is not t.Family.DURATION:
                raise SimulationError(f"{operator} of {one.name} and {other.name}")
            left, right = self._converter.converted(left, timed), self._converter.converted(right, timed)
            one = other = timed
        result = one
        if one.family is other.family is t.Family.DURATION:
            result = max(one, other, key=lambda type_: type_.bits)
        elif one.family is other.family and operator is Operator.SUBTRACT:  # two instants: the time between them
            long = one.name.startswith("L")
            result = t.LTIME if long else t.elementary("TIME", self._translator.library.dialect) or t.LTIME
        elif one.family is t.Family.DURATION:  # a duration and an instant
            result = other
        left, right = settled(left), settled(right)
        sign = _ARITHMETIC[operator]
        low, high = bounds(operator, (left.low, left.high), (right.low, right.high))
        if left.constant and right.constant:
            return settled(replace(constant(low, result), low=low, high=high))
        return settled(Code(f"({left.text} {sign} {right.text})", result, low, high, acts=acts))

    def _scaled(self, operator: Operator, left: Code, right: Code) -> Code:
        """Return a duration times or by a number (ed. 3, table 35: MUL_TIME, DIV_TIME)."""
        if operator is Operator.MULTIPLY and left.type.name not in _DURATIONS:
            left, right = right, left
        type_, number = left.type, right.type
        if not isinstance(type_, t.ScalarType) or type_.family is not t.Family.DURATION:
            raise SimulationError(f"{operator} of {left.type.name} and {right.type.name}")
        left, right = settled(left), settled(right)
        acts = left.acts or right.acts
        assert isinstance(number, t.ScalarType)  # noqa: S101  # arithmetic has looked
        if number.family is t.Family.DURATION and operator is Operator.DIVIDE:
            return Code(f"divided({left.text}, {right.text})", t.LINT, t.LINT.least, t.LINT.greatest, acts=acts)
        if not number.is_number:
            raise SimulationError(f"{operator} of {type_.name} and {number.name}")
        sign = "*" if operator is Operator.MULTIPLY else "/"
        if number.family is t.Family.REAL:
            text = f"truncated({left.text} {sign} {right.text})"
        else:
            text = f"({left.text} * {right.text})" if sign == "*" else f"divided({left.text}, {right.text})"
        return Code(wrapping(text, type_), type_, type_.least, type_.greatest, acts=acts)

    # -- types

    def _calculated(self, type_: t.ScalarType) -> t.ScalarType:
        """Return the type in which the tool calculates with values of a type."""
        base, library = _base(type_), self._translator.library
        if library.profile.matiec_library and base.family is t.Family.INTEGER and base.bits < t.DINT.bits:
            return t.DINT  # an int of C
        name = calculated_type(library.dialect, base.name) if base.name in ORDER else base.name
        return type_ if name == base.name else t.ELEMENTARY[name]

    def common(self, left: Code, right: Code) -> t.ScalarType:
        """Return the type in which two values are calculated: the greater; a literal takes that of the other."""
        one, other = left.type, right.type
        if not isinstance(one, t.ScalarType) or not isinstance(other, t.ScalarType):
            raise SimulationError(f"{one.name} and {other.name} do not go together")
        if t.Family.SPECIAL in (one.family, other.family):
            return t.ANY
        if left.loose != right.loose:
            literal, typed = (left, right) if left.loose else (right, left)
            if not isinstance(typed.type, t.ScalarType) or not isinstance(literal.type, t.ScalarType):
                raise SimulationError(f"{one.name} and {other.name} do not go together")
            type_ = _base(typed.type)
            whole = literal.type.family is not t.Family.REAL
            is_fitting = type_.is_number and whole and type_.least <= int(literal.value) <= type_.greatest
            if type_.family is t.Family.REAL or is_fitting:
                return type_
        one, other = _base(one), _base(other)
        if one.family is t.Family.REAL or other.family is t.Family.REAL:
            if not (one.is_number and other.is_number):
                raise SimulationError(f"{one.name} and {other.name} do not go together")
            reals = [type_ for type_ in (one, other) if type_.family is t.Family.REAL]
            return max(reals, key=lambda type_: type_.bits)
        if one.name in ORDER and other.name in ORDER:
            return t.ELEMENTARY[common_type(self._translator.library.dialect, one.name, other.name)]
        if one.is_ranged and not one.is_number:
            return one
        if other.is_ranged and not other.is_number:
            return other
        return one if one.family is not t.Family.BOOL else other


_DURATIONS = ("TIME", "LTIME", "S5TIME")


def _base(type_: t.ScalarType) -> t.ScalarType:
    """Return the type that a subrange or enumeration is one of."""
    if (type_.narrowed is None and not type_.names) or not type_.is_number:
        return type_
    for name in ORDER:
        known = t.ELEMENTARY[name]
        if (known.least, known.greatest, known.family) == (type_.least, type_.greatest, type_.family):
            return known
    return type_


def _is_truth(code: Code) -> bool:
    return isinstance(code.type, t.ScalarType) and code.type.family in (t.Family.BOOL, t.Family.SPECIAL)


def _wanted_bits(expected: t.Type | None) -> t.Type:
    return expected if isinstance(expected, t.ScalarType) and expected.family is t.Family.BITS else t.BOOL


_BIG = 1 << 200


def _is_big(code: Code) -> bool:
    """True if a value that has not been wrapped could grow without an end."""
    return code.low < -_BIG or code.high > _BIG


def _wide_enough(type_: t.ScalarType, value: int) -> t.ScalarType:
    for name in (type_.name, "DINT", "LINT", "ULINT"):
        known = t.ELEMENTARY[name]
        if known.least <= value <= known.greatest:
            return known
    return type_
