"""Numbers of free inputs of which only is known what comparisons with constants have told so far.

A number that nobody keeps needs no values to be tried one after the other: it begins as all that its type can hold, and
each comparison that this does not decide splits it. So a scan that asks `Level > 80` runs twice, however many other
constants the programs compare the level with in other steps.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from typing import NamedTuple, NoReturn

from plcopen_sfc.analysis.domains import GREATEST_REAL, Domain, NotProvableError, Probe, number_of
from plcopen_sfc.semantics.signals import Signal, SignalKind

__all__ = ["KeptError", "Split"]

Choose = Callable[[Sequence[bool]], bool]


class KeptError(Exception):
    """A program keeps a number for later scans, so its values must be tried one by one."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


class _Interval(NamedTuple):
    """The numbers from `least` to `greatest`, without the bounds themselves where they are `open`."""

    least: int | float
    greatest: int | float
    least_open: bool = False
    greatest_open: bool = False

    def __contains__(self, number: object) -> bool:
        if not isinstance(number, int | float):
            return False
        above = number > self.least if self.least_open else number >= self.least
        return above and (number < self.greatest if self.greatest_open else number <= self.greatest)

    def some(self, signal: Signal) -> int | float | None:
        """A number of the type of `signal` in it, near a bound or 0; None if there is none."""
        low, high = self.least, self.greatest
        if signal.kind is not SignalKind.REAL:
            return None if low > high else min(max(0, low), high)
        for candidate in (0.0, low, low + 1, high - 1, low / 2 + high / 2, high):
            number = signal.accept(float(candidate))
            if isinstance(number, float) and number in self:
                return number
        return None


class Split(Probe):
    """A number that may be compared with constants, and put out. `choose` decides what an interval leaves open."""

    __slots__ = ("_choose", "_interval")

    def __init__(self, domain: Domain, choose: Choose) -> None:
        signal = domain.signal
        interval = _Interval(signal.least, signal.greatest)
        if signal.kind is SignalKind.REAL:
            most = GREATEST_REAL if signal.type == "REAL" else sys.float_info.max
            interval = _Interval(-most, most)
        some = interval.some(signal)
        if some is None:
            raise NotProvableError(f"{domain.name} can have no value")
        super().__init__(some, domain)
        self._interval = interval
        self._choose = choose

    def _is_below(self, constant: object, *, inclusive: bool) -> bool:
        """Whether the number is less than the constant, or equal to it where `inclusive`."""
        bound = self._number(constant)
        least, greatest, least_open, greatest_open = self._interval
        if self.domain.signal.kind is not SignalKind.REAL:
            unit = self.domain.signal.unit
            bound = math.floor(bound) // unit * unit if inclusive else (math.ceil(bound) - 1) // unit * unit
            inclusive = True
        if bound > greatest or (bound == greatest and (inclusive or greatest_open)):
            return True
        if bound < least or (bound == least and (least_open or not inclusive)):
            return False
        below = _Interval(least, bound, least_open, not inclusive)
        above = _Interval(bound, greatest, inclusive, greatest_open)
        if self.domain.signal.kind is not SignalKind.REAL:
            above = _Interval(bound + self.domain.signal.unit, greatest)
        some_below, some_above = below.some(self.domain.signal), above.some(self.domain.signal)
        if some_below is None or some_above is None:
            return some_above is None
        answer = self._choose((False, True))
        self._interval = below if answer else above
        self.value = some_below if answer else some_above
        return answer

    def _number(self, constant: object) -> int | float:
        if isinstance(constant, Probe):
            raise NotProvableError(f"{self.domain.name} is compared with {constant.domain.name}")
        number = number_of(self.domain, constant)
        self.domain.note(number)
        return number

    def __lt__(self, other: object) -> bool:
        return other is not self and self._is_below(other, inclusive=False)

    def __le__(self, other: object) -> bool:
        return other is self or self._is_below(other, inclusive=True)

    def __gt__(self, other: object) -> bool:
        return other is not self and not self._is_below(other, inclusive=True)

    def __ge__(self, other: object) -> bool:
        return other is self or not self._is_below(other, inclusive=False)

    def __eq__(self, other: object) -> bool:
        return other is self or (self._is_below(other, inclusive=True) and not self._is_below(other, inclusive=False))

    def __hash__(self) -> NoReturn:
        raise KeptError(self.domain.name)

    def key(self) -> NoReturn:
        """Nothing tells two of them apart in a state."""
        raise KeptError(self.domain.name)
