"""Goals of a directed search: conditions of transitions and branches that were not taken yet.

Of each condition is told how far its variables are from making it TRUE, and z3 solves it for the inputs in it, given
the present values of everything else.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date, timedelta
from functools import cached_property
from itertools import chain, islice, takewhile
from types import MappingProxyType
from typing import Any, cast

from plcopen_sfc.analysis.assigned_values import assigning_texts, with_values
from plcopen_sfc.analysis.coverage import counted_charts
from plcopen_sfc.analysis.deciding_parts import ConditionPart, ConditionParts
from plcopen_sfc.analysis.distances import NO_DISTANCE, Distance, Distances, Measurement, is_elapsed
from plcopen_sfc.analysis.exclusivity import association_condition, condition_of
from plcopen_sfc.analysis.formulas import Formula, JudgedCondition, negation, new_context
from plcopen_sfc.analysis.knowledge import ProjectKnowledge
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.analysis.unreachable import Unreachable
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.binding import bind
from plcopen_sfc.languages.binding.name_scopes import given, parameters_of
from plcopen_sfc.languages.networks import normal_form
from plcopen_sfc.languages.networks.wires import joined
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node, walk
from plcopen_sfc.languages.st.literals import LiteralKind, LiteralValue, known_literal
from plcopen_sfc.languages.st.nodes import Expression, Operator
from plcopen_sfc.languages.st.walking import with_children
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.semantics.charts.running_chart import RunningChart
from plcopen_sfc.semantics.net import NetTransition
from plcopen_sfc.semantics.programs.marks import bounds, divisors
from plcopen_sfc.semantics.programs.runtime_types import Family, ScalarType
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value

_FAR = 1e15
_STORED = frozenset({Qualifier.S, Qualifier.SD, Qualifier.DS, Qualifier.SL})
_MOST_BRANCHES = 600
_MOST_CALLS = 8


@dataclass(eq=False)
class Goal:
    """A condition that is wanted TRUE.

    `sources` are the bits of the steps that must be active for that, of the chart of number `chart` (-1: of none).
    `part`: a part of a condition that decides it then; `action`: the bit of an action that it executes; `tries`: how
    often inputs that were to do it have not done it. `places`: numbers of charts, and bits of steps in one of which it
    is looked at, as far as that is known. `leads`: these are charts of the leading side. `waits`: it asks for an
    elapsed time. `last`: numbers with which it was tried last.
    """

    name: str
    tree: Expression | None
    chart: int = -1
    bit: int = 0
    sources: int = 0
    branch: int = -1
    part: ConditionPart | None = None
    action: int = 0
    tries: int = 0
    places: Sequence[tuple[int, int]] = ()
    waits: bool = False
    leads: bool = True
    own: frozenset[str] = frozenset()
    last: Mapping[str, int] = field(default_factory=dict)
    measured: Callable[[Goal], Distance] | None = field(default=None, repr=False)
    _formula: _Solving | None = field(default=None, repr=False)

    @cached_property
    def distance(self) -> Distance:
        """How far the values of variables that are no inputs are from it; none where inputs alone decide.

        A chart may have thousands of goals, of which a search looks at few: it is made when one asks.
        """
        return self.measured(self) if self.measured is not None else NO_DISTANCE


@dataclass
class _Solving:
    """A condition as z3 knows it: the formula, its term, and what it depends on besides inputs."""

    formula: Formula
    term: Any
    inner: list[str]
    found: dict[Any, dict[str, Value] | None] = field(default_factory=dict)


class Goals:
    """The conditions of one system, and what is known of them. `signals`: the inputs that both systems share.

    `look` tells when there is no time to look at more of them.
    """

    def __init__(
        self, system: ProgramSystem, signals: Mapping[str, Signal], parts: ConditionParts, look: Callable[[int], str]
    ) -> None:
        self.system = system
        self._signals = signals
        self._by_key = {name.casefold(): name for name in signals}
        self._shared = {own.casefold(): name for own, name in system.shared_names().items()}
        self._shared = _without_lists(system, self._shared) | self._shared
        self._project = system.subject.project
        self._knowledge = ProjectKnowledge(self._project)
        self._library = system.instance.controller.library
        found = [each for each in system.instance.called_charts() if isinstance(each[1], RunningChart)]
        self.charts = [(chart, frame) for _, chart, frame in found if isinstance(chart, RunningChart)]
        called = {id(chart): name for name, chart in counted_charts(system)}
        self._own = [chart for _, chart in system.instance.unit.charts]
        self._terms: dict[frozenset[Goal], tuple[Formula, Mapping[Goal, Any]]] = {}
        """The terms of goals, in one formula."""
        self._origins: dict[Goal, Goal | None] = {}
        """The results of `_origin`."""
        self._solvable: dict[Goal, bool] = {}
        """The results of `_may_be_solved`."""
        self._distances = Distances(system, lambda text: self._input(text) is not None)
        self.transitions: list[list[Goal]] = [[] for _ in self.charts]
        self.branches: list[Goal] = []
        self.outcomes: list[Goal] = []
        for number, (chart, _) in enumerate(self.charts):
            pou = system.subject.pou
            seen_as: Callable[[Expression], Expression] = _same
            if chart not in self._own:
                if id(chart) not in called:
                    continue
                name, _, action = called[id(chart)].partition(".")
                pou = self._project.pou(name)
                steps = [step.step.name for step in chart.net.steps]
                seen_as = self._outside(found[number][0].removesuffix(f".{action}"), pou, steps)
            self.transitions[number] = [
                self._of_transition(number, each, pou, seen_as) for each in chart.net.transitions
            ]
        self.actions = [goal for number, _ in enumerate(self.charts) for goal in self._of_actions(number)]
        self._find_branches(look)
        self.parts = [self._of_part(part) for part in parts if not look(0)]
        self.bounds = list(islice(takewhile(lambda _: not look(0), self._of_bounds()), _MOST_BRANCHES))

    # -- which

    def _of_transition(
        self, number: int, transition: NetTransition, pou: Pou, seen_as: Callable[[Expression], Expression]
    ) -> Goal:
        place = [(number, transition.pre)]
        goal = Goal(transition.path, None, number, transition.bit, transition.pre, places=place)
        if transition.transition.condition is None:
            return goal
        read = condition_of(transition.chart, transition.transition, self._project.dialect, transitions=pou.transitions)
        if read.tree is not None and read.complete:
            goal.tree = normal_form(seen_as(read.tree))
            goal.own = frozenset(
                node.identifier.casefold()
                for statement in read.before
                for node in walk(statement)
                if isinstance(node, n.Name)
            )
            goal.measured = self._distance
        return goal

    def _outside(self, path: str, pou: Pou, steps: Iterable[str] = ()) -> Callable[[Expression], Expression]:
        """Return how texts of the POU of an instance, which has `steps`, are texts of the compared POU.

        Its inputs are what statements of its caller pass or assign, of several calls any; its other variables and steps
        members of the instance. The caller may be an instance itself.
        """
        above, _, name = path.rpartition(".")
        caller = self._pou_of(above) if above else None
        inner = self._passed(name if caller is not None else path, pou, steps, caller or self.system.subject.pou)
        if caller is None:
            return inner
        outer = self._outside(above, caller)
        return lambda tree: outer(inner(tree))

    def _pou_of(self, path: str) -> Pou | None:
        """Return the POU of an instance or a program that the compared POU names; None where that is not known."""
        found: Pou | None = self.system.subject.pou
        for number, name in enumerate(path.casefold().split(".")):
            variables = found.variables() if found is not None else ()
            kinds = [v.type.name for v in variables if v.name.casefold() == name and isinstance(v.type, DerivedType)]
            wanted = kinds[0].casefold() if kinds else name if not number else ""
            found = next((each for each in self._project.pous if each.name.casefold() == wanted), None)
        return found

    def _passed(self, path: str, pou: Pou, steps: Iterable[str], caller: Pou) -> Callable[[Expression], Expression]:
        own = _own_variables(pou) | {step.casefold() for step in steps}
        members = {name: parse_expression(f"{path}.{name}", self._project.dialect).tree for name in own}
        parameters = [variable.name.casefold() for variable in parameters_of(pou.interface)]
        calls: dict[str, Mapping[str, Expression]] = {}
        assigned: dict[str, Expression] = {}
        for _, _, body in caller.named_bodies():
            for node in chain.from_iterable(map(walk, bind(body, self._project.dialect).statements)):
                match node:
                    case n.Call(callee) if print_node(callee).casefold() == path.casefold():
                        passed = {name: n.Parenthesized(value) for name, value in given(node, parameters).items()}
                        calls.setdefault(str({name: print_node(value) for name, value in passed.items()}), passed)
                    case n.Assignment(n.Member(base, name), value) if print_node(base).casefold() == path.casefold():
                        assigned[name.identifier.casefold()] = n.Parenthesized(value)

        def changed(node: n.Node, way: Mapping[str, Expression]) -> n.Node:
            match node:
                case n.Name(identifier):
                    key = identifier.casefold()
                    return way.get(key) or members.get(key) or node
                case n.Member(base, _):
                    return replace(node, base=cast("Expression", changed(base, way)))
                case n.Call():
                    return node
            return with_children(node, lambda inner: changed(inner, way))

        ways = [{**assigned, **passed} for passed in [*calls.values()][:_MOST_CALLS]] or [assigned]

        def seen_from_outside(tree: Expression) -> Expression:
            found = {print_node(each): each for each in (cast("Expression", changed(tree, way)) for way in ways)}
            return joined(Operator.OR, [*found.values()])

        return seen_from_outside

    def _find_branches(self, look: Callable[[int], str]) -> None:
        marks = self.system.marks
        own = self.system.subject.pou.name
        for number, branch in enumerate(marks.branches):
            goals = self.branches if branch.is_statement else self.outcomes
            if len(goals) >= _MOST_BRANCHES or look(0):
                continue
            inside = branch.owner == own or branch.owner.startswith((f"{own}.", f"{own} "))
            if not branch.guards or not inside:
                continue
            tree = normal_form(joined(Operator.AND, branch.guards))
            goal = Goal(branch.condition, tree, branch=number)
            goal.measured = self._distance
            goal.waits = any(map(is_elapsed, walk(tree)))
            goal.places = self._steps_asked(tree) or self._executing.get(branch.owner.casefold(), ())
            goals.append(goal)

    @cached_property
    def _executing(self) -> Mapping[str, list[tuple[int, int]]]:
        """The steps that execute a text only while they are active, by the name of its owner."""
        own, found = self.system.subject.pou.name, dict[str, list[tuple[int, int]]]()
        for number, (chart, _) in enumerate(self.charts):
            for step in chart.net.steps if chart in self._own else ():
                at, model = (number, step.bit), step.step
                names = [each for each in model.step_actions.values() if each]
                names += [each.target for each in model.actions if each.target and each.qualifier not in _STORED]
                owners = [f"{own}.{name}" for name in names if isinstance(name, str)]
                for owner in (*owners, f"{own} / step {step.path}"):
                    found.setdefault(owner.casefold(), []).append(at)
        return found

    def _steps_asked(self, tree: Expression) -> list[tuple[int, int]]:
        """Return the steps whose flags a conjunction asks for."""
        match tree:
            case n.Parenthesized(inner):
                return self._steps_asked(inner)
            case n.Operation(Operator.AND | Operator.AND_THEN, operands):
                return [at for each in operands for at in self._steps_asked(each)]
            case n.Member(n.Name() as step, member) if member.identifier.upper() == "X":
                key = step.identifier.casefold()
                return [
                    (number, each.bit)
                    for number, (chart, _) in enumerate(self.charts)
                    for each in chart.net.steps
                    if each.step.name.casefold() == key
                ]
        return []

    def _of_actions(self, number: int) -> Iterator[Goal]:
        """Yield the conditions of the associations of actions."""
        chart = self.charts[number][0]
        if chart not in self._own:
            return
        for action, origins in enumerate(chart.reached.origins):
            for steps, association in origins:
                tree = association_condition(association, self._project.dialect) if association is not None else None
                if tree is not None:
                    tree = normal_form(tree)
                    goal = Goal(chart.reached.labels[action], tree, number, sources=steps, action=1 << action)
                    goal.measured = self._distance
                    yield goal

    def _of_part(self, part: ConditionPart) -> Goal:
        number = next(number for number, (chart, _) in enumerate(self.charts) if chart is part.chart)
        transition = part.transition
        goal = Goal(part.text, part.deciding, number, transition.bit, transition.pre, part=part)
        goal.places = [(number, transition.pre)]
        goal.measured = self._distance
        return goal

    def _of_bounds(self) -> Iterator[Goal]:
        """Yield the goals that make a divisor 0, or both sides of a comparison equal where it matters, or one off."""
        yield from self._of_zeros()
        seen: set[tuple[int, int, str]] = set()
        for goal in chain(chain.from_iterable(self.transitions), self.branches, self.outcomes):
            if goal.tree is None or not self._reads_inputs(goal.tree):
                continue  # of many comparisons in long conditions, most are of steps and numbers of the program
            for comparison, around in bounds(goal.tree):
                left, right = map(n.Parenthesized, comparison.operands)
                more = [
                    n.Operation(operator, (right, n.Literal("1"))) for operator in (Operator.ADD, Operator.SUBTRACT)
                ]
                for other in (right, *map(n.Parenthesized, more)):
                    tree = normal_form(joined(Operator.AND, [n.Operation(Operator.EQUAL, (left, other)), around]))
                    key = (goal.chart, goal.sources, print_node(tree))
                    if key not in seen and self._reads_inputs(tree):
                        seen.add(key)
                        yield Goal(goal.name, tree, goal.chart, goal.bit, goal.sources, measured=self._distance)

    def _of_zeros(self) -> Iterator[Goal]:
        marks, own = self.system.marks, self.system.subject.pou.name
        for number, guards in marks.zeros:
            owner = marks.branches[number].owner
            if owner == own or owner.startswith((f"{own}.", f"{own} ")):
                tree = with_values(normal_form(joined(Operator.AND, guards)), self._assigned)
                if self._reads_inputs(tree):
                    yield Goal(print_node(guards[-1]), tree, branch=number)
        for goal in chain.from_iterable(self.transitions):
            for divisor in divisors(goal.tree) if goal.tree is not None else ():
                is_zero = n.Operation(Operator.EQUAL, (n.Parenthesized(divisor), n.Literal("0")))
                tree = with_values(normal_form(is_zero), self._assigned)
                if self._reads_inputs(tree):
                    yield Goal(goal.name, tree, goal.chart, goal.bit, goal.sources)

    def _reads_inputs(self, tree: Expression) -> bool:
        paths = (node for node in walk(tree) if isinstance(node, n.Operand))
        return any(self._input(print_node(node)) is not None for node in paths)

    def constants(self, signal: Signal) -> Iterator[Value]:
        """Yield the constants in the conditions that an input of a type could have."""
        for found in self._literals:
            if found.kind in signal.literals:
                try:
                    yield signal.accept(found.value)
                except SfcError:
                    continue  # the type has no such value

    @cached_property
    def _literals(self) -> list[LiteralValue]:
        """The values of the literals in all conditions, each once."""
        found: dict[tuple[LiteralKind, type, object], LiteralValue] = {}
        transitions = chain.from_iterable(self.transitions)
        for goal in chain(transitions, self.branches, self.outcomes, self.parts):
            for node in walk(goal.tree) if goal.tree is not None else ():
                value = known_literal(node, self._project.dialect) if isinstance(node, n.Literal) else None
                if value is not None:
                    found.setdefault((value.kind, type(value.value), value.value), value)
        return list(found.values())

    def open_parts(self) -> Iterator[Goal]:
        """Yield the parts of conditions of transitions whose sources were entered, and which have not decided them."""
        for goal in self.parts:
            if (
                goal.part is not None
                and goal.part.is_open
                and goal.sources & ~self.charts[goal.chart][0].reached.steps == 0
            ):
                yield goal

    def open_actions(self) -> Iterator[Goal]:
        """Yield the conditions of actions that were never executed though a step was entered which has them."""
        for goal in self.actions:
            reached = self.charts[goal.chart][0].reached
            if not goal.action & reached.actions and goal.sources & reached.steps:
                yield goal

    def open_outcomes(self) -> Iterator[Goal]:
        """Return the outcomes of comparisons that are assigned, and which have not come out so."""
        reached = self.system.marks.reached
        return (goal for goal in self.outcomes if not reached[goal.branch])

    def open_transitions(self) -> Iterator[Goal]:
        """Yield the transitions whose sources were entered, and which never fired."""
        for goals, (chart, _) in zip(self.transitions, self.charts, strict=True):
            reached = chart.reached
            for goal in goals:
                if not goal.bit & reached.transitions and goal.sources & ~reached.steps == 0:
                    yield goal

    def open_branches(self) -> Iterator[Goal]:
        """Return the branches that were not executed yet."""
        reached = self.system.marks.reached
        return (goal for goal in self.branches if not reached[goal.branch])

    def impossible(self, unreachable: Unreachable) -> set[Goal]:
        """Return the open transitions and branches that nothing can reach."""
        names = {id(chart): name for name, chart in self.system.instance.unit.charts}
        found: set[Goal] = set()
        for goals, (chart, _) in zip(self.transitions, self.charts, strict=True):
            dead = unreachable.transitions.get(names.get(id(chart), ""), ())
            found |= {goal for number, goal in enumerate(goals) if number in dead}
        for goal in self.open_branches():
            branch = self.system.marks.branches[goal.branch]
            own = self.system.subject.pou.chart
            is_never = unreachable.is_never_executed(branch.owner)
            if is_never or unreachable.is_impossible(branch.guards, own, owner=branch.owner):
                found.add(goal)
        return found

    def enabled(self, markings: Sequence[int]) -> list[Goal]:
        """Return the transitions that are enabled in a situation, in the order in which they are tried."""
        return [
            goal
            for goals, marking in zip(self.transitions, markings, strict=True)
            for goal in goals
            if not goal.sources & ~marking
        ]

    def open_bounds(self, tries: int) -> Iterator[Goal]:
        """Yield the bounds of comparisons that can be tried now, each only so often."""
        return (goal for goal in self.tested(self.bounds) if goal.tries < tries)

    def tested(self, goals: Iterable[Goal]) -> Iterator[Goal]:
        """Yield those whose steps are all active now."""
        markings = self.markings()
        return (goal for goal in goals if goal.chart < 0 or not goal.sources & ~markings[goal.chart])

    def solve_part(self, goal: Goal) -> dict[str, Value] | None:
        """Values of inputs that make something of active steps TRUE, if possible while no competing transition fires.

        None where there are none, or no inputs decide it.
        """
        if not self._may_be_solved(goal):
            return None
        markings = self.markings()
        enabled = [each for each in self.enabled(markings) if each.chart == goal.chart and each.tree is not None]
        competing = [each for each in enabled if each.bit != goal.bit and each.sources & goal.sources]
        found = self.solve([goal], competing)
        return found if found is not None or not competing else self.solve([goal], [])

    def solve_bound(self, goal: Goal) -> dict[str, Value] | None:
        """Values of inputs at a bound: with other numbers than the last ones, if that is possible."""
        goal.tries += 1
        found = self.solve([goal], [], avoided=goal.last) if goal.last else None
        found = found or self.solve([goal], [])
        numbers = (found or {}).items()
        goal.last = {name: value for name, value in numbers if isinstance(value, int) and not isinstance(value, bool)}
        return found

    def solve_after(self, goal: Goal) -> dict[str, Value] | None:
        """Values of inputs with which a goal is reached if a scan with other ones comes before, as an edge asks for.

        The steps of the goal are active.
        """
        origin = self._origin(goal)
        return self.solve([origin], [], remembering=False) if origin is not None else None

    def markings(self) -> tuple[int, ...]:
        """Return the situations of all charts in which the next scan begins."""
        return tuple([chart.situation(frame) for chart, frame in self.charts])

    # -- how far

    def _distance(self, goal: Goal) -> Distance:
        """Return how far a goal is, by its condition or by what its variables get in the scan."""
        origin = self._origin(goal)
        trees = [each.tree for each in (goal, origin) if each is not None and each.tree is not None]
        return self._distances.of(*trees)

    def _origin(self, goal: Goal) -> Goal | None:
        """Return the same goal with the expressions that its variables get in each scan in their places; None: none."""
        if goal not in self._origins:
            tree = with_values(goal.tree, self._assigned) if goal.tree is not None else None
            found = replace(goal, tree=tree, _formula=None) if tree is not goal.tree else None
            self._origins[goal] = found
            if found is not None:
                self._origins[found] = None
        return self._origins[goal]

    def _may_be_solved(self, goal: Goal) -> bool:
        """True if inputs are in the condition of a part, or in what its variables get in each scan."""
        if goal.part is None:
            return True
        if goal not in self._solvable:
            tree = (self._origin(goal) or goal).tree
            self._solvable[goal] = tree is not None and self._reads_inputs(tree)
        return self._solvable[goal]

    def _input(self, text: str) -> str | None:
        """Return the input of this name, as both systems call it."""
        key = text.casefold()
        name = self._shared.get(key, text)
        return self._by_key.get(name.casefold())

    # -- which inputs

    def solve(
        self,
        wanted: Sequence[Goal],
        unwanted: Sequence[Goal],
        *,
        hoping: bool = False,
        remembering: bool = True,
        avoided: Mapping[str, int] = MappingProxyType({}),
    ) -> dict[str, Value] | None:
        """Return values of inputs with which some conditions are TRUE and others FALSE now; None where there are none.

        All but inputs have their present values, or, `hoping`, any. Not `remembering`, what permanent statements keep
        from scan to scan has any value. `avoided` are numbers that inputs are not to have. Only as good as what z3
        knows of the conditions.
        """
        if not hoping and remembering:
            if any(map(_is_far, wanted)):
                return None
            unwanted = [goal for goal in unwanted if not _is_far(goal)]
            if not wanted and not unwanted:
                return {}  # all are FALSE whatever the inputs are
        goals = [*wanted, *unwanted]
        if any(goal.tree is None for goal in goals):
            return None
        parts = [self._solving(goal) for goal in goals]
        known: dict[str, Any] = {}
        kept = self._assigned
        for goal, part in zip(goals, parts, strict=True):
            for text in part.inner if not hoping else ():
                if text.casefold().partition(".")[0] not in goal.own and (remembering or text.casefold() not in kept):
                    known[text] = self._present(text)
        of = tuple(map(id, wanted)), tuple(map(id, unwanted))
        key = (hoping, of, tuple(sorted(known.items(), key=lambda each: each[0])), tuple(avoided.items()))
        cache = parts[0].found
        if key not in cache:
            cache[key] = self._solved(wanted, unwanted, known, avoided)
            if cache[key] is None and any(self._origin(each) is not None for each in goals):
                first, other = ([self._origin(each) or each for each in some] for some in (wanted, unwanted))
                cache[key] = self.solve(first, other, hoping=hoping, remembering=remembering, avoided=avoided)
        return cache[key]

    def _solving(self, goal: Goal) -> _Solving:
        if goal._formula is None:
            formula = self._formula()
            assert goal.tree is not None  # noqa: S101  # the caller looked
            term = formula.terms([JudgedCondition(goal.tree)])[0]
            inner = [text for text in formula.names() if self._input(text) is None]
            goal._formula = _Solving(formula, term, inner)
        return goal._formula

    @cached_property
    def _assigned(self) -> Mapping[str, Expression]:
        """The expressions of variables that one statement assigns, by their names (lower case).

        That is all that one depends on where the statement is executed in each scan: an edge of an input, a mode. A
        variable that gets its value further down has that of the scan before there; one of another text is taken as
        computed before, as edges and modes are.
        """
        found = [text.inlined for text in assigning_texts(self.system.subject.pou, self._project.dialect)]
        all_texts = {key: value for inside in found for key, value in inside.items()}
        whole: dict[str, Expression] = {}
        for inside in found:  # what is left of its own names has the value of the scan before
            others = {key: value for key, value in all_texts.items() if key not in inside}
            whole |= {key: with_values(value, others) for key, value in inside.items()}
        return whole

    def _formula(self) -> Formula:
        chart = self.system.subject.pou.chart
        knowledge = self._knowledge.at(self.system.subject.pou, chart)
        return Formula(self._project.dialect, knowledge, guessing=True, context=self._context)

    @cached_property
    def _context(self) -> Any:
        return new_context()  # the search is the same whatever was searched before

    def _present(self, text: str) -> Any:
        try:
            with self.system.instance.adding_nothing():
                return self.system.instance[text]
        except (SfcError, AttributeError):
            return None

    def _solved(
        self, wanted: Sequence[Goal], unwanted: Sequence[Goal], known: Mapping[str, Any], avoided: Mapping[str, int]
    ) -> dict[str, Value] | None:
        goals = [*wanted, *unwanted]
        key = frozenset(goals)
        if key not in self._terms and len(goals) == 1:
            alone = self._solving(goals[0])
            self._terms[key] = alone.formula, {goals[0]: alone.term}
        if key not in self._terms:  # making them takes longer than solving them, for each of some transitions
            formula = self._formula()
            trees = [goal.tree for goal in goals if goal.tree is not None]
            terms = formula.terms([JudgedCondition(tree) for tree in trees])
            self._terms[key] = formula, dict(zip(goals, terms, strict=True))
        formula, of = self._terms[key]
        terms = [*(of[goal] for goal in wanted), *(negation(of[goal]) for goal in unwanted)]
        inputs = {text: self._input(text) for text in formula.names()} if avoided else {}
        others = {text: avoided[name] for text, name in inputs.items() if name is not None and name in avoided}
        found = formula.model(terms, {text: self._named(text, value) for text, value in known.items()}, others)
        if found is None:
            return None
        values: dict[str, Value] = {}
        for text, value in found.items():
            name = self._input(text)
            if name is not None:
                accepted = _accepted(self._signals[name], value)
                if accepted is not None:
                    values[name] = accepted
        return values

    def _named(self, text: str, value: Any) -> Any:
        """Return the value of an enumeration as its name."""
        try:
            with self.system.instance.adding_nothing():
                type_ = self.system.instance.type_of(text)
        except SfcError:
            return None
        if isinstance(type_, ScalarType) and type_.family is Family.DATE and isinstance(value, int):
            return date(1970, 1, 1) + timedelta(value // type_.unit)
        names = getattr(type_, "names", None)
        if names and isinstance(value, int) and not isinstance(value, bool):
            return next((name for name, number in names.items() if number == value), None)
        return value


def _is_far(goal: Goal) -> bool:
    """True if no inputs make a goal TRUE now, which takes less time than asking z3."""
    return not goal.own and Measurement([goal.distance]).take() != [0.0]


def _same(tree: Expression) -> Expression:
    return tree


def _own_variables(pou: Pou) -> set[str]:
    """Return the names (lower case) of the variables that a POU does not only name."""
    external = {variable.name for variable in pou.variables(SectionKind.EXTERNAL)}
    return {variable.name.casefold() for variable in pou.variables() if variable.name not in external}


def _without_lists(system: ProgramSystem, shared: Mapping[str, str]) -> dict[str, str]:
    """Return the inputs in lists of global variables by their names without the list, which programs may use."""
    lists = {section.name.casefold() for section in system.subject.project.global_sections() if section.name}
    own = _own_variables(system.subject.pou)
    found: dict[str, list[str]] = {}
    for key, name in shared.items():
        first, _, rest = key.partition(".")
        if rest and first in lists and rest.partition(".")[0].partition("[")[0] not in own:
            found.setdefault(rest, []).append(name)
    return {name: names[0] for name, names in found.items() if len(names) == 1}


def _accepted(signal: Signal, value: Any) -> Value | None:
    """Return a value that z3 has found as one of the input's type."""
    if signal.kind is SignalKind.BOOL:
        return bool(value)
    if signal.kind is SignalKind.ENUMERATION:
        wanted = str(value).casefold()
        return next((number for number, name in signal.names.items() if name.casefold() == wanted), None)
    try:
        if signal.kind is SignalKind.STRING:
            is_text = isinstance(value, str) and len(value) <= (signal.length or len(value))
            return signal.accept(value) if is_text else None
        if signal.kind is SignalKind.REAL:
            return signal.accept(float(value))
        if signal.kind in (SignalKind.INTEGER, SignalKind.DURATION):
            return signal.accept(value if isinstance(value, date) else signal.whole(int(value)))
    except (SfcError, ValueError, OverflowError):
        return None
    return None


def total(distances: Iterable[float]) -> float:
    """Return one measure of several distances."""
    return sum(min(each, _FAR) for each in distances)
