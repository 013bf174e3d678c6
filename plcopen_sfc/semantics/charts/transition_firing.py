"""One evolution: which of the enabled transitions are cleared.

Situations are planned before they are executed, once for each situation that a chart gets into. This is what makes a
scan cost as much as there are active steps, however big the chart is.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from plcopen_sfc.errors import CompetingTransitionsError, Location, SimulationError
from plcopen_sfc.model import PouKind
from plcopen_sfc.semantics.charts.sfc_flags import Analysis
from plcopen_sfc.semantics.net import Competing, Net, NetTransition
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime_types import Family, Frame, ScalarType, StructureType

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope

Run = Callable[[Frame], None]
"""Executes a body."""

Write = Callable[[Frame, Any], None]
"""Writes a variable."""


@dataclass(frozen=True, slots=True)
class Watch:
    """A maximum time: the name of the step, the slot of its start, the time, and what keeps the step from ending."""

    step: str
    since: int
    time: Callable[[Frame], int]
    reasons: Analysis


@dataclass(frozen=True, slots=True)
class Plan:
    """A situation: its enabled transitions, times to bring up to date, main actions, and maximum times.

    `forced` are the transitions without their conditions, `current` is the name of the last active step of the chart.
    """

    moves: tuple[Move, ...]
    forced: tuple[Move, ...]
    timed: tuple[tuple[int, int], ...]
    main: tuple[Run, ...]
    watches: tuple[Watch, ...]
    current: str


_Situation = TypeVar("_Situation", bound=Hashable)
_Planned = TypeVar("_Planned")
_MOST_PLANS = 4096
"""Plans that are kept. A chart visits few situations; one with wide parallelism must not fill the memory."""


class Plans(dict[_Situation, _Planned]):
    """What is planned for the situations that were met, each when it is asked for first."""

    def __init__(self, make: Callable[[_Situation], _Planned]) -> None:
        super().__init__()
        self._make = make

    def __missing__(self, situation: _Situation) -> _Planned:
        if len(self) >= _MOST_PLANS:
            self.clear()
        planned = self[situation] = self._make(situation)
        return planned


def execution(target: str, scope: Scope, where: str) -> tuple[Run | None, Write | None]:
    """Return how to execute it, or how to write it: one of both. An undeclared name is a Boolean variable."""
    action = scope.action(target)
    if action is not None:
        return action, None
    try:
        type_ = Routines(scope).type_of(target)
    except SimulationError:  # a member that is no variable: an action of the instance, or nothing that could be called
        return Routines(scope).statements(f"{target}();", where), None
    is_called = isinstance(type_, StructureType) or (type_ is None and _is_program(target, scope))
    if is_called:
        return Routines(scope).statements(f"{target}();", where), None
    if type_ is not None and not (isinstance(type_, ScalarType) and type_.family is Family.BOOL):
        return None, _refusing(f"{target} is of type {type_.name}: only a Boolean variable can be an action", where)
    return None, Routines(scope).setter(target)


def _is_program(target: str, scope: Scope) -> bool:
    key = target.casefold()
    return any(pou.name.casefold() == key and pou.kind is PouKind.PROGRAM for pou in scope.library.project.pous)


def _refusing(message: str, where: str) -> Write:
    def fail(_: Frame, __: Any) -> None:
        raise SimulationError(message, location=Location(path=where))

    return fail


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
"""Choice of the enabled transitions that are cleared, all of them on the same situation."""


def choice(profile: Profile) -> Choice:
    """Return how a profile treats competing transitions."""
    if profile.competing is Competing.PRIORITY:
        return _first
    if profile.competing is Competing.ERROR:
        return _exclusive
    return _numbered_first if profile.numbered_first else _all


def watched(move: Move, look: Callable[[Frame], None] | None) -> Move:
    """Return the transition with something that looks at the variables each time its condition is tested."""
    if look is None:
        return move
    condition = move.condition

    def tested(frame: Frame) -> bool:
        value = condition(frame)
        look(frame)
        return value

    return move._replace(condition=tested)


def testing_order(net: Net) -> tuple[int, ...]:
    """Return the places of the transitions of a net, by their index, in the list in which matiec tests them.

    It puts one after the other into the list: one with a number before the first that has a greater one, one without
    at the end. So one without a number comes before, or behind, one with a number as in the text.
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
            # all see the same situation: one step may be left by several transitions, and a step that is left and
            # entered stays active (IEC 60848, rules 4 and 5); the caller subtracts what is left before it adds what is
            # entered
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
                # only a numbered one resets its sources at once in matiec, so only it hides those that are tested
                # behind it
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
