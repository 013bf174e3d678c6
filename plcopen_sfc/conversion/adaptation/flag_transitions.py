"""SFC flags of CODESYS as transitions of charts of tools without such variables: S7-GRAPH, and TC6 (`flags_in_tc6`).

SFCInit holds a chart in its initial step, of which nothing is executed; SFCReset begins it again there, and keeps its
transitions from firing; SFCPause stops it; SFCTipMode keeps transitions from firing, and an edge of SFCTip fires those
that are enabled. A block of S7-GRAPH has INIT_SQ and T_PUSH, but for its caller only; TC6 has nothing of the kind. So
the flags are conditions: of
transitions that are tried before all others, to the initial step and to one that does nothing, and of those that the
chart has (`plcopen_sfc.semantics.charts.sfc_flags`, and the tests compare both). Where several steps may be active at a
time, one transition leaves all that are active together, for each situation. A block of S7-GRAPH cannot have these.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Sequence

from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.conversion.adaptation.chart_rewriting import (
    GRAPH_CHARTS,
    ChartRewriting,
    all_of,
    flags_in_use,
    names_around,
    taken_names,
)
from plcopen_sfc.conversion.executed_parts import HIDDEN_FLAG, told_flag
from plcopen_sfc.formats.format_interface import SOURCE_CHART_FIELD, WriteOptions, may_have
from plcopen_sfc.formats.plcopen.source_marks import SourceMarks
from plcopen_sfc.languages.binding import Effects, Names, bind
from plcopen_sfc.languages.effects import may_change, path_of
from plcopen_sfc.languages.networks import draw_ld
from plcopen_sfc.languages.sfc_flag_uses import flags_at_rest, named_flags
from plcopen_sfc.languages.st import parse_expression, parse_statements
from plcopen_sfc.languages.st.literals import TIME_RANGES, time_literal
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.chart_settings import WATCHING_FLAGS, SfcFlag
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import ActionAssociation, PermanentOperation, Step, Transition
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import ConversionReport, Outcome

_LONGEST = time_literal(TIME_RANGES[Dialect.SCL, "TIME"][1], Dialect.SCL)
"""The time of a timer that goes on."""
_FIRST = 0
"""The priority of what is tried before all other transitions."""
_STORING = frozenset({Qualifier.SD, Qualifier.DS, Qualifier.SL})
_STORED = frozenset({Qualifier.S, Qualifier.R, Qualifier.R0})
_LASTING = _STORED | {Qualifier.N, Qualifier.NONE}
_WITH_FINAL_SCAN = frozenset({Qualifier.N, Qualifier.NONE, Qualifier.P})
_WITHOUT = {
    SfcFlag.CURRENT_STEP: "it has S_NO, the number of the step",
}
"""Why flags have no effect in a block of S7-GRAPH."""
_TIPPING = frozenset({SfcFlag.TIP, SfcFlag.TIP_MODE})
_ENDING = frozenset({SfcFlag.INIT, SfcFlag.RESET})
_STOPPING = frozenset({SfcFlag.PAUSE, SfcFlag.QUIT_ERROR})
_OBEYED = _TIPPING | _ENDING | {SfcFlag.PAUSE}
_BRANCHES = "several of its steps may be active at a time, which no transition leaves together"
_MOST_SITUATIONS = 32
"""The most situations for which there is a transition each."""
_ENDED = "actions that it ends, stored or delayed ones, go on there"


def has_flags(project: Project, options: WriteOptions) -> bool:
    """True if `execute_flags` changes or reports something of a project."""
    is_known = may_have(options.source, SOURCE_CHART_FIELD) if options.same else options.of_codesys
    return is_known and any(map(flags_in_use, project.charts()))


def execute_flags(
    project: Project, source: Project, options: WriteOptions, report: ConversionReport, marks: SourceMarks
) -> None:
    """Change the charts of `project`, a copy of `source` in SCL, so that conditions obey their flags."""
    named = named_flags(Names(source))
    for chart, before in zip(list(project.charts()), list(source.charts()), strict=True):
        flags = frozenset(flag for flag in flags_in_use(chart) if flag.variable.upper() not in options.at_rest)
        resting = flags_at_rest(source, before.pou, flags, named)
        taken = taken_names(project, chart)
        rewriting = ChartRewriting(chart, before.chart, GRAPH_CHARTS, options, report, marks, taken)
        rewriter = _GraphFlags(rewriting, resting)
        if not rewriter.rewrite(flags - WATCHING_FLAGS):
            continue
        marks[id(chart.chart)] = {"lines": rewriter.lines, "ends": rewriter.ends}
        if chart.chart is chart.pou.chart:
            marks[id(chart.chart)][SOURCE_CHART_FIELD] = before.chart
        else:
            marks.setdefault(id(chart.pou), {})["actions"] = before.pou.actions


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
        self._timed = {step.id: step.min_time for step in self._chart.steps if step.min_time}

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
            self._execute(executed)
        return frozenset(executed)

    # -- what the target has

    def _declare(self, name: str) -> str:
        """Declare a Boolean variable that the source does not have; its name in texts."""
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
        if flag in _ENDING and self._has_branches and not self._situations():
            return _BRANCHES
        held = self._held_by(flag)
        if any(self._texts[number] is None for number in held):
            return "a condition that would obey it is no expression"
        if flag in _ENDING:
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
        is_any = flag not in _ENDING or self._has_branches
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
        self._hold(flags, again, all_wait=has_branches and not _ENDING.isdisjoint(flags))
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
        self._report_ends([flag for flag in flags if flag in _ENDING], steps)

    def _beginning(self) -> Step:
        """Return the step to which SFCReset leads."""
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
        stops, waits = "", ""
        if self._pause:
            stronger = {SfcFlag.INIT: self._init, SfcFlag.RESET: self._reset}
            others = [f"NOT {text}" for flag, text in stronger.items() if flag in flags]
            stops = self._memory("SFC_stops")
            waits = self._memory(f"{SfcFlag.PAUSE.variable}_before")
            self.lines.append(f"{stops} := {all_of([self._pause, *others])};")
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
                found = self._memory(f"{self._chart.label(transition).replace(' -> ', '_to_')}_waits")
                left = [step for step in self._chart.steps if step.id in transition.sources]
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
        if not _ENDING.isdisjoint(flags):
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
        """Declare a Boolean variable that the source does not have; its name in texts."""
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

    def _is_executed_at_end(self, step: Step) -> bool:
        """True if a step executes something when it is left, however it is left."""
        last = [row for row in step.actions if row.qualifier in _WITH_FINAL_SCAN and is_code(self._place, row)]
        return bool(step.exit_action or last or any(row.qualifier is Qualifier.P0 for row in step.actions))

    def _is_read(self, step: Step, member: str) -> bool:
        """True if a text of the POU names data of a step, or its minimum time asks for its time."""
        path = (step.name.casefold(),)
        named = (each for body in self._bodies for each in body.uses if each.name.casefold() == member)
        is_named = any(each.base is not None and path_of(each.base) == path for each in named)
        return is_named or (member == "t" and step.id in self._timed)


class _GraphFlags(FlagRewriter):
    """Rewrites one chart for a block of S7-GRAPH."""

    obeyed = FlagRewriter.obeyed | {SfcFlag.QUIT_ERROR}
    prefix = "#"

    def _execute(self, flags: Collection[SfcFlag]) -> None:
        if not _ENDING.isdisjoint(flags):
            self._wait()
        super()._execute(flags)
        if SfcFlag.QUIT_ERROR in flags:
            self._quit()

    def _quit(self) -> None:
        """Let SFCQuitError reset SFCError, which is not set before a maximum time has passed since then."""
        quits, error = f"#{SfcFlag.QUIT_ERROR.variable}", SfcFlag.ERROR.variable
        for step in self._chart.steps:
            if self._is_read(step, "t"):
                why = f"{SfcFlag.QUIT_ERROR.variable} does not let it begin again, which it does in CODESYS"
                self._note(Outcome.APPROXIMATED, "step time", f"step {step.name}", why)
        if SfcFlag.ERROR not in flags_in_use(self._place):
            return
        before, enable = self._memory(f"{SfcFlag.QUIT_ERROR.variable}_before"), SfcFlag.ENABLE_LIMIT
        is_held = f" OR ({before} AND {self._pause})" if self._pause != quits else ""
        self.lines += [f"IF {quits} THEN #{error} := FALSE; END_IF;", f"{before} := {quits}{is_held};"]
        watches = [f"#{enable.variable}"] * (enable in flags_in_use(self._place))
        for step in (each for each in self._chart.steps if each.max_time):
            timer = self._rewriting.new_variable(f"{step.name}_watch", DerivedType(name="TON"))
            late = all_of([*watches, f"#{timer}.ET > {step.max_time}"])
            self.lines += [
                f"#{timer}(IN := {self._host.active(step)} AND NOT {before}, PT := {_LONGEST});",
                f"IF {late} THEN #{error} := TRUE; END_IF;",
            ]
            why = f"the timer {timer} sets {error}, which counts whole milliseconds and begins again behind {quits[1:]}"
            self._note(Outcome.APPROXIMATED, "max time", f"step {step.name}", why)
            step.max_time = None

    def _wait(self) -> None:
        """Let the transitions of the chart wait for minimum times, which those of flags do not."""
        for step in (step for step in self._chart.steps if step.id in self._timed):
            least = f"{self._host.elapsed(step)} >= {step.min_time}"
            step.min_time = None
            for transition in (each for each in self._chart.transitions if step.id in each.sources):
                self._texts[transition.id] = text = all_of([self._texts[transition.id] or "TRUE", least])
                transition.condition = Expression(text=text)
            why = f"the transitions that leave the step wait for {least}"
            self._note(Outcome.TRANSLATED, "min time", f"step {step.name}", why)

    def _refused_end(self) -> str | None:
        waiting = [each for each in self._chart.transitions if not self._timed.keys().isdisjoint(each.sources)]
        if any(self._texts[each.id] is None for each in waiting):
            return "a condition that waits for a minimum time is no expression"
        rows = [row for _, row in self._chart.associations()]
        controlled, stored = self._controlled(), self._stored()
        others = [row for row in rows if (row.target or "").casefold() in stored and row.qualifier not in _STORED]
        names = {*controlled, *stored}
        is_code = any(self._place.pou.find_action(_bare(name)) for name in names)
        if others or is_code or any(row.target is None and row.qualifier in _STORING for row in rows):
            return _ENDED
        is_begun = any((row.target or "").casefold() in controlled for row in self._initial.actions)
        return _ENDED if is_begun or (stored and self._has_rest) or self._is_written(names) else None

    def _controlled(self) -> set[str]:
        """Return the operands, in lower case, of which networks behind the sequence control the storing and delays."""
        rows = [row for _, row in self._chart.associations() if row.qualifier in _STORING and row.target]
        return {row.target.casefold() for row in rows if row.target is not None}

    def _stored(self) -> dict[str, str]:
        """Return the operands that rows store, by their names in lower case."""
        rows = [row for _, row in self._chart.associations() if row.qualifier is Qualifier.S and row.target]
        found = {row.target.casefold(): row.target for row in rows if row.target is not None}
        return {key: name for key, name in found.items() if key not in self._controlled()}

    def _is_written(self, names: Iterable[str]) -> bool:
        """True if code of the POU may write one of these operands, as code that cannot be read may."""
        operands = frozenset(path_of(parse_expression(name, Dialect.SCL).tree) for name in names)
        written = Effects.all(body.code for body in self._bodies).writes
        is_unknown = any(body.unknown for body in self._bodies)
        return bool(operands) and (is_unknown or may_change(operands, written, frozenset()))

    def _refused_quit(self) -> str | None:
        is_input = any(v.name.casefold() == "sfcerror" for v in self._place.pou.variables(SectionKind.INPUT))
        return "SFCError is an input" if is_input else None

    def _refusal(self, flag: SfcFlag) -> str | None:
        return super()._refusal(flag) or (self._refused_quit() if flag is SfcFlag.QUIT_ERROR else None)

    def _refused_pause(self) -> str | None:
        for step, row in self._chart.associations():
            if row.qualifier not in _LASTING or is_code(self._place, row) or row.condition is not None:
                return f"the actions of the step {step.name} go on there"
        for step in self._chart.steps:
            if step.entry_action or step.main_action or step.exit_action:
                return f"the actions of the step {step.name} go on there"
        return None

    def _pushed(self, flags: Collection[SfcFlag], stops: str) -> tuple[str, list[str]]:
        edge, lines = super()._pushed(flags, stops)
        if not lines or not self._is_pushed_inside():
            return edge, lines
        # Rows are executed behind the transitions. A memory that is set behind the rows would take what they write for
        # tested already: so it is set where it is tested, in the next cycle.
        pushed, (tested, *others) = self._memory(f"{SfcFlag.TIP.variable}_pushed"), lines
        drawn = draw_ld(parse_statements(f"{pushed} := {edge}; {tested}", Dialect.SCL).tree.statements)
        self._chart.permanent_pre.append(PermanentOperation(body=drawn.body))
        self._note(Outcome.TRANSLATED, "permanent instruction before the sequence", "", "it tests SFCTip")
        return pushed, others

    def _end_stored(self, flags: Collection[SfcFlag]) -> None:
        """Let what actions store end where a flag ends it."""
        if not self._stored():
            return
        ends = [self._init] * (SfcFlag.INIT in flags)
        if SfcFlag.RESET in flags:
            before = self._memory(f"{SfcFlag.RESET.variable}_before")
            ends.append(f"({self._reset} AND NOT {before})")
        for name in self._stored().values():
            self.lines.append(f"IF {' OR '.join(ends)} THEN {name} := FALSE; END_IF;")
        if SfcFlag.RESET in flags:
            self.lines.append(f"{before} := {self._reset};")

    def _added_step(self, wish: str, why: str) -> Step:
        step = self._chart.add_step(self._rewriting.new_name(wish))
        self._note(Outcome.TRANSLATED, "step", f"step {step.name}", why)
        return step

    def _lead(self, sources: Sequence[Step], target: Step, condition: str) -> None:
        added = self._chart.add_transition(sources, target, Expression(text=condition), priority=_FIRST)
        added.name = self._rewriting.new_name(f"{sources[0].name}_to_{target.name}")
        why = "it replaces an SFC flag, and is tried before the others"
        self._note(Outcome.TRANSLATED, "transition", f"transition {added.name}", why)


def is_code(chart: Chart, row: ActionAssociation) -> bool:
    """True if an association executes statements, and does not drive an operand."""
    is_named = row.target is not None and (chart.pou.find_action(_bare(row.target)) is not None or "." in row.target)
    return row.body is not None or row.value is not None or is_named


def _bare(name: str) -> str:
    return name.removeprefix("#").strip('"')
