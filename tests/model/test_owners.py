"""A step knows its chart, a chart its project: whatever way they were put together."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Action, Macro, PartialChart, Pou, PouKind, Project, SfcBody, SfcNetwork, Step

FIXTURES = Path(__file__).parents[2] / "fixtures"


def chart() -> SfcNetwork:
    found = SfcNetwork()
    found.add_step("S1", initial=True)
    return found


def pou(name: str = "Main", *charts: SfcNetwork) -> Pou:
    return Pou(name=name, kind=PouKind.PROGRAM, bodies=[SfcBody(chart=each) for each in charts])


def test_what_a_constructor_gets_is_in_it() -> None:
    own = chart()
    made = Project(pous=[pou("Main", own)])
    assert own.project is made
    assert own.steps[0].chart is own
    assert own.steps[0].project is made
    assert made.pous[0].project is made


PUT: list[Callable[[Project, Pou], object]] = [
    lambda project, thing: project.pous.append(thing),
    lambda project, thing: project.pous.extend(each for each in [thing]),
    lambda project, thing: project.pous.insert(0, thing),
    lambda project, thing: project.pous.__setitem__(0, thing),
    lambda project, thing: project.pous.__setitem__(slice(0, 1), [thing]),
    lambda project, thing: project.pous.__iadd__([thing]),
    lambda project, thing: setattr(project, "pous", [thing]),
]


@pytest.mark.parametrize("put", PUT)
def test_every_way_to_put_a_pou_in(put: Callable[[Project, Pou], object]) -> None:
    made, own = Project(pous=[pou("Other")]), chart()
    put(made, pou("Main", own))
    assert own.project is made


def test_charts_of_actions_macro_steps_and_partial_charts() -> None:
    inner, deeper, partial = chart(), chart(), chart()
    own = chart()
    own.steps[0].macro = Macro(body=SfcBody(chart=inner))
    inner.steps.append(Step(id=9, name="M", macro=Macro(body=SfcBody(chart=deeper))))
    own.partial_charts.append(PartialChart(name="G2", chart=partial))
    made = Project(pous=[pou("Main")])
    made.pous[0].actions.append(Action(name="Fill", body=SfcBody(chart=own)))
    assert {each.project is made for each in (own, inner, deeper, partial)} == {True}


def test_what_was_taken_out_is_in_nothing() -> None:
    own = chart()
    made = Project(pous=[pou("Main", own)])
    step = own.steps.pop()
    thing = made.pous.pop()
    assert step.chart is None
    assert thing.project is own.project is None
    other = Project(pous=[thing])
    assert own.project is other


def test_a_project_made_of_pous_of_another_does_not_take_them() -> None:
    own = chart()
    made = Project(pous=[pou("Main", own)])
    assert Project(pous=list(made.pous)).pous[0].project is made
    assert made.model_copy(update={"pous": [made.pous[0]]}).pous[0].project is made


@pytest.mark.parametrize("again", [copy.deepcopy, lambda made: pickle.loads(pickle.dumps(made))])  # noqa: S301
def test_copies_have_parts_of_their_own(again: Callable[[Project], Project]) -> None:
    made = Project(pous=[pou("Main", chart())])
    other = again(made)
    own = other.pou("Main").sfc
    assert other == made
    assert own is not None
    assert own.project is other
    assert own.steps[0].chart is own
    other.pous.append(pou("More"))
    assert other.pous[1].project is other
    assert len(made.pous) == 1
    alone = copy.deepcopy(made.pous[0])
    assert alone.project is None


@pytest.mark.parametrize("name", ["codesys/sorting_conveyor.xml", "simaticml/FB_Drill.xml", "simaticml-plc"])
def test_what_is_read_late(name: str) -> None:
    made = sfc.load(FIXTURES / name)
    for each in made.charts():
        assert each.chart.project is made
        assert all(step.chart is each.chart for step in each.chart.steps)
        assert all(step.project is made for step in each.chart.steps)


def test_a_part_keeps_the_project_that_nothing_else_keeps() -> None:
    source = b"FUNCTION Twice : INT VAR_INPUT n : INT; END_VAR Twice := 2 * n; END_FUNCTION\nPROGRAM Main END_PROGRAM"
    pou = sfc.loads(source, format="iec-text").pou("Main")
    assert pou.project is not None
    assert [each.name for each in pou.project.pous] == ["Twice", "Main"]


def test_a_copy_with_other_values_does_not_copy_what_the_original_is_in(monkeypatch: pytest.MonkeyPatch) -> None:
    body = SfcBody(chart=SfcNetwork(steps=[Step(id=1, name="S1")]))
    project = Project(pous=[Pou(name="Main", kind=PouKind.PROGRAM, bodies=[body])])

    def refuse(*_: object) -> None:
        pytest.fail("the project is copied")

    monkeypatch.setattr(Project, "__deepcopy__", refuse)
    main = project.pou("Main")
    copied = main.model_copy(update={"name": "Other"}, deep=True)
    assert (copied.name, copied.owner, main.owner) == ("Other", None, project)
    assert copied.chart == main.chart
    assert copied.chart is not main.chart
    assert copied.chart is not None
    assert copied.chart.owner is copied.bodies[0]
    without = main.model_copy(update={"bodies": []}, deep=True)
    assert (without.bodies, without.name) == ([], "Main")
