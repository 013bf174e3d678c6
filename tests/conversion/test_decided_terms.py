"""Conditions without terms that others decide: shorter, with the same values."""

from __future__ import annotations

import random
import re
from itertools import product

import pytest

from plcopen_sfc.languages.st import parse_expression, print_node
from plcopen_sfc.lowering.code.boolean_logic import reduced


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a AND (b OR NOT a)", "a AND b"),
        ("a OR a AND b", "a"),
        ("a AND NOT (c AND a)", "a AND NOT c"),
        ("(a OR b) AND NOT (c AND (a OR b))", "(a OR b) AND NOT c"),
        ("a AND NOT a", "FALSE"),
        ("(a OR b) AND (a OR b OR c)", "a OR b"),
        ("F(a) AND (b OR NOT F(a))", "F(a) AND (b OR NOT F(a))"),
    ],
)
def test_terms_that_others_decide_are_left_out(text: str, expected: str) -> None:
    assert print_node(reduced(parse_expression(text).tree)) == expected


def test_a_reduced_expression_has_the_same_values() -> None:
    chance = random.Random(7)  # noqa: S311

    def expression(depth: int) -> str:
        if not depth or not chance.randrange(4):
            return chance.choice("abcd")
        if not chance.randrange(3):
            return f"NOT ({expression(depth - 1)})"
        word = chance.choice([" AND ", " OR "])
        return "(" + word.join(expression(depth - 1) for _ in range(chance.randint(2, 3))) + ")"

    for _ in range(300):
        text = expression(4)
        short = print_node(reduced(parse_expression(text).tree))
        assert len(short) <= len(print_node(parse_expression(text).tree))
        for values in product((False, True), repeat=4):
            names = {**dict(zip("abcd", values, strict=True)), "TRUE": True, "FALSE": False}
            python = [re.sub("AND|OR|NOT", lambda word: word[0].lower(), each) for each in (text, short)]
            assert eval(python[0], names.copy()) == eval(python[1], names.copy()), (text, short)  # noqa: S307
