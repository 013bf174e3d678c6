"""Flip-flops of TIA Portal, which keep their state in a variable, in tools whose flip-flops are instances."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.model.compare import differences
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.programs import Controller

BLOCK = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
VAR f : BOOL; END_VAR
END_FUNCTION_BLOCK
"""
PINS = {"SR": ("S1", "R"), "RS": ("S", "R1")}
SCANS = [(0, 0), (1, 0), (0, 0), (0, 1), (1, 1), (0, 0), (1, 0), (1, 1), (0, 0)]
EXPECTED = {"SR": [0, 1, 1, 0, 1, 1, 1, 1, 1], "RS": [0, 1, 1, 0, 0, 0, 1, 0, 0]}


def wire(source: int, pin: str | None = None) -> m.InputPin:
    return m.InputPin(connections=[m.Connection(source=source, pin=pin)])


def of_tia(kind: str, *, negated: bool = False, output: bool = True) -> m.Project:
    """A block in FBD of TIA Portal with a flip-flop on the variable f."""
    names = PINS[kind]
    inputs = [
        m.BlockVariable(name=names[0], input=wire(1)),
        m.BlockVariable(name=names[1], input=wire(2), negated=negated),
        m.BlockVariable(name="operand", input=m.InputPin(expression="#f")),
    ]
    outputs = [m.BlockVariable(name="Q1", output=m.OutputPin())]
    box = m.Block(id=3, type_name=kind, parameters=m.BlockParameters(inputs=inputs, outputs=outputs))
    nodes: list[m.Node] = [m.InputVariable(id=1, expression="#a"), m.InputVariable(id=2, expression="#b"), box]
    source, pin = (3, "Q1") if output else (5, None)
    after: list[m.Node] = [] if output else [m.InputVariable(id=5, expression="#f")]
    after.append(m.Coil(id=4, variable="#q", input=wire(source, pin)))
    project = sfc.loads(BLOCK.encode(), format="iec-text")
    project.dialect = m.Dialect.SCL
    networks = [m.LogicNetwork(nodes=[*nodes, *after])] if output else [m.LogicNetwork(nodes=n) for n in (nodes, after)]
    project.pou("Main").bodies = [m.FbdBody(networks=networks)]
    return sfc.loads(sfc.dumps(project, format="simaticml", partial=True), as_tool=True)


def values(project: m.Project, *, inverted: bool = False) -> list[int]:
    instance = Controller(project).instance("Main")
    found = []
    for a, b in SCANS:
        instance["a"], instance["b"] = bool(a), bool(b) is not inverted
        instance.scan()
        found.append(int(bool(instance["q"])))
    return found


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01", "plcopen-1.01"])
@pytest.mark.parametrize("negated", [False, True])
@pytest.mark.parametrize("output", [True, False])
@pytest.mark.parametrize("kind", PINS)
def test_a_flip_flop_with_an_operand_does_the_same(kind: str, target: str, negated: bool, output: bool) -> None:
    project = of_tia(kind, negated=negated, output=output)
    assert values(project, inverted=negated) == EXPECTED[kind]
    data, report = sfc.convert(project, target)
    assert report.losses == []
    assert [item.what for item in report.with_outcome(Outcome.TRANSLATED) if "keep no state" in item.why] == ["box"]
    seen = sfc.loads(data, format=target, as_tool=True)
    assert values(seen, inverted=negated) == EXPECTED[kind]


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
@pytest.mark.parametrize("kind", PINS)
def test_the_box_comes_back_unless_the_logic_was_edited(kind: str, target: str) -> None:
    project = of_tia(kind)
    data = sfc.dumps(project, format=target)
    back = sfc.loads(sfc.dumps(sfc.loads(data), format="simaticml"))
    assert not list(differences(project, back, ignore=frozenset({"drawing", "header"})))
    other = sfc.loads(data)
    edited = other.pou("Main").bodies[0]
    assert isinstance(edited, m.FbdBody)
    box = next(n for n in edited.networks[0].nodes if isinstance(n, m.Block) and n.extension_data is not None)
    box.type_name = "XOR"
    boxes = [n.type_name for n in loaded_boxes(sfc.dumps(other, format="simaticml"))]
    assert kind not in boxes
    assert "XOR" in boxes or "X" in boxes


def loaded_boxes(data: bytes) -> list[m.Block]:
    body = sfc.loads(data).pou("Main").bodies[0]
    assert isinstance(body, m.FbdBody)
    return [node for network in body.networks for node in network.nodes if isinstance(node, m.Block)]


CALLED = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
VAR f : %s; END_VAR
f(%s := a, %s := b); q := f.Q1;
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("target", ["simaticml", "scl"])
@pytest.mark.parametrize(
    ("kind", "pins", "dialect"),
    [(kind, pins, m.Dialect.IEC) for kind, pins in PINS.items()]
    + [("SR", ("SET1", "RESET"), m.Dialect.CODESYS), ("RS", ("SET", "RESET1"), m.Dialect.CODESYS)],
)
def test_a_flip_flop_that_texts_call_is_a_block_of_its_own_in_s7(
    kind: str, pins: tuple[str, str], dialect: m.Dialect, target: str
) -> None:
    project = sfc.loads((CALLED % (kind, *pins)).encode(), format="iec-text")
    project.dialect = dialect
    assert values(project) == EXPECTED[kind]
    data, report = sfc.convert(project, target)
    assert report.losses == []
    seen = sfc.loads(data, format=target, as_tool=True)
    assert values(seen) == EXPECTED[kind]
    assert values(sfc.loads(sfc.convert(seen, "plcopen-2.01")[0], as_tool=True)) == EXPECTED[kind]
