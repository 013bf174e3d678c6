"""Steps that are skipped: with a setting of the block, one behind which a transition is satisfied is only passed."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    equal,
    negation,
    when,
)
from plcopen_sfc.lowering.encodings.case_encodings import RegionEncoding
from plcopen_sfc.lowering.encodings.case_states import RegionState, TriedTransition
from plcopen_sfc.lowering.encodings.step_flags import StepFlagEncoding
from plcopen_sfc.semantics.net import NetTransition


class SkippedSteps:
    """Search for the steps that become active instead of those that are skipped; no step is passed twice.

    `conditions` and `preparations` are those of the transitions alone, `evolves` tells when any is evaluated.
    """

    def __init__(
        self,
        encoding: StepFlagEncoding | RegionEncoding,
        conditions: Sequence[Expression],
        preparations: Sequence[tuple[Statement, ...]],
        evolves: Callable[[], Expression],
    ) -> None:
        self._encoding, self._net, self._code, self._texts = encoding, encoding.net, encoding.code, encoding.texts
        self._conditions, self._preparations, self._evolves = conditions, preparations, evolves

    def _named(self, step: int, suffix: str) -> n.Name:
        return self._code.declare(self._texts.with_suffix(self._encoding.situation.name(step), suffix))

    # -- with a flag for each step

    def entered(self) -> dict[int, Expression]:
        """Append the search, and return when each step becomes active. Conditions are those before."""
        encoding, net = self._encoding, self._net
        assert isinstance(encoding, StepFlagEncoding)  # noqa: S101  # the caller has looked
        entering = {step.index: net.entering[step.index] for step in net.steps if net.entering[step.index]}
        entered = {i: self._named(i, "entered") for i in entering}
        statements: list[Statement] = [
            assignment(entered[i], conjunction([disjunction(encoding.fired[t] for t in found), self._evolves()]))
            for i, found in entering.items()
        ]
        passed = {i: self._named(i, "seen") for i in entering if self._onward(i)}
        if passed:
            stays = ((i, conjunction(negation(encoding.fired[t]) for t in net.leaving[i])) for i in passed)
            statements += [
                assignment(passed[i], conjunction([encoding.held.get(i, encoding.flags[i]), left])) for i, left in stays
            ]
            again = self._code.declare(self._texts.more_skipped)
            sweep: list[Statement] = [assignment(again, FALSE)]
            for step, flag in passed.items():
                fresh = conjunction([entered[step], negation(flag)])
                # a step is passed once: a ring of satisfied conditions would never end
                sweep.append(when(fresh, assignment(flag, TRUE), *self._passing(step, entered, again)))
            statements.append(n.Repeat(tuple(sweep), negation(again)))
        self._code.add(self._texts.skips, statements)
        return dict(entered)

    def _onward(self, step: int) -> list[int]:
        """Return the transitions that can lead on from a step that is alone."""
        return [t for t in self._net.leaving[step] if self._net.transitions[t].sources == (step,)]

    def _passing(self, step: int, entered: dict[int, n.Name], again: n.Name) -> list[Statement]:
        """Return the way on behind a step if a transition is satisfied: the first one wins."""
        following: list[Statement] = []
        # from the last to the first, as each choice is nested in the ELSE of the one before it
        for index in reversed(self._onward(step)):
            transition = self._net.transitions[index]
            goes = [assignment(entered[i], TRUE) for i in transition.targets if i != step]
            if step not in transition.targets:
                goes.insert(0, assignment(entered[step], FALSE))
            branch = n.Branch(self._conditions[index], (*goes, assignment(again, TRUE)))
            match following:
                case [n.If(branches, otherwise)]:
                    choice = n.If((branch, *branches), otherwise)
                case _:
                    choice = n.If((branch,), tuple(following) or None)
            following = [*self._preparations[index], choice]
        return following

    # -- with a CASE for each region

    def declare(self) -> None:
        """Declare following states: loops compare these with the states."""
        if isinstance(self._encoding, RegionEncoding):
            for machine in self._encoding.machines:
                self._encoding.states.add_following_state(machine)

    def add_loops(self) -> None:
        """Append a loop for each region that goes on behind a step whose next transition is satisfied."""
        if isinstance(self._encoding, RegionEncoding):
            for machine in self._encoding.machines:
                self._add_loop(self._encoding, machine)

    def _add_loop(self, encoding: RegionEncoding, machine: RegionState) -> None:
        steps = [i for i in machine.region.steps if self._net.entering[i] and self._net.leaving[i]]
        if not steps:
            return
        states, following = encoding.states, encoding.states.following(machine)
        again = self._code.declare(self._texts.more_skipped)
        goes_on = assignment(again, TRUE)
        begin: list[Statement] = []
        branches: list[n.CaseBranch] = []
        for step in (self._net.steps[i] for i in steps):
            passed = self._named(step.index, "seen")
            begin.append(assignment(passed, FALSE))
            leaving = [self._net.transitions[t] for t in self._net.leaving[step.index]]
            tries = [self._tried(encoding, machine, transition, goes_on) for transition in leaving]
            once = when(negation(passed), assignment(passed, TRUE), *states.tried(tries))
            branches.append(states.branch(states.names.step(step.index), states.heading(step), [once]))
        begin.append(assignment(again, conjunction([negation(equal(following, machine.state)), self._evolves()])))
        loop = n.While(again, (assignment(again, FALSE), n.Case(following, tuple(branches))))
        self._code.add(self._texts.skips, [*begin, loop])

    def _tried(
        self, encoding: RegionEncoding, machine: RegionState, transition: NetTransition, goes_on: Statement
    ) -> TriedTransition:
        effect = [*encoding.states.effect(machine, transition), goes_on]
        return TriedTransition(self._preparations[transition.index], self._conditions[transition.index], effect)
