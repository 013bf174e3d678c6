"""Commands on many files: which files are meant, the order, failing ones, targets, and runs that go on."""

from __future__ import annotations

import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.cli.screen import Screen
from tests.samples import FIXTURES

CODESYS = ["device_export.xml", "distribution_belt.xml", "sorting_conveyor.xml"]


@pytest.fixture
def exports(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of exports, one of them broken off, and a folder in it, in the working folder."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "exports"
    shutil.copytree(FIXTURES / "codesys", folder)
    (folder / "Anlage Süd").mkdir()
    shutil.copy(FIXTURES / "training-chain" / "codesys.xml", folder / "Anlage Süd" / "chain.xml")
    (folder / "cut.xml").write_bytes((folder / CODESYS[0]).read_bytes()[:4000])
    return folder


def test_lines_of_a_file_are_in_a_log_before_the_next_file_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    log = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(log, encoding="utf-8"))
    screen = Screen()

    def files() -> Iterator[str]:
        for name in ("one", "two"):
            logged.append(log.getvalue().decode().split())
            yield name

    logged: list[list[str]] = []
    for name in screen.progress(files(), "Editing", 2):
        screen.line(name)
    assert logged == [[], ["one"]]


IN_ORDER = ["exports/Anlage Süd/chain.xml", "exports/cut.xml", *(f"exports/{name}" for name in CODESYS)]


@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize("command", [["info"], ["validate"], ["check", "--select", "STR"]])
def test_a_folder_is_its_files_in_order_and_a_broken_one_stops_no_other(
    cli: Any, exports: Path, command: list[str], jobs: int
) -> None:
    outcome = cli(*command, "exports", "--jobs", jobs)
    assert outcome.code == 2
    places = [outcome.out.index(name) for name in IN_ORDER if name != "exports/cut.xml"]
    assert places == sorted(places)
    assert "cut.xml:" in outcome.err
    assert outcome.out.splitlines()[-1].endswith("1 failed")
    files = json.loads(cli(*command, "exports", "--jobs", jobs, "--json").out)["files"]
    assert [each["file"] for each in files] == IN_ORDER
    assert ["error" in each for each in files] == [False, True, False, False, False]


