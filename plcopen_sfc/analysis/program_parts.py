"""Programs in parts: what each reads and writes, and the program with some of them only.

Variables of the POU count as a whole, others by all the names of their paths: ``GVL.x`` may also be written ``x``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from dataclasses import dataclass, replace
from itertools import chain
from typing import Protocol

from plcopen_sfc.errors import SfcError, SimulationError
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding import bind, names_in, with_called
from plcopen_sfc.languages.effects import ANYTHING, Path, is_standard_call, path_of, reads, writes
from plcopen_sfc.languages.networks import condition_reader
from plcopen_sfc.languages.networks.results import NetworkExpression
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.model.actions import COUNTERS, SWITCHES, TIMERS, Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.chart_settings import GRAPH_INPUTS, GRAPH_OUTPUTS
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import (
    ActionAssociation,
    Body,
    Condition,
    PermanentOperation,
    SfcBody,
    SfcNetwork,
    Step,
    connected_parts,
)
from plcopen_sfc.model.variables import sections_of
from plcopen_sfc.reachability import reached
from plcopen_sfc.semantics.charts.graph.graph_program import GraphProgram
from plcopen_sfc.semantics.charts.graph.interlock_conditions import programmed
from plcopen_sfc.semantics.charts.running_chart import RunningChart
from plcopen_sfc.semantics.programs.addresses import address_of
from plcopen_sfc.semantics.programs.controller import Instance
from plcopen_sfc.semantics.programs.runtime_types import Family, ScalarType, StructureType, Type

Names = frozenset[str]
"""Names of variables and of members, in lower case."""

_HARMLESS = (
    n.Name,
    n.Literal,
    n.Member,
    n.Parenthesized,
    n.Unary,
    n.Argument,
    n.Assignment,
    n.CallStatement,
    n.If,
    n.Branch,
    n.Case,
    n.CaseBranch,
    n.Range,
    n.RegionBlock,
    n.Empty,
)
"""Nodes that cannot end with an error, nor leave the body."""

_HARMLESS_OPERATORS = frozenset(n.Operator) - {
    n.Operator.MULTIPLY,
    n.Operator.DIVIDE,
    n.Operator.MODULO,
    n.Operator.POWER,
}
_HARMLESS_ASSIGNMENTS = frozenset({n.AssignmentKind.ASSIGN, n.AssignmentKind.SET, n.AssignmentKind.RESET})


class NotDivisibleError(Exception):
    """It is not known of which parts a program is made."""


@dataclass(frozen=True)
class ProgramPart:
    """Reads and writes of a part. `always`: it must be kept whatever is looked at."""

    reads: Names
    writes: Names
    always: bool = False

    def __or__(self, other: ProgramPart) -> ProgramPart:
        return ProgramPart(self.reads | other.reads, self.writes | other.writes, self.always or other.always)


NOTHING = ProgramPart(frozenset(), frozenset())


class Parts(Protocol):
    """A program in parts."""

    @property
    def parts(self) -> Sequence[ProgramPart]:
        """All parts."""

    def taken(self, kept: Set[int]) -> Pou:
        """Return the POU with these parts only, by their numbers."""


def cone(parts: Sequence[ProgramPart], names: Iterable[str]) -> frozenset[int]:
    """Return the parts that the values of some variables depend on, by their numbers."""
    writers = grouped((name, number) for number, part in enumerate(parts) for name in part.writes)
    starts: list[int | str] = [number for number, part in enumerate(parts) if part.always]
    starts += names

    def needed(thing: int | str) -> Iterable[int | str]:
        return writers.get(thing, ()) if isinstance(thing, str) else parts[thing].reads

    return frozenset(each for each in reached(starts, needed) if isinstance(each, int))


class NamedEffects:
    """Reads and writes of statements and expressions of a POU. Raises `NotDivisibleError` where that is not known."""

    def __init__(self, instance: Instance) -> None:
        library = instance.controller.library
        fields = [*instance.frame.layout.fields, *library.globals.fields]
        if any(isinstance(each.type, ScalarType) and each.type.narrowed is not None for each in fields):
            raise NotDivisibleError("a subrange can be left")
        _check_places(instance)
        self._layout = instance.frame.layout
        self._blocks = {(f.name.casefold(),) for f in fields if _is_block(f.type, instance)}

    def of(self, node: n.Statement | n.Expression) -> ProgramPart:
        """Return a statement or an expression."""
        written = self.names(writes(node, self._blocks))
        harmless = all(self._is_harmless(each) for each in walk(node))
        return ProgramPart(self.names(reads(node)), written, always=not harmless)

    def names(self, paths: Iterable[Path]) -> Names:
        """Return names of variables in parts."""
        found: set[str] = set()
        for path in paths:
            if path == ANYTHING:
                raise NotDivisibleError("it uses references, or calls what is not known")
            found.update(path[:1] if self._layout.find(path[0]) is not None else path)
        return frozenset(found)

    def of_all(self, nodes: Iterable[n.Statement | n.Expression]) -> ProgramPart:
        """Return several parts as one."""
        found = NOTHING
        for node in nodes:
            found |= self.of(node)
        return found

    def _is_harmless(self, node: n.Node) -> bool:
        if isinstance(
            node, n.Dereference | n.Peripheral | n.Address | n.Goto | n.LabelStatement | n.Try | n.Unreadable
        ):
            raise NotDivisibleError("it uses references, addresses or jumps")
        if isinstance(node, n.EmbeddedCode):
            raise NotDivisibleError("it has code in C")
        if isinstance(node, n.Call):
            if is_standard_call(node) and path_of(node.callee) == ("adr",):
                raise NotDivisibleError("it uses references")
            return path_of(node.callee) in self._blocks
        if isinstance(node, n.Operation | n.Unary):
            return node.operator in _HARMLESS_OPERATORS
        if isinstance(node, n.Assignment):
            if node.kind is n.AssignmentKind.REFERENCE:
                raise NotDivisibleError("it uses references")
            return node.kind in _HARMLESS_ASSIGNMENTS
        return isinstance(node, _HARMLESS)


def _is_block(type_: Type, instance: Instance) -> bool:
    if not isinstance(type_, StructureType):
        return False
    block = instance.controller.library.block_of(type_.layout)
    return block is not None and block.run is not None


def _check_places(instance: Instance) -> None:
    """Variables with addresses may lie over each other."""
    project = instance.controller.project
    interface = instance.unit.pou.interface
    sections = [*project.global_variables, *sections_of(interface)]
    places = [v.address for section in sections for v in section.variables if v.address and "*" not in v.address]
    try:
        different = {address_of(each, by_bytes=False) for each in places}
    except SimulationError as error:
        raise NotDivisibleError(error.message) from error
    if len(places) != len(different):
        raise NotDivisibleError("two variables have the same address")


class ProgramParts:
    """Statements as `Parts`: single ones, also inside of IF and CASE."""

    def __init__(self, instance: Instance) -> None:
        self._pou = instance.unit.pou
        if self._pou.actions or self._pou.transitions:
            raise NotDivisibleError(f"{self._pou.name} is more than one body")
        self._effects = NamedEffects(instance)
        self._statements = statements_of(self._pou.bodies[0], instance)
        self.parts: list[ProgramPart] = list(self._parts(self._statements, NOTHING))

    def taken(self, kept: Set[int]) -> Pou:
        """Return the body with these parts only."""
        statements = self._kept(self._statements, iter(number in kept for number in range(len(self.parts))))
        text = print_node(n.Statements(statements))
        return self._pou.model_copy(update={"bodies": [StBody(text=text)]})

    def _parts(self, statements: Sequence[n.Statement], around: ProgramPart) -> Iterator[ProgramPart]:
        for statement in statements:
            heads = _heads(statement)
            head = self._effects.of_all(heads)
            if not heads or head.always or head.writes:
                yield self._effects.of(statement) | around
                continue
            inside = ProgramPart(head.reads | around.reads, frozenset())
            for inner in _inner(statement):
                yield from self._parts(inner, inside)

    def _kept(self, statements: Sequence[n.Statement], wanted: Iterator[bool]) -> tuple[n.Statement, ...]:
        """Return the statements with the parts that are wanted, which come in the order of `_parts`."""
        found: list[n.Statement] = []
        for statement in statements:
            heads = _heads(statement)
            head = self._effects.of_all(heads)
            if not heads or head.always or head.writes:
                if next(wanted):
                    found.append(statement)
                continue
            inner = [self._kept(each, wanted) for each in _inner(statement)]
            if any(inner):
                found.append(_with_inner(statement, inner))
        return tuple(found)


def statements_of(body: Body, instance: Instance) -> Sequence[n.Statement]:
    """Return the statements of a body, whatever its language. Raises `NotDivisibleError`."""
    bound = bind(body, instance.controller.project.dialect)
    declared = all(instance.frame.layout.find(name) is not None for name in bound.instances)
    if bound.program is None or not declared:
        raise NotDivisibleError(f"a body in {body.language} cannot be divided, or needs variables of its own")
    return bound.program


def _heads(statement: n.Statement) -> Sequence[n.Expression]:
    """Return the expressions that decide which statements inside are executed; none: it is executed as a whole."""
    match statement:
        case n.If(branches=branches):
            return [branch.condition for branch in branches]
        case n.Case(selector=selector):
            return [selector]
    return []


def _inner(statement: n.Statement) -> list[Sequence[n.Statement]]:
    """Return the lists of statements inside."""
    assert isinstance(statement, n.If | n.Case)  # noqa: S101
    return [*(branch.statements for branch in statement.branches), statement.otherwise or ()]


def _with_inner(statement: n.Statement, inner: Sequence[tuple[n.Statement, ...]]) -> n.Statement:
    """Return the statement with other ones inside, as many lists as `_inner` gives."""
    filled = [statements or (n.Empty(),) for statements in inner]
    otherwise = inner[-1] or None
    if isinstance(statement, n.Case):
        cases = [replace(old, statements=new) for old, new in zip(statement.branches, filled, strict=False)]
        return replace(statement, branches=tuple(cases), otherwise=otherwise)
    assert isinstance(statement, n.If)  # noqa: S101
    ways = [replace(old, statements=new) for old, new in zip(statement.branches, filled, strict=False)]
    return replace(statement, branches=tuple(ways), otherwise=otherwise)


_STEP_ACTIONS = ("entry_action", "main_action", "exit_action")
_PERMANENT = ("permanent_pre", "permanent_post")
_NO_STEP = -1
_Place = tuple[int, str]
"""A step by its id, and which of its actions: the index of an association, or a step action.

