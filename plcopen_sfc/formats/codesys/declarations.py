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
    before, after = _by_path(baseline), _by_path(project)
    stale: set[int] = set()
    for path, things in after.items():
        thing, old = things[0], before.get(path)
        if old is None or thing.declaration is None or thing.declaration != old[0].declaration:
            continue
        if list(map(_content, things)) != list(map(_content, old)):
            stale.add(id(thing))
            why = "it no longer says what is declared; the tool builds it anew, without pragmas and comments between"
            report.add(Outcome.APPROXIMATED, "declaration text", path, why)
    return frozenset(stale)


def _by_path(project: Project) -> dict[str, list[_Declared]]:
    """What is declared by its path; a list of global variables may have several sections, and its text at the first."""
    found: dict[str, list[_Declared]] = {}
    for path, thing in _declared(project):
        found.setdefault(path, []).append(thing)
    return found


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
    for section in project.global_sections():
        yield f"global variables {section.name}", section
