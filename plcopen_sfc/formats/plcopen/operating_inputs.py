"""INIT_SQ and OFF_SQ of S7-GRAPH as transitions: from every step to the initial step, and to one that does nothing.

A rising edge of OFF_SQ deactivates all steps, one of INIT_SQ activates the initial step instead of all others, and no
transition counts in that cycle (`plcopen_sfc.semantics.charts.graph`, and the tests compare both). A chart of which one
step is active at a time does that with transitions that are tried before all others. Where several may be active,
nothing of the kind is right in tools with nested branches, and the inputs are left to the report.
"""

from __future__ import annotations

from collections.abc import Collection

from plcopen_sfc.formats.plcopen.chart_hosts import ChartRewriting, as_term, conjunction
from plcopen_sfc.formats.plcopen.source_marks import REWRITTEN_FIELD, added_element, rewritten_transition
from plcopen_sfc.formats.plcopen.step_checks import StepChecks
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.s7_programs import unused_inputs
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.sfc import Step, Transition
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import Outcome

_OFF, _INIT = "OFF_SQ", "INIT_SQ"
_FIRST = 0
"""The priority of what is tried before all other transitions: S7-GRAPH counts from 1."""


class OperatingInputs:
    """Adds the transitions to a chart whose own transitions are rewritten already."""

    def __init__(self, rewriting: ChartRewriting, checks: StepChecks) -> None:
        self._rewriting, self._checks = rewriting, checks
        self._chart = rewriting.chart.chart
        self._wanted = self._inputs()
        known = {step.id for step in self._chart.steps} | {each.id for each in self._chart.transitions}
        drawn = self._chart.drawing.symbols if self._chart.drawing is not None else []
        # a file that is edited has symbols of what was added when it was written, and keeps their ids
        free = sorted((symbol.id, symbol.kind) for symbol in drawn if symbol.id not in known)
        self._ids = {kind: iter([number for number, each in free if each is kind]) for _, kind in free}

    def _inputs(self) -> dict[str, str]:
        """Return the inputs that are executed, as they are declared."""
        pou, chart = self._rewriting.chart.pou, self._chart
        found = {v.name.upper(): v.name for v in pou.variables(SectionKind.INPUT) if v.name.upper() in (_OFF, _INIT)}
        one_at_a_time = all(len(each.sources) == 1 and len(each.targets) < 2 for each in chart.transitions)
        if (
            not found
            or chart.graph_settings is None
            or not one_at_a_time
            or sum(step.initial for step in chart.steps) != 1
        ):
            return {}
        unused: Collection[str] = ()
        if pou.project is not None:
            unused = unused_inputs(Names(pou.project), pou, found.values())
        at_rest = self._rewriting.options.at_rest
        return {key: name for key, name in found.items() if key not in at_rest and name not in unused}

    def execute(self) -> None:
        """Change the chart, and report what stands for the inputs."""
        chart, edges = self._chart, {key: self._checks.rising(key) for key in self._wanted}
        initial = next((step for step in chart.steps if step.initial), None)
        own = list(chart.transitions)
        texts = {
            each.id: self._rewriting.text(each.condition) for each in own if initial and initial.id in each.sources
        }
        if not edges or initial is None or None in texts.values():
            return
        ends = [each for each in own if not each.targets] if _INIT in edges else []
        steps = list(chart.steps)
        if _OFF in edges or ends:
            off = chart.add_step(self._rewriting.new_name("Off"))
            self._mark(off, SymbolKind.STEP)
            self._rewriting.note(Outcome.TRANSLATED, "step", f"step {off.name}", "no step is active in S7-GRAPH")
            for end in ends:
                self._lead(end, off)
            for step in steps if _OFF in edges else ():
                self._add(step, off, edges[_OFF])
            steps.append(off)
            if _INIT not in edges:  # charts of CODESYS end with a jump
                self._add(off, off, "FALSE")
        if _INIT in edges:
            stops = [f"NOT {as_term(edges[_OFF])}"] if _OFF in edges else []
            for step in steps:
                if step is not initial:
                    self._add(step, initial, conjunction(edges[_INIT], *stops))
            for each in own:
                if each.id in texts:
                    self._hold(each, texts[each.id] or "TRUE", edges[_INIT])
        for name in self._wanted.values():
            why = "transitions that are tried before all others"
            self._rewriting.note(Outcome.TRANSLATED, "operating input", name, why)

    def _add(self, source: Step, target: Step, condition: str) -> None:
        added = self._chart.add_transition(source, target, Expression(text=condition), priority=_FIRST)
        self._mark(added, SymbolKind.TRANSITION)
        self._note(added, f"it stands for {' and '.join(self._wanted.values())}")

    def _mark(self, added: Step | Transition, kind: SymbolKind) -> None:
        added.id = next(self._ids.get(kind, iter(())), added.id)
        self._rewriting.marks[id(added)] = added_element(added, self._checks.names_of_edges())

    def _note(self, transition: Transition, why: str) -> None:
        place = f"transition {self._chart.label(transition)}"
        self._rewriting.note(Outcome.TRANSLATED, "transition", place, why)

    def _lead(self, end: Transition, off: Step) -> None:
        self._note(end, f"it leads to the step {off.name}, which does nothing")
        end.targets = [off.id]
        (source,) = (step for step in self._chart.steps if step.id in end.sources)
        place = f"transition {source.name} -> {off.name}"
        self._rewriting.note(Outcome.TRANSLATED, "transition", place, "it ends the sequence")

    def _hold(self, transition: Transition, text: str, edge: str) -> None:
        """Let a transition that leaves the initial step not count while the sequence begins again."""
        source, marks = self._rewriting.source_transitions[transition.id], self._rewriting.marks
        known = marks.get(id(transition), {}).get(REWRITTEN_FIELD, {})
        transition.condition = Expression(text=conjunction(text, f"NOT {as_term(edge)}"))
        uses = [*known.get("uses", ()), *self._checks.names_of_edges()]
        marks[id(transition)] = rewritten_transition(transition, source, uses, known.get("held", ()))
        why = f"not while {self._wanted[_INIT]} begins the sequence again"
        self._rewriting.note(Outcome.TRANSLATED, "condition", f"transition {self._chart.label(transition)}", why)
