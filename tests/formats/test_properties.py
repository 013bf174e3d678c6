"""Whatever a project is, it is the same after saving and loading, in every format."""

from __future__ import annotations

import json
import os
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, note, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from tests.strategies import conditions, expressions, names, projects, texts, times

FORMATS = ("plcopen-2.01", "plcopen-2.0", "plcopen-1.01", "codesys")
STATED = {"exclude", "symbol", "duplicate", "monitoring"}
"""Values that CODESYS always writes: False where none was stated."""


def loaded(data: bytes, name: str) -> m.Project:
    """The content of a file. A file without any data of CODESYS cannot be told from one of another tool."""
    return sfc.loads(data, format="codesys" if name == "codesys" else None)


quick = settings(
    max_examples=int(os.environ.get("PLCOPEN_SFC_EXAMPLES", "5")),
    phases=[Phase.explicit, Phase.generate],  # projects are big: what fails is read faster than it is shrunk
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    derandomize=True,
)


def meaning(project: m.Project, *, codesys: bool = False) -> Any:
    """The content of a project, without drawings and without the ids that files give to objects."""
    copy = project.model_copy(deep=True)
    if codesys:
        copy.dialect = m.Dialect.CODESYS  # that of its files; the texts are the same in both
    nets = [net(chart.chart, codesys=codesys) for chart in copy.charts()]
    for chart in copy.charts():
        chart.chart.steps, chart.chart.transitions, chart.chart.drawing = [], [], None
    return json.loads(copy.model_dump_json(exclude_none=True)), nets


def net(chart: m.SfcNetwork, *, codesys: bool) -> Any:
    names = [{s.id: s.name for s in chart.steps}]

    def plain(thing: m.Model) -> Any:
        return thing.model_dump(
            mode="json", exclude_none=True, exclude={"id", "actions"} | (STATED if codesys else set())
        )

    steps = sorted(
        [s.name, plain(s), [plain(a) for a in s.actions]]  # type: ignore[list-item]
        for s in chart.steps
    )
    transitions = []
    for one in chart.transitions:
        content = plain(one)
        content["sources"] = sorted(names[0][i] for i in one.sources)
        content["targets"] = sorted(names[0][i] for i in one.targets)
        # priorities are written where the order of the document cannot be that of competing transitions; CODESYS, which
        # has none, reports such an order
        content.pop("priority", None)
        if not codesys:
            content["order"] = sorted([names[0][i], place_in(chart, i, one)] for i in one.sources)
        transitions.append(content)
    # competing transitions keep their order; transitions of different steps have none among them
    return steps, sorted(transitions, key=lambda t: t["sources"])


def place_in(chart: m.SfcNetwork, step: int, transition: m.Transition) -> int:
    """In which place a transition is tried when the step is active."""
    source = next(each for each in chart.steps if each.id == step)
    return [each.id for each in chart.outgoing(source)].index(transition.id)


@pytest.mark.slow
@quick
@given(projects())
def test_json_is_exact(project: m.Project) -> None:
    assert sfc.loads(sfc.dumps(project, format="json")) == project


@pytest.mark.slow
@pytest.mark.parametrize("name", FORMATS)
@quick
@given(project=projects())
def test_saved_and_loaded_is_the_same(name: str, project: m.Project) -> None:
    codesys = name == "codesys"
    if codesys:  # a project of another tool gets other names there
        project.dialect = m.Dialect.CODESYS
    data = sfc.dumps(project, format=name, partial=True)
    note(data.decode())
    again = loaded(data, name)
    assert meaning(again, codesys=codesys) == meaning(project, codesys=codesys)
    assert sfc.dumps(again) == data


@st.composite
def edits(draw: Any, project: m.Project) -> None:
    """Edits a loaded project here and there."""
    for chart in project.charts():
        for step in chart.chart.steps:
            if draw(st.booleans()):
                step.comment = draw(st.none() | texts)
            if draw(st.integers(0, 3)) == 0:
                step.max_time = draw(st.none() | times)
            for association in step.actions:
                if draw(st.booleans()):
                    association.duration, association.target = draw(st.none() | times), draw(names)
        for transition in chart.chart.transitions:
            if draw(st.integers(0, 2)) == 0 and isinstance(transition.condition, m.Expression):
                transition.condition.text = draw(expressions)
    for pou in project.pous:
        if draw(st.booleans()):
            pou.comment = draw(st.none() | texts)
        for variable in pou.interface.variables() if pou.interface else ():
            if draw(st.booleans()):
                variable.name, variable.comment = draw(names), draw(st.none() | texts)
    for _, _, body in project.bodies():
        if isinstance(body, m.StBody) and draw(st.booleans()):
            body.text = draw(texts)


@pytest.mark.slow
@pytest.mark.parametrize("name", FORMATS)
@quick
@given(data=st.data())
def test_edited_after_loading_and_saved_is_what_was_edited(name: str, data: st.DataObject) -> None:
    first = sfc.dumps(data.draw(projects()), format=name, partial=True)
    project = loaded(first, name)
    data.draw(edits(project))
    second = sfc.dumps(project, partial=True)
    note(second.decode())
    again = loaded(second, name)
    if name == "codesys":
        # a declaration text that no longer says what is declared is left out
        for pou in (*project.pous, *again.pous):
            if pou.interface is not None:
                pou.interface.declaration = None
    codesys = name == "codesys"
    assert meaning(again, codesys=codesys) == meaning(project, codesys=codesys)


@pytest.mark.slow
@pytest.mark.parametrize("name", FORMATS)
@quick
@given(data=st.data())
def test_grown_after_loading_and_saved_is_what_has_grown(name: str, data: st.DataObject) -> None:
    project = loaded(sfc.dumps(data.draw(projects()), format=name, partial=True), name)
    for chart in project.charts():
        network = chart.chart
        last = data.draw(st.sampled_from(network.steps))
        new = network.add_step("Zz_neu")
        network.add_transition(last, new, data.draw(conditions))
        network.add_transition(new, network.initial_steps[0], "TRUE")
        new.actions.append(m.ActionAssociation(id=network.new_id(), target="q"))
    second = sfc.dumps(project, partial=True)
    note(second.decode())
    codesys = name == "codesys"
    assert meaning(loaded(second, name), codesys=codesys) == meaning(project, codesys=codesys)
