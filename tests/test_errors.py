"""Everything a user can do wrong ends in one clear error: through the library, and through every command."""

from __future__ import annotations

import errno
import os
import pickle
import shutil
import signal
import socket
import stat
import subprocess
import sys
import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import errors
from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.analysis.verdict import Verdict
from plcopen_sfc.cli import main
from plcopen_sfc.model import SfcNetwork
from tests.sweeps import WHOLE, some_of

ROOT = Path(__file__).resolve().parents[1]
FIXTURES = ROOT / "fixtures"
BELT = FIXTURES / "codesys" / "sorting_conveyor.xml"
TC6 = "http://www.plcopen.org/xml/tc6_0201"
COMMANDS = (["info"], ["validate"], ["convert", "--to", "json"])
POSIX = pytest.mark.skipif(os.name == "nt", reason="needs a POSIX system")

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Run a command: exit code, standard output, standard error."""

    def run_it(*arguments: object) -> tuple[int, str, str]:
        capsys.readouterr()
        code = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run_it


def python(script: str, *arguments: object, timeout: float = 60) -> subprocess.CompletedProcess[str]:
    """Run a script in a process of its own."""
    return subprocess.run(
        [sys.executable, "-c", script, *map(str, arguments)],
        capture_output=True,
        encoding="utf-8",
        check=False,
        timeout=timeout,
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"},
    )


# -- files that cannot be read ----------------------------------------------------------------------------------------

UNREADABLE = [
    ("not_xml.txt", errors.XmlSyntaxError, (1, 1), "plain text, not XML: it begins with 'Stirring tank'"),
    ("truncated.xml", errors.XmlSyntaxError, (168, 8), "the file ends in the middle of element <actionBlock>"),
    ("wrong_root.xml", errors.StructureError, (2, None), "the root element is <plant>"),
    ("unknown_version.xml", errors.UnknownVersionError, (2, None), "http://www.plcopen.org/xml/tc6_0305"),
    ("lying_encoding.xml", errors.EncodingError, (4, 25), 'declares encoding="utf-8", but at byte offset 278 (fc)'),
    ("empty.xml", errors.XmlSyntaxError, (1, 1), "the file is empty"),
    ("entity_bomb.xml", errors.UnsafeXmlError, (2, None), "declares entities"),
    ("external_entity.xml", errors.UnsafeXmlError, (2, None), "declares entities"),
]


def check(run: Run, path: Path, kind: type[sfc.SfcError], place: tuple[int | None, int | None], words: str) -> None:
    """The same error from `load`, and from each command with exit code 2."""
    with pytest.raises(kind) as caught:
        _ = sfc.load(path).diagnostics
    error = caught.value
    assert type(error) is kind
    assert words in error.message
    assert (error.location.file, error.location.line, error.location.column) == (str(path), *place)
    assert error.hint
    position = ":".join(str(number) for number in place if number is not None)
    for command in COMMANDS:
        code, out, err = run(*command, path)
        assert code == 2, command
        assert out == ""
        assert err.startswith(f"error: {path}:{position}" if position else f"error: {path}: ")
        assert words in err
        assert error.hint in err
        assert "Traceback" not in err


@pytest.mark.parametrize("case", UNREADABLE, ids=[each[0] for each in UNREADABLE])
def test_unreadable(run, case, tmp_path):
    name, kind, place, words = case
    shutil.copy(FIXTURES / "broken" / name, tmp_path / name)
    before = (tmp_path / name).read_bytes()
    check(run, tmp_path / name, kind, place, words)
    assert [path.name for path in tmp_path.iterdir()] == [name]  # nothing was written
    assert (tmp_path / name).read_bytes() == before


def test_missing(run, tmp_path):
    check(run, tmp_path / "missing.xml", errors.FileAccessError, (None, None), "the file does not exist")


def test_a_folder(run, tmp_path):
    check(run, tmp_path, errors.UnknownFormatError, (None, None), "the folder has no document")


def test_a_zip(run, tmp_path):
    path = tmp_path / "project.xml"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("project.xml", BELT.read_bytes())
    check(run, path, errors.XmlSyntaxError, (1, 1), "ZIP")


def test_foreign_json(run, tmp_path):
    path = tmp_path / "package.json"
    path.write_text('{"name": "other"}', encoding="utf-8")
    check(run, path, errors.UnknownFormatError, (None, None), "JSON, but not a model")


def test_deep_nesting(run, tmp_path):
    path = tmp_path / "deep.xml"
    path.write_text(f'<project xmlns="{TC6}">\n' + "<a>" * 5000 + "</a>" * 5000 + "</project>", encoding="utf-8")
    check(run, path, errors.UnsafeXmlError, (2, None), "nested deeper than 256 levels")


def test_deep_nesting_in_json(run, tmp_path):
    path = tmp_path / "deep.json"
    path.write_text('{"format": "plcopen_sfc", "x": ' + "[" * 200_000, encoding="utf-8")
    with pytest.raises(errors.FormatError) as caught:
        sfc.load(path)
    assert caught.value.location.file == str(path)
    assert run("info", path)[0] == 2


def test_a_file_that_vanishes_between_listing_and_reading(run, tmp_path, monkeypatch):
    """It stood in the folder when it was looked for, and is gone when it is opened."""
    read = Path.read_bytes

    def vanish(path: Path) -> bytes:
        path.unlink(missing_ok=True)
        return read(path)

    for name in ("a.xml", "b.xml"):
        shutil.copy(BELT, tmp_path / name)
    monkeypatch.setattr(Path, "read_bytes", vanish)
    code, _, err = run("info", tmp_path / "*.xml")
    assert code == 2
    assert err.count("the file does not exist") == 2
    assert f"{tmp_path / 'b.xml'}: " in err
    shutil.copy(BELT, tmp_path / "c.xml")
    with pytest.raises(errors.FileAccessError, match="the file does not exist") as caught:
        sfc.load(tmp_path / "c.xml")
    assert caught.value.location.file == str(tmp_path / "c.xml")


# -- nothing but the file itself is opened ----------------------------------------------------------------------------

CANARY = "CANARY-5f1c"
DOCUMENT = '<project xmlns="{tc6}" xmlns:xi="http://www.w3.org/2001/XInclude"><fileHeader companyName="c" productName="p" productVersion="1" creationDateTime="2024-01-01T00:00:00">{inside}</fileHeader>{rest}</project>'  # noqa: E501
REST = '<contentHeader name="n"><coordinateInfo><fbd><scaling x="1" y="1"/></fbd><ld><scaling x="1" y="1"/></ld><sfc><scaling x="1" y="1"/></sfc></coordinateInfo></contentHeader><types><dataTypes/><pous/></types><instances><configurations/></instances>'  # noqa: E501
HOSTILE = {
    "entity": ('<!DOCTYPE project [<!ENTITY x SYSTEM "{url}">]>', "&x;"),
    "entity in an attribute": ('<!DOCTYPE project [<!ENTITY x SYSTEM "{url}">]>', "<a b='&x;'/>"),
    "public entity": ('<!DOCTYPE project [<!ENTITY x PUBLIC "-//x//y" "{url}">]>', "&x;"),
    "parameter entity": ('<!DOCTYPE project [<!ENTITY % x SYSTEM "{url}"> %x;]>', ""),
    "unparsed entity": ('<!DOCTYPE project [<!NOTATION n SYSTEM "n"><!ENTITY x SYSTEM "{url}" NDATA n>]>', ""),
    "external subset": ('<!DOCTYPE project SYSTEM "{url}">', ""),
    "public subset": ('<!DOCTYPE project PUBLIC "-//x//y" "{url}">', ""),
}
HARMLESS = {
    "XInclude": ("", '<xi:include href="{url}" parse="text"/>'),
    "style sheet": ('<?xml-stylesheet type="text/xsl" href="{url}"?>', ""),
    "schema location": (
        "",
        '<a xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="{url} {url}"/>',
    ),
}


def hostile(prolog: str, inside: str, url: str) -> str:
    text = DOCUMENT.format(tc6=TC6, inside=inside.format(url=url), rest=REST)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{prolog.format(url=url)}\n{text}'


@pytest.mark.parametrize("name", HOSTILE)
def test_external_references_are_refused(run, tmp_path, name):
    secret = tmp_path / "secret.txt"
    secret.write_text(CANARY, encoding="utf-8")
    path = tmp_path / "hostile.xml"
    path.write_text(hostile(*HOSTILE[name], secret.as_uri()), encoding="utf-8")
    with pytest.raises(errors.UnsafeXmlError) as caught:
        sfc.load(path)
    assert caught.value.location.line == 2
    assert CANARY not in str(caught.value)
    for command in COMMANDS:
        code, out, err = run(*command, path)
        assert (code, out) == (2, "")
        assert CANARY not in err
        assert "Traceback" not in err


@pytest.mark.parametrize("name", HARMLESS)
def test_other_references_are_left_alone(run, tmp_path, name):
    secret = tmp_path / "secret.txt"
    secret.write_text(CANARY, encoding="utf-8")
    path = tmp_path / "harmless.xml"
    path.write_text(hostile(*HARMLESS[name], secret.as_uri()), encoding="utf-8")
    assert CANARY not in sfc.load(path).model_dump_json()
    for command in ("info", "validate"):
        code, out, err = run(command, path)
        assert code < 2
        assert CANARY not in out + err


@pytest.mark.slow
@POSIX
@pytest.mark.parametrize("name", some_of([*HOSTILE, *HARMLESS], 4))
def test_nothing_is_opened(tmp_path, name):
    """The reference leads to a pipe without a writer: whoever opened it to read would wait until the time is up."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    path = tmp_path / "hostile.xml"
    path.write_text(hostile(*(HOSTILE | HARMLESS)[name], pipe.as_uri()), encoding="utf-8")
    done = python("import sys; from plcopen_sfc.cli import main; sys.exit(main())", "validate", path, timeout=30)
    assert done.returncode == 2 if name in HOSTILE else done.returncode < 2, done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("name", [*HOSTILE, *HARMLESS])
