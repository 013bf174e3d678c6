"""convert: what it writes and what it says about it."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc
from tests.conversion.test_flags_in_tc6 import LONG_BRANCHES
from tests.conversion.test_flags_in_tia import chart_with
from tests.conversion.test_running import UNREACHED

BELT = "codesys/sorting_conveyor.xml"


@pytest.mark.slow
def test_to_json_and_back(cli, fixtures, tmp_path):
    model, back = tmp_path / "model.json", tmp_path / "back.xml"
    assert cli("convert", BELT, model, "--to", "json").code == 0
    assert sfc.load(model) == sfc.load(BELT)
    assert cli("convert", model, back, "--to", "codesys", "--limit", "0").code == 0
    steps = [[step.name for step in chart.chart.steps] for chart in sfc.load(back).charts()]
    assert steps == [[step.name for step in chart.chart.steps] for chart in sfc.load(BELT).charts()]


def test_same_format_is_the_same_file(cli, fixtures, tmp_path):
    outcome = cli("convert", BELT, tmp_path / "same.xml", "--to", "codesys")
    assert outcome.code == 0
    assert (tmp_path / "same.xml").read_bytes() == (fixtures / BELT).read_bytes()
    assert "the format is the same" in outcome.out


@pytest.mark.slow
def test_one_command_makes_files_of_several_formats(cli, fixtures, tmp_path):
    made = ("convert", "steplist/mixer.csv", f"{tmp_path}/out/", "--to", "codesys,simaticml", "--limit", "0")
    result = json.loads(cli(*made, "--tia", "V17", "--json").out)
    assert [*result["formats"]] == ["codesys", "simaticml"]
    assert sorted(path.name for path in Path(tmp_path, "out").iterdir()) == ["mixer.codesys.xml", "mixer.simaticml"]
    assert sfc.load(tmp_path / "out" / "mixer.simaticml").pou("Mixer").chart.step("Fill").number == 10
    for several, wrong in (("codesys,scll", "no format 'scll'"), ("codesys,scl", "need a folder")):
        refused = cli("convert", "steplist/mixer.csv", tmp_path / "one.xml", "--to", several)
        assert refused.code == 2
        assert wrong in refused.err


@pytest.mark.slow
def test_inputs_without_effect_are_named_with_the_option(cli, fixtures, tmp_path):
    """Several names go into one option, and then nothing is left."""
    drill = sfc.load(fixtures / "simaticml" / "FB_Drill.xml")
    section = next(each for each in drill.pou("FB_Drill").interface.sections if each.kind == "input")
    section.variables.append(section.variables[0].model_copy(update={"name": "HALT_SQ"}))
    sfc.save(drill, tmp_path / "drill.xml", format="simaticml")
    arguments = ("convert", tmp_path / "drill.xml", tmp_path / "out.xml", "--to", "codesys", "--limit", "0")
    told = cli(*arguments).out
    [option] = [line.partition("convert again with ")[2] for line in told.splitlines() if "convert again with" in line]
    assert option.startswith("--at-rest ")
    assert "HALT_SQ" in option
    assert "convert again with" not in cli(*arguments, *option.rstrip(".").split()).out


def test_a_flag_without_effect_is_told_with_what_is_in_the_way(cli, tmp_path):
    source = tmp_path / "branches.xml"
    sfc.save(chart_with("SFCReset", chart=LONG_BRANCHES), source, format="codesys")
    told = cli("convert", source, f"{tmp_path}/out/", "--to", "simaticml", "--limit", "0").out
    assert "operating inputs without effect: SFCReset\n      SFCReset: several of its steps may be active" in told


@pytest.mark.slow
def test_sequences_that_become_loops_are_told_with_the_option_that_keeps_them(cli, fixtures, tmp_path):
    out = tmp_path / "out.xml"
    arguments = ("convert", "simaticml/FB_Drill.xml", out, "--to", "codesys", "--partial", "--limit", "0")
    told = [line for line in cli(*arguments).err.splitlines() if "keeps their sequences" in line]
    assert len(told) == 1
    assert told[0].startswith("POU FB_Drill: ")
    assert any(
        step.name.endswith("_rests") for chart in sfc.load(out, as_tool=True).charts() for step in chart.chart.steps
    )
    option = re.search(r"--at-rest \S+", told[0])[0]
    assert "keeps their sequences" not in cli(*arguments, *option.split()).err
    assert not any(
        step.name.endswith("_rests") for chart in sfc.load(out, as_tool=True).charts() for step in chart.chart.steps
    )


@pytest.mark.slow
def test_fresh_writes_from_the_model(cli, fixtures, tmp_path):
    outcome = cli("convert", BELT, tmp_path / "fresh.xml", "--to", "codesys", "--fresh", "--limit", "0")
    assert outcome.code == 0
    assert "items: " in outcome.out
    assert len(list(sfc.load(tmp_path / "fresh.xml").charts())) == 3


@pytest.mark.slow
@pytest.mark.parametrize("version", ["1.01", "2.0", "2.01"])
def test_to_plcopen(cli, fixtures, tmp_path, version):
    target = tmp_path / "belt.xml"
    outcome = cli(
        "convert",
        BELT,
        target,
        "--to",
        f"plcopen-{version}",
        "--partial",
        "--limit",
        0,
        "--report",
        tmp_path / "report.json",
    )
    assert outcome.code == 0
    assert any(line.startswith("items: ") and " kept, " in line for line in outcome.out.splitlines())
    assert outcome.out.splitlines()[-1] == f"written: {target}"
    assert "\x1b" not in outcome.out
    report = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert report["target_format"] == f"plcopen-{version}"
    assert report["written"] == [str(target)]
    steps = [item for item in report["items"] if item["what"] == "step"]
    others = {item["path"].rpartition(" / step ")[2] for item in steps if item["outcome"] != "kept"}
    assert others == {"SFCReset_begins"}, "added for an SFC flag"
    assert len(steps) == 34
    assert cli("validate", target).code == 0


@pytest.mark.slow
def test_for_beremiz(cli, fixtures, tmp_path):
    outcome = cli(
        "convert",
        BELT,
        tmp_path / "beremiz.xml",
        "--to",
        "plcopen",
        "--partial",
        "--for",
        "beremiz",
        "-q",
        "--limit",
        0,
    )
    assert outcome.code == 0
    assert outcome.out == outcome.err == ""
    assert (tmp_path / "beremiz.xml").exists()
    unknown = cli("convert", BELT, tmp_path / "x.xml", "--to", "plcopen", "--for", "nobody")
    assert unknown.code == 2
    assert "no flavour 'nobody'" in unknown.err


@pytest.mark.slow
def test_what_no_machine_executes_is_counted_and_listed_on_request(cli, fixtures, tmp_path):
    arguments = ["convert", BELT, tmp_path / "belt", "--to", "simaticml", "--partial", "--limit", 0]
    short, long = cli(*arguments).out, cli(*arguments, "--verbose").out
    assert short.startswith("NOT EXECUTED in the target")
    assert not any(line.startswith(("extension data", "translated")) for line in short.splitlines())
    assert re.search(r"^items: .*\d+ extension data.*--verbose lists them", short, re.MULTILINE)
    assert any(line.startswith("extension data: ") for line in long.splitlines())
    assert any(line.split()[:2] == ["what", "kept"] for line in long.splitlines())


@pytest.mark.slow
def test_usual_target_stands_beside_the_source(cli, fixtures, tmp_path):
    source = tmp_path / "belt.xml"
    shutil.copy(BELT, source)
    before = source.read_bytes()
    assert cli("convert", source, "--to", "plcopen-2.01", "--partial", "--limit", 0).code == 0
    assert cli("convert", source, "--to", "json").code == 0
    assert cli("convert", source, "--to", "codesys").code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "belt.codesys.xml",
        "belt.json",
        "belt.plcopen-2.01.xml",
        "belt.xml",
    ]
    assert source.read_bytes() == before


@pytest.mark.slow
def test_the_usual_target_is_a_folder_for_tools_that_import_one_object_a_file(cli, fixtures, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(fixtures / "training-chain" / "codesys.xml", "chain.xml")
    options = ("--limit", "0")
    assert cli("convert", "chain.xml", "--to", "twincat", *options).code == 0
    assert cli("convert", "chain.xml", "--to", "simaticml", *options).code == 0
    assert Path("chain.twincat", "POUs", "Ablauf.TcPOU").is_file()
    block = Path("chain.simaticml", "Program blocks", "Ablauf.xml")
    assert block.is_file()
    assert cli("convert", block, "--to", "simaticml-V16", *options).code == 0  # what is one file already stays one
    assert block.with_name("Ablauf.simaticml-V16.xml").is_file()
    shutil.copy("chain.xml", "other.xml")
    assert cli("convert", "chain.xml", "other.xml", "out/", "--to", "simaticml", *options).code == 0
    assert all(Path("out", name, "Program blocks", "Ablauf.xml").is_file() for name in ("chain", "other"))
    assert cli("lower", "chain.xml", "--to", "simaticml", "--no-verify").code == 0
    assert Path("chain-lowered", "Program blocks", "Ablauf.xml").is_file()


def test_usual_target_never_is_the_source(cli, fixtures, tmp_path):
    model = tmp_path / "belt.json"
    assert cli("convert", BELT, model, "--to", "json").code == 0
    before = model.read_bytes()
    assert cli("convert", model, "--to", "json").code == 0
    assert model.read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["belt.json", "belt.json.json"]


def test_explicit_target_may_be_the_source(cli, fixtures, tmp_path):
    source = tmp_path / "belt.xml"
    shutil.copy(BELT, source)
    assert cli("convert", source, source, "--to", "json").code == 0
    assert source.read_bytes().startswith(b"{")


@pytest.mark.slow
def test_to_standard_output(command, fixtures):
    done = command("convert", BELT, "-", "--to", "codesys")
    assert done.returncode == 0
    assert done.stdout == (fixtures / BELT).read_bytes()
    assert b"the format is the same" in done.stderr


def test_standard_output_and_json_exclude_each_other(cli, fixtures):
    outcome = cli("convert", BELT, "-", "--to", "json", "--json")
    assert outcome.code == 2
    assert "--report" in outcome.err


@pytest.mark.slow
def test_json_report(cli, fixtures, tmp_path):
    outcome = cli("convert", BELT, tmp_path / "belt.xml", "--to", "plcopen-2.01", "--partial", "--limit", 0, "--json")
    report = json.loads(outcome.out)
    assert report["source_format"] == "codesys"
    assert report["items"]


class TestStrict:
    """To CODESYS, which does not have all qualifiers of the standard."""

    SOURCE = "plcopen/filling_station_2.01.xml"

    @pytest.mark.slow
    def test_refuses_and_writes_nothing(self, cli, fixtures, tmp_path):
        target, report = tmp_path / "belt.xml", tmp_path / "report.json"
        outcome = cli("convert", self.SOURCE, target, "--to", "codesys", "--strict", "--report", report)
        assert outcome.code == 1
        assert not target.exists()
        assert "would be executed otherwise or not at all" in outcome.err
        assert "Nothing was written" in outcome.err
        assert "NOT EXECUTED in the target: 1\n  POU FillingStation\n    step Cap (line 1267)\n" in outcome.out
        assert "      action: `DL Y4_CapTorque` is not executed" in outcome.out
        assert any(
            item["outcome"] == "approximated" for item in json.loads(report.read_text(encoding="utf-8"))["items"]
        )
        assert "written:" not in outcome.out

    def test_without_it_the_file_is_written(self, cli, fixtures, tmp_path):
        outcome = cli(
            "convert", self.SOURCE, tmp_path / "filling.xml", "--to", "codesys", "--partial", "--limit", 0, "--json"
        )
        assert outcome.code == 0
        assert any(item["outcome"] == "not executed" for item in json.loads(outcome.out)["items"])
        assert (tmp_path / "filling.xml").exists()

    def test_does_not_stop_what_loses_nothing(self, cli, fixtures, tmp_path):
        assert cli("convert", BELT, tmp_path / "belt.json", "--to", "json", "--strict").code == 0


def test_items_with_one_reason_are_in_one_place(cli, tmp_path):
    """The refusal repeated what is above it; a machine that reads the errors alone still gets it."""
    source = tmp_path / "pointers.st"
    block = "FUNCTION_BLOCK {}\nVAR p, q : POINTER TO DWORD; r : POINTER TO INT; END_VAR\nEND_FUNCTION_BLOCK\n"
    source.write_text(block.format("A") + block.format("B"), encoding="utf-8")
    outcome = cli("convert", source, tmp_path / "x.scl", "--to", "scl")
    assert outcome.code == 1
    lines = outcome.out.splitlines()
    first = lines.index("  type: TIA Portal has no type POINTER TO DWord")
    assert lines[first + 1 : first + 3] == ["    POU A: p, q", "    POU B: p, q"]
    assert "POINTER" not in outcome.err
    assert "POINTER" in cli("convert", source, tmp_path / "x.scl", "--to", "scl", "--quiet").err


def test_an_item_alone_has_the_line_of_its_text(cli, tmp_path):
    project = sfc.loads(
        b"FUNCTION_BLOCK A\nVAR x : REAL; n : INT; END_VAR\nn := 0;\nn := REAL_TO_INT(x);\nEND_FUNCTION_BLOCK\n"
    )
    project.dialect = "codesys"
    sfc.save(project, tmp_path / "a.xml", format="codesys")
    for options in ((), ("--verbose",)):
        outcome = cli("convert", tmp_path / "a.xml", tmp_path / "a.scl", "--to", "scl", *options)
        assert re.search(r"approximated: text POU A \(line \d+\): line 2: REAL_TO_INT", outcome.out)


@pytest.mark.slow
def test_what_is_not_executed_is_refused(cli, fixtures, tmp_path):
    target, report = tmp_path / "drill.xml", tmp_path / "report.json"
    arguments = ("convert", "simaticml/FB_Drill.xml", target, "--to", "codesys", "--report", report)
    arguments += ("--limit", "60s")  # the usual one may end a proof on a busy machine, and be told otherwise
    outcome = cli(*arguments)
    assert outcome.code == 1
    assert outcome.out.startswith("NOT EXECUTED in the target: ")
    assert "--partial" in outcome.err
    assert not target.exists()
    refused = json.loads(report.read_text(encoding="utf-8"))["items"]
    assert cli(*arguments, "--partial", "--accept-untested").code == 0
    assert json.loads(report.read_text(encoding="utf-8"))["items"] == refused
    assert target.exists()


def test_findings_in_the_source(cli, fixtures, tmp_path):
    """Nothing is written, unless that is asked for: then the errors show in report and exit code."""
    arguments = ("convert", "broken/two_initial_steps.xml", tmp_path / "x.json", "--to", "json")
    outcome = cli(*arguments)
    assert outcome.code == 2
    assert "SFC110" in outcome.err
    assert "--accept-errors" in outcome.err
    assert list(tmp_path.iterdir()) == []
    outcome = cli(*arguments, "--accept-errors")
    assert outcome.code == 1
    assert "approximated: error POU" in outcome.out
    assert (tmp_path / "x.json").exists()
    assert cli(*arguments, "--accept-errors", "--strict").code == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nowhere.xml", "--to", "json"], "nowhere.xml: the file does not exist"),
        (["codesys", BELT, "--to", "json"], f"{BELT}: several files need a folder to be written into"),
        ([BELT, "--to", "word"], "there is no format 'word'"),
        ([BELT, "nowhere/x.json", "--to", "json"], "nowhere/x.json: the folder to write into does not exist"),
    ],
)
def test_wrong_usage(cli, fixtures, arguments, message):
    outcome = cli("convert", *arguments)
    assert outcome.code == 2
    assert outcome.err.startswith(f"error: {message}")
    assert outcome.out == ""


@pytest.mark.parametrize("target", ["there", "there/", "new/"])
def test_a_file_is_written_into_a_folder_by_its_name(cli, fixtures, tmp_path, target):
    (tmp_path / "there").mkdir()
    source = fixtures / "steplist" / "mixer.csv"
    outcome = cli("convert", source, f"{tmp_path}/{target}", "--to", "json", "--json")
    assert outcome.code == 0
    (written,) = tmp_path.glob("*/*.json")
    assert written == tmp_path / target / "mixer.json"
    assert json.loads(outcome.out)["written"] == [str(written)]
    again = cli("convert", written, f"{tmp_path}/{target}", "--to", "json")
    assert again.code == 2
    assert "which is read too" in again.err


@pytest.mark.slow
def test_as_its_tool_reads_a_file(cli, fixtures, tmp_path):
    source = tmp_path / "conveyor.scl"
    assert (
        cli(
            "convert", fixtures / "codesys" / "sorting_conveyor.xml", source, "--to", "scl", "--partial", "--limit", 0
        ).code
        == 0
    )
    assert cli("convert", source, tmp_path / "whole.json", "--to", "json").code == 0
    assert cli("convert", source, tmp_path / "seen.json", "--to", "json", "--as-tool").code == 0
    actions = [len(sfc.load(tmp_path / name).pou("PLC_PRG").actions) for name in ("whole.json", "seen.json")]
    assert actions == [20, 0]
    assert cli("convert", source, tmp_path / "plain.scl", "--to", "scl", "--as-tool", "--limit", 0).code == 0
    assert b"{plcopen_sfc " in source.read_bytes()
    assert b"{plcopen_sfc " not in (tmp_path / "plain.scl").read_bytes()


def test_charts_that_are_not_run_for_one_reason_are_in_one_line(cli: Any, fixtures: Path, tmp_path: Path) -> None:
    source = fixtures / "codesys" / "sorting_conveyor.xml"
    out = cli("convert", source, tmp_path / "out.scl", "--to", "scl", "--partial").out
    (line,) = [line for line in out.splitlines() if "not compared" in line]
    assert line.startswith("POU PLC_PRG, POU PLC_PRG / action ACT_Home, POU FB_Pusher: not compared: ")
    assert line.endswith("change that in the source, or test it in TIA Portal")


@pytest.mark.slow
def test_a_chart_of_which_not_all_was_reached_is_a_finding(cli: Any, tmp_path: Path) -> None:
    source, target = tmp_path / "main.st", tmp_path / "out.xml"
    source.write_text(UNREACHED)
    result = cli("convert", source, target, "--to", "codesys")
    assert result.code == 1
    assert "not all was reached" in result.out
    assert "S1" in result.out
    assert "--accept-untested" in result.err
    assert target.exists()
    assert cli("convert", source, target, "--to", "codesys", "--accept-untested").code == 0
    assert cli("convert", source, target, "--to", "codesys", "--limit", "0").code == 0


def test_a_chart_that_nothing_executes_in_the_target_is_a_finding(cli: Any, tmp_path: Path) -> None:
    source, target = tmp_path / "main.st", tmp_path / "out.csv"
    source.write_text(UNREACHED)
    result = cli("convert", source, target, "--to", "csv")
    assert result.code == 1
    assert "POU Main: not compared, as nothing executes a step list" in result.out
    assert "not simulated for both tools: 1 chart: --accept-untested" in " ".join(result.err.split())
    assert cli("convert", source, target, "--to", "csv", "--accept-untested").code == 0


def test_a_place_does_not_say_twice_what_it_is(cli: Any, tmp_path: Path) -> None:
    source = tmp_path / "block.scl"
    source.write_text('DATA_BLOCK "Recipe"\n   STRUCT\n      n : Int;\n   END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n')
    outcome = cli("convert", source, tmp_path / "out.xml", "--to", "codesys", "--verbose")
    assert "translated: data block Recipe" in outcome.out
    assert "data block data block" not in outcome.out


@pytest.mark.slow
def test_without_a_run_the_result_says_so(cli, fixtures, tmp_path):
    told = "no chart was simulated for both tools (--no-verify)"
    source, target = "training-chain/codesys.xml", tmp_path / "out.xml"
    assert told in cli("convert", source, target, "--to", "plcopen-2.01", "--limit", 0).err
    assert told in cli("convert", source, target, "--to", "plcopen-2.01", "--no-verify").err
    assert told not in cli("convert", source, target, "--to", "plcopen-2.01", "--limit", 20, "--strict").err


@pytest.mark.slow
def test_a_single_file_for_tia_portal_names_the_folder_form(cli: Any, fixtures: Path, tmp_path: Path) -> None:
    arguments = ("--to", "simaticml", "--limit", "0")
    outcome = cli("convert", BELT, tmp_path / "belt.xml", "--partial", *arguments)
    assert "for the import into TIA Portal write a folder (belt/ --to simaticml)" in " ".join(
        f"{outcome.out} {outcome.err}".split()
    )
    outcome = cli("convert", BELT, f"{tmp_path}/belt/", "--partial", *arguments)
    assert "for the import" not in outcome.out + outcome.err


def test_the_extension_of_the_target_tells_the_format_and_else_it_is_to_be_named(tmp_path, cli, fixtures):
    assert cli("convert", BELT, tmp_path / "belt.json", "--limit", 0).code == 0
    assert sfc.load(tmp_path / "belt.json").source.format == "json"
    for arguments, message in [
        ((BELT,), "the format to write is not named"),
        ((BELT, "-"), "the format to write is not named"),
        ((BELT, BELT, f"{tmp_path}/"), "the format to write is not named"),
        ((BELT, tmp_path / "out.xml"), "of several formats: codesys, plcopen, simaticml"),
        ((BELT, tmp_path / "out.txt"), "the extension .txt is of no format"),
    ]:
        refused = cli("convert", *arguments)
        assert refused.code == 2
        assert message in refused.err
    assert "the format to write is not named" in cli("lower", BELT).err


INEXACT = """PROGRAM Main
VAR_INPUT a : BOOL; b : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP Idle: END_STEP
TRANSITION FROM Idle TO Work := a; END_TRANSITION
STEP Work: q(N); END_STEP
TRANSITION FROM Work TO Idle := b; END_TRANSITION
END_PROGRAM
"""


@pytest.mark.parametrize("negated", [True, False])
def test_lower_is_offered_where_the_target_has_no_exact_chart(cli: Any, tmp_path: Path, negated: bool) -> None:
    project = sfc.loads(INEXACT.encode(), format="iec-text")
    project.pou("Main").chart.step("Work").actions[0].negated = negated
    sfc.save(project, tmp_path / "in.xml", format="plcopen-2.01")
    arguments = (
        "convert",
        tmp_path / "in.xml",
        tmp_path / "out.xml",
        "--to",
        "codesys",
        "--report",
        tmp_path / "r.html",
    )
    outcome = cli(*arguments)
    told = " ".join(f"{outcome.out} {outcome.err}".split())
    command = "plcopen-sfc lower FILE DST --to codesys --pou Main"
    assert (command in told) is negated
    assert ("plcopen-sfc lower --pou NAME" in (tmp_path / "r.html").read_text()) is negated
    assert json.loads(cli(*arguments[:-2], "--json").out)["to_lower"] == ["Main"] * negated
    words = command.replace("FILE", str(tmp_path / "in.xml")).replace("DST", str(tmp_path / "code.xml")).split()[1:]
    lowered = cli(*words)
    assert lowered.code == 0
    assert "equal (proof" in lowered.out
