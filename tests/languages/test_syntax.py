"""Syntax errors of a project: each with its place in the text and in the file."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Action, Dialect, Expression, Pou, PouKind, Project, SfcBody, SfcNetwork, StBody
from tests.corpus import corpus_files, require_corpus
from tests.samples import fixture_files
from tests.snippets import codesys


def test_a_project_built_in_python_says_where_in_the_text() -> None:
    project = Project(pous=[Pou(name="Main", kind=PouKind.PROGRAM, bodies=[StBody(text="a := 1;\nb := ;\n")])])
    (found,) = sfc.check_syntax(project)
    assert found.code == "LNG101"
    assert found.message == "found ';', expected an expression"
    assert found.location.path == "Main, line 2, column 6"
    assert found.location.line is None


BODY = """<pou name="Main" pouType="program"><body><ST><xhtml:p>IF a &lt; b THEN
  c := 'x' &amp; d e;
END_IF;
f := 1 +;</xhtml:p></ST></body></pou>"""


def test_a_file_says_where_in_the_file() -> None:
    data = codesys(BODY)
    project = sfc.loads(data, path="line.xml")
    lines = data.decode().splitlines()
    places = [(d.location.line, d.location.column) for d in sfc.check_syntax(project)]
    assert [(lines[line - 1][column - 1 :][:3]) for line, column in places if line and column] == ["e;", ";</"]
    assert {d.location.file for d in sfc.check_syntax(project)} == {"line.xml"}


def test_equal_texts_are_found_where_each_stands() -> None:
    text = '<pou name="{}" pouType="program"><body><ST><xhtml:p>a b;</xhtml:p></ST></body></pou>'
    project = sfc.loads(codesys(text.format("One") + "\n" + text.format("Two")))
    lines = [d.location.line for d in sfc.check_syntax(project)]
    assert len(set(lines)) == 2


def test_an_edited_text_has_no_place_in_the_file() -> None:
    project = sfc.loads(codesys(BODY))
    body = project.pou("Main").body
    assert isinstance(body, StBody)
    body.text = "new text;"
    (found,) = sfc.check_syntax(project)
    assert found.location.line is None
    assert found.location.path == "Main, line 1, column 5"


@pytest.mark.slow
def test_what_no_expression_is_expected_in_is_not_parsed() -> None:
    found = [f"{file.name}: {d}" for file in fixture_files() for d in _problems(file)]
    assert found == []


def _problems(path: Path) -> list[sfc.Diagnostic]:
    try:
        project = sfc.load(path)
    except sfc.SfcError:
        return []  # broken on purpose
    return sfc.check_syntax(project)


def test_conditions_of_grafcets_are_read_as_such(tmp_path: Path) -> None:
    files = sorted(Path("fixtures/grafcet").iterdir())
    assert len(files) >= 3
    for file in files:
        project = sfc.load(file)
        saved = tmp_path / f"{file.stem}.json"
        sfc.save(project, saved)
        found = [sfc.check_syntax(each) for each in (project, sfc.load(saved), project.pous[0])]
        assert found == [[], [], []]


def test_conditions_of_other_charts_have_no_terms_of_grafcet() -> None:
    chart = SfcNetwork()
    chart.add_transition(chart.add_step("S0", initial=True), chart.add_step("S1"), Expression(text="↑a"))
    project = Project(
        dialect=Dialect.CODESYS, pous=[Pou(name="Main", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])]
    )
    (found,) = sfc.check_syntax(project)
    told = "'↑' cannot stand here: structured text has R_TRIG: `Edge(CLK := a);` and then `Edge.Q`"
    assert (found.code, found.message) == ("LNG101", told)


def test_an_unreadable_condition_of_a_grafcet_has_its_place() -> None:
    text = "GRAFCET G\nINPUTS\n    a\n    n : INT\nINITIAL STEP 1\n1 -> 2 : /a * [n < 5 + a*]\nSTEP 2\n2 -> 1 : ↑a\n"
    (found,) = sfc.check_syntax(sfc.loads(text.encode()))
    assert (found.code, found.location.line, found.location.column) == ("LNG101", 6, 26)
    assert "'n < 5 + a*' is no structured text" in found.message


LISTED = {
    "example.xml": [
        # instructions in the middle of lines: the file was formatted by a tool for XML
        "ILTest, line 1, column 7",
        "ILTest, line 2, column 56",
        "ILTest, line 4, column 62",
        "ILTest, line 5, column 56",
        "ILTest, line 6, column 57",
        "ILTest, line 9, column 60",
        "ILTest, line 10, column 59",
        "SFCTest / step Step3 / action IN1 / duration, line 1, column 3",  # a time without T#
    ],
}
"""Every text of the corpus that does not parse."""


@pytest.mark.slow
@pytest.mark.corpus
def test_all_texts_of_real_projects_parse() -> None:
    require_corpus()
    found: dict[str, list[str]] = {}
    for path in [*corpus_files("plcopen"), *corpus_files("codesys")]:
        for problem in _problems(path):
            found.setdefault(path.name, []).append(problem.location.path or "")
    assert found == LISTED


def test_conditions_may_end_with_a_semicolon_as_codesys_takes_it() -> None:
    project = Project(dialect=Dialect.CODESYS, pous=[Pou(name="Main", kind=PouKind.PROGRAM)])
    body = SfcBody()
    project.pous[0].bodies.append(body)
    step = body.chart.add_step("A", initial=True)
    body.chart.add_transition(step, step, Expression(text="a = b;"))
    assert sfc.check_syntax(project) == []


def test_the_texts_of_a_chart_alone_are_checked() -> None:
    chart = SfcNetwork()
    wait, work = chart.add_step("Wait", initial=True), chart.add_step("Work")
    chart.add_transition(wait, work, "a AND")
    chart.add_transition(work, wait, "b")
    (found,) = sfc.check_syntax(chart)
    assert "transition Wait -> Work" in str(found)
    pou = Pou(name="Main", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])
    pou.actions = [Action(name="Fill", body=StBody(text="q := ;"))]
    assert len(sfc.check_syntax(pou)) == 2
    assert len(sfc.check_syntax(chart)) == 1
