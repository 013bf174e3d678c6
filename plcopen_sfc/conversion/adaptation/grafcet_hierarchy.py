"""Hierarchy of a GRAFCET as one chart: partial charts, macro-steps, forcing orders, enclosing steps.

A chart of a tool knows transitions only. So the partial charts become sequences of one chart, expansions take the place
of their macro-steps, and what rules a chart becomes transitions that are tried before its own: to the forced situation
while the step of the order will be active, to the links of an enclosing step that will become active, to a step that
does nothing where no step may be active. "Will be" is what the same evolution makes of the step, since an order acts in
the evolution that activates it (IEC 60848:2013, 7.1): an expression of step flags and conditions, put in where a
condition needs it. That is exact for charts of which one step is active at a time; others are refused.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from plcopen_sfc.analysis.exclusivity import exclusive
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node
from plcopen_sfc.languages.st.nodes import Expression as Tree
from plcopen_sfc.lowering.code.boolean_logic import FALSE, conjunction, disjunction, negation, simplified
from plcopen_sfc.model.actions import ActionAssociation
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition
from plcopen_sfc.semantics.charts.chart_actions import Owner
from plcopen_sfc.semantics.charts.grafcet.partial_charts import Hierarchy, RuledChart
from plcopen_sfc.semantics.net import Net, indexes

_FIRST = 0
"""The priority of what is tried before all other transitions."""


class HierarchyError(ValueError):
    """A hierarchy that no chart of one level does the same as."""


class FlatChart:
    """A GRAFCET with all its steps and transitions on one level, the conditions and actions as they were.

    `macros` are the steps of each macro-step by its name in lower case. `rule` must still be called.
    """

    def __init__(self, source: SfcNetwork, path: str) -> None:
        """Raise `HierarchyError` for what cannot be one chart, `UnknownBehaviourError` where there is no chart."""
        net = Net.of(source)
        if net.problems:
            raise HierarchyError(net.problems[0].message)
        if any(macro.step.actions for macro in net.macros):
            raise HierarchyError("a macro-step has actions")
        names = [step.step.name.casefold() for step in net.steps]
        twice = next((step.step.name for step in net.steps if names.count(step.step.name.casefold()) > 1), None)
        if twice is not None:
            raise HierarchyError(f"two steps are called {twice}: conditions could not tell them apart")
        owned = [(Owner(s.path, s.bit, 0, inverted=False), each) for s in net.steps for each in s.step.actions]
        hierarchy = Hierarchy(net, owned, path)
        self.ruled = hierarchy.charts
        self._initial = hierarchy.start(net.initial)
        self.macros = {macro.step.name.casefold(): list(indexes(macro.steps)) for macro in net.macros}
        self.steps = [
            step.step.model_copy(
                update={
                    "id": step.index + 1,
                    "initial": bool(step.bit & self._initial),
                    "encloses": None,
                    "actions": [each.model_copy() for each in step.step.actions if each.forcing is None],
                }
            )
            for step in net.steps
        ]
        numbers = iter(range(len(self.steps) + 1, 1_000_000))
        self.transitions = [
            each.transition.model_copy(
                update={
                    "id": next(numbers),
                    "sources": [self.steps[i].id for i in each.sources],
                    "targets": [self.steps[i].id for i in each.targets],
                    "priority": None,
                }
            )
            for each in net.transitions
        ]
        actions: Iterable[ActionAssociation] = (each for step in self.steps for each in step.actions)
        for action, number in zip(actions, numbers, strict=False):
            action.id = number

    def put_into(self, chart: SfcNetwork) -> None:
        """Replace what is in `chart`."""
        chart.drawing, chart.partial_charts, chart.sequences = None, [], []
        chart.steps, chart.transitions = self.steps, self.transitions


class Rules:
    """Transitions for what rules the charts of a `FlatChart`, whose conditions are structured text by now."""

    def __init__(self, chart: SfcNetwork, flat: FlatChart, edged: set[int], name: Callable[[str], str]) -> None:
        """`edged`: the ids of transitions that wait for an edge. `name` makes names that are free."""
        self._chart, self._flat, self._edged, self._name = chart, flat, edged, name

    def apply(self) -> None:
        """Change the chart, from the top of the hierarchy down."""
        for ruled in self._flat.ruled:
            self._rule(ruled)
        # the order alone says which is tried first: not every tool has numbers
        self._chart.transitions = self._in_order()
        for transition in self._chart.transitions:
            transition.priority = None

    def _rule(self, ruled: RuledChart) -> None:
        steps = [self._flat.steps[i] for i in indexes(ruled.steps)]
        own = [t for t in self._chart.transitions if any(step.id in (*t.sources, *t.targets) for step in steps)]
        if any(len(t.sources) != 1 or len(t.targets) != 1 for t in own) or sum(step.initial for step in steps) > 1:
            raise HierarchyError(f"{ruled.name} is ruled, and several of its steps can be active at once")
        waits = [(self._steps(order.steps), order.imposed) for order in ruled.orders]
        idle = None
        if ruled.enclosures or any(imposed == 0 for _, imposed in waits) or not any(step.initial for step in steps):
            idle = Step(id=self._chart.new_id(), name=self._name(f"{ruled.name}_Off"))
            idle.initial = not any(step.initial for step in steps)
            self._chart.steps.append(idle)
        everywhere = [*steps, *([idle] if idle is not None else [])]
        orders = [(self.will_be(by), by, self._imposed(imposed, idle, ruled)) for by, imposed in waits]
        forced = disjunction(condition for condition, _, _ in orders)
        openings, closing = self._enclosures(ruled, idle)
        for step in everywhere:
            holds = [condition for condition, _, target in orders if target is None or target is step]
            for condition, _, target in orders:
                if target is not None and target is not step:
                    self._add(step, target, condition)
            for condition, target in openings:
                if target is step:
                    holds.append(condition)
                elif step is idle or len(openings) > 1 or orders:
                    self._add(step, target, conjunction([condition, negation(forced)]))
            if openings and step is not idle and idle is not None:
                self._add(step, idle, conjunction([closing, negation(forced)]))
            if len(openings) == 1 and not orders:
                holds = []  # it is idle whenever the enclosing step becomes active
            for transition in own:
                if step.id in transition.sources:
                    self._hold(transition, holds, [by for _, by, _ in orders])

        if idle is not None and not self._leaving(idle):
            self._add(idle, idle, FALSE)  # no chart of CODESYS ends with a step

    def _enclosures(self, ruled: RuledChart, idle: Step | None) -> tuple[list[tuple[Tree, Step]], Tree]:
        """Return when each enclosing step becomes active, with the step that it activates; and when none stays so."""
        openings = []
        for enclosing in ruled.enclosures:
            target = self._imposed(enclosing.links, idle, ruled)
            if target is not None:
                openings.append((self._becomes(enclosing.steps), target))
        steps = [step for enclosing in ruled.enclosures for step in self._steps(enclosing.steps)]
        if len(steps) == 1 and not ruled.orders and all(len(t.sources) == 1 for t in self._leaving(steps[0])):
            # the chart has active steps only while this step is active
            return openings, disjunction(self._condition(each) for each in self._leaving(steps[0]))
        return openings, negation(self.will_be(steps))

    def _steps(self, bits: int) -> list[Step]:
        return [self._flat.steps[i] for i in indexes(bits)]

    def _imposed(self, bits: int | None, idle: Step | None, ruled: RuledChart) -> Step | None:
        """Return the step of a situation; None: the present one."""
        if bits is None:
            return None
        steps = self._steps(bits)
        if len(steps) > 1:
            raise HierarchyError(f"{ruled.name} is ruled, and several of its steps can be active at once")
        return steps[0] if steps else idle

    def _leaving(self, step: Step) -> list[Transition]:
        return [each for each in self._chart.transitions if step.id in each.sources]

    def _becomes(self, bits: int) -> Tree:
        """Return when an enclosing step becomes active."""
        (step,) = self._steps(bits)
        if any(step.id in each.targets for each in self._leaving(step)):
            raise HierarchyError(f"step {step.name} encloses a chart, and a transition leads from it to itself")
        before = [] if self._ring(step) is not None else [negation(step_flag(step))]
        return conjunction([self._entered(step), *before])

    def _hold(self, transition: Transition, holds: list[Tree], by: list[list[Step]]) -> None:
        """Let a transition not fire while an order holds its chart."""
        if transition.id in self._edged:
            # an edge is over when the chart is free again, in the evolution behind that which ends the order
            holds = [*holds, *(step_flag(step) for steps in by for step in steps)]
        if holds:
            tree = conjunction([self._condition(transition), *(negation(each) for each in holds)])
            transition.condition = Expression(text=print_node(tree))

    def _add(self, source: Step, target: Step, condition: Tree) -> None:
        text = print_node(condition)
        self._chart.add_transition(source, target, Expression(text=text), priority=_FIRST)

    def _condition(self, transition: Transition) -> Tree:
        condition = transition.condition
        tree = parse_expression(condition.text).tree if isinstance(condition, Expression) else None
        if tree is None:
            raise HierarchyError(f"the condition of {self._chart.label(transition)} cannot be read")
        return simplified(tree)

    # -- what an evolution makes of steps

    def will_be(self, steps: Sequence[Step]) -> Tree:
        """Return when one of these steps is active behind the transitions of a scan."""
        return disjunction(self._will_be(step) for step in steps)

    def _will_be(self, step: Step) -> Tree:
        by_id = {each.id: each for each in self._chart.steps}
        stays = [negation(conjunction(self._enabled(each, step, by_id))) for each in self._leaving(step)]
        return self._entered(step, (conjunction(stays), step.id))

    def _entered(self, step: Step, *also: tuple[Tree, int]) -> Tree:
        """Return when transitions lead to a step. `also`: another condition, and the step that it needs."""
        by_id = {each.id: each for each in self._chart.steps}
        leading: dict[Tree, set[int]] = {}
        parts: list[Tree] = []
        for transition in self._chart.transitions:
            if step.id in transition.targets:
                fires = self._fires(transition)
                if len(transition.sources) == 1:
                    leading.setdefault(fires, set()).add(transition.sources[0])
                else:
                    parts.append(conjunction([*(step_flag(by_id[i]) for i in transition.sources), fires]))
        for condition, source in also:
            leading.setdefault(condition, set()).add(source)
        ring = self._ring(step)
        for condition, sources in leading.items():
            if ring is not None and ring <= sources:
                parts.append(condition)  # one of them is always active
            else:
                parts += [conjunction([step_flag(by_id[i]), condition]) for i in sorted(sources)]
        return disjunction(parts)

    def _enabled(self, transition: Transition, step: Step, by_id: dict[int, Step]) -> Iterator[Tree]:
        """Yield what must be TRUE for a transition to fire while one of its sources, `step`, is active."""
        yield from (step_flag(by_id[i]) for i in transition.sources if i != step.id)
        yield self._condition(transition)

    def _fires(self, transition: Transition) -> Tree:
        """Return when a transition fires whose sources are active: transitions of less priority wait for it."""
        own = self._condition(transition)
        before = []
        for other in self._in_order():
            if other is transition:
                break
            shared = [i for i in other.sources if i in transition.sources]
            if not shared:
                continue
            condition = self._condition(other)
            if not exclusive(print_node(own), print_node(condition)).answer:
                by_id = {each.id: each for each in self._chart.steps}
                more = [step_flag(by_id[i]) for i in other.sources if i not in transition.sources]
                before.append(negation(conjunction([*more, condition])))
        return conjunction([own, *before])

    def _in_order(self) -> list[Transition]:
        return sorted(self._chart.transitions, key=lambda t: (t.priority is None, t.priority or 0))

    def _ring(self, step: Step) -> set[int] | None:
        """Return the steps of which, with `step`, always exactly one is active; None: nobody knows."""
        found, waiting = {step.id}, [step.id]
        while waiting:
            here = waiting.pop()
            for transition in self._chart.transitions:
                if here in transition.sources or here in transition.targets:
                    if len(transition.sources) != 1 or len(transition.targets) != 1:
                        return None
                    for other in (*transition.sources, *transition.targets):
                        if other not in found:
                            found.add(other)
                            waiting.append(other)
        return found if sum(each.initial for each in self._chart.steps if each.id in found) == 1 else None


def sequences_of(chart: SfcNetwork) -> list[list[Step]]:
    """Return the steps of the parts that no transition connects, in the order of the chart."""
    part = {step.id: step.id for step in chart.steps}

    def root(step: int) -> int:
        while part.setdefault(step, step) != step:  # a damaged chart has transitions from steps that it lacks
            step = part[step]
        return step

    for transition in chart.transitions:
        joined = [root(step) for step in (*transition.sources, *transition.targets)]
        part |= dict.fromkeys(joined, min(joined, default=0))
    found: dict[int, list[Step]] = {}
    for step in chart.steps:  # in the order of the chart
        found.setdefault(root(step.id), []).append(step)
    return list(found.values())


def step_flag(step: Step) -> Tree:
    """Return ``Step.X``."""
    return n.Member(n.Name(step.name), n.Name("X"))
