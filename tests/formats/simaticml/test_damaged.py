"""Damaged documents: a clear error or a finding, never another exception, and nothing lost."""

from __future__ import annotations

import copy
import random
from collections import Counter
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.errors import FormatError
from tests.formats.simaticml.documents import FIXTURES, parsed
from tests.sweeps import WHOLE

NUMBERS = ("ID", "UId", "Number")
MUTANTS = 60 if WHOLE else 8
SEED = 60848
VALUES = ("", "0", "-1", "x", "999999", "true", "Direct", "SimEnd", "é", "1.5", "00", "FBD")


def mutants(data: bytes, count: int, seed: int) -> list[bytes]:
    """Documents that differ in one place: an element gone, doubled, renamed or moved, an attribute or text changed."""
    chance = random.Random(seed)  # noqa: S311
    found: list[bytes] = []
    while len(found) < count:
        root = copy.deepcopy(parsed(data))
        element = chance.choice(list(root.iter(etree.Element))[1:])
        parent = element.getparent()
        assert parent is not None
        kind = chance.randrange(6)
        if kind == 0:
            parent.remove(element)
        elif kind == 1:
            element.addnext(copy.deepcopy(element))
        elif kind == 2:
            element.tag = f"{str(element.tag).rpartition('}')[0]}}}Strange" if "}" in str(element.tag) else "Strange"
        elif kind == 3 and element.attrib:
            element.set(chance.choice(list(element.attrib)), chance.choice(VALUES))
        elif kind == 4:
            element.set("Unknown", chance.choice(VALUES))
        elif kind == 5 and element.text and not len(element):  # other text is in no schema, and kept in the file only
            element.text = chance.choice(VALUES)
        found.append(etree.tostring(root))
    return found


def lost(data: bytes, fresh: bytes) -> Counter[tuple[str, str]]:
    """Names of elements with what they say, but for running numbers and what is empty, that are no longer there."""

    def findings(content: bytes) -> Counter[tuple[str, str]]:
        found: Counter[tuple[str, str]] = Counter()
        for element in parsed(content).iter(etree.Element):
            name = etree.QName(element).localname
            marks = sorted(f"{key!s}={value!s}" for key, value in element.attrib.items() if key not in NUMBERS)
            text = (element.text or "").strip()
            if marks or text:
                found[name, " ".join([*marks, text])] += 1
        return found

    return findings(data) - findings(fresh)


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(FIXTURES.glob("*.xml")), ids=lambda path: path.name)
def test_mutants_are_read_or_refused(path: Path) -> None:
    loaded = 0
    for data in mutants(path.read_bytes(), MUTANTS, SEED):
        try:
            project = sfc.loads(data, format="simaticml")
            project.read_all()
        except FormatError:
            continue
        loaded += 1
        assert sfc.dumps(project) == data
        if any(d.code == "SFC101" for d in project.diagnostics):
            continue  # two of one number: a document that is written again gives one of them another
        fresh = sfc.dumps(project, fresh=True)
        again = sfc.loads(fresh)
        assert sfc.dumps(again, fresh=True) == fresh
        assert not lost(data, fresh)
    assert loaded > MUTANTS / 2
