"""Declarations that names refer to, and the types of what they name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import Enum
from functools import cached_property
from typing import Any

from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding.name_scopes import (
    Scopes,
    declared_name,
    head_of,
    list_level,
    namespace_place,
    object_of,
    parameters_of,
    step_of,
)
from plcopen_sfc.languages.binding.name_sites import Reference, named
from plcopen_sfc.languages.binding.symbols import NOTHING, Binding, Level
from plcopen_sfc.languages.binding.text_sites import Role, Site, TextSite, ValueOf
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.nodes import Quoting
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7, StandardBlock, standard_block
from plcopen_sfc.model import types as t
from plcopen_sfc.model.declaration import Declaration, Kind, NamedObject
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.pou import DataBlock, Method, Pou, PouKind
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource, Tag
from plcopen_sfc.model.variables import SectionKind, VariableSection


class Untyped(Enum):
    """Types that the project does not declare.

    FOREIGN: elementary types and standard blocks, which hold nothing of the project. ELSEWHERE: their members are not
    declared in the project, but may be of types that are. UNKNOWN: it can be any type.
    """

    FOREIGN = "foreign"
    ELSEWHERE = "elsewhere"
    UNKNOWN = "unknown"


Type = t.DataType | Pou | Level | Untyped
"""The type of a value, as far as names need it. A `Level` is a thing with members that is no value."""


StoredType = t.DataTypeDeclaration | Pou
"""What a value or an instance can be of."""


class Resolver:
    """Tells what names of a project mean. Edits of the project make it wrong."""

    def __init__(self, project: Project, dialect: Dialect) -> None:
        self.project = project
        self.dialect = dialect
        self.scopes = Scopes(project)

    @cached_property
    def functions(self) -> dict[str, list[str]]:
        """The inputs of the functions that the project declares, by their names in lower case."""
        kinds = (SectionKind.INPUT, SectionKind.IN_OUT)
        functions = (pou for pou in self.project.pous if pou.kind is PouKind.FUNCTION)
        return {pou.name.casefold(): [v.name for kind in kinds for v in pou.variables(kind)] for pou in functions}

    @cached_property
    def constants(self) -> frozenset[int]:
        """The ids of the variables and entries of tables of tags that are declared as constants."""
        inside = (section for each in self.project.interfaces() for section in each.sections)
        sections = [*self.project.global_sections(), *inside]
        constant = (each for each in sections if each.constant or each.kind is SectionKind.CONSTANT)
        tags = (id(each) for table in self.project.tag_tables for each in table.constants)
        return frozenset((*(id(variable) for section in constant for variable in section.variables), *tags))

    def meaning(self, reference: Reference, text_site: TextSite) -> Binding:
        """Return the declaration that a name in a text site refers to."""
        site = text_site.site
        if reference.unread:
            return Binding(doubt=reference.unread)
        if reference.role is Role.PARAMETER:
            return self._parameter_of_block(text_site.owner, reference.name, site)
        if reference.role is Role.MEMBER:
            return self._member_of_value(text_site.owner, reference.name, site)
        if reference.role is Role.STEP:
            return step_of(self.scopes, text_site.owner, reference.name, site)
        if reference.role is Role.OBJECT:
            return object_of(self.scopes, text_site.owner)
        if reference.role is Role.HEAD:
            return head_of(self.scopes, text_site)
        if reference.declares:
            own = declared_name(self.scopes, reference, text_site).declaration
            return Binding(self.original(own)) if own is not None else NOTHING
        if reference.base is not None:
            return self.member(self.type_of(reference.base, site, reference.name), reference.name)
        if reference.callee is not None:
            return self._parameter(self.called_type(reference.callee, site), reference.name)
        meaning = self.lookup(reference, site)
        if meaning.declaration is None or meaning.declaration.kind is Kind.ENUM_VALUE:
            return self._expected(reference, text_site) or meaning
        return meaning

    def _expected(self, reference: Reference, text_site: TextSite) -> Binding | None:
        """Return the value of the enumeration that is expected at the place of the name."""
        if reference.expected is not None:
            type_ = self.type_of(reference.expected, text_site.site)
        elif isinstance(text_site.owner, ValueOf) and not reference.access:
            type_ = self.type_of_value(text_site.owner, text_site.site)
        else:
            return None
        level = self.scopes.enumeration(type_) if isinstance(type_, t.EnumType) else type_
        values = level.named(reference.name) if isinstance(level, Level) else ()
        return next((Binding(value) for value in values if value.kind is Kind.ENUM_VALUE), None)

    def levels(self, reference: Reference, text_site: TextSite) -> Sequence[Level]:
        """The scopes in which a name in a text site is looked for, the first one first; () where that is not known."""
        site = text_site.site
        if reference.unread or reference.declares or reference.role in (Role.STEP, Role.OBJECT, Role.HEAD):
            return ()
        if reference.role is Role.PARAMETER:
            return self._parameters(self._called_by_block(text_site.owner, site))
        if reference.role is Role.MEMBER:
            return self._members(self.type_of_value(text_site.owner, site))
        if reference.base is not None:
            return self._members(self.type_of(reference.base, site, reference.name))
        if reference.callee is not None:
            return self._parameters(self.called_type(reference.callee, site))
        return self._visible(reference, site)

    # -- names on their own

    def lookup(self, reference: Reference, site: Site) -> Binding:
        """Return the declaration that a name on its own refers to."""
        if site.transition is not None and site.transition.name.casefold() == reference.name.casefold():
            # its body in FBD and LD decides its type by assigning to it
            path = f"{site.pou.name if site.pou is not None else ''}.{reference.name}"
            return Binding(Declaration(Kind.TRANSITION, path, (site.transition,), site.pou))
        # an inner scope hides an outer one only by what the role can mean: a type is found past a variable of its name
        levels = self._visible(reference, site)
        nearest: list[Declaration] = []
        for index, level in enumerate(levels):
            found = fitting(level.named(reference.name), reference.role)
            if found and index < len(site.charts):
                # steps are variables of the POU: they have no scope of their own in which they hide its names
                found += self._beside_steps(reference, site)
            if found and reference.access and not any(self._may_have(d, reference.access) for d in found):
                # a variable may be called after its type: before a dot the thing is meant that has such a member
                nearest = nearest or found
            elif found:
                return self._choose(found, reference, site)
        return self._choose(nearest, reference, site) if nearest else NOTHING

    def _beside_steps(self, reference: Reference, site: Site) -> list[Declaration]:
        levels = self.scopes.local(site)[len(site.charts) :]
        found = [d for level in levels for d in fitting(level.named(reference.name), reference.role)]
        return [d for d in found if d.kind is not Kind.STEP]

    def _visible(self, reference: Reference, site: Site) -> Sequence[Level]:
        if reference.role is Role.TYPE or reference.quoting is Quoting.GLOBAL:
            return self.scopes.outer(site.place)
        if reference.quoting is not Quoting.NONE:
            return self.scopes.local(site)
        return self.scopes.levels(site)

    def _choose(self, found: list[Declaration], reference: Reference, site: Site) -> Binding:
        found = self._without_step_variables(found)
        if len(found) > 1 and reference.access:
            having = [d for d in found if self._may_have(d, reference.access)]
            found = having or found
        if reference.role is Role.VALUE and reference.access.casefold() in _STEP_VARIABLES:
            # ``S1.x`` is the flag of a step, or a member x of a variable S1: certain only where the type of the
            # variable is known
            certain = [d for d in found if d.kind is not Kind.STEP and self._has(d, reference.access)]
            steps = [d for d in found if d.kind is Kind.STEP]
            if not certain and steps and len(found) > len(steps):
                return Binding(doubt="a step and a variable have this name", candidates=tuple(found))
            found = certain or found
        found = preferred(found, reference.role)
        if len(found) > 1:
            return Binding(doubt="several things have this name", candidates=tuple(found))
        return self._of_external(found[0], site)

    def _without_step_variables(self, found: Sequence[Declaration]) -> list[Declaration]:
        """Return the same, with a step instead of the variable that its tool declares for it."""
        return list(dict.fromkeys(self.scopes.step_of(d) or d for d in found))

    def _may_have(self, declaration: Declaration, member: str) -> bool:
        if declaration.kind is Kind.STEP:
            return member.casefold() in _STEP_VARIABLES
        unknown = self.type_of_declaration(declaration) in (Untyped.UNKNOWN, Untyped.ELSEWHERE)
        return unknown or self._has(declaration, member)

    def _has(self, declaration: Declaration, member: str) -> bool:
        return self.member(self.type_of_declaration(declaration), member).declaration is not None

    def _of_external(self, declaration: Declaration, site: Site) -> Binding:
        """Return the global variable that a variable in VAR_EXTERNAL is."""
        if not self.scopes.is_external(declaration):
            return Binding(declaration)
        for level in self.scopes.outer(site.place):
            found = [d for d in level.named(declaration.name) if d.kind is Kind.VARIABLE]
            if len(found) > 1:
                return Binding(doubt="several global variables have this name", candidates=(declaration, *found))
            if found:
                return Binding(found[0])
        return Binding(declaration)

    def original(self, declaration: Declaration) -> Declaration:
        """Return the declaration that a variable in VAR_EXTERNAL or in an instance data block repeats, or itself."""
        if declaration.pou is not None:
            step = self.scopes.step_of(declaration)
            if step is not None:
                return step
            return self._of_external(declaration, Site(place=declaration.pou.place)).declaration or declaration
        for block in self.project.data_blocks:
            if block.type_name and declaration in self.scopes.data_block(block):
                type_ = self.settled(t.DerivedType(name=block.type_name), "")
                return self.member(type_, declaration.name).declaration or declaration
        return declaration

    def repeated(self, declaration: Declaration) -> Iterator[NamedObject]:
        """Yield the variables that repeat a declaration: in VAR_EXTERNAL, in instance data blocks, of steps."""
        if declaration.pou is not None:
            alike = self.scopes.pou(declaration.pou).named(declaration.name)
            yield from (own.holder for own in alike if self.scopes.step_of(own) == declaration)
        for pou in self.project.pous:
            for site in (Site(pou, place=pou.place), *(Site(pou, method, place=pou.place) for method in pou.methods)):
                yield from self._externals(declaration, site)
        for block in self.project.data_blocks:
            if block.type_name and declaration.kind in (Kind.VARIABLE, Kind.MEMBER, Kind.STEP, Kind.TRANSITION):
                type_ = self.settled(t.DerivedType(name=block.type_name), "")
                if any(declaration in level for level in self._members(type_)):
                    yield from (own.holder for own in self.scopes.data_block(block).named(declaration.name))

    def _externals(self, declaration: Declaration, site: Site) -> Iterator[NamedObject]:
        """Yield the variables in VAR_EXTERNAL of a POU or method that are this global variable."""
        around = site.method or site.pou
        key = declaration.name.casefold()
        declared = around.interface.variables(SectionKind.EXTERNAL) if around and around.interface is not None else []
        if not any(variable.name.casefold() == key for variable in declared):
            return  # its charts need not be read for that
        for level in self.scopes.local(site)[:1]:
            for own in level.named(declaration.name):
                if self.scopes.is_external(own) and self._of_external(own, site).declaration == declaration != own:
                    yield own.holder

    # -- members

    def member(self, type_: Type, name: str) -> Binding:
        """Return the member `name` of a value or a thing of this type."""
        if type_ is Untyped.UNKNOWN:
            return Binding(doubt="the type of what is before the dot is not known")
        for level in self._members(type_):
            found = [d for d in level.named(name) if d.kind is not Kind.TRANSITION]
            if found:
                found = preferred(self._without_step_variables(found), Role.VALUE)
                if len(found) > 1:
                    return Binding(doubt="several things have this name", candidates=tuple(found))
                return self._of_external(found[0], Site(place=found[0].pou.place if found[0].pou is not None else ""))
        return NOTHING

    def _members(self, type_: Type) -> Sequence[Level]:
        for _ in range(_MOST_ALIASES):  # a type can be a pointer to itself
            if not isinstance(type_, t.ArrayType | t.PointerType):
                break
            type_ = self.settled(type_.base, "")  # references are followed without a sign
        if isinstance(type_, Level):
            return (type_,)
        if isinstance(type_, Pou):
            return self.scopes.pou_levels(type_)
        if isinstance(type_, t.StructType):
            return self.scopes.structure_levels(type_)
        return ()

    def type_of(self, expression: n.Expression | n.Node, site: Site, access: str = "") -> Type:
        """Return the type of an expression, or the thing that it names; `access` is the member of it that is meant."""
        if isinstance(expression, n.Parenthesized):
            return self.type_of(expression.inner, site)
        if isinstance(expression, n.Peripheral):
            return self.type_of(expression.base, site)
        if isinstance(expression, n.Index | n.Dereference):
            base = self.type_of(expression.base, site)
            return self.settled(base.base, site.place) if isinstance(base, t.ArrayType | t.PointerType) else base
        if isinstance(expression, n.Call):
            return self._result(expression.callee, site)
        if isinstance(expression, n.Name):
            own = self._own(expression.identifier, site)
            if own is not None:
                return own
            meaning = self.lookup(named(expression, access=access), site)
            if meaning is NOTHING and standard_block(expression.identifier) is not None:
                return Untyped.FOREIGN
        elif isinstance(expression, n.Member):
            base = self.type_of(expression.base, site, expression.name.identifier)
            if base is Untyped.FOREIGN:
                return base
            meaning = self.member(base, expression.name.identifier)
        else:
            return Untyped.FOREIGN
        if meaning.declaration is None:
            return Untyped.UNKNOWN
        if site.method is not None and meaning.declaration.holder is site.method:
            result = site.method.interface.return_type if site.method.interface is not None else None
            return self.settled(result, site.place) if result is not None else Untyped.FOREIGN
        return self.type_of_declaration(meaning.declaration)

    def declaration_of(self, value: n.Node, site: Site) -> Declaration | None:
        """Return the declaration of a variable or a member; None for anything else."""
        if isinstance(value, n.Name):
            return self.lookup(named(value), site).declaration
        if isinstance(value, n.Member):
            base = self.type_of(value.base, site, value.name.identifier)
            return self.member(base, value.name.identifier).declaration
        return None

    def _own(self, word: str, site: Site) -> Type | None:
        """Return the POU that THIS or SUPER of CODESYS is."""
        if site.pou is None or word.upper() not in ("THIS", "SUPER"):
            return None
        if word.upper() == "THIS":
            return site.pou
        return self.scopes.base(site.pou) or Untyped.FOREIGN

    def type_of_declaration(self, declaration: Declaration) -> Type:
        """Return the type of a variable; what other things are that have members."""
        holder: Any = declaration.holder
        place = declaration.pou.place if declaration.pou is not None else ""
        if isinstance(holder, t.Variable):
            return self.settled(holder.type, place)
        if isinstance(holder, Pou):
            return holder
        if isinstance(holder, t.DataTypeDeclaration):
            if isinstance(holder.type, t.EnumType):
                return self.scopes.enumeration(holder.type)
            return self.settled(holder.type, place)
        if isinstance(holder, VariableSection):
            return list_level(declaration)
        if isinstance(holder, DataBlock):
            type_ = self.settled(t.DerivedType(name=holder.type_name), "") if holder.type_name else Untyped.ELSEWHERE
            return self.scopes.data_block(holder) if type_ is Untyped.ELSEWHERE else type_
        if isinstance(holder, Tag):
            elementary = holder.type.upper()
            if elementary in t.Elementary.__members__:
                return t.ElementaryType(name=t.Elementary[elementary])
            return self.settled(t.DerivedType(name=holder.type), "")
        if isinstance(holder, PouInstance):
            return self.settled(t.DerivedType(name=holder.type_name), "")
        if isinstance(holder, Resource | Configuration):
            return self.scopes.place(namespace_place(self.project, holder))
        return Untyped.FOREIGN

    def settled(self, type_: t.DataType, place: str) -> Type:
        """Return a type, or the type that its name is an alias of."""
        for _ in range(_MOST_ALIASES):
            if not isinstance(type_, t.DerivedType):
                return type_
            name = type_.name
            if self.dialect is not Dialect.SCL:  # where a name can be anything, and is alone here
                tree = parse_expression(name, self.dialect).tree
                if not isinstance(tree, n.Name):
                    return Untyped.UNKNOWN
            meaning = self.lookup(Reference(name.strip('"'), (0, 0), Role.TYPE), Site(place=place))
            if meaning.declaration is None:
                known = standard_block(name) is not None or name.upper() in _FOREIGN_TYPES
                return Untyped.FOREIGN if known else Untyped.ELSEWHERE
            holder: Any = meaning.declaration.holder
            if isinstance(holder, Pou):
                return holder
            type_ = holder.type
        return Untyped.UNKNOWN

    def endless_types(self) -> Iterator[tuple[StoredType, ...]]:
        """Yield the types and blocks that contain themselves, each with those through which they do, once a circle."""
        stored: list[StoredType] = [*self.project.data_types, *self.project.pous]
        declared = {id(each): each for each in stored}
        contained = {key: [id(inner) for inner in self._contained(each)] for key, each in declared.items()}
        told: set[frozenset[int]] = set()
        for start in _with_an_end_removed(contained):
            before: dict[int, int | None] = {start: None}
            waiting = [start]
            for each in waiting:
                if start in contained[each]:
                    way: list[int] = []
                    at: int | None = each
                    while at is not None:
                        way.append(at)
                        at = before[at]
                    if frozenset(way) not in told:
                        told.add(frozenset(way))
                        yield tuple(declared[key] for key in reversed(way))
                    break
                for inner in contained[each]:
                    if inner not in before:
                        before[inner] = each
                        waiting.append(inner)

    def _contained(self, thing: StoredType) -> list[StoredType]:
        """Return the declared types of what is stored in a value of a type, or in an instance of a block."""
        types = [thing.type] if isinstance(thing, t.DataTypeDeclaration) else []
        if isinstance(thing, Pou) and thing.kind is PouKind.FUNCTION_BLOCK and thing.interface is not None:
            stored = [section for section in thing.interface.sections if section.kind not in _NOT_STORED]
            types = [variable.type for section in stored for variable in section.variables]
        found: list[StoredType] = []
        for type_ in types:
            if isinstance(type_, t.ArrayType):
                types.append(type_.base)
            elif isinstance(type_, t.StructType):
                types += [member.type for member in type_.members]
            elif isinstance(type_, t.DerivedType):
                reference = Reference(type_.name.strip('"'), (0, 0), Role.TYPE)
                declaration = self.lookup(reference, Site(place=thing.place)).declaration
                holder = declaration.holder if declaration is not None else None
                if isinstance(holder, Pou | t.DataTypeDeclaration):
                    found.append(holder)
        return found

    # -- calls

    def _result(self, callee: n.Expression, site: Site) -> Type:
        """Return the type of what a call gives back."""
        called = self.called_type(callee, site)
        if isinstance(called, Untyped):
            return called
        interface = called.interface if isinstance(called, Pou | Method) else None
        if interface is not None and interface.return_type is not None:
            return self.settled(interface.return_type, site.place)
        return Untyped.FOREIGN

    def called(self, callee: n.Expression, site: Site) -> Declaration | None:
        """Return the declaration of what a call names: an action, a method, an instance, a POU; None: not known."""
        found = self._called_thing(callee, site)
        return found.declaration if found is not None else None

    def _called_thing(self, callee: n.Node, site: Site) -> Binding | None:
        """Return what a name or path in the place of a callee means; None for other expressions."""
        if isinstance(callee, n.Name):
            return self.lookup(named(callee, role=Role.CALL), site)
        if isinstance(callee, n.Member):
            name = callee.name.identifier
            return self.member(self.type_of(callee.base, site, name), name)
        return None

    def called_type(self, callee: n.Expression | n.Node, site: Site) -> Pou | Method | Type:
        """Return the POU, method or type that a call names."""
        meaning = self._called_thing(callee, site)
        if meaning is None:
            return self.type_of(callee, site)
        if meaning is NOTHING and isinstance(callee, n.Name):
            # in SCL all but the instructions of the controller are in quotes
            instruction = self.dialect is Dialect.SCL and callee.quoting is Quoting.NONE
            if instruction or standard_block(callee.identifier) is not None:
                return Untyped.FOREIGN
        declaration = meaning.declaration
        if declaration is None:
            return Untyped.UNKNOWN
        if isinstance(declaration.holder, Method):
            return declaration.holder
        if declaration.kind is Kind.ACTION and declaration.pou is not None:
            return declaration.pou
        return self.type_of_declaration(declaration)

    def parameter_type(self, call: n.Call, position: int, site: Site) -> Type:
        """The type of the parameter that gets an argument of a call, by the name or the place of the argument."""
        called = self.called_type(call.callee, site)
        name = call.arguments[position].name
        if name is not None:
            declaration = self._parameter(called, name.identifier).declaration
            return self.type_of_declaration(declaration) if declaration is not None else Untyped.UNKNOWN
        if not isinstance(called, Pou | Method) or called.interface is None:
            return Untyped.UNKNOWN
        inputs = parameters_of(called.interface)
        return self.settled(inputs[position].type, site.place) if position < len(inputs) else Untyped.UNKNOWN

    def standard_block_of(self, value: n.Expression | n.Node, site: Site) -> StandardBlock | None:
        """Return the standard function block that a value is an instance of, None for other values."""
        depth = 0
        while isinstance(value, n.Parenthesized | n.Index):
            depth += isinstance(value, n.Index)
            value = value.inner if isinstance(value, n.Parenthesized) else value.base
        meaning = self._called_thing(value, site)
        declaration = meaning.declaration if meaning is not None else None
        holder = declaration.holder if declaration is not None else None
        type_ = holder.type if isinstance(holder, t.Variable) else None
        while depth and isinstance(type_, t.ArrayType):
            depth, type_ = depth - 1, type_.base
        if depth or not isinstance(type_, t.DerivedType) or self.settled(type_, site.place) is not Untyped.FOREIGN:
            return None
        block = standard_block(BLOCKS_OF_S7.get(type_.name, type_.name))
        return block if block is not None and block.stateful else None

    def _parameter(self, called: Pou | Method | Type, name: str) -> Binding:
        if called is Untyped.UNKNOWN:
            return Binding(doubt="what is called is not known")
        if isinstance(called, Pou) and called.kind is PouKind.FUNCTION and called.name.casefold() == name.casefold():
            return Binding(Declaration(Kind.POU, called.name, (called,)))  # its result
        for level in self._parameters(called):
            found = [d for d in level.named(name) if d.kind in (Kind.VARIABLE, Kind.MEMBER)]
            if found:
                return Binding(found[0])
        return NOTHING

    def _parameters(self, called: Pou | Method | Type) -> Sequence[Level]:
        if isinstance(called, Method):
            owner = next(pou for pou in self.project.pous if any(m is called for m in pou.methods))
            return (self.scopes.method(owner, called),)
        return self._members(called)

    def _parameter_of_block(self, block: object, name: str, site: Site) -> Binding:
        if not isinstance(block, Block):
            return Binding(doubt="only its tool knows the element that it is a pin of")
        return self._parameter(self._called_by_block(block, site), name)

    def _called_by_block(self, block: object, site: Site) -> Pou | Method | Type:
        if not isinstance(block, Block):
            return Untyped.UNKNOWN
        if block.instance:
            called = self.type_of(parse_expression(block.instance, self.dialect).tree, site)
            return (
                called
                if called is not Untyped.UNKNOWN
                else self.settled(t.DerivedType(name=block.type_name), site.place)
            )
        tree = parse_expression(block.type_name, self.dialect).tree
        type_ = self.called_type(tree, site)
        # of what is in a block by its name alone, the type is that name
        return Untyped.ELSEWHERE if type_ is Untyped.UNKNOWN and not isinstance(tree, n.Member) else type_

    # -- names with a place of their own

    def _member_of_value(self, value: object, name: str, site: Site) -> Binding:
        if not isinstance(value, ValueOf):
            return Binding(doubt="the type of the value is not known")
        return self._parameter(self.type_of_value(value, site), name)

    def type_of_value(self, value: object, site: Site) -> Type:
        """Return the type of what an initial value at a site is for."""
        if not isinstance(value, ValueOf):
            return Untyped.UNKNOWN
        type_ = self.settled(value.type, site.place)
        for member in value.members:
            inner = self.member(type_, member.member).declaration
            type_ = self.type_of_declaration(inner) if inner is not None else Untyped.UNKNOWN
        return type_


def circle_text(circle: Sequence[StoredType]) -> str:
    """Return what a circle of `Resolver.endless_types` is, for people."""
    head, *others = [each.name for each in circle]
    return f"{head} contains itself" + (f" through {', '.join(others)}" if others else "")


def _with_an_end_removed(contained: dict[int, list[int]]) -> list[int]:
    """Return the keys of what contains itself, or what does: without all that has an end."""
    holders = grouped((inner, key) for key, inside in contained.items() for inner in inside)
    left = {key: len(inside) for key, inside in contained.items()}
    ending = [key for key, count in left.items() if not count]
    for key in ending:
        for holder in holders.get(key, ()):
            left[holder] -= 1
            if not left[holder]:
                ending.append(holder)
    return [key for key, count in left.items() if count]


def fitting(found: Sequence[Declaration], role: Role) -> list[Declaration]:
    """Return those of the declarations that a name in this role can mean."""
    if role is Role.TYPE:
        return [d for d in found if d.kind in (Kind.POU, Kind.DATA_TYPE)]
    if role is Role.TRANSITION:
        return list(found)
    if role is Role.CALL:  # a step may have the name of a standard function
        return [d for d in found if d.kind not in (Kind.TRANSITION, Kind.STEP)]
    return [d for d in found if d.kind is not Kind.TRANSITION]


def preferred(found: Sequence[Declaration], role: Role) -> list[Declaration]:
    """Return those of several declarations in one scope that a name in this role means: one, if that can be told."""
    if role in (Role.ACTION, Role.CALL):
        found = [d for d in found if _is_callable(d)] or found
    ranks = _RANKS.get(role, _VALUE_RANKS)
    best = min(ranks.get(d.kind, _LAST) for d in found)
    return [d for d in found if ranks.get(d.kind, _LAST) == best]


def _is_callable(declaration: Declaration) -> bool:
    holder = declaration.holder
    if declaration.kind is Kind.STEP:
        return False  # an action ``S Fill`` sets the variable of that name, in a step Fill too
    if isinstance(holder, Pou):
        return holder.kind is not PouKind.FUNCTION_BLOCK
    return not isinstance(holder, t.Variable) or not isinstance(holder.type, t.ElementaryType | t.StringType)


_STEP_VARIABLES = frozenset({"x", "t"})
"""The members of a step (IEC 61131-3: ``S.X``, ``S.T``; CODESYS: ``S.x``, ``S.t``)."""
_NOT_STORED = frozenset({SectionKind.IN_OUT, SectionKind.EXTERNAL, SectionKind.TEMP})
_MOST_ALIASES = 20
_FOREIGN_TYPES = frozenset({"SFCSTEPTYPE", "SFCACTIONTYPE", "S5TIME", "BIT", "LTIME"})
_LAST = 9
_VALUE_RANKS = {
    Kind.VARIABLE: 0,
    Kind.MEMBER: 0,
    Kind.DATA_BLOCK: 0,
    Kind.ENUM_VALUE: 1,
    Kind.INSTANCE: 1,
    Kind.STEP: 2,
    Kind.METHOD: 3,
    Kind.ACTION: 3,
    Kind.GLOBAL_LIST: 4,
    Kind.POU: 5,
    Kind.DATA_TYPE: 6,
    Kind.NAMESPACE: 7,
}
_EXECUTED_RANKS = {
    Kind.ACTION: 0,
    Kind.METHOD: 0,
    Kind.VARIABLE: 1,
    Kind.DATA_BLOCK: 1,
    Kind.POU: 2,
    Kind.INSTANCE: 3,
    Kind.STEP: 4,
}
_RANKS = {
    Role.ACTION: _EXECUTED_RANKS,
    Role.CALL: _EXECUTED_RANKS,
    Role.TRANSITION: {Kind.TRANSITION: 0, Kind.VARIABLE: 1},
    Role.TYPE: {Kind.POU: 0, Kind.DATA_TYPE: 0},
}
"""Rank among things of one name: that with the lowest number is meant."""
