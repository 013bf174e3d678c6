"""SFC flags of CODESYS in charts of TC6: conditions, a step that ends what actions store, and guards of statements.

Actions of IEC 61131-3 are executed once more after their step was left; CODESYS executes them no more where a flag ends
the step, and none during SFCPause. So the statements ask the flags. What a step stores goes on until an action with R
ends it: SFCInit and SFCReset lead to steps that do so.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from plcopen_sfc.conversion.adaptation.chart_rewriting import ChartRewriting, all_of, first_of, guarded
from plcopen_sfc.conversion.adaptation.flag_transitions import FlagRewriter, is_code
from plcopen_sfc.conversion.adaptation.operating_inputs import AddedElements
from plcopen_sfc.conversion.adaptation.sequencer_rewriting import PermanentRewriter
from plcopen_sfc.conversion.adaptation.step_checks import StepChecks
from plcopen_sfc.conversion.adaptation.step_rewriting import StepRewriter
from plcopen_sfc.conversion.executed_parts import told_flag
from plcopen_sfc.formats.plcopen.source_marks import (
    OF_FLAGS,
    TEXTS_FIELD,
    text_digest,
)
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.sfc import Step, Transition
from plcopen_sfc.model.types import Elementary, ElementaryType, StringType
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import Outcome

_STORES = frozenset({Qualifier.S, Qualifier.SD, Qualifier.DS, Qualifier.SL})
_RESETS = frozenset({Qualifier.R, Qualifier.R0})
_TIMED = frozenset({Qualifier.L, Qualifier.D, Qualifier.SD, Qualifier.DS, Qualifier.SL})
_FORGOTTEN = {SfcFlag.ERROR: "FALSE", SfcFlag.ERROR_STEP: "''", SfcFlag.ERROR_POU: "''"}
_REPORTS = frozenset({*_FORGOTTEN, SfcFlag.ENABLE_LIMIT, SfcFlag.CURRENT_STEP})
"""The flags that statements set, and the one that enables this."""
_TOGETHER = ".flags"
"""A name in all marks: an edit of the replacement of one flag counts for all of it."""


def execute_flags_in_tc6(
    rewriting: ChartRewriting, steps: StepRewriter, checks: StepChecks, surroundings: PermanentRewriter
) -> None:
    """Let the conditions of a chart obey its flags; `rewriting.flags` are then those that have no effect."""
    at_rest = rewriting.options.at_rest
    used = frozenset(flag for flag in rewriting.flags if flag.variable.upper() not in at_rest)
    rewriter = _Tc6Flags(rewriting, steps, checks)
    wanted = used & rewriter.obeyed
    if used & (rewriter.obeyed | _REPORTS):
        executed = rewriter.rewrite(wanted)
        rewriting.flags -= wanted | rewriter.watch(used, executed)
        rewriter.store(surroundings)


class _Tc6Flags(FlagRewriter):
    obeyed = FlagRewriter.obeyed | {SfcFlag.QUIT_ERROR}
    leaves_branches = True

    def __init__(self, rewriting: ChartRewriting, steps: StepRewriter, checks: StepChecks) -> None:
        super().__init__(rewriting)
        self._steps, self._added = steps, AddedElements(rewriting, checks)
        self._names = [_TOGETHER]
        self._changed: list[Transition] = []
        self._quit_before = ""
        self._watching: list[str] = []
        """The statements for before all actions, which set the flags that report on the chart."""

    def store(self, surroundings: PermanentRewriter) -> None:
        """Let the initial step store the action with the memories, and mark what was changed for the way back."""
        for transition in (each for each in self._changed if each.id in self._rewriting.source_transitions):
            self._rewriting.mark_condition(transition, self._names)
        self._added.mark(self._names, of=OF_FLAGS)
        if self.lines:
            body = StBody(text="\n".join(self.lines))
            if surroundings.is_overtaken(body):
                holds = f"what holds transitions during {self._pause}" if self._pause else "what is kept of SFC flags"
                why = f"{holds} may be computed before actions that the conditions read"
                self._note(Outcome.APPROXIMATED, "operating inputs", "", why)
            self._steps.store(self._initial, "sfc_flags", body, first=False, instead_of=None, uses=self._names)
        if self._watching:
            body = StBody(text="\n".join(self._watching))
            self._steps.store(self._initial, "sfc_times", body, first=True, instead_of=None, uses=self._names)

    # -- what TC6 has

    def _refusal(self, flag: SfcFlag) -> str | None:
        if flag is SfcFlag.TIP and self._is_pushed_inside():
            return "its own actions write it, before or after what remembers it"
        return super()._refusal(flag)

    def _is_declared(self, flag: SfcFlag) -> bool:
        return self._is_known(flag)

    def _declare(self, name: str) -> str:
        self._names.append(name)
        return super()._declare(name)

    def _added_step(self, wish: str, why: str) -> Step:
        return self._added.step(wish, why)

    def _lead(self, sources: Sequence[Step], target: Step, condition: str) -> None:
        why = "it replaces an SFC flag, and is tried before the others"
        self._added.transition(sources, target, condition, why, first=True)

    def _put(self, transition: Transition, condition: str) -> None:
        super()._put(transition, condition)
        self._changed.append(transition)
        for step in (each for each in self._chart.steps if each.id in transition.sources and each.min_time):
            why = "the conditions that leave it ask for its time, and for the flags"
            self._note(Outcome.TRANSLATED, "minimum time", f"step {step.name}", why)

    # -- what is stored

    def _stored(self) -> list[str]:
        """Return the operands that rows store, in the order of the chart."""
        rows = (row for _, row in self._chart.associations() if row.qualifier in _STORES and row.target)
        found = {row.target.casefold(): row.target for row in rows if row.target is not None}
        return list(found.values())

    def _refused_end(self) -> str | None:
        if any(row.target is None and row.qualifier in _STORES for _, row in self._chart.associations()):
            return "an action in place that is stored has no name by which it could be reset"
        return None

    @property
    def _has_rest(self) -> bool:
        return super()._has_rest or bool(self._stored())

    def _rest(self, flags: Collection[SfcFlag]) -> Step:
        rest = super()._rest(flags)
        self._end(rest)
        return rest

    def _end(self, step: Step) -> None:
        """Let an added step end what is stored."""
        stored = self._stored()
        self._steps.reset(step, stored)
        for owner, row in self._chart.associations() if stored else ():
            if row.qualifier in _STORES:
                why = f"the step {step.name} ends what it stores"
                self._note(Outcome.TRANSLATED, "qualifier", f"step {owner.name} / action {row.target}", why)

    def _beginning(self) -> Step:
        """Return the step to which SFCReset leads: one that ends what is stored, and then is as the initial step."""
        stored, initial = self._stored(), self._initial
        self._firsts = {initial.id}
        if not stored:
            return initial
        why = "it ends what is stored, and executes what the initial step does"
        again = self._added_step(f"{SfcFlag.RESET.variable}_begins", why)
        self._firsts.add(again.id)
        names = {name.casefold() for name in stored}
        rows = [row for row in initial.actions if (row.target or "").casefold() not in names]
        for row in rows:
            self._steps.add(again, row)
        self._end(again)
        for kind in ("entry", "main", "exit"):
            code = getattr(initial, f"{kind}_action")
            body = self._statements(code)  # a name would have one control for both steps
            setattr(again, f"{kind}_action", code if body is None else StBody(text=body.text))
        for each in [each for each in self._chart.transitions if initial.id in each.sources]:
            targets = [step for step in self._chart.steps if step.id in each.targets]
            text = self._texts[each.id]
            added = self._added.transition(again, targets, text or "TRUE", "as from the initial step")
            self._texts[added.id] = text
        if any(row.qualifier not in _RESETS for row in initial.actions if (row.target or "").casefold() in names):
            why = f"behind {self._reset} it does not store what it stores otherwise"
            self._note(Outcome.APPROXIMATED, "initial step", f"step {initial.name}", why)
        self._hide(initial, f"while the step {again.name} is active in its place")
        if self._is_read(initial, "t"):
            why = f"its time does not begin while the step {again.name} is active in its place"
            self._note(Outcome.APPROXIMATED, "step time", f"step {initial.name}", why)
        return again

    def _end_stored(self, flags: Collection[SfcFlag]) -> None:
        """Let nothing but the added steps end what is stored."""

    # -- what is executed

    def _refused_pause(self) -> str | None:
        return None

    def _is_executed_at_end(self, step: Step) -> bool:
        rows = [row for row in step.actions if is_code(self._place, row)]
        bodies = [self._text_of(row) for row in rows if row.qualifier is not Qualifier.P1]
        is_told = any(body is None or not self._is_left(self._runners(body), "TRUE") for body in bodies)
        return is_told or (step.exit_action is not None and self._statements(step.exit_action) is None)

    def _guard(self, flags: Collection[SfcFlag]) -> None:
        if self._goes_on(flags):
            self._report_pause()
        super()._guard(flags)

    def _mark_text(self, body: StBody, text: str) -> None:
        mark = self._rewriting.marks.setdefault(id(body), {}).setdefault(TEXTS_FIELD, {})
        mark["text"] = [mark.get("text", [body.text])[0], text_digest(text)]

    def _mark_step(self, step: Step) -> None:
        self._steps.execute(step, self._names)

    # -- what reports on the chart

    def watch(self, used: Collection[SfcFlag], obeyed: Collection[SfcFlag]) -> frozenset[SfcFlag]:
        """Let statements set the flags that report on the chart, of which `obeyed` operate it. Returns those."""
        inputs = {each.name.casefold() for each in self._place.pou.variables(SectionKind.INPUT)}
        is_own = self._chart is self._place.pou.chart
        found = [flag for flag in sorted(_REPORTS & set(used)) if is_own or self._is_declared(flag)]
        found = [flag for flag in found if flag is SfcFlag.ENABLE_LIMIT or flag.variable.casefold() not in inputs]
        # the other flags tell of errors, and work only together with SFCError
        if not any(step.initial for step in self._chart.steps) or (
            SfcFlag.ERROR in used and SfcFlag.ERROR not in found
        ):
            found = []
        if SfcFlag.ENABLE_LIMIT in used and SfcFlag.ENABLE_LIMIT not in found:
            found = [flag for flag in found if flag is SfcFlag.CURRENT_STEP]
        for flag in found:
            if not self._is_declared(flag):
                is_truth = flag in (SfcFlag.ERROR, SfcFlag.ENABLE_LIMIT)
                self._rewriting.declare(
                    flag.variable, ElementaryType(name=Elementary.BOOL) if is_truth else StringType()
                )
                self._names.append(flag.variable)
            what, place = told_flag(flag)
            self._note(Outcome.TRANSLATED, what, place, "statements that every scan executes set it, or ask for it")
        halts = [flag.variable for flag in (SfcFlag.QUIT_ERROR, SfcFlag.INIT) if flag in obeyed]
        stopped = [*halts, *([SfcFlag.PAUSE.variable] if SfcFlag.PAUSE in obeyed else [])]
        # a reset is executed in spite of a pause
        if SfcFlag.RESET in obeyed and len(stopped) > len(halts):
            stopped[-1] = f"({stopped[-1]} AND NOT {self._reset})"
        if SfcFlag.ERROR in found:
            self._watch_times(found, obeyed, halts, stopped)
        if SfcFlag.CURRENT_STEP in found:
            name = SfcFlag.CURRENT_STEP.variable
            steps = [(self._host.active(step), [f"{name} := '{step.name}';"]) for step in reversed(self._chart.steps)]
            self._watching += guarded(_none(stopped), first_of([*steps, ("", [f"{name} := '';"])]))
            self._watching += guarded(self._init, [f"{name} := '';"]) if SfcFlag.INIT in obeyed else []
        return frozenset(found)

    def _watch_times(
        self, found: Collection[SfcFlag], obeyed: Collection[SfcFlag], halts: list[str], stopped: list[str]
    ) -> None:
        """Set SFCError while a step is active longer than its maximum time, until something lets it be forgotten."""
        known = [flag for flag in _FORGOTTEN if flag in found]
        causes = [*halts]
        if SfcFlag.RESET in obeyed:
            before = self._memory(f"{SfcFlag.RESET.variable}_before")
            causes.append(f"({self._reset} AND NOT {before})")
        forgotten = [f"{flag.variable} := {_FORGOTTEN[flag]};" for flag in known]
        self._watching += guarded(" OR ".join(causes), forgotten) if causes else []
        values = {SfcFlag.ERROR: "TRUE", SfcFlag.ERROR_POU: f"'{self._place.pou.name}'"}
        late: list[tuple[str, list[str]]] = []
        for step in (step for step in self._chart.steps if step.max_time):
            elapsed = self._host.elapsed(step)
            if SfcFlag.QUIT_ERROR in obeyed:
                elapsed = f"{elapsed} - {self._quitted(step, elapsed)}"
            told = values | {SfcFlag.ERROR_STEP: f"'{step.name}'"}
            lines = " ".join(f"{flag.variable} := {told[flag]};" for flag in known)
            late.append((f"{self._host.active(step)} AND {elapsed} > {step.max_time}", [lines]))
            why = "statements that every scan executes set SFCError"
            self._note(Outcome.TRANSLATED, "max time", f"step {step.name}", why)
        watches = [*stopped, SfcFlag.ERROR.variable]
        enabled = SfcFlag.ENABLE_LIMIT.variable if SfcFlag.ENABLE_LIMIT in found else ""
        self._watching += guarded(all_of([enabled, _none(watches)]), first_of(late)) if late else []
        if SfcFlag.RESET in obeyed:
            self._watching.append(f"{before} := {self._reset};")

    def _quitted(self, step: Step, elapsed: str) -> str:
        """Return the variable with the time of a step at which SFCQuitError let its time begin again."""
        name = self._rewriting.new_variable(f"{step.name}_quit", ElementaryType(name=Elementary.TIME))
        self._names.append(name)
        quits = SfcFlag.QUIT_ERROR.variable
        if not self._quit_before:
            self._quit_before = self._memory(f"{quits}_before")
            is_paused = f" OR ({self._quit_before} AND {self._pause})" if self._pause != quits else ""
            self.lines.append(f"{self._quit_before} := {quits}{is_paused};")
        left = f"NOT {self._host.active(step)}"
        if any(step.id in each.sources and step.id in each.targets for each in self._chart.transitions):
            left += f" OR {elapsed} < {name}"  # it was left and entered at once
        self._watching += first_of(
            [
                (left, [f"{name} := T#0s;"]),
                (f"{quits} OR {self._quit_before}", [f"{name} := {elapsed};"]),
            ]
        )
        return name

    def _report_pause(self) -> None:
        """Report the actions that go on during SFCPause: one item where it is in several steps."""
        pause, quits = self._pause, SfcFlag.QUIT_ERROR.variable
        timed: dict[str, str] = {}
        going: dict[str, str] = {}
        for step, row in self._chart.associations():
            name = row.target or "in place"
            place = f"step {step.name} / action {name}"
            if row.qualifier in _TIMED | {Qualifier.P} or row.duration is not None:
                timed[place] = name
            elif is_code(self._place, row) and self._text_of(row) is None:
                going[place] = name
        stays = "in CODESYS nothing is executed, and all stays as it is"
        one, more = f"its time goes on during {pause}; {stays}", f"the times of {{}} go on during {pause}; {stays}"
        self._report_together("action", timed, one, more)
        self._report_together("action", going, f"it goes on during {pause}", f"{{}} go on during {pause}")
        for step in self._chart.steps:
            if step.main_action is not None and self._statements(step.main_action) is None:
                self._note(Outcome.APPROXIMATED, "main action", f"step {step.name}", f"it goes on during {pause}")
        if quits in pause:
            read = {f"step {step.name}": step.name for step in self._chart.steps if self._is_read(step, "t")}
            one = f"{quits} does not let it begin again, which it does in CODESYS"
            more = f"{quits} does not let the times of {{}} begin again, which it does in CODESYS"
            self._report_together("step time", read, one, more)

    def _report_together(self, what: str, places: Mapping[str, str], one: str, more: str) -> None:
        """Report something of one place there, of several for the chart, with the names that `places` has."""
        if len(places) > 1:
            names = ", ".join(dict.fromkeys(places.values()))
            self._note(Outcome.APPROXIMATED, what, "", more.format(names))
        for place in places if len(places) == 1 else ():
            self._note(Outcome.APPROXIMATED, what, place, one)


def _none(terms: Iterable[str]) -> str:
    """Return an expression that is TRUE while none of the terms is."""
    return all_of(f"NOT {term}" for term in terms)
