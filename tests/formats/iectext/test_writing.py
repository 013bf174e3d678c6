"""The text that is written: readable, and a pragma only for what text cannot say."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import Outcome

NASTY = ("END_STEP", "Step 1", "to", "a.b", "", "x}", "FROM", "Füllen", "1st", "*)", "IF")


def written(project: m.Project) -> str:
    text = sfc.dumps(project, format="iec-text", fresh=True, partial=True)
    assert sfc.loads(text) == project
    return text.decode()


def project_of(chart: m.SfcNetwork, **more: object) -> m.Project:
    body = m.SfcBody(chart=chart)
    pou = m.Pou(name="Main", kind=m.PouKind.PROGRAM, interface=m.Interface(), bodies=[body], **more)
    return m.Project(pous=[pou])


def test_a_chart_is_what_the_standard_says() -> None:
    chart = m.SfcNetwork()
    wait, fill = chart.add_step("Wait", initial=True), chart.add_step("Fill")
    fill.comment = "until the level is reached"
    fill.actions = [
        m.ActionAssociation(id=2, target="Valve"),
        m.ActionAssociation(id=3, target="Horn", qualifier=m.Qualifier.D, duration="T#5s", indicator="Done"),
    ]
    chart.add_transition(wait, fill, "Start AND NOT Fault", priority=1)
    chart.add_transition(fill, wait, "Level")
    action = m.Action(name="Horn", body=m.StBody(text="Lamp := TRUE;"))
    assert (
        written(project_of(chart, actions=[action]))
        == """\
{plcopen_sfc format := 1}

