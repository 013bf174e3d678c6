"""The variables of steps: since when each one is active, and what programs see of it (``Step1.X``, ``Step1.T``)."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from plcopen_sfc.errors import Location, UnknownBehaviourError
from plcopen_sfc.model.sfc import ActionAssociation, simple_steps
from plcopen_sfc.semantics.charts.graph import step_data
from plcopen_sfc.semantics.net import Net, NetStep, Owner, indexes
from plcopen_sfc.semantics.profile import Profile, ScanOrder, StepVariables
from plcopen_sfc.semantics.programs.runtime_types import BOOL, ELAPSED, INSTANT, Frame, ScalarType, StructureType, Type

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope


class ActionOrigin(NamedTuple):
    """Origin of an action: steps as bits, and the association; None for a step action."""

    steps: int
    association: ActionAssociation | None


class Reached:
    """Steps entered, transitions fired and actions executed, as bits.

    `labels` names the actions, `origins` tells for each of them what executes it. All instances of a chart count
    together.
    """

    __slots__ = ("actions", "labels", "origins", "steps", "transitions")

    def __init__(self) -> None:
        self.steps = 0
        self.transitions = 0
        self.actions = 0
        self.labels: list[str] = []
        self.origins: list[tuple[ActionOrigin, ...]] = []

    def action(self, label: str, origins: Iterable[ActionOrigin]) -> int:
        """Note that there is an action; return its bit."""
        self.labels.append(label)
        self.origins.append(tuple(origins))
        return 1 << len(self.labels) - 1


def override(scope: Scope, name: str, type_: Type) -> int:
    """Return a variable of this type, also where the POU declares the name with an unknown type of the tool."""
    made = scope.layout.add(name, type_)
    made.initial = scope.library.default(type_)
    return made.slot


_STRUCTURE = "SFC_STEP"
X, T, NEXT = 0, 1, 2
"""Slots of the structure of a step."""


@dataclass(frozen=True, slots=True)
class StepName:
    """A name that programs use for a step: of one step, of a macro-step, or of steps of one name in several expansions.

    Several count as active while one of them is.

    `steps` are the bits, `slot` is where its structure is (its BOOL where `flag`), `since` where its start is.
    """

    name: str
    steps: int
    slot: int
    since: int
    flag: bool


class Steps:
    """The steps of a chart in a frame. `times` are the slots of times in the structure of one."""

    def __init__(self, net: Net, scope: Scope, path: str, profile: Profile) -> None:
        self.net = net
        self._path = path
        self.since = tuple(scope.declare(f"{path} {step.path}.since", INSTANT, hidden=True) for step in net.steps)
        has_simple = profile.step_variables is StepVariables.FLAG
        simple = simple_steps([step.step for step in net.steps]) if has_simple else []
        all_simple = has_simple and len(simple) == len(net.steps)
        flags = {step.name.casefold() for step in simple}
        members: Mapping[str, ScalarType] = {"X": BOOL, "T": ELAPSED}
        self.times: tuple[int, ...] = (T,)
        if profile.step_variables is StepVariables.GRAPH:
            members, self.times = step_data.STEP, (T, step_data.U)
        self._announces = profile.order is not ScanOrder.TRANSITIONS_FIRST and not all_simple
        if self._announces:
            members = {**members, "_X": BOOL}
        structure = None if all_simple else scope.structure(_STRUCTURE, members)
        self._has_flags = profile.step_variables is StepVariables.GRAFCET
        self.names = tuple(
            self._declare(scope, name, bits, None if key in flags else structure)
            for key, (name, bits) in net.named().items()
        )
        if self._has_flags:
            self.names += tuple(self._flags(scope))
        self._by_step: list[list[StepName]] = [[] for _ in net.steps]
        for variable in self.names:
            for index in indexes(variable.steps):
                self._by_step[index].append(variable)

    def _declare(self, scope: Scope, name: str, bits: int, structure: StructureType | None) -> StepName:
        """Return the variable of a step.

        Another chart of the POU may have one of the same name; TIA Portal declares steps. The flag of a step of a
        GRAFCET is ``XS2``: a variable ``S2`` is another thing.
        """
        start = self._start_of(scope, name, bits)
        there = scope.lookup(name)
        if there is not None and there.type == BOOL and self._has_flags and structure is not None:
            slot = scope.declare(f"{self._path}: {name}", structure, hidden=True)
            return StepName(name, bits, slot, start, flag=False)
        if there is not None and there.type == BOOL:
            return StepName(name, bits, there.slot, start, flag=True)
        if there is not None and isinstance(there.type, StructureType) and there.type.name == _STRUCTURE:
            return StepName(name, bits, there.slot, start, flag=False)
        return StepName(name, bits, override(scope, name, structure or BOOL), start, flag=structure is None)

    def _start_of(self, scope: Scope, name: str, bits: int) -> int:
        if bits.bit_count() == 1:
            return self.since[bits.bit_length() - 1]
        return scope.declare(f"{self._path} {name}.since", INSTANT, hidden=True)

    def since_of(self, owner: Owner) -> int:
        """Return the slot with the start of a step or macro-step."""
        if isinstance(owner, NetStep):
            return self.since[owner.index]
        name = owner.step.name.casefold()
        return next(each.since for each in self.names if each.name.casefold() == name)

    def _flags(self, scope: Scope) -> Iterator[StepName]:
        for name, bits in self.net.flags.items():
            if scope.lookup(name) is None:
                start = self._start_of(scope, name, bits)
                yield StepName(name, bits, scope.declare(name, BOOL), start, flag=True)

    @property
    def slots(self) -> tuple[int, ...]:
        """The slots of the structures of the steps, in the order of the net. Raises `UnknownBehaviourError`."""
        found = []
        for names in self._by_step:
            slot = next((name.slot for name in names if not name.flag), None)
            if slot is None:
                raise UnknownBehaviourError(
                    f"the step {names[0].name} has the name of a BOOL variable, which S7-GRAPH does not allow",
                    location=Location(path=self._path),
                    hint="Give one of them another name.",
                )
            found.append(slot)
        return tuple(found)

    def change(self, frame: Frame, before: int, situation: int, entered: int, now: int) -> None:
        """Another situation. `entered`: the steps whose time starts again."""
        v = frame.v
        since = self.since
        for index in indexes(before & ~situation):
            v[since[index]] = None
        for index in indexes(entered & situation):
            v[since[index]] = now
        for index in indexes((before ^ situation) | (entered & situation)):
            for name in self._by_step[index]:
                active = situation & name.steps != 0
                if name.flag:
                    v[name.slot] = active
                    continue
                values = v[name.slot].v
                if name.steps & (name.steps - 1):
                    if active and not values[X]:
                        v[name.since] = now
                    elif not active:
                        v[name.since] = None
                values[X] = active
                if self._announces:
                    values[NEXT] = active
                if active:
                    values[T] = now - v[name.since]

    @property
    def starts(self) -> tuple[int, ...]:
        """All slots with the start of something."""
        return (*self.since, *(name.since for name in self.names))

    def timed(self, situation: int) -> tuple[tuple[int, int], ...]:
        """Return where the times of active steps are, and where their starts."""
        found = {
            name.slot: name.since for index in indexes(situation) for name in self._by_step[index] if not name.flag
        }
        return tuple(found.items())

    def announce(self, frame: Frame, situation: int, following: int) -> None:
        """Tell which steps will be active in the next scan (``Step1._x`` of CODESYS)."""
        if not self._announces:
            return
        for index in indexes(situation ^ following):
            for name in self._by_step[index]:
                if not name.flag:
                    frame.v[name.slot].v[NEXT] = following & name.steps != 0

    def restart(self, frame: Frame, situation: int, now: int) -> None:
        """Restart the times of all active steps."""
        self.change(frame, situation, situation, situation, now)


def tick(frame: Frame, timed: tuple[tuple[int, int], ...], now: int) -> None:
    """Bring the times of active steps up to date."""
    v = frame.v
    for slot, since in timed:
        v[slot].v[T] = now - v[since]


def forgetting(
    steps: Steps, anywhere: Container[str], read: Container[str], used: Container[int]
) -> Callable[[Frame, int], None]:
    """See `RunningChart.forgetting`; what is given back gets a frame and the present time.

    `used` are the slots of starts that the chart itself depends on.
    """
    seen = [name for name in steps.names if not name.flag]
    timed = {name.slot for name in seen if name.name.casefold() in read or name.since in used}
    timeless = tuple((name.slot, time) for name in seen if name.slot not in timed for time in steps.times)
    # a macro-step with one step inside has the start of that step
    kept = {name.since for name in seen if name.slot in timed}
    # nothing asks how long ago these were: set to now, situations that differ in that alone are one state of a search
    unread = tuple({name.since for name in seen} - kept)
    # a time that only the conditions behind its step read is asked for while the step is active, and not before
    own = [name.slot for name in seen if name.slot in timed and name.name.casefold() not in anywhere]
    inactive = tuple((slot, time) for slot in own for time in steps.times)

    def forget(frame: Frame, now: int) -> None:
        v = frame.v
        for slot, time in timeless:
            v[slot].v[time] = 0
        for since in unread:
            if v[since] is not None:
                v[since] = now
        for slot, time in inactive:
            values = v[slot].v
            if not values[X]:
                values[time] = 0

    return forget
