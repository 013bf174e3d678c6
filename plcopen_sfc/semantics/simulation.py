"""Running a chart or a program scan by scan, with its inputs from somewhere, and recording what it does."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.errors import (
    ArgumentError,
    InputError,
    ModelError,
    SimulationError,
    check_argument,
    check_names,
    listed_names,
    nearest,
    shown,
)
from plcopen_sfc.languages.st.literals import duration_of
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.charts import compile_chart
from plcopen_sfc.semantics.charts.sfc_flags import COMMANDS
from plcopen_sfc.semantics.drawn_charts import as_executed
from plcopen_sfc.semantics.inputs import (
    BoundInputs,
    CsvInputs,
    InputFunction,
    InputSource,
    TraceInputs,
    Variables,
    system_inputs,
)
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.semantics.profile import profile as profile_named
from plcopen_sfc.semantics.programs.controller import Controller, Instance
from plcopen_sfc.semantics.programs.runtime_types import Direction
from plcopen_sfc.semantics.signals import Signal, Value
from plcopen_sfc.semantics.subjects import (
    Subject,
    Watched,
    executed_alone,
    is_written,
    macro_steps,
    resolve,
    signal_of,
    step_marking,
    watched,
)
from plcopen_sfc.semantics.trace import Column, Trace

Inputs = InputSource | InputFunction | Trace | str | os.PathLike[str] | None
"""Source of the inputs of a simulation; a path is that of a CSV file."""

_DEFAULT_SCANS = 100
_CLOCK = 2**63
_OPERATING_FLAGS = frozenset(flag.variable.casefold() for flag in COMMANDS)


@collecting_rarely()
def simulate(
    subject: SfcNetwork | Pou | Project,
    *,
    inputs: Inputs = None,
    scans: int | None = None,
    pou: str | None = None,
    profile: str | Profile | None = None,
    scan_time: str | int | timedelta = "10ms",
    initial: Mapping[str, object] | None = None,
    record: Iterable[str] | None = None,
    functions: Mapping[str, Callable[..., Any]] | None = None,
    free_inputs: Iterable[str] | str = (),
    project: Project | None = None,
) -> Trace:
    """Run a chart, a POU or the `pou` of a project for a number of scans, and record it.

    `inputs`: a CSV file (see `CsvInputs`), a function from the number of the scan and the values of all variables to
    what changes, `RandomInputs(seed)`, or a `Trace` whose inputs are replayed; without any the inputs keep their
    initial values. `scans`: as many as the inputs have, else 100. `profile`: a name, a `Profile`, or that of the tool
    the project is for. `scan_time`: the clock between two scans, as ``10ms``, a `timedelta` or nanoseconds. `initial`:
    values of variables before the first scan. `record`: the variables to record, else all inputs, outputs and simple
    local variables. `functions`: those that the project does not have, by name. `free_inputs`: variables that
    nothing writes and that count as inputs though they are declared as none, or ``all``. `project`: for a POU that is
    in none.

    Raises `SimulationError` for what cannot be executed, with scan, POU and line; `InputError`, `ModelError` for
    names and values that do not fit.
    """
    check_argument(scans, (int, type(None)), "scans is their number")
    if scans is not None and scans < 0:
        raise ArgumentError(f"there are no {shown(scans)} scans")
    check_argument(initial, (Mapping, type(None)), "initial values are a mapping from variables to values")
    run = Simulation(
        resolve(subject, pou, project=project),
        profile=profile,
        scan_time=scan_time,
        functions=functions,
        record=record,
        free_inputs=free_inputs,
    )
    for path, value in (initial or {}).items():
        run.set(path, value)
    source = _source(inputs, run)
    count = scans if scans is not None else source.scans(run.scan_time)
    if count is not None and count * run.scan_time >= _CLOCK:
        hint = "Its clock counts nanoseconds up to 2^63, which is 292 years."
        raise ArgumentError(f"{shown(count)} scans are more than a simulation can run", hint=hint)
    run.run(source.bind(run.variables, run.scan_time), _DEFAULT_SCANS if count is None else count)
    return run.trace


class Simulation:
    """A running chart or program, for whoever wants to drive it scan by scan: set, `scan`, look, set .."""

    def __init__(
        self,
        subject: Subject,
        *,
        profile: str | Profile | None = None,
        scan_time: str | int | timedelta = "10ms",
        functions: Mapping[str, Callable[..., Any]] | None = None,
        record: Iterable[str] | None = None,
        free_inputs: Iterable[str] | str = (),
    ) -> None:
        check_names(functions or {}, "functions are a mapping from their names")
        chosen = default_profile(subject.project) if profile is None else profile_named(profile)
        self.subject = subject = executed_alone(as_executed(subject, chosen))
        self.profile = chosen
        self.scan_time = nanoseconds(scan_time)
        self.controller = Controller(
            subject.project,
            chosen,
            functions=functions or {},
            chart_compiler=compile_chart,
            free_inputs=listed_names(free_inputs, "free inputs are named by texts"),
        )
        self.instance: Instance = self.controller.instance(subject.pou)
        self._watched = watched(self.instance)
        self._paths = {path.casefold(): path for path in self._watched}
        inputs = {
            path: each.signal for path, each in self._watched.items() if each.is_input or self._operates(path, each)
        }
        self.variables = Variables(
            inputs,
            [path for path in self._watched if path not in inputs],
            system_inputs(subject.pou, chosen, inputs),
        )
        steps, self._marking = step_marking(self.instance)
        self.trace = Trace(
            self._columns(self._watched if record is None else listed_names(record, "variables to record are texts")),
            scan_time=self.scan_time,
            steps=steps,
            macros=macro_steps(self.instance),
            name=subject.name,
            profile=chosen.name,
        )
        self._read = self.instance.reader([column.name for column in self.trace.columns])
        self._read_all = self.instance.reader(list(self._watched))

    def _operates(self, path: str, variable: Watched) -> bool:
        """Return True for a local SFC flag that operates the chart: visualisations write it, or calls from outside."""
        is_flag = variable.direction == Direction.LOCAL and path.casefold() in _OPERATING_FLAGS
        return is_flag and bool(self.instance.charts()) and not is_written(self.instance, path)

    @property
    def undeclared(self) -> dict[str, str]:
        """Names that the program uses and the project does not declare, with the types that were guessed."""
        return {name: type_.name for name, type_ in self.controller.undeclared.items()}

    def set(self, path: str, value: object) -> None:
        """Set a variable, checked against its type. Raises `ModelError`, `InputError`."""
        check_argument(path, str, "a variable is named by a text")
        name = self._paths.get(path.casefold(), path)
        self.instance[name] = self._accepted(name, value)

    def scan(self) -> None:
        """Run one scan and record it. Raises `SimulationError`; then nothing is recorded but the error."""
        if len(self.trace):
            self.controller.now += self.scan_time
        try:
            self.instance.scan()
        except SimulationError as error:
            self.trace.ended = error.message
            raise
        self.trace.record(self._read(), self._marking())

    def values(self) -> dict[str, Value]:
        """Return the values of all variables that are recorded by default."""
        return dict(zip(self._watched, self._read_all(), strict=True))

    def run(self, inputs: BoundInputs, scans: int) -> None:
        """Run `scans` scans with these inputs."""
        instance = self.instance
        for scan in range(scans):
            for name, value in inputs(scan).items():
                instance[name] = value
            self.scan()

    def accepted(self, values: Mapping[str, object]) -> dict[str, Value]:
        """Return values that a function gave, by the names of variables as they are declared. Raises `InputError`."""
        found: dict[str, Value] = {}
        for name, value in values.items():
            declared = self._paths.get(name.casefold()) or self.variables.find(name) or name
            if declared not in self._watched and declared not in self.instance:
                hint = "Its inputs are: " + ", ".join(list(self.variables.inputs)[:20])
                raise InputError(f"the program has no variable {name!r}{nearest(name, self._watched)}", hint=hint)
            found[declared] = self._accepted(declared, value)
        return found

    def _accepted(self, path: str, value: object) -> Value:
        signal = self._watched[path].signal if path in self._watched else self._signal_at(path)
        try:
            return signal.accept(value)
        except ModelError as error:
            raise InputError(f"{path}: {error.message}", hint=error.hint) from None

    def _columns(self, names: Iterable[str]) -> list[Column]:
        columns: list[Column] = []
        for name in names:
            path = self._paths.get(name.casefold())
            if path is not None:
                columns.append(Column(path, self._watched[path].signal, self._watched[path].direction))
            else:
                columns.append(Column(name, self._signal_at(name)))
        return columns

    def _signal_at(self, path: str) -> Signal:
        """Return the signal of ``Timer.ET``, ``Step1.T``, ``a[3]``.

        Raises `ModelError` where there is no such value.
        """
        signal = signal_of(self.instance.type_of(path))
        if signal is None:
            raise ModelError(f"{path} is no single value", hint="Name one of its members or elements.")
        return signal


@dataclass(frozen=True)
class _FunctionInputs:
    function: InputFunction
    run: Simulation

    def scans(self, scan_time: int) -> int | None:  # noqa: ARG002  # of the protocol
        return None

    def bind(self, variables: Variables, scan_time: int) -> BoundInputs:  # noqa: ARG002
        def given(scan: int) -> Mapping[str, Value]:
            changed = self.function(scan, self.run.values())
            check_argument(changed, (Mapping, type(None)), "the function for inputs returns a dictionary")
            return self.run.accepted(changed or {})

        return given


class _NoInputs:
    def scans(self, scan_time: int) -> int | None:  # noqa: ARG002  # of the protocol
        return None

    def bind(self, variables: Variables, scan_time: int) -> BoundInputs:  # noqa: ARG002
        return lambda _: {}


def _source(inputs: Inputs, run: Simulation) -> InputSource:
    if inputs is None:
        return _NoInputs()
    if isinstance(inputs, str | os.PathLike):
        return CsvInputs.load(inputs)
    if isinstance(inputs, Trace):
        return TraceInputs(inputs)
    if callable(inputs):
        return _FunctionInputs(inputs, run)
    check_argument(
        inputs,
        InputSource,
        "inputs are a CSV file, a function, RandomInputs(seed) or a Trace",
        "A function gets the number of the scan and all values, and returns what changes: {'Start': True}.",
    )
    return inputs


def nanoseconds(time: str | int | timedelta) -> int:
    """Return a scan time in nanoseconds: ``10ms``, ``T#10ms``, a `timedelta`, or nanoseconds. Raises `InputError`."""
    if isinstance(time, timedelta):
        found = (time // timedelta(microseconds=1)) * 1000
    elif isinstance(time, str):
        duration = duration_of(time if "#" in time else f"T#{time.strip()}")
        if duration is None:
            raise InputError(f"{time!r} is no scan time", hint="Write it as 10ms or 1.5s.")
        found = duration
    else:
        check_argument(time, int, "a scan time is a text such as 10ms, a timedelta, or nanoseconds")
        found = time
    if found <= 0:
        raise InputError(f"the scan time {time!r} is not greater than zero")
    return found
