"""Networks whose elements have ids of their own, put together.

In TC6 an id belongs to one element of a body. TIA Portal counts anew in every network.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

from plcopen_sfc.languages.networks.graph import wires_of
from plcopen_sfc.model.network import LogicNetwork


def apart(networks: Sequence[LogicNetwork]) -> tuple[list[LogicNetwork], dict[int, int]]:
    """The networks with ids that no two of them share, and the old id of each new one.

    Networks that share none are given back as they are. An id that stands twice in one network stays twice.
    """
    used = [{node.id for node in network.nodes} for network in networks]
    if len(set(chain.from_iterable(used))) == sum(len(ids) for ids in used):
        return list(networks), {}
    old: dict[int, int] = {}
    renumbered: list[LogicNetwork] = []
    for network in networks:
        copy = network.model_copy(deep=True)
        # a wire may start at an id that no element has: it gets a new one as well, which no element has either
        wires = [wire for node in copy.nodes for wire in wires_of(node)]
        numbers = sorted({node.id for node in copy.nodes} | {wire.source for wire in wires})
        new = {number: len(old) + index for index, number in enumerate(numbers)}
        old |= {value: key for key, value in new.items()}
        for node in copy.nodes:
            node.id = new[node.id]
        for wire in wires:
            wire.source = new[wire.source]
        renumbered.append(copy)
    return renumbered, old
