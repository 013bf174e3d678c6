"""Charts of projects against the text for matiec that is made of them: interpreted and compiled, scan by scan."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc.conversion.executed_parts import OPERATING_KINDS
from plcopen_sfc.model import Pou, PouKind
from plcopen_sfc.report import ConversionReport
from plcopen_sfc.semantics.profile import DrawnBlocks, Profile, ScanOrder, default_profile
from plcopen_sfc.semantics.simulation import Simulation
from plcopen_sfc.semantics.subjects import resolve
from tests.judges.matiec import CompiledProgram, require_matiec

SCANS = 100
PERIOD = 10_000_000
_RENAMED = re.compile(r"renamed to (\w+)")
_RESOURCE = re.compile(r"^(\s*RESOURCE [^\n]*\n)(.*?)^(\s*END_RESOURCE)", re.MULTILINE | re.DOTALL)
_RUN = re.compile(r"^\s*(?:TASK|PROGRAM) \w+.*;\n", re.MULTILINE)


@dataclass(frozen=True)
class Compiled:
    """A text for matiec and how things are called in it."""

    text: str
    renamed: dict[str, str]

    @classmethod
    def of(cls, data: bytes, report: ConversionReport) -> Compiled:
        found = {i.path: _RENAMED.match(i.why) for i in report.items if i.what == "name"}
        return cls(data.decode(), {path.casefold(): new[1] for path, new in found.items() if new is not None})

    def name(self, *names: str) -> str:
        """The name in the text of what the source calls so, in the POU that is named before it."""
        return self.renamed.get(".".join(names).casefold(), names[-1])

    def running(self, pou: Pou) -> str:
        """The text with `pou` alone in its configuration, in a task of 10 ms."""
        name, text = self.name(pou.name), self.text
        if pou.kind is not PouKind.PROGRAM:
            judge = f"PROGRAM Judge\nVAR it : {name}; END_VAR\nit();\nEND_PROGRAM\n\n"
            text, name = text.replace("\nCONFIGURATION ", f"\n{judge}CONFIGURATION ", 1), "Judge"
            if "\nCONFIGURATION " not in self.text:
                return text + judge
        run = f"TASK Judged(INTERVAL := T#10ms, PRIORITY := 0);\nPROGRAM Judgement WITH Judged : {name};\n"
        first = iter((run,))
        return _RESOURCE.sub(lambda m: f"{m[1]}{_RUN.sub('', m[2])}{next(first, '')}{m[3]}", text)


def _profile(project: sfc.Project, losses: set[str]) -> Profile:
    """That of the source, but for what the text for matiec has in another way.

    IEC 61131-3 leaves the last execution of actions to the tool. CODESYS executes actions before transitions: its scans
    are cut so that what is executed between two looks is the same. Where the report says that a text by the wires
    differs from what the converter of Beremiz makes of drawn conditions, it is compared by the wires.
    """
    found = default_profile(project)
    if "condition" in losses:
        return replace(found, drawn_blocks=DrawnBlocks.WHEN_ENABLED, drawn_blocks_late=False)
    if found.order is ScanOrder.ACTIONS_FIRST:
        return replace(found, order=ScanOrder.RETIMED)
    return replace(found, final_scan=False)


def _places(run: Simulation, pou: Pou, compiled: Compiled, machine: CompiledProgram) -> dict[str, str]:
    """The things compared: the steps and variables of `pou` by their names in the source, with those in the machine.

    Without times and real numbers: matiec makes 3999999 ns of T#4ms.
    """
    prefix = "" if pou.kind is PouKind.PROGRAM else "it."
    known = {name.casefold() for name in machine.names()}
    plain = [column.name for column in run.trace.columns if not re.search("TIME|REAL|STRING", column.signal.type)]
    found = {path: f"{prefix}{compiled.name(pou.name, path)}" for path in plain}
    for step in pou.sfc.steps if pou.sfc is not None else ():
        found[f"{step.name}.X"] = f"{prefix}{compiled.name(pou.name, step.name)}.X"
    return {path: place for path, place in found.items() if place.casefold() in known}


def differences(
    project: sfc.Project, pou: Pou, compiled: Compiled, report: ConversionReport, folder: Path
) -> Iterator[str]:
    """Where `pou` does something else in the interpreter and compiled."""
    losses = {item.what for item in report.losses if f"{item.path} / ".startswith(f"{pou.report_path} / ")}
    machine = require_matiec().build(compiled.running(pou), folder)
    run = Simulation(resolve(project, pou.name), profile=_profile(project, losses), scan_time="10ms")
    places = _places(run, pou, compiled, machine)
    inputs = [path for path, signal in run.variables.inputs.items() if signal.type == "BOOL" and path in places]
    driven = {(a.target or "").casefold() for _, a in pou.sfc.associations()} if pou.sfc is not None else set()
    lost = {item.path.rpartition(" / ")[2].casefold() for item in report.losses if item.what in OPERATING_KINDS}
    inputs = [path for path in inputs if path.casefold() not in driven | lost]
    rng = random.Random(len(places))  # noqa: S311
    scans = [{path: rng.random() < 0.5 for path in inputs if rng.random() < 0.4} for _ in range(SCANS)]
    theirs = machine.run([{places[p]: v for p, v in s.items()} for s in scans], list(places.values()), period=PERIOD)
    if run.profile.order is ScanOrder.RETIMED and not _acts_first(pou):
        run.scan()  # in the compiled text an initial step without actions is left at once
    for number, (values, row) in enumerate(zip(scans, theirs, strict=True)):
        for path, value in values.items():
            run.set(path, value)
        run.scan()
        for path, place in places.items():
            if run.instance[path] != row[place]:
                yield f"{path} in scan {number}: {run.instance[path]}, compiled {row[place]}"


def _acts_first(pou: Pou) -> bool:
    chart = pou.sfc
    initial = chart.initial_steps if chart is not None else ()
    return any(step.actions or step.entry_action or step.main_action or step.exit_action for step in initial)


def is_known(report: ConversionReport, pou: Pou) -> bool:
    """True if the report names what the chart of `pou` executes otherwise: drawn logic, an association, an input."""
    known = ("drawn logic", "association", *OPERATING_KINDS)
    return any(i.what in known and i.path.startswith(pou.report_path) for i in report.losses)
