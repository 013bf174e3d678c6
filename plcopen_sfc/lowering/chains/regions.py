"""One CASE for each part of a chart in which one step is active at a time.

All of them look at the situation as it was and write that which is to be: no CASE sees what another one has just done,
whatever their order. A fork gives the state variable of its part a state of its own, in which the join is waited for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from plcopen_sfc.analysis.regions import ParallelBlock, Region, Regions, Unstructured, find_regions
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.chains.chain import Chain
from plcopen_sfc.lowering.chains.rivals import firing_together
from plcopen_sfc.lowering.chains.states import StateNames
from plcopen_sfc.lowering.code.emitting import comment_lines
from plcopen_sfc.lowering.code.logic import (
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
from plcopen_sfc.lowering.code.program import TextNetwork
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.rules import States
from plcopen_sfc.model.sfc import SfcFlag, Step, Transition
from plcopen_sfc.semantics.net import Net, NetStep, NetTransition
from plcopen_sfc.semantics.profile import ScanOrder

INDENT = "    "


def no_regions(source: ChartSource) -> str:
    """Why a chart is not built of regions that one CASE each can hold; empty if it is."""
    found = _regions(source.net)
    return found if isinstance(found, str) else ""


def _regions(net: Net) -> Regions | str:
    """The regions of a net, or why it has none that hold all of its steps."""
    found = find_regions(net)
    if isinstance(found, Unstructured):
        return found.message
    never = next((step.path for step in net.steps if found.region_of[step.index] is None), None)
    return found if never is None else f"step {never} can never become active"


@dataclass(frozen=True)
class Machine:
    """A region and its state variable. `first`: the step with which it starts, `blocks`: what is forked from it."""

    region: Region
    first: int
    blocks: tuple[ParallelBlock, ...]
    state: n.Name


class _Try(NamedTuple):
    """A transition as the CASE tries it: what must be executed before, its condition, and what it does."""

    before: tuple[Statement, ...]
    condition: Expression
    effect: list[str]
    remarks: list[str]


class RegionChain(Chain):
    """Lowers one chart into `code`. Raises `LoweringError` where it is not built of regions."""

    def declare_states(self, source: ChartSource) -> None:
        """A state variable for each region, that of the initial step at the start, else that of no step."""
        self._refuse_rivals(source)
        self._regions = self.structure(source)
        self._region_of = [r or 0 for r in self._regions.region_of]
        self.names = StateNames(source, self._regions, self.code, self.rules, self.surroundings)
        self._forked = {fork: block for block in self._regions.blocks for fork in block.forks}
        self.machines = tuple(self._machine(region) for region in self._regions.regions)
        self._next = {machine.region.index: machine.state for machine in self.machines}
        self._bits: dict[int, n.Name] = {}
        for index in self._needing_bits(source):
            transition = self.net.transitions[index]
            comment = self.texts.transition_of(transition.path)
            self._bits[index] = self.code.declare(self.texts.transition_name(self.net, transition), comment=comment)
        self._again: dict[int, n.Name] = {}

    def active(self, step: int) -> Expression:
        """A comparison of the state of its region."""
        return equal(self.machines[self._region_of[step]].state, self.names.step(step))

    def exact(self) -> None:
        """One scan, as the chart has it."""
        for machine in self.machines:
            if self._must_wait(machine):
                self._next[machine.region.index] = self._declared(machine.region, following=True)
        super().exact()

    def choose(self) -> None:
        """Append the CASE of each region with the transitions of each step."""
        self.code.add(self.texts.transitions, list(self._computed_bits()))
        self._declare_again()
        self.code.add("", [assignment(flag, FALSE) for flag in self._again.values()])
        for machine in self.machines:
            lines = self._guarded(machine, self._case(machine))
            self.code.networks.append(TextNetwork(self._title(machine), "\n".join(lines)))

    def select(self) -> None:
        """Append what makes the selected step the state of its region, and leaves all others without a step."""
        selecting, selected = self.modes.selecting, self.modes.selected
        if selecting is None or selected is None:
            return
        named = self.rules.states is States.ENUMERATION
        if len(self.machines) == 1 and not named:
            state = self._next[self.machines[0].region.index]
            self.code.add(self.texts.selection, [when(selecting, assignment(state, selected))])
            return
        ended: list[Statement] = []
        if len(self.machines) > 1:
            ended = [assignment(self._next[machine.region.index], self.names.none) for machine in self.machines]
        branches: list[n.CaseBranch] = []
        for machine in self.machines:
            state, numbers = self._next[machine.region.index], [self.modes.number(i) for i in machine.region.steps]
            if named:
                states = [assignment(state, self.names.step(i)) for i in machine.region.steps]
                branches += [n.CaseBranch((each,), (to,)) for each, to in zip(numbers, states, strict=True)]
            else:
                branches.append(n.CaseBranch(tuple(numbers), (assignment(state, selected),)))
        chosen = n.Case(selected, tuple(branches))
        self.code.add(self.texts.selection, [when(selecting, *ended, chosen)])

    def move(self) -> None:
        """Append what makes the states those that they are to be, where that had to wait."""
        waiting = [machine for machine in self.machines if self._waits(machine)]
        restart = [when(self.init, *map(self._restarted, waiting))] if self.init is not None and waiting else []
        moves = [assignment(machine.state, self._next[machine.region.index]) for machine in waiting]
        self.code.add(self.texts.moves, [*restart, *moves])

    def any_fires(self) -> Expression:
        """Whether any state will be another one, or a step is left and entered at once."""
        changes = [negation(equal(self._next[m.region.index], m.state)) for m in self.machines]
        return disjunction([*changes, *self._again.values()])

    def reentered(self) -> Mapping[int, Expression]:
        """Steps that a transition leaves and enters at once: a flag that it sets, where anything asks for that."""
        return self._again

    def text(self, node: n.Node) -> str:
        """A node in the dialect of the code."""
        return print_node(node, self.source.dialect)

    # -- structure

    def structure(self, source: ChartSource) -> Regions:
        """The regions of the chart. Raises `LoweringError` where it is not built of them."""
        found = _regions(source.net)
        if isinstance(found, str):
            raise LoweringError(
                f"the chart is not built of parts that one CASE each could hold: {found}",
                location=Location(path=source.pou.name),
                hint="Step bits can hold every chart.",
            )
        return found

    def _refuse_rivals(self, source: ChartSource) -> None:
        rival = firing_together(source.net, self.profile)
        if rival is not None:
            raise LoweringError(
                f"a CASE cannot hold rivals that fire together under the profile {self.profile.name}",
                location=Location(path=f"{source.pou.name} / transition {rival.path}"),
                hint="Step bits can.",
            )

    def _machine(self, region: Region) -> Machine:
        blocks = tuple(self._regions.blocks[i] for i in region.blocks)
        state = self._declared(region, following=False)
        return Machine(region, self._regions.first_step(region), blocks, state)

    def _declared(self, region: Region, *, following: bool) -> n.Name:
        """The variable of a region, that of its state now or the `following` one.

        Those of the first region of the chart have no step in their name.
        """
        first = self.net.steps[self._regions.first_step(region)].path
        return self.names.declare(region, "" if region.index == 0 else first, following=following)

    def _restarted(self, machine: Machine) -> Statement:
        """The assignment that starts a region anew."""
        return assignment(self._next[machine.region.index], self.names.start(machine.region))

    # -- states that change behind all CASEs

    def _must_wait(self, machine: Machine) -> bool:
        """Whether anything looks at the state of a region, or writes it, besides its own CASE."""
        if self.profile.order is ScanOrder.ACTIONS_FIRST or machine.blocks or machine.region.block is not None:
            return True
        return bool(self._askers.get(machine.state.identifier, set()) - {machine.region.index})

    @cached_property
    def _askers(self) -> dict[str, set[int]]:
        """By the names that conditions ask for: the regions in whose CASE that is done."""
        found: dict[str, set[int]] = {}
        for transition in self.net.transitions:
            region = self._region_of[transition.sources[0]]
            for tree in (self.source.conditions[transition.index], *self.source.preparations[transition.index]):
                for node in walk(tree):
                    if isinstance(node, n.Name):
                        found.setdefault(node.identifier, set()).add(region)
        return found

    def _waits(self, machine: Machine) -> bool:
        return self._next[machine.region.index] != machine.state

    def _guarded(self, machine: Machine, case: list[str]) -> list[str]:
        """A CASE that is not executed while no transition may fire."""
        if not self.blocking:
            return case
        blocked = disjunction(self.blocking)
        if self._waits(machine) or self.init is None:  # it is set back where it changes
            head = [f"IF {self.text(negation(blocked))} THEN"]
        else:
            head = [f"IF {self.text(blocked)} THEN", INDENT + self.text(self._restarted(machine)), "ELSE"]
        return [*head, *(INDENT + line for line in case), "END_IF;"]

    # -- transitions whose rivals are tried in another CASE

    def _needing_bits(self, source: ChartSource) -> list[int]:
        """Joins that have rivals, with these; joins before whose condition something must be executed."""
        found: set[int] = set()
        for block in self._regions.blocks:
            rivals = self._regions.exit_rivals(block)
            if rivals:
                found.update(block.joins, rivals)
            found.update(join for join in block.joins if source.preparations[join])
        return sorted(found)

    def _computed_bits(self) -> Iterator[Statement]:
        for index, bit in self._bits.items():
            transition = self.net.transitions[index]
            free = [negation(self._bits[rival]) for rival in transition.rivals if rival in self._bits]
            free += [negation(each) for each in self.blocking]
            enabled = self._enabled(transition)
            yield from self.prepared(index, conjunction([enabled, *free]))
            yield assignment(bit, conjunction([enabled, self.source.conditions[index], *free]))

    def _enabled(self, transition: NetTransition) -> Expression:
        return conjunction(self.active(i) for i in transition.sources)

    # -- steps that are left and entered at once

    def _declare_again(self) -> None:
        reported = SfcFlag.TRANS in self.source.flags
        # where steps change between two scans such a step is never seen to be left
        timed = self.profile.order is ScanOrder.TRANSITIONS_FIRST
        for transition in self.net.transitions:
            for step in set(transition.sources) & set(transition.targets):
                if (reported or (timed and self.times.measures(step))) and step not in self._again:
                    path = self.net.steps[step].path
                    wanted = self.texts.with_suffix(self.texts.flag_name(self.net.steps[step].step), "again")
                    self._again[step] = self.code.declare(wanted, comment=self.texts.again_of(path))

    # -- the CASE of one region

    def _title(self, machine: Machine) -> str:
        if len(self.machines) == 1:
            return self.texts.chain
        return self.texts.part(self.net.steps[machine.first].path)

    def _case(self, machine: Machine) -> list[str]:
        lines = [f"CASE {self.text(machine.state)} OF"]
        for i in machine.region.steps:
            step = self.net.steps[i]
            leaving = [self.net.transitions[t] for t in self.net.leaving[i]]
            choice = [self._try(machine, t) for t in leaving if len(t.sources) == 1]
            idle = f"; // {self.texts.until_joined}" if len(choice) < len(leaving) else ";"
            content = self._tried(choice) or [idle]
            lines += self._branch(self.names.step(i), self.heading(step), [*self.remarks(step.step), *content])
        for block in machine.blocks:
            firsts = [self.net.steps[self.machines[branch].first].path for branch in block.branches]
            choice = [self._try(machine, self.net.transitions[t]) for t in block.joins]
            lines += self._branch(self.names.waiting(block), self.texts.waiting(firsts), self._tried(choice) or [";"])
        return [*lines, "END_CASE;"]

    def _branch(self, label: Expression, heading: str, lines: list[str]) -> list[str]:
        comment = " ".join(heading.split())  # a line break in a name would end it
        return [f"{INDENT}{self.text(label)}: // {comment}", *(INDENT * 2 + line for line in lines)]

    def heading(self, step: NetStep) -> str:
        """The comment of a step's branch."""
        return self.texts.step(step.step, step.path, initial=bool(self.net.initial & step.bit))

    def remarks(self, element: Step | Transition) -> list[str]:
        """What the chart says of a step or transition, as comments."""
        return comment_lines(self.texts.remark(element))

    def _try(self, machine: Machine, transition: NetTransition) -> _Try:
        effect = self._effect(machine, transition)
        remarks = self.remarks(transition.transition)
        if transition.index in self._bits:
            return _Try((), self._bits[transition.index], effect, remarks)
        # a step with one source is active where it is tried, a join is tried while its branches are
        enabled = TRUE if len(transition.sources) == 1 else self._enabled(transition)
        condition = conjunction([enabled, self.source.conditions[transition.index]])
        before = self.source.preparations[transition.index]
        asked = self.sfc_flags.is_asked()
        if before and not is_constant(asked, TRUE):
            before = (when(asked, *before),)
        return _Try(before, condition, effect, remarks)

    def _effect(self, machine: Machine, transition: NetTransition) -> list[str]:
        joined = {self._region_of[i] for i in transition.sources} if len(transition.sources) > 1 else set()
        lines = [self.entered(i) for i in transition.targets]
        if len(transition.targets) > 1:
            block = self._forked[transition.index]
            lines.insert(0, self._becoming(machine.region.index, self.names.waiting(block)))
        left = sorted(joined) if transition.targets else [machine.region.index]
        lines += [self._becoming(region, self.names.none) for region in left]
        loops = set(transition.sources) & set(transition.targets) & set(self._again)
        return lines + [f"{self.text(self._again[i])} := TRUE;" for i in loops]

    def entered(self, step: int) -> str:
        """The assignment that activates a step."""
        return self._becoming(self._region_of[step], self.names.step(step))

    def _becoming(self, region: int, state: Expression) -> str:
        return self.text(assignment(self._next[region], state))

    def _tried(self, choice: Sequence[_Try]) -> list[str]:
        """IF and ELSIF in the order in which they are tried; ELSE where something must be executed between them.

        The last one stands in ELSE, or alone, if its condition is TRUE.
        """
        lines: list[str] = []
        for number, each in enumerate(choice):
            if lines and each.before:
                return [*lines, "ELSE", *(INDENT + line for line in self._tried(choice[number:])), "END_IF;"]
            lines += each.remarks
            if each.before:
                lines += self.text(n.Statements(each.before)).splitlines()
            opened = number > 0
            if number == len(choice) - 1 and is_constant(each.condition, TRUE):
                return (
                    [*lines, "ELSE", *(INDENT + x for x in each.effect), "END_IF;"] if opened else lines + each.effect
                )
            lines.append(f"{'ELSIF' if opened else 'IF'} {self.text(each.condition)} THEN")
            lines += [INDENT + line for line in each.effect]
        return [*lines, "END_IF;"] if lines else []
