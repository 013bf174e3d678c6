"""Meanings of names, and uses of things."""

from __future__ import annotations

import pytest

import plcopen_sfc
import plcopen_sfc.model as m
from plcopen_sfc.errors import ModelError
from plcopen_sfc.languages.binding import Names, find_uses
from tests.languages.binding.projects import (
    block,
    chart,
    enum,
    global_list,
    interface,
    pou,
    project,
    sfc,
    struct,
    variables,
)


def places(made: m.Project, what: str | m.Model) -> list[str]:
    """Where something is used: ``Main:1:4``."""
    return [f"{use.path}:{use.line}:{use.column}" for use in find_uses(made, what)]


def doubtful(made: m.Project, what: str) -> list[str]:
    names = Names(made)
    (declaration,) = names.find(what)
    return [
        f"{o.use.path}:{o.use.line}:{o.use.column}"
        for o in names.occurrences(declaration.name)
        if o.may_refer_to(declaration)
    ]


# -- scopes -----------------------------------------------------------------------------------------------------------


def test_a_local_variable_hides_a_global_one() -> None:
    made = project(pou("A", "x := 1;", "x: INT"), pou("B", "x := 2;\n(* x *) y := X;"), global_list("", "x: INT"))
    assert places(made, "x") == ["B:1:1", "B:2:14"]
    assert places(made, "A.x") == ["A:1:1"]


def test_variables_of_a_method_hide_those_of_the_block() -> None:
    motor = block("FB", "x := 1;", "x: INT; y: INT")
    method = m.Method(name="Do", interface=interface("x: INT"), body=m.StBody(text="x := y; THIS^.x := 3;"))
    motor.methods = [method, m.Method(name="Other", body=m.StBody(text="x := y;"))]
    made = project(motor)
    assert places(made, "FB.x") == ["FB.Do:1:15", "FB.Other:1:1", "FB:1:1"]
    assert places(made, "FB.Do.x") == ["FB.Do:1:1"]
    assert places(made, "FB.y") == ["FB.Do:1:6", "FB.Other:1:6"]


def test_actions_see_the_variables_of_their_pou() -> None:
    made = project(pou("A", "Act();", "x: INT", actions={"Act": "x := x + 1; Act;"}))
    assert places(made, "A.x") == ["A.Act:1:1", "A.Act:1:6"]
    assert places(made, "A.Act") == ["A.Act:1:13", "A:1:1"]


def test_names_in_comments_and_strings_are_none() -> None:
    made = project(pou("A", "// x\n(* x (* x *) x *) y := 'x'; {x} z := \"x\"; x;", "x: INT"))
    assert places(made, "A.x") == ["A:2:43"]


def test_a_variable_in_var_external_is_the_global_one() -> None:
    made = project(pou("A", "x := 1;", external="x: INT"), pou("B", "A.x := 2;"), global_list("", "x: INT"))
    assert places(made, "x") == ["A:1:1", "B:1:3"]


def test_lists_of_global_variables() -> None:
    made = project(pou("A", "GVL.x := x + y;"), global_list("GVL", "x: INT"), global_list("GVL", "y: INT"))
    assert places(made, "GVL") == ["A:1:1"]
    assert places(made, "GVL.x") == ["A:1:5", "A:1:10"]
    assert places(made, "GVL.y") == ["A:1:14"]


def test_a_list_that_must_be_named() -> None:
    strict = global_list("GVL", "x: INT")
    strict.declaration = "{attribute 'qualified_only'}\nVAR_GLOBAL\nx : INT;\nEND_VAR"
    assert places(project(pou("A", "GVL.x := x;"), strict), "GVL.x") == ["A:1:5", "GVL:3:1"]


