"""Commands on many files: which files are meant, and what is done with each, told in their order.

With several jobs each file is worked on in a process of its own. Its output is kept, and printed in its turn.
"""

from __future__ import annotations

import glob
import os
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from plcopen_sfc.cli.command_files import STANDARD_STREAM, error_data
from plcopen_sfc.cli.screen import UNREADABLE, Line, Screen, T, Table
from plcopen_sfc.errors import FileAccessError, InputError, Location, SfcError, told_when_exhausted
from plcopen_sfc.files import folder_exists, path_exists, read_bytes

if TYPE_CHECKING:
    from plcopen_sfc.analysis.search_limits import SearchProgress

_LIST = "@"
"""The sign before the name of a file that lists files."""


@dataclass(frozen=True)
class ManyFiles:
    """The files of a command, as they were named: files, patterns, folders, and lists of these (``@list.txt``, ``@-``).

    `jobs` of them are worked on at a time.
    """

    named: tuple[str, ...]
    jobs: int = 1

    @cached_property
    def found(self) -> dict[str, str]:
        """The path of each file or project, once, with its name in an output folder: its path in the folder named.

        Raises `FileAccessError` where a pattern matches nothing.
        """
        from plcopen_sfc.batch import without_repeated  # noqa: PLC0415  # heavy, and help needs none of it

        found = _found(self.named)
        return {path: found[path] for path in without_repeated(found)}

    @property
    def alone(self) -> bool:
        """True if one file or project is named, and no pattern, list or folder of files: its report is no list."""
        return len(self.named) == 1 and [*self.found] == [*self.named]

    def with_target(self) -> tuple[ManyFiles, str | None]:
        """Return the files without the last one, and this: of ``SRC... [DST]``."""
        *sources, target = self.named
        return (ManyFiles(tuple(sources), self.jobs), target) if sources else (self, None)


def _found(names: Iterable[str]) -> dict[str, str]:
    from plcopen_sfc.batch import project_files  # noqa: PLC0415

    found: dict[str, str] = {}
    for name in names:
        if name.startswith(_LIST) and not path_exists(name):
            found |= _found(_listed(name[1:]))
        elif folder_exists(name):
            for path in project_files([name]) or [name]:
                found[path] = Path(path).name if path == name else Path(path).relative_to(name).as_posix()
        elif glob.has_magic(name) and not path_exists(name):
            matching = sorted(each for each in glob.glob(name, recursive=True) if not folder_exists(each))  # noqa: PTH207  # any path
            if not matching:
                hint = "Check the pattern and the working folder."
                raise FileAccessError("no file matches this pattern", location=Location(name), hint=hint)
            found |= {path: Path(path).name for path in matching}
        else:
            found[name] = Path(name).name
    return found


def _listed(name: str) -> list[str]:
    """Return the names in a list, one on each line; ``-`` is standard input."""
    text = sys.stdin.read() if name == STANDARD_STREAM else read_bytes(name).decode("utf-8-sig", "surrogateescape")
    return [line.strip() for line in text.splitlines() if line.strip()]


# -- targets ----------------------------------------------------------------------------------------------------------


def targets(
    files: ManyFiles, folder: str | None, beside: Callable[[Path], str], inside: Callable[[Path, str], str]
) -> dict[str, str]:
    """Return the path that each of several files is written to: `beside` it, or by its path and name `inside` a folder.

    Raises `InputError` where two would be written to one place, or one over a file that is read.
    """
    if folder is not None and not folder.endswith((os.sep, "/")) and not folder_exists(folder):
        hint = f"Name it last: {folder}/ if this is to be the folder."
        raise InputError("several files need a folder to be written into", location=Location(folder), hint=hint)
    made = {
        path: beside(Path(path)) if folder is None else f"{folder.rstrip('/')}/{inside(Path(path), name)}"
        for path, name in files.found.items()
    }
    sources = {os.path.realpath(path).casefold(): path for path in made}
    taken: dict[str, str] = {}
    for path, target in made.items():
        key = os.path.realpath(target).casefold()
        if key in sources:
            message = f"{path} would be written over {sources[key]}, which is read too"
            raise InputError(message, hint="Name another folder, last: out/")
        if key in taken:
            message = f"{taken[key]} and {path} would both be written to {target}"
            raise InputError(message, hint="Convert them one after the other, or into several folders.")
        taken[key] = path
    return made


