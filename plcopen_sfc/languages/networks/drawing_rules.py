"""Rules for drawing text as networks: how the tool draws, what names are, and what a text is for drawing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from plcopen_sfc.languages.effects import Path, is_variable, path_of
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Operator
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.languages.standard_blocks import StandardBlock, Tool, operator_block, standard_block
from plcopen_sfc.languages.words import needs_quotes
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, StringType, Variable


@dataclass(frozen=True)
class DrawingRules:
    """Rules by which networks are drawn.

    `dialect`: of the texts in their elements. `tool`: pins have its names instead of those of IEC 61131-3.
    `instances`: the types of function block instances by name, without which their calls cannot be drawn as blocks.
    `booleans`: which variables are of type BOOL, by name in lower case. In a ladder, one that is not there is taken as
    BOOL where it is in a logic operation. `operands`: variables that are called like instances but are of type
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
        """Return the paths of `operands` in calls."""
        return frozenset(map(self._path, self.operands))

    def _path(self, name: str) -> Path:
        return path_of(parse_expression(name, self.dialect).tree)


def declared_rules(
    variables: Iterable[Variable], dialect: Dialect = Dialect.IEC, tool: Tool | None = None
) -> DrawingRules:
    """Return the rules for texts whose names are those of `variables` (`Interface.variables`).

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
    """Return a variable of a block as texts name it."""
    if dialect is not Dialect.SCL:
        return name
    return f'#"{name}"' if needs_quotes(name) else f"#{name}"


_RISKY = frozenset({Operator.DIVIDE, Operator.MODULO, Operator.POWER})


def constant_of(expression: Expression) -> bool | None:
    """Return the value of TRUE and FALSE; None for what is neither."""
    text = n.bare(expression)
    if isinstance(text, n.Literal) and text.text.upper() in ("TRUE", "FALSE"):
        return text.text.upper() == "TRUE"
    return None


def is_boolean_result(expression: Expression) -> bool | None:
    """True if a value that is no variable is of type BOOL; None: unknown."""
    if isinstance(expression, n.Literal):
        return expression.text.upper().removeprefix("BOOL#") in ("TRUE", "FALSE")
    block = None
    if isinstance(expression, n.Operation | n.Unary):
        block = operator_block(expression.operator)
    elif isinstance(expression, n.Call):
        block = standard_block(expression.called)
        if block is None:
            return None
    known = {"BOOL": True, "ANY": None, "ANY_BIT": None, "ANY_ELEMENTARY": None}
    return known.get(block.result.type, False) if block is not None else None


def by_name(call: n.Call, *, outputs: bool = False) -> bool:
    """True if all its arguments have names, and so pins; are all inputs, or `outputs` that go to variables too."""
    return all(
        a.name is not None
        and a.value is not None
        and (not a.output or (outputs and not a.negated and is_variable(a.value)))
        for a in call.arguments
    )


def is_power(block: StandardBlock, name: str) -> bool:
    """True if an input is of type BOOL."""
    iec = block.input_name(name)
    return any(pin.name == iec and pin.type == "BOOL" for pin in block.inputs)


def is_harmless(expression: Expression) -> bool:
    """True if its operands may be evaluated though their operation is not enabled: none can fail or do anything."""
    inner = n.bare(expression)
    operands: Sequence[n.Node] = (inner,)
    if isinstance(inner, n.Operation):
        operands = inner.operands
    elif isinstance(inner, n.Call) and not is_variable(inner):
        operands = inner.arguments
    return not any(
        isinstance(node, n.Call | n.Index | n.Dereference | n.EmbeddedCode | n.Unreadable | n.AssignmentExpression)
        or (isinstance(node, n.Operation) and node.operator in _RISKY)
        for operand in operands
        for node in walk(operand)
    )
