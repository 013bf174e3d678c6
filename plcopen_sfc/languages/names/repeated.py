"""Data of tools that repeats what the model declares.

CODESYS writes a list of global variables whose parts have different attributes twice: as one list, and in its own data
(``mixedattrsvarlist``) part by part. The model carries that data as it came, so its names must follow.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.names.pieces import Role
from plcopen_sfc.languages.names.references import Reference, in_tree, moved, unread
from plcopen_sfc.languages.st import parse_expression

_SAID = re.compile(
    r"<globalVars\b[^>]*?\bname=\"(?P<list>[^\"]*)\"|<variable\b[^>]*?\bname=\"(?P<variable>[^\"]*)\""
    r"|<derived\b[^>]*?\bname=\"(?P<type>[^\"]*)\"|<simpleValue\b[^>]*?\bvalue=\"(?P<value>[^\"]*)\""
    r"|<(?P<comment>documentation)\b.*?</documentation>",
    re.DOTALL,
)


def in_repeated_list(markup: str, dialect: Dialect) -> Iterator[Reference]:
    """The names in the parts of a list of global variables. Comments hold none; what else there is cannot be read."""
    done = 0
    for found in _SAID.finditer(markup):
        yield from _rest(markup, done, found.start())
        done = found.end()
        kind = found.lastgroup or ""
        text, (start, end) = found[kind], found.span(kind)
        if kind == "list":
            yield Reference(text, (start, end), Role.HEAD)
        elif kind == "variable":
            yield Reference(text, (start, end), declares=True)
        elif kind == "type":
            yield Reference(text, (start, end), Role.TYPE)
        elif kind == "value" and "&" not in text:
            yield from moved(in_tree(parse_expression(text, dialect).tree, dialect), start)
        elif kind == "value":
            yield from unread(text, start, "it is written with references of XML", dialect)
    yield from _rest(markup, done, len(markup))


def _rest(markup: str, start: int, end: int) -> Iterator[Reference]:
    """Texts and attributes of elements that are not known here."""
    for value in re.finditer(r"=\"([^\"]*)\"|>([^<]*)<", markup[start:end]):
        inner = value.lastindex or 0
        yield from unread(value[inner], start + value.start(inner), "it stands in data that only another tool reads")
