"""Declarations as text: which of them no longer say what is declared.

CODESYS and TwinCAT exports may hold a declaration twice, as elements and as the text that was typed. After an edit of
the elements the text would contradict them, so it is left out; the tools then build it anew from the elements.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.model.base import Element
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.model.variables import Interface, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome

_Declared = Interface | DataTypeDeclaration | VariableSection


def drop_stale(project: Project, baseline: Project, report: ConversionReport) -> frozenset[int]:
    """The objects (by `id()`) whose text was typed for what `baseline` declares; each is in the report."""
    before = dict(_declared(baseline))
    stale: set[int] = set()
    for path, thing in _declared(project):
        old = before.get(path)
        if old is None or thing.declaration is None or thing.declaration != old.declaration:
            continue
        if _content(thing) != _content(old):
            stale.add(id(thing))
            why = "it no longer says what is declared; the tool builds it anew, without pragmas and comments between"
            report.add(Outcome.APPROXIMATED, "declaration text", path, why)
    return frozenset(stale)


def _content(thing: Element) -> dict[str, object]:
    return {name: value for name, value in vars(thing).items() if name != "declaration"}


def _declared(project: Project) -> Iterator[tuple[str, _Declared]]:
    for pou in project.pous:
        if pou.interface is not None:
            yield f"POU {pou.name}", pou.interface
        for method in pou.methods:
            if method.interface is not None:
                yield f"POU {pou.name} / method {method.name}", method.interface
    for declaration in project.data_types:
        yield f"type {declaration.name}", declaration
    lists = list(project.global_variables)
    for configuration in project.configurations:
        lists += configuration.global_variables
    for resource in (*project.applications, *(r for c in project.configurations for r in c.resources)):
        lists += resource.global_variables
    for section in lists:
        yield f"global variables {section.name}", section
