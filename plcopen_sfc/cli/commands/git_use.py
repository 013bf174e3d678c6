"""``plcopen-sfc git-setup`` and ``git-merge``: let git show changes in the words of charts, and check merged files."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from plcopen_sfc.api import loads
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.comparison import diff
from plcopen_sfc.comparison.merged_files import Versions, merge_faults
from plcopen_sfc.errors import ArgumentError, Location, SfcError
from plcopen_sfc.files import path_exists, read_bytes, write_atomic
from plcopen_sfc.formats.registry import all_formats

_NAME = "plcopen-sfc"
_LINE = re.compile(rf'^(?:"(?:[^"\\]|\\.)*"|\S+) diff={_NAME}(?: merge={_NAME})?\r?\n?$')
_SECTIONS = (f"diff.{_NAME}", f"difftool.{_NAME}", f"merge.{_NAME}")
_CONFLICT = 1


def setup(screen: Screen, patterns: Sequence[str] | None, *, undo: bool) -> int:
    """Write, or with `undo` take out again, what makes git use `plcopen-sfc diff` in this repository."""
    root = Path(_git("rev-parse", "--show-toplevel").strip())
    attributes = root / ".gitattributes"
    wanted = [] if undo else patterns or _known_patterns()
    lines = [f"{_quoted(pattern)} diff={_NAME} merge={_NAME}" for pattern in wanted]
    is_changed = _write(attributes, lines)
    settings = {} if undo else _settings()
    for section in _SECTIONS:
        _git("config", "--local", "--remove-section", section, may_fail=True)
    for name, value in settings.items():
        _git("config", "--local", name, value)
    if not screen.as_json and not screen.quiet:
        if is_changed:
            screen.line("written: ", (str(attributes), "bold"))
        told = ", ".join(re.sub(r"\[(\w)\w\]", r"\1", pattern) for pattern in wanted)  # *.xml of *.[xX][mM][lL]
        screen.line("git diff shows ", "lines of the files again" if undo else f"changes of charts in words: {told}")
    screen.result({"attributes": str(attributes), "lines": lines, "config": settings})
    return 0


def _quoted(pattern: str) -> str:
    """Return a pattern as `.gitattributes` has it: in quotation marks where a blank would end it (gitattributes(5))."""
    if not pattern.strip() or pattern.startswith("!") or not pattern.isprintable():
        hint = "Patterns are such as '*.xml'; .gitattributes has none that begin with !."
        raise ArgumentError(f"{pattern!r} is no pattern of files for git", hint=hint)
    if " " not in pattern and not pattern.startswith(('"', "#")):
        return pattern
    return '"' + pattern.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _known_patterns() -> list[str]:
    """Return patterns for the files of tools, in any case: to git ``A.TcPOU`` is no ``*.tcpou``, but on Windows."""
    kinds = (kind for kind in all_formats() if kind.tool or kind.name.startswith("grafcet"))
    extensions = dict.fromkeys(extension for kind in kinds for extension in kind.extensions)
    letters = ("".join(f"[{c}{c.upper()}]" if c.isalpha() else c for c in extension) for extension in extensions)
    return [f"*{extension}" for extension in letters]


def _settings() -> dict[str, str]:
    """Return the drivers and the difftool. A file that is no program of a PLC is shown as plain lines."""
    program = f"'{Path(sys.executable).as_posix()}' -m plcopen_sfc"
    command = f"{program} diff"
    # what the text does not have is seen by the last line: no change of a file is hidden
    text = f'{program} convert "$1" - --to iec-text --partial --accept-errors --limit 0 --quiet 2>/dev/null'
    shown = """if [ -n "$t" ]; then printf '%s\\n' "$t"; git hash-object "$1"; else cat "$1"; fi"""
    # git gives the path, then file, hash and mode of the old version and of the new one; of a renamed file its new path
    # and lines that tell it; a file that is new or gone has the mode "." on one side
    renamed = """if [ -n "$9" ]; then printf '%s' "$9" | grep -v '^index '; fi"""
    mode = """case "$4.$7" in .*|*.|"$4.$4") ;; *) echo "mode $4 -> $7" ;; esac"""
    content = f"""{command} "$2" "$5" 2>/dev/null || diff -u "$2" "$5\""""
    driver = f"""f() {{ echo "$1"; {renamed}; {mode}; cmp -s "$2" "$5" || {content}; true; }}; f"""
    return {
        f"diff.{_NAME}.command": driver,
        f"diff.{_NAME}.textconv": f"f() {{ t=$({text}); {shown}; }}; f",
        f"difftool.{_NAME}.cmd": f'{command} "$LOCAL" "$REMOTE"',
        f"merge.{_NAME}.name": "merge lines, and compare the charts with both sides",
        f"merge.{_NAME}.driver": f"{program} git-merge %O %A %B %P",
    }


