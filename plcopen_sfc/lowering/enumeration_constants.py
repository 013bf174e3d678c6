"""Values of enumerations as constants of the blocks that name them: a source of SCL declares no user constants."""

from __future__ import annotations

import re
from collections.abc import Iterable

from plcopen_sfc.languages.binding import Kind, Names
from plcopen_sfc.languages.s7_types import Constant, S7Types, s7_types
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.words import free_name
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DerivedType, SimpleValue, StructType, Variable
from plcopen_sfc.model.variables import SectionKind, VariableSection


def with_enumeration_constants(project: Project) -> Project:
    """Return `project` as blocks of S7 without enumerations: their values are constants, their variables numbers.

    The project itself where it has none, and where charts are left in it: these keep their types.
    """
    types = s7_types(project)
    if project.dialect is Dialect.SCL or not types.constants or any(True for _ in project.charts()):
        return project
    copy = project.model_copy(deep=True)
    _name_constants(copy, types)
    for pou in copy.pous:
        if pou.interface is not None:
            pou.interface.declaration = None
            _as_numbers(pou.interface.variables(), types)
            if pou.interface.return_type is not None:
                pou.interface.return_type = types.type(pou.interface.return_type)
    for section in copy.global_sections():
        section.declaration = None
        _as_numbers(section.variables, types)
    copy.data_types = [each for each in copy.data_types if isinstance(each.type, StructType)]
    for each in copy.data_types:
        if isinstance(each.type, StructType):
            _as_numbers(each.type.members, types)
    return copy


def _as_numbers(variables: Iterable[Variable], types: S7Types) -> None:
    for variable in variables:
        variable.initial, variable.type = types.start(variable), types.type(variable.type)
        if isinstance(variable.type, StructType):
            _as_numbers(variable.type.members, types)


def _name_constants(project: Project, types: S7Types) -> None:
    """Put constants in the place of the values in texts, and declare them in the blocks of these texts."""
    known = {f"{each.type}.{each.value}".casefold(): each for each in types.constants}
    edits: dict[int, tuple[StBody, list[Edit]]] = {}
    declared: dict[int, dict[str, Variable]] = {}
    for each in Names(project).occurrences(*(constant.value for constant in types.constants)):
        found, body, pou = each.meaning.declaration, each.text_site.holder, each.text_site.site.pou
        if found is None or found.kind is not Kind.ENUM_VALUE or not isinstance(body, StBody) or pou is None:
            continue
        constant = known.get(found.path.casefold())
        if constant is None:
            continue
        own = declared.setdefault(id(pou), {})
        if constant.name not in own:
            own[constant.name] = _constant(constant, pou, types)
        start, end = each.reference.span
        typed = re.search(rf"\b{re.escape(constant.type)}\s*[.#]\s*$", body.text[:start], re.IGNORECASE)
        edit = Edit(typed.start() if typed is not None else start, end, own[constant.name].name)
        edits.setdefault(id(body), (body, []))[1].append(edit)
    for body, found_edits in edits.values():
        body.text, body.markup = apply_edits(body.text, found_edits), None
    for pou in project.pous:
        if id(pou) in declared and pou.interface is not None:
            constants = list(declared[id(pou)].values())
            pou.interface.sections.append(VariableSection(kind=SectionKind.LOCAL, constant=True, variables=constants))


def _constant(constant: Constant, pou: Pou, types: S7Types) -> Variable:
    taken = {variable.name.casefold() for variable in pou.variables()}
    kind = types.type(DerivedType(name=constant.type))
    return Variable(name=free_name(constant.name, taken), type=kind, initial=SimpleValue(text=str(constant.number)))
