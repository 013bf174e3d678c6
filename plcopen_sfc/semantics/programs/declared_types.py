"""From the types that a project declares to those of running programs, and from initial values to Python source."""

from __future__ import annotations

from dataclasses import replace

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.languages.binding.symbols import Declaration, Kind
from plcopen_sfc.languages.declarations import read_declarations
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.model import types as m
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.semantics.programs import types as t
from plcopen_sfc.semantics.programs.code_generation import Writer
from plcopen_sfc.semantics.programs.expressions import Translator
from plcopen_sfc.semantics.programs.scopes import Scope, TranslatedProject
from plcopen_sfc.semantics.programs.types import Direction, Field, Layout
from plcopen_sfc.semantics.programs.value_code import Code

_MOST_ELEMENTS = 1_000_000


class TypeReader:
    """Makes types; those with a name once."""

    def __init__(self, library: TranslatedProject, initials: Initials) -> None:
        self._library = library
        self._initials = initials
        self._named: dict[int, t.Type] = {}
        self._open: set[int] = set()

    def read(self, type_: m.DataType, scope: Scope) -> t.Type:
        """The type as it is seen in `scope`."""
        match type_:
            case m.ElementaryType(name=name):
                found = t.elementary(name.value, self._library.dialect)
                if found is None:
                    return t.OpaqueType(name.value)
                return found
            case m.StringType(wide=wide, length=length):
                name_ = "WSTRING" if wide else "STRING"
                if length is None:
                    return t.elementary(name_, self._library.dialect) or t.OpaqueType(name_)
                return t.string(name_, _constant(scope, length))
            case m.DerivedType(name=name):
                return self.named(name, scope)
            case m.ArrayType(dimensions=dimensions, base=base):
                inner = self.read(base, scope)
                if any(d.lower.strip() == "*" for d in dimensions):
                    return t.ArrayType(f"ARRAY OF {inner.name}", inner, ())
                bounds = tuple((_constant(scope, d.lower), _constant(scope, d.upper)) for d in dimensions)
                shown = ", ".join(f"{lower}..{upper}" for lower, upper in bounds)
                made = t.ArrayType(f"ARRAY [{shown}] OF {inner.name}", inner, bounds)
                if _cells(made) > _MOST_ELEMENTS:
                    raise SimulationError(f"{made.name} has more than {_MOST_ELEMENTS} elements")
                return made
            case m.StructType():
                return self.structure("STRUCT", type_, scope)
            case m.EnumType():
                return self._enumeration("enumeration", type_, scope)
            case m.SubrangeType(bounds=bounds_, base=base):
                inner = self.read(base, scope)
                if not isinstance(inner, t.ElementaryType):
                    raise SimulationError(f"a subrange of {inner.name}")
                ends = (_constant(scope, bounds_.lower), _constant(scope, bounds_.upper))
                return replace(inner, name=f"{inner.name}({ends[0]}..{ends[1]})", narrowed=ends)
            case m.PointerType(base=base, reference=reference):
                inner = self.read(base, scope)
                return t.ReferenceType(f"REF_TO {inner.name}", inner, automatic=reference and self._library.is_codesys)
        return t.OpaqueType("?")

    def named(self, name: str, scope: Scope) -> t.Type:
        """The type of a name: of the project, a standard block, an elementary one; else an opaque one."""
        name = name.strip().strip('"')
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
        """The type that a data type or a POU is."""
        holder = declaration.holder
        if isinstance(holder, Pou):
            unit = self._library.unit(holder)
            return t.StructureType(holder.name, unit.layout)
        assert isinstance(holder, m.DataTypeDeclaration)  # noqa: S101  # the kind says so
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
            return self.structure(holder.name, holder.type, scope, base=kept(holder.carried).get("extends"))
        if isinstance(holder.type, m.EnumType):
            return self._enumeration(holder.name, holder.type, scope)
        return self.read(holder.type, scope)

    def structure(self, name: str, type_: m.StructType, scope: Scope, base: str | None = None) -> t.StructureType:
        """A structure; the initial values of its members are constants."""
        if "union" in kept(type_.carried):
            raise SimulationError(f"{name} is a UNION, which the simulator does not know")
        inherited = self.named(base, scope) if base else None
        layout = Layout(name, inherited.layout if isinstance(inherited, t.StructureType) else None)
        for member in type_.members:
            made = layout.add(member.name, self.read(member.type, scope))
            self._initials.give(made, member.initial, scope)
        self._library.write_new(layout)
        return t.StructureType(name, layout)

    def _enumeration(self, name: str, type_: m.EnumType, scope: Scope) -> t.ElementaryType:
        base = self.read(type_.base, scope) if type_.base is not None else t.INT
        if not isinstance(base, t.ElementaryType):
            raise SimulationError(f"{name} is an enumeration of {base.name}")
        names: dict[str, int] = {}
        following = 0
        for value in type_.values:
            if value.value is not None and value.value.strip():
                text = value.value.strip()
                following = names[text.casefold()] if text.casefold() in names else _constant(scope, text)
            names[value.name.casefold()] = following
            following += 1
        return replace(base, name=name, names=names)


