"""The files that a command was given: patterns are expanded where the shell did not (Windows)."""

from __future__ import annotations

import glob
from collections.abc import Iterable
from pathlib import Path

from plcopen_sfc.errors import FileAccessError, Location

__all__ = ["expand"]


def expand(names: Iterable[str]) -> list[str]:
    """The files that `names` mean, each once. Raises `FileAccessError` where a pattern matches nothing."""
    found: list[str] = []
    for name in names:
        if not glob.has_magic(name) or Path(name).exists():
            found.append(name)
            continue
        matching = sorted(match for match in glob.glob(name) if not Path(match).is_dir())  # noqa: PTH207  # any path
        if not matching:
            hint = "Check the pattern and the working folder."
            raise FileAccessError("no file matches this pattern", location=Location(name), hint=hint)
        found += matching
    return list(dict.fromkeys(found))
