"""A project document by document."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.documents.folders.merging import with_objects
from plcopen_sfc.documents.source import FolderSource
from plcopen_sfc.formats.provenance import place_in_folder
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.project_object import ProjectObject

__all__ = ["documents_of"]


def documents_of(project: Project) -> Iterator[Project]:
    """The documents that a project was read from, each as a project with the very objects that are in it.

    A project that was not read from a folder is its one document. Objects that are in no document come last.
    """
    source = project.source
    if not isinstance(source, FolderSource):
        yield project
        return
    things: dict[str, list[ProjectObject]] = {path: [] for path in source.documents}
    new: list[ProjectObject] = []
    for thing in project.objects():
        place = place_in_folder(thing)
        path = place[0] if place is not None else ""
        things.get(path, new).append(thing)
    for path, document in source.documents.items():
        yield with_objects(document.frame, things[path])
    if new:
        yield with_objects(Project(dialect=project.dialect), new)
