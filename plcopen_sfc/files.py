"""Reading and writing whole files: a clear error when it fails, and never half a file.

`write_atomic` writes a temporary file next to the target and renames it over the target when every byte is on the
disk. Whoever is interrupted in between (power, a full disk, Ctrl-C, a killed process) still has the old file whole.
"""

from __future__ import annotations

import errno
import os
import secrets
import stat
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from plcopen_sfc.errors import FileAccessError, Location

_READ_REASONS = {
    errno.ENOENT: ("the file does not exist", "Check the path and the working folder."),
    errno.ENOTDIR: ("the file does not exist: a part of its path is not a folder", "Check the path."),
    errno.EISDIR: ("this is a folder, not a file", "Name a file inside it."),
    errno.EACCES: ("no right to read the file", "Check the file's permissions and whether another program locks it."),
    errno.EPERM: ("no right to read the file", "Check the file's permissions and whether another program locks it."),
    errno.ENXIO: ("this is a device, not a file", "Name a file; - is the standard input."),
    errno.ESPIPE: ("this is a pipe, not a file", "Name a file; - is the standard input."),
    errno.ENAMETOOLONG: ("the path is too long for this system", "Use a shorter path."),
    errno.ELOOP: ("the path is a symbolic link that leads back to itself", "Repair the link."),
}
_WRITE_REASONS = _READ_REASONS | {
    errno.ENOENT: ("the folder to write into does not exist", "Create it first, or check the path."),
    errno.EISDIR: ("the target is a folder, not a file", "Name a file inside it."),
    errno.EACCES: ("no right to write here", "Check the permissions of file and folder, and who has the file open."),
    errno.EPERM: ("no right to write here", "Check the permissions of file and folder, and who has the file open."),
    errno.EROFS: ("the file system is read-only", "Write to another place."),
    errno.ENOSPC: ("the disk is full", "Free some space; the old file is untouched."),
    errno.EDQUOT: ("the disk quota is used up", "Free some space; the old file is untouched."),
    errno.EFBIG: ("the file would become larger than the system allows", "The old file is untouched."),
}


_OPEN_FILES = ("/dev/", "/proc/")
"""Folders of files that the process has open, such as the ``<(command)`` of a shell: there somebody writes."""


def folder_exists(path: str | os.PathLike[str]) -> bool:
    """True if there is a folder at `path`; False for a path that no system can have, as if nothing were there."""
    return os.path.isdir(path)  # noqa: PTH112  # Path.is_dir raises OSError where a name is too long


def file_exists(path: str | os.PathLike[str]) -> bool:
    """Tell the same of a file."""
    return os.path.isfile(path)  # noqa: PTH113


def path_exists(path: str | os.PathLike[str]) -> bool:
    """Tell the same of anything."""
    return os.path.exists(path)  # noqa: PTH110


