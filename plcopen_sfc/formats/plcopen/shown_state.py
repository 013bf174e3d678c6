"""Outputs by which a block of S7-GRAPH shows the state of its sequencer, as statements.

They are those of the automatic mode: what switches modes, or selects the step displayed, has no effect in other tools.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.formats.plcopen.chart_hosts import ChartRewriting, as_term
from plcopen_sfc.formats.plcopen.step_checks import StepChecks
from plcopen_sfc.model.sfc import Step
from plcopen_sfc.model.variables import SectionKind

_LAMPS = {"AUTO_ON": "TRUE", "MAN_ON": "FALSE", "TAP_ON": "FALSE", "TOP_ON": "FALSE"}


class ShownState:
    """Statements for the outputs that a block has; they read the step flags behind the step change."""

    def __init__(self, rewriting: ChartRewriting, checks: StepChecks) -> None:
        self._rewriting, self._host, self._checks = rewriting, rewriting.host, checks
        source = rewriting.source
        self._steps = sorted(rewriting.chart.chart.steps, key=lambda step: step.number or 0)
        self._is_one = sum(step.initial for step in source.steps) == 1 and all(
            len(transition.targets) < 2 for transition in source.transitions
        )
        rows = {(row.target or "").strip('"').casefold() for _, row in source.associations()}
        outputs = rewriting.chart.pou.variables(SectionKind.OUTPUT)
        self._names = {v.name.upper(): v.name for v in outputs if v.name.casefold() not in rows}
        self.lines = list(self._lines()) if source.graph_settings is not None else []
        """The statements."""

    @property
    def names(self) -> set[str]:
        """The outputs that the statements write."""
        return {line.split(" := ")[0].strip() for line in self.lines if " := " in line}

    def _lines(self) -> Iterator[str]:
        flags = [self._host.active(step) for step in self._steps]
        if "S_NO" in self._names and flags:
            yield from self._number(self._names["S_NO"])
        if "S_ACTIVE" in self._names and flags:
            yield f"{self._names['S_ACTIVE']} := {' OR '.join(flags)};"
        if "S_MORE" in self._names and flags:
            count = " + ".join(f"BOOL_TO_INT({flag})" for flag in flags)
            yield f"{self._names['S_MORE']} := {'FALSE' if self._is_one else f'{count} > 1'};"
        if "ERR_FLT" in self._names:
            found = [self._disturbed(step) for step in self._steps]
            errors = [text for text in found if text]
            if None not in found:
                yield f"{self._names['ERR_FLT']} := {' OR '.join(errors) or 'FALSE'};"
        for name, value in _LAMPS.items():
            if name in self._names:
                yield f"{self._names[name]} := {value};"

    def _number(self, shown: str) -> Iterator[str]:
        """Yield the number of the step displayed: that of before while it is active, else the first active one."""
        inner = "" if self._is_one else "    "
        kept = [f"({self._host.active(step)} AND {shown} = {step.number or 0})" for step in self._steps]
        if inner:
            yield f"IF NOT ({' OR '.join(kept)}) THEN"
        for at, step in enumerate(self._steps):
            yield f"{inner}{'ELSIF' if at else 'IF'} {self._host.active(step)} THEN"
            yield f"{inner}    {shown} := {step.number or 0};"
        yield from (f"{inner}ELSE", f"{inner}    {shown} := 0;", f"{inner}END_IF;")
        if inner:
            yield "END_IF;"

    def _disturbed(self, step: Step) -> str | None:
        """Return when an active step has an error: empty where it never has, None where that is no expression."""
        interlock, fault = self._rewriting.interlock(step), self._checks.disturbed(step)
        if interlock is None or fault is None:
            return None
        parts = [f"NOT {as_term(interlock)}"] * (interlock != "TRUE") + [fault] * (fault != "FALSE")
        return f"({self._host.active(step)} AND {as_term(' OR '.join(parts))})" if parts else ""
