"""Common part of the codecs of step lists: files that are sheets of cells."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from plcopen_sfc.errors import FormatError, StructureError
from plcopen_sfc.formats.format_interface import Codec, ReadResult, WriteOptions
from plcopen_sfc.formats.steplist.list_reader import read_list
from plcopen_sfc.formats.steplist.list_tables import Sheet, laid_out
from plcopen_sfc.formats.steplist.list_writer import tables_of
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome


class ListCodec(Codec):
    """Reads and writes the sheets of a file."""

    @abstractmethod
    def sheets(self, data: bytes, file: str | None = None) -> list[Sheet]:
        """Return the sheets of a file. Raises `FormatError`."""

    @abstractmethod
    def encode(self, sheets: Sequence[Sheet], source: bytes) -> bytes:
        """Return the file with these sheets; in the form of `source`, where that is not empty."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a list. Raises `StructureError` where it has no table."""
        return read_list(self.sheets(data, file), file)

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write the tables of a project; into the list that it was read from, where there is one."""
        tables = tables_of(project, report)
        if not options.source:
            return self.encode(laid_out(tables, []), b"")
        old = self.sheets(options.source)
        known = tables_of(self.read(options.source).project, ConversionReport())
        data = self.encode(laid_out(tables, old, known), options.source)
        whole = self.encode(laid_out(tables, old), options.source)
        try:
            # a list that has its actions and transitions in other rows than those that are written of it
            return data if self.read(data).project == self.read(whole).project else whole
        except StructureError:
            raise
        except FormatError as error:  # a workbook with a margin of 400 digits: openpyxl reads it, and writes nothing
            why = f"its sheets are in a new file without its formats, which cannot be written again: {error.message}"
            report.add(Outcome.APPROXIMATED, "file", "", why)
            new = laid_out(tables, old)
            names = {sheet.name for sheet in new}
            return self.encode([*new, *(sheet for sheet in old if sheet.name not in names)], b"")
