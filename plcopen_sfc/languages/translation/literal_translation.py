"""Literals of one dialect in another."""

from __future__ import annotations

import re
from datetime import date, timedelta

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.memory_addresses import INTERNATIONAL
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
from plcopen_sfc.model.dialect import COUNTING_BYTES, Dialect

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
    """Return a literal of `source` in `target`, both families (see `family`). How it is written stays where it can.

    Enumerated values (``Color#red``) are not for here: in CODESYS they are no literals.
    """
    try:
        literal = literal_value(text, source)
    except LiteralError as error:
        return PartText(text, Severity.ERROR, f"{error.message}; left unchanged")
    prefix, mark, body = text.partition("#")
    why = _LACKING[target].get(literal.type)
    if why is not None and source is not target:
        return PartText(text, Severity.ERROR, f"{TITLES[target]} has no literals of the type {literal.type}: {why}")
    match literal.kind:
        case LiteralKind.INTEGER if mark:
            short = source is Dialect.SCL and prefix.upper() in SHORT_TYPES
            return PartText(_integer(text, body, literal.type, target, short=short))
        case LiteralKind.STRING:
            return PartText(_string(_with_line_ends(text, source, target), literal, target))
        case LiteralKind.DURATION if isinstance(literal.value, int):
            return _duration(text, literal.value, literal.type, target)
        case LiteralKind.DATE | LiteralKind.DATE_AND_TIME if not _is_in_calendar(literal, target):
            first, last = _CALENDARS[target][literal.type]
            reason = f"{text}: {TITLES[target]} has {literal.type} from {first} to {last} only"
            return PartText(text, Severity.ERROR, f"{reason}; left unchanged")
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


def _with_line_ends(text: str, source: Dialect, target: Dialect) -> str:
    """Return a string with the line ends that it has in the source: $N is $R$L in S7, and $L in all others.

    S7-1200 manual, "Valid ASCII control characters"; IEC 61131-3, 6.3.3; TwinCAT 3: ``$N`` is ``$0A``.
    """
    if (source is Dialect.SCL) is (target is Dialect.SCL):
        return text
    end = "$R$L" if source is Dialect.SCL else "$L"
    return re.sub(r"\$([\s\S])", lambda found: end if found[1] in "Nn" else found[0], text)


def _string(text: str, literal: LiteralValue, target: Dialect) -> str:
    quoted = text[text.index("#") + 1 :] if text[0] not in ("'", '"') else text
    typed = text[: len(text) - len(quoted)]
    if not literal.type.startswith("W"):
        return quoted if target is Dialect.CODESYS else text
    if target is Dialect.SCL:
        return f"{typed or 'WSTRING#'}{_requoted(quoted, chr(39))}"
    return (typed if literal.type == "WCHAR" else "") + _requoted(quoted, '"')


def _requoted(text: str, quote: str) -> str:
    """Return a string in other quotes; of its escapes only those of quotes change."""
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
        exact = literal_value(f"T#{body}", Dialect.IEC).value == nanoseconds
        return PartText(f"T#{body}" if exact else time_literal(nanoseconds, target))
    if target is Dialect.IEC:
        return PartText(text)
    fine = "." in body or (type != "LTIME" and re.search("us|ns", body, re.IGNORECASE))
    least, greatest = TIME_RANGES.get((target, type), (nanoseconds, nanoseconds))
    if fine or _overflows(body) or not least <= nanoseconds <= greatest:
        try:
            return PartText(time_literal(nanoseconds, target, type))
        except LiteralError as error:
            return PartText(text, Severity.ERROR, f"{text}: {error.message}; left unchanged")
    if target is Dialect.CODESYS and text[:3].upper() == "LT#":
        return PartText(f"LTIME#{body}")
    return PartText(text)


def _overflows(body: str) -> bool:
    """True if a unit behind the first has more than fits the one before it, as in ``5m68s``: CODESYS refuses that."""
    parts = re.findall(r"(\d+)([a-z]+)", body.replace("_", "").lower())
    return any(int(count) >= _FULL.get(unit, 1000) for count, unit in parts[1:])


_FULL = {"h": 24, "m": 60, "s": 60}


