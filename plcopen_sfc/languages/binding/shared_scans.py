"""Actions of a chart that one scan may execute, and the variables for which their order counts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from itertools import product

from plcopen_sfc.languages.binding.bound_bodies import step_effects
from plcopen_sfc.languages.effects import ANYTHING, Effects, may_change, path_of
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.model.actions import ActionAssociation, Qualifier
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcNetwork, Step

_MOST_SITUATIONS = 2_000
STORING = frozenset({Qualifier.S, Qualifier.SD, Qualifier.DS, Qualifier.SL})
"""Qualifiers of actions that go on when their step is left."""
_LISTED = 3

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
        self._found: dict[int, Effects] = {}
        self._names = {variable.name.casefold(): variable.name for variable in pou.variables()}

    @cached_property
    def situations(self) -> set[frozenset[int]]:
        """The situations that the chart can reach, as far as they are few: ids of steps that are active together."""
        first = frozenset(step.id for step in self._chart.steps if step.initial)
        found, waiting = {first}, [first]
        while waiting and len(found) < _MOST_SITUATIONS:
            situation = waiting.pop()
            for transition in self._chart.transitions:
                if transition.sources and situation.issuperset(transition.sources):
                    following = situation.difference(transition.sources).union(transition.targets)
                    waiting += [following] if following not in found else []
                    found.add(following)
        return found

    def follow(self, left: Step, entered: Step) -> bool:
        """True if a step may become active in the scan in which another one was left."""
        together = left is not entered and self.are_together(left, entered)
        return together or any(left.id in t.sources and entered.id in t.targets for t in self._chart.transitions)

    @cached_property
    def is_parallel(self) -> bool:
        """True if two steps may be active together."""
        starts = sum(step.initial for step in self._chart.steps)
        return starts > 1 or any(len(transition.targets) > 1 for transition in self._chart.transitions)

    def are_together(self, one: Step, other: Step) -> bool:
        """True if two steps may be active together; a step is with itself."""
        if one is other or not self.is_parallel:
            return one is other
        if len(self.situations) >= _MOST_SITUATIONS:
            return True
        return other.id in self._together.get(one.id, ())

    @cached_property
    def _together(self) -> dict[int, set[int]]:
        found: dict[int, set[int]] = {}
        for situation in self.situations:
            for step in situation:
                found.setdefault(step, set()).update(situation)
        return found

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
        forth = (
            first.qualifier is not Qualifier.P1 and second.qualifier is not Qualifier.P0 and self.follow(here, there)
        )
        back = second.qualifier is not Qualifier.P1 and first.qualifier is not Qualifier.P0 and self.follow(there, here)
        return forth or back

    def shared(self, one: Row, other: Row) -> str:
        """Return a variable that one of two actions writes and the other one reads or writes; empty without one."""
        mine, its = self._effects(one), self._effects(other)
        for writes, uses in ((mine.writes, its.reads | its.writes), (its.writes, mine.reads)):
            for path in sorted(writes):
                if may_change(uses, frozenset({path}), frozenset()):
                    named = path or next(iter(sorted(uses)), ("?",))
                    return ".".join([self._names.get(named[0], named[0]), *named[1:]])
        return ""

    def writes(self, row: Row, name: str) -> bool:
        """True if an association may write a variable of this name, with or without what it is in."""
        wanted = tuple(name.casefold().split("."))
        return any(
            path and (path == wanted[: len(path)] or path[:1] == wanted[-1:]) for path in self._effects(row).writes
        )

    def sharing(self, rows: Sequence[Row]) -> list[tuple[Row, Row]]:
        """Return the pairs of rows, both ways round, of which one may write a variable that the other has, too.

        Rows that execute the same action are no pair: charts have thousands of them.
        """
        writers: dict[str, dict[str, list[int]]] = {}
        users: dict[str, dict[str, list[int]]] = {}
        every: dict[str, list[int]] = {}
        for place, row in enumerate(rows):
            action = _called(row).casefold()
            every.setdefault(action, []).append(place)
            effects = self._effects(row)
            for places, paths in ((writers, effects.writes), (users, effects.reads | effects.writes)):
                for name in {name for path in paths for name in path[:2] or ("",)}:  # GVL.x is x too, () is anything
                    places.setdefault(name, {}).setdefault(action, []).append(place)
        found: set[tuple[int, int]] = set()
        for name, writing in writers.items():
            for using in (users.get(name, {}), users.get("", {})) if name else (every,):
                for action, other in product(writing, using):
                    if action != other:
                        found.update(product(writing[action], using[other]))
        both = found | {(other, one) for one, other in found}
        return [(rows[one], rows[other]) for one, other in sorted(both)]

    def _effects(self, row: Row) -> Effects:
        """Return what an association executes, as names tell it: a block changes its instance, a function nothing."""
        _, association = row
        if id(association) not in self._found:
            alone = _ALONE.model_copy(update={"actions": [association]})
            found = step_effects(alone, self._pou, self._dialect)
            own = {path for path in found.calls if path and path[0] in self._names}
            changed = own | {path[:-1] for path in own if len(path) > 1}
            called = {ANYTHING, *found.calls} if found.calls else set()
            if association.target and self._pou.find_action(association.target) is None:
                called.discard(path_of(parse_expression(association.target, self._dialect).tree))  # a global variable
            self._found[id(association)] = Effects(
                found.reads | changed, (found.writes - called) | changed, found.calls
            )
        return self._found[id(association)]


_ALONE = Step(id=0, name="")


def told_orders(scans: SharedScans, rows: Sequence[Row], differ: Callable[[Row, Row], bool], word: str) -> str:
    """Return which of `rows` a target executes before (`word`) or after which others, and the source does not."""
    found: dict[str, None] = {}
    for one, other in scans.sharing(rows):
        names = _called(one), _called(other)
        if one[1] is other[1] or not differ(one, other):
            continue
        if scans.meet(one, other) and (shared := scans.shared(one, other)):
            found[
                f"{names[0]} is executed {word} {names[1]} in one scan, in the source the other way round ({shared})"
            ] = None
    more = f"; and {len(found) - _LISTED} more" if len(found) > _LISTED else ""
    return "; ".join(list(found)[:_LISTED]) + more


def _called(row: Row) -> str:
    step, association = row
    return (association.target or f"an action of {step.name}").replace("#", "").replace('"', "")
