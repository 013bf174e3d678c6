"""The distribution belt in simple steps does what the exercise asks for (textbook of the seeds, 11.5.1 and 11.5.3)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pytest

import plcopen_sfc as sfc
from tests.formats.codesys23.test_reading import BELT

AT_PLACE_3 = 10
AT_THE_END = 15
SCAN = 100  # ms


class Plant:
    """A part on the belt: it moves by one in each scan in which a motor runs."""

    def __init__(self, **inputs: Callable[[int], bool]) -> None:
        self.position = 0
        self.inputs = {"S1_Start": lambda scan: scan == 2, **inputs}

    def __call__(self, scan: int, values: Mapping[str, Any]) -> dict[str, Any]:
        right, left = (values[f"Globale_Variablen.Band_{side}"] for side in ("Rechts", "Links"))
        self.position += int(right) - int(left)
        sensors = {
            "Platz1": self.position <= 0,
            "Platz3": self.position == AT_PLACE_3,
            "Lichtschranke": self.position >= AT_THE_END,
        }
        return sensors | {name: value(scan) for name, value in self.inputs.items()}


def run(scans: int, **inputs: Callable[[int], bool]) -> sfc.Trace:
    return sfc.simulate(sfc.load(BELT), pou="Ablauf", inputs=Plant(**inputs), scans=scans, scan_time=f"{SCAN}ms")


def test_the_part_waits_three_seconds_and_swings_twice() -> None:
    trace = run(150)
    steps = [(scan, names[0]) for scan, names in trace.situations()]
    order = [name for _, name in steps]
    swing = ["Pendel_Hin", "Pendel_Zurueck", "Pendel_Zaehlen", "Pruefen"]
    assert order == ["Bereit", "Zu_Platz3", "Warten", "Zurueck", "Pruefen", *swing, *swing, "Abtransport", "Bereit"]
    times = {name: scan for scan, name in reversed(steps)}
    assert abs((times["Zurueck"] - times["Warten"]) * SCAN - 3000) <= SCAN
    # the lamp shows that the belt is ready
    assert trace["Globale_Variablen.H1_Bereit"][1]
    assert not trace["Globale_Variablen.H1_Bereit"][times["Warten"]]


@pytest.mark.slow
def test_the_belt_does_the_same_in_codesys_v3() -> None:
    belt = sfc.load(BELT)
    data, report = sfc.convert(belt, "codesys", partial=True)
    told = [item.path for item in report.items if item.what == "condition" and "instruction list" in item.why]
    assert told == ["POU Ablauf / transition Bereit -> Zu_Platz3"]
    verdict = sfc.equivalent(
        belt.pou("Ablauf"), sfc.loads(data).pou("Ablauf"), profile=("codesys23", "codesys"), runs=10, cap=2000
    )
    assert verdict.equal, str(verdict)


@pytest.mark.parametrize(("flag", "executed"), [("SFCInit", False), ("SFCReset", True)])
def test_flags_set_the_chart_back(flag: str, executed: bool) -> None:
    """Both lead to the initial step; SFCInit does not execute it, SFCReset does."""
    trace = run(40, **{flag: lambda scan: scan >= 20})
    assert trace.active(30) == ("Bereit",)
    assert trace["Globale_Variablen.H1_Bereit"][30] is executed


def test_a_pause_holds_the_chart() -> None:
    trace = run(60, SFCPause=lambda scan: 16 <= scan < 55)
    assert trace.active(54) == ("Warten",)
    assert trace.active(16) == ("Warten",)


@pytest.mark.parametrize(("last", "lost"), [("7", 0), ("14", 2)])
def test_bits_that_a_controller_counts_in_words_are_other_terminals_elsewhere(last: str, lost: int) -> None:
    declared = f"PROGRAM Main\nVAR\n\tx AT %IX0.{last} : BOOL;\n\ty AT %QX1.2 : BOOL;\nEND_VAR\n"
    project = sfc.loads(f"(* @PATH := '' *)\n{declared}(* @END_DECLARATION := '0' *)\ny := x;\nEND_PROGRAM\n".encode())
    for target in ("codesys", "twincat", "codesys-export"):
        report = sfc.convert(project, target, partial=True).report
        assert len([each for each in report.losses if each.what == "address"]) == lost
