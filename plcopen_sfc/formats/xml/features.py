"""Elements of a tree and nodes of the source, made comparable with each other."""

from __future__ import annotations

from collections import Counter
from functools import partial
from typing import TYPE_CHECKING, Any, cast

from lxml import etree

from plcopen_sfc.formats.xml.align import Item, KeyFunction, Keys
from plcopen_sfc.formats.xml.fragments import kind_of

if TYPE_CHECKING:
    from collections.abc import Hashable

    from plcopen_sfc.formats.xml.tokens import Node, SourceTree

__all__ = ["Comparison"]

_FEATURE_LIMIT = 400


class Comparison:
    """What the alignment needs to know about elements, for one source and a pair of trees."""

    def __init__(self, tree: SourceTree, before: etree._Element, after: etree._Element, keys: KeyFunction) -> None:
        self._tree = tree
        self._keys = keys
        # Plain serialisation is twice as fast but names every namespace in scope: it only compares trees that declare
        # the same ones.
        self._plain = before.nsmap == after.nsmap

    def bytes_of(self, element: etree._Element) -> bytes:
        """Equal for elements that say the same."""
        if not self._plain and isinstance(cast("object", element.tag), str):
            try:
                return etree.tostring(element, method="c14n", exclusive=True, with_tail=False)
            except etree.C14NError:  # for namespaces that are no absolute URIs
                self._plain = True
        return etree.tostring(element, with_tail=False)

    def same(self, before: etree._Element, after: etree._Element) -> bool:
        """Whether two elements are equal, down to the last descendant."""
        return before is after or self.bytes_of(before) == self.bytes_of(after)

    def tree_item(self, element: etree._Element, *, exact: bool = True) -> Item:
        """An element of `before` or `after`."""
        tag = kind_of(element)
        keys: Keys = () if tag.startswith("#") else self._keys(tag, cast("Any", element.attrib))
        return Item(
            tag, keys, partial(self.bytes_of, element) if exact else None, partial(_tree_features, element, keys)
        )

    def source_item(self, node: Node) -> Item:
        """A node of the source."""
        tree = self._tree
        tag = tree.tag(node)
        keys: Keys = self._keys(tag, tree.values(node)) if node.is_element else ()
        return Item(tag, keys, None, partial(_source_features, tree, node, keys))


def _tree_features(element: etree._Element, keys: Keys) -> Counter[Hashable]:
    """What an element says, in small pieces; without its keys, for these are compared by themselves."""
    own = {name for name, _ in keys}
    found: Counter[Hashable] = Counter()
    for count, node in enumerate(element.iter()):
        if count > _FEATURE_LIMIT:
            break
        tag = kind_of(node)
        if node is not element:
            found[tag] += 1
        for name, value in node.attrib.items():
            if node is not element or name not in own:
                found[tag, str(name), str(value)] += 1
        if text := (node.text or "").strip():
            found[tag, text] += 1
    return found


def _source_features(tree: SourceTree, node: Node, keys: Keys) -> Counter[Hashable]:
    """The same of an element in the source."""
    own = {name for name, _ in keys}
    found: Counter[Hashable] = Counter()
    waiting = [node]
    count = 0
    while waiting and count <= _FEATURE_LIMIT:
        here = waiting.pop()
        count += 1
        tag = tree.tag(here)
        if here is not node:
            found[tag] += 1
        for name, value in tree.values(here).items():
            if here is not node or name not in own:
                found[tag, name, value] += 1
        text = tree.value_of(tree.content(here)) if here.is_element else tree.inner(here)
        if text.strip():
            found[tag, text.strip()] += 1
        waiting += reversed(here.children)
    return found
