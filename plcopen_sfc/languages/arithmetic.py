"""The types in which tools calculate with integers and bit strings.

IEC 61131-3, 7.3.2, gives the result of an operation the type of its operands, and leaves open what is done with several
types. Evidence: help of CODESYS and TwinCAT 3, "Operators", overflow in the data type; help of TIA Portal, "Arithmetic
expressions" of SCL; for the order of types of other tools a guess.
"""

from __future__ import annotations

from plcopen_sfc.languages.dialects import Dialect

__all__ = ["NATIVE", "ORDER", "UNSIGNED", "bits_of", "calculated_type", "common_type"]

ORDER = ("SINT", "USINT", "BYTE", "INT", "UINT", "WORD", "DINT", "UDINT", "DWORD", "LINT", "ULINT", "LWORD")
"""Integers and bit strings, from the narrowest to the widest: of two types the later one is that of their sum."""
UNSIGNED = frozenset({"USINT", "UINT", "UDINT", "ULINT"})
_SIGNED = ("SINT", "INT", "DINT", "LINT")
NATIVE = "DINT"
"""The least type in which CODESYS calculates: that of 32-bit hardware. On 64-bit hardware it is LINT."""


def bits_of(name: str) -> int:
    """The width of an integer or bit string."""
    return 8 << ORDER.index(name) // 3


def common_type(dialect: Dialect, one: str, other: str) -> str:
    """The type that two operands are brought to.

    S7 takes a signed type that holds the values of both where one of them is signed and the other is not.
    """
    if dialect is Dialect.SCL and (one in UNSIGNED) is not (other in UNSIGNED) and {one, other} <= _NUMBERS:
        unsigned = one if one in UNSIGNED else other
        signed = other if one in UNSIGNED else one
        holding = _SIGNED[min(ORDER.index(unsigned) // 3 + 1, len(_SIGNED) - 1)]
        return max(signed, holding, key=ORDER.index)
    return max(one, other, key=ORDER.index)


def calculated_type(dialect: Dialect, name: str) -> str:
    """The type in which operands of type `name` are added, subtracted, multiplied, divided and negated.

    CODESYS and TwinCAT calculate with the width of the processor and cut off only what is assigned or converted.
    """
    if dialect in (Dialect.CODESYS, Dialect.TWINCAT) and bits_of(name) < bits_of(NATIVE):
        return NATIVE
    return name


_NUMBERS = UNSIGNED | set(_SIGNED)
