"""All POUs, types and global variables of a project, each translated when something first needs it.

Declared types become those of running programs, and initial values Python source.
"""

from __future__ import annotations

import re
from collections import ChainMap
from collections.abc import Iterable, MutableMapping
from dataclasses import replace
from functools import cached_property
from typing import Any

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.languages.binding.name_scopes import list_level, namespace_place
from plcopen_sfc.languages.declarations import read_declarations
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.model import types as m
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import COUNTING_BYTES
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project import PouInstance, Project, Tag
from plcopen_sfc.model.variables import sections_of
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs import matiec_runtime, runtime
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.addresses import Image
from plcopen_sfc.semantics.programs.code_generation import Writer
from plcopen_sfc.semantics.programs.expressions import Translator
from plcopen_sfc.semantics.programs.marks import UNSEEN
from plcopen_sfc.semantics.programs.places import Place, Space
from plcopen_sfc.semantics.programs.routines import declare, translate
from plcopen_sfc.semantics.programs.runtime_types import Direction, Field, Frame, Layout
from plcopen_sfc.semantics.programs.scopes import RunOptions, Scope, TranslatedPou, TranslatedProject
from plcopen_sfc.semantics.programs.value_code import Code
from plcopen_sfc.semantics.programs.variable_use import is_plain

_MOST_ELEMENTS = 1_000_000


