"""Files of a PLC project of TwinCAT 3, read and written: ``TcPlcObject`` with a POU, a type, variables or a task.

Tasks have files of their own (``.TcTTO``): a cycle in microseconds, a priority, the programs called. No file of the
corpus is one. What is known of them is from programs of others that read and write them.
"""

from __future__ import annotations

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.errors import Location, ModelError, StructureError
from plcopen_sfc.formats.archives.object_elements import (
    KINDS,
    attributes_of,
    identity,
    identity_of,
    path_of,
    read_element,
    write_declared,
    write_pou,
)
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.plcopen.tc6_reading import Tc6ReadContext, line_of
from plcopen_sfc.formats.plcopen.tc6_versions import V2_0
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse_xml
from plcopen_sfc.languages.task_schedules import FREEWHEELING, cycle_literal, nanoseconds, schedule_of
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import PouInstance, Project, Resource, Task
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.whole_numbers import whole_number

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
    cycle = whole_number((element.findtext("CycleTime") or "").strip())
    task = Task(name=element.get("Name", ""))
    task.priority = whole_number((element.findtext("Priority") or "").strip()) or 0
    task.interval = cycle_literal(cycle) if cycle is not None else None
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


ROOT = "TcPlcObject"
_FILE_VERSION = "1.1.0.1"
_KINDS = (*KINDS, TASK)


# -- reading ----------------------------------------------------------------------------------------------------------


def read_object(data: bytes, *, file: str | None) -> ReadResult:
    """Read a file. Raises `FormatError` where it is none of an object."""
    root = parse_xml(data, file=file)
    thing = next((child for child in root if child.tag in _KINDS), None)
    if root.tag != ROOT or thing is None:
        known = ", ".join(_KINDS)
        found = next((str(child.tag) for child in root if isinstance(child.tag, str)), "nothing")
        raise StructureError(
            f"<{root.tag}> holds {found}, and not an object that is read ({known})",
            location=Location(file, line_of(root)),
            hint="Give the .TcPOU, .TcGVL, .TcDUT, .TcIO and .TcTTO files of the project.",
        )
    ctx = Tc6ReadContext(V2_0, file=file, lines=SourceLines(root, data), placeless=True)
    try:
        project = read_task(thing) if thing.tag == TASK else read_element(ctx, thing, file)
    except ValidationError as error:
        first = error.errors()[0]
        message = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        raise StructureError(message, location=Location(file, line_of(thing))) from error
    project.dialect = Dialect.CODESYS
    return ReadResult(project, ctx.diagnostics)


# -- writing ----------------------------------------------------------------------------------------------------------


def write_object(project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
    """Return the tree of a file. Raises `ModelError` where the project is more, or less, than one object."""
    lists = list(dict.fromkeys(section.name or "" for section in project.global_variables))
    tasks = [task for resource in project.applications for task in resource.tasks]
    count = len(project.pous) + len(project.data_types) + len(lists) + len(tasks)
    if count != 1 or project.data_blocks or project.tag_tables:
        raise ModelError(
            f"a file of TwinCAT holds one POU, type, list of variables or task; the project has {count} of them",
            hint="Save it into a folder: each object gets its file there.",
        )
    root = etree.Element(ROOT)
    source = _source_of(options)
    patched = source.getparent() if source is not None else None
    for name, value in {"Version": _FILE_VERSION, **(attributes_of(patched) if patched is not None else {})}.items():
        root.set(name, value)
    if project.pous:
        root.append(write_pou(project.pous[0], report, source))
    elif tasks:
        known = identity_of(source) if source is not None else None
        root.append(write_task(tasks[0], identity(known, tasks[0].name)))
        report.add(Outcome.KEPT, "task", f"task {tasks[0].name}")
    else:
        root.append(write_declared(project, source))
        report.add(Outcome.KEPT, "data type" if project.data_types else "global variables", path_of(project))
    return root


def _source_of(options: WriteOptions) -> etree._Element | None:
    """Return the object in the file that is patched."""
    if not (options.same and options.source):
        return None
    return next((child for child in parse_xml(options.source) if child.tag in _KINDS), None)
