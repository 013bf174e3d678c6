"""Scripts that change many files: what each file becomes, and the changes on the disk.

A script is a Python file with a function ``refactor(project)``, or with a class that has such a method. Further
parameters of the function, or the attributes that the class declares, are settings. They have a type (`str`, `int`,
`float`, `bool`, `Path`, `Literal`, one of several, or a list of these), else that of their default, and a default where
they may be left out. A plugin provides the same under a name of its own.
"""

from __future__ import annotations

import dataclasses
import difflib
import inspect
import io
import json
import os
import sys
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext, redirect_stdout
from dataclasses import dataclass
from functools import partial, wraps
from hashlib import blake2b
from pathlib import Path, PurePath
from types import ModuleType, NoneType, UnionType
from typing import TYPE_CHECKING, Any, Literal, Union, get_args, get_origin, get_type_hints

from plcopen_sfc import plugins
from plcopen_sfc.documents.folder_projects import edited_files, files_below, folder_format
from plcopen_sfc.documents.sources import FileSource
from plcopen_sfc.documents.storage import load_project, refuse_mistakes, save_project
from plcopen_sfc.errors import (
    FileAccessError,
    FormatError,
    Location,
    ScriptError,
    SfcError,
    nearest,
    told_when_exhausted,
)
from plcopen_sfc.files import folder_exists, read_bytes, write_all
from plcopen_sfc.formats.file_recognition import recognise
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.registry import all_formats, format_named
from plcopen_sfc.model.project import Project
from plcopen_sfc.processes import results
from plcopen_sfc.report import LOSSES, ConversionReport, Item, Outcome

if TYPE_CHECKING:
    from plcopen_sfc.comparison.changes import Proof

_SPACE = b"\xef\xbb\xbf\xff\xfe\0 \t\r\n"
_BLANK = 100
"""Bytes that an empty file has at most: a mark of its encoding, ends of lines."""
_OF_ANYTHING = frozenset({".xml", ".json", ".csv", ".xlsx"})
"""Extensions that are not those of the files of PLC tools alone."""
_BY_PLACE = (
    inspect.Parameter.POSITIONAL_ONLY,
    inspect.Parameter.POSITIONAL_OR_KEYWORD,
    inspect.Parameter.VAR_POSITIONAL,
)
"""Kinds of parameters that take a project."""
_START = 100_000
"""Bytes by which a file is recognised."""


@dataclass(frozen=True)
class FileChange:
    """A file that a script changes, with its content before and after; a file that is new or gone has none."""

    path: str
    before: bytes
    after: bytes


@dataclass(frozen=True)
class AppliedFile:
    """Result of a script for the project at `path`, a file or a folder. `error`: why it failed, and nothing changes.

    `proofs`: whether what it changed still does the same, where that was asked for. `resumed`: the run that was resumed
    had done it; what changed is not known any more. `returned` is what the script returned, `lost` has the items that
    are not whole in the saved files.
    """

    path: str
    changes: tuple[FileChange, ...] = ()
    error: str = ""
    resumed: bool = False
    proofs: tuple[Proof, ...] = ()
    returned: Any = None
    lost: tuple[Item, ...] = ()


@dataclass(frozen=True)
class Script:
    """A script as text, so that a run has one version of it; a plugin has no text, and `path` is its name."""

    path: str
    text: str | None = None


Edit = Callable[[Project], Any]
"""A function that changes a project. Several processes need a picklable one; a journal knows it by its `repr`."""


