"""Timers and edges drawn in front of transitions, in the tools of CODESYS, which draw nothing in a chart."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import LossError
from plcopen_sfc.model import Expression, Project, StBody
from plcopen_sfc.report import Outcome

CODESYS_FAMILY = ["codesys", "codesys-export", "twincat", "codesys23"]
HEAD = (
    '<project xmlns="http://www.plcopen.org/xml/tc6_0201"><fileHeader companyName="X" productName="{tool}" '
    'productVersion="1" creationDateTime="2024-01-01T00:00:00"/><contentHeader name="p"><coordinateInfo><fbd><scaling '
    'x="1" y="1"/></fbd><ld><scaling x="1" y="1"/></ld><sfc><scaling x="1" y="1"/></sfc></coordinateInfo>'
    '</contentHeader><types><dataTypes/><pous><pou name="Main" pouType="program"><interface><inputVars>'
    '<variable name="a"><type><BOOL/></type></variable><variable name="b"><type><BOOL/></type></variable>'
    '<variable name="wait"><type><TIME/></type></variable></inputVars>'
    '<outputVars><variable name="q"><type><BOOL/></type></variable><variable name="r"><type><BOOL/></type></variable>'
    '</outputVars><localVars><variable name="t1"><type><derived name="{block}"/></type></variable></localVars>'
    "</interface><body><SFC>"
)
FOOT = "</SFC></body></pou></pous></types><instances><configurations/></instances></project>"
AT = '<position x="0" y="0"/>'
TIMER = (
    f'<inVariable localId="30">{AT}<connectionPointOut/><expression>a</expression></inVariable>'
    f'<inVariable localId="31">{AT}<connectionPointOut/><expression>T#30ms</expression></inVariable>'
    f'<block localId="32" typeName="TON" instanceName="t1">{AT}<inputVariables>'
    '<variable formalParameter="IN"><connectionPointIn><connection refLocalId="30"/></connectionPointIn></variable>'
    '<variable formalParameter="PT"><connectionPointIn><connection refLocalId="31"/></connectionPointIn></variable>'
    '</inputVariables><inOutVariables/><outputVariables><variable formalParameter="Q"><connectionPointOut/></variable>'
    "</outputVariables></block>"
)
EDGE = (
    f'<leftPowerRail localId="20">{AT}<connectionPointOut formalParameter=""/></leftPowerRail>'
    f'<contact localId="21" edge="rising">{AT}<connectionPointIn><connection refLocalId="20"/></connectionPointIn>'
    "<connectionPointOut/><variable>b</variable></contact>"
)
FLIP_FLOP = (
    TIMER.replace("TON", "SR").replace('"IN"', '"S1"').replace('"PT"', '"R"').replace("T#30ms", "b").replace("Q", "Q1")
)
LAMP = (
    f'<inVariable localId="40">{AT}<connectionPointOut/><expression>b</expression></inVariable>'
    f'<outVariable localId="41">{AT}<connectionPointIn><connection refLocalId="40"/></connectionPointIn>'
    "<expression>r</expression></outVariable>"
)


def step(number: int, name: str, before: int, *, initial: bool = False) -> str:
    start = str(initial).lower()
    return (
        f'<step localId="{number}" name="{name}" initialStep="{start}">{AT}<connectionPointIn><connection '
        f'refLocalId="{before}"/></connectionPointIn><connectionPointOut formalParameter=""/>'
        '<connectionPointOutAction formalParameter=""/></step>'
    )


def transition(number: int, source: int, condition: str, priority: int = 0) -> str:
    order = f' priority="{priority}"' if priority else ""
    return (
        f'<transition localId="{number}"{order}>{AT}<connectionPointIn><connection refLocalId="{source}"/>'
        f"</connectionPointIn><connectionPointOut/><condition>{condition}</condition></transition>"
    )


def wire(source: str) -> str:
    return f"<connectionPointIn><connection {source}/></connectionPointIn>"


def text(condition: str) -> str:
    body = f'<xhtml xmlns="http://www.w3.org/1999/xhtml">{condition}</xhtml>'
    return f'<inline name=""><ST>{body}</ST></inline>'


ACTION = (
    f'<actionBlock localId="7">{AT}<connectionPointIn><connection refLocalId="6"/></connectionPointIn><action '
    'localId="0" qualifier="N"><relPosition x="0" y="0"/><reference name="q"/></action></actionBlock>'
)


def chart(logic: str, source: str, *, tool: str = "Vendor") -> Project:
    """S1, left by what `logic` gives at `source`, and S2, left by ``NOT a``."""
    content = step(1, "S1", 9, initial=True) + logic + transition(2, 1, wire(source)) + step(6, "S2", 2) + ACTION
    content += transition(9, 6, text("NOT a"))
    block = "SR" if "SR" in logic else "TON"
    return sfc.loads((HEAD.format(tool=tool, block=block) + content + FOOT).encode())


def branch() -> Project:
    """S1, left by an edge or else by a timer."""
    content = step(1, "S1", 9, initial=True) + TIMER + EDGE
    content += (
        f'<selectionDivergence localId="50">{AT}<connectionPointIn><connection refLocalId="1"/></connectionPointIn>'
    )
    content += '<connectionPointOut formalParameter=""/><connectionPointOut formalParameter=""/></selectionDivergence>'
    content += transition(2, 50, wire('refLocalId="21"'), 1)
    content += transition(3, 50, wire('refLocalId="32" formalParameter="Q"'), 2)
    content += f'<selectionConvergence localId="51">{AT}<connectionPointIn><connection refLocalId="2"/>'
    content += '</connectionPointIn><connectionPointIn><connection refLocalId="3"/></connectionPointIn>'
    content += "<connectionPointOut/></selectionConvergence>"
    content += step(6, "S2", 51) + ACTION + transition(9, 6, text("NOT a"))
    return sfc.loads((HEAD.format(tool="Vendor", block="TON") + content + FOOT).encode())


BOXES = {"timer": (TIMER, 'refLocalId="32" formalParameter="Q"'), "edge": (EDGE, 'refLocalId="21"')}


def converted(source: Project, target: str) -> tuple[Project, sfc.ConversionReport]:
    data, report = sfc.convert(source, target, limit=10)
    return sfc.loads(data, as_tool=True), report


@pytest.mark.parametrize("target", CODESYS_FAMILY)
@pytest.mark.parametrize("box", BOXES)
def test_boxes_before_a_condition_become_calls_in_an_action(box: str, target: str) -> None:
    result, report = converted(chart(*BOXES[box]), target)
    assert [item for item in report.losses if "timers_and_edges" in item.why or "condition" in item.what] == []
    assert report.compared["POU Main"].startswith("equal")
    (found,) = result.charts()
    assert found.chart.logic == []
    action = found.pou.find_action("timers_and_edges")
    assert action is not None
    assert isinstance(action.body, StBody)
    assert action.body.text.startswith("IF S1.x THEN")
    condition = next(t.condition for t in found.chart.transitions if t.condition is not None)
    assert isinstance(condition, Expression)
    assert condition.text == ("t1.Q" if box == "timer" else "edge_21.Q")


@pytest.mark.slow
@pytest.mark.parametrize("source", [chart(*BOXES["timer"]), chart(*BOXES["edge"]), branch()], ids=[*BOXES, "branch"])
def test_boxes_before_a_condition_are_permanent_instructions_in_tia_portal(source: Project) -> None:
    data, report = sfc.convert(source, "simaticml", limit=5)
    assert not report.losses
    assert report.compared["POU Main"].startswith("equal")
    assert sfc.loads(data, as_tool=True).pou("Main").chart.permanent_pre
    back, before = sfc.loads(data).pou("Main"), source.pou("Main")
    assert back.chart.permanent_pre == []
    assert len(back.chart.logic) == len(before.chart.logic)
    assert [each.name for each in back.variables()] == [each.name for each in before.variables()]


def test_the_time_of_a_timer_stays_while_nothing_calls_it_in_tia_portal() -> None:
    source = chart(TIMER.replace("T#30ms", "wait"), BOXES["timer"][1])
    data, report = sfc.convert(source, "simaticml", limit=3)
    assert not report.losses
    assert report.compared["POU Main"].startswith("equal")
    written = sfc.loads(data, as_tool=True).pou("Main").chart.permanent_pre[0].model_dump_json()
    assert "SEL" in written


@pytest.mark.parametrize(
    "source",
    [
        chart(*BOXES["timer"], tool="Beremiz"),
        chart(*BOXES["edge"], tool="Beremiz"),
        chart(FLIP_FLOP, 'refLocalId="32" formalParameter="Q1"', tool="Beremiz"),
        chart(TIMER + LAMP, BOXES["timer"][1], tool="Beremiz"),
        chart(LAMP + EDGE, BOXES["edge"][1]),
    ],
    ids=["timer", "edge", "flip-flop", "left out", "lamp"],
)
def test_what_is_drawn_is_executed_in_permanent_instructions_of_tia_portal(source: Project) -> None:
    """Beremiz executes boxes in every scan after the transitions, and nothing else that is drawn."""
    data, report = sfc.convert(source, "simaticml", limit=8)
    assert not report.losses
    assert report.compared["POU Main"].startswith("equal")
    written = sfc.loads(data, as_tool=True).pou("Main").chart
    assert bool(written.permanent_post) is (source.header.product == "Beremiz")
    back = sfc.loads(data).pou("Main")
    assert len(back.chart.logic) == len(source.pou("Main").chart.logic)
    assert [each.name for each in back.variables()] == [each.name for each in source.pou("Main").variables()]


@pytest.mark.slow
@pytest.mark.parametrize("target", ["codesys", "codesys23"])
def test_a_box_waits_for_the_transitions_that_are_tried_before(target: str) -> None:
    result, report = converted(branch(), target)
    assert report.compared["POU Main"].startswith("equal")
    action = result.pou("Main").find_action("timers_and_edges")
    assert action is not None
    assert isinstance(action.body, StBody)
    assert "AND NOT edge_21.Q THEN\n    t1(" in action.body.text


def test_conditions_of_beremiz_read_what_boxes_gave_a_scan_ago() -> None:
    result, report = converted(chart(*BOXES["timer"], tool="Beremiz"), "codesys")
    assert report.compared["POU Main"].startswith("equal")
    action = result.pou("Main").find_action("timers_and_edges")
    assert action is not None
    assert isinstance(action.body, StBody)
    assert action.body.text.splitlines() == ["t1_Q_before := t1.Q;", "t1(IN := a, PT := T#30ms);"]


def test_logic_that_writes_becomes_statements_that_follow_at_once() -> None:
    source = chart(TIMER + LAMP, 'refLocalId="32" formalParameter="Q"')
    data, report = sfc.convert(source, "codesys", limit=0)
    (item,) = (item for item in report.items if item.what == "drawn logic")
    assert item.outcome is Outcome.APPROXIMATED
    action = sfc.loads(data, as_tool=True).pou("Main").find_action("timers_and_edges")
    assert action is not None
    assert isinstance(action.body, StBody)
    assert action.body.text.startswith("r := b;\nIF S1.x THEN")
    with pytest.raises(LossError):
        sfc.convert(source, "codesys", limit=0, strict=True)


@pytest.mark.parametrize("target", ["codesys", "codesys23"])
@pytest.mark.parametrize("source", [chart(TIMER + LAMP + EDGE, 'refLocalId="21"'), branch()], ids=["lamp", "branch"])
def test_the_drawing_comes_back(source: Project, target: str) -> None:
    data, _ = sfc.convert(source, target, limit=0)
    assert not sfc.diff(source, sfc.loads(data)).changes


def test_an_edited_action_stays_as_it_is_written() -> None:
    data, _ = sfc.convert(chart(*BOXES["timer"]), "codesys", limit=0)
    edited = data.replace(b"PT := T#30ms", b"PT := T#40ms")
    (found,) = sfc.loads(edited).charts()
    assert found.chart.logic == []
    texts = [t.condition.text for t in found.chart.transitions if isinstance(t.condition, Expression)]
    assert texts[0] == "t1.Q"
    assert found.pou.find_action("timers_and_edges") is not None
