"""Reading and writing whole files: clear errors, and the old file or the new one, never a half."""

from __future__ import annotations

import errno
import os
import signal
import stat
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import NoReturn

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import FileAccessError
from plcopen_sfc.files import read_bytes, write_all, write_atomic

_ROOT = hasattr(os, "geteuid") and os.geteuid() == 0
posix_only = pytest.mark.skipif(os.name == "nt", reason="needs POSIX permissions, links and signals")


def _names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_reads_what_was_written(tmp_path: Path) -> None:
    path = tmp_path / "Förderer.xml"
    write_atomic(path, b"\x00\r\n\xff")
    assert read_bytes(path) == b"\x00\r\n\xff"
    write_atomic(str(path), b"")
    assert read_bytes(str(path)) == b""
    assert _names(tmp_path) == ["Förderer.xml"]


@posix_only
def test_a_device_is_no_file() -> None:
    with pytest.raises(FileAccessError, match="is a device"):
        read_bytes("/dev/zero")


@posix_only
def test_a_pipe_is_no_file_but_for_one_that_the_process_has_open(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.xml"
    os.mkfifo(pipe)
    with pytest.raises(FileAccessError, match="this is a pipe, not a file"):
        read_bytes(pipe)  # it would wait for a program that writes
    reading, writing = os.pipe()
    os.write(writing, b"<a/>")
    os.close(writing)
    assert read_bytes(f"/dev/fd/{reading}") == b"<a/>"
    os.close(reading)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("missing.xml", "does not exist"),
        ("folder", "folder, not a file"),
        ("file.xml/inside", "not a folder"),
        ("nul\0.xml", "null"),
    ],
)
def test_reading_says_what_is_wrong(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file.xml").write_bytes(b"")
    with pytest.raises(FileAccessError, match=message) as caught:
        read_bytes(tmp_path / name)
    assert caught.value.location.file == str(tmp_path / name)


@posix_only
@pytest.mark.skipif(_ROOT, reason="root may read everything")
def test_reading_without_rights(tmp_path: Path) -> None:
    path = tmp_path / "secret.xml"
    path.write_bytes(b"x")
    path.chmod(0)
    with pytest.raises(FileAccessError, match="no right to read"):
        read_bytes(path)


def test_no_rights_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_self: Path) -> NoReturn:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "read_bytes", refuse)
    with pytest.raises(FileAccessError, match="no right to read") as caught:
        read_bytes(tmp_path / "a.xml")
    assert caught.value.errno == errno.EACCES


def test_a_file_that_vanishes_meanwhile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def vanish(_self: Path) -> NoReturn:
        raise FileNotFoundError(errno.ENOENT, "No such file")

    path = tmp_path / "a.xml"
    path.write_bytes(b"x")
    monkeypatch.setattr(Path, "read_bytes", vanish)
    with pytest.raises(FileAccessError, match="does not exist"):
        read_bytes(path)


def test_an_empty_path_is_not_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for action in (lambda: read_bytes(""), lambda: write_atomic("", b"x"), lambda: sfc.load("")):
        with pytest.raises(FileAccessError, match="the path is empty") as caught:
            action()
        assert "current folder" in (caught.value.hint or "")
    with pytest.raises(FileAccessError, match="the path is empty"):
        sfc.save(sfc.model.Project(), "", format="simaticml")
    assert _names(tmp_path) == []


def test_writing_into_a_missing_folder(tmp_path: Path) -> None:
    with pytest.raises(FileAccessError, match="folder to write into does not exist"):
        write_atomic(tmp_path / "no" / "a.xml", b"x")


def test_writing_onto_a_folder(tmp_path: Path) -> None:
    with pytest.raises(FileAccessError, match="folder, not a file"):
        write_atomic(tmp_path, b"x")
    assert _names(tmp_path) == []


@posix_only
def test_the_mode_of_the_old_file_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_bytes(b"old")
    path.chmod(0o640)
    write_atomic(path, b"new")
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


