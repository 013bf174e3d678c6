"""Errors of the model for wrong values and names, and the `repr` of its objects."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"


def small() -> m.SfcNetwork:
    chart = m.SfcNetwork()
    chart.add_step("Wait", initial=True)
    chart.add_step("Fill")
    chart.add_transition("wait", "Fill", "Start")
    chart.add_transition(["Fill"], 0, "Full").name = "T_Back"
    return chart


def test_transitions_are_added_between_steps_names_and_ids():
    chart = small()
    assert [chart.label(each) for each in chart.transitions] == ["Wait -> Fill", "T_Back"]
    assert chart.transitions[1].targets == [chart.step("Wait").id]


def test_steps_and_transitions_are_looked_up_in_the_same_way():
    chart = small()
    step, transition = chart.steps[1], chart.transitions[1]
    assert chart.step("fill") is chart.step(step.id) is step
    assert chart.transition("t_back") is chart.transition(transition.id) is transition
    assert chart.transition("wait -> fill") is chart.transitions[0]


def test_an_action_is_looked_up_as_a_pou_is():
    pou = m.Pou(name="Main", kind="program", actions=[m.Action(name="Fill")])
    assert pou.action("FILL") is pou.find_action("fill") is pou.actions[0]
    assert pou.find_action("Fil") is None
    with pytest.raises(sfc.ModelError, match=r"POU Main has no action 'Fil' \(did you mean 'Fill'\?\)"):
        pou.action("Fil")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.step("Fil"), "no step 'Fil' (did you mean 'Fill'?)"),
        (lambda c: c.step(7), "no step 7"),
        (lambda c: c.transition("Wait -> Fil"), "no transition 'Wait -> Fil' (did you mean 'Wait -> Fill'?)"),
        (lambda c: c.add_transition("Wait", "Drian"), "no step 'Drian'"),
        (lambda c: c.add_transition("Wait", m.Step(id=9, name="Other")), "the step 'Other' is not in this chart"),
        (lambda c: c.add_transition("Wait", "Fill", 5), "condition of Transition is no object of the model: 5 (int)"),
        (lambda c: setattr(c.step("Fill"), "maxtime", "T#5s"), "has no field 'maxtime' (did you mean 'max_time'?)"),
        (lambda c: setattr(c.step("Fill"), "number", "many"), "number of Step 'Fill' is not a whole number: 'many'"),
        (lambda c: setattr(c.step("Fill"), "initial", "maybe"), "initial of Step 'Fill' is not True or False"),
        (lambda c: m.Step(id=3), "Step needs name"),
        (lambda c: m.ActionAssociation(id=3, qualifier="p2"), "is none of None, N, R, R0"),
        (lambda c: m.MarkupText(text=3, markup=""), "text of MarkupText is not a text: 3 (int)"),
        (lambda c: sfc.Project().pou("Main"), "the project has no POU 'Main'"),
        (lambda c: sfc.Project(pous=[m.Pou(name="Main", kind="program")]).pou("Mian"), "(did you mean 'Main'?)"),
    ],
)  # fmt: skip
def test_a_wrong_value_or_name_is_an_error_of_ours(change, message):
    with pytest.raises(sfc.ModelError) as caught:
        change(small())
    assert message in str(caught.value)
    assert "pydantic" not in str(caught.value)


@pytest.mark.parametrize(
    "call",
    [
        lambda c: c.step(None),
        lambda c: c.transition(None),
        lambda c: c.add_step(5),
        lambda c: sfc.Project().pou(None),
        lambda c: m.Step("Fill"),
        lambda c: c.rename_step("Fill", 5),
        lambda c: sfc.Project().rename(5, "Fill"),
        lambda c: sfc.Project().rename("Fill", 5),
    ],
)
def test_an_object_of_a_wrong_type_is_an_error_of_ours(call):
    with pytest.raises(sfc.ArgumentError):
        call(small())


def test_what_is_wrong_with_a_value_is_told_in_words_of_ours():
    wrong = [
        object(),
        -1,
        1.5,
        float("nan"),
        [1],
        (1, 2, 3),
        {},
        {"kind": "q"},
        {"language": "q"},
        "\ud800",
        "1" * 5000,
    ]
    told = []
    step, symbol, action = {"id": 0, "name": "S"}, {"id": 0, "kind": "step"}, {"name": "A"}
    for kind, needed in ((m.Step, step), (m.Symbol, symbol), (m.Action, action)):
        for field in kind.model_fields:
            for value in wrong:
                try:
                    kind(**needed | {field: value})
                except sfc.ModelError as error:
                    told.append(str(error))
    theirs = ("Input ", "nable to", "permitted", "required", "valid", "discriminator", "exceeded")
    assert [text for text in told if any(word in text for word in theirs)] == []
    for part in (
        "id of Step is less than 0: -1 (int)",
        "id of Step is not a finite number: nan (float)",
        "has 3 items, not 2: (1, 2, 3) (tuple)",
        "does not tell its language: {} (dict)",
        "has none of the kinds ST, IL, FBD, LD, SFC, opaque: {'language': 'q'} (dict)",
    ):
        assert any(part in text for text in told), part


def test_a_refused_value_changes_nothing():
    step = small().step("Fill")
    with pytest.raises(sfc.ModelError):
        step.number = "many"
    assert step.number is None


def things_in(thing):
    yield thing
    for name in type(thing).model_fields:
        value = getattr(thing, name)
        for each in value if isinstance(value, list) else [value]:
            if isinstance(each, m.Model):
                yield from things_in(each)


@pytest.mark.parametrize(
    "name", ["codesys/sorting_conveyor.xml", "simaticml/FB_Drill.xml", "plcopen/filling_station_2.01.xml"]
)
def test_every_object_of_a_project_shows_itself_in_two_lines(name):
    project = sfc.load(FIXTURES / name)
    shown = [repr(each) for each in things_in(project)]
    assert max(map(len, shown)) <= 200
    assert len(shown) > 100
    for each in (project.source, sfc.convert(project), *project.bodies(), *project.charts()):
        assert len(repr(each)) <= 500


def test_every_result_shows_itself_in_two_lines(tmp_path):
    project = sfc.load(FIXTURES / "training-chain" / "plcopen_2.01.xml")
    exact, classic = sfc.lower(project, "case"), sfc.lower(project, "flipflop", style="classic")
    results = [
        project,
        exact,
        exact.proof,
        classic,
        *classic.faults,
        classic.proof.counterexample,
        exact.profile,
        sfc.simulate(project, scans=500),
        sfc.CsvInputs.parse("B1;B2\n" + "1;0\n" * 500),
        sfc.lower_to_file(project, str(tmp_path / "chain.scl"), "case"),
        sfc.save(project, tmp_path / "chain.st"),
        sfc.load(FIXTURES / "simaticml-plc").source,
        project.rename("Ablauf.S1", "Grundstellung"),
    ]
    assert classic.faults
    for each in results:
        assert 0 < len(repr(each)) <= 200
        assert "\n" not in repr(each)


def test_a_step_shows_what_was_stated():
    step = small().step("Fill")
    step.max_time = "T#5s"
    assert repr(step) == str(step) == "Step(name='Fill', id=1, max_time='T#5s')"


def test_what_follows_from_fields_cannot_be_assigned():
    pou = m.Pou(name="Main", kind="program", bodies=[m.SfcBody(chart=small())])
    with pytest.raises(sfc.ModelError, match="chart of Pou 'Main' cannot be assigned") as caught:
        pou.chart = None
    assert caught.value.hint == "The chart of the first SFC body."
