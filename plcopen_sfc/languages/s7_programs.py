"""Programs and tasks as S7 has them: function blocks with instance data blocks, which organization blocks call.

A program of CODESYS has one set of variables, whoever calls it: one data block. A program of IEC 61131-3 has one for
each of its instances (6.8.2). A task that runs in every cycle is a program cycle OB; one with an interval is a cyclic
interrupt OB, whose cycle time is set in TIA Portal: its files have no place for it. A task that an event starts has no
counterpart in a file.

For the result of a function S7 has a variable ``Ret_Val``, other tools the name of the function.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.networks.network_graph import wires_from
from plcopen_sfc.languages.s7_globals import global_names, local_tags
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.task_schedules import FREEWHEELING, nanoseconds, schedule_of
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model.body import FbdBody, LdBody, StBody, networks_of
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block, LogicNetwork
from plcopen_sfc.model.pou import DataBlock, DataBlockKind, Pou, PouKind
from plcopen_sfc.model.project import PouInstance, Project, Task
from plcopen_sfc.model.sfc import Body
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome

RESULT = "Ret_Val"
OPERANDS = ("expression", "variable")
"""Fields of elements of networks that hold operands."""


def is_void(section: VariableSection) -> bool:
    """True if a section of S7 declares that a function has no result."""
    kinds = [variable.type for variable in section.variables if section.kind is SectionKind.RETURN]
    return len(kinds) == 1 and isinstance(kinds[0], DerivedType) and kinds[0].name.casefold() == "void"


def has_results(project: Project) -> bool:
    """True if a function of a project has its result as S7 has it."""
    return any(_result(pou) is not None for pou in project.pous)


def name_results(project: Project, report: ConversionReport) -> None:
    """Give results of functions of S7 the name of their function, in declarations, texts and networks."""
    named: dict[str, str] = {}
    for pou in project.pous:
        section = _result(pou)
        if section is None or pou.interface is None:
            continue
        pou.interface.return_type = section.variables[0].type
        pou.interface.sections = [other for other in pou.interface.sections if other is not section]
        for body in pou.bodies:
            rename_local(body, RESULT, pou.name)
        named[pou.name.casefold()] = pou.name
        report.add(Outcome.TRANSLATED, "result", pou.report_path, "it has the name of the function")
    for network in (each for _, _, body in project.bodies() for each in networks_of(body)) if named else ():
        for node in network.nodes:
            name = named.get(node.type_name.casefold()) if isinstance(node, Block) else None
            if isinstance(node, Block) and name is not None:
                _name_pin(network, node, name)


def _result(pou: Pou) -> VariableSection | None:
    """Return the section with the result of a function of S7; None where it has none, or not as S7 has it."""
    if pou.kind is not PouKind.FUNCTION or pou.interface is None or pou.interface.return_type is not None:
        return None
    found = [section for section in pou.interface.sections if section.kind is SectionKind.RETURN]
    if len(found) != 1 or [variable.name.casefold() for variable in found[0].variables] != [RESULT.casefold()]:
        return None
    type_ = found[0].variables[0].type
    return None if isinstance(type_, DerivedType) and type_.name.casefold() == "void" else found[0]


def _name_pin(network: LogicNetwork, block: Block, name: str) -> None:
    for pin in block.parameters.outputs:
        if pin.name.casefold() == RESULT.casefold():
            for wire in wires_from(network, block.id):
                if wire.pin == pin.name:
                    wire.pin = name
            pin.name = name


def rename_local(body: Body, old: str, new: str) -> None:
    """Call the local variable `old` of a block in SCL `new`."""
    if isinstance(body, StBody):
        body.text = renamed_local(body.text, old, new)
    elif isinstance(body, FbdBody | LdBody):
        for node in (node for network in body.networks for node in network.nodes):
            for field in OPERANDS:
                if (text := getattr(node, field, None)) is not None:
                    setattr(node, field, renamed_local(text, old, new))


def renamed_local(text: str, old: str, new: str) -> str:
    """Return a text of SCL with the local variable `old` called `new`."""
    if old.casefold() not in text.casefold():
        return text
    spelled = (f"#{old}".casefold(), f'#"{old}"'.casefold())
    tokens = tokenize(text, Dialect.SCL).tokens
    return apply_edits(text, [Edit(*token.span, f"#{new}") for token in tokens if token.value.casefold() in spelled])


WITHOUT_TASK = "Programs"
"""Name of the organization block for instances of programs that have no task."""
_FIRST_PROGRAM_CYCLE, _CYCLIC_INTERRUPTS = 123, range(30, 39)
"""Numbers of organization blocks: OB30 to OB38 are cyclic interrupts, from OB123 on all are free (S7-1500)."""
_EVERY_CYCLE = frozenset({"", FREEWHEELING.casefold()})


class Caller(NamedTuple):
    """An organization block that calls instances of programs, in place of a task.

    `block` has no body yet: it calls the data blocks `called`, each with its program. `task` None: the instances have
    none. `interval` is its cycle time as a literal, empty: it runs in every cycle.
    """

    block: Pou
    task: Task | None
    interval: str
    called: tuple[tuple[str, str], ...]

    @property
    def event_class(self) -> str:
        """The kind of the block in TIA Portal."""
        return "CyclicInterrupt" if self.interval else "ProgramCycle"


@dataclass(slots=True)
class S7Programs:
    """Counterparts of programs and tasks in S7.

    `instances` are the instance data blocks, by the name of their program in lower case. `callers` call them.
    `uncalled` are tasks without an organization block, each with the reason.
    """

    instances: dict[str, list[DataBlock]] = field(default_factory=dict)
    callers: list[Caller] = field(default_factory=list)
    uncalled: list[tuple[Task, str]] = field(default_factory=list)

    @property
    def blocks(self) -> list[DataBlock]:
        """All instance data blocks."""
        return [block for blocks in self.instances.values() for block in blocks]


def s7_programs(project: Project) -> S7Programs:
    """Return the blocks of S7 in place of the programs and tasks of a project of another tool."""
    found = S7Programs()
    programs = {pou.name.casefold(): pou for pou in project.pous if pou.kind is PouKind.PROGRAM}
    if not programs and not any(project.resources()):
        return found
    taken = set(global_names(project)) | {
        tag.name.casefold() for local in local_tags(project).values() for tag in local.values()
    }
    shares = project.dialect is Dialect.CODESYS or bool(project.applications)
    numbers = {pou.number for pou in project.pous if pou.kind is PouKind.ORGANIZATION_BLOCK}

    def instance_of(program: Pou) -> DataBlock:
        """Return the data block for one more call of a program."""
        blocks = found.instances.setdefault(program.name.casefold(), [])
        if not blocks or not shares:
            name = take_name(f"{program.name}_DB", taken, first=1)
            blocks.append(DataBlock(name=name, kind=DataBlockKind.INSTANCE, type_name=program.name))
        return blocks[-1]

    def add_caller(name: str, task: Task | None, instances: list[PouInstance], interval: str) -> None:
        called = [programs[key] for each in instances if (key := _program(each)) in programs]
        if not called:
            if task is not None:
                found.uncalled.append((task, "the project has no program that it calls"))
            return
        usual = iter(_CYCLIC_INTERRUPTS if interval else ())
        number = next((each for each in usual if each not in numbers), _FIRST_PROGRAM_CYCLE)
        while number in numbers:
            number += 1
        numbers.add(number)
        blocks = tuple((instance_of(program).name, program.name) for program in called)
        interface = Interface(sections=[VariableSection(kind=SectionKind.TEMP)])
        kind = PouKind.ORGANIZATION_BLOCK
        block = Pou(name=take_name(name, taken, first=1), number=number, kind=kind, interface=interface)
        found.callers.append(Caller(block, task, interval, blocks))

    for resource in project.resources():
        for task in resource.tasks:
            interval, why = _cycle(task)
            if why:
                found.uncalled.append((task, why))
            else:
                add_caller(task.name, task, task.instances, interval)
        if not resource.tasks or not shares:  # CODESYS runs what its tasks call
            add_caller(WITHOUT_TASK, None, resource.instances, "")
    for program in programs.values():
        if program.name.casefold() not in found.instances:
            instance_of(program)
    return found


def unused_inputs(names: Names, block: Pou, inputs: Iterable[str], named: Collection[str] | None = None) -> set[str]:
    """Return those `inputs` of a block that nothing in a project reads or writes, although it has an instance.

    `named`: the names, in lower case, that the project uses; looked for where they are not known.
    """
    if block.name.casefold() not in instance_types(names.project):
        return set()
    found = list(inputs)
    used = {each.reference.name.casefold() for each in names.occurrences(*found)} if named is None else named
    return {name for name in found if name.casefold() not in used}


def instance_types(project: Project) -> frozenset[str]:
    """Return the names, in lower case, of all types of which a project has a variable or an instance data block."""
    types = [data_block.type_name or "" for data_block in project.data_blocks]
    declared = (variable.type for pou in project.pous for variable in pou.variables())
    types += [kind.name for kind in declared if isinstance(kind, DerivedType)]
    return frozenset(name.strip('"').casefold() for name in types)


def names_of_programs(project: Project) -> dict[str, str]:
    """Return the data blocks of the programs that others can call and read: the only ones of theirs; by program."""
    names = {pou.name.casefold(): pou.name for pou in project.pous}
    return {names[key]: blocks[0].name for key, blocks in s7_programs(project).instances.items() if len(blocks) == 1}


def report_program(project: Project, pou: Pou, report: ConversionReport) -> None:
    """Report the outcome of a program of `project`."""
    found = s7_programs(project)
    names = [block.name for block in found.instances[pou.name.casefold()]]
    why = f"a function block with the instance data block {' and '.join(names)}"
    if not any(name in names for caller in found.callers for name, _ in caller.called):
        why += "; no task calls it, so no organization block does"
    report.add(Outcome.TRANSLATED, "program", pou.report_path, why)


def report_tasks(project: Project, report: ConversionReport) -> None:
    """Report the outcome of the tasks of `project`."""
    found = s7_programs(project)
    for task, why in found.uncalled:
        called = ", ".join(each.type_name or each.name for each in task.instances)
        outcome = Outcome.NOT_EXECUTED if called else Outcome.TRANSLATED
        reason = f"{why}; no organization block is written that calls {called or 'nothing'}"
        report.add(outcome, "task", f"task {task.name}", reason)
    for block, stands_for, interval, _ in found.callers:
        if stands_for is None:
            continue
        path = f"task {stands_for.name}"
        report.add(Outcome.TRANSLATED, "task", path, f"the organization block {block.name} (OB{block.number})")
        kind = schedule_of(stands_for).kind
        if kind:
            report.add(Outcome.TRANSLATED, "kind of task", path, f"{kind} is a program cycle")
        if interval:
            why = f"set the cycle time of {block.name} to {interval} in TIA Portal: its files have no place for it"
            report.add(Outcome.APPROXIMATED, "interval", path, why)
        if len(found.callers) > 1:
            why = f"set the priority of {block.name} in TIA Portal: in the source it is {stands_for.priority}"
            report.add(Outcome.APPROXIMATED, "priority", path, why)
        else:
            report.add(Outcome.TRANSLATED, "priority", path, "there is one organization block only")


def _program(instance: PouInstance) -> str:
    """Name, in lower case, of the program that an instance executes. A task of CODESYS calls a program by its name."""
    return (instance.type_name or instance.name).strip().casefold()


def _cycle(task: Task) -> tuple[str, str]:
    """Return the cycle time of a task, empty for every cycle; and why it has none that S7 could keep."""
    schedule = schedule_of(task)
    if schedule.event is not None:
        return "", f"it starts at a rising edge of {schedule.event}"
    if schedule.kind.casefold() not in _EVERY_CYCLE:
        return "", f"it is a task of the kind {schedule.kind}"
    if schedule.interval is None:
        return "", ""
    if nanoseconds(schedule.interval) is None:
        return "", f"its interval is the variable {schedule.interval}"
    return schedule.interval, ""
