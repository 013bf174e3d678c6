"""What can happen in one evolution: which transitions can be cleared together, and enter steps that are active."""

from __future__ import annotations

from plcopen_sfc.analysis.exclusivity import exclusive
from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.lowering.source import ChartSource
from plcopen_sfc.semantics.net import Net, NetTransition, Rivals
from plcopen_sfc.semantics.profile import Profile

_MOST_MARKINGS = 5_000


class Concurrency:
    """What the situations of a chart allow. Where they are too many to be looked at, anything is possible.

    Charts that others rule are in situations that transitions alone do not lead to: anything is possible there too.
    """

    def __init__(self, source: ChartSource, profile: Profile) -> None:
        self._net = source.net
        self._source = source
        together = profile.rivals is Rivals.ALL and not self._rivals_exclude_each_other()
        self._rivals = Rivals.ALL if together else Rivals.PRIORITY
        self._markings: tuple[int, ...] | None = None
        if not source.net.hierarchy:
            graph = marking_graph(source.net, rivals=self._rivals, cap=_MOST_MARKINGS)
            if graph.complete:
                self._markings = tuple(graph)

    def both_fire(self, one: NetTransition, other: NetTransition) -> bool:
        """Whether two transitions can be cleared in the same evolution."""
        if one.pre & other.pre and self._rivals is Rivals.PRIORITY:
            return False
        return self._is_there(one.pre | other.pre)

    def enters_active(self, transition: NetTransition, step: int) -> bool:
        """Whether a transition can be cleared while a step that it activates is active."""
        return self._is_there(transition.pre | 1 << step)

    def _is_there(self, steps: int) -> bool:
        return self._markings is None or any(steps & ~marking == 0 for marking in self._markings)

    def _rivals_exclude_each_other(self) -> bool:
        return all(self._exclusive(t.index, rival) for t in self._net.transitions for rival in t.rivals)

    def _exclusive(self, one: int, other: int) -> bool:
        dialect = self._source.dialect
        texts = [print_node(self._source.conditions[i], dialect) for i in (one, other)]
        return bool(exclusive(texts[0], texts[1], dialect=dialect).answer)


def leaving_and_entering(net: Net, step: int) -> tuple[list[NetTransition], list[NetTransition]]:
    """The transitions that leave a step, and those that enter it."""
    return [net.transitions[i] for i in net.leaving[step]], [net.transitions[i] for i in net.entering[step]]
