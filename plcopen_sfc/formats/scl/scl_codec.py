"""External source files in SCL: read, write, and put edits into the text."""

from __future__ import annotations

from plcopen_sfc.formats.format_interface import ReadResult, TextCodec, WriteOptions
from plcopen_sfc.formats.scl.scl_reader import OWN_COMMENT, read_source
from plcopen_sfc.formats.scl.scl_writer import write_pieces
from plcopen_sfc.formats.text_patch import BlockSpan, SourceText, WrittenBlock, decode_text
from plcopen_sfc.languages.declarations import split_units
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.edits import without
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport


class SclCodec(TextCodec):
    """External source files in SCL."""

    def decode(self, content: bytes) -> SourceText:
        """Return the text of a file, and its encoding."""
        return decode_text(content)

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a source. What does not parse is kept and reported."""
        found = read_source(self.decode(data), file)
        return ReadResult(found.project, found.diagnostics)

    def as_tool_sees(self, data: bytes, *, file: str | None = None) -> bytes:
        """Return the source without comments of this package."""
        source = self.decode(data)
        comments = split_units(source.text, Dialect.SCL).comments
        own = [comment.span for comment in comments if OWN_COMMENT.match(comment.text)]
        return source.encode(without(source.text, own))[0] if own else data

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a whole source: in UTF-8 with a byte order mark and CRLF, as TIA Portal does."""
        text = self.to_blocks(project, options, report).whole() + "\n"
        return text.replace("\n", "\r\n").encode("utf-8-sig", errors="replace")

    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        """Return the text of a project, in the pieces that an edit replaces."""
        return write_pieces(project, report)

    def spans(self, content: bytes) -> tuple[SourceText, BlockSpan]:
        """Return the text of a source, and the place of each object in it."""
        source = self.decode(content)
        return source, read_source(source).spans


CODEC = SclCodec()
