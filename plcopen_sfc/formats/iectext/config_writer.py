"""Writes configurations, resources, tasks and lists of global variables. The reader is `config_reader`."""

from __future__ import annotations

from dataclasses import dataclass, field

from plcopen_sfc.formats.durations import duration_literal
from plcopen_sfc.formats.iectext.config_reader import CONFIG_NAME, ON_PLACE, config_fields
from plcopen_sfc.formats.iectext.declarations_writer import said_listing, write_said_section
from plcopen_sfc.formats.iectext.layout import INDENT, indented
from plcopen_sfc.formats.iectext.outline import KEYWORDS, Kind, outline
from plcopen_sfc.formats.iectext.printing import Printer, comment_lines, foreign_pragmas, label, pragmas, split
from plcopen_sfc.formats.iectext.source import Source, unwrapped, wrapped
from plcopen_sfc.formats.tasks import iec_form
from plcopen_sfc.languages.declarations import write_access_section, write_config_section
from plcopen_sfc.languages.pragmas import Change, Fields, changes, plain_fields
from plcopen_sfc.languages.pragmas.remainder import Named, Segment
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.model.project import Configuration, PouInstance, Resource, Task
from plcopen_sfc.model.variables import VariableSection
from plcopen_sfc.report import Outcome

_LISTS = frozenset({"resources", "global_variables", "access_variables", "config_variables", "tasks", "instances"})


def write_configuration(printer: Printer, configuration: Configuration) -> str:
    """``CONFIGURATION name .. END_CONFIGURATION``."""
    printer.note(Outcome.KEPT, "configuration", f"configuration {configuration.name}")
    writer = _Writer(printer)
    lines = writer.configuration(configuration, [])
    return lines.rstrip("\n")


def write_application(printer: Printer, application: Resource) -> str:
    """An application of CODESYS or TwinCAT: a resource without a configuration, which gets one."""
    printer.note(
        Outcome.TRANSLATED, "application", f"application {application.name}", "a configuration with one resource"
    )
    writer = _Writer(printer)
    around = Configuration(name=application.name, resources=[application])
    return writer.configuration(around, [Change(("application",), True)]).rstrip("\n")


def write_global_section(printer: Printer, section: VariableSection, indent: str) -> str:
    """A list of global variables, with what its declaration does not say before it."""
    meant = plain_fields(section)
    typed = said_listing(printer, section, meant)
    text, said = typed if typed is not None else write_said_section(printer, section, indent)
    return pragmas(changes(said, meant), indent) + text + "\n"