def test_things_of_one_application_come_before_those_of_another() -> None:
    lists = [global_list("GVL", "x: INT"), global_list("GVL", "x: INT")]
    made = project(pou("A", "GVL.x := 1;"), pou("B", "GVL.x := 2;"), pou("C", "GVL.x := 3;"))
    made.applications = [
        m.Resource(name=name, global_variables=[own]) for name, own in zip(("P", "Q"), lists, strict=True)
    ]
    made.pous[0].place, made.pous[1].place = "application/P", "application/Q"
    assert places(made, lists[0].variables[0]) == ["A:1:5"]
    assert places(made, lists[1].variables[0]) == ["B:1:5"]
    with pytest.raises(ModelError, match="several"):
        find_uses(made, "GVL.x")


# -- steps ------------------------------------------------------------------------------------------------------------


def test_steps_in_conditions_and_bodies() -> None:
    main = sfc("Main", "S1 S2", "S1.x AND S2.T > T#5s", actions={"Act": "IF s1.X THEN S1.t; END_IF"})
    other = pou("Other", "y := Main.S1.x OR S1.x; a.S1.x := 1;")
    made = project(main, other)
    assert places(made, "Main.S1") == ["Main.Act:1:4", "Main.Act:1:14", "Main / transition S1 -> S2:1:1", "Other:1:11"]
    assert doubtful(made, "Main.S1") == ["Other:1:27"]


def test_steps_of_other_charts_of_the_pou_are_visible() -> None:
    main = sfc("Main", "S1 S2", "S1.x AND S3.x")
    main.actions = [m.Action(name="Act", body=m.SfcBody(chart=chart("S1 S3", "S1.x")))]
    made = project(main)
    first, second = (body.chart.steps[0] for _, _, body in made.bodies() if isinstance(body, m.SfcBody))
    assert places(made, first) == ["Main / transition S1 -> S2:1:1"]
    assert places(made, second) == ["Main.Act / transition S1 -> S3:1:1"]
    assert places(made, "Main.Act.S3") == ["Main / transition S1 -> S2:1:10"]


def test_a_step_and_a_variable_of_one_name() -> None:
    main = sfc("Main", "S1 S2", "S1.x AND S1", declared="S1: BOOL")
    made = project(main)
    chart_ = main.sfc
    assert chart_ is not None
    assert places(made, chart_.steps[0]) == ["Main / transition S1 -> S2:1:1"]
    assert main.interface is not None
    assert places(made, main.interface.variables()[0]) == ["Main / transition S1 -> S2:1:10"]


def test_a_step_and_a_variable_that_has_such_a_member() -> None:
    main = sfc("Main", "S1 S2", "S1.x", declared="S1: Point")
    known = project(main, struct("Point", "x: INT"))
    assert main.sfc is not None
    assert main.interface is not None
    assert places(known, main.sfc.steps[0]) == []
    assert places(known, main.interface.variables()[0]) == ["Main / transition S1 -> S2:1:1"]


def test_a_step_and_an_action_of_one_name() -> None:
    main = sfc("Main", "Fill S2", "Fill.x", actions={"Fill": "Fill(); y := Fill.t;"})
    assert main.sfc is not None
    main.sfc.steps[0].actions = [m.ActionAssociation(id=9, target="Fill")]
    made = project(main)
    assert places(made, main.sfc.steps[0]) == ["Main.Fill:1:14", "Main / transition Fill -> S2:1:1"]
    assert places(made, main.actions[0]) == ["Main.Fill:1:1", "Main / step Fill / action Fill / target:1:1"]


def test_steps_of_macro_steps() -> None:
    main = sfc("Main", "S1 M", "In1.x")
    assert main.sfc is not None
    main.sfc.steps[1].macro = m.Macro(body=m.SfcBody(chart=chart("In1 In2", "S1.x AND In1.T > T#1s")))
    made = project(main)
    assert places(made, "Main.S1") == ["Main / step M / transition In1 -> In2:1:1"]
    assert places(made, "Main.In1") == [
        "Main / step M / transition In1 -> In2:1:10",
        "Main / transition S1 -> M:1:1",
    ]


