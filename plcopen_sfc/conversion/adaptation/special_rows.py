"""Rows and step actions of a chart that not all tools execute alike: special ones, and several with one operand."""

from __future__ import annotations

from collections import Counter

from plcopen_sfc.formats.format_interface import ChartHost
from plcopen_sfc.languages.binding.shared_scans import step_action_rows
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.sfc import ActionAssociation, Body, SfcNetwork, Step

COILS = frozenset({Qualifier.N, Qualifier.NONE, Qualifier.D, Qualifier.L})
QUALIFIERS_OF_GRAPH = frozenset("CALL ON OFF CS CU CD CR TL TD TR TF".split())
KINDS_OF_SFC = (None, ActionKind.CONTINUOUS, ActionKind.CONDITIONAL)


def stays_in_place(main: Body | str | None, host: ChartHost) -> bool:
    """True for the main action of a step that the tool has as a text in the step."""
    return host.keeps_bodies and isinstance(main, StBody | IlBody)


def mixed_operands(chart: SfcNetwork) -> set[str]:
    """Return the operands that some rows drive and others set or reset: S7-GRAPH writes them one after the other.

    Action control of IEC 61131-3 has one input for each qualifier instead, and what is set stays.
    """
    rows = [row for _, row in chart.associations() if row.target is not None]
    return {row_key(row) for row in rows if is_coil(row)} & {row_key(row) for row in rows if not is_coil(row)}


def timed_operands(chart: SfcNetwork) -> set[str]:
    """Return the operands that several rows drive, one of them for a time: IEC 61131-3 has one time for all of them."""
    coils = [row for _, row in chart.associations() if row.target is not None and is_coil(row)]
    counts = Counter(map(row_key, coils))
    return {row_key(row) for row in coils if row.duration is not None and counts[row_key(row)] > 1}


def shared_step_actions(chart: SfcNetwork) -> set[str]:
    """Return the names, in lower case, of entry and exit actions that are used more than once in a chart."""
    acting = [*chart.associations(), *step_action_rows(chart)]
    counts = Counter(row_key(row) for _, row in acting if row.target is not None)
    pulses = (Qualifier.P1, Qualifier.P0)
    return {row_key(row) for _, row in acting if row.qualifier in pulses and row.target and counts[row_key(row)] > 1}


def overwritten_rows(step: Step) -> list[ActionAssociation]:
    """Return the rows R of a step whose operand a later row S of it sets: S7-GRAPH executes rows in their order.

    Rows before one that calls or assigns something are left alone: it may read the operand in between.
    """
    found: list[ActionAssociation] = []
    set_later: set[str] = set()
    for row in reversed(step.actions):
        if row.body is not None or row.value is not None or row.condition is not None:
            break
        if is_special(row) or row.exclude or row.negated or row.duration is not None:
            continue
        if row.qualifier is Qualifier.S:
            set_later.add(row_key(row))
        elif row.qualifier in (Qualifier.R, Qualifier.R0) and row_key(row) in set_later:
            found.append(row)
    return found


def is_special(row: ActionAssociation) -> bool:
    """True if a row needs more than a qualifier and a time: an event, an interlock, a condition or a value."""
    if row.event is not None or row.interlock or row.value is not None or row.condition is not None:
        return True
    return row.qualifier in QUALIFIERS_OF_GRAPH or row.forcing is not None or row.kind not in KINDS_OF_SFC


def is_coil(row: ActionAssociation) -> bool:
    """True if a row drives its operand while its step is active."""
    return row.qualifier in COILS and row.value is None and row.body is None


def row_key(row: ActionAssociation) -> str:
    """Return the operand of a row in lower case."""
    return (row.target or "").casefold()
