"""Tables of new names: CSV files and workbooks with a path and a new name in each row, for `rename_many`."""

from __future__ import annotations

from pathlib import Path

from plcopen_sfc.errors import Location, StructureError
from plcopen_sfc.files import read_bytes
from plcopen_sfc.formats.steplist import list_codec, xlsx_codec

_HEADINGS = frozenset({("old", "new"), ("path", "name"), ("alt", "neu"), ("old name", "new name")})
_WANTED = "A row has the path, such as Main.S3, and the new name: Main.S3;Fill. Further columns are for people."


def read_names(path: str | Path) -> dict[str, str]:
    """Return the new names by the paths of what gets them, from the first two columns of a CSV file or a workbook.

    Empty rows and one with headings (``old``, ``new``) are left out. Raises `StructureError` where a row lacks a path
    or a name, or a path has two names.
    """
    is_workbook = str(path).casefold().endswith(".xlsx")
    codec = xlsx_codec.CODEC if is_workbook else list_codec.CODEC
    table: dict[str, str] = {}
    for sheet in codec.sheets(read_bytes(str(path)), str(path)):
        for number, row in zip(sheet.lines or range(1, len(sheet.rows) + 1), sheet.rows, strict=False):
            old, new = (cell.strip() for cell in [*row, "", ""][:2])
            if (not old and not new) or (not table and (old.casefold(), new.casefold()) in _HEADINGS):
                continue
            place = Location(str(path), number, None, f"{sheet.name}!{number}" if sheet.name else None)
            if not old or not new:
                raise StructureError(f"this row has no {'new name' if old else 'path'}", location=place, hint=_WANTED)
            if table.setdefault(old, new) != new:
                raise StructureError(f"{old} gets two names: {table[old]} and {new}", location=place, hint=_WANTED)
    if not table:
        raise StructureError("this table has no names", location=Location(str(path)), hint=_WANTED)
    return table
