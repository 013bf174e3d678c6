"""The order in which S7-GRAPH executes the rows of a chart, and that of what a target has in their place.

A cycle writes coils first, then executes the rows of the steps that were left, then those of the active steps, each in
the order of the steps and of their rows. It counts where a row reads what another one writes.
"""

from __future__ import annotations

from plcopen_sfc.conversion.adaptation.special_rows import is_coil, is_special, row_key
from plcopen_sfc.languages.binding import Row, SharedScans, told_orders
from plcopen_sfc.model.actions import ActionEvent
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Step

AFTER_ENTRY = (None, ActionEvent.C, ActionEvent.L1, ActionEvent.V1, ActionEvent.R1)
"""The events of rows that may act as their step begins, in statements after those that are executed once then."""
Place = tuple[int | str, ...]
"""When a target executes a row: the least of a scan first."""


class RowOrders:
    """The order of the rows of a chart.

    Args:
        chart: The chart with its rows as in the source.
        scans: Tells which rows have a scan and a variable in common.
        by_name: The target executes actions in the order of their names, and entry and exit actions before them.
    """

    def __init__(self, chart: SfcNetwork, scans: SharedScans, *, by_name: bool) -> None:
        self._scans, self._by_name = scans, by_name
        self._rows = [(step, row) for step in chart.steps for row in step.actions if not row.exclude]
        self._order = {id(row): _in_graph(number, row) for number, (_, row) in enumerate(self._rows)}
        self._places: dict[int, Place] = {}

    def late_starts(self, step: Step) -> set[int]:
        """Return the rows on S1, by their identity, that depend on coils or rows above which act in the same cycle.

        They are executed among the statements of the active step, not before all of them.
        """
        found: set[int] = set()
        above = [each for each in step.actions if is_coil(each) and self._by_name]  # behind entry actions there
        for row in (each for each in step.actions if not is_coil(each)):
            is_start = row.event is ActionEvent.S1
            if is_start and any(self._scans.shared((step, row), (step, each)) for each in above):
                found.add(id(row))
            if row.event in AFTER_ENTRY or id(row) in found:
                above.append(row)
        return found

    def operands_in_order(self) -> set[str]:
        """Return the operands of plain rows that must be statements among those which read or write them.

        An association comes before the statements of its step, in CODESYS where its name puts it.
        """
        found: set[str] = set()
        for step, row in self._rows:
            if row.target is None or is_special(row) or row.body is not None or row.duration is not None:
                continue
            place = next(number for number, each in enumerate(step.actions) if each is row)
            for other in step.actions if self._by_name else step.actions[: 0 if is_coil(row) else place]:
                is_stated = (is_special(other) or other.body is not None) and not is_coil(other)
                if is_stated and row_key(other) != row_key(row) and self._scans.shared((step, row), (step, other)):
                    found.add(row_key(row))
        return found

    def put(self, row: ActionAssociation, place: Place) -> None:
        """Note when the target executes a row; of an operand that several steps have, the first place counts."""
        self._places[id(row)] = place

    def told(self) -> str:
        """Return which rows the target executes before others, and S7-GRAPH after them; empty where none is."""
        rows = [row for row in self._rows if id(row[1]) in self._places]
        return told_orders(self._scans, rows, self._is_overtaken, "before")

    def _is_overtaken(self, one: Row, other: Row) -> bool:
        mine, its = id(one[1]), id(other[1])
        is_other_way = self._places[mine] < self._places[its] and self._order[mine] > self._order[its]
        return is_other_way and row_key(one[1]) != row_key(other[1]) and self._in_one_cycle(one, other)

    def _in_one_cycle(self, one: Row, other: Row) -> bool:
        """True if S7-GRAPH may execute both rows in one cycle; it has no final scans."""
        (here, first), (there, second) = one, other
        ended = [each.event is ActionEvent.S0 for each in (first, second)]
        if ended[0] is ended[1]:
            return self._scans.are_together(here, there)
        left, entered, row = (here, there, second) if ended[0] else (there, here, first)
        return self._scans.follow(left, entered) or (left is entered and is_coil(row))


def _in_graph(number: int, row: ActionAssociation) -> tuple[int, int]:
    """Return when a cycle of S7-GRAPH executes a row: coils first, then what was left."""
    if is_coil(row):
        return 0, 0
    return (1 if row.event is ActionEvent.S0 else 2), number
