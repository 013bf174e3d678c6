"""Rules on what a chart can reach and leave: on its marking graph and its branches, with all conditions taken as free.

Some of these charts do not come to rest.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache, reduce
from operator import or_

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, Finding, Rule, ring
from plcopen_sfc.analysis.exclusivity import Truth, covered
from plcopen_sfc.analysis.marking import Firing
from plcopen_sfc.analysis.regions import Obstacle, Unstructured, find_regions
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.analysis.soundness import soundness
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.effects import reads
from plcopen_sfc.languages.networks import NetworkExpression
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.semantics.charts.grafcet.term_evaluation import is_edge, is_term
from plcopen_sfc.semantics.net import NetStep, NetTransition


def cycles(chart: CheckedChart) -> Iterator[tuple[int, ...]]:
    """Cycles of transitions (indexes) that are always true; one for each set of steps that they connect."""
    always = [t for t in chart.net.transitions if _truth(chart, t) is Truth.ALWAYS]
    alone = (each for each in always if len(each.sources) == 1)  # a convergence waits for others
    after = grouped((each.sources[0], (target, each.index)) for each in alone for target in each.targets)
    done: set[int] = set()
    for start in sorted(after):
        way: list[int] = []
        at, steps = start, [start]
        while at not in done and at in after:
            target, transition_index = after[at][0]
            way.append(transition_index)
            if target in steps:
                yield tuple(way[steps.index(target) :])
                break
            steps.append(target)
            at = target
        done.update(steps)


def _endless(chart: CheckedChart) -> Iterator[Finding]:
    is_dead = _dead_steps(chart)
    for cycle in cycles(chart):
        first = chart.net.transitions[cycle[0]]
        if not is_dead(first.sources):
            names = ", ".join(chart.net.transitions[i].path for i in cycle)
            yield Finding(chart.place_of(first), f"always true in a circle: {names}")
    if chart.family == "grafcet":
        yield from _unstable(chart)


def _unstable(chart: CheckedChart) -> Iterator[Finding]:
    """Find circles of transitions that are all true as long as one condition is: the shortest from each transition.

    Only inputs count: what actions write, edges, times and flags of steps may be other in the next evolution.
    """
    net, is_dead = chart.net, _dead_steps(chart)
    steady = {t.index: condition for t in net.transitions if (condition := _steady(chart, t)) is not None}
    always = {i for i in steady if _truth(chart, net.transitions[i]) is Truth.ALWAYS}
    done: set[frozenset[int]] = set()
    for first in (i for i in steady if _truth(chart, net.transitions[i]) is Truth.VARIES):
        start = net.transitions[first].sources[0]
        waiting: deque[tuple[int, tuple[int, ...]]] = deque((t, (first,)) for t in net.transitions[first].targets)
        seen: set[int] = set()
        while waiting:
            at, way = waiting.popleft()
            if at == start:
                if frozenset(way) not in done and not is_dead(net.transitions[first].sources):
                    done.add(frozenset(way))
                    one, names = net.transitions[first], ", ".join(net.transitions[i].path for i in way)
                    message = f"as long as the condition of {one.path} is true, a circle fires without end: {names}"
                    yield Finding(chart.place_of(one), message)
                break
            if at in seen:
                continue
            seen.add(at)
            for index in net.leaving[at]:
                if index in always or (index in steady and _implies(steady[first], [steady[index]], chart)):
                    waiting.extend((target, (*way, index)) for target in net.transitions[index].targets)


def _truth(chart: CheckedChart, transition: NetTransition) -> Truth:
    return chart.truth(chart.sheet_of(transition), transition.transition)


def _steady(chart: CheckedChart, transition: NetTransition) -> NetworkExpression | None:
    """Return the condition of a transition that needs one step only; None if something else than inputs changes it."""
    condition = chart.condition(chart.sheet_of(transition), transition.transition)
    if len(transition.sources) != 1 or condition.before or condition.tree is None:
        return None
    changing = chart.flags | chart.around.written | chart.around.associated.keys()
    names = {name for path in reads(condition.tree) for name in path}
    return None if any(is_term(name.upper()) or name in changing for name in names) else condition


def _run_through(chart: CheckedChart) -> Iterator[Finding]:
    net, is_dead = chart.net, _dead_steps(chart)
    known: dict[tuple[Expression | None, ...], bool] = {}  # the conditions of one station are those of the next

    def implies(condition: NetworkExpression, others: Sequence[NetworkExpression]) -> bool:
        if any(each.helpers or each.problems for each in (condition, *others)):
            return _implies(condition, others, chart)
        key = (condition.tree if not condition.before else None, *(other.tree for other in others))
        if key not in known:
            known[key] = _implies(condition, others, chart)
        return known[key]

    for step in net.steps:
        entering = [t for i in net.entering[step.index] if _truth(chart, t := net.transitions[i]) is not Truth.NEVER]
        leaving = [net.transitions[i] for i in net.leaving[step.index] if len(net.transitions[i].sources) == 1]
        after = [chart.condition(chart.sheet_of(t), t.transition) for t in leaving]
        plain = [_behind_edges(condition) for condition in after if not condition.before]
        if not entering or not plain or any(_truth(chart, t) is Truth.ALWAYS for t in leaving):
            continue  # CND02 finds conditions that are always true
        before = [chart.condition(chart.sheet_of(t), t.transition) for t in entering]
        if all(implies(condition, plain) for condition in before) and not is_dead([step.index]):
            message = "whenever the step is entered, a transition that leaves it is true already"
            yield Finding(chart.place_of(step), message)


def _behind_edges(condition: NetworkExpression) -> NetworkExpression:
    """Return a condition of a GRAFCET as it is when its step was just entered: an edge lasts for one evolution."""

    def over(node: n.Node) -> n.Node:
        return _NEVER if isinstance(node, n.Name) and is_edge(node.identifier) else node

    return replace(condition, tree=transform(condition.tree, over)) if condition.tree is not None else condition


_NEVER = n.Literal("FALSE")


def _implies(condition: NetworkExpression, others: Sequence[NetworkExpression], chart: CheckedChart) -> bool:
    """Return True if one of the others is true with it. Calls before conditions may change values between them."""
    if condition.before or condition.tree is None:
        return False
    read = reads(condition.tree)
    near = [other for other in others if other.tree is not None and reads(other.tree) & read]
    return bool(near) and covered(condition, others, dialect=chart.dialect, knowledge=chart.knowledge) is Answer.YES


EVO01 = Rule(
    code="EVO01",
    title="The chart comes to rest",
    why="A circle of transitions that are always true is run through without end: in GRAFCET the search for a stable "
    "situation never ends, elsewhere the chart goes round with every scan. In GRAFCET it is enough that one condition "
    "of inputs makes all others of the circle true, as with equal conditions.",
    hint="Let one transition of the circle wait for something else, such as an edge.",
    example=ring(forth="TRUE", back="a OR NOT a"),
    check=_endless,
    severity=Severity.INFO,
    severities={"grafcet": Severity.ERROR},
)

EVO02 = Rule(
    code="EVO02",
    title="Steps are not run through",
    why="The condition that enters the step lets it be left again, too. In GRAFCET the step is transient: its "
    "continuous actions never happen. Elsewhere it is active for one scan, unless its actions change the variables.",
    hint="Ask for something that comes later, or for an edge: the next press of the button, not the same.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := button AND ready; END_TRANSITION
TRANSITION FROM S2 TO S3 := button; END_TRANSITION
TRANSITION FROM S3 TO S1 := b; END_TRANSITION
""",
    check=_run_through,
    severity=Severity.INFO,
    severities={"grafcet": Severity.WARNING},
)


