"""Texts of lowered code exist in each language."""

from __future__ import annotations

import ast
import inspect
from collections import Counter

import pytest

from plcopen_sfc import load
from plcopen_sfc import model as m
from plcopen_sfc.lowering import lower
from plcopen_sfc.lowering.code_texts import SUFFIXES, TEXTS, CodeWords, Phrase, Texts
from tests.lowering.charts import act, boolean, training_chain
from tests.lowering.grafcets import pou_with
from tests.samples import FIXTURES

SAME = {
    "init_input",
    "pause",
    "start",
    "transition",
    "transition_title",
    "waiting_constant",
}
"""Texts that are the same in all languages."""


def test_german_has_words_of_its_own_for_everything() -> None:
    english, german = (TEXTS[language] for language in ("en", "de"))
    names = [name for name, words in vars(Texts).items() if isinstance(words, CodeWords)]
    assert {name for name in names if getattr(english, name) == getattr(german, name)} == SAME - {"transition_title"}
    phrases = [name for name, words in vars(Texts).items() if isinstance(words, Phrase)]
    filled = {name: [getattr(each, name)("a", "b", "c") for each in (english, german)] for name in phrases}
    assert {name for name, (one, other) in filled.items() if one == other} <= SAME


def test_every_suffix_is_german_too() -> None:
    assert {TEXTS["de"].with_suffix("a", suffix) for suffix in SUFFIXES} > {"a_flanke", "a_alt"}


@pytest.mark.parametrize("language", TEXTS)
def test_texts_are_one_line_and_not_empty(language: str) -> None:
    texts = TEXTS[language]
    for name, text in inspect.getmembers(texts, lambda value: isinstance(value, str)):
        if not name.startswith("_") and name not in ("culture", "flag_pattern"):
            assert text.strip() == text, name
            assert text, name
            assert "\n" not in text, name


def test_nothing_is_said_twice_under_one_name() -> None:
    tree = ast.parse(inspect.getsource(Texts))
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


def with_everything() -> m.Pou:
    """A chart of whose variables every kind has a name of its own."""
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    assert pou.interface is not None
    flags = ("SFCReset", "SFCTip", "SFCTipMode", "SFCError", "SFCTrans", "SFCEnableLimit")
    pou.interface.sections[0].variables += map(boolean, flags)
    chart.steps[1].max_time = "T#5s"
    chart.steps[2].min_time = "T#5s"
    chart.steps[3].entry_action, chart.steps[3].exit_action = (
        m.StBody(text=f"Q3 := {value};") for value in ("B5", "B4")
    )
    for number, (qualifier, step) in enumerate((("N", 0), ("S", 1), ("P", 3)), 90):
        body = m.StBody(text="Q3 := NOT Q3;")
        chart.steps[step].actions.append(m.ActionAssociation(id=number, body=body, qualifier=qualifier))
    chart.add_transition(chart.steps[2], chart.steps[2], "B5")
    for step, qualifier, duration in (
        (0, m.Qualifier.P, None),
        (1, m.Qualifier.SD, "Long"),
        (2, m.Qualifier.D, "T#2s"),
    ):
        act(chart, chart.steps[step], "Q3", qualifier, duration=duration)
    pou.interface.sections[0].variables.append(m.Variable(name="Long", type="TIME"))
    return pou


def with_edges() -> m.Pou:
    """The same of a GRAFCET."""
    chart = m.SfcNetwork()
    first, second, third = (chart.add_step(name, initial=name == "1") for name in "123")
    for source, target, condition in ((first, second, "↑Go"), (second, third, "Go"), (third, first, "NOT Go")):
        chart.add_transition(source, target, condition)
    act(chart, second, "Q", m.Qualifier.P1)
    second.actions.append(m.ActionAssociation(id=99, kind="onActivation", target="n", value="n + 1"))
    return pou_with(chart, "Go", "Q n:INT")


def names(project: m.Project, lang: str, **options: str | list[str]) -> set[str]:
    """The words of all names of variables."""
    made = lower(project, lang=lang, verify=False, **options)  # type: ignore[arg-type]
    return {word for variable in made.pou.variables() for word in variable.name.split("_")}


ENGLISH = {suffix for suffix in SUFFIXES if TEXTS["de"].with_suffix("", suffix) != f"_{suffix}"}
ENGLISH |= {TEXTS["en"].pulse, TEXTS["en"].condition, TEXTS["en"].state}
DRAWN = {"construction": "flipflop", "language": "FBD"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pou", "options"),
    [
        (with_everything(), {"construction": "bits", "profile": "codesys", "modes": ["single-step", "select"]}),
        (with_everything(), {**DRAWN, "target": "simaticml", "profile": "codesys", "modes": ["single-step", "select"]}),
        (with_everything(), {"construction": "bits", "profile": "matiec"}),
        (with_everything(), {**DRAWN, "target": "simaticml", "profile": "matiec"}),
        (with_edges(), {"construction": "bits", "profile": "grafcet"}),
    ],
)
def test_all_names_are_german_where_german_was_asked_for(pou: m.Pou, options: dict[str, str | list[str]]) -> None:
    project = m.Project(pous=[pou])
    assert names(project, "en", **options) & ENGLISH
    assert not names(project, "de", **options) & ENGLISH


@pytest.mark.parametrize("options", [{"construction": "bits"}, {**DRAWN, "target": "codesys"}])
def test_names_of_sequencers_are_german_too(options: dict[str, str | list[str]]) -> None:
    project = load(FIXTURES / "simaticml-plc")
    assert names(project, "en", pou="FB_Drilling", **options) & ENGLISH
    assert not names(project, "de", pou="FB_Drilling", **options) & ENGLISH
