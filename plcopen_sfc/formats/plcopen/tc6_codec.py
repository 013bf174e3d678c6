"""PLCopen TC6 XML in the table of formats: projects from bytes and as a tree, and the lines of objects.

The flavour for Beremiz, OpenPLC and the readers that share their code is TC6 2.01. Its charts are drawn plainly
(`plcopen_sfc.drawing`): wires with points, no branches that end in nothing but a jump, no nested bars of one kind,
conditions inline, POUs in ``types``. What their converter and matiec do not execute, `formats.matiec` has put into
other terms, or refused, before it is written.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from datetime import datetime
from types import MappingProxyType

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.matiec.matiec_declarations import quote_strings
from plcopen_sfc.formats.matiec.matiec_project import fit_project
from plcopen_sfc.formats.plcopen.source_marks import is_added_configuration, is_added_pou
from plcopen_sfc.formats.plcopen.tc6_bodies import read_pou, write_pou
from plcopen_sfc.formats.plcopen.tc6_chart_writer import unchanged_symbols
from plcopen_sfc.formats.plcopen.tc6_configurations import read_configuration, write_configuration
from plcopen_sfc.formats.plcopen.tc6_declarations import read_data_type_declaration, write_data_type_declaration
from plcopen_sfc.formats.plcopen.tc6_networks import TAGS
from plcopen_sfc.formats.plcopen.tc6_reading import (
    APPLICATION_FIELD,
    Fields,
    Tc6ReadContext,
    ToolData,
    decimal_or_none,
    keep_attributes,
    keep_element,
    read_common,
    read_text,
)
from plcopen_sfc.formats.plcopen.tc6_versions import (
    NO_TIME,
    V2_01,
    XHTML,
    Tc6Version,
    find_version,
    validate_tc6,
    version_named,
)
from plcopen_sfc.formats.plcopen.tc6_writing import (
    Tc6Dialect,
    Tc6WriteContext,
    add_child,
    decimal,
    finish_element,
    write_text,
)
from plcopen_sfc.formats.xml.extension_data import attributes, extension_data, misfit
from plcopen_sfc.formats.xml.xml_codec import XmlCodec, XmlStyle
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, line_of, parse_xml
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.project import Configuration, Project, Scaling
from plcopen_sfc.model.sfc import Body, SfcBody, SfcNetwork
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.whole_numbers import xml_number

_PLAIN = ToolData()


def load_tc6(data: bytes, tool: ToolData = _PLAIN, *, file: str | None = None) -> ReadResult:
    """Read a TC6 file, with the data of a tool. Raises `FormatError` where it cannot be read at all."""
    with collecting_rarely():
        root = parse_xml(data, file=file)
        ctx = Tc6ReadContext(find_version(root, file=file), tool, file=file, lines=SourceLines(root, data))
        fields = _read_project(ctx, root)
        try:
            project = Project.model_validate(fields)
        except ValidationError as error:
            raise misfit(error, fields, root, file=file, lines=ctx.lines) from error
    return ReadResult(project, ctx.diagnostics, ctx.version.name)


def _read_project(ctx: Tc6ReadContext, root: etree._Element) -> Fields:
    fields: Fields = {"configurations": [], "applications": [], "pous": ctx.pous, "data_types": ctx.data_types}
    for child in root:
        local = ctx.tags.get(child.tag)
        reader = _PROJECT_READERS.get(local or "")
        if reader is not None:
            reader(ctx, child, fields)
        else:
            read_common(ctx, fields, child, local, "project")
    if ctx.global_variables:
        fields["global_variables"] = [*fields.get("global_variables", ()), *ctx.global_variables]
    for required in ("fileHeader", "contentHeader", "types", "instances"):
        if root.find(ctx.version.qualified[required]) is None:
            ctx.error("XML207", f"<project> has no <{required}>", root)
    keep_attributes(fields, attributes(root))
    return fields


_FILE_HEADER = {
    "companyName": "company",
    "companyURL": "company_url",
    "productName": "product",
    "productVersion": "version",
    "productRelease": "release",
    "creationDateTime": "created",
    "contentDescription": "description",
}
_CONTENT_HEADER = {
    "name": "name",
    "version": "version",
    "modificationDateTime": "modified",
    "organization": "organization",
    "author": "author",
    "language": "language",
}
"""Attributes of the two headers, and the fields with them."""


def _read_file_header(ctx: Tc6ReadContext, element: etree._Element, fields: Fields) -> None:
    left = attributes(element)
    header: Fields = {field: left.pop(name) for name, field in _FILE_HEADER.items() if name in left}
    if header.get("created") == NO_TIME:
        del header["created"]
    if left:
        extension_data(header)["attributes"].update(left)
    for child in element:
        keep_element(ctx, header, child)
    fields["header"] = header


def _read_content_header(ctx: Tc6ReadContext, element: etree._Element, fields: Fields) -> None:
    left = attributes(element)
    content: Fields = {}
    fields.update({field: left.pop(name) for name, field in _CONTENT_HEADER.items() if name in left})
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "Comment":
            fields["content_comment"] = child.text or ""
        elif local == "coordinateInfo":
            fields["scales"] = _read_scales(ctx, child)
        elif local == "addDataInfo":
            fields["foreign_data_infos"] = [_read_info(ctx, info) for info in child if ctx.tags.get(info.tag) == "info"]
        else:
            read_common(ctx, content, child, local, "contentHeader")
    if left:
        extension_data(content)["attributes"].update(left)
    if "extension_data" in content:
        fields["content_extension_data"] = content["extension_data"]


def _read_scales(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    scales: Fields = {}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "pageSize":
            scales["page"] = _read_scale(child)
        elif local in ("fbd", "ld", "sfc"):
            for scaling in child:
                if ctx.tags.get(scaling.tag) == "scaling":
                    scales[local] = _read_scale(scaling)
    return scales


def _read_scale(element: etree._Element) -> Fields:
    return {"x": decimal_or_none(element.get("x")) or 0, "y": decimal_or_none(element.get("y")) or 0}


def _read_info(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    info: Fields = {
        "name": element.get("name", ""),
        "vendor": element.get("vendor", ""),
        "version": element.get("version"),
    }
    for child in element:
        if ctx.tags.get(child.tag) == "description":
            info["description"] = read_text(ctx, child)
    return info


def _read_types(ctx: Tc6ReadContext, element: etree._Element, fields: Fields) -> None:
    for child in element:
        local = ctx.tags.get(child.tag)
        for part in child if local in ("dataTypes", "pous") else ():
            kind = ctx.tags.get(part.tag)
            if kind == "dataType" and local == "dataTypes":
                ctx.data_types.append(read_data_type_declaration(ctx, part, ""))
            elif kind == "pou" and local == "pous":
                pou = read_pou(ctx, part, "")
                if not is_added_pou(pou):
                    ctx.pous.append(pou)
            else:
                keep_element(ctx, fields, part)
        if local not in ("dataTypes", "pous"):
            keep_element(ctx, fields, child)


def _read_instances(ctx: Tc6ReadContext, element: etree._Element, fields: Fields) -> None:
    for child in element:
        if ctx.tags.get(child.tag) != "configurations":
            keep_element(ctx, fields, child)
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
                keep_element(ctx, fields, part)


_PROJECT_READERS = {
    "fileHeader": _read_file_header,
    "contentHeader": _read_content_header,
    "types": _read_types,
    "instances": _read_instances,
}


_HEADERS = frozenset(
    {"header", "content_comment", "content_extension_data", "scales", "foreign_data_infos", *_CONTENT_HEADER.values()}
)
_TIME = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?(Z|[+-]\d\d:\d\d)?")


def write_project(
    project: Project,
    dialect: Tc6Dialect,
    report: ConversionReport,
    options: WriteOptions,
    texts: Mapping[int, str | None] = MappingProxyType({}),
) -> etree._Element:
    """Return the tree of the file for `project`; what becomes of each item goes into `report`.

    `texts` are declarations as text to write instead of those of objects, by their `id()`; None is left out.
    """
    ctx = Tc6WriteContext(dialect, report, project, options, texts)
    nsmap: dict[str | None, str] = {None: dialect.version.namespace}
    if dialect.declares_xhtml:
        nsmap["xhtml"] = XHTML
    root = etree.Element(ctx.names["project"], nsmap=nsmap)  # type: ignore[arg-type]  # lxml-stubs: str keys only
    _write_file_header(ctx, root, project)
    _write_content_header(ctx, root, project)
    hidden = dialect.native_fields.get("resource", frozenset())
    types = add_child(ctx, root, "types")
    data_types = add_child(ctx, types, "dataTypes")
    for declaration in project.data_types:
        if not declaration.place or "place" not in hidden:
            write_data_type_declaration(ctx, data_types, declaration, in_place=not declaration.place)
    pous = add_child(ctx, types, "pous")
    for pou in project.pous:
        if not pou.place or "place" not in hidden:
            write_pou(ctx, pous, pou, in_place=not pou.place)
    instances = add_child(ctx, root, "instances")
    configurations = add_child(ctx, instances, "configurations")
    for configuration in project.configurations:
        write_configuration(ctx, configurations, configuration)
    if "applications" not in dialect.native_fields.get("project", frozenset()):
        for application in project.applications:
            holder = Configuration(name=application.name, resources=[application])
            write_configuration(ctx, configurations, holder, is_application=True)
    # the format has its dialect
    native = _HEADERS | {"data_types", "pous", "configurations", "applications", "dialect"}
    if project.header.created != _time(ctx, project.header.created) or (
        project.header.extension_data is not None and not ctx.takes_markup
    ):
        native = native - {"header"}
    if project.modified is not None and project.modified != (_time(ctx, project.modified) or None):
        native = native - {"modified"}
    if ctx.version.first_generation:
        native = native - {"content_extension_data", "foreign_data_infos"}
    finish_element(ctx, root, project, "project", native, documents=not ctx.version.first_generation)
    return root


def _time(ctx: Tc6WriteContext, text: str) -> str:
    """Return a time as the schema wants it: some tools write ``2007-07-07 11:58:26``. Empty for what is no time.

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


