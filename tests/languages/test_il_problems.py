"""Faults of syntax in instruction lists, wherever they are read."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.languages.il_problems import instruction_problems

FAULTY = {
    "LD a AND": ("found the end of the text, expected an expression", ""),
    "LD a\nAND( b": ("AND( has no closing parenthesis", "AND"),
    "LD a\nANDN( b\nOR( c\n)\nST q": ("ANDN( has no closing parenthesis", "ANDN"),
    "LD a\n)\nST q": ("found ')', which no operator has opened", ")"),
    "LD a\nST": ("ST has no operand", "ST"),
    "LD a\n&N\nST q": ("&N has no operand", "&N"),
    "CAL\nLD a": ("CAL has no operand", "CAL"),
    "LD a\nJMPC Nowhere\nST q": ("JMPC leads to Nowhere, which is no label here", "JMPC"),
    "LD a\n3\nST q": ("expected an operator", "3"),
}
SOUND = [
    "LD a\nAND( b\nOR c\n)\nST q",
    "LD a\nAND (b OR c)\nST q",
    "LD a\n&N b\nST q",
    "CAL t(IN := a,\n PT := T#1s)\nLD t.Q\nST q",
    "LD a\nJMPC ende\nLD b\nST q\nEnde:",
    "Start: LD a\nNOT\nST q\nRETC",
    "LD n\nADD( m\nMUL 2\n)\nGT 3\nST q",
    "LD n\nINT_TO_REAL\nLIMIT 0.0, 1.0\nST x",
]
CHART = """PROGRAM Main
VAR a, b, c, q : BOOL; n : INT; t : TON; END_VAR
INITIAL_STEP S1: Work(N); END_STEP
TRANSITION FROM S1 TO S2 :
{condition}
END_TRANSITION
STEP S2: END_STEP
TRANSITION FROM S2 TO S1 := a; END_TRANSITION
ACTION Work:
{action}
END_ACTION
END_PROGRAM"""


@pytest.mark.parametrize("text", FAULTY)
def test_what_is_no_instruction_is_named_with_its_place(text: str) -> None:
    message, marked = FAULTY[text]
    (problem,) = instruction_problems(text)
    assert problem.message == message
    assert text[slice(*problem.span)] == marked


@pytest.mark.parametrize("text", SOUND)
def test_sound_instructions_have_no_faults(text: str) -> None:
    assert instruction_problems(text) == []


def test_instructions_are_checked_where_statements_are() -> None:
    """In conditions and actions: by the reader of texts, by `check_syntax`, and before another format is written."""
    broken = CHART.format(condition="LD a\nAND( b", action="LD a\nST")
    project = sfc.loads(broken.encode(), format="iec-text")
    assert [(each.code, each.location.line) for each in project.diagnostics] == [("IEC110", 6), ("IEC110", 12)]
    found = sfc.check_syntax(project)
    assert [(each.code, each.location.line) for each in found] == [("LNG101", 12), ("LNG101", 6)]
    (of_chart,) = sfc.check_syntax(project.pou("Main").chart)
    assert of_chart.message == "AND( has no closing parenthesis"
    with pytest.raises(sfc.DamagedSourceError):
        sfc.dumps(project, format="plcopen-2.01")
    with pytest.raises(sfc.LoweringError, match=r"cannot be read as an expression: AND\( has no closing parenthesis"):
        sfc.lower(project, "bits", verify=False)


def test_the_same_chart_without_faults_has_no_finding() -> None:
    sound = CHART.format(condition="LD a\nAND( b\nOR c\n)", action="LD a\nJMPC Ende\nLD n\nADD 1\nST n\nEnde: LD TRUE")
    project = sfc.loads(sound.encode(), format="iec-text")
    assert not project.diagnostics
    assert sfc.check_syntax(project) == []
