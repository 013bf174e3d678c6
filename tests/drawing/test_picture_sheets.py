"""Pictures on several sheets: nothing is lost, and every element is whole on one of them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.drawing.pictures import sheets
from plcopen_sfc.errors import ModelError

CONVEYOR = Path("fixtures/codesys/sorting_conveyor.xml")


Area = tuple[int, ...]


def window(root: etree._Element) -> Area:
    """The part of the picture that a sheet shows: left, top, width, height."""
    return tuple(map(int, root[-1].get("viewBox").split()))


def areas(root: etree._Element) -> list[Area]:
    return [tuple(map(int, each.get("data-area").split())) for each in root.iter() if each.get("data-area")]


def is_inside(area: Area, shown: Area) -> bool:
    """True if an element is shown with the lines on its edge, half of which are outside of it."""
    return all(shown[at] < area[at] and area[at] + area[at + 2] < shown[at] + shown[at + 2] for at in (0, 1))


def test_every_element_is_whole_on_a_sheet_of_the_size_of_the_paper(tmp_path: Path) -> None:
    project = sfc.load(CONVEYOR)
    whole = etree.fromstring(project.pou("PLC_PRG").chart.to_svg().encode())
    drawn = sfc.draw(project, f"{tmp_path}/", pou="PLC_PRG", paper="a4")
    assert [picture.path.name for picture in drawn] == [f"PLC_PRG-{number}.svg" for number in range(1, len(drawn) + 1)]
    roots = [etree.fromstring(picture.path.read_bytes()) for picture in drawn]
    assert len(roots) > 3
    assert {(root.get("width"), root.get("height")) for root in roots} in ({("794", "1123")}, {("1123", "794")})
    found = [area for root in roots for area in areas(root) if is_inside(area, window(root))]
    assert set(found) == set(areas(whole))
    assert all(areas(root) for root in roots)


def test_sheets_have_their_numbers_and_those_beside_them(tmp_path: Path) -> None:
    drawn = sfc.draw(sfc.load(CONVEYOR), f"{tmp_path}/", pou="PLC_PRG", paper="A4")
    texts = [etree.fromstring(picture.path.read_bytes()).xpath("*[local-name()='text']/text()") for picture in drawn]
    assert [text[0] for text in texts] == [f"PLC_PRG {number}/{len(drawn)}" for number in range(1, len(drawn) + 1)]
    leading = {
        (at, int(number)) for at, text in enumerate(texts, 1) for each in text[1:] for number in each[1:].split(",")
    }
    assert leading == {(number, at) for at, number in leading}
    assert {at for at, _ in leading} == set(range(1, len(drawn) + 1))


def test_a_wire_goes_on_where_the_sheet_before_ends(tmp_path: Path) -> None:
    drawn = sfc.draw(sfc.load(CONVEYOR), f"{tmp_path}/", pou="PLC_PRG", paper="A4")
    first, *others = (etree.fromstring(picture.path.read_bytes()) for picture in drawn)
    _, top, _, height = window(first)
    below = next(root for root in others if window(root)[1] > top)
    assert window(below)[1] <= top + height
    wires = [{each.get("d") for each in root.iter() if each.get("class") == "wire"} for root in (first, below)]
    assert wires[0] & wires[1]


def test_nothing_of_networks_is_left_out(tmp_path: Path) -> None:
    project = sfc.lower(sfc.load(CONVEYOR), "flipflop", pou="FB_Pusher", language="FBD", verify=False).project
    (whole,) = sfc.draw(project, tmp_path / "whole.svg", pou="FB_Pusher")
    drawn = sfc.draw(project, f"{tmp_path}/", pou="FB_Pusher", paper="A4")
    assert len(drawn) > 1
    head, shapes = "<(?:svg|title|style|/svg|rect class=.paper)", set(whole.path.read_text().splitlines())
    found = {line for picture in drawn for line in picture.path.read_text().splitlines()}
    assert {line for line in shapes - found if not re.match(head, line)} == set()
    assert any("<circle" in line for line in found)


def test_elements_of_a_long_chart_are_on_one_sheet_each(tmp_path: Path) -> None:
    chart = sfc.SfcNetwork()
    for number in range(40):
        chart.add_step(f"Step{number}", initial=not number)
    for number in range(40):
        chart.add_transition(f"Step{number}", f"Step{(number + 1) % 40}", "a AND b")
    project = sfc.Project(name="p", pous=[sfc.Pou(name="Main", kind="program", bodies=[sfc.SfcBody(chart=chart)])])
    drawn = sfc.draw(project, tmp_path / "main.svg", paper="A4")
    assert len(drawn) > 2
    roots = [etree.fromstring(picture.path.read_bytes()) for picture in drawn]
    found = [area for root in roots for area in areas(root)]
    assert sorted(found) == sorted(areas(etree.fromstring(chart.to_svg().encode())))
    assert all(is_inside(area, window(root)) for root in roots for area in areas(root))


def test_no_sheet_is_empty() -> None:
    chart = sfc.SfcNetwork()
    first = chart.add_step("S", initial=True)
    for branch in range(8):  # all short but for one, which is alone on the sheets below
        last = first
        for number in range(30 if branch == 6 else 1):
            last, before = chart.add_step(f"S{branch}_{number}"), last
            chart.add_transition(before, last, f"condition_{branch} AND another_{number}")
    drawn = [etree.fromstring(text.encode()) for text in sheets(chart.to_svg(), "A4")]
    assert len(drawn) > 3
    assert all(len(root[-1]) for root in drawn)
    assert window(drawn[0])[0] < 30
    assert all(window(root)[0] > 30 for root in drawn[-2:]), "sheets begin where something is drawn"
    texts = [root.xpath("*[local-name()='text']/text()")[1:] for root in drawn]
    beside = {(at, int(number)) for at, text in enumerate(texts, 1) for each in text for number in each[1:].split(",")}
    assert beside == {(number, at) for at, number in beside}


def test_a_small_chart_is_one_file_and_papers_have_names(tmp_path: Path) -> None:
    project = sfc.load(CONVEYOR)
    (drawn,) = sfc.draw(project, tmp_path / "pusher.svg", pou="FB_Pusher", paper="A4")
    assert drawn.path == tmp_path / "pusher.svg"
    assert ' width="1123" height="794" ' in drawn.path.read_text()
    with pytest.raises(ModelError, match="there is no paper 'A5'"):
        sfc.draw(project, tmp_path / "x.svg", pou="FB_Pusher", paper="A5")


def test_a_few_sheets_are_a_little_smaller_rather_than_one_more(tmp_path: Path) -> None:
    """A third sheet had nothing but the arrow of a jump."""
    chart = sfc.SfcNetwork()
    step = first = chart.add_step("S0", initial=True)
    for number in range(1, 12):
        after = chart.add_step(f"S{number}")
        chart.add_transition(step, after, "a")
        step = after
    chart.add_transition(step, first, "a")
    pou = sfc.Pou(name="P", kind=sfc.PouKind.PROGRAM, bodies=[sfc.SfcBody(chart=chart)])
    svg = chart.to_svg()
    height = int(etree.fromstring(svg.encode()).get("height"))
    assert 1.0 < height / (1123 - 76) < 1 / 0.85, "more than a sheet, and less than one at the smallest scale"
    (drawn,) = sfc.draw(sfc.Project(pous=[pou]), tmp_path / "p.svg", paper="A4")
    root = etree.fromstring(drawn.path.read_bytes())
    (shown,) = root.findall("{*}svg")
    assert (root.get("width"), root.get("height")) == ("794", "1123")
    assert float(shown.get("height")) <= 1123 - 76
    assert float(shown.get("height")) / float(shown.get("viewBox").split()[3]) >= 0.85
    assert len(areas(root)) == len(areas(etree.fromstring(svg.encode())))


def test_sheets_hold_whatever_names_and_comments_have_in_them() -> None:
    hostile = 'A\nB<g class="step">\r</g>\n<title>'
    chart = sfc.SfcNetwork()
    last = chart.add_step("S", initial=True)
    for number in range(40):
        following = chart.add_step(f"S{number}")
        following.comment = hostile
        chart.add_transition(last, following, hostile)
        last = following
    project = sfc.Project(pous=[sfc.Pou(name=hostile, kind=sfc.PouKind.PROGRAM, bodies=[sfc.SfcBody(chart=chart)])])
    assert project.pous[0].chart is chart
    drawn = [etree.fromstring(text.encode()) for text in sheets(chart.to_svg(), "A4")]
    assert len(drawn) > 3
    steps = {g.get("id") for root in drawn for g in root.iter("{*}g") if "step" in (g.get("class") or "").split()}
    assert steps == {f"step-{step.id}" for step in chart.steps}
    assert {root.findtext("{*}title") for root in drawn} == {hostile}


def test_no_sheet_has_the_frame_of_a_partial_chart_alone() -> None:
    steps = "\n".join(f"    STEP {n}\n    {n} -> {n + 1} : a" for n in range(2, 120))
    branches = "\n".join(f"    STEP {n}\n        n{n} := 1" for n in range(301, 306))
    text = "GRAFCET H\nCHART G1\n    INITIAL STEP 1\n    1 -> 2, 301, 302, 303, 304, 305 : a\n"
    text += f"{steps}\n    STEP 120\n{branches}\n"
    chart = sfc.loads(text.encode()).pou("H").chart
    drawn = [etree.fromstring(each.encode()) for each in sheets(chart.to_svg(), "A4")]
    assert len(drawn) > 5
    for root in drawn:
        assert [each.get("class") for each in root[-1]] != ["part"]
    assert sum("G1" in root.xpath("//*[local-name()='text']/text()") for root in drawn) > 0


def test_sheets_begin_with_the_chart_and_not_with_the_frame_around_it() -> None:
    """A chart that stood on the right of its frame was cut in the middle, beside empty paper."""
    steps = [f"    STEP {number}\n        q{number}\n    {number} -> {number + 1} : a\n" for number in range(2, 40)]
    back = [f"    40 -> {number} : a * x{number}_with_a_long_name_of_its_own\n" for number in range(1, 8)]
    text = "GRAFCET G\nINPUTS\n    a\nCHART G1\n    INITIAL STEP 1\n    1 -> 2 : a\n" + "".join(steps)
    text += "    STEP 40\n" + "".join(back) + "    40 -> 41 : a\n    STEP 41\n    41 -> 1 : a\n"
    roots = [etree.fromstring(svg) for svg in sheets(sfc.loads(text.encode()).pous[0].chart.to_svg(), "A4")]
    alone = [root for root in roots if [window(each)[1] for each in roots].count(window(root)[1]) == 1]
    assert alone
    for root in alone:
        shown = window(root)
        first = min(area[0] for area in areas(root) if is_inside(area, shown))
        assert first - shown[0] < 30
