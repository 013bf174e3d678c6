"""Times of steps that nobody will see, set back: so that a search of states does not tell them apart."""

from __future__ import annotations

from collections.abc import Callable, Container

from plcopen_sfc.semantics.charts.steps import Steps, T, X
from plcopen_sfc.semantics.programs.layouts import Frame


def forgetting(
    steps: Steps, anywhere: Container[str], read: Container[str], used: Container[int]
) -> Callable[[Frame, int], None]:
    """See `ChartProgram.forgetting`; what is given back gets a frame and the present time.

    `used` are the slots of starts that the chart itself depends on.
    """
    seen = [name for name in steps.names if not name.flag]
    timed = {name.slot for name in seen if name.name.casefold() in read or name.since in used}
    timeless = tuple((name.slot, name.since) for name in seen if name.slot not in timed)
    own = tuple(n.slot for n in seen if n.slot in timed and n.name.casefold() not in anywhere)

    def forget(frame: Frame, now: int) -> None:
        v = frame.v
        for slot, since in timeless:
            v[slot].v[T] = 0
            if v[since] is not None:
                v[since] = now
        for slot in own:
            values = v[slot].v
            if not values[X]:
                values[T] = 0

    return forget
