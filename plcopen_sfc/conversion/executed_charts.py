"""Executed parts of a chart: steps, transitions, actions, permanent instructions, partial charts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Protocol

from plcopen_sfc.conversion.executed_parts import (
    ALONE,
    BOOLEAN_ACTIONS,
    PLAIN_VARIABLES,
    SHOWN_STATE,
    STORED,
    TOGETHER,
    BooleanActions,
    Detail,
    Key,
    Part,
    duration_meaning,
    plain_name,
)
from plcopen_sfc.conversion.meaning import (
    Meaning,
    Once,
    Renaming,
    condition_meaning,
    plain,
    program_form,
)
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding import SharedScans, bind
from plcopen_sfc.languages.effects import ANYTHING, Path, path_of
from plcopen_sfc.languages.networks import NetworkExpression, chart_statements, condition_reader
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, print_node, transform
from plcopen_sfc.model import sfc
from plcopen_sfc.model.actions import STEP_ACTIONS, ActionEvent, Qualifier
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.chart_settings import OPERATING_FLAGS, WATCHING_FLAGS, SfcFlag
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.text import Text
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.semantics.charts.sfc_flags import flags_in_use
from plcopen_sfc.semantics.inputs import MEMBER_NAMES, OUTPUT_NAMES, PARAMETER_NAMES, system_inputs
from plcopen_sfc.semantics.profile import ActionControl, BooleanTargets, Profile


class Around(Protocol):
    """The project around a chart: how its names, texts and actions are compared."""

    project: Project
    profile: Profile
    dialect: Dialect
    global_names: set[str]
    lists: set[str]
    detail: Detail
    added_functions: dict[str, Pou]

    def naming(self, result: str = "") -> Renaming:
        """Return how names in the POU that is read now become names that all tools could have."""

    def code(self, body: sfc.Body | None, result: str = "") -> Meaning | None:
        """Meaning of a body."""

    def target(self, name: str) -> str:
        """Target of an association, as all tools could name it."""

    def operation(self, pou: Pou, name: str, *, is_used: bool | None = None) -> str:
        """The kind of an input that operates the chart of a block: whether anything operates it, if not known."""

    def flags_at_rest(self, pou: Pou, flags: Iterable[SfcFlag]) -> set[SfcFlag]:
        """Return those flags of the charts of a POU that nothing uses."""

    def tell_comment(self, part: Part, thing: Element) -> None:
        """Note the comment and the title of something, where they are wanted."""

    def tell_text(self, part: Part, aspect: str, text: Text | None) -> None:
        """Note a text for people, in all its languages where that is wanted."""

    def tell_networks(self, part: Part, body: sfc.Body | None, aspect: str = "networks") -> None:
        """Note the titles and comments of networks."""


_OF_STEPS = frozenset({Qualifier.N, Qualifier.NONE, Qualifier.P1, Qualifier.P0})
"""Qualifiers without time and memory: their step alone determines what is executed."""
_RESTARTS = frozenset({SfcFlag.INIT, SfcFlag.RESET})
_Executed = tuple[sfc.Step, Qualifier]
"""A step that executes an action, and how."""


class ExecutedChartReader:
    """Reads one chart: steps, transitions, actions, permanent instructions, partial charts."""

    def __init__(self, owner: Around, pou: Pou, chart: sfc.SfcNetwork, path: str, called: set[str]) -> None:
        self.owner = owner
        self.pou = pou
        self.chart = chart
        self.path = path
        self.called = called
        self.is_written = owner.detail is Detail.WRITTEN
        self.names = {step.id: step.name for step in chart.steps if owner.detail or not step.exclude}
        self.timed = [step for step in chart.steps if step.min_time]
        self.labels = chart.labels()
        self.excluded = {step.id for step in chart.steps if step.exclude and not owner.detail}
        declared = {variable.name.casefold() for variable in pou.variables()} | owner.global_names
        self.flags = flags_in_use(chart, owner.profile, lambda name: name.casefold() in declared)
        self.used = Counter(name for step in chart.steps for name, _ in _executed_by(step))
        self.calls: Counter[str] = Counter()
        for step in chart.steps if owner.added_functions else ():
            lasts = [last for last, _ in self._final_calls(step)]
            rows = (row for row in step.actions if not any(row is last for last in lasts))
            self.calls.update(each.name for row in rows if (each := self._function(row.body)) is not None)
        self._named = owner.naming()
        self._read_condition = condition_reader(chart, owner.dialect, transitions=pou.transitions)

    def condition_of(self, condition: sfc.Condition) -> NetworkExpression:
        """Return a condition as an expression in which names of lists of global variables are left out."""
        found = self._read_condition(condition)
        named = self._named
        tree = transform(found.tree, named) if found.tree is not None else None
        return replace(found, tree=tree, before=tuple(transform(each, named) for each in found.before))

    def read(self, part: Part) -> None:
        """Note in `part` what is executed of the chart."""
        self.owner.tell_comment(part, self.chart)
        for step in self.chart.steps:
            if not step.exclude or self.owner.detail:
                self._step(part, step)
        keys: dict[int, Key] = {}
        for transition in self.chart.transitions:
            is_there = self.owner.detail or not self._is_never(transition)
            if is_there and self.excluded.isdisjoint((*transition.sources, *transition.targets)):
                keys[transition.id] = self._transition(part, transition)
        self._priorities(part, keys)
        for number, sequence in enumerate(self.chart.sequences, 1):
            self._tell_title(part, f"title of sequence {number}", sequence.title)
        self._settings(part)
        if not self.owner.detail and (written := self._boolean_actions()) != _NONE_WRITTEN:
            part.tell(BOOLEAN_ACTIONS, Meaning.of(written))
        if self.chart.logic:
            part.tell("drawn logic", self._logic())
        operations = (("before", self.chart.permanent_pre), ("after", self.chart.permanent_post))
        for when, permanent in operations:
            for operation in permanent:
                self._permanent(part, operation, when)
        for partial in self.chart.partial_charts:
            path = f"{self.path} / {partial.name}"
            inner = part.add("partial chart", partial.name, path)
            self.owner.tell_comment(inner, partial)
            inner.tell("kind", Meaning.of(partial.kind.value, f"a partial chart that is {partial.kind}"))
            for aspect, name in (("entry step", partial.entry_step), ("exit step", partial.exit_step)):
                inner.tell(aspect, Meaning.of(name.casefold(), name) if name is not None else None)
            ExecutedChartReader(self.owner, self.pou, partial.chart, path, self.called).read(inner)

    # -- steps

    def _step(self, chart: Part, step: sfc.Step) -> None:
        path = f"{self.path} / step {step.name}"
        part = chart.add("step", step.name, path, step)
        part.tell("initial", Meaning.of(step.initial, "initial step" if step.initial else "no initial step"))
        if step.negated:
            part.tell("negation", Meaning.of(True, "negated"))
        part.tell("min time", duration_meaning(step.min_time))
        if self._uses_maximum_times() or self.owner.detail:
            part.tell("max time", duration_meaning(step.max_time))
        if self.owner.detail:
            part.tell("warning time", duration_meaning(step.warning_time))
            for aspect, supervised in (("interlock", step.interlock), ("supervision", step.supervision)):
                if supervised is not None:
                    self.owner.tell_text(part, f"alarm of the {aspect}", supervised.alarm)
                    self._tell_title(part, f"title of the {aspect}", supervised.title)
            self._tell_all(part, step)
        for aspect, condition in step.conditions.items():
            part.tell(aspect, self._condition(condition))
            self._tell_networks(part, aspect, condition)
        for event, action in (("S1", step.entry_action), ("", step.main_action), ("S0", step.exit_action)):
            is_empty = isinstance(action, StBody) and not action.text.strip()
            if action is not None and (self.owner.detail or not is_empty):
                self._step_action(part, event, action)
        final = self._final_calls(step)
        for association in step.actions:
            if (not association.exclude or self.owner.detail) and not any(association is last for last, _ in final):
                self._association(part, step, association, ends=any(association is first for _, first in final))
        self._stored(part, step)
        if step.macro is not None:
            inner = part.add("macro-step", step.name, path)
            if step.macro.expansion is not None:
                inner.tell("expansion", Meaning.of(step.macro.expansion.casefold(), step.macro.expansion))
            if isinstance(step.macro.body, sfc.SfcBody):
                ExecutedChartReader(self.owner, self.pou, step.macro.body.chart, path, self.called).read(inner)
        for enclosure in step.encloses or ():
            inner = part.add("enclosed chart", enclosure.chart, path)
            steps = enclosure.activated_steps
            inner.tell("activated steps", Meaning.of(tuple(map(str.casefold, steps)), ", ".join(steps) or "none"))

    def _tell_all(self, part: Part, thing: sfc.Step | sfc.Transition | sfc.ActionAssociation) -> None:
        """Note what no controller executes."""
        self.owner.tell_comment(part, thing)
        part.tell("excluded", Meaning.of(True, "excluded from the program") if thing.exclude else None)
        number = None if isinstance(thing, sfc.ActionAssociation) or not self.is_written else thing.number
        part.tell("number", Meaning.of(number) if number is not None else None)

    def _uses_maximum_times(self) -> bool:
        """True if exceeding a maximum time does something: S7-GRAPH reports it, CODESYS sets SFCError."""
        if self.owner.profile.graph_parameters:
            return False  # an alarm for people; `.T_MAX` is a variable like others
        return self.owner.profile.maximum_times and SfcFlag.ERROR in self.flags

    def _step_action(self, step: Part, event: str, action: str | sfc.Body) -> None:
        """An entry (S1), main or exit (S0) action of CODESYS."""
        if isinstance(action, str) and not self.is_written and self.pou.find_action(action) is None:
            action = StBody(text=f"{action}();")  # of which a text has the call
        name, code = self._code_of(action)
        part = step.add("action", name, f"{step.path} / action {name}")
        when = {"S1": "on activation", "S0": "on deactivation", "": "while active"}[event]
        part.tell("trigger", Meaning.of(event if self.is_written else (when, ALONE), _STEP_ACTIONS[event]))
        part.tell("code", code)

    def _function(self, body: sfc.Body | None) -> Pou | None:
        """Return the function added for an action that a row does nothing but call, with the variables of the block."""
        if not isinstance(body, StBody) or not self.owner.added_functions:
            return None
        statements = parse_statements(body.text, self.owner.dialect).tree.statements
        call = statements[0].call if len(statements) == 1 and isinstance(statements[0], n.CallStatement) else None
        if not isinstance(call, n.Call):
            return None
        function = self.owner.added_functions.get(call.called.casefold())
        passed = {_same_name(argument) for argument in call.arguments}
        if function is None or passed != {variable.name.casefold() for variable in function.variables()}:
            return None
        return function

    def _final_calls(self, step: sfc.Step) -> list[tuple[sfc.ActionAssociation, sfc.ActionAssociation]]:
        """The rows that call an added function once more when the step ends, each with the row that calls it before."""
        calls = [row for row in step.actions if not row.exclude and self._function(row.body) is not None]
        lasting = [row for row in calls if row.event is None]
        found: list[tuple[sfc.ActionAssociation, sfc.ActionAssociation]] = []
        for row in (each for each in calls if each.event is ActionEvent.S0):
            pairs = (each for each in lasting if each.body == row.body and all(each is not first for _, first in found))
            first = next(pairs, None)
            if first is not None:
                found.append((row, first))
        return found

    def _association(self, step: Part, of: sfc.Step, association: sfc.ActionAssociation, *, ends: bool = False) -> None:
        """Note an association. `ends`: another one executes it once more when the step ends."""
        function = self._function(association.body)
        name, code = self._code_of(association.target, association.body if function is None else function.body)
        if association.forcing is not None:
            name = f"force {association.forcing.chart}"
        part = step.add("action", name, f"{step.path} / action {name}")
        part.tell("trigger", self._trigger(association, is_code=code is not None))
        if self.owner.detail:
            self._tell_all(part, association)
            part.tell("indicator", Meaning.of(association.indicator) if association.indicator else None)
        pulse = association.qualifier in (Qualifier.P, Qualifier.P1, Qualifier.P0)
        if ends or (code is not None and self.owner.profile.final_scan and not pulse and association.event is None):
            part.tell("final scan", Meaning.of(True))
        part.tell("code", code)
        if association.target is not None and association.body is not None:
            part.tell("target", Meaning.of(association.target.casefold(), association.target))
        if association.qualifier not in _UNTIMED or self.owner.detail:
            part.tell("time", duration_meaning(association.duration))
        if association.value is not None:
            value = association.value
            part.tell("value", condition_meaning(lambda: self.condition_of(Expression(text=value)), value.strip()))
        if association.condition is not None:
            part.tell("condition", self._condition(association.condition))
        if association.interlock and self.is_written:
            part.tell("interlock", Meaning.of(True, "needed"))
        elif association.interlock and "interlock" in of.conditions:
            part.tell("interlock", self._condition(of.conditions["interlock"]))
        if association.negated:
            part.tell("negation", Meaning.of(True, "negated"))
        if association.forcing is not None:
            order = association.forcing
            part.tell("forcing", Meaning.of((order.chart, order.situation.value, *order.steps), str(order)))

    def _stored(self, part: Part, step: sfc.Step) -> None:
        """Values that the rows S and R of a step leave in each operand: the last one counts in S7-GRAPH, else R."""
        for association in step.actions:
            name = association.target
            plain_row = association.event is None and association.body is None and association.condition is None
            stored = _STORED.get(association.qualifier)
            if name is None or stored is None or not plain_row or association.interlock or association.exclude:
                continue
            if association.duration or self.pou.find_action(name) is not None:
                continue
            aspect = f"{STORED}{plain_name(self.owner.target(name))}"
            before = part.aspects.get(aspect)
            if before is None or stored == "FALSE" or self.owner.profile.graph_parameters:
                part.tell(aspect, Meaning.of(stored))

    def _boolean_actions(self) -> BooleanActions:
        """Return the variables that are actions, and which of them something else writes as well."""
        rows = [(step, row) for step, row in self.chart.associations() if self._is_boolean(row)]
        trees = [parse_expression(row.target or "", self.owner.dialect).tree for _, row in rows]
        own = [self._path(path_of(tree)) for tree in trees]
        acting: dict[Path, list[sfc.ActionAssociation]] = {}
        for path, (step, row) in zip(own, rows, strict=True):
            if not (step.exclude or row.exclude) and path != ANYTHING:
                acting.setdefault(path, []).append(row)
        paths = set(own) - {ANYTHING}
        inside = self._written(self.pou) if paths else set()
        declared = {variable.name.casefold() for variable in self.pou.variables()}
        declared -= {variable.name.casefold() for variable in self.pou.variables(SectionKind.EXTERNAL)}
        shared = {path for path in paths - inside if path[0] not in declared}
        others = (pou for pou in self.owner.project.pous if pou is not self.pou) if shared else ()
        outside = {path for pou in others for path in self._written(pou) & shared}
        rules = {".".join(path): self._written_at(each) for path, each in acting.items()}
        spelled = {".".join(path): (each[0].target or "").translate(_NO_MARKS) for path, each in acting.items()}
        by_code, elsewhere = (frozenset(map(".".join, each)) for each in (paths & inside, outside))
        return BooleanActions(rules, by_code, elsewhere, spelled)

    def _written_at(self, rows: Sequence[sfc.ActionAssociation]) -> tuple[str, str]:
        """Return when the variable of these rows is written, and when, if only other POUs look."""
        profile = self.owner.profile
        if not profile.graph_parameters:
            return WRITTEN[profile.boolean_targets], WRITTEN[profile.boolean_targets]
        are_coils = all(row.qualifier in _COILS for row in rows)
        return BY_STEPS, WRITTEN[BooleanTargets.WHEN_EXECUTED] if are_coils else BY_STEPS

    def _is_boolean(self, row: sfc.ActionAssociation) -> bool:
        """True for a row whose action is a variable that follows its control; in S7-GRAPH a coil, or S and R."""
        if row.target is None or row.body is not None or row.value is not None or row.kind is not None:
            return False
        is_plain = row.qualifier in _COILS or (row.qualifier in _STORED and row.event is None)
        return (is_plain or not self.owner.profile.graph_parameters) and self.pou.find_action(row.target) is None

    def _written(self, pou: Pou) -> set[Path]:
        """Return what the bodies of a POU write, but for the rows of this chart."""
        bodies = (*pou.bodies, *(action.body for action in pou.actions), *(method.body for method in pou.methods))
        bound = [bind(body, self.owner.dialect) for body in bodies if body is not None]
        found = [each.code if any(c.chart is self.chart for c in each.charts) else each.effects for each in bound]
        return {self._path(path) for each in found for path in each.writes}

    def _path(self, path: Path) -> Path:
        """Return the path of a variable as all tools could have it: without the list of a global variable."""
        return tuple(map(plain_name, path[1:] if len(path) > 1 and path[0] in self.owner.lists else path))

    def _code_of(self, action: str | sfc.Body | None, body: sfc.Body | None = None) -> tuple[str, Meaning | None]:
        """Name of an action, and its program; none for a variable."""
        if isinstance(action, str):
            found = self.pou.find_action(action)
            if found is None:
                return self.owner.target(action), self.owner.code(body)
            self.called.add(found.name.casefold())
            if self.is_written:
                return found.name, None
            if isinstance(found.body, sfc.SfcBody):
                order = self.owner.profile.order.value.replace("_", " ")
                return found.name, Meaning.of(("chart", found.name.casefold(), order), f"a chart, {order}")
            return found.name, self.owner.code(found.body) or Meaning.of("", "an empty action")
        return "in place", self.owner.code(action or body)

    def _trigger(self, association: sfc.ActionAssociation, *, is_code: bool) -> Meaning:
        """Return when an action is executed, the same for all tools: qualifier, event and kind."""
        qualifier, event = association.qualifier, association.event
        if event in (ActionEvent.C, None):
            event = None
        kind = association.kind.words if association.kind is not None else None
        shown = kind or " ".join(filter(None, (qualifier.value, event and f"event {event.value}")))
        if self.is_written:
            return Meaning.of((qualifier.value, event and event.value, association.kind), shown)
        control = self._control(association, is_code=is_code)
        if association.kind is not None:
            return Meaning.of((association.kind.value, qualifier.value), shown)
        plain = qualifier in (Qualifier.N, Qualifier.NONE, Qualifier.CALL)
        if event is not None and not plain:
            return Meaning.of((event.value, qualifier.value), shown)
        if event is not None:
            when = {ActionEvent.S1: "on activation", ActionEvent.S0: "on deactivation"}.get(event, event.value)
            return Meaning.of((when, control), shown)
        # with a final scan the code of a pulse is executed twice, in other tools once
        twice = qualifier is Qualifier.P and is_code and self.owner.profile.final_scan
        if qualifier in (Qualifier.P1, Qualifier.P) and not twice:
            return Meaning.of(("on activation", control), shown)
        if qualifier is Qualifier.P0:
            return Meaning.of(("on deactivation", control), shown)
        if plain:
            return Meaning.of(("while active", control), shown)
        if twice:
            shown = f"{shown} with a final scan"
        return Meaning.of(("R" if qualifier is Qualifier.R0 else qualifier.value, control), shown)

    def _control(self, association: sfc.ActionAssociation, *, is_code: bool) -> str:
        """Return the control of an action of several associations: one control for all, or each step for itself.

        It makes a difference for programs, and for what has a time or a pulse.
        """
        name = plain_name(association.target) if association.target is not None else ""
        matters = is_code or association.qualifier.needs_duration or association.qualifier is Qualifier.P
        function = self._function(association.body)
        # a single association is the same with a control of its own and with a common one
        if not matters or (self.used[name] if function is None else self.calls[function.name]) < 2:
            return ALONE
        if association.qualifier is Qualifier.P and not is_code and self._is_plain_but_for(association):
            return ALONE  # what is N in other steps neither begins nor hides its pulse
        if function is None and name in self._apart:
            return ALONE
        profile = self.owner.profile
        alone = profile.graph_parameters and profile.action_control is not ActionControl.SEQUENTIAL
        return ALONE if alone else TOGETHER

    @cached_property
    def _apart(self) -> frozenset[str]:
        """The actions that no scan executes for two steps, nor for one right behind another one.

        Then it is the same whether they have one control or each step its own. SFCInit and SFCReset lead from any step
        to an initial one.
        """
        rows = grouped((name, (step, qualifier)) for step in self.chart.steps for name, qualifier in _executed_by(step))
        scans, restarts = SharedScans(self.chart, self.pou, self.owner.dialect), bool(self.flags & _RESTARTS)

        def meet(one: _Executed, other: _Executed) -> bool:
            if {one[1], other[1]} == {Qualifier.P0, Qualifier.P1}:
                left, entered = (one, other) if one[1] is Qualifier.P0 else (other, one)
                return scans.follow(left[0], entered[0])
            return scans.follow(one[0], other[0]) or scans.follow(other[0], one[0])

        def are_apart(used: list[_Executed]) -> bool:
            if restarts and len(used) > 1 and any(step.initial for step, _ in used):
                return False
            of_step: dict[int, list[_Executed]] = {}
            for each in used:  # an action may be that of thousands of steps: only those near each other are compared
                near = of_step.keys() & scans.near(each[0].id)
                if any(meet(each, other) for step in near for other in of_step[step]):
                    return False
                of_step.setdefault(each[0].id, []).append(each)
            return True

        plain = {name: used for name, used in rows.items() if all(qualifier in _OF_STEPS for _, qualifier in used)}
        return frozenset(name for name, used in plain.items() if not scans.are_switched and are_apart(used))

    def _is_plain_but_for(self, pulse: sfc.ActionAssociation) -> bool:
        """True if all other associations with the variable of a pulse are N."""
        return all(row is pulse for row in self._not_plain.get(plain_name(pulse.target or ""), ()))

    @cached_property
    def _not_plain(self) -> dict[str, list[sfc.ActionAssociation]]:
        """The associations that are not N, by the names of their variables."""
        return grouped(
            (plain_name(row.target or ""), row)
            for _, row in self.chart.associations()
            if row.qualifier not in (Qualifier.N, Qualifier.NONE) or row.event is not None
        )

    # -- transitions

    def _transition(self, chart: Part, transition: sfc.Transition) -> Key:
        sources = "+".join(sorted(plain_name(self.names.get(i, "?")) for i in transition.sources))
        targets = "+".join(sorted(plain_name(self.names.get(i, "?")) for i in transition.targets))
        name = f"{sources} -> {targets}"
        label = self.labels[transition.id]
        part = chart.add("transition", name, f"{self.path} / transition {label}", transition)
        part.leaves = tuple(plain_name(self.names.get(i, "?")) for i in transition.sources)
        if transition.condition is not None:
            part.tell("condition", self._condition(transition.condition))
            self._tell_networks(part, "condition", transition.condition)
            part.waiting = self._waiting(transition)
        elif self.owner.profile.graph_parameters:
            part.tell("condition", Meaning.of(("TRUE",), "TRUE"))
        if self.owner.detail:
            self._tell_all(part, transition)
        return next(reversed(chart.parts))

    def _is_never(self, transition: sfc.Transition) -> bool:
        """True for a transition that never fires: it is excluded, or its condition is FALSE, and no SFCTip fires it."""
        if transition.exclude or transition.condition is None:
            return transition.exclude
        if isinstance(transition.condition, Expression) and "FALSE" not in transition.condition.text.upper():
            return False
        if self.owner.flags_at_rest(self.pou, self.flags & {SfcFlag.TIP}) != self.flags & {SfcFlag.TIP}:
            return False
        found = self.condition_of(transition.condition)
        tree = n.bare(found.tree) if found.tree is not None else None
        return isinstance(tree, n.Literal) and tree.text.upper() == "FALSE" and not found.before

    def _waiting(self, transition: sfc.Transition) -> Meaning | None:
        """Return the condition together with the minimum times of the steps that a transition leaves."""
        condition = transition.condition
        sources = [step for step in self.timed if step.id in transition.sources]
        if condition is None or not sources:
            return None
        local = "#" if self.owner.dialect is Dialect.SCL else ""
        times = [f"{local}{step.name}.T >= {step.min_time}" for step in sources]

        def read() -> NetworkExpression:
            found = self.condition_of(condition)
            parsed = [parse_expression(text, self.owner.dialect).tree for text in times]
            trees = [tree for tree in (found.tree, *parsed) if tree is not None]
            return replace(found, tree=n.Operation(n.Operator.AND, tuple(trees)))

        return condition_meaning(Once(read), (plain(condition), *times))

    def _priorities(self, chart: Part, keys: dict[int, Key]) -> None:
        """The order in which competing transitions of each step are tried."""
        for source, leaving in sfc.leaving_steps(self.chart.transitions).items():
            order = [keys[each.id] for each in leaving if each.id in keys]
            if source in self.names and len(order) > 1:
                step = chart.steps_named(plain_name(self.names[source]))[0]
                names = tuple(key.name for key in order)
                step.tell("order of transitions", Meaning.of(names, ", ".join(names)))
                step.order = tuple(order)

    def _tell_networks(self, part: Part, aspect: str, condition: sfc.Condition) -> None:
        if isinstance(condition, sfc.BodyCondition):
            self.owner.tell_networks(part, condition.body, f"the {aspect}")

    def _condition(self, condition: sfc.Condition) -> Meaning:
        if self.is_written and condition.kind == "named":
            name, negated = condition.name, condition.negated
            return Meaning.of(("named", name.casefold(), negated), f"NOT {name}" if negated else name)
        # two names or wires that cannot be followed may lead to different things; a pin without wires leads nowhere
        is_whole = condition.kind in ("expression", "body") or (
            condition.kind == "wired" and not condition.input.connections
        )
        raw = plain(condition) if is_whole else object()
        read = Once(lambda: self.condition_of(condition))
        meaning = condition_meaning(read, raw)
        if (
            not self.owner.detail
            or not isinstance(condition, sfc.BodyCondition)
            or not isinstance(condition.body, IlBody)
        ):
            return meaning
        text = condition.body.text.strip()
        return replace(meaning, shown=lambda: meaning.show() if read().tree is not None else text)

    # -- around the steps

    def _settings(self, chart: Part) -> None:
        """Tell what operates and watches the chart: SFC flags, parameters of S7-GRAPH, settings of its block.

        Where texts are compared as they are written (`detail`), settings are told that no controller executes.
        """
        resting = self.owner.flags_at_rest(self.pou, self.flags) if not self.owner.detail else set()
        for flag in sorted(self.flags):
            name = flag.variable
            if flag in OPERATING_FLAGS and not self.owner.detail:
                kind = self.owner.operation(self.pou, name, is_used=flag not in resting)
                chart.add(kind, name, f"{self.path} / {name}")
            elif flag in WATCHING_FLAGS or flag not in resting:  # what only people read is no part of the machine
                chart.tell(name, Meaning.of(True, name))
        inputs = [variable.name for variable in self.pou.variables(SectionKind.INPUT)]
        flags = {flag.variable.casefold() for flag in self.flags}
        operating = system_inputs(self.pou, self.owner.profile, inputs)
        operating -= {name for name in operating if name.rpartition(".")[2].casefold() in flags}
        if operating and self.owner.profile.graph_parameters:
            for name in sorted(operating):
                chart.add(self.owner.operation(self.pou, name), name, f"{self.pou.report_path} / {name}")
        outputs = [variable.name for variable in self.pou.variables(SectionKind.OUTPUT)]
        named = [name for name in (*inputs, *outputs) if name.casefold() in PARAMETER_NAMES]
        named += [v.name for v in self.pou.variables() if v.name.casefold() in MEMBER_NAMES and v.name not in named]
        if self.owner.profile.graph_parameters:
            chart.parameters = frozenset(map(str.casefold, named))
            rows = {plain_name(row.target or "") for step in self.chart.steps for row in step.actions}
            shown = [name for name in outputs if name.casefold() in OUTPUT_NAMES and plain_name(name) not in rows]
            if shown:
                chart.tell(SHOWN_STATE, Meaning.of(frozenset(map(str.casefold, shown)), ", ".join(shown)))
        elif named and self.chart.graph_settings is None:  # it was no chart of S7-GRAPH before
            chart.tell(PLAIN_VARIABLES, Meaning.of(frozenset(map(str.casefold, named)), ", ".join(named)))
        graph = self.chart.graph_settings
        if self.is_written:
            for settings in filter(None, (graph, self.chart.settings)):
                for name in type(settings).model_fields:
                    value = getattr(settings, name)
                    words = {True: "on", False: "off"}[value] if isinstance(value, bool) else value
                    chart.tell(name.replace("_", " "), Meaning.of(value, words) if isinstance(words, str) else None)
        elif graph is not None and self.owner.profile.graph_parameters:
            for name, needs in _GRAPH_SETTINGS.items():
                matters = not needs or any(getattr(step, needs) is not None for step in self.chart.steps)
                if matters and getattr(graph, name):
                    chart.tell(name.replace("_", " "), Meaning.of(True, "on"))

    def _logic(self) -> Meaning | None:
        """Return the effects of logic drawn in the chart, besides feeding conditions."""
        drawn = chart_statements(self.chart, self.owner.dialect).tree
        text = print_node(drawn)
        meaning = Meaning(lambda: text, text, lambda: program_form(drawn, self._named), text=lambda: text)
        return meaning if text.strip() else None

    def _permanent(self, chart: Part, operation: sfc.PermanentOperation, when: str) -> None:
        code = self.owner.code(operation.body)
        if code is not None:
            part = chart.add(f"permanent instruction {when} the sequence", "", self.path)
            part.tell("code", code)
            self._tell_title(part, "title", operation.title)
            self.owner.tell_networks(part, operation.body)

    def _tell_title(self, part: Part, aspect: str, title: Text | None) -> None:
        """Note a title that only files of one tool have."""
        if self.is_written:
            self.owner.tell_text(part, aspect, title)


def _executed_by(step: sfc.Step) -> Iterator[tuple[str, Qualifier]]:
    """Yield the names of what a step executes, with entry and exit actions as P1 and P0.

    Every association and step action counts; assignments share no control.
    """
    for row in step.actions:
        if row.value is None and isinstance(row.target, str):
            yield plain_name(row.target), row.qualifier
    for kind, action in step.step_actions.items():
        if isinstance(action, str):
            yield plain_name(action), STEP_ACTIONS[kind]


def _same_name(argument: n.Argument) -> str:
    """Return the name of a parameter, in lower case, that gets the variable of the same name; empty for any other."""
    named, value = argument.name, argument.value
    same = (
        named is not None and isinstance(value, n.Name) and value.identifier.casefold() == named.identifier.casefold()
    )
    return named.identifier.casefold() if named is not None and same else ""


WRITTEN = {
    BooleanTargets.ALWAYS: "in every scan",
    BooleanTargets.WHEN_EXECUTED: "only while its action is executed",
    BooleanTargets.WHEN_DECIDED: "only while an association decides on it",
}
"""When a Boolean variable that is an action is written, in words."""
BY_STEPS = "only while a step with it is active, before other actions"
"""The same of S7-GRAPH: coils come first, S and R are rows of their steps."""
_NONE_WRITTEN = BooleanActions({}, frozenset(), frozenset(), {})
_NO_MARKS = str.maketrans("", "", '#"')
_COILS = frozenset({Qualifier.N, Qualifier.NONE, Qualifier.D, Qualifier.L})
_UNTIMED = frozenset({Qualifier.N, Qualifier.NONE, Qualifier.S, Qualifier.R, Qualifier.R0})
"""Qualifiers with which no tool executes a time that is written nevertheless."""
_STORED = {Qualifier.S: "TRUE", Qualifier.R: "FALSE", Qualifier.R0: "FALSE"}
_STEP_ACTIONS = {"S1": "entry action", "": "main action", "S0": "exit action"}
_GRAPH_SETTINGS = {
    "acknowledge_errors_required": "supervision",
    "lock_operating_mode": "",
    "permanent_interlock_processing_in_manual_mode": "interlock",
    "skip_steps": "",
}
"""Settings of S7-GRAPH that change what is executed, and what a step must have for that."""
