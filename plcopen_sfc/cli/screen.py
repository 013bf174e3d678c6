"""Output of the commands: results on standard output, messages on standard error, colours for people only.

Works on Linux terminals, in Windows consoles and in pipes.

Whatever goes wrong in a command ends in one clear message and the right exit code.
"""

from __future__ import annotations

import errno
import io
import json
import os
import sys
import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TextIO, TypeVar

import typer

from plcopen_sfc.errors import SfcError, told_when_exhausted
from plcopen_sfc.files import refuse_unwritable, write_atomic

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table as RichTable

    from plcopen_sfc.analysis.search_limits import SearchProgress
    from plcopen_sfc.diagnostics import Diagnostic

UNREADABLE = 2
INTERRUPTED = 130  # 128 + SIGINT, as shells do
_PIPE_CLOSED = 141  # 128 + SIGPIPE


@contextmanager
def guarded(*, as_json: bool, quiet: bool, verbose: int, report: Path | None = None) -> Iterator[Screen]:
    """Run a command in this; ends in `typer.Exit` with `Screen.exit_code`, or with the code of what went wrong.

    A `report` that cannot be written is an error before the command begins.
    """
    debug = verbose > 1 or os.environ.get("PLCOPEN_SFC_DEBUG", "") not in {"", "0"}
    screen = Screen(as_json=as_json, quiet=quiet, verbose=verbose, report=report)
    try:
        if report is not None:
            refuse_unwritable(report)
        with told_when_exhausted():
            yield screen
        screen.flush()
    except SfcError as error:
        screen.exit_code = UNREADABLE
        screen.error(error)
        _trace(wanted=debug)
    except KeyboardInterrupt:
        screen.exit_code = INTERRUPTED
        screen.complain("interrupted")
    except BrokenPipeError:
        screen.exit_code = _PIPE_CLOSED
        silence_stdout()
    except OSError as error:
        screen.exit_code = UNREADABLE
        if error.errno == errno.EINVAL and os.name == "nt":  # how Windows reports a closed pipe
            screen.exit_code = _PIPE_CLOSED
        else:
            place = f"{os.fsdecode(error.filename)}: " if isinstance(error.filename, str | bytes) else ""
            screen.complain(f"{place}{error.strerror or error}")
            _trace(wanted=debug)
        _give_up_output(screen)
    except Exception as error:  # a mistake in this package, which the message admits
        screen.exit_code = UNREADABLE
        screen.complain(f"{type(error).__name__}: {error}")
        screen.advise("This is a bug in plcopen_sfc, please report it; --verbose shows the details.")
        _trace(wanted=debug or verbose > 0)
    raise typer.Exit(screen.exit_code)


def _give_up_output(screen: Screen) -> None:
    """Write what can still be written, so that nothing complains at exit about what cannot."""
    try:
        screen.flush()
    except OSError:
        silence_stdout()


def _trace(*, wanted: bool) -> None:
    if wanted:
        traceback.print_exc(file=sys.stderr)


@dataclass
class Table:
    """Headers and rows of texts and numbers; columns of numbers are aligned to the right.

    `short` are headers for narrow terminals. `total`: the last row is a sum.
    """

    headers: Sequence[str]
    short: Sequence[str] = ()
    rows: list[Sequence[str | int]] = field(default_factory=list)
    total: bool = False

    def plain(self) -> list[str]:
        """Return the lines of the table as text: columns two blanks apart, nothing cut off."""
        texts = [[str(cell) for cell in row] for row in (self.headers, *self.rows)]
        widths = [max(len(row[column]) for row in texts) for column in range(len(self.headers))]
        right = self._numbers()
        return [
            "  ".join(
                text.rjust(width) if number else text.ljust(width)
                for text, width, number in zip(row, widths, right, strict=True)
            ).rstrip()
            for row in texts
        ]

    def rich(self, width: int) -> RichTable:
        """Return the table for a terminal `width` characters wide, without the columns that hold nothing but zeros."""
        from rich import box  # noqa: PLC0415  # only where somebody looks
        from rich.table import Table as RichTable  # noqa: PLC0415
        from rich.text import Text  # noqa: PLC0415

        shown = [c for c in range(len(self.headers)) if not self.rows or any(row[c] != 0 for row in self.rows)]
        narrow = max(map(len, self.plain())) > width
        headers = self.short if narrow and self.short else self.headers
        numbers = self._numbers()
        table = RichTable(box=box.SIMPLE_HEAD, header_style="bold", pad_edge=False)
        for column in shown:
            side: Literal["right", "left"] = "right" if numbers[column] else "left"
            table.add_column(Text(headers[column]), justify=side, overflow="fold", no_wrap=numbers[column])
        for place, row in enumerate(self.rows, start=1):
            last = place == len(self.rows) and self.total
            if last:
                table.add_section()
            table.add_row(*(Text(str(row[column])) for column in shown), style="bold" if last else None)
        return table

    def _numbers(self) -> list[bool]:
        return [
            bool(self.rows) and all(isinstance(row[column], int) or row[column] == "-" for row in self.rows)
            for column in range(len(self.headers))
        ]


