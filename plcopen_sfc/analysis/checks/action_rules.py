"""Rules about actions: qualifiers and times, values that are kept, and steps that write the same variable together."""

from __future__ import annotations

import re
from collections.abc import Iterator

from plcopen_sfc.analysis.checks.action_targets import (
    Manner,
    TargetUse,
    assignments,
    body_named,
    by_operand,
    how,
    manner_of,
    uses,
    written_elsewhere,
)
from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, Finding, Rule, ring
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.effects import path_of, reads
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.model.actions import NEED_EVENT, TIMERS, ActionEvent, Qualifier

_KEEPING = frozenset({Manner.SET, Manner.RESET, Manner.STORED})


def _mixed(chart: CheckedChart) -> Iterator[Finding]:
    for found in by_operand(chart).values():
        continuous = next((use for use in found if use.manner is Manner.CONTINUOUS), None)
        if continuous is None:
            continue
        for use in found:
            if use.manner in _KEEPING:
                what = {Manner.SET: "set", Manner.RESET: "reset"}.get(use.manner, "stored")
                message = f"{use.name} is {what} here ({how(use)}), and {_there(continuous)}"
                yield Finding(use.sheet.at(use.step, use.association), message)
    continuous_uses = {use.path: use for use in uses(chart) if use.manner is Manner.CONTINUOUS}
    for sheet, step, association in chart.actions():
        stores = association.kind is not None and manner_of(association) is Manner.STORED
        for assigned in assignments(association.body, chart) if stores else ():
            found_use = continuous_uses.get(path_of(assigned.target))
            if found_use is not None and association.kind is not None:
                what = f"{print_node(assigned.target)} is stored here ({association.kind.words})"
                yield Finding(sheet.at(step, association), f"{what}, and {_there(found_use)}")


def _there(continuous: TargetUse) -> str:
    return f"step {continuous.step.name} writes it while it is active ({how(continuous)})"


def _takes_back(use: TargetUse) -> bool:
    """Return True if an action resets its operand, or assigns something that may be FALSE."""
    value = (use.association.value or "").strip().upper()
    return use.manner is Manner.RESET or (use.manner is Manner.STORED and value not in ("TRUE", "1"))


def _never_reset(chart: CheckedChart) -> Iterator[Finding]:
    for path, found in by_operand(chart).items():
        setting = [use for use in found if use.manner is Manner.SET]
        if setting and not any(map(_takes_back, found)) and not written_elsewhere(chart, path):
            use = setting[0]
            message = f"{use.name} is set ({how(use)}), and nothing resets it"
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
                message = f"the step sets {use.name} ({how(other)}) and resets it: the reset wins"
                yield Finding(use.sheet.at(use.step, use.association), message)


ACT02 = Rule(
    code="ACT02",
    title="An operand is written continuously or stored, not both",
    why="A continuous action writes its operand all the time, also FALSE: whatever a stored action did is overwritten "
    "at once (IEC 60848:2013, 4.8; tools for GRAFCET refuse it). With the action control of IEC 61131-3 the operand "
    "is TRUE while either of them wants it, which few readers expect; in S7-GRAPH N resets it when its step is left.",
    hint="Use S and R, or the continuous action in every step.",
    grafcet_hint="Write it continuously in all steps that need it, or store it in all of them (ON ACTIVATION Q, "
    "ON DEACTIVATION Q := FALSE).",
    example=ring("q(N);", "q(S);"),
    check=_mixed,
    severity=Severity.WARNING,
    severities={"grafcet": Severity.ERROR},
)

ACT03 = Rule(
    code="ACT03",
    title="Every action and variable that is set is reset",
    why="A stored action stays active when its step is left, until an R of the same action. Without one it never "
    "ends; initialising the chart does not end it in all tools. Code anywhere in the project that writes the variable "
    "counts as a reset.",
    hint="Add an action with R to the step in which it shall end.",
    example=ring("q(S);"),
    check=_never_reset,
    severity=Severity.WARNING,
)

ACT10 = Rule(
    code="ACT10",
    title="Every action and variable that is reset is set",
    why="R ends a stored action of the same name. Where there is none, R does nothing, or the variable is set "
    "elsewhere: then two places fight for it.",
    hint="Look where it is set; correct the name if it is another.",
    example=ring("q(R);"),
    check=_never_set,
    severity=Severity.INFO,
)


