"""Data that CODESYS and TwinCAT add to charts and to elements of charts and networks, read and written.

Each reader takes one ``addData/data`` element into the fields of its owner. It returns False, and leaves the data to be
kept as extension data, where it does not understand all of it.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Container, Iterator
from functools import lru_cache
from typing import Any

from lxml import etree

from plcopen_sfc.formats.codesys import codesys_names as names
from plcopen_sfc.formats.plcopen.tc6_reading import DataReader, Fields, Tc6ReadContext
from plcopen_sfc.formats.plcopen.tc6_writing import Tc6WriteContext, Written, tool_element
from plcopen_sfc.formats.xml.extension_data import extension_data, legal_text, markup, parsed_markup
from plcopen_sfc.model.actions import Monitoring, SymbolAccess
from plcopen_sfc.model.base import ExtensionData, Model, UnknownDataRule
from plcopen_sfc.model.chart_settings import SfcFlag, SfcSettings
from plcopen_sfc.model.drawing import Symbol, SymbolKind
from plcopen_sfc.model.exclusion import IS_EXECUTED
from plcopen_sfc.model.network import Block, BlockCall, VendorElement
from plcopen_sfc.model.sfc import ActionAssociation, SfcBody, Step, Transition
from plcopen_sfc.report import Outcome

_FLAGS = {flag.value for flag in SfcFlag}


def local_name(element: etree._Element) -> str:
    """Return the tag of an element without its namespace; empty for a comment."""
    tag = element.tag  # without a QName, which takes ten times as long: files have attributes by the ten thousand
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""


def only_child(data: etree._Element, name: str) -> etree._Element | None:
    """Return the one child of `data`; None where it has another local name, or is not alone."""
    return data[0] if len(data) == 1 and local_name(data[0]) == name else None


def plain_child_text(data: etree._Element, name: str) -> str | None:
    """Return the text of the one child of `data`, where that is all there is in it."""
    child = only_child(data, name)
    return None if child is None or len(child) or child.attrib else child.text or ""


def read_element_attributes(ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``sfc/element``: the attributes of the SFC editor at a step, transition, branch, jump or association."""
    table = only_child(data, "attributes")
    if table is None:
        return False
    unknown: list[etree._Element] = []
    tag: object = None
    for attribute in table:
        items: Any = attribute.items()
        if attribute.tag != tag and local_name(attribute) == "attribute":
            tag = attribute.tag
        is_plain = len(items) == 1 and not len(attribute) and attribute.tag == tag
        guid = items[0][1] if is_plain and items[0][0] == "guid" else None
        raw = attribute.text or ""
        known = _VALUES.get((guid, raw))
        if known is not None:  # most attributes
            fields[known[0]] = known[1]
            continue
        value = raw.strip()
        if guid is None or not _take_attribute(fields, owner, guid, value):
            unknown.append(attribute)
        elif guid == names.COMMENT and not is_reformatted(raw):
            fields["comment"] = raw
        elif raw != value and guid != names.NAME:
            unknown.append(attribute)
        elif guid == names.NAME and owner == "transition":
            # the condition is known only when the whole chart is: `finish_chart` compares the two
            fields[_PENDING] = (raw, attribute)
        elif guid == names.NAME and not _is_name(raw, _derived_name(fields, owner)):
            unknown.append(attribute)
            _check_name(ctx, attribute, fields, owner, value)
    if unknown:
        _keep_attributes(fields, unknown, data.get("handleUnknown", "implementation"))
    return True


def _keep_attributes(fields: Fields, unknown: list[etree._Element], rule: str) -> None:
    """Carry attributes of the SFC editor as a table of their own."""
    table = etree.Element("attributes")
    table.extend([copy.deepcopy(attribute) for attribute in unknown])
    extension_data(fields)["data"].append({"name": names.SFC_ELEMENT, "rule": rule, "content": markup(table)})


def is_reformatted(raw: str) -> bool:
    """True if a formatter of XML has put the end tag of a value on a line of its own. The tools never do."""
    return bool(re.search(r"\n[ \t]+$", raw))


