"""The regions of a chart: parts in which at most one step is active, nested by simultaneous branches.

A region is a state machine, so it can be one CASE over one variable. A fork takes the token of its region and starts
all branches of a block; a join ends them all and gives the token back. Where a chart is not built like that,
`Unstructured` names the transition in the way.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from plcopen_sfc.grouping import grouped
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.net import Net, NetTransition, indexes


@dataclass(frozen=True)
class Region:
    """A state machine in the chart. All numbers are indexes of the net or of `Regions`.

    `transitions` lead from one step of the region to another one of it. `block` is the block that it is a branch of,
    None for the region of an initial step (a chart has one, several where it is of several sequences). `blocks` are
    those that are forked from it. `initial` is its initial step.
    """

    index: int
    steps: tuple[int, ...]
    transitions: tuple[int, ...]
    block: int | None
    blocks: tuple[int, ...]
    initial: int | None


@dataclass(frozen=True)
class ParallelBlock:
    """Simultaneous branches. `forks` enter all `branches` (regions) from `parent`, `joins` leave them all to it.

    Mostly there is one fork and one join. Without join the branches never end.
    """

    index: int
    parent: int
    branches: tuple[int, ...]
    forks: tuple[int, ...]
    joins: tuple[int, ...]


@dataclass(frozen=True)
class Regions:
    """A chart that is built of regions; so it is safe. `region_of` has the region of each step, None if unreachable."""

    net: Net
    regions: tuple[Region, ...]
    blocks: tuple[ParallelBlock, ...]
    region_of: tuple[int | None, ...]

    def first_step(self, region: Region) -> int:
        """The step with which a region starts: its initial one, or that which the first fork of its block enters."""
        if region.block is None:
            return region.initial if region.initial is not None else region.steps[0]
        fork = self.net.transitions[self.blocks[region.block].forks[0]]
        return next(step for step in fork.targets if self.region_of[step] == region.index)

    def exit_competitors(self, block: ParallelBlock) -> tuple[int, ...]:
        """Return the transitions that leave a last step of a branch besides the join: whoever fires first wins."""
        last = {step for join in block.joins for step in self.net.transitions[join].sources}
        return tuple(sorted({t for step in last for t in self.net.leaving[step]} - set(block.joins)))


class Obstacle(StrEnum):
    """Obstacle that keeps a chart from being built of regions."""

    NO_INITIAL_STEP = "no initial step"
    SEVERAL_INITIAL_STEPS = "several initial steps in one region"
    INITIAL_STEP_IN_BRANCH = "initial step in a branch"
    NO_SOURCE = "transition without source"
    NO_TARGET = "transition without target"
    FORK_AND_JOIN = "transition that both joins and forks"
    JUMP_ACROSS_BORDER = "jump across the border of a branch"
    BRANCHES_RUN_TOGETHER = "branches that run together without a join"
    UNMATCHED_JOIN = "join of other branches than were forked"
    UNMATCHED_FORK = "forks that share some of their branches"
    LOCKED_JOIN = "join that waits for a step that is never active"


@dataclass(frozen=True)
class Unstructured:
    """Reason why a chart is not built of regions: the first obstacle, in words, and the transitions concerned."""

    net: Net
    obstacle: Obstacle
    message: str
    transitions: tuple[int, ...] = ()


class _Blocked(Exception):  # noqa: N818  # not an error: it carries the answer out
    def __init__(self, obstacle: Obstacle, message: str, transitions: Iterable[int] = ()) -> None:
        super().__init__(message)
        self.obstacle = obstacle
        self.message = message
        self.transitions = tuple(transitions)


def find_regions(chart: SfcNetwork | Net) -> Regions | Unstructured:
    """Return the regions of a chart, or what is in their way. The work grows with the size of the chart.

    Steps and transitions that can never be active or enabled belong to no region and do not matter. Rules beyond the
    net (`Net.hierarchy`) are not obeyed.
    """
    net = chart if isinstance(chart, Net) else Net.of(chart)
    try:
        return _Finder(net).find()
    except _Blocked as blocked:
        return Unstructured(net, blocked.obstacle, blocked.message, blocked.transitions)


class _Finder:
    def __init__(self, net: Net) -> None:
        self._net = net
        # more than can happen, so that whatever is missing here is really dead
        self._reached = set(indexes(net.reachable(net.initial)))
        self._live = [t for t in net.transitions if all(s in self._reached for s in t.sources)]
        self._parent = list(range(len(net.steps)))

    def find(self) -> Regions:
        net = self._net
        if not net.initial:
            raise _Blocked(Obstacle.NO_INITIAL_STEP, "no step is initial")
        forks: list[NetTransition] = []
        joins: list[NetTransition] = []
        for transition in self._live:
            self._refuse_if_odd(transition)
            if len(transition.targets) > 1:
                forks.append(transition)
            elif len(transition.sources) > 1:
                joins.append(transition)
            else:
                self._unite(transition.sources[0], transition.targets[0])
        self._refuse_locked_joins()
        blocks = self._match(forks, joins)
        return self._result(blocks)

    def _refuse_if_odd(self, transition: NetTransition) -> None:
        if not transition.sources:
            raise _Blocked(Obstacle.NO_SOURCE, f"{transition.path} has no source", [transition.index])
        if not transition.targets:
            raise _Blocked(Obstacle.NO_TARGET, f"{transition.path} has no target", [transition.index])
        if len(transition.sources) > 1 and len(transition.targets) > 1:
            message = f"{transition.path} ends simultaneous branches and starts others"
            raise _Blocked(Obstacle.FORK_AND_JOIN, message, [transition.index])

    def _refuse_locked_joins(self) -> None:
        for transition in self._net.transitions:
            never = [s for s in transition.sources if s not in self._reached]
            if never and len(never) < len(transition.sources):
                name = self._net.steps[never[0]].path
                message = f"{transition.path} waits for step {name}, which is never active"
                raise _Blocked(Obstacle.LOCKED_JOIN, message, [transition.index])

    # -- sets of steps that belong to one region

    def _region(self, step: int) -> int:
        while self._parent[step] != step:
            self._parent[step] = self._parent[self._parent[step]]
            step = self._parent[step]
        return step

    def _unite(self, a: int, b: int) -> None:
        self._parent[self._region(a)] = self._region(b)

    # -- forks and joins

    def _match(
        self, forks: list[NetTransition], joins: list[NetTransition]
    ) -> dict[frozenset[int], tuple[list[NetTransition], list[NetTransition]]]:
        """Put forks and joins of the same branches together; the outside of each block is one region."""
        while True:
            # the ways around a block are one region, whichever fork or join they belong to; uniting them may make two
            # branches of a block around it one, whose key then changes: so all are matched again until nothing is
            # united any more
            blocks: dict[frozenset[int], tuple[list[NetTransition], list[NetTransition]]] = {}
            for fork in forks:
                blocks.setdefault(self._branches(fork, fork.targets), ([], []))[0].append(fork)
            unmatched = []
            for join in joins:
                branches = self._branches(join, join.sources)
                if branches in blocks:
                    blocks[branches][1].append(join)
                else:
                    unmatched.append(join)
            united = False
            for block in blocks.values():
                outside = [fork.sources[0] for fork in block[0]] + [join.targets[0] for join in block[1]]
                for step in outside[1:]:
                    if self._region(step) != self._region(outside[0]):
                        self._unite(step, outside[0])
                        united = True
            if not united:
                break
        if unmatched:
            names = ", ".join(self._net.steps[s].path for s in unmatched[0].sources)
            message = f"{unmatched[0].path} joins {names}, which were not forked together"
            raise _Blocked(Obstacle.UNMATCHED_JOIN, message, [unmatched[0].index])
        return blocks

    def _branches(self, transition: NetTransition, ends: tuple[int, ...]) -> frozenset[int]:
        """Return the regions that a fork enters or a join leaves: all different, and none of them the one outside."""
        found = [self._region(step) for step in ends]
        twice = [step for step, region in zip(ends, found, strict=True) if found.count(region) > 1][:2]
        names = " and ".join(self._net.steps[step].path for step in twice)
        if twice and ends is transition.sources:
            message = f"{transition.path} joins {names}, of which only one can be active"
            raise _Blocked(Obstacle.UNMATCHED_JOIN, message, [transition.index])
        (outside,) = transition.targets if ends is transition.sources else transition.sources
        for step, region in zip(ends, found, strict=True):
            if region == self._region(outside):
                self._refuse_jump(transition, step, outside)
        if twice:
            way = self._way(twice[0], twice[1])
            message = f"the branches of {names} at {transition.path} run together without a join"
            raise _Blocked(Obstacle.BRANCHES_RUN_TOGETHER, message + self._by(way), way)
        return frozenset(found)

    def _refuse_jump(self, transition: NetTransition, inside: int, outside: int) -> None:
        way = self._way(inside, outside)
        name = self._net.steps[inside].path
        message = f"the branch of step {name} at {transition.path} is connected with its outside"
        raise _Blocked(Obstacle.JUMP_ACROSS_BORDER, message + self._by(way), way)

    def _by(self, way: tuple[int, ...]) -> str:
        return f": {', '.join(self._net.transitions[i].path for i in way)}" if way else ""

    def _way(self, start: int, goal: int) -> tuple[int, ...]:
        """Return the transitions that connect two steps of one region, in whatever direction they lead; the fewest."""
        came: dict[int, tuple[int, int]] = {start: (start, -1)}
        waiting = deque([start])
        while waiting and goal not in came:
            step = waiting.popleft()
            # a region is connected without regard to direction: a jump back out of a branch leads against the flow
            for number in (*self._net.leaving[step], *self._net.entering[step]):
                transition = self._net.transitions[number]
                if len(transition.sources) == len(transition.targets) == 1:
                    for beside in (*transition.sources, *transition.targets):
                        if beside not in came:
                            came[beside] = (step, number)
                            waiting.append(beside)
        way: list[int] = []
        while goal in came and goal != start:
            goal, number = came[goal]
            way.append(number)
        return tuple(reversed(way))

    # -- the answer

    def _result(self, found: dict[frozenset[int], tuple[list[NetTransition], list[NetTransition]]]) -> Regions:
        net = self._net
        block_of: dict[int, int] = {}
        for number, (branches, (forks, _)) in enumerate(found.items()):
            for branch in branches:
                if branch in block_of:
                    message = f"{forks[0].path} forks branches of which another transition forks some, too"
                    raise _Blocked(Obstacle.UNMATCHED_FORK, message, [forks[0].index])
                block_of[branch] = number
        members = grouped((self._region(step), step) for step in sorted(self._reached))
        initial: dict[int, int] = {}
        for step in indexes(net.initial):
            region = self._region(step)
            name = net.steps[step].path
            if region in initial:
                message = f"{net.steps[initial[region]].path} and {name} are both initial"
                raise _Blocked(Obstacle.SEVERAL_INITIAL_STEPS, message)
            if region in block_of:
                raise _Blocked(Obstacle.INITIAL_STEP_IN_BRANCH, f"{name} is initial inside a simultaneous branch")
            initial[region] = step
        order = {region: index for index, region in enumerate(members)}
        plain = (each for each in self._live if len(each.sources) == len(each.targets) == 1)
        inner = grouped((self._region(each.sources[0]), each.index) for each in plain)
        blocks = tuple(
            ParallelBlock(
                index=number,
                parent=order[self._region(forks[0].sources[0])],
                branches=tuple(sorted(order[branch] for branch in branches)),
                forks=tuple(t.index for t in forks),
                joins=tuple(t.index for t in joins),
            )
            for number, (branches, (forks, joins)) in enumerate(found.items())
        )
        forked = grouped((block.parent, block.index) for block in blocks)
        regions = tuple(
            Region(
                index=order[region],
                steps=tuple(steps),
                transitions=tuple(inner.get(region, ())),
                block=block_of.get(region),
                blocks=tuple(forked.get(order[region], ())),
                initial=initial.get(region),
            )
            for region, steps in members.items()
        )
        return Regions(net, regions, blocks, self._regions_of_steps(order))

    def _regions_of_steps(self, order: dict[int, int]) -> tuple[int | None, ...]:
        return tuple(
            order[self._region(step.index)] if step.index in self._reached else None for step in self._net.steps
        )