def apply(
    script: str | Edit,
    paths: Iterable[str],
    *,
    settings: Mapping[str, str] | None = None,
    write: bool = False,
    jobs: int = 1,
    scheduler: str = "",
    prove: bool = False,
    limit: float | str | None = None,
    journal: str | None = None,
) -> Iterator[AppliedFile]:
    """Run a script on each of `paths` (see `project_files`), and yield what came of it, in their order.

    `script` is a file, the name of a plugin or a function, `settings` are texts by the names of its parameters. Files
    are changed with `write` only. A file for which the script fails stays as it is, and does not stop the others. With
    `prove` that is also a file of which something that changed does not do the same as before, by proof or in runs that
    reached all of it, or of which nothing tells that: each is run for at most `limit` (seconds, or ``60s``).

    `jobs` files are worked on at a time, each in a process of its own; `scheduler` is the address of a Dask scheduler,
    whose workers do it. They return what changes, and this process alone writes: a process or worker that ends in the
    middle loses nothing, and nothing is done twice. `journal` is a file that keeps what is done: a run with the same
    journal goes on where another was interrupted.

    Raises `ScriptError` for a script that cannot be run, or does not have the settings, and for the journal of another
    script or of other settings; `InputError` for a limit that is none.
    """
    from plcopen_sfc.analysis.search_limits import seconds  # noqa: PLC0415  # brings the simulation

    given = dict(settings or {})
    prepared = _read_script(script) if isinstance(script, str) else script
    if isinstance(prepared, Script):
        _function(prepared, given)  # before any file is touched
    wanted = list(paths)
    seconds(limit)  # a wrong one is a mistake of the call, not of a file
    work = partial(_applied, prepared, given, prove, limit)
    run = [prepared.path, prepared.text or ""] if isinstance(prepared, Script) else [repr(prepared), ""]
    with RunJournal(journal, [*run, given, write, prove]) if journal else nullcontext() as kept:
        done = kept.done if kept is not None else {}
        fresh = results(work, [each for each in wanted if each not in done], jobs, scheduler=scheduler, lost=_lost)
        for path in wanted:
            if path in done:
                yield AppliedFile(path, error=done[path], resumed=True)
                continue
            found = next(fresh)
            yield _finished(found, kept, write=write)


def _lost(path: str, why: str) -> AppliedFile:
    return AppliedFile(path, error=why)


def _finished(found: AppliedFile, journal: RunJournal | None, *, write: bool) -> AppliedFile:
    """Write what changes, and note it in the journal: before, so that an interruption in between is seen, and after."""
    try:
        if write and not found.error:
            if journal is not None:
                journal.begin(found)
            _write(found.changes)
    except SfcError as error:
        found = AppliedFile(found.path, error=str(error))
    if journal is not None:
        journal.end(found.path, found.error)
    return found


def _write(changes: Sequence[FileChange]) -> None:
    """Write files; refuse to where one was changed since the script saw it."""
    for change in changes:
        if (read_bytes(change.path) if Path(change.path).is_file() else b"") != change.before:
            hint = "Nothing was written. Run the script on it again."
            where = Location(change.path)
            raise FileAccessError("the file was changed while the script ran", location=where, hint=hint)
    write_all({Path(change.path): change.after for change in changes if change.after})
    for change in changes:
        if not change.after:
            Path(change.path).unlink(missing_ok=True)


