"""Whether two ``FlgNet`` say the same: numbers, and the order of operands and wires, mean nothing."""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.formats.simaticml.reading import XmlNode, attributes, children, local
from plcopen_sfc.formats.simaticml.uids import UID, are_numbers, numbers_of

Key = tuple[str, ...]
"""Where an element stands in a network: the place of a part among the parts, or the pin that an operand is wired to."""


def numbers_like(given: XmlNode, written: XmlNode) -> list[str] | None:
    """The numbers of `given` in the order of those of `written`; None where the two do not say the same.

    Mostly they are the same to the letter, or have other words in them; only what is left takes long to compare.
    """
    if equal(given, written):
        return numbers_of(written)
    if _words(given) != _words(written):
        return None
    one, other = _described(given), _described(written)
    if [local(child) for child in children(given)] != [local(child) for child in children(written)]:
        return None
    if one is None or other is None or one.keys() != other.keys():
        return None
    if any(one[key][1] != other[key][1] for key in one):
        return None
    return [one[key][0] for key in sorted(other, key=lambda key: int(other[key][0]))]


def equal(one: XmlNode, other: XmlNode) -> bool:
    """Whether two elements are the same to the letter but for blanks between elements."""
    pairs: Iterable[tuple[XmlNode, XmlNode]] = zip(one.iter(), other.iter(), strict=False)
    for mine, theirs in pairs:
        if mine.tag != theirs.tag or mine.attrib != theirs.attrib or len(mine) != len(theirs):
            return False
        text, other_text = mine.text, theirs.text
        if text != other_text and _said(text, mine) != _said(other_text, theirs):
            return False
        tail, other_tail = mine.tail, theirs.tail
        if tail != other_tail and mine is not one and (tail or "").strip() != (other_tail or "").strip():
            return False
    return True


def _said(text: str | None, element: XmlNode) -> str:
    """The text at the start of an element; blanks before other elements mean nothing."""
    return (text or "").strip() if len(element) else text or ""


def _words(net: XmlNode) -> list[tuple[str, ...]]:
    """The names, attributes and texts of the elements of a network, without numbers, in no order."""
    found: list[tuple[str, ...]] = []
    for element in net.iter():
        marks = [
            f"{name}={value}" for name, value in sorted(attributes(element).items()) if not _is_number(name, value)
        ]
        tail = "" if element is net else (element.tail or "").strip()
        found.append((str(element.tag), _said(element.text, element), tail, *marks))
    return sorted(found)


def _is_number(name: str, value: str) -> bool:
    return name == UID and (not value or (value.isascii() and value.isdigit()))


def _described(net: XmlNode) -> dict[Key, tuple[str, str]] | None:
    """The number and the content of each numbered element by its place; None for a network that is built otherwise."""
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


def _end(end: XmlNode, places: dict[str, int], operands: dict[str, str]) -> tuple[str, str, str]:
    kind, number = local(end), end.get(UID, "")
    if kind == "NameCon":
        return kind, str(places.get(number, "?")), end.get("Name", "")
    return kind, operands.get(number, "?") if kind == "IdentCon" else "", ""


def _content(element: XmlNode) -> str:
    """What an element says, without numbers."""
    marks = sorted(
        (key, value) for key, value in attributes(element).items() if key != UID or local(element) in _NESTED
    )
    inner = children(element)
    text = "" if inner else element.text or ""
    return f"{local(element)}{marks}{text}<{''.join(map(_content, inner))}>"


_NESTED = frozenset({"Component", "Constant", "ConstantType", "ConstantValue", "Symbol", "Label"})
"""Elements that have no number in networks of TIA Portal."""