PROGRAM Main

    INITIAL_STEP Wait:
    END_STEP

    TRANSITION (PRIORITY := 1) FROM Wait TO Fill
        := Start AND NOT Fault;
    END_TRANSITION

    (* until the level is reached *)
    STEP Fill:
        Valve(N);
        Horn(D, T#5s, Done);
    END_STEP

    TRANSITION FROM Fill TO Wait
        := Level;
    END_TRANSITION

    ACTION Horn:
        Lamp := TRUE;
    END_ACTION
END_PROGRAM
"""
    )


def test_what_text_cannot_say_stands_beside_what_it_belongs_to() -> None:
    chart = m.SfcNetwork()
    step = chart.add_step("Heat", initial=True)
    step.max_time = "T#20s"
    step.entry_action = "Heater.On"
    step.exit_action = m.StBody(text="Heat := FALSE;")
    step.supervision = m.Supervised(condition=m.Expression(text="Temp > 90"), alarm="too hot")
    step.title = m.MultilingualText(texts={"de-DE": "Heizen", "en-US": "Heat"})
    text = written(project_of(chart))
    assert (
        text.split("PROGRAM Main\n")[1]
        == """\

    INITIAL_STEP Heat:
        {plcopen_sfc title.texts.'de-DE' := 'Heizen'}
        {plcopen_sfc title.texts.'en-US' := 'Heat'}
        {plcopen_sfc max_time := 'T#20s'}
        {plcopen_sfc supervision.condition.kind := 'expression'}
        {plcopen_sfc supervision.condition.text := 'Temp > 90'}
        {plcopen_sfc supervision.alarm := 'too hot'}
        Heater.On(P1); {plcopen_sfc step_action := 'entry'}
        Heat_exit(P0); {plcopen_sfc step_action := 'exit'}
    END_STEP

    {plcopen_sfc in_place}
    ACTION Heat_exit:
        Heat := FALSE;
    END_ACTION
END_PROGRAM
"""
    )


def test_names_that_cannot_stand_in_the_text_are_replaced_and_come_back() -> None:
    chart = m.SfcNetwork()
    steps = [chart.add_step(name) for name in NASTY]
    steps[0].initial = True
    for one, other in zip(steps, [*steps[1:], steps[0]], strict=True):
        one.actions.append(m.ActionAssociation(id=chart.new_id(), target=other.name or None))
        chart.add_transition(one, other, m.NamedCondition(name=other.name))
    text = written(project_of(chart))
    assert "name := 'Step 1' FOR 'Step_1'" in text


def test_two_steps_of_a_name_stay_two() -> None:
    steps = b"INITIAL_STEP A: END_STEP\nSTEP a: END_STEP\nTRANSITION FROM A TO B := x; END_TRANSITION\n"
    text = b"PROGRAM Main\n" + steps + b"END_PROGRAM"
    project = sfc.loads(text, format="iec-text")
    project.accept_errors()
    again = sfc.loads(sfc.dumps(project, format="iec-text", fresh=True, partial=True))
    assert [step.name for step in again.pou("Main").chart.steps] == ["A", "a"]


def test_transitions_from_and_to_what_does_not_exist() -> None:
    chart = m.SfcNetwork()
    chart.add_step("A", initial=True)
    chart.transitions.append(m.Transition(id=9, sources=[77], targets=[], condition=m.Expression(text="x")))
    written(project_of(chart))


def test_program_text_that_does_not_fit_between_the_keywords_is_kept_in_a_pragma() -> None:
    for text in (
        "END_ACTION",
        "(* open",
        "x := 'open",
        "STEP A:",
        "{plcopen_sfc x}",
        "a\r\nb",
        "  x;\n",
        "\n\n",
        "\tx\n\ty",
    ):
        action = m.Action(name="Act", body=m.StBody(text=text))
        chart = m.SfcNetwork()
        chart.add_step("A", initial=True)
        written(project_of(chart, actions=[action]))
        pou = m.Pou(name="P", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.StBody(text=text)])
        written(m.Project(pous=[pou]))


def test_expressions_that_do_not_fit_are_kept_in_a_pragma() -> None:
    for text in ("a; b", "", " a", "a // b", "END_TRANSITION", "(* x", "{plcopen_sfc x}", "a\r\nb"):
        chart = m.SfcNetwork()
        step = chart.add_step("A", initial=True)
        chart.add_transition(step, step, m.Expression(text=text, negated=True))
        written(project_of(chart))


def test_drawn_conditions_are_shown_as_expressions() -> None:
    source = sfc.load("fixtures/plcopen/filling_station_2.01.xml")
    text = written(source)
    drawn = [
        t for chart in source.charts() for t in chart.chart.transitions if isinstance(t.condition, m.WiredCondition)
    ]
    assert len(drawn) == 4
    assert text.count("].drawn.shown := ") == 4
    seen = sfc.loads(text.encode(), format="iec-text", as_tool=True)
    shown = [t.condition for chart in seen.charts() for t in chart.chart.transitions]
    assert all(condition is not None for condition in shown)
    texts = [condition.text for condition in shown if isinstance(condition, m.Expression)]
    # two of them call a timer, and give the condition to no name that a reader of the text would know
    assert len([each for each in texts if each.startswith("NOT_EXECUTED_")]) == 2


def test_what_no_text_says_does_not_compile_there() -> None:
    source = sfc.load("fixtures/plcopen/filling_station_2.01.xml")
    text, report = sfc.convert(source, "iec-text", partial=True)
    places = {item.path for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == "body"}
    assert places == {"POU FillingStation / transition EmergencyOff", "POU DripValve"}  # they need edges
    seen = sfc.loads(text, as_tool=True)
    bodies = [seen.pou("DripValve").body, *(t.body for t in seen.pou("FillingStation").transitions)]
    assert [body.text for body in bodies if isinstance(body, m.StBody)] == [
        "NOT_EXECUTED_DripValve := TRUE;",
        "LevelRaw > 8000 AND S5_EStopOk",
        "NOT_EXECUTED_EmergencyOff",
    ]
    assert sfc.loads(text).pou("DripValve") == source.pou("DripValve")


def test_a_condition_of_an_association_is_executed_in_text_too() -> None:
    source = sfc.load("fixtures/training-chain/plcopen_2.01.xml")
    text, report = sfc.convert(source, "iec-text")
    assert report.losses == []
    seen = sfc.loads(text, as_tool=True)
    association = next(a for a in seen.pou("Ablauf").sfc.step("S3").actions if (a.target or "").startswith("S3"))
    assert seen.pou("Ablauf").action(association.target).body.text == "Q3 := S3.X AND (B5);"
    assert sfc.loads(text).pou("Ablauf") == source.pou("Ablauf")


def test_values_of_strings_get_quotes() -> None:
    text = b"PROGRAM Main\nVAR a : STRING := 'x'; END_VAR\nEND_PROGRAM\n"
    project = sfc.loads(text, format="iec-text")
    variable = project.pou("Main").variables()[0]
    for value, written_as in (("Hello World", "'Hello World'"), ("it's", "'it$'s'"), ("", "''"), ("'x'", "'x'")):
        variable.initial = m.SimpleValue(text=value)
        data = sfc.dumps(project, format="iec-text", fresh=True, partial=True)
        assert f":= {written_as};" in data.decode()
        assert sfc.loads(data).pou("Main") == project.pou("Main")


def test_a_changed_expression_counts_more_than_the_drawing_it_was_shown_for() -> None:
    text = written(sfc.load("fixtures/plcopen/filling_station_2.01.xml"))
    line = next(line for line in text.splitlines() if ".drawn.shown := " in line)
    shown = line.split(":= '")[1].removesuffix("'}")
    edited = sfc.loads(text.replace(f":= {shown};", ":= Something_else;", 1).encode())
    conditions = [t.condition for chart in edited.charts() for t in chart.chart.transitions]
    assert m.Expression(text="Something_else") in conditions
    assert [d.code for d in edited.diagnostics if d.code == "IEC213"] == ["IEC213"]


def test_the_report_says_what_became_a_pragma() -> None:
    chart = m.SfcNetwork()
    step = chart.add_step("A", initial=True)
    step.max_time = "T#1s"
    step.main_action = "Act"
    _, report = sfc.convert(project_of(chart), "iec-text")
    outcomes = {(item.what, item.outcome) for item in report.items}
    assert {
        ("step", Outcome.KEPT),
        ("max time", Outcome.EXTENSION_DATA),
        ("main action", Outcome.TRANSLATED),
    } <= outcomes
    assert report.losses == []


def test_permanent_instructions_without_a_network_are_no_loss() -> None:
    """TIA Portal writes an empty one into each export; they were named as two bodies that are not executed."""
    text = b"FUNCTION_BLOCK Main\nVAR a : BOOL; END_VAR\nINITIAL_STEP S: END_STEP\nTRANSITION FROM S TO S := a;"
    source = sfc.loads(text + b" END_TRANSITION\nEND_FUNCTION_BLOCK\n", format="iec-text")
    chart = source.pou("Main").sfc
    chart.permanent_pre = [m.PermanentOperation(body=m.LdBody())]
    data, report = sfc.convert(source, "iec-text", fresh=True)
    assert report.losses == []
    assert sfc.loads(data).pou("Main").sfc.permanent_pre == chart.permanent_pre
    chart.permanent_pre = [m.PermanentOperation(body=m.StBody(text="a := TRUE;"))]
    report = sfc.convert(source, "iec-text", fresh=True, partial=True).report
    assert "chart" in {item.what for item in report.losses}


@pytest.mark.parametrize(("path", "is_text"), [("R.Main.x", True), ("R.Main.x y", False)])
def test_instance_addresses_outside_of_a_configuration_come_back(path: str, is_text: bool) -> None:
    project = m.Project(name="Plant")
    project.add_program("Main").add_variable("x", "BOOL")
    bool_, start = m.ElementaryType(name=m.Elementary.BOOL), m.SimpleValue(text="TRUE")
    entry = m.ConfigVariable(path=path, type=bool_, address="%IX0.0", initial=start)
    project.config_variables = m.ConfigSection(comment="wiring", variables=[entry])
    data = sfc.dumps(project, format="iec-text", partial=True)
    assert (b"VAR_CONFIG\n    R.Main.x AT %IX0.0 : BOOL := TRUE;\nEND_VAR\n" in data) == is_text
    assert sfc.loads(data).config_variables == project.config_variables
