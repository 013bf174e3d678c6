"""Whether two ``FlgNet`` say the same: numbers, and the order of operands and wires, mean nothing."""

from __future__ import annotations

import re

from lxml import etree

from plcopen_sfc.formats.simaticml.reading import attributes, children, local
from plcopen_sfc.formats.simaticml.uids import UID, are_numbers, numbers_of
from plcopen_sfc.formats.xml.canonical import canonical_form

Key = tuple[str, ...]
"""Where an element stands in a network: the place of a part among the parts, or the pin that an operand is wired to."""


def numbers_like(given: etree._Element, written: etree._Element) -> list[str] | None:
    """The numbers of `given` in the order of those of `written`; None where the two do not say the same.

    Mostly they are the same to the letter, or have other words in them; only what is left takes long to compare.
    """
    text, written_text = _text(given), _text(written)
    if text == written_text:
        return numbers_of(written)
    if _words(text) != _words(written_text):
        return None
    one, other = _described(given), _described(written)
    if [local(child) for child in children(given)] != [local(child) for child in children(written)]:
        return None
    if one is None or other is None or one.keys() != other.keys():
        return None
    if any(one[key][1] != other[key][1] for key in one):
        return None
    return [one[key][0] for key in sorted(other, key=lambda key: int(other[key][0]))]


def _text(net: etree._Element) -> bytes:
    """A network as text without comments, and without blanks between elements."""
    text = canonical_form(net, comments=False)
    if net.prefix is not None:  # what our writer makes has one, files do not
        prefix = net.prefix.encode()
        text = text.replace(b"<" + prefix + b":", b"<").replace(b"</" + prefix + b":", b"</")
        text = text.replace(b" xmlns:" + prefix + b"=", b" xmlns=", 1)
    return _BEFORE_START.sub(b">", _BEHIND_END.sub(lambda found: found[1], text))


_BEHIND_END = re.compile(rb"(</[^>]*+>)\s++")
_BEFORE_START = re.compile(rb">\s++(?=<[^/])")
_NUMBER = re.compile(rb' UId="\d*+"')


def _words(text: bytes) -> list[bytes]:
    """The tags and texts of a network, without numbers, in no order."""
    return sorted(_NUMBER.sub(b"", text).split(b"<"))


def _described(net: etree._Element) -> dict[Key, tuple[str, str]] | None:
    """The number and the content of each numbered element by its place; None for a network that is built otherwise."""
    found: dict[Key, tuple[str, str]] = {}
    operands: dict[str, str] = {}
    places: dict[str, int] = {}
    wires: list[etree._Element] = []
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
                for instance in child.iter("{*}Instance"):
                    found["instance", str(places[number])] = instance.get(UID, ""), ""
    count = len(found) + len(operands)
    for wire in wires:
        ends = [_end(end, places, operands) for end in children(wire)]
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
    known = len(found) == count and are_numbers([number for number, _ in found.values()])
    return found if known else None


def _end(end: etree._Element, places: dict[str, int], operands: dict[str, str]) -> tuple[str, str, str]:
    kind, number = local(end), end.get(UID, "")
    if kind == "NameCon":
        return kind, str(places.get(number, "?")), end.get("Name", "")
    return kind, operands.get(number, "?") if kind == "IdentCon" else "", ""


def _content(element: etree._Element) -> str:
    """What an element says, without numbers."""
    marks = sorted(
        (key, value) for key, value in attributes(element).items() if key != UID or local(element) in _NESTED
    )
    inner = children(element)
    text = "" if inner else element.text or ""
    return f"{local(element)}{marks}{text}<{''.join(map(_content, inner))}>"


_NESTED = frozenset({"Component", "Constant", "ConstantType", "ConstantValue", "Symbol", "Label"})
"""Elements that have no number in networks of TIA Portal."""