@posix_only
def test_a_new_file_has_the_usual_mode(tmp_path: Path) -> None:
    (tmp_path / "usual").write_bytes(b"")
    write_atomic(tmp_path / "new", b"")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_a_read_only_file_is_not_overwritten(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.xml"
    path.write_bytes(b"old")
    monkeypatch.setattr(os, "access", lambda *_arguments: False)
    with pytest.raises(FileAccessError, match="no right to write"):
        write_atomic(path, b"new")
    assert path.read_bytes() == b"old"


@posix_only
def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    target, link = tmp_path / "real" / "a.xml", tmp_path / "link.xml"
    target.write_bytes(b"old")
    link.symlink_to(target)
    write_atomic(link, b"new")
    assert link.is_symlink()
    assert target.read_bytes() == b"new"
    assert _names(tmp_path / "real") == ["a.xml"]


@posix_only
def test_a_link_to_nothing_creates_its_target(tmp_path: Path) -> None:
    link = tmp_path / "link.xml"
    link.symlink_to(tmp_path / "later.xml")
    write_atomic(link, b"new")
    assert (tmp_path / "later.xml").read_bytes() == b"new"


@posix_only
def test_a_device_is_written_to_and_not_replaced() -> None:
    write_atomic("/dev/null", b"x")
    assert Path("/dev/null").is_char_device()


@posix_only
def test_the_longest_possible_name(tmp_path: Path) -> None:
    path = tmp_path / ("x" * 255)
    write_atomic(path, b"new")
    assert read_bytes(path) == b"new"
    with pytest.raises(FileAccessError, match="too long"):
        write_atomic(tmp_path / ("x" * 256), b"new")


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EIO])
def test_a_full_or_broken_disk_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    path = tmp_path / "a.xml"
    path.write_bytes(b"old")
    really_write = os.write

    def some_then_fail(handle: int, data: memoryview) -> int:
        if len(data) <= 50:
            raise OSError(number, os.strerror(number))
        return really_write(handle, data[:50])

    monkeypatch.setattr(os, "write", some_then_fail)
    with pytest.raises(FileAccessError, match="disk is full" if number == errno.ENOSPC else "cannot be written"):
        write_atomic(path, b"x" * 100)
    assert path.read_bytes() == b"old"
    assert _names(tmp_path) == ["a.xml"]


@pytest.mark.parametrize("where", ["write", "fsync"])
def test_an_interruption_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str) -> None:
    path = tmp_path / "a.xml"
    path.write_bytes(b"old")

    def interrupt(*_arguments: object) -> NoReturn:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, where, interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_atomic(path, b"new")
    assert path.read_bytes() == b"old"
    assert _names(tmp_path) == ["a.xml"]


def test_short_writes_are_continued(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    really_write = os.write
    monkeypatch.setattr(os, "write", lambda handle, data: really_write(handle, data[:7]))
    data = bytes(range(256)) * 3
    write_atomic(tmp_path / "a.xml", data)
    assert read_bytes(tmp_path / "a.xml") == data


def _python(code: str, *arguments: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


@posix_only
def test_a_real_size_limit_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_bytes(b"old")
    process = _python(
        """
        import resource, signal, sys
        from plcopen_sfc.errors import FileAccessError
        from plcopen_sfc.files import write_atomic
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, 10_000))
        try:
            write_atomic(sys.argv[1], b"x" * 1_000_000)
        except FileAccessError as error:
            print(error)
        """,
        str(path),
    )
    out, err = process.communicate(timeout=60)
    assert b"larger than the system allows" in out, err
    assert path.read_bytes() == b"old"
    assert _names(tmp_path) == ["a.xml"]


@posix_only
def test_a_killed_process_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_bytes(b"old")
    process = _python(
        """
        import os, sys, time
        from plcopen_sfc.files import write_atomic
        really_write = os.write
        def slow(handle, data):
            written = really_write(handle, data[:1000])
            print("wrote", flush=True)
            time.sleep(60)
            return written
        os.write = slow
        write_atomic(sys.argv[1], b"x" * 1_000_000)
        """,
        str(path),
    )
    assert process.stdout is not None
    assert process.stdout.readline() == b"wrote\n"
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=60)
    assert path.read_bytes() == b"old"


def test_many_files_are_replaced_together_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = {tmp_path / "a.xml": b"old a", tmp_path / "sub" / "b.xml": b"old b", tmp_path / "c.xml": b"old c"}
    write_all(old)
    written = 0

    def write(handle: int, data: memoryview) -> int:
        nonlocal written
        written += 1
        if written == 3:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real_write(handle, data)

    real_write = os.write
    monkeypatch.setattr(os, "write", write)
    with pytest.raises(FileAccessError, match="disk is full") as caught:
        write_all(dict.fromkeys(old, b"new"))
    assert caught.value.location.file == str(tmp_path / "c.xml")
    assert {path: path.read_bytes() for path in old} == old
    assert _names(tmp_path) == ["a.xml", "c.xml", "sub"]
    monkeypatch.undo()
    write_all(dict.fromkeys(old, b"new"))
    assert {path.read_bytes() for path in old} == {b"new"}


def test_a_folder_in_place_of_a_file_stops_all(tmp_path: Path) -> None:
    (tmp_path / "b.xml").mkdir()
    with pytest.raises(FileAccessError, match="folder, not a file"):
        write_all({tmp_path / "a.xml": b"a", tmp_path / "b.xml": b"b"})
    assert _names(tmp_path) == ["b.xml"]
