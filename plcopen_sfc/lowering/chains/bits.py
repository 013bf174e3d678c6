"""Step bits in two phases: all transitions from the old bits, then all resets, then all sets.

This is the rule of evolution itself (IEC 60848:2013, rules 4 and 5: what is left and entered at once stays active), so
it holds for every chart, also for one that is not safe.
"""

from __future__ import annotations

from plcopen_sfc.languages.st.nodes import Statement
from plcopen_sfc.lowering.chains.steps import StepFlags
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, assignment, conjunction, negation, when
from plcopen_sfc.semantics.net import NetStep
from plcopen_sfc.semantics.profile import ScanOrder


class StepBits(StepFlags):
    """Lowers one chart into `code`."""

    def flag_comment(self, step: NetStep) -> str:
        """With what the chart says of the step: it has no network of its own."""
        remark = " ".join(self.texts.remark(step.step).split())
        return ": ".join(filter(None, [self.texts.flag_of(step.path), remark]))

    def move(self) -> None:
        """Append all resets, then all sets."""
        # transitions of the last scan are forgotten where the chain is to start anew now
        late = self.profile.order is ScanOrder.ACTIONS_FIRST and not self.forgets
        free = [negation(self.init)] if self.init is not None and late else []
        resets: list[Statement] = []
        sets: list[Statement] = []
        for transition in self.net.transitions:
            flag = self.fired[transition.index]
            leaving = [assignment(self.flags[i], FALSE) for i in transition.sources]
            entering = [assignment(self.flags[i], TRUE) for i in transition.targets]
            resets += [when(flag, *leaving)] if leaving else []
            sets += [when(conjunction([flag, *free]), *entering)] if entering else []
        if self.init is not None:
            resets.append(when(self.init, *(assignment(flag, FALSE) for flag in self.flags)))
            initial = [self.flags[s.index] for s in self.net.steps if self.net.initial & s.bit]
            sets.append(when(self.init, *(assignment(flag, TRUE) for flag in initial)))
        if self.modes.selecting is not None:
            chosen = [assignment(flag, self.modes.is_selected(step)) for step, flag in enumerate(self.flags)]
            sets.append(when(self.modes.selecting, *chosen))
        self.code.add(self.texts.resets, resets)
        self.code.add(self.texts.sets, sets)
