"""Structures that extend others (``TYPE Part EXTENDS Thing``) get the members of those where no tool extends types."""

from __future__ import annotations

from collections.abc import Mapping

from plcopen_sfc.languages.declarations.kept_texts import kept, with_kept
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataTypeDeclaration, StructType
from plcopen_sfc.report import ConversionReport, Outcome


def include_bases(project: Project, report: ConversionReport) -> None:
    """Give the structures of `project`, a copy, the members of those that they extend, before their own.

    A type that extends what the project does not declare stays as it is.
    """
    declared = {declaration.name.casefold(): declaration for declaration in project.data_types}
    for declaration in project.data_types:
        _include(declaration, declared, report, frozenset())


def _include(
    declaration: DataTypeDeclaration,
    declared: Mapping[str, DataTypeDeclaration],
    report: ConversionReport,
    around: frozenset[str],
) -> None:
    """Give a structure the members of its base, after that those of its own; `around` are what extend this one."""
    base = declared.get(_base(declaration))
    if base is None or base.name.casefold() in around:
        return
    _include(base, declared, report, around | {declaration.name.casefold()})
    if isinstance(base.type, StructType) and isinstance(declaration.type, StructType) and not _base(base):
        inherited = [member.model_copy(deep=True) for member in base.type.members]
        declaration.type.members = [*inherited, *declaration.type.members]
        _forget_base(declaration)
        why = f"the members of {base.name}, which it extends, are in it"
        report.add(Outcome.TRANSLATED, "extends", declaration.report_path, why)


def _base(declaration: DataTypeDeclaration) -> str:
    return kept(declaration.extension_data).get("extends", "").strip().casefold()


def _forget_base(declaration: DataTypeDeclaration) -> None:
    texts = kept(declaration.extension_data)
    del texts["extends"]
    declaration.extension_data = with_kept(declaration.extension_data, texts)
    declaration.declaration = None
