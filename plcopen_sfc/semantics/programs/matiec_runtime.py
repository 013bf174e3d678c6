"""Standard functions as the library of matiec has them where IEC 61131-3 and other tools have them otherwise.

Seen in its C library of 2024 and in compiled programs.
"""

from __future__ import annotations

import ctypes
import re
from typing import Any

from plcopen_sfc.semantics.programs import function_runtime
from plcopen_sfc.semantics.programs.runtime_types import Family, ScalarType

LONGEST_STRING = 126
"""Characters of every STRING (``STR_MAX_LEN``)."""
_SECOND = 1_000_000_000
_DIGITS = 20


def find(text: str, part: str) -> int:
    """FIND, which goes on behind a part that matched in part only: 'lo' is not found in 'hello'."""
    start = same = 0
    if not part or len(part) > len(text):
        return 0
    while start + same < len(text) and same < len(part):
        if text[start + same] != part[same]:
            start += same + 1
            same = 0
        else:
            same += 1
    return start + 1 if same == len(part) else 0


def replace(text: str, by: str, count: int, position: int) -> str:
    """REPLACE, which puts in at most as many characters as it takes out."""
    return function_runtime.replace(text, by[: max(count, 0)], count, position)


def to_text(value: Any, type_: ScalarType) -> str:
    """Return a value as a string: bit strings in hexadecimal digits, real numbers with ten digits, times with units."""
    if type_.family is Family.BITS:
        return f"16#{value:x}"
    if type_.family is Family.REAL:
        return f"{value:.10g}"
    if type_.family is Family.DURATION:
        return _duration(value)
    return function_runtime.to_text(value, type_)


def _duration(value: int) -> str:
    sign = -1 if value < 0 else 1
    seconds, fraction = divmod(abs(value), _SECOND)
    minutes, second = divmod(seconds, 60)
    hours, minute = divmod(minutes, 60)
    day, hour = divmod(hours, 24)
    parts = [(day, "d"), (hour, "h"), (minute, "m"), (second, "s")]
    if not fraction:
        while len(parts) > 1 and parts[-1][0] == 0:
            parts.pop()
    milliseconds = f"{sign * fraction / 1_000_000:g}ms" if fraction else ""
    return "T#" + "".join(f"{sign * number}{unit}" for number, unit in parts) + milliseconds


def of_text(text: str, type_: ScalarType) -> Any:
    """Return the number in a string: of what is no digit only the last digits before it, if any, count."""
    if type_.family is Family.BOOL:
        return text == "1" or text.upper() == "TRUE"
    if type_.family is Family.REAL:
        value = _real(text)
        return ctypes.c_float(value).value if type_.bits == 32 else value
    if type_.family is Family.DURATION:
        return int(_real(text)) * _SECOND
    if type_.family not in (Family.INTEGER, Family.BITS):
        return function_runtime.of_text(text, type_)
    span = type_.greatest - type_.least + 1
    return (_whole(text) - type_.least) % span + type_.least


def _real(text: str) -> float:
    if "." not in text[1:]:
        return float(_whole(text))
    found = re.match(r"\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?", text)
    return float(found[0]) if found is not None else 0.0


def _whole(text: str) -> int:
    for prefix, digits, base in (("2#", "[01]", 2), ("8#", "[0-7]", 8), ("16#", "[0-9a-fA-F]", 16)):
        if text.startswith(prefix):
            return int("".join(re.findall(digits, text[len(prefix) :])) or "0", base)
    number, place = 0, 1
    for character in reversed(text):
        if character.isdigit() and place < 10**_DIGITS:
            number, place = number + int(character) * place, place * 10
        elif character >= ".":
            number, place = 0, 1
    return -number if text.startswith("-") else number
