"""Calls of standard functions and function blocks between dialects."""

from __future__ import annotations

import pytest

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.model.dialect import Dialect
from tests.languages.translating import assert_says_the_same, translated

IEC, CODESYS, TWINCAT, SCL = Dialect.IEC, Dialect.CODESYS, Dialect.TWINCAT, Dialect.SCL
INFO, WARNING, ERROR = Severity.INFO, Severity.WARNING, Severity.ERROR


@pytest.mark.parametrize(
    ("text", "source", "target", "expected"),
    [
        ("LIMIT(MN := #a, IN := #b, MX := 10)", SCL, CODESYS, "LIMIT(a, b, 10)"),
        ("LIMIT(MX := 10, MN := #a, IN := #b)", SCL, CODESYS, "LIMIT(a, b, 10)"),
        ("LIMIT(MN := #a, IN := #b, MX := 10)", SCL, IEC, "LIMIT(MN := a, IN := b, MX := 10)"),
        ("LIMIT(a, b, 10)", CODESYS, SCL, "LIMIT(MN := #a, IN := #b, MX := 10)"),
        ("MIN(a, b, 1)", IEC, SCL, "MIN(IN1 := #a, IN2 := #b, IN3 := 1)"),
        ("SEL(a, 1, 2)", CODESYS, SCL, "SEL(G := #a, IN0 := 1, IN1 := 2)"),
        ("MUX(a, 1, 2, 3)", CODESYS, SCL, "MUX(K := MIN(IN1 := #a, IN2 := 2), IN0 := 1, IN1 := 2, IN2 := 3)"),
        ("SHL(IN := #a, N := 2)", SCL, TWINCAT, "SHL(a, 2)"),
        ("LEFT(a, 3)", CODESYS, SCL, "LEFT(IN := #a, L := 3)"),
        ("MID(STR := a, LEN := 3, POS := 1)", CODESYS, IEC, "MID(IN := a, L := 3, P := 1)"),
        ("MID(IN := a, L := 3, P := 1)", IEC, CODESYS, "MID(a, 3, 1)"),
        ("CONCAT(STR1 := a, STR2 := b)", CODESYS, SCL, "CONCAT(IN1 := #a, IN2 := #b)"),
        ("CONCAT(a, b, 'x')", IEC, CODESYS, "CONCAT(CONCAT(a, b), 'x')"),
        ("ABS(#a)", SCL, CODESYS, "ABS(a)"),
        ("SQRT(a)", CODESYS, SCL, "SQRT(#a)"),
        ("SQR(#a)", SCL, IEC, "a * a"),
        ("1 / SQR(#s.v)", SCL, CODESYS, "1 / (s.v * s.v)"),
        ("INT_TO_REAL(a)", CODESYS, SCL, "INT_TO_REAL(#a)"),
        ("TO_REAL(b)", CODESYS, IEC, "TO_REAL(b)"),
        ("TO_REAL(c)", CODESYS, SCL, "INT_TO_REAL(#c)"),
        ("TRUNC(#a)", SCL, CODESYS, "TRUNC(a)"),
        ("REAL_TRUNC_DINT(a)", IEC, CODESYS, "TRUNC(a)"),
        ("REAL_TRUNC_INT(a)", IEC, SCL, "TRUNC_INT(#a)"),
        ("TRUNC_INT(a)", CODESYS, IEC, "REAL_TRUNC_INT(a)"),
        ("TRUNC_INT(x)", CODESYS, IEC, "LREAL_TRUNC_INT(x)"),
        ("MOVE(a)", CODESYS, SCL, "#a"),
        ("MOVE(a + 1) * 2", CODESYS, SCL, "(#a + 1) * 2"),
        ("ADD_TIME(a, T#1s)", IEC, CODESYS, "a + T#1s"),
        ("ADD_TIME(IN1 := a, IN2 := T#1s)", IEC, SCL, "#a + T#1s"),
        ("MUL_TIME(a, 2)", IEC, SCL, "#a * 2"),
        ("SUB_DATE_DATE(a, b)", IEC, CODESYS, "a - b"),
        ("UPPER_BOUND(a, 1)", IEC, SCL, "UPPER_BOUND(ARR := #a, DIM := 1)"),
        ("UPPER_BOUND(ARR := #a, DIM := 1)", SCL, CODESYS, "UPPER_BOUND(a, 1)"),
        ("WORD_TO_BOOL(a)", CODESYS, SCL, "(#a <> 16#0)"),
        ("DWORD_TO_BOOL(a + b)", IEC, SCL, "(#a + #b <> 16#0)"),
        ("NOT INT_TO_BOOL(c)", CODESYS, SCL, "NOT (#c <> 0)"),
        ("TO_BOOL(x)", CODESYS, SCL, "(#x <> 0.0)"),
        ("WORD_TO_BOOL(#a OR #b)", SCL, CODESYS, "WORD_TO_BOOL((a OR b) AND 16#1)"),
        ("BYTE_TO_BOOL(#a)", SCL, IEC, "BYTE_TO_BOOL(a AND 16#1)"),
        ("WORD_TO_BOOL(a)", CODESYS, IEC, "WORD_TO_BOOL(a)"),
        ("AND(a, b, c)", IEC, SCL, "#a AND #b AND #c"),
    ],
)
def test_functions(text: str, source: Dialect, target: Dialect, expected: str) -> None:
    types = {"c": "Int", "x": "LREAL"}
    assert_says_the_same(text, source, target, expected, locals=["a", "b", "c", "x"], types=types)


