"""Elements that were moved: their source text comes along, with all that only the source knows about them."""

from __future__ import annotations

from collections import defaultdict, deque
from typing import TYPE_CHECKING

from plcopen_sfc.formats.xml.align import align, similarity
from plcopen_sfc.formats.xml.fragments import kind_of, nodes_of
from plcopen_sfc.formats.xml.textdiff import Change, apply
from plcopen_sfc.formats.xml.tokens import Node, SourceTree

if TYPE_CHECKING:
    from collections.abc import Hashable, Mapping

    from lxml import etree

    from plcopen_sfc.formats.xml.features import Comparison

__all__ = ["FileSource", "Removed", "missing_declarations", "reindented"]

FileSource = tuple[Node, "etree._Element"]
"""A node of the source and the element of `before` that it corresponds to."""

_ALIKE = 0.5
_MAX_INSIDE = 20_000


class Removed:
    """What was removed anywhere, to be found again when the same comes in elsewhere."""

    def __init__(self, comparison: Comparison) -> None:
        self._comparison = comparison
        self._new: deque[FileSource] = deque()
        self._by_content: defaultdict[bytes, deque[FileSource]] = defaultdict(deque)
        self._by_keys: defaultdict[Hashable, deque[FileSource]] = defaultdict(deque)
        self._taken: set[Node] = set()
        self._inside = 0

    def add(self, node: Node, element: etree._Element) -> None:
        """Remember a removed node."""
        self._new.append((node, element))

    def take(self, element: etree._Element) -> FileSource | None:
        """Where `element` was before, if it is one of those removed; it can be taken only once."""
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
            if origin[0] not in self._taken and similarity(self._comparison.tree_item(origin[1]), item) >= _ALIKE:
                self._taken.add(origin[0])
                return origin
        return None

    def _learn(self, node: Node, element: etree._Element) -> None:
        item = self._comparison.tree_item(element)
        self._by_content[self._comparison.bytes_of(element)].append((node, element))
        if item.keys:
            self._by_keys[item.tag, tuple(item.keys)].append((node, element))
        # What stood inside may have been taken out before the rest was removed.
        children = [child for child in nodes_of(element) if not kind_of(child).startswith("#")]
        self._inside += len(children)
        if not children or self._inside > _MAX_INSIDE:
            return
        places = align(
            [self._comparison.source_item(child) for child in node.children],
            [self._comparison.tree_item(child, exact=False) for child in children],
        )
        for place, child in zip(places, children, strict=True):
            if place is not None and (len(child) or child.text):
                self._new.append((node.children[place], child))


def missing_declarations(tree: SourceTree, node: Node, scope: Mapping[str, str]) -> dict[str, str]:
    """Namespaces that the text of `node` uses and that mean something else, or nothing, in another scope."""
    outer = tree.scope(node.parent)
    changed = {prefix for prefix in outer.keys() | scope.keys() if outer.get(prefix, "") != scope.get(prefix, "")}
    if not changed:
        return {}
    found: dict[str, str] = {}
    waiting: list[tuple[Node, frozenset[str]]] = [(node, frozenset())]
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
    """The text of one element, moved from indentation `old` to `new`. Text beside other nodes is left as it is."""
    if old == new:
        return text
    tree = SourceTree(text)
    edits: list[Change] = []
    waiting = [tree.root]
    while waiting:
        node = waiting.pop()
        if not node.children or tree.value_of(tree.content(node)).strip():
            continue
        for position in (*(child.start for child in node.children), node.close_start):
            start = tree.blank_before(position)
            if start and text[start - 1] in "\r\n" and text.startswith(old, start, position):
                edits.append(Change(start, start + len(old), new))
        waiting += node.children
    return apply(text, edits)
