"""Writes a TC6 project: headers, types, instances. The reader is `project_reader`."""

from __future__ import annotations

import re
from collections.abc import Iterable
from datetime import datetime

from lxml import etree

from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.plcopen.body_writer import write_pou
from plcopen_sfc.formats.plcopen.carrying import APPLICATION_FIELD, INSTANCE_FIELD, SCHEDULE_FIELD
from plcopen_sfc.formats.plcopen.global_lists import list_names
from plcopen_sfc.formats.plcopen.rewritten import mark
from plcopen_sfc.formats.plcopen.types_writer import (
    write_access_section,
    write_config_section,
    write_data_type_declaration,
    write_lists,
)
from plcopen_sfc.formats.plcopen.versions import NO_TIME, XHTML
from plcopen_sfc.formats.plcopen.writing import Dialect, WriteContext, decimal, finish, sub, write_text
from plcopen_sfc.formats.task_schedules import SCHEDULE_FIELDS, clock_time, codesys_form, iec_form, said_schedule
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource, Scaling, Task
from plcopen_sfc.report import ConversionReport, Outcome

_HEADER = frozenset(
    {"name", "header", "version", "modified", "organization", "author", "language", "content_comment"}
    | {"content_carried", "scales", "foreign_data_infos"}
)
_TIME = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?(Z|[+-]\d\d:\d\d)?")


def write_project(
    project: Project,
    dialect: Dialect,
    report: ConversionReport,
    options: WriteOptions,
    stale: frozenset[int] = frozenset(),
) -> etree._Element:
    """The tree of the file for `project`; what becomes of each item goes into `report`.

    `stale` are the objects (by `id()`) whose declaration as text is left out.
    """
    ctx = WriteContext(dialect, report, project, options, stale)
    nsmap: dict[str | None, str] = {None: dialect.version.namespace}
    if dialect.declares_xhtml:
        nsmap["xhtml"] = XHTML
    root = etree.Element(ctx.names["project"], nsmap=nsmap)  # type: ignore[arg-type]  # lxml-stubs: str keys only
    _file_header(ctx, root, project)
    _content_header(ctx, root, project)
    hidden = dialect.native_fields.get("resource", frozenset())
    types = sub(ctx, root, "types")
    data_types = sub(ctx, types, "dataTypes")
    for declaration in project.data_types:
        if not declaration.place or "place" not in hidden:
            write_data_type_declaration(ctx, data_types, declaration, in_place=not declaration.place)
    pous = sub(ctx, types, "pous")
    for pou in project.pous:
        if not pou.place or "place" not in hidden:
            write_pou(ctx, pous, pou, in_place=not pou.place)
    instances = sub(ctx, root, "instances")
    configurations = sub(ctx, instances, "configurations")
    for configuration in project.configurations:
        write_configuration(ctx, configurations, configuration)
    if "applications" not in dialect.native_fields.get("project", frozenset()):
        for application in project.applications:
            holder = Configuration(name=application.name, resources=[application])
            write_configuration(ctx, configurations, holder, is_application=True)
    native = _HEADER | {"data_types", "pous", "configurations", "applications", "dialect"}  # the format has its dialect
    if project.header.created != _time(ctx, project.header.created) or (
        project.header.carried is not None and not ctx.takes_markup
    ):
        native = native - {"header"}
    if project.modified is not None and project.modified != (_time(ctx, project.modified) or None):
        native = native - {"modified"}
    if ctx.version.first_generation:
        native = native - {"content_carried", "foreign_data_infos"}
    finish(ctx, root, project, "project", native, documents=not ctx.version.first_generation)
    return root


def _attributes(pairs: Iterable[tuple[str, str | None]]) -> dict[str, str]:
    return {name: value for name, value in pairs if value is not None}


def _time(ctx: WriteContext, text: str) -> str:
    """A time as the schema wants it: some tools write ``2007-07-07 11:58:26``. Empty for what is no time.

    In a file of the same format it stays as it was.
    """
    if ctx.same:
        return text
    time = text.strip().replace(" ", "T", 1)
    if not _TIME.fullmatch(time):
        return ""
    try:
        datetime.fromisoformat(time)
    except ValueError:
        return ""
    return time


def _file_header(ctx: WriteContext, root: etree._Element, project: Project) -> None:
    header = project.header
    element = sub(
        ctx,
        root,
        "fileHeader",
        _attributes(
            (
                ("companyName", header.company),
                ("companyURL", header.company_url),
                ("productName", header.product),
                ("productVersion", header.version),
                ("productRelease", header.release),
                ("creationDateTime", _time(ctx, header.created) or NO_TIME),
                ("contentDescription", header.description),
            )
        ),
    )
    if header.carried is not None and ctx.takes_markup:
        for name, value in header.carried.attributes.items():
            element.set(name, value)


