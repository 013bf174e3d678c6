"""Reading of a chart for lowering: what is not understood completely is refused, nothing is guessed."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, walk
from plcopen_sfc.lowering.code.boolean_logic import TRUE, conjunction, negation
from plcopen_sfc.lowering.reading.chart_source import (
    ActionSource,
    ActionUse,
    ChartSource,
    ConditionText,
    HoldingOperand,
    StepStatements,
    StepTimeLimit,
)
from plcopen_sfc.lowering.reading.step_variables import asked_by_contacts, asked_outside
from plcopen_sfc.lowering.reading.text_reading import REPAIR, ActionTargets, TextReader
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.conditions import Expression as TextCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Body, Condition, SfcBody, SfcNetwork
from plcopen_sfc.model.types import Elementary, ElementaryType
from plcopen_sfc.semantics.charts.sfc_flags import flags_in_use
from plcopen_sfc.semantics.net import Net, NetTransition, Owner, indexes
from plcopen_sfc.semantics.profile import ActionControl, Evolution, Profile, ScanOrder


def read_chart(
    pou: Pou,
    chart: SfcNetwork,
    dialect: Dialect,
    profile: Profile,
    surroundings: Collection[str] = (),
    *,
    project: Project | None = None,
    grafcet: TextReader | None = None,
) -> ChartSource:
    """Read a chart of `pou`. `surroundings`: the names of its project in lower case.

    `grafcet` has read what only IEC 60848 has.

    Raises `LoweringError` for what has no meaning that could be lowered.
    """
    return _Reader(pou, chart, dialect, profile, surroundings, project=project, grafcet=grafcet).source()


_OTHER_PROFILE = "Take another profile: --profile iec."
_OTHER_QUALIFIER = "Take another qualifier, or a profile that has it (--profile)."
OF_GRAFCET = "Take the profile of their tool: --profile grafcet."
_OF_GRAPH = "Take the profile of their tool: --profile s7graph."
_OF_OTHERS = "Take the profile of their tool: --profile grafcet, s7graph."
_OF_CODESYS = "Take the profile of their tool: --profile codesys."


class _Reader(TextReader):
    def __init__(
        self,
        pou: Pou,
        chart: SfcNetwork,
        dialect: Dialect,
        profile: Profile,
        surroundings: Collection[str],
        *,
        project: Project | None,
        grafcet: TextReader | None,
    ) -> None:
        super().__init__(pou, chart, dialect, grafcet.helpers if grafcet is not None else ())
        self._targets = ActionTargets(pou, project, dialect)
        self._grafcet = grafcet
        self._profile = profile
        self._types = {variable.name.casefold(): variable.type for variable in pou.variables()}
        self._declared = {*self._types, *surroundings}
        self._flags = flags_in_use(chart, profile, lambda name: name.casefold() in self._declared)
        self._net = Net.of(chart)

    def _check(self) -> None:
        """Refuse what only other profiles have, and rules of profiles that users write and no tool has."""
        net, profile, chart = self._net, self._profile, self.chart
        if net.problems:
            self.refuse(f"the chart is broken: {net.problems[0].message}", net.problems[0].path, REPAIR)
        used = {association.qualifier for _, association in net.owned()}
        shared = profile.action_control is ActionControl.PER_ACTION
        delays = shared and not profile.reset_cancels_delays and used & {Qualifier.SD, Qualifier.SL}
        searches = profile.evolution is Evolution.UNTIL_STABLE
        foreign = profile.graph_parameters or (net.hierarchy and self._grafcet is None)
        # only CODESYS has SFC flags, and there actions come first: what they end is defined in that order only
        flags = self._flags and profile.order is not ScanOrder.ACTIONS_FIRST
        self.refuse_any(
            "",
            (searches, "the search for stability is lowered for GRAFCETs only", _OTHER_PROFILE),
            (foreign, f"{profile.name} has no enclosing steps, forcing orders and sequencers", _OF_OTHERS),
            (flags, "SFC flags are lowered only where actions come before transitions", _OF_CODESYS),
            (chart.permanent, f"{profile.name} has no permanent operations", _OF_GRAPH),
            # rules that a user can compose and that no construction has
            (profile.initial_situation_held, f"{profile.name} holds the initial situation", _OTHER_PROFILE),
            (delays, f"R does not end the times of SD and SL under {profile.name}", _OTHER_PROFILE),
        )
        for step in net.steps:
            kind = self._types.get(step.step.name.casefold())
            # the flag of a step of a GRAFCET has another name, XS2
            is_flag = self._grafcet is None and isinstance(kind, ElementaryType) and kind.name is Elementary.BOOL
            skipped = not profile.initial_steps_entered and net.initial & step.bit and step.step.entry_action
            twice = f"a variable of the POU is called {step.step.name}, too: rename it or the step"
            self.refuse_any(
                step.path,
                (skipped, f"{profile.name} does not execute the entry action of an initial step", _OTHER_PROFILE),
                (is_flag, twice, "plcopen-sfc rename does it in all texts."),  # it would be the flag of the step
            )

    def source(self) -> ChartSource:
        """Return the chart."""
        self._check()
        logic = self.logic()
        conditions = [self._transition(transition) for transition in self._net.transitions]
        actions = tuple(self._actions())
        code = tuple(self._step_code())
        source = ChartSource(
            self.pou,
            self.dialect,
            self._net,
            tuple(condition.value for condition in conditions),
            tuple(condition.preparation for condition in conditions),
            logic,
            tuple(self.helpers),
            actions,
            code,
            dict(self._minimum_times()),
            tuple(self._watches()),
            self._flags,
            instances=self.instances,
            asked_outside=asked_outside(self.pou, self._net, self.dialect),
            asked_by_contacts=asked_by_contacts(self.pou, self._net),
        )
        # a flag can be used by its name alone, which is known when all texts are read
        return replace(source, undeclared_flags=self._undeclared(source.names()))

    def _undeclared(self, names: set[str]) -> frozenset[SfcFlag]:
        """Return the flags that are used or named, and that only the tool declares."""
        settings = self.chart.settings
        stated = settings.flags if settings is not None else {}
        named = {name.casefold() for name in names}
        implicit = {flag for flag, use in stated.items() if use.declare and flag.variable.casefold() in named}
        return frozenset(f for f in implicit | self._flags if f.variable.casefold() not in self._declared)

    # -- conditions

    def _transition(self, transition: NetTransition) -> ConditionText:
        path = f"transition {transition.path}"
        found = self.condition(transition.chart, transition.transition.condition, path)
        return replace(found, value=self._boolean(found.value, path))

    def _boolean(self, condition: n.Expression, path: str) -> n.Expression:
        """Return the same, if no variable of another type is where it must be of type BOOL."""
        for operand in _logical(condition):
            kind = self._types.get(operand.identifier.casefold())
            # the code would not compile: IF wants a BOOL
            if isinstance(kind, ElementaryType) and kind.name is not Elementary.BOOL:
                self.refuse(
                    f"{operand.identifier} is a {kind.name}: a condition is of type BOOL",
                    path,
                    f"Compare it: {operand.identifier} <> ..",
                )
        return condition

    # -- actions

    def _actions(self) -> Iterator[ActionSource]:
        """Yield the actions: associations with the same target are one, every body in place is one of its own."""
        targets: dict[str, tuple[str, str, str, list[ActionUse]]] = {}
        found: list[str | ActionSource] = []
        for owner in self._net.owners():
            for number, association in enumerate(owner.step.actions, 1):
                if association.exclude:
                    continue
                path = f"step {owner.path} / action {association.target or number}"
                use = self._use(owner, association, path)
                if association.target is not None:
                    assigned = f" := {association.value}" if association.value is not None else ""
                    key = f"{association.target}{assigned}".casefold()
                    # the place of an action is that of its first association: tools execute actions in that order
                    if key not in targets:
                        targets[key] = association.target, assigned, path, []
                        found.append(key)
                    targets[key][3].append(use)
                if association.body is not None:
                    statements = self.statements(association.body, path)
                    name = f"{owner.step.name}_{number}"
                    text = _text_of(association.body)
                    found.append(ActionSource(name, None, statements, (use,), in_place=True, text=text))
        for each in found:
            if isinstance(each, ActionSource):
                yield each
                continue
            name, assigned, path, uses = targets[each]
            if assigned:
                yield ActionSource(name, None, self.read(f"{name}{assigned};", f"action {name}"), tuple(uses))
                continue
            action = self.pou.find_action(name)
            if action is not None:
                # the text is written as it is where it has comments; a call has none
                text = "" if self._stays(action) else _text_of(action.body)
                statements = self._statements_of(action)
                yield ActionSource(name, None, statements, tuple(uses), text=text, comment=action.comment)
                continue
            target = self.expression(name, f"action {name}")
            # CODESYS and TIA Portal: an association may name an instance or a program, which is called while it acts
            if self._targets.is_called(target):
                yield ActionSource(name, None, self.read(f"{name}();", f"action {name}"), tuple(uses))
            else:
                yield ActionSource(name, self.variable(name, self._targets, path), (), tuple(uses))

    def _statements_of(self, action: Action) -> tuple[n.Statement, ...]:
        """Return the code of an action; one with a chart of its own is called, and one that RETURN leaves."""
        path = f"action {action.name}"
        return self.read(f"{action.name}();", path) if self._stays(action) else self.statements(action.body, path)

    def _stays(self, action: Action) -> bool:
        """Return True if the code of an action has to stay where it is, and is called."""
        if isinstance(action.body, SfcBody):
            return True
        if not isinstance(action.body, StBody) or self.dialect not in _WITH_CALLS:
            return False
        parts = [
            node for each in parse_statements(action.body.text, self.dialect).tree.statements for node in walk(each)
        ]
        steps = {step.step.name.casefold() for step in self._net.steps}
        asks = any(isinstance(node, n.Name) and node.identifier.casefold() in steps for node in parts)
        # inlined, a RETURN would leave the whole code. An action that asks for steps cannot stay: there are none any
        # more
        return not asks and any(isinstance(node, n.ReturnStatement) for node in parts)

    def _use(self, owner: Owner, association: ActionAssociation, path: str) -> ActionUse:
        qualifier = Qualifier.N if association.qualifier is Qualifier.NONE else association.qualifier
        name, kind = self._profile.name, association.kind
        events = association.event is not None or association.interlock or association.forcing is not None
        stored = kind not in (None, ActionKind.CONTINUOUS, ActionKind.CONDITIONAL)
        unknown = qualifier not in self._profile.qualifiers
        self.refuse_any(
            path,
            (events, f"{name} has no events, interlocks and forcing orders", _OF_OTHERS),
            (stored, f"{name} has no actions of kind {kind}", OF_GRAFCET),
            (unknown, f"the profile {name} has no rule for the qualifier {qualifier}", _OTHER_QUALIFIER),
        )
        duration = self.expression(association.duration, path) if association.duration else None
        if qualifier.needs_duration and duration is None:
            self.refuse(f"{qualifier} needs a time", path, "Give the action one, such as T#5s.")
        guard = self._guard(owner.chart, association.condition, path)
        # a negated association of a negated step acts while the step is active
        inverted = owner.step.negated is not association.negated
        steps, comment = tuple(indexes(owner.steps)), association.comment
        return ActionUse(steps, inverted, qualifier, guard.value, duration, comment, guard.preparation)

    def _guard(self, chart: SfcNetwork, condition: Condition | None, path: str) -> ConditionText:
        if condition is None:
            return ConditionText(TRUE, ())
        found = self.condition(chart, condition, path)
        return replace(found, value=self._boolean(found.value, path))

    # -- what steps execute

    def _step_code(self) -> Iterator[StepStatements]:
        for step in self._net.steps:
            model = step.step
            if model.interlock is not None or model.supervision is not None:
                what = f"{self._profile.name} has no interlocks and supervisions"
                self.refuse(what, f"step {step.path}", _OF_GRAPH)
            entry, main, exit_ = (
                self._step_action(action, f"step {step.path}")
                for action in (model.entry_action, model.main_action, model.exit_action)
            )
            if entry or main or exit_:
                yield StepStatements(step.index, entry, main, exit_, self._text_of_step(model.main_action))

    def _step_action(self, action: str | Body | None, path: str) -> tuple[n.Statement, ...]:
        if not isinstance(action, str):
            return self.statements(action, path)
        known = self.pou.find_action(action)
        if known is not None:
            return self._statements_of(known)
        return self.read(f"{action}();", path)

    def _text_of_step(self, action: str | Body | None) -> str:
        if not isinstance(action, str):
            return _text_of(action)
        known = self.pou.find_action(action)
        return _text_of(known.body) if known is not None and not self._stays(known) else ""

    def _minimum_times(self) -> Iterator[tuple[int, n.Expression]]:
        if self._profile.minimum_times:
            for step in self._net.steps:
                if step.step.min_time:
                    yield step.index, self.expression(step.step.min_time, f"step {step.path}")

    def _watches(self) -> Iterator[StepTimeLimit]:
        if self._profile.maximum_times and SfcFlag.ERROR in self._flags:
            for step in self._net.steps:
                if step.step.max_time:
                    time = self.expression(step.step.max_time, f"step {step.path}")
                    reasons = tuple(self._reasons(step.index)) if _ANALYSES & self._flags else ()
                    yield StepTimeLimit(step.index, time, reasons)

    def _reasons(self, step: int) -> Iterator[HoldingOperand]:
        """Yield the operands that can keep the transitions behind a step from being TRUE."""
        for index in self._net.leaving[step]:
            condition = self._net.transitions[index].transition.condition
            # the simulator analyses texts only
            if isinstance(condition, TextCondition):
                tree = self.expression(condition.text, f"transition {self._net.transitions[index].path}")
                yield from _reasons(tree, condition.text, not condition.negated, ())


def _logical(node: n.Expression) -> Iterator[n.Name]:
    """Yield the names where a value of type BOOL must be: alone, and below AND, OR, XOR and NOT."""
    match n.bare(node):
        case n.Name() as name:
            yield name
        case n.Unary(operator=n.Operator.NOT, operand=operand):
            yield from _logical(operand)
        case n.Operation(operator=operator, operands=operands) if operator in n.CONNECTIVES:
            for operand in operands:
                yield from _logical(operand)


def _reasons(node: n.Expression, text: str, wanted: bool, given: tuple[n.Expression, ...]) -> Iterator[HoldingOperand]:
    """Yield the operands that keep `node` from being `wanted`, if all that is `given` is TRUE."""
    match node:
        case n.Parenthesized():
            yield from _reasons(node.inner, text, wanted, given)
            return
        case n.Unary(operator=n.Operator.NOT):
            yield from _reasons(node.operand, text, not wanted, given)
            return
        case n.Operation(operator=n.Operator.AND | n.Operator.AND_THEN | n.Operator.OR | n.Operator.OR_ELSE):
            if (node.operator in (n.Operator.AND, n.Operator.AND_THEN)) is not wanted:  # one operand would do
                given = (*given, negation(node) if wanted else node)
            for operand in node.operands:
                yield from _reasons(operand, text, wanted, given)
            return
    start, end = node.span or (0, len(text))
    yield HoldingOperand(text[start:end], conjunction([*given, negation(node) if wanted else node]), not wanted)


_ANALYSES = {SfcFlag.ERROR_ANALYZATION, SfcFlag.ERROR_ANALYZATION_TABLE}
_WITH_CALLS = frozenset({Dialect.CODESYS, Dialect.TWINCAT})
"""The dialects in which an action can be called."""


def _text_of(body: Body | None) -> str:
    return body.text if isinstance(body, StBody) else ""
