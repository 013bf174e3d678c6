"""Tables: aligned by blanks in a pipe, drawn by rich on a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from rich.table import Table as RichTable

__all__ = ["Table"]


@dataclass
class Table:
    """Headers and rows of texts and numbers; columns of numbers are aligned to the right.

    `short` are headers for narrow terminals. `total`: the last row is a sum.
    """

    headers: Sequence[str]
    short: Sequence[str] = ()
    rows: list[Sequence[str | int]] = field(default_factory=list)
    total: bool = False

    def plain(self) -> list[str]:
        """The lines of the table as text: columns two blanks apart, nothing cut off."""
        texts = [[str(cell) for cell in row] for row in (self.headers, *self.rows)]
        widths = [max(len(row[column]) for row in texts) for column in range(len(self.headers))]
        right = self._numbers()
        return [
            "  ".join(
                text.rjust(width) if number else text.ljust(width)
                for text, width, number in zip(row, widths, right, strict=True)
            ).rstrip()
            for row in texts
        ]

    def rich(self, width: int) -> RichTable:
        """The table for a terminal `width` characters wide, without the columns that hold nothing but zeros."""
        from rich import box  # noqa: PLC0415  # only where somebody looks
        from rich.table import Table as RichTable  # noqa: PLC0415
        from rich.text import Text  # noqa: PLC0415

        shown = [c for c in range(len(self.headers)) if not self.rows or any(row[c] != 0 for row in self.rows)]
        narrow = max(map(len, self.plain())) > width
        headers = self.short if narrow and self.short else self.headers
        numbers = self._numbers()
        table = RichTable(box=box.SIMPLE_HEAD, header_style="bold", pad_edge=False)
        for column in shown:
            side: Literal["right", "left"] = "right" if numbers[column] else "left"
            table.add_column(Text(headers[column]), justify=side, overflow="fold", no_wrap=numbers[column])
        for place, row in enumerate(self.rows, start=1):
            last = place == len(self.rows) and self.total
            if last:
                table.add_section()
            table.add_row(*(Text(str(row[column])) for column in shown), style="bold" if last else None)
        return table

    def _numbers(self) -> list[bool]:
        return [
            bool(self.rows) and all(isinstance(row[column], int) or row[column] == "-" for row in self.rows)
            for column in range(len(self.headers))
        ]
