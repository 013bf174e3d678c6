"""Declarations that the charts of a project need to be run beside those of another: missing types, and inputs.

Structures are in the place of types that no file of a project declares.

An export of single blocks lacks the types that other files declare. What the blocks use of their variables tells the
members: the simulator takes each such name for a variable of the type that its first use asks for. As a structure, the
variable can also be passed to the functions that a conversion makes of actions.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from copy import deepcopy

from plcopen_sfc.errors import SfcError
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataTypeDeclaration, DerivedType, StructType, Variable
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.semantics.simulation import Simulation
from plcopen_sfc.semantics.subjects import resolve

_Members = dict[str, "str | _Members"]
"""Members by name: the name of an elementary type, or the members of a structure."""


def assumed_types(project: Project, names: Collection[str]) -> list[DataTypeDeclaration]:
    """Return structures for types that `project` does not declare, with the members that its blocks use.

    `names` are those of the types, in lower case. A type is left out where an element of an array is used of it, or a
    member both as a whole and with members: it is not known well enough then.
    """
    found: dict[str, _Members] = {}
    spelled: dict[str, str] = {}
    unfit: set[str] = set()
    for pou in project.pous:
        typed = [(v.name.casefold(), v.type.name) for v in pou.variables() if isinstance(v.type, DerivedType)]
        kinds = {name: spelled.setdefault(kind.casefold(), kind) for name, kind in typed if kind.casefold() in names}
        for kind in kinds.values():
            found.setdefault(kind, {})
        for path, type_name in _used_of(project, pou.name) if kinds else ():
            owner, _, rest = path.partition(".")
            variable, _, member = rest.partition(".")
            if owner.casefold() != pou.name.casefold() or variable.casefold() not in kinds or not member:
                continue
            kind = kinds[variable.casefold()]
            if not re.fullmatch(r"\w+(\.\w+)*", member) or not _put(found[kind], member, type_name):
                unfit.add(kind)
    return [
        DataTypeDeclaration(name=kind, type=_structure(members)) for kind, members in found.items() if kind not in unfit
    ]


def with_types(project: Project, types: list[DataTypeDeclaration]) -> Project:
    """Return a copy of a project that declares `types`, too."""
    copied = deepcopy(project)
    copied.data_types += deepcopy(types)
    return copied


def with_inputs(project: Project, names: Mapping[str, Collection[str]]) -> Project:
    """Return a project in which local variables are inputs: their names by those of the POUs."""
    if not names:
        return project
    copied = deepcopy(project)
    for pou in copied.pous:
        inputs = names.get(pou.name, ())
        if inputs and pou.interface is not None:
            moved = [variable for variable in pou.variables(SectionKind.LOCAL) if variable.name in inputs]
            for section in pou.interface.sections:
                section.variables = [each for each in section.variables if each not in moved]
            pou.interface.sections.append(VariableSection(kind=SectionKind.INPUT, variables=moved))
    return copied


def _used_of(project: Project, pou: str) -> Iterator[tuple[str, str]]:
    """Yield the names that a POU uses without a declaration: paths, and the types that were guessed."""
    try:
        run = Simulation(resolve(project, pou))
    except SfcError:
        return
    yield from run.undeclared.items()


def _put(members: _Members, path: str, type_name: str) -> bool:
    """Add a member; False where it is a structure and a simple value at once."""
    name, _, rest = path.partition(".")
    name = next((each for each in members if each.casefold() == name.casefold()), name)
    if not rest:
        return members.setdefault(name, type_name) == type_name
    inner = members.setdefault(name, {})
    return isinstance(inner, dict) and _put(inner, rest, type_name)


def _structure(members: _Members) -> StructType:
    made: list[Variable] = []
    for name, kind in members.items():
        made.append(Variable(name=name, type=_structure(kind)) if isinstance(kind, dict) else _variable(name, kind))
    return StructType(members=made or [_variable("unused", "BOOL")])


def _variable(name: str, type_name: str) -> Variable:
    return Variable.model_validate({"name": name, "type": type_name})
