"""All POUs, types and global variables of a project, each translated when something first needs it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.binding.name_scopes import namespace_place, variables_in
from plcopen_sfc.languages.binding.symbols import Declaration, Kind, Level
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.model import types as m
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project import PouInstance, Project, Tag
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs import runtime
from plcopen_sfc.semantics.programs import types as t
from plcopen_sfc.semantics.programs.addresses import Image
from plcopen_sfc.semantics.programs.code_generation import Writer
from plcopen_sfc.semantics.programs.declared_types import Initials, TypeReader
from plcopen_sfc.semantics.programs.marks import UNSEEN
from plcopen_sfc.semantics.programs.places import Place, Space
from plcopen_sfc.semantics.programs.pou_translation import ChartCompiler, declare, translate
from plcopen_sfc.semantics.programs.scopes import Scope, TranslatedPou, TranslatedProject
from plcopen_sfc.semantics.programs.types import Direction, Field, Frame, Layout
from plcopen_sfc.semantics.programs.unknown_calls import UnknownCalls
from plcopen_sfc.semantics.programs.value_code import Code
from plcopen_sfc.semantics.programs.variable_use import is_plain

_RUNTIME = """
    Frame Pointer View assign bit_set bits_set character_at cloned code_at divided endless fail half_away
    half_even named narrow out_of_bounds power preset put remainder single truncated wrapped
