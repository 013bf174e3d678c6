"""Charts as matiec executes them: what it has no words for becomes statements that are executed in every scan.

The order of a scan in the C code that matiec makes: transitions, then what associations say, then the bodies of
actions. A condition in text cannot call a block, so that blocks, edges and drawn outputs stand in one action, which is
executed in every scan from the first on; conditions read what it left in the scan before, as the converters of Beremiz
and OpenPLC have it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import count

from plcopen_sfc.formats.matiec.drawn import is_taken, write_negations_out
from plcopen_sfc.formats.matiec.flags import StepFlags
from plcopen_sfc.formats.matiec.statements import compilable_comments
from plcopen_sfc.formats.matiec.unit import Unit
from plcopen_sfc.languages.networks import NetworkExpression, NetworkStatements, chart_statements, condition_reader
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.words import is_plain
from plcopen_sfc.model.actions import ActionAssociation, Qualifier
from plcopen_sfc.model.body import Body, FbdBody, LdBody, StBody
from plcopen_sfc.model.conditions import Condition, Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.pou import Action
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.report import Outcome

_QUALIFIERS = frozenset(
    {Qualifier.N, Qualifier.NONE, Qualifier.S, Qualifier.R, Qualifier.P, Qualifier.P0, Qualifier.P1}
    | {Qualifier.L, Qualifier.D, Qualifier.SD, Qualifier.DS, Qualifier.SL}
)
_ALONE = frozenset({Qualifier.N, Qualifier.NONE, Qualifier.P, Qualifier.P0, Qualifier.P1, Qualifier.L, Qualifier.D})
"""Those of which matiec takes the last of several that drive one thing, instead of one that is active."""
_DELAYED = frozenset({Qualifier.SD, Qualifier.DS, Qualifier.SL})
_STEP_ACTIONS = (("entry", Qualifier.P1), ("main", Qualifier.N), ("exit", Qualifier.P0))
_RISING = frozenset({Qualifier.P, Qualifier.P1})
_PULSES = _RISING | {Qualifier.P0}
_WHENEVER = frozenset({Qualifier.N, Qualifier.NONE})


@dataclass(slots=True)
class ChartFitter:
    """Fits the chart of a POU.

    `final_scan`: the tool of the project executes an action once more after its end, as CODESYS does; False: IEC
    61131-3 leaves that to the tool; None: its tool does not. `step_actions` are the ids of associations in the place of
    entry, main and exit actions, which are never executed once more.
    """

    unit: Unit
    chart: SfcNetwork
    final_scan: bool | None = None
    logic: list[str] = field(default_factory=list)
    step_actions: set[int] = field(default_factory=set)
    ids: Iterator[int] = field(init=False)

    def __post_init__(self) -> None:
        """What is added to the chart gets new ids."""
        self.ids = count(self.chart.new_id())

    def fit(self) -> None:
        """Change the chart, and the actions and variables of its POU."""
        chart = self.chart
        self._refuse_parts()
        keeps = self._keeps_drawn_logic()
        chart.steps.sort(key=lambda step: not step.initial)
        self._number_competing()
        # what feeds conditions only is told by the conditions, as long as they are drawn
        drawn = None if keeps else chart_statements(chart, self.unit.dialect, taken=self.unit.used)
        self._conditions(keeps)
        for step in chart.steps:
            self._step(step)
        self._hold_initial_steps()
        self._share()
        if drawn is not None:
            self._drawn_logic(drawn)
            chart.logic = []
        self._ends()
        self._put_logic()
        if self.unit.keeps_drawings:
            StepFlags(self.unit, chart, self.ids).put()
        chart.drawing = None
        used = {t.condition.name.casefold() for t in chart.transitions if isinstance(t.condition, NamedCondition)}
        self.unit.pou.transitions = [t for t in self.unit.pou.transitions if t.name.casefold() in used]

    def _keeps_drawn_logic(self) -> bool:
        """True if wired conditions stay as they are drawn; what is drawn besides is translated by nobody."""
        unit, chart = self.unit, self.chart
        if not unit.keeps_drawings or not is_taken(chart.logic, unit.dialect):
            return False
        if not unit.own and chart_statements(chart, unit.dialect, taken=unit.used).tree.statements:
            return False
        unit.note_negations(write_negations_out(chart.logic), unit.path)
        return True

    def _stays_drawn(self, condition: Condition | None, *, keeps: bool) -> bool:
        """True if the converters translate a condition rightly as it is drawn."""
        if isinstance(condition, WiredCondition):
            return keeps and not condition.negated and bool(condition.input.connections)
        if not self.unit.keeps_drawings or not isinstance(condition, NamedCondition) or condition.negated:
            return False
        found = [t.body for t in self.unit.pou.transitions if t.name.casefold() == condition.name.casefold()]
        bodies = [body for body in found if isinstance(body, FbdBody | LdBody)]
        nodes = [node for body in bodies for network in body.networks for node in network.nodes]
        if not bodies or not is_taken(nodes, self.unit.dialect):
            return False
        self.unit.note_negations(write_negations_out(nodes), f"{self.unit.path} / transition {condition.name}")
        return True

    # -- what cannot be said -------------------------------------------------------------------------------------------

    def _refuse_parts(self) -> None:
        chart, path = self.chart, self.unit.path
        chart.steps = [step for step in chart.steps if not self._is_excluded(step, f"step {step.name}")]
        kept = {step.id for step in chart.steps}
        chart.transitions = [t for t in chart.transitions if kept.issuperset((*t.sources, *t.targets))]
        labels = chart.labels()
        chart.transitions = [t for t in chart.transitions if not self._is_excluded(t, f"transition {labels[t.id]}")]
        refused = [
            (chart.partial_charts, "partial charts", "matiec has no GRAFCET"),
            (chart.permanent_pre, "permanent operations", "matiec has none"),
            (chart.permanent_post, "permanent operations", "matiec has none"),
        ]
        for things, what, why in refused:
            if things:
                self.unit.note(Outcome.NOT_EXECUTED, what, path, why)
                self.logic.append(self.unit.nothing_right(what))
        chart.partial_charts, chart.permanent_pre, chart.permanent_post = [], [], []
        settings = chart.settings
        for flag, use in settings.flags.items() if settings is not None else ():
            if use.use:
                self.unit.note(Outcome.NOT_EXECUTED, "flag", path, f"matiec has no {flag.variable}")
        chart.settings = None
        chart.graph_settings = None
        chart.sequences = []

    def _is_excluded(self, part: Step | Transition | ActionAssociation, path: str) -> bool:
        if part.exclude:
            self.unit.note(
                Outcome.TRANSLATED, "excluded part", f"{self.unit.path} / {path}", "left out, as it is built"
            )
        return part.exclude

    # -- transitions ---------------------------------------------------------------------------------------------------

    def _number_competing(self) -> None:
        """Give competing transitions numbers: without them matiec lets all that are true fire together."""
        chart = self.chart
        chart.transitions = [t for step in chart.steps for t in chart.outgoing(step) if t.sources[0] == step.id] + [
            t for t in chart.transitions if not t.sources or all(s.id != t.sources[0] for s in chart.steps)
        ]
        if self.unit.own:
            return
        competing = Counter(source for t in chart.transitions for source in set(t.sources))
        groups = [t for t in chart.transitions if any(competing[s] > 1 for s in t.sources)]
        ordered = sorted(groups, key=lambda t: (t.priority is None, t.priority or 0))
        if ordered and [t.priority for t in ordered] != sorted({t.priority or -1 for t in ordered}):
            self.unit.note(
                Outcome.TRANSLATED, "selection", self.unit.path, "numbered: matiec fires all without numbers together"
            )
        for number, transition in enumerate(ordered, 1):
            transition.priority = number

    def _conditions(self, keeps: bool) -> None:
        unit, chart = self.unit, self.chart
        read = condition_reader(chart, unit.dialect, transitions=unit.pou.transitions, taken=unit.used)
        labels = chart.labels()
        steps = {step.id: step for step in chart.steps}
        names: set[str] = set()
        for transition in chart.transitions:
            path = f"{unit.path} / transition {labels[transition.id]}"
            timed = any(steps[source].min_time for source in transition.sources if source in steps)
            if not timed and self._stays_drawn(transition.condition, keeps=keeps):
                continue
            text = self._condition(transition.condition, read, path)
            for source in transition.sources:
                step = steps.get(source)
                if step is not None and step.min_time:
                    text = f"({text}) AND {step.name}.T >= {step.min_time}"
                    unit.note(Outcome.TRANSLATED, "minimum time", path, "a condition on the step's time")
            transition.condition = Expression(text=text)
            if not is_plain(transition.name) or transition.name.casefold() in names | unit.used:
                transition.name = ""
            names.add(transition.name.casefold())
            if not transition.sources:
                unit.note(Outcome.NOT_EXECUTED, "transition", path, "it leaves no step")
        for step in chart.steps:
            step.min_time = None

    def _condition(self, condition: Condition | None, read: Callable[[Condition], NetworkExpression], path: str) -> str:
        unit = self.unit
        if condition is None:
            unit.note(
                Outcome.NOT_EXECUTED, "condition", path, "the transition has none; the text does not compile there"
            )
            return unit.missing("condition")
        if isinstance(condition, Expression):
            text = compilable_comments(condition.text, unit.dialect).strip().removeprefix(":=").strip(" ;\n")
            if text:
                return f"NOT ({text})" if condition.negated else text
        found = read(condition)
        wrong = [str(problem) for problem in found.obstacles]
        if found.tree is None:
            wrong = wrong or ["it has no value"]
        if not wrong:
            wrong = unit.declare_helpers(found.helpers)
        if wrong or found.tree is None:
            unit.note(Outcome.NOT_EXECUTED, "condition", path, f"{'; '.join(wrong)}; the text does not compile there")
            return unit.missing("condition")
        before = [print_node(statement, unit.dialect) for statement in found.before]
        self.logic += [text for text in before if text not in self.logic]  # a block may feed several conditions
        drawn = not isinstance(condition, Expression)
        if before and not unit.own:
            why = "its blocks are executed in every scan, behind the transitions"
            unit.note(Outcome.APPROXIMATED, "condition", path, why)
        elif drawn and unit.own and any(isinstance(node, Block) for node in self.chart.logic):
            why = "the converter of its tool computes its blocks in the order of their places, and one scan later"
            unit.note(Outcome.APPROXIMATED, "condition", path, why)
        elif drawn:
            unit.note(Outcome.TRANSLATED, "condition", path, "an expression")
        return print_node(found.tree, unit.dialect)

    def _ends(self) -> None:
        """A transition that leads nowhere leads to a step that is never left."""
        for transition in self.chart.transitions:
            if not transition.targets:
                step = Step(id=next(self.ids), name=self.unit.new_name("End"))
                self.chart.steps.append(step)
                transition.targets = [step.id]
                path = f"{self.unit.path} / transition {self.chart.label(transition)}"
                self.unit.note(Outcome.TRANSLATED, "end", path, f"a step {step.name} that is never left")

    def _hold_initial_steps(self) -> None:
        """Execute the actions of initial steps in the first scan: their tool does so before it looks at transitions."""
        initial = {step.id: step for step in self.chart.initial_steps if step.actions}
        leaving = [t for t in self.chart.transitions if initial.keys() & set(t.sources)]
        if not self.final_scan or not leaving:
            return
        started = self.unit.declare("Started")
        self.logic.append(f"{started} := TRUE;")
        for transition in leaving:
            if isinstance(transition.condition, Expression):
                transition.condition.text = f"{started} AND ({transition.condition.text})"
        for step in initial.values():
            path = f"{self.unit.path} / step {step.name}"
            self.unit.note(
                Outcome.TRANSLATED, "initial step", path, f"not left before {started}: its actions come first"
            )

    # -- steps ---------------------------------------------------------------------------------------------------------

    def _step(self, step: Step) -> None:
        unit = self.unit
        path = f"{unit.path} / step {step.name}"
        lines: list[ActionAssociation] = []
        for kind, qualifier in _STEP_ACTIONS:
            value = getattr(step, f"{kind}_action")
            setattr(step, f"{kind}_action", None)
            if value is not None:
                new = ActionAssociation(id=next(self.ids), qualifier=qualifier)
                if isinstance(value, str):
                    new.target = value
                else:
                    new.body = value
                unit.note(Outcome.TRANSLATED, f"{kind} action", path, f"an association with {qualifier}")
                lines += self._association(step, new, f"{step.name}_{kind}", path)
                self.step_actions.update(line.id for line in lines)
        for number, association in enumerate(step.actions, 1):
            lines += self._association(step, association, f"{step.name}_action_{number}", path)
        step.actions = lines
        gone = [
            (step.max_time, "maximum time", False),
            (step.warning_time, "warning time", False),
            (step.interlock is not None and step.interlock.condition, "interlock", False),
            (step.supervision is not None and step.supervision.condition, "supervision", True),
            (step.macro, "macro-step", True),
            (step.encloses, "enclosed charts", True),
        ]
        for present, what, changes_more in gone:
            if present:
                unit.note(Outcome.NOT_EXECUTED, what, path, f"matiec has no {what}")
                if changes_more:
                    self.logic.append(unit.nothing_right(f"{step.name}_{what}"))
        step.max_time = step.warning_time = step.interlock = step.supervision = step.macro = step.encloses = None
        step.negated = False

    def _association(self, step: Step, found: ActionAssociation, wish: str, path: str) -> list[ActionAssociation]:
        unit = self.unit
        place = f"{path} / {found.target or wish}"
        if self._is_excluded(found, place.removeprefix(f"{unit.path} / ")):
            return []
        wrong = self._wrong(step, found)
        if wrong:
            unit.note(Outcome.NOT_EXECUTED, "association", place, "; ".join(wrong))
            return [self._line(Qualifier.N, self._action(wish, StBody(text=unit.nothing_right(wish)), place))]
        if found.qualifier in _DELAYED and not unit.own:
            why = "matiec starts SL again without R, lets R end no delay that runs, and sees no activation in the start"
            unit.note(Outcome.APPROXIMATED, "association", place, f"{found.qualifier}: {why}")
        qualifier = Qualifier.R if found.qualifier is Qualifier.R0 else found.qualifier
        lines: list[ActionAssociation] = []
        for target, body in ((found.target, None), (None, found.body)):
            if target is None and body is None:
                continue
            line = self._line(qualifier, target or "", duration=found.duration, indicator=found.indicator)
            lines.append(line)
            condition = found.condition
            if body is not None:
                line.target = self._action(wish, body, place, condition)
            elif found.value is not None:
                line.target = self._action(wish, StBody(text=f"{target} := {found.value};"), place, condition)
            elif found.negated or step.negated:
                lines.pop()
                self._drive(f"NOT {step.name}.X", target or "")
            elif condition is not None and (action := unit.pou.action(target or "")) is not None:
                line.target = self._action(wish, action.body or StBody(), place, condition)
            elif condition is not None:
                lines.pop()
                self._drive(f"{step.name}.X AND ({self._text(condition, place)})", target or "")
        return lines

    def _wrong(self, step: Step, found: ActionAssociation) -> list[str]:
        """What of an association matiec does not execute."""
        wrong: list[str] = []
        if found.qualifier not in _QUALIFIERS and found.qualifier is not Qualifier.R0:
            wrong.append(f"matiec does not execute the qualifier {found.qualifier}")
        elif found.qualifier.needs_duration and not found.duration:
            wrong.append(f"it has no time for {found.qualifier}")
        if found.event is not None:
            wrong.append(f"matiec has no event {found.event}")
        if found.interlock and step.interlock is not None and step.interlock.condition is not None:
            wrong.append("matiec has no interlock")
        if found.kind is not None or found.forcing is not None:
            wrong.append("matiec has no actions of GRAFCET")
        if found.target is None and found.body is None:
            wrong.append("it has no action")
        plainly = found.qualifier in _WHENEVER
        if not plainly and (found.negated or step.negated):
            wrong.append(f"the negation of a step with the qualifier {found.qualifier}")
        if not plainly and (found.condition is not None or found.value is not None):
            wrong.append(f"a condition or a value with the qualifier {found.qualifier}")
        if (found.negated or step.negated) and (found.body is not None or self.unit.pou.action(found.target or "")):
            wrong.append("the negation of a step with an action that has a body")
        target = found.target or ""
        if "." in target and self._is_action_of_instance(target):
            wrong.append("matiec has no actions of instances")
        return wrong

    def _is_action_of_instance(self, target: str) -> bool:
        name = target.partition(".")[0].casefold()
        kinds = [v.type for v in self.unit.pou.variables() if v.name.casefold() == name]
        return any(isinstance(k, DerivedType) and k.name.casefold() not in self.unit.types for k in kinds)

    def _line(
        self, qualifier: Qualifier, target: str, *, duration: str | None = None, indicator: str | None = None
    ) -> ActionAssociation:
        return ActionAssociation(
            id=next(self.ids), qualifier=qualifier, target=target, duration=duration, indicator=indicator or None
        )

    def _action(self, wish: str, body: Body, path: str, condition: Condition | None = None) -> str:
        """An action of the POU with this body; returns its name."""
        unit = self.unit
        if condition is not None:
            text = unit.statements(body, path)
            text = unit.nothing_right(wish) if text is None else text
            body = StBody(text=f"IF {self._text(condition, path)} THEN\n{text}\nEND_IF;")
        name = unit.new_name(wish)
        unit.pou.actions.append(Action(name=name, body=unit.fitted(body, path, wish)))
        return name

    def _text(self, condition: Condition, path: str) -> str:
        read = condition_reader(self.chart, self.unit.dialect, transitions=self.unit.pou.transitions)
        return self._condition(condition, read, path)

    def _drive(self, active: str, target: str) -> None:
        """Write `target` while `active`, and once when that ends."""
        was = self.unit.declare(f"{target}_was")
        self.logic.append(f"IF {active} THEN\n    {target} := TRUE;\nELSIF {was} THEN\n    {target} := FALSE;\nEND_IF;")
        self.logic.append(f"{was} := {active};")

    # -- actions of several steps --------------------------------------------------------------------------------------

    def _share(self) -> None:
        """Drive in every scan what associations of matiec do not drive right.

        Of several associations that drive one thing the last has its way, the start is no activation of the initial
        steps, and only a variable with a simple name can be driven.
        """
        lines: dict[tuple[str, bool], list[tuple[Step, ActionAssociation]]] = {}
        for step in self.chart.steps:
            for association in step.actions:
                key = ((association.target or "").casefold(), association.id in self.step_actions)
                lines.setdefault(key, []).append((step, association))
        for (_, is_of_step), users in lines.items():
            target = users[0][1].target or ""
            action = self.unit.pou.action(target)
            text = action.body.text if action is not None and isinstance(action.body, StBody) else None
            shared = len(users) > 1 and any(association.qualifier in _ALONE for _, association in users)
            started = any(step.initial and association.qualifier in _RISING for step, association in users)
            if any(association.indicator for _, association in users):
                continue
            if action is None and (not is_plain(target) or ((shared or started) and not self.unit.own)):
                self._drive(self._any_of(users), target)
            elif text is not None and (shared or started or self.final_scan) and not self.unit.own:
                self._execute(self._any_of(users), text, target, once_more=bool(self.final_scan) and not is_of_step)
            if text is not None and self.final_scan is False and not is_of_step:
                why = "matiec does not execute it once more after its end, which IEC 61131-3 leaves to the tool"
                self.unit.note(Outcome.APPROXIMATED, "action", f"{self.unit.path} / action {target}", why)

    def _execute(self, active: str, text: str, target: str, *, once_more: bool) -> None:
        """Execute statements while `active`, and `once_more` after that."""
        was = f" OR {self.unit.declare(f'{target}_was')}" if once_more else ""
        self.logic.append(f"IF {active}{was} THEN\n{text}\nEND_IF;")
        if was:
            self.logic.append(f"{was.removeprefix(' OR ')} := {active};")

    def _any_of(self, users: list[tuple[Step, ActionAssociation]]) -> str:
        """An expression that is TRUE while one of the associations is active; they drive something else from now on."""
        terms: list[str] = []
        stored = ""
        edges: dict[str, list[str]] = {}
        for step, association in users:
            flag = f"{step.name}.X"
            if association.qualifier in _WHENEVER:
                step.actions.remove(association)
                terms.append(flag)
            elif association.qualifier in _PULSES:
                step.actions.remove(association)
                edges.setdefault("falling" if association.qualifier is Qualifier.P0 else "rising", []).append(flag)
            elif association.qualifier in _ALONE:
                association.target = self.unit.declare(f"{step.name}_{association.target}")
                terms.append(association.target)
            else:
                stored = stored or self.unit.declare(f"{association.target}_stored")
                association.target = stored
        terms += [self._edge(kind, " OR ".join(flags), users[0][1].target or "") for kind, flags in edges.items()]
        return " OR ".join([*terms, stored] if stored else terms)

    def _edge(self, kind: str, active: str, target: str) -> str:
        """A variable that is TRUE in the scan in which an expression becomes TRUE, or FALSE."""
        edge, before = self.unit.declare(f"{target}_{kind}"), self.unit.declare(f"{target}_before")
        shown = f"({active})" if " " in active else active
        value = f"{shown} AND NOT {before}" if kind == "rising" else f"{before} AND NOT {shown}"
        self.logic += [f"{edge} := {value};", f"{before} := {active};"]
        return edge

    # -- the action of every scan --------------------------------------------------------------------------------------

    def _drawn_logic(self, read: NetworkStatements) -> None:
        unit = self.unit
        wrong = [str(problem) for problem in read.obstacles] or unit.declare_helpers(read.helpers)
        if wrong:
            unit.note(Outcome.NOT_EXECUTED, "drawn logic", unit.path, "; ".join(wrong))
            self.logic.append(unit.nothing_right("drawn logic"))
        elif read.tree.statements:
            texts = [print_node(statement, unit.dialect) for statement in read.tree.statements]
            self.logic += [text for text in texts if text not in self.logic]
            why = "statements of an action of every scan, behind the transitions: they see steps a scan earlier"
            unit.note(Outcome.APPROXIMATED, "drawn logic", unit.path, why)

    def _put_logic(self) -> None:
        """The action, stored by the steps that can be active in the first scan; actions in the order of first use.

        What the action drives is driven before bodies are executed, as other variables. The converter of Beremiz and
        OpenPLC lets the first step alone start it, behind the actions of that step.
        """
        actions = self.unit.pou.actions
        name = self._action("ChartLogic", StBody(text="\n".join(self.logic)), self.unit.path) if self.logic else ""
        used = [(a.target or "").casefold() for _, a in self.chart.associations()]
        order = {target: place for place, target in reversed(list(enumerate(used)))}
        actions.sort(key=lambda action: -1 if action.name == name else order.get(action.name.casefold(), len(order)))
        first = {step.id for step in self.chart.initial_steps}
        if self.unit.own and name:
            first = {self.chart.initial_steps[0].id}
            own = {(a.target or "").casefold() for a in self.chart.initial_steps[0].actions}
            actions.sort(key=lambda action: action.name.casefold() not in own)
        elif name:
            first |= {i for t in self.chart.transitions if set(t.sources) <= first for i in t.targets}
        for step in self.chart.steps:
            if name and step.id in first:
                step.actions.append(self._line(Qualifier.S, name))