def test_everything_that_a_step_says() -> None:
    main = sfc("Main", "S1 S2", declared="v: BOOL; t1: TIME; n: INT")
    assert main.sfc is not None
    step = main.sfc.steps[0]
    step.min_time, step.max_time, step.warning_time = "t1", "T#5s", "t1 + T#1s"
    step.entry_action, step.main_action = "Act", m.StBody(text="Act();")
    step.actions = [m.ActionAssociation(id=8, target="v", value="n", duration="t1", indicator="v", condition="v")]
    step.interlock = m.Supervised(condition="v")
    main.actions = [m.Action(name="Act")]
    made = project(main)
    assert len(places(made, "Main.v")) == 4
    assert len(places(made, "Main.t1")) == 3
    assert len(places(made, "Main.n")) == 1
    assert len(places(made, "Main.Act")) == 2


def test_forcing_orders_name_steps_of_partial_charts() -> None:
    main = sfc("Main", "S1 S2")
    assert main.sfc is not None
    main.sfc.partial_charts = [m.PartialChart(name="G2", chart=chart("S1 S7"), entry_step="S7")]
    order = m.ForcingOrder(chart="G2", situation=m.ForcedSituation.EXPLICIT, steps=["S1", "S7"])
    main.sfc.steps[0].actions = [m.ActionAssociation(id=9, forcing=order)]
    made = project(main)
    inner = main.sfc.partial_charts[0].chart
    assert len(places(made, inner.steps[0])) == 1
    assert len(places(made, inner.steps[1])) == 2
    assert places(made, main.sfc.steps[0]) == []


# -- transitions and actions ------------------------------------------------------------------------------------------


def test_named_transitions() -> None:
    main = sfc("Main", "S1 S2")
    main.transitions = [
        m.NamedTransition(name="Go", body=m.StBody(text="Go := a;")),
        m.NamedTransition(name="Go2", body=m.StBody(text=":= a AND Go;")),
    ]
    main.interface = interface("a: BOOL")
    assert main.sfc is not None
    main.sfc.transitions[0].condition = m.NamedCondition(name="GO")
    made = project(main)
    assert places(made, "Main.Go") == ["Main.Go:1:1", "Main / transition S1 -> S2:1:1"]
    assert places(made, "Main.a") == ["Main.Go:1:7", "Main.Go2:1:4"]


def test_actions_of_instances() -> None:
    motor = block("FB_Motor", actions={"Stop": "run := FALSE;"}, declared="run: BOOL")
    main = sfc("Main", "S1 S2", declared="Motor: FB_Motor; Stop: BOOL")
    assert main.sfc is not None
    main.sfc.steps[0].exit_action = "Motor.Stop"
    main.sfc.steps[1].actions = [
        m.ActionAssociation(id=9, target="motor.stop"),
        m.ActionAssociation(id=10, target="Stop"),
    ]
    made = project(motor, main)
    assert places(made, "FB_Motor.Stop") == [
        "Main / step S1 / exit action:1:7",
        "Main / step S2 / action motor.stop / target:1:7",
    ]
    assert places(made, "Main.Stop") == ["Main / step S2 / action Stop / target:1:1"]


# -- members ----------------------------------------------------------------------------------------------------------

MEMBERS = [
    "p.a := 1;",
    "list[3].a := 1;",
    "nested.inner.a := 1;",
    "deep[1, 2].inner.a := 1;",
    "pointer^.a := 1;",
    "Make(5).a := 1;",
    "fb.point.a := 1;",
    "GVL.g.a := 1;",
    "alias.a := 1;",
    "fb.Get().a := 1;",
]


