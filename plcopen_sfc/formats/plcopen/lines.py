"""Where the objects of a project stand in their TC6 file."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.plcopen.logic_reader import TAGS
from plcopen_sfc.formats.plcopen.project_reader import find_version
from plcopen_sfc.formats.plcopen.reading import line_of
from plcopen_sfc.formats.plcopen.versions import Tc6Version
from plcopen_sfc.formats.xml.xml_parsing import parse
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork


def source_lines(content: bytes, project: Project) -> dict[str, int]:
    """The line of each object of `project` in `content`, by the path that a `ConversionReport` gives it."""
    root = parse(content)
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
        local_id = symbol.get("localId") if isinstance(symbol.tag, str) else None
        if local_id is not None and local_id.isdigit():
            found.setdefault(int(local_id), symbol)
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
    """What the report calls the objects of a chart, by their id."""
    names = {step.id: [step.name, f"step {step.name}"] for step in chart.steps}
    names |= {transition: [label, f"transition {label}"] for transition, label in chart.labels().items()}
    for node in chart.logic:
        names[node.id] = [f"{TAGS.get(node.kind, node.kind)} {node.id}"]
    for step, association in chart.associations():
        target = association.target or "inline"
        short = f"{step.name} {association.qualifier.value} {target}"
        names[association.id] = [short, f"step {step.name} / action {target}"]
    return names
