"""Durations of TC6 files as literals of IEC 61131-3: those of ISO 8601, and times of day (TC6 1.01, old Beremiz)."""

from __future__ import annotations

import re

from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value

_ISO_DURATION = re.compile(r"PT(?:(\d+)H)?(?:(\d+)M)?(?:(\d+)(?:\.(\d+))?S)?")
_WITHOUT_PREFIX = re.compile(r"(?:\d+(?:\.\d+)?(?:ms|us|ns|d|h|m|s)_?)+", re.IGNORECASE)
"""``10ms``, as an example of TC6 2.01 has it (iec-checker)."""
_TIME_OF_DAY = re.compile(r"(\d+):(\d+):(\d+)(?:\.(\d+))?")


def duration_literal(interval: str | None) -> str | None:
    """An interval as a literal of IEC 61131-3: ``T#100ms`` for ``PT0.1S``, ``00:00:00.1`` and ``100ms``.

    Any other is given back as it is.
    """
    if _WITHOUT_PREFIX.fullmatch((interval or "").strip()):
        return f"T#{(interval or '').strip()}"
    found = _ISO_DURATION.fullmatch(interval or "") or _TIME_OF_DAY.fullmatch(interval or "")
    if found is None or not any(found.groups()):
        return interval
    hours, minutes, seconds, fraction = found.groups()
    text = (f"{int(hours)}h" if int(hours or 0) else "") + (f"{int(minutes)}m" if int(minutes or 0) else "")
    microseconds = int((fraction or "").ljust(6, "0")[:6])
    total = int(seconds or 0) * 1000 + microseconds // 1000
    text += f"{total}ms" if total or not (text or microseconds % 1000) else ""
    return "T#" + text + (f"{microseconds % 1000}us" if microseconds % 1000 else "")


def nanoseconds(interval: str | None) -> int | None:
    """The length of an interval; None where it is none, or the name of a variable."""
    literal = duration_literal(interval) or ""
    if "#" not in literal:
        return None
    try:
        found = literal_value(literal)
    except LiteralError:
        return None
    return found.value if found.kind is LiteralKind.DURATION and isinstance(found.value, int) else None


def iso_duration(interval: str | None) -> str | None:
    """An interval as CODESYS writes it: ``PT0.02S`` for ``T#20ms``. None: it is no length of time."""
    length = nanoseconds(interval)
    if length is None or length < 0:
        return None
    seconds, fraction = divmod(length, 1_000_000_000)
    return f"PT{seconds}" + (f".{fraction:09}".rstrip("0") if fraction else "") + "S"


def clock_time(interval: str | None) -> str | None:
    """An interval as the ``xsd:time`` of TC6 1.01: ``00:00:00.02`` for ``T#20ms``. None: no duration below a day."""
    length = nanoseconds(interval)
    if length is None:
        return None
    seconds, fraction = divmod(length, 1_000_000_000)
    minutes, seconds = divmod(seconds, 60)
    hours, minutes = divmod(minutes, 60)
    if not 0 <= hours < 24:
        return None
    return f"{hours:02}:{minutes:02}:{seconds:02}" + (f".{fraction:09}".rstrip("0") if fraction else "")
