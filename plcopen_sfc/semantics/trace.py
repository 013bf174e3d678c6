"""Records of a simulation: the values of variables and the active steps, scan by scan."""

from __future__ import annotations

import csv
import io
import os
import re
import unicodedata
from array import array
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias, TypeVar, overload

from plcopen_sfc.errors import ModelError
from plcopen_sfc.files import write_atomic
from plcopen_sfc.languages.st.literals import time_literal
from plcopen_sfc.operations import provided
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value
from plcopen_sfc.version import __version__

SCAN_COLUMN = "scan no"
TIME_COLUMN = "time ms"
ACTIVE_COLUMN = "active steps"
"""Headers of CSV files that are no variables: none can have a blank in its name."""

_Item = TypeVar("_Item")
_MILLISECOND = 1_000_000
_BOOL = Signal.elementary("BOOL")


class _Runs(Sequence[_Item]):
    """A sequence that keeps a value only where it changes: long recordings take memory by what happens in them."""

    __slots__ = ("_scans", "_starts", "_values")

    def __init__(self) -> None:
        self._starts = array("Q")
        self._values: list[_Item] = []
        self._scans = [0]  # in a trace one for all columns

    @property
    def _length(self) -> int:
        return self._scans[0]

    def note(self, value: _Item) -> None:
        """The value from the next scan on; somebody else counts the scans."""
        if not self._values or self._values[-1] != value:
            self._starts.append(self._scans[0])
            self._values.append(value)

    def append(self, value: _Item) -> None:
        """Add the value of the next scan."""
        self.note(value)
        self._scans[0] += 1

    def share(self, scans: list[int]) -> None:
        """Take the scans from another counter."""
        self._scans = scans

    def runs(self) -> Iterator[tuple[int, _Item]]:
        """Yield every value with the scan from which on it holds."""
        return zip(self._starts, self._values, strict=True)

    def __len__(self) -> int:
        return self._length

    @overload
    def __getitem__(self, index: int) -> _Item: ...
    @overload
    def __getitem__(self, index: slice) -> list[_Item]: ...
    def __getitem__(self, index: int | slice) -> _Item | list[_Item]:
        """The value of a scan (negative: from the end), or the values of several."""
        if isinstance(index, slice):
            return [self[each] for each in range(*index.indices(self._length))]
        place = index + self._length if index < 0 else index
        if not 0 <= place < self._length:
            raise IndexError(f"the trace has no scan {index}: it has {self._length}")
        return self._values[bisect_right(self._starts, place) - 1]

    def __iter__(self) -> Iterator[_Item]:
        ends = [*self._starts[1:], self._length] if self._starts else []
        for start, end, value in zip(self._starts, ends, self._values, strict=True):
            for _ in range(end - start):
                yield value

    def __eq__(self, other: object) -> bool:
        """Equal values, scan by scan; the other side may be a list or tuple."""
        if isinstance(other, _Runs):
            return (self._length, self._starts, self._values) == (other._length, other._starts, other._values)
        return isinstance(other, list | tuple) and list(self) == list(other)

    __hash__ = None  # type: ignore[assignment]  # grows


class Column(_Runs[Value]):
    """The values of one variable, scan by scan: ``column[5]``, ``list(column)``, ``column == [0, 0, 1]``."""

    __slots__ = ("direction", "name", "signal")

    def __init__(self, name: str, signal: Signal, direction: str = "") -> None:
        super().__init__()
        self.name = name
        self.signal = signal
        self.direction = direction

    def __repr__(self) -> str:
        return f"<Column {self.name}: {self.signal.type}, {len(self)} scans, {len(self._values)} runs>"


@dataclass(frozen=True, slots=True)
class ValueChange:
    """A variable has another value from `scan` on (0: its first value)."""

    scan: int
    name: str
    value: Value


