"""Extension data: markup kept as text, fields that a format has no place for, and markup of another format.

The model does not interpret what an object carries: markup of TC6 or of SimaticML, never both as they are. The product
in the header of their project, which files of both formats keep, tells whose markup it is. Where the other format is
read or written, its own markup changes places with that: markup that does not belong there is kept as one data element
at the object, and restored on the way back.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum
from functools import cache
from typing import Any, cast
from xml.etree import ElementTree as ET
from xml.sax.saxutils import escape

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.errors import Location, ModelError, StructureError
from plcopen_sfc.formats.format_interface import TIA_PORTAL
from plcopen_sfc.formats.xml.xml_parsing import SourceLines
from plcopen_sfc.languages.translation.renames import NAMES_DATA
from plcopen_sfc.model.base import ExtensionData, ForeignData, Model
from plcopen_sfc.model.checked import first_misfit
from plcopen_sfc.model.late import LateElement
from plcopen_sfc.model.project import Project


def canonical_form(
    element: etree._Element, *, comments: bool = True, exclusive: bool = True, prefixes: Sequence[str] | None = None
) -> bytes:
    """Return `element` without what follows it; `prefixes` are declared even where nothing but a value uses them.

    There is no canonical form of elements in namespaces whose names are relative (``xmlns:a="b"``): they come as they
    are, with comments.
    """
    try:
        form: bytes = etree.tostring(
            element,
            method="c14n",
            exclusive=exclusive,
            with_comments=comments,
            with_tail=False,
            inclusive_ns_prefixes=prefixes or None,
        )
    except etree.C14NError:
        return etree.tostring(element, encoding="utf-8", with_tail=False)
    return form


def attributes(element: etree._Element | ET.Element) -> dict[str, str]:
    """Return a copy of the attributes of `element`, from which a reader takes them one by one."""
    return dict(element.items())  # type: ignore[arg-type]  # lxml types keys and values as str or bytes


def extension_data(fields: dict[str, Any]) -> dict[str, Any]:
    """Return the extension data of an object being read, created when it is needed."""
    found: dict[str, Any] | None = fields.get("extension_data")
    if found is None:
        found = fields["extension_data"] = {"data": [], "attributes": {}, "elements": []}
    return found


def boolean(value: bool) -> str:
    """Return a truth as ``xsd:boolean``."""
    return "true" if value else "false"


def misfit(
    error: ValidationError,
    fields: Mapping[str, Any],
    element: etree._Element,
    *,
    file: str | None,
    lines: SourceLines | None,
    place: Sequence[str] = (),
) -> StructureError:
    """Return the error of an object whose fields do not fit the model: those in extension data may have been edited.

    `element` and `place` are those of the object. Its line is that of the innermost element whose name is on the way.
    """
    first = error.errors()[0]
    holder: Any = fields
    names = [*place]
    for key in first["loc"]:  # which has kinds of objects between the names of fields
        if isinstance(holder, Mapping):
            holder = holder.get(key, holder)
        elif isinstance(holder, list) and isinstance(key, int):
            holder = holder[key]
        name = holder.get("name") if isinstance(holder, Mapping) else getattr(holder, "name", None)
        if isinstance(name, str) and name and names[-1:] != [name]:
            names.append(name)
            named = (each for each in element.iter(etree.Element) if name in (each.get("name"), each.get("Name")))
            element = next(named, element)
    line = lines.line(element) if lines is not None else cast("int | None", element.sourceline)
    message = f"the file does not fit the model: {first_misfit(error)}"
    hint = "Data of plcopen_sfc in it were edited, or are damaged. Restore them, or remove them."
    return StructureError(message, location=Location(file, line, None, " / ".join(names) or None), hint=hint)


COMMENT_MARK = "plcopen_sfc "
"""XML comments of this package begin with it: they hold fields that the format has no place for, as JSON."""
OWN_DATA = "urn:plcopen-sfc:"
"""The names of foreign data of this package begin with it: no other tool reads them."""


def markup(element: etree._Element) -> str:
    """Return `element` as text, with the namespaces it needs and no others, without what follows it.

    The form is canonical, so that the same content is the same text in every place: its indentation is left out.
    """
    if not isinstance(element.tag, str):  # a comment or a processing instruction
        return etree.tostring(element, encoding="unicode", with_tail=False)
    element = copy.deepcopy(element)
    for node in _INDENTED(element):
        node.text = None
        for child in node:
            child.tail = None
    prefixes = [prefix for prefix in element.nsmap if prefix]
    if prefixes:
        # names in values (xsi:type="x:Name") need their prefix too; canonical XML cannot see them
        plain = etree.tostring(element, encoding="unicode", with_tail=False)
        prefixes = [prefix for prefix in prefixes if f'"{prefix}:' in plain or f">{prefix}:" in plain]
    text = canonical_form(element, prefixes=prefixes).decode()
    name = etree.QName(element)
    if name.namespace is None and ' xmlns="' not in text.partition(">")[0]:
        # canonical XML leaves this out at the top; elsewhere it would put the element into the surrounding namespace
        return f'<{name.localname} xmlns=""' + text.removeprefix(f"<{name.localname}")
    return text


_INDENTED: Any = etree.XPath(
    "descendant-or-self::*[text()][* or comment() or processing-instruction()][not(text()[normalize-space()])]"
)
"""The elements that have other nodes and blanks in them, and no other text."""


def inner_markup(element: etree._Element) -> str:
    """Return the content of `element` as text, each child with its namespaces, without blanks between children."""
    return _escaped(element.text) + "".join(markup(child) + _escaped(child.tail) for child in element)


def _escaped(text: str | None) -> str:
    return escape(text) if text is not None and text.strip() else ""


def add_markup(parent: etree._Element, markup: str) -> None:
    """Append markup that was kept as text. Raises `ModelError` where it is no markup."""
    holder = parsed_markup(f"<x>{markup}</x>")
    if holder.text and holder.text.strip():
        parent.text = (parent.text or "") + holder.text
    for child in list(holder):
        parent.append(child)


def parsed_markup(markup: str) -> etree._Element:
    """Return the element that extension data are. Raises `ModelError` where they are none, as scripts can have it."""
    try:
        return etree.fromstring(markup, etree.XMLParser(resolve_entities=False, huge_tree=True))
    except (etree.XMLSyntaxError, ValueError) as error:  # ValueError: control characters, or a declared encoding
        why = str(error)
    shown = markup if len(markup) <= _SHOWN else f"{markup[:_SHOWN]}.."
    hint = (
        "Nothing was written. Mend the extension data (`extension_data`) of the object that has them, or remove them."
    )
    # without the error of lxml as its context: it could not be pickled
    raise ModelError(f"extension data are no well-formed XML: {why}: {shown}", hint=hint)


_SHOWN = 80


def set_attributes(element: etree._Element, kept: Mapping[str, str]) -> None:
    """Write attributes back that were kept of an element. Raises `ModelError` for what can be none."""
    for name, value in kept.items():
        if name not in element.attrib:
            try:
                element.set(name, value)
            except ValueError as error:
                hint = "Nothing was written. Mend the extension data (`extension_data`) of the object, or remove them."
                raise ModelError(
                    f"extension data have an attribute that XML cannot have: {error}", hint=hint
                ) from error


def attributes_of(extension_data: ExtensionData | None) -> dict[str, str]:
    """Return the attributes that were kept of an object."""
    return extension_data.attributes if extension_data is not None else {}


def elements_of(extension_data: ExtensionData | None) -> list[str]:
    """Return the elements that were kept of an object, as markup."""
    return extension_data.elements if extension_data is not None else []


def legal_text(text: str) -> str:
    """Return `text` without the control characters that XML 1.0 cannot hold."""
    return _ILLEGAL.sub("", text)


_ILLEGAL = re.compile("[^\t\n\r -\ufffd\U00010000-\U0010ffff]")


def fields_left(thing: Model, native: frozenset[str]) -> dict[str, Any]:
    """Return the fields of `thing` that are not in `native` and do not have their default value, as plain data."""
    if isinstance(thing, LateElement):
        thing.read()
    fields = thing.__dict__  # as attributes they would take three times as long, and files have them by the million
    names = set()
    for name, default in _defaults(type(thing), native):  # a comprehension would be a call for each of them
        value = fields.get(name, default)
        if value is not default and value != default:
            names.add(name)
    return thing.model_dump(mode="json", include=names, exclude_none=True) if names else {}


@cache
def _defaults(kind: type[Model], native: frozenset[str]) -> list[tuple[str, Any]]:
    """Return the fields of a class but for `native`, with their default values, which pydantic makes each time."""
    fields = kind.model_fields.items()
    return [(name, info.get_default(call_default_factory=True)) for name, info in fields if name not in native]


KEPT_MARKUP = "urn:plcopen-sfc:kept"
"""The name of such data begins so; the `Markup` that it is follows after a colon."""


class Markup(StrEnum):
    """Owner of markup."""

    TC6 = "tc6"
    SIMATICML = "simaticml"


def markup_of(project: Project) -> Markup:
    """Whose markup the objects of a project carry as it is."""
    return Markup.SIMATICML if project.header.product == TIA_PORTAL else Markup.TC6


def exchange_markup(thing: Model | Sequence[Model], own: Markup, wanted: Markup) -> None:
    """Change what `thing`, or each in a list, and the objects in it carry: markup of `wanted` as it is, not of `own`.

    Objects and charts that are unread stay so, and as they are.
    """
    if own is not wanted:
        for holder, name, extension_data in list(_extension_data_in(thing)):
            setattr(holder, name, _exchanged(extension_data, own, wanted))


def _extension_data_in(thing: Any) -> Iterator[tuple[Model, str, ExtensionData]]:
    if isinstance(thing, Model):
        for name, value in thing.__dict__.items():
            if isinstance(value, ExtensionData):
                yield thing, name, value
            else:
                yield from _extension_data_in(value)
    elif isinstance(thing, list):
        for item in thing:
            yield from _extension_data_in(item)


def _exchanged(extension_data: ExtensionData, own: Markup, wanted: Markup) -> ExtensionData:
    left = ExtensionData(attributes=extension_data.attributes, elements=extension_data.elements)
    found = ExtensionData()
    for data in extension_data.data:
        if data.name == f"{KEPT_MARKUP}:{wanted}" and (taken := _restored(data)) is not None:
            found.data += taken.data
            found.attributes |= taken.attributes
            found.elements += taken.elements
        elif data.name.startswith(KEPT_MARKUP) or data.name == NAMES_DATA:
            found.data.append(data)
        else:
            left.data.append(data)
    if left != ExtensionData() or not extension_data.data:
        found.data.append(_kept_as_data(left, own))
    return found


def _kept_as_data(extension_data: ExtensionData, own: Markup) -> ForeignData:
    element = etree.Element(f"{{{KEPT_MARKUP}}}kept", nsmap={None: KEPT_MARKUP})  # type: ignore[dict-item]  # lxml-stubs
    element.text = extension_data.model_dump_json(exclude_defaults=True)
    return ForeignData(name=f"{KEPT_MARKUP}:{own}", content=markup(element))


def _restored(data: ForeignData) -> ExtensionData | None:
    """Return the markup that was kept as data; None where it is damaged."""
    try:
        return ExtensionData.model_validate_json(parsed_markup(data.content).text or "")
    except (ModelError, ValidationError):
        return None
