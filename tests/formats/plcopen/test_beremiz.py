"""Files for Beremiz and OpenPLC: what their converters do not see is written in other words."""

from __future__ import annotations

from dataclasses import replace

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


TIMED = b"""PROGRAM Main
VAR_INPUT go : BOOL; END_VAR
VAR_OUTPUT q : BOOL; late : BOOL; n : INT; END_VAR
INITIAL_STEP S1: Watch(N); END_STEP
STEP S2: Watch(N); END_STEP
STEP S3: Watch(N); END_STEP
TRANSITION FROM S1 TO S2 := go; END_TRANSITION
TRANSITION FROM S2 TO S3 := S2.T >= T#30ms; END_TRANSITION
TRANSITION FROM S3 TO S1 := NOT go; END_TRANSITION
ACTION Watch:
    q := S2.T > T#10ms;
    late := S1.T >= T#40ms AND S3.X;
    n := n + 1;
END_ACTION
END_PROGRAM
"""


def test_times_of_steps_are_variables_in_actions() -> None:
    """The compiler knows ``S2.T`` behind the step only, and its parser may not end where it does not."""
    source = sfc.loads(TIMED, format="iec-text")
    data, report = sfc.convert(source, "plcopen", flavour="beremiz")
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    read = sfc.loads(data, as_tool=True)
    texts = [action.body.text for action in read.pou("Main").actions]
    assert not [text for text in texts if ".T" in text.replace(".T)", "")]
    assert "S2_time > T#10ms" in "".join(texts)
    conditions = [transition.condition.text for transition in read.pou("Main").sfc.transitions]
    assert "S2.T >= T#30ms" in conditions

    def pulses(scan: int, _: object) -> dict[str, bool]:
        return {"go": scan % 17 in (3, 4, 5, 6, 9, 10)}

    runs = [
        sfc.simulate(each, pou="Main", scans=120, inputs=pulses, record=["q", "late", "n"], profile=rules)
        for each, rules in ((source, replace(PROFILES["iec"], final_scan=False)), (read, PROFILES["beremiz"]))
    ]
    assert [runs[0][name] for name in ("q", "late", "n")] == [runs[1][name] for name in ("q", "late", "n")]
    assert any(runs[0]["q"])
    assert any(runs[0]["late"])


ENDS = b"""PROGRAM Main
VAR_INPUT go : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO (S1, S2) := go; END_TRANSITION
STEP S1: END_STEP
STEP S2: q(N); END_STEP
TRANSITION FROM (S1, S2) TO S0 := S2.T >= T#30ms; END_TRANSITION
END_PROGRAM
"""


def test_the_time_of_a_step_at_the_end_of_simultaneous_sequences_comes_one_scan_later() -> None:
    """The converter writes the transition behind the first sequence, before the steps of the second."""
    source = sfc.loads(ENDS, format="iec-text")
    data, report = sfc.convert(source, "plcopen", flavour="beremiz")
    (told,) = [item for item in report.losses if item.what == "transition"]
    assert (told.outcome, told.path) == (Outcome.APPROXIMATED, "POU Main / transition S1+S2 -> S0")
    assert "the time of another step one scan later" in told.why
    read = sfc.loads(data, as_tool=True)
    runs = [
        sfc.simulate(
            each, pou="Main", scans=20, inputs=lambda scan, _: {"go": scan == 2}, record=["q"], profile="beremiz"
        )
        for each in (source, read)
    ]
    assert [run["q"].count(True) for run in runs] == [3, 4]


OPERANDS = [
    m.InputPin(expression="q"),
    m.InputPin(connections=[m.Connection(source=6)]),
]


