"""Charts of other tools in TIA Portal: parts that no row or network expresses are reported, and not written."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.formats.simaticml.graph_conditions import NOT_TRANSLATED
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.network import Connection as Wire
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.simulation import simulate
from tests.conversion.features import drawn
from tests.formats.simaticml.documents import parsed
from tests.formats.simaticml.official import official, outer_parts, without_namespace

BOOL = m.ElementaryType(name=m.Elementary.BOOL)
INT = m.ElementaryType(name=m.Elementary.INT)
Row = tuple[str, str, str | None, str | None]


def variables(kind: m.SectionKind, names: str, type_: m.DataType = BOOL) -> m.VariableSection:
    return m.VariableSection(kind=kind, variables=[m.Variable(name=name, type=type_) for name in names.split()])


def project_with(
    *actions: m.ActionAssociation, condition: m.Condition | str | None = "go", **step: object
) -> m.Project:
    """Steps Idle and Run, of which Run has the actions; between them the conditions `condition` and ``stop``."""
    chart = m.SfcNetwork()
    idle, run = chart.add_step("Idle", initial=True), chart.add_step("Run")
    run.actions = list(actions)
    for name, value in step.items():
        setattr(run, name, value)
    chart.add_transition(idle, run, condition)  # type: ignore[arg-type]  # a plain string is an expression
    chart.add_transition(run, idle, "stop")
    interface = m.Interface(
        sections=[
            variables(m.SectionKind.INPUT, "go stop a b"),
            variables(m.SectionKind.OUTPUT, "q r"),
            variables(m.SectionKind.LOCAL, "level n", INT),
        ]
    )
    pou = m.Pou(name="Seq", kind=m.PouKind.FUNCTION_BLOCK, interface=interface, bodies=[m.SfcBody(chart=chart)])
    texts = {
        "Set": "q := TRUE; level := n;",
        "Clear": "q := FALSE;",
        "Sum": "level := level + 1;",
        "Choose": "IF a THEN q := b; END_IF;",
        "Nothing": "// later\n",
    }
    pou.actions = [m.Action(name=name, body=m.StBody(text=text)) for name, text in texts.items()]
    pou.actions.append(m.Action(name="Chart", body=m.SfcBody(chart=m.SfcNetwork())))
    project = m.Project(name="Line", pous=[pou], dialect=m.Dialect.CODESYS)
    project.header.product = "CODESYS"
    return project


def converted(project: m.Project) -> tuple[bytes, ConversionReport]:
    """A file for TIA Portal; it fits the published schemas and comes back whole."""
    before = project.model_copy(deep=True)
    data, report = sfc.convert(project, "simaticml", partial=True)
    assert list(differences(project, before)) == []
    assert report.with_outcome(Outcome.DROPPED) == []
    for kind, number, part in outer_parts(parsed(data)):
        official(kind, number).assertValid(without_namespace(part))
    return data, report


def rows(data: bytes, step: str = "Run") -> list[Row]:
    chart = sfc.loads(data, as_tool=True).pous[0].sfc
    assert chart is not None
    return [(a.qualifier.value, a.event or "", a.target, a.value) for a in chart.step(step).actions]


def lost(report: ConversionReport, what: str) -> Sequence[str]:
    return [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == what]


def action(qualifier: str, target: str | None = None, **fields: object) -> m.ActionAssociation:
    return m.ActionAssociation.model_validate({"id": 90, "qualifier": qualifier, "target": target, **fields})


def test_step_actions_of_single_assignments_are_rows_with_events() -> None:
    project = project_with(action("N", "r"), entry_action="Set", main_action="Set", exit_action="Clear")
    data, report = converted(project)
    both: list[Row] = [("N", "", "#q", "TRUE"), ("N", "", "#level", "#n")]
    entry: list[Row] = [(q, "S1", t, v) for q, _, t, v in both]
    assert rows(data) == [*entry, *both, ("N", "", "#r", None), ("N", "S0", "#q", "FALSE")]
    assert [item.outcome for item in report.items if item.what in ("entry action", "main action", "exit action")] == [
        Outcome.TRANSLATED
    ] * 3
    back = sfc.loads(data).pous[0].sfc
    assert back is not None
    run = back.step("Run")
    assert (run.entry_action, run.main_action, run.exit_action) == ("#Set", "#Set", "#Clear")
    assert [each.target for each in run.actions] == ["#r"], "the rows of step actions are no associations"


@pytest.mark.parametrize("kind", ["entry_action", "main_action", "exit_action"])
def test_other_step_actions_are_not_written(kind: str) -> None:
    data, report = converted(project_with(**{kind: "Chart"}))
    assert rows(data) == []
    (why,) = lost(report, kind.replace("_", " "))
    assert why.startswith("`Chart` is not executed: ")


def test_step_actions_of_more_statements_are_functions() -> None:
    """A function for each action, whoever calls it, with the variables it names, and a name of its own."""
    project = project_with(entry_action="Choose", main_action="Sum", exit_action="Choose")
    project.pous.append(m.Pou(name="SEQ_SUM", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.StBody(text=";")]))
    data, report = converted(project)
    assert {item.what for item in report.losses} == {"inputs of actions"}
    seen = sfc.loads(data, as_tool=True)
    chart = seen.pou("Seq").chart
    assert chart is not None
    called = [(row.event or "", row.body.text) for row in chart.step("Run").actions if isinstance(row.body, m.StBody)]
    choose = '"Seq_Choose"(a := #a, b := #b, q := #q);'
    assert called == [("S1", choose), ("", '"Seq_Sum_2"(level := #level);'), ("S0", choose)]
    function = seen.pou("Seq_Choose")
    assert isinstance(function.body, m.StBody)
    assert function.body.text == "IF #a THEN #q := #b; END_IF;"
    passed = {kind: [v.name for v in function.variables(kind)] for kind in (m.SectionKind.INPUT, m.SectionKind.IN_OUT)}
    assert passed == {m.SectionKind.INPUT: ["a", "b"], m.SectionKind.IN_OUT: ["q"]}
    assert [pou.name for pou in sfc.loads(data).pous] == ["Seq", "SEQ_SUM"], "it comes back as an action"


@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_networks_of_more_statements_are_functions(language: str) -> None:
    project = project_with(action("N", "Sum"))
    project.pous[0].actions[2].body = drawn("q := a AND NOT b; level := level + 1;", language, m.Dialect.CODESYS)
    data, report = converted(project)
    assert {item.what for item in report.losses} == {"inputs of actions"}
    assert rows(data) == [("CALL", "", None, None), ("CALL", "S0", None, None)]
    back = sfc.loads(data).pous[0].find_action("Sum")
    assert back is not None
    assert back.body is not None
    assert back.body.language == language


def test_an_edit_of_the_written_file_goes_into_the_function() -> None:
    data, _ = sfc.convert(project_with(entry_action="Choose"), "simaticml")
    written = sfc.loads(data)
    written.pou("Seq").title = "other"
    titled = sfc.dumps(written)
    assert len(titled.splitlines()) - len(data.splitlines()) < 15
    assert "Seq_Choose" in [pou.name for pou in sfc.loads(titled, as_tool=True).pous]
    written.pou("Seq").action("Choose").body = m.StBody(text="IF #b THEN #q := #b; END_IF;")
    seen = sfc.loads(sfc.dumps(written), as_tool=True)
    assert seen.pou("Seq_Choose").body == m.StBody(text="IF #b THEN #q := #b; END_IF;")
    assert [row.event for row in seen.pou("Seq").chart.step("Run").actions if row.body] == ["S1"]


def test_an_edited_function_is_what_the_step_calls() -> None:
    data, _ = sfc.convert(project_with(entry_action="Sum", actions=[]), "simaticml")
    edited = data.replace(b">1</ConstantValue>", b">2</ConstantValue>")
    assert edited != data
    back = sfc.loads(edited)
    chart = back.pou("Seq").chart
    assert chart is not None
    assert chart.step("Run").entry_action is None
    (row,) = chart.step("Run").actions
    assert row.body == m.StBody(text='"Seq_Sum"(level := #level);')
    assert back.pou("Seq_Sum").body == m.StBody(text="#level := #level + 2;")
    assert {"XML213", "XML214"} <= {each.code for each in back.diagnostics}


BODIES = [
    ("P1", "Set", Outcome.TRANSLATED, [("N", "S1", "#q", "TRUE"), ("N", "S1", "#level", "#n")]),
    ("P0", "Clear", Outcome.TRANSLATED, [("N", "S0", "#q", "FALSE")]),
    ("N", "Clear", Outcome.TRANSLATED, [("N", "", "#q", "FALSE"), ("N", "S0", "#q", "FALSE")]),
    ("P", "Clear", Outcome.TRANSLATED, []),
    ("N", "Nothing", Outcome.APPROXIMATED, []),
    *((q, "Clear", Outcome.TRANSLATED, []) for q in ("S", "R", "L", "D", "SD", "DS", "SL")),
    ("P1", "Choose", Outcome.TRANSLATED, [("CALL", "S1", None, None)]),
    ("P0", "Choose", Outcome.TRANSLATED, [("CALL", "S0", None, None)]),
    ("N", "Choose", Outcome.TRANSLATED, [("CALL", "", None, None), ("CALL", "S0", None, None)]),
    ("P", "Choose", Outcome.TRANSLATED, []),
    ("N", "Chart", Outcome.NOT_EXECUTED, []),
]


@pytest.mark.parametrize(("qualifier", "name", "outcome", "expected"), BODIES)
def test_associations_with_actions(qualifier: str, name: str, outcome: Outcome, expected: list[Row]) -> None:
    project = project_with(action(qualifier, name, duration="T#1s" if set(qualifier) & set("LD") else None))
    data, report = converted(project)
    assert rows(data) == expected
    (item,) = [item for item in report.items if item.what == "action" and f"action {name}" in item.path]
    assert item.outcome is (Outcome.TRANSLATED if name == "Nothing" else outcome)
    assert item.path == f"POU Seq / step Run / action {name}"
    back = sfc.loads(data).pous[0].sfc
    assert back is not None
    (association,) = back.step("Run").actions
    assert (association.qualifier.value, association.target) == (qualifier, f"#{name}")


def test_a_qualifier_that_graph_does_not_have_is_no_other() -> None:
    data, report = converted(project_with(action("DL", "q", duration="T#1s")))
    assert rows(data) == []
    assert lost(report, "action") == ["`q` is not executed: S7-GRAPH has no qualifier DL"]


@pytest.mark.parametrize(
    "fields",
    [
        {"target": None, "body": {"language": "ST", "text": "IF b THEN a := TRUE; END_IF;"}},
        {"value": "a AND b"},
        {"kind": "onEvent"},
    ],
)
def test_what_a_row_cannot_say_is_not_written(fields: dict[str, object]) -> None:
    data, report = converted(project_with(action("N", **{"target": "q", **fields})))  # type: ignore[arg-type]
    assert rows(data) == []
    assert len(lost(report, "action")) == 1


def test_instruction_list_of_one_assignment_is_a_row_and_its_final_scan() -> None:
    data, report = converted(project_with(action("N", body={"language": "IL", "text": "LD a\nST q"})))
    assert rows(data) == [("N", "", "#q", "#a"), ("N", "S0", "#q", "#a")]
    assert not report.with_outcome(Outcome.NOT_EXECUTED)


def test_actions_of_instances_are_their_statements() -> None:
    project = project_with(action("N", "motor.Stop"), action("N", "motor.on", id=91))
    motor = m.Pou(name="Motor", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.StBody(text=";")])
    motor.interface = m.Interface(sections=[variables(m.SectionKind.INPUT, "on")])
    motor.actions = [m.Action(name="Stop", body=m.StBody(text="on := FALSE;"))]
    project.pous.append(motor)
    instance = m.Variable(name="motor", type=m.DerivedType(name="Motor"))
    assert project.pous[0].interface is not None
    project.pous[0].interface.sections[2].variables.append(instance)
    data, report = converted(project)
    stop = [("N", "", "#motor.on", "FALSE"), ("N", "S0", "#motor.on", "FALSE")]
    assert rows(data) == [*stop, ("N", "", "#motor.on", None)]
    assert not report.with_outcome(Outcome.NOT_EXECUTED)


def test_actions_and_methods_that_no_step_has_are_told() -> None:
    project = project_with(action("N", "Choose"))
    project.pous.append(m.Pou(name="Caller", kind=m.PouKind.PROGRAM, bodies=[m.StBody(text="seq.Sum(); seq.Set();")]))
    project.pous[0].methods = [m.Method(name="FB_Init", body=m.StBody(text="q := FALSE;"))]
    _, report = converted(project)
    told = {item.path for item in report.with_outcome(Outcome.NOT_EXECUTED)}
    assert {"POU Seq / method FB_Init", "POU Seq / action Sum", "POU Seq / action Set"} <= told
    assert "POU Seq / action Choose" not in told, "the step with it is told"


# -- conditions


def coil_inputs(data: bytes, result: str = "TrCoil") -> list[str]:
    """The conditions of the transitions, as TIA Portal sees them: names of contacts, "TRUE" for none."""
    found: list[str] = []
    chart = sfc.loads(data, as_tool=True).pous[0].sfc
    assert chart is not None
    for transition in chart.transitions:
        condition = transition.condition
        if isinstance(condition, m.Expression):
            found.append(condition.text)
        else:
            assert isinstance(condition, m.BodyCondition)
            assert isinstance(condition.body, m.LdBody | m.FbdBody)
            nodes = condition.body.networks[0].nodes
            found.append(" ".join(str(node.variable) for node in nodes if isinstance(node, m.Contact)))
    return found


@pytest.mark.parametrize(
    "condition",
    [
        None,
        m.Expression(text="a AND"),
        m.Expression(text="a = b := c"),
        m.BodyCondition(body=m.IlBody(text="LD a\nJMPC x")),
        m.BodyCondition(body=m.StBody(text="IF a THEN q := b; END_IF;")),
        m.WiredCondition(input=m.InputPin()),
    ],
)
def test_a_condition_that_cannot_be_written_does_not_compile(condition: m.Condition | None) -> None:
    data, report = converted(project_with(condition=condition))
    assert coil_inputs(data) == [f"#{NOT_TRANSLATED}_Trans1", "#stop"]
    (why,) = lost(report, "condition of the transition")
    assert "does not compile" in why
    declared = {v.name for v in sfc.loads(data, as_tool=True).pous[0].variables()}
    assert f"{NOT_TRANSLATED}_Trans1" not in declared


def test_edges_and_timers_in_a_condition_do_not_compile() -> None:
    project = project_with(condition=m.NamedCondition(name="Ready"))
    text = "t(IN := a, PT := T#1s);\nReady := t.Q;"
    project.pous[0].transitions = [m.NamedTransition(name="Ready", body=m.StBody(text=text))]
    data, report = converted(project)
    assert coil_inputs(data)[0] == f"#{NOT_TRANSLATED}_Trans1"
    assert "function blocks or edges" in lost(report, "condition of the transition")[0]


@pytest.mark.parametrize("text", ["a", "a;", ":= a;", "Ready := a;"])
def test_named_transitions_are_their_expressions(text: str) -> None:
    project = project_with(condition=m.NamedCondition(name="Ready"))
    project.pous[0].transitions = [m.NamedTransition(name="Ready", body=m.StBody(text=text))]
    data, report = converted(project)
    assert coil_inputs(data) == ["#a", "#stop"]
    assert lost(report, "condition of the transition") == []
    assert sfc.loads(data).pous[0].sfc.transitions[0].condition == m.NamedCondition(name="Ready")  # type: ignore[union-attr]


@pytest.mark.parametrize("product", ["", "CODESYS"])
@pytest.mark.parametrize("dialect", [m.Dialect.IEC, m.Dialect.CODESYS, m.Dialect.SCL])
def test_a_missing_condition_is_true_of_s7_graph_only(dialect: m.Dialect, product: str) -> None:
    """An empty network is TRUE for TIA Portal. Charts made in Python have no product."""
    project = project_with(condition=None)
    project.dialect, project.header.product = dialect, product
    data, report = converted(project)
    first = coil_inputs(data)[0]
    reported = [
        item for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.path.startswith("POU Seq / transition")
    ]
    if dialect is m.Dialect.SCL:
        assert NOT_TRANSLATED not in first
    else:
        assert NOT_TRANSLATED in first
        assert "condition of the transition" in [item.what for item in reported]


def test_wired_conditions_are_networks() -> None:
    project = project_with(condition=m.WiredCondition(input=m.InputPin(connections=[Wire(source=80)])))
    chart = project.pous[0].sfc
    assert chart is not None
    chart.logic = [m.InputVariable(id=80, expression="b", negated=True)]
    data, report = converted(project)
    assert coil_inputs(data) == ["#b", "#stop"]
    assert lost(report, "condition of the transition") == []


def test_excluded_elements_do_nothing() -> None:
    project = project_with(action("N", "q", exclude=True), action("N", "r", id=91))
    chart = project.pous[0].sfc
    assert chart is not None
    chart.transitions[1].exclude = True
    data, report = converted(project)
    assert rows(data) == [("N", "", "#r", None)]
    assert "stop" not in coil_inputs(data)[1]
    trace = simulate(sfc.loads(data, as_tool=True), initial={"go": True, "stop": True}, scans=5, profile="s7graph")
    assert trace.is_active("Run")[-3:] == [True, True, True], "it is never left"
    assert [item.what for item in report.losses if item.what != "POU action"] == []


# -- times


def test_minimum_times_are_conditions() -> None:
    project = project_with(action("N", "q"), min_time="T#50ms", condition="TRUE")
    data, report = converted(project)
    assert lost(report, "min time") == []
    seen = sfc.loads(data, as_tool=True)
    inputs = {"go": True, "stop": True}
    # CODESYS tests conditions at the end of a scan, S7-GRAPH at the beginning of the next one
    there = simulate(project.pous[0], initial=inputs, scans=30, profile="codesys").is_active("Run")
    here = simulate(seen.pous[0], initial=inputs, scans=30, profile="s7graph").is_active("Run")
    assert [len(list(same)) for on, same in groupby(there) if on][:3] == [6, 6, 6]
    assert [len(list(same)) for on, same in groupby(here) if on][:3] == [5, 5, 5]


def test_time_limits_are_told_where_somebody_looks() -> None:
    project = project_with(max_time="T#5s")
    assert lost(converted(project)[1], "max time") == []
    chart = project.pous[0].sfc
    assert chart is not None
    chart.settings = m.SfcSettings(flags={m.SfcFlag.ERROR: m.FlagUse(use=True)})
    report = converted(project)[1]
    assert len(lost(report, "max time")) == 1
    assert lost(report, "flag") == ["S7-GRAPH has no SFCError: the chart neither obeys it nor sets it"]


# -- types


def with_enumeration(text: str) -> m.Project:
    """A block whose text uses the values of an enumeration, with one of them as initial value."""
    kind = m.EnumType(values=[m.EnumValue(name="Off"), m.EnumValue(name="Slow", value="5"), m.EnumValue(name="Fast")])
    sections = [
        variables(m.SectionKind.OUTPUT, "y", INT),
        m.VariableSection(
            kind=m.SectionKind.LOCAL,
            variables=[
                m.Variable(name="pace", type=m.DerivedType(name="Speed"), initial=m.SimpleValue(text="Speed.Slow")),
                m.Variable(name="other", type=m.DerivedType(name="Speed")),
                m.Variable(name="list", type=m.ArrayType(dimensions=[m.Dimension(lower="0", upper="1")], base="Speed")),  # type: ignore[arg-type]
            ],
        ),
    ]
    pou = m.Pou(name="Main", kind=m.PouKind.FUNCTION_BLOCK, interface=m.Interface(sections=sections))
    pou.bodies = [m.StBody(text=text)]
    initial = m.SimpleValue(text="Fast")
    declaration = m.DataTypeDeclaration(name="Speed", type=kind, initial=initial)
    project = m.Project(name="Line", pous=[pou], data_types=[declaration], dialect=m.Dialect.CODESYS)
    project.header.product = "CODESYS"
    return project


ENUMERATED = """IF pace = Speed.Slow AND other = Fast THEN
    pace := Speed.Fast;
    y := 1;
