"""What the lowerings with a flag for each step have in common: the flags and the transition bits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

from plcopen_sfc.analysis.regions import Regions, find_regions
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.chains.chain import Chain
from plcopen_sfc.lowering.chains.rivals import exclusive_rivals, firing_together
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, assignment, conjunction, disjunction, is_constant, negation
from plcopen_sfc.lowering.code.program import CodeNetwork
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.semantics.net import NetStep, NetTransition


class StepFlags(Chain):
    """A flag for each step, and a bit for each transition that fires."""

    def declare_states(self, source: ChartSource) -> None:
        """The flags, those of initial steps TRUE at the start."""
        self.flags: list[Expression] = []
        self.fired: list[n.Name] = []
        for step in source.net.steps:
            initial = bool(source.net.initial & step.bit)
            comment = self.flag_comment(step)
            name = self.texts.flag_name(step.step)
            self.flags.append(self.code.declare_flag(name, initial=initial, comment=comment))
        if self.code.flags is not None and not self.code.flags.have_values:
            values = [TRUE if source.net.initial & step.bit else FALSE for step in source.net.steps]
            start = [assignment(flag, value) for flag, value in zip(self.flags, values, strict=True)]
            self.code.add(self.texts.initial_steps, self.memory.conditional("", self.code.first_scan_pulse(), start))
        for transition in source.net.transitions:
            comment = self.texts.transition_of(transition.path)
            name = self.texts.transition_name(source.net, transition)
            self.fired.append(self.code.declare(name, comment=comment))

    def flag_comment(self, step: NetStep) -> str:
        """What is said of the flag of a step where it is declared."""
        return self.texts.flag_of(step.path)

    def active(self, step: int) -> Expression:
        """The flag of a step."""
        return self.flags[step]

    def enabled(self, transition: NetTransition) -> Expression:
        """All its steps are active."""
        return conjunction(self.flags[i] for i in transition.sources)

    def select(self) -> None:
        """Nothing: moving does it."""

    def choose(self) -> None:
        """Append a bit for each transition: enabled, its condition TRUE, and no rival before it has fired."""
        parts: list[CodeNetwork] = []
        rivals = exclusive_rivals(self.net, self.profile)
        for transition in self.net.transitions:
            statements: list[Statement] = []
            enabled = [self.enabled(transition)]
            free = [negation(self.fired[i]) for i in rivals[transition.index]]
            free += [negation(each) for each in self.blocking]
            statements += self.prepared(transition.index, conjunction([*enabled, *free]))
            condition = self.source.conditions[transition.index]
            statements.append(assignment(self.fired[transition.index], conjunction([*enabled, condition, *free])))
            title = self.texts.transition_title(transition.path)
            remark = self.texts.remark(transition.transition)
            parts.append(CodeNetwork(title, tuple(statements), remark))
        self.code.add_each(self.texts.transitions, parts)

    def chosen(self) -> Sequence[n.Name]:
        """The bits of the transitions."""
        return self.fired

    def any_fires(self) -> Expression:
        """Any of the bits of the transitions."""
        return disjunction(self.fired)

    @cached_property
    def is_safe(self) -> bool:
        """Whether a step that a transition enters is never active already, as its structure tells."""
        return firing_together(self.net, self.profile) is None and isinstance(find_regions(self.net), Regions)

    def reentered(self) -> Mapping[int, Expression]:
        """Steps whose time starts anew though they are active, by the bits of the transitions.

        They are left and entered in one scan. In a safe chart one transition does both; where it is not known to be
        safe two of them can.
        """
        found: dict[int, Expression] = {}
        for step in range(len(self.net.steps)):
            leaving, entering = self.net.leaving[step], self.net.entering[step]
            loops = disjunction(self.fired[i] for i in leaving if i in entering)
            both = [disjunction(self.fired[i] for i in side) for side in (leaving, entering)]
            if self.profile.entering_restarts_time:
                both = both[1:]
            again = loops if self.is_safe else disjunction([loops, conjunction(both)])
            if not is_constant(again, FALSE):
                found[step] = again
        return found
