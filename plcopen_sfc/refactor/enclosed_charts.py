"""Runs of steps that become a chart of their own, which one step executes: in an action, or in a function block.

The step has an association with N, so that its tool executes the chart while it is active, and once more when it was
left: there the chart returns to its beginning. Both go on in the same scan, which takes one form for each order of a
scan (`plcopen_sfc.semantics.profile.ScanOrder`):

- Actions first (CODESYS): the chart ends in a step without actions for each transition that leaves the run, which has
  its condition. The transition outside asks ``Fill_end._x``: will that step be active in the next scan?
- Transitions first (IEC 61131-3): the chart rests in a step without actions. The transitions outside keep their
  conditions, and ask if the last step of the run is active, which the scan before has decided.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Condition, SfcNetwork, Step, Transition
from plcopen_sfc.operations import provided
from plcopen_sfc.refactor.chart_edits import joined, refused
from plcopen_sfc.refactor.journal import Journal
from plcopen_sfc.refactor.queries import dialect_in
from plcopen_sfc.refactor.runs_of_steps import Run, check_free, put_back, replace_run

_GOES_ON = frozenset({Qualifier.S, Qualifier.SL, Qualifier.SD, Qualifier.DS})
"""Qualifiers whose actions go on when their step was left."""


class Form(StrEnum):
    """Form of a chart that a step executes, by the order of a scan; the head of this module has them."""

    ENDING = "ending"
    RESTING = "resting"

    @property
    def flag(self) -> str:
        """The member of a step that tells if it is active, as people write it in such a tool."""
        return "x" if self is Form.ENDING else "X"

    @property
    def asked(self) -> str:
        """The member of the step that transitions outside ask for."""
        return "_x" if self is Form.ENDING else "X"


@dataclass(frozen=True, slots=True)
class Enclosing:
    """Names by which a chart and the step that executes it know of each other.

    `active`: the condition in the chart that the step is active. `flag`: the text outside that a step of the chart is
    active, with ``{}`` for its name; of the last step where transitions are tested first.
    """

    step: str
    active: str
    flag: str
    form: Form


def form_of(project: Project, chart: SfcNetwork, steps: Sequence[Step], what: str) -> Form:
    """Return the form that the tool of a project needs. Raises `ModelError` where it has none."""
    profile = provided("default_profile")(project)
    hint = "Move the steps into a macro-step."
    if not profile.final_scan:
        why = (
            f"{profile.name} executes no action once more when its step was left, so the chart would go on where it was"
        )
        raise refused(what, why, hint)
    if profile.step_variables == "flag" and not (any(chart.associations()) and any(each.actions for each in steps)):
        why = "it needs IEC steps there and here: flags of simple steps do not tell what is active in the next scan"
        raise refused(what, why, "Give the chart and the run an association.")
    return Form.ENDING if profile.order == "actions_first" else Form.RESTING


def check_associations(project: Project, pou: Pou, run: Run, what: str) -> None:
    """Raise `ModelError` for actions of a run that do something else in a chart of their own."""
    flags = {flag.variable.casefold() for flag in SfcFlag}
    used = [*pou.implicit_flags(), *(each.name for each in pou.variables() if each.name.casefold() in flags)]
    reasons = [f"the POU has the flag {flag}, which acts on each chart by itself" for flag in used]
    inside = {id(each) for step in run.steps for each in step.actions}
    own = [(step, each) for step in run.steps for each in step.actions if each.target]
    targets = {_target(each) for _, each in own}
    charts = [chart.chart for chart in project.charts() if chart.pou is pou]
    for step, each in (pair for chart in charts for pair in chart.associations()):
        if id(each) not in inside and _target(each) in targets:
            reasons.append(f"{step.name} outside has {each.text} too: both share one action control")
    for step, each in own:
        is_action = pou.find_action(each.target or "") is not None
        if each.qualifier in _GOES_ON and (is_action or each.qualifier is not Qualifier.S):
            reasons.append(f"{step.name} has {each.text}, which goes on when the step was left")
    if reasons:
        raise refused(what, reasons)


def _target(association: ActionAssociation) -> str:
    return (association.target or "").casefold()


# -- there


def enclose(
    journal: Journal, chart: SfcNetwork, run: Run, enclosing: Enclosing, taken: set[str]
) -> tuple[Step, SfcNetwork]:
    """Replace a run of steps by one, and return that step and the chart of the run.

    New steps get names that are not `taken`, in small letters.
    """
    what = f"the chart of {enclosing.step!r} cannot be made"
    inside = {step.id for step in run.steps}
    waiting = [each for each in run.leaving if not inside.issuperset(each.sources)]
    if waiting:
        raise refused(what, f"the transition {chart.label(waiting[0])} waits for other steps too")
    if enclosing.form is Form.RESTING and run.left_inside:
        raise refused(what, f"the step that is left last goes on inside, too: {chart.label(run.left_inside[0])}")
    order = {id(each): place for place, each in enumerate(chart.transitions)}
    sources = [list(each.sources) for each in run.leaving]
    step = replace_run(journal, chart, run, enclosing.step)
    inner = SfcNetwork(steps=run.steps, transitions=run.inner)
    if enclosing.form is Form.ENDING:
        journal.put(run.first, "initial", True)
        returns = []
        for each, left in zip(run.leaving, sources, strict=True):
            end = inner.add_step(take_name(f"{enclosing.step}_end", taken), declare=False)
            made = inner.add_transition(left, end, each.condition, priority=each.priority)
            order[id(made)] = order[id(each)]
            returns.append(end)
            journal.put(each, "condition", enclosing.flag.format(end.name))
        inner.transitions = sorted(inner.transitions, key=lambda each: order[id(each)])  # as they compete
        for end in returns:
            inner.add_transition(end, run.first, f"NOT {enclosing.active}")
        return step, inner
    rest = inner.add_step(take_name(f"{enclosing.step}_rest", taken), declare=False, initial=True)
    inner.add_transition(rest, run.first, enclosing.active)
    if run.last is not None:
        inner.add_transition(run.last, rest, f"NOT {enclosing.active}")
        asked = Expression(text=enclosing.flag.format(run.last.name))
        for each in run.leaving:
            conditions = [asked, each.condition] if each.condition is not None else [asked]
            journal.put(each, "condition", joined(what, conditions, "AND", dialect_in(chart)))
    return step, inner


# -- and back


def disclose(journal: Journal, chart: SfcNetwork, step: Step, inner: SfcNetwork, enclosing: Enclosing) -> list[Step]:
    """Put the steps of a chart that `enclose` has made into the place of the step that executes it.

    Raises `ModelError` for any other chart: it goes on where it was when its step becomes active again.
    """
    what = f"the chart of {step.name!r} cannot be put in its place"
    check_free(chart, step, inner, what)
    find = _with_ends if enclosing.form is Form.ENDING else _with_rest
    found = find(chart, step, inner, enclosing)
    if found is None:
        why = "it goes on where it was when its step becomes active again, or its transitions ask for something else"
        raise refused(what, why, "Only a chart in the form that these edits give it can be put back.")
    gone = {each.id for each in found.added}
    steps = [each for each in inner.steps if each.id not in gone]
    kept = [each for each in inner.transitions if gone.isdisjoint((*each.sources, *each.targets))]
    links = {id(inside): link for inside, link, _, _ in found.leaving}
    own = {id(each) for each in kept}
    order = [links.get(id(each), each) for each in inner.transitions if id(each) in links or id(each) in own]
    put_back(journal, chart, step, inner, Run(steps, kept, [], [], found.first, []), order=order)
    for _, link, source, condition in found.leaving:
        journal.put(link, "sources", [source.id])
        journal.put(link, "condition", condition)
    return steps


@dataclass(frozen=True, slots=True)
class _Found:
    """What `enclose` has made of a run: the steps that it added, and the transitions outside as they were.

    Of these the transition in the chart, the step that they left, and the condition.
    """

    added: list[Step]
    first: Step
    leaving: list[tuple[Transition, Transition, Step, Condition | str | None]]


def _with_ends(chart: SfcNetwork, step: Step, inner: SfcNetwork, enclosing: Enclosing) -> _Found | None:
    if len(inner.initial_steps) != 1:
        return None
    (first,) = inner.initial_steps
    found = _Found([], first, [])
    for link in chart.outgoing(step):
        ends = [each for each in inner.steps if _is(link.condition, enclosing.flag.format(each.name))]
        if len(ends) != 1 or ends[0] in found.added or not _is_empty(ends[0]):
            return None
        incoming, outgoing = inner.incoming(ends[0]), inner.outgoing(ends[0])
        returns = len(outgoing) == 1 and outgoing[0].targets == [first.id]
        if (
            len(incoming) != 1
            or len(incoming[0].sources) != 1
            or not returns
            or not _is(outgoing[0].condition, f"NOT {enclosing.active}")
        ):
            return None
        found.added.append(ends[0])
        found.leaving.append((incoming[0], link, inner.step(incoming[0].sources[0]), incoming[0].condition))
    return found


def _with_rest(chart: SfcNetwork, step: Step, inner: SfcNetwork, enclosing: Enclosing) -> _Found | None:
    if len(inner.initial_steps) != 1 or not _is_empty(inner.initial_steps[0]):
        return None
    (rest,) = inner.initial_steps
    begin, back = inner.outgoing(rest), inner.incoming(rest)
    if len(begin) != 1 or len(begin[0].targets) != 1 or not _is(begin[0].condition, enclosing.active):
        return None
    returns = [each for each in back if len(each.sources) == 1 and _is(each.condition, f"NOT {enclosing.active}")]
    if len(back) > 1 or len(returns) < len(back):
        return None
    last = inner.step(back[0].sources[0]) if back else None
    found = _Found([rest], inner.step(begin[0].targets[0]), [])
    for link in chart.outgoing(step):
        condition = _without(link.condition, enclosing.flag.format(last.name)) if last is not None else None
        if condition is None or last is None:
            return None
        found.leaving.append((link, link, last, condition))
    return found


def _is_empty(step: Step) -> bool:
    return step == Step(id=step.id, name=step.name, initial=step.initial)


def _is(condition: Condition | None, text: str) -> bool:
    """True if a condition is a text, whatever its layout and case."""
    plain = isinstance(condition, Expression) and not condition.negated
    return plain and isinstance(condition, Expression) and _squeezed(condition.text) == _squeezed(text)


def _squeezed(text: str) -> str:
    return re.sub(r"\s+", "", text).casefold()


def _without(condition: Condition | None, flag: str) -> str | None:
    """Return what a condition asks for besides a flag; None if it does not ask for that first."""
    if _is(condition, flag):
        return "TRUE"
    if not isinstance(condition, Expression) or condition.negated:
        return None
    tree = parse_condition(condition.text).tree
    if not isinstance(tree, n.Operation) or tree.operator is not n.Operator.AND:
        return None
    asked, other = (each.span for each in tree.operands[:2])
    if asked is None or other is None or _squeezed(condition.text[slice(*asked)]) != _squeezed(flag):
        return None
    rest = condition.text[other[0] :].strip()
    whole = parse_condition(rest).tree
    return rest[1:-1] if isinstance(whole, n.Parenthesized) else rest
