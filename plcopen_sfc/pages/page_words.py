"""The words of pages in English and German, and the German of what reports, findings, runs and verdicts tell.

What comes from the project is shown as it is there. ``german/words.json`` has the words of pages, the other files there
have the messages by the English ones, with places as `plcopen_sfc.pages.phrases` has them. A message that is not there
stays English. Tools are in the dative, as German puts them after `in` and `von`; in ``words.json`` in the nominative.
"""

from __future__ import annotations

import re
from functools import lru_cache

from plcopen_sfc.errors import ModelError, check_argument, nearest
from plcopen_sfc.pages.phrases import Phrases, german_label, german_table, german_tables
from plcopen_sfc.pages.verdict_words import Verdicts

_WORDS = german_table("words")
_KINDS = german_tables("reports")["kinds of things"]
_LINE = re.compile(r"line (\d+): ")
"""Beginnings of messages about program text of several lines."""
_PLACE = re.compile(r"(?:line ([\d:]+) \((.+)\)|\w+(?:\.\w+)* / .+)")
"""Places that are before the reason for the end of a run: ``Band / transition S1 -> S2``, ``line 2 (Main)``."""
_NAME = re.compile(r"\w+(?:\.\w+)*")
_RUN = ("it does something else after ", "it is not known to do the same")
"""Beginnings of what a run of both sides has shown."""


class Words:
    """The words of one language: ``en`` or ``de``. Raises `ModelError` for another."""

    def __init__(self, lang: str) -> None:
        check_argument(lang, str, "the language of a page is a text")
        if lang not in ("en", "de"):
            raise ModelError(f"pages have no language {lang!r}{nearest(lang, ('en', 'de'))}", hint="There are: en, de")
        self.lang = lang

    def __call__(self, english: str, *values: object) -> str:
        """Return the words, with `values` in their places."""
        text = _WORDS.get(english) or german(english) if self.lang == "de" else english
        return text.format(*values) if values else text

    def heading(self, english: str) -> str:
        """Return words that begin with a capital letter."""
        text = self(english)
        return text[:1].upper() + text[1:]

    def message(self, english: str) -> str:
        """Return a message of a report, a finding or its hint, or why a run ended; English where it is not known."""
        return german(english) if self.lang == "de" else english

    def verdict(self, english: str) -> str:
        """Return a line of a verdict, or why something was not reached; English where no translation is known."""
        return german_verdict(english) if self.lang == "de" else english

    def place(self, path: str) -> str:
        """Return a path of a report: names as they are, the kinds of things in the language of the page."""
        return german_place(path) if self.lang == "de" else path

    def label(self, label: str) -> str:
        """Return the label of a transition, which may lead nowhere; other names as they are."""
        return german_label(label) if self.lang == "de" else label


def german_place(path: str) -> str:
    """Return a path of a report with the kinds of things in German: ``POU Main / Schritt Fill``."""
    return " / ".join(map(_german_part, path.split(" / ")))


def _german_part(part: str) -> str:
    words = part.split(" ")
    for end in range(len(words), 0, -1):
        kind = " ".join(words[:end])
        if kind in _KINDS:
            name = " ".join(words[end:])
            return f"{_KINDS[kind]} {german_label(name) if kind == 'transition' else name}".rstrip()
    return part


@lru_cache(maxsize=4096)
def german(message: str) -> str:
    """Return a message in German, where a place or a line may be before it; itself where no table has it."""
    if message in _TABLE:
        return _TABLE[message]
    if message.startswith(_RUN):
        return german_verdict(message)
    if line := _LINE.match(message):
        return f"Zeile {line[1]}: {german(message[line.end() :])}"
    place, _, reason = message.partition(": ")
    told = german(reason) if reason else ""
    if (at := _PLACE.fullmatch(place)) and told != reason:
        path = german_place(at[2] or place)
        return f"Zeile {at[1]} ({path}): {told}" if at[1] else f"{path}: {told}"
    named = f"{place}: {told}" if _NAME.fullmatch(place) and reason else message
    return german_label(_PHRASES.find(message) or named)


_TABLE = {
    english: told for name in ("runs", "verdicts", "rules", "reports") for english, told in german_table(name).items()
}
_PHRASES = Phrases(_TABLE, german)
german_verdict = Verdicts(german, _PHRASES)
"""Return a line of a verdict in German, or why something was not reached; English stays what is not known."""
