"""Reading of GRAFCET: terms in conditions, its actions, charts that force others, and the plain form for textbooks."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from plcopen_sfc.analysis.exclusivity import Truth, exclusive, truth
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.errors import ForcingConflictError, LoweringError, UnknownBehaviourError
from plcopen_sfc.languages.grafcet_conditions import ConditionError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.lowering.code.boolean_logic import FALSE, TRUE, disjunction, is_constant
from plcopen_sfc.lowering.reading.chart_reading import read_chart
from plcopen_sfc.lowering.reading.chart_source import (
    ActionSource,
    ActionUse,
    ChartSource,
    ConditionText,
    DelayInCondition,
    EdgeInCondition,
    GrafcetSource,
    StoredAction,
)
from plcopen_sfc.lowering.reading.text_reading import ActionTargets, TextReader
from plcopen_sfc.lowering.schedule.scan_schedule import refuse_classic
from plcopen_sfc.model.actions import ActionKind, ForcedSituation, ForcingOrder, Qualifier
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Condition, SfcBody, SfcNetwork
from plcopen_sfc.semantics.charts.grafcet.grafcet_program import CONTINUOUS, STORED, has_grafcet
from plcopen_sfc.semantics.charts.grafcet.partial_charts import Hierarchy
from plcopen_sfc.semantics.charts.grafcet.term_evaluation import EdgeTerm, TermTexts, TimeTerm, is_term, rising
from plcopen_sfc.semantics.net import Net, NetTransition, Owner, indexes
from plcopen_sfc.semantics.profile import Evolution, Profile, ScanOrder, StepVariables
from plcopen_sfc.semantics.subjects import Subject


def is_grafcet(chart: SfcNetwork, profile: Profile) -> bool:
    """Return True if a chart has something of GRAFCET, or the profile searches for stability."""
    return profile.evolution is Evolution.UNTIL_STABLE or has_grafcet(Net.of(chart), profile)


def read_grafcet(
    pou: Pou,
    dialect: Dialect,
    profile: Profile,
    surroundings: Collection[str] = (),
    *,
    project: Project | None = None,
) -> ChartSource:
    """Read the chart of `pou`; the rest as in `read_chart`."""
    # terms, stored actions and orders are taken out of the copy; what remains is a chart of IEC 61131-3
    copied = pou.model_copy(deep=True)
    chart = copied.chart
    if chart is None:
        raise LoweringError("there is no chart to be lowered")
    reader = _Reader(copied, chart, dialect, profile, ActionTargets(pou, project, dialect))
    grafcet = reader.grafcet()
    # the reader of plain charts refuses the search for stability, which the schedule of GRAFCET adds
    once = replace(profile, evolution=Evolution.SINGLE)
    plain = read_chart(copied, chart, dialect, once, surroundings, project=project, grafcet=reader)
    # charts that others enclose start when their step becomes active, not with the program
    try:
        initial = reader.hierarchy.start(plain.net.initial)
    except ForcingConflictError as error:
        hint = "Let the steps that give the orders exclude each other."
        raise LoweringError(error.message, location=error.location, hint=hint) from error
    ruled = replace(plain.net, initial=initial, hierarchy=bool(reader.hierarchy))
    return replace(plain, pou=pou, net=ruled, grafcet=grafcet)


class _Reader(TextReader):
    """Reader that takes everything out of a copy of the chart that `read_chart` does not know."""

    def __init__(self, pou: Pou, chart: SfcNetwork, dialect: Dialect, profile: Profile, targets: ActionTargets) -> None:
        super().__init__(pou, chart, dialect)
        self._profile, self._targets = profile, targets
        net = self._net = Net.of(chart)
        self._owned = net.owned()
        self._terms = TermTexts()
        self._flags = frozenset(map(str.casefold, net.flags))
        if profile.order is ScanOrder.ACTIONS_FIRST:
            self.refuse(
                f"it has something of GRAFCET, which the profile {profile.name} does not have",
                "",
                "Take the profile grafcet: --profile grafcet.",
            )
        try:
            self.hierarchy = Hierarchy(net, pou.name)
        except UnknownBehaviourError as error:
            raise LoweringError(error.message, location=error.location, hint=error.hint) from error

    def grafcet(self) -> GrafcetSource:
        """Return the parts that were taken out; conditions have the names of their terms then."""
        for transition in self._net.transitions:
            if transition.transition.condition is not None:
                path = f"transition {transition.path}"
                transition.transition.condition = self._termless(transition.transition.condition, path)
        stored = tuple(self._stored())
        continuous = tuple(self._continuous())
        for step in (owner.step for owner in self._net.owners()):
            step.actions = [a for a in step.actions if a.kind is None and a.forcing is None]
        edges = [self._edge(term) for term in self._terms.edges]
        delays = [self._delay(term) for term in self._terms.timers]
        known = self._profile.step_variables is StepVariables.GRAFCET
        names = frozenset(map(str.casefold, self._net.flags) if known else ())
        return GrafcetSource(tuple(edges), tuple(delays), stored, continuous, self.hierarchy.charts, names)

    def _edge(self, term: EdgeTerm) -> EdgeInCondition:
        operand = self.expression(term.operand, "an edge")
        return EdgeInCondition(term.name, operand, term.rising, _words(operand))

    def _delay(self, term: TimeTerm) -> DelayInCondition:
        if "GRAFCET_EDGE" in term.operand:
            why = f"{self._terms.shown(term.name)} is a time of an edge, which lasts for no time"
            self.refuse(why, "", "Set a variable in an action on that event, and take the time of the variable.")
        operand, *times = (
            self.expression(text, "a time") if text is not None else None
            for text in (term.operand, term.first, term.last)
        )
        assert operand is not None  # noqa: S101  # terms have one
        return DelayInCondition(term.name, operand, times[0], times[1], _words(operand))

    def _termless(self, condition: Condition, path: str) -> Condition:
        if not self._profile.grafcet_terms or not isinstance(condition, Expression):
            return condition
        try:
            text = self._terms.readable(condition.text)
        except ConditionError as error:
            self.refuse(f"the condition {condition.text!r} cannot be read: {error}", path, "")
        return condition.model_copy(update={"text": text})

    def _stored(self) -> Iterator[StoredAction]:
        for owner, model in self._owned:
            if model.kind not in STORED:
                continue
            path = f"step {owner.path} / action {model.target or ''}".rstrip()
            event: n.Expression | None = None
            if model.kind is ActionKind.ON_EVENT:
                if not isinstance(model.condition, Expression) or not self._profile.grafcet_terms:
                    self.refuse(
                        "the stored action has no event that could be lowered", path, "Give it one, such as ↑a."
                    )
                event = self.condition(owner.chart, self._termless(rising(model.condition), path), path).value
            statements: tuple[n.Statement, ...] = ()
            if model.body is not None:
                statements = self.statements(model.body, path)
            elif model.target is not None:
                if model.value is None:
                    self.variable(model.target, self._targets, path)
                value = model.value or "TRUE"
                if value.strip() in _TRUTHS and self._targets.is_boolean(self.expression(model.target, path)):
                    value = _TRUTHS[value.strip()]
                statements = self.read(f"{model.target} := {value};", path)
            self._refuse_misfits(statements, path)
            if statements:
                yield StoredAction(model.kind, tuple(indexes(owner.steps)), event, statements)

    def _refuse_misfits(self, statements: Iterable[n.Statement], path: str) -> None:
        """Refuse values that no tool takes, where a GRAFCET's `simulate` converts them: the proof would not tell."""
        for statement in statements:
            for node in walk(statement):
                if isinstance(node, n.Assignment):
                    self._refuse_flag(print_node(node.target), path)
        for why in (why for statement in statements for why in self._targets.mistakes(statement)):
            self.refuse(f"no tool compiles the action: {why}", path, "Convert the value, or compare it: n <> 0.")

    def _refuse_flag(self, name: str, path: str) -> None:
        declared = {variable.name.casefold() for variable in self.pou.variables()}
        if self._profile.step_variables is StepVariables.GRAFCET and name.casefold() in self._flags - declared:
            why = f"{name} is the flag of a step, and the action writes it"
            self.refuse(why, path, "Write a variable: transitions change steps.")

    def _continuous(self) -> Iterator[ActionSource]:
        """Yield the actions: associations with the same target are one, every body in place is one of its own."""
        found: list[tuple[ActionSource, list[ActionUse]]] = []
        by_target: dict[str, list[ActionUse]] = {}
        for owner, model in self._owned:
            if model.kind not in CONTINUOUS:
                continue
            path = f"step {owner.path} / action {model.target or ''}".rstrip()
            self._refuse_flag(model.target or "", path)
            use = self._use(owner, model, path)
            if model.target is not None:
                uses = by_target.get(model.target.casefold())
                if uses is None:
                    uses = by_target[model.target.casefold()] = []
                    found.append((self._action(model.target, path), uses))
                uses.append(use)
            if model.body is not None:
                name = f"{owner.path}_{len(found) + 1}"
                statements = self.statements(model.body, path)
                self._refuse_misfits(statements, path)
                found.append((ActionSource(name, None, statements, ()), [use]))
        return (replace(action, uses=tuple(uses)) for action, uses in found)

    def _action(self, target: str, path: str) -> ActionSource:
        action = self.pou.find_action(target)
        if action is None:
            return ActionSource(target, self.variable(target, self._targets, path), (), ())
        statements = self.statements(action.body, f"action {target}")
        return ActionSource(target, None, statements, (), comment=action.comment)

    def _use(self, owner: Owner, model: ActionAssociation, path: str) -> ActionUse:
        assert model.kind is not None  # noqa: S101  # the caller has looked
        if model.value is not None and model.value.strip().upper() not in ("TRUE", "1"):
            self.refuse(
                f"a continuous action gives it the value {model.value}: only Booleans have one",
                path,
                "Take a stored action for other values.",
            )
        qualifier = CONTINUOUS[model.kind]
        inverted = owner.step.negated is not model.negated
        duration: n.Expression | None = None
        if qualifier is not Qualifier.N:
            if model.duration is None:
                self.refuse("the delayed or limited action has no time", path, "Give it one, such as 5s/X1.")
            if inverted:
                self.refuse(
                    "an action that is delayed or limited while its step is not active has no meaning",
                    path,
                    "Let it act while the step is active.",
                )
            duration = self.expression(model.duration, path)
        condition = ConditionText(TRUE, ())
        if model.condition is not None:
            condition = self.condition(owner.chart, self._termless(model.condition, path), path)
        return ActionUse(
            tuple(indexes(owner.steps)),
            inverted,
            qualifier,
            condition.value,
            duration,
            model.comment,
            condition.preparation,
        )


