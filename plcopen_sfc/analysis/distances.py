"""Distances of conditions: how far the values of variables that are no inputs are from making one TRUE.

Conditions of a program have most of their parts in common. Each part is one object, whose distance is calculated once
for all conditions that are measured together.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from plcopen_sfc.analysis.domains import plain
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import Expression, Operator
from plcopen_sfc.semantics.programs.routines import Routines

_ELAPSED = frozenset({"T", "ET"})


@dataclass(frozen=True, eq=False, slots=True)
class Distance:
    """Distance of a condition: `made` of those of its parts; of one without parts, of what its variables are now."""

    made: Callable[[list[float]], float]
    parts: tuple[Distance, ...] = ()


NO_DISTANCE = Distance(lambda _: 0.0)
"""The distance where inputs alone decide."""


class Measurement:
    """Distances that are measured together."""

    def __init__(self, wanted: Sequence[Distance]) -> None:
        self._places: dict[Distance, int] = {}
        self._steps: list[tuple[Callable[[list[float]], float], list[int]]] = []
        self._wanted = [self._place(each) for each in wanted]

    def _place(self, distance: Distance) -> int:
        if distance not in self._places:
            parts = [self._place(each) for each in distance.parts]
            self._places[distance] = len(self._steps)
            self._steps.append((distance.made, parts))
        return self._places[distance]

    def take(self) -> list[float]:
        """Return the distances now."""
        found: list[float] = []
        for made, parts in self._steps:
            found.append(made([found[part] for part in parts]))
        return [found[place] for place in self._wanted]


def is_elapsed(tree: n.Node) -> bool:
    """True if it is the elapsed time of a step or of a timer."""
    return isinstance(tree, n.Member) and tree.name.identifier.upper() in _ELAPSED


class Distances:
    """The distances of the conditions of one system; `is_input` tells which of their operands are inputs."""

    def __init__(self, system: ProgramSystem, is_input: Callable[[str], bool]) -> None:
        self._instance = system.instance
        self._is_input = is_input
        self._found: dict[tuple[object, ...], Distance] = {}
        self._readers: dict[str, Callable[[], Any] | None] = {}

    def of(self, *trees: Expression) -> Distance:
        """Return how far the nearest of some conditions is from being TRUE."""
        found = self._joined(min, [self._of(tree, wanted=True) for tree in trees])
        self._instance.controller.library.link()
        return found

    def _of(self, tree: Expression, *, wanted: bool) -> Distance:
        match tree:
            case n.Parenthesized(inner):
                return self._of(inner, wanted=wanted)
            case n.Unary(Operator.NOT, operand):
                return self._of(operand, wanted=not wanted)
            case n.Operation(Operator.AND | Operator.AND_THEN | Operator.OR | Operator.OR_ELSE as operator, operands):
                parts = [self._of(each, wanted=wanted) for each in operands]
                return self._joined(sum if (operator in (Operator.AND, Operator.AND_THEN)) is wanted else min, parts)
            case n.Operation(operator, (left, right)) if operator in n.COMPARISONS:
                return self._compared(operator if wanted else n.OPPOSITES[operator], left, right)
        return self._boolean(tree, wanted=wanted)

    def _joined(self, made: Callable[[list[float]], float], parts: Sequence[Distance]) -> Distance:
        """Return the sum or the least of distances."""
        parts = list(dict.fromkeys(parts)) if made is min else [each for each in parts if each is not NO_DISTANCE]
        if not parts or NO_DISTANCE in parts:
            return NO_DISTANCE
        return parts[0] if len(parts) == 1 else self._once((made, *map(id, parts)), lambda: Distance(made, (*parts,)))

    def _once(self, key: tuple[object, ...], make: Callable[[], Distance]) -> Distance:
        if key not in self._found:
            self._found[key] = make()
        return self._found[key]

    def _boolean(self, tree: Expression, *, wanted: bool) -> Distance:
        value = self._value(tree)
        if value is None:
            return NO_DISTANCE
        return self._once((print_node(tree), wanted), lambda: Distance(lambda _: float(bool(value()) is not wanted)))

    def _compared(self, operator: Operator, left: Expression, right: Expression) -> Distance:
        first, second = self._value(left), self._value(right)
        if first is None or second is None or any(map(is_elapsed, (left, right))):
            return NO_DISTANCE  # a time that runs comes nearer by itself

        def distance(_: list[float]) -> float:
            a, b = first(), second()
            if isinstance(a, str) or isinstance(b, str):
                return float((a == b) is not (operator is Operator.EQUAL))
            match operator:
                case Operator.EQUAL:
                    return float(abs(a - b))
                case Operator.UNEQUAL:
                    return float(a == b)
                case Operator.LESS:
                    return float(max(a - b + 1, 0)) if a >= b else 0.0
                case Operator.LESS_OR_EQUAL:
                    return float(max(a - b, 0))
                case Operator.GREATER:
                    return float(max(b - a + 1, 0)) if a <= b else 0.0
            return float(max(b - a, 0))

        return self._once((operator, print_node(left), print_node(right)), lambda: Distance(distance))

    def _value(self, tree: Expression) -> Callable[[], Any] | None:
        """Return a reader of a value after a scan; None where it depends on inputs, or on what must not be called."""
        text = print_node(tree)
        if text not in self._readers:
            self._readers[text] = self._reader(tree, text)
        return self._readers[text]

    def _reader(self, tree: Expression, text: str) -> Callable[[], Any] | None:
        for node in walk(tree):
            if isinstance(node, n.Call) or (isinstance(node, n.Operand) and self._is_input(print_node(node))):
                return None
        instance = self._instance
        try:
            with instance.adding_nothing():  # a branch of a method has names that are known in the method alone
                function = Routines(instance.unit.scope).expression(text, instance.unit.pou.name)
        except SfcError:
            return None
        frame = instance.frame

        def value() -> Any:
            try:
                return plain(function(frame))  # an input of a block may still have what a search put there
            except (SfcError, ArithmeticError, TypeError, AttributeError, IndexError):
                return 0

        return value
