"""``plcopen-sfc git-setup`` and ``git-merge``: let git show changes in the words of charts, and check merged files."""

from __future__ import annotations

import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from plcopen_sfc.api import loads
from plcopen_sfc.checking import check
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.comparison import Change, ChangeKind, diff
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.errors import ArgumentError, Location, SfcError
from plcopen_sfc.files import path_exists, read_bytes, write_atomic
from plcopen_sfc.formats.registry import all_formats
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.model.project import Project

_NAME = "plcopen-sfc"
_LINE = re.compile(rf'^(?:"(?:[^"\\]|\\.)*"|\S+) diff={_NAME}(?: merge={_NAME})?\r?\n?$')
_SECTIONS = (f"diff.{_NAME}", f"difftool.{_NAME}", f"merge.{_NAME}")
_CONFLICT = 1


def setup(screen: Screen, patterns: Sequence[str], *, undo: bool) -> int:
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
        versions = _Versions(*(loads(data, path=name) for data in sides))
        changes = [diff(versions.base, side).changes for side in (versions.ours, versions.theirs)]
    except SfcError:  # no file of a PLC tool, or new on both sides: lines are all there is
        return min(done.returncode, _CONFLICT)
    told = set() if done.returncode else _faults(done.stdout, versions, changes, name)
    if not done.returncode and not told:
        return 0
    screen.note(f"{name}: {'both sides change the same lines' if done.returncode else 'the merged file is not both'}")
    for side, found in zip(("ours", "theirs", "merged"), (*(map(str, each) for each in changes), told), strict=True):
        for text in sorted(set(found)):
            screen.note(f"  {side}: {text}")
    return _CONFLICT


class _Versions(NamedTuple):
    """A file as it was before both sides changed it, and as they have it."""

    base: Project
    ours: Project
    theirs: Project


def _faults(data: bytes, versions: _Versions, changes: Sequence[Sequence[Change]], name: str) -> set[str]:
    """Return the faults of a merged file, in words: what neither side has, or only one, and is not meant so."""
    try:
        merged = loads(data, path=name)
        told = _errors(merged) - _errors(versions.base) | _unlike(diff(versions.base, merged).changes, changes)
        told |= _new_findings(merged, versions)
    except SfcError as error:
        return {str(error)}
    names = [Names(each) for each in (merged, *versions)]
    lost = _undeclared(names[0]) - _undeclared(names[2]) - _undeclared(names[3])
    told |= {f"{each!r} is named, and nothing declares it" for each in lost}  # one side renamed it
    told |= _declared_twice(merged) - _declared_twice(versions.ours)  # both sides added it
    return told | set(_other_meanings(names))


def _errors(project: Project) -> set[str]:
    return {str(each) for each in project.diagnostics if each.severity is Severity.ERROR}


def _unlike(found: Sequence[Change], sides: Sequence[Sequence[Change]]) -> set[str]:
    """Return the changes of a merged file that are missing or of no side.

    Of one text both sides may have changed lines: the merged one has the changed lines of both, and no others.
    """
    say = _in_new_names([each for side in sides for each in side])

    def place(change: Change) -> tuple[str, str, str]:
        return say(change.path), change.what, change.aspect

    def lines(change: Change) -> set[str]:
        return {say(line) for line in change.lines if line.startswith(("+", "-"))}

    def words(change: Change) -> str:
        is_renamed = change.kind is ChangeKind.RENAMED  # whose old name stays
        return f"{say(change.place)}: {change.news}" if is_renamed else say(str(change))

    ours, theirs = ({place(each): lines(each) for each in side} for side in sides)
    both = {where: ours[where] | theirs[where] for where in ours if ours[where] and theirs.get(where)}
    fits = {place(each) for each in found if lines(each) == both.get(place(each))}
    told, wanted = (
        {words(each) for each in changes if place(each) not in fits}
        for changes in (found, [each for side in sides for each in side])
    )
    return {f"lacks {each}" for each in wanted - told} | {f"of no side: {each}" for each in told - wanted}


def _in_new_names(changes: Sequence[Change]) -> Callable[[str], str]:
    """Return the function that gives a text the names that things have after both sides renamed some.

    A side that knows nothing of that tells its changes with the old ones.
    """
    names = {each.before: each.after or "" for each in changes if each.kind is ChangeKind.RENAMED and each.before}
    if not names:
        return str
    pattern = re.compile(rf"(?<!\w)(?:{'|'.join(map(re.escape, names))})(?!\w)")
    return lambda text: pattern.sub(lambda found: names[found[0]], text)


def _new_findings(merged: Project, versions: _Versions) -> set[str]:
    """Return the errors and warnings of `check` in a merged file that neither side has.

    One that a side brought may have other words, where the other side renamed what it names.
    """
    found, base, *sides = (dict(_findings(each)) for each in (merged, *versions))
    known = {text: code for side in sides for text, code in side.items()}
    gone = Counter(code for text, code in known.items() if text not in found and text not in base)
    new = {text: code for text, code in found.items() if text not in known}
    counts = Counter(new.values())
    return {text for text, code in new.items() if counts[code] > gone[code]}


def _findings(project: Project) -> Iterator[tuple[str, str]]:
    """Yield the errors and warnings of `check` in words, each with its code."""
    for found in check(project):
        if found.severity is not Severity.INFO:
            yield f"{found.location.path or ''}: {found.code} {found.message}", found.code


def _undeclared(names: Names) -> set[str]:
    """Return the names in program text of a file that it does not declare."""
    return {each.reference.name for each in (*names.undeclared(), *names.undeclared_members())}


def _declared_twice(project: Project) -> set[str]:
    """Return the things of a file whose names others of their kind have, in words."""
    return {
        f"{pou.report_path}: a second {word} {thing.name}"
        for pou in project.pous
        for word, thing, _ in pou.declared_twice()
    }


class _Meaning(NamedTuple):
    """What a name in a text means: the path of its declaration, empty for what is not in the file."""

    name: str
    path: str
    is_local: bool


def _meanings(names: Names) -> Counter[_Meaning]:
    """Return what the names in the texts of a file mean, each with how often."""
    found = Counter[_Meaning]()
    for each in names.everything:
        meant = each.meaning.declaration
        if not each.meaning.doubt:
            path = meant.path if meant is not None else ""
            found[_Meaning(each.reference.name.casefold(), path, meant is not None and meant.pou is not None)] += 1
    return found


def _other_meanings(names: Sequence[Names]) -> Iterator[str]:
    """Yield the names that mean something else after a merge: more mean the one than both sides have made so.

    Fewer mean another thing then that the file still declares, or that is in another file.
    """
    merged, base, ours, theirs = map(_meanings, names)
    declared = {each.path for each in names[0].declarations()}
    for meaning, count in merged.items():
        if count <= max(ours[meaning], theirs[meaning], ours[meaning] + theirs[meaning] - base[meaning]):
            continue
        for other in {*ours, *theirs}:
            is_lost = ours[other] + theirs[other] - base[other] > merged[other]
            is_there = other.path in declared if other.path else meaning.is_local
            if other.name == meaning.name and other != meaning and is_lost and is_there:
                before = other.path or "something of another file"
                yield f"{meaning.name!r} means {meaning.path or 'nothing of this file'}, and {before} on one side"


_MOST_CONFLICTS = 127
"""The exit code of ``git merge-file`` is the number of conflicts up to this; above it is an error."""
