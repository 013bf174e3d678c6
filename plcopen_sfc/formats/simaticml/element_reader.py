"""Elements of SimaticML for all readers: local names, texts in several languages, and extension data.

Readers turn elements into plain dictionaries of model fields, which are validated into the model in one go. Namespaces
carry nothing but the schema version, so elements are told apart by their local names.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, TypeVar
from xml.etree import ElementTree as ET

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.formats.simaticml.tia_versions import TiaVersion, neutral, schema_of
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK, attributes, extension_data, markup, misfit
from plcopen_sfc.formats.xml.xml_parsing import ElementReading, SourceLines
from plcopen_sfc.model.base import ExtensionData, Model
from plcopen_sfc.model.checked import first_misfit

M = TypeVar("M", bound=Model)

Fields = dict[str, Any]
"""Fields of a model object that is being read."""

XmlNode = etree._Element | ET.Element
"""An element of the document, or of a program that was taken out of it (see `program_comparison`)."""
N = TypeVar("N", bound=XmlNode)

VERBATIM = "urn:plcopen-sfc:simaticml"
"""Foreign data that is the element as it was in the file, where our writer would write it differently.

It is written as long as it means the same as the model. See docs/formats/simaticml.md.
"""


class NotUnderstoodError(Exception):
    """An element holds something that the model cannot express: it is kept whole."""


class DocumentReading(ElementReading):
    """State of reading one file."""

    def __init__(self, version: TiaVersion, *, file: str | None = None, lines: SourceLines | None = None) -> None:
        super().__init__(file, lines)
        self.version = version
        self.schemas: dict[str, int] = {}
        """Schema numbers that the file uses, by kind."""
        self.of_tia = True
        """True if the project is one of TIA Portal, by its header."""
        self.trusting = True
        """True while fields in comments are read."""
        self.types: dict[str, str] = {}
        """Types of the variables of the block being read, as TIA Portal spells them, by ``#name``."""
        self.constants: frozenset[str] = frozenset()
        """Constants of that block, as its texts name them, in lower case."""
        self.edited_controls = False
        """True in a block in which a network that controls an action was edited: all of these networks count."""
        self.edited_copies: set[str] = set()
        """Objects that were added for TIA Portal and edited since, in lower case."""

    def note_schema(self, element: etree._Element) -> None:
        """Remember of which schema version `element` is."""
        found = schema_of(etree.QName(element).namespace or "")
        if found is not None:
            self.schemas.setdefault(*found)


_LOCAL: dict[str, str] = {}


ADDED = "added"
"""Field in our comments that marks an element as no part of the project."""


ASSOCIATION = "association"
"""Field in our comments that holds an action association which rows express in another way, or not at all."""


def local(element: XmlNode) -> str:
    """Return the local name of an element, "" for a comment or processing instruction."""
    tag: Any = element.tag
    name = _LOCAL.get(tag)
    if name is None:
        if not isinstance(tag, str):
            return ""
        name = tag.rpartition("}")[2]
        if len(_LOCAL) < _KNOWN_NAMES:
            _LOCAL[tag] = name
    return name


_KNOWN_NAMES = 4096
"""A damaged or malicious file may have any number of names; only so many are remembered."""


def children(element: N) -> list[N]:
    """Return the child elements, without comments."""
    if isinstance(element, ET.Element):
        return list(element)  # type: ignore[arg-type]  # elements hold those of their own kind, here and below
    return [child for child in element if isinstance(child.tag, str)]  # type: ignore[misc]


def child_named(element: N, name: str) -> N | None:
    """Return the first child of this local name."""
    for child in element:
        if local(child) == name:
            return child  # type: ignore[return-value]
    return None


def keep_element(fields: Fields, element: etree._Element) -> None:
    """Keep a child that has no place in the model."""
    if isinstance(element.tag, str):
        extension_data(fields)["elements"].append(neutral(markup(element)))


def keep_attribute(fields: Fields, name: str, value: str) -> None:
    """Keep a value that has no place in the model."""
    extension_data(fields)["attributes"][name] = value


def opaque_body(*elements: etree._Element) -> Fields:
    """Return a body that is kept as it is."""
    content = "".join(neutral(markup(element)) for element in elements)
    return {"language": "opaque", "source": "simaticml", "content": content}


def keep_rest(fields: Fields, element: etree._Element) -> None:
    """Keep the content of an object besides its one list of attributes and its one list of objects."""
    seen: set[str] = set()
    for child in children(element):
        if local(child) in ("AttributeList", "ObjectList") and local(child) not in seen:
            seen.add(local(child))
            for name, value in attributes(child).items():
                keep_attribute(fields, f"@{local(child)}@{name}", value)
        else:
            keep_element(fields, child)


def keep_verbatim(fields: Fields, element: etree._Element) -> None:
    """Keep `element` as it is in the file, besides the fields that were read from it."""
    extension_data(fields)["data"].append({"name": VERBATIM, "content": neutral(markup(element))})


def same_content(one: XmlNode, other: XmlNode) -> bool:
    """True if two elements are equal; namespaces and blanks between elements do not count."""
    if local(one) != local(other) or one.attrib != other.attrib:
        return False
    mine, theirs = children(one), children(other)
    if len(mine) != len(theirs):
        return False
    text, other_text = one.text or "", other.text or ""
    if mine:
        text, other_text = text.strip(), other_text.strip()
    return text == other_text and all(same_content(a, b) for a, b in zip(mine, theirs, strict=True))


