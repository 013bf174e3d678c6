"""Tasks in exports of CODESYS V3: an entry each, below the task configuration of an application."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.codesys_export.export_entries import Entry
from plcopen_sfc.formats.codesys_export.export_notation import SINGLE, member, value
from plcopen_sfc.model.project import PouInstance, Task, TaskSettings, TaskWatchdog
from plcopen_sfc.whole_numbers import whole_number

_SETTINGS = {
    "kind": ("Kindoftask",),
    "interval": ("Interval", "Time"),
    "interval_unit": ("Interval", "Unit"),
    "event": ("Event",),
}
_WATCHDOG = {
    "time": ("Watchdog", "Time", "Time"),
    "time_unit": ("Watchdog", "Time", "Unit"),
    "sensitivity": ("Watchdog", "Sensitivity"),
}
_CALL_TYPE = "{f194d1ef-7376-42ce-a729-4a5485a97a46}"


def read_task(entry: Entry) -> Task:
    """Return the task of an entry."""
    content = entry.content
    task = Task(name=entry.name, object_id=entry.guid)
    task.priority = whole_number(value(content, "Priority").strip()) or 0
    stated = {name: value(content, *path) or None for name, path in _SETTINGS.items()}
    watched = {name: value(content, *path) or None for name, path in _WATCHDOG.items()}
    task.settings = TaskSettings(**stated, watchdog=TaskWatchdog(enabled=_is_watched(entry), **watched))
    calls = member(content, "PouList")
    names = [value(call, "Name") for call in calls] if calls is not None else []
    task.instances = [PouInstance(name=name, type_name="") for name in names if name]
    return task


def _is_watched(entry: Entry) -> bool:
    return value(entry.content, "Watchdog", "Enabled").casefold() == "true"


def change_task(entry: Entry, task: Task) -> None:
    """Change an entry to what the model says of its task."""
    content = entry.content
    before = read_task(entry)
    if content is None or before == task:
        return
    named = member(entry.element, "MetaObject", "Name")
    if named is not None:
        named.text = task.name
    _set(entry, ("Priority",), str(task.priority))
    settings = task.settings or TaskSettings()
    interval = task.interval if task.interval != before.interval else settings.interval
    stated = {**settings.model_dump(include=set(_SETTINGS)), "interval": interval}
    for name, path in _SETTINGS.items():
        _set(entry, path, stated[name] or "")
    watchdog = settings.watchdog or TaskWatchdog()
    _set(entry, ("Watchdog", "Enabled"), str(watchdog.enabled))
    for name, path in _WATCHDOG.items():
        _set(entry, path, getattr(watchdog, name) or "")
    calls = member(content, "PouList")
    if calls is not None and [each.name for each in before.instances] != [each.name for each in task.instances]:
        old = {value(call, "Name"): call for call in calls}
        calls[:] = [old.get(each.name, _call(each.name)) for each in task.instances]


def _set(entry: Entry, path: tuple[str, ...], text: str) -> None:
    found = member(entry.content, *path)
    if found is not None and (found.text or "") != text:
        found.text = text


def _call(name: str) -> etree._Element:
    call = etree.Element(SINGLE, Type=_CALL_TYPE, Method="IArchivable")
    etree.SubElement(call, SINGLE, Name="Name", Type="string").text = name
    etree.SubElement(call, SINGLE, Name="Comment", Type="string").text = ""
    return call
