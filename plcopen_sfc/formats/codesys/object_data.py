"""Data that CODESYS and TwinCAT add to projects, POUs, types, lists of variables and tasks, read and written.

See `element_data` for the rules of readers.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from lxml import etree

from plcopen_sfc.formats.codesys import codesys_names as names
from plcopen_sfc.formats.codesys.element_data import (
    ELEMENT_WRITERS,
    DataWriter,
    Writers,
    local_name,
    only_child,
    plain_child_text,
    write_settings,
)
from plcopen_sfc.formats.plcopen.source_marks import sources_of_section
from plcopen_sfc.formats.plcopen.tc6_bodies import finished_body, read_body, read_pou, write_body, write_pou
from plcopen_sfc.formats.plcopen.tc6_configurations import read_resource, write_resource
from plcopen_sfc.formats.plcopen.tc6_declarations import (
    PARTS_FIELD,
    parts_of_list,
    read_data_type_declaration,
    read_interface,
    read_section,
    write_data_type_declaration,
    write_interface,
    write_lists,
    write_section,
)
from plcopen_sfc.formats.plcopen.tc6_reading import Fields, Tc6ReadContext, read_common
from plcopen_sfc.formats.plcopen.tc6_versions import XHTML
from plcopen_sfc.formats.plcopen.tc6_writing import Tc6WriteContext, Written, finish_element, given, tool_element
from plcopen_sfc.formats.xml.extension_data import attributes, extension_data, legal_text
from plcopen_sfc.languages.declarations.attributes import attribute_pragmas, pragma_attributes
from plcopen_sfc.languages.declarations.kept_texts import (
    Inheritance,
    keep,
    kept,
    kept_inheritance,
)
from plcopen_sfc.model.base import ExtensionData, Model, UnknownDataRule
from plcopen_sfc.model.pou import Action, Method, NamedTransition, Pou
from plcopen_sfc.model.project import Configuration, Project, Resource, Task, TreeNode
from plcopen_sfc.model.types import DataTypeDeclaration, Variable
from plcopen_sfc.model.variables import Interface, VariableSection
from plcopen_sfc.report import ConversionReport


def write_data(ctx: Tc6WriteContext, thing: Model, owner: str) -> Iterator[Written]:
    """Yield the tool's own data of `thing`."""
    writer = _writer_of(type(thing))
    if writer is not None:
        yield from writer(ctx, thing, owner)


@cache
def _writer_of(kind: type[Model]) -> DataWriter | None:
    return next((writer for known, writer in (*ELEMENT_WRITERS, *_OBJECT_WRITERS) if issubclass(kind, known)), None)


def _holder(ctx: Tc6WriteContext) -> etree._Element:
    return etree.Element(ctx.names["data"], nsmap={None: ctx.version.namespace})  # type: ignore[dict-item]