_LONGEST_WAY = 6


def words(names: tuple[str, ...]) -> str:
    """Return names for people: ``A``, ``A and B``, ``A, B and C``."""
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:]))) or "no step"


def _way(trace: tuple[Firing, ...]) -> str:
    """Return how a situation is reached."""
    fired = [" and ".join(t.path for t in firing.transitions) for firing in trace]
    if not fired:
        return "at the start"
    shown = fired if len(fired) <= _LONGEST_WAY else ["..", *fired[-_LONGEST_WAY:]]
    return "after " + ", ".join(shown)


def started_elsewhere(chart: CheckedChart) -> int:
    """The steps (bits) that something else than a transition may activate: forcing orders, enclosing steps, ON."""
    charts: set[str] = set()
    names: set[str] = set()
    for _, _, association in chart.actions():
        if association.forcing is not None:
            charts.add(association.forcing.chart.casefold())
            names.update(name.casefold() for name in association.forcing.steps)
        if association.qualifier is Qualifier.ON and association.target:
            names.add(association.target.strip('#"').casefold())
    for _, _, enclosure in chart.enclosures():
        charts.add(enclosure.chart.casefold())
        names.update(name.casefold() for name in enclosure.activated_steps)
    found = 0
    for net_step in chart.net.steps:
        partial = chart.sheet_of(net_step).partial
        of_chart = partial is not None and partial.name.casefold() in charts and net_step.step.initial
        if of_chart or net_step.step.name.casefold() in names:
            found |= net_step.bit
    return found


