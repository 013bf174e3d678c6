"""Scopes: the declarations of a project by where they are visible."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from typing import Any, TypeVar

from plcopen_sfc.languages.binding.name_sites import Reference
from plcopen_sfc.languages.binding.symbols import (
    NOTHING,
    Binding,
    Level,
    inside,
    members_of,
    values_of,
    variable_of,
    variables_of,
)
from plcopen_sfc.languages.binding.text_sites import Site, TextSite
from plcopen_sfc.languages.declarations.kept_texts import inheritance, kept_inheritance
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model import types as t
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, DataBlock, Method, NamedTransition, Pou
from plcopen_sfc.model.project import Configuration, Project, Resource, TreeNode
from plcopen_sfc.model.sfc import Body, SfcBody, SfcNetwork
from plcopen_sfc.model.variables import PASSED, Interface, SectionKind, VariableSection, sections_of

_T = TypeVar("_T")


class Scopes:
    """The scopes of a project, each made when it is first asked for. Edits of the project make them wrong."""

    def __init__(self, project: Project) -> None:
        self._project = project
        self._levels: dict[int, Level] = {}
        self._sites: dict[tuple[object, ...], tuple[Level, ...]] = {}
        self._places: dict[str, Level] | None = None
        self._everywhere = Level()
        self._values = Level()
        self._externals: set[int] = set()
        self._steps: dict[int, Declaration] = {}
        self._chains: list[list[Pou]] | None = None
        self._declared: dict[int, t.DataTypeDeclaration] | None = None
        self._owners: dict[int, tuple[str, Pou | None]] | None = None

    def levels(self, site: Site) -> tuple[Level, ...]:
        """Return the scopes that are visible at `site`, the innermost first."""
        # by identity: objects of the model are equal by content, and two equal POUs are two scopes
        key = (id(site.pou), id(site.method), tuple(map(id, site.charts)), site.place)
        found = self._sites.get(key)
        if found is None:
            found = self._sites[key] = (*self.local(site), *self.outer(site.place))
        return found

    def local(self, site: Site) -> tuple[Level, ...]:
        """Return the scopes within the POU: of the charts, the method, the POU."""
        levels = [self.chart(chart, site.pou) for chart in site.charts]
        if site.method is not None and site.pou is not None:
            levels.append(self.method(site.pou, site.method))
        if site.pou is not None:
            levels += self.pou_levels(site.pou)
        return tuple(levels)

    def outer(self, place: str) -> tuple[Level, ...]:
        """The scopes around POUs: of the application, of the project, and of enumeration values without their type."""
        places = self._by_place()
        near = [places[p] for p in _outward(place) if p in places]
        return (*near, self._everywhere, self._values)

    def place(self, place: str) -> Level:
        """Return the declarations of an application, a resource or a configuration."""
        return self._by_place().get(place) or Level()

    def pou(self, pou: Pou) -> Level:
        """Return the declarations of a POU: variables, actions, transitions, methods, the steps of its charts."""
        is_new = id(pou) not in self._levels
        level = self._level(pou, self._of_pou(pou))
        if is_new:
            self._find_step_variables(level)
        return level

    def _level(self, thing: object, declarations: Iterable[Declaration]) -> Level:
        """Return the level of `thing`, which is made of its declarations when it is first asked for."""
        level = self._levels.get(id(thing))
        if level is None:
            level = self._levels[id(thing)] = Level(declarations)
        return level

    def _find_step_variables(self, level: Level) -> None:
        for variable in level:
            type_ = getattr(variable.holder, "type", None)
            # text that names the variable means the step: a rename of either has to take the other with it
            if isinstance(type_, t.DerivedType) and _OF_STEPS.fullmatch(type_.name):
                for other in level.named(variable.name):
                    if other.kind in (Kind.STEP, Kind.TRANSITION):
                        self._steps.setdefault(id(variable.holder), other)

    def step_of(self, declaration: Declaration) -> Declaration | None:
        """Return the step or transition whose variable this is, if the tool declares such among the others."""
        return self._steps.get(id(declaration.holder))

    def pou_levels(self, pou: Pou) -> tuple[Level, ...]:
        """Return the scope of a POU and those of what it extends."""
        return tuple(map(self.pou, _chain(pou, self.base)))

    def base(self, pou: Pou) -> Pou | None:
        """Return the POU that this one extends, as the text of its declaration names it."""
        # behind the namespace of a library, which may be in the project as well
        names = [name.rpartition(".")[2] for name in inheritance(pou.interface).extends]
        found = [d.holder for level in self.outer(pou.place) for name in names for d in level.named(name)]
        return next((holder for holder in found if isinstance(holder, Pou)), None)

    def extends_unknown(self, thing: object) -> bool:
        """Return True for a POU or structure that extends, directly or not, what the project does not declare."""
        if isinstance(thing, Pou):
            last = _chain(thing, self.base)[-1]
            return bool(inheritance(last.interface).extends) and self.base(last) is None
        if isinstance(thing, t.StructType) and len(self.structure_levels(thing)):
            end = _chain(thing, self._extended)[-1]
            declaration = (self._declared or {}).get(id(end))
            extends = kept_inheritance(declaration.extension_data).extends if declaration is not None else ()
            return bool(extends) and self._extended(end) is None
        return False

    def overrides(self, declaration: Declaration) -> list[Declaration]:
        """Return the declarations that have their name together with this one, because blocks extend each other.

        For a method or an action those that override it or that it overrides; for a parameter of a method theirs.
        """
        pou, holder = declaration.pou, declaration.holder
        if pou is None or declaration.kind not in (Kind.METHOD, Kind.ACTION, Kind.VARIABLE):
            return []
        if declaration.kind is not Kind.VARIABLE:
            return [each for each in self._overriding(pou, declaration.kind, declaration.name) if each != declaration]
        method = next((each for each in pou.methods if any(holder is v for v in parameters_of(each.interface))), None)
        others = self._overriding(pou, Kind.METHOD, method.name) if method is not None else []
        return [
            Declaration(Kind.VARIABLE, f"{other.path}.{parameter.name}", (parameter,), other.pou)
            for other in others
            for parameter in (parameters_of(other.holder.interface) if isinstance(other.holder, Method) else ())
            if parameter.name.casefold() == declaration.name.casefold() and parameter is not holder
        ]

    def _overriding(self, pou: Pou, kind: Kind, name: str) -> list[Declaration]:
        """Return the methods or actions of a name in a POU, in what it extends, and in what extends that."""
        if self._chains is None:
            self._chains = [_chain(each, self.base) for each in self._project.pous]
        own = next(each for each in self._chains if each[0] is pou)
        # blocks that extend the topmost one which declares it override one method, also beside each other
        root = next((each for each in reversed(own) if self._declares(each, kind, name)), pou)
        family = (blocks[0] for blocks in self._chains if any(each is root for each in blocks))
        return [found for each in family for found in self._declares(each, kind, name)]

    def _declares(self, pou: Pou, kind: Kind, name: str) -> list[Declaration]:
        return [each for each in self.pou(pou).named(name) if each.kind is kind]

    def method(self, pou: Pou, method: Method) -> Level:
        """Return the declarations of a method."""
        path = f"{pou.name}.{method.name}"
        return self._level(method, chain(self._variables(method.interface, path, pou), _steps(method.body, path, pou)))

    def data_block(self, block: DataBlock) -> Level:
        """Return the variables of a data block."""
        return self._level(block, variables_of(block.interface, block.name, None))

    def chart(self, chart: SfcNetwork, pou: Pou | None) -> Level:
        """Return the steps of a chart, without those of charts in it."""
        return self._level(chart, steps_of(chart, pou.name if pou is not None else "", pou))

    def structure(self, type_: t.StructType) -> Level:
        """Return the members of a structure."""
        return self._level(type_, members_of(type_, *self._owner_of(type_)))

    def structure_levels(self, type_: t.StructType) -> tuple[Level, ...]:
        """Return the members of a structure, and those of what it extends."""
        if self._declared is None:
            self._declared = {id(each.type): each for each in self._project.data_types}
        return tuple(map(self.structure, _chain(type_, self._extended)))

    def _extended(self, type_: t.StructType) -> t.StructType | None:
        """Return the structure that this one extends, as its declaration names it."""
        declaration = (self._declared or {}).get(id(type_))
        if declaration is None:
            return None
        for name in kept_inheritance(declaration.extension_data).extends:
            for level in self.outer(declaration.place):
                for found in level.named(name.rpartition(".")[2]):
                    if isinstance(found.holder, t.DataTypeDeclaration) and isinstance(found.holder.type, t.StructType):
                        return found.holder.type
        return None

    def enumeration(self, type_: t.EnumType) -> Level:
        """Return the values of an enumeration."""
        return self._level(type_, values_of(type_, *self._owner_of(type_)))

    def _owner_of(self, type_: t.StructType | t.EnumType) -> tuple[str, Pou | None]:
        """Return the path of what a type is declared in, and the POU that this belongs to."""
        if self._owners is None:
            self._owners = {id(inner): (path, pou) for inner, path, pou in _types(self._project)}
        return self._owners.get(id(type_), ("", None))

    def every_place(self) -> Iterator[Level]:
        """Yield the scopes of everything global."""
        self._by_place()
        yield self._everywhere
        for section in self._project.global_sections():
            yield Level(variables_in(section))

    def every_type(self) -> Iterator[Level]:
        """Yield the members of every type that is declared in place."""
        for type_, _, _ in _types(self._project):
            if isinstance(type_, t.StructType):
                yield self.structure(type_)
            elif isinstance(type_, t.EnumType):
                yield self.enumeration(type_)

    def objects(self) -> Iterator[Declaration]:
        """Yield the declarations that can have a node in the project tree of the tool."""
        kinds = (Kind.POU, Kind.DATA_TYPE, Kind.GLOBAL_LIST, Kind.ACTION, Kind.METHOD, Kind.TRANSITION)
        for _, declaration in self._global():
            if declaration.kind in kinds:
                yield declaration
        for pou in self._project.pous:
            for declaration in self.pou(pou):
                if declaration.kind in kinds and hasattr(declaration.holder, "object_id"):
                    yield declaration

    def is_external(self, declaration: Declaration) -> bool:
        """True if a variable is declared in VAR_EXTERNAL: it is the global variable of its name."""
        return id(declaration.holder) in self._externals

    def _of_pou(self, pou: Pou) -> Iterator[Declaration]:
        yield from self._variables(pou.interface, pou.name, pou)
        for action in pou.actions:
            yield Declaration(Kind.ACTION, f"{pou.name}.{action.name}", (action,), pou)
        for transition in pou.transitions:
            yield Declaration(Kind.TRANSITION, f"{pou.name}.{transition.name}", (transition,), pou)
        for method in pou.methods:
            yield Declaration(Kind.METHOD, f"{pou.name}.{method.name}", (method,), pou)
        for body in pou.bodies:
            yield from _steps(body, pou.name, pou)
        parts: list[Action | NamedTransition] = [*pou.actions, *pou.transitions]
        for part in parts:
            yield from _steps(part.body, f"{pou.name}.{part.name}", pou)

    def _variables(self, interface: Interface | None, path: str, pou: Pou) -> Iterator[Declaration]:
        for section in sections_of(interface):
            if section.kind is SectionKind.EXTERNAL:
                self._externals.update(id(variable) for variable in section.variables)
        yield from variables_of(interface, path, pou)

    # -- global

    def _by_place(self) -> dict[str, Level]:
        if self._places is None:
            self._places = {}
            for place, declaration in self._global():
                self._everywhere.add(declaration)
                if place:
                    self._places.setdefault(place, Level()).add(declaration)
            for type_declaration in self._project.data_types:
                type_ = type_declaration.type
                if isinstance(type_, t.EnumType) and not qualified_only(type_declaration):
                    for value in values_of(type_, type_declaration.name, None):
                        self._values.add(value)
        return self._places

    def _global(self) -> Iterator[tuple[str, Declaration]]:
        project = self._project
        for pou in project.pous:
            yield pou.place, Declaration(Kind.POU, pou.name, (pou,))
        for type_ in project.data_types:
            yield type_.place, Declaration(Kind.DATA_TYPE, type_.name, (type_,))
        for block in project.data_blocks:
            yield "", Declaration(Kind.DATA_BLOCK, block.name, (block,))
        for section in project.global_variables:
            yield from (("", d) for d in _listed(section, project))
        for table in project.tag_tables:
            yield from (("", Declaration(Kind.VARIABLE, tag.name, (tag,))) for tag in table.tags)
            yield from (("", variable_of(constant, "", None)) for constant in table.constants)
        for resource in project.applications:
            yield from _of_resource(resource, f"application/{resource.name}", project)
        for configuration in project.configurations:
            place = f"configuration/{configuration.name}"
            yield "", Declaration(Kind.NAMESPACE, configuration.name, (configuration,))
            for section in configuration.global_variables:
                yield from ((place, d) for d in _listed(section, project))
            for resource in configuration.resources:
                yield place, Declaration(Kind.NAMESPACE, resource.name, (resource,))
                yield from _of_resource(resource, f"{place}/resource/{resource.name}", project)


_OF_STEPS = re.compile(r"G7_(?:Step|Transition)\w*|SFCStepType", re.IGNORECASE)
"""The types of variables that S7-GRAPH declares for each step and transition, and CODESYS on demand, by its name."""


def _chain(first: _T, base: Callable[[_T], _T | None]) -> list[_T]:
    """Return something and what it extends, the nearest first."""
    found: list[_T] = []
    derived: _T | None = first
    while derived is not None and all(derived is not each for each in found):  # a damaged file may have a circle
        found.append(derived)
        derived = base(derived)
    return found


def parameters_of(interface: Interface | None) -> list[t.Variable]:
    """Return the variables that a call passes, in their order."""
    return [variable for section in sections_of(interface) if section.kind in PASSED for variable in section.variables]


def given(call: n.Call, parameters: Iterable[str]) -> dict[str, n.Expression]:
    """Return what a call passes to `parameters`, in lower case, by their names: those by place are in this order."""
    by_place, found = iter(parameters), dict[str, n.Expression]()
    for argument in call.arguments:
        name = argument.name.identifier.casefold() if argument.name is not None else next(by_place, None)
        if name is not None and argument.value is not None and not argument.output:
            found[name] = argument.value
    return found


def is_instance(type_: t.DataType, project: Project) -> bool:
    """True for the type of an instance: of a function block of the project, or of a standard one."""
    name = type_.name.rpartition(".")[2].casefold() if isinstance(type_, t.DerivedType) else ""
    standard = standard_block(name.upper())
    return any(pou.name.casefold() == name for pou in project.pous) or (standard is not None and standard.stateful)


def namespace_place(project: Project, namespace: Resource | Configuration) -> str:
    """Return the place that things in an application, a resource or a configuration have."""
    if isinstance(namespace, Configuration):
        return f"configuration/{namespace.name}"
    for configuration in project.configurations:
        if any(resource is namespace for resource in configuration.resources):
            return f"configuration/{configuration.name}/resource/{namespace.name}"
    return f"application/{namespace.name}"


def _outward(place: str) -> Iterator[str]:
    """Yield a place and those around it."""
    yield place
    if "/resource/" in place:
        yield place.partition("/resource/")[0]


def _of_resource(resource: Resource, place: str, project: Project) -> Iterator[tuple[str, Declaration]]:
    yield place, Declaration(Kind.NAMESPACE, resource.name, (resource,))
    for section in resource.global_variables:
        yield from ((place, declaration) for declaration in _listed(section, project))
    for instance in resource.every_instance():
        if instance.type_name:
            yield place, Declaration(Kind.INSTANCE, f"{resource.name}.{instance.name}", (instance,))


def _listed(section: VariableSection, project: Project) -> Iterator[Declaration]:
    """A list of global variables, and those of its variables that can be named without it: as tags all of them."""
    if section.name:
        yield Declaration(Kind.GLOBAL_LIST, section.name, (section,))  # type: ignore[arg-type]
    if section.name and qualified_only(section) and project.dialect is not Dialect.SCL:
        return
    yield from variables_in(section)


def list_level(declaration: Declaration) -> Level:
    """Names of what is in a list of global variables."""
    sections: tuple[Any, ...] = declaration.holders
    return Level(variable for section in sections for variable in variables_in(section))


def variables_in(section: VariableSection) -> Iterator[Declaration]:
    """The variables of a section of global variables, and the values of enumerations that are declared in place."""
    for variable in section.variables:
        yield variable_of(variable, section.name or "", None)
        for type_ in inside(variable.type):
            if isinstance(type_, t.EnumType):
                yield from values_of(type_, section.name or "", None)


def qualified_only(thing: VariableSection | object) -> bool:
    """True if a list or an enumeration must be named with what it holds (CODESYS ``attribute 'qualified_only'``)."""
    texts = [getattr(thing, "declaration", None) or ""]
    if isinstance(thing, Element) and thing.extension_data is not None:
        texts += [data.content for data in thing.extension_data.data if data.name.endswith("/attributes")]
    return any("qualified_only" in text for text in texts)


def steps_of(chart: SfcNetwork, path: str, pou: Pou | None) -> Iterator[Declaration]:
    """Yield the steps of a chart, and the names of its transitions."""
    for step in chart.steps:
        yield Declaration(Kind.STEP, f"{path}.{step.name}" if path else step.name, (step,), pou)
    for transition in chart.transitions:
        if transition.name:
            name = f"{path}.{transition.name}" if path else transition.name
            yield Declaration(Kind.TRANSITION, name, (transition,), pou)


def charts_inside(body: Body | None) -> Iterator[SfcNetwork]:
    """Yield the chart of a body and those of macro-steps and partial charts in it."""
    if isinstance(body, SfcBody):
        yield from with_inner_charts(body.chart)


def every_chart(pou: Pou) -> Iterator[SfcNetwork]:
    """Yield the charts of a POU and of its parts, those of macro-steps and partial charts too."""
    for _, _, body in pou.named_bodies():
        yield from charts_inside(body)


def with_inner_charts(chart: SfcNetwork) -> Iterator[SfcNetwork]:
    """Yield a chart and those of macro-steps and partial charts in it."""
    waiting = [chart]
    for each in waiting:
        yield each
        waiting += [partial.chart for partial in each.partial_charts]
        macros = [step.macro.body for step in each.steps if step.macro is not None]
        waiting += [macro.chart for macro in macros if isinstance(macro, SfcBody)]


def _steps(body: Body | None, path: str, pou: Pou) -> Iterator[Declaration]:
    for chart in charts_inside(body):
        yield from steps_of(chart, path, pou)


def _types(project: Project) -> Iterator[tuple[t.DataType, str, Pou | None]]:
    """Yield every type that is declared in place, with the path and the POU of what it is declared in."""
    for declaration in project.data_types:
        yield from _inner(declaration.type, declaration.name, None)
    for pou in project.pous:
        interfaces = [(pou.interface, pou.name), *((m.interface, f"{pou.name}.{m.name}") for m in pou.methods)]
        for interface, path in interfaces:
            for variable in interface.variables() if interface is not None else ():
                yield from _inner(variable.type, f"{path}.{variable.name}", pou)
    for block in project.data_blocks:
        for variable in block.interface.variables() if block.interface is not None else ():
            yield from _inner(variable.type, f"{block.name}.{variable.name}", None)
    for section in project.global_sections():
        for variable in section.variables:
            path = f"{section.name}.{variable.name}" if section.name else variable.name
            yield from _inner(variable.type, path, None)


def _inner(type_: t.DataType, path: str, pou: Pou | None) -> Iterator[tuple[t.DataType, str, Pou | None]]:
    for inner in inside(type_):
        yield inner, path, pou
        if isinstance(inner, t.StructType):
            for member in inner.members:
                yield from _inner(member.type, f"{path}.{member.name}", pou)


def step_of(scopes: Scopes, chart: object, name: str, site: Site) -> Binding:
    """Return a step of the chart that something names beside it."""
    if not isinstance(chart, SfcNetwork):
        return Binding(doubt="there is no chart of this name")
    found = [d for d in scopes.chart(chart, site.pou).named(name) if d.kind is Kind.STEP]
    return Binding(found[0]) if found else NOTHING


def object_of(scopes: Scopes, nodes: tuple[TreeNode, ...]) -> Binding:
    """Return the object of a node of the project tree: by its id; without ids, by its name there."""
    node = nodes[-1]
    around = {outer.name.casefold() for outer in nodes[:-1]}
    alike: list[Declaration] = []
    for declaration in scopes.objects():
        object_id = getattr(declaration.holder, "object_id", None)
        if object_id is not None and object_id == node.object_id:
            return Binding(declaration)
        same = declaration.name.casefold() == node.name.casefold()
        if object_id is None and same and (declaration.pou is None or declaration.pou.name.casefold() in around):
            alike.append(declaration)
    if len(alike) > 1:
        return Binding(doubt="several things have this name in the project tree", candidates=tuple(alike))
    return Binding(alike[0]) if alike else NOTHING


def head_of(scopes: Scopes, text_site: TextSite) -> Binding:
    """Return the object that a text of declarations declares as a whole."""
    site = text_site.site
    if isinstance(text_site.owner, VariableSection):
        levels = scopes.outer(site.place)
        lists = [
            d
            for level in levels
            for d in level.named(text_site.owner.name or "")
            if id(text_site.owner) in map(id, d.holders)
        ]
        return Binding(lists[0]) if lists else NOTHING
    if site.pou is not None and site.method is not None:
        path = f"{site.pou.name}.{site.method.name}"
        return Binding(Declaration(Kind.METHOD, path, (site.method,), site.pou))
    return Binding(Declaration(Kind.POU, site.pou.name, (site.pou,))) if site.pou is not None else NOTHING


def declared_name(scopes: Scopes, reference: Reference, text_site: TextSite) -> Binding:
    """Return the declaration of this name in a text of declarations."""
    holder = text_site.owner if isinstance(text_site.owner, VariableSection) else text_site.holder
    within = reference.within
    type_: t.DataType | None = None
    level = Level()
    if isinstance(holder, t.DataTypeDeclaration):
        type_, within = holder.type, within[1:]
    elif isinstance(holder, VariableSection):
        level = Level(variables_in(holder))
    else:
        own = scopes.local(text_site.site)[len(text_site.site.charts) :]
        level = own[0] if own else level
    for name in within:
        if type_ is not None:
            level = _in_place(scopes, type_)
        variables = [d.holder for d in level.named(name)]
        type_ = next((variable.type for variable in variables if isinstance(variable, t.Variable)), None)
        if type_ is None:
            return NOTHING
    if type_ is not None:
        level = _in_place(scopes, type_)
    kinds = (Kind.VARIABLE, Kind.MEMBER, Kind.ENUM_VALUE)
    found = [d for d in level.named(reference.name) if d.kind in kinds]
    return Binding(found[0]) if found else NOTHING


def _in_place(scopes: Scopes, type_: t.DataType) -> Level:
    """Return the declarations in a type: the members of a structure, the values of an enumeration."""
    while isinstance(type_, t.ArrayType | t.PointerType):
        type_ = type_.base
    if isinstance(type_, t.EnumType):
        return scopes.enumeration(type_)
    return scopes.structure(type_) if isinstance(type_, t.StructType) else Level()
