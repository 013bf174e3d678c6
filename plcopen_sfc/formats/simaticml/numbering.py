"""The ids of objects: hexadecimal numbers that mean nothing, and that an edit should not change."""

from __future__ import annotations

from difflib import SequenceMatcher

from lxml import etree

ID = "ID"


def number(root: etree._Element, given: list[str]) -> None:
    """Give every object its id: those of the file (`given`) where they are no running numbers, else these."""
    objects = _all_objects(root)
    ids = given if len(given) == len(objects) else [format(place, "X") for place in range(len(objects))]
    for element, text in zip(objects, ids, strict=True):
        element.set(ID, text)


def number_like(root: etree._Element, before: etree._Element, given: list[str]) -> None:
    """Give every object of an edited document the id that it had `before`; new ones get numbers above all others."""
    pairs: list[tuple[etree._Element, etree._Element]] = []
    _pair(before, root, pairs)
    number(before, given)
    for old, new in pairs:
        new.set(ID, old.get(ID, ""))
    used = [_value(element.get(ID, "")) for element in _all_objects(before)]
    following = max(used, default=-1) + 1
    known = {new for _, new in pairs}
    for element in _all_objects(root):
        if element not in known:
            element.set(ID, format(following, "X"))
            following += 1


def _value(text: str) -> int:
    try:
        return int(text, 16)
    except ValueError:
        return -1


def _all_objects(root: etree._Element) -> list[etree._Element]:
    return [element for element in root.iter(etree.Element) if element.get(ID) is not None]


def _objects(element: etree._Element) -> list[etree._Element]:
    """The objects directly in an object."""
    found: list[etree._Element] = []
    for child in element:
        if isinstance(child.tag, str):
            found += [child] if child.get(ID) is not None else _objects(child)
    return found


def _pair(before: etree._Element, after: etree._Element, pairs: list[tuple[etree._Element, etree._Element]]) -> None:
    """Find the objects in `after` that are those of `before`; ids are not written yet."""
    old, new = _objects(before), _objects(after)
    matcher = SequenceMatcher(None, [_said(one) for one in old], [_said(one) for one in new], autojunk=False)
    for _, old_start, old_end, new_start, new_end in matcher.get_opcodes():
        for one, other in zip(old[old_start:old_end], new[new_start:new_end], strict=False):
            if one.tag == other.tag:
                pairs.append((one, other))
                _pair(one, other, pairs)


def _said(element: etree._Element) -> bytes:
    return etree.tostring(element, with_tail=False)
