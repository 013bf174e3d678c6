"""The faults that textbook chains have are found, each with the shortest inputs that show it; and no others are."""

from __future__ import annotations

from plcopen_sfc import model as m
from plcopen_sfc.lowering.faults import Fault, FaultKind
from plcopen_sfc.lowering.lower import lower
from tests.lowering.charts import act, pou_with, training_chain


def faults(pou: m.Pou, construction: str, *, init: str | None = None, **options: str) -> dict[FaultKind, Fault]:
    lowered = lower(m.Project(pous=[pou]), construction, style="classic", init=init, **options)
    return {fault.kind: fault for fault in lowered.faults}


def ring(*conditions: str) -> m.Pou:
    """A chain of as many steps as conditions, closed to a ring."""
    chart = m.SfcNetwork()
    steps = [chart.add_step(f"S{number}", initial=number == 1) for number in range(1, len(conditions) + 1)]
    for number, condition in enumerate(conditions):
        chart.add_transition(steps[number], steps[(number + 1) % len(steps)], condition)
    act(chart, steps[0], "Q")
    return pou_with(chart)


def table(fault: Fault) -> list[str]:
    return [" ".join(line.split()) for line in fault.table()]


def test_the_training_chain_as_flip_flops_overlaps_and_runs_through() -> None:
    found = faults(training_chain(), "fup", language="ST")
    assert list(found) == [FaultKind.OVERLAP, FaultKind.RUN_THROUGH]
    overlap, through = found.values()
    assert (overlap.place, overlap.shortest) == (("S1", "S2"), True)
    assert table(overlap) == ["scan | B1 | chart | code", "1 | 1 | S2 | S1 S2"]
    assert (through.place, through.shortest) == (("S1", "S2", "S3"), True)
    assert table(through) == ["scan | B1 B2 | chart | code", "1 | 1 1 | S2 | S1 S2 S3"]


def test_an_init_of_one_scan_empties_the_chain() -> None:
    found = faults(training_chain(), "fup", language="ST", init="Init")[FaultKind.INIT_EMPTIES]
    assert found.place == ("S1", "S2")
    assert table(found) == ["scan | B1 Init | chart | code", "1 | 1 0 | S2 | S1 S2", "2 | 0 1 | S1 | -"]
