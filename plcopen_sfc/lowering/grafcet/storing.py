"""Where a block of its own may execute the stored actions of a GRAFCET: what asks in between for what they write."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Node
from plcopen_sfc.lowering.code.program import StepValue
from plcopen_sfc.lowering.reading.grafcet_source import GrafcetSource, StoredAction
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.model.actions import ActionKind
from plcopen_sfc.semantics.net import indexes


def events_asked_early(source: ChartSource, grafcet: GrafcetSource, active: StepValue) -> str:
    """Why actions on events cannot be executed behind the transitions of their evolution; empty if they can."""
    events = [stored for stored in grafcet.stored if stored.event is not None]
    used = _used(events)
    asked = next((name for name in _identifiers(_conditions(source)) if name.casefold() in used), None)
    if asked is not None:
        return f"conditions of transitions ask for {asked}"
    states = _identifiers(active(step) for step in range(len(source.net.steps)))
    asked = next((name for name in states if name.casefold() in used), None)
    return f"they ask for steps, by {asked}" if asked is not None else ""


def asked_in_between(source: ChartSource, grafcet: GrafcetSource, initial: int) -> bool:
    """Whether anything asks, between an evolution and the outputs, for what stored actions write.

    That is also so where it is asked for before the first evolution what the `initial` steps store.
    """
    started = set(indexes(initial))
    at_start = [s for s in grafcet.stored if s.kind is ActionKind.ON_ACTIVATION and started.intersection(s.steps)]
    operands = [delay.operand for delay in grafcet.delays]
    edges = [edge.operand for edge in grafcet.edges]
    early = [*_conditions(source), *operands, *edges, *(s.event for s in grafcet.stored if s.event is not None)]
    times = [time for delay in grafcet.delays for time in (delay.first, delay.last) if time is not None]
    actions = (*source.actions, *grafcet.continuous)
    times += [use.duration for action in actions for use in action.uses if use.duration is not None]
    between = _names([*times, *operands])
    return bool(source.step_code or _names(early) & _used(at_start) or between & _used(grafcet.stored))


def _identifiers(trees: Iterable[Node]) -> Iterator[str]:
    return (node.identifier for tree in trees for node in walk(tree) if isinstance(node, n.Name))


def _names(trees: Iterable[Node]) -> set[str]:
    """The names in some texts, in lower case."""
    return {name.casefold() for name in _identifiers(trees)}


def _conditions(source: ChartSource) -> list[Node]:
    before = [statement for statements in source.preparations for statement in statements]
    return [*source.conditions, *before]


def _used(actions: Iterable[StoredAction]) -> set[str]:
    return _names(statement for action in actions for statement in action.statements)
