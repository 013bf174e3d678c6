"""What the states of a CASE are: one for each step, one for each wait for a join, and one for no step at all.

All of them have numbers. The code writes these, names of constants, or values of an enumeration.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import count

from plcopen_sfc.analysis.regions import ParallelBlock, Region, Regions
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.names.words import objection
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering.code.naming import Naming
from plcopen_sfc.lowering.code.program import INT, Code
from plcopen_sfc.lowering.code.targets import tool_of
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.rules import LoweringRules, OperatingMode, States
from plcopen_sfc.lowering.texts import Texts, step_digits
from plcopen_sfc.model.types import (
    DataType,
    DataTypeDeclaration,
    DerivedType,
    Elementary,
    ElementaryType,
    EnumType,
    EnumValue,
)
from plcopen_sfc.semantics.net import Net

_LARGEST_INT = 32_767
_LARGEST_DINT = 2_147_483_647
_MOST_DIGITS = 9
"""Numbers that every DINT holds."""
_SPARE = 100_000
"""Numbers that waits can have behind those of the steps."""


def step_numbers(net: Net) -> list[int]:
    """A number for each step: its own, else that which its name says (``S3``), else the next one that is free.

    Of steps that have the same number the first one keeps it.
    """
    wanted = [step.step.number if step.step.number is not None else _said(step.step.name) for step in net.steps]
    kept: dict[int, int] = {}
    for step, number in enumerate(wanted):
        if number is not None and 0 <= number < _LARGEST_DINT - _SPARE:
            kept.setdefault(number, step)
    numbers = {step: number for number, step in kept.items()}
    free = (number for number in count(1) if number not in kept)
    return [numbers[step] if step in numbers else next(free) for step in range(len(wanted))]


def integer(largest: int) -> ElementaryType:
    """The type of numbers up to `largest`: INT where it holds them, else DINT."""
    return INT if largest <= _LARGEST_INT else ElementaryType(name=Elementary.DINT)


def _said(name: str) -> int | None:
    digits = step_digits(name)
    return int(digits) if 0 < len(digits) <= _MOST_DIGITS else None


@dataclass(frozen=True)
class _State:
    """A state: its number, its name as a value of an enumeration and as a constant, and what it means."""

    number: int
    name: str
    constant: str
    comment: str


class StateNames:
    """The states of one chart, as its code writes them.

    Raises `LoweringError` where the user wants an enumeration and the target has none.
    """

    def __init__(
        self, source: ChartSource, regions: Regions, code: Code, rules: LoweringRules, surroundings: Collection[str]
    ) -> None:
        self._code, self._texts = code, rules.texts
        # where steps are selected, the regions of all others have none
        left = OperatingMode.SELECT in rules.modes and len(regions.regions) > 1
        steps, waiting, none = _states(source.net, regions, rules.texts, left=left)
        states = [*steps, *waiting, *none]
        largest = max(state.number for state in states)
        self._type: DataType = integer(largest)
        written: list[Expression] = [n.Literal(str(state.number)) for state in states]
        self._initial = [str(state.number) for state in states]
        if rules.states is States.CONSTANTS:
            written = [self._constant(state) for state in states]
        elif rules.states is States.ENUMERATION:
            _refuse_without_enumerations(source, rules)
            written = self._enumeration(states, source, surroundings)
            self._initial = [print_node(value, source.dialect) for value in written]
        self._steps = written[: len(steps)]
        self._waiting = written[len(steps) : len(steps) + len(waiting)]
        self._none = written[-1]

    def step(self, step: int) -> Expression:
        """The state in which a step is active."""
        return self._steps[step]

    def waiting(self, block: ParallelBlock) -> Expression:
        """The state in which a region waits for the branches of a block."""
        return self._waiting[block.index]

    def start(self, region: Region) -> Expression:
        """The state of a region at the start: that of its initial step, else that in which none of its steps is."""
        return self._none if region.initial is None else self._steps[region.initial]

    def declare(self, region: Region, suffix: str, *, following: bool) -> n.Name:
        """A variable for the state of a region, or for its `following` one."""
        texts = self._texts
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
        """The state in which no step of a region is active."""
        return self._none

    def _constant(self, state: _State) -> n.Name:
        return self._code.declare_constant(state.constant, self._type, str(state.number), state.comment)

    def _enumeration(
        self, states: Sequence[_State], source: ChartSource, surroundings: Collection[str]
    ) -> list[Expression]:
        """Declare a type of its own: its values are written with its name, so nothing else can be meant."""
        used = {name.casefold() for name in source.names()}
        name = Naming(source.dialect, {*surroundings, *used}).fresh(f"{source.pou.name}_{self._texts.enumeration}")
        naming = Naming(source.dialect, ())
        values = [naming.fresh(state.name) for state in states]
        listed = [EnumValue(name=v, value=str(state.number)) for v, state in zip(values, states, strict=True)]
        self._code.data_types.append(
            DataTypeDeclaration(
                name=name,
                folder=source.pou.folder,
                place=source.pou.place,
                type=EnumType(values=listed),
                comment=self._texts.enumeration_of(source.pou.name),
            )
        )
        self._type = DerivedType(name=name)
        if source.dialect is Dialect.CODESYS:
            return [n.Member(n.Name(name), n.Name(value)) for value in values]
        return [n.Literal(f"{name}#{value}") for value in values]


def _refuse_without_enumerations(source: ChartSource, rules: LoweringRules) -> None:
    if source.dialect is Dialect.SCL or tool_of(rules.target, source.dialect) is Tool.S7:
        raise LoweringError(
            f"there are no enumerations in {rules.target or source.dialect}",
            location=Location(path=source.pou.name),
            hint="Constants name the steps there as well.",
        )


def _states(net: Net, regions: Regions, texts: Texts, *, left: bool) -> tuple[list[_State], list[_State], list[_State]]:
    """The states of the steps, of the waits for joins, and of no step, where that can be: any region can be `left`."""
    numbers = step_numbers(net)
    # waits have numbers of a hundred of their own: they stay when steps are added
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
    starting = all(region.initial is not None for region in regions.regions)
    if starting and not left and all(t.targets for t in net.transitions):
        return steps, waits, []
    none = hundred if 0 in numbers else 0
    return steps, waits, [_State(none, texts.no_step, texts.no_step, texts.no_step_comment)]


def _short(path: str, number: int) -> str:
    """A step in the name of a constant: its number where its name says nothing else."""
    return str(number) if _said(path) == number else path
