"""Encodings of a sequencer with a bit or a flip-flop for each step, and a bit for each transition.

With the block setting for skipping, a step whose next transition is satisfied already does not become active.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import cached_property

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    equal,
    is_constant,
    negation,
    when,
)
from plcopen_sfc.lowering.encodings.step_flags import FiringTransition, StepFlags, is_safe
from plcopen_sfc.lowering.graph.sequencer_actions import SequencerActions
from plcopen_sfc.lowering.graph.sequencer_scan import Sequencer
from plcopen_sfc.lowering.graph.sequencer_source import CyclePhase
from plcopen_sfc.lowering.schedule.scan_schedule import exclusive_transitions
from plcopen_sfc.model.actions import ActionEvent, Qualifier
from plcopen_sfc.semantics.charts.graph.graph_parameters import Mode
from plcopen_sfc.semantics.net import NetStep, NetTransition


class BitSequencer(Sequencer):
    """Encoding of a sequencer with bits; it holds every one, whatever switches its steps."""

    captioned = True

    def declare_states(self, surroundings: Collection[str]) -> Sequence[str]:  # noqa: ARG002
        """Declare the flags of steps, the bits of transitions, and bits for the steps that actions switch."""
        code, texts = self.code, self.texts
        # a block of S7-GRAPH starts in its first cycle: before that no step is active
        self.steps = StepFlags(self.net, code, texts, initial=0, captioned=self.captioned)
        self.steps.declare_transitions()
        self.flags, self.fired = self.steps.flags, self.steps.fired
        names = [self.steps.name(step.index) for step in self.net.steps]
        self._events: dict[tuple[int, ActionEvent], n.Name] = {}
        self._left_before: dict[int, tuple[n.Name, Expression]] = {}
        # actions ON and OFF act in the next cycle: the steps are kept in bits of their own until then
        switched = {i for rows in self.source.rows for row in rows for i in row.switched}
        self.wanted = {
            i: code.declare(
                texts.with_suffix(names[i], "next"),
                comment=self.own_texts.wanted_of(self.net.steps[i].path),
            )
            for i in sorted(switched)
        }
        return names

    def active(self, step: int) -> Expression:
        """Return the flag of a step."""
        return self.flags[step]

    def add_switched(self, actions: SequencerActions) -> None:
        """Append the steps of the next cycle: one that is switched on is active in any case."""
        changes = [assignment(wanted, self._next(actions, step)) for step, wanted in self.wanted.items()]
        self.code.add(self.own_texts.switched, changes)

    def _next(self, actions: SequencerActions, step: int) -> Expression:
        stays = conjunction([self.flags[step], negation(actions.switched(Qualifier.OFF, step))])
        return disjunction([stays, actions.switched(Qualifier.ON, step)])

    # -- events

    def changed(self, step: int, event: ActionEvent) -> Expression:
        """Return a bit for each event that anything asks for."""
        if (step, event) not in self._events:
            self._events[step, event] = self.code.declare(f"{self.signs[step].name}_{event.value}")
            self.steps.before(step)
        return self._events[step, event]

    def touched(self, step: int) -> Expression:
        """Return the flag, or the event that the step was left."""
        return disjunction([self.flags[step], self.changed(step, ActionEvent.S0)])

    def gone(self, step: int) -> Expression:
        """Return a bit that keeps the event of the last cycle."""
        left = self.changed(step, ActionEvent.S0)
        if step not in self._left_before:
            name = self.texts.with_suffix(f"{self.signs[step].name}_S0", "old")
            self._left_before[step] = self.code.declare(name), left
        return self._left_before[step][0]

    def add_events(self, place: int, registered: Sequence[Statement]) -> None:
        """Insert the comparison of flags with those of the last cycle."""
        statements: list[Statement] = [assignment(old, event) for old, event in self._left_before.values()]
        for (step, event), name in sorted(self._events.items(), key=lambda item: (item[0][0], item[0][1].value)):
            flag, old = self.flags[step], self.steps.before(step)
            value = [flag, negation(old)] if event is ActionEvent.S1 else [old, negation(flag)]
            statements.append(assignment(name, conjunction(value)))
        statements += [*registered, *self.steps.remembered()]
        self.code.add(self.own_texts.events, statements, place=place)

    # -- transitions

    def enabled(self, transition: NetTransition) -> Expression:
        """Return an expression that is TRUE if all steps before a transition are active."""
        return conjunction(self.wanted.get(i, self.flags[i]) for i in transition.sources)

    def add_transitions(self) -> None:
        """Append a bit for each transition: enabled, satisfied or pushed, not held, first of those competing."""
        statements: list[Statement] = []
        permitted, pushed = self.commands.permitted(), self.commands.pushed()
        if not is_constant(permitted, TRUE):
            permitted = self.memory.named(self.own_texts.permitted, permitted, statements)
        if not is_constant(pushed, FALSE):
            pushed = self.memory.named(self.own_texts.pushed, pushed, statements)

        def tried(transition: NetTransition) -> FiringTransition:
            index, enabled = transition.index, self.enabled(transition)
            before = self.resolved(self.source.preparations[index], CyclePhase.SWITCH)
            condition = self.resolve(self.source.conditions[index], CyclePhase.SWITCH)
            switches = disjunction([conjunction([condition, permitted]), pushed])
            held = [self._held(i) for i in transition.sources]
            # all conditions are evaluated before the first one wins, as S7-GRAPH does
            free = [*map(negation, held), *(negation(self.fired[i]) for i in competing[index])]
            evaluated = [when(conjunction([enabled, self.evolves()]), *before)] if before else []
            return FiringTransition(evaluated, conjunction([enabled, switches, *free]))

        competing = exclusive_transitions(self.net, self.rules.profile)
        self.steps.add_transitions(map(tried, self.net.transitions), statements)

    def _held(self, step: int) -> Expression:
        """Return when its supervision holds a step; one just switched on is not supervised yet."""
        held = self.checks[step].held(self.resolve)
        return conjunction([self.flags[step], held]) if step in self.wanted else held

    def stays(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step is active and no transition leaves it."""
        leaving = [negation(self.fired[t]) for t in self.net.leaving[step]]
        return conjunction([self.wanted.get(step, self.flags[step]), *leaving])

    # -- the step change

    def add_step_change(self) -> None:
        """Append an assignment for each step, then the switching by hand, the start and the end."""
        entered = add_skips(self) if self.source.skips else None
        self.code.add(self.texts.moves, self.steps.next_situation(held=self.wanted, entered=entered))
        # start and end come behind the switching by hand, and override it
        self.code.add(self.own_texts.manual, self._selected("S_ON", TRUE) + self._selected("S_OFF", FALSE))
        steps = range(len(self.net.steps))
        initial = [assignment(self.flags[i], self._initial(i)) for i in steps]
        start = disjunction([self.first, self.started()])
        self.code.add(self.own_texts.start, [when(start, *initial, assignment(self.first, FALSE))])
        off = self.commands.edge("OFF_SQ")
        self.code.add(self.own_texts.off, [when(off, *self._off(steps))] if not is_constant(off, FALSE) else [])

    def _initial(self, step: int) -> Expression:
        return TRUE if self.net.initial & self.net.steps[step].bit else FALSE

    def _off(self, steps: range) -> list[Statement]:
        return [assignment(self.flags[i], FALSE) for i in steps]

    def _selected(self, command: str, value: Expression) -> list[Statement]:
        """Return S_ON and S_OFF for the step whose number S_SEL has."""
        by_hand = self.commands.is_on(Mode.MANUAL)
        selection = self.commands.variable("S_SEL")
        edge = self.commands.edge(command) if not is_constant(by_hand, FALSE) else FALSE
        if selection is None or is_constant(edge, FALSE):
            return []
        numbers: dict[int, int] = {}
        for step in self.net.steps:
            if step.step.number is not None:
                # of two steps with the same number S_SEL means the first one
                numbers.setdefault(step.step.number, step.index)
        branches = tuple(
            n.CaseBranch((n.Literal(str(number)),), (assignment(self.flags[index], value),))
            for number, index in numbers.items()
        )
        return [when(conjunction([by_hand, edge]), n.Case(selection, branches))] if branches else []


