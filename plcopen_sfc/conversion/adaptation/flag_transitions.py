"""SFC flags of CODESYS as transitions of charts of tools without such variables.

SFCInit holds a chart in its initial step, of which nothing is executed; SFCReset begins it again there, and keeps its
transitions from firing; SFCPause stops it; SFCTipMode keeps transitions from firing, and an edge of SFCTip fires those
that are enabled. A block of S7-GRAPH has INIT_SQ and T_PUSH, but for its caller only; TC6 has nothing of the kind. So
the flags are conditions: of transitions that are tried before all others, to the initial step and to one that does
nothing, and of those that the chart has (`plcopen_sfc.semantics.charts.sfc_flags`, and the tests compare both). Where
several steps may be active at a time, one transition leaves all that are active together, for each situation.

Statements ask the flags: CODESYS executes none once more where a flag ends its step, and none while the chart stops.
What else actions need is in `flags_in_graph` and `flags_in_tc6`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Sequence

from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.conversion.adaptation.chart_rewriting import (
    ChartRewriting,
    all_of,
    guarded,
    names_around,
)
from plcopen_sfc.conversion.executed_parts import HIDDEN_FLAG, told_flag
from plcopen_sfc.languages.binding import Effects, bind
from plcopen_sfc.languages.effects import path_of
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.project import Chart
from plcopen_sfc.model.sfc import ActionAssociation, Body, SfcBody, Step, Transition
from plcopen_sfc.model.text import without_signs
from plcopen_sfc.model.types import Elementary, ElementaryType
from plcopen_sfc.report import INPUTS_TOGETHER, Outcome

_LASTING = frozenset({Qualifier.S, Qualifier.R, Qualifier.R0, Qualifier.N, Qualifier.NONE})
"""Qualifiers of actions on operands that are the same in each scan of a step."""
_WITHOUT = {
    SfcFlag.CURRENT_STEP: "it has S_NO, the number of the step",
}
"""Why flags have no effect in a block of S7-GRAPH."""
_TIPPING = frozenset({SfcFlag.TIP, SfcFlag.TIP_MODE})
ENDING = frozenset({SfcFlag.INIT, SfcFlag.RESET})
_STOPPING = frozenset({SfcFlag.PAUSE, SfcFlag.QUIT_ERROR})
_OBEYED = _TIPPING | ENDING | {SfcFlag.PAUSE}
_BRANCHES = "several of its steps may be active at a time, which no transition leaves together"
_MOST_SITUATIONS = 32
"""The most situations for which there is a transition each."""
PULSES = frozenset({Qualifier.P1, Qualifier.P0})
"""Qualifiers of actions that are executed once, as a step begins or ends."""
_ACTIVE = frozenset({Qualifier.N, Qualifier.NONE, Qualifier.P, Qualifier.L, Qualifier.D})
"""Qualifiers of actions that are executed while a step is active, and once more."""


class FlagRewriter(ABC):
    """Rewrites one chart for its flags. Of those `resting`, it tells nothing that has no effect."""

    obeyed = _OBEYED
    """The flags that conditions obey."""
    prefix = ""
    """The prefix of a variable of the block in texts."""
    leaves_branches = False
    """True if a transition may leave whatever steps of simultaneous branches are active together."""

    def __init__(self, rewriting: ChartRewriting, resting: Collection[SfcFlag] = ()) -> None:
        self._rewriting, self._host, self._note = rewriting, rewriting.host, rewriting.note
        self._place, self._chart, self._resting = rewriting.chart, rewriting.chart.chart, resting
        self._texts = {each.id: rewriting.text(each.condition) for each in self._chart.transitions}
        """The conditions of transitions by their ids, None for those that are no expression."""
        self.lines: list[str] = []
        """The statements for behind the sequence, which set the memories."""
        self.ends: list[str] = []
        """The flags in use that end actions."""
        self._dialect = self._host.dialect
        self._bodies = [bind(body, self._dialect) for _, _, body in self._place.pou.named_bodies()]
        """The texts of the POU before its chart is changed."""
        names = (SfcFlag.INIT, SfcFlag.RESET, SfcFlag.TIP, SfcFlag.TIP_MODE)
        self._init, self._reset, self._tip, self._tip_mode = (f"{self.prefix}{each.variable}" for each in names)
        self._pause = ""
        """The reason why the chart stops, where it does."""
        self.stops = ""
        """The variable that is TRUE while the chart stops, where it does."""
        self._timed = {step.id: step.min_time for step in self._chart.steps if step.min_time}
        self._called = Effects.all(body.code for body in self._bodies).calls
        self._firsts: set[int] = set()
        """The steps that SFCReset does not leave."""

    def rewrite(self, flags: Collection[SfcFlag]) -> frozenset[SfcFlag]:
        """Change the chart, and report what became of these flags. Returns those that it obeys now."""
        refused = {flag: self._refusal(flag) for flag in sorted(flags)}
        executed = [flag for flag, why in refused.items() if why is None]
        for flag, why in refused.items():
            what, place = told_flag(flag)
            if why is None:
                self._note(Outcome.TRANSLATED, what, place, "the conditions of transitions obey it")
            elif flag not in self._resting:
                self._note(Outcome.NOT_EXECUTED, what, place, f"{self._host.title} has no {flag.variable}: {why}")
        if executed:
            stopping = [f"{self.prefix}{flag.variable}" for flag in executed if flag in _STOPPING]
            self._pause = f"({' OR '.join(stopping)})" if len(stopping) > 1 else "".join(stopping)
            self._report_together_with(executed)
            self._execute(executed)
            self._guard(executed)
        return frozenset(executed)

    def _report_together_with(self, flags: Collection[SfcFlag]) -> None:
        """Report what comes in one scan with a flag: CODESYS acts on a transition a scan later than the target."""
        if stopping := ", ".join(each.variable for each in sorted(_STOPPING & {*flags})):
            why = f"a condition that is TRUE only in the scan in which {stopping} comes fires its transition behind it"
            self._note(Outcome.APPROXIMATED, INPUTS_TOGETHER, "", f"{why}; CODESYS tests none in that scan")
        if {SfcFlag.TIP, SfcFlag.INIT} <= {*flags}:
            told = "a push of SFCTip that comes in one scan with SFCInit fires no transition"
            self._note(Outcome.APPROXIMATED, INPUTS_TOGETHER, "", f"{told}; in CODESYS one fires behind it")

    # -- what the target has

    def _declare(self, name: str) -> str:
        """Declare a Boolean variable that the source does not have; return its name in texts."""
        self._rewriting.declare(name, ElementaryType(name=Elementary.BOOL))
        return f"{self.prefix}{name}"

    @abstractmethod
    def _added_step(self, wish: str, why: str) -> Step:
        """Add a step."""

    @abstractmethod
    def _lead(self, sources: Sequence[Step], target: Step, condition: str) -> None:
        """Add a transition that is tried before the others."""

    def _put(self, transition: Transition, condition: str) -> None:
        """Give a transition another condition."""
        transition.condition = Expression(text=condition)
        place = f"transition {self._chart.label(transition)}"
        self._note(Outcome.TRANSLATED, "condition", place, "it obeys the SFC flags of the chart")

    @abstractmethod
    def _end_stored(self, flags: Collection[SfcFlag]) -> None:
        """Let what actions store end where a flag ends it."""

    # -- what cannot be done

    @abstractmethod
    def _refused_end(self) -> str | None:
        """Return why actions cannot end where a flag ends them."""

    @abstractmethod
    def _refused_pause(self) -> str | None:
        """Return why actions cannot stop."""

    def _refusal(self, flag: SfcFlag) -> str | None:
        """Return why no condition does what a flag does; None where conditions do."""
        if flag not in self.obeyed:
            return _WITHOUT.get(flag, "the chart neither obeys it nor sets it")
        chart = self._chart
        if not self._is_declared(flag) and (chart is not self._place.pou.chart or self._is_known(flag)):
            return "it is no variable of the block"
        if sum(step.initial for step in chart.steps) != 1 or any(step.macro is not None for step in chart.steps):
            return _BRANCHES
        if flag in ENDING and self._has_branches and not self._situations():
            return _BRANCHES
        held = self._held_by(flag)
        if any(self._texts[number] is None for number in held):
            return "a condition that would obey it is no expression"
        if flag in ENDING:
            return self._refused_end()
        return self._refused_pause() if flag in _STOPPING else None

    @property
    def _has_branches(self) -> bool:
        return any(len(each.sources) != 1 or len(each.targets) != 1 for each in self._chart.transitions)

    def _situations(self) -> list[list[Step]]:
        """Return the steps that may be active together; none where transitions cannot leave each of the situations."""
        if not self._has_branches:
            return [[step] for step in self._chart.steps]
        graph = marking_graph(self._chart, cap=_MOST_SITUATIONS)
        found = [*graph] if self.leaves_branches and graph.complete and graph.safe is Answer.YES else []
        if any(one & other == one for one in found for other in found if one != other):
            return []  # a transition that leaves one situation would be enabled in the other
        return [[step.step for step in graph.net.steps if step.bit & marking] for marking in found]

    def _is_declared(self, flag: SfcFlag) -> bool:
        return any(each.name.casefold() == flag.variable.casefold() for each in self._place.pou.variables())

    def _is_known(self, flag: SfcFlag) -> bool:
        """True if the POU declares a flag, or a global variable has its name."""
        return flag.variable.casefold() in names_around(self._place.pou)

    def _held_by(self, flag: SfcFlag) -> list[int]:
        """Return the ids of the transitions that do not fire while a flag is TRUE, and that others do not precede."""
        is_any = flag not in ENDING or self._has_branches
        return [each.id for each in self._chart.transitions if is_any or self._initial.id in each.sources]

    @property
    def _initial(self) -> Step:
        return next(step for step in self._chart.steps if step.initial)

    # -- the chart

    def _execute(self, flags: Collection[SfcFlag]) -> None:
        for flag in (flag for flag in flags if not self._is_declared(flag)):
            self._declare(flag.variable)
        steps, situations = list(self._chart.steps), self._situations()
        has_branches = self._has_branches
        again = self._initial
        if SfcFlag.RESET in flags:
            again = self._beginning()
        self._hold(flags, again, all_wait=has_branches and not ENDING.isdisjoint(flags))
        wanted = {SfcFlag.INIT: self._init, SfcFlag.RESET: self._reset}
        begins = [text for flag, text in wanted.items() if flag in flags]
        self.ends = [*begins]
        if SfcFlag.INIT in flags and self._has_rest:
            begins.remove(self._init)
            rest = self._rest(flags)
            for active in situations if again in steps else [*situations, [again]]:
                self._lead(active, rest, self._init)
        for active in (active for active in situations if active != [again] and begins):
            ids = [step.id for step in active]
            if any(each.sources == ids and each.targets == [again.id] for each in self._chart.transitions):
                why = "the transition of the flags to the initial step is another one"
                self._note(Outcome.TRANSLATED, "order of transitions", f"step {active[0].name}", why)
            self._lead(active, again, " OR ".join(begins))
        self._report_ends([flag for flag in flags if flag in ENDING], steps)

    def _beginning(self) -> Step:
        """Return the step to which SFCReset leads."""
        self._firsts = {self._initial.id}
        return self._initial

    @property
    def _has_rest(self) -> bool:
        """True if the initial step executes something, so that SFCInit activates another one that does nothing."""
        initial = self._initial
        return any((initial.actions, initial.entry_action, initial.main_action, initial.exit_action))

    def _rest(self, flags: Collection[SfcFlag]) -> Step:
        why = "it is active instead of the initial step, and does nothing"
        rest = self._added_step(f"{SfcFlag.INIT.variable}_holds", why)
        self._lead([rest], self._initial, all_of([f"NOT {self._init}", self._goes_on(flags)]))
        return rest

    def _goes_on(self, flags: Collection[SfcFlag]) -> str:
        """Return when SFCPause does not stop the chart while SFCInit is FALSE; empty where it is no flag."""
        if not self._pause:
            return ""
        return f"NOT {self._pause}" + (f" OR {self._reset}" if SfcFlag.RESET in flags else "")

    def _hold(self, flags: Collection[SfcFlag], again: Step, *, all_wait: bool) -> None:
        """Let transitions not fire while a flag is TRUE, and as CODESYS tests them afterwards.

        SFCReset leads to the step `again`, the initial one or another in its place. `all_wait`: a transition of the
        flags leaves several steps, and precedes no transition that leaves one of them.

        CODESYS executes actions before it tests transitions: after a scan without either it tests none before it has
        executed actions again, and the transition that it found before a pause fires behind that.
        """
        waits = ""
        if self._pause:
            stronger = {SfcFlag.INIT: self._init, SfcFlag.RESET: self._reset}
            others = [f"NOT {text}" for flag, text in stronger.items() if flag in flags]
            self.stops = self._memory("SFC_stops")
            waits = self._memory(f"{SfcFlag.PAUSE.variable}_before")
            self.lines.append(f"{self.stops} := {all_of([self._pause, *others])};")
        stops = self.stops
        rises = SfcFlag.INIT in flags and not self._has_rest
        init = self._memory(f"{SfcFlag.INIT.variable}_before") if rises else ""
        tips = not _TIPPING.isdisjoint(flags)
        pushed, watching = self._pushed(flags, stops)
        for transition in list(self._chart.transitions):
            is_first = not {self._initial.id, again.id}.isdisjoint(transition.sources)
            text = self._texts[transition.id] or "TRUE"
            is_never = transition.exclude or (text == "FALSE" and not pushed)
            if is_never or not (stops or is_first or tips or all_wait):
                continue
            text = all_of([text, f"NOT {self._tip_mode}" if SfcFlag.TIP_MODE in flags else ""])
            text = f"({text}) OR ({pushed})" if pushed else text
            fires = [text, *(f"NOT {each}" for each in (waits, init if is_first or stops else "") if each)]
            condition = all_of(fires)
            if stops:
                left, entered = (
                    [step for step in self._chart.steps if step.id in ends]
                    for ends in (transition.sources, transition.targets)
                )
                # not by its own name: the target may give it one, and the file come back with that
                found = self._memory(f"{_together(left)}_to_{_together(entered)}_waits")
                now = all_of([*map(self._host.active, left), *fires])
                self.lines.append(f"{found} := {stops} AND (({waits} AND {found}) OR ({now}));")
                condition = all_of([f"({condition}) OR ({waits} AND {found})", f"NOT {self._pause}"])
            if is_first or all_wait:
                is_ended = rises or (all_wait and SfcFlag.INIT in flags)
                held = [self._init] * is_ended + [self._reset] * (SfcFlag.RESET in flags)
                condition = all_of([condition, *(f"NOT {text}" for text in held)])
            self._put(transition, condition)
        # the memories are written last: the lines above need those of the scan before
        self.lines += watching
        if waits:
            self.lines.append(f"{waits} := {stops};")
        if init:
            self.lines.append(f"{init} := {self._init};")
        if not ENDING.isdisjoint(flags):
            self._end_stored(flags)

    def _pushed(self, flags: Collection[SfcFlag], stops: str) -> tuple[str, list[str]]:
        """Return the edge of SFCTip, empty where it is no flag, and the statements for its memory.

        CODESYS looks for it where it tests transitions, which it does behind scans with actions only.
        """
        if SfcFlag.TIP not in flags:
            return "", []
        before, tests = self._memory(f"{SfcFlag.TIP.variable}_before"), self._memory("SFC_tests")
        stopped = [f"NOT {text}" for text in (stops, self._init if SfcFlag.INIT in flags else "") if text]
        return f"{self._tip} AND NOT {before}", [
            f"{before} := ({tests} AND {self._tip}) OR ({before} AND NOT {tests});",
            f"{tests} := {all_of(stopped)};",
        ]

    def _is_pushed_inside(self) -> bool:
        """True if code of the POU itself writes SFCTip."""
        flag = path_of(parse_expression(self._tip, self._dialect).tree)
        return flag in Effects.all(body.code for body in self._bodies).writes

    def _memory(self, wish: str) -> str:
        """Declare a Boolean variable that the source does not have; return its name in texts."""
        return self._declare(self._rewriting.new_name(wish))

    # -- what differs

    def _report_ends(self, flags: Collection[SfcFlag], steps: list[Step]) -> None:
        """Report the actions as a flag ends a step, and those of the initial step that do not begin again."""
        words = " and ".join(flag.variable for flag in flags)
        for step in steps if flags else ():
            if self._is_executed_at_end(step):
                why = f"what it executes when it is left is executed when {words} ends it too, in CODESYS it is not"
                self._note(Outcome.APPROXIMATED, "end of the step", f"step {step.name}", why)
        initial = self._initial
        is_plain = all(row.qualifier in _LASTING for row in initial.actions)
        if SfcFlag.RESET in flags and not (is_plain and not initial.entry_action and not self._is_read(initial, "t")):
            why = f"{SfcFlag.RESET.variable} does not begin it again where it is active already"
            self._note(Outcome.APPROXIMATED, "initial step", f"step {initial.name}", why)
        if SfcFlag.INIT in flags and self._is_read(initial, "t"):
            why = f"its time does not begin again while {SfcFlag.INIT.variable} is TRUE"
            self._note(Outcome.APPROXIMATED, "step time", f"step {initial.name}", why)
        if SfcFlag.INIT in flags and self._has_rest:
            self._hide(initial, f"while {SfcFlag.INIT.variable} is TRUE")

    def _hide(self, initial: Step, when: str) -> None:
        """Report that another step is active in place of the initial one."""
        place, why = f"step {initial.name}", f"its flag is FALSE {when}, in CODESYS it is TRUE"
        if self._is_read(initial, "x"):
            self._note(Outcome.APPROXIMATED, "step flag", place, why)
        else:
            self._note(Outcome.TRANSLATED, HIDDEN_FLAG, place, f"{why}; nothing of the block reads it")

    # -- what is executed

    def _statements(self, found: Body | str | None) -> StBody | None:
        """Return the statements of a step action; None where it has none."""
        body = self._body_of(found)
        return body if isinstance(body, StBody) else None

    def _body_of(self, code: Body | str | None) -> Body | None:
        """Return what executes an action of a step, also one of the POU by its name."""
        if not isinstance(code, str):
            return code
        action = self._place.pou.find_action(without_signs(code))
        return action.body if action is not None else None

    def _text_of(self, row: ActionAssociation) -> StBody | None:
        """Return the statements that a row executes, and nothing else does; None where there are none."""
        if row.target is None:
            return row.body if isinstance(row.body, StBody) else None
        action, name = self._place.pou.find_action(without_signs(row.target)), row.target.casefold()
        charts = [body.chart for _, _, body in self._place.pou.named_bodies() if isinstance(body, SfcBody)]
        others = [row for chart in charts if chart is not self._chart for _, row in chart.associations()]
        is_used = any((each.target or "").casefold() == name for each in others)
        is_used |= (without_signs(name),) in self._called
        return action.body if action is not None and isinstance(action.body, StBody) and not is_used else None

    def _runners(self, wanted: StBody) -> list[tuple[Step, ActionAssociation]]:
        """Return the rows that execute a body."""
        return [found for found in self._chart.associations() if self._text_of(found[1]) is wanted]

    def _is_left(self, rows: list[tuple[Step, ActionAssociation]], ends: str) -> str:
        """Return when statements are executed that a flag does not end; empty where rows store them."""
        if not all(row.qualifier in _ACTIVE | PULSES for _, row in rows):
            return ""
        steps = {step.id: step for step, row in rows if row.qualifier is not Qualifier.P0}
        return " OR ".join([*map(self._host.active, steps.values()), f"NOT ({ends})" if " " in ends else f"NOT {ends}"])

    @abstractmethod
    def _is_executed_at_end(self, step: Step) -> bool:
        """True if a step executes something when it is left that does not ask the flags."""

    def _guard(self, flags: Collection[SfcFlag]) -> None:
        """Let statements not run where a flag ends their step, or stops the chart."""
        ends, runs = " OR ".join(self.ends), self._goes_on(flags)
        bodies = {id(body): body for _, row in self._chart.associations() if (body := self._text_of(row)) is not None}
        changed: set[int] = set()
        for body in bodies.values():
            rows = self._runners(body)
            if all(row.qualifier is Qualifier.P1 for _, row in rows):  # once, when nothing stops or ends the step
                continue
            is_kept = SfcFlag.INIT not in flags and all(step.id in self._firsts for step, _ in rows)
            text = _guarded(body.text, [runs, self._is_left(rows, ends) if ends and not is_kept else ""])
            if text == body.text:
                continue
            if rows[0][1].target is not None:
                self._mark_text(body, text)
                for step, row in rows:
                    why = "its statements ask the SFC flags of the chart"
                    place = f"step {step.name} / action {without_signs(row.target or '')}"
                    self._note(Outcome.TRANSLATED, "action", place, why)
            else:
                changed |= {step.id for step, _ in rows}
            body.text = text
        for step in self._chart.steps:
            for kind, needed in (("main", runs), ("exit", f"NOT ({ends})" if ends else "")):
                body = self._statements(getattr(step, f"{kind}_action")) if needed else None
                if body is not None:
                    setattr(step, f"{kind}_action", StBody(text=_guarded(body.text, [needed])))
                    changed.add(step.id)
            if step.id in changed:
                self._mark_step(step)

    @abstractmethod
    def _mark_text(self, body: StBody, text: str) -> None:
        """Keep the statements of an action for the way back, which become `text`."""

    @abstractmethod
    def _mark_step(self, step: Step) -> None:
        """Keep the actions of a step for the way back, which are others now."""

    def _is_read(self, step: Step, member: str) -> bool:
        """True if a text of the POU names data of a step, or its minimum time asks for its time."""
        path = (step.name.casefold(),)
        named = (each for body in self._bodies for each in body.uses if each.name.casefold() == member)
        is_named = any(each.base is not None and path_of(each.base) == path for each in named)
        return is_named or (member == "t" and step.id in self._timed)


def is_code(chart: Chart, row: ActionAssociation) -> bool:
    """True if an association executes statements, and does not drive an operand."""
    is_named = row.target is not None and (
        chart.pou.find_action(without_signs(row.target)) is not None or "." in row.target
    )
    return row.body is not None or row.value is not None or is_named


def _guarded(text: str, terms: list[str]) -> str:
    return "\n".join(guarded(all_of(terms), text.strip().splitlines())) if any(terms) else text


def _together(steps: Sequence[Step]) -> str:
    return "_".join(step.name for step in steps)
