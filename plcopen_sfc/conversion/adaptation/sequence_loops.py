"""Sequences that charts of other tools cannot hold as they are: each step as a loop of its own.

Actions of S7-GRAPH switch steps of any sequence (ON, OFF), the manual mode does, and INIT_SQ and OFF_SQ end all
branches of a simultaneous sequence at once. Nothing but transitions does that elsewhere, and several steps of one
sequence may be active then. So each step of such a sequence becomes a sequence of two steps: the step itself, and one
that does nothing. Their conditions tell whether the step is active in the next situation of S7-GRAPH: which transitions
fire, in the order of their priorities, and what switches the step. Where actions come before transitions, the last
action computes once which transitions fire (`Fill_to_Stir`): the conditions of a step are a line then, and not all
conditions around it. The rules are those of `plcopen_sfc.semantics.charts.graph`, and the tests compare both.

Charts of CODESYS are nested branches: a sequence with branches that do not end together becomes loops as well.

Charts of CODESYS begin with one step: where there are several sequences, or several initial steps in a chart of another
tool, a step `Start` leads to them all. So it is in TC6 with several initial steps that are connected.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.conversion.adaptation.chart_rewriting import ChartRewriting, all_of, any_of, as_term
from plcopen_sfc.conversion.adaptation.operating_inputs import (
    INIT,
    OFF,
    AddedElements,
    OperatingInputs,
    OperatingModes,
    operated_inputs,
)
from plcopen_sfc.conversion.adaptation.step_checks import StepChecks
from plcopen_sfc.conversion.executed_parts import START
from plcopen_sfc.drawing import limits
from plcopen_sfc.formats.format_interface import ChartHost, WriteOptions
from plcopen_sfc.formats.plcopen.source_marks import OF_BRANCHES, replaced_sequences
from plcopen_sfc.formats.provenance import is_replaced
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition, connected_parts
from plcopen_sfc.report import SEQUENCE, Outcome
from plcopen_sfc.semantics.net import Net

_MOST_SITUATIONS = 1000
_TOGETHER = ".sequences"
"""A name in all marks: an edit of one loop counts for all of them."""


class SequenceRewriter:
    """Rewrites the sequences of a chart whose conditions and actions are rewritten already."""

    def __init__(self, rewriting: ChartRewriting, checks: StepChecks, modes: OperatingModes) -> None:
        self._modes = modes
        self._rewriting, self._checks, self._host = rewriting, checks, rewriting.host
        self._chart = chart = rewriting.chart.chart
        self._wanted = operated_inputs(rewriting, (OFF, INIT))
        net = Net.of_sequencer(rewriting.source)
        self._initial = {step.step.id for step in net.steps if step.bit & net.initial}
        self._order = [
            each for found in net.transitions for each in chart.transitions if each.id == found.transition.id
        ]
        self._texts = {each.id: rewriting.text(each.condition) for each in chart.transitions}
        self._firings: dict[int, str] = {}
        """The variables that tell which transitions fire, by the ids of these."""

    def rewrite(self) -> None:
        """Change the chart; what it does otherwise is in the report."""
        added = AddedElements(self._rewriting, self._checks)
        parts = connected_parts(self._chart.steps, self._chart.transitions)
        self._undrawable = undrawable(self._chart, self._host, self._rewriting.options)
        irregular = [part for part in parts if self._is_irregular(part)]
        operators = [name for part in parts if part not in irregular for name in self._operators(part)]
        looped = [part for part in parts if part in irregular or self._operators(part)]
        plain = [part for part in parts if part not in looped and self._initial.intersection(s.id for s in part)]
        unknown = [each for each in self._order if self._texts[each.id] is None]
        if looped and unknown:
            return  # what is missing then is reported as not executed
        heads = [next(step for step in part if step.id in self._initial) for part in plain]
        if looped:
            heads += self._loops([step for part in looped for step in part], added)
        if operators:
            names = ",".join(dict.fromkeys(operators))
            why = f"steps are loops with `<Step>_rests`; where {names} stay inactive, "
            why += f"--at-rest {names} keeps their sequences"
            if self._modes.switches_of_steps:
                why += f", as does {self._modes.manual} where the manual mode is not used"
            self._rewriting.note(Outcome.TRANSLATED, SEQUENCE, "", why)
        if self._host.is_codesys and (looped or (self._rewriting.of_graph and len(heads) > 1)):
            start = self._start(heads, added)
            if not self._rewriting.of_graph:
                why = "it leads to all sequences: each step of branches that do not end together is one"
                self._rewriting.note(Outcome.APPROXIMATED, START, f"step {start.name}", why)
        elif not self._rewriting.of_graph:
            together = steps_to_start(self._chart, self._host, self._rewriting.options)
            if together:
                start = self._start(together, added)
                why = "it leads to all initial steps: charts of the target have one, and the first scan passes with it"
                self._rewriting.note(Outcome.APPROXIMATED, START, f"step {start.name}", why)
        instead_of = replaced_sequences(self._rewriting.source, self._chart)
        added.mark([_TOGETHER], instead_of, of="" if self._rewriting.of_graph else OF_BRANCHES)
        # INIT_SQ holds the transitions that leave an initial step: their conditions must be known
        is_known = not any(self._initial.intersection(each.sources) for each in unknown)
        OperatingInputs(self._rewriting, self._checks, added).execute(plain if is_known else [], self._initial)

    def _is_irregular(self, part: Sequence[Step]) -> bool:
        """True if a chart of the target cannot hold the sequence, whatever people operate."""
        ids = {step.id for step in part}
        starts = len(ids & self._initial)
        is_switched = not ids.isdisjoint(self._checks.switched)
        if not ids.isdisjoint(self._undrawable):
            return True
        return self._rewriting.of_graph and (is_switched or starts > 1 or (self._host.is_codesys and not starts))

    def _operators(self, part: Sequence[Step]) -> list[str]:
        """Return the inputs for which a sequence needs loops that would keep its form without them."""
        ids = {step.id for step in part}
        own = [each for each in self._order if not ids.isdisjoint(each.sources)]
        one_at_a_time = all(len(each.sources) == 1 and len(each.targets) < 2 for each in own)
        is_plain = one_at_a_time and not ids.isdisjoint(self._initial)
        return [*self._modes.switches_of_steps, *(() if is_plain else self._wanted.values())]

    @cached_property
    def _is_crowded(self) -> bool:
        """True if a transition may lead to a step that is active already."""
        is_switched = bool(self._checks.switched) or bool(self._modes.switches_of_steps)
        source = self._rewriting.source
        if is_switched or len(self._initial) > len(connected_parts(source.steps, source.transitions)):
            return True
        return not self._rewriting.of_graph and marking_graph(self._chart, cap=_MOST_SITUATIONS).safe is not Answer.YES

    # -- one sequence for each step

    def _loops(self, steps: Iterable[Step], added: AddedElements) -> list[Step]:
        """Replace the transitions of these steps by loops; the steps with which these begin."""
        steps = list(steps)
        ids = {step.id for step in steps}
        own = [each for each in self._order if not ids.isdisjoint((*each.sources, *each.targets))]
        edges = {key: self._checks.rising(key) for key in self._wanted}
        if self._host.is_codesys:
            self._compute_firings(own)
        conditions = [
            (self._rewriting.reduced(self._begins(step, edges)), self._rewriting.reduced(self._ends(step, edges)))
            for step in steps
        ]
        why = "the steps that it connects are loops with its condition"
        for each in own:
            self._rewriting.note(Outcome.TRANSLATED, "transition", f"transition {self._chart.label(each)}", why)
            self._rewriting.marks.pop(id(each), None)
        self._chart.transitions = [each for each in self._chart.transitions if each not in own]
        heads: list[Step] = []
        for step, (begins, ends) in zip(steps, conditions, strict=True):
            rest = added.step(f"{step.name}_rests", f"the step {step.name} is not active")
            added.transition(rest, step, begins, "the transitions that lead to the step, and what activates it")
            added.transition(step, rest, ends, "the transitions that leave the step, and what deactivates it")
            step.initial, rest.initial = step.id in self._initial, step.id not in self._initial
            heads.append(step if step.initial else rest)
            if sum(step.id in each.sources for each in own) > 1:
                why = "conditions tell which transition fires"
                self._rewriting.note(Outcome.TRANSLATED, "order of transitions", f"step {step.name}", why)
        return heads

    def _compute_firings(self, own: Iterable[Transition]) -> None:
        """Have a variable computed for each transition that tells whether it fires."""
        names = {step.id: step.name for step in self._chart.steps}
        for each in own:
            text = self._rewriting.reduced(self._fires(each))
            if " " not in text:
                continue  # a flag or a constant
            left = "_".join(names[i] for i in each.sources if i in names)
            entered = "_".join(names[i] for i in each.targets if i in names)
            name = self._rewriting.new_variable(f"{left}_to_{entered}" if entered else f"{left}_ends")
            self._firings[each.id] = name
            self._checks.firings[name] = text

    def _entering(self, step: Step) -> list[str]:
        """Return the firings of the transitions that lead to a step from others."""
        return [self._fires(each) for each in self._order if step.id in each.targets and step.id not in each.sources]

    def _begins(self, step: Step, edges: dict[str, str]) -> str:
        """Return when a step that is not active becomes active."""
        entered = self._entering(step)
        switched = self._checks.is_switched(step, "on")
        if switched is not None:
            entered.append(all_of([switched, *(f"NOT {as_term(each)}" for each in self._leaving(step))]))
        on, off = self._modes.switched(step)
        begins = all_of([any_of([*entered, on]), f"NOT {as_term(off)}" if off != "FALSE" else "TRUE"])
        return self._operated(step, begins, edges, begins=True)

    def _ends(self, step: Step, edges: dict[str, str]) -> str:
        """Return when an active step is not active any more."""
        left = self._leaving(step)
        off, on = self._checks.is_switched(step, "off"), self._checks.is_switched(step, "on")
        if off is not None:
            left.append(off if on is None else f"{off} AND NOT {on}")
        found = any_of(left)
        entered = self._entering(step)
        if entered and found != "FALSE" and self._is_crowded:
            # a step that is left and entered in one cycle stays active
            found = all_of([found, f"NOT {as_term(any_of(entered))}"])
        return self._operated(step, any_of([found, self._modes.switched(step)[1]]), edges, begins=False)

    def _operated(self, step: Step, text: str, edges: dict[str, str], *, begins: bool) -> str:
        """Return a condition with what INIT_SQ and OFF_SQ do to the step."""
        is_initial = step.id in self._initial
        init, off = edges.get(INIT), edges.get(OFF)
        if init is not None:
            text = any_of([text, init]) if is_initial is begins else all_of([text, f"NOT {as_term(init)}"])
        if off is not None:
            text = all_of([text, f"NOT {as_term(off)}"]) if begins else any_of([text, off])
        return text

    def _leaving(self, step: Step) -> list[str]:
        """Return when each transition that leaves an active step fires."""
        own = [each for each in self._order if step.id in each.sources and step.id not in each.targets]
        return [self._fires(each, known=step) for each in own]

    def _fires(self, transition: Transition, known: Step | None = None) -> str:
        """Return when a transition fires; the step `known` is active."""
        if transition.id in self._firings:
            return self._firings[transition.id]
        steps = [step for step in self._chart.steps if step.id in transition.sources]
        terms = [self._is_active(step) for step in steps if step is not known]
        terms.append(self._texts[transition.id] or "TRUE")
        for other in self._order[: self._order.index(transition)]:
            if not set(other.sources).isdisjoint(transition.sources):
                # the only step before the other one is one before this one, whose flag is asked already
                is_asked = len(other.sources) == 1 and other.id not in self._firings
                fires = (self._texts[other.id] or "TRUE") if is_asked else self._fires(other)
                terms.append(f"NOT {as_term(fires)}")
        return all_of(terms)

    def _is_active(self, step: Step) -> str:
        """Return whether a step is active when transitions are tested, behind what actions have switched."""
        found = self._host.active(step)
        off, on = self._checks.is_switched(step, "off"), self._checks.is_switched(step, "on")
        if off is not None:
            found = all_of([found, f"NOT {off}"])
        return any_of([found, on]) if on is not None else found

    # -- the start

    def _start(self, heads: Sequence[Step], added: AddedElements) -> Step:
        start = added.step("Start", "it leads to all sequences: a chart of the target begins with one step")
        start.initial = True
        self._chart.steps.insert(0, self._chart.steps.pop())
        for step in [each for each in self._chart.steps[1:] if self._host.is_codesys or each in heads]:
            if step.initial and step.id in self._rewriting.source_steps:
                why = f"the step {start.name} leads to it"
                self._rewriting.note(Outcome.TRANSLATED, "initial", f"step {step.name}", why)
            step.initial = False
        begins = "TRUE"
        if OFF in self._wanted:
            begins = f"NOT {self._checks.waits(start)}"
            if INIT in self._wanted:
                begins = any_of([begins, f"{self._checks.rising(INIT)} AND NOT {self._checks.rising(OFF)}"])
        added.transition(start, heads, self._rewriting.reduced(begins), "the sequences begin")
        return start


def _may_replace(chart: SfcNetwork, options: WriteOptions) -> bool:
    """True if the chart is none of the target, or the file of the target has other sequences in its place."""
    return not (options.of_codesys or options.same_format) or is_replaced(chart)


def undrawable(chart: SfcNetwork, host: ChartHost, options: WriteOptions) -> frozenset[int]:
    """Return the steps before transitions that wait for branches which do not end together; loops can replace them.

    A loop cannot say that a step is left and entered at once.
    """
    waiting = [each for each in chart.transitions if len(each.sources) > 1]
    if not host.is_codesys or not waiting or not _may_replace(chart, options):
        return frozenset()
    if any(not set(each.sources).isdisjoint(each.targets) for each in chart.transitions):
        return frozenset()
    wrong = {problem.symbol for problem in limits(chart) if problem.code == "SFC130"}
    return frozenset(step for each in waiting if each.id in wrong for step in each.sources)


def steps_to_start(chart: SfcNetwork, host: ChartHost, options: WriteOptions) -> list[Step]:
    """Return the initial steps that a chart of the target cannot have beside each other; none: it can have all."""
    initial = [step for step in chart.steps if step.initial]
    if len(initial) < 2 or not _may_replace(chart, options):
        return []
    if host.is_codesys:
        return initial
    parts = [[step for step in part if step.initial] for part in connected_parts(chart.steps, chart.transitions)]
    return next((part for part in parts if len(part) > 1), [])
