"""Whether a chart is sound, however large it is: safe, without deadlock, and with every step in use again and again."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from plcopen_sfc.analysis.answers import Answer
from plcopen_sfc.analysis.marking import DEFAULT_CAP, marking_graph
from plcopen_sfc.analysis.reductions import ReducedNet
from plcopen_sfc.collector import collector_paused
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.net import Net, NetStep


class Proof(StrEnum):
    """How soundness was decided.

    REDUCTION: the net became a single step. MARKINGS: by the markings of what reduction left. NONE: it was not.
    """

    REDUCTION = "reduction"
    MARKINGS = "markings"
    NONE = "none"


@dataclass(frozen=True)
class Soundness:
    """What is known of a chart whose conditions are free.

    `safe`: no step is entered while it is active. `live`: whatever happens, every transition can be enabled again; so
    there is no deadlock and nothing dead; unknown where the chart is not safe. `way_home`: the initial situation can
    always be reached again. `remaining`: the steps at which the reduction stopped, where something is not built of
    blocks; () where all was reduced.
    """

    safe: Answer
    live: Answer
    way_home: Answer
    proof: Proof
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
    with collector_paused():  # it would look through the growing net again and again
        reduced = ReducedNet(net, [(step.bit, net.initial) for step in ends])
    if reduced.unsafe:
        return Soundness(Answer.NO, Answer.UNKNOWN, Answer.UNKNOWN, Proof.REDUCTION)
    if reduced.trivial:
        return Soundness(Answer.YES, Answer.YES, _way_home(net, Answer.YES, Answer.YES), Proof.REDUCTION)
    graph = marking_graph(reduced.net(), cap=cap)
    remaining = tuple(net.steps[i] for i in reduced.steps)
    if graph.safe is Answer.NO:
        return Soundness(Answer.NO, Answer.UNKNOWN, Answer.UNKNOWN, Proof.MARKINGS, remaining)
    proof = Proof.MARKINGS if graph.complete else Proof.NONE
    return Soundness(graph.safe, graph.live, _way_home(net, graph.safe, graph.live), proof, remaining)


def _way_home(net: Net, safe: Answer, live: Answer) -> Answer:
    """A live and safe net that starts with one step can enter that step again, and then no other one is active.

    If another were, the way from the first marking to this one could be gone again and again, each time with more
    tokens.
    """
    return Answer.YES if safe and live and net.initial.bit_count() == 1 else Answer.UNKNOWN
