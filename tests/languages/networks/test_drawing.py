"""How statements and expressions are drawn."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.formats.plcopen.tc6_versions import validate_tc6
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules, declared_rules
from plcopen_sfc.languages.networks.network_drawing import draw_fbd, draw_fbd_expression, draw_ld, draw_ld_expression
from plcopen_sfc.languages.networks.network_reading import body_statements
from plcopen_sfc.languages.networks.wires import normal_form
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.parsing import parse_expression, parse_statements
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model import (
    Block,
    Coil,
    Contact,
    FbdBody,
    InputVariable,
    LdBody,
    OutputVariable,
    Pou,
    PouKind,
    Project,
    StBody,
)
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import BlockCall, Node, Storage
from tests.languages.networks.build import read_drawn
from tests.languages.networks.programs import INSTANCES, programs
from tests.samples import FIXTURES
from tests.sweeps import examples


def statements(text: str, dialect: Dialect = Dialect.CODESYS) -> tuple[n.Statement, ...]:
    parsed = parse_statements(text, dialect)
    assert not parsed.problems
    return parsed.tree.statements


def fbd(text: str, **rules: object) -> list[Node]:
    (network,) = draw_fbd(statements(text), DrawingRules(Dialect.CODESYS, **rules)).body.networks  # type: ignore[arg-type]
    return network.nodes


def ld(text: str, **rules: object) -> list[Node]:
    (network,) = draw_ld(statements(text), DrawingRules(Dialect.CODESYS, **rules)).body.networks  # type: ignore[arg-type]
    return network.nodes


def kinds(nodes: list[Node]) -> list[str]:
    return [node.type_name if isinstance(node, Block) else node.kind for node in nodes]


def test_not_is_drawn_at_the_pin_that_takes_the_value() -> None:
    _a, _b, gate, out = fbd("x := NOT (NOT a AND b);")
    assert isinstance(gate, Block)
    assert isinstance(out, OutputVariable)
    assert [pin.negated for pin in gate.parameters.inputs] == [True, False]
    assert out.negated


def test_pins_have_the_names_of_the_tool() -> None:
    gate = fbd("x := a AND b AND c;", tool=Tool.CODESYS)[3]
    assert isinstance(gate, Block)
    assert [pin.name for pin in gate.parameters.inputs] == ["In1", "In2", "In3"]
    assert [pin.name for pin in gate.parameters.outputs] == ["Out1"]
    assert gate.call is BlockCall.OPERATOR
    gate = fbd("x := a AND b AND c;")[3]
    assert isinstance(gate, Block)
    assert [pin.name for pin in gate.parameters.inputs] == ["IN1", "IN2", "IN3"]
    assert gate.call is None


def test_a_function_block_stands_in_the_rung_that_uses_it() -> None:
    text = "edge(CLK := a); timer(IN := edge.Q, PT := T#1s); x := timer.Q AND b;"
    nodes = fbd(text, instances={"edge": "R_TRIG", "timer": "TON"})
    assert kinds(nodes) == ["input", "R_TRIG", "input", "TON", "input", "AND", "output"]
    timer = nodes[3]
    assert isinstance(timer, Block)
    assert timer.instance == "timer"
    assert [pin.name for pin in timer.parameters.outputs] == ["Q", "ET"]


def test_a_function_block_that_is_executed_later_stands_in_a_rung_of_its_own() -> None:
    text = "late(CLK := a); early(CLK := b); x := early.Q AND late.Q;"
    assert kinds(fbd(text, instances={"late": "R_TRIG", "early": "R_TRIG"})) == [
        *("input", "R_TRIG"),
        *("input", "R_TRIG", "input", "AND", "output"),
    ]


def test_variables_are_set_and_reset_by_coils() -> None:
    nodes = ld("x S= a; IF b THEN y := FALSE; END_IF")
    stored = [node.storage for node in nodes if isinstance(node, Coil)]
    assert stored == [Storage.SET, Storage.RESET]


def test_branches_and_negated_contacts() -> None:
    nodes = ld("x := (a OR NOT b) AND c;")
    contacts = [(node.variable, node.negated) for node in nodes if isinstance(node, Contact)]
    assert contacts == [("a", False), ("b", True), ("c", False)]
    last = [node for node in nodes if isinstance(node, Contact)][-1]
    assert last.input is not None
    assert len(last.input.connections) == 2


def test_comparisons_are_blocks_in_the_rung() -> None:
    assert kinds(ld("x := a AND Level > 5;")) == [
        *("leftPowerRail", "contact", "input", "input", "GT", "AND", "coil", "rightPowerRail")
    ]


def test_what_is_no_bool_is_no_contact() -> None:
    assert kinds(ld("x := y;")) == ["leftPowerRail", "input", "output", "rightPowerRail"]
    assert kinds(ld("x := y;", booleans={"y": True})) == ["leftPowerRail", "contact", "coil", "rightPowerRail"]
    assert kinds(ld("x := y AND z;", booleans={"y": False})) == [
        *("leftPowerRail", "input", "input", "AND", "output", "rightPowerRail")
    ]


def test_declarations_tell_what_is_an_instance_and_what_is_a_bool() -> None:
    pou = sfc.load(FIXTURES / "plcopen" / "filling_station_2.01.xml").pou("FillingStation")
    assert pou.interface is not None
    rules = declared_rules(pou.interface.variables(), Dialect.CODESYS, Tool.CODESYS)
    assert rules.instances["DripTimer"] == "TON"
    assert rules.booleans["s3_door"] is True
    assert rules.booleans["levelraw"] is False
    assert (rules.dialect, rules.tool) == (Dialect.CODESYS, Tool.CODESYS)


def test_what_has_no_graphical_form_is_kept_as_text_and_told() -> None:
    text = "FOR i := 1 TO 5 DO\n    x := x + i;\nEND_FOR;"
    drawn = draw_fbd(statements(text), DrawingRules(Dialect.CODESYS))
    (box,) = drawn.body.networks[0].nodes
    assert isinstance(box, Block)
    assert (box.type_name, box.code) == ("EXECUTE", text)
    assert [(problem.node, problem.message) for problem in drawn.problems] == [
        (box.id, "a statement (For) has no graphical form: kept as the text of an EXECUTE box of CODESYS")
    ]


def test_the_title_of_a_region_is_not_drawn() -> None:
    drawn = draw_fbd(statements("REGION Pump\nx := a;\nEND_REGION", Dialect.SCL))
    assert kinds(drawn.body.networks[0].nodes) == ["input", "output"]
    assert [str(p) for p in drawn.problems] == ["info: the region 'Pump' is not drawn, only what is in it"]


def test_a_call_of_something_unknown_is_kept_as_text() -> None:
    assert kinds(fbd("Motor.ACT_Stop(); Unknown(IN := a);")) == ["EXECUTE", "EXECUTE"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("IF a THEN x := b + 1; END_IF", ["input", "input", "input", "ADD", "output"]),
        ("IF a THEN x := b; END_IF", ["input", "input", "MOVE", "output"]),
        ("IF d <> 0 THEN x := c / d + 1; END_IF", ["input", "input", "NE", "EXECUTE"]),
        ("IF i < 9 THEN x := v[i] + 1; END_IF", ["input", "input", "LT", "EXECUTE"]),
    ],
)
def test_only_what_may_be_evaluated_anyway_stands_before_a_block_with_en(text: str, expected: list[str]) -> None:
    assert kinds(fbd(text)) == expected


def test_ids_begin_where_they_are_told_to() -> None:
    drawn = draw_fbd(statements("x := a; y := b;"), first_id=50, divided=True)
    assert [[node.id for node in network.nodes] for network in drawn.body.networks] == [[50, 51], [52, 53]]


def test_expressions_for_somebody_else_to_take() -> None:
    tree = parse_expression("NOT (a OR b)").tree
    drawn = draw_fbd_expression(tree)
    assert drawn.negated
    assert [wire.source for wire in drawn.outputs] == [3]
    drawn = draw_ld_expression(parse_expression("a OR b").tree)
    assert not drawn.negated
    assert len(drawn.outputs) == 2
    read = read_drawn(drawn)
    assert read.tree is not None
    assert normal_form(read.tree) == parse_expression("a OR b").tree


def test_a_text_that_cannot_be_read_stands_at_an_input_as_it_is() -> None:
    drawn = draw_fbd_expression(parse_expression("a +").tree)
    (node,) = drawn.network.nodes
    assert isinstance(node, InputVariable)
    assert node.expression == "a +"
    assert [problem.message for problem in drawn.problems] == [
        "'a +' cannot be read; it is kept as the text of an input"
    ]


def project(body: FbdBody | LdBody) -> Project:
    return Project(name="drawn", pous=[Pou(name="Main", kind=PouKind.PROGRAM, bodies=[body])])


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(40))
@given(programs, st.sampled_from(["FBD", "LD"]))
def test_files_hold_what_is_drawn(program: n.Statements, language: str) -> None:
    rules = DrawingRules(Dialect.CODESYS, instances=INSTANCES)
    body = (draw_fbd if language == "FBD" else draw_ld)(program.statements, rules).body
    content = sfc.dumps(project(body), format="plcopen", partial=True)
    loaded = sfc.loads(content)
    (read,) = loaded.pous[0].bodies
    if isinstance(read, StBody):  # boxes that only CODESYS has are text in TC6
        assert normal_form(parse_statements(read.text, Dialect.CODESYS).tree) == normal_form(program)
    else:
        assert isinstance(read, FbdBody | LdBody)
        assert normal_form(body_statements(read, Dialect.CODESYS).tree) == normal_form(program)


def test_files_with_what_is_drawn_are_valid(tmp_path: Path) -> None:
    text = "edge(CLK := a); x := (edge.Q OR b) AND NOT c AND Level > 5; IF a THEN y := z + 1; END_IF; q S= a; RETURN;"
    for draw in (draw_fbd, draw_ld):
        body = draw(statements(text), DrawingRules(instances={"edge": "R_TRIG"})).body
        path = tmp_path / f"{body.language}.xml"
        sfc.save(project(body), path, format="plcopen")
        assert not validate_tc6(path.read_bytes())
