"""Structures without a name, which matiec does not take in declarations: each becomes a data type."""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.formats.matiec.naming import matiec_name
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import (
    ArrayType,
    DataType,
    DataTypeDeclaration,
    DerivedType,
    EnumType,
    StructType,
    Variable,
)
from plcopen_sfc.report import ConversionReport, Outcome


def name_structures(project: Project, report: ConversionReport) -> None:
    """Give a name to the structures and enumerations in declarations of variables and in other structures."""
    namer = _Namer(project)
    for declaration in list(project.data_types):
        if isinstance(declaration.type, StructType):
            namer.fit(declaration.type.members, declaration.name)
        elif isinstance(declaration.type, ArrayType):
            declaration.type.base = namer.named(declaration.type.base, f"{declaration.name}_element")
    for pou in project.pous:
        namer.fit(pou.variables(), pou.name)
    for section in project.global_sections():
        for variable in section.variables:
            wish = f"{section.name or 'global'}_{variable.name}"
            variable.type = namer.named(variable.type, wish)
            if isinstance(variable.type, ArrayType):  # VAR_EXTERNAL must name the same type
                variable.type = namer.declared(variable.type, wish)
    for name in namer.given:
        report.add(Outcome.TRANSLATED, "data type", f"type {name}", "a type without a name got one")


class _Namer:
    def __init__(self, project: Project) -> None:
        self.project = project
        self.used = {one.name.casefold() for one in (*project.data_types, *project.pous)}
        self.given: list[str] = []

    def fit(self, variables: Iterable[Variable], owner: str) -> None:
        """Give names to what the types of `variables` hold."""
        for variable in variables:
            variable.type = self.named(variable.type, f"{owner}_{variable.name}")

    def named(self, kind: DataType, wish: str) -> DataType:
        """The type, or the new name of one that has none."""
        if isinstance(kind, ArrayType):
            kind.base = self.named(kind.base, f"{wish}_element")
            return kind
        if not isinstance(kind, StructType | EnumType):
            return kind
        if isinstance(kind, StructType):
            self.fit(kind.members, wish)
        return self.declared(kind, wish)

    def declared(self, kind: DataType, wish: str) -> DerivedType:
        """A new data type for `kind`."""
        name, number = matiec_name(f"T_{wish}"), 1
        while name.casefold() in self.used:
            number += 1
            name = matiec_name(f"T_{wish}_{number}")
        self.used.add(name.casefold())
        self.given.append(name)
        self.project.data_types.append(DataTypeDeclaration(name=name, type=kind))
        return DerivedType(name=name)