def unreachable(chart: CheckedChart) -> tuple[NetStep, ...]:
    """Return the steps that can never be active."""
    if _plain(chart) and chart.graph.unreachable_steps is not None:
        return chart.graph.unreachable_steps
    start = chart.net.initial | started_elsewhere(chart)
    if chart.family == "grafcet":
        start = reduce(or_, (chart.net.transitions[i].post for i in chart.net.sourceless), start)
    reached = chart.net.reachable(start)
    return tuple(step for step in chart.net.steps if not reached & step.bit)


def _started(chart: CheckedChart) -> bool:
    """Return True if there is a start to reach anything from; a missing one is found by another rule."""
    return bool(chart.net.initial)


def _dead_steps(chart: CheckedChart) -> Callable[[Iterable[int]], bool]:
    """Return what tells if one of some steps (indexes) can never be active: STR06 finds them, nothing else matters."""

    @cache
    def dead() -> frozenset[int]:
        return frozenset(step.index for step in unreachable(chart)) if _started(chart) else frozenset()

    return lambda steps: not dead().isdisjoint(steps)


def _plain(chart: CheckedChart) -> bool:
    """Return True if the marking graph is exact: nothing but transitions moves tokens, all of them from steps.

    A net takes a transition without a step before it for always enabled, as GRAFCET does; elsewhere it never fires.
    """
    if chart.net.sourceless and chart.family != "grafcet":
        return False
    return _started(chart) and not chart.net.hierarchy and not started_elsewhere(chart)


def _unreachable(chart: CheckedChart) -> Iterator[Finding]:
    if not _started(chart):
        return
    for step in unreachable(chart):
        yield Finding(chart.place_of(step), "the step can never become active")


def _unsafe(chart: CheckedChart) -> Iterator[Finding]:
    if not _plain(chart):
        return
    unsafe = chart.graph.unsafe
    if unsafe is not None:
        message = (
            f"{unsafe.transition.path} would activate step {unsafe.step.path} while it is active: "
            f"{_way(unsafe.trace)} the active steps are {words(chart.net.names(unsafe.marking))}"
        )
        yield Finding(chart.place_of(unsafe.step), message)
    elif not chart.graph.complete and soundness(chart.net, cap=len(chart.graph)).safe is Answer.NO:
        yield Finding(chart.root.place, "the chart is too large to say which, but a step can be activated twice")


def dead_joins(chart: CheckedChart) -> tuple[NetTransition, ...]:
    """Transitions whose sources can each be active, but never together."""
    if not _plain(chart):
        return ()
    never = reduce(or_, (step.bit for step in unreachable(chart)), 0)
    return tuple(t for t in chart.graph.dead_transitions or () if len(t.sources) > 1 and not t.pre & never)


def _dead(chart: CheckedChart) -> Iterator[Finding]:
    for transition in dead_joins(chart):
        names = words(tuple(chart.net.steps[i].path for i in transition.sources))
        yield Finding(chart.place_of(transition), f"{names} are never active together: the transition is never enabled")


def _ends(chart: CheckedChart) -> int:
    """Return the steps that no transition leaves."""
    return reduce(or_, (step.bit for step in chart.net.steps if not chart.net.leaving[step.index]), 0)


def _deadlocks(chart: CheckedChart) -> Iterator[Finding]:
    if not _plain(chart):
        return
    ends = _ends(chart)
    for marking in chart.graph.deadlocks:
        if marking and not marking & ends:
            names = chart.net.names(marking)
            message = f"nothing leads on from {words(names)} together: {_way(chart.graph.trace(marking))}"
            step = next(step for step in chart.net.steps if step.bit & marking)
            yield Finding(chart.place_of(step), message)
            return


def _one_way(chart: CheckedChart) -> Iterator[Finding]:
    ends = _ends(chart) or any(not t.targets for t in chart.net.transitions)
    if ends or not _plain(chart) or chart.graph.way_home is not Answer.NO:
        return  # there are rules on ends, too
    stranded = chart.graph.stranded
    if stranded is not None:
        names, home = (words(chart.net.names(marking)) for marking in (stranded, chart.net.initial))
        message = f"from {names} no way leads back to {home}: {_way(chart.graph.trace(stranded))}"
        yield Finding(chart.root.place, message)


