"""Documents of a folder: what they hold beside their objects, their names, and the document of each object.

See docs/decisions/0012.
"""

from __future__ import annotations

import copy
import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, cast

from plcopen_sfc.documents.sources import FolderSource, SourceDocument, with_objects
from plcopen_sfc.errors import ModelError
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.provenance import as_in_file, place_in_folder
from plcopen_sfc.model.base import ExtensionData
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.project import FileHeader, Project

if TYPE_CHECKING:
    from plcopen_sfc.formats.xml.xml_codec import FolderCodec, ProjectPart


SHARED = tuple(name for name in Project.model_fields if name not in (*Project.OBJECTS, "dialect"))
"""The fields with what belongs to the project and to none of its objects."""


def without_objects(project: Project) -> Project:
    """Return a copy of `project` that has nothing but what is beside its objects."""
    return project.model_copy(update={name: [] for name in Project.OBJECTS})


def shared_fields(project: Project) -> dict[str, Any]:
    """Return the parts of the project itself, by the names of the fields; a copy."""
    return {name: copy.deepcopy(getattr(project, name)) for name in SHARED}


def is_bare(project: Project) -> bool:
    """True if a document has nothing of the project beside its objects and its header."""
    plain = Project()
    return all(
        getattr(project, name) == getattr(plain, name) for name in SHARED if name not in ("header", "extension_data")
    )


def merged(documents: dict[str, SourceDocument], kind: Format) -> Project:
    """Return a project without objects that has what all of `documents` have beside theirs."""
    frames = [document.frame for document in documents.values()]
    fields: dict[str, Any] = {}
    plain = Project()
    for name in SHARED:
        values = [value for frame in frames if (value := getattr(frame, name)) != getattr(plain, name)]
        if not values or name == "header":
            continue
        if name == "extension_data":
            fields[name] = _merged_extension_data(values)
        elif isinstance(values[0], list):
            fields[name] = [item for value in values for item in copy.deepcopy(value)]
        else:
            fields[name] = copy.deepcopy(values[0])
    fields["header"] = _header(documents, kind)
    fields["dialect"] = frames[0].dialect if frames else plain.dialect
    project = Project.model_validate({name: value for name, value in fields.items() if value is not None})
    cast("FolderCodec", kind.codec()).join(project)
    return project


def _header(documents: dict[str, SourceDocument], kind: Format) -> FileHeader:
    """Return the header of the document that speaks for the project, else what all documents agree on."""
    for document in documents.values():
        if not document.objects and not is_bare(document.frame):
            return document.frame.header.model_copy(deep=True)
    headers = [document.frame.header for document in documents.values()]
    agreed = _agreed([header.model_dump(exclude={"extension_data"}) for header in headers])
    agreed["version"] = newest(kind, [header.version for header in headers])
    return FileHeader.model_validate(agreed)


def newest(kind: Format, versions: Iterable[str]) -> str:
    """Return the newest of `versions` of a format."""
    order = {version: place for place, version in enumerate(kind.versions)}
    return max(versions, key=lambda version: order.get(version, -1), default="")


