"""What can happen in one evolution: which transitions can be cleared together, and enter steps that are active."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcopen_sfc.analysis.exclusivity import exclusive
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.lowering.code.logic import FALSE, is_constant
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.semantics.charts.grafcet.hierarchy import RuledChart
from plcopen_sfc.semantics.net import Net, NetTransition, Rivals, indexes, mask
from plcopen_sfc.semantics.profile import Profile

_MOST_EVOLUTIONS = 20_000
_MOST_TOGETHER = 8


class Concurrency:
    """What the situations of a chart allow. Where they are too many to be looked at, anything is possible.

    Each part of the chart that no transition connects with others is looked at alone, from its initial situation and
    from those that the charts above impose on it.
    """

    def __init__(self, source: ChartSource, profile: Profile) -> None:
        self._net = source.net
        together = profile.rivals is Rivals.ALL and not _rivals_exclude_each_other(source)
        self._rivals = Rivals.ALL if together else Rivals.PRIORITY
        ruled = source.grafcet.ruled if source.grafcet is not None else ()
        self._parts = [_Part(source.net, steps, ruled, self._rivals) for steps in _parts(source.net)]
        self._part_of = {step: part for part in self._parts for step in indexes(part.steps)}

    def both_fire(self, one: NetTransition, other: NetTransition) -> bool:
        """Whether two transitions can be cleared in the same evolution."""
        if one.pre & other.pre and self._rivals is Rivals.PRIORITY:
            return False
        return self._is_there(one.pre | other.pre)

    def enters_active(self, transition: NetTransition, step: int) -> bool:
        """Whether a transition can be cleared while a step that it activates is active."""
        return self._is_there(transition.pre | 1 << step)

    def _is_there(self, active: int) -> bool:
        touched = {id(part): part for part in (self._part_of[step] for step in indexes(active))}
        return all(part.can_be(active & part.steps) for part in touched.values())


class _Part:
    """The situations that a part can be in, by the steps that are active in them; `complete` if these are all."""

    def __init__(self, net: Net, steps: int, ruled: Sequence[RuledChart], rivals: Rivals) -> None:
        self.steps = steps
        self._with: dict[int, list[int]] = {}
        markings = _markings(net, steps, ruled, rivals)
        self._complete = markings is not None
        for marking in markings or ():
            for step in indexes(marking):
                self._with.setdefault(step, []).append(marking)

    def can_be(self, active: int) -> bool:
        """Whether all these steps can be active together."""
        first = next(indexes(active))
        return not self._complete or any(not active & ~marking for marking in self._with.get(first, ()))


def leaving_and_entering(net: Net, step: int) -> tuple[list[NetTransition], list[NetTransition]]:
    """The transitions that leave a step, and those that enter it."""
    return [net.transitions[i] for i in net.leaving[step]], [net.transitions[i] for i in net.entering[step]]


def exclude(one: Expression, other: Expression, dialect: Dialect) -> bool:
    """Whether two conditions can never be TRUE together."""
    if is_constant(one, FALSE) or is_constant(other, FALSE):
        return True
    names = [{node.identifier.casefold() for node in walk(tree) if isinstance(node, n.Name)} for tree in (one, other)]
    if not names[0] & names[1]:
        return False  # each of them can be TRUE, or nobody could tell
    return bool(exclusive(print_node(one, dialect), print_node(other, dialect), dialect=dialect).answer)


def _rivals_exclude_each_other(source: ChartSource) -> bool:
    pairs = ((t.index, rival) for t in source.net.transitions for rival in t.rivals)
    return all(exclude(source.conditions[a], source.conditions[b], source.dialect) for a, b in pairs)


def _parts(net: Net) -> list[int]:
    """The steps of each part as bits."""
    part = list(range(len(net.steps)))

    def root(step: int) -> int:
        while part[step] != step:
            part[step] = step = part[part[step]]
        return step

    for transition in net.transitions:
        joined = {root(step) for step in (*transition.sources, *transition.targets)}
        for step in joined:
            part[step] = min(joined)
    found: dict[int, int] = {}
    for step in range(len(part)):
        found[root(step)] = found.get(root(step), 0) | 1 << step
    return list(found.values())


def _markings(net: Net, steps: int, ruled: Sequence[RuledChart], rivals: Rivals) -> set[int] | None:
    """The situations that a part can be in; None where there are too many."""
    imposed = (start for chart in ruled if chart.steps & steps for start in _imposed(chart))
    waiting = [start & steps for start in (net.initial, *imposed)]
    found = set(waiting)
    left = _MOST_EVOLUTIONS
    while waiting:
        marking = waiting.pop()
        enabled = [i for i in net.enabled(marking) if (net.transitions[i].pre | net.transitions[i].post) & steps]
        left -= 1 << len(enabled)
        if len(enabled) > _MOST_TOGETHER or left < 0:
            return None
        for true in _subsets(enabled):
            after, _ = net.fire(marking, true, rivals)
            if after & steps not in found:
                found.add(after & steps)
                waiting.append(after & steps)
    return found


def _imposed(chart: RuledChart) -> Iterator[int]:
    """The situations that the charts above can put a chart into."""
    yield from (order.imposed for order in chart.orders if order.imposed is not None)
    opened = {0} if chart.enclosures else set()
    for enclosing in chart.enclosures:  # several can become active at once
        opened |= {links | enclosing.links for links in opened}
    yield from opened


def _subsets(indices: Sequence[int]) -> Iterator[int]:
    """Every non-empty set of some indexes, as bits."""
    for chosen in range(1, 1 << len(indices)):
        yield mask(index for place, index in enumerate(indices) if chosen >> place & 1)
