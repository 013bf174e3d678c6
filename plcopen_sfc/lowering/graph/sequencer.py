"""One cycle of a sequencer as structured text, in the order of S7-GRAPH.

Permanent operations, commands, interlocks and supervisions, step change, events, actions, outputs, permanent
operations. What the block does not declare and what nobody asks for makes no code.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.chains.restart import declare_restart
from plcopen_sfc.lowering.code.logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    is_constant,
    negation,
    when,
)
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.program import Code
from plcopen_sfc.lowering.graph.actions import Actions, StepSignals
from plcopen_sfc.lowering.graph.checks import Asked, StepChecks
from plcopen_sfc.lowering.graph.commands import Commands
from plcopen_sfc.lowering.graph.reports import add_reports
from plcopen_sfc.lowering.graph.shown import show
from plcopen_sfc.lowering.graph.skipping import add_skips
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.lowering.graph.step_data import Phase, Questions, step_quantity
from plcopen_sfc.lowering.graph.texts import graph_texts
from plcopen_sfc.lowering.graph.times import StepClock
from plcopen_sfc.lowering.rules import LoweringRules
from plcopen_sfc.model.actions import ActionEvent, Qualifier
from plcopen_sfc.model.text import plain
from plcopen_sfc.semantics.charts.graph.parameters import Mode
from plcopen_sfc.semantics.net import NetTransition, Rivals

_STEP_EVENTS = frozenset({"S1", "S0", "R1"})
_LIMITS = {"T_MAX": "max_time", "T_WARN": "warning_time"}


class Sequencer:
    """Lowers one sequencer into `code`: a bit for each step, a bit for each transition."""

    def __init__(
        self,
        source: GraphSource,
        code: Code,
        memory: Memory,
        rules: LoweringRules,
        surroundings: Collection[str] = (),
    ) -> None:
        self.source, self.code, self.memory, self.rules = source, code, memory, rules
        self.net, self.texts = source.net, rules.texts
        self.own_texts = graph_texts(rules.texts)
        self.init = declare_restart(source, code, rules, surroundings)
        code.declare_helpers(source.helpers)
        self.flags = [
            code.declare(self.texts.flag_name(step.step), comment=self.texts.flag_of(step.path))
            for step in self.net.steps
        ]
        self.fired = [
            code.declare(self.texts.transition_name(self.net, t), comment=self.texts.transition_of(t.path))
            for t in self.net.transitions
        ]
        self.first = code.declare("FirstScan", initial="TRUE", comment=self.own_texts.first_cycle)
        self.questions = Questions(source)
        self.commands = Commands(source, code, memory, self.own_texts)
        self.clock = StepClock(source, code, self.flags, self.texts, self.questions)
        self._events: dict[tuple[int, ActionEvent], n.Name] = {}
        self._old: dict[int, n.Name] = {}
        self._left_before: dict[int, tuple[n.Name, Expression]] = {}
        self.checks = [self._checks_of(step.index) for step in self.net.steps]
        switched = {i for rows in source.rows for row in rows for i in row.switched}
        self.wanted = {
            i: code.declare(
                f"{self.flags[i].identifier}_next", comment=self.own_texts.wanted_of(self.net.steps[i].path)
            )
            for i in sorted(switched)
        }

    def _checks_of(self, step: int) -> StepChecks:
        needed = self.questions.of(step)
        for row in self.source.rows[step]:
            needed |= {row.event.value} if row.event is not None else set()
            needed |= {"LS"} if row.interlock else set()
        if "ERR_FLT" in self.source.parameters or "U" in needed:
            needed |= {"LS", "VA"}
        return StepChecks(self.source, step, self.code, Asked(self.flags[step], needed, self.questions))

    def tells(self) -> dict[str, Expression]:
        """What tells that a step is active, by its path."""
        return {step.path: self.flags[step.index] for step in self.net.steps}

    def active(self, step: int) -> Expression:
        """What tells that a step is active."""
        return self.flags[step]

    def exact(self) -> None:
        """One cycle."""
        code, own_texts = self.code, self.own_texts
        code.add(own_texts.before, [*self._resolved(self.source.before, Phase.BEFORE)])
        code.add(self.texts.logic, [*self._resolved(self.source.logic, Phase.BEFORE)])
        place = len(code.networks)
        self._add_checks()
        self._add_transitions()
        self.add_step_change()
        self._add_actions()
        steps = list(zip(self.flags, self.checks, strict=True))
        add_reports(self.source, code, self.commands, steps, own_texts)
        code.add(own_texts.after, [*self._resolved(self.source.after, Phase.ACT)])
        values = [self._value(*asked, Phase.ACT) for asked in self.source.shown]
        code.add(own_texts.shown_data, show(self.source.shown, values, self.net, code))
        self._insert_commands(place)

    def _insert_commands(self, place: int) -> None:
        """Edges stand before everything that asks for them; what does is only known in the end."""
        rest = self.code.networks[place:]
        del self.code.networks[place:]
        self.code.add(self.own_texts.commands, self.commands.statements())
        self.code.networks += rest

    # -- texts

    def _resolved(self, statements: tuple[n.Statement, ...], phase: Phase) -> list[Statement]:
        return [self.resolve(statement, phase) for statement in statements]

    def resolve(self, tree: Any, phase: Phase) -> Any:
        """A text with what stands for the data of steps."""

        def change(node: n.Node) -> n.Node:
            found = step_quantity(node, self.questions.steps)
            return node if found is None else self._value(*found, phase)

        return transform(tree, change)

    def _value(self, step: int, quantity: str, phase: Phase) -> Expression:
        if quantity == "X":
            return self.flags[step]
        if quantity == "SNO":
            return n.Literal(str(self.net.steps[step].step.number or 0))
        if quantity in _LIMITS:
            return self.clock.stated(getattr(self.net.steps[step].step, _LIMITS[quantity]))
        if quantity in ("T", "U"):
            return self.clock.value(step, quantity)
        if quantity in _STEP_EVENTS:
            happened = phase in (Phase.BEFORE, Phase.ACT) or (phase is Phase.ENTERED and quantity != "R1")
            return self.event(step, ActionEvent(quantity)) if happened else FALSE
        return self.checks[step].value(quantity)

    def event(self, step: int, event: ActionEvent) -> Expression:
        """What tells of an event of a step, from the step change on."""
        if event not in (ActionEvent.S1, ActionEvent.S0, ActionEvent.R1):
            return self.checks[step].value(event.value)
        if event is ActionEvent.R1 and is_constant(self._registers(), FALSE):
            return FALSE
        if (step, event) not in self._events:
            flag = self.flags[step].identifier
            self._events[step, event] = self.code.declare(f"{flag}_{event.value}")
            if event is not ActionEvent.R1 and step not in self._old:
                self._old[step] = self.code.declare(f"{flag}_old")
        return self._events[step, event]

    def _registers(self) -> Expression:
        return disjunction([self.commands.edge("REG_EF"), self.commands.edge("REG_S")])

    # -- before the step change

    def _add_checks(self) -> None:
        self.code.add(self.texts.times, self.clock.calls())
        acknowledge = self.commands.edge("ACK_EF") if any(c.early for c in self.checks) else FALSE
        checked = [s for each in self.checks for s in each.cleared()]
        checked += [s for each in self.checks for s in each.before(self.resolve, acknowledge)]
        self.code.add(self.own_texts.checks, checked, "" if self._checked_late else self._alarms())
        self.code.add(self.own_texts.undisturbed, self.clock.counted(self.checks))

    def enabled(self, transition: NetTransition) -> Expression:
        """Whether all steps before a transition are active."""
        return conjunction(self.wanted.get(i, self.flags[i]) for i in transition.sources)

    def _add_transitions(self) -> None:
        statements: list[Statement] = []
        permitted, pushed = self.commands.permitted(), self.commands.pushed()
        if not is_constant(permitted, TRUE):
            permitted = self.memory.named(self.own_texts.permitted, permitted, statements)
        if not is_constant(pushed, FALSE):
            pushed = self.memory.named(self.own_texts.pushed, pushed, statements)
        for transition in self.net.transitions:
            index = transition.index
            enabled = self.enabled(transition)
            preparation = self._resolved(self.source.preparations[index], Phase.SWITCH)
            if preparation:
                statements.append(when(conjunction([enabled, self.evolves()]), *preparation))
            condition = self.resolve(self.source.conditions[index], Phase.SWITCH)
            switches = disjunction([conjunction([condition, permitted]), pushed])
            held = [self._held(i) for i in transition.sources]
            rivals = transition.rivals if self.rules.profile.rivals is Rivals.PRIORITY else ()
            free = [*map(negation, held), *(negation(self.fired[i]) for i in rivals)]
            statements.append(assignment(self.fired[index], conjunction([enabled, switches, *free])))
        self.code.add(self.texts.transitions, statements)

    def _held(self, step: int) -> Expression:
        """Whether its supervision keeps a step active; one that was only just switched on is not supervised yet."""
        held = self.checks[step].held(self.resolve)
        return conjunction([self.flags[step], held]) if step in self.wanted else held

    def stays(self, step: int) -> Expression:
        """Whether a step is active and no transition leaves it."""
        leaving = [negation(self.fired[t]) for t in self.net.leaving[step]]
        return conjunction([self.wanted.get(step, self.flags[step]), *leaving])

    def evolves(self) -> Expression:
        """Whether conditions of transitions are evaluated in this cycle."""
        idle = (self.commands.is_on(Mode.MANUAL), self.started(), self.commands.edge("OFF_SQ"))
        return conjunction(map(negation, idle))

    # -- the step change

    def add_step_change(self) -> None:
        """Append the networks that change the situation: all resets, then all sets."""
        resets: list[Statement] = [assignment(self.flags[i], wanted) for i, wanted in self.wanted.items()]
        sets: list[Statement] = []
        for transition in self.net.transitions:
            flag = self.fired[transition.index]
            resets += self._all(transition.sources, FALSE, flag)
            sets += self._all(transition.targets, TRUE, flag)
        if self.source.skips:
            sets = add_skips(self)
        self.code.add(self.texts.resets, resets)
        self.code.add(self.texts.sets, sets)
        self.code.add(self.own_texts.manual, self._selected("S_ON", TRUE) + self._selected("S_OFF", FALSE))
        steps = range(len(self.net.steps))
        initial = [assignment(self.flags[i], self._initial(i)) for i in steps]
        start = disjunction([self.first, self.started()])
        self.code.add(self.own_texts.start, [when(start, *initial, assignment(self.first, FALSE))])
        off = self.commands.edge("OFF_SQ")
        self.code.add(self.own_texts.off, [when(off, *self._off(steps))] if not is_constant(off, FALSE) else [])

    def started(self) -> Expression:
        """Whether the sequence is started anew."""
        return disjunction([self.commands.edge("INIT_SQ"), *([self.init] if self.init is not None else [])])

    def _initial(self, step: int) -> Expression:
        return TRUE if self.net.initial & self.net.steps[step].bit else FALSE

    def _off(self, steps: range) -> list[Statement]:
        return [assignment(self.flags[i], FALSE) for i in steps]

    def _all(self, steps: tuple[int, ...], value: Expression, condition: Expression) -> list[Statement]:
        return [when(condition, *(assignment(self.flags[i], value) for i in steps))] if steps else []

    def _selected(self, command: str, value: Expression) -> list[Statement]:
        """S_ON and S_OFF: the step whose number S_SEL says."""
        by_hand = self.commands.is_on(Mode.MANUAL)
        selection = self.commands.variable("S_SEL")
        edge = self.commands.edge(command) if not is_constant(by_hand, FALSE) else FALSE
        if selection is None or is_constant(edge, FALSE):
            return []
        numbers: dict[int, int] = {}
        for step in self.net.steps:
            if step.step.number is not None:
                numbers.setdefault(step.step.number, step.index)
        branches = tuple(
            n.CaseBranch((n.Literal(str(number)),), (assignment(self.flags[index], value),))
            for number, index in numbers.items()
        )
        return [when(conjunction([by_hand, edge]), n.Case(selection, branches))] if branches else []

    # -- behind the step change

    def _add_actions(self) -> None:
        place = len(self.code.networks)
        for step in self.net.steps:
            for name in self.questions.of(step.index) & _STEP_EVENTS:
                self.event(step.index, ActionEvent(name))
        self.code.add(self.texts.times, [*self.clock.calls(), *self._restarted()])
        self.code.add(self.own_texts.checks_behind, self._checked(), self._alarms() if self._checked_late else "")
        signals = StepSignals(self.flags.__getitem__, self.event, self._released, self.clock.over, self._gone)
        actions = Actions(self.source, self.code, self.texts, self.own_texts, signals)
        actions.add()
        changes = [assignment(wanted, self._next(actions, step)) for step, wanted in self.wanted.items()]
        self.code.add(self.own_texts.switched, changes)
        self._insert_events(place)

    def _restarted(self) -> list[Statement]:
        return self.clock.restarted(lambda step: self.event(step, ActionEvent.S1))

    def _checked(self) -> list[Statement]:
        """Checks behind the step change: what is left is forgotten before anything asks for it."""

        def signal(step: int, event: ActionEvent) -> Callable[[], Expression]:
            return lambda: self.event(step, event)

        found = [s for i, each in enumerate(self.checks) for s in each.forgotten(signal(i, ActionEvent.S0))]
        for i, each in enumerate(self.checks):
            found += each.behind(self.resolve, signal(i, ActionEvent.S1))
        return found

    @property
    def _checked_late(self) -> bool:
        """Whether there are no checks before the step change."""
        return not any(check.early for check in self.checks)

    def _alarms(self) -> str:
        """What people are told when a check finds something: lowered code makes no alarms."""
        language = self.own_texts.language
        lines: list[str] = []
        for step in self.net.steps:
            for check in (step.step.interlock, step.step.supervision):
                texts = [plain(text, language) for text in (check.title, check.alarm)] if check is not None else []
                if any(texts):
                    lines.append(f"{step.path}: {', '.join(filter(None, texts))}")
        return "\n".join(lines)

    def _released(self, step: int) -> Expression:
        return self.checks[step].value("LS")

    def _gone(self, step: int) -> Expression:
        """Whether a step was left in the cycle before."""
        left = self.event(step, ActionEvent.S0)
        if step not in self._left_before:
            self._left_before[step] = self.code.declare(f"{self.flags[step].identifier}_S0_old"), left
        return self._left_before[step][0]

    def _next(self, actions: Actions, step: int) -> Expression:
        """Whether a step is active at the start of the next cycle: what is switched on is so in any case."""
        stays = conjunction([self.flags[step], negation(actions.switched(Qualifier.OFF, step))])
        return disjunction([stays, actions.switched(Qualifier.ON, step)])

    def _insert_events(self, place: int) -> None:
        """Events stand right behind the step change; which ones are needed is only known in the end."""
        rest = self.code.networks[place:]
        del self.code.networks[place:]
        statements: list[Statement] = [assignment(old, event) for old, event in self._left_before.values()]
        for (step, event), name in sorted(self._events.items(), key=lambda item: (item[0][0], item[0][1].value)):
            flag = self.flags[step]
            if event is ActionEvent.S1:
                value = conjunction([flag, negation(self._old[step])])
            elif event is ActionEvent.S0:
                value = conjunction([self._old[step], negation(flag)])
            else:
                value = conjunction([flag, self._registers()])
            statements.append(assignment(name, value))
        statements += [assignment(old, self.flags[step]) for step, old in sorted(self._old.items())]
        self.code.add(self.own_texts.events, statements)
        self.code.networks += rest