def _take_attribute(fields: Fields, owner: str, guid: str, value: str) -> bool:
    """Put one attribute into the fields; False where it is unknown or its value is."""
    if guid == names.NAME:
        if owner in ("selectionDivergence", "simultaneousDivergence"):
            fields["name"] = value
        return True
    if guid == names.COMMENT:
        fields["comment"] = value
    elif guid in _ENUMERATED:
        if (guid, value) not in _VALUES:
            return False
        field, meant = _VALUES[guid, value]
        fields[field] = meant
    elif guid in (names.INITIAL, names.PARALLEL):
        stated = bool(fields.get("initial", False)) if guid == names.INITIAL else owner == "simultaneousDivergence"
        return value in ("TRUE", "FALSE") and stated == (value == "TRUE")
    elif guid == names.QUALIFIER:
        return " ".join(filter(None, (fields.get("qualifier", "N"), fields.get("duration")))) == value
    elif owner == "step" and guid in STEP_TEXTS:
        fields[STEP_TEXTS[guid]] = value
    else:
        return False
    return True


_ENUMERATED: dict[str, tuple[str, dict[str, Any]]] = {
    names.EXCLUDE: ("exclude", {"TRUE": True, "FALSE": False}),
    names.DUPLICATION: ("duplicate", {"TRUE": True, "FALSE": False}),
    names.SYMBOL: ("symbol", {str(number): value for number, value in enumerate(names.SYMBOL_VALUES)}),
    names.MONITORING: ("monitoring", {str(number): value for number, value in enumerate(names.MONITORING_VALUES)}),
}
"""Attributes that have one of a few values: the field, and its values by their texts."""
_VALUES: dict[tuple[str | None, str], tuple[str, Any]] = {
    (guid, text): (field, value) for guid, (field, values) in _ENUMERATED.items() for text, value in values.items()
}
STEP_TEXTS = {
    names.MIN_TIME: "min_time",
    names.MAX_TIME: "max_time",
    names.MAIN_ACTION: "main_action",
    names.ENTRY_ACTION: "entry_action",
    names.EXIT_ACTION: "exit_action",
}


def _derived_name(fields: Fields, owner: str) -> str | None:
    """Return the value of the Name attribute that follows from the rest of the element; None where none does."""
    return fields.get("target" if owner == "action" else "name")


def _is_name(raw: str, derived: str | None) -> bool:
    """True if the value of a Name attribute is what follows from its element, apart from blanks of a formatter."""
    return raw == derived or (derived is not None and is_reformatted(raw) and raw.strip() == derived.strip())


def _check_name(ctx: Tc6ReadContext, attribute: etree._Element, fields: Fields, owner: str, value: str) -> None:
    derived = _derived_name(fields, owner)
    if derived is not None and derived.strip() != value:
        ctx.warn("CDS101", f"the Name attribute is {value!r}, the element {derived!r}", attribute, f"{owner} {derived}")


_PENDING = "name_attribute"


def finish_chart(_ctx: Tc6ReadContext, chart: Fields) -> None:
    """Compare the Name attribute of each transition with its condition; keep it where it is written differently."""
    for transition in chart["transitions"]:
        raw, attribute = transition.pop(_PENDING, (None, None))
        condition = transition.get("condition") or {}
        if attribute is not None and not _is_name(raw, condition.get("text", condition.get("name", ""))):
            _keep_attributes(transition, [attribute], "implementation")


_SYMBOLS = {SymbolAccess(value): str(i) for i, value in enumerate(names.SYMBOL_VALUES)}
_MONITORINGS = {Monitoring(value): str(i) for i, value in enumerate(names.MONITORING_VALUES)}


_CORE_VERSION = re.compile(r"V?(\d{1,9})\.(\d{1,9})(?:\s+SP(\d{1,9}))?(?:\s+Patch\s+(\d{1,9}))?((?:\.\d{1,9})*)")


