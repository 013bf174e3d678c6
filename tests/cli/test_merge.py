"""merge: an edited step list into the file that it is a list of."""

from __future__ import annotations

import io
import json
import shutil
import sys
from types import SimpleNamespace

import pytest

import plcopen_sfc as sfc


@pytest.mark.slow
def test_a_list_goes_into_its_file_and_either_may_be_standard_input(cli, fixtures, tmp_path, monkeypatch):
    line, steps, told = tmp_path / "line.xml", tmp_path / "steps.csv", tmp_path / "told.json"
    shutil.copy(fixtures / "training-chain" / "codesys.xml", line)
    assert cli("convert", line, steps, "--partial", "-q", "--limit", 0).code == 0
    steps.write_bytes(steps.read_bytes().replace(b"S2", b"Wait"))
    before = line.read_bytes()
    shown = cli("merge", steps, line, "--dry-run", "--report", told)
    assert shown.code == 0
    assert json.loads(told.read_text())["changes"] == ["POU Ablauf / step S2: renamed to Wait"]
    assert line.read_bytes() == before
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(steps.read_bytes())))
    piped = cli("merge", "-", line, "--dry-run")
    assert (piped.code, piped.out) == (0, shown.out)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(before)))
    filtered = cli("merge", steps, "-", "--dry-run")
    assert filtered.out.splitlines()[2:] == shown.out.splitlines()[2:]
    assert cli("merge", steps, line).code == 0
    assert sfc.load(line).pou("Ablauf").chart.step("Wait").name == "Wait"
