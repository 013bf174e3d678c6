"""Expressions: what each construct becomes in the tree."""

from __future__ import annotations

from typing import Any

import pytest

from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.nodes import Literal, Name, Quoting, Unary, Unreadable, bare
from plcopen_sfc.model.dialect import Dialect
from tests.languages.st.shapes import MINUS, NOT, shape

IEC, CODESYS, SCL = Dialect.IEC, Dialect.CODESYS, Dialect.SCL


def read(text: str, dialect: Dialect = IEC) -> Any:
    parsed = parse_expression(text, dialect)
    assert parsed.problems == ()
    return shape(parsed.tree)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a OR b XOR c AND d", ("OR", "a", ("XOR", "b", ("AND", "c", "d")))),
        ("a AND b & c", ("AND", "a", "b", "c")),
        ("a OR (b OR c)", ("OR", "a", ("Parenthesized", ("OR", "b", "c")))),
        ("a = b AND c <> d", ("AND", ("=", "a", "b"), ("<>", "c", "d"))),
        ("a < b = c", ("=", ("<", "a", "b"), "c")),
        ("a + b * c - d", ("-", ("+", "a", ("*", "b", "c")), "d")),
        ("a - b - c", ("-", ("-", "a", "b"), "c")),
        ("a MOD b / c", ("/", ("MOD", "a", "b"), "c")),
        ("NOT a AND b", ("AND", (NOT, "a"), "b")),
        ("NOT a = b", ("=", (NOT, "a"), "b")),
        ("-a * b", ("*", (MINUS, "a"), "b")),
        ("a - -b", ("-", "a", (MINUS, "b"))),
        ("a ** b ** c", ("**", ("**", "a", "b"), "c")),
        ("a AND_THEN b OR_ELSE c", ("OR_ELSE", ("AND_THEN", "a", "b"), "c")),
        ("a and b Or c", ("OR", ("AND", "a", "b"), "c")),
    ],
)
def test_operators_bind_as_the_standard_says(text: str, expected: Any) -> None:
    assert read(text) == expected


def test_a_power_binds_less_than_a_sign_but_not_in_scl() -> None:
    assert read("-2 ** 2") == ("**", (MINUS, "2"), "2")
    assert read("-2 ** 2", SCL) == (MINUS, ("**", "2", "2"))
    assert read("- -a ** 2", SCL) == (MINUS, (MINUS, ("**", "a", "2")))
    assert read("(-2) ** 2", SCL) == ("**", ("Parenthesized", (MINUS, "2")), "2")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a.b.c", ("Member", ("Member", "a", "b"), "c")),
        ("a[1, i + 1].b[2]", ("Index", ("Member", ("Index", "a", ["1", ("+", "i", "1")]), "b"), ["2"])),
        ("p^.x", ("Member", ("Dereference", "p"), "x")),
        ("word.3", ("Member", "word", "3")),
        ("Step1.x AND Step1.t > T#2s", ("AND", ("Member", "Step1", "x"), (">", ("Member", "Step1", "t"), "T#2s"))),
        ("THIS^.Run()", ("Call", ("Member", ("Dereference", "THIS"), "Run"), [])),
        (
            "f(a)(b)",
            ("Call", ("Call", "f", [("Argument", "a", None, False, False)]), [("Argument", "b", None, False, False)]),
        ),
        ("inst.END_IF", ("Member", "inst", "END_IF")),
    ],
)
def test_access(text: str, expected: Any) -> None:
    assert read(text) == expected


def test_arguments_by_position_by_name_as_output_and_empty() -> None:
    assert read("fb(1, IN := x, PT := , Q => y, NOT R => z, ET =>)") == (
        "Call",
        "fb",
        [
            ("Argument", "1", None, False, False),
            ("Argument", "x", "IN", False, False),
            ("Argument", None, "PT", False, False),
            ("Argument", "y", "Q", True, False),
            ("Argument", "z", "R", True, True),
            ("Argument", None, "ET", True, False),
        ],
    )
    assert read("fb(EN := go, ENO => done)")[2][1] == ("Argument", "done", "ENO", True, False)
    assert read("fb(a,)") == ("Call", "fb", [("Argument", "a", None, False, False)])


def test_operators_as_functions() -> None:
    a, b = ("Argument", "a", None, False, False), ("Argument", "b", "IN2", False, False)
    assert read("x OR AND(a, IN2 := b)") == ("OR", "x", ("Call", "AND", [a, b]))
    assert [p.message for p in parse_expression("*(a, b)").problems] == ["found '*', expected an expression"]


@pytest.mark.parametrize(
    "literal",
    """1 1_000 16#FF 2#1010_0101 8#17 1.5 1.5e-3 1E6 TRUE FALSE INT#5 INT#-5 UINT#16#FF REAL#1.5 BOOL#1 BYTE#2#11
    T#5s T#-5s t#1d2h3m4s5.5ms TIME#10ms LTIME#1us2ns D#2024-02-29 DATE#2024-1-1 TOD#12:30:15.250 DT#2024-02-29-12:30:15
    LDT#2024-02-29-12:30:15.123456789 DATE_AND_TIME#1990-01-01-00:00:00 TIME_OF_DAY#0:0:0 'text' 'it$'s' '' '$N$41'
    STRING#'x' Color#red WSTRING#"x" 'one_word' """.split(),
)
def test_literals_are_one_token(literal: str) -> None:
    assert_literal(literal)


