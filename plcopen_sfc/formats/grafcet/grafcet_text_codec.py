"""GRAFCETs as text: read, write, and put edits into the text."""

from __future__ import annotations

import re

from plcopen_sfc.formats.format_interface import ReadResult, TextCodec, WriteOptions
from plcopen_sfc.formats.grafcet.grafcet_text_reader import read_text
from plcopen_sfc.formats.grafcet.grafcet_text_writer import write_blocks
from plcopen_sfc.formats.text_patch import BlockSpan, SourceText, WrittenBlock, decode_text
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport

_OWN_LINES = re.compile(r"^[ \t]*// *\{plcopen_sfc[^\r\n]*(?:\r\n|\r|\n)?", re.MULTILINE)


class GrafcetTextCodec(TextCodec):
    """GRAFCETs as text."""

    def decode(self, content: bytes) -> SourceText:
        """Return the text of a file, and its encoding."""
        return decode_text(content)

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a text. Raises `StructureError` at a line that is none of a GRAFCET."""
        found = read_text(self.decode(data), file)
        return ReadResult(found.project, found.diagnostics)

    def as_tool_sees(self, data: bytes, *, file: str | None = None) -> bytes:
        """Return the text without comments of this package."""
        source = self.decode(data)
        return source.encode(_OWN_LINES.sub("", source.text))[0]

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        """Return the line of each object of the text."""
        return read_text(self.decode(content)).lines

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a whole text in UTF-8."""
        return (self.to_blocks(project, options, report).whole() + "\n").encode("utf-8", errors="replace")

    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        """Return the text of a project, in the blocks that an edit replaces."""
        return write_blocks(project, report)

    def spans(self, content: bytes) -> tuple[SourceText, BlockSpan]:
        """Return the text of a file, and the place of each object in it."""
        source = self.decode(content)
        return source, read_text(source).spans


CODEC = GrafcetTextCodec()
