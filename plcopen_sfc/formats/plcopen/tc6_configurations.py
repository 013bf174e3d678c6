"""Configurations, resources, tasks and program instances of TC6 XML, read and written."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.plcopen.source_marks import marked_source, source_mark, sources_of_section
from plcopen_sfc.formats.plcopen.tc6_declarations import (
    LISTINGS,
    parts_of_list,
    read_listing,
    read_section,
    write_listing,
    write_lists,
)
from plcopen_sfc.formats.plcopen.tc6_reading import (
    APPLICATION_FIELD,
    INSTANCE_FIELD,
    SCHEDULE_FIELD,
    Fields,
    Tc6ReadContext,
    keep_attributes,
    read_common,
    take_integer,
    take_required,
)
from plcopen_sfc.formats.plcopen.tc6_writing import Tc6WriteContext, add_child, finish_element
from plcopen_sfc.formats.xml.extension_data import attributes
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.languages.task_schedules import SCHEDULE_FIELDS, clock_time, codesys_form, iec_form, schedule_fields
from plcopen_sfc.model.project import Configuration, PouInstance, Resource, Task
from plcopen_sfc.report import Outcome


def _read_global_variables(ctx: Tc6ReadContext, element: etree._Element, fields: Fields) -> None:
    for section in parts_of_list(read_section(ctx, element, "global")):
        sources = sources_of_section(section)
        if sources is None:
            fields["global_variables"].append(section)
        else:
            ctx.global_variables += sources


def read_configuration(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    """Read ``configuration``."""
    left = attributes(element)
    name = take_required(ctx, element, left, "name")
    fields: Fields = {"name": name, "resources": [], "global_variables": []}
    ctx.place.append(f"configuration {name}")
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "resource":
            resource = child.get("name", "")
            fields["resources"].append(read_resource(ctx, child, f"configuration/{name}/resource/{resource}"))
        elif local == "globalVars":
            _read_global_variables(ctx, child, fields)
        elif local in LISTINGS:
            fields[LISTINGS[local]] = read_listing(ctx, child, local)
        else:
            read_common(ctx, fields, child, local, "configuration")
    ctx.place.pop()
    keep_attributes(fields, left)
    return fields


def write_configuration(
    ctx: Tc6WriteContext, parent: etree._Element, configuration: Configuration, *, is_application: bool = False
) -> None:
    """Write ``configuration``. `is_application`: it only holds an application, which is read back as such."""
    element = add_child(ctx, parent, "configuration", {"name": configuration.name})
    ctx.place.append(f"configuration {configuration.name}")
    for resource in configuration.resources:
        write_resource(ctx, element, resource, f"configuration/{configuration.name}/resource/{resource.name}")
    write_lists(ctx, element, configuration.global_variables)
    native = {"name", "resources", "global_variables"}
    if not ctx.version.first_generation:
        native |= {*LISTINGS.values()}
        for listing in (configuration.access_variables, configuration.config_variables):
            if listing is not None:
                write_listing(ctx, element, listing)
    if is_application:
        ctx.note(Outcome.TRANSLATED, "application", why="a configuration with one resource; TC6 has no application")
    else:
        ctx.keep("configuration")
    also = {APPLICATION_FIELD: True} if is_application else None
    finish_element(ctx, element, configuration, "configuration", frozenset(native), also=also)
    ctx.place.pop()


def read_resource(ctx: Tc6ReadContext, element: etree._Element, place: str) -> Fields:
    """Read ``resource``; `place` is the `Pou.place` of POUs in it."""
    left = attributes(element)
    fields: Fields = {
        "name": take_required(ctx, element, left, "name"),
        "tasks": [],
        "global_variables": [],
        "instances": [],
    }
    outer, ctx.resource_place = ctx.resource_place, place
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "task":
            fields["tasks"].append(_read_task(ctx, child))
        elif local == "globalVars":
            _read_global_variables(ctx, child, fields)
        elif local == "pouInstance":
            fields["instances"].append(_read_instance(ctx, child))
        else:
            read_common(ctx, fields, child, local, "resource")
    ctx.resource_place = outer
    keep_attributes(fields, left)
    return fields


def write_resource(ctx: Tc6WriteContext, parent: etree._Element, resource: Resource, place: str) -> None:
    """Write ``resource``. `place` is the `Pou.place` of POUs that belong into it."""
    element = add_child(ctx, parent, "resource", {"name": resource.name})
    ctx.place.append(f"resource {resource.name}")
    for task in resource.tasks:
        _write_task(ctx, element, task)
    write_lists(ctx, element, resource.global_variables)
    for instance in resource.instances:
        _write_instance(ctx, element, instance)
    ctx.keep("resource")
    ctx.resource_place = place
    finish_element(ctx, element, resource, "resource", frozenset({"name", "tasks", "global_variables", "instances"}))
    ctx.place.pop()


def _read_task(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    left = attributes(element)
    interval = left.pop("interval", None)
    fields: Fields = {
        "name": take_required(ctx, element, left, "name"),
        "interval": interval,
        "single": left.pop("single", None),
        "instances": [],
    }
    priority = take_integer(ctx, element, left, "priority")
    fields["priority"] = 0 if priority is None else priority
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "pouInstance":
            fields["instances"].append(_read_instance(ctx, child))
        else:
            read_common(ctx, fields, child, local, "task")
    written = Task.model_validate({"name": "", **{name: fields.get(name) for name in SCHEDULE_FIELDS}})
    source = marked_source(fields, SCHEDULE_FIELD, schedule_fields(written))
    if source is not None:
        fields.update(dict.fromkeys(SCHEDULE_FIELDS) | source)
    keep_attributes(fields, left)
    return fields


def _write_task(ctx: Tc6WriteContext, parent: etree._Element, task: Task) -> None:
    """Write ``task``. A schedule that is written otherwise than in the source is kept beside it."""
    lists = frozenset(section.name.casefold() for section in ctx.project.global_sections() if section.name)
    form = codesys_form(task) if ctx.dialect.tool is Tool.CODESYS else iec_form(task, lists)
    if ctx.version.first_generation and form["interval"] is not None and not _is_time(form["interval"]):
        form["interval"] = clock_time(form["interval"])
    shown = task.model_copy(update=form)
    also = source_mark(SCHEDULE_FIELD, schedule_fields(task), schedule_fields(shown))
    schedule = {"single": shown.single, "interval": shown.interval, "priority": str(task.priority)}
    element = add_child(ctx, parent, "task", {"name": task.name} | schedule)
    for instance in task.instances:
        _write_instance(ctx, element, instance)
    ctx.keep("task", task.name)
    finish_element(
        ctx, element, shown, "task", frozenset({"name", "priority", "instances", *SCHEDULE_FIELDS}), also=also
    )


def _is_time(text: str) -> bool:
    """True if `text` is an ``xsd:time``, the only form of an interval in TC6 1.01."""
    parts = text.split(":")
    return len(parts) == 3 and all(part[:2].isdigit() for part in parts)


def _read_instance(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    left = attributes(element)
    fields: Fields = {"name": take_required(ctx, element, left, "name")}
    # TC6 1.01 calls the attribute "type"
    type_name = left.pop("type", None) if ctx.version.first_generation else left.pop("typeName", None)
    fields["type_name"] = type_name or ""
    for child in element:
        read_common(ctx, fields, child, ctx.tags.get(child.tag), "pouInstance")
    fields.update(marked_source(fields, INSTANCE_FIELD, {name: fields[name] for name in ("name", "type_name")}) or {})
    keep_attributes(fields, left)
    return fields


def _write_instance(ctx: Tc6WriteContext, parent: etree._Element, instance: PouInstance) -> None:
    """Write ``pouInstance``. CODESYS and TwinCAT name the program only: it is its only instance."""
    type_attribute = "type" if ctx.version.first_generation else "typeName"
    name, type_name = instance.name, instance.type_name
    if ctx.dialect.tool is Tool.CODESYS:
        name, type_name = type_name or name, ""
    elif not type_name and not (instance.extension_data is not None and "type" in instance.extension_data.attributes):
        # but a file of TC6 2.x may have the attribute of 1.01 (iec-checker), which stays
        name, type_name = f"{name}_instance", name
    source = {"name": instance.name, "type_name": instance.type_name}
    also = source_mark(INSTANCE_FIELD, source, {"name": name, "type_name": type_name})
    element = add_child(ctx, parent, "pouInstance", {"name": name, type_attribute: type_name})
    ctx.keep("POU instance", instance.name)
    finish_element(ctx, element, instance, "pouInstance", frozenset({"name", "type_name"}), also=also)
