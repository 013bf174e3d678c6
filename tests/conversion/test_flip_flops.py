"""Flip-flops of TIA Portal, which keep their state in a variable, in tools whose flip-flops are instances."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.model.compare import differences
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.programs import Controller
from tests.samples import FIXTURES

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
    + [("SR", ("SET1", "RESET"), m.Dialect.CODESYS), ("RS", ("SET", "RESET1"), m.Dialect.CODESYS)]
    + [("SR", ("S1", "RESET"), m.Dialect.IEC), ("RS", ("S", "RESET1"), m.Dialect.CODESYS)],  # mixed
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


PINS_IN_TOOLS = {
    "SR": ("S1 R", "SET1 RESET"),
    "RS": ("S R1", "SET RESET1"),
    "CTU": ("CU R PV", "CU RESET PV"),
    "CTD": ("CD LD PV", "CD LOAD PV"),
    "CTUD": ("CU CD R LD PV", "CU CD RESET LOAD PV"),
}


def calling(kind: str, pins: str, dialect: m.Dialect) -> m.Project:
    """A block that calls an instance in ST, IL and a box, and writes one of its inputs."""
    names = pins.split()
    values = {name: "3" if name == "PV" else "a" for name in names}
    call = f"f({', '.join(f'{name} := {value}' for name, value in values.items())})"
    text = (
        f"FUNCTION_BLOCK Main VAR_INPUT a : BOOL; END_VAR VAR f, f2 : {kind}; many : ARRAY [0..1] OF {kind}; END_VAR\n"
    )
    text += f"{call}; many[1].{names[1]} := a;\n"
    text += f"ACTION List:\nCAL {call}\nLD a\nST f.{names[1]}\nEND_ACTION\nEND_FUNCTION_BLOCK"
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = dialect
    inputs = [m.BlockVariable(name=n, input=m.InputPin(expression=value)) for n, value in values.items()]
    box = m.Block(id=1, type_name=kind, instance="f2", parameters=m.BlockParameters(inputs=inputs))
    body = m.FbdBody(networks=[m.LogicNetwork(nodes=[box])])
    project.pous[0].actions.append(m.Action(name="Drawn", body=body))
    return project


@pytest.mark.parametrize("target", ["codesys", "codesys23", "plcopen-2.01"])
@pytest.mark.parametrize("kind", PINS_IN_TOOLS)
def test_inputs_of_flip_flops_and_counters_have_the_names_of_the_tool(kind: str, target: str) -> None:
    iec, codesys = PINS_IN_TOOLS[kind]
    to_iec = target.startswith("plcopen")
    source = calling(kind, codesys, m.Dialect.CODESYS) if to_iec else calling(kind, iec, m.Dialect.IEC)
    result = sfc.loads(sfc.dumps(source, format=target, partial=True), as_tool=True)
    mistaken = [each for each in sfc.check(result, select=["VAR01"]) if "parameter" in each.message]
    assert mistaken == []
    written = sfc.dumps(result, format="json").decode()
    wanted, other = (set(each.split()) for each in ((iec, codesys) if to_iec else (codesys, iec)))
    used = set(re.findall(r"\b(\w+) :=|many\[1\]\.(\w+)|ST f\.(\w+)", written))
    found = {name for names in used for name in names if name}
    assert wanted <= found
    assert not (other - wanted) & found


@pytest.mark.parametrize(("dialect", "wrong"), [(m.Dialect.IEC, 1), (m.Dialect.CODESYS, 0), (m.Dialect.SCL, None)])
def test_inputs_have_the_names_that_their_own_tool_gives_them(dialect: m.Dialect, wrong: int | None) -> None:
    for kind, names in PINS_IN_TOOLS.items():
        for number, pins in enumerate(names):
            project = calling(kind, pins, dialect)
            bound = Names(project)
            assert bool(list(bound.undeclared_members())) is (number == wrong), (kind, pins)


def test_what_counters_have_counted_is_int_in_beremiz() -> None:
    project = sfc.loads(
        b"PROGRAM Main VAR c : CTU; n : INT; d : DINT; w : WORD; END_VAR\n"
        b"n := WORD_TO_INT(c.CV); d := WORD_TO_DINT((c.CV)) + WORD_TO_DINT(w);\nEND_PROGRAM",
        format="iec-text",
    )
    project.dialect = m.Dialect.CODESYS
    result = sfc.loads(sfc.dumps(project, format="plcopen", flavour="beremiz", partial=True), as_tool=True)
    body = result.pou("Main").body
    assert isinstance(body, m.StBody)
    assert body.text.split(";")[:2] == ["n := c.CV", " d := INT_TO_DINT(c.CV) + WORD_TO_DINT(w)"]


@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize("source", ["codesys.xml", "plcopen_2.01.xml"])
def test_flip_flops_of_a_chart_go_to_tia_portal_at_once_and_by_way_of_another_tool(source: str, language: str) -> None:
    project = sfc.load(FIXTURES / "training-chain" / source)
    form = project.source.format
    lowered = sfc.lower(project, "flipflop", language=language, target="simaticml")
    in_tia = sfc.loads(sfc.dumps(lowered.project, format="simaticml"), as_tool=True)
    assert sfc.equivalent(project.pou("Ablauf"), in_tia.pou("Ablauf")).equal
    if (source, language) == ("codesys.xml", "LD"):
        return  # ladders of CODESYS have elements of its own
    boxes = sfc.lower(project, "flipflop", language=language, target=form)
    moved = sfc.convert(boxes.project, "simaticml", limit=20)
    assert not moved.report.losses
    assert moved.data.count(b'Name="Sr"') >= 4