def add_skips(sequencer: BitSequencer) -> dict[int, n.Name]:
    """Append the search for the steps that become active, and return when each does. Conditions are those before."""
    net, code = sequencer.net, sequencer.code
    entering = {step.index: net.entering[step.index] for step in net.steps if net.entering[step.index]}
    entered = {i: code.declare(sequencer.texts.with_suffix(sequencer.signs[i].name, "entered")) for i in entering}
    statements: list[Statement] = [
        assignment(entered[i], conjunction([disjunction(sequencer.fired[t] for t in found), sequencer.evolves()]))
        for i, found in entering.items()
    ]
    passed = {
        i: code.declare(sequencer.texts.with_suffix(sequencer.signs[i].name, "seen"))
        for i in entering
        if _onward(sequencer, i)
    }
    if passed:
        statements += [assignment(passed[i], sequencer.stays(i)) for i in passed]
        again = code.declare(sequencer.own_texts.again)
        sweep: list[Statement] = [assignment(again, FALSE)]
        for step, flag in passed.items():
            fresh = conjunction([entered[step], negation(flag)])
            # a step is passed once: a ring of satisfied conditions would never end
            sweep.append(when(fresh, assignment(flag, TRUE), *_passing(sequencer, step, entered, again)))
        statements.append(n.Repeat(tuple(sweep), negation(again)))
    code.add(sequencer.own_texts.skips, statements)
    return entered


