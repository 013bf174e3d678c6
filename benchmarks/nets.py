"""How long the analyses of charts take, and how they grow.

    python -m benchmarks.nets              as a table
    python -m benchmarks.nets --json       the same as data

The marking graph of six simultaneous branches of ten steps has a million markings. Charts of nested sequences,
selections, simultaneous branches and loops are proven sound, and divided into regions, at sizes from 1,250 to 40,000
steps. Times are processor times of the best of three runs, without making the chart.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable
from random import Random

from plcopen_sfc.analysis.exclusivity import exclusive
from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.analysis.regions import Regions, find_regions
from plcopen_sfc.analysis.soundness import soundness
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition
from plcopen_sfc.semantics.net import Net

SIZES = (1250, 2500, 5000, 10_000, 20_000, 40_000)
PAIRS = 500

Arcs = list[tuple[list[int], list[int]]]


def branches(count: int, length: int) -> SfcNetwork:
    """One fork, `count` branches of `length` steps each, one join."""
    arcs: Arcs = [([0], [2 + b * length for b in range(count)])]
    for b in range(count):
        arcs += [([2 + b * length + i], [3 + b * length + i]) for i in range(length - 1)]
    arcs += [([1 + (b + 1) * length for b in range(count)], [1]), ([1], [0])]
    arcs[-2] = (sorted(arcs[-2][0]), [1])
    return _chart(2 + count * length, arcs)


def nested(size: int, seed: int = 1) -> SfcNetwork:
    """Nested blocks with `size` steps."""
    random = Random(seed)
    arcs: Arcs = [([0], [1])]
    # each arc between two steps may be replaced by a block; the chart starts with one that leads back to the start
    plain = [0]
    arcs.append(([1], [0]))
    steps = 2
    while steps < size:
        number = random.choice(plain)
        (begin,), (end,) = arcs[number]
        kind = random.choice(("sequence", "sequence", "selection", "simultaneous", "loop"))
        if kind == "sequence" or size - steps < 4:
            arcs[number] = ([begin], [steps])
            arcs.append(([steps], [end]))
            steps += 1
        elif kind == "selection":
            arcs += [([begin], [steps]), ([steps], [end])]
            plain.append(len(arcs) - 2)
            steps += 1
        elif kind == "loop":
            arcs[number] = ([begin], [steps])
            arcs += [([steps], [end]), ([steps], [steps + 1]), ([steps + 1], [steps])]
            plain.append(len(arcs) - 2)
            steps += 2
        else:
            arcs[number] = ([begin], [steps, steps + 1])
            plain.remove(number)
            arcs += [([steps], [steps + 2]), ([steps + 1], [steps + 3]), ([steps + 2, steps + 3], [end])]
            plain += [len(arcs) - 3, len(arcs) - 2]
            steps += 4
        if kind != "simultaneous" or size - steps < 0:
            plain.append(len(arcs) - 1)
    return _chart(steps, arcs)


def _chart(steps: int, arcs: Arcs) -> SfcNetwork:
    return SfcNetwork(
        steps=[Step(id=i, name=f"S{i}", initial=i == 0) for i in range(steps)],
        transitions=[
            Transition(id=steps + i, sources=sources, targets=targets) for i, (sources, targets) in enumerate(arcs)
        ],
    )


def best(work: Callable[[], object], rounds: int = 3) -> float:
    """Processor time of the best run, in seconds."""
    times = []
    for _ in range(rounds):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def _markings() -> int:
    graph = marking_graph(branches(6, 10), cap=2_000_000)
    if not graph.safe:
        raise AssertionError("six branches beside each other are safe")
    return len(graph)


def _sound(net: Net) -> None:
    if not soundness(net):
        raise AssertionError("nested blocks are sound")


def _regions(net: Net) -> None:
    if not isinstance(find_regions(net), Regions):
        raise AssertionError("nested blocks have regions")


def _exclusive() -> None:
    for i in range(PAIRS):
        if not exclusive(f"Level > {i} AND NOT Fault", f"Start AND (Level <= {i} OR Fault)"):
            raise AssertionError("these exclude each other")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    rows: dict[str, float] = {f"marking graph, {_markings()} markings": best(_markings, 2)}
    _exclusive()
    rows[f"exclusivity of {PAIRS} pairs of conditions"] = best(_exclusive)
    growth: dict[str, list[tuple[int, float]]] = {}
    for size in SIZES:
        chart = nested(size)
        net = Net.of(chart)
        for name, work in (
            ("net", lambda chart=chart: Net.of(chart)),
            ("soundness", lambda net=net: _sound(net)),
            ("regions", lambda net=net: _regions(net)),
        ):
            seconds = best(work)
            rows[f"{name}, {len(net.steps)} steps"] = seconds
            growth.setdefault(name, []).append((len(net.steps), seconds))
    exponents = {
        name: math.log(points[-1][1] / points[0][1]) / math.log(points[-1][0] / points[0][0])
        for name, points in growth.items()
    }
    if arguments.json:
        print(json.dumps({"seconds": rows, "exponents": exponents}))
        return
    for name, seconds in rows.items():
        print(f"{name:45} {seconds:9.3f} s")
    for name, exponent in exponents.items():
        print(f"{'growth of ' + name:45} {exponent:9.2f}")


if __name__ == "__main__":
    main()