_TRUTHS = {"0": "FALSE", "1": "TRUE"}
"""Values of BOOL in drawings of GRAFCETs (``Q := 1``), as every tool writes them."""


def _words(tree: n.Expression) -> tuple[str, ...]:
    """Return the names in the operand of a term, but those of other terms."""
    names = (node.identifier for node in walk(tree) if isinstance(node, n.Name))
    return tuple(name for name in names if not is_term(name))


def read_plain(pou: Pou, chart: SfcNetwork, project: Project, profile: Profile) -> ChartSource:
    """Read a chart as textbook forms see it. Raises `LoweringError` for what they have no place for."""
    if is_grafcet(chart, profile):
        return plain_chart(read_grafcet(pou, project.dialect, profile, project=project))
    return read_chart(pou, chart, project.dialect, profile)


def stop_condition(text: str, chart: Subject, profile: Profile) -> str:
    """Return the condition of an emergency stop as structured text: a GRAFCET's may be written as its conditions are.

    Raises `LoweringError` for an edge or a time, since it is a level that holds the chart.
    """
    whole = chart.pou.chart
    if whole is None or not is_grafcet(whole, profile):
        return text
    terms = TermTexts()
    read = terms.read(text)
    if terms.edges or terms.timers:
        raise LoweringError(
            f"{text!r} is no condition of an emergency stop: it has an edge or a time",
            hint="Take a level, such as NOT Stop.",
        )
    return read


