"""Files for Beremiz and OpenPLC: what their converters do not see is written in other words."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import equivalent
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.profile import PROFILES, default_profile
from tests.conversion.features import FEATURES, feature_project

TEXT = b"""PROGRAM Main
VAR a : BOOL; q : BOOL; r : BOOL; n : INT; w : STRING := 'x'; END_VAR
INITIAL_STEP S1: q(N); END_STEP
STEP S2: Count(N); q(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := Ready; END_TRANSITION
TRANSITION Ready := S2.T > T#1s; END_TRANSITION
ACTION Count: IF a THEN n := n + 1; END_IF // counts
END_ACTION
END_PROGRAM
FUNCTION_BLOCK Empty
VAR_INPUT a : BOOL; END_VAR
END_FUNCTION_BLOCK
CONFIGURATION Plant
RESOURCE Plant ON PLC
TASK Main(INTERVAL := T#0s, PRIORITY := 0);
PROGRAM Main WITH Main : Main;
END_RESOURCE
END_CONFIGURATION
"""


@pytest.fixture
def project() -> sfc.Project:
    return sfc.loads(TEXT, format="iec-text")


def converted(project: sfc.Project) -> tuple[sfc.Project, sfc.ConversionReport]:
    data, report = sfc.convert(project, "plcopen-2.01", flavour="beremiz", partial=True)
    return sfc.loads(data, as_tool=True), report


def test_texts_are_those_that_the_compiler_takes(project: sfc.Project) -> None:
    seen, report = converted(project)
    assert not report.with_outcome(Outcome.NOT_EXECUTED, Outcome.DROPPED)
    assert seen.pou("Main").action("Count").body.text == "IF a THEN n := n + 1; END_IF; (* counts *)"
    assert seen.pou("Empty").body.text == "idle := FALSE;"
    assert [t.condition.text for t in seen.pou("Main").sfc.transitions] == ["a", "S2.T > T#1s"]


def test_every_name_is_there_once(project: sfc.Project) -> None:
    seen, report = converted(project)
    (configuration,) = seen.configurations
    (resource,) = configuration.resources
    (task,) = resource.tasks
    names = [configuration.name, resource.name, task.name, task.instances[0].name]
    assert len({name.casefold() for name in (*names, "Main")}) == 5
    assert task.instances[0].type_name == "Main"
    assert {item.path for item in report.with_outcome(Outcome.TRANSLATED) if item.what == "name"} >= {"resource Plant"}


@pytest.mark.parametrize(
    ("interval", "written"), [("PT0S", "T#20ms"), ("PT1.5S", "T#1500ms"), ("00:00:00.100000", "T#100ms")]
)
def test_an_interval_is_a_literal_and_not_zero(project: sfc.Project, interval: str, written: str) -> None:
    project.configurations[0].resources[0].tasks[0].interval = interval
    seen, report = converted(project)
    assert seen.configurations[0].resources[0].tasks[0].interval == written
    told = [item.why for item in report.losses if item.what == "interval"]
    assert told == (["none is set, and matiec wants one: 20 ms"] if interval == "PT0S" else [])


def test_negations_are_written_out(project: sfc.Project) -> None:
    chart = project.pou("Main").sfc
    chart.transitions[0].condition = m.Expression(text="a", negated=True)
    wire = m.Connection(source=50)
    chart.logic = [m.InputVariable(id=50, expression="q AND r", negated=True, output=m.OutputPin())]
    chart.transitions[1].condition = m.WiredCondition(input=m.InputPin(connections=[wire]))
    seen, _ = converted(project)
    conditions = [transition.condition for transition in seen.pou("Main").sfc.transitions]
    assert conditions[0] == m.Expression(text="NOT (a)")
    texts = [node.expression for node in seen.pou("Main").sfc.logic] + [getattr(conditions[1], "text", "")]
    assert "NOT (q AND r)" in texts
    assert not any(getattr(part, "negated", False) for part in (*conditions, *seen.pou("Main").sfc.logic))


def test_a_chart_in_an_action_that_executes_itself_does_not_compile(project: sfc.Project) -> None:
    project.pou("Main").actions[0].body = m.SfcBody(chart=project.pou("Main").sfc.model_copy(deep=True))
    seen, report = converted(project)
    assert {item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)} == {"chart", "body"}
    assert seen.pou("Main").action("Count").body.text == "NOT_EXECUTED_Count := TRUE;"


def test_flags_of_steps_are_variables(project: sfc.Project) -> None:
    """The converter writes an action before the steps that come after the one it belongs to."""
    seen, _ = converted(project)
    logic = seen.pou("Main").action("ChartLogic").body.text
    assert "S1_flag OR S2_flag" in logic
    assert {a.target for _, a in seen.pou("Main").sfc.associations()} == {"ChartLogic", "Count", "S1_flag", "S2_flag"}


@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_a_drawn_action_is_not_executed_once_more_after_its_end(language: str) -> None:
    feature = next(each for each in FEATURES if each.name == f"action in {language}")
    for source in ("plcopen", "codesys"):
        original = sfc.loads(sfc.dumps(feature_project(feature, source), format=source), format=source)
        report = sfc.convert(original, "plcopen-2.01", flavour="beremiz").report
        found = [(item.what, item.path) for item in report.losses]
        read = [("inputs of actions", "POU Main")] if source == "codesys" else []
        assert found == [("action", "POU Main / action Count"), *read]


def test_values_of_strings_are_texts_in_files_of_beremiz(project: sfc.Project) -> None:
    """Its converter puts quotes around each value of a string, also around one that is the name of a variable."""
    project.header.product = "Beremiz"
    project.data_types = [m.DataTypeDeclaration(name="Text", type=m.StringType())]
    variables = project.pou("Main").variables()
    (w,) = (v for v in variables if v.name == "w")
    w.initial = m.SimpleValue(text="two words")
    variables[0].type, variables[0].initial = m.DerivedType(name="Text"), m.SimpleValue(text="q")
    data = sfc.dumps(project, format="plcopen", fresh=True, partial=True)
    assert b'value="two words"' in data
    read = sfc.loads(data)
    values = {v.name: v.initial.text for v in read.pou("Main").variables() if isinstance(v.initial, m.SimpleValue)}
    assert values == {"a": "'q'", "w": "'two words'"}
    for target in ("codesys", "codesys-export", "codesys23", "iec-text", "scl", "simaticml"):
        report = sfc.convert(read, target, partial=True).report
        assert not [item for item in report.losses if item.what in ("initial value", "undeclared name", "text")], target
    assert sfc.dumps(read) == data
    read.rename("Main", "Pump")
    lines, edited = data.splitlines(), sfc.dumps(read).splitlines()
    assert [line for line in edited if line not in lines and b"Pump" not in line] == []


@pytest.mark.parametrize("source", ["codesys", "simaticml", "plcopen"])
def test_a_written_file_runs_by_the_rules_of_beremiz(source: str) -> None:
    """The action of a step that was left is executed once more by IEC 61131-3, and not by matiec."""
    feature = next(each for each in FEATURES if each.name == "condition: step time")
    data, report = sfc.convert(feature_project(feature, source), "plcopen", flavour="beremiz", partial=True)
    for as_tool in (False, True):
        read = sfc.loads(data, as_tool=as_tool)
        assert default_profile(read).name == "beremiz"
    assert [item.outcome for item in report.items if item.what == "header"] == [Outcome.TRANSLATED]
    again, told = sfc.convert(read, "plcopen", flavour="beremiz", partial=True)
    assert not [item for item in told.items if item.what == "header"]
    assert default_profile(sfc.loads(again)).name == "beremiz"


def test_a_simulation_of_a_written_file_does_what_the_comparison_of_the_conversion_did() -> None:
    text = TEXT.replace(b"q(N); END_STEP\nSTEP S2: Count(N); q(N)", b"END_STEP\nSTEP S2: Count(N)").replace(
        b"IF a", b"IF TRUE"
    )
    data, _ = sfc.convert(sfc.loads(text, format="iec-text"), "plcopen", flavour="beremiz", partial=True)
    read = sfc.loads(data)

    def pulse(scan: int, _: object) -> dict[str, bool]:
        return {"a": scan == 0}

    counts = [
        sfc.simulate(read, pou="Main", scans=150, inputs=pulse, record=["n"], **given)["n"][-1]
        for given in ({}, {"profile": "beremiz"}, {"profile": "iec"})
    ]
    assert counts[0] == counts[1] == counts[2] - 1


LEFT_APART = b"""PROGRAM Main
VAR_INPUT a : BOOL; b : BOOL; c : BOOL; r : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO (S1, S2) := a; END_TRANSITION
STEP S1: END_STEP
STEP S2: q(N); END_STEP
STEP S3: END_STEP
TRANSITION FROM (S1, S2) TO S0 := r; END_TRANSITION
TRANSITION FROM S1 TO S3 := b; END_TRANSITION
TRANSITION FROM (S3, S2) TO S0 := c; END_TRANSITION
END_PROGRAM
"""


def test_simultaneous_convergences_begin_at_steps_that_have_other_transitions() -> None:
    """The converter takes what a convergence is wired to for a step, and ends with an error at a divergence."""
    source = sfc.loads(LEFT_APART, format="iec-text")
    data, report = sfc.convert(source, "plcopen", flavour="beremiz")
    assert report.losses == []
    read = sfc.loads(data, as_tool=True)
    symbols = {symbol.id: symbol for symbol in read.pou("Main").sfc.drawing.symbols}
    bars = [each for each in symbols.values() if each.kind is m.SymbolKind.SIMULTANEOUS_CONVERGENCE]
    above = [symbols[wire.source].kind for bar in bars for pin in bar.inputs for wire in pin.connections]
    assert above == [m.SymbolKind.STEP] * 4
    wired = {wire.source for symbol in symbols.values() for pin in symbol.inputs for wire in pin.connections}
    assert {each.id for each in symbols.values() if each.kind is m.SymbolKind.SELECTION_DIVERGENCE} <= wired
    rules = (PROFILES["iec"], PROFILES["iec"])
    assert equivalent(source.pou("Main"), read.pou("Main"), rules, outputs=["q"]).proven
