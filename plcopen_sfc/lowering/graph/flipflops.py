"""Sequencers with a reset-dominant flip-flop for each step."""

from __future__ import annotations

from functools import cached_property

from plcopen_sfc.analysis.regions import Regions, find_regions
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.logic import FALSE, assignment, conjunction, disjunction, equal, is_constant, negation
from plcopen_sfc.lowering.graph.bits import BitSequencer
from plcopen_sfc.semantics.charts.graph.parameters import Mode
from plcopen_sfc.semantics.net import NetStep


class FlipFlopSequencer(BitSequencer):
    """Lowers one sequencer into `code`."""

    def exact(self) -> None:
        """One cycle, in statements that networks can have."""
        if self.source.skips:
            self._refuse("steps that are skipped need a loop, which networks do not have")
        super().exact()

    def _refuse(self, message: str) -> None:
        raise LoweringError(message, location=Location(path=self.source.pou.name))

    def flag_comment(self, step: NetStep) -> str:
        """What is said of the flag of a step; what the chart says of that stands at its flip-flop."""
        return self.texts.flag_of(step.path)

    def add_step_change(self) -> None:
        """Append a network for each step."""
        for step in self.net.steps:
            self._add_flip_flop(step)
        self.code.add(self.texts.first_scan, [assignment(self.first, FALSE)])

    def _add_flip_flop(self, step: NetStep) -> None:
        entering, leaving = self.net.entering[step.index], self.net.leaving[step.index]
        loops = set(entering) & set(leaving)
        set_: list[Expression] = [self.fired[i] for i in entering if i not in loops]
        left = disjunction(self.fired[i] for i in leaving if i not in loops)
        # what is left and entered at once stays active
        reset = left if self._is_safe else conjunction([left, *(negation(self.fired[i]) for i in entering)])
        start = disjunction([self.first, self.started()])
        initial = bool(self.net.initial & step.bit)
        if initial:
            set_.insert(0, start)
            reset = conjunction([reset, negation(start)])
        wanted = self.wanted.get(step.index)
        if wanted is not None:
            flag = self.flags[step.index]
            set_.append(conjunction([wanted, negation(flag)]))
            off = conjunction([flag, negation(wanted), *(negation(self.fired[i]) for i in entering)])
            reset = disjunction([reset, conjunction([off, *([negation(start)] if initial else [])])])
        off_by_hand = self._by_hand("S_OFF", step)
        if initial:  # the start comes behind the switching by hand
            off_by_hand = conjunction([off_by_hand, negation(start)])
        resets = [reset, off_by_hand, *([] if initial else [start]), self.commands.edge("OFF_SQ")]
        set_.append(self._by_hand("S_ON", step))
        statements: list[Statement] = []
        name = f"FF_{self.signs[step.index].name}"
        self.memory.latch(name, disjunction(set_), disjunction(resets), statements, self.flags[step.index])
        title = self.texts.step(step.step, step.path, initial=initial)
        self.code.add(title, statements, self.texts.remark(step.step))

    @cached_property
    def _is_safe(self) -> bool:
        """Whether a step that a transition enters is never active already: nothing else switches steps on."""
        switched = self.wanted or not is_constant(self.commands.is_on(Mode.MANUAL), FALSE)
        return not switched and isinstance(find_regions(self.net), Regions)

    def _by_hand(self, command: str, step: NetStep) -> Expression:
        """Whether a command by hand means a step."""
        selection, number = self.commands.variable("S_SEL"), step.step.number
        by_hand = self.commands.is_on(Mode.MANUAL)
        first = next((s.index for s in self.net.steps if s.step.number == number), None)
        if selection is None or number is None or first != step.index or is_constant(by_hand, FALSE):
            return FALSE
        return conjunction([by_hand, self.commands.edge(command), equal(selection, n.Literal(str(number)))])
