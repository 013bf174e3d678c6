"""Soundness of charts of any size: safe, without deadlock, and with every step in use again and again."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum

from plcopen_sfc.analysis.marking import DEFAULT_CAP, marking_graph
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition
from plcopen_sfc.semantics.net import Net, NetStep

_MOST_PRODUCTS = 16
"""A place is taken out if not more transitions than so many take the place of those around it."""

_MOST_COMPARED = 8
"""Places with more transitions than so many are not compared with others: it would cost too much each time."""


@dataclass
class _Place:
    tokens: int
    entering: set[int] = field(default_factory=set)
    leaving: set[int] = field(default_factory=set)


@dataclass
class _Move:
    pre: set[int]
    post: set[int]


class ReducedNet:
    """Rest of a net. Places represent one or more steps each; moves are what is left of transitions."""

    def __init__(self, net: Net, closing: Iterable[tuple[int, int]] = ()) -> None:
        """Reduce `net`. `closing`: transitions that are added to it first, as bits of their sources and targets."""
        self._places = {step.index: _Place(net.initial >> step.index & 1) for step in net.steps}
        self._moves: dict[int, _Move] = {}
        self._equal_moves: dict[tuple[frozenset[int], frozenset[int]], set[int]] = {}
        self._equal_places: dict[tuple[frozenset[int], frozenset[int]], set[int]] = {}
        self._next = 0
        self._waiting = dict.fromkeys(self._places)
        self.unsafe = False
        """True if a place got two tokens: then some step of the net can get two."""
        for transition in net.transitions:
            self._add(set(transition.sources), set(transition.targets))
        for pre, post in closing:
            self._add({i for i in self._places if pre >> i & 1}, {i for i in self._places if post >> i & 1})
        self._reduce()

    @property
    def trivial(self) -> bool:
        """True if nothing is left that could go wrong: no move, and no place without a token."""
        return not self.unsafe and not self._moves and all(place.tokens == 1 for place in self._places.values())

    @property
    def steps(self) -> tuple[int, ...]:
        """The indexes of the steps that are left."""
        return tuple(sorted(self._places))

    def net(self) -> Net:
        """Return the net that is left, its steps named by the indexes of those of the original net."""
        places, moves = sorted(self._places.items()), sorted(self._moves.items())
        chart = SfcNetwork(
            steps=[Step(id=i, name=f"{i}", initial=place.tokens > 0) for i, place in places],
            transitions=[Transition(id=i, sources=sorted(m.pre), targets=sorted(m.post)) for i, m in moves],
        )
        return Net.of(chart)

    # -- the net

    def _add(self, pre: set[int], post: set[int]) -> None:
        key = (frozenset(pre), frozenset(post))
        if self._equal_moves.get(key) or (pre == post and len(pre) == 1):
            # fusion of parallel transitions, elimination of self-loop transitions
            self._touch(pre | post)
            return
        number, self._next = self._next, self._next + 1
        self._moves[number] = _Move(pre, post)
        self._equal_moves.setdefault(key, set()).add(number)
        for i in pre:
            self._unlist(i)
            self._places[i].leaving.add(number)
        for i in post:
            self._unlist(i)
            self._places[i].entering.add(number)
        self._touch(pre | post)

    def _take(self, number: int) -> _Move:
        """Remove a move from the net."""
        move = self._moves.pop(number)
        self._equal_moves[frozenset(move.pre), frozenset(move.post)].discard(number)
        for i in move.pre:
            self._unlist(i)
            self._places[i].leaving.discard(number)
        for i in move.post:
            self._unlist(i)
            self._places[i].entering.discard(number)
        self._touch(move.pre | move.post)
        return move

    def _touch(self, places: Iterable[int]) -> None:
        for i in places:
            if i in self._places:
                self._waiting[i] = None

    def _unlist(self, index: int) -> None:
        place = self._places[index]
        if len(place.entering) + len(place.leaving) <= _MOST_COMPARED:
            self._equal_places.get((frozenset(place.entering), frozenset(place.leaving)), set()).discard(index)

    # -- the rules

    def _reduce(self) -> None:
        rules = (self._drop_self_loop, self._drop_parallel, self._fuse_forward, self._take_out)
        while self._waiting and not self.unsafe:
            index, _ = self._waiting.popitem()
            if index in self._places:
                any(rule(index) for rule in rules)

    def _drop_self_loop(self, index: int) -> bool:
        """A marked place to which every transition gives back its token restricts nothing."""
        place = self._places[index]
        if place.tokens != 1 or place.entering != place.leaving or len(self._places) == 1:
            return False
        if any(len(self._moves[m].pre) == 1 for m in place.leaving):
            return False  # that would become a source transition
        self._remove(index)
        return True

    def _drop_parallel(self, index: int) -> bool:
        """Of places with the same transitions and tokens one is enough."""
        place = self._places[index]
        if len(place.entering) + len(place.leaving) > _MOST_COMPARED or not place.entering or not place.leaving:
            return False
        key = (frozenset(place.entering), frozenset(place.leaving))
        equal = self._equal_places.setdefault(key, set())
        if any(i != index and self._places[i].tokens == place.tokens for i in equal):
            self._remove(index)
            return True
        equal.add(index)
        return False

    def _fuse_forward(self, index: int) -> bool:
        """A token that can do nothing but go on to the next place is as good as there (fusion of series places)."""
        place = self._places[index]
        if len(place.leaving) != 1 or not place.entering:
            return False
        number = next(iter(place.leaving))
        move = self._moves[number]
        # a join lets the token wait for another branch, a fork makes two of it: then it is not as good as there
        if len(move.pre) != 1 or len(move.post) != 1 or number in place.entering:
            return False
        (target,) = move.post
        if place.entering & self._places[target].entering:
            return False  # it would get two tokens at once
        self._take(number)
        # a token that the place has from the start goes on, too; two of them are the proof that a step gets two
        self._places[target].tokens += place.tokens
        place.tokens = 0
        if self._places[target].tokens > 1:
            self.unsafe = True
            return True
        for entering in list(place.entering):
            found = self._take(entering)
            self._add(found.pre, found.post - {index} | {target})
        self._remove(index)
        return True

    def _take_out(self, index: int) -> bool:
        """Each way into an unmarked place is joined with each way out of it, which needs no other token."""
        place = self._places[index]
        products = len(place.entering) * len(place.leaving)
        if place.tokens or not products or place.entering & place.leaving:
            return False
        if products > max(_MOST_PRODUCTS, len(place.entering) + len(place.leaving)):
            return False
        entering = [self._moves[m] for m in place.entering]
        leaving = [self._moves[m] for m in place.leaving]
        # a way out that joins waits for its other token after this one has come; in one move with the way in it would
        # ask for it before, and whatever happens while this one waits would be lost
        if any(len(move.pre) != 1 for move in leaving) or not all(move.post for move in leaving):
            return False
        if any(a.post & b.post for a in entering for b in leaving):
            return False  # a place would get two tokens at once
        for number in [*place.entering, *place.leaving]:
            self._take(number)
        self._remove(index)
        for a in entering:
            for b in leaving:
                self._add(set(a.pre), a.post - {index} | b.post)
        return True

    def _remove(self, index: int) -> None:
        self._unlist(index)
        place = self._places[index]
        for number in place.entering | place.leaving:
            move = self._take(number)
            move.pre.discard(index)
            move.post.discard(index)
            self._add(move.pre, move.post)
        del self._places[index]
        self._waiting.pop(index, None)


class SoundnessProof(StrEnum):
    """Way in which soundness was decided.

    REDUCTION: the net became a single step. MARKINGS: by the markings of what reduction left. NONE: it was not.
    """

    REDUCTION = "reduction"
    MARKINGS = "markings"
    NONE = "none"


@dataclass(frozen=True)
class Soundness:
    """Soundness of a chart whose conditions are free.

    `safe`: no step is entered while it is active. `live`: whatever happens, every transition can be enabled again; so
    there is no deadlock and nothing dead; unknown where the chart is not safe. `way_home`: the initial situation can
    always be reached again. `remaining`: the steps at which the reduction stopped, where something is not built of
    blocks; () where all was reduced.
    """

    safe: Answer
    live: Answer
    way_home: Answer
    proof: SoundnessProof
    remaining: tuple[NetStep, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.safe) and bool(self.live)


def soundness(chart: SfcNetwork | Net, *, restart: bool = False, cap: int = DEFAULT_CAP) -> Soundness:
    """Decide whether a chart is sound, by reduction, and by the markings of what is left (at most about `cap`).

    `restart`: a chart that comes to its end is meant to do so; each step that no transition leaves counts as if one led
    from it to the initial situation. At most one of competing transitions fires (`Competing.PRIORITY`). Rules beyond
    the net (`Net.hierarchy`) are not obeyed.
    """
    net = chart if isinstance(chart, Net) else Net.of(chart)
    ends = [step for step in net.steps if restart and not net.leaving[step.index]]
    with collecting_rarely():  # it would look through the growing net again and again
        reduced = ReducedNet(net, [(step.bit, net.initial) for step in ends])
    if reduced.unsafe:
        return Soundness(Answer.NO, Answer.UNKNOWN, Answer.UNKNOWN, SoundnessProof.REDUCTION)
    if reduced.trivial:
        return Soundness(Answer.YES, Answer.YES, _way_home(net, Answer.YES, Answer.YES), SoundnessProof.REDUCTION)
    graph = marking_graph(reduced.net(), cap=cap)
    remaining = tuple(net.steps[i] for i in reduced.steps)
    if graph.safe is Answer.NO:
        return Soundness(Answer.NO, Answer.UNKNOWN, Answer.UNKNOWN, SoundnessProof.MARKINGS, remaining)
    proof = SoundnessProof.MARKINGS if graph.complete else SoundnessProof.NONE
    return Soundness(graph.safe, graph.live, _way_home(net, graph.safe, graph.live), proof, remaining)


def _way_home(net: Net, safe: Answer, live: Answer) -> Answer:
    """A live and safe net that starts with one step can enter that step again, and then no other one is active.

    If another were, the way from the first marking to this one could be gone again and again, each time with more
    tokens.
    """
    return Answer.YES if safe and live and net.initial.bit_count() == 1 else Answer.UNKNOWN
