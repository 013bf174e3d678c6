"""The declaration as text stays as long as it says what is declared."""

from __future__ import annotations

import io
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc.report import Outcome

PRESS = Path(__file__).parents[3] / "fixtures" / "twincat" / "press_station.xml"


def saved(project: sfc.Project) -> tuple[sfc.Project, sfc.ConversionReport]:
    target = io.BytesIO()
    report = sfc.save(project, target)
    return sfc.loads(target.getvalue()), report


def test_an_edit_elsewhere_keeps_the_text() -> None:
    project = sfc.load(PRESS)
    pou = project.pou("MAIN")
    assert pou.interface is not None
    text = pou.interface.declaration
    assert text
    chart = pou.sfc
    assert chart is not None
    chart.steps[0].comment = "waits for a part"
    back, report = saved(project)
    interface = back.pou("MAIN").interface
    assert interface is not None
    assert interface.declaration == text
    assert report.losses == []


def test_an_edit_of_the_declaration_drops_the_text_and_says_so() -> None:
    project = sfc.load(PRESS)
    interface = project.pou("MAIN").interface
    assert interface is not None
    interface.variables()[0].name = "Drive"
    back, report = saved(project)
    found = back.pou("MAIN").interface
    assert found is not None
    assert found.declaration is None
    assert found.variables()[0].name == "Drive"
    [item] = report.with_outcome(Outcome.APPROXIMATED)
    assert (item.what, item.path) == ("declaration text", "POU MAIN")
    others = [pou.interface for pou in back.pous if pou.name != "MAIN" and pou.interface is not None]
    assert all(other.declaration for other in others)


def test_a_new_text_is_kept_with_the_edit() -> None:
    project = sfc.load(PRESS)
    interface = project.pou("MAIN").interface
    assert interface is not None
    interface.variables()[0].name = "Drive"
    interface.declaration = "PROGRAM MAIN VAR Drive : FB_Motor; END_VAR"
    back, report = saved(project)
    found = back.pou("MAIN").interface
    assert found is not None
    assert found.declaration == interface.declaration
    assert report.losses == []
