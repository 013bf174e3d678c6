"""Standard functions of the dialects, and their names there.

The pins come from `plcopen_sfc.languages.standard_blocks`. Evidence for each row: docs/dialects.md.
"""

from __future__ import annotations

import re

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st.nodes import Operator
from plcopen_sfc.languages.standard_blocks import BlockKind, StandardBlock, standard_blocks

S7_TIMERS_AND_COUNTERS = frozenset({"TON", "TOF", "TP", "CTU", "CTD", "CTUD"})
"""What S7 calls on an instance data block by name: ``"DB".TON(..)``."""

LACKED_BY_SCL = frozenset(
    """LOG ATAN2 IS_VALID IS_VALID_BCD TO_BIG_ENDIAN TO_LITTLE_ENDIAN FROM_BIG_ENDIAN FROM_LITTLE_ENDIAN DAY_OF_WEEK
    CONCAT_DATE CONCAT_TOD CONCAT_LTOD CONCAT_DT CONCAT_LDT CONCAT_DATE_LTOD SUB_DATE_DATE SUB_LDATE_LDATE
    SUB_TOD_TOD SUB_LTOD_LTOD SUB_DT_DT SUB_LDT_LDT ADD_TOD_TIME ADD_LTOD_LTIME ADD_DT_TIME ADD_LDT_LTIME
    SUB_TOD_TIME SUB_LTOD_LTIME SUB_DT_TIME SUB_LDT_LTIME SR RS""".split()
)
LACKED_BY_CODESYS = frozenset(
    """ATAN2 IS_VALID IS_VALID_BCD TO_BIG_ENDIAN TO_LITTLE_ENDIAN FROM_BIG_ENDIAN FROM_LITTLE_ENDIAN DAY_OF_WEEK
    CONCAT_DATE CONCAT_TOD CONCAT_LTOD CONCAT_DT CONCAT_LDT CONCAT_DATE_TOD CONCAT_DATE_LTOD""".split()
)
ONLY_CODESYS = frozenset("ADR SIZEOF XSIZEOF BITADR INDEXOF INI TIME LTIME TEST_AND_SET".split())
"""Operators and functions of CODESYS that IEC 61131-3 and SCL do not have; so have all that begin with ``__``."""

_TIME_OPERATORS = {"ADD": Operator.ADD, "SUB": Operator.SUBTRACT, "MUL": Operator.MULTIPLY, "DIV": Operator.DIVIDE}
_TIME_FUNCTION = re.compile(r"(ADD|SUB|MUL|DIV)_(L?)(TIME|TOD|DT|DATE)(?:_L?(?:TIME|TOD|DT|DATE))?")


def operator_of(block: StandardBlock, target: Dialect) -> Operator | None:
    """The operator that `target` has in place of a function; None: it has the function, or has neither.

    SCL has no functional form of operators; neither SCL nor CODESYS has the functions for times, such as ``ADD_TIME``.
    """
    if target is Dialect.SCL and block.kind is BlockKind.OPERATOR:
        return block.operator
    found = _TIME_FUNCTION.fullmatch(block.name)
    if found is None or target is Dialect.IEC:
        return None
    lacked = LACKED_BY_SCL if target is Dialect.SCL else LACKED_BY_CODESYS
    return None if block.name in lacked else _TIME_OPERATORS[found[1]]


def is_lacking(name: str, target: Dialect) -> bool:
    """True if `target` is not known to have the standard function or block `name`."""
    return name in {Dialect.SCL: LACKED_BY_SCL, Dialect.CODESYS: LACKED_BY_CODESYS}.get(target, frozenset())


_TRUNCATION = re.compile(r"(?:(L?REAL)_)?TRUNC(?:_(S?INT|DINT|LINT|U\w+))?")


def translated_truncation(name: str, target: Dialect, real: str) -> str | None:
    """Return the name in `target` of a function that cuts off decimals; None: `name` is none, or it has none.

    ``REAL_TRUNC_DINT`` of IEC 61131-3 ed. 3 is ``TRUNC`` in SCL and CODESYS, ``REAL_TRUNC_INT`` is ``TRUNC_INT``.
    `real`: the type of the argument.
    """
    found = _TRUNCATION.fullmatch(name.upper())
    if found is None or name.upper() == "TRUNC":
        return None
    result = found[2]
    if target is Dialect.IEC:
        return f"{found[1] or real}_TRUNC_{result}"
    if target is Dialect.SCL:
        return "TRUNC" if result == "DINT" else f"TRUNC_{result}"
    return {"DINT": "TRUNC", "INT": "TRUNC_INT"}.get(result)


def block_of_type(type: str) -> StandardBlock | None:
    """The standard function block of an instance by its type; S7 tells types of times and counts behind the name."""
    name = re.sub(r"_(TIME|LTIME|U?[SDL]?INT)$", "", type.upper()).rpartition(".")[2].strip('"')
    return _BLOCKS.get(name)


_BLOCKS = {block.name: block for block in standard_blocks() if block.stateful}
