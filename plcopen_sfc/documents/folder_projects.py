"""A folder of documents as one project, loaded and saved.

Saving goes into the documents that the project was read from, or writes one document for each object. See
docs/decisions/0012.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, BinaryIO, TypeVar, cast

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.documents.file_documents import (
    encode,
    normalized,
    read_document,
    refuse_losses,
    refuse_reading_errors,
    report_behaviour,
)
from plcopen_sfc.documents.folder_documents import (
    PROJECT_DOCUMENT,
    PlannedDocument,
    merged,
    plan_like,
    plan_new,
    shared_fields,
    without_objects,
)
from plcopen_sfc.documents.reading_back import verify
from plcopen_sfc.documents.source_names import names_in_the_source
from plcopen_sfc.documents.sources import FileSource, FolderSource, SourceDocument, with_objects
from plcopen_sfc.errors import (
    FileAccessError,
    Location,
    OldVersionError,
    SfcError,
    UnknownFormatError,
    UnreadFormatError,
    told_when_exhausted,
)
from plcopen_sfc.files import access_failure, file_exists, path_exists, read_bytes, write_all
from plcopen_sfc.formats.file_recognition import named_like, recognised_as
from plcopen_sfc.formats.format_interface import HEAD, Format, WriteOptions
from plcopen_sfc.formats.provenance import place_in_folder, put_in_folder, take_provenance
from plcopen_sfc.formats.registry import all_formats, format_named
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.report import ConversionReport

if TYPE_CHECKING:
    from plcopen_sfc.formats.xml.xml_codec import FolderCodec


Progress = Callable[[Sequence[str]], Iterable[str]]
"""Iterates over the files of a folder and shows the progress."""


def load_folder(
    folder: str,
    *,
    format: str | None = None,
    progress: Progress | None = None,
    as_tool: bool = False,
    listed: Sequence[str] | None = None,
) -> Project:
    """Read all documents below `folder`, or those `listed`, into one project; `as_tool`: as their tool sees them.

    A document that cannot be read does not keep the others from it: it is an error in `Project.diagnostics`. Raises
    `FileAccessError` where the folder cannot be read, `UnknownFormatError` where it has no document that can be.
    """
    scan = _Scan(Path(folder))
    kind = _folder_format(folder, format, scan.files)
    source = FolderSource(kind.name, "", folder, {}, {}, {}, [], [])
    things: list[ProjectObject] = []
    source.unreadable.update(scan.failures)
    if listed is not None:
        _keep_listed(scan, listed, kind, source)
    with collecting_rarely():
        for name in progress(scan.files) if progress is not None else scan.files:
            try:
                with told_when_exhausted(str(Path(folder, name))):
                    things += _read(source, kind, name, as_tool=as_tool)
            except SfcError as error:
                source.unreadable[name] = error
    source.others += scan.links
    if not source.documents:
        raise _no_document(source, [kind] if format is not None else [each for each in all_formats() if each.folders])
    frame = merged(source.documents, kind)
    project = with_objects(frame, things)
    project.adopt()
    newest = kind.versions[-1] if kind.versions else ""
    source.version = frame.header.version if frame.header.version in kind.versions else newest
    source.shared = shared_fields(project)
    source.own_diagnostics += _findings(source, project)
    if listed is None:
        source.own_diagnostics += _of_other_tools(source)
    project.source = source
    return project


def _keep_listed(scan: _Scan, listed: Sequence[str], kind: Format, source: FolderSource) -> None:
    """Leave only the files `listed` in `scan`; those that are not there are errors."""
    wanted = {name.casefold(): name for name in listed if PurePosixPath(name).suffix.casefold() in kind.extensions}
    source.others += [name for name in scan.files if name.casefold() not in wanted]
    scan.files = [name for name in scan.files if name.casefold() in wanted]
    if "" in listed:
        why = "the project lists a file without its path (Include)"
        source.unreadable[""] = FileAccessError(why, location=Location(source.path))
    for missing in wanted.keys() - {name.casefold() for name in scan.files}:
        name = wanted[missing]
        place = Location(str(Path(source.path, name)))
        outside = ".." in PurePosixPath(name).parts
        why = "it is outside of its folder: load the folder above" if outside else "it is not there"
        source.unreadable[name] = FileAccessError(f"the project lists this file, and {why}", location=place)


def load_listed(path: str, kind: Format, *, progress: Progress | None = None, as_tool: bool = False) -> Project:
    """Load the documents that the file at `path` lists, such as a ``.plcproj``; others beside them are left alone."""
    wanted = cast("FolderCodec", kind.codec()).listed(read_bytes(path), file=path)
    return load_folder(str(Path(path).parent), format=kind.name, progress=progress, as_tool=as_tool, listed=wanted)


def folder_format(folder: str) -> Format:
    """Return the format in which a folder is read where none is named."""
    return _folder_format(folder, None, _Scan(Path(folder)).files)


def _folder_format(folder: str, format: str | None, files: list[str]) -> Format:
    """Return the format of a folder: the one named, else that of which it has the most documents."""
    known = [kind for kind in all_formats() if kind.folders]
    if format is None:
        named = {
            kind.name: [n for n in files if PurePosixPath(n).suffix.casefold() in kind.extensions] for kind in known
        }
        if all(named.values()):  # exports of other tools end in .xml, too
            named = {kind.name: [n for n in named[kind.name] if _is_document(kind, folder, n)] for kind in known}
        return max(known, key=lambda kind: len(named[kind.name]))
    kind = format_named(format)[0]
    if not kind.folders:
        names = ", ".join(each.name for each in known)
        raise UnknownFormatError(
            f"a folder is no project in the format {kind.name}",
            location=Location(folder),
            hint=f"Folders are read in the format {names}; name the files otherwise.",
        )
    return kind


class _Scan:
    """The files below a folder, by their paths in it (with ``/``), in an order that no file system decides.

    Hidden folders and files (``.git``) are none of the project's. Links to folders are not followed: they may lead
    round in circles, or to files that are read already.
    """

    def __init__(self, top: Path) -> None:
        self._top = top
        self.files: list[str] = []
        self.links: list[str] = []
        self.failures: dict[str, SfcError] = {}
        try:
            os.scandir(top).close()
        except OSError as error:
            raise access_failure(top, error) from error
        for parent, folders, files in os.walk(top, onerror=self._failed):
            here = PurePosixPath(Path(parent).relative_to(top).as_posix())
            self.links += [(here / name).as_posix() for name in folders if Path(parent, name).is_symlink()]
            folders[:] = [name for name in folders if not name.startswith(".")]
            self.files += [(here / name).as_posix() for name in files if not name.startswith(".")]
        self.files.sort(key=lambda name: (name.casefold(), name))

    def _failed(self, error: OSError) -> None:
        name = Path(os.fsdecode(error.filename)).relative_to(self._top).as_posix()
        self.failures[name] = access_failure(error.filename, error)


def files_below(folder: str) -> list[str]:
    """Return the paths of all files in `folder` that are not hidden, and of links to folders."""
    scan = _Scan(Path(folder))
    return [*scan.files, *scan.links]


def _read(source: FolderSource, kind: Format, name: str, *, as_tool: bool) -> list[ProjectObject]:
    """Read one file, if it is a document of `kind`; its objects.

    One with an extension that no other format has is such a document, whatever damage hides it.
    """
    path = Path(source.path, name)
    suffix = path.suffix.casefold()
    is_own = suffix in kind.extensions and all(suffix not in each.extensions for each in all_formats() if each != kind)
    if not is_own and (suffix not in kind.extensions or not recognised_as(kind, _start(path))):
        source.others.append(name)
        return []
    return add_document(source, name, read_bytes(path), as_tool=as_tool)


def _is_document(kind: Format, folder: str, name: str) -> bool:
    try:
        return recognised_as(kind, _start(Path(folder, name)))
    except FileAccessError:
        return False


def _start(path: Path) -> bytes:
    """Return enough of a file to recognise it: a file of no document may have any size."""
    try:
        if path_exists(path) and not file_exists(path):
            return b""  # a pipe would wait for ever
        file: BinaryIO
        with path.open("rb") as file:
            return file.read(HEAD)
    except OSError as error:
        raise access_failure(path, error) from error


def add_document(source: FolderSource, name: str, data: bytes, *, as_tool: bool = False) -> list[ProjectObject]:
    """Make `data` the document `name` of the folder; return its objects, which know where they are from."""
    part = read_document(data, format=source.format, path=str(Path(source.path, name)), as_tool=as_tool)
    things = list(part.objects())
    source.documents[name] = SourceDocument(without_objects(part), len(things))
    place_objects(things, name)
    return things


def _pairs_of(
    ones: Iterable[ProjectObject], things: Iterable[ProjectObject]
) -> list[tuple[ProjectObject, ProjectObject]]:
    """Return each of `things` with that of `ones` that has its kind and its name."""
    found = {(type(each), each.name): each for each in ones}
    return [(found[type(each), each.name], each) for each in things if (type(each), each.name) in found]


def place_objects(things: Iterable[ProjectObject], name: str) -> None:
    """Let objects know that they are those of the document `name`, in their order."""
    folder = PurePosixPath(name).parent.as_posix()
    for place, thing in enumerate(things):
        put_in_folder(thing, name, place, "" if folder == "." else folder)


def _no_document(source: FolderSource, kinds: list[Format]) -> SfcError:
    if source.unreadable:
        count = len(source.unreadable)
        first = next(iter(source.unreadable.values()))
        message = f"none of the {count} documents in this folder can be read; the first: {first.message}"
        return FileAccessError(message, location=Location(source.path), hint=first.hint)
    message = f"the folder has no document of {' or '.join(kind.name for kind in kinds)}"
    known = next((known for name in source.others if (known := named_like(name)) is not None), None)
    if known is not None:
        message = f"{message}; a file in it is {known.title}, which is not read"
        return UnreadFormatError(message, location=Location(source.path), hint=known.advice)
    hint = "Folders are read as exports of TIA Portal Openness, or as projects of TwinCAT; name other files one by one."
    return UnknownFormatError(message, location=Location(source.path), hint=hint)


def _findings(source: FolderSource, project: Project) -> list[Diagnostic]:
    """Return the findings about the folder as a whole."""
    found = [
        Diagnostic("DIR101", Severity.ERROR, f"not read: {error.message}", _place(error, Path(source.path, name)))
        for name, error in source.unreadable.items()
    ]
    versions = {document.source.version for document in source.documents.values()}
    if len(versions) > 1:
        message = "the documents are of several versions: " + ", ".join(sorted(versions))
        found.append(Diagnostic("DIR104", Severity.INFO, message, Location(source.path)))
    groups: list[Sequence[ProjectObject]] = [
        [*project.pous, *project.data_blocks, *project.data_types],
        project.tag_tables,
    ]
    for group in groups:
        found += _duplicates(source, group, "DIR102", lambda thing: thing.name.casefold())
    found += _duplicates(source, project.pous, "DIR103", lambda pou: pou.number and (pou.kind, pou.number))
    found += _duplicates(source, project.data_blocks, "DIR103", lambda block: block.number)
    if format_named(source.format)[0].tool == "TwinCAT":
        things: list[Pou | DataTypeDeclaration] = [*project.pous, *project.data_types]
        found += _duplicates(source, things, "DIR106", lambda thing: thing.object_id)
    return found


def _of_other_tools(source: FolderSource) -> Iterator[Diagnostic]:
    """Yield a finding for each format in which the folder has files that are no part of the project."""
    found: dict[str, list[str]] = {}
    for name in source.others:
        for kind in all_formats():
            like = PurePosixPath(name).suffix.casefold() in kind.extensions and kind.name != source.format
            if like and _is_document(kind, source.path, name):
                found.setdefault(kind.name, []).append(name)
                break
    for format, names in found.items():
        shown = ", ".join(names[:_SHOWN]) + (f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else "")
        message = f"the folder is a project of {source.format}; its files of {format} are no part of it"
        yield Diagnostic("DIR105", Severity.WARNING, f"{message}: {shown}", Location(source.path))


_SHOWN = 5
"""Names of files in a finding."""

T = TypeVar("T", bound=ProjectObject)


def _duplicates(
    source: FolderSource, things: Sequence[T], code: str, key: Callable[[T], Hashable | None]
) -> Iterator[Diagnostic]:
    """Yield objects that have the same `key` as one before them: its name, its number.

    A PLC has each name once: of two with one name the texts mean one, and which is not known. A conversion is refused.
    """
    first: dict[Hashable, T] = {}
    for thing in things:
        mine = key(thing)
        other = first.setdefault(mine, thing)
        if other is not thing and mine is not None:
            message = f"{thing.name} is declared in {_file(other)} too: one of them is an old copy, or of another PLC"
            shared = {"DIR103": "number", "DIR106": f"identity {mine}"}.get(code, "")
            if shared:
                message = f"{other.name}, in {_file(other)}, has the same {shared}"
            place = Location(str(Path(source.path, _file(thing))), None, None, thing.name)
            yield Diagnostic(code, Severity.WARNING if shared else Severity.ERROR, message, place)


def _file(thing: ProjectObject) -> str:
    place = place_in_folder(thing)
    return place[0] if place is not None else ""


def _place(error: SfcError, path: Path) -> Location:
    place = error.location
    return Location(place.file or str(path), place.line, place.column, place.path)


def save_folder(
    project: Project,
    folder: str,
    name: str,
    *,
    flavour: str = "",
    strict: bool = False,
    partial: bool = False,
    fresh: bool = False,
    normalize: bool = False,
    limit: float = 0,
    at_rest: Collection[str] = (),
) -> ConversionReport:
    """Save `project` in the format `name` into `folder`, which is made where it is missing.

    A project that was read from documents of this format keeps them: those without edits stay byte for byte as
    they are, an edit changes its lines. New objects get documents of their own. In the folder that the project was read
    from, a document is removed when its objects are. Everything is encoded before anything is written.

    Raises `LossError`; `FileAccessError`, also where a document to be changed was changed on the disk meanwhile.
    """
    kind, version = format_named(name)
    if not kind.folders:
        message = f"the target is a folder, not a file, and in the format {kind.name} a project is one file"
        raise FileAccessError(message, location=Location(folder), hint="Name a file inside it.")
    report = ConversionReport(project.source.format if project.source is not None else "", name, unchanged=True)
    source = _folder_source(project, kind)
    is_own = source is not None and source is project.source and _same_folder(source.path, folder)
    if source is None:
        planned, contents = _convert(project, kind, version, report, limit=limit, at_rest=at_rest)
    else:
        planned = plan_like(project, source, kind, is_own=is_own)
        contents = _encode(planned, source, name, report, flavour=flavour, fresh=fresh)
    if normalize:
        plain, contents = contents, {path: normalized(data, name) for path, data in contents.items()}
        report.unchanged = report.unchanged and contents == plain
    if not is_own:
        refuse_reading_errors(project, report)
    refuse_losses(report, strict=strict, partial=partial)
    before = {path: document.source.content for path, document in source.documents.items()} if is_own and source else {}
    gone = [path for path in before if path not in contents]
    if is_own:
        changed = {path: data for path, data in contents.items() if before.get(path) != data}
        _refuse_if_changed(folder, {path: before[path] for path in [*gone, *changed] if path in before})
    else:
        changed = {path: data for path, data in contents.items() if _on_disk(Path(folder, path)) != data}
    lists = _relisted(folder, kind, [path for path in changed if path not in before], gone) if is_own else {}
    _refuse_links_out_of(folder, [*changed, *lists, *gone])
    # files are removed last: a run that is interrupted leaves an object twice, not nowhere
    write_all({Path(folder, path): data for path, data in {**changed, **lists}.items()})
    for path in gone:
        Path(folder, path).unlink(missing_ok=True)
    report.unchanged = not changed and not gone if is_own else report.unchanged
    report.written += [str(Path(folder, path)) for path in (*changed, *lists)]
    report.removed += [str(Path(folder, path)) for path in gone]
    report.left_alone += [str(Path(folder, path)) for path in files_below(folder) if path not in {**contents, **lists}]
    if is_own and source is not None:
        _remember(project, source, planned, changed, gone)
    return report


def _relisted(folder: str, kind: Format, added: Sequence[str], gone: Sequence[str]) -> dict[str, bytes]:
    """Return the files that list the documents of the project (``.plcproj``), where others are there now."""
    lists = [
        path for path in files_below(folder) if kind.list_extension and path.casefold().endswith(kind.list_extension)
    ]
    found: dict[str, bytes] = {}
    for path in lists if added or gone else ():
        top = PurePosixPath(path).parent
        inside = [
            [str(PurePosixPath(each).relative_to(top)) for each in names if PurePosixPath(each).is_relative_to(top)]
            for names in (added, gone)
        ]
        data = read_bytes(Path(folder, path))
        after = cast("FolderCodec", kind.codec()).relisted(data, *inside)
        if after != data:
            found[path] = after
    return found


def edited_files(
    project: Project, path: str, report: ConversionReport | None = None
) -> Iterator[tuple[str, bytes, bytes]]:
    """Yield the changes of saving a project where it was read from: path, bytes before and after.

    A file that is not there has no bytes. `report` gets the items. Raises `LossError` as saving does.
    """
    source = project.source
    if isinstance(source, FileSource):
        yield path, source.content, encode(project, source.format, flavour="", fresh=False)[0]
    if not isinstance(source, FolderSource):
        return
    kind = format_named(source.format)[0]
    report = ConversionReport() if report is None else report
    after = _encode(
        plan_like(project, source, kind, is_own=True), source, source.format, report, flavour="", fresh=False
    )
    refuse_losses(report, strict=False, partial=False)
    before = {name: document.source.content for name, document in source.documents.items()}
    for name in sorted(before.keys() | after.keys()):
        if before.get(name) != after.get(name):
            yield str(Path(source.path, name)), before.get(name, b""), after.get(name, b"")


def _folder_source(project: Project, kind: Format) -> FolderSource | None:
    """Return the documents that the project was read from; None where they are of another format, or there are none."""
    source = project.source
    if isinstance(source, FolderSource) and source.format == kind.name:
        return source
    if not isinstance(source, FileSource) or source.format != kind.name:
        return None
    name = Path(source.path).name if source.path else f"{PROJECT_DOCUMENT}{kind.extensions[0]}"
    things = list(project.objects())
    for place, thing in enumerate(things):
        put_in_folder(thing, name, place, None)
    documents = {name: SourceDocument(without_objects(project), len(things))}
    return FolderSource(kind.name, source.version, "", documents, shared_fields(project), {}, [], [])


def _same_folder(one: str, other: str) -> bool:
    try:
        return Path(one).samefile(other)
    except OSError:
        return False


def _encode(
    planned: list[PlannedDocument],
    source: FolderSource,
    name: str,
    report: ConversionReport,
    *,
    flavour: str,
    fresh: bool,
) -> dict[str, bytes]:
    """Return the bytes of each document, by path."""

    def write(document: PlannedDocument) -> bytes:
        new = document.source is None and name == source.format
        alone = document.project()
        if new:  # of the tool that has the libraries and the other documents
            alone.source = FolderSource(source.format, source.version, source.path)
        wanted = f"{name}-{source.version}" if new and source.version else name
        data, found = encode(alone, wanted, flavour=flavour, fresh=fresh)
        report.extend(found.items)
        report.unchanged = report.unchanged and found.unchanged and document.path == document.source
        return data

    return _write_each(planned, write)


def _write_each(planned: list[PlannedDocument], write: Callable[[PlannedDocument], bytes]) -> dict[str, bytes]:
    """Return the bytes of each document, by path; raise one `OldVersionError` for all that need a newer version."""
    contents: dict[str, bytes] = {}
    refused: list[OldVersionError] = []
    for document in planned:
        try:
            contents[document.path] = write(document)
        except OldVersionError as error:
            refused.append(error)
    if refused:
        raise OldVersionError(refused[0].version, [need for error in refused for need in error.needs])
    return contents


def _convert(
    project: Project,
    kind: Format,
    version: str,
    report: ConversionReport,
    *,
    limit: float,
    at_rest: Collection[str],
) -> tuple[list[PlannedDocument], dict[str, bytes]]:
    """Convert a project of another format: adapt it as a whole, write its documents, read it back as a whole."""
    from plcopen_sfc.documents.writer_preparation import prepared  # noqa: PLC0415  # loading needs no interpreter

    codec = cast("FolderCodec", kind.codec())
    options = WriteOptions(version, at_rest=at_rest)
    copy, meant, options, behaviour = prepared(project, kind, options, report)
    if not copy.header.product:
        copy.header = meant.header = codec.new_document(version).header
    planned = plan_new(copy, kind, version)
    options = replace(options, whole=copy)

    def write(document: PlannedDocument) -> bytes:
        alone = document.project()  # it has copies of the objects, with ids of their own
        pairs = _pairs_of(alone.objects(), document.things)
        marks = {id(one): options.marks[id(thing)] for one, thing in pairs if id(thing) in options.marks}
        return codec.write(alone, replace(options, added=document.added, marks={**options.marks, **marks}), report)

    contents = _write_each(planned, write)
    for document in planned:
        if not document.added:
            place_objects(document.things, document.path)
            if meant is not copy:  # flags of the source, say, are in the conditions of the copy alone
                place_objects([one for one, _ in _pairs_of(meant.objects(), document.things)], document.path)
    verify(meant, kind, _read_back(contents, kind, version, as_tool=False), report)
    if behaviour is not None:
        seen = _read_back(contents, kind, version, as_tool=True)
        called = names_in_the_source(project, copy)
        report_behaviour(report, project, behaviour, seen, called, tool=kind.tool, limit=limit)
    report.unchanged = False
    return planned, contents


def _read_back(contents: dict[str, bytes], kind: Format, version: str, *, as_tool: bool) -> Project:
    """Return the project in the documents that are to be written."""
    back = FolderSource(kind.name, version, "", {}, {}, {}, [], [])
    things: list[ProjectObject] = []
    for path, data in contents.items():
        things += add_document(back, path, data, as_tool=as_tool)
    project = with_objects(merged(back.documents, kind), things)
    project.source = back
    return project


def _on_disk(path: Path) -> bytes | None:
    """Return the bytes of a file; None where there is none."""
    return read_bytes(path) if path_exists(path) else None


def _refuse_links_out_of(folder: str, paths: Iterable[str]) -> None:
    """Refuse to write through a link to a folder: reading does not follow it, and it may lead anywhere."""
    top = Path(os.path.realpath(folder))
    for path in paths:
        place = Path(folder, path).parent
        if not Path(os.path.realpath(place)).is_relative_to(top):
            raise FileAccessError(
                "the folder is a symbolic link that leads out of the folder of the project",
                location=Location(str(place)),
                hint="Nothing was written. Make it a folder, or save to another place.",
            )


def _refuse_if_changed(folder: str, expected: dict[str, bytes]) -> None:
    """Refuse to overwrite a file that was changed since the project was read."""
    for path, content in expected.items():
        if _on_disk(Path(folder, path)) not in (None, content):
            raise FileAccessError(
                "the file was changed since the project was read, and so was the project",
                location=Location(str(Path(folder, path))),
                hint="Nothing was written. Load the folder again and repeat the edit.",
            )


def _remember(
    project: Project, source: FolderSource, planned: list[PlannedDocument], changed: dict[str, bytes], gone: list[str]
) -> None:
    """The folder is what was written now: the next save changes what is edited from here on."""
    for path in gone:
        del source.documents[path]
    for document in planned:
        if document.path in changed:
            found = add_document(source, document.path, changed[document.path])
            saved = {(type(thing), thing.name): thing for thing in found}
            for thing in document.things:
                again = saved.get((type(thing), thing.name))
                if again is not None:
                    take_provenance(thing, again)
    source.shared = shared_fields(project)
