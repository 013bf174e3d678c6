"""Traces as value change dumps (VCD, IEEE 1364-2005, clause 18), which GTKWave and other wave viewers show.

Booleans and steps are wires, integers are vectors in two's complement, durations are reals in seconds, enumerations
and texts are strings (an extension that GTKWave understands). Files are plain ASCII, as readers of the standard expect:
names lose their accents (``Grösse`` becomes ``Groesse``).
"""

from __future__ import annotations

import re
import unicodedata
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

from plcopen_sfc.semantics.signals import Signal, SignalKind, Value
from plcopen_sfc.version import __version__

__all__ = ["dump"]

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
    """The text of a VCD file of `scans` scans, `scan_time` nanoseconds each. It has no date: the same every time."""
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
    """A name in ASCII without blanks; an empty one would not be a name at all."""
    decomposed = unicodedata.normalize("NFKD", name.translate(_GERMAN))
    return _UNSAFE.sub("_", "".join(c for c in decomposed if not unicodedata.combining(c))) or "_"
