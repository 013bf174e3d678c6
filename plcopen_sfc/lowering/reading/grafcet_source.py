"""What a lowering sees of a GRAFCET beyond steps, transitions and the actions of IEC 61131-3."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.model.actions import ActionKind
from plcopen_sfc.semantics.charts.grafcet.hierarchy import RuledChart

if TYPE_CHECKING:
    from plcopen_sfc.lowering.reading.source import ActionSource, Change


@dataclass(frozen=True)
class Edge:
    """``↑operand``, or ``↓operand`` where it is not `rising`. In conditions `name` stands for it.

    `words` are the names in it, as people wrote them.
    """

    name: str
    operand: n.Expression
    rising: bool
    words: tuple[str, ...]


@dataclass(frozen=True)
class Delay:
    """``first/operand/last``: TRUE `first` after the operand became TRUE, until `last` after it became FALSE.

    In conditions `name` stands for it. None: no delay at this end. `words` are the names in it, as people wrote them.
    """

    name: str
    operand: n.Expression
    first: n.Expression | None
    last: n.Expression | None
    words: tuple[str, ...]


@dataclass(frozen=True)
class StoredAction:
    """What is executed when `steps` (several in a macro-step) become active or no longer are, or on an `event`."""

    kind: ActionKind
    steps: tuple[int, ...]
    event: n.Expression | None
    statements: tuple[n.Statement, ...]


@dataclass(frozen=True)
class GrafcetSource:
    """`edges` and `delays` of all conditions, the `stored` and `continuous` actions, and the charts that others rule.

    Edges and delays stand in an order in which each needs only those before it, `ruled` in one in which each chart is
    ruled only by those before it. `step_variables` are the names that mean steps (``X5``), in lower case.
    """

    edges: tuple[Edge, ...]
    delays: tuple[Delay, ...]
    stored: tuple[StoredAction, ...]
    continuous: tuple[ActionSource, ...]
    ruled: tuple[RuledChart, ...]
    step_variables: frozenset[str]

    def changed(self, change: Change) -> GrafcetSource:
        """The same with `change` applied to every text but the targets of actions."""

        def optional(node: Any) -> Any:
            return change(node) if node is not None else None

        delays = [
            replace(d, operand=change(d.operand), first=optional(d.first), last=optional(d.last)) for d in self.delays
        ]
        stored = [
            replace(s, event=optional(s.event), statements=tuple(change(each) for each in s.statements))
            for s in self.stored
        ]
        return replace(
            self,
            edges=tuple(replace(edge, operand=change(edge.operand)) for edge in self.edges),
            delays=tuple(delays),
            stored=tuple(stored),
            continuous=tuple(action.changed(change) for action in self.continuous),
        )

    def trees(self) -> Iterator[n.Node]:
        """Every text."""
        yield from (edge.operand for edge in self.edges)
        for delay in self.delays:
            yield from (each for each in (delay.operand, delay.first, delay.last) if each is not None)
        for stored in self.stored:
            yield from stored.statements
            if stored.event is not None:
                yield stored.event
        for action in self.continuous:
            yield from action.trees()
