"""Edges and times of a GRAFCET as conditions that can be decided."""

from __future__ import annotations

import re
from collections.abc import Iterable

from plcopen_sfc.semantics.charts.grafcet.term_evaluation import TermTexts, written_operand

_EDGE = re.compile(r"\(*GRAFCET_EDGE_\d+ AND .*\)")
"""An edge as `JudgedTerms` has it."""


class JudgedTerms(TermTexts):
    """Terms of a GRAFCET with what is known of them.

    At a rising edge the operand is true, at a falling one false. ``3s/a`` is true only with its operand and not before
    ``2s/a``, ``a/3s`` always with it and not after ``a/5s``; at an edge of ``a`` no time has passed. ``3s/↑a`` is
    never true: an edge lasts for no time. `texts` are the conditions that are decided together.
    """

    def __init__(self, texts: Iterable[str] = ()) -> None:
        super().__init__()
        self._since: dict[str, str] = {}
        """How long each operand has had its value: the names of these times."""
        for text in texts:
            self.read(text)

    def edge(self, operand: str, *, rising: bool) -> str:
        """Return an edge and the value that its operand has then."""
        name = super().edge(operand, rising=rising)
        just = f" AND {self._since[operand]} = T#0s" if operand in self._since else ""
        return f"({name} AND {'' if rising else 'NOT '}({operand}){just})"

    def delay(self, operand: str, first: str | None, last: str | None) -> str:
        """Return a time, and the value that its operand gives it."""
        name = super().delay(operand, first, last)
        if first is not None and _EDGE.fullmatch(operand):
            return "FALSE"
        if "GRAFCET_EDGE" in operand:  # an edge is older than the time
            return name
        since = self._since.setdefault(operand, f"GRAFCET_SINCE_{len(self._since) + 1}")
        if last is None:
            return f"(({operand}) AND {since} >= {first})"
        if first is None:
            return f"(({operand}) OR {since} < {last})"
        return f"({name} OR ({operand}) AND {since} >= {first})"

    def shown(self, text: str) -> str:
        """Return a text with the terms as people write them, and ``t/a`` for how long ``a`` has had its value."""
        for operand, name in self._since.items():
            text = re.sub(rf"\b{name}\b", f"t/{written_operand(operand)}", text)
        return super().shown(text)
