"""Skipping steps: one whose next transition is satisfied already does not become active (block setting of GRAPH)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, assignment, conjunction, disjunction, negation, when
from plcopen_sfc.lowering.graph.step_data import Phase

if TYPE_CHECKING:
    from plcopen_sfc.lowering.graph.bits import BitSequencer


def add_skips(sequencer: BitSequencer) -> list[Statement]:
    """Append what finds out which steps become active; gives what activates them. Conditions see the old situation."""
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
            sweep.append(when(fresh, assignment(flag, TRUE), *_passing(sequencer, step, entered, again)))
        statements.append(n.Repeat(tuple(sweep), negation(again)))
    code.add(sequencer.own_texts.skips, statements)
    return [when(flag, assignment(sequencer.flags[i], TRUE)) for i, flag in entered.items()]


def _onward(sequencer: BitSequencer, step: int) -> list[int]:
    """The transitions that can lead on from a step that is alone."""
    net = sequencer.net
    return [t for t in net.leaving[step] if net.transitions[t].sources == (step,)]


def _passing(sequencer: BitSequencer, step: int, entered: dict[int, n.Name], again: n.Name) -> list[Statement]:
    """Go on behind a step if a transition is satisfied: the first one wins."""
    source = sequencer.source
    following: list[Statement] = []
    for index in reversed(_onward(sequencer, step)):
        transition = sequencer.net.transitions[index]
        condition: Expression = sequencer.resolve(source.conditions[index], Phase.SWITCH)
        goes = [assignment(entered[i], TRUE) for i in transition.targets if i != step]
        if step not in transition.targets:
            goes.insert(0, assignment(entered[step], FALSE))
        preparation = [sequencer.resolve(each, Phase.SWITCH) for each in source.preparations[index]]
        branch = n.Branch(condition, (*goes, assignment(again, TRUE)))
        match following:
            case [n.If(branches, otherwise)]:
                choice = n.If((branch, *branches), otherwise)
            case _:
                choice = n.If((branch,), tuple(following) or None)
        following = [*preparation, choice]
    return following
