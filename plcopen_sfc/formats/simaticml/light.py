"""Programs taken out of a document, as trees that are quick to go through and to compare.

lxml makes an object for an element whenever somebody asks for it. Programs are most of the elements of a document; each
is read, written once more and compared, and elements of the standard library take a fifth of the time for that.
"""

from __future__ import annotations

from xml.etree import ElementTree as ET

from lxml import etree

from plcopen_sfc.formats.xml.canonical import canonical_form


def text_of(element: etree._Element) -> bytes:
    """`element` as text without comments and marks of CDATA."""
    text: bytes = etree.tostring(element, with_tail=False)
    return canonical_form(element, comments=False) if b"<!" in text else text


def is_complete(text: bytes) -> bool:
    """Whether the tree of a text has all that stands there: it has no processing instructions."""
    return b"<?" not in text


def light(text: bytes) -> ET.Element:
    """The tree of a text that `text_of` gave: of a document, so its entities and nesting have been looked at."""
    return ET.fromstring(text)  # noqa: S314
