"""By how many scans one side of a comparison may be later than the other, and what is then compared with what.

Tools cut their scans at different places: CODESYS executes actions and then tests transitions, IEC 61131-3 tools and
S7-GRAPH the other way round. So the same chart does the same in both, but one of them does it a scan later.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from plcopen_sfc.errors import ModelError
from plcopen_sfc.semantics.profile import Profile, ScanOrder

__all__ = ["NO_DELAY", "Delay", "delays", "retimed"]

_AUTOMATIC = (0, 1, -1, 2, -2)


@dataclass(frozen=True)
class Delay:
    """A constant delay of all that is compared.

    Args:
        scans: by how many scans the second is later; less than 0: the first is.
        late_start: the later side also begins as many scans later; inputs that operate a chart rest until then.
            Otherwise both begin together, and what the later
            side does in its first scans has no counterpart: it is not compared.
        retimed: the scans of a side that executes actions first are cut behind the actions: the transitions of one scan
            and the actions of the next see the same inputs and the same time. And no side tests transitions in its
            first scan.
    """

    scans: int = 0
    late_start: bool = False
    retimed: bool = False

    @property
    def queued(self) -> int:
        """The scans that observations of the earlier side wait for those of the later one; less than 0: of the first.

        Retimed sides are in step with the other side already.
        """
        return 0 if self.retimed else self.scans

    def __str__(self) -> str:
        """The delay, as ``second 1 scan later``; empty: there is none."""
        if not self.scans:
            return ""
        count = abs(self.scans)
        return f"{'second' if self.scans > 0 else 'first'} {count} scan{'' if count == 1 else 's'} later"

    def notes(self, orders: Sequence[ScanOrder], operated: Sequence[str] = ()) -> tuple[str, ...]:
        """What this means for the start, inputs and times; `orders`: the scan orders of the first and the second.

        `operated`: inputs that operate a chart. They rest while the earlier side runs alone, or transitions are not
        tested yet: an edge of that time would be lost.
        """
        later = "second" if self.scans > 0 else "first"
        count = abs(self.scans)
        if self.retimed:
            start = "no transition is tested in the first scan"
            start += f", and {', '.join(operated)} at rest in it" if operated else ""
            sides = [name for name, order in zip(("first", "second"), orders, strict=True) if order in _RETIMABLE]
            if not self.scans:
                return (start,)
            return (start, *(f"actions of the {side} see the inputs and times of the scan before" for side in sides))
        if not self.scans:
            return ()
        scans = "scan" if count == 1 else f"{count} scans"
        if self.late_start:
            start = f"the {later} starts {count} scan{'' if count == 1 else 's'} later"
            return (f"{start}, and until then {', '.join(operated)} at rest",) if operated else (start,)
        return (f"the first {scans} of the {later} {'has' if count == 1 else 'have'} no counterpart",)

    def as_dict(self) -> dict[str, int | bool]:
        """The delay as plain data, for JSON."""
        return {"scans": self.scans, "late_start": self.late_start, "retimed": self.retimed}


NO_DELAY = Delay()
_RETIMABLE = frozenset({ScanOrder.ACTIONS_FIRST, ScanOrder.RETIMED})


def delays(wanted: int | str | Delay | Iterable[int], profiles: Sequence[Profile]) -> tuple[Delay, ...]:
    """The delays to try, in this order, for a choice of ``delay=``. `profiles`: of the first and the second.

    Of each number of scans that is wanted those come first that say most: both sides as they are, begun together; one
    begun later; retimed. Raises `ModelError`.
    """
    if isinstance(wanted, Delay):
        return (wanted,)
    if wanted == "auto":
        wanted = _AUTOMATIC
    elif isinstance(wanted, str):
        raise ModelError(f"there is no delay {wanted!r}", hint='It is a number of scans, a range, or "auto".')
    if wanted == 0:
        return (NO_DELAY,)
    numbers = [wanted] if isinstance(wanted, int) else sorted(wanted, key=lambda each: (abs(each), -each))
    if not numbers:
        raise ModelError("there is no delay to try")
    return tuple(_forms(numbers, _in_retiming(profiles)))


def _in_retiming(profiles: Sequence[Profile]) -> int | None:
    """The scans that the second is later where scans are cut at the same place; None: that changes nothing."""
    actions_first = [each.order is not ScanOrder.TRANSITIONS_FIRST for each in profiles]
    if actions_first[0] == actions_first[1]:
        same = all(actions_first) or profiles[0].initial_situation_held == profiles[1].initial_situation_held
        return None if same else 0
    return 1 if actions_first[1] else -1


def _forms(numbers: Iterable[int], in_retiming: int | None) -> Iterator[Delay]:
    for number in numbers:
        yield Delay(number)
        if number:
            yield Delay(number, late_start=True)
        if number == in_retiming:
            yield Delay(number, retimed=True)


def retimed(profile: Profile) -> Profile:
    """A profile whose scans are cut behind the actions, and that tests no transitions in the first scan."""
    if profile.order is ScanOrder.TRANSITIONS_FIRST:
        return replace(profile, initial_situation_held=True)
    return replace(profile, order=ScanOrder.RETIMED)