def _constant(scope: Scope, text: str) -> int:
    """Return the value of a constant expression. Raises `SimulationError`."""
    parsed = parse_expression(text, scope.library.dialect)
    if not parsed.problems:
        code = Translator(scope, Writer()).value(parsed.tree, t.DINT)
        if code.constant and isinstance(code.value, int):
            return int(code.value)
    raise SimulationError(f"{text!r} is no constant", location=Location(path=scope.path))


def _cells(type_: t.Type) -> int:
    """How many values a variable of a type holds."""
    if isinstance(type_, t.ArrayType):
        return type_.size * max(_cells(type_.base), 1)
    if isinstance(type_, t.StructureType):
        return sum(_cells(field.type) for field in type_.layout.fields)
    return 1


class Initials:
    """First values of variables."""

    def __init__(self, library: TranslatedProject) -> None:
        self._library = library

    def give(self, field: Field, value: m.Value | None, scope: Scope) -> None:
        """Give a variable the value of its declaration, or that of its type."""
        if value is None or (isinstance(value, m.SimpleValue) and not (value.text or "").strip()):
            field.initial = self._library.default(field.type)
            return
        code = self.source(field.type, value, scope)
        field.initial = code.text
        field.preset = code.text != self._library.default(field.type)
        if code.constant:
            field.value = code.value if field.direction is Direction.CONSTANT else None
        elif isinstance(field.type, t.ElementaryType):
            field.late = True

    def source(self, type_: t.Type, value: m.Value, scope: Scope) -> Code:
        """Source of a value of `type_`."""
        if isinstance(value, m.SimpleValue):
            return self._simple(type_, value, scope)
        if isinstance(type_, t.ArrayType):
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
        plain = isinstance(type_, t.ElementaryType | t.ReferenceType | t.OpaqueType)
        if plain and not parsed.problems:
            if isinstance(type_, t.OpaqueType):
                return Code("None", type_)
            translator = Translator(scope, Writer())
            return translator.fitted(translator.value(parsed.tree, type_), type_)
        declared = read_declarations(f"VAR x : INT := {text}; END_VAR", self._library.dialect)
        variables = [v for section in declared.sections for v in section.variables]
        inner = variables[0].initial if len(variables) == 1 and not declared.problems else None
        if inner is None or isinstance(inner, m.SimpleValue):
            if isinstance(type_, t.ArrayType) and not parsed.problems:
                return Code(self._array(type_, m.ArrayValue(items=[m.RepeatedValue(value=value)]), scope), type_)
            if not parsed.problems and isinstance(n.bare(parsed.tree), n.Name):
                return Code(f"cloned({Translator(scope, Writer()).value(parsed.tree, type_).text})", type_)
            raise SimulationError(f"{text!r} is no value of {type_.name}")
        return self.source(type_, inner, scope)

    def _array(self, type_: t.ArrayType, value: m.Value, scope: Scope) -> str:
        assert isinstance(value, m.ArrayValue)  # noqa: S101  # the only one left
        parts: list[str] = []
        count = 0
        for item in value.items:
            times = _constant(scope, item.repetitions) if item.repetitions is not None else 1
            nested = type_.base
            if isinstance(item.value, m.ArrayValue) and not isinstance(nested, t.ArrayType):
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