@pytest.mark.parametrize("text", MEMBERS)
def test_members_through_all_kinds_of_values(text: str) -> None:
    main = pou("Main", text, "p: Point; nested: Nested; fb: FB; alias: Alias; a: INT")
    point = m.DerivedType(name="POINT")
    assert main.interface is not None
    main.interface.sections[0].variables += [
        m.Variable(name="list", type=m.ArrayType(dimensions=[m.Dimension(lower="0", upper="9")], base=point)),
        m.Variable(
            name="deep",
            type=m.ArrayType(dimensions=[m.Dimension(lower="0", upper="9")] * 2, base=m.DerivedType(name="Nested")),
        ),
        m.Variable(name="pointer", type=m.PointerType(base=point)),
    ]
    make = pou("Make", kind=m.PouKind.FUNCTION, input="n: INT")
    assert make.interface is not None
    make.interface.return_type = point
    fb = block("FB", output="point: Point")
    fb.methods = [m.Method(name="Get", interface=m.Interface(return_type=point))]
    made = project(
        main,
        make,
        fb,
        struct("Point", "a: INT; b: INT"),
        struct("Nested", "inner: Point; a: INT"),
        m.DataTypeDeclaration(name="Alias", type=point),
        global_list("GVL", "g: Point"),
    )
    assert places(made, "Point.a") == [f"Main:1:{text.index('.a') + 2}"]
    assert places(made, "Main.a") == []
    assert places(made, "Nested.a") == []
    assert doubtful(made, "Point.a") == []


@pytest.mark.parametrize("text", ["q.a := 1;", "lib.x.a := 1;", "Foreign(1).a := 1;", "unknown.inner.a := 1;"])
def test_members_of_unknown_things_are_in_doubt(text: str) -> None:
    made = project(pou("Main", text, "unknown: Other"), struct("Point", "a: INT"))
    assert places(made, "Point.a") == []
    assert doubtful(made, "Point.a") == [f"Main:1:{text.index('.a') + 2}"]


@pytest.mark.parametrize("text", ["t.q := TRUE;", "r.a := 1;", "n.3 := TRUE;", "other.a := 1;", "S.a := 1;"])
def test_members_of_other_types_are_not_in_doubt(text: str) -> None:
    declared = "t: TON; r: Rect; n: INT; other: Elsewhere"
    made = project(
        pou("Main", text, declared), struct("Point", "a: INT; q: INT"), struct("Rect", "a: INT"), sfc("S", "S1")
    )
    assert places(made, "Point.a") == doubtful(made, "Point.a") == []
    assert places(made, "Point.q") == doubtful(made, "Point.q") == []


def test_what_a_block_extends() -> None:
    base, derived = block("Base", "", "a: INT"), block("Derived", "a := SUPER^.a + THIS^.a;", "b: INT")
    assert derived.interface is not None
    derived.interface.declaration = "FUNCTION_BLOCK Derived EXTENDS Base\nVAR\n  b : INT;\nEND_VAR"
    made = project(base, derived, pou("Main", "d.a := 1;", "d: Derived"))
    assert places(made, "Base.a") == ["Derived:1:1", "Derived:1:13", "Derived:1:23", "Main:1:3"]
    assert places(made, "Base") == ["Derived:1:32"]
    assert places(made, "Derived") == ["Derived:1:16", "Main / d:1:1"]


def test_parameters_of_calls() -> None:
    motor = block("FB", "", input="run: BOOL", output="done: BOOL")
    scale = pou("Scale", "Scale := raw;", kind=m.PouKind.FUNCTION, input="raw: INT")
    text = "fb(run := run, done => run); x := Scale(raw := raw); fbs[1](run := TRUE); other(run := run); t(IN := run);"
    main = pou("Main", text, "fb: FB; run: BOOL; raw: INT; t: TON")
    assert main.interface is not None
    array = m.ArrayType(dimensions=[m.Dimension(lower="0", upper="9")], base=m.DerivedType(name="FB"))
    main.interface.sections[0].variables.append(m.Variable(name="fbs", type=array))
    made = project(motor, scale, main)
    columns = [int(place.rpartition(":")[2]) - 1 for place in places(made, "FB.run")]
    assert [text[c : c + 6] for c in columns] == ["run :=", "run :="]
    assert doubtful(made, "FB.run") == [f"Main:1:{text.index('other(') + 7}"]
    assert len(places(made, "Main.run")) == 4
    assert places(made, "Scale.raw") == ["Scale:1:10", f"Main:1:{text.index('raw :=') + 1}"]
    assert places(made, "Scale") == ["Scale:1:1", f"Main:1:{text.index('Scale') + 1}"]


