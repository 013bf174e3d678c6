"""Executing the actions of a chart: all are decided on first, then executed, those first that have ended.

Where no action sees what another one does that is the same as one after the other, which is what people would write.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from textwrap import dedent

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.effects import Path, path_of, reads, writes
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.actions.control import ActionControl
from plcopen_sfc.lowering.actions.ownership import OwnVariables, WrittenPaths, standard_instances
from plcopen_sfc.lowering.actions.sequential import SequentialControl
from plcopen_sfc.lowering.code.emitting import comment_lines
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, assignment, conjunction, disjunction, is_constant, negation
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.program import Code, StepValue, TextNetwork
from plcopen_sfc.lowering.reading.source import ActionSource, ChartSource
from plcopen_sfc.lowering.rules import LoweringRules
from plcopen_sfc.semantics.profile import ActionControl as ActionControlKind
from plcopen_sfc.semantics.profile import ActionOrder, BooleanTargets


def add_actions(
    source: ChartSource, code: Code, control: ActionControl | SequentialControl, memory: Memory, rules: LoweringRules
) -> None:
    """Append what drives and executes the actions, in the order in which the profile does."""
    actions = _in_order(source, rules)
    execution = _Execution(source, code, control, memory, rules)
    acting = [action for action in actions if action.target is not None or action.statements]
    if execution.interfere(acting):
        execution.in_phases(acting)
    else:
        for action in acting:
            execution.at_once(action)
    for action in actions:
        if action.target is None and not action.statements:
            execution.explain(action)
    if isinstance(control, SequentialControl):
        code.add(rules.texts.steps_before, control.remember())


def add_conditions(source: ChartSource, code: Code, memory: Memory, active: StepValue, rules: LoweringRules) -> None:
    """Append the blocks with a state in conditions of actions, executed while their steps drive these."""
    statements: list[Statement] = []
    for action in _in_order(source, rules):
        for use in action.uses:
            driven = disjunction(active(step) for step in use.steps)
            driven = negation(driven) if use.inverted else driven
            statements += memory.conditional(f"{action.name}_asked", driven, use.preparation)
    code.add(rules.texts.conditions, statements)


def _in_order(source: ChartSource, rules: LoweringRules) -> list[ActionSource]:
    order = rules.profile.action_order
    variables_first = rules.profile.action_control is ActionControlKind.SEQUENTIAL
    declared = {action.name.casefold(): number for number, action in enumerate(source.pou.actions)}

    def place(action: ActionSource) -> tuple[bool, int, str]:
        name = "" if action.in_place else action.name.casefold()
        late = variables_first and action.target is None
        if order is ActionOrder.ALPHABETIC:
            return late, 0, name
        return late, declared.get(name, -1) if order is ActionOrder.DECLARED else 0, ""

    return sorted(source.actions, key=place)


class _Execution:
    def __init__(
        self,
        source: ChartSource,
        code: Code,
        control: ActionControl | SequentialControl,
        memory: Memory,
        rules: LoweringRules,
    ) -> None:
        self._source, self._code, self._control, self._memory = source, code, control, memory
        self._texts = rules.texts
        self._verbatim = not code.drawn
        self._final_scan = rules.profile.final_scan
        self._always = rules.profile.boolean_targets is BooleanTargets.ALWAYS
        self._blocks = standard_instances(source)
        self._owned = OwnVariables(source)

    # -- one after the other

    def at_once(self, action: ActionSource) -> None:
        """Append a network that drives and executes an action."""
        statements: list[Statement] = []
        if action.target is None:
            lasting, single = self._control.outputs(action, statements)
            executed = disjunction([lasting, single])
            if self._final_scan and not is_constant(lasting, FALSE):
                lasting = self._memory.named(f"{action.name}_Q", lasting, statements)
                ended = self._memory.falling(self._texts.with_suffix(action.name, "end"), lasting, statements)
                executed = disjunction([lasting, single, ended])
            self._add(action, executed, statements)
            return
        if isinstance(self._control, SequentialControl):
            self._decide(action, self._control, statements)
        elif self._always or self._owned.is_false_at_rest(action.target):
            statements.append(assignment(action.target, self._control.drive(action, statements)))
        else:
            driven = self._memory.named(f"{action.name}_Q", self._control.drive(action, statements), statements)
            ended = self._memory.falling(self._texts.with_suffix(action.name, "end"), driven, statements)
            statements += self._memory.conditional("", ended, [assignment(action.target, FALSE)])
            statements += self._memory.conditional("", driven, [assignment(action.target, TRUE)])
        self._code.add(self._texts.action(action.name), statements, self._said(action))

    def _decide(self, action: ActionSource, control: SequentialControl, statements: list[Statement]) -> None:
        """Write a variable where its associations decide on it."""
        assert action.target is not None  # noqa: S101
        decision = control.decision(action, statements)
        if control.never_holds(action) and self._owned.is_false_at_rest(action.target):
            statements.append(assignment(action.target, decision.on))
            return
        statements += self._memory.conditional("", decision.off, [assignment(action.target, FALSE)])
        statements += self._memory.conditional("", decision.on, [assignment(action.target, TRUE)])

    # -- all decided on, then all executed

    def in_phases(self, actions: Sequence[ActionSource]) -> None:
        """Append what decides on all actions, what executes those that have ended, and what executes the others."""
        deciding: list[Statement] = []
        ending: list[Statement] = []
        acting: list[tuple[ActionSource, Expression]] = []
        idle: list[Statement] = []
        for action in actions:
            name = action.name
            if action.target is not None and isinstance(self._control, SequentialControl):
                decision = self._control.decision(action, deciding)
                off = self._memory.named(self._texts.with_suffix(name, "end"), decision.off, deciding)
                driven = self._memory.named(f"{name}_Q", decision.on, deciding)
                idle += self._memory.conditional("", off, [assignment(action.target, FALSE)])
                acting.append((replace(action, statements=(assignment(action.target, TRUE),)), driven))
                continue
            lasting, single = self._control.outputs(action, deciding)
            if action.target is not None:
                driven = self._memory.named(f"{name}_Q", disjunction([lasting, single]), deciding)
                rest, on = [assignment(action.target, FALSE)], assignment(action.target, TRUE)
                if self._always:
                    idle += self._memory.conditional("", negation(driven), rest)
                else:
                    ended = self._memory.falling(self._texts.with_suffix(name, "end"), driven, deciding)
                    ending += self._memory.conditional("", ended, rest)
                acting.append((replace(action, statements=(on,)), driven))
                continue
            if not is_constant(single, FALSE):
                single = self._memory.named(self._texts.with_suffix(name, "pulse"), single, deciding)
            if not is_constant(lasting, FALSE):
                lasting = self._memory.named(f"{name}_Q", lasting, deciding)
                if self._final_scan:
                    ended = self._memory.falling(self._texts.with_suffix(name, "end"), lasting, deciding)
                    last = conjunction([ended, negation(single)])
                    ending += self._memory.conditional(self._texts.with_suffix(name, "last"), last, action.statements)
            acting.append((action, disjunction([lasting, single])))
        self._code.add(self._texts.control, deciding)
        self._code.add(self._texts.ended, [*idle, *ending])
        for action, executed in acting:
            self._add(action, executed)

    def _add(self, action: ActionSource, executed: Expression, before: Sequence[Statement] = ()) -> None:
        """Append a network that executes an action: with its comments where its text can stand there."""
        title = self._texts.action(action.name)
        if not self._verbatim or not action.statements or not has_comments(action.text):
            acting = self._memory.conditional(f"{action.name}_A", executed, action.statements)
            self._code.add(title, [*before, *acting], self._said(action))
            return
        lines = print_node(n.Statements(tuple(before)), self._source.dialect).splitlines()
        lines.append(f"IF {print_node(executed, self._source.dialect)} THEN")
        lines += [f"    {line}".rstrip() for line in dedent(action.text).strip("\n").splitlines()]
        self._code.networks.append(TextNetwork(title, "\n".join([*lines, "END_IF;"]), self._said(action)))

    def explain(self, action: ActionSource) -> None:
        """Append the comments of an action that does nothing."""
        lines = comment_lines(self._said(action))
        lines += dedent(action.text).strip("\n").splitlines() if has_comments(action.text) else []
        if self._verbatim and lines:
            self._code.networks.append(TextNetwork(self._texts.action(action.name), "\n".join(lines)))

    def _said(self, action: ActionSource) -> str:
        """The comments of an action and of its associations."""
        return self._texts.said(action.comment, *(use.comment for use in action.uses))

    # -- whether it matters

    def interfere(self, actions: Sequence[ActionSource]) -> bool:
        """Whether an action may see what another one does: then they cannot be lowered one after the other."""
        written, asked, used = WrittenPaths(), [], []
        for index, action in enumerate(actions):
            if action.target is not None:
                writing = frozenset({path_of(action.target)})
                reading = frozenset(reads(action.target) - writing)
            else:
                writing = _union(writes(each, self._blocks) for each in action.statements)
                reading = _union(reads(each) for each in action.statements)
            conditions = [use.condition for use in action.uses]
            times = [use.duration for use in action.uses if use.duration is not None]
            asked.append(_union(reads(each) for each in (*conditions, *times)))
            used.append(reading | writing)
            written.add(index, writing)
        plain = {index for index, action in enumerate(actions) if action.target is not None}
        for index in range(len(actions)):
            if any(other < index for other in written.touching(asked[index])):
                return True
            for other in written.touching(used[index]) - {index}:
                # two variables do not disturb each other; two bodies stay in order where none of them runs once more
                if not plain >= {index, other} and (self._final_scan or plain & {index, other}):
                    return True
        return False


def has_comments(text: str) -> bool:
    """Whether there may be comments in structured text."""
    return any(start in text for start in ("//", "(*", "/*"))


def _union(sets: Iterable[frozenset[Path]]) -> frozenset[Path]:
    return frozenset().union(*sets)
