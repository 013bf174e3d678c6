"""Our schemas and the official ones say the same about every real file, and about thousands of damaged ones."""

from __future__ import annotations

import copy
import random
from collections import Counter
from functools import cache
from itertools import islice
from typing import TYPE_CHECKING

import pytest
from lxml import etree

from plcopen_sfc.formats.plcopen.tc6_versions import VERSIONS, version_of
from plcopen_sfc.formats.xml.schema_validation import is_valid
from plcopen_sfc.formats.xml.xml_parsing import parse_xml
from tests.corpus import ROOT, corpus_files, require_corpus, require_official_schema
from tests.mutants import Mutator, systematic_mutants
from tests.sweeps import WHOLE

if TYPE_CHECKING:
    from pathlib import Path

FULL = ROOT / "fixtures" / "plcopen"
PER_FILE = 100 if WHOLE else 20
PER_FULL_DOCUMENT = 1500 if WHOLE else 150
SYSTEMATIC = 1 if WHOLE else 15
"""Of so many systematic mutants one is judged, in each version another."""
KEPT_POUS = 3
KEPT_OBJECTS = 60


@cache
def official(version: str) -> etree.XMLSchema:
    return etree.XMLSchema(etree.parse(require_official_schema(version)))


def verdicts(root: etree._Element, version: str) -> tuple[bool, bool]:
    """Ours and the official one."""
    return is_valid(root, f"plcopen-{version}"), official(version).validate(root)


def version_name(root: etree._Element) -> str | None:
    version = version_of(etree.QName(root).namespace or "")
    return version.name if version else None


def hoist(root: etree._Element) -> etree._Element:
    """Move POUs and data types out of foreign data to where TC6 wants them: a schema looks at them only there."""
    space = f"{{{etree.QName(root).namespace}}}"
    for tag, parent in (("pou", "pous"), ("dataType", "dataTypes")):
        place = root.find(f"{space}types/{space}{parent}")
        for data in list(root.iter(f"{space}data")) if place is not None else ():
            for hidden in data.findall(f"{space}{tag}"):
                data.getparent().remove(data)
                place.append(hidden)
    return root


def cut_down(root: etree._Element, seed: str) -> etree._Element:
    """A few POUs of a large project, of which long bodies are shortened: mutants of 2 MB would take hours."""
    chance = random.Random(seed)  # noqa: S311
    for pous in root.iter("{*}pous"):
        children = list(pous)
        for surplus in chance.sample(children, max(0, len(children) - KEPT_POUS)):
            pous.remove(surplus)
    for body in root.iter("{*}SFC", "{*}FBD", "{*}LD"):
        for surplus in list(body)[KEPT_OBJECTS:]:
            body.remove(surplus)
    for foreign in root.iterchildren("{*}addData"):
        root.remove(foreign)
    return root


def disagreements(root: etree._Element, seed: str, count: int) -> tuple[list[str], int]:
    """Mutants on which the verdicts differ, and how many of all were valid."""
    version = version_name(root)
    assert version is not None
    mutator = Mutator(root, seed)
    differing, valid = [], 0
    for number in range(count):
        mutant = mutator.mutant()
        ours, theirs = verdicts(mutant, version)
        valid += theirs
        if ours != theirs:
            differing.append(f"{seed}, mutant {number}: ours {ours}, official {theirs}")
    return differing, valid


def full_document(version: str) -> etree._Element:
    """A document with every element of the version; valid."""
    data = (FULL / f"every_element_{'1.01' if version == '1.01' else '2.01'}.xml").read_bytes()
    if version == "2.0":
        data = data.replace(b"http://www.plcopen.org/xml/tc6_0201", b"http://www.plcopen.org/xml/tc6_0200")
    root = parse_xml(data)
    assert version_name(root) == version
    assert verdicts(root, version) == (True, True)
    return root


def thinned(root: etree._Element) -> etree._Element:
    """Remove what has a like: a third is left, with every kind of element and attribute where each kind may be.

    Mutants are as many then, but for a few other places of an element among more siblings.
    """
    counts = Counter(kind for each in root.iter(etree.Element) for kind in kinds(each))
    for each in [] if WHOLE else reversed(list(root.iterdescendants(etree.Element))):
        parent = each.getparent()
        within = Counter(kind for below in each.iter(etree.Element) for kind in kinds(below))
        has_like = any(other is not each and other.tag == each.tag for other in parent)
        if has_like and all(counts[kind] > count for kind, count in within.items()):
            counts -= within
            parent.remove(each)
    return root


