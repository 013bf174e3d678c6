"""Put an edit of the model into the source text, and change nothing else.

A three-way merge. `before` is the tree that our writer makes of the model as it was loaded, `after` the tree that the
same writer makes of the edited model; their difference is the edit. The source text corresponds to `before` element by
element, but says more (comments, unknown attributes and elements, its own handwriting). So: walk down all three
together, skip what is equal in `before` and `after`, and where they differ note which characters of the source are to
be replaced. What the source has and `before` lacks is never touched.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Mapping
from typing import Any, cast

from lxml import etree

from plcopen_sfc.errors import SfcError
from plcopen_sfc.formats.xml.align import Item, KeyFunction, align, default_keys, longest_rising
from plcopen_sfc.formats.xml.escaping import Habits, RawText, encode_text, escape_attribute, escape_text
from plcopen_sfc.formats.xml.fragments import Fragments, Handwriting, is_mixed, kind_of, nodes_of, qualified_name
from plcopen_sfc.formats.xml.source import decode, parse
from plcopen_sfc.formats.xml.textdiff import Change, changes
from plcopen_sfc.formats.xml.tokens import COMMENT, Attribute, Node, PatchError, Segment, SourceTree

__all__ = ["PatchError", "patch"]


def patch(source: bytes, before: etree._Element, after: etree._Element, *, keys: KeyFunction = default_keys) -> bytes:
    """`source` with the difference from `before` to `after` applied; byte for byte the same where they are equal.

    `keys` names the identifying attributes of an element, strongest first. Raises `PatchError` if the result would not
    be well-formed or `before` does not describe `source`, and `EncodingError` if a new name cannot be written in the
    encoding of the file.
    """
    if before is after:
        return source
    text, encoding = decode(source)
    if encoding.encode(text) != source:
        raise PatchError(f"the source text does not come back the same in {encoding.codec}")
    edited = _Merge(text, encoding.codec, before, after, keys).run()
    if edited == text:
        return source
    result = encoding.bom + encode_text(edited, encoding.codec)
    try:
        parse(result)
    except SfcError as error:
        raise PatchError(f"the edited file would be damaged: {error.message}", location=error.location) from error
    return result


class _Insertion:
    """New nodes for one place: `text[start:end]` becomes `head`, then every node after `separator`, then `tail`."""

    def __init__(
        self,
        parent: Node,
        start: int,
        end: int,
        *,
        head: str = "",
        tail: str = "",
        indent: str | None,
        separator: str,
    ) -> None:
        self.parent = parent
        self.start = start
        self.end = end
        self.head = head
        self.tail = tail
        self.indent = indent
        self.separator = separator
        self.elements: list[etree._Element] = []


class _Merge:
    def __init__(self, text: str, codec: str, before: etree._Element, after: etree._Element, keys: KeyFunction) -> None:
        self.tree = SourceTree(text)
        self.codec = codec
        self.writing = Handwriting(self.tree)
        self.fragments = Fragments(self.writing, self._reuse)
        self.keys = keys
        self.before = before
        self.after = after
        # Plain serialisation names all namespaces in scope, so it only compares trees that declare the same.
        self.method = "xml" if before.nsmap == after.nsmap else "c14n"
        self.edits: list[Change] = []
        self.insertions: list[_Insertion] = []
        self.removed: list[tuple[Node, etree._Element]] = []
        self.moved: dict[etree._Element, tuple[Node, etree._Element]] = {}

    def run(self) -> str:
        root = self.tree.root
        if self.tree.tag(root) != kind_of(self.before) or kind_of(self.before) != kind_of(self.after):
            raise PatchError(f"the root element is <{self.tree.tag(root)}>, not <{kind_of(self.before)}>")
        self._element(root, self.before, self.after)
        self._insert()
        return _apply(self.tree.text, self.edits, 0, len(self.tree.text))

    # Comparing

    def _bytes(self, element: etree._Element) -> bytes:
        if self.method == "c14n" and isinstance(cast("object", element.tag), str):
            return etree.tostring(element, method="c14n", exclusive=True)
        return etree.tostring(element, with_tail=False)

    def _same(self, before: etree._Element, after: etree._Element) -> bool:
        return self._bytes(before) == self._bytes(after)

    def _tree_items(self, elements: Iterable[etree._Element], *, exact: bool) -> list[Item]:
        items: list[Item] = []
        for element in elements:
            tag = kind_of(element)
            keys = self.keys(tag, cast("Any", element.attrib)) if not tag.startswith("#") else ()
            items.append(
                Item(
                    tag,
                    keys,
                    (lambda element=element: self._bytes(element)) if exact else None,
                    lambda element=element: tree_features(element),
                )
            )
        return items

    def _source_items(self, nodes: Iterable[Node]) -> list[Item]:
        items: list[Item] = []
        for node in nodes:
            tag = self.tree.tag(node)
            keys = self.keys(tag, self._values(node)) if node.is_element else ()
            items.append(Item(tag, keys, None, lambda node=node: source_features(self.tree, node)))
        return items

    def _values(self, node: Node) -> dict[str, str]:
        return {name: self.tree.value(found) for name, found in self.tree.named_attributes(node).items()}

    # Walking down

    def _element(self, node: Node, before: etree._Element, after: etree._Element) -> None:
        if before is after or self._same(before, after):
            return
        if not node.is_element:
            self._replace(node.start, node.end, etree.tostring(after, encoding="unicode", with_tail=False))
            return
        self._attributes(node, before, after)
        self._content(node, before, after)

    def _attributes(self, node: Node, before: etree._Element, after: etree._Element) -> None:
        written = self.tree.named_attributes(node)
        for name in before.attrib:
            found = written.get(str(name))
            if name not in after.attrib and found is not None:
                self._replace(found.blank, found.end, "")
        anchor = self._leading_declarations(node)
        scope = self.tree.scope(node)
        for name, value in after.attrib.items():
            found = written.get(str(name))
            if found is not None:
                anchor = found
            if before.get(name) == value:
                continue
            if found is not None:
                self._attribute_value(found, str(value))
                continue
            declared: dict[str, str] = {}
            plain = qualified_name(str(name), scope, declared, after.nsmap, attribute=True)
            position = anchor.end if anchor else self.tree.name_end(node)
            blank = self.tree.text[anchor.blank : anchor.start] if anchor else " "
            new = [self.fragments.attribute(f"xmlns:{prefix}", uri) for prefix, uri in declared.items()]
            new.append(self.fragments.attribute(plain, str(value)))
            self._replace(position, position, "".join(blank + text for text in new))

    def _leading_declarations(self, node: Node) -> Attribute | None:
        last: Attribute | None = None
        for attribute in self.tree.attributes(node):
            if not attribute.name.startswith("xmlns"):
                break
            last = attribute
        return last

    def _attribute_value(self, found: Attribute, value: str) -> None:
        text = self.tree.text
        raw = RawText(text[found.value_start : found.value_end], attribute=True)
        habits = Habits(raw.raw, newline=self.tree.newline)
        for change in changes(raw.value, value):
            self._replace(
                found.value_start + raw.raw_position(change.start),
                found.value_start + raw.raw_position(change.end),
                escape_attribute(change.text, text[found.value_end], habits),
            )

    def _content(self, node: Node, before: etree._Element, after: etree._Element) -> None:
        old, new = nodes_of(before), nodes_of(after)
        if not old and not new:
            self._text(node, self.tree.content(node), before.text or "", after.text or "")
        elif (
            is_mixed(before)
            or is_mixed(after)
            or (not old and (before.text or "").strip())
            or (not new and (after.text or "").strip())
        ):
            self._mixed(node, before, after, old, new)
        else:
            self._children(node, old, new)

    # Children on their own

    def _match(
        self, node: Node, old: list[etree._Element], new: list[etree._Element]
    ) -> tuple[list[Node | None], list[int | None]]:
        """For every node of `old` its place in the source, and for every node of `new` its index in `old`."""
        places = align(self._source_items(node.children), self._tree_items(old, exact=False))
        origins = align(self._tree_items(old, exact=True), self._tree_items(new, exact=True))
        return [None if place is None else node.children[place] for place in places], origins

    def _children(self, node: Node, old: list[etree._Element], new: list[etree._Element]) -> None:
        places, origins = self._match(node, old, new)
        kept = set(origins)
        going: set[Node] = set()
        for index, place in enumerate(places):
            if index not in kept and place is not None:
                going.add(place)
                self.removed.append((place, old[index]))
        followed = [(index, origin) for index, origin in enumerate(origins) if origin is not None and places[origin]]
        staying = longest_rising([origin for _, origin in followed])
        stays: dict[int, tuple[Node, etree._Element]] = {}
        for position, (index, origin) in enumerate(followed):
            place = places[origin]
            if place is None:
                continue
            if position in staying:
                stays[index] = (place, old[origin])
            else:
                going.add(place)
                self.moved[new[index]] = (place, old[origin])
        self._remove(node, going)
        anchor: Node | None = None
        insertion: _Insertion | None = None
        for index, element in enumerate(new):
            if index in stays:
                place, original = stays[index]
                self._element(place, original, element)
                anchor, insertion = place, None
                continue
            origin = origins[index]
            if origin is not None and places[origin] is None and self._same(old[origin], element):
                continue  # the source does without it, and nothing about it was edited
            if insertion is None:
                following = next((stays[later][0] for later in range(index, len(new)) if later in stays), None)
                insertion = self._insertion(node, anchor, following, going)
            insertion.elements.append(element)
        if not new or (not stays and insertion is None):
            self._collapse(node, going)

    def _remove(self, node: Node, going: set[Node]) -> None:
        """Remove child nodes, with their lines where nothing else stands on them."""
        text = self.tree.text
        run: list[Node] = []
        for child in [*node.children, None]:
            if child in going and child is not None:
                between = text[run[-1].end : child.start] if run else ""
                if run and (between.strip() or "\n" in between):
                    self._remove_run(run)
                    run = []
                run.append(child)
            elif run:
                self._remove_run(run)
                run = []

    def _remove_run(self, run: list[Node]) -> None:
        start, end = run[0].start, run[-1].end
        lines = self.tree.own_lines(start, end)
        self._replace(*(lines or (start, end)), "")

    def _collapse(self, node: Node, going: set[Node]) -> None:
        """Write an element whose last child goes as an empty one, if nothing else is left in it."""
        if node.is_closed or any(child not in going for child in node.children):
            return
        if self.tree.value_of(self.tree.content(node)).strip():
            return
        self.edits = [edit for edit in self.edits if not (node.open_end <= edit.start and edit.end <= node.close_start)]
        self._make_empty(node)

    def _make_empty(self, node: Node) -> None:
        empty_end = self.writing.empty_end(node.start)
        if empty_end is None:
            self._replace(node.open_end, node.close_start, "")
        else:
            self._replace(self.tree.tag_end(node), node.end, empty_end)

    def _insertion(self, node: Node, anchor: Node | None, following: Node | None, going: set[Node]) -> _Insertion:
        """The place for new children of `node` behind `anchor`, or before `following`, or as the first ones."""
        indent = self.writing.child_indent(node)
        separator = "" if indent is None else self.tree.newline + indent
        if not node.children and not self.tree.value_of(self.tree.content(node)).strip():
            insertion = self._fill(node, indent, separator)
        else:
            place = self._behind(node, anchor, indent) if anchor else self._ahead(node, following, going)
            insertion = _Insertion(node, place, place, indent=indent, separator=separator)
            if indent is not None and not node.children:
                insertion.tail = self.tree.newline + (self.tree.line_indent(node) or "")
        self.insertions.append(insertion)
        return insertion

    def _fill(self, node: Node, indent: str | None, separator: str) -> _Insertion:
        """New content of an element that has none."""
        tail = "" if indent is None else self.tree.newline + (self.tree.line_indent(node) or "")
        if node.is_closed:
            start, end = self.tree.tag_end(node), node.end
            return _Insertion(
                node, start, end, head=">", tail=f"{tail}</{node.name}>", indent=indent, separator=separator
            )
        return _Insertion(node, node.open_end, node.close_start, tail=tail, indent=indent, separator=separator)

    def _behind(self, node: Node, anchor: Node, indent: str | None) -> int:
        """Behind `anchor` and the comments that stand behind it on its line."""
        place = anchor.end
        if indent is None:
            return place
        for child in node.children[node.children.index(anchor) + 1 :]:
            if child.name != COMMENT or "\n" in self.tree.text[place : child.start]:
                break
            place = child.end
        return place

    def _ahead(self, node: Node, following: Node | None, going: set[Node]) -> int:
        """Before `following` and the comments above it."""
        if following is None:
            return node.open_end
        index = node.children.index(following)
        while index > 0 and node.children[index - 1].name == COMMENT and node.children[index - 1] not in going:
            index -= 1
        while index > 0 and node.children[index - 1] in going:
            index -= 1
        return node.children[index - 1].end if index else node.open_end

    # Text

    def _text(self, node: Node, segments: list[Segment], old: str, new: str) -> None:
        """Change the text that `segments` hold together from `old` to `new`."""
        if old == new:
            return
        current = self.tree.value_of(segments)
        if current != old and current.strip() == old.strip() and old.strip():
            # The writer does not keep the blanks around the text, so they are not part of the edit.
            lead = current[: len(current) - len(current.lstrip())]
            new = lead + new.strip() + current[len(current.rstrip()) :]
        if current == new:
            return
        if not new and not node.children:
            self._make_empty(node)
        elif not segments:
            self._first_text(node, new)
        else:
            self._edit_segments(segments, current, new)

    def _first_text(self, node: Node, new: str) -> None:
        raw = escape_text(new, self.writing.habits)
        if node.is_closed:
            self._replace(self.tree.tag_end(node), node.end, f">{raw}</{node.name}>")
        else:
            self._replace(node.open_end, node.open_end, raw)

    def _edit_segments(self, segments: list[Segment], current: str, new: str) -> None:
        waiting = changes(current, new)
        begin = 0
        for index, segment in enumerate(segments):
            raw = self.tree.raw(segment)
            end = begin + len(raw.value)
            mine: list[Change] = []
            rest: list[Change] = []
            for change in waiting:
                if change.start > end or (change.start == end and change.end > end and index < len(segments) - 1):
                    rest.append(change)
                    continue
                mine.append(Change(change.start - begin, min(change.end, end) - begin, change.text))
                if change.end > end:
                    rest.append(Change(end, change.end, ""))
            waiting = rest
            if mine:
                self._edit_segment(segment, raw, mine)
            begin = end

    def _edit_segment(self, segment: Segment, raw: RawText, mine: list[Change]) -> None:
        value = _apply(raw.value, mine, 0, len(raw.value))
        newline = self.tree.newline
        if "\n" in raw.value:
            newline = "\r\n" if "\r\n" in raw.raw else "\n"
        habits = Habits("" if segment.cdata else raw.raw, newline=newline)
        if segment.cdata and ("]]>" in value or "\r" in value or not self._encodable(value)):
            self._replace(segment.outer_start, segment.outer_end, escape_text(value, habits))
        elif segment.cdata and not value:
            self._replace(segment.outer_start, segment.outer_end, "")
        elif not segment.cdata and "]]>" in value and not habits.greater:
            self._replace(segment.start, segment.end, escape_text(value, habits))
        else:
            for change in mine:
                text = change.text.replace("\n", newline) if segment.cdata else escape_text(change.text, habits)
                self._replace(
                    segment.start + raw.raw_position(change.start), segment.start + raw.raw_position(change.end), text
                )

    def _encodable(self, value: str) -> bool:
        try:
            value.encode(self.codec)
        except UnicodeEncodeError:
            return False
        return True

    # Text beside children

    def _mixed(
        self,
        node: Node,
        before: etree._Element,
        after: etree._Element,
        old: list[etree._Element],
        new: list[etree._Element],
    ) -> None:
        places, origins = self._match(node, old, new)
        if origins == list(range(len(old))) and None not in places and _rising(places):
            self._mixed_runs(node, before, after, places)
            for place, original, element in zip(places, old, new, strict=True):
                if place is not None:
                    self._element(place, original, element)
            return
        self._mixed_anew(node, after, old, new, places, origins)

    def _mixed_runs(self, node: Node, before: etree._Element, after: etree._Element, places: list[Node | None]) -> None:
        """The children are the same ones: change the text between them, piece by piece."""
        known = set(places)
        runs: list[list[Segment]] = [[]]
        position = node.open_end
        for child in node.children:
            runs[-1] += self.tree.segments(position, child.start)
            position = child.end
            if child in known:
                runs.append([])
        runs[-1] += self.tree.segments(position, node.close_start)
        ends = [node.open_end, *(place.end for place in places if place is not None)]
        for run, place, old, new in zip(runs, ends, _texts(before), _texts(after), strict=True):
            if run or old == new:
                self._text(node, run, old, new)
            else:
                self._replace(place, place, escape_text(new, self.writing.habits))

    def _mixed_anew(
        self,
        node: Node,
        after: etree._Element,
        old: list[etree._Element],
        new: list[etree._Element],
        places: list[Node | None],
        origins: list[int | None],
    ) -> None:
        """Write the content anew, out of the old pieces where they are still wanted."""
        known = {place for place in places if place is not None}
        used = {places[origin] for origin in origins if origin is not None}
        self.removed += [
            (place, original) for place, original in zip(places, old, strict=True) if place and place not in used
        ]
        scope = self.tree.scope(node)
        empty_end = self.writing.empty_end(node.start)
        habits = Habits("", newline=self.tree.newline)
        parts = self._unknown_behind(node, None, known)
        parts.append(escape_text(after.text or "", habits))
        for element, origin in zip(new, origins, strict=True):
            place = None if origin is None else places[origin]
            if place is not None and origin is not None:
                parts.append(self._slice(place, old[origin], element))
                parts += self._unknown_behind(node, place, known)
            else:
                parts.append(self.fragments.render(element, scope, None, "", empty_end))
            parts.append(escape_text(element.tail or "", habits))
        inner = "".join(parts)
        if node.is_closed:
            self._replace(self.tree.tag_end(node), node.end, f">{inner}</{node.name}>")
        else:
            self._replace(node.open_end, node.close_start, inner)

    def _unknown_behind(self, node: Node, place: Node | None, known: set[Node]) -> list[str]:
        """The source's own nodes directly behind `place`, which the trees do not have."""
        found: list[str] = []
        first = node.children.index(place) + 1 if place else 0
        for child in node.children[first:]:
            if child in known:
                break
            found.append(self.tree.text[child.start : child.end])
        return found

    # Writing

    def _replace(self, start: int, end: int, text: str) -> None:
        self.edits.append(Change(start, end, text))

    def _insert(self) -> None:
        """Turn the noted insertions into edits. Only now everything is known that goes and may come in elsewhere."""
        waiting, self.insertions = self.insertions, []
        for insertion in waiting:
            scope = self.tree.scope(insertion.parent)
            unit = self.writing.unit(insertion.parent)
            empty_end = self.writing.empty_end(insertion.start)
            parts = [insertion.head]
            for element in insertion.elements:
                parts.append(insertion.separator)
                parts.append(self.fragments.render(element, scope, insertion.indent, unit, empty_end))
            parts.append(insertion.tail)
            self._replace(insertion.start, insertion.end, "".join(parts))

    def _slice(self, node: Node, before: etree._Element, after: etree._Element) -> str:
        """The source text of `node` with the edits inside it."""
        outer = self.edits, self.insertions
        self.edits, self.insertions = [], []
        self._element(node, before, after)
        self._insert()
        edits = self.edits
        self.edits, self.insertions = outer
        return _apply(self.tree.text, edits, node.start, node.end)

    def _reuse(self, element: etree._Element, scope: Mapping[str, str], indent: str | None) -> str | None:
        origin = self.moved.pop(element, None)
        if origin is None:
            content = self._bytes(element)
            found = next((i for i, (_, old) in enumerate(self.removed) if self._bytes(old) == content), None)
            if found is None:
                return None
            origin = self.removed.pop(found)
        node, before = origin
        return self._slice(node, before, element)


