"""Facts of a project about the names in conditions: types, constants, values of enumerations."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from plcopen_sfc.languages.binding.name_resolution import Resolver
from plcopen_sfc.languages.binding.name_uses import dialect_of
from plcopen_sfc.languages.binding.symbols import inside
from plcopen_sfc.languages.binding.text_sites import Site
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.literals import INTEGER_RANGES, TIME_RANGES, LiteralKind, LiteralValue, known_literal
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.model import types as t
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.programs.runtime_types import elementary


class ValueKind(StrEnum):
    """Kind of the values of a variable in comparisons. Times and dates are integers; see `LiteralKind`."""

    BOOL = "BOOL"
    INTEGER = "integer"
    REAL = "real"
    DURATION = "duration"
    DATE = "date"
    TIME_OF_DAY = "time of day"
    DATE_AND_TIME = "date and time"
    SYMBOL = "symbol"
    TEXT = "text"


@dataclass(frozen=True, slots=True)
class VariableValues:
    """The values that a variable can have: its kind, and for numbers the least and the greatest value where known.

    `symbols` are all values of an enumeration, as `LiteralValue.value` has them. `unit` is what durations and times are
    multiples of, in nanoseconds.
    """

    kind: ValueKind
    least: int | None = None
    greatest: int | None = None
    symbols: tuple[str, ...] = ()
    unit: int = 1


Knowledge = Callable[[Expression], VariableValues | LiteralValue | None]
"""Knowledge of a name in a condition: the values it can have, its constant value, or nothing."""


KIND_OF_LITERAL = {
    LiteralKind.BOOL: ValueKind.BOOL,
    LiteralKind.INTEGER: ValueKind.INTEGER,
    LiteralKind.REAL: ValueKind.REAL,
    LiteralKind.DURATION: ValueKind.DURATION,
    LiteralKind.DATE: ValueKind.DATE,
    LiteralKind.TIME_OF_DAY: ValueKind.TIME_OF_DAY,
    LiteralKind.DATE_AND_TIME: ValueKind.DATE_AND_TIME,
    LiteralKind.STRING: ValueKind.TEXT,
    LiteralKind.ENUMERATED: ValueKind.SYMBOL,
}
KIND_OF_NUMBER = {"REAL": ValueKind.REAL, "LREAL": ValueKind.REAL, **dict.fromkeys(INTEGER_RANGES, ValueKind.INTEGER)}


def constant_of(tree: Expression, dialect: Dialect, knowledge: Knowledge | None) -> LiteralValue | None:
    """Return the value of a literal or of a constant; None for anything else."""
    tree = n.bare(tree)
    match tree:
        case n.Literal():
            return known_literal(tree, dialect)
        case n.Unary((n.Operator.NEGATE | n.Operator.PLUS) as sign, operand):
            inner = constant_of(operand, dialect, knowledge)
            if inner is None or not isinstance(inner.value, int | float):
                return None
            return LiteralValue(inner.kind, -inner.value if sign is n.Operator.NEGATE else inner.value, inner.type)
        case n.Name() | n.Member():
            known = knowledge(tree) if knowledge is not None else None
            return known if isinstance(known, LiteralValue) else None
    return None


_BOOLEAN_ADDRESS = re.compile(r"%[IQM](X?\d+(\.\d+)+|X\d+)", re.IGNORECASE)
_KINDS = {
    "BOOL": ValueKind.BOOL,
    "REAL": ValueKind.REAL,
    "LREAL": ValueKind.REAL,
    "TIME": ValueKind.DURATION,
    "LTIME": ValueKind.DURATION,
    "DATE": ValueKind.DATE,
    "LDATE": ValueKind.DATE,
    "TOD": ValueKind.TIME_OF_DAY,
    "LTOD": ValueKind.TIME_OF_DAY,
    "DT": ValueKind.DATE_AND_TIME,
    "LDT": ValueKind.DATE_AND_TIME,
}


class ProjectKnowledge:
    """Facts of a project about names, wherever they are in it. Edits of the project make it wrong."""

    def __init__(self, project: Project) -> None:
        self.resolver = Resolver(project, dialect_of(project))
        sections = [*project.global_sections(), *(s for p in project.pous if p.interface for s in p.interface.sections)]
        self.constants = {id(v) for section in sections if section.constant for v in section.variables}
        self.constants |= {id(constant) for table in project.tag_tables for constant in table.constants}
        enumerations = [type_ for declared in project.data_types for type_ in inside(declared.type)]
        self.distinct = {
            id(value)
            for type_ in enumerations
            if isinstance(type_, t.EnumType) and self._numbers_differ(type_)
            for value in type_.values
        }

    def at(self, pou: Pou | None = None, chart: SfcNetwork | None = None) -> Knowledge:
        """Return the knowledge about the names in conditions of `chart` in `pou`.

        Constants count with their value where it is a literal. A variable of an enumeration has one of its values; of
        one in which two names may have the same number nothing is known.
        """
        return _Known(self, pou, chart).of

    def _numbers_differ(self, type_: t.EnumType) -> bool:
        """Return True if all names of an enumeration have numbers of their own; one without takes the next one."""
        numbers: list[int] = []
        for value in type_.values:
            number: object = numbers[-1] + 1 if numbers else 0
            if value.value is not None:
                literal = known_literal(value.value, self.resolver.dialect)
                number = literal.value if literal is not None else None
            if not isinstance(number, int):
                return False
            numbers.append(number)
        return len(set(numbers)) == len(numbers)


def project_knowledge(project: Project, pou: Pou | None = None, chart: SfcNetwork | None = None) -> Knowledge:
    """`ProjectKnowledge.at`; for many charts of a project, make the `ProjectKnowledge` once."""
    return ProjectKnowledge(project).at(pou, chart)


class _Known:
    def __init__(self, project: ProjectKnowledge, pou: Pou | None, chart: SfcNetwork | None) -> None:
        self._resolver = project.resolver
        self._dialect = project.resolver.dialect
        self._constants = project.constants
        self._distinct = project.distinct
        charts = (chart,) if chart is not None else ()
        self._site = Site(pou, charts=charts, place=pou.place if pou is not None else "")
        self._found: dict[n.Expression, VariableValues | LiteralValue | None] = {}

    def of(self, tree: n.Expression) -> VariableValues | LiteralValue | None:
        """Return the values that a variable can have, the value of a constant, or None."""
        if tree not in self._found:
            self._found[tree] = self._look_up(tree)
        return self._found[tree]

    def _look_up(self, tree: n.Expression) -> VariableValues | LiteralValue | None:
        if isinstance(tree, n.Address):
            return VariableValues(ValueKind.BOOL) if _BOOLEAN_ADDRESS.fullmatch(tree.text) else None
        declaration = self._resolver.declaration_of(tree, self._site)
        if declaration is not None and declaration.kind is Kind.ENUM_VALUE:
            return self._enumerated(declaration)
        if declaration is not None and id(declaration.holder) in self._constants:
            value = self._constant(declaration)
            if value is not None:
                return value
        if declaration is None and not isinstance(tree, n.Index):
            return None
        type_ = self._resolver.type_of(tree, self._site)
        return self._domain(type_)

    def _constant(self, declaration: Declaration) -> LiteralValue | None:
        """Return the value of a constant where it is written as a literal."""
        holder = declaration.holder
        initial = holder.initial if isinstance(holder, t.Variable) else None
        if not isinstance(initial, t.SimpleValue) or not initial.text:
            return None
        return constant_of(parse_expression(initial.text, self._dialect).tree, self._dialect, None)

    def _enumerated(self, declaration: Declaration) -> LiteralValue | None:
        holder = declaration.holder
        if not isinstance(holder, t.EnumValue) or (holder.value is not None and id(holder) not in self._distinct):
            return None
        return LiteralValue(LiteralKind.ENUMERATED, holder.name, declaration.path.rpartition(".")[0])

    def _domain(self, type_: object) -> VariableValues | None:
        if isinstance(type_, t.ElementaryType):
            return self._elementary(type_.name.value)
        if isinstance(type_, t.StringType):
            return VariableValues(ValueKind.TEXT)
        if isinstance(type_, t.EnumType):
            if any(value.value is not None and id(value) not in self._distinct for value in type_.values):
                return None
            return VariableValues(ValueKind.SYMBOL, symbols=tuple(value.name for value in type_.values))
        if isinstance(type_, t.SubrangeType):
            bounds = [known_literal(each, self._dialect) for each in (type_.bounds.lower, type_.bounds.upper)]
            if None in bounds:
                return self._domain(type_.base)
            values = (bound.value for bound in bounds if bound is not None)
            least, greatest = (value if isinstance(value, int) else None for value in values)
            return VariableValues(ValueKind.INTEGER, least, greatest)
        return None

    def _elementary(self, name: str) -> VariableValues | None:
        if name in INTEGER_RANGES:
            return VariableValues(ValueKind.INTEGER, *INTEGER_RANGES[name])
        if name not in _KINDS:
            return None
        kind, type_ = _KINDS[name], elementary(name, self._dialect)
        unit = type_.unit if type_ is not None and kind is not ValueKind.DATE else 1  # of dates the formula counts days
        least, greatest = TIME_RANGES.get((self._dialect, name), (None, None))
        return VariableValues(kind, least, greatest, unit=unit)
