"""Places of child elements in the source: where one is removed, where a new one goes in, where a moved one was.

A moved element takes its source text along, with all that only the source knows about it.
"""

from __future__ import annotations

from collections import defaultdict, deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from plcopen_sfc.formats.xml.element_alignment import align, similarity
from plcopen_sfc.formats.xml.source_style import kind_of, nodes_of
from plcopen_sfc.formats.xml.source_tree import COMMENT, SourceNode, SourceTree
from plcopen_sfc.languages.edits import Edit, apply_edits

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator, Mapping
    from collections.abc import Set as AbstractSet

    from lxml import etree

    from plcopen_sfc.formats.xml.element_alignment import ElementComparison
    from plcopen_sfc.formats.xml.source_style import SourceStyle


@dataclass(slots=True)
class Insertion:
    """New nodes for one place: `text[start:end]` becomes `head`, every node after its separator, and `tail`."""

    parent: SourceNode
    start: int
    end: int
    indent: str | None
    separator: str
    first_separator: str
    head: str = ""
    tail: str = ""
    elements: list[etree._Element] = field(default_factory=list)


def make_empty(style: SourceStyle, node: SourceNode) -> Edit:
    """Return the edit that writes an element without any content."""
    empty_end = style.empty_end(node.start)
    if empty_end is None:
        return Edit(node.open_end, node.close_start, "")
    return Edit(style.tree.tag_end(node), node.end, empty_end)


class ChildLayout:
    """The children of one source node, of which those in `going` are removed."""

    def __init__(self, style: SourceStyle, parent: SourceNode, going: AbstractSet[SourceNode]) -> None:
        self._style = style
        self._tree = style.tree
        self._parent = parent
        self._going = going
        self._index = {child: index for index, child in enumerate(parent.children)}
        self._removals: list[Edit] = []
        self._removal_of: dict[SourceNode, Edit] = {}
        self._find_removals()

    def _find_removals(self) -> None:
        """Children that go, together with their lines where these have nothing else."""
        text = self._tree.text
        run: list[SourceNode] = []
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

    def _close_run(self, run: list[SourceNode]) -> None:
        if not run:
            return
        start, end = run[0].start, run[-1].end
        change = Edit(*(self._tree.own_lines(start, end) or (start, end)), "")
        self._removals.append(change)
        for node in run:
            self._removal_of[node] = change

    def removals(self) -> list[Edit]:
        """Return the edits that remove the children in `going`; all content, if nothing but blanks would be left."""
        parent = self._parent
        if not self._going or any(child not in self._going for child in parent.children):
            return self._removals
        if self._tree.value_of(self._tree.content(parent)).strip():
            return self._removals
        return [make_empty(self._style, parent)]

    def removals_one_by_one(self) -> list[Edit]:
        """Return the same edits where something new comes in instead."""
        return self._removals

    def insertion(self, anchor: SourceNode | None, following: SourceNode | None) -> Insertion:
        """Return the place for new children between two that stay (None: the beginning or the end of the parent)."""
        indent = self._style.child_indent(self._parent)
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

    def _going_between(self, anchor: SourceNode | None, following: SourceNode | None) -> Iterator[SourceNode]:
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

    def _behind(self, anchor: SourceNode, indent: str | None) -> int:
        """Return the place behind `anchor` and the comments behind it on its line."""
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

    def _ahead(self, following: SourceNode | None) -> int:
        """Return the place before `following` and the comments above it."""
        if following is None:
            return self._parent.open_end
        children = self._parent.children
        index = self._index[following]
        while index > 0 and children[index - 1].name == COMMENT:
            index -= 1
        return children[index - 1].end if index else self._parent.open_end


MatchedElement = tuple[SourceNode, "etree._Element"]
"""A node of the source and the element of `before` that it corresponds to."""


_SAME_THING = 0.5

_MAX_INSIDE = 20_000


