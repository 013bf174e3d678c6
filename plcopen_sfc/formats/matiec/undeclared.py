"""What a text uses and does not declare: blocks of libraries, above all. matiec compiles nothing but the text."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.formats.matiec.naming import is_of_library, used_types
from plcopen_sfc.formats.matiec.unit import NOTHING_RIGHT
from plcopen_sfc.languages.names import Names
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import Elementary
from plcopen_sfc.report import ConversionReport, Outcome


def note_undeclared(project: Project, report: ConversionReport) -> None:
    """Report each name that nothing declares, at the first place where it stands."""
    found: dict[str, tuple[str, str]] = {}
    for name, path in (*_types(project), *_programs(project), *_names(project)):
        if not name.upper().startswith(NOTHING_RIGHT):
            found.setdefault(name.casefold(), (name, path))
    for name, path in found.values():
        report.add(Outcome.NOT_EXECUTED, "undeclared name", path, f"nothing in the project declares `{name}`")


def _types(project: Project) -> Iterator[tuple[str, str]]:
    known = {one.name.casefold() for one in (*project.pous, *project.data_types)}
    places = [(one.report_path, one.type) for one in project.data_types]
    for pou in project.pous:
        places += [(f"{pou.report_path} / variable {one.name}", one.type) for one in pou.variables()]
    for path, kind in places:
        yield from (
            (name, path) for name in used_types(kind) if name.casefold() not in known and not is_of_library(name)
        )


def _programs(project: Project) -> Iterator[tuple[str, str]]:
    known = {pou.name.casefold() for pou in project.pous if pou.kind is PouKind.PROGRAM}
    for configuration in project.configurations:
        for resource in configuration.resources:
            for task in resource.tasks:
                instances = [one for one in task.instances if one.type_name.casefold() not in known]
                yield from ((one.type_name, f"task {task.name} / {one.name}") for one in instances)


def _names(project: Project) -> Iterator[tuple[str, str]]:
    for occurrence in Names(project).undeclared():
        name = occurrence.reference.name
        if not is_of_library(name) and name.upper() not in Elementary.__members__:  # BOOL#TRUE
            yield name, occurrence.piece.report_path
