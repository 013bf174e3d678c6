"""Types and initial values as matiec takes them in declarations."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from plcopen_sfc.languages.declarations.kept import kept
from plcopen_sfc.model.types import (
    ArrayType,
    ArrayValue,
    DataType,
    DataTypeDeclaration,
    DerivedType,
    Elementary,
    ElementaryType,
    EnumType,
    PointerType,
    SimpleValue,
    StringType,
    StructType,
    StructValue,
    Value,
    Variable,
)
from plcopen_sfc.model.variables import VariableSection
from plcopen_sfc.report import ConversionReport, Outcome

_UNKNOWN = frozenset({"LTIME", "LDATE", "LTOD", "LDT", "CHAR", "WCHAR"})
_REALS = frozenset({Elementary.REAL, Elementary.LREAL})
_WHOLE = re.compile(r"[+-]?\d[\d_]*")


class TypeFitter:
    """Changes types and values of variables; what matiec has not is reported. `declared` are the data types by name."""

    def __init__(self, declared: Iterable[DataTypeDeclaration], report: ConversionReport) -> None:
        self._declared = {one.name.casefold(): one.type for one in declared}
        self._report = report

    def declaration(self, one: DataTypeDeclaration) -> None:
        """Fit a data type."""
        path = f"type {one.name}"
        for word in ("extends", "union"):
            if word in kept(one.carried) or word in kept(getattr(one.type, "carried", None)):
                self._lost("type", path, f"matiec has no {word.upper()}")
        if isinstance(one.type, EnumType):
            numbers = [value.value for value in one.type.values]
            if any(number is not None and number.strip() != str(index) for index, number in enumerate(numbers)):
                self._lost("enumeration", f"data type {one.name}", "matiec numbers enumerations from 0")
            for value in one.type.values:
                value.value = None
            one.type.base = None
        one.declaration = None
        one.type = self._type(one.type, path, {})
        one.initial = self._value(one.type, one.initial, path)

    def sections(self, sections: Iterable[VariableSection], path: str, known: Mapping[str, str]) -> dict[str, str]:
        """Fit variables; returns the values of constants, with those that are `known`, by names in lower case."""
        sections = list(sections)
        constants = {**known, **_constants(sections)}
        for section in sections:
            for variable in section.variables:
                place = f"{path} / variable {variable.name}" if path else f"variable {variable.name}"
                self._variable(variable, place, constants)
        return constants

    def _variable(self, variable: Variable, path: str, constants: Mapping[str, str]) -> None:
        variable.type = self._type(variable.type, path, constants)
        variable.initial = self._value(variable.type, variable.initial, path)

    def _type(self, kind: DataType, path: str, constants: Mapping[str, str]) -> DataType:
        """A type without strings of a length, whose variables matiec does not find, and with numbers for limits."""
        if isinstance(kind, ArrayType):
            if isinstance(kind.base, ArrayType):
                self._lost("type", path, "matiec has no arrays of arrays; write one of two dimensions")
            for dimension in kind.dimensions:
                dimension.lower, dimension.upper = (
                    self._limit(text, path, constants) for text in (dimension.lower, dimension.upper)
                )
            kind.base = self._type(kind.base, path, constants)
        elif isinstance(kind, ElementaryType) and kind.name.value in _UNKNOWN:
            self._lost("type", path, f"matiec has no {kind.name.value}")
        elif isinstance(kind, StringType) and kind.wide:
            self._lost("type", path, "matiec has no WSTRING")
        elif isinstance(kind, PointerType) and not kind.reference:
            self._lost("type", path, "matiec has no pointers")
        elif isinstance(kind, StructType):
            for member in kind.members:
                self._variable(member, f"{path} / {member.name}", constants)
        elif isinstance(kind, StringType) and kind.length is not None:
            self._report.add(Outcome.APPROXIMATED, "string", path, "matiec has strings of its own length")
            return StringType(wide=kind.wide)
        return kind

    def _limit(self, text: str, path: str, constants: Mapping[str, str]) -> str:
        number = constants.get(text.strip().rpartition(".")[2].casefold(), text.strip())
        if _WHOLE.fullmatch(number) is None:
            self._lost("type", path, f"matiec takes numbers as limits of arrays, not {text}")
        return number

    def _value(self, kind: DataType, value: Value | None, path: str) -> Value | None:
        """An initial value; None for one that matiec does not take."""
        kind = self._plain(kind)
        wrong = ""
        if isinstance(kind, ElementaryType) and isinstance(value, ArrayValue | StructValue):
            wrong = "a list is no value of an elementary type"
        elif isinstance(value, ArrayValue) and any(isinstance(item.value, StructValue) for item in value.items):
            wrong = "matiec has no values of structures in values of arrays"
        if wrong:
            self._lost("initial value", path, wrong)
            return None
        if isinstance(value, SimpleValue) and isinstance(kind, ElementaryType) and kind.name in _REALS:
            is_whole = value.text is not None and _WHOLE.fullmatch(value.text.strip()) is not None
            return SimpleValue(text=f"{value.text}.0") if is_whole else value
        if isinstance(value, ArrayValue) and isinstance(kind, ArrayType):
            for item in value.items:
                item.value = self._value(kind.base, item.value, path) or item.value
        if isinstance(value, StructValue) and isinstance(kind, StructType):
            types = {member.name.casefold(): member.type for member in kind.members}
            for one in value.members:
                if one.member.casefold() in types:
                    one.value = self._value(types[one.member.casefold()], one.value, path) or one.value
        return value

    def _plain(self, kind: DataType) -> DataType:
        """The type that a name stands for."""
        for _ in self._declared:
            found = self._declared.get(kind.name.casefold()) if isinstance(kind, DerivedType) else None
            if found is None:
                break
            kind = found
        return kind

    def _lost(self, what: str, path: str, why: str) -> None:
        self._report.add(Outcome.NOT_EXECUTED, what, path, why)


def _constants(sections: Iterable[VariableSection]) -> dict[str, str]:
    constants = [variable for section in sections if section.constant for variable in section.variables]
    texts = {one.name.casefold(): one.initial.text for one in constants if isinstance(one.initial, SimpleValue)}
    return {name: text.strip() for name, text in texts.items() if text is not None and _WHOLE.fullmatch(text.strip())}
