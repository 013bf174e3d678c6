"""Texts that cannot be read as they are: syntax errors with their places in the file, and code in C."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.languages.binding.text_sites import SiteKind, TextSite, text_sites
from plcopen_sfc.languages.grafcet_conditions import condition_problem
from plcopen_sfc.languages.il_problems import instruction_problems
from plcopen_sfc.languages.problems import Lines, Problem
from plcopen_sfc.languages.st import (
    parse_body,
    parse_condition,
    parse_declarations,
    parse_expression,
    parse_statements,
)
from plcopen_sfc.languages.st.nodes import EmbeddedCode
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import Dimension

_ESCAPED = {
    "<": "(?:&lt;|<)",
    ">": "(?:&gt;|>)",
    "&": "(?:&amp;|&)",
    '"': '(?:&quot;|"|&#34;)',
    "'": "(?:&apos;|'|&#39;)",
    "\t": "(?:\t|&#x?9;)",
    "\n": "(?:\r\n|\r|\n|&#10;|&#x[Aa];)",
    "\r": "(?:\r|&#13;|&#x[Dd];|)",
}


class TextFinder:
    """Finds texts in `content`, the text of a file: XML, or one that has them unchanged.

    In XML a text fills an element or an attribute; elsewhere it may be a part of anything.

    The same text asked for again is looked for behind the place where it was found before, so that asking in the order
    of the file finds each where it is.
    """

    def __init__(self, content: str, *, xml: bool) -> None:
        self._content = content
        self._around = (r"""(?<=[>"'\[])\s*""", r"""(?=\s*[<"'\]])""") if xml else ("", "")
        self._lines = Lines(content)
        self._found: dict[str, int] = {}

    def places(self, text: str, offsets: Sequence[int]) -> list[tuple[int, int]] | None:
        """Line and column in the file of what is at each of `offsets` in `text`; None if the text is not found."""
        before, after = self._around
        found = re.compile(f"{before}({_pattern(text)}){after}").search(self._content, self._found.get(text, 0))
        if found is None:
            return None
        self._found[text] = found.end()
        return [self._lines.place(self._end_of(text[:offset], found.start(1))) for offset in offsets]

    def _end_of(self, part: str, start: int) -> int:
        found = re.compile(_pattern(part)).match(self._content, start)
        return found.end() if found is not None else start


def _pattern(text: str) -> str:
    return "".join(_ESCAPED.get(character) or re.escape(character) for character in text.replace("\r\n", "\n"))


def embedded_code(project: Project) -> Iterator[str]:
    """Yield the path of each text that has code in C among its statements."""
    if not any(pou.may_mention(("{{",)) for pou in project.pous):
        return  # a walk over all texts takes four times as long
    for text_site in text_sites(project):
        if text_site.reading is SiteKind.STATEMENTS and "{{" in text_site.text:
            tree = parse_statements(text_site.text, project.dialect).tree
            if any(isinstance(node, EmbeddedCode) for node in walk(tree)):
                yield text_site.report_path


def syntax_problems(
    project: Project, *, grafcet: bool = False, file: str | None = None, finder: TextFinder | None = None
) -> list[Diagnostic]:
    """Return every syntax error, with its line and column in its text and, with a `finder`, in the file as well.

    `grafcet`: the conditions are those of GRAFCETs, with edges and times (IEC 60848:2013, 4.6).
    """
    found: list[Diagnostic] = []
    for text_site, problems in _problems(project, grafcet=grafcet):
        if not problems:
            continue
        offsets = [problem.span[0] for problem in problems]
        places = finder.places(text_site.text, offsets) if finder is not None else None
        lines = Lines(text_site.text)
        for index, problem in enumerate(problems):
            line, column = lines.place(offsets[index])
            file_line, file_column = places[index] if places is not None else (None, None)
            where = f"{text_site.path}, line {line}, column {column}"
            location = Location(file, file_line, file_column, where)
            found.append(Diagnostic("LNG101", Severity.ERROR, problem.message, location))
    return found


def _problems(project: Project, *, grafcet: bool) -> Iterator[tuple[TextSite, Sequence[Problem]]]:
    for text_site in text_sites(project):
        if text_site.reading is SiteKind.STATEMENTS:
            yield text_site, parse_body(text_site.text, project.dialect).problems
        elif text_site.reading is SiteKind.INSTRUCTIONS:
            yield text_site, instruction_problems(text_site.text, project.dialect)
        elif grafcet and isinstance(text_site.holder, Expression):
            problem = condition_problem(text_site.text, project.dialect)
            yield text_site, [problem] if problem is not None else []
        elif text_site.is_program_text and not _is_any_size(text_site):
            parse = parse_condition if isinstance(text_site.holder, Expression) else parse_expression
            yield text_site, parse(text_site.text, project.dialect).problems
        elif text_site.reading is SiteKind.DECLARATIONS:
            yield text_site, parse_declarations(text_site.text, project.dialect).problems


def _is_any_size(text_site: TextSite) -> bool:
    """True for the bounds of ``ARRAY [*]``, which are no expression."""
    return isinstance(text_site.holder, Dimension) and text_site.text == "*"
