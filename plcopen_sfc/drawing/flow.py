"""A chart as a graph of steps and transitions, ready to be cut into branches.

A drawing runs downwards, so the edges of the chart are first told apart: *forward* edges are drawn as wires where they
fit, edges that close a loop or lead into what another start has drawn already become jumps. On the forward edges, which
have no loops, the immediate dominator of a node is the place above it where all ways to it part: there the branch
opens that has to be closed before the node.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from plcopen_sfc.drawing.survey import Survey
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition


@dataclass(slots=True)
class Joint:
    """A transition as it is drawn: one symbol for each of `members`, which differ in nothing but their source step."""

    members: list[Transition]
    alternatives: list[tuple[int, ...]]
    targets: tuple[int, ...]

    @property
    def sources(self) -> tuple[int, ...]:
        """The steps of all alternatives."""
        return tuple(dict.fromkeys(step for alternative in self.alternatives for step in alternative))

    @property
    def synchronizing(self) -> bool:
        """Whether several steps have to be active."""
        return len(self.alternatives[0]) > 1


@dataclass(slots=True)
class Flow:
    """The graph: `successors` of every node in the order in which they are drawn, and what its `survey` says."""

    steps: dict[int, Step]
    joints: dict[int, Joint]
    successors: dict[int, list[int]]
    survey: Survey


def flow_of(chart: SfcNetwork, together: Mapping[int, int], *, split: frozenset[int] = frozenset()) -> Flow:
    """The graph of `chart`.

    `together`: which transitions may share a node, as a group number for each; those in `split` may not.
    """
    steps = {step.id: step for step in chart.steps}
    joints: dict[int, Joint] = {}
    for group in _groups(chart, together, split):
        first = group[0]
        alternatives = [tuple(dict.fromkeys(i for i in t.sources if i in steps)) for t in group]
        joints[first.id] = Joint(group, alternatives, tuple(dict.fromkeys(i for i in first.targets if i in steps)))
    successors: dict[int, list[int]] = {i: [] for i in steps}
    priorities = {i: joint.members[0].priority for i, joint in joints.items()}
    for number, joint in sorted(joints.items(), key=lambda item: _urgency(priorities[item[0]])):
        for source in joint.sources:
            successors[source].append(number)
        successors[number] = list(joint.targets)
    entered = {target for targets in successors.values() for target in targets}
    candidates = [i for i, step in steps.items() if step.initial]
    candidates += [i for i in (*steps, *joints) if i not in entered]
    return Flow(steps, joints, successors, Survey(successors, candidates))


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
    """The transitions, those together that can be one symbol below a convergence of their steps."""
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
    """Whether two transitions with one source each differ in nothing else, so that one symbol can stand for both."""
    if len(one.sources) != 1 or len(other.sources) != 1 or one.targets != other.targets:
        return False
    same = {"id": 0, "sources": []}
    return one.model_copy(update=same) == other.model_copy(update=same)
