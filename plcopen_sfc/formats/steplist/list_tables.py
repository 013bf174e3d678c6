"""Tables of a step list: their columns, and where in the sheets of a file they are.

A table begins with a row of headings and ends before an empty row. The order of its
columns is free. A column with another heading is not read, and keeps its cells when the list is written again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple


class TableKind(StrEnum):
    """Tables of a list: the steps of charts, variables (an I/O list), and actions of programs."""

    STEPS = "Steps"
    VARIABLES = "Variables"
    ACTIONS = "Actions"


class ListColumn(NamedTuple):
    """A column: its heading, other headings that mean the same, and True if a new list has it in any case."""

    heading: str
    others: tuple[str, ...] = ()
    usual: bool = False


_PROGRAM = ListColumn("Program", ("POU", "Block", "Programm", "Baustein"), usual=True)
_COMMENT = ListColumn("Comment", ("Kommentar",), usual=True)

COLUMNS: Mapping[TableKind, tuple[ListColumn, ...]] = {
    TableKind.STEPS: (
        _PROGRAM,
        ListColumn("Step", ("Step name", "Schritt", "Schrittname"), usual=True),
        ListColumn("Number", ("No.", "No", "Nr.", "Nr", "Nummer"), usual=True),
        ListColumn("Initial", ("Initial step", "Initialschritt"), usual=True),
        _COMMENT,
        ListColumn("Qualifier", ("Bestimmungszeichen", "Kennung"), usual=True),
        ListColumn("Action", ("Aktion",), usual=True),
        ListColumn("Time", ("Zeit", "Duration", "Dauer"), usual=True),
        ListColumn("Event", ("Ereignis",)),
        ListColumn("Interlocked", ("Verriegelt",)),
        ListColumn("Min time", ("Minimum time", "Mindestzeit")),
        ListColumn("Max time", ("Maximum time", "Überwachungszeit")),
        ListColumn("Warning time", ("Warnzeit",)),
        ListColumn("Interlock", ("Verriegelung",)),
        ListColumn("Supervision", ("Überwachung",)),
        ListColumn("Transition", ("Transition name",)),
        ListColumn("Condition", ("Bedingung", "Weiterschaltbedingung"), usual=True),
        ListColumn("Next", ("Next step", "Folgeschritt", "Nächster Schritt", "Weiter"), usual=True),
        ListColumn("Priority", ("Priorität",), usual=True),
        ListColumn("Simultaneous", ("Simultaneous group", "Simultan", "Parallel"), usual=True),
        ListColumn("Transition comment", ("Kommentar der Transition",)),
    ),
    TableKind.VARIABLES: (
        _PROGRAM,
        ListColumn("Variable", ("Tag", "Symbol", "Signal"), usual=True),
        ListColumn("Section", ("Scope", "Abschnitt"), usual=True),
        ListColumn("Type", ("Data type", "Typ", "Datentyp"), usual=True),
        ListColumn("Address", ("Adresse",), usual=True),
        ListColumn("Initial value", ("Initial", "Anfangswert", "Startwert")),
        _COMMENT,
    ),
    TableKind.ACTIONS: (
        _PROGRAM,
        ListColumn("Action", ("Aktion",), usual=True),
        ListColumn("Statements", ("Code", "Anweisungen"), usual=True),
        _COMMENT,
    ),
}
"""The columns of each table."""

_NEEDED = {
    TableKind.STEPS: ({"Step"}, {"Condition", "Next", "Action"}),
    TableKind.VARIABLES: ({"Variable"}, {"Type", "Address"}),
    TableKind.ACTIONS: ({"Action"}, {"Statements"}),
}
"""Columns that the headings of a table have: all of the first, one of the others."""


NAMES = {TableKind.STEPS: "Step", TableKind.VARIABLES: "Variable", TableKind.ACTIONS: "Action"}
"""The columns with the names of what the rows are about."""


@dataclass(frozen=True)
class Sheet:
    """A sheet of a file: its name, and the texts of its cells, row by row. `lines` are those of the rows in a text."""

    name: str
    rows: Sequence[Sequence[str]]
    lines: Sequence[int] = ()


@dataclass(frozen=True)
class TableRow:
    """A row of a table: its texts by the headings of `COLUMNS`, and its place in the sheet, from 0."""

    texts: Mapping[str, str]
    place: int = 0

    def __getitem__(self, heading: str) -> str:
        return self.texts.get(heading, "").strip()

    def has_any(self, *headings: str) -> bool:
        """True if one of these cells has a text."""
        return any(self[heading] for heading in headings)


@dataclass(frozen=True)
class ListTable:
    """A table in a sheet. `columns` are the places of its columns, `start` is the row of the headings."""

    kind: TableKind
    rows: list[TableRow]
    sheet: Sheet = field(default_factory=lambda: Sheet("", []))
    start: int = 0
    columns: Mapping[str, int] = field(default_factory=dict)

    @property
    def end(self) -> int:
        """The row behind the last one."""
        return self.start + 1 + len(self.rows)

    @property
    def unknown(self) -> list[tuple[int, str]]:
        """Columns that are not read: their places and headings."""
        headings = self.sheet.rows[self.start]
        return [
            (at, text.strip()) for at, text in enumerate(headings) if text.strip() and at not in self.columns.values()
        ]


def tables_in(sheets: Sequence[Sheet]) -> Iterator[ListTable]:
    """Find the tables in the sheets of a file."""
    for sheet in sheets:
        at = 0
        while at < len(sheet.rows):
            found = _headings(sheet.rows[at])
            if found is None:
                at += 1
                continue
            kind, columns = found
            start, at = at, at + 1
            rows: list[TableRow] = []
            while at < len(sheet.rows) and any(map(str.strip, sheet.rows[at])):
                row = sheet.rows[at]
                rows.append(TableRow({name: row[place] for name, place in columns.items() if place < len(row)}, at))
                at += 1
            yield ListTable(kind, rows, sheet, start, columns)


class UnreadRow(NamedTuple):
    """A row outside of the tables of a sheet: its place, that of its first text, and True if it is data of a table."""

    place: int
    column: int
    is_data: bool


def unread_rows(sheet: Sheet) -> Iterator[UnreadRow]:
    """Yield the rows outside of the tables of a sheet that can be rows of a table.

    Below a table, a row with a text in a column of that table other than its first one is data: an empty row ended the
    table. Other rows there are notes; the title of the next table is left out. Where no table is above, a row with
    several texts can be one of headings, and one of them is told.
    """
    done, above = 0, None
    for table in (*tables_in([sheet]), None):
        end = table.start if table is not None else len(sheet.rows)
        for at in range(done, end):
            texts = [place for place, text in enumerate(sheet.rows[at]) if text.strip()]
            if above is None and len(texts) > 1:
                yield UnreadRow(at, texts[0], is_data=False)
                break
            if above is None or not texts:
                continue
            data = sorted(set(above.columns.values()).intersection(texts) - {min(above.columns.values())})
            if data or table is None or at + 1 < end:
                yield UnreadRow(at, (data or texts)[0], is_data=bool(data))
        if table is not None:
            done, above = table.end, table


def _headings(row: Sequence[str]) -> tuple[TableKind, dict[str, int]] | None:
    """Return the table that begins with these headings, and the places of its columns."""
    for kind, (all_of, one_of) in _NEEDED.items():
        columns: dict[str, int] = {}
        for place, text in enumerate(row):
            name = _HEADINGS[kind].get(" ".join(text.split()).casefold())
            if name is not None:
                columns.setdefault(name, place)
        if all_of <= columns.keys() and one_of & columns.keys():
            return kind, columns
    return None


_HEADINGS = {
    kind: {name.casefold(): column.heading for column in reversed(columns) for name in (column.heading, *column.others)}
    for kind, columns in COLUMNS.items()
}


def laid_out(tables: Sequence[ListTable], sheets: Sequence[Sheet], known: Sequence[ListTable] = ()) -> list[Sheet]:
    """Return the sheets of a file with `tables` in them: in place of those in `sheets`, which keep all else.

    `known` are the tables that would be written of the project in `sheets`. Where a cell is the same there, that of the
    sheet stays, however it is written. So do cells of columns that are not read, beside their row.
    """
    waiting = {table.kind: table for table in tables}
    before = {table.kind: table for table in known}
    result: list[Sheet] = []
    for sheet in sheets:
        rows: list[Sequence[str]] = []
        done = 0
        for old in tables_in([sheet]):
            new = waiting.pop(old.kind, ListTable(old.kind, []))  # a second table of a kind goes into the first
            rows += [*sheet.rows[done : old.start], *_rows(new, old, before.get(old.kind))]
            done = old.end
        result.append(Sheet(sheet.name, [*rows, *sheet.rows[done:]]))
    added = [table for table in waiting.values() if table.rows]
    return result + [Sheet(table.kind.value, _rows(table, None, None)) for table in added]


def _rows(table: ListTable, old: ListTable | None, known: ListTable | None) -> list[list[str]]:
    headings = list(old.sheet.rows[old.start]) if old is not None else []
    columns = dict(old.columns) if old is not None else {}
    cells_of = dict(_old_cells(old, known)) if old is not None else {}
    written = dict(_keyed(known)) if known is not None else {}
    rows = list(_keyed(table))
    if table.kind is not TableKind.STEPS:  # whose order has a meaning
        places = {key: at for at, key in enumerate(cells_of)}
        rows.sort(key=lambda row: places.get(row[0], len(places)))
    for column in COLUMNS[table.kind]:
        name = column.heading
        is_new = any(row[name] != (written[key][name] if key in written else "") for key, row in rows)
        if name not in columns and (is_new or (old is None and column.usual)):
            columns[name] = len(headings)
            headings.append(name)
    result = [headings]
    for key, row in rows:
        cells = cells_of.get(key, [])
        result.append([*cells, *[""] * (len(headings) - len(cells))])
        for name, place in columns.items():
            is_same = key in cells_of and key in written and written[key][name] == row[name]
            if not is_same or place >= len(cells):
                result[-1][place] = row.texts.get(name, "")
    return result


def _old_cells(old: ListTable, known: ListTable | None) -> Iterator[tuple[tuple[str, ...], list[str]]]:
    """Yield the rows of a table in a sheet with the keys that they have in the table that is written of it."""
    rows = [list(old.sheet.rows[row.place]) for row in old.rows]
    keys = [key for key, _ in _keyed(known)] if known is not None else []
    if old.kind is TableKind.STEPS:
        if len(keys) == len(rows):
            yield from zip(keys, rows, strict=True)
        return
    by_name = {key[1]: key for key in keys}
    for row, cells in zip(old.rows, rows, strict=True):
        key = by_name.pop(row[NAMES[old.kind]].casefold(), None)
        if key is not None:
            yield key, cells


def _keyed(table: ListTable) -> Iterator[tuple[tuple[str, ...], TableRow]]:
    """Yield the rows of a table with what tells them apart: program, name, and which row of that it is."""
    name = NAMES[table.kind]
    program, thing, count = "", "", 0
    for row in table.rows:
        program = row["Program"].casefold() or (program if table.kind is TableKind.STEPS else "")
        if row[name]:
            thing, count = row[name].casefold(), 0
        yield (program, thing, str(count)), row
        count += 1


def cell_name(row: int, column: int) -> str:
    """Return the name of a cell, ``C5``; row and column count from 0."""
    letters, column = "", column + 1
    while column:
        column, letter = divmod(column - 1, 26)
        letters = chr(ord("A") + letter) + letters
    return f"{letters}{row + 1}"