class RunJournal:
    """The progress of a run, in lines of JSON: a head, then for each path one before it is written and one after.

    `done` has by path why it failed, empty where it did not. `run` is what the run does, as plain data. Raises
    `ScriptError` for the journal of another run.
    """

    def __init__(self, path: str, run: object) -> None:
        self._path = path
        self._head = blake2b(json.dumps(run, sort_keys=True).encode(), digest_size=16).hexdigest()
        self.done: dict[str, str] = {}

    def __enter__(self) -> RunJournal:
        lines = read_bytes(self._path).decode("utf-8", "replace").split("\n")[:-1] if Path(self._path).exists() else []
        try:
            read: Iterable[dict[str, Any]] = map(json.loads, lines) if lines else [{"run": self._head}]
            head, *entries = read
            begun: dict[str, list[list[str]]] = {entry["path"]: entry["files"] for entry in entries if "files" in entry}
            self.done = {entry["path"]: entry["error"] for entry in entries if "error" in entry}
            run = head["run"]
        except (ValueError, KeyError, TypeError):
            raise ScriptError("this is no journal of a run", location=Location(self._path)) from None
        if run != self._head:
            hint = "Name another journal, or remove this one to begin from the start."
            message = "this is the journal of another script, or of other settings"
            raise ScriptError(message, location=Location(self._path), hint=hint)
        for path, files in begun.items():
            if path not in self.done and (why := _state_of(files)) is not None:
                self.done[path] = why
        self._file = Path(self._path).open("ab")  # closed in __exit__
        # a line that the interruption cut off is overwritten by its end
        self._file.truncate(sum(len(line.encode()) + 1 for line in lines))
        if not lines:
            self._add({"run": self._head})
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def begin(self, found: AppliedFile) -> None:
        """Note what is about to be written."""
        if found.changes:
            files = [[each.path, _digest(each.before), _digest(each.after)] for each in found.changes]
            self._add({"path": found.path, "files": files})

    def end(self, path: str, error: str) -> None:
        """Note what is done."""
        self._add({"path": path, "error": error})

    def _add(self, entry: Mapping[str, object]) -> None:
        self._file.write((json.dumps(entry) + "\n").encode())
        self._file.flush()
        os.fsync(self._file.fileno())


def _state_of(files: list[list[str]]) -> str | None:
    """Return the outcome of a project that was being written: None for nothing, empty if all is there, else why not."""
    now = [_digest(read_bytes(name) if Path(name).is_file() else b"") for name, *_ in files]
    if now == [before for _, before, _ in files]:
        return None
    if now == [after for *_, after in files]:
        return ""
    odd = [name for (name, _, after), digest in zip(files, now, strict=True) if digest != after]
    return (
        f"the run was interrupted while it was written; these files are not as the script makes them: {', '.join(odd)}"
    )


def _digest(content: bytes) -> str:
    return blake2b(content, digest_size=16).hexdigest() if content else ""


def project_files(paths: Iterable[str]) -> list[str]:
    """Return files and folders that are a project each, once.

    The documents of TIA Portal Openness in a folder are one project, those of TwinCAT are one, and each file of another
    format.
    """
    found = (_in_folder(path) if folder_exists(path) else [path] for path in paths)
    return without_repeated(name for each in found for name in each)


def without_repeated(paths: Iterable[str]) -> list[str]:
    """Return paths without those that lead to the same file as an earlier one, as links do: none is edited twice."""
    first: dict[str, str] = {}
    for path in paths:
        first.setdefault(os.path.realpath(path), path)
    return list(first.values())


def difference(change: FileChange) -> list[str]:
    """Return the lines of a unified diff, without context."""
    codec = _encoding(change.before or change.after, change.path)
    old, new = (text.decode(codec, "replace").lstrip("\ufeff").splitlines() for text in (change.before, change.after))
    return list(difflib.unified_diff(old, new, change.path, change.path, n=0, lineterm=""))


def patch_of(change: FileChange) -> bytes:
    """Return the same byte for byte, as `patch` takes it: with the line ends and in the encoding of the file."""

    def lines(data: bytes) -> list[bytes]:
        *whole, last = data.split(b"\n")
        return [*(line + b"\n" for line in whole), *([last] if last else [])]

    path = change.path.encode("utf-8", "surrogateescape")
    before, after = lines(change.before), lines(change.after)
    found = difflib.diff_bytes(difflib.unified_diff, before, after, path, path, n=0)
    return b"".join(line if line.endswith(b"\n") else line + _NO_END for line in found)


_NO_END = b"\n\\ No newline at end of file\n"


def _encoding(data: bytes, name: str) -> str:
    if not recognise(data, file=name).xml:
        return "utf-8"
    from plcopen_sfc.formats.xml.xml_parsing import detect_encoding  # noqa: PLC0415  # only for XML

    return detect_encoding(data, file=name).codec


def documents_in(folder: str) -> list[str]:
    """Return the files of known formats in a folder and those below."""
    return [*_kinds_in(folder)]


