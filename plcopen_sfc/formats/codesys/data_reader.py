"""Reads the data that CODESYS and TwinCAT add to PLCopen XML. The writer is `data_writer`.

Each function reads one ``addData/data`` element into the fields of its owner. It returns False, and leaves the data to
be carried, where it does not understand all of it.
"""

from __future__ import annotations

import copy
import re

from lxml import etree

from plcopen_sfc.formats.codesys import names
from plcopen_sfc.formats.plcopen.body_reader import defer, read_body, read_pou
from plcopen_sfc.formats.plcopen.project_reader import read_resource
from plcopen_sfc.formats.plcopen.reading import DataReader, Fields, ReadContext, attributes, carried, read_common
from plcopen_sfc.formats.plcopen.rewritten import sources_of_section
from plcopen_sfc.formats.plcopen.types_reader import (
    PARTS_FIELD,
    parts_of_list,
    read_data_type_declaration,
    read_interface,
    read_section,
)
from plcopen_sfc.formats.xml.extension_data import markup
from plcopen_sfc.languages.declarations.inheritance import Inheritance, kept_inheritance
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.network import BlockCall
from plcopen_sfc.model.sfc import SfcFlag

_FLAGS = {flag.value for flag in SfcFlag}
_CALLS = {call.value for call in BlockCall}


def _local(element: etree._Element) -> str:
    return etree.QName(element).localname if isinstance(element.tag, str) else ""


def _only(data: etree._Element, name: str) -> etree._Element | None:
    """The one child of `data`, where it has this local name."""
    return data[0] if len(data) == 1 and _local(data[0]) == name else None


def _plain_text(data: etree._Element, name: str) -> str | None:
    """The text of the one child of `data`, where that is all there is in it."""
    child = _only(data, name)
    return None if child is None or len(child) or child.attrib else child.text or ""