def _agreed(dumps: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the items that are in all of `dumps`."""
    first = dumps[0] if dumps else {}
    return {key: value for key, value in first.items() if all(dump.get(key) == value for dump in dumps)}


def _merged_extension_data(values: list[ExtensionData]) -> ExtensionData | None:
    """Return the extension data of the project in documents; their attributes describe the documents."""
    data = [item for value in values for item in value.data]
    elements = [item for value in values for item in value.elements]
    return ExtensionData(data=copy.deepcopy(data), elements=elements) if data or elements else None


_ILLEGAL = re.compile(r'[<>:"/\\|?*\x00-\x1f\x7f]')
_DEVICES = frozenset({"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))})
"""File names that Windows keeps for devices, whatever their extension."""
_LONGEST = 120
_MOST_BYTES = 200
"""File systems allow 255 bytes; the name gets an extension, and a number where it is taken."""


def file_stem(name: str) -> str:
    """Return `name` as the name of a file without extension: what no file system takes is replaced by ``_``."""
    # macOS stores umlauts decomposed: without one form the same name would be two files elsewhere.
    stem = _ILLEGAL.sub("_", unicodedata.normalize("NFC", name))[:_LONGEST]
    stem = stem.encode("utf-8", "replace")[:_MOST_BYTES].decode("utf-8", "ignore").strip().rstrip(".")
    if not stem or stem.partition(".")[0].casefold() in _DEVICES:
        stem = f"_{stem}"
    # hidden files are not read as part of a project
    return f"_{stem[1:]}" if stem.startswith(".") else stem


def legal_folder(folder: str) -> str:
    """Return `folder` with names that every file system takes; raise `ModelError` if it leads out of the project."""
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
        """Return a path in `folder` for an object called `name` that no other file has; it is taken from now on."""
        start = f"{folder}/" if folder else ""
        stem = file_stem(name)
        path, number = f"{start}{stem}{extension}", 1
        while self._same(path) in self._taken:
            number += 1
            path = f"{start}{stem}_{number}{extension}"
        self._taken.add(self._same(path))
        return path


PROJECT_DOCUMENT = "plcopen_sfc"
"""The name of the document with what belongs to no object; TIA Portal finds nothing to import in it."""


@dataclass
class PlannedDocument:
    """A document to be written: its path in the folder, its objects and what is beside them.

    `source`: the path of the document that it was read from, None for a new one. `added`: its objects are those that a
    codec adds for its tool.
    """

    path: str
    things: list[ProjectObject]
    frame: Project
    source: str | None = None
    added: bool = False

    def project(self) -> Project:
        """Return the document as a project; its path determines the folder of its objects."""
        return with_objects(self.frame, (as_in_file(thing) for thing in self.things))


def plan_like(project: Project, source: FolderSource, kind: Format, *, is_own: bool) -> list[PlannedDocument]:
    """Return the documents of a project that was read from those of `source`: every object stays where it was.

    One whose `folder` was changed moves there: with its document if all objects of that do, else into one of its own.
    New objects get documents of their own. A document whose objects are all gone is not planned. `is_own`: the folder
    is the one that was read, with files that do not belong to the project.
    """
    staying: dict[str, list[ProjectObject]] = {path: [] for path in source.documents}
    new: list[ProjectObject] = []
    claimed: set[tuple[str, int]] = set()
    for thing in project.objects():
        place = place_in_folder(thing)
        if place is None or place[0] not in staying or place in claimed:
            new.append(thing)  # a copy of an object knows the same place
        else:
            claimed.add(place)
            staying[place[0]].append(thing)
    names = FileNames([*source.others, *source.unreadable] if is_own else ())
    frames = _frames(project, source, kind)
    planned: list[PlannedDocument] = []
    moving: list[PlannedDocument] = []
    for path, things in staying.items():
        document = source.documents[path]
        was_of_objects = bool(document.objects) or not _has_objects_only(document.frame)
        if was_of_objects and not things and _has_objects_only(frames[path]):
            continue
        here = _parent(path)
        away = [thing for thing in things if thing.folder not in (None, here)]
        if away and len({thing.folder for thing in things}) == 1:
            moving.append(PlannedDocument(path, things, frames[path], path))
            continue
        new += away
        stay = [thing for thing in things if thing.folder in (None, here)]
        names.take(path)
        planned.append(PlannedDocument(path, stay, frames[path], path))
    for document_moved in moving:
        old = PurePosixPath(document_moved.path)
        folder = legal_folder(document_moved.things[0].folder or "")
        document_moved.path = names.free(folder, old.stem, old.suffix)
    planned += moving
    codec = cast("FolderCodec", kind.codec())
    if None in frames:
        planned += _project_documents(names, kind, frames[None])
    planned += [
        PlannedDocument(_free_path(names, kind, thing), [thing], codec.new_document(source.version)) for thing in new
    ]
    return planned


def plan_new(project: Project, kind: Format, version: str) -> list[PlannedDocument]:
    """Plan a document for each object of a project, in the folders of the tool, and one for what has no object."""
    names = FileNames()
    codec = cast("FolderCodec", kind.codec())
    planned: list[PlannedDocument] = []
    if not _has_objects_only(project) or project.header != codec.new_document(version).header:
        planned += _project_documents(names, kind, with_objects(project, ()))
    planned += [
        PlannedDocument(_free_path(names, kind, thing), [thing], codec.new_document(version))
        for thing in project.objects()
    ]
    for thing in codec.added_objects(project):
        path = _free_path(names, kind, thing)
        planned.append(PlannedDocument(path, [thing], codec.new_document(version), added=True))
    return planned


def _project_documents(names: FileNames, kind: Format, frame: Project) -> list[PlannedDocument]:
    """Plan documents for what belongs to no object: one, or one for each part."""
    codec = cast("FolderCodec", kind.codec())
    parts = codec.parts(frame)
    if parts is None:
        return [PlannedDocument(names.free("", PROJECT_DOCUMENT, kind.extensions[0]), [], frame)]
    return [
        PlannedDocument(names.free(part.folder, part.name, codec.extension(part.document)), [], part.document)
        for part in parts
    ]


def _free_path(names: FileNames, kind: Format, thing: ProjectObject) -> str:
    codec = cast("FolderCodec", kind.codec())
    folder = thing.folder if thing.folder is not None else codec.standard_folder(thing)
    extension = codec.extension(with_objects(Project(), [thing])) or kind.extensions[0]
    return names.free(legal_folder(folder), thing.name, extension)


def _parent(path: str) -> str:
    folder = PurePosixPath(path).parent.as_posix()
    return "" if folder == "." else folder


def _has_objects_only(frame: Project) -> bool:
    """True if a document has nothing but objects, so that it means nothing without them."""
    extension_data = frame.extension_data
    return is_bare(frame) and (extension_data is None or not (extension_data.elements or extension_data.data))


def _frames(project: Project, source: FolderSource, kind: Format) -> dict[str | None, Project]:
    """Return each document without its objects, with the edits of the project in it; None: a new document.

    An edit of what belongs to the project goes into the document that had it, or the first that speaks for the project.
    """
    frames: dict[str | None, Project] = {path: document.frame for path, document in source.documents.items()}
    edited = [name for name in SHARED if getattr(project, name) != source.shared[name]]
    if not edited:
        return frames
    if "header" in edited:
        _edit_headers(frames, project, source)
        edited.remove("header")
    parts = cast("FolderCodec", kind.codec()).parts(project) if edited else None
    if parts is not None:
        _edit_parts(frames, parts, kind)
        edited = [name for name in edited if name not in PART_FIELDS]
    for name in edited:
        plain = Project.model_fields[name].get_default(call_default_factory=True)
        owner = next((path for path in frames if _content(frames[path], name) != plain), None)
        if owner is None:
            owner = next((path for path, document in source.documents.items() if not document.objects), None)
        if owner is None and owner not in frames:
            frames[None] = Project(dialect=project.dialect, header=project.header)
        for path, frame in frames.items():
            value = getattr(project, name) if path == owner else plain
            frames[path] = frame.model_copy(
                update={name: _edited_extension_data(frame, value) if name == "extension_data" else value}
            )
    return frames


def _edit_parts(frames: dict[str | None, Project], parts: list[ProjectPart], kind: Format) -> None:
    """Put the parts of a project into the documents that have those of their names; None: all that are new."""
    codec = cast("FolderCodec", kind.codec())

    def key(part: ProjectPart) -> tuple[str, str]:
        return codec.extension(part.document), part.name

    homes = {key(part): path for path, frame in frames.items() for part in codec.parts(frame) or ()}
    plain = Project()
    emptied = {name: getattr(plain, name) for name in PART_FIELDS}
    for path in homes.values():
        frames[path] = frames[path].model_copy(update=emptied)
    for part in parts:
        path = homes.get(key(part))
        frame = frames.get(path) or part.document.model_copy(update=emptied)
        added = {name: [*getattr(frame, name), *getattr(part.document, name)] for name in PART_FIELDS}
        frames[path] = frame.model_copy(update=added)


PART_FIELDS = ("global_variables", "applications")
"""The fields with what belongs to no object and has documents of its own in some tools."""


def _content(frame: Project, name: str) -> Any:
    """Return the field `name` of a document, as far as it belongs to the project."""
    value = getattr(frame, name)
    return None if name == "extension_data" and value is not None and not (value.data or value.elements) else value


def _edited_extension_data(frame: Project, value: ExtensionData | None) -> ExtensionData | None:
    """Return the extension data of a document: its own attributes, and data and elements of the project."""
    if frame.extension_data is None:
        return value
    return ExtensionData(
        attributes=frame.extension_data.attributes,
        data=value.data if value is not None else [],
        elements=value.elements if value is not None else [],
    )


def _edit_headers(frames: dict[str | None, Project], project: Project, source: FolderSource) -> None:
    """Put what was edited in the header of the project into those of all documents of the same tool.

    The version is that of each document: another one is written by saving in that version.
    """
    before = source.shared["header"]
    names = [name for name in type(before).model_fields if name not in ("version", "extension_data")]
    update = {name: value for name in names if (value := getattr(project.header, name)) != getattr(before, name)}
    for path, frame in frames.items():
        if frame.header.product == before.product:
            frames[path] = frame.model_copy(update={"header": frame.header.model_copy(update=update)})
