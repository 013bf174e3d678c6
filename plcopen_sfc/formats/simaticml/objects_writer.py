"""Writes blocks, data blocks, data types and tag tables. The reader is `objects_reader`."""

from __future__ import annotations

from typing import Any

from lxml import etree

from plcopen_sfc.formats.simaticml.added import keep_added
from plcopen_sfc.formats.simaticml.bodies_reader import block_language
from plcopen_sfc.formats.simaticml.bodies_writer import language_of, write_units
from plcopen_sfc.formats.simaticml.coils import types_of
from plcopen_sfc.formats.simaticml.interface_writer import spelling, write_interface, write_members
from plcopen_sfc.formats.simaticml.objects_reader import (
    CONSTANT,
    DATA_BLOCKS,
    DATA_TYPE,
    POUS,
    SETTING_TEXTS,
    SETTINGS,
    TAG,
    TAG_TABLE,
)
from plcopen_sfc.formats.simaticml.results import bodies_with_result
from plcopen_sfc.formats.simaticml.rewritten import WRITTEN, of_interface
from plcopen_sfc.formats.simaticml.sections import holds_constants
from plcopen_sfc.formats.simaticml.types import write_type
from plcopen_sfc.formats.simaticml.writing import (
    ID,
    WriteContext,
    add_element,
    finish,
    flag,
    sub,
    write_object_text,
)
from plcopen_sfc.languages.s7_globals import UNCALLED
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.pou import DataBlock, Pou, PouKind
from plcopen_sfc.model.project import Tag, TagTable
from plcopen_sfc.model.sfc import GraphSettings, SfcNetwork
from plcopen_sfc.model.types import DataTypeDeclaration, EnumType, SimpleValue, StructType, Variable
from plcopen_sfc.model.variables import Interface
from plcopen_sfc.report import Outcome

_POU_TAGS = {kind: tag for tag, kind in POUS.items()}
_DATA_BLOCK_TAGS = {kind: tag for tag, kind in DATA_BLOCKS.items()}
_MARKED = frozenset({"Name"})
"""Attributes that the model has even where they are more than text in the file, and so are kept too."""
_TEXTS = frozenset({"name", "number", "title", "comment"})


class _Object:
    """An object that is being written: its attributes by name, which are sorted at the end, and its objects."""

    def __init__(self, ctx: WriteContext, parent: etree._Element, tag: str, thing: Element, role: str = "") -> None:
        self.ctx = ctx
        self.thing = thing
        self.element = sub(parent, tag, {ID: ""} | ({"CompositionName": role} if role else {}))
        self.values = sub(self.element, "AttributeList")
        self.objects = sub(self.element, "ObjectList")
        self.set("Name", getattr(thing, "name", ""))
        number = getattr(thing, "number", None)
        if number is not None:
            self.set("Number", str(number))

    def set(self, name: str, value: str) -> None:
        """Write an attribute, unless it has a value already."""
        if self.values.find(name) is None:
            sub(self.values, name).text = value or None

    def finish(
        self, native: frozenset[str], *, told: frozenset[str] = frozenset(), also: dict[str, Any] | None = None
    ) -> None:
        """Write what was kept, sort the attributes as TIA Portal does, and carry what is left."""
        carried = self.thing.carried
        for name, value in carried.attributes.items() if carried is not None else ():
            if name.startswith("@"):
                owner, _, mark = name[1:].rpartition("@")
                {"AttributeList": self.values, "ObjectList": self.objects}.get(owner, self.element).set(mark, value)
            elif name not in ("Datatype", ID):
                self.set(name, value)
        for content in carried.elements if carried is not None else ():
            holder = etree.Element("holder")
            add_element(self.ctx, holder, content)
            for element in list(holder):
                own = self.values.find(str(element.tag)) if element.get(ID) is None else None
                if own is not None and own.tag in _MARKED and element.attrib:
                    self.values.remove(own)
                (self.objects if element.get(ID) is not None else self.values).append(element)
        self.values[:] = sorted(self.values, key=lambda value: str(value.tag).lower())
        write_object_text(self.ctx, self.objects, "Title", getattr(self.thing, "title", None))
        if not len(self.objects):
            self.element.remove(self.objects)
        finish(self.ctx, self.element, self.thing, native | _TEXTS, told=told, also=also)


