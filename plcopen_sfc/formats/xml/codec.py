"""What the codecs of all XML formats share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from lxml import etree

from plcopen_sfc.formats.base import Codec, WriteOptions
from plcopen_sfc.formats.xml import tool_view, writing
from plcopen_sfc.formats.xml.writing import XmlStyle
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.project_object import ProjectObject
from plcopen_sfc.report import ConversionReport

__all__ = ["FolderCodec", "XmlCodec"]


class XmlCodec(Codec):
    """Reads and writes an XML format, whose files can be patched."""

    @abstractmethod
    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """The tree of the file for `project`."""

    @abstractmethod
    def style(self) -> XmlStyle:
        """How the tool writes XML."""

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a file anew."""
        return writing.write(self.to_tree(project, options, report), self.style())

    def as_tool_sees(self, data: bytes, *, file: str | None = None) -> bytes:
        """The file without data and comments of this package."""
        return tool_view.as_tool_sees(data, file=file)


class FolderCodec(XmlCodec):
    """Reads and writes a format in which a folder of files is one project."""

    @abstractmethod
    def standard_folder(self, thing: ProjectObject) -> str:
        """Where an object belongs that has no folder yet."""

    @abstractmethod
    def new_document(self, version: str) -> Project:
        """A project without objects."""

    def added_objects(self, project: Project) -> Sequence[ProjectObject]:
        """Objects for the tool that `project` has otherwise, and that are none of its own when they are read again."""
        return ()
