"""``plcopen-sfc lower``."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from tests.cli.conftest import Outcome
from tests.lowering.charts import training_chain

Cli = Callable[..., Outcome]


@pytest.fixture
def plant(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    sfc.save(m.Project(name="Anlage", pous=[training_chain()]), "plant.xml", format="plcopen-2.01")
    return tmp_path


def test_writes_code_that_is_proven(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "out.st", "--to", "iec-text", "--as", "case", "--lang", "de")
    assert done.code == 0
    assert "equal (proof" in done.out
    text = (plant / "out.st").read_text(encoding="utf-8")
    assert "CASE schrittnummer OF" in text
    assert sfc.load("out.st").pou("Ablauf").sfc is None


def test_a_classic_chain_is_written_and_its_fault_is_shown(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "--to", "plcopen", "--as", "fup", "--style", "classic", "--init", "Init")
    assert done.code == 1
    assert "different after" in done.out
    assert "shortest input trace" in done.out
    assert (plant / "plant-lowered.xml").is_file()


def test_as_json(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "out.xml", "--to", "codesys", "--as", "bits", "--profile", "iec", "--json")
    data = json.loads(done.out)
    assert (data["construction"], data["profile"], data["file"]) == ("bits", "iec", "out.xml")
    assert data["proof"]["outcome"] == "equal (proof)"


def test_what_cannot_be_said_is_refused_and_nothing_is_written(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "out.xml", "--to", "codesys", "--as", "case", "--language", "LD")
    assert done.code == 2
    assert "cannot be drawn in LD" in done.err
    assert not (plant / "out.xml").exists()
