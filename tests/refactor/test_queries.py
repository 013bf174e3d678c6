"""Queries: steps by what they do, declarations by name, uses, and tables."""

from __future__ import annotations

from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import ArgumentError, ModelError
from tests.samples import FIXTURES

SORTING = FIXTURES / "codesys" / "sorting_conveyor.xml"
STATION = FIXTURES / "plcopen" / "filling_station_2.01.xml"


def names(steps: list[sfc.Step]) -> list[str]:
    return [step.name for step in steps]


@pytest.fixture
def chart() -> sfc.SfcNetwork:
    chart = sfc.SfcNetwork()
    for name in ("Wait", "Fill", "Mix", "Drain"):
        chart.add_step(name, initial=name == "Wait")
    texts = {"Fill": ["N Valve1", "N Pour"], "Mix": ["D T#2s GVL.Motor"], "Drain": ["S Valve2", "N Lamp"]}
    for name, lines in texts.items():
        for line in lines:
            chart.step(name).actions.append(sfc.ActionAssociation.parse(line, chart.new_id()))
    chart.step("Mix").max_time = "T#5s"
    chart.add_transition("Wait", ["Fill", "Mix"], "Start AND Level > 5")
    chart.add_transition(["Fill", "Mix"], "Drain", "Full")
    chart.add_transition("Drain", "Drain", "Again")
    pour = sfc.Action(name="Pour", body=sfc.StBody(text="Pump := Level < 9; Dose();"))
    dose = sfc.Action(name="Dose", body=sfc.StBody(text="Doser := TRUE;"))
    pou = sfc.Pou(name="Main", kind=sfc.PouKind.PROGRAM, bodies=[sfc.SfcBody(chart=chart)], actions=[pour, dose])
    sfc.Project(name="Plant", pous=[pou])
    return chart


def test_steps_know_what_is_before_and_after_them(chart: sfc.SfcNetwork) -> None:
    assert names(chart.step("Wait").successors) == ["Fill", "Mix"]
    assert names(chart.step("Drain").predecessors) == ["Fill", "Mix", "Drain"]
    assert chart.step("Wait").predecessors == []


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ({"drives": "valve*"}, ["Fill", "Drain"]),
        ({"drives": "Motor"}, ["Mix"]),
        ({"drives": "gvl.*"}, ["Mix"]),
        ({"drives": "Pump"}, ["Fill"]),
        ({"drives": "Doser"}, ["Fill"]),
        ({"drives": "Pour"}, []),
        ({"calls": "Pour"}, ["Fill"]),
        ({"calls": "Dose"}, ["Fill"]),
        ({"reads": "Level"}, ["Fill"]),
        ({"qualifier": "D"}, ["Mix"]),
        ({"qualifier": ["S", sfc.Qualifier.D]}, ["Mix", "Drain"]),
        ({"max_time": None}, ["Wait", "Fill", "Drain"]),
        ({"max_time": "t#*"}, ["Mix"]),
        ({"initial": True}, ["Wait"]),
        ({"name": "?i*"}, ["Fill", "Mix"]),
        ({"reachable_from": "Fill"}, ["Drain"]),
        ({"reachable_from": "main.fill"}, ["Drain"]),
        ({"leading_to": "Drain"}, ["Wait", "Fill", "Mix", "Drain"]),
        ({"leading_to": "Fill"}, ["Wait"]),
        ({"drives": "*Valve*", "name": "D*"}, ["Drain"]),
        ({"where": lambda step: len(step.actions) == 2}, ["Fill", "Drain"]),
    ],
)
def test_steps_are_found_by_what_they_do(chart: sfc.SfcNetwork, wanted: dict[str, object], found: list[str]) -> None:
    assert names(chart.find(**wanted)) == found  # type: ignore[arg-type]
    project = chart.project
    assert project is not None
    assert names(project.steps(**wanted)) == found


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ({"reads": "Level"}, ["Start AND Level > 5"]),
        ({"reads": "Full"}, ["Full"]),
        ({"condition": "*a*"}, ["Start AND Level > 5", "Again"]),
        ({"leaving": "Drain"}, ["Again"]),
        ({"leaving": "Main.Dr*"}, ["Again"]),
        ({"leaving": "Other.Dr*"}, []),
        ({"entering": "m*"}, ["Start AND Level > 5"]),
        ({"entering": "Drain", "leaving": "Mix"}, ["Full"]),
        ({"where": lambda link: len(link.targets) == 1}, ["Full", "Again"]),
    ],
)
def test_transitions_are_found_by_what_they_read(
    chart: sfc.SfcNetwork, wanted: dict[str, object], found: list[str]
) -> None:
    assert chart.project is not None
    for where in (chart, chart.project):
        assert [each.condition.text for each in where.find_transitions(**wanted)] == found  # type: ignore[arg-type, union-attr]
    with pytest.raises(ModelError, match="transitions have no field 'prioriti'"):
        chart.find_transitions(prioriti=1)


