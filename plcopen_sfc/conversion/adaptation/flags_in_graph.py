"""SFC flags of CODESYS in blocks of S7-GRAPH: conditions, and networks and statements that ask the flags.

What S7-GRAPH does with an operand while a step is active goes on in every cycle. So where a flag stops the chart, what
is delayed or executed once is no row, but a network that keeps its value meanwhile; and the flags that end a step reset
what networks store.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from plcopen_sfc.conversion.adaptation.chart_rewriting import (
    GRAPH_CHARTS,
    ChartRewriting,
    all_of,
    flags_in_use,
    taken_names,
)
from plcopen_sfc.conversion.adaptation.flag_transitions import ENDING, PULSES, FlagRewriter, is_code
from plcopen_sfc.formats.format_interface import SOURCE_CHART_FIELD, WriteOptions, may_have
from plcopen_sfc.formats.plcopen.source_marks import SourceMarks
from plcopen_sfc.languages.binding import BoundBody, Effects, Names, bind
from plcopen_sfc.languages.effects import may_change, path_of
from plcopen_sfc.languages.networks import draw_ld
from plcopen_sfc.languages.sfc_flag_uses import flags_at_rest, named_flags
from plcopen_sfc.languages.st import parse_expression, parse_statements
from plcopen_sfc.languages.st.literals import TIME_RANGES, time_literal
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.chart_settings import WATCHING_FLAGS, SfcFlag
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, PermanentOperation, Step
from plcopen_sfc.model.text import without_signs
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import ORDER_OF_ACTIONS, ConversionReport, Outcome

_LONGEST = time_literal(TIME_RANGES[Dialect.SCL, "TIME"][1], Dialect.SCL)
"""The time of a timer that goes on."""
_FIRST = 0
"""The priority of what is tried before all other transitions."""
_STORING = frozenset({Qualifier.SD, Qualifier.DS, Qualifier.SL})
_STORED = frozenset({Qualifier.S, Qualifier.R, Qualifier.R0})
_IN_ROWS = frozenset({Qualifier.N, Qualifier.NONE, Qualifier.P0})
"""Qualifiers of statements that rows execute, and once more or only at the end of a step."""
_ENDED = "actions that it ends, stored or delayed ones, go on there"


def has_flags(project: Project, options: WriteOptions) -> bool:
    """True if `execute_flags_in_graph` changes or reports something of a project."""
    is_known = may_have(options.source, SOURCE_CHART_FIELD) if options.same else options.of_codesys
    return is_known and any(map(flags_in_use, project.charts()))


def execute_flags_in_graph(
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
        marks[id(chart.chart)] = {"lines": rewriter.lines, "ends": rewriter.ends, "stops": rewriter.stops}
        if chart.chart is chart.pou.chart:
            marks[id(chart.chart)][SOURCE_CHART_FIELD] = before.chart
        if chart.chart is not chart.pou.chart or rewriter.has_other_actions:
            marks.setdefault(id(chart.pou), {})["actions"] = before.pou.actions


class _GraphFlags(FlagRewriter):
    """Rewrites one chart for a block of S7-GRAPH."""

    obeyed = FlagRewriter.obeyed | {SfcFlag.QUIT_ERROR}
    prefix = "#"
    has_other_actions = False
    """True if statements of actions of the POU ask the flags."""

    def _execute(self, flags: Collection[SfcFlag]) -> None:
        if not ENDING.isdisjoint(flags):
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
        if others or any(row.target is None and row.qualifier in _STORING for row in rows):
            return _ENDED
        begun = self._initial.actions
        is_begun = any(row.qualifier in _STORING or (row.target or "").casefold() in controlled for row in begun)
        is_written = self._is_written(stored, self._bodies)
        return _ENDED if is_begun or (stored and self._has_rest) or is_written else None

    def _controlled(self) -> dict[str, str]:
        """Return the operands of which networks control the storing and delays, by their names in lower case."""
        return self._operands(_STORING)

    def _stored(self) -> dict[str, str]:
        """Return the operands that rows store, by their names in lower case."""
        controlled = self._controlled()
        return {key: name for key, name in self._operands({Qualifier.S}).items() if key not in controlled}

    def _operands(self, qualifiers: Collection[Qualifier]) -> dict[str, str]:
        """Return the operands of rows with these qualifiers, as far as these execute no statements."""
        rows = [row for _, row in self._chart.associations() if row.qualifier in qualifiers]
        rows = [row for row in rows if row.target and not is_code(self._place, row)]
        return {row.target.casefold(): row.target for row in rows if row.target is not None}

    def _is_written(self, names: Iterable[str], bodies: Iterable[BoundBody]) -> bool:
        """True if code may write one of these operands, as code that cannot be read may."""
        operands = frozenset(path_of(parse_expression(name, Dialect.SCL).tree) for name in names)
        found = list(bodies)
        written = Effects.all(body.code for body in found).writes
        is_unknown = any(body.unknown for body in found)
        return bool(operands) and (is_unknown or may_change(operands, written, frozenset()))

    def _report_ends(self, flags: Collection[SfcFlag], steps: list[Step]) -> None:
        super()._report_ends(flags, steps)
        begun = [self._body_of(code) for code in (self._initial.entry_action, self._initial.main_action) if code]
        begun += [self._body_of(row.target or row.body) for row in self._initial.actions if is_code(self._place, row)]
        bound = [bind(body, self._dialect) for body in begun if body is not None]
        names = [name for name in self._controlled().values() if self._is_written([name], bound)]
        if SfcFlag.RESET in flags and names:
            what = ", ".join(map(without_signs, names))
            why = f"{SfcFlag.RESET.variable} ends {what} behind what the initial step writes, in CODESYS before it"
            self._note(Outcome.APPROXIMATED, ORDER_OF_ACTIONS, "", why)

    def _is_executed_at_end(self, step: Step) -> bool:
        # statements that others execute, too, do not ask the flags; networks end all other actions
        rows = [row for row in step.actions if row.qualifier in _IN_ROWS and is_code(self._place, row)]
        bodies = [self._body_of(row.target or row.body) for row in rows if self._text_of(row) is None]
        is_told = any(body is None or isinstance(body, StBody) for body in bodies)
        return is_told or (step.exit_action is not None and self._statements(step.exit_action) is None)

    def _refusal(self, flag: SfcFlag) -> str | None:
        inputs = {variable.name.casefold() for variable in self._place.pou.variables(SectionKind.INPUT)}
        own = "SFCError is an input" if flag is SfcFlag.QUIT_ERROR and "sfcerror" in inputs else None
        return super()._refusal(flag) or own

    def _refused_pause(self) -> str | None:
        for step, row in self._chart.associations():
            if row.condition is not None or not self._can_stop(row):
                return f"the actions of the step {step.name} go on there"
        for step in self._chart.steps:
            if step.main_action is not None and self._statements(step.main_action) is None:
                return f"the actions of the step {step.name} go on there"
        return None

    def _can_stop(self, row: ActionAssociation) -> bool:
        """True if what a row executes stops: a network behind the sequence keeps it, or its statements ask the flag.

        What is executed once is, as a step begins or ends, when nothing stops the chart.
        """
        if not is_code(self._place, row):
            return row.value is None and row.target is not None
        body = self._body_of(row.target if row.target is not None else row.body)
        is_single = self._text_of(row) is not None or not isinstance(body, StBody)
        return body is not None and (row.qualifier in PULSES or is_single)

    def _mark_text(self, body: StBody, text: str) -> None:  # noqa: ARG002
        self.has_other_actions = True

    def _mark_step(self, step: Step) -> None:
        """Keep nothing: the chart of the source is kept as a whole."""

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
