"""Comments, pragmas and regions: text beside the program that the dialects write in different ways."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.edits import Edit, apply_edits
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import Comment, CommentKind, tokenize
from plcopen_sfc.languages.st.parsing import Parsed
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.languages.translation.translation_context import TITLES, PartText

_CARRIED = re.compile(r"\(\*pragma (\{[^}]*\})\*\)")
_REGION = re.compile(r"""\{\s*region\s*(?:\(?\s*(?:'([^\r\n]*)'|"([^\r\n]*)")\s*\)?\s*)?\}""", re.IGNORECASE)
_CONDITIONAL = re.compile(r"\{\s*IF\b", re.IGNORECASE)
"""The first of the pragmas with which CODESYS compiles statements or not."""
_END_OF_REGION = re.compile(r"END_REGION", re.IGNORECASE)
_END_REGION = re.compile(r"\{\s*endregion\s*\}", re.IGNORECASE)


def translated_comment(kind: CommentKind, text: str, source: Dialect, target: Dialect, *, regions: bool) -> PartText:
    """A comment or a pragma of `source` in `target`, both families.

    ``//`` and ``(* *)`` are known to all, ``/* */`` to IEC 61131-3, ``(/* */)`` to SCL, pragmas to all but SCL: there
    they stand in a comment that becomes a pragma again on the way back. `regions`: pragmas of regions become REGION.
    """
    if source is target or kind is CommentKind.LINE:
        return PartText(text)
    if kind is CommentKind.PRAGMA:
        return _pragma(text, target, regions=regions)
    carried = _CARRIED.fullmatch(text)
    if carried is not None and source is Dialect.SCL:
        return PartText(carried[1])
    if text.startswith("(/*") and target is not Dialect.SCL:
        return PartText(f"(*{_harmless(text[3:-3])}*)")
    if text.startswith("/*") and target is not Dialect.IEC:
        return PartText(f"(*{_harmless(text[2:-2])}*)")
    return PartText(text)


def _pragma(text: str, target: Dialect, *, regions: bool) -> PartText:
    if _CONDITIONAL.match(text):
        why = f"{TITLES[target]} has no pragmas that leave statements out: they are always executed there"
        return PartText(text if target is not Dialect.SCL else f"(*pragma {_harmless(text)}*)", Severity.ERROR, why)
    region, end = _REGION.fullmatch(text), _END_REGION.fullmatch(text)
    if target is not Dialect.SCL:
        if region is not None or end is not None:
            return PartText(text)
        return PartText(text, Severity.INFO, f"what a pragma means depends on the tool: {TITLES[target]} may ignore it")
    if regions and region is not None:
        return PartText(f"REGION {_unescaped(region[1] or region[2] or '')}".rstrip())
    if regions and end is not None:
        return PartText("END_REGION")
    reason = "SCL has no pragmas in statements: it became a comment"
    return PartText(f"(*pragma {_harmless(text)}*)", Severity.WARNING, reason)


def _harmless(text: str) -> str:
    """The text inside of a comment, so that nothing in it starts or ends one."""
    return text.replace("(*", "( *").replace("*)", "* )")


def with_translated_comments(text: str, source: Dialect, target: Dialect, *, regions: bool) -> str:
    """A text whose program is in the target dialect already, with its comments and pragmas so too."""
    edits = []
    for comment in tokenize(text, target, comments_of=source).comments:
        new = translated_comment(comment.kind, comment.text, source, target, regions=regions).text
        if new == comment.text:
            continue
        start, end = comment.span
        if new.startswith("REGION") and re.match(r"[ \t]*[^\s]", text[end:]):
            new += "\n"  # its title goes to the end of the line
        edits.append(Edit(start, end, new))
    return apply_edits(text, edits)


def holds_regions(comments: Iterable[Comment]) -> bool:
    """True if there are pragmas of regions among comments."""
    return any(_REGION.fullmatch(comment.text) or _END_REGION.fullmatch(comment.text) for comment in comments)


def region_edits(parsed: Parsed[Any]) -> list[Edit]:
    """The edits that make pragmas of the regions of SCL: other dialects have nothing else for them."""
    text = parsed.text
    ends = [end.span() for end in _END_OF_REGION.finditer(text)]
    ends = [end for end in ends if not any(a <= end[0] < b for a, b in (c.span for c in parsed.comments))]
    edits = []
    for node in walk(parsed.tree):
        if isinstance(node, n.Region) and node.span is not None:
            start, end = node.span
            first = min((text.find(mark, start, end) for mark in "\r\n" if mark in text[start:end]), default=end)
            last = max(each for each in ends if start < each[0] < end)
            edits.append(Edit(start, first, f"{{region '{_escaped(node.title)}'}}"))
            edits.append(Edit(*last, "{endregion}"))
            if text[last[1] : end].endswith(";"):
                edits.append(Edit(end - 1, end, ""))
    return edits


def _escaped(title: str) -> str:
    return title.replace("$", "$$").replace("'", "$'").replace("}", "$7D")


def _unescaped(title: str) -> str:
    return re.sub(r"\$(7D|[$'\"])", lambda found: "}" if found[1] == "7D" else found[1], title)
