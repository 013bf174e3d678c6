"""One cycle of a sequencer as structured text, in the order of S7-GRAPH.

Permanent instructions, commands, interlocks and supervisions, step change, events, actions, outputs, permanent
instructions. Parameters and step data without a use make no code.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.actions.action_execution import StepCode
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    equal,
    is_constant,
    negation,
    when,
)
from plcopen_sfc.lowering.encodings.case_encodings import RegionEncoding
from plcopen_sfc.lowering.encodings.case_states import RegionState, StateVariables
from plcopen_sfc.lowering.encodings.step_flags import FlipFlopEncoding, Imposed, StepBitEncoding
from plcopen_sfc.lowering.graph.block_parameters import BlockCommands, add_reports
from plcopen_sfc.lowering.graph.sequencer_actions import SequencerActions, StepSignals
from plcopen_sfc.lowering.graph.sequencer_reading import show
from plcopen_sfc.lowering.graph.sequencer_source import (
    ActionRow,
    AskedStepData,
    CyclePhase,
    GraphSource,
    StepNames,
    step_quantity,
)
from plcopen_sfc.lowering.graph.skipped_steps import SkippedSteps
from plcopen_sfc.lowering.graph.step_supervision import CheckedStep, StepClock, SupervisionChecks
from plcopen_sfc.lowering.lowering_options import States
from plcopen_sfc.lowering.reading.chart_source import step_numbers
from plcopen_sfc.model.actions import ActionEvent, Qualifier
from plcopen_sfc.model.text import plain
from plcopen_sfc.semantics.charts.graph.graph_parameters import Mode

_STEP_EVENTS = frozenset({"S1", "S0", "R1"})
_LARGEST_INT = 32_767
_LIMITS = {"T_MAX": "max_time", "T_WARN": "warning_time"}


class GraphCycle:
    """Schedule of one cycle in the order of S7-GRAPH, for the sequencer of `encoding`."""

    def __init__(self, encoding: StepBitEncoding | FlipFlopEncoding | RegionEncoding, source: GraphSource) -> None:
        self._encoding, self._source, self._code, self._net = encoding, source, encoding.code, source.net
        self._texts, self._situation, self._active = encoding.texts, encoding.situation, encoding.active
        steps = range(len(self._net.steps))
        self._signs = [StepNames(self._active(step), self._situation.name(step)) for step in steps]
        # actions ON and OFF act in the next cycle: the steps are kept in bits of their own until then
        switched = sorted({i for rows in source.rows for row in rows for i in row.switched})
        self._wanted: dict[int, n.Name] = {}
        for i in switched:
            name, comment = (
                self._texts.with_suffix(self._signs[i].name, "next"),
                self._texts.wanted_of(self._net.steps[i].path),
            )
            self._wanted[i] = self._code.declare(name, comment=comment)
        if not isinstance(encoding, RegionEncoding):
            encoding.held = self._wanted
        self._first = self._code.declare(self._texts.pulse, initial="TRUE", comment=self._texts.first_cycle)
        self._questions = AskedStepData(source)
        self._commands = BlockCommands(source, encoding.memory)
        self._clock = StepClock(source, self._code, self._signs, self._questions)
        self._registered: dict[int, n.Name] = {}
        self._gone: dict[int, n.Name] = {}
        self._checks = [self._checks_of(step) for step in steps]
        # code of one step each is in the branches of a CASE where one step is active at a time
        self._only: tuple[StateVariables, RegionState] | None = None
        if isinstance(encoding, RegionEncoding) and len(encoding.machines) == 1:
            self._only = encoding.states, encoding.machines[0]

    def append(self) -> None:
        """Append one cycle."""
        source, code, texts = self._source, self._code, self._texts
        code.add(texts.before_sequence, [*self._resolved(source.before, CyclePhase.BEFORE)])
        code.add(self._texts.logic, [*self._resolved(source.logic, CyclePhase.BEFORE)])
        # commands are evaluated here; which edges are read is known when all else is made
        place = len(code.networks)
        self._add_checks_before()
        change = len(code.networks)
        self._add_step_change()
        self._add_actions(change)
        steps = [(sign.active, check) for sign, check in zip(self._signs, self._checks, strict=True)]
        add_reports(source, code, self._commands, steps, state=self._only_state())
        code.add(texts.after_sequence, [*self._resolved(source.after, CyclePhase.ACT)])
        values = [self._value(*asked, CyclePhase.ACT) for asked in source.shown]
        code.add(texts.shown_data, show(source.shown, values, self._net, code))
        # edges stand before all code that reads them
        rest, code.networks[place:] = code.networks[place:], []
        code.add(texts.commands, self._commands.statements(), self._commands.mode_comment)
        code.networks += rest

    def _only_state(self) -> n.Name | None:
        """Return the number of the active step, 0 for none, if a variable has that; None where there can be several."""
        if self._only is None or not self._has_numbers(machine := self._only[1]):
            return None
        return machine.state if max(step_numbers(self._net)) <= _LARGEST_INT else None

    def _has_numbers(self, machine: RegionState) -> bool:
        """Return True if the states of a region are the numbers that its steps have for the user."""
        numbers = step_numbers(self._net)
        # S_NO shows the number that the user knows, and 0 where no step is active
        own = all(self._net.steps[i].step.number == numbers[i] != 0 for i in machine.region.steps)
        return own and not machine.blocks and self._encoding.rules.states is not States.ENUMERATION

    def _checks_of(self, step: int) -> SupervisionChecks:
        needed = self._questions.of(step)
        for row in self._source.rows[step]:
            needed |= {row.event.value} if row.event is not None else set()
            needed |= {"LS"} if row.interlock else set()
        # the time without disturbance and the error of the block need both checks of every step
        if "ERR_FLT" in self._source.parameters or "U" in needed:
            needed |= {"LS", "VA"}
        comment = partial(self._texts.check, self._net.steps[step].path)
        return SupervisionChecks(
            self._source, step, self._code, CheckedStep(self._signs[step], needed, self._questions, comment)
        )

    # -- texts

    def _resolved(self, statements: tuple[n.Statement, ...], phase: CyclePhase) -> list[Statement]:
        """Return texts with variables in the place of the data of steps."""
        return [self._resolve(statement, phase) for statement in statements]

    def _resolve(self, tree: Any, phase: CyclePhase) -> Any:
        """Return a text with variables in the place of the data of steps."""

        def change(node: n.Node) -> n.Node:
            found = step_quantity(node, self._questions.steps)
            return node if found is None else self._value(*found, phase)

        return transform(tree, change)

    def _value(self, step: int, quantity: str, phase: CyclePhase) -> Expression:
        if quantity == "X":
            return self._active(step)
        if quantity == "SNO":
            return n.Literal(str(self._net.steps[step].step.number or 0))
        if quantity in _LIMITS:
            return n.Literal(getattr(self._net.steps[step].step, _LIMITS[quantity]) or "T#0ms")
        if quantity in ("T", "U"):
            return self._clock.value(step, quantity)
        if quantity in _STEP_EVENTS:
            # permanent instructions before the sequence see the events of the last cycle; checks and transitions before
            # the step change see none
            happened = phase in (CyclePhase.BEFORE, CyclePhase.ACT) or (
                phase is CyclePhase.ENTERED and quantity != "R1"
            )
            return self._event(step, ActionEvent(quantity)) if happened else FALSE
        return self._checks[step].value(quantity)

    def _event(self, step: int, event: ActionEvent) -> Expression:
        """Return an expression that is TRUE from the step change on if an event of a step has happened."""
        if event in (ActionEvent.S1, ActionEvent.S0):
            return self._changed(step, event)
        if event is not ActionEvent.R1:
            return self._checks[step].value(event.value)
        if is_constant(self._registers(), FALSE):
            return FALSE
        if step not in self._registered:
            self._registered[step] = self._code.declare(f"{self._signs[step].name}_{event.value}")
        return self._registered[step]

    def _registers(self) -> Expression:
        return disjunction([self._commands.edge("REG_EF"), self._commands.edge("REG_S")])

    # -- events of steps

    def _changed(self, step: int, event: ActionEvent) -> Expression:
        """Return an expression that is TRUE from the step change on if a step was entered (S1) or left (S0)."""
        now, before = self._active(step), self._situation.before(step)
        return conjunction([now, negation(before)] if event is ActionEvent.S1 else [before, negation(now)])

    def _touched(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step is active or was left in this cycle."""
        return disjunction([self._active(step), self._situation.before(step)])

    def _was_gone(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step was left in the cycle before."""
        if step not in self._gone:
            self._gone[step] = self._code.declare(self._texts.with_suffix(f"{self._signs[step].name}_S0", "old"))
        return self._gone[step]

    # -- the step change

    def _add_step_change(self) -> None:
        """Append what decides on transitions, what these change, and the steps that commands set."""
        encoding, code, texts, source = self._encoding, self._code, self._texts, self._source
        plain = [self._resolve(condition, CyclePhase.SWITCH) for condition in source.conditions]
        before = tuple(tuple(self._resolved(each, CyclePhase.SWITCH)) for each in source.preparations)
        shared: list[Statement] = []
        encoding.source = replace(source, conditions=self._conditions(plain, shared), preparations=before)
        encoding.asked = self._evolves
        skips = SkippedSteps(encoding, plain, before, self._evolves) if source.skips else None
        if skips is not None and isinstance(encoding, RegionEncoding):
            skips.declare()
        encoding.divide()
        encoding.choose_transitions(shared)
        if isinstance(encoding, FlipFlopEncoding):
            if skips is not None:
                source.refuse("steps that are skipped need a loop, which networks do not have", "Take --language ST.")
            by_hand = [*self._imposed_by_hand()]
            start, off = disjunction([self._first, self._started()]), self._commands.edge("OFF_SQ")
            ends = Imposed(off, dict.fromkeys(encoding.initial_situation, FALSE))
            imposed = [*by_hand, Imposed(start, encoding.initial_situation), ends]
            manual = self._wanted or not is_constant(self._commands.is_on(Mode.MANUAL), FALSE)
            encoding.change_situation(imposed, lambda *_: bool(manual) or not encoding.is_safe, starts=start)
            code.add(self._texts.first_scan, [assignment(self._first, FALSE)])
            return
        if isinstance(encoding, StepBitEncoding):
            encoding.change_situation(skips.entered() if skips is not None else None)
        elif skips is not None:
            skips.add_loops()
        # start and end come behind the switching by hand, and override it
        code.add(texts.manual, self._switched_by_hand())
        start, off = disjunction([self._first, self._started()]), self._commands.edge("OFF_SQ")
        code.add(texts.sequence_start, [when(start, *encoding.starting(), assignment(self._first, FALSE))])
        ended = encoding.ending()  # nothing, if there is no step
        code.add(texts.off, [when(off, *ended)] if ended and not is_constant(off, FALSE) else [])
        if isinstance(encoding, RegionEncoding):
            encoding.change_situation()

    def _conditions(self, plain: Sequence[Expression], shared: list[Statement]) -> tuple[Expression, ...]:
        """Return when the conditions of transitions let these switch: in this mode, and without a fault."""
        encoding, commands, named = self._encoding, self._commands, self._encoding.memory.named
        permitted, pushed = commands.permitted(), commands.pushed()
        # one IF around the CASE instead of the same condition in every transition; what must be executed before a
        # condition is executed where nothing switches, too
        guards = isinstance(encoding, RegionEncoding) and not any(self._source.preparations)
        if not is_constant(permitted, TRUE) and not (guards and self._only is not None):
            permitted = named(self._texts.permitted, permitted, shared)
        if not is_constant(pushed, FALSE):
            pushed = named(self._texts.pushed, pushed, shared)
        if guards and isinstance(encoding, RegionEncoding):
            encoding.may_fire, permitted = permitted, TRUE
        found: list[Expression] = []
        for transition, condition in zip(self._net.transitions, plain, strict=True):
            held = [negation(self._held(i)) for i in transition.sources]
            found.append(conjunction([disjunction([conjunction([condition, permitted]), pushed]), *held]))
        return tuple(found)

    def _held(self, step: int) -> Expression:
        """Return when its supervision holds a step; one just switched on is not supervised yet."""
        held = self._checks[step].held(self._resolve)
        return conjunction([self._active(step), held]) if step in self._wanted else held

    # -- steps switched by hand

    def _selected(self, command: str) -> tuple[n.Name, Expression] | None:
        """Return the number of the step that a command concerns, and when it is given; None if it never is."""
        by_hand, selection = self._commands.is_on(Mode.MANUAL), self._commands.variable("S_SEL")
        edge = self._commands.edge(command) if not is_constant(by_hand, FALSE) else FALSE
        if selection is None or is_constant(edge, FALSE):
            return None
        return selection, conjunction([by_hand, edge])

    def _numbered(self) -> dict[int, int]:
        """Return the steps by their numbers: of two with the same number S_SEL means the first one."""
        found: dict[int, int] = {}
        for step in self._net.steps:
            if step.step.number is not None:
                found.setdefault(step.step.number, step.index)
        return found

    def _imposed_by_hand(self) -> Iterator[Imposed]:
        for command, value in (("S_ON", TRUE), ("S_OFF", FALSE)):
            if (given := self._selected(command)) is not None:
                for number, step in self._numbered().items():
                    one = conjunction([given[1], equal(given[0], n.Literal(str(number)))])
                    yield Imposed(one, {step: value}, locks=bool(self._wanted))

    def _switched_by_hand(self) -> list[Statement]:
        """Return S_ON and S_OFF for the step whose number S_SEL has; regions have no S_ON."""
        encoding, found = self._encoding, list[Statement]()
        if isinstance(encoding, RegionEncoding):
            if (given := self._selected("S_OFF")) is None:
                return found
            for machine in encoding.machines:
                meant = conjunction([given[1], self._is_selected(machine, given[0])])
                if not is_constant(meant, FALSE):
                    found.append(when(meant, *encoding.ending([machine])))
            return found
        for command, value in (("S_ON", TRUE), ("S_OFF", FALSE)):
            given = self._selected(command)
            branches = [
                n.CaseBranch((n.Literal(str(number)),), tuple(encoding.imposing({step: value})))
                for number, step in self._numbered().items()
            ]
            if given is not None and branches:
                found.append(when(given[1], n.Case(given[0], tuple(branches))))
        return found

    def _is_selected(self, machine: RegionState, selection: n.Name) -> Expression:
        """Return an expression that is TRUE if the active step of a region is the one selected."""
        # the state is the number: one comparison instead of one for each step
        if self._has_numbers(machine):
            return equal(machine.state, selection)
        own = ((number, step) for number, step in self._numbered().items() if step in machine.region.steps)
        return disjunction(
            conjunction([self._active(step), equal(selection, n.Literal(str(number)))]) for number, step in own
        )

    # -- before the step change

    def _add_checks_before(self) -> None:
        self._code.add(self._texts.times, self._clock.calls(ahead=True))
        acknowledge = self._commands.edge("ACK_EF") if any(c.early for c in self._checks) else FALSE
        cleared = [s for each in self._checks for s in each.cleared()]
        checked = self._of_steps(each.before(self._resolve, acknowledge) for each in self._checks)
        alarms = "" if self._checked_late else self._alarms()
        self._code.add(self._texts.checks, [*cleared, *self._of_active(checked)], alarms)
        self._code.add(self._texts.undisturbed, self._clock.counted(self._checks))

    def _evolves(self) -> Expression:
        """Return an expression that is TRUE if conditions of transitions are evaluated in this cycle."""
        idle = (self._commands.is_on(Mode.MANUAL), self._started(), self._commands.edge("OFF_SQ"))
        return conjunction(map(negation, idle))

    def _started(self) -> Expression:
        """Return an expression that is TRUE if the sequence is restarted."""
        restart = self._encoding.restart
        return disjunction([self._commands.edge("INIT_SQ"), *([restart] if restart is not None else [])])

    # -- behind the step change

    def _add_actions(self, change: int) -> None:
        """Append actions. `change` is the place before the step change, where what steps were is remembered."""
        place = len(self._code.networks)
        for step in self._net.steps:
            # declared in the order of the steps, whatever text asks first
            for name in sorted(self._questions.of(step.index) & _STEP_EVENTS):
                self._event(step.index, ActionEvent(name))
        restarted = self._clock.restarted(lambda step: self._event(step, ActionEvent.S1))
        self._code.add(self._texts.times, [*self._clock.calls(ahead=False), *restarted])
        self._add_checks_behind(self._alarms() if self._checked_late else "")
        over, gone, released = self._clock.over, self._was_gone, lambda step: self._checks[step].value("LS")
        signals = StepSignals(self._active, self._touched, self._event, released, over, gone)
        actions = SequencerActions(self._with_resolved_rows(), self._code, signals)
        actions.add_coils()
        self._add_leaving(actions.leaving())
        self._add_acting(actions.acting())
        actions.add_timers()
        wanted = [assignment(name, self._wants(actions, step)) for step, name in self._wanted.items()]
        self._code.add(self._texts.switched, wanted)
        registers = self._registers()
        registered = [
            assignment(name, conjunction([self._active(step), registers]))
            for step, name in sorted(self._registered.items())
        ]
        # events are found out right behind the step change; which of them are read is known now
        self._code.add(self._texts.step_events, registered, place=place)
        kept = [assignment(bit, self._changed(step, ActionEvent.S0)) for step, bit in self._gone.items()]
        self._code.add(self._texts.before, [*kept, *self._situation.remembered()], place=change)

    def _wants(self, actions: SequencerActions, step: int) -> Expression:
        """Return when a step is active at the start of the next cycle: one that is switched on is in any case."""
        stays = conjunction([self._active(step), negation(actions.switched(Qualifier.OFF, step))])
        return disjunction([stays, actions.switched(Qualifier.ON, step)])

    def _with_resolved_rows(self) -> GraphSource:
        """Return the sequencer with variables in the place of the data of steps in its actions."""

        def resolved(row: ActionRow) -> ActionRow:
            target, value = (
                self._resolve(tree, CyclePhase.ACT) if tree is not None else None for tree in (row.target, row.value)
            )
            return replace(
                row, target=target, value=value, statements=tuple(self._resolved(row.statements, CyclePhase.ACT))
            )

        return replace(self._source, rows=tuple(tuple(map(resolved, rows)) for rows in self._source.rows))

    def _add_checks_behind(self, alarms: str) -> None:
        """Append the checks behind the step change: what is left is forgotten before anything reads it."""

        def signal(step: int, event: ActionEvent) -> Callable[[], Expression]:
            return lambda: self._event(step, event)

        forgotten = [each.forgotten(signal(i, ActionEvent.S0)) for i, each in enumerate(self._checks)]
        behind = [each.behind(self._resolve, signal(i, ActionEvent.S1)) for i, each in enumerate(self._checks)]
        left, checked = self._of_steps(forgotten), self._of_steps(behind)
        # checks before the step change miss the steps that it activates: these are checked behind it once more
        entered = [part for part in checked if self._checks[part.step].early]
        late = _all(part for part in checked if part not in entered)
        done = self._of_changed(left, entered) if self._only is not None and len(entered) > 1 else []
        done = [*done, *late] if done else [*_all(left), *_all(checked)]
        self._code.add(self._texts.checks_behind, done, alarms)

    def _of_steps(self, statements: Iterable[list[Statement]]) -> list[StepCode]:
        """Return the code of each step that has some."""
        pairs = zip(self._net.steps, statements, strict=True)
        return [StepCode(step.index, step.path, own) for step, own in pairs if own]

    def _of_active(self, parts: Sequence[StepCode]) -> list[Statement]:
        """Return the code of active steps: one CASE, where one step is active at a time and several have some."""
        if self._only is None or len(parts) < _SEVERAL:
            return _all(parts)
        states, machine = self._only
        return [states.selection(machine.state, self._in_order(parts))]

    def _of_changed(self, left: Sequence[StepCode], entered: Sequence[StepCode]) -> list[Statement]:
        """Return the code of steps that were left and entered, executed while the only state changes."""
        assert self._only is not None  # noqa: S101  # the caller has looked
        states, machine = self._only
        old = states.state_before(machine)
        cases = [states.selection(old, self._in_order(left), machine.state)] if left else []
        cases += [states.selection(machine.state, self._in_order(entered), old)] if entered else []
        return [when(states.changed(), *cases)]

    def _in_order(self, parts: Sequence[StepCode]) -> list[StepCode]:
        """Return the code in the order of the numbers of steps, in which readers look for them."""
        numbers = step_numbers(self._net)
        return sorted(parts, key=lambda each: numbers[each.step])

    # -- what belongs to one step each

    def _add_leaving(self, parts: Sequence[StepCode]) -> None:
        """Append the code of steps that were left."""
        if self._only is not None and len(parts) >= _SEVERAL:
            self._code.add(self._texts.leaving_one, self._of_changed(parts, ()))
            return
        for part in parts:
            self._code.add(self._texts.leaving(part.name), part.statements)

    def _add_acting(self, parts: Sequence[StepCode]) -> None:
        """Append the code of active steps. An inactive step has no event but that it was left."""
        if self._only is not None and len(parts) >= _SEVERAL:
            self._code.add(self._texts.acting_one, self._of_active(parts))
            return
        for part in parts:
            self._code.add(self._texts.acting(part.name), part.statements)

    @property
    def _checked_late(self) -> bool:
        """True if there are no checks before the step change."""
        return not any(check.early for check in self._checks)

    def _alarms(self) -> str:
        """Return the comment on checks: lowered code makes no alarms."""
        lines: list[str] = []
        for step in self._net.steps:
            for check in (step.step.interlock, step.step.supervision):
                texts = (
                    [plain(text, self._texts.culture or "en-US") for text in (check.title, check.alarm)]
                    if check is not None
                    else []
                )
                if any(texts):
                    lines.append(f"{step.path}: {', '.join(filter(None, texts))}")
        return "\n".join(lines)


_SEVERAL = 2


def _all(parts: Iterable[StepCode]) -> list[Statement]:
    return [statement for part in parts for statement in part.statements]
