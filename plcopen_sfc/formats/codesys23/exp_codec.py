"""``.EXP`` files: read, write, and put edits into the text."""

from __future__ import annotations

from plcopen_sfc.formats.codesys23.code_pages import decode_export
from plcopen_sfc.formats.codesys23.exp_outline import OWN_LINE
from plcopen_sfc.formats.codesys23.exp_reader import read_export
from plcopen_sfc.formats.codesys23.exp_writer import replace_line_comments, write_blocks, write_export
from plcopen_sfc.formats.codesys23.later_language import replace_later_language
from plcopen_sfc.formats.format_interface import Marks, ReadResult, TextCodec, WriteOptions
from plcopen_sfc.formats.text_patch import BlockSpan, SourceText, WrittenBlock
from plcopen_sfc.languages.edits import without
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport

SOURCE = "source"
"""Name of the project beside its copy in the terms of the tool."""


class ExpCodec(TextCodec):
    """Exports of CoDeSys 2.3 and TwinCAT 2."""

    def decode(self, content: bytes) -> SourceText:
        """Return the text of a file, and its code page."""
        return decode_export(content)

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file. What does not parse is kept and reported."""
        found = read_export(self.decode(data), file)
        return ReadResult(found.project, found.diagnostics)

    def as_tool_sees(self, data: bytes, *, file: str | None = None) -> bytes:
        """Return the file without comments of this package."""
        source = self.decode(data)
        own = [found.span() for found in OWN_LINE.finditer(source.text)]
        return source.encode(without(source.text, own))[0] if own else data

    def rewrite(self, project: Project, options: WriteOptions, report: ConversionReport) -> tuple[Project, Marks]:
        """Return a copy of `project` with charts as CODESYS executes them, and the source beside it."""
        from plcopen_sfc.formats.plcopen.chart_hosts import ChartHost  # noqa: PLC0415  # not needed to read
        from plcopen_sfc.formats.plcopen.project_rewriting import rewrite_project  # noqa: PLC0415

        copy, _ = rewrite_project(
            project, ChartHost("CoDeSys 2.3", is_codesys=True, has_tasks=False, il_conditions=True), options, report
        )
        return copy, {id(copy): {SOURCE: project}}

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a whole file with CRLF, in the code page that has its characters."""
        text, page = write_export(project, options.marks.get(id(project), {}).get(SOURCE, project), report)
        return f"\n{text}\n".replace("\n", "\r\n").encode(page, errors="replace")

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Write comments as CoDeSys 2.3 has them, and report what it does not compile."""
        replace_line_comments(project, report)
        replace_later_language(project, report)

    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        """Return the text of a project, in the blocks that an edit replaces."""
        return write_blocks(project, project, report)

    def spans(self, content: bytes) -> tuple[SourceText, BlockSpan]:
        """Return the text of a file, and the place of each object in it."""
        source = self.decode(content)
        return source, read_export(source).spans


CODEC = ExpCodec()
