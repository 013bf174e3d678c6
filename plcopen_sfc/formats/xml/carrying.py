"""What has no place of its own: markup that is kept as text, and fields that a format cannot say."""

from __future__ import annotations

import copy
from functools import cache
from typing import Any
from xml.sax.saxutils import escape

from lxml import etree

from plcopen_sfc.formats.xml.canonical import canonical_form
from plcopen_sfc.model.base import Model

__all__ = ["COMMENT_MARK", "OWN_DATA", "add_markup", "inner_markup", "left_over", "legal", "markup"]

COMMENT_MARK = "plcopen_sfc "
"""XML comments that begin with it are ours: they hold fields that the format cannot say, as JSON."""
OWN_DATA = "urn:plcopen-sfc:"
"""The names of foreign data of ours begin with it: no other tool reads them."""


def markup(element: etree._Element) -> str:
    """`element` as text, with the namespaces it needs and no others, without what follows it.

    The form is canonical, so that the same content is the same text wherever it stands: how it was indented is left
    out.
    """
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
    """The content of `element` as text, each child with the namespaces it needs, without blanks between children."""
    return _escaped(element.text) + "".join(markup(child) + _escaped(child.tail) for child in element)


def _escaped(text: str | None) -> str:
    return escape(text) if text is not None and text.strip() else ""


def add_markup(parent: etree._Element, markup: str) -> None:
    """Append markup that was carried as text."""
    holder = etree.fromstring(f"<x>{markup}</x>", etree.XMLParser(resolve_entities=False, huge_tree=True))
    if holder.text and holder.text.strip():
        parent.text = (parent.text or "") + holder.text
    for child in list(holder):
        parent.append(child)


def legal(text: str) -> str:
    """`text` without the control characters that XML 1.0 cannot hold."""
    return (
        text
        if text.isprintable()
        else "".join(c for c in text if c in "\t\n\r" or (c >= " " and c not in "\ufffe\uffff"))
    )


def left_over(thing: Model, native: frozenset[str]) -> dict[str, Any]:
    """The fields of `thing` that are not in `native` and do not have their default value, as plain data."""
    names = {name for name, default in _defaults(type(thing), native) if getattr(thing, name) != default}
    return thing.model_dump(mode="json", include=names, exclude_none=True) if names else {}


@cache
def _defaults(kind: type[Model], native: frozenset[str]) -> list[tuple[str, Any]]:
    """The fields of a class but for `native`, and their default values to compare with: pydantic makes each anew."""
    fields = kind.model_fields.items()
    return [(name, info.get_default(call_default_factory=True)) for name, info in fields if name not in native]