class RemovedElements:
    """Elements that were removed anywhere, to be found again when the same comes in elsewhere."""

    def __init__(self, comparison: ElementComparison) -> None:
        self._comparison = comparison
        self._new: deque[MatchedElement] = deque()
        self._by_content: defaultdict[bytes, deque[MatchedElement]] = defaultdict(deque)
        self._by_keys: defaultdict[Hashable, deque[MatchedElement]] = defaultdict(deque)
        self._taken: set[SourceNode] = set()
        self._inside = 0

    def add(self, node: SourceNode, element: etree._Element) -> None:
        """Remember a removed node."""
        self._new.append((node, element))

    def take(self, element: etree._Element) -> MatchedElement | None:
        """Return the old place of `element`, if it is one of those removed; it can be taken only once."""
        while self._new:
            self._learn(*self._new.popleft())
        if not self._by_content:
            return None
        equal = self._by_content.get(self._comparison.bytes_of(element))
        while equal:
            if (origin := equal.popleft())[0] not in self._taken:
                self._taken.add(origin[0])
                return origin
        item = self._comparison.tree_item(element)
        if not item.keys:
            return None
        for origin in self._by_keys.get((item.tag, tuple(item.keys)), ()):
            if origin[0] not in self._taken and similarity(self._comparison.tree_item(origin[1]), item) >= _SAME_THING:
                self._taken.add(origin[0])
                return origin
        return None

    def _learn(self, node: SourceNode, element: etree._Element) -> None:
        item = self._comparison.tree_item(element)
        self._by_content[self._comparison.bytes_of(element)].append((node, element))
        if item.keys:
            self._by_keys[item.tag, tuple(item.keys)].append((node, element))
        # A child may have been taken out before the rest was removed.
        children = [child for child in nodes_of(element) if not kind_of(child).startswith("#")]
        self._inside += len(children)
        # Every removed subtree is aligned with its source here; the bound keeps the removal of a whole project fast.
        if not children or self._inside > _MAX_INSIDE:
            return
        places = align(
            [self._comparison.source_item(child) for child in node.children],
            [self._comparison.tree_item(child, exact=False) for child in children],
        )
        for place, child in zip(places, children, strict=True):
            if place is not None and (len(child) or child.text):
                self._new.append((node.children[place], child))


def missing_declarations(tree: SourceTree, node: SourceNode, scope: Mapping[str, str]) -> dict[str, str]:
    """Namespaces that the text of `node` uses and that mean something else, or nothing, in another scope."""
    outer = tree.scope(node.parent)
    changed = {prefix for prefix in outer.keys() | scope.keys() if outer.get(prefix, "") != scope.get(prefix, "")}
    if not changed:
        return {}
    found: dict[str, str] = {}
    waiting: list[tuple[SourceNode, frozenset[str]]] = [(node, frozenset())]
    while waiting:
        here, own = waiting.pop()
        if not here.is_element:
            continue
        own |= tree.declared(here).keys()
        names = [here.name, *(attribute.name for attribute in tree.attributes(here) if ":" in attribute.name)]
        for prefix in sorted({name.rpartition(":")[0] for name in names} & changed - own):
            found[prefix] = outer.get(prefix, "")
        waiting += ((child, own) for child in here.children)
    return found


def reindented(text: str, old: str, new: str) -> str:
    """Return the text of one element, moved from indentation `old` to `new`. Text beside other nodes stays as it is."""
    if old == new:
        return text
    tree = SourceTree(text)
    edits: list[Edit] = []
    waiting = [tree.root]
    while waiting:
        node = waiting.pop()
        if not node.children or tree.value_of(tree.content(node)).strip():
            continue
        for position in (*(child.start for child in node.children), node.close_start):
            start = tree.blank_before(position)
            if start and text[start - 1] in "\r\n" and text.startswith(old, start, position):
                edits.append(Edit(start, start + len(old), new))
        waiting += node.children
    return apply_edits(text, edits)
