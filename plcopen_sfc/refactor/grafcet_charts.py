"""GRAFCETs as sequential function charts of IEC 61131-3, as far as these have words for them.

Stored actions become S and R, or P1 and P0; conditional ones an action that all steps with this output share; delays
D and L; ``X3`` the flag of the step, ``3s/X3`` its time. What has no counterpart is left as it is, and reported.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from plcopen_sfc.languages.grafcet_conditions import ConditionError, to_structured_text
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node, transform
from plcopen_sfc.model.actions import ActionAssociation, ActionEvent, ActionKind, Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Condition, Expression
from plcopen_sfc.model.pou import Action, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import PartialChartKind, SfcNetwork, Step, Supervised
from plcopen_sfc.report import Outcome

Note = Callable[[Outcome, str, str, str], None]
"""Takes what became of something, what it is, where and why."""

_CONTINUOUS = frozenset({ActionKind.CONTINUOUS, ActionKind.CONDITIONAL, ActionKind.DELAYED, ActionKind.LIMITED})
_CONSTANTS = {None: "TRUE", "TRUE": "TRUE", "1": "TRUE", "FALSE": "FALSE", "0": "FALSE"}


def put_into_sfc(project: Project, note: Note, *, tells_hierarchy: bool, of_graph: bool) -> None:
    """Change the charts of `project`.

    `tells_hierarchy`: what rules charts is reported elsewhere. `of_graph`: for S7-GRAPH: its steps have interlocks, and
    its actions events.
    """
    for pou in project.pous:
        chart = pou.chart
        if chart is not None:
            _unwrap(chart)
            _Chart(pou, chart, note, tells_hierarchy=tells_hierarchy, of_graph=of_graph).run()


def _unwrap(chart: SfcNetwork) -> None:
    """Put the only partial chart of a GRAFCET in its place."""
    if len(chart.partial_charts) == 1 and not chart.steps:
        only = chart.partial_charts[0]
        if only.kind is PartialChartKind.GLOBAL:
            chart.steps, chart.transitions = only.chart.steps, only.chart.transitions
            chart.partial_charts = []


class _TermError(ValueError):
    """A term that program text has no words for."""


class _Terms:
    """Times of steps as program text has them."""

    def __init__(self, steps: dict[str, Step]) -> None:
        self._steps = steps

    def edge(self, operand: str, *, rising: bool) -> str:
        raise _TermError(f"{'↑' if rising else '↓'}{operand} needs an instance of an edge block")

    def delay(self, operand: str, first: str | None, last: str | None) -> str:
        bare = operand.strip("()")
        step = self._steps.get(bare[1:].casefold()) if bare[:1] in "Xx" else None
        if step is None or first is None or last is not None:
            raise _TermError("a time of something that is no step needs an instance of a timer")
        return f"{step.name}.T >= {first}"


class _Chart:
    def __init__(self, pou: Pou, chart: SfcNetwork, note: Note, *, tells_hierarchy: bool, of_graph: bool) -> None:
        self._pou = pou
        self._chart = chart
        self._note = note
        self._tells = tells_hierarchy
        self._of_graph = of_graph
        self._steps = {step.name.casefold(): step for step in chart.steps}

    def run(self) -> None:
        """Change the chart."""
        path = f"POU {self._pou.name}"
        why = "the target fires transitions once in a scan: a step that a GRAFCET only passes is active for a scan"
        self._note(Outcome.APPROXIMATED, "search for stability", path, why)
        if not self._tells:
            self._report_hierarchy(path)
        for step in self._chart.steps:
            if step.name.isdecimal():
                new = f"Step{step.name}"
                if new.casefold() not in self._steps:
                    step.number, step.name = int(step.name), new
                    self._note(Outcome.TRANSLATED, "step name", f"{path} / step {new}", "a name begins with no digit")
        for transition in self._chart.transitions:
            place = f"{path} / transition {self._chart.label(transition)}"
            transition.condition = self._read(transition.condition, place)
        self._actions(path)

    def _report_hierarchy(self, path: str) -> None:
        if self._chart.partial_charts:
            why = "a chart of the target is alone: lower the GRAFCET, which makes proven code of all of it"
            self._note(Outcome.NOT_EXECUTED, "partial charts", path, why)
        for step in self._chart.steps:
            if step.encloses or (step.macro is not None and step.macro.expansion is not None):
                self._note(
                    Outcome.NOT_EXECUTED,
                    "hierarchy",
                    f"{path} / step {step.name}",
                    "the target has no charts inside steps",
                )

    def _read(self, condition: Condition | None, place: str) -> Condition | None:
        if not isinstance(condition, Expression):
            return condition
        try:
            return Expression(text=self._text(condition.text), negated=condition.negated)
        except (ConditionError, _TermError) as error:
            self._note(Outcome.NOT_EXECUTED, "condition", place, str(error))
            return condition

    def _text(self, text: str) -> str:
        tree = parse_expression(to_structured_text(text, _Terms(self._steps))).tree
        return print_node(transform(tree, self._flag))

    def _flag(self, node: n.Node) -> n.Node:
        if isinstance(node, n.Name) and node.identifier[:1] in "Xx":
            step = self._steps.get(node.identifier[1:].casefold())
            if step is not None and not self._declares(node.identifier):
                return n.Member(n.Name(step.name), n.Name("X"))
        return node

    def _declares(self, name: str) -> bool:
        return any(variable.name.casefold() == name.casefold() for variable in self._pou.variables())

    # -- actions

    def _actions(self, path: str) -> None:
        conditional: dict[str, list[tuple[Step, ActionAssociation]]] = {}
        stored: dict[str, list[ActionAssociation]] = {}
        for step, each in self._chart.associations():
            if each.target is not None and each.kind in (ActionKind.CONTINUOUS, ActionKind.CONDITIONAL):
                conditional.setdefault(each.target.casefold(), []).append((step, each))
            elif each.target is not None and each.kind is not None and each.kind not in _CONTINUOUS:
                stored.setdefault(each.target.casefold(), []).append(each)
        constants = {name for name, each in stored.items() if all(map(_is_constant, each))}
        for uses in conditional.values():
            if any(each.kind is ActionKind.CONDITIONAL for _, each in uses):
                (self._interlock if self._of_graph else self._share)(uses, path)
        for step, each in list(self._chart.associations()):
            place = f"{path} / step {step.name} / action {each.target or 'in place'}"
            if each.forcing is not None:
                if not self._tells:
                    self._note(
                        Outcome.NOT_EXECUTED, "forcing order", place, "the target has no charts that force others"
                    )
            elif each.kind in _CONTINUOUS:
                self._continuous(each, place)
            elif each.kind is ActionKind.ON_EVENT:
                self._note(
                    Outcome.NOT_EXECUTED, "action", place, "an action on an event needs an instance of an edge block"
                )
            elif each.kind is not None:
                constant = (each.target or "").casefold() in constants
                self._store(step, each, place, constant=constant and each.body is None)

    def _share(self, uses: list[tuple[Step, ActionAssociation]], path: str) -> None:
        """Give all uses of an output one action, which assigns it in every scan and in the one behind the last."""
        target = uses[0][1].target or ""
        parts = []
        for step, each in uses:
            flag = f"{step.name}.X"
            if isinstance(each.condition, Expression):
                try:
                    flag += f" AND ({self._text(each.condition.text)})"
                except (ConditionError, _TermError) as error:
                    self._note(
                        Outcome.NOT_EXECUTED, "condition", f"{path} / step {step.name} / action {target}", str(error)
                    )
            parts.append(flag)
        name = self._new_action(f"Assign_{target}", f"{target} := {' OR '.join(parts)};")
        for step, each in uses:
            each.target, each.kind, each.condition = name, ActionKind.CONTINUOUS, None
            why = f"the action {name} assigns {target} in all steps that drive it"
            self._note(Outcome.TRANSLATED, "action", f"{path} / step {step.name} / action {target}", why)

    def _interlock(self, uses: list[tuple[Step, ActionAssociation]], path: str) -> None:
        """Make the condition of an action the interlock of its step, unless that has another one."""
        for step, each in uses:
            if not isinstance(each.condition, Expression):
                continue
            place = f"{path} / step {step.name} / action {each.target}"
            try:
                wanted = Supervised(condition=Expression(text=self._text(each.condition.text)))
            except (ConditionError, _TermError) as error:
                self._note(Outcome.NOT_EXECUTED, "condition", place, str(error))
                continue
            if step.interlock not in (None, wanted):
                self._note(
                    Outcome.NOT_EXECUTED, "condition", place, "the interlock of the step is that of another action"
                )
                continue
            step.interlock, each.interlock = wanted, True
            each.kind, each.condition = ActionKind.CONTINUOUS, None
            self._note(Outcome.TRANSLATED, "action", place, "its condition is the interlock of the step")

    def _continuous(self, each: ActionAssociation, place: str) -> None:
        if each.condition is not None or each.value not in (None, "TRUE", "1"):
            self._note(Outcome.NOT_EXECUTED, "action", place, f"{each.kind} with a condition has no qualifier")
            return
        qualifiers = {ActionKind.DELAYED: Qualifier.D, ActionKind.LIMITED: Qualifier.L}
        each.qualifier = qualifiers.get(each.kind or ActionKind.CONTINUOUS, Qualifier.N)
        each.kind = each.value = None

    def _store(self, step: Step, each: ActionAssociation, place: str, *, constant: bool) -> None:
        if constant and each.kind is ActionKind.ON_ACTIVATION:
            each.qualifier = Qualifier.S if _CONSTANTS[each.value] == "TRUE" else Qualifier.R
            self._note(
                Outcome.TRANSLATED, "action", place, f"on activation is {each.qualifier}: it stays so till it is reset"
            )
        elif self._of_graph and each.target is not None:
            each.event = ActionEvent.S1 if each.kind is ActionKind.ON_ACTIVATION else ActionEvent.S0
            self._note(Outcome.TRANSLATED, "action", place, f"{each.kind} is the event {each.event}")
            each.kind, each.value = None, each.value or "TRUE"
            return
        else:
            text = each.body.text if isinstance(each.body, StBody) else f"{each.target} := {each.value or 'TRUE'};"
            on = each.kind is ActionKind.ON_ACTIVATION
            each.target = self._new_action(f"{step.name}_{each.target or 'stores'}_{'P1' if on else 'P0'}", text)
            each.body = None
            each.qualifier = Qualifier.P1 if on else Qualifier.P0
            self._note(Outcome.TRANSLATED, "action", place, f"{each.kind} is {each.qualifier} with an action")
        each.kind = each.value = None

    def _new_action(self, wanted: str, text: str) -> str:
        wanted = re.sub(r"\W+", "_", wanted)
        number, name = 1, wanted
        while self._pou.find_action(name) is not None or self._declares(name):
            number += 1
            name = f"{wanted}_{number}"
        self._pou.actions.append(Action(name=name, body=StBody(text=text)))
        return name


def _is_constant(each: ActionAssociation) -> bool:
    return each.kind is ActionKind.ON_ACTIVATION and each.value in _CONSTANTS and each.body is None
