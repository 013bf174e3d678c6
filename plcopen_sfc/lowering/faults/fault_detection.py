"""Faults of textbook sequences in single scans, found by variables that tell which transitions want to fire."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from plcopen_sfc.analysis.marking import MarkingGraph
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.languages.networks.network_graph import apart
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, transform, walk
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.lowering.code.boolean_logic import TRUE, assignment, conjunction, is_constant
from plcopen_sfc.lowering.code.code_bodies import body_of
from plcopen_sfc.lowering.code.lowered_code import LoweredCode, Naming
from plcopen_sfc.lowering.faults.fault_kinds import FaultKind
from plcopen_sfc.lowering.lowering_options import Language
from plcopen_sfc.lowering.reading.chart_source import ActionSource, ChartSource
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import Body
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import VariableSection
from plcopen_sfc.semantics.net import Competing, indexes, mask
from plcopen_sfc.semantics.profile import Evolution, Profile, ScanOrder


class WatchedPou(NamedTuple):
    """Copy, and the variables by the index of their transitions: those before all other code, and those behind."""

    pou: Pou
    before: dict[int, str]
    behind: dict[int, str]


def watched_pou(code: Pou, source: ChartSource, situation: Mapping[str, str], *, behind: bool) -> WatchedPou:
    """Return a copy of `code` with a variable for each transition.

    A variable is TRUE while the steps before its transition are active and its condition is TRUE. `situation` has the
    expressions that are TRUE while steps are active, by the path of the step. Transitions whose condition can be
    evaluated only in its own place, because it asks for the time of a step, have no variable. `behind`: there are
    variables for the end of a scan, too.
    """
    flags = {path.casefold(): parse_expression(text, source.dialect).tree for path, text in situation.items()}
    declared = {v.name.casefold() for v in code.variables()}
    first = LoweredCode(Naming(source.dialect, declared | source.names()))
    last = LoweredCode(first.naming)
    # at the beginning of a scan and at its end: in between the code changes variables of the conditions
    names = _watch(first, source, flags, "wanted"), _watch(last, source, flags, "waits") if behind else {}
    if not names[0]:
        return WatchedPou(code, {}, {})
    copy = code.model_copy(deep=True)
    if copy.interface is not None:
        copy.interface.sections.append(VariableSection(variables=[*first.variables, *last.variables]))
    bodies = list(copy.bodies)
    bodies[0] = _around(bodies[0], first, last, source, copy.variables())
    copy.bodies = bodies
    return WatchedPou(copy, *names)


def _watch(code: LoweredCode, source: ChartSource, flags: Mapping[str, Expression], wanted: str) -> dict[int, str]:
    """Append the assignments of the variables."""
    statements: list[n.Statement] = []
    names: dict[int, str] = {}
    for transition in source.net.transitions:
        condition = _with_flags(source.conditions[transition.index], flags)
        if condition is None:
            continue
        enabled = [flags[source.net.steps[i].path.casefold()] for i in transition.sources]
        variable = code.declare(f"{wanted}_{transition.index + 1}")
        statements.append(assignment(variable, conjunction([*enabled, condition])))
        names[transition.index] = variable.identifier
    code.add("", statements)
    return names


def _with_flags(condition: Expression, flags: Mapping[str, Expression]) -> Expression | None:
    """Return the condition with flags for the step variables in it; None where it has other data of a step."""

    def flag(node: n.Node) -> n.Node:
        match node:
            case n.Member(n.Name(step), n.Name(quantity)) if quantity.casefold() == "x":
                return flags.get(step.casefold(), node)
        return node

    resolved = transform(condition, flag)
    asks = (node.base for node in walk(resolved) if isinstance(node, n.Member))
    if any(isinstance(base, n.Name) and base.identifier.casefold() in flags for base in asks):
        return None
    return resolved


def _around(body: Body, first: LoweredCode, last: LoweredCode, source: ChartSource, declared: list[Variable]) -> Body:
    """Return the body with code before and behind it."""
    language = Language(body.language)
    before, behind = (body_of(code, source.dialect, language, declared, source.pou.name) for code in (first, last))
    match before, body, behind:
        case ((StBody() | IlBody()), (StBody() | IlBody()), (StBody() | IlBody())):
            return type(body)(text=before.text + body.text + behind.text)
        case ((FbdBody() | LdBody()), (FbdBody() | LdBody()), (FbdBody() | LdBody())):
            return type(body)(networks=apart([*before.networks, *body.networks, *behind.networks])[0])
    raise LoweringError(f"nothing can be put around a body in {body.language}")


FaultPlace = tuple[str, ...]
"""The steps, and the output, in which a fault has shown itself."""


@dataclass(frozen=True)
class ObservedScan:
    """Observations in one scan of the code.

    `before` and `after` are the active steps, `wanted` the transitions that were enabled with a TRUE condition at its
    beginning, `waiting` those that are at its end, where that was asked; all as bits. `restarted`: the sequence was
    initialised. `was` and `now` are the outputs of `ChartFacts.outputs` before and after it.
    """

    first: bool
    before: int
    after: int
    wanted: int
    waiting: int
    restarted: bool
    was: Sequence[bool]
    now: Sequence[bool]


@dataclass(frozen=True)
class ObservedOutput:
    """Variable that is driven by qualifier N only: by the steps `always`, and by `sometimes` under conditions."""

    name: str
    always: int
    sometimes: int


class ChartFacts:
    """Facts about a chart and its code before anything runs. `waits`: there is an initialisation."""

    def __init__(
        self,
        source: ChartSource,
        profile: Profile,
        graph: MarkingGraph,
        outputs: Sequence[ObservedOutput],
        *,
        waits: bool,
    ) -> None:
        net = source.net
        self.net, self.profile, self.graph = net, profile, graph
        self.outputs, self.waits = outputs, waits
        driven = {output.name for output in outputs}
        self.executed = [
            (action.name, mask(step for use in action.uses for step in use.steps))
            for action in source.actions
            if not (isinstance(action.target, n.Name) and action.target.identifier in driven)
        ]
        names = (sum(isinstance(node, n.Name) for node in walk(condition)) for condition in source.conditions)
        self.inputs_of_a_condition = max(names, default=0)
        self.following = [mask(x for t in each for x in net.transitions[t].targets) for each in net.leaving]

    def together(self, a: int, b: int) -> bool:
        """Return True if the chart can have both steps active, as far as was searched."""
        together = self.graph.concurrency
        if together is not None:
            return bool(together[a] >> b & 1)
        both = 1 << a | 1 << b
        return any(marking & both == both for marking in self.graph)

    def names(self, *steps: int) -> FaultPlace:
        """Return the paths of steps."""
        return tuple(self.net.steps[step].path for step in steps)


def outputs_of(actions: Sequence[ActionSource]) -> list[ObservedOutput]:
    """Return the Boolean variables that nothing but qualifier N drives."""
    found: list[ObservedOutput] = []
    for action in actions:
        plain = all(use.qualifier in (Qualifier.N, Qualifier.NONE) and not use.inverted for use in action.uses)
        if not isinstance(action.target, n.Name) or not plain:
            continue
        always = sometimes = 0
        for use in action.uses:
            bits = mask(use.steps)
            always |= bits if is_constant(use.condition, TRUE) else 0
            sometimes |= bits
        found.append(ObservedOutput(action.target.identifier, always, sometimes))
    return found


def _overlap(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    for source in indexes(scan.after):
        for target in indexes(facts.following[source] & scan.after & ~(1 << source)):
            # two steps of simultaneous branches may be active together, though one can lead to the other
            if not facts.together(source, target):
                yield facts.names(source, target)


def _run_through(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if facts.profile.evolution is Evolution.UNTIL_STABLE:
        return  # the chart does so too
    entered = scan.after & ~scan.before
    if scan.restarted or scan.first:
        entered &= ~facts.net.initial
    for step in indexes(entered):
        ways = [facts.net.transitions[t] for t in facts.net.entering[step]]
        # a transition from steps that were active explains the step: one evolution
        if any(not way.pre & ~scan.before for way in ways):
            continue
        for way in ways:
            if way.pre & ~(scan.before | scan.after):
                continue
            through = indexes(way.pre & ~scan.before)[0]
            origins = [facts.net.transitions[t].pre for t in facts.net.entering[through]]
            origin = next((bits for bits in origins if not bits & ~(scan.before | scan.after)), 0)
            yield facts.names(*indexes(origin), through, step)


def _blocked_loop(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if scan.restarted:
        return
    for transition in (facts.net.transitions[t] for t in indexes(scan.wanted)):
        # the other one of the selection was to fire
        if any(scan.wanted >> other & 1 for other in transition.competing):
            continue
        for target in indexes(transition.post & ~transition.pre & ~scan.before & ~scan.after):
            if transition.pre & facts.following[target]:
                source = indexes(transition.pre & facts.following[target])[0]
                yield facts.names(*sorted((source, target)))


def _init_empties(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if not scan.restarted:
        return
    for step in indexes(facts.net.initial & ~scan.after):
        behind = facts.following[step] & scan.before & ~(1 << step)
        if behind and not scan.after & ~facts.net.initial:
            yield facts.names(step, indexes(behind)[0])


def _duplicated(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if facts.profile.competing is Competing.ALL:
        return
    entered = scan.after & ~scan.before
    for transition in (facts.net.transitions[t] for t in indexes(scan.wanted)):
        for other in (facts.net.transitions[t] for t in transition.competing if scan.wanted >> t & 1):
            mine, theirs = transition.post & ~other.post, other.post & ~transition.post
            if mine & entered and theirs & entered:
                source = indexes(transition.pre & other.pre)[0]
                yield facts.names(source, indexes(theirs & entered)[0], indexes(mine & entered)[0])


def _lost(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if scan.restarted or (scan.first and facts.waits):
        return
    for step in indexes(scan.before & ~scan.after):
        leaving = [facts.net.transitions[t] for t in facts.net.leaving[step]]
        behind = facts.following[step] & ~(1 << step)
        if not behind & (scan.before | scan.after) and all(t.post for t in leaving):
            yield facts.names(step)


def _not_started(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if scan.first and facts.waits and not scan.after and not scan.restarted and facts.net.initial:
        yield facts.names(*indexes(facts.net.initial))


def _gap(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if scan.before == scan.after or scan.restarted:
        return
    for output, now in zip(facts.outputs, scan.now, strict=True):
        if output.always & scan.before and output.always & scan.after and not now:
            yield (*facts.names(*indexes(scan.before), *indexes(scan.after)), output.name)


def _shifted(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if scan.before == scan.after or scan.restarted:
        return
    late = facts.profile.order is ScanOrder.TRANSITIONS_FIRST
    active = scan.after if late else scan.before
    other = scan.before if late else scan.after
    for output, now in zip(facts.outputs, scan.now, strict=True):
        if output.always & active and not output.always & other and not now:
            yield (*facts.names(*indexes(active)), output.name)


def _swallowed(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if scan.before == scan.after or scan.restarted or scan.first:
        return
    for output, was, now in zip(facts.outputs, scan.was, scan.now, strict=True):
        if output.always & scan.before and not was and not now:
            yield (*facts.names(*indexes(scan.before)), output.name)


def _stuck(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if not scan.restarted:
        return
    for output, now in zip(facts.outputs, scan.now, strict=True):
        if now and output.sometimes & scan.before and not output.sometimes & (facts.net.initial | scan.after):
            yield (*facts.names(*indexes(scan.before)), output.name)


def _init_ignored(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if scan.restarted and scan.after & ~facts.net.initial:
        yield facts.names(*indexes(facts.net.initial), *indexes(scan.after & ~facts.net.initial))


def _late(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if facts.profile.order is not ScanOrder.TRANSITIONS_FIRST or scan.restarted:
        return
    for name, steps in facts.executed:
        if scan.after != scan.before and steps & scan.after:
            yield (*facts.names(*indexes(scan.after)), name)


def _not_stable(facts: ChartFacts, scan: ObservedScan) -> Iterator[FaultPlace]:
    if scan.restarted:
        return
    for transition in (facts.net.transitions[t] for t in indexes(scan.waiting)):
        if transition.post and not transition.post & scan.after:  # else it has fired, and its step is late to go
            yield facts.names(next(iter(indexes(transition.pre)), 0), indexes(transition.post)[0])


Rule = Callable[[ChartFacts, ObservedScan], Iterator[FaultPlace]]
"""Yields the places in which a scan shows a fault; `FaultKind` tells what each of them is."""

FLIP_FLOP_RULES: Mapping[FaultKind, Rule] = {
    FaultKind.OVERLAP: _overlap,
    FaultKind.RUN_THROUGH: _run_through,
    FaultKind.BLOCKED_LOOP: _blocked_loop,
    FaultKind.INIT_EMPTIES: _init_empties,
    FaultKind.DUPLICATED: _duplicated,
    FaultKind.LOST: _lost,
    FaultKind.NOT_STARTED: _not_started,
    FaultKind.NOT_STABLE: _not_stable,
}
"""Faults that a sequence of flip-flops can have."""

CASE_RULES: Mapping[FaultKind, Rule] = {
    FaultKind.GAP: _gap,
    FaultKind.SHIFTED: _shifted,
    FaultKind.SWALLOWED: _swallowed,
    FaultKind.STUCK: _stuck,
    FaultKind.INIT_IGNORED: _init_ignored,
    FaultKind.LATE: _late,
    FaultKind.NOT_STABLE: _not_stable,
}
"""Faults that a CASE can have whose branches hold the actions."""
