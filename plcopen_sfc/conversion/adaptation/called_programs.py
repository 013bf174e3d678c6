"""Programs of CODESYS that others call, or whose variables others name, where no tool has such calls.

A program of IEC 61131-3 is executed by its task alone, and keeps its variables for itself. So it becomes a function
block, and its name is that of a global instance: what calls it or names its variables stays as it is. What a task
called is a program that calls the instance. The project keeps the names, and becomes as it was in CODESYS.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping

from plcopen_sfc.languages.binding import Names, bind
from plcopen_sfc.languages.translation.renames import KeptNames, keep_names, kept_names
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model.base import ForeignData
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource
from plcopen_sfc.model.types import DerivedType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection, sections_of
from plcopen_sfc.reachability import reached
from plcopen_sfc.report import ConversionReport, Outcome


def make_blocks_of_programs(project: Project, tool: str, report: ConversionReport) -> None:
    """Change the called programs of `project`, a copy, into blocks for a tool."""
    programs = {pou.name.casefold(): pou for pou in project.pous if pou.kind is PouKind.PROGRAM}
    users = _users(project, programs)
    taken = {thing.name.casefold() for thing in project.objects()}
    made: list[tuple[str, str, str]] = []
    # programs that use each other in a circle stay: their blocks would need each other's declaration first
    used = [key for key in programs if key in users]
    for key in [key for key in used if key not in reached(users[key], lambda user: users.get(user, ()))]:
        program, name = programs[key], programs[key].name
        reads, writes = _named_outside(project, program, key)
        if any(each.address is not None or _is_constant(program, each.name, reads) for each in program.variables()):
            continue  # blocks have no variables at addresses, and others do not see their constants
        shown = show_variables(program, reads, writes)
        program.name, program.kind = take_name(f"{name}_block", taken), PouKind.FUNCTION_BLOCK
        instance = Variable(name=name, type=DerivedType(name=program.name))
        section = VariableSection(kind=SectionKind.GLOBAL, name=take_name("Programs", taken), variables=[instance])
        project.global_variables = [*project.global_variables, section]
        why = f"the function block {program.name} with the global instance {name}: others name it or its variables"
        report.add(Outcome.TRANSLATED, "program", f"POU {name}", why)
        report.add(Outcome.TRANSLATED, "global variable", f"global variable {section.name}.{name}", "an instance")
        caller = ""
        for place, called in _called_by_tasks(project, key):
            if not caller:
                caller = take_name(f"{name}_task", taken)
                body = StBody(text=f"{name}();")
                project.pous = [
                    *project.pous,
                    Pou(name=caller, kind=PouKind.PROGRAM, interface=Interface(), bodies=[body]),
                ]
                report.add(
                    Outcome.TRANSLATED, "POU", f"POU {caller}", f"it calls the instance {name}, for tasks of {tool}"
                )
            _execute(called, caller, place, f"the program {caller}, which calls the instance", report)
        made.append((name, program.name, caller))
        made += [(program.name, "", row) for row in shown]
    if made:
        keep_names(project, KeptNames.PROGRAMS, made)


def make_programs_of_blocks(project: Project, report: ConversionReport) -> None:
    """Let function blocks be programs again that were made of such, where nothing else is called as they were."""
    pous = {pou.name: pou for pou in project.pous}
    rows = kept_names(project, KeptNames.PROGRAMS)
    shown = {(block, text.split()[-1]): text for block, kind, text in rows if not kind}
    for name, block, caller in (row for row in rows if row[1]):
        sections = [each for each in project.global_sections() if any(v.name == name for v in each.variables)]
        if block not in pous or name in pous or len(sections) != 1:
            continue
        hide_variables(pous[block], {variable: text for (owner, variable), text in shown.items() if owner == block})
        pous[block].name, pous[block].kind = name, PouKind.PROGRAM
        sections[0].variables = [each for each in sections[0].variables if each.name != name]
        owners: list[Project | Configuration | Resource] = [project, *project.configurations, *project.resources()]
        for owner in owners:
            owner.global_variables = [s for s in owner.global_variables if s.variables or s is not sections[0]]
        body = pous[caller].body if caller in pous else None
        if isinstance(body, StBody) and body.text.strip() == f"{name}();":
            project.pous = [each for each in project.pous if each.name != caller]
            for place, called in _called_by_tasks(project, caller.casefold()):
                _execute(called, name, place, f"the program {name}", report)
    keep_names(project, KeptNames.PROGRAMS, ())


def _users(project: Project, programs: Mapping[str, Pou]) -> dict[str, set[str]]:
    """Return the POUs that call each program or name its variables; all names are in lower case."""
    found: dict[str, set[str]] = {}
    for occurrence in Names(project).occurrences(*programs) if programs else ():
        program, user = programs[occurrence.reference.name.casefold()], occurrence.text_site.site.pou
        declaration = occurrence.meaning.declaration
        is_it = declaration is not None and declaration.holder is program
        if is_it and user not in (None, program) and not isinstance(occurrence.text_site.holder, ForeignData):
            found.setdefault(program.name.casefold(), set()).add(user.name.casefold() if user is not None else "")
    return found


def _named_outside(project: Project, program: Pou, key: str) -> tuple[set[str], set[str]]:
    """Return the variables of a program that others read, and those that they write, in lower case."""
    bodies = [body for pou in project.pous if pou is not program for _, _, body in pou.named_bodies()]
    effects = [bind(body, project.dialect).effects for body in bodies]
    reads = {path[1] for each in effects for path in each.reads if len(path) > 1 and path[0] == key}
    return reads, {path[1] for each in effects for path in each.writes if len(path) > 1 and path[0] == key}


def _is_constant(program: Pou, name: str, reads: set[str]) -> bool:
    constant = (each for each in sections_of(program.interface) if each.constant or each.kind is SectionKind.CONSTANT)
    return name.casefold() in reads and any(v.name == name for each in constant for v in each.variables)


def show_variables(program: Pou, reads: set[str], writes: set[str]) -> list[str]:
    """Let others see local variables that they name: as inputs where they write them, else as outputs.

    Outputs that they write are inputs, too. Returns a row of each: the number of its section, its place there, how many
    variables that had, its kind, and the name.
    """
    shown: list[str] = []
    sections: list[VariableSection] = []
    for number, section in enumerate(sections_of(program.interface)):
        parts: dict[SectionKind, list[Variable]] = {section.kind: []}
        for place, variable in enumerate(section.variables):
            key, kind = variable.name.casefold(), section.kind
            if (kind is SectionKind.LOCAL and key in writes | reads) or (kind is SectionKind.OUTPUT and key in writes):
                shown.append(f"{number} {place} {len(section.variables)} {kind} {variable.name}")
                kind = SectionKind.INPUT if key in writes else SectionKind.OUTPUT
            parts.setdefault(kind, []).append(variable)
        kept = [(kind, variables) for kind, variables in parts.items() if variables or len(parts) == 1]
        sections += [section.model_copy(update={"kind": kind, "variables": variables}) for kind, variables in kept]
    if program.interface is not None:
        program.interface.sections = sections
    return shown


def hide_variables(program: Pou, shown: Mapping[str, str]) -> None:
    """Put variables that were shown into their sections again; `shown` has their places by their names."""
    if program.interface is None or not shown:
        return
    places = {name: tuple(map(int, text.split()[:3])) for name, text in shown.items()}
    kinds = {places[name][0]: SectionKind(text.split()[3]) for name, text in shown.items()}
    whole = Counter(number for number, _, _ in places.values())
    sections: list[VariableSection] = []
    parts: dict[int, tuple[VariableSection, list[Variable]]] = {}
    for section in program.interface.sections:
        if not section.variables or any(variable.name not in places for variable in section.variables):
            sections.append(section)
            continue
        number, _, count = places[section.variables[0].name]
        if number not in parts and (whole[number] == count or not sections):  # nothing of the section was left
            sections.append(section.model_copy(update={"kind": kinds[number], "variables": []}))
        parts.setdefault(number, (sections[-1], []))[1].extend(section.variables)
    for section, variables in parts.values():
        for variable in sorted(variables, key=lambda each: places[each.name][1]):
            section.variables = [*section.variables]
            section.variables.insert(places[variable.name][1], variable)
    program.interface.sections = sections


def _execute(instance: PouInstance, program: str, place: str, why: str, report: ConversionReport) -> None:
    """Let a task or resource execute another program."""
    before = instance.name
    instance.name, instance.type_name = (instance.name, program) if instance.type_name else (program, "")
    for each in dict.fromkeys((before, instance.type_name, instance.name)):
        if each:
            report.add(Outcome.TRANSLATED, "program instance", f"{place}program instance {each}", why)


def _called_by_tasks(project: Project, program: str) -> Iterator[tuple[str, PouInstance]]:
    """Yield the instances of a program that tasks and resources execute, with the path of what they are in."""
    for resource in project.resources():
        places = [("", resource.instances), *((f"task {task.name} / ", task.instances) for task in resource.tasks)]
        for place, instances in places:
            yield from ((place, each) for each in instances if (each.type_name or each.name).casefold() == program)
