"""Rows and step actions that a tool has no element for, as statements that do the same.

Action associations of IEC 61131-3 know no interlock, no event and no value. Where structured text does the same, it
takes their place: an action with qualifier N that acts while its step is active, one that is executed once when it
becomes active, and one when it was left. What cannot be written so is left out and reported as not executed, never
written without its condition.

The rules are those of `plcopen_sfc.semantics.charts.graph`, and the tests compare both scan by scan.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from plcopen_sfc.conversion.adaptation.chart_rewriting import ChartRewriting, as_term, guarded
from plcopen_sfc.conversion.adaptation.row_orders import RowOrders
from plcopen_sfc.conversion.adaptation.s5_operands import TimerRows, counted
from plcopen_sfc.conversion.adaptation.special_rows import (
    COILS,
    KINDS_OF_SFC,
    is_coil,
    is_special,
    mixed_operands,
    overwritten_rows,
    row_key,
    shared_step_actions,
    stays_in_place,
    timed_operands,
)
from plcopen_sfc.conversion.adaptation.step_checks import COMPUTED, StepChecks
from plcopen_sfc.formats.plcopen.source_marks import STEP_FIELDS, added_part, changed_element, rewritten_step
from plcopen_sfc.languages.binding import STORING, Row, SharedScans, told_orders
from plcopen_sfc.languages.binding.shared_scans import step_action_rows
from plcopen_sfc.languages.networks import shown_body
from plcopen_sfc.model.actions import (
    COUNTERS,
    NEED_EVENT,
    NEED_TIME,
    STEP_ACTIONS,
    SWITCHES,
    TIMERS,
    ActionEvent,
    Qualifier,
)
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.network import Node
from plcopen_sfc.model.pou import Action
from plcopen_sfc.model.sfc import ActionAssociation, Body, SfcBody, Step
from plcopen_sfc.report import ORDER_OF_ACTIONS, Cause, CauseKind, Outcome

_STORING = {Qualifier.S: "TRUE", Qualifier.R: "FALSE"}
_PULSES = {ActionEvent.S1: Qualifier.P1, ActionEvent.S0: Qualifier.P0}
_MEANT = {
    Qualifier.P1: "the statements of the step that are executed once when it becomes active",
    Qualifier.N: "the statements of the step that are executed while it is active",
    Qualifier.P: "the statements of the step that are executed at its start, after other rows have written",
    Qualifier.P0: "the statements of the step that are executed once when it was left",
}
_ORDER = (Qualifier.P0, Qualifier.P1, Qualifier.N)
"""Exit, entry and main actions as CODESYS executes them in a scan, before the actions of associations."""
_KEPT_ONLY = ("max_time", "warning_time", "interlock", "supervision")
"""Fields of a step that are extension data only: they come back as in the source."""
_NO_TEXT = "its network cannot be written as an expression"


@dataclass(slots=True)
class _Rows:
    """Statements of a step in place of its rows: while it is active, once at its start, once when it was left.

    `first` and `final` are what happens once at the start and when it was left, but after the coils were written.
    """

    kept: list[ActionAssociation] = field(default_factory=list)
    coils: list[str] = field(default_factory=list)
    active: list[str] = field(default_factory=list)
    entry: list[str] = field(default_factory=list)
    exit: list[str] = field(default_factory=list)
    first: list[str] = field(default_factory=list)
    final: list[str] = field(default_factory=list)
    places: list[tuple[ActionAssociation, str]] = field(default_factory=list)
    """Rows in the order in which they were written, each with the name of its list."""


class StepRewriter:
    """Rewrites the steps of a chart."""

    def __init__(self, rewriting: ChartRewriting, checks: StepChecks) -> None:
        self._rewriting, self._checks = rewriting, checks
        self._host = rewriting.host
        self._chart = rewriting.chart.chart
        self._pou = rewriting.chart.pou
        self._rows = [(step, row) for step in self._chart.steps for row in step.actions]
        self._stated = {row_key(row) for _, row in self._rows if self._writes_operand(row)}
        self._mixed = mixed_operands(self._chart) if rewriting.options.of_graph else set()
        if rewriting.options.of_graph:
            self._stated |= self._mixed | timed_operands(self._chart)
        self._orders: RowOrders | None = None
        if rewriting.options.of_graph:
            self._orders = RowOrders(self._chart, self._scans, by_name=self._host.is_codesys)
            self._stated |= self._orders.operands_in_order()
        self._late: set[int] = set()
        self._acting = [*self._rows, *step_action_rows(self._chart)]
        self._shared = shared_step_actions(self._chart)
        self._moved: dict[int, Qualifier] = {}
        self.pulses: dict[str, str] = {}
        """Variables that are TRUE for a scan after a step was left, each with the one that its exit action sets."""
        self.timers = TimerRows(self._chart, checks.variable, at_once=not self._host.is_codesys)
        self.has_stored = False
        """True if a step stores an action that is executed in every scan."""
        self._uses: dict[int, list[str]] = {}
        self._permanent: dict[int, list[str]] = {}
        self._logic: dict[int, Mapping[int, Node] | None] = {}

    def _is_entered(self, step: Step) -> bool:
        """True if an excluded step can become active in a tool that knows no exclusion."""
        entering = (t for t in self._rewriting.source.transitions if step.id in t.targets and not t.exclude)
        return step.initial or next(entering, None) is not None

    def _writes_operand(self, row: ActionAssociation) -> bool:
        """True if a row writes a Boolean operand in a way that associations cannot: other rows with it must follow."""
        return (
            row.target is not None
            and row.qualifier in COILS | _STORING.keys()
            and is_special(row)
            and not self._is_pulse(row)
        )

    def rewrite(self, step: Step) -> None:
        """Change a step; what the tool cannot execute is in the report."""
        source = self._rewriting.source_steps[step.id]
        uses = self._uses[step.id] = []
        if step.exclude and not self._host.excludes and self._is_entered(step):
            step.actions, step.entry_action, step.main_action, step.exit_action = [], None, None, None
            why = "nothing is executed in it and nothing leaves it: CODESYS leaves the step out"
            self._rewriting.note(Outcome.TRANSLATED, "exclude", f"step {step.name}", why)
        rows = _Rows()
        overwritten = overwritten_rows(step) if self._rewriting.options.of_graph else []
        self._late = self._orders.late_starts(step) if self._orders is not None else set()
        for row in step.actions:
            if any(row is each for each in overwritten):
                why = f"`{_called(row)}` is left out: a later row of the step sets {row.target}"
                self._note_action(Outcome.TRANSLATED, step, row.target, why)
                continue
            self._row(step, row, rows)
        step.actions = rows.kept
        is_active = self._host.active(step)
        later = [*guarded(is_active, rows.active), *guarded(f"NOT {is_active}", rows.final)]
        checks = guarded(is_active, self._checks.statements(step))
        if checks:
            checks[-1:] = ["ELSE", *(f"    {line}" for line in self._checks.forgotten(step)), "END_IF;"]
            uses += self._checks.names(step.id)
        # coils before all, as in S7-GRAPH; what happens once at the start is among the rest where it depends on rows
        # above it. Names are in this order too, in which CODESYS executes actions
        units: dict[str, str] = {}
        for kind, qualifier, lines in (
            ("actions", Qualifier.N, [*checks, *rows.coils, *(later if not rows.entry else [])]),
            ("entry", Qualifier.P1, rows.entry),
            ("events", Qualifier.P, guarded(is_active, rows.first)),
            ("further_actions", Qualifier.N, later if rows.entry else []),
            ("exit", Qualifier.P0, rows.exit),
        ):
            if not lines:
                continue
            body = StBody(text="\n".join(lines))
            before = len(self._pou.actions)
            if not self._host.is_codesys:
                self._add_row(step, qualifier, body=body)
            elif kind not in ("entry", "exit") or getattr(step, f"{kind}_action") is not None:
                self._add_row(step, qualifier, target=self._action(f"{step.name}_{kind}", body, uses))
            else:
                setattr(step, f"{kind}_action", self._action(f"{step.name}_{kind}", body, uses))
            added = self._pou.actions[before].name if len(self._pou.actions) > before else None
            self._note_action(Outcome.TRANSLATED, step, added, _MEANT[qualifier])
            units[kind] = (added or "").casefold()
        if self._orders is not None:
            self._place(step, rows, units)
        if self._host.is_codesys:
            self._name_bodies(step, uses)
        else:
            self._own_step_actions(step)
            if step.main_action is not None:
                self._main_action(step)
        for name in _KEPT_ONLY:
            if name != "max_time" or not self._host.is_codesys:  # where it sets SFCError
                setattr(step, name, getattr(source, name))
        self._mark(step)

    def _place(self, step: Step, rows: _Rows, units: Mapping[str, str]) -> None:
        """Note when the target executes the rows of a step; `units` are the added actions in their order."""
        assert self._orders is not None  # noqa: S101  # as in rewrite
        number, order = self._chart.steps.index(step), list(units)
        lasting = "further_actions" if rows.entry else "actions"
        in_unit = {"coils": "actions", "entry": "entry", "first": "events", "exit": "exit"}
        for place, (row, kind) in enumerate(rows.places):
            unit = in_unit.get(kind, lasting)
            if not self._host.is_codesys:
                self._orders.put(row, (number, order.index(unit) if kind != "kept" else -1, place))
            elif unit in ("entry", "exit"):
                self._orders.put(row, (("exit", "entry").index(unit), number, place))
            else:
                self._orders.put(row, (2, row_key(row) if kind == "kept" else units[unit], place))

    def _mark(self, step: Step) -> None:
        source = self._rewriting.source_steps.get(step.id)
        if source is None:
            known = self._rewriting.marks.get(id(step))
            if known is not None:  # else what has added it marks it at last
                self._rewriting.marks[id(step)] = changed_element(step, known, self._uses.get(step.id, ()))
            return
        if any(getattr(step, name) != getattr(source, name) for name in STEP_FIELDS):
            permanent = self._permanent.get(step.id, ())
            logic = self._logic.get(step.id)
            self._rewriting.marks[id(step)] = rewritten_step(step, source, self._uses[step.id], permanent, logic)

    def store(
        self,
        step: Step,
        wish: str,
        body: StBody,
        *,
        first: bool,
        instead_of: str | None,
        uses: Iterable[str] = (),
        logic: Mapping[int, Node] | None = None,
    ) -> str:
        """Let a step, rewritten already, store an action that is executed in every scan from then on; its name.

        `first`: before the other actions of the step. `instead_of`: the field of the chart that it executes. `uses`:
        the added variables in it. `logic`: the elements drawn in the chart that it executes, by their places.
        """
        self.has_stored = True
        self._logic[step.id] = logic
        self._uses.setdefault(step.id, []).extend([*self._checks.names(step.id), *uses])
        self._name_main(step)
        if self._host.is_codesys:
            self._add_row(step, Qualifier.S, target=self._action(wish, body, self._uses[step.id]))
        else:
            self._add_row(step, Qualifier.S, body=body)
        row = step.actions[-1]
        if first:
            step.actions = [row, *step.actions[:-1]]
        if instead_of is not None:
            self._permanent.setdefault(step.id, []).append(instead_of)
        self._mark(step)
        self._note_action(Outcome.TRANSLATED, step, row.target, "executed in every scan")
        return row.target or "in place"

    def add(self, step: Step, row: ActionAssociation) -> None:
        """Add a row like another one to a step that was added to the chart."""
        self._add_row(step, row.qualifier, target=row.target, duration=row.duration)
        if isinstance(row.body, StBody):
            step.actions[-1].body = row.body.model_copy()

    def set(self, step: Step, target: str) -> None:
        """Let a step, rewritten already, set an added variable."""
        self._uses.setdefault(step.id, []).extend([*self._checks.names(step.id), target])
        self._name_main(step)
        self._add_row(step, Qualifier.S, target=target)
        self._mark(step)

    def reset(self, step: Step, targets: Iterable[str]) -> None:
        """Let a step that was added to the chart end what others store in `targets`."""
        for target in targets:
            self._add_row(step, Qualifier.R, target=target)

    def execute(self, step: Step, uses: Iterable[str]) -> None:
        """Mark a step, rewritten already, whose statements depend on the added variables `uses` now."""
        self._uses.setdefault(step.id, []).extend(uses)
        self._mark(step)

    def _note_action(self, outcome: Outcome, step: Step, action: object, why: str, cause: Cause | None = None) -> None:
        name = action if isinstance(action, str) else "in place"
        self._rewriting.note(outcome, "action", f"step {step.name} / action {name}", why, cause)

    def _action(self, wish: str, body: Body, uses: list[str]) -> str:
        """Add an action to the POU; return its name."""
        action = Action(name=self._rewriting.new_name(wish), body=body)
        self._pou.actions.append(action)
        if isinstance(body, StBody | IlBody):
            self._rewriting.marks[id(self._pou.actions[-1])] = added_part(body)
            uses.append(action.name)
        return action.name

    def _add_row(
        self,
        step: Step,
        qualifier: Qualifier,
        *,
        target: str | None = None,
        body: StBody | None = None,
        duration: str | None = None,
    ) -> None:
        number = next(self._free_ids(step))
        row = ActionAssociation(id=number, qualifier=qualifier, target=target, body=body, duration=duration)
        self._rows.append((step, row))
        step.actions = [*step.actions, row]

    def _free_ids(self, step: Step) -> Iterator[int]:
        """Yield ids for new rows of a step: first those of replaced rows, then those that only its drawing has.

        A file that was read has such rows where the source was put back for them.
        """
        kept = {row.id for row in step.actions}
        replaced = [row.id for owner, row in self._rows if owner is step and row.id not in kept]
        acting = {row.id for _, row in self._chart.associations()}
        yield from (number for number in replaced if number not in acting)
        used = {row.id for _, row in self._rows}
        drawing = self._chart.drawing
        for symbol in drawing.symbols if drawing is not None else ():
            if any(connection.source == step.id for pin in symbol.inputs for connection in pin.connections):
                drawn = [entry.association for entry in symbol.entries or () if entry.step_action is None]
                # in the order in which they were given: stored actions may be drawn before others
                yield from sorted(number for number in drawn if number not in used)
        yield max([self._chart.new_id(), *(number + 1 for number in used)])

    # -- steps in terms of CODESYS and of TC6

    def _name_bodies(self, step: Step, uses: list[str]) -> None:
        """Give bodies in place a name: CODESYS executes actions of the POU."""
        for kind in ("entry", "main", "exit"):
            body = self._in_words(getattr(step, f"{kind}_action"))
            if kind == "main" and stays_in_place(body, self._host):
                step.main_action = body
            else:
                self._name_body(step, kind, body, uses)
        rows = [named for row in step.actions if (named := self._named_row(step, row, uses)) is not None]
        if self._host.keeps_bodies:  # behind the rows that become the exit action
            rows = [row for row in rows if not self._pulses_at_exit(step, row, uses)]
        if rows != step.actions:
            step.actions = rows

    def _name_body(self, step: Step, kind: str, body: Body | str | None, uses: list[str]) -> None:
        if isinstance(body, StBody | IlBody):
            setattr(step, f"{kind}_action", self._action(f"{step.name}_{kind}", body, uses))
            self._note_action(Outcome.TRANSLATED, step, body, f"the {kind} action, an action of the POU")

    def _name_main(self, step: Step) -> None:
        """Name the main action of a step that gets actions for every scan: they are executed in the order of names."""
        if self._host.is_codesys:
            self._name_body(step, "main", step.main_action, self._uses[step.id])

    def _in_words(self, body: Body | str | None) -> Body | str | None:
        """Return a body in place; a drawn one as structured text where that needs no more variables."""
        text = shown_body(body, self._host.dialect) if isinstance(body, FbdBody | LdBody) else None
        return StBody(text=text) if text is not None else body

    def _named_row(self, step: Step, row: ActionAssociation, uses: list[str]) -> ActionAssociation | None:
        """Return a row that executes an action of the POU; None if it became the entry or exit action of its step."""
        number = id(row)
        kind = {Qualifier.P1: "entry", Qualifier.P0: "exit"}.get(row.qualifier, "")
        if self._runs_no_final_scan(step, row):
            kind = {Qualifier.P: "entry", Qualifier.N: "main", Qualifier.NONE: "main"}.get(row.qualifier, kind)
        body = self._in_words(row.body)
        if isinstance(body, StBody | IlBody) and row.target is None:
            name = self._action(f"{step.name}_{kind or 'action'}", body, uses)
            row = row.model_copy(update={"target": name, "body": None})
            self._note_action(Outcome.TRANSLATED, step, row.body, f"an action of the POU, {name}")
        action = self._pou.find_action(row.target) if row.target is not None else None
        if not kind or action is None or row.negated or getattr(step, f"{kind}_action") is not None:
            return row
        if kind == "main" and isinstance(action.body, SfcBody):
            return row
        setattr(step, f"{kind}_action", row.target)
        self._moved[number] = STEP_ACTIONS[kind]
        self._note_action(Outcome.TRANSLATED, step, row.target, f"`{_called(row)}` is the {kind} action of the step")
        return None

    def _pulses_at_exit(self, step: Step, row: ActionAssociation, uses: list[str]) -> bool:
        """Let the exit action of a step tell `pulses` to set a variable, which nothing else of the chart drives."""
        source = self._rewriting.source
        rows = [each for _, each in source.associations() if each.target and row_key(each) == row_key(row)]
        others = any(each.qualifier is not Qualifier.P0 or each.negated or each.exclude for each in rows)
        before = step.exit_action
        is_pulse = row.qualifier is Qualifier.P0 and row.target and self._pou.find_action(row.target) is None
        if not is_pulse or others or not (before is None or isinstance(before, str)) or not self._has_start:
            return False
        assert row.target is not None  # noqa: S101  # as is_pulse
        if row.target not in self.pulses:
            self.pulses[row.target] = self._rewriting.new_variable(f"{row.target}_pulse")
        lines = [f"{before}();"] * (before is not None) + [f"{self.pulses[row.target]} := TRUE;"]
        step.exit_action = self._action(f"{step.name}_exit", StBody(text="\n".join(lines)), uses)
        why = f"`{_called(row)}` is set by an action that is executed in every scan, after the exit action of the step"
        self._note_action(Outcome.TRANSLATED, step, row.target, why)
        return True

    @property
    def _has_start(self) -> bool:
        """True if there is a step that stores what is executed in every scan."""
        return any(step.initial for step in self._rewriting.source.steps)

    def _runs_no_final_scan(self, step: Step, row: ActionAssociation) -> bool:
        """True for a row of a source without final scans whose program only this step executes.

        Blocks of S7 have no actions: a row with an action of a POU comes from a tool that has final scans, and goes
        back there.
        """
        if self._rewriting.options.of_graph and self._pou.find_action(row.target or "") is not None:
            return False
        if self._rewriting.options.final_scan or row not in self._rewriting.source_steps[step.id].actions:
            return False
        return row.target is None or sum(row_key(other) == row_key(row) for _, other in self._rows) == 1

    def report_order(self) -> None:
        """Report entry, main and exit actions that CODESYS executes before others that precede them in the source."""
        acting = [row for row in self._acting if row[1].qualifier not in (Qualifier.R, Qualifier.R0)]
        moved = any(id(row) in self._moved for _, row in acting)
        if moved and (told := told_orders(self._scans, acting, self._is_overtaken, "before")):
            self._rewriting.note(Outcome.APPROXIMATED, ORDER_OF_ACTIONS, "", told)
        if self._orders is not None and (told := self._orders.told()):
            self._rewriting.note(Outcome.APPROXIMATED, ORDER_OF_ACTIONS, "", told)

    def _is_overtaken(self, moved: Row, other: Row) -> bool:
        """True if an association that became a step action is executed before another one, and not in the source."""
        (step, row), (there, second) = moved, other
        if id(row) not in self._moved:
            return False
        steps = [each.id for each in self._chart.steps]
        of_step = not any(second is each for _, each in self._rows)
        phase = second.qualifier if of_step else self._moved.get(id(second))
        if phase is not None:
            places = [(_ORDER.index(p), steps.index(s.id)) for p, s in ((self._moved[id(row)], step), (phase, there))]
            if places[0] > places[1]:
                return False
            return of_step or self._precedes(second, row)
        is_last = self._rewriting.options.final_scan and second.qualifier not in (Qualifier.P1, Qualifier.P0)
        if is_last and second.qualifier in STORING:
            return True
        if is_last and row.qualifier is Qualifier.P0:
            return self._scans.are_together(there, step)
        return self._precedes(second, row) or (is_last and self._scans.follow(there, step))

    def _precedes(self, one: ActionAssociation, other: ActionAssociation) -> bool:
        """True if the source executes one action before another one that is active too."""
        if self._rewriting.options.of_codesys:
            return row_key(one) < row_key(other)
        used = [row_key(row) if row.target else str(id(row)) for _, row in self._acting]
        return used.index(row_key(one) or str(id(one))) < used.index(row_key(other) or str(id(other)))

    def _own_step_actions(self, step: Step) -> None:
        """Give a step the statements of entry and exit actions that others have too: IEC has one control for them.

        A pulse of that control does not come where one step with the action follows another one.
        """
        for kind in ("entry", "exit"):
            name = getattr(step, f"{kind}_action")
            action = self._pou.find_action(name) if isinstance(name, str) and name.casefold() in self._shared else None
            body = self._in_words(action.body) if action is not None else None
            if isinstance(body, StBody):
                setattr(step, f"{kind}_action", StBody(text=body.text))
                why = f"the {kind} action: the step has its statements, as other steps have this action too"
                self._note_action(Outcome.TRANSLATED, step, name, why)
                self._note_action(Outcome.TRANSLATED, step, None, why)

    def _main_action(self, step: Step) -> None:
        """Let a main action of CODESYS act while its step is active only: an action of IEC 61131-3 has a final scan."""
        found: object = step.main_action
        if isinstance(found, str):
            action = self._pou.find_action(found)
            found = action.body if action is not None else None
        if isinstance(found, StBody):
            lines = guarded(self._host.active(step), found.text.strip().splitlines())
            why = "the main action: its statements run only while the step is active"
            self._note_action(Outcome.TRANSLATED, step, step.main_action, why)
            if isinstance(step.main_action, str):
                self._note_action(Outcome.TRANSLATED, step, None, why)
            step.main_action = StBody(text="\n".join(lines))

    # -- rows

    def _is_pulse(self, row: ActionAssociation) -> bool:
        """True if a row is a coil that is TRUE in the scan of an event, which TC6 has as P1 and P0."""
        plain = row.value is None and row.body is None and not row.interlock and row.qualifier is Qualifier.N
        return plain and row.event in _PULSES and not self._host.is_codesys

    def _row(self, step: Step, row: ActionAssociation, rows: _Rows) -> None:
        """Sort a row into `rows`: kept, kept with another qualifier, as a statement, or left out with a reason."""
        if row.exclude and not self._host.excludes:
            why = f"`{_called(row)}` is left out: CODESYS excludes it"
            self._rewriting.note(Outcome.TRANSLATED, "excluded action", f"step {step.name}", why)
            return
        if row.qualifier is Qualifier.R0:
            row = row.model_copy(update={"qualifier": Qualifier.R})
            self._note_action(Outcome.TRANSLATED, step, row.target, "R0 is another name for R")
        event = None if row.event is ActionEvent.C else row.event
        if event in COMPUTED and not self._checks.happens(step, event) and not is_coil(row):
            why = f"`{_called(row)}` is left out: the event {event} never happens in this step"
            self._note_action(Outcome.TRANSLATED, step, row.target, why)
            return
        stated = row.target is not None and row_key(row) in self._stated
        if row.negated and self._host.is_codesys:
            self._leave_out(step, row, "CODESYS has no action that acts while its step is not active")
            return
        if row.qualifier is Qualifier.DL and self._host.is_codesys:
            self._leave_out(step, row, "CODESYS has no qualifier DL, and no standard tells what it does")
            return
        is_text = self._orders is not None and isinstance(row.body, StBody)  # else TC6 runs it once more after its end
        if not (is_special(row) or stated or is_text):
            rows.kept.append(row)
            rows.places.append((row, "kept"))
            return
        if self._is_pulse(row) and not stated and event is not None:
            rows.kept.append(row.model_copy(update={"qualifier": _PULSES[event], "event": None}))
            rows.places.append((row, "kept"))
            why = f"`{_called(row)}` has the qualifier {_PULSES[event].value}"
            self._note_action(Outcome.TRANSLATED, step, row.target, why)
            return
        refusal = self._refusal(step, row, event)
        if refusal is not None:
            self._leave_out(step, row, refusal)
            return
        needed = self._needed(step, row) or "TRUE"
        where = "while the step is active"
        if is_coil(row):
            driven = f"{row.target} := {self._driven(row)};"
            rows.coils += [driven] if driven not in rows.coils else []
            rows.places.insert(0, (row, "coils"))
        else:
            lines = guarded(needed, self._statements(step, row))
            late = self._host.is_codesys and row_key(row) in self._mixed  # its entry and exit actions precede coils
            kind = "active"
            if event is ActionEvent.S1 and id(row) not in self._late:
                kind, where = "first" if late else "entry", "once when the step becomes active"
            elif event is ActionEvent.S0:
                kind, where = "final" if late else "exit", "once when the step was left"
            getattr(rows, kind).extend(lines)
            rows.places.append((row, kind))
            if row.qualifier is Qualifier.TF:
                rows.exit += self.timers.left(row)
        # The statement is written in any case. From here on: scans in which it comes before or behind another write of
        # its operand otherwise than in S7-GRAPH, which the report tells.
        order = self._other_order(step, row, event)
        if order:
            self._note_action(Outcome.APPROXIMATED, step, row.target, f"`{_called(row)}` {order}")
            return
        needs = f", under the condition {needed}" if needed != "TRUE" else ""
        self._note_action(Outcome.TRANSLATED, step, row.target, f"`{_called(row)}` is a statement {where}{needs}")

    def _other_order(self, step: Step, row: ActionAssociation, event: ActionEvent | None) -> str:
        """Return in which order with other writes of its operand a statement is executed, if not that of S7-GRAPH."""
        if event is ActionEvent.S0 and self._is_driven_next(step, row):
            return f"(event S0) is executed before the next step drives {row.target}; S7-GRAPH executes it after that"
        if event is ActionEvent.S0 and self._is_written_before(step, row):
            return (
                f"(event S0) is executed after the next step has written {row.target}; S7-GRAPH executes it before that"
            )
        if is_coil(row):
            return ""
        if (other := self._driven_after(step, row)) is not None:
            words = f"is executed before the step {other.name}, active too, drives {row.target}"
            return f"{words}; S7-GRAPH executes it after that"
        if (other := self._driven_beside(step, row)) is not None:
            return f"and the step {other.name}, active too, write {row.target} at other times than in S7-GRAPH"
        return ""

    def _refusal(self, step: Step, row: ActionAssociation, event: ActionEvent | None) -> str | None:
        """Return why no statement does the same as a row; None where one does."""
        title = self._host.title
        locked = row.interlock or row.event is ActionEvent.C
        if event in COMPUTED and self._event(step, row) is None:
            return f"it depends on a condition of the step, and {_NO_TEXT}"
        if row.forcing is not None or row.kind not in KINDS_OF_SFC:
            return f"{title} has no such action of IEC 60848"
        if row.qualifier in NEED_EVENT and event is None:
            return "it has no event"
        if row.qualifier in SWITCHES and not self._checks.switched_by(row, step):
            return "there is no such step"
        if row.qualifier not in COILS | _STORING.keys() | SWITCHES | COUNTERS | TIMERS | {Qualifier.CALL}:
            return f"{title} has no action {row.qualifier.value}"
        if row.negated:
            return "it acts while its step is not active"
        if row.body is not None and not isinstance(row.body, StBody):
            return f"its body is a network in {row.body.language}"
        if row.target is None and row.body is None:
            return "it has no operand"
        if locked and (event is ActionEvent.S0 or row.qualifier is Qualifier.TF):
            return f"{title} has no interlock of a step that was left"
        if self._needed(step, row) is None:
            return f"it needs a condition, and {_NO_TEXT}"
        again = row.value is not None or row.body is not None or self._needed(step, row) != "TRUE"
        is_start = event is ActionEvent.S1 and id(row) not in self._late
        late = is_start and row_key(row) in self._mixed and self._host.is_codesys
        if late and again and not is_coil(row):
            return f"another row drives {row.target}, and {title} executes it after entry actions"
        if row.qualifier in NEED_TIME and (not row.duration or row.condition is not None):
            return "its time depends on its condition" if row.duration else "it has no time"
        if row.qualifier is Qualifier.TF and event is not None:
            return "its time has no event"
        if is_coil(row):
            if event is ActionEvent.S0:
                return f"{title} has no action that is TRUE in the scan after its step only"
            if event is not None and row.duration is not None:
                return "its time has no event"
            if self._driven(row) is None:
                return f"another action of {row.target} cannot be written"
        return None

    def _is_driven_next(self, step: Step, row: ActionAssociation) -> bool:
        """True if a following step may drive the operand of a row otherwise in the cycle in which its step is left."""
        coils = [r for _, r in self._next_rows(step, row) if is_coil(r)]
        return any(row.qualifier is not Qualifier.S or r.duration is not None or r.interlock for r in coils)

    def _is_written_before(self, step: Step, row: ActionAssociation) -> bool:
        """True if a following step writes the operand of a row in an action that comes before those of its step.

        CODESYS executes exit actions before all others, IEC 61131-3 gives no order but that of the chart.
        """
        if self._host.is_codesys:
            return False
        order = [each.id for each in self._chart.steps]
        others = [s for s, r in self._next_rows(step, row) if not is_coil(r)]
        return any(order.index(other.id) < order.index(step.id) for other in others)

    def _driven_after(self, step: Step, row: ActionAssociation) -> Step | None:
        """Return a step, active together with `step`, that drives the operand of a row in a later action."""
        order = [each.id for each in self._chart.steps]
        for other, coil in self._rows:
            if other is step or not coil.target or not is_coil(coil) or row_key(coil) != row_key(row):
                continue
            here, there = step.name.casefold(), other.name.casefold()
            late = here < there if self._host.is_codesys else order.index(step.id) < order.index(other.id)
            if late and self._scans.are_together(step, other):
                return other
        return None

    def _driven_beside(self, step: Step, row: ActionAssociation) -> Step | None:
        """Return a step, active together with `step`, that drives the operand of a row which CODESYS executes twice.

        An action with P has a final scan. Where rows switch steps, it is not known when which of them begin.
        """
        twice = row.event is ActionEvent.S1 or self._scans.are_switched
        if not self._host.is_codesys or row_key(row) not in self._mixed or not twice:
            return None
        coils = (s for s, each in self._rows if s is not step and is_coil(each) and row_key(each) == row_key(row))
        return next((each for each in coils if self._scans.are_together(step, each)), None)

    @cached_property
    def _scans(self) -> SharedScans:
        return SharedScans(self._rewriting.source, self._pou, self._host.dialect)

    def _next_rows(self, step: Step, row: ActionAssociation) -> Iterator[tuple[Step, ActionAssociation]]:
        """Yield the rows of following steps that have the operand of a row."""
        following = {i for t in self._rewriting.source.transitions if step.id in t.sources for i in t.targets}
        yield from ((s, r) for s, r in self._rows if s.id in following and r.target and row_key(r) == row_key(row))

    def _needed(self, step: Step, row: ActionAssociation) -> str | None:
        """Return the condition of a row besides its active step; None where it is no expression."""
        interlock = self._rewriting.interlock(step) if row.interlock or row.event is ActionEvent.C else "TRUE"
        condition = self._rewriting.text(row.condition) if row.condition is not None else "TRUE"
        if interlock is None or condition is None:
            return None
        parts = [part for part in (self._event(step, row) or "TRUE", interlock, condition) if part != "TRUE"]
        return " AND ".join(as_term(part) for part in parts) if len(parts) > 1 else (parts or ["TRUE"])[0]

    def _event(self, step: Step, row: ActionAssociation) -> str | None:
        """Return the variable of the event of a row: TRUE where its place decides the time, None where none can."""
        event = row.event
        if event is None or event not in COMPUTED or not self._checks.happens(step, event):
            return "TRUE"
        if event is ActionEvent.S1 and not is_coil(row) and id(row) not in self._late:
            return "TRUE"
        return self._checks.variable(step, event.value) if self._checks.can_tell(step, event) else None

    def _driven(self, coil: ActionAssociation) -> str | None:
        """Return the OR over all rows of the chart that drive a coil; None where one of them is no expression."""
        # One statement for all rows with the operand: of several the last would win, even while its step is not active.
        terms: list[str] = []
        for step, row in self._rows:
            if row.target is None or row_key(row) != row_key(coil) or not is_coil(row):
                continue
            if row.event is ActionEvent.S0 or (row.event in COMPUTED and not self._checks.happens(step, row.event)):
                continue  # it is left out, and reported, or never TRUE
            parts = [self._host.active(step)]
            if row.qualifier in (Qualifier.D, Qualifier.L):
                sign = ">=" if row.qualifier is Qualifier.D else "<"
                parts.append(f"{self._host.elapsed(step)} {sign} {row.duration}")
            needed = self._needed(step, row)
            if needed is None:
                return None
            terms.append(" AND ".join([*parts, *([as_term(needed)] if needed != "TRUE" else [])]))
        return " OR ".join(terms) or "FALSE"

    def _statements(self, step: Step, row: ActionAssociation) -> list[str]:
        if row.qualifier in SWITCHES:
            switched, word = self._checks.switched_by(row, step), row.qualifier.value.lower()
            return [f"{self._checks.switch(each, word)} := TRUE;" for each in switched]
        if row.qualifier in TIMERS:
            return self.timers.started(row)
        if row.qualifier in COUNTERS:
            return [counted(row)]
        return _plain_statements(row)

    def _leave_out(self, step: Step, row: ActionAssociation, why: str) -> None:
        event = f" (event {row.event})" if row.event is not None else ""
        text = f"`{_called(row)}`{event} is not executed in {self._host.title}: {why}"
        self._note_action(Outcome.NOT_EXECUTED, step, row.target, text, Cause(CauseKind.AS_IT_IS))


def _plain_statements(row: ActionAssociation) -> list[str]:
    if isinstance(row.body, StBody):
        text = row.body.text.strip()
        return (text if text.endswith(";") else f"{text};").splitlines()
    if row.value is not None:
        return [f"{row.target} := {row.value};"]
    if row.qualifier in _STORING:
        return [f"{row.target} := {_STORING[row.qualifier]};"]
    return [f"{row.target}();"]


def _called(row: ActionAssociation) -> str:
    """Return the words for a row: its qualifier and what it writes or calls."""
    if row.body is not None:
        words = row.body.text.strip() if isinstance(row.body, StBody) else row.body.language
    else:
        words = row.target or ""
    words = f"{words} := {row.value}" if row.value is not None else words
    return f"{row.qualifier.value} {words}" if row.qualifier is not Qualifier.NONE else words