def without_emergency_stop(chart: Subject, profile: Profile) -> tuple[Subject, str]:
    """Return a chart without the one that only forces it into its initial steps, and the condition of that.

    So textbooks have it: a step of the emergency stop's chart forces ``G1{INIT}`` while the button is pressed, which
    the program has as an input of every flip-flop. A single chart below is the whole chart then. Any other chart stays
    as it is, and the condition is empty.
    """
    whole = chart.pou.chart
    if whole is None or not whole.partial_charts or not is_grafcet(whole, profile):
        return chart, ""
    source = read_grafcet(chart.pou, chart.project.dialect, profile, project=chart.project)
    for partial, read in zip(whole.partial_charts, source.net.chart.partial_charts, strict=True):
        pressed = _pressed(partial.chart, [t for t in source.net.transitions if t.chart is read.chart], source)
        others = [each for each in whole.partial_charts if each is not partial]
        forced = _forced(partial.chart, {each.name.casefold(): each.chart for each in others})
        if pressed is None or whole.steps or forced != {each.name.casefold() for each in others}:
            continue
        flags = {f"x{name}".casefold() for name in (partial.name, *(step.name for step in partial.chart.steps))}
        if any(name.casefold() in flags for name in source.names_in_texts()):
            continue  # something asks for the steps that would be gone
        alone = others[0].chart if len(others) == 1 else None
        reduced = alone or whole.model_copy(update={"partial_charts": others})
        pou = chart.pou.model_copy(update={"bodies": [SfcBody(chart=reduced)]})
        return Subject(chart.project, pou, chart.name), print_node(pressed)
    return chart, ""


