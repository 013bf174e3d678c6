"""Boxes that are drawn before conditions: while the transition is enabled, or in every scan and a scan late."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import ModelError
from plcopen_sfc.lowering import lower
from plcopen_sfc.semantics.drawn_charts import as_executed
from plcopen_sfc.semantics.profile import PROFILES, DrawnBlocks
from plcopen_sfc.semantics.simulation import simulate
from plcopen_sfc.semantics.subjects import resolve
from tests.judges.matiec import Value, require_matiec
from tests.lowering.charts import boolean
from tests.lowering.test_drawn_conditions import FORMS, pin
from tests.semantics.charts.rig import chain

ROWS: list[dict[str, Value]] = [{"go": True}, {}, {}, {"stop": True}, {"stop": False}, {}, {"go": False, "stop": True}]
ROWS += [{"stop": False}, {"go": True}, {}, {}, {}, {"stop": True}]

CONVERTED = """PROGRAM Chart
VAR go, stop, lamp : BOOL; timer : TON; END_VAR
INITIAL_STEP Dark: Boxes(S); END_STEP
ACTION Boxes: timer(IN := go, PT := T#20ms); END_ACTION
TRANSITION FROM Dark TO Bright := timer.Q; END_TRANSITION
STEP Bright: lamp(N); END_STEP
TRANSITION FROM Bright TO Dark := stop; END_TRANSITION
END_PROGRAM
"""
"""The text that the converter of Beremiz writes for `timed`."""


def project(chart: m.SfcNetwork, inputs: str, outputs: str, *others: m.Variable) -> m.Project:
    kinds = {m.SectionKind.INPUT: inputs, m.SectionKind.OUTPUT: outputs}
    sections = [
        m.VariableSection(kind=kind, variables=[boolean(name) for name in names.split()])
        for kind, names in kinds.items()
    ]
    sections.append(m.VariableSection(kind=m.SectionKind.LOCAL, variables=list(others)))
    interface = m.Interface(sections=sections)
    pou = m.Pou(name="Chart", kind=m.PouKind.PROGRAM, interface=interface, bodies=[m.SfcBody(chart=chart)])
    return m.Project(pous=[pou])


def boxes(*boxes: tuple[str, str, str]) -> list[m.Node]:
    """Boxes one behind the other, as instance, type and the input of each; the first has two inputs of its own."""
    found: list[m.Node] = []
    before: m.InputPin | None = None
    for number, (instance, kind, given) in enumerate(boxes):
        first, second, block = 100 + 10 * number, 101 + 10 * number, 102 + 10 * number
        names = ("IN", "PT", "Q") if kind == "TON" else ("IN1", "IN2", "OUT")
        values = [given, "T#20ms"] if kind == "TON" else given.split()
        pins = [before or pin(first), pin(second)]
        found += [m.InputVariable(id=second, expression=values[-1], output=m.OutputPin())]
        if before is None:
            found.append(m.InputVariable(id=first, expression=values[0], output=m.OutputPin()))
        inputs = [m.BlockVariable(name=name, input=each) for name, each in zip(names[:2], pins, strict=True)]
        outputs = [m.BlockVariable(name=names[2], output=m.OutputPin())]
        parameters = m.BlockParameters(inputs=inputs, outputs=outputs)
        found.append(m.Block(id=block, type_name=kind, instance=instance or None, parameters=parameters))
        before = pin(block, names[2])
    return found


def timed(kind: str = "wired") -> m.Project:
    """Dark leads to Bright 20 ms after `go` became TRUE, Bright leads back with `stop`; a lamp is on in Bright."""
    chart = chain("Dark", "Bright", conditions="go stop")
    chart.step("Bright").actions = [m.ActionAssociation(id=10, qualifier=m.Qualifier.N, target="lamp")]
    nodes = boxes(("timer", "TON", "go"))
    others = [m.Variable(name="timer", type=m.DerivedType(name="TON"))]
    made = project(chart, "go stop", "lamp", *others)
    if kind == "wired":
        chart.logic = nodes
        chart.transitions[0].condition = m.WiredCondition(input=pin(102, "Q"))
        return made
    coil = m.OutputVariable(id=1, expression="Ready", input=pin(102, "Q"))
    body = m.FbdBody(networks=[m.LogicNetwork(nodes=[*nodes, coil])])
    if kind == "named":
        made.pous[0].transitions.append(m.NamedTransition(name="Ready", body=body))
        chart.transitions[0].condition = m.NamedCondition(name="Ready")
    else:
        chart.transitions[0].condition = m.BodyCondition(name="Ready", body=body)
    return made


def log(project: m.Project, profile: str, signal: str = "lamp") -> str:
    trace = simulate(project, inputs=lambda scan, _: ROWS[scan], scans=len(ROWS), profile=profile)
    return "".join(str(int(bool(value))) for value in trace[signal])


@pytest.mark.parametrize("kind", ["wired", "named", "inline"])
def test_a_timer_is_reset_only_where_it_is_executed_in_every_scan(kind: str) -> None:
    """While Bright is active its condition is not asked: the timer keeps its time, and Dark is left at once."""
    assert log(timed(kind), "iec") == "0010110000110"
    assert log(timed(kind), "beremiz") == "0001110000010"


def test_the_compiler_does_so_with_what_the_converter_writes(tmp_path: Path) -> None:
    rows = require_matiec().build(CONVERTED, tmp_path).run(ROWS, ["lamp"])
    assert "".join(str(int(bool(row["lamp"]))) for row in rows) == log(timed(), "beremiz")


def gate() -> m.Project:
    """The same with an AND instead of a timer; a lamp is wired to Bright besides."""
    made = timed()
    chart = made.pous[0].sfc
    assert chart is not None
    lamp = m.OutputVariable(id=200, expression="shown", input=pin(chart.step("Bright").id))
    chart.logic = [*boxes(("", "AND", "go stop")), lamp]
    chart.transitions[0].condition = m.WiredCondition(input=pin(102, "OUT"))
    chart.transitions[1].condition = m.Expression(text="NOT go")
    assert made.pous[0].interface is not None
    made.pous[0].interface.sections[1].variables.append(boolean("shown"))
    return made


def test_conditions_see_what_a_box_gave_one_scan_ago() -> None:
    assert log(gate(), "iec") == "0001110000001"
    assert log(gate(), "beremiz") == "0000110000000"


def test_a_contact_is_read_when_the_transition_is_tested() -> None:
    made = gate()
    chart = made.pous[0].sfc
    assert chart is not None
    rail = m.LeftPowerRail(id=300, outputs=[m.OutputPin()])
    chart.logic += [rail, m.Contact(id=301, variable="stop", input=pin(300))]
    chart.transitions[0].condition = m.WiredCondition(input=pin(301))
    assert log(made, "beremiz") == log(made, "iec")


def test_a_wire_from_a_step_to_a_variable_is_left_out() -> None:
    assert "1" in log(gate(), "iec", "shown")
    assert "1" not in log(gate(), "beremiz", "shown")


def test_a_box_that_feeds_two_conditions_is_executed_once() -> None:
    made = timed()
    chart = made.pous[0].sfc
    assert chart is not None
    for transition in chart.transitions:
        transition.condition = m.WiredCondition(input=pin(102, "Q"))
    (action,) = as_executed(resolve(made), PROFILES["beremiz"]).pou.actions
    assert isinstance(action.body, m.StBody)
    assert action.body.text.split("\n") == ["timer(IN := go, PT := T#20ms);"]


def test_variables_are_written_before_any_body_is_executed() -> None:
    """The body that the chart uses first writes the variable that an association writes too: the body is the last."""
    chart = chain("A", "B", conditions="stop go")
    chart.step("A").actions = [
        m.ActionAssociation(id=10, qualifier=m.Qualifier.N, target="Switch_off"),
        m.ActionAssociation(id=11, qualifier=m.Qualifier.N, target="lamp"),
    ]
    made = project(chart, "go stop", "lamp")
    made.pous[0].actions.append(m.Action(name="Switch_off", body=m.StBody(text="lamp := FALSE;")))
    for profile, first in (("iec", "1"), ("matiec", "0"), ("beremiz", "0")):
        assert log(made, profile)[0] == first
        lowered = lower(made, "bits", profile=profile)
        assert lowered.proof is not None
        assert lowered.proof.kind is VerdictKind.PROVEN


def test_steps_and_transitions_stand_in_the_order_of_the_flow() -> None:
    chart = chain("A", "C", "B", conditions="go go go", ring=False)
    chart.steps = [chart.step("B"), chart.step("C"), chart.step("A")]
    chart.transitions.reverse()
    adapted = as_executed(resolve(project(chart, "go", "")), PROFILES["beremiz"]).pou.sfc
    assert adapted is not None
    assert [step.name for step in adapted.steps] == ["A", "C", "B"]
    assert [t.sources for t in adapted.transitions] == [[chart.step("A").id], [chart.step("C").id]]
    assert [step.name for step in chart.steps] == ["B", "C", "A"]  # what was given is as it was


@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_code_is_proven_to_do_the_same(construction: str, language: str) -> None:
    lowered = lower(gate(), construction, language=language, profile="beremiz")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)
    tested = lower(timed(), construction, language=language, profile="beremiz", cap=500, runs=5)
    assert tested.proof is not None
    assert tested.proof.equal, str(tested.proof)


def test_the_two_ways_are_different() -> None:
    assert equivalent(timed(), timed(), ("iec", "beremiz"), cap=500).kind is VerdictKind.DIFFERENT


def test_boxes_are_late_where_they_are_executed_in_every_scan() -> None:
    with pytest.raises(ModelError, match="every scan"):
        replace(PROFILES["iec"], drawn_blocks=DrawnBlocks.EVERY_SCAN)
