"""Conditions and actions in one line of text, as an engineer would note them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from plcopen_sfc.languages.networks import condition_reader
from plcopen_sfc.languages.networks.results import Helper, NetworkExpression
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.conditions import Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import ActionAssociation, Body, BodyCondition, Condition, Enclosure, SfcNetwork, Step

KINDS = {kind: "" if kind is ActionKind.CONTINUOUS else kind.words for kind in ActionKind}
"""The words of IEC 60848 for kinds of actions; the usual one, a continuous action, goes without saying."""

Told = Callable[..., str]
"""Words in the language of the reader: of a text in English, whose places ``{}`` are for further arguments."""


def english(text: str, *values: object) -> str:
    """Return words in English, with `values` in their places."""
    return text.format(*values) if values else text


@dataclass(frozen=True, slots=True)
class ActionLine:
    """An action of a step in words: what is done, and when.

    `qualifier` is also the kind of an action of GRAFCET (`KINDS`), ``entry``, ``main`` or ``exit`` of a step action,
    and ``macro`` or ``encloses`` of a step that has other charts inside, in the language of the reader, as
    `excluded` is, which is empty where the action is executed. `indicator` is the variable that tells that it is done,
    `interlock` is ``C`` where it depends on the interlock of its step.
    """

    what: str
    qualifier: str = ""
    event: str = ""
    duration: str = ""
    condition: str = ""
    indicator: str = ""
    excluded: str = ""
    interlock: str = ""

    def __str__(self) -> str:
        """Return the action in one line: ``D T#2s Lamp (Lit)``, ``C N Drill``, ``on event n := 5 [a]``."""
        when = self.interlock, self.event, self.qualifier, self.duration
        condition = f"[{self.condition}]" if self.condition else ""
        indicator = f"({self.indicator})" if self.indicator else ""
        return " ".join(filter(None, (*when, self.what, condition, indicator, self.excluded)))


EXCLUDED = "(excluded)"
"""Suffix of the name of an element that is excluded from the program."""


