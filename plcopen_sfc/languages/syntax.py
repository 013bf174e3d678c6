"""What does not parse in the bodies, conditions and declarations of a project."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.locating import TextFinder
from plcopen_sfc.languages.names.pieces import Piece, Reading, pieces
from plcopen_sfc.languages.st import Parsed, parse_condition, parse_declarations, parse_expression, parse_statements
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.project import Project


def syntax_problems(project: Project, *, file: str | None = None, finder: TextFinder | None = None) -> list[Diagnostic]:
    """Every syntax error, with its line and column in its text and, with a `finder`, in the file as well."""
    found: list[Diagnostic] = []
    for piece, parsed in _parsed(project):
        if not parsed.problems:
            continue
        offsets = [problem.span[0] for problem in parsed.problems]
        places = finder.places(piece.text, offsets) if finder is not None else None
        for index, problem in enumerate(parsed.problems):
            line, column = parsed.place(offsets[index])
            file_line, file_column = places[index] if places is not None else (None, None)
            where = f"{piece.path}, line {line}, column {column}"
            location = Location(file, file_line, file_column, where)
            found.append(Diagnostic("LNG101", Severity.ERROR, problem.message, location))
    return found


def _parsed(project: Project) -> Iterator[tuple[Piece, Parsed[Any]]]:
    for piece in pieces(project):
        if piece.reading is Reading.STATEMENTS:
            yield piece, _statements(piece.text, project.dialect)
        elif piece.is_program_text:
            parse = parse_condition if isinstance(piece.holder, Expression) else parse_expression
            yield piece, parse(piece.text, project.dialect)
        elif piece.reading is Reading.DECLARATIONS:
            yield piece, parse_declarations(piece.text, project.dialect)


def _statements(text: str, dialect: Dialect) -> Parsed[Any]:
    """Statements, or the condition that the body of a transition may be."""
    parsed = parse_statements(text, dialect)
    if not parsed.problems:
        return parsed
    condition = parse_condition(text, dialect)
    return parsed if condition.problems else condition
