"""Programs taken out of a document, as trees that are quick to go through and to compare.

lxml makes an object for an element whenever somebody asks for it. Programs are most of the elements of a document; each
is read, written once more and compared, and elements of the standard library take a fifth of the time for that.
"""

from __future__ import annotations

import re
from xml.etree import ElementTree as ET

from lxml import etree

from plcopen_sfc.formats.simaticml.reading import NotUnderstoodError
from plcopen_sfc.formats.xml.extension_data import canonical_form


def text_of(element: etree._Element) -> bytes:
    """`element` as text without comments, marks of CDATA, and most of the blanks between elements."""
    text: bytes = etree.tostring(element, with_tail=False)
    if b"<!" in text:
        text = canonical_form(element, comments=False)
    return _BEFORE_START.sub(b"><", text)


_BEFORE_START = re.compile(rb">\s+<(?!/)")
"""Blanks before an element: they are no content, as those before an end may be."""


def light(text: bytes) -> ET.Element:
    """The tree of a text that `text_of` gave: of a document, so its entities and nesting have been looked at.

    Raises `NotUnderstoodError` for processing instructions, which such a tree does not have.
    """
    if b"<?" in text:
        raise NotUnderstoodError("a processing instruction")
    return ET.fromstring(text)  # noqa: S314
