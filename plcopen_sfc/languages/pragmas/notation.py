"""The notation of values in pragmas: literals of IEC 61131-3, ``(key := value)`` and ``[value, value]``.

No brace and no comment mark ever stands in it, so that every tool finds the end of the pragma:
``{plcopen_sfc supervision := (alarm := 'too hot', condition := (kind := 'expression', text := 'x > 3'))}``.
"""

from __future__ import annotations

import re
from typing import Any, Final


class Default:
    """The value of a field that a text does not state."""

    def __repr__(self) -> str:
        return "DEFAULT"


DEFAULT: Final = Default()
"""The value ``DEFAULT``: the field has its default, whatever the text beside the pragma says."""


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
    """A key: a plain word where it is read as one (``nan`` is a number), or a string."""
    found = _TOKEN.fullmatch(key)
    return key if found is not None and found.group("word") == key else format_string(key)


_TOKEN = re.compile(
    r"\s*(?:(?P<string>'(?:\$.|[^$'])*')|(?P<number>[-+]?(?:\d[\d.]*(?:[eE][-+]?\d+)?|inf|nan)\b)"
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
        """The mark that comes next, or an empty text. Does not move."""
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
        if not (found.group("number") or "").isdecimal():
            raise NotationError("a number is expected here", found.start())
        return int(found.group("number"))

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
