"""Work that grows with its input as it should, by counting calls: times tell nothing on a busy machine."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.languages.binding import Row, SharedScans, shared_scans, told_orders
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.pages.report_words import german


def ring(steps: int, qualifier: str = "N") -> sfc.Project:
    """A chart of so many steps in a circle, each with an action of its own, all of which write one variable."""
    numbers = range(steps)
    lines = [
        f"{'INITIAL_' * (not each)}STEP S{each}: A{each}({qualifier}); END_STEP\n"
        f"TRANSITION FROM S{each} TO S{(each + 1) % steps} := a; END_TRANSITION"
        for each in numbers
    ]
    lines += [f"ACTION A{each}: n := n + 1; END_ACTION" for each in numbers]
    head = "PROGRAM Main\nVAR_INPUT a : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR\n"
    return sfc.loads(f"{head}{chr(10).join(lines)}\nEND_PROGRAM\n".encode(), format="iec-text")


def calls_of(operation: Callable[[], object]) -> int:
    """Return the number of Python functions, and of turns of generators, that an operation enters."""
    count = 0

    def profile(_frame: FrameType, event: str, _argument: object) -> None:
        nonlocal count
        count += event == "call"

    before = sys.getprofile()
    sys.setprofile(profile)
    try:
        operation()
    finally:
        sys.setprofile(before)
    return count


def orders(project: sfc.Project) -> tuple[int, str]:
    """Return how many pairs of actions are asked for their order, and what is told of them."""
    asked = 0

    def differ(_one: Row, _other: Row) -> bool:
        nonlocal asked
        asked += 1
        return True

    pou = project.pou("Main")
    assert pou.sfc is not None
    told = told_orders(SharedScans(pou.sfc, pou, Dialect.IEC), list(pou.sfc.associations()), differ, "before")
    return asked, told


@pytest.mark.parametrize("operation", [sfc.check, orders], ids=["check", "orders of actions"])
def test_a_chart_of_twice_the_length_takes_twice_the_work(operation: Callable[[sfc.Project], object]) -> None:
    operation(ring(3))  # what is imported and prepared once
    projects = [ring(steps) for steps in (12, 24, 48)]
    works = [calls_of(lambda project=project: operation(project)) for project in projects]  # type: ignore[misc]
    assert works[2] - works[1] < 2.2 * (works[1] - works[0]), "linear is 2, quadratic is 4"


def test_only_actions_of_neighbouring_steps_are_asked_for_their_order(monkeypatch: pytest.MonkeyPatch) -> None:
    assert [orders(ring(steps))[0] for steps in (10, 20)] == [20, 40]
    stored = ring(8, "S")
    assert orders(stored)[0] == 8 * 7, "they may all meet"
    monkeypatch.setattr(shared_scans, "_MOST_PAIRS", 20)
    told = orders(stored)[1].split("; ")
    assert told[-1] == "the orders of 20 pairs of actions were compared, there are more pairs"
    assert german("; ".join(told)).endswith(
        "; die Reihenfolgen von 20 Paaren von Aktionen wurden verglichen, es gibt mehr Paare"
    )
    assert german("; ".join(told)).startswith("A0 wird in einem Zyklus vor A1 ausgeführt")
