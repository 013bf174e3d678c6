"""A sequencer of S7-GRAPH as a lowering sees it: besides its net what its steps check and do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.reading.texts import ConditionText
from plcopen_sfc.model.actions import ActionEvent, Qualifier

COILS = frozenset({Qualifier.N, Qualifier.D, Qualifier.L})
SWITCHES = frozenset({Qualifier.ON, Qualifier.OFF})
COUNTERS = frozenset({Qualifier.CS, Qualifier.CU, Qualifier.CD, Qualifier.CR})
TIMERS = frozenset({Qualifier.TL, Qualifier.TD, Qualifier.TR, Qualifier.TF})


@dataclass(frozen=True)
class Row:
    """An action of a step. `event` is None where it acts while the step is active, `interlock`: only if that allows.

    `target` is an operand, `statements` what is executed instead. `value` is the time, or the number a counter is set
    to. `switched` are the steps that ON and OFF switch.
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
        """Whether it is TRUE or FALSE with its step, and not executed."""
        return self.qualifier in COILS and self.target is not None


@dataclass(frozen=True, kw_only=True)
class GraphSource(ChartSource):
    """What is lowered. Of `ChartSource` it uses all but actions, step code and minimum times.

    `interlocks` and `supervisions` are those of steps, by index; `rows` the actions of each step; `before` and `after`
    the permanent operations. `parameters` are those that the block declares, by their names in upper case.
    `acknowledged`: disturbances must be; `locked`: the operating mode cannot be changed; `skips`: steps can be skipped.
    `shown` are the quantities of steps that other blocks ask for. `at_rest`: the inputs of the block that are
    parameters and have no code, since nobody operates them.
    """

    interlocks: dict[int, ConditionText]
    supervisions: dict[int, ConditionText]
    rows: tuple[tuple[Row, ...], ...]
    before: tuple[n.Statement, ...]
    after: tuple[n.Statement, ...]
    parameters: dict[str, str]
    acknowledged: bool
    locked: bool
    skips: bool
    shown: tuple[tuple[int, str], ...] = ()
    at_rest: tuple[str, ...] = ()

    @cached_property
    def prepared_names(self) -> frozenset[str]:
        """The names (lower case) in what is executed before conditions of transitions: it may change them."""
        trees = chain.from_iterable(self.preparations)
        return frozenset(node.identifier.casefold() for t in trees for node in walk(t) if isinstance(node, n.Name))

    def _trees(self) -> Iterator[n.Node]:
        yield from super()._trees()
        yield from (*self.before, *self.after)
        for condition in (*self.interlocks.values(), *self.supervisions.values()):
            yield from (*condition.preparation, condition.value)
        for row in (row for rows in self.rows for row in rows):
            yield from row.statements
            yield from (tree for tree in (row.target, row.value) if tree is not None)
