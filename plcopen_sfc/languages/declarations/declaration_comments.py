"""Comments of declarations: the declaration of each, its text, and how it is written."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterable

from plcopen_sfc.languages.st.lexer import Comment, CommentKind
from plcopen_sfc.model.dialect import Dialect

LINE_END = re.compile(r"\r\n|\r|\n")


class Comments:
    """The comments of a text, each of which is given to one object only."""

    def __init__(self, text: str, comments: Iterable[Comment]) -> None:
        self._text = text
        self._left = list(comments)

    def take(self, start: int, end: int) -> list[Comment]:
        """Return the comments between two places that are not taken yet."""
        first = bisect_left(self._left, start, key=_start)
        last = bisect_left(self._left, end, key=_start)
        taken = self._left[first:last]
        del self._left[first:last]
        return taken

    def behind(self, end: int) -> int:
        """Return where the comments end that follow `end` on its line."""
        index = bisect_left(self._left, end, key=_start)
        while index < len(self._left):
            start, stop = self._left[index].span
            if self._left[index].kind is CommentKind.PRAGMA or LINE_END.search(self._text, end, start):
                break
            if self._text[end:start].strip():
                break
            end = stop
            index += 1
        return end


def _start(comment: Comment) -> int:
    return comment.span[0]


def comment_text(comments: Iterable[Comment]) -> str | None:
    """Return the text of comments without their delimiters; None if there is none. Pragmas are no comments."""
    texts = [_inside(comment) for comment in comments if comment.kind is not CommentKind.PRAGMA]
    return "\n".join(texts).strip() or None


def pragmas(comments: Iterable[Comment]) -> str:
    """Return the pragmas and SCL attributes among `comments`, as written."""
    return "\n".join(comment.text for comment in comments if comment.kind is CommentKind.PRAGMA)


def _inside(comment: Comment) -> str:
    if comment.kind is CommentKind.LINE:
        return comment.text[2:].removeprefix(" ").rstrip()
    inner = re.sub(r"^(?:\(\*|/\*|\(/\*)|(?:\*/\)|\*/|\*\))$", "", comment.text)
    return "\n".join(line.strip() for line in LINE_END.split(inner)).strip()


def comment_lines(text: str, dialect: Dialect) -> list[str]:
    """Comments with `text`, one for each of its lines; none if there are only spaces in it."""
    if not text.strip():
        return []
    lines = LINE_END.split(text)
    if dialect is Dialect.IEC and len(lines) == 1 and not re.search(r"\(\*|\*\)", text):
        return [f"(* {text} *)"]
    return [f"// {line}".rstrip() for line in lines]


_ATTRIBUTE = r"\s*(\w+)\s*:=\s*'([^$']*+(?:\$[\s\S][^$']*+)*+)'\s*"
_LIST = re.compile(rf"\{{{_ATTRIBUTE}(?:;{_ATTRIBUTE})*;?\s*\}}")


def read_attributes(text: str) -> dict[str, str] | None:
    """Return the attributes by name; None if they are written otherwise, or twice."""
    if _LIST.fullmatch(text) is None:
        return None
    found = re.findall(_ATTRIBUTE, text)
    attributes = {name: value.replace("$$", "$") for name, value in found}
    return attributes if len(attributes) == len(found) and write_attributes(attributes) else None


def write_attributes(attributes: dict[str, str]) -> str:
    """Return the attributes in braces; empty where one of them could not be read back."""
    listed = "; ".join(f"{name} := '{value.replace('$', '$$')}'" for name, value in attributes.items())
    return f"{{ {listed} }}" if _sayable(attributes) else ""


def _sayable(attributes: dict[str, str]) -> bool:
    return all(re.fullmatch(r"\w+", name) and not re.search(r"['{}\r\n]", value) for name, value in attributes.items())
