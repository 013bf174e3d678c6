"""Elements of networks as text."""

from __future__ import annotations

import pytest

from plcopen_sfc.languages.networks.network_reading import network_statements
from plcopen_sfc.languages.networks.results import Helper
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import (
    Block,
    BlockCall,
    BlockVariable,
    CommentBox,
    Connector,
    Continuation,
    Edge,
    ErrorBox,
    InOutVariable,
    InputPin,
    Jump,
    Label,
    LogicNetwork,
    OutputPin,
    Return,
    RightPowerRail,
    Storage,
    VendorElement,
)
from tests.languages.networks.build import block, coil, contact, lines, output, pin, rail, read, told, variable

CODESYS = Dialect.CODESYS


# -- ladders ----------------------------------------------------------------------------------------------------------


def test_contacts_behind_each_other_and_beside_each_other() -> None:
    result = read(
        rail(),
        contact(1, "a", 0),
        contact(2, "b", 0, negated=True),
        contact(3, "c", 1, 2),
        contact(4, "d", 3),
        contact(5, "e", 3),
        coil(6, "x", 4, 5),
    )
    assert lines(result) == ["x := (a OR NOT b) AND c AND (d OR e);"]
    assert result.complete


def test_branches_in_branches_are_not_multiplied_out() -> None:
    nodes = [
        rail(),
        contact(1, "a", 0),
        contact(2, "b", 1),
        contact(3, "c", 1),
        contact(4, "d", 2, 3),
        contact(5, "e", 0),
        coil(6, "x", 4, 5),
    ]
    assert lines(read(*nodes)) == ["x := a AND (b OR c) AND d OR e;"]


def test_a_bridge_is_multiplied_out() -> None:
    nodes = [
        rail(),
        contact(1, "a", 0),
        contact(2, "b", 0),
        contact(3, "c", 1),
        contact(4, "d", 1, 2),
        coil(5, "x", 3, 4),
    ]
    assert lines(read(*nodes)) == ["x := a AND c OR (a OR b) AND d;"]


def test_coils_behind_each_other_all_get_what_comes_to_the_first() -> None:
    result = read(
        rail(), contact(1, "a", 0), coil(2, "x", 1, negated=True), coil(3, "y", 2), contact(4, "b", 3), coil(5, "z", 4)
    )
    assert lines(result) == ["x := NOT a;", "y := a;", "z := a AND b;"]


def test_what_passes_a_coil_is_what_came_before_it_wrote() -> None:
    result = read(rail(), contact(1, "a", 0), coil(2, "a", 1, negated=True), coil(3, "x", 2))
    assert lines(result) == ["value_2 := a;", "a := NOT value_2;", "x := value_2;"]
    result = read(variable(1, "Test()"), coil(2, "x", 1), coil(3, "y", 2))
    assert lines(result) == ["value_2 := Test();", "x := value_2;", "y := value_2;"]


def test_set_and_reset() -> None:
    nodes = [rail(), contact(1, "a", 0), coil(2, "x", 1, storage=Storage.SET), coil(3, "y", 1, storage=Storage.RESET)]
    assert lines(read(*nodes)) == ["IF a THEN", "    x := TRUE;", "END_IF;", "IF a THEN", "    y := FALSE;", "END_IF;"]
    assert lines(read(*nodes, dialect=CODESYS), CODESYS) == ["x S= a;", "y R= a;"]


def test_edges_need_an_instance_or_a_variable() -> None:
    result = read(
        rail(),
        contact(1, "a", 0, edge=Edge.RISING),
        contact(2, "b", 1),
        coil(3, "x", 2, edge=Edge.FALLING),
        taken=["edge_1"],
    )
    assert lines(result) == [
        "edge_1_2(CLK := a);",
        "value_3 := edge_1_2.Q AND b;",
        "value_3_2 := NOT value_3 AND last_3;",
        "last_3 := value_3;",
        "x := value_3_2;",
    ]
    assert Helper("edge_1_2", "R_TRIG", True) in result.helpers
    assert Helper("last_3", "BOOL", True) in result.helpers
    assert result.instances == {"edge_1_2": "R_TRIG"}


