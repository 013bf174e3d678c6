"""Single charts of a conversion, run against their results under the rules of both tools."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from plcopen_sfc.conversion.causes import told_apart, told_difference
from plcopen_sfc.conversion.scan_order import calls_charts, is_begun_again, is_begun_for_good, may_race, reads_inputs
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.binding import names_in
from plcopen_sfc.languages.binding.name_scopes import with_inner_charts
from plcopen_sfc.languages.st.literals import time_literal
from plcopen_sfc.languages.task_schedules import nanoseconds, schedule_of
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.types import ElementaryType
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import ConversionReport, Item
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.variable_use import ALL_FREE
from plcopen_sfc.whole_numbers import counted

if TYPE_CHECKING:
    from plcopen_sfc.analysis.verdict import Counterexample, Verdict

_SCAN_TIME = 10_000_000
"""Nanoseconds of a scan where no task of the source declares its interval."""

IN_IT = "what the report names as approximated is in it"
SHIFTED = "the same but for the inputs and times that actions see, and the first scan"
"""Part of the verdict on a chart that does the same in both tools if its actions get the same inputs."""


class ChartRun(NamedTuple):
    """A chart of the source that was run against its result.

    `verdict`: what was found; `as_run`: the same with a constant delay only, where that is another question. `unseen`:
    what was not run as it is, in words. `stays`: how a chart that differs compares in what stays, in words.
    """

    chart: Chart
    verdict: Verdict
    as_run: Verdict
    profiles: tuple[Profile, Profile]
    tool: str
    unseen: str = ""
    stays: str = ""

    @property
    def seen(self) -> list[str]:
        """The verdict in one short line, and what it rests on."""
        example = self.as_run.counterexample
        if example is None or not self.verdict.equal:
            given = [f"given: {self.unseen}"] if self.unseen else []
            return [self.as_run.summary, *self.as_run.premises, *given]
        head = f"different after {counted(len(example.inputs), 'scan')}; {SHIFTED}"
        other = self.as_run.scan_time != self.verdict.scan_time
        given = [f"given: for the difference scans of {time_literal(self.as_run.scan_time)}"] if other else []
        return [head, f"but for these: {self.verdict.summary}", *self.verdict.premises, *given]

    def told_with(self, losses: Sequence[Item], rules: Sequence[str]) -> list[str]:
        """Return the verdict on a chart in which the report names something as approximated; see `told`."""
        example = self.as_run.counterexample
        if example is None:
            told = self.seen
        elif self.verdict.equal:
            told = [*self.seen, *told_apart(example, self.chart, self.profiles, self.tool)]
        else:
            told = self.told(example, losses, rules)
        return [*told, IN_IT]

    def told(self, example: Counterexample, losses: Sequence[Item], rules: Sequence[str] = ()) -> list[str]:
        """Return a difference in words, with its cause: the `rules` of tools where some are given."""
        return told_difference(example, self.chart, losses, self.profiles, self.tool, rules=rules)


class ComparedChart(NamedTuple):
    """A chart of the source to be run, and where its verdict goes."""

    report: ConversionReport
    chart: Chart
    source: Project
    profiles: tuple[Profile, Profile]
    tool: str

    def ask(self, compare: Callable[..., Verdict], *subjects: Any, **options: Any) -> Verdict:
        """Compare the chart. An interruption ends that of all charts, with what is known of this one."""
        found = compare(*subjects, **options)
        if found.interrupted:
            if self.chart.report_path not in self.report.compared:
                self.note_untested(*str(found).splitlines())
            raise KeyboardInterrupt
        return found

    def run_with_commands(
        self, compared: Callable[..., Verdict], renamed: Mapping[str, str], end: float
    ) -> tuple[ChartRun, Callable[..., Verdict], list[str]] | None:
        """Run the chart, and once more with what only commands from outside reach; None where it cannot be run.

        `renamed`: names in the source of variables of the result. Also returned are how it was compared, and what that
        rests on, in words.
        """
        run = self.run(compared, end - time.thread_time())
        if run is None:
            return None
        self.note(*run.seen)
        commands = _asked_in_vain(self.chart, self.source, run.as_run)
        if not commands:
            return run, compared, []
        others = [name for name, old in renamed.items() if old in commands]
        compared = partial(compared, free_inputs=(ALL_FREE, *commands, *others))
        outside = f"{', '.join(f'`{name}`' for name in commands)} written from outside as well"
        again = self.run_from_outside(compared, run, outside, end - time.thread_time())
        return (again, compared, [f"given: {outside}"]) if again is not None else None

    def run(self, compared: Callable[..., Verdict], limit: float) -> ChartRun | None:
        """Run the chart for at most `limit` seconds; None, and in the report why, where it cannot be run."""
        from plcopen_sfc.analysis.pairing import Delay, in_retiming  # noqa: PLC0415  # most conversions run nothing

        if limit <= 0:
            self.note_untested("not run: the time limit was reached")
            return None
        try:
            verdict = self._at_intervals(compared, compared(delay="auto", limit=limit), limit)
            as_run, unseen, stays, is_cut = verdict, "", "", verdict.delay.retimed and not verdict.different
            if verdict.different and calls_charts(self.chart, self.source):  # which may be a scan late in its steps
                late = in_retiming(self.profiles)
                again = settled(compared, self.source, late, limit) if late is not None else None
                if again is not None and again.different:
                    verdict = as_run = again
                elif again is not None and is_whole(again):
                    stays = f"in what both come to while inputs stay: {again.summary}"
            other = self.profiles[0].order is not self.profiles[1].order
            reads = other and reads_inputs(self.chart, self.source, verdict.inputs)
            if is_cut and (is_begun_for_good(self.chart) or reads):  # which the report names where it is not proven
                as_run = compared(delay=Delay(verdict.delay.scans), limit=limit) if verdict.equal else verdict
            elif is_cut and other and may_race(self.chart, verdict.inputs):
                *before, last = self._in_sequence(compared, verdict, limit)
                if not last.different and is_begun_again(verdict.inputs):  # before a step has acted
                    before.append(last)
                    last = compared(delay=Delay(verdict.delay.scans, settled=True), limit=limit)
                if last.different:
                    as_run = last
                    verdict = verdict if verdict.equal else as_run
                elif not all(map(is_whole, (*before, last))):
                    unseen = "times that actions and transitions wait for were not compared in all situations"
        except SfcError as error:
            self.note_untested(f"not run: {error.message}")
            return None
        return ChartRun(self.chart, verdict, as_run, self.profiles, self.tool, unseen, stays)

    def _at_intervals(self, compared: Callable[..., Verdict], verdict: Verdict, limit: float) -> Verdict:
        """Return a difference that shows in scans as long as those of the tasks, or usual ones, else the verdict."""
        end = time.thread_time() + limit
        for scan_time in longer_scans(self.source, verdict) if verdict.equal else ():
            again = compared(delay=verdict.delay, scan_time=scan_time, limit=max(end - time.thread_time(), 0))
            if again.different:
                return again
        return verdict

    def _in_sequence(self, compared: Callable[..., Verdict], verdict: Verdict, limit: float) -> list[Verdict]:
        """Compare what comes one after another, at the scan time of a verdict and of tasks, up to a difference.

        With longer scans times that are not the same may end in one.
        """
        longer = longer_scans(self.source, verdict)
        delay = replace(verdict.delay, retimed=False, operated_later=False, in_sequence=True)
        end = time.thread_time() + limit
        found: list[Verdict] = []
        for scan_time in (*reversed(longer), verdict.scan_time):
            found.append(compared(delay=delay, scan_time=scan_time, limit=max(end - time.thread_time(), 0)))
            if found[-1].different:
                break
        return found

    def run_from_outside(
        self, compared: Callable[..., Verdict], first: ChartRun, outside: str, limit: float
    ) -> ChartRun | None:
        """Run a chart again that reaches more with commands from `outside`; None, and in the report why, if not equal.

        What keeps steps from being entered is written by the chart alone in its `first` run.
        """
        found = self.run(compared, limit)
        if found is not None and found.as_run.equal:
            return found
        seen, *unreached = str(first.verdict).splitlines()
        told = found.seen if found is not None else self.report.compared[self.chart.report_path].splitlines()
        self.note_untested(f"not all steps are reached, {seen}", *unreached, f"with {outside}: {told[0]}", *told[1:])
        return None

    def note(self, *lines: str) -> None:
        """Put the verdict into the report: one short line, and details below."""
        self.report.compared[self.chart.report_path] = "\n".join(lines)

    def note_more(self, *lines: str) -> None:
        """Put more details below the verdict."""
        self.note(self.report.compared[self.chart.report_path], *lines)

    def note_untested(self, found: str, *unreached: str) -> None:
        """Put a verdict into the report that does not cover all."""
        self.note(found)
        self.report.untested[self.chart.report_path] = list(unreached)


def _asked_in_vain(there: Chart, source: Project, verdict: Verdict) -> list[str]:
    """Return the variables that keep steps from being entered, as nothing but the chart itself writes them in a run.

    Most are commands that an operator or another controller gives, and that the chart takes back.
    """
    from plcopen_sfc.analysis.coverage import STEP, TRANSITION  # noqa: PLC0415  # most conversions run nothing

    if not verdict.proven:
        return []
    never = [each for each in verdict.coverage[0].unreached if each.impossible and not each.follows]
    if not any(each.kind == STEP for each in never):
        return []
    missed = tuple(each.name for each in never if each.kind == TRANSITION)
    names: set[str] = set()
    for inner in with_inner_charts(there.chart):
        labels = inner.labels()
        for transition in inner.transitions:
            label = labels.get(transition.id, "")
            if label and any(each.endswith(label) for each in missed):
                names |= names_in(transition, source.dialect)
    for named in there.pou.transitions:
        names |= names_in(named, source.dialect) if named.name.casefold() in names else set()
    names -= {name.casefold() for name in (*verdict.inputs, *(flag.variable for flag in SfcFlag))}
    declared = [each for section in source.global_sections() for each in section.variables]
    kinds = (SectionKind.LOCAL, SectionKind.EXTERNAL)  # outputs are for others to read
    declared += [variable for kind in kinds for variable in there.pou.variables(kind)]
    plain = (each for each in declared if isinstance(each.type, ElementaryType))
    return sorted({each.name for each in plain if each.name.casefold() in names})


def is_whole(verdict: Verdict) -> bool:
    """True for a proof that leaves nothing out."""
    from plcopen_sfc.analysis.sequences import RESTLESS  # noqa: PLC0415  # most conversions run nothing

    return verdict.proven and not any(RESTLESS in note for note in verdict.notes)


def longer_scans(source: Project, verdict: Verdict) -> list[int]:
    """Return the scan times of the tasks of a project, else the usual one, that are longer than that of a verdict."""
    declared = {nanoseconds(schedule_of(task).interval) for task in source.tasks()}
    times = {each for each in declared if each is not None} or {_SCAN_TIME}
    return sorted(each for each in times if verdict.timed and each > verdict.scan_time)


def settled(compared: Callable[..., Verdict], source: Project, late: int, limit: float) -> Verdict | None:
    """Return the verdict on what both come to while inputs stay: that which tells least; None where it cannot be run.

    First with inputs of single scans; where there are times with the scans of the tasks of `source` as well, and, if
    one side is later, with inputs that stay until both rest, and times as they are. `late`: by how many scans the
    second is later, about.
    """
    from plcopen_sfc.analysis.pairing import Delay  # noqa: PLC0415  # most conversions run nothing

    end, found = time.thread_time() + limit, None
    waiting: list[tuple[int | None, bool]] = [(None, False)]
    while waiting:
        left = (end - time.thread_time()) / len(waiting)
        scan_time, to_rest = waiting.pop(0)
        delay = Delay(late, settled=True, in_sequence=to_rest)
        try:
            verdict = compared(delay=delay, scan_time=scan_time, limit=left) if left > 0 else None
        except SfcError:
            return None
        if verdict is None or verdict.different:
            return verdict
        if verdict.interrupted:
            raise KeyboardInterrupt
        if found is None and verdict.timed:
            times = None, *longer_scans(source, verdict)
            waiting += [(each, to_rest) for each in times for to_rest in ((False, True) if late else (False,))][1:]
        if found is None or (is_whole(found) and not is_whole(verdict)):
            found = verdict
    return found
