"""The values that free inputs can take, as few as tell everything that programs do with them.

A Boolean has two, an enumeration its names. Of a number only a few matter as long as programs do nothing with it but
compare it with constants: one for each constant, and one of each interval between them. Which constants these are shows
when the programs run: they get a `Probe` instead of a number, which answers comparisons and notes what it is compared
with. Anything else that is done with a probe ends the proof (`NotProvableError`).

A number that nothing keeps needs no values to be tried one after the other: it begins as all that its type can hold,
and each comparison that this does not decide splits it. So a scan that asks `Level > 80` runs twice, however many other
constants the programs compare the level with in other steps.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple, NoReturn, TypeVar

from plcopen_sfc.semantics.signals import Signal, SignalKind, Value

GREATEST_REAL = 3.4028234663852886e38
_MOST_CUTS = 24
_MOST_NAMES = 64

S = TypeVar("S")


class NotProvableError(Exception):
    """Programs use an input in a way that no few values can represent."""


class Domain:
    """The values of one input. `grown`: a constant was found since it was last looked at."""

    def __init__(self, name: str, signal: Signal) -> None:
        self.name = name
        self.signal = signal
        self.grown = False
        self._cuts: set[int | float] = set()
        self._is_doubled = False
        self.options: tuple[Any, ...] = self._options()

    @property
    def is_number(self) -> bool:
        """True if its values are probes of numbers."""
        return isinstance(self.options[0], Probe) and not isinstance(self.options[0], Text)

    def cut(self, constant: object) -> None:
        """Note that the input is compared with a constant."""
        self.note(number_of(self, constant))
        if len(self._cuts) > _MOST_CUTS:
            raise NotProvableError(f"{self.name} is compared with more than {_MOST_CUTS} values")

    def note(self, constant: int | float) -> None:
        """Have values on both sides of a constant, unless there are far too many already."""
        # a constant may be between two values of the type (a TIME in milliseconds and T#1.5ms): both matter then
        unit = self.signal.unit
        low = math.floor(constant) // unit * unit
        found = {constant} if self.signal.kind is SignalKind.REAL else {low, low + unit * (low < constant)}
        if found <= self._cuts or len(self._cuts) > _MOST_CUTS:
            return
        self._cuts |= found
        self.options = self._options()
        self.grown = True

    def double(self) -> None:
        """Have two values where one would do for comparisons: copies of it from different scans are told apart."""
        if not self._is_doubled:
            self._is_doubled = True
            self.options = self._options()
            self.grown = True

    def _options(self) -> tuple[Any, ...]:
        match self.signal.kind:
            case SignalKind.BOOL:
                return (False, True)
            case SignalKind.STRING:
                return (Text("", self), Text("A", self)) if self._is_doubled else (Text("", self),)
            case SignalKind.ENUMERATION if 0 < len(self.signal.names) <= _MOST_NAMES:
                return tuple(sorted(self.signal.names))
        return tuple(Probe(value, self) for value in self._numbers())

    def _numbers(self) -> list[int | float]:
        """Return one number for each constant, and one below, between and above them where the type has any; or two."""
        cuts = sorted(self._cuts)
        if not cuts:
            some = (0, self.signal.unit) if self._is_doubled else (0,)
            return sorted({min(max(each, self.signal.least), self.signal.greatest) for each in some})
        if self.signal.kind is SignalKind.REAL:
            most = GREATEST_REAL if self.signal.type == "REAL" else sys.float_info.max
            between = [low / 2 + high / 2 for low, high in pairwise(cuts)]
            below, above = cuts[0] - abs(cuts[0]) - 1, cuts[-1] + abs(cuts[-1]) + 1
            if self._is_doubled:
                between += [low / 4 + high / 4 * 3 for low, high in pairwise(cuts)]
                between += [2 * below, 2 * above]
            inside = (min(max(float(each), -most), most) for each in (below, *cuts, *between, above))
            return sorted({each for each in map(self.signal.accept, inside) if isinstance(each, float)})
        offsets = [self.signal.unit * count for count in range(3 if self._is_doubled else 2)]
        near = {cut + offset for cut in cuts for offset in offsets} | {cuts[0] - offset for offset in offsets}
        near |= {self.signal.least, self.signal.greatest}  # for intervals that a bound of the type cuts off
        return sorted(each for each in near if self.signal.least <= each <= self.signal.greatest)


def number_of(domain: Domain, constant: object) -> int | float:
    """Return the value that an input is compared with, if that is a finite number."""
    if isinstance(constant, bool) or not isinstance(constant, int | float) or constant - constant != 0:
        raise NotProvableError(f"{domain.name} is compared with {constant!r}")
    return constant


class Symbolic:
    """Symbol for a value in a search: whatever depends on the value, or may fail, ends the proof."""

    __slots__ = ()

    def key(self) -> Any:
        """Counterpart in a state that can be hashed: equal keys mean equal values."""
        raise NotImplementedError

    @property
    def misuse(self) -> str:
        """The reason why something cannot be done with it."""
        return "a number that is calculated must be known"


def _refuse(value: Symbolic, *_: object) -> NoReturn:
    raise NotProvableError(value.misuse)


_OPERATIONS = """
    add sub mul truediv floordiv mod pow divmod and or xor lshift rshift
    radd rsub rmul rtruediv rfloordiv rmod rpow rdivmod rand ror rxor rlshift rrshift
    neg pos abs invert bool int float index round trunc floor ceil hash str repr format