class Wording:
    """Words for the elements of one chart, in the language of `told`."""

    def __init__(self, chart: SfcNetwork, dialect: Dialect = Dialect.IEC, told: Told = english) -> None:
        self.told = told
        self._read = condition_reader(chart, dialect)

    def label(self, label: str) -> str:
        """A label of a transition (`SfcNetwork.label`): where it leads nowhere, or comes from nowhere, in words."""
        start, _, end = label.partition(" -> ")
        if end == "nowhere":
            return self.told("{} -> nowhere", start)
        return self.told("nowhere -> {}", end) if start == "nowhere" else label

    def condition(self, condition: Condition | None) -> str:
        """Return a condition; empty where there is none."""
        if condition is None:
            return ""
        if isinstance(condition, Expression):
            return _negated(_one_line(condition.text), condition.negated)
        if isinstance(condition, NamedCondition):
            return _negated(condition.name, condition.negated)
        drawn = self._drawn(condition)
        if drawn:
            return drawn
        if isinstance(condition, BodyCondition):
            return _negated(condition.name or body_words(condition.body), condition.negated)
        pin = condition.input
        return _negated(pin.expression or self.told("(logic)" if pin.connections else "(not wired)"), condition.negated)

    def _drawn(self, condition: BodyCondition | WiredCondition) -> str:
        """Return a condition in FBD or LD as an expression; empty where there is none."""
        if isinstance(condition, BodyCondition) and not isinstance(condition.body, FbdBody | LdBody):
            return ""
        read = self._read(condition)
        if read.tree is None or not read.complete:
            return ""
        helpers = {helper.name for helper in read.helpers}
        calls = [self._text(call) for block, call in _calls(read) if block not in helpers]
        text = self._text(read.tree)
        text = self.told("{}, with {}", text, "; ".join(calls)) if calls else text
        for helper in reversed(read.helpers):
            if helper.name in text:
                meant = self._meant(read, helper)
                if meant is None:
                    return ""
                text = text.replace(f"{helper.name}.Q" if helper.type_name == "R_TRIG" else helper.name, meant)
        return text

    def _meant(self, read: NetworkExpression, helper: Helper) -> str | None:
        """Return a helper variable in words: the edge that it has, or the value that it is given; None for others."""
        if helper.type_name == "R_TRIG":
            watched = next(_watched(read, helper), None)
            return None if watched is None else self.told("rising edge of {}", self._text(watched))
        given = {
            statement.target.identifier: statement.value
            for statement in read.before
            if isinstance(statement, n.Assignment) and isinstance(statement.target, n.Name)
        }
        value = given.get(helper.name)
        if value is None or helper.retained:
            return None
        retained = {other.name for other in read.helpers if other.retained}
        last = value.operands[-1] if isinstance(value, n.Operation) else None
        if isinstance(last, n.Name) and last.identifier in retained:  # as `Wires.edge` has it: NOT now AND last
            return self.told("falling edge of {}", self._text(given[last.identifier]))
        return f"({self._text(value)})"

    def _text(self, tree: n.Node) -> str:
        return _one_line(print_node(tree))

    def actions(self, step: Step) -> Iterator[ActionLine]:
        """Return the actions of a step: step actions and associations, each as ``N Motor`` or ``D T#2s Lamp``.

        Behind them, what else decides on its actions and its end: interlock, supervision, charts inside.
        """
        yield from (line for line, _ in self.step_actions(step))
        for association in step.actions:
            yield self.association(association)
        for label, condition in step.conditions.items():
            yield ActionLine(self.condition(condition), self.told(label))
        if step.macro is not None:
            yield ActionLine(step.macro.expansion or "", self.told("macro"))
        for enclosure in step.encloses or ():
            yield ActionLine(enclosure_words(enclosure), self.told("encloses"))

    def step_actions(self, step: Step) -> Iterator[tuple[ActionLine, str | Body]]:
        """Yield the entry, main and exit action of a step, each in words and as it is in the model."""
        for label, action in step.step_actions.items():
            if action:
                words = action if isinstance(action, str) else body_words(action)
                yield ActionLine(words, self.told(label)), action

    def association(self, association: ActionAssociation) -> ActionLine:
        """Return a line of an action block in words."""
        what = association.target or (body_words(association.body) if association.body is not None else "")
        if association.value is not None:
            what = f"{what} := {_one_line(association.value)}"
        if association.forcing is not None:
            what = str(association.forcing)
        qualifier = "" if association.qualifier is Qualifier.NONE else association.qualifier.value
        return ActionLine(
            _negated(what, association.negated),
            self.told(KINDS[association.kind]) if association.kind is not None else qualifier,
            association.event.value if association.event is not None else "",
            association.duration or "",
            self.condition(association.condition),
            association.indicator or "",
            self.told(EXCLUDED) if association.exclude else "",
            "C" if association.interlock else "",
        )


def _calls(read: NetworkExpression) -> Iterator[tuple[str, n.Call]]:
    """Yield the calls of blocks that are drawn before a condition, with the names of their instances."""
    for statement in read.before:
        call = statement.call if isinstance(statement, n.CallStatement) else None
        if isinstance(call, n.Call):
            yield print_node(call.callee), call


def _watched(read: NetworkExpression, helper: Helper) -> Iterator[n.Expression]:
    """Yield the values that the edge block `helper` watches."""
    calls = (call for block, call in _calls(read) if block == helper.name)
    return (argument.value for call in calls for argument in call.arguments if argument.value is not None)


def enclosure_words(enclosure: Enclosure) -> str:
    """Return the chart that a step encloses, with the steps that it activates there: ``G2{10, 12}``."""
    activated = f"{{{', '.join(enclosure.activated_steps)}}}" if enclosure.activated_steps else ""
    return f"{enclosure.chart}{activated}"


def body_words(body: Body) -> str:
    """Return a body in words: its text where that is short, else its language."""
    if isinstance(body, StBody | IlBody):
        text = _one_line(body.text)
        if text and len(text) <= 60:
            return f"{{{text}}}"
    return f"({body.language})"


def _negated(text: str, negated: bool) -> str:
    if not negated:
        return text
    simple = text.replace("_", "").replace(".", "").isalnum()
    return f"NOT {text}" if simple else f"NOT ({text})"


def _one_line(text: str) -> str:
    return " ".join(text.split())
