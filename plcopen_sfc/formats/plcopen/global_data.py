"""Tag tables and data blocks of TIA Portal as global variables of CODESYS and TC6.

A tag becomes a variable at its address, a user constant a constant. A data block becomes what programs name as before:
``DB.x`` is a variable of a list in CODESYS and a member of a structure in TC6, an instance data block is an instance.
An organization block is a program, which a resource of TC6 executes.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.formats.plcopen.host import Host
from plcopen_sfc.formats.plcopen.rewritten import ADDED_FIELD, Marks, added_section
from plcopen_sfc.languages.declarations import read_declarations
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.s7_globals import is_retained
from plcopen_sfc.languages.s7_results import is_void
from plcopen_sfc.languages.standard_blocks import S7_INSTANCES
from plcopen_sfc.languages.start_values import filled
from plcopen_sfc.languages.translation import NameScope, Renames
from plcopen_sfc.languages.translation.addresses import translated_address
from plcopen_sfc.languages.translation.kept import kept_names
from plcopen_sfc.languages.translation.renames import identifier
from plcopen_sfc.model.pou import DataBlock, DataBlockKind, PouKind
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource, TagTable
from plcopen_sfc.model.types import (
    ArrayType,
    DataType,
    DerivedType,
    MemberValue,
    StructType,
    StructValue,
    Variable,
)
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome

_INSTANCES = {own: block for block, own in S7_INSTANCES.items()}
_OF_S7 = frozenset(
    """TIMER COUNTER S5TIME DTL IEC_TIMER IEC_LTIMER IEC_COUNTER IEC_SCOUNTER IEC_DCOUNTER IEC_UCOUNTER IEC_USCOUNTER
    IEC_UDCOUNTER VARIANT DB_ANY ERROR_STRUCT CREF NREF POINTER BLOCK_FB BLOCK_FC BLOCK_DB VOID HW_ANY HW_IO HW_DEVICE
    HW_SUBMODULE OB_ANY PORT RTM CONN_ANY CONDITIONS""".split()
)
"""Data types of S7 that neither CODESYS nor TC6 has."""


def has_globals(project: Project) -> bool:
    """True if a project has tags or data blocks."""
    blocks = any(pou.kind is PouKind.ORGANIZATION_BLOCK for pou in project.pous)
    return blocks or bool(project.tag_tables or project.data_blocks)


def add_globals(project: Project, host: Host, report: ConversionReport, marks: Marks) -> None:
    """Add the global variables that stand for tags and data blocks to `project`, a copy."""
    sections = _Globals(project, host, report).sections()
    for section in sections:
        marks[id(section)] = added_section(section)
    cyclic = _cyclic_blocks(project, host, report)
    if host.is_codesys:
        project.global_variables = [*project.global_variables, *sections]
        return
    if not project.configurations and (sections or cyclic):
        instances = [PouInstance(name=f"{name}_instance", type_name=name) for name in cyclic]
        resource = Resource(name="Resource", instances=instances)
        project.configurations = [Configuration(name="Configuration", resources=[resource])]
        marks[id(project.configurations[0])] = {ADDED_FIELD: [instance.name for instance in instances]}
    if sections:
        target = project.configurations[0]
        target.global_variables = [*target.global_variables, *sections]


def _cyclic_blocks(project: Project, host: Host, report: ConversionReport) -> list[str]:
    """The organization blocks that a resource of TC6 executes in every cycle; the others are in the report."""
    found: list[str] = []
    for pou in project.pous:
        if pou.kind is not PouKind.ORGANIZATION_BLOCK:
            continue
        if pou.number in (None, 1) and not host.is_codesys and not project.configurations:
            found.append(pou.name)
            report.add(Outcome.TRANSLATED, "program", pou.report_path, "a program of the resource")
        else:
            why = f"a program that no task of {host.title} calls: give it one"
            report.add(Outcome.NOT_EXECUTED, "program", pou.report_path, why)
    return found


def report_types(project: Project, host: Host, report: ConversionReport) -> None:
    """Report the variables whose type only S7 has: their declarations do not compile."""
    declared = {thing.name.casefold() for thing in (*project.pous, *project.data_types)}

    def look_at(variables: Iterable[Variable], path: str) -> None:
        for variable in variables:
            foreign = is_foreign_type(variable.type)
            if foreign is not None and foreign.casefold() not in declared:
                why = f"{host.title} has no type {foreign}: the declaration does not compile"
                report.add(Outcome.NOT_EXECUTED, "data type", f"{path} / variable {variable.name}", why)

    for pou in project.pous:
        for section in pou.interface.sections if pou.interface is not None else ():
            if not is_void(section):
                look_at(section.variables, pou.report_path)
    for declaration in project.data_types:
        if isinstance(declaration.type, StructType):
            look_at(declaration.type.members, declaration.report_path)


def is_foreign_type(kind: DataType) -> str | None:
    """The name of a data type of S7 in `kind` that no other tool has; None where there is none."""
    match kind:
        case DerivedType(name=name) if name.strip('"').upper() in _OF_S7:
            return name
        case ArrayType(base=base):
            return is_foreign_type(base)
        case StructType(members=members):
            return next((found for member in members if (found := is_foreign_type(member.type))), None)
        case _:
            return None


@dataclass
class _Globals:
    project: Project
    host: Host
    report: ConversionReport
    names: Renames = field(init=False)
    declared: set[str] = field(init=False)

    def __post_init__(self) -> None:
        self.names = kept_names(self.project)
        things = [*self.project.pous, *self.project.data_types]
        self.declared = {thing.name.casefold() for thing in things}
        self.types = {each.name.casefold(): each.type for each in self.project.data_types}

    def sections(self) -> list[VariableSection]:
        """The lists of variables."""
        found: list[VariableSection] = []
        for table in self.project.tag_tables:
            found += self._table(table)
        instances: list[Variable] = []
        retained: list[Variable] = []
        for block in self.project.data_blocks:
            found += self._block(block, retained if _is_all_retained(block) else instances)
        for variables in (instances, retained):
            if variables:
                found.append(self._list("Instances", variables))
                found[-1].retain = variables is retained
        taken: set[str] = set()
        for section in found:
            section.name = _new_name(section.name or "", taken)
        return found

    def _note(self, outcome: Outcome, what: str, path: str, why: str) -> None:
        self.report.add(outcome, what, path, why)

    def _named(self, name: str) -> str:
        return self.names.new_name(NameScope.GLOBAL, name) or identifier(name)

    def _list(self, name: str, variables: list[Variable]) -> VariableSection:
        return VariableSection(kind=SectionKind.GLOBAL, name=name, variables=variables)

    # -- tags

    def _table(self, table: TagTable) -> list[VariableSection]:
        tags: list[Variable] = []
        counted: list[str] = []
        for tag in table.tags:
            path = f"{table.report_path} / tag {tag.name}"
            kind = _type_of(tag.type)
            address = translated_address(tag.address or "", Dialect.SCL, self.host.dialect)
            if kind is None or is_foreign_type(kind):
                self._note(Outcome.NOT_EXECUTED, "tag", path, f"{self.host.title} has no type {tag.type}")
                continue
            if tag.address and address.severity is Severity.ERROR:
                self._note(Outcome.NOT_EXECUTED, "address", path, f"{address.reason}: the tag is left out")
                continue
            if address.severity is not None:
                counted.append(f"{tag.name} AT {address.text}")
            tags.append(
                Variable(name=self._named(tag.name), type=kind, address=address.text or None, comment=tag.comment)
            )
        constants = [
            Variable(name=self._named(c.name), type=c.type, initial=c.initial, comment=c.comment)
            for c in table.constants
        ]
        if counted:
            why = "the same bytes, where S7 counts bytes and other tools words or double words: "
            self._note(Outcome.TRANSLATED, "address", table.report_path, why + ", ".join(counted))
        self._note(Outcome.TRANSLATED, "tag table", table.report_path, "global variables")
        found = [self._list(identifier(table.name), tags)] if tags else []
        if constants:
            found.append(self._list(f"{identifier(table.name)}_constants", constants))
            found[-1].constant = True
        return found

    # -- data blocks

    def _block(self, block: DataBlock, instances: list[Variable]) -> list[VariableSection]:
        name, path = self._named(block.name), block.report_path
        if block.type_name is not None or block.kind is DataBlockKind.INSTANCE:
            type_name = (block.type_name or "").strip('"')
            type_name = _INSTANCES.get(type_name.upper(), type_name)
            known = type_name.casefold() in self.declared or type_name.upper() in S7_INSTANCES
            if not known:
                why = f"{self.host.title} does not know what it is an instance of: {type_name or 'its type'} is missing"
                self._note(Outcome.NOT_EXECUTED, "data block", path, why)
                return []
            instances.append(self._instance(name, type_name, block))
            self._note(Outcome.TRANSLATED, "data block", path, f"a global instance of {type_name}")
            return []
        variables = block.interface.variables() if block.interface is not None else []
        if not variables or block.kind is not DataBlockKind.GLOBAL:
            self._note(Outcome.NOT_EXECUTED, "data block", path, f"{self.host.title} has no such block")
            return []
        members = [self._member(variable, path) for variable in variables]
        retained = _retained(block)
        if self.host.is_codesys:
            section = self._list(name, members)
            self._note(Outcome.TRANSLATED, "data block", path, f"the list of global variables {name}")
        else:
            initial = _struct_value(members)
            plain = [member.model_copy(update={"initial": None}) for member in members]
            whole = Variable(name=name, type=StructType(members=plain), initial=initial, comment=block.comment)
            section = self._list(f"{name}_data", [whole])
            self._note(Outcome.TRANSLATED, "data block", path, f"the global structure {name}")
            self._note(Outcome.TRANSLATED, "global variables", f"global variables {name}", "members of a structure")
        section.retain = all(retained)
        for variable in variables if section.retain else ():
            place = f"global variable {name}.{variable.name}"
            self._note(Outcome.TRANSLATED, "retain", place, "as in its data block")
        if any(retained) and not all(retained):
            kept = ", ".join(v.name for v, is_kept in zip(variables, retained, strict=True) if is_kept)
            why = f"{kept} would be retained, other variables of the block not: none is"
            self._note(Outcome.NOT_EXECUTED, "retain", path, why)
        return [section]

    def _instance(self, name: str, type_name: str, block: DataBlock) -> Variable:
        """The variable for an instance, with the start values that it has and its type has not."""
        own = next((pou for pou in self.project.pous if pou.name.casefold() == type_name.casefold()), None)
        usual = {v.name.casefold(): v.initial for v in own.variables()} if own is not None else {}
        given = [
            self._member(variable, block.report_path)
            for variable in (block.interface.variables() if block.interface is not None else ())
            if variable.initial is not None and variable.initial != usual.get(variable.name.casefold())
        ]
        type_ = DerivedType(name=self._named(type_name))
        return Variable(name=name, type=type_, initial=_struct_value(given), comment=block.comment)

    def _member(self, variable: Variable, path: str) -> Variable:
        foreign = is_foreign_type(variable.type)
        if foreign is not None:
            why = f"{self.host.title} has no type {foreign}: it does not compile"
            self._note(Outcome.NOT_EXECUTED, "data type", f"{path} / variable {variable.name}", why)
        name = self.names.new_name(NameScope.MEMBER, variable.name) or identifier(variable.name)
        kind = variable.type
        if isinstance(kind, StructType):
            kind = StructType(members=[self._member(member, path) for member in kind.members])
        initial = None if variable.initial is None else filled(variable.initial, variable.type, self.types)
        return Variable(name=name, type=kind, initial=initial, comment=variable.comment)


def _type_of(text: str) -> DataType | None:
    """A type as tags name it."""
    section = next(iter(read_declarations(f"VAR x : {text}; END_VAR", Dialect.SCL).sections), None)
    return section.variables[0].type if section is not None and section.variables else None


def _struct_value(members: Iterable[Variable]) -> StructValue | None:
    values = [MemberValue(member=member.name, value=member.initial) for member in members if member.initial is not None]
    return StructValue(members=values) if values else None


def _retained(block: DataBlock) -> list[bool]:
    """For each variable of a data block, whether it is retained."""
    sections = block.interface.sections if block.interface is not None else []
    return [is_retained(section, variable) for section in sections for variable in section.variables]


def _is_all_retained(block: DataBlock) -> bool:
    retained = _retained(block)
    return bool(retained) and all(retained)


def _new_name(wish: str, taken: set[str]) -> str:
    name, number = wish, 1
    while name.casefold() in taken:
        number += 1
        name = f"{wish}_{number}"
    taken.add(name.casefold())
    return name
