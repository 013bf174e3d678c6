"""Subjects of a run: a chart, a POU or a project with a name, as a POU in its project.

The variables of a running instance as signals, and its steps: all that can be set, recorded and compared.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import Any

from plcopen_sfc.errors import ModelError, check_argument
from plcopen_sfc.languages.binding import uncalled_actions
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, SfcBody, SfcNetwork
from plcopen_sfc.semantics.charts.chart_program import ChartProgram
from plcopen_sfc.semantics.charts.running_chart import RunningChart
from plcopen_sfc.semantics.programs.controller import Instance
from plcopen_sfc.semantics.programs.runtime_types import (
    MOST_ELEMENTS,
    ArrayOf,
    Direction,
    Family,
    Frame,
    Layout,
    ScalarType,
    Type,
)
from plcopen_sfc.semantics.signals import Signal

_NOT_SHOWN = frozenset({"constant", "temp"})
_NOT_COMPARED = frozenset({Direction.CONSTANT, Direction.TEMP, Direction.IN_OUT})


@dataclass(frozen=True, slots=True)
class Watched:
    """A variable: ``input`` where it is one or nothing writes it, ``in_out``, else its direction as declared."""

    signal: Signal
    direction: str

    @property
    def is_input(self) -> bool:
        """True if a user gives it its value."""
        return self.direction in ("input", "in_out")


def watched(instance: Instance) -> dict[str, Watched]:
    """Return the single variables of an instance, and the global and undeclared ones that it uses.

    Inputs are those of the interface, and what nothing writes. Members of structures, timers and steps have paths of
    their own and are not among them, unless they are inputs.
    """
    inputs = {path.casefold(): (path, type_) for path, type_ in instance.inputs().items()}
    found: dict[str, Watched] = {}
    for path, variable in instance.variables().items():
        direction = str(variable.direction)
        if variable.is_member or direction in _NOT_SHOWN:
            continue
        if inputs.pop(path.casefold(), None) is not None and direction != "in_out":
            direction = "input"
        _watch(found, path, variable.type, direction)
    for path, type_ in inputs.values():
        root = instance.unit.layout.find(re.split(r"[.\[]", path)[0])
        in_out = root is not None and root.direction is Direction.IN_OUT
        _watch(found, path, type_, "in_out" if in_out else "input")
    return found


def watched_members(instance: Instance) -> tuple[dict[str, Watched], list[str]]:
    """Return the single values in arrays, structures and instances of the project's own function blocks, by path.

    Without what a user gives a value, and without what charts and the simulator bring with them; then the paths of
    arrays that have too many elements to look at all of them.
    """
    inputs = {path.casefold() for path in instance.inputs()}
    roots = {id(instance.frame)}
    found: dict[str, Watched] = {}
    large: list[str] = []
    for frame in (instance.frame, instance.controller.library.frame):
        for path, type_, direction in _members(instance, frame, "", roots):
            if isinstance(type_, ArrayOf):
                large.append(path)
            elif path.casefold() not in inputs:
                _watch(found, path, type_, str(direction))
    return found, large


def _members(instance: Instance, frame: Frame, path: str, seen: set[int]) -> Iterator[tuple[str, Type, Direction]]:
    for field in frame.layout.fields:
        own = field.declared or not (frame.layout.is_instance or not path)
        if field.hidden or not own or not field.retained or field.direction in _NOT_COMPARED:
            continue
        if frame.layout.find(field.name) is not field:
            continue
        value = frame.v[field.slot]
        if path or isinstance(value, Frame | list):
            yield from _inside(instance, f"{path}{field.name}", field.type, field.direction, value, seen=seen)


def _inside(
    instance: Instance, path: str, type_: Type, direction: Direction, value: Any, *, seen: set[int]
) -> Iterator[tuple[str, Type, Direction]]:
    """Yield the single values of a variable, and arrays of too many elements."""
    if isinstance(value, Frame):
        if id(value) not in seen and instance.controller.library.block_of(value.layout) is None:
            seen.add(id(value))
            yield from _members(instance, value, f"{path}.", seen)
    elif isinstance(value, list) and isinstance(type_, ArrayOf):
        if type_.whole_size > MOST_ELEMENTS:
            yield path, type_, direction
            return
        indices = product(*(range(lower, upper + 1) for lower, upper in type_.dimensions))
        for index, element in zip(indices, value, strict=True):
            name = f"{path}[{','.join(map(str, index))}]"
            yield from _inside(instance, name, type_.base, direction, element, seen=seen)
    elif not isinstance(value, list):
        yield path, type_, direction


def _watch(found: dict[str, Watched], path: str, type_: Type, direction: str) -> None:
    signal = signal_of(type_)
    if signal is not None:
        found[path] = Watched(signal, direction)


def is_written(instance: Instance, path: str) -> bool:
    """True if a program may write a variable, or a part of it; of an element of an array: any element."""
    library = instance.controller.library
    outer_path = path.removeprefix(".")  # a global variable that one of the POU hides
    placed = library.frame.layout.find(outer_path)  # what is at an address has its path as its name
    own = instance.frame
    if placed is not None and (outer_path != path or own.layout.find(path) is None):
        return library.use.is_written_inside(f"g.{placed.slot}")
    names = [name.partition("[")[0] for name in outer_path.split(".")]
    starts: tuple[tuple[list[str], Layout | None, Frame], ...] = (([], own.layout, own), (["g"], None, library.frame))
    for start, owner, outer in starts:
        keys, pou = start, owner
        value: Any = outer
        for name in names:
            field = value.layout.find(name) if isinstance(value, Frame) else None
            if field is None:
                break
            keys = [f"{key}.{field.slot}" for key in keys]
            keys += [library.use.key(pou, field.slot)] if pou is not None else []
            value = value.v[field.slot]
            if isinstance(value, list):
                return any(map(library.use.is_written_inside, keys))
            pou = value.layout if isinstance(value, Frame) and value.layout.is_instance else None
        else:
            return any(map(library.use.is_written_inside, keys))
    return True  # at an address, or where a chart keeps it


def step_marking(instance: Instance) -> tuple[tuple[str, ...], Callable[[], int]]:
    """Return the paths of the steps of the chart that an instance is, and what gives the active ones as bits."""
    for path, chart, frame in instance.charts():
        if not path and isinstance(chart, RunningChart):
            return tuple(step.path for step in chart.net.steps), partial(chart.marking, frame)
    return (), lambda: 0


def macro_steps(instance: Instance) -> tuple[str, ...]:
    """Return the paths of the macro-steps of the chart that an instance is."""
    charts = (chart for path, chart, _ in instance.charts() if not path and isinstance(chart, ChartProgram))
    return next((tuple(macro.path for macro in chart.net.macros) for chart in charts), ())


def step_flags(instance: Instance) -> dict[str, int]:
    """Return the variables of an instance's chart that tell that steps are active, with the bits of `step_marking`."""
    charts = (chart for path, chart, _ in instance.charts() if not path and isinstance(chart, ChartProgram))
    return next((chart.step_flags() for chart in charts), {})


