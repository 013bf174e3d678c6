"""Findings point at the line of the object that they are about, in every format that has lines."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Project
from tests.corpus import ROOT

FIXTURES = ROOT / "fixtures"
FILES = [
    "plcopen/filling_station_2.01.xml",
    "codesys/sorting_conveyor.xml",
    "twincat/press_station.xml",
    "simaticml/FB_Drill.xml",
    "iectext/mixing_plant.st",
    "iectext/distribution_belt.st",
]


def damaged(project: Project) -> list[tuple[str, str]]:
    """Give every step a minimum time above its maximum; the paths of the steps, and their names."""
    found: list[tuple[str, str]] = []
    for pou in project.pous:
        for name, chart in [
            ("", pou.sfc),
            *((f" / action {a.name}", getattr(a.body, "chart", None)) for a in pou.actions),
        ]:
            for step in chart.steps if chart is not None else ():
                if step.exclude:
                    continue
                step.min_time, step.max_time = "T#9d", "T#8d"
                found.append((f"POU {pou.name}{name} / step {step.name}", step.name))
    return found


@pytest.mark.parametrize("file", FILES)
def test_of_every_step(file: str) -> None:
    path = FIXTURES / file
    project = sfc.load(path)
    lines = path.read_bytes().decode("utf-8-sig").splitlines()
    expected = damaged(project)
    assert expected
    found = {finding.location.path: finding.location for finding in sfc.check(project, select=["TIM01"])}
    for place, name in expected:
        location = found[place]
        assert location.file == str(path)
        assert location.line is not None
        line = lines[location.line - 1]
        assert name in line, (place, line)
        assert "step" in line.casefold()


@pytest.mark.parametrize("file", ["simaticml/FB_Drill.xml", "iectext/mixing_plant.st"])
def test_of_transitions(file: str) -> None:
    path = FIXTURES / file
    project = sfc.load(path)
    for _, _, chart in project.charts():
        for transition in chart.transitions:
            transition.condition = None
    lines = path.read_bytes().decode("utf-8-sig").splitlines()
    found = sfc.check(project, select=["CND01"])
    assert found
    for finding in found:
        assert finding.location.line is not None
        assert "transition" in lines[finding.location.line - 1].casefold()


def test_in_a_folder_they_are_in_the_document(tmp_path: Path) -> None:
    folder = tmp_path / "blocks"
    shutil.copytree(FIXTURES / "simaticml", folder)
    project = sfc.load(folder)
    damaged(project)
    found = sfc.check(project, select=["TIM01"])
    assert found
    assert {finding.location.file for finding in found} == {str(folder / "FB_Drill.xml")}
    assert all(finding.location.line for finding in found)


def test_a_project_that_was_made_has_no_file() -> None:
    project = sfc.load(FIXTURES / FILES[0])
    made = Project.model_validate(project.model_dump())
    damaged(made)
    found = sfc.check(made, select=["TIM01"])
    assert found
    assert {(finding.location.file, finding.location.line) for finding in found} == {(None, None)}


def test_what_was_added_after_loading_has_the_line_of_what_is_around_it() -> None:
    path = FIXTURES / FILES[0]
    project = sfc.load(path)
    pou = next(pou for pou in project.pous if pou.sfc is not None)
    assert pou.sfc is not None
    pou.sfc.add_step("Added")
    [finding] = [f for f in sfc.check(project, select=["STR06"]) if "Added" in str(f.location.path)]
    assert finding.location.line is not None
    assert pou.name in path.read_text(encoding="utf-8").splitlines()[finding.location.line - 1]


PLAN = """GRAFCET Plan
INPUTS
    a
OUTPUTS
    Q1
CHART G1
    INITIAL STEP 1
        Q1 IF b1
        ON EVENT ↑b2 : Q1 := X97
        FORCE G9{INIT}
        { Q1 := b4; }
    1 -> 2 : a * b5
    STEP 2
    2 -> 1 : /X98
"""


def test_of_variables_of_a_grafcet(tmp_path: Path) -> None:
    path = tmp_path / "plan.gct"
    path.write_text(PLAN.replace("OUTPUTS", "    While\nOUTPUTS\n    V : BOOOL\n    G1"), encoding="utf-8")
    found = sfc.check(sfc.load(path), select=["VAR01", "VAR06"])
    at = {finding.message.split("'")[1]: finding.location.line for finding in found}
    assert (at["While"], at["BOOOL"]) == (4, 6)
    assert sfc.load(path).locations_of(["POU Plan / G1"])[0].line == 9  # the chart: it has no other path


def test_of_actions_of_a_grafcet(tmp_path: Path) -> None:
    path = tmp_path / "plan.gct"
    path.write_text(PLAN, encoding="utf-8")
    found = sfc.check(sfc.load(path), select=["VAR01", "HIE04", "ACT02"])
    at = {finding.message.split("'")[1] if "'" in finding.message else "Q1": finding.location for finding in found}
    lines = PLAN.splitlines()
    for name in ("b1", "b2", "X97", "G9", "b4", "b5", "X98"):
        assert name in lines[(at[name].line or 0) - 1], name
    assert "ON EVENT" in lines[(at["Q1"].line or 0) - 1]  # of two actions on one variable
    assert str(at["G9"].path).endswith("step 1 / action G9{INIT}")
