"""Options mean the same in every command: -, --report, --json, --quiet, --limit; help and completion."""

from __future__ import annotations

import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import plcopen_sfc as sfc

ROOT = Path(__file__).resolve().parents[2]
CHAIN = ROOT / "fixtures" / "training-chain" / "plcopen_2.01.xml"
SCRIPT = ROOT / "examples" / "plant_standard.py"
COMMANDS = (
    "formats info validate check rules convert diff rename renumber merge apply simulate lower draw page "
    "normalize git-setup schema"
).split()


@pytest.fixture
def stdin(monkeypatch):
    def give(path: Path) -> None:
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(path.read_bytes())))

    return give


class TestStandardStreams:
    @pytest.mark.parametrize(
        "command", [["info"], ["validate"], ["check", "--select", "STR"], ["simulate", "--seed", "3"]]
    )
    def test_minus_is_standard_input(self, cli, stdin, command):
        stdin(CHAIN)
        piped = cli(*command, "-")
        named = cli(*command, CHAIN)
        assert piped.code == named.code
        assert piped.out == named.out.replace(str(CHAIN), "-")

    def test_an_error_names_standard_input(self, cli, stdin):
        stdin(ROOT / "fixtures" / "broken" / "truncated.xml")
        outcome = cli("info", "-")
        assert outcome.code == 2
        assert outcome.err.startswith("error: standard input:168:8: the file ends in the middle of element")

    @pytest.mark.slow
    @pytest.mark.parametrize(
        "arguments",
        [
            ["convert", "-", "--to", "codesys", "--limit", "0"],
            ["convert", "-", "-", "--to", "codesys", "--limit", "0"],
            ["rename", "-", "Ablauf.S1", "Grundstellung"],
            ["lower", "-", "--to", "plcopen", "--as", "case"],
            ["lower", "-", "-", "--to", "plcopen", "--as", "case"],
        ],
    )
    def test_what_is_read_from_standard_input_goes_to_standard_output(self, command, arguments):
        done = command(*arguments, input=CHAIN.read_bytes())
        assert done.returncode == 0, done.stderr
        project = sfc.loads(done.stdout)  # nothing but the file
        chart = project.pous[0].chart
        if arguments[0] == "lower":
            assert chart is None
            assert b"equal (proof" in done.stderr
        else:
            assert (chart.steps[0].name == "Grundstellung") is (arguments[0] == "rename")

    @pytest.mark.slow
    def test_a_file_can_go_to_standard_output_too(self, command):
        done = command("lower", CHAIN, "-", "--to", "scl", "--as", "case", "--quiet")
        assert (done.returncode, done.stderr) == (0, b"")
        assert b"CASE" in done.stdout

    def test_a_script_changes_standard_input(self, cli, stdin, tmp_path):
        script = tmp_path / "wait.py"
        script.write_text("def refactor(project, name='A'):\n    project.rename('Ablauf.S1', name)\n")
        stdin(CHAIN)
        shown = cli("apply", script, "-", "--set", "name=Wait")
        assert shown.code == 0
        assert {line[0] for line in shown.out.splitlines() if '"Wait"' in line} == {"+"}
        script.write_text("def refactor(project):\n    project.nothing\n")
        stdin(CHAIN)
        failed = cli("apply", script, "-")
        assert (failed.code, failed.out) == (2, "")
        assert f"{script}:2" in failed.err

    @pytest.mark.slow
    def test_normalize_is_a_filter_of_git(self, command):
        source = (ROOT / "fixtures" / "simaticml" / "FB_Drill.xml").read_bytes()
        done = command("normalize", "-", input=source)
        assert (done.returncode, done.stderr) == (0, b"")
        assert done.stdout == sfc.dumps(sfc.loads(source), normalize=True)
        assert command("normalize", "-", "--dry-run", input=source).returncode == 1
        assert command("normalize", "-", input=CHAIN.read_bytes()).stdout == CHAIN.read_bytes()

    def test_the_file_and_json_are_not_mixed(self, cli, stdin):
        for arguments in (["convert", "-", "--to", "json"], ["rename", "-", "Ablauf", "B"]):
            stdin(CHAIN)
            outcome = cli(*arguments, "--json")
            assert (outcome.code, outcome.out) == (2, "")
            assert "--report FILE.json" in outcome.err

    @pytest.mark.slow
    def test_a_refused_conversion_writes_nothing_to_standard_output(self, command):
        source = ROOT / "fixtures" / "codesys" / "sorting_conveyor.xml"
        done = command("convert", source, "-", "--to", "iec-text", "--limit", "0")
        assert (done.returncode, done.stdout) == (1, b"")


REPORTING = [
    ["formats"],
    ["rules", "SEL01"],
    ["info", "CHAIN"],
    ["validate", "CHAIN"],
    ["check", "CHAIN"],
    ["convert", "CHAIN", "OUT.json", "--to", "json"],
    ["diff", "CHAIN", "CHAIN"],
    ["rename", "CHAIN", "Ablauf.S1", "Grundstellung", "--dry-run"],
    ["renumber", "CHAIN", "--names", "S{number}", "--start", "10", "--dry-run"],
    ["simulate", "CHAIN", "--scans", "3"],
    ["lower", "CHAIN", "OUT.scl", "--to", "scl", "--as", "case"],
    ["draw", "CHAIN", "OUT.svg"],
    ["page", "CHAIN", "OUT.html"],
    ["normalize", "CHAIN"],
    ["apply", "SCRIPT", "CHAIN"],
]


