"""``plcopen-sfc git-setup``: let git show changes in the words of charts."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.errors import SfcError
from plcopen_sfc.files import path_exists, read_bytes, write_atomic
from plcopen_sfc.formats.registry import all_formats

_NAME = "plcopen-sfc"
_LINE = re.compile(rf"^\S+ diff={_NAME}\r?\n?$")


def run(screen: Screen, patterns: Sequence[str], *, undo: bool) -> int:
    """Write, or with `undo` take out again, what makes git use `plcopen-sfc diff` in this repository."""
    root = Path(_git("rev-parse", "--show-toplevel").strip())
    attributes = root / ".gitattributes"
    lines = [] if undo else [f"{pattern} diff={_NAME}" for pattern in patterns or _known_patterns()]
    is_changed = _write(attributes, lines)
    settings = {} if undo else _settings()
    for section in (f"diff.{_NAME}", f"difftool.{_NAME}"):
        _git("config", "--local", "--remove-section", section, may_fail=True)
    for name, value in settings.items():
        _git("config", "--local", name, value)
    if not screen.as_json and not screen.quiet:
        if is_changed:
            screen.line("written: ", (str(attributes), "bold"))
        screen.line("git diff shows ", "lines of the files again" if undo else f"changes of {', '.join(lines)}")
    screen.result({"attributes": str(attributes), "lines": lines, "config": settings})
    return 0


def _known_patterns() -> list[str]:
    extensions = dict.fromkeys(extension for kind in all_formats() for extension in kind.extensions if kind.tool)
    return [f"*{extension}" for extension in extensions]


def _settings() -> dict[str, str]:
    """The driver and the difftool. A file that is no program of a PLC is shown as plain lines."""
    command = f"'{Path(sys.executable).as_posix()}' -m plcopen_sfc diff"
    # git gives the path, then file, hash and mode of the old version and of the new one
    driver = f"""f() {{ echo "$1"; {command} "$2" "$5" 2>/dev/null || diff -u "$2" "$5"; true; }}; f"""
    return {f"diff.{_NAME}.command": driver, f"difftool.{_NAME}.cmd": f'{command} "$LOCAL" "$REMOTE"'}


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
