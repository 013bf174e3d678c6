"""An edit of an SCL source changes the lines that say what was edited, and no others."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from tests.corpus import require_corpus
from tests.formats.scl.test_reading import CLASSIC, TIA, corpus_sources


def block(project: m.Project) -> m.Pou:
    return project.pou("FB_Fill")


def variables(project: m.Project, section: int) -> list[m.Variable]:
    interface = block(project).interface
    assert interface is not None
    return interface.sections[section].variables


def sections(project: m.Project) -> list[m.VariableSection]:
    interface = block(project).interface
    assert interface is not None
    return interface.sections


def start_values(project: m.Project, number: int) -> list[m.Variable]:
    interface = project.data_blocks[number].interface
    assert interface is not None
    return interface.variables()


def diff(path: Path, project: m.Project) -> list[str]:
    """The lines that saving takes out and puts in."""
    old, data = path.read_bytes(), sfc.dumps(project)
    assert sfc.loads(data, format="scl") == project
    encoding = "cp1252" if path == CLASSIC else "utf-8"
    lines = difflib.unified_diff(old.decode(encoding).split("\n"), data.decode(encoding).split("\n"), lineterm="", n=0)
    return [line.rstrip("\r") for line in lines if not line.startswith(("---", "+++", "@@"))]


def set_to(name: str, value: Any) -> Callable[[Any], None]:
    return lambda thing: setattr(thing, name, value)


EDITS: dict[str, tuple[Callable[[m.Project], Any], list[str]]] = {
    "name of a block": (
        lambda p: (set_to("name", "FB_Filling")(block(p)), set_to("type_name", "FB_Filling")(p.data_blocks[2])),
        ['-FUNCTION_BLOCK "FB_Fill"', '+FUNCTION_BLOCK "FB_Filling"', '-"FB_Fill"', '+"FB_Filling"'],
    ),
    "title": (
        lambda p: set_to("title", "New")(block(p)),
        ["-TITLE = Filling with two valves (it's slow)", "+TITLE = New"],
    ),
    "comment of a block": (
        lambda p: set_to("comment", 'Fills a tank: coarse first, then very fine.\nNeeds "FB_Valve".')(block(p)),
        ["-//Fills a tank: coarse first, then fine.", "+// Fills a tank: coarse first, then very fine."],
    ),
    "type": (
        lambda p: set_to("type", "Int")(variables(p, 0)[1]),
        ['-      "set point" : Real := 12.5;   // litres', '+      "set point" : Int := 12.5;   // litres'],
    ),
    "comment of a variable": (
        lambda p: set_to("comment", "gallons")(variables(p, 0)[1]),
        ['-      "set point" : Real := 12.5;   // litres', '+      "set point" : Real := 12.5;   // gallons'],
    ),
    "attribute": (
        lambda p: variables(p, 4)[0].attributes.update(LibVersion="1.1"),
        [
            "-      timer {InstructionName := 'TON_TIME'; LibVersion := '1.0'} : TON_TIME;",
            "+      timer {InstructionName := 'TON_TIME'; LibVersion := '1.1'} : TON_TIME;",
        ],
    ),
    "initial value": (
        lambda p: set_to("initial", None)(variables(p, 0)[1]),
        ['-      "set point" : Real := 12.5;   // litres', '+      "set point" : Real;   // litres'],
    ),
    "one of two that are declared together": (
        lambda p: set_to("type", "Int")(variables(p, 0)[3]),
        ["-      low, high : Bool;", "+      low : Bool;", "+      high : Int;"],
    ),
    "name of a variable": (
        lambda p: [set_to("name", "position")(found) for found in (variables(p, 3)[0], start_values(p, 2)[0])],
        ["-      step : Int;", "+      position : Int;", "-   step := 1;", "+   position := 1;"],
    ),
    "a variable less": (
        lambda p: (variables(p, 3).pop(0), set_to("interface", None)(p.data_blocks[2])),
        ["-      step : Int;", "-   step := 1;", "+"],
    ),
    "a variable more": (
        lambda p: variables(p, 1).append(m.Variable(name="done", type="BOOL", comment="x")),
        ["+      done : Bool; // x"],
    ),
    "a variable more at the start": (
        lambda p: variables(p, 1).insert(0, m.Variable(name="done", type="BOOL")),
        ["+      done : Bool;"],
    ),
    "retain": (lambda p: set_to("retain", False)(sections(p)[3]), ["-   VAR RETAIN", "+   VAR"]),
    "a section less": (lambda p: sections(p).pop(1), ["-   VAR_OUTPUT", "-      busy : Bool;", "-   END_VAR"]),
    "program": (
        lambda p: set_to("text", block(p).body.text.replace("T#5s", "T#6s"))(block(p).body),  # type: ignore[union-attr]
        ["-\t            #timer(IN := TRUE, PT := T#5s);", "+\t            #timer(IN := TRUE, PT := T#6s);"],
    ),
    "start value": (
        lambda p: set_to("initial", "3.5")(start_values(p, 0)[0]),
        ["-   amount := 2.5;", "+   amount := 3.5;"],
    ),
    "a start value more": (
        lambda p: set_to("initial", "7")(start_values(p, 0)[3]),
        ["+   counter := 7;"],
    ),
    "a member more": (
        lambda p: p.data_types[0].type.members.append(m.Variable(name="speed", type="INT")),  # type: ignore[union-attr]
        ["+      speed : Int;"],
    ),
    "name of a member": (
        lambda p: set_to("name", "ok")(p.data_types[0].type.members[1]),  # type: ignore[union-attr]
        [
            "-      feedback { ExternalWritable := 'False' } : Bool;",
            "+      ok { ExternalWritable := 'False' } : Bool;",
        ],
    ),
}


def test_an_edited_start_value_counts_instead_of_the_assignment_in_the_file() -> None:
    project = sfc.load(TIA)
    row = start_values(project, 1)[0]
    assert row.initial == m.ArrayValue(
        items=[m.RepeatedValue(value=m.SimpleValue(text=text)) for text in ("1", "2", "7", "0")]
    )
    row.initial = None
    data = sfc.dumps(project)
    assert sfc.loads(data) == project
    assert start_values(sfc.loads(data, as_tool=True), 1)[0].initial is None


@pytest.mark.slow
@pytest.mark.parametrize("what", EDITS)
def test_an_edit_changes_its_lines(what: str) -> None:
    edit, expected = EDITS[what]
    project = sfc.load(TIA)
    edit(project)
    assert diff(TIA, project) == expected


def test_blocks_go_and_come_with_the_empty_lines_between_them() -> None:
    project = sfc.load(TIA)
    gone = project.pous.pop(1)
    changed = diff(TIA, project)
    assert {line[0] for line in changed} == {"-"}
    assert len(changed) == 11
    project.pous.insert(1, gone)
    project.data_types.append(m.DataTypeDeclaration(name="more", type=m.StructType()))
    assert sorted(diff(TIA, project)) == sorted(["+", '+TYPE "more"', "+   Struct", "+   END_STRUCT;", "+END_TYPE"])


def test_the_code_page_stays_as_long_as_it_has_all_characters() -> None:
    project = sfc.load(CLASSIC)
    project.pou("FB10").comment = "Förderband für Gefäße"
    assert diff(CLASSIC, project) == ["-// Förderband für Gepäckstücke", "+// Förderband für Gefäße"]
    project.pou("FB10").comment = "Förderband → 行李"
    report = sfc.ConversionReport()
    data = sfc.dumps(project)
    assert data.startswith(b"\xef\xbb\xbf// F\xc3\xb6rderband \xe2\x86\x92")
    assert sfc.loads(data) == project
    assert report.losses == []


def test_a_chart_put_into_a_source_is_carried_in_comments() -> None:
    project = sfc.load(TIA)
    chart = m.SfcNetwork()
    one, other = chart.add_step("S1", initial=True), chart.add_step("S2")
    chart.add_transition(one, other, m.Expression(text="#start"))
    project.pous.append(m.Pou(name="Chart", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.SfcBody(chart=chart)]))
    data, report = sfc.convert(project, "scl", partial=True)
    assert sfc.loads(data) == project
    assert any(item.outcome is sfc.Outcome.NOT_EXECUTED and item.path.startswith("POU Chart") for item in report.items)
    old = TIA.read_bytes()
    assert data.startswith(old.rstrip())


def test_what_tia_portal_does_not_know_is_reported() -> None:
    interface = m.Interface(
        sections=[
            m.VariableSection(
                kind=m.SectionKind.GLOBAL,
                variables=[m.Variable(name="x", type=m.PointerType(base="INT")), m.Variable(name="y", type="INT")],
            )
        ]
    )
    project = m.Project(
        dialect=m.Dialect.SCL,
        pous=[m.Pou(name="a", kind=m.PouKind.FUNCTION_BLOCK, interface=interface, bodies=[m.StBody(text=";")])],
    )
    data, report = sfc.convert(project, "scl", partial=True)
    assert [(item.what, item.path) for item in report.losses] == [
        ("section", "POU a / VAR_GLOBAL"),
        ("type", "POU a / x"),
    ]
    assert sfc.loads(data, format="scl") == project


def test_external_variables_are_global_and_declared_in_no_block() -> None:
    text = "FUNCTION_BLOCK A\nVAR_EXTERNAL x : INT; END_VAR\nVAR_OUTPUT y : INT; END_VAR\ny := x;\nEND_FUNCTION_BLOCK"
    project = sfc.loads(text.encode(), format="iec-text")
    data = sfc.dumps(project, format="scl", partial=True)
    assert b'#y := "x";' in data
    assert b"\r\n   VAR_EXTERNAL" not in data
    back = sfc.loads(data)
    assert back.pous[0].interface == project.pous[0].interface
    assert b"y := x;" in sfc.dumps(back, format="codesys")


@pytest.mark.corpus
def test_one_edit_in_each_source_of_the_corpus() -> None:
    require_corpus()
    for path in corpus_sources():
        project = sfc.load(path)
        interface = project.pous[0].interface
        assert interface is not None
        for section in interface.sections:
            for variable in section.variables:
                variable.name += "_x"
        changed = diff(path, project)
        count = len(interface.variables())
        assert len(changed) == 2 * count, path
        names = [variable.name for variable in interface.variables()]
        assert all(name in line for name, line in zip(names, [c for c in changed if c[0] == "+"], strict=True))
