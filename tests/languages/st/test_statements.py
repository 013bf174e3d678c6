"""Statements: what each construct becomes in the tree, and reading on after errors."""

from __future__ import annotations

from typing import Any

import pytest

from plcopen_sfc.languages.st import Parsed, parse_statements
from plcopen_sfc.languages.st.lexer import CommentKind
from plcopen_sfc.languages.st.nodes import If, Statements, Unreadable
from plcopen_sfc.model.dialect import Dialect
from tests.languages.st.shapes import shape

IEC, CODESYS, SCL = Dialect.IEC, Dialect.CODESYS, Dialect.SCL


def read(text: str, dialect: Dialect = IEC) -> Any:
    parsed = parse_statements(text, dialect)
    assert parsed.problems == ()
    return shape(parsed.tree.statements)


def messages(parsed: Parsed[Statements]) -> list[tuple[int, int, str]]:
    return [(*parsed.place(problem.span[0]), problem.message) for problem in parsed.problems]


def one(target: str) -> list[Any]:
    return [("Assignment", target, "1", ":=")]


def test_if() -> None:
    assert read("IF a THEN x:=1; ELSIF b THEN y:=1; ELSIF c THEN ELSE z:=1; END_IF;") == [
        ("If", [("Branch", "a", one("x")), ("Branch", "b", one("y")), ("Branch", "c", [])], one("z"))
    ]
    assert read("IF a THEN END_IF") == [("If", [("Branch", "a", [])], None)]
    assert read("IF a THEN ELSE END_IF;") == [("If", [("Branch", "a", [])], [])]


def test_case_with_values_ranges_lists_and_enumerations() -> None:
    text = "CASE s OF 1: x:=1; 2, 4..6, -1: y:=1; E.idle, E#run: ; CONST+1: z:=1; ELSE q:=1; END_CASE"
    assert read(text) == [
        (
            "Case",
            "s",
            [
                ("CaseBranch", ["1"], one("x")),
                ("CaseBranch", ["2", ("Range", "4", "6"), ("neg", "1")], one("y")),
                ("CaseBranch", [("Member", "E", "idle"), "E#run"], [("Empty",)]),
                ("CaseBranch", [("+", "CONST", "1")], one("z")),
            ],
            one("q"),
        )
    ]


def test_loops() -> None:
    assert read("FOR i := 0 TO 9 DO x:=1; END_FOR;") == [("For", "i", "0", "9", None, one("x"))]
    assert read("FOR i := 9 TO 0 BY -1 DO EXIT; END_FOR") == [("For", "i", "9", "0", ("neg", "1"), [("Exit",)])]
    assert read("WHILE a DO CONTINUE; END_WHILE") == [("While", "a", [("Continue",)])]
    assert read("REPEAT x:=1; UNTIL a END_REPEAT") == [("Repeat", one("x"), "a")]
    assert read("REPEAT x:=1; UNTIL a; END_REPEAT;") == [("Repeat", one("x"), "a")]


def test_calls_returns_and_empty_statements() -> None:
    assert read("f(); fb.act; RETURN; ;") == [
        ("CallStatement", ("Call", "f", [])),
        ("CallStatement", ("Member", "fb", "act")),
        ("ReturnStatement", None),
        ("Empty",),
    ]


def test_assignments_of_codesys() -> None:
    text = "x S= a; x R= b; r REF= y; a := b := c; p ?= q;"
    assert [item[-1] if item[-1] != ":=" else item[2] for item in read(text, CODESYS)] == [
        "S=",
        "R=",
        "REF=",
        ("AssignmentExpression", "b", "c"),
        "?=",
    ]
    assert read("SUPER^.Run(); THIS^.x := 1;", CODESYS)[1] == (
        "Assignment",
        ("Member", ("Dereference", "THIS"), "x"),
        "1",
        ":=",
    )
    assert read("__TRY a; __CATCH(e) b; __FINALLY c; __ENDTRY", CODESYS) == [
        ("Try", [("CallStatement", "a")], "e", [("CallStatement", "b")], [("CallStatement", "c")])
    ]
    assert read("lab: x := 1; JMP lab;", CODESYS) == [("LabelStatement", "lab"), *one("x"), ("Goto", "lab", "JMP")]


def test_statements_of_scl() -> None:
    assert read("#x += 1; again: GOTO again;", SCL) == [
        ("Assignment", "#x", "1", "+="),
        ("LabelStatement", "again"),
        ("Goto", "again", "GOTO"),
    ]
    text = 'REGION Fill (the tank) // free text\n "DB".a := 1;\nREGION\nEND_REGION END_REGION'
    assert read(text, SCL) == [
        (
            "RegionBlock",
            "Fill (the tank) // free text",
            [("Assignment", ("Member", '"DB', "a"), "1", ":="), ("RegionBlock", "", [])],
        )
    ]
    call = read('"TON_DB".TON(IN := #a, PT := T#1s, Q => #q); #inst(x := 1);', SCL)[0][1]
    assert call[1] == ("Member", '"TON_DB', "TON")
    assert read('CASE #s OF "IDLE": ; "RUN": ; END_CASE;', SCL)[0][2] == [
        ("CaseBranch", ['"IDLE'], [("Empty",)]),
        ("CaseBranch", ['"RUN'], [("Empty",)]),
    ]