def test_helpers_are_locals_in_scl() -> None:
    result = read(rail(), contact(1, "#a", 0, edge=Edge.RISING), coil(2, '"x"', 1), dialect=Dialect.SCL)
    assert lines(result, Dialect.SCL) == ["#edge_1(CLK := #a);", '"x" := #edge_1.Q;']


def test_negated_and_edge_together_is_an_assumption() -> None:
    result = read(rail(), contact(1, "a", 0, negated=True, edge=Edge.RISING), coil(2, "x", 1))
    assert lines(result) == ["edge_1(CLK := NOT a);", "x := edge_1.Q;"]
    assert told(result) == [
        "warning: element 1: it is negated and watches for an edge: taken as the edge of the negated value"
    ]


def test_a_wire_around_a_contact_stays() -> None:
    assert lines(read(rail(), contact(1, "a", 0), coil(2, "x", 0, 1))) == ["x := TRUE OR a;"]


# -- values that are used more than once ------------------------------------------------------------------------------


def test_a_value_that_changes_between_its_uses_is_kept() -> None:
    nodes = [rail(), contact(1, "a", 0), contact(2, "b", 1), coil(3, "a", 2), coil(4, "x", 2), coil(5, "y", 2)]
    result = read(*nodes)
    assert lines(result) == ["value_2 := a AND b;", "a := value_2;", "x := value_2;", "y := value_2;"]
    assert result.helpers == (Helper("value_2", "BOOL", False),)


def test_a_value_that_does_not_change_is_written_again() -> None:
    nodes = [rail(), contact(1, "a", 0), contact(2, "b", 1), coil(3, "x", 2), coil(4, "y", 2)]
    assert lines(read(*nodes)) == ["x := a AND b;", "y := a AND b;"]


@pytest.mark.parametrize("written", ["GVL.a", "a", "gvl", "GVL.a.part"])
def test_a_part_and_the_whole_and_a_global_by_its_short_name_are_the_same_variable(written: str) -> None:
    result = read(variable(1, "GVL.a"), variable(2, "b"), output(3, written, 2), output(4, "x", 1), output(5, "y", 1))
    assert not result.helpers
    result = read(variable(1, "GVL.a"), output(2, "w", 1), variable(3, "b"), output(4, written, 3), output(5, "y", 1))
    assert [helper.name for helper in result.helpers] == ["value_1"]


def test_a_function_of_the_project_is_called_once() -> None:
    result = read(
        variable(1, "a"), block(2, "Safe", {"In": 1}, "OUT"), output(3, "x", (2, "OUT")), output(4, "y", (2, "OUT"))
    )
    assert lines(result) == ["value_2 := Safe(In := a);", "x := value_2;", "y := value_2;"]


def test_long_values_are_not_written_twice_however_often_they_are_used() -> None:
    nodes = [variable(0, "a"), variable(1, "b")]
    for number in range(2, 60):
        nodes.append(block(number, "XOR", {"IN1": number - 1, "IN2": number - 2}, "OUT"))
    result = read(*nodes, output(60, "x", 59))
    assert len(lines(result)) > 2
    assert sum(map(len, lines(result))) < 20_000


@pytest.mark.slow
def test_a_deep_network_does_not_overflow() -> None:
    nodes = [variable(0, "a")]
    nodes += [block(number, "SQRT", {"IN": number - 1}, "OUT") for number in range(1, 3000)]
    assert read(*nodes, output(3000, "x", 2999)).complete


def test_a_long_rung_does_not_overflow() -> None:
    nodes = [rail(), *(contact(number, "a", number - 1) for number in range(1, 3000)), coil(3000, "x", 2999)]
    assert lines(read(*nodes))[0].count("AND") == 2998


