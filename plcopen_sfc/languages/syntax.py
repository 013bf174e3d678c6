"""What does not parse in the bodies, conditions and declarations of a project."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.languages.binding.text_sites import TextKind, TextSite, text_sites
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.locating import TextFinder
from plcopen_sfc.languages.st import Parsed, parse_condition, parse_declarations, parse_expression, parse_statements
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.project import Project


def syntax_problems(project: Project, *, file: str | None = None, finder: TextFinder | None = None) -> list[Diagnostic]:
    """Every syntax error, with its line and column in its text and, with a `finder`, in the file as well."""
    found: list[Diagnostic] = []
    for text_site, parsed in _parsed(project):
        if not parsed.problems:
            continue
        offsets = [problem.span[0] for problem in parsed.problems]
        places = finder.places(text_site.text, offsets) if finder is not None else None
        for index, problem in enumerate(parsed.problems):
            line, column = parsed.place(offsets[index])
            file_line, file_column = places[index] if places is not None else (None, None)
            where = f"{text_site.path}, line {line}, column {column}"
            location = Location(file, file_line, file_column, where)
            found.append(Diagnostic("LNG101", Severity.ERROR, problem.message, location))
    return found


def _parsed(project: Project) -> Iterator[tuple[TextSite, Parsed[Any]]]:
    for text_site in text_sites(project):
        if text_site.reading is TextKind.STATEMENTS:
            yield text_site, _statements(text_site.text, project.dialect)
        elif text_site.is_program_text:
            parse = parse_condition if isinstance(text_site.holder, Expression) else parse_expression
            yield text_site, parse(text_site.text, project.dialect)
        elif text_site.reading is TextKind.DECLARATIONS:
            yield text_site, parse_declarations(text_site.text, project.dialect)


def _statements(text: str, dialect: Dialect) -> Parsed[Any]:
    """Statements, or the condition that the body of a transition may be."""
    parsed = parse_statements(text, dialect)
    if not parsed.problems:
        return parsed
    condition = parse_condition(text, dialect)
    return parsed if condition.problems else condition
