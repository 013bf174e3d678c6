"""What must be known to draw a text: how the tool does it, and what the names in it are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st.effects import Path, path_of
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.languages.words import needs_quotes
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, StringType, Variable


@dataclass(frozen=True)
class DrawingRules:
    """How networks are drawn.

    `dialect`: of the texts in their elements. `tool`: pins have its names instead of those of IEC 61131-3.
    `instances`: the types of function block instances by name, without which their calls cannot be drawn as blocks.
    `booleans`: which variables are of type BOOL, by name in lower case. In a ladder, one that is not there is taken as
    BOOL where it stands in a logic operation. `operands`: variables that are called like instances but are of type
    BOOL: flip-flops and edges of S7 keep their state in them; by name that block (``RS``, ``R_TRIG``).
    """

    dialect: Dialect = Dialect.IEC
    tool: Tool | None = None
    instances: Mapping[str, str] = field(default_factory=dict)
    booleans: Mapping[str, bool] = field(default_factory=dict)
    operands: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def block_types(self) -> Mapping[Path, str]:
        """The types of `instances` and `operands` by what they are called in calls."""
        return {self._path(name): kind for name, kind in (*self.instances.items(), *self.operands.items())}

    @cached_property
    def operand_paths(self) -> frozenset[Path]:
        """What `operands` are called in calls."""
        return frozenset(map(self._path, self.operands))

    def _path(self, name: str) -> Path:
        return path_of(parse_expression(name, self.dialect).tree)


def declared_rules(
    variables: Iterable[Variable], dialect: Dialect = Dialect.IEC, tool: Tool | None = None
) -> DrawingRules:
    """The rules for texts whose names are those of `variables` (`Interface.variables`).

    A variable of a derived type counts as an instance: a structure is not called.
    """
    instances: dict[str, str] = {}
    booleans: dict[str, bool] = {}
    for variable in variables:
        kind = variable.type
        if isinstance(kind, DerivedType):
            instances[variable.name] = kind.name
        elif isinstance(kind, ElementaryType | StringType):
            is_bool = isinstance(kind, ElementaryType) and kind.name is Elementary.BOOL
            booleans[_spelled(variable.name, dialect).lower()] = is_bool
    return DrawingRules(dialect, tool, instances, booleans)


def _spelled(name: str, dialect: Dialect) -> str:
    """A variable of a block as texts name it."""
    if dialect is not Dialect.SCL:
        return name
    return f'#"{name}"' if needs_quotes(name) else f"#{name}"
