"""diff: what it prints, its JSON and its exit codes."""

from __future__ import annotations

import io
import json
import sys
from types import SimpleNamespace

import pytest

import plcopen_sfc as sfc

CHAIN = "training-chain/codesys.xml"


@pytest.fixture
def edited(fixtures, tmp_path):
    """The training chain with a renamed step, and another condition of its first transition."""
    project = sfc.load(CHAIN)
    project.rename("Ablauf.S2", "Fill")
    project.pou("Ablauf").chart.transition("S1 -> Fill").condition = "B2"
    sfc.save(project, tmp_path / "edited.xml")
    return tmp_path / "edited.xml"


def test_changes_are_lines_below_their_pou(cli, edited):
    outcome = cli("diff", CHAIN, edited)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.splitlines() == [
        "POU Ablauf",
        "  step Fill: renamed, was S2",
        "  transition S1 -> Fill: condition B1 -> B2",
    ]
    assert cli("diff", CHAIN, edited, "--exit-code").code == 1


def test_the_same_file_has_no_differences(cli, fixtures):
    outcome = cli("diff", CHAIN, CHAIN, "--exit-code")
    assert (outcome.code, outcome.out) == (0, "no differences\n")
    assert cli("diff", CHAIN, CHAIN, "--quiet").out == ""


def test_json_has_every_change_and_the_proof(cli, edited):
    outcome = cli("diff", CHAIN, edited, "--json", "--prove", "--limit", "20")
    found = json.loads(outcome.out)
    assert (found["a"], found["b"], found["equal"]) == (CHAIN, str(edited), False)
    assert found["changes"] == [
        {"kind": "renamed", "path": "POU Ablauf / step Fill", "what": "step", "before": "S2", "after": "Fill"},
        {
            "kind": "changed",
            "path": "POU Ablauf / transition S1 -> Fill",
            "what": "transition",
            "aspect": "condition",
            "before": "B1",
            "after": "B2",
        },
    ]
    (proof,) = found["proofs"]
    assert (proof["path"], proof["verdict"]["equal"]) == ("POU Ablauf", False)
    assert len(proof["verdict"]["counterexample"]["inputs"]) > 0


def test_one_of_both_may_be_standard_input(cli, edited, monkeypatch):
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(edited.read_bytes())))
    assert "step Fill: renamed, was S2" in cli("diff", CHAIN, "-").out
    outcome = cli("diff", "-", "-")
    assert outcome.code == 2
    assert "standard input cannot be both files" in outcome.err


def test_a_limit_that_is_none_is_an_error(cli, fixtures):
    outcome = cli("diff", CHAIN, CHAIN, "--prove", "--limit", "soon")
    assert (outcome.code, outcome.out) == (2, "")
    assert "'soon' is no time limit" in outcome.err


def test_a_file_that_cannot_be_read_is_an_error(cli, fixtures):
    assert cli("diff", CHAIN, "broken/truncated.xml").code == 2
    outcome = cli("diff", "broken/jump_to_nowhere.xml", "broken/jump_to_nowhere.xml")
    assert (outcome.code, outcome.out) == (0, "no differences\n")
    assert "jump" in outcome.err  # what is wrong with it is in no comparison


def test_files_of_other_tools_in_a_folder_of_tia_are_named(cli, fixtures, tmp_path):
    for source in ("simaticml-training-chain/Ablauf.xml", "training-chain/codesys.xml"):
        (tmp_path / source.rpartition("/")[2]).write_bytes((fixtures / source).read_bytes())
    outcome = cli("diff", tmp_path, tmp_path)
    assert (outcome.code, outcome.out) == (0, "no differences\n")
    assert "its files of codesys are no part of it: codesys.xml" in outcome.err


def test_the_files_of_two_folders_are_compared_by_name(cli, edited, fixtures, tmp_path):
    for name, sources in {"a": ["codesys.xml", "plcopen_2.0.xml"], "b": ["codesys.xml", "iec-text.st"]}.items():
        (tmp_path / name / "sub").mkdir(parents=True)
        for source in sources:
            (tmp_path / name / "sub" / source).write_bytes((fixtures / "training-chain" / source).read_bytes())
    (tmp_path / "b" / "sub" / "codesys.xml").write_bytes(edited.read_bytes())
    outcome = cli("diff", tmp_path / "a", tmp_path / "b", "--exit-code")
    assert (outcome.code, outcome.err) == (1, "")
    assert outcome.out.splitlines() == [
        "== sub/codesys.xml",
        "POU Ablauf",
        "  step Fill: renamed, was S2",
        "  transition S1 -> Fill: condition B1 -> B2",
        "== sub/iec-text.st",
        "POU Ablauf: added (functionBlock)",
        "== sub/plcopen_2.0.xml",
        "POU Ablauf: removed (functionBlock)",
    ]
    (tmp_path / "b" / "sub" / "damaged.xml").write_bytes((fixtures / "broken" / "truncated.xml").read_bytes())
    outcome = cli("diff", tmp_path / "a", tmp_path / "b", "--json")
    found = json.loads(outcome.out)
    assert (outcome.code, found["equal"]) == (2, False)
    assert [file["file"] for file in found["files"]] == [
        "sub/codesys.xml", "sub/damaged.xml", "sub/iec-text.st", "sub/plcopen_2.0.xml"
    ]  # fmt: skip
    assert "error" in found["files"][1]
    assert cli("diff", tmp_path / "a", tmp_path / "a").out == "no differences\n"