def test_transitions_are_found_through_named_ones(chart: sfc.SfcNetwork) -> None:
    assert chart.project is not None
    link = chart.transitions[1]
    chart.project.edit().extract_condition(link, "IsFull")
    assert chart.find_transitions(reads="Full") == [link]


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        ({"maxtime": None}, "no field 'maxtime'.*did you mean 'max_time'"),
        ({"qualifier": "X"}, "'X' is no qualifier"),
        ({"reachable_from": "Fil"}, "did you mean 'Fill'"),
    ],
)
def test_a_condition_that_is_none_is_refused(chart: sfc.SfcNetwork, wanted: dict[str, object], message: str) -> None:
    assert chart.project is not None
    with pytest.raises(ModelError, match=message):
        chart.find(**wanted)  # type: ignore[arg-type]
    with pytest.raises(ModelError, match=message):
        chart.project.steps(**wanted)


def test_lists_are_asked_as_charts_are(chart: sfc.SfcNetwork) -> None:
    steps: Any = chart.steps
    transitions: Any = chart.transitions
    for wanted in ({"drives": "*"}, {"name": "F*"}, {"initial": True}):
        assert steps.where(**wanted) == chart.find(**wanted) != []
    assert steps.where(lambda each: each.initial) == chart.initial_steps
    assert transitions.where(reads="*") == chart.find_transitions(reads="*") != []
    project: Any = sfc.Project(pous=[sfc.Pou(name=name, kind="program") for name in ("FB_A", "Main")])
    assert [each.name for each in project.pous.where(name="fb_*")] == ["FB_A"]
    with pytest.raises(ModelError, match="pous have no field 'nam'"):
        project.pous.where(nam="x")


def test_declarations_are_found_by_name_and_know_their_uses() -> None:
    project = sfc.load(SORTING)
    found = project.find("*Mot*", "variable")
    assert found
    assert {str(each.kind) for each in found} == {"variable"}
    assert all("mot" in each.path.casefold() for each in found)
    assert [each.path for each in project.find("PLC_PRG.Measure")] == ["PLC_PRG.Measure"]
    chart = project.pou("PLC_PRG").chart
    assert [use.text for use in chart.step("Measure").uses()] == [
        "Measure.t > T#2s500ms AND eMaterial = E_Material.Unknown"
    ]
    action = project.pou("PLC_PRG").action("ACT_Classify")
    assert [use.path for use in action.uses()] == [use.path for use in project.uses("PLC_PRG.ACT_Classify")] != []
    variable = project.pou("PLC_PRG").variables()[0]
    assert project.uses(variable) == project.uses(f"PLC_PRG.{variable.name}")
    assert variable.uses() == project.uses(variable)
    with pytest.raises(ModelError, match="no kind of declaration"):
        project.find("*", "steps")


@pytest.mark.parametrize(
    "file",
    [
        "codesys/sorting_conveyor.xml",
        "codesys/distribution_belt.xml",
        "plcopen/every_element_2.01.xml",
        "simaticml",
        "twincat-belt",
        "twincat/press_station.xml",
    ],
)
def test_whatever_is_declared_knows_its_uses(file: str) -> None:
    project = sfc.load(FIXTURES / file)
    found = [each for each in project.find("*") if not isinstance(each.holder, sfc.Transition)]
    copy = project.model_copy(deep=True).find("*")
    assert len({each.kind for each in found}) > 3
    for each, copied in zip(found, [c for c in copy if not isinstance(c.holder, sfc.Transition)], strict=True):
        assert each.holder.uses() == project.uses(each) == copied.holder.uses()
        assert each.holder.project is project


def test_a_variable_that_moves_to_another_list_is_of_that_project() -> None:
    project, other = sfc.load(SORTING), sfc.Project(name="Other")
    (found,) = project.find("PLC_PRG.bBeltRun")
    variable = found.holder
    assert variable.uses() != []
    pou = other.add_program("Main")
    for section in project.pou("PLC_PRG").interface.sections:
        section.variables = [each for each in section.variables if each is not variable]
    assert (variable.project, variable.uses()) == (None, [])
    pou.add_variable("Motor")
    pou.interface.sections[0].variables.append(variable)
    assert variable.project is other
    with pytest.raises(ArgumentError, match="`variables` of VariableSection is a list of Variable"):
        pou.interface.sections[0].variables.append("Motor2")