def read_element_attributes(ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``sfc/element``: the attributes of the SFC editor at a step, transition, branch, jump or association."""
    table = _only(data, "attributes")
    if table is None:
        return False
    unknown: list[etree._Element] = []
    for attribute in table:
        guid = attribute.get("guid") if _local(attribute) == "attribute" else None
        raw = attribute.text or ""
        value = raw.strip()
        if guid is None or len(attribute) or len(attribute.attrib) != 1 or not _take(fields, owner, guid, value):
            unknown.append(attribute)
        elif guid == names.COMMENT and not is_reformatted(raw):
            fields["comment"] = raw
        elif raw != value and guid != names.NAME:
            unknown.append(attribute)
        elif guid == names.NAME and owner == "transition":
            # the condition is known only when the whole chart is: `finish_chart` compares the two
            fields[_PENDING] = (raw, attribute)
        elif guid == names.NAME and raw != _derived_name(fields, owner):
            unknown.append(attribute)
            _check_name(ctx, attribute, fields, owner, value)
    if unknown:
        _carry_attributes(fields, unknown, data.get("handleUnknown", "implementation"))
    return True


def _carry_attributes(fields: Fields, unknown: list[etree._Element], rule: str) -> None:
    """Carry attributes of the SFC editor as a table of their own."""
    table = etree.Element("attributes")
    table.extend([copy.deepcopy(attribute) for attribute in unknown])
    carried(fields)["data"].append({"name": names.SFC_ELEMENT, "rule": rule, "content": markup(table)})


def is_reformatted(raw: str) -> bool:
    """Whether a formatter of XML has put the end tag of a value on a line of its own. The tools never do."""
    return bool(re.search(r"\n[ \t]+$", raw))


def _take(fields: Fields, owner: str, guid: str, value: str) -> bool:
    """Put one attribute into the fields; False where it is unknown or its value is."""
    if guid == names.NAME:
        if owner in ("selectionDivergence", "simultaneousDivergence"):
            fields["name"] = value
        return True
    if guid == names.COMMENT:
        fields["comment"] = value
    elif guid in _TRUTHS:
        if value not in ("TRUE", "FALSE"):
            return False
        if guid == names.EXCLUDE:
            fields["exclude"] = value == "TRUE"
        elif guid == names.DUPLICATION:
            fields["duplicate"] = value == "TRUE"
        elif guid == names.INITIAL:
            return bool(fields.get("initial", False)) == (value == "TRUE")
        else:
            return (owner == "simultaneousDivergence") == (value == "TRUE")
    elif guid in (names.SYMBOL, names.MONITORING):
        choices = names.SYMBOL_VALUES if guid == names.SYMBOL else names.MONITORING_VALUES
        if value not in map(str, range(len(choices))):
            return False
        fields["symbol" if guid == names.SYMBOL else "monitoring"] = choices[int(value)]
    elif guid == names.QUALIFIER:
        return " ".join(filter(None, (fields.get("qualifier", "N"), fields.get("duration")))) == value
    elif owner == "step" and guid in _STEP_TEXTS:
        fields[_STEP_TEXTS[guid]] = value
    else:
        return False
    return True


_TRUTHS = frozenset({names.EXCLUDE, names.DUPLICATION, names.INITIAL, names.PARALLEL})
_STEP_TEXTS = {
    names.MIN_TIME: "min_time",
    names.MAX_TIME: "max_time",
    names.MAIN_ACTION: "main_action",
    names.ENTRY_ACTION: "entry_action",
    names.EXIT_ACTION: "exit_action",
}


def _derived_name(fields: Fields, owner: str) -> str | None:
    """What the Name attribute says, where the rest of the element says it too. None: the element says nothing."""
    return fields.get("target" if owner == "action" else "name")


def _check_name(ctx: ReadContext, attribute: etree._Element, fields: Fields, owner: str, value: str) -> None:
    derived = _derived_name(fields, owner)
    if derived is not None and derived.strip() != value:
        ctx.warn(
            "CDS101", f"the Name attribute says {value!r}, the element {derived!r}", attribute, f"{owner} {derived}"
        )


_PENDING = "name_attribute"


def finish_chart(_ctx: ReadContext, chart: Fields) -> None:
    """Compare the Name attribute of each transition with its condition; carry it where it is written differently."""
    for transition in chart["transitions"]:
        raw, attribute = transition.pop(_PENDING, (None, None))
        condition = transition.get("condition") or {}
        if attribute is not None and raw != condition.get("text", condition.get("name", "")):
            _carry_attributes(transition, [attribute], "implementation")


def read_settings(_ctx: ReadContext, data: etree._Element, fields: Fields, _owner: str) -> bool:
    """``sfcsettings``: the flags and the library of the chart in a POU or action."""
    element = _only(data, "SFCSettings")
    bodies = fields.get("bodies") or ([fields["body"]] if fields.get("body") else [])
    chart = next((body["chart"] for body in bodies if body["language"] == "SFC"), None)
    if element is None or chart is None or element.attrib:
        return False
    settings: Fields = {"flags": {}, "other_flags": {}}
    library: Fields = {}
    for child in element:
        name = _local(child)
        if name in _LIBRARY and not len(child):
            library[_LIBRARY[name]] = child.text or ""
        elif name in _SWITCHES and child.text in ("true", "false"):
            settings[_SWITCHES[name]] = child.text == "true"
        elif name == "Flags" and all(_is_flag(flag) for flag in child):
            for flag in child:
                use = {"use": flag.get("Use") == "true", "declare": flag.get("Declare") == "true"}
                settings["flags" if _local(flag) in _FLAGS else "other_flags"][_local(flag)] = use
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


def read_declaration(ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``interfaceasplaintext``: the declaration as it was typed."""
    holder = _only(data, "InterfaceAsPlainText")
    if holder is None or len(holder) != 1 or len(holder[0]) or holder[0].tag != ctx.text_element:
        return False
    target = fields
    if owner in ("pou", "method"):
        if fields.get("interface") is None:
            fields["interface"] = {}
        target = fields["interface"]
    target["declaration"] = holder[0].text or ""
    return True


def read_object_id(_ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``objectid``: the id of the object in the tool's project."""
    text = _plain_text(data, "ObjectId")
    if text is None or owner not in _WITH_OBJECT_ID or data.get("handleUnknown") != "discard":
        return False
    fields["object_id"] = text
    return True


_WITH_OBJECT_ID = frozenset(
    {"pou", "action", "transition_object", "method", "dataType", "globalVars", "task", "resource", "configuration"}
)


def read_hidden_pou(ctx: ReadContext, data: etree._Element, _fields: Fields, owner: str) -> bool:
    """``pou`` in a resource: a POU of an application."""
    element = _only(data, "pou")
    if element is None or owner != "resource":
        return False
    ctx.pous.append(read_pou(ctx, element, ctx.resource_place))
    return True


def read_hidden_data_type(ctx: ReadContext, data: etree._Element, _fields: Fields, owner: str) -> bool:
    """``datatype`` in a resource."""
    element = _only(data, "dataType")
    if element is None or owner != "resource":
        return False
    ctx.data_types.append(read_data_type_declaration(ctx, element, ctx.resource_place))
    return True


def read_application(ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``application`` in the project: a resource without a configuration."""
    element = _only(data, "resource")
    if element is None or owner != "project":
        return False
    fields["applications"].append(read_resource(ctx, element, f"application/{element.get('name', '')}"))
    return True


def read_global_variables(ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``globalvars`` in the project: a list of global variables of an export of single objects."""
    element = _only(data, "globalVars")
    if element is None or owner != "project":
        return False
    for section in parts_of_list(read_section(ctx, element, "global")):
        if sources_of_section(section) is None:
            fields.setdefault("global_variables", []).append(section)
    return True


def read_mixed_list(ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``mixedattrsvarlist``: the sections of a list of global variables, which differ in RETAIN and CONSTANT.

    It is carried where its variables are not those of the list.
    """
    element = _only(data, "MixedAttrsVarList")
    if element is None or owner != "globalVars" or fields["kind"] != "global" or element.attrib:
        return False
    if len(element) < 2 or any(_local(child) != "globalVars" for child in element):
        return False
    parts = [read_section(ctx, child, "global") for child in element]
    variables = [variable for part in parts for variable in part["variables"]]

    def is_more(part: Fields) -> bool:
        return bool(part.keys() - _OF_A_PART) or part.get("name") != fields.get("name")

    if variables != fields["variables"] or any(map(is_more, parts)):
        return False
    fields[PARTS_FIELD] = parts
    return True


_OF_A_PART = frozenset({"kind", "name", "variables", "constant", "retain", "nonretain", "persistent", "nonpersistent"})


def read_method(ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``method`` of a POU."""
    element = _only(data, "Method")
    if element is None or owner != "pou":
        return False
    left = attributes(element)
    method: Fields = {"name": left.pop("name", "")}
    if "ObjectId" in left:
        method["object_id"] = left.pop("ObjectId")
    ctx.place.append(f"method {method['name']}")
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "interface" and "interface" not in method:
            method["interface"] = read_interface(ctx, child)
        elif local == "body" and "body" not in method:
            method["body"] = read_body(ctx, child)
        else:
            read_common(ctx, method, child, local, "method")
    ctx.place.pop()
    if "body" in method:
        method["body"] = defer(method["body"])
    if left:
        carried(method)["attributes"].update(left)
    fields["methods"].append(method)
    return True


def read_inheritance(_ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``pouinheritance`` of an interface, ``datatypeinheritance`` of a type: what it extends and implements."""
    element = _only(data, "Inheritance")
    if element is None or owner not in ("interface", "dataType") or element.attrib:
        return False
    names: dict[str, list[str]] = {"Extends": [], "Implements": []}
    for child in element:
        if _local(child) not in names or len(child) or child.attrib or not (child.text or "").strip():
            return False
        names[_local(child)].append((child.text or "").strip())
    found = Inheritance(tuple(names["Extends"]), tuple(names["Implements"]))
    kept = found.keep()
    if kept is None or len(found.extends) > 1:
        return False
    said = fields.get("carried")
    if kept_inheritance(Carried.model_validate(said) if said else None) != found:
        carried(fields)["data"] += [each.model_dump(mode="json") for each in kept.data]
    return True


def read_project_structure(_ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``projectstructure``: the tree of folders and objects."""
    root = _only(data, "ProjectStructure")
    if root is None or owner != "project" or root.attrib:
        return False
    tree = [_tree_node(child) for child in root]
    if any(node is None for node in tree):
        return False
    if tree:  # an empty one only tells whose file it is
        fields["tree"] = tree
    return True


def _tree_node(element: etree._Element) -> Fields | None:
    kind = _local(element)
    if kind not in ("Object", "Folder") or set(element.attrib) - {"Name", "ObjectId"} or "Name" not in element.attrib:
        return None
    children = [_tree_node(child) for child in element]
    if any(child is None for child in children):
        return None
    return {
        "name": element.get("Name"),
        "folder": kind == "Folder",
        "object_id": element.get("ObjectId"),
        "children": children,
    }


def read_task_settings(_ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``tasksettings``."""
    element = _only(data, "TaskSettings")
    if element is None or owner != "task" or len(element) > 1:
        return False
    given = {str(name): str(value) for name, value in element.attrib.items()}
    settings: Fields = {_TASK[name]: value for name, value in given.items() if name in _TASK}
    settings["attributes"] = {name: value for name, value in given.items() if name not in _TASK}
    for child in element:
        if _local(child) != "Watchdog" or set(child.attrib) - _WATCHDOG.keys() or len(child):
            return False
        watchdog: Fields = {_WATCHDOG[str(name)]: value for name, value in child.attrib.items()}
        if watchdog.get("enabled") not in ("true", "false"):
            return False
        watchdog["enabled"] = watchdog["enabled"] == "true"
        settings["watchdog"] = watchdog
    fields["settings"] = settings
    return True


_TASK = {"KindOfTask": "kind", "Interval": "interval", "IntervalUnit": "interval_unit", "Event": "event"}
_WATCHDOG = {"Enabled": "enabled", "Time": "time", "TimeUnit": "time_unit", "Sensitivity": "sensitivity"}


def read_call_type(_ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``fbdcalltype`` of a block."""
    text = _plain_text(data, "CallType")
    if owner != "block" or text not in _CALLS:
        return False
    fields["call"] = text
    return True


def read_st_code(_ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``stcode`` of an EXECUTE block."""
    text = _plain_text(data, "STCode")
    if owner != "block" or text is None:
        return False
    fields["code"] = text
    return True


def read_element_type(_ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``fbdelementtype`` of a vendor element: what it is in the FBD or LD editor."""
    text = _plain_text(data, "ElementType")
    if owner != "vendorElement" or text is None:
        return False
    fields["element_type"] = text
    return True


def read_fbd_attributes(_ctx: ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``fbd/implementationattributes`` of a vendor element."""
    table = _only(data, "fbdattributes")
    if owner != "vendorElement" or table is None or table.attrib:
        return False
    found: dict[str, str] = {}
    for attribute in table:
        if _local(attribute) != "attribute" or set(attribute.attrib) != {"name", "value"} or len(attribute):
            return False
        found[attribute.get("name", "")] = attribute.get("value", "")
    fields["attributes"] = found
    return True


DATA_READERS: dict[str, DataReader] = {
    names.SFC_ELEMENT: read_element_attributes,
    names.SFC_SETTINGS: read_settings,
    names.PLAIN_TEXT: read_declaration,
    names.OBJECT_ID: read_object_id,
    names.POU: read_hidden_pou,
    names.DATA_TYPE: read_hidden_data_type,
    names.APPLICATION: read_application,
    names.GLOBAL_VARS: read_global_variables,
    names.MIXED_LIST: read_mixed_list,
    names.METHOD: read_method,
    names.POU_INHERITANCE: read_inheritance,
    names.TYPE_INHERITANCE: read_inheritance,
    names.PROJECT_STRUCTURE: read_project_structure,
    names.TASK_SETTINGS: read_task_settings,
    names.CALL_TYPE: read_call_type,
    names.ST_CODE: read_st_code,
    names.ELEMENT_TYPE: read_element_type,
    names.FBD_ATTRIBUTES: read_fbd_attributes,
}
"""Who reads which data."""
