"""Small exports of a PLC, as folders."""

from __future__ import annotations

import shutil
from pathlib import Path

from tests.corpus import ROOT

FIXTURES = ROOT / "fixtures" / "simaticml"
PLACES = {
    "FB_Drill.xml": "Program blocks/Station Süd",
    "FB_Drill_DB.xml": "Program blocks/Station Süd",
    "FB_Motor.xml": "Program blocks",
    "FC_Release.xml": "Program blocks",
    "Machine.xml": "Program blocks",
    "Station.xml": "PLC data types",
    "tags.xml": "PLC tags",
}


def export(folder: Path) -> Path:
    """The example project of TIA Portal as Openness exports a PLC: a folder in `folder`."""
    target = folder / "export"
    for name, place in PLACES.items():
        (target / place).mkdir(parents=True, exist_ok=True)
        shutil.copy(FIXTURES / name, target / place / name)
    return target


def contents(folder: Path) -> dict[str, bytes]:
    """Every file of a folder by its path in it."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def changes(before: dict[str, bytes], after: dict[str, bytes]) -> set[str]:
    """The files that are not the same, by path."""
    return {path for path in before.keys() | after.keys() if before.get(path) != after.get(path)}


def block(name: str, number: int = 1, *, version: str = "V20", comment: str = "") -> bytes:
    """A small global data block."""
    return (
        f'\ufeff<?xml version="1.0" encoding="utf-8"?>\r\n<Document>\r\n  <Engineering version="{version}" />\r\n'
        f'  <SW.Blocks.GlobalDB ID="0">{comment}\r\n    <AttributeList>\r\n      <Interface><Sections xmlns='
        '"http://www.siemens.com/automation/Openness/SW/Interface/v5">\r\n'
        '  <Section Name="Static">\r\n    <Member Name="x" Datatype="Bool" />\r\n  </Section>\r\n'
        f"</Sections></Interface>\r\n      <Name>{name}</Name>\r\n      <Number>{number}</Number>\r\n"
        "      <ProgrammingLanguage>DB</ProgrammingLanguage>\r\n    </AttributeList>\r\n"
        "  </SW.Blocks.GlobalDB>\r\n</Document>\r\n"
    ).encode()
