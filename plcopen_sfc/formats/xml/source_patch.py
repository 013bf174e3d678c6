"""Edits of the model as a patch of the source text that changes nothing else.

A three-way merge. `before` is the tree that our writer makes of the model as it was loaded, `after` the tree that the
same writer makes of the edited model; their difference is the edit. The source text corresponds to `before` element by
element, but holds more (comments, unknown attributes and elements, its own style). So the merge walks down all three
together, skips what is equal in `before` and `after`, and where they differ notes which characters of the source are to
be replaced. It never touches what the source has and `before` lacks.

`source_tree` has the positions in the source, `element_alignment` pairs children, `child_places` and `source_style`
lay out new lines and changed texts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lxml import etree

from plcopen_sfc.errors import SfcError
from plcopen_sfc.formats.xml.child_places import (
    ChildLayout,
    Insertion,
    MatchedElement,
    RemovedElements,
    make_empty,
    missing_declarations,
    reindented,
)
from plcopen_sfc.formats.xml.element_alignment import (
    ElementComparison,
    KeyFunction,
    align,
    default_keys,
    longest_rising,
)
from plcopen_sfc.formats.xml.escaping import encode_text, escape_text
from plcopen_sfc.formats.xml.source_style import (
    NewMarkup,
    SourceStyle,
    attribute_changes,
    is_mixed,
    kind_of,
    nodes_of,
    qualified_name,
    text_changes,
    with_source_blanks,
)
from plcopen_sfc.formats.xml.source_tree import PatchError, SourceAttribute, SourceNode, SourceTree, TextSegment
from plcopen_sfc.formats.xml.xml_parsing import decode_xml, parse_xml
from plcopen_sfc.languages.edits import Edit, apply_edits

if TYPE_CHECKING:
    from collections.abc import Mapping


class SourceMerge:
    """One three-way merge: collects the edits of the source text that the difference of two trees asks for."""

    def __init__(
        self, tree: SourceTree, codec: str, before: etree._Element, after: etree._Element, *, keys: KeyFunction
    ) -> None:
        self._tree = tree
        self._before = before
        self._after = after
        self._comparison = ElementComparison(tree, before, after, keys)
        self._style = SourceStyle(tree, codec)
        self._fragments = NewMarkup(self._style, self._reuse)
        self._edits: list[Edit] = []
        self._insertions: list[Insertion] = []
        self._removed = RemovedElements(self._comparison)
        self._moved: dict[etree._Element, MatchedElement] = {}

    def run(self) -> str:
        """Return the edited text."""
        root = self._tree.root
        if not self._tree.tag(root) == kind_of(self._before) == kind_of(self._after):
            raise PatchError(
                f"the root element is <{self._tree.tag(root)}> in the file, <{kind_of(self._before)}> before and "
                f"<{kind_of(self._after)}> after the edit"
            )
        self._element(root, self._before, self._after)
        self._write_insertions()
        return apply_edits(self._tree.text, self._edits)

    # One element. Recursion: `_element` -> `_children` or `_mixed` -> `_element`; depth is bounded by the parser.

    def _element(self, node: SourceNode, before: etree._Element, after: etree._Element) -> None:
        if self._comparison.same(before, after):
            return
        if not node.is_element:
            self._replace(node.start, node.end, self._fragments.note(after))
            return
        self._attributes(node, before, after)
        old_text, new_text = before.text or "", after.text or ""
        has_old, has_new = len(before) > 0, len(after) > 0
        if not has_old and not has_new:
            self._text(node, self._tree.content(node), old_text, new_text, cdata_like=after)
        elif (
            is_mixed(before)
            or is_mixed(after)
            or (not has_old and old_text.strip())
            or (not has_new and new_text.strip())
        ):
            self._mixed(node, before, after)
        else:
            self._children(node, nodes_of(before), nodes_of(after))

    def _attributes(self, node: SourceNode, before: etree._Element, after: etree._Element) -> None:
        written = self._tree.named_attributes(node)
        for name in before.attrib:
            found = written.get(str(name))
            if name not in after.attrib and found is not None:
                self._replace(found.blank, found.end, "")
        anchor = self._last_leading_declaration(node)
        scope = self._tree.scope(node)
        for name, value in after.attrib.items():
            found = written.get(str(name))
            anchor = found or anchor
            if before.get(name) == value:
                continue
            if found is not None:
                self._edits += attribute_changes(self._style, found, str(value))
                continue
            declared: dict[str, str] = {}
            plain = qualified_name(str(name), scope, declared, after.nsmap, attribute=True)
            new = [self._fragments.attribute(f"xmlns:{prefix}", uri) for prefix, uri in declared.items()]
            new.append(self._fragments.attribute(plain, str(value)))
            position = anchor.end if anchor else self._tree.name_end(node)
            blank = self._tree.text[anchor.blank : anchor.start] if anchor else " "
            self._replace(position, position, "".join(blank + text for text in new))

    def _last_leading_declaration(self, node: SourceNode) -> SourceAttribute | None:
        last: SourceAttribute | None = None
        for attribute in self._tree.attributes(node):
            if attribute.name != "xmlns" and not attribute.name.startswith("xmlns:"):
                break
            last = attribute
        return last

    # Children

    def _match(
        self, node: SourceNode, old: list[etree._Element], new: list[etree._Element]
    ) -> tuple[list[SourceNode | None], list[int | None]]:
        """For every node of `old` its place in the source, and for every node of `new` its index in `old`."""
        item = self._comparison.tree_item
        places = align(
            [self._comparison.source_item(child) for child in node.children],
            [item(element, exact=False) for element in old],
        )
        origins = align([item(element) for element in old], [item(element) for element in new])
        return [None if place is None else node.children[place] for place in places], origins

    def _children(self, node: SourceNode, old: list[etree._Element], new: list[etree._Element]) -> None:
        places, origins = self._match(node, old, new)
        stays, going = self._sort_out(places, origins, old, new)
        layout = ChildLayout(self._style, node, going)
        # From the end, to know of every new node which one that stays follows it.
        following: list[SourceNode | None] = [None] * (len(new) + 1)
        for index in range(len(new) - 1, -1, -1):
            following[index] = stays[index][0] if index in stays else following[index + 1]
        anchor: SourceNode | None = None
        insertion: Insertion | None = None
        inserted = False
        for index, element in enumerate(new):
            if index in stays:
                place, original = stays[index]
                self._element(place, original, element)
                anchor, insertion = place, None
                continue
            origin = origins[index]
            if origin is not None and places[origin] is None and self._comparison.same(old[origin], element):
                continue  # the source does without it, and nothing about it was edited
            if insertion is None:
                insertion = layout.insertion(anchor, following[index])
                self._insertions.append(insertion)
            insertion.elements.append(element)
            inserted = True
        self._edits += layout.removals_one_by_one() if inserted else layout.removals()

    def _sort_out(
        self,
        places: list[SourceNode | None],
        origins: list[int | None],
        old: list[etree._Element],
        new: list[etree._Element],
    ) -> tuple[dict[int, MatchedElement], set[SourceNode]]:
        """Which new nodes stay where they are in the source, and which source nodes go (removed or moved)."""
        going: set[SourceNode] = set()
        kept = set(origins)
        for index, place in enumerate(places):
            if index not in kept and place is not None:
                going.add(place)
                self._removed.add(place, old[index])
        followed: list[tuple[int, int, SourceNode]] = []
        for index, origin in enumerate(origins):
            if origin is not None and (place := places[origin]) is not None:
                followed.append((index, origin, place))
        # As many children as possible stay, so that a reordered list is a small diff: those whose old indices rise.
        in_order = longest_rising([origin for _, origin, _ in followed])
        stays: dict[int, MatchedElement] = {}
        for position, (index, origin, place) in enumerate(followed):
            if position in in_order:
                stays[index] = (place, old[origin])
            else:
                going.add(place)
                self._moved[new[index]] = (place, old[origin])
        return stays, going

    # Text

    def _text(
        self,
        node: SourceNode,
        segments: list[TextSegment],
        old: str,
        new: str,
        *,
        cdata_like: etree._Element | None = None,
    ) -> None:
        """Edit the text that `segments` hold together from `old` to `new`."""
        if old == new:
            return
        current = self._tree.value_of(segments)
        new = with_source_blanks(current, old, new)
        if current == new:
            return
        if not new and not node.children:
            self._edits.append(make_empty(self._style, node))
        elif segments:
            self._edits += text_changes(self._style, segments, current, new)
        else:
            plain = escape_text(new, self._style.habits)
            raw = plain if cdata_like is None else self._fragments.text(cdata_like)
            self._fill(node, raw, node.open_end)

    def _fill(self, node: SourceNode, raw: str, end: int) -> None:
        """Put content into an element, in place of its content up to `end`."""
        if node.is_closed:
            self._replace(self._tree.tag_end(node), node.end, f">{raw}</{node.name}>")
        else:
            self._replace(node.open_end, end, raw)

    # Text beside children

    def _mixed(self, node: SourceNode, before: etree._Element, after: etree._Element) -> None:
        old, new = nodes_of(before), nodes_of(after)
        places, origins = self._match(node, old, new)
        found = [place for place in places if place is not None]
        in_order = found == sorted(found, key=lambda place: place.start)
        if origins == list(range(len(old))) and len(found) == len(old) and in_order:
            self._mixed_runs(node, before, after, found)
            for place, original, element in zip(found, old, new, strict=True):
                self._element(place, original, element)
            return
        used = {places[origin] for origin in origins if origin is not None}
        for index, gone in enumerate(places):
            if gone is not None and gone not in used:
                self._removed.add(gone, old[index])
        matched: list[MatchedElement | None] = []
        for origin in origins:
            known = None if origin is None else places[origin]
            matched.append(None if origin is None or known is None else (known, old[origin]))
        self._fill(node, self._mixed_anew(node, after, matched, set(found)), node.close_start)

    def _runs(self, node: SourceNode, known: set[SourceNode]) -> list[list[TextSegment]]:
        """Return the text before, between and behind the children in `known`."""
        runs: list[list[TextSegment]] = [[]]
        position = node.open_end
        for child in node.children:
            runs[-1] += self._tree.segments(position, child.start)
            position = child.end
            if child in known:
                runs.append([])
        runs[-1] += self._tree.segments(position, node.close_start)
        return runs

    def _mixed_runs(
        self, node: SourceNode, before: etree._Element, after: etree._Element, places: list[SourceNode]
    ) -> None:
        """The children are the same ones: change the text between them, piece by piece."""
        runs = self._runs(node, set(places))
        starts = [node.open_end, *(place.end for place in places)]
        for run, start, old, new in zip(runs, starts, _texts(before), _texts(after), strict=True):
            if run or old == new:
                self._text(node, run, old, new)
            else:
                self._replace(start, start, escape_text(new, self._style.habits))

    def _mixed_anew(
        self, node: SourceNode, after: etree._Element, matched: list[MatchedElement | None], known: set[SourceNode]
    ) -> str:
        """Return the content, out of the old texts where they are still wanted."""
        tree = self._tree
        scope = tree.scope(node)
        empty_end = self._style.empty_end(node.start)
        raw_of = {
            tree.value_of(run): tree.text[run[0].outer_start : run[-1].outer_end]
            for run in self._runs(node, set(node.children))
            if run
        }

        def written(text: str) -> str:
            return raw_of.get(text) or escape_text(text, self._style.habits)

        parts = [*self._unknown_behind(node, None, known), written(after.text or "")]
        for element, origin in zip(after, matched, strict=True):
            if origin is None:
                parts.append(self._fragments.render(element, scope, None, "", empty_end))
            else:
                parts.append(self._slice(*origin, element))
                parts += self._unknown_behind(node, origin[0], known)
            parts.append(written(element.tail or ""))
        return "".join(parts)

    def _unknown_behind(self, node: SourceNode, place: SourceNode | None, known: set[SourceNode]) -> list[str]:
        """Return the source's own nodes directly behind `place`, which the trees do not have."""
        found: list[str] = []
        for child in node.children[node.children.index(place) + 1 if place else 0 :]:
            if child in known:
                break
            found.append(self._tree.text[child.start : child.end])
        return found

    # Writing

    def _replace(self, start: int, end: int, text: str) -> None:
        self._edits.append(Edit(start, end, text))

    def _write_insertions(self) -> None:
        """Turn the noted insertions into edits. Only now all that goes, and may come in elsewhere, is known."""
        waiting, self._insertions = self._insertions, []
        for insertion in waiting:
            scope = self._tree.scope(insertion.parent)
            unit = self._style.unit(insertion.parent)
            empty_end = self._style.empty_end(insertion.start)
            parts: list[str] = []
            for element in insertion.elements:
                parts.append(insertion.separator if parts else insertion.first_separator)
                parts.append(self._fragments.render(element, scope, insertion.indent, unit, empty_end))
            self._replace(insertion.start, insertion.end, f"{insertion.head}{''.join(parts)}{insertion.tail}")

    def _slice(
        self, node: SourceNode, before: etree._Element, after: etree._Element, scope: Mapping[str, str] | None = None
    ) -> str:
        """Return the source text of `node` with the edits inside it, for a place where `scope` holds."""
        outer = self._edits, self._insertions
        self._edits, self._insertions = [], []
        if scope is not None:
            for prefix, uri in missing_declarations(self._tree, node, scope).items():
                name = f"xmlns:{prefix}" if prefix else "xmlns"
                end = self._tree.name_end(node)
                self._replace(end, end, f" {self._fragments.attribute(name, uri)}")
        self._element(node, before, after)
        self._write_insertions()
        edits = self._edits
        self._edits, self._insertions = outer
        return apply_edits(self._tree.text, edits, node.start, node.end)

    def _reuse(self, element: etree._Element, scope: Mapping[str, str], indent: str | None) -> str | None:
        """Return the source text of an element that was moved; None for a new one."""
        origin = self._moved.pop(element, None) or self._removed.take(element)
        if origin is None:
            return None
        text = self._slice(*origin, element, scope)
        old = self._tree.line_indent(origin[0])
        if old is None or indent is None:
            return text
        return reindented(text, old, indent)


