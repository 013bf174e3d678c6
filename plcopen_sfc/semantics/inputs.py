"""Inputs of a simulation: from CSV files, from another trace, from a Python function, or random with a seed.

Commands, modes and SFC flags, which operate a chart or tell its state, are no signals of the machine.
"""

from __future__ import annotations

import codecs
import csv
import os
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from random import Random
from typing import Protocol, TypeAlias, TypeVar, runtime_checkable

from plcopen_sfc.errors import InputError, Location, ModelError
from plcopen_sfc.files import read_bytes
from plcopen_sfc.model.chart_settings import GRAPH_INPUTS, GRAPH_OUTPUTS, SfcFlag
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.semantics.charts.graph.graph_parameters import PARAMETERS
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value
from plcopen_sfc.semantics.trace import ACTIVE_COLUMN, SCAN_COLUMN, TIME_COLUMN, Trace

_FLAGS = frozenset(flag.variable.casefold() for flag in SfcFlag)
_SEQUENCER = frozenset(name.casefold() for name in GRAPH_INPUTS)
OUTPUT_NAMES = frozenset(name.casefold() for name in GRAPH_OUTPUTS)
"""Casefolded names of the outputs by which S7-GRAPH tells the state of a sequence."""
PARAMETER_NAMES = _SEQUENCER | OUTPUT_NAMES
"""Casefolded names of the inputs and outputs by which S7-GRAPH is told what to do with a sequence, and tells its state.
"""
MEMBER_NAMES = frozenset(name.casefold() for name in (*PARAMETERS, "RT_DATA"))
"""Casefolded names of what a block of S7-GRAPH usually has, so that no other variable of the block has such a name."""
_SIGNS = frozenset({"off_sq", "init_sq"})
"""A block without a chart that has one of these is a sequencer that was lowered."""


def system_inputs(pou: Pou, profile: Profile, inputs: Iterable[str]) -> frozenset[str]:
    """Return those of `inputs` that operate the chart of `pou`, as they are written there.

    They are the SFC flags of CODESYS (``SFCInit``, ``SFCPause``), wherever they are declared, and under a profile with
    the parameters of S7-GRAPH those parameters of the block (``OFF_SQ``, ``SW_MAN``, ``T_PUSH``). A chart does its work
    while they keep their initial values.
    """
    own = {variable.name.casefold() for variable in pou.variables(SectionKind.INPUT)}
    parameters = (
        own & _SEQUENCER if profile.graph_parameters and (pou.chart is not None or own & _SIGNS) else frozenset()
    )
    return frozenset(
        name for name in inputs if name.casefold() in parameters or name.rpartition(".")[2].casefold() in _FLAGS
    )


InputFunction: TypeAlias = Callable[[int, Mapping[str, Value]], Mapping[str, object]]
"""Gives what changes in a scan: from its number (0 is the first) and all values at the end of the scan before."""

BoundInputs: TypeAlias = Callable[[int], Mapping[str, Value]]
"""Changes of a scan, from its number; it is asked for scan after scan."""


@dataclass(frozen=True)
class Variables:
    """Variables that a source sets: the inputs with their types, and the names of all others (case as declared).

    `system` are those inputs that operate the chart.
    """

    inputs: Mapping[str, Signal]
    others: Collection[str] = ()
    system: Collection[str] = ()

    def find(self, name: str) -> str | None:
        """Return the input of this name as it is declared; case does not matter.

        A variable at an address has a path with its program (``Main.Start``); its name is enough where only one has it.
        """
        wanted = name.casefold()
        inside = [each for key, each in self._folded.items() if key.endswith(f".{wanted}")]
        return self._folded.get(wanted) or (inside[0] if len(inside) == 1 else None)

    @property
    def _folded(self) -> dict[str, str]:
        return {each.casefold(): each for each in self.inputs}


_Choice = TypeVar("_Choice")


