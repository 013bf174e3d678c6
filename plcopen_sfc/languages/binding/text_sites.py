"""Text sites: every place of the model in which program text can name something.

The walk knows no format and no grammar: a table maps each field of the model to its reading. Fields that are not in
it hold no names; a test holds that every text of the model is in one of the two tables.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from types import MappingProxyType
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin

from plcopen_sfc.languages.declarations.kept_texts import KEPT_DATA, inheritance, unwrapped
from plcopen_sfc.languages.networks.box_trees import is_box_tree
from plcopen_sfc.languages.networks.exported_networks import EXPORTS
from plcopen_sfc.languages.st import Parsed, parse_body, parse_condition, render, transform
from plcopen_sfc.languages.st.nodes import Node
from plcopen_sfc.languages.translation.renames import NAMES_DATA
from plcopen_sfc.model import body as b
from plcopen_sfc.model import network as n
from plcopen_sfc.model import sfc as s
from plcopen_sfc.model import types as t
from plcopen_sfc.model.actions import ForcingOrder
from plcopen_sfc.model.base import ExtensionData, ForeignData, Model
from plcopen_sfc.model.conditions import Expression, NamedCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import LateElement
from plcopen_sfc.model.pou import Action, DataBlock, Method, NamedTransition, Pou
from plcopen_sfc.model.project import (
    Configuration,
    PouInstance,
    Project,
    Resource,
    Tag,
    TagTable,
    Task,
    TaskSettings,
    TreeNode,
)
from plcopen_sfc.model.sfc import ActionAssociation
from plcopen_sfc.model.variables import AccessVariable, ConfigVariable, Interface, VariableSection


class SiteKind(StrEnum):
    """Kind of a text: how it is read.

    NETWORKS: drawn ones as exports of CoDeSys 2.3 have them. REPEATED: a list of global variables that CODESYS has a
    second time. KEPT: parts of declarations that the model has no field for. PROPERTY: a property, kept as text.
    """

    STATEMENTS = "statements"
    EXPRESSION = "expression"
    INSTRUCTIONS = "instructions"
    DECLARATIONS = "declarations"
    NAME = "name"
    FOREIGN = "foreign"
    REPEATED = "repeated"
    KEPT = "kept"
    PROPERTY = "property"
    NETWORKS = "networks"


class Role(StrEnum):
    """Uses of names, where these decide which of several things a name means.

    Where a name belongs to `TextSite.owner`: PARAMETER, of this block; MEMBER, of this value; STEP, of this chart;
    OBJECT: the last of these nodes of the project tree, each inside the one before. HEAD: what a text of declarations
    declares as a whole. ACTION: what an association or a statement executes, CALL: what is called with arguments.
    """

    VALUE = "value"
    TYPE = "type"
    ACTION = "action"
    CALL = "call"
    TRANSITION = "transition"
    PARAMETER = "parameter"
    MEMBER = "member"
    STEP = "step"
    OBJECT = "object"
    HEAD = "head"


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """Site of a text, as far as it decides what is visible there: the innermost chart is the first."""

    pou: Pou | None = None
    method: Method | None = None
    transition: NamedTransition | s.BodyCondition | None = None
    charts: tuple[s.SfcNetwork, ...] = ()
    place: str = ""


@dataclass(frozen=True, slots=True)
class ValueOf:
    """The type of an initial value: of a variable, or of the member below it that `members` lead to."""

    type: t.DataType
    members: tuple[t.MemberValue, ...] = ()


@dataclass(slots=True, eq=False)  # frozen ones take three times as long to make, and there is one for every text
class TextSite:
    """A text of the model: field or item `key` of `holder`.

    `path` is its place in words; `language` is that of the body or ``declaration``.
    `report_path` is the path in the words of messages and reports: ``POU Main / action Fill`` for ``Main.Fill``.
    """

    holder: Any
    key: str | int
    reading: SiteKind
    role: Role
    site: Site
    path: str
    language: str
    owner: Any = None
    report_path: str = ""

    @property
    def is_program_text(self) -> bool:
        """True if it is an expression or statements, rather than a bare name, a type or the cycle of a task."""
        if self.reading is SiteKind.STATEMENTS:
            return True
        plain = self.key == "type_name" or isinstance(self.holder, Task | TaskSettings)
        return self.reading is SiteKind.EXPRESSION and self.role in (Role.VALUE, Role.ACTION) and not plain

    @property
    def text(self) -> str:
        """The text as it is now."""
        text: str = self.holder[self.key] if isinstance(self.key, int) else getattr(self.holder, self.key)
        return text

    def parsed(self, dialect: Dialect) -> Parsed[Any]:
        """Return a program text as a tree: statements, or an expression with what may be around a condition."""
        return (parse_body if self.reading is SiteKind.STATEMENTS else parse_condition)(self.text, dialect)

    def rewritten(self, dialect: Dialect, change: Callable[[Node], Node]) -> str:
        """Return a program text with `change` applied to its tree, as by `transform`; itself if it cannot be read."""
        parsed = self.parsed(dialect)
        return self.text if parsed.problems else render(parsed, transform(parsed.tree, change))

    def put(self, text: str) -> None:
        """Put another text in its place."""
        if isinstance(self.key, int):
            self.holder[self.key] = text
        else:
            setattr(self.holder, self.key, text)


_STATEMENTS = (SiteKind.STATEMENTS, Role.VALUE)
_EXPRESSION = (SiteKind.EXPRESSION, Role.VALUE)
_ACTION = (SiteKind.EXPRESSION, Role.ACTION)
_TYPE = (SiteKind.EXPRESSION, Role.TYPE)
_DECLARATIONS = (SiteKind.DECLARATIONS, Role.VALUE)
_FOREIGN = (SiteKind.FOREIGN, Role.VALUE)
_STEP = (SiteKind.NAME, Role.STEP)

NAMING: dict[type[Model], dict[str, tuple[SiteKind, Role]]] = {
    b.StBody: {"text": _STATEMENTS},
    b.IlBody: {"text": (SiteKind.INSTRUCTIONS, Role.VALUE)},
    b.OpaqueBody: {"content": _FOREIGN},
    ExtensionData: {"elements": _FOREIGN},
    ForeignData: {"content": _FOREIGN},
    Expression: {"text": _EXPRESSION},
    NamedCondition: {"name": (SiteKind.EXPRESSION, Role.TRANSITION)},
    ActionAssociation: {"target": _ACTION, "value": _EXPRESSION, "duration": _EXPRESSION, "indicator": _EXPRESSION},
    s.Step: {
        "entry_action": _ACTION,
        "main_action": _ACTION,
        "exit_action": _ACTION,
        "min_time": _EXPRESSION,
        "max_time": _EXPRESSION,
        "warning_time": _EXPRESSION,
    },
    s.Enclosure: {"activated_steps": _STEP},
    s.PartialChart: {"entry_step": _STEP, "exit_step": _STEP},
    ForcingOrder: {"steps": _STEP},
    n.Block: {"type_name": (SiteKind.EXPRESSION, Role.ACTION), "instance": _EXPRESSION, "code": _STATEMENTS},
    n.BlockVariable: {"name": (SiteKind.NAME, Role.PARAMETER)},
    n.Connection: {"pin": (SiteKind.NAME, Role.PARAMETER)},
    n.InputPin: {"expression": _EXPRESSION},
    n.OutputPin: {"expression": _EXPRESSION},
    n.InputVariable: {"expression": _EXPRESSION},
    n.OutputVariable: {"expression": _EXPRESSION},
    n.InOutVariable: {"expression": _EXPRESSION},
    n.Contact: {"variable": _EXPRESSION},
    n.Coil: {"variable": _EXPRESSION},
    t.DerivedType: {"name": _TYPE},
    t.Variable: {"address": (SiteKind.NAME, Role.VALUE)},
    t.Dimension: {"lower": _EXPRESSION, "upper": _EXPRESSION},
    t.StringType: {"length": _EXPRESSION},
    t.EnumValue: {"value": _EXPRESSION},
    t.SimpleValue: {"text": _EXPRESSION},
    t.RepeatedValue: {"repetitions": _EXPRESSION},
    t.MemberValue: {"member": (SiteKind.NAME, Role.MEMBER)},
    t.DataTypeDeclaration: {"declaration": _DECLARATIONS},
    Interface: {"declaration": _DECLARATIONS},
    VariableSection: {"declaration": _DECLARATIONS},
    ConfigVariable: {"path": _EXPRESSION},
    AccessVariable: {"path": _EXPRESSION},
    Tag: {"type": _TYPE},
    Task: {"interval": _EXPRESSION, "single": _EXPRESSION},
    TaskSettings: {"interval": _EXPRESSION, "event": _EXPRESSION},
    DataBlock: {"type_name": _TYPE},
    PouInstance: {"name": _TYPE, "type_name": _TYPE},
    TreeNode: {"name": (SiteKind.NAME, Role.OBJECT)},
}
"""The fields that hold names, and how they are read."""

NAMELESS: dict[str, frozenset[str]] = {
    "names of the objects themselves": frozenset(
        """
        Action.name Configuration.name DataBlock.name DataTypeDeclaration.name EnumValue.name Method.name
        NamedTransition.name PartialChart.name Pou.name Project.name Resource.name Step.name Tag.name TagTable.name
        Task.name Transition.name Variable.name VariableSection.name AccessVariable.alias BodyCondition.name
        ProjectObject.name
        """.split()
    ),
    "names within a drawing or a body, which nothing else uses": frozenset(
        """
        Connector.name Continuation.name Jump.label Label.label OutputPin.name Symbol.name SfcSettings.other_flags
        Enclosure.chart ForcingOrder.chart Macro.expansion
        """.split()
    ),
    "texts for people": frozenset(
        """
        AlarmCategory.name AlarmCategory.text CommentBox.content ErrorBox.content LogicNetwork.title
        PermanentOperation.title Sequence.title Step.title Supervised.title Supervised.alarm Transition.title
        VendorElement.alternative_text ForeignDataInfo.description Project.content_comment
        BodyBase.title StBody.title IlBody.title FbdBody.title LdBody.title SfcBody.title OpaqueBody.title Pou.title
        DataBlock.title DataTypeDeclaration.title
        """.split()
    ),
    "the same text with its markup": frozenset({"StBody.markup", "Expression.markup", "IlBody.markup"}),
    "about the file and the tool": frozenset(
        """
        BodyBase.worksheet StBody.worksheet IlBody.worksheet FbdBody.worksheet LdBody.worksheet SfcBody.worksheet
        OpaqueBody.worksheet OpaqueBody.source FileHeader.company FileHeader.company_url FileHeader.product
        FileHeader.version FileHeader.release FileHeader.created FileHeader.description ForeignData.name
        ForeignDataInfo.name ForeignDataInfo.vendor ForeignDataInfo.version ExtensionData.attributes
        GraphSettings.version GraphSettings.initial_values_acquisition GraphSettings.network_language Project.version
        Project.modified Project.organization Project.author Project.origin RuntimeLibrary.title Variable.attributes
        RuntimeLibrary.company RuntimeLibrary.version RuntimeLibrary.namespace TaskSettings.interval_unit
        TaskSettings.attributes TaskWatchdog.time TaskWatchdog.time_unit TaskWatchdog.sensitivity
        VendorElement.element_type VendorElement.attributes DataTypeDeclaration.place Pou.place ProjectObject.folder
        DataBlock.folder DataTypeDeclaration.folder Pou.folder TagTable.folder
        """.split()
    ),
    "addresses": frozenset({"ConfigVariable.address", "Tag.address"}),
}
"""The fields that hold texts without names that a rename concerns, by reason. ``object_id`` and the like go without."""


class _Where(NamedTuple):
    """Objects around the one that the walk is at. A tuple, as each object in a chart gets one of its own."""

    site: Site
    path: str
    language: str
    owner: Any = None
    nodes: dict[int, Any] | None = None
    labels: Mapping[int, str] = MappingProxyType({})
    report_path: str = ""
    words: Collection[str] = ()
    homes: frozenset[int] | None = None

    def at(self, label: str, labels: Mapping[int, str] | None = None) -> _Where:
        path, report_path = _below_path(self.path, label), _below_path(self.report_path, label)
        labels = self.labels if labels is None else labels
        # `_replace` takes four times as long, and every step and action is a place of its own
        return _Where(
            self.site, path, self.language, self.owner, self.nodes, labels, report_path, self.words, self.homes
        )

    def inside(self, name: str, kind: str) -> _Where:
        """Return the site of a part of a POU: an action, a transition, a method."""
        return self._replace(path=f"{self.path}.{name}", report_path=_below_path(self.report_path, f"{kind} {name}"))


def _below_path(path: str, label: str) -> str:
    return f"{path} / {label}" if path else label


def text_sites(project: Project, words: Collection[str] = (), homes: Collection[Pou] | None = None) -> list[TextSite]:
    """Return every text of `project` that may name something.

    With `words` (in small letters), charts that mention none of them are left out, and stay unread. With `homes`, the
    words are names of steps and transitions of these POUs, which other charts can only mention behind a dot.
    """
    if not words:
        project.read_all()
    at_home = frozenset(map(id, homes)) if homes is not None else None
    found: list[TextSite] = []
    _collect(project, _Where(Site(), "", "project", words=words, homes=at_home), found)
    return found


def text_sites_in(thing: Model) -> list[TextSite]:
    """Return every text in an object of the model that may name something, as if nothing were around it."""
    found: list[TextSite] = []
    _collect(thing, _Where(Site(), "", ""), found)
    return found


def _collect(thing: Any, where: _Where, found: list[TextSite]) -> None:
    """Add the texts in an object to `found`: generators inside each other would take twice the time."""
    kind: type[Model] = type(thing)
    fields = _telling_fields(kind)
    if not fields or (where.words and _is_without(thing, where)):
        return
    entering = _ENTERING.get(kind)
    if entering is not None:
        where = entering(thing, where)
    if isinstance(thing, LateElement):
        thing.read()
    content = thing.__dict__
    for key, how in fields:
        value = content.get(key)
        if not value:
            continue  # half of all fields; an object of the model is never false
        if isinstance(value, str):
            if how is not None and not (value == "*" and isinstance(thing, t.Dimension)):
                _add_named(thing, key, how, where, found)
        elif isinstance(value, list):
            if isinstance(value[0], Model):
                below = _below(thing, key, where)
                for item in value:
                    _collect(item, below, found)
            elif how is not None:
                for index in range(len(value)):
                    _add_named(value, index, how, where, found)
        elif isinstance(value, Model):
            _collect(value, _below(thing, key, where), found)


def _is_without(thing: Any, where: _Where) -> bool:
    """True if none of the words looked for can be in an object."""
    if isinstance(thing, s.SfcNetwork):
        pou = where.site.pou
        abroad = where.homes is not None and pou is not None and id(pou) not in where.homes
        as_members = abroad and not inheritance(pou.interface if pou is not None else None).extends
        return not thing.may_mention(where.words, as_members=as_members)
    if isinstance(thing, LateElement):
        return thing.is_unread and not thing.may_mention(where.words)
    if isinstance(thing, t.Variable):
        others = map(thing.__dict__.get, _OTHER_FIELDS)
        return type(thing.type) is t.ElementaryType and not any(others) and not _overlays(thing)
    return False


_OTHER_FIELDS = tuple(name for name in t.Variable.model_fields if name not in {"name", "type", "address", "attributes"})
"""The fields of a variable but for those that name nothing where its type is elementary and it is no overlay."""


def _overlays(variable: t.Variable) -> bool:
    """True if a variable is at the address of another one, as S7 has it: ``bits AT word : ARRAY[0..15] OF BOOL``."""
    return bool(variable.address) and not str(variable.address).lstrip().startswith("%")


@cache
def _telling_fields(kind: type[Model]) -> tuple[tuple[str, tuple[SiteKind, Role] | None], ...]:
    """Return the fields of a class that name something, with their reading, and those that may hold objects.

    Nine of ten fields are neither, and most objects of a drawing have no other ones.
    """
    naming = NAMING.get(kind, {})
    return tuple(
        (name, naming.get(name))
        for name, field in kind.model_fields.items()
        if name in naming or not _is_plain(field.annotation)
    )


def _is_plain(annotation: Any) -> bool:
    """True if no value of this type is an object of the model. What is not resolved yet may be one."""
    if isinstance(annotation, type) and not get_args(annotation):
        return not issubclass(annotation, Model) and annotation.__module__ != "typing"
    parts = get_args(annotation)
    if get_origin(annotation) is Annotated:
        parts = parts[:1]
    return get_origin(annotation) is Literal or (
        parts != () and all(_is_plain(part) for part in parts if part is not Ellipsis)
    )


def _add_named(holder: Any, key: str | int, how: tuple[SiteKind, Role], where: _Where, found: list[TextSite]) -> None:
    """Add the text of a field, read as the objects around it tell where its class alone does not."""
    reading, role = how
    owner = where.owner
    if isinstance(holder, n.Connection):
        owner = (where.nodes or {}).get(holder.source)
        if not isinstance(owner, n.Block | n.VendorElement):
            return  # the pins of all other elements have no names that something declares
    elif isinstance(holder, ForeignData) and isinstance(owner, VariableSection) and holder.name.endswith(_PARTS):
        reading = SiteKind.REPEATED
    elif isinstance(holder, ForeignData) and holder.name == NAMES_DATA:
        return  # what a conversion has renamed, of which nothing is executed
    elif isinstance(holder, ForeignData) and holder.name == KEPT_DATA:
        reading = SiteKind.KEPT
    elif isinstance(holder, ForeignData) and (unwrapped(holder.content) or ("",))[0] == "property":
        reading, where = SiteKind.PROPERTY, where._replace(language="ST")
    elif isinstance(holder, b.OpaqueBody) and (holder.source == EXPORTS or is_box_tree(holder.content)):
        reading = SiteKind.NETWORKS
    elif isinstance(holder, PouInstance) and key == "name" and holder.type_name:
        return  # a name of its own
    elif isinstance(holder, t.Variable) and not _overlays(holder):
        return  # a direct address
    elif isinstance(holder, TreeNode):
        if holder.folder:
            return  # the name of a folder, which is no declaration
    elif isinstance(holder, n.Block) and key == "type_name" and holder.instance:
        role = Role.TYPE
    path, report_path = where.path, where.report_path
    if not isinstance(key, int) and key not in _UNSAID:
        label = key.replace("_", " ")
        path, report_path = _below_path(path, label), _below_path(report_path, label)
    found.append(TextSite(holder, key, reading, role, where.site, path, where.language, owner, report_path))


_PARTS = "/mixedattrsvarlist"
"""The name of the data in which CODESYS repeats a list of global variables."""
_UNSAID = frozenset(
    "text name content elements variable expression declaration pin path type_name member value".split()
)
"""Fields that go without saying in a path."""


def _below(thing: Model, key: str, where: _Where) -> _Where:
    """Return the surroundings of the objects in a field."""
    if key == "initial" and isinstance(thing, t.Variable | t.DataTypeDeclaration):
        return where._replace(owner=ValueOf(thing.type))
    if key == "extension_data":
        owner = thing if isinstance(thing, VariableSection) else None
        return where._replace(language="foreign data", owner=owner)
    if key == "value" and isinstance(thing, t.MemberValue) and isinstance(where.owner, ValueOf):
        return where._replace(owner=ValueOf(where.owner.type, (*where.owner.members, thing)))
    return where


def _chart(chart: s.SfcNetwork, where: _Where) -> _Where:
    site = replace(where.site, charts=(chart, *where.site.charts))
    nodes = {node.id: node for node in chart.logic}
    return where._replace(site=site, nodes=nodes, labels=chart.labels(), owner=chart)


def _step(step: s.Step, where: _Where) -> _Where:
    labels = {each.id: label for each, label in zip(step.actions, step.action_labels(), strict=True) if each.target}
    return where.at(f"step {step.name}", labels)


def _section(section: VariableSection, where: _Where) -> _Where:
    site = where.site if where.site.pou is not None else replace(where.site, charts=())
    where = where._replace(site=site, language="declaration")
    return where.at(section.name) if section.name else where


def _resource(resource: Resource, where: _Where) -> _Where:
    place = f"{where.site.place}/resource/{resource.name}" if where.site.place else f"application/{resource.name}"
    return where.at(resource.name)._replace(site=Site(place=place))


def _partial(name: str, where: _Where) -> s.SfcNetwork | None:
    """Return the partial chart of this name in the charts around."""
    waiting = list(where.site.charts)
    while waiting:
        for partial in waiting.pop().partial_charts:
            if partial.name == name:
                return partial.chart
            waiting.append(partial.chart)
    return None


_Entering = Callable[[Any, _Where], _Where]
_ENTERING: dict[type[Model], _Entering] = {
    Pou: lambda pou, where: where._replace(
        site=Site(pou=pou, place=pou.place), path=pou.name, report_path=pou.report_path
    ),
    Action: lambda action, where: where.inside(action.name, "action"),
    NamedTransition: lambda transition, where: where.inside(transition.name, "transition")._replace(
        site=replace(where.site, transition=transition)
    ),
    s.BodyCondition: lambda condition, where: (
        where._replace(site=replace(where.site, transition=condition)) if condition.name else where
    ),
    Method: lambda method, where: where.inside(method.name, "method")._replace(site=replace(where.site, method=method)),
    DataBlock: lambda block, where: where._replace(
        path=block.name, report_path=block.report_path, language="declaration"
    ),
    Interface: lambda _, where: where._replace(language="declaration"),
    VariableSection: _section,
    t.Variable: lambda v, where: where.at(v.name)._replace(language="declaration"),
    t.DataTypeDeclaration: lambda each, where: where._replace(
        site=Site(place=each.place), path=each.name, report_path=each.report_path, language="declaration"
    ),
    **dict.fromkeys(
        (b.StBody, b.IlBody, b.FbdBody, b.LdBody, s.SfcBody, b.OpaqueBody),
        lambda body, where: where._replace(language=body.language),
    ),
    s.SfcNetwork: _chart,
    s.Step: _step,
    s.Transition: lambda each, where: where.at(f"transition {where.labels.get(each.id, each.name)}"),
    s.PartialChart: lambda partial, where: where.at(partial.name)._replace(owner=partial.chart),
    **dict.fromkeys((s.Enclosure, ForcingOrder), lambda each, where: where._replace(owner=_partial(each.chart, where))),
    ActionAssociation: lambda a, where: where.at(
        f"action {where.labels.get(a.id, a.target)}" if a.target else "action"
    ),
    n.LogicNetwork: lambda network, where: where._replace(nodes={node.id: node for node in network.nodes}),
    n.Block: lambda block, where: where.at(f"block {block.instance or block.type_name}")._replace(owner=block),
    n.VendorElement: lambda element, where: where._replace(owner=element),
    Resource: _resource,
    Configuration: lambda each, where: where.at(each.name)._replace(site=Site(place=f"configuration/{each.name}")),
    Task: lambda task, where: where.at(task.name),
    TagTable: lambda table, where: where.at(table.name)._replace(report_path=table.report_path),
    Tag: lambda tag, where: where.at(tag.name),
    TreeNode: lambda node, where: where._replace(
        path="project tree", report_path="project tree", owner=(*(where.owner or ()), node)
    ),
}
