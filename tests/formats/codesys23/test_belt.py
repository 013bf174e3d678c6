"""The distribution belt of the textbook (11.5) in all files of it does what the sections describe.

Quoted by section, in our words: 11.5.1 the task and the chart of simple steps, 11.5.2 the same in IEC steps with a
step behind the initial one, 11.5.3 the flags.
"""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.sfc import simple_steps
from tests.formats.codesys23.test_behaviour import SCAN, Plant
from tests.samples import FIXTURES

FOLDER = FIXTURES / "distribution-belt"
SIMPLE = [FIXTURES / "codesys23" / "distribution_belt.EXP", FOLDER / "simple_steps", FOLDER / "simple_steps.xml"]
IEC = [FOLDER / "iec_steps.EXP", FOLDER / "iec_steps", FOLDER / "iec_steps.xml"]
EVERY = pytest.mark.parametrize("path", [*SIMPLE, *IEC], ids=lambda path: path.name)
LAMP = "Globale_Variablen.H1_Bereit"


def run(path: Path, scans: int, *, swings: int = 2, **inputs: int) -> sfc.Trace:
    """Run the belt; each of `inputs` is TRUE from this scan on."""
    number = {"Globale_Variablen.Auftraege.Anzahl": swings}
    flags = {name: lambda scan, first=first: scan >= first for name, first in inputs.items()}
    project = sfc.load(path)
    return sfc.simulate(
        project, pou="Ablauf", inputs=Plant(**flags), scans=scans, scan_time=f"{SCAN}ms", initial=number
    )


def situations(trace: sfc.Trace) -> list[tuple[int, str]]:
    return [(scan, names[0]) for scan, names in trace.situations()]


@EVERY
@pytest.mark.parametrize("swings", [0, 1, 3])
def test_11_5_1_the_part_waits_three_seconds_and_swings_as_often_as_chosen(path: Path, swings: int) -> None:
    """To place 3 at the push of S1, three seconds' rest, back, the chosen swings, and away to the light barrier."""
    found = situations(run(path, 90 + 30 * swings, swings=swings))
    begin = ["Anfang", "Bereitschaft"] if path in IEC else ["Bereit"]
    swing = ["Pendel_Hin", "Pendel_Zurueck", "Pendel_Zaehlen", "Pruefen"]
    order = [*begin, "Zu_Platz3", "Warten", "Zurueck", "Pruefen", *swing * swings, "Abtransport", *begin]
    assert [name for _, name in found] == order
    first = {name: scan for scan, name in reversed(found)}
    assert abs((first["Zurueck"] - first["Warten"]) * SCAN - 3000) <= 2 * SCAN


@EVERY
def test_11_5_1_the_lamp_tells_that_the_belt_is_ready(path: Path) -> None:
    trace = run(path, 60)
    first = {name: scan for scan, name in reversed(situations(trace))}
    ready = "Bereitschaft" if path in IEC else "Bereit"
    assert trace[LAMP][first[ready]]
    assert not trace[LAMP][first["Warten"]]


@pytest.mark.parametrize("path", IEC, ids=lambda path: path.name)
def test_11_5_2_no_action_at_the_initial_step_and_no_timer_for_the_wait(path: Path) -> None:
    """The initial step takes no association: a step with the transition TRUE follows it. The wait is a qualifier D."""
    project = sfc.load(path)
    chart = project.pou("Ablauf").chart
    assert chart is not None
    (initial,) = chart.initial_steps
    assert initial.actions == []
    assert initial.main_action is None
    assert [each.shown_condition for each in chart.outgoing(initial)] == ["TRUE"]
    assert [(row.qualifier, row.duration) for row in chart.step("Warten").actions] == [(Qualifier.D, "t#3s")]
    assert simple_steps(chart.steps) == []
    assert {"P_Zaehlen", "RESET_Zaehler"} <= {action.name for action in project.pou("Ablauf").actions}


@EVERY
@pytest.mark.parametrize(("flag", "executed"), [("SFCInit", False), ("SFCReset", True)])
def test_11_5_3_flags_set_the_chart_back(path: Path, flag: str, executed: bool) -> None:
    """Both set the chart to its initial step; it is executed with SFCReset only."""
    trace = run(path, 40, **{flag: 20})
    assert trace.active(30) == ("Anfang" if path in IEC else "Bereit",)
    assert trace[LAMP][30] is (executed and path not in IEC)  # the initial step of IEC steps has no action


@EVERY
def test_11_5_3_a_pause_holds_the_chart(path: Path) -> None:
    trace = run(path, 70, SFCPause=16)
    assert trace.active(16) == trace.active(69) == ("Warten",)


@pytest.mark.parametrize("paths", [SIMPLE, IEC], ids=["simple steps", "IEC steps"])
def test_the_files_of_one_kind_are_one_chart(paths: list[Path]) -> None:
    first, *others = [sfc.load(path).pou("Ablauf").chart for path in paths]
    assert first is not None
    one, two = (
        [
            [step.model_dump(exclude={"extension_data"}) for step in chart.steps],
            [each.model_dump(exclude={"extension_data"}) for each in chart.transitions],
        ]
        for chart in others
        if chart is not None and list(chart.labels().values()) == list(first.labels().values())
    )
    assert one == two