class Trace:
    """A recording: one row for each scan, with the values at its end (inputs: during it).

    Scan 0 is the first. Times are integer nanoseconds since the start. `name` is what was simulated, `profile` the name
    of the execution profile, `steps` the paths of all steps, `macros` those of macro-steps. `ended` is the error that
    ended the run before its last scan, empty where none did.
    """

    def __init__(
        self,
        columns: Iterable[Column],
        *,
        scan_time: int,
        steps: Sequence[str] = (),
        macros: Sequence[str] = (),
        name: str = "",
        profile: str = "",
    ) -> None:
        self.name = name
        self.profile = profile
        self.scan_time = scan_time
        self.steps = tuple(steps)
        self.macros = tuple(macros)
        self.ended = ""
        self._columns = {column.name.casefold(): column for column in columns}
        self._list = list(self._columns.values())
        self._marking: _Runs[int] = _Runs()
        self._scans = [0]
        self._last: tuple[Value, ...] = ()
        self._marking.share(self._scans)
        for column in self._list:
            column.share(self._scans)

    def record(self, values: Sequence[Value], marking: int = 0, *, scans: int = 1) -> None:
        """Add rows: a value for each column in their order, and the active steps as bits in the order of `steps`."""
        row = tuple(values)
        if row != self._last:
            for column, value in zip(self._list, row, strict=True):
                column.note(value)
            self._last = row
        self._marking.note(marking)
        self._scans[0] += scans

    # -- questions

    def __len__(self) -> int:
        """Return how many scans there are."""
        return len(self._marking)

    def __getitem__(self, name: str) -> Column:
        """The values of a variable; case does not matter. Raises `ModelError` where it was not recorded."""
        column = self._columns.get(name.casefold())
        if column is None:
            known = ", ".join(each.name for each in self._list[:20]) + (" .." if len(self._list) > 20 else "")
            raise ModelError(f"{name!r} was not recorded", hint=f"Recorded: {known}" if known else "Nothing was.")
        return column

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name.casefold() in self._columns

    @property
    def columns(self) -> tuple[Column, ...]:
        """The recorded variables."""
        return tuple(self._list)

    def active(self, scan: int) -> tuple[str, ...]:
        """Return the paths of the steps that are active at the end of a scan; -1 is the last."""
        return self._names(self._marking[scan])

    def is_active(self, step: str) -> list[bool]:
        """True if a step is active, scan by scan. Raises `ModelError` where there is no such step."""
        folded = [path.casefold() for path in self.steps]
        if step.casefold() not in folded:
            raise ModelError(f"the trace has no step {step!r}", hint="Its steps are: " + ", ".join(self.steps[:20]))
        bit = 1 << folded.index(step.casefold())
        return [bool(marking & bit) for marking in self._marking]

    def time(self, scan: int) -> int:
        """Return when a scan ran, in nanoseconds since the first; -1 is the last. Raises `IndexError`."""
        place = scan + len(self) if scan < 0 else scan
        if not 0 <= place < len(self):
            raise IndexError(f"the trace has no scan {scan}: it has {len(self)}")
        return place * self.scan_time

    def changes(self, *names: str) -> list[ValueChange]:
        """Return every change of the variables with these names, or of all, in the order of the scans."""
        columns = [self[name] for name in names] if names else self._list
        found = [(scan, i, ValueChange(scan, c.name, value)) for i, c in enumerate(columns) for scan, value in c.runs()]
        return [change for _, _, change in sorted(found, key=lambda each: each[:2])]

    def situations(self) -> list[tuple[int, tuple[str, ...]]]:
        """Return the situations that the chart went through: the active steps, and the scan from which on they are."""
        return [(scan, self._names(marking)) for scan, marking in self._marking.runs()]

    def row(self, scan: int) -> dict[str, Value]:
        """Return the values of all variables in one scan."""
        return {column.name: column[scan] for column in self._list}

    def __eq__(self, other: object) -> bool:
        """The same steps and columns with the same values."""
        if not isinstance(other, Trace):
            return NotImplemented
        same = (self.steps, self.scan_time, list(self._columns)) == (other.steps, other.scan_time, list(other._columns))
        return same and self._marking == other._marking and self._list == other._list

    __hash__ = None  # type: ignore[assignment]  # grows

    def __repr__(self) -> str:
        return f"<Trace of {self.name or 'a chart'}: {len(self)} scans, {len(self._list)} variables>"

    # -- as text

    def headers(self) -> list[str]:
        """Return the headers of `rows`."""
        steps = [ACTIVE_COLUMN] if self.steps else []
        return ["scan", "time", *steps, *(column.name for column in self._list)]

    def rows(self, scans: Iterable[int]) -> Iterator[list[str]]:
        """Yield the rows of a table for people, for these scans."""
        for scan in scans:
            steps = [" ".join(self.active(scan)) or "-"] if self.steps else []
            values = [column.signal.text(column[scan]) for column in self._list]
            yield [str(scan), time_literal(self.time(scan)).removeprefix("T#"), *steps, *values]

    def eventful_scans(self) -> list[int]:
        """Return the scans in which anything changed, the first and the last."""
        scans = {scan for column in self._list for scan, _ in column.runs()}
        scans.update(scan for scan, _ in self._marking.runs())
        return sorted(scans | {len(self) - 1}) if len(self) else []

    def __str__(self) -> str:
        """A table of the scans in which something changed."""
        return "\n".join(aligned([self.headers(), *self.rows(self.eventful_scans())]))

    def as_dict(self) -> dict[str, Any]:
        """Return the trace as plain data, for JSON: every column as ``[scan, value]`` where its value changes."""
        return {
            "name": self.name,
            "profile": self.profile,
            "scan_time_ns": self.scan_time,
            "scans": len(self),
            "steps": list(self.steps),
            "situations": [[scan, list(active)] for scan, active in self.situations()],
            "columns": [
                {
                    "name": column.name,
                    "type": column.signal.type,
                    "direction": column.direction,
                    "changes": [[scan, _plain(value)] for scan, value in column.runs()],
                }
                for column in self._list
            ],
        }

    def to_records(self) -> list[dict[str, Any]]:
        """The trace as a table: a dictionary for each scan, with the same keys in all; ``pandas.DataFrame`` takes it.

        Keys: `scan`, `time` (nanoseconds), `steps` (the active ones), and the variables.
        """
        columns = [[*column] for column in self._list]
        return [
            {"scan": scan, "time": self.time(scan), "steps": self.active(scan)}
            | {column.name: values[scan] for column, values in zip(self._list, columns, strict=True)}
            for scan in range(len(self))
        ]

    def csv(self, *, delimiter: str = ";") -> str:
        """Return the trace as CSV: a row for each scan with its number, its time, the active steps and all values.

        `simulate` takes such a file as inputs again.
        """
        text = io.StringIO()
        writer = csv.writer(text, delimiter=delimiter, lineterminator="\n")
        steps = [ACTIVE_COLUMN] if self.steps else []
        writer.writerow([SCAN_COLUMN, TIME_COLUMN, *steps, *(column.name for column in self._list)])
        columns = [[column.signal.text(value) for value in column] for column in self._list]
        situations = [[" ".join(self._names(marking)) for marking in self._marking]] if self.steps else []
        scans = range(len(self))
        times = [_milliseconds(scan * self.scan_time) for scan in scans]
        writer.writerows(zip(scans, times, *situations, *columns, strict=True))
        return text.getvalue()

    def save_csv(self, path: str | os.PathLike[str], *, delimiter: str = ";") -> None:
        """Write `csv` in UTF-8 with byte order mark, which spreadsheets want. Raises `FileAccessError`."""
        write_atomic(path, self.csv(delimiter=delimiter).encode("utf-8-sig"))

    def vcd(self) -> str:
        """Return the trace as value change dump (IEEE 1364-2005, 18), for GTKWave and the like."""
        return dump(self.name, self._recordings(), scans=len(self), scan_time=self.scan_time)

    def _recordings(self) -> Iterator[Recording]:
        """Yield the variables and the steps, which are ``steps.Fill`` there."""
        for column in self.columns:
            yield column.name, column.signal, column.runs()
        for bit, path in enumerate(self.steps):
            yield f"steps.{path}", _BOOL, self._step_runs(bit)

    def _step_runs(self, bit: int) -> Iterator[tuple[int, Value]]:
        before: bool | None = None
        for scan, marking in self.markings():
            active = bool(marking >> bit & 1)
            if active is not before:
                yield scan, active
            before = active

    def save_vcd(self, path: str | os.PathLike[str]) -> None:
        """Write `vcd`. Raises `FileAccessError`."""
        write_atomic(path, self.vcd().encode())

    def to_svg(self, *, theme: str = "light") -> str:
        """Draw a timing diagram: the steps that become active, inputs and outputs, as the text of an SVG file.

        `theme` is ``light``, ``dark`` or ``print``. Raises `ModelError` for any other.
        """
        picture: str = provided("trace_svg")(self, theme)
        return picture

    def _repr_svg_(self) -> str:
        """Show the trace in Jupyter."""
        return self.to_svg()

    def markings(self) -> Iterator[tuple[int, int]]:
        """Return the active steps as bits in the order of `steps`, with the scan from which on they are."""
        return self._marking.runs()

    def _names(self, marking: int) -> tuple[str, ...]:
        return tuple(path for bit, path in enumerate(self.steps) if marking >> bit & 1)