def _in_folder(folder: str) -> list[str]:
    kinds = _kinds_in(folder)
    if not any(kind.folders for kind in kinds.values()):
        return [*kinds]
    own = folder_format(folder)
    others = {path: kind for path, kind in kinds.items() if kind is not own}
    return [folder, *dict.fromkeys(_project_of(path, kind, kinds) for path, kind in others.items())]


def _project_of(path: str, kind: Format, kinds: Mapping[str, Format]) -> str:
    """Return the folder with all documents of a kind, where it has none of another one; else the file alone."""
    if not kind.folders:
        return path
    folder = os.path.commonpath([Path(each).parent for each, its in kinds.items() if its is kind])
    below = (its for each, its in kinds.items() if its.folders and Path(each).is_relative_to(folder))
    return folder if all(its is kind for its in below) else path


def _kinds_in(folder: str) -> dict[str, Format]:
    paths = (Path(folder, name) for name in sorted(files_below(folder)))
    return {str(path): kind for path in paths if (kind := known_format(path) or _format_of_empty(path)) is not None}


def _format_of_empty(path: Path) -> Format | None:
    """Return the format of an empty file by an extension that only one tool has: reading tells that it is empty."""
    suffix = path.suffix.casefold()
    if suffix in _OF_ANYTHING or not path.is_file() or path.stat().st_size > _BLANK or path.read_bytes().strip(_SPACE):
        return None
    return next((kind for kind in all_formats() if suffix in kind.extensions), None)


def known_format(path: Path) -> Format | None:
    """Return the format of a file by its content; None for a folder, and where it is no known one."""
    if not path.is_file():
        return None
    with path.open("rb") as file:
        start = file.read(_START)
    try:
        return recognise(start, file=str(path))
    except FormatError:
        return None


def is_folder_in(kind: Format, source: Path) -> bool:
    """True if what is written of `source` in a format is a folder, where nothing else is asked for.

    Tools such as TIA Portal import one object a file. So a project that comes from another tool becomes a folder.
    """
    return kind.folders and known_format(source) is not kind


def _applied(
    script: Script | Edit, settings: Mapping[str, str], prove: bool, limit: float | str | None, path: str
) -> AppliedFile:
    from plcopen_sfc.comparison.project_comparison import diff  # noqa: PLC0415  # brings the interpreter

    function, values = _function(script, settings) if isinstance(script, Script) else (script, {})
    name = script.path if isinstance(script, Script) else __file__
    try:
        with told_when_exhausted(path):
            project = load_project(path)
            returned = function(project, **values)
            changes, report = _changes(project, path)
        proofs = diff(load_project(path), project, prove=True, limit=limit).proofs if prove and changes else ()
        failed = next((each for each in proofs if not each.equal), None)
        error = f"{path}: not proven to do the same: {failed}" if failed is not None else ""
        lost = tuple(report.with_outcome(*LOSSES, Outcome.DROPPED))
        return AppliedFile(path, () if error else changes, error, proofs=proofs, returned=returned, lost=lost)
    except SfcError as error:
        return AppliedFile(path, error=str(error))
    except (Exception, SystemExit) as error:  # whatever a script does wrong, the other files go on
        return AppliedFile(path, error=str(_mistake(name, error)))


def script_edit(script: str, settings: Mapping[str, str]) -> Edit:
    """Return a script, or the plugin of this name, as a function that changes a project.

    Raises `ScriptError` as `apply` does; the function raises one for any error of the script.
    """
    function, values = _function(_read_script(script), settings)

    def edit(project: Project) -> Any:
        try:
            return function(project, **values)
        except SfcError:
            raise
        except (Exception, SystemExit) as error:
            raise _mistake(script, error) from error

    return edit


def _mistake(script: str, error: BaseException) -> ScriptError:
    """Return the error of a script with its line."""
    frames = traceback.extract_tb(error.__traceback__)
    line = next((each.lineno for each in reversed(frames) if each.filename == script), 0)
    return ScriptError(f"{type(error).__name__}: {error}", location=Location(script, line=line))


