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
from plcopen_sfc.conversion.executed_parts import OPERATING_INPUT
from plcopen_sfc.formats.plcopen.source_marks import OF_ENDS, added_element
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.s7_programs import unused_inputs
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.sfc import Step, Transition, connected_parts
from plcopen_sfc.model.types import Elementary, ElementaryType
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import Outcome

OFF, INIT = "OFF_SQ", "INIT_SQ"
_HIGHEST_PRIORITY = 0
"""The priority of what is tried before all other transitions: S7-GRAPH counts from 1."""


def operated_inputs(rewriting: ChartRewriting, names: Collection[str]) -> dict[str, str]:
    """Return those of the inputs `names`, in upper case, that somebody may operate, as the block declares them."""
    pou = rewriting.chart.pou
    found = {v.name.upper(): v.name for v in pou.variables(SectionKind.INPUT) if v.name.upper() in names}
    if not found or not rewriting.of_graph:
        return {}
    unused: Collection[str] = ()
    if pou.project is not None:
        unused = unused_inputs(Names(pou.project), pou, found.values())
    at_rest = rewriting.options.at_rest
    return {key: name for key, name in found.items() if key not in at_rest and name not in unused}


_MANUAL, _INCHING, _PUSHED = "SW_MAN", "SW_TAP", "SW_TOP"
_MODES = ("SW_AUTO", _MANUAL, _INCHING, _PUSHED)
"""The inputs that switch modes; of several that rise the last counts."""
_LAMPS = {"MAN_ON": _MANUAL, "TAP_ON": _INCHING, "TOP_ON": _PUSHED}
_GOES_ON = ("sequence", "goes_on")
"""The variable that is TRUE while the modes let transitions fire."""
_PUSH, _ON, _OFF, _SELECTED, _NEXT, _PREVIOUS = "T_PUSH", "S_ON", "S_OFF", "S_SEL", "S_NEXT", "S_PREV"


