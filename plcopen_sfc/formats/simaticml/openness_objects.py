"""Blocks, data blocks, data types and tag tables, read and written."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any

from lxml import etree

from plcopen_sfc.formats.format_interface import may_have
from plcopen_sfc.formats.simaticml.action_controls import (
    ControlPlanner,
    are_rows_alone,
    are_shared,
    told_late_actions,
)
from plcopen_sfc.formats.simaticml.action_functions import ActionFunctions
from plcopen_sfc.formats.simaticml.action_rows import functions_of
from plcopen_sfc.formats.simaticml.added_elements import bodies_with_result, is_added, mark_added, name_result
from plcopen_sfc.formats.simaticml.block_interfaces import (
    read_interface,
    read_members,
    spelled_as,
    spelling,
    write_interface,
    write_members,
)
from plcopen_sfc.formats.simaticml.coils_and_contacts import types_of
from plcopen_sfc.formats.simaticml.compile_units import block_language, language_of, read_units, write_units
from plcopen_sfc.formats.simaticml.control_statements import FlagTexts
from plcopen_sfc.formats.simaticml.declaration_spelling import holds_constants, read_type, write_type
from plcopen_sfc.formats.simaticml.element_reader import (
    TRUTHS,
    DocumentReading,
    Fields,
    child_named,
    children,
    keep_attribute,
    keep_element,
    keep_rest,
    local,
    merge_fields,
    plain_text,
    read_comments,
    read_objects,
)
from plcopen_sfc.formats.simaticml.element_writer import ID, DocumentWriting, finish, kept_parts, sub, write_object_text
from plcopen_sfc.formats.simaticml.graph_reader import CONTROLLED, are_controls_edited
from plcopen_sfc.formats.simaticml.replaced_elements import WRITTEN, counting_fields, interface_digest
from plcopen_sfc.formats.xml.extension_data import attributes, attributes_of, boolean, elements_of
from plcopen_sfc.languages.s7_globals import UNCALLED, local_tags
from plcopen_sfc.languages.s7_programs import report_program
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.chart_settings import GraphSettings
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, DataBlock, DataBlockKind, Method, Pou, PouKind
from plcopen_sfc.model.project import Tag, TagTable
from plcopen_sfc.model.sfc import SfcBody, SfcNetwork
from plcopen_sfc.model.types import DataTypeDeclaration, EnumType, SimpleValue, StructType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, sections_of
from plcopen_sfc.report import CHART_OF_ACTION, ORDER_OF_ACTIONS, Outcome
from plcopen_sfc.whole_numbers import canonical_number

POUS = {
    "SW.Blocks.FB": PouKind.FUNCTION_BLOCK,
    "SW.Blocks.FC": PouKind.FUNCTION,
    "SW.Blocks.OB": PouKind.ORGANIZATION_BLOCK,
}
DATA_BLOCKS = {
    "SW.Blocks.GlobalDB": DataBlockKind.GLOBAL,
    "SW.Blocks.InstanceDB": DataBlockKind.INSTANCE,
    "SW.Blocks.ArrayDB": DataBlockKind.ARRAY,
}
DATA_TYPE = "SW.Types.PlcStruct"
TAG_TABLE = "SW.Tags.PlcTagTable"
TAG = "SW.Tags.PlcTag"
CONSTANT = "SW.Tags.PlcUserConstant"
ROLES = {TAG: "Tags", CONSTANT: "UserConstants"}
"""Collections of objects; those of a document are in none."""
SETTINGS = {
    "AcknowledgeErrorsRequired": "acknowledge_errors_required",
    "LockOperatingMode": "lock_operating_mode",
    "PermanentILProcessingInMANMode": "permanent_interlock_processing_in_manual_mode",
    "SkipSteps": "skip_steps",
    "WithAlarmHandling": "with_alarm_handling",
}
"""Attributes of GRAPH blocks that are Booleans, and the fields of `GraphSettings` for them."""
SETTING_TEXTS = {
    "GraphVersion": "version",
    "InitialValuesAcquisition": "initial_values_acquisition",
    "LanguageInNetworks": "network_language",
}
_POU_TAGS = {kind: tag for tag, kind in POUS.items()}
_DATA_BLOCK_TAGS = {kind: tag for tag, kind in DATA_BLOCKS.items()}
_MARKED = frozenset({"Name"})
"""Attributes that the model has even where they are more than text in the file, and so are kept too."""
_TEXTS = frozenset({"name", "number", "title", "comment"})


def read_pou(ctx: DocumentReading, element: etree._Element) -> Fields:
    """Read a code block."""
    fields: Fields = {"kind": POUS[local(element)], "bodies": []}
    values = _start(ctx, element, fields)
    interface = values.pop("Interface", None)
    ctx.edited_controls = are_controls_edited(element)
    if interface is not None:
        read = read_interface(ctx, interface)
        if read != {"sections": []} or not is_added(interface):
            fields["interface"] = read
        ctx.types = {
            f"#{m.get('Name', '').lower()}": m.get("Datatype", "") for m in interface.iterfind("*/*/{*}Member")
        }
        ctx.constants = frozenset(
            f"#{m.get('Name', '').lower()}" for m in interface.iterfind("*/*[@Name='Constant']/{*}Member")
        )
    language = _take(values, "ProgrammingLanguage")
    units = read_objects(element, fields, "SW.Blocks.CompileUnit")
    late: Fields = {}
    fields["bodies"], unit_language = read_units(ctx, units, late)
    if fields.get("interface", {}).get("return_type") is not None:
        name_result(fields["bodies"], fields["name"])
    if any(isinstance(body, SfcBody) for body in fields["bodies"]):
        late["graph_settings"] = _read_settings(values)
    if language is not None and language != unit_language:
        keep_attribute(fields, "ProgrammingLanguage", language)
    return _end(ctx, element, fields, values)


def write_pou(ctx: DocumentWriting, parent: etree._Element, pou: Pou) -> None:
    """Write a code block. A program becomes a function block: TIA Portal has none."""
    writer = _Object(ctx, parent, _POU_TAGS.get(pou.kind, "SW.Blocks.FB"), pou)
    functions = functions_of(ctx)
    chart_of_action = functions.charts.get(pou.name.casefold())
    if chart_of_action is not None:
        ctx.place += [f"POU {chart_of_action.owner.name}", f"action {chart_of_action.action.name}"]
    else:
        ctx.place.append(f"POU {pou.name}")
    ctx.body_name, ctx.pou = pou.name, pou
    ctx.types = types_of(ctx.project, pou)
    sections = sections_of(pou.interface)
    constants = [variable for section in sections if holds_constants(section) for variable in section.variables]
    ctx.constants = frozenset(f"#{variable.name.lower()}" for variable in constants)
    ctx.tags = local_tags(ctx.project).get(pou.name.casefold(), {})
    native = {"interface", "bodies"}
    if pou.kind in _POU_TAGS:
        native.add("kind")
        ctx.keep("POU")
    elif pou.kind is PouKind.PROGRAM:
        report_program(ctx.project, pou, ctx.report)
    chart = next((body for body in pou.bodies if isinstance(body, SfcBody)), None)
    mark = ctx.options.marks.get(id(pou), {})
    _write_interface_of(ctx, writer.values, pou, functions, chart.chart if chart is not None else None)
    kept = attributes_of(pou.extension_data).get("ProgrammingLanguage")
    writer.set("ProgrammingLanguage", kept or block_language([language_of(body) for body in pou.bodies]) or "LAD")
    if chart is not None and ctx.body_name not in ctx.options.untouched:
        _write_settings(writer, chart.chart.graph_settings)
    write_object_text(ctx, writer.objects, "Comment", pou.comment)
    ctx.actions_reported = set()
    for body in bodies_with_result(pou):
        write_units(ctx, writer.objects, body)
    if chart_of_action is not None:
        writer.finish(frozenset({*native, "actions", "transitions"}))
        del ctx.place[-2:]
        return
    for action in pou.actions:
        if action.body is not None:
            _note_action(ctx, functions, action)
    for method in pou.methods:
        _note_method(ctx, functions, pou, method)
    if "actions" in mark:  # the charts of some are others than in the source
        writer.thing = pou.model_copy(update={"actions": mark["actions"]})
    writer.finish(frozenset(native), reported=frozenset({"kind", "actions", "methods"}))
    if writer.values.findtext("ProgrammingLanguage") != "GRAPH":
        _without_graph(writer.values)
    ctx.place.pop()


def _write_interface_of(
    ctx: DocumentWriting, values: etree._Element, pou: Pou, functions: ActionFunctions, chart: SfcNetwork | None
) -> None:
    """Write the interface of a code block, with the variables that TIA Portal wants for its chart and its actions."""
    added = functions.instances(pou)
    if ctx.options.of_codesys and any(each.owner.name == pou.name for each in functions.charts.values()):
        why = (
            "charts in actions show a new step one call later in CODESYS: where such an action ends just then, the step"
            " acts before it ends in TIA Portal, and when it begins again in CODESYS"
        )
        ctx.note(Outcome.APPROXIMATED, CHART_OF_ACTION, why=why)
    # the controls look for the types of operands, and add variables that rows name
    ctx.types |= {f"#{variable.name.lower()}": write_type(variable.type) for variable in added}
    ctx.action_controls = None
    if chart is not None and _may_have_controls(ctx):
        added += _planned_controls(ctx, pou, chart, functions)
        chart_of_action = functions.charts.get(pou.name.casefold())
        if chart_of_action is not None:
            added += _memories(ctx, chart_of_action.owner, pou, chart)
        ctx.types |= {f"#{variable.name.lower()}": write_type(variable.type) for variable in added}
    marked = ctx.options.marks.get(id(pou), {}).get("variables", [])
    added += marked
    if pou.interface is None:
        if chart is not None:
            mark_added(write_interface(ctx, values, Interface(), graph=True, added=added))
        return
    inside = functions.kept_inside(pou) if not ctx.keeps_sections else frozenset[str]()
    for name in (v.name for v in pou.variables(SectionKind.INPUT) if v.name.casefold() in inside):
        why = "a static variable, as no input is an instance and none passes it"
        ctx.note(Outcome.TRANSLATED, "section", name, why)
    write_interface(
        ctx,
        values,
        _without(pou.interface, marked),
        _renamed(ctx, pou),
        graph=chart is not None,
        static=pou.kind is not PouKind.FUNCTION or ctx.keeps_sections,
        added=added,
        kept_inside=inside,
    )


def _planned_controls(ctx: DocumentWriting, pou: Pou, chart: SfcNetwork, functions: ActionFunctions) -> list[Variable]:
    """Plan the networks that control actions, and return the variables that they add to the block."""
    mark = ctx.options.marks.get(id(chart), {})
    flags = FlagTexts(mark.get("lines", ()), mark.get("ends", ()), mark.get("stops", ""))
    alone, shared = are_rows_alone(ctx.options), are_shared(ctx.options)
    in_turn = ctx.options.of_matiec
    planner = ControlPlanner(
        ctx.project, pou, chart, functions, alone=alone, shared=shared, flags=flags, in_turn=in_turn
    )
    controls = planner.plan()
    ctx.action_controls = controls
    for label in controls.going_on:
        why = "it goes on where an SFC flag stops the chart, or ends a step: no network controls it"
        ctx.note(Outcome.NOT_EXECUTED, "SFC flags", f"action {label}", why)
    if told := told_late_actions(pou, chart, controls, ctx.options):
        ctx.note(Outcome.APPROXIMATED, ORDER_OF_ACTIONS, why=told)
    return controls.variables


def _memories(ctx: DocumentWriting, owner: Pou, block: Pou, chart: SfcNetwork) -> list[Variable]:
    """Return the variables that only the statements of the flags of a chart use: no parameter passes them."""
    text = "\n".join(ctx.options.marks.get(id(chart), {}).get("lines", ()))
    used = {token.value.removeprefix("#").casefold() for token in tokenize(text, Dialect.SCL).tokens}
    passed = {variable.name.casefold() for variable in block.variables()}
    added = ctx.options.marks.get(id(owner), {}).get("variables", ())
    return [each for each in added if each.name.casefold() in used - passed]


def _without(interface: Interface, added: Collection[Variable]) -> Interface:
    """Return an interface without sections of these variables, which are written for themselves."""
    ids = set(map(id, added))
    sections = [each for each in interface.sections if not each.variables or id(each.variables[0]) not in ids]
    return interface.model_copy(update={"sections": sections}) if ids else interface


def _note_action(ctx: DocumentWriting, functions: ActionFunctions, action: Action) -> None:
    """Report the outcome of an action of the block that is written, where no step has told it."""
    outcome, why = Outcome.EXTENSION_DATA, UNCALLED
    if id(action) in ctx.lost_actions:
        outcome, why = Outcome.NOT_EXECUTED, "blocks of TIA Portal have no actions: what calls it does not execute it"
    elif action.name.casefold() in ctx.actions_reported or id(action) in functions.told:
        return
    elif id(action) in functions.calls.reached:
        outcome, why = Outcome.TRANSLATED, "its statements are in place of the calls of it"
    elif id(action) in ctx.called_actions:
        outcome, why = Outcome.NOT_EXECUTED, "what calls it is not executed"
    ctx.note(outcome, "POU action", f"action {action.name}", why)


def _note_method(ctx: DocumentWriting, functions: ActionFunctions, pou: Pou, method: Method) -> None:
    """Report the outcome of a method of the block that is written."""
    made = functions.method(pou, method)
    if isinstance(made, str):
        outcome, why = Outcome.NOT_EXECUTED, f"blocks of TIA Portal have no methods, and no function holds it: {made}"
    else:
        outcome = Outcome.TRANSLATED
        why = f"it is the function {made.name}, with the variables of the block that it uses"
    ctx.note(outcome, "method", f"method {method.name}", why)


def _may_have_controls(ctx: DocumentWriting) -> bool:
    """True unless the chart stays as TIA Portal wrote it."""
    return ctx.body_name not in ctx.options.untouched or may_have(ctx.options.source, CONTROLLED)


def _without_graph(values: etree._Element) -> None:
    """Take the base of GRAPH out of the interface of a block that was one: only those have it."""
    for section in list(values.iterfind("Interface/{*}Sections/{*}Section[@Name='Base']")):
        if section.find("{*}Sections[@Datatype='GRAPH_BASE']") is not None:
            section.getparent().remove(section)  # type: ignore[union-attr]  # it has one


def _renamed(ctx: DocumentWriting, pou: Pou) -> dict[str, str]:
    """New names of the static members that belong to steps and transitions, where these were renamed."""
    baseline = ctx.options.baseline
    before = next((p for p in baseline.pous if p.name == pou.name), None) if baseline is not None else None
    if before is None or before.chart is None or pou.name in ctx.options.untouched or pou.chart is None:
        return {}
    old = _chart_names(before.chart)
    new = _chart_names(pou.chart)
    return {old[key]: new[key] for key in old.keys() & new.keys() if old[key] != new[key]}


def _chart_names(chart: SfcNetwork) -> dict[int, str]:
    """Return the names of steps and transitions by id."""
    return {step.id: step.name for step in chart.steps} | {t.id: t.name for t in chart.transitions}


def _read_settings(values: dict[str, etree._Element]) -> Fields:
    settings: Fields = {}
    for name, field in SETTINGS.items():
        truth = TRUTHS.get(plain_text(values.get(name)) or "")
        if truth is not None:
            settings[field] = truth
            del values[name]
    for name, field in SETTING_TEXTS.items():
        text = plain_text(values.get(name))
        if text is not None:
            settings[field] = text
            del values[name]
    return settings


def _write_settings(writer: _Object, settings: GraphSettings | None) -> None:
    if settings is None:
        settings = GraphSettings()
    for name, field in SETTINGS.items():
        truth = getattr(settings, field)
        if truth is not None:
            writer.set(name, boolean(truth))
    for name, field in SETTING_TEXTS.items():
        text = getattr(settings, field)
        if text is not None:
            writer.set(name, text)


def read_data_block(ctx: DocumentReading, element: etree._Element) -> Fields:
    """Read a data block."""
    fields: Fields = {"kind": DATA_BLOCKS[local(element)]}
    values = _start(ctx, element, fields)
    interface = values.pop("Interface", None)
    if interface is not None:
        fields["interface"] = read_interface(ctx, interface)
    fields["type_name"] = _take(values, "InstanceOfName")
    if plain_text(values.get("ProgrammingLanguage")) == "DB":
        del values["ProgrammingLanguage"]
    read_objects(element, fields)
    return _end(ctx, element, fields, values)


def write_data_block(ctx: DocumentWriting, parent: etree._Element, block: DataBlock) -> None:
    """Write a data block."""
    writer = _Object(ctx, parent, _DATA_BLOCK_TAGS[block.kind], block)
    ctx.place.append(f"data block {block.name}")
    if block.interface is not None:
        write_interface(ctx, writer.values, block.interface)
    if block.type_name is not None:
        writer.set("InstanceOfName", block.type_name)
    kept = attributes_of(block.extension_data).get("ProgrammingLanguage")
    writer.set("ProgrammingLanguage", kept or "DB")
    ctx.keep("data block")
    write_object_text(ctx, writer.objects, "Comment", block.comment)
    writer.finish(frozenset({"kind", "interface", "type_name"}))
    ctx.place.pop()


def read_data_type(ctx: DocumentReading, element: etree._Element) -> Fields:
    """Read a PLC data type."""
    fields: Fields = {"type": {"kind": "struct", "members": []}}
    values = _start(ctx, element, fields)
    interface = values.get("Interface")
    members = read_members(ctx, interface) if interface is not None else None
    if members is not None:
        fields["type"] = members
        del values["Interface"]
    read_objects(element, fields)
    digest = interface_digest(interface) if interface is not None else ""
    return _end(ctx, element, fields, values, {"type": digest, "initial": digest})


def write_data_type(ctx: DocumentWriting, parent: etree._Element, declaration: DataTypeDeclaration) -> None:
    """Write a PLC data type. TIA Portal has structures only."""
    writer = _Object(ctx, parent, DATA_TYPE, declaration)
    ctx.place.append(f"type {declaration.name}")
    native = {"type"}
    also: dict[str, Any] = {}
    if isinstance(declaration.type, StructType):
        kept = elements_of(declaration.extension_data)
        if declaration.type.members or not any(content.startswith("<Interface ") for content in kept):
            write_members(ctx, writer.values, declaration.type)
        ctx.keep("data type")
    else:
        native.discard("type")
        held = Variable(name="Value", type=ctx.s7_types.type(declaration.type))
        write_members(ctx, writer.values, StructType(members=[held]))
        written = interface_digest(writer.values[-1])
        also[WRITTEN] = {"type": written, "initial": written}
        why = f"its variables are of the type {write_type(held.type)}"
        if isinstance(declaration.type, EnumType):
            why += "; its values are user constants"
        ctx.note(Outcome.TRANSLATED, "data type", why=why)
    write_object_text(ctx, writer.objects, "Comment", declaration.comment)
    writer.finish(frozenset(native), reported=frozenset({"type", "initial"}), also=also)
    ctx.place.pop()


def read_tag_table(ctx: DocumentReading, element: etree._Element) -> Fields:
    """Read a tag table with its tags and user constants."""
    fields: Fields = {"tags": [], "constants": []}
    values = _start(ctx, element, fields)
    for child in read_objects(element, fields, TAG, CONSTANT):
        if local(child) == TAG:
            fields["tags"].append(_read_tag(ctx, child))
        else:
            fields["constants"].append(_read_constant(ctx, child))
    return _end(ctx, element, fields, values)


def write_tag_table(ctx: DocumentWriting, parent: etree._Element, table: TagTable) -> None:
    """Write a tag table."""
    writer = _Object(ctx, parent, TAG_TABLE, table)
    ctx.place.append(f"tag table {table.name}")
    for tag in table.tags:
        _write_tag(ctx, writer.objects, tag)
    for constant in table.constants:
        _write_constant(ctx, writer.objects, constant)
    ctx.keep("tag table")
    writer.finish(frozenset({"tags", "constants"}))
    ctx.place.pop()


def _read_tag(ctx: DocumentReading, element: etree._Element) -> Fields:
    fields: Fields = {}
    values = _start(ctx, element, fields)
    fields["type"] = _take(values, "DataTypeName") or ""
    fields["address"] = _take(values, "LogicalAddress")
    read_objects(element, fields)
    return _end(ctx, element, fields, values)


def _write_tag(ctx: DocumentWriting, parent: etree._Element, tag: Tag) -> None:
    writer = _Object(ctx, parent, TAG, tag, "Tags")
    writer.set("DataTypeName", tag.type)
    if tag.address is not None:
        writer.set("LogicalAddress", tag.address)
    write_object_text(ctx, writer.objects, "Comment", tag.comment)
    writer.finish(frozenset({"type", "address"}))


def _read_constant(ctx: DocumentReading, element: etree._Element) -> Fields:
    fields: Fields = {}
    values = _start(ctx, element, fields)
    spelled = _take(values, "DataTypeName") or ""
    fields["type"] = read_type(spelled)
    if spelled_as(fields["type"]) != spelled:
        keep_attribute(fields, "Datatype", spelled)
    value = _take(values, "Value")
    if value is not None:
        fields["initial"] = {"kind": "simple", "text": value}
    read_objects(element, fields)
    return _end(ctx, element, fields, values)


def _write_constant(ctx: DocumentWriting, parent: etree._Element, constant: Variable) -> None:
    writer = _Object(ctx, parent, CONSTANT, constant, "UserConstants")
    kept = attributes_of(constant.extension_data)
    writer.set("DataTypeName", spelling(constant.type, kept))
    native = {"type"}
    if isinstance(constant.initial, SimpleValue):
        writer.set("Value", constant.initial.text or "")
        native.add("initial")
    write_object_text(ctx, writer.objects, "Comment", constant.comment)
    writer.finish(frozenset(native))


def _start(ctx: DocumentReading, element: etree._Element, fields: Fields) -> dict[str, etree._Element]:
    """Return the attributes of an object by name; its name and number are read."""
    holder = child_named(element, "AttributeList")
    values: dict[str, etree._Element] = {}
    for child in children(holder) if holder is not None else ():
        if local(child) in values:
            keep_element(fields, child)
        else:
            values[local(child)] = child
    name = values.get("Name")
    fields["name"] = (name.text or "") if name is not None else ""
    _take(values, "Name")
    ctx.place.append(f"{local(element).rpartition('.')[2]} {fields['name']}")
    number = canonical_number(plain_text(values.get("Number")))
    if number is not None:
        fields["number"] = number
        del values["Number"]
    return values


def _end(
    ctx: DocumentReading,
    element: etree._Element,
    fields: Fields,
    values: dict[str, etree._Element],
    digests: dict[str, str] | None = None,
) -> Fields:
    """Keep the attributes that were not read, and put back the fields in comments as long as `digests` fit."""
    for name, value in values.items():
        text = plain_text(value)
        if text is not None:
            keep_attribute(fields, name, text)
        else:
            keep_element(fields, value)
    keep_rest(fields, element)
    for key, mark in attributes(element).items():
        if key not in ("ID", "CompositionName") or (key == "CompositionName" and ROLES.get(local(element)) != mark):
            keep_attribute(fields, f"@{key}", mark)
    kept: Fields = {}
    read_comments(ctx, element, kept)
    merge_fields(fields, counting_fields(ctx, kept, digests or {}, element))
    ctx.place.pop()
    return fields


def _take(values: dict[str, etree._Element], name: str) -> str | None:
    """Take the text of a plain attribute; one that is more than text is left, and so kept."""
    text = plain_text(values.get(name))
    if text is not None:
        del values[name]
    return text


class _Object:
    """An object that is being written: its attributes by name, which are sorted at the end, and its objects."""

    def __init__(self, ctx: DocumentWriting, parent: etree._Element, tag: str, thing: Element, role: str = "") -> None:
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
        self, native: frozenset[str], *, reported: frozenset[str] = frozenset(), also: dict[str, Any] | None = None
    ) -> None:
        """Write what was kept, sort the attributes as TIA Portal does, and carry the fields that are left."""
        for name, value in attributes_of(self.thing.extension_data).items():
            if name.startswith("@"):
                owner, _, mark = name[1:].rpartition("@")
                {"AttributeList": self.values, "ObjectList": self.objects}.get(owner, self.element).set(mark, value)
            elif name not in ("Datatype", ID):
                self.set(name, value)
        for element in kept_parts(self.ctx, self.thing.extension_data):
            own = self.values.find(str(element.tag)) if element.get(ID) is None else None
            if own is not None and own.tag in _MARKED and element.attrib:
                self.values.remove(own)
            (self.objects if element.get(ID) is not None else self.values).append(element)
        self.values[:] = sorted(self.values, key=lambda value: str(value.tag).lower())
        write_object_text(self.ctx, self.objects, "Title", getattr(self.thing, "title", None))
        if not len(self.objects):
            self.element.remove(self.objects)
        finish(self.ctx, self.element, self.thing, native | _TEXTS, reported=reported, also=also)


Thing = Pou | DataBlock | DataTypeDeclaration | TagTable
"""An object of a document."""


@dataclass(frozen=True)
class ObjectKind:
    """Kind of the objects of a document: their class, the field of a project with them, their reader and writer."""

    model: type[Thing]
    field: str
    read: Callable[[DocumentReading, etree._Element], Fields]
    write: Callable[[DocumentWriting, etree._Element, Any], None]


_POU = ObjectKind(Pou, "pous", read_pou, write_pou)
_DATA_BLOCK = ObjectKind(DataBlock, "data_blocks", read_data_block, write_data_block)
KINDS: dict[str, ObjectKind] = {
    TAG_TABLE: ObjectKind(TagTable, "tag_tables", read_tag_table, write_tag_table),
    DATA_TYPE: ObjectKind(DataTypeDeclaration, "data_types", read_data_type, write_data_type),
    **dict.fromkeys(DATA_BLOCKS, _DATA_BLOCK),
    **dict.fromkeys(POUS, _POU),
}
"""Kinds of objects by their elements, those that others need first."""
