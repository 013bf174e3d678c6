"""Timers, counters and times of S5 in other tools: their types, and statements in place of rows that act on them.

A counter is a number from 0 to 999. A timer is its output, with a TON, a mode and a time: TL is TRUE up to its time, TD
from it on, TF up to it after its step was left. The rules are those of `plcopen_sfc.semantics.charts.graph`, and the
tests compare both scan by scan.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from plcopen_sfc.conversion.adaptation.chart_rewriting import first_of, guarded
from plcopen_sfc.formats.plcopen.source_marks import TYPES_OF_S5_FIELD, SourceMarks
from plcopen_sfc.languages.s7_types import is_operand_of_s5, plain_type
from plcopen_sfc.model.actions import TIMERS, Qualifier
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork
from plcopen_sfc.model.types import DataType, DerivedType, Elementary, ElementaryType, StructType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome

_MODES = {Qualifier.TR: "0", Qualifier.TL: "1", Qualifier.TD: "2", Qualifier.TF: "3"}
_WAITS = "4"
"""The mode of TF while its step is active: the output is TRUE, the time has not begun."""
_PULSES = frozenset({Qualifier.TL, Qualifier.TF})
_COUNTS = {Qualifier.CU: "MIN({} + 1, 999)", Qualifier.CD: "MAX({} - 1, 0)"}


def counted(row: ActionAssociation) -> str:
    """Return the statement of a row that sets a counter or counts."""
    value = row.value if row.qualifier is Qualifier.CS and row.value is not None else "0"
    return f"{row.target} := {_COUNTS.get(row.qualifier, value).format(row.target)};"


class TimerRows:
    """The timers of a chart; `variable` returns the variable of a timer for a quantity.

    `at_once`: a row calls its timer, as the action that calls it in every scan may have been executed before.
    """

    def __init__(self, chart: SfcNetwork, variable: Callable[[str, str, DataType], str], *, at_once: bool) -> None:
        self._variable, self._at_once = variable, at_once
        self._started: dict[str, str] = {}
        self._kinds: dict[str, set[Qualifier]] = {}
        for _, row in chart.associations():
            if row.qualifier in TIMERS and not row.exclude:
                self._kinds.setdefault((row.target or "").casefold(), set()).add(row.qualifier)

    def started(self, row: ActionAssociation) -> list[str]:
        """Return the statements of TL, TD and TR, and those of TF in each scan in which its step is active."""
        reset = f"{row.target} := FALSE;"
        if self._kinds[(row.target or "").casefold()] == {Qualifier.TR}:
            return [reset]
        timer, mode, time = self._names(row)
        starts = _WAITS if row.qualifier is Qualifier.TF else _MODES[row.qualifier]
        if row.qualifier is Qualifier.TR:
            return [f"{mode} := {starts};", reset]
        # a timer of S5 starts again with each event: a TON needs to see FALSE before
        begins = [f"{mode} := {starts};", f"{time} := {row.duration};", f"{timer}(IN := FALSE, PT := {time});"]
        if row.qualifier is Qualifier.TF:
            return [*begins, *([f"{row.target} := TRUE;"] if self._at_once else ())]
        return [*begins, *(self._begins(row) if self._at_once else [reset])]

    def left(self, row: ActionAssociation) -> list[str]:
        """Return the statements of TF when its step was left."""
        _, mode, time = self._names(row)
        begins = [f"{mode} := {_MODES[Qualifier.TF]};", f"{time} := {row.duration};"]
        return [*begins, *(self._begins(row) if self._at_once else ())]

    def _begins(self, row: ActionAssociation) -> list[str]:
        timer, _, time = self._names(row)
        value = f"{timer}.Q" if row.qualifier is Qualifier.TD else f"NOT {timer}.Q"
        return [f"{timer}(IN := TRUE, PT := {time});", f"{row.target} := {value};"]

    def in_every_scan(self) -> list[str]:
        """Return the statements that let the timers run."""
        rows = (ActionAssociation(id=0, qualifier=Qualifier.TL, target=each) for each in self.outputs)
        return [line for row in rows for line in self._runs(row)]

    @property
    def outputs(self) -> list[str]:
        """The operands of the timers."""
        return [*self._started.values()]

    def _names(self, row: ActionAssociation) -> tuple[str, str, str]:
        target = self._started.setdefault((row.target or "").casefold(), row.target or "")
        kinds: dict[str, DataType] = {
            "timer": DerivedType(name="TON"),
            "mode": ElementaryType(name=Elementary.INT),
            "time": ElementaryType(name=Elementary.TIME),
        }
        timer, mode, time = (self._variable(target, quantity, kind) for quantity, kind in kinds.items())
        return timer, mode, time

    def _runs(self, row: ActionAssociation) -> list[str]:
        timer, mode, time = self._names(row)
        kinds = self._kinds[(row.target or "").casefold()]
        runs = f"{mode} > 0 AND {mode} < {_WAITS}" if Qualifier.TF in kinds else f"{mode} > 0"
        ended = [f"{row.target} := NOT {timer}.Q;", *guarded(f"{timer}.Q", [f"{mode} := {_MODES[Qualifier.TR]};"])]
        delayed = f"{mode} = {_MODES[Qualifier.TD]}" if kinds & _PULSES else f"{mode} > 0"
        cases = [(delayed, [f"{row.target} := {timer}.Q;"])] if Qualifier.TD in kinds else []
        if kinds & _PULSES:
            cases.append((f"{mode} > 0", ended))
        return [f"{timer}(IN := {runs}, PT := {time});", *first_of(cases)]


def variables_with_times(project: Project) -> Iterator[tuple[str, Variable]]:
    """Yield the variables of blocks and the members of data types that are an S5TIME, and their paths."""
    for pou in project.pous:
        yield from ((f"{pou.report_path} / {v.name}", v) for v in pou.variables() if _is_time_of_s5(v.type))
    for declared in project.data_types:
        members = declared.type.members if isinstance(declared.type, StructType) else ()
        yield from ((f"{declared.report_path} / {v.name}", v) for v in members if _is_time_of_s5(v.type))


def declare_times(project: Project, report: ConversionReport) -> None:
    """Declare variables that are an S5TIME as a TIME."""
    for path, variable in variables_with_times(project):
        variable.type = plain_type(variable.type)
        report.add(Outcome.TRANSLATED, "variable", path, "a TIME, as only S7 has S5TIME")


def _is_time_of_s5(kind: DataType) -> bool:
    return plain_type(kind) is not kind and not is_operand_of_s5(kind)


def interfaces_with_operands(project: Project) -> Iterator[tuple[str, Interface]]:
    """Yield the interfaces of blocks with timers or counters, and the paths of their blocks."""
    for pou in project.pous:
        if any(is_operand_of_s5(variable.type) for variable in pou.variables()):
            assert pou.interface is not None  # noqa: S101  # it has variables
            yield pou.report_path, pou.interface


def declare_operands(project: Project, report: ConversionReport, marks: SourceMarks) -> None:
    """Declare timers and counters of `project`, a copy, as their outputs and counts.

    An input that is a timer or counter is one of the caller, which the block changes: an in-out.
    """
    for path, interface in interfaces_with_operands(project):
        written: list[tuple[int, int, dict[str, object]]] = []
        passed: list[Variable] = []
        for number, section in enumerate(interface.sections):
            kept: list[Variable] = []
            for place, variable in enumerate(section.variables):
                if not is_operand_of_s5(variable.type):
                    kept.append(variable)
                    continue
                written.append((number, place, variable.model_dump(mode="json", exclude_none=True)))
                plain = plain_type(variable.type)
                changed = variable.model_copy(update={"type": plain})
                (passed if section.kind is SectionKind.INPUT else kept).append(changed)
                why = "the count" if plain == ElementaryType(name=Elementary.INT) else "the output of the timer"
                report.add(Outcome.TRANSLATED, "variable", f"{path} / {variable.name}", why)
            section.variables = kept
        if passed:
            interface.sections = [*interface.sections, VariableSection(kind=SectionKind.IN_OUT, variables=passed)]
        marks.setdefault(id(interface), {})[TYPES_OF_S5_FIELD] = written
