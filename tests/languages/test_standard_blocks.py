"""The table of standard blocks."""

from __future__ import annotations

import pytest

from plcopen_sfc.languages.st.nodes import Operator
from plcopen_sfc.languages.standard_blocks import (
    BlockKind,
    StandardBlock,
    Tool,
    operator_block,
    standard_block,
    standard_blocks,
)


def block(name: str, tool: Tool | None = None) -> StandardBlock:
    found = standard_block(name, tool)
    assert found is not None
    return found


def test_names_do_not_depend_on_case() -> None:
    assert block("ton") is block("TON")
    assert standard_block("TONE") is None


def test_the_dominant_input_has_the_one() -> None:
    """SR is set dominant in IEC 61131-3 and CODESYS; the parts of S7 are named the other way round."""
    assert [pin.name for pin in block("SR").inputs] == ["S1", "R"]
    assert [pin.name for pin in block("RS").inputs] == ["S", "R1"]
    assert block("Sr", Tool.S7) is block("RS")
    assert block("Rs", Tool.S7) is block("SR")
    assert block("RS").tool_pin("R1", Tool.S7) == "r1"
    assert block("SR").tool_pin("S1", Tool.CODESYS) == "SET1"


def test_pins_by_the_name_of_any_tool() -> None:
    assert block("SR").input_name("set1") == "S1"
    assert block("CTU").input_name("RESET") == "R"
    assert block("AND").output_name("Out1") == "OUT"
    assert block("TON").input_name("Q") is None
    assert block("MUX").input_name("IN7") == "IN7"
    assert block("SUB").input_name("IN3") is None


def test_inputs_that_repeat() -> None:
    assert [pin.name for pin in block("AND").input_pins(4)] == ["IN1", "IN2", "IN3", "IN4"]
    assert [pin.name for pin in block("MUX").input_pins(5)] == ["K", "IN0", "IN1", "IN2", "IN3"]
    assert [pin.name for pin in block("SUB").input_pins(5)] == ["IN1", "IN2"]
    assert block("AND").tool_pin("IN12", Tool.CODESYS) == "In12"
    assert block("ADD").tool_pin("IN3", Tool.S7) == "in3"


def test_conversions_are_standard() -> None:
    assert block("INT_TO_REAL").inputs[0].type == "INT"
    assert block("TO_REAL").result.type == "REAL"
    assert block("real_trunc_dint").result.type == "DINT"
    assert standard_block("ACT_TO_STOP") is None


def test_operators_have_blocks_but_for_those_that_have_none() -> None:
    for operator in Operator:
        found = operator_block(operator)
        without = {Operator.NEGATE, Operator.PLUS, Operator.AND_THEN, Operator.OR_ELSE}
        assert (found is None) == (operator in without)
        assert found is None or (found.kind is BlockKind.OPERATOR and found.operator is operator)


@pytest.mark.parametrize("found", [*standard_blocks()], ids=lambda found: found.name)
def test_the_table_is_sound(found: StandardBlock) -> None:
    assert found.inputs
    assert found.outputs
    assert found.stateful == (found.kind is BlockKind.FUNCTION_BLOCK)
    names = [pin.name for pin in (*found.inputs, *found.outputs)]
    assert len(set(names)) == len(names)
    for tool, own in found.tools.items():
        assert standard_block(own.name, tool) is found
        assert own.pins.keys() <= set(names)
        for pin in found.inputs:
            assert found.input_name(found.tool_pin(pin.name, tool)) == pin.name
        for pin in found.outputs:
            assert found.output_name(found.tool_pin(pin.name, tool)) == pin.name