def test_feedback_reads_the_last_value_of_what_keeps_it() -> None:
    result = read(
        variable(1, "1"),
        block(2, "ADD", {"IN1": 1, "IN2": 3}, "OUT"),
        InOutVariable(id=3, expression="Count", input=pin((2, "OUT")), output=OutputPin()),
    )
    assert lines(result) == ["Count := 1 + Count;"]
    result = read(
        variable(1, "a"),
        block(2, "SR", {"S1": 1, "R": (3, "Q")}, "Q1", instance="ff"),
        block(3, "TON", {"IN": (2, "Q1"), "PT": InputPin(expression="T#1s")}, "Q", "ET", instance="timer"),
    )
    assert lines(result) == ["timer(IN := ff.Q1, PT := T#1s);", "ff(S1 := a, R := timer.Q);"]
    assert result.complete


def test_feedback_through_nothing_that_keeps_a_value_needs_a_helper() -> None:
    result = read(variable(1, "a"), block(2, "OR", {"IN1": 1, "IN2": (2, "OUT")}, "OUT"), output(3, "x", (2, "OUT")))
    assert lines(result) == ["last_2 := a OR last_2;", "x := last_2;"]
    assert result.helpers == (Helper("last_2", None, True),)
    assert told(result) == [
        "warning: element 2: its value feeds what it depends on; last_2 keeps it from the last cycle"
    ]


# -- blocks -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("type_name", "inputs", "text"),
    [
        ("AND", ["IN1", "IN2", "IN3"], "a AND b AND c"),
        ("XOR", ["In1", "In2"], "a XOR b"),
        ("NOT", ["IN"], "NOT a"),
        ("GT", ["IN1", "IN2", "IN3"], "a > b AND b > c"),
        ("NE", ["IN1", "IN2"], "a <> b"),
        ("SUB", ["IN1", "IN2"], "a - b"),
        ("EXPT", ["IN1", "IN2"], "a ** b"),
        ("MOVE", ["IN"], "a"),
        ("SEL", ["G", "IN0", "IN1"], "SEL(a, b, c)"),
        ("SEL", ["IN1", "G", "IN0"], "SEL(b, c, a)"),
        ("SUB", ["In2", "In1"], "b - a"),
        ("MAX", ["IN1", "IN2", "IN3"], "MAX(a, b, c)"),
        ("int_to_real", ["IN"], "int_to_real(a)"),
        ("Mixer", ["Raw", "Factor"], "Mixer(Raw := a, Factor := b)"),
    ],
)
def test_operators_and_functions(type_name: str, inputs: list[str], text: str) -> None:
    names = "abc"[: len(inputs)]
    nodes = [variable(number, name) for number, name in enumerate(names)]
    function = block(10, type_name, dict(zip(inputs, range(3), strict=False)), "OUT")
    assert lines(read(*nodes, function, output(11, "x", (10, "OUT")))) == [f"x := {text};"]


def test_calls_of_function_blocks() -> None:
    result = read(
        variable(1, "a"),
        variable(2, "T#5s"),
        block(3, "TON", {"IN": 1, "PT": 2}, "Q", "ET", instance="Timers.First"),
        output(4, "x", (3, "Q")),
        output(5, "t", (3, "ET")),
        block(6, "CTU", {"CU": (3, "Q"), "RESET": 1, "PV": None}, "Q", "CV", instance="Counter"),
    )
    assert lines(result) == [
        "Timers.First(IN := a, PT := T#5s);",
        "x := Timers.First.Q;",
        "t := Timers.First.ET;",
        "Counter(CU := Timers.First.Q, RESET := a);",
    ]
    assert result.instances == {"Timers.First": "TON", "Counter": "CTU"}
    assert told(result) == ["info: element 6: its input 'PV' is not connected and keeps its value"]