def test_values_of_enumerations() -> None:
    text = """c := Red; c := Colour.Red; c := Colour#Red;
CASE c OF
Red, Colour.Green: y := 1;
END_CASE
IF Red = c THEN END_IF"""
    made = project(pou("Main", text, "c: Colour"), enum("Colour", "Red Green"))
    assert places(made, "Colour.Red") == ["Main:1:6", "Main:1:23", "Main:1:40", "Main:3:1", "Main:5:4"]
    assert places(made, "Colour") == ["Main / c:1:1", "Main:1:16", "Main:1:33", "Main:3:6"]


def test_values_that_two_enumerations_have() -> None:
    text = "c := Red; l := Red;\nCASE l OF\nRed: y := 1;\nEND_CASE\nIF Red = c THEN x := Red; END_IF"
    made = project(
        pou("Main", text, "c: Colour := Red; l: Light; x: INT"), enum("Colour", "Red Green"), enum("Light", "Off Red")
    )
    assert places(made, "Colour.Red") == ["Main / c:1:1", "Main:1:6", "Main:5:4"]
    assert places(made, "Light.Red") == ["Main:1:16", "Main:3:1"]
    assert doubtful(made, "Light.Red") == ["Main:5:22"]


# -- declarations -----------------------------------------------------------------------------------------------------


def test_names_in_declarations() -> None:
    main = pou("Main", "", "n: INT := MAX_N + 1; fb: FB")
    assert main.interface is not None
    main.interface.sections[0].variables += [
        m.Variable(
            name="list",
            type=m.ArrayType(dimensions=[m.Dimension(lower="0", upper="MAX_N")], base=m.StringType(length="MAX_N")),
        ),
        m.Variable(
            name="p",
            type="Point",
            initial=m.StructValue(
                members=[m.MemberValue(member="a", value="MAX_N"), m.MemberValue(member="b", value="1")]
            ),
        ),
    ]
    made = project(main, block("FB"), struct("Point", "a: INT; b: INT"), global_list("", "MAX_N: INT"))
    assert len(places(made, "MAX_N")) == 4
    assert places(made, "FB") == ["Main / fb:1:1"]
    assert places(made, "Point.a") == ["Main / p:1:1"]


DECLARED = """PROGRAM Main
VAR
  n, k : INT := MAX_N; // n counts
  p : Point := (a := n, inner := (c := 2));
  own : STRUCT n : BOOL; END_STRUCT;
  kind : (n1, n2) := n1;
  fb : FB(MAX_N);
END_VAR
"""


def test_declarations_that_are_kept_as_text() -> None:
    main = pou("Main", "own.n := n1 = kind; n := 1;", "n: INT; k: INT; p: Point; fb: FB")
    assert main.interface is not None
    main.interface.declaration = DECLARED
    main.interface.sections[0].variables += [
        m.Variable(name="own", type=m.StructType(members=variables("n: BOOL"))),
        m.Variable(name="kind", type=m.EnumType(values=[m.EnumValue(name="n1"), m.EnumValue(name="n2")])),
    ]
    made = project(
        main,
        block("FB"),
        struct("Point", "a: INT; inner: Inner"),
        struct("Inner", "c: INT"),
        global_list("", "MAX_N: INT"),
    )
    assert places(made, "Main") == ["Main:1:9"]
    assert places(made, "Main.n") == ["Main:3:3", "Main:4:22", "Main:1:21"]
    assert places(made, "Main.own.n") == ["Main:5:16", "Main:1:5"]
    assert places(made, "Main.n1") == ["Main:6:11", "Main:6:22", "Main:1:10"]
    assert places(made, "Point.a") == ["Main:4:17"]
    assert places(made, "Inner.c") == ["Main:4:35"]
    assert places(made, "MAX_N") == ["Main:3:17", "Main:7:11"]
    assert places(made, "FB") == ["Main / fb:1:1", "Main:7:8"]


