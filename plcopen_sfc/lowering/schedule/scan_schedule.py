"""Schedule of a scan: the parts of a lowered chart in the order of its execution profile, whatever the encoding."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import NoReturn

from plcopen_sfc.analysis.exclusivity import exclusive
from plcopen_sfc.languages.effects import is_impure
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.actions.action_control import (
    ActionControlCode,
    EarlierSteps,
    SequentialControlCode,
    stepwise_timed,
    timed_alone,
    unknown_before,
)
from plcopen_sfc.lowering.actions.action_execution import (
    StepCode,
    add_actions,
    add_conditions,
)
from plcopen_sfc.lowering.actions.drive_block import DriveBlock, DriveSignal, without_texts
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    Alternative,
    conjunction,
    is_constant,
    names_in,
    when,
    with_distinct,
)
from plcopen_sfc.lowering.code.code_memory import Memory
from plcopen_sfc.lowering.lowering_options import ActionPlace, LoweringRules
from plcopen_sfc.lowering.reading.chart_source import ChartSource
from plcopen_sfc.lowering.reading.step_variables import StepTimers, TimedPart, resolve_steps
from plcopen_sfc.lowering.schedule.added_inputs import ModeInputs, declare_restart
from plcopen_sfc.lowering.schedule.sfc_flag_code import SfcFlagCode
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.charts.transition_firing import testing_order
from plcopen_sfc.semantics.net import Competing, Net, NetTransition
from plcopen_sfc.semantics.profile import ActionControl as Control
from plcopen_sfc.semantics.profile import Profile, ScanOrder


def exclusive_transitions(net: Net, profile: Profile) -> list[tuple[int, ...]]:
    """Return for each transition the competing ones tried before it that keep it from firing when they fire."""
    if profile.competing is Competing.PRIORITY:
        return [transition.competing for transition in net.transitions]
    if not profile.numbered_first:
        return [()] * len(net.transitions)
    tested = testing_order(net)
    numbered = {transition.index for transition in net.transitions if transition.transition.priority is not None}
    return [tuple(i for i in t.competing if i in numbered and tested[i] < tested[t.index]) for t in net.transitions]


def exclude(one: Expression, other: Expression, dialect: Dialect) -> bool:
    """Return True if two conditions can never be TRUE together."""
    if is_constant(one, FALSE) or is_constant(other, FALSE):
        return True
    # conditions without a common name are independent: the prover would only cost time
    if set(names_in(one)).isdisjoint(names_in(other)):
        return False  # each of them can be TRUE, or the prover did not decide
    return bool(exclusive(print_node(one), print_node(other), dialect=dialect).answer)


def firing_together(source: ChartSource, profile: Profile) -> NetTransition | None:
    """Return the first transition that can fire although a competing one before it does; None if there is none."""
    exclusive_ones = exclusive_transitions(source.net, profile)

    def together(one: int, other: int) -> bool:
        executed = source.preparations[one] or source.preparations[other]  # which may change what the second one reads
        conditions = source.conditions[one], source.conditions[other]
        return bool(executed) or any(map(is_impure, conditions)) or not exclude(*conditions, source.dialect)

    for transition in source.net.transitions:
        free = set(transition.competing) - set(exclusive_ones[transition.index])
        if any(together(other, transition.index) for other in free):
            return transition
    return None


def refuse_classic(source: ChartSource, what: str, path: str = "", hint: str = "") -> NoReturn:
    """Raise a `LoweringError`: the classic form has no place for something, found at `path` of the chart.

    `hint`: what to change, where more can be said than that the exact form has it.
    """
    source.refuse(f"the classic form has no place for {what}", hint or "The exact form has.", path)


class ScanSchedule(ABC):
    """Schedule of one scan: its parts in the order of the execution profile, appended to `code`.

    An encoding has an expression for each active step (`active`) and changes the situation (`choose_transitions`,
    `change_situation`). `init`: the condition that sets the sequence back, whatever was chosen, unless it `forgets`
    that. `blocking`: no transition fires meanwhile. `restart`: the condition that the user has asked for.
    """

    def __init__(
        self, source: ChartSource, memory: Memory, rules: LoweringRules, surroundings: Collection[str] = ()
    ) -> None:
        code = memory.code
        self.code, self.memory, self.rules = code, memory, rules
        self.net, self.profile, self.texts = source.net, rules.profile, rules.texts
        self.surroundings = surroundings
        # the order of these declarations is that of the variables in the block, and names are given first come, first
        # served
        self.restart = declare_restart(source, code, rules, surroundings)
        code.declare_helpers(source.helpers)
        # a chart that its schedule starts is restarted by that, too
        init = self.restart if not source.starts_off else None
        self.sfc_flags = SfcFlagCode(source, memory, init)
        self.init: Expression | None = self.sfc_flags.restart
        self.blocking = self.sfc_flags.blocking
        # when conditions of unblocked transitions are evaluated at all
        self.asked: Callable[[], Expression] = self.sfc_flags.is_asked
        self.modes = ModeInputs(source, memory, rules, self.init)
        self.forgets = False
        self.drives: list[DriveBlock] = []
        self.declare_states(source)
        self.signals = {
            self.active(s.index): DriveSignal(self.texts.flag_name(s.step), self.texts.flag_of(s.path))
            for s in self.net.steps
        }
        names = {step.index: self.texts.time_name(step.step) for step in self.net.steps}
        self.times = StepTimers(code, self.active, names.__getitem__, self.timed_part)
        self.source = source
        self._timed_alone: set[int] = set()

    def resolve_steps(self) -> None:
        """Write flags and timers in the place of step variables in the texts of the chart."""
        sequential = self.profile.action_control is Control.SEQUENTIAL
        self._timed_alone = set() if sequential else timed_alone(self.source)
        self.source = resolve_steps(
            *(self.source, self.active, self.times, self.profile, self._may_fire),
            timed=stepwise_timed(self.source) if sequential else (),
            shareable=self._timed_alone,
        )

    def _may_fire(self, condition: Expression, waited: Expression) -> Expression:
        return self.modes.may_fire(self.sfc_flags.may_fire(condition, waited))

    @abstractmethod
    def declare_states(self, source: ChartSource) -> None:
        """Declare the variables that keep the situation."""

    @abstractmethod
    def active(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step, given by its index in the net, is active."""

    def timed_part(self, step: int) -> TimedPart | None:  # noqa: ARG002
        """Return the part of the chart whose steps can have one timer together with this one; None if there is none."""
        return None

    def while_active(self, parts: Sequence[StepCode], suffix: str) -> list[Statement]:
        """Return the statements of the steps that are active. `suffix`: for the names of variables."""
        found: list[Statement] = []
        for step, name, statements in parts:
            found += self.memory.conditional(self.texts.with_suffix(name, suffix), self.active(step), statements)
        return found

    def on_change(self, exits: Sequence[StepCode], entries: Sequence[StepCode]) -> list[Statement]:
        """Return the statements of the steps that were left, then of those that were entered."""
        found: list[Statement] = []
        for step, name, statements in exits:
            left = self.memory.falling(self.texts.with_suffix(name, "exit"), self.active(step), found)
            found += self.memory.conditional(self.texts.with_suffix(name, "left"), left, statements)
        for step, name, statements in entries:
            entered = self.memory.rising(self.texts.with_suffix(name, "entry"), self.active(step), found)
            found += self.memory.conditional(self.texts.with_suffix(name, "entered"), entered, statements)
        return found

    def alternatives(self) -> Alternative | None:
        """Return the expressions of the situation of which no two can be TRUE at once; None if none are known."""
        return None

    def was_active(self, steps: Sequence[int]) -> Expression | None:  # noqa: ARG002
        """Return an expression that is TRUE if one of the steps was active in the last scan.

        None where the code does not keep it. At the start and after a restart none was, unless the profile has it so.
        """
        return None

    def divide(self) -> None:  # noqa: B027
        """Declare what parts of the situation that are not changed at once need of each other."""

    def into_branches(self, begin: int) -> None:  # noqa: B027
        """Move what active steps execute, in networks from `begin` on, to their transitions, where that is the same."""

    def gather(self, begin: int) -> None:  # noqa: B027
        """Put together what single steps do, in networks from `begin` on, where that is shorter."""

    def remember(self) -> None:  # noqa: B027
        """Append what keeps the situation for `was_active` in the next scan."""

    @abstractmethod
    def choose_transitions(self, shared: Sequence[Statement] = ()) -> None:
        """Append the networks that decide which transitions fire, behind statements that they share."""

    @abstractmethod
    def change_situation(self) -> None:
        """Append the networks that change the situation as the transitions want it, if choosing does not."""

    @abstractmethod
    def reentered(self) -> Mapping[int, Expression]:
        """Return, for steps that can be left and entered at once, when they are."""

    @abstractmethod
    def select(self) -> None:
        """Append the selection of a step as the only active one, where `change_situation` does not do that."""

    def chosen(self) -> Sequence[n.Name]:
        """Return the variables that keep, from one scan to the next, which transitions fire."""
        return ()

    @abstractmethod
    def any_fires(self) -> Expression:
        """Return an expression that is TRUE if any transition fires, when it has been chosen which ones do."""

    @property
    def late_edges(self) -> bool:
        """True if nothing needs the edges of flags before what actions remember is ended."""
        return False

    def active_steps(self) -> dict[str, Expression]:
        """Return expressions that are TRUE between two scans while a step is active, by its path."""
        return {step.path: self.active(step.index) for step in self.net.steps}

    def exact(self) -> None:
        """Append one scan, as the chart has it."""
        self.resolve_steps()
        self.divide()
        self.code.add(self.texts.logic, self.source.logic)
        self.select()
        # CODESYS executes the actions of the old situation before it evaluates transitions: the situation chosen in one
        # scan becomes valid at the beginning of the next one
        if self.profile.order is ScanOrder.ACTIONS_FIRST:
            self.sfc_flags.begin(self.times, late_edges=self.late_edges)
            self.forgets = self.sfc_flags.forget(self.chosen())
            self.change_situation()  # what was chosen in the last scan
            # what ends actions and times is known only when all of them are lowered
            place = len(self.code.networks)
            self.code.add(self.texts.times, self.times.calls())
            begin = len(self.code.networks)
            self.add_actions()
            self.sfc_flags.before_transitions()
            self.into_branches(begin)
            self.remember()
            self.sfc_flags.end(place, self.times, [drive.call for drive in self.drives])
            self.choose_transitions()
            self.sfc_flags.report_transition(self.any_fires)
        else:
            # since the last scan only a selection has changed the situation
            changed = self.modes.selecting is not None
            self.code.add(self.texts.times, self.times.calls(changed=changed, ahead=True))
            self.choose_transitions()
            self.change_situation()
            # a timer of a step that was left and entered in one scan has seen no FALSE: it is called twice to start
            # again
            restarts = [s for step, when in self.reentered().items() for s in self.times.restarts(step, when)]
            self.code.add(self.texts.times, [*restarts, *self.times.calls()])
            self.add_actions()
            self.remember()
        self.code.end_first_scan()

    def begin_classic(self) -> None:
        """Append what comes before a textbook sequence: the logic drawn in the chart, and the timers of steps."""
        if self.source.flags:
            flags = ", ".join(sorted(flag.variable for flag in self.source.flags))
            refuse_classic(self.source, f"SFC flags, and the chart uses {flags}")
        self.code.add(self.texts.logic, self.source.logic)
        self.code.add(self.texts.times, self.times.calls())

    def add_actions(self) -> None:
        """Append the code of steps, then the actions, without terms that other ones decide."""
        begin = len(self.code.networks)
        self._add_actions()
        alternatives = self.alternatives()
        if alternatives is None:
            return
        self.code.change(lambda statement: with_distinct(statement, alternatives), begin)
        self.gather(begin)

    def _add_actions(self) -> None:
        self.sfc_flags.report_step(self.while_active)
        self.add_changes()
        self.sfc_flags.watch(self.source.watches, self.active, self.times)
        self.add_main_actions()
        add_conditions(self.source, self.memory, self.active, self.rules)
        ending = self.init if self.init is not None and self.rules.reset_actions else FALSE
        if self.rules.actions is ActionPlace.BLOCK:
            self._add_drive_block(ending)
        else:
            control = self._control(self.memory, ending, self.was_active)
            add_actions(self.source, control, self.rules)

    def add_changes(self) -> None:
        """Append the exit actions of all steps that were left, then the entry actions of those that were entered."""
        exits = [self._part(each.step, each.exit) for each in self.source.step_code if each.exit]
        entries = [self._part(each.step, each.entry) for each in self.source.step_code if each.entry]
        self.code.add(self.texts.step_actions, self.on_change(exits, entries))

    def add_main_actions(self) -> None:
        """Append the code that active steps execute in every scan."""
        for each in self.source.step_code:
            self.code.keep_text(each.main, each.main_text)
        parts = [self._part(each.step, each.main) for each in self.source.step_code if each.main]
        self.code.add(self.texts.main_actions, self.while_active(parts, "main"))

    def _part(self, step: int, statements: Sequence[Statement]) -> StepCode:
        return StepCode(step, self.net.steps[step].step.name, statements)

    def _control(
        self, memory: Memory, ending: Expression, was_active: EarlierSteps = unknown_before
    ) -> ActionControlCode | SequentialControlCode:
        """Return the control of actions in the code of `memory`."""
        if self.profile.action_control is Control.SEQUENTIAL:
            entered = self.profile.initial_steps_entered
            return SequentialControlCode(
                *(self.net, memory, self.times),
                active=self.active,
                ending=ending,
                entered=entered,
                reentered=frozenset(self.reentered()),
                was_active=was_active,
            )
        return ActionControlCode(memory, self.active, ending, was_active, self._time_is_over)

    def _time_is_over(self, step: int, time: Expression) -> n.Operation | None:
        """Return the comparison with the time of a step that has one timer together with others."""
        return self.times.is_over_together(step, time) if step in self._timed_alone else None

    def drive_block(self, wanted: str, beside: Iterable[Statement] = ()) -> DriveBlock:
        """Return a block for actions, which gets the flags of steps and the `signals`; see `DriveBlock`."""
        return DriveBlock(self.source, self.memory, wanted=wanted, signals=self.signals, beside=beside)

    def call(self, drive: DriveBlock) -> n.CallStatement:
        """Return the call of a block that is complete. It holds the actions from now on."""
        self.drives.append(drive)
        drive.finish(self.surroundings)
        return drive.call

    def _add_drive_block(self, ending: Expression) -> None:
        """Append the call of a block with the actions."""
        drive = self.drive_block(self.texts.drive)
        add_actions(without_texts(self.source), self._control(drive.memory, ending), self.rules)
        self.sfc_flags.end_in_block(drive.memory)
        self.code.add(self.texts.drive_call, [self.call(drive)])

    def prepared(self, transition: int, enabled: Expression, free: Sequence[Expression] = ()) -> list[Statement]:
        """Return the statements to execute before the condition of a transition is evaluated, where it is.

        `free`: no competing transition before it fires.
        """
        preparation = self.source.preparations[transition]
        asked = conjunction([enabled, *([] if self.source.evaluates_all else free), self.asked()])
        # blocks with a state in a condition (TON, R_TRIG) are executed only while the tool would evaluate that
        # condition
        if not preparation or is_constant(asked, TRUE):
            return list(preparation)
        return [when(asked, *preparation)]
