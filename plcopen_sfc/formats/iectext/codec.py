"""Textual IEC 61131-3: read and write, and the pieces for patching."""

from __future__ import annotations

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import EncodingError, Location
from plcopen_sfc.formats.base import Reading, TextCodec, WriteOptions
from plcopen_sfc.formats.iectext.compiled import compiled_text
from plcopen_sfc.formats.iectext.lines import source_lines
from plcopen_sfc.formats.iectext.project_reader import read_project
from plcopen_sfc.formats.iectext.project_writer import write_project
from plcopen_sfc.formats.iectext.slices import file_slices
from plcopen_sfc.formats.iectext.tool_view import without_own_pragmas
from plcopen_sfc.formats.matiec.fitting import fit_project
from plcopen_sfc.formats.text import Piece, Slice, SourceText, decode
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport

_MOST_NULS = 8


class IecTextCodec(TextCodec):
    """Textual IEC 61131-3."""

    def read(self, data: bytes, *, file: str | None = None) -> Reading:
        """Read a text. Raises `FormatError`; what is wrong inside of it is in the diagnostics."""
        source = decode(data)
        if source.text.count("\0") > len(source.text) // _MOST_NULS:
            hint = "UTF-16 needs a byte order mark."
            raise EncodingError("this is no text: it is full of NUL bytes", location=Location(file, 1, 1), hint=hint)
        project, src = read_project(source.text, file)
        if source.guessed:
            message = f"not UTF-8; taken as {source.encoding}, which is a guess"
            src.diagnostics.append(Diagnostic("IEC200", Severity.WARNING, message, Location(file)))
        return Reading(project, src.diagnostics)

    def as_tool_sees(self, data: bytes, *, file: str | None = None) -> bytes:
        """The file without pragmas of ours."""
        return without_own_pragmas(data)

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        """The line of each object in the text `content`, by the path that the report gives it."""
        return source_lines(decode(content).text)

    def to_pieces(self, project: Project, options: WriteOptions, report: ConversionReport) -> Piece:
        """The text of a project by its objects."""
        return write_project(project, options, report)

    def slices(self, content: bytes) -> tuple[SourceText, Slice]:
        """Where those objects stand in the text of a file."""
        source = decode(content)
        project, src = read_project(source.text, None)
        return source, file_slices(project, src, self.to_pieces(project, WriteOptions(), ConversionReport()))

    def fit(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Change `project`, a copy, into what matiec executes."""
        fit_project(project, options, report)

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a text anew; for matiec, of a project that was fitted."""
        if options.flavour:
            return compiled_text(project).encode()
        return (write_project(project, options, report).whole() + "\n").encode()


CODEC = IecTextCodec()