def test_a_function_block_without_an_instance_gets_one() -> None:
    result = read(variable(1, "a"), block(2, "R_TRIG", {"CLK": 1}, "Q"), output(3, "x", 2))
    assert lines(result) == ["r_trig_2(CLK := a);", "x := r_trig_2.Q;"]
    assert told(result) == ["warning: element 2: R_TRIG has no instance here; r_trig_2 is one"]


def test_parameters_that_go_in_and_out() -> None:
    result = read(
        variable(1, "data"),
        block(2, "Sort", {}, "Done", instance="sorter", in_outs={"Table": 1}),
        output(3, "copy", (2, "Table")),
        output(4, "done", (2, "Done")),
    )
    assert lines(result) == ["sorter(Table := data);", "copy := data;", "done := sorter.Done;"]


def test_more_than_one_output_of_a_function() -> None:
    result = read(
        variable(1, "a"),
        block(2, "Divide", {"X": 1}, "OUT", "Rest"),
        output(3, "x", (2, "OUT")),
        output(4, "y", (2, "Rest")),
    )
    assert lines(result) == ["value_2_2 := Divide(X := a, Rest => value_2);", "x := value_2_2;", "y := value_2;"]


def test_what_stands_at_pins() -> None:
    result = read(
        variable(1, "a"),
        block(
            2,
            "AND",
            {"IN1": 1, "IN2": InputPin(expression="b OR c")},
            BlockVariable(name="OUT", output=OutputPin(expression="x"), negated=True),
        ),
        output(3, "y", (2, "OUT")),
    )
    assert lines(result) == ["x := NOT (a AND (b OR c));", "y := x;"]


def test_modifiers_at_pins() -> None:
    gate = block(2, "AND", {"IN1": 1, "IN2": 1}, "OUT")
    assert isinstance(gate, Block)
    gate.parameters.inputs[0].negated = True
    gate.parameters.inputs[1].edge = Edge.RISING
    gate.parameters.outputs[0].storage = Storage.SET
    gate.parameters.outputs[0].output = OutputPin(expression="x")
    result = read(variable(1, "a"), gate)
    assert lines(result)[:2] == ["edge_2(CLK := a);", "IF NOT a AND edge_2.Q THEN"]


def test_enable() -> None:
    nodes = [
        variable(1, "a"),
        variable(2, "b"),
        block(3, "ADD", {"EN": 1, "IN1": 2, "IN2": InputPin(expression="1")}, "ENO", "OUT"),
        output(4, "x", (3, "OUT")),
        output(5, "y", (3, "ENO")),
    ]
    assert lines(read(*nodes)) == ["IF a THEN", "    x := b + 1;", "END_IF;", "y := a;"]


def test_a_negation_at_the_contact_and_at_the_pin_is_suspicious() -> None:
    box = block(2, "EXECUTE", {"EN": 1}, "ENO", call=BlockCall.EXECUTE, code="Stop();")
    assert isinstance(box, Block)
    box.parameters.inputs[0].negated = True
    result = read(rail(), contact(1, "a", 0, negated=True), box)
    assert lines(result) == ["IF a THEN", "    Stop();", "END_IF;"]
    assert told(result) == [
        "warning: element 2: its input 'EN' is negated, and so is contact 1 before it; both are counted"
    ]


def test_enable_where_the_result_goes_on() -> None:
    result = read(
        variable(1, "a"),
        variable(2, "b"),
        block(3, "MOVE", {"EN": 1, "IN": 2}, "ENO", "OUT"),
        block(4, "ADD", {"IN1": (3, "OUT"), "IN2": 2}, "OUT"),
        output(5, "x", (4, "OUT")),
    )
    assert lines(result) == ["IF a THEN", "    value_3 := b;", "END_IF;", "x := value_3 + b;"]
    assert result.helpers == (Helper("value_3", None, True),)


