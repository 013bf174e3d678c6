"""The pragma ``{plcopen_sfc path := value}``: what IEC 61131-3 cannot express, in a form to read and to diff.

Other tools ignore them. They hold the difference between what a reader takes from a text and what the model holds.
Plain data on both sides: dictionaries of fields that are not at their default. A writer prints an object, knows what
the reader will take from the print, and writes the remainder as pragmas; so nothing is forgotten, whatever the object
holds.

Values are literals of IEC 61131-3, ``(key := value)`` and ``[value, value]``. No value has a brace or a comment mark
in it, so that every tool finds the end of the pragma: ``{plcopen_sfc supervision := (alarm := 'too hot', condition :=
(kind := 'expression', text := 'x > 3'))}``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Final, Literal, TypeAlias, get_origin

from pydantic import BaseModel

from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.whole_numbers import whole_number


class Default:
    """The value of a field that a text does not state."""

    def __repr__(self) -> str:
        return "DEFAULT"


DEFAULT: Final = Default()
"""The value ``DEFAULT``: the field has its default, whatever is in the text beside the pragma."""


class NotationError(ValueError):
    """Not a value: what is wrong, at `position` of the text."""

    def __init__(self, message: str, position: int) -> None:
        super().__init__(message)
        self.position = position


_WORDS: dict[str, Any] = {"TRUE": True, "FALSE": False, "NULL": None, "DEFAULT": DEFAULT}
_ESCAPES = {"$": "$$", "'": "$'", "\n": "$N", "\r": "$R", "\t": "$T", "{": "$7B", "}": "$7D"}
_MUST_ESCAPE = re.compile(r"[$'{}\x00-\x1f\x7f-\x9f\u2028\u2029\ufeff]|(?<=\()\*|\*(?=\))")
_UNESCAPES = {"$": "$", "'": "'", '"': '"', "N": "\n", "L": "\n", "R": "\r", "T": "\t", "P": "\f"}
_ESCAPED = re.compile(r"\$(?:u([0-9A-Fa-f]{4})|([0-9A-Fa-f]{2})|([\s\S]))")


def format_value(value: Any) -> str:
    """`value` (plain data as JSON has it, or `DEFAULT`) in the notation, on one line."""
    if value is None:
        return "NULL"
    if value is True or value is False:
        return "TRUE" if value else "FALSE"
    if isinstance(value, int):
        return str(int(value))
    if isinstance(value, float):
        return str(int(value)) if value.is_integer() else repr(value)
    if isinstance(value, str):
        return format_string(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(format_value, value)) + "]"
    if isinstance(value, dict):
        return "(" + ", ".join(f"{format_key(k)} := {format_value(value[k])}" for k in value) + ")"
    return repr(value)


def format_string(text: str) -> str:
    """`text` as a string literal with the escapes of IEC 61131-3, and ``$u0085`` for further control characters."""
    return "'" + _MUST_ESCAPE.sub(_escape, text) + "'"


def _escape(found: re.Match[str]) -> str:
    character = found.group()
    code = ord(character)
    return _ESCAPES.get(character) or (f"${code:02X}" if code < 0x80 else f"$u{code:04X}")


def format_key(key: str) -> str:
    """Return a key: a plain word where it is read as one (``nan`` is a number), or a string."""
    found = _TOKEN.fullmatch(key)
    return key if found is not None and found.group("word") == key else format_string(key)


_TOKEN = re.compile(
    r"\s*(?:(?P<string>'[^$']*+(?:\$.[^$']*+)*+')|(?P<number>[-+]?(?:\d[\d.]*(?:[eE][-+]?\d+)?|inf|nan)\b)"
    r"|(?P<word>[A-Za-z_]\w*)|(?P<mark>:=|[()\[\],.#]))",
    re.DOTALL | re.ASCII,
)
_DEEPEST = 200


class Scanner:
    """Reads keys, marks and values from a text, from `position` on. All methods raise `NotationError`."""

    def __init__(self, text: str, position: int = 0) -> None:
        self.text = text
        self.position = position

    def at_end(self) -> bool:
        """True if only blanks are left."""
        return not self.text[self.position :].strip()

    def next_mark(self) -> str:
        """Return the mark that comes next, or an empty text. Does not move."""
        found = _TOKEN.match(self.text, self.position)
        return (found.group("mark") or "") if found is not None else ""

    def take(self, mark: str) -> None:
        """Move over `mark`."""
        found = _TOKEN.match(self.text, self.position)
        if found is None or found.group("mark") != mark:
            raise NotationError(f"{mark} is expected here", self.position)
        self.position = found.end()

    def word(self, word: str) -> None:
        """Move over the word `word`."""
        found = _TOKEN.match(self.text, self.position)
        if found is None or found.group("word") != word:
            raise NotationError("nothing may follow the value", self.position)
        self.position = found.end()

    def key(self) -> str:
        """Move over a key."""
        found = self._token("a name is expected here")
        if found.group("word") is None and found.group("string") is None:
            raise NotationError("a name is expected here", found.start())
        return found.group("word") or _unescape(found.group("string"))

    def number(self) -> int:
        """Move over a whole number."""
        found = self._token("a number is expected here")
        number = whole_number(found.group("number"))
        if number is None:
            raise NotationError("a number is expected here", found.start())
        return number

    def value(self, depth: int = 0) -> Any:
        """Move over a value."""
        if depth > _DEEPEST:
            raise NotationError("this value is nested too deeply", self.position)
        found = self._token("a value is expected here")
        if found.group("string") is not None:
            return _unescape(found.group("string"))
        if found.group("number") is not None:
            number = found.group("number")
            try:
                return int(number) if re.fullmatch(r"[-+]?\d+", number) else float(number)
            except ValueError as error:
                raise NotationError(f"{number} is no number", found.start()) from error
        if found.group("word") is not None:
            if found.group("word") not in _WORDS:
                raise NotationError("a value is expected here; texts stand in '..'", found.start())
            return _WORDS[found.group("word")]
        if found.group("mark") == "[":
            return self._items(depth)
        if found.group("mark") == "(":
            return self._fields(depth)
        raise NotationError("a value is expected here", found.start())

    def _items(self, depth: int) -> list[Any]:
        items: list[Any] = []
        while self.next_mark() != "]":
            if items:
                self.take(",")
            items.append(self.value(depth + 1))
        self.take("]")
        return items

    def _fields(self, depth: int) -> dict[str, Any]:
        fields: dict[str, Any] = {}
        while self.next_mark() != ")":
            if fields:
                self.take(",")
            key = self.key()
            self.take(":=")
            fields[key] = self.value(depth + 1)
        self.take(")")
        return fields

    def _token(self, complaint: str) -> re.Match[str]:
        found = _TOKEN.match(self.text, self.position)
        if found is None:
            raise NotationError(complaint, self.position)
        self.position = found.end()
        return found


def _unescape(literal: str) -> str:
    return _ESCAPED.sub(_unescaped, literal[1:-1])


def _unescaped(found: re.Match[str]) -> str:
    wide, code, letter = found.groups()
    if wide or code:
        return chr(int(wide or code, 16))
    return _UNESCAPES.get(letter.upper(), letter)


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
    """The value at `path` is `value`; `DEFAULT`: the text has none there.

    `instead` is the value in the text, None if it has none. An edit of the text overrides the pragma: the change is
    made only as long as the text has that value.
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

    @property
    def field(self) -> str:
        """The name of the innermost field, in words."""
        return next(segment for segment in reversed(self.path) if isinstance(segment, str)).replace("_", " ")


