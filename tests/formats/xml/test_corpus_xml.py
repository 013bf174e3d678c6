"""Real files: the source tree sees what lxml sees, and a random edit arrives and stays small."""

from __future__ import annotations

import copy
import os
import random
from pathlib import Path

import pytest
from lxml import etree

from plcopen_sfc.errors import FormatError
from plcopen_sfc.formats.xml.source_patch import patch_xml
from plcopen_sfc.formats.xml.source_tree import SourceTree, text_edits
from plcopen_sfc.formats.xml.xml_parsing import decode_xml, parse_xml

pytestmark = pytest.mark.corpus

_CHANCE = random.Random
_CORPUS = Path(os.environ.get("PLCOPEN_SFC_CORPUS") or Path(__file__).parents[4] / "shared" / "corpus")
_SAMPLE = 60
_LARGEST = 400_000


def _sample() -> list[Path]:
    files = sorted(path for path in _CORPUS.rglob("*") if path.is_file() and path.stat().st_size < _LARGEST)
    xml = [path for path in files if path.suffix.lower() in {".xml", ".tcpou", ".grafcet", ".l5x"}]
    return _CHANCE(1).sample(xml, min(_SAMPLE, len(xml)))


@pytest.fixture(scope="module")
def sources() -> list[tuple[Path, bytes]]:
    found = [(path, path.read_bytes()) for path in _sample()]
    if not found:
        pytest.skip(f"no corpus at {_CORPUS}; set PLCOPEN_SFC_CORPUS")
    return found


def _roots(sources: list[tuple[Path, bytes]]) -> list[tuple[Path, bytes, etree._Element]]:
    roots: list[tuple[Path, bytes, etree._Element]] = []
    for path, data in sources:
        try:
            roots.append((path, data, parse_xml(data)))
        except FormatError:
            continue  # the corpus has damaged files too
    assert len(roots) > len(sources) / 2
    return roots


def _is_cut_out(small: str, large: str) -> bool:
    """True if one piece cut out of `large` leaves `small`."""
    (change,) = text_edits(small.replace("\n", " "), large.replace("\n", " "))
    return change.start == change.end


@pytest.mark.slow
def test_the_source_tree_sees_what_lxml_sees(sources: list[tuple[Path, bytes]]) -> None:
    for path, data, root in _roots(sources):
        text, encoding = decode_xml(data)
        assert encoding.encode(text) == data, path
        tree = SourceTree(text)
        waiting = [tree.root]
        seen: list[tuple[str, dict[str, str]]] = []
        while waiting:
            node = waiting.pop()
            if node.is_element:
                seen.append((tree.tag(node), tree.values(node)))
            waiting += reversed(node.children)
        assert seen == [(element.tag, dict(element.attrib)) for element in root.iter(etree.Element)], path


@pytest.mark.slow
def test_a_changed_value_changes_one_tag(sources: list[tuple[Path, bytes]]) -> None:
    chance = _CHANCE(2)
    for path, data, before in _roots(sources):
        after = copy.deepcopy(before)
        element = chance.choice([node for node in after.iter(etree.Element) if node.attrib] or [after])
        name = chance.choice(sorted(element.attrib) or ["new"])
        element.set(name, element.get(name, "") + "<x")
        result = patch_xml(data, before, after)
        assert etree.tostring(parse_xml(result)) == etree.tostring(after), path
        added = len(result) - len(data)
        text, encoding = decode_xml(data)
        changed, _ = decode_xml(result)
        assert _is_cut_out(text, changed), path
        assert added <= len(encoding.encode(' new="&lt;x"')), path


@pytest.mark.slow
def test_a_removed_element_is_cut_out(sources: list[tuple[Path, bytes]]) -> None:
    chance = _CHANCE(3)
    for path, data, before in _roots(sources):
        after = copy.deepcopy(before)
        element = chance.choice(
            [child for node in after.iter(etree.Element) if len(node) > 1 for child in node] or [after]
        )
        parent = element.getparent()
        if parent is None:
            continue
        parent.remove(element)
        result = patch_xml(data, before, after)
        text, changed = decode_xml(data)[0], decode_xml(result)[0]
        assert _is_cut_out(changed, text), path
        assert len(list(parse_xml(result).iter())) == len(list(after.iter())), path
