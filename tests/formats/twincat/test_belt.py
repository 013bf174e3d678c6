"""The distribution belt as `.TcPOU` and as PLCopen XML: one model that does what the textbook (11.5) describes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc

FIXTURES = Path(__file__).parents[3] / "fixtures"
BELTS = [FIXTURES / "twincat-belt", FIXTURES / "codesys" / "distribution_belt.xml"]
SCAN = 100  # ms


def test_both_files_are_the_same_chart() -> None:
    charts = [sfc.load(path).pou("Ablauf_Band").chart for path in BELTS]
    one, two = (
        [
            [step.model_dump(exclude={"extension_data"}) for step in chart.steps],
            [each.model_dump(exclude={"extension_data"}) for each in chart.transitions],
        ]
        for chart in charts
        if chart is not None
    )
    assert one == two


def run(path: Path, scans: int, **inputs: Callable[[int], bool]) -> sfc.Trace:
    """Run the chart with a part that moves by one in each scan in which a motor runs, to place 3 and back."""
    position = 0

    def plant(scan: int, values: Mapping[str, Any]) -> dict[str, Any]:
        nonlocal position
        position += int(values["GVL_EA.K1_BandRechts"]) - int(values["GVL_EA.K2_BandLinks"])
        sensors = {
            "GVL_EA.B1_Platz1": position <= 0,
            "GVL_EA.B3_Platz3": position == 10,
            "GVL_EA.B4_Lichtschranke": True,
            "GVL_EA.S1_Start": 3 <= scan < 6,
            "GVL_EA.S2_Halt": True,
        }
        return sensors | {name: value(scan) for name, value in inputs.items()}

    return sfc.simulate(sfc.load(path), pou="Ablauf_Band", inputs=plant, scans=scans, scan_time=f"{SCAN}ms")


@pytest.mark.parametrize("path", BELTS, ids=lambda path: path.name)
def test_the_part_waits_three_seconds_at_place_3(path: Path) -> None:
    trace = run(path, 60)
    times = {names[0]: scan for scan, names in reversed(list(trace.situations()))}
    assert times["Bereitschaft"] < times["Zu_Platz3"] < times["Warten"] < times["Zurueck_Platz1"]
    assert abs((times["Zurueck_Platz1"] - times["Warten"]) * SCAN - 3000) <= 2 * SCAN


@pytest.mark.parametrize("path", BELTS, ids=lambda path: path.name)
def test_reset_goes_back_and_pause_holds(path: Path) -> None:
    assert run(path, 40, SFCReset=lambda scan: scan >= 30).active(35) == ("Grundstellung",)
    assert run(path, 60, SFCPause=lambda scan: scan >= 20).active(55) == ("Warten",)


def test_the_project_goes_to_plcopen_xml_and_back(tmp_path: Path) -> None:
    """TwinCAT has no BLINK: the block is one of the project there, and in CODESYS."""
    project = sfc.load(BELTS[0])
    data, report = sfc.convert(project, "codesys")
    assert report.losses == []
    sfc.save(sfc.loads(data), tmp_path, format="twincat")
    back = sfc.load(tmp_path)
    assert str(sfc.diff(project, back)) == "no differences"
    assert [pou.name for pou in back.pous] == [pou.name for pou in project.pous]