def test_types_that_are_kept_as_text() -> None:
    point, colour = struct("Point", "a: Colour; b: INT"), enum("Colour", "Red Green")
    point.declaration = "TYPE Point :\nSTRUCT\n  a : Colour := Red; (* b *)\n  b : INT;\nEND_STRUCT\nEND_TYPE"
    colour.declaration = "{attribute 'qualified_only'}\nTYPE Colour :\n(\n  Red := 0,\n  Green\n) := Red;\nEND_TYPE"
    made = project(point, colour)
    assert places(made, "Point") == ["Point:1:6"]
    assert places(made, "Point.b") == ["Point:4:3"]
    assert places(made, "Colour.Red") == ["Point:3:17", "Colour:4:3", "Colour:6:6"]
    assert places(made, "Colour") == ["Point / a:1:1", "Point:3:7", "Colour:2:6"]


def test_tasks_and_paths() -> None:
    main = pou("Main", "", "n: INT")
    made = project(main, global_list("", "go: BOOL; cycle: TIME"))
    task = m.Task(name="T", single="go", interval="cycle", instances=[m.PouInstance(name="P1", type_name="Main")])
    resource = m.Resource(name="R", tasks=[task], instances=[m.PouInstance(name="Main")])
    config = m.ConfigSection(variables=[m.ConfigVariable(path="C.R.P1.n", type="INT")])
    made.configurations = [m.Configuration(name="C", resources=[resource], config_variables=config)]
    assert len(places(made, "Main")) == 2
    assert len(places(made, "Main.n")) == 1
    assert len(places(made, "R.P1")) == 1
    assert len(places(made, "go")) == len(places(made, "cycle")) == 1


def test_the_project_tree() -> None:
    main, other = pou("Main", actions={"Act": ""}), pou("Other", actions={"Act": ""})
    main.object_id, main.actions[0].object_id = "1", "2"
    made = project(main, other)
    node = m.TreeNode(name="Main", object_id="1", children=[m.TreeNode(name="Act", object_id="2")])
    without = m.TreeNode(name="Other", children=[m.TreeNode(name="Act"), m.TreeNode(name="Main", folder=True)])
    made.tree = [m.TreeNode(name="Main", folder=True, children=[node, without])]
    assert places(made, "Main") == ["project tree:1:1"]
    assert places(made, "Main.Act") == ["project tree:1:1"]
    assert places(made, "Other.Act") == ["project tree:1:1"]


# -- SCL --------------------------------------------------------------------------------------------------------------


def test_signs_of_scl() -> None:
    motor = block("Motor", '#x := "x"; #"x" := x; "DB".y := #y;', "x: INT; y: INT")
    made = project(motor, global_list("", "x: INT"), global_list("DB", "y: INT"))
    made.dialect = m.Dialect.SCL
    assert places(made, "Motor.x") == ["Motor:1:2", "Motor:1:14", "Motor:1:20"]
    assert places(made, "x") == ["Motor:1:8"]
    assert places(made, "DB.y") == ["Motor:1:28"]
    assert places(made, "DB") == ["Motor:1:24"]


