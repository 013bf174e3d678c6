"""Tasks of TwinCAT 3 in files of their own (``.TcTTO``): a cycle in microseconds, a priority, the programs called.

No file of the corpus is one. What is known of them is from programs of others that read and write them.
"""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.languages.task_schedules import FREEWHEELING, cycle_literal, nanoseconds, schedule_of
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import PouInstance, Project, Resource, Task
from plcopen_sfc.report import ConversionReport, Outcome

TASK = "Task"
_APPLICATION = "PLC"
_MICROSECOND = 1000
_USUAL_CYCLE = 10_000_000


def task_document(*tasks: Task) -> Project:
    """Return a project with nothing but an application that has these tasks."""
    resources = [Resource(name=_APPLICATION, tasks=list(tasks))] if tasks else []
    return Project(applications=resources, dialect=Dialect.CODESYS)


def read_task(element: etree._Element) -> Project:
    """Read ``Task``."""
    priority = (element.findtext("Priority") or "").strip()
    cycle = (element.findtext("CycleTime") or "").strip()
    task = Task(name=element.get("Name", ""))
    task.priority = int(priority) if priority.isdecimal() else 0
    task.interval = cycle_literal(int(cycle)) if cycle.isdecimal() else None
    programs = (name.text or "" for name in element.iterfind("PouCall/Name"))
    task.instances = [PouInstance(name=name.strip(), type_name="") for name in programs]
    return task_document(task)


def write_task(task: Task, identity: str) -> etree._Element:
    """Return ``Task``."""
    written = etree.Element(TASK, Name=task.name, Id=identity)
    length = nanoseconds(schedule_of(task).interval)
    if length is not None:
        etree.SubElement(written, "CycleTime").text = str(length // _MICROSECOND)
    etree.SubElement(written, "Priority").text = str(task.priority)
    for instance in task.instances:
        etree.SubElement(etree.SubElement(written, "PouCall"), "Name").text = instance.name
    return written


def adapted_task(task: Task, report: ConversionReport) -> Task | None:
    """Return a task in terms of TwinCAT, whose tasks are cyclic and call programs by name; None: there is none."""
    path = f"task {task.name}"
    schedule = schedule_of(task)
    length = nanoseconds(schedule.interval)
    if schedule.kind == FREEWHEELING:
        length = _USUAL_CYCLE
        why = "it begins again when it has ended, and tasks of TwinCAT are cyclic: here every 10 ms"
        report.add(Outcome.APPROXIMATED, "interval", path, why)
    elif length is None or schedule.event is not None or schedule.kind:
        report.add(Outcome.NOT_EXECUTED, "task", path, "tasks of TwinCAT are cyclic, with a cycle that is a constant")
        return None
    if task.settings is not None and task.settings.watchdog is not None and task.settings.watchdog.enabled:
        report.add(Outcome.APPROXIMATED, "watchdog", path, "no file of TwinCAT is known to hold it: set it there")
    report.add(Outcome.TRANSLATED, "task", path, "a file of its own: connect it with a real-time task in TwinCAT")
    adapted = Task(name=task.name, priority=task.priority, interval=cycle_literal(length // _MICROSECOND))
    adapted.instances = [PouInstance(name=each.type_name or each.name, type_name="") for each in task.instances]
    return adapted