@pytest.mark.parametrize("text", ["SHR(c, 1)", "SHL(IN := c, N := 2)", "ROL(c, 1)"])
def test_numbers_are_shifted_in_tools_only(text: str) -> None:
    """IEC 61131-3 ed. 3, table 30: bit strings."""
    result = translated(text, CODESYS, IEC, locals=["c"], types={"c": "INT"})
    assert [(note.severity, note.reason) for note in result.notes] == [
        (ERROR, f"IEC 61131-3 has {text[:3]} of bit strings only, not of INT; left unchanged")
    ]


@pytest.mark.parametrize(
    ("text", "source", "target", "expected", "note"),
    [
        ("TO_REAL(a)", CODESYS, SCL, "TO_REAL(#a)", (ERROR, "tells the source type")),
        ("LOG(a)", IEC, SCL, "LOG(#a)", (ERROR, "no function LOG")),
        ("ATAN2(a, b)", IEC, CODESYS, "ATAN2(a, b)", (ERROR, "no function ATAN2")),
        ("ADR(a)", CODESYS, IEC, "ADR(a)", (ERROR, "ADR")),
        ("__NEW(T)", CODESYS, SCL, '__NEW("T")', (ERROR, "__NEW")),
        ("SCALE_X(MIN := 0, VALUE := #a)", SCL, IEC, "SCALE_X(MIN := 0, VALUE := a)", (ERROR, "no standard function")),
        ("ROUND(#a)", SCL, IEC, "TO_DINT(a)", (INFO, "rounded to even")),
        ("ROUND(#a)", SCL, CODESYS, "TO_DINT(a)", (WARNING, "rounded to even")),
        ("SQR(#a + 1)", SCL, IEC, "(a + 1) ** 2", (WARNING, "REAL")),
        ("SQR(#a + 1)", SCL, CODESYS, "EXPT(a + 1, 2)", (WARNING, "REAL")),
        ("MUX(K := #a, IN0 := 1, INELSE := 2)", SCL, IEC, "MUX(K := a, IN0 := 1, INELSE := 2)", (ERROR, "INELSE")),
        ("SEL(G := #a, IN0 := 1)", SCL, CODESYS, "SEL(G := a, IN0 := 1)", (ERROR, "by position")),
        ("LIMIT(a)", CODESYS, SCL, "LIMIT(#a)", (ERROR, "not its inputs")),
    ],
)
def test_functions_that_differ(
    text: str, source: Dialect, target: Dialect, expected: str, note: tuple[Severity, str]
) -> None:
    found = translated(text, source, target, locals=["a", "b"])
    assert found.text == expected
    assert [(each.severity, note[1] in each.reason) for each in found.notes] == [(note[0], True)], found.notes