STR06 = Rule(
    code="STR06",
    title="Every step can become active",
    why="A step that no way leads to is never executed (IEC 61131-3 ed. 3, 6.7.5, unreachable steps). All conditions "
    "are taken as free here: no condition can help.",
    hint="Connect the step, or remove it with what follows it.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP Forgotten: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
TRANSITION FROM Forgotten TO S1 := c; END_TRANSITION
""",
    check=_unreachable,
    severity=Severity.WARNING,
    severities={"iec": Severity.ERROR},
)

STR07 = Rule(
    code="STR07",
    title="No step is activated twice",
    why="A branch that is left by a jump, or simultaneous branches that end in a selection, leave tokens behind. The "
    "next round meets them: steps are active together that never should be (IEC 61131-3 ed. 3, 6.7.5, unsafe network). "
    "In GRAFCET the step stays active, which may be meant.",
    hint="Let simultaneous branches meet in a simultaneous convergence, without jumps into them or out of them.",
    example="""
INITIAL_STEP S1: END_STEP
STEP A: END_STEP
STEP B: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO (A, B) := a; END_TRANSITION
TRANSITION FROM A TO S2 := b; END_TRANSITION
TRANSITION FROM B TO S2 := c; END_TRANSITION
TRANSITION FROM S2 TO S1 := d; END_TRANSITION
""",
    check=_unsafe,
    severity=Severity.ERROR,
    severities={"grafcet": Severity.WARNING},
)

STR08 = Rule(
    code="STR08",
    title="A simultaneous convergence can be enabled",
    why="Where branches of a selection meet in a simultaneous convergence, all of its steps are never active "
    "together: the chart is locked (IEC 61131-3 ed. 3, 6.7.5).",
    hint="Let the branches of a selection meet in a selection convergence.",
    example="""
INITIAL_STEP S1: END_STEP
STEP A: END_STEP
STEP B: END_STEP
TRANSITION FROM S1 TO A := a; END_TRANSITION
TRANSITION FROM S1 TO B := b; END_TRANSITION
TRANSITION FROM (A, B) TO S1 := c; END_TRANSITION
""",
    check=_dead,
    severity=Severity.ERROR,
)

STR10 = Rule(
    code="STR10",
    title="Nothing locks the chart",
    why="In a deadlock steps are active, each of them has a transition, and none of these can ever be enabled: the "
    "chart is locked until it is reset.",
    hint="Look which branch the convergence waits for, and how that was left.",
    example="""
INITIAL_STEP S1: END_STEP
STEP A: END_STEP
STEP B: END_STEP
STEP C: END_STEP
TRANSITION FROM S1 TO (A, B) := a; END_TRANSITION
TRANSITION FROM A TO C := b; END_TRANSITION
TRANSITION FROM (A, B) TO S1 := c; END_TRANSITION
TRANSITION FROM (A, C) TO S1 := d; END_TRANSITION
""",
    check=_deadlocks,
    severity=Severity.WARNING,
)

STR15 = Rule(
    code="STR15",
    title="A way leads back to the start",
    why="From some situation the initial one cannot be reached again. Charts that run once are meant so; in others a "
    "branch has no end.",
    hint="Nothing, if the chart runs once. Else add the transition or jump that leads back.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S3 := b; END_TRANSITION
TRANSITION FROM S3 TO S2 := c; END_TRANSITION
""",
    check=_one_way,
    severity=Severity.INFO,
)


_CROSSING = frozenset(
    {
        Obstacle.JUMP_ACROSS_BORDER,
        Obstacle.BRANCHES_RUN_TOGETHER,
        Obstacle.UNMATCHED_JOIN,
        Obstacle.UNMATCHED_FORK,
    }
)


def _crossing(chart: CheckedChart) -> Iterator[Finding]:
    if chart.net.hierarchy:
        return
    found = find_regions(chart.net)
    if isinstance(found, Unstructured) and found.obstacle in _CROSSING and found.transitions:
        place = chart.place_of(chart.net.transitions[found.transitions[0]])
        yield Finding(place, found.message)


STR13 = Rule(
    code="STR13",
    title="Simultaneous branches are nested, and nothing leads into them or out of them",
    why="Branches that begin together end together. A jump out of a branch leaves the others active, one into a "
    "branch starts it without the others (IEC 61131-3 ed. 3, 6.7.5). CODESYS and S7-GRAPH draw branches in each other "
    "only, but CODESYS lets jumps cross their borders.",
    hint="Let the branches meet in one convergence; where one shall end early, let its last step wait for the others.",
    example="""
INITIAL_STEP S1: END_STEP
STEP A: END_STEP
STEP B: END_STEP
TRANSITION FROM S1 TO (A, B) := a; END_TRANSITION
TRANSITION FROM (A, B) TO S1 := b; END_TRANSITION
TRANSITION FROM A TO S1 := stop; END_TRANSITION
""",
    check=_crossing,
    severity=Severity.WARNING,
    severities={"grafcet": Severity.INFO},
)
