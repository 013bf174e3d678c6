"""Encodings with a CASE: one for the chart, or one for each of its parts with one active step at a time."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from itertools import groupby

from plcopen_sfc.analysis.regions import ParallelBlock, Regions
from plcopen_sfc.languages.effects import is_impure, path_of
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.actions.action_execution import StepCode
from plcopen_sfc.lowering.actions.variable_access import Effect, UntouchedVariables
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    Alternative,
    assignment,
    beside,
    conjunction,
    disjunction,
    equal,
    is_constant,
    names_in,
    negation,
    one_of_values,
    remark,
    when,
)
from plcopen_sfc.lowering.code.lowered_code import CodeNetwork
from plcopen_sfc.lowering.code.statement_lists import timers_of
from plcopen_sfc.lowering.encodings.case_states import (
    RegionState,
    StateNames,
    StateVariables,
    TriedTransition,
    ending_together,
    one_region,
    regions_of,
)
from plcopen_sfc.lowering.encodings.step_branches import BranchCode, StepBranches
from plcopen_sfc.lowering.lowering_options import ActionPlace, OperatingMode, States
from plcopen_sfc.lowering.reading.chart_source import ActionSource, ActionUse, ChartSource, step_numbers
from plcopen_sfc.lowering.reading.step_variables import TimedPart
from plcopen_sfc.lowering.schedule.scan_schedule import ScanSchedule, refuse_classic
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.semantics.net import NetStep, NetTransition
from plcopen_sfc.semantics.profile import Evolution, ScanOrder


class RegionEncoding(ScanSchedule):
    """Encoding with one CASE for each region, for charts to which `case_objections` has none."""

    def declare_states(self, source: ChartSource) -> None:
        """Declare a state variable for each region, at the start that of its initial step or of no step."""
        self._regions = self.structure(source)
        # a step that is selected by its number needs a state of that number
        own = OperatingMode.SELECT in self.rules.modes or source.ends_single_steps
        merged = frozenset[int]() if own else ending_together(self._regions)
        off = self._regions
        if source.starts_off:
            numbers = step_numbers(source.net)  # in whose order readers look for steps
            regions = (replace(r, steps=tuple(sorted(r.steps, key=numbers.__getitem__))) for r in off.regions)
            self._regions = replace(off, regions=tuple(regions))
            off = replace(off, regions=tuple(replace(each, initial=None) for each in self._regions.regions))
        self.names = StateNames(source, off, self.code, self.rules, self.surroundings, merged=merged)
        self.states = StateVariables(self._regions, self.names, off=source.starts_off, part=self.rules.part)
        self.machines = self.states.machines
        self._bits: dict[int, n.Name] = {}
        self._again: dict[int, n.Name] = {}
        self._last: dict[int, n.Name] = {}
        self._done: dict[int, list[BranchCode]] = {}
        self._entered: dict[int, n.Name] = {}
        self.may_fire: Expression = TRUE
        self._held: dict[int, Expression] = {}
        # a contact in another body cannot compare
        self._asked = {
            step: self.code.declare_flag(
                self.texts.flag_name(self.net.steps[step].step),
                self.net.steps[step].path,
                initial=bool(self.net.initial & self.net.steps[step].bit),
                comment=self.texts.flag_of(self.net.steps[step].path),
            )
            for step in sorted(source.asked_by_contacts)
        }

    def active(self, step: int) -> Expression:
        """Return a comparison of the state of its region."""
        return self.states.active(step)

    @property
    def situation(self) -> StateVariables:
        """State variables."""
        return self.states

    def hold(self, steps: Collection[int], held: Expression) -> None:
        """Let no transition of some steps fire while a condition is TRUE; no more than one for a region."""
        self._held |= {m.region.index: held for m in self.machines if m.first in steps}

    def divide(self) -> None:
        """Declare following states and bits of transitions where CASEs need each other."""
        # all CASEs look at the situation of the last scan: no order of CASEs would be right, as a divergence wants the
        # branches before and a convergence wants them behind. So states that others read change behind all CASEs
        for machine in self.machines:
            if self._must_wait(machine) and not self.states.has_following(machine):
                self.states.add_following_state(machine)
        if self._is_announced and SfcFlag.TRANS in self.source.flags:
            for machine in self.machines:
                self.last_state(machine)  # asked for when they are assigned already
        for index in self._needing_bits():
            transition = self.net.transitions[index]
            comment = self.texts.transition_of(transition.path)
            self._bits[index] = self.code.declare(self.texts.transition_name(self.net, transition), comment=comment)

    def timed_part(self, step: int) -> TimedPart | None:
        """Return the region of a step. Textbook code and blocks with actions do not know the step of the last scan."""
        once = self.profile.evolution is Evolution.SINGLE
        if self.code.is_textbook or self.rules.actions is ActionPlace.BLOCK or not once:
            return None
        return _TimedRegion(self, self.states.machine_of(step))

    def while_active(self, parts: Sequence[StepCode], suffix: str) -> list[Statement]:
        """Return one CASE instead of several IFs of the same region."""
        found: list[Statement] = []
        for machine, these in self._by_region(parts):
            several = [self.states.selection(machine.state, these)] if len(these) > 1 else []
            found += several or super().while_active(these, suffix)
        return found

    def on_change(self, exits: Sequence[StepCode], entries: Sequence[StepCode]) -> list[Statement]:
        """Return the comparison of states with those of the last scan: one memory for all steps of a region."""
        found: list[Statement] = []
        for machine, these in self._by_region(exits):
            found += self._changed(self.last_state(machine), machine.state, these)
        for machine, these in self._by_region(entries):
            found += self._changed(machine.state, self.last_state(machine), these)
        return found

    def was_active(self, steps: Sequence[int]) -> Expression:
        """Return a comparison of the states of the last scan."""
        machines = [(self.states.machine_of(step), self.states.state_of(step)) for step in steps]
        return disjunction(equal(self.last_state(machine), state) for machine, state in machines)

    def remember(self) -> None:
        """Append the assignments of the states of the last scan."""
        kept = [assignment(each, self.states.machine(index).state) for index, each in self._last.items()]
        entered = ((flag, equal(self.states.machine(i).state, self._last[i])) for i, flag in self._entered.items())
        kept[:0] = [assignment(flag, negation(same)) for flag, same in entered]
        self.code.add(self.texts.steps_before, kept)
        if self.sfc_flags.set_back:
            self.memory.ends += [assignment(each, self.names.no_state) for each in self._last.values()]

    def last_state(self, machine: RegionState) -> n.Name:
        """Return the variable with the state that a region had in the last scan."""
        index = machine.region.index
        if index not in self._last:
            entered = self.profile.initial_steps_entered
            suffix = self.states.suffix(machine.region)
            self._last[index] = self.names.declare_last(machine.region, suffix, entered=entered)
        return self._last[index]

    def _by_region(self, parts: Sequence[StepCode]) -> list[tuple[RegionState, list[StepCode]]]:
        """Return the parts in their order, with those of one region behind each other together."""
        return [
            (machine, list(these)) for machine, these in groupby(parts, lambda each: self.states.machine_of(each.step))
        ]

    def _changed(self, state: n.Name, other: n.Name, parts: Sequence[StepCode]) -> list[Statement]:
        """Return the parts of the steps that `state` is, and that `other` is not."""
        if len(parts) == 1:
            (part,) = parts
            step = self.states.state_of(part.step)
            return [when(conjunction([equal(state, step), negation(equal(other, step))]), *part.statements)]
        return [when(negation(equal(state, other)), self.states.selection(state, parts, other))]

    def gather(self, begin: int) -> None:
        """Write what single steps do, in one network behind the other, as one CASE."""
        for place, network in enumerate(self.code.networks[begin:], begin):
            self.code.networks[place] = replace(network, statements=tuple(self._ended_by_state(network.statements)))
        if self.profile.order is ScanOrder.ACTIONS_FIRST:
            return  # what can moves to the transitions
        branches = [self._branches(machine, whole=True) for machine in self.machines]
        found: list[CodeNetwork] = []
        firsts = (self.net.steps[machine.first].path for machine in self.machines)
        several = [*map(self.texts.main_actions_of, firsts)] if len(self.machines) > 1 else [self.texts.main_actions]
        titles = dict(zip(branches, several, strict=True))
        groups = groupby(self.code.networks[begin:], lambda each: next((b for b in branches if b.can_take(each)), None))
        for taking, networks in groups:
            run = list(networks)
            if taking is not None and len(run) > 1:
                taking.take(run)  # nothing of it stays
                run = [CodeNetwork(titles[taking], (taking.case(),))]
            found += run
        self.code.networks[begin:] = found

    def _ended_by_state(self, statements: Iterable[Statement]) -> Iterator[Statement]:
        """Yield statements with one CASE instead of several IFs in a row that ask if a step was left."""
        for machine, these in groupby(statements, self._left_machine):
            run = [*these]
            if machine is None or len(run) == 1:
                yield from run
                continue
            steps = {self.states.state_of(step): step for step in self.states.steps_of(machine)}
            parts: list[StepCode] = []
            for each in run:
                match each:
                    case n.If((n.Branch(n.Operation(_, (n.Operation(_, (_, state)), _)), inside),), None):
                        parts.append(StepCode(steps[state], "", inside))
            yield from self._changed(self.last_state(machine), machine.state, parts)

    def _left_machine(self, statement: Statement) -> RegionState | None:
        """Return the region of ``IF last = Fill AND state <> Fill THEN``; None for all others."""
        match statement:
            case n.If((n.Branch(n.Operation(Operator.AND, (n.Operation(_, (last, state)) as was, now)), _),), None):
                for index, name in self._last.items():
                    machine = self.states.machine(index)
                    left = was, now
                    if last == name and left == (equal(name, state), negation(equal(machine.state, state))):
                        return machine
        return None

    def _branches(self, machine: RegionState, *, whole: bool) -> StepBranches:
        """Return empty branches of a CASE for the code of its steps; `whole`: the CASE comes right behind that code."""
        scope = UntouchedVariables(self.source, self.code.own_names, timers_of(self.code))
        last = self._last.get(machine.region.index)
        between = None if whole else self._between(machine, scope)
        return StepBranches(self.states, machine, last, scope, whole=whole, between=between)

    def choose_transitions(self, shared: Sequence[Statement] = ()) -> None:
        """Append the CASE of each region with the transitions of each step."""
        self.code.add(self.texts.transitions, [*shared, *self._computed_bits()])
        self._declare_again()
        self.code.add("", [assignment(flag, FALSE) for flag in self._again.values()])
        for machine in self._sequence or self.machines:
            self.code.add(self.states.title(machine), self._guarded(machine, self._case(machine)))
        if self.blocking and not self._keeps_out:
            back = [self.states.set_back(each) for each in self.machines if self._is_set_back_behind(each)]
            ahead = [beside(self.texts.held), *back]
            self.code.add("", [when(disjunction(self.blocking), *ahead)] if back else [])

    def select(self) -> None:
        """Append the selection: the selected step becomes the state of its region, all other regions have none."""
        selecting, selected = self.modes.selecting, self.modes.selected
        if selecting is None or selected is None:
            return
        named = self.rules.states is States.ENUMERATION
        if len(self.machines) == 1 and not named:
            state = self.states.following(self.machines[0])
            self.code.add(self.texts.selection, [when(selecting, assignment(state, selected))])
            return
        # the number does not tell its region: all regions are left, then the one with that step is entered
        ended: list[Statement] = []
        if len(self.machines) > 1:
            ended = self.ending()
        branches: list[n.CaseBranch] = []
        for machine in self.machines:
            state, numbers = self.states.following(machine), [self.modes.number(i) for i in machine.region.steps]
            if named:
                states = [assignment(state, self.names.step(i)) for i in machine.region.steps]
                branches += [n.CaseBranch((each,), (to,)) for each, to in zip(numbers, states, strict=True)]
            else:
                branches.append(n.CaseBranch(tuple(numbers), (assignment(state, selected),)))
        chosen = n.Case(selected, tuple(branches))
        self.code.add(self.texts.selection, [when(selecting, *ended, chosen)])

    def alternatives(self) -> Alternative:
        """Return the states: a variable has one of them."""
        return one_of_values(self.names.all)

    def into_branches(self, begin: int) -> None:
        """Move what active steps do into the branches of the CASE, where that is the same."""
        if self._keeps_out:
            return
        for machine in self.machines:
            branches = self._branches(machine, whole=False)
            self.code.networks[begin:] = branches.take(self.code.networks[begin:])
            self._done |= branches.code
            if branches.enters:
                wanted = "_".join(filter(None, [self.texts.entered, self.states.suffix(machine.region)]))
                entered = self.code.declare(wanted, comment=self.texts.entered_comment)
                self._entered[machine.region.index] = entered

    def _between(self, machine: RegionState, scope: UntouchedVariables) -> Effect:
        """Return the effect of what is executed between the actions and the CASE of a region."""
        between = Effect(scope)
        between.writing |= {path_of(each) for each in self._last.values()}  # brought up to date before the CASEs
        others = [each for each in self.machines if each is not machine]
        if others:
            between.writing |= {path_of(self.states.following(each)) for each in others}
            between.writing |= {path_of(each) for each in self._bits.values()}
            between.add(self.source.conditions)
            between.add(each for statements in self.source.preparations for each in statements)
            between.add(each for parts in self._done.values() for code in parts for each in code.statements)
        return between

    @property
    def _keeps_out(self) -> bool:
        """True if a CASE is not executed while no transition may fire: neither are what its conditions call."""
        return bool(self.blocking) and (any(self.source.preparations) or any(map(is_impure, self.source.conditions)))

    def change_situation(self) -> None:
        """Append the assignments of following states, where these had to wait."""
        if self._is_announced:
            held = self.sfc_flags.held
            self.code.add(self.texts.init, [when(held, *self.starting())] if held != FALSE else [])
            return
        waiting = [machine for machine in self.machines if self.states.has_following(machine)]
        restart = [when(self.init, *map(self.states.set_back, waiting))] if self.init is not None and waiting else []
        asked = [assignment(flag, self.active(step)) for step, flag in self._asked.items()]
        self.code.add(self.texts.moves, [*restart, *self.states.following_assignments(), *asked])

    def starting(self) -> list[Statement]:
        """Return the assignments that restart all regions."""
        return [self.states.set_back(machine) for machine in self.machines]

    def ending(self, machines: Sequence[RegionState] = ()) -> list[Statement]:
        """Return the assignments of the state of no step to some regions, or to all."""
        return [assignment(self.states.following(machine), self.names.none) for machine in machines or self.machines]

    def imposing(self, situation: Mapping[int, Expression | None]) -> list[Statement]:
        """Return the assignments that impose a situation: of each step TRUE or FALSE, or all as they were."""
        found: list[Statement] = []
        for machine in self.machines:
            if machine.first in situation:
                active = [i for i in machine.region.steps if situation[i] == TRUE]
                state = self.names.step(active[0]) if active else self.names.none
                if situation[machine.first] is None:
                    state = self.states.state_before(machine)
                both = dict.fromkeys([machine.state, self.states.following(machine)])
                found += [assignment(each, state) for each in both]
        return found

    def any_fires(self) -> Expression:
        """Return an expression that is TRUE if any state will be another one, or a step is left and entered at once."""
        # announced states are those of the next scan already, where the last ones are those of this scan
        new, old = (_state, self.last_state) if self._is_announced else (self.states.following, _state)
        changes = [negation(equal(new(machine), old(machine))) for machine in self.machines]
        return disjunction([*changes, *self._again.values()])

    def reentered(self) -> Mapping[int, Expression]:
        """Return, for steps that a transition leaves and enters at once, a flag that it sets, if that is used."""
        return self._again

    # -- structure

    def structure(self, source: ChartSource) -> Regions:
        """Return the regions of the chart, which is built of them."""
        found = regions_of(source.region_net)
        assert not isinstance(found, str)  # noqa: S101  # `refuse_cases` has looked
        return replace(found, net=source.net)

    # -- states that change behind all CASEs

    def _must_wait(self, machine: RegionState) -> bool:
        """Return True if other code than its own CASE reads or writes the state of a region."""
        # where actions come first they see the situation of the last scan, chosen transitions wait until the next one
        if self.profile.order is ScanOrder.ACTIONS_FIRST and not self._is_announced:
            return True
        if self._sequence:
            return False
        return bool(machine.blocks or machine.region.block is not None or self._is_asked(machine))

    @cached_property
    def _sequence(self) -> tuple[RegionState, ...]:
        """Regions in an order in which CASEs behind each other are as good as at once; none if there is no such order.

        Those of branches come before that which they branch from: a branch does not see that it is begun in this scan
        then; whether it is ended was decided before all of them. Those whose conditions ask for the state of another
        region come before that one.
        """
        ahead: dict[int, set[int]] = {}
        for machine in sorted(self.machines, key=self._depth, reverse=True):
            index, block = machine.region.index, machine.region.block
            ahead.setdefault(index, set()).update(
                self._askers.get(machine.state.identifier.casefold(), set()) - {index}
            )
            if block is not None:
                ahead.setdefault(self._regions.blocks[block].parent, set()).add(index)
        if not any(map(self._is_asked, self.machines)):
            return tuple(sorted(self.machines, key=self._depth, reverse=True))
        try:
            return tuple(map(self.states.machine, TopologicalSorter(ahead).static_order()))
        except CycleError:
            return ()

    def _is_asked(self, machine: RegionState) -> bool:
        """Return True if conditions in the CASE of another region ask for the state of this one."""
        return bool(self._askers.get(machine.state.identifier.casefold(), set()) - {machine.region.index})

    def _depth(self, machine: RegionState) -> int:
        """Return how many simultaneous branches a region is in."""
        depth, block = 0, machine.region.block
        while block is not None:
            depth, block = depth + 1, self._regions.regions[self._regions.blocks[block].parent].block
        return depth

    @cached_property
    def _is_announced(self) -> bool:
        """True if transitions change the state itself, which then tells of the next scan: nothing asks before that."""
        return (
            self.profile.order is ScanOrder.ACTIONS_FIRST
            and bool(self._sequence)
            and not (self.source.asked_outside or self.source.logic)
            and not (self.blocking and self.modes.selecting is not None)
        )

    @property
    def late_edges(self) -> bool:
        """True if only what actions remember asks whether the chart was just set back."""
        if self.rules.actions is ActionPlace.BLOCK:  # the block has to know it too
            return False
        return self._is_announced and not {SfcFlag.PAUSE, SfcFlag.QUIT_ERROR} & self.source.flags

    def active_steps(self) -> dict[str, Expression]:
        """Return expressions by the paths of steps, or by ``Fill._x`` if they tell of the next scan."""
        found = super().active_steps() | {self.net.steps[step].path: flag for step, flag in self._asked.items()}
        return {f"{path}._x": active for path, active in found.items()} if self._is_announced else found

    @cached_property
    def _askers(self) -> dict[str, set[int]]:
        """Return the regions in whose CASE conditions ask for a name, by these names."""
        found: dict[str, set[int]] = {}
        for index, held in self._held.items():
            for name in names_in(held):
                found.setdefault(name, set()).add(index)
        for transition in self.net.transitions:
            # a join is tried in the CASE of the region that waits for it, whose steps are none of its sources; that
            # region has blocks and waits in any case
            region = self.states.machine_of(transition.sources[0]).region.index
            for tree in (self.source.conditions[transition.index], *self.source.preparations[transition.index]):
                for node in walk(tree):
                    if isinstance(node, n.Name):
                        found.setdefault(node.identifier.casefold(), set()).add(region)
        return found

    def _guarded(self, machine: RegionState, case: list[Statement]) -> list[Statement]:
        """Return a CASE that is not executed while no transition may fire, or whose transitions do nothing then."""
        may_fire = conjunction([self.may_fire, negation(self._held.get(machine.region.index, FALSE))])
        case = [when(may_fire, *case)] if case and not is_constant(may_fire, TRUE) else case
        if not self.blocking:
            return case
        blocked, back = disjunction(self.blocking), self.states.set_back(machine)
        if not self._is_set_back_behind(machine):
            return [n.If((n.Branch(blocked, (back,)),), tuple(case) or None)]
        # else the initial step stays active meanwhile
        return [when(negation(blocked), *case)] if case and self._keeps_out else case

    def _is_set_back_behind(self, machine: RegionState) -> bool:
        """Return True if a state is set back where it becomes valid, and not in the place of its CASE."""
        return self._is_announced or self.states.has_following(machine) or self.init is None

    # -- transitions that compete with those of another CASE

    def _needing_bits(self) -> list[int]:
        """Return joins with competing transitions, with these, and joins whose condition needs statements before it."""
        found = self.states.competing_joins()
        if self.source.evaluates_all and any(self.source.preparations):
            # a statement in one CASE would come behind the transitions of the CASE before it
            if len(self.machines) > 1:
                return list(range(len(self.net.transitions)))
            for leaving in self.net.leaving:
                if any(self.source.preparations[t] for t in leaving[1:]):
                    found.update(leaving)
        for block in self._regions.blocks:
            # where all branches are one state with the wait there is no CASE in between that could end one of them
            branches = [i for join in block.joins for i in self.net.transitions[join].sources]
            alone = all(map(self.states.is_merged, branches))
            waiting = all(self.states.has_following(self.states.machine_of(i)) for i in branches)
            if self._sequence and not (alone or waiting):
                found.update(block.joins)
            found.update(join for join in block.joins if self.source.preparations[join])
        return sorted(found)

    def _computed_bits(self) -> Iterator[Statement]:
        for index, bit in self._bits.items():
            transition = self.net.transitions[index]
            free = [negation(self._bits[other]) for other in transition.competing if other in self._bits]
            held = self._held.get(self.states.machine_of(transition.sources[0]).region.index, FALSE)
            free += [negation(each) for each in (*self.blocking, held)]
            enabled = conjunction(self.active(i) for i in transition.sources)
            yield from self.prepared(index, enabled, free)
            yield assignment(bit, conjunction([enabled, self.source.conditions[index], *free]))

    # -- steps that are left and entered at once

    def _declare_again(self) -> None:
        reported = SfcFlag.TRANS in self.source.flags
        # where steps change between two scans such a step is never seen to be left
        timed = self.profile.order is ScanOrder.TRANSITIONS_FIRST and self.profile.leaving_restarts_time
        for transition in self.net.transitions:
            for step in set(transition.sources) & set(transition.targets):
                if (reported or (timed and self.times.measures(step))) and step not in self._again:
                    path = self.net.steps[step].path
                    wanted = self.texts.with_suffix(self.texts.flag_name(self.net.steps[step].step), "again")
                    self._again[step] = self.code.declare(wanted, comment=self.texts.again_of(path))

    # -- the CASE of one region

    def _case(self, machine: RegionState) -> list[Statement]:
        def done(*steps: int) -> list[Statement]:
            entered = self._entered.get(machine.region.index)
            return [each for i in steps for code in self._done.get(i, ()) for each in code.written(entered)]

        def leaving(step: NetStep) -> list[Statement]:
            transitions = [self.net.transitions[t] for t in self.net.leaving[step.index]]
            tried = self.states.tried([self._try(machine, t) for t in transitions if len(t.sources) == 1])
            return [*done(step.index), *tried]

        def joining(block: ParallelBlock) -> list[Statement]:
            firsts = (self._regions.first_step(self._regions.regions[i]) for i in block.branches)
            tried = self.states.tried([self._try(machine, self.net.transitions[t]) for t in block.joins])
            return [*done(*filter(self.states.is_merged, firsts)), *tried]

        return self.states.case(machine, leaving, joining)

    def _try(self, machine: RegionState, transition: NetTransition) -> TriedTransition:
        before = self.source.preparations[transition.index]
        evaluated = self.asked()
        if before and not is_constant(evaluated, TRUE):
            before = (when(evaluated, *before),)
        # the state stays the same number, so that nothing else shows that the step was left and entered
        loops = set(transition.sources) & set(transition.targets) & set(self._again)
        return self.states.attempt(
            machine,
            transition,
            self.source.conditions[transition.index],
            before,
            bit=self._bits.get(transition.index),
            also=[assignment(self._again[i], TRUE) for i in loops],
        )


def _state(machine: RegionState) -> n.Name:
    return machine.state


@dataclass(frozen=True)
class _TimedRegion:
    """Region whose steps have one timer together: it starts again when the state changes."""

    encoding: RegionEncoding
    machine: RegionState

    @property
    def time_name(self) -> str:
        """Name of that timer."""
        name, suffix = self.encoding.texts.step_time, self.encoding.states.suffix(self.machine.region)
        return f"{name}_{suffix}" if suffix else name

    def changed(self) -> Expression:
        """Return a comparison with the state of the last scan."""
        return negation(equal(self.machine.state, self.encoding.last_state(self.machine)))


_STORED = (Qualifier.S, Qualifier.R, Qualifier.R0)


class CaseEncoding(RegionEncoding):
    """Encoding with one CASE, for charts with one active step."""

    def structure(self, source: ChartSource) -> Regions:
        """Return all steps in one region, also those that are never active."""
        return one_region(source.net)

    def classic(self) -> None:
        """Append a CASE whose branches have the actions of the step, then its transitions.

        Raises `LoweringError` for what such branches cannot hold.
        """
        # outputs in the branches are what textbooks do; the gap of one scan between two steps that both drive an output
        # is one of the faults that are reported
        self.resolve_steps()
        self._check_classic()
        self.begin_classic()
        if self.init is not None:
            self.code.add(
                self.texts.init, [when(self.init, self.states.entered(self.machines[0].first), *self._stored())]
            )
        branches = tuple(map(self._classic_branch, self.net.steps))
        self.code.add(self.texts.chain, [n.Case(self.machines[0].state, branches)])

    def _stored(self) -> list[Statement]:
        """Return the resets of the actions that steps have stored, if a restart is to end them."""
        if not self.rules.reset_actions:
            return []
        stored = [a for a in self.source.actions if any(use.qualifier is Qualifier.S for use in a.uses)]
        targets = [action.target for action in stored if action.target is not None]
        return [each for target in targets for each in (assignment(target, _OFF), beside(self.texts.reset_action))]

    def _classic_branch(self, step: NetStep) -> n.CaseBranch:
        used = [(action, use) for action in self.source.actions for use in action.uses if step.index in use.steps]
        acts = [each for code in self.source.step_code if code.step == step.index for each in code.main]
        for action, use in used:
            acts += [*remark(self.texts.captions(action.comment, use.comment)), *self._acting(action, use)]
        ending = [each for action, use in used for each in self._ending(action, use)]
        transitions = self._classic_transitions(step, ending)
        title = [*remark(self.texts.actions), *acts, n.Remark("")] if acts else []
        if not (any(not isinstance(each, n.Remark) for each in acts) or transitions):
            transitions = [n.Empty()]  # some tools want a statement in every branch
        inside = (*self.states.remarks(step.step), *title, *transitions, n.Remark(""))
        return n.CaseBranch((self.names.step(step.index),), (beside(self.states.heading(step)), *inside))

    def _classic_transitions(self, step: NetStep, ending: Sequence[Statement]) -> list[Statement]:
        """Return the transitions behind a step in their order; each ends the actions of the step."""
        leaving = [self.net.transitions[i] for i in self.net.leaving[step.index]]
        branches: list[n.Branch] = []
        for transition in leaving:
            target = self.net.steps[transition.targets[0]]
            initial = bool(self.net.initial & target.bit)
            jump = self.texts.jump(target.step, initial=initial, back=target.index <= step.index)
            above = (*remark(self.texts.transition), *self.states.remarks(transition.transition))
            done = (*ending, self.states.entered(target.index), beside(jump))
            branches.append(n.Branch(self.source.conditions[transition.index], (*above, *done)))
        before = [each for t in leaving for each in self.source.preparations[t.index]]
        return [*before, n.If(tuple(branches))] if branches else before

    def _check_classic(self) -> None:
        """Refuse what the branches of a textbook CASE cannot hold."""
        if self.modes.selecting is not None:
            refuse_classic(self.source, "selecting steps")
        for transition in self.net.transitions:
            if not transition.targets:
                refuse_classic(self.source, "the end of a chart", f"transition {transition.path}")
        for code in self.source.step_code:
            if code.entry or code.exit:
                path = self.net.steps[code.step].path
                refuse_classic(self.source, "entry and exit actions", f"step {path}")
        for action in self.source.actions:
            for use in action.uses:
                if use.preparation:
                    refuse_classic(self.source, "blocks with a state in conditions", f"action {action.name}")
                plain = use.qualifier in (Qualifier.N, Qualifier.NONE)
                if use.inverted or not (plain or (action.target is not None and use.qualifier in _STORED)):
                    what = "an action of all other steps" if use.inverted else f"qualifier {use.qualifier}"
                    refuse_classic(self.source, what, f"action {action.name}")

    def _acting(self, action: ActionSource, use: ActionUse) -> list[Statement]:
        conditional = not is_constant(use.condition, TRUE)
        done: list[Statement]
        if action.target is None:
            done = [*action.statements]
        elif use.qualifier is Qualifier.S:
            done = [assignment(action.target, _ON)]
        elif use.qualifier in _STORED:
            done = [assignment(action.target, _OFF), beside(self.texts.reset_action)]
        elif conditional:
            return [assignment(action.target, use.condition), beside(self.texts.set_while(print_node(use.condition)))]
        else:
            return [assignment(action.target, _ON), beside(self.texts.set_action)]
        return [when(use.condition, *done)] if conditional else done

    def _ending(self, action: ActionSource, use: ActionUse) -> list[Statement]:
        if action.target is None or use.qualifier in _STORED:
            return []
        return [assignment(action.target, _OFF), beside(self.texts.reset_actions)]


_ON, _OFF = n.Literal("true"), n.Literal("false")
"""As textbooks write them."""