ELSIF pace = Speed.Fast THEN
    y := 2;
END_IF;
"""


def values(project: m.Project) -> list[object]:
    return list(simulate(project, scans=3)["y"])


@pytest.mark.parametrize("target", ["simaticml", "scl"])
def test_enumerations_are_numbers_and_constants(target: str) -> None:
    project = with_enumeration(ENUMERATED)
    data, report = sfc.convert(project, target)
    assert report.losses == []
    seen = sfc.loads(data, format=target, as_tool=True)
    main = seen.pou("Main")
    assert [v.type for v in main.variables()[:3]] == [INT, INT, INT]
    assert [v.initial for v in main.variables()[1:3]] == [m.SimpleValue(text="5"), m.SimpleValue(text="6")]
    assert values(seen) == values(project) == [1, 2, 2]
    if target == "simaticml":
        (table,) = seen.tag_tables
        named = {c.name: c.initial.text for c in table.constants if isinstance(c.initial, m.SimpleValue)}
        assert named == {"Speed_Off": "0", "Speed_Slow": "5", "Speed_Fast": "6"}
        assert data.count(b'"GlobalConstant"') == 4
    assert all(d.type.members for d in seen.data_types if isinstance(d.type, m.StructType))
    back = sfc.loads(sfc.dumps(sfc.loads(data, format=target), format="codesys"))
    assert back.data_types[0].type == project.data_types[0].type
    assert "pace = Speed.Slow AND other = Speed.Fast" in back.pous[0].body.text  # type: ignore[union-attr]


def test_conditions_with_values_of_enumerations() -> None:
    project = project_with(condition="mode = Mode.Auto", entry_action="Choose")
    project.data_types = [m.DataTypeDeclaration(name="Mode", type=m.EnumType(values=[m.EnumValue(name="Auto")]))]
    assert project.pous[0].interface is not None
    mode = m.Variable(name="mode", type=m.DerivedType(name="Mode"))
    project.pous[0].interface.sections[2].variables.append(mode)
    project.pous[0].action("Choose").body = m.StBody(text="mode := Mode.Auto;")  # type: ignore[union-attr]
    data, report = converted(project)
    assert lost(report, "condition of the transition") == []
    assert rows(data) == [("N", "S1", "#mode", '"Mode_Auto"')]
    assert b'Scope="GlobalConstant"' in data


def test_other_types_are_what_they_stand_for() -> None:
    project = with_enumeration("y := n;")
    low = m.SubrangeType(bounds=m.Dimension(lower="3", upper="9"), base=INT)
    project.data_types += [
        m.DataTypeDeclaration(name="Level", type=low),
        m.DataTypeDeclaration(name="Alias", type=m.DerivedType(name="Level")),
    ]
    assert project.pous[0].interface is not None
    section = project.pous[0].interface.sections[1]
    section.variables.append(m.Variable(name="n", type=m.DerivedType(name="Alias")))
    data, report = sfc.convert(project, "simaticml")
    assert [item.outcome for item in report.losses] == [Outcome.APPROXIMATED], "no bounds"
    seen = sfc.loads(data, as_tool=True)
    assert seen.pou("Main").variables()[-1].type == INT
    assert values(seen) == values(project) == [3, 3, 3]
    assert list(differences(sfc.loads(data).data_types, sfc.loads(data).data_types)) == []


# -- declarations

DECLARED = """
VAR CONSTANT k : INT := 5; END_VAR
VAR RETAIN r : INT := 7; END_VAR
VAR_TEMP t : INT; END_VAR
VAR s : STRING[20] := 'it$'s'; b AT %IX0.3 : BOOL; END_VAR
VAR_INPUT late : BOOL; END_VAR
VAR_STAT u : INT; END_VAR
"""


def declared(kind: str, text: str) -> m.Project:
    result = " : INT" if kind == "FUNCTION" else ""
    project = sfc.loads(f"{kind} F{result}\n{text}\n;\nEND_{kind}\n".encode(), format="iec-text")
    project.header.product = "CODESYS"
    return project


def test_sections_stand_once_and_in_the_order_of_tia_portal() -> None:
    project = declared("FUNCTION_BLOCK", DECLARED)
    data, report = sfc.convert(project, "simaticml", partial=True)
    assert report.with_outcome(Outcome.DROPPED) == []
    sections = parsed(data).findall(".//{*}Section")
    assert [section.get("Name") for section in sections] == ["Input", "Static", "Temp", "Constant"]
    seen = {v.name: v for v in sfc.loads(data, as_tool=True).pous[0].variables()}
    assert seen["r"].attributes == {"Remanence": "Retain"}
    assert [seen[name].initial for name in "krs"] == [m.SimpleValue(text=text) for text in ("5", "7", "'it$'s'")]
    assert "b" not in seen, "it is a tag"
    assert [(item.what, item.path) for item in report.losses] == [("static", "POU F / u")]
    back = sfc.loads(data).pous[0].interface
    assert [(d.left, d.right) for d in differences(back, project.pous[0].interface)] == [("%I0.3", "%IX0.3")]


@pytest.mark.parametrize("target", ["simaticml", "scl"])
def test_functions_have_temporary_variables_without_start_values(target: str) -> None:
    project = declared("FUNCTION", "VAR_INPUT a : INT; END_VAR\nVAR n : INT; m : INT := 3; END_VAR")
    data, report = sfc.convert(project, target)
    assert [item.path for item in report.items if item.what == "initial value"] == ["POU F / variable m"]
    sections = sfc.loads(data, format=target, as_tool=True).pous[0].interface.sections  # type: ignore[union-attr]
    assert [s.kind for s in sections if s.variables][:2] == [m.SectionKind.INPUT, m.SectionKind.TEMP]
    assert all(v.initial is None for s in sections for v in s.variables)
    back = sfc.loads(data, format=target).pous[0]
    assert isinstance(body := back.bodies[0], m.StBody)
    assert body.text.startswith("#m := 3;")
    given = project.pous[0].interface
    assert given is not None
    given.sections[1].variables[1].initial = None  # the statement is the same
    assert list(differences(back.interface, given)) == []


def test_a_variable_that_came_in_tia_portal_stays() -> None:
    project = declared("FUNCTION_BLOCK", DECLARED)
    text = sfc.dumps(project, format="simaticml", partial=True).decode("utf-8-sig")
    member = '<Member Name="s" Datatype="String[20]">'
    edited = text.replace(member, f'<Member Name="new" Datatype="Int" />{member}')
    sections = sfc.loads(edited.encode()).pous[0].interface.sections  # type: ignore[union-attr]
    assert [v.name for v in sections[1].variables] == ["r", "new"]


def test_ids_of_drawn_logic_meet_no_others_when_the_file_is_read() -> None:
    """Steps, actions and transitions get new ids: here those that elements of the logic had."""
    project = project_with(*(action("N", "q", id=90 + number) for number in range(6)))
    chart = project.pous[0].sfc
    assert chart is not None
    chart.logic = [m.InputVariable(id=number, expression=f"x{number}") for number in range(10, 20)]
    chart.transitions[1].condition = m.WiredCondition(input=m.InputPin(connections=[Wire(source=12)]))
    data, _ = converted(project)
    back = sfc.loads(data).pous[0].sfc
    assert back is not None
    wired = back.transitions[1].condition
    assert isinstance(wired, m.WiredCondition)
    found = [node for node in back.logic if node.id == wired.input.connections[0].source]
    assert [node.expression for node in found if isinstance(node, m.InputVariable)] == ['"x12"']
    ids = [
        *(each.id for each in (*back.steps, *back.transitions, *back.logic)),
        *(a.id for _, a in back.associations()),
    ]
    assert len(ids) == len(set(ids))


def test_a_condition_in_other_letters_comes_back_as_it_was() -> None:
    data, _ = converted(project_with(condition="True"))
    assert sfc.loads(data).pous[0].sfc.transitions[0].condition == m.Expression(text="True")  # type: ignore[union-attr]
    assert coil_inputs(data)[0] == "TRUE"


def test_an_edit_of_a_block_with_merged_sections_changes_its_line() -> None:
    data = sfc.dumps(declared("FUNCTION_BLOCK", DECLARED), format="simaticml", partial=True)
    project = sfc.loads(data)
    next(v for v in project.pous[0].variables() if v.name == "r").initial = m.SimpleValue(text="8")
    before, after = data.splitlines(), sfc.dumps(project, partial=True).splitlines()
    assert [(a.strip(), b.strip()) for a, b in zip(before, after, strict=True) if a != b] == [
        (b"<StartValue>7</StartValue>", b"<StartValue>8</StartValue>")
    ]


def test_a_named_transition_names_the_steps_of_its_chart() -> None:
    """They are members of the block in S7, not data blocks."""
    project = project_with(condition=m.NamedCondition(name="Ready"))
    body = m.StBody(text="Idle.T > T#1s AND Run.X")
    project.pou("Seq").transitions = [m.NamedTransition(name="Ready", body=body)]
    data, report = sfc.convert(project, "simaticml")
    assert report.losses == []
    assert b'"GlobalVariable"' not in data
    assert sfc.loads(data).pou("Seq").transitions[0].body == m.StBody(text="#Idle.T > T#1s AND #Run.X")