@dataclass(slots=True)
class _Writer:
    printer: Printer
    late: list[Change] = field(default_factory=list)

    def configuration(self, configuration: Configuration, extra: list[Change]) -> str:
        resources = configuration.resources
        name = self._name(configuration.name)
        top = self._top(configuration, name, "", place=[], extra=extra)
        text = f"{top}CONFIGURATION {name}\n"
        text += self._sections(configuration.global_variables, INDENT)
        unique = len({resource.name.casefold() for resource in resources}) == len(resources)
        for resource in resources:
            place: list[Segment] | None = ["resources", Named(resource.name)] if unique else None
            text += "\n" + self._resource(resource, place)
        if configuration.access_variables is not None:
            shown = write_access_section(configuration.access_variables, self.printer.dialect)
            text += self._listing("access_variables", shown, plain_fields(configuration.access_variables))
        if configuration.config_variables is not None:
            shown = write_config_section(configuration.config_variables, self.printer.dialect)
            text += self._listing("config_variables", shown, plain_fields(configuration.config_variables))
        return text + ("\n" + pragmas(self.late, INDENT) if self.late else "") + "END_CONFIGURATION\n"

    def _listing(self, name: str, section: str, meant: Fields) -> str:
        """``VAR_ACCESS`` or ``VAR_CONFIG``, unless it does not come back from text."""
        lines = indented(section, INDENT) + "\n"
        src = Source(outline(f"CONFIGURATION x\n{lines}END_CONFIGURATION\n", self.printer.dialect))
        if not src.outline.problems and [p.kind for p in src.outline.parts[0].parts] == [Kind.VAR]:
            said = config_fields(src, src.outline.parts[0], (0, 0)).get(name)
            if said is not None and not src.diagnostics:
                self.late += changes(said, meant, (name,))
                return "\n" + lines
        self.late.append(Change((name,), meant))
        return ""

    def _resource(self, resource: Resource, place: list[Segment] | None) -> str:
        name = self._name(resource.name)
        processor = next((kept[1] for kept in self._kept(resource) if kept[0] == ON_PLACE), "PLC")
        text = self._top(resource, name, INDENT, place=place)
        text += f"{INDENT}RESOURCE {name} ON {processor}\n"
        inner = INDENT * 2
        text += self._sections(resource.global_variables, inner)
        for task in resource.tasks:
            text += self._task(task, inner)
        for instance in resource.instances:
            text += self._instance(instance, None, inner)
        return text + f"{INDENT}END_RESOURCE\n"

    def _sections(self, sections: list[VariableSection], indent: str) -> str:
        return "".join(write_global_section(self.printer, section, indent) for section in sections)

    def _kept(self, resource: Resource) -> list[tuple[str, str]]:
        data = resource.carried.data if resource.carried is not None else []
        return [kept for kept in (unwrapped(one.content) for one in data) if kept is not None]

    def _name(self, name: str) -> str:
        return name if self.printer.is_name(name) else self.printer.new_name(name or CONFIG_NAME)

    def _top(
        self,
        thing: Configuration | Resource | Task | PouInstance,
        name: str,
        indent: str,
        *,
        place: list[Segment] | None = None,
        extra: list[Change] | None = None,
        said: Fields | None = None,
    ) -> str:
        """The lines above a thing: its comment and what its text does not say. Big data waits for the end."""
        meant = plain_fields(thing, leave=_LISTS)
        said = Fields(name=name) | (said or {})
        text = comment_lines(meant, said, indent) if str(meant.get("comment", "")).strip() else ""
        text += foreign_pragmas(meant, said, indent)
        if isinstance(thing, Resource):
            for found, data in zip(self._kept(thing), meant.get("carried", {}).get("data", []), strict=False):
                if found[0] == ON_PLACE:
                    said.setdefault("carried", {}).setdefault("data", []).append(data)
        near, late = split([*(extra or []), *changes(said, meant)])
        for change in (*near, *late):
            self.printer.note(Outcome.EXTENSION_DATA, label(change), thing.name, "IEC text cannot say it")
        if place is None:
            near += late
        else:
            self.late += [Change((*place, *change.path), change.value, change.instead) for change in late]
        return text + pragmas(near, indent)

    def _task(self, task: Task, indent: str) -> str:
        name = self._name(task.name)
        said: Fields = {}
        arguments = []
        form = iec_form(task)
        for keyword, shown in (("SINGLE", form["single"]), ("INTERVAL", duration_literal(form["interval"]))):
            if shown is not None and self._is_argument(shown):
                arguments.append(f"{keyword} := {shown}")
                said[keyword.lower()] = shown
        if task.priority >= 0:
            arguments.append(f"PRIORITY := {task.priority}")
            said |= {"priority": task.priority} if task.priority else {}
        text = self._top(task, name, indent, said=said) + f"{indent}TASK {name}({', '.join(arguments)});\n"
        return text + "".join(self._instance(instance, name, indent) for instance in task.instances)

    def _is_argument(self, text: str) -> bool:
        tokens = tokenize(text, self.printer.dialect, KEYWORDS).tokens
        plain = all(t.type not in ("COMMA", "LPAR", "RPAR") and t.type not in KEYWORDS for t in tokens)
        return self.printer.is_expression(text) and plain

    def _instance(self, instance: PouInstance, task: str | None, indent: str) -> str:
        name = self._name(instance.name)
        type_name = instance.type_name if self.printer.is_name(instance.type_name) else name
        said: Fields = {} if type_name == name else {"type_name": type_name}
        data = instance.carried.data if instance.carried is not None else []
        kept = [found for found in (unwrapped(each.content) for each in data) if found is not None]
        arguments = next((words for place, words in kept if place == "arguments"), "")
        if arguments:
            said["carried"] = {"data": [wrapped("arguments", arguments)]}
        text = self._top(instance, name, indent, said=said)
        within = f" WITH {task}" if task is not None else ""
        return f"{text}{indent}PROGRAM {name}{within} : {type_name}{arguments and f' {arguments}'};\n"
