"""Encodings of a sequencer with a CASE for each sequence and each simultaneous branch with at most one active step."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

from plcopen_sfc.analysis.regions import ParallelBlock, Region, Regions
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    equal,
    is_constant,
    negation,
    when,
)
from plcopen_sfc.lowering.code.code_bodies import indented, spaced
from plcopen_sfc.lowering.code.lowered_code import TextNetwork
from plcopen_sfc.lowering.encodings.case_encodings import one_step_at_a_time
from plcopen_sfc.lowering.encodings.case_states import (
    RegionState,
    StateNames,
    StateVariables,
    TriedTransition,
    one_region,
    regions_of,
)
from plcopen_sfc.lowering.graph.sequencer_actions import SequencerActions, SequencerStepCode
from plcopen_sfc.lowering.graph.sequencer_scan import Sequencer
from plcopen_sfc.lowering.graph.sequencer_source import CyclePhase, GraphSource
from plcopen_sfc.lowering.lowering_options import States
from plcopen_sfc.lowering.reading.chart_source import step_numbers
from plcopen_sfc.lowering.schedule.scan_schedule import firing_together
from plcopen_sfc.model.actions import ActionEvent, Qualifier
from plcopen_sfc.semantics.charts.graph.graph_parameters import Mode
from plcopen_sfc.semantics.net import Net, NetStep, NetTransition
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
    found = regions_of(_endless(source.net))
    return found if isinstance(found, str) else replace(found, net=source.net)


def _endless(net: Net) -> Net:
    """Return the same net, but the end of a sequence or a branch leads back to its own step: regions do not differ."""
    transitions = (replace(t, targets=t.targets or t.sources) if len(t.sources) == 1 else t for t in net.transitions)
    return replace(net, transitions=tuple(transitions))


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


def on_by_hand(source: GraphSource) -> bool:
    """Return True if the parameters of the block can switch steps on."""
    return not source.locked and {"SW_MAN", "S_SEL", ON_BY_HAND} <= set(source.parameters)


_LARGEST_INT = 32_767


class _Selected(NamedTuple):
    """Selector of a CASE, and the expressions that are known in the branch of a step."""

    selector: Expression
    known: list[Expression]


class RegionSequencer(Sequencer):
    """Encoding of a sequencer with CASEs. Raises `LoweringError` where several steps of a region can be active."""

    def declare_states(self, surroundings: Collection[str]) -> Sequence[str]:
        """Declare a state variable for each region, at the start that of no step."""
        regions = self.structure()
        if isinstance(regions, str):
            hint = "Step bits can hold every sequencer."
            if on_by_hand(self.source):
                hint += (
                    f" Where {ON_BY_HAND} is never operated, leave it inactive: at_rest=['{ON_BY_HAND}'], --at-rest."
                )
            raise LoweringError(
                f"a CASE holds one active step, and that is not so here: {regions}",
                location=Location(path=self.source.pou.name),
                hint=hint,
            )
        regions = replace(regions, regions=tuple(self._in_order(region) for region in regions.regions))
        # a block of S7-GRAPH starts in its first cycle, by a command or by itself: before that no step is active
        off = replace(regions, regions=tuple(replace(region, initial=None) for region in regions.regions))
        names = StateNames(self.source, off, self.code, self.rules, surroundings)
        self.states = StateVariables(regions, names, self.texts, self.source.dialect, off=True)
        self._gone: dict[int, n.Name] = {}
        self._bits: dict[int, n.Name] = {}
        self._before: dict[int, tuple[Statement, ...]] = {}
        self._conditions: dict[int, Expression] = {}
        self._guard: Expression = TRUE
        self._change = 0
        return [self.texts.flag_name(step.step) for step in self.net.steps]

    def _in_order(self, region: Region) -> Region:
        """Return the same with its steps in the order of their numbers, as readers look for them."""
        numbers = step_numbers(self.net)
        return replace(region, steps=tuple(sorted(region.steps, key=numbers.__getitem__)))

    def structure(self) -> Regions | str:
        """Return the regions, or why there are none."""
        return sequences(self.source, self.rules.profile)

    def active(self, step: int) -> Expression:
        """Return a comparison of the state of its region."""
        return self.states.active(step)

    def add_switched(self, actions: SequencerActions) -> None:
        """Append nothing: no action switches steps."""

    def only_state(self) -> n.Name | None:
        """Return the number of the active step, 0 where none is, if all steps are of one region and have numbers."""
        numbers = step_numbers(self.net)
        if len(self.states.machines) > 1 or max(numbers) > _LARGEST_INT:
            return None
        machine = self.states.machines[0]
        return machine.state if self._has_numbers_of_steps(machine) else None

    def _has_numbers_of_steps(self, machine: RegionState) -> bool:
        """Return True if the states of a region are the numbers that its steps have for the user."""
        numbers = step_numbers(self.net)
        # S_NO shows the number that the user knows, and 0 where no step is active
        own = all(self.net.steps[i].step.number == numbers[i] != 0 for i in machine.region.steps)
        return own and not machine.blocks and self.rules.states is not States.ENUMERATION

    # -- events

    def changed(self, step: int, event: ActionEvent) -> Expression:
        """Return a comparison of the states now and before."""
        now, before = self.active(step), self.states.before(step)
        return conjunction([now, negation(before)] if event is ActionEvent.S1 else [before, negation(now)])

    def touched(self, step: int) -> Expression:
        """Return a comparison: the step is the state now, or was it before."""
        return disjunction([self.active(step), self.states.before(step)])

    def gone(self, step: int) -> Expression:
        """Return a bit that keeps the event of the last cycle."""
        if step not in self._gone:
            self._gone[step] = self.code.declare(self.texts.with_suffix(f"{self.signs[step].name}_S0", "old"))
        return self._gone[step]

    def add_events(self, place: int, registered: Sequence[Statement]) -> None:
        """Insert the copies of the states before they change."""
        self.code.add(self.own_texts.events, registered, place=place)
        kept = [assignment(bit, self.changed(step, ActionEvent.S0)) for step, bit in self._gone.items()]
        self.code.add(self.texts.before, [*kept, *self.states.remembered()], place=self._change)

    # -- what belongs to one step each: where there is one active step, in the branches of a CASE

    def add_checks(self, cleared: list[Statement], checked: Sequence[SequencerStepCode], alarms: str) -> None:
        """Append the checks as they are, or in a CASE."""
        if self._is_one_of(checked):
            lines = [self.states.text(statement) for statement in cleared]
            text = "\n".join([*lines, *self._case_of(checked, self._while_active)])
            self.code.networks.append(TextNetwork(self.own_texts.checks, text, alarms))
        else:
            super().add_checks(cleared, checked, alarms)

    def add_checks_behind(
        self, forgotten: Sequence[SequencerStepCode], checked: Sequence[SequencerStepCode], alarms: str
    ) -> None:
        """Append the checks as they are, or in a CASE each for what was left and entered."""
        # checks before the step change miss the steps that it activates: these are checked behind it once more
        entered = [part for part in checked if self.checks[part.step.index].early]
        if not self._is_one_of(entered):
            super().add_checks_behind(forgotten, checked, alarms)
            return
        cases = [*self._case_of(forgotten, self._when_left), *self._case_of(entered, self._when_entered)]
        lines = self._when_changed(cases)
        lines += [self.states.text(s) for part in checked if part not in entered for s in part.statements]
        self.code.networks.append(TextNetwork(self.own_texts.checks_behind, "\n".join(lines), alarms))

    def add_leaving(self, parts: Sequence[SequencerStepCode]) -> None:
        """Append the code as it is, or in a CASE."""
        if self._is_one_of(parts):
            lines = self._when_changed(self._case_of(parts, self._when_left))
            self.code.networks.append(TextNetwork(self.own_texts.leaving_one, "\n".join(lines)))
        else:
            super().add_leaving(parts)

    def add_acting(self, parts: Sequence[SequencerStepCode]) -> None:
        """Append the code as it is, or in a CASE. An inactive step has no event but that it was left."""
        if self._is_one_of(parts):
            lines = self._case_of(parts, self._while_active)
            self.code.networks.append(TextNetwork(self.own_texts.acting_one, "\n".join(lines)))
        else:
            super().add_acting(parts)

    def _is_one_of(self, parts: Sequence[SequencerStepCode]) -> bool:
        return len(parts) > 1 and len(self.states.machines) == 1

    def _while_active(self, step: int) -> _Selected:
        return _Selected(self.states.machine_of(step).state, [self.active(step)])

    def _when_entered(self, step: int) -> _Selected:
        known = [self.active(step), negation(self.states.before(step))]
        return _Selected(self.states.machine_of(step).state, known)

    def _when_left(self, step: int) -> _Selected:
        known = [self.states.before(step), negation(self.active(step))]
        return _Selected(self.states.state_before(self.states.machine_of(step)), known)

    def _case_of(self, parts: Sequence[SequencerStepCode], selected: Callable[[int], _Selected]) -> list[str]:
        """Return a CASE with the code of each step, without the conditions that its branch implies."""
        if not parts:
            return []
        branches: list[list[str]] = []
        numbers = step_numbers(self.net)
        for part in sorted(parts, key=lambda each: numbers[each.step.index]):
            step = part.step
            known = selected(step.index).known
            statements = n.Statements(tuple(chain.from_iterable(_without(known, s) for s in part.statements)))
            content = self.states.text(statements).splitlines()
            branches.append(self.states.branch(self.states.names.step(step.index), self.states.heading(step), content))
        selector = self.states.text(selected(parts[0].step.index).selector)
        return [f"CASE {selector} OF", *spaced(branches), "END_CASE;"]

    def _when_changed(self, lines: list[str]) -> list[str]:
        return [f"IF {self.states.text(self.states.changed())} THEN", *indented(lines), "END_IF;"]

    # -- transitions

    def add_transitions(self) -> None:
        """Append what all transitions share, and a bit for each that competing transitions in other CASEs need."""
        statements: list[Statement] = []
        permitted, pushed = self.commands.permitted(), self.commands.pushed()
        if not is_constant(pushed, FALSE):
            pushed = self.memory.named(self.own_texts.pushed, pushed, statements)
        needing = self._needing_bits()
        # one IF around the CASE instead of the same condition in every transition
        guards_all = not any(self.source.preparations)  # these are executed where nothing switches, too
        if not is_constant(permitted, TRUE) and (len(self.states.machines) > 1 or needing or not guards_all):
            permitted = self.memory.named(self.own_texts.permitted, permitted, statements)
        if guards_all:
            self._guard, permitted = permitted, TRUE
        for transition in self.net.transitions:
            self._prepare(transition, permitted, pushed)
        for index in needing:
            transition = self.net.transitions[index]
            name = self.texts.transition_name(self.net, transition)
            self._bits[index] = self.code.declare(name, comment=self.texts.transition_of(transition.path))
            free = [negation(self._bits[other]) for other in transition.competing if other in self._bits]
            enabled = [self.active(i) for i in transition.sources]
            if self._before[index]:
                statements.append(when(conjunction([*enabled, self.evolves()]), *self._before[index]))
            fires = conjunction([*enabled, self._conditions[index], *free])
            statements.append(assignment(self._bits[index], fires))
        self.code.add(self.texts.transitions, statements)

    def _prepare(self, transition: NetTransition, permitted: Expression, pushed: Expression) -> None:
        """Find the statements before the condition of a transition, and when they let the transition switch."""
        index = transition.index
        self._before[index] = tuple(self.resolved(self.source.preparations[index], CyclePhase.SWITCH))
        condition: Expression = self.resolve(self.source.conditions[index], CyclePhase.SWITCH)
        switches = disjunction([conjunction([condition, permitted]), pushed])
        held = [negation(self.checks[i].held(self.resolve)) for i in transition.sources]
        self._conditions[index] = conjunction([switches, *held])

    def _needing_bits(self) -> list[int]:
        """Return joins with their competing transitions, and transitions whose conditions need statements before them.

        All conditions of active steps are evaluated one after the other, also of those that compete with one that
        switches: then all of them need a bit, those of one step, or where there are several regions all.
        """
        # a statement in one CASE would come behind the transitions of the CASE before it
        if any(self.source.preparations) and len(self.states.machines) > 1:
            return list(range(len(self.net.transitions)))
        found = self.states.competing_joins()
        for leaving in self.net.leaving:
            if any(self.source.preparations[t] for t in leaving[1:]):
                found.update(leaving)
        return sorted(found)

    # -- the step change

    def add_step_change(self) -> None:
        """Append the CASE of each region, and what sets the states besides."""
        self._change = len(self.code.networks)
        machines = self.states.machines
        for machine in machines:
            if self._must_wait(machine):
                self.states.add_following_state(machine)
        for machine in machines:
            case = self.states.case(machine, self._leaving, self._joining)
            if not case:
                continue
            if not is_constant(self._guard, TRUE):
                case = [f"IF {self.states.text(self._guard)} THEN", *indented(case), "END_IF;"]
            self.code.networks.append(TextNetwork(self.states.title(machine), "\n".join(case)))
        if self.source.skips:
            for machine in machines:
                self._add_skips(machine)
        self.code.add(self.own_texts.manual, self._off_by_hand())
        start = disjunction([self.first, self.started()])
        initial = [self.states.set_back(machine) for machine in machines]
        self.code.add(self.own_texts.start, [when(start, *initial, assignment(self.first, FALSE))])
        off = self.commands.edge("OFF_SQ")
        none = [assignment(self.states.following(machine), self.states.names.none) for machine in machines]
        self.code.add(self.own_texts.off, [when(off, *none)] if not is_constant(off, FALSE) else [])
        self.code.add(self.texts.moves, self.states.following_assignments())

    def _must_wait(self, machine: RegionState) -> bool:
        """Return True if code between its CASE and the step change reads or writes the state of a region."""
        if machine.blocks or machine.region.block is not None or self.source.skips:
            return True
        others = (t for t in self.net.transitions if t.index not in machine.region.transitions)
        trees = chain.from_iterable((self._conditions[t.index], *self._before[t.index]) for t in others)
        return any(node == machine.state for tree in trees for node in walk(tree))

    def _leaving(self, step: NetStep) -> list[str]:
        """Return the transitions of an active step."""
        leaving = [self.net.transitions[t] for t in self.net.leaving[step.index]]
        machine = self.states.machine_of(step.index)
        return self.states.tried([self._try(machine, t) for t in leaving if len(t.sources) == 1])

    def _joining(self, block: ParallelBlock) -> list[str]:
        """Return the transitions that wait for branches."""
        machine = self.states.machines[block.parent]
        return self.states.tried([self._try(machine, self.net.transitions[t]) for t in block.joins])

    def _try(self, machine: RegionState, transition: NetTransition) -> TriedTransition:
        index = transition.index
        before = self._before[index]
        if before and not is_constant(self.evolves(), TRUE):
            before = (when(self.evolves(), *before),)
        return self.states.attempt(machine, transition, self._conditions[index], before, bit=self._bits.get(index))

    def _off_by_hand(self) -> list[Statement]:
        """Return S_OFF for the step whose number S_SEL has."""
        by_hand = self.commands.is_on(Mode.MANUAL)
        selection = self.commands.variable("S_SEL")
        edge = self.commands.edge("S_OFF") if not is_constant(by_hand, FALSE) else FALSE
        if selection is None or is_constant(edge, FALSE):
            return []
        meant = {machine: self._selected(machine, selection) for machine in self.states.machines}
        return [
            when(conjunction([by_hand, edge, one]), assignment(self.states.following(machine), self.states.names.none))
            for machine, one in meant.items()
            if not is_constant(one, FALSE)
        ]

    def _selected(self, machine: RegionState, selection: n.Name) -> Expression:
        """Return an expression that is TRUE if the active step of a region is the one selected."""
        # the state is the number: one comparison instead of one for each step
        if self._has_numbers_of_steps(machine):
            return equal(machine.state, selection)
        firsts: dict[int | None, int] = {}
        for step in self.net.steps:
            firsts.setdefault(step.step.number, step.index)
        return disjunction(
            conjunction([self.active(index), equal(selection, n.Literal(str(number)))])
            for number, index in firsts.items()
            if number is not None and self.states.machine_of(index) is machine
        )

    # -- steps that are skipped

    def _add_skips(self, machine: RegionState) -> None:
        """Append a loop that goes on behind a step whose next transition is satisfied; no step is passed twice."""
        steps = [i for i in machine.region.steps if self.net.entering[i] and self.net.leaving[i]]
        if not steps:
            return
        states, text, following = self.states, self.states.text, self.states.following(machine)
        again = self.code.declare(self.own_texts.again)
        goes_on = text(assignment(again, TRUE))
        loop = [text(assignment(again, FALSE)), f"CASE {text(following)} OF"]
        begin: list[Statement] = []
        for step in (self.net.steps[i] for i in steps):
            passed = self.code.declare(self.texts.with_suffix(self.signs[step.index].name, "seen"))
            begin.append(assignment(passed, FALSE))
            tries = [self._passing(machine, self.net.transitions[t], goes_on) for t in self.net.leaving[step.index]]
            inner = [text(assignment(passed, TRUE)), *states.tried(tries)]
            once = [f"IF {text(negation(passed))} THEN", *indented(inner), "END_IF;"]
            loop += states.branch(states.names.step(step.index), states.heading(step), once)
        begin.append(assignment(again, conjunction([negation(equal(following, machine.state)), self.evolves()])))
        lines = [text(statement) for statement in begin]
        lines += [f"WHILE {text(again)} DO", *indented([*loop, "END_CASE;"]), "END_WHILE;"]
        self.code.networks.append(TextNetwork(self.own_texts.skips, "\n".join(lines)))

    def _passing(self, machine: RegionState, transition: NetTransition, goes_on: str) -> TriedTransition:
        condition: Expression = self.resolve(self.source.conditions[transition.index], CyclePhase.SWITCH)
        effect = self.states.effect(machine, transition)
        return TriedTransition(self._before[transition.index], condition, [*effect, goes_on], [])


class CaseSequencer(RegionSequencer):
    """Encoding with all steps in one region, also those that are never active."""

    def structure(self) -> Regions | str:
        """Return one region, or why it cannot be one."""
        return one_sequence(self.source, self.rules.profile)


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
