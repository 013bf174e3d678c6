"""Times at which a task runs, in the terms of IEC 61131-3 and of CODESYS, and durations of TC6 files as literals.

IEC 61131-3 ed. 3, 6.8.2: INTERVAL is the cycle of a task, SINGLE starts it once at a rising edge. CODESYS has kinds of
tasks beside the TC6 attributes (``tasksettings``), and follows them: exports of TwinCAT have ``PT0S`` in the attribute.
Its help names the kinds Cyclic, Event (a rising edge), Status (as long as the variable is TRUE), External and
Freewheeling. Exports hold Cyclic only; how the others are spelled is a guess.

Durations of TC6 files are those of ISO 8601, or times of day (TC6 1.01, old Beremiz).
"""

from __future__ import annotations

import re
from collections.abc import Container
from dataclasses import dataclass
from typing import Any

from plcopen_sfc.languages.st.literals import duration_of
from plcopen_sfc.model.project import Task, TaskSettings
from plcopen_sfc.whole_numbers import whole_number

CYCLIC = "Cyclic"
EVENT = "Event"
FREEWHEELING = "Freewheeling"
"""The kind of a task that begins again when it has ended."""
SCHEDULE_FIELDS = ("interval", "single", "settings")
"""The fields of a task with its schedule."""


@dataclass(frozen=True, slots=True)
class Schedule:
    """Schedule of a task: in cycles of `interval`, at rising edges of `event`, or by the `kind` of CODESYS.

    `interval` is a literal of IEC 61131-3 or the name of a variable. `kind` is empty where IEC 61131-3 has it too.
    """

    interval: str | None = None
    event: str | None = None
    kind: str = ""


def schedule_of(task: Task) -> Schedule:
    """Return the schedule of a task."""
    interval = duration_literal(task.interval)
    settings = task.settings
    if settings is None or settings.kind is None:
        return Schedule(_none_of_zero(interval), task.single or None)
    if settings.kind.casefold() == CYCLIC.casefold():
        return Schedule(_none_of_zero(_with_unit(settings) or interval))
    event = settings.event or task.single or None
    if settings.kind.casefold() == EVENT.casefold():
        return Schedule(event=event)
    return Schedule(_none_of_zero(_with_unit(settings)), event, settings.kind)


def codesys_form(task: Task) -> dict[str, Any]:
    """Return the schedule fields of a task for CODESYS.

    A task of CODESYS has one kind: that at an event has no cycle besides.
    """
    schedule = schedule_of(task)
    if task.settings is not None or (schedule.interval is None and schedule.event is None):
        return {name: getattr(task, name) for name in SCHEDULE_FIELDS}
    if schedule.event is not None:
        settings = TaskSettings(kind=EVENT, event=schedule.event)
        return {"interval": "PT0S", "single": schedule.event, "settings": settings}
    length = nanoseconds(schedule.interval)
    milliseconds, rest = divmod(length or 0, 1_000_000)
    if length is None:
        settings = TaskSettings(kind=CYCLIC, interval=schedule.interval, interval_unit="ms")
    elif rest:
        settings = TaskSettings(kind=CYCLIC, interval=str(length // 1000), interval_unit="us")
    else:
        settings = TaskSettings(kind=CYCLIC, interval=f"t#{milliseconds}ms", interval_unit="ms")
    return {"interval": iso_duration(schedule.interval) or "PT0S", "single": None, "settings": settings}


def iec_form(task: Task, lists: Container[str] = frozenset()) -> dict[str, Any]:
    """Return the schedule fields of a task for tools of IEC 61131-3, which know no settings.

    `lists` are the names, in lower case, of lists of global variables, by which those variables are not called there.
    """
    schedule = schedule_of(task)
    same = nanoseconds(task.interval) == nanoseconds(schedule.interval) is not None
    interval = task.interval if same or task.settings is None else schedule.interval
    return {
        "interval": _without_list(interval, lists),
        "single": _without_list(schedule.event, lists),
        "settings": None,
    }


def _without_list(text: str | None, lists: Container[str]) -> str | None:
    around, dot, name = (text or "").partition(".")
    return name if dot and around.casefold() in lists else text


def schedule_fields(task: Task) -> dict[str, Any]:
    """Return the schedule fields of a task as plain data."""
    return task.model_dump(mode="json", include=set(SCHEDULE_FIELDS), exclude_none=True)


def _with_unit(settings: TaskSettings) -> str | None:
    """Return the cycle in the settings of CODESYS, with its unit."""
    text = (settings.interval or "").strip()
    count = whole_number(text)
    if count is None:
        return text or None
    return cycle_literal(count * (1 if settings.interval_unit in ("us", "µs") else 1000))


def cycle_literal(microseconds: int) -> str:
    """Return a cycle as a literal of IEC 61131-3: ``T#20ms``, ``T#0.25ms``."""
    milliseconds, rest = divmod(microseconds, 1000)
    return f"T#{milliseconds}" + (f".{rest:03}".rstrip("0") if rest else "") + "ms"


def _none_of_zero(interval: str | None) -> str | None:
    """None for an interval of no length, which IEC 61131-3 takes as none."""
    return None if nanoseconds(interval) == 0 else interval or None


_ISO_DURATION = re.compile(r"PT(?:(\d{1,9})H)?(?:(\d{1,9})M)?(?:(\d{1,9})(?:\.(\d+))?S)?")
_WITHOUT_PREFIX = re.compile(r"(?:\d+(?:\.\d+)?(?:ms|us|ns|d|h|m|s)_?)+", re.IGNORECASE)
"""``10ms``, as an example of TC6 2.01 has it (iec-checker)."""
_TIME_OF_DAY = re.compile(r"(\d{1,9}):(\d{1,9}):(\d{1,9})(?:\.(\d+))?")


def duration_literal(interval: str | None) -> str | None:
    """Return an interval as a literal of IEC 61131-3: ``T#100ms`` for ``PT0.1S``, ``00:00:00.1`` and ``100ms``.

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
    """Return the length of an interval; None where it is none, or the name of a variable."""
    literal = duration_literal(interval) or ""
    return duration_of(literal) if "#" in literal else None


def iso_duration(interval: str | None) -> str | None:
    """Return an interval as CODESYS writes it: ``PT0.02S`` for ``T#20ms``. None: it is no length of time."""
    length = nanoseconds(interval)
    if length is None or length < 0:
        return None
    seconds, fraction = divmod(length, 1_000_000_000)
    return f"PT{seconds}" + (f".{fraction:09}".rstrip("0") if fraction else "") + "S"


def clock_time(interval: str | None) -> str | None:
    """Return an interval as the ``xsd:time`` of TC6 1.01, ``00:00:00.02`` for ``T#20ms``; None from a day on."""
    length = nanoseconds(interval)
    if length is None:
        return None
    seconds, fraction = divmod(length, 1_000_000_000)
    minutes, seconds = divmod(seconds, 60)
    hours, minutes = divmod(minutes, 60)
    if not 0 <= hours < 24:
        return None
    return f"{hours:02}:{minutes:02}:{seconds:02}" + (f".{fraction:09}".rstrip("0") if fraction else "")
