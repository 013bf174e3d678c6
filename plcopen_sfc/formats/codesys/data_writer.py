"""Writes the data that CODESYS and TwinCAT add to PLCopen XML. The reader is `data_reader`."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Any

from lxml import etree

from plcopen_sfc.formats.codesys import names
from plcopen_sfc.formats.codesys.data_reader import is_reformatted
from plcopen_sfc.formats.plcopen.body_writer import write_body, write_pou
from plcopen_sfc.formats.plcopen.project_writer import write_resource
from plcopen_sfc.formats.plcopen.types_writer import (
    write_data_type_declaration,
    write_interface,
    write_lists,
    write_section,
)
from plcopen_sfc.formats.plcopen.versions import XHTML
from plcopen_sfc.formats.plcopen.writing import WriteContext, Written, finish
from plcopen_sfc.formats.xml.extension_data import legal_text
from plcopen_sfc.languages.declarations.inheritance import kept_inheritance
from plcopen_sfc.languages.declarations.kept import KEPT_DATA
from plcopen_sfc.model.actions import ActionAssociation, Monitoring, SymbolAccess
from plcopen_sfc.model.base import Carried, Model, UnknownDataRule
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.conditions import BodyCondition, Expression, NamedCondition
from plcopen_sfc.model.drawing import Symbol, SymbolKind
from plcopen_sfc.model.network import Block, VendorElement
from plcopen_sfc.model.pou import Action, Method, NamedTransition, Pou
from plcopen_sfc.model.project import Configuration, Project, Resource, Task, TreeNode
from plcopen_sfc.model.sfc import SfcSettings, Step, Transition
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.model.variables import Interface, VariableSection
from plcopen_sfc.report import ConversionReport

_DISCARD = UnknownDataRule.DISCARD
_IMPLEMENTATION = UnknownDataRule.IMPLEMENTATION
_SYMBOLS = {SymbolAccess(value): str(i) for i, value in enumerate(names.SYMBOL_VALUES)}
_MONITORINGS = {Monitoring(value): str(i) for i, value in enumerate(names.MONITORING_VALUES)}

NATIVE_FIELDS = {
    "project": frozenset({"applications", "tree", "global_variables"}),
    "resource": frozenset({"object_id", "place"}),
    "configuration": frozenset({"object_id"}),
    "task": frozenset({"settings", "object_id"}),
    "pou": frozenset({"object_id", "methods"}),
    "interface": frozenset({"declaration"}),
    "action": frozenset({"object_id", "exclude", "symbol", "comment"}),
    "action_object": frozenset({"object_id"}),
    "transition_object": frozenset({"object_id"}),
    "method": frozenset({"object_id"}),
    "dataType": frozenset({"object_id", "declaration", "place"}),
    "globalVars": frozenset({"object_id", "declaration"}),
    "chart": frozenset({"settings"}),
    "step": frozenset(
        {
            "exclude",
            "symbol",
            "duplicate",
            "min_time",
            "max_time",
            "main_action",
            "entry_action",
            "exit_action",
            "comment",
        }
    ),
    "transition": frozenset({"exclude", "symbol", "duplicate", "monitoring", "comment"}),
    "selectionDivergence": frozenset({"exclude", "name", "comment"}),
    "simultaneousDivergence": frozenset({"exclude", "name", "comment"}),
    "jumpStep": frozenset({"exclude", "comment"}),
    "block": frozenset({"call", "code"}),
    "vendorElement": frozenset({"element_type", "attributes"}),
}
"""The fields that this module writes, by the kind of their owner."""

NATIVE_TEXTS = frozenset({"extends", "implements"})
"""The texts kept of declarations that this module writes."""

DATA_RANK = {
    KEPT_DATA: 1,
    names.POU_INHERITANCE: 5,
    names.TYPE_INHERITANCE: 5,
    names.DATA_TYPE: 5,
    names.POU: 6,
    names.METHOD: 7,
    names.SFC_SETTINGS: 10,
    names.TASK_SETTINGS: 10,
    names.APPLICATION: 10,
    names.GLOBAL_VARS: 10,
    names.CALL_TYPE: 10,
    names.ST_CODE: 60,
    names.PLAIN_TEXT: 60,
    names.PROJECT_STRUCTURE: 70,
    names.OBJECT_ID: 80,
    names.MIXED_LIST: 90,
}
"""The order of data at one owner; what is not named here stands in the middle."""


@lru_cache(maxsize=32)
def core_version(product_version: str) -> tuple[int, ...]:
    """The version of the CODESYS core: ``CODESYS V3.5 SP14 Patch 1`` and TwinCAT's ``3.5.13.20`` as (3, 5, 14, 1)."""
    match = re.search(r"V?(\d+)\.(\d+)(?:\s+SP(\d+))?(?:\s+Patch\s+(\d+))?((?:\.\d+)*)", product_version)
    if match is None:
        return ()
    major, minor, pack, patch, rest = match.groups()
    if rest:
        return (int(major), int(minor), *map(int, rest.strip(".").split(".")))
    return (int(major), int(minor), int(pack or 0), int(patch or 0))


