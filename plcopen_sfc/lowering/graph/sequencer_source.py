"""A sequencer of S7-GRAPH as a lowering sees it: its net, and the checks, actions and asked data of its steps."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from enum import Enum, auto
from functools import cached_property
from itertools import chain
from typing import NoReturn

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.walking import children
from plcopen_sfc.lowering.code.boolean_logic import names_in
from plcopen_sfc.lowering.reading.chart_source import ChartSource, ConditionText, SourcePart
from plcopen_sfc.model.actions import COILS, ActionEvent, Qualifier


@dataclass(frozen=True)
class ActionRow(SourcePart):
    """Action of a step. `event` is None where it acts while the step is active, `interlock`: only if that allows.

    `target` is an operand, `statements` are executed instead. `value` is the time, or the number a counter is set to.
    `switched` are the steps that ON and OFF switch.
    """

    name: str
    qualifier: Qualifier
    event: ActionEvent | None
    interlock: bool
    target: n.Expression | None = None
    statements: tuple[n.Statement, ...] = ()
    value: n.Expression | None = None
    switched: tuple[int, ...] = ()

    @property
    def is_coil(self) -> bool:
        """True if it is TRUE or FALSE with its step, and not executed."""
        return self.qualifier in COILS and self.target is not None


@dataclass(frozen=True, kw_only=True)
class GraphSource(ChartSource):
    """Sequencer that is lowered. Of `ChartSource` it uses all but actions, step code and minimum times.

    `interlocks` and `supervisions` are those of steps, by index; `rows` the actions of each step; `before` and `after`
    the permanent instructions. `parameters` are those that the block declares, by their names in upper case.
    `acknowledged`: disturbances must be; `locked`: the operating mode cannot be changed; `skips`: steps can be skipped.
    `shown` are the quantities of steps that other blocks ask for. `at_rest`: the parameters of the block that are
    inactive inputs and have no code.
    """

    interlocks: dict[int, ConditionText]
    supervisions: dict[int, ConditionText]
    rows: tuple[tuple[ActionRow, ...], ...]
    before: tuple[n.Statement, ...]
    after: tuple[n.Statement, ...]
    parameters: dict[str, str]
    acknowledged: bool
    locked: bool
    skips: bool
    shown: tuple[tuple[int, str], ...] = ()
    at_rest: tuple[str, ...] = ()

    @property
    def starts_off(self) -> bool:
        """True: a block starts its sequence in its first cycle, by a command or by itself."""
        return True

    @property
    def ends_single_steps(self) -> bool:
        """True if steps are switched off by hand."""
        return "S_OFF" in self.parameters

    @property
    def evaluates_all(self) -> bool:
        """True: all conditions are evaluated before the first transition wins."""
        return True

    @cached_property
    def prepared_names(self) -> frozenset[str]:
        """Names (lower case) in what is executed before conditions of transitions: it may change them."""
        return frozenset(names_in(*chain.from_iterable(self.preparations)))


QUANTITIES = frozenset("X T U T_MAX T_WARN SNO S1 S0 L1 L0 V1 V0 A1 R1 LS LA VS VA".split())
"""Data that texts can ask of a step."""


@dataclass(frozen=True)
class StepNames:
    """Names of a step in code: the expression that is TRUE while it is `active`, and the beginning of its variables."""

    active: n.Expression
    name: str


class CyclePhase(Enum):
    """Place of a text in a cycle.

    BEFORE: permanent instructions before the sequence. CHECK: interlocks and supervisions. SWITCH: conditions of
    transitions. ENTERED: interlocks and supervisions of steps that were entered. ACT: actions and all behind them.
    """

    BEFORE = auto()
    CHECK = auto()
    SWITCH = auto()
    ENTERED = auto()
    ACT = auto()


@dataclass(frozen=True)
class SequencerText:
    """Text of the sequencer, and the steps that are active whenever it is executed."""

    tree: n.Expression | n.Statement
    phase: CyclePhase
    active: tuple[int, ...]
    path: str


def texts_of(source: GraphSource) -> Iterator[SequencerText]:
    """Yield all texts of a sequencer."""
    tree: n.Expression | n.Statement
    # conditions are also evaluated for steps that are not active yet
    ahead = {i for rows in source.rows for row in rows for i in row.switched}
    if source.skips:
        ahead = {step.index for step in source.net.steps}
    for tree in (*source.before, *source.logic):
        yield SequencerText(tree, CyclePhase.BEFORE, (), "permanent operations before")
    for transition, condition, preparation in zip(
        source.net.transitions, source.conditions, source.preparations, strict=True
    ):
        for tree in (condition, *preparation):
            active = tuple(i for i in transition.sources if i not in ahead)
            yield SequencerText(tree, CyclePhase.SWITCH, active, f"transition {transition.path}")
    for kind, conditions in (("interlock", source.interlocks), ("supervision", source.supervisions)):
        for step, stated in conditions.items():
            for tree in (stated.value, *stated.preparation):
                yield SequencerText(tree, CyclePhase.CHECK, (step,), f"{kind} of step {source.net.steps[step].path}")
    for step, rows in enumerate(source.rows):
        for row in rows:
            owner = () if row.event is ActionEvent.S0 else (step,)
            for tree in (*row.statements, *(t for t in (row.target, row.value) if t is not None)):
                yield SequencerText(
                    tree, CyclePhase.ACT, owner, f"step {source.net.steps[step].path} / action {row.name}"
                )
    for tree in source.after:
        yield SequencerText(tree, CyclePhase.ACT, (), "permanent operations after")
    for index, quantity in source.shown:
        step_name = n.Name(source.net.steps[index].step.name, n.Quoting.LOCAL)
        yield SequencerText(n.Member(step_name, n.Name(quantity)), CyclePhase.ACT, (), "other blocks")


def step_quantity(node: n.Node, steps: dict[str, int]) -> tuple[int, str] | None:
    """Return the step and the quantity (upper case) that a node asks for; None where it asks for none."""
    match node:
        case n.Member(n.Name(name, quoting), n.Name(quantity)) if name.casefold() in steps:
            return None if quoting is n.Quoting.GLOBAL else (steps[name.casefold()], quantity.upper())
    return None


class AskedStepData:
    """Data of steps that texts ask for, and where."""

    def __init__(self, source: GraphSource) -> None:
        self.steps = {step.step.name.casefold(): step.index for step in source.net.steps}
        self._asked: dict[tuple[int, str], list[SequencerText]] = defaultdict(list)
        self._asking: set[int] = set()
        names = {*self.steps, *(t.transition.name.casefold() for t in source.net.transitions if t.transition.name)}
        for text in texts_of(source):
            for node in walk(text.tree):
                found = step_quantity(node, self.steps)
                if found is not None:
                    self._asked[found].append(text)
                    self._asking.add(id(text.tree))
            _check_names(text, text.tree, names, self.steps)
        for step, rows in enumerate(source.rows):
            for row in rows:
                if row.target is not None and step_quantity(row.target, self.steps) is not None:
                    path = f"step {source.net.steps[step].path} / action {row.name}"
                    raise LoweringError("data of steps are written", location=Location(path=path), hint=_WRITTEN)

    def __contains__(self, quantity: tuple[int, str]) -> bool:
        return quantity in self._asked

    def of(self, step: int) -> set[str]:
        """Return the quantities of a step that are asked for."""
        return {quantity for index, quantity in self._asked if index == step}

    def asked(self, step: int, quantities: Collection[str], *phases: CyclePhase) -> bool:
        """Return True if one of these is asked for in these phases."""
        return any(
            text.phase in phases
            for (index, quantity), texts in self._asked.items()
            if index == step and quantity in quantities
            for text in texts
        )

    def compared(self, step: int, quantities: Collection[str]) -> Iterator[n.Expression | None]:
        """Yield the operands that some quantities of a step are compared with; None where one is read alone."""
        trees = {id(t.tree): t.tree for q in quantities for t in self._asked.get((step, q), ())}
        wanted = {(step, quantity) for quantity in quantities}
        for tree in trees.values():
            for node in walk(tree):
                if step_quantity(node, self.steps) in wanted:
                    yield self._partner(tree, node)

    def _partner(self, tree: n.Node, asking: n.Node) -> n.Expression | None:
        for node in walk(tree):
            if isinstance(node, n.Operation) and node.operator in n.COMPARISONS and len(node.operands) == 2:
                left, right = map(n.bare, node.operands)
                if left is asking or right is asking:
                    return right if left is asking else left
        return None

    def only_while_active(self, step: int, quantity: str) -> bool:
        """Return True if it is asked for only where the step is active."""
        return all(step in text.active for text in self._asked.get((step, quantity), ()))

    def asks(self, tree: n.Node) -> bool:
        """Return True if a text of the source asks for anything of a step."""
        return id(tree) in self._asking


def _check_names(text: SequencerText, node: n.Node, names: Collection[str], steps: dict[str, int]) -> None:
    """Refuse all uses of steps and transitions, but for reading a single quantity of a step."""
    found = step_quantity(node, steps)
    if found is not None:
        if found[1] not in QUANTITIES:
            _refuse(
                text,
                f"the step data {found[1]} are not lowered yet",
                "Take them from a variable that an action writes.",
            )
        return
    if isinstance(node, n.Name) and node.identifier.casefold() in names and node.quoting is not n.Quoting.GLOBAL:
        _refuse(
            text,
            f"{node.identifier} is used in a way that is not lowered yet",
            "Ask for one quantity of a step: X, T ...",
        )
    if isinstance(node, n.Assignment) and step_quantity(node.target, steps) is not None:
        _refuse(text, "data of steps are written", _WRITTEN)
    if isinstance(node, n.Argument) and node.output and node.value and step_quantity(node.value, steps) is not None:
        _refuse(text, "data of steps are written", _WRITTEN)
    named = node.name if isinstance(node, n.Member | n.Argument) else None
    for child in children(node):
        if child is not named:
            _check_names(text, child, names, steps)


_WRITTEN = "Delete what writes them: only the sequencer does."


def _refuse(text: SequencerText, message: str, hint: str) -> NoReturn:
    raise LoweringError(message, location=Location(path=text.path), hint=hint)
