"""Between the characters of a value and the characters that a file writes for it.

`raw` is the text in the file (`a &lt; b`, CRLF), `value` is what a parser reports (`a < b`, LF). A small change of a
value shall change only a few characters of the raw text and leave every other reference as its author wrote it, so
`RawText` remembers which raw characters mean which characters of the value.
"""

from __future__ import annotations

import re
from bisect import bisect_right

from plcopen_sfc.errors import EncodingError, Location

_NAMED = {"lt": "<", "gt": ">", "amp": "&", "quot": '"', "apos": "'"}
_TEXT_UNIT = re.compile(r"&([^;&\s]+);|\r\n?")
_ATTRIBUTE_UNIT = re.compile(r"&([^;&\s]+);|\r\n|[\r\n\t]")


def _meaning(raw: str, reference: str | None, *, attribute: bool) -> str:
    if reference is None:
        return " " if attribute else "\n"
    if reference.startswith("#x"):
        return chr(int(reference[2:], 16))
    if reference.startswith("#"):
        return chr(int(reference[1:]))
    return _NAMED.get(reference, raw)


class RawText:
    """A stretch of raw text (of an attribute value, or between tags, or inside CDATA) and its value."""

    def __init__(self, raw: str, *, attribute: bool = False, cdata: bool = False) -> None:
        unit = _ATTRIBUTE_UNIT if attribute else _TEXT_UNIT
        pieces: list[str] = []
        # Only places where raw and value run apart are noted: (value position, raw position) after each of them.
        self._values, self._raws = [0], [0]
        value_length = raw_position = 0
        for found in unit.finditer(raw):
            if cdata and found[1] is not None:
                continue
            plain = raw[raw_position : found.start()]
            meaning = _meaning(found[0], found[1], attribute=attribute)
            if plain:
                self._note(value_length, raw_position)
            self._note(value_length + len(plain), found.start())
            value_length += len(plain) + len(meaning)
            self._note(value_length, found.end())
            pieces += (plain, meaning)
            raw_position = found.end()
        pieces.append(raw[raw_position:])
        self.raw = raw
        self.value = "".join(pieces)

    def _note(self, value: int, raw: int) -> None:
        if self._values[-1] != value:
            self._values.append(value)
            self._raws.append(raw)

    def raw_position(self, position: int) -> int:
        """Return the start in the raw text of the character at `position` of the value."""
        index = bisect_right(self._values, position) - 1
        return self._raws[index] + position - self._values[index]


class Habits:
    """Characters that the author of a raw text escapes without need, seen from the text itself."""

    def __init__(self, raw: str, *, newline: str) -> None:
        self.newline = newline
        self.quot = "&quot;" in raw and '"' not in raw
        self.apos = "&apos;" in raw and "'" not in raw
        self.greater = "&gt;" in raw or ">" not in raw


def escape_text(value: str, habits: Habits) -> str:
    """Return `value` as text between tags."""
    # A parser reads CR as LF: only a reference keeps it. Of ">" XML forbids nothing but "]]>".
    raw = value.replace("&", "&amp;").replace("<", "&lt;").replace("\r", "&#13;")
    raw = raw.replace(">", "&gt;") if habits.greater else raw.replace("]]>", "]]&gt;")
    if habits.quot:
        raw = raw.replace('"', "&quot;")
    if habits.apos:
        raw = raw.replace("'", "&apos;")
    return raw.replace("\n", habits.newline) if habits.newline != "\n" else raw


def escape_attribute(value: str, quote: str, habits: Habits) -> str:
    """Return `value` as an attribute value between two `quote` characters."""
    raw = value.replace("&", "&amp;").replace("<", "&lt;")
    if habits.greater:
        raw = raw.replace(">", "&gt;")
    if habits.quot or quote == '"':
        raw = raw.replace('"', "&quot;")
    if habits.apos or quote == "'":
        raw = raw.replace("'", "&apos;")
    return raw.replace("\r", "&#13;").replace("\n", "&#10;").replace("\t", "&#9;")


_MARKUP = re.compile(
    r"""(?P<cdata><!\[CDATA\[.*?\]\]>)|<!--.*?-->|<\?.*?\?>|(?P<tag><[^>"']*+(?:"[^"]*"[^>"']*+|'[^']*'[^>"']*+)*+>)""",
    re.DOTALL,
)
_VALUE = re.compile(r"""("[^"]*"|'[^']*')""")


def encode_text(text: str, codec: str) -> bytes:
    """Return the XML document `text` in `codec`; characters that it lacks become character references.

    Raises `EncodingError` where XML has no references: in names, comments and processing instructions.
    """
    try:
        return text.encode(codec)
    except UnicodeEncodeError:
        pass
    parts: list[bytes] = []
    done = 0
    for token in _MARKUP.finditer(text):
        parts.append(text[done : token.start()].encode(codec, "xmlcharrefreplace"))
        raw = token[0]
        if token["cdata"] is not None:
            raw = re.sub(r"[^\x00-\x7f]", lambda found: _outside_cdata(found[0], codec), raw)
        pieces = _VALUE.split(raw) if token["tag"] is not None else [raw]
        pieces[1::2] = [value.encode(codec, "xmlcharrefreplace").decode(codec) for value in pieces[1::2]]
        try:
            parts.append("".join(pieces).encode(codec))
        except UnicodeEncodeError as error:
            position = token.start() + raw.index(error.object[error.start])
            raise _cannot_encode(text, position, codec) from error
        done = token.end()
    parts.append(text[done:].encode(codec, "xmlcharrefreplace"))
    return b"".join(parts)


def _outside_cdata(character: str, codec: str) -> str:
    try:
        character.encode(codec)
    except UnicodeEncodeError:
        return f"]]>&#{ord(character)};<![CDATA["
    return character


def _cannot_encode(text: str, position: int, codec: str) -> EncodingError:
    return EncodingError(
        f"{text[position]!r} in a name, comment or instruction cannot be written in {codec}",
        location=Location(None, text.count("\n", 0, position) + 1, position - text.rfind("\n", 0, position)),
        hint="Write the file as UTF-8, or use another name.",
    )
