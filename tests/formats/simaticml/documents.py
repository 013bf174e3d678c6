"""The documents of TIA Portal Openness that tests run over."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest
from lxml import etree

from tests.corpus import ROOT, corpus_files
from tests.sweeps import WHOLE, some_of

FIXTURES = ROOT / "fixtures" / "simaticml"
FIXTURE_PARAMS = [pytest.param(path, id=path.name) for path in sorted(FIXTURES.glob("*.xml"))]


@cache
def real_documents() -> tuple[Path, ...]:
    """The documents of the corpus; other files there are parts of documents, templates and notes."""
    return tuple(path for path in corpus_files("simaticml") if path.suffix == ".xml" and is_document(path))


def is_document(path: Path) -> bool:
    """True if a file is a whole document."""
    try:
        return bool(parsed(path.read_bytes()).tag == "Document")
    except etree.XMLSyntaxError:
        return False


def parsed(data: bytes) -> etree._Element:
    """The root of a document."""
    return etree.fromstring(data, etree.XMLParser(huge_tree=True))


CORPUS_PARAMS = [
    pytest.param(path, id=f"{number:03}-{path.name[:40]}", marks=pytest.mark.corpus)
    for number, path in enumerate(real_documents())
] or [
    pytest.param(
        None, marks=[pytest.mark.corpus, pytest.mark.skip("no corpus beside the repository (see tests/corpus.py)")]
    )
]
ALL_PARAMS = [*FIXTURE_PARAMS, *CORPUS_PARAMS]
SOME_PARAMS = [*FIXTURE_PARAMS, *some_of(CORPUS_PARAMS, 3)]
"""For sweeps that take long: many documents of the corpus are versions of one."""
GRAPH_PARAMS = [
    param
    for param in ALL_PARAMS
    if isinstance(path := param.values[0], Path) and b"NetworkSource/Graph/v" in path.read_bytes()
]
SOME_GRAPH_PARAMS = [
    param for param in GRAPH_PARAMS if WHOLE or param in FIXTURE_PARAMS or GRAPH_PARAMS.index(param) % 3 == 0
]