def _onward(sequencer: BitSequencer, step: int) -> list[int]:
    """Return the transitions that can lead on from a step that is alone."""
    net = sequencer.net
    return [t for t in net.leaving[step] if net.transitions[t].sources == (step,)]


def _passing(sequencer: BitSequencer, step: int, entered: dict[int, n.Name], again: n.Name) -> list[Statement]:
    """Return the way on behind a step if a transition is satisfied: the first one wins."""
    source = sequencer.source
    following: list[Statement] = []
    # from the last to the first, as each choice is nested in the ELSE of the one before it
    for index in reversed(_onward(sequencer, step)):
        transition = sequencer.net.transitions[index]
        condition: Expression = sequencer.resolve(source.conditions[index], CyclePhase.SWITCH)
        goes = [assignment(entered[i], TRUE) for i in transition.targets if i != step]
        if step not in transition.targets:
            goes.insert(0, assignment(entered[step], FALSE))
        preparation = [sequencer.resolve(each, CyclePhase.SWITCH) for each in source.preparations[index]]
        branch = n.Branch(condition, (*goes, assignment(again, TRUE)))
        match following:
            case [n.If(branches, otherwise)]:
                choice = n.If((branch, *branches), otherwise)
            case _:
                choice = n.If((branch,), tuple(following) or None)
        following = [*preparation, choice]
    return following


class FlipFlopSequencer(BitSequencer):
    """Encoding of a sequencer with a reset-dominant flip-flop for each step."""

    captioned = False

    def exact(self) -> None:
        """Append one cycle, in statements that networks can have."""
        if self.source.skips:
            self._refuse("steps that are skipped need a loop, which networks do not have")
        super().exact()

    def _refuse(self, message: str) -> None:
        raise LoweringError(message, location=Location(path=self.source.pou.name))

    def add_step_change(self) -> None:
        """Append a network for each step."""
        for step in self.net.steps:
            self._add_flip_flop(step)
        self.code.add(self.texts.first_scan, [assignment(self.first, FALSE)])

    def _add_flip_flop(self, step: NetStep) -> None:
        set_, resets = self.steps.set_and_reset(step.index, lambda *_: not self._is_safe)
        reset = disjunction(resets)
        start = disjunction([self.first, self.started()])
        initial = bool(self.net.initial & step.bit)
        if initial:
            set_.insert(0, start)
            reset = conjunction([reset, negation(start)])
        wanted = self.wanted.get(step.index)
        if wanted is not None:
            flag = self.flags[step.index]
            set_.append(conjunction([wanted, negation(flag)]))
            entered = [negation(self.fired[i]) for i in self.net.entering[step.index]]
            off = conjunction([flag, negation(wanted), *entered])
            reset = disjunction([reset, conjunction([off, *([negation(start)] if initial else [])])])
        off_by_hand = self._by_hand("S_OFF", step)
        if initial:  # the start comes behind the switching by hand
            off_by_hand = conjunction([off_by_hand, negation(start)])
        resets = [reset, off_by_hand, *([] if initial else [start]), self.commands.edge("OFF_SQ")]
        set_.append(self._by_hand("S_ON", step))
        statements: list[Statement] = []
        name = f"FF_{self.signs[step.index].name}"
        self.memory.latch(name, disjunction(set_), disjunction(resets), statements, self.flags[step.index])
        title = self.texts.step(step.step, step.path, initial=initial)
        self.code.add(title, statements, self.texts.remark(step.step))

    @cached_property
    def _is_safe(self) -> bool:
        """True if a step that a transition enters is never active already: nothing else switches steps on."""
        switched = self.wanted or not is_constant(self.commands.is_on(Mode.MANUAL), FALSE)
        return not switched and is_safe(self.source, self.rules.profile)

    def _by_hand(self, command: str, step: NetStep) -> Expression:
        """Return an expression that is TRUE if a command by hand concerns a step."""
        selection, number = self.commands.variable("S_SEL"), step.step.number
        by_hand = self.commands.is_on(Mode.MANUAL)
        first = next((s.index for s in self.net.steps if s.step.number == number), None)
        if selection is None or number is None or first != step.index or is_constant(by_hand, FALSE):
            return FALSE
        return conjunction([by_hand, self.commands.edge(command), equal(selection, n.Literal(str(number)))])
