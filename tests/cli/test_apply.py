"""apply: what a script does to many files, what is written, and its exit codes."""

from __future__ import annotations

import io
import json
import re
import shutil
from functools import partial
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.batch import FileChange, apply, patch_of, project_files

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


@pytest.mark.slow
def test_a_dry_run_shows_the_lines_and_writes_nothing(cli, fixtures, exports):
    outcome = cli("apply", "script.py", "exports", "--set", "prefix=Z", "--diff", "out.patch")
    assert outcome.code == 0
    assert outcome.out.splitlines()[-1] == "3 changed, 0 unchanged, 0 failed; nothing is written without --write"
    for name in CODESYS:
        assert (exports / name).read_bytes() == (fixtures / "codesys" / name).read_bytes()
    patch = (exports.parent / "out.patch").read_text(encoding="utf-8")
    assert '+            <step localId="' in patch or "Z_Init" in patch
    assert patch.count("+++ exports/") == 3


def test_removed_lines_are_counted(cli, exports):
    """A file that lost all its POUs was told as one changed line."""
    script = "def refactor(project):\n    project.pou('Ablauf_Band').actions.clear()\n"
    (exports.parent / "script.py").write_text(script, encoding="utf-8")
    outcome = cli("apply", "script.py", "exports/distribution_belt.xml", "--diff", "out.patch")
    signs = [line[0] for line in (exports.parent / "out.patch").read_text(encoding="utf-8").splitlines()[2:]]
    removed = signs.count("-") - signs.count("+")
    assert removed > 20
    assert f"{signs.count('+')} lines, {removed} lines removed" in outcome.out.splitlines()[0]


def test_a_patch_has_the_bytes_of_the_files() -> None:
    before = "a\r\nü\r\nlast".encode("cp1252")
    change = FileChange("list.st", before, before.replace(b"\xfc", b"\xe4").replace(b"last", b"l"))
    assert patch_of(change).splitlines(keepends=True) == [
        b"--- list.st\n",
        b"+++ list.st\n",
        b"@@ -2,2 +2,2 @@\n",
        b"-\xfc\r\n",
        b"-last\n",
        b"\\ No newline at end of file\n",
        b"+\xe4\r\n",
        b"+l\n",
        b"\\ No newline at end of file\n",
    ]


def test_a_wrong_limit_is_a_mistake_of_the_call(cli, exports):
    outcome = cli("apply", "script.py", "exports", "--set", "prefix=Z", "--prove", "--limit", "soon")
    assert (outcome.code, "'soon' is no time limit" in outcome.err) == (2, True)


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2])
def test_files_are_changed_and_a_failing_one_stops_no_other(cli, fixtures, exports, jobs):
    broken = exports / "distribution_belt.xml"
    broken.write_bytes(broken.read_bytes()[:5000])
    outcome = cli("apply", "script.py", "exports/*.xml", "--set", "prefix=Z", "--write", "--jobs", jobs, "--json")
    assert outcome.code == 2
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
    assert outcome.code == 2
    assert "script.py:9: RuntimeError: no more than once: Z_Standby" in outcome.err
    assert outcome.out.splitlines()[-1].startswith("0 changed, 0 unchanged, 3 failed")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("async def refactor(project): pass", "refactor is an async function, which nothing runs"),
        (
            "class All:\n    async def refactor(self, project): pass",
            "refactor is an async function, which nothing runs",
        ),
        ("def refactor(): pass", "refactor takes no project"),
        ("def refactor(*, project): pass", "refactor takes no project"),
    ],
)
def test_a_function_that_would_do_nothing_is_refused_before_any_file(cli, exports, text, told):
    (exports.parent / "script.py").write_text(text + "\n", encoding="utf-8")
    outcome = cli("apply", "script.py", "exports")
    assert (outcome.code, outcome.out) == (2, "")
    assert f"script.py: {told}" in outcome.err


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_script_that_exits_fails_for_its_file_alone(cli, exports, jobs):
    text = "import sys\ndef refactor(project):\n    'distribution' in project.source.path and sys.exit(3)\n"
    (exports.parent / "script.py").write_text(text, encoding="utf-8")
    outcome = cli("apply", "script.py", "exports", "--jobs", jobs)
    assert outcome.code == 2
    assert "script.py:3: SystemExit: 3" in outcome.err
    assert outcome.out.splitlines()[-1].startswith("0 changed, 2 unchanged, 1 failed")
    (exports.parent / "script.py").write_text("import sys\nsys.exit()\n", encoding="utf-8")
    assert "script.py: SystemExit" in cli("apply", "script.py", "exports", "--jobs", jobs).err


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


