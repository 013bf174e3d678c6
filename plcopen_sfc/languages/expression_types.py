"""Elementary types of expressions, and the types in which tools calculate with integers and bit strings.

IEC 61131-3, 7.3.2, gives the result of an operation the type of its operands, and leaves open what is done with several
types. Evidence: help of CODESYS and TwinCAT 3, "Operators", overflow in the data type; help of TIA Portal, "Arithmetic
expressions" of SCL; for the order of types of other tools a guess.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import INTEGER_RANGES, LiteralKind, known_literal
from plcopen_sfc.languages.st.nodes import Expression, Node, Operator
from plcopen_sfc.model.dialect import Dialect

ORDER = ("SINT", "USINT", "BYTE", "INT", "UINT", "WORD", "DINT", "UDINT", "DWORD", "LINT", "ULINT", "LWORD")
"""Integers and bit strings, from the narrowest to the widest: of two types the later one is that of their sum."""
UNSIGNED = frozenset({"USINT", "UINT", "UDINT", "ULINT"})
_SIGNED = ("SINT", "INT", "DINT", "LINT")
NATIVE = "DINT"
"""The least type in which CODESYS calculates: that of 32-bit hardware. On 64-bit hardware it is LINT."""
_NUMBERS = UNSIGNED | set(_SIGNED)
SUMS = frozenset({Operator.ADD, Operator.SUBTRACT, Operator.MULTIPLY})
CALCULATING = SUMS | {Operator.DIVIDE, Operator.MODULO}
BIT_STRINGS = frozenset({"BYTE", "WORD", "DWORD", "LWORD"})
REALS = ("REAL", "LREAL")
_DURATIONS = ("TIME", "LTIME")
INSTANTS = frozenset({"DATE", "LDATE", "TOD", "LTOD", "DT", "LDT"})
CONVERSION = re.compile(r"(?:(?P<source>[A-Z]+)_)?TO_(?P<result>[A-Z]+)")
OF_ONE_TYPE = {"ABS": 0, "MIN": 0, "MAX": 0, "LIMIT": 0, "SEL": 1, "MUX": 1}
"""Standard functions whose result has the type of their arguments, and how many others come before these."""
_RESULTS = {
    **{"TRUNC": "DINT", "TRUNC_INT": "INT", "LEN": "INT", "FIND": "INT", "ROUND": "DINT"},
    **dict.fromkeys(("LEFT", "RIGHT", "MID", "CONCAT", "INSERT", "DELETE", "REPLACE"), "STRING"),
}


def bits_of(name: str) -> int:
    """Return the width of an integer or bit string."""
    return 8 << ORDER.index(name) // 3


def common_type(dialect: Dialect, one: str, other: str) -> str:
    """Return the type that two operands are brought to.

    S7 takes a signed type that holds the values of both where one of them is signed and the other is not.
    """
    if dialect is Dialect.SCL and (one in UNSIGNED) is not (other in UNSIGNED) and {one, other} <= _NUMBERS:
        unsigned = one if one in UNSIGNED else other
        signed = other if one in UNSIGNED else one
        holding = _SIGNED[min(ORDER.index(unsigned) // 3 + 1, len(_SIGNED) - 1)]
        return max(signed, holding, key=ORDER.index)
    return max(one, other, key=ORDER.index)


def calculated_type(dialect: Dialect, name: str) -> str:
    """Return the type in which operands of type `name` are added, subtracted, multiplied, divided and negated.

    CODESYS and TwinCAT calculate with the width of the processor and cut off only what is assigned or converted.
    """
    if dialect in (Dialect.CODESYS, Dialect.TWINCAT) and bits_of(name) < bits_of(NATIVE):
        return NATIVE
    return name


@dataclass(frozen=True, slots=True)
class ElementaryValue:
    """The elementary type of an expression, empty where it is not known, and the integers that it can be.

    `loose`: a number without a type, which takes that of its surroundings.
    """

    type: str
    low: int = 0
    high: int = 0
    loose: bool = False

    @property
    def is_whole(self) -> bool:
        """True for integers and bit strings."""
        return self.loose or self.type in ORDER


UNKNOWN = ElementaryValue("")


def _of_type(name: str) -> ElementaryValue:
    return ElementaryValue(name, *INTEGER_RANGES[name]) if name in ORDER else ElementaryValue(name)


def fits(value: ElementaryValue, name: str) -> bool:
    """True if a type holds all numbers that a value can be."""
    least, greatest = INTEGER_RANGES[name]
    return least <= value.low and value.high <= greatest


def _range(value: ElementaryValue) -> tuple[int, int]:
    """Return the numbers that an operand can be: what is too great for its type has been cut off."""
    return (value.low, value.high) if value.loose or fits(value, value.type) else INTEGER_RANGES[value.type]


def number_of(name: str) -> str:
    """Return the integer type with the values of a bit string."""
    return {"BYTE": "USINT", "WORD": "UINT", "DWORD": "UDINT", "LWORD": "ULINT"}.get(name, name)


def bits_as_wide_as(name: str) -> str:
    """Return the bit string with the width of an integer."""
    return ORDER[ORDER.index(name) // 3 * 3 + 2]


class ExpressionTypes:
    """The types of expressions of a text under the rules of its tool.

    `type_of` gives the elementary type of a variable or of the result of a function of the project, in capitals, empty
    where it has another (see `Resolver.type_of`); without it only literals and what is made of them are known.
    """

    def __init__(self, dialect: Dialect, type_of: Callable[[Expression], str] | None = None) -> None:
        self._dialect = dialect
        self._type_of = type_of
        self._known: dict[int, tuple[Node, ElementaryValue]] = {}

    def value(self, node: Expression) -> ElementaryValue:
        """Return the type of an expression, and the numbers that it can be."""
        found = self._known.get(id(node))
        if found is None or found[0] is not node:
            found = self._known[id(node)] = node, self._value(node)
        return found[1]

    def _value(self, node: Expression) -> ElementaryValue:
        match node:
            case n.Parenthesized(inner):
                return self.value(inner)
            case n.Literal():
                return self._literal(node)
            case n.Unary(Operator.NOT, operand):
                value = self.value(operand)
                return value if value.loose else _of_type(value.type)
            case n.Unary(operator, operand):
                value = self.value(operand)
                return (
                    self.calculated(Operator.SUBTRACT, [ElementaryValue("", loose=True), value])
                    if value.is_whole
                    else value
                )
            case n.Operation(operator, operands) if operator in n.COMPARISONS:
                return ElementaryValue("BOOL")
            case n.Operation(operator, operands) if operator in n.CONNECTIVES:
                return self._joined([self.value(each) for each in operands])
            case n.Operation(operator, operands) if operator in CALCULATING:
                return self.calculated(operator, [self.value(each) for each in operands])
            case n.Operation():
                return ElementaryValue("LREAL")
            case n.Call(n.Name(name), arguments):
                return self._result(node, name.upper(), arguments)
        return _of_type(self._type_of(node)) if self._type_of is not None else UNKNOWN

    def _literal(self, node: n.Literal) -> ElementaryValue:
        found = known_literal(node, self._dialect)
        if found is None:
            return UNKNOWN
        if found.kind is LiteralKind.INTEGER and isinstance(found.value, int):
            return ElementaryValue(found.type, found.value, found.value, loose=not found.type)
        kinds = {LiteralKind.REAL: "REAL", LiteralKind.BOOL: "BOOL", LiteralKind.STRING: "STRING"}
        return ElementaryValue(found.type or kinds.get(found.kind, ""))

    def _joined(self, values: list[ElementaryValue]) -> ElementaryValue:
        types = [value.type for value in values if not value.loose]
        if types and all(each in ORDER for each in types):
            return _of_type(reduce(lambda a, b: common_type(self._dialect, a, b), types))
        return ElementaryValue("BOOL") if "BOOL" in types else UNKNOWN

    def calculated(self, operator: Operator, values: list[ElementaryValue]) -> ElementaryValue:
        """The result of an arithmetic operation: its type, and the numbers that it can be before it is cut off."""
        types = [value.type for value in values if not value.loose]
        if not all(value.is_whole for value in values):
            return ElementaryValue(_mixed(types))
        low, high = _range(values[0])
        for value in values[1:]:
            low, high = bounds(operator, (low, high), _range(value))
        if not types:
            return ElementaryValue("", low, high, loose=True)
        return ElementaryValue(calculated_type(self._dialect, operand_type(self._dialect, types, values)), low, high)

    def _result(self, node: n.Call, name: str, arguments: tuple[n.Argument, ...]) -> ElementaryValue:
        found = CONVERSION.fullmatch(name)
        if found is not None and (found["source"] is None or found["source"] in _ELEMENTARY):
            return _of_type(found["result"])
        values = [self.value(each.value) for each in arguments if each.value is not None]
        if name in _RESULTS:
            own = self._type_of(node) if self._type_of is not None else ""  # a function of the project hides it
            return _of_type(own or _RESULTS[name])
        if name in OF_ONE_TYPE:
            chosen = values[OF_ONE_TYPE[name] :]
            if chosen and all(value.is_whole for value in chosen):
                low, high = min(value.low for value in chosen), max(value.high for value in chosen)
                low, high = (0, max(abs(low), abs(high))) if name == "ABS" else (low, high)
                types = [value.type for value in chosen if not value.loose]
                kind = reduce(lambda a, b: common_type(self._dialect, a, b), types) if types else ""
                return ElementaryValue(kind, low, high, loose=not types)
            return ElementaryValue(_mixed([value.type for value in chosen]))
        if name in ("SHL", "SHR", "ROL", "ROR") and values:
            return _of_type(values[0].type)
        return _of_type(self._type_of(node)) if self._type_of is not None else UNKNOWN


_ELEMENTARY = frozenset({*ORDER, *REALS, *_DURATIONS, *INSTANTS, "BOOL", "STRING", "WSTRING", "CHAR", "WCHAR"})


def _mixed(types: list[str]) -> str:
    """Return the type of a calculation with others than integers; empty where it is not known."""
    instants = [each for each in types if each in INSTANTS]
    if len(instants) > 1:
        return "TIME"
    for among in (instants, _DURATIONS[::-1], REALS[::-1]):
        found = next((each for each in among if each in types), "")
        if found:
            return found
    return types[0] if len(set(types)) == 1 else ""


def operand_type(dialect: Dialect, types: list[str], values: list[ElementaryValue]) -> str:
    """Return the type that operands are brought to; those of `values` that have no type take it where they fit."""
    types = types or [_least_type(value) for value in values]
    common = reduce(lambda a, b: common_type(dialect, a, b), types)
    for value in values:
        if value.loose and not fits(value, common):
            common = common_type(dialect, common, _least_type(value))
    return common


def _least_type(value: ElementaryValue) -> str:
    """Return the type of a number without one, where it does not fit its surroundings."""
    return next((each for each in ("SINT", "INT", "DINT", "LINT") if fits(value, each)), "ULINT")


def bounds(operator: Operator, left: tuple[int, int], right: tuple[int, int]) -> tuple[int, int]:
    """Return the least and the greatest integer that an operation with operands between such numbers can have."""
    if operator is Operator.ADD:
        return left[0] + right[0], left[1] + right[1]
    if operator is Operator.SUBTRACT:
        return left[0] - right[1], left[1] - right[0]
    if operator is Operator.MULTIPLY:
        products = [a * b for a in left for b in right]
        return min(products), max(products)
    if operator is Operator.MODULO:
        most = max(max(abs(right[0]), abs(right[1])) - 1, 0)
        return (0 if left[0] >= 0 else max(left[0], -most)), max(min(left[1], most), 0)
    least = min((abs(each) for each in right), default=1) if right[0] > 0 or right[1] < 0 else 1
    if right[0] > 0:
        return min(left[0] // least, 0) if left[0] >= 0 else -(-left[0] // least), max(left[1] // least, 0)
    most = max(abs(left[0]), abs(left[1])) // least
    return -most, most
