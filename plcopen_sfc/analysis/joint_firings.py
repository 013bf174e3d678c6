"""Situations of a GRAFCET as its conditions have them: all transitions that are true fire at once.

The other searches take conditions as free. Here a condition is decided with the flags of the situation, and with those
of the transitions that fire beside it. Variables may have any value in every evolution, so that too many situations are
found, and never too few.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import reduce
from operator import or_
from typing import Any

from plcopen_sfc.analysis.formulas import Formula, JudgedCondition, negation
from plcopen_sfc.analysis.ruled_situations import RuledSituations
from plcopen_sfc.languages.networks import NetworkExpression
from plcopen_sfc.languages.st import names_of
from plcopen_sfc.semantics.net import Net, NetStep, NetTransition


class JointFirings:
    """Sets of transitions that may fire together in a situation.

    Args:
        formula: With knowledge of the names in conditions, and no terms yet.
        conditions: Those of the transitions of a net, in its order.
        flags: The steps (bits) that the flags in the conditions tell of, by their names in lower case.
        most: Questions to the solver until no more sets are found, some tenths of a millisecond each.
    """

    def __init__(
        self, formula: Formula, conditions: Sequence[NetworkExpression], flags: Mapping[str, int], most: int
    ) -> None:
        read = {
            index: JudgedCondition(each.tree)
            for index, each in enumerate(conditions)
            if each.tree is not None and each.complete and not each.before
        }
        self._formula = formula
        self._terms = dict(zip(read, formula.terms([*read.values()]), strict=True))
        self._flags = {text: flags[text.casefold()] for text in formula.names() if text.casefold() in flags}
        named = [names_of(each.tree) & flags.keys() if each.tree is not None else () for each in conditions]
        self.asked = [reduce(or_, (flags[flag] for flag in each), 0) for each in named]
        """The steps (bits) whose flags each transition reads."""
        self._known: dict[tuple[tuple[int, ...], tuple[int, ...], tuple[bool | None, ...]], bool] = {}
        self.left = most

    def of(self, enabled: Sequence[NetTransition], situation: int, part: int) -> Iterator[tuple[NetTransition, ...]]:
        """Yield sets of enabled transitions that may fire while the others do not. `part`: the steps that are known."""
        values = tuple(bool(situation & bits) if not bits & ~part else None for bits in self._flags.values())
        yield from self._sets(enabled, 0, (), (), values)

    def _sets(
        self,
        enabled: Sequence[NetTransition],
        place: int,
        fired: tuple[int, ...],
        others: tuple[int, ...],
        values: tuple[bool | None, ...],
    ) -> Iterator[tuple[NetTransition, ...]]:
        if self.left < 0 or not self._possible(fired, others, values):
            return
        if place == len(enabled):
            yield tuple(each for each in enabled if each.index in fired)
            return
        index = enabled[place].index
        yield from self._sets(enabled, place + 1, (*fired, index), others, values)
        yield from self._sets(enabled, place + 1, fired, (*others, index), values)

    def _possible(self, fired: tuple[int, ...], others: tuple[int, ...], values: tuple[bool | None, ...]) -> bool:
        key = fired, others, values
        if key not in self._known:
            terms: list[Any] = [self._terms[index] for index in fired if index in self._terms]
            terms += [negation(self._terms[index]) for index in others if index in self._terms]
            self.left -= 1
            known = dict(zip(self._flags, values, strict=True))
            self._known[key] = not self._formula.is_impossible(terms, known)
        return self._known[key]


class ConditionedSituations:
    """Searches of a net with its conditions, each of the charts that decide if some steps are active."""

    def __init__(self, net: Net, firings: JointFirings, cap: int) -> None:
        self._net = net
        self._firings = firings
        self._cap = cap
        self._searches: list[tuple[RuledSituations, bool]] = []

    def apart(self, a: NetStep, b: NetStep) -> bool:
        """Return True if two steps are never active together, whatever the variables are; False if not known."""
        both = a.bit | b.bit
        done = next((each for each in self._searches if not both & ~each[0].part), None)
        if done is None:
            firings = self._firings
            found = RuledSituations(self._net, self._cap, around=both, asked=firings.asked, firings=firings.of)
            done = found, found.complete and firings.left >= 0
            self._searches.append(done)
        found, is_whole = done
        return is_whole and not found.concurrent(a, b)