def _changes(project: Project, path: str) -> tuple[tuple[FileChange, ...], ConversionReport]:
    """Return the changes that saving the project in its place would make, and their report."""
    source = project.source
    if isinstance(source, FileSource):
        content = io.BytesIO()
        report = save_project(project, content, format=source.format)  # refuses what it would refuse on the disk
        change = FileChange(path, source.content, content.getvalue())
        return (change,) if change.after != change.before else (), report
    if source is not None:
        refuse_mistakes(project, format_named(source.format)[0])
    report = ConversionReport()
    return tuple(FileChange(*each) for each in edited_files(project, path, report)), report


def _read_script(name: str) -> Script:
    """Return a script, or the plugin of this name. Raises `ScriptError` where there is neither."""
    if Path(name).is_file():
        return Script(name, read_bytes(name).decode("utf-8-sig"))
    known = plugins.names_of(plugins.REFACTORINGS)
    if name in known:
        return Script(name)
    hint = "It is a Python file" + (f", or one of: {', '.join(known)}." if known else ".")
    raise ScriptError("there is no such script", location=Location(name), hint=hint)


def _function(script: Script, settings: Mapping[str, str]) -> tuple[Callable[..., Any], dict[str, Any]]:
    """Return the function of a script, and its settings as values."""
    where = Location(script.path)
    try:
        found = _refactoring(script)
        function = found if found is None or not inspect.isclass(found) else _of_class(found)
        hints = get_type_hints(found) if found is not None else {}
    except SfcError:
        raise
    except (Exception, SystemExit) as error:
        raise ScriptError(f"{type(error).__name__}: {error}", location=where) from error
    if function is None:
        hint = "Or a class with a method refactor(self, project)."
        raise ScriptError("the script has no function refactor(project)", location=where, hint=hint)
    if inspect.iscoroutinefunction(getattr(found, "refactor", function)):
        raise ScriptError("refactor is an async function, which nothing runs", location=where, hint="Write def alone.")
    parameters = list(inspect.signature(function).parameters.values())
    if not parameters or parameters.pop(0).kind not in _BY_PLACE:
        raise ScriptError("refactor takes no project", location=where, hint="Write: def refactor(project)")
    names = [parameter.name for parameter in parameters]
    for name in settings:
        if name not in names:
            message = f"the script has no setting {name!r}{nearest(name, names)}"
            raise ScriptError(message, location=where, hint=f"It has: {', '.join(names) or 'none'}")
    missing = [each.name for each in parameters if each.default is each.empty and each.name not in settings]
    if missing:
        hint = f"--set {missing[0]}=VALUE"
        raise ScriptError(f"the script needs the setting {missing[0]!r}", location=where, hint=hint)
    usual = {each.name: str if each.default in (None, each.empty) else type(each.default) for each in parameters}
    kinds = usual | hints
    return _aside(function), {name: _value(script.path, name, text, kinds[name]) for name, text in settings.items()}


