"""What is edited in a converted file counts; without an edit the source comes back."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.model.compare import differences

CHART = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR_OUTPUT q, r : BOOL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a AND NOT b; END_TRANSITION
STEP S1: q(P1); Both(N); END_STEP
TRANSITION FROM S1 TO S0 := b; END_TRANSITION
ACTION Both: q := a; r := b; END_ACTION
END_FUNCTION_BLOCK
"""


def converted() -> str:
    return sfc.dumps(sfc.loads(CHART.encode(), format="iec-text"), format="simaticml", partial=True).decode("utf-8-sig")


def chart_of(text: str) -> m.SfcNetwork:
    chart = sfc.loads(text.encode(), format="simaticml").pou("Main").sfc
    assert chart is not None
    return chart


def row_targets(text: str) -> list[tuple[str | None, str | None]]:
    return [(row.target, row.value) for row in chart_of(text).step("S1").actions]


def renumbered(text: str) -> str:
    """The file with other numbers, and the comments where they were."""
    return re.sub(r'UId="(\d+)"', lambda found: f'UId="{int(found[1]) + 100}"', text)


@pytest.mark.parametrize("change", [str, renumbered])
def test_the_source_comes_back_where_nothing_was_edited(change: Callable[[str], str]) -> None:
    chart = chart_of(change(converted()))
    assert [t.condition for t in chart.transitions] == [
        m.Expression(text="#a AND NOT #b"),
        m.Expression(text="#b"),
    ]
    assert [(row.qualifier, row.target) for row in chart.step("S1").actions] == [("P1", "#q"), ("N", "#Both")]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('<Component Name="a" />', '<Component Name="r" />'),
        ('<Negated Name="operand" />', ""),
    ],
)
def test_an_edited_condition_counts(old: str, new: str) -> None:
    text = converted()
    assert old in text
    first, second = chart_of(text.replace(old, new)).transitions
    assert isinstance(first.condition, m.BodyCondition)
    assert second.condition == m.Expression(text="#b")


@pytest.mark.parametrize(
    ("pattern", "new", "expected"),
    [
        ('Text="#q" />', 'Text="#r" />', [("#r", None), ("#r", "#a"), ("#r", "#b")]),
        ('Text="#b" />', 'Text="#q" />', [("#q", None), ("#q", "#a"), ("#r", "#q")]),
        ('Event="S1"', 'Event="S0"', [("#q", None), ("#q", "#a"), ("#r", "#b")]),
    ],
)
def test_edited_rows_count(pattern: str, new: str, expected: list[tuple[str, str | None]]) -> None:
    text = converted()
    assert pattern in text
    assert row_targets(text.replace(pattern, new)) == expected


def test_a_deleted_row_is_gone() -> None:
    rows = re.findall(r"<Action [^/>]*>.*?</Action>", converted(), re.DOTALL)
    for row in rows:
        assert len(row_targets(converted().replace(row, "", 1))) == len(rows) - 1


def test_a_condition_without_its_minimum_time_needs_none() -> None:
    source = sfc.loads(CHART.encode(), format="iec-text")
    chart = source.pou("Main").sfc
    assert chart is not None
    chart.step("S1").min_time = "T#5s"
    text = sfc.dumps(source, format="simaticml", partial=True).decode("utf-8-sig")
    assert chart_of(text).step("S1").min_time == "T#5s"
    assert "T#5s" in text
    edited = chart_of(re.sub(r"(<ConstantValue[^>]*>)T#5s", r"\1T#9s", text))
    assert edited.step("S1").min_time is None
    assert isinstance(edited.transitions[1].condition, m.BodyCondition)


def test_files_without_digests_are_read_as_before() -> None:
    text = re.sub(r', "written": "\w+"', "", converted())
    old = re.sub(r'<!--plcopen_sfc \{"written".*?-->', "", text)
    assert "written" not in old
    assert not list(differences(sfc.loads(converted().encode()), sfc.loads(old.encode())))


def test_what_is_programmed_in_an_empty_block_counts() -> None:
    """TIA Portal has no IL: the block is empty until somebody programs it."""
    block = m.Pou(name="List", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.IlBody(text="LD a\nST q")])
    text = sfc.dumps(m.Project(pous=[block]), format="simaticml", partial=True).decode("utf-8-sig")
    assert isinstance(sfc.loads(text.encode()).pou("List").bodies[0], m.IlBody)
    network = re.search(r"<FlgNet.*?</FlgNet>", converted(), re.DOTALL)
    assert network is not None
    flgnet = network[0].replace(
        "<FlgNet>", '<FlgNet xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/FlgNet/v4">'
    )
    programmed = text.replace("<NetworkSource />", f"<NetworkSource>{flgnet}</NetworkSource>")
    assert programmed != text
    assert isinstance(sfc.loads(programmed.encode()).pou("List").bodies[0], m.LdBody)
