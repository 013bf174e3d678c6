"""Codec of a text format, whose files can be patched: see `text_patch`."""

from __future__ import annotations

from abc import abstractmethod

from plcopen_sfc.formats.format_interface import Codec, WriteOptions
from plcopen_sfc.formats.text_encoding import SourceText, decode_text
from plcopen_sfc.formats.text_patch import BlockSpan, WrittenBlock
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport


class TextCodec(Codec):
    """Reads and writes a text format. New files have `encoding` and `newline`."""

    encoding = "utf-8"
    newline = "\n"

    def decode(self, content: bytes) -> SourceText:
        """Return the text of a file, and its encoding."""
        return decode_text(content)

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a whole file; characters that its encoding does not have are replaced."""
        text = self.to_blocks(project, options, report).whole() + "\n"
        return text.replace("\n", self.newline).encode(self.encoding, errors="replace")

    def as_tool_sees(self, data: bytes, *, file: str | None = None) -> bytes:
        """Return the file without what only this package reads."""
        source = self.decode(data)
        text = self.without_own_comments(source.text)
        return source.encode(text)[0] if text != source.text else data

    def without_own_comments(self, text: str) -> str:
        """Return the text of a file without comments of this package."""
        return text

    @abstractmethod
    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        """Return the text of a project, object by object."""

    @abstractmethod
    def located(self, content: bytes) -> tuple[Project, SourceText, BlockSpan]:
        """Return the project in a file, its text, and the places of the objects in that."""
