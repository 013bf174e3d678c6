"""All POUs, types and global variables of a project, each translated when something first needs it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import product
from typing import Any, Protocol, TypeGuard

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.binding.name_scopes import Scopes, namespace_place, variables_in
from plcopen_sfc.languages.binding.symbols import Declaration, Kind, Level
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.model import types as m
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project import PouInstance, Project, Tag
from plcopen_sfc.model.sfc import SfcFlag, SfcNetwork
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs import runtime
from plcopen_sfc.semantics.programs import types as t
from plcopen_sfc.semantics.programs.addresses import Image
from plcopen_sfc.semantics.programs.code import Code, Converter
from plcopen_sfc.semantics.programs.declared_types import Initials, TypeReader
from plcopen_sfc.semantics.programs.linking import Linker, Writer
from plcopen_sfc.semantics.programs.marks import UNSEEN, Marks
from plcopen_sfc.semantics.programs.places import ANYWHERE, Place, Space
from plcopen_sfc.semantics.programs.scopes import Scope
from plcopen_sfc.semantics.programs.standard_blocks import BlockType, BlockTypes
from plcopen_sfc.semantics.programs.types import MOST_ELEMENTS, Direction, Field, Frame, Layout
from plcopen_sfc.semantics.programs.units import MethodUnit, Unit
from plcopen_sfc.semantics.programs.unknown_calls import UnknownBlocks, UnknownCalls


class CompiledChart(Protocol):
    """A chart as a chart compiler makes it."""

    def translate(self) -> None:
        """Translate conditions and actions: all POUs are declared now."""

    def initialise(self, frame: Frame) -> None:
        """Bring a new frame of the POU into the initial situation."""

    def execute(self, frame: Frame) -> None:
        """One call of the body."""


ChartCompiler = Callable[[SfcNetwork, Scope, str], CompiledChart]

ALL_FREE = "all"
"""Stands for all variables that could be inputs."""

_FLAGS = frozenset(flag.variable.casefold() for flag in SfcFlag)
_LIBRARIES = frozenset({"standard", "tc2_standard", "tc2_system", "util", "standard64"})
_RUNTIME = """
    Frame Pointer View assign bit_set bits_set character_at cloned code_at divided endless fail half_away
    half_even named narrow out_of_bounds power preset put remainder single truncated wrapped