def test_enable_of_function_blocks_and_boxes_of_text() -> None:
    result = read(
        variable(1, "a"),
        block(2, "Valve", {"EN": 1, "Open": 1}, "ENO", instance="v"),
        block(3, "EXECUTE", {"EN": (2, "ENO")}, "ENO", call=BlockCall.EXECUTE, code="i := i + 1;\nGo();"),
    )
    assert lines(result) == [
        "value_2 := a;",
        "IF a THEN",
        "    v(Open := a);",
        "END_IF;",
        "IF value_2 THEN",
        "    i := i + 1;",
        "    Go();",
        "END_IF;",
    ]


def test_programs_actions_and_methods() -> None:
    result = read(
        variable(1, "a"),
        block(2, "Feeding", {"Go": 1}, "Done", call=BlockCall.PROGRAM),
        output(3, "x", (2, "Done")),
        block(4, "ACT_Stop", {}, instance="Motor", call=BlockCall.ACTION),
        block(5, "Turn", {"Speed": InputPin(expression="5")}, "Turn", instance="Motor", call=BlockCall.METHOD),
        dialect=CODESYS,
    )
    assert lines(result, CODESYS) == [
        "Feeding(Go := a);",
        "x := Feeding.Done;",
        "Motor.ACT_Stop();",
        "Motor.Turn(Speed := 5);",
    ]
    assert result.instances == {}


# -- order ------------------------------------------------------------------------------------------------------------


def test_elements_with_an_order_come_first() -> None:
    result = read(
        variable(1, "a"),
        output(2, "x", 1, position=(0, 10)),
        output(3, "y", 1, position=(0, 50), execution_order=2),
        output(4, "z", 1, position=(0, 90), execution_order=1),
        output(5, "w", 1, position=(0, 5), execution_order=0),
    )
    assert lines(result) == ["z := a;", "y := a;", "w := a;", "x := a;"]


def test_without_an_order_from_top_to_bottom_and_from_left_to_right() -> None:
    result = read(
        variable(1, "a"),
        output(2, "x", 1, position=(50, 90)),
        output(3, "y", 1, position=(90, 20)),
        output(4, "z", 1, position=(50, 20)),
    )
    assert lines(result) == ["z := a;", "y := a;", "x := a;"]


def test_without_places_in_the_order_of_the_file() -> None:
    assert lines(read(variable(1, "a"), output(2, "x", 1), output(3, "b", 1))) == ["x := a;", "b := a;"]


# -- jumps and connectors ---------------------------------------------------------------------------------------------


def test_jumps_labels_and_returns() -> None:
    nodes = [
        variable(1, "a"),
        Jump(id=2, label="End", input=pin(1)),
        output(3, "x", 1),
        Label(id=4, label="End"),
        Return(id=5, input=pin(1)),
    ]
    result = read(*nodes, dialect=CODESYS)
    assert lines(result, CODESYS) == [
        "IF a THEN",
        "    JMP End;",
        "END_IF;",
        "x := a;",
        "End:",
        "IF a THEN",
        "    RETURN;",
        "END_IF;",
    ]
    assert not result.problems
    assert lines(read(rail(), Jump(id=2, label="End", input=pin(0)), dialect=CODESYS), CODESYS) == ["JMP End;"]


def test_connectors_go_on_at_continuations() -> None:
    result = read(
        variable(1, "a"),
        Connector(id=2, name="Lid", input=pin(1)),
        Continuation(id=3, name="LID", output=OutputPin()),
        output(4, "x", 3),
        output(5, "y", 3),
    )
    assert lines(result) == ["x := a;", "y := a;"]
    assert not result.problems


# -- nothing is dropped silently --------------------------------------------------------------------------------------


