"""apply: what a script does to many files, what is written, and its exit codes."""

from __future__ import annotations

import io
import json
import shutil

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.batch import apply, project_files

SCRIPT = '''"""Rename steps to a prefix, and leave out a chart on request."""


def refactor(project, prefix: str, twice: bool = False, most: int = 100):
    for chart in project.charts():
        for step in [each for each in chart.chart.steps if each.initial][:most]:
            project.rename(f"{chart.name}.{step.name}", f"{prefix}_{step.name}")
            if twice:
                raise RuntimeError(f"no more than once: {step.name}")
'''
CODESYS = ["device_export.xml", "distribution_belt.xml", "sorting_conveyor.xml"]


@pytest.fixture
def exports(fixtures, tmp_path, monkeypatch):
    """A folder of exports that may be changed, beside a script, in the working folder."""
    shutil.copytree(fixtures / "codesys", tmp_path / "exports")
    (tmp_path / "exports" / "note.txt").write_text("no export", encoding="utf-8")
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path / "exports"


def test_a_dry_run_shows_the_lines_and_writes_nothing(cli, fixtures, exports):
    outcome = cli("apply", "script.py", "exports", "--set", "prefix=Z", "--diff", "out.patch")
    assert outcome.code == 0
    assert outcome.out.splitlines()[-1] == "3 changed, 0 unchanged, 0 failed; nothing is written without --write"
    for name in CODESYS:
        assert (exports / name).read_bytes() == (fixtures / "codesys" / name).read_bytes()
    patch = (exports.parent / "out.patch").read_text(encoding="utf-8")
    assert '+            <step localId="' in patch or "Z_Init" in patch
    assert patch.count("+++ exports/") == 3


@pytest.mark.parametrize("jobs", [1, 2])
def test_files_are_changed_and_a_failing_one_stops_no_other(cli, fixtures, exports, jobs):
    broken = exports / "distribution_belt.xml"
    broken.write_bytes(broken.read_bytes()[:5000])
    outcome = cli("apply", "script.py", "exports/*.xml", "--set", "prefix=Z", "--write", "--jobs", jobs, "--json")
    assert outcome.code == 1
    data = json.loads(outcome.out)
    assert [each["outcome"] for each in data["files"]] == ["changed", "failed", "changed"]
    assert "distribution_belt.xml" in data["files"][1]["error"]
    assert broken.read_bytes() == (fixtures / "codesys" / broken.name).read_bytes()[:5000]
    for name in (CODESYS[0], CODESYS[2]):
        charts = list(sfc.load(exports / name).charts())
        assert all(step.name.startswith("Z_") for each in charts for step in each.chart.steps if step.initial)


def test_mistakes_of_a_script_are_told_with_their_line(cli, exports):
    outcome = cli(
        "apply", "script.py", *(f"exports/{name}" for name in CODESYS), "--set", "prefix=Z", "--set", "twice=true"
    )
    assert outcome.code == 1
    assert "script.py:9: RuntimeError: no more than once: Z_Standby" in outcome.err
    assert outcome.out.splitlines()[-1].startswith("0 changed, 0 unchanged, 3 failed")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ([], "the script needs the setting 'prefix'"),
        (["prefix=Z", "prefx=1"], "no setting 'prefx' (did you mean 'prefix'?)"),
        (["prefix=Z", "most=some"], "the setting most is a whole number, not 'some'"),
        (["prefix"], "a setting is NAME=VALUE"),
    ],
)
def test_settings_are_those_of_the_script(cli, exports, settings, message):
    outcome = cli("apply", "script.py", "exports", *(text for each in settings for text in ("--set", each)))
    assert outcome.code == 2
    assert message in outcome.err


def test_standard_input_lists_files(cli, exports, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO("exports/device_export.xml\n\n"))
    outcome = cli("apply", "script.py", "-", "--set", "prefix=Z")
    assert outcome.out.splitlines()[0].startswith("changed: exports/device_export.xml, ")


def test_a_folder_of_a_tia_export_is_one_project(fixtures, exports):
    folder = str(fixtures / "simaticml-plc")
    assert project_files([folder, folder]) == [folder]
    (done,) = apply("script.py", [folder], settings={"prefix": "Z"})
    assert [change.path.rsplit("/", 1)[-1] for change in done.changes] == ["FB_Drilling.xml"]
    assert project_files([str(exports)]) == [str(exports / name) for name in CODESYS]
