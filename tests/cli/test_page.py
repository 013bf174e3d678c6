"""``plcopen-sfc page``: to a file, to standard output, and what is wrong with it."""

from __future__ import annotations

import json
import shutil

import pytest

import plcopen_sfc as sfc


def test_a_page_beside_the_source_and_on_standard_output(cli, fixtures, tmp_path):
    source = shutil.copy(fixtures / "iectext" / "mixing_plant.st", tmp_path)
    expected = sfc.page(sfc.load(source), lang="de")
    outcome = cli("page", source, "--lang", "de")
    assert (outcome.code, outcome.out) == (0, f"written: {tmp_path / 'mixing_plant.html'}\n")
    assert (tmp_path / "mixing_plant.html").read_text(encoding="ascii") == expected
    assert cli("page", source, "-", "--lang", "de").out == expected
    target = tmp_path / "other.html"
    assert json.loads(cli("page", source, target, "--json").out) == {"file": str(source), "page": str(target)}


def test_a_folder_has_its_page_beside_it(cli, fixtures, tmp_path):
    shutil.copytree(fixtures / "twincat-belt", tmp_path / "belt")
    assert cli("page", tmp_path / "belt").out == f"written: {tmp_path / 'belt.html'}\n"


def test_an_unknown_language_writes_nothing(cli, fixtures, tmp_path):
    outcome = cli("page", "iectext/mixing_plant.st", tmp_path / "x.html", "--lang", "fr")
    assert (outcome.code, list(tmp_path.iterdir())) == (2, [])
    assert "There are: en, de" in outcome.err


def test_diff_saves_a_page(cli, fixtures, tmp_path):
    page = tmp_path / "diff.html"
    outcome = cli("diff", "training-chain/codesys.xml", "simaticml-training-chain/Ablauf.xml", "--html", page)
    assert outcome.code == 0
    assert f"written: {page}" in outcome.err
    assert "step S3: interlock B5 added" in outcome.out
    assert "step S3</b>: interlock B5 added" in page.read_text(encoding="ascii")
    refused = cli("diff", "training-chain", "codesys", "--html", page)  # many pairs of files
    assert refused.code == 2


@pytest.mark.slow
def test_the_report_of_a_conversion_is_a_page(cli, fixtures, tmp_path):
    page, target = tmp_path / "drill.html", tmp_path / "drill.xml"
    options = ("--to", "codesys", "--limit", "0", "--lang", "de", "--report", page)
    outcome = cli("convert", "simaticml/FB_Drill.xml", target, *options)
    assert (outcome.code, target.exists()) == (1, False)
    assert "es wurde nichts geschrieben" in page.read_text(encoding="ascii")
    assert cli("convert", "simaticml/FB_Drill.xml", target, "--partial", *options).code == 0
    text = page.read_text(encoding="ascii")
    assert text.count("<svg") == 4  # each sequence in both tools
    assert "Nicht ausgef&#252;hrt" in text
    page.unlink()
    assert cli("convert", "simaticml/FB_Drill.xml", "-", "--partial", *options).code == 0
    assert page.read_text(encoding="ascii") == text.replace(f"{target.name}, ", "").replace(f", {target.name}", "")


@pytest.mark.slow
def test_a_page_marks_what_a_comparison_with_another_file_did_not_reach(cli, fixtures, tmp_path):
    source, other, target = "codesys/sorting_conveyor.xml", tmp_path / "other.xml", tmp_path / "x.html"
    cli("convert", source, other, "--to", "plcopen-2.01", "--partial", "--quiet", "--limit", "0")
    outcome = cli("page", source, target, "--against", other, "--pou", "FB_Pusher", "--limit", "2s")
    assert outcome.code == 0
    assert "FB_Pusher: equal" in outcome.out + outcome.err
    assert 'id="coverage"' in target.read_text(encoding="ascii")
    wrong = cli("page", source, target, "--against", other, "--pou", "FB_Pushed")
    assert wrong.code == 2
    assert "FB_Pusher" in wrong.err
