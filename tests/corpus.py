"""Where the real files and the official schemas lie: beside the repository, never in it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CORPUS = Path(os.environ.get("PLCOPEN_SFC_CORPUS") or ROOT.parent / "shared" / "corpus")
XSD = Path(os.environ.get("PLCOPEN_SFC_XSD") or ROOT.parent / "shared" / "xsd")

_NO_PROJECTS = {".jpg", ".jpeg", ".png", ".gif", ".pdf", ".zip", ".md", ".html"}
_OFFICIAL = {
    "1.0": "plcopen/TC6_XML_V10.xsd",
    "1.01": "plcopen/TC6_XML_V10_B.xsd",
    "2.0": "plcopen/tc6_xml_v200.xsd",
    "2.01": "plcopen/tc6_xml_v201.xsd",
}


def corpus_files(kind: str) -> list[Path]:
    """The files of a format (`plcopen`, `codesys`, `twincat` ...), without pictures and the like; [] without corpus."""
    folder = CORPUS / kind
    files = (path for path in folder.rglob("*") if path.is_file()) if folder.is_dir() else iter(())
    return sorted(path for path in files if path.suffix.lower() not in _NO_PROJECTS)


def require_corpus() -> Path:
    """The folder of the corpus; skips the test where there is none."""
    if not CORPUS.is_dir():
        pytest.skip(f"no corpus at {CORPUS} (set PLCOPEN_SFC_CORPUS)")
    return CORPUS


def official_schema(version: str) -> Path | None:
    """The published schema of a version of TC6 XML; None where it is missing."""
    path = XSD / _OFFICIAL[version]
    return path if path.is_file() else None


def require_official_schema(version: str) -> Path:
    """The published schema of a version of TC6 XML; skips the test where it is missing."""
    path = official_schema(version)
    if path is None:
        pytest.skip(f"no official schema of TC6 {version} at {XSD} (set PLCOPEN_SFC_XSD)")
    return path
