"""Faults of textbook sequences, and the report on those of one chart."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.semantics.signals import Signal, Value
from plcopen_sfc.semantics.trace import aligned

_OTHERS_SHOWN = 10
__all__ = ["Fault", "FaultKind", "FaultScan"]


class FaultKind(Enum):
    """Way in which a textbook sequence differs from its chart. The codes are stable."""

    def __init__(self, code: str, title: str, why: str) -> None:
        self.code = code
        self.title = title
        self.why = why

    OVERLAP = (
        "LOW101",
        "two steps that follow each other are active in one scan",
        "A step is reset by the flag of the step behind it, and so a scan after that was set. What both drive is on "
        "together: forward and backward, for instance.",
    )
    RUN_THROUGH = (
        "LOW102",
        "a token runs through several steps in one scan",
        "The network of a step sees the flag that the network before it has just set. Where the next condition is TRUE "
        "already, it goes on at once.",
    )
    BLOCKED_LOOP = (
        "LOW103",
        "two steps that lead to each other block the sequence",
        "The step before it is the step behind it too, and resets it in the scan in which it is to be set.",
    )
    INIT_EMPTIES = (
        "LOW104",
        "an initialisation of one scan leaves no initial step active",
        "The initial step is reset by the step behind it, still active in that scan; then that is reset too.",
    )
    DUPLICATED = (
        "LOW105",
        "a selection activates several of its branches",
        "The conditions of two branches are TRUE together, and nothing gives way to the other.",
    )
    LOST = (
        "LOW106",
        "a step ends although no transition has left it",
        "It leads to itself, and so is reset by its own flag.",
    )
    NOT_STARTED = (
        "LOW107",
        "no step is active until the first initialisation",
        "The chart starts at its initial step; the flip-flop of that step waits for a pulse.",
    )
    NOT_STABLE = (
        "LOW108",
        "the situation is not stable at the end of a scan",
        "A GRAFCET passes all situations in which it cannot stay within one scan; the code passes one in a scan.",
    )
    GAP = (
        "LOW201",
        "an output is off for a scan between two steps that both drive it",
        "The step that ends resets it behind everything that set it.",
    )
    SHIFTED = (
        "LOW202",
        "an output is off in a scan in which its step is active",
        "The actions of a step come before its transition: they begin a scan after it has become active, and are "
        "reset in the scan in which it ends.",
    )
    SWALLOWED = (
        "LOW203",
        "the output of a step never comes on",
        "The condition behind the step is TRUE at once: its transition resets the output in the scan that sets it.",
    )
    STUCK = (
        "LOW204",
        "an output stays on that no active step drives",
        "The initialisation changes the step without what its transition would have reset.",
    )
    INIT_IGNORED = (
        "LOW205",
        "the sequence goes on while it is initialised",
        "The transition of the initial step is tried in the same scan.",
    )
    LATE = (
        "LOW206",
        "an action is executed a scan later than in the chart",
        "The branch of a step is executed for the first time in the scan after that in which it has become active.",
    )


@dataclass(frozen=True)
class FaultScan:
    """One scan of the inputs that show a fault, and the reaction of both.

    `inputs` are all that the code reads. `chart` and `code` are the steps that are active at its end, `chart_outputs`
    and `code_outputs` the values of the outputs concerned. `is_stable`: False if the chart, a GRAFCET, fires
    transitions without end in this scan, so that no steps of it are told.
    """

    inputs: Mapping[str, Value]
    chart: tuple[str, ...]
    code: tuple[str, ...]
    chart_outputs: Mapping[str, bool]
    code_outputs: Mapping[str, bool]
    is_stable: bool = True


@dataclass(frozen=True)
class Fault:
    """Fault of the code of a chart.

    `place`: the steps, and the output, that `trace` shows it with; `others` has it in other places. `shortest`: no
    shorter sequence of inputs shows any. `signals` are the types of the inputs.
    """

    kind: FaultKind
    place: tuple[str, ...]
    others: tuple[tuple[str, ...], ...]
    trace: tuple[FaultScan, ...]
    shortest: bool
    signals: Mapping[str, Signal]

    def __repr__(self) -> str:
        return f"Fault({self.code}, {_listed(self.place)}: {len(self.trace)} scans)"

    @property
    def code(self) -> str:
        """Stable code: ``LOW101`` ..."""
        return self.kind.code

    @property
    def message(self) -> str:
        """Error and its place."""
        return f"{self.kind.title}: {_listed(self.place)}"

    def diagnostic(self, pou: str) -> Diagnostic:
        """Return the fault as a finding about a POU."""
        return Diagnostic(
            self.code, Severity.WARNING, self.message, Location(path=pou), "The exact style does what the chart does."
        )

    def table(self) -> list[str]:
        """Return the trace as lines of a table: inputs that are not 0, and the steps and outputs of chart and code."""
        outputs = list(self.trace[0].code_outputs)
        rows = [["scan", "|", "inputs", "|", "chart", *outputs, "|", "code", *outputs]]
        for number, scan in enumerate(self.trace, 1):
            steps = " ".join(scan.chart) or "-" if scan.is_stable else "never stable"
            chart = [steps, *(_shown(scan.chart_outputs[name]) for name in outputs)]
            code = [" ".join(scan.code) or "-", *(_shown(scan.code_outputs[name]) for name in outputs)]
            rows.append([str(number), "|", self._given(scan.inputs), "|", *chart, "|", *code])
        return aligned(rows, " ")

    def _given(self, inputs: Mapping[str, Value]) -> str:
        """Return the inputs that are not 0: the names of Boolean ones, the values of all others."""
        given = [(name, value) for name, value in inputs.items() if value]
        texts = [n if value is True else f"{n}={self.signals[n].text(value)}" for n, value in given]
        return " ".join(texts) or "-"

    def __str__(self) -> str:
        """Return the error, the reason for it, and the table."""
        lines = [f"{self.code}: {self.message}", f"  {self.kind.why}"]
        if self.others:
            more = len(self.others) - _OTHERS_SHOWN
            also = "; ".join(map(_listed, self.others[:_OTHERS_SHOWN])) + (f"; and {more} more" if more > 0 else "")
            lines.append(f"  Likewise: {also}")
        return "\n".join([*lines, *(f"  {line}" for line in self.table())])

    def as_dict(self) -> dict[str, Any]:
        """Return the fault as plain data, for JSON."""
        return {
            "code": self.code,
            "title": self.kind.title,
            "why": self.kind.why,
            "place": list(self.place),
            "others": [list(each) for each in self.others],
            "shortest": self.shortest,
            "trace": [
                {
                    "inputs": dict(scan.inputs),
                    "chart": {
                        "active": list(scan.chart),
                        "outputs": dict(scan.chart_outputs),
                        "stable": scan.is_stable,
                    },
                    "code": {"active": list(scan.code), "outputs": dict(scan.code_outputs)},
                }
                for scan in self.trace
            ],
        }


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names)


def _shown(value: bool) -> str:
    return str(int(value))
