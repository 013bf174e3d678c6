"""The words of pages in English and German. What comes from the project is shown as it is there."""

from __future__ import annotations

from plcopen_sfc.errors import ModelError, check_argument, nearest
from plcopen_sfc.pages.phrases import german_label, german_table
from plcopen_sfc.pages.report_words import GERMAN, german, german_failure, german_finding, german_place, german_verdict

_WORDS = german_table("words")


class Words:
    """The words of one language: ``en`` or ``de``. Raises `ModelError` for another."""

    def __init__(self, lang: str) -> None:
        check_argument(lang, str, "the language of a page is a text")
        if lang not in ("en", "de"):
            raise ModelError(f"pages have no language {lang!r}{nearest(lang, ('en', 'de'))}", hint="There are: en, de")
        self.lang = lang

    def __call__(self, english: str, *values: object) -> str:
        """Return the words, with `values` in their places."""
        text = (_WORDS.get(english) or GERMAN[english]) if self.lang == "de" and english else english
        return text.format(*values) if values else text

    def heading(self, english: str) -> str:
        """Return words that begin with a capital letter."""
        text = self(english)
        return text[:1].upper() + text[1:]

    def message(self, english: str) -> str:
        """Return a message of a report; English where no translation of it is known."""
        return german(english) if self.lang == "de" else english

    def tool(self, english: str) -> str:
        """Return a tool in a heading, which messages of a report have in another case of German."""
        return _WORDS.get(english) or german(english) if self.lang == "de" else english

    def verdict(self, english: str) -> str:
        """Return a line of a verdict, or why something was not reached; English where no translation is known."""
        return german_verdict(english) if self.lang == "de" else english

    def failure(self, english: str) -> str:
        """Return why a run ended with an error; English where no translation of it is known."""
        return german_failure(english) if self.lang == "de" else english

    def place(self, path: str) -> str:
        """Return a path of a report: names as they are, the kinds of things in the language of the page."""
        return german_place(path) if self.lang == "de" else path

    def label(self, label: str) -> str:
        """Return the label of a transition, which may lead nowhere; other names as they are."""
        return german_label(label) if self.lang == "de" else label

    def finding(self, english: str) -> str:
        """Return the message or the hint of a finding; English where no translation of it is known."""
        return german_finding(english) if self.lang == "de" else english
