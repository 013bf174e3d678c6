"""Lines of objects in files whose charts are archives, by the paths that reports give them."""

from __future__ import annotations

from collections.abc import Callable

from lxml import etree

from plcopen_sfc.formats.archives.chart_elements import STEP, TRANSITION
from plcopen_sfc.formats.archives.object_archive import member, number_of, type_of
from plcopen_sfc.formats.archives.object_elements import LineAt, declaration_in, line_below
from plcopen_sfc.formats.iectext.iectext_codec import source_lines
from plcopen_sfc.formats.iectext.object_declarations import unit_of
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcBody, SfcNetwork

Line = Callable[[etree._Element], int | None]
"""Returns the line of an element of the file."""


def object_lines(thing: etree._Element, project: Project, line: Line, line_at: LineAt = line_below) -> dict[str, int]:
    """Return the lines of an object of `project`, of what it declares, and of its steps and transitions."""
    found: dict[str, int | None] = {}
    declaration = declaration_in(thing)
    if declaration is not None:
        declared = source_lines(unit_of(declaration).around(declaration))
        found = {path: line_at(thing, number - 1) for path, number in declared.items()}
    for pou in project.pous if thing.tag == "POU" else ():
        if pou.name != thing.get("Name"):
            continue
        owners = {
            f"{pou.name}.{part.get('Name')}": part for part in thing.iterchildren("Action", "Method", "Transition")
        }
        for name, _, body in pou.named_bodies():
            path, owner = pou.report_path_of(name), owners.get(name, thing)
            found.setdefault(path, line(owner))
            if isinstance(body, SfcBody):
                _note_chart(found, path, owner, body.chart, line)
    return {path: number for path, number in found.items() if number is not None}


def _note_chart(found: dict[str, int | None], path: str, owner: etree._Element, chart: SfcNetwork, line: Line) -> None:
    """Note the steps and transitions of a chart, whose elements have the ids of the model as their numbers."""
    paths = {step.id: f"{path} / step {step.name}" for step in chart.steps}
    paths |= {number: f"{path} / transition {label}" for number, label in chart.labels().items()}
    for each in owner.iterfind("Implementation/SFC/XmlArchive/Data//o"):
        number = number_of(member(each, "Id")) if type_of(each) in (STEP, TRANSITION) else None
        if number in paths:
            found.setdefault(paths[number], line(each))
