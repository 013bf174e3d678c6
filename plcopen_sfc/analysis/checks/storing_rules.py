"""Actions that keep a value: what else writes it, and what takes it back."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks.action_targets import Manner, TargetUse, by_operand, written_elsewhere
from plcopen_sfc.analysis.checks.checked_chart import CheckedChart
from plcopen_sfc.analysis.checks.rule import Finding, Rule
from plcopen_sfc.diagnostics import Severity

_KEEPING = frozenset({Manner.SET, Manner.RESET, Manner.STORED})


def _mixed(chart: CheckedChart) -> Iterator[Finding]:
    for found in by_operand(chart).values():
        continuous = next((use for use in found if use.manner is Manner.CONTINUOUS), None)
        if continuous is None:
            continue
        for use in found:
            if use.manner in _KEEPING:
                there = f"step {continuous.step.name} writes it continuously ({_how(continuous)})"
                what = {Manner.SET: "set", Manner.RESET: "reset"}.get(use.manner, "stored")
                message = f"{use.name} is {what} here ({_how(use)}), and {there}"
                yield Finding(use.sheet.at(use.step, use.association), message)


def _how(use: TargetUse) -> str:
    kind = use.association.kind
    return kind.value if kind is not None else use.association.qualifier.value


def _takes_back(use: TargetUse) -> bool:
    """Whether an action resets its operand, or assigns something that may be FALSE."""
    value = (use.association.value or "").strip().upper()
    return use.manner is Manner.RESET or (use.manner is Manner.STORED and value not in ("TRUE", "1"))


def _never_reset(chart: CheckedChart) -> Iterator[Finding]:
    for path, found in by_operand(chart).items():
        setting = [use for use in found if use.manner is Manner.SET]
        if setting and not any(map(_takes_back, found)) and not written_elsewhere(chart, path):
            use = setting[0]
            message = f"{use.name} is set ({_how(use)}), and nothing resets it"
            yield Finding(use.sheet.at(use.step, use.association), message)


def _never_set(chart: CheckedChart) -> Iterator[Finding]:
    for path, found in by_operand(chart).items():
        if all(use.manner is Manner.RESET for use in found) and not written_elsewhere(chart, path):
            use = found[0]
            message = f"{use.name} is reset, and nothing sets it"
            yield Finding(use.sheet.at(use.step, use.association), message)


def _both_at_once(chart: CheckedChart) -> Iterator[Finding]:
    for found in by_operand(chart).values():
        setting = {id(use.step): use for use in found if use.manner is Manner.SET and use.association.event is None}
        for use in found:
            other = setting.get(id(use.step))
            if other is not None and use.manner is Manner.RESET and use.association.event is None:
                message = f"the step sets {use.name} ({_how(other)}) and resets it: the reset wins"
                yield Finding(use.sheet.at(use.step, use.association), message)


def _chart(first: str, second: str) -> str:
    return f"""
INITIAL_STEP S1: {first} END_STEP
STEP S2: {second} END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
"""


ACT02 = Rule(
    code="ACT02",
    title="An operand is written continuously or stored, not both",
    why="A continuous action writes its operand all the time, also FALSE: whatever a stored action did is overwritten "
    "at once (IEC 60848:2013, 4.8; tools for GRAFCET refuse it). With the action control of IEC 61131-3 the operand "
    "is TRUE while either of them wants it, which few readers expect; in S7-GRAPH N resets it when its step is left.",
    hint="Use S and R, or the continuous action in every step.",
    example=_chart("q(N);", "q(S);"),
    check=_mixed,
    severity=Severity.WARNING,
    severities={"grafcet": Severity.ERROR},
)

ACT03 = Rule(
    code="ACT03",
    title="What is set is reset",
    why="A stored action stays active when its step is left, until an R of the same action. Without one it never "
    "ends; initialising the chart does not end it in all tools. Code anywhere in the project that writes the variable "
    "counts as a reset.",
    hint="Add an action with R to the step in which it shall end.",
    example=_chart("q(S);", ""),
    check=_never_reset,
    severity=Severity.WARNING,
)

ACT10 = Rule(
    code="ACT10",
    title="What is reset is set",
    why="R ends a stored action of the same name. Where there is none, R does nothing, or the variable is set "
    "elsewhere: then two places fight for it.",
    hint="Look where it is set; correct the name if it is another.",
    example=_chart("q(R);", ""),
    check=_never_set,
    severity=Severity.INFO,
)

ACT18 = Rule(
    code="ACT18",
    title="A step does not set and reset the same operand",
    why="R dominates in the action control of IEC 61131-3 (ed. 3, 6.7.4.6), so that the operand is never set; where "
    "the actions are coils, the last line counts.",
    hint="Remove one of them, or use P1 and P0.",
    example=_chart("q(S); q(R);", ""),
    check=_both_at_once,
    severity=Severity.WARNING,
)