@pytest.mark.parametrize(
    ("names", "pin"), [(("In1", "In2", "Out1"), OPERANDS[1]), (("IN1", "IN2", "OUT"), OPERANDS[0])]
)
def test_pins_that_the_converter_does_not_see_become_statements(
    project: sfc.Project, names: tuple[str, str, str], pin: m.InputPin
) -> None:
    """It ends with an error at an output that is not called OUT, and leaves out an operand that is written at a pin."""
    wire = m.InputPin(connections=[m.Connection(source=7)])
    block = m.Block(
        id=8,
        type_name="AND",
        parameters=m.BlockParameters(
            inputs=[m.BlockVariable(name=names[0], input=pin), m.BlockVariable(name=names[1], input=wire)],
            outputs=[m.BlockVariable(name=names[2], output=m.OutputPin())],
        ),
    )
    nodes = [
        m.InputVariable(id=6, expression="q", output=m.OutputPin()),
        m.InputVariable(id=7, expression="a", output=m.OutputPin()),
        block,
        m.OutputVariable(id=9, expression="q", input=m.InputPin(connections=[m.Connection(source=8, pin=names[2])])),
    ]
    project.pou("Empty").bodies = [m.FbdBody(networks=[m.LogicNetwork(nodes=nodes)])]
    project.pou("Empty").interface.sections[0].variables.append(m.Variable(name="q", type="BOOL"))
    seen, report = converted(project)
    assert seen.pou("Empty").body.text == "q := q AND a;"
    assert ("body", "FBD became statements") in [(item.what, item.why) for item in report.items]


@pytest.mark.parametrize(
    ("names", "written"),
    [(("Configuration", "Resource"), ("x_Configuration", "x_Resource")), (("PLC", "A"), ("PLC_1", "A"))],
)
def test_configurations_are_not_called_by_keywords(
    project: sfc.Project, names: tuple[str, str], written: tuple[str, str]
) -> None:
    """``ON PLC`` is the type of each resource, which a configuration of that name hides."""
    project.configurations[0].name, project.configurations[0].resources[0].name = names
    seen, _ = converted(project)
    assert (seen.configurations[0].name, seen.configurations[0].resources[0].name) == written


STRUCTURES = b"""TYPE Part : STRUCT length : INT; END_STRUCT; END_TYPE
TYPE Parts : ARRAY [0..3] OF Part; END_TYPE
FUNCTION Long : BOOL VAR_INPUT p : Part; END_VAR Long := p.length > 9; END_FUNCTION
PROGRAM Main
VAR a : Part; b : Part; list : ARRAY [0..3] OF Part; n : INT; END_VAR
a := b; n := a.length;
END_PROGRAM
PROGRAM Plain VAR a : Part; n : INT; END_VAR n := a.length; END_PROGRAM
"""


def test_structures_that_openplc_makes_function_blocks_of_are_told() -> None:
    report = sfc.convert(sfc.loads(STRUCTURES, format="iec-text"), "plcopen", flavour="beremiz").report
    told = {item.path: item for item in report.losses if item.what == "structure"}
    assert {item.outcome for item in told.values()} == {Outcome.APPROXIMATED}
    found = {path: item.why.rpartition(": ")[2] for path, item in told.items()}
    assert found == {
        "data type Parts": "Parts",
        "POU Long": "p",
        "POU Main": "list, a",
    }
    assert not sfc.convert(sfc.loads(STRUCTURES, format="iec-text"), "iec-text", flavour="matiec").report.losses


STARTS = b"""PROGRAM Main
VAR_INPUT a : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
VAR delay : TON := (PT := T#50ms); END_VAR
delay(IN := a); q := delay.Q;
END_PROGRAM
"""


def test_start_values_of_instances_are_statements_of_the_first_scan() -> None:
    """The converter leaves them out without a word."""
    source = sfc.loads(STARTS, format="iec-text")
    data, report = sfc.convert(source, "plcopen", flavour="beremiz")
    read = sfc.loads(data, as_tool=True)
    assert not report.losses
    assert all(variable.initial is None for variable in read.pou("Main").variables())
    runs = [
        sfc.simulate(each, pou="Main", scans=20, inputs=lambda *_: {"a": True}, record=["q"]) for each in (source, read)
    ]
    assert runs[0]["q"] == runs[1]["q"]
    assert runs[0]["q"].count(True) in range(1, 19)


def test_start_values_that_no_statement_can_give_are_not_executed() -> None:
    text = STARTS.replace(b"VAR delay", b"VAR RETAIN delay")
    report = sfc.convert(sfc.loads(text, format="iec-text"), "plcopen", flavour="beremiz", partial=True).report
    (told,) = report.with_outcome(Outcome.NOT_EXECUTED)
    assert (told.what, told.path) == ("initial", "POU Main / variable delay")
