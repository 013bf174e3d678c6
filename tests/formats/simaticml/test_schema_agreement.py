"""Our schemas and the official ones say the same about every part of every real file, and about damaged ones.

The official ones are of interfaces, networks, charts and program text only: there is none of the frame of a document.
"""

from __future__ import annotations

import random
from collections import Counter
from functools import cache
from typing import TYPE_CHECKING

import pytest
from lxml import etree

from plcopen_sfc.formats.simaticml.tia_versions import namespace
from plcopen_sfc.formats.xml.schema_validation import is_valid
from tests.corpus import ROOT, require_corpus
from tests.formats.simaticml.documents import FIXTURES, parsed, real_documents
from tests.formats.simaticml.instances import Instances
from tests.formats.simaticml.official import KINDS_AND_NUMBERS, ROOTS, official, outer_parts, without_namespace
from tests.mutants import Mutator

if TYPE_CHECKING:
    from collections.abc import Iterator

MUTANTS_PER_PART = 2
LARGE = 400
INSTANCES = 8
MUTANTS_PER_INSTANCE = 3
VALUES = (
    "", " ", "x", "0", "1", "-1", "65535", "65536", "16", "17", "2147483648", "1.5", " 2 ", "+3", "true", "TRUE", "N",
    "P1", "S1", "CALL", "LAD", "SCL", "Direct", "Jump", "AltBegin", "SimEnd", "Input", "Static", "LocalVariable",
    "NamedValueConstant", "UserType", "Retain", "Public", "de-DE", "zh-Hans-CN", "deDE", "x3", "1.0", "1.0.0.0.0",
    "T#5s", "ADD_I", "1,2", "Array", "2024-01-31T08:30:00",
)  # fmt: skip


def verdicts(part: etree._Element, kind: str, number: int) -> tuple[bool, bool]:
    """Ours and the official one."""
    return is_valid(part, f"simaticml/{kind}-v{number}"), official(kind, number).validate(without_namespace(part))


def parts() -> Iterator[tuple[str, str, int, etree._Element]]:
    for path in (*real_documents(), *sorted(FIXTURES.rglob("*.xml"))):
        root = parsed(path.read_bytes())
        for place, (kind, number, element) in enumerate(outer_parts(root)):
            yield f"{path.name}/{place}", kind, number, etree.fromstring(etree.tostring(element, with_tail=False))


@cache
def declared_names() -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The names of all elements and attributes that our schemas declare, in the order of the alphabet."""
    space = "{http://www.w3.org/2001/XMLSchema}"
    found: dict[str, set[str]] = {"element": set(), "attribute": set()}
    for path in (ROOT / "schemas" / "simaticml").glob("*.xsd"):
        for kind, names in found.items():
            names |= {str(each.get("name")) for each in etree.parse(path).iter(space + kind) if each.get("name")}
    return tuple(sorted(found["element"])), tuple(sorted(found["attribute"]))


def mutants(part: etree._Element, seed: str, count: int) -> Iterator[etree._Element]:
    tags, attributes = declared_names()
    mutator = Mutator(cut_down(part, seed), seed, tags=(*tags, "unheardOf"), attributes=attributes, values=VALUES)
    if not any(each.attrib for each in mutator.root.iterdescendants(etree.Element)):
        return  # too little to damage
    for _ in range(count):
        yield mutator.mutant()


def cut_down(part: etree._Element, seed: str) -> etree._Element:
    """A part with so many elements that damage is likely to hit a rare kind, and quick to copy."""
    chance = random.Random(seed)  # noqa: S311
    while sum(1 for _ in part.iter(etree.Element)) > LARGE:
        longest = max(part.iter(etree.Element), key=len)
        for surplus in chance.sample(list(longest), max(1, len(longest) // 2)):
            longest.remove(surplus)
    return part


@pytest.mark.slow
@pytest.mark.corpus
def test_same_verdict_on_every_part_of_every_file() -> None:
    require_corpus()
    judged: Counter[tuple[str, bool]] = Counter()
    for name, kind, number, part in parts():
        ours, theirs = verdicts(part, kind, number)
        assert ours == theirs, name
        judged[kind, theirs] += 1
    print(f"parts of the corpus and the fixtures, by kind and verdict: {dict(judged)}")  # noqa: T201
    assert {kind for kind, _ in judged} >= {"Interface", "Graph", "FlgNet", "StructuredText"}


@pytest.mark.corpus
@pytest.mark.slow
def test_same_verdict_on_mutants_of_every_part_of_the_corpus() -> None:
    require_corpus()
    differing: list[str] = []
    total = valid = 0
    for name, kind, number, part in parts():
        for mutant in mutants(part, name, MUTANTS_PER_PART):
            ours, theirs = verdicts(mutant, kind, number)
            total += 1
            valid += theirs
            if ours != theirs:
                differing.append(f"{name} mutant {total}: ours {ours}, official {theirs}")
    print(f"{total} mutants of the corpus, {len(differing)} disagreements; {valid} are valid")  # noqa: T201
    assert differing == []
    assert 0.05 < valid / total < 0.95, "verdicts that are all the same would prove nothing"


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "number"), KINDS_AND_NUMBERS)
def test_same_verdict_on_random_documents_of_our_grammar_and_on_mutants_of_them(kind: str, number: int) -> None:
    made = Instances(f"simaticml/{kind}-v{number}", ROOTS[kind], f"{kind}{number}")
    judged: Counter[bool] = Counter()
    for count in range(INSTANCES):
        part = made.instance()
        assert part.tag == f"{{{namespace(kind, number)}}}{ROOTS[kind]}"
        assert verdicts(part, kind, number) == (True, True), etree.tostring(part)
        for mutant in mutants(part, str(count), MUTANTS_PER_INSTANCE):
            ours, theirs = verdicts(mutant, kind, number)
            assert ours == theirs, etree.tostring(mutant)
            judged[theirs] += 1
    assert set(judged) == {True, False}
