"""A project document by document."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.folders.merging import with_objects
from plcopen_sfc.model.project import FolderOrigin, Project
from plcopen_sfc.model.project_object import ProjectObject

__all__ = ["documents_of"]


def documents_of(project: Project) -> Iterator[Project]:
    """The documents that a project was read from, each as a project with the very objects that are in it.

    A project that was not read from a folder is its one document. Objects that are in no document come last.
    """
    origin = project._origin
    if not isinstance(origin, FolderOrigin):
        yield project
        return
    things: dict[str, list[ProjectObject]] = {path: [] for path in origin.documents}
    new: list[ProjectObject] = []
    for thing in project.objects():
        path = thing._home[0] if thing._home is not None else ""
        things.get(path, new).append(thing)
    for path, document in origin.documents.items():
        yield with_objects(document.frame, things[path])
    if new:
        yield with_objects(Project(dialect=project.dialect), new)
