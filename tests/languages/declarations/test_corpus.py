"""All declarations of the corpus."""

from __future__ import annotations

import pytest

from plcopen_sfc.languages.declarations import read_declarations, write_data_type, write_section
from tests.corpus import require_corpus
from tests.languages.st_corpus import TextKind, corpus_texts, distinct

pytestmark = pytest.mark.corpus


@pytest.mark.slow
def test_every_declaration_parses_and_comes_back() -> None:
    require_corpus()
    texts = distinct(text for text in corpus_texts() if text.kind is TextKind.DECLARATIONS)
    assert len(texts) >= 165
    variables = 0
    for text in texts:
        declared = read_declarations(text.text, text.dialect)
        assert declared.problems == (), str(text)
        for section in declared.sections:
            variables += len(section.variables)
            again = read_declarations(write_section(section, text.dialect), text.dialect)
            assert again.sections == [section], str(text)
        for declaration in declared.types:
            again = read_declarations(write_data_type(declaration, text.dialect), text.dialect)
            assert again.types == [declaration], str(text)
    assert variables > 1000
