"""What a POU sees of its project: the names that mean something in it already."""

from __future__ import annotations

from plcopen_sfc.model.project import Project


def names_of(project: Project) -> set[str]:
    """The names of a project in lower case: of POUs, types, data blocks, tags, global variables and their lists."""
    found = {pou.name for pou in project.pous} | {kind.name for kind in project.data_types}
    found |= {block.name for block in project.data_blocks}
    for table in project.tag_tables:
        found |= {tag.name for tag in table.tags} | {constant.name for constant in table.constants}
    for section in project.global_sections():
        found |= {section.name or "", *(variable.name for variable in section.variables)}
    return {name.casefold() for name in found}
