"""The text of an XML file as a tree of positions, and the smallest edits that turn one text into another.

lxml forgets how a file was written: quotes, CDATA, blanks inside tags, the position of each element. `SourceTree` reads
the same text once more with regular expressions and keeps nothing but positions. It looks for what is in an element,
and parses the inside of a tag (attributes, namespaces), only for the few elements that a caller asks about.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import lru_cache
from typing import NamedTuple

from plcopen_sfc.errors import SfcError
from plcopen_sfc.formats.xml.escaping import RawText
from plcopen_sfc.languages.text_edits import Edit

COMMENT = "#comment"
INSTRUCTION = "#instruction"
XML_NAMESPACE = "http://www.w3.org/XML/1998/namespace"


class PatchError(SfcError):
    """An edit that does not go into the source text: a fault of the package, not of the user. Nothing was written."""


class SourceNode:
    """An element, comment or processing instruction: `text[start:end]`.

    `open_end` and `close_start` are the end of the start tag and the beginning of the end tag; for anything without
    content, and for `<a/>`, both are `end`. `name` is the tag as written, or `COMMENT` or `INSTRUCTION`.
    """

    __slots__ = (
        "_children",
        "attributes",
        "close_start",
        "declared",
        "end",
        "name",
        "open_end",
        "parent",
        "start",
        "text",
    )

    def __init__(self, text: str, token: re.Match[str], parent: SourceNode | None) -> None:
        kind = token.lastgroup or ""
        self.text = text
        self.name = token["open"] if kind == "open" else COMMENT if kind == "comment" else INSTRUCTION
        self.start = token.start()
        self.open_end = self.close_start = self.end = token.end()
        if kind == "open" and text[self.open_end - 2] != "/":
            self.close_start, self.end = _end_tag(text, self.name, self.open_end)
        self.parent = parent
        self._children: list[SourceNode] | None = None
        self.attributes: list[SourceAttribute] | None = None
        self.declared: dict[str, str] | None = None

    @property
    def children(self) -> list[SourceNode]:
        """The content directly in this element, in its order; looked for when it is asked for."""
        if self._children is None:
            self._children = [*_nodes(self.text, self.open_end, self.close_start, self)]
        return self._children

    @property
    def is_element(self) -> bool:
        """True if this is an element."""
        return not self.name.startswith("#")

    @property
    def is_closed(self) -> bool:
        """True if this is written as one tag, `<a/>`."""
        return self.open_end == self.end


@dataclass(frozen=True, slots=True)
class SourceAttribute:
    """An attribute as written: `text[start:end]` with the blanks before it from `blank`, its value between quotes."""

    name: str
    blank: int
    start: int
    value_start: int
    value_end: int

    @property
    def end(self) -> int:
        """Behind the closing quote."""
        return self.value_end + 1


@dataclass(frozen=True, slots=True)
class TextSegment:
    """A run of character data: `text[start:end]`; in a CDATA section, `outer_*` include its marks."""

    cdata: bool
    start: int
    end: int
    outer_start: int
    outer_end: int


# Possessive quantifiers (*+, ++) never backtrack, so that a damaged file takes linear time.
_TOKEN = re.compile(
    r"""<(?:(?P<close>/)[^>]*+>|(?P<comment>!--).*?-->|(?P<cdata>!\[CDATA\[).*?\]\]>|(?P<pi>\?).*?\?>"""
    r"""|(?P<open>[^\s/>!?]++)[^>"']*+(?:"[^"]*"[^>"']*+|'[^']*'[^>"']*+)*+>)""",
    re.DOTALL,
)
_PROLOG = re.compile(
    r"""(?:\s++|<\?.*?\?>|<!--.*?-->|<!DOCTYPE(?:[^\[>"']|"[^"]*"|'[^']*'|\[.*?\]\s*(?=>))*>)*+""", re.DOTALL
)
_ATTRIBUTE = re.compile(r"""(\s+)([^\s=]+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
_HAS_MEANING = re.compile("[&\t\r\n]")
_BLANKS = " \t"


class SourceTree:
    """The positions of everything in one source text."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.newline = "\r\n" if "\r" in text and 2 * text.count("\r\n") > text.count("\n") else "\n"
        self.root = self._read()
        self._inherited: dict[tuple[SourceNode, str], str] = {}

    def _read(self) -> SourceNode:
        prolog = _PROLOG.match(self.text)
        nodes = _nodes(self.text, prolog.end() if prolog else 0, len(self.text), None)
        root = next((node for node in nodes if node.is_element), None)
        if root is None:
            raise PatchError("the source text is not well-formed")
        return root

    # Parts of a tag

    def attributes(self, node: SourceNode) -> list[SourceAttribute]:
        """Return attributes in the order written, namespace declarations among them."""
        if node.attributes is None:
            node.attributes = []
            if node.is_element:
                for found in _ATTRIBUTE.finditer(self.text, self.name_end(node), node.open_end):
                    group = 3 if found[3] is not None else 4
                    node.attributes.append(
                        SourceAttribute(found[2], found.start(), found.start(2), found.start(group), found.end(group))
                    )
        return node.attributes

    def name_end(self, node: SourceNode) -> int:
        """Behind the name in the start tag."""
        return node.start + 1 + len(node.name)

    def tag_end(self, node: SourceNode) -> int:
        """Behind the last attribute (or the name) in the start tag."""
        attributes = self.attributes(node)
        return attributes[-1].end if attributes else self.name_end(node)

    def value(self, attribute: SourceAttribute) -> str:
        """Return the value of an attribute, as a parser reports it."""
        raw = self.text[attribute.value_start : attribute.value_end]
        return RawText(raw, attribute=True).value if _HAS_MEANING.search(raw) else raw  # few values have

    def declared(self, node: SourceNode) -> dict[str, str]:
        """Namespaces declared in this start tag, by prefix ("" is the default namespace)."""
        if node.declared is None:
            node.declared = {}
            if self.text.find("xmlns", node.start, node.open_end) >= 0:
                for attribute in self.attributes(node):
                    if attribute.name == "xmlns" or attribute.name.startswith("xmlns:"):
                        node.declared[attribute.name[6:]] = self.value(attribute)
        return node.declared

    def scope(self, node: SourceNode | None) -> dict[str, str]:
        """Return all namespaces in scope inside `node`, by prefix."""
        chain: list[dict[str, str]] = []
        while node is not None:
            chain.append(self.declared(node))
            node = node.parent
        scope = {"xml": XML_NAMESPACE}
        for declared in reversed(chain):
            scope.update(declared)
        return scope

    def namespace(self, node: SourceNode, prefix: str) -> str:
        """Return the namespace that `prefix` means in `node`; "" for none."""
        found = self.declared(node).get(prefix)
        if found is not None:
            return found
        if node.parent is None:
            return XML_NAMESPACE if prefix == "xml" else ""
        known = (node.parent, prefix)
        if known not in self._inherited:
            self._inherited[known] = self.namespace(*known)
        return self._inherited[known]

    def tag(self, node: SourceNode) -> str:
        """Return the tag as lxml names it, `{namespace}local`; `COMMENT` or `INSTRUCTION`."""
        if not node.is_element:
            return node.name
        prefix, _, local = node.name.rpartition(":")
        uri = self.namespace(node, prefix)
        return f"{{{uri}}}{local}" if uri else local

    def named_attributes(self, node: SourceNode) -> dict[str, SourceAttribute]:
        """Return attributes by the name that lxml gives them, without namespace declarations."""
        found: dict[str, SourceAttribute] = {}
        for attribute in self.attributes(node):
            prefix, _, local = attribute.name.rpartition(":")
            if prefix == "xmlns" or attribute.name == "xmlns":
                continue
            found[f"{{{self.namespace(node, prefix)}}}{local}" if prefix else local] = attribute
        return found

    def values(self, node: SourceNode) -> dict[str, str]:
        """SourceAttribute values by the name that lxml gives them."""
        return {name: self.value(attribute) for name, attribute in self.named_attributes(node).items()}

    # Parts between tags

    def segments(self, start: int, end: int) -> list[TextSegment]:
        """Character data between two positions that have no tags between them."""
        found: list[TextSegment] = []
        text = self.text
        while start < end:
            mark = text.find("<![CDATA[", start, end)
            stop = end if mark < 0 else mark
            if stop > start:
                found.append(TextSegment(False, start, stop, start, stop))
            if mark < 0:
                break
            close = text.index("]]>", mark, end)
            found.append(TextSegment(True, mark + 9, close, mark, close + 3))
            start = close + 3
        return found

    def raw(self, segment: TextSegment) -> RawText:
        """Return the segment's characters and their meaning."""
        return RawText(self.text[segment.start : segment.end], cdata=segment.cdata)

    def value_of(self, segments: list[TextSegment]) -> str:
        """Return the text that some segments mean together."""
        return "".join(self.raw(segment).value for segment in segments)

    def content(self, node: SourceNode) -> list[TextSegment]:
        """Return all character data directly in an element."""
        found: list[TextSegment] = []
        position = node.open_end
        for child in node.children:
            found += self.segments(position, child.start)
            position = child.end
        return found + self.segments(position, node.close_start)

    def inner(self, node: SourceNode) -> str:
        """Return the text of a comment or processing instruction."""
        text = self.text[node.start : node.end]
        return text[4:-3] if node.name == COMMENT else text[2:-2].partition(" ")[2]

    # Lines and blanks

    def line_indent(self, node: SourceNode) -> str | None:
        """Return the blanks before a node that is the first on its line; None if there is something else before it."""
        start = self.blank_before(node.start)
        if start > 0 and self.text[start - 1] not in "\r\n":
            return None
        return self.text[start : node.start]

    def blank_before(self, position: int) -> int:
        """Return the first of the blanks that end at `position`."""
        while position > 0 and self.text[position - 1] in _BLANKS:
            position -= 1
        return position

    def blank_after(self, position: int) -> int:
        """Behind the blanks that begin at `position`."""
        while position < len(self.text) and self.text[position] in _BLANKS:
            position += 1
        return position

    def own_lines(self, start: int, end: int) -> tuple[int, int] | None:
        """Return `start` to `end` with the line end before and all blanks, if these lines have nothing else."""
        first, last = self.blank_before(start), self.blank_after(end)
        if first == 0 or self.text[first - 1] not in "\r\n":
            return None
        if last < len(self.text) and self.text[last] not in "\r\n":
            return None
        first -= 2 if self.text[max(first - 2, 0) : first] == "\r\n" else 1
        return first, last


class ElementSpan(NamedTuple):
    """An element with content: `text[start:end]`, its start tag up to `open_end`, its end tag from `close_start`."""

    start: int
    open_end: int
    close_start: int
    end: int


def outermost_elements(text: str, name: str) -> list[ElementSpan]:
    """Return the elements `name` in a well-formed file that are in no other such one; none in a file with a DOCTYPE.

    Looks at no other tag, and so takes a small part of the time of a `SourceTree`. An empty tag counts as an element
    whose content is behind it.
    """
    prolog = _PROLOG.match(text)
    if prolog is None or "<!DOCTYPE" in prolog[0]:  # a search of the whole text takes as long as the rest
        return []
    found: list[ElementSpan] = []
    position = 0
    marks = re.compile(rf"<(?:{name}(?=[\s/>])|!--|!\[CDATA\[|\?)")
    while mark := marks.search(text, position):
        token = _TOKEN.match(text, mark.start()) if mark[0] not in _ENDS else None
        if token is None:
            position = text.index(_ENDS.get(mark[0], ">"), mark.end())
            continue
        close_start = position = open_end = token.end()
        if text[open_end - 2] != "/":
            close_start, position = _end_tag(text, name, open_end)
        found.append(ElementSpan(mark.start(), open_end, close_start, position))
    return found


def _nodes(text: str, start: int, end: int, parent: SourceNode | None) -> Iterator[SourceNode]:
    """Yield the nodes between two positions that are in no other one there."""
    while token := _TOKEN.search(text, start, end):
        start = token.end()
        if token.lastgroup == "close":
            raise PatchError("the source text is not well-formed")
        if token.lastgroup != "cdata":
            node = SourceNode(text, token, parent)
            start = node.end
            yield node


def _end_tag(text: str, name: str, position: int) -> tuple[int, int]:
    """Return the start and the end of the end tag of an element whose start tag ends at `position`.

    Looks at no other tag, which takes a small part of the time.
    """
    depth = 1
    while mark := _marks(name).search(text, position):
        kind = mark[0]
        if kind in _ENDS:
            position = text.find(_ENDS[kind], mark.end())
        elif kind.startswith("</"):
            depth -= 1
            position = text.find(">", mark.end()) + 1
            if depth == 0 and position > 0:
                return mark.start(), position
        else:
            token = _TOKEN.match(text, mark.start())
            position = token.end() if token is not None else -1
            depth += text[position - 2] != "/"
        if position <= 0:
            break
    raise PatchError("the source text is not well-formed")


@lru_cache(maxsize=256)
def _marks(name: str) -> re.Pattern[str]:
    return re.compile(rf"<(?:/?{re.escape(name)}(?=[\s/>])|!--|!\[CDATA\[|\?)")


_ENDS = {"<!--": "-->", "<![CDATA[": "]]>", "<?": "?>"}

_MAX_LINE_PAIRS = 4_000_000


def text_edits(old: str, new: str) -> list[Edit]:
    """Return replacements in rising order that do not overlap; lines that are the same on both sides stay untouched."""
    if old == new:
        return []
    whole = _trim(old, new, 0)
    first, second = whole.text.splitlines(keepends=True), old[whole.start : whole.end].splitlines(keepends=True)
    if len(first) < 2 or len(second) < 2:
        return [whole]
    # Compare whole lines: the trimmed block begins and ends inside lines.
    begin = old.rfind("\n", 0, whole.start) + 1
    finish = len(old) if (stop := old.find("\n", whole.end)) < 0 else stop + 1
    left = old[begin:finish].splitlines(keepends=True)
    right = new[begin : finish + len(new) - len(old)].splitlines(keepends=True)
    if len(left) * len(right) > _MAX_LINE_PAIRS:
        return [whole]
    found: list[Edit] = []
    position, line = begin, 0
    for operation, i1, i2, j1, j2 in SequenceMatcher(None, left, right, autojunk=False).get_opcodes():
        position += sum(map(len, left[line:i1]))
        line = i1
        if operation == "equal":
            continue
        if i2 - i1 == j2 - j1:
            for before, after in zip(left[i1:i2], right[j1:j2], strict=True):
                if before != after:
                    found.append(_trim(before, after, position))
                position += len(before)
            line = i2
        else:
            found.append(_trim("".join(left[i1:i2]), "".join(right[j1:j2]), position))
    return found


def _trim(old: str, new: str, offset: int) -> Edit:
    """Return one replacement without what both begin and end with."""
    limit = min(len(old), len(new))
    head = _common(old, new, limit)
    tail = 0
    while tail < limit - head and old[-1 - tail] == new[-1 - tail]:
        tail += 1
    return Edit(offset + head, offset + len(old) - tail, new[head : len(new) - tail])


def _common(old: str, new: str, limit: int) -> int:
    """Length of the common beginning; by halves, because texts may have megabytes."""
    if old[:limit] == new[:limit]:
        return limit
    low, high = 0, limit
    while high - low > 1:
        middle = (low + high) // 2
        if old[low:middle] == new[low:middle]:
            low = middle
        else:
            high = middle
    return low
