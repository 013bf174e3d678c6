"""Types that matiec does not take together: they are refused, as its compiler does, and not written as kept."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.report import Outcome
from tests.judges.matiec import MatiecError, require_matiec

DECLARED = (
    "bb, bc : BOOL; i, j : INT; d : DINT; ui : UINT; w : WORD; b : BYTE; r : REAL; t : TIME; s : STRING; td : TOD;"
)
TAKEN = """
i := i + j MOD 3|t := t * 2|t := t - T#1s|bb := 1|i := MAX(i, 5)|r := LIMIT(0.0, r, 10.0)|w := SHL(w, i)|r := SQRT(r)
w := NOT w|w := w AND 16#FF|w := w OR b|bb := t > T#1s|bb := s = 'x'|i := LEN(s)|r := i|i := TRUNC(r)
t := SEL(bb, t, T#1s)|i := REAL_TO_INT(r)|w := 65535|td := td + t|t := td - td|bb := bb AND 1
r := EXPT(r, 2.0)|i := MUX(i, 1, 2, 3)
r := MAX(r, 3)|r := LIMIT(0, r, 100)|r := SEL(bb, r, 0)|r := MUX(i, 1, r)|r := r + SEL(bb, 0, 1)|r := MAX(i, 3) * r
r := SQRT(2)|r := SQRT(i)|r := EXPT(2, i)|w := SHL(w, b)|d := MIN(d, i)|i := MAX(i, 7)|bb := MAX(r, 3) > 2
i := REAL_TRUNC_INT(r)|d := REAL_TRUNC_DINT(r)|bb := REAL_TRUNC_DINT(r) > 5|r := -SEL(bb, 1, 2) * r
"""
REFUSED = """
w := w + 1|b := b + 100|bb := bb + 1|t := t + 1|i := t|i := 'a'|i := 100000|bb := -1|i := MAX(i, d)
i := LIMIT(0, i, 10.0)|i := SHL(i, 1)|i := NOT i|bb := t > 5|w := ABS(w)|w := -w|s := i|bb := i AND bb
ui := -1|b := 300
"""


def _statements(texts: str) -> list[str]:
    return [text for line in texts.strip().splitlines() for text in line.split("|")]


def _converted(*statements: str) -> tuple[str, list[str]]:
    """The text for matiec, and what is lost."""
    text = f"PROGRAM Main\nVAR {DECLARED} END_VAR\n{'; '.join(statements)};\nEND_PROGRAM\n"
    project = sfc.loads(text.encode(), format="iec-text")
    data, report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)
    return data.decode(), [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)]


def test_what_is_taken_is_no_loss() -> None:
    assert _converted(*_statements(TAKEN))[1] == []


@pytest.mark.parametrize("statement", _statements(REFUSED))
def test_what_is_refused_is_not_executed(statement: str) -> None:
    found = _converted(statement)[1]
    assert found
    assert {why.endswith("does not compile there") for why in found} == {True}


def test_the_compiler_says_the_same(tmp_path: Path) -> None:
    matiec = require_matiec()
    matiec.build(_converted(*_statements(TAKEN))[0], tmp_path)
    for number, statement in enumerate(_statements(REFUSED)[::4]):
        with pytest.raises(MatiecError):
            matiec.build(_converted(statement)[0], tmp_path / str(number))


def _program(text: str) -> tuple[str, list[str]]:
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "iec-text", flavour="matiec", partial=True)
    return data.decode(), [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)]


@pytest.mark.parametrize("kind", ["TON", "Own"])
def test_function_blocks_in_structures_are_not_executed(kind: str) -> None:
    own = "FUNCTION_BLOCK Own VAR_INPUT x : BOOL; END_VAR VAR_OUTPUT y : BOOL; END_VAR y := x; END_FUNCTION_BLOCK"
    both = f"TYPE Both : STRUCT t : {kind}; n : INT; END_STRUCT; END_TYPE"
    _, lost = _program(f"{both} {own} PROGRAM Main VAR b : Both; END_VAR b.n := 1; END_PROGRAM")
    assert lost == [f"matiec has no function blocks in structures: declare an instance of {kind} in the POU"]


@pytest.mark.parametrize(("step", "is_renamed"), [("Main", True), ("Min", False)])
def test_a_step_gets_another_name_where_its_macro_changes_the_program(
    step: str, is_renamed: bool, tmp_path: Path
) -> None:
    text, lost = _program(f"""PROGRAM Main VAR k : INT; END_VAR
        INITIAL_STEP A1: Count(N); END_STEP STEP {step}: Count(N); END_STEP
        TRANSITION FROM A1 TO {step} := k > 3; END_TRANSITION
        TRANSITION FROM {step} TO A1 := k > 9; END_TRANSITION
        ACTION Count: k := MAX(k, 2) + 1; END_ACTION END_PROGRAM""")
    assert not lost
    assert (f"STEP {step}:" not in text) is is_renamed
    if is_renamed:
        require_matiec().build(text, tmp_path)


STRINGS = """TYPE Label : STRUCT text : STRING; END_STRUCT; END_TYPE
FUNCTION Longer : STRING VAR_INPUT x : STRING[10]; END_VAR Longer := x; END_FUNCTION
FUNCTION_BLOCK Main
VAR_INPUT s : STRING; END_VAR
VAR_OUTPUT n : INT; END_VAR
VAR l : Label; END_VAR
l.text := Longer(s); n := LEN(l.text);
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("source", ["iec-text", "codesys", "scl", "simaticml"])
def test_strings_have_the_length_of_matiec(source: str, tmp_path: Path) -> None:
    project = sfc.loads(STRINGS.encode(), format="iec-text")
    project = sfc.loads(sfc.convert(project, source).data, format=source, as_tool=True)
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    assert "STRING[" not in data.decode()
    losses = {(item.outcome, item.what) for item in report.losses}
    assert losses == {(Outcome.APPROXIMATED, "string")}
    caller = "PROGRAM Plant\nVAR one : Main; END_VAR\none(s := 'a');\nEND_PROGRAM\n"
    require_matiec().build(data.decode() + caller, tmp_path)
