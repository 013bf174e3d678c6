"""Durations that TC6 files spell as ISO 8601 does, as literals of IEC 61131-3."""

from __future__ import annotations

import re

_ISO_DURATION = re.compile(r"PT(?:(\d+)H)?(?:(\d+)M)?(?:(\d+)(?:\.(\d+))?S)?")


def duration_literal(interval: str | None) -> str | None:
    """An interval as a literal of IEC 61131-3 (``T#0ms`` for ``PT0S``); what is no duration of ISO 8601 as it is."""
    found = _ISO_DURATION.fullmatch(interval or "")
    if found is None or not any(found.groups()):
        return interval
    hours, minutes, seconds, fraction = found.groups()
    text = (f"{hours}h" if hours else "") + (f"{minutes}m" if minutes else "")
    microseconds = int((fraction or "").ljust(6, "0")[:6])
    total = int(seconds or 0) * 1000 + microseconds // 1000
    text += f"{total}ms" if total or not (text or microseconds % 1000) else ""
    return "T#" + text + (f"{microseconds % 1000}us" if microseconds % 1000 else "")
