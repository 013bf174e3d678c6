"""Execution of the actions of a chart, and of the entry, main and exit actions of its steps.

All actions are decided on first, then executed, those first that have ended.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from plcopen_sfc.languages.effects import path_of, reads
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.actions.action_control import ActionControlCode, SequentialControlCode
from plcopen_sfc.lowering.actions.variable_access import Effect, OwnVariables, UntouchedVariables, WrittenPaths
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    is_constant,
    negation,
    not_all,
    remark,
    when,
)
from plcopen_sfc.lowering.code.code_memory import Memory
from plcopen_sfc.lowering.code.lowered_code import StepValue, without_marks
from plcopen_sfc.lowering.lowering_options import ActionPlace, LoweringRules
from plcopen_sfc.lowering.reading.chart_source import ActionSource, ChartSource
from plcopen_sfc.semantics.profile import ActionControl as ActionControlKind
from plcopen_sfc.semantics.profile import ActionOrder, BooleanTargets


def add_actions(source: ChartSource, control: ActionControlCode | SequentialControlCode, rules: LoweringRules) -> None:
    """Append the code that drives and executes the actions, in the order of the profile."""
    actions = _in_order(source, rules)
    execution = _Execution(source, control, rules)
    acting = [action for action in actions if action.target is not None or action.statements]
    # the profile decides on all actions from one situation. Lowered one after the other, an action could see what one
    # before it has just written; that is shorter to read and right as long as none of them looks
    together = execution.interfering(acting)
    for index, action in enumerate(acting):
        if index not in together:
            execution.at_once(action)
    if together:
        execution.in_phases([acting[index] for index in sorted(together)])
    for action in actions:
        if action.target is None and not action.statements:
            execution.explain(action)
    if isinstance(control, SequentialControlCode):
        control.memory.code.add(rules.texts.steps_before, control.remember())


def add_conditions(source: ChartSource, memory: Memory, active: StepValue, rules: LoweringRules) -> None:
    """Append the blocks with a state in conditions of actions, executed while their steps drive these."""
    statements: list[Statement] = []
    for action in _in_order(source, rules):
        for use in action.uses:
            driven = disjunction(active(step) for step in use.steps)
            driven = negation(driven) if use.inverted else driven
            statements += memory.conditional(f"{action.name}_asked", driven, use.preparation)
    memory.code.add(rules.texts.conditions, statements)


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


_SHOWN_TWICE = 100
"""Characters of a decision that is written for the execution and for the end of an action, instead of a variable."""


@dataclass
class _Phases:
    """Code of actions that may see what others do, in the order in which it is executed; each list holds that of all.

    `deciding` asks for conditions and times, `idle` and `ending` reset what is off or has just ended, `behind`
    remembers decisions for the next scan. Then each action of `acting` is executed, where its expression is TRUE.
    """

    deciding: list[Statement] = field(default_factory=list)
    idle: list[Statement] = field(default_factory=list)
    ending: list[Statement] = field(default_factory=list)
    behind: list[Statement] = field(default_factory=list)
    acting: list[tuple[ActionSource, Expression]] = field(default_factory=list)


class _Execution:
    def __init__(
        self, source: ChartSource, control: ActionControlCode | SequentialControlCode, rules: LoweringRules
    ) -> None:
        self._source, self._control, self._memory, self._code = source, control, control.memory, control.memory.code
        self._texts = rules.texts
        self._verbatim = not self._code.drawn
        self._is_block = rules.actions is ActionPlace.BLOCK
        self._final_scan = rules.profile.final_scan
        self._always = rules.profile.boolean_targets is BooleanTargets.ALWAYS
        self._owned = OwnVariables(source)
        for action in source.actions:
            self._code.keep_text(action.statements, action.text)

    # -- one after the other

    def at_once(self, action: ActionSource) -> None:
        """Append a network that drives and executes an action."""
        if action.target is None:
            self._execute(action)
        else:
            statements = self._driving(action, action.target)
            self._code.add(self._texts.action(action.name), statements, self._captions(action))

    def _execute(self, action: ActionSource) -> None:
        """Append the execution of an action with a body, where the profile has it with the final scan."""
        plain = self._control.plain(action) if self._final_scan else None
        if plain is not None:  # the steps of the last scan tell that it has just ended
            self._add(action, disjunction(plain))
            return
        if self._final_scan and self._verbatim and self._add_stored(action):
            return
        statements: list[Statement] = []
        lasting, single = self._control.outputs(action, statements)
        executed = [lasting, single]
        # P1 and P0 have no final scan, and the end of what never ends would be dead code
        if self._final_scan and not is_constant(lasting, FALSE) and not self._control.never_ends(action):
            if not self._verbatim or not self._is_brief(lasting):
                lasting = executed[0] = self._memory.named(f"{action.name}_Q", lasting, statements)
            if self._verbatim:  # the scan behind the last one: whatever was on in the scan before is executed
                on = self._code.declare(self._texts.with_suffix(action.name, "before"))
                self._memory.ends.append(assignment(on, FALSE))
                self._add(action, disjunction([*executed, on]), statements, [assignment(on, lasting)])
                return
            executed.append(self._memory.falling(self._texts.with_suffix(action.name, "end"), lasting, statements))
        self._add(action, disjunction(executed), statements)

    def _driving(self, action: ActionSource, target: Expression) -> list[Statement]:
        """Return the statements that write the Boolean variable of an action, in the shortest form that is right."""
        statements: list[Statement] = []
        set_, set_back = assignment(target, TRUE), assignment(target, FALSE)
        if isinstance(self._control, SequentialControlCode):
            self._decide(action, self._control, statements)
        # one assignment is enough where the profile writes in every scan, or nothing else could have written in between
        elif (
            self._verbatim
            and not self._is_block
            and self._owned.is_false_at_rest(target)
            and (stored := self._control.set_and_reset(action)) is not None
        ):  # nothing else writes the variable: it is the memory of its action
            self._memory.latch("", *stored, statements, target)
            self._memory.ends.append(set_back)
        elif self._always or self._owned.is_false_at_rest(target):
            statements.append(assignment(target, self._control.drive(action, statements)))
        elif (plain := self._control.plain(action)) is not None:
            driven, before = plain
            statements.append(n.If((n.Branch(driven, (set_,)), n.Branch(before, (set_back,)))))
            self._memory.ends.append(when(before, set_back))
        elif self._verbatim:
            on_before: n.Name | None = None
            stored = self._control.set_and_reset(action)
            if stored is not None:  # it is active as long as it was set and not reset
                on_before = self._code.declare(f"{action.name}_S")
                driven = conjunction([disjunction([stored[0], on_before]), negation(stored[1])])
            else:
                driven = self._control.drive(action, statements)
            if is_constant(driven, FALSE):
                return []
            # other code writes this variable too: it is set back once, and left alone while its action is inactive
            on = on_before or self._code.declare(f"{action.name}_Q")
            ending = () if self._control.never_ends(action) else (n.Branch(on, (set_back, assignment(on, FALSE))),)
            statements.append(n.If((n.Branch(driven, (set_, assignment(on, TRUE))), *ending)))
            self._end_when_set_back(on, target)
        else:
            driven = self._memory.named(f"{action.name}_Q", self._control.drive(action, statements), statements)
            if not self._control.never_ends(action):
                ended = self._memory.falling(self._texts.with_suffix(action.name, "end"), driven, statements)
                statements += self._memory.conditional("", ended, [set_back])
            statements += self._memory.conditional("", driven, [set_])
            self._end_when_set_back(driven, target)
        return statements

    def _add_stored(self, action: ActionSource) -> bool:
        """Append an action that is only stored: it is reset behind its final scan. False if something else decides."""
        stored = self._control.set_and_reset(action) if isinstance(self._control, ActionControlCode) else None
        if stored is None or not self._is_of_steps(stored[1]):
            return False
        set_, reset = stored
        on = self._code.declare(f"{action.name}_S")
        self._memory.ends.append(assignment(on, FALSE))
        begins = assignment(on, disjunction([conjunction([set_, negation(reset)]), on]))
        self._add(action, on, [begins], self._memory.conditional("", reset, [assignment(on, FALSE)]))
        return True

    def _is_of_steps(self, expression: Expression) -> bool:
        """Return True if only the lowered code itself changes the value of an expression."""
        return all(path[:1] and path[0] in self._code.own_names for path in reads(expression))

    def _is_brief(self, expression: Expression) -> bool:
        """Return True if an expression has no more than two operands, whose values stay the same in the action."""
        operands = expression.operands if isinstance(expression, n.Operation) else (expression,)
        plain = not any(isinstance(node, n.Operation) for operand in operands for node in _operands_of(operand))
        return len(operands) <= 2 and plain and self._is_of_steps(expression)

    def _end_when_set_back(self, driven: Expression, target: Expression) -> None:
        """Reset a variable that its action has set when SFCInit or SFCReset ends the action: nothing else does."""
        ended = self._memory.conditional("", driven, [assignment(target, FALSE)])
        self._memory.ends += [*ended, assignment(driven, FALSE)]

    def _decide(self, action: ActionSource, control: SequentialControlCode, statements: list[Statement]) -> None:
        """Write a variable where its associations decide on it."""
        assert action.target is not None  # noqa: S101
        decision = control.decision(action, statements)
        # FALSE whenever nothing decides: one assignment instead of set and reset
        if control.never_holds(action) and self._owned.is_false_at_rest(action.target):
            statements.append(assignment(action.target, decision.on))
            return
        on, off = (assignment(action.target, each) for each in (TRUE, FALSE))
        if self._verbatim and not (is_constant(decision.on, FALSE) or is_constant(decision.off, FALSE)):
            statements.append(n.If((n.Branch(decision.on, (on,)), n.Branch(decision.off, (off,)))))
            return
        statements += self._memory.conditional("", decision.off, [off])
        statements += self._memory.conditional("", decision.on, [on])

    # -- all decided on, then all executed

    def in_phases(self, actions: Sequence[ActionSource]) -> None:
        """Append the decisions on all actions, then the code of those that have ended, then that of the others."""
        phases = _Phases()
        for action in actions:
            self._add_to(phases, action)
        self._code.add(self._texts.control, phases.deciding)
        self._code.add(self._texts.ended, [*phases.idle, *phases.ending, *phases.behind])
        for action, executed in phases.acting:
            self._add(action, executed)

    def _add_to(self, phases: _Phases, action: ActionSource) -> None:
        name, target = action.name, action.target
        # a variable is set by its action, and reset at its end
        acted = action if target is None else replace(action, statements=(assignment(target, TRUE),))
        rest = action.statements if target is None else (assignment(target, FALSE),)
        if target is not None and isinstance(self._control, SequentialControlCode):
            decision = self._control.decision(action, phases.deciding)
            off = self._memory.named(self._texts.with_suffix(name, "end"), decision.off, phases.deciding)
            driven = self._memory.named(f"{name}_Q", decision.on, phases.deciding)
            phases.idle += self._memory.conditional("", off, rest)
            phases.acting.append((acted, driven))
            return
        plain = self._control.plain(action)
        if plain is not None:  # no memory: the steps of this scan and of the last one tell all
            driven, before = plain
            phases.acting.append((acted, driven))
            if target is not None and self._always:
                phases.idle += self._memory.conditional("", not_all(driven), rest)
            elif target is not None or self._final_scan:
                phases.ending += self._memory.conditional("", conjunction([before, negation(driven)]), rest)
                self._memory.ends += [when(before, *rest)] if target is not None else []
            return
        stored = self._control.set_and_reset(action) if isinstance(self._control, ActionControlCode) else None
        if stored is not None and self._is_kept_while_on(action, *stored):
            kept = self._code.declare(f"{name}_S")
            begins = disjunction([conjunction([stored[0], negation(stored[1])]), kept])
            phases.ending.append(self._ended(action, kept, stored[1], rest))
            phases.acting.append((_marked(acted, kept), begins))
            return
        lasting, single = self._control.outputs(action, phases.deciding)
        driven = disjunction([lasting, single]) if target is not None else lasting
        alone = target is not None or is_constant(single, FALSE)
        if alone and not is_constant(driven, FALSE) and self._is_kept_while_on(action, driven):
            kept = self._code.declare(f"{name}_Q")
            phases.ending.append(self._ended(action, kept, not_all(driven), rest))
            phases.acting.append((_marked(acted, kept), driven))
        elif target is not None:
            phases.acting.append((acted, self._variable_in_phases(action, target, driven, rest, phases)))
        else:
            phases.acting.append((action, self._body_in_phases(action, lasting, single, phases)))

    def _variable_in_phases(
        self, action: ActionSource, target: Expression, driven: Expression, rest: Sequence[Statement], phases: _Phases
    ) -> Expression:
        """Reset the variable of an action with a memory at its end (`rest`); return when it is set."""
        driven = self._decided(f"{action.name}_Q", driven, phases.deciding)
        if self._always:
            phases.idle += self._memory.conditional("", not_all(driven), rest)
        elif self._control.never_ends(action):
            self._end_when_set_back(self._memory.remembered(action.name, driven, phases.behind), target)
        else:
            ended, was = self._memory.ended(action.name, driven, phases.deciding, phases.behind)
            phases.ending += self._memory.conditional("", ended, rest)
            self._end_when_set_back(was, target)
        return driven

    def _body_in_phases(
        self, action: ActionSource, lasting: Expression, single: Expression, phases: _Phases
    ) -> Expression:
        """Append the final scan of an action with a memory; return when it is executed besides."""
        name = action.name
        if not is_constant(single, FALSE):
            single = self._decided(self._texts.with_suffix(name, "pulse"), single, phases.deciding)
        if not is_constant(lasting, FALSE):
            lasting = self._decided(f"{name}_Q", lasting, phases.deciding)
            if self._final_scan and not self._control.never_ends(action):
                ended, was = self._memory.ended(name, lasting, phases.deciding, phases.behind)
                if was is not lasting:
                    self._memory.ends.append(assignment(was, FALSE))
                # a pulse in the same scan executes the action anyway: once, not twice
                last = conjunction([ended, negation(single)])
                phases.ending += self._memory.conditional(
                    self._texts.with_suffix(name, "last"), last, action.statements
                )
        return disjunction([lasting, single])

    def _is_kept_while_on(self, action: ActionSource, *asked: Expression) -> bool:
        """Return True if one variable, TRUE from the execution of an action to its end, tells that it has ended.

        What is asked for then must be the same when actions are executed, and short enough to be written twice.
        """
        ends_once = self._final_scan if action.target is None else not self._always
        return (
            (self._verbatim and ends_once and not self._is_block and not self._control.never_ends(action))
            and all(map(self._is_of_steps, asked))
            and sum(len(print_node(each)) for each in asked) <= _SHOWN_TWICE
        )

    def _ended(self, action: ActionSource, on: Expression, over: Expression, rest: Sequence[Statement]) -> Statement:
        """Return the end of an action that is `over` while it is `on`: it executes `rest`."""
        if action.target is not None:
            self._end_when_set_back(on, action.target)
        else:
            self._memory.ends.append(assignment(on, FALSE))
        return when(conjunction([on, over]), *rest, assignment(on, FALSE))

    def _decided(self, wanted: str, value: Expression, deciding: list[Statement]) -> Expression:
        """Return the decision as a variable, unless it is short and stays the same while actions are executed."""
        return value if self._verbatim and self._is_brief(value) else self._memory.named(wanted, value, deciding)

    def _add(
        self,
        action: ActionSource,
        executed: Expression,
        before: Sequence[Statement] = (),
        behind: Sequence[Statement] = (),
    ) -> None:
        """Append a network that executes an action, with its comments where its text is written as it was."""
        acting = self._memory.conditional(f"{action.name}_A", executed, action.statements)
        title = self._texts.action(action.name)
        # an output and a call have a name that tells as much as the title
        is_clear = action.in_place or action.target is not None
        is_clear |= len(action.statements) == 1 and isinstance(action.statements[0], n.CallStatement)
        inside = "" if is_clear else title
        self._code.add(title, [*before, *acting, *behind], self._captions(action), inside=inside)

    def explain(self, action: ActionSource) -> None:
        """Append the comments of an action that does nothing."""
        comments = tokenize(action.text, self._source.dialect).comments
        captions = [self._captions(action), *(without_marks(each.text).strip() for each in comments)]
        if self._verbatim:
            self._code.add(self._texts.action(action.name), remark("\n".join(captions)))

    def _captions(self, action: ActionSource) -> str:
        """Return the comments of an action and of its associations."""
        return self._texts.captions(action.comment, *(use.comment for use in action.uses))

    # -- whether it matters

    def interfering(self, actions: Sequence[ActionSource]) -> set[int]:
        """Return the actions that may see what others do: those cannot be lowered one after the other."""
        scope = UntouchedVariables(self._source, self._code.own_names)
        written = WrittenPaths(scope)
        asked: list[Effect] = []
        used: list[Effect] = []
        for index, action in enumerate(actions):
            effect = Effect(scope, action.statements)
            if action.target is not None:
                effect.writing.add(path_of(action.target))
                effect.reading |= reads(action.target) - effect.writing
            conditions = [use.condition for use in action.uses]
            times = [use.duration for use in action.uses if use.duration is not None]
            asked.append(Effect(scope, [*conditions, *times]))
            used.append(effect)
            written.add(index, effect)
        plain = {index for index, action in enumerate(actions) if action.target is not None}
        found: set[int] = set()
        any_sees = False
        for index in range(len(actions)):
            asking = written.touching(asked[index].reading, is_open=asked[index].is_open) - {index}
            # two variables do not disturb each other
            touched = written.touching(used[index].reading | used[index].writing, is_open=used[index].is_open)
            using = {each for each in touched - {index} if not plain >= {index, each}}
            if asking or using:
                found |= {index, *asking, *using}
            # a condition or time would see what an action before it has written in this scan; two bodies stay in order
            # where none of them runs once more
            any_sees |= any(each < index for each in asking)
            any_sees |= any(self._final_scan or plain & {index, each} for each in using)
        return found if any_sees else set()


def _marked(action: ActionSource, on: Expression) -> ActionSource:
    """Return an action that also makes a variable TRUE."""
    return replace(action, statements=(*action.statements, assignment(on, TRUE)))


def _operands_of(expression: Expression) -> tuple[Expression, ...]:
    inner = n.bare(expression)
    return inner.operands if isinstance(inner, n.Operation) else ()


class StepCode(NamedTuple):
    """Statements of a step, given by its index in the net; `name` is that of the step, for variables."""

    step: int
    name: str
    statements: Sequence[Statement]