def test_comments_and_pragmas_are_kept_apart() -> None:
    text = "(* a (* nested *) *) x := 1; // line\r\n{attribute 'a'} /* c */ y := 1;"
    parsed = parse_statements(text, CODESYS)
    assert parsed.problems == ()
    assert [(c.kind, c.text) for c in parsed.comments] == [
        (CommentKind.BLOCK, "(* a (* nested *) *)"),
        (CommentKind.LINE, "// line"),
        (CommentKind.PRAGMA, "{attribute 'a'}"),
        (CommentKind.BLOCK, "/* c */"),
    ]
    assert all(text[slice(*c.span)] == c.text for c in parsed.comments)


def test_a_comment_that_does_not_close_when_nested_is_not_nested() -> None:
    assert read("(* see (* above *) x := 1;") == one("x")


def test_a_statement_ends_with_its_semicolon() -> None:
    text = "IF a THEN b; END_IF; c;"
    parsed = parse_statements(text)
    assert [text[slice(*s.span)] for s in parsed.tree.statements] == ["IF a THEN b; END_IF;", "c;"]  # type: ignore[misc]


# -- errors


def test_several_errors_in_one_pass() -> None:
    parsed = parse_statements("a := ;\nb := 1;\nc := (1;\nIF d THEN\n  e := 2 +;\n  f := 1;\nEND_IF;\ng := 1;")
    assert messages(parsed) == [
        (1, 6, "found ';', expected an expression"),
        (3, 8, "found ';', expected ')'"),
        (5, 11, "found ';', expected an expression"),
    ]
    assert shape(parsed.tree.statements) == [
        ("Unreadable", "a := ;"),
        *one("b"),
        ("Unreadable", "c := (1;"),
        ("If", [("Branch", "d", [("Unreadable", "e := 2 +;"), *one("f")])], None),
        *one("g"),
    ]


def test_a_missing_semicolon_costs_nothing_but_the_problem() -> None:
    parsed = parse_statements("a := 1\nIF b THEN c := 1 END_IF\nd := 1")
    assert messages(parsed) == [
        (2, 1, "found 'IF', expected ';' or an operator"),
        (2, 18, "found 'END_IF', expected ';' or an operator"),
        (3, 7, "found the end of the text, expected ';'"),
    ]
    assert shape(parsed.tree.statements) == [*one("a"), ("If", [("Branch", "b", one("c"))], None), *one("d")]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("IF a THEN\n b;\n", "END_IF or a statement for the IF in line 1"),
        ("x;\nWHILE a DO b;", "END_WHILE or a statement for the WHILE in line 2"),
        ("CASE a OF 1: b;", "END_CASE or a statement for the CASE in line 1"),
        ("FOR i := 1 TO 2 DO", "END_FOR or a statement for the FOR in line 1"),
    ],
)
def test_a_block_that_is_not_closed(text: str, expected: str) -> None:
    parsed = parse_statements(text)
    assert len(parsed.problems) == 1
    assert parsed.problems[0].message.endswith(expected)
    assert parsed.problems[0].message.startswith("found the end of the text, expected ")


def test_an_inner_block_that_is_not_closed_leaves_the_outer_one() -> None:
    parsed = parse_statements("IF a THEN WHILE b DO c; END_IF; d;")
    assert [p.message for p in parsed.problems] == [
        "found 'END_IF', expected END_WHILE or a statement for the WHILE in line 1"
    ]
    assert isinstance(parsed.tree.statements[0], If)
    assert shape(parsed.tree.statements[1]) == ("CallStatement", "d")


def test_an_end_too_many() -> None:
    parsed = parse_statements("a := 1; END_IF; b := 1;")
    assert [p.message for p in parsed.problems] == ["found 'END_IF', expected a statement"]
    assert shape(parsed.tree.statements)[-1] == one("b")[0]


def test_labels_outside_of_case() -> None:
    parsed = parse_statements("1, 2: a;")
    assert [p.message for p in parsed.problems] == ["labels of this form belong into a CASE"]


def test_a_statement_before_the_first_label() -> None:
    parsed = parse_statements("CASE a OF b := 1; 1: c; END_CASE;")
    assert [p.message for p in parsed.problems] == ["a label is missing before this statement"]


@pytest.mark.parametrize(
    "block",
    [
        "REPEAT a := 1; END_REPEAT;",
        "REPEAT END_REPEAT",
        "REPEAT a := 1; UNTIL x foo END_REPEAT;",
        "REPEAT IF a THEN y := 1; END_REPEAT;",
        "REPEAT REPEAT END_REPEAT END_REPEAT;",
    ],
)
def test_a_repeat_without_its_condition_is_one_problem(block: str) -> None:
    parsed = parse_statements(f"{block} b := 2;")
    assert len(parsed.problems) == 1
    unreadable, rest = parsed.tree.statements
    assert isinstance(unreadable, Unreadable)
    assert unreadable.text == block
    assert shape(rest) == ("Assignment", "b", "2", ":=")


def test_too_many_problems_end_the_reading() -> None:
    parsed = parse_statements("a b;\n" * 1000)
    assert len(parsed.problems) == 50
    assert "".join(s.text for s in parsed.tree.statements if isinstance(s, Unreadable)).count("a b;") == 1000


def test_what_is_nested_without_end_is_not_read() -> None:
    text = "x := " + "(" * 10_000 + "1" + ")" * 10_000 + ";"
    parsed = parse_statements(text)
    assert [p.message for p in parsed.problems] == ["this is nested in more than 150 levels"]
    assert parsed.tree == Statements((Unreadable(text),))
