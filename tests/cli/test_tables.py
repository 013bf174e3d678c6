"""Tables and file patterns."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console

from plcopen_sfc.cli.many_files import ManyFiles
from plcopen_sfc.cli.screen import Table
from plcopen_sfc.errors import FileAccessError

TABLE = Table(
    ["chart", "steps", "jumps", "macro-steps"],
    ["chart", "st.", "j.", "m."],
    [["Main", 12, "-", 0], ["A very long name of a chart, with [brackets]", 3, 1, 0]],
)


def drawn(table: Table, width: int) -> str:
    stream = io.StringIO()
    Console(file=stream, width=width, force_terminal=False).print(table.rich(width))
    return stream.getvalue()


def test_plain():
    assert TABLE.plain() == [
        "chart                                         steps  jumps  macro-steps",
        "Main                                             12      -            0",
        "A very long name of a chart, with [brackets]      3      1            0",
    ]


def test_plain_without_rows():
    assert Table(["a", "b"]).plain() == ["a  b"]


def test_on_a_wide_terminal():
    shown = drawn(TABLE, 120)
    assert "steps" in shown
    assert "A very long name of a chart, with [brackets]" in shown
    assert "macro" not in shown  # nothing but zeros


def test_on_a_narrow_terminal():
    shown = drawn(TABLE, 40)
    assert "st." in shown
    assert "steps" not in shown
    assert all(len(line) <= 40 for line in shown.splitlines())
    assert "12" in shown


def test_expand(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("b.xml", "a.xml", "c.txt", "[1].xml"):
        Path(name).touch()
    Path("folder.xml").mkdir()
    assert list(ManyFiles(("*.xml",)).found) == ["[1].xml", "a.xml", "b.xml"]
    assert list(
        ManyFiles(
            (
                "b.xml",
                "*.xml",
            )
        ).found
    ) == ["b.xml", "[1].xml", "a.xml"]
    assert list(ManyFiles(("[1].xml",)).found) == ["[1].xml"]
    assert list(ManyFiles(("missing.xml",)).found) == ["missing.xml"]
    with pytest.raises(FileAccessError, match="no file matches"):
        _ = ManyFiles(("*.zip",)).found
