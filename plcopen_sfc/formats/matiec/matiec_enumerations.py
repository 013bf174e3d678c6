"""Enumerations whose values have numbers of their own, as matiec has them: it numbers all from 0.

The type is one of numbers, and numbers take the places of its values: ``State := 99;`` for ``State := E_State.Fault;``.
"""

from __future__ import annotations

import re

from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.binding.text_sites import TextSite
from plcopen_sfc.languages.s7_types import Constant, constants_of
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataTypeDeclaration, Elementary, ElementaryType, EnumType, SimpleValue
from plcopen_sfc.report import ConversionReport, Outcome

_QUALIFIER = re.compile(r"\w+\s*[.#]\s*\Z")


def number_enumerations(project: Project, report: ConversionReport) -> None:
    """Change enumerations of `project`, a copy, that do not count from 0 into types of numbers."""
    numbered = [(each, found) for each in project.data_types if (found := _numbers(each))]
    numbers = {
        id(value): constant.number
        for declaration, found in numbered
        if isinstance(declaration.type, EnumType)
        for value, constant in zip(declaration.type.values, found, strict=True)
    }
    words = {constant.value for _, found in numbered for constant in found}
    edits: dict[tuple[int, str | int], tuple[TextSite, list[Edit]]] = {}
    for occurrence in Names(project).occurrences(*words) if words else ():
        declared, text_site = occurrence.meaning.declaration, occurrence.text_site
        number = numbers.get(id(declared.holder)) if declared is not None else None
        if number is not None:
            start, end = occurrence.reference.span
            qualifier = _QUALIFIER.search(text_site.text[:start])
            edit = Edit(qualifier.start() if qualifier is not None else start, end, str(number))
            edits.setdefault((id(text_site.holder), text_site.key), (text_site, []))[1].append(edit)
    for text_site, changes in edits.values():
        text_site.put(apply_edits(text_site.text, sorted(changes, key=lambda edit: edit.start)))
    for declaration, constants in numbered:
        if declaration.initial is None:
            declaration.initial = SimpleValue(text=str(constants[0].number))
        base = declaration.type.base if isinstance(declaration.type, EnumType) else None
        declaration.type = base or ElementaryType(name=Elementary.INT)
        why = "a type of numbers, which take the places of its values: matiec numbers enumerations from 0"
        report.add(Outcome.TRANSLATED, "enumeration", f"data type {declaration.name}", why)


def _numbers(declaration: DataTypeDeclaration) -> list[Constant]:
    """Return the values of an enumeration that does not count from 0; none for others."""
    found = constants_of(declaration)
    return found if any(each.number != number for number, each in enumerate(found)) else []
