"""Whole files: projects as text, and texts as projects."""

from __future__ import annotations

import re
from collections import Counter

from pydantic import ValidationError

from plcopen_sfc.errors import StructureError
from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.iectext.chart_text_reader import apply_change
from plcopen_sfc.formats.iectext.pou_text_reader import read_pou
from plcopen_sfc.formats.iectext.pou_text_writer import write_pou
from plcopen_sfc.formats.iectext.text_configurations import (
    read_configuration,
    read_global_section,
    write_application,
    write_configuration,
    write_global_section,
)
from plcopen_sfc.formats.iectext.text_declarations import read_listing, read_types, write_type_text
from plcopen_sfc.formats.iectext.text_outline import POUS, PartKind, TextPart, outline
from plcopen_sfc.formats.iectext.text_printing import TextPrinter, comment_lines, pragmas, split
from plcopen_sfc.formats.iectext.text_source import Annotations, TextSource, newlines, unwrapped, wrapped
from plcopen_sfc.formats.matiec.matiec_declarations import variable_names
from plcopen_sfc.formats.text_patch import WrittenBlock, numbered_blocks
from plcopen_sfc.languages.declarations import write_config_section
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.pragmas import Fields, RemainderEntry, changes, plain_fields
from plcopen_sfc.languages.pragmas.remainder import Append, Named
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.model.variables import ConfigSection
from plcopen_sfc.report import ConversionReport, Outcome

_DIALECT = re.compile(r"\{\s*plcopen_sfc\s+project\.dialect\s*:=\s*'(\w+)'\s*\}")


def read_project(text: str, file: str | None) -> tuple[Project, TextSource]:
    """Read the project of a text."""
    src = TextSource(outline(text, dialect_of(text)), file)
    for problem in src.outline.structure:
        src.note("IEC101", problem.message, problem.span[0])
    annotations = Annotations()
    fields: Fields = {}
    pous: list[Pou] = []
    position = 0
    for part in src.outline.parts:
        gap = (_project_changes(src, position, part.start, annotations), part.start)
        position = part.end
        if part.kind in POUS:
            pous.append(read_pou(src, part, gap))
        else:
            _read_unit(src, part, gap, fields)
    for problem in src.outline.found.problems:  # those in bodies were reported with their bodies
        if not any(start <= problem.span[0] < end for start, end in src.checked):
            src.note("IEC100", problem.message, problem.span[0])
    annotations.extend(src.annotations(position, len(text)))
    annotations.put_into(fields)
    for found, offset in annotations.changes:
        if found.path[0] == "project" and len(found.path) > 1:
            apply_change(src, fields, (RemainderEntry(found.path[1:], found.value, found.instead), offset), "project")
    try:
        project = Project.model_validate(fields | {"pous": pous})
    except ValidationError as error:
        first = error.errors()[0]
        message = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        path = ("project", *first["loc"])
        offsets = (offset for found, offset in annotations.changes if found.path == path[: len(found.path)])
        raise StructureError(message, location=src.location(next(offsets, 0))) from error
    return project, src


def _read_unit(src: TextSource, part: TextPart, gap: tuple[int, int], fields: Fields) -> None:
    if part.kind is PartKind.TYPE:
        fields.setdefault("data_types", []).extend(_read_types(src, part, gap))
    elif part.kind is PartKind.VAR and part.keyword == "VAR_CONFIG":
        for section in read_listing(src, part, gap, ""):
            known = fields.setdefault("config_variables", section)
            if known is not section:
                known.setdefault("variables", []).extend(section.get("variables", []))
    elif part.kind is PartKind.VAR and part.keyword == "VAR_GLOBAL":
        fields.setdefault("global_variables", []).extend(read_global_section(src, part, gap, ""))
    elif part.kind is PartKind.CONFIGURATION:
        found, application = read_configuration(src, part, gap)
        also = found.keys() - {"name", "resources"}
        if application and len(found.get("resources", ())) == 1 and not also:
            fields.setdefault("applications", []).extend(found["resources"])
        else:
            fields.setdefault("configurations", []).append(found)
    else:
        if part.kind is PartKind.LOOSE:
            src.note("IEC107", "this belongs to no unit: PROGRAM, FUNCTION_BLOCK, FUNCTION, TYPE ..", part.start)
        data = wrapped("unit", newlines(src.text[gap[0] : part.end]).strip())
        fields.setdefault("carried", {}).setdefault("data", []).append(data)


def _read_types(src: TextSource, part: TextPart, gap: tuple[int, int]) -> list[Fields]:
    types = read_types(src, part, gap)
    annotations = src.annotations(*gap)
    for fields in types[:1]:
        typed = [c for c, _ in annotations.changes if c.path == ("declaration_ends",)]
        if typed:
            start = src.core(*gap)[0]
            start += len(src.text[start : part.start]) - len(src.text[start : part.start].lstrip())
            fields["declaration"] = newlines(src.text[start : part.end]) + str(typed[0].value)
        for found in annotations.changes:
            if found[0].path != ("declaration_ends",):
                apply_change(src, fields, found, f"data type {fields.get('name', '')}")
    return types


