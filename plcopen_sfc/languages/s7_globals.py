"""Global variables as S7 has them: a named list is a data block, others are tags and constants of a table.

Named lists are those of CODESYS, whose variables texts name with their list: they stand in an application, or are
objects of a project. In a configuration of IEC 61131-3 the names of lists say nothing. A global variable without a
list, an address and a value that never changes has no counterpart: S7 keeps data in blocks.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from plcopen_sfc.languages.binding import Kind, Names
from plcopen_sfc.languages.declarations import write_type
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.s7_types import s7_types
from plcopen_sfc.languages.translation.literal_translation import translated_address
from plcopen_sfc.model.base import Carried, ForeignData
from plcopen_sfc.model.pou import DataBlock
from plcopen_sfc.model.project import Project, Tag, TagTable, TreeNode
from plcopen_sfc.model.types import DerivedType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection

TABLE = "GlobalVariables"


def data_blocks_of(project: Project) -> list[DataBlock]:
    """A data block for each named list of global variables, unless the project has an object of that name.

    Instances of function blocks are left out: global data blocks of S7 have none.
    """
    things = [*project.pous, *project.data_blocks, *project.data_types]
    taken = {thing.name.casefold() for thing in things}
    blocks = {pou.name.casefold() for pou in project.pous}
    found: dict[str, list[VariableSection]] = {}
    for name, section in _lists(project):
        variables = [v.model_copy(update={"address": None}) for v in section.variables if not _is_instance(v, blocks)]
        if name and name.casefold() not in taken and variables:
            sections = found.setdefault(name, [])
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
    """A section as sections with variables that are retained, and with others, in their order."""
    kept = [is_retained(section, variable) for variable in section.variables]
    if section.retain or section.persistent or True not in kept:
        yield section
        return
    for retain, group in groupby(zip(kept, section.variables, strict=True), key=lambda each: each[0]):
        yield section.model_copy(update={"retain": retain, "variables": [variable for _, variable in group]})


def blocks_of_variables(project: Project) -> dict[str, str]:
    """The data block of each variable of a list that texts may name alone, by its name in lower case.

    Names of several lists and of other objects are left out: texts name these with their list.
    """
    found: dict[str, list[str]] = {}
    for block in data_blocks_of(project):
        for variable in block.interface.variables() if block.interface is not None else ():
            found.setdefault(variable.name.casefold(), []).append(block.name)
    others = {
        variable.name.casefold() for name, section in _lists(project) if not name for variable in section.variables
    }
    others |= {thing.name.casefold() for thing in project.objects()}
    return {name: blocks[0] for name, blocks in found.items() if len(blocks) == 1 and name not in others}


def tag_tables_of(project: Project) -> list[TagTable]:
    """A table of the global variables that stand in no list: tags of those with an address, and constants."""
    known = {tag.name.casefold() for table in project.tag_tables for tag in table.tags}
    known |= {constant.name.casefold() for table in project.tag_tables for constant in table.constants}
    table, types = TagTable(name=TABLE), s7_types(project)
    for section in (section for name, section in _lists(project) if not name):
        for variable in (v for v in section.variables if v.name.casefold() not in known):
            address = variable.address and translated_address(variable.address, Dialect.IEC, Dialect.SCL).text
            if address and "*" not in address:
                type_ = write_type(types.type(variable.type), Dialect.SCL)
                table.tags.append(Tag(name=variable.name, type=type_, address=address, comment=variable.comment))
            elif section.constant and variable.initial is not None:
                table.constants.append(variable.model_copy(update={"address": None}))
    return [table] if table.tags or table.constants else []


def left_out(project: Project) -> Iterator[tuple[str, str]]:
    """The global variables of which blocks, tags and constants do not say all, each with what they leave out."""
    blocks = {pou.name.casefold() for pou in project.pous}
    tables = [*project.tag_tables, *tag_tables_of(project)]
    known = {thing.name.casefold() for table in tables for things in (table.tags, table.constants) for thing in things}
    for name, section in _lists(project):
        for variable in section.variables:
            if name and _is_instance(variable, blocks):
                yield f"{name}.{variable.name}", "a global data block has no instances of function blocks"
            elif name and variable.address:
                yield (
                    f"{name}.{variable.name}",
                    f"in a data block it has no address: it is not connected to {variable.address}",
                )
            elif not name and variable.name.casefold() not in known:
                yield (
                    variable.name,
                    "S7 keeps data in blocks: without a list, an address or a constant value it has no place",
                )


def uncalled(project: Project) -> Iterator[tuple[str, str, str]]:
    """What calls programs and connects variables in other tools, and is not written: kind, name, consequence."""
    for resource in project.resources():
        for task in resource.tasks:
            every = f" every {task.interval}" if task.interval else ""
            called = ", ".join(instance.type_name or instance.name for instance in task.instances) or "nothing"
            yield "task", f"task {task.name}", f"it calls {called}{every}; no organization block is written that does"
        for instance in resource.instances:
            why = f"it is an instance of {instance.type_name or instance.name}; no organization block calls it"
            yield "program instance", f"program instance {instance.name}", why
    for configuration in project.configurations:
        why = "S7 has no such section: its variables have no addresses and values by it"
        if configuration.access_variables is not None and configuration.access_variables.variables:
            yield "access variables", configuration.name, why
        if configuration.config_variables is not None and configuration.config_variables.variables:
            yield "config variables", configuration.name, why


def called_actions(project: Project) -> frozenset[int]:
    """The ids (``id``) of the actions that a step has or a program calls, or may call."""
    actions = [action for pou in project.pous for action in pou.actions]
    found: set[int] = set()
    for each in Names(project).occurrences(*(action.name for action in actions)) if actions else ():
        declaration = each.meaning.declaration
        if isinstance(each.text_site.holder, Carried | ForeignData | TreeNode):
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
    """All lists of global variables, each with the name that texts name its variables with."""
    for section in (*project.global_variables, *(s for a in project.applications for s in a.global_variables)):
        yield section.name or "", section
    sections = [s for c in project.configurations for s in c.global_variables]
    sections += [s for c in project.configurations for resource in c.resources for s in resource.global_variables]
    for section in sections:
        yield section.name if section.name and section.object_id is not None else "", section


def _is_instance(variable: Variable, blocks: set[str]) -> bool:
    return isinstance(variable.type, DerivedType) and variable.type.name.casefold() in blocks
