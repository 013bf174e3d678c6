"""What a POU needs of its project, compared with what has the same names in another project."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

from plcopen_sfc.languages.binding import Declaration, Kind, Names, bind, names_in
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project, Tag, TagTable
from plcopen_sfc.model.types import DataTypeDeclaration, Variable
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.operations import provided

_OF_THE_PLANT = frozenset({"start value", "retain", "persistent"})
"""What each project has its own of, for a global variable that is no constant."""
_FOR_PEOPLE = frozenset({"comment", "title"})

_Thing = Pou | DataTypeDeclaration | Variable | Tag


def declarations_in(names: Names, pou: Pou) -> list[Declaration | None]:
    """Return what each name in the texts of a POU means, in the order of the texts."""
    found = (each.meaning.declaration for each in names.everything if each.text_site.site.pou is pou)
    return [names.resolver.original(each) if each is not None else None for each in found]


def other_meanings(
    here: Names, there: Names, pou: Pou, pairs: Mapping[Declaration, Declaration], chosen: Collection[Declaration]
) -> list[str]:
    """Return why what has the same names in the project of `there` is something else, in words.

    `pairs` are declarations of both projects that `pou` uses. Types, function blocks and functions are compared with
    all that they use themselves; global variables without their start values, unless they are constants. Of the
    variables `chosen` by the user only the types are compared.
    """
    called = _called(pou, here)
    waiting: list[tuple[Declaration, Declaration | None]] = [*pairs.items()]
    things: dict[int, tuple[_Thing, _Thing]] = {}
    reasons: list[str] = []
    seen = {id(pou)}
    while waiting:
        was, now = waiting.pop()
        thing = _thing(here, was, called)
        if thing is None or id(thing) in seen:
            continue
        seen.add(id(thing))
        other = _thing(there, now, called) if now is not None else None
        if other is None:
            reasons.append(f"the project has no {was}")
            continue
        things[id(thing)] = thing, other
        if isinstance(thing, Pou):
            called |= _called(thing, here)
        waiting += [(each, _counterpart(there, each)) for each in _needed(here, thing) if each.pou is not thing]
    left, right = ([pair[side] for pair in things.values()] for side in (0, 1))
    names = {each.holder.name for each in chosen}
    own = {f"global variable {each.name}": _own(here.project, each, is_chosen=each.name in names) for each in left}
    for change in provided("diff")(_project(here.project, left), _project(there.project, right)).changes:
        if change.kind != "layout" and change.aspect not in _FOR_PEOPLE | own.get(change.path, frozenset()):
            reasons.append(f"the project has another {change.place}: {change.news}")
    return reasons


def _own(project: Project, thing: _Thing, *, is_chosen: bool) -> frozenset[str]:
    """Return the aspects of a variable that may differ between projects."""
    if is_chosen:
        return _OF_THE_PLANT | {"address"}
    return frozenset() if _section(project, thing).constant else _OF_THE_PLANT


def _called(pou: Pou, names: Names) -> set[str]:
    """Return the first names of what a POU calls, in lower case."""
    bodies = (body for _, _, body in pou.named_bodies())
    return {path[0] for body in bodies for path in bind(body, names.dialect).effects.calls if path}


def _thing(names: Names, declaration: Declaration, called: set[str]) -> _Thing | None:
    """Return what is compared for a declaration: all of a POU or type, a variable alone; None for nothing of its own.

    Of a program that is not called only the variables count that are named.
    """
    holder, pou = declaration.holder, declaration.pou
    if isinstance(holder, Pou):
        pou = holder
    if pou is not None and (
        pou.kind is not PouKind.PROGRAM or pou.name.casefold() in called or declaration.kind is Kind.ACTION
    ):
        return pou
    if isinstance(holder, DataTypeDeclaration):
        return holder
    if declaration.kind in (Kind.MEMBER, Kind.ENUM_VALUE):
        owners = (each.holder for each in names.find(declaration.path.partition(".")[0]))
        return next((each for each in owners if isinstance(each, DataTypeDeclaration)), None)
    return holder if declaration.kind is Kind.VARIABLE and isinstance(holder, Variable | Tag) else None


def _counterpart(there: Names, declaration: Declaration) -> Declaration | None:
    found = (each for each in there.find(declaration.path) if each.kind is declaration.kind)
    return next(map(there.resolver.original, found), None)


def _needed(names: Names, thing: _Thing) -> Iterator[Declaration]:
    """Yield what something uses of its project."""
    if isinstance(thing, Pou):
        yield from filter(None, declarations_in(names, thing))
        return
    for word in names_in(thing, names.dialect):
        yield from (each for each in names.find(word) if each.holder is not thing)


def _section(project: Project, thing: _Thing) -> VariableSection:
    """Return the section of a variable; an empty one for anything else."""
    if any(each is thing for table in project.tag_tables for each in table.constants):
        return VariableSection(constant=True)
    sections = [*project.global_sections()]
    sections += [each for pou in project.pous if pou.interface is not None for each in pou.interface.sections]
    own = (section for section in sections if any(each is thing for each in section.variables))
    return next(own, VariableSection())


def _project(project: Project, things: Iterable[_Thing]) -> Project:
    """Return a project of copies of things alone."""
    part = Project(dialect=project.dialect)
    for thing in things:
        copy = thing.model_copy(deep=True)
        if isinstance(copy, Pou):
            part.pous.append(copy)
        elif isinstance(copy, DataTypeDeclaration):
            part.data_types.append(copy)
        elif isinstance(copy, Tag):
            part.tag_tables.append(TagTable(name="", tags=[copy]))
        else:
            own = _section(project, thing)
            section = VariableSection(kind=SectionKind.GLOBAL, constant=own.constant, variables=[copy])
            part.global_variables.append(section)
    for pou in part.pous:
        pou.place = ""
    for type_ in part.data_types:
        type_.place = ""
    return part