@pytest.mark.parametrize("literal", ["'with space'", '"wide $"text$""', "'(* no comment *)'"])
def test_texts_are_one_token(literal: str) -> None:
    assert_literal(literal)


def assert_literal(literal: str) -> None:
    assert parse_expression(literal).tree == Literal(literal)
    assert parse_expression(literal, CODESYS).tree == Literal(literal)


@pytest.mark.parametrize(
    "literal", ["S5T#10s", "S5TIME#1m", "W#16#FFFF", "P#M0.0", "P#DB1.DBX0.0 BYTE 10", "DTL#2024-01-01"]
)
def test_literals_of_scl(literal: str) -> None:
    assert parse_expression(literal, SCL).tree == Literal(literal)


@pytest.mark.parametrize("address", ["%IX0.0", "%QW4", "%MD48", "%I*", "%M20.0", "%MW20", "%QX1.2.3", "%IB2"])
def test_direct_addresses(address: str) -> None:
    assert read(f"{address} = 1") == ("=", address, "1")


def test_scl_names_slices_and_peripheral_access() -> None:
    assert read('#local AND "global"', SCL) == ("AND", "#local", '"global')
    assert read('"My DB".a.b[#i]', SCL) == ("Index", ("Member", ("Member", '"My DB', "a"), "b"), ["#i"])
    assert read('#w.%X3 OR "DB".d.%B1', SCL)[1:] == (("Member", "#w", "%X3"), ("Member", ("Member", '"DB', "d"), "%B1"))
    assert read('"tag":P', SCL) == ("Peripheral", '"tag')
    assert read("%IW4:P", SCL) == ("Peripheral", "%IW4")
    assert read("%DB1.DBX0.0", SCL) == "%DB1.DBX0.0"
    assert parse_expression('#"with space"', SCL).tree == Name("with space", Quoting.LOCAL_QUOTED)
    assert read("#if OR #end_if", SCL) == ("OR", "#if", "#end_if")


def test_a_double_quoted_text_is_a_string_but_a_name_in_scl() -> None:
    assert parse_expression('"x"', CODESYS).tree == Literal('"x"')
    assert parse_expression('"x"', SCL).tree == Name("x", Quoting.GLOBAL)


def test_codesys_assignments_in_expressions_and_variables_called_s() -> None:
    assert read("(a := b) > 3", CODESYS) == (">", ("Parenthesized", ("AssignmentExpression", "a", "b")), "3")
    assert read("S=1 OR r=2", CODESYS) == ("OR", ("=", "S", "1"), ("=", "r", "2"))
    assert read("__NEW(INT, 5)", CODESYS)[1] == "__NEW"


def test_ranges_are_no_reals() -> None:
    assert read("a[1].2") == ("Member", ("Index", "a", ["1"]), "2")
    parsed = parse_expression("1..5")
    assert [p.message for p in parsed.problems] == ["found '..', expected the end of the text"]


def test_umlauts_stand_in_names() -> None:
    assert read("Füllstand > Größe") == (">", "Füllstand", "Größe")


def test_bare_looks_through_parentheses() -> None:
    assert bare(parse_expression("((a))").tree) == Name("a")


def test_spans_are_places_in_the_text() -> None:
    text = "  a AND ( NOT bc )  "
    tree = parse_expression(text).tree
    assert tree.span == (2, 18)
    inner = bare(tree.operands[1])  # type: ignore[union-attr]
    assert isinstance(inner, Unary)
    assert text[slice(*inner.span)] == "NOT bc"  # type: ignore[misc]
    assert tree == parse_expression("a AND(NOT bc)").tree, "places do not count in comparisons"


def test_equal_texts_share_one_tree() -> None:
    assert parse_expression("Start AND NOT Fault") is parse_expression("Start AND NOT Fault")
    assert parse_expression("Start AND NOT Fault") is not parse_expression("Start AND NOT Fault", SCL)


@pytest.mark.parametrize(
    ("text", "message", "column"),
    [
        ("", "found the end of the text, expected an expression", 1),
        ("a AND", "found the end of the text, expected an expression", 6),
        ("a b", "found 'b', expected the end of the text or an operator", 3),
        ("(a", "found the end of the text, expected ')', ':=' or an operator", 3),
        ("a[1", "found the end of the text, expected ',' or ']'", 4),
        ("a.", "found the end of the text, expected a name", 3),
        ("a;", "found ';', expected the end of the text", 2),
        ("a ? b", "'?' cannot stand here", 3),
        ("'abc", "this string has no end on its line", 1),
        ("a (* b", "this comment has no end: *) is missing", 3),
        ("a\0", "the character U+0000 cannot stand here", 2),
    ],
)
def test_errors_say_what_was_found_and_what_was_expected(text: str, message: str, column: int) -> None:
    parsed = parse_expression(text)
    assert [problem.message for problem in parsed.problems][:1] == [message]
    assert parsed.place(parsed.problems[0].span[0]) == (1, column)


def test_what_does_not_parse_is_kept() -> None:
    assert parse_expression("a AND AND b").tree == Unreadable("a AND AND b")