""".split()


class Library:
    """All that a controller runs of a project. Edits of the project make it wrong."""

    def __init__(
        self,
        project: Project,
        profile: Profile,
        functions: Mapping[str, Callable[..., Any]],
        chart_compiler: ChartCompiler | None,
        read_input: Callable[[str], Any] | None,
        *,
        free_inputs: Iterable[str] = (),
        not_free: Iterable[str] = (),
        marking: bool = False,
        unknown_calls: UnknownCalls | None = None,
    ) -> None:
        self.project = project
        self.profile = profile
        """For charts: how they are executed. The controller sets it."""
        self.dialect = project.dialect
        self.is_codesys = self.dialect in (Dialect.CODESYS, Dialect.TWINCAT)
        self.functions = {name.casefold(): function for name, function in functions.items()}
        self.chart_compiler = chart_compiler
        self.read_input = read_input
        self.names = Scopes(project)
        self.processor = runtime.Processor()
        self.linker = Linker()
        self.converter = Converter(self.dialect, self.linker)
        self.blocks = BlockTypes(self.dialect, self.processor)
        self.initials = Initials(self)
        self.types = TypeReader(self)
        self.globals = Layout("global variables")
        self.frame = Frame(self.globals, [])
        self.scope = Scope(self, "", self.globals)
        self.image = Image(self)
        self.undeclared: dict[str, t.Type] = {}
        self.missing: dict[str, str] = {}
        self.problems: list[SimulationError] = []
        self.written: set[str] = set()
        self.inputs: dict[str, tuple[str, t.Type]] = {}
        """Variables that are read and may be given from outside, by key: path and type; see `given`."""
        self.read: dict[str, tuple[str, t.Type]] = {}
        """Variables that are read besides inputs."""
        self.numbers: dict[int, None] = {}
        """The integers in the texts: what values of inputs may be compared with."""
        self.masks: dict[int, None] = {}
        """Bits of integers that are looked at: one that is read, or the constant of an AND, OR or XOR."""
        self.shifts: dict[int, None] = {}
        """By how many bits integers are shifted, and where parts of them begin; 0 where a remainder is taken."""
        self.passed: dict[str, dict[int, Field]] = {}
        """The VAR_IN_OUT that variables are passed to, by the keys of these."""
        self.parameters: dict[int, str] = {}
        """The keys of VAR_IN_OUT that a text uses."""
        self.pointed: set[str] = set()
        """The keys of what references lead to."""
        self.references: set[str] = set()
        """The keys of VAR_IN_OUT: what they refer to may be a free input."""
        self._asking: set[str] = set()
        self._in_outs: set[str] = set()
        """The keys of the variables that VAR_IN_OUT of what runs refer to."""
        self.free_cells: dict[tuple[int, int], str] = {}
        """The paths of free inputs by the lists that hold them and the places in these."""
        self.marks = Marks() if marking else None
        self._freed = frozenset(name.casefold() for name in free_inputs)
        self._not_free = _FLAGS | {name.casefold() for name in not_free}
        self.version = 0
        """Grows when new things were linked."""
        self.roots: set[Unit] = set()
        self._units: dict[int, Unit] = {}
        self._waiting: list[Unit] = []
        self._fields: dict[int, Place] = {}
        self._open: set[int] = set()
        self._implicit: dict[str, Place] = {}
        self._values: dict[int, Code] | None = None
        self._dispatching: dict[str, Callable[..., Frame]] = {}
        self._news: dict[Layout, Callable[..., Any]] = {}
        self.unknown = UnknownBlocks(self, unknown_calls) if unknown_calls is not None else None
        namespace = self.linker.namespace
        if self.unknown is not None:
            namespace.update({"unknown_call": self.unknown.call, "unknown_value": self.unknown.value})
        namespace.update({name: getattr(runtime, name) for name in _RUNTIME})
        namespace.update({"coerced": runtime.coerced, "U": runtime.UNREAD, "p": self.processor})
        namespace.update({"g": self.frame.v, "fetch": self._fetch, "asked": self._asked})
        if self.marks is not None:
            namespace.update({"m": self.marks.reached, "w": self.marks.watched, "Unseen": UNSEEN})

    def _fetch(self, cells: list[Any], index: int) -> Any:
        """A value, which is asked for where it is a free input that the scan has not read yet."""
        value = cells[index]
        if value is runtime.UNREAD:
            assert self.read_input is not None  # noqa: S101  # nothing is free else
            value = cells[index] = self.read_input(self.free_cells[id(cells), index])
        return value

    def _asked(self, value: Any) -> Any:
        """A structure or an array in which all free inputs were asked for."""
        cells = value.v if isinstance(value, Frame) else value.cells if isinstance(value, runtime.View) else value
        for index, each in enumerate(cells):
            if each is runtime.UNREAD:
                self._fetch(cells, index)
            elif type(each) is Frame or type(each) is list:
                self._asked(each)
        return value

    # -- units

    def unit(self, pou: Pou) -> Unit:
        """A POU, declared and waiting to be translated."""
        found = self._units.get(id(pou))
        if found is None:
            found = self._units[id(pou)] = Unit(self, pou)
            self._waiting.append(found)
            found.declare()
        return found

    def unit_of_layout(self, layout: Layout) -> Unit | None:
        """The POU whose variables a layout has."""
        return next((unit for unit in self._units.values() if unit.layout is layout), None)

    def is_overridden(self, method: MethodUnit) -> bool:
        """True if a POU that extends the one of a method has another one of its name."""
        key, owner = method.name.casefold(), method.pou
        others = (
            pou for pou in self.project.pous if pou is not owner and any(m.name.casefold() == key for m in pou.methods)
        )
        return any(self._extends(pou, owner) for pou in others)

    def _extends(self, pou: Pou, owner: Pou) -> bool:
        seen: list[Pou] = []
        base = self.names.base(pou)
        while base is not None and base is not owner and base not in seen:
            seen.append(base)
            base = self.names.base(base)
        return base is owner

    def dispatching(self, name: str) -> Callable[..., Frame]:
        """Function that enters the method of this name that the POU of a frame has."""
        found = self._dispatching.get(name.casefold())
        if found is None:
            known: dict[Layout, Callable[..., Frame]] = {}

            def enter(frame: Frame, *arguments: Any) -> Frame:
                if frame.layout not in known:
                    unit = self.unit_of_layout(frame.layout)
                    method = unit.method(name) if unit is not None else None
                    assert method is not None  # noqa: S101  # what is derived has it
                    known[frame.layout] = method.enter
                return known[frame.layout](frame, *arguments)

            found = self._dispatching[name.casefold()] = enter
        return found

    def block_of(self, layout: Layout) -> BlockType | None:
        """The standard function block whose variables a layout has."""
        return self.blocks.of_layout(layout)

    @property
    def known_libraries(self) -> frozenset[str]:
        """Names that stand before a dot and mean a library of the tool."""
        return _LIBRARIES

    def implicit_type(self, path: str) -> t.Type | None:
        """The type of an external that nobody declares, if it is known already."""
        found = self._implicit.get(path.casefold())
        return found.type if found is not None else None

    def finish(self) -> None:
        """Translate all that waits, and link it."""
        done: list[Unit] = []
        while self._waiting:
            unit = self._waiting.pop(0)
            unit.translate()
            done.append(unit)
        for unit in done:
            unit.finish()
        self.grow()

    def grow(self) -> None:
        """Link what is new, and give new global variables their first values."""
        start = len(self.frame.v)
        fields = self.globals.fields[start:]
        writer = Writer()
        for field in fields:
            writer.write(f"g.append({field.initial})")
        added = self.linker.routine("", writer, "global variables") if fields else None
        self.version += 1
        self.link()
        if added is not None:
            added()

    def give_in_outs(self, unit: Unit, frame: Frame) -> None:
        """Nobody calls the outermost instance: its VAR_IN_OUT refer to variables of their own."""
        missing = [
            field
            for field in unit.layout.fields
            if field.direction is Direction.IN_OUT
            and frame.v[field.slot] is None
            and not (isinstance(field.type, t.ArrayType) and not field.type.dimensions)
        ]
        slots = []
        for field in missing:
            if _is_plain(field.type) and not isinstance(field.type, t.ElementaryType):
                self.inputs.setdefault(self.key(unit.layout, field.slot), (field.name, field.type))
            made = self.globals.add(f"(of {unit.pou.name}) {field.name}", field.type, hidden=True)
            made.initial = self.initials.default(field.type)
            slots.append(made.slot)
            if isinstance(field.type, t.ElementaryType):
                self.inputs[f"g.{made.slot}"] = field.name, field.type
                self._in_outs.add(f"g.{made.slot}")
        self.grow()
        for field, slot in zip(missing, slots, strict=True):
            plain = isinstance(field.type, t.ElementaryType | t.ReferenceType | t.OpaqueType)
            cells = self.frame.v
            frame.v[field.slot] = runtime.Pointer(cells, slot) if plain else cells[slot]

    def link(self) -> None:
        """Link what is new."""
        unknown = len(self.unknown) if self.unknown is not None else 0
        passed = sum(map(len, self.passed.values())) + len(self.pointed)
        known = (
            (len(self.written), passed, len(self.inputs), len(self.roots), unknown)
            if self.read_input is not None
            else None
        )
        self.problems += self.linker.link(self.is_free, known)

    def is_free(self, key: str) -> bool:
        """True if the variable of this key, or a part of it, is read from `read_input`."""
        if self.read_input is None:
            return False
        return key == ANYWHERE or ".".join(key.split(".")[:2]) in self.references or self._may_be_given(key)

    def _may_be_given(self, key: str) -> bool:
        """True if a variable is one of the surroundings: VAR_INPUT and VAR_IN_OUT, and others that nothing writes."""
        if key not in self.inputs or (self.unknown is not None and self.unknown.owns(self.inputs[key][0])):
            return False
        return self._is_passed(key) or (self._is_root(key) and not self._is_written(key))

    def key(self, layout: Layout, slot: int) -> str:
        """The key of a variable of a POU, the same in all that extend it."""
        return f"{self.linker.name(layout.owner(slot), 'l')}.{slot}"

    def is_key_of(self, layout: Layout, key: str) -> bool:
        """True if a key is that of a variable of a POU, or of a part of one."""
        start, slot = key.split(".")[:2]
        return start != "g" and int(slot) < len(layout.fields) and self.key(layout, int(slot)) == f"{start}.{slot}"

    def _is_root(self, key: str) -> bool:
        return key.startswith("g.") or any(self.is_key_of(unit.layout, key) for unit in self.roots)

    def _is_passed(self, key: str) -> bool:
        """True for parameters of what runs: each call gives them a value, whatever the call before has written."""
        field = self._field(key)
        if field.direction not in (Direction.INPUT, Direction.IN_OUT) or not self._is_root(key):
            return key in self._in_outs
        type_ = field.type
        for slot in key.split(".")[2:]:
            if isinstance(type_, t.StructureType):
                if type_.layout.is_instance:
                    return False  # what it does is known
                type_ = type_.layout.fields[int(slot)].type
            elif isinstance(type_, t.ArrayType):
                type_ = type_.base
        return not (isinstance(type_, t.StructureType) and type_.layout.is_instance)

    def _field(self, key: str) -> Field:
        """The variable that the thing of a key is, or is a part of."""
        start, slot = key.split(".")[:2]
        layout = self.globals if start == "g" else self.linker.namespace[start]
        field: Field = layout.fields[int(slot)]
        return field

    def given(self) -> Iterator[tuple[str, str, t.ElementaryType]]:
        """Variables with values from outside: single variables, members and elements, by key, with path and type.

        Each input of what runs that is read, and other variables that nothing writes and whose declaration says no
        value. The one place that decides it: for proofs, for directed runs, and for simulation.
        """
        return ((key, path, type_) for key, path, type_ in self._parts_given() if _is_value(type_))

    def not_given(self) -> list[str]:
        """The paths of inputs that are read and keep their values: large arrays, references, what these lead to."""
        found = [path for _, path, type_ in self._parts_given() if not _is_value(type_)]
        pointed = [
            key for key in self.pointed if key in self.inputs and not self._is_passed(key) and self._is_root(key)
        ]
        return found + sorted(self.inputs[key][0] for key in pointed if key not in self.written)

    def _parts_given(self) -> Iterator[tuple[str, str, t.Type]]:
        seen: set[str] = set()
        for key, (path, type_) in list(self.inputs.items()):
            if not self._may_be_given(key):
                continue
            for inner, name, part in _parts(key, path, type_):
                if inner not in seen and (self._is_passed(inner) or not self._is_written(inner)):
                    seen.add(inner)
                    yield inner, name, part

    def is_written_inside(self, key: str) -> bool:
        """True if anything writes a variable, a part of it, or what it is a part of."""
        inner = f"{key}."
        if self._is_written(key) or any(each.startswith(inner) for each in (*self.written, *self.pointed)):
            return True
        return any(self._is_passed_on(each) for each in self.passed if each.startswith(inner))

    def _is_written(self, key: str) -> bool:
        parts = key.split(".")
        around = [".".join(parts[:end]) for end in range(1, len(parts) + 1)]
        return any(each in self.written or each in self.pointed or self._is_passed_on(each) for each in around)

    def _is_passed_on(self, key: str) -> bool:
        """True if a variable is passed to a VAR_IN_OUT that is written."""
        if key in self._asking:  # functions may call themselves
            return False
        self._asking.add(key)
        try:
            inner = [
                self.parameters[id(field)]
                for field in self.passed.get(key, {}).values()
                if id(field) in self.parameters
            ]
            return any(map(self.is_written_inside, inner))
        finally:
            self._asking.discard(key)

    def new_name(self, layout: Layout) -> str:
        """The name of the function that makes frames of a layout."""
        found = self._news.get(layout)
        if found is None:
            found = self._news[layout] = self.linker.reserve("new")
            layout.new = found
            layout.new_name = self.linker.name(found)
            if layout.is_instance and not any(unit.layout is layout for unit in self._units.values()):
                self.initials.link(layout)  # a standard block
        return layout.new_name

    def maker(self, layout: Layout, writer: Writer) -> None:
        """`writer` has the body of the function that makes frames of `layout`."""
        self.new_name(layout)
        self.linker.routine("", writer, layout.name, self._news[layout])

    def is_freed(self, field: Field) -> bool:
        """True if the user wants a variable as an input that its declaration does not make one."""
        if not field.declared or not _is_plain(field.type):
            return False
        if field.direction not in (Direction.LOCAL, Direction.EXTERNAL) or field.name.casefold() in self._not_free:
            return False
        return ALL_FREE in self._freed or field.name.casefold() in self._freed

    def frozen(self) -> Iterator[str]:
        """The paths of declared variables that are read, that nothing writes, and that are no inputs."""
        for key, (path, _) in self.read.items():
            field = self._field(key)
            plain = field.declared and field.name.casefold() not in _FLAGS and _is_plain(field.type)
            known = field.direction in (Direction.LOCAL, Direction.EXTERNAL)
            if plain and known and self._is_root(key) and not self._is_written(key):
                root = ".".join(key.split(".")[:2])
                yield path if self.is_written_inside(root) else field.name

    # -- global names

    def meaning(self, declaration: Declaration) -> Any:
        """Meaning of a global declaration: a `Place`, a `Code`, a `Space`, a `Unit` or a type."""
        holder: Any = declaration.holder
        kind = declaration.kind
        if kind is Kind.POU:
            return self.unit(holder)
        if kind is Kind.DATA_TYPE:
            return self.types.of_declaration(declaration)
        if kind is Kind.ENUM_VALUE:
            return self._enumeration_value(declaration)
        if kind is Kind.GLOBAL_LIST:
            level = Level()
            for section in declaration.holders:
                for inner in variables_in(section):  # type: ignore[arg-type]  # only sections are lists
                    level.add(inner)
            return Space(level, declaration.path)
        if kind is Kind.NAMESPACE:
            return Space(self.names.place(namespace_place(self.project, holder)), declaration.path)
        return self.variable(declaration)

    def variable(self, declaration: Declaration) -> Place:
        """The place of a global variable, a tag, a data block or a program instance."""
        holder: Any = declaration.holder
        found = self._fields.get(id(holder))
        if found is None:
            if id(holder) in self._open:
                raise SimulationError(f"the value of {declaration.path} depends on itself")
            self._open.add(id(holder))
            try:
                found = self._fields[id(holder)] = self._make(declaration, holder)
            finally:
                self._open.discard(id(holder))
        return found

    def _make(self, declaration: Declaration, holder: Any) -> Place:
        path = declaration.path
        if isinstance(holder, m.Variable):
            type_ = self.types.read(holder.type, self.scope)
            if holder.address and isinstance(type_, t.ElementaryType) and "*" not in holder.address:
                return self.image.place(holder.address, type_, path, holder.initial)
            return self.add(path, type_, holder.initial, constant=self._is_constant(holder))
        if isinstance(holder, Tag):
            type_ = self.types.named(holder.type, self.scope)
            if holder.address and isinstance(type_, t.ElementaryType):
                return self.image.place(holder.address, type_, path, None)
            return self.add(path, type_, None)
        if isinstance(holder, DataBlock):
            type_ = self._of_block(holder)
            return self.add(path, type_, _values_of(holder, type_))
        if isinstance(holder, PouInstance):
            return self.add(path, self.types.named(holder.type_name, self.scope), None)
        raise SimulationError(f"{declaration} is no variable")

    def _is_constant(self, variable: m.Variable) -> bool:
        if self._constants is None:
            self._constants = {id(v) for s in self.project.global_sections() if s.constant for v in s.variables}
            self._constants |= {id(v) for table in self.project.tag_tables for v in table.constants}
        return id(variable) in self._constants

    _constants: set[int] | None = None

    def _of_block(self, block: DataBlock) -> t.Type:
        if block.type_name:
            found = self.types.named(block.type_name, self.scope)
            if isinstance(found, t.StructureType):
                return found
        layout = Layout(block.name)
        for section in block.interface.sections if block.interface is not None else ():
            for variable in section.variables:
                made = layout.add(variable.name, self.types.read(variable.type, self.scope))
                self.initials.give(made, variable.initial, self.scope)
        self.initials.link(layout)
        return t.StructureType(block.name, layout)

    def add(self, path: str, type_: t.Type, initial: m.Value | None, *, constant: bool = False) -> Place:
        """A new global variable."""
        probe = Field(path, -1, type_, Direction.CONSTANT if constant else Direction.EXTERNAL)
        self.initials.give(probe, initial, self.scope)
        made = self.globals.add(path, type_, probe.direction)
        made.initial, made.value, made.preset = probe.initial, probe.value, probe.preset
        made.declared = True
        return self.place(made, path)

    def place(self, field: Field, path: str) -> Place:
        """The place of a global variable."""
        key = f"g.{field.slot}"
        return Place(
            "g",
            str(field.slot),
            field.type,
            path,
            key,
            key,
            field=field,
            input=field.direction is not Direction.CONSTANT and (not field.preset or self.is_freed(field)),
        )

    def implicit(self, path: str, type_: t.Type) -> Place:
        """Something that nobody declares: an external variable."""
        key = path.casefold()
        found = self._implicit.get(key)
        if found is None:
            self.undeclared[path] = type_
            found = self._implicit[key] = self.add(path, type_, None)
        return found

    def members_of(self, path: str) -> Iterator[tuple[str, int, t.ElementaryType, bool]]:
        """Members that programs use of an instance of an unknown type: name, slot, type, and whether they write it."""
        start = f"{path.casefold()}."
        for key, place in sorted(self._implicit.items()):
            if key.startswith(start) and isinstance(place.type, t.ElementaryType) and place.field is not None:
                yield key.removeprefix(start), place.field.slot, place.type, self._is_written(place.key)

    def _enumeration_value(self, declaration: Declaration) -> Code:
        if self._values is None:
            self._values = {}
            for holder in self.project.data_types:
                if isinstance(holder.type, m.EnumType):
                    self._know(
                        holder.type,
                        self.types.of_declaration(Declaration(Kind.DATA_TYPE, holder.name, (holder,))),
                    )
        code = self._values.get(id(declaration.holder))
        if code is None:
            raise SimulationError(f"{declaration.path} is a value of an enumeration that has no name")
        return code

    def _know(self, model: m.EnumType, type_: t.Type) -> None:
        assert self._values is not None and isinstance(type_, t.ElementaryType)  # noqa: S101, PT018
        for value in model.values:
            number = type_.names[value.name.casefold()]
            self._values[id(value)] = Code(repr(number), type_, number, number, number, constant=True)

    def program(self, unit: Unit) -> Place:
        """The only instance of a program."""
        found = self._fields.get(id(unit))
        if found is None:
            found = self._fields[id(unit)] = self.add(unit.pou.name, t.StructureType(unit.pou.name, unit.layout), None)
        return found

    def scope_of_type(self, holder: m.DataTypeDeclaration) -> Scope:
        """The scope in which a data type is declared."""
        return Scope(self, holder.name, self.globals, place=holder.place) if holder.place else self.scope


def _values_of(block: DataBlock, type_: t.Type) -> m.StructValue | None:
    """The start values that an instance data block has and the type of which it is one has not."""
    if block.type_name is None or block.interface is None or not isinstance(type_, t.StructureType):
        return None
    members = [
        m.MemberValue(member=variable.name, value=variable.initial)
        for variable in block.interface.variables()
        if variable.initial is not None and type_.layout.find(variable.name) is not None
    ]
    return m.StructValue(members=members) if members else None


def _is_value(type_: t.Type) -> TypeGuard[t.ElementaryType]:
    return isinstance(type_, t.ElementaryType) and type_.family is not t.Family.SPECIAL


def _is_plain(type_: t.Type) -> bool:
    """True for single values, and for structures and arrays of them."""
    if isinstance(type_, t.StructureType):
        return not type_.layout.is_instance and all(_is_plain(field.type) for field in type_.layout.fields)
    return _is_plain(type_.base) if isinstance(type_, t.ArrayType) else isinstance(type_, t.ElementaryType)


def _parts(key: str, path: str, type_: t.Type) -> Iterator[tuple[str, str, t.Type]]:
    """The single values in a variable, and what of it has none, or too many: key, path and type."""
    if isinstance(type_, t.StructureType) and not type_.layout.is_instance:
        for field in type_.layout.fields:
            yield from _parts(f"{key}.{field.slot}", f"{path}.{field.name}", field.type)
    elif isinstance(type_, t.ArrayType) and 0 < type_.size <= MOST_ELEMENTS:
        indices = product(*(range(lower, upper + 1) for lower, upper in type_.dimensions))
        for slot, index in enumerate(indices):
            yield from _parts(f"{key}.{slot}", f"{path}[{','.join(map(str, index))}]", type_.base)
    else:
        yield key, path, type_
