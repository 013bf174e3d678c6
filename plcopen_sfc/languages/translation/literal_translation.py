"""Literals of one dialect in another."""

from __future__ import annotations

import re
from datetime import date, timedelta

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st.literals import (
    SHORT_TYPES,
    TIME_RANGES,
    LiteralError,
    LiteralKind,
    LiteralValue,
    literal_value,
    time_literal,
)
from plcopen_sfc.languages.translation.translation_context import TITLES, PartText

_SHORT = {"BYTE": "B", "WORD": "W", "DWORD": "DW"}
_LACKING = {
    Dialect.IEC: {"DTL": "a structure of S7", "COUNTER": "a count of S7"},
    Dialect.CODESYS: {
        "DTL": "a structure of S7",
        "COUNTER": "a count of S7",
        "CHAR": "characters are strings there",
        "WCHAR": "characters are strings there",
    },
    Dialect.SCL: {"LDATE": "its long dates are part of LDT"},
}


def translated_literal(text: str, source: Dialect, target: Dialect) -> PartText:
    """A literal of `source` in `target`, both families (see `families`). How it is written stays where it can.

    Enumerated values (``Color#red``) are not for here: in CODESYS they are no literals.
    """
    try:
        literal = literal_value(text, source)
    except LiteralError as error:
        return PartText(text, Severity.ERROR, f"{error.message}; left as it stands")
    prefix, mark, body = text.partition("#")
    why = _LACKING[target].get(literal.type)
    if why is not None and source is not target:
        return PartText(text, Severity.ERROR, f"{TITLES[target]} has no literals of the type {literal.type}: {why}")
    match literal.kind:
        case LiteralKind.INTEGER if mark:
            short = source is Dialect.SCL and prefix.upper() in SHORT_TYPES
            return PartText(_integer(text, body, literal.type, target, short=short))
        case LiteralKind.STRING:
            return PartText(_string(text, literal, target))
        case LiteralKind.DURATION if isinstance(literal.value, int):
            return _duration(text, literal.value, literal.type, target)
        case LiteralKind.DATE | LiteralKind.DATE_AND_TIME if not _is_in_calendar(literal, target):
            first, last = _CALENDARS[target][literal.type]
            reason = f"{text}: {TITLES[target]} has {literal.type} from {first} to {last} only"
            return PartText(text, Severity.ERROR, f"{reason}; left as it stands")
        case LiteralKind.DATE if prefix.upper() == "LD" and target is Dialect.CODESYS:
            return PartText(f"LDATE#{body}")
        case LiteralKind.POINTER:
            return PartText(text, Severity.ERROR, f"{text} is a pointer of S7, {TITLES[target]} has none")
        case LiteralKind.NULL if target is Dialect.CODESYS:
            return PartText(text, Severity.ERROR, "CODESYS has no NULL: its pointers and references compare with 0")
        case _:
            return PartText(text)


_CALENDARS = {
    Dialect.SCL: {"DATE": (1990, 2168), "DT": (1990, 2089), "LDT": (1970, 2262)},
    Dialect.CODESYS: {"DATE": (1970, 2106), "DT": (1970, 2106)},
}
"""The first and the last year of dates. Evidence: help of TIA Portal and of CODESYS, data types."""
_NANOSECONDS_OF_A_DAY = 86_400_000_000_000


def _is_in_calendar(literal: LiteralValue, target: Dialect) -> bool:
    """True if the target has the year of a date."""
    least, greatest = _CALENDARS.get(target, {}).get(literal.type, (1, 9999))
    day = literal.value if isinstance(literal.value, date) else None
    if isinstance(literal.value, int):
        day = date(1970, 1, 1) + timedelta(days=literal.value // _NANOSECONDS_OF_A_DAY)
    return day is None or least <= day.year <= greatest


def _integer(text: str, body: str, type: str, target: Dialect, *, short: bool) -> str:
    if target is Dialect.SCL:
        return f"{_SHORT[type]}#{body}" if type in _SHORT and body.startswith("16#") else text
    return f"{type}#{body}" if short else text


def _string(text: str, literal: LiteralValue, target: Dialect) -> str:
    quoted = text[text.index("#") + 1 :] if text[0] not in ("'", '"') else text
    typed = text[: len(text) - len(quoted)]
    if not literal.type.startswith("W"):
        return quoted if target is Dialect.CODESYS else text
    if target is Dialect.SCL:
        return f"{typed or 'WSTRING#'}{_requoted(quoted, chr(39))}"
    return (typed if literal.type == "WCHAR" else "") + _requoted(quoted, '"')


def _requoted(text: str, quote: str) -> str:
    """A string in other quotes; of its escapes only those of quotes change."""
    if text[0] == quote:
        return text
    inner = re.sub(rf"\$([\s\S])|{quote}", lambda found: _requoted_part(found, text[0], quote), text[1:-1])
    return f"{quote}{inner}{quote}"


def _requoted_part(found: re.Match[str], old: str, quote: str) -> str:
    if found[0] == quote:
        return f"${quote}"
    return old if found[1] == old else found[0]


def _duration(text: str, nanoseconds: int, type: str, target: Dialect) -> PartText:
    body = text.partition("#")[2]
    if type == "S5TIME" and target is not Dialect.SCL:
        return PartText(f"T#{body}", Severity.WARNING, f"{text} is a S5TIME, it became a TIME, which counts finer")
    if target is Dialect.IEC:
        return PartText(text)
    fine = "." in body or (type != "LTIME" and re.search("us|ns", body, re.IGNORECASE))
    least, greatest = TIME_RANGES.get((target, type), (nanoseconds, nanoseconds))
    if fine or _overflows(body) or not least <= nanoseconds <= greatest:
        try:
            return PartText(time_literal(nanoseconds, target, type))
        except LiteralError as error:
            return PartText(text, Severity.ERROR, f"{text}: {error.message}; left as it stands")
    if target is Dialect.CODESYS and text[:3].upper() == "LT#":
        return PartText(f"LTIME#{body}")
    return PartText(text)


def _overflows(body: str) -> bool:
    """Whether a unit behind the first has more than fits the one before it, as in ``5m68s``: CODESYS refuses that."""
    parts = re.findall(r"(\d+)([a-z]+)", body.replace("_", "").lower())
    return any(int(count) >= _FULL.get(unit, 1000) for count, unit in parts[1:])


_FULL = {"h": 24, "m": 60, "s": 60}
