"""Encodings with a flag for each step: step bits, and flip-flops.

Both have a bit for each transition, which is computed from the flags of the last scan.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

from plcopen_sfc.analysis.regions import Regions, find_regions
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    Alternative,
    assignment,
    conjunction,
    disjunction,
    is_constant,
    negation,
    when,
)
from plcopen_sfc.lowering.code.lowered_code import CodeNetwork
from plcopen_sfc.lowering.lowering_options import OperatingMode
from plcopen_sfc.lowering.reading.chart_source import ChartSource
from plcopen_sfc.lowering.schedule.scan_schedule import ScanSchedule, exclusive_transitions, firing_together
from plcopen_sfc.semantics.net import NetStep, NetTransition
from plcopen_sfc.semantics.profile import ScanOrder


class Imposed(NamedTuple):
    """Situation that steps get while a condition is TRUE, whatever transitions want; None: a step stays as it is.

    `locks`: transitions may want another one at the same time.
    """

    when: Expression
    situation: Mapping[int, Expression | None]
    locks: bool = True

    def onto(
        self, step: int, sets: Sequence[Expression], resets: Sequence[Expression]
    ) -> tuple[list[Expression], list[Expression]]:
        """Return the set and reset conditions of the flip-flop of a step, which do so without it; reset dominates."""
        if step not in self.situation:
            return [*sets], [*resets]
        value, free = self.situation[step], negation(self.when)
        if value is None:
            return [conjunction([disjunction(sets), free])], [conjunction([disjunction(resets), free])]
        if self.locks and not is_constant(value, FALSE):
            resets = [conjunction([disjunction(resets), free])]
        return [*sets, conjunction([self.when, value])], [*resets, conjunction([self.when, negation(value)])]


class StepFlagEncoding(ScanSchedule):
    """A flag for each step, and a bit for each transition that fires.

    `held`: what counts as active at the beginning of a scan instead of a flag. `captioned`: the comment of a flag has
    the captions of its step, which has no network of its own.
    """

    captioned = False

    def declare_states(self, source: ChartSource) -> None:
        """Declare the flags, those of initial steps TRUE at the start, and the bits of transitions."""
        code, texts = self.code, self.texts
        self.flags: list[Expression] = []
        self.held: Mapping[int, Expression] = {}
        self._before: dict[int, n.Name] = {}
        for step in self.net.steps:
            comment = texts.described_flag(step.step, step.path) if self.captioned else texts.flag_of(step.path)
            initial = not source.starts_off and bool(source.net.initial & step.bit)
            self.flags.append(
                code.declare_flag(texts.flag_name(step.step), step.path, initial=initial, comment=comment)
            )
        self._have_values = code.flags is None or code.flags.have_values
        if not self._have_values and not self.rules.is_classic and not source.starts_off:
            # addresses of S7 have no start values: the first scan sets them
            start = self.memory.conditional("", code.first_scan_pulse(), self.starting())
            code.add(texts.initial_steps, start)
        self.fired = [
            code.declare(texts.transition_name(self.net, each), comment=texts.transition_of(each.path))
            for each in self.net.transitions
        ]

    @property
    def situation(self) -> StepFlagEncoding:
        """Flags, which are the situation."""
        return self

    @property
    def initial_situation(self) -> Mapping[int, Expression]:
        """TRUE for initial steps, FALSE for all others."""
        return {step.index: TRUE if self.net.initial & step.bit else FALSE for step in self.net.steps}

    def name(self, step: int) -> str:
        """Return the name of a flag, also of one that is a member of a data block."""
        flag = self.flags[step]
        if isinstance(flag, n.Member):
            flag = flag.name
        return flag.identifier if isinstance(flag, n.Name) else self.texts.flag_name(self.net.steps[step].step)

    def before(self, step: int) -> n.Name:
        """Return a copy of a flag, to be made as `remembered` has it."""
        if step not in self._before:
            self._before[step] = self.code.declare(self.texts.with_suffix(self.name(step), "old"))
        return self._before[step]

    def remembered(self) -> list[Statement]:
        """Return the copies of flags that are in use; complete after all calls of `before`."""
        return [assignment(copy, self.flags[step]) for step, copy in sorted(self._before.items())]

    def changed(self) -> Expression:
        """Return an expression that is TRUE if any transition fires."""
        return disjunction(self.fired)

    def imposing(self, situation: Mapping[int, Expression | None]) -> list[Statement]:
        """Return the assignments of the flags that impose a situation."""
        return [
            assignment(self.flags[step], value if value is not None else self.before(step))
            for step, value in situation.items()
        ]

    def starting(self) -> list[Statement]:
        """Return the assignments of the initial situation."""
        return self.imposing(self.initial_situation)

    def ending(self) -> list[Statement]:
        """Return the assignments that make all steps inactive."""
        return self.imposing(dict.fromkeys(self.initial_situation, FALSE))

    def active(self, step: int) -> Expression:
        """Return the flag of a step."""
        return self.flags[step]

    def enabled(self, transition: NetTransition) -> Expression:
        """Return the condition that all steps before a transition are active."""
        return conjunction(self.held.get(i, self.flags[i]) for i in transition.sources)

    def alternatives(self) -> Alternative | None:
        """Return the flags of each region: one step of it is active at a time.

        In textbook code neighbours overlap, and flags elsewhere can be written from there.
        """
        regions = find_regions(self.net)
        if self.code.is_textbook or self.code.flags is not None or not self.is_safe or not isinstance(regions, Regions):
            return None
        flags = {flag: (region, flag) for flag, region in zip(self.flags, regions.region_of, strict=True)}
        return flags.get

    def select(self) -> None:
        """Append nothing: `change_situation` does it."""

    def choose_transitions(self, shared: Sequence[Statement] = ()) -> None:
        """Append a bit for each transition: enabled, condition TRUE, and no competing transition before it fires."""
        # without the guard two branches of a selection with TRUE conditions would both become active
        competing = exclusive_transitions(self.net, self.profile)

        parts = [CodeNetwork(self.texts.transitions, tuple(shared))]
        for transition, bit in zip(self.net.transitions, self.fired, strict=True):
            index, enabled = transition.index, self.enabled(transition)
            free = [negation(self.fired[i]) for i in competing[index]]
            free += [negation(each) for each in self.blocking]
            fires = assignment(bit, conjunction([enabled, self.source.conditions[index], *free]))
            title, remark = self.texts.transition_title(transition.path), self.texts.remark(transition.transition)
            parts.append(CodeNetwork(title, (*self.prepared(index, enabled, free), fires), remark))
        self.code.add_each(self.texts.transitions, parts)

    def chosen(self) -> Sequence[n.Name]:
        """Return the bits of the transitions."""
        return self.fired

    def any_fires(self) -> Expression:
        """Return the disjunction of the bits of the transitions."""
        return self.changed()

    @cached_property
    def is_safe(self) -> bool:
        """True if a step that a transition enters is never active already, as the structure of the chart tells."""
        source = self.source
        return firing_together(source, self.profile) is None and isinstance(find_regions(source.net), Regions)

    def reentered(self) -> Mapping[int, Expression]:
        """Return the steps whose time restarts though they are active, by the bits of the transitions.

        They are left and entered in one scan. In a safe chart one transition does both; where it is not known to be
        safe two of them can.
        """
        found: dict[int, Expression] = {}
        for step in range(len(self.net.steps) if self.profile.leaving_restarts_time else 0):
            leaving, entering = self.net.leaving[step], self.net.entering[step]
            # a self-loop: the flag never goes FALSE, so that the timer of the step would run on
            loops = disjunction(self.fired[i] for i in leaving if i in entering)
            both = [disjunction(self.fired[i] for i in side) for side in (leaving, entering)]
            if self.profile.entering_restarts_time:
                both = both[1:]
            again = loops if self.is_safe else disjunction([loops, conjunction(both)])
            if not is_constant(again, FALSE):
                found[step] = again
        return found

    def _selection(self) -> list[Imposed]:
        """Return the selection of a step as the only active one, if steps can be selected."""
        if self.modes.selecting is None:
            return []
        return [Imposed(self.modes.selecting, {i: self.modes.is_selected(i) for i in range(len(self.flags))})]


class StepBitEncoding(StepFlagEncoding):
    """Encoding with step bits: all transitions from the old bits, then all steps from the transitions."""

    captioned = True

    def change_situation(self, entered: Mapping[int, Expression] | None = None) -> None:
        """Append an assignment for each step, then selection and restart, which override the transitions.

        A step is active if a transition enters it, or if it was and none leaves it. This is the rule of evolution
        itself (IEC 60848:2013, rules 4 and 5: what is left and entered at once stays active), so it holds for every
        chart, also for one that is not safe. `entered`: when a step is entered, where that is not by a transition
        before it alone.
        """
        changes: list[Statement] = []
        for step, flag in enumerate(self.flags):
            enters = disjunction(self.fired[i] for i in self.net.entering[step])
            if entered is not None:
                enters = entered.get(step, FALSE)
            leaves = disjunction(self.fired[i] for i in self.net.leaving[step])
            value = disjunction([enters, conjunction([self.held.get(step, flag), negation(leaves)])])
            if value != flag:
                changes.append(assignment(flag, value))
        changes += [when(each.when, *self.imposing(each.situation)) for each in self._selection()]
        self.code.add(self.texts.moves, changes)
        if self.init is not None:
            self.code.add(self.texts.init, [when(self.init, *self.starting())])


class FlipFlopEncoding(StepFlagEncoding):
    """Encoding with one reset-dominant flip-flop and one flag for each step.

    *Exact*: all transitions are computed first, from the flags of the last scan; then each flip-flop is set by the
    transitions that lead to its step and reset by those that leave it, unless one enters it at the same time. As no
    flip-flop reads another, neighbours never overlap and no token runs through. *Classic* is the textbook sequence: set
    by the step before and the condition, reset by the step behind. It differs from the chart; see docs/lowering.md.
    """

    def change_situation(
        self,
        imposed: Sequence[Imposed] = (),
        both_fire: Callable[[NetTransition, NetTransition], bool] | None = None,
        *,
        starts: Expression | None = None,
        order: Iterable[NetStep] | None = None,
    ) -> None:
        """Append a network for each step, in `order`.

        `imposed` are situations besides those of the transitions, the strongest last. `both_fire`: two transitions can
        fire in one scan. `starts`: what sets initial steps first, instead of the first scan.
        """
        # the bits are those of the last scan, chosen before this scan's selection or restart was known
        guarded = self.profile.order is ScanOrder.ACTIONS_FIRST and not self.forgets
        for step in order if order is not None else self.net.steps:
            fire = both_fire if both_fire is not None else lambda *_: not self.is_safe
            set_, reset = self._set_and_reset(step.index, fire)
            for each in imposed:
                set_, reset = each.onto(step.index, set_, reset)
            if self.net.initial & step.bit:
                set_.insert(0, starts if starts is not None else self.memory.starting())
            self._add_step(step, set_, reset, guarded=guarded)

    def _set_and_reset(
        self, step: int, both_fire: Callable[[NetTransition, NetTransition], bool]
    ) -> tuple[list[Expression], list[Expression]]:
        """Return the set and reset conditions of the flip-flop of a step, so that it does the same as a step bit.

        A transition that leaves and enters the step does neither. Activation dominates: the reset by a transition is
        locked where one that enters fires too. `both_fire` tells whether that can be; a lock that can never act is left
        out.
        """
        leaving, entering = (
            [self.net.transitions[i] for i in side[step]] for side in (self.net.leaving, self.net.entering)
        )
        sets: list[Expression] = [self.fired[t.index] for t in entering if t not in leaving]
        by_lock: dict[tuple[Expression, ...], list[Expression]] = {}
        for transition in leaving:
            if transition not in entering:
                lock = tuple(negation(self.fired[t.index]) for t in entering if both_fire(transition, t))
                by_lock.setdefault(lock, []).append(self.fired[transition.index])
        resets = [conjunction([disjunction(fired), *lock]) for lock, fired in by_lock.items()]
        if step in self.held:
            flag, held = self.flags[step], self.held[step]
            sets.append(conjunction([held, negation(flag)]))
            resets.append(conjunction([flag, negation(held), *(negation(self.fired[t.index]) for t in entering)]))
        return sets, resets

    def classic(self) -> None:
        """Append the textbook sequence: step by step, each with the flags as they are at that moment.

        The restart input also starts it first; where there is to be none the first scan does.
        """
        self.resolve_steps()
        # the textbook form has no bits of transitions: each step has the conditions in its own network
        unused = {name.identifier for name in self.fired}
        self.code.variables = [variable for variable in self.code.variables if variable.name not in unused]
        self.begin_classic()
        for step in self.net.steps:
            entering = [self.net.transitions[i] for i in self.net.entering[step.index]]
            before = [statement for t in entering for statement in self.prepared(t.index, self.enabled(t))]
            set_ = [
                conjunction([self.enabled(t), self.source.conditions[t.index], *self._one_at_a_time(t, step)])
                for t in entering
            ]
            if self.rules.init is None and self.net.initial & step.bit:
                set_.insert(0, self.memory.starting() if self._have_values else self.code.first_scan_pulse())
            # the reset by the step behind makes two steps active in one scan, and locks loops of two steps: known
            # faults
            following = {t for i in self.net.leaving[step.index] for t in self.net.transitions[i].targets}
            reset = [self.active(i) for i in sorted(following)]
            remarks = [f"{t.path}: {remark}" for t in entering if (remark := self.texts.remark(t.transition))]
            self._add_step(step, set_, reset, classic=True, before=before, remarks=remarks)
        self.add_actions()
        self.code.end_first_scan()

    def _one_at_a_time(self, transition: NetTransition, step: NetStep) -> list[Expression]:
        """Return that the steps two before are inactive: else one push would run through the whole sequence."""
        if not self.rules.modes & {OperatingMode.SINGLE_STEP, OperatingMode.ADVANCE}:
            return []
        before = {s for i in transition.sources for t in self.net.entering[i] for s in self.net.transitions[t].sources}
        return [negation(self.active(i)) for i in sorted(before - {step.index, *transition.sources})]

    def _add_step(
        self,
        step: NetStep,
        set_: list[Expression],
        reset: list[Expression],
        *,
        guarded: bool = False,
        classic: bool = False,
        before: Sequence[Statement] = (),
        remarks: Sequence[str] = (),
    ) -> None:
        """Append the network of a step, with selection and restart; in their scan what resets may want something else.

        `guarded`: that is so with both of them; in textbook code it is with a selection.
        """
        initial = bool(self.net.initial & step.bit)
        for each in self._selection():
            set_, reset = each._replace(locks=guarded or classic).onto(step.index, set_, reset)
        if self.init is not None:
            back = Imposed(self.init, self.initial_situation, locks=guarded)
            set_, reset = back.onto(step.index, [self.init, *set_] if initial else set_, reset)
        statements: list[Statement] = [*before]
        name = f"FF_{self.texts.flag_name(step.step)}"
        self.memory.latch(name, disjunction(set_), disjunction(reset), statements, self.flags[step.index])
        usual = self.texts.step(step.step, step.path, initial=initial)
        flag = self.name(step.index)
        address = self.code.flags.address_of(flag) if self.code.flags is not None else ""
        # of a flag with an address that is the title
        title, also = (self.texts.flag_title(flag, address), usual) if address else (usual, "")
        comment = "\n".join([*filter(None, [also, self.texts.remark(step.step)]), *remarks])
        self.code.add(title, statements, comment)
