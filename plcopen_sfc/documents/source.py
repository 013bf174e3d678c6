"""What a project was read from: one file, or a folder of documents."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from plcopen_sfc.diagnostics import Diagnostic
    from plcopen_sfc.errors import SfcError
    from plcopen_sfc.model.project import Project

__all__ = ["FileSource", "FolderSource", "SourceDocument"]


@dataclass
class FileSource:
    """The file that a project was read from; what saving needs to write only the edits.

    `fingerprint` is that of the project as it was read. `path` is None for bytes without a name. `errors_accepted`:
    see `Project.accept_errors`.
    """

    format: str
    version: str
    content: bytes
    fingerprint: bytes
    path: str | None
    diagnostics: list[Diagnostic]
    errors_accepted: bool = False

    def __repr__(self) -> str:
        place = f"{self.path}, " if self.path else ""
        return f"FileSource({place}{self.format} {self.version}, {len(self.content):,} bytes)"

    def accept_errors(self) -> None:
        """See `Project.accept_errors`."""
        self.errors_accepted = True

    def __deepcopy__(self, memo: dict[int, Any]) -> FileSource:
        """Copies of a project come from the same file."""
        return replace(self)


class SourceDocument(NamedTuple):
    """One document of a folder: a project with what is beside its objects, and how many objects it has."""

    frame: Project
    objects: int

    @property
    def source(self) -> FileSource:
        """What the document was read from."""
        if not isinstance(self.frame.source, FileSource):
            raise TypeError("a document is read from one file")
        return self.frame.source


@dataclass
class FolderSource:
    """The folder that a project was read from; what saving needs to touch changed files only.

    `path` is the folder, `documents` are by their path in it. `version` is the newest of theirs. `shared` is what the
    project has beside its objects, as it was read. `unreadable` are documents that could not be read, and why; `others`
    the files that are none of the project's.
    """

    format: str
    version: str
    path: str
    documents: dict[str, SourceDocument] = field(default_factory=dict)
    shared: dict[str, Any] = field(default_factory=dict)
    unreadable: dict[str, SfcError] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)
    own_diagnostics: list[Diagnostic] = field(default_factory=list)
    errors_accepted: bool = False

    def __repr__(self) -> str:
        return f"FolderSource({self.path}, {self.format} {self.version}, {len(self.documents)} documents)"

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """Findings about the folder, and about its documents."""
        of_documents = (document.source.diagnostics for document in self.documents.values())
        return [*self.own_diagnostics, *chain.from_iterable(of_documents)]

    def accept_errors(self) -> None:
        """See `Project.accept_errors`."""
        self.errors_accepted = True
        for document in self.documents.values():
            document.source.accept_errors()

    def __deepcopy__(self, memo: dict[int, Any]) -> FolderSource:
        """Copies of a project come from the same files, but each is saved by itself."""
        return replace(self, documents=dict(self.documents))