def _counted_twice(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, association in chart.actions():
        if association.qualifier is Qualifier.P and chart.profile.final_scan:
            body = association.body or body_named(association.target, chart)
            for assigned in assignments(body, chart):
                if path_of(assigned.target) in reads(assigned.value):
                    what = f"{print_node(assigned.target)} := {print_node(assigned.value)}"
                    yield Finding(sheet.at(step, association), f"P executes {what} twice")


ACT18 = Rule(
    code="ACT18",
    title="A step does not set and reset the same operand",
    why="R dominates in the action control of IEC 61131-3 (ed. 3, 6.7.4.6), so that the operand is never set; where "
    "the actions are coils, the last line counts.",
    hint="Remove one of them, or use P1 and P0.",
    example=ring("q(S); q(R);"),
    check=_both_at_once,
    severity=Severity.WARNING,
)

ACT21 = Rule(
    code="ACT21",
    title="An action with P counts nothing",
    why="The code of an action is executed once more when it has ended (IEC 61131-3 ed. 3, 6.7.4.6, and the help of "
    "CODESYS), so with P in two scans: what adds to a variable adds twice. A Boolean variable is TRUE in one scan. "
    "matiec and Beremiz have no such scan.",
    hint="Use P1, where the tool has it, or an entry action.",
    example=ring("Count(P);") + "ACTION Count: n := n + 1; END_ACTION\n",
    check=_counted_twice,
    severity=Severity.WARNING,
    severities=dict.fromkeys(("s7graph", "grafcet", "matiec", "beremiz")),
)


_TIMED_OF_S5 = TIMERS - {Qualifier.TR}
_NINE = 9


def _no_time(duration: str | None) -> bool:
    return duration is None or not duration.strip()


def _without_time(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, association in chart.actions():
        if association.qualifier.needs_duration and _no_time(association.duration):
            message = f"the qualifier {association.qualifier} needs a time"
            yield Finding(sheet.at(step, association), message)


def _with_time(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, association in chart.actions():
        timed = association.qualifier.needs_duration or association.qualifier in _TIMED_OF_S5
        plain = association.kind is None and not timed
        if plain and not _no_time(association.duration) and not _ZERO.fullmatch(association.duration or ""):
            message = f"the time {association.duration} has no effect with the qualifier {association.qualifier}"
            yield Finding(sheet.at(step, association), message)


_ZERO = re.compile(r"\s*(?:L?T(?:IME)?#0(?:[a-z]+)?|PT0S|0)\s*", re.IGNORECASE)
"""Text that some tools write where there is no time."""


def _several_times(chart: CheckedChart) -> Iterator[Finding]:
    first: dict[tuple[str, ...], tuple[str, str]] = {}
    for use in uses(chart):
        if not use.association.qualifier.needs_duration or _no_time(use.association.duration):
            continue
        time = (use.association.duration or "").strip().upper()
        known = first.setdefault(use.path, (time, use.step.name))
        if known[0] != time:
            message = f"{use.name} has another time here ({use.association.duration}) than in step {known[1]}"
            yield Finding(use.sheet.at(use.step, use.association), message)


def _foreign(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, association in chart.actions():
        if association.kind is None and association.qualifier not in chart.profile.qualifiers:
            message = f"there is no qualifier {association.qualifier} here"
            yield Finding(sheet.at(step, association), message)


def _nothing_done(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, association in chart.actions():
        if not association.target and association.body is None and association.forcing is None:
            yield Finding(sheet.at(step, association), "the association names no action and no variable")


def _step_actions(chart: CheckedChart) -> Iterator[Finding]:
    if chart.pou is None:
        return
    known = {action.name.casefold() for action in chart.pou.actions} | {m.name.casefold() for m in chart.pou.methods}
    for sheet, step in chart.steps():
        for kind, name in step.step_actions.items():
            if isinstance(name, str) and name.isidentifier() and name.casefold() not in known:
                yield Finding(sheet.at(step), f"the POU has no action {name!r}, the {kind} action of the step")


def _more_than_nine(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step in chart.steps():
        count = sum(not association.exclude for association in step.actions)
        if count > _NINE:
            yield Finding(sheet.at(step), f"the step has {count} associations")


def _initial_with_actions(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for step, association in sheet.actions():
            if step.initial:
                yield Finding(sheet.at(step, association), "the initial step has an association")
                break


# -- S7-GRAPH


def _events(chart: CheckedChart) -> Iterator[Finding]:
    names = {step.name.casefold() for _, step in chart.steps()} | {"s_all"}
    for sheet, step, association in chart.actions():
        place = sheet.at(step, association)
        qualifier = association.qualifier
        if qualifier in NEED_EVENT and association.event in (None, ActionEvent.C):
            yield Finding(place, f"the qualifier {qualifier} needs an event")
        switched = association.target if qualifier in (Qualifier.ON, Qualifier.OFF) else None
        if switched and switched.strip('#"').casefold() not in names:
            yield Finding(place, f"{qualifier} names {switched!r}, which is no step of this block")


def _guards(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, association in chart.actions():
        place = sheet.at(step, association)
        if (association.interlock or association.event is ActionEvent.C) and "interlock" not in step.conditions:
            yield Finding(place, "the action depends on the interlock, and the step has none")
        elif association.event in (ActionEvent.L0, ActionEvent.L1) and "interlock" not in step.conditions:
            yield Finding(place, f"the event {association.event} never comes: the step has no interlock")
        elif association.event in (ActionEvent.V0, ActionEvent.V1) and "supervision" not in step.conditions:
            yield Finding(place, f"the event {association.event} never comes: the step has no supervision")


ACT01 = Rule(
    code="ACT01",
    title="A timed qualifier has a time",
    why="L, D, SD, DS and SL do nothing, or something at once, without one (IEC 61131-3 ed. 3, table 59). CoDeSys and "
    "CODESYS refuse the chart.",
    hint="Add the time.",
    example=ring(second="q(D);"),
    check=_without_time,
    severity=Severity.ERROR,
)

ACT05 = Rule(
    code="ACT05",
    title="A qualifier without time has none",
    why="The time has no effect, although one was probably expected.",
    hint="Remove the time, or use the qualifier that was meant.",
    example=ring(second="q(N, T#5s);"),
    check=_with_time,
    severity=Severity.WARNING,
)

ACT06 = Rule(
    code="ACT06",
    title="An action has one time",
    why="All timed associations of an action share one action control, and that has one time input: which of several "
    "times counts is undefined (IEC 61131-3 ed. 3, 6.7.4.6).",
    hint="Use the same time everywhere, or actions of their own.",
    example=ring("q(L, T#2s);", "q(D, T#5s);"),
    check=_several_times,
    severity=Severity.WARNING,
    severities={"codesys": Severity.INFO, "codesys23": Severity.INFO, "s7graph": None, "grafcet": None},
)

ACT07 = Rule(
    code="ACT07",
    title="The qualifier exists in the tool",
    why="S7-GRAPH has no P, P0, P1, SD, DS and SL; IEC 61131-3 has no CALL, no ON and OFF, no counters and timers; "
    "no tool documents what DL of TC6 does.",
    hint="Express it in another way: P1 is the event S1 of S7-GRAPH, SD a set action and a timer.",
    example=ring("q(P1);"),
    check=_foreign,
    severity=Severity.ERROR,
)

ACT08 = Rule(
    code="ACT08",
    title="An association names what it executes",
    why="An association without an action, a variable or code does nothing.",
    hint="Name the action, or remove the line.",
    example="a line of an action block with the qualifier N and nothing else",
    check=_nothing_done,
    severity=Severity.WARNING,
)

ACT09 = Rule(
    code="ACT09",
    title="Step actions exist",
    why="The entry, main or exit action of a step names an action of the POU that is not there: the chart does not "
    "compile.",
    hint="Add the action, or correct the name.",
    example="a step with the entry action Start in a POU without an action Start",
    check=_step_actions,
    severity=Severity.ERROR,
)

ACT14 = Rule(
    code="ACT14",
    title="An IEC step of CoDeSys V2.3 has up to nine associations",
    why="CoDeSys V2.3 takes nine.",
    hint="Put several of them into one action, or into a step that is active at the same time.",
    example="a step with ten lines in its action block",
    check=_more_than_nine,
    severity=None,
    severities={"codesys23": Severity.ERROR},
)

ACT15 = Rule(
    code="ACT15",
    title="The initial step of CoDeSys V2.3 has no associations",
    why="In CoDeSys V2.3 the initial step that the editor makes cannot be associated with actions.",
    hint="Let a step with the transition TRUE before it do what the initial step shall do.",
    example="an initial step with N Ready",
    check=_initial_with_actions,
    severity=None,
    severities={"codesys23": Severity.WARNING},
)

ACT16 = Rule(
    code="ACT16",
    title="Events of S7-GRAPH are at the actions that need them",
    why="ON, OFF, counters and all timers but TF act on an event only, and ON and OFF switch steps of their own block "
    "(S7-GRAPH manual, actions).",
    hint="Add the event (S1: when the step becomes active), or name a step of this block.",
    example="an action ON Step5 without an event",
    check=_events,
    severity=None,
    severities={"s7graph": Severity.ERROR},
)

ACT17 = Rule(
    code="ACT17",
    title="Actions wait for conditions that the step has",
    why="An action with C, or with one of the events L0, L1, V0 and V1, depends on the interlock or the supervision "
    "of its step. Without one, C is always true, and the events never come.",
    hint="Program the interlock or supervision, or remove the event.",
    example="an action with the event V1 in a step without supervision",
    check=_guards,
    severity=None,
    severities={"s7graph": Severity.WARNING},
)
