"""POUs that another one may call, and the variables that the rest of the project writes."""

from __future__ import annotations

from collections.abc import Iterator, Set

from plcopen_sfc.languages.binding.bound_bodies import bind, names_in
from plcopen_sfc.languages.declarations.kept_texts import inheritance
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DerivedType, used_types
from plcopen_sfc.model.variables import SectionKind


def reached_pous(pou: Pou, names: Set[str], project: Project) -> Iterator[tuple[Pou, set[str]]]:
    """Yield a POU with some `names` in it (lower case), then all that it may call by these, with the names in them.

    Without the variables that a called POU has of its own. Types of variables that are named tell the blocks.
    """
    pous = {each.name.casefold(): each for each in project.pous}
    types = {declared.name.casefold(): declared.type for declared in project.data_types}
    instances = {b.name.casefold(): DerivedType(name=b.type_name) for b in project.data_blocks if b.type_name}
    global_ = [variable for section in project.global_sections() for variable in section.variables]
    waiting = [(pou, set(names))]
    seen, family = {pou.name.casefold()}, {pou.name.casefold()}
    while waiting:
        at, named = waiting.pop()
        bases = {base.casefold() for base in inheritance(at.interface).extends}
        family |= bases if at.name.casefold() in family else set()
        sections = at.interface.sections if at.interface is not None and at.name.casefold() not in family else []
        own = {v.name.casefold() for each in sections if each.kind is not SectionKind.EXTERNAL for v in each.variables}
        yield at, named - own
        kinds = [v.type for v in (*at.variables(), *global_) if v.name.casefold() in named]
        kinds += [kind for name, kind in instances.items() if name in named]
        of_types: set[str] = set()  # a variable may have the name of its type
        while kinds:
            new = {name.casefold() for name in used_types(kinds.pop())} - of_types
            of_types |= new
            kinds += [types[name] for name in new & types.keys()]
        called = (named | bases | of_types) & pous.keys() - seen
        seen |= called
        waiting += [(pous[each], set(names_in(pous[each], project.dialect))) for each in called]


def written_elsewhere(pou: Pou, project: Project) -> frozenset[str]:
    """Return what the code of a project writes that a POU does not call: global variables, and those of the POU.

    As paths in lower case, such as ``start`` or ``drive.start``, without lists of global variables and indices.
    """
    reached = {each.name.casefold() for each, _ in reached_pous(pou, names_in(pou, project.dialect), project)}
    others = [each for each in project.pous if each.name.casefold() not in reached]
    if not others:
        return frozenset()
    lists = {section.name.casefold() for section in project.global_sections() if section.name}
    shared = {variable.name.casefold() for section in project.global_sections() for variable in section.variables}
    shared |= {block.name.casefold() for block in project.data_blocks}
    found: set[str] = set()
    for other in others:
        own = {v.name.casefold() for v in other.variables()}
        own -= {v.name.casefold() for v in other.variables(SectionKind.EXTERNAL)}
        for _, _, body in other.named_bodies():
            for path in bind(body, project.dialect).effects.writes:
                inner = path[1:] if path[:1] and path[0] in lists else path
                if path[:1] == (pou.name.casefold(),):
                    found.add(".".join(path[1:]))
                elif inner and inner[0] in shared and (inner is not path or inner[0] not in own):
                    found.add(".".join(inner))
    return frozenset(found - {""})
