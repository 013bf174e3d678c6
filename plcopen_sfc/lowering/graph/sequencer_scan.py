"""One cycle of a sequencer as structured text, in the order of S7-GRAPH.

Permanent instructions, commands, interlocks and supervisions, step change, events, actions, outputs, permanent
instructions. Parameters and step data without a use make no code.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.boolean_logic import FALSE, assignment, conjunction, disjunction, is_constant, negation
from plcopen_sfc.lowering.code.code_memory import Memory
from plcopen_sfc.lowering.code.lowered_code import LoweredCode
from plcopen_sfc.lowering.code_texts import GraphTexts
from plcopen_sfc.lowering.graph.block_parameters import BlockCommands, add_reports
from plcopen_sfc.lowering.graph.sequencer_actions import SequencerActions, SequencerStepCode, StepSignals
from plcopen_sfc.lowering.graph.sequencer_reading import show
from plcopen_sfc.lowering.graph.sequencer_source import (
    ActionRow,
    AskedStepData,
    CyclePhase,
    GraphSource,
    StepNames,
    step_quantity,
)
from plcopen_sfc.lowering.graph.step_supervision import CheckedStep, StepClock, SupervisionChecks
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.lowering.schedule.added_inputs import declare_restart
from plcopen_sfc.model.actions import ActionEvent
from plcopen_sfc.model.text import plain
from plcopen_sfc.semantics.charts.graph.graph_parameters import Mode

_STEP_EVENTS = frozenset({"S1", "S0", "R1"})
_LIMITS = {"T_MAX": "max_time", "T_WARN": "warning_time"}


class Sequencer(ABC):
    """Schedule of one cycle in the order of S7-GRAPH, appended to `code`.

    An encoding has an expression for each active step (`active`), changes the situation (`add_transitions`,
    `add_step_change`), and has expressions for its changes (`changed`, `touched`, `gone`).
    """

    def __init__(
        self,
        source: GraphSource,
        code: LoweredCode,
        memory: Memory,
        rules: LoweringRules,
        surroundings: Collection[str] = (),
    ) -> None:
        self.source, self.code, self.memory, self.rules = source, code, memory, rules
        self.net, self.texts = source.net, rules.texts
        self.own_texts = GraphTexts(rules.texts)
        code.at_rest |= dict.fromkeys(source.at_rest, False)
        self.init = declare_restart(source, code, rules, surroundings)
        code.declare_helpers(source.helpers)
        names = self.declare_states(surroundings)
        self.signs = [StepNames(self.active(step), name) for step, name in enumerate(names)]
        self.first = code.declare(self.texts.pulse, initial="TRUE", comment=self.own_texts.first_cycle)
        self.questions = AskedStepData(source)
        self.commands = BlockCommands(source, code, memory, self.own_texts)
        self.clock = StepClock(source, code, self.signs, self.texts, self.questions)
        self._registered: dict[int, n.Name] = {}
        self.checks = [self._checks_of(step.index) for step in self.net.steps]

    def _checks_of(self, step: int) -> SupervisionChecks:
        needed = self.questions.of(step)
        for row in self.source.rows[step]:
            needed |= {row.event.value} if row.event is not None else set()
            needed |= {"LS"} if row.interlock else set()
        # the time without disturbance and the error of the block need both checks of every step
        if "ERR_FLT" in self.source.parameters or "U" in needed:
            needed |= {"LS", "VA"}
        comment = partial(self.own_texts.check, self.net.steps[step].path)
        return SupervisionChecks(
            self.source, step, self.code, CheckedStep(self.signs[step], needed, self.questions, comment)
        )

    @abstractmethod
    def declare_states(self, surroundings: Collection[str]) -> Sequence[str]:
        """Declare the variables of the situation. Returns the beginning of the names of each step's variables."""

    @abstractmethod
    def active(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step, given by its index in the net, is active."""

    def only_state(self) -> n.Name | None:
        """Return the number of the active step, 0 for none, if a variable has that; None where there can be several."""
        return None

    @abstractmethod
    def add_transitions(self) -> None:
        """Append the networks that decide which transitions fire."""

    @abstractmethod
    def add_step_change(self) -> None:
        """Append the networks that change the situation."""

    @abstractmethod
    def changed(self, step: int, event: ActionEvent) -> Expression:
        """Return an expression that is TRUE from the step change on if a step was entered (S1) or left (S0)."""

    @abstractmethod
    def touched(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step is active or was left in this cycle."""

    @abstractmethod
    def gone(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step was left in the cycle before."""

    @abstractmethod
    def add_events(self, place: int, registered: Sequence[Statement]) -> None:
        """Insert at `place`, right behind the step change, what finds out its events, and which steps `registered`."""

    @abstractmethod
    def add_switched(self, actions: SequencerActions) -> None:
        """Append the effect of actions that switch steps on and off."""

    def active_steps(self) -> dict[str, Expression]:
        """Return expressions that are TRUE while a step is active, by its path."""
        return {step.path: self.active(step.index) for step in self.net.steps}

    def exact(self) -> None:
        """Append one cycle."""
        code, own_texts = self.code, self.own_texts
        code.add(own_texts.before, [*self.resolved(self.source.before, CyclePhase.BEFORE)])
        code.add(self.texts.logic, [*self.resolved(self.source.logic, CyclePhase.BEFORE)])
        # commands are evaluated here; which edges are read is known when all else is made
        place = len(code.networks)
        self._add_checks()
        self.add_transitions()
        self.add_step_change()
        self._add_actions()
        steps = [(sign.active, check) for sign, check in zip(self.signs, self.checks, strict=True)]
        add_reports(self.source, code, self.commands, steps, own_texts, state=self.only_state())
        code.add(own_texts.after, [*self.resolved(self.source.after, CyclePhase.ACT)])
        values = [self._value(*asked, CyclePhase.ACT) for asked in self.source.shown]
        code.add(own_texts.shown_data, show(self.source.shown, values, self.net, code))
        self._insert_commands(place)

    def _insert_commands(self, place: int) -> None:
        """Insert edges before all code that reads them; which ones these are is only known at the end."""
        rest = self.code.networks[place:]
        del self.code.networks[place:]
        self.code.add(self.own_texts.commands, self.commands.statements(), self.commands.mode_comment)
        self.code.networks += rest

    # -- texts

    def resolved(self, statements: tuple[n.Statement, ...], phase: CyclePhase) -> list[Statement]:
        """Return texts with variables in the place of the data of steps."""
        return [self.resolve(statement, phase) for statement in statements]

    def resolve(self, tree: Any, phase: CyclePhase) -> Any:
        """Return a text with variables in the place of the data of steps."""

        def change(node: n.Node) -> n.Node:
            found = step_quantity(node, self.questions.steps)
            return node if found is None else self._value(*found, phase)

        return transform(tree, change)

    def _value(self, step: int, quantity: str, phase: CyclePhase) -> Expression:
        if quantity == "X":
            return self.active(step)
        if quantity == "SNO":
            return n.Literal(str(self.net.steps[step].step.number or 0))
        if quantity in _LIMITS:
            return self.clock.stated(getattr(self.net.steps[step].step, _LIMITS[quantity]))
        if quantity in ("T", "U"):
            return self.clock.value(step, quantity)
        if quantity in _STEP_EVENTS:
            # permanent instructions before the sequence see the events of the last cycle; checks and transitions before
            # the step change see none
            happened = phase in (CyclePhase.BEFORE, CyclePhase.ACT) or (
                phase is CyclePhase.ENTERED and quantity != "R1"
            )
            return self.event(step, ActionEvent(quantity)) if happened else FALSE
        return self.checks[step].value(quantity)

    def event(self, step: int, event: ActionEvent) -> Expression:
        """Return an expression that is TRUE from the step change on if an event of a step has happened."""
        if event in (ActionEvent.S1, ActionEvent.S0):
            return self.changed(step, event)
        if event is not ActionEvent.R1:
            return self.checks[step].value(event.value)
        if is_constant(self._registers(), FALSE):
            return FALSE
        if step not in self._registered:
            self._registered[step] = self.code.declare(f"{self.signs[step].name}_{event.value}")
        return self._registered[step]

    def _registers(self) -> Expression:
        return disjunction([self.commands.edge("REG_EF"), self.commands.edge("REG_S")])

    # -- before the step change

    def _add_checks(self) -> None:
        self.code.add(self.texts.times, self.clock.calls())
        acknowledge = self.commands.edge("ACK_EF") if any(c.early for c in self.checks) else FALSE
        cleared = [s for each in self.checks for s in each.cleared()]
        checked = self._of_steps(each.before(self.resolve, acknowledge) for each in self.checks)
        self.add_checks(cleared, checked, "" if self._checked_late else self._alarms())
        self.code.add(self.own_texts.undisturbed, self.clock.counted(self.checks))

    def evolves(self) -> Expression:
        """Return an expression that is TRUE if conditions of transitions are evaluated in this cycle."""
        idle = (self.commands.is_on(Mode.MANUAL), self.started(), self.commands.edge("OFF_SQ"))
        return conjunction(map(negation, idle))

    def started(self) -> Expression:
        """Return an expression that is TRUE if the sequence is restarted."""
        return disjunction([self.commands.edge("INIT_SQ"), *([self.init] if self.init is not None else [])])

    # -- behind the step change

    def _add_actions(self) -> None:
        place = len(self.code.networks)
        for step in self.net.steps:
            # declared in the order of the steps, whatever text asks first
            for name in sorted(self.questions.of(step.index) & _STEP_EVENTS):
                self.event(step.index, ActionEvent(name))
        self.code.add(self.texts.times, [*self.clock.calls(), *self._restarted()])
        self._add_checks_behind(self._alarms() if self._checked_late else "")
        signals = StepSignals(self.active, self.touched, self.event, self._released, self.clock.over, self.gone)
        actions = SequencerActions(self._with_resolved_rows(), self.code, self.texts, self.own_texts, signals)
        actions.add_coils()
        self.add_leaving(actions.leaving())
        self.add_acting(actions.acting())
        actions.add_timers()
        self.add_switched(actions)
        registers = self._registers()
        registered = [
            assignment(name, conjunction([self.active(step), registers]))
            for step, name in sorted(self._registered.items())
        ]
        # events are found out right behind the step change; which of them are read is known now
        self.add_events(place, registered)

    def _with_resolved_rows(self) -> GraphSource:
        """Return the sequencer with variables in the place of the data of steps in its actions."""

        def resolved(row: ActionRow) -> ActionRow:
            target, value = (
                self.resolve(tree, CyclePhase.ACT) if tree is not None else None for tree in (row.target, row.value)
            )
            return replace(
                row, target=target, value=value, statements=tuple(self.resolved(row.statements, CyclePhase.ACT))
            )

        return replace(self.source, rows=tuple(tuple(map(resolved, rows)) for rows in self.source.rows))

    def _restarted(self) -> list[Statement]:
        return self.clock.restarted(lambda step: self.event(step, ActionEvent.S1))

    def _add_checks_behind(self, alarms: str) -> None:
        """Append the checks behind the step change: what is left is forgotten before anything reads it."""

        def signal(step: int, event: ActionEvent) -> Callable[[], Expression]:
            return lambda: self.event(step, event)

        forgotten = [each.forgotten(signal(i, ActionEvent.S0)) for i, each in enumerate(self.checks)]
        behind = [each.behind(self.resolve, signal(i, ActionEvent.S1)) for i, each in enumerate(self.checks)]
        self.add_checks_behind(self._of_steps(forgotten), self._of_steps(behind), alarms)

    def _of_steps(self, statements: Iterable[list[Statement]]) -> list[SequencerStepCode]:
        """Return the code of each step that has some."""
        pairs = zip(self.net.steps, statements, strict=True)
        return [SequencerStepCode(step, tuple(own)) for step, own in pairs if own]

    # -- what belongs to one step each

    def add_checks(self, cleared: list[Statement], checked: Sequence[SequencerStepCode], alarms: str) -> None:
        """Append the checks of the active steps before the step change."""
        self.code.add(self.own_texts.checks, [*cleared, *_all(checked)], alarms)

    def add_checks_behind(
        self, forgotten: Sequence[SequencerStepCode], checked: Sequence[SequencerStepCode], alarms: str
    ) -> None:
        """Append the checks behind the step change, of steps that were left, then of the active ones."""
        self.code.add(self.own_texts.checks_behind, [*_all(forgotten), *_all(checked)], alarms)

    def add_leaving(self, parts: Sequence[SequencerStepCode]) -> None:
        """Append the code of steps that were left."""
        for part in parts:
            self.code.add(self.own_texts.leaving(part.step.path), part.statements)

    def add_acting(self, parts: Sequence[SequencerStepCode]) -> None:
        """Append the code of active steps."""
        for part in parts:
            self.code.add(self.own_texts.acting(part.step.path), part.statements)

    @property
    def _checked_late(self) -> bool:
        """True if there are no checks before the step change."""
        return not any(check.early for check in self.checks)

    def _alarms(self) -> str:
        """Return the comment on checks: lowered code makes no alarms."""
        language = self.own_texts.language
        lines: list[str] = []
        for step in self.net.steps:
            for check in (step.step.interlock, step.step.supervision):
                texts = [plain(text, language) for text in (check.title, check.alarm)] if check is not None else []
                if any(texts):
                    lines.append(f"{step.path}: {', '.join(filter(None, texts))}")
        return "\n".join(lines)

    def _released(self, step: int) -> Expression:
        return self.checks[step].value("LS")


def _all(parts: Iterable[SequencerStepCode]) -> list[Statement]:
    return [statement for part in parts for statement in part.statements]