class OperatingModes:
    """The operating modes of a block: each one is a variable, which conditions and outputs read.

    Transitions fire as in the automatic mode; with T_PUSH only (SW_TAP), or also (SW_TOP); never in the manual mode, in
    which S_ON and S_OFF switch the step with the number S_SEL.
    """

    def __init__(self, rewriting: ChartRewriting, checks: StepChecks) -> None:
        self._rewriting, self._checks = rewriting, checks
        settings = rewriting.source.graph_settings
        self._locked = settings is not None and bool(settings.lock_operating_mode)
        commands = (_PUSH, _ON, _OFF, _SELECTED, _NEXT, _PREVIOUS)
        self._found = operated_inputs(rewriting, (*_MODES, *commands))
        self._switches = [] if self._locked else [name for name in _MODES if name in self._found]
        self._modes = [name for name in self._switches if name != _MODES[0]]
        declared = {v.name.upper(): v.name for v in rewriting.chart.pou.variables(SectionKind.INPUT)}
        self.selected = declared.get(_SELECTED) if _MANUAL in self._modes else None
        """The input with the number of the selected step, where the manual mode can be switched on."""
        manual = self.selected is not None
        self.switches_of_steps = [self._found[key] for key in (_ON, _OFF) if manual and key in self._found]
        """The inputs with which people can switch steps."""
        self.manual = self._found.get(_MANUAL, _MANUAL)
        """The input that switches to the mode in which they can."""
        self.changes_conditions = bool(self._modes)
        """True if transitions fire otherwise in some mode."""
        if self._modes:
            self._checks.modes = self.statements

    def statements(self) -> list[str]:
        """Return the change of the modes, behind the edges of the inputs."""
        found = [f"{self._variable(mode)} := {self._on(mode, edges=True)};" for mode in self._modes]
        if self._rewriting.host.is_codesys and (goes_on := self._goes_on()) != "TRUE":
            found.append(f"{self._checks.variable(*_GOES_ON)} := {goes_on};")
        shown = self.selected_shown
        return found if shown == self.selected else [*found, f"{shown} := {self.selected};"]

    @property
    def selected_shown(self) -> str | None:
        """The number of the step selected, in the scan that the outputs show."""
        if self.selected is None or not self._rewriting.host.is_codesys:
            return self.selected
        return self._checks.variable(_SELECTED, "before", ElementaryType(name=Elementary.INT))

    def _variable(self, mode: str) -> str:
        return self._checks.variable(mode, "is_on")

    def _on(self, mode: str, *, edges: bool = False) -> str:
        """Return whether a mode is on behind the edges of this scan."""
        if self._rewriting.host.is_codesys and not edges:
            return self._variable(mode)
        rises = {
            name: self._checks.edge(name) if edges else f"({self._checks.rising(name)})" for name in self._switches
        }
        place = self._switches.index(mode)
        before, later = (
            [rises[name] for name in names] for names in (self._switches[:place], self._switches[place + 1 :])
        )
        kept = " AND ".join([self._variable(mode), *(f"NOT {each}" for each in before)])
        found = f"{as_term(rises[mode])} OR {as_term(kept)}"
        return " AND ".join([f"({found})", *(f"NOT {each}" for each in later)]) if later else found

    def _rises(self, name: str) -> str:
        return as_term(self._checks.rising(name)) if name in self._found else "FALSE"

    def switching(self, text: str) -> str:
        """Return when a transition with the condition `text` fires, whatever holds its steps."""
        push = self._rises(_PUSH)
        if _PUSHED in self._modes and push != "FALSE" and text != "TRUE":
            text = f"{as_term(text)} OR ({as_term(self._on(_PUSHED))} AND {push})"
        goes_on = self._goes_on()
        if goes_on != "TRUE":
            # where actions come before transitions, one of them computes it for all conditions
            own = self._checks.variable(*_GOES_ON) if self._rewriting.host.is_codesys else as_term(goes_on)
            text = conjunction(text, own)
        return text

    def _goes_on(self) -> str:
        """Return when the modes let transitions fire."""
        terms: list[str] = []
        if _INCHING in self._modes:
            push = self._rises(_PUSH)
            others = f" OR {push}" if push != "FALSE" else ""
            terms.append(f"(NOT {as_term(self._on(_INCHING))}{others})")
        if _MANUAL in self._modes:
            terms.append(f"NOT {as_term(self._on(_MANUAL))}")
        return " AND ".join(terms) or "TRUE"

    def switched(self, step: Step) -> tuple[str, str]:
        """Return when people switch a step on, and when off."""
        if not self.switches_of_steps or not step.number:
            return "FALSE", "FALSE"
        chosen = f"{as_term(self._on(_MANUAL))} AND {self.selected} = {step.number}"
        on, off = self._rises(_ON), self._rises(_OFF)
        begins = f"{chosen} AND {on}" if on != "FALSE" else "FALSE"
        return begins, f"{chosen} AND {off}" if off != "FALSE" else "FALSE"

    def lamps(self) -> dict[str, str]:
        """Return the values of the outputs that show the mode."""
        known = {lamp: self._variable(mode) if mode in self._modes else "FALSE" for lamp, mode in _LAMPS.items()}
        others = [each for each in known.values() if each != "FALSE"]
        return {"AUTO_ON": f"NOT ({' OR '.join(others)})" if others else "TRUE", **known}

    def shows_selected(self) -> str | None:
        """Return when the step displayed is the selected one; None: never."""
        return f"{self._variable(_MANUAL)} AND {self.selected_shown} <> 0" if self.selected is not None else None

    def turns(self) -> dict[str, str]:
        """Return the edges that display the next or the previous active step, in the order in which they count."""
        return {name: self._checks.edge(name) for name in (_NEXT, _PREVIOUS) if name in self._found}

    def report(self) -> None:
        """Report the replacement of the inputs."""
        for name in self._found.values():
            why = "the modes are variables, which the conditions read"
            if self._locked:
                why = "the operating mode is locked in the block"
            elif not self._modes:
                why = "nothing switches to a mode in which it does something"
            self._rewriting.note(Outcome.TRANSLATED, OPERATING_INPUT, name, why)


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
        """Add a step that is called `wish`, or like that."""
        step = self._chart.add_step(self._rewriting.new_name(wish))
        step.id = next(self._ids.get(SymbolKind.STEP, iter(())), self._unlike_source(step.id))
        self._added.append(step)
        self._rewriting.note(Outcome.TRANSLATED, "step", f"step {step.name}", why)
        return step

    def transition(
        self,
        sources: Step | Iterable[Step],
        targets: Step | Iterable[Step],
        condition: str,
        why: str,
        *,
        first: bool = False,
    ) -> Transition:
        """Add a transition; `first`: it is tried before all others."""
        priority = _HIGHEST_PRIORITY if first else None
        added = self._chart.add_transition(sources, targets, Expression(text=condition), priority=priority)
        added.id = next(self._ids.get(SymbolKind.TRANSITION, iter(())), self._unlike_source(added.id))
        self._added.append(added)
        self._rewriting.note(Outcome.TRANSLATED, "transition", f"transition {self._chart.label(added)}", why)
        return added

    def _unlike_source(self, number: int) -> int:
        """Return an id that nothing in the source has: what loops replace comes back with its own."""
        return max(number, self._rewriting.source.new_id())

    def mark(self, together: Iterable[str] = (), instead_of: dict[str, object] | None = None, *, of: str = "") -> None:
        """Mark all that was added; `together`: names by which edits of one count for all.

        `of`: the thing that it replaces, as in `added_element`.
        """
        uses = [*self._checks.names_of_edges(), *together]
        for added in self._added:
            self._rewriting.marks[id(added)] = added_element(added, uses, instead_of, of=of)
            instead_of = None
        self._added = []


