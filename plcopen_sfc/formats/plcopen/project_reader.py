"""Reads a TC6 project: headers, types, instances. The writer is `project_writer`."""

from __future__ import annotations

from collections.abc import Callable

from lxml import etree

from plcopen_sfc.errors import Location, StructureError, UnknownVersionError
from plcopen_sfc.formats.plcopen.body_reader import read_pou
from plcopen_sfc.formats.plcopen.carrying import (
    APPLICATION_FIELD,
    FIELDS_DATA,
    INSTANCE_FIELD,
    SCHEDULE_FIELD,
    read_comment,
    read_fields,
)
from plcopen_sfc.formats.plcopen.reading import (
    DataReader,
    Fields,
    ReadContext,
    attributes,
    carry_attributes,
    carry_element,
    line_of,
    number,
    read_common,
    read_text,
    take_integer,
    take_required,
)
from plcopen_sfc.formats.plcopen.rewritten import is_added_configuration, marked, sources_of_section
from plcopen_sfc.formats.plcopen.types_reader import (
    parts_of_list,
    read_access_section,
    read_config_section,
    read_data_type_declaration,
    read_section,
)
from plcopen_sfc.formats.plcopen.versions import NO_TIME, PREFIX, VERSIONS, Tc6Version, version_of
from plcopen_sfc.formats.task_schedules import SCHEDULE_FIELDS, said_schedule
from plcopen_sfc.formats.xml.xml_parsing import SourceLines
from plcopen_sfc.model.project import Task


def find_version(root: etree._Element, *, file: str | None = None) -> Tc6Version:
    """The TC6 version of a document. Raises `StructureError` and `UnknownVersionError`."""
    name = etree.QName(root)
    place = Location(file, line_of(root), None, f"/{name.localname}")
    version = version_of(name.namespace or "")
    if version is None:
        if (name.namespace or "").startswith(PREFIX):
            known = ", ".join(v.namespace for v in VERSIONS)
            raise UnknownVersionError(
                f"PLCopen XML in the unknown namespace {name.namespace!r}", location=place, hint=f"Known are: {known}"
            )
        raise StructureError(
            f"this is not PLCopen XML: the root element is <{name.localname}>"
            + (f" in the namespace {name.namespace!r}" if name.namespace else ""),
            location=place,
            hint="PLCopen XML starts with <project> in a namespace such as http://www.plcopen.org/xml/tc6_0201.",
        )
    if name.localname != "project":
        raise StructureError(
            f"the root element is <{name.localname}>, not <project>",
            location=place,
            hint="This may be a part of a PLCopen XML file; load the whole file.",
        )
    return version


def read_project(
    root: etree._Element,
    version: Tc6Version,
    *,
    file: str | None = None,
    lines: SourceLines | None = None,
    data_readers: dict[str, DataReader] | None = None,
    usual_text_element: str = "p",
    placeless: bool = False,
    finish_chart: Callable[[ReadContext, Fields], None] | None = None,
) -> tuple[Fields, ReadContext]:
    """Read ``project`` into the fields of a `Project`; what there is to say about it is in the context returned."""
    ctx = ReadContext(
        version,
        file=file,
        lines=lines,
        data_readers=data_readers,
        usual_text_element=usual_text_element,
        placeless=placeless,
    )
    ctx.finish_chart = finish_chart
    ctx.comment_reader = read_comment
    ctx.data_readers = {FIELDS_DATA: read_fields, **ctx.data_readers}
    fields: Fields = {"configurations": [], "applications": [], "pous": ctx.pous, "data_types": ctx.data_types}
    for child in root:
        local = ctx.tags.get(child.tag)
        reader = _PARTS.get(local or "")
        if reader is not None:
            reader(ctx, child, fields)
        else:
            read_common(ctx, fields, child, local, "project")
    if ctx.global_variables:
        fields["global_variables"] = [*fields.get("global_variables", ()), *ctx.global_variables]
    for required in ("fileHeader", "contentHeader", "types", "instances"):
        if root.find(ctx.version.qualified[required]) is None:
            ctx.error("XML207", f"<project> has no <{required}>", root)
    carry_attributes(fields, attributes(root))
    return fields, ctx


def _file_header(ctx: ReadContext, element: etree._Element, fields: Fields) -> None:
    left = attributes(element)
    header: Fields = {
        "company": left.pop("companyName", ""),
        "company_url": left.pop("companyURL", None),
        "product": left.pop("productName", ""),
        "version": left.pop("productVersion", ""),
        "release": left.pop("productRelease", None),
        "created": "" if (created := left.pop("creationDateTime", "")) == NO_TIME else created,
        "description": left.pop("contentDescription", None),
    }
    if left:
        header["carried"] = {"attributes": left}
    for child in element:
        carry_element(ctx, header, child)
    fields["header"] = header


def _content_header(ctx: ReadContext, element: etree._Element, fields: Fields) -> None:
    left = attributes(element)
    content: Fields = {}
    fields.update(
        name=left.pop("name", ""),
        version=left.pop("version", None),
        modified=left.pop("modificationDateTime", None),
        organization=left.pop("organization", None),
        author=left.pop("author", None),
        language=left.pop("language", None),
    )
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "Comment":
            fields["content_comment"] = child.text or ""
        elif local == "coordinateInfo":
            fields["scales"] = _scales(ctx, child)
        elif local == "addDataInfo":
            fields["foreign_data_infos"] = [_data_info(ctx, info) for info in child if ctx.tags.get(info.tag) == "info"]
        else:
            read_common(ctx, content, child, local, "contentHeader")
    if left:
        content.setdefault("carried", {"data": [], "attributes": {}, "elements": []})["attributes"].update(left)
    if "carried" in content:
        fields["content_carried"] = content["carried"]