def write_data(ctx: WriteContext, thing: Model, owner: str) -> Iterator[Written]:
    """The tool's own data of `thing`."""
    for kind, writer in _WRITERS:
        if isinstance(thing, kind):
            yield from writer(ctx, thing, owner)
            return


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
    attributes = {"name": names.PROJECT_STRUCTURE, "handleUnknown": _DISCARD.value}
    data = etree.SubElement(holder, f"{namespace}data", attributes)
    etree.SubElement(data, f"{namespace}ProjectStructure")


def _text_element(ctx: WriteContext, name: str, text: str) -> etree._Element:
    element = etree.Element(ctx.version_tag(name), nsmap={None: ctx.version.namespace})  # type: ignore[dict-item]
    element.text = legal_text(text)
    return element


def _object_id(ctx: WriteContext, object_id: str | None) -> Iterator[Written]:
    if object_id is not None:
        yield names.OBJECT_ID, _DISCARD, _text_element(ctx, "ObjectId", object_id)


def _declaration(ctx: WriteContext, thing: Interface | DataTypeDeclaration | VariableSection) -> Iterator[Written]:
    text = thing.declaration
    if text is not None and id(thing) not in ctx.stale:
        holder = etree.Element(ctx.version_tag("InterfaceAsPlainText"), nsmap={None: ctx.version.namespace})  # type: ignore[dict-item]
        etree.SubElement(holder, f"{{{XHTML}}}xhtml", nsmap={None: XHTML}).text = legal_text(text)  # type: ignore[dict-item]
        yield names.PLAIN_TEXT, _IMPLEMENTATION, holder


# -- chart elements ---------------------------------------------------------------------------------------------------


def _truth(value: bool | None) -> str:
    return "TRUE" if value else "FALSE"


def _attributes(carried: Carried | None, pairs: list[tuple[str, str | None]]) -> etree._Element:
    """The attribute table: `pairs` of GUID and value (None or empty: left out), and those that were carried."""
    kept: dict[str, str] = {}
    for data in carried.data if carried is not None else ():
        if data.name == names.SFC_ELEMENT:
            for attribute in etree.fromstring(data.content):
                kept[attribute.get("guid", "")] = attribute.text or ""
    table = etree.Element("attributes", nsmap={None: ""})  # type: ignore[dict-item]
    for guid, value in pairs:
        text = value or ""
        if guid in kept:
            raw = kept.pop(guid)
            # the file has blanks around the value, or writes it in another way
            unheard_of = text in ("0", "FALSE") and raw.strip() not in _VALUES.get(guid, {raw.strip()})
            text = raw if unheard_of or raw.split() == text.split() else text and padded(text, raw)
        if text:
            etree.SubElement(table, "attribute", guid=guid).text = legal_text(text)
    for guid, raw in kept.items():
        if guid not in _KNOWN:
            etree.SubElement(table, "attribute", guid=guid).text = legal_text(raw)
    return table


_VALUES = {
    names.EXCLUDE: {"TRUE", "FALSE"},
    names.DUPLICATION: {"TRUE", "FALSE"},
    names.SYMBOL: set(_SYMBOLS.values()),
    names.MONITORING: set(_MONITORINGS.values()),
}
"""The values that the model has a place for, of attributes that are carried where they have another."""


def padded(text: str, raw: str) -> str:
    """`text` with the blanks that stand around `raw` where a formatter has put the end tag on a line of its own."""
    if not is_reformatted(raw):
        return text
    return raw[: len(raw) - len(raw.lstrip())] + text + raw[len(raw.rstrip()) :]


_KNOWN = frozenset(
    {names.NAME, names.EXCLUDE, names.SYMBOL, names.INITIAL, names.DUPLICATION, names.QUALIFIER, names.PARALLEL}
)


def _name_of(action: object) -> str | None:
    return action if isinstance(action, str) else None


def _modern(ctx: WriteContext, *version: int) -> bool:
    """Whether the target tool's core is at least `version`; an unknown one is taken for the newest."""
    core = core_version(ctx.project.header.version)
    return not core or core >= version


