"""Differences between dialects, one by one."""

from __future__ import annotations

import pytest

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.translation import translate_text
from plcopen_sfc.model.dialect import Dialect
from tests.languages.translating import assert_says_the_same, translated

IEC, CODESYS, TWINCAT, SCL = Dialect.IEC, Dialect.CODESYS, Dialect.TWINCAT, Dialect.SCL
INFO, WARNING, ERROR = Severity.INFO, Severity.WARNING, Severity.ERROR


# -- names ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('#a AND "b"', "a AND b"),
        ('"DB".station[#i].Value', "DB.station[i].Value"),
        ("plain", "plain"),
        ("#ENO", "ENO"),
        ('"FC1"(x := #y)', "FC1(x := y)"),
        ('#inst(In := "DB".a, Out => #b);', "inst(In := DB.a, Out => b);"),
    ],
)
@pytest.mark.parametrize("target", [IEC, CODESYS, TWINCAT])
def test_names_lose_their_quotes_and_prefixes(text: str, expected: str, target: Dialect) -> None:
    assert_says_the_same(text, SCL, target, expected)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a AND b", '#a AND "b"'),
        ("DB.station[i].Value", '"DB".station[#i].Value'),
        ("Größe > 1", '"Größe" > 1'),
        ("FC1(x := I)", '"FC1"(x := #I)'),
        ("A(In := a, Out => c);", '#A(In := #a, Out => "c");'),
        ("REGION + 1", '"REGION" + 1'),
        ("ABS(a)", "ABS(#a)"),
        ("INT_TO_REAL(a)", "INT_TO_REAL(#a)"),
        ("a.Goto", '#a."Goto"'),
        ("ENO AND a", "ENO AND #a"),
    ],
)
def test_names_get_quotes_and_prefixes(text: str, expected: str) -> None:
    assert_says_the_same(text, IEC, SCL, expected, locals=["a", "I"])


def test_names_stay_plain_where_nothing_is_known_of_them() -> None:
    found = translated("a AND b", IEC, SCL)
    assert found.text == "a AND b"
    assert [(note.severity, "not known which names are local" in note.reason) for note in found.notes] == [
        (WARNING, True)
    ]


def test_a_local_name_hides_a_function() -> None:
    assert_says_the_same("LIMIT(x)", IEC, SCL, "#LIMIT(#x)", locals=["Limit", "x"])


def test_objects_have_no_counterpart_in_scl() -> None:
    assert_says_the_same("THIS^.a", CODESYS, SCL, "#a", locals=["a"])
    for text, length in (("THIS^.b", 4), ("SUPER^.a", 5)):
        found = translated(text, CODESYS, SCL, locals=["a"])
        assert found.text == text
        assert [(note.severity, note.span) for note in found.notes] == [(ERROR, (0, length))]


def test_objects_are_pointers_in_codesys_only() -> None:
    assert_says_the_same("SUPER^(); x := THIS^.y;", CODESYS, IEC, "SUPER(); x := THIS.y;")
    assert_says_the_same(
        "SUPER(); Go(me := THIS); x := THIS.y;", IEC, CODESYS, "SUPER^(); Go(me := THIS^); x := THIS^.y;"
    )


# -- literals ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "source", "target", "expected"),
    [
        ("W#16#00_FF", SCL, IEC, "WORD#16#00_FF"),
        ("b#16#1", SCL, CODESYS, "BYTE#16#1"),
        ("DW#16#1", SCL, IEC, "DWORD#16#1"),
        ("L#5", SCL, IEC, "DINT#5"),
        ("WORD#16#FF", IEC, SCL, "W#16#FF"),
        ("WORD#2#10", IEC, SCL, "WORD#2#10"),
        ("LWORD#16#FF", IEC, SCL, "LWORD#16#FF"),
        ("INT#-5", CODESYS, SCL, "INT#-5"),
        ("16#FF", SCL, CODESYS, "16#FF"),
        ("T#1d_2h", IEC, SCL, "T#1d_2h"),
        ("T#2.5s", IEC, SCL, "T#2s500ms"),
        ("T#2.5s", SCL, IEC, "T#2.5s"),
        ("TIME#3000us", IEC, CODESYS, "T#3ms"),
        ("T#5m68s", IEC, CODESYS, "T#6m8s"),
        ("T#100s12ms", IEC, CODESYS, "T#100s12ms"),
        ("LT#1us", SCL, CODESYS, "LTIME#1us"),
        ("LD#2024-01-01", IEC, CODESYS, "LDATE#2024-01-01"),
        ("D#2024-01-01", SCL, IEC, "D#2024-01-01"),
        ('"wide \'x\' $" $$ $0041"', CODESYS, SCL, "WSTRING#'wide $'x$' \" $$ $0041'"),
        ("WSTRING#'a \"b\" $'c'", SCL, IEC, '"a $"b$" \'c"'),
        ("STRING#'x'", IEC, CODESYS, "'x'"),
        ('WCHAR#"a"', IEC, SCL, "WCHAR#'a'"),
        ("WCHAR#'a'", SCL, IEC, 'WCHAR#"a"'),
        ("TRUE", SCL, CODESYS, "TRUE"),
        ("NULL", IEC, SCL, "NULL"),
    ],
)
def test_literals(text: str, source: Dialect, target: Dialect, expected: str) -> None:
    assert_says_the_same(text, source, target, expected)


