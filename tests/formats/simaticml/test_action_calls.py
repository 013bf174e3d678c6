"""Calls of actions, and charts of actions: TIA Portal has no actions, but statements and blocks in their places."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import Outcome
from tests.conversion.features import Feature, FeatureChart, feature_project, variable


def project_of(build: object) -> m.Project:
    """A chart of CODESYS that `build` adds something to."""
    return feature_project(Feature("x", ("codesys",), build), "codesys")  # type: ignore[arg-type]


def text_of(pou: m.Pou) -> str:
    """The statements of a block."""
    (body,) = pou.bodies
    assert isinstance(body, m.StBody)
    return body.text


def motor() -> m.Pou:
    """A function block whose actions call each other, with a constant."""
    sections = [
        m.VariableSection(kind=m.SectionKind.INPUT, variables=[variable("slow")]),
        m.VariableSection(kind=m.SectionKind.OUTPUT, variables=[variable("run"), variable("count", "INT")]),
        m.VariableSection(
            kind=m.SectionKind.LOCAL,
            constant=True,
            variables=[variable("WIDTH", "INT", initial=m.SimpleValue(text="2"))],
        ),
    ]
    actions = {
        "Start": "run := NOT slow;\nBump();",
        "Stop": "run := FALSE;",
        "Bump": "count := WIDTH - count;",
    }
    return m.Pou(
        name="Motor",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(sections=sections),
        bodies=[m.StBody(text=";")],
        actions=[m.Action(name=name, body=m.StBody(text=text)) for name, text in actions.items()],
    )


def own(rig: FeatureChart) -> None:
    """An action that calls another one, in each way that CODESYS has."""
    rig.action("Count", m.StBody(text="n := n + 1;\nIF n > 3 THEN Clear(); END_IF;\nTHIS^.Swap(); Swap;"))
    rig.action("Clear", m.StBody(text="n := 0;\nr := NOT r;"))
    rig.action("Swap", m.StBody(text="q := NOT q;"))
    rig.act("Work", "Count")


def of_instances(rig: FeatureChart) -> None:
    """An action that calls those of an instance in another one, with an argument."""
    rig.project.pous.append(motor())
    axis = m.VariableSection(kind=m.SectionKind.LOCAL, variables=[variable("motor", "Motor")])
    rig.project.pous.append(
        m.Pou(
            name="Axis",
            kind=m.PouKind.FUNCTION_BLOCK,
            interface=m.Interface(sections=[axis]),
            bodies=[m.StBody(text="motor.Stop();")],
        )
    )
    rig.declare(m.SectionKind.LOCAL, variable("axis", "Axis"))
    rig.action("Go", m.StBody(text="axis.motor.Start(slow := NOT axis.motor.slow);\nn := axis.motor.count;"))
    rig.action("Halt", m.StBody(text="axis();\nq := axis.motor.run;"))
    rig.act("Work", "Go")
    rig.act("Done", "Halt")


def method(name: str, text: str, *inputs: m.Variable, result: str | None = None) -> m.Method:
    """A method with a variable of its own."""
    sections = [
        m.VariableSection(kind=m.SectionKind.INPUT, variables=[*inputs]),
        m.VariableSection(kind=m.SectionKind.LOCAL, variables=[variable("old", "INT")]),
    ]
    type_ = m.ElementaryType(name=m.Elementary(result)) if result is not None else None
    return m.Method(name=name, interface=m.Interface(return_type=type_, sections=sections), body=m.StBody(text=text))


def methods(rig: FeatureChart) -> None:
    """Methods that call each other, in expressions and among the arguments, and one of an instance in another one."""
    of_instances(rig)
    more = variable("more", "INT", initial=m.SimpleValue(text="1"))
    rig.pou.methods = [
        method(
            "Next", "old := n;\nn := n + more;\nNext := old;\nIF n > 9 THEN THIS^.Clear(); END_IF;", more, result="INT"
        ),
        method("Clear", "n := 0;\nr := NOT r;"),
    ]
    rig.project.pous[1].methods = [method("Toggle", "run := NOT run AND NOT slow;\nToggle := run;", result="BOOL")]
    rig.action("Up", m.StBody(text="n := Next(more := 2) + Next();\nIF Next(Next(1)) > 5 THEN Clear(); END_IF;"))
    rig.action("Turn", m.StBody(text="q := axis.motor.Toggle();\naxis.motor.Toggle();"))
    rig.act("Work", "Up")
    rig.act("Done", "Turn")


@pytest.mark.slow
@pytest.mark.parametrize("build", [own, of_instances, methods])
def test_charts_with_calls_of_actions_do_the_same(build: object) -> None:
    converted = sfc.convert(project_of(build), "simaticml", strict=True, limit=8)
    assert not converted.report.losses
    assert converted.report.compared["POU Main"].startswith("equal")
    assert not converted.report.untested


@pytest.mark.parametrize("build", [own, of_instances, methods])
def test_the_calls_come_back(build: object) -> None:
    source = project_of(build)
    back = sfc.loads(sfc.dumps(sfc.loads(sfc.dumps(source, format="simaticml")), format="codesys"))
    before = sfc.loads(sfc.dumps(source, format="codesys"))
    named = {(pou.name, action.name): action.body for pou in before.pous for action in pou.actions}
    for pou in back.pous:
        for action in pou.actions:
            was = named.pop((pou.name, action.name))
            assert isinstance(was, m.StBody)
            assert isinstance(action.body, m.StBody)
            assert action.body.text == was.text.replace("THIS^.", "").replace("Swap;", "Swap();")
    assert not named
    assert "motor.Stop();" in [text_of(pou) for pou in back.pous if pou.name == "Axis"] or build is own


def test_a_folder_has_the_texts_of_the_single_file(tmp_path: Path) -> None:
    """Bodies kept the calls of actions and methods there, and those of methods without an item of the report."""
    text = """FUNCTION_BLOCK Motor VAR_INPUT slow : BOOL; END_VAR VAR_OUTPUT run : BOOL; n : INT; END_VAR
        METHOD Half : INT VAR_INPUT x : INT; END_VAR Half := x / 2; END_METHOD
        ACTION Stop: run := FALSE; END_ACTION
        n := Half(x := n + 2); IF slow THEN Stop(); END_IF; END_FUNCTION_BLOCK
        PROGRAM Line VAR one : Motor; wait : TON := (PT := T#1s); k : INT; END_VAR
        wait(IN := one.run); k := one.Half(x := k); one.Stop(); END_PROGRAM"""
    project = sfc.loads(sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="codesys"))
    sfc.save(project, f"{tmp_path}/plc/", format="simaticml", strict=True)
    in_folder = sfc.load(tmp_path / "plc", as_tool=True)
    alone = sfc.loads(sfc.dumps(project, format="simaticml"), as_tool=True)
    for name in ("Motor", "Line"):
        assert text_of(in_folder.pou(name)) == text_of(alone.pou(name))
    assert "PT := T#1s" in text_of(in_folder.pou("Line"))


def test_a_variable_of_a_method_starts_by_a_statement() -> None:
    """It was not executed, although one of a function was."""
    text = """FUNCTION_BLOCK Motor VAR_INPUT a : INT; END_VAR VAR_OUTPUT n : INT; END_VAR
        METHOD Half : INT VAR_INPUT x : INT; END_VAR VAR y : INT := 4; END_VAR y := y + x; Half := y / 2; END_METHOD
        n := Half(x := a); END_FUNCTION_BLOCK"""
    project = sfc.loads(sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="codesys"))
    tool = sfc.loads(sfc.convert(project, "simaticml", strict=True)[0], as_tool=True)
    for each in (project, tool):
        assert list(sfc.simulate(each, pou="Motor", inputs=lambda scan, _: {"a": scan}, scans=5)["n"]) == [
            2,
            2,
            3,
            3,
            4,
        ]


def test_statements_are_those_of_the_instance() -> None:
    tool = sfc.loads(sfc.dumps(project_of(of_instances), format="simaticml"), as_tool=True)
    assert text_of(tool.pou("Axis")) == "// action Stop of #motor\n#motor.run := FALSE;"
    assert text_of(tool.pou("Main_Go")).splitlines()[:5] == [
        "#axis.motor.slow := NOT #axis.motor.slow;",
        "// action Start of #axis.motor",
        "#axis.motor.run := NOT #axis.motor.slow;",
        "// action Bump",
        "#axis.motor.count := 2 - #axis.motor.count;",
    ]


def test_edited_statements_count() -> None:
    data = sfc.dumps(project_of(of_instances), format="simaticml")
    edited = data.replace(b'<Component Name="run" UId="28" />', b'<Component Name="slow" UId="28" />')
    assert edited != data
    again = sfc.loads(edited)
    assert "XML214" in {each.code for each in again.diagnostics}
    assert "#motor.slow := FALSE;" in text_of(again.pou("Axis"))


def test_the_action_of_a_program_is_that_of_its_data_block() -> None:
    def build(rig: FeatureChart) -> None:
        section = m.VariableSection(kind=m.SectionKind.LOCAL, variables=[variable("lamp")])
        rig.project.pous.append(
            m.Pou(
                name="Panel",
                kind=m.PouKind.PROGRAM,
                interface=m.Interface(sections=[section]),
                bodies=[m.StBody(text=";")],
                actions=[m.Action(name="Blink", body=m.StBody(text="lamp := NOT lamp;"))],
            )
        )
        rig.action("Show", m.StBody(text="Panel.Blink();\nq := Panel.lamp;"))
        rig.act("Work", "Show")

    converted = sfc.convert(project_of(build), "simaticml", strict=True, limit=5)
    assert converted.report.compared["POU Main"].startswith("equal")
    tool = sfc.loads(converted.data, as_tool=True)
    assert '"Panel_DB".lamp := NOT "Panel_DB".lamp;' in text_of(tool.pou("Main_Show"))


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("IF a THEN RETURN; END_IF;\nq := TRUE;", "RETURN"),
        ("Count();", "calls itself"),
    ],
)
def test_what_no_statements_do_is_told(text: str, why: str) -> None:
    def build(rig: FeatureChart) -> None:
        rig.action("Count", m.StBody(text="n := n + 1;\nInner();"))
        rig.action("Inner", m.StBody(text=text))
        rig.act("Work", "Count")

    report = sfc.convert(project_of(build), "simaticml", partial=True).report
    reasons = [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)]
    assert any(why in reason for reason in reasons), reasons


def test_variables_that_nobody_else_reaches_are_told() -> None:
    def build(rig: FeatureChart) -> None:
        block = motor()
        assert block.interface is not None
        block.interface.sections.append(
            m.VariableSection(kind=m.SectionKind.TEMP, variables=[variable("scratch", "INT")])
        )
        block.actions.append(m.Action(name="Work", body=m.StBody(text="scratch := 1; count := scratch;")))
        rig.project.pous.append(block)
        rig.declare(m.SectionKind.LOCAL, variable("drive", "Motor"))
        rig.action("Go", m.StBody(text="drive.Work();\nIF a THEN q := TRUE; END_IF;"))
        rig.act("Work", "Go")

    report = sfc.convert(project_of(build), "simaticml", partial=True).report
    reasons = [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)]
    assert any("scratch, a temporary variable of Motor" in reason for reason in reasons), reasons


# -- charts of actions


def inner_chart(condition: str, *names: str) -> m.SfcNetwork:
    """A chart of two steps that follows a condition."""
    chart = m.SfcNetwork()
    first, second = chart.add_step(names[0], initial=True), chart.add_step(names[1])
    chart.add_transition(first, second, condition)
    chart.add_transition(second, first, f"NOT {condition}")
    return chart


def nested(rig: FeatureChart) -> None:
    """A chart in an action whose step executes the chart of another action, which has actions of the block."""
    inner = inner_chart("b", "One", "Two")
    inner.step("Two").actions.append(m.ActionAssociation(id=inner.new_id(), target="r"))
    inner.step("One").actions.append(m.ActionAssociation(id=inner.new_id(), target="Count"))
    outer = inner_chart("g", "Three", "Four")
    outer.step("Four").actions.append(m.ActionAssociation(id=outer.new_id(), target="Inner"))
    rig.action("Inner", m.SfcBody(chart=inner))
    rig.action("Outer", m.SfcBody(chart=outer))
    rig.action("Count", m.StBody(text="IF n > 3 THEN n := 0; END_IF;\nn := n + 1;"))
    rig.act("Work", "Outer")
    rig.act("Done", "q")


@pytest.mark.slow
def test_charts_of_actions_are_blocks_that_do_the_same() -> None:
    source = feature_project(Feature("x", ("plcopen",), nested), "plcopen")
    converted = sfc.convert(source, "simaticml", limit=10)
    assert {item.what for item in converted.report.losses} == {"chart of an action", "chart"}  # its first call is held
    tool = sfc.loads(converted.data, as_tool=True)
    assert [pou.name for pou in tool.pous if pou.sfc is not None] == ["Main", "Main_Inner", "Main_Outer"]
    assert [variable.name for variable in tool.pou("Main").variables(m.SectionKind.LOCAL)] == [
        "Inner_chart",
        "Outer_chart",
    ]
    assert {v.name for v in tool.pou("Main_Outer").variables(m.SectionKind.IN_OUT)} == {"r", "n", "Inner_chart"}


@pytest.mark.parametrize("source", ["plcopen", "iec-text"])
@pytest.mark.parametrize("qualifier", ["S", "D"])
def test_charts_of_actions_are_stored_and_delayed(source: str, qualifier: str) -> None:
    def build(rig: FeatureChart) -> None:
        inner = inner_chart("a", "One", "Two")
        inner.step("Two").actions.append(m.ActionAssociation(id=inner.new_id(), target="r"))
        rig.action("Inner", m.SfcBody(chart=inner))
        rig.act("Work", "Inner", qualifier, **({"duration": "T#20ms"} if qualifier == "D" else {}))
        rig.act("Done", "Inner", "R")

    project = feature_project(Feature("x", (source,), build), source)
    converted = sfc.convert(project, "simaticml", limit=10)
    # S7-GRAPH tests no transition of the inner chart in the scan that calls it first: a pulse of `a` in it is missed
    assert "\nin what both come to while inputs stay: equal" in converted.report.compared["POU Main"]


@pytest.mark.slow
@pytest.mark.parametrize("qualifier", ["S", "D"])
def test_actions_of_instances_are_stored_and_delayed(qualifier: str) -> None:
    def build(rig: FeatureChart) -> None:
        block = motor()
        block.actions.append(m.Action(name="Turn", body=m.StBody(text="count := 3 - count;")))
        rig.project.pous.append(block)
        rig.declare(m.SectionKind.LOCAL, variable("drive", "Motor"))
        rig.act("Work", "drive.Turn", qualifier, **({"duration": "T#20ms"} if qualifier == "D" else {}))
        rig.act("Done", "drive.Turn", "R")
        rig.action("Copy", m.StBody(text="n := drive.count;"))
        rig.act("Idle", "Copy")  # no scan executes both: tools differ in the order

    converted = sfc.convert(project_of(build), "simaticml", limit=10)
    assert converted.report.compared["POU Main"].startswith("equal"), converted.report.compared
    assert not converted.report.with_outcome(Outcome.NOT_EXECUTED)


def test_charts_of_actions_come_back() -> None:
    source = sfc.loads(sfc.dumps(project_of(nested), format="codesys"))
    data = sfc.dumps(source, format="simaticml")
    again = sfc.loads(data)
    assert [pou.name for pou in again.pous] == ["Main"]
    assert not again.pous[0].variables(m.SectionKind.LOCAL)
    back = sfc.loads(sfc.dumps(again, format="codesys"))
    for name in ("Inner", "Outer"):
        bodies = [project.pou("Main").find_action(name).body for project in (source, back)]  # type: ignore[union-attr]
        charts = [body.chart for body in bodies if isinstance(body, m.SfcBody)]
        assert [[step.name for step in chart.steps] for chart in charts] == [[s.name for s in charts[0].steps]] * 2
        assert charts[0].steps[1].actions[0].target == charts[1].steps[1].actions[0].target


@pytest.mark.slow
def test_the_chart_of_an_instance_is_called_there() -> None:
    def build(rig: FeatureChart) -> None:
        block = motor()
        block.actions.append(m.Action(name="Seek", body=m.SfcBody(chart=inner_chart("slow", "Near", "Far"))))
        rig.project.pous.append(block)
        rig.declare(m.SectionKind.LOCAL, variable("drive", "Motor"))
        rig.action("Go", m.StBody(text="drive.Seek(slow := b);\nIF a THEN q := TRUE; END_IF;"))
        rig.act("Work", "Go")

    converted = sfc.convert(project_of(build), "simaticml", limit=5)
    assert not converted.report.with_outcome(Outcome.NOT_EXECUTED)
    tool = sfc.loads(converted.data, as_tool=True)
    assert text_of(tool.pou("Main_Go")).splitlines()[:3] == [
        "#drive.slow := #b;",
        "// action Seek of #drive",
        "#drive.Seek_chart(slow := #drive.slow);",
    ]


@pytest.mark.slow
def test_a_step_that_shows_later_in_codesys_is_told() -> None:
    """The action ends in the scan in which its chart goes on: CODESYS acts on that when the action begins again."""

    def build(rig: FeatureChart) -> None:
        inner = inner_chart("b", "One", "Two")
        inner.step("Two").actions.append(m.ActionAssociation(id=inner.new_id(), target="r"))
        rig.action("Inner", m.SfcBody(chart=inner))
        rig.chart.step("Work").main_action = "Inner"

    report = sfc.convert(project_of(build), "simaticml", limit=5).report
    told = [item.what for item in report.with_outcome(Outcome.APPROXIMATED)]
    assert "chart of an action" in told
    assert report.compared["POU Main"].startswith("different")


def test_what_a_block_for_a_chart_cannot_have_is_told() -> None:
    def build(rig: FeatureChart) -> None:
        inner = inner_chart("b", "One", "Two")
        inner.step("Two").actions.append(m.ActionAssociation(id=inner.new_id(), target="a"))
        rig.action("Inner", m.SfcBody(chart=inner))
        rig.act("Work", "Inner")

    report = sfc.convert(project_of(build), "simaticml", partial=True).report
    reasons = [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)]
    assert any("it writes the input a" in reason for reason in reasons), reasons


# -- maximum times


def watched(rig: FeatureChart, *, limited: bool = True) -> None:
    """A step that sets SFCError when it lasts too long, which an action reads."""
    rig.chart.step("Work").max_time = "T#50ms"
    rig.declare(m.SectionKind.OUTPUT, variable("SFCError"))
    if limited:
        rig.declare(m.SectionKind.LOCAL, variable("SFCEnableLimit", initial=m.SimpleValue(text="TRUE")))
    rig.action("Look", m.StBody(text="r := SFCError;"))
    rig.chart.step("Done").main_action = "Look"
    rig.act("Work", "q")


@pytest.mark.slow
@pytest.mark.parametrize("limited", [True, False])
def test_a_step_that_lasts_too_long_sets_sfc_error(limited: bool) -> None:
    source = project_of(lambda rig: watched(rig, limited=limited))
    converted = sfc.convert(source, "simaticml", strict=True, limit=3)
    assert converted.report.compared["POU Main"].startswith("equal")
    again = sfc.loads(converted.data)
    chart = again.pous[0].sfc
    assert chart is not None
    assert not chart.permanent_post, "the network is added"
    assert [step.max_time for step in chart.steps] == [None, "T#50ms", None]


def test_flags_without_a_counterpart_are_told_with_the_reason() -> None:
    def build(rig: FeatureChart) -> None:
        watched(rig)
        rig.chart.step("Done").main_action = None
        rig.act("Done", "Look")
        rig.action("Other", m.StBody(text="Look();"))  # so its statements may not ask the flags of the step
        flags = (m.SfcFlag.ERROR, m.SfcFlag.QUIT_ERROR, m.SfcFlag.RESET)
        rig.chart.settings = m.SfcSettings(flags={flag: m.FlagUse(use=True, declare=False) for flag in flags})
        rig.declare(m.SectionKind.INPUT, variable("SFCQuitError"), variable("SFCReset"))

    report = sfc.convert(project_of(build), "simaticml", partial=True).report
    told = {item.path.rpartition(" ")[2]: item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)}
    assert told.keys() == {"SFCQuitError"}
    assert "the actions of the step Done go on there" in told["SFCQuitError"]


def test_inlined_statements_are_readable_and_whole() -> None:
    """A branch has a statement, a negative constant parentheses, and each statement a line of its own."""

    def build(rig: FeatureChart) -> None:
        block = motor()
        assert block.interface is not None
        block.interface.sections[-1].variables[0].initial = m.SimpleValue(text="-2")
        block.actions.append(m.Action(name="Back", body=m.StBody(text="count := count - WIDTH; // back")))
        rig.project.pous.append(block)
        rig.declare(m.SectionKind.LOCAL, variable("drive", "Motor"))
        rig.action("Go", m.StBody(text="IF a THEN Rest(); ELSE drive.Back(); drive.Stop(); END_IF;"))
        rig.action("Rest", m.StBody(text="// nothing"))
        rig.act("Work", "Go")

    tool = sfc.loads(sfc.dumps(project_of(build), format="simaticml"), as_tool=True)
    assert text_of(tool.pou("Main_Go")).splitlines() == [
        "IF #a THEN",
        "    // action Rest",
        "    // nothing",
        "    ;",
        "ELSE",
        "    // action Back of #drive",
        "    #drive.count := #drive.count - (-2); // back",
        "    // action Stop of #drive",
        "    #drive.run := FALSE;",
        "END_IF;",
    ]


# -- inputs that are none in S7


def test_inputs_that_nobody_passes_are_static_variables() -> None:
    """An instance, or a variable that the block writes itself: no input of S7 is that, and no parameter gets it."""

    def build(rig: FeatureChart) -> None:
        rig.project.pous.append(motor())
        inner = inner_chart("b", "One", "Two")
        inner.step("Two").actions.append(m.ActionAssociation(id=inner.new_id(), target="Go"))
        sections = [
            m.VariableSection(
                kind=m.SectionKind.INPUT, variables=[variable("drive", "Motor"), variable("done"), variable("b")]
            ),
        ]
        axis = m.Pou(
            name="Axis",
            kind=m.PouKind.FUNCTION_BLOCK,
            interface=m.Interface(sections=sections),
            bodies=[m.StBody(text=";")],
            actions=[
                m.Action(name="Move", body=m.SfcBody(chart=inner)),
                m.Action(name="Go", body=m.StBody(text="drive.Start();\ndone := NOT done;")),
            ],
        )
        rig.project.pous.append(axis)
        rig.declare(m.SectionKind.LOCAL, variable("axis", "Axis"))
        rig.action("Run_axis", m.StBody(text="axis.Move(b := g);\nr := axis.done;"))
        rig.act("Work", "Run_axis")

    data, report = sfc.convert(project_of(build), "simaticml")
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    tool = sfc.loads(data, as_tool=True).pou("Axis")
    assert [variable.name for variable in tool.variables(m.SectionKind.INPUT)] == ["b"]
    assert [variable.name for variable in tool.variables(m.SectionKind.LOCAL)] == ["drive", "done", "Move_chart"]
    back = sfc.loads(data).pou("Axis")
    assert [variable.name for variable in back.variables(m.SectionKind.INPUT)] == ["drive", "done", "b"]
    assert not back.variables(m.SectionKind.LOCAL)


@pytest.mark.parametrize(("kind", "executed"), [("PROGRAM", True), ("FUNCTION_BLOCK", False)])
def test_inputs_that_a_program_writes_are_static_variables(kind: str, *, executed: bool) -> None:
    text = f"""{kind} Main VAR_INPUT a : BOOL; n : INT; END_VAR VAR_OUTPUT q : BOOL; END_VAR
    INITIAL_STEP S0: END_STEP STEP S1: act(N); q(N); END_STEP
    TRANSITION FROM S0 TO S1 := a; END_TRANSITION TRANSITION FROM S1 TO S0 := NOT a OR n > 3; END_TRANSITION
    ACTION act: a := FALSE; n := n + 1; END_ACTION
    END_{kind}"""
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "simaticml", partial=True, limit=20)
    assert bool(report.with_outcome(Outcome.NOT_EXECUTED)) is not executed
    assert report.compared["POU Main"].startswith("equal (proof") is executed
    inputs = [variable.name for variable in sfc.loads(data, as_tool=True).pou("Main").variables(m.SectionKind.INPUT)]
    assert ({"a", "n"} <= set(inputs)) is not executed
    assert [v.name for v in sfc.loads(data).pou("Main").variables(m.SectionKind.INPUT)] == ["a", "n"]


def test_inputs_of_blocks_without_an_instance_stay_inputs() -> None:
    def build(rig: FeatureChart) -> None:
        rig.action("Count", m.StBody(text="g := NOT g;\nIF g THEN n := 1; END_IF;"))
        rig.act("Work", "Count")

    report = sfc.convert(project_of(build), "simaticml", partial=True).report
    assert any("it writes the input g" in item.why for item in report.with_outcome(Outcome.NOT_EXECUTED))


@pytest.mark.slow
@pytest.mark.parametrize("qualifier", ["N", "S", "P1"])
def test_an_action_that_uses_data_of_steps_gets_them_passed(qualifier: str) -> None:
    def build(rig: FeatureChart) -> None:
        rig.declare(m.SectionKind.LOCAL, variable("Done_X"))
        rig.action("Go", m.StBody(text="IF Done.x THEN q := NOT q; END_IF;\nDone_X := NOT Work.x AND Work.t > T#1h;"))
        rig.act("Work", "Go", qualifier)

    data = sfc.convert(project_of(build), "simaticml", strict=True, limit=8).data
    function = sfc.loads(data, as_tool=True).pou("Main_Go")
    assert [variable.name for variable in function.variables(m.SectionKind.INPUT)] == ["Done_X_", "Work_X", "Work_T"]
    assert "#Done.X THEN" in sfc.loads(data).pou("Main").find_action("Go").body.text


def test_a_method_is_a_function_with_the_variables_that_it_uses() -> None:
    data, report = sfc.convert(project_of(methods), "simaticml")
    told = {item.path: item.why for item in report.items if item.what == "method"}
    assert told["POU Motor / method Toggle"].startswith("it is the function Motor_Toggle,")
    tool = sfc.loads(data, as_tool=True)
    interface = tool.pou("Motor_Toggle").interface
    assert interface is not None
    sections = {section.kind.name: [v.name for v in section.variables] for section in interface.sections}
    assert sections == {"INPUT": ["slow"], "IN_OUT": ["run"], "TEMP": ["old"], "RETURN": ["Ret_Val"]}
    back = sfc.loads(data)
    assert [each.name for each in back.pou("Main").methods] == ["Next", "Clear"]
    assert back.pou("Main").find_action("Turn").body.text == "#q := #axis.motor.Toggle();\n#axis.motor.Toggle();"


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda pou: setattr(pou.methods[0], "name", "FB_Init"), "its tool calls it when an instance is made or goes"),
        (lambda pou: setattr(pou.methods[0], "body", m.StBody(text="run := THIS^.Toggle();")), "it calls itself"),
    ],
)
def test_a_method_that_no_function_holds_says_why(change: object, why: str) -> None:
    project = project_of(methods)
    change(project.pous[1])  # type: ignore[operator]
    report = sfc.convert(project, "simaticml", partial=True).report
    (item,) = [item for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == "method"]
    assert why in item.why


@pytest.mark.parametrize("target", ["simaticml", "plcopen-2.01"])
def test_a_method_that_codesys_calls_is_not_executed_elsewhere(target: str) -> None:
    project = project_of(methods)
    motor = project.pou("Motor")
    for thing, head in ((motor, "FUNCTION_BLOCK Motor"), (motor.methods[0], "METHOD Toggle")):
        assert thing.interface is not None
        thing.interface.declaration = f"{{attribute 'call_after_init'}}\n{head}\n"
    report = sfc.convert(project, target, partial=True).report
    told = [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.path == "POU Motor / method Toggle"]
    assert any("its tool calls it when an instance is made or goes" in why for why in told)


@pytest.mark.parametrize("call", ["axis.motor.Toggle(a, g)", "axis.motor.Toggle(slow := a, quick := g)"])
def test_a_call_with_more_than_a_method_takes_is_left_and_told(call: str) -> None:
    project = project_of(methods)
    turn = project.pou("Main").find_action("Turn")
    assert turn is not None
    turn.body = m.StBody(text=f"q := {call};")
    report = sfc.convert(project, "simaticml", partial=True).report
    assert any("it has no parameter for" in item.why for item in report.with_outcome(Outcome.NOT_EXECUTED))


def test_a_method_that_a_block_further_down_has_too_is_no_function() -> None:
    """Which of both is called, only the running program tells."""
    project = project_of(methods)
    heirs = "FUNCTION_BLOCK Geared EXTENDS Motor\nEND_FUNCTION_BLOCK\nFUNCTION_BLOCK Slow EXTENDS Geared\n"
    read = sfc.loads(f"{heirs}END_FUNCTION_BLOCK\n".encode(), format="iec-text")
    read.pou("Slow").methods = [method("Toggle", "run := FALSE;")]
    project.pous += read.pous
    project = sfc.loads(sfc.dumps(project, format="codesys", partial=True), format="codesys")
    report = sfc.convert(project, "simaticml", partial=True).report
    told = {item.path: item.why for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == "method"}
    assert "Slow has a method Toggle too" in told["POU Motor / method Toggle"]


def test_a_method_that_uses_a_step_names_it() -> None:
    def build(rig: FeatureChart) -> None:
        rig.pou.methods = [method("Look", "q := Done.x;")]
        rig.action("Go", m.StBody(text="Look();"))
        rig.act("Work", "Go")

    report = sfc.convert(project_of(build), "simaticml", partial=True).report
    (item,) = [item for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == "method"]
    assert "it uses data of the step Done, which no call passes" in item.why
    assert item.why.endswith("let the step set a variable (N), and use that in its place")


def edges(rig: FeatureChart) -> None:
    """Two actions in LD with contacts of edges, which need a memory of their own."""
    for name, edge, storage in (("Mark", m.Edge.RISING, m.Storage.SET), ("Clear", m.Edge.FALLING, m.Storage.RESET)):
        nodes = [
            m.LeftPowerRail(id=1, outputs=[m.OutputPin()]),
            m.Contact(id=2, variable="b", edge=edge, input=wired(1), output=m.OutputPin()),
            m.Coil(id=3, variable="q", storage=storage, input=wired(2)),
        ]
        rig.action(name, m.LdBody(networks=[m.LogicNetwork(nodes=nodes)]))
        rig.act("Work", name)


def wired(source: int) -> m.InputPin:
    return m.InputPin(connections=[m.Connection(source=source)])


def inner_steps(rig: FeatureChart) -> None:
    """An action that reads steps of the chart of another one."""
    rig.action("Inner", m.SfcBody(chart=inner_chart("b", "One", "Two")))
    rig.action("Tell", m.StBody(text="q := Two.X;\nr := NOT Two.X AND g;"))
    rig.act("Work", "Inner")
    rig.act("Work", "Tell")


@pytest.mark.parametrize("build", [edges, inner_steps])
def test_functions_get_memories_of_edges_and_steps_of_other_charts(build: object) -> None:
    source = feature_project(Feature("x", ("plcopen",), build), "plcopen")  # type: ignore[arg-type]
    data, report = sfc.convert(source, "simaticml", limit=10)
    told = report.compared["POU Main"]
    assert told.startswith("equal") if build is edges else "\nin what both come to while inputs stay: equal" in told
    tool = sfc.loads(data, as_tool=True)
    added = {v.name: str(v.type) for v in tool.pou("Main").variables() if v.name.startswith(("edge", "last", "Inner"))}
    assert len(added) == (2 if build is edges else 1)
    back = sfc.loads(data).pou("Main")
    assert [v.name for v in back.variables()] == [v.name for v in source.pou("Main").variables()]
    kinds = [(action.name, type(action.body)) for action in source.pou("Main").actions]
    assert [(action.name, type(action.body)) for action in back.actions] == kinds