class TypeReader:
    """Makes types; those with a name once."""

    def __init__(self, library: TranslatedProject, initials: Initials) -> None:
        self._library = library
        self._initials = initials
        self._named: dict[int, t.Type] = {}
        self._open: set[int] = set()
        self._held: dict[int, int] = {}
        """The values that a variable of a structure holds, by the `id` of its layout."""

    def read(self, type_: m.DataType, scope: Scope) -> t.Type:
        """Return the type as it is seen in `scope`."""
        match type_:
            case m.ElementaryType(name=name):
                return t.elementary(name.value, self._library.dialect) or t.OpaqueType(name.value)
            case m.StringType(wide=wide, length=length):
                name_ = "WSTRING" if wide else "STRING"
                if length is None and self._library.profile.matiec_library:
                    return t.string(name_, matiec_runtime.LONGEST_STRING)
                if length is None:
                    return t.elementary(name_, self._library.dialect) or t.OpaqueType(name_)
                return t.string(name_, _constant(scope, length))
            case m.DerivedType(name=name):
                return self.named(name, scope)
            case m.ArrayType(dimensions=dimensions, base=base):
                inner = self.read(base, scope)
                if any(d.lower.strip() == "*" for d in dimensions):
                    return t.ArrayOf(f"ARRAY OF {inner.name}", inner, ())
                bounds = tuple((_constant(scope, d.lower), _constant(scope, d.upper)) for d in dimensions)
                shown = ", ".join(f"{lower}..{upper}" for lower, upper in bounds)
                made = t.ArrayOf(f"ARRAY [{shown}] OF {inner.name}", inner, bounds)
                _refuse_large(made, ChainMap({}, self._held))
                return made
            case m.StructType():
                return self.structure("STRUCT", type_, scope)
            case m.EnumType():
                return self._enumeration("enumeration", type_, scope)
            case m.SubrangeType(bounds=bounds_, base=base):
                inner = self.read(base, scope)
                if not isinstance(inner, t.ScalarType):
                    raise SimulationError(f"a subrange of {inner.name}")
                ends = (_constant(scope, bounds_.lower), _constant(scope, bounds_.upper))
                return replace(inner, name=f"{inner.name}({ends[0]}..{ends[1]})", narrowed=ends)
            case m.PointerType(base=base, reference=reference):
                inner = self.read(base, scope)
                return t.ReferenceType(f"REF_TO {inner.name}", inner, automatic=reference and self._library.is_codesys)
        return t.OpaqueType("?")

    def named(self, name: str, scope: Scope) -> t.Type:
        """Return the type of a name: of the project, a standard block, an elementary one; else an opaque one."""
        name = name.strip().strip('"')
        # ``Util.BLINK``: where nothing has the name with its namespace, that of a library is left out
        for candidate in dict.fromkeys((name, name.rpartition(".")[2])):
            found = self._declared(candidate, scope)
            if found is not None:
                return found
            block = self._library.blocks.find(candidate)
            if block is not None:
                return t.StructureType(candidate.upper(), block.layout)
            known = t.elementary(candidate, self._library.dialect)
            if known is not None:
                return known
            if candidate.upper().startswith("REF_TO_"):
                return t.ReferenceType(candidate, self.named(candidate[7:], scope))
        self._library.missing.setdefault(name, scope.path)
        return t.OpaqueType(name)

    def _declared(self, name: str, scope: Scope) -> t.Type | None:
        for level in scope.outer():
            found = [d for d in level.named(name) if d.kind in (Kind.POU, Kind.DATA_TYPE)]
            if found:
                return self.of_declaration(found[0])
        return None

    def of_declaration(self, declaration: Declaration) -> t.Type:
        """Return the type that a data type or a POU is."""
        holder = declaration.holder
        if isinstance(holder, Pou):
            unit = self._library.unit(holder)
            return t.StructureType(holder.name, unit.layout)
        assert isinstance(holder, m.DataTypeDeclaration)  # noqa: S101  # by its kind
        key = id(holder)
        if key not in self._named:
            if key in self._open:
                raise SimulationError(f"the type {holder.name} contains itself")
            self._open.add(key)
            try:
                library = self._library
                own = library.scope
                if holder.place:
                    own = Scope(library, holder.name, library.globals, place=holder.place)
                found = self._named[key] = self._make(holder, own)
                if holder.initial is not None:  # the name of a value of an enumeration is of the type itself
                    start = self._initials.source(found, holder.initial, own).text
                    self._named[key] = replace(found, start=start)
            finally:
                self._open.discard(key)
        return self._named[key]

    def _make(self, holder: m.DataTypeDeclaration, scope: Scope) -> t.Type:
        if isinstance(holder.type, m.StructType):
            return self.structure(holder.name, holder.type, scope, base=kept(holder.extension_data).get("extends"))
        if isinstance(holder.type, m.EnumType):
            return self._enumeration(holder.name, holder.type, scope)
        return self.read(holder.type, scope)

    def structure(self, name: str, type_: m.StructType, scope: Scope, base: str | None = None) -> t.StructureType:
        """Return a structure; the initial values of its members are constants."""
        if "union" in kept(type_.extension_data):
            raise SimulationError(f"{name} is a UNION, which the simulator does not know")
        inherited = self.named(base, scope) if base else None
        layout = Layout(name, inherited.layout if isinstance(inherited, t.StructureType) else None)
        for member in type_.members:
            made = layout.add(member.name, self.read(member.type, scope))
            self._initials.give(made, member.initial, scope)
        self._library.write_new(layout)
        made_type = t.StructureType(name, layout)
        self._held[id(layout)] = _refuse_large(made_type, ChainMap({}, self._held))
        return made_type

    def _enumeration(self, name: str, type_: m.EnumType, scope: Scope) -> t.ScalarType:
        base = self.read(type_.base, scope) if type_.base is not None else t.INT
        if not isinstance(base, t.ScalarType):
            raise SimulationError(f"{name} is an enumeration of {base.name}")
        names, spelled = dict[str, int](), dict[int, str]()
        following = 0
        for value in type_.values:
            if value.value is not None and value.value.strip():
                text = value.value.strip()
                following = names[text.casefold()] if text.casefold() in names else _constant(scope, text)
            names[value.name.casefold()], spelled[following] = following, value.name
            following += 1
        return replace(base, name=name, names=names, spelled=spelled)


def _constant(scope: Scope, text: str) -> int:
    """Return the value of a constant expression. Raises `SimulationError`."""
    parsed = parse_expression(text, scope.library.dialect)
    if not parsed.problems:
        code = Translator(scope, Writer()).value(parsed.tree, t.DINT)
        if code.constant and isinstance(code.value, int):
            return int(code.value)
    raise SimulationError(f"{text!r} is no constant", location=Location(path=scope.path))


def _cells(type_: t.Type, known: MutableMapping[int, int]) -> int:
    """Return how many values a variable of a type holds.

    `known` has those of structures and blocks by the `id` of their layouts: of structures that have the one before
    twice, 40 hold 2**40 values.
    """
    if isinstance(type_, t.ArrayOf):
        return type_.size * max(_cells(type_.base, known), 1)
    if isinstance(type_, t.StructureType):
        key = id(type_.layout)
        if key not in known:
            known[key] = 0  # a block may contain itself, which is another error
            known[key] = sum(_cells(field.type, known) for field in type_.layout.fields)
        return known[key]
    return 1


