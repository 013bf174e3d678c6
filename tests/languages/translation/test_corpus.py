"""All structured text of the corpus in the other dialects."""

from __future__ import annotations

from collections import Counter

import pytest

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.translation import Translated, TranslationContext, translate, translate_text
from plcopen_sfc.model.dialect import Dialect
from tests.corpus import require_corpus
from tests.languages.st_corpus import CorpusText, TextKind, corpus_texts, distinct
from tests.sweeps import WHOLE, in_turn

# What stays and does not parse in the target: references of CODESYS, jumps in IEC 61131-3.
LEFT_AS_THEY_STAND = {
    (Dialect.TWINCAT, Dialect.IEC): 1,
    (Dialect.TWINCAT, Dialect.SCL): 1,
    (Dialect.SCL, Dialect.IEC): 1,
}


def _texts() -> list[CorpusText]:
    require_corpus()
    return distinct(text for text in corpus_texts() if text.kind in (TextKind.STATEMENTS, TextKind.EXPRESSION))


def _translated(text: CorpusText, target: Dialect, context: TranslationContext) -> Translated:
    return translate_text(
        text.text, "statements" if text.kind is TextKind.STATEMENTS else "expression", text.dialect, target, context
    )


def _comments(text: str, dialect: Dialect) -> list[str]:
    found = [comment.text for comment in tokenize(text, dialect).comments]
    return sorted(comment for comment in found if comment[0] != "{" and not comment.startswith("(*pragma"))


@pytest.mark.corpus
@pytest.mark.slow
def test_the_corpus_in_every_dialect() -> None:
    unread: Counter[tuple[Dialect, Dialect]] = Counter()
    for text in _texts():
        for target in Dialect:
            found = _translated(text, target, TranslationContext(locals=[]))
            if found.parsed.problems:
                assert any(note.severity is Severity.ERROR for note in found.notes), text
                if not any("cannot be read" in note.reason for note in found.notes):
                    unread[text.dialect, target] += 1
            elif "REGION" not in text.text.upper():
                assert _comments(found.text, target) == _comments(text.text, text.dialect), text
    assert unread == LEFT_AS_THEY_STAND


@pytest.mark.corpus
@pytest.mark.slow
def test_what_is_exact_comes_back() -> None:
    """From names that are all plain; quotes that SCL did not need are not put back."""
    back = Counter[bool]()
    dialects = list(Dialect)
    for number, text in enumerate(_texts()):
        if text.dialect is Dialect.SCL:
            continue
        for target in in_turn(dialects, number, 2):
            context = TranslationContext(locals=[])
            found = _translated(text, target, context)
            if found.exact and not found.parsed.problems:
                again = translate(found.parsed, text.dialect, context)
                back[again.text == text.text] += 1
    assert back[True] > (3000 if WHOLE else 1000)
    # arguments by name and semicolons behind END_IF, which SCL needs, stay; parameters without a value
    assert back[False] < 100
