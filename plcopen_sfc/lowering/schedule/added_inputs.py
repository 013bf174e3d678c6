"""Inputs that lowered code can have besides those of the chart: operating modes, restart, emergency stop."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, transform, walk
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.languages.words import free_name
from plcopen_sfc.lowering.code.boolean_logic import FALSE, TRUE, assignment, conjunction, disjunction, equal, negation
from plcopen_sfc.lowering.code.code_memory import Memory
from plcopen_sfc.lowering.code.lowered_code import BOOL, LoweredCode, integer
from plcopen_sfc.lowering.lowering_options import LoweringRules, OperatingMode
from plcopen_sfc.lowering.reading.chart_source import ChartSource, step_numbers
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.variables import SectionKind


def names_in_conditions(rules: LoweringRules, dialect: Dialect) -> set[str]:
    """Return the names that the user gives in `init` and `stop`, which are taken."""
    texts = [text for text in (rules.init, rules.stop) if text is not None]
    trees = [parse_expression(text, dialect).tree for text in texts]
    return {node.identifier for tree in trees for node in walk(tree) if isinstance(node, n.Name)}


def with_usual_input(rules: LoweringRules, source: ChartSource, surroundings: Collection[str]) -> LoweringRules:
    """Return the rules with the restart input that a textbook form has where none was asked for; or with none.

    An input of the POU of this name is taken, unless the chart reads it: then it means something else.
    """
    if rules.init or (rules.init is None and not rules.is_classic):
        return rules
    if rules.init is not None:
        return replace(rules, init=None)
    wanted = rules.texts.init_input
    inputs = (v.name for v in source.pou.variables(SectionKind.INPUT) if v.type == BOOL)
    own = next((name for name in inputs if name.casefold() == wanted.casefold()), None)
    # the textbook programs have the input already; a chart that reads it means something else by it
    if own is not None and own.casefold() not in map(str.casefold, source.names_in_texts()):
        return replace(rules, init=own)
    taken = {*surroundings, *map(str.casefold, source.names())}
    return replace(rules, init=free_name(wanted, taken))


def declare_restart(
    source: ChartSource, code: LoweredCode, rules: LoweringRules, surroundings: Collection[str]
) -> Expression | None:
    """Return a condition that is TRUE while the sequence is held in its initial steps; None if none was asked for.

    Names that are unknown in the POU and in its `surroundings` (names of the project in lower case) become inputs of
    type BOOL. Raises `LoweringError` for a condition that cannot be read.
    """
    maker = _Conditions(source, code, {*surroundings, *(name.casefold() for name in source.names())})
    init = maker.named(rules.init, rules.texts.init) if rules.init is not None else None
    stop = maker.condition(rules.stop, rules.texts.stop) if rules.stop is not None else None
    if stop is None:
        return init
    # a plain input needs no variable of its own, and textbooks have a button in the network of each step
    if init is None and isinstance(stop, n.Name) and maker.rests(stop):
        return stop
    if init is None and rules.is_classic and _is_button(stop):
        code.left_out = stop
        return stop
    restart = code.declare(rules.texts.restart, comment=rules.texts.restart_comment)
    code.add(rules.texts.init, [assignment(restart, disjunction([init, stop] if init is not None else [stop]))])
    # a condition on variables of the plant cannot be held FALSE in the proof: scans in which it is TRUE are left out
    if not maker.rests(stop):
        code.left_out = restart
    return restart


def _is_button(stop: Expression) -> bool:
    """True for a variable or its negation that has the same name in every format."""
    inner = stop.operand if isinstance(stop, n.Unary) and stop.operator is Operator.NOT else stop
    return isinstance(inner, n.Name) and inner.identifier.isidentifier() and inner.identifier.isascii()


class _Conditions:
    """Reader of conditions that declares the inputs that they need."""

    def __init__(self, source: ChartSource, code: LoweredCode, known: Collection[str]) -> None:
        self._source, self._code, self._known = source, code, known
        self._inputs: dict[str, n.Name] = {}

    def rests(self, condition: Expression) -> bool:
        """Return True if it is an input that was added, and so FALSE where the code is compared with the chart."""
        return isinstance(condition, n.Name) and condition.identifier in self._code.at_rest

    def named(self, name: str, comment: str) -> n.Name:
        """Return the input of this name, which is added if the POU has none."""
        tree = n.bare(self._parsed(name))
        if not isinstance(tree, n.Name) or tree.quoting is n.Quoting.GLOBAL:
            self._source.refuse(f"{name!r} is no name of an input", "Give one name, such as Init.")
        declared = self._declared(tree.identifier)
        if declared is not None:
            if declared != BOOL:
                self._source.refuse(f"{name} is there already, and is no BOOL", "Give the input another name.")
            if tree.identifier.casefold() in map(str.casefold, self._source.names_in_texts()):
                # the proof would hold it FALSE, and call what needs it unreachable
                hint = f"stop={name!r}, --stop {name}, restarts the chart by a condition on what it reads."
                self._source.refuse(f"{name} cannot restart the chart: the chart itself reads or writes it", hint)
            # as with an input that was added, the proof holds while it is FALSE
            self._code.at_rest[tree.identifier] = False
            return self._code.naming.local(tree.identifier)
        if tree.identifier.casefold() in self._known:
            steps = {each.step.name.casefold() for each in self._source.net.steps}
            what = "a step" if tree.identifier.casefold() in steps else "something else"
            self._source.refuse(f"{name} is the name of {what} already", "Give the input another name.")
        return self._input(tree.identifier, comment, rests=True)

    def condition(self, text: str, comment: str) -> Expression:
        """Return a condition; unknown names in it become inputs."""
        tree = n.bare(self._parsed(text))
        if isinstance(tree, n.Name) and self._is_new(tree):
            return self._input(tree.identifier, comment, rests=True)
        parts = [node.name for node in walk(tree) if isinstance(node, n.Member | n.Argument)]
        parts += [node.callee for node in walk(tree) if isinstance(node, n.Call) and isinstance(node.callee, n.Name)]
        # names of members, parameters and functions are no variables
        kept = {id(part) for part in parts}

        def added(node: n.Node) -> n.Node:
            if isinstance(node, n.Name) and id(node) not in kept and self._is_new(node):
                return self._input(node.identifier, comment, rests=False)
            return node

        return transform(tree, added)

    def _is_new(self, name: n.Name) -> bool:
        if name.quoting is n.Quoting.GLOBAL:
            return False
        return name.identifier in self._inputs or name.identifier.casefold() not in self._known

    def _input(self, name: str, comment: str, *, rests: bool) -> n.Name:
        if name not in self._inputs:
            self._inputs[name] = self._code.declare_input(name, comment, at_rest=False if rests else None)
        return self._inputs[name]

    def _declared(self, name: str) -> object:
        return next((v.type for v in self._source.pou.variables() if v.name.casefold() == name.casefold()), None)

    def _parsed(self, text: str) -> Expression:
        parsed = parse_expression(text, self._source.dialect)
        if parsed.problems:
            hint = "Write it as conditions of the project are written: NOT Stop OR Fault."
            self._source.refuse(f"{text!r} is no condition: {parsed.problems[0].message}", hint)
        return parsed.tree


class ModeInputs:
    """Operating modes of one sequence. Their inputs, and the network that evaluates them, come first in its code.

    `init`: the restart condition, which overrides them all. `selecting`: a pulse in the scan in which the step of the
    number `selected` becomes the only active one; None where steps cannot be selected.
    """

    def __init__(self, source: ChartSource, memory: Memory, rules: LoweringRules, init: Expression | None) -> None:
        self._code, self._memory, self._texts, self._modes = memory.code, memory, rules.texts, rules.modes
        self._numbers = step_numbers(source.net)
        self._statements: list[Statement] = []
        self.selecting: n.Name | None = None
        self.selected: n.Name | None = None
        if source.grafcet is not None and self._modes - {OperatingMode.ENABLE}:
            message = (
                "charts that search for stability are not stepped by hand: one push would lead through several steps"
            )
            source.refuse(message, "Leave out these modes: --mode enable is possible.")
        if OperatingMode.SELECT in self._modes and not self._numbers:
            source.refuse("the chart has no step that could be selected", "Leave out --mode select.")
        self._usual, self._forced = self._declared(init)
        comment = rules.texts.step_numbers(source.net, self._numbers) if self.selected is not None else ""
        memory.code.add(rules.texts.modes, self._statements, comment)

    def may_fire(self, condition: Expression) -> Expression:
        """Return when a transition whose steps are active fires, by its condition."""
        return disjunction([conjunction([condition, self._usual]), self._forced])

    def is_selected(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step, by its index, has the number that is selected."""
        if self.selected is None:
            return FALSE
        return equal(self.selected, self.number(step))

    def number(self, step: int) -> Expression:
        """Return the number by which a step, given by its index, is selected."""
        return n.Literal(str(self._numbers[step]))

    def _declared(self, init: Expression | None) -> tuple[Expression, Expression]:
        """Return when transitions fire whose conditions are TRUE, and when all fire whose steps are active."""
        texts, modes = self._texts, self._modes
        enable, single, always = (
            self._input(name, comment, at_rest=rest is TRUE) if mode in modes else rest
            for mode, name, comment, rest in (
                (OperatingMode.ENABLE, texts.enable, texts.enable_comment, TRUE),
                (OperatingMode.SINGLE_STEP, texts.single_step, texts.single_step_comment, FALSE),
                (OperatingMode.ADVANCE, texts.without_conditions, texts.without_conditions_comment, FALSE),
            )
        )
        pulse: Expression = FALSE
        if modes & {OperatingMode.SINGLE_STEP, OperatingMode.ADVANCE}:
            push = self._input(texts.advance, texts.advance_comment)
            pulse = self._memory.rising(self._texts.with_suffix(push.identifier, "edge"), push, self._statements)
        if OperatingMode.SELECT in modes:
            self._declare_selection(init)
        # in the scan of a selection no transition fires: the step selected would be left at once
        calm = [negation(self.selecting)] if self.selecting is not None else []
        usual = conjunction([enable, negation(always), disjunction([negation(single), pulse]), *calm])
        forced = conjunction([enable, always, pulse, *calm])
        # every transition asks for it: a variable of its own keeps them short
        if isinstance(usual, n.Operation):
            usual = self._memory.named(texts.free, usual, self._statements)
        if forced != FALSE:
            forced = self._memory.named(texts.forced, forced, self._statements)
        return usual, forced

    def _declare_selection(self, init: Expression | None) -> None:
        push = self._input(self._texts.select, self._texts.select_comment)
        name = self._code.naming.fresh(self._texts.selected)
        self.selected = self._code.declare_input(name, self._texts.selected_comment, integer(max(self._numbers)))
        edge = self._memory.rising(self._texts.with_suffix(push.identifier, "edge"), push, self._statements)
        stronger = [negation(init)] if init is not None else []
        known = conjunction([edge, self._is_known(self.selected), *stronger])
        self.selecting = self._code.declare(self._texts.selecting)
        self._statements.append(assignment(self.selecting, known))

    def _is_known(self, selected: Expression) -> Expression:
        """Return an expression that is TRUE if a number is that of a step: other numbers select nothing."""
        numbers = sorted(self._numbers)
        literals = [n.Literal(str(number)) for number in numbers]
        # numbers without a gap are a range: two comparisons
        if numbers[-1] - numbers[0] != len(numbers) - 1:
            return disjunction(equal(selected, literal) for literal in literals)
        return conjunction(
            [
                n.Operation(Operator.GREATER_OR_EQUAL, (selected, literals[0])),
                n.Operation(Operator.LESS_OR_EQUAL, (selected, literals[-1])),
            ]
        )

    def _input(self, wanted: str, comment: str, *, at_rest: bool = False) -> n.Name:
        name = self._code.naming.fresh(wanted)
        return self._code.declare_input(name, comment, BOOL, at_rest=at_rest)
