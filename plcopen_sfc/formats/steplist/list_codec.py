"""Codecs of step lists: files that are sheets of cells, and those that are text (``csv``).

A text has semicolons, commas or tabs between the cells, and its tables below each other.
"""

from __future__ import annotations

import csv
import io
import re
from abc import abstractmethod
from collections.abc import Sequence

from plcopen_sfc.errors import FormatError, Location, StructureError
from plcopen_sfc.formats.format_interface import Codec, ReadResult, WriteOptions
from plcopen_sfc.formats.steplist.list_reader import read_list
from plcopen_sfc.formats.steplist.list_tables import Sheet, laid_out
from plcopen_sfc.formats.steplist.list_writer import tables_of
from plcopen_sfc.formats.text_encoding import SourceText, decode_text
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


_DELIMITERS = ";,\t"
_FORMULA = re.compile(r"'*[=+\-@\t\r]")
"""Start of a cell that a program of tables takes for a formula, and that has an apostrophe in front in the file."""
_QUOTED = re.compile(r"'+[=+\-@\t\r]")


class CsvCodec(ListCodec):
    """Step lists as text: one sheet without a name."""

    def sheets(self, data: bytes, file: str | None = None) -> list[Sheet]:
        """Return the one sheet of a text."""
        return [_sheet(decode_text(data), file)]

    def encode(self, sheets: Sequence[Sheet], source: bytes) -> bytes:
        """Return the tables below each other; with the delimiter, line ends and encoding of `source`."""
        old = decode_text(source) if source else SourceText("", "utf-8-sig")
        lines: list[Sequence[str]] = []
        for sheet in sheets:
            lines += [[], *sheet.rows] if lines else sheet.rows
        text = io.StringIO()
        newline = old.newline if source else "\r\n"
        writer = csv.writer(text, delimiter=_delimiter(old.text), lineterminator=newline)
        writer.writerows([f"'{cell}" if _FORMULA.match(cell) else cell for cell in line] for line in lines)
        mark = "\ufeff" if old.text.startswith("\ufeff") else ""  # without it nobody reads UTF-16
        return old.encode(mark + text.getvalue())[0]


def _sheet(source: SourceText, file: str | None) -> Sheet:
    """Return the rows of a text, and the lines in which they begin."""
    text = source.text.removeprefix("\ufeff")
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=_delimiter(text), strict=True)
    rows, lines, line = [], [], 1
    try:
        while (row := next(reader, None)) is not None:
            rows.append(row)
            lines.append(line)
            line = reader.line_num + 1
    except csv.Error as error:
        hint = "A cell with quotation marks is in quotation marks, and they are doubled in it."
        raise StructureError(f"this is no CSV: {error}", location=Location(file, line), hint=hint) from error
    return Sheet("", [[cell[1:] if _QUOTED.match(cell) else cell for cell in row] for row in rows], lines or [1])


def _delimiter(text: str) -> str:
    """Return the delimiter that is most frequent in the first line that has one."""
    counts = ({each: line.count(each) for each in _DELIMITERS} for line in text.splitlines())
    first = next((each for each in counts if any(each.values())), {";": 1})
    return max(first, key=lambda each: first[each])


CODEC = CsvCodec()
