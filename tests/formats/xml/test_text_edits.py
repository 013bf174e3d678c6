"""Small replacements, raw text and alignment: the parts under the patch."""

from __future__ import annotations

from collections import Counter
from functools import partial
from itertools import combinations, pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcopen_sfc.formats.xml.element_alignment import AlignedItem, align, longest_rising
from plcopen_sfc.formats.xml.escaping import RawText
from plcopen_sfc.formats.xml.source_tree import text_edits
from plcopen_sfc.languages.text_edits import Edit, apply_edits

LINES = st.lists(st.sampled_from(["a", "b", "", "long line", "x := 1;"]), max_size=8).map("\n".join)


@given(LINES, LINES)
def test_changes_turn_one_text_into_the_other(old: str, new: str) -> None:
    found = text_edits(old, new)
    assert apply_edits(old, found) == new
    assert all(left.end <= right.start for left, right in pairwise(found))


def test_changes_leave_equal_lines_alone() -> None:
    old, new = "one\ntwo\nthree\nfour\nfive", "oNe\ntwo\nthree\nfour\nfi\nve"
    assert text_edits(old, new) == [Edit(1, 2, "N"), Edit(21, 21, "\n")]
    assert text_edits("a", "a") == []
    assert text_edits("", "a") == [Edit(0, 0, "a")]


def test_long_texts_of_equal_lines() -> None:
    old = "x\n" * 5000
    assert apply_edits("y\n" + old + "z", text_edits("y\n" + old + "z", "u\n" + old + "v")) == "u\n" + old + "v"


def test_edits_that_overlap_are_refused() -> None:
    with pytest.raises(ValueError, match="overlap"):
        apply_edits("abc", [Edit(0, 2, ""), Edit(1, 3, "")])
    assert apply_edits("abc", [Edit(1, 2, "x"), Edit(1, 1, "1"), Edit(1, 1, "2")]) == "a12xc"


@given(st.lists(st.sampled_from(["a", "\n", "\r\n", "&lt;", "&#65;", "&#x1F600;", " ", "\t"]), max_size=10))
def test_raw_positions(pieces: list[str]) -> None:
    raw = RawText("".join(pieces))
    starts = [sum(map(len, pieces[:n])) for n in range(len(pieces) + 1)]
    assert len(raw.value) == len(pieces)
    assert [raw.raw_position(n) for n in range(len(pieces) + 1)] == starts


def test_raw_meanings() -> None:
    assert RawText("&amp;lt;\r\n\r&apos;&quot;&gt;&#10;&unknown;").value == "&lt;\n\n'\">\n&unknown;"
    assert RawText("a\r\nb\tc\n&#10;", attribute=True).value == "a b c \n"
    assert RawText("&amp;\r\n", cdata=True).value == "&amp;\n"


def items(*texts: str) -> list[AlignedItem]:
    """`tag:key=value,key=value/content`."""
    found: list[AlignedItem] = []
    for text in texts:
        head, _, content = text.partition("/")
        tag, _, keys = head.partition(":")
        pairs = [(pair.split("=")[0], pair.split("=")[1]) for pair in keys.split(",") if pair]
        found.append(AlignedItem(tag, pairs, partial(str, text), partial(Counter, content)))
    return found


@pytest.mark.parametrize(
    ("left", "right", "expected"),
    [
        (["s:id=1", "s:id=2"], ["s:id=2", "s:id=1"], [1, 0]),
        (["s:id=1,name=A", "s:id=2,name=B"], ["s:id=1,name=B", "s:id=2,name=A"], [0, 1]),
        (["s:id=1,name=A", "s:id=2,name=B"], ["s:id=5,name=B", "s:id=6,name=A"], [1, 0]),
        (["s:name=A"], ["s:name=B"], [0]),
        (["s:name=A/xyz"], ["s:name=B/uvw"], [None]),
        (["s:name=A/xyz", "t"], ["t", "s:name=B/xyz"], [1, None]),
        (["s:id=1,name=A"], ["s:id=2,name=B"], [None]),
        (["p/abc", "p/def", "p/ghi"], ["p/abc", "p/ghi"], [0, 2]),
        (["p/abc", "p/def", "p/ghi"], ["p/deg"], [1]),
        (["p/a"], ["q/a"], [None]),
        (["s:v=1,name=A"], ["s:name=A"], [0]),
        ([], ["p"], [None]),
    ],
)
def test_alignment(left: list[str], right: list[str], expected: list[int | None]) -> None:
    assert align(items(*left), items(*right)) == expected


@given(st.permutations(range(7)))
def test_longest_rising(numbers: list[int]) -> None:
    chosen = [numbers[index] for index in sorted(longest_rising(numbers))]
    longest = max(size for size in range(1, 8) if any(list(c) == sorted(c) for c in combinations(numbers, size)))
    assert chosen == sorted(chosen)
    assert len(chosen) == longest