def following_situation(instance: Instance) -> Callable[[], int]:
    """Return a function that gives, as bits, the steps of an instance's chart whose transitions the next scan tests."""
    for path, chart, frame in instance.charts():
        if not path and isinstance(chart, ChartProgram):
            return partial(chart.situation, frame)
    return step_marking(instance)[1]


def signal_of(type_: Type) -> Signal | None:
    """Return the signal for a type of a running program; None for what is no single value."""
    if not isinstance(type_, ScalarType) or type_.family is Family.SPECIAL:
        return None
    if type_.names:
        return Signal.enumeration(type_.name, type_.spelled)
    plain = Signal.elementary("TIME" if type_.family is Family.DURATION else type_.name)
    least, greatest = type_.narrowed or (type_.least, type_.greatest)
    if not type_.is_ranged:
        return replace(plain, length=type_.length)
    return replace(
        plain,
        type=type_.name if type_.narrowed else plain.type,
        unit=type_.unit,
        least=-(-least // type_.unit) * type_.unit,
        greatest=greatest // type_.unit * type_.unit,
    )


_ALONE = "Chart"


@dataclass(frozen=True)
class Subject:
    """A POU and the project whose types, POUs and global variables it uses. `name`: ``Main``, ``Main.Fill``."""

    project: Project
    pou: Pou
    name: str


def executed_alone(subject: Subject) -> Subject:
    """Return a subject without the actions of its POU that nothing executes where an action runs as its body.

    What they would write keeps its value then, or is an input: the bodies that execute them do not run.
    """
    if subject.name == subject.pou.name:
        return subject
    unused = {id(action) for action in uncalled_actions(subject.pou, subject.project)}
    kept = [action for action in subject.pou.actions if id(action) not in unused]
    return replace(subject, pou=subject.pou.model_copy(update={"actions": kept}))


def resolve(subject: SfcNetwork | Pou | Project, pou: str | None = None, *, project: Project | None = None) -> Subject:
    """Find out what to run.

    Of a project, `pou` names it: ``Main``, or ``Main.Fill`` for an action; it may be left out where there
    is only one chart, or only one POU that can run. A chart brings the project that it is in; a chart of an action
    runs as if it were the body of its POU. A POU without `project` uses the project that it is in, if there is one.
    Raises `ModelError`.
    """
    check_argument(subject, (Project, Pou, SfcNetwork), "a chart, a POU or a project is needed")
    check_argument(pou, (str, type(None)), "pou is the name of one")
    if isinstance(subject, Project):
        return _named(subject, pou) if pou is not None else _only(subject)
    if isinstance(subject, Pou):
        around = project or subject.project or Project(pous=[subject])
        return Subject(around, subject, subject.name)
    whole = project or subject.project
    if whole is None:
        alone = Pou(name=_ALONE, kind=PouKind.PROGRAM, bodies=[SfcBody(chart=subject)])
        return Subject(Project(pous=[alone]), alone, _ALONE)
    for name, owner, body in whole.bodies():
        if isinstance(body, SfcBody) and body.chart is subject:
            return _of_body(whole, name, owner, body)
    raise ModelError("this chart is inside another one", hint="Simulate the chart that it is a part of.")


def _named(project: Project, name: str) -> Subject:
    for path, owner, body in project.bodies():
        if isinstance(body, SfcBody) and path.casefold() == name.casefold():
            return _of_body(project, path, owner, body)
    for path, owner, body in project.bodies():
        if path.casefold() == name.casefold() and any(body is action.body for action in owner.actions):
            return _of_body(project, path, owner, body)
    found = project.pou(name)
    return Subject(project, found, found.name)


def _only(project: Project) -> Subject:
    charts = [(name, owner, body) for name, owner, body in project.bodies() if isinstance(body, SfcBody)]
    if len(charts) == 1:
        return _of_body(project, *charts[0])
    running = [pou for pou in project.pous if pou.kind is not PouKind.FUNCTION and pou.bodies]
    if not charts and len(running) == 1:
        return Subject(project, running[0], running[0].name)
    names = [name for name, _, _ in charts] or [pou.name for pou in running]
    if not names:
        raise ModelError("the project has nothing that could be run")
    raise ModelError("the POU to run is not named", hint="Name one of them: " + ", ".join(names[:20]))


def _of_body(project: Project, name: str, owner: Pou, body: Body) -> Subject:
    """Return an action as the body of a POU that is like its own in everything else."""
    if any(body is each for each in owner.bodies):
        return Subject(project, owner, owner.name)
    return Subject(project, owner.model_copy(update={"bodies": [body]}), name)
