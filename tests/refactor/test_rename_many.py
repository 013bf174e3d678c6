"""Renaming many things in one pass: exchanged names, patterns, and all or nothing."""

from __future__ import annotations

import difflib
import io

import pytest

import plcopen_sfc
from plcopen_sfc.errors import ModelError
from plcopen_sfc.languages.binding import Kind
from plcopen_sfc.refactor.rename import names_by_pattern
from tests.languages.binding.projects import pou, project, sfc
from tests.samples import FIXTURES

STATION = (FIXTURES / "plcopen" / "filling_station_2.01.xml").read_bytes()


def test_names_are_exchanged_in_every_body() -> None:
    main = sfc("Main", "S1 S2 S3", "S1.x AND S2.x (* S1 *)")
    other = pou("Other", "y := Main.S2.x OR Main.S1.x;")
    made = project(main, other)
    results = made.rename_many({"Main.S1": "S2", "Main.S2": "S1", "Main.S3": "S3"})
    assert main.sfc is not None
    assert [step.name for step in main.sfc.steps] == ["S2", "S1", "S3"]
    assert main.sfc.transitions[0].condition.text == "S2.x AND S1.x (* S1 *)"  # type: ignore[union-attr]
    assert other.body is not None
    assert other.body.text == "y := Main.S1.x OR Main.S2.x;"  # type: ignore[union-attr]
    assert [(r.path, r.old, r.new, len(r.changed)) for r in results] == [
        ("Main.S1", "S1", "S2", 2),
        ("Main.S2", "S2", "S1", 2),
        ("Main.S3", "S3", "S3", 0),
    ]


def test_names_are_passed_on() -> None:
    main = sfc("Main", "S1 S2 S3", "S1.x AND S2.x AND S3.x")
    project(main).rename_many({"Main.S1": "S2", "Main.S2": "S3", "Main.S3": "S4"})
    assert main.sfc is not None
    assert main.sfc.transitions[0].condition.text == "S2.x AND S3.x AND S4.x"  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ({"Main.S1": "Fill", "Main.S2": "fill"}, "gets this name too"),
        ({"Main.S1": "Fill", "Main.S2": "S3"}, "the step Main.S3 has this name already"),
        ({"Main.S1": "Fill", "Main.S3": "IF"}, "cannot be a name"),
        ({"Main.S1": "Fill", "main.s1": "Mix"}, "twice"),
        ({"Main.S1": "Fill", "Main.S9": "Mix"}, "declares no 'Main.S9'"),
        ({"Main.S1": "s1", "Main.S2": "S1"}, "gets this name too"),
        ({"Main.S1": "Fill", "Main.S2": "outside"}, "would mean|means"),
    ],
)
def test_one_refused_name_leaves_all_as_they_were(table: dict[str, str], reason: str) -> None:
    main = sfc("Main", "S1 S2 S3", "S1.x AND S2.x AND outside")
    made = project(main)
    before = made.model_dump()
    with pytest.raises(ModelError, match=reason):
        made.rename_many(table)
    assert made.model_dump() == before


def test_pattern_with_groups_names_all_things_of_a_kind() -> None:
    main = sfc("Main", "S1 S20 Wait", "S1.x AND S20.x", actions={"S3": ""})
    made = project(main, sfc("Other", "S1 S2"))
    made.rename_many(names_by_pattern(made, Kind.STEP, r"main\.S(\d+)", r"N\g<1>0"))
    assert main.sfc is not None
    assert [step.name for step in main.sfc.steps] == ["N10", "N200", "Wait"]
    assert [action.name for action in main.actions] == ["S3"]
    assert main.sfc.transitions[0].condition.text == "N10.x AND N200.x"  # type: ignore[union-attr]


def test_a_kind_may_be_given_as_its_word() -> None:
    """A word gave an empty table, and the batch told that nothing changed."""
    made = project(sfc("Main", "S1 S2"))
    assert [*names_by_pattern(made, "step", r"Main\.(S1)", r"N\1").values()] == ["NS1"]
    with pytest.raises(ModelError, match="'stp' is no kind of declaration"):
        names_by_pattern(made, "stp", r"Main\.(S1)", r"N\1")


@pytest.mark.parametrize(("pattern", "new"), [("S(", "N"), ("Main.(S1)", r"\2"), ("Main.(S1)", r"\g<no>")])
def test_wrong_pattern_is_an_error_of_ours(pattern: str, new: str) -> None:
    with pytest.raises(ModelError, match="no pattern"):
        names_by_pattern(project(sfc("Main", "S1 S2")), Kind.STEP, pattern, new)


def test_table_of_another_project_is_refused() -> None:
    one, two = (project(sfc("Main", "S1 S2", "S1.x")) for _ in range(2))
    before = two.model_dump()
    with pytest.raises(ModelError, match="does not declare the step"):
        one.rename_many(names_by_pattern(two, Kind.STEP, "Main.S1", "Fill"))
    assert two.model_dump() == before


def saved(made: plcopen_sfc.Project) -> bytes:
    target = io.BytesIO()
    plcopen_sfc.save(made, target, format="plcopen")
    return target.getvalue()


def test_file_differs_in_the_lines_of_the_names_and_comes_back() -> None:
    made = plcopen_sfc.loads(STATION)
    # a variable has the name of the step Fault: that could not be given back
    table = names_by_pattern(made, Kind.STEP, r".*\.((?!Fault)\w+)", r"Z_\1")
    assert len(table) > 2
    old = [declaration.name for declaration in table]
    made.rename_many(table)
    data = saved(made)
    loaded = names_by_pattern(plcopen_sfc.loads(data), Kind.STEP, r".*\.Z_.*", "x")
    assert [d.name for d in loaded] == [f"Z_{name}" for name in old]
    lines = [
        line
        for line in difflib.unified_diff(STATION.decode().splitlines(), data.decode().splitlines(), n=0, lineterm="")
        if line[0] in "+-" and line[:3] not in ("+++", "---")
    ]
    added = [line[1:] for line in lines if line[0] == "+"]
    assert len(added) == len(lines) / 2
    assert all("Z_" in line for line in added)
    assert [line.replace("Z_", "") for line in added] == [line[1:] for line in lines if line[0] == "-"]
    made.rename_many({declaration: declaration.name.removeprefix("Z_") for declaration in table})
    assert saved(made) == STATION


def test_tokens_of_tia_portal_exchange_their_names() -> None:
    file = FIXTURES / "simaticml" / "FB_Motor.xml"
    made = plcopen_sfc.load(file)
    names = [v.name for s in made.pous[0].interface.sections for v in s.variables][:2]  # type: ignore[union-attr]
    one, two = (f"{made.pous[0].name}.{name}" for name in names)
    before = plcopen_sfc.dumps(made, format="simaticml")
    made.rename_many({one: names[1], two: names[0]})
    assert plcopen_sfc.dumps(made, format="simaticml") != before
    made.rename_many({one: names[1], two: names[0]})
    assert plcopen_sfc.dumps(made, format="simaticml") == before == file.read_bytes()
