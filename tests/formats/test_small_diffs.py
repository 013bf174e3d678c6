"""One edit changes the lines of what was edited, and no others."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Expression, IlBody, StBody
from tests.sweeps import some_of

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"
FILES = [
    path
    for pattern in ("iectext/*.st", "codesys23/*.EXP", "grafcet/*.gct", "scl/*.scl", "plcopen/*.xml", "codesys/*.xml")
    for path in sorted(FIXTURES.glob(pattern))
]
MOST_LINES = 8
"""Lines that an edit removes and adds: a declaration of several variables becomes several."""


def edits(project: sfc.Project) -> Iterator[Callable[[], None]]:
    """Edits of one word in each comment, time, target, condition and body of a project."""

    def put(thing: object, name: str, value: str) -> Callable[[], None]:
        return lambda: setattr(thing, name, value)

    for pou in project.pous:
        for each in (pou, *pou.variables(), *pou.actions, *pou.transitions):
            yield put(each, "comment", "New")
    for _, _, chart in project.charts():
        for step in chart.steps:
            yield put(step, "comment", "New")
            yield put(step, "max_time", "T#77s")
            for action in step.actions:
                yield put(action, "comment", "New")
                if action.target:
                    yield put(action, "target", "New")
        for transition in chart.transitions:
            yield put(transition, "comment", "New")
            if isinstance(transition.condition, Expression):
                yield put(transition.condition, "text", "New AND Newer")
    for _, _, body in project.bodies():
        if isinstance(body, StBody | IlBody) and ";" in body.text:
            yield put(body, "text", body.text.replace(";", " + 1;", 1))


def changed_lines(before: bytes, after: bytes) -> list[str]:
    """The lines that were removed or added."""
    texts = (data.decode("latin-1").splitlines() for data in (before, after))
    found = difflib.unified_diff(*texts, n=0, lineterm="")
    return [line for line in found if line[:1] in "+-" and line[:3] not in ("+++", "---")]


@pytest.mark.slow
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_one_edit_changes_few_lines(path: Path) -> None:
    data = path.read_bytes()
    count = sum(1 for _ in edits(sfc.loads(data)))
    sample = 4 if path.suffix == ".xml" else 12
    for number in some_of(range(count), 1 + count // sample):
        project = sfc.loads(data)
        list(edits(project))[number]()
        saved = BytesIO()
        report = sfc.save(project, saved)
        assert not [item for item in report.items if item.what == "file"]
        assert 1 <= len(changed_lines(data, saved.getvalue())) <= MOST_LINES


DECLARED = b"""FUNCTION_BLOCK F
VAR
	//one
	a : BOOL;
	(* two *)
	b : INT;
	c : bool; // three

	// four
	d : TON := (PT := T#1s);
END_VAR
a := TRUE;
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(("name", "gone"), [("a", ["-\t//one", "-\ta : BOOL;"]), ("c", ["-\tc : bool; // three"])])
def test_a_variable_is_removed_with_the_comment_above_it(name: str, gone: list[str]) -> None:
    """Comments above variables made every removal and addition lay out the whole section."""
    project = sfc.loads(DECLARED)
    section = project.pous[0].interface.sections[0]  # type: ignore[union-attr]
    section.variables = [each for each in section.variables if each.name != name]
    assert changed_lines(DECLARED, sfc.dumps(project)) == gone


@pytest.mark.parametrize("place", range(5))
def test_a_variable_is_added_beside_comments_above_others(place: int) -> None:
    project = sfc.loads(DECLARED)
    section = project.pous[0].interface.sections[0]  # type: ignore[union-attr]
    section.variables.insert(place, sfc.Variable(name="New", type="INT"))
    data = sfc.dumps(project)
    assert changed_lines(DECLARED, data) == ["+\tNew : INT;"]
    again = sfc.loads(data).pous[0].variables()
    assert [(each.name, each.comment) for each in again] == [(each.name, each.comment) for each in section.variables]


def test_a_rename_changes_the_lines_of_properties_that_have_the_name() -> None:
    """The whole block was written from the model: a property had no place in its text."""
    run = b"PROPERTY Run : BOOL\nGET\nRun := a;\nEND_GET\nEND_PROPERTY\n"
    data = DECLARED.replace(b"a := TRUE;", run + run.replace(b"Run", b"Two") + b"a := TRUE;")
    project = sfc.loads(data)
    assert project.rename("F.a", "Aus").undecided == ()
    added = [line for line in changed_lines(data, sfc.dumps(project)) if line.startswith("+")]
    assert added == ["+\tAus : BOOL;", "+Run := Aus;", "+Two := Aus;", "+Aus := TRUE;"]


MIXING_PLANT = (FIXTURES / "iectext" / "mixing_plant.st").read_bytes()


def test_a_body_that_ends_in_a_comment_is_edited_in_its_line() -> None:
    project = sfc.loads(MIXING_PLANT)
    body = project.pou("Blinker").bodies[0]
    assert isinstance(body, StBody)
    assert body.text.endswith("// half of the time")
    body.text = body.text.replace("Lamp := Pulse.Q;", "Lamp := NOT Pulse.Q;")
    assert changed_lines(MIXING_PLANT, sfc.dumps(project)) == [
        "-  Lamp := Pulse.Q; // half of the time",
        "+  Lamp := NOT Pulse.Q; // half of the time",
    ]


def test_a_comment_of_one_of_two_variables_in_a_declaration_is_not_one_of_both() -> None:
    project = sfc.loads(MIXING_PLANT)
    variable = next(each for each in project.pou("Blinker").variables() if each.name == "Pause")
    variable.comment = "off"
    assert changed_lines(MIXING_PLANT, sfc.dumps(project)) == [
        "-    Pulse, Pause : TON;",
        "+    Pulse : TON;",
        "+    Pause : TON; (* off *)",
    ]


@pytest.mark.parametrize("damage", [b' localId="1"', b""])
def test_an_edit_stays_small_where_elements_have_no_id_of_their_own(damage: bytes) -> None:
    """Their neighbours tell which of several alike was edited; they were left out, and the whole file was written."""
    content = (FIXTURES / "plcopen" / "filling_station_2.01.xml").read_bytes()
    content = re.sub(rb'(?<=<transition) localId="\d+"', damage, content)
    count = len(next(sfc.loads(content).charts()).chart.transitions)
    for number in range(0, count, 3):
        project = sfc.loads(content)
        next(project.charts()).chart.transitions[number].comment = "New"
        data = sfc.dumps(project)
        assert len(changed_lines(content, data)) <= MOST_LINES
        again = next(sfc.loads(data).charts()).chart.transitions
        assert [number for number, each in enumerate(again) if each.comment == "New"] == [number]


LISTED = """VAR
\tc, d : REAL; (* both *)
\tf   :   INT := 3;   (* far *)
\tg, h :
\t\tINT;
\tq : INT;
END_VAR"""
EDITS_OF_LISTS: dict[str, tuple[Callable[[sfc.Project, list[sfc.Variable]], object], list[str]]] = {
    "comment of the first": (
        lambda _, found: setattr(found[0], "comment", "New"),
        ["-c, d : REAL; (* both *)", "+c : REAL; (* New *)", "+d : REAL; (* both *)"],
    ),
    "comment of the last": (
        lambda _, found: setattr(found[1], "comment", "New"),
        ["-c, d : REAL; (* both *)", "+c : REAL; (* both *)", "+d : REAL; (* New *)"],
    ),
    "type": (
        lambda _, found: setattr(found[1], "type", found[2].type),
        ["-c, d : REAL; (* both *)", "+c : REAL; (* both *)", "+d : INT; (* both *)"],
    ),
    "type in two lines": (
        lambda _, found: setattr(found[3], "type", found[0].type),
        ["-g, h :", "-INT;", "+g : REAL;", "+h : INT;"],
    ),
    "removal of the first": (lambda _, found: found.pop(0), ["-c, d : REAL; (* both *)", "+d : REAL; (* both *)"]),
    "removal of the last": (lambda _, found: found.pop(1), ["-c, d : REAL; (* both *)", "+c : REAL; (* both *)"]),
    "removal of both": (lambda _, found: (found.pop(0), found.pop(0)), ["-c, d : REAL; (* both *)"]),
    "one between them": (
        lambda _, found: found.insert(1, sfc.Variable(name="New", type="INT")),
        ["-c, d : REAL; (* both *)", "+c : REAL; (* both *)", "+New : INT;", "+d : REAL; (* both *)"],
    ),
    "one behind them": (lambda _, found: found.insert(2, sfc.Variable(name="New", type="INT")), ["+New : INT;"]),
    "rename": (
        lambda project, _: project.rename("F.d", "New"),
        ["-c, d : REAL; (* both *)", "+c, New : REAL; (* both *)"],
    ),
    "rename of both": (
        lambda project, _: project.rename_many({"F.c": "x", "F.d": "y"}),
        ["-c, d : REAL; (* both *)", "+x, y : REAL; (* both *)"],
    ),
    "rename in two lines": (lambda project, _: project.rename("F.g", "New"), ["-g, h :", "+New, h :"]),
}


@pytest.mark.parametrize("edit", EDITS_OF_LISTS)
@pytest.mark.parametrize("kind", ["iec-text", "twincat", "codesys-export", "codesys23", "scl"])
def test_an_edit_of_one_variable_of_a_list_leaves_the_other_declarations(kind: str, edit: str) -> None:
    """Files of TwinCAT and CODESYS got the whole declaration of the block laid out anew, or all of its section."""
    text = b"FUNCTION_BLOCK F\nVAR q : INT; END_VAR\nq := 1;\nEND_FUNCTION_BLOCK\n"
    whole = re.sub(rb"(?s)VAR\b.*?END_VAR", LISTED.encode(), sfc.dumps(sfc.loads(text), format=kind, partial=True))
    change, expected = EDITS_OF_LISTS[edit]
    project = sfc.loads(whole)
    assert [each.name for each in project.pous[0].variables()] == ["c", "d", "f", "g", "h", "q"]
    change(project, project.pous[0].interface.sections[0].variables)  # type: ignore[union-attr]
    found = changed_lines(whole, sfc.dumps(project))
    plain = [line[0] + re.sub(r"// (\w+)", r"(* \1 *)", line[1:].strip()) for line in found]
    assert [line.casefold() for line in plain] == [line.casefold() for line in expected]
