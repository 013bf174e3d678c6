"""What a chart says to people: titles, comments, and those inside of its texts; and whether its code says it too."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.model.actions import ActionAssociation
from plcopen_sfc.model.base import Carried, Model
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.network import Block, NodeBase
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcNetwork, SfcSettings, Step
from plcopen_sfc.model.text import MarkupText, MultilingualText, Text

_TEXTS = ("title", "comment", "content", "alternative_text", "alarm")
_MARKS = re.compile(r"^\s*//+|\(\*+|\*+\)|/\*+|\*+/", re.MULTILINE)


class Remark(NamedTuple):
    """A text for people, and the path of what it is about."""

    path: str
    text: Text


def remarks(thing: Any, path: str, dialect: Dialect | None) -> Iterator[Remark]:
    """All texts for people in a part of the model, in the order in which it has them.

    Without a `dialect` structured text is given as a whole, else what its comments say.
    """
    if isinstance(thing, list | tuple):
        for each in thing:
            yield from remarks(each, path, dialect)
    if not isinstance(thing, Model) or isinstance(thing, Carried | SfcSettings):
        return
    if isinstance(thing, Block) and thing.code is not None:
        yield from _inside(thing.code, path, dialect)
    if isinstance(thing, NodeBase):  # there are many, and nothing in their pins is for people
        found = (getattr(thing, name, None) for name in _TEXTS)
        yield from (Remark(path, text) for text in found if text is not None)
        return
    if isinstance(thing, Step):
        path = f"{path} / step {thing.name}"
    elif isinstance(thing, ActionAssociation) and thing.target is not None:
        path = f"{path} / action {thing.target}"
    for name, value in thing:
        if name in _TEXTS and isinstance(value, str | MarkupText | MultilingualText):
            yield Remark(path, value)
        elif isinstance(thing, SfcNetwork) and name == "transitions":
            labels = thing.labels()
            for transition in thing.transitions:
                yield from remarks(transition, f"{path} / transition {labels[transition.id]}", dialect)
        elif isinstance(value, Model | list):
            yield from remarks(value, path, dialect)
    if isinstance(thing, StBody | Expression):
        yield from _inside(thing.text, path, dialect)


def _inside(text: str, path: str, dialect: Dialect | None) -> Iterator[Remark]:
    if dialect is None:
        yield Remark(path, text)
    else:
        yield from (Remark(path, comment.text) for comment in tokenize(text, dialect).comments)


def texts_of(text: Text) -> dict[str, str]:
    """What a text says, by language; in none where it does not say in which, and nothing where it is empty."""
    if isinstance(text, MultilingualText):
        return {language: each for language, each in text.texts.items() if _bare(each)}
    only = text.text if isinstance(text, MarkupText) else text
    return {"": only} if _bare(only) else {}


class Said:
    """All that the code of some POUs says to people."""

    def __init__(self, pous: Iterable[Pou]) -> None:
        found = [remark.text for pou in pous for remark in remarks(pou, "", None)]
        texts = [each for text in found for each in texts_of(text).values()]
        self._lines = frozenset(_bare(line) for text in texts for line in text.splitlines())
        self._all = _bare(" ".join(texts))

    def has(self, text: str) -> bool:
        """Whether all lines of a text stand somewhere in it, as words of their own."""
        return all(line in self._lines or self._contains(line) for line in map(_bare, text.splitlines()))

    def _contains(self, line: str) -> bool:
        return re.search(rf"(?<!\w){re.escape(line)}(?!\w)", self._all) is not None


def _bare(text: str) -> str:
    """A text without the marks of comments, its words divided by one space each."""
    return " ".join(_MARKS.sub(" ", text).split())
