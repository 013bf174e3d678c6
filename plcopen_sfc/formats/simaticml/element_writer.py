"""Elements of SimaticML for all writers: namespaces of a version, texts, and extension data."""

from __future__ import annotations

import json
from functools import cached_property, lru_cache
from typing import Any
from xml.etree import ElementTree as ET

from lxml import etree

from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.simaticml.action_functions import ActionControls, ActionFunctions
from plcopen_sfc.formats.simaticml.declaration_spelling import LAYOUT
from plcopen_sfc.formats.simaticml.element_reader import VERBATIM, N
from plcopen_sfc.formats.simaticml.tia_versions import TiaVersion, concrete, namespace
from plcopen_sfc.formats.xml.extension_data import (
    COMMENT_MARK,
    add_markup,
    elements_of,
    fields_left,
    legal_text,
    parsed_markup,
)
from plcopen_sfc.languages.s7_actions import ActionCalls
from plcopen_sfc.languages.s7_globals import called_actions
from plcopen_sfc.languages.s7_types import s7_types
from plcopen_sfc.model.base import ExtensionData, Model
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project, Tag
from plcopen_sfc.model.text import MultilingualText, Text, plain
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import Cause, ConversionReport, Outcome

ID = "ID"
"""Written empty first: ids are running numbers, which the whole document gets at the end."""


EXECUTED = {
    "address": "variables of blocks have no address in TIA Portal: it is connected to no input or output",
    "initial": "TIA Portal cannot write this start value: the variable starts with the usual value of its type",
    "return_type": "the block has no result",
    "sections": "TIA Portal has no such section: its variables are not declared",
    "partial_charts": "S7-GRAPH has no partial charts: they are not executed",
}
"""Fields that a controller executes, and the behaviour of the machine without them."""


class DocumentWriting:
    """State of writing one project."""

    def __init__(
        self,
        project: Project,
        version: TiaVersion,
        schemas: dict[str, int],
        report: ConversionReport,
        options: WriteOptions,
    ) -> None:
        self.project = project
        self.version = version
        self.schemas = schemas
        """Schema numbers to write, by kind; 0: no namespace."""
        self.report = report
        self.options = options
        self.s7_types = s7_types(project)
        """Types that TIA Portal has for those of the project."""
        self.culture = project.language or "en-US"
        """Language of texts without one."""
        self.place: list[str] = []
        self.types: dict[str, str] = {}
        """Types of the variables of the block being written (``#name``) and of tags, as TIA Portal spells them."""
        self.constants: frozenset[str] = frozenset()
        self.tags: dict[str, Tag] = {}
        """Constants of that block, as its texts name them (``#name``), in lower case."""
        source = options.source if options.same else b""
        self.keeps_sections = bool(source) and LAYOUT.encode() not in source
        """True if the sections of interfaces are those of a file of TIA Portal, which are written as they are."""
        self.actions_reported: set[str] = set()
        """Actions of that block whose outcome the report lists already at their steps."""
        self.action_functions: ActionFunctions | None = None
        """Functions that hold the statements of actions; made with the first chart."""
        self.action_controls: ActionControls | None = None
        """Action controls of the chart of the block being written."""
        self.pou: Pou | None = None
        """The block being written."""
        self.body_name = ""
        """Name of the body being written, as `Pou.named_bodies` gives it."""

    @cached_property
    def called_actions(self) -> frozenset[int]:
        """Ids of the actions that a step has or a program calls."""
        return called_actions(self.project)

    @cached_property
    def lost_actions(self) -> frozenset[int]:
        """Ids of the actions that a program calls where nothing is in place of the call."""
        return called_actions(self.project, self.action_calls.is_replaced)

    @cached_property
    def action_calls(self) -> ActionCalls:
        """Statements in place of the calls of actions."""
        return ActionCalls(self.project)

    def note(self, outcome: Outcome, what: str, name: str = "", why: str = "", cause: Cause | None = None) -> None:
        """Put the outcome of an item into the report."""
        self.report.add(outcome, what, ObjectPath(*self.place, name), why, cause)

    def keep(self, what: str, name: str = "") -> None:
        """Put an item into the report that is written as it is."""
        self.note(Outcome.KEPT, what, name)

    def root(self, kind: str, name: str, parent: etree._Element | None = None) -> etree._Element:
        """Return the root `name` of a part in the namespace of `kind`."""
        number = self.schemas.get(kind, self.version.schema(kind))
        if number == 0:
            return etree.Element(name) if parent is None else etree.SubElement(parent, name)
        uri = namespace(kind, number)
        nsmap: Any = {None: uri}
        tag = f"{{{uri}}}{name}"
        return etree.Element(tag, nsmap=nsmap) if parent is None else etree.SubElement(parent, tag, nsmap=nsmap)


