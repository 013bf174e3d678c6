"""Reading a file as the tool of its format sees it: nothing of what only this package reads."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.documents import as_tool_sees
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.model.compare import differences

TARGETS = ["plcopen-1.01", "plcopen-2.01", "codesys", "simaticml", "scl", "iec-text"]
FIXTURES = Path(__file__).parents[2] / "fixtures"
FILES = ["codesys/device_export.xml", "plcopen/filling_station_2.01.xml", "simaticml/FB_Drill.xml"]


def seen(content: bytes, target: str) -> bytes:
    return as_tool_sees(content, format_named(target)[0])


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", FILES)
def test_nothing_of_ours_is_left(name: str, target: str) -> None:
    content = sfc.dumps(sfc.load(FIXTURES / name), format=target, fresh=True)
    left = seen(content, target)
    text = left.decode("utf-8-sig").replace("{plcopen_sfc format", "").replace("{plcopen_sfc project.dialect", "")
    assert "plcopen_sfc " not in text
    assert "urn:plcopen-sfc:" not in text
    assert seen(left, target) == left
    assert left.count(b"\n") == content.count(b"\n"), "everything stays in its line"
    project = sfc.loads(content, format=target, as_tool=True)
    assert list(differences(project, sfc.loads(left, format=target))) == []
    assert project._origin is not None
    assert project._origin.content == left
