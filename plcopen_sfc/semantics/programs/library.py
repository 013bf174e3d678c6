"""All POUs, types and global variables of a project, each translated when something first needs it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Protocol

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.names.declarations import Declaration, Kind, Level
from plcopen_sfc.languages.names.scopes import Scopes, namespace_place, variables_in
from plcopen_sfc.model import types as m
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project import PouInstance, Project, Resource, Tag
from plcopen_sfc.model.sfc import SfcFlag, SfcNetwork
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs import runtime
from plcopen_sfc.semantics.programs import types as t
from plcopen_sfc.semantics.programs.addresses import Image
from plcopen_sfc.semantics.programs.code import Code, Converter
from plcopen_sfc.semantics.programs.declared_types import Initials, TypeReader
from plcopen_sfc.semantics.programs.layouts import Direction, Field, Frame, Layout
from plcopen_sfc.semantics.programs.linking import Linker, Writer
from plcopen_sfc.semantics.programs.marks import Marks
from plcopen_sfc.semantics.programs.places import Place, Space
from plcopen_sfc.semantics.programs.scopes import Scope
from plcopen_sfc.semantics.programs.standard_blocks import BlockType, BlockTypes
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
    """What a controller runs. Edits of the project make it wrong."""

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
        self.inputs: dict[str, tuple[str, Field]] = {}
        self.read: dict[str, tuple[str, Field]] = {}
        """What is read besides inputs, by key: its path and field."""
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
        namespace.update({"g": self.frame.v, "ask": self._ask})
        if self.marks is not None:
            namespace["m"] = self.marks.reached

    def _ask(self, cells: list[Any], index: int, path: str) -> Any:
        assert self.read_input is not None  # noqa: S101  # nothing is free else
        value = cells[index] = self.read_input(path)
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
        """Whether a POU that extends the one of a method has another one of its name."""
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
        """What enters the method of this name that the POU of a frame has."""
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
            made = self.globals.add(f"(of {unit.pou.name}) {field.name}", field.type, hidden=True)
            made.initial = self.initials.default(field.type)
            slots.append(made.slot)
        self.grow()
        for field, slot in zip(missing, slots, strict=True):
            plain = isinstance(field.type, t.ElementaryType | t.ReferenceType | t.OpaqueType)
            cells = self.frame.v
            frame.v[field.slot] = runtime.Pointer(cells, slot) if plain else cells[slot]

    def link(self) -> None:
        """Link what is new."""
        unknown = len(self.unknown) if self.unknown is not None else 0
        known = (len(self.written), len(self.inputs), len(self.roots), unknown) if self.read_input is not None else None
        self.problems += self.linker.link(self.is_free, known)

    def is_free(self, key: str) -> bool:
        """Whether the variable of this key is read from `read_input`."""
        return self.read_input is not None and self.is_given(key)

    def is_given(self, key: str) -> bool:
        """Whether the variable of this key has its value from outside: it is an input, and nothing writes it."""
        if key not in self.inputs or (self.unknown is not None and self.unknown.owns(self.inputs[key][0])):
            return False
        parts = key.split(".")
        if parts[0] != "g" and not any(self.linker.name(unit.layout) == parts[0] for unit in self.roots):
            return False
        return not self._is_written(key)

    def is_written_inside(self, key: str) -> bool:
        """Whether anything writes a variable, a part of it, or what it is a part of."""
        return self._is_written(key) or any(each.startswith(f"{key}.") for each in self.written)

    def _is_written(self, key: str) -> bool:
        parts = key.split(".")
        return any(".".join(parts[:end]) in self.written for end in range(1, len(parts) + 1))

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
        if not field.declared or not isinstance(field.type, t.ElementaryType):
            return False
        if field.direction not in (Direction.LOCAL, Direction.EXTERNAL) or field.name.casefold() in self._not_free:
            return False
        return ALL_FREE in self._freed or field.name.casefold() in self._freed

    def frozen(self) -> Iterator[str]:
        """The paths of declared variables that are read, that nothing writes, and that are no inputs."""
        roots = {self.linker.name(unit.layout) for unit in self.roots}
        for key, (path, field) in self.read.items():
            start, *slots = key.split(".")
            plain = field.declared and field.name.casefold() not in _FLAGS and isinstance(field.type, t.ElementaryType)
            known = field.direction in (Direction.LOCAL, Direction.EXTERNAL) and len(slots) == 1
            if plain and known and (start == "g" or start in roots) and not self._is_written(key):
                yield path

    # -- global names

    def meaning(self, declaration: Declaration) -> Any:
        """What a global declaration is: a `Place`, a `Code`, a `Space`, a `Unit` or a type."""
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
            return self.add(path, self._of_block(holder), None)
        if isinstance(holder, PouInstance):
            return self.add(path, self.types.named(holder.type_name, self.scope), None)
        raise SimulationError(f"{declaration} is no variable")

    def _is_constant(self, variable: m.Variable) -> bool:
        if self._constants is None:
            sections = [*self.project.global_variables]
            for resource in self._resources():
                sections += resource.global_variables
            for configuration in self.project.configurations:
                sections += configuration.global_variables
            self._constants = {id(v) for s in sections if s.constant for v in s.variables}
            self._constants |= {id(v) for table in self.project.tag_tables for v in table.constants}
        return id(variable) in self._constants

    _constants: set[int] | None = None

    def _resources(self) -> list[Resource]:
        inner = [resource for configuration in self.project.configurations for resource in configuration.resources]
        return [*self.project.applications, *inner]

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
            input=not field.preset or self.is_freed(field),
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
        """What programs use of an instance whose type nobody declares: name, slot, type, and whether they write it."""
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
