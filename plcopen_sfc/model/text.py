"""Texts for people: comments and titles."""

from __future__ import annotations

from plcopen_sfc.model.checked import Checked


class MarkupText(Checked):
    """A text with markup (XHTML in PLCopen XML). `text` is what a person reads, `markup` how the file writes it."""

    text: str
    markup: str


class MultilingualText(Checked):
    """A text in several languages: `texts` maps a language tag (``de-DE``) to the text in it."""

    texts: dict[str, str]


Text = str | MarkupText | MultilingualText
"""A comment or title: plain, with markup, or in several languages."""


def plain(text: Text | None, language: str = "") -> str:
    """Return the words of `text`; of a multilingual one that in `language` (``de-DE``, ``de``), else the first."""
    if text is None:
        return ""
    if isinstance(text, str):
        return text
    if isinstance(text, MarkupText):
        return text.text
    spoken = language.partition("-")[0]
    others = (caption for tag, caption in text.texts.items() if caption and tag.partition("-")[0] == spoken)
    return text.texts.get(language) or next(others, "") or next(iter(text.texts.values()), "")


def is_direct(markup: str | None) -> bool:
    """True if the `markup` of program text is that text itself, without an element: old versions of Beremiz."""
    return bool(markup) and "<" not in str(markup)


def without_signs(name: str) -> str:
    """Return any name as other tools than TIA Portal write it: without ``#`` and quotes."""
    return name.removeprefix("#").strip('"')


def local_name(name: str) -> str:
    """Return the name of something that a POU declares without the signs of S7: ``#Count``, ``#"Fill valve"``."""
    return name[1:].strip('"') if name.startswith("#") else name