SETTINGS = """
from pathlib import Path
from typing import Literal, Optional

def refactor(project, names: list[str] = None, o: Optional[int] = None, u: float | str | None = None, d: dict = None,
        level: Literal["a", 2] = "a", path: Path = None, raw=5, free=None, pair: tuple[int, str] = None,
        several: tuple[int, ...] = (), of: list[Literal["x", "y"]] = ["x"], on=False,
        where=Path()):
    return repr(locals())
"""


@pytest.mark.parametrize(
    ("given", "value"),
    [
        ("names=a, b", "['a', 'b']"),
        ("names=", "[]"),
        ("o=3", "3"),
        ("u=3", "3.0"),
        ("u=T#3s", "'T#3s'"),
        ("level=2", "2"),
        ("raw=7", "7"),
        ("free=7", "'7'"),
        ("several=1,2", "(1, 2)"),
        ("of=y,x", "['y', 'x']"),
        ("on=TRUE", "True"),
        ("path=x", repr(Path("x"))),
        ("where=x", repr(Path("x"))),
    ],
)
def test_a_setting_has_the_type_of_its_parameter(exports, given, value):
    (exports.parent / "script.py").write_text(SETTINGS, encoding="utf-8")
    name, _, text = given.partition("=")
    (exports / "empty.st").write_text("PROGRAM P\nEND_PROGRAM\n", encoding="utf-8")
    (done,) = apply("script.py", ["exports/empty.st"], settings={name: text})
    assert f"'{name}': {value}" in done.returned


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("o=x", "the setting o is a whole number, not 'x'"),
        ("level=c", "the setting level is a or 2, not 'c'"),
        ("of=y,z", "the setting of is x or y, not 'y,z'"),
        ("raw=x", "the setting raw is a whole number, not 'x'"),
        ("d={}", "the setting d cannot be given: its type is dict"),
        ("pair=1,a", "the setting pair cannot be given: its type is tuple[int, str]"),
    ],
)
def test_a_setting_of_another_type_is_refused(exports, given, message):
    (exports.parent / "script.py").write_text(SETTINGS, encoding="utf-8")
    name, _, text = given.partition("=")
    with pytest.raises(sfc.SfcError, match=re.escape(message)):
        list(apply("script.py", [], settings={name: text}))


def test_standard_input_lists_files(cli, exports, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO("exports/device_export.xml\n\n"))
    outcome = cli("apply", "script.py", "@-", "--set", "prefix=Z")
    assert outcome.out.splitlines()[0].startswith("changed: exports/device_export.xml, ")


def test_exports_of_another_tool_in_a_folder_of_tia_are_projects_of_their_own(fixtures, exports):
    shutil.copy(fixtures / "simaticml-plc" / "Program blocks" / "FB_Drilling.xml", exports / "blocks.xml")
    assert project_files(["exports"]) == ["exports", *(f"exports/{name}" for name in CODESYS)]
    found = list(apply("script.py", project_files(["exports"]), settings={"prefix": "Z"}))
    assert all(each.changes and not each.error for each in found)


@pytest.mark.parametrize(
    ("files", "projects"),
    [
        (["twincat-belt > tw", "grafcet/belt.gct"], [".", "belt.gct"]),
        (["simaticml/FB_Drill.xml", "grafcet/belt.gct"], [".", "belt.gct"]),
        (["twincat-belt > tw", "simaticml-plc > plc"], [".", "tw"]),
        (["twincat-belt > Program blocks/tw", "simaticml-plc > ."], [".", "Program blocks/tw"]),
        (["twincat-belt > tw", "simaticml/FB_Drill.xml"], [".", "FB_Drill.xml"]),
        (["twincat-belt > tw", "codesys > ."], [".", *CODESYS]),
    ],
)
def test_no_file_beside_a_project_of_a_folder_is_left_out(fixtures, tmp_path, files, projects):
    for source, _, folder in (each.partition(" > ") for each in files):
        copied = tmp_path / "plant" / (folder or source.rpartition("/")[2])
        copied.parent.mkdir(exist_ok=True, parents=True)
        copy = shutil.copy if source.rpartition("/")[1] else partial(shutil.copytree, dirs_exist_ok=True)
        copy(fixtures / source, copied)
    if "codesys > ." in files:  # more of them than of the project
        for number in range(5):
            shutil.copy(fixtures / "codesys" / CODESYS[0], tmp_path / "plant" / f"z{number}.xml")
        projects = [*projects, *(f"z{number}.xml" for number in range(5))]
    found = project_files([str(tmp_path / "plant")])
    assert [Path(each).relative_to(tmp_path / "plant").as_posix() for each in found] == projects
    assert all(sfc.load(each).pous for each in found)