def write_pou(ctx: WriteContext, parent: etree._Element, pou: Pou) -> None:
    """Write a code block. A program becomes a function block: TIA Portal has none."""
    writer = _Object(ctx, parent, _POU_TAGS.get(pou.kind, "SW.Blocks.FB"), pou)
    ctx.place.append(f"POU {pou.name}")
    ctx.body_name = pou.name
    ctx.types = types_of(ctx.project, pou)
    sections = pou.interface.sections if pou.interface is not None else []
    constants = [variable for section in sections if holds_constants(section) for variable in section.variables]
    ctx.constants = frozenset(f"#{variable.name.lower()}" for variable in constants)
    native = {"interface", "bodies"}
    if pou.kind in _POU_TAGS:
        native.add("kind")
        ctx.keep("POU")
    else:
        what = "program" if pou.kind is PouKind.PROGRAM else "POU"
        why = "a function block; no organization block calls it, and it has no instance data block"
        ctx.note(Outcome.NOT_EXECUTED, what, why=why)
    chart = next((body for body in pou.bodies if isinstance(body, SfcBody)), None)
    if pou.interface is not None:
        static = pou.kind is not PouKind.FUNCTION or ctx.keeps_sections
        write_interface(ctx, writer.values, pou.interface, _renamed(ctx, pou), graph=chart is not None, static=static)
    elif chart is not None:
        keep_added(write_interface(ctx, writer.values, Interface(), graph=True))
    kept = pou.carried.attributes.get("ProgrammingLanguage") if pou.carried is not None else None
    writer.set("ProgrammingLanguage", kept or block_language([language_of(body) for body in pou.bodies]) or "LAD")
    if chart is not None and ctx.body_name not in ctx.options.untouched:
        _settings(writer, chart.chart.graph_settings)
    write_object_text(ctx, writer.objects, "Comment", pou.comment)
    ctx.actions_told = set()
    for body in bodies_with_result(pou):
        write_units(ctx, writer.objects, body)
    for action in pou.actions:
        if action.body is not None and action.name.casefold() not in ctx.actions_told:
            is_called = id(action) in ctx.called_actions
            why = "blocks of TIA Portal have no actions: what calls it does not execute it" if is_called else UNCALLED
            outcome = Outcome.NOT_EXECUTED if is_called else Outcome.EXTENSION_DATA
            ctx.note(outcome, "POU action", f"action {action.name}", why)
    for method in pou.methods:
        why = "blocks of TIA Portal have no methods: what calls it does not execute it"
        ctx.note(Outcome.NOT_EXECUTED, "method", f"method {method.name}", why)
    writer.finish(frozenset(native), told=frozenset({"kind", "actions", "methods"}))
    if writer.values.findtext("ProgrammingLanguage") != "GRAPH":
        _without_graph(writer.values)
    ctx.place.pop()


def _without_graph(values: etree._Element) -> None:
    """Take the base of GRAPH out of the interface of a block that was one: only those have it."""
    for section in list(values.iterfind("Interface/{*}Sections/{*}Section[@Name='Base']")):
        if section.find("{*}Sections[@Datatype='GRAPH_BASE']") is not None:
            section.getparent().remove(section)  # type: ignore[union-attr]  # it has one


def _settings(writer: _Object, settings: GraphSettings | None) -> None:
    if settings is None:
        settings = GraphSettings()
    for name, field in SETTINGS.items():
        truth = getattr(settings, field)
        if truth is not None:
            writer.set(name, flag(truth))
    for name, field in SETTING_TEXTS.items():
        text = getattr(settings, field)
        if text is not None:
            writer.set(name, text)


def _renamed(ctx: WriteContext, pou: Pou) -> dict[str, str]:
    """New names of the static members that belong to steps and transitions, where these were renamed."""
    baseline = ctx.options.baseline
    before = next((p for p in baseline.pous if p.name == pou.name), None) if baseline is not None else None
    if before is None or before.chart is None or pou.name in ctx.options.untouched or pou.chart is None:
        return {}
    old = _chart_names(before.chart)
    new = _chart_names(pou.chart)
    return {old[key]: new[key] for key in old.keys() & new.keys() if old[key] != new[key]}


