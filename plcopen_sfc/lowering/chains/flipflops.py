"""Flip-flop chains: one reset-dominant flip-flop and one flag for each step.

*Exact*: all transitions are computed first, from the flags of the last scan; then each flip-flop is set by the
transitions that lead to its step and reset by those that leave it, unless one enters it at the same time. As no
flip-flop reads another, neighbours never overlap and no token runs through. *Classic* is the textbook chain: set by
the step before and the condition, reset by the step behind. It does something else than the chart; see
docs/lowering.md.
"""

from __future__ import annotations

from collections.abc import Sequence

from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.chains.steps import StepFlags
from plcopen_sfc.lowering.code.logic import conjunction, disjunction, negation
from plcopen_sfc.lowering.rules import OperatingMode
from plcopen_sfc.semantics.net import NetStep, NetTransition
from plcopen_sfc.semantics.profile import ScanOrder


class FlipFlopChain(StepFlags):
    """Lowers one chart into `code`."""

    def move(self) -> None:
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
            guarded = self.profile.order is ScanOrder.ACTIONS_FIRST and not self.forgets
            self._add_step(step, set_, reset, guarded=guarded)

    def classic(self) -> None:
        """The textbook chain: steps one after the other, each looks at the flags as they are at that moment.

        The input for starting anew also starts it first; where there is to be none the first scan does.
        """
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
            following = {t for i in self.net.leaving[step.index] for t in self.net.transitions[i].targets}
            reset = [self.active(i) for i in sorted(following)]
            remarks = [f"{t.path}: {remark}" for t in entering if (remark := self.texts.remark(t.transition))]
            self._add_step(step, set_, reset, classic=True, before=before, remarks=remarks)
        self.add_actions()
        self.memory.finish(self.texts.first_scan)

    def _one_at_a_time(self, transition: NetTransition, step: NetStep) -> list[Expression]:
        """That the steps before those of the transition are left: else a push would lead through the whole chain."""
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
            if initial and reset and guarded:  # transitions of the last scan, when nobody wanted to start anew yet
                reset = [conjunction([disjunction(reset), negation(self.init)])]
        flag = self.flags[step.index]
        statements: list[Statement] = [*before]
        name = f"FF_{self.texts.flag_name(step.step)}"
        self.memory.latch(name, disjunction(set_), disjunction(reset), statements, flag)
        comment = "\n".join([*filter(None, [self.texts.remark(step.step)]), *remarks])
        self.code.add(self.texts.step(step.step, step.path, initial=initial), statements, comment)
