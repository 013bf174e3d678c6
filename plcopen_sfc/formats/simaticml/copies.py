"""Objects that are copies of what the project says elsewhere, such as a data block of a list of global variables.

They are marked with a digest of what they say. Read again they are no objects of the project, unless somebody has
edited them since: then they are, and nothing that was edited is lost.
"""

from __future__ import annotations

import hashlib
import json
from enum import Enum

from lxml import etree

from plcopen_sfc.formats.simaticml.reading import attributes, children, local
from plcopen_sfc.formats.simaticml.writing import keep_fields
from plcopen_sfc.formats.xml.carrying import COMMENT_MARK

_COPY = "copy"
_NUMBERED = frozenset({"ID", "UId"})
"""Attributes that number elements anew whenever a document is written."""


class Copy(Enum):
    """What an object is."""

    NONE = "an object of the project"
    UNCHANGED = "a copy"
    EDITED = "a copy that was edited"


def mark_copy(element: etree._Element) -> None:
    """Say in a comment that an object is a copy, as it is now."""
    keep_fields(element, {_COPY: _digest(element)})


def copy_of(element: etree._Element) -> Copy:
    """What the comments of an object say of it. That of a copy which was edited is taken out: it no longer is one."""
    for comment in element.iterchildren(etree.Comment):
        text = comment.text or ""
        try:
            found = json.loads(text.removeprefix(COMMENT_MARK)) if text.startswith(COMMENT_MARK) else None
        except (ValueError, RecursionError):
            continue  # who reads the object says so
        if isinstance(found, dict) and _COPY in found:
            if found[_COPY] == _digest(element):
                return Copy.UNCHANGED
            element.remove(comment)
            return Copy.EDITED
    return Copy.NONE


def _digest(element: etree._Element) -> str:
    """The same for elements that say the same, however they are indented and numbered."""
    digest = hashlib.sha256()
    for each in element.iter(etree.Element):
        said = [(name, value) for name, value in sorted(attributes(each).items()) if name not in _NUMBERED]
        text = "" if len(children(each)) else each.text or ""
        digest.update(repr((local(each), len(children(each)), said, text)).encode())
    return digest.hexdigest()[:16]