# -- from the model to plain data -----------------------------------------------------------------------------------

_TAGS = ("kind", "language")
Substitute: TypeAlias = Callable[[BaseModel], Any]


def plain_fields(thing: BaseModel, substitute: Substitute | None = None, leave: frozenset[str] = frozenset()) -> Fields:
    """Return the fields of `thing` that are not at their default, those named in `leave` left out.

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
    """Of each field its name, True if it is always written, and its default."""
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
    read: Any, meant: Any, path: tuple[Segment, ...] = (), *, guarded: bool = False
) -> Iterator[RemainderEntry]:
    """Return the entries beside a text with the content `read` that give it the content `meant`.

    `guarded`: each change of fields and lists tells what they are in the text, too, not only one of a plain value. The
    reader must have all of the text before it makes the first change.
    """
    if guarded and isinstance(read, dict) and isinstance(meant, dict) and _differ_in_language_only(read, meant):
        yield RemainderEntry(path, meant, read)
    elif isinstance(read, dict) and isinstance(meant, dict) and (not path or (meant and _same_kind(read, meant))):
        for key in meant:
            if key in read:
                yield from changes(read[key], meant[key], (*path, key), guarded=guarded)
            else:
                yield from additions(meant[key], (*path, key))
        for key in read:
            if key not in meant:
                yield RemainderEntry((*path, key), DEFAULT, _instead(read[key], guarded))
    elif isinstance(read, list) and isinstance(meant, list) and len(read) > len(meant) and _starts_alike(meant, read):
        segments = _segments(read, [*meant, *read[len(meant) :]])
        for one, other, segment in zip(read, meant, segments, strict=False):
            yield from changes(one, other, (*path, segment), guarded=guarded)
        # from the last to the first, since each removal moves the items behind it
        for item, segment in reversed([*zip(read, segments, strict=True)][len(meant) :]):
            yield RemainderEntry((*path, segment), DEFAULT, _instead(item, guarded))
    elif isinstance(read, list) and isinstance(meant, list) and _starts_alike(read, meant):
        for one, other, segment in zip(read, meant, _segments(read, meant), strict=False):
            yield from changes(one, other, (*path, segment), guarded=guarded)
        for index, item in enumerate(meant[len(read) :], len(read)):
            yield from _appended(item, path, index)
    elif read != meant or type(read) is not type(meant):
        if isinstance(read, list) and isinstance(meant, list) and read and meant:
            # lists that begin otherwise have nothing to be matched by: one is emptied, and filled again
            yield RemainderEntry(path, [], _instead(read, guarded))
            yield from additions(meant, path)
        else:
            yield RemainderEntry(path, meant, _instead(read, guarded))


def _instead(read: Any, guarded: bool) -> Any:
    return read if guarded or not isinstance(read, dict | list) else None


def additions(meant: Any, path: tuple[Segment, ...]) -> Iterator[RemainderEntry]:
    """Yield the entries where the text has nothing: one line for each field and each item of a list."""
    if isinstance(meant, dict) and meant and not _is_map(meant):
        for key in meant:
            yield from additions(meant[key], (*path, key))
    elif isinstance(meant, list) and any(isinstance(item, dict | list) for item in meant):
        for index, item in enumerate(meant):
            yield from _appended(item, path, index)
    else:
        yield RemainderEntry(path, meant)


def _appended(item: Any, path: tuple[Segment, ...], index: int) -> Iterator[RemainderEntry]:
    """Yield a new item of a list; if it is long, its own lists on lines of their own."""
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


def _same_kind(read: Fields, meant: Fields) -> bool:
    """True if both have the same fields: the kind of a POU is one of them, other kinds tell which fields there are."""
    kinds = {read.get("kind"), meant.get("kind")}
    return len(kinds) == 1 or kinds <= _POU_KINDS


def _differ_in_language_only(read: Fields, meant: Fields) -> bool:
    """True for one text in two languages, as comments alone are: an edit of it may mean any of them."""
    languages = {read.get("language"), meant.get("language")}
    return len(languages) > 1 and "text" in meant and read.get("text") == meant["text"]


_POU_KINDS = frozenset(kind.value for kind in PouKind)


def _is_map(fields: Fields) -> bool:
    """True if these are many things of a kind by their names, which are better shown together."""
    return len(fields) > _MANY and all(isinstance(value, dict) for value in fields.values())


_MANY = 4


def _starts_alike(read: list[Any], meant: list[Any]) -> bool:
    """True if the items of `read` are those that `meant` begins with; in a list as long, some may have other names."""
    if not read or len(read) > len(meant) or any(type(o) is not type(t) for o, t in zip(read, meant, strict=False)):
        return False
    if not all(isinstance(item, dict) for item in read):
        return len(read) == len(meant)
    alike = sum(_is_alike(o, t) for o, t in zip(read, meant, strict=False))
    return alike == len(read) or (len(read) == len(meant) and 2 * alike >= len(read))


def _is_alike(read: Fields, meant: Fields) -> bool:
    """True if both are one object: of one name, or the same but for the name."""
    named = read.get("name") == meant.get("name") or {**read, "name": None} == {**meant, "name": None}
    return named and _same_kind(read, meant)


def _segments(read: list[Any], meant: list[Any]) -> list[Segment]:
    """Return how to point at each item: by its name, if it keeps that and is the only one of that name."""
    names = [_name(item) for item in read]
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
    """A change that was made for a text that has been edited since."""


def apply(fields: Fields, change: RemainderEntry) -> None:
    """Make `change` in `fields`. Raises `StaleError` where the text has been edited, and `PathError`."""
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
    elif change.value is DEFAULT:
        index = _index(holder, last)
        if change.instead is not None and holder[index] != change.instead:
            raise StaleError(f"the text says {format_value(holder[index])} now")
        del holder[index]
    else:
        holder[_index(holder, last)] = change.value


def value_at(fields: Fields, path: tuple[Segment, ...]) -> Any:
    """Return the value at `path`; None where nothing is there."""
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
        found: Iterator[int] = iter(())
        if isinstance(segment, Named):
            name = segment.name.casefold()
            found = (i for i, each in enumerate(items) if isinstance(each, dict) and _name_of(each) == name)
        elif isinstance(segment, Numbered):
            number = segment.id
            found = (i for i, each in enumerate(items) if isinstance(each, dict) and each.get("id") == number)
        elif isinstance(segment, int) and not isinstance(segment, bool) and 0 <= segment < len(items):
            return segment
        for index in found:
            return index
    raise PathError(f"there is no {format_path((segment,))} here")


def _name_of(item: Mapping[str, Any]) -> str:
    return str(item.get("name", "")).casefold()


# -- paths as text ----------------------------------------------------------------------------------------------------


def format_path(path: tuple[Segment, ...]) -> str:
    """``supervision.condition``, ``variables[Start].comment``, ``symbols[]``, ``steps[#4].extension_data``."""
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
    """Return the change in ``path := value``; ``path`` alone means TRUE. Raises `NotationError`."""
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
