"""Charts written as they are read: steps and conditions in turn, with selections and simultaneous sequences as parts.

    chart.add_sequence(
        step("Wait", initial=True), "Start",
        step("Fill", actions=["N Valve"], max_time="T#30s"),
        selection(
            ["Full"],
            ["Stop", jump("Wait")],
        ),
        simultaneous([step("Heat")], [step("Mix")]), "Done",
        jump("Wait"),
    )

Sequences are built by `SfcNetwork.add_sequence` and `Project.add_program`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from plcopen_sfc.errors import ModelError, shown
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.binding.name_sites import Reference
from plcopen_sfc.languages.binding.text_sites import Role, Site
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition
from plcopen_sfc.languages.st.walking import children
from plcopen_sfc.model.actions import COUNTERS, SWITCHES, Qualifier
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Condition, SfcNetwork, Step, StepKey, Transition, step_codes
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.refactor.queries import pou_of


@dataclass(frozen=True, slots=True)
class StepPart:
    """A step of a sequence: the arguments of `SfcNetwork.add_step`."""

    name: str
    fields: Mapping[str, Any]

    def __str__(self) -> str:
        return f"the step {self.name!r}"


@dataclass(frozen=True, slots=True)
class TransitionPart:
    """A transition of a sequence, between what is before it and what is after it."""

    condition: Condition | str | None
    fields: Mapping[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        text = self.condition.text if isinstance(self.condition, Expression) else self.condition
        return f"the condition {text!r}"


@dataclass(frozen=True, slots=True)
class SelectionPart:
    """A selection of sequences: each branch begins with its condition and ends with one, or with a jump."""

    branches: tuple[Sequence[Any], ...]

    def __str__(self) -> str:
        return "the selection"


@dataclass(frozen=True, slots=True)
class SimultaneousPart:
    """Simultaneous sequences: each branch begins and ends with a step."""

    branches: tuple[Sequence[Any], ...]

    def __str__(self) -> str:
        return "the simultaneous sequences"


@dataclass(frozen=True, slots=True)
class JumpPart:
    """The end of a sequence or branch: the transition before it leads to a step of the chart, also to a later one."""

    target: str

    def __str__(self) -> str:
        return f"the jump to {self.target!r}"


def step(name: str, **fields: Any) -> StepPart:
    """Make a step of a sequence, with the arguments of `SfcNetwork.add_step`."""
    return StepPart(name, fields)


def transition(condition: Condition | str | None, **fields: Any) -> TransitionPart:
    """Make a transition with more than a condition: `name`, `priority`, `comment` and other fields of `Transition`."""
    return TransitionPart(condition, fields)


def selection(*branches: Sequence[Any]) -> SelectionPart:
    """Make a selection of sequences: lists of parts, which are tried from the first to the last."""
    return SelectionPart(branches)


def simultaneous(*branches: Sequence[Any]) -> SimultaneousPart:
    """Make simultaneous sequences: lists of parts."""
    return SimultaneousPart(branches)


def jump(target: str) -> JumpPart:
    """Make a jump to the step of this name."""
    return JumpPart(target)


def add_sequence(
    chart: SfcNetwork, parts: Sequence[Any], after: StepKey | None = None, *, declare: bool = True
) -> None:
    """Append a sequence to a chart; `SfcNetwork.add_sequence` has the rules."""
    building = _Building(chart)
    steps, transitions = len(chart.steps), len(chart.transitions)
    try:
        start = after if isinstance(after, Step) or after is None else chart.step(after)
        ends = building.run(parts, _Ends((start.id,)) if start is not None else _BEGINNING)
        if ends.transitions:
            raise ModelError("a sequence ends with a step or a jump", hint='Append jump("..") or a step.')
        building.resolve_jumps()
    except ModelError:
        chart.steps = chart.steps[:steps]
        chart.transitions = chart.transitions[:transitions]
        raise
    if declare:
        declare_named(chart, chart.steps[steps:], chart.transitions[transitions:], building.codes)


def append_branch(chart: SfcNetwork, parts: Sequence[Any]) -> tuple[int, tuple[int, ...]]:
    """Append a branch of simultaneous sequences; give the ids of its first step and of its last steps."""
    building = _Building(chart)
    steps, transitions = len(chart.steps), len(chart.transitions)
    ends = building.branch(parts)
    building.resolve_jumps()
    declare_named(chart, chart.steps[steps:], chart.transitions[transitions:], building.codes)
    return ends


@dataclass(frozen=True, slots=True)
class _Ends:
    """Open ends of a sequence: the steps that the next transition leaves, or the transitions to the next step."""

    steps: tuple[int, ...] = ()
    transitions: tuple[Transition, ...] = ()
    closed: bool = False


_BEGINNING = _Ends()
_CLOSED = _Ends(closed=True)


class _Building:
    """A sequence that is being built. `codes` are statements of actions by their names."""

    def __init__(self, chart: SfcNetwork) -> None:
        self.chart = chart
        self.codes: dict[str, str] = {}
        self._jumps: list[tuple[Transition, str]] = []

    def run(self, parts: Sequence[Any], ends: _Ends) -> _Ends:
        for part in parts:
            if ends.closed:
                raise ModelError(f"{part} is behind a jump", hint="Nothing can follow the end of a sequence.")
            ends = self._append(TransitionPart(part) if isinstance(part, str) else part, ends)
        return ends

    def resolve_jumps(self) -> None:
        for transition, target in self._jumps:
            transition.targets = [self.chart.step(target).id]

    def _append(self, part: Any, ends: _Ends) -> _Ends:
        match part:
            case StepPart():
                if ends.steps:
                    raise ModelError(f"{part} is behind a step", hint="A condition comes between two steps.")
                return _Ends((self._enter(ends, [self._step(part)])[0],))
            case SimultaneousPart():
                if not ends.transitions:
                    raise ModelError(f"{part} need a condition before them")
                found = [self.branch(branch) for branch in part.branches]
                self._enter(ends, [first for first, _ in found])
                return _Ends(tuple(last for _, lasts in found for last in lasts))
            case JumpPart():
                if not ends.transitions:
                    raise ModelError(f"{part} needs a condition before it")
                self._jumps += [(transition, part.target) for transition in ends.transitions]
                return _CLOSED
            case SelectionPart() | TransitionPart():
                if not ends.steps:
                    raise ModelError(f"{part} needs a step before it")
                if isinstance(part, SelectionPart):
                    return self._select(part, ends)
                made = self.chart.add_transition(ends.steps, [], part.condition)
                for name, value in part.fields.items():
                    setattr(made, name, value)
                return _Ends(transitions=(made,))
            case _:
                raise ModelError(
                    f"{shown(part)} is no part of a chart",
                    hint="Parts are texts (conditions), step, transition, selection, simultaneous and jump.",
                )

    def _select(self, part: SelectionPart, ends: _Ends) -> _Ends:
        transitions: list[Transition] = []
        for branch in part.branches:
            last = self.run(branch, ends)
            if last.steps:
                raise ModelError("a branch of a selection ends with a condition or a jump")
            transitions += last.transitions
        return _Ends(transitions=tuple(transitions)) if transitions else _CLOSED

    def branch(self, branch: Sequence[Any]) -> tuple[int, tuple[int, ...]]:
        if not branch or not isinstance(branch[0], StepPart):
            raise ModelError("a branch of simultaneous sequences begins with a step")
        first = self._step(branch[0])
        last = self.run(branch[1:], _Ends((first,)))
        if not last.steps:
            raise ModelError("a branch of simultaneous sequences ends with a step")
        return first, last.steps

    def _enter(self, ends: _Ends, targets: list[int]) -> list[int]:
        for transition in ends.transitions:
            transition.targets = targets
        return targets

    def _step(self, part: StepPart) -> int:
        made = self.chart.add_step(part.name, declare=False, **part.fields)
        self.codes.update(step_codes(made, part.fields.get("actions", ())))
        return made.id


# -- declarations


def declare_named(
    chart: SfcNetwork, steps: Iterable[Step], transitions: Iterable[Transition], codes: Mapping[str, str]
) -> None:
    """Declare in the POU of a chart what steps and transitions name and nothing declares.

    Targets without a value become BOOL outputs, counters of S7-GRAPH INT variables, durations TIME inputs, operands of
    conditions BOOL inputs. `codes` are statements of actions by their names. All others stay undeclared: their types
    are not known.
    """
    pou, project = pou_of(chart), chart.project
    if pou is None:
        return
    for name, code in codes.items():
        if pou.find_action(name) is None:
            pou.add_action(name, code)
    names = Names(project or Project(pous=[pou]))
    site = Site(pou=pou, charts=(chart,), place=pou.place)
    declared: set[str] = set()
    for name, type_, kind in _wanted(steps, transitions, names):
        known = names.resolver.lookup(Reference(name, (0, 0), Role.ACTION), site)
        if known.declaration is None and not known.doubt and name.casefold() not in declared:
            declared.add(name.casefold())
            pou.add_variable(name, type_, kind)


def _wanted(
    steps: Iterable[Step], transitions: Iterable[Transition], names: Names
) -> Iterator[tuple[str, str, SectionKind]]:
    """Yield names with the types that their places give them, and the sections that they are declared in."""
    steps = list(steps)
    associations = [association for each in steps for association in each.actions]
    for association in associations:
        if association.qualifier in COUNTERS:
            yield from ((name, "INT", SectionKind.LOCAL) for name in _operands(association.target, names))
        elif association.value is None and association.qualifier not in _NO_VARIABLES:
            yield from ((name, "BOOL", SectionKind.OUTPUT) for name in _operands(association.target, names))
    for association in associations:
        yield from ((name, "TIME", SectionKind.INPUT) for name in _operands(association.duration, names))
    conditions = [each.condition for each in transitions]
    conditions += [condition for step in steps for condition in step.conditions.values()]
    texts = [each.text for each in conditions if isinstance(each, Expression)]
    for text in texts:
        yield from ((name, "BOOL", SectionKind.INPUT) for name in _operands(text, names))


_NO_VARIABLES = SWITCHES | {Qualifier.CALL}
"""Their targets are steps and blocks."""

_JOINING = n.CONNECTIVES | {n.Operator.NOT}


def _operands(text: str | None, names: Names) -> Iterator[str]:
    """Yield the plain names that a text consists of, or joins by AND, OR, XOR and NOT."""
    waiting: list[n.Node] = [parse_condition(text, names.dialect).tree] if text else []
    while waiting:
        node = waiting.pop()
        if isinstance(node, n.Name):
            yield node.identifier
        elif isinstance(node, n.Parenthesized):
            waiting.append(node.inner)
        elif isinstance(node, n.Unary | n.Operation) and node.operator in _JOINING:
            waiting += reversed([*children(node)])
