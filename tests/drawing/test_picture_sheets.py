"""Pictures on several sheets: nothing is lost, and elements are whole where there is a place between them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.errors import ModelError

CONVEYOR = Path("fixtures/codesys/sorting_conveyor.xml")


def windows(files: list[Path]) -> list[tuple[int, ...]]:
    """The part of the picture that each sheet shows: left, top, width, height."""
    roots = [etree.fromstring(file.read_bytes()) for file in files]
    return [tuple(map(int, root[-1].get("viewBox").split())) for root in roots]


def test_sheets_show_the_whole_picture_once(tmp_path: Path) -> None:
    project = sfc.load(CONVEYOR)
    whole = project.pou("PLC_PRG").chart.to_svg()
    width, height = map(int, re.findall(r'(?:width|height)="(\d+)"', whole)[:2])
    drawn = sfc.draw(project, f"{tmp_path}/", pou="PLC_PRG", paper="a4")
    assert [picture.path.name for picture in drawn] == [f"PLC_PRG-{number}.svg" for number in range(1, len(drawn) + 1)]
    assert len(drawn) > 3
    found = windows([picture.path for picture in drawn])
    assert sum(w * h for _, _, w, h in found) == width * height
    assert all(w <= 794 - 76 and h <= 1123 - 76 for _, _, w, h in found)


def test_elements_of_a_long_chart_are_on_one_sheet_each(tmp_path: Path) -> None:
    chart = sfc.SfcNetwork()
    for number in range(40):
        chart.add_step(f"Step{number}", initial=not number)
    for number in range(40):
        chart.add_transition(f"Step{number}", f"Step{(number + 1) % 40}", "a AND b")
    project = sfc.Project(name="p", pous=[sfc.Pou(name="Main", kind="program", bodies=[sfc.SfcBody(chart=chart)])])
    drawn = sfc.draw(project, tmp_path / "main.svg", paper="A4")
    assert len(drawn) > 2
    cuts = [top for _, top, _, _ in windows([picture.path for picture in drawn])][1:]
    areas = re.findall(r'data-area="-?\d+ (-?\d+) \d+ (\d+)"', chart.to_svg())
    divided = [cut for cut in cuts for top, high in areas if int(top) < cut < int(top) + int(high)]
    assert divided == []


def test_a_small_chart_is_one_file_and_papers_have_names(tmp_path: Path) -> None:
    project = sfc.load(CONVEYOR)
    (drawn,) = sfc.draw(project, tmp_path / "pusher.svg", pou="FB_Pusher", paper="A4")
    assert drawn.path == tmp_path / "pusher.svg"
    with pytest.raises(ModelError, match="there is no paper 'A5'"):
        sfc.draw(project, tmp_path / "x.svg", pou="FB_Pusher", paper="A5")
