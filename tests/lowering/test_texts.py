"""What lowered code says is there in each language."""

from __future__ import annotations

import ast
import inspect
from collections import Counter

import pytest

from plcopen_sfc.lowering.texts import TEXTS, GermanTexts, Texts

SAME = {"flag_name", "time_name", "transition_name", "delay_name", "transition_title", "waiting_constant"}
"""What is the same in all languages."""


def test_german_has_words_of_its_own_for_everything() -> None:
    missing = [name for name in vars(Texts) if not name.startswith("_") and name not in vars(GermanTexts)]
    assert set(missing) <= SAME


@pytest.mark.parametrize("language", TEXTS)
def test_texts_are_one_line_and_not_empty(language: str) -> None:
    texts = TEXTS[language]
    for name, text in inspect.getmembers(texts, lambda value: isinstance(value, str)):
        if not name.startswith("_") and name != "culture":
            assert text.strip() == text, name
            assert text, name
            assert "\n" not in text, name


@pytest.mark.parametrize("language", TEXTS)
def test_nothing_is_said_twice_under_one_name(language: str) -> None:
    tree = ast.parse(inspect.getsource(type(TEXTS[language])))
    body = tree.body[0].body if isinstance(tree.body[0], ast.ClassDef) else []
    names = [
        target.id
        for each in body
        if isinstance(each, ast.Assign)
        for target in each.targets
        if isinstance(target, ast.Name)
    ]
    names += [each.name for each in body if isinstance(each, ast.FunctionDef)]
    assert [name for name, count in Counter(names).items() if count > 1] == []
