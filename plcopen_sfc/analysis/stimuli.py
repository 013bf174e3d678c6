"""Inputs to try where not all can be tried: directed ones that known mistakes fall over, then random ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from random import Random

from plcopen_sfc.analysis.domains import Domain, plain
from plcopen_sfc.analysis.timers import Clocking
from plcopen_sfc.semantics.inputs import RandomInputs, Variables
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value

_HOLDS = ((1, 1), (1, 3), (1, 8), (1, 20), (5, 60))
_PULSED_SCANS = 3


def stimuli(
    signals: Mapping[str, Signal],
    domains: Mapping[str, Domain],
    clock: Clocking,
    *,
    seed: int,
    runs: int,
    scans: int,
) -> Iterator[list[dict[str, Value]]]:
    """Yield the inputs of `runs` runs: for each scan a value of every input.

    All TRUE, all FALSE, alternating, one-scan pulses of one input after the other, random values that are held for
    different times, single pulses in otherwise random inputs (such as an Init that comes in any step), and durations
    around those of the programs: one scan before, in, and one after.
    """
    values = {name: [plain(each) for each in domain.options] for name, domain in domains.items()}
    made = 0
    for rows in patterns(signals, values, scans):
        if made == runs:
            return
        yield rows
        made += 1
    around = _around(clock, scans)
    booleans = [name for name, signal in signals.items() if signal.kind is SignalKind.BOOL]
    for number in range(runs - made):
        low_high = _HOLDS[number % len(_HOLDS)]
        timed = around if around and number % 2 else ()
        source = RandomInputs(seed + number, hold=low_high, holds=timed, values=_varied(values), system_inputs=True)
        rows = _rows(source, signals, scans, clock.scan_time)
        if booleans and number % 3 == 0:
            _pulse(rows, booleans[number // 3 % len(booleans)], Random(f"{seed}:{number}"))  # noqa: S311  # no secret
        yield rows


def patterns(
    signals: Mapping[str, Signal], values: Mapping[str, Sequence[Value]], scans: int
) -> Iterator[list[dict[str, Value]]]:
    """Yield runs with inputs all TRUE, all FALSE, alternating, one-scan pulses of one input after the other."""
    count = len(signals) or 1
    patterns: tuple[Callable[[int, int], int], ...] = (
        lambda _scan, _place: -1,
        lambda _scan, _place: 0,
        lambda scan, _place: scan,
        lambda scan, place: scan + place,
        lambda scan, place: int(scan % count == place),
        lambda scan, place: int(scan // 2 % count == place and scan % 2),
        lambda scan, place: int(scan // _PULSED_SCANS % count != place),
    )
    for pattern in patterns:
        yield [
            {name: values[name][pattern(scan, place) % len(values[name])] for place, name in enumerate(signals)}
            for scan in range(scans)
        ]


def _varied(values: Mapping[str, Sequence[Value]]) -> dict[str, Sequence[Value]]:
    """Return values for numbers: those that the search has found; others are left to chance."""
    return {name: found for name, found in values.items() if len(found) > 1}


def _around(clock: Clocking, scans: int) -> list[int]:
    counts = {constant // clock.scan_time + offset for constant in clock.constants for offset in (-1, 0, 1)}
    return sorted({1, 2, *(count for count in counts if 0 < count < scans)}) if clock.constants else []


def _rows(source: RandomInputs, signals: Mapping[str, Signal], scans: int, scan_time: int) -> list[dict[str, Value]]:
    changes = source.bind(Variables(signals), scan_time)
    row: dict[str, Value] = {}
    rows = []
    for scan in range(scans):
        row = {**row, **changes(scan)}
        rows.append(row)
    return rows


def _pulse(rows: list[dict[str, Value]], name: str, chance: Random) -> None:
    """Keep one input FALSE but for single scans."""
    pulse = 0
    for scan, row in enumerate(rows):
        if scan > pulse:
            pulse = scan + int(chance.random() * 12)
        rows[scan] = {**row, name: scan == pulse}