def _forced(chart: SfcNetwork, others: Mapping[str, SfcNetwork]) -> set[str]:
    """Return the charts, in lower case, that the only actions of a chart force into their initial steps."""
    orders = [action.forcing for step in chart.steps for action in step.actions]
    if not all(order is not None and _is_initial(order, others) for order in orders):
        return set()
    return {order.chart.casefold() for order in orders if order is not None}


def _is_initial(order: ForcingOrder, charts: Mapping[str, SfcNetwork]) -> bool:
    """Return True if an order forces a chart into its initial steps: ``{INIT}``, or the names of these."""
    if order.situation is not ForcedSituation.EXPLICIT or order.chart.casefold() not in charts:
        return order.situation is ForcedSituation.INITIAL
    starts = {step.name.casefold() for step in charts[order.chart.casefold()].initial_steps}
    return {name.casefold() for name in order.steps} == starts


def _pressed(chart: SfcNetwork, transitions: Sequence[NetTransition], source: ChartSource) -> n.Expression | None:
    """Return the condition under which the forcing step of two that follow each other is active; None if there is none.

    Each is left on the opposite of what the other one is left on, however that is written.
    """
    acting = [step for step in chart.steps if step.actions]
    if len(chart.steps) != 2 or len(transitions) != 2 or len(acting) != 1:
        return None
    leaving = {source.net.steps[i].step.id: t for t in transitions for i in t.sources}
    resting = next(step for step in chart.steps if step is not acting[0])
    if set(leaving) != {acting[0].id, resting.id}:
        return None
    released, pressed = (source.conditions[leaving[step.id].index] for step in (acting[0], resting))
    if any(is_term(node.identifier) for node in walk(pressed) if isinstance(node, n.Name)):
        return None  # an edge or a time holds no chart
    opposite = exclusive(released, pressed).answer is Answer.YES and truth(disjunction([released, pressed]))
    return pressed if opposite is Truth.ALWAYS else None


_OF_STOPS = (
    "It takes a chart as the condition of an emergency stop that has two steps, one of which forces {INIT} of all "
    "other charts and does nothing else, and is left on the opposite of what leads to it, without edges and times: "
    "10 -> 11 : NOT_AUS * a, 11 -> 10 : /NOT_AUS + /a. The exact form has the rest."
)


def plain_chart(source: ChartSource) -> ChartSource:
    """Return the chart without what only GRAFCET has. Raises `LoweringError` for what textbook forms cannot hold."""
    grafcet = source.grafcet
    if grafcet is None:
        return source
    if grafcet.edges:
        refuse_classic(source, "edges")
    if grafcet.delays:
        refuse_classic(source, "times of conditions")
    if grafcet.ruled:
        refuse_classic(source, "charts that others force or enclose", hint=_OF_STOPS)
    actions = {action.name.casefold(): action for action in (*source.actions, *grafcet.continuous)}
    for stored in grafcet.stored:
        target, use = _stored_use(source, stored)
        name = print_node(target)
        before = actions.get(name.casefold(), ActionSource(name, target, (), ()))
        actions[name.casefold()] = replace(before, uses=(*before.uses, use))
    # stored actions come among the others in the order of the steps that use them first
    in_order = sorted(actions.values(), key=lambda action: min(step for use in action.uses for step in use.steps))
    return replace(source, actions=tuple(in_order), grafcet=None)


def _stored_use(source: ChartSource, stored: StoredAction) -> tuple[n.Expression, ActionUse]:
    """Return the output that a stored action sets or resets, and the association that does so."""
    if stored.kind is not ActionKind.ON_ACTIVATION:
        refuse_classic(source, "stored actions on deactivation or on an event")
    only = stored.statements[0]
    if len(stored.statements) > 1 or not isinstance(only, n.Assignment) or not isinstance(only.value, n.Literal):
        refuse_classic(source, "stored actions that give an output anything but TRUE or FALSE")
    sets, resets = (is_constant(only.value, constant) for constant in (TRUE, FALSE))
    if not sets and not resets:
        refuse_classic(source, f"stored actions that give an output the value {only.value.text}")
    return only.target, ActionUse(stored.steps, False, Qualifier.S if sets else Qualifier.R, TRUE, None)
