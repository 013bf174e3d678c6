"""GRAFCETs as sequential function charts of IEC 61131-3, as far as these have words for them.

Hierarchy becomes transitions of one chart (`grafcet_hierarchy`), which begins with a step of its own where the tool
knows one initial step. Stored actions become S and R, or P1 and P0; conditional ones an action that all steps with this
output share; delays D and L; ``X3`` the flag of the step, ``3s/X3`` its time. Edges need a memory, which is kept by an
action that every scan executes, or by a permanent instruction. What has no counterpart is left as it is, and reported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple, TypeAlias

from plcopen_sfc.conversion.adaptation.grafcet_hierarchy import (
    FlatChart,
    HierarchyError,
    Rules,
    step_flag,
)
from plcopen_sfc.conversion.adaptation.grafcet_scans import (
    Evolutions,
    first_names,
    in_one_action,
    stored_names,
    stored_text,
    written_in_place,
)
from plcopen_sfc.conversion.adaptation.grafcet_terms import (
    EventEvolution,
    GrafcetTexts,
    MissingTermError,
    Note,
    TextTerms,
    shown_edge,
)
from plcopen_sfc.conversion.executed_parts import FIRST_SCAN, SELECTION, STABILITY, START
from plcopen_sfc.errors import ForcingConflictError, SfcError, UnknownBehaviourError
from plcopen_sfc.languages.grafcet_conditions import ConditionError, to_structured_text
from plcopen_sfc.languages.networks import declared_rules, draw_ld
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, print_node, transform, walk
from plcopen_sfc.lowering.code.boolean_logic import FALSE, conjunction, simplified
from plcopen_sfc.lowering.reading.text_reading import ActionTargets
from plcopen_sfc.model import sfc
from plcopen_sfc.model.actions import ActionEvent, ActionKind, ForcedSituation, Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import Elementary, ElementaryType
from plcopen_sfc.report import ORDER_OF_ACTIONS, Outcome
from plcopen_sfc.semantics.charts.grafcet.term_evaluation import rising
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import Profile, ScanOrder

_CONTINUOUS = frozenset({ActionKind.CONTINUOUS, ActionKind.CONDITIONAL, ActionKind.DELAYED, ActionKind.LIMITED})
_BOOL = ElementaryType(name=Elementary.BOOL)
_Use: TypeAlias = tuple[sfc.Step, sfc.ActionAssociation]
_COMPARED = {ActionKind.DELAYED: ">=", ActionKind.LIMITED: "<"}
_TRUE = ("TRUE", "1")
_CONSTANTS = {None: "TRUE", "TRUE": "TRUE", "1": "TRUE", "FALSE": "FALSE", "0": "FALSE"}


def put_into_sfc(project: Project, note: Note, target: Profile) -> None:
    """Change the charts of `project` into what a tool with the profile `target` executes."""
    for pou in project.pous:
        chart = pou.chart
        if chart is not None:
            _Chart(project, pou, chart, note, target).run()


def _has_hierarchy(chart: sfc.SfcNetwork) -> bool:
    forces = any(each.forcing is not None for _, each in chart.associations())
    return forces or bool(chart.partial_charts) or any(step.macro or step.encloses for step in chart.steps)


def _forced_steps(chart: sfc.SfcNetwork) -> set[str]:
    """Return the names that the steps to which forcing orders lead have in the target."""
    charts = {each.name: each.chart for each in chart.partial_charts}
    orders = [each.forcing for part in charts.values() for _, each in part.associations() if each.forcing is not None]
    names = {name for order in orders if order.situation is ForcedSituation.EXPLICIT for name in order.steps}
    for order in orders:
        if order.situation is ForcedSituation.INITIAL and order.chart in charts:
            names |= {step.name for step in charts[order.chart].initial_steps}
    return {f"Step{name}" if name.isdecimal() else name for name in names}


class _Ruling(NamedTuple):
    """An order or an enclosing step, by its path; what is `missing` without it, and the `chart` that it rules."""

    what: str
    path: str
    missing: str
    chart: str


class _Chart:
    def __init__(self, project: Project, pou: Pou, chart: sfc.SfcNetwork, note: Note, target: Profile) -> None:
        self._project, self._pou = project, pou
        self._chart = chart
        self._note = note
        self._of_graph = target.graph_parameters
        self._actions_first = target.order is ScanOrder.ACTIONS_FIRST
        self._terms = GrafcetTexts(project, pou, chart, note, target)
        self._events: list[str] = []
        self._second_events: list[str] = []
        self._forced: set[str] = set()
        self._ruling: list[_Ruling] = []
        self._misfits: dict[int, str] = {}
        self._refused: set[int] = set()
        self._stores: dict[tuple[int, Qualifier], StBody] = {}
        self._begun: list[str] = []
        self._deactivations: list[str] = []
        self._activations: list[str] = []

    def run(self) -> None:
        """Change the chart."""
        path = f"POU {self._pou.name}"
        flat: FlatChart | None = None
        if _has_hierarchy(self._chart):
            self._forced = _forced_steps(self._chart)
            self._ruling = [*self._orders_and_enclosures(path)]
            try:
                flat = self._flatten(path)
            except (UnknownBehaviourError, ForcingConflictError) as error:
                place, why = self._place_of(error, path), f"the hierarchy is broken: {error.message}"
                self._note(Outcome.NOT_EXECUTED, "hierarchy", place, why)
            except HierarchyError as error:
                self._refuse_hierarchy(path, error)
        self._terms.steps = {step.name.casefold(): step for step in self._chart.steps}
        self._misfits = {id(each): why for _, each in self._chart.associations() if (why := self._misfit(each))}
        self._name_steps(path)
        edged = set()
        for transition in self._chart.transitions:
            place = f"{path} / transition {self._chart.label(transition)}"
            terms = TextTerms(self._terms, transition.sources)
            transition.condition = self._read(transition.condition, place, terms)
            if terms.has_edge:
                edged.add(transition.id)
        self._note_evolutions(path, flat)
        self._actions(path, flat.activated() if flat is not None else set())
        if flat is not None and flat.ruled:
            refused = Rules(self._chart, flat, edged, self._terms.new_name).apply()
            if len(refused) < len(flat.ruled):
                why = "transitions that are tried before those of the charts that it rules"
                self._note(Outcome.TRANSLATED, "hierarchy", path, why)
            for name, why_not in refused.items():
                self._refuse_hierarchy(path, why_not, name)
        starts = [step for step in self._chart.steps if step.initial]
        self._keep_memories(path, starts)
        if self._of_graph:
            self._sequences()
        elif len(starts) > 1:
            self._start(starts, path)

    def _name_steps(self, path: str) -> None:
        """Give steps names that are theirs alone: ``S2``, the last step of an expansion, may be a button, too."""
        taken = {each.name.casefold() for each in self._pou.variables()}
        for step in self._chart.steps:
            why = ""
            if step.name.isdecimal():
                step.number, why = int(step.name), "a name begins with no digit"
                wish = f"Step{step.name}"
                is_free = wish.casefold() not in taken | self._terms.steps.keys()
                step.name = wish if is_free else self._terms.new_name(wish)
            elif step.name.casefold() in taken:
                why = f"a variable is called {step.name}, too"
                step.name = self._terms.new_name(f"Step_{step.name}")
            if why:
                self._note(Outcome.TRANSLATED, "step name", f"{path} / step {step.name}", why)

    def _place_of(self, error: SfcError, path: str) -> str:
        """Return the place of the step that an error about the hierarchy names; `path` where it names none."""
        net = Net.of(self._chart)
        named = (error.location.path or "") if error.location is not None else ""
        steps = zip(net.steps, net.report_paths(path)[0], strict=True)
        return next((at for step, at in steps if named.endswith(f" / step {step.path}")), path)

    def _refuse_hierarchy(self, path: str, error: HierarchyError, chart: str | None = None) -> None:
        """Note what is not executed of the orders to a chart and of the steps that enclose it; None: of all."""
        why = f"{error}: lower the GRAFCET, which makes proven code of all of it"
        self._note(Outcome.NOT_EXECUTED, "hierarchy", path, why)
        for each in self._ruling:
            if chart is None or each.chart.casefold() == chart.casefold():
                why = f"the hierarchy is not executed: {each.missing}"
                self._note(Outcome.NOT_EXECUTED, each.what, each.path, why)

    def _orders_and_enclosures(self, path: str) -> Iterator[_Ruling]:
        """Yield the forcing orders and enclosing steps of all charts."""
        net = Net.of(self._chart)
        for step, place in zip((each.step for each in net.steps), net.report_paths(path)[0], strict=True):
            for order in (each.forcing for each in step.actions if each.forcing is not None):
                yield _Ruling(
                    "forcing order", f"{place} / action {order}", f"nothing forces {order.chart}", order.chart
                )
            for enclosure in step.encloses or ():
                yield _Ruling("enclosing step", place, f"nothing starts {enclosure.chart}", enclosure.chart)

    def _note_evolutions(self, path: str, flat: FlatChart | None) -> None:
        """Tell what a GRAFCET does in one scan that the target does not, which fires transitions once."""
        once = "the target fires transitions once in a scan, code of `lower` until none can fire"
        lately = stored_names(self._chart)
        steps = {step.name for step in self._chart.steps}
        for (operand, rises), edge in self._terms.edges.items():
            trees = [parse_expression(text).tree for text in (operand, edge)]
            names, memories = (first_names(tree) if tree is not None else [] for tree in trees)
            if not lately.isdisjoint(map(str.casefold, names)) or self._terms.steps_in(operand, rising=rises):
                lately |= {name.casefold() for name in memories if name not in steps}
        evolutions = Evolutions(self._chart, self._terms.over, lately)
        passed = list(evolutions.passed(flat.freed(self._chart) if flat is not None else {}))
        late = [self._chart.label(transition) for transition in evolutions.late()]
        if passed:
            acting = {each.target: None for step in passed for each in step.actions if each.kind in _CONTINUOUS}
            outputs = [each for each in acting if each]
            writing = f", and drive {_first_of(outputs)} there" if outputs else ""
            which = f"{_first_of([step.name for step in passed])} may be active where a GRAFCET only passes"
            self._note(Outcome.APPROXIMATED, STABILITY, path, f"{once}: {which}{writing}")
        if late:
            why = f"{once}: {_first_of(late)} may fire a scan later, for flags and stored variables are read"
            self._note(Outcome.APPROXIMATED, STABILITY, path, why)
        if not passed and not late:
            why = f"{once}: here none can fire behind another one with the same inputs"
            self._note(Outcome.TRANSLATED, STABILITY, path, why)
        if together := [step.name for step in evolutions.left_together()]:
            why = f"the target fires one of the transitions behind {_first_of(together)}, a GRAFCET all that are TRUE"
            self._note(Outcome.APPROXIMATED, SELECTION, path, why)

    def _note_first_scan(self, path: str, ordered: set[int]) -> None:
        """Tell what the target misses that a GRAFCET does in its first scan. `ordered`: actions that miss nothing."""
        starts = [step for step in self._chart.steps if step.initial]
        acting = [each for each in starts[0].actions if id(each) not in ordered] if starts else []
        if self._of_graph:
            why = "S7-GRAPH tests no transition in its first scan: what is TRUE in that scan only is missed"
            self._note(Outcome.APPROXIMATED, FIRST_SCAN, path, why)
        elif not self._actions_first and len(starts) == 1 and any(map(self._is_missed, acting)):
            why = f"where it leaves {starts[0].name}, stored actions miss it: they have not seen the step"
            self._note(Outcome.APPROXIMATED, FIRST_SCAN, path, why)

    def _is_missed(self, each: sfc.ActionAssociation) -> bool:
        """True if an action of the initial step changes something when that is left at once."""
        if each.kind is ActionKind.ON_ACTIVATION and each.value in ("FALSE", "0"):
            initial = {variable.name.casefold(): variable.initial for variable in self._pou.variables()}
            return initial.get((each.target or "").casefold()) is not None  # else it is so from the start
        return each.kind in (ActionKind.ON_ACTIVATION, ActionKind.ON_DEACTIVATION)

    def _flatten(self, path: str) -> FlatChart:
        """Put all partial charts on one level."""
        flat = FlatChart(self._chart, self._pou.name)
        names = [partial.name for partial in self._chart.partial_charts]
        flat.put_into(self._chart)
        self._terms.groups = {name: [flat.steps[i] for i in steps] for name, steps in flat.groups.items()}
        for name in names:
            self._note(Outcome.TRANSLATED, "partial chart", f"{path} / {name}", "its steps are in the one chart")
        return flat

    def _start(self, starts: list[sfc.Step], path: str) -> None:
        """Let a chart with several initial steps begin with one that leads to them all."""
        first = self._chart.add_step(self._terms.new_name("Start"), initial=True)
        self._chart.steps.insert(0, self._chart.steps.pop())
        for step in starts:
            step.initial = False
        self._chart.add_transition(first, starts, Expression(text="TRUE"))
        why = "it leads to all initial steps: charts of the target have one, and the first scan passes with it"
        self._note(Outcome.APPROXIMATED, START, f"{path} / step {first.name}", why)

    def _sequences(self) -> None:
        parts = sfc.connected_parts(self._chart.steps, self._chart.transitions)
        if len(parts) > 1 and not self._chart.sequences:
            self._chart.sequences = [sfc.Sequence(steps=[step.id for step in steps]) for steps in parts]

    def _keep_memories(self, path: str, starts: Sequence[sfc.Step]) -> None:
        """Let every scan keep what edges need: before the transitions, or behind all of them."""
        first = [*self._terms.times, *self._events, *self._in_order(), *self._second_events]
        if not self._terms.memories and not self._terms.times and not first:
            return
        flags = {step.id: print_node(step_flag(step)) for step in self._chart.steps}
        last = [f"{name} := {flags[step]};" for step, name in self._terms.was_active.items()]
        if self._of_graph:  # the sequences see these edges, and events the steps that were active before
            self._chart.permanent_pre.append(self._drawn("\n".join([*self._terms.memories, *self._events])))
            why = "a permanent instruction before the sequences"
        else:
            name = self._new_action("A_edges", StBody(text="\n".join([*first, *self._terms.memories, *last])))
            # an event of a step comes before what its deactivation and the next activation store
            self._pou.actions.insert(0, self._pou.actions.pop())
            # of the first scan those steps are active that it begins with, or those that follow them
            follow = {i for t in self._chart.transitions if {s.id for s in starts} & {*t.sources} for i in t.targets}
            for step in self._chart.steps:
                if step.initial or (step.id in follow and not self._actions_first and len(starts) == 1):
                    added = sfc.ActionAssociation(id=self._chart.new_id(), qualifier=Qualifier.S, target=name)
                    step.actions.insert(0, added)
            why = f"the action {name}, which is executed in every scan"
        for operand, rises in self._terms.edges:
            self._note(Outcome.TRANSLATED, "edge", f"{path} / {shown_edge(operand, rising=rises)}", why)

    def _drawn(self, text: str) -> sfc.PermanentOperation:
        drawn = draw_ld(parse_statements(text).tree.statements, declared_rules(self._pou.variables()))
        return sfc.PermanentOperation(body=drawn.body)

    # -- conditions

    def _read(self, condition: sfc.Condition | None, place: str, terms: TextTerms) -> sfc.Condition | None:
        if not isinstance(condition, Expression):
            return condition
        try:
            return Expression(text=self._terms.text(condition.text, terms), negated=condition.negated)
        except (ConditionError, MissingTermError) as error:
            self._note(Outcome.NOT_EXECUTED, "condition", place, _why(error))
            return condition

    # -- actions

    def _actions(self, path: str, by_rules: set[int]) -> None:
        """Rewrite all actions. Those of several steps that write one variable decide about it together.

        A continuous action is FALSE where its step is inactive, so each row would switch off what another one holds.
        `by_rules`: the ids of steps that orders and enclosing steps activate.
        """
        conditional: dict[str, list[_Use]] = {}
        timed: dict[str, list[_Use]] = {}
        stored: dict[str, list[sfc.ActionAssociation]] = {}
        for step, each in self._chart.associations():
            if each.target is not None and each.kind in (ActionKind.CONTINUOUS, ActionKind.CONDITIONAL):
                conditional.setdefault(each.target.casefold(), []).append((step, each))
            elif each.target is not None and each.kind in (ActionKind.DELAYED, ActionKind.LIMITED):
                timed.setdefault(each.target.casefold(), []).append((step, each))
            elif each.target is not None and each.kind is not None:
                stored.setdefault(each.target.casefold(), []).append(each)
        numbers = self._terms.numbers | {each.name.casefold() for each in self._pou.variables() if each.type != _BOOL}
        numbers |= written_in_place(self._chart)  # a coil would hold it against the statements
        constants = {name for name, each in stored.items() if name not in numbers and all(map(_is_constant, each))}
        ordered = self._ordered(path, by_rules, constants)
        self._note_first_scan(path, ordered)
        for target, uses in timed.items():
            # one that has a condition in another step gets an action that assigns it, which would overwrite the delay
            is_assigned = any(each.kind is ActionKind.CONDITIONAL for _, each in conditional.get(target, ()))
            if target not in stored and _are_plain(uses) and (is_assigned or self._share_a_time(uses)):
                self._share([*conditional.pop(target, []), *uses], path)
        alone = conditional.keys() - stored.keys() - timed.keys()
        for target, uses in conditional.items():
            if any(each.kind is ActionKind.CONDITIONAL for _, each in uses):
                if self._of_graph and not (target in alone and self._have_other_interlocks(uses)):
                    self._interlock(uses, path)
                else:
                    self._share(uses, path)
        for step, each in list(self._chart.associations()):
            place = f"{path} / step {step.name} / action {each.target or 'in place'}"
            if problem := _problem_of(each):
                self._note(Outcome.NOT_EXECUTED, "action", place, f"what it does cannot be read: {problem}")
            elif id(each) in self._misfits:
                self._note(Outcome.NOT_EXECUTED, "action", place, f"no tool compiles it: {self._misfits[id(each)]}")
            elif each.kind is not ActionKind.ON_EVENT:
                self._put_flags(each, self._terms.flag)
            if each.forcing is not None:
                self._note(Outcome.NOT_EXECUTED, "forcing order", place, "it has no counterpart in this chart")
            elif each.kind in _CONTINUOUS and id(each) not in self._refused:
                self._continuous(each, place)
            elif each.kind is ActionKind.ON_EVENT:
                self._on_event(step, each, place)
            elif id(each) in ordered:
                self._store_in_order(step, each, place)
            elif each.kind is not None and each.kind not in _CONTINUOUS:
                constant = (each.target or "").casefold() in constants
                self._store(step, each, place, constant=constant and each.body is None)

    def _misfit(self, each: sfc.ActionAssociation) -> str:
        """Return why no tool compiles what an action stores; empty where that is not known."""
        targets = ActionTargets(self._pou, self._project, Dialect.IEC)
        tree = parse_statements(stored_text(each)).tree
        written = [first_names(node.target)[:1] for node in walk(tree) if isinstance(node, n.Assignment)]
        for name in (name for names in written for name in names):
            if self._terms.step_of(name) is not None and not self._terms.is_known(name):
                return f"{name} is the flag of a step, which only transitions change"
        statements = tree.statements if each.kind not in _CONTINUOUS else ()
        return next((why for statement in statements for why in targets.mistakes(statement)), "")

    def _put_flags(self, each: sfc.ActionAssociation, flag: Callable[[n.Node], n.Node]) -> None:
        """Put the flags of steps, as the tool has them, into what an action stores."""
        if each.value is not None:
            each.value = self._terms.flagged(each.value, flag)
        if isinstance(each.body, StBody):
            tree = parse_statements(each.body.text).tree
            flagged = transform(tree, flag)
            if flagged != tree:
                each.body = StBody(text=print_node(flagged))

    def _share_a_time(self, uses: list[_Use]) -> bool:
        """True if delayed or limited actions of several steps have one time in a tool, which goes on from step to step.

        In a GRAFCET each has its own. It is the same where the steps never follow each other, nor are active together.
        """
        return any(self._overlap([use for use in uses if use[1].kind is kind]) for kind in _COMPARED)

    def _overlap(self, uses: list[_Use]) -> bool:
        if len(uses) < 2:
            return False
        steps = {step.id for step, _ in uses}
        follow = any(steps & {*t.sources} and steps & {*t.targets} for t in self._chart.transitions)
        follow |= any(step.name in self._forced for step, _ in uses)
        connected = sfc.connected_parts(self._chart.steps, self._chart.transitions)
        parts = [part for each in connected if steps & (part := {step.id for step in each})]
        branched = any(len(t.targets) > 1 and parts[0] & {*t.targets} for t in self._chart.transitions)
        return follow or branched or len(parts) > 1 or len({each.duration for _, each in uses}) > 1

    def _share(self, uses: list[_Use], path: str) -> None:
        """Give all uses of an output one action, which assigns it in every scan and in the one behind the last.

        In S7-GRAPH it is a permanent instruction, behind the sequences: a step has one interlock for all its rows.
        """
        target = uses[0][1].target or ""
        parts = []
        for step, each in uses:
            flag = f"{step.name}.X"
            if each.kind in _COMPARED:
                flag += f" AND {step.name}.T {_COMPARED[each.kind]} {each.duration}"
            if isinstance(each.condition, Expression):
                try:
                    flag += f" AND ({self._terms.text(each.condition.text, TextTerms(self._terms, in_action=True))})"
                except (ConditionError, MissingTermError) as error:
                    place = f"{path} / step {step.name} / action {target}"
                    self._note(Outcome.NOT_EXECUTED, "condition", place, _why(error))
            parts.append(flag)
        text = f"{target} := {' OR '.join(parts)};"
        if self._of_graph:
            self._chart.permanent_post.append(self._drawn(text))
            for step, each in uses:
                step.actions.remove(each)
                why = f"a permanent instruction assigns {target}: the interlock of the step is that of another action"
                self._note(Outcome.TRANSLATED, "action", f"{path} / step {step.name} / action {target}", why)
            return
        name = self._new_action(f"Assign_{target}", StBody(text=text))
        for step, each in uses:
            each.target, each.kind, each.condition, each.duration = name, ActionKind.CONTINUOUS, None, None
            why = f"the action {name} assigns {target} in all steps that drive it"
            self._note(Outcome.TRANSLATED, "action", f"{path} / step {step.name} / action {target}", why)

    def _have_other_interlocks(self, uses: list[_Use]) -> bool:
        """True if the condition of a use cannot be the interlock of its step, which has another one."""
        wanted = {id(step): step.interlock for step, _ in uses if step.interlock is not None}
        conditional = [(step, each.condition) for step, each in uses if isinstance(each.condition, Expression)]
        try:
            found = [(step, self._as_interlock(condition)) for step, condition in conditional]
        except (ConditionError, MissingTermError):
            return False  # it is told for each of them
        return any(wanted.setdefault(id(step), interlock) != interlock for step, interlock in found)

    def _as_interlock(self, condition: Expression) -> sfc.Supervised:
        return sfc.Supervised(
            condition=Expression(text=self._terms.text(condition.text, TextTerms(self._terms, in_action=True)))
        )

    def _interlock(self, uses: list[_Use], path: str) -> None:
        """Make the condition of an action the interlock of its step, unless that has another one."""
        for step, each in uses:
            if not isinstance(each.condition, Expression):
                continue
            place = f"{path} / step {step.name} / action {each.target}"
            try:
                wanted = self._as_interlock(each.condition)
            except (ConditionError, MissingTermError) as error:
                self._note(Outcome.NOT_EXECUTED, "condition", place, _why(error))
                self._refused.add(id(each))
                continue
            if step.interlock not in (None, wanted):
                why = f"and {each.target} is stored or delayed, too: let a step do one of it"
                why = f"the interlock of the step is that of another action, {why}"
                self._note(Outcome.NOT_EXECUTED, "condition", place, why)
                continue
            step.interlock, each.interlock = wanted, True
            each.kind, each.condition = ActionKind.CONTINUOUS, None
            self._note(Outcome.TRANSLATED, "action", place, "its condition is the interlock of the step")

    def _continuous(self, each: sfc.ActionAssociation, place: str) -> None:
        if each.condition is not None or each.value not in (None, *_TRUE):
            why = f"{each.kind} with a condition has no qualifier: lower the GRAFCET, which makes proven code of it"
            self._note(Outcome.NOT_EXECUTED, "action", place, why)
            return
        qualifiers = {ActionKind.DELAYED: Qualifier.D, ActionKind.LIMITED: Qualifier.L}
        each.qualifier = qualifiers.get(each.kind or ActionKind.CONTINUOUS, Qualifier.N)
        each.kind = each.value = None

    def _store(self, step: sfc.Step, each: sfc.ActionAssociation, place: str, *, constant: bool) -> None:
        kind = each.kind.words if each.kind is not None else ""
        if constant and each.kind is ActionKind.ON_ACTIVATION:
            each.qualifier = Qualifier.S if _CONSTANTS[each.value] == "TRUE" else Qualifier.R
            self._note(
                Outcome.TRANSLATED, "action", place, f"on activation is {each.qualifier}: it stays so till it is reset"
            )
        elif self._of_graph and each.target is not None:
            each.event = ActionEvent.S1 if each.kind is ActionKind.ON_ACTIVATION else ActionEvent.S0
            self._note(Outcome.TRANSLATED, "action", place, f"{kind} is the event {each.event}")
            each.kind, each.value = None, each.value or "TRUE"
            return
        else:
            self._store_by_action(step, each, place, kind)
            return
        each.kind = each.value = None

    def _store_by_action(self, step: sfc.Step, each: sfc.ActionAssociation, place: str, kind: str) -> None:
        """Let an action of the POU execute what is stored: once as the step begins, or as it ends."""
        text = stored_text(each)
        qualifier = Qualifier.P1 if each.kind is ActionKind.ON_ACTIVATION else Qualifier.P0
        is_entry = qualifier is Qualifier.P1
        where = f"the {'entry' if is_entry else 'exit'} action of the step"
        where = where if self._actions_first else f"{qualifier} with an action"
        self._note(Outcome.TRANSLATED, "action", place, f"{kind} is {where}")
        first = self._stores.get((step.id, qualifier))
        if first is not None:  # a step has one entry action and one exit action in CODESYS
            first.text += f"\n{text}"
            step.actions.remove(each)
            return
        body = self._stores[step.id, qualifier] = StBody(text=text)
        name = self._new_action(f"{step.name}_{each.target or 'stores'}_{qualifier}", body)
        if self._actions_first:
            step.actions.remove(each)
            if is_entry:
                step.entry_action = name
            else:
                step.exit_action = name
            return
        each.target, each.body, each.kind, each.value = name, None, None, None
        if self._of_graph:  # which has no P1
            each.event = ActionEvent.S1 if is_entry else ActionEvent.S0
        else:
            each.qualifier = qualifier

    def _ordered(self, path: str, by_rules: set[int], constants: set[str]) -> set[int]:
        """Return the stored actions (ids of objects) that one action executes, for the order of a GRAFCET."""
        if self._of_graph or self._actions_first:
            return set()
        found, is_possible = in_one_action(self._chart, by_rules, constants)
        if is_possible:
            return {id(each) for each in found}
        why = "what a step stores when it is left may be executed behind what the next one stores on activation"
        self._note(Outcome.APPROXIMATED, ORDER_OF_ACTIONS, path, f"{why}, a GRAFCET executes it before")
        return set()

    def _store_in_order(self, step: sfc.Step, each: sfc.ActionAssociation, place: str) -> None:
        """Let the action that keeps the edges execute a stored action, where its order matters."""
        before, now, text = self._terms.activity_before(step), print_node(step_flag(step)), stored_text(each)
        if each.kind is ActionKind.ON_DEACTIVATION:
            self._deactivations.append(f"IF {before} AND NOT {now} THEN\n    {text}\nEND_IF;")
        else:
            self._activations.append(f"IF {now} AND NOT {before} THEN\n    {text}\nEND_IF;")
            if step.initial:
                self._begun.append(f"    {text}")
        step.actions.remove(each)
        why = "a statement of an action that every scan executes: what is stored on deactivation comes first there"
        self._note(Outcome.TRANSLATED, "action", place, why)

    def _in_order(self) -> list[str]:
        """Return the statements of stored actions whose order matters."""
        first = []
        if self._begun:
            started = self._terms.new_variable("started")
            first = [f"IF NOT {started} THEN", f"    {started} := TRUE;", *self._begun, "END_IF;"]
        return [*first, *self._deactivations, *self._activations]

    def _on_event(self, step: sfc.Step, each: sfc.ActionAssociation, place: str) -> None:
        """Let the action that keeps the edges execute an action on an event.

        The step must have been active before the transitions of the scan: actions that are executed first see it so
        one scan later, together with the edge.
        """
        happens = rising(each.condition) if each.condition is not None else None
        two = not (self._of_graph or self._actions_first)
        is_of_flags = is_of_time = False
        statements: dict[EventEvolution | None, list[str]] = {}
        try:
            if not isinstance(happens, Expression):
                raise MissingTermError("it has no event")
            for event in EventEvolution if two else (None,):
                terms = TextTerms(self._terms, event=event)
                text = to_structured_text(happens.text, terms)
                statements[event] = self._at_event(step, each, text, event)
                is_of_flags |= terms.has_edge_of_step
                is_of_time |= terms.has_edge_of_time
        except (ConditionError, MissingTermError) as error:
            self._note(Outcome.NOT_EXECUTED, "action", place, _why(error))
            return
        if is_of_flags and not two:
            why = "the target fires transitions once in a scan: an edge of a flag comes with the scan behind its step"
            self._note(Outcome.APPROXIMATED, STABILITY, place, why)
        if is_of_time and not two:
            why = "its action sees the time of a step one scan later: where the step is left then, the event is missed"
            self._note(Outcome.APPROXIMATED, "time", place, why)
        for event, lines in statements.items():
            (self._second_events if event is EventEvolution.SECOND else self._events).extend(lines)
        step.actions.remove(each)
        where = "permanent instruction" if self._of_graph else "action"
        self._note(Outcome.TRANSLATED, "action", place, f"a statement of the {where} that keeps the edges")

    def _at_event(
        self, step: sfc.Step, each: sfc.ActionAssociation, text: str, event: EventEvolution | None
    ) -> list[str]:
        """Return the statements for an event that comes in one evolution of the scan."""
        is_now = self._of_graph or event is EventEvolution.SECOND
        flag = self._terms.flag if is_now else self._terms.flag_before
        edge = parse_expression(self._terms.flagged(text, flag)).tree
        edge = simplified(edge) if edge is not None and event is not None else edge
        if edge is None or edge == FALSE:
            return []
        active = [step_flag(step)] if is_now else []
        if not self._of_graph:
            active.append(n.Name(self._terms.activity_before(step)))
        if self._actions_first and not set(first_names(edge)) <= {*self._terms.edges.values()}:
            # the event is one of the scan before, and so is all that it asks for
            edge = n.Name(self._terms.new_variable(f"{step.name}_event"))
            self._terms.memories.append(f"{edge.identifier} := {self._terms.flagged(text)};")
        when = conjunction([*active, edge])
        statements = []
        operators = {node.operator for node in walk(when) if isinstance(node, n.Operation)}
        if self._of_graph and n.Operator.OR in operators:
            # a drawn IF is read as one branch for each of its ways
            name = self._terms.new_variable(f"{step.name}_event")
            statements.append(f"{name} := {print_node(when)};")
            when = n.Name(name)
        done = each.model_copy()
        self._put_flags(done, flag)
        lines = self._drawable(stored_text(done)) if self._of_graph else [stored_text(done)]
        return [*statements, *(f"IF {print_node(when)} THEN\n    {line}\nEND_IF;" for line in lines)]

    def _drawable(self, text: str) -> list[str]:
        """Return the assignments of a text, which is drawn with a condition before each."""
        statements = parse_statements(text).tree.statements
        if not all(isinstance(each, n.Assignment) for each in statements):
            raise MissingTermError("a permanent instruction of S7-GRAPH is drawn, and has boxes for assignments only")
        return [print_node(each) for each in statements]

    def _new_action(self, wanted: str, body: StBody) -> str:
        name = self._terms.new_name(wanted)
        self._pou.actions.append(Action(name=name, body=body))
        return name


def _why(error: ConditionError | MissingTermError) -> str:
    return f"the condition cannot be read: {error}" if isinstance(error, ConditionError) else str(error)


def _are_plain(uses: list[_Use]) -> bool:
    """True for actions without conditions that switch a variable on."""
    return all(each.condition is None and each.value in (None, *_TRUE) for _, each in uses)


def _problem_of(each: sfc.ActionAssociation) -> str:
    """Return why the value or the statements of an action cannot be read; empty where they can."""
    value = parse_expression(each.value).problems if each.value else ()
    body = parse_statements(each.body.text).problems if isinstance(each.body, StBody) else ()
    return next((problem.message for problem in (*value, *body)), "")


def _is_constant(each: sfc.ActionAssociation) -> bool:
    return each.kind is ActionKind.ON_ACTIVATION and each.value in _CONSTANTS and each.body is None


def _first_of(names: list[str]) -> str:
    return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")
