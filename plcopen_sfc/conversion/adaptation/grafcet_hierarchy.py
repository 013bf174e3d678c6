"""Hierarchy of a GRAFCET as one chart: partial charts, macro-steps, forcing orders, enclosing steps.

A chart of a tool knows transitions only. So the partial charts become sequences of one chart, expansions take the place
of their macro-steps, and what rules a chart becomes transitions that are tried before its own: to the forced situation
while the step of the order will be active, to the links of an enclosing step that will become active, to a step that
does nothing where no step may be active. "Will be" is what the same evolution makes of the step, since an order acts in
the evolution that activates it (IEC 60848:2013, 7.1): an expression of step flags and conditions, put in where a
condition needs it. That is exact for charts of which one step is active at a time; simultaneous branches of a ruled
chart are divided into such sequences.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from plcopen_sfc.analysis.exclusivity import exclusive
from plcopen_sfc.errors import UnknownBehaviourError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node
from plcopen_sfc.languages.st.nodes import Expression as Tree
from plcopen_sfc.lowering.code.boolean_logic import FALSE, conjunction, disjunction, negation, simplified
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Step, Transition, by_priority
from plcopen_sfc.reachability import reached
from plcopen_sfc.semantics.charts.grafcet.partial_charts import Hierarchy, RuledChart
from plcopen_sfc.semantics.net import Net, indexes

_MOST_SITUATIONS = 500
"""Situations of a ruled chart that are looked at."""
_FIRST = 0
"""The priority of what is tried before all other transitions."""


class HierarchyError(ValueError):
    """A hierarchy that no chart of one level does the same as."""


class FlatChart:
    """A GRAFCET with all its steps and transitions on one level, the conditions and actions as they were.

    `groups` are the steps of each macro-step and partial chart by its name in lower case. `rule` must still be called.
    """

    def __init__(self, source: SfcNetwork, path: str) -> None:
        """Raise `HierarchyError` for what cannot be one chart, `UnknownBehaviourError` for what is broken."""
        net = Net.of(source)
        if net.problems:
            raise UnknownBehaviourError(net.problems[0].message)
        if any(macro.step.actions for macro in net.macros):
            raise HierarchyError("a macro-step has actions")
        names = [step.step.name.casefold() for step in net.steps]
        twice = next((step.step.name for step in net.steps if names.count(step.step.name.casefold()) > 1), None)
        if twice is not None:
            raise HierarchyError(f"two steps are called {twice}: conditions could not tell them apart")
        hierarchy = Hierarchy(net, path)
        self.ruled = hierarchy.charts
        self._initial = hierarchy.start(net.initial)
        flags = ((name.removeprefix("X").casefold(), bits) for name, bits in net.flags.items())
        self.groups = {name: list(indexes(bits)) for name, bits in flags if name not in names}
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

    def activated(self) -> set[int]:
        """Return the ids of the steps that forcing orders and enclosing steps activate."""
        bits = [order.imposed or 0 for ruled in self.ruled for order in ruled.orders]
        bits += [enclosure.links for ruled in self.ruled for enclosure in ruled.enclosures]
        return {self.steps[i].id for each in bits for i in indexes(each)}

    def freed(self, chart: SfcNetwork) -> dict[int, list[Transition]]:
        """Return the transitions of `chart` that let steps evolve which a rule has activated or held, by their ids."""
        found: dict[int, list[Transition]] = {}

        def note(steps: int, by: list[Transition]) -> None:
            for i in indexes(steps):
                found.setdefault(self.steps[i].id, []).extend(by)

        for ruled in self.ruled:
            for order in ruled.orders:
                ends = [t for i in indexes(order.steps) for t in chart.outgoing(self.steps[i])]
                note(ruled.steps if order.imposed is None else order.imposed, ends)
            for enclosure in ruled.enclosures:
                note(enclosure.links, [t for i in indexes(enclosure.steps) for t in chart.incoming(self.steps[i])])
        return found


class Rules:
    """Transitions for what rules the charts of a `FlatChart`, whose conditions are structured text by now."""

    def __init__(self, chart: SfcNetwork, flat: FlatChart, edged: set[int], name: Callable[[str], str]) -> None:
        """`edged`: the ids of transitions that wait for an edge. `name` makes names that are free."""
        self._chart, self._flat, self._edged, self._name = chart, flat, edged, name

    def apply(self) -> dict[str, HierarchyError]:
        """Change the chart, from the top of the hierarchy down; return why charts are not ruled, by their names."""
        refused: dict[str, HierarchyError] = {}
        for ruled in self._flat.ruled:
            steps, transitions = [*self._chart.steps], [(each, each.condition) for each in self._chart.transitions]
            try:
                for part, idle in self._parts(ruled):
                    self._rule(part, idle)
            except HierarchyError as error:  # half of the rules of a chart would do something else
                refused[ruled.name] = error
                self._chart.steps, self._chart.transitions = steps, [each for each, _ in transitions]
                for transition, condition in transitions:
                    transition.condition = condition
        # the order alone decides which is tried first: not every tool has numbers
        self._chart.transitions = self._in_order()
        for transition in self._chart.transitions:
            transition.priority = None
        return refused

    def _parts(self, ruled: RuledChart) -> list[tuple[RuledChart, Step | None]]:
        """Return a ruled chart as sequences of which one step is active at a time, each with the step for none.

        Simultaneous branches become sequences of their own, which wait in that step for the transition that begins
        them: what rules the chart can lead each of them to its situation then.
        """
        own = self._of(ruled)
        if all(len(t.sources) == 1 == len(t.targets) for t in own) and not self._many(self._initial(ruled)):
            return [(ruled, self._idle(ruled, ruled.name, needed=False))]
        orders = [order for order in ruled.orders if order.imposed is not None]
        starts = {self._initial(ruled), *(o.imposed or 0 for o in orders), *(e.links for e in ruled.enclosures)}
        situations = self._situations(ruled, own, starts)
        fires = {each.id: self._fires(each) for each in own}
        found: list[tuple[RuledChart, Step | None]] = []
        for number, bits in enumerate(self._exclusive(ruled, own, situations), 1):
            part = replace(
                ruled,
                steps=bits,
                orders=[o if o.imposed is None else replace(o, imposed=o.imposed & bits) for o in ruled.orders],
                enclosures=[replace(e, links=e.links & bits) for e in ruled.enclosures],
            )
            needed = any(not situation & bits for situation in situations)
            found.append((part, self._idle(part, f"{ruled.name}_{number}", needed=needed)))
        self._divide(own, fires, found)
        return found

    def _of(self, ruled: RuledChart) -> list[Transition]:
        steps = {self._flat.steps[i].id for i in indexes(ruled.steps)}
        return [t for t in self._chart.transitions if not steps.isdisjoint((*t.sources, *t.targets))]

    def _initial(self, ruled: RuledChart) -> int:
        return sum(1 << i for i in indexes(ruled.steps) if self._flat.steps[i].initial)

    def _many(self, bits: int) -> bool:
        return bits.bit_count() > 1

    def _idle(self, ruled: RuledChart, name: str, *, needed: bool) -> Step | None:
        """Return the step in which a chart has no other active, where it may have none."""
        starts = bool(self._initial(ruled))
        if not (needed or ruled.enclosures or not starts or any(order.imposed == 0 for order in ruled.orders)):
            return None
        idle = Step(id=self._chart.new_id(), name=self._name(f"{name}_Off"), initial=not starts)
        self._chart.steps.append(idle)
        return idle

    def _situations(self, ruled: RuledChart, own: list[Transition], starts: set[int]) -> set[int]:
        """Return all sets of steps that can be active together, whatever the conditions are."""
        bit = {self._flat.steps[i].id: 1 << i for i in indexes(ruled.steps)}
        moves = [(sum(bit[i] for i in t.sources), sum(bit[i] for i in t.targets)) for t in own]
        found, waiting = set(starts), list(starts)
        while waiting:
            here = waiting.pop()
            for sources, targets in moves:
                if not sources or here & sources != sources:
                    continue
                if here & targets & ~sources:  # left and entered at once it would stay, which no sequence can do
                    raise HierarchyError(f"{ruled.name} is ruled, and a step of it can be activated twice")
                after = here & ~sources | targets
                if after not in found:
                    found.add(after)
                    waiting.append(after)
            if len(found) > _MOST_SITUATIONS:
                raise HierarchyError(f"{ruled.name} is ruled, and has more than {_MOST_SITUATIONS} situations")
        return found

    def _exclusive(self, ruled: RuledChart, own: list[Transition], situations: set[int]) -> list[int]:
        """Return groups of steps that are never active together, connected ones first."""
        together = dict.fromkeys(indexes(ruled.steps), 0)
        for situation in situations:
            for i in indexes(situation):
                together[i] |= situation
        index = {self._flat.steps[i].id: i for i in together}
        groups: list[int] = []
        for i, others in together.items():
            before = sum({1 << index[s] for t in own if self._flat.steps[i].id in t.targets for s in t.sources})
            fitting = [number for number, group in enumerate(groups) if not group & others]
            best = max(fitting, key=lambda number: bool(groups[number] & before), default=None)
            if best is None:
                groups.append(0)
                best = len(groups) - 1
            groups[best] |= 1 << i
        for transition in own:
            for ends in (transition.sources, transition.targets):
                bits = sum(1 << index[i] for i in ends)
                if not ends or any(self._many(group & bits) for group in groups):
                    raise HierarchyError(f"{ruled.name} is ruled, and a step of it can be activated twice")
        return groups

    def _divide(
        self, own: list[Transition], fires: dict[int, Tree], parts: list[tuple[RuledChart, Step | None]]
    ) -> None:
        """Put a transition of each part in the place of those that lead through several."""
        for transition in own:
            made: list[Transition] = []
            for part, idle in parts:
                steps = {self._flat.steps[i].id for i in indexes(part.steps)}
                ends = [[i for i in each if i in steps] for each in (transition.sources, transition.targets)]
                if ends == [[], []]:
                    continue
                (source, target) = (each[0] if each else idle.id if idle is not None else 0 for each in ends)
                others = self._flags(i for i in transition.sources if i != source)
                text = print_node(conjunction([*others, fires[transition.id]]))
                new = transition.model_copy(
                    update={
                        "id": self._chart.new_id() + len(made),
                        "sources": [source],
                        "targets": [target],
                        "condition": Expression(text=text),
                    }
                )
                made.append(new)
            if len(made) > 1:
                place = next(i for i, each in enumerate(self._chart.transitions) if each is transition)
                self._chart.transitions[place : place + 1] = made
                if transition.id in self._edged:
                    self._edged |= {each.id for each in made}

    def _rule(self, ruled: RuledChart, idle: Step | None) -> None:
        """Let orders and enclosing steps act on a chart: by transitions from each step to the one that they activate.

        `idle` is the added step of a chart that has times without any active step. A transition of the chart does not
        fire while an order holds, nor in the scan in which the enclosing step activates the step that it leaves.
        """
        steps = [self._flat.steps[i] for i in indexes(ruled.steps)]
        own = self._of(ruled)
        waits = [(self._steps(order.steps), order.imposed) for order in ruled.orders]
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
            if openings and step is idle:
                holds.append(closing)  # of a branch that another one begins
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
        stays = [negation(conjunction(self._enabled(each, step))) for each in self._leaving(step)]
        return self._entered(step, (conjunction(stays), step.id))

    def _entered(self, step: Step, *also: tuple[Tree, int]) -> Tree:
        """Return when transitions lead to a step. `also`: another condition, and the step that it needs."""
        leading: dict[Tree, set[int]] = {}
        parts: list[Tree] = []
        for transition in self._chart.transitions:
            if step.id in transition.targets:
                fires = self._fires(transition)
                if len(transition.sources) == 1:
                    leading.setdefault(fires, set()).add(transition.sources[0])
                else:
                    parts.append(conjunction([*self._flags(transition.sources), fires]))
        for condition, source in also:
            leading.setdefault(condition, set()).add(source)
        ring = self._ring(step)
        for condition, sources in leading.items():
            if ring is not None and ring <= sources:
                parts.append(condition)  # one of them is always active
            else:
                parts += [conjunction([flag, condition]) for flag in self._flags(sorted(sources))]
        return disjunction(parts)

    def _enabled(self, transition: Transition, step: Step) -> list[Tree]:
        """Return the conditions under which a transition fires while one of its sources, `step`, is active."""
        return [*self._flags(i for i in transition.sources if i != step.id), self._condition(transition)]

    def _flags(self, ids: Iterable[int]) -> list[Tree]:
        """Return the flags of steps, given by their ids."""
        by_id = {each.id: each for each in self._chart.steps}
        return [step_flag(by_id[i]) for i in ids]

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
                more = self._flags(i for i in other.sources if i not in transition.sources)
                before.append(negation(conjunction([*more, condition])))
        return conjunction([own, *before])

    def _in_order(self) -> list[Transition]:
        return by_priority(self._chart.transitions)

    def _ring(self, step: Step) -> set[int] | None:
        """Return the steps of which, with `step`, always exactly one is active; None: unknown."""
        joined = [{*each.sources, *each.targets} for each in self._chart.transitions]
        ring = reached([step.id], lambda here: (other for ids in joined if here in ids for other in ids))
        for each in self._chart.transitions:
            if not ring.isdisjoint((*each.sources, *each.targets)) and not len(each.sources) == len(each.targets) == 1:
                return None
        return ring if sum(each.initial for each in self._chart.steps if each.id in ring) == 1 else None


def step_flag(step: Step) -> Tree:
    """Return ``Step.X``."""
    return n.Member(n.Name(step.name), n.Name("X"))
