"""Selecting, ignoring, letting be: which findings come out, with which severity and place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.errors import ModelError
from plcopen_sfc.model import MultilingualText, Pou, PouKind, Project, SfcBody, SfcNetwork, Step
from plcopen_sfc.semantics.profile import PROFILES
from tests.analysis.checks.charts import RING, chart_of, codes, project_of, ring

DEAD_END = """
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
"""


def test_a_sound_chart_has_no_errors() -> None:
    assert [f for f in sfc.check(project_of(RING)) if f.severity is not Severity.INFO] == []


def test_a_chart_a_pou_and_a_project_can_be_checked() -> None:
    project = project_of(DEAD_END)
    chart = project.pou("P").sfc
    assert chart is not None
    everything = sfc.check(project)
    assert "STR09" in {finding.code for finding in everything}
    assert sfc.check(chart) == everything
    assert sfc.check(project.pou("P")) == everything


def test_a_chart_alone_is_checked() -> None:
    chart = ring("S1", "S2")
    chart.transitions.pop()
    [finding] = sfc.check(chart, select=["STR09"])
    assert str(finding.location) == "step S2"
    assert finding.hint


def test_a_pou_alone_is_checked() -> None:
    chart = ring("S1", "S2")
    chart.transitions.pop()
    pou = Pou(name="Main", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])
    [finding] = sfc.check(pou, select=["STR09"])
    assert finding.location.path == "POU Main / step S2"


def test_charts_of_actions_and_inside_of_steps_are_checked() -> None:
    inner = ring("A", "B")
    inner.transitions.pop()
    chart = ring("S1", "S2")
    chart.step("S1").entry_action = SfcBody(chart=inner)
    project = Project(pous=[Pou(name="Main", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])])
    [finding] = sfc.check(project, select=["STR09"])
    assert finding.location.path == "POU Main / step S1 / step B"


def test_places_in_the_file(fixtures_folder: Path) -> None:
    path = fixtures_folder / "broken" / "jump_to_nowhere.xml"
    [finding] = sfc.check(sfc.load(path), select=["STR05"])
    assert finding.location.file == str(path)
    assert finding.location.line is not None
    line = path.read_text(encoding="utf-8").splitlines()[finding.location.line - 1]
    assert "<transition" in line


@pytest.fixture
def fixtures_folder() -> Path:
    return Path(__file__).resolve().parents[3] / "fixtures"


class TestSelecting:
    def test_by_code_and_by_the_start_of_a_code(self) -> None:
        chart = chart_of(DEAD_END)
        assert codes(chart, select=["STR09"]) == ["STR09"]
        assert codes(chart, select=["str"]) == ["STR09"]
        assert codes(chart, select=["STR01"]) == []

    def test_ignored(self) -> None:
        chart = chart_of(DEAD_END)
        assert "STR09" not in {f.code for f in sfc.check(chart, ignore=["STR09"])}
        assert not any(f.code.startswith("STR") for f in sfc.check(chart, ignore=["STR"]))

    @pytest.mark.parametrize("unknown", ["STR99", "XYZ", "", "9"])
    def test_an_unknown_code_is_an_error(self, unknown: str) -> None:
        with pytest.raises(ModelError, match="there is no rule"):
            sfc.check(ring("A"), select=[unknown])
        with pytest.raises(ModelError, match="there is no rule"):
            sfc.check(ring("A"), ignore=[unknown])

    def test_an_unknown_profile_is_an_error(self) -> None:
        with pytest.raises(ModelError, match="profile"):
            sfc.check(ring("A"), profile="graph5")


class TestProfiles:
    @pytest.mark.parametrize(
        ("profile", "severity"), [("iec", "warning"), ("codesys", "error"), ("s7graph", "error"), ("grafcet", "info")]
    )
    def test_decide_on_the_severity(self, profile: str, severity: str) -> None:
        [finding] = sfc.check(chart_of(DEAD_END), profile=profile, select=["STR09"])
        assert finding.severity == severity

    def test_decide_whether_a_rule_applies(self) -> None:
        chart = ring("S1", "S2")
        chart.step("S2").initial = True
        assert codes(chart, "iec", ["STR12"]) == ["STR12"]
        assert codes(chart, "grafcet", ["STR12"]) == []

    def test_one_of_your_own_counts_as_the_one_it_is_made_of(self) -> None:
        own = replace(PROFILES["s7graph"], name="ours", final_scan=True)
        [finding] = sfc.check(chart_of(DEAD_END), profile=own, select=["STR09"])
        assert finding.severity is Severity.ERROR


class TestLettingBe:
    @pytest.mark.parametrize(
        "comment",
        [
            "plcopen-sfc: ignore STR09",
            "runs once; plcopen-sfc: ignore str09",
            "PLCOPEN-SFC: ignore STR",
            "plcopen-sfc: ignore ACT01, STR09",
            "plcopen-sfc: ignore ACT01 STR09 because it runs once",
        ],
    )
    def test_in_the_comment_of_the_step(self, comment: str) -> None:
        chart = chart_of(DEAD_END)
        chart.step("S2").comment = comment
        assert codes(chart, select=["STR09"]) == []

    @pytest.mark.parametrize(
        "comment", ["plcopen-sfc: ignore ACT01", "ignore STR09", "see plcopen-sfc", "plcopen-sfc: ignore: STR08"]
    )
    def test_other_comments_do_not(self, comment: str) -> None:
        chart = chart_of(DEAD_END)
        chart.step("S2").comment = comment
        assert codes(chart, select=["STR09"]) == ["STR09"]

    def test_the_comment_of_another_step_does_not(self) -> None:
        chart = chart_of(DEAD_END)
        chart.step("S1").comment = "plcopen-sfc: ignore STR09"
        assert codes(chart, select=["STR09"]) == ["STR09"]

    def test_in_the_comment_of_the_chart_or_of_the_pou(self) -> None:
        project = project_of(DEAD_END)
        pou = project.pou("P")
        pou.comment = MultilingualText(texts={"de-DE": "läuft einmal", "en-US": "plcopen-sfc: ignore STR09"})
        assert codes(project, select=["STR09"]) == []
        pou.comment = None
        assert pou.sfc is not None
        pou.sfc.comment = "plcopen-sfc: ignore STR09"
        assert codes(project, select=["STR09"]) == []

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("file", "pou"),
        [
            ("plcopen/filling_station_2.01.xml", "FillingStation"),
            ("codesys/sorting_conveyor.xml", "PLC_PRG"),
            ("simaticml/FB_Drill.xml", "FB_Drill"),
            ("iectext/mixing_plant.st", "Mixer"),
        ],
    )
    def test_comments_are_kept_in_files(self, fixtures_folder: Path, file: str, pou: str) -> None:
        project = sfc.load(fixtures_folder / file)
        chart = project.pou(pou).sfc
        assert chart is not None
        for step in chart.steps:
            step.min_time, step.max_time = "T#9s", "T#8s"
        before = len(codes(project, select=["TIM01"]))
        suppressed = next(step for step in chart.steps if not step.exclude)
        suppressed.comment = "plcopen-sfc: ignore TIM01"
        again = sfc.loads(sfc.dumps(project, partial=True))
        places = [finding.location.path for finding in sfc.check(again, select=["TIM01"])]
        assert len(places) == before - 1 > 0
        assert not any(str(place).endswith(f"step {suppressed.name}") for place in places)


class TestExcluded:
    def test_elements_are_not_looked_at(self) -> None:
        chart = chart_of(DEAD_END)
        chart.step("S2").exclude = True
        chart.transitions[0].exclude = True
        assert codes(chart, select=["STR"]) == []

    def test_what_stands_in_an_excluded_step_is_not_looked_at(self) -> None:
        inner = ring("A", "B")
        inner.transitions.pop()
        chart = ring("S1", "S2")
        chart.steps.append(Step(id=99, name="S3", exclude=True, entry_action=SfcBody(chart=inner)))
        assert codes(SfcNetwork.model_validate(chart), select=["STR"]) == []
