"""Initial values of strings: Beremiz and OpenPLC write them without quotes in their files."""

from __future__ import annotations

from collections.abc import Container, Iterator

from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import SimpleValue, StringType, StructType, Variable


def variable_names(project: Project) -> Iterator[str]:
    """The names of all variables of a project, in lower case."""
    for section in project.global_sections():
        yield from (variable.name.casefold() for variable in section.variables)
    for pou in project.pous:
        yield from (variable.name.casefold() for variable in pou.variables())


def with_quotes(variable: Variable, names: Container[str]) -> Variable:
    """The variable with its value as a literal, if it is a string; a value of `names` is that of a constant."""
    value = variable.initial
    if not isinstance(variable.type, StringType) or not isinstance(value, SimpleValue) or value.text is None:
        return variable
    quote = '"' if variable.type.wide else "'"
    text = value.text.strip()
    if text[:1] in ("'", '"') or "#" in text or text.casefold() in names:
        return variable
    inner = text.replace("$", "$$").replace(quote, f"${quote}")
    return variable.model_copy(update={"initial": SimpleValue(text=f"{quote}{inner}{quote}")})


def quote_strings(project: Project) -> None:
    """Put the values of all string variables of POUs and structures in quotes."""
    names = frozenset(variable_names(project))
    lists = [pou.interface.sections for pou in project.pous if pou.interface is not None]
    for section in (section for sections in lists for section in sections):
        section.variables = [with_quotes(variable, names) for variable in section.variables]
    for declaration in project.data_types:
        if isinstance(declaration.type, StructType):
            declaration.type.members = [with_quotes(member, names) for member in declaration.type.members]
