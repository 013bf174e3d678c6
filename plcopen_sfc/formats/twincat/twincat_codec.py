"""Files of PLC projects of TwinCAT 3: ``TcPlcObject`` with a POU, a type, variables or a task.

Tasks have files of their own (``.TcTTO``): a cycle in microseconds, a priority, the programs called. No file of the
corpus is one. What is known of them is from programs of others that read and write them.
"""

from __future__ import annotations

import copy
from collections.abc import Collection, Sequence
from pathlib import PurePosixPath

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.errors import Location, ModelError, StructureError
from plcopen_sfc.formats.archives.object_elements import (
    KINDS,
    attributes_of,
    path_of,
    read_element,
    take_out_others,
    write_declared,
    write_pou,
)
from plcopen_sfc.formats.archives.object_identities import identity, identity_of
from plcopen_sfc.formats.archives.object_lines import object_lines
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.plcopen.tc6_reading import PLACELESS, Tc6ReadContext
from plcopen_sfc.formats.plcopen.tc6_versions import V2_0
from plcopen_sfc.formats.xml.source_patch import patch_xml
from plcopen_sfc.formats.xml.xml_codec import FolderCodec, ProjectPart, XmlStyle, write_xml
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, line_of, parse_xml
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.task_schedules import FREEWHEELING, cycle_literal, nanoseconds, schedule_of
from plcopen_sfc.model.checked import first_misfit
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.project import PouInstance, Project, Resource, Task
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.whole_numbers import whole_number

TASK = "Task"
_GENERATED = ("TaskFBGuid", "Fb_init", "Fb_exit", "CycleUpdate", "PostCycleUpdate")
"""Identities that TwinCAT gives a task for code of its own, which it makes again."""
_PARTS_OF_TASK = frozenset({"CycleTime", "Priority", "PouCall", "ObjectProperties", *_GENERATED})
_PARTS_OF_CALL = frozenset({"Name", "Comment"})
_REPEATED = frozenset({"PouCall", "Name"})
_APPLICATION = "PLC"
_MICROSECOND = 1000
_USUAL_CYCLE = 10_000_000


def task_document(*tasks: Task) -> Project:
    """Return a project with nothing but an application that has these tasks."""
    resources = [Resource(name=_APPLICATION, tasks=list(tasks))] if tasks else []
    return Project(applications=resources, dialect=Dialect.CODESYS)


def read_task(ctx: Tc6ReadContext, element: etree._Element) -> Project:
    """Read ``Task``."""
    for name in ("CycleTime", "Priority"):
        text = (element.findtext(name) or "").strip()
        if whole_number(text) is None:
            ctx.error("TWC110", f"{name} of the task is {text or 'missing'}, and no whole number", element)
    for part in (*element, *(each for call in element.iterfind("PouCall") for each in call)):
        holder = part.getparent()
        known = _PARTS_OF_TASK if holder is element else _PARTS_OF_CALL
        is_first = part.tag in _REPEATED or (holder is not None and holder.find(part.tag) is part)
        if isinstance(part.tag, str) and not (part.tag in known and is_first):
            ctx.error("TWC110", f"{part.tag} of the task is not understood: TwinCAT may execute it otherwise", part)
    for thing in (element, *element.iterfind("PouCall")):
        names = [thing.get("Name", "")] if thing is element else [each.text or "" for each in thing.iterfind("Name")]
        if len(names) != 1 or not names[0].strip():
            ctx.error("TWC110", f"a {thing.tag} has {'several names' if len(names) > 1 else 'no name'}", thing)
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
    objects = [child for child in root if child.tag in _KINDS]
    thing = objects[0] if objects else None
    if root.tag != ROOT or thing is None:
        known = ", ".join(_KINDS)
        found = next((str(child.tag) for child in root if isinstance(child.tag, str)), "nothing")
        raise StructureError(
            f"<{root.tag}> holds {found}, and not an object that is read ({known})",
            location=Location(file, line_of(root)),
            hint="Give the .TcPOU, .TcGVL, .TcDUT, .TcIO and .TcTTO files of the project.",
        )
    ctx = Tc6ReadContext(V2_0, PLACELESS, file=file, lines=SourceLines(root, data))
    try:
        project = read_task(ctx, thing) if thing.tag == TASK else read_element(ctx, thing, file)
    except ValidationError as error:
        raise StructureError(first_misfit(error), location=Location(file, line_of(thing))) from error
    project.dialect = Dialect.CODESYS
    for other in objects[1:]:
        ctx.error("TWC106", f"{other.get('Name', '')} is a second object in the file, which is not read", other)
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
        root.append(write_task(tasks[0], identity(known, TASK, tasks[0].name)))
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


_INDENT = "  "


