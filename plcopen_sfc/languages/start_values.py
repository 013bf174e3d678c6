"""Start values that files give to single elements, such as ``u.y[1] := 2.5``, and values of whole variables."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from math import prod

from plcopen_sfc.languages.s7_types import number_of
from plcopen_sfc.model import types as t

Path = tuple[str | tuple[int, ...], ...]
"""The way to an element: names of members, and indices of elements of arrays."""
Types = Mapping[str, t.DataType]
"""The types that a project declares, by name in lower case."""
_DEEPEST = 32
_MOST = 100_000
"""More elements than that are not listed one by one."""


class ValuePathError(ValueError):
    """A way leads to nothing that a type has, or to an element twice."""


def _plain_type(type_: t.DataType | None, types: Types) -> t.DataType | None:
    """Return a type, or the one that its name refers to; None for a name that nothing declares."""
    for _ in range(_DEEPEST):
        if not isinstance(type_, t.DerivedType):
            break
        type_ = types.get(type_.name.replace('"', "").casefold())
    return type_


def _member_type(type_: t.DataType | None, name: str, types: Types) -> t.DataType | None:
    struct = _plain_type(type_, types)
    if not isinstance(struct, t.StructType):
        return None
    return next((each.type for each in struct.members if each.name.casefold() == name.casefold()), None)


def _ranges(type_: t.DataType | None, types: Types) -> list[range] | None:
    """Return the indices of an array; None where it is none, or its bounds are no numbers, or too far apart."""
    array = _plain_type(type_, types)
    if not isinstance(array, t.ArrayType):
        return None
    bounds = [(number_of(d.lower), number_of(d.upper)) for d in array.dimensions]
    known = [(lower, upper) for lower, upper in bounds if lower is not None and upper is not None]
    found = [range(lower, upper + 1) for lower, upper in known if lower <= upper < lower + sys.maxsize]
    return found if len(found) == len(bounds) else None


def assembled(entries: Iterable[tuple[Path, str]], type_: t.DataType | None, types: Types) -> t.Value | None:
    """Return the value of a variable of which single elements have start values; None where there are none.

    Elements of an array without one of their own are values without text. Raises `ValuePathError`.
    """
    whole: t.SimpleValue | None = None
    members: dict[str, tuple[str, list[tuple[Path, str]]]] = {}
    elements: dict[tuple[int, ...], list[tuple[Path, str]]] = {}
    for path, text in entries:
        if not path:
            if whole is not None:
                raise ValuePathError("a start value is given twice")
            whole = t.SimpleValue(text=text)
        elif isinstance(path[0], str):
            members.setdefault(path[0].casefold(), (path[0], []))[1].append((path[1:], text))
        else:
            elements.setdefault(path[0], []).append((path[1:], text))
    if sum(map(bool, (whole, members, elements))) > 1:
        raise ValuePathError("a start value is given to a whole and to a part of it")
    if members:
        found = [(name, assembled(inner, _member_type(type_, name, types), types)) for name, inner in members.values()]
        return t.StructValue(
            members=[t.MemberValue(member=name, value=value) for name, value in found if value is not None]
        )
    return _array(elements, type_, types) if elements else whole


def _array(
    elements: dict[tuple[int, ...], list[tuple[Path, str]]], type_: t.DataType | None, types: Types
) -> t.ArrayValue:
    ranges, array = _ranges(type_, types), _plain_type(type_, types)
    if ranges is None or not isinstance(array, t.ArrayType):
        raise ValuePathError("the bounds of an array are not known")
    items: list[t.RepeatedValue] = []
    following = 0
    places = {indices: _place(indices, ranges) for indices in elements}
    for indices, place in sorted(places.items(), key=lambda each: each[1]):
        value = assembled(elements[indices], array.base, types) or t.SimpleValue()
        _append(items, t.SimpleValue(), place - following)
        _append(items, value, 1)
        following = place + 1
    return t.ArrayValue(items=items)


def _append(items: list[t.RepeatedValue], value: t.Value, count: int) -> None:
    if not count:
        return
    if items and items[-1].value == value:
        count += int(items.pop().repetitions or 1)
    items.append(t.RepeatedValue(value=value, repetitions=str(count) if count > 1 else None))


def _place(indices: tuple[int, ...], ranges: list[range]) -> int:
    """Return the place of an element among all: the last index counts first."""
    if len(indices) != len(ranges):
        raise ValuePathError("an array has another number of dimensions")
    place = 0
    for index, indexes in zip(indices, ranges, strict=True):
        if index not in indexes:
            raise ValuePathError(f"an array has no element {index}")
        place = place * len(indexes) + index - indexes.start
    return place


def _indices(place: int, ranges: list[range]) -> tuple[int, ...]:
    """Return the indices of the element at a place among all."""
    found: list[int] = []
    for indexes in reversed(ranges):
        place, rest = divmod(place, len(indexes))
        found.append(indexes[rest])
    return tuple(reversed(found))


def apart(value: t.Value, type_: t.DataType | None, types: Types) -> Iterator[tuple[Path, str]]:
    """Yield the single elements that a value gives start values to.

    Raises `ValuePathError` where there is no way to them.
    """
    if isinstance(value, t.SimpleValue):
        if (value.text or "").strip():
            yield (), value.text or ""
    elif isinstance(value, t.StructValue):
        for member in value.members:
            for path, text in apart(member.value, _member_type(type_, member.member, types), types):
                yield (member.member, *path), text
    else:
        ranges, array = _ranges(type_, types), _plain_type(type_, types)
        counts = [number_of(item.repetitions) if item.repetitions is not None else 1 for item in value.items]
        if ranges is None or not isinstance(array, t.ArrayType):
            raise ValuePathError("the elements of an array are not known")
        size, place, listed = prod(map(len, ranges)), 0, 0
        for item, count in zip(value.items, counts, strict=True):
            inner = list(apart(item.value, array.base, types))
            listed += len(inner) * (count or 0)
            if count is None or count < 0 or place + count > size or listed > _MOST:
                raise ValuePathError("an array has fewer elements, or more are given values than can be listed")
            for number in range(place, place + count) if inner else ():
                indices = _indices(number, ranges)
                yield from (((indices, *path), text) for path, text in inner)
            place += count


def filled(value: t.Value, type_: t.DataType | None, types: Types) -> t.Value:
    """Return a value in which the elements of arrays without a text have the start value of their type."""
    if isinstance(value, t.StructValue):
        members = [
            t.MemberValue(member=m.member, value=filled(m.value, _member_type(type_, m.member, types), types))
            for m in value.members
        ]
        return t.StructValue(members=members)
    if isinstance(value, t.ArrayValue):
        array = _plain_type(type_, types)
        base = array.base if isinstance(array, t.ArrayType) else None
        items = []
        for item in value.items:
            is_given = not isinstance(item.value, t.SimpleValue) or (item.value.text or "").strip()
            new = filled(item.value, base, types) if is_given else _usual(base, types)
            items.append(t.RepeatedValue(value=new or item.value, repetitions=item.repetitions))
        return t.ArrayValue(items=items)
    return value


def _usual(type_: t.DataType | None, types: Types, depth: int = 0) -> t.Value | None:
    """Return the start value of a type, written out; of a structure that of its first member, which is enough."""
    found = _plain_type(type_, types)
    if isinstance(found, t.StructType) and found.members and depth < _DEEPEST:
        return _of_first(found.members[0], types, depth)
    if isinstance(found, t.StringType):
        return t.SimpleValue(text='""' if found.wide else "''")
    if isinstance(found, t.ElementaryType):
        return t.SimpleValue(text=_ZEROS.get(found.name, "0"))
    return None


def _of_first(member: t.Variable, types: Types, depth: int) -> t.Value | None:
    value = member.initial or _usual(member.type, types, depth + 1)
    return None if value is None else t.StructValue(members=[t.MemberValue(member=member.name, value=value)])


_ZEROS = {
    t.Elementary.BOOL: "FALSE",
    t.Elementary.REAL: "0.0",
    t.Elementary.LREAL: "0.0",
    t.Elementary.TIME: "T#0s",
    t.Elementary.LTIME: "LTIME#0s",
    t.Elementary.DATE: "D#1970-01-01",
    t.Elementary.TOD: "TOD#00:00:00",
    t.Elementary.DT: "DT#1970-01-01-00:00:00",
    t.Elementary.CHAR: "' '",
    t.Elementary.WCHAR: '" "',
}
