"""Durations of TC6 files as literals of IEC 61131-3: those of ISO 8601, and times of day (TC6 1.01, old Beremiz)."""

from __future__ import annotations

import re

from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value

_ISO_DURATION = re.compile(r"PT(?:(\d+)H)?(?:(\d+)M)?(?:(\d+)(?:\.(\d+))?S)?")
_TIME_OF_DAY = re.compile(r"(\d+):(\d+):(\d+)(?:\.(\d+))?")


def duration_literal(interval: str | None) -> str | None:
    """An interval as a literal of IEC 61131-3: ``T#100ms`` for ``PT0.1S`` and ``00:00:00.1``; any other as it is."""
    found = _ISO_DURATION.fullmatch(interval or "") or _TIME_OF_DAY.fullmatch(interval or "")
    if found is None or not any(found.groups()):
        return interval
    hours, minutes, seconds, fraction = found.groups()
    text = (f"{int(hours)}h" if int(hours or 0) else "") + (f"{int(minutes)}m" if int(minutes or 0) else "")
    microseconds = int((fraction or "").ljust(6, "0")[:6])
    total = int(seconds or 0) * 1000 + microseconds // 1000
    text += f"{total}ms" if total or not (text or microseconds % 1000) else ""
    return "T#" + text + (f"{microseconds % 1000}us" if microseconds % 1000 else "")


def clock_time(interval: str | None) -> str | None:
    """An interval as the ``xsd:time`` of TC6 1.01: ``00:00:00.02`` for ``T#20ms``. None: no duration below a day."""
    literal = duration_literal(interval) or ""
    if "#" not in literal:
        return None
    try:
        found = literal_value(literal)
    except LiteralError:
        return None
    if found.kind is not LiteralKind.DURATION or not isinstance(found.value, int):
        return None
    seconds, fraction = divmod(found.value, 1_000_000_000)
    minutes, seconds = divmod(seconds, 60)
    hours, minutes = divmod(minutes, 60)
    if not 0 <= hours < 24:
        return None
    return f"{hours:02}:{minutes:02}:{seconds:02}" + (f".{fraction:09}".rstrip("0") if fraction else "")
