"""The action qualifiers of IEC 61131-3 with the times at their borders: one scan before, at, and one after.

A scan takes 10 ms. In ``log`` strings, character n is scan n+1 at n * 10 ms.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from plcopen_sfc.errors import SimulationError, UnknownBehaviourError
from plcopen_sfc.model import ActionAssociation, Expression, Qualifier, SfcNetwork
from plcopen_sfc.semantics.profile import PROFILES
from tests.semantics.charts.rig import Rig, chain

VARIABLES = "c1 c2 c3 Q"


def associated(qualifier: str, duration: str | None = None, *, target: str = "Q", reset: bool = False) -> SfcNetwork:
    """A ring of A, B and C. B is associated with the action; with `reset`, C resets it."""
    chart = chain("A", "B", "C")
    chart.step("B").actions = [
        ActionAssociation(id=1, qualifier=Qualifier(qualifier), target=target, duration=duration)
    ]
    if reset:
        chart.step("C").actions = [ActionAssociation(id=2, qualifier=Qualifier.R, target=target)]
    return chart


def record(rig: Rig, *, stays: int, after: int, path: str = "Q") -> str:
    """`path` while B is active for `stays` scans and C for `after` scans, beginning with the scan that enters B."""
    log = rig.scan(c1=False, c2=False, c3=False).log(path, 1, c1=True)
    if stays > 1:
        log += rig.log(path, stays - 1, c1=False)
    return log + "|" + rig.log(path, 1, c1=False, c2=True) + (rig.log(path, after - 1, c2=False) if after > 1 else "")


@pytest.mark.parametrize(
    ("qualifier", "duration", "stays", "log"),
    [
        ("N", None, 3, "111|000"),
        ("None", None, 3, "111|000"),
        ("S", None, 3, "111|111"),
        ("R", None, 3, "000|000"),
        ("P", None, 3, "100|000"),
        ("P1", None, 3, "100|000"),
        ("P0", None, 3, "000|100"),
        ("P0", None, 1, "0|10"),
        # L: until T or until the step is left, whatever comes first
        ("L", "T#30ms", 2, "11|000"),
        ("L", "T#30ms", 3, "111|000"),
        ("L", "T#30ms", 4, "1110|00"),
        ("L", "T#30ms", 5, "11100|0"),
        ("L", "T#0ms", 2, "00|0"),
        # D: only if the step is still active after T
        ("D", "T#30ms", 3, "000|000"),
        ("D", "T#30ms", 4, "0001|00"),
        ("D", "T#30ms", 5, "00011|0"),
        ("D", "T#0ms", 2, "11|0"),
        # SD: the delay goes on when the step is left
        ("SD", "T#30ms", 2, "00|0111"),
        ("SD", "T#30ms", 3, "000|111"),
        ("SD", "T#30ms", 4, "0001|11"),
        # DS: cancelled when the step is left before T
        ("DS", "T#30ms", 2, "00|0000"),
        ("DS", "T#30ms", 3, "000|000"),
        ("DS", "T#30ms", 4, "0001|11"),
        # SL: goes on when the step is left, never longer than T
        ("SL", "T#30ms", 2, "11|100"),
        ("SL", "T#30ms", 3, "111|00"),
        ("SL", "T#30ms", 4, "1110|00"),
    ],
)
def test_each_qualifier_while_its_step_is_active_and_afterwards(
    qualifier: str, duration: str | None, stays: int, log: str
) -> None:
    rig = Rig(associated(qualifier, duration), variables=VARIABLES)
    assert record(rig, stays=stays, after=len(log) - stays - 1) == log


@pytest.mark.parametrize("qualifier", ["S", "SD", "DS", "SL"])
def test_a_reset_ends_what_is_stored_at_once(qualifier: str) -> None:
    duration = None if qualifier == "S" else "T#1s" if qualifier == "SL" else "T#10ms"
    rig = Rig(associated(qualifier, duration, reset=True), variables=VARIABLES)
    rig.scan().scan(c1=True).scan(2, c1=False)
    assert rig["Q"] is True
    rig.scan(c2=True)
    assert rig["Q"] is False
    assert rig.log("Q", 5, c2=False, c3=False) == "00000"


def test_a_reset_cancels_a_delay_that_is_running() -> None:
    rig = Rig(associated("SD", "T#50ms", reset=True), variables=VARIABLES)
    assert record(rig, stays=2, after=10) == "00|0000000000"


def test_reset_dominates_in_the_same_scan() -> None:
    chart = associated("N")
    chart.step("B").actions.append(ActionAssociation(id=5, qualifier=Qualifier.R, target="Q"))
    assert record(Rig(chart, variables=VARIABLES), stays=3, after=2) == "000|00"


def test_one_control_for_an_action_of_several_steps() -> None:
    """Not one for each step: the value is the OR of all continuous associations, whatever their order."""
    for first, second in (("A", "B"), ("B", "A")):
        chart = chain("A", "B", "C")
        for index, name in enumerate((first, second)):
            chart.step(name).actions = [ActionAssociation(id=index, target="Q")]
        rig = Rig(chart, variables=VARIABLES)
        assert rig.log("Q", 2) == "11"
        assert rig.log("Q", 2, c1=True) == "11"
        assert rig.log("Q", 2, c1=False, c2=True) == "00"


def test_or_of_parallel_steps() -> None:
    chart = SfcNetwork()
    start, left, right = (chart.add_step(name, initial=name == "S") for name in ("S", "L", "R"))
    chart.add_transition(start, [left, right], "c1")
    left.actions = [ActionAssociation(id=1, target="Q")]
    right.actions = [ActionAssociation(id=2, target="Q", condition=Expression(text="c2"))]
    end = chart.add_step("E")
    chart.add_transition(left, end, "c3")
    rig = Rig(chart, variables=VARIABLES)
    rig.scan(2, c1=True)
    assert rig.active == "L R"
    assert rig["Q"] is True
    assert rig.log("Q", 1, c3=True) == "0"
    assert rig.log("Q", 2, c2=True) == "11"
    assert rig.log("Q", 1, c2=False) == "0"


def test_a_limited_action_of_two_neighbours_does_not_start_anew() -> None:
    """The input L stays TRUE from one step to the next: one timer, which goes on."""
    chart = associated("L", "T#40ms")
    chart.step("C").actions = [ActionAssociation(id=9, qualifier=Qualifier.L, target="Q", duration="T#40ms")]
    assert record(Rig(chart, variables=VARIABLES), stays=2, after=4) == "11|1100"


def test_a_limited_action_starts_anew_when_its_step_is_entered_again() -> None:
    rig = Rig(associated("L", "T#20ms"), variables=VARIABLES)
    assert record(rig, stays=3, after=1) == "110|0"
    rig.scan(c3=True).scan(c3=False)
    assert record(rig, stays=3, after=1) == "110|0"


def test_a_stored_limited_action_starts_anew_only_after_a_reset() -> None:
    rig = Rig(associated("SL", "T#20ms"), variables=VARIABLES)
    assert record(rig, stays=3, after=1) == "110|0"
    rig.scan(c3=True).scan(c3=False)
    assert record(rig, stays=3, after=1) == "000|0"
    rig = Rig(associated("SL", "T#20ms", reset=True), variables=VARIABLES)
    assert record(rig, stays=3, after=1) == "110|0"
    rig.scan(c3=True).scan(c3=False)
    assert record(rig, stays=3, after=1) == "110|0"


def test_a_negated_association_acts_while_its_step_is_not_active() -> None:
    chart = associated("N")
    chart.step("B").actions[0].negated = True
    rig = Rig(chart, variables=VARIABLES)
    assert rig.log("Q", 2) == "11"
    assert rig.log("Q", 2, c1=True) == "00"
    assert rig.log("Q", 2, c1=False, c2=True) == "11"


def test_a_negated_step_inverts_all_of_its_associations() -> None:
    chart = associated("N")
    chart.step("B").negated = True
    chart.step("B").actions.append(ActionAssociation(id=5, target="c3", negated=True))
    rig = Rig(chart, variables=VARIABLES).scan()
    assert (rig["Q"], rig["c3"]) == (True, False)
    rig.scan(c1=True)
    assert (rig["Q"], rig["c3"]) == (False, True)


def test_the_time_of_an_action_may_be_a_variable() -> None:
    rig = Rig(associated("L", "wait"), variables=VARIABLES + " wait:TIME")
    rig["wait"] = 20_000_000
    assert record(rig, stays=4, after=1) == "1100|0"


def test_an_action_without_its_time_says_so() -> None:
    rig = Rig(associated("D"), variables=VARIABLES).scan()
    with pytest.raises(SimulationError, match="Q has no time for D"):
        rig.scan(c1=True)


def test_a_body_runs_while_its_action_does_and_once_more() -> None:
    rig = Rig(associated("N", target="Work"), variables="c1 c2 c3 n:INT", actions={"Work": "n := n + 1;"})
    rig.scan().scan(c1=True).scan(2, c1=False)
    assert rig["n"] == 3
    rig.scan(c2=True)
    assert rig["n"] == 4, "the final scan"
    rig.scan(3, c2=False)
    assert rig["n"] == 4


@pytest.mark.parametrize(("qualifier", "runs"), [("N", 3), ("P", 1), ("P1", 1), ("P0", 1), ("S", 5), ("R", 0)])
def test_how_often_a_body_runs_without_a_final_scan(qualifier: str, runs: int) -> None:
    chart = associated(qualifier, target="Work")
    profile = replace(PROFILES["iec"], final_scan=False)
    rig = Rig(chart, profile, variables="c1 c2 c3 n:INT", actions={"Work": "n := n + 1;"})
    rig.scan().scan(c1=True).scan(2, c1=False).scan(c2=True).scan(c2=False)
    assert rig["n"] == runs


@pytest.mark.parametrize(("qualifier", "runs"), [("N", 4), ("P", 2), ("P1", 1), ("P0", 1), ("S", 5), ("R", 0)])
def test_how_often_a_body_runs_with_a_final_scan(qualifier: str, runs: int) -> None:
    rig = Rig(associated(qualifier, target="Work"), variables="c1 c2 c3 n:INT", actions={"Work": "n := n + 1;"})
    rig.scan().scan(c1=True).scan(2, c1=False).scan(c2=True).scan(c2=False)
    assert rig["n"] == runs


def test_a_qualifier_that_nobody_defines_is_refused() -> None:
    rig = Rig(associated("DL", "T#1s"), variables=VARIABLES)
    scans = []
    for _ in range(2):
        with pytest.raises(UnknownBehaviourError, match="iec does not say what the qualifier DL") as error:
            rig.scan()
        scans.append(error.value.scan)
    assert scans[0] is not None
    assert scans[1] == scans[0] + 1


@pytest.mark.parametrize(
    ("qualifier", "duration", "log"),
    [
        ("N", None, "111|000"),
        ("S", None, "111|111"),
        ("P", None, "100|000"),
        ("L", "T#20ms", "110|000"),
        ("D", "T#20ms", "001|000"),
        ("SD", "T#20ms", "001|111"),
        ("SD", "T#40ms", "000|011"),
        ("SD", "T#0ms", "000|000"),
        ("P1", None, "100|000"),
        ("P0", None, "000|100"),
        ("DS", "T#20ms", "001|111"),
        ("DS", "T#40ms", "000|000"),
        ("SL", "T#20ms", "110|000"),
        ("SL", "T#40ms", "111|100"),
        ("SL", "T#0ms", "111|111"),
    ],
)
def test_qualifiers_of_matiec(qualifier: str, duration: str | None, log: str) -> None:
    rig = Rig(associated(qualifier, duration), "matiec", variables=VARIABLES)
    assert record(rig, stays=3, after=3) == log


def test_in_matiec_a_reset_does_not_dominate_what_a_body_is_not_stored_for() -> None:
    """Of a variable it does: it is the last that is written."""
    chart = associated("N")
    chart.step("B").actions.append(ActionAssociation(id=5, qualifier=Qualifier.R, target="Q"))
    assert record(Rig(chart, "matiec", variables=VARIABLES), stays=3, after=2) == "000|00"
    rig = Rig(chart, "matiec", variables=f"{VARIABLES} n:INT", actions={"Q": "n := n + 1;"})
    assert record(rig, stays=3, after=2, path="n") == "123|33"