def _step(ctx: WriteContext, step: Step, _owner: str) -> Iterator[Written]:
    duplicate = step.duplicate or _modern(ctx, 3, 5, 10)
    table = _attributes(
        step.carried,
        [
            (names.NAME, step.name),
            (names.COMMENT, _comment(step.comment)),
            (names.EXCLUDE, _truth(step.exclude)),
            (names.SYMBOL, _SYMBOLS[step.symbol]),
            (names.INITIAL, _truth(step.initial)),
            (names.DUPLICATION, _truth(step.duplicate) if duplicate else None),
            (names.MIN_TIME, step.min_time),
            (names.MAX_TIME, step.max_time),
            (names.MAIN_ACTION, _name_of(step.main_action)),
            (names.ENTRY_ACTION, _name_of(step.entry_action)),
            (names.EXIT_ACTION, _name_of(step.exit_action)),
        ],
    )
    yield names.SFC_ELEMENT, _IMPLEMENTATION, table


def _comment(comment: object) -> str | None:
    return comment if isinstance(comment, str) else getattr(comment, "text", None)


def condition_text(transition: Transition) -> str:
    """What the editor shows at a transition: the expression, or the name of the transition object."""
    condition = transition.condition
    if isinstance(condition, Expression):
        return condition.text
    if isinstance(condition, NamedCondition | BodyCondition):
        return condition.name
    return ""


def _transition(ctx: WriteContext, transition: Transition, _owner: str) -> Iterator[Written]:
    duplicate = transition.duplicate or _modern(ctx, 3, 5, 10)
    monitoring = transition.monitoring is not Monitoring.NONE or _modern(ctx, 3, 5, 13)
    table = _attributes(
        transition.carried,
        [
            (names.NAME, condition_text(transition)),
            (names.COMMENT, _comment(transition.comment)),
            (names.EXCLUDE, _truth(transition.exclude)),
            (names.SYMBOL, _SYMBOLS[transition.symbol]),
            (names.DUPLICATION, _truth(transition.duplicate) if duplicate else None),
            (names.MONITORING, _MONITORINGS[transition.monitoring] if monitoring else None),
        ],
    )
    yield names.SFC_ELEMENT, _IMPLEMENTATION, table


def _association(_ctx: WriteContext, association: ActionAssociation, _owner: str) -> Iterator[Written]:
    qualifier = " ".join(filter(None, (association.qualifier.value, association.duration)))
    table = _attributes(
        association.carried,
        [
            (names.NAME, association.target),
            (names.COMMENT, _comment(association.comment)),
            (names.EXCLUDE, _truth(association.exclude)),
            (names.SYMBOL, _SYMBOLS[association.symbol]),
            (names.QUALIFIER, qualifier),
        ],
    )
    yield names.SFC_ELEMENT, _IMPLEMENTATION, table


def _symbol(ctx: WriteContext, symbol: Symbol, owner: str) -> Iterator[Written]:
    if symbol.kind is SymbolKind.JUMP:
        pairs = [(names.NAME, ctx.jump_name), (names.COMMENT, _comment(symbol.comment))]
        pairs.append((names.EXCLUDE, _truth(symbol.exclude)))
    elif owner in ("selectionDivergence", "simultaneousDivergence"):
        pairs = [(names.NAME, symbol.name), (names.COMMENT, _comment(symbol.comment))]
        pairs.append((names.EXCLUDE, _truth(symbol.exclude)))
        pairs.append((names.PARALLEL, _truth(symbol.kind is SymbolKind.SIMULTANEOUS_DIVERGENCE)))
    else:
        return
    yield names.SFC_ELEMENT, _IMPLEMENTATION, _attributes(symbol.carried, pairs)


# -- objects ----------------------------------------------------------------------------------------------------------


def settings_element(ctx: WriteContext, settings: SfcSettings) -> etree._Element:
    """``SFCSettings``."""
    namespace = ctx.version.namespace
    root = etree.Element(f"{{{namespace}}}SFCSettings", nsmap={None: namespace})  # type: ignore[dict-item]

    def text(name: str, value: str) -> None:
        etree.SubElement(root, f"{{{namespace}}}{name}").text = value or None

    if settings.library is not None:
        text("LibTitle", settings.library.title)
        text("LibCompany", settings.library.company)
        text("LibVersion", settings.library.version)
        text("LibNamespace", settings.library.namespace)
    if settings.active_transitions_only is not None:
        text("CalcActiveTransOnly", str(settings.active_transitions_only).lower())
    if settings.use_defaults is not None:
        text("UseDefaults", str(settings.use_defaults).lower())
    flags = {flag.value: use for flag, use in settings.flags.items()} | settings.other_flags
    holder = etree.SubElement(root, f"{{{namespace}}}Flags")
    for name, use in flags.items():
        switches = {"Declare": str(use.declare).lower(), "Use": str(use.use).lower()}
        etree.SubElement(holder, f"{{{namespace}}}{name}", switches)
    return root


