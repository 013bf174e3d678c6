"""Reads configurations, resources, tasks and lists of global variables. The writer is `config_writer`."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.formats.durations import duration_literal
from plcopen_sfc.formats.iectext.chart_reader import change
from plcopen_sfc.formats.iectext.declarations_reader import read_listing, read_section
from plcopen_sfc.formats.iectext.layout import newlines
from plcopen_sfc.formats.iectext.outline import Kind, Part
from plcopen_sfc.formats.iectext.source import Remark, Source, wrapped
from plcopen_sfc.formats.tasks import iec_form
from plcopen_sfc.languages.pragmas import Fields
from plcopen_sfc.languages.st.lexer import Token
from plcopen_sfc.model.project import Task

CONFIG_NAME = "Config"
ON_PLACE = "on"
_LISTS = {"VAR_ACCESS": "access_variables", "VAR_CONFIG": "config_variables"}


def read_global_section(src: Source, part: Part, gap: tuple[int, int], place: str) -> list[Fields]:
    """A list of global variables with what pragmas before it say."""
    sections = read_section(src, part, gap, place)
    remark = src.remark(gap[0], part.start, place)
    for fields in sections[:1]:
        typed = [c for c, _ in remark.changes if c.path == ("declaration_ends",)]
        if typed:
            start = src.core(*gap)[0]
            start += len(src.text[start : part.start]) - len(src.text[start : part.start].lstrip())
            fields["declaration"] = newlines(src.text[start : part.end]) + str(typed[0].value)
            fields.pop("comment", None)
            fields.pop("carried", None)
        for found, offset in remark.changes:
            if found.path != ("declaration_ends",):
                change(src, fields, (found, offset), place)
    return sections


def read_configuration(src: Source, part: Part, gap: tuple[int, int]) -> tuple[Fields, bool]:
    """A configuration, and whether it stands for an application of CODESYS or TwinCAT."""
    remark = src.remark(*gap)
    application = any(c.path == ("application",) for c, _ in remark.changes)
    return config_fields(src, part, gap), application


def config_fields(src: Source, part: Part, gap: tuple[int, int]) -> Fields:
    """The fields of a configuration or a resource."""
    place = f"{part.kind.lower()} {part.name}"
    fields: Fields = {"name": part.name}
    remark = src.remark(*gap, place)
    position = part.inside[0]
    head = src.outline.tokens(part.head)
    if len(head) > 3 and head[-1].value != "PLC":
        fields["carried"] = {"data": [wrapped(ON_PLACE, head[-1].value)]}
    for inner in part.parts:
        here = (position, inner.start)
        position = inner.end
        if inner.kind is Kind.VAR:
            _add_section(src, inner, here, fields, place)
        elif inner.kind is Kind.RESOURCE:
            fields.setdefault("resources", []).append(config_fields(src, inner, here))
        else:
            _read_statements(src, inner, here, fields, place)
    if part.kind is Kind.CONFIGURATION:
        alone = {name: fields.pop(name) for name in ("tasks", "instances") if name in fields}
        if alone:  # a configuration of one resource may leave its name and its keywords out
            fields.setdefault("resources", []).append({"name": ""} | alone)
    remark.extend(src.remark(position, part.inside[1], place))
    remark.put_into(fields)
    for found in remark.changes:
        if found[0].path != ("application",):
            change(src, fields, found, place)
    return fields


def _add_section(src: Source, part: Part, gap: tuple[int, int], fields: Fields, place: str) -> None:
    name = _LISTS.get(part.keyword)
    sections = read_listing(src, part, gap, place) if name else read_global_section(src, part, gap, place)
    if name is None:
        fields.setdefault("global_variables", []).extend(sections)
        return
    for section in sections:
        if name in fields:
            fields[name].setdefault("variables", []).extend(section.get("variables", []))
        else:
            fields[name] = section


def _read_statements(src: Source, part: Part, gap: tuple[int, int], fields: Fields, place: str) -> None:
    """``TASK ..;`` and ``PROGRAM ..;``."""
    position = gap[0]
    for tokens in _statements(src.outline.tokens(part.tokens)):
        remark = src.remark(position, tokens[0].span[0], place)
        position = tokens[-1].span[1]
        word = tokens[0].value.upper()
        if word == "TASK" and len(tokens) > 1:
            fields.setdefault("tasks", []).append(_task(src, tokens, remark, place))
        elif word == "PROGRAM" and len(tokens) > 1:
            _add_instance(src, tokens, remark, fields, place)
        elif fields.get("resources") is None or tokens[0].type != "SEMICOLON":
            text = newlines(src.text[tokens[0].span[0] : position])
            src.note("IEC105", f"{text[:40]!r} is no task and no program instance", tokens[0].span[0], place)
            fields.setdefault("carried", {}).setdefault("data", []).append(wrapped("statement", text))


def _statements(tokens: list[Token]) -> Iterator[list[Token]]:
    group: list[Token] = []
    for token in tokens:
        if token.type == "SEMICOLON":
            if group:
                yield group
            group = []
        else:
            group.append(token)
    if group:
        yield group


def _task(src: Source, tokens: list[Token], remark: Remark, place: str) -> Fields:
    fields: Fields = {"name": tokens[1].value}
    keyword, value = "", tokens[:0]
    for token in [*tokens[3:], None]:
        if token is None or token.type == "COMMA" or token is tokens[-1]:
            if keyword and value:
                text = newlines(src.text[value[0].span[0] : value[-1].span[1]])
                if keyword == "PRIORITY" and text.isdecimal():
                    fields |= {"priority": int(text)} if int(text) else {}
                elif keyword in ("SINGLE", "INTERVAL"):
                    fields[keyword.lower()] = text
                else:
                    fields.setdefault("carried", {}).setdefault("data", []).append(wrapped(keyword, text))
            keyword, value = "", []
        elif token.type == "ASSIGN" and not keyword:
            keyword, value = value[0].value.upper() if value else "", []
        else:
            value = [*value, token]
    said = {name: fields.get(name) for name in ("interval", "single")}
    fields = _with_remark(src, fields, remark, place)
    if "settings" in fields:
        form = iec_form(Task.model_validate(fields | {"instances": []}))
        if said != {"interval": duration_literal(form["interval"]), "single": form["single"]}:
            fields.update(said)  # edited since the settings of CODESYS were put beside it
            del fields["settings"]
    return fields


def _add_instance(src: Source, tokens: list[Token], remark: Remark, fields: Fields, place: str) -> None:
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
            text = newlines(src.text[rest[end].span[0] : rest[-1].span[1]])
            instance["carried"] = {"data": [wrapped("arguments", text)]}
    instance = _with_remark(src, instance, remark, place)
    for known in fields.get("tasks", []):
        if task and known["name"].casefold() == task.casefold():
            known.setdefault("instances", []).append(instance)
            return
    if task:
        src.note("IEC106", f"there is no task {task!r} in this resource", tokens[0].span[0], place)
        instance.setdefault("carried", {}).setdefault("data", []).append(wrapped("with", task))
    fields.setdefault("instances", []).append(instance)


def _with_remark(src: Source, fields: Fields, remark: Remark, place: str) -> Fields:
    remark.put_into(fields)
    for found in remark.changes:
        change(src, fields, found, place)
    return fields
