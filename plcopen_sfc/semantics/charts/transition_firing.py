"""One evolution: which of the enabled transitions are cleared."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from plcopen_sfc.errors import CompetingTransitionsError
from plcopen_sfc.semantics.net import Competing, Net, NetTransition
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.types import Frame


class Move(NamedTuple):
    """A transition, ready to run: bits of its sources and targets, its own bit, and its condition.

    `numbered`: it has a priority number.
    """

    sources: int
    targets: int
    bit: int
    condition: Callable[[Frame], bool]
    numbered: bool
    path: str


class Cleared(NamedTuple):
    """Effect of one evolution: the steps left and entered, and the transitions cleared."""

    left: int
    entered: int
    transitions: int


NOTHING = Cleared(0, 0, 0)

Choice = Callable[[Frame, Sequence[Move]], Cleared]
"""Which of the enabled transitions are cleared, all of them on the same situation."""


def choice(profile: Profile) -> Choice:
    """How a profile treats competing transitions."""
    if profile.competing is Competing.PRIORITY:
        return _first
    if profile.competing is Competing.ERROR:
        return _exclusive
    return _numbered_first if profile.numbered_first else _all


def watched(move: Move, look: Callable[[Frame], None] | None) -> Move:
    """The transition with something that looks at the variables each time its condition is tested."""
    if look is None:
        return move
    condition = move.condition

    def tested(frame: Frame) -> bool:
        value = condition(frame)
        look(frame)
        return value

    return move._replace(condition=tested)


def testing_order(net: Net) -> tuple[int, ...]:
    """The places of the transitions of a net, by their index, in the list in which matiec tests them.

    It puts one after the other into the list: one with a number before the first that has a greater one, one without
    at the end. So one without a number comes before, or behind, one with a number as they stand in the text.
    """
    charts = {id(transition.chart): transition.chart for transition in net.transitions}
    written = {id(each): number for chart in charts.values() for number, each in enumerate(chart.transitions)}
    tested: list[NetTransition] = []
    for transition in sorted(net.transitions, key=lambda t: written[id(t.transition)]):
        number = transition.transition.priority
        if number is None:
            tested.append(transition)
            continue
        later = (place for place, other in enumerate(tested) if (other.transition.priority or 0) > number)
        tested.insert(next(later, len(tested)), transition)
    places = {transition.index: place for place, transition in enumerate(tested)}
    return tuple(places[index] for index in range(len(net.transitions)))


def _first(frame: Frame, moves: Sequence[Move]) -> Cleared:
    left = entered = transitions = 0
    for sources, targets, bit, condition, _, _ in moves:
        if not sources & left and condition(frame):
            left |= sources
            entered |= targets
            transitions |= bit
    return Cleared(left, entered, transitions) if transitions else NOTHING


def _all(frame: Frame, moves: Sequence[Move]) -> Cleared:
    left = entered = transitions = 0
    for sources, targets, bit, condition, _, _ in moves:
        if condition(frame):
            left |= sources
            entered |= targets
            transitions |= bit
    return Cleared(left, entered, transitions)


def _numbered_first(frame: Frame, moves: Sequence[Move]) -> Cleared:
    left = entered = transitions = locked = 0
    for sources, targets, bit, condition, numbered, _ in moves:
        if not sources & locked and condition(frame):
            left |= sources
            entered |= targets
            transitions |= bit
            if numbered:
                locked |= sources
    return Cleared(left, entered, transitions)


def _exclusive(frame: Frame, moves: Sequence[Move]) -> Cleared:
    left = entered = transitions = 0
    taken: list[Move] = []
    for move in moves:
        if move.condition(frame):
            competitor = next((other for other in taken if other.sources & move.sources), None)
            if competitor is not None:
                raise CompetingTransitionsError(
                    f"the transitions {competitor.path} and {move.path} leave the same step at the same time",
                    transitions=(competitor.path, move.path),
                )
            taken.append(move)
            left |= move.sources
            entered |= move.targets
            transitions |= move.bit
    return Cleared(left, entered, transitions)
