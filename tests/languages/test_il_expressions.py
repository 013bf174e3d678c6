"""Instruction list that computes a value, as an expression."""

from __future__ import annotations

import pytest

from plcopen_sfc.languages.il import result_expression
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.model.dialect import Dialect


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("LD Start", "Start"),
        ("LDN Stop\nAND Start (* both *)", "NOT Stop AND Start"),
        ("LD a\nANDN b\nOR c", "a AND NOT b OR c"),
        ("LD a\nOR b\nAND c\nNOT", "NOT ((a OR b) AND c)"),
        ("LD a\nAND(\nLD b\nOR c\n)", "a AND (b OR c)"),
        ("LD a\nORN( b\nAND c\n)\nXOR d", "(a OR NOT (b AND c)) XOR d"),
        ("LD Timer.ET\nGE T#3s", "Timer.ET >= T#3s"),
        ("LD n\nADD 1\nMUL 2\nLT Limit[3]", "(n + 1) * 2 < Limit[3]"),
        ("LD n\nMAX 3, m\nGT 5", "MAX(n, 3, m) > 5"),
        ("LD a\nST Ready", "a"),
    ],
)
def test_what_only_computes_is_an_expression(text: str, expected: str) -> None:
    tree = result_expression(text, Dialect.CODESYS, stored_in="ready")
    assert tree is not None
    assert print_node(tree, Dialect.CODESYS) == expected


@pytest.mark.parametrize(
    "text",
    [
        "",
        "AND a",
        "LD a\nST b",
        "LD a\nS b\nLD c",
        "CAL t(IN := a)\nLD t.Q",
        "LD a\nJMPC m\nm: LD b",
        "LD a\nAND(\nLD b",
    ],
)
def test_what_does_more_is_none(text: str) -> None:
    assert result_expression(text, Dialect.CODESYS, stored_in="ready") is None