def test_lists_name_files(cli: Any, exports: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (exports.parent / "list.txt").write_text(f"exports/{CODESYS[2]}\n\nexports/{CODESYS[0]}\n", encoding="utf-8")
    listed = [each["file"] for each in json.loads(cli("info", "@list.txt", "--json").out)["files"]]
    assert listed == [f"exports/{CODESYS[2]}", f"exports/{CODESYS[0]}"]
    monkeypatch.setattr("sys.stdin", io.StringIO("exports/Anlage Süd\n"))
    (file,) = json.loads(cli("info", "@-", "--json").out)["files"]
    assert file["file"] == IN_ORDER[0]


@pytest.mark.parametrize("jobs", [1, 2])
def test_many_are_converted_into_a_folder_under_their_names(cli: Any, exports: Path, jobs: int) -> None:
    outcome = cli("convert", "exports", "out/", "--to", "json", "--limit", "0", "--jobs", jobs, "--json")
    assert outcome.code == 2
    files = json.loads(outcome.out)["files"]
    assert [each["file"] for each in files] == IN_ORDER
    written = sorted(str(path.relative_to("out")) for path in Path("out").rglob("*.json"))
    assert written == ["Anlage Süd/chain.json", *(name.replace(".xml", ".json") for name in CODESYS)]
    assert sfc.load("out/Anlage Süd/chain.json").pou("Ablauf")


def test_many_are_converted_beside_their_sources_and_never_over_one(cli: Any, exports: Path) -> None:
    (exports / "cut.xml").unlink()
    before = {path: path.read_bytes() for path in exports.rglob("*.xml")}
    assert cli("convert", "exports/*.xml", "--to", "json", "--limit", "0").out.splitlines()[-1] == "3 fine"
    assert (exports / "device_export.json").is_file()
    refused = cli("convert", "exports", "--to", "json", "--limit", "0")
    assert refused.code == 2
    assert "device_export.xml would be written over exports/device_export.json" in refused.err
    assert "would be written over" in cli("convert", "exports/*.xml", "exports", "--to", "codesys").err
    shutil.copy(exports / CODESYS[0], "device_export.xml")
    both = cli("convert", "device_export.xml", f"exports/{CODESYS[0]}", "out/", "--to", "json")
    assert (both.code, Path("out").exists()) == (2, False)
    assert "would both be written to" in both.err
    two = cli("convert", *(f"exports/{name}" for name in CODESYS[:2]), "--to", "plcopen")  # *.xml, where there are two
    assert (two.code, "is a file of codesys too" in two.err) == (2, True)
    assert {path: path.read_bytes() for path in exports.rglob("*.xml")} == before


@pytest.mark.slow
def test_a_conversion_of_many_goes_on_where_it_was(cli: Any, exports: Path) -> None:
    arguments = ["convert", "exports", "out/", "--to", "json", "--limit", "0", "--resume", "run.journal"]
    cli(*arguments)
    journal = Path("run.journal").read_text(encoding="utf-8").splitlines(keepends=True)
    Path("run.journal").write_text("".join(journal[:4]), encoding="utf-8")  # the head, two files and the broken one
    outcome = cli(*arguments)
    assert outcome.out.splitlines()[-1] == "2 fine, 1 failed, 2 done before"
    made = sorted(Path("out").rglob("*.json"))
    assert len(made) == 4
    made[0].unlink()  # what is not there is not done
    assert cli(*arguments).out.splitlines()[-1] == "1 fine, 1 failed, 3 done before"
    assert sorted(Path("out").rglob("*.json")) == made
    good, broken = (next(Path("exports").rglob(name)) for name in (Path(CODESYS[0]).name, "cut.xml"))
    broken.write_bytes(good.read_bytes())  # nor is what was changed since, or failed
    assert cli(*arguments).out.splitlines()[-1] == "1 fine, 4 done before"
    later = time.time() + 5
    os.utime(good, (later, later))
    assert cli(*arguments).out.splitlines()[-1] == "1 fine, 4 done before"
    assert "journal of another" in cli(*arguments, "--strict").err


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_rename_in_many_changes_those_that_have_the_name(cli: Any, exports: Path, jobs: int) -> None:
    before = {path: path.read_bytes() for path in exports.rglob("*.xml")}
    dry = cli("rename", "exports", "Ablauf.S2", "Fill", "--dry-run", "--diff", "out.patch", "--jobs", jobs)
    assert dry.code == 2
    assert dry.out.splitlines()[-1] == "1 changed, 0 unchanged, 4 failed; nothing is written with --dry-run"
    assert Path("out.patch").read_text(encoding="utf-8").count("+++ ") == 1
    assert {path: path.read_bytes() for path in exports.rglob("*.xml")} == before
    done = cli("rename", "exports", "Ablauf.S2", "Fill", "--jobs", jobs, "--json")
    (changed,) = (each for each in json.loads(done.out)["files"] if each["outcome"] == "changed")
    assert (changed["file"], changed["path"], changed["new"]) == (IN_ORDER[0], "Ablauf.S2", "Fill")
    now = {path: path.read_bytes() for path in exports.rglob("*.xml")}
    assert [path.name for path in before if before[path] != now[path]] == ["chain.xml"]


def test_many_are_numbered_drawn_and_put_on_pages(cli: Any, exports: Path) -> None:
    chain = "exports/Anlage Süd"
    assert cli("renumber", chain, "--names", "N{number}").out.splitlines()[-1] == "1 changed, 0 unchanged, 0 failed"
    assert [step.name for step in next(sfc.load(IN_ORDER[0]).charts()).chart.steps] == ["N1", "N2", "N3", "N4"]
    assert cli("draw", chain, "pictures/").code == 0
    assert list(Path("pictures").rglob("*.svg"))
    assert cli("page", chain, "pages/").code == 0
    assert Path("pages/chain.html").is_file()


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_a_link_and_its_file_are_one(cli: Any, exports: Path) -> None:
    (exports / "Anlage Süd" / "link.xml").symlink_to("chain.xml")
    outcome = cli("renumber", "exports/Anlage Süd/*.xml", "--names", "{name}_{number}")
    assert outcome.out.splitlines()[-1] == "1 changed, 0 unchanged, 0 failed"
    assert next(sfc.load(IN_ORDER[0]).charts()).chart.steps[0].name == "S1_1"
    assert (exports / "Anlage Süd" / "link.xml").is_symlink()


def test_standard_input_is_one_file(cli: Any, exports: Path) -> None:
    outcome = cli("rename", "-", f"exports/{CODESYS[0]}", "A", "B")
    assert outcome.code == 2
    assert "A list of files is @-." in outcome.err


_MANY = 80


def _converting(exports: Path) -> subprocess.Popen[str]:
    """Return the command that converts many files, with two processes that have written some of them.

    It cannot write all: its lines do not fit into the pipe, which nothing reads meanwhile, and the buffers before it.
    """
    for number in range(_MANY):
        shutil.copy(exports / CODESYS[2], exports / f"more{number}{'_' * 200}.xml")
    arguments = ["convert", "exports", "out/", "--to", "json", "--jobs", "2", "--resume", "run.journal"]
    command = [sys.executable, "-m", "plcopen_sfc", *arguments]
    run = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, pipesize=4096, text=True,
                           process_group=0, env={"PYTHONPATH": str(FIXTURES.parent)})  # fmt: skip
    for _ in range(600):
        if len(list(Path("out").glob("*.json"))) > 1:
            break
        time.sleep(0.1)
    return run


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_a_kill_ends_all_processes(exports: Path) -> None:
    run = _converting(exports)
    run.kill()
    run.communicate(timeout=60)  # ends when the last process has that could write there
    assert run.returncode == -signal.SIGKILL
    assert 1 < len(list(Path("out").glob("*.json"))) < _MANY


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_an_interruption_ends_all_processes_without_tracebacks(exports: Path) -> None:
    run = _converting(exports)
    subprocess.run(["kill", f"-{signal.SIGINT.value}", "--", f"-{run.pid}"], check=True)  # as Ctrl-C does in a terminal
    _, messages = run.communicate(timeout=60)
    assert run.returncode == 130
    assert "error: interrupted" in messages
    assert "Traceback" not in messages
    assert not [path for path in Path("out").rglob("*.*") if path.suffix != ".json"]
    for path in Path("out").glob("*.json"):
        assert sfc.load(path).pous