@lru_cache(maxsize=32)
def core_version(product_version: str) -> tuple[int, ...]:
    """Return the version of the CODESYS core: (3, 5, 14, 1) for ``CODESYS V3.5 SP14 Patch 1``."""
    match = _CORE_VERSION.search(product_version)
    if match is None:
        return ()
    major, minor, pack, patch, rest = match.groups()
    if rest:
        return (int(major), int(minor), *map(int, rest.strip(".").split(".")))
    return (int(major), int(minor), int(pack or 0), int(patch or 0))


# -- chart elements ---------------------------------------------------------------------------------------------------


def _truth(value: bool | None) -> str:
    return "TRUE" if value else "FALSE"


def _attribute_table(extension_data: ExtensionData | None, pairs: list[tuple[str, str | None]]) -> etree._Element:
    """Return the attribute table: `pairs` of GUID and value (None or empty: left out), and those that were carried."""
    kept: dict[str, str] = {}
    for data in extension_data.data if extension_data is not None else ():
        if data.name == names.SFC_ELEMENT:
            for attribute in parsed_markup(data.content):
                kept[attribute.get("guid", "")] = attribute.text or ""
    table = etree.Element("attributes", nsmap={None: ""})  # type: ignore[dict-item]
    for guid, value in pairs:
        text = value or ""
        if guid in kept:
            raw = kept.pop(guid)
            # the file has blanks around the value, or writes it in another way
            unheard_of = text in ("0", "FALSE") and raw.strip() not in _MODEL_VALUES.get(guid, {raw.strip()})
            text = raw if unheard_of or raw.split() == text.split() else text and padded(text, raw)
        if text:
            etree.SubElement(table, "attribute", guid=guid).text = legal_text(text)
    for guid, raw in kept.items():
        if guid not in _ALWAYS_WRITTEN:
            etree.SubElement(table, "attribute", guid=guid).text = legal_text(raw)
    return table


_MODEL_VALUES = {guid: set(values) for guid, (_, values) in _ENUMERATED.items()}
"""The values that the model has a place for, of attributes that are extension data where they have another."""


def padded(text: str, raw: str) -> str:
    """Return `text` with the blanks around `raw` where a formatter has put the end tag on a line of its own."""
    if not is_reformatted(raw):
        return text
    return raw[: len(raw) - len(raw.lstrip())] + text + raw[len(raw.rstrip()) :]


_ALWAYS_WRITTEN = frozenset(
    {names.NAME, names.EXCLUDE, names.SYMBOL, names.INITIAL, names.DUPLICATION, names.QUALIFIER, names.PARALLEL}
)


def _name_of(action: object) -> str | None:
    return action if isinstance(action, str) else None


# Exports have the attribute for duplication from V3.5 SP10 on, that for monitoring from SP13 on.
def _modern(ctx: Tc6WriteContext, *version: int) -> bool:
    """True if the target tool's core is at least `version`; an unknown one is taken for the newest."""
    core = core_version(ctx.project.header.version)
    return not core or core >= version


def _chart_data(
    ctx: Tc6WriteContext,
    thing: Step | Transition | ActionAssociation | Symbol,
    name: str | None,
    *more: tuple[str, str | None],
) -> Iterator[Written]:
    """Yield the attributes of the SFC editor at an element of a chart: those that all of these have, and `more`."""
    comment = thing.comment if isinstance(thing.comment, str) else getattr(thing.comment, "text", None)
    exclude = thing.exclude and id(thing) not in ctx.told_by_others
    if thing.exclude and not exclude and isinstance(thing, Symbol):
        ctx.note(Outcome.TRANSLATED, "exclude", name or "", IS_EXECUTED)
    pairs = [(names.NAME, name), (names.COMMENT, comment), (names.EXCLUDE, _truth(exclude))]
    if not isinstance(thing, Symbol):
        pairs.append((names.SYMBOL, _SYMBOLS[thing.symbol]))
    yield names.SFC_ELEMENT, UnknownDataRule.IMPLEMENTATION, _attribute_table(thing.extension_data, [*pairs, *more])


