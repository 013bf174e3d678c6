"""Writing TC6 elements: elements in the right namespace, texts, numbers, and extension data.

A writer names the fields of an object that it writes natively. Whatever else the object holds becomes extension data:
foreign data under a name of this package where the version has a place for it (TC6 2.0 on), an XML comment in 1.01. So
nothing can be forgotten, and each such field is in the report.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from types import MappingProxyType
from typing import Any

from lxml import etree

from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.plcopen.tc6_reading import FIELDS_DATA, NEUTRAL, all_languages
from plcopen_sfc.formats.plcopen.tc6_versions import XHTML, Tc6Version
from plcopen_sfc.formats.xml.extension_data import (
    COMMENT_MARK,
    Markup,
    add_markup,
    fields_left,
    legal_text,
    markup_of,
    parsed_markup,
    set_attributes,
)
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model.base import ExtensionData, ForeignData, Model, UnknownDataRule
from plcopen_sfc.model.drawing import DIVERGENCES
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.text import MarkupText, MultilingualText, Text, is_direct
from plcopen_sfc.model.variables import VariableSection
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import ConversionReport, Outcome

Written = tuple[str, UnknownDataRule, etree._Element]
"""One ``addData/data``: its name, its rule, and its content."""

_IDS = re.compile(rb"<!--" + COMMENT_MARK.encode() + rb' ?\{"(?:id|entries)"')
"""Comments in a file of TC6 1.01 that hold the ids of actions, which have no attribute for them there."""


@dataclass(frozen=True)
class Tc6Dialect:
    """TC6 XML as one tool or family of tools writes it.

    `data_writer` gives the tool's own data of an object (its fields in `native_fields` are no extension data, nor are
    texts of its declaration, by the names of the data that hold them in `native_texts`), `data_rank` its place among
    the others. `text_element` is the XHTML element of texts. `states_actions`: qualifier, duration and indicator are
    always written. `lacks` names what is written but not understood by the tools that the file is for, each with the
    reason: it is in the report as approximated.
    """

    version: Tc6Version
    text_element: str = "p"
    declares_xhtml: bool = True
    states_actions: bool = False
    tool: Tool | None = None
    lacks: dict[str, str] = field(default_factory=dict)
    native_fields: dict[str, frozenset[str]] = field(default_factory=dict)
    native_texts: dict[str, frozenset[str]] = field(default_factory=dict)
    data_writer: Callable[[Tc6WriteContext, Model, str], Iterable[Written]] | None = None
    data_rank: dict[str, int] = field(default_factory=dict)


class Tc6WriteContext:
    """State of writing one project: the dialect, the report, and where we are."""

    def __init__(
        self,
        dialect: Tc6Dialect,
        report: ConversionReport,
        project: Project,
        options: WriteOptions,
        texts: Mapping[int, str | None] = MappingProxyType({}),
    ) -> None:
        self.dialect = dialect
        self.version = dialect.version
        self.parts: dict[int, list[VariableSection]] = {}
        """The sections of lists of global variables that are written as one, by the `id()` of that."""
        self.names = dialect.version.qualified
        self.report = report
        self.untouched = options.untouched
        self.unchanged = options.unchanged
        self.same = options.same
        self.marks = options.marks
        """Fields to keep beside objects that were rewritten or added, by their `id()`."""
        """True if the project was read from this format in this version."""
        self.counts_ids = options.same and _IDS.search(options.source) is None
        """True if TC6 1.01 gets no ids in comments: the file has none either, and they come back by counting."""
        self.texts = texts
        """Declarations as text that are written instead of those of objects, by their `id()`."""
        self.body_name = ""
        """The name of the body being written, as `Pou.named_bodies` gives it."""
        self.place: list[str] = []
        self.project = project
        self.is_foreign = markup_of(project) is not Markup.TC6
        """True if the markup that objects carry is that of another format."""
        self.takes_markup = not dialect.version.first_generation and not self.is_foreign
        """True if the file takes extension data as they are: TC6 1.01 has no place for them, no version for others."""
        self.resource_place = ""
        """`Pou.place` of POUs in the resource being written."""
        self.jump_name = ""
        self.told_by_others: set[int] = set()
        """Identities (`id`) of the elements of charts whose exclusion is that of a branch or a jump."""
        """The name of what the jump being written leads to."""

    def version_tag(self, name: str) -> str:
        """Return a name in the namespace of the version that is no element of TC6."""
        return f"{{{self.version.namespace}}}{name}"

    def keep(self, what: str, name: str = "", *features: str) -> None:
        """Put an item into the report: kept, or approximated where the dialect lacks one of its `features`."""
        lacking = [self.dialect.lacks[feature] for feature in (what, *features) if feature in self.dialect.lacks]
        self.note(Outcome.APPROXIMATED if lacking else Outcome.KEPT, what, name, "; ".join(lacking))

    def note(self, outcome: Outcome, what: str, name: str = "", why: str = "") -> None:
        """Put the outcome of an item into the report."""
        self.report.add(outcome, what, ObjectPath(*self.place, name), why)


def add_child(
    ctx: Tc6WriteContext, parent: etree._Element, name: str, attributes: Mapping[str, str | None] | None = None
) -> etree._Element:
    """Return a new child of `parent`, in the TC6 namespace. Attributes without a value are left out."""
    return etree.SubElement(parent, ctx.names[name], given(attributes) if attributes else {})


def tool_element(ctx: Tc6WriteContext, name: str, attributes: Mapping[str, str | None] | None = None) -> etree._Element:
    """Return an element of a tool, which is no element of TC6, in the namespace of TC6."""
    nsmap: Any = {None: ctx.version.namespace}
    return etree.Element(ctx.version_tag(name), given(attributes or {}), nsmap=nsmap)


def given(attributes: Mapping[str, str | None]) -> dict[str, str]:
    """Return the attributes that have a value."""
    return {name: value for name, value in attributes.items() if value is not None}


def write_text(ctx: Tc6WriteContext, parent: etree._Element, name: str, text: Text | None) -> None:
    """Write ``formattedText`` as child `name` of `parent`; nothing for None."""
    if text is None:
        return
    element = add_child(ctx, parent, name)
    if isinstance(text, MarkupText):
        add_markup(element, text.markup)
    else:
        if isinstance(text, MultilingualText):
            text = all_languages(text.texts)
        xhtml_child(ctx, element).text = legal_text(text)


def xhtml_child(ctx: Tc6WriteContext, parent: etree._Element) -> etree._Element:
    """Return the element that holds the text of ``formattedText``."""
    tag = f"{{{XHTML}}}{ctx.dialect.text_element}"
    return etree.SubElement(parent, tag, nsmap=None if ctx.dialect.declares_xhtml else {None: XHTML})  # type: ignore[dict-item]


def write_code(ctx: Tc6WriteContext, parent: etree._Element, text: str, markup: str | None) -> None:
    """Write program text into ``ST`` or ``IL``: with its markup as long as that means the same text.

    Old versions of Beremiz wrote the text into ``ST`` itself; it stays there in files of that version only.
    """
    if is_direct(markup) and ctx.same:
        parent.text = legal_text(text)
    elif markup is not None and not is_direct(markup) and _text_of(markup).strip() == text.strip():
        add_markup(parent, markup)
    else:
        xhtml_child(ctx, parent).text = legal_text(text)


def _text_of(markup: str) -> str:
    return "".join(map(str, parsed_markup(f"<x>{markup}</x>").itertext()))


def decimal(value: float) -> str:
    """Return a number as ``xsd:decimal``."""
    if isinstance(value, int):  # nearly all
        return str(int(value))
    return str(int(value)) if value.is_integer() else format(value, ".15f").rstrip("0").rstrip(".")


def write_point(ctx: Tc6WriteContext, parent: etree._Element, name: str, point: tuple[float, float]) -> None:
    """Write ``position`` or ``relPosition``."""
    add_child(ctx, parent, name, {"x": decimal(point[0]), "y": decimal(point[1])})


def add_unknown(ctx: Tc6WriteContext, element: etree._Element, extension_data: ExtensionData | None) -> None:
    """Write back the attributes and child elements that the reader did not know. Before ``addData``."""
    if extension_data is None:
        return
    set_attributes(element, extension_data.attributes)
    for markup in extension_data.elements:
        add_markup(element, markup.replace(f'"{NEUTRAL}"', f'"{ctx.version.namespace}"'))


def finish_element(
    ctx: Tc6WriteContext,
    element: etree._Element,
    thing: Model,
    owner: str,
    native: frozenset[str],
    *,
    documents: bool = True,
    also: dict[str, Any] | None = None,
) -> None:
    """Write what every element ends with: unknown content, ``addData``, ``documentation``.

    `native` are the fields of `thing` that the caller has written; `documents`: the element may have documentation.
    `also` are more extension data: parts of fields.
    """
    also = {**ctx.marks.get(id(thing), {}), **(also or {})} if also or ctx.marks else {}
    # a dialect that writes the comment as data of its own does not write it as documentation too
    own = ctx.dialect.native_fields.get(owner, _NONE)
    documents = documents and "comment" not in own
    first_generation = ctx.version.first_generation
    left = fields_left(thing, _written(native, own, ctx.takes_markup, first_generation, documents))
    if also:
        left |= also
    fields = thing.__dict__  # asking for an attribute that a class does not have takes long
    extension_data: ExtensionData | None = fields.get("extension_data")
    if extension_data is not None and ctx.takes_markup:
        add_unknown(ctx, element, extension_data)
    written: list[Written] = []
    if not first_generation:
        global_id: str | None = fields.get("global_id")
        if global_id is not None:
            element.set("globalId", global_id)
        if ctx.dialect.data_writer is not None:
            written = list(ctx.dialect.data_writer(ctx, thing, owner))
    comment: Text | None = fields.get("comment")
    if not (left or written or extension_data) and comment is None:
        return
    if owner in _WITHOUT_DATA:
        left |= data_left(ctx, extension_data)
    if isinstance(comment, MultilingualText):  # documentation is in one language, a comment of CODESYS too
        left["comment"] = comment.model_dump(mode="json")
    if not first_generation and owner not in _WITHOUT_DATA:
        _add_data(ctx, element, written, extension_data if ctx.takes_markup else None, left)
    elif left:
        # An XML comment must not contain "--"; JSON can write the second hyphen as an escape.
        element.append(etree.Comment(COMMENT_MARK + json.dumps(left, ensure_ascii=True).replace("--", "-\\u002d")))
    own_name = str(fields.get("name") or "")
    subject = "" if ctx.place and ctx.place[-1].endswith(own_name) else own_name
    for name in (name for name in left if name not in also):
        why = _WHY.get(name, f"TC6 {ctx.version.name} has no place for it")
        if name in _CHANGES and not (name == "exclude" and owner in _REWRITTEN):
            outcome, change = _CHANGES[name]
            ctx.note(outcome, _label(name), subject, f"{why}; {change}")
        else:
            ctx.note(Outcome.EXTENSION_DATA, _label(name), subject, why)
    if documents:
        write_text(ctx, element, "documentation", comment)


_NONE: frozenset[str] = frozenset()


@cache
def _written(
    native: frozenset[str], own: frozenset[str], takes_markup: bool, first_generation: bool, documents: bool
) -> frozenset[str]:
    """Return the fields of an object that the file has elsewhere than in the data of this package."""
    besides = {"extension_data": takes_markup, "global_id": not first_generation, "comment": documents}
    return native | own | {name for name, is_written in besides.items() if is_written}


_WITHOUT_DATA = frozenset({"parameter"})
"""Elements without ``addData`` in every version of TC6: their extension data are in an XML comment."""
_REWRITTEN = frozenset({"step", "transition", "action", "jumpStep", *DIVERGENCES})
"""Elements whose exclusion from the build `plcopen_sfc.conversion.adaptation` has seen to."""
_WHY = {"priority": "CODESYS tries transitions from left to right, and they are written in that order"}
"""Fields for which TC6 has a place that not all of its tools read."""
_CHANGES = {
    "exclude": (Outcome.APPROXIMATED, "other tools execute what CODESYS leaves out"),
    "encloses": (Outcome.NOT_EXECUTED, "other tools execute no enclosed charts"),
    "methods": (Outcome.NOT_EXECUTED, "other tools neither declare nor execute them"),
    "global_variables": (Outcome.NOT_EXECUTED, "other tools do not declare them"),
}
"""Fields that are kept as extension data, but without which a machine does something else."""


def data_left(ctx: Tc6WriteContext, extension_data: ExtensionData | None) -> dict[str, Any]:
    """Return the data of other tools at an object that has no ``addData``, as a field of extension data."""
    data = extension_data.data if extension_data is not None and ctx.takes_markup else []
    return {"extension_data": ExtensionData(data=data).model_dump(mode="json", exclude_defaults=True)} if data else {}


def _label(name: str) -> str:
    return "foreign data" if name == "extension_data" else name.replace("_", " ")


def _add_data(
    ctx: Tc6WriteContext,
    element: etree._Element,
    written: list[Written],
    extension_data: ExtensionData | None,
    left: dict[str, Any],
) -> None:
    entries: list[tuple[str, UnknownDataRule, etree._Element | str]] = [*written]
    names = {name for name, _, _ in written}
    if extension_data is not None:
        entries.extend((d.name, d.rule, d.content) for d in extension_data.data if not _merged(ctx, d, names))
    if left:
        entries.append((FIELDS_DATA, UnknownDataRule.PRESERVE, fields_element(left)))
    if not entries:
        return
    rank = ctx.dialect.data_rank
    if rank:
        entries.sort(key=lambda entry: rank.get(entry[0], 50))
    holder = add_child(ctx, element, "addData")
    for name, rule, content in entries:
        data = add_child(ctx, holder, "data", {"name": name, "handleUnknown": rule.value})
        if isinstance(content, str):
            add_markup(data, content)
        else:
            data.append(content)


def _merged(ctx: Tc6WriteContext, data: ForeignData, written: set[str]) -> bool:
    """True if the dialect has put extension data into its own data already."""
    texts = kept(ExtensionData(data=[data]))
    if texts:
        return all(ctx.dialect.native_texts.get(name, _NONE) & written for name in texts)
    return data.name in written and ctx.dialect.data_writer is not None


def fields_element(left: dict[str, Any]) -> etree._Element:
    """Our own data: fields of the model that TC6 has no place for, as JSON by name."""
    holder = etree.Element(f"{{{FIELDS_DATA}}}fields", nsmap={None: FIELDS_DATA})  # type: ignore[dict-item]
    for name, value in left.items():
        entry = etree.SubElement(holder, f"{{{FIELDS_DATA}}}field", {"name": name})
        entry.text = legal_text(json.dumps(value, ensure_ascii=False))
    return holder
