"""Translations as the tests of them ask for: a text, two dialects, and what is known of the names."""

from __future__ import annotations

from typing import Any

from plcopen_sfc.languages.translation import Translated, TranslationContext, translate_text
from plcopen_sfc.model.dialect import Dialect


def translated(text: str, source: Dialect, target: Dialect, **known: Any) -> Translated:
    return translate_text(
        text, "statements" if ";" in text else "expression", source, target, TranslationContext(**known)
    )


def assert_says_the_same(text: str, source: Dialect, target: Dialect, expected: str, **known: Any) -> None:
    found = translated(text, source, target, **known)
    assert found.text == expected
    assert found.notes == ()
    assert found.parsed.problems == ()
    assert found.parsed.text == expected
    assert found.parsed.dialect is target
