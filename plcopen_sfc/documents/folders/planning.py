"""Which document of a folder each object of a project stands in."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, cast

from plcopen_sfc.documents.folders.merging import SHARED, is_bare, with_objects
from plcopen_sfc.documents.folders.naming import FileNames, legal_folder
from plcopen_sfc.documents.source import FolderSource
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.provenance import as_in_file, place_in_folder
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.project_object import ProjectObject

if TYPE_CHECKING:
    from plcopen_sfc.formats.xml.xml_codec import FolderCodec

__all__ = ["PROJECT_DOCUMENT", "PlannedDocument", "plan_anew", "plan_like"]

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
        """The document as a project; which folder its objects stand in is for the path to say."""
        return with_objects(self.frame, (as_in_file(thing) for thing in self.things))


def plan_like(project: Project, source: FolderSource, kind: Format, *, home: bool) -> list[PlannedDocument]:
    """The documents of a project that was read from those of `source`: every object stays where it was.

    One whose `folder` was changed moves there: with its document if all objects of that do, else into one of its own.
    New objects get documents of their own. A document whose objects are all gone is not planned. `home`: the folder is
    the one that was read, with files that are none of the project's.
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
    names = FileNames([*source.others, *source.unreadable] if home else ())
    frames = _frames(project, source)
    planned: list[PlannedDocument] = []
    moving: list[PlannedDocument] = []
    for path, things in staying.items():
        document = source.documents[path]
        if document.objects and not things and _says_nothing(frames[path]):
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
        planned.append(_project_document(names, kind, frames[None]))
    planned += [
        PlannedDocument(_free_path(names, kind, thing), [thing], codec.new_document(source.version)) for thing in new
    ]
    return planned


def plan_anew(project: Project, kind: Format, version: str) -> list[PlannedDocument]:
    """A document for each object of a project, in the folders of the tool, and one for what belongs to no object."""
    names = FileNames()
    codec = cast("FolderCodec", kind.codec())
    planned: list[PlannedDocument] = []
    if not _says_nothing(project) or project.header != codec.new_document(version).header:
        planned.append(_project_document(names, kind, with_objects(project, ())))
    planned += [
        PlannedDocument(_free_path(names, kind, thing), [thing], codec.new_document(version))
        for thing in project.objects()
    ]
    for thing in codec.added_objects(project):
        path = _free_path(names, kind, thing)
        planned.append(PlannedDocument(path, [thing], codec.new_document(version), added=True))
    return planned


def _project_document(names: FileNames, kind: Format, frame: Project) -> PlannedDocument:
    return PlannedDocument(names.free("", PROJECT_DOCUMENT, kind.extensions[0]), [], frame)


def _free_path(names: FileNames, kind: Format, thing: ProjectObject) -> str:
    folder = thing.folder if thing.folder is not None else cast("FolderCodec", kind.codec()).standard_folder(thing)
    return names.free(legal_folder(folder), thing.name, kind.extensions[0])


def _parent(path: str) -> str:
    folder = PurePosixPath(path).parent.as_posix()
    return "" if folder == "." else folder


def _says_nothing(frame: Project) -> bool:
    """Whether a document has nothing but objects, so that it means nothing without them."""
    carried = frame.carried
    return is_bare(frame) and (carried is None or not (carried.elements or carried.data))


def _frames(project: Project, source: FolderSource) -> dict[str | None, Project]:
    """What is beside the objects of each document, with the edits of the project in it; None: of a new document.

    An edit of what belongs to the project goes into the document that had it, or the first that speaks for the project.
    """
    frames: dict[str | None, Project] = {path: document.frame for path, document in source.documents.items()}
    edited = [name for name in SHARED if getattr(project, name) != source.shared[name]]
    if not edited:
        return frames
    if "header" in edited:
        _edit_headers(frames, project, source)
        edited.remove("header")
    for name in edited:
        plain = Project.model_fields[name].get_default(call_default_factory=True)
        owner = next((path for path in frames if _content(frames[path], name) != plain), None)
        if owner is None:
            owner = next((path for path, document in source.documents.items() if not document.objects), None)
        if owner is None and owner not in frames:
            frames[None] = Project(dialect=project.dialect, header=project.header)
        for path, frame in frames.items():
            value = getattr(project, name) if path == owner else plain
            frames[path] = frame.model_copy(update={name: _carried(frame, value) if name == "carried" else value})
    return frames


def _content(frame: Project, name: str) -> Any:
    """The field `name` of a document, as far as it says something of the project."""
    value = getattr(frame, name)
    return None if name == "carried" and value is not None and not (value.data or value.elements) else value


def _carried(frame: Project, value: Carried | None) -> Carried | None:
    """What a document carries: its own attributes, and data and elements of the project."""
    if frame.carried is None:
        return value
    return Carried(
        attributes=frame.carried.attributes,
        data=value.data if value is not None else [],
        elements=value.elements if value is not None else [],
    )


def _edit_headers(frames: dict[str | None, Project], project: Project, source: FolderSource) -> None:
    """Put what was edited in the header of the project into those of all documents of the same tool.

    The version is that of each document: another one is written by saving in that version.
    """
    before = source.shared["header"]
    names = [name for name in type(before).model_fields if name not in ("version", "carried")]
    update = {name: value for name in names if (value := getattr(project.header, name)) != getattr(before, name)}
    for path, frame in frames.items():
        if frame.header.product == before.product:
            frames[path] = frame.model_copy(update={"header": frame.header.model_copy(update=update)})