def read_declaration(ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``interfaceasplaintext``: the declaration as it was typed."""
    holder = only_child(data, "InterfaceAsPlainText")
    if holder is None or len(holder) != 1 or len(holder[0]) or holder[0].tag != ctx.text_element:
        return False
    target = fields
    if owner in ("pou", "method"):
        if fields.get("interface") is None:
            fields["interface"] = {}
        target = fields["interface"]
    target["declaration"] = holder[0].text or ""
    return True


def _write_declaration(
    ctx: Tc6WriteContext, thing: Interface | DataTypeDeclaration | VariableSection
) -> Iterator[Written]:
    text = ctx.texts.get(id(thing), thing.declaration)
    if text is not None:
        holder = tool_element(ctx, "InterfaceAsPlainText")
        etree.SubElement(holder, f"{{{XHTML}}}xhtml", nsmap={None: XHTML}).text = legal_text(text)  # type: ignore[dict-item]
        yield names.PLAIN_TEXT, UnknownDataRule.IMPLEMENTATION, holder


def read_attributes(_ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``attributes`` of a list, a type or a variable: the pragmas before its declaration (``qualified_only``)."""
    element = only_child(data, "Attributes")
    if element is None or owner not in ("globalVars", "dataType", "variable") or element.attrib:
        return False
    found: list[tuple[str, str]] = []
    for child in element:
        if local_name(child) != "Attribute" or len(child) or child.keys() != ["Name", "Value"]:
            return False
        found.append((child.get("Name", ""), child.get("Value", "")))
    text = attribute_pragmas(found)
    if pragma_attributes(text) != found or data.get("handleUnknown") != "implementation":
        return False
    known = fields.get("extension_data")
    texts = kept(ExtensionData.model_validate(known)) if known else {}
    if texts.get("pragmas") != text:
        pragmas = keep({"pragmas": text})
        extension_data(fields)["data"] += [each.model_dump(mode="json") for each in pragmas.data] if pragmas else []
    return True


def _write_attributes(ctx: Tc6WriteContext, extension_data: ExtensionData | None) -> Iterator[Written]:
    found = pragma_attributes(kept(extension_data).get("pragmas", ""))
    if found is not None:
        element = tool_element(ctx, "Attributes")
        for name, value in found:
            etree.SubElement(
                element, ctx.version_tag("Attribute"), {"Name": legal_text(name), "Value": legal_text(value)}
            )
        yield names.ATTRIBUTES, UnknownDataRule.IMPLEMENTATION, element


def _write_variable(ctx: Tc6WriteContext, variable: Variable, _owner: str) -> Iterator[Written]:
    yield from _write_attributes(ctx, variable.extension_data)


def read_object_id(_ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``objectid``: the id of the object in the tool's project."""
    text = plain_child_text(data, "ObjectId")
    if text is None or owner not in _WITH_OBJECT_ID or data.get("handleUnknown") != "discard":
        return False
    fields["object_id"] = text
    return True


_WITH_OBJECT_ID = frozenset(
    {"pou", "action", "transition_object", "method", "dataType", "globalVars", "task", "resource", "configuration"}
)


def _write_object_id(ctx: Tc6WriteContext, object_id: str | None) -> Iterator[Written]:
    if object_id is not None:
        element = tool_element(ctx, "ObjectId")
        element.text = legal_text(object_id)
        yield names.OBJECT_ID, UnknownDataRule.DISCARD, element


def read_hidden_pou(ctx: Tc6ReadContext, data: etree._Element, _fields: Fields, owner: str) -> bool:
    """``pou`` in a resource: a POU of an application."""
    element = only_child(data, "pou")
    if element is None or owner != "resource":
        return False
    ctx.pous.append(read_pou(ctx, element, ctx.resource_place))
    return True


def read_hidden_data_type(ctx: Tc6ReadContext, data: etree._Element, _fields: Fields, owner: str) -> bool:
    """``datatype`` in a resource."""
    element = only_child(data, "dataType")
    if element is None or owner != "resource":
        return False
    ctx.data_types.append(read_data_type_declaration(ctx, element, ctx.resource_place))
    return True


def _write_resource(ctx: Tc6WriteContext, resource: Resource, _owner: str) -> Iterator[Written]:
    place, project = ctx.resource_place, ctx.project
    for declaration in project.data_types:
        if declaration.place == place:
            holder = _holder(ctx)
            write_data_type_declaration(ctx, holder, declaration, in_place=True)
            yield names.DATA_TYPE, UnknownDataRule.IMPLEMENTATION, holder[0]
    for pou in project.pous:
        if pou.place == place:
            holder = _holder(ctx)
            write_pou(ctx, holder, pou, in_place=True)
            yield names.POU, UnknownDataRule.IMPLEMENTATION, holder[0]
    yield from _write_object_id(ctx, resource.object_id)


def _write_configuration(ctx: Tc6WriteContext, configuration: Configuration, _owner: str) -> Iterator[Written]:
    yield from _write_object_id(ctx, configuration.object_id)


def read_application(ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``application`` in the project: a resource without a configuration."""
    element = only_child(data, "resource")
    if element is None or owner != "project":
        return False
    fields["applications"].append(read_resource(ctx, element, f"application/{element.get('name', '')}"))
    return True


def read_global_variables(ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``globalvars`` in the project: a list of global variables of an export of single objects."""
    element = only_child(data, "globalVars")
    if element is None or owner != "project":
        return False
    for section in parts_of_list(read_section(ctx, element, "global")):
        if sources_of_section(section) is None:
            fields.setdefault("global_variables", []).append(section)
    return True


def _write_project(ctx: Tc6WriteContext, project: Project, owner: str) -> Iterator[Written]:
    if owner != "project":
        return
    for application in project.applications:
        holder = _holder(ctx)
        write_resource(ctx, holder, application, f"application/{application.name}")
        yield names.APPLICATION, UnknownDataRule.IMPLEMENTATION, holder[0]
    holder = _holder(ctx)
    write_lists(ctx, holder, project.global_variables)
    for element in list(holder):
        yield names.GLOBAL_VARS, UnknownDataRule.IMPLEMENTATION, element
    if project.tree is not None:
        root = tool_element(ctx, "ProjectStructure")
        for node in project.tree:
            _write_tree_node(ctx, root, node)
        yield names.PROJECT_STRUCTURE, UnknownDataRule.DISCARD, root


def read_project_structure(_ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``projectstructure``: the tree of folders and objects."""
    root = only_child(data, "ProjectStructure")
    if root is None or owner != "project" or root.attrib:
        return False
    tree = [_read_tree_node(child) for child in root]
    if any(node is None for node in tree):
        return False
    if tree:  # an empty one only tells whose file it is
        fields["tree"] = tree
    return True


def _read_tree_node(element: etree._Element) -> Fields | None:
    kind = local_name(element)
    if kind not in ("Object", "Folder") or set(element.attrib) - {"Name", "ObjectId"} or "Name" not in element.attrib:
        return None
    children = [_read_tree_node(child) for child in element]
    if any(child is None for child in children):
        return None
    return {
        "name": element.get("Name"),
        "folder": kind == "Folder",
        "object_id": element.get("ObjectId"),
        "children": children,
    }


def mark_as_codesys(root: etree._Element) -> None:
    """Add an empty project tree to a file that has no data of the tool, by which it is recognised.

    Every export has some. The tools give the objects that a tree does not name a place themselves (guess).
    """
    namespace = f"{{{etree.QName(root).namespace}}}"
    if any(data.get("name", "").startswith(names.PREFIX) for data in root.iter(f"{namespace}data")):
        return
    holder = root.find(f"{namespace}addData")
    if holder is None:
        holder = etree.Element(f"{namespace}addData")
        documentation = root.find(f"{namespace}documentation")
        root.insert(len(root) if documentation is None else root.index(documentation), holder)
    attributes = {"name": names.PROJECT_STRUCTURE, "handleUnknown": UnknownDataRule.DISCARD.value}
    data = etree.SubElement(holder, f"{namespace}data", attributes)
    etree.SubElement(data, f"{namespace}ProjectStructure")


def _write_tree_node(ctx: Tc6WriteContext, parent: etree._Element, node: TreeNode) -> None:
    attributes = given({"Name": node.name, "ObjectId": node.object_id})
    element = etree.SubElement(parent, ctx.version_tag("Folder" if node.folder else "Object"), attributes)
    for child in node.children:
        _write_tree_node(ctx, element, child)


def read_mixed_list(ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``mixedattrsvarlist``: the sections of a list of global variables, which differ in RETAIN and CONSTANT.

    It is extension data where its variables are not those of the list.
    """
    element = only_child(data, "MixedAttrsVarList")
    if element is None or owner != "globalVars" or fields["kind"] != "global" or element.attrib:
        return False
    if len(element) < 2 or any(local_name(child) != "globalVars" for child in element):
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


def _write_declared(
    ctx: Tc6WriteContext, thing: DataTypeDeclaration | VariableSection, _owner: str
) -> Iterator[Written]:
    yield from _write_attributes(ctx, thing.extension_data)
    yield from _write_declaration(ctx, thing)
    yield from _write_object_id(ctx, thing.object_id)
    if id(thing) in ctx.parts:
        yield names.MIXED_LIST, UnknownDataRule.IMPLEMENTATION, _mixed_list(ctx, ctx.parts[id(thing)])


def _mixed_list(ctx: Tc6WriteContext, parts: list[VariableSection]) -> etree._Element:
    """Return the sections of a list of global variables, whose variables are in the report with the list."""
    element = tool_element(ctx, "MixedAttrsVarList")
    report, ctx.report = ctx.report, ConversionReport()
    for part in parts:
        alone = dict.fromkeys(("comment", "extension_data", "declaration", "object_id"))
        write_section(ctx, element, part.model_copy(update=alone))
    ctx.report = report
    return element


def read_method(ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``method`` of a POU."""
    element = only_child(data, "Method")
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
        method["body"] = finished_body(method["body"])
    if left:
        extension_data(method)["attributes"].update(left)
    fields["methods"].append(method)
    return True


def _write_pou(ctx: Tc6WriteContext, pou: Pou, _owner: str) -> Iterator[Written]:
    for method in pou.methods:
        yield names.METHOD, UnknownDataRule.IMPLEMENTATION, _method_element(ctx, method)
    yield from write_settings(ctx, list(pou.bodies))
    if pou.interface is not None:
        yield from _write_declaration(ctx, pou.interface)
    yield from _write_object_id(ctx, pou.object_id)


def _method_element(ctx: Tc6WriteContext, method: Method) -> etree._Element:
    element = tool_element(ctx, "Method", {"name": method.name, "ObjectId": method.object_id})
    ctx.place.append(f"method {method.name}")
    if method.interface is not None:
        write_interface(ctx, element, method.interface)
    if method.body is not None:
        outer, ctx.body_name = ctx.body_name, f"{ctx.body_name}.{method.name}"
        write_body(ctx, element, "body", method.body, {})
        ctx.body_name = outer
    finish_element(ctx, element, method, "method", frozenset({"name", "interface", "body"}))
    ctx.place.pop()
    return element


def _write_part(ctx: Tc6WriteContext, part: Action | NamedTransition, _owner: str) -> Iterator[Written]:
    yield from write_settings(ctx, [part.body])
    yield from _write_object_id(ctx, part.object_id)


def _write_method_data(ctx: Tc6WriteContext, method: Method, _owner: str) -> Iterator[Written]:
    if method.interface is not None:
        yield from _write_declaration(ctx, method.interface)


def read_inheritance(_ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``pouinheritance`` of an interface, ``datatypeinheritance`` of a type: what it extends and implements."""
    element = only_child(data, "Inheritance")
    if element is None or owner not in ("interface", "dataType") or element.attrib:
        return False
    names: dict[str, list[str]] = {"Extends": [], "Implements": []}
    for child in element:
        if local_name(child) not in names or len(child) or child.attrib or not (child.text or "").strip():
            return False
        names[local_name(child)].append((child.text or "").strip())
    found = Inheritance(tuple(names["Extends"]), tuple(names["Implements"]))
    kept = found.keep()
    if kept is None or len(found.extends) > 1:
        return False
    known = fields.get("extension_data")
    if kept_inheritance(ExtensionData.model_validate(known) if known else None) != found:
        extension_data(fields)["data"] += [each.model_dump(mode="json") for each in kept.data]
    return True


def _write_interface(ctx: Tc6WriteContext, interface: Interface, _owner: str) -> Iterator[Written]:
    yield from _write_inheritance(ctx, names.POU_INHERITANCE, interface.extension_data)


def _write_inheritance(ctx: Tc6WriteContext, name: str, extension_data: ExtensionData | None) -> Iterator[Written]:
    found = kept_inheritance(extension_data)
    if any(found):
        element = tool_element(ctx, "Inheritance")
        for tag, bases in (("Extends", found.extends), ("Implements", found.implements)):
            for base in bases:
                etree.SubElement(element, ctx.version_tag(tag)).text = legal_text(base)
        yield name, UnknownDataRule.IMPLEMENTATION, element


def _write_data_type(ctx: Tc6WriteContext, declaration: DataTypeDeclaration, owner: str) -> Iterator[Written]:
    yield from _write_inheritance(ctx, names.TYPE_INHERITANCE, declaration.extension_data)
    yield from _write_declared(ctx, declaration, owner)


def read_task_settings(_ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """``tasksettings``."""
    element = only_child(data, "TaskSettings")
    if element is None or owner != "task" or len(element) > 1:
        return False
    given = {str(name): str(value) for name, value in element.attrib.items()}
    settings: Fields = {_TASK[name]: value for name, value in given.items() if name in _TASK}
    settings["attributes"] = {name: value for name, value in given.items() if name not in _TASK}
    for child in element:
        if local_name(child) != "Watchdog" or set(child.attrib) - _WATCHDOG.keys() or len(child):
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


def _write_task(ctx: Tc6WriteContext, task: Task, _owner: str) -> Iterator[Written]:
    settings = task.settings
    if settings is not None:
        attributes = {name: getattr(settings, field) for name, field in _TASK.items()}
        element = tool_element(ctx, "TaskSettings", attributes | settings.attributes)
        if settings.watchdog is not None:
            dog = {name: getattr(settings.watchdog, field) for name, field in _WATCHDOG.items()}
            dog["Enabled"] = str(settings.watchdog.enabled).lower()
            etree.SubElement(element, ctx.version_tag("Watchdog"), given(dog))
        yield names.TASK_SETTINGS, UnknownDataRule.IMPLEMENTATION, element
    yield from _write_object_id(ctx, task.object_id)


_OBJECT_WRITERS: Writers = (
    (Pou, _write_pou),
    (Action, _write_part),
    (NamedTransition, _write_part),
    (Method, _write_method_data),
    (Interface, _write_interface),
    (DataTypeDeclaration, _write_data_type),
    (VariableSection, _write_declared),
    (Variable, _write_variable),
    (Resource, _write_resource),
    (Configuration, _write_configuration),
    (Task, _write_task),
    (Project, _write_project),
)
