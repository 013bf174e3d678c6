"""Names of files and folders for objects, legal on Windows, Linux and macOS."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

from plcopen_sfc.errors import ModelError

__all__ = ["FileNames", "file_stem", "legal_folder"]

_ILLEGAL = re.compile(r'[<>:"/\\|?*\x00-\x1f\x7f]')
_DEVICES = frozenset({"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))})
"""File names that Windows keeps for devices, whatever their extension."""
_LONGEST = 120
_MOST_BYTES = 200
"""File systems allow 255 bytes; the name gets an extension, and a number where it is taken."""


def file_stem(name: str) -> str:
    """`name` as the name of a file without extension: what no file system takes is replaced by ``_``."""
    stem = _ILLEGAL.sub("_", unicodedata.normalize("NFC", name))[:_LONGEST]
    stem = stem.encode("utf-8", "replace")[:_MOST_BYTES].decode("utf-8", "ignore").strip().rstrip(".")
    if not stem or stem.partition(".")[0].casefold() in _DEVICES:
        stem = f"_{stem}"
    # hidden files are not read as part of a project
    return f"_{stem[1:]}" if stem.startswith(".") else stem


def legal_folder(folder: str) -> str:
    """`folder` with names that every file system takes. Raises `ModelError` where it leads out of the project."""
    parts = folder.replace("\\", "/").split("/")
    if folder.startswith(("/", "\\")) or ".." in parts or re.match(r"[A-Za-z]:", folder):
        raise ModelError(
            f"the folder {folder!r} leads out of the project",
            hint="Folders of objects are relative to the folder of the project.",
        )
    return "/".join(file_stem(part) for part in parts if part not in ("", "."))


class FileNames:
    """The files that a folder has; where upper and lower case or the form of umlauts differ only, they are the same."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = {self._same(path) for path in taken}

    @staticmethod
    def _same(path: str) -> str:
        return unicodedata.normalize("NFC", path).casefold()

    def take(self, path: str) -> None:
        """The folder has a file at `path`."""
        self._taken.add(self._same(path))

    def free(self, folder: str, name: str, extension: str) -> str:
        """A path in `folder` for an object called `name` that no other file has; it is taken from now on."""
        start = f"{folder}/" if folder else ""
        stem = file_stem(name)
        path, number = f"{start}{stem}{extension}", 1
        while self._same(path) in self._taken:
            number += 1
            path = f"{start}{stem}_{number}{extension}"
        self._taken.add(self._same(path))
        return path
