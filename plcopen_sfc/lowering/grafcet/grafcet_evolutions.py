"""Edges and times of IEC 60848 in conditions (4.6) as code of every evolution, and the most evolutions of a scan."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from graphlib import CycleError, TopologicalSorter

from plcopen_sfc.analysis.marking import explore_in_sets
from plcopen_sfc.grouping import Clusters
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform, walk
from plcopen_sfc.languages.st.nodes import Expression, Node, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    call,
    conjunction,
    disjunction,
    is_constant,
    names_in,
    negation,
    simplified,
)
from plcopen_sfc.lowering.code.lowered_code import LoweredCode
from plcopen_sfc.lowering.reading.chart_source import ChartSource, DelayInCondition, EdgeInCondition, GrafcetSource
from plcopen_sfc.lowering.schedule.scan_schedule import exclude
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.semantics.charts.grafcet.partial_charts import RuledChart
from plcopen_sfc.semantics.net import Competing, Net, NetTransition, indexes
from plcopen_sfc.semantics.profile import Profile


class TermCode:
    """Variables for the terms of a chart, and the statements that bring them up to date.

    `times` and `edges` are to be executed in this order before the transitions are tested; `starts` are values of
    variables before the first evolution. `active` gives the flag of a step.
    """

    def __init__(self, grafcet: GrafcetSource, code: LoweredCode, active: Collection[Expression]) -> None:
        self._code = code
        self._texts = code.texts
        self._values: dict[str, Expression] = {}
        self._timers: dict[str, list[n.Name]] = {}
        self._active = set(active)
        self._inactive = {negation(each) for each in active}
        self.times: list[Statement] = []
        self.edges: list[Statement] = []
        self.starts: list[tuple[n.Name, Expression]] = []
        # stored actions may change what they name before the first evolution
        self._early = set(names_in(*(tree for stored in grafcet.stored for tree in stored.statements)))
        for delay in grafcet.delays:
            self._values[delay.name.casefold()] = self._declare_delay(delay)
        for edge in grafcet.edges:
            self._values[edge.name.casefold()] = code.declare(code.texts.edge_name(edge.words, rising=edge.rising))
        for delay in grafcet.delays:
            self._add_delay(delay)
        for edge in grafcet.edges:
            self._add_edge(edge)

    def named(self, node: Node) -> Node:
        """Return the variable of a term in the place of its name."""
        return self._values.get(node.identifier.casefold(), node) if isinstance(node, n.Name) else node

    def value_of(self, term: EdgeInCondition | DelayInCondition) -> Expression:
        """Return the value of a term."""
        return self._values[term.name.casefold()]

    def _declare_delay(self, delay: DelayInCondition) -> Expression:
        kinds = [(delay.first, "TON"), (delay.last, "TOF")]
        names = [
            self._code.declare(self._texts.delay_name(delay.words, time.text), DerivedType(name=kind))
            for time, kind in kinds
            if isinstance(time, n.Literal)
        ]
        self._timers[delay.name] = names
        return n.Member(names[-1], n.Name("Q"))

    def _add_delay(self, delay: DelayInCondition) -> None:
        value = transform(delay.operand, self.named)
        times = [time for time in (delay.first, delay.last) if time is not None]
        # TON, then TOF: the second delay begins when the first one has passed
        for timer, time in zip(self._timers[delay.name], times, strict=True):
            self.times.append(call(timer, IN=value, PT=time))
            value = n.Member(timer, n.Name("Q"))

    def _add_edge(self, edge: EdgeInCondition) -> None:
        pulse = self._values[edge.name.casefold()]
        assert isinstance(pulse, n.Name)  # noqa: S101  # edges are variables
        operand = transform(edge.operand, self.named)
        # the first evolution compares with the value before the start, when no step was active: ``↑X1`` of an initial
        # step is an edge, one of an input that is TRUE is none
        start = self._at_the_start(operand)
        initial = "TRUE" if (is_constant(start, TRUE) if start is not None else edge.rising) else None
        before = self._code.declare(self._texts.with_suffix(pulse.identifier, "old"), initial=initial)
        if start is not None and not is_constant(start, TRUE) and not is_constant(start, FALSE):
            self.starts.append((before, start))
        now, then = (operand, negation(before)) if edge.rising else (negation(operand), before)
        self.edges += [assignment(pulse, conjunction([now, then])), assignment(before, operand)]

    def _at_the_start(self, operand: Expression) -> Expression | None:
        """Return the value of an operand before the first evolution, with no active step; None: its present one."""
        hidden = {*self._values.values(), *self._active}
        found = False

        def without(node: Node) -> Node:
            nonlocal found
            value = FALSE if node in hidden else TRUE if node in self._inactive else node
            found = found or value is not node
            return value

        start = simplified(transform(operand, without))
        early = not self._early.isdisjoint(names_in(operand))
        called = any(isinstance(node, n.Call | n.Member) for node in walk(operand))
        return start if found or early or called else None


_MOST_SITUATIONS = 10_000


class Concurrency:
    """Situations of a chart, as far as they allow transitions to fire together. Too many to explore: all are possible.

    Each part of the chart that no transition connects with others is explored alone, from its initial situation and
    from those that the charts above impose on it.
    """

    def __init__(self, source: ChartSource, profile: Profile) -> None:
        # competing transitions whose conditions exclude each other never fire together: then the situations under
        # priority are all, and they are fewer
        conditions = source.conditions
        pairs = ((conditions[t.index], conditions[other]) for t in source.net.transitions for other in t.competing)
        apart = (exclude(one, other, source.dialect) for one, other in pairs)
        together = profile.competing is Competing.ALL and not all(apart)
        self._competing = Competing.ALL if together else Competing.PRIORITY
        ruled = source.grafcet.ruled if source.grafcet is not None else ()
        self._parts = [_Part(source.net, steps, ruled, self._competing) for steps in _parts(source.net)]
        self._part_of = {step: part for part in self._parts for step in indexes(part.steps)}

    def both_fire(self, one: NetTransition, other: NetTransition) -> bool:
        """Return True if two transitions can fire in the same evolution."""
        if one.pre & other.pre and self._competing is Competing.PRIORITY:
            return False
        return self._is_there(one.pre | other.pre)

    def enters_active(self, transition: NetTransition, step: int) -> bool:
        """Return True if a transition can fire while a step that it activates is active."""
        return self._is_there(transition.pre | 1 << step)

    def _is_there(self, active: int) -> bool:
        touched = {id(part): part for part in (self._part_of[step] for step in indexes(active))}
        return all(part.can_be(active & part.steps) for part in touched.values())


class _Part:
    """Situations that a part can be in, by the steps that are active in them; `complete` if these are all."""

    def __init__(self, net: Net, steps: int, ruled: Sequence[RuledChart], competing: Competing) -> None:
        self.steps = steps
        self._with: dict[int, list[int]] = {}
        imposed = (start for chart in ruled if chart.steps & steps for start in _imposed(chart))
        # the situations are an over-approximation, which is right for both questions: can fire together, can be active
        starts = {start & steps for start in (net.initial, *imposed)}
        found = explore_in_sets(net, competing, _MOST_SITUATIONS, starts, steps)
        self._complete = found.complete
        for marking in found.seen:
            for step in indexes(marking):
                self._with.setdefault(step, []).append(marking)

    def can_be(self, active: int) -> bool:
        """Return True if all these steps can be active together."""
        first = indexes(active)[0]
        return not self._complete or any(not active & ~marking for marking in self._with.get(first, ()))


def _parts(net: Net) -> list[int]:
    """Return the steps of each part as bits."""
    parts = Clusters(range(len(net.steps)))
    for transition in net.transitions:
        parts.unite((*transition.sources, *transition.targets))
    return [sum(1 << step for step in steps) for steps in parts.members().values()]


def _imposed(chart: RuledChart) -> Iterator[int]:
    """Yield the situations that the charts above can put a chart into."""
    yield from (order.imposed for order in chart.orders if order.imposed is not None)
    opened = {0} if chart.enclosures else set()
    for enclosing in chart.enclosures:  # several can become active at once
        opened |= {links | enclosing.links for links in opened}
    yield from opened


class Stability:
    """Evolutions of a chart in a scan; its texts have the variables of steps and terms already.

    `active` are the flags of steps in the order of the net; `own` are the variables of the lowered code.
    """

    def __init__(
        self,
        source: ChartSource,
        terms: TermCode,
        active: Iterable[Expression],
        own: Iterable[str],
        seen: Concurrency,
    ) -> None:
        assert source.grafcet is not None  # noqa: S101  # only such charts are asked for
        self._source, self._grafcet, self._seen = source, source.grafcet, seen
        self._steps = {expression: step for step, expression in enumerate(active)}
        self._states = set(names_in(*self._steps))
        self._edges = {terms.value_of(edge): edge for edge in source.grafcet.edges}
        self._delays = {terms.value_of(delay): delay for delay in source.grafcet.delays}
        self._own = {name.casefold() for name in own}
        self._written = set(names_in(*(tree for stored in source.grafcet.stored for tree in stored.statements)))
        self._timers = {value.base for value in self._delays if isinstance(value, n.Member)}
        edges = self._edges.items()
        self._over = {pulse for pulse, e in edges if not self._changes(e.operand) and not self._steps_in(e.operand)}
        self._objection = ""
        self.most = self._most()
        """The most evolutions of a scan in which a transition fires; None: there may be any number of them."""

    @property
    def once(self) -> bool:
        """True if one evolution in each scan does the same as the search for stability."""
        return not self.several

    @cached_property
    def several(self) -> str:
        """Reason why a scan may need several evolutions; empty if one is enough."""
        if self._objection:
            return self._objection
        events = [stored.event for stored in self._grafcet.stored if stored.event is not None]
        if not all(is_constant(self._later(event), FALSE) for event in events):
            return "an event can happen in each of several evolutions"
        actions = (tree for a in (*self._source.actions, *self._grafcet.continuous) for tree in a.trees())
        if any(node in self._edges for tree in actions for node in walk(tree) if isinstance(node, n.Name)):
            return "an action asks for an edge, which only lasts for one evolution"
        return ""

    def _most(self) -> int | None:
        """Return the length of the longest run of transitions that can follow each other; None if there is no end."""
        # an order changes a chart without a transition: the order of transitions alone bounds nothing
        if self._grafcet.ruled:
            self._objection = "charts that others force or enclose are held and set free again"
            return None
        transitions = self._source.net.transitions
        later = [self._later(condition) for condition in self._source.conditions]
        readers: dict[int, list[int]] = {}
        for transition in transitions:
            if is_constant(later[transition.index], FALSE):
                continue
            # a source transition is always enabled, and a condition that changes by itself needs no step to become
            # active
            if not transition.pre or self._is_volatile(transition, later[transition.index]):
                self._objection = f"transition {transition.path} may fire in each of several evolutions"
                return None
            for step in indexes(self._reads(later[transition.index])):
                readers.setdefault(step, []).append(transition.index)
        followers = {t.index: self._followers(t, later, readers) for t in transitions}
        pair = next(((t, u) for t in transitions for u in sorted(followers[t.index])), None)
        if pair is not None:
            first, second = pair[0].path, transitions[pair[1]].path
            self._objection = f"transition {second} may follow {first} with the same inputs"
        # the graph of followers without a circle bounds the evolutions by its longest path; with one the loop needs a
        # counter
        try:
            order = list(TopologicalSorter(followers).static_order())
        except CycleError:
            return None
        length: dict[int, int] = {}
        for index in order:  # followers come before those they follow
            length[index] = 1 + max((length[u] for u in followers[index]), default=0)
        return max(length.values(), default=0)

    def _followers(
        self, before: NetTransition, later: Sequence[Expression], readers: Mapping[int, Sequence[int]]
    ) -> set[int]:
        """Return the transitions that can fire in the evolution behind that in which `before` fires."""
        found = {index for step in indexes(before.pre | before.post) for index in readers.get(step, ())}
        left = before.pre & ~before.post  # what needs these steps does not follow, unless another one enters them again
        found = {index for index in found if not self._source.net.transitions[index].pre & left}
        # with the same inputs both conditions hold in one scan: what excludes the condition of `before` cannot follow
        # it
        own = self._source.conditions[before.index]
        cleared = disjunction([own, later[before.index]])
        for step in indexes(before.post):
            for index in set(self._source.net.leaving[step]) - found:
                # the time of a step that was active already may have passed
                again = self._seen.enters_active(before, step)
                fresh = later[index] if again else self._just_entered(later[index], step)
                if not exclude(cleared, self._renamed(fresh), self._source.dialect):
                    found.add(index)
        return found

    # -- what changes between two evolutions

    def _is_volatile(self, transition: NetTransition, later: Expression) -> bool:
        """Return True if something else than the activity of steps can make a condition TRUE between two evolutions."""
        condition = self._source.conditions[transition.index]
        if self._source.preparations[transition.index] or self._changes(condition):
            return True
        return later != simplified(condition) and not exclude(later, negation(condition), self._source.dialect)

    def _changes(self, tree: Expression) -> bool:
        """Return True if it depends on what is called, or on what stored actions or the lowered code write."""
        for node in walk(tree):
            if isinstance(node, n.Call | n.AssignmentExpression):
                return True
            term = self._term(node)
            if term is not None and self._changes(term.operand):
                return True
            if isinstance(node, n.Name):
                name = node.identifier.casefold()
                known = name in self._states or node in self._edges or node in self._timers
                if name in self._written or (name in self._own and not known):
                    return True
        return False

    def _term(self, node: Node) -> EdgeInCondition | DelayInCondition | None:
        if isinstance(node, n.Name):
            return self._edges.get(node)
        return self._delays.get(node) if isinstance(node, n.Member) else None

    def _reads(self, condition: Expression) -> int:
        """Return the steps whose activity can make a condition TRUE, as bits."""
        for term in [node for node in walk(condition) if isinstance(node, n.Member) and node in self._delays]:
            if self._only_falls(self._delays[term]) and _rises_with(condition, term, self._source):
                condition = _with(condition, term, TRUE)
        return self._steps_in(condition)

    def _steps_in(self, tree: Expression) -> int:
        bits = 0
        for node in walk(tree):
            if isinstance(node, n.Name | n.Member | n.Address | n.Operation):
                bits |= self._step_bits(node)
            term = self._term(node)
            bits |= self._steps_in(term.operand) if term is not None else 0
        return bits

    def _step_bits(self, node: n.Name | n.Member | n.Address | n.Operation) -> int:
        """Return the step whose activity a node is, or the opposite of it (``step_number <> 2``), as a bit."""
        step = self._steps.get(node, self._steps.get(negation(node)))
        return 0 if step is None else 1 << step

    def _only_falls(self, delay: DelayInCondition) -> bool:
        """Return True if the term cannot become TRUE between two evolutions: its time has still to pass."""
        return delay.last is None and not self._changes(delay.operand)

    def _later(self, tree: Expression) -> Expression:
        """Return the condition in every evolution but the first: edges of inputs are over."""
        over = self._over
        return simplified(transform(tree, lambda node: FALSE if isinstance(node, n.Name) and node in over else node))

    def _just_entered(self, tree: Expression, step: int) -> Expression:
        """Return the condition when a step has just become active: times since then have not passed."""

        def fresh(node: Node) -> Node:
            delay = self._delays.get(node) if isinstance(node, n.Member) else None
            if delay is None or not self._only_falls(delay):
                return node
            return FALSE if self._steps.get(delay.operand) == step else node

        return simplified(transform(tree, fresh))

    def _renamed(self, tree: Expression) -> Expression:
        """Return a condition with other names for what may have changed since the evolution before."""

        def other(node: Node) -> Node:
            if isinstance(node, n.Name) and (node.identifier.casefold() in self._states or node in self._edges):
                return n.Name(f"{node.identifier}_now", node.quoting)
            if isinstance(node, n.Member) and node in self._delays and self._steps_in(node):
                return n.Name(f"{_path(node)}_now")
            return node

        return transform(tree, other)


def _path(member: n.Member) -> str:
    return f"{member.base.identifier}_{member.name.identifier}" if isinstance(member.base, n.Name) else "term"


def _rises_with(condition: Expression, atom: Expression, source: ChartSource) -> bool:
    """Return True if a condition that is TRUE while a term is FALSE is also TRUE when the term is TRUE."""
    without, with_ = _with(condition, atom, FALSE), _with(condition, atom, TRUE)
    return without != with_ and exclude(without, negation(with_), source.dialect)


def _with(condition: Expression, atom: Expression, value: n.Literal) -> Expression:
    return simplified(transform(condition, lambda node: value if node == atom else node))