""".split()


class Library(TranslatedProject):
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
        super().__init__(
            project,
            profile,
            functions,
            asks=read_input is not None,
            free_inputs=free_inputs,
            not_free=not_free,
            marking=marking,
            unknown_calls=unknown_calls,
        )
        self.read_input = read_input
        self.image = Image(self.add, by_bytes=self.dialect in (Dialect.TWINCAT, Dialect.SCL))
        self.free_cells: dict[tuple[int, int], str] = {}
        """The paths of free inputs by the lists that hold them and the places in these."""
        self.version = 0
        """Grows when new things were linked."""
        self._chart_compiler = chart_compiler
        self._initials = Initials(self)
        self._types = TypeReader(self, self._initials)
        self._waiting: list[TranslatedPou] = []
        self._fields: dict[int, Place] = {}
        self._open: set[int] = set()
        self._values: dict[int, Code] | None = None
        self._fill_namespace()

    def _fill_namespace(self) -> None:
        """Name all that the source of translated texts uses."""
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

    def unit(self, pou: Pou) -> TranslatedPou:
        """Return a POU, declared and waiting to be translated."""
        found = self.units.get(id(pou))
        if found is None:
            pou.read()
            base = self.names.base(pou)
            found = TranslatedPou(self, pou, self.unit(base) if base is not None and base is not pou else None)
            self.units[id(pou)] = found
            self._waiting.append(found)
            declare(found, self._chart_compiler)
        return found

    def finish(self) -> None:
        """Translate all that waits, and link it."""
        done: list[TranslatedPou] = []
        while self._waiting:
            unit = self._waiting.pop(0)
            translate(unit)
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

    def give_in_outs(self, unit: TranslatedPou, frame: Frame) -> None:
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
            if is_plain(field.type) and not isinstance(field.type, t.ElementaryType):
                self.use.inputs.setdefault(self.use.key(unit.layout, field.slot), (field.name, field.type))
            made = self.globals.add(f"(of {unit.pou.name}) {field.name}", field.type, hidden=True)
            made.initial = self.default(field.type)
            slots.append(made.slot)
            if isinstance(field.type, t.ElementaryType):
                self.use.inputs[f"g.{made.slot}"] = field.name, field.type
                self.use.in_outs.add(f"g.{made.slot}")
        self.grow()
        for field, slot in zip(missing, slots, strict=True):
            plain = isinstance(field.type, t.ElementaryType | t.ReferenceType | t.OpaqueType)
            cells = self.frame.v
            frame.v[field.slot] = runtime.Pointer(cells, slot) if plain else cells[slot]

    def link(self) -> None:
        """Link what is new."""
        unknown = len(self.unknown) if self.unknown is not None else 0
        self.problems += self.linker.link(self.use.is_free, (self.use.version, unknown))

    # -- global names

    def meaning(self, declaration: Declaration) -> Any:
        """Meaning of a global declaration: a `Place`, a `Code`, a `Space`, a `TranslatedPou` or a type."""
        holder: Any = declaration.holder
        kind = declaration.kind
        if kind is Kind.POU:
            return self.unit(holder)
        if kind is Kind.DATA_TYPE:
            return self._types.of_declaration(declaration)
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
            type_ = self._types.read(holder.type, self.scope)
            if holder.address and isinstance(type_, t.ElementaryType) and "*" not in holder.address:
                return self.at_address(holder.address, type_, path, holder.initial)
            return self.add(path, type_, holder.initial, constant=self._is_constant(holder))
        if isinstance(holder, Tag):
            type_ = self._types.named(holder.type, self.scope)
            if holder.address and isinstance(type_, t.ElementaryType):
                return self.at_address(holder.address, type_, path, None)
            return self.add(path, type_, None)
        if isinstance(holder, DataBlock):
            type_ = self._of_block(holder)
            return self.add(path, type_, _values_of(holder, type_))
        if isinstance(holder, PouInstance):
            return self.add(path, self._types.named(holder.type_name, self.scope), None)
        raise SimulationError(f"{declaration} is no variable")

    def _is_constant(self, variable: m.Variable) -> bool:
        if self._constants is None:
            self._constants = {id(v) for s in self.project.global_sections() if s.constant for v in s.variables}
            self._constants |= {id(v) for table in self.project.tag_tables for v in table.constants}
        return id(variable) in self._constants

    _constants: set[int] | None = None

    def _of_block(self, block: DataBlock) -> t.Type:
        if block.type_name:
            found = self._types.named(block.type_name, self.scope)
            if isinstance(found, t.StructureType):
                return found
        layout = Layout(block.name)
        for section in block.interface.sections if block.interface is not None else ():
            for variable in section.variables:
                made = layout.add(variable.name, self._types.read(variable.type, self.scope))
                self._initials.give(made, variable.initial, self.scope)
        self.write_new(layout)
        return t.StructureType(block.name, layout)

    def add(self, path: str, type_: t.Type, initial: m.Value | None, *, constant: bool = False) -> Place:
        """A new global variable."""
        probe = Field(path, -1, type_, Direction.CONSTANT if constant else Direction.EXTERNAL)
        self._initials.give(probe, initial, self.scope)
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
            input=field.direction is not Direction.CONSTANT and (not field.preset or self.use.is_freed(field)),
        )

    def at_address(self, address: str, type_: t.ElementaryType | None, path: str, initial: m.Value | None) -> Place:
        """Return the variable at a direct address; the first one that names it gives it its type."""
        return self.image.place(address, type_, path, initial)

    def read_type(self, type_: m.DataType, scope: Scope) -> t.Type:
        """Return the type as it is seen in a scope."""
        return self._types.read(type_, scope)

    def named_type(self, name: str, scope: Scope) -> t.Type:
        """Return the type of a name; see `TypeReader.named`."""
        return self._types.named(name, scope)

    def give_initial(self, field: Field, value: m.Value | None, scope: Scope) -> None:
        """Give a variable the value of its declaration, or that of its type."""
        self._initials.give(field, value, scope)

    def implicit(self, path: str, type_: t.Type) -> Place:
        """Return the external variable of an undeclared path."""
        key = path.casefold()
        found = self.implicits.get(key)
        if found is None:
            self.undeclared[path] = type_
            found = self.implicits[key] = self.add(path, type_, None)
        return found

    def _enumeration_value(self, declaration: Declaration) -> Code:
        if self._values is None:
            self._values = {}
            for holder in self.project.data_types:
                if isinstance(holder.type, m.EnumType):
                    self._know(
                        holder.type,
                        self._types.of_declaration(Declaration(Kind.DATA_TYPE, holder.name, (holder,))),
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

    def program(self, unit: TranslatedPou) -> Place:
        """The only instance of a program."""
        found = self._fields.get(id(unit))
        if found is None:
            found = self._fields[id(unit)] = self.add(unit.pou.name, t.StructureType(unit.pou.name, unit.layout), None)
        return found


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