class OperatingInputs:
    """Adds the transitions to sequences of which one step is active at a time; the others are rewritten already."""

    def __init__(self, rewriting: ChartRewriting, checks: StepChecks, added: AddedElements) -> None:
        self._rewriting, self._checks, self._added = rewriting, checks, added
        self._chart = rewriting.chart.chart
        self._wanted = operated_inputs(rewriting, (OFF, INIT))

    def execute(self, sequences: Iterable[Sequence[Step]], initial: Collection[int]) -> None:
        """Change these sequences, each with one of the `initial` steps, and report the replacement of the inputs."""
        edges = {key: self._checks.rising(key) for key in self._wanted}
        for steps in sequences if edges else ():
            self._sequence(steps, next(step for step in steps if step.id in initial), edges)
        self._added.mark()
        if self._rewriting.host.is_codesys and not self._rewriting.options.of_codesys:
            self._ends()
        for name in self._wanted.values():
            why = "transitions that are tried before all others"
            self._rewriting.note(Outcome.TRANSLATED, OPERATING_INPUT, name, why)

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
                if any(step.id in each.sources and each.targets == [initial.id] for each in own):
                    what = "the transition of INIT_SQ to the initial step is another one"
                    self._rewriting.note(Outcome.TRANSLATED, "order of transitions", f"step {step.name}", what)
                if step is not initial:
                    self._added.transition(step, initial, conjunction(edges[INIT], *stops), why, first=True)
            for each in own:
                if initial.id in each.sources:
                    self._hold(each, edges[INIT])

    def _ends(self) -> None:
        """Let what ends a sequence lead to a step that does nothing: charts of CODESYS have no end."""
        for steps in connected_parts(self._rewriting.source.steps, self._rewriting.source.transitions):
            ids = {step.id for step in steps}
            own = [each for each in self._chart.transitions if not ids.isdisjoint(each.sources)]
            ends = [each for each in own if not each.targets]
            if not ends:
                continue
            last = self._added.step("End", "no step is active in the source")
            for end in ends:
                self._lead(end, last)
                for source in (step for step in steps if step.id in end.sources):
                    if sum(source.id in each.sources for each in own) > 1:
                        why = f"one of them leads to the step {last.name}"
                        self._rewriting.note(Outcome.TRANSLATED, "order of transitions", f"step {source.name}", why)
            self._added.transition(last, last, "FALSE", "nothing leads on from this step")
        self._added.mark(of=OF_ENDS)

    def _lead(self, end: Transition, off: Step) -> None:
        why = f"it leads to the step {off.name}, which does nothing"
        self._rewriting.note(Outcome.TRANSLATED, "transition", f"transition {self._chart.label(end)}", why)
        end.targets = [off.id]
        names = ", ".join(step.name for step in self._chart.steps if step.id in end.sources)
        place = f"transition {names} -> {off.name}"
        self._rewriting.note(Outcome.TRANSLATED, "transition", place, "it ends the sequence")

    def _hold(self, transition: Transition, edge: str) -> None:
        """Let a transition that leaves the initial step not count while the sequence begins again."""
        text = conjunction(self._rewriting.text(transition.condition) or "TRUE", f"NOT {as_term(edge)}")
        self._rewriting.change_condition(transition, text, self._checks.names_of_edges())
        why = f"not while {self._wanted[INIT]} begins the sequence again"
        self._rewriting.note(Outcome.TRANSLATED, "condition", f"transition {self._chart.label(transition)}", why)
