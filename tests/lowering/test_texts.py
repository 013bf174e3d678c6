"""What lowered code says is there in each language."""

from __future__ import annotations

import ast
import inspect
from collections import Counter
from typing import get_args

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.lowering.lower import lower
from plcopen_sfc.lowering.texts import TEXTS, GermanTexts, Suffix, Texts
from tests.lowering.charts import act, boolean, training_chain
from tests.lowering.grafcets import pou_with

SAME = {
    "flag_name",
    "time_name",
    "transition_name",
    "delay_name",
    "transition_title",
    "waiting_constant",
    "init_input",
    "remark",
    "said",
    "with_suffix",
    "step_numbers",
}
"""What is the same in all languages."""


def test_german_has_words_of_its_own_for_everything() -> None:
    missing = [name for name in vars(Texts) if not name.startswith("_") and name not in vars(GermanTexts)]
    assert set(missing) <= SAME


def test_every_suffix_is_german_too() -> None:
    assert set(GermanTexts.suffixes) == set(get_args(Suffix))


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


@pytest.mark.parametrize("language", ["ST", "FBD"])
@pytest.mark.parametrize(
    ("pou", "profile", "modes"),
    [
        (with_everything(), "codesys", ["single-step", "select"]),
        (with_everything(), "matiec", []),
        (with_edges(), "grafcet", []),
    ],
)
def test_all_names_are_german_where_german_was_asked_for(
    pou: m.Pou, profile: str, modes: list[str], language: str
) -> None:
    if profile == "grafcet" and language != "ST":
        pytest.skip("networks have no loop")
    english = {word for word, german in GermanTexts.suffixes.items() if word != german}
    english |= {Texts.pulse, Texts.condition, Texts.state}

    def words(lang: str) -> set[str]:
        made = lower(
            m.Project(pous=[pou]),
            "flipflop" if language == "FBD" else "bits",
            language=language,
            profile=profile,
            modes=modes,
            target="simaticml" if language == "FBD" else None,
            lang=lang,
            verify=False,
        )
        return {word for variable in made.pou.variables() for word in variable.name.split("_")}

    assert words("en") & english
    assert not words("de") & english
