"""Instruction list that computes a value, as an expression."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import equivalent
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
    assert print_node(tree) == expected


@pytest.mark.parametrize(
    "text",
    [
        "",
        "AND a",
        "LD a\nST b",
        "LD a\nS b\nLD c",
        "CAL t(IN := a)\nLD t.Q",
        "m: LD a\nJMPC m",
        "LD a\nJMPC m\nLD b\nm: AND c",  # tools do not agree on the result that a jump leaves
        "LD a\nJMPC m\nLD b\nST ready\nOR c\nm: LD b",
        "LD a\nAND(\nLD b\nJMPC m\n)\nm: LD b",
        "\n".join(f"LD a\nJMPC m{i}\nLD b\nJMPC m{i}\nm{i}: LD c" for i in range(9)),
        "LD a\nAND(\nLD b",
    ],
)
def test_what_does_more_is_none(text: str) -> None:
    assert result_expression(text, Dialect.CODESYS, stored_in="ready") is None


JUMPS = [
    ("LD a\nJMPC yes\nLD b\nRET\nyes: LD c", "a AND c OR NOT a AND b"),
    ("LD a\nJMPCN no\nLD b\nAND c\nJMP end\nno: LDN c\nend:", "NOT a AND NOT c OR a AND (b AND c)"),
    ("LD a\nJMPC yes\nLD b\nST ready\nJMP end\nyes: LD c\nST ready\nend:", "a AND c OR NOT a AND b"),
    ("LD a\nRETC\nLD b\nANDN c", "a OR b AND NOT c"),
    ("LD a\nJMPCN end\nLD b\nend:", "a AND b"),
]


@pytest.mark.parametrize(("text", "expected"), JUMPS)
def test_ways_behind_jumps_are_joined(text: str, expected: str) -> None:
    tree = result_expression(text, Dialect.CODESYS, stored_in="ready")
    assert tree is not None
    assert print_node(tree) == expected


@pytest.mark.parametrize(("text", "expected"), [*JUMPS[:1], *JUMPS[2:3]])
def test_joined_ways_give_what_the_instructions_give(text: str, expected: str) -> None:
    """As the simulator runs the list, with each value of the inputs."""
    declared = "VAR_INPUT a : BOOL; b : BOOL; c : BOOL; END_VAR VAR_OUTPUT ready : BOOL; END_VAR"
    stored = text if "ST ready" in text else text.replace("\nRET", "\nST ready\nRET") + "\nST ready"
    one, other = (
        sfc.loads(f"PROGRAM Main {declared}\n{body}\nEND_PROGRAM".encode(), format="iec-text")
        for body in (stored, f"ready := {expected};")
    )
    assert one.pou("Main").body is not None
    assert one.pou("Main").body.language == "IL"
    assert equivalent(one, other).proven
