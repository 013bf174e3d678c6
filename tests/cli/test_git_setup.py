"""git-setup: git diff shows changes in the words of charts, until that is undone; hooks for pre-commit."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.cli import main
from plcopen_sfc.formats.registry import all_formats

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="needs git")


def git(*arguments: str) -> str:
    author = ("-c", "user.name=A", "-c", "user.email=a@example.org", "-c", "core.autocrlf=false")
    return subprocess.run(["git", *author, *arguments], capture_output=True, encoding="utf-8", check=True).stdout


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A repository with a chart and another XML file, as the working folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    git("init", "--quiet")
    shutil.copy(ROOT / "fixtures" / "training-chain" / "codesys.xml", "chain.xml")
    Path("pom.xml").write_text("<project>\n  <a/>\n</project>\n", encoding="utf-8")
    git("add", ".")
    git("commit", "--quiet", "-m", "first")
    return tmp_path


@pytest.mark.slow
def test_git_diff_shows_changes_of_charts_and_lines_of_other_files(repository, cli):
    assert cli("git-setup", "*.xml").code == 0
    assert (repository / ".gitattributes").read_bytes() == b"*.xml diff=plcopen-sfc merge=plcopen-sfc\n"
    assert cli("rename", "chain.xml", "Ablauf.S2", "Fill").code == 0
    assert git("diff", "chain.xml").splitlines() == ["chain.xml", "POU Ablauf", "  step Fill: renamed, was S2"]
    assert git("difftool", "-y", "-t", "plcopen-sfc", "chain.xml").splitlines()[-1] == "  step Fill: renamed, was S2"
    (repository / "pom.xml").write_text("<project>\n  <b/>\n</project>\n", encoding="utf-8")
    assert "+  <b/>" in git("diff", "pom.xml").splitlines()
    shutil.copy("chain.xml", "new.xml")
    git("add", "new.xml")
    assert "POU Ablauf: added (functionBlock)" in git("diff", "--cached", "new.xml")
    assert cli("git-setup", "--undo").code == 0
    assert not (repository / ".gitattributes").exists()
    assert "plcopen" not in (repository / ".git" / "config").read_text(encoding="utf-8")
    assert git("diff", "chain.xml").startswith("diff --git")


def test_it_tells_the_files_as_people_write_them(repository, cli):
    told = cli("git-setup").out
    assert "git diff shows changes of charts in words: *.xml, *.tcpou, " in told
    assert "[xX]" not in told


@pytest.mark.slow
def test_git_log_shows_text_and_hides_no_change(repository, cli):
    assert cli("git-setup", "*.xml").code == 0
    assert cli("rename", "chain.xml", "Ablauf.S2", "Fill").code == 0
    git("commit", "--quiet", "-am", "renamed")
    shown = git("log", "-p", "-1", "--", "chain.xml")
    assert re.search(r"^-\s+STEP S2:", shown, re.MULTILINE)
    assert re.search(r"^\+\s+STEP Fill:", shown, re.MULTILINE)
    assert "localId" not in shown
    Path("chain.xml").write_bytes(Path("chain.xml").read_bytes() + b"<!-- not in the text -->\n")
    git("commit", "--quiet", "-am", "noted")
    assert len(re.findall(r"^[-+][0-9a-f]{40}$", git("log", "-p", "-1", "--", "chain.xml"), re.MULTILINE)) == 2
    Path("pom.xml").write_text("<project>\n  <b/>\n</project>\n", encoding="utf-8")
    git("commit", "--quiet", "-am", "other")
    assert "+  <b/>" in git("log", "-p", "-1").splitlines()


@pytest.mark.slow
def test_git_merge_takes_what_both_sides_changed_and_tells_of_a_conflict(repository, cli):
    assert cli("git-setup", "*.xml").code == 0
    branch = git("branch", "--show-current").strip()
    git("checkout", "--quiet", "-b", "other")
    assert cli("rename", "chain.xml", "Ablauf.S2", "Fill").code == 0
    git("commit", "--quiet", "-am", "theirs")
    git("checkout", "--quiet", branch)
    assert cli("rename", "chain.xml", "Ablauf.Q1", "Pump").code == 0
    git("commit", "--quiet", "-am", "ours")
    git("merge", "--quiet", "-m", "both", "other")
    chart = sfc.load("chain.xml").pou("Ablauf").chart
    assert chart.step("Fill")
    assert b"Pump" in Path("chain.xml").read_bytes()
    git("checkout", "--quiet", "-b", "third", "HEAD~1")
    assert cli("rename", "chain.xml", "Ablauf.S2", "Mix").code == 0
    git("commit", "--quiet", "-am", "third")
    with pytest.raises(subprocess.CalledProcessError) as conflict:
        git("merge", "--quiet", "-m", "both", branch)
    assert conflict.value.returncode == 1
    told = conflict.value.stderr
    assert "chain.xml: both sides change the same lines" in told
    assert "ours: POU Ablauf / step Mix: renamed, was S2" in told
    assert "theirs: POU Ablauf / step Fill: renamed, was S2" in told


@pytest.mark.slow
def test_git_diff_tells_names_and_modes(repository, cli):
    """Of a file that was only renamed it told "no differences" below its old name."""
    assert cli("git-setup", "*.xml").code == 0
    git("config", "core.fileMode", "true")
    Path("chain.xml").chmod(0o755)
    assert git("diff").splitlines() == ["chain.xml", "mode 100644 -> 100755"]
    Path("chain.xml").chmod(0o644)
    git("mv", "chain.xml", "line.xml")
    moved = ["chain.xml", "similarity index 100%", "rename from chain.xml", "rename to line.xml"]
    assert git("diff", "--cached", "-M").splitlines() == moved
    assert cli("rename", "line.xml", "Ablauf.S2", "Fill").code == 0
    git("add", "line.xml")
    told = git("diff", "--cached", "-M").splitlines()
    assert told[2:] == [*moved[2:], "POU Ablauf", "  step Fill: renamed, was S2"]


@pytest.mark.parametrize("name", ["a b.xml", '"q.xml', "#y", 'c "d" \\e.xml'])
def test_a_pattern_with_a_blank_is_quoted(repository, cli, name):
    """Of the pattern `a b.xml` git took `a`, and `b.xml` for an attribute."""
    outcome = cli("git-setup", name.replace("\\", "\\\\"))
    assert outcome.code == 0
    assert f"changes of charts in words: {name}\n" in outcome.out or "\\" in name
    assert git("check-attr", "-z", "diff", "--", name, "a", "b.xml").split("\0")[2::3] == [
        "plcopen-sfc", "unspecified", "unspecified",
    ]  # fmt: skip
    assert cli("git-setup", "--undo").code == 0
    assert not (repository / ".gitattributes").exists()


@pytest.mark.parametrize("pattern", ["!x", "", " ", "a\nb"])
def test_what_is_no_pattern_is_refused(repository, cli, pattern):
    outcome = cli("git-setup", pattern)
    assert outcome.code == 2
    assert "is no pattern of files for git" in outcome.err
    assert not (repository / ".gitattributes").exists()


def test_other_lines_stay_as_they_are(repository, cli):
    attributes = repository / ".gitattributes"
    attributes.write_bytes(b"*.png binary\r\n*.exp -text")
    outcome = cli("git-setup", "--json")
    found = json.loads(outcome.out)
    assert "*.[xX][mM][lL] diff=plcopen-sfc merge=plcopen-sfc" in found["lines"]
    assert attributes.read_bytes().startswith(
        b"*.png binary\r\n*.exp -text\r\n*.[xX][mM][lL] diff=plcopen-sfc merge=plcopen-sfc\r\n"
    )
    written = attributes.read_bytes()
    assert cli("git-setup").code == 0  # twice is once
    assert attributes.read_bytes() == written
    assert cli("git-setup", "--undo").code == 0
    assert attributes.read_bytes() == b"*.png binary\r\n*.exp -text\r\n"


def test_files_of_all_tools_are_known_in_any_case(repository, cli):
    assert cli("git-setup").code == 0
    names = ["A.TcPOU", "a.tcpou", "belt.EXP", "P.XML", "p.xml", "plan.gct", "plan.grafcet", "Block.scl", "x.export"]
    assert git("check-attr", "merge", "--", *names).splitlines() == [f"{name}: merge: plcopen-sfc" for name in names]


TEXT = """PROGRAM Main
VAR a, q : BOOL; END_VAR