def _scales(ctx: ReadContext, element: etree._Element) -> Fields:
    scales: Fields = {}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "pageSize":
            scales["page"] = _scale(child)
        elif local in ("fbd", "ld", "sfc"):
            for scaling in child:
                if ctx.tags.get(scaling.tag) == "scaling":
                    scales[local] = _scale(scaling)
    return scales


def _scale(element: etree._Element) -> Fields:
    return {"x": number(element.get("x")) or 0, "y": number(element.get("y")) or 0}


def _data_info(ctx: ReadContext, element: etree._Element) -> Fields:
    info: Fields = {
        "name": element.get("name", ""),
        "vendor": element.get("vendor", ""),
        "version": element.get("version"),
    }
    for child in element:
        if ctx.tags.get(child.tag) == "description":
            info["description"] = read_text(ctx, child)
    return info


def _types(ctx: ReadContext, element: etree._Element, fields: Fields) -> None:
    for child in element:
        local = ctx.tags.get(child.tag)
        for part in child if local in ("dataTypes", "pous") else ():
            kind = ctx.tags.get(part.tag)
            if kind == "dataType" and local == "dataTypes":
                ctx.data_types.append(read_data_type_declaration(ctx, part, ""))
            elif kind == "pou" and local == "pous":
                ctx.pous.append(read_pou(ctx, part, ""))
            else:
                carry_element(ctx, fields, part)
        if local not in ("dataTypes", "pous"):
            carry_element(ctx, fields, child)


def _instances(ctx: ReadContext, element: etree._Element, fields: Fields) -> None:
    for child in element:
        if ctx.tags.get(child.tag) != "configurations":
            carry_element(ctx, fields, child)
            continue
        for part in child:
            if ctx.tags.get(part.tag) == "configuration":
                configuration = read_configuration(ctx, part)
                stands_for_another = configuration.pop(APPLICATION_FIELD, False)
                also = [name for name, held in configuration.items() if held and name not in ("name", "resources")]
                if stands_for_another and len(configuration["resources"]) == 1 and not also:
                    fields["applications"].extend(configuration["resources"])
                elif not is_added_configuration(configuration):
                    fields["configurations"].append(configuration)
            else:
                carry_element(ctx, fields, part)


_PARTS = {
    "fileHeader": _file_header,
    "contentHeader": _content_header,
    "types": _types,
    "instances": _instances,
}


def _global_variables(ctx: ReadContext, element: etree._Element, fields: Fields) -> None:
    for section in parts_of_list(read_section(ctx, element, "global")):
        sources = sources_of_section(section)
        if sources is None:
            fields["global_variables"].append(section)
        else:
            ctx.global_variables += sources


def read_configuration(ctx: ReadContext, element: etree._Element) -> Fields:
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
            _global_variables(ctx, child, fields)
        elif local == "accessVars":
            fields["access_variables"] = read_access_section(ctx, child)
        elif local == "configVars":
            fields["config_variables"] = read_config_section(ctx, child)
        else:
            read_common(ctx, fields, child, local, "configuration")
    ctx.place.pop()
    carry_attributes(fields, left)
    return fields


def read_resource(ctx: ReadContext, element: etree._Element, place: str) -> Fields:
    """Read ``resource``; `place` is what POUs in it say of where they stand."""
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
            fields["tasks"].append(_task(ctx, child))
        elif local == "globalVars":
            _global_variables(ctx, child, fields)
        elif local == "pouInstance":
            fields["instances"].append(_instance(ctx, child))
        else:
            read_common(ctx, fields, child, local, "resource")
    ctx.resource_place = outer
    carry_attributes(fields, left)
    return fields


def _task(ctx: ReadContext, element: etree._Element) -> Fields:
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
            fields["instances"].append(_instance(ctx, child))
        else:
            read_common(ctx, fields, child, local, "task")
    said = Task.model_validate({"name": "", **{name: fields.get(name) for name in SCHEDULE_FIELDS}})
    source = marked(fields, SCHEDULE_FIELD, said_schedule(said))
    if source is not None:
        fields.update(dict.fromkeys(SCHEDULE_FIELDS) | source)
    carry_attributes(fields, left)
    return fields


def _instance(ctx: ReadContext, element: etree._Element) -> Fields:
    left = attributes(element)
    fields: Fields = {"name": take_required(ctx, element, left, "name")}
    # TC6 1.01 calls the attribute "type"
    type_name = left.pop("type", None) if ctx.version.first_generation else left.pop("typeName", None)
    fields["type_name"] = type_name or ""
    for child in element:
        read_common(ctx, fields, child, ctx.tags.get(child.tag), "pouInstance")
    fields.update(marked(fields, INSTANCE_FIELD, {name: fields[name] for name in ("name", "type_name")}) or {})
    carry_attributes(fields, left)
    return fields