def test_a_chart_is_a_table(chart: sfc.SfcNetwork) -> None:
    records = chart.to_records()
    assert len({tuple(record) for record in records}) == 1
    assert records[1]["actions"] == ["N Valve1", "N Pour"]
    assert records[0]["next"] == ["Start AND Level > 5 -> Fill+Mix"]
    assert (records[2]["step"], records[2]["max_time"], records[2]["initial"]) == ("Mix", "T#5s", False)


def test_cross_references_of_all_bodies() -> None:
    project = sfc.load(SORTING)
    rows = project.cross_references()
    own = [row for row in rows if row["name"] == "PLC_PRG.bMeasure"]
    assert [(row["place"], row["line"]) for row in own] == [
        (use.path, use.line) for use in project.uses("PLC_PRG.bMeasure")
    ]
    assert {row["kind"] for row in project.cross_references("action")} == {"action"}
    assert len(project.cross_references(None)) > len(rows)


def test_a_trace_is_a_table() -> None:
    trace = sfc.simulate(sfc.load(SORTING), pou="FB_Pusher", inputs=sfc.RandomInputs(4), scans=5)
    records = trace.to_records()
    assert [record["scan"] for record in records] == [0, 1, 2, 3, 4]
    assert all(record["steps"] == trace.active(record["scan"]) for record in records)
    name = trace.columns[0].name
    assert [record[name] for record in records] == list(trace.columns[0])


LINES = ["N Valve", "D T#2s Lamp", "S Count := Count + 1", "S1 R Valve", "C N Valve", "SD tMax Motor.ACT_Stop", "P1 A"]


GRAPH_LINES = ["S1 TL T#5s Wait", "TF T#5s Wait", "S1 CU Parts", "S1 ON Fill", "P T#2s Lamp"]


@pytest.mark.parametrize("text", [*LINES, *GRAPH_LINES, 'N "My valve"', "S a[i + 1]"])
def test_the_text_of_an_action_is_read_and_written(text: str) -> None:
    assert sfc.ActionAssociation.parse(text, 1).text == text


@pytest.mark.parametrize("text", ["", "D Lamp", "D T#2s", "S x :=", "D 5s Lamp", "X Valve", "N Valve Lamp"])
def test_a_text_that_is_no_action_is_refused(text: str) -> None:
    with pytest.raises(ModelError, match="is no action of a step"):
        sfc.ActionAssociation.parse(text, 1)


@pytest.mark.parametrize(("text", "usual"), [("NC Valve", "C N Valve"), ("dc T#2s Lamp", "C D T#2s Lamp")])
def test_an_interlock_behind_the_qualifier_is_read(text: str, usual: str) -> None:
    assert sfc.ActionAssociation.parse(text, 1).text == usual


def test_one_of_several_values_is_wanted(chart: sfc.SfcNetwork) -> None:
    assert names(chart.steps.where(name=["Fill", "dr*"])) == ["Fill", "Drain"]
    assert names(chart.find(max_time=("T#5s", None))) == ["Wait", "Fill", "Mix", "Drain"]
    assert chart.transitions.where(targets=[chart.step("Drain").id]) != []


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ({"name": 5}, "name is never 5"),
        ({"name": ["Fill", 5]}, "name is never 5"),
        ({"initial": "true"}, "initial is never 'true'"),
        ({"number": "1"}, "number is never '1'"),
        ({"number": True}, "number is never True"),
        ({"actions": "N Lamp"}, "actions is never 'N Lamp'"),
    ],
)
def test_values_that_a_field_never_has_are_refused(chart: sfc.SfcNetwork, fields: dict[str, Any], told: str) -> None:
    with pytest.raises(ModelError, match=told):
        chart.steps.where(**fields)


def test_kinds_that_there_are_not_are_refused() -> None:
    project = sfc.load(SORTING)
    with pytest.raises(ModelError, match=r"kind is never 'prgram' \(did you mean 'program'"):
        project.pous.where(kind="prgram")
    assert [pou.name for pou in project.pous.where(kind="prog*")] == ["PLC_PRG"]


def test_a_name_is_not_in_a_list_of_objects(chart: sfc.SfcNetwork) -> None:
    assert chart.step("Fill") in chart.steps
    with pytest.raises(ArgumentError, match="`steps` of SfcNetwork is a list of Step"):
        assert "Fill" in chart.steps
