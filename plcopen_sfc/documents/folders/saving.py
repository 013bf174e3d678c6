"""Writing a project into a folder: into the documents that it was read from, or one document for each object."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

from plcopen_sfc.conversion import compare, executed, report_execution
from plcopen_sfc.documents.file import (
    encode,
    names_in_the_source,
    normalized,
    prepared,
    refuse_losses,
    refuse_reading_errors,
    verify,
)
from plcopen_sfc.documents.folders.loading import add_document, files_below, settle
from plcopen_sfc.documents.folders.merging import merged, shared_fields, with_objects, without_objects
from plcopen_sfc.documents.folders.planning import PROJECT_DOCUMENT, PlannedDocument, plan_anew, plan_like
from plcopen_sfc.documents.source import FileSource, FolderSource, SourceDocument
from plcopen_sfc.errors import FileAccessError, Location, OldVersionError
from plcopen_sfc.files import read_bytes, write_all
from plcopen_sfc.formats.format_interface import Format, WriteOptions
from plcopen_sfc.formats.provenance import put_in_folder, take_provenance
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.project_object import ProjectObject
from plcopen_sfc.report import ConversionReport

if TYPE_CHECKING:
    from plcopen_sfc.formats.xml.xml_codec import FolderCodec

__all__ = ["edited_files", "save_folder"]


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
) -> ConversionReport:
    """Save `project` in the format `name` into `folder`, which is made where it is missing.

    A project that was read from documents of this format keeps them: those that nobody edited stay byte for byte as
    they are, an edit changes its lines. New objects get documents of their own. In the folder that the project was read
    from, a document is removed when its objects are. Everything is encoded before anything is written.

    Raises `LossError`; `FileAccessError`, also where a document to be changed was changed on the disk meanwhile.
    """
    kind, version = format_named(name)
    if not kind.folders:
        message = f"the target is a folder, not a file, and in the format {kind.name} a project is one file"
        raise FileAccessError(message, location=Location(folder), hint="Name a file inside it.")
    report = ConversionReport(project.source.format if project.source is not None else "", name, unchanged=True)
    source = _documents_of(project, kind)
    home = source is not None and source is project.source and _same_folder(source.path, folder)
    if source is None:
        planned, contents = _convert(project, kind, version, report, limit)
    else:
        planned = plan_like(project, source, kind, home=home)
        contents = _encode(planned, source, name, report, flavour=flavour, fresh=fresh)
    if normalize:
        plain, contents = contents, {path: normalized(data, name) for path, data in contents.items()}
        report.unchanged = report.unchanged and contents == plain
    if not home:
        refuse_reading_errors(project, report)
    refuse_losses(report, strict=strict, partial=partial)
    before = {path: document.source.content for path, document in source.documents.items()} if home and source else {}
    gone = [path for path in before if path not in contents]
    if home:
        changed = {path: data for path, data in contents.items() if before.get(path) != data}
        _refuse_if_changed(folder, {path: before[path] for path in [*gone, *changed] if path in before})
    else:
        changed = {path: data for path, data in contents.items() if _on_disk(Path(folder, path)) != data}
    write_all({Path(folder, path): data for path, data in changed.items()})
    for path in gone:
        Path(folder, path).unlink(missing_ok=True)
    report.unchanged = not changed and not gone if home else report.unchanged
    report.written += [str(Path(folder, path)) for path in changed]
    report.removed += [str(Path(folder, path)) for path in gone]
    report.left_alone += [str(Path(folder, path)) for path in files_below(folder) if path not in contents]
    if home and source is not None:
        _remember(project, source, planned, changed, gone)
    return report


def edited_files(project: Project, path: str) -> Iterator[tuple[str, bytes, bytes]]:
    """What saving a project to the file or folder that it was read from would change: path, bytes before and after.

    A file that is not there has no bytes.
    """
    source = project.source
    if isinstance(source, FileSource):
        yield path, source.content, encode(project, source.format, flavour="", fresh=False)[0]
    if not isinstance(source, FolderSource):
        return
    kind = format_named(source.format)[0]
    report = ConversionReport()
    after = _encode(plan_like(project, source, kind, home=True), source, source.format, report, flavour="", fresh=False)
    before = {name: document.source.content for name, document in source.documents.items()}
    for name in sorted(before.keys() | after.keys()):
        if before.get(name) != after.get(name):
            yield str(Path(path, name)), before.get(name, b""), after.get(name, b"")


def _documents_of(project: Project, kind: Format) -> FolderSource | None:
    """The documents that the project was read from; None where they are of another format, or there are none."""
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
    """The bytes of each document, by path."""

    def write(document: PlannedDocument) -> bytes:
        wanted = name if document.source is not None or name != source.format else f"{name}-{source.version}"
        data, found = encode(document.project(), wanted, flavour=flavour, fresh=fresh)
        report.extend(found.items)
        report.unchanged = report.unchanged and found.unchanged and document.path == document.source
        return data

    return _write_each(planned, write)


def _write_each(planned: list[PlannedDocument], write: Callable[[PlannedDocument], bytes]) -> dict[str, bytes]:
    """The bytes of each document, by path. Raises one `OldVersionError` for all documents that need a newer version."""
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
    project: Project, kind: Format, version: str, report: ConversionReport, limit: float
) -> tuple[list[PlannedDocument], dict[str, bytes]]:
    """The documents of a project of another format: adapted as a whole, written one by one, read back as a whole."""
    codec = cast("FolderCodec", kind.codec())
    options = WriteOptions(version)
    copy, _, options, behaviour = prepared(project, kind, options, report)
    if not copy.header.product:
        copy.header = codec.new_document(version).header
    planned = plan_anew(copy, kind, version)
    options = replace(options, whole=copy)
    contents = _write_each(
        planned, lambda document: codec.write(document.project(), replace(options, added=document.added), report)
    )
    for document in planned:
        if not document.added:
            settle(document.things, document.path)
    verify(copy, kind, _read_back(contents, kind, version, as_tool=False), report)
    if behaviour is not None:
        seen = _read_back(contents, kind, version, as_tool=True)
        called = names_in_the_source(project, copy)
        report_execution(report, compare(behaviour, executed(seen, lists=behaviour.lists)), kind.tool, called)
        if limit:
            from plcopen_sfc.conversion.running import report_running  # noqa: PLC0415  # brings the interpreter

            report_running(report, project, seen, called, tool=kind.tool, target=None, limit=limit)
    report.unchanged = False
    return planned, contents


def _read_back(contents: dict[str, bytes], kind: Format, version: str, *, as_tool: bool) -> Project:
    """The project in the documents that are to be written."""
    back = FolderSource(kind.name, version, "", {}, {}, {}, [], [])
    things: list[ProjectObject] = []
    for path, data in contents.items():
        things += add_document(back, path, data, as_tool=as_tool)
    return with_objects(merged(back.documents, kind), things)


def _on_disk(path: Path) -> bytes | None:
    """The bytes of a file; None where there is none."""
    return read_bytes(path) if path.exists() else None


def _refuse_if_changed(folder: str, expected: dict[str, bytes]) -> None:
    """Refuse to overwrite what somebody else wrote since the project was read."""
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