def _refuse_large(type_: t.Type, known: MutableMapping[int, int]) -> int:
    """Return how many values a variable of a type holds. Raises `SimulationError` for too many."""
    held = _cells(type_, known)
    if held > _MOST_ELEMENTS:
        raise SimulationError(f"{type_.name} has more than {_MOST_ELEMENTS} elements")
    return held


def refuse_many_instances(types: Iterable[t.Type]) -> None:
    """Raise `SimulationError` for a variable with too many instances and structures in it; each is a frame."""
    known: dict[int, int] = {}

    def frames(type_: t.Type) -> int:
        if isinstance(type_, t.ArrayOf):
            return type_.size * frames(type_.base)
        if not isinstance(type_, t.StructureType):
            return 0
        key = id(type_.layout)
        if key not in known:
            known[key] = 0
            known[key] = 1 + sum(frames(field.type) for field in type_.layout.fields)
        return known[key]

    for each in types:
        if frames(each) > _MOST_ELEMENTS:
            raise SimulationError(f"{each.name} has more than {_MOST_ELEMENTS} elements")


_OWN_FRAME = re.compile(r"\bv\b")
"""The variables of the frame that is made, in Python source."""


class Initials:
    """First values of variables."""

    def __init__(self, library: TranslatedProject) -> None:
        self._library = library

    def give(self, field: Field, value: m.Value | None, scope: Scope) -> None:
        """Give a variable the value of its declaration, or of its type, which a wrong one leaves."""
        default = field.initial = self._library.default(field.type)
        if value is None or (isinstance(value, m.SimpleValue) and not (value.text or "").strip()):
            return
        code = self.source(field.type, value, scope)
        field.initial = code.text
        field.preset = code.text != default
        if code.constant:
            field.value = code.value if field.direction is Direction.CONSTANT else None
        elif isinstance(field.type, t.ScalarType | t.ReferenceType) or _OWN_FRAME.search(code.text):
            field.late = True

    def source(self, type_: t.Type, value: m.Value, scope: Scope) -> Code:
        """Source of a value of `type_`."""
        if isinstance(value, m.SimpleValue):
            return self._simple(type_, value, scope)
        if isinstance(type_, t.ArrayOf):
            if isinstance(value, m.StructValue):
                raise SimulationError(f"the value of a structure is given to {type_.name}")
            return Code(self._array(type_, value, scope), type_)
        if isinstance(type_, t.StructureType) and isinstance(value, m.StructValue):
            return Code(self._structure(type_, value, scope), type_)
        if isinstance(type_, t.OpaqueType):
            return Code("None", type_)
        raise SimulationError(f"a value in brackets is given to {type_.name}")

    def _simple(self, type_: t.Type, value: m.SimpleValue, scope: Scope) -> Code:
        text = (value.text or "").strip()
        if not text:
            return Code(self._library.default(type_), type_)
        parsed = parse_expression(text, self._library.dialect)
        plain = isinstance(type_, t.ScalarType | t.ReferenceType | t.OpaqueType)
        if plain and not parsed.problems:
            if isinstance(type_, t.OpaqueType):
                return Code("None", type_)
            translator = Translator(scope, Writer())
            return translator.fitted(translator.value(parsed.tree, type_), type_)
        # values in brackets are no expressions: the reader of declarations knows them
        declared = read_declarations(f"VAR x : INT := {text}; END_VAR", self._library.dialect)
        variables = [v for section in declared.sections for v in section.variables]
        inner = variables[0].initial if len(variables) == 1 and not declared.problems else None
        if inner is None or isinstance(inner, m.SimpleValue):
            if isinstance(type_, t.ArrayOf) and not parsed.problems:
                return Code(self._array(type_, m.ArrayValue(items=[m.RepeatedValue(value=value)]), scope), type_)
            if not parsed.problems and isinstance(n.bare(parsed.tree), n.Name):
                return Code(f"cloned({Translator(scope, Writer()).value(parsed.tree, type_).text})", type_)
            raise SimulationError(f"{text!r} is no value of {type_.name}")
        return self.source(type_, inner, scope)

    def _array(self, type_: t.ArrayOf, value: m.Value, scope: Scope) -> str:
        assert isinstance(value, m.ArrayValue)  # noqa: S101  # the only one left
        parts: list[str] = []
        count = 0
        for item in value.items:
            times = _constant(scope, item.repetitions) if item.repetitions is not None else 1
            nested = type_.base
            if isinstance(item.value, m.ArrayValue) and not isinstance(nested, t.ArrayOf):
                raise SimulationError("an array of values is given to one element")
            source = self.source(nested, item.value, scope).text
            if not 0 <= times <= type_.size:
                raise SimulationError(f"{times} values are given to {type_.name}")
            parts.append(f"*[{source} for _ in range({times})]" if times != 1 else source)
            count += times
        if count > type_.size:
            raise SimulationError(f"{count} values are given to {type_.name}")
        if count < type_.size:
            parts.append(f"*[{self._library.default(type_.base)} for _ in range({type_.size - count})]")
        return f"[{', '.join(parts)}]"

    def _structure(self, type_: t.StructureType, value: m.StructValue, scope: Scope) -> str:
        values = []
        for member in value.members:
            field = type_.layout.find(member.member)
            if field is None:
                raise SimulationError(f"{type_.name} has no member {member.member}")
            values.append(f"({field.slot}, {self.source(field.type, member.value, scope).text})")
        return f"preset({', '.join([self._library.default(type_), *values])})"