_ADDRESS = re.compile(r"%([IQMEA])([XBWDL]?)(\d{1,9}(?:\.\d{1,9})*)", re.IGNORECASE)
_BYTES = {"W": 2, "D": 4, "L": 8}
_WORDS = {2: "word", 4: "double word", 8: "long word"}
_COUNTING = "the same bytes: S7 counts bytes, other tools count words or double words; S7 has the high byte first"
_COUNTING_OF_TWINCAT = "the same bytes: TwinCAT counts bytes, other tools count words or double words"


def translated_address(text: str, source: Dialect, target: Dialect) -> PartText:
    """Return a direct address of `source` in `target`, no families: TwinCAT counts otherwise than CODESYS.

    S7 and TwinCAT count the bytes of words and double words, other tools count these (IEC 61131-3, 6.5.5, leaves it to
    them), so that ``%IW2`` of S7 is ``%IW1``. S7 has no letter for bits, and its German mnemonics have E for inputs and
    A for outputs.
    """
    bytes_there = target in COUNTING_BYTES
    of_s7, for_s7 = source is Dialect.SCL, target is Dialect.SCL
    if of_s7 is for_s7 and (source in COUNTING_BYTES) is bytes_there:
        return PartText(text)
    found = _ADDRESS.fullmatch(text)
    lacking = PartText(text, Severity.ERROR, f"{text} has no counterpart; left unchanged")
    unlike = lacking if of_s7 or for_s7 else PartText(text)
    if found is None or (for_s7 and found[1].upper() in INTERNATIONAL):
        return unlike
    area = INTERNATIONAL.get(found[1].upper(), found[1])
    size, place = found[2], found[3]
    if size.upper() in ("", "X"):
        if not (of_s7 or for_s7):
            return PartText(text)
        if not re.fullmatch(r"\d+\.[0-7]", place):
            return PartText(text, Severity.ERROR, f"{text} has no counterpart: S7 names bits by byte and bit")
        return PartText(f"%{area}{place}" if for_s7 else f"%{area}X{place}")
    if "." in place or ((of_s7 or for_s7) and size.upper() == "L"):
        return unlike
    width = _BYTES.get(size.upper())
    if width is None or (source in COUNTING_BYTES) is bytes_there:
        return PartText(f"%{area}{size}{place}")
    counting = _COUNTING if of_s7 or for_s7 else _COUNTING_OF_TWINCAT
    if bytes_there:
        return PartText(f"%{area}{size}{int(place) * width}", Severity.INFO, counting)
    if int(place) % width:
        reason = f"{text} has no counterpart: there a {_WORDS[width]} begins at every {width} bytes"
        return PartText(text, Severity.ERROR, reason)
    return PartText(f"%{area}{size}{int(place) // width}", Severity.INFO, counting)


def international_address(text: str) -> str:
    """Return an address with I and Q for the letters of German S7, E and A: ``%E0.3`` is ``%I0.3``."""
    found = _ADDRESS.fullmatch(text)
    letter = INTERNATIONAL.get(found[1].upper()) if found is not None else None
    return text if letter is None else f"%{letter}{text[2:]}"


def is_tag_address(text: str) -> bool:
    """True if a tag of S7 can have an address."""
    return _OF_TAGS.fullmatch(text) is not None


_OF_TAGS = re.compile(r"%[IQM](?:\d{1,9}\.[0-7]|[BWD]\d{1,9})", re.IGNORECASE)


def translated_part(name: str, source: Dialect, target: Dialect) -> PartText | None:
    """Return the name of a bit or another part of a word: ``3`` and ``%X3`` (6.5.4.4). None: it names no part.

    SCL has only the second form for bits; the first is the one that all versions of other tools know.
    """
    if name.isdigit():
        return PartText(f"%X{name}" if target is Dialect.SCL else name)
    if not name.startswith("%"):
        return None
    if source is Dialect.SCL and target is not Dialect.SCL and name[1] in "Xx":
        return PartText(name[2:])
    if target is Dialect.CODESYS:
        return PartText(name, Severity.INFO, f"older versions of CODESYS do not know .{name}")
    return PartText(name)
