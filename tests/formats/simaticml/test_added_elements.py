"""Elements added by our writer are gone when the file is read again, unless they were edited."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.formats.simaticml.added_elements import AddedMark, mark_of
from plcopen_sfc.model.compare import differences

PROJECTS = ("codesys/distribution_belt.xml", "training-chain/plcopen_2.01.xml", "plcopen/filling_station_2.01.xml")
FIXTURES = Path(__file__).parents[3] / "fixtures"


def with_jump_to_a_divergence() -> bytes:
    """A chart in which S7-GRAPH wants a step and transitions between: one that forks where it joins."""
    chart = m.SfcNetwork()
    a, b, c, d = (chart.add_step(name, initial=name == "A") for name in "ABCD")
    for sources, targets in (([a], [b, c]), ([b, c], [b, c]), ([b, c], [d]), ([d], [a])):
        chart.add_transition(list(sources), list(targets), "Go")
    block = m.Pou(name="Chain", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.SfcBody(chart=chart)])
    block.interface = m.Interface(
        sections=[m.VariableSection(kind=m.SectionKind.INPUT, variables=[m.Variable(name="Go", type="BOOL")])]
    )
    return sfc.dumps(m.Project(pous=[block]), format="simaticml", partial=True)


def added_elements(content: bytes) -> list[etree._Element]:
    return [each for each in etree.fromstring(content).iter(etree.Element) if mark_of(each) is not AddedMark.NO]


@pytest.mark.slow
@pytest.mark.parametrize("name", PROJECTS)
def test_all_that_was_added_is_known_again(name: str) -> None:
    content = sfc.dumps(sfc.load(FIXTURES / name), format="simaticml", partial=True)
    assert added_elements(content)
    assert {mark_of(each) for each in added_elements(content)} == {AddedMark.UNCHANGED}


@pytest.mark.slow
def test_edits_of_what_was_added_are_read() -> None:
    """Whatever of it somebody changes: names, types, conditions."""
    content = with_jump_to_a_divergence()
    original = sfc.loads(content)
    marked = {each.tag.rpartition("}")[2] for each in added_elements(content)}
    assert {"Member", "Step", "Transition"} <= marked
    tried = 0
    for index in range(len(added_elements(content))):
        root = etree.fromstring(content)
        element = [each for each in root.iter(etree.Element) if mark_of(each) is not AddedMark.NO][index]
        if etree.QName(element).localname not in ("Member", "Step", "Transition"):
            continue
        element.set("Name", f"{element.get('Name')}_edited")
        tried += 1
        edited = sfc.loads(etree.tostring(root))
        assert list(differences(original.pous, edited.pous)), etree.tostring(element)[:200]
    assert tried > 5