def test_data_blocks_of_tia() -> None:
    motor = block("Motor", "#run := TRUE;", input="run: BOOL")
    text = '"MotorDB".run := "Data".run; "MotorDB"(run := "Data".point.run); "My Data".a := "Data".list[2].run;'
    made = project(motor, block("Main", text), struct("A Point", "run: BOOL"))
    made.dialect = m.Dialect.SCL
    data = interface("run: BOOL; point: A Point")
    of_points = m.ArrayType(dimensions=[m.Dimension(lower="0", upper="9")], base=m.DerivedType(name='"A Point"'))
    data.sections[0].variables.append(m.Variable(name="list", type=of_points))
    made.data_blocks = [
        m.DataBlock(name="MotorDB", kind=m.DataBlockKind.INSTANCE, type_name="Motor", interface=interface("run: BOOL")),
        m.DataBlock(name="Data", interface=data),
        m.DataBlock(name="My Data", interface=interface("a: BOOL")),
    ]
    columns = {
        what: [int(p.rpartition(":")[2]) - 1 for p in places(made, what) if p.startswith("Main:")]
        for what in ("Motor.run", "Data.run", "A Point.run", "My Data.a", "Data", "My Data")
    }
    assert columns["Motor.run"] == [text.index("run"), text.index("(run") + 1]
    assert columns["Data.run"] == [text.index('"Data".run') + 7]
    assert columns["A Point.run"] == [text.index("point.run") + 6, text.index("].run") + 2]
    assert columns["My Data.a"] == [text.index(".a ") + 1]
    assert len(columns["Data"]) == 3
    assert places(made, "Motor") == ["MotorDB:1:1"]
    assert places(made, "A Point") == ["Data / point:1:1", "Data / list:1:2"]


def test_variables_that_a_tool_declares_for_steps() -> None:
    graph = block("Graph", "", "S1: G7_StepPlus_V2; T1: G7_TransitionPlus_V2; v: G7_StepPlus_V2")
    graph.bodies = [m.SfcBody(chart=chart("S1 S2", '#S1.U > T#1s AND "GraphDB".S1.X AND #v.X AND #T1.TT'))]
    assert graph.sfc is not None
    graph.sfc.transitions[0].name = "T1"
    made = project(graph)
    made.dialect = m.Dialect.SCL
    data = interface("S1: G7_StepPlus_V2; v: G7_StepPlus_V2")
    made.data_blocks = [m.DataBlock(name="GraphDB", kind=m.DataBlockKind.INSTANCE, type_name="Graph", interface=data)]
    assert places(made, graph.sfc.steps[0]) == ["Graph / transition T1:1:2", "Graph / transition T1:1:28"]
    assert places(made, graph.sfc.transitions[0]) == ["Graph / transition T1:1:47"]
    graph.sfc.rename_step("S1", "Warten")
    assert graph.interface is not None
    assert [v.name for v in graph.interface.variables()] == ["Warten", "T1", "v"]
    assert [v.name for v in data.variables()] == ["Warten", "v"]
    made.rename("Graph.v", "w")
    made.rename("Graph.T1", "Weiter")
    assert [v.name for v in graph.interface.variables()] == ["Warten", "Weiter", "w"]
    condition = graph.sfc.transitions[0].condition
    assert isinstance(condition, m.Expression)
    assert condition.text == '#Warten.U > T#1s AND "GraphDB".Warten.X AND #w.X AND #Weiter.TT'


def test_instructions_of_scl_are_no_blocks_of_the_project() -> None:
    made = project(block("Motor", '#x := PEEK(area := 1); #x := "Other"(area := 1);', "x: INT; area: INT"))
    made.dialect = m.Dialect.SCL
    assert doubtful(made, "Motor.area") == ["Motor:1:38"]


# -- what nobody can tell ---------------------------------------------------------------------------------------------


def test_text_that_cannot_be_read() -> None:
    made = project(pou("Main", "x := 1;\nIF x THEN y := ) x; // x\nx := 2;", "x: INT"))
    assert "Main:1:1" in places(made, "Main.x")
    found = places(made, "Main.x") + doubtful(made, "Main.x")
    assert {"Main:2:4", "Main:2:18", "Main:3:1"} <= set(found)
    assert "Main:2:24" not in found


