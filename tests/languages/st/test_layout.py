"""Laid out text means the same, keeps its comments, and is as it should be when it is laid out again."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.binding.text_sites import SiteKind
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.languages.st.layout import layout_edits
from plcopen_sfc.languages.text_edits import apply_edits
from plcopen_sfc.model.dialect import Dialect
from tests.corpus import corpus_files, require_corpus
from tests.languages.st.shapes import shape

WRITTEN = """if a and not b then x:=1;(* c *)
// note
  y := -3+ 4 ; // end
elsif (c) THEN
for i:=1 to 10 by -1 do z[i] := f( 1,2 ) ;
end_for
else
CASE k OF
// first
1,2: x := 1;
y:=2;

3..5:
x:=MAX(a,
b) ;
ELSE z := 0;
END_CASE
END_IF;



q:=S1 . X AND(b OR c) xor False;
"""
LAID_OUT = """IF a AND NOT b THEN x := 1; (* c *)
    // note
    y := -3 + 4; // end
ELSIF (c) THEN
    FOR i := 1 TO 10 BY -1 DO z[i] := f(1, 2);
    END_FOR
ELSE
    CASE k OF
        // first
        1, 2: x := 1;
            y := 2;

        3..5:
            x := MAX(a,
                b);
        ELSE z := 0;
    END_CASE
END_IF;



q := S1.X AND (b OR c) XOR FALSE;
"""


def laid_out(text: str, dialect: Dialect = Dialect.IEC, *, is_condition: bool = False) -> str:
    return apply_edits(text, layout_edits(text, dialect, is_condition=is_condition))


def test_keywords_blanks_and_indents() -> None:
    assert laid_out(WRITTEN) == LAID_OUT
    assert laid_out(LAID_OUT) == laid_out(LAID_OUT + "  ") == LAID_OUT
    assert laid_out(WRITTEN.replace("\n", "\r\n")) == LAID_OUT.replace("\n", "\r\n")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("IF a THEN\n\n\nx:=1;\n\nEND_IF\n\n", "IF a THEN\n\n\n    x := 1;\n\nEND_IF\n\n"),
        ("SUPER^();f[1]( a );", "SUPER^(); f[1](a);"),
        ("x := - -1;", "x := - -1;"),
        ("x := -  a;", "x := -a;"),
    ],
)
def test_line_breaks_calls_and_signs_stay(text: str, expected: str) -> None:
    assert laid_out(text, Dialect.CODESYS) == expected


@pytest.mark.parametrize(
    ("text", "dialect", "expected"),
    [
        ("a  and(not b)", Dialect.IEC, "a AND (NOT b)"),
        ('#a AND"DB".x[ 1 ]>=-2', Dialect.SCL, '#a AND "DB".x[1] >= -2'),
        ("p^ .x s= true", Dialect.CODESYS, "p^ .x s= true"),  # no condition
        ("a AND", Dialect.IEC, "a AND"),
        ("%IX0.1&x", Dialect.IEC, "%IX0.1 & x"),
    ],
)
def test_conditions_and_what_cannot_be_read(text: str, dialect: Dialect, expected: str) -> None:
    assert laid_out(text, dialect, is_condition=True) == expected


def assert_texts_mean_the_same(paths: Iterable[Path]) -> None:
    changed = 0
    for path in paths:
        try:
            names = Names(sfc.load(path))
        except sfc.SfcError:
            continue
        for site in names.text_sites():
            if site.is_program_text and site.reading is SiteKind.STATEMENTS:
                found = laid_out(site.text, names.dialect)
                changed += found != site.text
                assert laid_out(found, names.dialect) == found
                trees = [parse_statements(text, names.dialect).tree for text in (found, site.text)]
                assert str(shape(trees[0])).casefold() == str(shape(trees[1])).casefold()
    assert changed


def test_texts_of_fixtures_mean_the_same() -> None:
    assert_texts_mean_the_same(sorted(Path("fixtures/codesys").glob("*.xml")))


@pytest.mark.corpus
@pytest.mark.slow
def test_real_texts_mean_the_same() -> None:
    """Every text of every third file."""
    require_corpus()
    assert_texts_mean_the_same(
        path for kind in ("codesys", "twincat", "plcopen", "simaticml") for path in corpus_files(kind)[::3]
    )
