"""Methods of CODESYS in tools without methods: functions that get the variables of the block."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import Outcome
from tests.conversion.features import FeatureChart, variable
from tests.formats.simaticml.test_action_calls import method, methods, project_of

TARGETS = [("plcopen-2.01", ""), ("plcopen-2.01", "beremiz"), ("iec-text", "matiec")]


def called_methods(rig: FeatureChart) -> None:
    """Methods that call each other, one of an instance, in statements, expressions and conditions."""
    methods(rig)
    rig.project.pous[1].actions = []
    rig.project.pous[1].methods = [method("Toggle", "run := NOT THIS^.run;\nToggle := run;", result="BOOL")]
    axis = rig.project.pous[2]
    axis.bodies = [m.StBody(text="IF motor.run THEN motor.Toggle(); END_IF;")]
    rig.pou.actions = [each for each in rig.pou.actions if each.name not in ("Go", "Halt")]
    for step in rig.chart.steps:
        step.actions = [each for each in step.actions if each.target not in ("Go", "Halt")]


def told_methods(report: sfc.ConversionReport, outcome: Outcome) -> dict[str, str]:
    return {item.path: item.why for item in report.with_outcome(outcome) if item.what == "method"}


@pytest.mark.parametrize(("target", "flavour"), TARGETS)
def test_methods_are_functions_and_the_machine_does_the_same(target: str, flavour: str) -> None:
    report = sfc.convert(project_of(called_methods), target, flavour=flavour, limit=8).report
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []
    assert report.compared["POU Main"].startswith("equal")
    told = told_methods(report, Outcome.TRANSLATED)
    assert told["POU Main / method Next"].startswith("it is the function Main_Next,")


@pytest.mark.parametrize("target", ["plcopen-2.01", "plcopen-1.01"])
def test_methods_come_back(target: str) -> None:
    source = sfc.loads(sfc.dumps(project_of(called_methods), format="codesys"))
    back = sfc.loads(sfc.dumps(sfc.loads(sfc.dumps(source, format=target)), format="codesys"))
    for pou in source.pous:
        again = back.pou(pou.name)
        assert again.methods == pou.methods
        assert again.interface == pou.interface
    assert [pou.name for pou in back.pous] == [pou.name for pou in source.pous]
    up, turn = (back.pou("Main").find_action(name) for name in ("Up", "Turn"))
    assert isinstance(up.body, m.StBody)
    assert isinstance(turn.body, m.StBody)
    assert up.body.text == (
        "n := Next(more := 2) + Next(more := 1);\nIF Next(more := Next(more := 1)) > 5 THEN Clear(); END_IF;"
    )
    assert turn.body.text == "q := axis.motor.Toggle();\naxis.motor.Toggle();"


def test_an_edited_function_stays_one_and_what_calls_it() -> None:
    source = sfc.loads(sfc.dumps(project_of(called_methods), format="codesys"))
    written = sfc.loads(sfc.dumps(source, format="plcopen-2.01"))
    written.pou("Main_Clear").bodies = [m.StBody(text="n := 1;")]
    back = sfc.loads(sfc.dumps(written, format="codesys"))
    assert [each.name for each in back.pou("Main").methods] == []
    assert {"Main_Clear", "Main_Next"} <= {pou.name for pou in back.pous}
    assert [each.name for each in back.pou("Motor").methods] == ["Toggle"]


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("run := Toggle();", "it calls itself"),
        ("run := THIS^.old > 0;", "its text cannot be read"),
        ("THIS^(run := TRUE);", "it uses THIS, the block itself, which no function has"),
        ("Start();", "it calls the action Start, which only its block executes"),
        ("timer(IN := run);", "timer is an instance, which functions do not get in TC6 tools"),
    ],
)
def test_a_method_that_no_function_holds_says_why(text: str, why: str) -> None:
    project = project_of(called_methods)
    motor = project.pous[1]
    motor.actions = [m.Action(name="Start", body=m.StBody(text="run := TRUE;"))]
    section = m.VariableSection(kind=m.SectionKind.LOCAL, variables=[variable("timer", "TON"), variable("old", "INT")])
    assert motor.interface is not None
    motor.interface.sections.append(section)
    motor.methods = [method("Toggle", text, result="BOOL")]
    report = sfc.convert(project, "plcopen-2.01", flavour="beremiz", partial=True).report
    told = told_methods(report, Outcome.NOT_EXECUTED)
    assert why in told["POU Motor / method Toggle"]
    assert any(
        "have no methods, and this calls one: motor.Toggle" in item.why
        for item in report.with_outcome(Outcome.NOT_EXECUTED)
    )


def test_an_instance_is_a_parameter_in_tc6() -> None:
    project = project_of(called_methods)
    motor = project.pous[1]
    assert motor.interface is not None
    motor.interface.sections.append(m.VariableSection(variables=[variable("timer", "TON")]))
    motor.methods = [method("Toggle", "timer(IN := run);\nrun := NOT timer.Q;\nToggle := run;", result="BOOL")]
    data, report = sfc.convert(project, "plcopen-2.01")
    assert not told_methods(report, Outcome.NOT_EXECUTED)
    function = sfc.loads(data, as_tool=True).pou("Motor_Toggle")
    assert [each.name for each in function.variables(m.SectionKind.IN_OUT)] == ["run", "timer"]


@pytest.mark.parametrize(("target", "flavour"), [*TARGETS, ("simaticml", "")])
def test_what_a_method_writes_that_nothing_calls_is_no_input_in_the_proof(target: str, flavour: str) -> None:
    """It was one of the target alone, where the function writes a parameter."""

    def build(rig: FeatureChart) -> None:
        rig.declare(m.SectionKind.LOCAL, variable("held"))
        rig.pou.methods = [method("Hold", "held := TRUE;")]
        rig.action("Look", m.StBody(text="q := held;"))
        rig.act("Work", "Look")

    report = sfc.convert(project_of(build), target, flavour=flavour, limit=6).report
    assert report.losses == []
    assert report.compared["POU Main"].startswith("equal")


@pytest.mark.parametrize(("call", "name"), [("method", "Bump"), ("action", "Count")])
@pytest.mark.parametrize("target", ["plcopen-2.01", "simaticml"])
def test_boxes_that_call_methods_and_actions_are_executed(call: str, name: str, target: str) -> None:
    def build(rig: FeatureChart) -> None:
        rig.action("Count", m.StBody(text="n := 1 - n;"))
        rig.pou.methods = [method("Bump", "n := more - n;", variable("more", "INT"))]
        wire = m.InputPin(connections=[m.Connection(source=1)])
        pins = [m.BlockVariable(name="more", input=wire)] if call == "method" else []
        box = m.Block(id=2, type_name=name, call=m.BlockCall(call), parameters=m.BlockParameters(inputs=pins))
        nodes: list[m.Node] = [m.InputVariable(id=1, expression="2"), box] if pins else [box]
        rig.action("Box", m.FbdBody(networks=[m.LogicNetwork(nodes=nodes)]))
        rig.act("Work", "Box")

    report = sfc.convert(project_of(build), target, limit=4).report
    assert report.losses == []
    assert report.compared["POU Main"].startswith("equal")


def test_a_box_that_calls_an_action_is_not_executed_in_beremiz() -> None:
    def build(rig: FeatureChart) -> None:
        rig.action("Count", m.StBody(text="n := 1 - n;"))
        box = m.Block(id=2, type_name="Count", call=m.BlockCall.ACTION)
        rig.action("Box", m.FbdBody(networks=[m.LogicNetwork(nodes=[box])]))
        rig.act("Work", "Box")

    report = sfc.convert(project_of(build), "plcopen-2.01", flavour="beremiz", partial=True).report
    assert any("`Count`" in item.why for item in report.with_outcome(Outcome.NOT_EXECUTED))


@pytest.mark.parametrize("section", ["VAR_INST", "VAR_STAT"])
def test_variables_of_methods_that_keep_their_values_are_lost_nowhere_in_silence(section: str) -> None:
    """TIA Portal got a function with a temporary variable; the simulator began anew in each call; diff saw nothing."""
    text = f"""FUNCTION_BLOCK Mot VAR_OUTPUT o : INT; END_VAR o := Up();
    METHOD Up : INT {section} s : INT := 3; END_VAR s := s + 1; Up := s; END_METHOD END_FUNCTION_BLOCK"""
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = sfc.model.Dialect.CODESYS
    for target in ("simaticml", "plcopen-2.01"):
        _, report = sfc.convert(project, target, partial=True)
        lost = [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)]
        assert any("its variables keep their values" in why for why in lost)
    _, report = sfc.convert(project, "codesys", partial=True)
    (lost,) = report.with_outcome(Outcome.NOT_EXECUTED)
    assert lost.path == "POU Mot / method Up / s"
    assert section in lost.why
    with pytest.raises(sfc.SimulationError, match="keeps its value between calls"):
        sfc.simulate(project.pou("Mot"), scans=2)
    other = sfc.loads(text.replace(section, "VAR").encode(), format="iec-text")
    other.dialect = sfc.model.Dialect.CODESYS
    assert [f"no longer {section}" in str(change) for change in sfc.diff(project, other).changes] == [True]
