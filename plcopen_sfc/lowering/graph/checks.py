"""The interlock and the supervision of a step as code.

Where nothing asks for their results before the step change, one evaluation behind it is enough. Else they are evaluated
as the sequencer does it: for an active step before the step change, for one that was entered behind it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Expression, Statement
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
from plcopen_sfc.lowering.code.program import Code
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.lowering.graph.step_data import Phase, Questions, StepSign
from plcopen_sfc.lowering.texts import Suffix, Texts

INTERLOCK = ("LS", "LA", "L1", "L0")
SUPERVISION = ("VS", "VA", "V1", "V0", "A1")

Resolve = Callable[[Any, Phase], Any]
"""Makes of a text what stands for it in lowered code: the same, with other names for the data of steps."""


@dataclass(frozen=True)
class Asked:
    """What is asked of a step, and how code speaks of it; `needed` is what of its checks is wanted anywhere.

    `comment` says what a variable of them means.
    """

    sign: StepSign
    needed: set[str]
    questions: Questions
    comment: Callable[[str], str]


class StepChecks:
    """The checks of one step. `early`: they are evaluated before the step change."""

    def __init__(self, source: GraphSource, step: int, code: Code, asked: Asked) -> None:
        needed, questions = asked.needed, asked.questions
        self._flag = asked.sign.active
        self._interlock = source.interlocks.get(step)
        self._supervision = source.supervisions.get(step)
        self._must_acknowledge = source.acknowledged
        remembers = self._supervision is not None and (source.acknowledged or "A1" in needed)
        stated = [c for c in (self._interlock, self._supervision) if c is not None]
        asked_early = (step, "U") in questions or questions.asked(
            step, {*INTERLOCK, *SUPERVISION}, Phase.CHECK, Phase.SWITCH
        )
        self.early = (
            remembers
            or (asked_early and bool(stated))
            or any(c.preparation or questions.asks(c.value) for c in stated)
            or any(_names(c.value) & source.prepared_names for c in stated)
        )
        wanted: set[str] = set()
        if self._interlock is not None:
            wanted |= needed & {*INTERLOCK}
            if wanted & {"L1", "L0", "LA"} or (self.early and self._interlock.preparation):
                wanted |= {"LS"}
            if wanted & {"L1", "L0"}:
                wanted |= {"LA"}
        if self._supervision is not None:
            wanted |= needed & {*SUPERVISION}
            if remembers:
                wanted |= {"VS", "V1", "V0", "VA", "fault", "acknowledged"}
            elif wanted & {"V1", "V0"}:
                wanted |= {"VS", "fault"}
            if "VA" in wanted and not remembers:
                wanted = wanted - {"VA"} | {"VS"}
            if self.early:
                wanted |= {"VS"}
        self._remembers = remembers
        self._asked_between = questions.asked(step, _EVENTS, Phase.CHECK)
        self._variables = {
            name: code.declare(_called(name, asked.sign.name, code.texts), comment=asked.comment(name))
            for name in _ORDER
            if name in wanted
        }

    def value(self, quantity: str) -> Expression:
        """What tells of a quantity that is needed."""
        if quantity in INTERLOCK and self._interlock is None:
            return self._flag if quantity == "LS" else FALSE
        if quantity in SUPERVISION and self._supervision is None:
            return FALSE
        if quantity == "VA" and not self._remembers:
            quantity = "VS"
        return self._variables[quantity]

    def held(self, resolve: Resolve) -> Expression:
        """Whether the supervision keeps the step from being left."""
        if self._supervision is None:
            return FALSE
        if self.early:
            return self.value("VA")
        fault: Expression = resolve(self._supervision.value, Phase.SWITCH)
        return fault

    def disturbed(self) -> Expression:
        """Whether there is an error of the interlock or the supervision while the step is active."""
        interlock = conjunction([self._flag, negation(self.value("LS"))]) if self._interlock is not None else FALSE
        return disjunction([interlock, self.value("VA")])

    def cleared(self) -> list[Statement]:
        """Ends the events of the last cycle, for checks that ask for them before they happen anew."""
        if not self._asked_between:
            return []
        return [assignment(self._variables[event], FALSE) for event in _EVENTS if event in self._variables]

    def before(self, resolve: Resolve, acknowledge: Expression) -> list[Statement]:
        """The checks of the active step before the step change."""
        if not self.early:
            return []
        return [when(self._flag, *self._evaluated(resolve, Phase.CHECK, acknowledge))]

    def forgotten(self, left: Callable[[], Expression]) -> list[Statement]:
        """What ends when the step is left."""
        if not self.early or not self._variables:
            return []
        return [when(left(), *(assignment(variable, FALSE) for variable in self._variables.values()))]

    def behind(self, resolve: Resolve, entered: Callable[[], Expression]) -> list[Statement]:
        """The checks behind the step change."""
        if not self._variables:
            return []
        if not self.early:
            return self._late(resolve)
        return [when(entered(), *self._evaluated(resolve, Phase.ENTERED, FALSE))]

    def _evaluated(self, resolve: Resolve, phase: Phase, acknowledge: Expression) -> list[Statement]:
        v = self._variables
        into: list[Statement] = []
        if self._interlock is not None and "LS" in v:
            into += [resolve(each, phase) for each in self._interlock.preparation]
            into.append(assignment(v["LS"], resolve(self._interlock.value, phase)))
            self._interlock_events(into)
        if self._supervision is not None:
            into += [resolve(each, phase) for each in self._supervision.preparation]
            self._supervision_events(resolve(self._supervision.value, phase), into)
            if self._remembers:
                self._remembered(acknowledge, into)
        return into

    def _late(self, resolve: Resolve) -> list[Statement]:
        v = self._variables
        into: list[Statement] = []
        if self._interlock is not None and "LS" in v:
            satisfied = resolve(self._interlock.value, Phase.ACT)
            into.append(assignment(v["LS"], conjunction([self._flag, satisfied])))
            self._interlock_events(into)
        if self._supervision is not None and "VS" in v:
            fault = resolve(self._supervision.value, Phase.ACT)
            self._supervision_events(conjunction([self._flag, fault]), into)
        return into

    def _interlock_events(self, into: list[Statement]) -> None:
        v = self._variables
        guard = [] if self.early else [self._flag]
        if "L1" in v:
            into.append(assignment(v["L1"], conjunction([*guard, negation(v["LS"]), negation(v["LA"])])))
        if "L0" in v:
            into.append(assignment(v["L0"], conjunction([v["LS"], v["LA"]])))
        if "LA" in v:
            into.append(assignment(v["LA"], conjunction([*guard, negation(v["LS"])])))

    def _supervision_events(self, fault: Expression, into: list[Statement]) -> None:
        v = self._variables
        if "fault" not in v:
            into.append(assignment(v["VS"], fault))
            return
        guard = [] if self.early else [self._flag]
        into.append(assignment(v["fault"], fault))
        if "V1" in v:
            into.append(assignment(v["V1"], conjunction([v["fault"], negation(v["VS"])])))
        if "V0" in v:
            into.append(assignment(v["V0"], conjunction([*guard, v["VS"], negation(v["fault"])])))
        into.append(assignment(v["VS"], v["fault"]))

    def _remembered(self, acknowledge: Expression, into: list[Statement]) -> None:
        """An error stays until it is gone and acknowledged."""
        v = self._variables
        into.append(when(v["V1"], assignment(v["VA"], TRUE), assignment(v["acknowledged"], FALSE)))
        event = conjunction([acknowledge, v["VA"], negation(v["acknowledged"])])
        if "A1" in v:
            into.append(assignment(v["A1"], event))
            event = v["A1"]
        if not is_constant(acknowledge, FALSE):
            into.append(when(event, assignment(v["acknowledged"], TRUE)))
        known = [v["acknowledged"]] if self._must_acknowledge else []
        into.append(when(conjunction([negation(v["VS"]), *known]), assignment(v["VA"], FALSE)))


def _names(tree: Expression) -> set[str]:
    return {node.identifier.casefold() for node in walk(tree) if isinstance(node, n.Name)}


_EVENTS = ("L1", "L0", "V1", "V0", "A1")
_ORDER = ("LS", "L1", "L0", "LA", "fault", "V1", "V0", "VS", "VA", "A1", "acknowledged")


def _called(name: str, step: str, texts: Texts) -> str:
    """The variable of a step: as S7-GRAPH calls it, else by a word."""
    word = _WORDS.get(name)
    return f"{step}_{name}" if word is None else texts.with_suffix(step, word)


_WORDS: Mapping[str, Suffix] = {"fault": "fault", "acknowledged": "acknowledged"}
