"""All structured text of the corpus: it parses, covers its text, prints and survives edits; what does not is listed."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from plcopen_sfc.languages.st import (
    Parsed,
    parse_condition,
    parse_declarations,
    parse_expression,
    parse_statements,
    print_node,
    render,
    transform,
    walk,
)
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.model.dialect import Dialect
from tests.corpus import require_corpus
from tests.languages.st_corpus import CorpusText, TextKind, corpus_texts, distinct
from tests.languages.st_invariants import assert_tree_fits

pytestmark = pytest.mark.corpus

WRONG: dict[str, str] = {
    "7819f63bee": "10s: a duration that is no literal of IEC 61131-3; it must begin with T#",
    "d3f0b03bdf": "10ms: the interval of a task, likewise",
    "f353d55ecc": "00:00:00.100000: the interval of a task in the notation of XML Schema for times of day",
    "fc41d49f7d": "2s/X202: a generator has copied a time operator of GRAFCET into structured text",
    "2b00c35321": "an assignment as the condition of a transition (Rockwell)",
}
"""Texts that do not parse and why that is right, by the start of their digest (`key`)."""

SHARE = 0.99

PARSERS: dict[TextKind, Callable[[str, Dialect], Parsed[Any]]] = {
    TextKind.STATEMENTS: parse_statements,
    TextKind.EXPRESSION: parse_expression,
    TextKind.CONDITION: parse_condition,
    TextKind.DECLARATIONS: parse_declarations,
}


def key(text: CorpusText) -> str:
    return hashlib.sha256(text.text.encode("utf-8", "surrogatepass")).hexdigest()[:10]


@pytest.fixture(scope="module")
def texts() -> list[CorpusText]:
    require_corpus()
    return [each for each in corpus_texts() if each.kind in PARSERS]


@pytest.fixture(scope="module")
def parsed(texts: list[CorpusText]) -> list[tuple[CorpusText, Parsed[Any]]]:
    return [(each, PARSERS[each.kind](each.text, each.dialect)) for each in distinct(texts)]


Parses = list[tuple[CorpusText, Parsed[Any]]]


def right(parsed: Parses) -> Parses:
    return [(text, result) for text, result in parsed if not result.problems]


@pytest.mark.slow
def test_there_is_a_corpus(texts: list[CorpusText]) -> None:
    found = Counter((each.kind, each.dialect) for each in texts)
    assert found[TextKind.STATEMENTS, Dialect.CODESYS] > 600
    assert found[TextKind.STATEMENTS, Dialect.TWINCAT] > 100
    assert found[TextKind.STATEMENTS, Dialect.IEC] > 100
    assert found[TextKind.STATEMENTS, Dialect.SCL] > 40
    assert found[TextKind.EXPRESSION, Dialect.CODESYS] > 1500
    assert found[TextKind.CONDITION, Dialect.CODESYS] > 1000
    assert found[TextKind.DECLARATIONS, Dialect.CODESYS] > 150
    assert len(distinct(texts)) > 2000


@pytest.mark.slow
def test_every_text_parses_but_the_listed_ones(parsed: Parses) -> None:
    failed = {key(text): f"{text}: {result.problems[0].message}" for text, result in parsed if result.problems}
    unexpected = {name: why for name, why in failed.items() if name not in WRONG}
    assert not unexpected, "\n".join(f"{name}: {why}" for name, why in unexpected.items())
    assert not WRONG.keys() - failed.keys(), "these parse now, or are gone: take them out of the list"


@pytest.mark.parametrize("kind", PARSERS)
def test_of_each_kind_nearly_all_parse(parsed: Parses, texts: list[CorpusText], kind: TextKind) -> None:
    of_kind = [result for text, result in parsed if text.kind is kind]
    assert sum(not result.problems for result in of_kind) / len(of_kind) >= SHARE
    wrong = {(text.text, text.dialect) for text, result in parsed if text.kind is kind and result.problems}
    all_of_kind = [each for each in texts if each.kind is kind]
    assert sum((each.text, each.dialect) not in wrong for each in all_of_kind) / len(all_of_kind) >= SHARE


def test_trees_cover_their_texts(parsed: Parses) -> None:
    for text, result in parsed:
        try:
            assert_tree_fits(result)
        except AssertionError as error:
            raise AssertionError(str(text)) from error


def test_tokens_and_comments_are_all_of_the_text(parsed: Parses) -> None:
    for text, _ in parsed:
        found = tokenize(text.text, text.dialect)
        spans = sorted([token.span for token in found.tokens] + [comment.span for comment in found.comments])
        end = 0
        for start, stop in [*spans, (len(text.text), len(text.text))]:
            assert not text.text[end:start].replace("\ufeff", "").strip(), text
            end = stop


@pytest.mark.slow
def test_printed_trees_say_the_same(parsed: Parses) -> None:
    for text, result in right(parsed):
        if text.kind is TextKind.DECLARATIONS:
            continue  # they have no printer
        again = PARSERS[text.kind](print_node(result.tree), text.dialect)
        assert again.problems == (), f"{text}: {again.text}"
        assert again.tree == result.tree, f"{text}: {again.text}"


@pytest.mark.slow
def test_renamed_names_change_and_nothing_else(parsed: Parses) -> None:
    for text, result in right(parsed):
        names = [node for node in walk(result.tree) if isinstance(node, n.Name) and not node.identifier.startswith("%")]
        if not names:
            continue
        old = Counter(name.identifier for name in names).most_common(1)[0][0]
        if old.isdigit():
            continue
        spans = sorted(name.span or (0, 0) for name in names if name.identifier == old)
        expected, end = "", 0
        for start, stop in spans:
            expected += text.text[end:start] + text.text[start:stop].replace(old, "Renamed_1")
            end = stop
        changed = transform(
            result.tree,
            lambda node, old=old: (  # type: ignore[misc]  # mypy infers no lambda with a default
                replace(node, identifier="Renamed_1") if isinstance(node, n.Name) and node.identifier == old else node
            ),
        )
        assert render(result, changed) == expected + text.text[end:], text


@pytest.mark.slow
def test_every_statement_can_go_and_the_rest_stays(parsed: Parses) -> None:
    for text, result in right(parsed):
        if text.kind is not TextKind.STATEMENTS:
            continue
        body = result.tree.statements
        for index in {0, len(body) // 2, len(body) - 1} if body else ():
            left = n.Statements((*body[:index], *body[index + 1 :]))
            written = parse_statements(render(result, left), text.dialect)
            assert written.problems == (), text
            assert written.tree == left, text
