"""Edits of the model as a patch of the source text that changes nothing else.

A three-way merge. `before` is the tree that our writer makes of the model as it was loaded, `after` the tree that the
same writer makes of the edited model; their difference is the edit. The source text corresponds to `before` element by
element, but holds more (comments, unknown attributes and elements, its own style). So the merge walks down all three
together, skips what is equal in `before` and `after`, and where they differ notes which characters of the source are to
be replaced. It never touches what the source has and `before` lacks.

`source_tree` has the positions in the source, `element_alignment` pairs children, `source_style` lays out new lines and
changed texts. `ChildLayout` knows where a child is removed, where a new one goes in, where a moved one was. A moved
element takes its source text along, with all that only the source knows about it.
"""

from __future__ import annotations

from collections import defaultdict, deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from lxml import etree

from plcopen_sfc.errors import SfcError
from plcopen_sfc.formats.xml.element_alignment import (
    ElementComparison,
    align,
    longest_rising,
    similarity,
)
from plcopen_sfc.formats.xml.escaping import encode_text, escape_text
from plcopen_sfc.formats.xml.source_style import (
    NewMarkup,
    SourceStyle,
    attribute_changes,
    is_mixed,
    kind_of,
    qualified_name,
    text_changes,
    with_source_blanks,
)
from plcopen_sfc.formats.xml.source_tree import (
    COMMENT,
    PatchError,
    SourceAttribute,
    SourceNode,
    SourceTree,
    TextSegment,
)
from plcopen_sfc.formats.xml.xml_parsing import decode_xml, parse_xml
from plcopen_sfc.languages.text_edits import Edit, apply_edits

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator, Mapping
    from collections.abc import Set as AbstractSet


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

    def removals(self, *, refilled: bool) -> list[Edit]:
        """Return the edits that remove the children in `going`; all content, if nothing but blanks would be left.

        `refilled`: something new comes in.
        """
        parent = self._parent
        if refilled or not self._going or any(child not in self._going for child in parent.children):
            return self._removals
        if self._tree.value_of(self._tree.content(parent)).strip():
            return self._removals
        return [make_empty(self._style, parent)]

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
"""Share of equal content from which on an element with the keys of a removed one is that one, moved and edited."""

_MAX_INSIDE = 20_000
"""Elements inside of removed ones that are remembered one by one; those of more are found again as a whole only."""


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
        # equal content first, then the same keys: what was moved is told from what was moved and edited
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
        children = [child for child in element if not kind_of(child).startswith("#")]
        self._inside += len(children)
        # Every removed subtree is aligned with its source here; the bound keeps the removal of a whole project fast.
        if not children or self._inside > _MAX_INSIDE:
            return
        places = align(
            [self._comparison.source_item(child) for child in node.children],
            [self._comparison.tree_item(child) for child in children],
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


class SourceMerge:
    """One three-way merge: collects the edits of the source text that the difference of two trees asks for."""

    def __init__(self, tree: SourceTree, codec: str, before: etree._Element, after: etree._Element) -> None:
        self._tree = tree
        self._before = before
        self._after = after
        self._comparison = ElementComparison(tree, before, after)
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
        if not self._comparison.same(self._before, self._after):
            self._element(root, self._before, self._after)
        self._write_insertions()
        return apply_edits(self._tree.text, self._edits)

    # One element. Recursion: `_element` -> `_children` or `_mixed` -> `_element`; depth is bounded by the parser.

    def _element(self, node: SourceNode, before: etree._Element, after: etree._Element) -> None:
        """Edit a node whose content differs."""
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
            self._children(node, list(before), list(after))

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
            # a tool that writes each attribute on a line of its own gets the new one so, too
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
    ) -> tuple[list[SourceNode | None], list[int | None], set[int]]:
        """For every node of `old` its place in the source, and for every node of `new` its index in `old`.

        Also the indices in `new` of those that are equal to what they are in `old`.
        """
        item = self._comparison.tree_item
        left, right = [item(element) for element in old], [item(element) for element in new]
        # by keys and names: the source has more in each element than `before`, so that equal bytes would mean nothing
        places = align([self._comparison.source_item(child) for child in node.children], left)
        origins = align(left, right)
        pairs = [(origin, index) for index, origin in enumerate(origins) if origin is not None]
        equal = {index for origin, index in pairs if left[origin].exact == right[index].exact}
        return [None if place is None else node.children[place] for place in places], origins, equal

    def _children(self, node: SourceNode, old: list[etree._Element], new: list[etree._Element]) -> None:
        places, origins, equal = self._match(node, old, new)
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
                if index not in equal:
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
        self._edits += layout.removals(refilled=inserted)

    def _sort_out(
        self,
        places: list[SourceNode | None],
        origins: list[int | None],
        old: list[etree._Element],
        new: list[etree._Element],
    ) -> tuple[dict[int, MatchedElement], set[SourceNode]]:
        """Return which new nodes stay where they are in the source, and which source nodes go (removed or moved)."""
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
        old, new = list(before), list(after)
        places, origins, _ = self._match(node, old, new)
        found = [place for place in places if place is not None]
        in_order = found == sorted(found, key=lambda place: place.start)
        if origins == list(range(len(old))) and len(found) == len(old) and in_order:
            self._mixed_runs(node, before, after, found)
            for place, original, element in zip(found, old, new, strict=True):
                if not self._comparison.same(original, element):
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
        self._fill(node, self._mixed_content(node, after, matched, set(found)), node.close_start)

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
        """The children are the same ones: change the texts between them, one by one."""
        runs = self._runs(node, set(places))
        starts = [node.open_end, *(place.end for place in places)]
        for run, start, old, new in zip(runs, starts, _texts(before), _texts(after), strict=True):
            if run or old == new:
                self._text(node, run, old, new)
            else:
                self._replace(start, start, escape_text(new, self._style.habits))

    def _mixed_content(
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
        # edits of a moved element belong into its text at the new place, not into the source where it was
        outer = self._edits, self._insertions
        self._edits, self._insertions = [], []
        if scope is not None:
            for prefix, uri in missing_declarations(self._tree, node, scope).items():
                name = f"xmlns:{prefix}" if prefix else "xmlns"
                end = self._tree.name_end(node)
                self._replace(end, end, f" {self._fragments.attribute(name, uri)}")
        if not self._comparison.same(before, after):
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


def patch_xml(source: bytes, before: etree._Element, after: etree._Element) -> bytes:
    """Return `source` with the difference from `before` to `after`; byte for byte the same where they are equal.

    Raises `PatchError` if the result would not be well-formed or `before` does not describe `source`, and
    `EncodingError` if a new name cannot be written in the encoding of the file.
    """
    if before is after:
        return source
    text, encoding = decode_xml(source)
    # a patch must not change the rest of the file
    if not encoding.is_reversible(text, source):
        raise PatchError(f"the source text does not come back the same from {encoding.codec}")
    try:
        edited = SourceMerge(SourceTree(text), encoding.codec, before, after).run()
    except ValueError as error:
        # `apply_edits` refuses edits that overlap: a mistake of this package, which must end in an error
        # and not in a damaged file
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