def test_nothing_is_fetched(run, tmp_path, name):
    """Nobody has knocked at the door."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.setblocking(False)
        path = tmp_path / "hostile.xml"
        url = f"http://127.0.0.1:{server.getsockname()[1]}/x"
        path.write_text(hostile(*(HOSTILE | HARMLESS)[name], url), encoding="utf-8")
        code, _, _ = run("validate", path)
        assert code == 2 if name in HOSTILE else code < 2
        with pytest.raises(BlockingIOError):
            server.accept()


# -- files that want all the memory -----------------------------------------------------------------------------------

LIMITED = """
import resource, sys
megabytes = int(sys.argv[1])
resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))
resource.setrlimit(resource.RLIMIT_CPU, (60, 60))  # seconds of this process, after which it is ended by a signal
from plcopen_sfc.cli import main
sys.exit(main(sys.argv[2:]))
"""


@pytest.mark.slow
@POSIX
def test_an_entity_bomb_costs_nothing():
    done = python(LIMITED, 400, "info", FIXTURES / "broken" / "entity_bomb.xml")
    assert done.returncode == 2
    assert "declares entities" in done.stderr


MEGABYTES = 200 if WHOLE else 4


def huge(path: Path, repeated: str) -> Path:
    """A file of so many megabytes that begins as a project should."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f'<project xmlns="{TC6}"><types>')
        piece = repeated * (1_000_000 // len(repeated))
        for _ in range(MEGABYTES):
            file.write(piece)
    assert path.stat().st_size > (MEGABYTES - 1) * 1_000_000
    return path


@POSIX
@pytest.mark.slow
@pytest.mark.parametrize("repeated", ["<a>", "<a>\n"], ids=["on one line", "line by line"])
def test_many_megabytes_of_nesting(tmp_path, repeated):
    """Refused at once, with hardly more memory than the bytes themselves."""
    path = huge(tmp_path / "huge.xml", repeated)
    for command in some_of(COMMANDS, 2):
        done = python(LIMITED, 400 + MEGABYTES, *command, path)
        assert done.returncode == 2, done.stderr
        assert done.stderr.startswith(f"error: {path}:")
        assert "nested deeper than 256 levels" in done.stderr
    path.unlink()


@POSIX
@pytest.mark.slow
@pytest.mark.parametrize("repeated", ["x", "<a/>"], ids=["one text", "empty elements"])
def test_many_megabytes_of_something(tmp_path, repeated):
    """A file that breaks off; where memory does not suffice to notice, that is what is said."""
    path = huge(tmp_path / "huge.xml", repeated)
    done = python(LIMITED, 200 + 4 * MEGABYTES, "info", path, timeout=120)
    path.unlink()
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith(f"error: {path}:")
    assert "the file ends" in done.stderr or "not enough memory" in done.stderr
    assert "Traceback" not in done.stderr


@POSIX
@pytest.mark.slow
def test_a_sound_file_for_which_memory_does_not_suffice(tmp_path):
    """It is not called damaged, in Python neither."""
    path = tmp_path / "huge.xml"
    path.write_text(f'<project xmlns="{TC6}">{"<a/>" * 3_000_000}</project>', encoding="utf-8", newline="")
    done = python(SHORT, path, timeout=120)
    path.unlink()
    assert done.stdout.startswith(f"ExhaustionError: {path}: not enough memory"), done.stderr


SHORT = """
import resource, sys
from pathlib import Path
import plcopen_sfc as sfc
sfc.loads(Path("fixtures/broken/umlauts_utf8.xml").read_bytes())
used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + (60 << 20),) * 2)
try:
    sfc.load(sys.argv[1])
except sfc.SfcError as error:
    print(f"{type(error).__name__}: {error}")
"""


# -- names in every encoding ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("encoding", ["utf8", "cp1252", "utf16"])
def test_umlauts(run, encoding):
    path = FIXTURES / "broken" / f"umlauts_{encoding}.xml"
    project = sfc.load(path)
    assert project.diagnostics == ()
    chart = project.pou("Rührkessel").sfc
    assert chart is not None
    assert chart.step("Füllen").actions[0].target == "Y1_Füllventil"
    code, out, err = run("info", path)
    assert (code, err) == (0, "")
    assert "[Füllen]  N Y1_Füllventil" in out
    assert run("validate", path)[0] == 0


# -- saving -----------------------------------------------------------------------------------------------------------


@pytest.fixture
def old(tmp_path: Path) -> Path:
    """A file that must stay whole whatever happens."""
    path = tmp_path / "old.json"
    path.write_bytes(b"the old content")
    return path


def untouched(old: Path) -> bool:
    return old.read_bytes() == b"the old content" and list(old.parent.iterdir()) == [old]


def test_full_disk(run, old, monkeypatch):
    def full(_handle: int, _data: bytes) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    project = sfc.load(BELT)
    monkeypatch.setattr("plcopen_sfc.files.os.write", full)
    with pytest.raises(errors.FileAccessError, match="the disk is full") as caught:
        sfc.save(project, old, format="json")
    assert caught.value.location.file == str(old)
    assert untouched(old)
    code, out, err = run("convert", BELT, old, "--to", "json")
    assert (code, out) == (2, "")
    assert err.startswith(f"error: {old}: the disk is full\n")
    assert untouched(old)


@pytest.mark.slow
@POSIX
def test_the_system_lets_files_grow_no_further(old):
    """A real limit: the write stops in the middle of the file."""
    done = python(
        "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, 10_000));"
        "from plcopen_sfc.cli import main; sys.exit(main(sys.argv[1:]))",
        "convert",
        BELT,
        old,
        "--to",
        "json",
    )
    assert done.returncode == 2, done.stderr
    assert f"{old}: the file would become larger than the system allows" in done.stderr
    assert "Traceback" not in done.stderr
    assert untouched(old)


@pytest.fixture
def full_device(tmp_path: Path) -> Path:
    """A device of our own that is always full: should it be replaced by a file, the system's own is not."""
    path = tmp_path / "full"
    try:
        os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 7))
        with path.open("wb"):
            pass
    except (AttributeError, OSError) as error:
        pytest.skip(f"cannot make a device: {error}")
    return path