_RUNTIME = """
    Frame Pointer View assign bit_set bits_set character_at cloned code_at divided endless fail half_away
    half_even named narrow out_of_bounds power preset put remainder single truncated wrapped
""".split()


class Library(TranslatedProject):
    """All that a controller runs of a project. Edits of the project make it wrong."""

    def __init__(self, project: Project, profile: Profile, options: RunOptions) -> None:
        super().__init__(project, profile, options)
        self.read_input = options.get("read_input")
        self.image = Image(self.add, by_bytes=project.address_dialect in COUNTING_BYTES)
        self.free_cells: dict[tuple[int, int], str] = {}
        """The paths of free inputs by the lists that hold them and the places in these."""
        self.version = 0
        """Grows when new things were linked."""
        self._chart_compiler = options.get("chart_compiler")
        initials = Initials(self)
        self._types = TypeReader(self, initials)
        self.at_address, self.give_initial = self.image.place, initials.give
        self.read_type, self.named_type = self._types.read, self._types.named
        self._waiting: list[TranslatedPou] = []
        self._fields: dict[int, Place] = {}
        self._open: set[int] = set()
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
        """Return a value, which is asked for where it is a free input that the scan has not read yet."""
        value = cells[index]
        if value is runtime.UNREAD:
            assert self.read_input is not None  # noqa: S101  # nothing is free else
            value = cells[index] = self.read_input(self.free_cells[id(cells), index])
        return value

    def _asked(self, value: Any) -> Any:
        """Return a structure or an array in which all free inputs were asked for."""
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
        refuse_many_instances(field.type for field in fields)
        writer = Writer()
        for field in fields:
            writer.write(f"g.append({field.initial})")
        added = self.linker.routine("", writer, "global variables") if fields else None
        self.version += 1
        self.link()
        try:
            if added is not None:
                added()
        except IndexError:  # of `g`, which has the values of those before only
            message = "a start value names a variable that gets its own start value later"
            raise SimulationError(message, hint="Write the value instead of the name.") from None

    def give_in_outs(self, unit: TranslatedPou, frame: Frame) -> None:
        """Nobody calls the outermost instance: its VAR_IN_OUT refer to variables of their own."""
        missing = [
            field
            for field in unit.layout.fields
            if field.direction is Direction.IN_OUT
            and frame.v[field.slot] is None
            and not (isinstance(field.type, t.ArrayOf) and not field.type.dimensions)
        ]
        slots = []
        for field in missing:
            if is_plain(field.type) and not isinstance(field.type, t.ScalarType):
                self.use.inputs.setdefault(self.use.key(unit.layout, field.slot), (field.name, field.type))
            made = self.globals.add(f"(of {unit.pou.name}) {field.name}", field.type, hidden=True)
            made.initial = self.default(field.type)
            slots.append(made.slot)
            if isinstance(field.type, t.ScalarType):
                self.use.inputs[f"g.{made.slot}"] = field.name, field.type
                self.use.in_outs.add(f"g.{made.slot}")
        self.grow()
        for field, slot in zip(missing, slots, strict=True):
            plain = isinstance(field.type, t.ScalarType | t.ReferenceType | t.OpaqueType)
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
            return Space(list_level(declaration), declaration.path)
        if kind is Kind.NAMESPACE:
            return Space(self.names.place(namespace_place(self.project, holder)), declaration.path)
        return self.variable(declaration)

    def variable(self, declaration: Declaration) -> Place:
        """Return the place of a global variable, a tag, a data block or a program instance."""
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
            type_ = self.read_type(holder.type, self.scope)
            if holder.address and isinstance(type_, t.ScalarType) and "*" not in holder.address:
                return self.at_address(holder.address, type_, path, holder.initial)
            return self.add(path, type_, holder.initial, constant=id(holder) in self._constants)
        if isinstance(holder, Tag):
            type_ = self.named_type(holder.type, self.scope)
            if holder.address and isinstance(type_, t.ScalarType):
                return self.at_address(holder.address, type_, path, None)
            return self.add(path, type_, None)
        if isinstance(holder, DataBlock):
            type_ = self._of_block(holder)
            return self.add(path, type_, _values_of(holder, type_))
        if isinstance(holder, PouInstance):
            return self.add(path, self.named_type(holder.type_name, self.scope), None)
        raise SimulationError(f"{declaration} is no variable")

    @cached_property
    def _constants(self) -> set[int]:
        """The ids of the global variables that are constants."""
        found = {id(v) for s in self.project.global_sections() if s.constant for v in s.variables}
        return found | {id(v) for table in self.project.tag_tables for v in table.constants}

    def _of_block(self, block: DataBlock) -> t.Type:
        if block.type_name:
            found = self.named_type(block.type_name, self.scope)
            if isinstance(found, t.StructureType):
                return found
        layout = Layout(block.name)
        layout.is_list = True
        for section in sections_of(block.interface):
            for variable in section.variables:
                made = layout.add(variable.name, self.read_type(variable.type, self.scope))
                self.give_initial(made, variable.initial, self.scope)
        self.write_new(layout)
        return t.StructureType(block.name, layout)

    def add(self, path: str, type_: t.Type, initial: m.Value | None, *, constant: bool = False) -> Place:
        """Return a new global variable."""
        # its value is read before it gets a slot: globals that the value names are added meanwhile, and `grow` gives
        # values in the order of slots
        probe = Field(path, -1, type_, Direction.CONSTANT if constant else Direction.EXTERNAL)
        self.give_initial(probe, initial, self.scope)
        made = self.globals.add(path, type_, probe.direction)
        made.initial, made.value, made.preset = probe.initial, probe.value, probe.preset
        made.declared = True
        return self.place(made, path)

    def place(self, field: Field, path: str) -> Place:
        """Return the place of a global variable."""
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
            freed=self.use.is_freed(field),
        )

    def implicit(self, path: str, type_: t.Type) -> Place:
        """Return the external variable of an undeclared path."""
        key = path.casefold()
        found = self.implicits.get(key)
        if found is None and self.is_complete:
            raise SimulationError(f"{path} is not declared")
        if found is None:
            self.undeclared[path] = type_
            found = self.implicits[key] = self.add(path, type_, None)
        return found

    def _enumeration_value(self, declaration: Declaration) -> Code:
        code = self._enumeration_values.get(id(declaration.holder))
        if code is None:
            raise SimulationError(f"{declaration.path} is a value of an enumeration that has no name")
        return code

    @cached_property
    def _enumeration_values(self) -> dict[int, Code]:
        """The numbers of the values of all enumerations that have a name, by the ids of the values."""
        found: dict[int, Code] = {}
        for holder in self.project.data_types:
            if isinstance(holder.type, m.EnumType):
                type_ = self._types.of_declaration(Declaration(Kind.DATA_TYPE, holder.name, (holder,)))
                assert isinstance(type_, t.ScalarType)  # noqa: S101  # what enumerations are read as
                for value in holder.type.values:
                    number = type_.names[value.name.casefold()]
                    found[id(value)] = Code(repr(number), type_, number, number, number, constant=True)
        return found

    def program(self, unit: TranslatedPou) -> Place:
        """Return the only instance of a program."""
        found = self._fields.get(id(unit))
        if found is None:
            found = self._fields[id(unit)] = self.add(unit.pou.name, t.StructureType(unit.pou.name, unit.layout), None)
        return found


def _values_of(block: DataBlock, type_: t.Type) -> m.StructValue | None:
    """Return the start values that an instance data block has and the type of which it is one has not."""
    if block.type_name is None or block.interface is None or not isinstance(type_, t.StructureType):
        return None
    members = [
        m.MemberValue(member=variable.name, value=variable.initial)
        for variable in block.interface.variables()
        if variable.initial is not None and type_.layout.find(variable.name) is not None
    ]
    return m.StructValue(members=members) if members else None