def sub(parent: N, name: str, attributes: dict[str, str] | None = None) -> N:
    """Return a new child of `parent`, in the namespace of `parent`."""
    tag = _tag_beside(parent.tag, name)
    if isinstance(parent, ET.Element):
        return ET.SubElement(parent, tag, attributes or {})  # type: ignore[return-value]  # of its kind
    return etree.SubElement(parent, tag, attributes or {})  # type: ignore[return-value]


@lru_cache(maxsize=4096)
def _tag_beside(tag: str, name: str) -> str:
    """`name` in the namespace of `tag`."""
    head, brace, _ = tag.rpartition("}")
    return head + brace + name


def languages(ctx: DocumentWriting, text: Text) -> dict[str, str]:
    """Return a text by language."""
    return text.texts if isinstance(text, MultilingualText) else {ctx.culture: plain(text)}


def write_languages(
    ctx: DocumentWriting, parent: etree._Element, name: str, text: Text | None, attributes: dict[str, str] | None = None
) -> None:
    """Write a text inside a program or an interface as child `name`; nothing for None."""
    if text is None:
        return
    element = sub(parent, name, attributes)
    for language, content in languages(ctx, text).items():
        sub(element, "MultiLanguageText", {"Lang": language}).text = legal_text(content) or None


def write_object_text(ctx: DocumentWriting, parent: etree._Element, role: str, text: Text | None) -> None:
    """Write the object ``MultilingualText`` of a block or network; nothing for None."""
    if text is None:
        return
    element = sub(parent, "MultilingualText", {ID: "", "CompositionName": role})
    holder = sub(element, "ObjectList")
    for culture, content in languages(ctx, text).items():
        item = sub(holder, "MultilingualTextItem", {ID: "", "CompositionName": "Items"})
        values = sub(item, "AttributeList")
        sub(values, "Culture").text = culture
        sub(values, "Text").text = legal_text(content) or None


def verbatim(ctx: DocumentWriting, extension_data: ExtensionData | None) -> etree._Element | None:
    """Return the element as it was in the file that an object was read from, if it was kept."""
    for data in extension_data.data if extension_data is not None else ():
        if data.name == VERBATIM:
            return parsed_markup(concrete(data.content, ctx.schemas))
    return None


def add_element(ctx: DocumentWriting, parent: etree._Element, content: str) -> None:
    """Append an element that was kept as markup."""
    add_markup(parent, concrete(content, ctx.schemas))


def kept_parts(ctx: DocumentWriting, extension_data: ExtensionData | None) -> list[etree._Element]:
    """Return the elements of an object that were kept as markup."""
    holder = etree.Element("holder")
    for content in elements_of(extension_data):
        add_element(ctx, holder, content)
    return list(holder)


def keep_fields(element: etree._Element, fields: dict[str, Any]) -> None:
    """Write fields that have no place in SimaticML as an XML comment."""
    text = COMMENT_MARK + json.dumps(fields, ensure_ascii=True).replace("--", "-\\u002d")
    element.append(etree.Comment(text))


def finish(
    ctx: DocumentWriting,
    element: etree._Element,
    thing: Model,
    native: frozenset[str],
    *,
    also: dict[str, Any] | None = None,
    reported: frozenset[str] = frozenset(),
) -> None:
    """Write the fields of `thing` that are not in `native`, which have no place in SimaticML, as an XML comment.

    `reported` are those whose outcome the report lists already.
    """
    left = fields_left(thing, native | {"extension_data"}) | (also or {})
    extension_data: ExtensionData | None = getattr(thing, "extension_data", None)
    foreign = [data for data in extension_data.data if data.name != VERBATIM] if extension_data is not None else []
    if foreign:
        left["extension_data"] = ExtensionData(data=foreign).model_dump(mode="json", exclude_defaults=True)
    if not left:
        return
    keep_fields(element, left)
    name = str(getattr(thing, "name", None) or "")
    subject = "" if ctx.place and ctx.place[-1].endswith(name) else name
    for field in [field for field in left if field not in (also or {}) and field not in reported]:
        why = EXECUTED.get(field)
        outcome = Outcome.EXTENSION_DATA if why is None else Outcome.NOT_EXECUTED
        ctx.note(outcome, field.replace("_", " "), subject, why or "SimaticML has no place for it")