def refuse_empty(path: str | os.PathLike[str]) -> None:
    """Raise `FileAccessError` for an empty path: the system would take it for the current folder."""
    if not os.fspath(path):
        hint = "Write . for the current folder. A variable of a script may be empty."
        raise FileAccessError("the path is empty", location=Location('""'), hint=hint)


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Return all bytes of the file at `path`.

    Raises `FileAccessError` where the file is missing, a folder, not readable, or disappears meanwhile.
    """
    refuse_empty(path)
    try:
        if Path(path).is_dir():  # Windows reports "no rights" for a folder
            raise IsADirectoryError(errno.EISDIR, "is a directory")
        if Path(path).is_char_device() or Path(path).is_block_device():  # /dev/zero has no end
            raise OSError(errno.ENXIO, "is a device")
        if Path(path).is_fifo() and not os.fspath(path).startswith(_OPEN_FILES):  # waits for a program that writes
            raise OSError(errno.ESPIPE, "is a pipe")
        return Path(path).read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a path with a NUL character
        raise _failure(path, error, _READ_REASONS, "cannot be read") from error


def access_failure(path: str | os.PathLike[str], error: OSError) -> FileAccessError:
    """Return the message for a `path` that cannot be read because of `error`."""
    return _failure(path, error, _READ_REASONS, "cannot be read")


def refuse_unwritable(path: str | os.PathLike[str]) -> None:
    """Raise `FileAccessError` where `write_atomic` would find no place for a file at `path`. Writes nothing."""
    refuse_empty(path)
    try:
        target = Path(os.path.realpath(path))
        if target.is_dir():
            raise IsADirectoryError(errno.EISDIR, "is a directory")
        if not target.parent.is_dir():
            raise FileNotFoundError(errno.ENOENT, "no such folder")
        _mode_of(target)
        if not os.access(target.parent, os.W_OK):
            raise PermissionError(errno.EACCES, "not writable")
    except (OSError, ValueError) as error:
        raise _failure(path, error, _WRITE_REASONS, "cannot be written") from error


def resolved(path: str | os.PathLike[str]) -> Path:
    """Return the path to write to without links. Raises `FileAccessError` for one that no file can have."""
    try:
        return Path(os.path.realpath(path))
    except (OSError, ValueError) as error:
        raise _failure(path, error, _WRITE_REASONS, "cannot be written") from error


def write_atomic(path: str | os.PathLike[str], data: bytes) -> None:
    """Replace the file at `path` by `data`, or leave it exactly as it is.

    Symbolic links are followed, so the link stays a link; the permissions of an existing file are kept. Raises
    `FileAccessError`; on any other interruption (`KeyboardInterrupt` too) the temporary file is removed. A killed
    process leaves it behind (`.name.*.tmp`), never a damaged target. The new file is a new one to the file system: it
    belongs to whoever writes it, and hard links keep the old content.
    """
    refuse_empty(path)
    try:
        target = Path(os.path.realpath(path))
        if target.is_dir():
            raise IsADirectoryError(errno.EISDIR, "is a directory")
        if Path(path).exists() and not Path(path).is_file():
            Path(path).write_bytes(data)  # a device or a pipe: there is no old file to protect, and none to put there
        else:
            _replace(target, data)
    except (OSError, ValueError) as error:
        raise _failure(path, error, _WRITE_REASONS, "cannot be written") from error


def write_all(files: Mapping[Path, bytes]) -> None:
    """Replace all of `files`, or leave them exactly as they are; folders are made where they are missing.

    All temporary files are on the disk before the first is renamed: only what fails between two renames (a file that
    another program has just opened, a loss of power) leaves some files new and some old, each of them whole.
    Raises `FileAccessError`.
    """
    staged: list[tuple[Path, Path]] = []
    path = Path()
    try:
        for path, data in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            target = Path(os.path.realpath(path))
            if target.exists() and not target.is_file():
                raise IsADirectoryError(errno.EISDIR, "is no file")
            staged.append((_stage(target, data), target))
        for temporary, path in staged:
            temporary.replace(path)
        for folder in {target.parent for _, target in staged}:
            _sync_folder(folder)
    except (OSError, ValueError) as error:
        raise _failure(path, error, _WRITE_REASONS, "cannot be written") from error
    finally:
        for temporary, _ in staged:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)


def _replace(target: Path, data: bytes) -> None:
    temporary = _stage(target, data)
    try:
        temporary.replace(target)
    except BaseException:
        with suppress(OSError):
            temporary.unlink()
        raise
    _sync_folder(target.parent)


def _stage(target: Path, data: bytes) -> Path:
    """Write `data` to a temporary file beside `target`, with its permissions; return the path of that file."""
    mode = _mode_of(target)
    # The name is cut: the target's own name may already be as long as the file system allows.
    temporary = target.parent / f".{target.name[:40]}.{secrets.token_hex(6)}.tmp"
    handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
    try:
        try:
            _write_all(handle, data)
            if mode is not None and hasattr(os, "fchmod"):
                os.fchmod(handle, mode)
            os.fsync(handle)
        finally:
            os.close(handle)
    except BaseException:
        with suppress(OSError):
            temporary.unlink()
        raise
    return temporary


def _mode_of(target: Path) -> int | None:
    """Return the permissions of the old file; None if there is none.

    A file that may not be written is refused: the rename would overwrite it all the same.
    """
    try:
        mode = stat.S_IMODE(target.stat().st_mode)
    except FileNotFoundError:
        return None
    if not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, "not writable")
    return mode


def _write_all(handle: int, data: bytes) -> None:
    view = memoryview(data)
    while view:
        view = view[os.write(handle, view) :]


def _sync_folder(folder: Path) -> None:
    """Put the rename itself on the disk, where the system can do that (not on Windows)."""
    if os.name == "nt":
        return
    with suppress(OSError):  # the data is safe already; some network file systems refuse this
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _failure(
    path: str | os.PathLike[str], error: OSError | ValueError, reasons: dict[int, tuple[str, str]], verb: str
) -> FileAccessError:
    number = error.errno if isinstance(error, OSError) else None
    detail = (error.strerror or str(error)) if isinstance(error, OSError) else str(error)
    message, hint = reasons.get(number or 0, (f"the file {verb}: {detail}", ""))
    failure = FileAccessError(message, location=Location(file=os.fspath(path)), hint=hint)
    failure.errno = number
    return failure
