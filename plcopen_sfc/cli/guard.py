"""The frame around every command: whatever goes wrong ends in one clear message and the right exit code."""

from __future__ import annotations

import errno
import os
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from plcopen_sfc.cli.screen import Screen, silence_stdout
from plcopen_sfc.errors import SfcError
from plcopen_sfc.files import refuse_unwritable

__all__ = ["INTERRUPTED", "UNREADABLE", "describe_exhaustion", "guarded"]

UNREADABLE = 2
INTERRUPTED = 130  # 128 + SIGINT, as shells say it
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
        yield screen
        screen.flush()
    except SfcError as error:
        screen.exit_code = UNREADABLE
        screen.error(error)
        _trace(wanted=debug)
    except KeyboardInterrupt:
        screen.exit_code = INTERRUPTED
        screen.complain("interrupted")
    except (MemoryError, RecursionError) as error:
        screen.exit_code = UNREADABLE
        screen.complain(describe_exhaustion(error))
        _trace(wanted=debug)
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


def describe_exhaustion(error: MemoryError | RecursionError) -> str:
    """Return the message for a file that takes too much memory or nesting."""
    if isinstance(error, MemoryError):
        return "not enough memory for this file"
    return "the content of this file is nested too deeply"


def _give_up_output(screen: Screen) -> None:
    """Write what can still be written, so that nothing complains at exit about what cannot."""
    try:
        screen.flush()
    except OSError:
        silence_stdout()


def _trace(*, wanted: bool) -> None:
    if wanted:
        traceback.print_exc(file=sys.stderr)
