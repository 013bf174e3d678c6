"""Variables of GRAFCETs as program text can declare them.

Names in drawings begin with digits (``1B1``), which no tool but TIA Portal has: others get ``_1B1``. Inputs and outputs
of a drawing have addresses; in a program of IEC 61131-3 what has an address is a variable of its own (ed. 3, 6.5.5), in
S7 a tag.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.languages.binding import Declaration
from plcopen_sfc.languages.declarations import write_type
from plcopen_sfc.languages.grafcet_conditions import is_operand
from plcopen_sfc.languages.translation.literal_translation import international_address, translated_address
from plcopen_sfc.languages.words import free_name, identifier, is_plain
from plcopen_sfc.lowering.code.lowered_code import names_of
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project, Tag, TagTable
from plcopen_sfc.model.variables import SectionKind, VariableSection, sections_of
from plcopen_sfc.refactor.rename import rename_many
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.profile import default_profile

_DRAWN = (SectionKind.INPUT, SectionKind.OUTPUT)


def with_declarable_variables(project: Project, kind: Format) -> tuple[Project, ConversionReport]:
    """Return `project` with variables as tools of the format `kind` declare them, and what was changed in the copy.

    The project itself where there is nothing to change: it has no GRAFCETs, or no tool executes the format.
    """
    report = ConversionReport()
    if not kind.tool or not default_profile(project).grafcet_terms:
        return project, report
    for pou in project.pous:
        for variable in pou.variables():
            if not is_operand(variable.name):
                why = f"a condition does not read {variable.name!r} as one name"
                report.add(Outcome.NOT_EXECUTED, "name", f"{pou.report_path} / {variable.name}", why)
    table: dict[str | Declaration, str] = {}
    if kind.dialect is not Dialect.SCL:
        table |= _legal_names(project)
    if not table and not any(any(_located(pou)) for pou in project.pous):
        return project, report
    copy = project.model_copy(deep=True)
    rename_many(copy, table)
    for path, new in table.items():
        around, _, name = str(path).rpartition(".")
        why = f"`{new}` in {kind.tool}: a name begins with no digit"
        report.add(Outcome.TRANSLATED, "name", f"POU {around} / {name}" if around else f"POU {name}", why)
    for pou in copy.pous:
        for variable in (each for section in _located(pou) for each in section.variables):
            address = international_address(variable.address or "")
            if variable.address and address != variable.address:
                why = f"`{address}`: E and A are inputs and outputs of S7 in German"
                report.add(Outcome.TRANSLATED, "address", f"{pou.report_path} / {variable.name}", why)
                variable.address = address
        for name in _place(copy, pou, as_tags=kind.dialect is Dialect.SCL):
            what = "a tag" if kind.dialect is Dialect.SCL else "a variable of its own"
            why = f"what has an address is {what}, and no parameter"
            report.add(Outcome.TRANSLATED, "variable", f"{pou.report_path} / {name}", why)
    return copy, report


def _legal_names(project: Project) -> Iterator[tuple[str, str]]:
    """Yield the path and the new name of everything whose name begins with a digit."""
    taken = {thing.name.casefold() for thing in project.objects()} | names_of(project)
    for pou in project.pous:
        taken |= {variable.name.casefold() for variable in pou.variables()}
        taken |= {step.name.casefold() for chart in project.charts() if chart.pou is pou for step in chart.chart.steps}
    for pou in project.pous:
        named = [
            (pou.name, pou.name),
            *((variable.name, f"{pou.name}.{variable.name}") for variable in pou.variables()),
        ]
        for name, path in named:
            if not is_plain(name):
                yield path, free_name(identifier(name), taken)


def _located(pou: Pou) -> Iterator[VariableSection]:
    """Yield the sections with inputs and outputs that have an address."""
    for section in sections_of(pou.interface):
        if section.kind in _DRAWN and any(variable.address for variable in section.variables):
            yield section


def _place(project: Project, pou: Pou, *, as_tags: bool) -> Iterator[str]:
    """Declare inputs and outputs with an address as tags, or as variables of the POU; yield their names."""
    found = []
    for section in list(_located(pou)):
        found += [variable for variable in section.variables if variable.address]
        section.variables = [variable for variable in section.variables if not variable.address]
    if not found or pou.interface is None:
        return
    if as_tags:
        tags = [
            Tag(
                name=v.name,
                type=write_type(v.type, Dialect.SCL),
                address=translated_address(v.address or "", project.dialect, Dialect.SCL).text,
                comment=v.comment,
            )
            for v in found
        ]
        project.tag_tables.append(TagTable(name=f"{pou.name}_IO", tags=tags))
    else:
        pou.interface.sections.append(VariableSection(kind=SectionKind.LOCAL, variables=found))
    pou.interface.sections = [section for section in pou.interface.sections if section.variables]
    yield from (variable.name for variable in found)