def test_what_cannot_be_said_is_a_problem() -> None:
    result = read(
        output(1, "x"),
        output(2, "y", 99),
        variable(3, "unused"),
        contact(4, "a"),
        coil(5, "z", 4),
        Connector(id=6, name="out", input=pin(3)),
        Continuation(id=7, name="in", output=OutputPin()),
        ErrorBox(id=8, content="lost"),
        VendorElement(id=9, alternative_text="Trend"),
        block(10, "GT", {"IN1": 3, "IN2": None}, "OUT"),
        output(11, "w", (10, "OUT")),
        variable(12, "a +"),
        output(13, "v", 12),
        block(14, "SQRT", {"IN": 3}, "OUT"),
    )
    found = {(problem.node, problem.message.partition(":")[0]) for problem in result.problems}
    assert found == {
        (1, "nothing leads here, so x is not written"),
        (2, "a wire starts at element 99, which is not there"),
        (2, "nothing leads here, so y is not written"),
        (4, "nothing leads to this contact; taken as connected to the left power rail"),
        (6, "connector 'out' goes on nowhere"),
        (7, "continuation 'in' comes from nowhere"),
        (7, "it has no value, and leads nowhere"),
        (8, "an error of the tool that made the file"),
        (9, "an element that only its tool understands"),
        (10, "its input 'IN2' is not connected"),
        (12, "'a +'"),
        (14, "its value leads nowhere"),
    }
    assert not result.complete


def test_ids_that_are_used_twice_are_a_problem() -> None:
    assert "error: element 1: another element has this id too" in told(read(variable(1, "a"), output(1, "x", 1)))


def test_comments_and_titles_are_kept() -> None:
    result = read(
        CommentBox(id=1, content="Pump"), VendorElement(id=2, alternative_text="Slow", element_type="networktitle")
    )
    assert result.comments == ((1, "Pump"), (2, "Slow"))
    assert not result.problems
    gate = block(2, "NOT", {"IN": 1}, "OUT", comment="turned")
    assert isinstance(gate, Block)
    gate.parameters.inputs[0].comment = "see =M12"
    network = LogicNetwork(title="Pump", nodes=[variable(1, "a", comment="door"), gate, output(3, "x", 2)])
    assert network_statements([network]).comments == ((None, "Pump"), (1, "door"), (2, "turned"), (2, "see =M12"))


def test_the_right_power_rail_does_nothing() -> None:
    result = read(rail(), contact(1, "a", 0), RightPowerRail(id=2, inputs=[pin(1)]))
    assert told(result) == ["error: element 1: its value leads nowhere"]
    assert result.open_ends[0][0] == 1


def test_an_output_that_a_block_does_not_have() -> None:
    result = read(variable(1, "a"), block(2, "TON", {"IN": 1}, "Q", "ET", instance="t"), output(3, "x", (2, "x")))
    assert lines(result) == ["t(IN := a);", "x := t.Q;"]
    assert told(result) == [
        "warning: element 3: a wire starts at the output 'x' of element 2, which TON does not have; taken as 'Q'"
    ]


def test_flip_flops_of_s7_keep_their_state_in_a_variable() -> None:
    inputs = {"S": 1, "R1": 2, "operand": 3}
    parts = [variable(1, "a"), variable(2, "b"), variable(3, "m"), output(9, "y", (4, "Q1"))]
    result = read(*parts, block(4, "RS", inputs, "Q1"))
    assert lines(result) == ["m := (a OR m) AND NOT b;", "y := m;"]
    assert told(result) == []
    sets_win = {"S1": 1, "R": 2, "operand": 3}
    assert lines(read(*parts, block(4, "SR", sets_win, "Q1"))) == ["m := a OR m AND NOT b;", "y := m;"]
    only_set = {"S": 1, "R1": None, "operand": 3}
    assert lines(read(*parts[:3], block(4, "RS", only_set, "Q1"))) == ["m := a OR m;"]


def test_edges_of_s7_keep_their_state_in_a_variable() -> None:
    parts = [variable(1, "a"), variable(3, "m"), output(9, "y", (4, "Q"))]
    rising = read(*parts, block(4, "R_TRIG", {"CLK": 1, "bit": 3}, "Q"))
    assert lines(rising) == ["value_4 := a AND NOT m;", "m := a;", "y := value_4;"]
    falling = read(*parts, block(4, "F_TRIG", {"CLK": 1, "bit": 3}, "Q"))
    assert lines(falling) == ["value_4 := NOT a AND m;", "m := a;", "y := value_4;"]