def test_a_device_that_is_full(run, full_device):
    code, _, err = run("convert", BELT, full_device, "--to", "json")
    assert full_device.is_char_device()  # not replaced by a file
    assert code == 2
    assert err.startswith(f"error: {full_device}: the disk is full")


@pytest.mark.slow
@POSIX
def test_a_pipe_is_written_to_and_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    script = "import sys; from plcopen_sfc.cli import main; sys.exit(main(sys.argv[1:]))"
    reader = subprocess.Popen(
        [sys.executable, "-c", "import sys; sys.stdout.write(open(sys.argv[1]).read()[:1])", pipe]
    )
    try:
        assert python(script, "convert", BELT, pipe, "--to", "json").returncode == 0
        assert pipe.is_fifo()
        assert reader.wait(timeout=10) == 0
    finally:
        reader.kill()
        reader.wait()


KILLED = """
import os, signal, sys, pathlib
def die(*_arguments, **_options):
    os.kill(os.getpid(), signal.SIGKILL)
moment, source, target = sys.argv[1:]
import plcopen_sfc
project = plcopen_sfc.load(source)
if moment == "writing":
    write = os.write
    def half(handle, data):
        write(handle, data[: len(data) // 2])
        die()
    os.write = half
elif moment == "syncing":
    os.fsync = die
else:
    pathlib.Path.replace = die
plcopen_sfc.save(project, target, format="json")
"""