@runtime_checkable
class InputSource(Protocol):
    """Source of inputs."""

    def bind(self, variables: Variables, scan_time: int) -> BoundInputs:
        """Return the inputs for a program with these variables and this scan time in nanoseconds."""

    def scans(self, scan_time: int) -> int | None:
        """Return the number of scans that the source has values for; None: any number."""


# -- files


@dataclass(frozen=True)
class _Row:
    line: int
    cells: list[str]


@dataclass
class CsvInputs:
    """The content of a CSV file: a header with the names of inputs, then one row for each scan.

    Columns are separated by ``;``, ``,`` or tab; the decimal sign is a point. Empty cells leave the input as it is.
    With a column ``scan no`` or ``time ms`` a row holds from that scan or time on until the next, so rows may be left
    out. Columns of variables that are no inputs are left out (see `ignored`), so that a saved trace can be replayed;
    those of unknown names are errors. The last row holds for ever.
    """

    headers: list[str]
    rows: list[_Row]
    file: str | None = None
    ignored: list[str] = field(default_factory=list)

    def __repr__(self) -> str:
        return f"CsvInputs({self.file or 'text'}: {len(self.headers)} columns, {len(self.rows)} rows)"

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> CsvInputs:
        """Read a file. Raises `FileAccessError`, or `InputError` with the line that is wrong."""
        return cls.parse(_decode(read_bytes(path)), file=os.fspath(path))

    @classmethod
    def parse(cls, text: str, *, file: str | None = None) -> CsvInputs:
        """Read text. Raises `InputError` with the line that is wrong."""
        lines = text.splitlines(keepends=True)
        skipped = 0
        delimiter = None
        if lines and lines[0].lower().startswith("sep="):  # what Excel understands
            delimiter, skipped = lines[0].strip()[4:5] or None, 1
        while skipped < len(lines) and not lines[skipped].strip(" ;,\t\r\n"):
            skipped += 1
        if skipped == len(lines):
            raise InputError("the file has no header", location=Location(file, 1), hint="Write the names of inputs.")
        delimiter = delimiter or max(";\t,", key=lambda sign: "".join(lines[skipped].split('"')[::2]).count(sign))
        reader = csv.reader(lines[skipped:], delimiter=delimiter, strict=True, skipinitialspace=True)
        rows: list[_Row] = []
        start = skipped + 1
        try:
            for cells in reader:
                if any(cell.strip() for cell in cells):
                    rows.append(_Row(start, cells))
                start = skipped + 1 + reader.line_num
        except csv.Error as error:
            raise InputError(f"this is no CSV: {error}", location=Location(file, start)) from error
        headers = [cell.strip() for cell in rows[0].cells]
        while headers and not headers[-1]:
            headers.pop()
        found = cls(headers, rows[1:], file)
        found._check_shape(rows[0].line)
        return found

    def scans(self, scan_time: int) -> int | None:
        """Return the number of scans that the rows reach to."""
        starts = self._starts(scan_time)
        return starts[-1] + 1 if starts else 0

    def bind(self, variables: Variables, scan_time: int) -> BoundInputs:
        """See `InputSource.bind`. Raises `InputError` for unknown names and values that do not fit."""
        self.ignored = []
        others = {name.casefold() for name in variables.others}
        columns: list[tuple[int, str, Signal]] = []
        for place, header in enumerate(self.headers):
            name = variables.find(header)
            if name is not None:
                columns.append((place, name, variables.inputs[name]))
            elif header.casefold() in others or header.casefold() in _NO_VARIABLES:
                if header.casefold() in others:
                    self.ignored.append(header)
            else:
                names = ", ".join(list(variables.inputs)[:20])
                hint = f"Its inputs are: {names}" if names else "It has no inputs."
                raise InputError(f"the program has no variable {header!r}", location=Location(self.file, 1), hint=hint)
        changes: dict[int, dict[str, Value]] = {}
        for start, row in zip(self._starts(scan_time), self.rows, strict=True):
            changes.setdefault(start, {}).update(self._values(row, columns))
        return lambda scan: changes.get(scan, _NOTHING)

    def _values(self, row: _Row, columns: Iterable[tuple[int, str, Signal]]) -> dict[str, Value]:
        values: dict[str, Value] = {}
        for place, name, signal in columns:
            cell = row.cells[place]
            if cell.strip():
                try:
                    values[name] = signal.parse(cell)
                except ModelError as error:
                    location = Location(self.file, row.line)
                    raise InputError(f"{name}: {error.message}", location=location, hint=error.hint) from None
        return values

    def _starts(self, scan_time: int) -> list[int]:
        """Return the scan from which on each row holds."""
        folded = [header.casefold() for header in self.headers]
        if SCAN_COLUMN in folded:
            place, unit = folded.index(SCAN_COLUMN), 0
        elif TIME_COLUMN in folded:
            place, unit = folded.index(TIME_COLUMN), scan_time
        else:
            return list(range(len(self.rows)))
        starts: list[int] = []
        last = 0
        for row in self.rows:
            cell = row.cells[place].strip()
            location = Location(self.file, row.line)
            try:
                at = _nanoseconds(cell) if unit else int(cell)
            except ValueError:
                raise InputError(f"{self.headers[place]}: {cell!r} is no number", location=location) from None
            if at < last:
                raise InputError(f"{self.headers[place]}: {cell} is behind a later row", location=location)
            last = at
            starts.append(-(-at // unit) if unit else at)
        return starts

    def _check_shape(self, header_line: int) -> None:
        seen: set[str] = set()
        for header in self.headers:
            if not header:
                raise InputError("a column has no name", location=Location(self.file, header_line))
            if header.casefold() in seen:
                raise InputError(f"two columns are named {header!r}", location=Location(self.file, header_line))
            seen.add(header.casefold())
        width = len(self.headers)
        for row in self.rows:
            if len(row.cells) < width or any(cell.strip() for cell in row.cells[width:]):
                message = f"the row has {len(row.cells)} cells, the header {width}"
                hint = "Values with a decimal comma or the separator in them must be in quotes."
                raise InputError(message, location=Location(self.file, row.line), hint=hint)


_NOTHING: Mapping[str, Value] = {}
_NO_VARIABLES = frozenset({SCAN_COLUMN, TIME_COLUMN, ACTIVE_COLUMN})
_MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))