INITIAL_STEP S1: END_STEP

TRANSITION FROM S1 TO S2
  := a;
END_TRANSITION

STEP S2: Act(N); END_STEP

TRANSITION FROM S2 TO S1
  := NOT a;
END_TRANSITION

ACTION Act:
q := a;
END_ACTION
END_PROGRAM
"""


def merged(cli, theirs, ours):
    """Merge two versions of a text in git, and return what it tells of a conflict."""
    Path("m.st").write_text(TEXT, encoding="utf-8")
    git("add", "m.st")
    git("commit", "--quiet", "-m", "text")
    assert cli("git-setup").code == 0
    branch = git("branch", "--show-current").strip()
    git("checkout", "--quiet", "-b", "other")
    Path("m.st").write_text(theirs, encoding="utf-8")
    git("commit", "--quiet", "-am", "theirs")
    git("checkout", "--quiet", branch)
    Path("m.st").write_text(ours, encoding="utf-8")
    git("commit", "--quiet", "-am", "ours")
    with pytest.raises(subprocess.CalledProcessError) as conflict:
        git("merge", "--quiet", "-m", "both", "other")
    return conflict.value.stderr


@pytest.mark.slow
def test_a_new_use_of_what_the_other_side_renamed_is_a_conflict(repository, cli):
    told = merged(cli, TEXT.replace("S1", "Fill"), TEXT.replace("q := a;", "q := a OR S1.X;"))
    assert "'S1' is named, and nothing declares it" in told


@pytest.mark.slow
def test_a_name_that_both_sides_give_is_a_conflict(repository, cli):
    """Lines merge; of two actions of one name the first was executed for both sides."""
    theirs = TEXT.replace("ACTION Act", "ACTION New: q := TRUE; END_ACTION\n\nACTION Act")
    ours = TEXT.replace("END_PROGRAM", "\nACTION New: q := FALSE; END_ACTION\nEND_PROGRAM")
    assert "POU Main: a second action New" in merged(cli, theirs, ours)


MACHINE = """VAR_GLOBAL
  x, start : BOOL;