@pytest.mark.parametrize(
    ("text", "source", "target", "reason"),
    [
        ("T#1us", IEC, CODESYS, "whole ms"),
        ("T#-1s", IEC, CODESYS, "does not fit the TIME of codesys"),
        ("T#40d", CODESYS, SCL, "does not fit the TIME of scl"),
        ("DTL#2024-01-01-00:00:00", SCL, IEC, "no literals of the type DTL"),
        ("C#5", SCL, CODESYS, "no literals of the type COUNTER"),
        ("CHAR#'a'", IEC, CODESYS, "no literals of the type CHAR"),
        ("LDATE#2024-01-01", IEC, SCL, "no literals of the type LDATE"),
        ("P#M10.0", SCL, IEC, "pointer of S7"),
        ("NULL", IEC, CODESYS, "no NULL"),
        ("USINT#300", IEC, SCL, "does not fit USINT"),
        ("Color#red", IEC, SCL, "no enumerations"),
    ],
)
def test_literals_without_counterpart_stay(text: str, source: Dialect, target: Dialect, reason: str) -> None:
    found = translated(text, source, target, enumerations=["COLOR"])
    assert found.text == text
    assert [(note.severity, note.span) for note in found.notes] == [(ERROR, (0, len(text)))]
    assert reason in found.notes[0].reason


def test_s5time_becomes_time() -> None:
    for text, time in (("S5T#1m_5s", "T#1m_5s"), ("S5T#1s5ms", "T#1s")):
        found = translated(text, SCL, IEC)
        assert (found.text, found.notes) == (time, ())


def test_enumerations() -> None:
    assert_says_the_same("Color#red", IEC, CODESYS, "Color.red")
    assert_says_the_same("Color.red", CODESYS, IEC, "Color#red", enumerations=["color"])
    assert_says_the_same("Color.red", CODESYS, IEC, "Color.red")  # a variable, for all that is known
    found = translated("Color.red", CODESYS, SCL, enumerations=["color"])
    assert (found.text, [note.severity for note in found.notes]) == ("Color.red", [ERROR])


# -- addresses and bits -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "source", "target", "expected"),
    [
        ("%IX0.0", IEC, SCL, "%I0.0"),
        ("%Q4.7", CODESYS, SCL, "%Q4.7"),
        ("%E0.0", SCL, IEC, "%IX0.0"),
        ("%a1.2", SCL, CODESYS, "%QX1.2"),
        ("%M20.0", SCL, CODESYS, "%MX20.0"),
        ("%IB3", SCL, IEC, "%IB3"),
        ("%IX1.2.3", IEC, CODESYS, "%IX1.2.3"),
        ("#w.%X3", SCL, CODESYS, "w.3"),
        ("w.3", CODESYS, SCL, "#w.%X3"),
        ("#w.%B1", SCL, IEC, "w.%B1"),
    ],
)
def test_addresses_and_bits(text: str, source: Dialect, target: Dialect, expected: str) -> None:
    assert_says_the_same(text, source, target, expected, locals=["w"])


@pytest.mark.parametrize(
    ("text", "source", "target", "expected", "severity"),
    [
        ("%MW4", CODESYS, SCL, "%MW8", INFO),
        ("%MD3", IEC, SCL, "%MD12", INFO),
        ("%EW4", SCL, IEC, "%IW2", INFO),
        ("%ED8", SCL, IEC, "%ID2", INFO),
        ("%MW3", SCL, CODESYS, "%MW3", ERROR),
        ("%MD6", SCL, CODESYS, "%MD6", ERROR),
        ("%IX1.2.3", IEC, SCL, "%IX1.2.3", ERROR),
        ("%IX0.8", IEC, SCL, "%IX0.8", ERROR),
        ("%ML8", IEC, SCL, "%ML8", ERROR),
        ("%DB1.DBX0.0", SCL, IEC, "%DB1.DBX0.0", ERROR),
        ("%T5", SCL, CODESYS, "%T5", ERROR),
        ('"a":P', SCL, IEC, "a:P", ERROR),
        ("%IW4:P", SCL, IEC, "%IW2:P", ERROR),
        ("#w.%B1", SCL, CODESYS, "w.%B1", INFO),
    ],
)
def test_addresses_that_may_differ(
    text: str, source: Dialect, target: Dialect, expected: str, severity: Severity
) -> None:
    found = translated(text, source, target)
    assert found.text == expected
    assert severity in [note.severity for note in found.notes]


