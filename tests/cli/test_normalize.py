"""normalize: what it changes in place, and its exit codes."""

from __future__ import annotations

import json
import shutil

import plcopen_sfc as sfc

DRILL = "simaticml/FB_Drill.xml"


def test_it_changes_exports_of_tia_portal_once_and_leaves_others(cli, fixtures, tmp_path, monkeypatch):
    for name in (DRILL, "training-chain/codesys.xml"):
        shutil.copy(fixtures / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    before = (tmp_path / "FB_Drill.xml").read_bytes()
    assert cli("normalize", "*.xml", "--dry-run").out == "would be normalised: FB_Drill.xml\n"
    assert (tmp_path / "FB_Drill.xml").read_bytes() == before
    outcome = cli("normalize", "*.xml", "--json")
    assert outcome.code == 1
    assert [each["changed"] for each in json.loads(outcome.out)["files"]] == [True, False]
    project = sfc.load(fixtures / DRILL)
    assert (tmp_path / "FB_Drill.xml").read_bytes() == sfc.dumps(project, normalize=True)
    assert (tmp_path / "codesys.xml").read_bytes() == (fixtures / "training-chain/codesys.xml").read_bytes()
    assert cli("normalize", "*.xml").code == 0


def test_a_file_that_cannot_be_read_stops_no_other(cli, fixtures, tmp_path):
    shutil.copy(fixtures / DRILL, tmp_path)
    outcome = cli("normalize", "broken/not_xml.txt", tmp_path / "FB_Drill.xml")
    assert outcome.code == 2
    assert outcome.out.startswith("normalised: ")
    assert "not_xml.txt" in outcome.err
