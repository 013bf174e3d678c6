"""State variables of a chart and the texts of their CASEs: one for each part with one active step at a time.

There is a state for each step, one for each wait for a convergence, and one for no step. The code writes numbers, names
of constants, or values of an enumeration. A simultaneous divergence gives the state variable of its part a state of its
own, in which the convergence is waited for. Where other code reads a state besides its own CASE, the CASE writes the
following state into a second variable.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from plcopen_sfc.analysis.regions import ParallelBlock, Region, Regions, Unstructured, find_regions
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.languages.words import objection
from plcopen_sfc.lowering.actions.action_execution import StepCode
from plcopen_sfc.lowering.code.boolean_logic import (
    assignment,
    beside,
    conjunction,
    disjunction,
    equal,
    negation,
    remark,
    simplified,
    with_known,
    without_constant,
)
from plcopen_sfc.lowering.code.lowered_code import LoweredCode, Naming, integer
from plcopen_sfc.lowering.code_texts import Texts
from plcopen_sfc.lowering.lowering_options import LoweringRules, OperatingMode, States, tool_of
from plcopen_sfc.lowering.reading.chart_source import ChartSource, number_in_name, step_numbers
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import Step, Transition
from plcopen_sfc.model.types import (
    DataType,
    DataTypeDeclaration,
    DerivedType,
    EnumType,
    EnumValue,
    SimpleValue,
)
from plcopen_sfc.semantics.net import Net, NetStep, NetTransition, indexes

_SHORT_TITLE = 60
"""Characters of a comment behind several labels of a CASE."""


@dataclass(frozen=True)
class _State:
    """State: its number, its name as a value of an enumeration and as a constant, and its comment."""

    number: int
    name: str
    constant: str
    comment: str


class StateNames:
    """States of one chart, as its code writes them. `merged` are the regions without a state of their own.

    Raises `LoweringError` where the user wants an enumeration and the target has none.
    """

    def __init__(
        self,
        source: ChartSource,
        regions: Regions,
        code: LoweredCode,
        rules: LoweringRules,
        surroundings: Collection[str],
        *,
        merged: Collection[int] = (),
    ) -> None:
        self._code, self.texts = code, rules.texts
        self.merged = merged
        self._new_value: Callable[[str, str], Expression] = lambda _, number: n.Literal(number)
        self.no_empty_statements, self.has_regions = code.is_portable, code.has_regions
        # selecting a step of one region ends all others, a forcing order all that it does not name
        left = OperatingMode.SELECT in rules.modes and len(regions.regions) > 1
        left |= source.grafcet is not None and bool(source.grafcet.ruled)
        own = [region for region in regions.regions if region.index not in merged]
        steps, waiting, none = _states(source.net, regions, rules.texts, own, left=left)
        states = [*steps, *waiting, *none]
        largest = max(state.number for state in states)
        self._type: DataType = integer(largest)
        written: list[Expression] = [n.Literal(str(state.number)) for state in states]
        self._initial = [str(state.number) for state in states]
        if rules.states is States.CONSTANTS:
            written = [self._constant(state) for state in states]
            comment = rules.texts.no_step_comment
            self._new_value = lambda name, number: self._constant(_State(int(number), name, name, comment))
        elif rules.states is States.ENUMERATION:
            _refuse_without_enumerations(source, rules)
            written = self._enumeration(states, source, rules, surroundings)
            self._initial = [print_node(value) for value in written]
        self.all: frozenset[Expression] = frozenset(written)
        self._steps = written[: len(steps)]
        self._waiting = written[len(steps) : len(steps) + len(waiting)]
        self._none = written[-1]
        self._no_number = "-1" if 0 in step_numbers(source.net) else "0"
        if none:
            self._no_number = self._initial[-1]
            self.no_state = self._none

    @cached_property
    def no_state(self) -> Expression:
        """State of no step, also where the chart always has one."""
        return self._new_value(self.texts.no_step, self._no_number)

    def are_written_alike(self, some: Sequence[Statement], others: Sequence[Statement]) -> bool:
        """Return True if the code has the same text for statements, with their comments."""
        texts = ([self._code.text_of(each[i:])[1] for i in range(len(each))] for each in (some, others))
        return some == others and next(texts) == next(texts)

    def step(self, step: int) -> Expression:
        """Return the state in which a step is active."""
        return self._steps[step]

    def waiting(self, block: ParallelBlock) -> Expression:
        """Return the state in which a region waits for the branches of a block."""
        return self._waiting[block.index]

    def start(self, region: Region) -> Expression:
        """Return the state of a region at the start: that of its initial step, else that of no step."""
        return self._none if region.initial is None else self._steps[region.initial]

    def declare(self, region: Region, suffix: str, *, following: bool) -> n.Name:
        """Declare a variable for the state of a region, or for its `following` one."""
        texts = self.texts
        if isinstance(self._type, DerivedType):
            usual = texts.active_step, texts.active_step_comment
            later = texts.next_step, texts.next_step_comment
        else:
            usual = texts.state, texts.state_comment
            later = texts.next_state, texts.next_state_comment
        name, comment = later if following else usual
        initial = self._initial[-1 if region.initial is None else region.initial]
        wanted = f"{name}_{suffix}" if suffix else name
        return self._code.declare(wanted, self._type, initial=initial, comment=comment)

    @property
    def none(self) -> Expression:
        """State in which no step of a region is active."""
        return self._none

    def declare_last(self, region: Region, suffix: str, *, entered: bool) -> n.Name:
        """Declare a variable for the state of a region in the last scan.

        `entered`: the start is an activation of the initial step, so at first it has that of no step.
        """
        texts = self.texts
        name = texts.last_step if isinstance(self._type, DerivedType) else texts.last_state
        wanted = f"{name}_{suffix}" if suffix else name
        if entered or region.initial is None:
            initial = print_node(self.no_state) if isinstance(self._type, DerivedType) else self._no_number
        else:
            initial = self._initial[region.initial]
        return self._code.declare(wanted, self._type, initial=initial, comment=texts.last_state_comment)

    def declare_copy(self, state: n.Name) -> n.Name:
        """Declare a variable for what a state variable was before."""
        declared = next(each for each in self._code.variables if each.name == state.identifier)
        initial = declared.initial.text if isinstance(declared.initial, SimpleValue) else None
        return self._code.declare(self.texts.with_suffix(declared.name, "old"), declared.type, initial=initial)

    def _constant(self, state: _State) -> n.Name:
        return self._code.declare_constant(state.constant, self._type, str(state.number), state.comment)

    def _enumeration(
        self, states: Sequence[_State], source: ChartSource, rules: LoweringRules, surroundings: Collection[str]
    ) -> list[Expression]:
        """Declare a type of its own: its values are written with its name, so that no other value can be meant."""
        used = {name.casefold() for name in source.names()}
        ascii = rules.target is not None and tool_of(rules.target, source.dialect) is not Tool.S7
        names = Naming(source.dialect, {*surroundings, *used}, ascii=ascii)
        name = names.fresh(f"{source.pou.name}_{self.texts.enumeration}")
        naming = Naming(source.dialect, (), ascii=ascii)
        enumeration = EnumType(values=[])
        self._code.data_types.append(
            DataTypeDeclaration(
                name=name,
                folder=source.pou.folder,
                place=source.pou.place,
                type=enumeration,
                comment=self.texts.enumeration_of(source.pou.name),
            )
        )
        self._type = DerivedType(name=name)

        def declared(wanted: str, number: str) -> Expression:
            value = naming.fresh(wanted)
            # edition 2 of IEC 61131-3 and matiec number values themselves, and no code asks for the numbers
            numbered = tool_of(rules.target, source.dialect) is Tool.CODESYS
            enumeration.values.append(EnumValue(name=value, value=number if numbered else None))
            if source.dialect is Dialect.CODESYS:
                return n.Member(n.Name(name), n.Name(value))
            return n.Literal(f"{name}#{value}")

        self._new_value = declared
        return [declared(state.name, str(state.number)) for state in states]


def _refuse_without_enumerations(source: ChartSource, rules: LoweringRules) -> None:
    if source.dialect is Dialect.SCL or tool_of(rules.target, source.dialect) is Tool.S7:
        message = f"there are no enumerations in {rules.target or source.dialect}"
        source.refuse(message, "Constants name the steps there as well.")


def _states(
    net: Net, regions: Regions, texts: Texts, own: Iterable[Region], *, left: bool
) -> tuple[list[_State], list[_State], list[_State]]:
    """Return the states of steps, of waits for joins, and of no step, if one of the `own` regions can have none.

    `left`: any can.
    """
    numbers = step_numbers(net)
    # waits have numbers of a hundred of their own: they stay when steps are added
    # the hundred behind the last step
    hundred = 100 * (max(numbers) // 100 + 1)
    steps: list[_State] = []
    for step, number in zip(net.steps, numbers, strict=True):
        comment = texts.step(step.step, step.path, initial=bool(net.initial & step.bit))
        constant = f"{texts.step_constant}_{_short(step.path, number)}"
        plain = step.path.replace(".", "_")
        name = constant if objection(plain, Dialect.IEC) else plain
        steps.append(_State(number, name, constant, comment))
    waits: list[_State] = []
    for block in regions.blocks:
        firsts = [net.steps[regions.first_step(regions.regions[branch])] for branch in block.branches]
        name = f"{texts.waiting_constant}_{_short(firsts[0].path, numbers[firsts[0].index])}"
        waits.append(_State(hundred + 1 + block.index, name, name, texts.waiting(step.path for step in firsts)))
    starting = all(region.initial is not None for region in own)
    if starting and not left and all(t.targets for t in net.transitions):
        return steps, waits, []
    # 0 means that no step is active, unless a step of the user has that number
    none = hundred if 0 in numbers else 0
    return steps, waits, [_State(none, texts.no_step, texts.no_step, texts.no_step_comment)]


def _short(path: str, number: int) -> str:
    """Return a step in the name of a constant: its number where its name is that number."""
    return str(number) if number_in_name(path) == number else path


def regions_of(net: Net) -> Regions | str:
    """Return the regions of a net, or why it has none that hold all of its steps."""
    found = find_regions(net)
    if isinstance(found, Unstructured):
        return found.message
    never = next((step.path for step in net.steps if found.region_of[step.index] is None), None)
    if never is None:
        return found
    if net.hierarchy:  # enclosing steps and orders activate what no transition leads to
        return f"transitions alone never activate step {never}"
    return f"step {never} can never become active"


def one_region(net: Net) -> Regions:
    """Return all steps as one region, also those that are never active; the first initial step is its own."""
    steps, transitions = (tuple(range(len(each))) for each in (net.steps, net.transitions))
    region = Region(0, steps, transitions, block=None, blocks=(), initial=indexes(net.initial)[0])
    return Regions(net, (region,), (), tuple(0 for _ in steps))


def ending_together(regions: Regions) -> frozenset[int]:
    """Return the branches of one step that nothing but the joins of their block leaves.

    Such a step is active exactly while the region that was divided waits for the join.
    """
    return frozenset(
        region.index
        for region in regions.regions
        if region.block is not None and len(region.steps) == 1 and not region.transitions and not region.blocks
    )


@dataclass(frozen=True)
class RegionState:
    """Region and its state variable. `first`: the step with which it starts, `blocks`: the divergences in it."""

    region: Region
    first: int
    blocks: tuple[ParallelBlock, ...]
    state: n.Name


class TriedTransition(NamedTuple):
    """Transition in a CASE: what must be executed before, its condition, its effect, its comment."""

    before: tuple[Statement, ...]
    condition: Expression
    effect: Sequence[Statement]
    remarks: Sequence[Statement] = ()


class StateVariables:
    """State variables of all regions of a chart, and their CASEs.

    At the start their states are those of the initial steps, or with `off` those of no step. `part`: a name for the
    chart in those of its variables.
    """

    def __init__(self, regions: Regions, names: StateNames, *, off: bool = False, part: str = "") -> None:
        self.regions, self.names, self._part = regions, names, part
        self._net, self._texts, self._off = regions.net, names.texts, off
        # no region is None: `regions_of` refuses steps that can never become active
        self._region_of = [region or 0 for region in regions.region_of]
        self._merged: dict[int, ParallelBlock] = {}
        for index in names.merged:
            (step,), block = regions.regions[index].steps, regions.blocks[regions.regions[index].block or 0]
            self._merged[step], self._region_of[step] = block, block.parent
        self._forked = {fork: block for block in regions.blocks for fork in block.forks}
        self._machines = {r.index: self._machine(r) for r in regions.regions if r.index not in names.merged}
        self.machines = tuple(self._machines.values())
        self._next = {machine.region.index: machine.state for machine in self.machines}
        self._before: dict[int, n.Name] = {}

    def _machine(self, region: Region) -> RegionState:
        blocks = tuple(self.regions.blocks[i] for i in region.blocks)
        state = self._declared(region, following=False)
        return RegionState(region, self.regions.first_step(region), blocks, state)

    def _declared(self, region: Region, *, following: bool) -> n.Name:
        at_start = replace(region, initial=None) if self._off else region
        return self.names.declare(at_start, self.suffix(region), following=following)

    def suffix(self, region: Region) -> str:
        """Return the end of the names of a region's variables: its chart or first step; of the first region nothing."""
        roots = [each for each in self.regions.regions if each.block is None]
        charts = [self._net.steps[self.regions.first_step(each)].path.rpartition(".")[0] for each in roots]
        if region in roots and all(charts) and len(set(charts)) == len(charts) > 1:  # one for each partial chart
            return charts[roots.index(region)]
        first = "" if region.index == 0 else self._net.steps[self.regions.first_step(region)].path
        return "_".join(filter(None, [self._part, first]))

    def add_following_state(self, machine: RegionState) -> None:
        """Give a region a second variable, which its CASE writes and which becomes valid later."""
        self._next[machine.region.index] = self._declared(machine.region, following=True)

    def has_following(self, machine: RegionState) -> bool:
        """Return True if a region has a second variable."""
        return self.following(machine) != machine.state

    def following(self, machine: RegionState) -> n.Name:
        """Return the variable that the CASE of a region writes."""
        return self._next[machine.region.index]

    def machine(self, region: int) -> RegionState:
        """Return a region by its index."""
        return self._machines[region]

    def machine_of(self, step: int) -> RegionState:
        """Return the region whose states a step, given by its index in the net, is one of."""
        return self._machines[self._region_of[step]]

    def is_merged(self, step: int) -> bool:
        """Return True if a step is active while a region waits, so that it has no state of its own."""
        return step in self._merged

    def state_of(self, step: int) -> Expression:
        """Return the state of `machine_of` in which a step is active."""
        return self.names.waiting(self._merged[step]) if step in self._merged else self.names.step(step)

    def steps_of(self, machine: RegionState) -> list[int]:
        """Return the steps whose states the variable of a region has."""
        return [*machine.region.steps, *(step for step, block in self._merged.items() if block in machine.blocks)]

    def active(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step is active: a comparison of the state of its region."""
        return equal(self.machine_of(step).state, self.state_of(step))

    def name(self, step: int) -> str:
        """Return the beginning of the names of a step's variables."""
        return self._texts.flag_name(self._net.steps[step].step)

    def state_before(self, machine: RegionState) -> n.Name:
        """Return a copy of the state of a region, to be made as `remembered` has it."""
        index = machine.region.index
        if index not in self._before:
            self._before[index] = self.names.declare_copy(machine.state)
        return self._before[index]

    def before(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step was active when the copies were made."""
        return equal(self.state_before(self.machine_of(step)), self.state_of(step))

    def remembered(self) -> list[Statement]:
        """Return the copies of states that are in use; complete after all calls of `before` and `changed`."""
        return [assignment(copy, self._machines[index].state) for index, copy in sorted(self._before.items())]

    def changed(self) -> Expression:
        """Return an expression that is TRUE if any state is another one than its copy."""
        return disjunction(negation(equal(each.state, self.state_before(each))) for each in self.machines)

    def set_back(self, machine: RegionState) -> Statement:
        """Return the assignment that restarts a region."""
        return assignment(self.following(machine), self.names.start(machine.region))

    def following_assignments(self) -> list[Statement]:
        """Return the assignments of the following states."""
        return [assignment(m.state, self.following(m)) for m in self.machines if self.has_following(m)]

    # -- CASEs

    def title(self, machine: RegionState) -> str:
        """Return the title of the CASE of a region."""
        if len(self.machines) == 1:
            return self._texts.chain
        return self._texts.part(self._net.steps[machine.first].path)

    def heading(self, step: NetStep) -> str:
        """Return the comment of a step's branch."""
        return self._texts.step(step.step, step.path, initial=bool(self._net.initial & step.bit))

    def remarks(self, element: Step | Transition) -> tuple[Statement, ...]:
        """Return the captions of a step or transition as comments."""
        return remark(self._texts.remark(element))

    def case(
        self,
        machine: RegionState,
        leaving: Callable[[NetStep], list[Statement]],
        joining: Callable[[ParallelBlock], list[Statement]],
    ) -> list[Statement]:
        """Return a CASE: the transitions of each step, the wait for each join; nothing if it does nothing."""
        branches: list[n.CaseBranch] = []
        is_idle = True
        for i in machine.region.steps:
            step = self._net.steps[i]
            # an empty branch is no error: the region waits in it until the join is tried by the parent
            joined = any(len(self._net.transitions[t].sources) > 1 for t in self._net.leaving[i])
            until = [beside(self._texts.until_joined)] if joined else []
            # a condition may ask for the step itself, or for others of its part
            content = self.in_branch(machine.state, self.names.step(i), leaving(step))
            remarks = self.remarks(step.step)
            is_idle &= not (content or remarks)
            done = [*remarks, *(content or [self._nothing(machine), *until])]
            branches.append(self.branch(self.names.step(i), self.heading(step), done))
        for block in machine.blocks:
            firsts = [self._net.steps[self.regions.first_step(self.regions.regions[i])] for i in block.branches]
            remarks = tuple(each for s in firsts if s.index in self._merged for each in self.remarks(s.step))
            tried = joining(block)
            is_idle &= not (tried or remarks)
            done = [*remarks, *(tried or [self._nothing(machine)])]
            heading = self._texts.waiting(step.path for step in firsts)
            branches.append(self.branch(self.names.waiting(block), heading, done))
        if is_idle and len(self.machines) > 1:  # a branch of one step waits for its end
            return []
        return [n.Case(machine.state, tuple(branches))]

    def _nothing(self, machine: RegionState) -> Statement:
        return assignment(machine.state, machine.state) if self.names.no_empty_statements else n.Empty()

    def branch(self, label: Expression, heading: str, statements: Sequence[Statement]) -> n.CaseBranch:
        """Return a branch of a CASE."""
        if self.names.has_regions:
            return n.CaseBranch((label,), (n.RegionBlock(heading, tuple(statements)),))
        return n.CaseBranch((label,), (beside(heading), *statements))

    def selection(self, selector: n.Name, parts: Iterable[StepCode], other: n.Name | None = None) -> n.Case:
        """Return a CASE with the code of single steps of a region. `other`: a state that is known to be another one."""
        by_state = grouped((self.state_of(part.step), part) for part in parts)
        alike: list[tuple[list[Expression], list[str], list[Statement]]] = []
        for state, these in by_state.items():
            found = [each for part in these for each in self.in_branch(selector, state, part.statements, other)]
            heading = self.heading(self._net.steps[these[0].step])
            same = next((each for each in alike if self.names.are_written_alike(each[2], found)), None)
            if same is None:
                alike.append(([state], [heading], found))
            else:  # steps that do the same are one branch
                same[0].append(state)
                same[1].append(heading)
        branches: list[n.CaseBranch] = []
        for labels, told, found in alike:
            title = ", ".join(told)
            # of many steps the labels are enough
            shown = [beside(title)] if len(told) == 1 or len(title) <= _SHORT_TITLE else []
            branches.append(n.CaseBranch(tuple(labels), (*shown, *found)))
        return n.Case(selector, tuple(branches))

    def in_branch(
        self, selector: Expression, state: Expression, statements: Iterable[Statement], other: Expression | None = None
    ) -> list[Statement]:
        """Return statements without what is known in the branch of a state."""
        found: list[Statement] = []
        for each in statements:
            changed = with_known(each, selector, state, self.names.all)
            changed = with_known(changed, other, None, {state}) if other is not None else changed
            found += [each] if changed is each else without_constant(simplified(changed))
        return found

    def effect(self, machine: RegionState, transition: NetTransition) -> list[Statement]:
        """Return the statements of a transition in the CASE of a region."""
        sources = [i for i in transition.sources if i not in self._merged] if len(transition.sources) > 1 else []
        joined = {self._region_of[i] for i in sources}
        found = [self.entered(i) for i in transition.targets if i not in self._merged]
        if len(transition.targets) > 1:
            block = self._forked[transition.index]
            found.insert(0, self._becoming(machine.region.index, self.names.waiting(block)))
        # the branches of a join end; a transition without a target ends its own region
        left = sorted(joined) if transition.targets else [machine.region.index]
        return found + [self._becoming(region, self.names.none) for region in left]

    def attempt(
        self,
        machine: RegionState,
        transition: NetTransition,
        condition: Expression,
        before: Sequence[Statement] = (),
        *,
        bit: Expression | None = None,
        also: Sequence[Statement] = (),
    ) -> TriedTransition:
        """Return a transition as the CASE of a region tries it.

        `before`: what its condition needs. `bit`: it was decided on before the CASEs already. `also`: its effect beside
        that on the states.
        """
        effect, remarks = [*self.effect(machine, transition), *also], self.remarks(transition.transition)
        if bit is not None:
            return TriedTransition((), bit, effect, remarks)
        # a step with one source is active where it is tried, a join is tried while its branches are
        asked = [i for i in transition.sources if i not in self._merged] if len(transition.sources) > 1 else []
        return TriedTransition(tuple(before), conjunction([*map(self.active, asked), condition]), effect, remarks)

    def competing_joins(self) -> set[int]:
        """Return joins and the transitions that compete with them by leaving one of the branches.

        They are tried in different CASEs: their order is lost there, so all of them are decided on before.
        """
        exits = ((block, self.regions.exit_competitors(block)) for block in self.regions.blocks)
        return {index for block, competing in exits if competing for index in (*block.joins, *competing)}

    def entered(self, step: int) -> Statement:
        """Return the assignment that activates a step."""
        return self._becoming(self._region_of[step], self.names.step(step))

    def _becoming(self, region: int, state: Expression) -> Statement:
        return assignment(self._next[region], state)

    def tried(self, choice: Sequence[TriedTransition]) -> list[Statement]:
        """Return IF and ELSIF in the order of the transitions; ELSE where something must be executed between them.

        The last one has ELSE, or no condition, if its condition is TRUE.
        """
        ahead: list[Statement] = []
        branches: list[n.Branch] = []
        for number, each in enumerate(choice):
            # ELSIF has no place for statements: they must be executed only if the transitions before were not satisfied
            if branches and each.before:
                return [*ahead, n.If(tuple(branches), tuple(self.tried(choice[number:])))]
            done = (*each.remarks, *each.effect)
            if each.before:
                ahead, done = [*each.remarks, *each.before], (*each.effect,)
            branches.append(n.Branch(each.condition, done))
        return [*ahead, *without_constant(n.If(tuple(branches)))] if branches else []


def branch_content(branch: n.CaseBranch) -> tuple[Statement, ...]:
    """Return the statements of a branch that `StateVariables.branch` has made, without its heading."""
    match branch.statements:
        case (n.RegionBlock(_, statements),):
            return statements
        case (n.Remark(beside=True), *statements):
            return tuple(statements)
    return branch.statements