# -- work -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class PrintedLine:
    """A line of the result, or of a message; `cut` where a terminal is too narrow for it."""

    line: Line
    message: bool = False
    cut: bool = False


class RecordedScreen(Screen):
    """The screen of one file of many: keeps what is printed on it, for that of the command."""

    def __init__(self, *, as_json: bool = False, quiet: bool = False, verbose: int = 0, unicode: bool = False) -> None:
        super().__init__(as_json=as_json, quiet=quiet, verbose=verbose)
        self.printed: list[PrintedLine | Table] = []
        self._unicode = unicode

    @classmethod
    def like(cls, screen: Screen) -> Callable[[], RecordedScreen]:
        """Return a function that makes screens with the options of another one, also in another process."""
        return partial(cls, as_json=screen.as_json, quiet=screen.quiet, verbose=screen.verbose, unicode=screen.unicode)

    @property
    def unicode(self) -> bool:
        """True if every sign can be shown where it will be printed."""
        return self._unicode

    def table(self, table: Table) -> None:
        """Keep a table."""
        self.printed.append(table)

    def progress(self, items: Iterable[T], doing: str, total: int) -> Iterator[T]:  # noqa: ARG002
        """Go through items without a bar: there is one of all files."""
        yield from items

    @contextmanager
    def searching(self) -> Iterator[Callable[[SearchProgress], None] | None]:
        """Give no bar."""
        yield None

    def _write(self, stream: TextIO, line: Line, *, cut: bool = False) -> None:
        self.printed.append(PrintedLine(line, stream is sys.stderr, cut))


def replay(screen: Screen, printed: Iterable[PrintedLine | Table], *, results: bool = True) -> None:
    """Print what was kept: messages, and `results` where they are wanted."""
    for each in printed:
        if isinstance(each, Table):
            if results:
                screen.table(each)
        elif each.message or results:
            screen.print(each.line, message=each.message, cut=each.cut)


@dataclass(frozen=True)
class FileResult:
    """Result for one file. `value` is what the work returned; `resumed`: the run that was resumed had done it."""

    path: str
    value: Any = None
    error: SfcError | None = None
    exit_code: int = 0
    printed: Sequence[PrintedLine | Table] = field(default=(), repr=False)
    resumed: bool = False

    def as_dict(self) -> dict[str, Any]:
        """Return the value as plain data, or the error."""
        if self.error is not None:
            return {"file": self.path, "error": error_data(self.error)}
        return {"file": self.path, "resumed": True} if self.resumed else dict(self.value)


def for_each(
    screen: Screen,
    things: Iterable[str] | Mapping[str, Any],
    work: Callable[..., Any],
    doing: str,
    *,
    jobs: int = 1,
    journal: tuple[Path, object] | None = None,
    told: bool = True,
) -> list[FileResult]:
    """Do `work(screen, path)`, or `work(screen, path, what)` of a mapping, with each, and show it in their order.

    An error is printed, and stops no other file; the exit code is the worst of all. With several jobs `work` has to be
    a function of a module, or a `partial` of one. `journal`: a file that keeps what is done, and what is run, so that
    the next run leaves it out: what did not fail, and where the mapping names the result, is there and no older than
    its source. `told`: how many files were fine is printed in the end.
    """
    from plcopen_sfc.batch import RunJournal  # noqa: PLC0415
    from plcopen_sfc.processes import results  # noqa: PLC0415  # brings process pools with it

    given = [*things.items()] if isinstance(things, Mapping) else [(path,) for path in things]
    if len(given) == 1 and journal is None:
        return [_alone(screen, work, given[0])]
    outcomes: list[FileResult] = []
    with RunJournal(str(journal[0]), journal[1]) if journal is not None else nullcontext() as kept:
        done = {each[0] for each in given if kept is not None and _is_done(each, kept.done)}
        made = results(
            partial(_recorded, RecordedScreen.like(screen), work),
            [each for each in given if each[0] not in done],
            jobs,
            lost=_lost,
        )
        ordered = (FileResult(path, resumed=True) if path in done else next(made) for path, *_ in given)
        for outcome in screen.progress(ordered, doing, len(given)):
            replay(screen, outcome.printed)
            screen.exit_code = max(screen.exit_code, outcome.exit_code)
            if kept is not None and not outcome.resumed:
                kept.end(outcome.path, str(outcome.error) if outcome.error is not None else "")
            outcomes.append(replace(outcome, printed=()))
    if told:
        _summarise(screen, outcomes)
    return outcomes


