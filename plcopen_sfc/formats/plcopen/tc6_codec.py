"""PLCopen TC6 XML in the table of formats: reading, writing, the tree for patching, and the lines of objects.

The flavour for Beremiz, OpenPLC and the readers that share their code is TC6 2.01. Its charts are drawn plainly
(`plcopen_sfc.drawing`): wires with points, no branches that end in nothing but a jump, no nested bars of one kind,
conditions inline, POUs in ``types``. What their converter and matiec do not execute, `formats.matiec` has put into
other terms, or refused, before it is written.
"""

from __future__ import annotations

from typing import ClassVar

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.formats.format_interface import Marks, ReadResult, WriteOptions
from plcopen_sfc.formats.matiec.matiec_project import fit_project
from plcopen_sfc.formats.plcopen.chart_hosts import TC6_CHARTS, ChartHost
from plcopen_sfc.formats.plcopen.project_rewriting import is_rewritten, rewrite_project
from plcopen_sfc.formats.plcopen.tc6_networks import TAGS
from plcopen_sfc.formats.plcopen.tc6_project import load_tc6, write_project
from plcopen_sfc.formats.plcopen.tc6_reading import line_of, whole_number
from plcopen_sfc.formats.plcopen.tc6_versions import V2_01, Tc6Version, find_version, validate_tc6, version_named
from plcopen_sfc.formats.plcopen.tc6_writing import Tc6Dialect
from plcopen_sfc.formats.xml.xml_codec import XmlCodec, XmlStyle
from plcopen_sfc.formats.xml.xml_parsing import parse_xml
from plcopen_sfc.languages.s7_flip_flops import put_logic
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.report import ConversionReport


class Tc6Codec(XmlCodec):
    """PLCopen TC6 XML, and what its dialects share; `host` has the abilities of the charts of the tool."""

    host: ClassVar[ChartHost] = TC6_CHARTS

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file of any TC6 version. Raises `FormatError`."""
        return load_tc6(data, file=file)

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        """Return the line of each object of `project` in the file `content`, by the path that the report gives it."""
        return source_lines(content, project)

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Replace flip-flop boxes with an operand, which only TIA Portal has, by logic."""
        put_logic(project, report)

    def rewrite(self, project: Project, options: WriteOptions, report: ConversionReport) -> tuple[Project, Marks]:
        """Return a copy of `project` in terms of the tool, and what the reader restores the source from."""
        return rewrite_project(project, self.host, options, report)

    def is_rewritten(self, project: Project, content: bytes) -> bool:
        """True if the file `content` of `project` holds what was rewritten, or an edit made that necessary."""
        return is_rewritten(project, content, self.host)

    def fit(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Change `project`, a copy, into what Beremiz and OpenPLC execute."""
        fit_project(project, options, report, keeps_drawings=True)

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """Return the tree of the file for `project`."""
        if options.flavour == "beremiz":
            return write_project(project, BEREMIZ, report, options)
        version = version_named(options.version) or V2_01
        return write_project(project, Tc6Dialect(version), report, options)

    def style(self) -> XmlStyle:
        """As Beremiz and OpenPLC write: UTF-8 without a mark, LF, two blanks, ``<a/>``."""
        return XmlStyle(encoding="utf-8", newline="\n", self_closing="/>", final_newline=True)

    def validate(self, content: bytes, *, file: str | None = None) -> list[Diagnostic]:
        """Return the errors of a file by the schema of the format."""
        return validate_tc6(content, file=file)


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
        local_id = whole_number(symbol.get("localId")) if isinstance(symbol.tag, str) else None
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