def _chart_names(chart: SfcNetwork) -> dict[int, str]:
    """The names of steps and transitions by id."""
    return {step.id: step.name for step in chart.steps} | {t.id: t.name for t in chart.transitions}


def write_data_block(ctx: WriteContext, parent: etree._Element, block: DataBlock) -> None:
    """Write a data block."""
    writer = _Object(ctx, parent, _DATA_BLOCK_TAGS[block.kind], block)
    ctx.place.append(f"data block {block.name}")
    if block.interface is not None:
        write_interface(ctx, writer.values, block.interface)
    if block.type_name is not None:
        writer.set("InstanceOfName", block.type_name)
    kept = block.carried.attributes.get("ProgrammingLanguage") if block.carried is not None else None
    writer.set("ProgrammingLanguage", kept or "DB")
    ctx.keep("data block")
    write_object_text(ctx, writer.objects, "Comment", block.comment)
    writer.finish(frozenset({"kind", "interface", "type_name"}))
    ctx.place.pop()


def write_data_type(ctx: WriteContext, parent: etree._Element, declaration: DataTypeDeclaration) -> None:
    """Write a PLC data type. TIA Portal has structures only."""
    writer = _Object(ctx, parent, DATA_TYPE, declaration)
    ctx.place.append(f"type {declaration.name}")
    native = {"type"}
    also: dict[str, Any] = {}
    if isinstance(declaration.type, StructType):
        kept = declaration.carried.elements if declaration.carried is not None else []
        if declaration.type.members or not any(content.startswith("<Interface ") for content in kept):
            write_members(ctx, writer.values, declaration.type)
        ctx.keep("data type")
    else:
        native.discard("type")
        held = Variable(name="Value", type=ctx.s7_types.type(declaration.type))
        write_members(ctx, writer.values, StructType(members=[held]))
        written = of_interface(writer.values[-1])
        also[WRITTEN] = {"type": written, "initial": written}
        why = f"its variables are of the type {write_type(held.type)}"
        if isinstance(declaration.type, EnumType):
            why += "; its values are user constants"
        ctx.note(Outcome.TRANSLATED, "data type", why=why)
    write_object_text(ctx, writer.objects, "Comment", declaration.comment)
    writer.finish(frozenset(native), told=frozenset({"type", "initial"}), also=also)
    ctx.place.pop()


def write_tag_table(ctx: WriteContext, parent: etree._Element, table: TagTable) -> None:
    """Write a tag table."""
    writer = _Object(ctx, parent, TAG_TABLE, table)
    ctx.place.append(f"tag table {table.name}")
    for tag in table.tags:
        _tag(ctx, writer.objects, tag)
    for constant in table.constants:
        _constant(ctx, writer.objects, constant)
    ctx.keep("tag table")
    writer.finish(frozenset({"tags", "constants"}))
    ctx.place.pop()


def _tag(ctx: WriteContext, parent: etree._Element, tag: Tag) -> None:
    writer = _Object(ctx, parent, TAG, tag, "Tags")
    writer.set("DataTypeName", tag.type)
    if tag.address is not None:
        writer.set("LogicalAddress", tag.address)
    write_object_text(ctx, writer.objects, "Comment", tag.comment)
    writer.finish(frozenset({"type", "address"}))


def _constant(ctx: WriteContext, parent: etree._Element, constant: Variable) -> None:
    writer = _Object(ctx, parent, CONSTANT, constant, "UserConstants")
    kept = constant.carried.attributes if constant.carried is not None else {}
    writer.set("DataTypeName", spelling(constant.type, kept))
    native = {"type"}
    if isinstance(constant.initial, SimpleValue):
        writer.set("Value", constant.initial.text or "")
        native.add("initial")
    write_object_text(ctx, writer.objects, "Comment", constant.comment)
    writer.finish(frozenset(native))