def _project_changes(src: TextSource, start: int, end: int, annotations: Annotations) -> int:
    """Take the pragmas about the project, and return where the rest of the gap begins."""
    for comment in src.outline.comments(start, end):
        found = src.annotations(*comment.span)
        if not found.changes or found.changes[0][0].path[0] not in ("project", "format"):
            break
        annotations.extend(found)
        start = comment.span[1]
    return start


def dialect_of(text: str) -> Dialect:
    """Return the dialect that a text gives as its own."""
    found = _DIALECT.search(text)
    try:
        return Dialect(found.group(1)) if found is not None else Dialect.IEC
    except ValueError:
        return Dialect.IEC


VERSION = 1
_UNITS = frozenset({"pous", "data_types", "global_variables", "configurations", "applications", "config_variables"})


def write_project(project: Project, _options: WriteOptions, report: ConversionReport) -> WrittenBlock:
    """Return the text of a project."""
    printer = TextPrinter(project.dialect, report, variables=frozenset(variable_names(project)))
    read_back: Fields = {}
    intended = plain_fields(project, leave=_UNITS)
    foreign = _foreign_units(intended, read_back)
    found = [RemainderEntry(("project", *c.path), c.value, c.instead) for c in changes(read_back, intended)]
    for change in found:
        printer.note(
            Outcome.EXTENSION_DATA, str(change.path[1]).replace("_", " "), "project", "IEC text has no place for it"
        )
    near, late = split(found)
    late += [change for change in near if Append() in change.path]
    near = [change for change in near if Append() not in change.path]
    pieces = [WrittenBlock(("head", ""), pragmas([RemainderEntry(("format",), VERSION), *near], "").rstrip("\n"))]
    pieces += [WrittenBlock(("unit", ""), text, apart=True) for text in foreign]
    names = Counter(one.name.casefold() for one in project.data_types)
    for declaration in project.data_types:
        text = _type(printer, declaration, late, unique=names[declaration.name.casefold()] == 1)
        pieces.append(WrittenBlock(("type", declaration.name), text, apart=True))
    for section in project.global_variables:
        text = write_global_section(printer, section, "").rstrip("\n")
        pieces.append(WrittenBlock(("global variables", section.name or ""), text, apart=True))
    pieces += [write_pou(printer, pou) for pou in project.pous]
    for configuration in project.configurations:
        text = write_configuration(printer, configuration)
        pieces.append(WrittenBlock(("configuration", configuration.name), text, apart=True))
    for application in project.applications:
        text = write_application(printer, application)
        pieces.append(WrittenBlock(("configuration", application.name), text, apart=True))
    if project.config_variables is not None:
        text = _config_section(printer, project.config_variables, late)
        pieces.append(WrittenBlock(("VAR_CONFIG", ""), text, apart=True))
    if late:
        pieces.append(WrittenBlock(("late", ""), pragmas(late, "").rstrip("\n"), apart=True))
    return WrittenBlock(("project", ""), blocks=numbered_blocks(pieces))


def _foreign_units(intended: Fields, read_back: Fields) -> list[str]:
    """Units that the model has no place for, as they were read."""
    texts: list[str] = []
    for data in intended.get("carried", {}).get("data", []):
        kept = unwrapped(data.get("content", ""))
        if kept is None or kept[0] != "unit":
            continue
        known = read_back.get("carried", {}).get("data", [])
        back = read_project("\n\n".join([*texts, kept[1], ""]), None)[0].carried
        if back is not None and [one.content for one in back.data] == [one["content"] for one in (*known, data)]:
            texts.append(kept[1])
            read_back["carried"] = {"data": [*known, data]}
    return texts


def _config_section(printer: TextPrinter, section: ConfigSection, late: list[RemainderEntry]) -> str:
    """``VAR_CONFIG`` outside of a configuration; empty where it does not come back from text."""
    intended = plain_fields(section)
    text = comment_lines(intended, {}, "") if str(intended.get("comment", "")).strip() else ""
    text += write_config_section(section, printer.dialect)
    back, src = read_project(
        f"{pragmas([RemainderEntry(('project', 'dialect'), str(printer.dialect))], '')}{text}\n", None
    )
    if back.config_variables is None or src.diagnostics:
        late.append(RemainderEntry(("project", "config_variables"), intended))
        return ""
    late += changes(plain_fields(back.config_variables), intended, ("project", "config_variables"))
    return text


def _type(printer: TextPrinter, declaration: DataTypeDeclaration, late: list[RemainderEntry], *, unique: bool) -> str:
    text, read_back, intended = write_type_text(printer, declaration)
    printer.note(Outcome.KEPT, "data type", f"data type {declaration.name}")
    near, far = split(changes(read_back, intended))
    if unique:
        place = ("project", "data_types", Named(declaration.name))
        late += [RemainderEntry((*place, *change.path), change.value, change.instead) for change in far]
    else:
        near += far
    return pragmas(near, "") + text