def test_pragmas_that_ask_for_names() -> None:
    made = project(pou("Main", "{IF defined (variable: x)} x := 1; {END_IF} {attribute 'x'}", "x: INT"))
    assert places(made, "Main.x") == ["Main:1:28"]
    assert doubtful(made, "Main.x") == ["Main:1:24"]


def test_data_of_other_tools() -> None:
    main = pou("Main", "", "x: INT")
    main.extension_data = m.ExtensionData(data=[m.ForeignData(name="urn:tool", content="<trace var='Main.x' xx='1'/>")])
    main.bodies.append(m.OpaqueBody(source="urn:tool", content="<CFC>x</CFC>"))
    made = project(main)
    assert places(made, "Main.x") == []
    assert len(doubtful(made, "Main.x")) == 2


def test_unknown_paths() -> None:
    made = project(sfc("Main", "Fill S2"))
    with pytest.raises(ModelError, match="declares no") as error:
        find_uses(made, "Fill")
    assert "Main.Fill" in error.value.hint
    with pytest.raises(ModelError, match="declares no"):
        find_uses(made, m.Step(id=1, name="Fill"))


@pytest.mark.parametrize(
    "type_",
    [
        m.PointerType(base=m.DerivedType(name="T_Link")),
        m.ArrayType(dimensions=[m.Dimension(lower="0", upper="1")], base=m.DerivedType(name="T_Link")),
    ],
)
def test_a_type_that_leads_to_itself_has_no_members_and_ends(type_: m.PointerType | m.ArrayType) -> None:
    names = ("x", m.DerivedType(name="T_Link")), ("y", m.ElementaryType(name="INT"))
    section = m.VariableSection(kind="local", variables=[m.Variable(name=name, type=each) for name, each in names])
    main = m.Pou(name="Main", kind="program", interface=m.Interface(sections=[section]))
    main.bodies = [m.StBody(text="x.y := y;")]
    project = m.Project(data_types=[m.DataTypeDeclaration(name="T_Link", type=type_)], pous=[main])
    project.rename("Main.y", "z")
    assert main.bodies[0].text == "x.y := z;"
    for format in ("iec-text", "plcopen"):
        assert b"T_Link" in plcopen_sfc.dumps(project, format=format, partial=True)


OVERLAY = b"""FUNCTION_BLOCK FB1
VAR_INPUT go : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
VAR
  w : WORD;  // filled by the bus
  bits AT w : ARRAY[0..15] OF BOOL;
  z : INT;
END_VAR
BEGIN
  q := bits[3] AND go;
END_FUNCTION_BLOCK
"""


def test_an_overlay_uses_the_variable_at_whose_address_it_is() -> None:
    """It was taken for a direct address: a rename left `AT w`, and the unused `w` was removed under it."""
    made = plcopen_sfc.loads(OVERLAY)
    assert places(made, "FB1.w") == ["FB1 / bits / address:1:1"]
    assert made.edit().remove_unused() == ["FB1.z"]
    assert plcopen_sfc.dumps(made) == OVERLAY.replace(b"  z : INT;\n", b"")
    made = plcopen_sfc.loads(OVERLAY)
    made.rename("FB1.w", "status word")
    assert plcopen_sfc.dumps(made) == OVERLAY.replace(b"  w :", b'  "status word" :').replace(
        b"AT w", b'AT "status word"'
    )


def test_a_direct_address_names_nothing() -> None:
    made = plcopen_sfc.loads(b"PROGRAM P\nVAR IX0 : INT; x AT %IX0.0 : BOOL; END_VAR\nEND_PROGRAM\n")
    assert places(made, "P.IX0") == []
    assert [each.text_site.text for each in Names(made).everything if "address" in each.text_site.path] == []