def _alone(screen: Screen, work: Callable[..., Any], thing: tuple[Any, ...]) -> FileResult:
    """Do the work with one file on the screen itself."""
    path = thing[0]
    try:
        with told_when_exhausted(path):
            value = work(screen, *thing)
    except SfcError as error:
        screen.exit_code = UNREADABLE
        screen.error(error)
        return FileResult(path, error=error, exit_code=UNREADABLE)
    return FileResult(path, value, exit_code=screen.exit_code)


def _recorded(new_screen: Callable[[], RecordedScreen], work: Callable[..., Any], thing: tuple[Any, ...]) -> FileResult:
    screen, path = new_screen(), thing[0]
    try:
        found = _alone(screen, work, thing)
    except OSError as problem:
        error = SfcError(problem.strerror or str(problem), location=Location(path))
    except Exception as mistake:  # one of this package, which is told, and stops no other file
        hint = "This is a bug in plcopen_sfc, please report it; --verbose shows the details of this file alone."
        error = SfcError(f"{type(mistake).__name__}: {mistake}", location=Location(path), hint=hint)
    else:
        return FileResult(path, found.value, found.error, found.exit_code, screen.printed)
    screen.error(error)
    return FileResult(path, error=error, exit_code=UNREADABLE, printed=screen.printed)


def _lost(thing: tuple[Any, ...], why: str) -> FileResult:
    line: Line = [("error: ", "bold red"), (f"{thing[0]}: {why}", "")]
    error = SfcError(why, location=Location(thing[0]))
    return FileResult(thing[0], error=error, exit_code=UNREADABLE, printed=[PrintedLine(line, message=True)])


def _is_done(thing: tuple[Any, ...], done: Mapping[str, str]) -> bool:
    path, *made = thing
    if done.get(path) != "":
        return False
    try:
        return not made or Path(path).stat().st_mtime_ns <= Path(made[0]).stat().st_mtime_ns
    except OSError:
        return False


# -- summary ----------------------------------------------------------------------------------------------------------


def _summarise(screen: Screen, outcomes: Sequence[FileResult]) -> None:
    words = Counter(
        "failed" if each.error is not None
        else "done before" if each.resumed
        else "with findings" if each.exit_code
        else "fine"
        for each in outcomes
    )  # fmt: skip
    counts = {word: words[word] for word in ("fine", "with findings", "failed", "done before") if words[word]}
    show_counts(screen, counts, {each.path: str(each.error) for each in outcomes if each.error is not None})


def show_counts(screen: Screen, counts: Mapping[str, int], errors: Mapping[str, str], note: str = "") -> None:
    """Print how many files there were of each outcome, and where several failed a table of the reasons."""
    if screen.as_json or screen.quiet:
        return
    reasons = Counter(error.replace(path, "..").partition("\n")[0] for path, error in errors.items())
    if len(errors) > 1:
        table = Table(["files", "failed because"])
        table.rows = [[count, reason] for reason, count in reasons.most_common(_REASONS)]
        screen.table(table)
    screen.line(", ".join(f"{count} {word}" for word, count in counts.items()) + note)


_REASONS = 10
"""Reasons that the summary lists, the most frequent first."""
