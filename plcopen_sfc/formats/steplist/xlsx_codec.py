"""Step lists as workbooks (``xlsx``): a sheet for each table. Needs openpyxl: ``pip install plcopen-sfc[tables]``."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from datetime import timedelta
from typing import TYPE_CHECKING, Any
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from plcopen_sfc.errors import FormatError, Location, SfcError, StructureError
from plcopen_sfc.formats.steplist.list_codec import ListCodec
from plcopen_sfc.formats.steplist.list_tables import Sheet, TableKind, cell_name
from plcopen_sfc.whole_numbers import whole_number

if TYPE_CHECKING:
    from openpyxl import Workbook
    from openpyxl.worksheet.worksheet import Worksheet

_WIDEST = 60


class XlsxCodec(ListCodec):
    """Step lists as workbooks."""

    def sheets(self, data: bytes, file: str | None = None) -> list[Sheet]:
        """Return the sheets of a workbook. Raises `StructureError` for a formula that was never calculated."""
        return _sheets(data, file)

    def encode(self, sheets: Sequence[Sheet], source: bytes) -> bytes:
        """Return a workbook; that of `source` keeps sheets and formats, and gets the cells that differ."""
        workbook = _opened(source, None) if source else _empty()
        before = {sheet.name: sheet.rows for sheet in self.sheets(source)} if source else {}
        for sheet in sheets:
            if sheet.name in before:
                _put(workbook[sheet.name], before[sheet.name], sheet.rows)
                continue
            page = workbook.create_sheet(sheet.name)
            _put(page, [], sheet.rows)
            _format(page, sheet.rows)
        if not workbook.sheetnames:
            workbook.create_sheet(TableKind.STEPS.value)
        written = io.BytesIO()
        workbook.save(written)
        return _without_times(written.getvalue())


def _without_times(data: bytes) -> bytes:
    """Return a workbook without the time of its making, so that the same list gives the same bytes."""
    result = io.BytesIO()
    with ZipFile(io.BytesIO(data)) as old, ZipFile(result, "w", ZIP_DEFLATED) as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "docProps/core.xml":
                content = re.sub(rb"<dcterms:(created|modified)\b.*?</dcterms:\1>", b"", content, flags=re.DOTALL)
            new.writestr(ZipInfo(name, _BEGINNING), content, ZIP_DEFLATED)
    return result.getvalue()


_BEGINNING = (1980, 1, 1, 0, 0, 0)
"""The first time that an archive can hold."""


def _empty() -> Workbook:
    workbook = _openpyxl().Workbook()
    workbook.remove(workbook.active)
    return workbook  # type: ignore[no-any-return]


def _opened(data: bytes, file: str | None, *, values: bool = False) -> Workbook:
    library = _openpyxl()
    try:
        return library.load_workbook(io.BytesIO(data), data_only=values)  # type: ignore[no-any-return]
    except Exception as error:  # a damaged archive, its XML, and whatever openpyxl stumbles over
        message = f"this workbook cannot be read: {error}"
        raise FormatError(message, location=Location(file), hint="Save it again as .xlsx.") from error


def _openpyxl() -> Any:
    try:
        import openpyxl  # noqa: PLC0415  # an extra
    except ImportError:
        hint = "pip install plcopen-sfc[tables]. Or save the list as CSV, which needs nothing."
        raise SfcError("workbooks need openpyxl", hint=hint) from None
    return openpyxl


def _sheets(data: bytes, file: str | None) -> list[Sheet]:
    """Return the texts of all cells; of a formula, what it had as value when the workbook was saved."""
    workbook = _opened(data, file)
    calculated: Workbook | None = None
    sheets = []
    for page in workbook.worksheets:
        rows: list[list[str]] = []
        for at, row in enumerate(page.iter_rows()):
            rows.append([])
            for place, cell in enumerate(row):
                value = cell.value
                if cell.data_type == "f":
                    calculated = calculated or _opened(data, file, values=True)
                    value = calculated[page.title].cell(at + 1, place + 1).value
                    if value is None:
                        path = f"{page.title}!{cell_name(at, place)}"
                        hint = "Save the workbook in a program that calculates it, or put the value in place of it."
                        where = Location(file, at + 1, place + 1, path)
                        raise StructureError("the value of this formula is not known", location=where, hint=hint)
                rows[-1].append(_text(value))
        sheets.append(Sheet(page.title, rows))
    return sheets


def _text(value: object) -> str:
    match value:
        case None:
            return ""
        case bool():
            return "TRUE" if value else "FALSE"
        case float() if value.is_integer():
            return str(int(value))
        case timedelta():
            return f"T#{round(value.total_seconds() * 1000)}ms"
        case _:
            return str(value)


def _put(page: Worksheet, before: Sequence[Sequence[str]], rows: Sequence[Sequence[str]]) -> None:
    """Put texts into the cells of a sheet where they differ from those `before`."""
    height = max(len(before), len(rows))
    width = max((len(row) for row in [*before, *rows]), default=0)
    for at in range(height):
        for place in range(width):
            old, new = (each[at][place] if at < len(each) and place < len(each[at]) else "" for each in (before, rows))
            if old != new:
                cell = page.cell(at + 1, place + 1)
                number = whole_number(new)
                is_number = number is not None and new == str(number)
                cell.value = number if is_number else new or None
                if new and not is_number:
                    cell.data_type = "s"  # never a formula
                    cell.quotePrefix = new[0] in "=+-@"  # nor when somebody edits it


def _format(page: Worksheet, rows: Sequence[Sequence[str]]) -> None:
    """Make a new sheet readable: bold headings that stay in sight, columns as wide as their texts."""
    from openpyxl.styles import Alignment, Font  # noqa: PLC0415  # an extra

    for place, heading in enumerate(rows[0] if rows else ()):
        page.cell(1, place + 1).font = Font(bold=True)
        texts = [line for row in rows for line in row[place].splitlines()]
        letters = cell_name(0, place)[:-1]
        page.column_dimensions[letters].width = min(_WIDEST, max(map(len, [heading, *texts])) + 2)
        for at, row in enumerate(rows):
            if "\n" in row[place]:
                page.cell(at + 1, place + 1).alignment = Alignment(wrap_text=True, vertical="top")
    page.freeze_panes = "A2"


CODEC = XlsxCodec()
