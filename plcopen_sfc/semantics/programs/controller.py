"""A controller that runs a project, and the instances of its POUs: scans, variables by path, snapshots.

A search stores what a frame holds and puts it back, millions of times: by functions made for its layout. Their source
holds numbers only (decision 0018). It stores one flat tuple.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias, Unpack

from plcopen_sfc.errors import Location, ModelError, SimulationError
from plcopen_sfc.languages.binding.name_resolution import Resolver, circle_text
from plcopen_sfc.languages.binding.name_uses import dialect_of
from plcopen_sfc.languages.memory_addresses import MemoryAddress
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.semantics.profile import profile as profile_of
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.code_generation import Writer
from plcopen_sfc.semantics.programs.expressions import Translator
from plcopen_sfc.semantics.programs.places import Place, Unknown
from plcopen_sfc.semantics.programs.project_library import Library, refuse_many_instances
from plcopen_sfc.semantics.programs.runtime import UNREAD, bits_set, coerced
from plcopen_sfc.semantics.programs.runtime_types import Direction, Field, Frame, Layout, Type, leaves
from plcopen_sfc.semantics.programs.scopes import CompiledChart, RunOptions, TranslatedPou

_Store = Callable[[list[Any], int], tuple[Hashable, ...]]
_Load = Callable[[list[Any], Any, int], None]


@dataclass(slots=True)
class _Plan:
    """Plan to store a layout and put it back; `counts` are the variables of all layouts in it at that time."""

    store: _Store
    load: _Load
    counts: dict[Layout, int]

    @property
    def is_current(self) -> bool:
        """True if no layout has grown since."""
        for layout, count in self.counts.items():  # noqa: SIM110  # all() takes twice as long, for every state
            if len(layout.fields) != count:
                return False
        return True


class Snapshots:
    """Stores and puts back what a frame holds: all that a later scan can see, relative to the present."""

    def __init__(self) -> None:
        self._plans: dict[tuple[Layout, frozenset[int]], _Plan] = {}

    def store(self, frame: Frame, now: int, leave_out: frozenset[int] = frozenset()) -> Hashable:
        """Return values that `frame` holds, but for some slots."""
        return self._plan(frame.layout, leave_out).store(frame.v, now)

    def load(self, frame: Frame, stored: Any, now: int, leave_out: frozenset[int] = frozenset()) -> None:
        """Put back what `store` gave."""
        self._plan(frame.layout, leave_out).load(frame.v, stored, now)

    def _plan(self, layout: Layout, leave_out: frozenset[int]) -> _Plan:
        plan = self._plans.get((layout, leave_out))
        if plan is None or not plan.is_current:
            plan = self._plans[layout, leave_out] = _SnapshotWriter().plan(layout, leave_out)
        return plan


@dataclass
class _SnapshotWriter:
    """Writes the functions of one layout, or the loops of an array at some `depth` of arrays.

    `stored` are items of the tuple, `loads` are statements.
    """

    depth: int = 0
    stored: list[str] = dataclasses.field(default_factory=list)
    loads: list[str] = dataclasses.field(default_factory=list)
    counts: dict[Layout, int] = dataclasses.field(default_factory=dict)
    size: int = 0
    """Number of items of the tuple: an item of `stored` may be several."""

    def plan(self, layout: Layout, leave_out: frozenset[int]) -> _Plan:
        """Return the functions."""
        self._frame("v", layout, leave_out)
        source = [
            f"def store(v, now): return ({_items(self.stored)})",
            "def load(v, s0, now):",
            *(f" {line}" for line in self.lines()),
        ]
        return _Plan(*_functions("\n".join(source)), self.counts)

    def _frame(self, v: str, layout: Layout, leave_out: frozenset[int] = frozenset()) -> None:
        self.counts[layout] = len(layout.fields)
        # plain values in slots behind each other are one slice, which takes a fraction of the time
        run: list[int] = []
        for variable in self._seen(layout, leave_out):
            if not _is_plain(variable.type):
                continue
            if run and variable.slot != run[-1] + 1:
                self._run(v, run)
                run = []
            run.append(variable.slot)
        self._run(v, run)
        for variable in self._seen(layout, leave_out):
            if not _is_plain(variable.type):
                self._value(f"{v}[{variable.slot}]", variable.type)

    def _seen(self, layout: Layout, leave_out: frozenset[int]) -> Iterator[Field]:
        """Yield the variables that a later scan can see."""
        for variable in layout.fields:
            kept = variable.direction not in (Direction.CONSTANT, Direction.IN_OUT) and variable.retained
            if kept and variable.slot not in leave_out:
                yield variable

    def _run(self, v: str, slots: list[int]) -> None:
        """Plain values in slots behind each other."""
        if slots:
            values = f"{v}[{slots[0]}:{slots[-1] + 1}]"
            self._add(f"*{values}", f"{values} = s{self.depth}[{self.size}:{self.size + len(slots)}]", len(slots))

    def _value(self, place: str, type_: Type) -> None:
        """Write a value that is no plain one."""
        at = f"s{self.depth}[{self.size}]"
        if isinstance(type_, t.StructureType):
            self._frame(f"{place}.v", type_.layout)
        elif type_ is t.INSTANT:
            self._add(f"None if {place} is None else now - {place}", f"{place} = None if {at} is None else now - {at}")
        elif type_ is t.ELAPSED:
            self._add(place, f"{place} = {at}")
        elif isinstance(type_, t.ArrayOf):
            self._array(place, at, type_)

    def _array(self, place: str, at: str, type_: t.ArrayOf) -> None:
        if _is_plain(type_.base):
            self._add(f"tuple({place})", f"{place}[:] = {at}")
            return
        element = _SnapshotWriter(depth=self.depth + 1, counts=self.counts)
        index = f"i{element.depth}"
        element._value(f"{place}[{index}]", type_.base)
        stored = f"tuple([({_items(element.stored)}) for {index} in range(len({place}))])"
        loop = f"for {index}, s{element.depth} in enumerate({at}):"
        self._add(stored, "\n".join([loop, *(f" {line}" for line in element.lines())]))

    def _add(self, stored: str, load: str, size: int = 1) -> None:
        self.stored.append(stored)
        self.loads.append(load)
        self.size += size

    def lines(self) -> list[str]:
        """Return the lines of the statements."""
        return [line for load in self.loads or ["pass"] for line in load.split("\n")]


@lru_cache(maxsize=4096)  # a comparison makes the same program more than once
def _functions(source: str) -> tuple[_Store, _Load]:
    """Return the functions with this source."""
    made: dict[str, Any] = {}
    exec(compile(source, "<snapshot>", "exec"), made)  # noqa: S102  # numbers of slots, nothing else
    return made["store"], made["load"]


def _is_plain(type_: Type) -> bool:
    """True if a value is stored as it is."""
    return not isinstance(type_, t.StructureType | t.ArrayOf) and type_ is not t.INSTANT and type_ is not t.ELAPSED


def _items(items: list[str]) -> str:
    return "".join(f"{item}, " for item in items)


_MOST_STEPS = 1_000_000


class Controller:
    """Runs the POUs of a project. Edits of the project after that make it wrong.

    `profile` is for charts and their compiler; None: that of the tool that the project is for. `functions` are those
    that the project calls but does not have, by name; they get the arguments of the call. `read_input(path)` gives the
    value of a free input the first time that a scan reads it: of an input of the instance, a global variable or an
    undeclared name that nothing writes and no declaration gives a value. `unknown_calls` has results for calls that
    the project has nothing for; without it they are errors. `max_steps`: turns of loops and calls of functions in a
    scan before it counts as endless. `free_inputs`: variables that nothing writes and that count as inputs though no
    declaration makes them one, or ``all`` of them, but never `not_free`. `marking`: note which assignments are reached
    (`library.marks`). `known_types`: types of undeclared names, in lower case, whose first use tells none.
    """

    def __init__(
        self,
        project: Project,
        profile: str | Profile | None = None,
        *,
        max_steps: int = _MOST_STEPS,
        **options: Unpack[RunOptions],
    ) -> None:
        self.project = project
        self.profile = default_profile(project) if profile is None else profile_of(profile)
        self.max_steps = max_steps
        self.library = Library(project, self.profile, options)
        self.snapshots = Snapshots()
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
        """Return a program, or a new instance of a function block or function.

        Raises `ModelError`, `SimulationError`.
        """
        found = self.project.pou(pou) if isinstance(pou, str) else pou
        library = self.library
        try:
            unit = library.unit(found)
            place = library.program(unit) if unit.is_program else None
            library.use.roots.add(unit.layout)
            refuse_many_instances([t.StructureType(found.name, unit.layout)])
            library.finish()
            frame = library.frame.v[int(place.index)] if place is not None else unit.layout.new()
            library.give_in_outs(unit, frame)
        except RecursionError:
            where = Location(path=found.name)
            circles = Resolver(self.project, dialect_of(self.project)).endless_types()
            why = next(map(circle_text, circles), "an instance is nested too deeply")
            raise SimulationError(why, location=where) from None
        library.processor.left = self.max_steps
        self._initialise(frame)
        for value in library.frame.v:
            self._initialise(value)
        return Instance(self, unit, frame)

    def _check_start(self, field: Field, value: Any) -> None:
        """Refuse start values of an instance that calls methods when it is made: these come in between."""
        unit = self.library.unit_of_layout(value.layout) if field.preset and isinstance(value, Frame) else None
        if unit is not None and (calls := unit.starting()):
            message = f"{field.name} has start values beside {calls[0].name}: the simulator does not know which remain"
            raise SimulationError(message, location=Location(path=unit.pou.name))

    def _initialise(self, value: Any) -> None:
        """Bring charts of new frames into their initial situation: those of nested instances too."""
        if isinstance(value, Frame):
            if id(value) in self._initialised:
                return
            self._initialised[id(value)] = value
            unit: TranslatedPou | None = self.library.unit_of_layout(value.layout)
            for item in value.v:
                self._initialise(item)
            for field in value.layout.fields:
                self._check_start(field, value.v[field.slot])
            if unit is not None:
                unit.initialise(value)
        elif isinstance(value, list):
            for item in value:
                if isinstance(item, Frame | list):
                    self._initialise(item)


@dataclass(frozen=True, slots=True)
class InstanceVariable:
    """A variable that a user can look at: its path, type and direction. `preset`: its declaration gives it a value.

    `is_member`: it is a part of a structure or of an instance.
    """

    path: str
    type: t.Type
    direction: Direction
    preset: bool = False
    is_member: bool = False


@dataclass(frozen=True, slots=True)
class _Cell:
    cells: list[Any]
    index: int
    type: t.Type
    bits: tuple[int, int] | None = None


_Moving: TypeAlias = tuple[Callable[[Frame], tuple[list[Any], int]], Place]
"""Function that finds the value of a variable such as ``fill[i]`` in a frame, and its place as far as it is known."""


class Instance:
    """A program or function block that is executed scan by scan."""

    def __init__(self, controller: Controller, unit: TranslatedPou, frame: Frame) -> None:
        self.controller = controller
        self.unit = unit
        self.frame = frame
        self.scans = 0
        """Scans that were executed so far."""
        self._library = controller.library
        self._processor = controller.library.processor
        self._cells: dict[str, _Cell] = {}
        self._movings: dict[str, _Moving] = {}
        self._run = unit.run
        self._free: list[tuple[list[Any], int, Any]] = []
        self._inner: list[tuple[list[Any], int]] = []
        self._left_out: tuple[frozenset[int], frozenset[int]] = (frozenset(), frozenset())
        self._unseen: frozenset[int] = frozenset()
        self._known = -1
        self._find_free()

    # -- scans

    def scan(self) -> None:
        """Execute the body once. Raises `SimulationError`, which tells the scan, the POU and the line."""
        self.scans += 1
        self._processor.left = self.controller.max_steps
        if self._library.read_input is not None:
            self._find_free()
            for cells, index, _ in self._free:
                cells[index] = UNREAD
        try:
            if self.unit.is_function:
                self._renew()
            self._run(self.frame)
        except SimulationError as error:
            self._say_where(error, error.__traceback__)
            raise
        except ZeroDivisionError as error:
            raise self._said("division by zero", error) from None
        except RecursionError as error:
            raise self._said("functions call each other too deeply (recursion)", error) from None
        except OverflowError as error:
            raise self._said(f"a value is out of range: {error}", error) from None
        except (AttributeError, TypeError) as error:
            # the generated code does not test references, which would take time: one to nothing is None
            if "NoneType" not in str(error):
                raise
            raise self._said("a reference or VAR_IN_OUT that leads to nothing is used", error) from None

    def _renew(self) -> None:
        # a function has no memory: every scan is a new call, with the inputs that were set
        fresh = self.unit.layout.new().v
        for field in self.unit.parameters:
            fresh[field.slot] = self.frame.v[field.slot]
        self.frame.v[:] = fresh

    def _say_where(self, error: SimulationError, traceback: Any) -> None:
        if error.scan is None:
            error.scan = self.scans
        if error.location.path is None:
            error.location = self._library.linker.place(traceback) or Location(path=self.unit.pou.name)

    def _said(self, message: str, error: Exception) -> SimulationError:
        said = SimulationError(message)
        self._say_where(said, error.__traceback__)
        return said

    def _find_free(self) -> None:
        """The cells of free inputs; more may have become known, or some written."""
        library = self._library
        if self._known == library.version:
            return
        self._known = library.version
        for known, slot, value in self._free:
            if known[slot] is UNREAD:
                known[slot] = value
        self._free = []
        library.free_cells.clear()
        own: set[int] = set()
        outer = {slot for slot, value in enumerate(library.frame.v) if value is self.frame}  # it is stored on its own
        for key, path, type_ in self._given() if library.read_input is not None else ():
            parts = key.split(".")
            if parts[0] == "g":
                cells: Any = library.frame.v
            elif library.use.is_key_of(self.unit.layout, key):
                cells = self.frame.v
            else:
                continue
            if len(parts) == 2:
                (outer if parts[0] == "g" else own).add(int(parts[1]))
            for part in parts[1:-1]:
                inner = cells[int(part)]
                cells = inner.v if isinstance(inner, Frame) else inner
            if cells is None:
                continue  # an array of any length that no call passes: a scan that reaches it is an error
            index = int(parts[-1])
            self._free.append((cells, index, t.default(type_)))
            library.free_cells[id(cells), index] = path
        outermost = id(library.frame.v), id(self.frame.v)
        self._inner = [(cells, index) for cells, index, _ in self._free if id(cells) not in outermost]
        self._left_out = (self._unseen | own, frozenset(outer))

    # -- variables

    def __getitem__(self, path: str) -> Any:
        cell = self._cell(path)
        value = cell.cells[cell.index]
        if value is UNREAD and isinstance(cell.type, t.ScalarType):
            return t.default(cell.type)
        if cell.bits is not None:
            start, width = cell.bits
            part = value >> start & (1 << width) - 1
            return bool(part) if width == 1 else part
        return value

    def __setitem__(self, path: str, value: Any) -> None:
        cell = self._cell(path)
        if not isinstance(cell.type, t.ScalarType):
            raise ModelError(f"{path} is a {cell.type.name}: only values of elementary types can be given")
        given = coerced(value, cell.type)
        if cell.bits is not None:
            given = bits_set(cell.cells[cell.index], *cell.bits, int(given))
        cell.cells[cell.index] = given

    def __contains__(self, path: object) -> bool:
        try:
            self._cell(str(path))
        except (ModelError, SimulationError):
            return False
        return True

    def cell(self, path: str) -> tuple[list[Any], int]:
        """Return a list and the index in it where the value of a variable is, for quick access. Raises `ModelError`."""
        if self._moving(path) is not None:
            raise ModelError(f"{path} is another variable whenever its index or reference changes")
        cell = self._cell(path)
        if cell.bits is not None:
            raise ModelError(f"{path} is a part of a variable")
        return cell.cells, cell.index

    def type_of(self, path: str) -> t.Type:
        """Return the type of a variable, which that of `fill[i]` has whatever `i` is now. Raises `ModelError`."""
        moving = self._moving(path)
        return moving[1].type if moving is not None else self._cell(path).type

    def reader(self, paths: Sequence[str]) -> Callable[[], tuple[Any, ...]]:
        """A function that gives the values of some variables; `UNREAD` for free inputs that nothing has asked for."""
        if any(self._cell(path).bits is not None for path in paths):
            return lambda: tuple(self[path] for path in paths)
        if any(self._moving(path) is not None for path in paths):
            return lambda: tuple(cell.cells[cell.index] for cell in map(self._cell, paths))
        cells = [self.cell(path) for path in paths]
        return lambda: tuple([values[index] for values, index in cells])

    def inputs(self) -> Mapping[str, t.Type]:
        """Return variables that a user gives a value, by path, with their types: see `VariableUse.given`."""
        return {path: type_ for _, path, type_ in self._given()}

    def _given(self) -> Iterator[tuple[str, str, t.ScalarType]]:
        for key, path, type_ in self._library.use.given():
            yield key, self._outer(path) if key.startswith("g.") else path, type_

    def _outer(self, path: str) -> str:
        """Return the path of a global variable, ``.a`` where the POU has an ``a`` of its own."""
        own = self.unit.layout.find(re.split(r"[.\[]", path)[0])
        is_same = own is None or own.direction in (Direction.EXTERNAL, Direction.IN_OUT)
        return path if is_same else f".{path}"

    def variables(self) -> Mapping[str, InstanceVariable]:
        """Return all variables that a user sees, by path: those of the instance, then global ones that are used."""
        found: dict[str, InstanceVariable] = {}

        def add(path: str, field: Field, direction: Direction, cells: list[Any], index: int, *, member: bool) -> None:
            if path not in found:
                found[path] = InstanceVariable(path, field.type, direction, field.preset, member)
                if field.direction is not Direction.IN_OUT:  # there is a pointer in its place
                    self._cells.setdefault(path.casefold(), _Cell(cells, index, field.type))

        for path, field, cells, index in leaves(self.frame):
            member = "." in path
            add(path, field, Direction.LOCAL if member else field.direction, cells, index, member=member)
        outer = self._library.frame.v
        for field in [field for field in self._library.globals.fields if not field.hidden]:
            value = outer[field.slot]
            if isinstance(value, Frame) and value is not self.frame:
                for path, inner, cells, index in leaves(value, f"{self._outer(field.name)}."):
                    add(path, inner, Direction.EXTERNAL, cells, index, member=True)
            elif value is not self.frame:
                add(self._outer(field.name), field, field.direction, outer, field.slot, member=False)
        return found

    @contextmanager
    def adding_nothing(self) -> Iterator[None]:
        """Let an undeclared name be an error: states that were kept have no value for one more variable."""
        self._library.is_complete = True
        try:
            yield
        finally:
            self._library.is_complete = False

    def addresses(self) -> Mapping[str, MemoryAddress]:
        """Return the direct addresses of variables, by their paths."""
        return self._library.image.addresses()

    def charts(self) -> list[tuple[str, CompiledChart, Frame]]:
        """Return the charts of the instance and of instances in it: path, chart, and the frame that it works on."""
        return list(self._charts(self.frame, ""))

    def called_charts(self) -> list[tuple[str, CompiledChart, Frame]]:
        """Return the charts of `charts`, and those of programs and global instances that texts name."""
        found = self.charts()
        for field in self._library.globals.fields:
            inner = self._library.frame.v[field.slot] if field.slot < len(self._library.frame.v) else None
            if isinstance(inner, Frame) and inner is not self.frame and not field.hidden:
                found += self._charts(inner, f"{field.name}.")
        return found

    def _charts(self, frame: Frame, path: str) -> Iterator[tuple[str, CompiledChart, Frame]]:
        unit = self._library.unit_of_layout(frame.layout)
        while unit is not None:
            for name, chart in unit.charts:
                yield f"{path}{name.partition('.')[2]}".rstrip("."), chart, frame
            unit = unit.base
        for field in frame.layout.fields:
            inner = frame.v[field.slot]
            if isinstance(inner, Frame) and not field.hidden and field.direction is not Direction.IN_OUT:
                yield from self._charts(inner, f"{path}{field.name}.")

    def _cell(self, path: str) -> _Cell:
        """Return where the value of a variable is now. Raises `ModelError`."""
        moving = self._moving(path)
        if moving is None:
            return self._cells[path.casefold()]
        find, place = moving
        try:
            cells, index = find(self.frame)
        except (SimulationError, AttributeError, TypeError) as error:
            raise ModelError(f"{path} cannot be reached: {error}") from None
        return _Cell(cells, index, place.type, place.bits)

    def _moving(self, path: str) -> _Moving | None:
        """Finder of a variable whose place depends on an index or a reference; None for one that stays in its cell."""
        key = path.casefold()
        if key in self._cells:
            return None
        if key not in self._movings:
            found = self._find(path)
            if isinstance(found, _Cell):
                self._cells[key] = found
                return None
            self._movings[key] = found
        return self._movings[key]

    def _find(self, path: str) -> _Cell | _Moving:
        if path.startswith(".") and (outer := self._library.globals.find(path[1:])) is not None:
            return _Cell(self._library.frame.v, outer.slot, outer.type)
        if self._library.implicit_type(path) is not None and self._outer(path) == path:
            field = self._library.globals.by_name[path.casefold()]
            return _Cell(self._library.frame.v, field.slot, field.type)
        parsed = parse_expression(path, self._library.dialect)
        if parsed.problems:
            own = self.unit.layout.find(path)
            if own is None:
                raise ModelError(f"{path!r} is no path of a variable: {parsed.problems[0].message}")
            return _Cell(self.frame.v, own.slot, own.type)
        try:
            place = self._place(parsed.tree)
            self._make_room()
            return self._fixed(place) if place.key else (self._finder(place), place)
        except SimulationError as error:
            raise ModelError(error.message, hint=error.hint) from None
        except (AttributeError, TypeError) as error:
            raise ModelError(f"{path} cannot be reached: {error}") from None

    def _make_room(self) -> None:
        """Give variables cells that nothing but a path that was asked for names."""
        if len(self._library.globals.fields) > len(self._library.frame.v):
            self._library.grow()

    def _place(self, tree: n.Expression) -> Place:
        translator = Translator(self.unit.scope, Writer())
        try:
            found = translator.meaning(tree)
        finally:
            self._make_room()
        if isinstance(found, Unknown):
            field = self._library.globals.find(found.path)
            if field is None:
                raise SimulationError(f"there is no variable {found.path}", hint=self._similar(found.path))
            return self._library.place(field, found.path)
        return translator.place(tree)

    def _similar(self, name: str) -> str:
        from difflib import get_close_matches  # noqa: PLC0415  # only for a message

        near = get_close_matches(name, [*self.variables()], 3)
        return f"close to it: {', '.join(near)}" if near else ""

    def _fixed(self, place: Place) -> _Cell:
        start, *slots = place.key.split(".")
        cells: Any = self._library.frame.v if start == "g" else self.frame.v
        for slot in slots[:-1]:
            inner = cells[int(slot)]
            cells = inner.v if isinstance(inner, Frame) else inner
        return _Cell(cells, int(slots[-1]), place.type, place.bits)

    def _finder(self, place: Place) -> Callable[[Frame], tuple[list[Any], int]]:
        writer = Writer()
        writer.write("v = f.v")
        writer.write(f"return {place.cells}, {place.index}")
        finder: Callable[[Frame], tuple[list[Any], int]] = self._library.linker.routine("f", writer, self.unit.pou.name)
        self._library.link()
        return finder

    # -- snapshots

    def leave_out(self, slots: frozenset[int]) -> None:
        """Have snapshots from now on without some variables of the instance, whose values no later scan sees."""
        self._unseen = slots
        self._known = -1

    def snapshot(self) -> Hashable:
        """All that a later scan can see: of the instance and of global variables, but not the values of free inputs.

        Times are relative to `controller.now`, so that equal situations at different times have equal snapshots.
        """
        self._find_free()
        for cells, index in self._inner:
            cells[index] = UNREAD
        snapshots, now = self.controller.snapshots, self._processor.now
        own, outer = self._left_out
        return snapshots.store(self._library.frame, now, outer), snapshots.store(self.frame, now, own)

    def restore(self, snapshot: Any) -> None:
        """Put back what `snapshot` gave; times go on from `controller.now`."""
        snapshots, now = self.controller.snapshots, self._processor.now
        own, outer = self._left_out
        snapshots.load(self._library.frame, snapshot[0], now, outer)
        snapshots.load(self.frame, snapshot[1], now, own)