def _settings(ctx: WriteContext, bodies: list[object]) -> Iterator[Written]:
    if ctx.body_name in ctx.untouched:
        return
    chart = next((body.chart for body in bodies if isinstance(body, SfcBody)), None)
    if chart is not None and chart.settings is not None:
        yield names.SFC_SETTINGS, _IMPLEMENTATION, settings_element(ctx, chart.settings)


def _pou(ctx: WriteContext, pou: Pou, _owner: str) -> Iterator[Written]:
    for method in pou.methods:
        yield names.METHOD, _IMPLEMENTATION, _method(ctx, method)
    yield from _settings(ctx, list(pou.bodies))
    if pou.interface is not None:
        yield from _declaration(ctx, pou.interface)
    yield from _object_id(ctx, pou.object_id)


def _method(ctx: WriteContext, method: Method) -> etree._Element:
    attributes = {"name": method.name} | ({"ObjectId": method.object_id} if method.object_id is not None else {})
    element = etree.Element(ctx.version_tag("Method"), attributes, nsmap={None: ctx.version.namespace})  # type: ignore[dict-item]
    ctx.place.append(f"method {method.name}")
    if method.interface is not None:
        write_interface(ctx, element, method.interface)
    if method.body is not None:
        outer, ctx.body_name = ctx.body_name, f"{ctx.body_name}.{method.name}"
        write_body(ctx, element, "body", method.body, {})
        ctx.body_name = outer
    finish(ctx, element, method, "method", frozenset({"name", "interface", "body"}))
    ctx.place.pop()
    return element


def _part(ctx: WriteContext, part: Action | NamedTransition, _owner: str) -> Iterator[Written]:
    yield from _settings(ctx, [part.body])
    yield from _object_id(ctx, part.object_id)


def _method_data(ctx: WriteContext, method: Method, _owner: str) -> Iterator[Written]:
    if method.interface is not None:
        yield from _declaration(ctx, method.interface)


def _interface(ctx: WriteContext, interface: Interface, _owner: str) -> Iterator[Written]:
    yield from _inheritance(ctx, names.POU_INHERITANCE, interface.carried)


def _inheritance(ctx: WriteContext, name: str, carried: Carried | None) -> Iterator[Written]:
    found = kept_inheritance(carried)
    if any(found):
        element = etree.Element(ctx.version_tag("Inheritance"), nsmap={None: ctx.version.namespace})  # type: ignore[dict-item]
        for tag, bases in (("Extends", found.extends), ("Implements", found.implements)):
            for base in bases:
                etree.SubElement(element, ctx.version_tag(tag)).text = legal_text(base)
        yield name, _IMPLEMENTATION, element


def _data_type(ctx: WriteContext, declaration: DataTypeDeclaration, owner: str) -> Iterator[Written]:
    yield from _inheritance(ctx, names.TYPE_INHERITANCE, declaration.carried)
    yield from _declared(ctx, declaration, owner)


def _declared(ctx: WriteContext, thing: DataTypeDeclaration | VariableSection, _owner: str) -> Iterator[Written]:
    yield from _declaration(ctx, thing)
    yield from _object_id(ctx, thing.object_id)
    if id(thing) in ctx.parts:
        yield names.MIXED_LIST, _IMPLEMENTATION, _mixed_list(ctx, ctx.parts[id(thing)])


def _mixed_list(ctx: WriteContext, parts: list[VariableSection]) -> etree._Element:
    """The sections of a list of global variables, whose variables are in the report with the list."""
    element = etree.Element(ctx.version_tag("MixedAttrsVarList"), nsmap={None: ctx.version.namespace})  # type: ignore[dict-item]
    report, ctx.report = ctx.report, ConversionReport()
    for part in parts:
        write_section(
            ctx, element, part.model_copy(update=dict.fromkeys(("comment", "carried", "declaration", "object_id")))
        )
    ctx.report = report
    return element


def _holder(ctx: WriteContext) -> etree._Element:
    return etree.Element(ctx.names["data"], nsmap={None: ctx.version.namespace})  # type: ignore[dict-item]