def _content_header(ctx: WriteContext, root: etree._Element, project: Project) -> None:
    element = sub(
        ctx,
        root,
        "contentHeader",
        _attributes(
            (
                ("name", project.name),
                ("version", project.version),
                ("modificationDateTime", _time(ctx, project.modified or "") or None),
                ("organization", project.organization),
                ("author", project.author),
                ("language", project.language),
            )
        ),
    )
    if project.content_comment is not None:
        sub(ctx, element, "Comment").text = project.content_comment
    scales = project.scales
    coordinates = sub(ctx, element, "coordinateInfo")
    if scales.page is not None:
        sub(ctx, coordinates, "pageSize", _scale(scales.page))
    for name, scale in (("fbd", scales.fbd), ("ld", scales.ld), ("sfc", scales.sfc)):
        sub(ctx, sub(ctx, coordinates, name), "scaling", _scale(scale))
    if project.foreign_data_infos is not None and not ctx.version.first_generation:
        infos = sub(ctx, element, "addDataInfo")
        for info in project.foreign_data_infos:
            attributes = _attributes((("name", info.name), ("version", info.version), ("vendor", info.vendor)))
            write_text(ctx, sub(ctx, infos, "info", attributes), "description", info.description)
    content = Project(carried=project.content_carried)
    finish(ctx, element, content, "contentHeader", frozenset(), documents=False)


def _scale(scale: Scaling) -> dict[str, str]:
    return {"x": decimal(scale.x), "y": decimal(scale.y)}


def write_configuration(
    ctx: WriteContext, parent: etree._Element, configuration: Configuration, *, is_application: bool = False
) -> None:
    """Write ``configuration``. `is_application`: it only holds an application, which is read back as such."""
    element = sub(ctx, parent, "configuration", {"name": configuration.name})
    ctx.place.append(f"configuration {configuration.name}")
    for resource in configuration.resources:
        write_resource(ctx, element, resource, f"configuration/{configuration.name}/resource/{resource.name}")
    write_lists(ctx, element, configuration.global_variables)
    native = {"name", "resources", "global_variables"}
    if not ctx.version.first_generation:
        native |= {"access_variables", "config_variables"}
        if configuration.access_variables is not None:
            write_access_section(ctx, element, configuration.access_variables)
        if configuration.config_variables is not None:
            write_config_section(ctx, element, configuration.config_variables)
    if is_application:
        ctx.note(Outcome.TRANSLATED, "application", why="a configuration with one resource; TC6 has no application")
    else:
        ctx.keep("configuration")
    also = {APPLICATION_FIELD: True} if is_application else None
    finish(ctx, element, configuration, "configuration", frozenset(native), also=also)
    ctx.place.pop()


def write_resource(ctx: WriteContext, parent: etree._Element, resource: Resource, place: str) -> None:
    """Write ``resource``. `place` is what the POUs that belong into it say of where they stand."""
    element = sub(ctx, parent, "resource", {"name": resource.name})
    ctx.place.append(f"resource {resource.name}")
    for task in resource.tasks:
        _task(ctx, element, task)
    write_lists(ctx, element, resource.global_variables)
    for instance in resource.instances:
        _instance(ctx, element, instance)
    ctx.keep("resource")
    ctx.resource_place = place
    finish(ctx, element, resource, "resource", frozenset({"name", "tasks", "global_variables", "instances"}))
    ctx.place.pop()


def _task(ctx: WriteContext, parent: etree._Element, task: Task) -> None:
    """Write ``task``. What the source says otherwise of when it runs is kept beside what is written for it."""
    form = codesys_form(task) if ctx.dialect.tool is Tool.CODESYS else iec_form(task, list_names(ctx.project))
    if ctx.version.first_generation and form["interval"] is not None and not _is_time(form["interval"]):
        form["interval"] = clock_time(form["interval"])
    shown = task.model_copy(update=form)
    also = mark(SCHEDULE_FIELD, said_schedule(task), said_schedule(shown))
    element = sub(
        ctx,
        parent,
        "task",
        _attributes(
            (
                ("name", task.name),
                ("single", shown.single),
                ("interval", shown.interval),
                ("priority", str(task.priority)),
            )
        ),
    )
    for instance in task.instances:
        _instance(ctx, element, instance)
    ctx.keep("task", task.name)
    finish(ctx, element, shown, "task", frozenset({"name", "priority", "instances", *SCHEDULE_FIELDS}), also=also)


def _is_time(text: str) -> bool:
    """Whether `text` is an ``xsd:time``, the only form of an interval in TC6 1.01."""
    parts = text.split(":")
    return len(parts) == 3 and all(part[:2].isdigit() for part in parts)


def _instance(ctx: WriteContext, parent: etree._Element, instance: PouInstance) -> None:
    """Write ``pouInstance``. CODESYS and TwinCAT name the program only: it is its only instance."""
    type_attribute = "type" if ctx.version.first_generation else "typeName"
    name, type_name = instance.name, instance.type_name
    if ctx.dialect.tool is Tool.CODESYS:
        name, type_name = type_name or name, ""
    elif not type_name and not (instance.carried is not None and "type" in instance.carried.attributes):
        # but a file of TC6 2.x may have the attribute of 1.01 (iec-checker), which stays
        name, type_name = f"{name}_instance", name
    source = {"name": instance.name, "type_name": instance.type_name}
    also = mark(INSTANCE_FIELD, source, {"name": name, "type_name": type_name})
    element = sub(ctx, parent, "pouInstance", {"name": name, type_attribute: type_name})
    ctx.keep("POU instance", instance.name)
    finish(ctx, element, instance, "pouInstance", frozenset({"name", "type_name"}), also=also)
