"""Structured text becomes instructions that do the same."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.languages.il import statements
from plcopen_sfc.languages.il_printing import NoInstructionError, statement_instructions
from plcopen_sfc.languages.st import parse_statements, print_node
from plcopen_sfc.model import Dialect, IlBody, Pou, Project, StBody

EXPRESSIONS = {
    "a AND NOT b": "LD a\nANDN b",
    "NOT a": "LDN a",
    "NOT (a OR b)": "LD a\nOR b\nNOT",
    "a OR b AND c": "LD a\nOR( b\nAND c\n)",
    "a AND (NOT b OR c)": "LD a\nAND(\nLDN b\nOR c\n)",
    "a XOR NOT (b AND c)": "LD a\nXORN( b\nAND c\n)",
    "i + 1 > j * 2": "LD i\nADD 1\nGT( j\nMUL 2\n)",
    "a AND t.ET >= T#5s": "LD a\nAND( t.ET\nGE T#5s\n)",
    "i MOD 2 = 0 OR i - j - 1 <> 3": "LD i\nMOD 2\nEQ 0\nOR( i\nSUB j\nSUB 1\nNE 3\n)",
    "LIMIT(1, i, 5) < 3": "LD 1\nLIMIT i, 5\nLT 3",
    "TRUE": "LD TRUE",
}


@pytest.mark.parametrize(("text", "listed"), EXPRESSIONS.items())
def test_expressions_are_instructions(text: str, listed: str) -> None:
    tree = parse_statements(f"q := {text};").tree
    assert statement_instructions(tree.statements) == f"{listed}\nST q"
    back = statements(f"{listed}\nST q", Dialect.IEC)
    assert back is not None
    assert statement_instructions(back.statements) == f"{listed}\nST q"


@pytest.mark.parametrize("text", ["f(x := 1) > 2", "MAX(a, b + 1)", "t.Q AND_THEN a"])
def test_what_has_no_instructions_is_refused(text: str) -> None:
    with pytest.raises(NoInstructionError):
        statement_instructions(parse_statements(f"q := {text};", Dialect.CODESYS).tree.statements)


STATEMENTS = [
    "q := a AND NOT b;",
    "IF a THEN q := TRUE; END_IF;",
    "IF a OR b THEN q := FALSE; ELSE n := n + 1; END_IF;",
    "IF a THEN n := 1; ELSIF b THEN n := 2; q := NOT q; ELSE n := 3; END_IF; n := n * 2;",
    "IF a THEN IF b THEN n := n - 3; END_IF; n := n + 1; END_IF;",
    "t(IN := a AND b, PT := T#20ms); q := t.Q;",
    "IF a THEN RETURN; END_IF; n := n + 1;",
    "n := -n + 2;",
]


@pytest.mark.parametrize("text", STATEMENTS)
def test_statements_are_instructions_that_do_the_same(text: str) -> None:
    tree = parse_statements(text).tree
    listed = statement_instructions(tree.statements)
    head = "PROGRAM Main VAR_INPUT a : BOOL; b : BOOL; END_VAR VAR q : BOOL; n : INT; t : TON; END_VAR {} END_PROGRAM"

    def project(body: StBody | IlBody) -> Project:
        made = sfc.loads(head.format(";").encode(), format="iec-text")
        made.pous[0].bodies = [body]
        return made

    one, other = project(StBody(text=text)), project(IlBody(text=listed))
    assert isinstance(other.pous[0], Pou)
    verdict = sfc.equivalent(one, other, "iec", delay="auto", cap=3000)
    assert verdict.counterexample is None, f"{listed}\n{verdict}"
    if "RETURN" not in text:
        again = statements(listed, Dialect.IEC)
        assert again is not None, print_node(tree)


def test_labels_go_on_through_a_body() -> None:
    tree = parse_statements("IF a THEN n := 1; n := 2; END_IF; IF b THEN n := 1; n := 2; END_IF;").tree
    listed = statement_instructions(tree.statements)
    assert [line for line in listed.splitlines() if line.endswith(":")] == ["End1:", "End2:"]
