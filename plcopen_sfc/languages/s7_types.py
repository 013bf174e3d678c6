"""Data types as S7 has them: structures only. Other declared types become the type that they are made of.

A variable of an enumeration is one of its base type, usually Int, and the values of the enumeration are user constants
``"Type_value"``. A subrange is its base type, without the check of its bounds; another name for a type is this type.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from plcopen_sfc.model import types as t
from plcopen_sfc.model.project import Project, TagTable
from plcopen_sfc.whole_numbers import whole_number

NO_START = "parameters of functions and temporary variables have no start value in S7"
"""Why an initial value is not written."""
_INT = t.ElementaryType(name=t.Elementary.INT)
_NUMBER = re.compile(r"(?:\w+#)?([-+]?\d[\d_]*)|(?:\w+#)?(2|8|16)#([\dA-Fa-f_]+)")
_DEEPEST = 32
_OF_S5 = {"TIMER": t.Elementary.BOOL, "COUNTER": t.Elementary.INT, "S5TIME": t.Elementary.TIME}
"""The types of S5 by what programs read of them: the output of a timer, the count of a counter."""


def is_operand_of_s5(kind: t.DataType | None) -> bool:
    """True for the types of timers and counters of S5, which are no memory of a block."""
    return isinstance(kind, t.DerivedType) and kind.name.strip('"').upper() in ("TIMER", "COUNTER")


def plain_type(kind: t.DataType) -> t.DataType:
    """Return a type with those of other tools in the place of those of S5; the same object where it has none."""
    if isinstance(kind, t.ArrayType):
        base = plain_type(kind.base)
        return kind if base is kind.base else kind.model_copy(update={"base": base})
    found = _OF_S5.get(kind.name.strip('"').upper()) if isinstance(kind, t.DerivedType) else None
    return t.ElementaryType(name=found) if found is not None else kind


@dataclass(frozen=True, slots=True)
class Constant:
    """A value of an enumeration: its type, its name there, the name of the user constant, and its number."""

    type: str
    value: str
    name: str
    number: int


class S7Types:
    """The types of a project as S7 has them.

    `values`: texts in the place of constants that declarations name, by their names in lower case.
    """

    def __init__(self, declarations: Iterable[t.DataTypeDeclaration], values: Mapping[str, str] | None = None) -> None:
        self._values = values or {}
        self._declarations = {each.name.casefold(): each for each in declarations}
        self.declared = {name: self._with_members(each.type) for name, each in self._declarations.items()}
        self.constants = [each for declaration in self._declarations.values() for each in constants_of(declaration)]
        self._by_name = {each.name.casefold(): each for each in self.constants}
        self._by_value = {f"{each.type}.{each.value}".casefold(): each for each in self.constants}
        counts = Counter(each.value.casefold() for each in self.constants)
        self._alone = {each.value.casefold(): each for each in self.constants if counts[each.value.casefold()] == 1}

    def _with_members(self, type_: t.DataType) -> t.DataType:
        """Return a declared type, whose members have the types that S7 has for them."""
        if isinstance(type_, t.ArrayType):
            base = self._with_members(type_.base)
            return type_ if base is type_.base else type_.model_copy(update={"base": base})
        if not isinstance(type_, t.StructType):
            return type_
        types = [self._with_members(self.type(member.type)) for member in type_.members]
        if all(new is member.type for new, member in zip(types, type_.members, strict=True)):
            return type_
        pairs = zip(types, type_.members, strict=True)
        return type_.model_copy(update={"members": [m.model_copy(update={"type": new}) for new, m in pairs]})

    def type(self, type_: t.DataType) -> t.DataType:
        """Return the type that S7 has for `type_`: itself, if it is one of S7."""
        return self._type(type_, 0)

    def _type(self, type_: t.DataType, depth: int) -> t.DataType:
        if isinstance(type_, t.EnumType):
            return self._type(type_.base, depth + 1) if type_.base is not None else _INT
        if isinstance(type_, t.SubrangeType):
            return self._type(type_.base, depth + 1)
        if isinstance(type_, t.ArrayType):
            base, bounds = self._type(type_.base, depth + 1), [self._bound(each) for each in type_.dimensions]
            if base is type_.base and bounds == type_.dimensions:
                return type_
            return type_.model_copy(update={"base": base, "dimensions": bounds})
        if isinstance(type_, t.StringType) and type_.length is not None:
            length = self._value(type_.length)
            return type_ if length == type_.length else type_.model_copy(update={"length": length})
        if isinstance(type_, t.DerivedType) and depth < _DEEPEST:
            declared = self._declarations.get(type_.name.casefold())
            if declared is not None and not isinstance(declared.type, t.StructType):
                return self._type(declared.type, depth + 1)
        return type_

    def _bound(self, bound: t.Dimension) -> t.Dimension:
        """Return the bounds of an array with the values of constants."""
        lower, upper = self._value(bound.lower), self._value(bound.upper)
        if (lower, upper) == (bound.lower, bound.upper):
            return bound
        return bound.model_copy(update={"lower": lower, "upper": upper})

    def _value(self, text: str) -> str:
        """Return the value of the constant that a text names; any other text as it is."""
        return self._values.get(text.strip().strip('"').casefold(), text) if self._values else text

    def bounds(self, type_: t.DataType) -> t.Dimension | None:
        """Return the bounds of a subrange or of elements in one, which S7 does not have; None for other types."""
        for _ in range(_DEEPEST):
            declared = self._declarations.get(type_.name.casefold()) if isinstance(type_, t.DerivedType) else None
            inner = type_.base if isinstance(type_, t.ArrayType) else declared.type if declared is not None else None
            if inner is None:
                break
            type_ = inner
        return type_.bounds if isinstance(type_, t.SubrangeType) else None

    def start(self, variable: t.Variable) -> t.Value | None:
        """Return the start value of a variable as S7 writes it; that of its type, where it has none of its own."""
        if variable.initial is not None:
            return self._number(variable.initial)
        return self._start_of(variable.type, 0)

    def _start_of(self, type_: t.DataType, depth: int) -> t.Value | None:
        if isinstance(type_, t.DerivedType) and depth < _DEEPEST:
            declared = self._declarations.get(type_.name.casefold())
            if declared is None or isinstance(declared.type, t.StructType):
                return None
            if declared.initial is not None:
                return self._number(declared.initial, declared.name)
            if isinstance(declared.type, t.EnumType):
                first = next((each for each in self.constants if each.type == declared.name), None)
                return t.SimpleValue(text=str(first.number)) if first is not None and first.number else None
            return self._start_of(declared.type, depth + 1)
        if isinstance(type_, t.SubrangeType) and number_of(type_.bounds.lower) != 0:
            return t.SimpleValue(text=type_.bounds.lower)
        if isinstance(type_, t.ArrayType):
            element, count = self._start_of(type_.base, depth + 1), _elements(type_)
            if element is not None and count is not None:
                return t.ArrayValue(items=[t.RepeatedValue(value=element, repetitions=str(count))])
        return None

    def _number(self, value: t.Value, type_: str = "") -> t.Value:
        """Return a value with numbers for the values of enumerations and constants."""
        if isinstance(value, t.ArrayValue):
            items = [item.model_copy(update={"value": self._number(item.value, type_)}) for item in value.items]
            return value if items == value.items else value.model_copy(update={"items": items})
        if isinstance(value, t.StructValue):
            members = [each.model_copy(update={"value": self._number(each.value)}) for each in value.members]
            return value if members == value.members else value.model_copy(update={"members": members})
        if not isinstance(value, t.SimpleValue) or value.text is None:
            return value
        found = self.constant(value.text, type_)
        text = self._value(value.text) if found is None else str(found.number)
        return value if text == value.text else t.SimpleValue(text=text)

    def constant(self, text: str, type_: str = "") -> Constant | None:
        """The value of an enumeration that a text names: ``"Type_value"``, ``Type.value``, ``Type#value`` or ``value``.

        `type_` is the type that a value without one has.
        """
        key = text.strip().replace("#", ".").strip('".').replace('"', "").casefold()
        return (
            self._by_name.get(key)
            or self._by_value.get(key)
            or self._by_value.get(f"{type_}.{key}".casefold())
            or self._alone.get(key)
        )

    def named(self, name: str) -> Constant | None:
        """Return the value of an enumeration that the user constant `name` has."""
        return self._by_name.get(name.casefold())

    def alone(self, name: str) -> Constant | None:
        """Return the value that programs can name without its type: no other type has one of this name."""
        return self._alone.get(name.casefold())

    def tables(self) -> list[TagTable]:
        """Return a tag table with the user constants of each enumeration."""
        tables: dict[str, TagTable] = {}
        for each in self.constants:
            table = tables.setdefault(each.type, TagTable(name=each.type))
            kind = self.type(t.DerivedType(name=each.type))
            initial = t.SimpleValue(text=str(each.number))
            table.constants.append(t.Variable(name=each.name, type=kind, initial=initial))
        return list(tables.values())


def is_system_data(variable: t.Variable) -> bool:
    """True for what TIA Portal declares in a block of S7-GRAPH: its run-time data, its steps and transitions."""
    return isinstance(variable.type, t.DerivedType) and variable.type.name.strip('"').upper().startswith("G7_")


def constants_of(declaration: t.DataTypeDeclaration) -> list[Constant]:
    """Return the values of an enumeration with their numbers; none for one whose numbers are not known."""
    if not isinstance(declaration.type, t.EnumType):
        return []
    found: list[Constant] = []
    following = 0
    for each in declaration.type.values:
        number = following if each.value is None else number_of(each.value)
        if number is None:
            return []
        found.append(Constant(declaration.name, each.name, f"{declaration.name}_{each.name}", number))
        following = number + 1
    return found


def _elements(type_: t.ArrayType) -> int | None:
    """Return how many elements an array has; None where its bounds are no numbers."""
    count = 1
    for dimension in type_.dimensions:
        lower, upper = number_of(dimension.lower), number_of(dimension.upper)
        if lower is None or upper is None:
            return None
        count *= upper - lower + 1
    return count


_LONGEST = 400
"""Characters of a number; Python converts no more than 4300 digits."""


def number_of(text: str) -> int | None:
    """Return the number that a literal is; None for anything else."""
    found = _NUMBER.fullmatch(text.strip())
    if found is None or len(text) > _LONGEST:
        return None
    return int(found[1].replace("_", "")) if found[1] else int(found[3].replace("_", ""), int(found[2]))


def s7_types(project: Project, values: Mapping[str, str] | None = None) -> S7Types:
    """Return the types of `project` as S7 has them. `values`: those of constants that nothing declares for the tool."""
    return S7Types(project.data_types, values)


_LONGEST_TEXTS = {False: 254, True: 16382}


def is_too_long(type_: t.DataType) -> bool:
    """True for strings longer than S7 has: 254 characters, of WSTRING 16382 (TIA Portal help, "STRING", "WSTRING")."""
    type_ = t.element_type(type_)
    length = whole_number(type_.length or "") if isinstance(type_, t.StringType) else None
    return isinstance(type_, t.StringType) and length is not None and length > _LONGEST_TEXTS[type_.wide]
