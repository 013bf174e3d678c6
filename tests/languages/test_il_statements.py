"""Instruction list as statements: what they say, and that they do the same."""

from __future__ import annotations

import random

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.languages.il import statements
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.model.dialect import Dialect


def shown(text: str) -> str | None:
    tree = statements(text, Dialect.CODESYS)
    return None if tree is None else print_node(tree)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("LD a\nAND b\nST q\nSTN r", "q := a AND b;\nr := NOT (a AND b);"),
        ("LD n\nADD 1\nST n\nGT 5\nS q", "n := n + 1;\nIF n > 5 THEN\n    q := TRUE;\nEND_IF;"),
        ("LD a\nR q\nCALCN t(IN := b)", "IF a THEN\n    q := FALSE;\nEND_IF;\nIF NOT a THEN\n    t(IN := b);\nEND_IF;"),
        ("CAL t(IN := a)\nLD t.Q\nRETC\nLD b\nST q", "t(IN := a);\nIF t.Q THEN\n    RETURN;\nEND_IF;\nq := b;"),
        ("LD a\nCAL t\nCALC Fill", "t();\nIF a THEN\n    Fill();\nEND_IF;"),
        ("LD a\nAND( b\nOR c\n)\nST q", "q := a AND (b OR c);"),
        ("LD a\nAND b\nST a\nSTN b\nST c", "a := a AND b;\nb := NOT a;\nc := a;"),
    ],
)
def test_statements(text: str, expected: str) -> None:
    assert shown(text) == expected


@pytest.mark.parametrize(
    "text",
    [
        "m: LD a\nJMPC m",  # a loop without a statement
        "m: JMP m",
        "LD a\nJMPC x\nm: LD b\nST q\nx: LD c\nJMPC m",  # a jump into a loop
        "m: LD a\nST q\nLD b\nJMPC e\nLD c\nJMPC m\ne: LD a",  # a second way out of a loop
        "LD a\nAND b\nSTN a\nST c",  # the result would be computed from what was written
        "LD t.Q\nCAL t(IN := a)\nST q",
        "LD a\nAND( b\nST a\n)\nST q",
        "ST q",
        "LD a\nCU C1",
    ],
)
def test_what_no_statement_says(text: str) -> None:
    assert shown(text) is None


@pytest.mark.slow
def test_random_instructions_do_the_same() -> None:
    chosen = random.Random(7)  # noqa: S311  # the same in every run
    translated = proven = 0
    for _ in range(60):
        lines = ["LD a"]
        for _ in range(chosen.randint(2, 7)):
            word = chosen.choice(["LD", "LDN", "AND", "ANDN", "OR", "ORN", "XOR", "ST", "STN", "S", "R", "NOT"])
            lines.append(word if word == "NOT" else f"{word} {chosen.choice('abqr')}")
        tree = statements("\n".join(lines), Dialect.IEC)
        if tree is None:
            continue
        translated += 1
        one, two = (
            sfc.loads(f"FUNCTION_BLOCK F VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT q, r : BOOL; END_VAR\n{body}\n"
            "END_FUNCTION_BLOCK".encode(), format="iec-text").pous[0]
            for body in ("\n".join(lines), print_node(tree))
        )  # fmt: skip
        assert one.body is not None
        assert one.body.language == "IL"
        verdict = sfc.equivalent(one, two, "iec")
        assert not verdict.different, f"{lines}: {verdict}"
        proven += verdict.proven
    assert translated > 30
    assert proven > 20


def test_jumps_forward_are_if_and_else() -> None:
    over = "LD a\nJMPC m\nLD b\nST q\nm: LD c\nST r"
    assert shown(over) == "IF NOT a THEN\n    q := b;\nEND_IF;\nr := c;"
    both = "LD a\nJMPCN m\nLD b\nST q\nJMP e\nm: LD c\nST q\ne:"
    assert shown(both) == "IF NOT a THEN\n    q := c;\nELSE\n    q := b;\nEND_IF;"
    assert shown("LD a\nJMPC m\nm: ST b") is None  # the result may be that of another way


LOOPS = {
    "m: LD a\nST q\nLD n\nADD 1\nST n\nLT 5\nJMPC m\nLD q\nST r": (
        "REPEAT\n    q := a;\n    n := n + 1;\nUNTIL NOT (n < 5)\nEND_REPEAT;\nr := q;"
    ),
    "m: LD n\nGE 4\nJMPC e\nLD n\nADD 1\nST n\nJMP m\ne: LD a\nST r": (
        "WHILE NOT (n >= 4) DO\n    n := n + 1;\nEND_WHILE;\nr := a;"
    ),
    "m: LD n\nADD 1\nST n\nGE 4\nJMPC e\nLD a\nJMPCN k\nLD b\nST q\nk: JMP m\ne:": (
        "WHILE TRUE DO\n    n := n + 1;\n    IF n >= 4 THEN\n        EXIT;\n    END_IF;\n"
        "    IF a THEN\n        q := b;\n    END_IF;\nEND_WHILE;"
    ),
    "o: LD 0\nST m\ni: LD m\nADD 1\nST m\nLT 3\nJMPC i\nLD n\nADD m\nST n\nGE 4\nJMPCN o\nLD a\nST q": (
        "REPEAT\n    m := 0;\n    REPEAT\n        m := m + 1;\n    UNTIL NOT (m < 3)\n    END_REPEAT;\n"
        "    n := n + m;\nUNTIL n >= 4\nEND_REPEAT;\nq := a;"
    ),
}


@pytest.mark.parametrize("text", LOOPS)
def test_jumps_back_are_loops(text: str) -> None:
    assert shown(text) == LOOPS[text]
    head = "FUNCTION_BLOCK F VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT q, r : BOOL; END_VAR VAR m, n : INT; END_VAR"
    reset = "LD 0\nST n", "n := 0;"
    one, two = (
        sfc.loads(f"{head}\n{first}\n{body}\nEND_FUNCTION_BLOCK".encode(), format="iec-text").pous[0]
        for first, body in zip(reset, (text, LOOPS[text]), strict=True)
    )
    assert one.body is not None
    assert one.body.language == "IL"
    verdict = sfc.equivalent(one, two, "iec")
    assert verdict.proven, str(verdict)
