"""Checks of a project before it is saved: what a script can build and no file can hold.

A file that was read may hold it all the same. So only what is not in the source of the project is refused.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

from plcopen_sfc.documents.sources import FileSource, FolderSource
from plcopen_sfc.errors import Location, ModelError
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.languages.words import IEC_KEYWORDS, is_plain
from plcopen_sfc.model import times
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork


class Mistake(NamedTuple):
    """Something that cannot be saved, and the path of the object that has it."""

    path: str
    message: str


def refuse_mistakes(project: Project, kind: Format) -> None:
    """Raise `ModelError` for ids that two objects have, times that are none, and names that the target cannot have."""
    found = set(_mistakes(project, kind))
    if not found:
        return
    for source in _sources(project):
        before = format_named(source.format)[0].codec().read(source.content).project
        before.read_all()
        found -= set(_mistakes(before, kind))
    if found:
        first, *others = sorted(found)
        more = f" (and {len(others)} more of such mistakes)" if others else ""
        raise ModelError(f"{first.message}{more}", location=Location(path=first.path), hint="Nothing was written.")


def _sources(project: Project) -> list[FileSource]:
    source = project.source
    if isinstance(source, FolderSource):
        return [document.source for document in source.documents.values()]
    return [source] if isinstance(source, FileSource) else []


def _mistakes(project: Project, kind: Format) -> Iterator[Mistake]:
    """Yield the mistakes in what was read of a project; what is unread is as it is in its file."""
    # in SCL any name can be in quotes; writers of text replace names and report that
    names = kind.xml and Dialect.SCL not in (kind.dialect, project.dialect)
    for pou in project.pous:
        if pou.is_unread:
            continue
        if names:
            yield from _names(pou)
        for body in pou.named_bodies():
            chart = getattr(body.body, "chart", None)
            if isinstance(chart, SfcNetwork) and not chart.is_unread:
                yield from _chart_mistakes(chart, pou.report_path_of(body.name), names=names)


def _names(pou: Pou) -> Iterator[Mistake]:
    yield from _name(pou.name, pou.report_path)
    for kind, things in (("action", pou.actions), ("method", pou.methods), ("variable", pou.variables())):
        for thing in things:
            yield from _name(thing.name, f"{pou.report_path} / {kind} {thing.name}")


def _name(name: str, path: str) -> Iterator[Mistake]:
    if not is_plain(name):
        yield Mistake(path, f"{name!r} is no name: it needs letters, digits and underscores, and no digit at the start")
    elif name.upper() in IEC_KEYWORDS:
        yield Mistake(path, f"{name!r} is a keyword and no name")


def _chart_mistakes(chart: SfcNetwork, path: str, *, names: bool) -> Iterator[Mistake]:
    things = [(step.id, f"step {step.name}") for step in chart.steps]
    labels = chart.labels()
    things += [(each.id, f"transition {labels[each.id]}") for each in chart.transitions]
    things += [(node.id, f"element {node.kind}") for node in chart.logic]
    counts = Counter(number for number, _ in things)
    for number, thing in things:
        if counts[number] > 1:
            yield Mistake(f"{path} / {thing}", f"the id {number} belongs to another object of the chart too")
    for step in chart.steps:
        place = f"{path} / step {step.name}"
        if names:
            yield from _name(step.name, place)
        stated = [(name, getattr(step, name)) for name in step.TIMES]
        stated += [("duration", each.duration) for each in step.actions]
        for name, value in stated:
            why = times.objection(value) if value is not None else ""
            if why and times.objection(f"T#{value}"):  # files of TC6 have 10s
                yield Mistake(place, f"the {name.replace('_', ' ')} {value!r} cannot be saved: {why}")