def _resource(ctx: WriteContext, resource: Resource, _owner: str) -> Iterator[Written]:
    place, project = ctx.resource_place, ctx.project
    for declaration in project.data_types:
        if declaration.place == place:
            holder = _holder(ctx)
            write_data_type_declaration(ctx, holder, declaration, in_place=True)
            yield names.DATA_TYPE, _IMPLEMENTATION, holder[0]
    for pou in project.pous:
        if pou.place == place:
            holder = _holder(ctx)
            write_pou(ctx, holder, pou, in_place=True)
            yield names.POU, _IMPLEMENTATION, holder[0]
    yield from _object_id(ctx, resource.object_id)


def _project(ctx: WriteContext, project: Project, owner: str) -> Iterator[Written]:
    if owner != "project":
        return
    for application in project.applications:
        holder = _holder(ctx)
        write_resource(ctx, holder, application, f"application/{application.name}")
        yield names.APPLICATION, _IMPLEMENTATION, holder[0]
    holder = _holder(ctx)
    write_lists(ctx, holder, project.global_variables)
    for element in list(holder):
        yield names.GLOBAL_VARS, _IMPLEMENTATION, element
    if project.tree is not None:
        root = etree.Element(ctx.version_tag("ProjectStructure"), nsmap={None: ctx.version.namespace})  # type: ignore[dict-item]
        for node in project.tree:
            _tree_node(ctx, root, node)
        yield names.PROJECT_STRUCTURE, _DISCARD, root


def _tree_node(ctx: WriteContext, parent: etree._Element, node: TreeNode) -> None:
    attributes = {"Name": node.name} | ({"ObjectId": node.object_id} if node.object_id is not None else {})
    element = etree.SubElement(parent, ctx.version_tag("Folder" if node.folder else "Object"), attributes)
    for child in node.children:
        _tree_node(ctx, element, child)


def _configuration(ctx: WriteContext, configuration: Configuration, _owner: str) -> Iterator[Written]:
    yield from _object_id(ctx, configuration.object_id)


def _task(ctx: WriteContext, task: Task, _owner: str) -> Iterator[Written]:
    settings = task.settings
    if settings is not None:
        pairs = (
            ("KindOfTask", settings.kind),
            ("Interval", settings.interval),
            ("IntervalUnit", settings.interval_unit),
            ("Event", settings.event),
        )
        attributes = {name: value for name, value in pairs if value is not None} | settings.attributes
        element = etree.Element(ctx.version_tag("TaskSettings"), attributes, nsmap={None: ctx.version.namespace})  # type: ignore[dict-item]
        if settings.watchdog is not None:
            dog = settings.watchdog
            pairs = (
                ("Enabled", str(dog.enabled).lower()),
                ("Time", dog.time),
                ("TimeUnit", dog.time_unit),
                ("Sensitivity", dog.sensitivity),
            )
            attributes = {name: value for name, value in pairs if value is not None}
            etree.SubElement(element, ctx.version_tag("Watchdog"), attributes)
        yield names.TASK_SETTINGS, _IMPLEMENTATION, element
    yield from _object_id(ctx, task.object_id)


def _no_namespace(name: str, text: str) -> etree._Element:
    element = etree.Element(name, nsmap={None: ""})  # type: ignore[dict-item]
    element.text = legal_text(text) or None
    return element


def _block(_ctx: WriteContext, block: Block, _owner: str) -> Iterator[Written]:
    if block.call is not None:
        yield names.CALL_TYPE, _IMPLEMENTATION, _no_namespace("CallType", block.call.value)
    if block.code is not None:
        yield names.ST_CODE, _IMPLEMENTATION, _no_namespace("STCode", block.code)


def _vendor(_ctx: WriteContext, element: VendorElement, _owner: str) -> Iterator[Written]:
    if element.element_type is not None:
        yield names.ELEMENT_TYPE, _IMPLEMENTATION, _no_namespace("ElementType", element.element_type)
    if element.attributes:
        table = _no_namespace("fbdattributes", "")
        for name, value in element.attributes.items():
            etree.SubElement(table, "attribute", name=name, value=value)
        yield names.FBD_ATTRIBUTES, _IMPLEMENTATION, table


_WRITERS: tuple[tuple[type[Model], Callable[[WriteContext, Any, str], Iterator[Written]]], ...] = (
    (Step, _step),
    (Transition, _transition),
    (ActionAssociation, _association),
    (Symbol, _symbol),
    (Block, _block),
    (VendorElement, _vendor),
    (Pou, _pou),
    (Action, _part),
    (NamedTransition, _part),
    (Method, _method_data),
    (Interface, _interface),
    (DataTypeDeclaration, _data_type),
    (VariableSection, _declared),
    (Resource, _resource),
    (Configuration, _configuration),
    (Task, _task),
    (Project, _project),
)
