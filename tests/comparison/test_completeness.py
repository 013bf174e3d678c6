"""diff: every field of what a chart is made of is compared, or is in a list here that says why not."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import (
    Enclosure,
    ForcingOrder,
    GraphSettings,
    Macro,
    Method,
    Model,
    NamedTransition,
    PartialChart,
    PermanentOperation,
    SfcSettings,
)
from tests.samples import FIXTURES

NOT_COMPARED = {
    "id": "ids tell nothing to people",
    "global_id": "as ids",
    "object_id": "as ids",
    "extension_data": "data of the tool",
    "symbol": "the symbol configuration of CODESYS",
    "duplicate": "ids of the file that several elements have",
    "monitoring": "how the online view watches a transition",
    "declaration": "the text of what the variables are",
    "folder": "the project tree of the tool",
    "place": "the project tree of the tool",
    "nonretain": "the default",
    "nonpersistent": "the default",
    "markup": "how a file writes the text",
    "VariableSection.name": "sections of POUs have none",
    "VariableSection.comment": "no tool shows it",
    "Expression.kind": "what makes it an expression",
    "SfcNetwork.drawing": "layout",
    "SfcNetwork.logic": "what it does is compared: see test_diff.py",
    "SfcNetwork.sequences": "they follow from the transitions",
    "priority": "it counts among competing transitions only: see the order of transitions",
}
FALLBACKS: tuple[Any, ...] = (
    "Zz9",
    True,
    77,
    sfc.Supervised(condition="B5"),
    Macro(expansion="G2"),
    [Enclosure(chart="G2")],
    ForcingOrder(chart="G2", situation="INIT"),
    sfc.StBody(text="Zz9 := 1;"),
    sfc.ActionEvent.S1,
    [sfc.Action(name="Zz9")],
    [NamedTransition(name="Zz9", body=sfc.StBody(text="B1"))],
    [Method(name="Zz9")],
    {"ExternalAccessible": "false"},
    SfcSettings(use_defaults=True),
    GraphSettings(skip_steps=True),
    [PermanentOperation(body=sfc.StBody(text="Zz9 := 1;"))],
    [PartialChart(name="Zz9", chart=sfc.SfcNetwork())],
    sfc.SfcNetwork(steps=[sfc.Step(id=1, name="Zz9")]),
    sfc.ActionKind.CONTINUOUS,
    None,
)


def others(value: Any) -> Iterator[Any]:
    """Values that a field may have instead."""
    if isinstance(value, Enum):
        yield from (each for each in type(value) if each is not value)
    elif isinstance(value, bool):
        yield not value
    elif isinstance(value, int):
        yield value + 7
    elif isinstance(value, str):
        yield f"{value}Zz9"
    elif isinstance(value, list) and value:
        yield value[:-1]
    yield from FALLBACKS


def sample() -> sfc.Project:
    """A project with an object of each class."""
    project = sfc.load(FIXTURES / "training-chain" / "model.json")
    chart = project.pou("Ablauf").chart
    chart.partial_charts.append(PartialChart(name="G1", chart=sfc.SfcNetwork()))
    return project


def things(project: sfc.Project) -> Iterator[Model]:
    """One object of each class that people edit."""
    pou = project.pou("Ablauf")
    yield pou
    yield pou.interface.sections[0]
    yield pou.interface.sections[0].variables[0]
    yield pou.chart
    yield pou.chart.steps[2]
    yield pou.chart.transitions[1]
    yield pou.chart.transitions[1].condition
    yield pou.chart.steps[1].actions[0]
    yield pou.chart.partial_charts[0]


FIELDS = [
    (index, name)
    for index, thing in enumerate(things(sample()))
    for name in type(thing).model_fields
    if not {name, f"{type(thing).__name__}.{name}"} & NOT_COMPARED.keys()
]


@pytest.fixture(scope="module")
def before() -> sfc.Project:
    return sample()


@pytest.mark.parametrize(("index", "name"), FIELDS)
def test_another_value_is_a_change(before, index, name):
    after = before.model_copy(deep=True)
    thing = list(things(after))[index]
    old = getattr(thing, name)
    for value in others(old):
        try:
            setattr(thing, name, value)
        except sfc.ModelError:
            continue
        if getattr(thing, name) != old:
            break
    else:
        pytest.fail(f"no other value for {type(thing).__name__}.{name}")
    diff = sfc.diff(before, after)
    assert diff.changes
    assert str(diff) != "no differences"
