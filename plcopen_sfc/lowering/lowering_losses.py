"""Losses of a lowering: what a chart holds and its code does not, titles and comments included."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

from plcopen_sfc.languages.binding.name_scopes import with_inner_charts
from plcopen_sfc.languages.grafcet_conditions import program_parts
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.lowering.code.lowered_code import names_of, without_marks
from plcopen_sfc.model.base import ExtensionData, Model
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.chart_settings import SfcFlag, SfcSettings
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import NodeBase
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import ActionAssociation, PartialChart, SfcBody, SfcNetwork, Step
from plcopen_sfc.model.text import MarkupText, MultilingualText, Text, plain
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import Item, Outcome
from plcopen_sfc.semantics.charts.sfc_flags import flags_in_use
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.subjects import Subject

_TEXTS = ("title", "comment", "content", "alternative_text", "alarm")
_ATOMS = frozenset({int, float, bool, str})


@cache
def _texts_of(kind: type) -> tuple[str, ...] | None:
    """Return the fields of a kind of nodes that hold texts for people; None for what is no node."""
    return tuple(name for name in _TEXTS if name in kind.model_fields) if issubclass(kind, NodeBase) else None


class Caption(NamedTuple):
    """Text for people, and the path of its subject."""

    path: str
    text: Text


def captions(thing: Any, path: str, dialect: Dialect | None) -> Iterator[Caption]:
    """Yield all texts for people in a part of the model, in the order in which it has them.

    Without a `dialect` structured text is given as a whole, else its comments.
    """
    if isinstance(thing, list | tuple):
        for each in thing:
            # there are many nodes, and nothing in their pins is for people: no call for each of them
            texts = _texts_of(each.__class__)
            if texts is None:
                yield from captions(each, path, dialect)
                continue
            values = vars(each)
            if values.get("code") is not None:
                yield from _inside(values["code"], path, dialect)
            for name in texts:
                if values[name] is not None:
                    yield Caption(path, values[name])
    if not isinstance(thing, Model) or isinstance(thing, ExtensionData | SfcSettings):
        return
    if isinstance(thing, Step):
        path = f"{path} / step {thing.name}"
    elif isinstance(thing, PartialChart):
        path = f"{path} / {thing.name}"
    elif isinstance(thing, ActionAssociation) and thing.target is not None:
        path = f"{path} / action {thing.target}"
    for name, value in vars(thing).items():
        # most fields are none of these: to ask if they are an object of the model takes longer
        if value is None or value == [] or (type(value) in _ATOMS and name not in _TEXTS):
            continue
        if name in _TEXTS and isinstance(value, (str, MarkupText, MultilingualText)):
            yield Caption(path, value)
        elif isinstance(thing, SfcNetwork) and name == "transitions":
            labels = thing.labels()
            for transition in thing.transitions:
                yield from captions(transition, f"{path} / transition {labels[transition.id]}", dialect)
        elif isinstance(value, (Model, list)):
            yield from captions(value, path, dialect)
    if isinstance(thing, StBody | IlBody | Expression) and not _is_negated_in_time(thing):
        yield from _inside(thing.text, path, dialect)


def _is_negated_in_time(thing: StBody | IlBody | Expression) -> bool:
    """True for ``3s//a`` in a GRAFCET, which is no comment."""
    return isinstance(thing, Expression) and "//" in thing.text and bool(program_parts(thing.text))


def _inside(text: str, path: str, dialect: Dialect | None) -> Iterator[Caption]:
    if dialect is None:
        yield Caption(path, text)
    else:
        yield from (Caption(path, comment.text) for comment in tokenize(text, dialect).comments)


def caption_texts(text: Text) -> dict[str, str]:
    """Return a text by language: under an empty name where it has none, nothing where it is empty."""
    if isinstance(text, MultilingualText):
        return {language: each for language, each in text.texts.items() if _bare(each)}
    only = text.text if isinstance(text, MarkupText) else text
    return {"": only} if _bare(only) else {}


class CodeCaptions:
    """All titles and comments in the code of some POUs."""

    def __init__(self, pous: Iterable[Pou]) -> None:
        found = [remark.text for pou in pous for remark in captions(pou, "", None)]
        texts = [each for text in found for each in caption_texts(text).values()]
        self._lines = frozenset(_bare(line) for text in texts for line in text.splitlines())
        self._all = _bare(" ".join(texts))

    def has(self, text: str) -> bool:
        """Return True if it has all lines of a text, as words of their own."""
        lines = (line for line in map(_bare, text.splitlines()) if line not in self._lines)
        return all(re.search(rf"(?<!\w){re.escape(line)}(?!\w)", self._all) for line in lines)


def _bare(text: str) -> str:
    """Return a text without the marks of comments, its words divided by one space each."""
    return " ".join(without_marks(text).split())


_SHOWN = 60


