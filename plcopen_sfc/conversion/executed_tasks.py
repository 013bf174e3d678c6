"""Tasks and the programs that they call, in the tree of what a controller executes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property

from plcopen_sfc.conversion.declared_values import StartValues
from plcopen_sfc.conversion.executed_parts import Detail, Part, duration_meaning, plain_name
from plcopen_sfc.conversion.meaning import Meaning, address_meaning, plain, type_meaning
from plcopen_sfc.languages.declarations.kept_texts import texts_from
from plcopen_sfc.languages.s7_programs import WITHOUT_TASK
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.languages.task_schedules import schedule_of
from plcopen_sfc.languages.words import folded
from plcopen_sfc.model.body import FbdBody, LdBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block, Node
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Task, TaskWatchdog


class TaskReader:
    """Reads the tasks of a project into a tree: their schedules, and instances of programs.

    They are those of `source`, the project as it was read; in S7 organization blocks call the instance data blocks
    `programs`, each by the name of its program. `target` gives the name of a variable as it is compared.
    """

    def __init__(
        self,
        project: Project,
        source: Project,
        whole: Part,
        *,
        detail: Detail,
        programs: Mapping[str, str],
        starts: StartValues,
        addresses: Dialect,
        target: Callable[[str], str],
    ) -> None:
        self._project, self._source, self._whole = project, source, whole
        self._detail, self._programs, self._starts = detail, programs, starts
        self._addresses, self._target = addresses, target

    def read(self) -> None:
        """Read all of it."""
        called = Counter(self._program(instance) for instance in self._instances())
        shared = {program for program, count in called.items() if count > 1}
        for resource in self._source.resources():
            for task in resource.tasks:
                self._task(task, shared)
            for instance in resource.instances if not self._is_of_codesys else ():  # which runs what a task calls
                self._instance(self._whole, instance, "", shared)
        self._callers()
        owners: list[Project | Configuration] = [self._source, *self._source.configurations]
        if self._is_codesys_file:  # none of its exports has configVars: its importer may not read them
            owners = []
        for section in (owner.config_variables for owner in owners):
            for variable in section.variables if section is not None else ():
                part = self._whole.add("VAR_CONFIG", variable.path, f"VAR_CONFIG {variable.path}")
                part.tell("type", type_meaning(variable.type, self._project.dialect))
                part.tell("address", address_meaning(variable.address, self._addresses))
                part.tell("initial value", self._starts.of_value(variable.initial))

    def _callers(self) -> None:
        """Read the organization blocks in place of tasks."""
        callers = {pou.name: self._called_programs(pou) for pou in self._project.pous if self.replaces_task(pou)}
        calls = Counter(self._programs[block] for blocks in callers.values() for block in blocks)
        instances = Counter(self._programs.values())
        for name, blocks in callers.items():
            is_task = name != WITHOUT_TASK
            around = f"task {name} / " if is_task else ""
            owner = self._whole.add("task", name, f"task {name}") if is_task else self._whole
            for block in blocks:
                program = self._programs[block]
                part = owner.add("program instance", program, f"{around}program instance {block}")
                part.tell("program", Meaning.of(program))
                if calls[program] > 1:
                    memory = "its own" if instances[program] > 1 else "shared by all calls"
                    part.tell("variables", Meaning.of(memory))

    def replaces_task(self, pou: Pou) -> bool:
        """True for an organization block that does nothing but call programs of the source."""
        return pou.kind is PouKind.ORGANIZATION_BLOCK and bool(self._called_programs(pou))

    def _called_programs(self, pou: Pou) -> list[str]:
        """Return the instance data blocks of programs that a block calls, in lower case; none if it does more."""
        body = pou.body
        if isinstance(body, FbdBody | LdBody) and len(pou.bodies) == 1:
            boxes = [node for network in body.networks for node in network.nodes]
            names = [_called_alone(box) for box in boxes]
            return names if all(name in self._programs for name in names) else []
        if not isinstance(body, StBody) or len(pou.bodies) > 1:
            return []
        found: list[str] = []
        for statement in parse_statements(body.text, self._project.dialect).tree.statements:
            call = statement.call if isinstance(statement, n.CallStatement) else None
            callee = call.callee if isinstance(call, n.Call) and not call.arguments else None
            if not isinstance(callee, n.Name) or callee.identifier.casefold() not in self._programs:
                return []
            found.append(callee.identifier.casefold())
        return found

    @property
    def _is_of_codesys(self) -> bool:
        return self._source.dialect is Dialect.CODESYS

    @property
    def _is_codesys_file(self) -> bool:
        return self._source.tool_format == "codesys"

    def _instances(self) -> Iterator[PouInstance]:
        for resource in self._source.resources():
            for task in resource.tasks:
                yield from task.instances
            yield from resource.instances

    def _program(self, instance: PouInstance) -> str:
        """Return the program that an instance executes.

        A task of CODESYS calls a program by its name, and has no instances.
        """
        is_called = self._is_codesys_file and instance.name.casefold() in self._whole.programs
        name = instance.name if is_called or not instance.type_name else instance.type_name
        return plain_name(self._other_names.get(name.casefold(), name))

    @cached_property
    def _other_names(self) -> dict[str, str]:
        """The names of POUs that have others in the source, whose tasks name them so, by these in lower case."""
        own = {pou.name.casefold() for pou in self._project.pous}
        both = zip(self._source.pous, self._project.pous, strict=False)
        named = {pou.name.casefold() for pou in self._source.pous}
        return {
            old.name.casefold(): new.name
            for old, new in both
            if old.name.casefold() not in own and new.name.casefold() not in named
        }

    def _task(self, task: Task, shared: set[str]) -> None:
        part = self._whole.add("task", task.name, f"task {task.name}")
        schedule = schedule_of(task)
        part.tell("interval", self._source_of_data(schedule.interval))
        part.tell("trigger", self._source_of_data(schedule.event))
        if schedule.kind:
            part.tell("kind of task", Meaning.of(schedule.kind.casefold(), schedule.kind))
        part.tell("priority", Meaning.of(task.priority))
        watchdog = task.settings.watchdog if task.settings is not None else None
        if self._detail is Detail.WRITTEN and watchdog is not None:
            part.tell("watchdog", Meaning.of(plain(watchdog), _shown_watchdog(watchdog)))
        for instance in task.instances:
            self._instance(part, instance, f"task {task.name} / ", shared)

    def _source_of_data(self, text: str | None) -> Meaning | None:
        """Return the meaning of a literal or of the name of a variable."""
        if text is None or "#" in text:
            return duration_meaning(text)
        return Meaning.of(self._target(text.strip()).casefold(), text)

    def _instance(self, owner: Part, instance: PouInstance, around: str, shared: set[str]) -> None:
        program = self._program(instance)
        part = owner.add("program instance", program, f"{around}program instance {instance.name}")
        part.tell("program", Meaning.of(program, instance.type_name or instance.name))
        if self._detail is Detail.WRITTEN and instance.type_name and not self._is_codesys_file:
            part.tell("name", Meaning.of(instance.name.casefold(), instance.name))
        if program in shared:
            memory = "shared by all calls" if self._is_of_codesys else "its own"
            part.tell("variables", Meaning.of(memory))
        for text in texts_from("arguments", instance.extension_data):
            part.tell("arguments", Meaning.of(folded(" ".join(text.split())), text))


def _shown_watchdog(watchdog: TaskWatchdog) -> str:
    time = watchdog.time or ""
    unit = watchdog.time_unit if time and "#" not in time else None
    return " ".join(filter(None, ("on" if watchdog.enabled else "off", time + (unit or ""), watchdog.sensitivity)))


def _called_alone(node: Node) -> str:
    """Return the data block, in lower case, that a box calls without parameters; empty for anything else."""
    pins = [pin.input for pin in node.parameters.inputs] if isinstance(node, Block) else []
    if not isinstance(node, Block) or any(pin.connections or pin.expression for pin in pins if pin is not None):
        return ""
    return (node.instance or "").strip('"').casefold()
