"""Text of an edited tree: what did not change stays as it was written, with its layout and comments."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator
from itertools import islice
from typing import Any

from plcopen_sfc.languages.edits import Edit, apply_edits
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.st.lexer import Comment, CommentKind
from plcopen_sfc.languages.st.nodes import Branch, Node, Operation, Span, Statements, Unary
from plcopen_sfc.languages.st.parsing import Parsed
from plcopen_sfc.languages.st.printing import Printer, needs_parentheses, operands
from plcopen_sfc.languages.st.walking import parts, walk


def render(parsed: Parsed[Any], tree: Node) -> str:
    """The text of `tree`, which was made from `parsed.tree`. Of the unedited tree it is `parsed.text` exactly."""
    return apply_edits(parsed.text, tree_edits(parsed, tree))


def tree_edits(parsed: Parsed[Any], tree: Node) -> list[Edit]:
    """Return the edits that make `parsed.text` the text of `tree`."""
    return [] if tree is parsed.tree else _Comparison(parsed).edits(parsed.tree, tree)


_STATEMENTS = frozenset({"statements", "otherwise", "handler", "finally_"})


def _are_separate(name: str, before: tuple[Any, ...], after: tuple[Any, ...]) -> bool:
    """True if members of the list `name` can be taken out and put in: statements, and branches but the first."""
    return name in _STATEMENTS or (name == "branches" and before[:1] == after[:1])


class _Comparison:
    def __init__(self, parsed: Parsed[Any]) -> None:
        self._text = parsed.text
        self._comments = parsed.comments
        self._comment_starts = [comment.span[0] for comment in parsed.comments]
        self._lines = Lines(parsed.text)
        self._old = {id(node): node for node in walk(parsed.tree)}
        self._by_place = {(type(node), node.span): node for node in self._old.values()}
        self._used: list[Span] = []
        self._printed_anew: set[int] = set()
        newline = "\r\n" if "\r\n" in parsed.text else "\n"
        self._newline = newline
        self._printer = Printer(parsed.dialect, newline=newline, known=self._written)

    def _written(self, node: Node) -> str | None:
        """The text of a node that has some: of one that was edited with the edits made, so that its layout stays."""
        old = self._old.get(id(node)) or self._by_place.get((type(node), node.span))
        if old is None or old.span is None or id(node) in self._printed_anew:
            return None
        start, end = old.span
        self._used.append(old.span)
        edits = (Edit(first - start, last - start, new) for first, last, new in self.edits(old, node))
        return apply_edits(self._text[start:end], edits)

    def edits(self, old: Node, new: Node) -> list[Edit]:
        """The edits that make `new` of `old`."""
        if old is new:
            return []
        if type(old) is not type(new):
            return [self._replaced(old, new)]
        if isinstance(old, Operation | Unary) and isinstance(new, Operation | Unary):
            return self._operation_edits(old, new)
        found: list[Edit] = []
        for name in parts(type(old)):
            before, after = getattr(old, name), getattr(new, name)
            if before is after:
                continue
            if isinstance(before, Node) and isinstance(after, Node):
                found += self.edits(before, after)
            elif isinstance(before, tuple) and isinstance(after, tuple):
                inner = self._list_edits(before, after, separate=_are_separate(name, before, after))
                if inner is None:
                    return [self._replaced(old, new)]
                found += inner
            elif before != after:
                return [self._replaced(old, new)]
        return found

    def _operation_edits(self, old: Operation | Unary, new: Operation | Unary) -> list[Edit]:
        """As `edits`: what is new among the operands gets parentheses where it needs them."""
        before, after = operands(old), operands(new)
        if old.operator is not new.operator or len(before) != len(after):
            return [self._replaced(old, new)]
        found: list[Edit] = []
        for index, (a, b) in enumerate(zip(before, after, strict=True)):
            edits = self.edits(a, b)
            if edits and needs_parentheses(new, index):
                start, end, text = self._replaced(a, b)
                edits = [Edit(start, end, f"({text})")]
            found += edits
        return found

    def _replaced(self, old: Node, new: Node) -> Edit:
        start, end = old.span or (0, len(self._text))
        if isinstance(new, Statements):  # there were no statements, but perhaps comments
            before = self._newline if self._text.strip() and not self._text.endswith(("\n", "\r")) else ""
            return Edit(end, end, before + self._printer.text(new))
        indent = self._indent_at(start)
        used, self._used = self._used, []
        if id(new) not in self._old:
            self._printed_anew.add(id(new))
        text = self._printer.text(new, indent)
        if isinstance(new, Branch) and not self._text[start:end].upper().startswith("ELSIF"):
            text = text.removeprefix("ELS")  # a branch by itself is printed as one that is not the first
        text = self._lost_comments(start, end, indent) + text
        if text.startswith("/*") and self._text[:start].endswith("("):
            text = f" {text}"  # (/* starts a comment of SCL
        self._used = used
        return Edit(start, end, text)

    def _lost_comments(self, start: int, end: int, indent: str) -> str:
        """The comments from `start` to `end` that no part used again contains: they move before what is new there."""
        text = ""
        for comment in self._comments_from(start):
            first, last = comment.span
            if first >= end:
                break
            if last <= end and not any(a <= first and last <= b for a, b in self._used):
                text += comment.text + (f"{self._newline}{indent}" if comment.kind is CommentKind.LINE else " ")
        return text

    def _comments_from(self, offset: int) -> Iterator[Comment]:
        """The comments that start at `offset` or behind it."""
        return map(self._comments.__getitem__, range(bisect_left(self._comment_starts, offset), len(self._comments)))

    def _indent_at(self, offset: int) -> str:
        """The spaces at the start of the line that `offset` is in."""
        _, column = self._lines.place(offset)
        line = offset - column + 1
        found = re.compile(r"[ \t]*").match(self._text, line)
        return found.group() if found is not None else ""

    def _list_edits(self, old: tuple[Any, ...], new: tuple[Any, ...], *, separate: bool) -> list[Edit] | None:
        """The edits between two lists of nodes; None where the list has to be written anew with its node.

        `separate`: see `_are_separate`.
        """
        same = 0
        while same < min(len(old), len(new)) and old[same] is new[same]:
            same += 1
        tail = 0
        while tail < min(len(old), len(new)) - same and old[-1 - tail] is new[-1 - tail]:
            tail += 1
        gone, come = old[same : len(old) - tail], new[same : len(new) - tail]
        if len(gone) == len(come):
            return [edit for a, b in zip(gone, come, strict=True) for edit in self.edits(a, b)]
        if not separate or not old:
            return None
        paired = min(len(gone), len(come))
        found = [edit for a, b in zip(gone[:paired], come[:paired], strict=True) for edit in self.edits(a, b)]
        found += [self._removed(node) for node in gone[paired:]]
        if come[paired:]:
            found.append(self._inserted(come[paired:], old, same + paired))
        return found

    def _removed(self, node: Node) -> Edit:
        """Takes a statement out, with its line where nothing else stands in it."""
        start, end = node.span or (0, 0)
        before = re.compile(r"(?:^|(?<=[\r\n]))[ \t]*\Z").search(self._text[:start])
        after = re.compile(r"[ \t]*(\r\n|\r|\n|\Z)").match(self._text, end)
        if before is not None and after is not None:
            return Edit(before.start(), after.end(), "")
        return Edit(start, end, "")

    def _inserted(self, nodes: tuple[Any, ...], old: tuple[Any, ...], index: int) -> Edit:
        """Puts statements behind the one before them, or before the one behind them, each in a line of its own."""
        neighbour: Node = old[index - 1] if index else old[0]
        start, end = neighbour.span or (0, 0)
        indent = self._indent_at(start)
        texts = [self._printer.text(node, indent) for node in nodes]
        if index:
            end = self._end_with_comment(end)
            text = "".join(f"{self._newline}{indent}{text}" for text in texts)
            if self._text[end : end + 1].strip():  # what follows at once would become a part of it
                text += f"{self._newline}{indent}"
            return Edit(end, end, text)
        return Edit(start, start, "".join(f"{text}{self._newline}{indent}" for text in texts))

    def _end_with_comment(self, end: int) -> int:
        """`end`, or the end of the comment that follows it in its line."""
        for comment in islice(self._comments_from(end), 1):
            same_line = not self._text[end : comment.span[0]].strip(" \t") and not re.search(r"[\r\n]", comment.text)
            if same_line and comment.kind is not CommentKind.PRAGMA:
                return comment.span[1]
        return end
