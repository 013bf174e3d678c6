"""German for messages with values in them, by a table of English ones.

In a message of a table ``{}`` is the place of a text that is shown as it is, such as a name, ``{+}`` for something that
is German too, ``{|}`` for several of these with commas and "or" between them, ``{&}`` for names with "and" between
them or "and 2 more" behind them, ``{#}`` for a number, and ``{.}`` for a text without blanks. In the German text ``{}``
or ``{0}`` are their places.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache, cached_property
from importlib import resources


class Phrases:
    """German for the messages of a table. `part` translates the text at ``{+}``; the table itself as a rule."""

    def __init__(self, table: Mapping[str, str], part: Callable[[str], str]) -> None:
        self._table = table
        self._part = part

    def __call__(self, message: str) -> str:
        """Return a message in German; itself where the table does not have it."""
        return self.find(message) or message

    def find(self, message: str) -> str | None:
        """Return a message in German; None where the table does not have it."""
        if message in self._table:
            return self._table[message]
        first: str | None = None
        for pattern, places, text in self._patterns:
            if found := pattern.fullmatch(message):
                told = text.format(*map(self._value, found.groups(), places))
                if _are_names(found, places):
                    return told
                first = first or told
        return first

    def _value(self, text: str, place: str) -> str:
        if place == "{+}":
            return self._part(text)
        if place == "{#}":
            return _THOUSANDS.sub(".", text)
        if place == "{|}":
            return " oder ".join(", ".join(map(self._part, part.split(", "))) for part in text.split(" or "))
        return _MORE.sub(r" und \1 weitere", text).replace(" and ", " und ") if place == "{&}" else text

    @cached_property
    def _patterns(self) -> list[tuple[re.Pattern[str], list[str], str]]:
        """The messages with values in them: how to recognise each, its places, its German text.

        Those with the most words of their own are first: ``{+}: {+}`` would take what belongs to others.
        """
        messages = [message for message in self._table if _PLACES.search(message)]
        messages.sort(key=lambda each: -len(_PLACES.sub("", each)))
        return [self._read_pattern(message) for message in messages]

    def _read_pattern(self, message: str) -> tuple[re.Pattern[str], list[str], str]:
        places = _PLACES.findall(message)
        first, *others = map(re.escape, _PLACES.split(message))
        values = [_VALUES.get(place, "(.+?)") for place in places]
        pattern = first + "".join(f"{value}{own}" for value, own in zip(values, others, strict=True))
        return re.compile(pattern, re.DOTALL), places, self._table[message]


def _are_names(found: re.Match[str], places: Sequence[str]) -> bool:
    """True if what is shown as it is can be names.

    What ends as one message does may be the reason in another, ``condition {} cannot be read: {+}``, and what begins as
    one does may go on: ``{+}; S7-GRAPH executes it after that``.
    """
    values = [value for value, place in zip(found.groups(), places, strict=True) if place == "{}"]
    is_sentence = found.start(1) == 0 and places[0] == "{}" and ": " in found[1]
    return not is_sentence and not any("; " in value for value in values)


@cache
def german_tables(name: str) -> Mapping[str, Mapping[str, str]]:
    """Return the tables in ``german/<name>.json``, by their titles."""
    file = resources.files("plcopen_sfc.pages").joinpath("german", f"{name}.json")
    tables: Mapping[str, Mapping[str, str]] = json.loads(file.read_text(encoding="utf-8"))
    return tables


def german_table(name: str) -> Mapping[str, str]:
    """Return all tables in ``german/<name>.json`` as one."""
    return {english: german for table in german_tables(name).values() for english, german in table.items()}


def german_label(text: str) -> str:
    """Return a text in which the labels of transitions that lead nowhere, or come from nowhere, are German."""
    return _FROM_NOWHERE.sub("nirgends -> ", _TO_NOWHERE.sub(" -> nirgendwohin", text))


_FROM_NOWHERE, _TO_NOWHERE = re.compile(r"\bnowhere -> "), re.compile(r" -> nowhere\b")
_PLACES = re.compile(r"\{[+|&#.]?\}")
_MORE = re.compile(r" and (\d+) more$")
_THOUSANDS = re.compile(r"(?<=\d),(?=\d{3}\b)")
_VALUES = {"{#}": r"(\d[\d,.]*)", "{.}": r"(\S+)"}
