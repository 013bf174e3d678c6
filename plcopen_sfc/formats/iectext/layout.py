"""How bodies and comments lie on the page: indented when they are written, taken off the page when they are read."""

from __future__ import annotations

import re
from typing import NamedTuple

INDENT = "    "
_FIRST_LINE_END = re.compile(r"[ \t]*\n")
_BLANK_LINES_BEFORE = re.compile(r"(?:[ \t]*\n)*")
_MARK_OR_CONTROL = re.compile(r"\(\*|\*\)|[\x00-\x08\x0b-\x1f\x7f\x85\u2028\u2029\ufeff]")


class Block(NamedTuple):
    """A text of several lines: its lines without common margin and blank edges, and these edges."""

    text: str
    margin: str = ""
    before: str = ""
    after: str = ""

    def whole(self) -> str:
        """The text with its margin and edges."""
        return self.before + indented(self.text, self.margin) + self.after


def newlines(text: str) -> str:
    """`text` with LF as its line end."""
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def block(text: str) -> Block:
    """Take the margin and the blank edges off a text whose first line has its margin too."""
    before = _BLANK_LINES_BEFORE.match(text)
    start = before.end() if before is not None else 0
    core = text[start:].rstrip()
    if not core:
        return Block("", before=text)
    margin = _margin(core.split("\n"))
    lines = [line[len(margin) :] if line.strip() else line for line in core.split("\n")]
    return Block("\n".join(lines), margin, text[:start], text[start + len(core) :])


def taken(source: str) -> str:
    """What a reader takes from the lines between a header and its END: without margin and blank edges."""
    text = newlines(source)
    core = text.strip()
    if "\n" not in core or _FIRST_LINE_END.match(text) is not None:
        return block(text).text
    # the first line stands behind the header and says nothing of the margin
    head, _, rest = core.partition("\n")
    return head.rstrip() + "\n" + _dedented(rest)


def _dedented(text: str) -> str:
    lines = text.split("\n")
    margin = _margin(lines)
    return "\n".join(line[len(margin) :] if line.strip() else line for line in lines)


def _margin(lines: list[str]) -> str:
    margins = [line[: len(line) - len(line.lstrip(" \t"))] for line in lines if line.strip()]
    margin = min(margins, key=len, default="")
    while not all(one.startswith(margin) for one in margins):
        margin = margin[:-1]
    return margin


def indented(text: str, indent: str) -> str:
    """`text` with `indent` before each line that is not blank."""
    return "\n".join(indent + line if line.strip() else line for line in text.split("\n"))


# -- comments ---------------------------------------------------------------------------------------------------------


def format_comment(text: str, indent: str) -> str | None:
    """``(* text *)``, its further lines below the first; None where the text would not come back from that."""
    if _MARK_OR_CONTROL.search(text):
        return None
    lines = text.split("\n")
    shown = (
        "(* " + "\n".join([lines[0], *(indent + "   " + line if line.strip() else line for line in lines[1:])]) + " *)"
    )
    return shown if taken_comment(shown) == text else None


def taken_comment(raw: str) -> str:
    """What a comment says: without its marks, the blank beside each, and the margin of its further lines."""
    text = newlines(raw)
    if text.startswith("//"):
        return text[2:].removeprefix(" ").rstrip()
    inner = text[2 : -2 if len(text) >= 4 and text.endswith(("*)", "*/")) else None]
    inner = inner.removeprefix(" ").removesuffix(" ")
    first, line_end, rest = inner.partition("\n")
    if not line_end:
        return inner
    if not rest.strip():
        return first.rstrip()
    if not first.strip():
        return block(inner).text
    return first + "\n" + _dedented(rest)