def _decode(data: bytes) -> str:
    """Return the text of a file: by its byte order mark, as UTF-8, else in the code page of Western Windows."""
    encoding = next((encoding for mark, encoding in _MARKS if data.startswith(mark)), "utf-8")
    try:
        return data.decode(encoding)
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")


def _nanoseconds(milliseconds: str) -> int:
    whole, _, part = milliseconds.partition(".")
    if not (whole + part).isdecimal() or len(part) > 6:
        raise ValueError(milliseconds)
    return int(whole or "0") * 1_000_000 + int(part.ljust(6, "0"))


# -- traces


@dataclass(frozen=True)
class TraceInputs:
    """The inputs that a trace has recorded, again."""

    trace: Trace

    def scans(self, scan_time: int) -> int | None:  # noqa: ARG002  # of the protocol
        """As many as the trace has."""
        return len(self.trace)

    def bind(self, variables: Variables, scan_time: int) -> BoundInputs:  # noqa: ARG002
        """See `InputSource.bind`."""
        changes: dict[int, dict[str, Value]] = {}
        for column in self.trace.columns:
            name = variables.find(column.name)
            for scan, value in column.runs() if name is not None else ():
                changes.setdefault(scan, {})[name or ""] = value
        return lambda scan: changes.get(scan, _NOTHING)


# -- random


