"""Recognition of what has another name in the second project: steps, variables, actions, POUs, types.

A step is found again by its place in the flow and what it does, a variable by its type and its uses, everything else by
what is in it. The result is a table for `plcopen_sfc.refactor.rename`: with the new names in the first project, what
still differs are changes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from difflib import SequenceMatcher
from typing import NamedTuple

from plcopen_sfc.comparison.tree_comparison import matched_transitions
from plcopen_sfc.conversion.executed_parts import STORED, Key, Part
from plcopen_sfc.conversion.execution_differences import ends
from plcopen_sfc.conversion.meaning import Meaning
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.model.pou import NamedTransition
from plcopen_sfc.model.project import Project
from plcopen_sfc.object_path import ObjectPath


class Renaming(NamedTuple):
    """A part of the first project and the same part of the second, which has another name."""

    kind: str
    old: Part
    new: Part


_OUTER = ("POU", "type")
_LISTS = ("list of global variables", "data block")
_MEMBERS = ("global variable", "variable", "member", "action of the POU", "named transition")
_CHARTS = frozenset({"chart", "partial chart", "macro-step"})
_ENOUGH = 0.5
"""Share of a thing that must be the same."""
_ALIKE = 0.6
"""Likeness of two names that is enough where there is nothing else to know a thing by (ratio of `difflib`, 0 to 1)."""


def renamed_outer(left: Part, right: Part) -> Iterator[Renaming]:
    """POUs and data types by what is in them; lists of global variables and data blocks by what they declare."""
    for kind in _OUTER:
        yield from _best(kind, left, right, _likeness)
    for kind in _LISTS:
        yield from _best(kind, left, right, _overlap)


def renamed_steps(left: Part, right: Part) -> Iterator[Renaming]:
    """Steps, in every chart, by their places in the flow and what they do."""
    for key, part, other in _pairs(left, right):
        if key.kind in _CHARTS:
            yield from _surest_walk(part, other).renamed


def renamed_transitions(left: Part, right: Part) -> Iterator[Renaming]:
    """Transitions with names, in every chart, by their ends."""
    for key, part, other in _pairs(left, right):
        for old, new in matched_transitions(part, other).items() if key.kind in _CHARTS else ():
            names = {side.subject.name.casefold() for side in (part.parts[old], other.parts[new]) if side.subject}
            if len(names) == 2 and "" not in names:
                yield Renaming("transition", part.parts[old], other.parts[new])


def renamed_members(projects: tuple[Project, Project], left: Part, right: Part) -> Iterator[Renaming]:
    """Yield variables, members of types, actions and named transitions by their types, programs and uses."""
    uses: list[dict[int, Counter[str]]] = []

    def likeness(one: Part, other: Part) -> float:
        if not uses:
            uses.extend(map(_uses, projects))
        if not _same(one.aspects.get("type"), other.aspects.get("type")):
            return 0
        if "code" in one.aspects and _same(one.aspects["code"], other.aspects.get("code")):
            return 1
        mine, theirs = (
            counted.get(id(part.subject), Counter()) for counted, part in zip(uses, (one, other), strict=True)
        )
        # what is used at the same places is the same thing, whatever its name
        if mine or theirs:
            return (mine & theirs).total() / (mine | theirs).total()
        before, after = (ObjectPath.of(part.path).last for part in (one, other))
        alike = SequenceMatcher(None, before, after).ratio()
        return alike if alike >= _ALIKE and _likeness(one, other) == 1 else 0

    for _, part, other in _pairs(left, right):
        for kind in _MEMBERS:
            yield from _best(kind, part, other, likeness)


def _uses(project: Project) -> dict[int, Counter[str]]:
    """Return the places where each thing is used, by the id of its object; those of actions by their steps.

    What a named transition uses is used where that is named: it may have been extracted, or put in its place.
    """
    found: dict[int, Counter[str]] = {}
    inside: list[tuple[int, int, str]] = []
    for occurrence in Names(project).everything:
        declaration = occurrence.meaning.declaration
        path = ObjectPath.of(occurrence.text_site.report_path).parts
        # what a step does has the name of what is renamed in its path
        end = next((number for number, part in enumerate(path, start=1) if part.startswith("step ")), len(path))
        place, named = ObjectPath(*path[:end]).casefold(), occurrence.text_site.site.transition
        for holder in declaration.holders if declaration is not None else ():
            if isinstance(named, NamedTransition):
                inside.append((id(holder), id(named), place))
            else:
                found.setdefault(id(holder), Counter())[place] += 1
    for holder_id, named_id, place in inside:
        found.setdefault(holder_id, Counter()).update(found.get(named_id) or {place: 1})
    return found


def _pairs(left: Part, right: Part, key: Key | None = None) -> Iterator[tuple[Key, Part, Part]]:
    """Yield the parts that have the same name on both sides, from the whole inwards."""
    yield key or Key("project", ""), left, right
    for inner, part in left.parts.items():
        if inner in right.parts and inner.kind != "transition":
            yield from _pairs(part, right.parts[inner], inner)


def _unmatched(left: Part, right: Part, kind: str) -> tuple[list[Part], list[Part]]:
    """Return the parts of a kind that only one side has, where both have some and they can be renamed."""
    sides = [
        [part for key, part in side.parts.items() if key.kind == kind and key not in other.parts and part.subject]
        for side, other in ((left, right), (right, left))
    ]
    return (sides[0], sides[1]) if all(sides) else ([], [])


def _best(kind: str, left: Part, right: Part, likeness: Callable[[Part, Part], float]) -> Iterator[Renaming]:
    """Yield the pairs that are most alike, each part in one of them."""
    mine, others = _unmatched(left, right, kind)
    # each part gets its surest partner, not the best sum: two doubtful pairs must not break a sure one
    rated = [(likeness(one, other), one, other) for one in mine for other in others]
    taken: set[int] = set()
    for rate, one, other in sorted(rated, key=lambda each: -each[0]):
        if rate >= _ENOUGH and not taken & {id(one), id(other)}:
            taken |= {id(one), id(other)}
            yield Renaming(kind, one, other)


def _likeness(left: Part, right: Part) -> float:
    """Return how much of two parts is the same: of their aspects, and of the names in them."""
    if not _same(left.aspects.get("kind"), right.aspects.get("kind")):
        return 0
    aspects = {name for part in (left, right) for name in part.aspects if _counts(name)}
    inner = left.parts.keys() | right.parts.keys()
    same: float = sum(_same(left.aspects.get(name), right.aspects.get(name)) for name in aspects)
    both = left.parts.keys() & right.parts.keys()
    same += sum(0.5 + _likeness(left.parts[key], right.parts[key]) / 2 for key in both)
    return same / (len(aspects) + len(inner)) if aspects or inner else 1


def _overlap(left: Part, right: Part) -> float:
    """Return how many of the variables of two lists are the same."""
    one, other = (part.aspects["variables"].raw for part in (left, right))
    if not isinstance(one, frozenset) or not isinstance(other, frozenset) or not one | other:
        return 0
    return len(one & other) / len(one | other)


def _counts(aspect: str) -> bool:
    return aspect not in ("initial", "order of transitions", "number", "final scan") and not aspect.startswith(STORED)


def _same(left: Meaning | None, right: Meaning | None) -> bool:
    """True if both are written the same or have the same normal form: no proof, this is asked of many pairs."""
    if left is None or right is None:
        return left is right
    return left.raw == right.raw or left.form() == right.form()


def _surest_walk(left: Part, right: Part) -> _Walk:
    """Return the walk through two charts in which more is the same: steps of one name are one, or need not be.

    Who numbers steps by tens gives the first one the name that the tenth had.
    """
    by_name = _Walk(left, right)
    is_doubtful = any(by_name.rate(name, name) < _ENOUGH for name in by_name.steps[0].keys() & by_name.steps[1].keys())
    return max(by_name, _Walk(left, right, by_name=False), key=lambda walk: walk.same) if is_doubtful else by_name


class _Walk:
    """A walk through two charts at once, from the steps that both have and from those that begin them.

    `met` are the steps of the first chart that are found in the second one. With `by_name` those are whose names both
    have, whatever they do.
    """

    def __init__(self, left: Part, right: Part, *, by_name: bool = True) -> None:
        self.sides = left, right
        self.edges = _edges(left), _edges(right)
        steps = [{key.name: part for key, part in side.parts.items() if key.kind == "step"} for side in self.sides]
        self.steps = steps[0], steps[1]
        self.met = {name: name for name in self.steps[0] if name in self.steps[1]} if by_name else {}
        self._contents: dict[tuple[str, str], float] = {}
        self._go()

    @property
    def renamed(self) -> Iterator[Renaming]:
        """The steps that are met at the same place, do the same and have another name."""
        for one in (name for name in self.steps[0] if self.met.get(name, name) != name):
            yield Renaming("step", self.steps[0][one], self.steps[1][self.met[one]])

    @property
    def same(self) -> float:
        """The share of the steps met that is the same."""
        return sum(self.rate(*pair) for pair in self.met.items())

    def _go(self) -> None:
        left, right = ([name for name in side if name not in self.met] for side in self.steps)
        found: dict[str, str] = {}
        if not left or not right:
            return
        starts = [
            [name for name in names if steps[name].aspects["initial"].raw is True]
            for names, steps in zip((left, right), self.steps, strict=True)
        ]
        for names, own, side in zip(starts, (left, right), self.sides, strict=True):
            names += [name for name in own if _same(side.aspects.get("entry step"), Meaning.of(name))]
        near = [(one, other) for one in starts[0] for other in starts[1]]
        near += [pair for name in list(self.met) for pair in self._beside(name)]
        # The surest pairs first, and the pairs beside them next: a sequence of renamed steps is recognised from its
        # ends inwards. Rating all pairs of two charts at once would pair similar steps of different branches.
        while near:
            rated = [(self.rate(*pair), pair) for pair in dict.fromkeys(near)]
            best = max(rate for rate, _ in rated)
            if best < _ENOUGH:
                break
            for rate, (one, other) in rated:
                if rate == best and one not in found and other not in found.values():
                    self.met[one] = found[one] = other
                    near += self._beside(one)
            near = [pair for pair in near if pair[0] not in found and pair[1] not in found.values()]

    def _beside(self, name: str) -> Iterator[tuple[str, str]]:
        """Pairs of steps that are not met yet, next to a step that is."""
        taken = set(self.met.values())
        for direction in (0, 1):
            mine = [step for step, _ in self.edges[0][direction].get(name, ()) if step not in self.met]
            others = [step for step, _ in self.edges[1][direction].get(self.met[name], ()) if step not in taken]
            known = [(one, other) for one in mine for other in others]
            yield from (pair for pair in known if pair[0] in self.steps[0] and pair[1] in self.steps[1])

    def rate(self, one: str, other: str) -> float:
        """Return how much of the place and of the content of two steps is the same; 0: one of both is another."""
        place, ways = 0.0, 0.0
        for direction in (0, 1):
            mine, theirs = (edges[direction].get(n, []) for edges, n in zip(self.edges, (one, other), strict=True))
            ways += max(len(mine), len(theirs))
            free = list(theirs)
            for step, condition in mine:
                met = self.met.get(step)
                fits = [each for each in free if each[0] == met or (met is None and each[0] not in self.met.values())]
                best = next((each for each in fits if _same(each[1], condition)), fits[0] if fits else None)
                if best is not None:
                    free.remove(best)
                    place += 1 if _same(best[1], condition) else 0.6
        if (one, other) not in self._contents:
            self._contents[one, other] = _likeness(self.steps[0][one], self.steps[1][other])
        content = self._contents[one, other]
        is_initial = _same(*(side[n].aspects["initial"] for side, n in zip(self.steps, (one, other), strict=True)))
        where = place / ways if ways else 1
        return (where + content) / 2 if where >= _ENOUGH and content >= _LEAST and is_initial else 0


_LEAST = 0.3
"""Share of the content of a step that must be the same at the same place."""

_Edges = tuple[dict[str, list[tuple[str, Meaning | None]]], dict[str, list[tuple[str, Meaning | None]]]]


def _edges(chart: Part) -> _Edges:
    """Return the steps before and after each step, each with the condition between."""
    found: _Edges = ({}, {})
    for key, part in chart.parts.items():
        if key.kind == "transition":
            sources, targets = ends(key)
            for source in sources:
                for target in targets:
                    found[0].setdefault(target, []).append((source, part.aspects.get("condition")))
                    found[1].setdefault(source, []).append((target, part.aspects.get("condition")))
    return found
