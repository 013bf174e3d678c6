"""Coverage of a comparison: how much of two charts or programs it executed, what it did not, and why."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from plcopen_sfc.analysis.deciding_parts import ConditionPart, ConditionParts
from plcopen_sfc.analysis.exclusivity import association_condition
from plcopen_sfc.analysis.systems import Observation, ProgramSystem
from plcopen_sfc.analysis.unreachable import Unreachable
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.st import parse_condition, print_node
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.model import conditions
from plcopen_sfc.model.actions import SWITCHES, ActionEvent, Qualifier
from plcopen_sfc.model.sfc import ActionAssociation
from plcopen_sfc.semantics.charts.graph.graph_parameters import OPERATING
from plcopen_sfc.semantics.charts.graph.graph_program import GraphProgram
from plcopen_sfc.semantics.charts.running_chart import RunningChart
from plcopen_sfc.semantics.charts.step_state import ActionOrigin
from plcopen_sfc.semantics.net import Net, NetTransition, indexes
from plcopen_sfc.semantics.programs.marks import MarkedBranch

STEP, TRANSITION, ACTION, ASSIGNMENT = "step", "transition", "action", "assignment"
PART = "part of condition"
OUTCOME = "outcome of comparison"
DECISION = "outcome of condition"
_INSIDE = frozenset({PART, OUTCOME, DECISION})
"""Kinds that are no elements, but what is asked in one: a search for a proof does not count them."""
_SHOWN = 10
_DELAYED = (Qualifier.D, Qualifier.SD, Qualifier.DS)
_LIMITED = (Qualifier.L, Qualifier.SL)

_UNDECIDED = ("can never decide it", "never decided it")

_REGISTERING = frozenset({"reg_ef", "reg_s"})
_NO_EVENT = "the event R1, which nothing registers (proven)"
_SWITCHING = frozenset(name.casefold() for name in OPERATING) - {"ack_ef"} - _REGISTERING
"""Operating inputs of S7-GRAPH that switch steps, or have something else than conditions switch them."""
_ENTERING = frozenset({"s_on"})
"""Those that may enter any step."""

Key = tuple[str, str, int, str]
"""A part that can be reached: the chart or text that it is in, its name, a number where names are not unique, and the
condition behind which an assignment is, or the part of the condition of a transition. An outcome has its value as
number, a part of a condition in a text -1."""


@dataclass(frozen=True)
class Unreached:
    """A step, transition, action or assignment that was not executed, or a part of a condition, and why.

    Or an outcome that a condition of a program, or a comparison which is assigned, did not have, or a value that a
    Boolean did not have where it was tested: then `value` is TRUE or FALSE.

    `impossible`: it is proven that nothing reaches it. `follows`: it is behind a step that was not entered.
    """

    kind: str
    name: str
    why: str
    impossible: bool = False
    value: str = ""
    follows: bool = False

    @property
    def key(self) -> tuple[str, ...]:
        """Key that tells it from all else that was not reached."""
        return (self.kind, self.name, self.value)

    def __str__(self) -> str:
        if self.kind == PART:
            return f"{TRANSITION} {self.name} {self.why}"
        if self.kind == OUTCOME:
            return f"{ASSIGNMENT} {_quoted(self.name)} {self.why}"
        if self.kind == DECISION:
            return f"condition {self.name} {self.why}"
        return f"{self.kind} {self.name}: {self.why}"


@dataclass(frozen=True)
class Coverage:
    """Coverage of one side of a comparison.

    `counts`: by kind (``step``, ``transition`` and ``action`` of a chart, ``assignment`` of a program or of the actions
    of a chart) how many were reached, and how many there are; without a proof also ``part of condition``, those that
    have decided it or, of Booleans, the values that were tested, and ``outcome of comparison``, TRUE and FALSE of each
    comparison that is assigned, and ``outcome of condition``, TRUE and FALSE of each condition in programs, and their
    parts.
    """

    name: str
    counts: Mapping[str, tuple[int, int]]
    unreached: tuple[Unreached, ...] = ()

    @property
    def has_chart(self) -> bool:
        """True if this side is a chart."""
        return STEP in self.counts

    @property
    def untested(self) -> tuple[Unreached, ...]:
        """Parts that were not reached though they may be reachable."""
        return tuple(each for each in self.unreached if not each.impossible)

    def led(self) -> Coverage:
        """Return the coverage of code with what its chart does not tell: assignments that may be executed."""
        return replace(self, unreached=tuple(each for each in self.untested if each.kind == ASSIGNMENT))

    def joined(self, other: Coverage) -> Coverage:
        """Return the coverage here or there, in two searches of the same side."""
        # a proof, which may have been made with some inputs at rest, does not tell these
        told_here_only = _INSIDE - other.counts.keys()
        known = {each.key: each for each in other.unreached}
        known |= {each.key: each for each in self.unreached if each.kind in told_here_only}
        both = [(each, known[each.key]) for each in self.unreached if each.key in known]
        unreached = tuple(mine if mine.impossible else theirs for mine, theirs in both)
        missing = Counter(each.kind for each in unreached)
        counts = {kind: (all_ - missing[kind], all_) for kind, (_, all_) in self.counts.items()}
        return Coverage(self.name, counts, unreached)

    def __str__(self) -> str:
        counts = ", ".join(
            f"{reached} of {all_} {_plural(kind)}" for kind, (reached, all_) in self.counts.items() if all_
        )
        return counts or "nothing to be reached"

    def missing(self) -> str:
        """Return how much that may be reachable was not reached, but for what is behind a step that was not entered."""
        counts = Counter(each.kind for each in self.untested if not each.follows)
        return ", ".join(f"{count} {kind if count == 1 else _plural(kind)}" for kind, count in counts.items())

    def lines(self) -> list[str]:
        """Return the things not reached, a line for each reason; behind the first ones only how many there are.

        Elements that may be reachable come first. Those behind a step that was not entered are only counted.
        """
        following = Counter(each.kind for each in self.unreached if each.follows)
        behind = ", ".join(f"{count} {kind if count == 1 else _plural(kind)}" for kind, count in following.items())
        lines = [line for impossible in (False, True) for line in self._lines(impossible)]
        more = len(lines) - _SHOWN
        lines = [*lines[:_SHOWN], f"not reached for other reasons: {more}"] if more > 0 else lines
        return [*lines, f"not reached behind these steps: {behind}"] if behind else lines

    def _lines(self, impossible: bool) -> list[str]:
        known = [each for each in self.unreached if each.impossible is impossible and not each.follows]
        together = grouped(
            ((each.kind, each.why), each.name)
            for each in known
            if each.kind not in _INSIDE or each.why.startswith("needs ")
        )
        for kind, why in list(together):
            if kind == TRANSITION and (STEP, why) in together:  # told by the steps behind it
                del together[kind, why]
        lines = [
            f"not reached: {kind}{'s' * (len(names) > 1)} {listed(names)}: {why}"
            for (kind, why), names in together.items()
        ]
        # of a transition that never fired no parts are told, of an assignment that was not executed no outcomes
        missed = {(each.kind, each.name) for each in self.unreached}
        parts = [each for each in known if each.kind == PART]
        alone = [each for each in parts if (TRANSITION, each.name.partition(": `")[0]) not in missed]
        alone += [each for each in known if each.kind == OUTCOME and (ASSIGNMENT, each.name) not in missed]
        alone += [each for each in known if each.kind == DECISION and not each.why.startswith("needs ")]
        return lines + [f"not reached: {each}" for each in alone]

    def as_dict(self) -> dict[str, Any]:
        """Return the coverage as plain data, for JSON."""
        return {
            "name": self.name,
            "counts": {kind: {"reached": reached, "all": all_} for kind, (reached, all_) in self.counts.items()},
            "unreached": [
                {"kind": each.kind, "name": each.name, "why": each.why, "impossible": each.impossible}
                for each in self.unreached
            ],
        }


class Tally:
    """Record of what a search reached of a system, and of systems that are parts of it.

    Elements of the compared POU count, and those of blocks and functions that it calls, unless they are the
    same on both sides.
    """

    def __init__(self, system: ProgramSystem) -> None:
        self.system = system
        self._parts = [system]
        self.parts: ConditionParts | None = None

    def add(self, part: ProgramSystem) -> None:
        """Count what a part of the system reaches, too."""
        self._parts.append(part)

    def look_at_conditions(self) -> ConditionParts:
        """Count the parts of conditions that decide them, from now on."""
        self.parts = self.parts or ConditionParts(self.system, _charts(self.system))
        self.system.marks.watch()
        return self.parts

    def reached(self, kind: str) -> set[Key]:
        """Parts that were reached."""
        if kind == PART:
            return {_key(part) for part in self.parts or () if part.is_seen}
        return {key for part in self._parts for key, is_reached in _of_kind(part, kind) if is_reached}

    def numbers(self) -> tuple[int, int]:
        """Return how many steps, or assignments, were reached, and how many there are."""
        kind = STEP if _charts(self.system) else ASSIGNMENT
        everything = {key for key, _ in _of_kind(self.system, kind)}
        return len(self.reached(kind) & everything), len(everything)

    def coverage(
        self,
        *,
        complete: bool,
        chart: Unreachable | None = None,
        never: Sequence[Expression] = (),
        is_late: Callable[[], bool] = lambda: False,
    ) -> Coverage:
        """Return the coverage. `complete`: all that the system can do was searched; `is_late`: no time is left.

        Of code that does the same as a chart: what nothing reaches there, and flags of steps that are `never` TRUE.
        """
        kinds: tuple[str, ...] = (STEP, TRANSITION, ACTION) if counted_charts(self.system) else ()
        kinds += (PART, ASSIGNMENT) if _charts(self.system) else (ASSIGNMENT,)
        kinds += (OUTCOME, DECISION) if self.parts is not None else ()
        counts: dict[str, tuple[int, int]] = {}
        missing: dict[str, list[Key]] = {}
        reached: dict[str, set[Key]] = {}
        for kind in kinds:
            if kind == PART:
                everything = dict.fromkeys(map(_key, self.parts or ()))
            else:
                everything = dict.fromkeys(key for key, _ in _of_kind(self.system, kind))
            reached[kind] = self.reached(kind)
            missing[kind] = [key for key in everything if key not in reached[kind]]
            if everything or kind in kinds[:3]:
                counts[kind] = len(everything) - len(missing[kind]), len(everything)
        unreached: list[Unreached] = []
        if any(missing.values()):
            deciding = {_key(part): part for part in self.parts or ()}
            unreachable = unreachable_in(self.system, chart, never, is_late)
            reasons = _Reasons(self.system, reached, deciding, unreachable, complete=complete)
            unreached = [reasons.of(kind, key) for kind in kinds for key in missing[kind]]
        return Coverage(self.system.subject.name, counts, tuple(unreached))


def coverage_of(
    tallies: tuple[Tally, Tally],
    pairs: Iterable[tuple[Observation, Observation]],
    *,
    complete: bool,
    is_late: Callable[[], bool] = lambda: False,
) -> tuple[Coverage, Coverage]:
    """Return the coverage of two sides, of which `pairs` are compared: a chart tells of code beside it."""
    left, right = tallies
    own = left.coverage(complete=complete, is_late=is_late)
    if not _charts(left.system) or _charts(right.system):
        return own, right.coverage(complete=complete, is_late=is_late)
    chart = unreachable_in(left.system, is_late=is_late)
    dead = chart.dead_paths()
    flags = [
        parse_condition(str(code), right.system.subject.project.dialect) for own, code in pairs if own.path in dead
    ]
    never = [flag.tree for flag in flags if flag.tree is not None]
    return own, right.coverage(complete=complete, chart=chart, never=never, is_late=is_late)


def any_untested(coverage: Sequence[Coverage]) -> bool:
    """Return True if something that may be reachable was not reached: of a chart, where there is one.

    Of code beside a chart its assignments count: what they are behind follows from the chart, or is asked for there.
    """
    return any(each.untested for each in led_by_chart(coverage))


def led_by_chart(coverage: Sequence[Coverage]) -> list[Coverage]:
    """Return both sides; of code beside a chart only what that does not tell."""
    is_led = any(each.has_chart for each in coverage)
    return [each.led() if is_led and not each.has_chart else each for each in coverage]


def _key(part: ConditionPart) -> Key:
    return part.owner, part.transition.path, part.transition.transition.id, part.label


def _charts(system: ProgramSystem) -> list[tuple[str, RunningChart]]:
    """Return the charts of the POU itself, if its body is one, with their names."""
    subject = system.subject
    charts = system.instance.unit.charts
    found = [(name, chart) for name, chart in charts if isinstance(chart, RunningChart)]
    own = [each for each in found if each[0] == subject.pou.name]
    # a POU whose body is no chart is a program; the chart of an action runs as the body of a POU that is like its own
    return found if own and subject.name == subject.pou.name else own


def counted_charts(system: ProgramSystem) -> list[tuple[str, RunningChart]]:
    """Return the charts that count, with their names: its own, and those of called POUs that the other side has not."""
    called = [
        (name, chart)
        for unit in system.instance.controller.library.units.values()
        for name, chart in unit.charts
        if unit.pou.name in system.also_counted and isinstance(chart, RunningChart)
    ]
    return _charts(system) + called


def _of_kind(system: ProgramSystem, kind: str) -> Iterator[tuple[Key, bool]]:
    """Yield all of a kind, each with True if it was reached."""
    if kind in _OF_TEXTS:
        yield from ((key, is_reached) for branch, is_reached in _branches(system) for key in _keys(branch, kind))
        return
    for name, chart in counted_charts(system):
        reached = chart.reached
        if kind == STEP:
            for step in chart.net.steps:
                yield (name, step.path, step.step.id, ""), bool(reached.steps & step.bit)
        elif kind == TRANSITION:
            for transition in chart.net.transitions:
                key = (name, transition.path, transition.transition.id, "")
                yield key, bool(reached.transitions & transition.bit)
        else:
            for number, label in enumerate(reached.labels):
                yield (name, label, 0, ""), bool(reached.actions >> number & 1)


def _branches(system: ProgramSystem) -> Iterator[tuple[MarkedBranch, bool]]:
    marks = system.marks
    for branch, is_reached in zip(marks.branches, marks.reached, strict=True):
        if branch.owner in system.uncalled_actions:
            continue
        if _is_own(system, branch.owner) or re.split(r"[. ]", branch.owner)[0] in system.also_counted:
            yield branch, is_reached


def _is_own(system: ProgramSystem, owner: str) -> bool:
    """Return True for texts of the compared POU itself."""
    own = system.instance.unit.pou.name
    return owner == own or owner.startswith((f"{own}.", f"{own} "))


_OF_TEXTS = (ASSIGNMENT, OUTCOME, DECISION)


def _keys(branch: MarkedBranch, kind: str) -> Iterator[Key]:
    """Yield what of a kind is reached where a branch is executed."""
    if kind == ASSIGNMENT:
        yield from ((branch.owner, text, 0, branch.condition) for text in branch.assignments)
    elif kind == OUTCOME and branch.outcome is not None:
        text, value = branch.outcome
        yield branch.owner, text, int(value), branch.inside
    elif kind == DECISION and branch.decides is not None:
        condition, part, decided = branch.decides
        label = f"{_quoted(condition)}: {_quoted(part)}" if part else _quoted(condition)
        yield branch.owner, label, -1 if decided is None else int(decided), branch.inside


def unreachable_in(
    system: ProgramSystem,
    chart: Unreachable | None = None,
    never: Sequence[Expression] = (),
    is_late: Callable[[], bool] = lambda: False,
) -> Unreachable:
    """Return the unreachable parts; with forcing orders none are known.

    In S7-GRAPH actions and operating inputs that do not rest switch steps, too. Of code that does the same as a chart
    see `Tally.coverage`.
    """
    charts = _charts(system)
    fired = {name: chart.reached.transitions for name, chart in charts}
    nets = {name: each.net for name, each in charts if not any(chart.net.hierarchy for _, chart in charts)}
    operated = _are_operated(system, charts, _SWITCHING)
    entered = _are_operated(system, charts, _ENTERING)
    return Unreachable(system, nets, fired, chart, never, operated=operated, entered=entered, is_late=is_late)


def _are_operated(system: ProgramSystem, charts: Iterable[tuple[str, RunningChart]], names: Set[str]) -> bool:
    """True if actions of sequencers, or some operating inputs (lower case), may switch steps."""
    graphs = [chart for _, chart in charts if isinstance(chart, GraphProgram)]
    rows = (row for chart in graphs for step in chart.net.steps for row in step.step.actions)
    return bool(graphs) and (_may_operate(system, names) or any(row.qualifier in SWITCHES for row in rows))


def _may_operate(system: ProgramSystem, names: Set[str]) -> bool:
    """True if a block declares one of some operating inputs (lower case), and it does not rest."""
    declared = {variable.name.casefold() for variable in system.subject.pou.variables()}
    return not declared & names <= {name for name, value in system.fixed.items() if not value}


class _Reasons:
    """Reasons why something was not reached."""

    def __init__(
        self,
        system: ProgramSystem,
        reached: Mapping[str, set[Key]],
        parts: Mapping[Key, ConditionPart],
        unreachable: Unreachable,
        *,
        complete: bool,
    ) -> None:
        self._system = system
        self._reached = reached
        self._parts = parts
        self._unreachable = unreachable
        self._complete = complete
        self._nets = {name: chart.net for name, chart in counted_charts(system)}

    def of(self, kind: str, key: Key) -> Unreached:
        name, label, number, _ = key
        if kind in (OUTCOME, DECISION):
            return self._outcome(kind, key)
        several = (len(self._nets) > 1 and kind != ASSIGNMENT) or not _is_own(self._system, name)
        shown = f"{name}: {label}" if several else label
        if kind == ASSIGNMENT:
            return self._assignment(shown, key)
        net = self._nets[name]
        if kind == ACTION:
            why, impossible = self._not_executed(name, label, net)
            follows = all(each.startswith("needs step ") for each in why.split(" or "))
            return Unreached(kind, shown, why, impossible=impossible or self._complete, follows=follows)
        if kind == PART:
            return self._undecided(shown, key)
        if kind == STEP:
            index = next(s.index for s in net.steps if s.path == label and s.step.id == number)
            impossible = index in self._unreachable.steps.get(name, ())
            why = "unreachable (proven)" if impossible else self._way_to(name, net, {index})
        else:
            transition = next(t for t in net.transitions if (t.path, t.transition.id) == key[1:3])
            impossible = transition.index in self._unreachable.transitions.get(name, ())
            why = "can never fire (proven)" if impossible else self._needs(name, net, transition)
        if self._complete and not impossible:
            why, impossible = f"{why} (proven)", True
        follows = kind == TRANSITION and not self._reached_steps(name, net).issuperset(transition.sources)
        return Unreached(kind, shown, why, impossible=impossible, follows=follows)

    def _assignment(self, shown: str, key: Key) -> Unreached:
        owner, text, _, condition = key
        if self._unreachable.is_never_executed(owner):
            return Unreached(ASSIGNMENT, shown, "the code around it is never executed (proven)", impossible=True)
        never = self._never_true(ASSIGNMENT, key)
        if never:
            return Unreached(ASSIGNMENT, shown, f"needs {never}, never TRUE (proven)", impossible=True)
        if self._waits_for_nothing(owner, text):
            return Unreached(ASSIGNMENT, shown, f"needs {_NO_EVENT}", impossible=True)
        why = f"needs {_quoted(condition)}, never reached" if condition else "the code around it was not executed"
        follows = not condition and self._has_unentered
        return Unreached(ASSIGNMENT, shown, why, impossible=self._complete, follows=follows)

    def _outcome(self, kind: str, key: Key) -> Unreached:
        owner, name, number, inside = key
        is_own = _is_own(self._system, owner)
        shown = name if is_own else f"{owner}: {name}"
        value = {1: "TRUE", 0: "FALSE"}.get(number, "")
        leading = self._leading_to[kind, key]
        if kind == DECISION and not any(self._system.marks.reached[each.around] for each in leading):
            why, impossible = "the code around it was not executed", self._unreachable.is_never_executed(owner)
            if inside:
                impossible |= bool(self._never_true(kind, key))
                why = f"needs {_quoted(inside)}, never reached"
            why = f"{why} (proven)" if impossible else why
            return Unreached(kind, shown, why, impossible=impossible, value=value)
        around = kind == OUTCOME and self.of(ASSIGNMENT, (owner, name, 0, inside)).impossible
        is_never, was_never = (f"is never {value}", f"was never {value}") if value else _UNDECIDED
        if around or self._never_true(kind, key):
            return Unreached(kind, shown, f"{is_never} (proven)", impossible=True, value=value)
        frozen = [self._unreachable.frozen_by(each.guards, self._system.subject.pou.chart) for each in leading]
        if is_own and all(frozen):
            return Unreached(kind, shown, f"{was_never}, as {_kept(frozen[0])}", impossible=True, value=value)
        return Unreached(kind, shown, was_never, value=value)

    def _not_executed(self, name: str, label: str, net: Net) -> tuple[str, bool]:
        """Return why an action was never executed, and True if nothing can execute it."""
        chart = next(chart for own, chart in counted_charts(self._system) if own == name)
        told: dict[str, bool] = {}
        entered = sum(1 << index for index in self._reached_steps(name, net))
        dead = sum(1 << index for index in self._unreachable.steps.get(name, ()))
        for found, origins in zip(chart.reached.labels, chart.reached.origins, strict=True):
            for origin in origins if found == label else ():
                told.setdefault(*self._idle(name, origin, entered, dead))
        known = [why for why, impossible in told.items() if not impossible] or list(told)
        return " or ".join(known) or "was never executed", all(told.values()) and bool(told)

    def _idle(self, name: str, origin: ActionOrigin, entered: int, dead: int) -> tuple[str, bool]:
        """Return why a step did not execute an action, and True if it cannot."""
        steps, association = origin
        net = self._nets[name]
        step = ", ".join(net.names(steps))
        if not steps & ~dead:
            return f"needs step {step}, unreachable (proven)", True
        if association is not None and association.qualifier is Qualifier.R and association.event is None:
            return f"step {step} only resets it", True
        if not steps & entered:
            return f"needs step {step}, never entered", False
        if association is None:
            return f"step {step} never executed it", False
        if self._never_comes(association):
            return f"needs {_NO_EVENT}", True
        condition = association_condition(association, self._system.subject.project.dialect)
        if condition is not None and self._unreachable.is_impossible([condition], self._system.subject.pou.chart):
            return f"needs {_quoted(print_node(condition))}, never TRUE (proven)", True
        time = association.duration if association.qualifier in _DELAYED else None
        is_plain = association.qualifier is not Qualifier.SD and not association.negated
        if (
            time
            and is_plain
            and all(self._unreachable.is_left_before(name, net.steps[i], time) for i in indexes(steps))
        ):
            return f"step {step} is left before {time} has passed (proven)", True
        limit = association.duration if association.qualifier in _LIMITED else None
        if limit and not association.negated and self._unreachable.is_no_time(limit, self._system.subject.pou.chart):
            return f"its time {limit} is over at once (proven)", True
        needs = [_quoted(print_node(condition))] if condition is not None else []
        needs += [f"{time} to pass ({association.qualifier})"] if time else []
        if association.event is not None:
            needs.append(f"the event {association.event}")
        return f"step {step} never executed it" + (f", needs {' and '.join(needs)}" if needs else ""), False

    def _never_comes(self, association: ActionAssociation) -> bool:
        """True if an action depends on an event that only inputs make which nothing operates."""
        return association.event is ActionEvent.R1 and not _may_operate(self._system, _REGISTERING)

    def _waits_for_nothing(self, owner: str, assignment: str) -> bool:
        """True if an assignment is the value of actions of a step, and their events never come."""
        steps = {f"{name} / step {each.path}": each.step for name, net in self._nets.items() for each in net.steps}
        actions = steps[owner].actions if owner in steps else []
        rows = [row for row in actions if f"{row.target} := {row.value}" == assignment]
        return bool(rows) and all(map(self._never_comes, rows))

    def _never_true(self, kind: str, key: Key) -> str:
        """Return the condition that is needed and never TRUE, in words; empty: that is not proven."""
        told = ""
        for branch in self._leading_to[kind, key]:
            alone = branch.guards[-1:]
            pou = None if _is_own(self._system, branch.owner) else re.split(r"[. ]", branch.owner)[0]
            chart = self._system.subject.pou.chart
            if not branch.guards or not self._unreachable.is_impossible(branch.guards, chart, pou, branch.owner):
                return ""
            is_alone = self._unreachable.is_impossible(alone, chart, pou, branch.owner)
            told = " and ".join(_quoted(print_node(each)) for each in (alone if is_alone else branch.guards))
        return told

    @cached_property
    def _leading_to(self) -> Mapping[tuple[str, Key], list[MarkedBranch]]:
        """The branches in which an assignment is executed, or an outcome occurs."""
        branches = [branch for branch, _ in _branches(self._system)]
        return grouped(((kind, key), each) for each in branches for kind in _OF_TEXTS for key in _keys(each, kind))

    @cached_property
    def _has_unentered(self) -> bool:
        """True if there are steps that were not entered."""
        return any(len(self._reached_steps(name, net)) < len(net.steps) for name, net in self._nets.items())

    def _undecided(self, transition_shown: str, key: Key) -> Unreached:
        part = self._parts[key]
        transition, pou = part.transition, self._system.subject.pou
        value = "" if part.value is None else str(part.value).upper()
        shown = f"{transition_shown}: {_quoted(part.text)}"
        is_never = self._unreachable.is_never_tested(key[0], transition, part.deciding)
        if is_never or transition.index in self._unreachable.transitions.get(key[0], ()):
            why = f"is never {value} (proven)" if value and is_never else "can never decide it (proven)"
            return Unreached(PART, shown, why, impossible=True, value=value)
        why = f"was never {value}" if value else "never decided it"
        frozen = self._unreachable.frozen_by([part.deciding], transition.chart or pou.chart)
        why += f", as {_kept(frozen)}" if frozen else ""
        return Unreached(PART, shown, why, impossible=bool(frozen), value=value)

    # -- what is in the way

    def _reached_steps(self, name: str, net: Net) -> set[int]:
        entered = {(label, number) for chart, label, number, _ in self._reached[STEP] if chart == name}
        return {s.index for s in net.steps if (s.path, s.step.id) in entered}

    def _way_to(self, name: str, net: Net, steps: Iterable[int]) -> str:
        """Return the nearest transitions before steps whose sources were all entered, and which did not fire."""
        entered = self._reached_steps(name, net)
        waiting, seen = list(steps), set(steps)
        while waiting:
            nearest = [t for index in waiting for t in (net.transitions[i] for i in net.entering[index])]
            ready = [t for t in nearest if entered.issuperset(t.sources)]
            if ready:
                return " or ".join(dict.fromkeys(self._needs(name, net, t) for t in ready[:3]))
            waiting = [s for t in nearest for s in t.sources if s not in entered and s not in seen]
            waiting = list(dict.fromkeys(waiting))
            seen.update(waiting)
        return "no transition leads to it from what was reached"

    def _needs(self, name: str, net: Net, transition: NetTransition) -> str:
        missing = set(transition.sources) - self._reached_steps(name, net)
        if missing:
            return f"{self._way_to(name, net, missing)}, never reached".replace(", never reached, never", ", never")
        condition = transition.transition.condition
        if isinstance(condition, conditions.Expression):
            return f"needs {_quoted(condition.text)}, never reached"
        return f"needs the condition of {transition.path}, never reached"


def _kept(names: Sequence[str]) -> str:
    return f"{', '.join(names)} kept {'its value' if len(names) == 1 else 'their values'} (frozen)"


def _plural(kind: str) -> str:
    return {PART: "parts of conditions", OUTCOME: "outcomes of comparisons", DECISION: "outcomes of conditions"}.get(
        kind, f"{kind}s"
    )


def listed(names: Sequence[str]) -> str:
    """Return names, of many only the first ones."""
    more = len(names) - _SHOWN
    return ", ".join(names[:_SHOWN]) + (f" and {more} more" if more > 0 else "")


def _quoted(text: str) -> str:
    flat = " ".join(text.split())
    return f"`{flat}`"
