"""Numbers as terms: what is calculated, without knowing any value.

A counter (``n := n + 1``) takes thousands of values, and an input that is calculated with has too many to try. Where
two programs do the same with such a number it need not be known: both sides then have the same term. A comparison of
terms may come out either way, but the same way wherever the same terms are compared in a scan. After the scan every
term that is kept gets a name of its own, equal ones the same: from then on it may be any number. So there are a few
states, in which more can happen than really does. A proof there is a proof; a difference may be none.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from operator import itemgetter
from typing import Any

from plcopen_sfc.analysis.domains import Domain, NotProvableError, Symbolic, with_each
from plcopen_sfc.analysis.product import Branching, Explored, InputReader, ended, search
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.semantics.signals import Signal, SignalKind

_NUMBERS = frozenset({SignalKind.INTEGER, SignalKind.REAL, SignalKind.DURATION})
_MOST_ANSWERS = 60
"""Comparisons of terms in a scan; a loop whose end is a term asks without end."""

_LARGEST_TERM = 200
MOST_STATES = 2_000
"""States that are searched with terms."""

Key = tuple[Hashable, ...]
Operator = Callable[["Term", object], "Term"]
_Asked = tuple[tuple[tuple[str, Any], ...], ...]
"""Names and values of the inputs that were asked for in the last scans, the oldest first."""


class Answers:
    """Outcomes of the comparisons of terms in the scan that is run."""

    def __init__(self) -> None:
        self.branching: Branching | None = None

    def of(self, question: Key) -> bool:
        """The answer to a question, the same one in the whole scan."""
        if self.branching is None:
            raise NotProvableError("terms are compared outside of a scan")
        if len(self.branching.answers) > _MOST_ANSWERS:
            raise NotProvableError("too many terms are compared in a scan")
        return self.branching.answer(question)


def _both_ways(operation: str) -> tuple[Operator, Operator]:
    """Return the methods of an operation whose left and whose right operand is a term."""
    return (
        lambda term, other: term.made(operation, term, other),
        lambda term, other: term.made(operation, other, term),
    )


class Term(Symbolic):
    """A number with its calculation. A question that it cannot answer ends the proof."""

    __slots__ = ("_answers", "_key", "_size")

    def __init__(self, key: Key, answers: Answers, size: int = 1) -> None:
        self._key = key
        self._answers = answers
        self._size = size

    def key(self) -> Key:
        """Key of its calculation: equal keys are equal numbers."""
        return self._key

    def _asked(self, question: str, *operands: object) -> bool:
        return self._answers.of((question, *map(_key_of, operands)))

    def __lt__(self, other: object) -> bool:
        return self._asked("<", self, other)

    def __gt__(self, other: object) -> bool:
        return self._asked("<", other, self)

    def __le__(self, other: object) -> bool:
        return self._asked("<=", self, other)

    def __ge__(self, other: object) -> bool:
        return self._asked("<=", other, self)

    def __eq__(self, other: object) -> bool:
        # a = b and b = a are one question: with two answers the sides would differ
        first, second = sorted((_key_of(self), _key_of(other)), key=repr)
        return self._answers.of(("=", first, second))

    def __ne__(self, other: object) -> bool:
        return not self == other

    def made(self, operation: str, *operands: object) -> Term:
        """Return the result of an operation with terms."""
        size = 1 + sum(each._size if isinstance(each, Term) else 1 for each in operands)
        if size > _LARGEST_TERM:
            raise NotProvableError("too much is calculated in a scan")
        return Term((operation, *map(_key_of, operands)), self._answers, size)

    __add__, __radd__ = _both_ways("+")
    __sub__, __rsub__ = _both_ways("-")
    __mul__, __rmul__ = _both_ways("*")
    __and__, __rand__ = _both_ways("&")
    __or__, __ror__ = _both_ways("|")
    __xor__, __rxor__ = _both_ways("^")

    def __neg__(self) -> Term:
        return self.made("neg", self)

    def __abs__(self) -> Term:
        return self.made("abs", self)

    __hash__ = Symbolic.__hash__


def _key_of(value: object) -> Hashable:
    if isinstance(value, Term):
        return value.key()
    if isinstance(value, bool | int | float):
        return type(value).__name__, repr(value)  # 1 and 1.0 are calculated with in different ways, 0.0 and -0.0 too
    raise NotProvableError("a number is used together with what is no number")


class TermDomain(Domain):
    """An input that is any number, the same on both sides."""

    def __init__(self, name: str, signal: Signal, answers: Answers) -> None:
        super().__init__(name, signal)
        self.options = (Term(("input", name), answers),)

    @property
    def is_number(self) -> bool:
        """It has no values to be tried."""
        return False


class _Names:
    """New names for what is kept after a scan, the same for equal numbers of both sides."""

    def __init__(self, answers: Answers) -> None:
        self._answers = answers
        self._known: dict[Hashable, Term] = {}

    def clear(self) -> None:
        self._known = {}

    def of(self, value: object) -> Term:
        key = _key_of(value)
        if key not in self._known:
            self._known[key] = Term(("kept", len(self._known)), self._answers)
        return self._known[key]

    def in_all(self, state: Any) -> Any:
        """Return a state with the terms in it named."""
        return with_each(state, Term, self.of)


class _Lagging:
    """Inputs that one side gets some scans after the other one.

    What the other one has asked for is remembered. Of others it gets any value: nobody knows which was the right one.
    """

    def __init__(self, scans: int) -> None:
        self._scans = scans
        self._asked: _Asked = ()
        self._now: dict[str, Any] = {}

    def reset(self) -> None:
        """Go to the state before the first scan."""
        self._asked, self._now = ((),) * self._scans, {}

    def remembering(self, read: InputReader) -> InputReader:
        """Return how the side that gets them at once reads its inputs in this scan."""
        self._now = now = {}

        def remembered(name: str) -> Any:
            now[name] = value = read(name)
            return value

        return remembered

    def remembered(self, read: InputReader) -> InputReader:
        """Return how the side that gets them later reads its inputs in this scan."""
        then: dict[str, Any] = dict(self._asked[0])
        return lambda name: then[name] if name in then else read(_lagging(name))

    def snapshot(self) -> Any:
        """Return what was asked for in the last scans."""
        return (*self._asked[1:], tuple(sorted(self._now.items(), key=itemgetter(0))))

    def restore(self, snapshot: Any) -> None:
        """Go back to a state."""
        self._asked = snapshot


def _lagging(name: str) -> str:
    return f"{name} some scans before"


class _Abstract:
    """A system in which some variables may have any value at the beginning of each scan.

    `lagging`: inputs that it remembers for the other side, or that this one has remembered where it `is_later`.
    """

    def __init__(
        self,
        system: ProgramSystem,
        numbers: Iterable[str],
        names: _Names,
        lagging: _Lagging | None,
        *,
        first: bool,
        is_later: bool,
    ) -> None:
        self._system = system
        self._cells = [system.instance.cell(name) for name in numbers]
        self._names = names
        self._first = first
        self._lagging, self._is_later = lagging, is_later

    def reset(self) -> None:
        """Go to the state before the first scan."""
        self._system.reset()
        if self._lagging is not None:
            self._lagging.reset()

    def scan(self, read: InputReader, *, first: bool) -> None:
        """Run one scan."""
        if self._lagging is not None:
            read = self._lagging.remembered(read) if self._is_later else self._lagging.remembering(read)
        self._system.scan(read, first=first)

    def observed(self) -> tuple[Any, ...] | None:
        """Return the values to compare, of terms their calculation; None: this scan has no counterpart."""
        found = self._system.observed()
        return None if found is None else tuple([each.key() if isinstance(each, Term) else each for each in found])

    def snapshot(self) -> Any:
        """Return the state; both sides are asked one after the other."""
        if self._first:
            self._names.clear()
        # how a kept number came about is forgotten: the next scan has to be equal whatever it is
        for cells, slot in self._cells:
            if isinstance(cells[slot], Term | int | float):  # else nothing uses it
                cells[slot] = self._names.of(cells[slot])
        asked = () if self._lagging is None else self._lagging.snapshot()
        return self._names.in_all((self._system.snapshot(), asked))

    def restore(self, snapshot: Any) -> None:
        """Go back to a state."""
        state, asked = snapshot
        self._system.restore(state)
        if self._lagging is not None:
            self._lagging.restore(asked)


def _same_numbers(left: ProgramSystem, right: ProgramSystem) -> list[str]:
    """Return the numbers that both have under the same name and of the same type, and that are no inputs."""
    others = {name.casefold(): each for name, each in right.variables.items()}
    return [
        name
        for name, each in left.variables.items()
        if each.signal.kind in _NUMBERS
        and not each.is_input
        and (other := others.get(name.casefold())) is not None
        and not other.is_input
        and other.signal == each.signal
    ]


def searches(left: ProgramSystem, right: ProgramSystem, cap: int, few: int = MOST_STATES) -> tuple[int, ...]:
    """Return the states up to which values are searched: first a few, where a counter may be proven with terms."""
    return (few, cap) if cap > few and _same_numbers(left, right) else (cap,)


def explore_terms(
    left: ProgramSystem,
    right: ProgramSystem,
    signals: Mapping[str, Signal],
    cap: int,
    look: Callable[[int], str] = lambda _: "",
) -> Explored | None:
    """Prove two systems equal whatever the numbers of their inputs, and those that they keep, are.

    None where that is not possible, or there are no numbers: a difference that is found, and an error that both end
    with, may be none.
    """
    lags = [each.lag for each in (left, right) if each.lag is not None]
    if len(lags) < len((left, right)) or all(lags):
        return None
    kept = _same_numbers(left, right)
    unknown = left.unknown or right.unknown
    if unknown and any(lags):
        return None  # their results are those of another scan
    if not kept and not unknown and not any(signal.kind in _NUMBERS for signal in signals.values()):
        return None
    reached = left.reached(), right.reached()
    answers = Answers()
    names = _Names(answers)
    lagging = _Lagging(max(lags)) if any(lags) else None
    given = signals if lagging is None else {**signals, **{_lagging(name): each for name, each in signals.items()}}
    domains = {
        name: TermDomain(name, signal, answers) if signal.kind in _NUMBERS else Domain(name, signal)
        for name, signal in given.items()
    }
    sides = [
        _Abstract(each, kept, names, lagging, first=each is left, is_later=bool(each.lag)) for each in (left, right)
    ]

    def follow(branching: Branching) -> None:
        answers.branching = branching

    def number(question: Hashable) -> Term:
        return Term(("call", question), answers)

    calls = (left.unknown_calls, right.unknown_calls)
    later = [(system, lag) for system, lag in zip((left, right), lags, strict=True) if lag]
    for each in calls:
        each.number = number
    for system, lag in later:  # rather than that what it does waits: so both have the same numbers at one time
        system.delay(begins=lag)
    try:
        found = ended(search(sides[0], sides[1], domains, min(cap, MOST_STATES), follow=follow), look)
    finally:
        for system, lag in later:
            system.delay(kept=lag)
        for each in calls:
            each.number = None
    if found.complete and not found.notes:
        return found
    for system, before in zip((left, right), reached, strict=True):
        system.forget(before)  # what terms reach, numbers may never do
    return None
