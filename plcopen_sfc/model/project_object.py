"""The objects of a project that have files of their own in some tools: POUs, data blocks, data types, tag tables."""

from __future__ import annotations

from typing import ClassVar

from plcopen_sfc.model.late import LateElement
from plcopen_sfc.model.owners import OwnedName


class ProjectObject(OwnedName, LateElement):
    """Common to the objects of a project.

    `folder` is where the object is among the files of its project, relative to the project's own folder, with ``/``
    between names (``Program blocks/Station 1``); empty for that folder itself, None where the project is one file.
    """

    name: str
    folder: str | None = None

    kind_in_reports: ClassVar[str] = ""
    """Word for such an object in messages and reports."""

    @property
    def report_path(self) -> str:
        """The object in the words of messages and reports: ``POU Main``, ``data block Settings``."""
        return f"{self.kind_in_reports} {self.name}"
