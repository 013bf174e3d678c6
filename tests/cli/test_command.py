"""The command as a process: start, version, help, streams, interruptions."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import plcopen_sfc
from plcopen_sfc.cli import main

ROOT = Path(__file__).resolve().parents[2]
UMLAUTS = "broken/umlauts_utf8.xml"
POSIX = pytest.mark.skipif(os.name == "nt", reason="needs a POSIX system")


def test_module_and_script_are_the_same(command):
    assert command("--version").stdout.decode().split() == ["plcopen-sfc", plcopen_sfc.__version__]
    script = "import sys; from plcopen_sfc.cli import main; sys.exit(main(['--version']))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True, cwd=ROOT)
    assert done.stdout == command("--version").stdout


def test_the_project_file_names_the_entry_point():
    assert 'plcopen-sfc = "plcopen_sfc.cli:main"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")


def test_the_version_costs_no_import():
    script = (
        "import sys; from plcopen_sfc.cli import main; main(['--version']);"
        "heavy = ('typer', 'rich', 'lxml', 'pydantic', 'xmlschema', 'plcopen_sfc.model');"
        "print([name for name in heavy if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True, text=True, cwd=ROOT)
    assert done.stdout.splitlines()[1] == "[]"


@pytest.mark.slow
def test_loading_needs_neither_interpreter_nor_analysis():
    """Only what is converted, simulated or compared pays for them; every command loads."""
    script = (
        "import sys, plcopen_sfc; project = plcopen_sfc.load('fixtures/codesys/sorting_conveyor.xml');"
        "print(len(list(project.charts())));"
        "heavy = ('plcopen_sfc.semantics', 'plcopen_sfc.analysis', 'plcopen_sfc.conversion', 'z3', 'xmlschema');"
        "print([name for name in heavy if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True, text=True, cwd=ROOT)
    assert done.stdout.splitlines() == ["3", "[]"]


@pytest.mark.slow
@pytest.mark.parametrize("command", ["info", "validate"])
def test_commands_that_look_at_files_need_neither_interpreter_nor_analysis(command):
    script = (
        f"import sys; from plcopen_sfc.cli import main; main(['{command}', 'fixtures/codesys/sorting_conveyor.xml']);"
        "heavy = ('plcopen_sfc.semantics.programs', 'plcopen_sfc.analysis', 'plcopen_sfc.conversion', 'z3');"
        "print([name for name in heavy if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True, text=True, cwd=ROOT)
    assert done.stdout.splitlines()[-1] == "[]"


def test_help_needs_neither_model_nor_parser():
    script = (
        "import sys; from plcopen_sfc.cli import main; main(['convert', '--help']);"
        "print([m for m in ('rich', 'lxml', 'xmlschema', 'plcopen_sfc.model') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True, text=True, cwd=ROOT)
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("arguments", [["--help"], ["-h"], ["info", "--help"], ["convert", "--help"]])
def test_help_is_plain_text_in_a_pipe(cli, arguments):
    outcome = cli(*arguments)
    assert outcome.code == 0
    assert outcome.out.startswith("Usage: plcopen-sfc")
    assert outcome.out.isascii()
    assert "\x1b" not in outcome.out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["infoo"], "No such command 'infoo'"),
        (["info"], "Missing argument 'FILE"),
        (["info", "--colour", "x.xml"], "No such option"),
        (["convert", "x.xml"], "the format to write is not named"),
        (["validate"], "Missing argument"),
    ],
)
def test_wrong_usage_is_2(cli, arguments, message):
    outcome = cli(*arguments)
    assert outcome.code == 2
    assert message in outcome.err
    assert outcome.out == ""
    assert "Traceback" not in outcome.err


def test_no_arguments_shows_the_help(cli):
    outcome = cli()
    assert outcome.code == 2
    assert "convert" in outcome.out + outcome.err


def test_version_through_the_app(cli):
    assert cli("--version", "info").out == f"plcopen-sfc {plcopen_sfc.__version__}\n"


@pytest.mark.slow
def test_pipes_are_utf_8(command, fixtures):
    """Also where the locale is another, as on Windows; unless the user demands otherwise."""
    done = command("info", UMLAUTS, env={"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"})
    assert "Füllen" in done.stdout.decode("utf-8")


@pytest.mark.slow
def test_code_page_1252_is_no_reason_to_crash(command, fixtures):
    done = command("info", UMLAUTS, env={"PYTHONIOENCODING": "cp1252"})
    assert done.returncode == 0
    assert "Füllen" in done.stdout.decode("cp1252")


@pytest.mark.slow
def test_a_code_page_without_umlauts(command, fixtures):
    done = command("info", UMLAUTS, env={"PYTHONIOENCODING": "cp866"})
    assert done.returncode == 0
    assert b"F?llen" in done.stdout
    done = command("info", "--json", UMLAUTS, env={"PYTHONIOENCODING": "cp866"})
    assert json.loads(done.stdout)["files"][0]["charts"][0]["name"] == "Rührkessel"


@pytest.mark.slow
def test_a_name_that_is_no_unicode(command, tmp_path, fixtures):
    if os.name == "nt" or sys.platform == "darwin":
        pytest.skip("the file system has Unicode names only")
    name = tmp_path / os.fsdecode(b"F\xfcllen.xml")
    name.write_bytes((fixtures / UMLAUTS).read_bytes())
    done = command("info", name)
    assert done.returncode == 0
    assert "F?llen.xml" in done.stdout.decode()


@pytest.mark.slow
@POSIX
def test_a_closed_pipe_is_quiet(fixtures):
    with subprocess.Popen(
        [sys.executable, "-m", "plcopen_sfc", "schema"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 141


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_standard_output_on_a_full_disk(fixtures):
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "plcopen_sfc", "schema"],
            stdout=full,
            stderr=subprocess.PIPE,
            check=False,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )
    assert done.returncode == 2
    assert done.stderr.decode().startswith("error: No space left")
    assert len(done.stderr.splitlines()) == 1


def _terminal(arguments: list[str], **env: str) -> str:
    """Run the command on a pseudo-terminal, as a person sees it."""
    import pty  # noqa: PLC0415  # POSIX only

    main_end, other_end = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "plcopen_sfc", *arguments],
        stdin=other_end,
        stdout=other_end,
        stderr=other_end,
        env={**os.environ, "PYTHONPATH": str(ROOT), "TERM": "xterm-256color", "COLUMNS": "120", **env},
    )
    os.close(other_end)
    shown = b""
    while True:
        try:
            piece = os.read(main_end, 65536)
        except OSError:
            break
        if not piece:
            break
        shown += piece
    os.close(main_end)
    process.wait()
    return shown.decode()


@pytest.mark.slow
@POSIX
def test_colours_and_lines_on_a_terminal(fixtures, monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    shown = _terminal(["info", "codesys/sorting_conveyor.xml"])
    assert "├─" in shown
    assert "╠═" in shown
    assert "\x1b[1;32m[[Init]]" in shown


@pytest.mark.slow
@POSIX
def test_no_color_is_respected(fixtures):
    shown = _terminal(["info", "codesys/sorting_conveyor.xml"], NO_COLOR="1")
    assert "├─" in shown
    assert not re.search(r"\x1b\[[0-9;]*\b[349][0-7]\b", shown)


@pytest.mark.slow
@POSIX
def test_progress_on_a_terminal_leaves_the_results_whole(fixtures):
    files = ["codesys/sorting_conveyor.xml", "codesys/device_export.xml", "plcopen/filling_station_2.01.xml", UMLAUTS]
    shown = _terminal(["info", *files])
    for file in files:
        assert file in shown
    assert "Traceback" not in shown


class TestWhatGoesWrong:
    def _break(self, monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
        def fail(*_arguments: object, **_options: object) -> None:
            raise error

        monkeypatch.setattr("plcopen_sfc.cli.command_files.load", fail)

    def test_interrupted(self, cli, fixtures, monkeypatch):
        self._break(monkeypatch, KeyboardInterrupt())
        outcome = cli("info", UMLAUTS)
        assert (outcome.code, outcome.err) == (130, "error: interrupted\n")

    @pytest.mark.parametrize(("error", "words"), [(MemoryError(), "memory"), (RecursionError(), "nested too deeply")])
    def test_exhausted(self, cli, fixtures, monkeypatch, error, words):
        self._break(monkeypatch, error)
        outcome = cli("info", UMLAUTS)
        assert outcome.code == 2
        assert words in outcome.err
        assert UMLAUTS in outcome.err
        assert "Traceback" not in outcome.err

    def test_a_bug_of_ours(self, cli, fixtures, monkeypatch):
        self._break(monkeypatch, ZeroDivisionError("division by zero"))
        outcome = cli("info", UMLAUTS)
        assert outcome.code == 2
        assert "ZeroDivisionError: division by zero" in outcome.err
        assert "bug in plcopen_sfc" in outcome.err
        assert "Traceback" not in outcome.err
        assert "Traceback" in cli("info", "--verbose", UMLAUTS).err

    def test_tracebacks_for_those_who_want_them(self, cli, fixtures, monkeypatch):
        assert "Traceback" not in cli("convert", "broken/empty.xml", "--to", "json", "-v").err
        assert "Traceback" in cli("convert", "broken/empty.xml", "--to", "json", "-vv").err
        monkeypatch.setenv("PLCOPEN_SFC_DEBUG", "1")
        assert "Traceback" in cli("convert", "broken/empty.xml", "--to", "json").err


def test_main_takes_arguments(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"plcopen-sfc {plcopen_sfc.__version__}\n"
