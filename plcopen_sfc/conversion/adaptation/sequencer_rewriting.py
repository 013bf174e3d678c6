"""Behaviour of a block of S7-GRAPH beside its steps, in terms of the charts of other tools.

Permanent instructions become actions that are executed in every scan. Charts of other tools have no statements around
them. An action that the initial step stores (qualifier S) is executed in every scan, also when no step is active any
more. What matters is its place among transitions and actions: S7-GRAPH executes the instructions before, then
transitions and actions, then the instructions after the sequences.

Outputs that show the state of the sequencer become statements of such actions.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from plcopen_sfc.conversion.adaptation.chart_rewriting import ChartRewriting, as_term, conjunction, first_of
from plcopen_sfc.conversion.adaptation.operating_inputs import OperatingModes
from plcopen_sfc.conversion.adaptation.step_checks import StepChecks
from plcopen_sfc.conversion.adaptation.step_rewriting import StepRewriter
from plcopen_sfc.languages.effects import ANYTHING, Effects, Path, effects, may_change
from plcopen_sfc.languages.networks import body_statements
from plcopen_sfc.languages.st import parse_expression, parse_statements, print_node
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.body import FbdBody, LdBody, StBody, has_program
from plcopen_sfc.model.sfc import Body, PermanentOperation, Step
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import Outcome


class ShownState:
    """Statements for the outputs that a block has; they read the step flags behind the step change."""

    def __init__(self, rewriting: ChartRewriting, checks: StepChecks, modes: OperatingModes) -> None:
        self._rewriting, self._host, self._checks, self._modes = rewriting, rewriting.host, checks, modes
        source = rewriting.source
        self._steps = sorted(rewriting.chart.chart.steps, key=lambda step: step.number or 0)
        self._is_one = (
            sum(step.initial for step in source.steps) == 1
            and all(len(transition.targets) < 2 for transition in source.transitions)
            and not any(row.qualifier is Qualifier.ON for _, row in source.associations())
            and not modes.switches_of_steps
        )
        rows = {(row.target or "").strip('"').casefold() for _, row in source.associations()}
        outputs = rewriting.chart.pou.variables(SectionKind.OUTPUT)
        self._names = {v.name.upper(): v.name for v in outputs if v.name.casefold() not in rows}
        self.early: list[str] = []
        """The statements for before the edges of inputs: transitions of CODESYS see these a scan before the steps."""
        self.lines: list[str] = []
        """The statements for behind all others."""
        if rewriting.of_graph:
            is_early = self._host.is_codesys and modes.changes_conditions
            (self.early if is_early else self.lines).extend(self._situation())
            self.lines += self._errors()

    @property
    def names(self) -> set[str]:
        """The outputs that the statements write."""
        return {line.split(" := ")[0].strip() for line in (*self.early, *self.lines) if " := " in line}

    def _situation(self) -> Iterator[str]:
        flags: list[str] = [self._host.active(step) for step in self._steps]
        if "S_NO" in self._names and flags:
            yield from self._number(self._names["S_NO"])
        if "S_ACTIVE" in self._names and flags:
            shows = self._modes.shows_selected() is not None and "S_NO" in self._names
            shown = self._kept(self._names["S_NO"]) if shows else flags
            yield f"{self._names['S_ACTIVE']} := {' OR '.join(shown)};"
        if "S_MORE" in self._names and flags:
            count = " + ".join(f"BOOL_TO_INT({flag})" for flag in flags)
            yield f"{self._names['S_MORE']} := {'FALSE' if self._is_one else f'{count} > 1'};"
        for name, value in self._modes.lamps().items():
            if name in self._names:
                yield f"{self._names[name]} := {value};"

    def _errors(self) -> Iterator[str]:
        if "ERR_FLT" in self._names:
            found = [self._disturbed(step) for step in self._steps]
            errors = [text for text in found if text]
            if None not in found:
                yield f"{self._names['ERR_FLT']} := {' OR '.join(errors) or 'FALSE'};"

    def _kept(self, shown: str) -> list[str]:
        """Return conditions of which one is TRUE while the step displayed is active."""
        return [f"({self._host.active(step)} AND {shown} = {step.number or 0})" for step in self._steps]

    def _number(self, shown: str) -> list[str]:
        """Return the number of the step displayed: that of before while it is active, else the first active one."""
        selected = self._modes.shows_selected()
        cases = [(selected, [f"{shown} := {self._modes.selected_shown};"])] if selected is not None else []
        first = first_of([*self._active(shown, self._steps), ("", [f"{shown} := 0;"])])
        if self._is_one:
            cases.append(("", first))
        else:
            cases.append((f"NOT ({' OR '.join(self._kept(shown))})", first))
            for name, edge in self._modes.turns().items():
                steps, sign = (self._steps, ">") if name == "S_NEXT" else (self._steps[::-1], "<")
                # the step displayed is one of them here, and none is beyond the last one
                beyond = [step for step in steps if (step.number or 0) != (steps[0].number or 0)]
                onward = self._active(shown, beyond, f" AND {{number}} {sign} {shown}")
                cases.append((edge, first_of([*onward, ("", first_of(self._active(shown, steps)))])))
        return first if cases == [("", first)] else first_of(cases)

    def _active(self, shown: str, steps: Iterable[Step], needs: str = "") -> list[tuple[str, list[str]]]:
        """Return when each step is active, and the statement that shows it then."""
        numbered = [(self._host.active(step), step.number or 0) for step in steps]
        return [(flag + needs.format(number=number), [f"{shown} := {number};"]) for flag, number in numbered]

    def _disturbed(self, step: Step) -> str | None:
        """Return when an active step has an error: empty where it never has, None where that is no expression."""
        interlock, fault = self._rewriting.interlock(step), self._checks.disturbed(step)
        if interlock is None or fault is None:
            return None
        parts = [f"NOT {as_term(interlock)}"] * (interlock != "TRUE") + [fault] * (fault != "FALSE")
        return f"({self._host.active(step)} AND {as_term(' OR '.join(parts))})" if parts else ""


_UNKNOWN = Effects(frozenset({ANYTHING}), frozenset({ANYTHING}))
_NAMES = {
    "shown": ("state_of_sequence", "X_state_of_sequence", "ZY_state_of_sequence"),
    "timers": ("timers_of_steps", "X_timers_of_steps", "ZX_timers_of_steps"),
    "pulses": ("pulses", "A_pulses", "A0_pulses"),
    "edges": ("edges_of_inputs", "A_edges_of_inputs", "A0_edges_of_inputs"),
    "switches": ("switched_steps", "Z_switched_steps", "ZZZ_switched_steps"),
    "before": ("before_sequence", "A_before_sequence", "A0_before_sequence"),
    "after": ("sequence_after", "Z_after_sequence", "ZZZ_after_sequence"),
    "boxes": ("timers_and_edges", "Z_timers_and_edges", "ZZZZ_timers_and_edges"),
    "firings": ("transitions_that_fire", "Z_transitions_that_fire", "ZZZZZ_transitions_that_fire"),
}
"""Names of the actions: CODESYS executes actions in the order of their names."""

_EARLY = frozenset({"edges", "before", "pulses"})
"""Statements that are executed before the actions of the steps."""


class PermanentRewriter:
    """Rewrites the permanent instructions of a chart whose steps and transitions are rewritten already."""

    def __init__(self, rewriting: ChartRewriting, steps: StepRewriter, checks: StepChecks, shown: ShownState) -> None:
        self._rewriting, self._steps, self._checks, self._shown = rewriting, steps, checks, shown
        self._chart, self._pou, self._host = rewriting.chart.chart, rewriting.chart.pou, rewriting.host
        self._standard = frozenset(
            (variable.name.casefold(),)
            for variable in self._pou.variables()
            if isinstance(variable.type, DerivedType) and standard_block(variable.type.name) is not None
        )

    @property
    def _first(self) -> Step | None:
        """The step that is active from the start: of the source, or the one that several of them begin with."""
        own = next((step for step in self._chart.steps if step.initial), None)
        initial = next((step for step in self._rewriting.source.steps if step.initial), None)
        return own or next((step for step in self._chart.steps if initial is not None and step.id == initial.id), None)

    def rewrite(self) -> None:
        """Change the chart; what is not executed, or at another time, is in the report."""
        chart = self._chart
        initial = self._first
        if self._shown.lines and initial is not None:
            body = StBody(text="\n".join(self._shown.lines))
            self._steps.store(initial, self.name("shown"), body, first=False, instead_of=None)
        timers = self._steps.timers
        if timers.outputs and initial is not None:
            body = StBody(text="\n".join(timers.in_every_scan()))
            self._report_early(timers.outputs)
            self._steps.store(initial, self.name("timers"), body, first=False, instead_of=None)
        for when, operations in (("after", chart.permanent_post), ("before", chart.permanent_pre)):
            found = [operation for operation in operations if has_program(operation.body)]
            if found:
                self._operations(when, found)
        if self._steps.pulses and initial is not None:
            told = self._steps.pulses.items()
            text = "\n".join(f"{name} := {pulse};\n{pulse} := FALSE;" for name, pulse in told)
            self._steps.store(initial, self.name("pulses"), StBody(text=text), first=False, instead_of=None)
        edges, switches = [*self._shown.early, *self._checks.edges()], list(self._checks.switches())
        if switches and self._host.is_codesys and initial is not None:
            body = StBody(text="\n".join(switches))
            self._steps.store(initial, self.name("switches"), body, first=False, instead_of=None)
        elif switches:
            edges = [*switches, *edges]
        if edges:
            self._edges(StBody(text="\n".join(edges)))

    def add_firings(self) -> None:
        """Add the action that computes which transitions of loops fire: the last one before the transitions."""
        computed, initial = self._checks.firings, self._first
        if computed and initial is not None:
            body = StBody(text="\n".join(f"{name} := {text};" for name, text in computed.items()))
            self._steps.store(initial, self.name("firings"), body, first=False, instead_of=None, uses=computed)

    def hold(self) -> None:
        """Let no transition fire in the first scan, as in S7-GRAPH, if actions are stored.

        A step that is left before the actions of the first scan stores none. In CODESYS, actions come first.
        """
        initial = self._first
        if self._host.is_codesys or not self._rewriting.of_graph or not self._steps.has_stored or initial is None:
            return
        started = self._rewriting.new_variable("sequence_started")
        self._steps.set(initial, started)
        first = {step.id for step in self._chart.steps if step.initial}
        for transition in (each for each in self._chart.transitions if not first.isdisjoint(each.sources)):
            place = f"transition {self._chart.label(transition)}"
            text = self._rewriting.text(transition.condition)
            if text is None:
                why = "it may fire in the first scan, in which S7-GRAPH tests no transition"
                self._rewriting.note(Outcome.APPROXIMATED, "condition", place, why)
                continue
            self._rewriting.change_condition(transition, conjunction(text, started), [started])
            self._rewriting.note(Outcome.TRANSLATED, "condition", place, "not in the first scan, as in S7-GRAPH")

    def _report_early(self, outputs: list[str]) -> None:
        """Report actions that read the output of a timer of S5: S7-GRAPH writes it after all actions."""
        acting = Effects.all(self._effects_of(row.body) for _, row in self._chart.associations())
        for name in () if self._host.is_codesys else outputs:
            if may_change(acting.reads, self._effects(StBody(text=f"{name} := TRUE;")).writes, frozenset()):
                why = f"actions that read {name} may see what it is after the scan; in S7-GRAPH what it was before"
                self._rewriting.note(Outcome.APPROXIMATED, "timers of steps", "", why)

    def _edges(self, body: StBody) -> None:
        """Let the edges of inputs be computed before the actions of the steps, which read them."""
        initial = self._first
        if initial is None:
            return  # nothing is ever executed
        own = self._effects(body)
        name = self._steps.store(initial, self.name("edges"), body, first=True, instead_of=None)
        late = [
            row.target for _, row in self._chart.associations() if row.target is not None and _sorts(row.target, name)
        ]
        if (
            any(self._interfere(own, [self._effects_of(each)]) for each in late)
            if self._host.is_codesys
            else (self._interfere(own, self._rows(initial, before=True)))
        ):
            why = "edges of inputs may be computed after the actions that read them, a scan too late"
            self._rewriting.note(Outcome.APPROXIMATED, "operating inputs", "", why)

    def _operations(self, when: str, operations: list[PermanentOperation]) -> None:
        what = f"permanent instruction {when} the sequence"
        texts = [self._text(operation.body) for operation in operations]
        initial = self._first
        if initial is None or any(text is None for text in texts):
            why = "there is no initial step" if initial is None else "it cannot be written as statements"
            self._rewriting.note(Outcome.NOT_EXECUTED, what, "", f"not executed in {self._host.title}: {why}")
            return
        body = StBody(text="\n".join(text for text in texts if text))
        own = self._effects(body)
        difference = self._before(own, initial) if when == "before" else self._after(own, initial)
        name = self._steps.store(initial, self.name(when), body, first=when == "before", instead_of=_FIELDS[when])
        if difference:
            self._rewriting.note(Outcome.APPROXIMATED, what, "", difference)
        else:
            why = f"the action {name} of the step {initial.name}, which is executed in every scan"
            self._rewriting.note(Outcome.TRANSLATED, what, "", why)

    def _text(self, body: Body | None) -> str | None:
        """Return a body as statements; None where it needs variables that nothing declares."""
        if isinstance(body, StBody):
            return body.text.strip()
        if not isinstance(body, FbdBody | LdBody):
            return None
        found = body_statements(body, self._host.dialect, taken=self._rewriting.taken)
        return print_node(found.tree) if found.complete and not found.helpers else None

    # -- the order of execution

    def _before(self, own: Effects, initial: Step) -> str | None:
        """Return the difference if instructions are executed before all actions, but after the transitions."""
        title = self._host.title
        data = {step.name.casefold() for step in self._chart.steps}
        data |= {transition.name.casefold() for transition in self._chart.transitions if transition.name}
        if any(not path or path[0] in data for path in own.reads):
            return f"in {title} it reads the data of the steps that follow; in S7-GRAPH those of the cycle before"
        if may_change(self._conditions(), own.writes, frozenset()):
            if self._host.is_codesys:
                return "the conditions read its results in the same scan, but the steps that follow act a scan later"
            return f"the conditions read its results in the next scan: {title} executes it after the transitions"
        of_steps = (self._effects_of(each) for step in self._chart.steps for each in step.step_actions.values())
        actions = of_steps if self._host.is_codesys else self._rows(initial, before=True)
        if self._interfere(own, actions) or self._interfere(Effects(writes=own.writes), self._operands()):
            return f"{title} may execute other actions of the chart before it, which have variables in common with it"
        return None

    def _after(self, own: Effects, initial: Step) -> str | None:
        """Return the difference if instructions are executed with the actions of the initial step."""
        if not self._host.is_codesys and self._interfere(own, self._rows(initial, before=False)):
            return "IEC 61131-3 does not say which actions are executed first: it may be executed before others"
        return None

    def _interfere(self, own: Effects, bodies: Iterable[Effects]) -> bool:
        other = Effects.all(bodies)
        return may_change(own.reads | own.writes, other.writes, frozenset()) or may_change(
            other.reads, own.writes, frozenset()
        )

    def is_overtaken(self, body: StBody) -> bool:
        """True if an action that the initial step stores may be executed before others that write what it reads."""
        initial = self._first
        return initial is not None and self._interfere(self._effects(body), self._rows(initial, before=False))

    def _conditions(self) -> frozenset[Path]:
        """Return the names that the conditions of the chart read."""
        found: set[Path] = set()
        for transition in self._chart.transitions:
            text = self._rewriting.text(transition.condition)
            tree = parse_expression(text, self._host.dialect).tree if text is not None else None
            found |= effects([tree]).reads if tree is not None else set()
        return frozenset(found)

    def _operands(self) -> Iterator[Effects]:
        """Yield the effects of rows that are a variable, which S7-GRAPH writes as their step ends too."""
        for _, row in self._chart.associations():
            if row.body is None and row.target is not None and self._pou.find_action(row.target) is None:
                yield self._effects_of(row.target)

    def _rows(self, initial: Step, *, before: bool) -> Iterator[Effects]:
        """Yield the effects of the actions of the steps before the initial one, or behind it."""
        at = next(index for index, step in enumerate(self._chart.steps) if step is initial)
        for step in self._chart.steps[:at] if before else self._chart.steps[at + 1 :]:
            for row in step.actions:
                yield self._effects_of(row.body or row.target)

    def _effects_of(self, action: object) -> Effects:
        found = self._pou.find_action(action) if isinstance(action, str) else None
        body = found.body if found is not None else action
        if isinstance(body, StBody):
            return self._effects(body)
        if isinstance(body, str):
            target = parse_expression(body, self._host.dialect).tree
            return Effects(writes=effects([target]).reads) if target is not None else _UNKNOWN
        return _UNKNOWN if body is not None else Effects()

    def _effects(self, body: StBody) -> Effects:
        return effects(parse_statements(body.text, self._host.dialect).tree.statements, self._standard)

    def name(self, when: str) -> str:
        """Return a name by which CODESYS executes an action before, or after, all others of the chart."""
        others = [row.target for _, row in self._chart.associations() if row.target is not None]
        wishes = _NAMES[when]
        fits = (wish for wish in wishes if all(_sorts(wish, name) is (when in _EARLY) for name in others))
        return next(fits, wishes[-1])


def _sorts(name: str, before: str) -> bool:
    """True if CODESYS executes the action `name` before another one."""
    return name.casefold() < before.casefold()


_FIELDS = {"before": "permanent_pre", "after": "permanent_post"}
