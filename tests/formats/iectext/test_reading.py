"""Texts by people and other tools, as the reader takes them."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m


def load(text: str) -> m.Project:
    return sfc.loads(text.encode(), format="iec-text", path="a.st")


def program(parts: str, declarations: str = "") -> m.Pou:
    project = load(f"PROGRAM Main\n{declarations}\n{parts}\nEND_PROGRAM\n")
    return project.pou("Main")


def chart(parts: str) -> m.SfcNetwork:
    found = program(parts).sfc
    assert found is not None
    return found


STEPS = "INITIAL_STEP A: END_STEP STEP B: END_STEP STEP C: END_STEP\n"


@pytest.mark.parametrize(
    ("association", "expected"),
    [
        ("Act(N);", {"target": "Act"}),
        ("Act(P1);", {"target": "Act", "qualifier": "P1"}),
        ("Act();", {"target": "Act", "qualifier": "None"}),
        ("Act;", {"target": "Act", "qualifier": "None"}),
        ("act(n);", {"target": "act"}),
        ("Act(D, T#5s);", {"target": "Act", "qualifier": "D", "duration": "T#5s"}),
        ("Act(L, tMax, Done);", {"target": "Act", "qualifier": "L", "duration": "tMax", "indicator": "Done"}),
        ("Act(N, Done);", {"target": "Act", "indicator": "Done"}),
        ("Act(L, t, a, b);", {"target": "Act", "qualifier": "L", "duration": "t", "indicator": "a, b"}),
        ("Motor.Start(S);", {"target": "Motor.Start", "qualifier": "S"}),
        ("Valves[Max(a, b)](R0);", {"target": "Valves[Max(a, b)]", "qualifier": "R0"}),
    ],
)
def test_associations(association: str, expected: dict[str, str]) -> None:
    step = chart(f"INITIAL_STEP A: {association} END_STEP").step("A")
    assert step.actions == [m.ActionAssociation(id=step.actions[0].id, **expected)]


@pytest.mark.parametrize(
    ("header", "name", "priority", "sources", "targets"),
    [
        ("FROM A TO B", "", None, "A", "B"),
        ("Go FROM A TO B", "Go", None, "A", "B"),
        ("(PRIORITY := 3) FROM A TO B", "", 3, "A", "B"),
        ("Go (priority := 3) from a to (b, C)", "Go", 3, "A", "BC"),
        ("FROM (A, B) TO (C)", "", None, "AB", "C"),
    ],
)
def test_headers_of_transitions(header: str, name: str, priority: int | None, sources: str, targets: str) -> None:
    network = chart(f"{STEPS} TRANSITION {header} := x; END_TRANSITION")
    (transition,) = network.transitions
    names = {step.id: step.name for step in network.steps}
    assert (transition.name, transition.priority) == (name, priority)
    assert "".join(names[i] for i in transition.sources) == sources
    assert "".join(names[i] for i in transition.targets) == targets
    assert transition.condition == m.Expression(text="x")


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        (":= a AND (b OR c);", m.Expression(text="a AND (b OR c)")),
        (":=\n  a\n    AND b  ;", m.Expression(text="a\n    AND b")),
        (": LD a\n AND b\n", m.BodyCondition(body=m.IlBody(text="LD a\nAND b"))),
        (":= LD a\n", m.BodyCondition(body=m.IlBody(text="LD a"))),
        (": x := f(a);\n", m.BodyCondition(body=m.StBody(text="x := f(a);"))),
    ],
)
def test_conditions(condition: str, expected: m.Condition) -> None:
    (transition,) = chart(f"{STEPS} TRANSITION FROM A TO B {condition} END_TRANSITION").transitions
    assert transition.condition == expected


def test_a_condition_that_names_a_transition_object_of_the_program() -> None:
    pou = program(f"{STEPS} TRANSITION FROM A TO B := Ready; END_TRANSITION\nTRANSITION Ready := x > 3; END_TRANSITION")
    assert pou.sfc is not None
    assert pou.sfc.transitions[0].condition == m.NamedCondition(name="Ready")
    assert pou.transitions == [m.NamedTransition(name="Ready", body=m.StBody(text="x > 3"))]


def test_bodies_of_actions_lose_their_margin_and_keep_their_layout() -> None:
    pou = program(
        f"{STEPS}    ACTION Fill:\n        IF a THEN\n            b := 1;\n\n        END_IF;\n    END_ACTION\n"
    )
    assert pou.actions == [m.Action(name="Fill", body=m.StBody(text="IF a THEN\n    b := 1;\n\nEND_IF;"))]


def test_an_action_without_a_colon_and_in_small_letters() -> None:
    pou = program(f"{STEPS} action Fill\n b := 1;\n end_action")
    assert pou.actions[0].body == m.StBody(text="b := 1;")


def test_instruction_lists_are_told_apart() -> None:
    pou = program("LD a\nST b")
    assert pou.body == m.IlBody(text="LD a\nST b")
    assert program("LD := 3;").body == m.StBody(text="LD := 3;")
    assert program("start: LD a\nJMP start").body == m.IlBody(text="start: LD a\nJMP start")


def test_words_that_open_parts_may_be_names_elsewhere() -> None:
    pou = program("Step := 3;\nx.transition := Action(1);\nACTION Real: y := 1; END_ACTION")
    assert pou.body == m.StBody(text="Step := 3;\nx.transition := Action(1);")
    assert [action.name for action in pou.actions] == ["Real"]


def test_comments_belong_to_what_they_stand_above() -> None:
    network = chart(
        """
  (* waits *)
  INITIAL_STEP A: (* inside *)
    Act(N); (* does it *)
  END_STEP
  // to the next one
  // when it is ready
  TRANSITION FROM A TO A := x; END_TRANSITION