def _texts(element: etree._Element) -> list[str]:
    return [element.text or "", *(child.tail or "" for child in element)]


def patch_xml(
    source: bytes, before: etree._Element, after: etree._Element, *, keys: KeyFunction = default_keys
) -> bytes:
    """Return `source` with the difference from `before` to `after`; byte for byte the same where they are equal.

    `keys` names the identifying attributes of an element, strongest first. Raises `PatchError` if the result would not
    be well-formed or `before` does not describe `source`, and `EncodingError` if a new name cannot be written in the
    encoding of the file.
    """
    if before is after:
        return source
    text, encoding = decode_xml(source)
    # Some codecs are not reversible byte for byte; a patch must not change the rest of such a file.
    if encoding.encode(text) != source:
        raise PatchError(f"the source text does not come back the same from {encoding.codec}")
    try:
        edited = SourceMerge(SourceTree(text), encoding.codec, before, after, keys=keys).run()
    except ValueError as error:
        if isinstance(error, SfcError):
            raise
        raise PatchError(f"the edits of the source text contradict each other: {error}") from error
    if edited == text:
        return source
    result = encoding.bom + encode_text(edited, encoding.codec)
    try:
        # The patch edits text, not a tree: a result that is not well-formed must not reach the disk.
        parse_xml(result)
    except SfcError as error:
        raise PatchError(f"the edited file would be damaged: {error.message}", location=error.location) from error
    return result