def aligned(rows: Sequence[Sequence[str]], gap: str = "  ") -> list[str]:
    """Return the lines of a table whose columns are as wide as their longest cells, with a `gap` between them."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [gap.join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]


def _plain(value: Value) -> Value:
    """Return values that JSON has: no NaN and no infinity."""
    return str(value) if isinstance(value, float) and value - value != 0 else value


def _milliseconds(nanoseconds: int) -> str:
    whole, rest = divmod(nanoseconds, _MILLISECOND)
    return f"{whole}.{rest:06d}".rstrip("0").rstrip(".") if rest else str(whole)


_SCALES = ((10**9, "1 s"), (10**6, "1 ms"), (10**3, "1 us"), (1, "1 ns"))
_FIRST, _CODES = 33, 94  # printable ASCII makes the identifier codes
_SECOND = 1e9
_UNSAFE = re.compile(r"[^\x21-\x5b\x5d-\x7e]")  # blanks, control characters, backslashes, what is not ASCII
_GERMAN = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ß": "ss"})
Recording: TypeAlias = tuple[str, Signal, Iterable[tuple[int, Value]]]
"""The path of a variable, its signal, and its values by the scans in which they begin."""


@dataclass
class _Scope:
    scopes: dict[str, _Scope] = field(default_factory=dict)
    variables: dict[str, str] = field(default_factory=dict)

    def lines(self, name: str) -> Iterator[str]:
        yield f"$scope module {name} $end"
        yield from self.variables.values()
        for inner, scope in self.scopes.items():
            yield from scope.lines(inner)
        yield "$upscope $end"


def dump(name: str, recordings: Iterable[Recording], *, scans: int, scan_time: int) -> str:
    """Return the text of a VCD file of `scans` scans, `scan_time` nanoseconds each.

    It has no date: the same every time.
    """
    scale, unit = next(each for each in _SCALES if scan_time % each[0] == 0)
    top = _Scope()
    events: dict[int, list[str]] = defaultdict(list)
    for number, (path, signal, changes) in enumerate(recordings):
        code = _code(number)
        _declare(top, path, signal, code)
        for scan, value in changes:
            events[scan].append(_change(signal, value, code))
    lines = [f"$version plcopen_sfc {__version__} $end", f"$timescale {unit} $end", *top.lines(_safe(name))]
    lines.append("$enddefinitions $end")
    for scan in sorted(events):
        lines.append(f"#{scan * scan_time // scale}")
        lines += ["$dumpvars", *events[scan], "$end"] if scan == 0 else events[scan]
    lines.append(f"#{scans * scan_time // scale}")
    return "\n".join(lines) + "\n"


def _declare(top: _Scope, path: str, signal: Signal, code: str) -> None:
    """Put a variable into the scopes that its path names; an index stays in the name, in brackets that mean no bits."""
    *outer, name = path.replace("[", "(").replace("]", ")").split(".")
    scope = top
    for part in outer:
        scope = scope.scopes.setdefault(_safe(part), _Scope())
    match signal.kind:
        case SignalKind.BOOL:
            kind = "wire 1"
        case SignalKind.INTEGER:
            kind = f"integer {signal.bits}"
        case SignalKind.REAL | SignalKind.DURATION:
            kind = "real 64"
        case _:
            kind = "string 1"
    safe = wanted = _safe(name)
    number = 2
    while safe in scope.variables:
        safe, number = f"{wanted}_{number}", number + 1
    scope.variables[safe] = f"$var {kind} {code} {safe} $end"


def _change(signal: Signal, value: Value, code: str) -> str:
    match signal.kind:
        case SignalKind.BOOL:
            return f"{int(bool(value))}{code}"
        case SignalKind.INTEGER if isinstance(value, int):
            return f"b{value & ((1 << signal.bits) - 1):b} {code}"
        case SignalKind.REAL:
            return f"r{float(value)!r} {code}"
        case SignalKind.DURATION:
            return f"r{float(value) / _SECOND!r} {code}"
    text = value if isinstance(value, str) else signal.text(value)
    return f"s{_UNSAFE.sub(_escaped, text)} {code}"


def _escaped(match: re.Match[str]) -> str:
    return "".join(f"\\x{byte:02x}" for byte in match.group().encode())


def _code(number: int) -> str:
    digits = ""
    while True:
        digits += chr(_FIRST + number % _CODES)
        number = number // _CODES - 1
        if number < 0:
            return digits


def _safe(name: str) -> str:
    """Return a name in ASCII without blanks; an empty one would not be a name at all."""
    decomposed = unicodedata.normalize("NFKD", name.translate(_GERMAN))
    return _UNSAFE.sub("_", "".join(c for c in decomposed if not unicodedata.combining(c))) or "_"
