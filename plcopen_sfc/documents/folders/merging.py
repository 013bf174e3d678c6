"""What several documents say beside their objects, in one project."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from typing import Any

from plcopen_sfc.documents.source import SourceDocument
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.project import FileHeader, Project
from plcopen_sfc.model.project_object import ProjectObject

__all__ = ["SHARED", "is_bare", "merged", "shared_fields", "with_objects", "without_objects"]

SHARED = tuple(name for name in Project.model_fields if name not in (*Project.OBJECTS, "dialect"))
"""The fields with what belongs to the project and to none of its objects."""


def without_objects(project: Project) -> Project:
    """A copy of `project` that has nothing but what is beside its objects."""
    return project.model_copy(update={name: [] for name in Project.OBJECTS})


def with_objects(frame: Project, things: Iterable[ProjectObject]) -> Project:
    """A copy of `frame` with `things`, in their order."""
    lists: dict[str, list[ProjectObject]] = {name: [] for name in Project.OBJECTS}
    for thing in things:
        lists[_LIST_OF[type(thing).__name__]].append(thing)
    return frame.model_copy(update=lists)


_LIST_OF = {"TagTable": "tag_tables", "DataTypeDeclaration": "data_types", "DataBlock": "data_blocks", "Pou": "pous"}


def shared_fields(project: Project) -> dict[str, Any]:
    """What belongs to the project itself, by the names of the fields; a copy."""
    return {name: copy.deepcopy(getattr(project, name)) for name in SHARED}


def is_bare(project: Project) -> bool:
    """Whether a document says nothing of the project beside its objects and its header."""
    plain = Project()
    return all(getattr(project, name) == getattr(plain, name) for name in SHARED if name not in ("header", "carried"))


def merged(documents: dict[str, SourceDocument], kind: Format) -> Project:
    """A project without objects that says what all of `documents` say beside theirs."""
    frames = [document.frame for document in documents.values()]
    fields: dict[str, Any] = {}
    plain = Project()
    for name in SHARED:
        values = [value for frame in frames if (value := getattr(frame, name)) != getattr(plain, name)]
        if not values or name == "header":
            continue
        if name == "carried":
            fields[name] = _carried(values)
        elif isinstance(values[0], list):
            fields[name] = [item for value in values for item in copy.deepcopy(value)]
        else:
            fields[name] = copy.deepcopy(values[0])
    fields["header"] = _header(documents, kind)
    fields["dialect"] = frames[0].dialect if frames else plain.dialect
    return Project.model_validate({name: value for name, value in fields.items() if value is not None})


def _header(documents: dict[str, SourceDocument], kind: Format) -> FileHeader:
    """That of the document which speaks for the project, else what all documents agree on."""
    for document in documents.values():
        if not document.objects and not is_bare(document.frame):
            return document.frame.header.model_copy(deep=True)
    headers = [document.frame.header for document in documents.values()]
    agreed = _common([header.model_dump(exclude={"carried"}) for header in headers])
    agreed["version"] = newest(kind, [header.version for header in headers])
    return FileHeader.model_validate(agreed)


def newest(kind: Format, versions: Iterable[str]) -> str:
    """The newest of `versions` of a format."""
    order = {version: place for place, version in enumerate(kind.versions)}
    return max(versions, key=lambda version: order.get(version, -1), default="")


def _common(dumps: list[dict[str, Any]]) -> dict[str, Any]:
    """The items that are in all of `dumps`."""
    first = dumps[0] if dumps else {}
    return {key: value for key, value in first.items() if all(dump.get(key) == value for dump in dumps)}


def _carried(values: list[Carried]) -> Carried | None:
    """What documents carry for the project; their attributes describe the documents."""
    data = [item for value in values for item in value.data]
    elements = [item for value in values for item in value.elements]
    return Carried(data=copy.deepcopy(data), elements=elements) if data or elements else None
