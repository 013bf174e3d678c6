"""INIT_SQ and OFF_SQ of a block of S7-GRAPH as transitions of charts of other tools.

A rising edge of OFF_SQ deactivates all steps, one of INIT_SQ activates the initial steps instead of all others, and no
transition counts in that cycle (`plcopen_sfc.semantics.charts.graph`, and the tests compare both). A sequence of which
one step is active at a time does that with transitions that are tried before all others: from every step to the
initial one, and to one that does nothing. Other sequences become loops (`sequence_loops`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from plcopen_sfc.conversion.adaptation.chart_rewriting import ChartRewriting, as_term, conjunction
from plcopen_sfc.conversion.adaptation.step_checks import StepChecks
from plcopen_sfc.formats.plcopen.source_marks import REWRITTEN_FIELD, added_element, rewritten_transition
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.s7_programs import unused_inputs
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.sfc import Step, Transition
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import Outcome

OFF, INIT = "OFF_SQ", "INIT_SQ"
_HIGHEST_PRIORITY = 0
"""The priority of what is tried before all other transitions: S7-GRAPH counts from 1."""


def operated_inputs(rewriting: ChartRewriting, names: Collection[str]) -> dict[str, str]:
    """Return those of the inputs `names`, in upper case, that somebody may operate, as the block declares them."""
    pou, chart = rewriting.chart.pou, rewriting.chart.chart
    found = {v.name.upper(): v.name for v in pou.variables(SectionKind.INPUT) if v.name.upper() in names}
    if not found or chart.graph_settings is None:
        return {}
    unused: Collection[str] = ()
    if pou.project is not None:
        unused = unused_inputs(Names(pou.project), pou, found.values())
    at_rest = rewriting.options.at_rest
    return {key: name for key, name in found.items() if key not in at_rest and name not in unused}


class AddedElements:
    """Adds steps and transitions that the source does not have to a chart, with marks for the way back."""

    def __init__(self, rewriting: ChartRewriting, checks: StepChecks) -> None:
        self._rewriting, self._checks = rewriting, checks
        self._chart = rewriting.chart.chart
        known = {step.id for step in self._chart.steps} | {each.id for each in self._chart.transitions}
        drawn = self._chart.drawing.symbols if self._chart.drawing is not None else []
        # a file that is edited has symbols of what was added when it was written, and keeps their ids
        free = sorted((symbol.id, symbol.kind) for symbol in drawn if symbol.id not in known)
        self._ids = {kind: iter([number for number, each in free if each is kind]) for _, kind in free}
        self._added: list[Step | Transition] = []

    def step(self, wish: str, why: str) -> Step:
        """Add a step; its name is `wish`, or like it."""
        step = self._chart.add_step(self._rewriting.new_name(wish))
        step.id = next(self._ids.get(SymbolKind.STEP, iter(())), step.id)
        self._added.append(step)
        self._rewriting.note(Outcome.TRANSLATED, "step", f"step {step.name}", why)
        return step

    def transition(
        self, source: Step, targets: Step | Iterable[Step], condition: str, why: str, *, first: bool = False
    ) -> None:
        """Add a transition; `first`: it is tried before all others."""
        priority = _HIGHEST_PRIORITY if first else None
        added = self._chart.add_transition(source, targets, Expression(text=condition), priority=priority)
        added.id = next(self._ids.get(SymbolKind.TRANSITION, iter(())), added.id)
        self._added.append(added)
        self._rewriting.note(Outcome.TRANSLATED, "transition", f"transition {self._chart.label(added)}", why)

    def mark(self, together: Iterable[str] = (), instead_of: dict[str, object] | None = None) -> None:
        """Mark all that was added; `together`: names by which edits of one count for all."""
        uses = [*self._checks.names_of_edges(), *together]
        for added in self._added:
            self._rewriting.marks[id(added)] = added_element(added, uses, instead_of)
            instead_of = None
        self._added = []


class OperatingInputs:
    """Adds the transitions to sequences of which one step is active at a time; the others are rewritten already."""

    def __init__(self, rewriting: ChartRewriting, checks: StepChecks, added: AddedElements) -> None:
        self._rewriting, self._checks, self._added = rewriting, checks, added
        self._chart = rewriting.chart.chart
        self._wanted = operated_inputs(rewriting, (OFF, INIT))

    def execute(self, sequences: Iterable[Sequence[Step]], initial: Collection[int]) -> None:
        """Change these sequences, each with one of the `initial` steps, and report what stands for the inputs."""
        edges = {key: self._checks.rising(key) for key in self._wanted}
        for steps in sequences if edges else ():
            self._sequence(steps, next(step for step in steps if step.id in initial), edges)
        self._added.mark()
        for name in self._wanted.values():
            why = "transitions that are tried before all others"
            self._rewriting.note(Outcome.TRANSLATED, "operating input", name, why)

    def _sequence(self, steps: Sequence[Step], initial: Step, edges: dict[str, str]) -> None:
        ids, steps = {step.id for step in steps}, [*steps]
        own = [each for each in self._chart.transitions if not ids.isdisjoint(each.sources)]
        why = f"it stands for {' and '.join(self._wanted.values())}"
        ends = [each for each in own if not each.targets] if INIT in edges else []
        if OFF in edges or ends:
            off = self._added.step("Off", "no step is active in S7-GRAPH")
            for end in ends:
                self._lead(end, off)
            for step in steps if OFF in edges else ():
                self._added.transition(step, off, edges[OFF], why, first=True)
            steps.append(off)
            if INIT not in edges:  # charts of CODESYS end with a jump
                self._added.transition(off, off, "FALSE", why, first=True)
        if INIT in edges:
            stops = [f"NOT {as_term(edges[OFF])}"] if OFF in edges else []
            for step in steps:
                if step is not initial:
                    self._added.transition(step, initial, conjunction(edges[INIT], *stops), why, first=True)
            for each in own:
                if initial.id in each.sources:
                    self._hold(each, edges[INIT])

    def _lead(self, end: Transition, off: Step) -> None:
        why = f"it leads to the step {off.name}, which does nothing"
        self._rewriting.note(Outcome.TRANSLATED, "transition", f"transition {self._chart.label(end)}", why)
        end.targets = [off.id]
        (source,) = (step for step in self._chart.steps if step.id in end.sources)
        place = f"transition {source.name} -> {off.name}"
        self._rewriting.note(Outcome.TRANSLATED, "transition", place, "it ends the sequence")

    def _hold(self, transition: Transition, edge: str) -> None:
        """Let a transition that leaves the initial step not count while the sequence begins again."""
        source, marks = self._rewriting.source_transitions[transition.id], self._rewriting.marks
        known = marks.get(id(transition), {}).get(REWRITTEN_FIELD, {})
        text = self._rewriting.text(transition.condition) or "TRUE"
        transition.condition = Expression(text=conjunction(text, f"NOT {as_term(edge)}"))
        uses = [*known.get("uses", ()), *self._checks.names_of_edges()]
        marks[id(transition)] = rewritten_transition(transition, source, uses, known.get("held", ()))
        why = f"not while {self._wanted[INIT]} begins the sequence again"
        self._rewriting.note(Outcome.TRANSLATED, "condition", f"transition {self._chart.label(transition)}", why)
