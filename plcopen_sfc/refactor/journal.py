"""Record of an edit, so that it can be taken back: a project is as it was before, its objects are the same."""

from __future__ import annotations

from copy import deepcopy
from itertools import count
from typing import Any

from plcopen_sfc.model.owners import Owned
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcNetwork

EDITS = count(1)
"""Numbers for `Project.last_edit`."""


class Journal:
    """Values of fields before they were changed, in the order of the changes.

    An edit puts its changes through a journal, or lets it keep the fields that other code is going to change. Nothing
    is copied but the lists that are kept, and drawings: an edit costs what it touches.
    """

    def __init__(self) -> None:
        self._before: list[tuple[Any, str | int, Any, list[Any] | None]] = []

    def __len__(self) -> int:
        return len(self._before)

    def keep(self, holder: Any, *keys: str | int) -> None:
        """Remember fields of an object (or items of a list) as they are now; of a list also what is in it."""
        for key in keys:
            value = holder[key] if isinstance(key, int) else getattr(holder, key)
            self._before.append((holder, key, value, [*value] if isinstance(value, list) else None))

    def put(self, holder: Any, key: str | int, value: Any) -> None:
        """Give a field of an object (or an item of a list) another value. Raises `ModelError` for a wrong one."""
        self.keep(holder, key)
        if isinstance(key, int):
            holder[key] = value
        else:
            setattr(holder, key, value)

    def keep_drawing(self, chart: SfcNetwork) -> None:
        """Remember how a chart is drawn: saving lets its drawing follow an edit, symbol by symbol."""
        self._before.append((chart, "drawing", deepcopy(chart.drawing), None))

    def keep_declarations(self, pou: Pou) -> None:
        """Remember what a POU declares, for an edit that declares something."""
        self.keep(pou, "actions", "transitions", "interface")
        if pou.interface is not None:
            self.keep(pou.interface, "sections")
            for section in pou.interface.sections:
                self.keep(section, "variables")

    def take_back(self, length: int = 0) -> None:
        """Put back all values since the journal had this length, the last one first."""
        while len(self._before) > length:
            holder, key, value, items = self._before.pop()
            if items is not None:
                value[:] = items
            if isinstance(key, int):
                holder[key] = value
            else:
                holder.__dict__[key] = value  # an assignment would refuse what only files may have
            if isinstance(holder, Owned) and key in holder.OWNS:
                holder.adopt()  # what an edit moved to another owner is back
