"""A rename reads the charts that mention the name, and no others."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from benchmarks.generate import generate
from plcopen_sfc.model import SfcBody


def test_charts_that_do_not_mention_a_name_stay_unread(tmp_path: Path) -> None:
    generate(tmp_path / "many.xml", megabytes=0.6, steps=8)
    project = sfc.load(tmp_path / "many.xml")
    assert len(project.pous) > 2
    chart = project.pous[1].chart
    assert chart is not None
    chart.rename_step(chart.steps[3].name, "OnlyHere")
    sfc.save(project, tmp_path / "many.xml")
    project = sfc.load(tmp_path / "many.xml")
    project.rename(f"{project.pous[1].name}.OnlyHere", "Again")
    sfc.save(project, tmp_path / "many.xml")
    assert [not body.chart.is_unread for pou in project.pous for body in pou.bodies if isinstance(body, SfcBody)] == [
        at == 1 for at in range(len(project.pous))
    ]
    content = (tmp_path / "many.xml").read_bytes()
    assert b"OnlyHere" not in content
    assert (
        sum(step.name == "Again" for each in sfc.load(tmp_path / "many.xml").charts() for step in each.chart.steps) == 1
    )


def _program(name: str, text: str, step: str = "Init") -> str:
    """A POU in TC6 with one step, an action, and a condition with a text."""
    return (
        f'<pou name="{name}" pouType="program"><interface/><actions><action name="Act"><body><ST><xhtml:p>x := 1;'
        f'</xhtml:p></ST></body></action></actions><body><SFC><step localId="1" name="{step}" initialStep="true">'
        f'<position x="0" y="0"/></step><transition localId="2"><position x="0" y="9"/><connectionPointIn>'
        f'<connection refLocalId="1"/></connectionPointIn><condition><inline name=""><ST><xhtml:p>{text}</xhtml:p>'
        f"</ST></inline></condition></transition></SFC></body></pou>"
    )


def _file(*pous: str) -> bytes:
    return (
        '<project xmlns="http://www.plcopen.org/xml/tc6_0201" xmlns:xhtml="http://www.w3.org/1999/xhtml"><fileHeader '
        'companyName="" productName="" productVersion="" creationDateTime="2026-01-05T08:00:00"/><contentHeader '
        'name="a"><coordinateInfo><fbd><scaling x="0" y="0"/></fbd><ld><scaling x="0" y="0"/></ld><sfc><scaling x="0" '
        'y="0"/></sfc></coordinateInfo></contentHeader><types><dataTypes/><pous>\n'
        + "\n".join(pous)
        + "\n</pous></types><instances><configurations/></instances></project>\n"
    ).encode()


@pytest.mark.parametrize(
    ("text", "is_use"),
    [
        ("Init", False),
        ("Other.X", False),
        ("Main.Init.X", True),
        ("Main . (* the first *)\n Init.X", True),
        ("Main.\nInit.X", True),
    ],
)
@pytest.mark.parametrize("read", [False, True])
def test_a_step_is_looked_for_in_charts_that_name_it_behind_a_dot(text: str, is_use: bool, read: bool) -> None:
    project = sfc.loads(_file(_program("Main", "TRUE"), _program("Other", text)))
    if read:
        project.read_all()
    others = [body.chart for body in project.pous[1].bodies if isinstance(body, SfcBody)]
    result = project.rename("Main.Init", "Start")
    assert others[0].is_unread is (not read and not is_use)
    assert len(result.changed) == is_use
    data = sfc.dumps(project)
    assert data.count(b'name="Init"') == 1
    assert (text.replace("Init", "Start") if is_use else text).encode() in data


@pytest.mark.parametrize("text", ["Main.I&#110;it.X", "M&#x61;in.<![CDATA[Init]]>.X", "Main.In<xhtml:b>it</xhtml:b>.X"])
def test_a_step_is_found_where_markup_or_numbers_are_inside_of_its_name(text: str) -> None:
    project = sfc.loads(_file(_program("Main", "TRUE"), _program("Other", text)))
    assert [use.path for use in project.uses("Main.Init")] != []
    assert not project.uses("Main.Act")


def test_an_edit_leaves_all_other_programs_as_they_are() -> None:
    strange = _program("Strange", "TRUE").replace(
        "<interface/>", "<!-- <pou name='x'> --><interface/><?tool <pou > ?>", 1
    )
    strange = strange.replace("TRUE", "<![CDATA[x = '</pou>']]>", 1).replace('"program"', "'program'", 1)
    pous = [_program("First", "TRUE"), strange, _program("Last", "TRUE")]
    project = sfc.loads(_file(*pous))
    assert [pou.name for pou in project.pous] == ["First", "Strange", "Last"]
    for number, name in ((0, "First"), (2, "Last")):
        project.rename(f"{name}.Init", "Begin")
        pous[number] = pous[number].replace('"Init"', '"Begin"')
    assert sfc.dumps(project) == _file(*pous)
    project.rename("Strange.Init", "Begin")
    pous[1] = pous[1].replace('"Init"', '"Begin"')
    assert sfc.dumps(project) == _file(*pous)


def test_programs_in_another_order_are_saved_so() -> None:
    names = ["A", "B", "C"]
    project = sfc.loads(_file(*(_program(name, "TRUE") for name in names)))
    project.pous = [project.pous[2], project.pous[0], project.pous[1]]
    assert [pou.name for pou in sfc.loads(sfc.dumps(project)).pous] == ["C", "A", "B"]
    project.pous = project.pous[:2]
    project.rename("C.Init", "Begin")
    again = sfc.loads(sfc.dumps(project))
    assert [(pou.name, pou.sfc.steps[0].name) for pou in again.pous if pou.sfc] == [("C", "Begin"), ("A", "Init")]


@pytest.mark.parametrize("what", ["program", "body", "chart"])
def test_a_chart_of_the_same_name_in_another_file_is_saved(what: str) -> None:
    project = sfc.loads(_file(_program("Main", "TRUE")))
    other = sfc.loads(_file(_program("Main", "TRUE", step="Start")))
    if what == "program":
        project.pous[0] = other.pous[0]
    elif what == "body":
        project.pous[0].bodies = other.pous[0].bodies
    else:
        project.pous[0].bodies[0] = SfcBody(chart=other.pous[0].chart)
    assert b'name="Start"' in sfc.dumps(project)


def test_charts_with_statements_in_steps_are_rewritten_alone_in_codesys(tmp_path: Path) -> None:
    generate(tmp_path / "many.xml", megabytes=2.4, codesys=True, steps=8)
    data = (tmp_path / "many.xml").read_bytes()
    project = sfc.loads(data)
    charts = [body.chart for pou in project.pous for body in pou.bodies if isinstance(body, SfcBody)]
    assert len(charts) > 2
    charts[1].rename_step(charts[1].steps[0].name, "Renamed")
    saved = sfc.dumps(project)
    assert [not chart.is_unread for chart in charts] == [at == 1 for at in range(len(charts))]
    old, new = data.splitlines(), saved.splitlines()
    assert len(old) == len(new)
    assert {b"Renamed" in after for before, after in zip(old, new, strict=True) if before != after} == {True}


def test_a_word_is_found_wherever_it_is_in_a_long_text() -> None:
    """Texts with letters beyond ASCII are searched in parts, and a word may be in two of them."""
    for blanks in range(65_300, 65_540):
        step = sfc.Step(id=1, name="S", comment=f"ü{' ' * blanks}FindMe")
        assert sfc.SfcNetwork(steps=[step]).may_mention({"findme"})
        assert not sfc.SfcNetwork(steps=[step]).may_mention({"findyou"})
