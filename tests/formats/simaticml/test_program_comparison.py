"""Two networks say the same, whatever the quick comparison sees."""

from __future__ import annotations

import copy
import random

import pytest
from lxml import etree

from plcopen_sfc.formats.simaticml.program_comparison import UID, numbers_like, numbers_of
from tests.documents.exports import FIXTURES


def networks() -> list[etree._Element]:
    """The networks of the examples that have wires."""
    roots = [etree.parse(path).getroot() for path in sorted(FIXTURES.glob("*.xml"))]
    found = [net for root in roots for net in root.iter("{*}FlgNet")]
    return [net for net in found if next(net.iter("{*}Wire"), None) is not None]


@pytest.mark.parametrize("seed", range(20))
def test_numbers_and_order_say_nothing_words_do(seed: int) -> None:
    chance = random.Random(seed)  # noqa: S311
    net = chance.choice(networks())
    usual = numbers_of(net)
    assert numbers_like(net, copy.deepcopy(net)) == usual

    other = copy.deepcopy(net)
    new = [str(300 + number) for number in chance.sample(range(len(usual)), len(usual))]
    of = dict(zip(usual, new, strict=True))
    for element in other.iterdescendants(etree.Element):
        if element.get(UID) is not None:
            element.set(UID, of[str(element.get(UID))])
    for group in other:
        group[:] = chance.sample(list(group), len(group))
    parts_moved = [child.get(UID) for child in other.iter("{*}Part")] != [
        of[str(p.get(UID))] for p in net.iter("{*}Part")
    ]
    if not parts_moved:
        assert numbers_like(other, net) == [of[number] for number in usual]

    word = chance.choice([e for e in other.iterdescendants(etree.Element) if e.get("Name") is not None])
    word.set("Name", f"{word.get('Name')}_x")
    assert numbers_like(other, net) is None
    assert numbers_like(net, other) is None