def _write(path: Path, lines: Sequence[str]) -> bool:
    """Put our lines at the end of a file in place of those that it has; a file of nothing else is removed."""
    before = read_bytes(path).decode("utf-8") if path_exists(path) else ""
    kept = "".join(line for line in before.splitlines(keepends=True) if not _LINE.match(line))
    end = "\r\n" if "\r\n" in before else "\n"
    separator = end if kept and lines and not kept.endswith("\n") else ""
    after = kept + separator + "".join(line + end for line in lines)
    if after == before:
        return False
    if after:
        write_atomic(path, after.encode())
    else:
        path.unlink()
    return True


def _git(*arguments: str, may_fail: bool = False) -> str:
    """Run git here; raises `SfcError` where it cannot do it."""
    try:
        done = subprocess.run(["git", *arguments], capture_output=True, text=True, check=False)  # noqa: S603, S607
    except OSError as error:
        raise SfcError(f"git cannot be run: {error.strerror}", hint="Install git, or put it on the PATH.") from None
    if done.returncode and not may_fail:
        raise SfcError(f"git: {done.stderr.strip()}", hint="Run this in a repository of git.")
    return done.stdout


# -- merging ----------------------------------------------------------------------------------------------------------


def merge(screen: Screen, base: str, ours: str, theirs: str, name: str) -> int:
    """Merge three versions of the file `name` into `ours`, as git asks a merge driver to do.

    Lines are merged as git does it. A file of a PLC tool is merged if it can be read then, and has the changes of both
    sides and no other; else this is a conflict, and the changes of both sides are told.
    """
    done = subprocess.run(["git", "merge-file", "-p", ours, base, theirs], capture_output=True, check=False)  # noqa: S603, S607
    if done.returncode < 0 or done.returncode > _MOST_CONFLICTS:
        raise SfcError(f"git: {done.stderr.decode(errors='replace').strip()}", location=Location(name))
    sides = [read_bytes(path) for path in (base, ours, theirs)]
    write_atomic(ours, done.stdout)
    try:
        versions = Versions(*(loads(data, path=name) for data in sides))
        changes = [diff(versions.base, side).changes for side in (versions.ours, versions.theirs)]
    except SfcError:  # no file of a PLC tool, or new on both sides: lines are all there is
        return min(done.returncode, _CONFLICT)
    told: set[str] = set()
    if not done.returncode:
        try:
            told = merge_faults(loads(done.stdout, path=name), versions, changes)
        except SfcError as error:
            told = {str(error)}
    if not done.returncode and not told:
        return 0
    screen.note(f"{name}: {'both sides change the same lines' if done.returncode else 'the merged file is not both'}")
    for side, found in zip(("ours", "theirs", "merged"), (*(map(str, each) for each in changes), told), strict=True):
        for text in sorted(set(found)):
            screen.note(f"  {side}: {text}")
    return _CONFLICT


_MOST_CONFLICTS = 127
"""The exit code of ``git merge-file`` is the number of conflicts up to this; above it is an error."""
