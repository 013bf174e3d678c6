"""Comments, pragmas and regions between dialects."""

from __future__ import annotations

import pytest

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.translation import Translated, translate_text
from plcopen_sfc.model.dialect import Dialect

IEC, CODESYS, TWINCAT, SCL = Dialect.IEC, Dialect.CODESYS, Dialect.TWINCAT, Dialect.SCL


def translated(text: str, source: Dialect, target: Dialect) -> Translated:
    found = translate_text(text, "statements", source, target)
    assert found.parsed.problems == ()
    return found


@pytest.mark.parametrize(
    ("comment", "source", "target", "expected"),
    [
        ("// x", IEC, SCL, "// x"),
        ("(* x (* y *) *)", IEC, CODESYS, "(* x (* y *) *)"),
        ("/* x */", IEC, CODESYS, "(* x *)"),
        ("/* x (* y */", IEC, SCL, "(* x ( * y *)"),
        ("/* x *) y */", IEC, SCL, "(* x * ) y *)"),
        ("(/* x */)", SCL, IEC, "(* x *)"),
        ("(/* x */)", SCL, CODESYS, "(* x *)"),
        ("(* x *)", SCL, CODESYS, "(* x *)"),
        ("(*pragma {x := 1}*)", SCL, CODESYS, "{x := 1}"),
    ],
)
def test_comments(comment: str, source: Dialect, target: Dialect, expected: str) -> None:
    found = translated(f"{comment}\n;{comment}\n", source, target)
    assert found.text == f"{expected}\n;{expected}\n"
    assert found.notes == ()


def test_pragmas_of_scl_are_comments() -> None:
    found = translated("{attribute 'x'} ;", CODESYS, SCL)
    assert found.text == "(*pragma {attribute 'x'}*) ;"
    assert [(note.severity, note.span) for note in found.notes] == [(Severity.WARNING, (0, 15))]
    assert translated(found.text, SCL, CODESYS).text == "{attribute 'x'} ;"


def test_pragmas_elsewhere_stay() -> None:
    found = translated("{attribute 'x'} ;", CODESYS, IEC)
    assert found.text == "{attribute 'x'} ;"
    assert [note.severity for note in found.notes] == [Severity.INFO]


@pytest.mark.parametrize("target", [IEC, SCL])
def test_conditional_pragmas_have_no_counterpart(target: Dialect) -> None:
    found = translated("{IF defined (variable: x)}\n;\n{END_IF}\n", CODESYS, target)
    assert (found.notes[0].severity, found.notes[0].line) == (Severity.ERROR, 1)
    assert "always executed" in found.notes[0].reason


REGIONS = "REGION Füll 'es' $ }(* no comment\r\n  REGION\r\n    ;\r\n  END_REGION;\r\nEND_REGION // end\r\n"


@pytest.mark.parametrize("target", [IEC, CODESYS, TWINCAT])
def test_regions_become_pragmas_and_come_back(target: Dialect) -> None:
    found = translated(REGIONS, SCL, target)
    assert found.text.split("\r\n") == [
        "{region 'Füll $'es$' $$ $7D(* no comment'}",
        "  {region ''}",
        "    ;",
        "  {endregion}",
        "{endregion} // end",
        "",
    ]
    assert found.notes == ()
    back = translated(found.text, target, SCL)
    assert back.text == REGIONS.replace("END_REGION;", "END_REGION")
    assert back.notes == ()


@pytest.mark.parametrize("pragma", ["{region 'x'}", '{ Region ("x") }', "{region('x')}", '{region "x" }'])
def test_forms_of_the_pragma(pragma: str) -> None:
    assert translated(f"{pragma} ; {{ENDREGION}} ;", CODESYS, SCL).text == "REGION x\n ; END_REGION ;"


@pytest.mark.parametrize("text", ["{region 'x'} ;", "{endregion} ;", "IF a THEN {region 'x'} ; END_IF; {endregion}"])
def test_regions_that_are_not_whole_are_comments(text: str) -> None:
    found = translated(text, CODESYS, SCL)
    assert "(*pragma {" in found.text
    assert "REGION" not in found.text
    assert {note.severity for note in found.notes if "pragmas" in note.reason} == {Severity.WARNING}


def test_regions_inside_of_what_changes() -> None:
    found = translated("IF a THEN\n  {region 'x'}\n x S= (* why *) y;\n{endregion}\nEND_IF;", CODESYS, SCL)
    assert "REGION x" in found.text


def test_comments_inside_of_what_changes_are_translated() -> None:
    found = translated("y := a /* x */ ** b;", IEC, CODESYS)
    assert found.text.count("(* x *)") == 1
    assert "/*" not in found.text


def test_regions_behind_letters_that_grow_in_capitals() -> None:
    assert translated("REGION ßß\n; End_Region", SCL, IEC).text == "{region 'ßß'}\n; {endregion}"


def test_the_end_of_a_region_may_be_named_in_a_comment() -> None:
    text = "REGION a (* END_REGION *)\n; (* END_REGION *) END_REGION (* END_REGION; *) ; (* END_REGION *)"
    found = translated(text, SCL, IEC).text
    assert found == (
        "{region 'a (* END_REGION *)'}\n; (* END_REGION *) {endregion} (* END_REGION; *)  (* END_REGION *)"
    )


def test_a_target_that_is_read_too_has_its_comments_once() -> None:
    assert translated("a[b (* x *) + 1] += (* y *) 2;", SCL, IEC).text == "(* y *) a[b (* x *) + 1] := a[b + 1] + 2;"