def _write_step(ctx: Tc6WriteContext, step: Step, _owner: str) -> Iterator[Written]:
    duplicate = step.duplicate or _modern(ctx, 3, 5, 10)
    return _chart_data(
        ctx,
        step,
        step.name,
        (names.INITIAL, _truth(step.initial)),
        (names.DUPLICATION, _truth(step.duplicate) if duplicate else None),
        (names.MIN_TIME, step.min_time),
        (names.MAX_TIME, step.max_time),
        (names.MAIN_ACTION, _name_of(step.main_action)),
        (names.ENTRY_ACTION, _name_of(step.entry_action)),
        (names.EXIT_ACTION, _name_of(step.exit_action)),
    )


def _write_transition(ctx: Tc6WriteContext, transition: Transition, _owner: str) -> Iterator[Written]:
    duplicate = transition.duplicate or _modern(ctx, 3, 5, 10)
    monitoring = transition.monitoring is not Monitoring.NONE or _modern(ctx, 3, 5, 13)
    return _chart_data(
        ctx,
        transition,
        transition.shown_condition,
        (names.DUPLICATION, _truth(transition.duplicate) if duplicate else None),
        (names.MONITORING, _MONITORINGS[transition.monitoring] if monitoring else None),
    )


def _write_association(ctx: Tc6WriteContext, association: ActionAssociation, _owner: str) -> Iterator[Written]:
    qualifier = " ".join(filter(None, (association.qualifier.value, association.duration)))
    return _chart_data(ctx, association, association.target, (names.QUALIFIER, qualifier))


def _write_symbol(ctx: Tc6WriteContext, symbol: Symbol, owner: str) -> Iterator[Written]:
    if symbol.kind is SymbolKind.JUMP:
        yield from _chart_data(ctx, symbol, ctx.jump_name)
    elif owner in ("selectionDivergence", "simultaneousDivergence"):
        is_parallel = symbol.kind is SymbolKind.SIMULTANEOUS_DIVERGENCE
        yield from _chart_data(ctx, symbol, symbol.name, (names.PARALLEL, _truth(is_parallel)))


def read_settings(_ctx: Tc6ReadContext, data: etree._Element, fields: Fields, _owner: str) -> bool:
    """``sfcsettings``: the flags and the library of the chart in a POU or action."""
    element = only_child(data, "SFCSettings")
    bodies = fields.get("bodies") or ([fields["body"]] if fields.get("body") else [])
    chart = next((body["chart"] for body in bodies if body["language"] == "SFC"), None)
    if element is None or chart is None or element.attrib:
        return False
    settings: Fields = {"flags": {}, "other_flags": {}}
    library: Fields = {}
    for child in element:
        name = local_name(child)
        if name in _LIBRARY and not len(child):
            library[_LIBRARY[name]] = child.text or ""
        elif name in _SWITCHES and child.text in ("true", "false"):
            settings[_SWITCHES[name]] = child.text == "true"
        elif name == "Flags" and all(_is_flag(flag) for flag in child):
            for flag in child:
                use = {"use": flag.get("Use") == "true", "declare": flag.get("Declare") == "true"}
                settings["flags" if local_name(flag) in _FLAGS else "other_flags"][local_name(flag)] = use
        else:
            return False
    if library:
        settings["library"] = library
    chart.update({"settings": settings})
    return True


_LIBRARY = {"LibTitle": "title", "LibCompany": "company", "LibVersion": "version", "LibNamespace": "namespace"}
_SWITCHES = {"CalcActiveTransOnly": "active_transitions_only", "UseDefaults": "use_defaults"}


def _is_flag(element: etree._Element) -> bool:
    return set(element.attrib) == {"Use", "Declare"} and set(element.attrib.values()) <= {"true", "false"}


# -- objects ----------------------------------------------------------------------------------------------------------