"""
    )
    assert network.steps[0].comment == "waits\ninside"
    assert network.steps[0].actions[0].comment == "does it"
    assert network.transitions[0].comment == "to the next one\nwhen it is ready"


def test_comments_in_bodies_stay_there_and_comments_above_actions_do_not() -> None:
    pou = program("x := 1;\n\n(* still the body *)\n\n(* of the action *)\nACTION Fill: END_ACTION")
    assert pou.body == m.StBody(text="x := 1;\n\n(* still the body *)")
    assert pou.actions[0].comment == "of the action"


def test_pragmas_of_other_tools_are_carried_and_written_back() -> None:
    text = "PROGRAM Main\n{attribute 'x'}\nINITIAL_STEP A: END_STEP\nEND_PROGRAM\n"
    project = load(text)
    written = sfc.dumps(project, format="iec-text", fresh=True)
    assert b"{attribute 'x'}" in written
    assert sfc.loads(written) == project


def test_methods_properties_and_heads_with_words_the_model_lacks() -> None:
    project = load(
        """
FUNCTION_BLOCK ABSTRACT Valve EXTENDS Device IMPLEMENTS IValve, IOpen
VAR
    Open : BOOL;
END_VAR
METHOD PUBLIC Toggle : BOOL
VAR_INPUT
    Force : BOOL;
END_VAR
    Open := NOT Open;
END_METHOD
PROPERTY State : INT
GET
State := 3;
END_GET
END_PROPERTY
Open := Open;
END_FUNCTION_BLOCK
"""
    )
    pou = project.pou("Valve")
    assert pou.methods[0].interface is not None
    assert pou.methods[0].interface.return_type == m.ElementaryType(name=m.Elementary.BOOL)
    assert [v.name for v in pou.methods[0].interface.variables()] == ["Force"]
    assert pou.methods[0].body == m.StBody(text="Open := NOT Open;")
    assert pou.body == m.StBody(text="Open := Open;")
    written = sfc.dumps(project, format="iec-text", fresh=True).decode()
    assert "FUNCTION_BLOCK ABSTRACT Valve EXTENDS Device IMPLEMENTS IValve, IOpen\n" in written
    assert "METHOD PUBLIC Toggle : BOOL\n" in written
    assert "\n    PROPERTY State : INT\nGET\n" in written
    assert "{plcopen_sfc extension_data" not in written
    assert sfc.loads(written.encode()) == project


def test_units_that_are_none_of_ours_are_kept_as_text() -> None:
    text = "INTERFACE IValve\nMETHOD Open : BOOL\nEND_METHOD\nEND_INTERFACE\n\nsome words\nPROGRAM Main\nEND_PROGRAM\n"
    project = load(text)
    written = sfc.dumps(project, format="iec-text", fresh=True).decode()
    assert "\nINTERFACE IValve\nMETHOD Open : BOOL\nEND_METHOD\nEND_INTERFACE\n" in written
    assert "\nsome words\n" in written
    assert sfc.loads(written.encode()) == project


def test_configurations() -> None:
    project = load(
        """
CONFIGURATION Plant
  VAR_GLOBAL x : INT; END_VAR
  RESOURCE Station ON Beremiz
    TASK Fast(INTERVAL := t#10ms, PRIORITY := 1);
    TASK Edge(SINGLE := x, PRIORITY := 0);
    PROGRAM A WITH Fast : Main;
    PROGRAM B : Main (p := 3);
  END_RESOURCE
  VAR_ACCESS Out : Station.A.y : INT READ_ONLY; END_VAR
END_CONFIGURATION
"""
    )
    (plant,) = project.configurations
    (station,) = plant.resources
    assert [(t.name, t.interval, t.single, t.priority) for t in station.tasks] == [
        ("Fast", "t#10ms", None, 1),
        ("Edge", None, "x", 0),
    ]
    assert [(i.name, i.type_name) for i in station.tasks[0].instances] == [("A", "Main")]
    assert [(i.name, i.type_name) for i in station.instances] == [("B", "Main")]
    assert plant.access_variables is not None
    assert plant.access_variables.variables[0].path == "Station.A.y"
    assert [v.name for v in plant.global_variables[0].variables] == ["x"]
    written = sfc.dumps(project, format="iec-text", fresh=True)
    assert b"ON Beremiz" in written
    assert sfc.loads(written) == project


@pytest.mark.parametrize("newline", ["\r\n", "\r"])
def test_line_ends_do_not_matter(newline: str) -> None:
    text = "PROGRAM Main\nINITIAL_STEP A:\n  Act(N);\nEND_STEP\nACTION Act:\n  a := 1;\n  b := 2;\nEND_ACTION\n"
    text += "END_PROGRAM\n"
    assert load(text.replace("\n", newline)) == load(text)


def test_an_organisation_block_stays_one() -> None:
    made = m.Project(pous=[m.Pou(name="Main", kind=m.PouKind.ORGANIZATION_BLOCK, bodies=[m.StBody(text="a := b;")])])
    data, report = sfc.convert(made, "iec-text", partial=True)
    assert [item.what for item in report.losses] == ["kind"]  # no other tool calls it by itself
    assert sfc.loads(data) == made
