"""Whole projects in another dialect, and back."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.binding.text_sites import text_sites
from plcopen_sfc.model import (
    ActionAssociation,
    Dialect,
    Expression,
    Interface,
    Pou,
    PouKind,
    Project,
    Qualifier,
    SectionKind,
    SfcBody,
    SfcNetwork,
    StBody,
    Variable,
    VariableSection,
)
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.refactor.dialect_translation import translate_project
from plcopen_sfc.report import Outcome
from tests.corpus import corpus_files, require_corpus
from tests.sweeps import some_files


def mixer(dialect: Dialect, text: str, *names: str) -> Project:
    """A project with one body, and a chart whose first condition is the time of its step."""
    section = VariableSection(kind=SectionKind.LOCAL, variables=[Variable(name=name, type="BOOL") for name in names])
    chart = SfcBody()
    step = chart.chart.add_step("Fill", initial=True)
    chart.chart.add_transition(
        step, step, "Fill.t > T#5s AND Ready" if dialect is not Dialect.SCL else "#Fill.T > T#5s"
    )
    pou = Pou(
        name="Mixer", kind=PouKind.FUNCTION_BLOCK, interface=Interface(sections=[section]), bodies=[StBody(text=text)]
    )
    charts = Pou(name="Chart", kind=PouKind.PROGRAM, bodies=[chart])
    return Project(dialect=dialect, pous=[pou, charts])


def test_locals_get_their_sign_and_globals_their_quotes() -> None:
    project = mixer(Dialect.CODESYS, "Valve := Ready AND Start; // opens", "Valve", "Ready")
    translate_project(project, Dialect.SCL)
    assert project.dialect is Dialect.SCL
    assert [text_site.text for text_site in text_sites(project) if text_site.is_program_text] == [
        '#Valve := #Ready AND "Start"; // opens',
        '#Fill.T > T#5s AND "Ready"',
    ]
    translate_project(project, Dialect.CODESYS)
    assert project == mixer(Dialect.CODESYS, "Valve := Ready AND Start; // opens", "Valve", "Ready")


def test_instances_of_timers_and_counters_get_the_types_of_s7() -> None:
    kinds = ("TON", "TP", "LTOF", "CTU", "Valve", "R_TRIG")
    section = VariableSection(variables=[Variable(name=f"v{n}", type=DerivedType(name=k)) for n, k in enumerate(kinds)])
    pou = Pou(name="Mixer", kind=PouKind.FUNCTION_BLOCK, interface=Interface(sections=[section]))
    project = Project(dialect=Dialect.IEC, pous=[pou])
    before = project.model_copy(deep=True)
    translate_project(project, Dialect.SCL)
    found = [variable.type for variable in section.variables]
    assert [kind.name for kind in found if isinstance(kind, DerivedType)] == [
        *("TON_TIME", "TP_TIME", "TOF_LTIME", "CTU_INT"),
        *("Valve", "R_TRIG"),
    ]
    translate_project(project, Dialect.IEC)
    assert project == before


def test_a_block_of_the_project_that_is_called_like_a_timer_stays_what_it_is() -> None:
    section = VariableSection(variables=[Variable(name="t", type=DerivedType(name="TON"))])
    pou = Pou(name="TON", kind=PouKind.FUNCTION_BLOCK, interface=Interface(sections=[section]))
    translate_project(Project(dialect=Dialect.IEC, pous=[pou]), Dialect.SCL)
    assert section.variables[0].type == DerivedType(name="TON")


def test_names_that_only_scl_can_write_are_renamed_where_they_are_declared_too() -> None:
    project = mixer(Dialect.SCL, '#"Füll stand" := TRUE;', "Füll stand")
    found = translate_project(project, Dialect.IEC)
    (body, *_) = [text_site.text for text_site in text_sites(project) if text_site.is_program_text]
    interface = project.pou("Mixer").interface
    assert interface is not None
    name = interface.variables()[0].name
    assert body == f"{name} := TRUE;"
    assert name == "Fuell_stand"
    assert any(note.severity is Severity.INFO for text in found for note in text.notes)


def test_what_does_not_parse_stays_and_is_noted() -> None:
    project = mixer(Dialect.CODESYS, "Valve := ;", "Valve")
    found = translate_project(project, Dialect.SCL)
    assert text_sites(project)[0].text == "Valve := ;"
    (note,) = found[0].notes
    assert note.severity is Severity.ERROR
    assert not found[0].changed


def real_projects() -> list[Path]:
    return some_files([path for kind in ("plcopen", "codesys") for path in corpus_files(kind)], 0, 2)


@pytest.mark.corpus
@pytest.mark.slow
@pytest.mark.parametrize("path", real_projects(), ids=lambda path: path.name)
def test_real_projects_go_to_scl_and_back(path: Path) -> None:
    require_corpus()
    try:
        project = sfc.load(path)
    except sfc.FormatError:
        pytest.skip("not a project")
    dialect = project.dialect
    before = [(text_site.path, text_site.text) for text_site in text_sites(project) if text_site.is_program_text]
    unread = [
        text.path
        for text in translate_project(project, Dialect.SCL)
        if any(n.severity is Severity.ERROR and "no actions" not in n.reason for n in text.notes)
    ]
    translate_project(project, dialect)
    after = [(text_site.path, text_site.text) for text_site in text_sites(project) if text_site.is_program_text]
    # a STRING without a length has 80 characters in CODESYS; SCL has to say so, and it stays said
    told = len([text for path, text in after if path.endswith(" / length") and text == "80"])
    after = [(path, text) for path, text in after if not (path.endswith(" / length") and text == "80")]
    before = [(path, text) for path, text in before if not (path.endswith(" / length") and text == "80")]
    assert told == 0 or dialect is Dialect.CODESYS
    pairs = list(zip(before, after, strict=True))
    assert unread == UNREADABLE.get(path.name, [])
    ends = re.compile(r"(?i)\b(END_(?:IF|CASE|FOR|WHILE|REPEAT))\s*;")
    closed = [(ends.sub(r"\1", a), ends.sub(r"\1", b)) for (_, a), (_, b) in pairs]
    different = [(a, b) for a, b in closed if a != b]  # SCL wants the semicolons
    assert {spelling(a, b) for a, b in different} <= {"case", "Step", "conversions"}


UNREADABLE = {"example.xml": ["POU SFCTest / step Step3 / action IN1 / duration"]}


def spelling(before: str, after: str) -> str:
    """Why a text came back otherwise: a name in other letters, or one that is a keyword in IEC 61131-3."""
    if before.casefold() == after.casefold():
        return "case"
    if before == ":= AND(IN1, IN2, IN3);":  # SCL has no functions of this name, and back the operator is as good
        return "case"
    bare = [re.sub(r"[A-Z]+_TO_[A-Z]+(?=\()|16#0*(?=\d)|[()]", "", text).casefold() for text in (before, after)]
    if bare[0] == bare[1]:  # SCL calculates in other types, and has no logic of integers
        return "conversions"
    logic = re.sub(r"NOT \((\S+) XOR (\S+)\)", r"\1=\2", after)
    if (
        re.sub(r"\s*=\s*TRUE|\s", "", before).casefold() == re.sub(r"\s", "", logic).casefold()
    ):  # S7 has no box that compares BOOL
        return "conversions"
    return "Step" if before == after.replace("Step_2", "Step") else f"{before!r} became {after!r}"


@pytest.mark.parametrize(("source", "type_"), [(Dialect.IEC, "CTU_INT"), (Dialect.CODESYS, "CTU_UINT")])
def test_counters_count_as_far_as_in_the_source(source: Dialect, type_: str) -> None:
    counter = Variable(name="c", type=DerivedType(name="CTU"))
    interface = Interface(sections=[VariableSection(kind=SectionKind.LOCAL, variables=[counter])])
    body = StBody(text="c(CU := TRUE, RESET := FALSE, PV := 3);" if source is Dialect.CODESYS else "c(CU := TRUE);")
    project = Project(pous=[Pou(name="F", kind=PouKind.PROGRAM, interface=interface, bodies=[body])], dialect=source)
    translate_project(project, Dialect.SCL)
    assert counter.type == DerivedType(name=type_)
    translate_project(project, source)
    assert counter.type == DerivedType(name="CTU")


def test_steps_get_names_that_other_tools_know_and_texts_follow() -> None:
    chart = SfcNetwork()
    first, second = chart.add_step("evacuation 2", initial=True), chart.add_step("Done")
    chart.add_transition(first, second, '#"evacuation 2".T > T#2s')
    chart.add_transition(second, first, '#"evacuation 2".X')
    on = ActionAssociation(id=chart.new_id(), qualifier=Qualifier.ON, target="evacuation 2")
    second.actions.append(on)
    pou = Pou(name="Chain", kind=PouKind.FUNCTION_BLOCK, bodies=[SfcBody(chart=chart)])
    project = Project(pous=[pou], dialect=Dialect.SCL)
    found = translate_project(project, Dialect.IEC)
    assert first.name == on.target == "evacuation_2"
    texts = ["evacuation_2.T > T#2s", "evacuation_2.X"]
    assert [t.condition for t in chart.transitions] == [Expression(text=text) for text in texts]
    assert [text.path for text in found if text.notes] == ["POU Chain / step evacuation 2"]


BITS = """{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := 'codesys'}
PROGRAM Main
VAR CONSTANT B1 : INT := 2; BB : INT := B1 + 1; C : INT := ABS(1); END_VAR
VAR a, Q : BOOL; w : WORD; END_VAR
w.BB := a; w.0 := a; Q := w.%s;
END_PROGRAM
"""


@pytest.mark.parametrize(("target", "bit"), [("simaticml", "%X3"), ("plcopen-2.01", "w.3")])
def test_bits_that_a_constant_names_get_their_numbers(target: str, bit: str) -> None:
    data, report = sfc.convert(sfc.loads((BITS % "bb").encode(), format="iec-text"), target, partial=True)
    assert {item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)} <= {"constant expression"}
    assert any(item.why.endswith("bit 3: the constant BB names it in CODESYS alone") for item in report.items)
    back = sfc.loads(data, format=target, as_tool=True).pou("Main").body
    assert isinstance(back, StBody)
    assert back.text.count(bit) == 2
    assert "bb" not in back.text.casefold()


def test_bits_of_unknown_number_are_not_executed() -> None:
    _, report = sfc.convert(sfc.loads((BITS % "C").encode(), format="iec-text"), "simaticml", partial=True)
    assert any("the bit C is not known" in item.why for item in report.with_outcome(Outcome.NOT_EXECUTED))
