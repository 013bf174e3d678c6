"""SFCErrorAnalyzationTable in code: what keeps a step active for too long, as the rows of a table."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import string_literal
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, assignment, conjunction, when
from plcopen_sfc.lowering.code.program import BOOL, INT, Code
from plcopen_sfc.lowering.reading.source import ChartSource, Reason
from plcopen_sfc.lowering.texts import Texts
from plcopen_sfc.model.sfc import SfcFlag
from plcopen_sfc.model.types import (
    ArrayType,
    DataTypeDeclaration,
    DerivedType,
    Dimension,
    StringType,
    StructType,
    Variable,
)

_TYPE = "ExpressionResult"
_LAST = n.Literal("15")
_EMPTY = n.Literal("''")
_VARIABLE = SfcFlag.ERROR_ANALYZATION_TABLE.variable


class ErrorTable:
    """``ARRAY [0..15] OF ExpressionResult`` (CODESYS, library Analyzation: name, address, comment and value).

    The project gets the type where it has none of this name, so that the code needs no library. Address and comment
    stay empty, as in the simulator. Raises `LoweringError` where the POU declares the flag otherwise.
    """

    def __init__(self, source: ChartSource, code: Code, texts: Texts) -> None:
        self._dialect = source.dialect
        declared = next((v for v in source.pou.variables() if v.name.casefold() == _VARIABLE.casefold()), None)
        kind = ArrayType(dimensions=[Dimension(lower="0", upper="15")], base=DerivedType(name=_TYPE))
        if SfcFlag.ERROR_ANALYZATION_TABLE in source.undeclared_flags:
            code.declare_as(_VARIABLE, kind)
        elif declared is not None and not _is_table(declared):
            raise LoweringError(
                f"{_VARIABLE} is declared with another type than ARRAY [0..15] OF {_TYPE}",
                location=Location(path=source.pou.name),
            )
        if _TYPE.casefold() not in code.known_types:
            members = [Variable(name=name, type=StringType()) for name in ("name", "address", "comment")]
            members.append(Variable(name="value", type=BOOL))
            code.data_types.append(
                DataTypeDeclaration(
                    name=_TYPE, folder=source.pou.folder, place=source.pou.place, type=StructType(members=members)
                )
            )
        self._table = code.naming.local(_VARIABLE)
        self._row = code.declare(texts.table_row, INT)

    def filled(self, reasons: Iterable[Reason]) -> list[Statement]:
        """A row for each reason that stands, as far as there is place; all rows behind them are empty."""
        found: list[Statement] = [assignment(self._row, n.Literal("0"))]
        free = n.Operation(Operator.LESS_OR_EQUAL, (self._row, _LAST))
        for number, reason in enumerate(reasons):
            name = n.Literal(string_literal(reason.text, self._dialect))
            place = [free] if number > int(_LAST.text) else []
            found.append(when(conjunction([reason.stands, *place]), *self._written(name, reason.value)))
        return [*found, *self._rest()]

    def emptied(self) -> list[Statement]:
        """All rows are empty."""
        return [assignment(self._row, n.Literal("0")), *self._rest()]

    def _rest(self) -> Sequence[Statement]:
        free = n.Operation(Operator.LESS_OR_EQUAL, (self._row, _LAST))
        return [n.While(free, tuple(self._written(_EMPTY, value=False)))]

    def _written(self, name: Expression, value: bool) -> list[Statement]:
        row = n.Index(self._table, (self._row,))
        return [
            assignment(n.Member(row, n.Name("name")), name),
            assignment(n.Member(row, n.Name("value")), TRUE if value else FALSE),
            assignment(self._row, n.Operation(Operator.ADD, (self._row, n.Literal("1")))),
        ]


def _is_table(variable: Variable) -> bool:
    kind = variable.type
    base = kind.base if isinstance(kind, ArrayType) else None
    return isinstance(base, DerivedType) and base.name.casefold().rpartition(".")[2] == _TYPE.casefold()
