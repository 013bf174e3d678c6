"""Reads blocks, data blocks, data types and tag tables. The writer is `objects_writer`."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.simaticml.added import is_added
from plcopen_sfc.formats.simaticml.bodies_reader import read_units
from plcopen_sfc.formats.simaticml.interface_reader import read_interface, read_members, spelled_as
from plcopen_sfc.formats.simaticml.reading import (
    TRUTHS,
    Fields,
    ReadContext,
    attributes,
    carry_attribute,
    carry_element,
    carry_rest,
    child_named,
    children,
    local,
    merge,
    plain_text,
    read_comments,
    read_object_text,
    whole_number,
)
from plcopen_sfc.formats.simaticml.results import name_result
from plcopen_sfc.formats.simaticml.rewritten import counting, of_interface
from plcopen_sfc.formats.simaticml.types import read_type
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.pou import DataBlockKind, PouKind

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
"""The collections in which objects stand; those of a document stand in none."""
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


def read_pou(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read a code block."""
    fields: Fields = {"kind": POUS[local(element)], "bodies": []}
    values = _start(ctx, element, fields)
    interface = values.pop("Interface", None)
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
    units = _object_list(element, fields, "SW.Blocks.CompileUnit")
    late: Fields = {}
    fields["bodies"], unit_language = read_units(ctx, units, late)
    if fields.get("interface", {}).get("return_type") is not None:
        name_result(fields["bodies"], fields["name"])
    if any(isinstance(body, SfcBody) for body in fields["bodies"]):
        late["graph_settings"] = _settings(values)
    if language is not None and language != unit_language:
        carry_attribute(fields, "ProgrammingLanguage", language)
    return _end(ctx, element, fields, values)


def read_data_block(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read a data block."""
    fields: Fields = {"kind": DATA_BLOCKS[local(element)]}
    values = _start(ctx, element, fields)
    interface = values.pop("Interface", None)
    if interface is not None:
        fields["interface"] = read_interface(ctx, interface)
    fields["type_name"] = _take(values, "InstanceOfName")
    if plain_text(values.get("ProgrammingLanguage")) == "DB":
        del values["ProgrammingLanguage"]
    for child in _object_list(element, fields, ""):
        carry_element(fields, child)
    return _end(ctx, element, fields, values)


def read_data_type(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read a PLC data type."""
    fields: Fields = {"type": {"kind": "struct", "members": []}}
    values = _start(ctx, element, fields)
    interface = values.get("Interface")
    members = read_members(ctx, interface) if interface is not None else None
    if members is not None:
        fields["type"] = members
        del values["Interface"]
    for child in _object_list(element, fields, ""):
        carry_element(fields, child)
    digest = of_interface(interface) if interface is not None else ""
    return _end(ctx, element, fields, values, {"type": digest, "initial": digest})


def read_tag_table(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read a tag table with its tags and user constants."""
    fields: Fields = {"tags": [], "constants": []}
    values = _start(ctx, element, fields)
    for child in _object_list(element, fields, TAG, CONSTANT):
        if local(child) == TAG:
            fields["tags"].append(_tag(ctx, child))
        else:
            fields["constants"].append(_constant(ctx, child))
    return _end(ctx, element, fields, values)


def _tag(ctx: ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {}
    values = _start(ctx, element, fields)
    fields["type"] = _take(values, "DataTypeName") or ""
    fields["address"] = _take(values, "LogicalAddress")
    for child in _object_list(element, fields, ""):
        carry_element(fields, child)
    return _end(ctx, element, fields, values)


def _constant(ctx: ReadContext, element: etree._Element) -> Fields:
    fields: Fields = {}
    values = _start(ctx, element, fields)
    spelled = _take(values, "DataTypeName") or ""
    fields["type"] = read_type(spelled)
    if spelled_as(fields["type"]) != spelled:
        carry_attribute(fields, "Datatype", spelled)
    value = _take(values, "Value")
    if value is not None:
        fields["initial"] = {"kind": "simple", "text": value}
    for child in _object_list(element, fields, ""):
        carry_element(fields, child)
    return _end(ctx, element, fields, values)


def _start(ctx: ReadContext, element: etree._Element, fields: Fields) -> dict[str, etree._Element]:
    """The attributes of an object by name; its name and number are read."""
    holder = child_named(element, "AttributeList")
    values: dict[str, etree._Element] = {}
    for child in children(holder) if holder is not None else ():
        if local(child) in values:
            carry_element(fields, child)
        else:
            values[local(child)] = child
    name = values.get("Name")
    fields["name"] = (name.text or "") if name is not None else ""
    _take(values, "Name")
    ctx.place.append(f"{local(element).rpartition('.')[2]} {fields['name']}")
    number = whole_number(plain_text(values.get("Number")))
    if number is not None:
        fields["number"] = number
        del values["Number"]
    return values


def _end(
    ctx: ReadContext,
    element: etree._Element,
    fields: Fields,
    values: dict[str, etree._Element],
    digests: dict[str, str] | None = None,
) -> Fields:
    """Keep the attributes that nobody has read, and put back what comments keep as long as `digests` fit."""
    for name, value in values.items():
        text = plain_text(value)
        if text is not None:
            carry_attribute(fields, name, text)
        else:
            carry_element(fields, value)
    carry_rest(fields, element)
    for key, mark in attributes(element).items():
        if key not in ("ID", "CompositionName") or (key == "CompositionName" and ROLES.get(local(element)) != mark):
            carry_attribute(fields, f"@{key}", mark)
    kept: Fields = {}
    read_comments(ctx, element, kept)
    merge(fields, counting(ctx, kept, digests or {}, element))
    ctx.place.pop()
    return fields


def _take(values: dict[str, etree._Element], name: str) -> str | None:
    """Take the text of a plain attribute; one that is more than text is left, and so kept."""
    text = plain_text(values.get(name))
    if text is not None:
        del values[name]
    return text


def _settings(values: dict[str, etree._Element]) -> Fields:
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


def _object_list(element: etree._Element, fields: Fields, *expected: str) -> list[etree._Element]:
    """The objects of an object: its title and comment are read, the `expected` ones returned, others kept."""
    holder = child_named(element, "ObjectList")
    found: list[etree._Element] = []
    for child in children(holder) if holder is not None else ():
        field = {"Title": "title", "Comment": "comment"}.get(child.get("CompositionName", ""))
        text = read_object_text(child) if local(child) == "MultilingualText" and field not in fields else None
        if text is not None and field is not None:
            fields[field] = text
        elif local(child) in expected:
            found.append(child)
        else:
            carry_element(fields, child)
    return found
