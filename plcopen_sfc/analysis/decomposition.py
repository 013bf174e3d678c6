"""A comparison divided into parts: what each compared variable depends on, as a search of its own.

The states of what does not depend on each other multiply in one search; in several they add up. Each part is the two
programs without what its variables do not depend on, so all that the programs can do to these variables is searched
there: proofs of all parts are a proof of the whole, and a difference in one is a real one.

A part of a program is left out only where nothing that is looked at can notice: it writes no variable that a kept part
reads, and it cannot end with an error. Variables of the POU count as a whole, others by all the names of their paths:
``GVL.x`` may also be written ``x``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from plcopen_sfc.analysis.domains import Domain
from plcopen_sfc.analysis.number_terms import explore_terms, searches
from plcopen_sfc.analysis.product import RUNS_FOR_A_STATE, Explored, Progress, Search, StopError, advanced, search
from plcopen_sfc.analysis.program_parts import NotDivisibleError, cone, parts_of
from plcopen_sfc.analysis.systems import Observation, ProgramSystem
from plcopen_sfc.model.pou import Pou

_HEAD_START = 2_000
_HEAD_START_FOR_A_VARIABLE = 20
"""Scans that the undivided search gets first: what does not multiply has about as many states as it has variables."""

_SHARE = 4
"""Of so many scans one is given to the parts, as long as the whole may be the first to end."""

_BEFORE_TERMS = 500
"""States of a part that are searched before it is looked whether its numbers matter: a counter takes any number."""

_BUILDING = 3
"""Scans that take as long as making the systems of a part, for each of their variables."""

Pair = tuple[Observation, Observation]
_Built = tuple[ProgramSystem, ProgramSystem, Mapping[str, Domain]]
"""The two systems of a part, and the domains of their inputs."""

Build = Callable[[Pou, Pou, Sequence[Pair]], _Built]
"""Makes a part, the systems of which are compared in some observations."""


@dataclass(frozen=True)
class _Share:
    """Variables that some of the compared values depend on, on both sides."""

    left: frozenset[int]
    right: frozenset[int]
    pairs: tuple[Pair, ...]

    def holds(self, other: _Share) -> bool:
        return other.left <= self.left and other.right <= self.right

    @property
    def size(self) -> int:
        return len(self.left) + len(self.right)


class Division:
    """The parts of a comparison."""

    def __init__(self, pous: Sequence[Callable[[frozenset[int]], Pou]], shares: Sequence[_Share]) -> None:
        self._pous = pous
        self._shares = shares

    def search(self, build: Build, cap: int, look: Callable[[int], str]) -> Search:
        """Search the parts one after the other, each up to `cap` states, small ones first."""
        states = depth = scans = 0
        parts = len(self._shares)
        notes: dict[str, None] = {}
        inputs = None
        failed: list[Explored] = []
        dead = False
        try:
            for share in self._shares:
                left, right = (pou(kept) for pou, kept in zip(self._pous, (share.left, share.right), strict=True))
                part = build(left, right, share.pairs)
                scans += _BUILDING * (part[0].size + part[1].size)
                # once a part differs, the others are searched for a shorter difference only
                shorter = len(inputs) if inputs is not None else None
                around = Progress(scans, depth, states)
                found, scans = yield from _search_part(part, cap, look, shorter=shorter, around=around)
                if found is None:
                    continue
                states += found.states
                depth = max(depth, found.depth)
                notes |= dict.fromkeys(found.notes)
                dead |= found.dead
                if found.inputs is not None:
                    inputs = found.inputs
                elif not found.complete:
                    failed.append(found)
                    # there is no proof any more: others are searched for a difference as long as the whole would be
                    if not found.capped or (inputs is None and scans > max(RUNS_FOR_A_STATE * cap, _HEAD_START)):
                        break
        except StopError as stop:
            return Explored(states, depth, complete=False, reason=str(stop), capped=True, parts=parts)
        if inputs is not None:
            shortest = all(each.depth + 1 >= len(inputs) for each in failed)
            return Explored(states, depth, complete=False, inputs=inputs, shortest=shortest, parts=parts)
        if failed:
            return replace(failed[0], parts=parts)
        return Explored(states, depth, complete=True, notes=tuple(notes), parts=parts, dead=dead)


def _search_part(
    part: _Built, cap: int, look: Callable[[int], str], *, shorter: int | None, around: Progress
) -> Generator[Progress, None, tuple[Explored | None, int]]:
    """Search one part; return what was found, and the scans with those `around` it.

    `shorter`: only a difference of fewer scans is looked for; without one nothing is found.
    """
    left, right, domains = part
    found, scans = None, around.scans
    for number, most in enumerate(searches(left, right, cap, _BEFORE_TERMS)):
        searching = search(left, right, domains, most)
        found, progress = None, Progress(0, 0)
        while found is None and (shorter is None or progress.depth + 1 < shorter):
            try:
                progress = next(searching)
            except StopIteration as end:
                found = end.value
            else:
                yield Progress(scans + progress.scans, progress.depth, around.states + progress.states)
        scans += progress.scans
        if found is None or found.complete or found.inputs is not None or shorter is not None:
            break
        # numbers that were tried value by value may be equal whatever they are
        signals = {name: domain.signal for name, domain in domains.items()}
        proven = explore_terms(left, right, signals, cap, look) if number == 0 else None
        if proven is not None:
            return proven, scans
    return found, scans


def divide(left: ProgramSystem, right: ProgramSystem, pairs: Sequence[Pair]) -> Division | None:
    """Divide a comparison; None where that is not possible, or would leave out nothing."""
    try:
        sides = [parts_of(system.instance) for system in (left, right)]
    except NotDivisibleError:
        return None
    shares: list[_Share] = []
    for pair in pairs:
        kept = []
        for side, system, observation in zip(sides, (left, right), pair, strict=True):
            kept.append(cone(side.parts, _names_of(observation.path).union(*map(_names_of, system.not_followed))))
        shares.append(_Share(kept[0], kept[1], (pair,)))
    # a share inside another is compared with it: its variables are searched there anyway
    joined: list[_Share] = []
    for share in sorted(shares, key=lambda each: -each.size):
        around = next((place for place, each in enumerate(joined) if each.holds(share)), None)
        if around is None:
            joined.append(share)
        else:
            joined[around] = replace(joined[around], pairs=joined[around].pairs + share.pairs)
    if any(len(s.left) == len(sides[0].parts) and len(s.right) == len(sides[1].parts) for s in joined):
        return None
    return Division([side.taken for side in sides], joined[::-1])


def _names_of(path: str) -> set[str]:
    """Return all that may be a name in a path, which may be quoted: ``Q``, ``"my block".x``."""
    key = path.casefold()
    return {key, *re.findall(r"\w+", key), *(part.strip('"#') for part in key.split("."))}


class _Running:
    """A search that is advanced step by step."""

    def __init__(self, searching: Search, look: Callable[[int], str]) -> None:
        self._searching = searching
        self._look = look
        self._before = self._last = 0
        self.found: Explored | None = None

    def advance(self, scans: int | None = None) -> Explored | None:
        """Go on until so many scans were run in all, or to the end; what was found, if it has ended."""
        while self.found is None and (scans is None or self._before + self._last < scans):
            self.found, progress = advanced(self._searching, self._look)
            if progress is None:
                break
            now = progress.scans
            if now < self._last:  # it began again, with more values of inputs
                self._before += self._last
            self._last = now
        return self.found


def race(
    whole: Search,
    size: int,
    divided: Callable[[], Search | None],
    accepted: Callable[[Explored], bool],
    look: Callable[[int], str],
) -> Explored:
    """Search the whole and its parts in turn: whichever has an answer first ends it.

    `size`: how many variables the whole has. `accepted` is True if a difference of the parts is one of the whole.
    `look` tells why the search must end. The result of the whole counts where the parts have none.
    """
    undivided = _Running(whole, look)
    head_start = _HEAD_START + _HEAD_START_FOR_A_VARIABLE * size
    found = undivided.advance(head_start)
    if found is not None and (found.complete or found.inputs is not None):
        return found
    searching = divided()
    if searching is None:
        return undivided.advance() or _never()
    parts = _Running(searching, look)
    # turns that double: both have run about as long when one ends, so it takes no more than some times the faster one
    for limit in _doubling(head_start):
        by_parts = parts.advance(limit // _SHARE if undivided.found is None else None)
        if by_parts is not None and (by_parts.complete or (by_parts.inputs is not None and accepted(by_parts))):
            return by_parts
        found = undivided.advance(2 * limit if by_parts is None else None)
        if found is not None and (by_parts is not None or found.complete or found.inputs is not None):
            return found
    return _never()


def _doubling(number: int) -> Iterator[int]:
    while True:
        yield number
        number *= 2


def _never() -> Explored:
    raise AssertionError("a search has no end")