def filled(arguments: list[str], folder: Path) -> list[str]:
    words = {"CHAIN": str(CHAIN), "OUT": str(folder / "out"), "SCRIPT": str(SCRIPT)}
    return [next((word.replace(key, to) for key, to in words.items() if key in word), word) for word in arguments]


@pytest.mark.parametrize("arguments", REPORTING, ids=lambda arguments: arguments[0])
def test_a_report_is_what_json_prints(cli, tmp_path, arguments):
    arguments = filled(arguments, tmp_path)
    printed = cli(*arguments, "--json")
    written = cli(*arguments, "--report", tmp_path / "report.json")
    assert printed.code == written.code == 0
    assert json.loads((tmp_path / "report.json").read_text(encoding="utf-8")) == json.loads(printed.out)
    assert not written.out.startswith("{")


@pytest.mark.parametrize("arguments", REPORTING, ids=lambda arguments: arguments[0])
def test_a_report_that_cannot_be_written_fails_before_anything_is(cli, tmp_path, arguments):
    for report, message in (
        (tmp_path / "none" / "report.json", "the folder to write into does not exist"),
        (tmp_path, "is a folder"),
    ):
        outcome = cli(*filled(arguments, tmp_path), "--report", report)
        assert (outcome.code, outcome.out) == (2, "")
        assert message in outcome.err
        assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "arguments", [["convert", "CHAIN", "OUT.json", "--to", "json"], ["lower", "CHAIN", "OUT.scl", "--to", "scl"]]
)
def test_quiet_commands_that_write_files_print_nothing(cli, tmp_path, arguments):
    outcome = cli(*filled(arguments, tmp_path), "--quiet")
    assert (outcome.code, outcome.out, outcome.err) == (0, "", "")
    assert len(list(tmp_path.iterdir())) == 1


def test_wave_files_that_cannot_be_written_fail_before_the_run(cli, tmp_path):
    outcome = cli("simulate", CHAIN, "--csv", tmp_path / "none" / "x.csv")
    assert (outcome.code, outcome.out) == (2, "")


@pytest.mark.parametrize("limit", ["0", "20", "20s"])
def test_limits_are_numbers_of_seconds_or_times(cli, tmp_path, limit):
    assert cli("convert", CHAIN, tmp_path / "out.xml", "--to", "codesys", "--limit", limit).code == 0


def test_a_limit_that_is_none_is_an_error(cli, tmp_path):
    outcome = cli("convert", CHAIN, tmp_path / "out.xml", "--to", "codesys", "--limit", "soon")
    assert outcome.code == 2
    assert "'soon' is no time limit" in outcome.err


@pytest.mark.parametrize(
    ("name", "message"), [("tia", "TIA Portal uses simaticml"), ("plcopn", "did you mean 'plcopen'")]
)
def test_unknown_formats_are_told_the_right_one(cli, name, message):
    outcome = cli("convert", CHAIN, "--to", name)
    assert outcome.code == 2
    assert message in outcome.err


class TestHelp:
    def test_the_list_of_commands_has_whole_sentences_in_80_columns(self, cli, monkeypatch):
        monkeypatch.setenv("COLUMNS", "80")
        listed = cli("--help").out.partition("Commands:\n")[2].splitlines()
        assert [line.split()[0] for line in listed] == COMMANDS
        assert all(line.endswith(".") and not line.endswith("..") and len(line) <= 80 for line in listed)

    @pytest.mark.parametrize("name", COMMANDS)
    def test_the_help_of_every_option_is_a_sentence(self, cli, monkeypatch, name):
        monkeypatch.setenv("COLUMNS", "80")
        lines = re.sub(r"\n {10,}", " ", cli(name, "--help").out.partition("Options:\n")[2]).splitlines()
        assert lines
        for line in lines:
            text = re.sub(r"\s+\[(default: .*|required|x>=.*)\]$", "", line)
            _, _, sentence = re.sub(r"^  (\S.*?)(?:  +| (?=[A-Z][a-z]+ ))", r"\1||", text).partition("||")
            assert sentence[:1].isupper(), line
            assert sentence.endswith("."), line

    @pytest.mark.parametrize("name", COMMANDS)
    def test_nothing_is_wider_than_the_terminal(self, cli, monkeypatch, name):
        monkeypatch.setenv("COLUMNS", "80")
        assert max(map(len, cli(name, "--help").out.splitlines())) <= 80


class TestCompletion:
    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("line", "expected"),
        [
            ("plcopen-sfc val", {"validate"}),
            ("plcopen-sfc convert x.xml --to si", {"simaticml"}),
            ("plcopen-sfc convert x.xml --for be", {"beremiz"}),
            ("plcopen-sfc check x.xml --profile code", {"codesys", "codesys23"}),
        ],
    )
    def test_words_are_completed(self, line, expected):
        environment = os.environ | {
            "_PLCOPEN_SFC_COMPLETE": "complete_bash",
            "COMP_WORDS": line,
            "COMP_CWORD": str(len(line.split()) - 1),
            "PYTHONPATH": str(ROOT),
        }
        done = subprocess.run(
            [sys.executable, "-m", "plcopen_sfc"], env=environment, capture_output=True, text=True, check=False
        )
        assert set(done.stdout.split()) == expected

    def test_the_options_to_install_it_are_there(self, cli):
        assert {"--install-completion", "--show-completion"} <= set(cli("--help").out.split())
