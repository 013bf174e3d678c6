"""Text formats: an edited project as a patch of the text that was read.

A writer makes *blocks*: the text of an object, or of its parts. A reader of the same format makes *spans*: the places
of those objects in the file. To save an edit, the model is written as it was read and as it is now; only the blocks
that differ go into the text, in its own layout as far as possible. `declaration_blocks` has those of declarations.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import SequenceMatcher
from typing import TypeAlias

from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.formats.text_encoding import SourceText
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.model.project import Project


def block_span(key: Key, span: tuple[int, int], places: Iterable[Place]) -> BlockSpan:
    """Return the span of an object with `places` in it, their keys numbered where several are the same."""
    found = list(places)
    keys = numbered([each for each, _, _ in found])
    inner = [BlockSpan((own,), place, spans) for own, (_, place, spans) in zip(keys, found, strict=True)]
    return BlockSpan((key,), span, tuple(sorted(inner, key=lambda each: each.span)))


def plain_lines(text: str) -> str:
    """Return `text` with LF as its line end."""
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


# -- blocks and spans

Key: TypeAlias = tuple[str, str]
"""The kind of an object and its name; among its neighbours it is the only one with both."""


@dataclass(frozen=True)
class WrittenBlock:
    """An object as a writer writes it: `text` in whole lines, or `blocks` on lines below each other.

    `apart`: an empty line comes before it. `verbatim`: the text is that of the model, with its layout.
    `block`: it is put into the text as whole lines, indented as its first line is there, never word by word.
    """

    key: Key
    text: str = ""
    blocks: tuple[WrittenBlock, ...] = ()
    apart: bool = False
    verbatim: bool = False
    block: bool = False

    def lines(self) -> Iterator[str]:
        """Yield the text, its blocks joined."""
        if not self.blocks:
            yield self.text
        for number, block in enumerate(self.blocks):
            if block.apart and number:
                yield ""
            yield from block.lines()

    def whole(self) -> str:
        """Return the text as one string."""
        return "\n".join(self.lines())


@dataclass(frozen=True)
class BlockSpan:
    """Places of objects in a text: usually one, several where they are declared together (``a, b : INT``)."""

    keys: tuple[Key, ...]
    span: tuple[int, int]
    spans: tuple[BlockSpan, ...] = field(default=())


Place: TypeAlias = tuple[Key, tuple[int, int], tuple[BlockSpan, ...]]
"""Place of an object in a text, and those of what is in it."""


@dataclass
class ReadText:
    """A text that was read: the project, the places of its objects, and the findings."""

    project: Project
    spans: BlockSpan
    diagnostics: list[Diagnostic] = field(default_factory=list)


def numbered(keys: Sequence[Key]) -> list[Key]:
    """Return `keys` with a number behind the names of those that occur more than once."""
    seen: dict[Key, int] = {}
    unique: list[Key] = []
    for kind, name in keys:
        count = seen[kind, name] = seen.get((kind, name), 0) + 1
        unique.append((kind, f"{name}#{count}" if count > 1 else name))
    return unique


def numbered_blocks(blocks: Iterable[WrittenBlock]) -> tuple[WrittenBlock, ...]:
    """Return `blocks` with keys that are unique among them."""
    made = list(blocks)
    keys = numbered([block.key for block in made])
    return tuple(replace(block, key=key) for block, key in zip(made, keys, strict=True))


# -- patching


def patch_text(
    source: SourceText, spans: BlockSpan, before: WrittenBlock, after: WrittenBlock, *, by_words: bool = True
) -> str:
    """Return the text of `source` with what differs between the blocks `before` and `after` put into it.

    `by_words`: an edited block keeps its layout, and only words in it change; else it is written as a whole.
    """
    if source.text == _file(before, source.newline):  # the text is as the writer writes it, and stays so
        return _file(after, source.newline)
    patch = _Patch(source.text, source.newline, by_words=by_words)
    return apply_edits(source.text, patch.edits(spans, before, after))


def _file(block: WrittenBlock, newline: str) -> str:
    return block.whole().replace("\n", newline) + newline


class _Patch:
    def __init__(self, text: str, newline: str, *, by_words: bool) -> None:
        self._text = text
        self._newline = newline
        self._by_words = by_words

    def edits(self, around: BlockSpan, before: WrittenBlock, after: WrittenBlock) -> list[Edit]:
        if before == after:
            return []
        known = [key for inner in around.spans for key in inner.keys]
        # what the text does without before the edit, it does without behind it
        idle = {block for block in before.blocks if block.key not in known}.intersection(after.blocks)
        if known and idle:
            before, after = (
                replace(each, blocks=tuple(block for block in each.blocks if block not in idle))
                for each in (before, after)
            )
        if not (before.blocks and after.blocks and sorted(known) == sorted(block.key for block in before.blocks)):
            return [self._replaced(around, before, after)]
        return self._children(around, before, after)

    def _children(self, around: BlockSpan, before: WrittenBlock, after: WrittenBlock) -> list[Edit]:
        number_of = {key: number for number, inner in enumerate(around.spans) for key in inner.keys}
        in_text: Sequence[WrittenBlock] = sorted(before.blocks, key=lambda block: number_of[block.key])
        if _by_kind(in_text) != _by_kind(
            before.blocks
        ):  # the writer has another order, such as types before their uses
            in_text = before.blocks
        pairs = _pairs(in_text, _in_order_of(in_text, after.blocks))
        old_blocks = {block.key: block for block in before.blocks}
        edits: list[Edit] = []
        following: dict[int, list[WrittenBlock]] = {}  # new blocks by the number of the span that they follow
        new_of: dict[int, list[WrittenBlock]] = {}  # what is in the place of a span, by its number
        last = -1
        for old, new in pairs:
            if old is not None and new is not None:
                number = number_of[old.key]
                between = following.pop(last, []) if number == last else []  # in a list of variables
                new_of.setdefault(number, []).extend([*between, new])
                last = number
            elif new is not None:
                following.setdefault(last, []).append(new)
        final = following.get(last, [])
        if around.spans and final and final[-1] is after.blocks[-1]:
            # what ends the new text goes behind all that is there, in whatever order that is
            following.pop(last)
            following.setdefault(len(around.spans) - 1, []).extend(final)
        for number, inner in enumerate(around.spans):
            olds = [old_blocks[key] for key in inner.keys]
            news = new_of.get(number, [])
            if not news:
                edits.append(self._removed(inner, apart=olds[0].apart))
            elif len(olds) == 1:
                edits += self.edits(inner, olds[0], news[0])
            elif olds != news:
                edits += self._renamed_in_list(inner, olds, news) or [self._listed(inner, news)]
            if number in following:
                edits.append(self._inserted(around.spans, number, following[number]))
        if -1 in following:
            edits.append(self._put_first(around, following[-1]))
        return _joined(edits)

    # -- lists of variables

    def _listed(self, around: BlockSpan, news: Sequence[WrittenBlock]) -> Edit:
        """Return the edit of a list of variables into a declaration for each."""
        together = "\n".join(new.whole() for new in news)
        return Edit(*around.span, self._laid_out(together, around.span[0]))

    def _renamed_in_list(
        self, around: BlockSpan, olds: Sequence[WrittenBlock], news: Sequence[WrittenBlock]
    ) -> list[Edit]:
        """Return the edits of names in a list of variables; nothing where more than names differ."""
        start, end = around.span
        words = [*_WORDS.finditer(self._text, start, end)]
        names = words[: next((i for i, word in enumerate(words) if word.group() == ":"), 0)]
        edits: list[Edit] = []
        for old, new in zip(olds, news, strict=False) if len(olds) == len(news) else ():
            before, after = (_WORDS.findall(block.whole()) for block in (old, new))
            other = [pair for pair in zip(before, after, strict=False) if pair[0] != pair[1]]
            places = [word for word in names if other and word.group().casefold() == other[0][0].casefold()]
            if other and (len(before) != len(after) or len(other) > 1 or len(places) != 1):
                return []
            edits += [Edit(*word.span(), other[0][1]) for word in places]
        return edits

    # -- single edits

    def _replaced(self, around: BlockSpan, before: WrittenBlock, after: WrittenBlock) -> Edit:
        start, end = around.span
        source = self._text[start:end]
        old, new = before.whole(), after.whole()
        if after.verbatim:
            return Edit(start, end, self._with_newlines(new))
        if not self._by_words:
            new = self._in_unit_of(around, new)
        laid_out = self._laid_out(new, start)
        is_one_text = self._by_words and not (before.blocks or after.blocks or after.block)
        if not is_one_text or source.count("\n") >= _LONG or source == self._laid_out(old, start):
            return Edit(start, end, laid_out)
        merged = _merged(source, old.strip(), new.strip())
        return Edit(start, end, laid_out if merged is None else self._with_newlines(merged))

    def _removed(self, around: BlockSpan, *, apart: bool) -> Edit:
        start, end = around.span
        line = self._line_start(start)
        rest = re.compile(rf"{_REST_OF_LINE}(?:{_REST_OF_LINE})?" if apart else _REST_OF_LINE).match(self._text, end)
        return Edit(start, end, "") if line is None or rest is None else Edit(line, rest.end(), "")

    def _inserted(self, spans: Sequence[BlockSpan], number: int, blocks: list[WrittenBlock]) -> Edit:
        at = spans[number].span[1]
        line_end = _LINE_END.search(self._text, at)
        stop = line_end.start() if line_end is not None else len(self._text)
        if not any(at <= other.span[0] < stop for other in spans[number + 1 :]):
            at = stop  # behind a comment that belongs to nothing
        text = ""
        for block in blocks:
            kinds = {block.key[0]}
            neighbours = [*spans[number::-1], *spans[number + 1 :]]
            like = next((s for s in neighbours if kinds & {kind for kind, _ in s.keys}), None)
            lines = self._reindented(block.whole(), self._indent(like.span[0])) if like is not None else block.whole()
            text += ("\n\n" if block.apart else "\n") + lines
        return Edit(at, at, self._with_newlines(text))

    def _put_first(self, around: BlockSpan, blocks: list[WrittenBlock]) -> Edit:
        at = around.spans[0].span[0] if around.spans else around.span[1]
        line = self._line_start(at)
        at = line if line is not None else at
        text = "".join(block.whole() + ("\n\n" if block.apart else "\n") for block in blocks)
        return Edit(at, at, self._with_newlines(text))

    # -- layout

    def _laid_out(self, text: str, start: int) -> str:
        """`text` for a place in the middle of a line: without the indent of its first line."""
        return self._with_newlines(self._reindented(text, self._indent(start)).lstrip(" \t"))

    def _in_unit_of(self, around: BlockSpan, text: str) -> str:
        """Return `text`, whose levels are indented by four blanks, with the indentation that the file has there."""
        start, end = around.span
        own = self._indent(start)
        inner = (line[: len(line) - len(line.lstrip())] for line in self._text[start:end].splitlines()[1:])
        unit = next((each.removeprefix(own) for each in inner if each.startswith(own) and each != own), None)
        margin = re.match(r" *", text)
        base = len(margin.group()) if margin is not None else 0
        if unit is None:
            return text

        def level(found: re.Match[str]) -> str:
            depth, rest = divmod(len(found.group()) - base, 4)
            return " " * base + unit * depth + " " * rest if depth > 0 else found.group()

        return re.sub(r"^ +", level, text, flags=re.MULTILINE)

    def _reindented(self, text: str, indent: str) -> str:
        own = re.match(r"[ \t]*", text)
        old = own.group() if own is not None else ""
        lines = text.split("\n")
        return "\n".join(indent + line[len(old) :] if line.startswith(old) and line else line for line in lines)

    def _indent(self, offset: int) -> str:
        start = max(self._text.rfind("\n", 0, offset), self._text.rfind("\r", 0, offset)) + 1
        found = re.compile(r"[ \t]*").match(self._text, start)
        return found.group() if found is not None else ""

    def _line_start(self, offset: int) -> int | None:
        """Return the start of the line of `offset`, if there are only spaces before it."""
        start = max(self._text.rfind("\n", 0, offset), self._text.rfind("\r", 0, offset)) + 1
        return start if not self._text[start:offset].strip() else None

    def _with_newlines(self, text: str) -> str:
        return re.sub(r"\r\n|\r|\n", self._newline, text)


_LINE_END = re.compile(r"[\r\n]")
_REST_OF_LINE = r"[ \t]*(?:\r\n|\r|\n|\Z)"
_LONG = 200
"""Texts of more lines are not merged word by word, which takes the square of their length."""


def _in_order_of(before: Sequence[WrittenBlock], after: Sequence[WrittenBlock]) -> Sequence[WrittenBlock]:
    """Return the blocks `after` in the places that the blocks `before` have, each kind in its order.

    A writer puts the transitions of a chart between its steps as it flows, which one new step or one other target can
    change all along. Blocks without a place follow the one before them in `after`, as the order of their kind allows.
    """
    place = _places_by_kind(before, after)
    bounds: dict[str, int] = {}  # by kind, the place of the next block that has one
    limits: list[int] = []
    for block in reversed(after):
        limits.append(bounds.get(block.key[0], len(before)))
        bounds[block.key[0]] = place.get(block.key, limits[-1])
    latest: dict[str, int] = {}
    last = -1
    for block, limit in zip(after, reversed(limits), strict=True):
        if block.key not in place:
            place[block.key] = max(latest.get(block.key[0], -1), min(last, limit - 1))
        last = latest[block.key[0]] = place[block.key]
    return sorted(after, key=lambda block: place[block.key])


def _places_by_kind(before: Sequence[WrittenBlock], after: Sequence[WrittenBlock]) -> dict[Key, int]:
    """Return the numbers in `before` of the blocks `after` that stay or replace one, by their keys."""
    old = grouped((block.key[0], (number, block.key)) for number, block in enumerate(before))
    new = grouped((block.key[0], block.key) for block in after)
    found: dict[Key, int] = {}
    for kind in old.keys() & new.keys():
        numbers, keys = zip(*old[kind], strict=True)
        matcher = SequenceMatcher(a=keys, b=new[kind], autojunk=False)
        for _, low, high, new_low, new_high in matcher.get_opcodes():
            found |= zip(new[kind][new_low:new_high], numbers[low:high], strict=False)
    return found


def _by_kind(blocks: Iterable[WrittenBlock]) -> list[Key]:
    return sorted((block.key for block in blocks), key=lambda key: key[0])


def _pairs(
    before: Sequence[WrittenBlock], after: Sequence[WrittenBlock]
) -> Iterator[tuple[WrittenBlock | None, WrittenBlock | None]]:
    """Return which old block became which new one; None where it is removed or added.

    First those of the same text, then those of the same key, then those of the same kind at the same place: renamed.
    """
    for old, new in _runs(before, after, [p.whole() for p in before], [p.whole() for p in after]):
        for olds, news in _runs(old, new, [p.key for p in old], [p.key for p in new]):
            left, right = list(olds), list(news)
            while left and right and left[0].key[0] == right[0].key[0]:
                yield left.pop(0), right.pop(0)
            yield from ((block, None) for block in left)
            yield from ((None, block) for block in right)


def _runs(
    before: Sequence[WrittenBlock],
    after: Sequence[WrittenBlock],
    old_marks: Sequence[Hashable],
    new_marks: Sequence[Hashable],
) -> Iterator[tuple[Sequence[WrittenBlock], Sequence[WrittenBlock]]]:
    """Pieces that belong to each other: one by one where their marks are equal, else in runs."""
    matcher = SequenceMatcher(a=old_marks, b=new_marks, autojunk=False)
    for operation, low, high, new_low, new_high in matcher.get_opcodes():
        if operation == "equal":
            for offset in range(high - low):
                yield before[low + offset : low + offset + 1], after[new_low + offset : new_low + offset + 1]
        else:
            yield before[low:high], after[new_low:new_high]


def _joined(edits: list[Edit]) -> list[Edit]:
    """Insertions at the place where something is removed, in one edit with it."""
    joined: list[Edit] = []
    for edit in sorted(edits):
        if joined and edit.start < joined[-1].end:
            last = joined.pop()
            joined.append(Edit(last.start, max(last.end, edit.end), last.text + edit.text))
        else:
            joined.append(edit)
    return joined


_Word: TypeAlias = re.Match[str]
_WORDS = re.compile(
    r"TITLE\s*=[^\r\n]*|//[^\r\n]*|\(\*(?:(?!\*\))[\s\S])*\*\)|'[^'\r\n]*'|\"[^\"\r\n]*\"|%[\w.*]+|\w+#[\w.+-]+|\w+|:=|=>|\.\.|[^\w\s]"
)


def _merged(source: str, old: str, new: str) -> str | None:
    """Return `source`, which is `old` in its own layout, changed to `new`; None where they differ too much."""
    words, old_words, new_words = (list(_WORDS.finditer(text)) for text in (source, old, new))
    marks, old_marks, new_marks = ([_mark(word.group()) for word in found] for found in (words, old_words, new_words))
    place = _places(old_marks, marks)
    exact = [
        [word.group() for word in found] for found in (old_words, new_words)
    ]  # a new name may be the old in capitals
    indents = _indents(source, old, [(words[there], old_words[here]) for here, there in place.items()])
    edits: list[Edit] = []
    words_after, position = [], 0  # the words of the source after the edits
    for operation, low, high, new_low, new_high in SequenceMatcher(
        a=exact[0], b=exact[1], autojunk=False
    ).get_opcodes():
        if operation == "equal":
            continue
        at = [place.get(index, -1) for index in range(low, high)]
        first = min(at) if at else _behind(old_marks, place, low)
        if new_low == new_high:
            at.sort()  # what is removed may have its comment above it
        if first < position or at != list(range(first, first + high - low)):
            return None
        words_after += marks[position:first] + new_marks[new_low:new_high]
        position = first + high - low
        edit = _word_edit(words[first:position], words[:first], new, new_words, slice(new_low, new_high))
        edits.append(edit._replace(text=_LINE_START.sub(lambda at: indents.get(at.group(), at.group()), edit.text)))
    text = apply_edits(source, edits)
    words_after += marks[position:]
    # An edit beside a comment or a string may join or swallow words: then the block is laid out as a whole.
    return text if [_mark(word) for word in _WORDS.findall(text)] == words_after else None


def _behind(old: Sequence[str], place: Mapping[int, int], index: int) -> int:
    """Return the place in the source behind the word before `index`, and behind what its comments belong to.

    A writer puts a comment behind a declaration, and the source may have it above. -1 where the word is not found.
    """
    last = next((i for i in range(index - 1, -1, -1) if not old[i].startswith("//")), -1)
    if last >= 0 and last not in place:
        return -1
    return 1 + max((place[i] for i in range(max(last, 0), index) if i in place), default=-1)


_LINE_START = re.compile(r"(?<=\n)[ \t]*")


def _indents(source: str, old: str, pairs: Iterable[tuple[_Word, _Word]]) -> dict[str, str]:
    """Return the indentation in the source of lines by that which a writer gives them."""
    found: dict[str, str] = {}
    for mine, written in pairs:
        indent, own = (text[: word.start()].rpartition("\n") for text, word in ((old, written), (source, mine)))
        if indent[1] and own[1] and not indent[2].strip() and not own[2].strip():
            found.setdefault(indent[2], own[2])
    return found


def _word_edit(gone: list[_Word], before: list[_Word], new: str, new_words: list[_Word], at: slice) -> Edit:
    """Return the edit of the words `gone`, which follow those `before`, into the words of `new` at `at`."""
    end_before = before[-1].end() if before else 0
    put = new_words[at]
    if not gone:  # with the spaces before it in the new text
        gap = new_words[at.start - 1].end() if at.start else 0
        return Edit(end_before, end_before, new[gap : put[-1].end()])
    if not put:  # with the spaces before it
        return Edit(end_before, gone[-1].end(), "")
    return Edit(gone[0].start(), gone[-1].end(), new[put[0].start() : put[-1].end()])


def _mark(word: str) -> str:
    """Return the meaning of a word: case does not matter, nor the kind of comment."""
    if word.startswith("//"):
        return f"// {word[2:].strip()}"
    if word.startswith("(*"):
        return f"// {word[2:-2].strip()}"
    return word.casefold()


def _places(old: Sequence[str], words: Sequence[str]) -> dict[int, int]:
    """Return the word of the source for each old word. Comments may be elsewhere: above what they are about."""
    matcher = SequenceMatcher(a=old, b=words, autojunk=False)
    places = {block.a + i: block.b + i for block in matcher.get_matching_blocks() for i in range(block.size)}
    found = {*places.values()}
    mine = grouped((mark, i) for i, mark in enumerate(words) if i not in found and mark.startswith("//"))
    written = grouped((mark, i) for i, mark in enumerate(old) if i not in places and mark.startswith("//"))
    for mark, numbers in written.items():
        if len(numbers) == len(mine.get(mark, ())):
            places |= zip(numbers, mine[mark], strict=True)
    return places