T = TypeVar("T")

Line = Sequence[tuple[str, str]]
"""Pieces of a line: text and style (as rich names styles; empty: none)."""

_MANY = 4
"""Things of which a bar shows how many are done."""
_STYLES = {"error": "bold red", "warning": "yellow", "info": "cyan"}


class Screen:
    """Standard output and error of one command, and the exit code it will end with."""

    def __init__(
        self, *, as_json: bool = False, quiet: bool = False, verbose: int = 0, report: Path | None = None
    ) -> None:
        self.as_json = as_json
        self.quiet = quiet
        self.verbose = verbose
        self.report = report
        self.exit_code = 0
        self.results_to_stderr = False

    # -- results ------------------------------------------------------------------------------------------------------

    def line(self, *pieces: str | tuple[str, str]) -> None:
        """Print one line of the result; parts with a style have it on a terminal."""
        self._write(self._results, [(p, "") if isinstance(p, str) else p for p in pieces])

    def lines(self, lines: Iterable[Line]) -> None:
        """Print lines of the result; on a terminal what is too wide is cut off."""
        for line in lines:
            self._write(self._results, line, cut=True)

    def table(self, table: Table) -> None:
        """Print a table."""
        console = self._console(self._results)
        if console is None:
            for line in table.plain():
                self._results.write(line + "\n")
        else:
            console.print(table.rich(console.width))

    def result(self, data: Any) -> None:
        """Take the whole result as data: print it as JSON where that is wanted, and write the report."""
        if self.report is not None:
            write_atomic(self.report, (json.dumps(data, ensure_ascii=False, indent=2) + "\n").encode())
        if self.as_json:
            self.json(data)

    def json(self, value: Any) -> None:
        """Print a value as JSON."""
        text = json.dumps(value, ensure_ascii=not is_unicode(sys.stdout), indent=2)
        sys.stdout.write(text + "\n")

    def finding(self, diagnostic: Diagnostic, *, result: bool) -> None:
        """Print a finding: as a result, or as a message."""
        if not result and self.quiet and diagnostic.severity != "error":
            return
        stream = self._results if result else sys.stderr
        place, severity = str(diagnostic.location), diagnostic.severity.value
        pieces = [(f"{place}: ", "bold")] if place else []
        pieces += [(severity, _STYLES.get(severity, "")), (f" {diagnostic.code}: {diagnostic.message}", "")]
        self._write(stream, pieces)

    def print(self, line: Line, *, message: bool, cut: bool) -> None:
        """Print a line of the result, or of a message."""
        self._write(sys.stderr if message else self._results, line, cut=cut)

    # -- messages -----------------------------------------------------------------------------------------------------

    def note(self, text: str) -> None:
        """Print a message that --quiet suppresses."""
        if not self.quiet:
            self._write(sys.stderr, [(text, "")])

    def detail(self, text: str) -> None:
        """Print a message that only --verbose brings."""
        if self.verbose:
            self._write(sys.stderr, [(text, "dim")])

    def complain(self, text: str) -> None:
        """Print an error message."""
        self._write(sys.stderr, [("error: ", "bold red"), (text, "")])

    def advise(self, text: str) -> None:
        """Print what to do about the error above."""
        self._write(sys.stderr, [(f"  {text}", "dim")])

    def error(self, error: SfcError) -> None:
        """Print an error of the library: place, message, hint."""
        place = str(error.location)
        self.complain(f"{place}: {error.message}" if place else error.message)
        if error.hint:
            self.advise(error.hint)

    def progress(self, items: Iterable[T], doing: str, total: int) -> Iterator[T]:
        """Go through `total` things as they come, with a bar that shows how fast they do and how long it will take.

        What is printed of a thing is written out before the next one, which may take minutes: in pipes and logs too.
        """
        items = self._flushed(items)
        if self.quiet or total < _MANY or not is_terminal(sys.stderr):
            yield from items
            return
        from rich.progress import (  # noqa: PLC0415  # only where somebody looks
            BarColumn,
            MofNCompleteColumn,
            Progress,
            ProgressColumn,
            Task,
            TextColumn,
            TimeRemainingColumn,
        )
        from rich.text import Text  # noqa: PLC0415

        class Speed(ProgressColumn):
            def render(self, task: Task) -> Text:
                return Text(f"{task.speed:.1f}/s" if task.speed else "")

        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            Speed(),
            TimeRemainingColumn(),
        )
        with Progress(*columns, console=self._console(sys.stderr), transient=True) as bar:
            yield from bar.track(items, total=total, description=doing)

    def _flushed(self, items: Iterable[T]) -> Iterator[T]:
        for item in items:
            yield item
            self.flush()

    @contextmanager
    def searching(self) -> Iterator[Callable[[SearchProgress], None] | None]:
        """Yield a bar that shows how far comparisons are, on a terminal; else None."""
        if self.quiet or not is_terminal(sys.stderr):
            yield None
            return
        from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn  # noqa: PLC0415

        columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(bar_width=20), TimeElapsedColumn())
        with Progress(*columns, console=self._console(sys.stderr), transient=True) as bar:
            task = bar.add_task("Comparing", total=None)

            def report(progress: SearchProgress) -> None:
                bar.update(task, description=str(progress), completed=progress.seconds, total=progress.limit)

            yield report

    def flush(self) -> None:
        """Write out what is still buffered, so that a full disk or a closed pipe is noticed here."""
        sys.stdout.flush()
        sys.stderr.flush()

    # -- how ----------------------------------------------------------------------------------------------------------

    @property
    def _results(self) -> TextIO:
        return sys.stderr if self.results_to_stderr else sys.stdout

    @property
    def unicode(self) -> bool:
        """True if a person looks at results and every sign can be shown."""
        return is_terminal(self._results) and is_unicode(self._results)

    @cached_property
    def _consoles(self) -> dict[int, Console]:
        return {}

    def _console(self, stream: TextIO) -> Console | None:
        """Rich's console for a terminal; None for a pipe."""
        if not is_terminal(stream):
            return None
        if stream.fileno() not in self._consoles:
            from rich.console import Console  # noqa: PLC0415  # only where somebody looks

            self._consoles[stream.fileno()] = Console(file=stream, highlight=False, emoji=False)
        return self._consoles[stream.fileno()]

    def _write(self, stream: TextIO, line: Line, *, cut: bool = False) -> None:
        console = self._console(stream)
        if console is None:
            stream.write("".join(text for text, _ in line).rstrip() + "\n")
            return
        from rich.text import Text  # noqa: PLC0415

        text = Text.assemble(*((text, style) for text, style in line), overflow="ellipsis" if cut else "fold")
        console.print(text, no_wrap=cut, soft_wrap=not cut)


def prepare_streams() -> None:
    """Prevent encoding errors of output; use UTF-8 in pipes, unless PYTHONIOENCODING is set."""
    for stream in (sys.stdout, sys.stderr):
        if not isinstance(stream, io.TextIOWrapper):
            continue
        if is_terminal(stream) or os.environ.get("PYTHONIOENCODING"):
            stream.reconfigure(errors="replace")
        else:
            stream.reconfigure(encoding="utf-8", errors="replace")


def is_terminal(stream: TextIO) -> bool:
    """Return True if a person looks at `stream`."""
    try:
        return stream.isatty()
    except (AttributeError, ValueError):  # closed, or none at all (pythonw.exe)
        return False


def is_unicode(stream: TextIO) -> bool:
    """Return True if `stream` can show every character."""
    return (getattr(stream, "encoding", None) or "").lower().replace("-", "") in {"utf8", "utf16le", "utf16", "cp65001"}


def silence_stdout() -> None:
    """The reader of standard output is gone: let nothing complain at exit that it cannot be flushed."""
    try:
        number = sys.stdout.fileno()
    except (OSError, ValueError):
        return
    os.dup2(os.open(os.devnull, os.O_WRONLY), number)
