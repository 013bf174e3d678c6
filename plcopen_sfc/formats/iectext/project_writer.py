"""Writes whole projects. The reader is `project_reader`."""

from __future__ import annotations

from collections import Counter

from plcopen_sfc.formats.base import WriteOptions
from plcopen_sfc.formats.iectext.config_writer import write_application, write_configuration, write_global_section
from plcopen_sfc.formats.iectext.declarations_writer import write_said_type
from plcopen_sfc.formats.iectext.printing import Printer, comment_lines, numbered_pieces, pragmas, split
from plcopen_sfc.formats.iectext.project_reader import read_project
from plcopen_sfc.formats.iectext.source import unwrapped
from plcopen_sfc.formats.iectext.unit_writer import write_pou
from plcopen_sfc.formats.strings import variable_names
from plcopen_sfc.formats.text import Piece
from plcopen_sfc.languages.declarations import write_config_section
from plcopen_sfc.languages.pragmas import Change, Fields, changes, plain_fields
from plcopen_sfc.languages.pragmas.remainder import Append, Named
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.model.variables import ConfigSection
from plcopen_sfc.report import ConversionReport, Outcome

VERSION = 1
_UNITS = frozenset({"pous", "data_types", "global_variables", "configurations", "applications", "config_variables"})


def write_project(project: Project, _options: WriteOptions, report: ConversionReport) -> Piece:
    """The text of a project."""
    printer = Printer(project.dialect, report, variables=frozenset(variable_names(project)))
    said: Fields = {}
    meant = plain_fields(project, leave=_UNITS)
    foreign = _foreign_units(meant, said)
    found = [Change(("project", *c.path), c.value, c.instead) for c in changes(said, meant)]
    for change in found:
        printer.note(Outcome.EXTENSION_DATA, str(change.path[1]).replace("_", " "), "project", "IEC text cannot say it")
    near, late = split(found)
    late += [change for change in near if Append() in change.path]
    near = [change for change in near if Append() not in change.path]
    pieces = [Piece(("head", ""), pragmas([Change(("format",), VERSION), *near], "").rstrip("\n"))]
    pieces += [Piece(("unit", ""), text, apart=True) for text in foreign]
    names = Counter(one.name.casefold() for one in project.data_types)
    for declaration in project.data_types:
        text = _type(printer, declaration, late, unique=names[declaration.name.casefold()] == 1)
        pieces.append(Piece(("type", declaration.name), text, apart=True))
    for section in project.global_variables:
        text = write_global_section(printer, section, "").rstrip("\n")
        pieces.append(Piece(("global variables", section.name or ""), text, apart=True))
    pieces += [write_pou(printer, pou) for pou in project.pous]
    for configuration in project.configurations:
        text = write_configuration(printer, configuration)
        pieces.append(Piece(("configuration", configuration.name), text, apart=True))
    for application in project.applications:
        text = write_application(printer, application)
        pieces.append(Piece(("configuration", application.name), text, apart=True))
    if project.config_variables is not None:
        text = _config_section(printer, project.config_variables, late)
        pieces.append(Piece(("VAR_CONFIG", ""), text, apart=True))
    if late:
        pieces.append(Piece(("late", ""), pragmas(late, "").rstrip("\n"), apart=True))
    return Piece(("project", ""), pieces=numbered_pieces(pieces))


def _foreign_units(meant: Fields, said: Fields) -> list[str]:
    """Units that the model has no place for, as they were read."""
    texts: list[str] = []
    for data in meant.get("carried", {}).get("data", []):
        kept = unwrapped(data.get("content", ""))
        if kept is None or kept[0] != "unit":
            continue
        known = said.get("carried", {}).get("data", [])
        back = read_project("\n\n".join([*texts, kept[1], ""]), None)[0].carried
        if back is not None and [one.content for one in back.data] == [one["content"] for one in (*known, data)]:
            texts.append(kept[1])
            said["carried"] = {"data": [*known, data]}
    return texts


def _config_section(printer: Printer, section: ConfigSection, late: list[Change]) -> str:
    """``VAR_CONFIG`` outside of a configuration; empty where it does not come back from text."""
    meant = plain_fields(section)
    text = comment_lines(meant, {}, "") if str(meant.get("comment", "")).strip() else ""
    text += write_config_section(section, printer.dialect)
    back, src = read_project(f"{pragmas([Change(('project', 'dialect'), str(printer.dialect))], '')}{text}\n", None)
    if back.config_variables is None or src.diagnostics:
        late.append(Change(("project", "config_variables"), meant))
        return ""
    late += changes(plain_fields(back.config_variables), meant, ("project", "config_variables"))
    return text


def _type(printer: Printer, declaration: DataTypeDeclaration, late: list[Change], *, unique: bool) -> str:
    text, said, meant = write_said_type(printer, declaration)
    printer.note(Outcome.KEPT, "data type", f"data type {declaration.name}")
    near, far = split(changes(said, meant))
    if unique:
        place = ("project", "data_types", Named(declaration.name))
        late += [Change((*place, *change.path), change.value, change.instead) for change in far]
    else:
        near += far
    return pragmas(near, "") + text
