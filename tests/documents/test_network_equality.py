"""Networks that say the same, however they are drawn."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.documents.reading_back import mean_the_same
from plcopen_sfc.languages.networks import DrawingRules, draw_fbd, draw_ld
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.model.dialect import Dialect

TEXT = "Q1 := (B1 OR NOT B2) AND B3; Q2 := B4;"


def drawn(language: str, text: str = TEXT) -> m.LogicNetwork:
    draw = draw_fbd if language == "FBD" else draw_ld
    body = draw(parse_statements(text).tree.statements, DrawingRules()).body
    return m.LogicNetwork(nodes=[node for network in body.networks for node in network.nodes])


def undrawn(network: m.LogicNetwork) -> m.LogicNetwork:
    """The same without places; operands without modifiers stand at the pins that they are wired to."""
    copy = network.model_copy(deep=True)
    for node in copy.nodes:
        node.position, node.width, node.height = (0, 0), None, None
    operands = {n.id: n.expression for n in copy.nodes if isinstance(n, m.InputVariable) and not n.negated}
    for node in copy.nodes:
        pins = (
            [p.input for p in node.parameters.inputs] if isinstance(node, m.Block) else [getattr(node, "input", None)]
        )
        for pin in pins:
            if pin is not None and len(pin.connections) == 1 and pin.connections[0].source in operands:
                pin.expression = operands[pin.connections[0].source]
                pin.connections = []
    copy.nodes = [node for node in copy.nodes if node.id not in operands]
    return copy


@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_places_and_operands_at_pins_say_nothing(language: str) -> None:
    network = drawn(language)
    other = undrawn(network)
    assert other != network
    assert mean_the_same(network, other, Dialect.IEC)


@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize("text", [TEXT.replace("B4", "NOT B4"), TEXT.replace("OR", "XOR"), "Q2 := B4; Q1 := B1;", ""])
def test_other_logic_is_told(language: str, text: str) -> None:
    assert not mean_the_same(drawn(language), drawn(language, text), Dialect.IEC)


def test_what_stands_beside_the_logic_counts() -> None:
    network = drawn("FBD")
    for field, value in (
        ("comment", "why"),
        ("global_id", "7"),
        ("extension_data", m.ExtensionData(attributes={"a": "b"})),
    ):
        other = network.model_copy(deep=True)
        setattr(other.nodes[0], field, value)
        assert not mean_the_same(other, network, Dialect.IEC), field
    other = network.model_copy(deep=True)
    other.nodes.append(m.CommentBox(id=99, content="title"))
    assert not mean_the_same(other, network, Dialect.IEC)


@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_reports_of_conversions_tell_logic_from_drawing(language: str) -> None:
    bodies = [(m.FbdBody if language == "FBD" else m.LdBody)(networks=[drawn(language)])]
    names = {word for word in TEXT.replace(";", " ").replace("(", " ").replace(")", " ").split() if word[-1].isdigit()}
    variables = [m.Variable(name=name, type=m.ElementaryType(name=m.Elementary.BOOL)) for name in sorted(names)]
    interface = m.Interface(sections=[m.VariableSection(kind=m.SectionKind.LOCAL, variables=variables)])
    pou = m.Pou(name="Logic", kind=m.PouKind.FUNCTION_BLOCK, interface=interface, bodies=bodies)
    for target in ("simaticml", "codesys", "plcopen-2.01", "iec-text"):
        _, report = sfc.convert(m.Project(name="p", pous=[pou]), target)
        assert [item for item in report.items if item.outcome is sfc.Outcome.DROPPED] == [], target
