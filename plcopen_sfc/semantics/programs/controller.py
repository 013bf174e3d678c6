"""A controller that runs a project, and the instances of its POUs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.semantics.profile import profile as profile_of
from plcopen_sfc.semantics.programs import types as t
from plcopen_sfc.semantics.programs.instances import Instance
from plcopen_sfc.semantics.programs.keeping import Keeper
from plcopen_sfc.semantics.programs.layouts import Frame
from plcopen_sfc.semantics.programs.library import ChartCompiler, Library
from plcopen_sfc.semantics.programs.units import Unit
from plcopen_sfc.semantics.programs.unknown_calls import UnknownCalls

_MOST_STEPS = 1_000_000


class Controller:
    """Runs the POUs of a project. Edits of the project after that make it wrong.

    `profile` is for charts and their compiler; None: that of the tool that the project is for. `functions` are those
    that the project calls but does not have, by name; they get the arguments of the call. `read_input(path)` gives the
    value of a free input the first time that a scan reads it: of an input of the instance, a global variable or an
    undeclared name that nothing writes and no declaration gives a value. `unknown_calls` says what calls come to that
    the project has nothing for; without it they are errors. `max_steps`: turns of loops and calls of
    functions in a scan before it counts as endless. `free_inputs`: variables that nothing writes
    and that count as inputs though no declaration says so, or ``all`` of them, but never
    `not_free`. `marking`: note which assignments are
    reached (`library.marks`).
    """

    def __init__(
        self,
        project: Project,
        profile: str | Profile | None = None,
        *,
        functions: Mapping[str, Callable[..., Any]] | None = None,
        chart_compiler: ChartCompiler | None = None,
        read_input: Callable[[str], Any] | None = None,
        max_steps: int = _MOST_STEPS,
        free_inputs: Iterable[str] = (),
        not_free: Iterable[str] = (),
        marking: bool = False,
        unknown_calls: UnknownCalls | None = None,
    ) -> None:
        self.project = project
        self.profile = default_profile(project) if profile is None else profile_of(profile)
        self.max_steps = max_steps
        self.library = Library(
            project,
            self.profile,
            functions or {},
            chart_compiler,
            read_input,
            free_inputs=free_inputs,
            not_free=not_free,
            marking=marking,
            unknown_calls=unknown_calls,
        )
        self.keeper = Keeper()
        self._initialised: dict[int, Frame] = {}

    @property
    def now(self) -> int:
        """The time since the start in nanoseconds. Whoever drives the controller advances it between scans."""
        return self.library.processor.now

    @now.setter
    def now(self, value: int) -> None:
        self.library.processor.now = value

    @property
    def undeclared(self) -> Mapping[str, t.Type]:
        """Names that the project uses but does not declare: they are external variables of these types."""
        return dict(self.library.undeclared)

    @property
    def missing(self) -> tuple[str, ...]:
        """Functions, function blocks and types that are not known to the simulator. Reaching one is an error."""
        return tuple(self.library.missing)

    @property
    def problems(self) -> tuple[SimulationError, ...]:
        """Texts that could not be translated. A scan that reaches it raises the error."""
        return tuple(self.library.problems)

    def instance(self, pou: str | Pou) -> Instance:
        """A program, or a new instance of a function block or function. Raises `ModelError`, `SimulationError`."""
        found = self.project.pou(pou) if isinstance(pou, str) else pou
        library = self.library
        try:
            unit = library.unit(found)
            place = library.program(unit) if unit.is_program else None
            library.roots.add(unit)
            library.finish()
            frame = library.frame.v[int(place.index)] if place is not None else unit.layout.new()
            library.give_in_outs(unit, frame)
        except RecursionError:
            where = Location(path=found.name)
            raise SimulationError("an instance contains itself, or is nested too deeply", location=where) from None
        self._initialise(frame)
        for value in library.frame.v:
            self._initialise(value)
        return Instance(self, unit, frame)

    def _initialise(self, value: Any) -> None:
        """Bring charts of new frames into their initial situation: those of nested instances too."""
        if isinstance(value, Frame):
            if id(value) in self._initialised:
                return
            self._initialised[id(value)] = value
            unit: Unit | None = self.library.unit_of_layout(value.layout)
            for item in value.v:
                self._initialise(item)
            if unit is not None:
                unit.initialise(value)
        elif isinstance(value, list):
            for item in value:
                if isinstance(item, Frame | list):
                    self._initialise(item)