def _write_file_header(ctx: Tc6WriteContext, root: etree._Element, project: Project) -> None:
    header = project.header
    marks = {name: getattr(header, field) for name, field in _FILE_HEADER.items()}
    marks["creationDateTime"] = _time(ctx, header.created) or NO_TIME
    element = add_child(ctx, root, "fileHeader", marks)
    if header.extension_data is not None and ctx.takes_markup:
        for name, value in header.extension_data.attributes.items():
            element.set(name, value)


def _write_content_header(ctx: Tc6WriteContext, root: etree._Element, project: Project) -> None:
    marks = {name: getattr(project, field) for name, field in _CONTENT_HEADER.items()}
    marks["modificationDateTime"] = _time(ctx, project.modified or "") or None
    element = add_child(ctx, root, "contentHeader", marks)
    if project.content_comment is not None:
        add_child(ctx, element, "Comment").text = project.content_comment
    scales = project.scales
    coordinates = add_child(ctx, element, "coordinateInfo")
    if scales.page is not None:
        add_child(ctx, coordinates, "pageSize", _written_scale(scales.page))
    for name, scale in (("fbd", scales.fbd), ("ld", scales.ld), ("sfc", scales.sfc)):
        add_child(ctx, add_child(ctx, coordinates, name), "scaling", _written_scale(scale))
    if project.foreign_data_infos is not None and not ctx.version.first_generation:
        infos = add_child(ctx, element, "addDataInfo")
        for info in project.foreign_data_infos:
            marks = {"name": info.name, "version": info.version, "vendor": info.vendor}
            write_text(ctx, add_child(ctx, infos, "info", marks), "description", info.description)
    content = Project(extension_data=project.content_extension_data)
    finish_element(ctx, element, content, "contentHeader", frozenset(), documents=False)


