"""Remainder of the model beside a text: the difference between what a reader takes from it and what the model holds.

Plain data on both sides: dictionaries of fields that are not at their default. A writer prints an object, knows what
the reader will take from the print, and writes the remainder as pragmas; so nothing is forgotten, whatever the object
holds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal, TypeAlias, get_origin

from pydantic import BaseModel

from plcopen_sfc.languages.pragmas.notation import DEFAULT, NotationError, Scanner, format_key, format_value

Fields: TypeAlias = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Named:
    """A path segment: the item of a list that has this name."""

    name: str


@dataclass(frozen=True, slots=True)
class Numbered:
    """A path segment: the item of a list that has this id."""

    id: int


@dataclass(frozen=True, slots=True)
class Append:
    """A path segment: a new item at the end of a list."""


Segment: TypeAlias = str | int | Named | Numbered | Append


@dataclass(frozen=True, slots=True)
class RemainderEntry:
    """The value at `path` is `value`; `DEFAULT`: nothing is said there.

    `instead` is what the text says there, None if it says nothing. Who edits the text means the text: the change is
    made only as long as the text says that.
    """

    path: tuple[Segment, ...]
    value: Any
    instead: Any = None

    def __str__(self) -> str:
        path = format_path(self.path)
        if self.value is True and self.instead is None:
            return path
        text = f"{path} := {format_value(self.value)}"
        return text if self.instead is None else f"{text} FOR {format_value(self.instead)}"


# -- from the model to plain data -----------------------------------------------------------------------------------

_TAGS = ("kind", "language")
Substitute: TypeAlias = Callable[[BaseModel], Any]


def plain_fields(thing: BaseModel, substitute: Substitute | None = None, leave: frozenset[str] = frozenset()) -> Fields:
    """The fields of `thing` that are not at their default, those named in `leave` left out.

    `substitute` may give other data for an object inside it; None: none.
    """
    fields: Fields = {}
    for name, always, default in _defaults(type(thing)):
        if name not in leave:
            value = getattr(thing, name)
            if always or value != default:
                fields[name] = plain_value(value, substitute)
    return fields


@cache
def _defaults(kind: type[BaseModel]) -> list[tuple[str, bool, Any]]:
    """Of each field its name, whether it is always to be said, and its default."""
    return [
        (
            name,
            info.is_required() or (name in _TAGS and get_origin(info.annotation) is Literal),
            info.get_default(call_default_factory=True),
        )
        for name, info in kind.model_fields.items()
    ]


def plain_value(value: Any, substitute: Substitute | None = None) -> Any:
    """`value` as plain data."""
    if isinstance(value, BaseModel):
        replaced = substitute(value) if substitute is not None else None
        return plain_fields(value, substitute) if replaced is None else replaced
    if isinstance(value, list | tuple):
        return [plain_value(item, substitute) for item in value]
    if isinstance(value, dict):
        return {str(key): plain_value(item, substitute) for key, item in value.items()}
    return str(value) if isinstance(value, str) else value


# -- differences ------------------------------------------------------------------------------------------------------


def changes(
    said: Any, meant: Any, path: tuple[Segment, ...] = (), *, guarded: bool = False
) -> Iterator[RemainderEntry]:
    """Return what to state beside a text with the content `said`, so that it has the content `meant`.

    `guarded`: each change of fields and lists tells what they are in the text, too, not only one of a plain value. The
    reader must have all of the text before it makes the first change.
    """
    if isinstance(said, dict) and isinstance(meant, dict) and (not path or (meant and _same_kind(said, meant))):
        for key in meant:
            if key in said:
                yield from changes(said[key], meant[key], (*path, key), guarded=guarded)
            else:
                yield from additions(meant[key], (*path, key))
        for key in said:
            if key not in meant:
                yield RemainderEntry((*path, key), DEFAULT, _instead(said[key], guarded))
    elif isinstance(said, list) and isinstance(meant, list) and _starts_alike(said, meant):
        for one, other, segment in zip(said, meant, _segments(said, meant), strict=False):
            yield from changes(one, other, (*path, segment), guarded=guarded)
        for index, item in enumerate(meant[len(said) :], len(said)):
            yield from _appended(item, path, index)
    elif said != meant or type(said) is not type(meant):
        if isinstance(said, list) and isinstance(meant, list) and said and meant:
            yield RemainderEntry(path, [], _instead(said, guarded))
            yield from additions(meant, path)
        else:
            yield RemainderEntry(path, meant, _instead(said, guarded))


def _instead(said: Any, guarded: bool) -> Any:
    return said if guarded or not isinstance(said, dict | list) else None


def additions(meant: Any, path: tuple[Segment, ...]) -> Iterator[RemainderEntry]:
    """Yield what to state where the text has nothing: one line for each field and each item of a list."""
    if isinstance(meant, dict) and meant and not _is_map(meant):
        for key in meant:
            yield from additions(meant[key], (*path, key))
    elif isinstance(meant, list) and any(isinstance(item, dict | list) for item in meant):
        for index, item in enumerate(meant):
            yield from _appended(item, path, index)
    else:
        yield RemainderEntry(path, meant)


def _appended(item: Any, path: tuple[Segment, ...], index: int) -> Iterator[RemainderEntry]:
    """A new item of a list; if it is long, its own lists on lines of their own."""
    lists = {key: value for key, value in item.items() if _is_list_of_fields(value)} if isinstance(item, dict) else {}
    if not lists or len(format_value(item)) <= _WIDE:
        yield RemainderEntry((*path, Append()), item)
        return
    yield RemainderEntry((*path, Append()), {key: value for key, value in item.items() if key not in lists})
    for key, value in lists.items():
        yield from additions(value, (*path, index, key))


_WIDE = 300


def _is_list_of_fields(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def _same_kind(said: Fields, meant: Fields) -> bool:
    return said.get("kind") == meant.get("kind")


def _is_map(fields: Fields) -> bool:
    """True if these are many things of a kind by their names, which are better shown together."""
    return len(fields) > _MANY and all(isinstance(value, dict) for value in fields.values())


_MANY = 4


def _starts_alike(said: list[Any], meant: list[Any]) -> bool:
    """True if the items of `said` are those that `meant` begins with; in a list as long, some may have other names."""
    if not said or len(said) > len(meant) or any(type(o) is not type(t) for o, t in zip(said, meant, strict=False)):
        return False
    if not all(isinstance(item, dict) for item in said):
        return len(said) == len(meant)
    alike = sum(all(o.get(key) == t.get(key) for key in _KEYS) for o, t in zip(said, meant, strict=False))
    return alike == len(said) or (len(said) == len(meant) and 2 * alike >= len(said))


_KEYS = ("name", "kind")


def _segments(said: list[Any], meant: list[Any]) -> list[Segment]:
    """How to point at each item: by its name, if it keeps that and is the only one of that name."""
    names = [_name(item) for item in said]
    folded = [name.casefold() for name in names]
    return [
        Named(name) if name and folded.count(name.casefold()) == 1 and _name(other) == name else index
        for index, (name, other) in enumerate(zip(names, meant, strict=False))
    ]


def _name(item: Any) -> str:
    name = item.get("name") if isinstance(item, dict) else None
    return name if isinstance(name, str) else ""


# -- applying ---------------------------------------------------------------------------------------------------------


class PathError(ValueError):
    """A path that leads nowhere."""


class StaleError(ValueError):
    """A change that was made for another text than the one that stands there now."""


def apply(fields: Fields, change: RemainderEntry) -> None:
    """Make `change` in `fields`. Raises `StaleError` where the text says something new there, and `PathError`."""
    holder: Any = fields
    for segment, following in zip(change.path, change.path[1:], strict=False):
        holder = _enter(holder, segment, following)
    last = change.path[-1]
    if isinstance(last, str):
        if not isinstance(holder, dict):
            raise PathError(f"{format_path(change.path)}: there are no fields")
        if change.instead is not None and holder.get(last) != change.instead:
            raise StaleError(f"the text says {format_value(holder.get(last))} now")
        if change.value is DEFAULT:
            holder.pop(last, None)
        else:
            holder[last] = change.value
    elif isinstance(last, Append):
        holder.append(change.value)
    else:
        holder[_index(holder, last)] = change.value


def value_at(fields: Fields, path: tuple[Segment, ...]) -> Any:
    """The value at `path`; None where nothing is there."""
    found: Any = fields
    try:
        for segment in path:
            if isinstance(segment, str):
                found = found.get(segment) if isinstance(found, dict) else None
            else:
                found = found[_index(found, segment)]
    except PathError:
        return None
    return found


def _enter(holder: Any, segment: Segment, following: Segment) -> Any:
    if not isinstance(segment, str):
        inner = holder[_index(holder, segment)]
    elif isinstance(holder, dict):
        inner = holder.setdefault(segment, {} if isinstance(following, str) else [])
    else:
        raise PathError(f"{segment}: there are no fields here")
    if not isinstance(inner, dict if isinstance(following, str) else list):
        raise PathError(f"{format_path((segment,))} holds {'no fields' if isinstance(following, str) else 'no list'}")
    return inner


def _index(items: Any, segment: Segment) -> int:
    if isinstance(items, list):
        for index, item in enumerate(items):
            if segment == index and not isinstance(segment, bool):
                return index
            if isinstance(item, dict) and (
                (isinstance(segment, Named) and str(item.get("name", "")).casefold() == segment.name.casefold())
                or (isinstance(segment, Numbered) and item.get("id") == segment.id)
            ):
                return index
    raise PathError(f"there is no {format_path((segment,))} here")


# -- paths as text ----------------------------------------------------------------------------------------------------


def format_path(path: tuple[Segment, ...]) -> str:
    """``supervision.condition``, ``variables[Start].comment``, ``symbols[]``, ``steps[#4].carried``."""
    text = ""
    for segment in path:
        if isinstance(segment, str):
            text += ("." if text else "") + format_key(segment)
        elif isinstance(segment, Named):
            text += f"[{format_key(segment.name)}]"
        elif isinstance(segment, Numbered):
            text += f"[#{segment.id}]"
        else:
            text += "[]" if isinstance(segment, Append) else f"[{segment}]"
    return text


def parse_change(text: str, position: int = 0) -> RemainderEntry:
    """The change that ``path := value`` says; ``path`` alone means TRUE. Raises `NotationError`."""
    scanner = Scanner(text, position)
    path: list[Segment] = [scanner.key()]
    while (mark := scanner.next_mark()) in (".", "["):
        scanner.take(mark)
        if mark == ".":
            path.append(scanner.key())
        else:
            path.append(_bracketed(scanner))
            scanner.take("]")
    value: Any = True
    if not scanner.at_end():
        scanner.take(":=")
        value = scanner.value()
    instead: Any = None
    if not scanner.at_end():
        scanner.word("FOR")
        instead = scanner.value()
    if not scanner.at_end():
        raise NotationError("nothing may follow the value", scanner.position)
    return RemainderEntry(tuple(path), value, instead)


def _bracketed(scanner: Scanner) -> Segment:
    if scanner.next_mark() == "]":
        return Append()
    if scanner.next_mark() == "#":
        scanner.take("#")
        return Numbered(scanner.number())
    start = scanner.position
    try:
        return Named(scanner.key())
    except NotationError:
        scanner.position = start
        return scanner.number()
