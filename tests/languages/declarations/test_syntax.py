"""The grammar of declarations: what is at the outermost level, words that are names, and errors."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.languages.declarations import split_units
from plcopen_sfc.languages.st import declaration_nodes as d
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_declarations
from plcopen_sfc.model.dialect import Dialect
from tests.sweeps import examples


def messages(text: str, dialect: Dialect = Dialect.IEC) -> list[str]:
    return [problem.message for problem in parse_declarations(text, dialect).problems]


def head(text: str, dialect: Dialect = Dialect.CODESYS) -> d.PouHead:
    parsed = parse_declarations(text, dialect)
    assert parsed.problems == ()
    found = parsed.tree.items[0]
    assert isinstance(found, d.PouHead)
    return found


def test_heads() -> None:
    block = head("FUNCTION_BLOCK ABSTRACT PUBLIC x EXTENDS Lib.y IMPLEMENTS i, j")
    assert (block.keyword, block.qualifiers) == ("FUNCTION_BLOCK", ("ABSTRACT", "PUBLIC"))
    assert block.extends == (n.Member(n.Name("Lib"), n.Name("y")),)
    assert block.implements == (n.Name("i"), n.Name("j"))
    assert head("FUNCTION f : INT").type == d.NamedType(n.Name("INT"))
    assert head("METHOD PROTECTED m : ARRAY [0..1] OF INT").name == n.Name("m")
    assert head("PROPERTY p : BOOL").keyword == "PROPERTY"
    assert head("ACTION a:").type is None
    assert head("RESOURCE r ON PLC").type == d.NamedType(n.Name("PLC"))


def test_heads_of_scl() -> None:
    block = head(
        'FUNCTION_BLOCK "x y"\nTITLE = It\'s (* one\nAUTHOR : me\nVERSION : 0.1\nKNOW_HOW_PROTECT', Dialect.SCL
    )
    assert block.name == n.Name("x y", n.Quoting.GLOBAL)
    assert [(each.name, each.value) for each in block.properties] == [
        ("TITLE", "It's (* one"),
        ("AUTHOR", "me"),
        ("VERSION", "0.1"),
        ("KNOW_HOW_PROTECT", None),
    ]
    instance = head('DATA_BLOCK "Inst"\nVERSION : 0.1\nNON_RETAIN\n"Motor"', Dialect.SCL)
    assert instance.type == d.NamedType(n.Name("Motor", n.Quoting.GLOBAL))
    assert head("DATA_BLOCK DB11 FB10", Dialect.SCL).type == d.NamedType(n.Name("FB10"))


def test_configurations() -> None:
    text = """CONFIGURATION c RESOURCE r ON PLC TASK t(INTERVAL := T#1s, PRIORITY := 1);
        PROGRAM p WITH t : Main(a := b); END_RESOURCE END_CONFIGURATION"""
    parsed = parse_declarations(text)
    assert parsed.problems == ()
    kinds = [type(item) for item in parsed.tree.items]
    assert kinds == [d.PouHead, d.PouHead, d.TaskNode, d.ProgramInstance, d.EndNode, d.EndNode]


@pytest.mark.parametrize("name", "Type Action Step At Union Struct Constant Interface Public With On Method".split())
def test_words_of_declarations_can_be_names(name: str) -> None:
    parsed = parse_declarations(f"VAR {name} : INT; x, {name} : INT; e : (a, {name} := 1, {name}); END_VAR")
    assert parsed.problems == ()


@pytest.mark.parametrize("name", ["Region", "Title", "Version", "Name", "Author", "Goto"])
def test_words_of_scl_can_be_names(name: str) -> None:
    assert messages(f"VAR_INPUT\n{name} : Int;\nx : Int;\nEND_VAR", Dialect.SCL) == []


def test_types_with_and_without_a_semicolon() -> None:
    text = """TYPE a : INT(0..5) := 3; b : STRUCT x : INT; END_STRUCT c : STRUCT y : INT; END_STRUCT;
        d EXTENDS b : STRUCT END_STRUCT; e : DWORD (red := 16#FF, green); f : (p, q) INT := q; END_TYPE"""
    parsed = parse_declarations(text, Dialect.CODESYS)
    assert parsed.problems == ()
    (section,) = parsed.tree.items
    assert isinstance(section, d.TypeSection)
    names = [each.name.identifier for each in section.types if isinstance(each, d.TypeDeclaration)]
    assert names == list("abcdef")


def test_several_errors_in_one_pass_and_the_rest_is_read() -> None:
    parsed = parse_declarations(
        """VAR
        a : ;
        b : INT
        c : INT;
        d ! INT;
        e : STRUCT x : ; y : INT; END_STRUCT;
        END_VAR
        VAR_INPUT f : INT; END_VAR"""
    )
    assert [parsed.place(problem.span[0])[0] for problem in parsed.problems] == [2, 4, 5, 6]
    first, second = parsed.tree.items
    assert isinstance(first, d.Section)
    assert isinstance(second, d.Section)
    read = [v.names[0].identifier for v in first.variables if isinstance(v, d.VariableDeclaration)]
    assert read == ["b", "c", "e"]


def test_a_missing_end_of_a_section_is_put_in() -> None:
    parsed = parse_declarations("VAR a : INT;\nVAR_INPUT b : INT; END_VAR PROGRAM x VAR c : INT; END_VAR")
    assert [problem.message for problem in parsed.problems] == [
        "found the keyword 'VAR_INPUT', expected ';', AT, END_VAR or a name for the VAR in line 1"
    ]
    assert [type(item) for item in parsed.tree.items] == [d.Section, d.Section, d.PouHead, d.Section]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "VAR R_EDGE : BOOL; END_VAR",
            "found the keyword 'R_EDGE', expected ';', AT, CONSTANT or the like, END_VAR or a name",
        ),
        (
            "VAR a : BOOL; READ_ONLY : BOOL; END_VAR",
            "found the keyword 'READ_ONLY', expected ';', AT, END_VAR or a name",
        ),
        ("VAR a INT; END_VAR", "found 'INT', expected ',', ':' or AT"),
        ("VAR a : INT := ; END_VAR", "found ';', expected '[' or an expression"),
        ("VAR a : REAL[5]; END_VAR", "only STRING and WSTRING have a length"),
        ("VAR a : ARRAY [=] OF INT; END_VAR", "a dimension is missing here"),
        ("FUNCTION_BLOCK a b", "only a DATA_BLOCK has a name here"),
    ],
)
def test_errors_say_what_is_wrong(text: str, message: str) -> None:
    assert messages(text)[:1] == [message]


