"""Cuts the graph of a chart into nested branches: the form in which charts are drawn.

A `Segment` is what stands below each other: steps, transitions, whole branches, a jump at the end. A `Branch` is legs
beside each other, each a segment, that part at the element above it and may meet at the element below it. Every chart
can be cut so, with jumps where it does not nest. What cannot be a jump is a transition that waits for steps of branches
that do not end together: such a transition is *loose*; it is wired straight to its steps.

How it works: the legs of a branch are walked first. Each ends where it comes to something that other ways lead to
as well. Then the branch looks at where its legs ended. What all of them wait for stands below the branch; what some
neighbours wait for closes a nested branch around these; what lies further out is handed to the branch outside;
everything else becomes a jump. (After Ramsey: Beyond Relooper, ICFP 2022.)

Charts nest as deep as they like: walks call each other as generators that `_run` drives, so that Python's stack stays
flat.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass, field

from plcopen_sfc.drawing.flow import Flow, flow_of
from plcopen_sfc.model.sfc import SfcNetwork

_MAX_DEPTH = 100
"""Legs nested deeper than this end in jumps, so that chains of convergences stay short."""


@dataclass(slots=True)
class Place:
    """A step or transition. `loose`: a transition wired straight to its steps."""

    node: int
    loose: bool = False


@dataclass(slots=True)
class Leap:
    """A jump to a step."""

    target: int


@dataclass(slots=True)
class End:
    """Where a segment wants to go on: `target`, and which steps wait there if that is a transition."""

    target: int
    waiting: tuple[int, ...]


@dataclass(slots=True)
class Segment:
    """What stands below each other. `joined`: its end is wired on to what stands below the branch around it."""

    depth: int
    items: list[Place | Leap | Branch] = field(default_factory=list)
    spine: set[int] = field(default_factory=set)
    end: End | None = None
    joined: bool = False


@dataclass(slots=True)
class Branch:
    """Legs beside each other: a selection, or simultaneous sequences."""

    parallel: bool
    legs: list[Segment] = field(default_factory=list)


_Walk = Generator["_Walk", None, None]


def nest(chart: SfcNetwork, together: Mapping[int, int]) -> tuple[Flow, list[Segment]]:
    """The graph of a chart and its segments. `together`: transitions that may share a symbol, see `flow_of`."""
    split: frozenset[int] = frozenset()
    while True:
        flow = flow_of(chart, together, split=split)
        builder = _Builder(flow)
        segments = builder.run()
        if not builder.misfits:
            return flow, segments
        split |= builder.misfits


class _Builder:
    def __init__(self, flow: Flow) -> None:
        self.flow = flow
        self.placed: set[int] = set()
        self.waiting: dict[int, list[Segment]] = {}
        self.misfits: set[int] = set()
        for merges in flow.survey.merges.values():
            merges.sort(key=flow.survey.rank.__getitem__)

    def run(self) -> list[Segment]:
        segments: list[Segment] = []
        for start in self.flow.survey.starts:
            segment = Segment(0)
            segments.append(segment)
            _run(self.walk(segment, start))
            self.give_up(segment)
        for node in sorted(self.flow.survey.rank, key=self.flow.survey.rank.__getitem__):
            if node not in self.placed:
                segment = self.waiting[node][-1]
                if segment.items and isinstance(segment.items[-1], Leap):
                    segment.items.pop()
                _run(self.walk(segment, node))
                self.give_up(segment)
        return segments

    def walk(self, segment: Segment, node: int, waiting: tuple[int, ...] = ()) -> _Walk:
        """Place `node` in `segment`, and what comes below it."""
        flow = self.flow
        while True:
            self.place(segment, node, waiting)
            successors = flow.successors[node]
            if not successors:
                segment.end = None
                return
            if len(successors) == 1:
                segment.end = End(successors[0], (node,))
            else:
                branch = Branch(node in flow.joints)
                segment.items.append(branch)
                for target in successors:
                    leg = Segment(segment.depth + 1)
                    branch.legs.append(leg)
                    if self.enters(node, target):
                        yield self.walk(leg, target, (node,))
                    else:
                        leg.end = End(target, (node,))
                yield self.close(segment, node, branch)
            end = segment.end
            if end is None or end.target in self.placed or flow.survey.dominator[end.target] not in segment.spine:
                return
            node, waiting = end.target, end.waiting

    def enters(self, node: int, target: int) -> bool:
        return (
            target not in self.placed
            and self.flow.survey.dominator[target] == node
            and self.flow.survey.forward_inputs[target] == 1
        )

    def place(self, segment: Segment, node: int, waiting: tuple[int, ...]) -> None:
        self.placed.add(node)
        segment.spine.add(node)
        joint = self.flow.joints.get(node)
        loose = joint is not None and bool(joint.sources) and set(waiting) != set(joint.sources)
        if joint is not None and len(joint.alternatives) > 1 and loose:
            self.misfits.add(node)
        elif joint is not None and len(joint.alternatives) > 1:
            joint.members.sort(key=lambda member: waiting.index(member.sources[0]))
        segment.items.append(Place(node, loose))

    def close(self, segment: Segment, node: int, branch: Branch) -> _Walk:
        """Decide how the legs of the branch below `node` end, and where `segment` goes on."""
        inner = [target for target in self.flow.survey.merges.get(node, ()) if target not in self.placed]
        segment.end = None
        if self.hoist(segment, branch, frozenset(inner)):
            return
        for position, target in enumerate(inner):
            if target in self.placed:
                continue
            group = [i for i, leg in enumerate(branch.legs) if leg.end is not None and leg.end.target == target]
            if not group:
                continue
            later = {other for other in inner[position + 1 :] if other not in self.placed}
            alone = not any(leg.end is not None and leg.end.target in later for leg in branch.legs)
            meets = self.meets(branch, group, target)
            if alone and meets:
                self.join(segment, branch, target)
                return
            if meets and len(group) > 1 and group[-1] - group[0] == len(group) - 1:
                yield self.wrap(branch, group, target)
            else:
                leg = branch.legs[group[-1]]
                waiting = leg.end.waiting if leg.end is not None else ()
                yield self.walk(leg, target, waiting)
        if self.hoist(segment, branch, frozenset()):
            return
        outer = self.outer_target(segment, branch)
        self.join(segment, branch, outer)

    def hoist(self, segment: Segment, branch: Branch, inner: frozenset[int]) -> bool:
        """Draw the way on below the branch instead of in a leg, where only one leg leads to a step.

        Engineers draw an exit so: a leg that is a transition and a jump, beside the transition of the way on. Where the
        exits lead forward, to one of `inner`, they are taken for exits if the way on has branches of its own.
        """
        long = [leg for leg in branch.legs if len(leg.items) > 1]
        if branch.parallel or len(long) != 1 or not all(leg.items for leg in branch.legs):
            return False
        main = long[0]
        if inner and not any(isinstance(item, Branch) for item in main.items):
            return False
        exits = [leg.end.target for leg in branch.legs if leg is not main and leg.end is not None]
        if any(target not in self.placed and target not in inner for target in exits):
            return False
        below = main.items[1]
        if not isinstance(below, Place) or below.node not in self.flow.steps:
            return False
        segment.items += main.items[1:]
        segment.spine |= main.spine
        segment.end = main.end
        del main.items[1:]
        main.end, main.joined = None, True
        for leg in branch.legs:
            if leg is not main:
                self.give_up(leg)
        return True

    def wrap(self, branch: Branch, group: list[int], target: int) -> _Walk:
        """Put neighbouring legs into a branch of their own that ends before `target`."""
        nested = Branch(branch.parallel, branch.legs[group[0] : group[-1] + 1])
        leg = Segment(nested.legs[0].depth, [nested])
        for inside in nested.legs:
            inside.depth += 1
        branch.legs[group[0] : group[-1] + 1] = [leg]
        self.join(leg, nested, target)
        end = leg.end
        yield self.walk(leg, target, end.waiting if end is not None else ())

    def join(self, segment: Segment, branch: Branch, target: int | None) -> None:
        """Let the legs that wait for `target` meet there; the others end."""
        waiting: list[int] = []
        for leg in branch.legs:
            if leg.end is not None and leg.end.target == target and leg.items:
                leg.joined = True
                waiting += leg.end.waiting
            else:
                self.give_up(leg)
        if target is not None:
            segment.end = End(target, tuple(waiting))

    def give_up(self, segment: Segment) -> None:
        """End a segment with a jump to where it wants to go; to a transition there is no jump."""
        end, segment.end = segment.end, None
        if end is not None:
            if end.target not in self.placed:
                self.waiting.setdefault(end.target, []).append(segment)
            if end.target in self.flow.steps:
                segment.items.append(Leap(end.target))

    def meets(self, branch: Branch, group: list[int], target: int) -> bool:
        """Whether the legs of `group` may meet in a convergence before `target`."""
        joint = self.flow.joints.get(target)
        if not all(branch.legs[i].items for i in group):
            return False
        if joint is None:
            return not branch.parallel
        if not branch.parallel:
            return len(joint.alternatives) > 1 or len(group) == 1
        waiting = {step for i in group for step in _waiting(branch.legs[i])}
        return len(joint.alternatives) == 1 and waiting == set(joint.sources)

    def outer_target(self, segment: Segment, branch: Branch) -> int | None:
        """What the branch outside shall see as the way on."""
        if segment.depth > _MAX_DEPTH:
            return None
        groups: dict[int, list[int]] = {}
        for i, leg in enumerate(branch.legs):
            if leg.end is not None and leg.items:
                groups.setdefault(leg.end.target, []).append(i)
        if branch.parallel:
            target = next(iter(groups), None)
            whole = target is not None and sum(map(len, groups.values())) == len(branch.legs) == len(groups[target])
            joint = self.flow.joints.get(target) if target is not None else None
            return target if whole and joint is not None and len(joint.alternatives) == 1 else None
        rank = self.flow.survey.rank
        best: tuple[bool, int, int] | None = None
        found: int | None = None
        for target, group in groups.items():
            joint = self.flow.joints.get(target)
            if joint is not None and len(joint.alternatives) == 1 and len(group) > 1:
                continue
            behind = target in self.placed
            key = (behind, -len(group) if behind else rank[target], -group[-1])
            if best is None or key < best:
                best, found = key, target
        return found


def _waiting(leg: Segment) -> tuple[int, ...]:
    return leg.end.waiting if leg.end is not None else ()


def _run(walk: _Walk) -> None:
    stack = [walk]
    while stack:
        inner = next(stack[-1], None)
        if inner is None:
            stack.pop()
        else:
            stack.append(inner)
