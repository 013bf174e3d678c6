"""One scan of a GRAFCET as code: the evolutions up to a stable situation, then the outputs of that situation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.actions.action_execution import add_actions, add_conditions
from plcopen_sfc.lowering.actions.drive_block import DriveBlock, DriveSignal, without_texts
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    call,
    conjunction,
    disjunction,
    is_constant,
    negation,
    when,
)
from plcopen_sfc.lowering.code.code_bodies import titled
from plcopen_sfc.lowering.code.lowered_code import BOOL, INT, CodeNetwork
from plcopen_sfc.lowering.encodings.case_encodings import RegionEncoding
from plcopen_sfc.lowering.encodings.case_states import StateVariables
from plcopen_sfc.lowering.encodings.step_flags import FlipFlopEncoding, StepFlagEncoding
from plcopen_sfc.lowering.grafcet.grafcet_actions import (
    ContinuousActionCode,
    ForcingCode,
    PassingActionCode,
    StepViews,
    StoredActions,
    asked_in_between,
    events_asked_early,
    passed_steps,
    written_if,
)
from plcopen_sfc.lowering.grafcet.grafcet_evolutions import Concurrency, Stability, TermCode
from plcopen_sfc.lowering.lowering_options import ActionPlace
from plcopen_sfc.lowering.reading.chart_source import ChartSource, GrafcetSource
from plcopen_sfc.model.actions import ActionKind
from plcopen_sfc.semantics.net import indexes
from plcopen_sfc.semantics.profile import ActionOrder, BooleanTargets, Evolution, Profile


class GrafcetScan:
    """Schedule of one scan with one evolution, or with evolutions up to stability, for the chart of `encoding`."""

    def __init__(self, encoding: StepFlagEncoding | RegionEncoding) -> None:
        encoding.resolve_steps()
        self._encoding = encoding
        self._code, self._texts, self._net = encoding.code, encoding.texts, encoding.net
        assert encoding.source.grafcet is not None  # noqa: S101  # it was read so
        active = [encoding.active(step.index) for step in self._net.steps]
        self._terms = TermCode(encoding.source.grafcet, self._code, active)
        encoding.source = encoding.source.changed(lambda tree: transform(tree, self._terms.named))
        assert encoding.source.grafcet is not None  # noqa: S101
        self._grafcet: GrafcetSource = encoding.source.grafcet
        self._concurrency = Concurrency(encoding.source, encoding.profile)
        # declared so far: names that conditions may have and that change between two evolutions
        own = [variable.name for variable in self._code.variables]
        self.stability = Stability(encoding.source, self._terms, active, own, self._concurrency)
        self._searches = encoding.profile.evolution is Evolution.UNTIL_STABLE
        # a loop is made only where a scan could need a second evolution
        self._stable = self._searches and not self.stability.once
        self._situation = encoding.situation
        # stored and pulsed actions also come from steps that were active within the scan only
        passed = sorted(passed_steps(encoding.source.actions)) if self._stable else []
        names = {i: self._texts.flag_name(self._net.steps[i].step) for i in passed}
        self._passed = {i: self._code.declare(self._texts.with_suffix(names[i], "seen")) for i in passed}
        before = self._situation.before
        sights = StepViews(encoding.active, before, self._fresh)
        bits = _bits(encoding.source) if self._code.drawn else ()
        self._first: n.Name | None = None
        self._drive, self._drive_of_stored = self._drive_blocks()
        self._acting = self._drive.memory if self._drive is not None else encoding.memory
        memory = self._drive_of_stored.memory if self._drive_of_stored is not None else encoding.memory
        self._stored = StoredActions(self._grafcet.stored, memory, sights, bits)
        self._ruled = [ForcingCode(chart, encoding.active, before) for chart in self._grafcet.ruled]

    def append(self) -> None:
        """Append all networks."""
        encoding, code, texts = self._encoding, self._code, self._texts
        code.add(texts.logic, encoding.source.logic)
        code.add(texts.times, encoding.times.calls())  # of steps whose time conditions read
        self._hold()
        encoding.divide()
        continuous = ContinuousActionCode(self._grafcet.continuous, code, self._acting, encoding.active, encoding.times)
        moves = self._situation.changed() if self._stable else FALSE  # before it is known what must be remembered
        # the networks of an evolution are made before those in front of them: only then it is known what these must
        # prepare
        evolution = self._recorded(lambda: self._evolve(continuous))
        self._start()
        unseen = [(flag, self._starting() if self._net.initial >> i & 1 else FALSE) for i, flag in self._passed.items()]
        code.add(texts.passed, [assignment(flag, value) for flag, value in unseen])
        if self._stable and code.drawn:
            self._jump(evolution, moves)
        elif self._stable:
            self._loop(evolution, moves)
        else:
            code.networks += evolution
        timers = [call(timer, IN=started, PT=time) for timer, started, time in continuous.timers]
        code.add(texts.times, [*encoding.times.calls(), *timers])
        self._add_actions()
        events = any(stored.event is not None for stored in self._grafcet.stored)
        if not self._stable or events or encoding.source.actions or encoding.source.step_code:
            code.add(texts.terms, self._terms.times)  # something may have changed since they were last called
        outputs = replace(encoding.source, actions=self._grafcet.continuous)
        rules = replace(encoding.rules, profile=_outputs(encoding.profile))
        add_conditions(outputs, encoding.memory, encoding.active, rules)
        add_actions(self._executed(outputs), continuous, rules)
        if self._drive is not None:
            self._call(self._drive, texts.drive_call)
        code.end_first_scan()

    def _add_actions(self) -> None:
        """Append the actions of steps, and those with qualifiers of IEC 61131-3."""
        encoding = self._encoding
        encoding.add_changes()
        encoding.add_main_actions()
        add_conditions(encoding.source, encoding.memory, self._driving, encoding.rules)
        ending = encoding.init if encoding.init is not None and encoding.rules.reset_actions else FALSE
        control = PassingActionCode(self._acting, encoding.active, self._seen, ending)
        add_actions(self._executed(encoding.source), control, encoding.rules)
        encoding.remember()

    def _executed(self, source: ChartSource) -> ChartSource:
        """Return a chart whose actions are executed where they are to be, in the code of `_acting`."""
        return source if self._drive is None else without_texts(source)

    # -- blocks of their own for actions

    def _drive_blocks(self) -> tuple[DriveBlock | None, DriveBlock | None]:
        """Return the block for actions behind the evolutions, and that for stored actions: one block if possible."""
        encoding = self._encoding
        if encoding.rules.actions is not ActionPlace.BLOCK:
            return None, None
        problem = events_asked_early(encoding.source, self._grafcet, encoding.active)
        if problem:
            message = f"stored actions on events cannot be in a block of their own: {problem}"
            encoding.source.refuse(message, "Leave actions inline.")
        stored = [statement for each in self._grafcet.stored for statement in each.statements]
        if not self._stable and not asked_in_between(encoding.source, self._grafcet, self._net.initial):
            only = encoding.drive_block(self._texts.drive)
            return only, only
        lasting = (*encoding.source.actions, *self._grafcet.continuous)
        others = [*(statement for action in lasting for statement in action.statements)]
        others += [assignment(action.target, TRUE) for action in lasting if action.target is not None]
        behind = encoding.drive_block(self._texts.drive, stored)
        return behind, encoding.drive_block(self._texts.drive_stored, others) if stored else None

    def _call(self, drive: DriveBlock, title: str) -> None:
        """Append the call of a block, if there is anything in it."""
        if isinstance(self._situation, StateVariables) and self._situation.remembered():
            for step in self._net.steps:  # comparisons are no variables, which the block could get
                name = self._texts.with_suffix(self._texts.flag_name(step.step), "old")
                self._encoding.signals[self._situation.before(step.index)] = DriveSignal(name, "")
        if drive.code.networks:
            self._code.add(title, [self._encoding.call(drive)])

    def _call_at_the_start(self, drive: DriveBlock) -> n.CallStatement:
        """Return the call of the block for stored actions where no step was active before.

        The copy of a state, whose first value can be that of an initial step, does not tell that.
        """
        if isinstance(self._situation, StepFlagEncoding):
            return drive.call
        before = {self._situation.before(step.index) for step in self._net.steps}
        return transform(drive.call, lambda node: FALSE if node in before else node)

    # -- steps

    def _seen(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step was active in any situation of the scan but its first."""
        if self._stable:
            return self._passed[step]
        started = self._searches and self._net.initial >> step & 1
        return disjunction([self._encoding.active(step), self._starting() if started else FALSE])

    def _driving(self, step: int) -> Expression:
        """Return an expression that is TRUE if a step drives its actions in any situation of the scan."""
        return self._seen(step) if not self._stable or step in self._passed else self._encoding.active(step)

    def _fresh(self, step: int) -> Expression:
        """Return when the evolution before has activated a step; the start activates initial ones."""
        initial = self._net.initial >> step & 1
        if self._stable:
            starting = self._in_first_evolution() if initial else FALSE
            return disjunction([negation(self._situation.before(step)), starting])
        return self._starting() if initial else FALSE

    def _fired(self, transition: int) -> Expression:
        """Return an expression that is TRUE if a transition has fired in this evolution."""
        if isinstance(self._situation, StepFlagEncoding):
            return self._situation.fired[transition]
        return FALSE  # no code asks: with a CASE no transition leads back to its own step

    def _again(self, step: int) -> Expression:
        """Return an expression that is TRUE if transitions have left and entered a step at once: its time restarts."""
        if not self._encoding.profile.leaving_restarts_time:
            return FALSE
        net = self._net
        leaving, entering = ([net.transitions[i] for i in ids[step]] for ids in (net.leaving, net.entering))
        fired = self._fired
        pairs = [(t, u) for t in leaving for u in entering if t is u or self._concurrency.both_fire(t, u)]
        return disjunction(conjunction([fired(t.index), fired(u.index)]) for t, u in pairs)

    def _starting(self) -> Expression:
        """Return an expression that is TRUE if it is the first scan."""
        return self._code.first_scan_pulse()

    def _in_first_evolution(self) -> n.Name:
        """Return a variable that is TRUE in the first evolution of the first scan only."""
        if self._first is None:
            self._first = self._code.declare(self._texts.first_evolution, initial="TRUE")
        return self._first

    # -- evolutions

    def _hold(self) -> None:
        """Let no transition of a chart fire while an order holds the chart."""
        conditions = list(self._encoding.source.conditions)
        preparations = list(self._encoding.source.preparations)
        for ruling in self._ruled:
            forced = ruling.forced()
            if isinstance(self._encoding, RegionEncoding):
                self._encoding.hold(ruling.steps, forced)
                continue
            if is_constant(forced, FALSE):
                continue
            for transition in self._net.transitions:
                if set(ruling.steps) & {*transition.sources, *transition.targets}:
                    i = transition.index
                    conditions[i] = conjunction([conditions[i], negation(forced)])
                    preparations[i] = (when(negation(forced), *preparations[i]),) if preparations[i] else ()
        self._encoding.source = replace(
            self._encoding.source, conditions=tuple(conditions), preparations=tuple(preparations)
        )

    def _evolve(self, continuous: ContinuousActionCode) -> None:
        """Append one evolution."""
        encoding, code, texts = self._encoding, self._code, self._texts
        events = self._stored.events()
        happening: list[Statement] = []
        drive = self._drive_of_stored
        if drive is not None:  # which executes them behind the transitions
            events = [event.named(encoding.memory, texts.event, happening) for event in events]
            drive.code.add(texts.start, self._at_the_start() if drive is self._drive else [])
            drive.code.add(texts.events, self._stored.on_events(events))
            drive.code.add(texts.stored, [*self._stored.on_changes(), *self._ended()])
        changes = [*self._stored.on_changes(), *self._ended()] if drive is None else []
        code.add(texts.terms, [*self._terms.times, *self._terms.edges])
        code.add(texts.events, self._stored.on_events(events) if drive is None else happening)
        place = len(code.networks)
        encoding.choose_transitions()
        self._change_situation()
        code.add(texts.stored, changes)
        if drive is not None and drive is not self._drive:
            self._call(drive, texts.drive_stored_call)
        code.add(texts.times, self._restarts(continuous))
        seen = [assignment(flag, disjunction([flag, encoding.active(i)])) for i, flag in self._passed.items()]
        code.add(texts.passed, seen)
        code.add(texts.before, self._situation.remembered(), place=place)  # known now
        code.add(texts.first_evolution_ends, [assignment(self._first, FALSE)] if self._first is not None else [])

    def _change_situation(self) -> None:
        """Append what transitions change, and what the charts above impose on others."""
        encoding = self._encoding
        if isinstance(encoding, FlipFlopEncoding):  # which has them among its inputs, those of charts above first
            below = {step: place for place, ruling in enumerate(self._ruled) for step in ruling.steps}
            order = sorted(self._net.steps, key=lambda step: below.get(step.index, -1))
            # the first order counts, as in the interpreter: orders that contradict each other are a mistake
            imposed = [each for ruling in self._ruled for each in reversed(list(ruling.situations()))]
            starts = self._in_first_evolution() if self._stable and encoding.memory.has_instances else None
            encoding.change_situation(imposed, self._concurrency.both_fire, starts=starts, order=order)
            return
        encoding.change_situation()
        forced: list[Statement] = []
        for ruling in self._ruled:
            found = ruling.situations()
            branches = (n.Branch(each.when, tuple(encoding.imposing(each.situation))) for each in found)
            forced.append(n.If(tuple(branches)))
        self._code.add(self._texts.forcing, forced)

    def _ended(self) -> list[Statement]:
        """Return the effect of a restart on what is stored."""
        encoding = self._encoding
        if encoding.init is None or not encoding.rules.reset_actions:
            return []
        return self._stored.ended(encoding.init, indexes(self._net.initial), _bits(encoding.source))

    def _restarts(self, continuous: ContinuousActionCode) -> list[Statement]:
        """Return the restarts of the times of steps that are left and entered again before the scan ends."""
        encoding = self._encoding
        found: list[Statement] = []
        for step in range(len(self._net.steps)):
            # a step that is passed twice in one scan starts its time again each time, though its timer is called behind
            # the loop
            left = negation(encoding.active(step)) if self._stable else FALSE
            again = disjunction([left, self._again(step)]) if encoding.times.measures(step) else FALSE
            if not is_constant(again, FALSE):
                found += encoding.times.restarts(step, again)
        for timer, started, time in continuous.timers if self._stable else ():
            found.append(when(negation(started), call(timer, IN=FALSE, PT=time)))
        return found

    def _start(self) -> None:
        """Append what is executed once, before the first evolution."""
        statements: list[Statement] = []
        for variable, value in self._terms.starts:
            if self._code.drawn:
                statements.append(written_if(self._starting(), variable, value))
            else:
                statements.append(when(self._starting(), assignment(variable, value)))
        drive = self._drive_of_stored
        if drive is None:
            statements += self._at_the_start()
        elif drive is not self._drive and self._at_the_start():
            statements.append(when(self._starting(), self._call_at_the_start(self._encoding.drives[0])))
        self._code.add(self._texts.start, statements)

    def _at_the_start(self) -> list[Statement]:
        """Return the statements that the activation of the initial steps executes."""
        initial = set(indexes(self._net.initial))
        activated = (s.steps for s in self._grafcet.stored if s.kind is ActionKind.ON_ACTIVATION)
        if not any(initial.intersection(steps) for steps in activated):
            return []
        return self._stored.at_the_start(initial, self._starting())

    def _recorded(self, make: Callable[[], None]) -> list[CodeNetwork]:
        kept, self._code.networks = self._code.networks, []
        make()
        made, self._code.networks = self._code.networks, kept
        return made

    def _jump(self, evolution: Sequence[CodeNetwork], moves: Expression) -> None:
        """Repeat an evolution by a jump back to its first network: networks have no other loops."""
        code, texts = self._code, self._texts
        label = n.Name(code.naming.fresh(texts.next_evolution))
        moving, starts, counted, goes_on = self._counted(Operator.LESS)
        code.add(texts.stability, starts)
        first, *others = evolution
        code.networks += [replace(first, statements=(n.LabelStatement(label), *first.statements)), *others]
        code.add(texts.stability, [assignment(moving, moves), *counted])
        code.add(texts.next_evolution_title, [when(conjunction([moving, *goes_on]), n.Goto(label, "GOTO"))])

    def _loop(self, evolution: Sequence[CodeNetwork], moves: Expression) -> None:
        """Repeat an evolution until no transition fires any more."""
        moving, starts, counted, ends = self._counted(Operator.GREATER_OR_EQUAL)
        inside = [CodeNetwork("", tuple(counted)), *evolution, CodeNetwork("", (assignment(moving, moves),))]
        apart = [each for network in inside if network.statements for each in (n.Remark(""), *titled(network))]
        self._code.add(
            self._texts.stability, [*starts, n.Repeat(tuple(apart[1:]), disjunction([negation(moving), *ends]))]
        )

    def _counted(self, bound: Operator) -> tuple[n.Name, list[Statement], list[Statement], list[Expression]]:
        """Return what tells that a transition has fired; what starts, counts and compares evolutions with the most.

        They are only counted where no end of them is known: then the first one is an output, which stays TRUE where no
        stable situation was found.
        """
        code, texts = self._code, self._texts
        if self.stability.most is not None:
            return code.declare(texts.moving, comment=texts.moving_comment), [], [], []
        number = code.declare(texts.evolutions, INT)
        unstable = code.declare_output(texts.unstable, texts.unstable_comment)
        counted = assignment(number, n.Operation(Operator.ADD, (number, n.Literal("1"))))
        most = n.Literal(str(self._encoding.profile.max_evolutions))
        return unstable, [assignment(number, n.Literal("0"))], [counted], [n.Operation(bound, (number, most))]


def _bits(source: ChartSource) -> set[str]:
    """Return the names of the BOOL variables of the POU, in lower case."""
    return {variable.name.casefold() for variable in source.pou.variables() if variable.type == BOOL}


def _outputs(profile: Profile) -> Profile:
    """Return the profile with outputs written in every scan, in the order of the chart (4.8.2)."""
    return replace(profile, boolean_targets=BooleanTargets.ALWAYS, final_scan=False, action_order=ActionOrder.FIRST_USE)
