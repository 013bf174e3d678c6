"""When a task runs, as IEC 61131-3 and as CODESYS say it.

IEC 61131-3 ed. 3, 6.8.2: INTERVAL is the cycle of a task, SINGLE starts it once at a rising edge. CODESYS has kinds of
tasks beside the TC6 attributes (``tasksettings``), and follows them: exports of TwinCAT have ``PT0S`` in the attribute.
Its help names the kinds Cyclic, Event (a rising edge), Status (as long as the variable is TRUE), External and
Freewheeling. Exports hold Cyclic only; how the others are spelled is a guess.
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass
from typing import Any

from plcopen_sfc.formats.durations import duration_literal, iso_duration, nanoseconds
from plcopen_sfc.model.project import Task, TaskSettings

__all__ = ["SCHEDULE_FIELDS", "Schedule", "codesys_form", "iec_form", "said_schedule", "schedule_of"]

CYCLIC = "Cyclic"
EVENT = "Event"
SCHEDULE_FIELDS = ("interval", "single", "settings")
"""The fields of a task that say when it runs."""


@dataclass(frozen=True, slots=True)
class Schedule:
    """When a task runs: in cycles of `interval`, at rising edges of `event`, or as `kind` of CODESYS says it.

    `interval` is a literal of IEC 61131-3 or the name of a variable. `kind` is empty where IEC 61131-3 has it too.
    """

    interval: str | None = None
    event: str | None = None
    kind: str = ""


def schedule_of(task: Task) -> Schedule:
    """When a task runs."""
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
    """The fields of a task that say to CODESYS when it runs.

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
    """The fields of a task that say to tools of IEC 61131-3 when it runs: they know no settings.

    `lists` are the names, in lower case, of lists of global variables that do not stand before those variables there.
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


def said_schedule(task: Task) -> dict[str, Any]:
    """The fields of a task that say when it runs, as plain data."""
    return task.model_dump(mode="json", include=set(SCHEDULE_FIELDS), exclude_none=True)


def _with_unit(settings: TaskSettings) -> str | None:
    """The cycle in the settings of CODESYS, with its unit."""
    text = (settings.interval or "").strip()
    if not text.isdigit():
        return text or None
    microseconds = int(text) * (1 if settings.interval_unit in ("us", "µs") else 1000)
    milliseconds, rest = divmod(microseconds, 1000)
    return f"T#{milliseconds}" + (f".{rest:03}".rstrip("0") if rest else "") + "ms"


def _none_of_zero(interval: str | None) -> str | None:
    """None for an interval of no length, which IEC 61131-3 takes as none."""
    return None if nanoseconds(interval) == 0 else interval or None
