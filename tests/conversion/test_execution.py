"""The report names what the target executes otherwise."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import LossError
from plcopen_sfc.report import Outcome
from tests.samples import FIXTURES

SHARED = """FUNCTION_BLOCK Main
VAR_INPUT a, b, c : BOOL; END_VAR
VAR_OUTPUT n : INT; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a; END_TRANSITION
STEP S1: {first} END_STEP
TRANSITION FROM S1 TO S2 := b; END_TRANSITION
STEP S2: {second} END_STEP
TRANSITION FROM S2 TO S0 := c; END_TRANSITION
ACTION Act: n := n + 1; END_ACTION
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(
    ("first", "second"),
    [("Act(P1); Act(S);", "Act(R);"), ("Act(P1);", "Act(P1);"), ("Act(P0);", "Act(N);")],
)
def test_an_action_of_several_steps_has_one_control_that_step_actions_do_not_have(first: str, second: str) -> None:
    project = sfc.loads(SHARED.format(first=first, second=second).encode(), format="iec-text")
    _, report = sfc.convert(project, "codesys", partial=True)
    assert any(item.path.startswith("POU Main / step S") for item in report.losses)


def test_an_action_of_one_step_is_the_same_as_an_entry_action() -> None:
    project = sfc.loads(SHARED.format(first="Act(P1);", second="").encode(), format="iec-text")
    _, report = sfc.convert(project, "codesys")
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []


class TestPartly:
    """Things that the target does not execute are refused, and no file is written, unless that is asked for."""

    SOURCE = FIXTURES / "simaticml" / "FB_Drill.xml"

    @pytest.mark.slow
    def test_save_writes_nothing(self, tmp_path: Path) -> None:
        target = tmp_path / "drill.xml"
        with pytest.raises(LossError, match="would not be executed") as refused:
            sfc.save(sfc.load(self.SOURCE), target, format="codesys")
        assert list(tmp_path.iterdir()) == []
        assert refused.value.report.with_outcome(Outcome.NOT_EXECUTED)
        assert "partial=True" in str(refused.value)
        report = sfc.save(sfc.load(self.SOURCE), target, format="codesys", partial=True)
        assert report.items == refused.value.report.items
        assert target.exists()

    @pytest.mark.slow
    def test_bytes_are_not_made(self) -> None:
        for made in (sfc.convert, lambda project, form: sfc.dumps(project, format=form)):
            with pytest.raises(LossError):
                made(sfc.load(self.SOURCE), "codesys")
        data, _ = sfc.convert(sfc.load(self.SOURCE), "codesys", partial=True)
        assert sfc.dumps(sfc.load(self.SOURCE), format="codesys", partial=True) == data

    @pytest.mark.slow
    def test_a_folder_stays_as_it_is(self, tmp_path: Path) -> None:
        project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
        with pytest.raises(LossError):
            sfc.save(project, f"{tmp_path / 'out'}/", format="simaticml")
        assert list(tmp_path.iterdir()) == []
        assert sfc.save(project, f"{tmp_path / 'out'}/", format="simaticml", partial=True).written

    def test_strict_is_stricter(self) -> None:
        project = sfc.load(FIXTURES / "grafcet" / "four_steps.gct")
        report = sfc.convert(project, "codesys")[1]
        assert report.with_outcome(Outcome.APPROXIMATED)
        with pytest.raises(LossError, match="otherwise or not at all"):
            sfc.save(project, io.BytesIO(), format="codesys", strict=True)


OPERANDS = b"""PROGRAM Main
VAR_INPUT Begin : BOOL; Organization_Block : INT; END_VAR
VAR n : INT; q : BOOL; END_VAR
INITIAL_STEP Idle: END_STEP
STEP Work: %s(N); END_STEP
TRANSITION FROM Idle TO Work := Begin; END_TRANSITION
TRANSITION FROM Work TO Idle := Organization_Block > 3; END_TRANSITION
END_PROGRAM
"""


@pytest.mark.parametrize("target", ["codesys", "twincat", "codesys23", "plcopen-2.01", "simaticml"])
def test_an_action_on_a_variable_that_is_not_boolean_is_not_executed(target: str) -> None:
    project = sfc.loads(OPERANDS % b"n", format="iec-text")
    _, report = sfc.convert(project, target, partial=True)
    lost = report.with_outcome(Outcome.NOT_EXECUTED)
    assert [(item.what, item.path) for item in lost] == [("action", "POU Main / step Work / action n")]
    assert "of the type INT" in lost[0].why


@pytest.mark.parametrize("target", ["twincat", "codesys23", "codesys-export"])
def test_words_that_only_other_tools_reserve_are_names_in_texts_of_declarations(target: str) -> None:
    data, report = sfc.convert(sfc.loads(OPERANDS % b"q", format="iec-text"), target)
    assert not report.losses
    names = [variable.name for variable in sfc.loads(data, format=target, as_tool=True).pou("Main").variables()]
    assert names[:2] == ["Begin", "Organization_Block"]
