"""Edges and times of IEC 60848 in conditions (4.6), as code that is executed in every evolution."""

from __future__ import annotations

from collections.abc import Collection

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform, walk
from plcopen_sfc.languages.st.nodes import Expression, Node, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    call,
    conjunction,
    is_constant,
    negation,
    simplified,
)
from plcopen_sfc.lowering.code.lowered_code import LoweredCode
from plcopen_sfc.lowering.code_texts import Texts
from plcopen_sfc.lowering.reading.chart_source import DelayInCondition, EdgeInCondition, GrafcetSource
from plcopen_sfc.model.types import DerivedType


class TermCode:
    """Variables for the terms of a chart, and the statements that bring them up to date.

    `times` and `edges` are to be executed in this order before the transitions are tested; `starts` are values of
    variables before the first evolution. `active` gives the flag of a step.
    """

    def __init__(self, grafcet: GrafcetSource, code: LoweredCode, texts: Texts, active: Collection[Expression]) -> None:
        self._code = code
        self._texts = texts
        self._values: dict[str, Expression] = {}
        self._timers: dict[str, list[n.Name]] = {}
        self._active = set(active)
        self._inactive = {negation(each) for each in active}
        self.times: list[Statement] = []
        self.edges: list[Statement] = []
        self.starts: list[tuple[n.Name, Expression]] = []
        self._early = _written_early(grafcet)
        for delay in grafcet.delays:
            self._values[delay.name.casefold()] = self._declare_delay(delay)
        for edge in grafcet.edges:
            self._values[edge.name.casefold()] = code.declare(texts.edge_name(edge.words, rising=edge.rising))
        for delay in grafcet.delays:
            self._add_delay(delay)
        for edge in grafcet.edges:
            self._add_edge(edge)

    def named(self, node: Node) -> Node:
        """Return the variable of a term in the place of its name."""
        return self._values.get(node.identifier.casefold(), node) if isinstance(node, n.Name) else node

    def value_of(self, term: EdgeInCondition | DelayInCondition) -> Expression:
        """Return the value of a term."""
        return self._values[term.name.casefold()]

    def _declare_delay(self, delay: DelayInCondition) -> Expression:
        kinds = [(delay.first, "TON"), (delay.last, "TOF")]
        names = [
            self._code.declare(self._texts.delay_name(delay.words, time.text), DerivedType(name=kind))
            for time, kind in kinds
            if isinstance(time, n.Literal)
        ]
        self._timers[delay.name] = names
        return n.Member(names[-1], n.Name("Q"))

    def _add_delay(self, delay: DelayInCondition) -> None:
        value = transform(delay.operand, self.named)
        times = [time for time in (delay.first, delay.last) if time is not None]
        # TON, then TOF: the second delay begins when the first one has passed
        for timer, time in zip(self._timers[delay.name], times, strict=True):
            self.times.append(call(timer, IN=value, PT=time))
            value = n.Member(timer, n.Name("Q"))

    def _add_edge(self, edge: EdgeInCondition) -> None:
        pulse = self._values[edge.name.casefold()]
        assert isinstance(pulse, n.Name)  # noqa: S101  # edges are variables
        operand = transform(edge.operand, self.named)
        # the first evolution compares with the value before the start, when no step was active: ``↑X1`` of an initial
        # step is an edge, one of an input that is TRUE is none
        start = self._at_the_start(operand)
        initial = "TRUE" if (is_constant(start, TRUE) if start is not None else edge.rising) else None
        before = self._code.declare(self._texts.with_suffix(pulse.identifier, "old"), initial=initial)
        if start is not None and not is_constant(start, TRUE) and not is_constant(start, FALSE):
            self.starts.append((before, start))
        now, then = (operand, negation(before)) if edge.rising else (negation(operand), before)
        self.edges += [assignment(pulse, conjunction([now, then])), assignment(before, operand)]

    def _at_the_start(self, operand: Expression) -> Expression | None:
        """Return the value of an operand before the first evolution, with no active step; None: its present one."""
        hidden = {*self._values.values(), *self._active}
        found = False

        def without(node: Node) -> Node:
            nonlocal found
            value = FALSE if node in hidden else TRUE if node in self._inactive else node
            found = found or value is not node
            return value

        start = simplified(transform(operand, without))
        early = any(isinstance(node, n.Name) and node.identifier.casefold() in self._early for node in walk(operand))
        called = any(isinstance(node, n.Call | n.Member) for node in walk(operand))
        return start if found or early or called else None


def _written_early(grafcet: GrafcetSource) -> set[str]:
    """Return the names in stored actions, in lower case: they may change them before the first evolution."""
    trees = [tree for stored in grafcet.stored for tree in stored.statements]
    return {node.identifier.casefold() for tree in trees for node in walk(tree) if isinstance(node, n.Name)}