def test_edge_contacts_of_s7_watch_their_operand_whether_power_reaches_them_or_not() -> None:
    parts = [rail(), contact(1, "go", 0), variable(2, "a"), variable(3, "m"), coil(9, "y", (4, "out"))]
    pins = {"pre": 1, "operand": 2, "bit": 3}
    rising = read(*parts, block(4, "PContact", pins, "out"))
    assert lines(rising) == ["value_4 := a AND NOT m;", "m := a;", "y := go AND value_4;"]
    falling = read(*parts, block(4, "NContact", pins, "out"))
    assert lines(falling) == ["value_4 := NOT a AND m;", "m := a;", "y := go AND value_4;"]
    at_rail = read(*parts, block(4, "PContact", {**pins, "pre": 0}, "out"))
    assert lines(at_rail)[-1] == "y := value_4;"
    assert told(rising) == told(falling) == []


def test_edge_coils_of_s7_pass_on_what_comes_to_them() -> None:
    parts = [rail(), contact(1, "go", 0), variable(2, "pulse"), variable(3, "m"), coil(9, "y", (4, "out"))]
    pins = {"in": 1, "operand": 2, "bit": 3}
    rising = read(*parts, block(4, "PCoil", pins, "out"))
    assert lines(rising) == ["value_4 := go AND NOT m;", "m := go;", "pulse := value_4;", "y := go;"]
    falling = read(*parts[:4], block(4, "NCoil", pins, "out"))
    assert lines(falling) == ["value_4 := NOT go AND m;", "m := go;", "pulse := value_4;"]
    assert told(rising) == told(falling) == []


def test_an_edge_element_of_s7_without_its_memory_is_a_problem() -> None:
    result = read(rail(), variable(2, "a"), block(4, "PContact", {"pre": 0, "operand": 2}, "out"))
    assert "error: element 4: PContact has no operand, or none for its edge" in told(result)


def test_inc_and_dec_of_s7_change_their_operand() -> None:
    parts = [rail(), contact(1, "go", 0), variable(2, "n"), coil(9, "y", (4, "ENO"))]
    result = read(*parts, block(4, "Inc", {"EN": 1, "operand": 2}, "ENO"))
    assert lines(result) == ["IF go THEN", "    n := n + 1;", "END_IF;", "y := go;"]
    assert told(result) == []
    always = read(variable(2, "n"), block(4, "Dec", {"operand": 2}))
    assert lines(always) == ["n := n - 1;"]


def test_a_comparison_in_a_ladder_of_s7_is_a_contact() -> None:
    power, left, right = contact(2, "go", 0), variable(3, "x"), variable(4, "5")
    compare = block(5, "EQ", {"pre": 2, "in1": 3, "in2": 4}, "out")
    result = read(rail(), power, left, right, compare, coil(6, "y", (5, "out")), dialect=Dialect.SCL)
    assert lines(result, Dialect.SCL) == ["y := go AND x = 5;"]
    assert told(result) == []
    at_rail = block(5, "EQ", {"pre": 0, "in1": 3, "in2": 4}, "out")
    assert lines(read(rail(), left, right, at_rail, coil(6, "y", (5, "out")))) == ["y := x = 5;"]


def test_a_pin_that_a_standard_block_does_not_have_is_a_problem() -> None:
    parts = [variable(1, "a"), variable(2, "b"), variable(3, "c"), output(9, "y", (4, "OUT"))]
    result = read(*parts, block(4, "EQ", {"IN1": 1, "IN2": 2, "gate": 3}, "OUT"))
    assert "error: element 4: EQ has no input 'gate'" in told(result)
    assert not result.complete