def test_a_folder_of_a_tia_export_is_one_project(fixtures, exports):
    folder = str(fixtures / "simaticml-plc")
    assert project_files([folder, folder]) == [folder]
    (done,) = apply("script.py", [folder], settings={"prefix": "Z"})
    assert [change.path.rsplit("/", 1)[-1] for change in done.changes] == ["FB_Drilling.xml"]
    assert project_files([str(exports)]) == [str(exports / name) for name in CODESYS]


CLASS = """import plcopen_sfc as sfc


class Prefix:
    prefix: str
    most: int = 100

    def refactor(self, project: sfc.Project) -> None:
        for chart in project.charts():
            for step in chart.chart.initial_steps[: self.most]:
                project.rename(f"{chart.name}.{step.name}", self.prefix + step.name)
"""


@pytest.mark.slow
def test_a_class_with_typed_attributes_is_a_script(cli, exports):
    (exports.parent / "named.py").write_text(CLASS, encoding="utf-8")
    outcome = cli("apply", "named.py", "exports", "--set", "prefix=Z_", "--set", "most=1")
    assert outcome.out.splitlines()[-1].startswith("3 changed, 0 unchanged, 0 failed")
    assert "needs the setting 'prefix'" in cli("apply", "named.py", "exports").err
    assert "most is a whole number" in cli("apply", "named.py", "exports", "--set", "prefix=Z", "--set", "most=x").err


def test_a_change_that_is_not_proven_is_not_written(cli, fixtures, tmp_path, monkeypatch):
    shutil.copy(fixtures / "training-chain" / "codesys.xml", tmp_path / "chain.xml")
    monkeypatch.chdir(tmp_path)
    script = """
def refactor(project, text: str):
    first = project.pous[0].chart.transitions[0]
    first.condition = text + " AND " + first.condition.text
"""
    (tmp_path / "more.py").write_text(script, encoding="utf-8")
    before = (tmp_path / "chain.xml").read_bytes()
    outcome = cli("apply", "more.py", "chain.xml", "--set", "text=FALSE", "--write", "--prove")
    assert outcome.code == 1
    assert "not proven to do the same: POU Ablauf: different" in outcome.err
    assert (tmp_path / "chain.xml").read_bytes() == before
    outcome = cli("apply", "more.py", "chain.xml", "--set", "text=TRUE", "--write", "--prove")
    assert outcome.out.splitlines()[-1].startswith("1 changed")
    assert b"TRUE AND" in (tmp_path / "chain.xml").read_bytes()


def test_verdicts_of_what_changed_are_in_the_report(cli, fixtures, tmp_path, monkeypatch):
    shutil.copy(fixtures / "training-chain" / "codesys.xml", tmp_path / "chain.xml")
    monkeypatch.chdir(tmp_path)
    script = """
def refactor(project):
    chart = project.pous[0].chart
    chart.add_step("Never")
    chart.add_transition(chart.steps[1].name, "Never", "FALSE", priority=9)
"""
    (tmp_path / "never.py").write_text(script, encoding="utf-8")
    outcome = cli("apply", "never.py", "chain.xml", "--prove", "--report", "report.json")
    assert "POU Ablauf: equal (proof" in outcome.out
    (file,) = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["files"]
    assert [each["verdict"]["proven"] for each in file["proofs"]] == [True]


def initial_steps(path):
    return {step.name for each in sfc.load(path).charts() for step in each.chart.steps if step.initial}


