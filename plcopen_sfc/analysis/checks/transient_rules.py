"""Charts that do not come to rest."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.answers import Answer
from plcopen_sfc.analysis.checks.checked_chart import CheckedChart
from plcopen_sfc.analysis.checks.rule import Finding, Rule
from plcopen_sfc.analysis.exclusivity import Truth, covered
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.networks import NetworkExpression
from plcopen_sfc.languages.st.effects import reads


def cycles(chart: CheckedChart) -> Iterator[tuple[int, ...]]:
    """Cycles of transitions (indexes) that are always true; one for each set of steps that they connect."""
    always = [t for t in chart.net.transitions if chart.truth(chart.sheet_of(t), t.transition) is Truth.ALWAYS]
    after: dict[int, list[tuple[int, int]]] = {}
    for transition in always:
        if len(transition.sources) == 1:  # a convergence waits for others
            for target in transition.targets:
                after.setdefault(transition.sources[0], []).append((target, transition.index))
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
    for cycle in cycles(chart):
        names = ", ".join(chart.net.transitions[i].path for i in cycle)
        yield Finding(chart.place_of(chart.net.transitions[cycle[0]]), f"always true in a circle: {names}")


def _run_through(chart: CheckedChart) -> Iterator[Finding]:
    net = chart.net
    for step in net.steps:
        entering = [net.transitions[i] for i in net.entering[step.index]]
        leaving = [net.transitions[i] for i in net.leaving[step.index] if len(net.transitions[i].sources) == 1]
        after = [chart.condition(chart.sheet_of(t), t.transition) for t in leaving]
        plain = [condition for condition in after if not condition.before]
        if not entering or not plain or any(chart.truth(chart.sheet_of(t), t.transition) in _SAID for t in leaving):
            continue
        before = [chart.condition(chart.sheet_of(t), t.transition) for t in entering]
        if all(_implies(condition, plain, chart) for condition in before):
            message = "whenever the step is entered, a transition that leaves it is true already"
            yield Finding(chart.place_of(step), message)


_SAID = frozenset({Truth.ALWAYS})
"""Of conditions that are always true another rule speaks."""


def _implies(condition: NetworkExpression, others: list[NetworkExpression], chart: CheckedChart) -> bool:
    """Whether one of the others is true with it. What is called before conditions may change from one to the next."""
    if condition.before or condition.tree is None:
        return False
    read = reads(condition.tree)
    near = [other for other in others if other.tree is not None and reads(other.tree) & read]
    return bool(near) and covered(condition, others, dialect=chart.dialect, knowledge=chart.knowledge) is Answer.YES


EVO01 = Rule(
    code="EVO01",
    title="The chart comes to rest",
    why="A circle of transitions that are always true is run through without end: in GRAFCET the search for a stable "
    "situation never ends, elsewhere the chart goes round with every scan.",
    hint="Let one transition of the circle wait for something.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := TRUE; END_TRANSITION
TRANSITION FROM S2 TO S1 := a OR NOT a; END_TRANSITION
""",
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