`_NO_STEP` has the permanent operations, by their list and index.
"""

_WHOLE = SWITCHES | TIMERS


class ChartParts:
    """A chart as `Parts`: steps that transitions connect, then each action of a step."""

    def __init__(self, instance: Instance) -> None:
        self._instance = instance
        self._pou = instance.unit.pou
        charts = instance.charts()
        chart = self._pou.chart
        running = charts[0][1] if len(charts) == 1 else None
        if chart is None or not isinstance(running, RunningChart) or not running.is_divisible:
            raise NotDivisibleError("the chart acts as a whole")
        self._chart: SfcNetwork = chart
        self._effects = NamedEffects(instance)
        self._actions = {action.name.casefold(): action.body for action in self._pou.actions}
        self.parts: list[ProgramPart] = []
        self._is_graph = isinstance(running, GraphProgram)
        self._nets = self._find_nets()
        for steps in self._nets:
            self.parts.append(self._net(steps))
        self._places: list[_Place] = []
        for place, part in chain(self._permanent(), *map(self._step, chart.steps)):
            self._places.append(place)
            self.parts.append(part)

    def taken(self, kept: Set[int]) -> Pou:
        """Return the chart with these parts only. It keeps at least one net: without any it would be none."""
        nets = {number for number in kept if number < len(self._nets)} or {0}
        ids = {step for number in nets for step in self._nets[number]}
        places = {self._places[number - len(self._nets)] for number in kept if number >= len(self._nets)}
        steps = [_taken_step(step, places) for step in self._chart.steps if step.id in ids]
        transitions = [t for t in self._chart.transitions if ids & {*t.sources, *t.targets}]
        update: dict[str, object] = {kind: _taken_permanent(self._chart, kind, places) for kind in _PERMANENT}
        update |= {"steps": steps, "transitions": transitions, "drawing": None}
        chart = self._chart.model_copy(update=update)
        # what no step names any more must not count as a text that reads the times of steps
        dialect = self._instance.controller.project.dialect
        named = with_called(names_in(chart, dialect), self._pou.actions, dialect)
        actions = [action for action in self._pou.actions if action.name.casefold() in named]
        return self._pou.model_copy(update={"bodies": [SfcBody(chart=chart)], "actions": actions})

    # -- nets

    def _find_nets(self) -> list[frozenset[int]]:
        """Return the ids of steps that transitions connect, in the order of the chart; a block of S7-GRAPH is one."""
        if self._is_graph:
            return [frozenset(step.id for step in self._chart.steps)]
        parts = connected_parts(self._chart.steps, self._chart.transitions)
        return [frozenset(step.id for step in part) for part in parts]

    def _net(self, steps: Set[int]) -> ProgramPart:
        found = self._operation() if self._is_graph else NOTHING
        dialect = self._instance.controller.project.dialect
        read = condition_reader(self._chart, dialect, transitions=self._pou.transitions)
        for transition in self._chart.transitions:
            if steps & {*transition.sources, *transition.targets}:
                found |= self._tested(read, transition.condition)
        for step in self._chart.steps:
            if step.id in steps:
                times = self._times(step.min_time, step.max_time, step.warning_time)
                found |= ProgramPart(times, self._name(step))
                for condition in step.conditions.values() if self._is_graph else ():
                    found |= self._tested(read, condition)
        return found

    def _tested(self, read: Callable[[Condition], NetworkExpression], condition: Condition | None) -> ProgramPart:
        """Return a condition; in S7-GRAPH one that is not programmed is satisfied."""
        if self._is_graph and programmed(condition) is None:
            return NOTHING
        if condition is None:
            raise NotDivisibleError("a transition has no condition")
        found = read(condition)
        if found.tree is None or found.obstacles or found.helpers:
            raise NotDivisibleError("a condition cannot be read")
        return self._effects.of(found.tree) | self._effects.of_all(found.before)

    def _operation(self) -> ProgramPart:
        """Return the parameters of a block of S7-GRAPH, and its transitions: all tell of the whole sequencer."""
        names = [transition.name for transition in self._chart.transitions if transition.name]
        written = {name.casefold() for name in (*GRAPH_OUTPUTS, *names)}
        return ProgramPart(frozenset(name.casefold() for name in GRAPH_INPUTS), frozenset(written))

    def _name(self, step: Step) -> frozenset[str]:
        return frozenset({step.name.casefold()})

    def _times(self, *texts: str | None) -> frozenset[str]:
        names = frozenset[str]()
        for text in texts:
            if text:
                time = self._effects.of(self._expression(text))
                if time.always or time.writes:
                    raise NotDivisibleError(f"{text} is calculated")
                names |= time.reads
        return names

    # -- actions

    def _permanent(self) -> Iterator[tuple[_Place, ProgramPart]]:
        for kind in _PERMANENT:
            for index, operation in enumerate(getattr(self._chart, kind)):
                if operation.body is not None:
                    yield (_NO_STEP, f"{kind} {index}"), self._body(operation.body)

    def _step(self, step: Step) -> Iterator[tuple[_Place, ProgramPart]]:
        around = ProgramPart(self._name(step), frozenset())
        for index, association in enumerate(step.actions):
            if not association.exclude:
                yield (step.id, f"{index}"), around | self._association(association)
        for kind in _STEP_ACTIONS:
            action = getattr(step, kind)
            if action:
                yield (step.id, kind), around | self._body(action)

    def _association(self, association: ActionAssociation) -> ProgramPart:
        """Return an association. All with one action read what the others do: they share a control."""
        only_graph = association.event is not None or association.interlock
        if (only_graph and not self._is_graph) or association.kind is not None:
            raise NotDivisibleError("an action is one of S7-GRAPH or GRAFCET")
        if association.qualifier in _WHOLE:
            raise NotDivisibleError("an action switches steps, or a timer that others read")
        if association.qualifier.needs_duration and not association.duration:
            raise NotDivisibleError("an action has no time")
        found = ProgramPart(self._times(association.duration) | self._condition(association.condition), frozenset())
        if association.body is not None:
            found |= self._body(association.body)
        if association.target is not None:
            found |= self._target(association.qualifier, association.target, association.value)
        return found

    def _condition(self, condition: Condition | None) -> frozenset[str]:
        if condition is None:
            return frozenset()
        if condition.kind != "expression":
            raise NotDivisibleError("the condition of an action is no text")
        return self._times(condition.text)

    def _target(self, qualifier: Qualifier, target: str, value: str | None) -> ProgramPart:
        tree = self._expression(target)
        if qualifier is Qualifier.CALL and value is None:
            return self._effects.of(n.CallStatement(n.Call(tree, ())))
        if qualifier in COUNTERS:
            return self._effects.of(n.Assignment(tree, tree)) | self._effects.of(self._expression(value or "0"))
        if value is not None:
            return self._effects.of(n.Assignment(tree, self._expression(value)))
        if target.casefold() in self._actions:
            return self._body(target)
        path = path_of(tree)
        try:
            type_ = self._instance.type_of(target)
        except SfcError as error:
            raise NotDivisibleError(f"{target} is no variable") from error
        if not isinstance(type_, ScalarType) or type_.family is not Family.BOOL:
            raise NotDivisibleError(f"{target} is no Boolean variable")
        written = self._effects.names([path])
        return ProgramPart(self._effects.of(tree).reads, written)

    def _body(self, body: str | Body) -> ProgramPart:
        """Return an action: of the POU by its name, or in place."""
        if isinstance(body, str):
            named = self._actions.get(body.casefold())
            if named is None:
                raise NotDivisibleError(f"{body} is no action of the POU")
            body = named
        return self._effects.of_all(statements_of(body, self._instance))

    def _expression(self, text: str) -> n.Expression:
        parsed = parse_expression(text, self._instance.controller.project.dialect)
        if parsed.problems:
            raise NotDivisibleError(f"{text} does not parse")
        return parsed.tree


def _taken_permanent(chart: SfcNetwork, kind: str, places: Set[_Place]) -> list[PermanentOperation]:
    operations: Sequence[PermanentOperation] = getattr(chart, kind)
    return [each for index, each in enumerate(operations) if (_NO_STEP, f"{kind} {index}") in places]


def _taken_step(step: Step, places: Set[_Place]) -> Step:
    kept = {place for owner, place in places if owner == step.id}
    update: dict[str, object] = {"actions": [a for index, a in enumerate(step.actions) if f"{index}" in kept]}
    update |= {kind: None for kind in _STEP_ACTIONS if kind not in kept}
    return step.model_copy(update=update)


def parts_of(instance: Instance) -> Parts:
    """Return the parts of the POU that an instance is of. Raises `NotDivisibleError`."""
    pou = instance.unit.pou
    if len(pou.bodies) != 1 or pou.methods or instance.unit.base is not None:
        raise NotDivisibleError(f"{pou.name} is more than one body")
    if instance.controller.problems:
        raise NotDivisibleError(f"{pou.name} cannot be executed everywhere")
    return ChartParts(instance) if isinstance(pou.bodies[0], SfcBody) else ProgramParts(instance)