END_VAR

PROGRAM Main
VAR
  n : INT;
  b : BOOL;

END_VAR
INITIAL_STEP S0:
END_STEP

TRANSITION FROM S0 TO S1
  := start;
END_TRANSITION

STEP S1:

  Act(N);
END_STEP

TRANSITION FROM S1 TO S2
  := b;
END_TRANSITION

STEP S2:
END_STEP

TRANSITION FROM S2 TO S0
  := n > 3;
END_TRANSITION

ACTION Act:
  n := n + 1;

  b := start;

  n := n * 2;
END_ACTION
END_PROGRAM
"""


@pytest.fixture
def git_merge(tmp_path, monkeypatch, cli):
    """Merging edits of MACHINE, each from and to a text, as git asks the driver; returns the outcome and the file."""
    monkeypatch.chdir(tmp_path)

    def run(ours, theirs):
        for name, edits in (("base", ()), ("ours", ours), ("theirs", theirs)):
            text = MACHINE
            for old, new in edits:
                assert old in text
                text = text.replace(old, new)
            Path(name).write_text(text, encoding="utf-8")
        return cli("git-merge", "base", "ours", "theirs", "m.st"), Path("ours").read_text(encoding="utf-8")

    return run


LOCAL_X = ("  b : BOOL;\n", "  b : BOOL;\n  x : BOOL;\n")
USED_X = ("n > 3", "n > 3 AND x")
INITIAL = ("INITIAL_STEP S0", "STEP S0")


@pytest.mark.parametrize(
    ("ours", "theirs", "told"),
    [
        ([LOCAL_X], [USED_X], "'x' means Main.x, and x on one side"),
        ([LOCAL_X, (":= b;", ":= x;")], [USED_X], "'x' means Main.x, and x on one side"),
        (
            [("  b : BOOL;\n", "  b : BOOL;\n  y : BOOL;\n")],
            [("n > 3", "n > 3 AND y")],
            "'y' means Main.y, and something",
        ),
        (
            [INITIAL, ("STEP S1:", "INITIAL_STEP S1:")],
            [INITIAL, ("STEP S2:", "INITIAL_STEP S2:")],
            "STR12 a second initial step",
        ),
        (
            [("  b : BOOL;\n", "  b : BOOL;\n  S9 : BOOL;\n")],
            [
                (
                    "ACTION Act:",
                    "STEP S9: END_STEP\nTRANSITION FROM S2 TO S9 := x; END_TRANSITION\n"
                    "TRANSITION FROM S9 TO S0 := TRUE; END_TRANSITION\nACTION Act:",
                )
            ],
            "NAM03",
        ),
    ],
)
def test_a_merge_that_makes_what_no_side_has_is_a_conflict(git_merge, ours, theirs, told):
    """Lines merge; a use of a global variable meant a local one then, or a chart had two initial steps."""
    for one, other in ((ours, theirs), (theirs, ours)):
        outcome, _ = git_merge(one, other)
        assert outcome.code == 1
        assert told in outcome.err


@pytest.mark.parametrize(
    ("ours", "theirs", "parts"),
    [
        ([("n + 1", "n + 2")], [("n * 2", "n * 9")], ["n + 2", "n * 9"]),
        ([LOCAL_X, ("n + 1", "n + 2")], [("n * 2", "n * 9"), ("n > 3", "n > 4")], ["x : BOOL;\n", "n > 4"]),
        ([LOCAL_X, (":= b;", ":= b AND x;")], [(":= start;", ":= start AND n = 0;")], ["b AND x", "n = 0"]),
        ([("S1", "Fill")], [("n > 3", "n > 3 AND n < 9")], ["Fill", "n < 9"]),
        ([("PROGRAM Main", "PROGRAM Other")], [("n > 3", "n > 3 AND n < 9")], ["Other", "n < 9"]),
        ([("S1", "Fill")], [("Act(N)", "Act(P)")], ["STEP Fill", "Act(P)"]),
        ([(":= b;", ":= n > 0;")], [("  b := start;\n", "")], ["n > 0", "* 2"]),  # nothing uses b then
    ],
)
def test_lines_of_both_sides_are_no_conflict(git_merge, ours, theirs, parts):
    """Two that change other lines of one action are both taken."""
    for one, other in ((ours, theirs), (theirs, ours)):
        outcome, text = git_merge(one, other)
        assert (outcome.code, outcome.err) == (0, "")
        assert all(part in text for part in parts)


def test_outside_of_a_repository_it_is_an_error(tmp_path, monkeypatch, cli):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    outcome = cli("git-setup")
    assert (outcome.code, outcome.out) == (2, "")
    assert "Run this in a repository of git." in outcome.err


def test_the_hooks_of_pre_commit_are_commands(capsys):
    hooks = (ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8")
    for entry in re.findall(r"^  entry: (.*)$", hooks, re.MULTILINE):
        program, *arguments = entry.split()
        assert program == "plcopen-sfc"
        assert main([*arguments, str(ROOT / "fixtures" / "training-chain" / "codesys.xml")]) == 0
        # nothing of a file of TC6 is left out, whatever it is like
        broken = main([*arguments, str(ROOT / "fixtures" / "broken" / "truncated.xml")])
        assert broken == (0 if arguments == ["normalize"] else 2)
        capsys.readouterr()
    (files,) = re.findall(r"files: &files (.*)", hooks)
    extensions = {each for kind in all_formats() for each in kind.extensions}
    of_other_programs = {".json", ".xlsx", ".csv", ".sdf"}
    assert {each for each in extensions if not re.search(files, f"Line{each.upper()}")} == of_other_programs
