"""Properties of function blocks: texts in the model, elements with GET and SET in files."""

from __future__ import annotations

import copy
import re
from collections.abc import Container, Iterator

from lxml import etree

from plcopen_sfc.formats.archives.object_identities import add_code, identity, identity_of
from plcopen_sfc.formats.iectext.object_declarations import PROPERTY
from plcopen_sfc.languages.declarations.kept_texts import wrapped
from plcopen_sfc.model.base import ForeignData


def kept_property(element: etree._Element) -> ForeignData:
    """Return a property as the text that is kept of one."""
    return ForeignData.model_validate(wrapped(PROPERTY, "\n".join(text for text, _ in _texts_of_property(element))))


def _texts_of_property(element: etree._Element) -> Iterator[tuple[str, etree._Element | None]]:
    """Yield the parts of the text of a property, each with the element that has it, None for keywords."""
    head = element.find("Declaration")
    found: list[tuple[str, etree._Element | None]] = [
        ((head.text if head is not None else "") or f"PROPERTY {element.get('Name')}", head)
    ]
    for access in element.iterchildren("Get", "Set"):
        parts = (access.find("Declaration"), access.find("Implementation/ST"))
        texts = [((part.text or "") if part is not None else "", part) for part in parts]
        found += [(access.tag.upper(), None), *texts, (f"END_{access.tag.upper()}", None)]
    yield from ((text.strip(), part) for text, part in found if text.strip())
    yield "END_PROPERTY", None


def edited_property(source: etree._Element, text: str) -> etree._Element | None:
    """Return a copy of a property with another text of as many lines; None where it has another form."""
    written = copy.deepcopy(source)
    lines = text.split("\n")
    for before, part in [*_texts_of_property(written)]:
        count = before.count("\n") + 1
        after, lines = "\n".join(lines[:count]), lines[count:]
        if part is None and after != before:
            return None
        if part is not None and after != before:
            part.text = (part.text or "").replace(before, after, 1) or after
    return written if not lines else None


_HEAD = re.compile(r"^\s*PROPERTY\b([^:\n]*)", re.MULTILINE | re.IGNORECASE)
_ACCESSOR = re.compile(r"^\s*(GET|SET)\s*$(.*?)^\s*END_\1\s*$", re.MULTILINE | re.DOTALL | re.IGNORECASE)
_KEYWORD = re.compile(r"^\s*(?:GET|SET)\s*$", re.MULTILINE | re.IGNORECASE)
_DECLARED = re.compile(r"(?:\s*\bVAR\w*\b.*?\bEND_VAR\b)*", re.DOTALL | re.IGNORECASE)


def name_of_property(text: str) -> str:
    """Return the name in the text of a property: the last word before its type; empty where there is none."""
    found = _HEAD.search(text)
    return (found[1].split() or [""])[-1] if found is not None else ""


def written_property(
    pou: str, text: str, source: etree._Element | None, taken: Container[str]
) -> etree._Element | None:
    """Return a property from its text, with the identities of `source`; None where the text has another form."""
    name = name_of_property(text)
    first = _ACCESSOR.search(text)
    if not name or first is None or _KEYWORD.search(text[: first.start()]):
        return None
    old = [source, *source] if source is not None else []
    known = {each.tag: identity_of(each) for each in old if each is not None}
    written = etree.Element("Property", Name=name, Id=identity(known.get("Property"), pou, name, taken=taken))
    add_code(written, "Declaration", text[: first.start()].strip())
    for found in _ACCESSOR.finditer(text):
        kind = found[1].capitalize()
        number = identity(known.get(kind), pou, name, kind, taken=taken)
        accessor = etree.SubElement(written, kind, Name=kind, Id=number)
        declared = _DECLARED.match(found[2])
        length = declared.end() if declared is not None else 0
        add_code(accessor, "Declaration", found[2][:length].strip())
        add_code(etree.SubElement(accessor, "Implementation"), "ST", found[2][length:].strip())
    rebuilt = " ".join(part for part, _ in _texts_of_property(written))
    return written if rebuilt.split() == text.split() else None