# -- operators --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "source", "target", "expected"),
    [
        ("a ** b", IEC, CODESYS, "EXPT(a, b)"),
        ("(a + b) ** (-c) * 2", IEC, CODESYS, "EXPT(a + b, -c) * 2"),
        ("-a ** 2", IEC, SCL, "(-#a) ** 2"),  # a sign binds tighter there, looser here
        ("-(a ** 2)", IEC, SCL, "-(#a ** 2)"),
        ("-#a ** 2", SCL, IEC, "-(a ** 2)"),
        ("(-#a) ** 2", SCL, IEC, "(-a) ** 2"),
        ("-#a ** 2", SCL, CODESYS, "-EXPT(a, 2)"),
        ("NOT #a ** 2 = 4", SCL, IEC, "NOT (a ** 2) = 4"),
        ("#a ** 2 ** 3", SCL, CODESYS, "EXPT(EXPT(a, 2), 3)"),
        ("EXPT(a + 1, 2) / 3", CODESYS, SCL, "(#a + 1) ** 2 / 3"),
        ("3 / EXPT(-a, b)", CODESYS, SCL, "3 / (-#a) ** #b"),
        ("-EXPT(a, b)", CODESYS, SCL, "-(#a ** #b)"),
        ("EXPT(EXPT(a, b), 2)", CODESYS, SCL, "(#a ** #b) ** 2"),
        ("a AND_THEN b = 1", CODESYS, SCL, "#a AND #b = 1"),
        ("a OR_ELSE (b AND c)", CODESYS, IEC, "a OR (b AND c)"),
        ("a AND_THEN b AND c", CODESYS, IEC, "a AND b AND c"),
        ("a & b", IEC, SCL, "#a & #b"),
        ("#a MOD 2", SCL, CODESYS, "a MOD 2"),
        ("ADD(a, b, 1) * 2", IEC, SCL, "(#a + #b + 1) * 2"),
        ("MUL(a, b + 1)", IEC, SCL, "#a * (#b + 1)"),
        ("GT(a, b)", IEC, SCL, "#a > #b"),
    ],
)
def test_operators(text: str, source: Dialect, target: Dialect, expected: str) -> None:
    found = translated(text, source, target, locals="abc")
    assert found.notes == ()
    assert found.parsed.problems == ()
    assert found.text == expected


@pytest.mark.parametrize(("source", "target"), [(CODESYS, IEC), (CODESYS, SCL), (IEC, CODESYS), (SCL, CODESYS)])
def test_pointers_are_no_references(source: Dialect, target: Dialect) -> None:
    found = translated("p^ + 1", source, target, locals=["p"])
    assert found.text == ("#p^ + 1" if target is SCL else "p^ + 1")
    assert [(note.severity, note.span) for note in found.notes] == [(WARNING, (0, 2))]


def test_short_circuit_that_matters_is_noted() -> None:
    found = translated("p <> 0 AND_THEN 100 / p > 1", CODESYS, IEC)
    assert found.text == "p <> 0 AND 100 / p > 1"
    assert [note.severity for note in found.notes] == [WARNING]


def test_comparisons_of_more_than_two_stay() -> None:
    found = translated("GT(a, b, c)", IEC, SCL, locals="abc")
    assert found.text == "GT(#a, #b, #c)"
    assert [note.severity for note in found.notes] == [ERROR]


# -- assignments and other statements ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "source", "target", "expected"),
    [
        ("x S= a OR b; // on", CODESYS, IEC, "IF a OR b THEN\n    x := TRUE;\nEND_IF; // on"),
        ("  x R= a;", CODESYS, SCL, "  IF #a THEN\n      #x := FALSE;\n  END_IF;"),
        ("#x += 1;", SCL, IEC, "x := x + 1;"),
        ("#x -= #a + 1;", SCL, CODESYS, "x := x - (a + 1);"),
        ("#x[#a] *= -2;", SCL, IEC, "x[a] := x[a] * (-2);"),
        ("#x /= (#a + 1);", SCL, IEC, "x := x / (a + 1);"),
        ("x := a := 0;", CODESYS, SCL, "#x := #a := 0;"),
        ("x := a := b := 0;", CODESYS, IEC, "b := 0;\na := b;\nx := a;"),
        ("GOTO ende; ende: ;", SCL, CODESYS, "JMP ende; ende: ;"),
        ("JMP ende; ende: ;", CODESYS, SCL, "GOTO ende; ende: ;"),
        ("ACT_Init;", CODESYS, IEC, "ACT_Init();"),
        ("RETURN; EXIT; CONTINUE; ;", SCL, IEC, "RETURN; EXIT; CONTINUE; ;"),
        ("CASE #a OF 1, 3..5: #x := 1; END_CASE;", SCL, IEC, "CASE a OF 1, 3..5: x := 1; END_CASE;"),
    ],
)
def test_statements(text: str, source: Dialect, target: Dialect, expected: str) -> None:
    assert_says_the_same(text, source, target, expected, locals="xab")