def kinds(element: etree._Element) -> list[tuple[str, ...]]:
    """The parts that an element has, of those that its place may have: itself below its parent, and its attributes."""
    parent = element.getparent()
    where = (str(parent.tag) if parent is not None else "", str(element.tag))
    return [where, *((*where, str(name)) for name in element.attrib)]


def tc6_files() -> list[Path]:
    return [path for kind in ("plcopen", "codesys") for path in corpus_files(kind) if path.suffix == ".xml"]


@pytest.mark.slow
@pytest.mark.corpus
def test_same_verdict_on_every_file_of_the_corpus() -> None:
    require_corpus()
    files = tc6_files()
    judged = []
    for path in files:
        root = parse_xml(path.read_bytes())
        version = version_name(root)
        assert version is not None, path
        for document in (root, hoist(copy.deepcopy(root))):
            ours, theirs = verdicts(document, version)
            assert ours == theirs, path
        judged.append(theirs)
    print(f"{len(judged)} files of the corpus, the same verdict on all; {sum(judged)} are valid")  # noqa: T201
    assert len(judged) == len(files) > 0


@pytest.mark.corpus
@pytest.mark.slow
def test_same_verdict_on_mutants_of_every_file_of_the_corpus() -> None:
    require_corpus()
    differing: list[str] = []
    total = valid = 0
    for path in tc6_files():
        root = cut_down(hoist(parse_xml(path.read_bytes())), path.name)
        found, fine = disagreements(root, "/".join(path.parts[-4:]), PER_FILE)
        differing += found
        valid += fine
        total += PER_FILE
    print(f"{total} mutants of the corpus, {len(differing)} disagreements; {valid} are valid")  # noqa: T201
    assert total >= 20 * PER_FILE
    assert differing == []
    assert 0.05 < valid / total < 0.95, "verdicts that are all the same would prove nothing"


@pytest.mark.slow
@pytest.mark.parametrize("version", [version.name for version in VERSIONS])
def test_same_verdict_on_mutants_of_a_document_with_every_element(version: str) -> None:
    root = thinned(full_document(version))
    differing, valid = disagreements(root, f"every element {version}", PER_FULL_DOCUMENT)
    print(f"TC6 {version}: {PER_FULL_DOCUMENT} mutants, {len(differing)} disagreements; {valid} are valid")  # noqa: T201
    assert differing == []
    assert 0.05 < valid / PER_FULL_DOCUMENT < 0.95


@pytest.mark.slow
@pytest.mark.parametrize("version", [version.name for version in VERSIONS])
def test_same_verdict_on_every_single_change_of_a_document_with_every_element(version: str) -> None:
    """Chance misses rare places. Here each kind of element and attribute gets each kind of damage once.

    One in fifteen of these, unless everything is to be run: versions that are nearly the same have others. Whoever
    changes a schema runs all.
    """
    root = thinned(full_document(version))
    assert verdicts(root, version) == (True, True)
    differing, valid, total = [], 0, 0
    first = [each.name for each in VERSIONS].index(version) % SYSTEMATIC
    for what, mutant in islice(systematic_mutants(root), first, None, SYSTEMATIC):
        ours, theirs = verdicts(mutant, version)
        total += 1
        valid += theirs
        if ours != theirs:
            differing.append(f"{what}: ours {ours}, official {theirs}")
    print(f"TC6 {version}: {total} systematic mutants, {len(differing)} disagreements; {valid} are valid")  # noqa: T201
    assert differing == []
    assert 0.05 < valid / total < 0.95


@pytest.mark.parametrize("version", [version.name for version in VERSIONS])
def test_no_name_of_the_official_schema_is_missing_in_ours(version: str) -> None:
    """Every element and attribute that the official schema declares is declared in ours, and no other."""
    ours: set[tuple[str, str]] = set()
    files = [f"plcopen-{version}", "plcopen-shared", *([] if version == "1.01" else ["plcopen-2-shared"])]
    for name in files:
        ours |= declared(ROOT / "schemas" / f"{name}.xsd")
    theirs = declared(require_official_schema(version))
    assert ours == theirs


def declared(schema: Path) -> set[tuple[str, str]]:
    space = "{http://www.w3.org/2001/XMLSchema}"
    tree = etree.parse(schema)
    return {(kind, str(each.get("name"))) for kind in ("element", "attribute") for each in tree.iter(space + kind)}
