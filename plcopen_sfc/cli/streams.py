"""Standard output and error as they are on Linux terminals, in Windows consoles and in pipes."""

from __future__ import annotations

import io
import os
import sys
from typing import TextIO

__all__ = ["is_terminal", "is_unicode", "prepare_streams", "silence_stdout"]


def prepare_streams() -> None:
    """Never an encoding error; UTF-8 in pipes, unless PYTHONIOENCODING says otherwise."""
    for stream in (sys.stdout, sys.stderr):
        if not isinstance(stream, io.TextIOWrapper):
            continue
        if is_terminal(stream) or os.environ.get("PYTHONIOENCODING"):
            stream.reconfigure(errors="replace")
        else:
            stream.reconfigure(encoding="utf-8", errors="replace")


def is_terminal(stream: TextIO) -> bool:
    """Whether a person looks at `stream`."""
    try:
        return stream.isatty()
    except (AttributeError, ValueError):  # closed, or none at all (pythonw.exe)
        return False


def is_unicode(stream: TextIO) -> bool:
    """Whether `stream` can show every character."""
    return (getattr(stream, "encoding", None) or "").lower().replace("-", "") in {"utf8", "utf16le", "utf16", "cp65001"}


def silence_stdout() -> None:
    """The reader of standard output is gone: let nothing complain at exit that it cannot be flushed."""
    try:
        number = sys.stdout.fileno()
    except (OSError, ValueError):
        return
    os.dup2(os.open(os.devnull, os.O_WRONLY), number)