def losses(subject: Subject, lowered: Sequence[Pou], profile: Profile, language: str) -> tuple[Item, ...]:
    """Return the losses of a chart in its code, and the parts without a meaning under the profile.

    `lowered`: the POU of `subject` with its code, then the blocks that were made besides. `language` is that of the
    texts in the code (``de``).
    """
    own, pou = subject.pou, lowered[0]
    code_captions = CodeCaptions(lowered)
    found: list[Item] = []
    for path, part in _lowered_parts(subject, pou):
        if isinstance(part, SfcBody):
            found += _Chart(subject, part.chart, profile, path).losses()
        for remark in captions(part, path, subject.project.dialect):
            found += _missing_in_code(remark, code_captions, language)
    # VAR_EXTERNAL declares nothing: the code names the global variable itself
    kept = {variable.name.casefold() for variable in (*pou.variables(), *own.variables(SectionKind.EXTERNAL))}
    gone = [variable.name for variable in own.variables() if variable.name.casefold() not in kept]
    if gone:
        why = f"only a chart can have variables of their types: {', '.join(gone)}"
        found.append(Item(Outcome.DROPPED, "variables", own.report_path_of(own.name), why))
    places = subject.project.locations_of(item.path for item in found)
    return tuple(replace(item, line=at.line, file=at.file) for item, at in zip(found, places, strict=True))


def _lowered_parts(subject: Subject, pou: Pou) -> Iterator[tuple[str, Model]]:
    """Yield the lowered body and the actions, transition objects and charts that went with it, with their paths."""
    own = subject.pou
    if own.body is not None:
        yield own.report_path_of(subject.name), own.body
    for action in own.actions:
        name = f"{own.name}.{action.name}"
        left = pou.find_action(action.name)
        if left is None:
            yield own.report_path_of(name), action
        elif isinstance(action.body, SfcBody) and not isinstance(left.body, SfcBody) and name != subject.name:
            yield own.report_path_of(name), action.body
    transitions = {each.name for each in pou.transitions}
    for each in own.transitions:
        if each.name not in transitions:
            yield own.report_path_of(f"{own.name}.{each.name}"), each


def _missing_in_code(remark: Caption, code_captions: CodeCaptions, language: str) -> Iterator[Item]:
    """Yield a text for people that the code does not have, or has in one of its languages only."""
    texts = caption_texts(remark.text)
    missing = {culture: text for culture, text in texts.items() if not code_captions.has(text)}
    if not missing:
        return
    if len(missing) < len(texts):
        why = f"the code has it in one language, not in {', '.join(missing)}"
    else:
        text = " ".join(plain(remark.text, language).split())
        why = f"not in the code: {text if len(text) <= _SHOWN else text[:_SHOWN] + '..'}"
    yield Item(Outcome.DROPPED, "comment", remark.path, why)


class _Chart:
    """Contents of one chart that have no effect on its code."""

    def __init__(self, subject: Subject, chart: SfcNetwork, profile: Profile, path: str) -> None:
        self._chart, self._profile, self._path = chart, profile, path
        net = Net.of(chart)
        self._paths = {id(each.step): each.path for each in net.steps} | {id(m.step): m.path for m in net.macros}
        declared = {*names_of(subject.project), *(variable.name.casefold() for variable in subject.pou.variables())}
        flags = flags_in_use(chart, profile, lambda name: name.casefold() in declared)
        self._watched = profile.maximum_times and SfcFlag.ERROR in flags

    def losses(self) -> Iterator[Item]:
        """Yield the objects that are excluded from the build, and times and numbers that no code asks for."""
        for chart in with_inner_charts(self._chart):
            for step in chart.steps:
                yield from self._of_step(step)
            for transition in chart.transitions:
                if transition.exclude:
                    path = f"transition {chart.label(transition)}"
                    yield self._dropped("transition", path, "it is excluded from the build")

    def _of_step(self, step: Step) -> Iterator[Item]:
        path = f"step {self._paths.get(id(step), step.name)}"
        if step.exclude:
            yield self._dropped("step", path, "it is excluded from the build")
            return
        unknown = f"the profile {self._profile.name} has no such times"
        if step.min_time and not self._profile.minimum_times:
            yield self._dropped("minimum time", path, f"{step.min_time}: {unknown}")
        asked = self._watched or self._profile.graph_parameters  # in S7-GRAPH it is a value that texts can ask for
        if step.max_time and not asked:
            why = "nothing asks for it: the chart does not use SFCError" if self._profile.maximum_times else unknown
            yield self._dropped("maximum time", path, f"{step.max_time}: {why}")
        for number, association in enumerate(step.actions, 1):
            action = f"{path} / action {association.target or number}"
            if association.exclude:
                yield self._dropped("action", action, "it is excluded from the build")
            elif association.indicator:
                yield self._dropped("indicator", action, f"{association.indicator} does not act on the chart")

    def _dropped(self, what: str, path: str, why: str) -> Item:
        return Item(Outcome.DROPPED, what, f"{self._path} / {path}", why)