def _aside(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of a script, which prints to standard error: the other stream may be for the file or JSON."""

    @wraps(function)
    def run(*args: Any, **values: Any) -> Any:
        with redirect_stdout(sys.stderr):
            return function(*args, **values)

    return run


def _refactoring(script: Script) -> Callable[..., Any] | None:
    """Return the function or the class of a script; None where it has neither."""
    if script.text is None:
        provided: Callable[..., Any] = plugins.loaded(plugins.REFACTORINGS, script.path)
        return provided
    module = _executed(script.text, script.path)
    found: Callable[..., Any] | None = getattr(module, "refactor", None)
    if callable(found):
        return found
    own = (each for each in vars(module).values() if inspect.isclass(each) and each.__module__ == module.__name__)
    return next((each for each in own if callable(getattr(each, "refactor", None))), None)


def _of_class(kind: type) -> Callable[..., Any]:
    """Return the function of a class: what it declares as attributes are the parameters."""
    made: Any = kind if dataclasses.is_dataclass(kind) else dataclasses.dataclass(kind)

    def refactor(project: Project, **values: Any) -> None:
        made(**values).refactor(project)

    own = inspect.signature(made).parameters.values()
    project = inspect.Parameter("project", inspect.Parameter.POSITIONAL_ONLY)
    refactor.__signature__ = inspect.Signature([project, *(each.replace(kind=each.KEYWORD_ONLY) for each in own)])  # type: ignore[attr-defined]
    return refactor


def functions_of(script: str) -> dict[str, Callable[..., Any]]:
    """Return the functions that a Python file defines, by name, for programs that call them; ``_name`` is none.

    Raises `ScriptError` for a file that cannot be read or executed.
    """
    try:
        module = _executed(Path(script).read_text(encoding="utf-8"), script)
    except (Exception, SystemExit) as error:
        raise ScriptError(f"{type(error).__name__}: {error}", location=Location(script)) from error
    found = {name: each for name, each in vars(module).items() if inspect.isfunction(each) and not name.startswith("_")}
    return {name: _aside(each) for name, each in found.items() if each.__module__ == module.__name__}


def _executed(text: str, path: str) -> ModuleType:
    """Return the module that a Python file is."""
    module = ModuleType("plcopen_sfc_script")
    module.__file__ = path
    sys.modules[module.__name__] = module  # where dataclasses look for the names in annotations
    with redirect_stdout(sys.stderr):
        exec(compile(text, path, "exec"), module.__dict__)  # noqa: S102  # what the user asks for
    return module


def _value(script: str, name: str, text: str, kind: Any) -> Any:
    """Return the text of a setting as a value of its type."""
    try:
        return _converted(text, kind)
    except ValueError as error:
        message = f"the setting {name} is {error}, not {text!r}"
        raise ScriptError(message, location=Location(script)) from None
    except TypeError as error:
        message = f"the setting {name} cannot be given: its type is {error}"
        hint = "Settings are str, int, float, bool, Path, Literal, and lists of these."
        raise ScriptError(message, location=Location(script), hint=hint) from None


def _converted(text: str, kind: Any) -> Any:
    """Return a text as a value of a type; `ValueError` tells what the type takes, `TypeError` that no text is one."""
    made, choices = get_origin(kind) or kind, get_args(kind)
    if made in (Union, UnionType):
        return _first_of(text, [each for each in choices if each is not NoneType])
    if made is Literal:
        found = next((each for each in choices if str(each) == text), None)
        if found is None:
            raise ValueError(" or ".join(map(str, choices)))
        return found
    if made in (list, tuple, set, frozenset, Sequence, Iterable):
        if made is tuple and choices and choices[1:] != (...,):
            raise TypeError(kind)
        parts = [part.strip() for part in text.split(",")] if text.strip() else []
        found = [_converted(part, choices[0] if choices else str) for part in parts]
        return found if made in (Sequence, Iterable) else made(found)
    if made is bool and text.casefold() not in _BOOLEANS:
        raise ValueError("true or false")
    if made in _NUMBERS:
        try:
            return made(text)
        except ValueError:
            raise ValueError(_NUMBERS[made]) from None
    if isinstance(made, type) and issubclass(made, PurePath):
        return made(text)
    if made not in (bool, str, Any, object):
        raise TypeError(getattr(kind, "__name__", kind) if not choices else kind)
    return _BOOLEANS[text.casefold()] if made is bool else text


_BOOLEANS = {"true": True, "false": False}
_NUMBERS = {int: "a whole number", float: "a number"}


def _first_of(text: str, kinds: Sequence[Any]) -> Any:
    """Return a text as a value of the first type that takes it: any text is a str, so that is the last one."""
    wanted: list[str] = []
    for kind in sorted(kinds, key=lambda each: each is str):
        try:
            return _converted(text, kind)
        except ValueError as error:
            wanted.append(str(error))
    raise ValueError(" or ".join(wanted))
