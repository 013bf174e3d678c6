"""The start values of the elements of an array: ``Subelement`` by its indices, in the model one value of the array."""

from __future__ import annotations

import re
from collections.abc import Iterator

from lxml import etree

from plcopen_sfc.formats.simaticml.reading import Fields, children, local
from plcopen_sfc.formats.simaticml.writing import sub
from plcopen_sfc.formats.xml.extension_data import legal_text
from plcopen_sfc.model.types import ArrayType, ArrayValue, DataType, SimpleValue, Value

_BOUND = re.compile(r"[-+]?\d{1,9}")
_MOST = 100_000
"""More elements than that are not written one by one."""


def read_elements(type: Fields, elements: list[etree._Element]) -> Fields | None:
    """The value of an array whose elements have these start values; None where they say more, or do not fit.

    An element without a value of its own has the default of its type: it is a value without text.
    """
    ranges = _ranges([(d["lower"], d["upper"]) for d in type["dimensions"]]) if type["kind"] == "array" else None
    if ranges is None:
        return None
    items: list[Fields] = []
    following = 0
    for element in elements:
        place = _place(element.get("Path", ""), ranges)
        inner = children(element)
        plain = len(inner) == 1 and local(inner[0]) == "StartValue" and not inner[0].attrib and not len(inner[0])
        if place is None or place < following or not plain or not inner[0].text or set(element.attrib) != {"Path"}:
            return None
        _add(items, None, place - following)
        _add(items, inner[0].text, 1)
        following = place + 1
    return {"kind": "array", "items": items}


def _add(items: list[Fields], text: str | None, count: int) -> None:
    if not count:
        return
    if items and items[-1]["value"]["text"] == text:
        count += int(items[-1]["repetitions"] or 1)
        items.pop()
    value = {"kind": "simple", "text": text}
    items.append({"value": value, "repetitions": str(count) if count > 1 else None})


def write_elements(parent: etree._Element, type: DataType, value: Value) -> bool:
    """Write the start values of an array; False where they are none that TIA Portal can have."""
    if not isinstance(type, ArrayType) or not isinstance(value, ArrayValue):
        return False
    ranges = _ranges([(dimension.lower, dimension.upper) for dimension in type.dimensions])
    texts = _texts(value)
    if ranges is None or texts is None:
        return False
    size = 1
    for lower, upper in ranges:
        size *= upper - lower + 1
    written = sum(count for text, count in texts if text is not None)
    if sum(count for _, count in texts) > size or written > _MOST:
        return False
    place = 0
    for text, count in texts:
        for number in range(place, place + count) if text is not None else ():
            element = sub(parent, "Subelement", {"Path": _path(number, ranges)})
            sub(element, "StartValue").text = legal_text(text or "")
        place += count
    return True


def _texts(value: ArrayValue) -> list[tuple[str | None, int]] | None:
    """The values of an array, each with how often it stands there."""
    found: list[tuple[str | None, int]] = []
    for item in value.items:
        repetitions = item.repetitions or "1"
        if not isinstance(item.value, SimpleValue) or not _BOUND.fullmatch(repetitions) or int(repetitions) < 0:
            return None
        if item.value.text == "":
            return None
        found.append((item.value.text, int(repetitions)))
    return found


def _ranges(bounds: list[tuple[str, str]]) -> list[tuple[int, int]] | None:
    """The bounds of an array; None where they are not plain numbers."""
    found = [(int(lower), int(upper)) for lower, upper in bounds if _BOUND.fullmatch(lower) and _BOUND.fullmatch(upper)]
    return found if len(found) == len(bounds) and all(lower <= upper for lower, upper in found) else None


def _place(path: str, ranges: list[tuple[int, int]]) -> int | None:
    """The place of an element among all: the last index counts first."""
    indices = path.split(",")
    place = 0
    if len(indices) != len(ranges):
        return None
    for text, (lower, upper) in zip(indices, ranges, strict=True):
        if not _BOUND.fullmatch(text) or text != str(int(text)) or not lower <= int(text) <= upper:
            return None
        place = place * (upper - lower + 1) + int(text) - lower
    return place


def _path(place: int, ranges: list[tuple[int, int]]) -> str:
    return ",".join(reversed(list(_indices(place, ranges))))


def _indices(place: int, ranges: list[tuple[int, int]]) -> Iterator[str]:
    """The indices of an element, the last first."""
    for lower, upper in reversed(ranges):
        place, rest = divmod(place, upper - lower + 1)
        yield str(lower + rest)
