"""New text in the style of the file that it goes into: elements, attributes, and changed values.

A change of a value stays inside the CDATA section that holds it and keeps the references that its author wrote.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias, cast

from lxml import etree

from plcopen_sfc.formats.xml.escaping import Habits, RawText, escape_attribute, escape_text
from plcopen_sfc.formats.xml.source_tree import COMMENT, INSTRUCTION, XML_NAMESPACE, SourceNode, SourceTree, text_edits
from plcopen_sfc.languages.text_edits import Edit, apply_edits

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcopen_sfc.formats.xml.source_tree import SourceAttribute, TextSegment


_XML_SPACE = f"{{{XML_NAMESPACE}}}space"


def kind_of(element: etree._Element) -> str:
    """Return the tag of an element; `COMMENT` or `INSTRUCTION` for those."""
    tag = cast("object", element.tag)
    if isinstance(tag, str):
        return tag
    return COMMENT if tag is etree.Comment else INSTRUCTION


def is_mixed(element: etree._Element) -> bool:
    """True if an element has text beside other nodes, so that its white space counts."""
    if len(element) == 0:
        return False
    if element.get(_XML_SPACE) == "preserve":
        return True
    return bool((element.text or "").strip()) or any((child.tail or "").strip() for child in element)


class SourceStyle:
    """Style of a source file, for new text in it."""

    def __init__(self, tree: SourceTree, codec: str) -> None:
        self.tree = tree
        self.codec = codec
        self.newline = tree.newline
        # An escaped ">" is a habit of writers; without any to be seen, escape: it is right everywhere.
        self.habits = Habits("", newline=self.newline)
        self._collapses = "/>" in tree.text or "></" not in tree.text
        self._unit: str | None = None

    @cached_property
    def quote(self) -> str:
        """The quotes of most attributes: of a file of many megabytes, only a new attribute asks for them."""
        text = self.tree.text
        return "'" if text.count("='") > text.count('="') else '"'

    def encodable(self, text: str) -> bool:
        """True if the encoding of the file has all these characters."""
        try:
            text.encode(self.codec)
        except UnicodeEncodeError:
            return False
        return True

    def empty_end(self, position: int) -> str | None:
        """Return the end of an empty element near `position`, "/>" or " />"; None where the file writes `<a></a>`."""
        if not self._collapses:
            return None
        text = self.tree.text
        found = text.rfind("/>", 0, position)
        if found < 0:
            found = text.find("/>", position)
        if found < 0:
            return " />"
        return " />" if text[found - 1] in " \t\r\n" else "/>"

    def unit(self, node: SourceNode) -> str:
        """Return one level of indentation near `node`."""
        here: SourceNode | None = node
        while here is not None:
            step = self._step(here)
            if step:
                return step
            here = here.parent
        if self._unit is None:
            self._unit = self._first_step(self.tree.root) or "  "
        return self._unit

    def _step(self, parent: SourceNode) -> str | None:
        outer = self.tree.line_indent(parent)
        if outer is None:
            return None
        for child in parent.children[:8]:
            inner = self.tree.line_indent(child) if child.is_element else None
            if inner is not None and len(inner) > len(outer) and inner.startswith(outer):
                return inner[len(outer) :]
        return None

    def _first_step(self, root: SourceNode) -> str | None:
        waiting = [root]
        for node in waiting:
            if step := self._step(node):
                return step
            waiting += node.children[:20]
            if len(waiting) > 500:
                break
        return None

    def child_indent(self, parent: SourceNode) -> str | None:
        """Return the indentation of the children of `parent`; None where they are in one line with it."""
        for child in parent.children:
            indent = self.tree.line_indent(child)
            if indent is not None:
                return indent
        if parent.children:
            return None
        outer = self.tree.line_indent(parent)
        if outer is None or (parent.parent is None and "\n" not in self.tree.text):
            return None
        return outer + self.unit(parent)


Reuse: TypeAlias = Callable[[etree._Element, Mapping[str, str], str | None], str | None]
"""Gives the source text of an element that was only moved here; None for one that is new."""


class NewMarkup:
    """Writes elements that the source does not have yet."""

    def __init__(self, style: SourceStyle, reuse: Reuse) -> None:
        self._style = style
        self._reuse = reuse

    def render(
        self,
        element: etree._Element,
        scope: Mapping[str, str],
        indent: str | None,
        unit: str,
        empty_end: str | None,
    ) -> str:
        """Return `element` as text, from its first `<`; its children on lines of their own unless `indent` is None."""
        if (moved := self._reuse(element, scope, indent)) is not None:
            return moved
        if not isinstance(cast("object", element.tag), str):
            return self.note(element)
        scope = dict(scope)
        declared: dict[str, str] = {}
        name = qualified_name(element.tag, scope, declared, element.nsmap)
        tag = [name]
        for key, value in element.attrib.items():
            written = qualified_name(str(key), scope, declared, element.nsmap, attribute=True)
            tag.append(self.attribute(written, str(value)))
        tag[1:1] = [self.attribute(f"xmlns:{prefix}" if prefix else "xmlns", uri) for prefix, uri in declared.items()]
        head = " ".join(tag)
        inner = self._content(element, scope, indent, unit, empty_end)
        if inner:
            return f"<{head}>{inner}</{name}>"
        return f"<{head}></{name}>" if empty_end is None else f"<{head}{empty_end}"

    def _content(
        self, element: etree._Element, scope: Mapping[str, str], indent: str | None, unit: str, empty_end: str | None
    ) -> str:
        children = list(element)
        if not children:
            return self.text(element)
        mixed = is_mixed(element)
        inner = None if indent is None or mixed else indent + unit
        line = "" if inner is None else self._style.newline + inner
        parts = [escape_text(element.text or "", self._style.habits)] if mixed else []
        # No comprehensions: each level of nesting should take two frames of the stack, not three.
        for child in children:
            parts.append(line)
            parts.append(self.render(child, scope, inner, unit, empty_end))
            if mixed:
                parts.append(escape_text(child.tail or "", self._style.habits))
        if inner is not None:
            parts.append(f"{self._style.newline}{indent}")
        return "".join(parts)

    def note(self, element: etree._Element) -> str:
        """Return a comment or processing instruction."""
        return etree.tostring(element, encoding="unicode", with_tail=False).replace("\n", self._style.newline)

    def text(self, element: etree._Element) -> str:
        """Return the text of an element without children, as CDATA if the tree marks it so and it can be."""
        value = element.text or ""
        # lxml tells of CDATA only when it writes; anywhere else it escapes the "<".
        wanted = value and b"<![CDATA[" in etree.tostring(element, with_tail=False)
        if wanted and "]]>" not in value and "\r" not in value and self._style.encodable(value):
            return "<![CDATA[" + value.replace("\n", self._style.newline) + "]]>"
        return escape_text(value, self._style.habits)

    def attribute(self, name: str, value: str) -> str:
        """`name="value"`."""
        quote = self._style.quote
        return f"{name}={quote}{escape_attribute(value, quote, self._style.habits)}{quote}"


def qualified_name(
    name: str,
    scope: dict[str, str],
    declared: dict[str, str],
    hints: Mapping[str | None, str],
    *,
    attribute: bool = False,
) -> str:
    """Return `name` as written in `scope`; a namespace that is not in scope is put into `declared` (and `scope`).

    `hints` are the prefixes that the tree uses; they are taken if they do not hide another namespace.
    """
    uri, _, local = name.rpartition("}")
    uri = uri[1:]
    if not uri:
        if not attribute and scope.get(""):
            scope[""] = declared[""] = ""
        return local
    for prefix, known in scope.items():
        if known == uri and (prefix or not attribute):
            return f"{prefix}:{local}" if prefix else local
    prefix = next((hint or "" for hint, known in hints.items() if known == uri and (hint or not attribute)), "ns")
    number = 0
    base = prefix or "ns"
    while prefix in scope and (prefix != "" or attribute):
        number += 1
        prefix = f"{base}{number}"
    scope[prefix] = declared[prefix] = uri
    return f"{prefix}:{local}" if prefix else local


def attribute_changes(style: SourceStyle, attribute: SourceAttribute, value: str) -> Iterator[Edit]:
    """Edits of the source that give an attribute another value."""
    text = style.tree.text
    start = attribute.value_start
    raw = RawText(text[start : attribute.value_end], attribute=True)
    habits = Habits(raw.raw, newline=style.newline)
    quote = text[attribute.value_end]
    for change in text_edits(raw.value, value):
        yield Edit(
            start + raw.raw_position(change.start),
            start + raw.raw_position(change.end),
            escape_attribute(change.text, quote, habits),
        )


def with_source_blanks(current: str, old: str, new: str) -> str:
    """Return `new` with the blanks that the source has around the text, if the writer does not keep them.

    `current` is the text in the source, `old` what the writer made of it: a difference in the blanks at both ends is
    not part of the edit.
    """
    if current == old or current.strip() != old.strip() or not old.strip():
        return new
    return current[: len(current) - len(current.lstrip())] + new.strip() + current[len(current.rstrip()) :]


def text_changes(style: SourceStyle, segments: list[TextSegment], current: str, new: str) -> Iterator[Edit]:
    """Edits of the source that turn the text `current`, which `segments` hold together, into `new`."""
    waiting = text_edits(current, new)
    begin = 0
    for index, segment in enumerate(segments):
        raw = style.tree.raw(segment)
        end = begin + len(raw.value)
        last = index == len(segments) - 1
        mine: list[Edit] = []
        rest: list[Edit] = []
        for change in waiting:
            # An insertion between two segments goes to the first of them, unless the second is the CDATA section.
            between = change.start == end and not last
            if change.start > end or (between and (change.end > end or segments[index + 1].cdata > segment.cdata)):
                rest.append(change)
                continue
            mine.append(Edit(change.start - begin, min(change.end, end) - begin, change.text))
            if change.end > end:
                rest.append(Edit(end, change.end, ""))
        waiting = rest
        begin = end
        if mine:
            yield from _segment_changes(style, segment, raw, mine)


def _segment_changes(style: SourceStyle, segment: TextSegment, raw: RawText, mine: list[Edit]) -> Iterator[Edit]:
    value = apply_edits(raw.value, mine)
    newline = style.newline
    if "\n" in raw.value:
        newline = "\r\n" if "\r\n" in raw.raw else "\n"
    if segment.cdata:
        habits = Habits("", newline=newline)
        if not value:
            yield Edit(segment.outer_start, segment.outer_end, "")
            return
        if "]]>" in value or "\r" in value or not style.encodable(value):
            yield Edit(segment.outer_start, segment.outer_end, escape_text(value, habits))
            return
    else:
        habits = Habits(raw.raw, newline=newline)
        if "]]>" in value and not habits.greater:
            # The three characters may come together from old and new ones; text must not contain them.
            yield Edit(segment.start, segment.end, escape_text(value, habits))
            return
    for change in mine:
        text = change.text.replace("\n", newline) if segment.cdata else escape_text(change.text, habits)
        yield Edit(segment.start + raw.raw_position(change.start), segment.start + raw.raw_position(change.end), text)
