"""Step bits in two phases: all transitions from the old bits, then all resets, then all sets.

This is the rule of evolution itself (IEC 60848:2013, rules 4 and 5: what is left and entered at once stays active), so
it holds for every chart, also for one that is not safe.
"""

from __future__ import annotations

from plcopen_sfc.languages.st.nodes import Statement
from plcopen_sfc.lowering.chains.steps import StepFlags
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, assignment, when
from plcopen_sfc.semantics.net import NetStep


class StepBits(StepFlags):
    """Lowers one chart into `code`."""

    def flag_comment(self, step: NetStep) -> str:
        """With what the chart says of the step: it has no network of its own."""
        return self.texts.described_flag(step.step, step.path)

    def move(self) -> None:
        """Append all resets, then all sets, and what is stronger than the transitions behind them."""
        resets: list[Statement] = []
        sets: list[Statement] = []
        for transition in self.net.transitions:
            flag = self.fired[transition.index]
            leaving = [assignment(self.flags[i], FALSE) for i in transition.sources]
            entering = [assignment(self.flags[i], TRUE) for i in transition.targets]
            resets += [when(flag, *leaving)] if leaving else []
            sets += [when(flag, *entering)] if entering else []
        if self.modes.selecting is not None:
            chosen = [assignment(flag, self.modes.is_selected(step)) for step, flag in enumerate(self.flags)]
            sets.append(when(self.modes.selecting, *chosen))
        self.code.add(self.texts.resets, resets)
        self.code.add(self.texts.sets, sets)
        if self.init is not None:
            initial = [TRUE if self.net.initial & step.bit else FALSE for step in self.net.steps]
            back = [assignment(flag, value) for flag, value in zip(self.flags, initial, strict=True)]
            self.code.add(self.texts.init, [when(self.init, *back)])
