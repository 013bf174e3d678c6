"""Text that matiec compiles, of a project that `formats.matiec` has fitted."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.formats.iectext.text_source import INDENT, indented
from plcopen_sfc.formats.matiec.matiec_project import pous_in_order
from plcopen_sfc.formats.matiec.matiec_statements import compilable_comments, plain_comment
from plcopen_sfc.languages.declarations import write_data_type, write_section, write_type, write_value
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.model.actions import ActionAssociation, Qualifier
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.body import Body, IlBody, SfcBody, StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource, Task
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition
from plcopen_sfc.model.text import plain
from plcopen_sfc.model.variables import SectionKind, VariableSection

_KEYWORDS = {
    PouKind.FUNCTION: "FUNCTION",
    PouKind.FUNCTION_BLOCK: "FUNCTION_BLOCK",
    PouKind.PROGRAM: "PROGRAM",
    PouKind.ORGANIZATION_BLOCK: "PROGRAM",
}


def compiled_text(project: Project) -> str:
    """Return the whole text."""
    units = [write_data_type(declaration, Dialect.IEC) for declaration in project.data_types]
    units += [_pou(pou) for pou in pous_in_order(project)]
    units += [_configuration(configuration) for configuration in project.configurations]
    return compilable_comments("\n\n".join(units) + "\n", Dialect.IEC)


def _comment(thing: Element, indent: str) -> str:
    text = plain(thing.comment).strip()
    return indented(f"(* {plain_comment(text)} *)", indent) + "\n" if text else ""


def _pou(pou: Pou) -> str:
    keyword = _KEYWORDS[pou.kind]
    head = f"{keyword} {pou.name}"
    interface = pou.interface
    if interface is not None and interface.return_type is not None:
        head += f" : {write_type(interface.return_type)}"
    parts = [_section(section) for section in interface.sections] if interface is not None else []
    body = pou.body
    if isinstance(body, SfcBody):
        parts += _chart(body.chart, pou)
    elif body is not None:
        parts.append(indented(_text(body), INDENT))
    return "\n".join([_comment(pou, "") + head, "\n\n".join(parts), f"END_{keyword}"])


def _text(body: Body) -> str:
    return body.text.strip("\n") if isinstance(body, StBody | IlBody) else ""


def _section(section: VariableSection, indent: str = INDENT) -> str:
    """Return a section of variables; external ones have their values where they are declared."""
    if section.kind is SectionKind.EXTERNAL:
        section = section.model_copy(deep=True)
        for variable in section.variables:
            variable.initial = variable.address = None
    return write_section(section, Dialect.IEC, indent)


# -- charts -----------------------------------------------------------------------------------------------------------


def _chart(chart: SfcNetwork, pou: Pou) -> Iterator[str]:
    """Steps first, then the transitions that name them, then the actions."""
    names = {step.id: step.name for step in chart.steps}
    yield from (_step(step) for step in chart.steps)
    yield from (_transition(transition, names) for transition in chart.transitions if transition.sources)
    for action in pou.actions:
        if action.body is not None:
            lines = indented(_text(action.body), INDENT * 2)
            yield f"{_comment(action, INDENT)}{INDENT}ACTION {action.name}:\n{lines}\n{INDENT}END_ACTION"


def _step(step: Step) -> str:
    keyword = "INITIAL_STEP" if step.initial else "STEP"
    lines = [f"{_comment(step, INDENT)}{INDENT}{keyword} {step.name}:"]
    lines += [f"{_comment(one, INDENT * 2)}{INDENT * 2}{_association(one)};" for one in step.actions]
    return "\n".join([*lines, f"{INDENT}END_STEP"])


def _association(found: ActionAssociation) -> str:
    arguments = [] if found.qualifier is Qualifier.NONE else [found.qualifier.value]
    arguments += [text for text in (found.duration, found.indicator) if text]
    return f"{found.target}({', '.join(arguments)})"


def _transition(transition: Transition, names: dict[int, str]) -> str:
    head = f"TRANSITION {transition.name}".rstrip()
    if transition.priority is not None and transition.priority >= 0:
        head += f" (PRIORITY := {transition.priority})"
    head += f" FROM {_steps(transition.sources, names)} TO {_steps(transition.targets, names)}"
    text = transition.condition.text if isinstance(transition.condition, Expression) else ""
    condition = indented(f":= {text};", INDENT * 2)
    return f"{_comment(transition, INDENT)}{INDENT}{head}\n{condition}\n{INDENT}END_TRANSITION"


def _steps(ids: list[int], names: dict[int, str]) -> str:
    found = [names[i] for i in ids if i in names]
    return found[0] if len(found) == 1 else f"({', '.join(found)})"


# -- configurations ---------------------------------------------------------------------------------------------------


def _configuration(configuration: Configuration) -> str:
    lines = [f"{_comment(configuration, '')}CONFIGURATION {configuration.name}"]
    lines += [_section(section) for section in configuration.global_variables]
    lines += [_resource(resource) for resource in configuration.resources]
    if configuration.config_variables is not None:
        lines.append(f"{INDENT}VAR_CONFIG")
        for variable in configuration.config_variables.variables:
            address = f" AT {variable.address}" if variable.address else ""
            value = f" := {write_value(variable.initial)}" if variable.initial is not None else ""
            lines.append(f"{INDENT * 2}{variable.path}{address} : {write_type(variable.type)}{value};")
        lines.append(f"{INDENT}END_VAR")
    return "\n".join([*lines, "END_CONFIGURATION"])


def _resource(resource: Resource) -> str:
    lines = [f"{INDENT}RESOURCE {resource.name} ON PLC"]
    lines += [_section(section, INDENT * 2) for section in resource.global_variables]
    lines += [_task(task) for task in resource.tasks]
    lines += [_instance(instance, f" WITH {task.name}") for task in resource.tasks for instance in task.instances]
    lines += [_instance(instance, "") for instance in resource.instances]
    return "\n".join([*lines, f"{INDENT}END_RESOURCE"])


def _task(task: Task) -> str:
    arguments = [f"SINGLE := {task.single}"] if task.single else []
    arguments += [f"INTERVAL := {task.interval}"] if task.interval else []
    return f"{INDENT * 2}TASK {task.name}({', '.join([*arguments, f'PRIORITY := {max(task.priority, 0)}'])});"


def _instance(instance: PouInstance, task: str) -> str:
    return f"{INDENT * 2}PROGRAM {instance.name}{task} : {instance.type_name};"
