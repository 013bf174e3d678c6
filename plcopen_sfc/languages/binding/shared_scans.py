"""Actions of a chart that one scan may execute, and the variables for which their order counts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from itertools import chain, islice, product

from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding.bound_bodies import actions_by_name, step_effects
from plcopen_sfc.languages.effects import ANYTHING, Effects, may_change, path_of
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.model.actions import STEP_ACTIONS, SWITCHES, Qualifier
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Step
from plcopen_sfc.model.text import local_name

_MOST_SITUATIONS = 2_000
STORING = frozenset({Qualifier.S, Qualifier.SD, Qualifier.DS, Qualifier.SL})
"""Qualifiers of actions that go on when their step is left."""
_LISTED = 3
_MOST_PAIRS = 100_000

Row = tuple[Step, ActionAssociation]
"""An association and its step. That of an entry or exit action has the qualifier P1 or P0."""


class SharedScans:
    """Pairs of actions of a chart that have a scan and a variable in common.

    Args:
        chart: The steps and transitions that tell which steps are active together, or one right after the other.
        pou: The POU whose actions the associations name.
        dialect: The dialect of their texts.
    """

    def __init__(self, chart: SfcNetwork, pou: Pou, dialect: Dialect) -> None:
        self._chart, self._pou, self._dialect = chart, pou, dialect
        self._actions = actions_by_name(pou)
        self._found: dict[object, Effects] = {}
        self._names = {variable.name.casefold(): variable.name for variable in pou.variables()}

    @cached_property
    def situations(self) -> set[frozenset[int]]:
        """The situations that the chart can reach, as far as they are few: ids of steps that are active together."""
        first = frozenset(step.id for step in self._chart.steps if step.initial)
        found, waiting = {first}, [first]
        leaving = grouped((source, each) for each in self._chart.transitions for source in each.sources[:1])
        while waiting and len(found) < _MOST_SITUATIONS:
            situation = waiting.pop()
            for transition in (each for step in sorted(situation) for each in leaving.get(step, ())):
                if situation.issuperset(transition.sources):
                    following = situation.difference(transition.sources).union(transition.targets)
                    waiting += [following] if following not in found else []
                    found.add(following)
        return found

    def follow(self, left: Step, entered: Step) -> bool:
        """True if a step may become active in the scan in which another one was left."""
        together = left is not entered and self.are_together(left, entered)
        return together or entered.id in self._following.get(left.id, ())

    @cached_property
    def _following(self) -> dict[int, set[int]]:
        pairs = ((source, each.targets) for each in self._chart.transitions for source in each.sources)
        return {source: set(chain.from_iterable(targets)) for source, targets in grouped(pairs).items()}

    @cached_property
    def _preceding(self) -> dict[int, list[int]]:
        return grouped((each, step) for step, following in self._following.items() for each in following)

    @cached_property
    def are_switched(self) -> bool:
        """True if rows switch steps, so that any of them may be active together."""
        return any(row.qualifier in SWITCHES for _, row in self._chart.associations())

    @cached_property
    def is_parallel(self) -> bool:
        """True if two steps may be active together."""
        starts = sum(step.initial for step in self._chart.steps)
        return (
            self.are_switched
            or starts > 1
            or any(len(transition.targets) > 1 for transition in self._chart.transitions)
        )

    @cached_property
    def _is_any(self) -> bool:
        """True if it is not known which steps are active together."""
        return self.are_switched or len(self.situations) >= _MOST_SITUATIONS

    def are_together(self, one: Step, other: Step) -> bool:
        """True if two steps may be active together; a step is with itself."""
        if one is other or not self.is_parallel:
            return one is other
        return self._is_any or other.id in self._together.get(one.id, ())

    @cached_property
    def _together(self) -> dict[int, set[int]]:
        found = grouped((step, situation) for situation in self.situations for step in situation)
        return {step: set(chain.from_iterable(situations)) for step, situations in found.items()}

    def meet(self, one: Row, other: Row) -> bool:
        """True if a scan may execute both associations, the final scan of an action included."""
        (here, first), (there, second) = one, other
        if STORING & {first.qualifier, second.qualifier}:
            return True
        once = {first.qualifier, second.qualifier}
        if here is there and once == {Qualifier.P1, Qualifier.P0}:
            return self.follow(here, here)
        if self.are_together(here, there):
            return True
        return self._may_end_before(one, other) or self._may_end_before(other, one)

    def _may_end_before(self, one: Row, other: Row) -> bool:
        """True if the end of an action may be in the scan in which another one begins."""
        (left, ended), (entered, begun) = one, other
        # P1 has no final scan, and P0 nothing before the end of its own step
        return (
            ended.qualifier is not Qualifier.P1 and begun.qualifier is not Qualifier.P0 and self.follow(left, entered)
        )

    def shared(self, one: Row, other: Row) -> str:
        """Return a variable that one of two actions writes and the other one reads or writes; empty without one."""
        mine, its = self._effects(one), self._effects(other)
        for writes, uses in ((mine.writes, its.reads | its.writes), (its.writes, mine.reads)):
            for path in sorted(writes):
                if may_change(uses, frozenset({path}), frozenset()):
                    named = path or next(filter(None, sorted(uses)), ("?",))  # the empty path is any variable
                    return ".".join([self._names.get(named[0], named[0]), *named[1:]])
        return ""

    def writes(self, row: Row, name: str) -> bool:
        """True if an association may write a variable of this name, with or without what it is in."""
        wanted = tuple(name.casefold().split("."))
        return any(
            path and (path == wanted[: len(path)] or path[:1] == wanted[-1:]) for path in self._effects(row).writes
        )

    def sharing(self, rows: Sequence[Row]) -> tuple[list[tuple[Row, Row]], bool]:
        """Return the pairs of rows, both ways round, of which one may write a variable that the other has, too.

        Rows that execute the same action are no pair, nor are those of steps that are not active together or one
        after the other, unless one of the two goes on: charts have thousands of actions on one variable. True beside
        them: these are all.
        """
        writers: dict[str, _Users] = {}
        users: dict[str, _Users] = {}
        every = _Users()
        for place, row in enumerate(rows):
            action, effects = _called(row).casefold(), self._effects(row)
            every.add(place, row, action)
            for places, paths in ((writers, effects.writes), (users, effects.reads | effects.writes)):
                for name in {name for path in paths for name in path[:2] or ("",)}:  # GVL.x is x too, () is anything
                    places.setdefault(name, _Users()).add(place, row, action)
        meeting = chain.from_iterable(
            self._pairs(rows, writing, using)
            for name, writing in writers.items()
            for using in ((users.get(name, _NO_USERS), users.get("", _NO_USERS)) if name else (every,))
        )
        looked_at = list(islice(meeting, _MOST_PAIRS + 1))
        both = {*looked_at, *((other, one) for one, other in looked_at)}
        return [(rows[one], rows[other]) for one, other in sorted(both)], len(looked_at) <= _MOST_PAIRS

    def _pairs(self, rows: Sequence[Row], writing: _Users, using: _Users) -> Iterator[tuple[int, int]]:
        """Yield the places of rows that may have a scan in common, where they execute different actions."""
        stored = (writing.stored, using.actions), (writing.actions, using.stored)
        for some, others in stored:
            for action, other in product(some, others):
                if action != other:
                    yield from product(some[action], others[other])
        for action, places in writing.actions.items():
            for place in places:
                for step in self.near(rows[place][0].id):
                    for its_place, whose in using.of_step.get(step, ()):
                        if whose != action:
                            yield place, its_place

    def near(self, step: int) -> set[int]:
        """Return the steps that may be active in a scan in which a step is active, or was left, or is entered."""
        if self.is_parallel and self._is_any:
            return {each.id for each in self._chart.steps}
        together = self._together.get(step, set()) if self.is_parallel else set()
        return {step, *together, *self._following.get(step, ()), *self._preceding.get(step, ())}

    def _effects(self, row: Row) -> Effects:
        """Return the effects of an association by its names: a block changes its instance, a function nothing."""
        _, association = row
        names = (association.target, association.duration, association.indicator, association.value)
        known = (association.qualifier, *names) if association.body is None else id(association)
        if known not in self._found:
            alone = _ALONE.model_copy(update={"actions": [association]})
            found = step_effects([alone], self._actions, self._dialect)
            own = {path for path in found.calls if path and path[0] in self._names}
            changed = own | {path[:-1] for path in own if len(path) > 1}
            called = {ANYTHING, *found.calls} if found.calls else set()
            if association.target and local_name(association.target).casefold() not in self._actions:
                called.discard(path_of(parse_expression(association.target, self._dialect).tree))  # a global variable
            self._found[known] = Effects(found.reads | changed, (found.writes - called) | changed, found.calls)
        return self._found[known]


class _Users:
    """Places of rows that have one variable: by action, those that go on when their step is left, and by step."""

    __slots__ = ("actions", "of_step", "stored")

    def __init__(self) -> None:
        self.actions: dict[str, list[int]] = {}
        self.stored: dict[str, list[int]] = {}
        self.of_step: dict[int, list[tuple[int, str]]] = {}

    def add(self, place: int, row: Row, action: str) -> None:
        """Take in a row."""
        step, association = row
        self.actions.setdefault(action, []).append(place)
        self.of_step.setdefault(step.id, []).append((place, action))
        if association.qualifier in STORING:
            self.stored.setdefault(action, []).append(place)


_NO_USERS = _Users()
_ALONE = Step(id=0, name="")


def told_orders(scans: SharedScans, rows: Sequence[Row], differ: Callable[[Row, Row], bool], word: str) -> str:
    """Return which of `rows` a target executes before (`word`) or after which others, and the source does not."""
    pairs, are_all = scans.sharing(rows)
    found = {
        f"{one} is executed {word} {other} in one scan, in the source the other way round ({shared})": None
        for one, other, shared in _in_common(scans, pairs, differ)
    }
    told = [*list(found)[:_LISTED], *([f"and {len(found) - _LISTED} more"] if len(found) > _LISTED else [])]
    if not are_all:
        told.append(f"the orders of {_MOST_PAIRS} pairs of actions were compared, there are more pairs")
    return "; ".join(told)


def _in_common(
    scans: SharedScans, pairs: Iterable[tuple[Row, Row]], differ: Callable[[Row, Row], bool]
) -> Iterator[tuple[str, str, str]]:
    """Yield the names of two actions whose order differs, and a variable for which it counts in one scan."""
    for one, other in pairs:
        if one[1] is other[1] or not differ(one, other) or not scans.meet(one, other):
            continue
        if shared := scans.shared(one, other):
            yield _called(one), _called(other), shared


Place = tuple[int, int, str]
"""The place of an action in a scan of CODESYS: its phase, among step actions that of its step, and its name."""


def place_of_step(number: int) -> Place:
    """Return the place of the main action of a step; `number` is that of the step in its chart."""
    return _PHASES.index(Qualifier.N), number, ""


def place_of_name(name: str) -> Place:
    """Return the place of an association."""
    return len(_PHASES), 0, local_name(name).casefold()


def place_of_use(number: int) -> Place:
    """Return the place of an association in a tool that executes them in the order of their first use."""
    return len(_PHASES), number, ""


def changed_places(
    chart: SfcNetwork, pou: Pou, dialect: Dialect, moved: Callable[[Row], Place | None], *, by_name: bool = True
) -> list[str]:
    """Return why the order of a scan is another one where some actions get other places.

    `moved`: the new place of an action, None for one that keeps its own. `by_name`: a tool executes associations in the
    order of names, after all step actions (CODESYS), others in the order of their first use.
    """
    early = [each for each in step_action_rows(chart) if not each[0].exclude]
    rows = list(chart.associations())
    phases = {id(row): _PHASES.index(row.qualifier) for _, row in early}
    mains = {id(row) for _, row in early if row.qualifier is Qualifier.N}
    places = {step.id: number for number, step in enumerate(chart.steps)}
    used: dict[str, int] = {}
    for number, row in enumerate(rows):
        used.setdefault(_called(row).casefold(), number)

    def place(row: Row) -> Place:
        step, association = row
        if id(association) in phases:
            return phases[id(association)], places[step.id], ""
        return place_of_name(association.target or "") if by_name else place_of_use(used[_called(row).casefold()])

    def differ(one: Row, other: Row) -> bool:
        here, there = moved(one), moved(other)
        if here is None or here == there or (there is not None and places[one[0].id] > places[other[0].id]):
            return False  # of two that are moved the pair is asked for once
        is_main = here[0] < len(_PHASES) or mains & {id(one[1]), id(other[1])}
        if is_main and not scans.are_together(one[0], other[0]):
            return False  # a main action has no final scan
        return (place(one) < place(other)) is not (here < (there or place(other)))

    scans = SharedScans(chart, pou, dialect)
    pairs, _ = scans.sharing([each for each in (*rows, *early) if not (each[0].exclude or each[1].exclude)])
    found = dict.fromkeys(_in_common(scans, pairs, differ))
    return [f"{one} and {other} would change places in a scan ({shared})" for one, other, shared in found]


def told_step_actions(
    chart: SfcNetwork,
    pou: Pou,
    dialect: Dialect,
    by_name: Callable[[str], tuple[int, str]] | None = None,
    *,
    exits_first: bool,
) -> str:
    """Return which actions are executed before an entry, main or exit action of a chart of CODESYS in other tools.

    CODESYS executes exit actions before entry actions, these before main actions, and all of them before associations
    and their final scans. Elsewhere they are associations of their steps, and final scans come first. `by_name` gives
    the order of actions in a tool that looks at their names only; others execute them in the order of their first use.
    `exits_first`: those of steps that were left come before all of active steps, as in S7-GRAPH.
    """
    early = [each for each in step_action_rows(chart) if not each[0].exclude]
    if not early:
        return ""
    rows = [(step, row) for step, row in chart.associations() if not (step.exclude or row.exclude)]
    rows = [each for each in rows if each[1].qualifier not in (Qualifier.R, Qualifier.R0)]
    scans, phases = SharedScans(chart, pou, dialect), {id(row): _PHASES.index(row.qualifier) for _, row in early}
    places = {step.id: number for number, step in enumerate(chart.steps)}
    used: dict[str | int, int] = {}

    def key(row: Row) -> str | int:  # a step action that is used elsewhere becomes statements of its own
        return id(row[1]) if id(row[1]) in phases else _called(row).casefold()

    def in_step(row: Row) -> tuple[int, int]:
        _, association = row
        phase = association.qualifier if id(association) in phases else None
        return places[row[0].id], _IN_STEP.index(phase)

    for number, row in enumerate(sorted([*early, *rows], key=in_step)):
        used.setdefault(key(row), number)

    def differ(one: Row, other: Row) -> bool:
        (here, row), (there, later) = one, other
        mine, its = (phases.get(id(each), len(_PHASES)) for each in (row, later))
        if (mine, places[here.id]) <= (its, places[there.id]) or its == len(_PHASES):
            return False
        is_row = mine == len(_PHASES)
        if is_row and row.qualifier in STORING:
            return True
        is_exit = later.qualifier is Qualifier.P0
        if not is_row and is_exit and exits_first:
            return False
        if not is_row and row.qualifier is Qualifier.N and not is_exit and not scans.are_together(here, there):
            return False  # a main action has no final scan
        if not is_exit or scans.follow(there, here):
            if by_name is None and used[key(one)] < used[key(other)]:
                return True
            if by_name is not None and by_name(row.target or "") < by_name(later.target or ""):
                return True
        is_code = is_row and (row.body is not None or pou.find_action(row.target or "") is not None)
        ends = scans.are_together(here, there) if is_exit else scans.follow(here, there)
        return is_code and ends and row.qualifier not in (Qualifier.P1, Qualifier.P0)

    return told_orders(scans, [*rows, *early], differ, "before")


_PHASES = (Qualifier.P0, Qualifier.P1, Qualifier.N)
"""Step actions of CODESYS in the order in which a scan executes them."""
_IN_STEP = (Qualifier.P1, None, Qualifier.N, Qualifier.P0)
"""The order in which a step is written in other tools: associations (None) among step actions."""


def step_action_rows(chart: SfcNetwork) -> Iterator[Row]:
    """Yield the entry, main and exit actions of the steps as associations."""
    for step in chart.steps:
        for kind, action in step.step_actions.items():
            target, body = (action, None) if isinstance(action, str) else (None, action)
            yield step, ActionAssociation(id=0, qualifier=STEP_ACTIONS[kind], target=target, body=body)


def _called(row: Row) -> str:
    step, association = row
    return (association.target or f"an action of {step.name}").replace("#", "").replace('"', "")