def _written_scale(scale: Scaling) -> dict[str, str]:
    return {"x": decimal(scale.x), "y": decimal(scale.y)}


class Tc6Codec(XmlCodec):
    """PLCopen TC6 XML, and what its dialects share."""

    pou_tag = "pou"

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        reading = load_tc6(data, file=file)
        if reading.project.header.is_of_beremiz:  # which writes the values of strings without quotes, none by a name
            quote_strings(reading.project, frozenset())
        return reading

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        return source_lines(content, project)

    def fit(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Change `project`, a copy, into what Beremiz and OpenPLC execute."""
        fit_project(project, options, report, keeps_drawings=True)
        if (
            not project.header.is_of_beremiz
        ):  # readers learn the tool from the header; its product stays (decision 0020)
            project.header = project.header.model_copy(update={"release": "for Beremiz"})
            report.add(
                Outcome.TRANSLATED, "header", "", "its release is `for Beremiz`, so that runs obey the rules of that"
            )

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        if options.flavour == "beremiz":
            for place in project.charts():
                _wire_convergences_to_steps(place.chart)
            return write_project(project, BEREMIZ, report, options)
        version = version_named(options.version) or V2_01
        return write_project(project, Tc6Dialect(version), report, options)

    def unchanged_symbols(self, before: SfcNetwork, after: SfcNetwork) -> frozenset[int]:
        return unchanged_symbols(before, after)

    def style(self) -> XmlStyle:
        """As Beremiz and OpenPLC write: UTF-8 without a mark, LF, two blanks, ``<a/>``."""
        return XmlStyle(encoding="utf-8", newline="\n", self_closing="/>", final_newline=True)

    def validate(self, content: bytes, *, file: str | None = None) -> list[Diagnostic]:
        return validate_tc6(content, file=file)


def _wire_convergences_to_steps(chart: SfcNetwork) -> None:
    """Let simultaneous convergences begin at steps, also at such with other transitions.

    The converter of Beremiz takes what a convergence is wired to for a step: a divergence between them ends it with an
    error (tried with the one of OpenPLC).
    """
    if chart.drawing is None:
        return
    symbols = chart.drawing.symbols
    divergences = {each.id: each for each in symbols if each.kind is SymbolKind.SELECTION_DIVERGENCE}
    for bar in (each for each in symbols if each.kind is SymbolKind.SIMULTANEOUS_CONVERGENCE):
        for wire in (wire for pin in bar.inputs for wire in pin.connections):
            while wire.source in divergences:
                wire.source = divergences[wire.source].inputs[0].connections[0].source
    led = {wire.source for each in symbols for pin in each.inputs for wire in pin.connections}
    chart.drawing.symbols = [each for each in symbols if each.id not in divergences or each.id in led]


CODEC = Tc6Codec()


BEREMIZ = Tc6Dialect(version=V2_01)


def source_lines(content: bytes, project: Project) -> dict[str, int]:
    """Return the line of each object of `project` in `content`, by the path that a `ConversionReport` gives it."""
    root = parse_xml(content)
    version = find_version(root)
    lines: dict[str, int] = {}
    for declared in root.iter(version.qualified["dataType"]):
        _note(lines, f"type {declared.get('name')}", declared)
    pous = {pou.name: pou for pou in project.pous}
    for element in root.iter(version.qualified["pou"]):
        pou = pous.get(element.get("name", ""))
        if pou is None:
            continue
        path = f"POU {pou.name}"
        _note(lines, path, element)
        for variable in element.iterfind(f"{version.qualified['interface']}/*/{version.qualified['variable']}"):
            _note(lines, f"{path} / {variable.get('name')}", variable)
        _chart(lines, path, element, pou.body, version)
        for group, bodies in (
            ("action", {part.name: part.body for part in pou.actions}),
            ("transition", {part.name: part.body for part in pou.transitions}),
        ):
            for part in element.iterfind(f"{version.qualified[group + 's']}/*"):
                name = part.get("name", "")
                _note(lines, f"{path} / {group} {name}", part)
                _chart(lines, f"{path} / {group} {name}", part, bodies.get(name), version)
    return lines


def _note(lines: dict[str, int], path: str, element: etree._Element) -> None:
    line = line_of(element)
    if line is not None:
        lines.setdefault(path, line)


def _chart(lines: dict[str, int], path: str, owner: etree._Element, body: Body | None, version: Tc6Version) -> None:
    element = owner.find(f"{version.qualified['body']}/{version.qualified['SFC']}")
    if element is None or not isinstance(body, SfcBody):
        return
    found: dict[int, etree._Element] = {}
    for symbol in element.iter():
        local_id = xml_number(symbol.get("localId")) if isinstance(symbol.tag, str) else None
        if local_id is not None:
            found.setdefault(local_id, symbol)
    _add_lines_of_blocks(found, body.chart, version)
    for number, names in _names(body.chart).items():
        for name in names if number in found else ():
            _note(lines, f"{path} / {name}", found[number])


def _add_lines_of_blocks(found: dict[int, etree._Element], chart: SfcNetwork, version: Tc6Version) -> None:
    """Find associations that have no id of their own in the file by their line in their block."""
    for symbol in chart.drawing.symbols if chart.drawing is not None else ():
        block = found.get(symbol.id)
        if symbol.entries and block is not None:
            for entry, action in zip(symbol.entries, block.iterfind(version.qualified["action"]), strict=False):
                if entry.association not in found or entry.local_id is not None:
                    found[entry.association] = action


def _names(chart: SfcNetwork) -> dict[int, list[str]]:
    """Return the names of the objects of a chart in reports, by their id."""
    names = {step.id: [step.name, f"step {step.name}"] for step in chart.steps}
    names |= {transition: [label, f"transition {label}"] for transition, label in chart.labels().items()}
    for node in chart.logic:
        names[node.id] = [f"{TAGS.get(node.kind, node.kind)} {node.id}"]
    for step, association in chart.associations():
        target = association.target or "inline"
        short = f"{step.name} {association.qualifier.value} {target}"
        names[association.id] = [short, f"step {step.name} / action {target}"]
    return names
