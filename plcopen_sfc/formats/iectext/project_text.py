"""Whole files: projects as text, and texts as projects, with configurations, resources, tasks and global variables."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field, replace
from functools import partial

from pydantic import ValidationError

from plcopen_sfc.errors import StructureError
from plcopen_sfc.formats.declaration_blocks import type_blocks
from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.iectext.chart_text_reader import apply_change
from plcopen_sfc.formats.iectext.pou_text_reader import read_pou
from plcopen_sfc.formats.iectext.pou_text_writer import write_pou
from plcopen_sfc.formats.iectext.text_declarations import (
    listing_text,
    read_listing,
    read_section,
    read_types,
    write_section_block,
    write_type_text,
)
from plcopen_sfc.formats.iectext.text_outline import KEYWORDS, POUS, PartKind, TextPart, outline
from plcopen_sfc.formats.iectext.text_printing import TextPrinter, comment_lines, foreign_pragmas, label, pragmas, split
from plcopen_sfc.formats.iectext.text_source import (
    INDENT,
    Annotations,
    TextSource,
    between_semicolons,
    indented,
    keep_data,
    keep_text,
    kept_texts,
)
from plcopen_sfc.formats.matiec.matiec_declarations import variable_names
from plcopen_sfc.formats.text_patch import WrittenBlock, numbered_blocks, plain_lines
from plcopen_sfc.languages.declarations import write_listing, write_variable
from plcopen_sfc.languages.declarations.kept_texts import texts_from, unwrapped, wrapped
from plcopen_sfc.languages.pragmas import Append, Fields, Named, RemainderEntry, Segment, changes, plain_fields
from plcopen_sfc.languages.st.lexer import Token, tokenize
from plcopen_sfc.languages.task_schedules import duration_literal, iec_form
from plcopen_sfc.model.checked import first_misfit
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource, Task
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.model.variables import ConfigSection, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.whole_numbers import whole_number

CONFIG_NAME = "Config"
ON_PLACE = "on"
_LIST_FIELDS = {"VAR_ACCESS": "access_variables", "VAR_CONFIG": "config_variables"}
_LISTS = frozenset({"resources", "global_variables", "access_variables", "config_variables", "tasks", "instances"})


def read_global_section(src: TextSource, part: TextPart, gap: tuple[int, int], place: str) -> list[Fields]:
    """Read a list of global variables with the changes of the pragmas before it."""
    sections = [plain_fields(section) for section in read_section(src, part, gap, place)]
    annotations = src.annotations(gap[0], part.start, place)
    for fields in sections[:1]:
        if _keep_typed(src, part, annotations, fields, gap):
            fields.pop("comment", None)
            fields.pop("extension_data", None)
        _change_others(src, annotations, fields, place)
    return sections


def _keep_typed(
    src: TextSource, part: TextPart, annotations: Annotations, fields: Fields, gap: tuple[int, int]
) -> bool:
    """Return True if a pragma tells to keep a declaration as it was typed, which is done then."""
    typed = [str(found.value) for found, _ in annotations.changes if found.path == _TYPED]
    if typed:
        start = src.core(*gap)[0]
        start += len(src.text[start : part.start]) - len(src.text[start : part.start].lstrip())
        fields["declaration"] = plain_lines(src.text[start : part.end]) + typed[0]
    return bool(typed)


def _change_others(src: TextSource, annotations: Annotations, fields: Fields, place: str) -> None:
    """Make the changes that the other pragmas before a declaration tell."""
    for found in annotations.changes:
        if found[0].path != _TYPED:
            apply_change(src, fields, found, place)


_TYPED = ("declaration_ends",)


def write_global_section(printer: TextPrinter, section: VariableSection, indent: str) -> WrittenBlock:
    """Write a list of global variables, with pragmas before it for the fields that its declaration lacks."""
    intended = plain_fields(section)
    key = ("global variables", section.name or "")
    typed = listing_text(printer, section, intended)
    if typed is not None:
        block, read_back = WrittenBlock(key, typed[0], apart=True), typed[1]
    else:
        block, read_back = write_section_block(printer, section, indent)
        block = replace(block, key=key, apart=True)
    above = pragmas(changes(read_back, intended), indent)
    return replace(block, text=above + block.whole(), blocks=()) if above else block


def read_configuration(src: TextSource, part: TextPart, gap: tuple[int, int]) -> tuple[Fields, bool]:
    """Read a configuration; True besides it if it is an application of CODESYS or TwinCAT."""
    annotations = src.annotations(*gap)
    application = any(c.path == ("application",) for c, _ in annotations.changes)
    return config_fields(src, part, gap), application


def write_configuration(printer: TextPrinter, configuration: Configuration) -> str:
    """``CONFIGURATION name .. END_CONFIGURATION``."""
    printer.note(Outcome.KEPT, "configuration", f"configuration {configuration.name}")
    writer = _ConfigurationWriter(printer)
    lines = writer.configuration(configuration, [])
    return lines.rstrip("\n")


def write_application(printer: TextPrinter, application: Resource) -> str:
    """Write an application of CODESYS or TwinCAT: a resource without a configuration, which gets one."""
    printer.note(
        Outcome.TRANSLATED, "application", f"application {application.name}", "a configuration with one resource"
    )
    writer = _ConfigurationWriter(printer)
    around = Configuration(name=application.name, resources=[application])
    return writer.configuration(around, [RemainderEntry(("application",), True)]).rstrip("\n")


def config_fields(src: TextSource, part: TextPart, gap: tuple[int, int]) -> Fields:
    """Return the fields of a configuration or a resource."""
    place = f"{part.kind.lower()} {part.name}"
    fields: Fields = {"name": part.name}
    annotations = src.annotations(*gap, place)
    position = part.inside[0]
    head = src.outline.tokens(part.head)
    if len(head) > 3 and head[-1].value != "PLC":
        fields["extension_data"] = {"data": [wrapped(ON_PLACE, head[-1].value)]}
    for inner in part.parts:
        here = (position, inner.start)
        position = inner.end
        if inner.kind is PartKind.VAR:
            _add_section(src, inner, here, fields, place)
        elif inner.kind is PartKind.RESOURCE:
            fields.setdefault("resources", []).append(config_fields(src, inner, here))
        else:
            _read_statements(src, inner, here, fields, place)
    if part.kind is PartKind.CONFIGURATION:
        alone = {name: fields.pop(name) for name in ("tasks", "instances") if name in fields}
        if alone:  # a configuration of one resource may leave its name and its keywords out
            fields.setdefault("resources", []).append({"name": ""} | alone)
    annotations.extend(src.annotations(position, part.inside[1], place))
    annotations.put_into(fields)
    for found in annotations.changes:
        if found[0].path != ("application",):
            apply_change(src, fields, found, place)
    return fields


def _add_section(src: TextSource, part: TextPart, gap: tuple[int, int], fields: Fields, place: str) -> None:
    name = _LIST_FIELDS.get(part.keyword)
    sections = read_listing(src, part, gap, place) if name else read_global_section(src, part, gap, place)
    if name is None:
        fields.setdefault("global_variables", []).extend(sections)
        return
    for section in sections:
        if name in fields:
            fields[name].setdefault("variables", []).extend(section.get("variables", []))
        else:
            fields[name] = section


def _read_statements(src: TextSource, part: TextPart, gap: tuple[int, int], fields: Fields, place: str) -> None:
    """``TASK ..;`` and ``PROGRAM ..;``."""
    position = gap[0]
    for tokens in between_semicolons(src.outline.tokens(part.tokens)):
        annotations = src.annotations(position, tokens[0].span[0], place)
        position = tokens[-1].span[1]
        word = tokens[0].value.upper()
        if word == "TASK" and len(tokens) > 1:
            fields.setdefault("tasks", []).append(_task(src, tokens, annotations, place))
        elif word == "PROGRAM" and len(tokens) > 1:
            _add_instance(src, tokens, annotations, fields, place)
        elif fields.get("resources") is None or tokens[0].type != "SEMICOLON":
            text = plain_lines(src.text[tokens[0].span[0] : position])
            src.note("IEC105", f"{text[:40]!r} is no task and no program instance", tokens[0].span[0], place)
            keep_text(fields, "statement", text)


def _task(src: TextSource, tokens: list[Token], annotations: Annotations, place: str) -> Fields:
    fields: Fields = {"name": tokens[1].value}
    keyword, value = "", tokens[:0]
    for token in [*tokens[3:], None]:
        if token is None or token.type == "COMMA" or token is tokens[-1]:
            if keyword and value:
                text = plain_lines(src.text[value[0].span[0] : value[-1].span[1]])
                if keyword == "PRIORITY" and (number := whole_number(text)) is not None:
                    fields |= {"priority": number} if number else {}
                elif keyword in ("SINGLE", "INTERVAL"):
                    fields[keyword.lower()] = text
                else:
                    keep_text(fields, keyword, text)
            keyword, value = "", []
        elif token.type == "ASSIGN" and not keyword:
            keyword, value = value[0].value.upper() if value else "", []
        else:
            value = [*value, token]
    read_back = {name: fields.get(name) for name in ("interval", "single")}
    fields = _with_annotations(src, fields, annotations, place)
    if "settings" in fields:
        try:
            form = iec_form(Task.model_validate(fields | {"instances": []}))
        except ValidationError:
            return fields  # what is wrong is told of the whole project
        if read_back != {"interval": duration_literal(form["interval"]), "single": form["single"]}:
            fields.update(read_back)  # edited since the settings of CODESYS were put beside it
            del fields["settings"]
    return fields


def _add_instance(src: TextSource, tokens: list[Token], annotations: Annotations, fields: Fields, place: str) -> None:
    instance: Fields = {"name": tokens[1].value}
    rest = tokens[2:]
    task = ""
    if len(rest) > 1 and rest[0].value.upper() == "WITH":
        task, rest = rest[1].value, rest[2:]
    if len(rest) > 1 and rest[0].type == "COLON":
        end = next((i for i, token in enumerate(rest) if token.type == "LPAR"), len(rest))
        type_name = src.text[rest[1].span[0] : rest[end - 1].span[1]]
        if type_name != instance["name"]:
            instance["type_name"] = type_name
        if end < len(rest):
            text = plain_lines(src.text[rest[end].span[0] : rest[-1].span[1]])
            instance["extension_data"] = {"data": [wrapped("arguments", text)]}
    instance = _with_annotations(src, instance, annotations, place)
    for known in fields.get("tasks", []):
        if task and known["name"].casefold() == task.casefold():
            known.setdefault("instances", []).append(instance)
            return
    if task:
        src.note("IEC106", f"there is no task {task!r} in this resource", tokens[0].span[0], place)
        keep_text(instance, "with", task)
    fields.setdefault("instances", []).append(instance)


def _with_annotations(src: TextSource, fields: Fields, annotations: Annotations, place: str) -> Fields:
    annotations.put_into(fields)
    for found in annotations.changes:
        apply_change(src, fields, found, place)
    return fields


@dataclass(slots=True)
class _ConfigurationWriter:
    printer: TextPrinter
    late: list[RemainderEntry] = field(default_factory=list)

    def configuration(self, configuration: Configuration, extra: list[RemainderEntry]) -> str:
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
            shown = write_listing(configuration.access_variables, self.printer.dialect)
            text += self._listing("access_variables", shown, plain_fields(configuration.access_variables))
        if configuration.config_variables is not None:
            shown = write_listing(configuration.config_variables, self.printer.dialect)
            text += self._listing("config_variables", shown, plain_fields(configuration.config_variables))
        return text + ("\n" + pragmas(self.late, INDENT) if self.late else "") + "END_CONFIGURATION\n"

    def _listing(self, name: str, section: str, intended: Fields) -> str:
        """``VAR_ACCESS`` or ``VAR_CONFIG``, unless it does not come back from text."""
        lines = indented(section, INDENT) + "\n"
        src = TextSource(outline(f"CONFIGURATION x\n{lines}END_CONFIGURATION\n", self.printer.dialect))
        if not src.outline.problems and [p.kind for p in src.outline.parts[0].parts] == [PartKind.VAR]:
            read_back = config_fields(src, src.outline.parts[0], (0, 0)).get(name)
            if read_back is not None and not src.diagnostics:
                self.late += changes(read_back, intended, (name,))
                return "\n" + lines
        self.late.append(RemainderEntry((name,), intended))
        return ""

    def _resource(self, resource: Resource, place: list[Segment] | None) -> str:
        name = self._name(resource.name)
        processor = next(texts_from(ON_PLACE, resource.extension_data), "PLC")
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
        return "".join(f"{write_global_section(self.printer, section, indent).whole()}\n" for section in sections)

    def _kept(self, thing: Resource | PouInstance) -> list[tuple[str, str]]:
        data = thing.extension_data.data if thing.extension_data is not None else []
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
        extra: list[RemainderEntry] | None = None,
        read_back: Fields | None = None,
    ) -> str:
        """Return the lines above a thing: its comment and the fields that its text lacks. Big data goes to the end."""
        intended = plain_fields(thing, leave=_LISTS)
        read_back = Fields(name=name) | (read_back or {})
        text = comment_lines(intended, read_back, indent) if str(intended.get("comment", "")).strip() else ""
        text += foreign_pragmas(intended, read_back, indent)
        if isinstance(thing, Resource):
            for found, data in zip(self._kept(thing), intended.get("extension_data", {}).get("data", []), strict=False):
                if found[0] == ON_PLACE:
                    keep_data(read_back, data)
        near, late = split([*(extra or []), *changes(read_back, intended)])
        for change in (*near, *late):
            self.printer.note(Outcome.EXTENSION_DATA, label(change), thing.name, "IEC text has no place for it")
        if place is None:
            near += late
        else:
            self.late += [RemainderEntry((*place, *change.path), change.value, change.instead) for change in late]
        return text + pragmas(near, indent)

    def _task(self, task: Task, indent: str) -> str:
        name = self._name(task.name)
        read_back: Fields = {}
        arguments = []
        form = iec_form(task)
        for keyword, shown in (("SINGLE", form["single"]), ("INTERVAL", duration_literal(form["interval"]))):
            if shown is not None and self._is_argument(shown):
                arguments.append(f"{keyword} := {shown}")
                read_back[keyword.lower()] = shown
        if task.priority >= 0:
            arguments.append(f"PRIORITY := {task.priority}")
            read_back |= {"priority": task.priority} if task.priority else {}
        text = self._top(task, name, indent, read_back=read_back) + f"{indent}TASK {name}({', '.join(arguments)});\n"
        return text + "".join(self._instance(instance, name, indent) for instance in task.instances)

    def _is_argument(self, text: str) -> bool:
        tokens = tokenize(text, self.printer.dialect, KEYWORDS).tokens
        plain = all(t.type not in ("COMMA", "LPAR", "RPAR") and t.type not in KEYWORDS for t in tokens)
        return self.printer.is_expression(text) and plain

    def _instance(self, instance: PouInstance, task: str | None, indent: str) -> str:
        name = self._name(instance.name)
        type_name = instance.type_name if self.printer.is_name(instance.type_name) else name
        read_back: Fields = {} if type_name == name else {"type_name": type_name}
        arguments = next(texts_from("arguments", instance.extension_data), "")
        if arguments:
            read_back["extension_data"] = {"data": [wrapped("arguments", arguments)]}
        text = self._top(instance, name, indent, read_back=read_back)
        within = f" WITH {task}" if task is not None else ""
        return f"{text}{indent}PROGRAM {name}{within} : {type_name}{arguments and f' {arguments}'};\n"


_DIALECT = re.compile(r"\{\s*plcopen_sfc\s+project\.dialect\s*:=\s*'(\w+)'\s*\}")


def read_project(text: str, file: str | None) -> tuple[Project, TextSource]:
    """Read the project of a text."""
    src = TextSource(outline(text, dialect_of(text)), file)
    for problem in src.outline.structure:
        src.note("IEC101", problem.message, problem.span[0])
    annotations = Annotations()
    fields: Fields = {}
    pous: list[Pou] = []
    position = 0
    for part in src.outline.parts:
        gap = (_project_changes(src, position, part.start, annotations), part.start)
        position = part.end
        if part.kind in POUS:
            pous.append(read_pou(src, part, gap))
        else:
            _read_unit(src, part, gap, fields)
    for problem in src.outline.found.problems:  # those in bodies were reported with their bodies
        if not any(start <= problem.span[0] < end for start, end in src.checked):
            src.note("IEC100", problem.message, problem.span[0])
    annotations.extend(src.annotations(position, len(text)))
    annotations.put_into(fields)
    for found, offset in annotations.changes:
        if found.path[0] == "project" and len(found.path) > 1:
            apply_change(src, fields, (RemainderEntry(found.path[1:], found.value, found.instead), offset), "project")
    try:
        project = Project.model_validate(fields | {"pous": pous})
    except ValidationError as error:
        first = error.errors()[0]
        message = first_misfit(error)
        path = ("project", *first["loc"])
        offsets = (offset for found, offset in annotations.changes if found.path == path[: len(found.path)])
        raise StructureError(message, location=src.location(next(offsets, 0))) from error
    return project, src


def _read_unit(src: TextSource, part: TextPart, gap: tuple[int, int], fields: Fields) -> None:
    types = _read_types(src, part, gap) if part.kind is PartKind.TYPE else []
    if types:
        fields.setdefault("data_types", []).extend(types)
    elif part.kind is PartKind.VAR and part.keyword == "VAR_CONFIG":
        for section in read_listing(src, part, gap, ""):
            known = fields.setdefault("config_variables", section)
            if known is not section:
                known.setdefault("variables", []).extend(section.get("variables", []))
    elif part.kind is PartKind.VAR and part.keyword == "VAR_GLOBAL":
        fields.setdefault("global_variables", []).extend(read_global_section(src, part, gap, ""))
    elif part.kind is PartKind.CONFIGURATION:
        found, application = read_configuration(src, part, gap)
        also = found.keys() - {"name", "resources"}
        if application and len(found.get("resources", ())) == 1 and not also:
            fields.setdefault("applications", []).extend(found["resources"])
        else:
            fields.setdefault("configurations", []).append(found)
    else:
        if part.kind is PartKind.LOOSE:
            src.note("IEC107", "this belongs to no unit: PROGRAM, FUNCTION_BLOCK, FUNCTION, TYPE ..", part.start)
        keep_text(fields, "unit", plain_lines(src.text[gap[0] : part.end]).strip())


def _read_types(src: TextSource, part: TextPart, gap: tuple[int, int]) -> list[Fields]:
    types = read_types(src, part, gap)
    annotations = src.annotations(*gap)
    for fields in types[:1]:
        _keep_typed(src, part, annotations, fields, gap)
        _change_others(src, annotations, fields, f"data type {fields.get('name', '')}")
    return types


def _project_changes(src: TextSource, start: int, end: int, annotations: Annotations) -> int:
    """Take the pragmas about the project, and return where the rest of the gap begins."""
    for comment in src.outline.comments(start, end):
        found = src.annotations(*comment.span)
        if not found.changes or found.changes[0][0].path[0] not in ("project", "format"):
            break
        annotations.extend(found)
        start = comment.span[1]
    return start


def dialect_of(text: str) -> Dialect:
    """Return the dialect that a text gives as its own."""
    found = _DIALECT.search(text)
    try:
        return Dialect(found.group(1)) if found is not None else Dialect.IEC
    except ValueError:
        return Dialect.IEC


VERSION = 1
_UNITS = frozenset({"pous", "data_types", "global_variables", "configurations", "applications", "config_variables"})


def write_project(project: Project, _options: WriteOptions, report: ConversionReport) -> WrittenBlock:
    """Return the text of a project."""
    printer = TextPrinter(project.dialect, report, variables=frozenset(variable_names(project)))
    read_back: Fields = {}
    intended = plain_fields(project, leave=_UNITS)
    foreign = _foreign_units(intended, read_back)
    found = [RemainderEntry(("project", *c.path), c.value, c.instead) for c in changes(read_back, intended)]
    for change in found:
        printer.note(
            Outcome.EXTENSION_DATA, str(change.path[1]).replace("_", " "), "project", "IEC text has no place for it"
        )
    near, late = split(found)
    late += [change for change in near if Append() in change.path]
    near = [change for change in near if Append() not in change.path]
    pieces = [WrittenBlock(("head", ""), pragmas([RemainderEntry(("format",), VERSION), *near], "").rstrip("\n"))]
    pieces += [WrittenBlock(("unit", ""), text, apart=True) for text in foreign]
    names = Counter(one.name.casefold() for one in project.data_types)
    for declaration in project.data_types:
        text = _type(printer, declaration, late, unique=names[declaration.name.casefold()] == 1)
        member = partial(write_variable, dialect=printer.dialect, indent=" " * 8)
        blocks = tuple(type_blocks(text, declaration, member))
        pieces.append(WrittenBlock(("type", declaration.name), "" if blocks else text, blocks, apart=True))
    pieces += [write_global_section(printer, section, "") for section in project.global_variables]
    pieces += [write_pou(printer, pou) for pou in project.pous]
    for configuration in project.configurations:
        text = write_configuration(printer, configuration)
        pieces.append(WrittenBlock(("configuration", configuration.name), text, apart=True))
    for application in project.applications:
        text = write_application(printer, application)
        pieces.append(WrittenBlock(("configuration", application.name), text, apart=True))
    if project.config_variables is not None:
        text = _config_section(printer, project.config_variables, late)
        pieces.append(WrittenBlock(("VAR_CONFIG", ""), text, apart=True))
    if late:
        pieces.append(WrittenBlock(("late", ""), pragmas(late, "").rstrip("\n"), apart=True))
    return WrittenBlock(("project", ""), blocks=numbered_blocks(pieces))


def _foreign_units(intended: Fields, read_back: Fields) -> list[str]:
    """Units that the model has no place for, as they were read."""
    texts: list[str] = []
    for _, text, data in (kept for kept in kept_texts(intended) if kept[0] == "unit"):
        known = read_back.get("extension_data", {}).get("data", [])
        back = read_project("\n\n".join([*texts, text, ""]), None)[0].extension_data
        if back is not None and [one.content for one in back.data] == [one["content"] for one in (*known, data)]:
            texts.append(text)
            keep_data(read_back, data)
    return texts


def _config_section(printer: TextPrinter, section: ConfigSection, late: list[RemainderEntry]) -> str:
    """``VAR_CONFIG`` outside of a configuration; empty where it does not come back from text."""
    intended = plain_fields(section)
    text = comment_lines(intended, {}, "") if str(intended.get("comment", "")).strip() else ""
    text += write_listing(section, printer.dialect)
    back, src = read_project(
        f"{pragmas([RemainderEntry(('project', 'dialect'), str(printer.dialect))], '')}{text}\n", None
    )
    if back.config_variables is None or src.diagnostics:
        late.append(RemainderEntry(("project", "config_variables"), intended))
        return ""
    late += changes(plain_fields(back.config_variables), intended, ("project", "config_variables"))
    return text


def _type(printer: TextPrinter, declaration: DataTypeDeclaration, late: list[RemainderEntry], *, unique: bool) -> str:
    text, read_back, intended = write_type_text(printer, declaration)
    printer.note(Outcome.KEPT, "data type", f"data type {declaration.name}")
    near, far = split(changes(read_back, intended))
    if unique:
        place = ("project", "data_types", Named(declaration.name))
        late += [RemainderEntry((*place, *change.path), change.value, change.instead) for change in far]
    else:
        near += far
    return pragmas(near, "") + text