def read_languages(element: etree._Element) -> Fields | None:
    """Read ``MultiLanguageText`` children into a multilingual text; None where there is more than that."""
    texts: dict[str, str] = {}
    for child in children(element):
        language = child.get("Lang")
        if local(child) != "MultiLanguageText" or language is None or language in texts or len(child.attrib) > 1:
            return None
        texts[language] = child.text or ""
    return {"texts": texts}


def read_object_text(element: etree._Element) -> Fields | None:
    """Read the object ``MultilingualText``; None where it holds more than texts in cultures."""
    texts: dict[str, str] = {}
    usual: dict[str, set[str]] = {"MultilingualText": _OBJECT, "MultilingualTextItem": _OBJECT}
    if any(set(part.attrib) - usual.get(local(part), set()) for part in element.iter(etree.Element)):
        return None
    if len(element) > 1:
        return None
    for holder in children(element):
        if local(holder) != "ObjectList":
            return None
        for item in children(holder):
            listed = children(item)
            if (
                item.get("CompositionName") != "Items"
                or local(item) != "MultilingualTextItem"
                or len(listed) != 1
                or local(listed[0]) != "AttributeList"
            ):
                return None
            values = {local(value): value.text or "" for value in children(listed[0])}
            if len(values) != len(listed[0]) or any(len(value) for value in listed[0]):
                return None
            if not values.keys() <= {"Culture", "Text"} or values.get("Culture", "") in texts:
                return None
            texts[values.get("Culture", "")] = values.get("Text", "")
    return {"texts": texts}


def read_objects(element: etree._Element, fields: Fields, *expected: str) -> list[etree._Element]:
    """Return the objects of an object: its title and comment are read, the `expected` ones returned, others kept."""
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
            keep_element(fields, child)
    return found


def read_comments(ctx: DocumentReading, element: etree._Element, fields: Fields) -> None:
    """Put the fields back that XML comments of this package at `element` hold."""
    for comment in element.iterchildren(etree.Comment):
        read_comment(ctx, comment, fields)


def read_comment(ctx: DocumentReading, comment: etree._Element, fields: Fields) -> None:
    """Put the fields back that one XML comment holds."""
    try:
        found = comment_fields(comment) if ctx.trusting else {}
        if "extension_data" in found:
            extension_data(fields)
            found["extension_data"] = ExtensionData.model_validate(found["extension_data"]).model_dump(mode="json")
    except (ValueError, RecursionError) as error:
        ctx.warn("XML208", f"fields in extension data are damaged: {first_line(error)}", comment)
    else:
        found.pop(ADDED, None)
        merge_fields(fields, found)


def comment_fields(comment: etree._Element) -> Fields:
    """Return the fields in a comment of this package; none in any other. Raises `ValueError` or `RecursionError`."""
    text = comment.text or ""
    found = json.loads(text.removeprefix(COMMENT_MARK)) if text.startswith(COMMENT_MARK) else {}
    return found if isinstance(found, dict) else {}


def first_line(error: Exception) -> str:
    """Return the message of an error, in one line."""
    if isinstance(error, ValidationError):
        return first_misfit(error)
    return str(error).partition("\n")[0]


def read_model(
    ctx: DocumentReading,
    element: etree._Element,
    model: type[M],
    read: Callable[[DocumentReading, etree._Element], Fields],
) -> M:
    """Read an object of the model.

    Fields that were kept in comments, which may have been edited, are left out where they do not fit: the file
    keeps them. Raises `StructureError` where that does not help.
    """
    place = list(ctx.place)
    try:
        return model.model_validate(read(ctx, element))
    except (ValidationError, TypeError, KeyError, AttributeError) as error:
        comments = (comment.text or "" for comment in element.iter(etree.Comment))
        if not any(text.startswith(COMMENT_MARK) for text in comments):
            raise _misfit(ctx, element, error) from error
        ctx.place = place
        ctx.warn("XML208", f"fields in extension data do not fit the model: {first_line(error)}", element)
    ctx.trusting = False
    try:
        return model.model_validate(read(ctx, element))
    except ValidationError as error:
        raise _misfit(ctx, element, error) from error
    finally:
        ctx.trusting = True


def _misfit(ctx: DocumentReading, element: etree._Element, error: Exception) -> Exception:
    if not isinstance(error, ValidationError):
        return error
    return misfit(error, {}, element, file=ctx.file, lines=ctx.lines, place=ctx.place)


def merge_fields(fields: Fields, found: Fields) -> Fields:
    """Return `fields` with `found` added; lists and parts of objects are added to those that are there."""
    for name, value in found.items():
        present = fields.get(name)
        if isinstance(value, dict) and isinstance(present, dict) and not value.keys() & {"kind", "language"}:
            merge_fields(present, value)
        elif isinstance(value, list) and isinstance(present, list):
            present.extend(value)
        else:
            fields[name] = value
    return fields


_OBJECT = {"ID", "CompositionName"}


def plain_text(element: etree._Element | None) -> str | None:
    """Return the text of a plain attribute; None for one that is marked, or is more than text."""
    if element is None or element.attrib or len(element):
        return None
    return element.text or ""


TRUTHS = {"true": True, "false": False}
"""Booleans of SimaticML."""