class TwincatCodec(FolderCodec):
    """Files of TwinCAT 3 with one object each."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        return read_object(data, file=file)

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        root = parse_xml(content)
        thing = next((child for child in root if child.tag in KINDS), None)
        return object_lines(thing, project, SourceLines(root, content).line) if thing is not None else {}

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        return write_object(project, options, report)

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        root = self.to_tree(project, options, report)
        # archives are marked as preserving blanks, and the tool indents them all the same
        etree.indent(root, _INDENT)
        return write_xml(root, self.style())

    def style(self) -> XmlStyle:
        """As TwinCAT writes: UTF-8 with a mark, CRLF, two blanks, ``<a />``."""
        return XmlStyle(encoding="utf-8", bom=True, newline="\r\n", indent=None, self_closing=" />")

    def standard_folder(self, thing: ProjectObject) -> str:
        """Return the folder in which TwinCAT puts an object of this kind."""
        return "DUTs" if isinstance(thing, DataTypeDeclaration) else "POUs"

    def listed(self, data: bytes, *, file: str | None = None) -> list[str]:
        """Return the files that a ``.plcproj`` compiles."""
        return [_path_in(each) for each in parse_xml(data, file=file).iterfind("{*}ItemGroup/{*}Compile")]

    def relisted(self, data: bytes, added: Sequence[str], gone: Sequence[str]) -> bytes:
        """Return a ``.plcproj`` that compiles other files, and lists their folders."""
        before = parse_xml(data)
        after = copy.deepcopy(before)
        space = str(after.tag)[: str(after.tag).rfind("}") + 1]
        compiled = list(after.iterfind("{*}ItemGroup/{*}Compile"))
        group = compiled[-1].getparent() if compiled else None
        without = {name.casefold() for name in gone}
        for each in compiled:
            holder = each.getparent()
            if _path_in(each).casefold() in without and holder is not None:
                holder.remove(each)
        if group is None:
            group = etree.SubElement(after, f"{space}ItemGroup")
        for name in added:
            entry = etree.SubElement(group, f"{space}Compile", Include=name.replace("/", "\\"))
            etree.SubElement(entry, f"{space}SubType").text = "Code"
        folders = list(after.iterfind("{*}ItemGroup/{*}Folder"))
        known = {_path_in(each).casefold() for each in folders}
        wanted = {str(PurePosixPath(name).parent) for name in added} - {"."}
        for name in sorted(folder for folder in wanted if folder.casefold() not in known):
            holder = folders[-1].getparent() if folders else etree.SubElement(after, f"{space}ItemGroup")
            if holder is not None:
                folders.append(etree.SubElement(holder, f"{space}Folder", Include=name.replace("/", "\\")))
        _take_out_folders(after, {folder for name in without for folder in PurePosixPath(name).parents})
        return patch_xml(data, before, after)

    def parts(self, project: Project) -> list[ProjectPart]:
        """Return the lists of global variables and the tasks of `project`."""
        lists = grouped((section.name or "", section) for section in project.global_variables)
        found = [
            ProjectPart(name, "GVLs", Project(global_variables=sections, dialect=Dialect.CODESYS))
            for name, sections in lists.items()
        ]
        tasks = [task for resource in project.applications for task in resource.tasks]
        return found + [ProjectPart(task.name, "", task_document(task)) for task in tasks]

    def join(self, project: Project) -> None:
        """Put the tasks of several files into one application."""
        tasks = [task for resource in project.applications for task in resource.tasks]
        project.applications = task_document(*tasks).applications if tasks else []

    def extension(self, document: Project) -> str:
        kinds = {".TcDUT": document.data_types, ".TcGVL": document.global_variables, ".TcTTO": document.applications}
        return next((extension for extension, found in kinds.items() if found), ".TcPOU")

    def new_document(self, version: str) -> Project:
        """Return a project without objects."""
        return Project(dialect=Dialect.CODESYS)

    def adapt(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Take out of `project`, a copy, what files of objects do not hold, such as how the project is filed."""
        if options.same:
            return
        tasks = [adapted_task(task, report) for task in project.tasks()]
        take_out_others(project)
        project.applications = task_document(*(task for task in tasks if task is not None)).applications


def _take_out_folders(root: etree._Element, left: Collection[PurePosixPath]) -> None:
    """Take out the folders among `left`, in lower case, in which nothing is listed any more."""
    entries = [each for each in root.iterfind("{*}ItemGroup/{*}*") if each.get("Include")]
    places = {each: PurePosixPath(_path_in(each).casefold()) for each in entries}
    for folder in sorted(entries, key=lambda each: -len(places[each].parts)):  # inner ones first
        is_folder = etree.QName(folder).localname == "Folder" and places[folder] in left
        if not is_folder or any(places[folder] in place.parents for place in places.values()):
            continue
        del places[folder]
        group = folder.getparent()
        if group is not None:
            group.remove(folder)
            if not len(group):
                root.remove(group)


def _path_in(element: etree._Element) -> str:
    """Return the path that an element of a ``.plcproj`` names, with ``/``."""
    return str(element.get("Include", "")).replace("\\", "/")


CODEC = TwincatCodec()
