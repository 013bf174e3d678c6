"""Where in the source lines a child is removed, and where a new one goes in."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from plcopen_sfc.formats.xml.textdiff import Change
from plcopen_sfc.formats.xml.tokens import COMMENT, Node

if TYPE_CHECKING:
    from collections.abc import Iterator
    from collections.abc import Set as AbstractSet

    from lxml import etree

    from plcopen_sfc.formats.xml.fragments import Handwriting

__all__ = ["ChildLayout", "Insertion", "make_empty"]


@dataclass(slots=True)
class Insertion:
    """New nodes for one place: `text[start:end]` becomes `head`, every node after its separator, and `tail`."""

    parent: Node
    start: int
    end: int
    indent: str | None
    separator: str
    first_separator: str
    head: str = ""
    tail: str = ""
    elements: list[etree._Element] = field(default_factory=list)


def make_empty(writing: Handwriting, node: Node) -> Change:
    """The edit that writes an element without any content."""
    empty_end = writing.empty_end(node.start)
    if empty_end is None:
        return Change(node.open_end, node.close_start, "")
    return Change(writing.tree.tag_end(node), node.end, empty_end)


class ChildLayout:
    """The children of one source node, of which those in `going` are removed."""

    def __init__(self, writing: Handwriting, parent: Node, going: AbstractSet[Node]) -> None:
        self._writing = writing
        self._tree = writing.tree
        self._parent = parent
        self._going = going
        self._index = {child: index for index, child in enumerate(parent.children)}
        self._removals: list[Change] = []
        self._removal_of: dict[Node, Change] = {}
        self._find_removals()

    def _find_removals(self) -> None:
        """Children that go, together with their lines where nothing else stands on them."""
        text = self._tree.text
        run: list[Node] = []
        for child in self._parent.children:
            if child not in self._going:
                self._close_run(run)
                run = []
                continue
            if run:
                between = text[run[-1].end : child.start]
                if between.strip() or "\n" in between or "\r" in between:
                    self._close_run(run)
                    run = []
            run.append(child)
        self._close_run(run)

    def _close_run(self, run: list[Node]) -> None:
        if not run:
            return
        start, end = run[0].start, run[-1].end
        change = Change(*(self._tree.own_lines(start, end) or (start, end)), "")
        self._removals.append(change)
        for node in run:
            self._removal_of[node] = change

    def removals(self) -> list[Change]:
        """The edits that remove the children in `going`; all content, if nothing but blanks would be left."""
        parent = self._parent
        if not self._going or any(child not in self._going for child in parent.children):
            return self._removals
        if self._tree.value_of(self._tree.content(parent)).strip():
            return self._removals
        return [make_empty(self._writing, parent)]

    def removals_one_by_one(self) -> list[Change]:
        """The same where something new comes in instead."""
        return self._removals

    def insertion(self, anchor: Node | None, following: Node | None) -> Insertion:
        """The place for new children between two that stay (None: the beginning or the end of the parent)."""
        indent = self._writing.child_indent(self._parent)
        separator = "" if indent is None else self._tree.newline + indent
        if not self._parent.children and not self._tree.value_of(self._tree.content(self._parent)).strip():
            return self._fill(indent, separator)
        replaced = next(self._going_between(anchor, following), None)
        if replaced is not None:
            removal = self._removal_of[replaced]
            alone = removal.start != replaced.start
            place, first = removal.start, separator if alone else ""
        else:
            place, first = self._behind(anchor, indent) if anchor else self._ahead(following), separator
        return Insertion(self._parent, place, place, indent, separator, first)

    def _going_between(self, anchor: Node | None, following: Node | None) -> Iterator[Node]:
        first = self._index[anchor] + 1 if anchor else 0
        last = self._index[following] if following else len(self._parent.children)
        return (child for child in self._parent.children[first:last] if child in self._going)

    def _fill(self, indent: str | None, separator: str) -> Insertion:
        """New content of an element that has none."""
        parent, tree = self._parent, self._tree
        tail = "" if indent is None else tree.newline + (tree.line_indent(parent) or "")
        found = Insertion(parent, parent.open_end, parent.close_start, indent, separator, separator, "", tail)
        if parent.is_closed:
            found.start, found.end = tree.tag_end(parent), parent.end
            found.head, found.tail = ">", f"{tail}</{parent.name}>"
        return found

    def _behind(self, anchor: Node, indent: str | None) -> int:
        """Behind `anchor` and the comments that stand behind it on its line."""
        place = anchor.end
        if indent is None:
            return place
        children = self._parent.children
        for index in range(self._index[anchor] + 1, len(children)):
            child = children[index]
            if child.name != COMMENT or "\n" in self._tree.text[place : child.start]:
                break
            place = child.end
        return place

    def _ahead(self, following: Node | None) -> int:
        """Before `following` and the comments above it."""
        if following is None:
            return self._parent.open_end
        children = self._parent.children
        index = self._index[following]
        while index > 0 and children[index - 1].name == COMMENT:
            index -= 1
        return children[index - 1].end if index else self._parent.open_end
