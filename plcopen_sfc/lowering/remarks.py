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
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcNetwork, SfcSettings, Step, Transition
from plcopen_sfc.model.text import MarkupText, MultilingualText, Text

_TEXTS = ("title", "comment", "content", "alternative_text", "alarm")
_MARKS = re.compile(r"^\s*//+|\(\*+|\*+\)|/\*+|\*+/", re.MULTILINE)


class Remark(NamedTuple):
    """A text for people, and the path of what it is about."""

    path: str
    text: Text


def remarks(thing: Any, path: str, dialect: Dialect) -> Iterator[Remark]:
    """All texts for people in a part of the model, in the order in which it has them."""
    if isinstance(thing, list | tuple):
        for each in thing:
            yield from remarks(each, path, dialect)
    if not isinstance(thing, Model) or isinstance(thing, Carried | SfcSettings):
        return
    if isinstance(thing, Step):
        path = f"{path} / step {thing.name}"
    elif isinstance(thing, ActionAssociation) and thing.target is not None:
        path = f"{path} / action {thing.target}"
    for name, value in thing:
        if name in _TEXTS and isinstance(value, str | MarkupText | MultilingualText):
            yield Remark(path, value)
        elif isinstance(thing, SfcNetwork) and name == "transitions":
            for transition in thing.transitions:
                yield from _of_transition(thing, transition, path, dialect)
        elif isinstance(value, Model | list):
            yield from remarks(value, path, dialect)
    if isinstance(thing, StBody | Expression):
        yield from (Remark(path, comment.text) for comment in tokenize(thing.text, dialect).comments)


def _of_transition(chart: SfcNetwork, transition: Transition, path: str, dialect: Dialect) -> Iterator[Remark]:
    yield from remarks(transition, f"{path} / transition {chart.label(transition)}", dialect)


def texts_of(text: Text) -> dict[str, str]:
    """What a text says, by language; in none where it does not say in which, and nothing where it is empty."""
    if isinstance(text, MultilingualText):
        return {language: bare for language, each in text.texts.items() if (bare := _bare(each))}
    bare = _bare(text.text if isinstance(text, MarkupText) else text)
    return {"": bare} if bare else {}


class Said:
    """All that the code of some POUs says to people."""

    def __init__(self, pous: Iterable[Pou], dialect: Dialect) -> None:
        found = [remark.text for pou in pous for remark in remarks(pou, "", dialect)]
        texts = [each for text in found for each in texts_of(text).values()]
        self._texts, self._all = frozenset(texts), " ".join(texts)

    def has(self, text: str) -> bool:
        """Whether a text stands somewhere in it, as words of its own."""
        if text in self._texts:
            return True
        return re.search(rf"(?<!\w){re.escape(text)}(?!\w)", self._all) is not None


def _bare(text: str) -> str:
    """A text without the marks of comments, its words divided by one space each."""
    return " ".join(_MARKS.sub(" ", text).split())
