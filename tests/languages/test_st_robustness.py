"""Text that is wrong, huge or hostile: problems at their places, the text kept, no exception and no hang."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from plcopen_sfc.languages.st import (
    Parsed,
    parse_condition,
    parse_declarations,
    parse_expression,
    parse_statements,
    print_node,
)
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import MAX_PROBLEMS, tokenize
from plcopen_sfc.model.dialect import Dialect
from tests.languages.st_invariants import assert_tree_fits
from tests.languages.st_strategies import CODESYS, dialects, laid_out, programs
from tests.sweeps import WHOLE

Parser = Callable[[str, Dialect], Parsed[Any]]
PARSERS: list[Parser] = [parse_statements, parse_expression, parse_condition, parse_declarations]


def told(parsed: Parsed[Any]) -> list[tuple[int, int, str]]:
    return [(*parsed.place(problem.span[0]), problem.message) for problem in parsed.problems]


# -- wrong text -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "line", "column", "message"),
    [
        ("a := 1;\nb := 2; (* no end\nc := 3;", 2, 9, "this comment has no end: *) is missing"),
        ("a := 1; (* one (* two *)", 1, 9, None),
        ("a := 1;\n  /* no end", 2, 3, "this comment has no end: */ is missing"),
        ("a := 1;\r\n{pragma", 2, 1, "this pragma has no end: } is missing"),
        ("a := 'no end;\nb := 1;", 1, 6, "this string has no end on its line"),
        ('a := 1;\rb := "no end;\rc := 1;', 2, 6, "this string has no end on its line"),
        ("a := 1;\nb := 2\x00;", 2, 7, "the character U+0000 cannot stand here"),
        ("a := ?;", 1, 6, "'?' cannot stand here"),
        ("a := b ≥ c;", 1, 8, "'≥' cannot stand here: structured text has >="),
        ("a := ¬b;", 1, 6, "'¬' cannot stand here: structured text has NOT"),
        ("a := \ud800;", 1, 6, "the character U+D800 cannot stand here"),
        ("a\r\n:=\n1\r;\n b := ;", 5, 7, "found ';', expected an expression"),
    ],
)
def test_wrong_tokens_are_told_at_their_place(text: str, line: int, column: int, message: str | None) -> None:
    parsed = parse_statements(text, Dialect.IEC)
    assert_tree_fits(parsed)
    if message is None:
        assert parsed.problems == ()  # a comment that closes only when it is not nested
    else:
        assert told(parsed)[0] == (line, column, message)


def test_text_behind_a_wrong_token_is_read() -> None:
    parsed = parse_statements("a := 'no end;\nb := 1;\nc := ?;\nd := 2;", Dialect.IEC)
    assert [place[:2] for place in told(parsed)] == [(1, 6), (3, 6)]
    kinds = [type(statement).__name__ for statement in parsed.tree.statements]
    assert kinds.count("Unreadable") == 2
    assert n.Assignment(n.Name("d"), n.Literal("2")) in parsed.tree.statements


def test_several_errors_each_at_its_place() -> None:
    text = "\n".join(
        [
            "a := ;",
            "IF b THEN",
            "    c := (1 + 2;",
            "    d := 3;",
            "END_IF;",
            "e := 4 5;",
            "CASE f OF 1: g := ]; END_CASE;",
            "h := 1;",
        ]
    )
    parsed = parse_statements(text, Dialect.CODESYS)
    assert [place[:2] for place in told(parsed)] == [(1, 6), (3, 16), (6, 8), (7, 19)]
    assert_tree_fits(parsed)
    branch = parsed.tree.statements[1]
    assert isinstance(branch, n.If)
    assert n.Assignment(n.Name("d"), n.Literal("3")) in branch.branches[0].statements
    assert parsed.tree.statements[-1] == n.Assignment(n.Name("h"), n.Literal("1"))


@pytest.mark.parametrize("word", ["IF", "CASE", "FOR", "WHILE", "REPEAT"])
def test_a_block_without_end_names_its_line(word: str) -> None:
    block = {
        "IF": "IF a THEN",
        "CASE": "CASE a OF 1:",
        "FOR": "FOR i := 1 TO 2 DO",
        "WHILE": "WHILE a DO",
        "REPEAT": "REPEAT",
    }[word]
    parsed = parse_statements(f"x := 1;\n{block}\n  y := 2;\n", Dialect.IEC)
    assert_tree_fits(parsed)
    (message,) = [place[2] for place in told(parsed)]
    assert message.endswith(f"for the {word} in line 2")
    assert parsed.tree.statements[0] == n.Assignment(n.Name("x"), n.Literal("1"))


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("IF a THEN IF b END_IF; x := 1; END_IF; y := 2;", ["If", "Assignment"]),
        ("IF a THEN WHILE b END_IF; y := 2;", ["If", "Assignment"]),
        ("IF a THEN x := 1; ELSE IF END_IF; END_IF; y := 2;", ["If", "Assignment"]),
        ("IF b END_IF; y := 2;", ["Unreadable", "Assignment"]),
        ("__TRY a(); __CATCH(e) b(); __FINALLY c();", ["Unreadable"]),
    ],
)
def test_a_block_that_is_not_finished_costs_only_itself(text: str, read: list[str]) -> None:
    parsed = parse_statements(text, Dialect.CODESYS)
    assert len(parsed.problems) == 1
    assert [type(statement).__name__ for statement in parsed.tree.statements] == read
    assert_tree_fits(parsed)


@pytest.mark.parametrize("encoding", ["cp437", "cp1251", "utf-16-le", "utf-8"])
def test_text_in_the_wrong_code_page_is_kept(encoding: str) -> None:
    text = "Größe := Größe + 1; // Füllhöhe\nTür := 'ß';".encode(encoding, "replace").decode("latin-1")
    for parse in PARSERS:
        for dialect in Dialect:
            assert_tree_fits(parse(text, dialect))


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_lines_are_counted_with_any_line_end(newline: str) -> None:
    parsed = parse_statements(newline.join(["a := 1;", "", "  b := ;", "c := ;"]), Dialect.IEC)
    assert [place[:2] for place in told(parsed)] == [(3, 8), (4, 6)]


# -- huge and deep text -----------------------------------------------------------------------------------------------

DEEP = {
    "parentheses": lambda depth: "x := " + "(" * depth + "a" + ")" * depth + ";",
    "brackets": lambda depth: "x := " + "a[" * depth + "1" + "]" * depth + ";",
    "calls": lambda depth: "x := " + "f(" * depth + "1" + ")" * depth + ";",
    "NOT": lambda depth: "x := " + "NOT " * depth + "a;",
    "IF": lambda depth: "IF a THEN " * depth + "x := 1; " + "END_IF; " * depth,
    "CASE": lambda depth: "CASE a OF 1: " * depth + "x := 1; " + "END_CASE; " * depth,
    "members": lambda depth: "x := a" + ".b" * depth + ";",
    "differences": lambda depth: "x := a" + " - b" * depth + ";",
    "assignments": lambda depth: "a := " * depth + "b;",
    "open parentheses": lambda depth: "x := " + "(" * depth,
    "open IF": lambda depth: "IF a THEN " * depth,
    "closing": lambda depth: ") END_IF " * depth,
}


@pytest.mark.slow
@pytest.mark.parametrize("what", DEEP)
def test_what_is_nested_without_measure_is_told_and_kept(what: str) -> None:
    text = DEEP[what](10_000)
    for parse in (parse_statements, parse_expression):
        parsed = parse(text, Dialect.CODESYS)
        assert parsed.problems
        assert_tree_fits(parsed)


@pytest.mark.parametrize("what", ["parentheses", "brackets", "calls", "NOT", "IF", "CASE", "members", "differences"])
def test_what_people_nest_is_read(what: str) -> None:
    parsed = parse_statements(DEEP[what](20), Dialect.CODESYS)
    assert parsed.problems == ()
    assert_tree_fits(parsed)


def test_deep_comments_are_one_comment() -> None:
    parsed = parse_statements("(*" * 10_000 + "*)" * 10_000 + "x;", Dialect.IEC)
    assert parsed.problems == ()
    assert len(parsed.comments) == 1


HUGE = {
    "statements": ("x := a + b; ", 0),
    "errors": ("x := ; ", MAX_PROBLEMS),
    "wrong characters": ("? # ", MAX_PROBLEMS),
    "open comments": ("(* ", 1),
    "open pragmas": ("{ ", 1),
    "open C comments": (" /*", 1),
    "comments that do not nest": ("(* a (* b *) ", 0),
    "quotes": ("'a", 1),
    "half blocks": ("IF a THEN ", 1),
    "one word": ("a", 1),
}


HUGE_SIZE = 5_000_000 if WHOLE else 500_000


@pytest.mark.slow
@pytest.mark.parametrize("what", HUGE)
def test_a_line_of_megabytes(what: str) -> None:
    piece, problems = HUGE[what]
    text = piece * (HUGE_SIZE // len(piece))
    parsed = parse_statements(text, Dialect.CODESYS)
    assert len(parsed.problems) in (
        {problems} if problems < MAX_PROBLEMS else range(MAX_PROBLEMS, 2 * MAX_PROBLEMS + 1)
    )
    end = parsed.tree.statements[-1].span if parsed.tree.statements else (0, 0)
    assert end is not None
    covered = max(end[1], parsed.comments[-1].span[1] if parsed.comments else 0)
    assert not text[covered:].strip()


def test_a_row_of_many_operands_is_flat() -> None:
    parsed = parse_expression(" AND ".join(["a"] * 20_000), Dialect.IEC)
    assert parsed.problems == ()
    assert isinstance(parsed.tree, n.Operation)
    assert len(parsed.tree.operands) == 20_000


# -- any text ---------------------------------------------------------------------------------------------------------

QUICK = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])

WORDS = """IF THEN ELSIF ELSE END_IF CASE OF END_CASE FOR TO BY DO END_FOR WHILE END_WHILE REPEAT UNTIL END_REPEAT EXIT
    RETURN CONTINUE NOT AND OR XOR MOD REGION END_REGION GOTO JMP __TRY __CATCH __FINALLY __ENDTRY a b.c #x "y" 1 2.5
    16#F T#1s 'text' %IX0.0 := => = <> <= ** + - * / & ( ) [ ] ; , : . .. ^ S= REF= ?= += :P { } (* *) // $ ' " # % @
    VAR VAR_INPUT END_VAR TYPE END_TYPE STRUCT END_STRUCT PROGRAM FUNCTION_BLOCK END_PROGRAM AT INT
    ARRAY BEGIN""".split()
token_soups = st.lists(st.sampled_from([*WORDS, "\n", "\r\n", "\r", " "]), max_size=40).map(" ".join)
glued_soups = st.lists(st.sampled_from([*WORDS, "\n", " "]), max_size=40).map("".join)
any_text = st.text(st.characters(), max_size=60)


@QUICK
@given(any_text | token_soups | glued_soups, dialects)
@example("\ud800", Dialect.IEC)
@example("\x00", Dialect.SCL)
@example("\ufeff", Dialect.IEC)
@example("a\u2028b\x85c\x0bd", Dialect.CODESYS)
def test_any_text_has_a_tree_that_covers_it(text: str, dialect: Dialect) -> None:
    for parse in PARSERS:
        assert_tree_fits(parse(text, dialect))


@pytest.mark.slow
@QUICK
@given(st.data(), programs(), st.integers(1, 3))
def test_programs_with_tokens_lost_or_put_in(
    data: st.DataObject, program: tuple[Dialect, n.Statements], changes: int
) -> None:
    dialect, tree = program
    text = data.draw(laid_out(print_node(tree), dialect))
    for _ in range(changes):
        tokens = tokenize(text, dialect).tokens
        if not tokens:
            return
        start, end = data.draw(st.sampled_from(tokens)).span
        new = data.draw(st.just("") | st.sampled_from(WORDS))
        end = data.draw(st.sampled_from([start, end]))
        text = f"{text[:start]}{new} {text[end:]}"
    parsed = parse_statements(text, dialect)
    assert_tree_fits(parsed)
    unreadable = any(isinstance(node, n.Unreadable) for node in parsed.tree.statements)
    assert parsed.problems or not unreadable


@pytest.mark.slow
@QUICK
@given(st.data(), programs(), programs())
def test_a_wrong_statement_costs_no_other(
    data: st.DataObject, before: tuple[Dialect, n.Statements], after: tuple[Dialect, n.Statements]
) -> None:
    dialect = before[0]
    if after[0] is not dialect and not {after[0], dialect} <= CODESYS:
        return
    wrong = data.draw(st.sampled_from(["x := ;", "x := (1;", "f(1,,2);", "?;", "x y;", "IF THEN a; END_IF;"]))
    marks = ["marker_1 := 1;", "marker_2 := 2;"]
    text = "\n".join([print_node(before[1]), marks[0], wrong, marks[1], print_node(after[1])])
    parsed = parse_statements(text, dialect)
    assert_tree_fits(parsed)
    first, last = text.index(wrong), text.index(marks[1])
    assert parsed.problems
    assert all(first <= problem.span[0] <= last for problem in parsed.problems), told(parsed)
    for number, mark in enumerate(marks, 1):
        assert n.Assignment(n.Name(mark[:8]), n.Literal(str(number))) in parsed.tree.statements
