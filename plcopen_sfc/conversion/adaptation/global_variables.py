"""Global variables of other tools: tags and data blocks of TIA Portal, and lists of CODESYS in TC6.

A tag becomes a variable at its address, a user constant a constant. A data block becomes what programs name as before:
``DB.x`` is a variable of a list in CODESYS and a member of a structure in TC6, an instance data block is an instance.
An organization block is a program, which a resource of TC6 executes.

Programs of CODESYS name a variable with its list, ``GVL_IO.x``, or without. In TC6 global variables belong to a
configuration and to no list, and it is ``x``: the name of the list is taken out of every text, and the texts of the
source are kept for the way back.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator

from plcopen_sfc.conversion.adaptation.main_programs import MAIN, add_main
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.formats.format_interface import ChartHost
from plcopen_sfc.formats.plcopen.source_marks import (
    TEXTS_FIELD,
    SourceMarks,
    added_configuration,
    added_section,
    text_digest,
)
from plcopen_sfc.languages.binding.text_sites import Site, SiteKind, TextSite, text_sites
from plcopen_sfc.languages.s7_globals import is_retained, type_named
from plcopen_sfc.languages.s7_programs import is_void
from plcopen_sfc.languages.s7_types import is_operand_of_s5, plain_type
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7
from plcopen_sfc.languages.start_values import filled
from plcopen_sfc.languages.task_schedules import FREEWHEELING
from plcopen_sfc.languages.translation import NameScope
from plcopen_sfc.languages.translation.literal_translation import translated_address
from plcopen_sfc.languages.translation.renames import kept_renames
from plcopen_sfc.languages.words import identifier, take_name
from plcopen_sfc.model import types as t
from plcopen_sfc.model.body import FbdBody, LdBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import DataBlock, DataBlockKind, Pou, PouKind
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource, TagTable, Task, TaskSettings
from plcopen_sfc.model.sfc import SfcBody
from plcopen_sfc.model.variables import SectionKind, VariableSection, sections_of
from plcopen_sfc.report import Cause, CauseKind, ConversionReport, Outcome

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


def add_globals(project: Project, host: ChartHost, report: ConversionReport, marks: SourceMarks) -> None:
    """Add global variables for tags and data blocks to `project`, a copy."""
    sections = _Globals(project, host, report).sections()
    for section in sections:
        marks[id(section)] = added_section(section)
    cyclic = _cyclic_blocks(project, host, report)
    if host.is_codesys:
        project.global_variables = [*project.global_variables, *sections]
        if cyclic and host.has_main:
            add_main(project, cyclic, report, marks)
        elif cyclic:
            called = [PouInstance(name=name, type_name="") for name in cyclic]
            task = Task(name="MainTask", settings=TaskSettings(kind=FREEWHEELING), instances=called)
            resource = Resource(name="Application", tasks=[task])
            project.configurations = [Configuration(name="Device", resources=[resource])]
            marks[id(project.configurations[0])] = added_configuration(project.configurations[0])
        return
    if not project.configurations and (sections or cyclic):
        instances = [PouInstance(name=f"{name}_instance", type_name=name) for name in cyclic]
        resource = Resource(name="Resource", instances=instances)
        project.configurations = [Configuration(name="Configuration", resources=[resource])]
        marks[id(project.configurations[0])] = added_configuration(project.configurations[0])
    if sections:
        target = project.configurations[0]
        target.global_variables = [*target.global_variables, *sections]


def _cyclic_blocks(project: Project, host: ChartHost, report: ConversionReport) -> list[str]:
    """Return the organization blocks that are executed in every cycle; the others are in the report."""
    found: list[str] = []
    others = [thing.name for thing in project.objects()]
    for pou in project.pous:
        if pou.kind is not PouKind.ORGANIZATION_BLOCK:
            continue
        # OB1 is the cyclic one; others start at events that no file names.
        can_call = host.has_tasks or (host.has_main and MAIN not in map(str.upper, others))
        if pou.number in (None, 1) and can_call and not any(project.resources()):
            found.append(pou.name)
            why = "a program of a task without a cycle time" if host.is_codesys else "a program of the resource"
            why = f"a program that {MAIN} calls in every cycle" if host.has_main else why
            report.add(Outcome.TRANSLATED, "program", pou.report_path, why)
        else:
            why = f"a program that no task of {host.title} calls: give it one"
            report.add(Outcome.NOT_EXECUTED, "program", pou.report_path, why)
    return found


def report_types(project: Project, host: ChartHost, report: ConversionReport) -> None:
    """Report the variables whose type the target does not have: their declarations do not compile."""
    declared = {thing.name.casefold() for thing in (*project.pous, *project.data_types)}

    def look_at(variables: Iterable[t.Variable], path: str) -> None:
        for variable in variables:
            foreign = is_foreign_type(variable.type, host)
            if foreign is not None and foreign.casefold() not in declared:
                why = f"{host.title} has no type {foreign}: the declaration does not compile"
                lacking = Cause(CauseKind.LACKING, foreign)
                report.add(Outcome.NOT_EXECUTED, "data type", f"{path} / variable {variable.name}", why, lacking)

    for pou in project.pous:
        for section in sections_of(pou.interface):
            if not is_void(section):  # those of S5 get others
                plain = [v.model_copy(update={"type": plain_type(v.type)}) for v in section.variables]
                look_at(plain, pou.report_path)
    for section in project.global_sections():
        look_at(section.variables, f"list of global variables {section.name}" if section.name else "global variables")
    for declaration in project.data_types:
        if isinstance(declaration.type, t.StructType):
            look_at(declaration.type.members, declaration.report_path)


def is_foreign_type(kind: t.DataType, host: ChartHost) -> str | None:
    """Return the name of a data type in `kind` that the target does not have; None where there is none."""
    match kind:
        case t.DerivedType(name=name) if name.strip('"').upper() in _OF_S7:
            return name
        case t.ElementaryType(name=t.Elementary.CHAR | t.Elementary.WCHAR as name) if host.is_codesys:
            return name.value
        case t.ArrayType(base=base):
            return is_foreign_type(base, host)
        case t.StructType(members=members):
            return next((found for member in members if (found := is_foreign_type(member.type, host))), None)
        case _:
            return None


class _Globals:
    def __init__(self, project: Project, host: ChartHost, report: ConversionReport) -> None:
        self.project, self.host, self.report = project, host, report
        self.names = kept_renames(project)
        self.types = {each.name.casefold(): each.type for each in project.data_types}
        self.declared = self.types.keys() | {pou.name.casefold() for pou in project.pous}
        self._operands: dict[str, str] = {}
        """The tags of timers and counters of S5 by their addresses."""

    def sections(self) -> list[VariableSection]:
        """Return the lists of variables."""
        found: list[VariableSection] = []
        for table in self.project.tag_tables:
            found += self._table(table)
        instances: list[t.Variable] = []
        retained: list[t.Variable] = []
        for block in self.project.data_blocks:
            kept = _retained(block)
            found += self._block(block, retained if kept and all(kept) else instances)
        for variables in (instances, retained):
            if variables:
                found.append(self._list("Instances", variables))
                found[-1].retain = variables is retained
        taken: set[str] = set()
        for section in found:
            section.name = take_name(section.name or "", taken)
        return found

    def _named(self, name: str) -> str:
        return self.names.new_name(NameScope.GLOBAL, name) or identifier(name)

    def _list(self, name: str, variables: list[t.Variable]) -> VariableSection:
        return VariableSection(kind=SectionKind.GLOBAL, name=name, variables=variables)

    # -- tags

    def _table(self, table: TagTable) -> list[VariableSection]:
        tags: list[t.Variable] = []
        counted: list[str] = []
        for tag in table.tags:
            path = f"{table.report_path} / tag {tag.name}"
            kind = type_named(tag.type)
            is_operand = is_operand_of_s5(kind)
            kind = plain_type(kind) if kind is not None else None
            other = self._operands.setdefault((tag.address or tag.name).upper(), tag.name) if is_operand else tag.name
            if other != tag.name:
                why = f"it is the same as {other}, and would be another variable in {self.host.title}"
                self.report.add(Outcome.NOT_EXECUTED, "tag", path, why)
                continue
            place = "" if is_operand else tag.address or ""  # timers and counters of S5 are in no memory of others
            address = translated_address(place, Dialect.SCL, self.host.addresses)
            if kind is None or is_foreign_type(kind, self.host):
                why, lacking = f"{self.host.title} has no type {tag.type}", Cause(CauseKind.LACKING, tag.type)
                self.report.add(Outcome.NOT_EXECUTED, "tag", path, why, lacking)
                continue
            if place and address.severity is Severity.ERROR:
                self.report.add(Outcome.NOT_EXECUTED, "address", path, f"{address.reason}: the tag is left out")
                continue
            if address.severity is not None:
                counted.append(f"{tag.name} AT {address.text}")
            tags.append(
                t.Variable(name=self._named(tag.name), type=kind, address=address.text or None, comment=tag.comment)
            )
        constants = [
            t.Variable(name=self._named(c.name), type=c.type, initial=c.initial, comment=c.comment)
            for c in table.constants
        ]
        if counted:
            why = "the same bytes, where S7 counts bytes and other tools words or double words: "
            self.report.add(Outcome.TRANSLATED, "address", table.report_path, why + ", ".join(counted))
        self.report.add(Outcome.TRANSLATED, "tag table", table.report_path, "global variables")
        found = [self._list(identifier(table.name), tags)] if tags else []
        if constants:
            found.append(self._list(f"{identifier(table.name)}_constants", constants))
            found[-1].constant = True
        return found

    # -- data blocks

    def _block(self, block: DataBlock, instances: list[t.Variable]) -> list[VariableSection]:
        name, path = self._named(block.name), block.report_path
        if block.type_name is not None or block.kind is DataBlockKind.INSTANCE:
            type_name = (block.type_name or "").strip('"')
            type_name = BLOCKS_OF_S7.get(type_name.upper(), type_name)
            known = type_name.casefold() in self.declared or type_name.upper() in BLOCKS_OF_S7.values()
            if not known:
                why = f"{self.host.title} does not know what it is an instance of: {type_name or 'its type'} is missing"
                self.report.add(Outcome.NOT_EXECUTED, "data block", path, why)
                return []
            instances.append(self._instance(name, type_name, block))
            self.report.add(Outcome.TRANSLATED, "data block", path, f"a global instance of {type_name}")
            return []
        variables = block.interface.variables() if block.interface is not None else []
        if not variables or block.kind is not DataBlockKind.GLOBAL:
            self.report.add(Outcome.NOT_EXECUTED, "data block", path, f"{self.host.title} has no such block")
            return []
        members = [self._member(variable, path) for variable in variables]
        retained = _retained(block)
        if self.host.is_codesys:
            section = self._list(name, members)
            self.report.add(Outcome.TRANSLATED, "data block", path, f"the list of global variables {name}")
        else:
            initial = _struct_value(members)
            plain = [member.model_copy(update={"initial": None}) for member in members]
            whole = t.Variable(name=name, type=t.StructType(members=plain), initial=initial, comment=block.comment)
            section = self._list(f"{name}_data", [whole])
            self.report.add(Outcome.TRANSLATED, "data block", path, f"the global structure {name}")
            self.report.add(
                Outcome.TRANSLATED, "global variables", f"global variables {name}", "members of a structure"
            )
        section.retain = all(retained)
        for variable in variables if section.retain else ():
            place = f"global variable {name}.{variable.name}"
            self.report.add(Outcome.TRANSLATED, "retain", place, "as in its data block")
        if any(retained) and not all(retained):
            kept = ", ".join(v.name for v, is_kept in zip(variables, retained, strict=True) if is_kept)
            why = f"{kept} would be retained, other variables of the block not: none is"
            self.report.add(Outcome.NOT_EXECUTED, "retain", path, why)
        return [section]

    def _instance(self, name: str, type_name: str, block: DataBlock) -> t.Variable:
        """Return the variable for an instance, with the start values that it has and its type has not."""
        own = next((pou for pou in self.project.pous if pou.name.casefold() == type_name.casefold()), None)
        usual = {v.name.casefold(): v.initial for v in own.variables()} if own is not None else {}
        given = [
            self._member(variable, block.report_path)
            for variable in (block.interface.variables() if block.interface is not None else ())
            if variable.initial is not None and variable.initial != usual.get(variable.name.casefold())
        ]
        type_ = t.DerivedType(name=self._named(type_name))
        return t.Variable(name=name, type=type_, initial=_struct_value(given), comment=block.comment)

    def _member(self, variable: t.Variable, path: str) -> t.Variable:
        kind = plain_type(variable.type)
        foreign = is_foreign_type(kind, self.host)
        if foreign is not None:
            why = f"{self.host.title} has no type {foreign}: it does not compile"
            lacking = Cause(CauseKind.LACKING, foreign)
            self.report.add(Outcome.NOT_EXECUTED, "data type", f"{path} / variable {variable.name}", why, lacking)
        name = self.names.new_name(NameScope.MEMBER, variable.name) or identifier(variable.name)
        if isinstance(kind, t.StructType):
            kind = t.StructType(members=[self._member(member, path) for member in kind.members])
        initial = None if variable.initial is None else filled(variable.initial, variable.type, self.types)
        return t.Variable(name=name, type=kind, initial=initial, comment=variable.comment)


def _struct_value(members: Iterable[t.Variable]) -> t.StructValue | None:
    values = [
        t.MemberValue(member=member.name, value=member.initial) for member in members if member.initial is not None
    ]
    return t.StructValue(members=values) if values else None


def _retained(block: DataBlock) -> list[bool]:
    """For each variable of a data block, whether it is retained."""
    sections = sections_of(block.interface)
    return [is_retained(section, variable) for section in sections for variable in section.variables]


def has_lists(project: Project) -> bool:
    """True if a project has lists of global variables whose names are used in texts."""
    return any(True for _ in _lists(project))


def _lists(project: Project) -> Iterator[VariableSection]:
    yield from project.global_variables
    for section in (section for resource in project.applications for section in resource.global_variables):
        if section.name:
            yield section
    for section in (s for c in project.configurations for r in c.resources for s in r.global_variables):
        if section.name and section.object_id is not None:  # in IEC 61131-3 the name of a list means nothing
            yield section


def declare_lists(project: Project, host: ChartHost, report: ConversionReport, marks: SourceMarks) -> None:
    """Take the names of lists out of the texts of `project`, a copy, and move the lists into a configuration.

    CoDeSys 2.3 has lists, with names that mean nothing in texts.
    """
    counts = Counter(v.name.casefold() for section in _lists(project) for v in section.variables)
    members: dict[str, set[str]] = {}
    for section in _lists(project):
        if section.name:
            members.setdefault(section.name.casefold(), set()).update(v.name.casefold() for v in section.variables)
    shared = {name for name, count in counts.items() if count > 1}
    for name in sorted(shared):
        why = f"several lists have one of this name, and {host.title} knows no lists: what names it does not compile"
        report.add(Outcome.NOT_EXECUTED, "global variable", f"global variable {name}", why)
    unqualifier = _Unqualifier(project, members, shared, marks)
    unqualifier.run()
    for path in dict.fromkeys(unqualifier.left):
        why = f"it names a variable with its list, which {host.title} does not know: it does not compile"
        report.add(Outcome.NOT_EXECUTED, "text", path, why)
    for path, name in dict.fromkeys(unqualifier.hidden):
        why = f"{name} keeps its list, which {host.title} does not know, as another {name.rpartition('.')[2]} hides it"
        report.add(Outcome.NOT_EXECUTED, "text", path, f"{why}: it does not compile")
    if host.is_codesys:
        for around in dict.fromkeys(section.name for section in _lists(project) if section.name):
            report.add(Outcome.TRANSLATED, "global variables", f"global variables {around}", "named without their list")
        return
    moved: list[VariableSection] = []
    for section in project.global_variables:
        source = section.model_dump(mode="json", exclude_none=True)
        plain = section.model_copy(update={"declaration": None, "object_id": None, "extension_data": None})
        marks[id(plain)] = added_section(plain) | {"list": source}
        moved.append(plain)
    for listed in dict.fromkeys(section.name for section in moved):  # a list may have several sections
        report.add(Outcome.TRANSLATED, "global variables", f"global variables {listed}", "of the configuration")
    project.global_variables = []
    if moved:
        if not project.configurations and not project.applications:
            project.configurations = [Configuration(name="Configuration", resources=[Resource(name="Resource")])]
            marks[id(project.configurations[0])] = added_configuration(project.configurations[0])
        target = project.configurations[0] if project.configurations else project.applications[0]
        target.global_variables = [*target.global_variables, *moved]


class _Unqualifier:
    """Takes the names of lists out of texts.

    `left` are the paths of texts that keep them, `hidden` those in which a variable keeps its list, each with its name.
    """

    def __init__(self, project: Project, members: dict[str, set[str]], shared: set[str], marks: SourceMarks) -> None:
        self._project = project
        self._members = members
        self._marks = marks
        self._objects = shared | {thing.name.casefold() for thing in project.objects()}
        self._locals: dict[int, set[str]] = {}
        self.left: list[str] = []
        self.hidden: list[tuple[str, str]] = []

    def run(self) -> None:
        """Change the texts of all bodies and declarations."""
        bodies = [body for _, _, body in self._project.bodies()]
        drawn = [body for body in bodies if isinstance(body, FbdBody | LdBody)]
        before = {id(body): body.model_dump(mode="json", exclude_none=True)["networks"] for body in drawn}
        texts = {id(body): body.text for body in bodies if isinstance(body, StBody)}
        for text_site in list(text_sites(self._project)):
            is_text = text_site.is_program_text or text_site.reading is SiteKind.INSTRUCTIONS
            if not is_text or not self._mentions(text_site.text):
                continue
            if text_site.reading is SiteKind.INSTRUCTIONS:
                self.left.append(text_site.report_path)
            elif (new := self._unqualified(text_site)) != text_site.text:
                text_site.put(new)
        for body in bodies:
            if isinstance(body, StBody) and body.text != texts[id(body)]:
                kept = {"text": [texts[id(body)], text_digest(body.text)]}
                self._marks[id(body)] = {TEXTS_FIELD: kept}
        for body in drawn:
            if body.model_dump(mode="json", exclude_none=True)["networks"] != before[id(body)]:
                self._marks[id(body)] = {"networks": before[id(body)]}

    def _mentions(self, text: str) -> bool:
        folded = text.casefold()
        return any(f"{name}." in folded for name in self._members)

    def _unqualified(self, text_site: TextSite) -> str:
        hidden = self._names_in(text_site.site)

        def change(node: n.Node) -> n.Node:
            if not isinstance(node, n.Member) or not isinstance(node.base, n.Name):
                return node
            name, member = node.base.identifier.casefold(), node.name.identifier.casefold()
            if member not in self._members.get(name, ()) or name in hidden:
                return node
            if member in hidden or member in self._objects:
                self.hidden.append((text_site.report_path, print_node(node)))
                return node
            return node.name

        return text_site.rewritten(Dialect.CODESYS, change)

    def _names_in(self, site: Site) -> set[str]:
        """Return the names that hide global ones."""
        pou = site.pou
        if pou is None:
            return set()
        if id(pou) not in self._locals:
            self._locals[id(pou)] = {name.casefold() for name in _own_names(pou)}
        return self._locals[id(pou)]


def _own_names(pou: Pou) -> Iterator[str]:
    external = SectionKind.EXTERNAL  # which names the global variable itself
    sections = sections_of(pou.interface)
    yield from (variable.name for section in sections if section.kind is not external for variable in section.variables)
    yield from (action.name for action in pou.actions)
    yield from (transition.name for transition in pou.transitions)
    for _, _, body in pou.named_bodies():
        yield from (step.name for step in body.chart.steps) if isinstance(body, SfcBody) else ()
    for method in pou.methods:
        if method.interface is not None:
            yield from (variable.name for variable in method.interface.variables())
