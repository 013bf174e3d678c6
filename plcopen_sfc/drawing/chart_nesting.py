"""Cuts the graph of a chart into nested branches: the form in which charts are drawn.

A `ChartSegment` is a column of a chart: steps, transitions, whole divergences, a jump at the end. A `NestedDivergence`
holds branches side by side, each a segment, that part at the element above it and may meet at the element below it.
Every chart can be cut so, with jumps where it does not nest. A transition that waits for steps of branches that do not
end together cannot be replaced by a jump: such a transition is *loose*; it is wired straight to its steps.

How it works: the branches of a divergence are walked first. Each ends where it comes to a node that other paths lead to
as well. Then the divergence looks at where its branches ended. A node that all of them wait for goes below the
divergence; one that some neighbours wait for closes a nested divergence around these; one that lies further out is
handed to the divergence outside; everything else becomes a jump. (After Ramsey: Beyond Relooper, ICFP 2022.)

Charts nest as deep as they like: walks call each other as generators that `run_walk` drives, so that Python's stack
stays flat.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass, field

from plcopen_sfc.drawing.drawing_style import same_drawn
from plcopen_sfc.drawing.forward_edges import ForwardEdges, without_entries
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition


@dataclass(slots=True)
class DrawnTransition:
    """A transition as it is drawn: one symbol for all `members`, which differ in nothing but their source step."""

    members: list[Transition]
    alternatives: list[tuple[int, ...]]
    targets: tuple[int, ...]
    sources: tuple[int, ...] = field(init=False)
    """Steps of all alternatives."""

    def __post_init__(self) -> None:
        """Join the alternatives."""
        self.sources = tuple(dict.fromkeys(step for alternative in self.alternatives for step in alternative))


@dataclass(slots=True)
class ChartGraph:
    """Graph: `successors` of every node in the order in which they are drawn, and its forward `edges`."""

    steps: dict[int, Step]
    joints: dict[int, DrawnTransition]
    successors: dict[int, list[int]]
    edges: ForwardEdges


def flow_of(chart: SfcNetwork, together: Mapping[int, int], *, split: frozenset[int] = frozenset()) -> ChartGraph:
    """Return the graph of `chart`.

    `together`: which transitions may share a node, as a group number for each; those in `split` may not.
    """
    steps = {step.id: step for step in chart.steps}
    joints: dict[int, DrawnTransition] = {}
    for group in _groups(chart, together, split):
        first = group[0]
        alternatives = [tuple(dict.fromkeys(i for i in t.sources if i in steps)) for t in group]
        joints[first.id] = DrawnTransition(
            group, alternatives, tuple(dict.fromkeys(i for i in first.targets if i in steps))
        )
    successors: dict[int, list[int]] = {i: [] for i in steps}
    priorities = {i: joint.members[0].priority for i, joint in joints.items()}
    for number, joint in sorted(joints.items(), key=lambda item: _urgency(priorities[item[0]])):
        for source in joint.sources:
            successors[source].append(number)
        successors[number] = list(joint.targets)
    entered = {target for targets in successors.values() for target in targets}
    candidates = [i for i, step in steps.items() if step.initial]
    candidates += [i for i in (*steps, *joints) if i not in entered]
    waiting = {i: joint.sources for i, joint in joints.items() if len(joint.alternatives) == 1}
    jumps = frozenset((t.id, target) for t in chart.jumps_between_sequences() for target in t.targets)
    return ChartGraph(steps, joints, successors, without_entries(successors, candidates, waiting, jumps))


def alike(chart: SfcNetwork) -> dict[int, int]:
    """Neighbours among the transitions that differ in nothing but their source step, as a group number for each."""
    groups: dict[int, int] = {}
    last: Transition | None = None
    for transition in chart.transitions:
        if last is not None and same_but_source(last, transition):
            groups[transition.id] = groups.setdefault(last.id, last.id)
        last = transition
    return groups


def _urgency(priority: int | None) -> tuple[bool, int]:
    return (priority is None, priority or 0)


def _groups(chart: SfcNetwork, together: Mapping[int, int], split: frozenset[int]) -> list[list[Transition]]:
    """Return the transitions, those together that can be one symbol below a convergence of their steps."""
    leaving: dict[int, int] = {}
    for transition in chart.transitions:
        for source in dict.fromkeys(transition.sources):
            leaving[source] = leaving.get(source, 0) + 1
    groups: dict[int, list[Transition]] = {}
    found: list[list[Transition]] = []
    for transition in chart.transitions:
        number = together.get(transition.id)
        group = groups.get(number) if number is not None else None
        if group is not None and group[0].id not in split and same_but_source(group[0], transition):
            taken = {t.sources[0] for t in group}
            lone = all(leaving[t.sources[0]] == 1 for t in (*group, transition))
            if lone and transition.sources[0] not in taken:
                group.append(transition)
                continue
        found.append([transition])
        if number is not None:
            groups.setdefault(number, found[-1])
    return found


def same_but_source(one: Transition, other: Transition) -> bool:
    """True if two transitions with one source each differ in nothing else, so that one symbol can show both."""
    return len(one.sources) == len(other.sources) == 1 and one.targets == other.targets and same_drawn(one, other)


_MAX_DEPTH = 100
"""Branches nested deeper than this end in jumps, so that chains of convergences stay short."""


@dataclass(slots=True)
class NestedNode:
    """A step or transition. `loose`: a transition wired straight to its steps."""

    node: int
    loose: bool = False


@dataclass(slots=True)
class NestedJump:
    """A jump to a step."""

    target: int


@dataclass(slots=True)
class SegmentEnd:
    """The `target` at which a segment wants to go on, and the steps that wait there if it is a transition."""

    target: int
    waiting: tuple[int, ...]


@dataclass(slots=True)
class ChartSegment:
    """A column of a chart. `joined`: its end is wired on to the element below the divergence around it."""

    depth: int
    items: list[NestedNode | NestedJump | NestedDivergence] = field(default_factory=list)
    spine: set[int] = field(default_factory=set)
    end: SegmentEnd | None = None
    joined: bool = False


@dataclass(slots=True)
class NestedDivergence:
    """Branches side by side: a selection, or simultaneous sequences."""

    parallel: bool
    branches: list[ChartSegment] = field(default_factory=list)


Walk = Generator["Walk", None, None]


def nest(
    chart: SfcNetwork, together: Mapping[int, int], *, lines: bool = False
) -> tuple[ChartGraph, list[ChartSegment]]:
    """Return the graph of a chart and its segments. `together`: transitions that may share a symbol, see `flow_of`.

    `lines`: a branch of a selection may be a line to a convergence, with nothing on it; CODESYS draws none.
    """
    split: frozenset[int] = frozenset()
    while True:
        flow = flow_of(chart, together, split=split)
        builder = _Builder(flow, lines=lines)
        segments = builder.run()
        if not builder.misfits:
            return flow, segments
        # one symbol for several transitions needs their steps to meet above it: where they do not, each gets its own
        split |= builder.misfits


class _Builder:
    def __init__(self, flow: ChartGraph, *, lines: bool) -> None:
        self.flow = flow
        self.lines = lines
        self.placed: set[int] = set()
        self.waiting: dict[int, list[ChartSegment]] = {}
        self.misfits: set[int] = set()
        for merges in flow.edges.merges.values():
            merges.sort(key=flow.edges.rank.__getitem__)

    def run(self) -> list[ChartSegment]:
        segments: list[ChartSegment] = []
        for start in self.flow.edges.starts:
            segment = ChartSegment(0)
            segments.append(segment)
            run_walk(self.walk(segment, start))
            self.give_up(segment)
        for node in sorted(self.flow.edges.rank, key=self.flow.edges.rank.__getitem__):
            if (
                node not in self.placed
            ):  # only jumps lead here: it goes below the last branch that wanted to go on at it
                segment = self.waiting[node][-1]
                if segment.items and isinstance(segment.items[-1], NestedJump):
                    segment.items.pop()
                run_walk(self.walk(segment, node))
                self.give_up(segment)
        return segments

    def walk(self, segment: ChartSegment, node: int, waiting: tuple[int, ...] = ()) -> Walk:
        """Place `node` in `segment`, and the nodes below it."""
        flow = self.flow
        while True:
            self.place(segment, node, waiting)
            successors = flow.successors[node]
            if not successors:
                segment.end = None
                return
            if len(successors) == 1:
                segment.end = SegmentEnd(successors[0], (node,))
            else:
                divergence = NestedDivergence(node in flow.joints)
                segment.items.append(divergence)
                for target in successors:
                    branch = ChartSegment(segment.depth + 1)
                    divergence.branches.append(branch)
                    if self.enters(node, target):
                        yield self.walk(branch, target, (node,))
                    else:
                        branch.end = SegmentEnd(target, (node,))
                yield self.close(segment, node, divergence)
            end = segment.end
            if end is None or end.target in self.placed or flow.edges.dominator[end.target] not in segment.spine:
                return
            node, waiting = end.target, end.waiting

    def enters(self, node: int, target: int) -> bool:
        return (
            target not in self.placed
            and self.flow.edges.dominator[target] == node
            and self.flow.edges.forward_inputs[target] == 1
        )

    def place(self, segment: ChartSegment, node: int, waiting: tuple[int, ...]) -> None:
        self.placed.add(node)
        segment.spine.add(node)
        joint = self.flow.joints.get(node)
        loose = joint is not None and bool(joint.sources) and set(waiting) != set(joint.sources)
        if joint is not None and len(joint.alternatives) > 1:
            places = {step: place for place, step in enumerate(waiting)}
            if loose or any(member.sources[0] not in places for member in joint.members):
                self.misfits.add(node)
            else:
                joint.members.sort(key=lambda member: places[member.sources[0]])
        segment.items.append(NestedNode(node, loose))

    def close(self, segment: ChartSegment, node: int, divergence: NestedDivergence) -> Walk:
        """Decide how the branches of the divergence below `node` end, and where `segment` goes on."""
        inner = [target for target in self.flow.edges.merges.get(node, ()) if target not in self.placed]
        segment.end = None
        if self.hoist(segment, divergence, frozenset(inner)):
            return
        # Where branches of this divergence alone meet, it ends there. Where only some neighbours meet, they become a
        # divergence inside it. Else one branch leads to the target and the others jump.
        for position, target in enumerate(inner):
            if target in self.placed:
                continue
            group = [
                i
                for i, branch in enumerate(divergence.branches)
                if branch.end is not None and branch.end.target == target
            ]
            if not group:
                continue
            later = {other for other in inner[position + 1 :] if other not in self.placed}
            ends = [branch.end.target for branch in divergence.branches if branch.end is not None]
            alone = later.isdisjoint(ends) and (
                divergence.parallel or not any(self.is_convergence(end) for end in ends if end != target)
            )
            meets = self.meets(divergence, group, target)
            if alone and meets:
                self.join(segment, divergence, target)
                return
            if meets and len(group) > 1 and group[-1] - group[0] == len(group) - 1:
                yield self.wrap(divergence, group, target)
            else:
                branch = divergence.branches[group[-1]]
                waiting = branch.end.waiting if branch.end is not None else ()
                yield self.walk(branch, target, waiting)
        if self.hoist(segment, divergence, frozenset()):
            return
        outer = self.outer_target(segment, divergence)
        self.join(segment, divergence, outer)

    def hoist(self, segment: ChartSegment, divergence: NestedDivergence, inner: frozenset[int]) -> bool:
        """Draw the way on below the divergence instead of in a branch, where only one branch leads to a step.

        Engineers draw an exit so: a branch that is a transition and a jump, beside the transition of the way on. Where
        the exits lead forward, to one of `inner`, they are taken for exits if the way on has divergences of its own.
        """
        long = [branch for branch in divergence.branches if len(branch.items) > 1]
        if divergence.parallel or len(long) != 1 or not all(branch.items for branch in divergence.branches):
            return False
        main = long[0]
        if inner and not any(isinstance(item, NestedDivergence) for item in main.items):
            return False
        exits = [branch.end for branch in divergence.branches if branch is not main and branch.end is not None]
        if any(not self.is_jump(end) and end.target not in inner for end in exits):
            return False
        below = main.items[1]
        if not isinstance(below, NestedNode) or below.node not in self.flow.steps:
            return False
        segment.items += main.items[1:]
        segment.spine |= main.spine
        segment.end = main.end
        del main.items[1:]
        main.end, main.joined = None, True
        for branch in divergence.branches:
            if branch is not main:
                self.give_up(branch)
        return True

    def wrap(self, divergence: NestedDivergence, group: list[int], target: int) -> Walk:
        """Put neighbouring branches into a divergence of their own that ends before `target`."""
        nested = NestedDivergence(divergence.parallel, divergence.branches[group[0] : group[-1] + 1])
        branch = ChartSegment(nested.branches[0].depth, [nested])
        for inside in nested.branches:
            inside.depth += 1
        divergence.branches[group[0] : group[-1] + 1] = [branch]
        self.join(branch, nested, target)
        end = branch.end
        yield self.walk(branch, target, end.waiting if end is not None else ())

    def join(self, segment: ChartSegment, divergence: NestedDivergence, target: int | None) -> None:
        """Let the branches that wait for `target` meet there; the others end."""
        waiting: list[int] = []
        for branch in divergence.branches:
            if branch.end is not None and branch.end.target == target and self.leads_down(branch):
                branch.joined = True
                waiting += branch.end.waiting
            else:
                self.give_up(branch)
        if target is not None:
            segment.end = SegmentEnd(target, tuple(waiting))

    def leads_down(self, branch: ChartSegment) -> bool:
        """True if a branch may go on below its divergence."""
        is_line = self.lines and branch.end is not None and self.is_convergence(branch.end.target)
        return bool(branch.items) or (is_line and branch.end is not None and not self.is_jump(branch.end))

    def give_up(self, segment: ChartSegment) -> None:
        """End a segment with a jump to where it wants to go; to a transition there is no jump."""
        end, segment.end = segment.end, None
        if end is not None:
            for line in _lines_below(segment):
                line.joined, segment = False, line
            if end.target not in self.placed:
                self.waiting.setdefault(end.target, []).append(segment)
            if end.target in self.flow.steps:
                segment.items.append(NestedJump(end.target))

    def is_convergence(self, node: int) -> bool:
        """True if a node is a transition that waits for several steps: nothing but their wires can lead there."""
        joint = self.flow.joints.get(node)
        return joint is not None and len(joint.alternatives) == 1 and len(joint.sources) > 1

    def is_jump(self, end: SegmentEnd) -> bool:
        """True if only a jump can lead to where a segment ends: back, or into a simultaneous branch from outside."""
        jumps = self.flow.edges.jumps
        return end.target in self.placed or all((node, end.target) in jumps for node in end.waiting)

    def meets(self, divergence: NestedDivergence, group: list[int], target: int) -> bool:
        """True if the branches of `group` may meet in a convergence before `target`."""
        joint = self.flow.joints.get(target)
        if not all(divergence.branches[i].items for i in group):
            return False
        if joint is None:
            return not divergence.parallel
        if not divergence.parallel:
            return len(joint.alternatives) > 1 or len(group) == 1
        waiting = {step for i in group for step in _waiting(divergence.branches[i])}
        return len(joint.alternatives) == 1 and waiting == set(joint.sources)

    def outer_target(self, segment: ChartSegment, divergence: NestedDivergence) -> int | None:
        """Return the target at which the divergence outside shall go on."""
        if segment.depth > _MAX_DEPTH:
            return None
        groups: dict[int, list[int]] = {}
        for i, branch in enumerate(divergence.branches):
            if branch.end is not None and self.leads_down(branch):
                groups.setdefault(branch.end.target, []).append(i)
        if divergence.parallel:
            target = next(iter(groups), None)
            whole = target is not None and sum(map(len, groups.values())) == len(divergence.branches) == len(
                groups[target]
            )
            joint = self.flow.joints.get(target) if target is not None else None
            return target if whole and joint is not None and len(joint.alternatives) == 1 else None
        rank = self.flow.edges.rank
        best: tuple[bool, bool, int, int, int] | None = None
        found: int | None = None
        for target, group in groups.items():
            joint = self.flow.joints.get(target)
            if joint is not None and len(joint.alternatives) == 1 and len(group) > 1:
                continue
            # a convergence that waits for this branch, else the nearest target ahead; without one, the target behind to
            # which most branches go back, or the longest one: it is the straight line
            behind = all(end is not None and self.is_jump(end) for end in (divergence.branches[i].end for i in group))
            longest = max(len(divergence.branches[i].items) for i in group) if behind else 0
            first = -len(group) if behind else rank[target]
            key = (behind, not self.is_convergence(target), first, -longest, -group[-1])
            if best is None or key < best:
                best, found = key, target
        return found


def _waiting(branch: ChartSegment) -> tuple[int, ...]:
    return branch.end.waiting if branch.end is not None else ()


def _lines_below(segment: ChartSegment) -> list[ChartSegment]:
    """Return the branches without a symbol at the end of a segment that go on below it."""
    found: list[ChartSegment] = []
    pending = [segment]
    for each in pending:  # grows while it is walked
        last = each.items[-1] if each.items else None
        if isinstance(last, NestedDivergence):
            pending += [branch for branch in last.branches if branch.joined]
        elif last is None and each.joined:
            found.append(each)
    return found


def run_walk(walk: Walk) -> None:
    """Execute a walk and those that it calls."""
    stack = [walk]
    while stack:
        inner = next(stack[-1], None)
        if inner is None:
            stack.pop()
        else:
            stack.append(inner)
