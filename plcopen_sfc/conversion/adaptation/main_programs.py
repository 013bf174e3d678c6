"""Programs that a controller executes without a task: `PLC_PRG` of CoDeSys 2.3.

Where a project of CoDeSys 2.3 has no task configuration, its controller executes the program PLC_PRG in every cycle. No
export shows how a task configuration is written. So the programs of one cyclic task become calls in PLC_PRG, and in
tools with tasks PLC_PRG gets one.
"""

from __future__ import annotations

from collections.abc import Sequence

from plcopen_sfc.formats.format_interface import ChartHost
from plcopen_sfc.formats.plcopen.source_marks import SourceMarks, added_pou
from plcopen_sfc.languages.declarations.kept_texts import texts_from
from plcopen_sfc.languages.task_schedules import FREEWHEELING, schedule_of
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource, Task, TaskSettings
from plcopen_sfc.model.variables import Interface
from plcopen_sfc.report import ConversionReport, Outcome

MAIN = "PLC_PRG"


def give_task(project: Project, report: ConversionReport) -> None:
    """Give PLC_PRG of `project`, a copy that comes from CoDeSys 2.3, the task by which other tools execute it."""
    if any(project.resources()) or MAIN.casefold() not in _programs(project):
        return
    name = _programs(project)[MAIN.casefold()]
    project.configurations = [*project.configurations, _given(name)]
    why = f"it calls {name}, which CoDeSys 2.3 executes in every cycle without one"
    report.add(Outcome.TRANSLATED, "task", f"task {_TASK}", why)


def take_task(project: Project, report: ConversionReport) -> None:
    """Take from `project`, a copy for CoDeSys 2.3, the task that `give_task` gives a project from there."""
    name = _programs(project).get(MAIN.casefold(), "")
    stated = [each.model_dump(exclude_defaults=True) for each in project.configurations]
    if stated == [_given(name).model_dump(exclude_defaults=True)] and not project.applications:
        project.configurations = []
        report.add(Outcome.TRANSLATED, "task", f"task {_TASK}", f"{MAIN} is executed in every cycle of the controller")


_TASK = "MainTask"


def _given(name: str) -> Configuration:
    called = [PouInstance(name=name, type_name=name)]
    task = Task(name=_TASK, settings=TaskSettings(kind=FREEWHEELING), instances=called)
    return Configuration(name="Device", resources=[Resource(name="Application", tasks=[task])])


def executes_without_tasks(project: Project) -> bool:
    """True if PLC_PRG, which nothing calls yet, can execute what the tasks of a project execute.

    That is one task without an event, with programs that are called once each and without arguments.
    """
    tasks = _tasks(project)
    if len(tasks) != 1:
        return False
    schedule, instances = schedule_of(tasks[0]), tasks[0].instances
    if schedule.event is not None or schedule.kind not in ("", FREEWHEELING):
        return False
    names = [_program(instance).casefold() for instance in instances]
    if len({*names}) < len(names) or not {*names} <= _programs(project).keys():
        return False
    is_taken = MAIN.casefold() in {thing.name.casefold() for thing in project.objects()}
    has_arguments = any(any(texts_from("arguments", instance.extension_data)) for instance in instances)
    return not has_arguments and (not is_taken or names == [MAIN.casefold()])


def call_from_main(project: Project, host: ChartHost, report: ConversionReport, marks: SourceMarks) -> None:
    """Let PLC_PRG of `project`, a copy, call the programs of its one task."""
    (task,) = _tasks(project)
    names = [_program(instance) for instance in task.instances]
    interval = schedule_of(task).interval
    if interval is not None:
        why = f"{MAIN} is executed in every cycle of the controller: set {interval} as its cycle in {host.title}"
        report.add(Outcome.APPROXIMATED, "task", f"task {task.name}", why)
    else:
        why = f"{MAIN} is executed in every cycle of the controller"
        report.add(Outcome.TRANSLATED, "task", f"task {task.name}", why)
    add_main(project, names, report, marks)


def add_main(project: Project, names: Sequence[str], report: ConversionReport, marks: SourceMarks) -> None:
    """Add the program PLC_PRG, which calls others, unless it is the only one that is called."""
    if [name.casefold() for name in names] == [MAIN.casefold()]:
        return
    body = StBody(text="\n".join(f"{name}();" for name in names))
    program = Pou(name=MAIN, kind=PouKind.PROGRAM, interface=Interface(), bodies=[body])
    project.pous = [*project.pous, program]
    marks[id(program)] = added_pou(program)
    report.add(Outcome.TRANSLATED, "POU", program.report_path, f"it calls {', '.join(names)} in every cycle")


def _tasks(project: Project) -> list[Task]:
    return [task for task in project.tasks() if task.instances]


def _programs(project: Project) -> dict[str, str]:
    return {pou.name.casefold(): pou.name for pou in project.pous if pou.kind is PouKind.PROGRAM}


def _program(instance: PouInstance) -> str:
    """Return the program of an instance; that of CODESYS has the name of its program alone."""
    return instance.type_name or instance.name
