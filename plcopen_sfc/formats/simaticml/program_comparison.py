"""Comparison of the programs of a document, and the numbers of their elements.

The ``UId`` of the elements of a program are running numbers that tie its elements together, and mean nothing else. We
number programs as TIA Portal does. Where a file does otherwise, its numbers are kept in short form beside the model, so
that a program without edits keeps them; an edited one of another length gets new numbers.

Programs are compared as trees that were taken out of the document. lxml makes an object for an element whenever it is
asked for; programs are most of the elements of a document, each is read, written once more and compared, and elements
of the standard library take a fifth of the time for that.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any
from xml.etree import ElementTree as ET

from lxml import etree

from plcopen_sfc.formats.simaticml.element_reader import NotUnderstoodError, XmlNode, children, local
from plcopen_sfc.formats.xml.extension_data import attributes, canonical_form


def program_text(element: etree._Element) -> bytes:
    """`element` as text without comments, marks of CDATA, and most of the blanks between elements."""
    text: bytes = etree.tostring(element, with_tail=False)
    if b"<!" in text:
        text = canonical_form(element, comments=False)
    return _BEFORE_START.sub(b"><", text)


_BEFORE_START = re.compile(rb">\s+<(?!/)")
"""Blanks before an element: they are no content, as those before an end may be."""


def parse_program(text: bytes) -> ET.Element:
    """Tree of a text that `program_text` gave: of a document, so its entities and nesting have been looked at.

    Raises `NotUnderstoodError` for processing instructions, which such a tree does not have.
    """
    if b"<?" in text:
        raise NotUnderstoodError("a processing instruction")
    return ET.fromstring(text)  # noqa: S314


UID = "UId"
FIRST = 21
"""First number that TIA Portal gives."""
NUMBERS = "UId numbers"
"""Extension attribute: the numbers of the file, in the order in which this package numbers them."""


def shortened(numbers: list[str], usual: list[str]) -> str:
    """Numbers in short form: ``21-40 42``; "" where they are the `usual` ones."""
    if numbers == usual:
        return ""
    runs: list[list[int]] = []
    for text in numbers:
        number = int(text)
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return " ".join(f"{first}-{last}" if last > first else str(first) for first, last in runs)


def lengthened(text: str, usual: list[str]) -> list[str]:
    """Return the numbers of a short form; the `usual` ones where there are not as many."""
    count = len(usual)
    found: list[str] = []
    for run in text.split():
        first, dash, last = run.partition("-")
        # a damaged run such as 1-999999999 must not fill the memory
        if not _is_number(first) or (dash and not _is_number(last)) or int(last or first) - int(first) >= count:
            return usual
        found += [str(number) for number in range(int(first), int(last or first) + 1)]
    return found if len(found) == count == len(set(found)) else usual


def are_numbers(texts: list[str]) -> bool:
    """True if all of them are plain whole numbers, and all different."""
    return all(map(_is_number, texts)) and len(set(texts)) == len(texts)


def _is_number(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) < _LONGEST and text == str(int(text))


_LONGEST = 12


def numbers_of(root: XmlNode) -> list[str]:
    """Return the numbers of the elements below `root`, which must be whole numbers; rising."""
    return [str(number) for number in sorted({int(str(element.get(UID))) for element in _numbered(root)})]


def renumber(root: XmlNode, text: str) -> None:
    """Give the elements below `root`, which has the usual numbers, those of a short form.

    Operands, parts and wires of networks are in the order of their numbers then, as in TIA Portal.
    """
    usual = numbers_of(root)
    numbers = dict(zip(usual, lengthened(text, usual), strict=True))
    for element in _numbered(root):
        element.set(UID, numbers[str(element.get(UID))])
    for group in root:
        if local(group) in ("Parts", "Wires"):
            ordered: list[Any] = sorted(children(group), key=lambda element: int(str(element.get(UID))))
            group[:] = ordered


def _numbered(root: XmlNode) -> list[XmlNode]:
    return [
        element
        for element in root.iter()
        if isinstance(element.tag, str) and element.get(UID) is not None and element is not root
    ]


Key = tuple[str, ...]
"""Place of an element in a network: that of a part among the parts, or the pin that an operand is wired to."""


def numbers_like(given: XmlNode, written: XmlNode) -> list[str] | None:
    """Return the numbers of `given` in the order of those of `written`; None where the two do not mean the same.

    Mostly they are the same to the letter, or have other words in them; only what is left takes long to compare.
    """
    if is_identical(given, written):
        return numbers_of(written)
    if _words(given) != _words(written):  # cheap, and finds most differences
        return None
    one, other = _described(given), _described(written)
    if [local(child) for child in children(given)] != [local(child) for child in children(written)]:
        return None
    if one is None or other is None or one.keys() != other.keys():
        return None
    if any(one[key][1] != other[key][1] for key in one):
        return None
    return [one[key][0] for key in sorted(other, key=lambda key: int(other[key][0]))]


def is_identical(one: XmlNode, other: XmlNode) -> bool:
    """True if two elements are the same to the letter but for blanks between elements."""
    pairs: Iterable[tuple[XmlNode, XmlNode]] = zip(one.iter(), other.iter(), strict=False)
    for mine, theirs in pairs:
        if mine.tag != theirs.tag or mine.attrib != theirs.attrib or len(mine) != len(theirs):
            return False
        text, other_text = mine.text, theirs.text
        if text != other_text and _significant_text(text, mine) != _significant_text(other_text, theirs):
            return False
        tail, other_tail = mine.tail, theirs.tail
        if tail != other_tail and mine is not one and (tail or "").strip() != (other_tail or "").strip():
            return False
    return True


def _significant_text(text: str | None, element: XmlNode) -> str:
    """Return the text at the start of an element; blanks before other elements mean nothing."""
    return (text or "").strip() if len(element) else text or ""


def _words(net: XmlNode) -> list[tuple[str, ...]]:
    """Return the names, attributes and texts of the elements of a network, without numbers, in no order."""
    found: list[tuple[str, ...]] = []
    for element in net.iter():
        marks = [f"{name}={value}" for name, value in sorted(attributes(element).items()) if not _is_uid(name, value)]
        tail = "" if element is net else (element.tail or "").strip()
        found.append((str(element.tag), _significant_text(element.text, element), tail, *marks))
    return sorted(found)


def _is_uid(name: str, value: str) -> bool:
    return name == UID and (not value or (value.isascii() and value.isdigit()))


def _described(net: XmlNode) -> dict[Key, tuple[str, str]] | None:
    """Number and the content of each numbered element by its place; None for a network that is built otherwise."""
    found: dict[Key, tuple[str, str]] = {}
    operands: dict[str, str] = {}
    places: dict[str, int] = {}
    wires: list[XmlNode] = []
    for group in children(net):
        if group.attrib or local(group) not in ("Labels", "Parts", "Wires"):
            return None
        for child in children(group):
            number = child.get(UID, "")
            if local(child) == "Wire":
                if len(child.attrib) > 1 or any(not set(end.attrib) <= {UID, "Name"} for end in children(child)):
                    return None
                wires.append(child)
            elif local(child) == "Access":
                operands[number] = _content(child)
            elif number in places:
                return None
            else:
                places[number] = len(places)
                found["part", str(places[number])] = number, _content(child)
                for instance in child.iter():
                    if local(instance) == "Instance":
                        found["instance", str(places[number])] = instance.get(UID, ""), ""
    count = len(found) + len(operands)
    for wire in wires:
        ends = [_end(end, places, operands) for end in children(wire)]
        # a wire is known by its first pin: TIA Portal has no two wires at one pin
        pins = sorted(end[1:] for end in ends if end[0] == "NameCon")
        if not pins:
            return None
        place = (*pins[0],)
        found["wire", *place] = wire.get(UID, ""), repr([ends[0][:3], *sorted(end[:3] for end in ends[1:])])
        count += 1
        for end, element in zip(ends, children(wire), strict=True):
            if end[0] in ("IdentCon", "OpenCon"):
                found[end[0], *place] = element.get(UID, ""), ""
                count += end[0] == "OpenCon"
    # two elements at one place replace each other in `found`, which the count shows
    known = len(found) == count and are_numbers([number for number, _ in found.values()])
    return found if known else None


def _end(end: XmlNode, places: dict[str, int], operands: dict[str, str]) -> tuple[str, str, str]:
    kind, number = local(end), end.get(UID, "")
    if kind == "NameCon":
        return kind, str(places.get(number, "?")), end.get("Name", "")
    return kind, operands.get(number, "?") if kind == "IdentCon" else "", ""


def _content(element: XmlNode) -> str:
    """Return the content of an element, without numbers."""
    marks = sorted(
        (key, value) for key, value in attributes(element).items() if key != UID or local(element) in _NESTED
    )
    inner = children(element)
    text = "" if inner else element.text or ""
    return f"{local(element)}{marks}{text}<{''.join(map(_content, inner))}>"


_NESTED = frozenset({"Component", "Constant", "ConstantType", "ConstantValue", "Symbol", "Label"})
"""Elements that have no number in networks of TIA Portal."""
