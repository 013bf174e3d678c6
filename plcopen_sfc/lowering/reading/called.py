"""What an association names: something to be called, or a Boolean variable to be written."""

from __future__ import annotations

from functools import cached_property

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.names.declarations import Kind
from plcopen_sfc.languages.names.pieces import Role, Site
from plcopen_sfc.languages.names.references import named
from plcopen_sfc.languages.names.resolving import Resolver, Untyped
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import (
    ArrayType,
    Elementary,
    ElementaryType,
    EnumType,
    StringType,
    StructType,
    SubrangeType,
)


class Targets:
    """Tells of the targets of a POU's actions what they are; see `plcopen_sfc.semantics.charts.targets`."""

    def __init__(self, pou: Pou, project: Project | None, dialect: Dialect) -> None:
        self._site = Site(pou, place=pou.place)
        self._project = project if project is not None else Project(pous=[pou])
        self._dialect = dialect

    @cached_property
    def _resolver(self) -> Resolver:
        return Resolver(self._project, self._dialect)

    def is_called(self, target: n.Expression) -> bool:
        """Whether it is an instance, a program, or an action of one. A name that nobody declares is a variable."""
        if isinstance(target, n.Member):
            base = self._resolver.type_of(target.base, self._site, target.name.identifier)
            if base in (Untyped.FOREIGN, Untyped.ELSEWHERE):
                return False  # an output of a standard block, or of one of a library
            meaning = self._resolver.member(base, target.name.identifier)
            if meaning.declaration is None:
                return base is not Untyped.UNKNOWN
        elif isinstance(target, n.Name):
            meaning = self._resolver.lookup(named(target, role=Role.ACTION), self._site)
            if meaning.declaration is None:
                return False
        else:
            return False
        declaration = meaning.declaration
        if declaration.kind in (Kind.ACTION, Kind.METHOD):
            return True
        type_ = self._resolver.type_of_declaration(declaration)
        return isinstance(type_, Pou) or (declaration.kind is Kind.VARIABLE and type_ is Untyped.FOREIGN)

    def other_type(self, target: n.Expression) -> str:
        """The type of a variable that is known not to be Boolean; empty if it is, or can be."""
        type_ = self._resolver.type_of(target, self._site)
        if isinstance(type_, ElementaryType):
            return "" if type_.name is Elementary.BOOL else type_.name.value
        return type_.kind if isinstance(type_, _NEVER_BOOLEAN) else ""


_NEVER_BOOLEAN = (StringType, ArrayType, StructType, EnumType, SubrangeType)
