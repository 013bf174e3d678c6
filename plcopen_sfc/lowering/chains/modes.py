"""Operating modes: inputs that lock, step and set a chain by hand."""

from __future__ import annotations

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.chains.states import integer, step_numbers
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, assignment, conjunction, disjunction, equal, negation
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.program import BOOL, Code
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.rules import LoweringRules, OperatingMode


class Modes:
    """The operating modes of one chain. Their inputs, and the network that evaluates them, come first in its code.

    `init`: what starts the chain anew, which is stronger than all of them. `selecting`: a pulse in the scan in which
    the step of the number `selected` becomes the only active one; None where steps cannot be selected.
    """

    def __init__(
        self, source: ChartSource, code: Code, memory: Memory, rules: LoweringRules, init: Expression | None
    ) -> None:
        self._code, self._memory, self._texts, self._modes = code, memory, rules.texts, rules.modes
        self._numbers = step_numbers(source.net)
        self._statements: list[Statement] = []
        self.selecting: n.Name | None = None
        self.selected: n.Name | None = None
        if source.grafcet is not None and self._modes - {OperatingMode.ENABLE}:
            raise LoweringError(
                "charts that search for stability are not stepped by hand: one push would lead through several steps",
                location=Location(path=source.pou.name),
            )
        if OperatingMode.SELECT in self._modes and not self._numbers:
            raise LoweringError("the chart has no step that could be selected", location=Location(path=source.pou.name))
        self._usual, self._forced = self._declared(init)
        told = rules.texts.step_numbers(source.net, self._numbers) if self.selected is not None else ""
        code.add(rules.texts.modes, self._statements, told)

    def may_fire(self, condition: Expression) -> Expression:
        """When a transition whose steps are active fires, by its condition."""
        return disjunction([conjunction([condition, self._usual]), self._forced])

    def is_selected(self, step: int) -> Expression:
        """Whether a step, by its index, has the number that is selected."""
        if self.selected is None:
            return FALSE
        return equal(self.selected, self.number(step))

    def number(self, step: int) -> Expression:
        """The number by which a step, given by its index, is selected."""
        return n.Literal(str(self._numbers[step]))

    def _declared(self, init: Expression | None) -> tuple[Expression, Expression]:
        """What lets transitions fire whose conditions are TRUE, and what lets all fire whose steps are active."""
        texts, modes = self._texts, self._modes
        enable = self._input(texts.enable, at_rest=True) if OperatingMode.ENABLE in modes else TRUE
        single = self._input(texts.single_step) if OperatingMode.SINGLE_STEP in modes else FALSE
        always = self._input(texts.without_conditions) if OperatingMode.ADVANCE in modes else FALSE
        pulse: Expression = FALSE
        if modes & {OperatingMode.SINGLE_STEP, OperatingMode.ADVANCE}:
            push = self._input(texts.advance)
            pulse = self._memory.rising(self._texts.with_suffix(push.identifier, "edge"), push, self._statements)
        if OperatingMode.SELECT in modes:
            self._declare_selection(init)
        calm = [negation(self.selecting)] if self.selecting is not None else []
        usual = conjunction([enable, negation(always), disjunction([negation(single), pulse]), *calm])
        forced = conjunction([enable, always, pulse, *calm])
        if isinstance(usual, n.Operation):
            usual = self._memory.named(texts.free, usual, self._statements)
        if forced != FALSE:
            forced = self._memory.named(texts.forced, forced, self._statements)
        return usual, forced

    def _declare_selection(self, init: Expression | None) -> None:
        push = self._input(self._texts.select)
        name = self._code.naming.fresh(self._texts.selected)
        self.selected = self._code.declare_input(
            name, self._texts.comments[self._texts.selected], integer(max(self._numbers))
        )
        edge = self._memory.rising(self._texts.with_suffix(push.identifier, "edge"), push, self._statements)
        stronger = [negation(init)] if init is not None else []
        known = conjunction([edge, self._is_known(self.selected), *stronger])
        self.selecting = self._code.declare(self._texts.selecting)
        self._statements.append(assignment(self.selecting, known))

    def _is_known(self, selected: Expression) -> Expression:
        """Whether a number is that of a step: nothing is selected by any other."""
        numbers = sorted(self._numbers)
        literals = [n.Literal(str(number)) for number in numbers]
        if numbers[-1] - numbers[0] != len(numbers) - 1:
            return disjunction(equal(selected, literal) for literal in literals)
        return conjunction(
            [
                n.Operation(Operator.GREATER_OR_EQUAL, (selected, literals[0])),
                n.Operation(Operator.LESS_OR_EQUAL, (selected, literals[-1])),
            ]
        )

    def _input(self, wanted: str, *, at_rest: bool = False) -> n.Name:
        name = self._code.naming.fresh(wanted)
        return self._code.declare_input(name, self._texts.comments[wanted], BOOL, at_rest=at_rest)
