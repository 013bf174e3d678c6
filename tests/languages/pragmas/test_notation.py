"""Values and changes in pragmas: what is written is read back, and no brace or comment mark stands in it."""

from __future__ import annotations

import copy
import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.languages.pragmas import (
    DEFAULT,
    NotationError,
    PathError,
    Scanner,
    StaleError,
    apply,
    changes,
    format_value,
    parse_change,
)
from tests.sweeps import examples

keys = st.text(max_size=4)
values: st.SearchStrategy[Any] = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=8) | st.floats(allow_nan=False),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=3),
    max_leaves=8,
)
fields = st.dictionaries(keys, values, max_size=4)
many = settings(max_examples=examples(500), deadline=None)


def read(text: str) -> Any:
    scanner = Scanner(text)
    value = scanner.value()
    assert scanner.at_end()
    return value


@pytest.mark.slow
@many
@given(values)
def test_values_come_back(value: Any) -> None:
    text = format_value(value)
    assert read(text) == value
    assert not any(mark in text for mark in ("{", "}", "(*", "*)", "\n", "\r"))


@pytest.mark.slow
@many
@given(fields, fields)
def test_changes_lead_from_what_is_said_to_what_is_meant(written: dict[str, Any], meant: dict[str, Any]) -> None:
    result = copy.deepcopy(written)
    for change in changes(written, meant):
        again = parse_change(str(change))
        assert again == change
        apply(result, again)
    assert result == meant


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (True, "TRUE"),
        (None, "NULL"),
        (DEFAULT, "DEFAULT"),
        (12, "12"),
        (1.5, "1.5"),
        (2.0, "2"),
        ("it's 5 $", "'it$'s 5 $$'"),
        ("a\nb\tc", "'a$Nb$Tc'"),
        ("{x} (* y *)", "'$7Bx$7D ($2A y $2A)'"),
        ("Füllen €", "'Füllen €'"),
        ([1, "a"], "[1, 'a']"),
        ({"b": 1, "a": {"de-DE": "x"}}, "(b := 1, a := ('de-DE' := 'x'))"),
        (math.inf, "inf"),
        ({"inf": 1, "nan": 2, "-inf": 3}, "('inf' := 1, 'nan' := 2, '-inf' := 3)"),
    ],
)
def test_values_look_like_literals_of_the_standard(value: Any, text: str) -> None:
    assert format_value(value) == text
    assert read(text) == value or value is DEFAULT


@pytest.mark.parametrize("text", ["", "'open", "(a 1)", "[1", "(a := )", "Motor", "#", "1.2.3", "(" * 500])
def test_what_is_no_value_is_an_error_with_its_place(text: str) -> None:
    with pytest.raises(NotationError) as caught:
        read(text)
    assert 0 <= caught.value.position <= len(text)


@pytest.mark.parametrize(
    ("written", "meant", "lines"),
    [
        ({}, {"max_time": "T#5s"}, ["max_time := 'T#5s'"]),
        ({"negated": False}, {"negated": True}, ["negated := TRUE FOR FALSE"]),
        ({}, {"exclude": True}, ["exclude"]),
        ({"a": "x"}, {}, ["a := DEFAULT FOR 'x'"]),
        ({}, {"a": {"b": 1, "c": "2"}}, ["a.b := 1", "a.c := '2'"]),
        ({}, {"points": [[1, 2]]}, ["points[] := [1, 2]"]),
        (
            {"v": [{"name": "x"}]},
            {"v": [{"name": "x", "t": 1}, {"name": "y"}]},
            ["v[x].t := 1", "v[] := (name := 'y')"],
        ),
        ({"v": [{"name": "x"}]}, {"v": []}, ["v := []"]),
        (
            {"v": [{"name": "x"}, {"name": "y"}, {"name": "z"}]},
            {"v": [{"name": "x", "n": 1}]},
            ["v[x].n := 1", "v[z] := DEFAULT", "v[y] := DEFAULT"],
        ),
        (
            {"v": [{"name": "Globals_1", "n": [1, 2]}]},
            {"v": [{"n": [1, 2]}]},
            ["v[0].name := DEFAULT FOR 'Globals_1'"],
        ),
        (
            {"v": [{"name": "Main", "kind": "functionBlock", "text": "a"}]},
            {"v": [{"name": "Main", "kind": "program", "text": "a"}]},
            ["v[Main].kind := 'program' FOR 'functionBlock'"],
        ),
    ],
)
def test_one_line_for_each_thing_left_unsaid(written: Any, meant: Any, lines: list[str]) -> None:
    assert [str(change) for change in changes(written, meant)] == lines


def test_a_change_for_another_text_is_stale() -> None:
    change = parse_change("text := 'T#1s0ms' FOR 'T#1s'")
    known = {"text": "T#1s"}
    apply(known, change)
    assert known == {"text": "T#1s0ms"}
    with pytest.raises(StaleError, match="'T#2s'"):
        apply({"text": "T#2s"}, change)


def test_what_the_text_has_behind_the_items_of_a_list_is_taken_out() -> None:
    text = {"pous": [{"name": "Main", "kind": "functionBlock"}, {"name": "Task"}]}
    meant = {"pous": [{"name": "Main", "kind": "program"}]}
    lines = [str(change) for change in changes(text, meant, guarded=True)]
    assert lines == ["pous[Main].kind := 'program' FOR 'functionBlock'", "pous[Task] := DEFAULT FOR (name := 'Task')"]
    for line in lines:
        apply(text, parse_change(line))
    assert text == meant
    with pytest.raises(StaleError, match="'other'"):
        apply({"pous": [{"name": "Task", "comment": "other"}]}, parse_change(lines[-1]))


@pytest.mark.parametrize("text", ["a.b := 1", "a[3] := 1", "a[x].y := 1", "a[#7].y := 1", "a[] := 1"])
def test_a_path_that_leads_nowhere_is_an_error(text: str) -> None:
    with pytest.raises(PathError):
        apply({"a": 5}, parse_change(text))


@pytest.mark.parametrize("text", ["a := 1 2", "a := 1 FOR", ":= 1", "a[ := 1", "a.", "5 := 1"])
def test_what_is_no_change_is_an_error(text: str) -> None:
    with pytest.raises(NotationError):
        parse_change(text)
