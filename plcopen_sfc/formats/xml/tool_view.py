"""An XML file as the tool of its format sees it: without what only this package reads.

That is what writers carry: comments of ours, and foreign data under a name of ours. Everything else stands as it stood,
and in its line, vendors' data too.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.formats.xml.carrying import COMMENT_MARK, OWN_DATA
from plcopen_sfc.formats.xml.source import decode, parse
from plcopen_sfc.formats.xml.tokens import COMMENT, Node, SourceTree
from plcopen_sfc.languages.edits import without


def as_tool_sees(data: bytes, *, file: str | None = None) -> bytes:
    """The file `data` without what is ours; `data` itself where there is nothing. Raises `FormatError`."""
    text, encoding = decode(data, file=file)
    if COMMENT_MARK not in text and OWN_DATA not in text:
        return data
    parse(data, file=file)  # says what is wrong with the file, where it is no XML
    tree = SourceTree(text)
    return encoding.encode(without(text, [(node.start, node.end) for node in _own(tree, tree.root)]))


def _own(tree: SourceTree, node: Node) -> Iterator[Node]:
    for child in node.children:
        if _is_own(tree, child):
            yield child
        else:
            yield from _own(tree, child)


def _is_own(tree: SourceTree, node: Node) -> bool:
    if node.name == COMMENT:
        return tree.inner(node).startswith(COMMENT_MARK)
    local = node.name.rpartition(":")[2]
    if local == "data":
        return tree.values(node).get("name", "").startswith(OWN_DATA)
    # a holder with nothing but our data was made for it
    return local == "addData" and bool(node.children) and all(_is_own(tree, child) for child in node.children)
