"""Alignment of two lists of sibling elements: which child is which.

Two children are the same when an identifying attribute (`localId`, `name`, ...) agrees. Without one, order and content
decide: equal children are the same, and children left between two known neighbours are paired if they are alike enough.
Used twice: source against tree (which element of the file is this?) and tree before against after (what was renamed,
what removed, what is new?).
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from lxml import etree

from plcopen_sfc.formats.xml.source_style import kind_of

if TYPE_CHECKING:
    from plcopen_sfc.formats.xml.source_tree import SourceNode, SourceTree


Keys: TypeAlias = Sequence[tuple[str, str]]
"""Identifying attributes of an element (name, value), strongest first."""


_KEYS = (
    "localId", "guid", "Guid", "globalId", "UId", "Id", "ID", "Number", "name", "Name", "formalParameter",
    "refLocalId", "targetName",
)  # fmt: skip


def _keys_of(attributes: Mapping[str, str]) -> Keys:
    """Return the identifying attributes that PLC formats use."""
    return [(name, attributes[name]) for name in _KEYS if name in attributes]


class AlignedItem:
    """One child in an alignment: its tag, its identifying attributes, and its content on request."""

    __slots__ = ("_exact", "_features", "_make_exact", "_make_features", "keys", "tag")

    def __init__(
        self,
        tag: str,
        keys: Keys,
        exact: Callable[[], Hashable] | None,
        features: Callable[[], Counter[Hashable]],
    ) -> None:
        self.tag = tag
        self.keys = keys
        self._make_exact = exact
        self._make_features = features
        self._exact: Hashable = None
        self._features: Counter[Hashable] | None = None

    @property
    def exact(self) -> Hashable:
        """Equal for equal content; None where that cannot be told."""
        if self._exact is None and self._make_exact is not None:
            self._exact = self._make_exact()
        return self._exact

    @property
    def features(self) -> Counter[Hashable]:
        """Small facts about the content, to count how many two elements share."""
        if self._features is None:
            self._features = self._make_features()
        return self._features


def similarity(left: AlignedItem, right: AlignedItem) -> float:
    """Return how much of their content two items share, 0 to 1. Two items without any content are alike."""
    total = left.features.total() + right.features.total()
    return 2 * (left.features & right.features).total() / total if total else 1.0


_ALIKE = 0.5
_MAX_PAIRS = 40_000
_MAX_EXACT = 1_000_000
_MAX_CANDIDATES = 8


def align(left: Sequence[AlignedItem], right: Sequence[AlignedItem]) -> list[int | None]:
    """For every item of `right` the index of the item of `left` that it is the same as, or None."""
    signatures = [(item.tag, *item.keys) for item in left]
    if signatures == [(item.tag, *item.keys) for item in right] and len(set(signatures)) == len(signatures):
        return list(range(len(left)))  # most lists: no content is looked at
    matches: list[int | None] = [None] * len(right)
    free = [True] * len(left)

    def pair(i: int, j: int) -> None:
        matches[j] = i
        free[i] = False

    def group(signature: Callable[[AlignedItem], Hashable | None]) -> None:
        groups: defaultdict[Hashable, tuple[list[int], list[int]]] = defaultdict(lambda: ([], []))
        for i, item in enumerate(left):
            if free[i] and (sign := signature(item)) is not None:
                groups[sign][0].append(i)
        for j, item in enumerate(right):
            if matches[j] is None and (sign := signature(item)) is not None:
                groups[sign][1].append(j)
        for lefts, rights in groups.values():
            if lefts and rights:
                _pair_group(left, right, lefts, rights, pair)

    # Equal children first, so that an edit between identical neighbours does not shift them. Then all keys together,
    # then each key alone, strongest first: a renamed element keeps its localId, a renumbered one its name.
    if left and right and left[0].exact is not None and right[0].exact is not None:
        _pair_equal(left, right, list(range(len(left))), list(range(len(right))), pair)
    group(lambda item: (item.tag, tuple(item.keys)) if item.keys else None)
    for name in _key_names((*left, *right)):
        group(lambda item, name=name: _key(item, name))  # type: ignore[misc]  # mypy cannot infer a bound default
    group(lambda item: None if item.keys else item.tag)
    _between_neighbours(left, right, pair, matches, free)
    return matches


_Pair: TypeAlias = Callable[[int, int], None]


def _key_names(items: Sequence[AlignedItem]) -> list[str]:
    """Return names of all keys, strongest first."""
    rank: dict[str, int] = {}
    for item in items:
        for position, (name, _) in enumerate(item.keys):
            rank[name] = max(rank.get(name, 0), position)
    return sorted(rank, key=rank.__getitem__)


def _key(item: AlignedItem, name: str) -> Hashable | None:
    return next(((item.tag, value) for key, value in item.keys if key == name), None)


def _pair_group(
    left: Sequence[AlignedItem], right: Sequence[AlignedItem], lefts: list[int], rights: list[int], pair: _Pair
) -> None:
    """Pair items that differ in content only."""
    if len(lefts) == len(rights) == 1:
        pair(lefts[0], rights[0])
        return
    if left[lefts[0]].exact is None or right[rights[0]].exact is None:
        _pair_alike(left, right, lefts, rights, pair)
        return
    for some, others in _pair_equal(left, right, lefts, rights, pair):
        _pair_alike(left, right, some, others, pair)


def _pair_equal(
    left: Sequence[AlignedItem], right: Sequence[AlignedItem], lefts: list[int], rights: list[int], pair: _Pair
) -> list[tuple[list[int], list[int]]]:
    """Pair what is equal and in the same order; return what was replaced in between."""
    head = 0
    limit = min(len(lefts), len(rights))
    while head < limit and left[lefts[head]].exact == right[rights[head]].exact:
        pair(lefts[head], rights[head])
        head += 1
    tail = 0
    while tail < limit - head and left[lefts[-1 - tail]].exact == right[rights[-1 - tail]].exact:
        pair(lefts[-1 - tail], rights[-1 - tail])
        tail += 1
    lefts, rights = lefts[head : len(lefts) - tail], rights[head : len(rights) - tail]
    if not lefts or not rights:
        return []
    left_values, right_values = [left[i].exact for i in lefts], [right[j].exact for j in rights]
    # Many equal items among many would take quadratic time; pairing what is alike still gives a right result.
    if len(lefts) * len(rights) > _MAX_EXACT and len(set(right_values)) < len(right_values) // 2:
        return [(lefts, rights)]
    replaced: list[tuple[list[int], list[int]]] = []
    for operation, i1, i2, j1, j2 in SequenceMatcher(None, left_values, right_values, autojunk=False).get_opcodes():
        if operation == "equal":
            for i, j in zip(lefts[i1:i2], rights[j1:j2], strict=True):
                pair(i, j)
        elif operation == "replace":
            replaced.append((lefts[i1:i2], rights[j1:j2]))
    return replaced


def _pair_alike(
    left: Sequence[AlignedItem], right: Sequence[AlignedItem], lefts: list[int], rights: list[int], pair: _Pair
) -> None:
    """Pair in order: all if their number is the same, else so that the pairs are as alike as can be."""
    if len(lefts) == len(rights) or len(lefts) * len(rights) > _MAX_PAIRS:
        for i, j in zip(lefts, rights, strict=False):
            pair(i, j)
        return
    rows, columns = len(lefts), len(rights)
    # A pair is worth a little even if nothing is alike: the shorter side is matched completely.
    worth = [[0.01 + similarity(left[i], right[j]) for j in rights] for i in lefts]
    best = [[0.0] * (columns + 1) for _ in range(rows + 1)]
    for r in range(rows - 1, -1, -1):
        for c in range(columns - 1, -1, -1):
            best[r][c] = max(best[r + 1][c], best[r][c + 1], best[r + 1][c + 1] + worth[r][c])
    r = c = 0
    while r < rows and c < columns:
        if best[r][c] == best[r + 1][c + 1] + worth[r][c]:
            pair(lefts[r], rights[c])
            r, c = r + 1, c + 1
        elif best[r][c] == best[r + 1][c]:
            r += 1
        else:
            c += 1


def _between_neighbours(
    left: Sequence[AlignedItem],
    right: Sequence[AlignedItem],
    pair: _Pair,
    matches: Sequence[int | None],
    free: Sequence[bool],
) -> None:
    """Pair what has other keys now (renamed, renumbered) but is between the same neighbours and is alike."""
    waiting: defaultdict[str, list[int]] = defaultdict(list)
    for i, item in enumerate(left):
        if free[i]:
            waiting[item.tag].append(i)
    if not waiting:
        return
    above: list[int] = [len(left)] * (len(right) + 1)
    for j in range(len(right) - 1, -1, -1):
        known = matches[j]
        above[j] = above[j + 1] if known is None else known
    low = -1
    for j, item in enumerate(right):
        known = matches[j]
        if known is not None:
            low = known
            continue
        high = above[j + 1]
        candidates = islice((i for i in waiting[item.tag] if low < i < high or high <= low), _MAX_CANDIDATES)
        found = next((i for i in candidates if _renamed(left[i], item)), None)
        if found is not None:
            pair(found, j)
            low = found
            waiting[item.tag].remove(found)


def _renamed(left: AlignedItem, right: AlignedItem) -> bool:
    """True if two items with different strongest keys can be the same thing."""
    left_values, right_values = dict(left.keys), dict(right.keys)
    both = left_values.keys() & right_values.keys()
    if any(left_values[name] == right_values[name] for name in both):
        return True
    # Two different keys are another element, however alike its content.
    if len(both) > 1:
        return False
    return similarity(left, right) >= _ALIKE


def longest_rising(numbers: Sequence[int]) -> set[int]:
    """Return indices of a longest rising subsequence: what stays in place when a list was reordered."""
    tails: list[int] = []
    ends: list[int] = []
    previous: list[int] = []
    for index, number in enumerate(numbers):
        place = bisect_left(tails, number)
        previous.append(ends[place - 1] if place else -1)
        tails[place : place + 1] = [number]
        ends[place : place + 1] = [index]
    chosen: set[int] = set()
    index = ends[-1] if ends else -1
    while index >= 0:
        chosen.add(index)
        index = previous[index]
    return chosen


_FEATURE_LIMIT = 401


class ElementComparison:
    """Elements made comparable for the alignment, for one source and a pair of trees."""

    def __init__(self, tree: SourceTree, before: etree._Element, after: etree._Element) -> None:
        self._tree = tree
        # Plain serialisation is twice as fast but names every namespace in scope: it only compares trees that declare
        # the same ones.
        self._plain = before.nsmap == after.nsmap

    def bytes_of(self, element: etree._Element) -> bytes:
        """Return bytes that are equal for elements of the same content."""
        if not self._plain and isinstance(cast("object", element.tag), str):
            try:
                return etree.tostring(element, method="c14n", exclusive=True, with_tail=False)
            except etree.C14NError:  # for namespaces that are no absolute URIs
                self._plain = True
        return etree.tostring(element, with_tail=False)

    def same(self, before: etree._Element, after: etree._Element) -> bool:
        """True if two elements are equal, down to the last descendant."""
        return before is after or self.bytes_of(before) == self.bytes_of(after)

    def tree_item(self, element: etree._Element) -> AlignedItem:
        """Return an element of `before` or `after`."""
        tag = kind_of(element)
        keys: Keys = () if tag.startswith("#") else _keys_of(dict(cast("Any", element.attrib)))
        return AlignedItem(tag, keys, partial(self.bytes_of, element), lambda: _features(_of_tree(element), keys))

    def source_item(self, node: SourceNode) -> AlignedItem:
        """Return a node of the source."""
        tree = self._tree
        tag = tree.tag(node)
        keys: Keys = _keys_of(tree.values(node)) if node.is_element else ()
        return AlignedItem(tag, keys, None, lambda: _features(_of_source(tree, node), keys))


_Facts: TypeAlias = tuple[str, Mapping[str, str], str]
"""Of one node: its tag, its attributes, and its own text."""


def _features(nodes: Iterable[_Facts], keys: Keys) -> Counter[Hashable]:
    """Return small facts of the nodes of an element, without its keys, which are compared by themselves."""
    own = {name for name, _ in keys}
    found: Counter[Hashable] = Counter()
    for place, (tag, attributes, text) in enumerate(islice(nodes, _FEATURE_LIMIT)):
        if place:
            found[tag] += 1
        for name, value in attributes.items():
            if place or name not in own:
                found[tag, str(name), str(value)] += 1
        if text.strip():
            found[tag, text.strip()] += 1
    return found


def _of_tree(element: etree._Element) -> Iterator[_Facts]:
    return ((kind_of(node), cast("Any", node.attrib), node.text or "") for node in element.iter())


def _of_source(tree: SourceTree, node: SourceNode) -> Iterator[_Facts]:
    waiting = [node]
    while waiting:
        here = waiting.pop()
        yield (
            tree.tag(here),
            tree.values(here),
            tree.value_of(tree.content(here)) if here.is_element else tree.inner(here),
        )
        waiting += reversed(here.children)
