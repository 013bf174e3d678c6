"""The rules for charts of other tools: what a target has no element for becomes statements and conditions.

A thing without a replacement is left out and reported as not executed. The source is kept beside what was written
(`source_marks`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from plcopen_sfc.conversion.adaptation.chart_rewriting import (
    ChartRewriting,
    as_term,
    conjunction,
    flags_in_use,
    guarded,
    is_network,
    is_supervised,
    taken_names,
)
from plcopen_sfc.conversion.adaptation.flags_in_tc6 import execute_flags_in_tc6
from plcopen_sfc.conversion.adaptation.operating_inputs import OperatingModes
from plcopen_sfc.conversion.adaptation.passed_steps import SkipRewriter
from plcopen_sfc.conversion.adaptation.sequence_loops import SequenceRewriter, steps_to_start, undrawable
from plcopen_sfc.conversion.adaptation.sequencer_rewriting import PermanentRewriter, ShownState
from plcopen_sfc.conversion.adaptation.special_rows import is_special, shared_step_actions, stays_in_place
from plcopen_sfc.conversion.adaptation.step_checks import ACKNOWLEDGING, StepChecks
from plcopen_sfc.conversion.adaptation.step_rewriting import StepRewriter
from plcopen_sfc.conversion.executed_parts import OPERATING_INPUT, told_flag
from plcopen_sfc.formats.format_interface import ChartHost, WriteOptions
from plcopen_sfc.formats.plcopen.source_marks import (
    REWRITTEN_FIELD,
    SourceMarks,
    drawing_mark,
    rewritten_transition,
)
from plcopen_sfc.languages.binding import STORING, Names, Row, SharedScans, told_orders
from plcopen_sfc.languages.networks import (
    chart_statements,
    feeding_nodes,
    is_empty_network,
    kept_conditions,
)
from plcopen_sfc.languages.sfc_flag_uses import flags_at_rest, named_flags
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, transform
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody, has_program
from plcopen_sfc.model.chart_settings import WATCHING_FLAGS, FlagUse, SfcFlag, SfcSettings
from plcopen_sfc.model.conditions import Expression, WiredCondition
from plcopen_sfc.model.network import Node
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import BodyCondition, Condition, Step, Transition, by_priority
from plcopen_sfc.report import ORDER_OF_ACTIONS, Cause, CauseKind, ConversionReport, Outcome


def needs_rewriting(place: Chart, host: ChartHost, options: WriteOptions) -> bool:
    """True if `rewrite_charts` would change a chart, or report something of it."""
    chart = place.chart
    if options.of_graph or chart.graph_settings is not None:
        return True
    if any(is_special(row) for _, row in chart.associations()):
        return True
    if any(is_supervised(step) for step in chart.steps):
        return True
    if steps_to_start(chart, host, options) or undrawable(chart, host, options):
        return True
    if any(has_program(operation.body) for operation in chart.permanent):
        return True
    if any(row.qualifier is Qualifier.R0 for _, row in chart.associations()):
        return True
    excluded = any(s.exclude for s in chart.steps) or any(t.exclude for t in chart.transitions)
    if not host.excludes and (excluded or any(row.exclude for _, row in chart.associations())):
        return True
    if host.is_codesys:
        bodies: list[object] = [row.body for _, row in chart.associations()]
        bodies += [action for s in chart.steps for action in (s.entry_action, s.exit_action)]
        bodies += [s.main_action for s in chart.steps if not stays_in_place(s.main_action, host)]
        own = ("P1", "P0", "DL") if options.final_scan else ("P1", "P0", "DL", "P", "N", "None")
        rows = any(row.negated or row.qualifier in own for _, row in chart.associations())
        conditions = any(_is_foreign(transition.condition, host) for transition in chart.transitions)
        return (
            rows
            or conditions
            or bool(chart.logic)
            or (not options.of_codesys and any(not transition.targets for transition in chart.transitions))
            or any(isinstance(body, StBody | IlBody | FbdBody | LdBody) for body in bodies)
        )
    if any(step.main_action is not None or step.min_time or step.max_time for step in chart.steps):
        return True
    if any(step.entry_action or step.exit_action for step in chart.steps) and shared_step_actions(chart):
        return True
    if options.of_codesys and flags_in_use(place):
        return True
    return chart.settings is not None


def _is_foreign(condition: Condition | None, host: ChartHost) -> bool:
    """True if CODESYS has no such condition: it takes expressions and names of transition objects."""
    body = condition.body if isinstance(condition, BodyCondition) else None
    is_text = isinstance(body, StBody) or (isinstance(body, IlBody) and not host.il_conditions)
    wired = isinstance(condition, WiredCondition)
    return condition is not None and (condition.negated or is_network(condition) or wired or is_text)


def report_orders(project: Project, host: ChartHost, report: ConversionReport) -> None:
    """Report actions that one tool executes by their names (CODESYS), and the other in the order of their first use.

    Rows with P1 and P0 and those of tools without final scans become step actions of CODESYS: see `StepRewriter`.
    """
    for place in project.charts():
        if told := _told_order(place, host):
            report.add(Outcome.APPROXIMATED, ORDER_OF_ACTIONS, place.report_path, told)


def _told_order(place: Chart, host: ChartHost) -> str:
    others = {Qualifier.R, Qualifier.R0} | ({Qualifier.P1, Qualifier.P0} if host.is_codesys else set())
    rows = [each for each in place.chart.associations() if each[1].qualifier not in others and not each[1].exclude]
    named = {id(row): (row.target or f"{step.name}_action").casefold() for step, row in rows}
    first: dict[str, int] = {}
    for _, row in rows:
        first.setdefault(named[id(row)], len(first))
    scans = SharedScans(place.chart, place.pou, host.dialect)

    def differ(one: Row, other: Row) -> bool:
        names = named[id(one[1])], named[id(other[1])]
        is_named, is_used = names[0] < names[1], first[names[0]] < first[names[1]]
        is_stored = one[1].qualifier in STORING or other[1].qualifier in STORING
        is_before = is_named if host.is_codesys else is_used
        return is_named is not is_used and is_before and (is_stored or scans.are_together(one[0], other[0]))

    return told_orders(scans, rows, differ, "before")


def rewrite_charts(
    copy: Project,
    project: Project,
    host: ChartHost,
    *,
    options: WriteOptions,
    report: ConversionReport,
    marks: SourceMarks,
) -> None:
    """Change the charts of `copy` into what `host` executes, and add to `marks` what to keep of `project` where."""
    named = named_flags(Names(project)) if options.of_codesys and not host.is_codesys else frozenset[str]()
    for chart, source in zip(list(copy.charts()), list(project.charts()), strict=True):
        if needs_rewriting(chart, host, options) or chart.chart != source.chart:
            rewriting = ChartRewriting(chart, source.chart, host, options, report, marks, taken_names(copy, chart))
            if options.of_codesys and not host.is_codesys and not options.flavour:
                rewriting.flags = _used_flags(project, source, named)
            _ChartRewriter(rewriting).rewrite()
            drawing = source.chart.drawing
            if drawing is not None and len(chart.chart.transitions) > len(source.chart.transitions):
                marks.setdefault(id(chart.chart), {}).update(drawing_mark(drawing))


def obey_flags(project: Project, source: Project, options: WriteOptions, report: ConversionReport) -> None:
    """Let conditions of `project`, a copy of `source` from CODESYS, obey its SFC flags before other rules apply."""
    named = named_flags(Names(source))
    host = ChartHost("matiec")
    for chart, before in zip(list(project.charts()), list(source.charts()), strict=True):
        flags = _used_flags(source, before, named)
        if flags:
            kept, taken = chart.chart.model_copy(deep=True), taken_names(project, chart)
            rewriting = ChartRewriting(chart, kept, host, options, report, {}, taken, flags)
            _ChartRewriter(rewriting).obey()


def _used_flags(project: Project, source: Chart, named: frozenset[str]) -> frozenset[SfcFlag]:
    """Return the SFC flags of a chart of CODESYS that something uses; an output that is set is for people, too."""
    used = flags_in_use(source)
    return used - (flags_at_rest(project, source.pou, used, named) - WATCHING_FLAGS)


class _ChartRewriter:
    def __init__(self, rewriting: ChartRewriting) -> None:
        self._rewriting = rewriting
        self._host = rewriting.host
        self._chart = rewriting.chart.chart
        self._note = rewriting.note
        self._checks = StepChecks(rewriting)
        self._modes = OperatingModes(rewriting, self._checks)

        self._boxes = _DrawnBoxes(rewriting)

    def rewrite(self) -> None:
        """Change the chart, by `CHART_RULES`."""
        for rule in CHART_RULES:
            rule.apply(self)

    def obey(self) -> None:
        """Let the chart obey its flags, which no minimum time holds up, and nothing else."""
        self._shown = ShownState(self._rewriting, self._checks, self._modes)
        for step in [each for each in self._chart.steps if each.min_time]:
            self._wait(step)
        self._steps = StepRewriter(self._rewriting, self._checks)
        self._permanent = PermanentRewriter(self._rewriting, self._steps, self._checks, self._shown)
        self.flags()
        self._report_codesys()
        self._chart.settings = SfcSettings(flags={flag: FlagUse(use=False) for flag in SfcFlag})

    def conditions(self) -> None:
        """Rewrite the conditions, with the supervisions and minimum times of the steps that they leave."""
        steps = {step.id: step for step in self._chart.steps}
        # boxes of a condition are executed unless a competing transition before it fires
        for transition in by_priority(self._chart.transitions):
            self._transition(transition, [steps[i] for i in transition.sources if i in steps])
        self._shown = ShownState(self._rewriting, self._checks, self._modes)

    def steps(self) -> None:
        """Rewrite the rows and the actions of the steps."""
        self._steps = StepRewriter(self._rewriting, self._checks)
        for step in self._chart.steps:
            self._steps.rewrite(step)
        self._steps.report_order()

    def sequences(self) -> None:
        """Rewrite sequences that the target cannot hold, and add the transitions of INIT_SQ and OFF_SQ."""
        SequenceRewriter(self._rewriting, self._checks, self._modes).rewrite()
        self._modes.report()

    def skips(self) -> None:
        """Add the transitions past steps that S7-GRAPH skips."""
        SkipRewriter(self._rewriting, self._checks).rewrite()

    def surroundings(self) -> None:
        """Add the actions for permanent instructions, edges of inputs and outputs that show the state."""
        self._permanent = PermanentRewriter(self._rewriting, self._steps, self._checks, self._shown)
        self._permanent.rewrite()

    def drawn_logic(self) -> None:
        """Add the action for logic that is drawn in the chart."""
        self._boxes.store(self._steps, self._permanent)

    def firings(self) -> None:
        """Add the action for the transitions of loops, behind all others."""
        self._permanent.add_firings()

    def flags(self) -> None:
        """Let conditions obey the SFC flags of CODESYS."""
        if self._rewriting.flags:
            execute_flags_in_tc6(self._rewriting, self._steps, self._checks, self._permanent)

    def start(self) -> None:
        """Hold the start of a sequencer until what its initial step stores has been executed."""
        self._permanent.hold()

    def losses(self) -> None:
        """Report the parts without a counterpart."""
        self._report_graph(self._shown.names)
        if not self._host.is_codesys:
            self._report_codesys()

    def _transition(self, transition: Transition, sources: list[Step]) -> None:
        source = self._rewriting.source_transitions[transition.id]
        held = self._rewrite_condition(transition, sources)
        if transition.condition != source.condition:
            uses = [name for step, field in held if field == "supervision" for name in self._checks.names(step)]
            uses += self._boxes.uses.get(transition.id, ())
            drawn = self._boxes.drawn(source)
            self._rewriting.marks[id(transition)] = rewritten_transition(transition, source, uses, held, drawn)

    def _rewrite_condition(self, transition: Transition, sources: list[Step]) -> list[tuple[int, str]]:
        """Change a condition; the ids of steps and the fields of them that it executes now."""
        condition = transition.condition
        if not self._host.excludes and (transition.exclude or any(step.exclude for step in sources)):
            transition.condition = Expression(text="FALSE")
            place = f"transition {self._chart.label(transition)}"
            self._note(
                Outcome.TRANSLATED, "exclude", place, "the condition is FALSE: CODESYS leaves the transition out"
            )
            return []
        supervised = [step for step in sources if is_supervised(step)]
        timed = [step for step in sources if step.min_time] if not self._host.is_codesys else []
        foreign = self._host.is_codesys and _is_foreign(condition, self._host)
        if condition is None or not (supervised or timed or foreign or self._modes.changes_conditions):
            return []
        label = f"transition {self._chart.label(transition)}"
        text = self._boxes.value(transition) if foreign else self._rewriting.text(condition)
        if text is None:
            # An undeclared name stops the compiler of the target. TRUE or FALSE in its place would run, and be wrong.
            text = self._rewriting.new_name(f"Condition_of_{self._chart.label(transition)}_is_missing")
            why = f"it cannot be written as an expression; the undeclared name {text} is in its place"
            told = f"{why}, so that {self._host.title} does not compile it"
            self._note(Outcome.NOT_EXECUTED, "condition", label, told, Cause(CauseKind.PLACEHOLDER, text))
        elif foreign:
            what = "a network" if is_network(condition) else "logic drawn in the chart"
            if not is_network(condition) and not isinstance(condition, WiredCondition):
                what = "a negated condition" if condition.negated else "a body"
            self._note(Outcome.TRANSLATED, "condition", label, f"{what} in the source, here the expression {text}")
        if is_empty_network(condition) and not (supervised or timed):
            text = "TRUE"
        if self._modes.changes_conditions:
            text = self._modes.switching(text)
            self._note(Outcome.TRANSLATED, "condition", label, "it depends on the operating mode")
        for step in supervised:
            text = self._held(step, text)
        for step in timed:
            text = conjunction(text, f"{self._host.elapsed(step)} >= {step.min_time}")
            why = f"the minimum time {step.min_time} of the step {step.name} is a part of the condition"
            self._note(Outcome.TRANSLATED, "minimum time", label, why)
        if supervised or timed:
            self._note(Outcome.TRANSLATED, "condition", label, f"with what holds the step: {text}")
        transition.condition = Expression(text=text)
        return [*((step.id, "supervision") for step in supervised), *((step.id, "min_time") for step in timed)]

    def _wait(self, step: Step) -> None:
        """Let the conditions that leave a step ask for its minimum time, before those of flags are added."""
        leaving = [each for each in self._chart.transitions if step.id in each.sources]
        texts = [self._rewriting.text(each.condition) for each in leaving]
        expressions = [text for text in texts if text is not None]
        if len(expressions) < len(texts):
            why = f"the flags of the chart wait for {step.min_time}, too"
            self._note(Outcome.APPROXIMATED, "minimum time", f"step {step.name}", why)
            return
        for transition, text in zip(leaving, expressions, strict=True):
            timed = conjunction(text, f"{self._host.elapsed(step)} >= {step.min_time}")
            transition.condition = Expression(text=timed)
        step.min_time = None

    def _held(self, step: Step, text: str) -> str:
        """Return the condition of a transition with the supervision of a step that it leaves."""
        held = self._checks.held(step)
        place = f"step {step.name}"
        if held is None:
            why = f"it does not hold the step in {self._host.title}: it cannot be written as an expression"
            self._note(Outcome.NOT_EXECUTED, "supervision", place, why)
            return text
        self._note(Outcome.TRANSLATED, "supervision", place, f"NOT {as_term(held)} in the conditions that leave it")
        return conjunction(text, f"NOT {as_term(held)}")

    def _report_graph(self, shown: set[str]) -> None:
        """Report the surroundings of a sequencer of S7-GRAPH that have no counterpart."""
        for step in self._chart.steps:
            if self._rewriting.interlock(step) not in (None, "TRUE"):
                why = "rows and outputs that depend on it are statements; it does nothing else"
                self._note(Outcome.TRANSLATED, "interlock", f"step {step.name}", why)
        if not self._rewriting.of_graph:
            return
        for variable in self._rewriting.chart.pou.variables():
            if variable.name in ACKNOWLEDGING:
                why = "statements compute its rising edges where something depends on them"
                self._note(Outcome.TRANSLATED, OPERATING_INPUT, variable.name, why)
        if shown:
            why = f"{', '.join(sorted(shown))}: statements set them as in the automatic mode"
            self._note(Outcome.TRANSLATED, "shown state", "", why)

    def _report_codesys(self) -> None:
        """Report the flags of a chart of CODESYS that have no counterpart in TC6."""
        chart = self._chart
        used = self._rewriting.flags
        for flag in sorted(each for each in used if each.variable.upper() not in self._rewriting.options.at_rest):
            what, place = told_flag(flag)
            self._note(Outcome.NOT_EXECUTED, what, place, f"the flag has no effect in {self._host.title}")
        if SfcFlag.ERROR in used:
            for step in (step for step in chart.steps if step.max_time):
                why = f"{step.max_time} is not watched in {self._host.title}: SFCError is never set"
                self._note(Outcome.NOT_EXECUTED, "max time", f"step {step.name}", why)


class _DrawnBoxes:
    """Logic drawn in a chart, such as timers and edges before conditions, as an action; CODESYS draws none in a chart.

    Actions come before the transitions there. So the action calls the boxes of a condition after all other actions,
    while the steps that its transition leaves are active, as IEC 61131-3 executes what is drawn before a condition.
    Beremiz executes all boxes in every scan, after the transitions: its conditions read what they gave a scan ago.
    """

    def __init__(self, rewriting: ChartRewriting) -> None:
        self._rewriting, self._chart = rewriting, rewriting.chart.chart
        self._lines: list[str] = []
        self._kept: dict[int, n.Expression] | None = None
        self._tried: list[tuple[Transition, str]] = []
        self._added: list[str] = []
        self._instances: set[str] = set()
        self._before: dict[str, str] = {}
        self.uses: dict[int, list[str]] = {}
        """The added variables that conditions read, by the ids of transitions."""

    def value(self, transition: Transition) -> str | None:
        """Return the expression for the condition of a transition; its boxes are in the action then."""
        condition = transition.condition
        text = self._rewriting.text(condition)
        if text is None and condition is not None:
            found = self._rewriting.read(condition)
            if found.tree is None or not found.complete or self._initial is None:
                return None
            if self._rewriting.options.of_matiec:
                text = self._value_before(transition)
            else:
                self.uses[transition.id] = self._rewriting.declare_helpers(found.helpers)
                statements = print_node(n.Statements(found.before)).splitlines()
                self._lines += guarded(self._rewriting.enabled(transition, self._tried), statements)
                text = print_node(found.tree)
        if text is not None:
            self._tried.append((transition, text))
        return text

    def drawn(self, source: Transition) -> dict[int, Node]:
        """Return the logic that feeds a condition of the source and leaves the chart, by its places there."""
        rewriting = self._rewriting
        if not rewriting.host.is_codesys:
            return {}
        feeding = feeding_nodes(rewriting.source, source.condition, rewriting.host.dialect)
        return {at: node for at, node in enumerate(rewriting.source.logic) if any(node is each for each in feeding)}

    def store(self, steps: StepRewriter, surroundings: PermanentRewriter) -> None:
        """Let the initial step store the action, and take the logic out of the chart."""
        rewriting, initial = self._rewriting, self._initial
        if not rewriting.host.is_codesys or initial is None:
            return
        acting = self._acting()
        if acting is None:
            return  # the logic stays, and the writer tells what its tool makes of it
        lines = [*acting, *self._lines]
        marks = [rewriting.marks.get(id(each), {}).get(REWRITTEN_FIELD, {}) for each in self._chart.transitions]
        kept = {place for mark in marks for place, _ in mark.get("logic", ())}
        rest = {place: node for place, node in enumerate(rewriting.source.logic) if place not in kept}
        if rest and not lines:
            return  # it does nothing
        if lines:
            uses = [*self._added, *(name for names in self.uses.values() for name in names)]
            name = steps.store(
                initial,
                surroundings.name("boxes"),
                StBody(text="\n".join(lines)),
                first=False,
                instead_of=None,
                uses=dict.fromkeys(uses),
                logic=rest,
            )
            for transition in self._chart.transitions:
                if transition.id in self.uses:  # one comes back with the other
                    rewriting.marks[id(transition)][REWRITTEN_FIELD]["uses"].append(name.casefold())
            why = f"the action {name} of the step {initial.name} executes it, and the boxes drawn before conditions"
            if acting:
                why += "; it follows its inputs at once, and the actions of steps a scan later than in the source"
            rewriting.note(Outcome.APPROXIMATED if acting else Outcome.TRANSLATED, "drawn logic", "", why)
        self._chart.logic = []

    def _acting(self) -> list[str] | None:
        """Return the logic that does more than feed conditions as statements; None where it cannot be written."""
        dialect, rewriting = self._rewriting.host.dialect, self._rewriting
        if not self._chart.logic or rewriting.options.of_matiec:  # Beremiz does not execute it
            return []
        found = chart_statements(rewriting.source, dialect, taken=rewriting.taken)
        if found.obstacles:
            return None
        self._added += rewriting.declare_helpers(found.helpers)
        return print_node(found.tree).splitlines()

    @property
    def _initial(self) -> Step | None:
        return next((step for step in self._chart.steps if step.initial), None)

    def _value_before(self, transition: Transition) -> str | None:
        """Return a condition of Beremiz, which reads what the boxes gave in the scan before."""
        dialect = self._rewriting.host.dialect
        if self._kept is None:
            objects, taken = self._rewriting.chart.pou.transitions, self._rewriting.taken
            wired = (t for t in self._rewriting.source.transitions if isinstance(t.condition, WiredCondition))
            needed = [each for each in wired if self._rewriting.text(each.condition) is None]
            chart = self._rewriting.source.model_copy(update={"transitions": needed})
            found, self._kept = kept_conditions(chart, dialect, transitions=objects, taken=taken)
            self._added += self._rewriting.declare_helpers(found.helpers)
            self._instances = {name.casefold() for name in found.instances}
            self._lines += print_node(found.tree).splitlines()
        tree = self._kept.get(transition.id)
        if tree is None:
            return None
        text = print_node(transform(tree, self._as_before))
        self.uses[transition.id] = [*self._added, *self._before.values()]
        return text

    def _as_before(self, node: n.Node) -> n.Node:
        """Return the variable with the value that a box gave in the scan before."""
        instances = self._instances
        match node:
            case n.Member(base=n.Name() as owner) if owner.identifier.casefold() in instances:
                is_given = node.name.identifier.upper() == "Q"
            case n.Name():
                is_given = node.identifier in self._added and node.identifier.casefold() not in instances
            case _:
                is_given = False
        if not is_given:
            return node
        value = print_node(node)
        if value not in self._before:
            self._before[value] = self._rewriting.new_variable(f"{value.replace('.', '_')}_before")
            self._lines.insert(0, f"{self._before[value]} := {value};")
        return n.Name(self._before[value])


@dataclass(frozen=True)
class ChartRule:
    """A rule for charts: what it is about, and what it makes of that; see `AdaptationRule`."""

    of: str
    makes: str
    apply: Callable[[_ChartRewriter], None]


CHART_RULES = (
    ChartRule(
        "networks, wired and negated conditions in CODESYS; supervisions; operating modes; minimum times in TC6; "
        "excluded elements",
        "expressions, with `AND NOT <supervision>`, the mode and T_PUSH, and `AND <Step>.T >= <time>`; FALSE for what "
        "is excluded in tools that know no exclusion",
        _ChartRewriter.conditions,
    ),
    ChartRule(
        "rows with an event, an interlock, a value or a call; timers and counters of S5; operands that S7-GRAPH "
        "writes or reads in the order of its rows; negated rows; main actions, and entry and exit actions of several "
        "steps, in TC6",
        "statements in actions of the step: while it is active, once at its start, once when it was left; not executed "
        "where no statement does the same",
        _ChartRewriter.steps,
    ),
    ChartRule(
        "steps that actions ON and OFF or people switch; several sequences and ends in CODESYS; INIT_SQ and OFF_SQ",
        "transitions that are tried before all others, to the initial step and to a step `Off`; where several steps of "
        "a sequence may be active, a loop for each step: the step and one that does nothing; a step `Start` that leads "
        "to all sequences, and a step `End` that does nothing",
        _ChartRewriter.sequences,
    ),
    ChartRule(
        "SkipSteps",
        "transitions that are tried first and lead past the steps that are skipped; not executed where the conditions "
        "are no expressions, or ask for the time of such a step, and where a way begins or ends with several steps",
        _ChartRewriter.skips,
    ),
    ChartRule(
        "permanent instructions, `S_NO`, `S_ACTIVE`, `S_MORE`, `ERR_FLT`, edges of ACK_EF and REG_EF",
        "actions that the initial step stores, named so that CODESYS executes them before or after all others",
        _ChartRewriter.surroundings,
    ),
    ChartRule(
        "timers, edges and other logic drawn in a chart, in CODESYS",
        "an action that the initial step stores: it calls what is drawn before a condition while its transition is "
        "enabled, and executes the rest in every scan",
        _ChartRewriter.drawn_logic,
    ),
    ChartRule(
        "transitions of steps that become loops, in CODESYS",
        "a variable for each, such as `Fill_to_Stir`, that tells whether it fires: an action that the initial step "
        "stores computes them behind all other actions, and the conditions of the loops read them",
        _ChartRewriter.firings,
    ),
    ChartRule(
        "SFC flags and maximum times in TC6",
        "conditions that obey them, transitions to the initial step and to one that does nothing, statements that ask "
        "them, and such that set SFCError and SFCCurrentStep; not executed where several steps may be active",
        _ChartRewriter.flags,
    ),
    ChartRule(
        "the first scan of S7-GRAPH, which tests no transition, where the initial step stores actions, in TC6",
        "a variable `sequence_started` that the initial step sets, and the conditions that leave it ask for",
        _ChartRewriter.start,
    ),
    ChartRule(
        "SFC flags that analyse errors in TC6",
        "not executed: the target has nothing of the kind",
        _ChartRewriter.losses,
    ),
)
"""The rules for charts. Conditions come first: the supervisions that they need are those of the source."""