@pytest.mark.slow
def test_an_interrupted_run_goes_on_where_it_was(exports):
    paths = [f"exports/{name}" for name in CODESYS]
    run = {"settings": {"prefix": "Z"}, "write": True, "journal": "run.journal"}
    first = apply("script.py", paths, **run)
    assert next(first).changes
    first.close()  # as an interruption does
    journal = exports.parent / "run.journal"
    journal.write_bytes(journal.read_bytes() + b'{"path": "exports/dist')  # cut off in a line
    done = list(apply("script.py", paths, **run))
    assert [(each.path, each.resumed, bool(each.changes)) for each in done] == [
        (paths[0], True, False),
        (paths[1], False, True),
        (paths[2], False, True),
    ]
    assert all(each.resumed for each in apply("script.py", paths, **run))
    assert all(name.startswith("Z_") and not name.startswith("Z_Z_") for path in paths for name in initial_steps(path))
    with pytest.raises(sfc.ScriptError, match="other settings"):
        list(apply("script.py", paths, **run | {"settings": {"prefix": "Y"}}))


@pytest.mark.parametrize("written", [True, False])
def test_an_interruption_around_the_writing_of_a_file_is_seen(exports, written):
    path = f"exports/{CODESYS[0]}"
    before = (exports / CODESYS[0]).read_bytes()
    run = {"settings": {"prefix": "Z"}, "write": True, "journal": "run.journal"}
    (done,) = apply("script.py", [path], **run)
    journal = exports.parent / "run.journal"
    journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:2]))  # begun, and not ended
    if not written:
        (exports / CODESYS[0]).write_bytes(before)
    (again,) = apply("script.py", [path], **run)
    assert (again.resumed, again.error, again.changes) == (written, "", () if written else done.changes)
    assert (exports / CODESYS[0]).read_bytes() == done.changes[0].after


def test_a_file_that_another_program_changed_meanwhile_is_not_overwritten(exports):
    script = """
from pathlib import Path

def refactor(project):
    project.pous[0].name += "_1"
    Path(project.source.path).write_bytes(b"of another program")
"""
    (exports.parent / "script.py").write_text(script, encoding="utf-8")
    (done,) = apply("script.py", [f"exports/{CODESYS[0]}"], write=True)
    assert "was changed while the script ran" in done.error
    assert (exports / CODESYS[0]).read_bytes() == b"of another program"


KILLS = """
import os, signal
from pathlib import Path

def refactor(project, prefix: str, always: bool = False):
    mark = Path("killed")
    if "distribution" in project.source.path and (always or not mark.exists()):
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    chart = project.pous[0].chart or next(iter(project.charts())).chart
    chart.rename_step(chart.steps[0].name, prefix + chart.steps[0].name)
"""


@pytest.mark.slow
@pytest.mark.parametrize("always", [False, True])
def test_a_process_that_ends_in_the_middle_loses_nothing(exports, always):
    (exports.parent / "script.py").write_text(KILLS, encoding="utf-8")
    paths = [f"exports/{name}" for name in CODESYS]
    settings = {"prefix": "Z_", "always": str(always)}
    done = list(apply("script.py", paths, settings=settings, write=True, jobs=2))
    assert [each.path for each in done] == paths
    assert [bool(each.error) for each in done] == [False, always, False]
    assert not always or "has ended, twice" in done[1].error
    steps = ["".join(step.name for each in sfc.load(path).charts() for step in each.chart.steps) for path in paths]
    assert [names.count("Z_") for names in steps] == [1, 0 if always else 1, 1]


NOISY = """print("when it is read")


def refactor(project):
    print("when it runs")
    project.rename("Ablauf.S2", "Weigh")

"""


def test_what_a_script_prints_is_no_result(cli, command, fixtures, tmp_path):
    """It was written into the file on standard output, and before the JSON."""
    (tmp_path / "noisy.py").write_text(NOISY, encoding="utf-8")
    one, other = (
        shutil.copy(fixtures / "training-chain" / "codesys.xml", tmp_path / name) for name in ("a.xml", "b.xml")
    )
    before = one.read_bytes()
    done = command("apply", "noisy.py", "-", "--write", input=before, cwd=tmp_path)
    assert done.returncode == 0
    assert re.sub(rb"\bWeigh\b", b"S2", done.stdout) == before != done.stdout
    assert done.stderr.count(b"when it runs") == 1
    done = command("apply", "noisy.py", one, other, "--json", "--jobs", 2, cwd=tmp_path)
    here = cli("apply", tmp_path / "noisy.py", one, other, "--json", "--jobs", 1)
    for out, err in ((done.stdout.decode(), done.stderr.decode()), (here.out, here.err)):
        assert [each["outcome"] for each in json.loads(out)["files"]] == ["changed", "changed"]
        assert err.count("when it runs") == 2
