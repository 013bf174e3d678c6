"""Charts that are written as they are read."""

from __future__ import annotations

from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import jump, selection, simultaneous, step, transition
from plcopen_sfc.errors import ModelError

FILLING = (
    step("Wait", initial=True),
    "Start",
    step("Fill", actions=["N Valve", "D T#2s Lamp"], max_time="T#30s"),
    selection(
        ["Full AND Level > 5", simultaneous([step("Heat"), "Hot", step("Keep")], [step("Mix")]), "Done"],
        ["Stop", jump("Wait")],
    ),
    step("Drain", actions=[("N Pour", "Pump := NOT Empty;")]),
    "Empty",
    jump("Wait"),
)
LABELS = [
    "Wait -> Fill",
    "Fill -> Heat+Mix",
    "Heat -> Keep",
    "Keep+Mix -> Drain",
    "Fill -> Wait",
    "Drain -> Wait",
]


def test_a_chart_is_written_as_it_is_read() -> None:
    project = sfc.Project(name="Plant")
    pou = project.add_program("Main", *FILLING)
    chart = pou.chart
    assert chart is not None
    assert list(chart.labels().values()) == LABELS
    assert [each.name for each in chart.steps] == ["Wait", "Fill", "Heat", "Keep", "Mix", "Drain"]
    fill = chart.step("Fill")
    assert ([each.text for each in fill.actions], fill.max_time) == (["N Valve", "D T#2s Lamp"], "T#30s")
    assert chart.outgoing(fill)[0].condition == sfc.Expression(text="Full AND Level > 5")
    ids = [each.id for each in (*chart.steps, *chart.transitions)] + [a.id for _, a in chart.associations()]
    assert len(ids) == len(set(ids))


def test_what_it_names_is_declared_once() -> None:
    project = sfc.Project(name="Plant")
    project.global_variables.append(sfc.VariableSection(variables=[sfc.Variable(name="Stop", type="BOOL")]))
    pou = project.add_program("Main", *FILLING)
    inputs, outputs = (
        [v.name for v in pou.variables(kind)] for kind in (sfc.SectionKind.INPUT, sfc.SectionKind.OUTPUT)
    )
    assert inputs == ["Start", "Full", "Hot", "Done", "Empty"]  # Stop is global, the type of Level is not known
    assert outputs == ["Valve", "Lamp"]
    assert pou.action("Pour").body == sfc.StBody(text="Pump := NOT Empty;")


def test_steps_and_counters_of_a_sequencer_are_no_boolean_outputs() -> None:
    """A step that ON named was declared as an output too, so that the step got another name in TIA Portal."""
    rows = ["NC Motor", "S1 CU Parts", "S1 ON Rinse", "CALL Log"]
    parts = [step("Wait", initial=True), "Start", step("Fill", actions=rows, interlock="Guard", supervision="NOT Flow")]
    pou = sfc.Project().add_function_block("Filler", *parts, "Full", step("Rinse"))
    found = {(v.name, v.type.name, section.kind) for section in pou.interface.sections for v in section.variables}
    inputs = {(name, "BOOL", "input") for name in ("Start", "Full", "Guard", "Flow")}
    assert found == {*inputs, ("Motor", "BOOL", "output"), ("Parts", "INT", "local")}


@pytest.mark.parametrize("format", ["plcopen", "codesys", "iec-text", "json"])
def test_the_chart_goes_into_files_and_does_the_same(format: str) -> None:
    project = sfc.Project(name="Plant")
    pou = project.add_program("Main", *FILLING)
    pou.add_variable("Level", "INT", "input")
    pou.add_variable("Pump")
    again = sfc.loads(sfc.dumps(project, format=format, partial=True))
    assert sorted(again.pou("Main").chart.labels().values()) == sorted(LABELS)


def test_it_runs() -> None:
    project = sfc.Project()
    project.add_program("Main", step("A", initial=True, actions=["N Q"]), "Go", step("B"), "NOT Go", jump("A"))
    trace = sfc.simulate(project, pou="Main", inputs=sfc.RandomInputs(1), scans=20)
    assert {"A", "B"} == {name for scan in range(20) for name in trace.active(scan)}


def test_a_sequence_goes_on_after_a_step() -> None:
    chart = sfc.SfcNetwork()
    chart.add_sequence(step("A", initial=True), transition("x", name="t1", priority=2), step("B"))
    chart.add_sequence("y", step("C"), "z", jump("a"), after="A")
    assert list(chart.labels().values()) == ["t1", "A -> C", "C -> A"]
    assert chart.transition("t1").priority == 2
    assert [each.name for each in chart.step("A").successors] == ["B", "C"]


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (["x"], "the condition 'x' needs a step before it"),
        ([step("A"), step("B")], "the step 'B' is behind a step"),
        ([step("A"), "x"], "ends with a step or a jump"),
        ([step("A"), "x", "y"], "the condition 'y' needs a step before it"),
        ([step("A"), "x", jump("B")], "no step 'B'"),
        ([step("A"), "x", jump("A"), "y"], "behind a jump"),
        ([step("A"), jump("A")], "needs a condition"),
        ([step("A"), selection(["x", step("B")]), "y", jump("A")], "ends with a condition or a jump"),
        ([step("A"), "x", simultaneous(["y"], [step("B")])], "begins with a step"),
        ([step("A"), "x", simultaneous([step("B"), "y"], [step("C")])], "ends with a step"),
        ([step("A"), simultaneous([step("B")])], "need a condition"),
        ([step("A"), "x", step("a")], "has a step 'a' already"),
        ([step("A", maxtime="T#1s")], "did you mean 'max_time'"),
        ([step("A", max_time="5 s")], "cannot be '5 s'"),
        ([step("A", actions=["N Y", ("N Pour", "x := 1;")]), 5], "5 is no part of a chart"),
        ([step("A", actions=["D Lamp"])], "is no action"),
    ],
)
def test_a_part_out_of_place_changes_nothing(parts: list[Any], message: str) -> None:
    project = sfc.Project()
    pou = project.add_program("Main", step("Z", initial=True))
    before = project.model_dump()
    with pytest.raises(ModelError, match=message):
        pou.chart.add_sequence(*parts)  # type: ignore[union-attr]
    assert project.model_dump() == before
    with pytest.raises(ModelError, match=message):
        project.add_program("Other", *parts)
    assert project.model_dump() == before


def test_names_that_are_taken_are_refused() -> None:
    project = sfc.Project()
    pou = project.add_program("Main", step("A", initial=True, actions=["N Valve"]))
    with pytest.raises(ModelError, match="has a POU 'main' already"):
        project.add_function_block("main")
    with pytest.raises(ModelError, match="POU Main has a 'valve' already"):
        pou.add_variable("valve")


def test_a_text_is_the_condition_of_an_interlock() -> None:
    chart = sfc.SfcNetwork()
    made = chart.add_step("A", interlock="NOT Fault")
    made.supervision = "Level > 9"  # type: ignore[assignment]
    assert made.interlock == sfc.Supervised(condition="NOT Fault")  # type: ignore[arg-type]
    assert made.supervision.condition == sfc.Expression(text="Level > 9")  # type: ignore[union-attr]