@pytest.mark.parametrize(
    ("text", "source", "target", "expected"),
    [
        ("#t(IN := #a, PT := T#5s, Q => #b, ET => #e);", SCL, IEC, "t(IN := a, PT := T#5s, Q => b, ET => e);"),
        ("t(IN := a, PT := T#5s);", CODESYS, SCL, "#t(IN := #a, PT := T#5s);"),
        ('"T1".TON(IN := #a, PT := T#5s);', SCL, CODESYS, "T1(IN := a, PT := T#5s);"),
        ("T1(IN := a, PT := T#5s);", CODESYS, SCL, '"T1".TON(IN := #a, PT := T#5s);'),
        ("#t.TON(IN := #a, PT := T#5s);", SCL, IEC, "t(IN := a, PT := T#5s);"),
        ("edge(CLK := a);", IEC, SCL, "#edge(CLK := #a);"),
        ("E1(CLK := a);", IEC, SCL, '"E1"(CLK := #a);'),
        ("c(CU := a, RESET := b, PV := 3, Q => e);", CODESYS, SCL, "#c(CU := #a, R := #b, PV := 3, Q => #e);"),
        ("c(CU := a, R := b, PV := 3, CV => e);", IEC, TWINCAT, "c(CU := a, RESET := b, PV := 3, CV => e);"),
        ("ud(LOAD := a, RESET := b);", CODESYS, IEC, "ud(LD := a, R := b);"),
        ("#ud(LD := #a, R := #b);", SCL, CODESYS, "ud(LOAD := a, RESET := b);"),
        ("s(SET1 := a, RESET := b); b := s.Q1;", CODESYS, IEC, "s(S1 := a, R := b); b := s.Q1;"),
        ("c.RESET := a;", CODESYS, IEC, "c.R := a;"),
        ("many[3](CU := a, RESET := b);", CODESYS, SCL, "#many[3](CU := #a, R := #b);"),
        ("st.c(CU := a, RESET := b);", CODESYS, SCL, "#st.c(CU := #a, R := #b);"),
        ("prog(In := a, Out => b);", CODESYS, SCL, '"prog"(In := #a, Out => #b);'),
    ],
)
def test_instances(text: str, source: Dialect, target: Dialect, expected: str) -> None:
    locals_ = "a b e t edge c ud s many st".split()
    types = {
        "T": "TON_TIME" if source is SCL else "TON",
        "T1": "TON",
        "edge": "R_TRIG",
        "E1": "R_TRIG",
        "c": "CTU",
        "ud": "CTUD_INT" if source is SCL else "CTUD",
        "s": "SR",
        "many": "ARRAY [0..9] OF CTU",
        "st.c": "CTU",
    }
    assert_says_the_same(text, source, target, expected, locals=locals_, types=types)


@pytest.mark.parametrize(
    ("text", "source", "target", "expected", "note"),
    [
        ("x(CU := a, RESET := b);", CODESYS, IEC, "x(CU := a, RESET := b);", (WARNING, "RESET may have another name")),
        ("x(S1 := a, R := b);", IEC, CODESYS, "x(S1 := a, R := b);", (WARNING, "S1, R may have another name")),
        ("s(S1 := a, R := b);", IEC, SCL, "#s(S1 := #a, R := #b);", (ERROR, "no function block SR")),
        ("s(S1 := a, Foo := b);", IEC, CODESYS, "s(SET1 := a, Foo := b);", (ERROR, "no parameter Foo")),
        ("x(EN := a, ENO => b);", IEC, CODESYS, "x(EN := a, ENO => b);", (ERROR, "no EN")),
        ("x(IN := , PT := T#1s);", CODESYS, IEC, "x(PT := T#1s);", (INFO, "keeps what it has")),
        ("x.Init(a := b);", CODESYS, SCL, "#x.Init(a := #b);", (WARNING, "neither methods nor actions")),
        ("x(NOT Q => b);", IEC, SCL, "#x(NOT Q => #b);", (ERROR, "no negated outputs")),
    ],
)
def test_instances_that_differ(
    text: str, source: Dialect, target: Dialect, expected: str, note: tuple[Severity, str]
) -> None:
    found = translated(text, source, target, locals=["a", "b", "s", "x"], types={"s": "SR"})
    assert found.text == expected
    assert (note[0], True) in [(each.severity, note[1] in each.reason) for each in found.notes]


def test_calls_keep_their_layout() -> None:
    text = "c(\n    CU    := a, // up\n    RESET := b, // back\n    PV    := 3);"
    expected = text.replace("RESET", "R").replace("c(", "#c(").replace("= a", "= #a").replace("= b", "= #b")
    assert_says_the_same(text, CODESYS, SCL, expected, locals="abc", types={"c": "CTU"})