def settings_element(ctx: Tc6WriteContext, settings: SfcSettings) -> etree._Element:
    """``SFCSettings``."""
    root = tool_element(ctx, "SFCSettings")

    def text(name: str, value: str | None) -> None:
        if value is not None:
            etree.SubElement(root, ctx.version_tag(name)).text = value or None

    for name, field in _LIBRARY.items() if settings.library is not None else ():
        text(name, getattr(settings.library, field))
    for name, field in _SWITCHES.items():
        switch = getattr(settings, field)
        text(name, None if switch is None else str(switch).lower())
    flags = {flag.value: use for flag, use in settings.flags.items()} | settings.other_flags
    holder = etree.SubElement(root, ctx.version_tag("Flags"))
    for name, use in flags.items():
        switches = {"Declare": str(use.declare).lower(), "Use": str(use.use).lower()}
        etree.SubElement(holder, ctx.version_tag(name), switches)
    return root


def write_settings(ctx: Tc6WriteContext, bodies: list[object]) -> Iterator[Written]:
    """Write the settings of the chart among `bodies`, unless it stays as it is in the file that is patched."""
    if ctx.body_name in ctx.untouched:
        return
    chart = next((body.chart for body in bodies if isinstance(body, SfcBody)), None)
    if chart is not None and chart.settings is not None:
        yield names.SFC_SETTINGS, UnknownDataRule.IMPLEMENTATION, settings_element(ctx, chart.settings)


def _no_namespace(name: str, text: str) -> etree._Element:
    element = etree.Element(name, nsmap={None: ""})  # type: ignore[dict-item]
    element.text = legal_text(text) or None
    return element


def text_reader(child: str, owner: str, field: str, known: Container[str] | None = None) -> DataReader:
    """Return the reader of data of `owner` that is one text, of those `known`, in an element `child`."""

    def read(_ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner_: str) -> bool:
        text = plain_child_text(data, child)
        if text is None or owner_ != owner or (known is not None and text not in known):
            return False
        fields[field] = text
        return True

    return read


CALLS = {call.value for call in BlockCall}


def _write_block(_ctx: Tc6WriteContext, block: Block, _owner: str) -> Iterator[Written]:
    if block.call is not None:
        yield names.CALL_TYPE, UnknownDataRule.IMPLEMENTATION, _no_namespace("CallType", block.call.value)
    if block.code is not None:
        yield names.ST_CODE, UnknownDataRule.IMPLEMENTATION, _no_namespace("STCode", block.code)


def read_fbd_attributes(_ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``fbd/implementationattributes`` of a vendor element."""
    table = only_child(data, "fbdattributes")
    if owner != "vendorElement" or table is None or table.attrib:
        return False
    found: dict[str, str] = {}
    for attribute in table:
        if local_name(attribute) != "attribute" or set(attribute.attrib) != {"name", "value"} or len(attribute):
            return False
        found[attribute.get("name", "")] = attribute.get("value", "")
    fields["attributes"] = found
    return True


def _write_vendor_element(_ctx: Tc6WriteContext, element: VendorElement, _owner: str) -> Iterator[Written]:
    if element.element_type is not None:
        yield names.ELEMENT_TYPE, UnknownDataRule.IMPLEMENTATION, _no_namespace("ElementType", element.element_type)
    if element.attributes:
        table = _no_namespace("fbdattributes", "")
        for name, value in element.attributes.items():
            etree.SubElement(table, "attribute", name=name, value=value)
        yield names.FBD_ATTRIBUTES, UnknownDataRule.IMPLEMENTATION, table


DataWriter = Callable[[Tc6WriteContext, Any, str], Iterator[Written]]
Writers = tuple[tuple[type[Model], DataWriter], ...]
"""The writers of the data of objects by their class; the first that fits counts."""

ELEMENT_WRITERS: Writers = (
    (Step, _write_step),
    (Transition, _write_transition),
    (ActionAssociation, _write_association),
    (Symbol, _write_symbol),
    (Block, _write_block),
    (VendorElement, _write_vendor_element),
)