"""
for _operation in _OPERATIONS.split():  # a text of it, too, must not be taken for that of a number
    setattr(Symbolic, f"__{_operation}__", _refuse)


class Probe(Symbolic):
    """A number of a free input that may only be compared with constants, stored, and put out."""

    __slots__ = ("domain", "value")

    def __init__(self, value: Any, domain: Domain) -> None:
        self.value = value
        self.domain = domain

    def _compared(self, other: object) -> Any:
        """Return the other side of a comparison as a plain number."""
        if isinstance(other, Probe):
            if other.domain is self.domain:  # one of them may be of an earlier scan, and so less, equal or greater
                raise NotProvableError(f"values of {self.domain.name} are compared with each other")
            raise NotProvableError(f"{self.domain.name} is compared with {other.domain.name}")
        self.domain.cut(other)
        return other

    def __lt__(self, other: object) -> bool:
        return bool(self.value < self._compared(other))

    def __le__(self, other: object) -> bool:
        return bool(self.value <= self._compared(other))

    def __gt__(self, other: object) -> bool:
        return bool(self.value > self._compared(other))

    def __ge__(self, other: object) -> bool:
        return bool(self.value >= self._compared(other))

    def __eq__(self, other: object) -> bool:
        return bool(self.value == self._compared(other))

    __hash__ = Symbolic.__hash__

    def key(self) -> Any:
        """Counterpart in a state that can be hashed."""
        return self.domain.name, self.value

    @property
    def misuse(self) -> str:
        """See `Symbolic.misuse`."""
        return f"{self.domain.name} is used otherwise than in comparisons with constants"


class Text(Probe):
    """A text of a free input: nothing may be done with it at all."""

    __slots__ = ()

    def _compared(self, other: object) -> NoReturn:  # noqa: ARG002
        raise NotProvableError(f"{self.domain.name} is a text")


@dataclass(slots=True, eq=False)
class Unasked:
    """The value of an input at the end of a scan that has not read it: it is only asked for where it matters."""

    name: str
    ask: Callable[[], Any]


def asked(value: Any) -> Any:
    """Return a value, which is asked for if it was not yet."""
    return value.ask() if isinstance(value, Unasked) else value


def plain(value: Any) -> Value:
    """Return the number of a probe; anything else itself."""
    value = asked(value)
    number: Value = value.value if isinstance(value, Probe) else value
    return number


def frozen(state: Any) -> Any:
    """Return a state that can be hashed: symbolic values in it are named."""
    return with_each(state, Symbolic, lambda symbol: symbol.key())


def with_each(state: Any, kind: type[S], change: Callable[[S], Any]) -> Any:
    """Return a state, tuples in each other, with each value of a class changed; parts without one stay as they are."""
    if isinstance(state, kind):
        return change(state)
    if not isinstance(state, tuple):
        return state
    # a state has thousands of numbers and few others: to ask for their types takes a tenth of a call for each
    others = {each for each in set(map(type, state)) if issubclass(each, (kind, tuple))}
    if not others:
        return state
    return tuple([with_each(each, kind, change) if type(each) in others else each for each in state])


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
        """Return a number of the type of `signal` in it, near a bound or 0; None if there is none."""
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
        """Return True if the number is less than the constant, or equal to it where `inclusive`."""
        bound = self._number(constant)
        least, greatest, least_open, greatest_open = self._interval
        if self.domain.signal.kind is not SignalKind.REAL:
            # the greatest value of the type that is below: what is left to ask is whether the number is at most that
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
        # a REAL has gaps: between two bounds that are neighbours there is no number, and nothing is left open
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
