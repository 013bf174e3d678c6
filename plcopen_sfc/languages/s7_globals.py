"""Global variables as S7 has them: a named list is a data block, others are tags and constants of a table.

A global variable without a list, an address and a value that never changes has no counterpart: S7 keeps data in blocks.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.languages.declarations import write_type
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.translation.addresses import translated_address
from plcopen_sfc.model.pou import DataBlock
from plcopen_sfc.model.project import Project, Tag, TagTable
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
    found: dict[str, list[Variable]] = {}
    for section in _lists(project):
        if section.name and section.name.casefold() not in taken:
            variables = [v for v in section.variables if not _is_instance(v, blocks)]
            found.setdefault(section.name, []).extend(v.model_copy(update={"address": None}) for v in variables)
    return [
        DataBlock(
            name=name,
            interface=Interface(sections=[VariableSection(kind=SectionKind.LOCAL, variables=variables)]),
        )
        for name, variables in found.items()
        if variables
    ]


def tag_tables_of(project: Project) -> list[TagTable]:
    """A table of the global variables that stand in no list: tags of those with an address, and constants."""
    known = {tag.name.casefold() for table in project.tag_tables for tag in table.tags}
    known |= {constant.name.casefold() for table in project.tag_tables for constant in table.constants}
    table = TagTable(name=TABLE)
    for section in (section for section in _lists(project) if not section.name):
        for variable in (v for v in section.variables if v.name.casefold() not in known):
            address = variable.address and translated_address(variable.address, Dialect.IEC, Dialect.SCL).text
            if address and "*" not in address:
                type_ = write_type(variable.type, Dialect.SCL)
                table.tags.append(Tag(name=variable.name, type=type_, address=address, comment=variable.comment))
            elif section.constant and variable.initial is not None:
                table.constants.append(variable.model_copy(update={"address": None}))
    return [table] if table.tags or table.constants else []


def left_out(project: Project) -> Iterator[tuple[str, str]]:
    """The global variables of which blocks, tags and constants do not say all, each with what they leave out."""
    blocks = {pou.name.casefold() for pou in project.pous}
    tables = [*project.tag_tables, *tag_tables_of(project)]
    known = {thing.name.casefold() for table in tables for things in (table.tags, table.constants) for thing in things}
    for section in _lists(project):
        for variable in section.variables:
            if section.name and _is_instance(variable, blocks):
                yield f"{section.name}.{variable.name}", "a global data block has no instances of function blocks"
            elif section.name and variable.address:
                yield f"{section.name}.{variable.name}", f"in a data block it has no address: {variable.address}"
            elif not section.name and variable.name.casefold() not in known:
                yield (
                    variable.name,
                    "S7 keeps data in blocks: without a list, an address or a constant value it has no place",
                )


def _lists(project: Project) -> Iterator[VariableSection]:
    yield from project.global_variables
    for configuration in project.configurations:
        yield from configuration.global_variables
        for resource in configuration.resources:
            yield from resource.global_variables
    for application in project.applications:
        yield from application.global_variables


def _is_instance(variable: Variable, blocks: set[str]) -> bool:
    return isinstance(variable.type, DerivedType) and variable.type.name.casefold() in blocks