@pytest.mark.parametrize(
    ("text", "source", "target", "expected", "reason"),
    [
        ("r REF= a;", CODESYS, SCL, "#r REF= #a;", "REF="),
        ("r ?= a;", IEC, CODESYS, "r ?= a;", "?="),
        ("GOTO ende;", SCL, IEC, "GOTO ende;", "jumps"),
        ("ende: ;", CODESYS, IEC, "ende: ;", "labels to jump to"),
        ("__TRY a := r; __ENDTRY;", CODESYS, IEC, "__TRY a := r; __ENDTRY;", "__TRY"),
        ("RETURN a;", IEC, SCL, "RETURN #a;", "RETURN with a value"),
        ("ACT;", CODESYS, SCL, '"ACT"();', "actions"),
        ("IF (a := r) THEN ; END_IF;", CODESYS, IEC, "IF (a := r) THEN ; END_IF;", "assignments inside expressions"),
        ("x S= a S= r;", CODESYS, IEC, "x S= a S= r;", "left unchanged"),
    ],
)
def test_statements_without_counterpart_are_noted(
    text: str, source: Dialect, target: Dialect, expected: str, reason: str
) -> None:
    found = translated(text, source, target, locals="ar")
    assert found.text == expected
    assert any(note.severity is ERROR and reason in note.reason for note in found.notes)


# -- what a translation gives -----------------------------------------------------------------------------------------


def test_layout_and_comments_stay() -> None:
    text = (
        "#x  :=  #a (* first *)\r\n      AND\t#b; // last\r\n\r\n"
        "#inst(\r\n  In  := #a,   // in\r\n  Out => #b);\r\nIF #a THEN (* x *)\r\n  #b := 1; END_IF;"
    )
    assert_says_the_same(text, SCL, CODESYS, text.replace("#", ""))


def test_layout_stays_inside_of_what_is_written_anew() -> None:
    text = "x S= a/100  AND(*why*)NOT b; y := LIMIT(1, f(a/2*(*c*)b), EXPT(a*b,  2));"
    found = translated(text, CODESYS, SCL, locals="abxy")
    assert found.text == (
        "IF #a/100  AND(*why*)NOT #b THEN\n    #x := TRUE;\nEND_IF; "
        '#y := LIMIT(MN := 1, IN := "f"(#a/2*(*c*)#b), MX := (#a*#b) ** 2);'
    )


def test_notes_have_places() -> None:
    found = translated("#a := 1;\n  #b := P#M10.0;\n", SCL, IEC)
    assert [(note.line, note.column, note.span) for note in found.notes] == [(2, 9, (17, 24))]
    assert not found.exact
    assert translated("#a", SCL, IEC).exact


@pytest.mark.parametrize("text", ["a := ;", "a := 'open", "IF a THEN b := 1;", "(* never closed", "a b c", "\0"])
@pytest.mark.parametrize("target", list(Dialect))
def test_text_that_does_not_parse_stays(text: str, target: Dialect) -> None:
    for source in Dialect:
        for kind in ("statements", "expression"):
            found = translate_text(text, kind, source, target)
            if found.parsed.problems:
                assert found.text == text
                assert found.notes
                assert all(note.severity is ERROR for note in found.notes)


@pytest.mark.parametrize("dialect", list(Dialect))
def test_within_a_dialect_nothing_changes(dialect: Dialect) -> None:
    text = "x := a ** 2 AND T#1.5s > T#1us; (* c *)  /* d */ {p} y := EXPT(a, b);"
    found = translate_text(text, "statements", dialect, dialect)
    assert (found.text, found.notes) == (text, ())


def test_codesys_and_twincat_are_one_language() -> None:
    text = "x S= a AND_THEN p^; r REF= b; c(RESET := TRUE); {attribute 'x'}"
    for source, target in ((CODESYS, TWINCAT), (TWINCAT, CODESYS)):
        found = translate_text(text, "statements", source, target)
        assert (found.text, found.notes, found.parsed.dialect) == (text, (), target)


def test_conditions_as_they_stand_in_a_transition() -> None:
    found = translate_text(":= #a AND\t#b;  // c", "condition", SCL, CODESYS)
    assert (found.text, found.notes, found.parsed.problems) == (":= a AND\tb;  // c", (), ())
