"""Step lists merged back: nothing changes without an edit, and an edit changes its lines only."""

from __future__ import annotations

import csv
import difflib
import io
import re
from collections.abc import Callable
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import ArgumentError, ModelError
from plcopen_sfc.model import Project

FILES = [
    "codesys/sorting_conveyor.xml",
    "codesys23/distribution_belt.EXP",
    "grafcet/four_steps.gct",
    "iectext/mixing_plant.st",
    "plcopen/every_element_1.01.xml",
    "plcopen/filling_station_2.01.xml",
    "simaticml/FB_Drill.xml",
    "simaticml-training-chain/Ablauf.xml",
    "training-chain/codesys.xml",
    "twincat/press_station.xml",
]
WITHOUT_VARIABLES = {"grafcet/four_steps.gct"}


def loaded(name: str) -> Project:
    project = sfc.load(Path("fixtures", name))
    project.accept_errors()
    return project


def list_of(project: Project) -> Project:
    return sfc.loads(sfc.dumps(project, format="csv", partial=True, fresh=True))


def edited(listed: Project) -> Project:
    """The list as it is read again after an edit of its model."""
    return sfc.loads(sfc.dumps(listed, format="csv", fresh=True))


def new_lines(project: Project, name: str) -> list[str]:
    before = Path("fixtures", name).read_text(encoding="utf-8").splitlines()
    lines = difflib.unified_diff(before, sfc.dumps(project).decode("utf-8").splitlines(), n=0, lineterm="")
    return [line for line in lines if line.startswith("+") and not line.startswith("+++")]


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("form", ["csv", "xlsx"])
def test_a_list_without_edits_changes_nothing(name: str, form: str) -> None:
    project = loaded(name)
    listed = sfc.loads(sfc.dumps(project, format=form, partial=True))
    assert sfc.merge_list(project, listed) == []
    assert sfc.dumps(project) == Path("fixtures", name).read_bytes()


@pytest.mark.parametrize("form", ["simaticml", "codesys", "plcopen-2.01"])
def test_a_list_without_edits_changes_nothing_in_a_file_made_of_a_list(form: str) -> None:
    """A program without variables got an interface of its own, so that a line of TIA Portal was written anew."""
    table = "Step;Action;Condition;Next\nIdle;Lamp;Weight > 5;Run\nRun;;Weight <= 5;Idle\n\n"
    table += "Variable;Type;Address\nLamp;BOOL;A4.1\nWeight;INT;EW64\n"
    data = sfc.dumps(sfc.loads(table.encode(), format="csv"), format=form)
    project = sfc.loads(data)
    listed = sfc.loads(sfc.dumps(project, format="csv", partial=True, fresh=True))
    assert sfc.merge_list(project, listed) == []
    assert sfc.dumps(project) == data


@pytest.mark.parametrize("name", FILES)
def test_edits_of_a_chart_are_in_the_file_and_in_its_list(name: str) -> None:
    project = loaded(name)
    listed = list_of(project)
    pou = next(each for each in listed.pous if each.chart is not None and len(each.chart.steps) > 2)
    chart = pou.chart
    assert chart is not None
    first, second, last = chart.steps[0], chart.steps[1], chart.steps[-1]
    second.comment = "merged"
    left = next(t for t in chart.transitions if first.id in t.sources)
    targets, left.targets = left.targets, [chart.add_step("Between9").id]
    chart.add_transition("Between9", [step for step in chart.steps if step.id in targets], "TRUE")
    last.actions = last.actions[:-1]
    wanted = edited(listed)
    changes = sfc.merge_list(project, wanted)
    assert [change.rpartition(": ")[2] for change in changes if "Between9" in change][:1] == ["new"]
    again = sfc.loads(sfc.dumps(project))
    again.accept_errors()
    assert sfc.merge_list(again, wanted) == []
    names = [step.name for step in (again.pou(pou.name).chart or chart).steps]
    assert len(names) == len(chart.steps)