@pytest.mark.slow
@POSIX
@pytest.mark.parametrize("moment", ["writing", "syncing", "renaming"])
def test_killed_while_saving(old, moment):
    done = python(KILLED, moment, BELT, old)
    assert done.returncode == -signal.SIGKILL
    assert old.read_bytes() == b"the old content"


def test_interrupted_while_saving(run, old, monkeypatch):
    def interrupt(_handle: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("plcopen_sfc.files.os.fsync", interrupt)
    assert run("convert", BELT, old, "--to", "json")[0] == 130
    assert untouched(old)


# -- charts that are wrong, but can be looked at ----------------------------------------------------------------------

WRONG = [
    ("duplicate_local_id.xml", "SFC101", 250, "POU StirTank", "localId 3 is used twice"),
    ("connection_to_nothing.xml", "SFC102", 180, "POU StirTank / transition 8", "element 99, which does not exist"),
    ("jump_to_nowhere.xml", "SFC103", 250, "POU StirTank / jumpStep Waiting", "'Waiting', which is no step"),
    ("transition_without_condition.xml", "SFC112", 180, "POU StirTank / transition 8", "no condition"),
    ("two_initial_steps.xml", "SFC110", 150, "POU StirTank / step Stir", "'Stir' is a second initial step"),
]


@pytest.mark.parametrize("case", WRONG, ids=[each[0] for each in WRONG])
def test_wrong_charts_are_loaded_and_say_so(run, case):
    name, code, line, path, words = case
    file = FIXTURES / "broken" / name
    project = sfc.load(file)
    chart = project.pou("StirTank").sfc
    assert chart is not None
    assert len(chart.steps) == 4
    found = [each for each in project.diagnostics if each.severity == "error"]
    assert [(each.code, each.location.line, each.location.path) for each in found] == [(code, line, path)]
    assert words in found[0].message
    assert found[0].location.file == str(file)
    line = f"{file}:{line} ({path}): error {code}: "
    exit_code, out, err = run("info", file)
    assert exit_code == 1
    assert line in err
    assert "StirTank" in out
    exit_code, out, err = run("validate", file)
    assert exit_code == 1
    assert line in out
    assert err == ""


def every_error() -> list[type[errors.SfcError]]:
    named = [*vars(errors).values(), *(getattr(sfc, name) for name in dir(sfc))]
    kinds = {kind for kind in named if isinstance(kind, type) and issubclass(kind, errors.SfcError)}
    return sorted(kinds, key=lambda kind: kind.__name__)


@pytest.mark.parametrize("kind", every_error(), ids=lambda kind: kind.__name__)
def test_an_error_of_a_worker_process_reaches_its_user_whole(kind: type[errors.SfcError]) -> None:
    project = sfc.load(BELT)
    unread = [sfc.Diagnostic("XML001", sfc.Severity.ERROR, "an element is missing", sfc.Location("a.xml", 3))]
    special: dict[type[errors.SfcError], Callable[[], errors.SfcError]] = {
        sfc.DamagedSourceError: lambda: sfc.DamagedSourceError(unread),
        errors.LossError: lambda: errors.LossError("2 losses", sfc.convert(project, "simaticml", partial=True)[1]),
        errors.OldVersionError: lambda: errors.OldVersionError("V14", [errors.VersionNeed("POU A", "texts", "V15")]),
        errors.CompetingTransitionsError: lambda: errors.CompetingTransitionsError("both", transitions=("1", "2")),
        errors.UnknownFunctionError: lambda: errors.UnknownFunctionError("F", "unknown", hint="declare it"),
        sfc.UntestedError: lambda: sfc.UntestedError("untested", verdict=sfc_verdict()),
    }
    plain = errors.Location("a.xml", 3, 4, "POU Main / step S1")
    error = special[kind]() if kind in special else kind("it is wrong", location=plain, hint="mend it")
    if isinstance(error, errors.FileAccessError):
        error.errno = errno.ENOENT
    again = pickle.loads(pickle.dumps(error))  # noqa: S301  # made one line before
    assert type(again) is kind
    assert str(again) == str(error)
    assert again.__dict__.keys() == error.__dict__.keys()
    assert (again.location, again.hint) == (error.location, error.hint)
    assert getattr(again, "errno", None) == getattr(error, "errno", None)
    for name in ("report", "verdict", "needs", "findings", "transitions", "name"):
        assert str(getattr(again, name, None)) == str(getattr(error, name, None))


def sfc_verdict() -> Verdict:
    pou = sfc.loads(b"PROGRAM Main VAR_INPUT a : BOOL; END_VAR VAR q : BOOL; END_VAR q := a; END_PROGRAM").pou("Main")
    return equivalent(pou, pou)


def loop() -> sfc.Project:
    chart = "INITIAL_STEP S: END_STEP TRANSITION FROM S TO S := x; END_TRANSITION"
    return sfc.loads(f"PROGRAM P VAR_INPUT x : BOOL; END_VAR {chart} END_PROGRAM".encode(), format="iec-text")


@pytest.mark.parametrize(
    "options",
    [
        *({"scans": "x"}, {"scans": 1.5}, {"scan_time": []}, {"pou": 5}, {"initial": 5}, {"record": 5}),
        *({"record": [5]}, {"functions": 5}, {"free_inputs": 5}, {"inputs": 5}, {"profile": 5}),
    ],
    ids=str,
)
def test_arguments_of_other_types_are_refused(options: dict[str, object]) -> None:
    with pytest.raises(errors.ArgumentError):
        sfc.simulate(loop(), **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("options", [{"init": 5}, {"flags": 5}, {"modes": 5}, {"at_rest": 5}, {"pou": 5}], ids=str)
def test_options_of_other_types_are_refused_in_lowering(options: dict[str, object]) -> None:
    with pytest.raises(errors.ArgumentError):
        sfc.lower(loop(), verify=False, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("options", [{"tia": 5}, {"at_rest": 5}, {"format": 5}], ids=str)
def test_options_of_other_types_are_refused_in_saving(options: dict[str, object]) -> None:
    with pytest.raises(errors.ArgumentError):
        sfc.dumps(sfc.load(BELT), **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("options", [{"select": 5}, {"ignore": 5}, {"select": [5]}], ids=str)
def test_options_of_other_types_are_refused_in_checking(options: dict[str, object]) -> None:
    with pytest.raises(errors.ArgumentError):
        sfc.check(sfc.load(BELT), **options)  # type: ignore[arg-type]


QUERIES: dict[str, Callable[[sfc.Project, SfcNetwork, Any], object]] = {
    "chart.find": lambda _, chart, wrong: chart.find(wrong),
    "chart.find_transitions": lambda _, chart, wrong: chart.find_transitions(wrong),
    "chart.outgoing": lambda _, chart, wrong: chart.outgoing(wrong),
    "chart.incoming": lambda _, chart, wrong: chart.incoming(wrong),
    "steps.where": lambda _, chart, wrong: chart.steps.where(wrong),
    "pous.where": lambda project, _, wrong: project.pous.where(wrong),
    "project.steps": lambda project, _, wrong: project.steps(wrong),
}


@pytest.mark.parametrize("query", QUERIES)
@pytest.mark.parametrize("wrong", ["Fill", 5, b"S", ["S"]], ids=str)
def test_queries_refuse_what_is_no_function_or_step(query: str, wrong: object) -> None:
    project = loop()
    with pytest.raises(errors.ArgumentError, match="name"):
        QUERIES[query](project, next(project.charts()).chart, wrong)


@pytest.mark.parametrize("wrong", [5, b"S", [5]], ids=str)
def test_conditions_of_other_types_are_refused_in_queries(wrong: Any) -> None:
    project = loop()
    chart = next(project.charts()).chart
    for name in ("reads", "calls", "condition", "leaving", "entering"):
        with pytest.raises(errors.ArgumentError, match=f"{name}.* patterns"):
            chart.find_transitions(**{name: wrong})
    for query in (lambda: project.steps(qualifier=wrong), lambda: chart.step(wrong)):
        with pytest.raises(errors.SfcError):
            query()
    for deed in (lambda: project.locations_of(wrong), lambda: sfc.check_import(project, wrong)):
        with pytest.raises(errors.ArgumentError):
            deed()
    for sides in ((wrong, "S"), ("S", wrong)):
        with pytest.raises(errors.SfcError):
            chart.add_transition(*sides)
    assert len(chart.transitions) == 1


@pytest.mark.parametrize("wrong", [None, 5, b"x", []], ids=str)
def test_other_types_are_refused_in_drawing(wrong: Any) -> None:
    project = loop()
    for deed in (sfc.draw, sfc.conversion_page, partial(sfc.diff_page, project)):
        with pytest.raises(errors.ArgumentError):
            deed(project, wrong)


@POSIX
def test_names_that_are_too_long_for_the_system(run: Run, tmp_path: Path) -> None:
    name = tmp_path / f"{'a' * 300}.xml"
    for deed in (lambda: sfc.load(name), lambda: sfc.save(sfc.load(BELT), name), lambda: sfc.load("a/" * 3000)):
        with pytest.raises(errors.FileAccessError, match="too long"):
            deed()
    for command in COMMANDS:
        assert "too long" in run(*command, name)[2]
