"""Charts as matiec executes them: what it has no words for becomes statements that are executed in every scan.

The order of a scan in the C code that matiec makes: transitions, then action associations, then the bodies of actions.
A condition in text cannot call a block. So blocks, edges and drawn outputs go into one action, which is executed in
every scan from the first on; conditions read its results of the scan before, as in the converters of Beremiz and
OpenPLC.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import count

from plcopen_sfc.formats.matiec.matiec_actions import WHENEVER, ActionFitter, StepFlagsAndTimes
from plcopen_sfc.formats.matiec.matiec_pou import FittedPou, is_taken, write_negations_out
from plcopen_sfc.formats.matiec.matiec_statements import compilable_comments
from plcopen_sfc.languages.networks import (
    NetworkExpression,
    NetworkStatements,
    chart_statements,
    condition_reader,
    kept_conditions,
)
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.words import is_plain
from plcopen_sfc.model.actions import STEP_ACTIONS, Qualifier
from plcopen_sfc.model.body import FbdBody, LdBody, StBody
from plcopen_sfc.model.conditions import Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.pou import Action
from plcopen_sfc.model.sfc import ActionAssociation, Body, Condition, SfcNetwork, Step, Transition, by_priority
from plcopen_sfc.model.types import DataType, DerivedType, Elementary, ElementaryType
from plcopen_sfc.report import Outcome

_QUALIFIERS = frozenset(
    {Qualifier.N, Qualifier.NONE, Qualifier.S, Qualifier.R, Qualifier.P, Qualifier.P0, Qualifier.P1}
    | {Qualifier.L, Qualifier.D, Qualifier.SD, Qualifier.DS, Qualifier.SL}
)


@dataclass(slots=True)
class ChartFitter:
    """Fits the chart of a POU.

    `final_scan`: the tool of the project executes an action once more after its end, as CODESYS does; False: IEC
    61131-3 leaves that to the tool; None: its tool does not. `relies`: the statements are in place of what S7-GRAPH
    or a GRAFCET has, and rely on that all the same. `logic` are the statements that every scan executes. `calls` has
    the kinds of the associations in the place of entry, main and exit actions, `in_place` the names of actions that
    have none in the source.
    """

    unit: FittedPou
    chart: SfcNetwork
    final_scan: bool | None = None
    relies: bool = False
    logic: list[str] = field(default_factory=list)
    calls: dict[int, str] = field(default_factory=dict)
    in_place: set[str] = field(default_factory=set)
    instances: dict[str, str] = field(default_factory=dict)
    ids: Iterator[int] = field(init=False)

    def __post_init__(self) -> None:
        """Give new ids to elements that are added to the chart."""
        self.ids = count(self.chart.new_id())

    def fit(self) -> None:
        """Change the chart, and the actions and variables of its POU."""
        chart = self.chart
        self._refuse_parts()
        keeps = self._keeps_drawn_logic()
        places = {step.id: place for place, step in enumerate(chart.steps)}
        chart.steps.sort(key=lambda step: not step.initial)
        self._number_competing()
        # what feeds conditions only is told by the conditions, as long as they are drawn
        drawn = None if keeps else chart_statements(chart, self.unit.dialect, taken=self.unit.used)
        self._conditions(keeps)
        for step in chart.steps:
            self._step(step)
        self._hold_initial_steps()
        rules = (self.final_scan, self.relies)
        ActionFitter(self.unit, chart, self.logic, *rules, places, self.calls, self.in_place).fit()
        self._order_actions(places)
        if drawn is not None:
            self._drawn_logic(drawn)
            chart.logic = []
        self._ends()
        if self.unit.keeps_drawings:
            StepFlagsAndTimes(self.unit, chart, self.ids, self.logic).put()
        self._put_logic()
        chart.drawing = None
        used = {t.condition.name.casefold() for t in chart.transitions if isinstance(t.condition, NamedCondition)}
        self.unit.pou.transitions = [t for t in self.unit.pou.transitions if t.name.casefold() in used]

    def _keeps_drawn_logic(self) -> bool:
        """True if wired conditions stay as they are drawn; no converter translates what is drawn besides."""
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

    # -- what matiec lacks ---------------------------------------------------------------------------------------------

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
                self.logic.append(self.unit.uncompilable(what))
        chart.partial_charts, chart.permanent_pre, chart.permanent_post = [], [], []
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
        ordered = by_priority(t for t in chart.transitions if any(competing[s] > 1 for s in t.sources))
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
        late = {} if unit.keeps_drawings or not unit.own else self._late_conditions()
        steps = {step.id: step for step in chart.steps}
        names: set[str] = set()
        for transition in chart.transitions:
            path = f"{unit.path} / transition {labels[transition.id]}"
            timed = any(steps[source].min_time for source in transition.sources if source in steps)
            if not timed and self._stays_drawn(transition.condition, keeps=keeps):
                continue
            if transition.id in late:
                text = print_node(late[transition.id])
            else:
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
        if self.final_scan:
            self._note_loops(labels)
        for step in chart.steps:
            step.min_time = None

    def _late_conditions(self) -> dict[int, n.Expression]:
        """Put the boxes before conditions into the action of every scan, as the converter of Beremiz and OpenPLC does.

        Functions go there too, and the first step alone starts the action: if that is left in the first scan, no box
        is ever executed. Returns the conditions by their transitions.
        """
        unit, chart = self.unit, self.chart
        drawn, found = kept_conditions(chart, unit.dialect, transitions=unit.pou.transitions, taken=unit.used)
        if not drawn.tree.statements:
            return {}
        # what feeds conditions only, and has no other type, is Boolean
        unit.declare_helpers(replace(helper, type_name=helper.type_name or "BOOL") for helper in drawn.helpers)
        self.logic += [print_node(statement) for statement in drawn.tree.statements]
        bodies = (t.body for t in unit.pou.transitions)
        networks = [
            chart.logic,
            *(each.nodes for b in bodies if isinstance(b, FbdBody | LdBody) for each in b.networks),
        ]
        if any(sum(isinstance(node, Block) for node in nodes) > 1 for nodes in networks):
            why = "statements follow the wires, the converter of its tool goes by the places of the blocks"
            unit.note(Outcome.APPROXIMATED, "drawn logic", unit.path, why)
        labels = chart.labels()
        for transition in chart.transitions:
            if transition.id in found:
                path = f"{unit.path} / transition {labels[transition.id]}"
                why = "an expression of what its boxes gave one scan before, as its tool does"
                unit.note(Outcome.TRANSLATED, "condition", path, why)
        return found

    def _note_loops(self, labels: Mapping[int, str]) -> None:
        """Report steps that are left and entered at once: in matiec their time starts again, in CODESYS it goes on."""
        chart, unit = self.chart, self.unit
        texts = [t.condition.text for t in chart.transitions if isinstance(t.condition, Expression)]
        texts += [action.body.text for action in unit.pou.actions if isinstance(action.body, StBody)]
        for transition in chart.transitions:
            for step in chart.steps:
                loops = step.id in transition.sources and step.id in transition.targets
                if loops and any(re.search(rf"\b{step.name}\.T\b", text, re.IGNORECASE) for text in texts):
                    why = f"the time of {step.name} starts again with it in matiec, and goes on in CODESYS"
                    path = f"{unit.path} / transition {labels[transition.id]}"
                    unit.note(Outcome.APPROXIMATED, "transition", path, why)

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
        before = [print_node(statement) for statement in found.before]
        self.logic += [text for text in before if text not in self.logic]  # a block may feed several conditions
        drawn = not isinstance(condition, Expression)
        if before and not unit.own:
            why = "its blocks are executed in every scan, behind the transitions"
            unit.note(Outcome.APPROXIMATED, "condition", path, why)
        elif drawn:
            unit.note(Outcome.TRANSLATED, "condition", path, "an expression")
        return print_node(found.tree)

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
        for kind, qualifier in STEP_ACTIONS.items():
            value = getattr(step, f"{kind}_action")
            setattr(step, f"{kind}_action", None)
            if value is not None:
                new = ActionAssociation(id=next(self.ids), qualifier=qualifier)
                if isinstance(value, str):
                    new.target = value
                else:
                    new.body = value
                unit.note(Outcome.TRANSLATED, f"{kind} action", path, f"an association with {qualifier}")
                made = self._association(step, new, f"{step.name}_{kind}", path)
                self.calls.update((line.id, kind) for line in made)
                lines += made
        for number, association in enumerate(step.actions, 1):
            lines += self._association(step, association, f"{step.name}_action_{number}", path)
        step.actions = lines
        gone = [
            ("interlock" in step.conditions, "interlock", False),
            ("supervision" in step.conditions, "supervision", True),
            (step.macro, "macro-step", True),
            (step.encloses, "enclosed charts", True),
        ]
        for present, what, changes_more in gone:
            if present:
                unit.note(Outcome.NOT_EXECUTED, what, path, f"matiec has no {what}")
                if changes_more:
                    self.logic.append(unit.uncompilable(f"{step.name}_{what}"))
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
            return [self._line(Qualifier.N, self._action(wish, StBody(text=unit.uncompilable(wish)), place))]
        qualifier = Qualifier.R if found.qualifier is Qualifier.R0 else found.qualifier
        condition = None
        if found.condition is not None:
            condition = Expression(text=self._text(found.condition, place))
        lines: list[ActionAssociation] = []
        for target, body in ((found.target, None), (None, found.body)):
            if target is None and body is None:
                continue
            line = self._line(qualifier, target or "", duration=found.duration, indicator=self._indicator(found, place))
            line.condition, line.negated = condition, found.negated is not step.negated
            lines.append(line)
            if body is not None:
                line.target = self._action(wish, body, place)
            elif self._is_instance(target or ""):
                key = (target or "").casefold()
                if key not in self.instances:
                    self.instances[key] = self._action(f"{target}_call", StBody(text=f"{target}();"), place)
                line.target = self.instances[key]
            elif found.value is not None:
                line.target = self._action(wish, StBody(text=f"{target} := {found.value};"), place)
        return lines

    def _indicator(self, found: ActionAssociation, path: str) -> str | None:
        """Return the indicator variable, which nothing executes; None where it is not declared."""
        name = found.indicator or None
        if name is not None and is_plain(name) and self._type(name) is None:
            self.unit.note(Outcome.TRANSLATED, "indicator", path, f"{name} is left out: nothing declares it")
            return None
        return name

    def _wrong(self, step: Step, found: ActionAssociation) -> list[str]:
        """Return the parts of an association that matiec does not execute."""
        wrong: list[str] = []
        if found.qualifier not in _QUALIFIERS and found.qualifier is not Qualifier.R0:
            wrong.append(f"matiec does not execute the qualifier {found.qualifier}")
        elif found.qualifier.needs_duration and not found.duration:
            wrong.append(f"it has no time for {found.qualifier}")
        if found.event is not None:
            wrong.append(f"matiec has no event {found.event}")
        if found.interlock and "interlock" in step.conditions:
            wrong.append("matiec has no interlock")
        if found.kind is not None or found.forcing is not None:
            wrong.append("matiec has no actions of GRAFCET")
        if found.target is None and found.body is None:
            wrong.append("it has no action")
        if found.value is not None and found.qualifier not in WHENEVER:
            wrong.append(f"a value with the qualifier {found.qualifier}")
        target = found.target or ""
        if self.unit.pou.find_action(target) is None and found.value is None:
            kind = self._type(target)
            if isinstance(kind, ElementaryType) and kind.name is not Elementary.BOOL:
                wrong.append(f"{target} is of type {kind.name.value}: only a Boolean variable can be an action")
        if "." in target and self._is_instance(target.partition(".")[0]):
            wrong.append("matiec has no actions of instances")
        return wrong

    def _type(self, name: str) -> DataType | None:
        kinds = [v.type for v in self.unit.pou.variables() if v.name.casefold() == name.casefold()]
        return kinds[0] if kinds else None

    def _is_instance(self, name: str) -> bool:
        """True if this is an instance of a function block, which is called as an action."""
        kind = self._type(name)
        return isinstance(kind, DerivedType) and kind.name.casefold() not in self.unit.types

    def _line(
        self, qualifier: Qualifier, target: str, *, duration: str | None = None, indicator: str | None = None
    ) -> ActionAssociation:
        return ActionAssociation(
            id=next(self.ids), qualifier=qualifier, target=target, duration=duration, indicator=indicator or None
        )

    def _action(self, wish: str, body: Body, path: str) -> str:
        """Add an action with this body to the POU; return its name."""
        name = self.unit.new_name(wish)
        self.in_place.add(name.casefold())
        self.unit.pou.actions.append(Action(name=name, body=self.unit.action(body, path, wish)))
        return name

    def _text(self, condition: Condition, path: str) -> str:
        read = condition_reader(self.chart, self.unit.dialect, transitions=self.unit.pou.transitions)
        return self._condition(condition, read, path)

    def _order_actions(self, places: Mapping[int, int]) -> None:
        """Put the actions into the order of their first use, those of exit, entry and main actions first."""
        kinds = ("exit", "entry", "main", None)
        used: list[tuple[int, int, str]] = []
        for step in self.chart.steps:
            for line in step.actions:
                used.append((kinds.index(self.calls.get(line.id)), places[step.id], (line.target or "").casefold()))
        order = {
            target: place for place, (_, _, target) in reversed(list(enumerate(sorted(used, key=lambda u: u[:2]))))
        }
        self.unit.pou.actions.sort(key=lambda action: order.get(action.name.casefold(), len(order)))

    # -- the action of every scan --------------------------------------------------------------------------------------

    def _drawn_logic(self, read: NetworkStatements) -> None:
        unit = self.unit
        wrong = [str(problem) for problem in read.obstacles] or unit.declare_helpers(read.helpers)
        if wrong:
            unit.note(Outcome.NOT_EXECUTED, "drawn logic", unit.path, "; ".join(wrong))
            self.logic.append(unit.uncompilable("drawn logic"))
        elif read.tree.statements:
            texts = [print_node(statement) for statement in read.tree.statements]
            self.logic += [text for text in texts if text not in self.logic]
            why = "statements of an action of every scan, behind the transitions: they see steps a scan earlier"
            unit.note(Outcome.APPROXIMATED, "drawn logic", unit.path, why)

    def _put_logic(self) -> None:
        """The action, stored by the steps that can be active in the first scan; actions in the order of first use.

        Variables of the action are written before bodies are executed, as other variables. The converter of Beremiz and
        OpenPLC lets the first step alone start it, behind the actions of that step.
        """
        actions = self.unit.pou.actions
        name = self._action("ChartLogic", StBody(text="\n".join(self.logic)), self.unit.path) if self.logic else ""
        actions.sort(key=lambda action: action.name != name)
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
