"""``plcopen-sfc info`` on documents of TIA Portal: versions, blocks with their numbers, what S7-GRAPH charts have."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.cli import main
from tests.corpus import ROOT

DRILL = ROOT / "fixtures" / "simaticml" / "FB_Drill.xml"
PLC = ROOT / "fixtures" / "simaticml-plc"


def told(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    capsys.readouterr()
    assert main([str(argument) for argument in arguments]) == 0
    return capsys.readouterr().out


def test_a_graph_block(capsys: pytest.CaptureFixture[str]) -> None:
    text = " ".join(told(capsys, "info", DRILL, "--no-charts").split())
    assert "tool TIA Portal V20" in text
    assert "blocks FB 10 FB_Drill" in text
    assert "texts de-DE, en-US" in text
    assert "GRAPH 6.0" in text
    assert "rules execution profile s7graph" in text
    assert re.search(r"seq\.|sequences", text)
    file: dict[str, Any] = json.loads(told(capsys, "info", DRILL, "--json"))["files"][0]
    (chart,) = file["charts"]
    assert {key: chart[key] for key in ("steps", "transitions", "sequences", "interlocks", "supervisions")} == {
        "steps": 10,
        "transitions": 11,
        "sequences": 2,
        "interlocks": 2,
        "supervisions": 1,
    }
    assert chart["graph_version"] == "6.0"
    assert file["blocks"] == ["FB 10 FB_Drill"]
    assert file["cultures"] == ["de-DE", "en-US"]
    assert file["totals"]["sequences"] == 2


@pytest.mark.slow
def test_rules_are_those_of_the_tool_whose_charts_a_file_keeps(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "block.xml"
    sfc.save(sfc.load(ROOT / "fixtures" / "codesys" / "distribution_belt.xml"), path, format="simaticml", partial=True)
    text = told(capsys, "info", path, "--no-charts")
    assert "rules    execution profile codesys (charts of CODESYS, which the file keeps)" in text
    path = tmp_path / "plan.json"
    sfc.save(sfc.load(ROOT / "fixtures" / "grafcet" / "forcing.gct"), path, format="json")
    text = told(capsys, "info", path, "--no-charts")
    assert "rules    execution profile grafcet (GRAFCETs (IEC 60848) as text, which the file keeps)" in text


def test_a_folder(capsys: pytest.CaptureFixture[str]) -> None:
    file: dict[str, Any] = json.loads(told(capsys, "info", PLC, "--json"))["files"][0]
    assert file["documents"] == 9
    assert file["blocks"][:2] == ["OB 1 Main", "FB 20 FB_Drilling"]
    assert [name.split()[0] for name in file["blocks"]] == ["OB", "FB", "FB", "FC", "DB", "DB", "DB"]


def test_protected_and_inconsistent_blocks(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    marks = b'<IsConsistent ReadOnly="true">false</IsConsistent>'
    marks += b'<IsKnowHowProtected ReadOnly="true">true</IsKnowHowProtected>'
    path = tmp_path / "block.xml"
    path.write_bytes(DRILL.read_bytes().replace(b"<GraphVersion>", marks + b"<GraphVersion>", 1))
    file: dict[str, Any] = json.loads(told(capsys, "info", path, "--json"))["files"][0]
    assert {finding["code"] for finding in file["findings"]} == {"XML211", "XML212"}


def test_other_files_have_none_of_it(capsys: pytest.CaptureFixture[str]) -> None:
    other = ROOT / "fixtures" / "codesys" / "sorting_conveyor.xml"
    file: dict[str, Any] = json.loads(told(capsys, "info", other, "--json"))["files"][0]
    assert not {"blocks", "cultures"} & file.keys()
    assert "sequences" not in file["totals"]
    assert "sequences" not in file["charts"][0]
    assert not re.search(r"seq\.|sequences", told(capsys, "info", other))
