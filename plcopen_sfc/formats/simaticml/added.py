"""Elements that only TIA Portal wants, and objects that are copies of what the project says elsewhere.

A comment marks them, with a digest of what they say. Read again they are gone, unless somebody has edited them since:
then they are elements as all others, and nothing that was edited is lost.
"""

from __future__ import annotations

import hashlib
import json
from enum import Enum
from typing import Any

from lxml import etree

from plcopen_sfc.formats.simaticml.reading import ADDED, attributes, children, local
from plcopen_sfc.formats.simaticml.writing import keep_fields
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK

_NUMBERED = frozenset({"ID", "UId"})
"""Attributes that number elements anew whenever a document is written."""


class Added(Enum):
    """Whether an element was added by us."""

    NO = "it is part of the project"
    UNCHANGED = "it was added"
    EDITED = "it was added, and somebody has edited it"


def keep_added(element: etree._Element) -> None:
    """Mark an element as added. `seal` the document when all is written."""
    keep_fields(element, {ADDED: True})


def seal(root: etree._Element) -> None:
    """Say in each mark what its element is like."""
    for comment in [*root.iter(etree.Comment)]:
        element = comment.getparent()
        if element is not None and _mark(comment) is True:
            element.remove(comment)
            keep_fields(element, {ADDED: _digest(element)})


def added(element: etree._Element) -> Added:
    """What the comments of an element say of it."""
    for comment in element.iterchildren(etree.Comment):
        mark = _mark(comment)
        if mark is not None:
            return Added.UNCHANGED if mark == _digest(element) else Added.EDITED
    return Added.NO


def is_added(element: etree._Element) -> bool:
    """Whether an element is as we have added it."""
    return added(element) is Added.UNCHANGED


def forget_mark(element: etree._Element) -> None:
    """Take out the mark of an element that is part of the project now."""
    for comment in [*element.iterchildren(etree.Comment)]:
        if _mark(comment) is not None:
            element.remove(comment)


def _mark(comment: etree._Element) -> Any:
    text = comment.text or ""
    if not text.startswith(f'{COMMENT_MARK}{{"{ADDED}"'):
        return None
    try:
        return json.loads(text.removeprefix(COMMENT_MARK)).get(ADDED)
    except (ValueError, RecursionError):
        return None  # who reads the element says that it is damaged


def _digest(element: etree._Element) -> str:
    """The same for elements that say the same, however they are indented and numbered."""
    digest = hashlib.sha256()
    for each in element.iter(etree.Element):
        said = [(name, value) for name, value in sorted(attributes(each).items()) if name not in _NUMBERED]
        text = "" if len(children(each)) else each.text or ""
        digest.update(repr((local(each), len(children(each)), said, text)).encode())
    return digest.hexdigest()[:16]
