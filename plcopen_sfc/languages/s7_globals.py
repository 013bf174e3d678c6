"""Global variables as S7 has them: a named list is a data block, others are tags and constants of a table.

Named lists are those of CODESYS, whose variables texts name with their list: they belong to an application, or are
objects of a project. In a configuration of IEC 61131-3 the names of lists mean nothing. The variables of a list that
have an address are tags, in a table with the name of the list: S7 has no addresses in optimised data blocks. A global
variable without a list, an address and a value that never changes is in a data block for all of these.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from itertools import groupby

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.binding import Kind, Names
from plcopen_sfc.languages.binding.text_sites import TextSite
from plcopen_sfc.languages.declarations import read_declarations, write_type
from plcopen_sfc.languages.s7_types import S7Types, s7_types
from plcopen_sfc.languages.translation.literal_translation import is_tag_address, translated_address
from plcopen_sfc.model.base import ExtensionData, ForeignData
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import DataBlock, PouKind
from plcopen_sfc.model.project import Project, Tag, TagTable, TreeNode
from plcopen_sfc.model.types import DataType, ElementaryType, SimpleValue, StructType, Variable, used_types
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection

TABLE = "GlobalVariables"
"""Name of the tag table and of the data block for what is in no list."""


def data_blocks_of(project: Project) -> list[DataBlock]:
    """Return a data block for each named list of global variables, unless the project has an object of that name.

    Another one has the variables of no list. Instances of function blocks are left out: global data blocks of S7 have
    none. So are tags and constants.
    """
    things = [*project.pous, *project.data_blocks, *project.data_types]
    taken = {thing.name.casefold() for thing in things}
    blocks = {pou.name.casefold() for pou in project.pous}
    tags, known = _tags_of_lists(project), _names_in_tables(project)
    found: dict[str, list[VariableSection]] = {}
    for name, section in _lists(project):
        variables = [
            v.model_copy(update={"address": None})
            for v in section.variables
            if not _is_instance(v, blocks) and (name.casefold(), v.name.casefold()) not in tags
        ]
        if not name:
            variables = [v for v in variables if v.name.casefold() not in known]
        if (name or TABLE).casefold() not in taken and variables:
            sections = found.setdefault(name or TABLE, [])
            retain = section.retain or section.persistent
            if not sections or sections[-1].retain is not retain:
                sections.append(VariableSection(kind=SectionKind.LOCAL, retain=retain))
            sections[-1].variables.extend(variables)
    return [DataBlock(name=name, interface=Interface(sections=sections)) for name, sections in found.items()]


def is_retained(section: VariableSection, variable: Variable) -> bool:
    """True if a variable keeps its value when the power fails."""
    is_remanent = variable.attributes.get("Remanence", "").casefold() == "retain"
    return section.retain or section.persistent or is_remanent


def by_retention(section: VariableSection) -> Iterator[VariableSection]:
    """Yield a section as sections with variables that are retained, and with others, in their order."""
    kept = [is_retained(section, variable) for variable in section.variables]
    if section.retain or section.persistent or True not in kept:
        yield section
        return
    for retain, group in groupby(zip(kept, section.variables, strict=True), key=lambda each: each[0]):
        yield section.model_copy(update={"retain": retain, "variables": [variable for _, variable in group]})


def names_in_s7(project: Project) -> dict[str, tuple[str, ...]]:
    """Return the names by which S7 knows variables of lists, by those that texts of other tools have, in lower case.

    A variable of a data block that a text names alone, ``x``, is named with its block. A tag, ``GVL.x`` or ``x``, is
    named alone. Names of several lists and of other objects are left out: texts name these with their list.
    """
    found: dict[str, list[tuple[str, ...]]] = {}
    for block in data_blocks_of(project):
        for variable in block.interface.variables() if block.interface is not None else ():
            found.setdefault(variable.name.casefold(), []).append((block.name, variable.name))
    tags = [(around, name, tag) for (around, name), tag in _tags_of_lists(project).items()]
    for _, name, tag in tags:
        found.setdefault(name, []).append((tag.name,))
    others = _names_in_tables(project) | {thing.name.casefold() for thing in project.objects()}
    names = {name: paths[0] for name, paths in found.items() if len(paths) == 1 and name not in others}
    for around, local in local_tags(project).items():
        tags += [(around, name, tag) for name, tag in local.items()]
    for around, name, tag in tags:
        names[f"{around}.{name}"] = (tag.name,)
    return names


def names_from_s7(project: Project) -> dict[str, tuple[str, ...]]:
    """The names of tags, and of variables in no list, in other tools, by those that they have in S7, in lower case."""
    lists = {name.casefold(): name for name, _ in _lists(project)}
    found: dict[str, tuple[str, ...]] = {}
    for (around, _), tag in _tags_of_lists(project).items():
        found[tag.name.casefold()] = (lists[around], tag.name)
    for block in data_blocks_of(project):
        unlisted = block.interface if block.name == TABLE else None
        for variable in unlisted.variables() if unlisted is not None else ():
            found[f"{TABLE}.{variable.name}".casefold()] = (variable.name,)
    tags = local_tags(project)
    for pou in project.pous:
        names = {variable.name.casefold(): variable.name for variable in pou.variables()}
        local = tags.get(pou.name.casefold(), {})
        for name, tag in local.items():
            found[tag.name.casefold()] = (pou.name, names[name])
    return found


def _tags_of_lists(project: Project) -> dict[tuple[str, str], Tag | Variable]:
    """Return the tags and user constants that variables of named lists become, by the names of both in lower case.

    A tag has an address that S7 knows; a constant has a value. Both have an elementary type and a name that no other
    global thing has: S7 names them without their list.
    """
    counts, types = Counter(global_names(project)), s7_types(project)
    found: dict[tuple[str, str], Tag | Variable] = {}
    for name, section in _lists(project):
        for variable in section.variables if name else ():
            key = name.casefold(), variable.name.casefold()
            if counts[key[1]] > 1 or not _is_plain(variable, types):
                continue
            tag = _tag(variable, types, project.address_dialect)
            if tag is not None:
                found[key] = tag
            elif section.constant and not variable.address and isinstance(variable.initial, SimpleValue):
                found[key] = variable
    return found


def local_tags(project: Project) -> dict[str, dict[str, Tag]]:
    """Return the tags that variables with an address become which a POU declares, by its name and theirs in lower case.

    All instances of a POU have them in common. A tag has the name of the variable if nothing global and no other of
    them has it, else that of the POU before it.
    """
    declared = [
        (pou, variable)
        for pou in project.pous
        for variable in (pou.variables(SectionKind.LOCAL) if pou.kind in _WITH_ADDRESSES else ())
        if (variable.address or "").startswith("%")
    ]
    if not declared:
        return {}
    counts, types = Counter(global_names(project)), s7_types(project)
    counts.update(variable.name.casefold() for _, variable in declared)
    found: dict[str, dict[str, Tag]] = {}
    for pou, variable in declared:
        alone = counts[variable.name.casefold()] == 1
        name = variable.name if alone else f"{pou.name}_{variable.name}"
        tag = _tag(variable, types, project.address_dialect)
        if tag is not None and _is_plain(variable, types) and (alone or not counts[name.casefold()]):
            tag.name = name
            found.setdefault(pou.name.casefold(), {})[variable.name.casefold()] = tag
    return found


_WITH_ADDRESSES = (PouKind.PROGRAM, PouKind.FUNCTION_BLOCK)


def global_names(project: Project) -> Iterator[str]:
    """The names of everything global in a project, in lower case: of variables, lists, objects, tags and constants."""
    lists: set[str] = set()
    for name, section in _lists(project):
        lists.add(name.casefold())
        yield from (variable.name.casefold() for variable in section.variables)
    yield from lists
    for thing in project.objects():
        yield thing.name.casefold()
    yield from _names_in(project.tag_tables)


def _names_in(tables: Iterable[TagTable]) -> Iterator[str]:
    """Yield the names of tags and constants, in lower case."""
    for table in tables:
        yield from (tag.name.casefold() for tag in table.tags)
        yield from (constant.name.casefold() for constant in table.constants)


def _is_plain(variable: Variable, types: S7Types) -> bool:
    return isinstance(types.type(variable.type), ElementaryType)


def _tag(variable: Variable, types: S7Types, addresses: Dialect) -> Tag | None:
    """Return the tag for a variable; None where it has no address that S7 can write."""
    if not variable.address or "*" in variable.address:
        return None
    address = translated_address(variable.address, addresses, Dialect.SCL)
    if address.severity is Severity.ERROR or not is_tag_address(address.text):
        return None
    type_ = write_type(types.type(variable.type), Dialect.SCL)
    return Tag(name=variable.name, type=type_, address=address.text, comment=variable.comment)


def _names_in_tables(project: Project) -> set[str]:
    """Return the names, in lower case, of the tags and constants of the project, and of those that others become."""
    return {*_names_in([*project.tag_tables, _unlisted(project)])}


def _unlisted(project: Project) -> TagTable:
    """Return a table with the tags and constants that the variables of no list become."""
    known = {*_names_in(project.tag_tables)}
    table, types = TagTable(name=TABLE), s7_types(project)
    for section in (section for name, section in _lists(project) if not name):
        for variable in (v for v in section.variables if v.name.casefold() not in known):
            tag = _tag(variable, types, project.address_dialect)
            if tag is not None:
                table.tags.append(tag)
            elif section.constant and not variable.address and variable.initial is not None:
                table.constants.append(variable.model_copy(update={"address": None}))
    return table


def tag_tables_of(project: Project) -> list[TagTable]:
    """Tables of the global variables that are no data: a table for each list whose variables have addresses.

    Another one has what is in no list: tags of the variables with an address, and constants.
    """
    table = _unlisted(project)
    tables = {name: TagTable(name=name) for name, _ in _lists(project) if name}
    lists = {name.casefold(): name for name in tables}
    for (around, _), found in _tags_of_lists(project).items():
        if isinstance(found, Tag):
            tables[lists[around]].tags.append(found)
        else:
            tables[lists[around]].constants.append(found)
    for local in local_tags(project).values():
        table.tags += local.values()
    return [each for each in (table, *tables.values()) if each.tags or each.constants]


def left_out(project: Project) -> Iterator[tuple[str, str, str]]:
    """Yield the losses of variables in types, blocks, tags and constants: of what, its name, and what it is."""
    blocks = {pou.name.casefold() for pou in project.pous}
    for declared in project.data_types:
        members = declared.type.members if isinstance(declared.type, StructType) else []
        for member in (each for each in members if _is_instance(each, blocks)):
            where = f"{declared.report_path} / {member.name}"
            yield "member", where, "a PLC data type has no instances of function blocks"
    for place, why in _left_out_globals(project):
        yield "global variable", place, why
    tags = local_tags(project)
    for pou in project.pous:
        local = tags.get(pou.name.casefold(), {})
        for section in pou.interface.sections if local and pou.interface is not None else ():
            for variable in (each for each in section.variables if each.name.casefold() in local):
                for what, why in _not_of_tags(variable, section):
                    yield what, f"{pou.report_path} / {variable.name}", why


def _not_of_tags(variable: Variable, section: VariableSection) -> Iterator[tuple[str, str]]:
    """Yield the losses of a variable in a tag, and why."""
    if variable.initial is not None:
        yield "initial value", "it is a tag, which has no start value: it starts as FALSE or 0"
    if is_retained(section, variable):
        yield "retain", "it is a tag: whether it is retained is set for the memory of the controller"


def _left_out_globals(project: Project) -> Iterator[tuple[str, str]]:
    """Yield the global variables that blocks, tags and constants cannot express completely, each with what is lost."""
    blocks = {pou.name.casefold() for pou in project.pous}
    tables = [*project.tag_tables, *tag_tables_of(project)]
    tags = {tag.name.casefold() for table in tables for tag in table.tags}
    known = {*_names_in(tables)}
    of_lists = _tags_of_lists(project)
    for name, section in _lists(project):
        for variable in section.variables:
            place = f"{name}.{variable.name}" if name else variable.name
            is_tag = not name and variable.name.casefold() in tags
            listed = of_lists.get((name.casefold(), variable.name.casefold()))
            if isinstance(listed, Variable):
                continue
            if is_tag or listed is not None:
                yield from ((place, why) for _, why in _not_of_tags(variable, section))
            elif not name and variable.name.casefold() in known:
                continue
            elif _is_instance(variable, blocks):
                yield place, "a global data block has no instances of function blocks"
            elif variable.address:
                yield place, f"in a data block it has no address: it is not connected to {variable.address}"


def unconnected(project: Project) -> Iterator[tuple[str, str, str]]:
    """Yield connections of variables in configurations of other tools, not written: kind, name, consequence."""
    for configuration in project.configurations:
        why = "S7 has no such section: its variables have no addresses and values by it"
        if configuration.access_variables is not None and configuration.access_variables.variables:
            yield "access variables", configuration.name, why
        if configuration.config_variables is not None and configuration.config_variables.variables:
            yield "config variables", configuration.name, why


def open_address(project: Project, variable: Variable) -> str | None:
    """Return why S7 connects a variable to no more than the source does; None where it has an address there.

    ``AT %I*`` leaves open which input it is. A device in CODESYS, or VAR_CONFIG, has the address of each instance.
    """
    if not (variable.address or "").endswith("*"):
        return None
    sections = [project.config_variables, *(each.config_variables for each in project.configurations)]
    paths = [each.path for section in sections if section is not None for each in section.variables]
    if any(path.rpartition(".")[2].casefold() == variable.name.casefold() for path in paths):
        return None
    return f"the source leaves open which one it is ({variable.address}), and no file says it: connect each instance"


def called_actions(project: Project, is_replaced: Callable[[TextSite], bool] = lambda _: False) -> frozenset[int]:
    """Return the ids (``id``) of the actions that a step has or a program calls, or may call.

    `is_replaced`: True if the calls in a text are written as something else.
    """
    actions = [action for pou in project.pous for action in pou.actions]
    found: set[int] = set()
    for each in Names(project).occurrences(*(action.name for action in actions)) if actions else ():
        declaration = each.meaning.declaration
        if isinstance(each.text_site.holder, ExtensionData | ForeignData | TreeNode) or is_replaced(each.text_site):
            continue
        if declaration is not None and declaration.kind is Kind.ACTION:
            found.add(id(declaration.holder))
        elif declaration is None:
            name = each.reference.name.casefold()
            found.update(id(action) for action in actions if action.name.casefold() == name)
    return frozenset(found)


UNCALLED = "no step has it and no program calls it: nothing executes it in the source either"
"""Why an action that S7 does not have is no loss."""


def _lists(project: Project) -> Iterator[tuple[str, VariableSection]]:
    """Yield all lists of global variables, each with the name that texts name its variables with."""
    for section in (*project.global_variables, *(s for a in project.applications for s in a.global_variables)):
        yield section.name or "", section
    sections = [s for c in project.configurations for s in c.global_variables]
    sections += [s for c in project.configurations for resource in c.resources for s in resource.global_variables]
    # texts name variables with a list of CODESYS, which has an id; the names of other lists are labels in TC6
    for section in sections:
        yield section.name if section.name and section.object_id is not None else "", section


def _is_instance(variable: Variable, blocks: set[str]) -> bool:
    return not blocks.isdisjoint(map(str.casefold, used_types(variable.type)))


def type_named(text: str) -> DataType | None:
    """Return a type as tags name it; None where it is none."""
    section = next(iter(read_declarations(f"VAR x : {text}; END_VAR", Dialect.SCL).sections), None)
    return section.variables[0].type if section is not None and section.variables else None