def _rising(places: list[Node | None]) -> bool:
    starts = [place.start for place in places if place is not None]
    return starts == sorted(starts)


def _texts(element: etree._Element) -> list[str]:
    return [element.text or "", *(child.tail or "" for child in element)]


def _apply(text: str, edits: list[Change], start: int, end: int) -> str:
    """`text[start:end]` with all edits made."""
    parts: list[str] = []
    for edit in sorted(edits, key=lambda edit: (edit.start, edit.end)):
        if edit.start < start:
            raise PatchError("two edits meet in the same place of the source text")
        parts += (text[start : edit.start], edit.text)
        start = edit.end
    parts.append(text[start:end])
    return "".join(parts)


_FEATURE_LIMIT = 400


def tree_features(element: etree._Element) -> Counter[Hashable]:
    """What an element says, in small pieces, without its own keys."""
    found: Counter[Hashable] = Counter()
    for count, node in enumerate(element.iter()):
        if count > _FEATURE_LIMIT:
            break
        tag = kind_of(node)
        if node is not element:
            found[tag] += 1
        for name, value in node.attrib.items():
            found[tag, str(name), str(value)] += 1
        if text := (node.text or "").strip():
            found[tag, text] += 1
    return found


def source_features(tree: SourceTree, node: Node) -> Counter[Hashable]:
    """The same of an element in the source."""
    found: Counter[Hashable] = Counter()
    waiting = [node]
    count = 0
    while waiting and count <= _FEATURE_LIMIT:
        here = waiting.pop()
        count += 1
        tag = tree.tag(here)
        if here is not node:
            found[tag] += 1
        for name, attribute in tree.named_attributes(here).items():
            found[tag, name, tree.value(attribute)] += 1
        if here.is_element and (text := tree.value_of(tree.content(here)).strip()):
            found[tag, text] += 1
        waiting += reversed(here.children)
    return found
