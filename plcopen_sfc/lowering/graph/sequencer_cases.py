"""A sequencer as CASEs: whether one can hold it, and the code of single steps in the branches of one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import chain

from plcopen_sfc.analysis.regions import Regions
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.boolean_logic import TRUE, conjunction, is_constant, negation, when
from plcopen_sfc.lowering.code.code_bodies import indented, spaced
from plcopen_sfc.lowering.code.lowered_code import LoweredCode, TextNetwork
from plcopen_sfc.lowering.encodings.case_encodings import one_step_at_a_time
from plcopen_sfc.lowering.encodings.case_states import StateVariables, one_region, regions_of
from plcopen_sfc.lowering.graph.sequencer_actions import SequencerStepCode
from plcopen_sfc.lowering.graph.sequencer_source import GraphSource
from plcopen_sfc.lowering.lowering_options import Construction
from plcopen_sfc.lowering.reading.chart_source import step_numbers
from plcopen_sfc.lowering.schedule.scan_schedule import firing_together
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import Profile

ON_BY_HAND = "S_ON"
"""The parameter that switches a step on whatever others are active."""


def one_sequence(source: GraphSource, profile: Profile) -> Regions | str:
    """Return all steps as one region, or in words why a CASE cannot hold them."""
    return several_steps(source, profile) or one_step_at_a_time(source) or one_region(source.net)


def sequences(source: GraphSource, profile: Profile) -> Regions | str:
    """Return a region for each sequence and each simultaneous branch, or in words why CASEs cannot hold them."""
    objection = several_steps(source, profile)
    if objection:
        return objection
    if source.skips and any(len(t.sources) != 1 or len(t.targets) > 1 for t in source.net.transitions):
        return "steps can be skipped, and there are simultaneous branches"
    return regions_of(source.region_net)


def several_steps(source: GraphSource, profile: Profile) -> str:
    """Return why several steps of a sequence can be active whatever its structure is; empty if they cannot."""
    if not source.net.initial:
        return "no step is initial"
    for step in source.net.steps:
        for row in source.rows[step.index]:
            if row.qualifier is Qualifier.ON:
                return f"step {step.path} switches steps on: {row.name}"
            if row.switched:
                return f"step {step.path} switches steps off: {row.name}"
    if on_by_hand(source):
        return f"{ON_BY_HAND} can switch on a step while another one is active"
    other = firing_together(source, profile)
    if other is not None:
        return f"transition {other.path} fires together with competing transitions under the profile {profile.name}"
    loops = (t.path for t in source.net.transitions if set(t.sources) & set(t.targets))
    if source.skips and (loop := next(loops, None)) is not None:
        return f"steps can be skipped, and transition {loop} leads back to its own step"
    return ""


def without_switching_by_hand(source: GraphSource) -> GraphSource:
    """Return the same without the switching of steps by hand."""
    return replace(source, parameters={k: v for k, v in source.parameters.items() if k != ON_BY_HAND})


def refuse_several_steps(source: GraphSource, wanted: Construction, profile: Profile) -> None:
    """Raise `LoweringError` where CASEs are wanted, and several steps that share one can be active."""
    found = {Construction.CASE: one_sequence, Construction.REGIONS: sequences}.get(wanted)
    objection = found(source, profile) if found is not None else None
    if isinstance(objection, str):
        hint = "Step bits can hold every sequencer."
        if on_by_hand(source):
            hint += f" Where {ON_BY_HAND} is never operated, leave it inactive: at_rest=['{ON_BY_HAND}'], --at-rest."
        raise LoweringError(
            f"a CASE holds one active step, and that is not so here: {objection}",
            location=Location(path=source.pou.name),
            hint=hint,
        )


def on_by_hand(source: GraphSource) -> bool:
    """Return True if the parameters of the block can switch steps on."""
    return not source.locked and {"SW_MAN", "S_SEL", ON_BY_HAND} <= set(source.parameters)


class StepCases:
    """Code of single steps in CASEs on the one state variable of a sequencer, without what a branch implies."""

    def __init__(self, states: StateVariables, net: Net) -> None:
        self._states, self._net = states, net
        self.machine, self.text = states.machines[0], states.text

    def while_active(self, parts: Sequence[SequencerStepCode]) -> list[str]:
        """Return a CASE with what active steps do."""
        return self._case(parts, self.machine.state, lambda step: [self._states.active(step)])

    def when_changed(
        self, left: Sequence[SequencerStepCode] = (), entered: Sequence[SequencerStepCode] = ()
    ) -> list[str]:
        """Return a CASE each with what is done when steps are left and entered, executed while the state changes."""
        now, before = self._states.active, self._states.before
        lines: list[str] = []
        if left:
            old = self._states.state_before(self.machine)
            lines += self._case(left, old, lambda step: [before(step), negation(now(step))])
        if entered:
            lines += self._case(entered, self.machine.state, lambda step: [now(step), negation(before(step))])
        return [f"IF {self.text(self._states.changed())} THEN", *indented(lines), "END_IF;"]

    def add(
        self, code: LoweredCode, title: str, before: Sequence[Statement], lines: Sequence[str], comment: str = ""
    ) -> None:
        """Append lines as a network, behind statements."""
        code.networks.append(TextNetwork(title, "\n".join([*map(self.text, before), *lines]), comment))

    def _case(
        self, parts: Sequence[SequencerStepCode], selector: n.Name, known: Callable[[int], list[Expression]]
    ) -> list[str]:
        branches: list[list[str]] = []
        numbers = step_numbers(self._net)
        for step, statements in sorted(parts, key=lambda each: numbers[each.step.index]):
            implied = known(step.index)
            left = n.Statements(tuple(chain.from_iterable(_without(implied, each) for each in statements)))
            label, heading = self._states.names.step(step.index), self._states.heading(step)
            branches.append(self._states.branch(label, heading, self.text(left).splitlines()))
        return [f"CASE {self.text(selector)} OF", *spaced(branches), "END_CASE;"]


def _without(known: Sequence[Expression], statement: Statement) -> tuple[Statement, ...]:
    """Return a statement without the conditions that are known to be satisfied."""
    match statement:
        # the branch of the CASE implies these operands
        case n.If((n.Branch(n.Operation(n.Operator.AND, operands), statements),), None):
            rest = conjunction(operand for operand in operands if operand not in known)
            return statements if is_constant(rest, TRUE) else (when(rest, *statements),)
        case n.If((n.Branch(condition, statements),), None) if condition in known:
            return statements
    return (statement,)
