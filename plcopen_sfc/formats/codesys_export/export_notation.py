"""Archives of objects in exports of CODESYS V3, and in the short notation of TwinCAT (`archives.object_archive`).

Both hold the same objects. ``<o n="Root" t="SFCSegment">`` is ``<Single Name="Root" Type="{f1db..}"
Method="IArchivable">`` here; values name their type instead of showing it, dictionaries have an ``Entry`` with ``Key``
and ``Value``. Texts are one value, or in older versions an object for each line, which has a number. (Two exports of
CODESYS 3.5.16 and 3.5.22, one of e!COCKPIT 1.10 with four charts)
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from difflib import SequenceMatcher

from lxml import etree

from plcopen_sfc.errors import Location, StructureError
from plcopen_sfc.formats.archives.object_archive import TYPES
from plcopen_sfc.formats.xml.xml_parsing import line_of
from plcopen_sfc.whole_numbers import whole_number

SINGLE, NONE, KEY = "Single", "Null", "Name"
_NAMES = {guid.casefold(): name for name, guid in TYPES.items()}
_LISTS = {"List2": "l2", "List": "l", "Array": "l2", "Dictionary": "d2", "Dictionary2": "d2"}
_LINE_TYPE = "{a5de0b0b-1cb5-4913-ac21-9d70293ec00d}"
_LINES, _BLOB, _TEXT = "TextLines", "TextBlobForSerialisation", "Text"
_DOCUMENT_TYPE = "{f3878285-8e4f-490b-bb1b-9acbb7eb04db}"
_GUID = re.compile(r"\{[0-9a-fA-F-]{36}\}")


def member(thing: etree._Element | None, *names: str) -> etree._Element | None:
    """Return the member of an object, or of a member of it, with this name."""
    for name in names:
        thing = next((child for child in thing if child.get(KEY) == name), None) if thing is not None else None
    return thing


def value(thing: etree._Element | None, *names: str) -> str:
    """Return the text of a member; empty where it has none."""
    found = member(thing, *names)
    return (found.text or "") if found is not None else ""


# -- objects ----------------------------------------------------------------------------------------------------------


def shortened(thing: etree._Element) -> etree._Element:
    """Return an object in the short notation, each element with the line of its own. Raises `StructureError`."""
    written = _shortened(thing)
    if thing.get(KEY) is not None:
        written.set("n", str(thing.get(KEY)))
    take_line(written, thing)
    return written


def take_line(written: etree._Element, source: etree._Element) -> None:
    """Give an element the line of another one; libxml2 keeps 16 bits of it."""
    line = source.sourceline
    if isinstance(line, int):
        written.sourceline = min(line, 0xFFFF)


def _shortened(thing: etree._Element) -> etree._Element:
    kind = thing.get("Type", "")
    if thing.tag == NONE:
        return etree.Element("n")
    if thing.tag in _LISTS:
        written = etree.Element(_LISTS[str(thing.tag)])
        for child in thing.iterchildren(etree.Element):
            if child.tag == "Entry":
                written.extend([shortened(each) for holder in child for each in holder.iterchildren(etree.Element)])
            else:
                written.append(shortened(child))
        return written
    if thing.tag == SINGLE and thing.get("Method") is not None:
        written = etree.Element("o", t=_NAMES.get(kind.casefold(), kind))
        written.extend([shortened(child) for child in thing.iterchildren(etree.Element)])
        return written
    if thing.tag != SINGLE:
        raise StructureError(f"<{thing.tag}> is nothing that an archive holds", location=Location(None, line_of(thing)))
    written = etree.Element("v")
    text = thing.text or ""
    match kind:
        case "string":
            written.text = f'"{text}"'
        case "System.Guid":
            written.text = f"{{{text}}}"
        case "bool":
            written.text = text.casefold()
        case "long":
            written.text = f"{text}L"
        case _:
            written.text = text
    return written


def spelled_out(thing: etree._Element) -> etree._Element:
    """Return an object of the short notation as an export has it."""
    return _spelled_out(thing, "")


def _spelled_out(thing: etree._Element, item_type: str) -> etree._Element:
    """Return it; `item_type` is the type that the list or the dictionary around it gives all of its items."""
    name = thing.get("n")
    named = {KEY: str(name)} if name is not None else {}
    match thing.tag:
        case "n":
            return etree.Element(NONE, dict(named))
        case "o":
            kind = thing.get("t") or item_type
            written = etree.Element(SINGLE, {**named, "Type": TYPES.get(kind, kind), "Method": "IArchivable"})
            written.extend([_spelled_out(child, "") for child in thing])
            return written
        case "d2":
            written = etree.Element("Dictionary2", named)
            found = list(thing)
            for key, item in zip(found[::2], found[1::2], strict=True):
                entry = etree.SubElement(written, "Entry")
                etree.SubElement(entry, "Key").append(_spelled_out(key, thing.get("ckt", "")))
                etree.SubElement(entry, "Value").append(_spelled_out(item, thing.get("cvt", "")))
            return written
        case "l" | "l2":
            typed = {"Type": TYPES["ArrayList"]} if thing.tag == "l" else {}
            written = etree.Element("List" if thing.tag == "l" else "List2", {**named, **typed})
            written.extend([_spelled_out(child, thing.get("cet", "")) for child in thing])
            return written
    text = thing.text or ""
    if text[:1] == '"':
        return _value(named, "string", text[1:-1])
    if _GUID.fullmatch(text):
        return _value(named, "System.Guid", text[1:-1])
    if text in ("true", "false"):
        return _value(named, "bool", text.capitalize())
    if text.endswith("L") and text[:-1].lstrip("-").isdigit():
        return _value(named, "long", text[:-1])
    return _value(named, TYPES.get(item_type, item_type), text)


def _value(named: dict[str, str], kind: str, text: str) -> etree._Element:
    written = etree.Element(SINGLE, {**named, "Type": kind})
    written.text = text
    return written


# -- texts ------------------------------------------------------------------------------------------------------------


def text_of(holder: etree._Element | None) -> tuple[str, etree._Element] | None:
    """Return the text in an ``Interface`` or ``Implementation``, and the element in which it begins."""
    document = member(holder, "TextDocument")
    blob = member(document, _BLOB)
    if blob is not None:
        return blob.text or "", blob
    lines = member(document, _LINES)
    if lines is None or document is None:
        return None
    found = [value(line, _TEXT) for line in lines.iterchildren(SINGLE)]
    return "\n".join(found), next(iter(lines.iter(etree.Element)))


def broken_texts(holder: etree._Element) -> Iterator[etree._Element]:
    """Yield elements of an ``Interface`` or ``Implementation`` of text in which text is missing, or more than one."""
    documents = [each for each in holder if each.get(KEY) == "TextDocument"]
    held = [each for document in documents for each in document if each.get(KEY) in (_BLOB, _LINES)]
    if len(documents) != 1 or len(held) != 1:
        yield holder
    for lines in (each for each in held if each.get(KEY) == _LINES):
        for line in lines.iterchildren(etree.Element):
            if line.tag != SINGLE or member(line, _TEXT) is None:
                yield line


def repeated_lines(holder: etree._Element) -> Iterator[etree._Element]:
    """Yield the lines of an ``Interface`` or ``Implementation`` that have the number of a line before them."""
    lines = member(holder, "TextDocument", _LINES)
    seen: set[str] = set()
    for line in lines.iterchildren(SINGLE) if lines is not None else ():
        number = value(line, "Id")
        if number in seen:
            yield line
        seen.add(number)


def line_elements(holder: etree._Element | None) -> list[etree._Element]:
    """Return the element of each line of such a text, where it has one for each."""
    lines = member(holder, "TextDocument", _LINES)
    return [each for line in lines for each in line if each.get(KEY) == _TEXT] if lines is not None else []


def new_text(holder: etree._Element, text: str) -> None:
    """Put a text into an ``Interface`` or ``Implementation`` that has none."""
    document = etree.SubElement(holder, SINGLE, Name="TextDocument", Type=_DOCUMENT_TYPE, Method="IArchivable")
    etree.SubElement(document, SINGLE, Name=_BLOB, Type="string").text = text


def change_text(holder: etree._Element, text: str) -> None:
    """Put a text in the place of the one that is there; lines that stay keep their numbers."""
    document = member(holder, "TextDocument")
    lines = member(document, _LINES)
    blob = member(document, _BLOB)
    if blob is not None:
        blob.text = text
    elif document is None or lines is None:
        new_text(holder, text)
    else:
        old = list(lines.iterchildren(SINGLE))
        numbers = [number for line in old if (number := whole_number(value(line, "Id"))) is not None]
        after = text.split("\n")
        free = max(numbers, default=0) + 1
        matcher = SequenceMatcher(None, [value(line, _TEXT) for line in old], after, autojunk=False)
        for kind, start, end, first, last in reversed(matcher.get_opcodes()):
            if kind == "equal":
                continue
            for line, changed in zip(old[start:end], after[first:last], strict=False):
                text_element = member(line, _TEXT)
                if text_element is not None:
                    text_element.text = changed
            for line in old[start + last - first : end]:
                lines.remove(line)
            for place in range(first + end - start, last):
                lines.insert(start + place - first, _new_line(free, after[place]))
                free += 1


def _new_line(number: int, text: str) -> etree._Element:
    line = etree.Element(SINGLE, Type=_LINE_TYPE, Method="IArchivable")
    etree.SubElement(line, SINGLE, Name="Id", Type="long").text = str(number)
    etree.SubElement(line, NONE, Name="Tag")
    etree.SubElement(line, SINGLE, Name=_TEXT, Type="string").text = text
    return line