@dataclass(frozen=True)
class RandomInputs:
    """Random inputs, the same for the same seed on every machine.

    Every input keeps a value for a number of scans out of `hold` (both ends included), or out of `holds` where that is
    given: durations that matter, such as those around the times of a program. Booleans change, enumerations and
    numbers get any value: of `values` by name, of `ranges` by name, or of a few around zero and the bounds of the type.
    An input has the same values whatever other inputs there are. What operates the chart (``SFCInit`` of CODESYS,
    ``OFF_SQ`` and ``SW_MAN`` of S7-GRAPH) keeps its initial value unless `system_inputs` is set, or `ranges` or
    `values` name it: a chart that is held or switched off most of the time shows little.
    """

    seed: int = 0
    hold: tuple[int, int] = (1, 20)
    holds: Sequence[int] = ()
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    values: Mapping[str, Sequence[Value]] = field(default_factory=dict)
    system_inputs: bool = False

    def scans(self, scan_time: int) -> int | None:  # noqa: ARG002  # of the protocol
        """Any number."""
        return None

    def bind(self, variables: Variables, scan_time: int) -> BoundInputs:  # noqa: ARG002
        """See `InputSource.bind`. Raises `InputError` for ranges and values of what is no input."""
        for name in (*self.ranges, *self.values):
            if variables.find(name) is None:
                raise InputError(f"the program has no input {name!r}", hint=", ".join(list(variables.inputs)[:20]))
        named = {name.casefold() for name in (*self.ranges, *self.values)}
        sources = [
            _RandomInput(self, name, signal)
            for name, signal in variables.inputs.items()
            if self.system_inputs or name.casefold() in named or name not in variables.system
        ]

        def changes(scan: int) -> dict[str, Value]:
            found: dict[str, Value] = {}
            for source in sources:
                if source.until <= scan:
                    found[source.name] = source.advance(scan)
            return found

        return changes


class _RandomInput:
    def __init__(self, options: RandomInputs, name: str, signal: Signal) -> None:
        self.name = name
        self.until = 0
        self._random = Random(f"{options.seed}:{name.casefold()}")  # noqa: S311  # no secret
        self._signal = signal
        self._options = options
        self._value: Value | None = None
        by_name = {key.casefold(): each for key, each in options.values.items()}
        self._values = list(by_name.get(name.casefold(), ())) or samples(signal)
        self._range = {key.casefold(): each for key, each in options.ranges.items()}.get(name.casefold())

    def advance(self, scan: int) -> Value:
        low, high = self._options.hold
        holds = self._options.holds
        self.until = scan + (self._below(holds) if holds else low + int(self._random.random() * (high - low + 1)))
        self._value = self._next()
        return self._value

    def _next(self) -> Value:
        if self._range is not None:
            low, high = self._range
            if self._signal.kind is SignalKind.REAL:
                return self._signal.accept(low + (high - low) * self._random.random())
            return int(low) + int(self._random.random() * (int(high) - int(low) + 1))
        if self._signal.kind is SignalKind.BOOL and self._value is not None:
            return not self._value
        return self._below(self._values)

    def _below(self, choices: Sequence[_Choice]) -> _Choice:
        return choices[int(self._random.random() * len(choices))]


def samples(signal: Signal) -> list[Value]:
    """Return a few values of a type, simple ones more often than odd ones."""
    match signal.kind:
        case SignalKind.BOOL:
            return [False, True]
        case SignalKind.REAL:
            return [0.0, 1.0, -1.0, 0.5, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0]
        case SignalKind.DURATION:
            return [milliseconds * 1_000_000 for milliseconds in (0, 10, 50, 100, 500, 1000, 2000, 5000, 10000)]
        case SignalKind.STRING:
            return ["", "A", "Test"]
        case SignalKind.ENUMERATION if signal.names:
            return list(signal.names)
    around = [count * signal.unit for count in (0, 1, 2, 3, 4, 5, 10, 20, 50, 100, 1000, -1)]
    return [value for value in around if signal.least <= value <= signal.greatest] or [signal.least]