EDITS: dict[str, tuple[Callable[[Project], object], list[str]]] = {
    "condition": (
        lambda p: setattr(p.pou("PLC_PRG").sfc.transition("Init -> Homing"), "condition", "S1_Start"),  # type: ignore[union-attr]
        ["POU PLC_PRG / transition Init -> Homing: condition"],
    ),
    "comment": (
        lambda p: setattr(p.pou("FB_Pusher").sfc.steps[1], "comment", "waits"),  # type: ignore[union-attr]
        ["POU FB_Pusher / step Extending: comment"],
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_changes_its_lines_only(edit: str) -> None:
    project = loaded("codesys/sorting_conveyor.xml")
    listed = list_of(project)
    change, words = EDITS[edit]
    change(listed)
    assert sfc.merge_list(project, edited(listed)) == words
    assert 1 <= len(new_lines(project, "codesys/sorting_conveyor.xml")) <= 5


def test_a_step_with_the_number_of_one_that_is_gone_is_renamed_everywhere() -> None:
    project = loaded("simaticml-training-chain/Ablauf.xml")
    text = sfc.dumps(project, format="csv", partial=True, fresh=True).decode("utf-8-sig")
    text = text.replace(";S2;", ";Mischen;")  # the step, and where it is next
    assert sfc.merge_list(project, sfc.loads(text.encode())) == ["POU Ablauf / step S2: renamed to Mischen"]
    assert project.pou("Ablauf").sfc.step("Mischen").number == 2  # type: ignore[union-attr]


PARTLY = """
PROGRAM Main
VAR x, y, z : BOOL; END_VAR
INITIAL_STEP A: END_STEP STEP B: END_STEP STEP C: END_STEP
TRANSITION FROM A TO B := x; END_TRANSITION
TRANSITION (PRIORITY := 7) FROM A TO C := y; END_TRANSITION
TRANSITION FROM (A, B) TO C := z; END_TRANSITION
TRANSITION FROM B TO A := x; END_TRANSITION
TRANSITION FROM C TO A := x; END_TRANSITION
END_PROGRAM
"""


def test_priorities_in_part_are_whole_in_a_list() -> None:
    project = sfc.loads(PARTLY.encode())
    listed = list_of(project)
    chart, shown = project.pous[0].sfc, listed.pous[0].sfc
    assert chart is not None
    assert shown is not None
    order = [transition.condition for transition in chart.outgoing(chart.step("A"))]
    assert {shown.label(t): t.priority for t in shown.transitions} == {
        "A -> B": 8,
        "A -> C": 7,
        "A+B -> C": 9,
        "B -> A": 10,
        "C -> A": None,
    }
    assert [transition.condition for transition in shown.outgoing(shown.step("A"))] == order
    assert sfc.merge_list(project, listed) == []
    shown.transition("A+B -> C").priority = 1
    changes = sfc.merge_list(project, edited(listed))
    assert {each.rpartition(": ")[2] for each in changes} == {"priority"}
    assert (
        [t.condition for t in chart.outgoing(chart.step("A"))]
        == [t.condition for t in shown.outgoing(shown.step("A"))]
        != order
    )


def test_variables_and_actions_follow_their_tables() -> None:
    project = loaded("training-chain/codesys.xml")
    own = project.pous[0].interface
    assert own is not None
    own.sections[0].variables.append(own.sections[0].variables[0].model_copy(update={"name": "Spare"}))
    listed = list_of(project)
    pou = listed.pous[0]
    assert pou.interface is not None
    section = pou.interface.sections[0]
    section.variables[0].comment = "first"
    gone = section.variables.pop()
    section.variables.append(section.variables[0].model_copy(update={"name": "Added9"}))
    changes = sfc.merge_list(project, edited(listed))
    assert sorted(change.partition(" / variable ")[2] for change in changes) == sorted(
        [f"{section.variables[0].name}: comment", "Added9: new", f"{gone.name}: removed"]
    )
    names = [each.name for each in sfc.loads(sfc.dumps(project)).pous[0].variables()]
    assert "Added9" in names
    assert gone.name not in names


NAMING = """PROGRAM Main
VAR a : BOOL; b : BOOL; c : BOOL; END_VAR
INITIAL_STEP S1: Work(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
STEP S2: c(N); END_STEP
TRANSITION FROM S2 TO S1 := b OR S1.t > T#1s; END_TRANSITION
ACTION Work: b := FALSE; END_ACTION
END_PROGRAM
"""


@pytest.mark.parametrize(
    ("kind", "name", "why"),
    [
        ("variable", "a", "a has no row any more, and Main"),
        ("variable", "b", "b has no row any more, and Main"),
        ("variable", "c", "c has no row any more, and Main"),
        ("action", "Work", "Work has no row any more, and Main"),
    ],
)
def test_what_something_still_names_is_not_removed(kind: str, name: str, why: str) -> None:
    project = sfc.loads(NAMING.encode(), format="iec-text")
    listed = list_of(project)
    (pou,) = listed.pous
    if kind == "variable":
        assert pou.interface is not None
        for section in pou.interface.sections:
            section.variables = [each for each in section.variables if each.name != name]
    else:
        pou.actions = [each for each in pou.actions if each.name != name]
    with pytest.raises(ModelError, match=re.escape(why)):
        sfc.merge_list(project, edited(listed))
    assert sfc.dumps(project).decode() == NAMING


def test_what_is_removed_with_all_that_names_it_is_gone() -> None:
    project = sfc.loads(NAMING.encode(), format="iec-text")
    listed = list_of(project)
    (pou,) = listed.pous
    assert pou.interface is not None
    assert pou.chart is not None
    pou.interface.sections[0].variables = [each for each in pou.interface.sections[0].variables if each.name != "a"]
    pou.chart.transitions[0].condition = "TRUE"
    changes = sfc.merge_list(project, edited(listed))
    assert "POU Main / variable a: removed" in changes


COMPETING = """PROGRAM Main
VAR a, b, c, d : BOOL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a; END_TRANSITION
TRANSITION FROM S1 TO S0 := c; END_TRANSITION
TRANSITION FROM S0 TO S2 := b; END_TRANSITION
STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S2 TO S0 := d; END_TRANSITION
END_PROGRAM
"""


@pytest.mark.parametrize("target", ["iec-text", "codesys", "plcopen"])
@pytest.mark.parametrize(
    ("rows", "order"),
    [
        (["b;S2", "a;S1"], ["b", "a"]),
        (["c;S2", "a;S1", "b;S2"], ["c", "a", "b"]),
        (["b;S2", "c;S1", "a;S1"], ["b", "c", "a"]),
    ],
)
def test_the_order_of_rows_is_that_of_competing_transitions(target: str, rows: list[str], order: list[str]) -> None:
    """Two conditions that were exchanged with their next steps changed nothing, without a word."""
    project = sfc.loads(sfc.convert(sfc.loads(COMPETING.encode()), target).data)
    table = "\n".join(["Step;Condition;Next", f"S0;{rows[0]}", *(f";{row}" for row in rows[1:]), "S1;c;S0", "S2;d;S0"])
    listed = sfc.loads(table.encode())
    assert "POU Main / step S0: order of transitions" in sfc.merge_list(project, listed) or len(rows) > 2
    chart = sfc.loads(sfc.dumps(project)).pou("Main").chart
    assert chart is not None
    found = chart.outgoing(chart.step("S0"))
    assert [getattr(each.condition, "text", None) for each in found] == order
    assert sfc.merge_list(project, listed) == []


@pytest.mark.slow
def test_columns_and_tables_that_a_list_does_not_have_change_nothing() -> None:
    project = loaded("codesys/sorting_conveyor.xml")
    listed = list_of(project)
    lines = ["Program;Step;Condition;Next;Simultaneous"]
    for pou in listed.pous:
        chart = pou.chart
        assert chart is not None
        kind = "FUNCTION_BLOCK " if pou.kind == "functionBlock" else ""
        for step in chart.steps:
            rows = [t for t in chart.transitions if t.sources[0] == step.id]
            waits = [t for t in chart.transitions if step.id in t.sources[1:]]
            names = {each.id: each.name for each in chart.steps}
            texts = [
                f"{getattr(t.condition, 'text', '')};{','.join(names[each] for each in t.targets)};"
                + (f"g{t.id}" if len(t.sources) > 1 else "")
                for t in rows
            ] + [f";;g{t.id}" for t in waits]
            for at, text in enumerate(texts or [";;"]):
                lines.append(f"{kind}{pou.name};{'' if at else step.name};{text}")
    assert sfc.merge_list(project, sfc.loads("\n".join(lines).encode())) == []
    assert sfc.dumps(project) == Path("fixtures/codesys/sorting_conveyor.xml").read_bytes()


def test_a_list_with_errors_and_what_is_no_list_are_refused() -> None:
    project = loaded("training-chain/codesys.xml")
    with pytest.raises(sfc.DamagedSourceError):
        sfc.merge_list(project, sfc.load("fixtures/steplist/wrong_cells.csv"))
    with pytest.raises(ArgumentError):
        sfc.merge_list(project, loaded("training-chain/codesys.xml"))


def with_cells(data: bytes, column: str, wanted: Callable[[dict[str, str]], bool], value: str) -> Project:
    """Return a list with another text in one cell: that of the first row that is wanted."""
    rows = list(csv.reader(io.StringIO(data.decode("utf-8-sig")), delimiter=";"))
    head: list[str] = []
    for row in rows:
        head = [] if not any(row) else head or row
        if column in head and row is not head and wanted(dict(zip(head, row, strict=True))):
            row[head.index(column)] = value
            break
    text = io.StringIO()
    csv.writer(text, delimiter=";").writerows(rows)
    return sfc.loads(text.getvalue().encode())


SECTIONS = {"VAR": "VAR_INPUT", "VAR_INPUT": "VAR_OUTPUT", "VAR_OUTPUT": "VAR"}


@pytest.mark.parametrize("name", [each for each in FILES if each not in WITHOUT_VARIABLES])
def test_a_section_that_was_edited_is_that_of_the_variable(name: str) -> None:
    """It was told that "the list changes nothing", and the file was not written."""
    project = loaded(name)
    data = sfc.dumps(project, format="csv", partial=True, fresh=True)
    found: dict[str, str] = {}

    def is_wanted(cells: dict[str, str]) -> bool:
        if not found and cells["Section"] in SECTIONS and not cells["Address"]:
            found.update(cells)
        return cells == found

    with_cells(data, "Section", is_wanted, "")
    wanted = SECTIONS[found["Section"]]
    listed = with_cells(data, "Section", is_wanted, wanted)
    (change,) = sfc.merge_list(project, listed)
    assert change.endswith(f"/ variable {found['Variable']}: section")
    again = sfc.loads(sfc.dumps(project))
    again.accept_errors()
    lines = sfc.dumps(again, format="csv", partial=True, fresh=True).decode().splitlines()
    program, variable = found["Program"], found["Variable"]
    assert next(line for line in lines if line.startswith(f"{program};{variable};")).split(";")[2] == wanted
    assert len(lines) == len(data.decode().splitlines())


@pytest.mark.parametrize(
    ("name", "variable"),
    [("codesys23/distribution_belt.EXP", "Band_Rechts"), ("codesys/sorting_conveyor.xml", "Y3_Blower")],
)
@pytest.mark.parametrize("whole", [False, True])
def test_a_list_of_global_variables_becomes_no_program(name: str, variable: str, whole: bool) -> None:
    """One cell moved it and the rows below into a new PROGRAM, and what named them was not told."""
    project = loaded(name)
    data = sfc.dumps(project, format="csv", partial=True, fresh=True)
    before = sfc.dumps(project)
    listed = with_cells(data, "Section", lambda cells: cells["Variable"] == variable, "VAR")
    if whole:
        program = next(line for line in data.decode().splitlines() if f";{variable};" in line).partition(";")[0]
        listed = sfc.loads(re.sub(rf"(?m)^({program};[^;]*;)VAR_GLOBAL", r"\1VAR", data.decode()).encode())
    with pytest.raises(ModelError if whole else sfc.DamagedSourceError, match=r"no VAR|program with steps|with steps"):
        sfc.merge_list(project, listed)
    assert sfc.dumps(project) == before
