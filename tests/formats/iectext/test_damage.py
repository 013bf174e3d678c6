"""Whatever happens to a text, it is read or refused with an error of this package, and what was read comes back."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import Outcome
from tests.samples import FIXTURES
from tests.strategies import projects
from tests.sweeps import examples

PLANT = (FIXTURES / "iectext" / "mixing_plant.st").read_text(encoding="utf-8")
PIECES = [
    "(*",
    "*)",
    "{",
    "}",
    "'",
    "END_STEP",
    "STEP",
    "ACTION x:",
    ";",
    ":=",
    "(",
    ")",
    "END_PROGRAM",
    "\0",
    "\r",
    "//",
]
some = settings(
    max_examples=examples(40),
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


@st.composite
def damaged(draw: Callable[..., Any]) -> str:
    text = PLANT
    for _ in range(draw(st.integers(1, 3))):
        start = draw(st.integers(0, len(text) - 1))
        length = draw(st.sampled_from([0, 1, 3, 10, 40, 200]))
        kind = draw(st.sampled_from(["remove", "copy", "insert"]))
        if kind == "remove":
            text = text[:start] + text[start + length :]
        elif kind == "copy":
            place = draw(st.integers(0, len(text) - 1))
            text = text[:place] + text[start : start + length] + text[place:]
        else:
            text = text[:start] + draw(st.sampled_from(PIECES)) + text[start:]
    return text


def assert_kept(text: str) -> m.Project:
    project = sfc.loads(text.encode(), format="iec-text")
    assert sfc.dumps(project) == text.encode()
    written = sfc.dumps(project, format="iec-text", fresh=True, partial=True)
    assert sfc.loads(written, format="iec-text") == project
    return project


@pytest.mark.slow
@some
@given(damaged())
def test_damaged_texts(text: str) -> None:
    with contextlib.suppress(sfc.SfcError):
        assert_kept(text)


@pytest.mark.parametrize(
    "text",
    [
        "PROGRAM P\nACTION A:\nACTION B: x := 1; END_ACTION\nEND_ACTION\nEND_PROGRAM\n",
        "PROGRAM P\nACTION A: x := 1;\nINITIAL_STEP S: END_STEP\nACTION B: END_ACTION\nEND_PROGRAM\n",
        "PROGRAM P\nACTION A:\nINITIAL_STEP S: END_STEP\nx := 1;\nEND_ACTION\nEND_PROGRAM\n",
        "PROGRAM P\nVAR_ACCESS a : R.b : INT READ_ONLY; END_VAR\nEND_PROGRAM\n",
        "PROGRAM P\nVAR FUNCTION x END_VAR\nEND_PROGRAM\n",
        "PROGRAM P END_PROGRAM\nwords\n\nINTERFACE I END_INTERFACE\nmore words\n",
        "INTERFACE I\nPROGRAM P END_PROGRAM\n",
        "FUNCTION_BLOCK F\nMETHOD PUBLIC\n:x := 1;\nEND_METHOD\nEND_FUNCTION_BLOCK\n",
        "PROGRAM P\nINITIAL_STEP A: ; ; Act(N);; END_STEP\nTRANSITION END_TRANSITION\nEND_PROGRAM\n",
        "CONFIGURATION C\nTASK T; PROGRAM; PROGRAM x WITH y : z;\nEND_CONFIGURATION\n",
    ],
)
def test_texts_that_were_read_wrongly_once(text: str) -> None:
    assert_kept(text)


def test_an_action_without_its_end_does_not_swallow_the_chart() -> None:
    project = assert_kept(
        "PROGRAM P\nINITIAL_STEP A: END_STEP\nACTION Act: x := 1;\nSTEP B: END_STEP\n"
        "TRANSITION FROM A TO B := x; END_TRANSITION\nEND_PROGRAM\n"
    )
    chart = project.pou("P").sfc
    assert chart is not None
    assert [step.name for step in chart.steps] == ["A", "B"]
    assert project.pou("P").actions[0].body == m.StBody(text="x := 1;")


@pytest.mark.slow
@some
@given(projects(), st.data())
def test_edits_of_random_texts_change_their_place(project: m.Project, data: st.DataObject) -> None:
    text = sfc.dumps(project, format="iec-text", fresh=True, partial=True)
    loaded = sfc.loads(text, format="iec-text")
    charts = [chart.chart for chart in loaded.charts()]
    if charts:
        chart = data.draw(st.sampled_from(charts))
        step = data.draw(st.sampled_from(chart.steps))
        step.name, step.max_time = "Zz9_Neu", "T#77s"
        data.draw(st.sampled_from(chart.transitions)).condition = m.Expression(text="Zz9 > 3")
    else:
        loaded.pous[0].bodies = [m.StBody(text="Zz9 := 3;")]
    _, report = sfc.convert(loaded, "iec-text", partial=True)
    assert report.with_outcome(Outcome.APPROXIMATED, Outcome.DROPPED) == []
    assert sfc.loads(sfc.dumps(loaded, partial=True), format="iec-text") == loaded