WORDS = [*"VAR END_VAR TYPE END_TYPE STRUCT END_STRUCT a : ; , ( ) [ ] := INT 1 .. OF ! {x}".split(), "\n"]


@given(st.lists(st.sampled_from(WORDS), max_size=30).map(" ".join))
@settings(max_examples=examples(300), deadline=None)
def test_every_text_has_a_tree_of_which_nothing_is_lost(text: str) -> None:
    parsed = parse_declarations(text)
    covered = 0
    for item in parsed.tree.items:
        assert item.span is not None
        assert _is_layout(text[covered : item.span[0]])
        covered = max(covered, item.span[1])
    assert _is_layout(text[covered:])


def _is_layout(between: str) -> bool:
    return not re.sub(r"\{[^}]*\}|;", "", between).strip()


def test_arrays_nested_without_measure_are_not_read() -> None:
    text = "VAR x : " + "ARRAY [0..1] OF " * 5000 + "INT; END_VAR"
    parsed = parse_declarations(text)
    assert [problem.message for problem in parsed.problems] == ["this is nested in more than 150 levels"]
    assert parsed.tree.items == (n.Unreadable(text),)


# -- units ------------------------------------------------------------------------------------------------------------


def test_units_of_iec_text() -> None:
    text = """(* c *) FUNCTION_BLOCK a VAR x : INT; END_VAR VAR_INPUT y : INT; END_VAR x := y; END_FUNCTION_BLOCK
TYPE t : INT; END_TYPE VAR_GLOBAL g : INT; END_VAR
PROGRAM p
  x := 1;
END_PROGRAM what is this
FUNCTION f : INT VAR a : INT; END_VAR"""
    found = split_units(text)
    assert [unit.keyword for unit in found.units] == ["FUNCTION_BLOCK", "TYPE", "VAR_GLOBAL", "PROGRAM", "FUNCTION"]
    bodies = [text[slice(*unit.body)].strip() if unit.body is not None else None for unit in found.units]
    assert bodies == ["x := y;", None, None, "x := 1;", ""]
    assert text[slice(*found.units[0].head)].endswith("y : INT; END_VAR")
    assert [problem.message for problem in found.problems] == [
        "a POU, a type or a list of variables is expected here",
        "END_FUNCTION is missing for the FUNCTION in line 6",
    ]


def test_a_unit_without_an_end_does_not_swallow_the_next() -> None:
    text = "FUNCTION_BLOCK a\nVAR x : INT; END_VAR\nx := 1;\nFUNCTION_BLOCK b\nEND_FUNCTION_BLOCK"
    found = split_units(text)
    assert [text[slice(*unit.head)].split()[1] for unit in found.units] == ["a", "b"]
    assert [unit.end is None for unit in found.units] == [True, False]
    assert [problem.message for problem in found.problems] == [
        "END_FUNCTION_BLOCK is missing for the FUNCTION_BLOCK in line 1"
    ]


def test_units_of_scl() -> None:
    text = """FUNCTION_BLOCK "a" VAR x : Int; END_VAR BEGIN x := 1; END_FUNCTION_BLOCK
DATA_BLOCK "b" STRUCT y : Int; END_STRUCT; BEGIN END_DATA_BLOCK
FUNCTION FC1 : Void
VAR_TEMP z : Int; END_VAR
z := 1;
END_FUNCTION"""
    found = split_units(text, Dialect.SCL)
    assert [text[slice(*unit.body)].strip() for unit in found.units if unit.body is not None] == [
        "x := 1;",
        "",
        "z := 1;",
    ]
    assert found.problems == ()
