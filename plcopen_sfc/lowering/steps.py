"""What the lowerings with a flag for each step have in common: the flags, the transition bits, the actions."""

from __future__ import annotations

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.lowering.code import Code
from plcopen_sfc.lowering.control import ActionControl, add_actions
from plcopen_sfc.lowering.logic import assignment, conjunction, negation
from plcopen_sfc.lowering.memory import Memory
from plcopen_sfc.lowering.references import resolve_steps
from plcopen_sfc.lowering.rules import LoweringRules
from plcopen_sfc.lowering.source import ChartSource
from plcopen_sfc.semantics.net import NetStep, NetTransition, Rivals


class StepFlags:
    """The flags of the steps of one chart, and what is made of them in `code`."""

    def __init__(self, source: ChartSource, code: Code, memory: Memory, rules: LoweringRules) -> None:
        self.code, self.memory, self.rules = code, memory, rules
        self.net, self.profile, self.texts = source.net, rules.profile, rules.texts
        self.init = code.declare_input(rules.init, rules.texts.init) if rules.init is not None else None
        self.flags: tuple[n.Name, ...] = tuple(self._declare(step) for step in self.net.steps)
        self.source = resolve_steps(source, self.flags.__getitem__, rules.profile)

    def enabled(self, transition: NetTransition) -> Expression:
        """All its steps are active and its condition is TRUE."""
        sources = [self.flags[i] for i in transition.sources]
        return conjunction([*sources, self.source.conditions[transition.index]])

    def add_transitions(self) -> list[n.Name]:
        """Append a bit for each transition: enabled, and no rival before it has fired."""
        fired: list[n.Name] = []
        statements = list(self.source.before)
        for transition in self.net.transitions:
            comment = self.texts.transition_of(transition.path)
            flag = self.code.declare(f"T{transition.index + 1}", comment=comment)
            rivals = transition.rivals if self.profile.rivals is Rivals.PRIORITY else ()
            parts = [self.enabled(transition), *(negation(fired[i]) for i in rivals)]
            if self.init is not None:
                parts.append(negation(self.init))
            statements.append(assignment(flag, conjunction(parts)))
            fired.append(flag)
        self.code.add(self.texts.transitions, statements)
        return fired

    def add_actions(self) -> None:
        """Append the networks of the actions."""
        control = ActionControl(self.memory, self.flags.__getitem__)
        add_actions(self.source, self.code, control, self.rules)

    def _declare(self, step: NetStep) -> n.Name:
        initial = "TRUE" if self.net.initial & step.bit else None
        comment = self.texts.flag_of(step.path)
        return self.code.declare(self.texts.flag_name(step.step), initial=initial, comment=comment)
