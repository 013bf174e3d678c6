"""Identities of objects in files of TwinCAT 3 and CODESYS V3, and their sections of text."""

from __future__ import annotations

from collections.abc import Container
from uuid import NAMESPACE_URL, uuid5

from lxml import etree


def identity_of(element: etree._Element) -> str | None:
    """Return the identity of an object, without braces."""
    found = element.get("Id")
    return str(found).strip("{}") if found is not None else None


def identity(known: str | None, *names: str, taken: Container[str] = ()) -> str:
    """Return the identity of an object: a new one follows from its name, so that it is the same in every run.

    An object that was renamed since keeps the one of its old name: that is `taken`.
    """
    made = str(uuid5(NAMESPACE_URL, "/".join(("twincat", *names))))
    while made in taken:
        made = str(uuid5(NAMESPACE_URL, made))
    return f"{{{known or made}}}"


def add_code(parent: etree._Element, name: str, text: str) -> None:
    """Append a section with a text."""
    child = etree.SubElement(parent, name)
    # text that ends such a section cannot stand in one
    child.text = etree.CDATA(text) if "]]>" not in text else text
