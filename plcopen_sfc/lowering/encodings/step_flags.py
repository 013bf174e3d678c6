"""Encodings with a flag for each step: step bits, and flip-flops.

Both have a bit for each transition, which is computed from the flags of the last scan.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

from plcopen_sfc.analysis.regions import Regions, find_regions
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
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
from plcopen_sfc.semantics.net import Net, NetStep, NetTransition
from plcopen_sfc.semantics.profile import ScanOrder


class StepFlagEncoding(ScanSchedule):
    """A flag for each step, and a bit for each transition that fires."""

    def declare_states(self, source: ChartSource) -> None:
        """Declare the flags, those of initial steps TRUE at the start, and the bits of transitions."""
        self.flags: list[Expression] = []
        self.fired: list[n.Name] = []
        for step in source.net.steps:
            initial = bool(source.net.initial & step.bit)
            comment = self.flag_comment(step)
            name = self.texts.flag_name(step.step)
            self.flags.append(self.code.declare_flag(name, initial=initial, comment=comment))
        if self.code.flags is not None and not self.code.flags.have_values:
            # addresses of S7 have no start values: the first scan sets them
            values = [TRUE if source.net.initial & step.bit else FALSE for step in source.net.steps]
            start = [assignment(flag, value) for flag, value in zip(self.flags, values, strict=True)]
            self.code.add(self.texts.initial_steps, self.memory.conditional("", self.code.first_scan_pulse(), start))
        for transition in source.net.transitions:
            comment = self.texts.transition_of(transition.path)
            name = self.texts.transition_name(source.net, transition)
            self.fired.append(self.code.declare(name, comment=comment))

    def flag_comment(self, step: NetStep) -> str:
        """Return the comment of the flag of a step."""
        return self.texts.flag_of(step.path)

    def active(self, step: int) -> Expression:
        """Return the flag of a step."""
        return self.flags[step]

    def enabled(self, transition: NetTransition) -> Expression:
        """Return the condition that all steps before a transition are active."""
        return conjunction(self.flags[i] for i in transition.sources)

    def select(self) -> None:
        """Append nothing: `change_situation` does it."""

    def choose_transitions(self) -> None:
        """Append a bit for each transition: enabled, condition TRUE, and no competing transition before it fires."""
        parts: list[CodeNetwork] = []
        # without the guard two branches of a selection with TRUE conditions would both become active
        competing = exclusive_transitions(self.net, self.profile)
        for transition in self.net.transitions:
            statements: list[Statement] = []
            enabled = [self.enabled(transition)]
            free = [negation(self.fired[i]) for i in competing[transition.index]]
            free += [negation(each) for each in self.blocking]
            statements += self.prepared(transition.index, conjunction([*enabled, *free]))
            condition = self.source.conditions[transition.index]
            statements.append(assignment(self.fired[transition.index], conjunction([*enabled, condition, *free])))
            title = self.texts.transition_title(transition.path)
            remark = self.texts.remark(transition.transition)
            parts.append(CodeNetwork(title, tuple(statements), remark))
        self.code.add_each(self.texts.transitions, parts)

    def chosen(self) -> Sequence[n.Name]:
        """Return the bits of the transitions."""
        return self.fired

    def any_fires(self) -> Expression:
        """Return the disjunction of the bits of the transitions."""
        return disjunction(self.fired)

    @cached_property
    def is_safe(self) -> bool:
        """True if a step that a transition enters is never active already, as its structure tells."""
        return firing_together(self.source, self.profile) is None and isinstance(find_regions(self.net), Regions)

    def reentered(self) -> Mapping[int, Expression]:
        """Return the steps whose time restarts though they are active, by the bits of the transitions.

        They are left and entered in one scan. In a safe chart one transition does both; where it is not known to be
        safe two of them can.
        """
        found: dict[int, Expression] = {}
        for step in range(len(self.net.steps)):
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


def next_situation(
    net: Net,
    flags: Sequence[Expression],
    fired: Sequence[Expression],
    *,
    held: Mapping[int, Expression] = MappingProxyType({}),
    entered: Mapping[int, Expression] | None = None,
) -> list[Statement]:
    """Return an assignment for each step: it is active if a transition enters it, or if it was and none leaves it.

    This is the rule of evolution itself (IEC 60848:2013, rules 4 and 5: what is left and entered at once stays active),
    so it holds for every chart, also for one that is not safe. `held`: what counts as active before instead of the
    flag. `entered`: when a step is entered, where that is not by a transition before it alone.
    """
    found: list[Statement] = []
    for step, flag in enumerate(flags):
        enters = disjunction(fired[i] for i in net.entering[step])
        if entered is not None:
            enters = entered.get(step, FALSE)
        leaves = disjunction(fired[i] for i in net.leaving[step])
        value = disjunction([enters, conjunction([held.get(step, flag), negation(leaves)])])
        if value != flag:
            found.append(assignment(flag, value))
    return found


class StepBitEncoding(StepFlagEncoding):
    """Encoding with step bits: all transitions from the old bits, then all steps from the transitions."""

    def flag_comment(self, step: NetStep) -> str:
        """Return the comment of a flag with the captions of the step, which has no network of its own."""
        return self.texts.described_flag(step.step, step.path)

    def change_situation(self) -> None:
        """Append an assignment for each step, then selection and restart, which override the transitions."""
        changes = next_situation(self.net, self.flags, self.fired)
        if self.modes.selecting is not None:
            chosen = [assignment(flag, self.modes.is_selected(step)) for step, flag in enumerate(self.flags)]
            changes.append(when(self.modes.selecting, *chosen))
        self.code.add(self.texts.moves, changes)
        if self.init is not None:
            initial = [TRUE if self.net.initial & step.bit else FALSE for step in self.net.steps]
            back = [assignment(flag, value) for flag, value in zip(self.flags, initial, strict=True)]
            self.code.add(self.texts.init, [when(self.init, *back)])


class FlipFlopEncoding(StepFlagEncoding):
    """Encoding with one reset-dominant flip-flop and one flag for each step.

    *Exact*: all transitions are computed first, from the flags of the last scan; then each flip-flop is set by the
    transitions that lead to its step and reset by those that leave it, unless one enters it at the same time. As no
    flip-flop reads another, neighbours never overlap and no token runs through. *Classic* is the textbook sequence: set
    by the step before and the condition, reset by the step behind. It differs from the chart; see docs/lowering.md.
    """

    def change_situation(self) -> None:
        """Append a network for each step."""
        for step in self.net.steps:
            entering, leaving = self.net.entering[step.index], self.net.leaving[step.index]
            loops = set(entering) & set(leaving)  # such a step stays active: neither set nor reset
            set_: list[Expression] = [self.fired[i] for i in entering if i not in loops]
            if self.net.initial & step.bit:
                set_.insert(0, self.memory.starting())
            reset: list[Expression] = [self.fired[i] for i in leaving if i not in loops]
            if not self.is_safe:  # what is left and entered at once stays active
                entered = [negation(self.fired[i]) for i in entering]
                reset = [conjunction([disjunction(reset), *entered])] if reset else []
            # the bits are those of the last scan, chosen before this scan's selection or restart was known
            guarded = self.profile.order is ScanOrder.ACTIONS_FIRST and not self.forgets
            self._add_step(step, set_, reset, guarded=guarded)

    def classic(self) -> None:
        """Append the textbook sequence: step by step, each with the flags as they are at that moment.

        The restart input also starts it first; where there is to be none the first scan does.
        """
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
                set_.insert(0, self.memory.starting())
            # the reset by the step behind makes two steps active in one scan, and locks loops of two steps: known
            # faults
            following = {t for i in self.net.leaving[step.index] for t in self.net.transitions[i].targets}
            reset = [self.active(i) for i in sorted(following)]
            remarks = [f"{t.path}: {remark}" for t in entering if (remark := self.texts.remark(t.transition))]
            self._add_step(step, set_, reset, classic=True, before=before, remarks=remarks)
        self.add_actions()
        self.memory.finish(self.texts.first_scan)

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
        initial = bool(self.net.initial & step.bit)
        selecting = self.modes.selecting
        if selecting is not None:
            is_selected = self.modes.is_selected(step.index)
            set_ = [*set_, conjunction([selecting, is_selected])]
            others = conjunction([selecting, negation(is_selected)])
            if guarded or classic:  # in this scan no transition fires, but what resets does not know
                reset = [conjunction([disjunction(reset), negation(selecting)])]
            reset = [*reset, others]
        if self.init is not None:
            set_, reset = ([self.init, *set_], reset) if initial else (set_, [*reset, self.init])
            if initial and reset and guarded:  # transitions of the last scan, chosen before the restart
                reset = [conjunction([disjunction(reset), negation(self.init)])]
        flag = self.flags[step.index]
        statements: list[Statement] = [*before]
        name = f"FF_{self.texts.flag_name(step.step)}"
        self.memory.latch(name, disjunction(set_), disjunction(reset), statements, flag)
        comment = "\n".join([*filter(None, [self.texts.remark(step.step)]), *remarks])
        self.code.add(self.texts.step(step.step, step.path, initial=initial), statements, comment)
