"""LAD and FBD networks: read, written back, and conditions that become networks and say the same."""

from __future__ import annotations

import operator
from collections import Counter
from collections.abc import Mapping
from itertools import product
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from plcopen_sfc.formats.simaticml.element_reader import VERBATIM, DocumentReading, NotUnderstoodError, same_content
from plcopen_sfc.formats.simaticml.flgnet_reader import read_flgnet
from plcopen_sfc.formats.simaticml.graph_conditions import condition_body
from plcopen_sfc.formats.simaticml.lad_fbd_networks import read_network, write_flgnet
from plcopen_sfc.formats.simaticml.network_operands import parse_operand, read_operand, write_operand
from plcopen_sfc.formats.simaticml.program_comparison import lengthened, numbers_like, shortened
from plcopen_sfc.formats.simaticml.tia_versions import DEFAULT
from plcopen_sfc.languages.networks.condition_reading import condition_expression
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model import Block, BodyCondition, Coil, Dialect, Expression, Jump, Label, LogicNetwork, SfcNetwork
from tests.formats.simaticml.documents import parsed, real_documents


def networks() -> list[etree._Element]:
    return [net for path in real_documents() for net in parsed(path.read_bytes()).iter("{*}FlgNet")]


KEPT_BESIDE = {"a literal without a type, in a sketch": 1, "an empty list of wires": 1}
"""Networks whose content the model has, and that we would write otherwise: how many, and why."""
NOT_READ = {
    "a wire has one end only": 1,
    "a contact or coil without an operand or input": 8,  # four versions of a block made by hand, wires the wrong way
}
"""Networks that the model does not have: how many, and why. They are kept whole."""


@pytest.mark.corpus
@pytest.mark.slow
def test_networks_of_the_corpus_are_in_the_model() -> None:
    """All but a few made by hand, and written from the model they say the same, to the last number."""
    outcomes: Counter[str] = Counter()
    reasons: Counter[str] = Counter()
    ctx = DocumentReading(DEFAULT)
    for net in networks():
        try:
            fields = read_network(ctx, net)
        except NotUnderstoodError as error:
            outcomes["not read"] += 1
            reasons[str(error)] += 1
            continue
        kept = any(data["name"] == VERBATIM for data in fields.get("extension_data", {}).get("data", []))
        outcomes["kept beside" if kept else "in the model"] += 1
        if not kept:
            copy = etree.Element(net.tag)
            write_flgnet(copy, LogicNetwork.model_validate(fields))
            assert numbers_like(net, copy) is not None
            assert sorted(uids(copy)) == sorted(uids(net))
    if not outcomes:
        pytest.skip("no corpus beside the repository")
    assert outcomes["kept beside"] == sum(KEPT_BESIDE.values())
    assert reasons == NOT_READ
    assert outcomes["in the model"] > 50 * (outcomes["kept beside"] + outcomes["not read"])


def uids(net: etree._Element) -> list[str]:
    return [str(element.get("UId")) for element in net.iter(etree.Element) if element.get("UId") is not None]


VARIABLES = ("#a", "#b", "#c.d", '"Tag"', '"DB".x', '#"with blank"', "#e[1].f")
NAMES = st.sampled_from(VARIABLES)


def operations(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    pairs = st.lists(inner, min_size=2, max_size=3)
    return (
        pairs.map(lambda parts: "(" + " AND ".join(parts) + ")")
        | pairs.map(lambda parts: "(" + " OR ".join(parts) + ")")
        | inner.map(lambda part: f"NOT {part}")
    )


COMPARISONS = st.tuples(st.sampled_from(["#n", "#m"]), st.sampled_from(["<", ">=", "=", "<>"]), st.integers(0, 9)).map(
    lambda parts: f"({parts[0]} {parts[1]} {parts[2]})"
)
LOGIC = st.recursive(NAMES, operations, max_leaves=8)
MIXED = st.recursive(NAMES | COMPARISONS, operations, max_leaves=8)


def value(tree: n.Expression, values: Mapping[str, Any]) -> Any:
    """The value of an expression where variables have these values."""
    if isinstance(tree, n.Parenthesized):
        return value(tree.inner, values)
    if isinstance(tree, n.Unary):
        assert tree.operator is n.Operator.NOT
        return not value(tree.operand, values)
    if isinstance(tree, n.Operation):
        parts = [value(operand, values) for operand in tree.operands]
        if tree.operator is n.Operator.AND:
            return all(parts)
        if tree.operator is n.Operator.OR:
            return any(parts)
        return COMPARE[tree.operator](*parts)
    text = print_node(tree)
    if text in ("TRUE", "FALSE"):
        return text == "TRUE"
    return int(text) if text.isdigit() else values[text]


COMPARE = {
    n.Operator.LESS: operator.lt,
    n.Operator.GREATER_OR_EQUAL: operator.ge,
    n.Operator.EQUAL: operator.eq,
    n.Operator.UNEQUAL: operator.ne,
}


def through_xml(text: str) -> tuple[str, n.Expression, n.Expression]:
    """The language of the network that a condition becomes, and the expressions behind and before the file."""
    body = condition_body(Expression(text=text), "TrCoil")
    assert body is not None
    element = etree.Element("FlgNet")
    write_flgnet(element, body.networks[0], {"#n": "Int", "#m": "Int"})
    again = body.model_copy(update={"networks": [LogicNetwork.model_validate({"nodes": read_flgnet(element)})]})
    chart = SfcNetwork()
    transition = chart.add_transition([], [], BodyCondition(body=again, name="TrCoil"))
    read = condition_expression(chart, transition, Dialect.SCL)
    wanted = parse_expression(text, Dialect.SCL).tree
    assert read.tree is not None
    assert wanted is not None
    assert not read.before
    return body.language, read.tree, wanted


@given(text=LOGIC)
def test_boolean_logic_becomes_a_ladder_that_says_the_same(text: str) -> None:
    language, read, wanted = through_xml(text)
    assert language == "LD"
    for values in product((False, True), repeat=len(VARIABLES)):
        row = dict(zip(VARIABLES, values, strict=True))
        assert value(read, row) == value(wanted, row)


@given(text=MIXED, values=st.tuples(*[st.booleans()] * len(VARIABLES)), numbers=st.tuples(*[st.integers(0, 9)] * 2))
def test_any_condition_becomes_a_network_that_says_the_same(
    text: str, values: tuple[bool, ...], numbers: tuple[int, int]
) -> None:
    _, read, wanted = through_xml(text)
    row = {**dict(zip(VARIABLES, values, strict=True)), "#n": numbers[0], "#m": numbers[1]}
    assert value(read, row) == value(wanted, row)


OPERANDS = (
    "#a",
    '"DB".a.b',
    '#"with blank".x',
    '"DB"."a.b"',
    "#a[1]",
    "#a[#i, 2].b",
    '"DB".a[#b[1]].c',
    "#w.%X3",
    "%I0.1",
    "%QW4",
    "%MD8",
    "TRUE",
    "16#FF",
    "-1.5",
    "T#5S",
    "'text'",
)


@pytest.mark.parametrize("text", OPERANDS)
def test_operands_come_back(text: str) -> None:
    holder = etree.Element("Parts")
    write_operand(holder, text, "Int")
    assert read_operand(holder[0]) == text


@pytest.mark.parametrize("text", ["", "#a + 1", "#a.", "#a[", "#", '"a', "#a b", "NOT #a", "%X1"])
def test_what_is_no_operand(text: str) -> None:
    assert parse_operand(text) is None
    with pytest.raises(NotUnderstoodError):
        write_operand(etree.Element("Parts"), text, "")


DAMAGED = (
    '<Wires><Wire UId="30"><Powerrail /><NameCon UId="99" Name="in" /></Wire></Wires>',
    '<Wires><Wire UId="30"><IdentCon UId="99" /><NameCon UId="21" Name="in" /></Wire></Wires>',
    '<Wires><Wire UId="30"><Powerrail /></Wire></Wires>',
    '<Wires><Wire UId="30"><Powerrail /><NameCon UId="21" Name="unknown" /></Wire></Wires>',
    '<Wires><Wire UId="30"><Openbranch /><NameCon UId="21" Name="in" /></Wire></Wires>',
)


@pytest.mark.parametrize("wires", DAMAGED)
def test_damaged_networks_are_not_understood(wires: str) -> None:
    net = etree.fromstring(f'<FlgNet><Parts><Part Name="TrCoil" UId="21" /></Parts>{wires}</FlgNet>')
    with pytest.raises(NotUnderstoodError):
        read_flgnet(net)


def through_model(content: str) -> tuple[LogicNetwork, etree._Element, etree._Element]:
    """A network, as it is read, and as it is written from that."""
    net = etree.fromstring(f"<FlgNet>{content}</FlgNet>")
    network = LogicNetwork.model_validate(read_network(DocumentReading(DEFAULT), net))
    copy = etree.Element("FlgNet")
    write_flgnet(copy, network)
    return network, net, copy


CONTACT = """<Access Scope="LocalVariable" UId="22"><Symbol><Component Name="a" /></Symbol></Access>"""
JUMP = f"""
<Labels><LabelDeclaration UId="21"><Label Name="Again" /></LabelDeclaration></Labels>
<Parts>{CONTACT}<Access Scope="Label" UId="23"><Label Name="End" /></Access>
<Part Name="Contact" UId="24" /><Part Name="Jump" UId="25" /></Parts>
<Wires><Wire UId="26"><Powerrail /><NameCon UId="24" Name="in" /></Wire>
<Wire UId="27"><IdentCon UId="22" /><NameCon UId="24" Name="operand" /></Wire>
<Wire UId="28"><NameCon UId="24" Name="out" /><NameCon UId="25" Name="in" /></Wire>
<Wire UId="29"><IdentCon UId="23" /><NameCon UId="25" Name="label" /></Wire></Wires>"""


def test_a_jump_and_a_label() -> None:
    network, net, copy = through_model(JUMP)
    assert [(node.kind, node.label) for node in network.nodes if isinstance(node, Jump | Label)] == [
        ("label", "Again"),
        ("jump", "End"),
    ]
    assert same_content(net, copy)
    assert network.extension_data is None


def test_a_return() -> None:
    content = JUMP.replace('Name="Jump"', 'Name="Return"').partition('<Access Scope="Label"')
    content_without = content[0] + content[2].partition("</Access>")[2]
    content_without = content_without.replace(
        '<Wire UId="29"><IdentCon UId="23" /><NameCon UId="25" Name="label" /></Wire>', ""
    )
    network, net, copy = through_model(content_without)
    assert [node.kind for node in network.nodes][-1] == "return"
    assert numbers_like(net, copy) is not None
    # 23, the operand that is gone, is a number that nothing has
    assert network.extension_data is not None
    assert network.extension_data.attributes == {"UId numbers": "21-22 24-28"}


def test_a_coil_whose_input_is_negated_reads_the_inverse() -> None:
    network, net, copy = through_model(
        f"""<Parts>{CONTACT}<Access Scope="LocalVariable" UId="23"><Symbol><Component Name="b" /></Symbol></Access>
        <Part Name="SCoil" UId="24"><Negated Name="in" /></Part></Parts>
        <Wires><Wire UId="25"><IdentCon UId="22" /><NameCon UId="24" Name="in" /></Wire>
        <Wire UId="26"><IdentCon UId="23" /><NameCon UId="24" Name="operand" /></Wire></Wires>"""
    )
    inverter, coil = network.nodes
    assert isinstance(inverter, Block)
    assert inverter.type_name == "NOT"
    assert isinstance(coil, Coil)
    assert coil.input is not None
    assert [wire.source for wire in coil.input.connections] == [inverter.id]
    assert numbers_like(net, copy) is not None
    assert uids(copy) == uids(net)


EDGES = ("PContact", "NContact")


@pytest.mark.parametrize("name", EDGES)
def test_edge_contacts_have_a_memory(name: str) -> None:
    network, net, copy = through_model(
        f"""<Parts>{CONTACT}<Access Scope="LocalVariable" UId="23"><Symbol><Component Name="m" /></Symbol></Access>
        <Part Name="{name}" UId="24" /><Part Name="TrCoil" UId="25" /></Parts>
        <Wires><Wire UId="26"><Powerrail /><NameCon UId="24" Name="pre" /></Wire>
        <Wire UId="27"><IdentCon UId="22" /><NameCon UId="24" Name="operand" /></Wire>
        <Wire UId="28"><IdentCon UId="23" /><NameCon UId="24" Name="bit" /></Wire>
        <Wire UId="29"><NameCon UId="24" Name="out" /><NameCon UId="25" Name="in" /></Wire></Wires>"""
    )
    edge = next(node for node in network.nodes if isinstance(node, Block))
    pins = {pin.name: pin.input.expression for pin in edge.parameters.inputs if pin.input is not None}
    assert pins == {"pre": None, "operand": "#a", "bit": "#m"}
    assert numbers_like(net, copy) is not None


def test_a_part_says_its_types_and_what_it_hides() -> None:
    part = """<Part Name="Calc" UId="23" DisabledENO="true"><Equation>IN1 + 1</Equation>
    <TemplateValue Name="Card" Type="Cardinality">1</TemplateValue><AutomaticTyped Name="SrcType" />
    <Invisible Name="eno" /><Invisible Name="x" /></Part>"""
    network, net, copy = through_model(
        f"""<Parts>{CONTACT}{part}</Parts><Wires><Wire UId="24"><Powerrail /><NameCon UId="23" Name="en" /></Wire>
        <Wire UId="25"><IdentCon UId="22" /><NameCon UId="23" Name="in1" /></Wire></Wires>"""
    )
    assert same_content(net, copy) or numbers_like(net, copy) is not None
    assert network.nodes[-1].extension_data is not None
    assert network.nodes[-1].extension_data.attributes["Invisible"] == "eno,x"


LITERALS = """<Parts>
<Access Scope="LiteralConstant" UId="21"><Constant><ConstantType>USInt</ConstantType>
<ConstantValue>0</ConstantValue></Constant></Access>
<Access Scope="LiteralConstant" UId="22"><Constant><ConstantType>UDInt</ConstantType><ConstantValue>0</ConstantValue>
<StringAttribute Name="Format" Informative="true">Dec</StringAttribute></Constant></Access>
<Access Scope="GlobalVariable" UId="23"><Symbol><Component Name="DB" /><Component Name="x" />
<Address Area="DB" Type="Bool" BlockNumber="7" BitOffset="3" Informative="true" /></Symbol></Access>
<Part Name="Strange" UId="24" /></Parts><Wires>
<Wire UId="25"><IdentCon UId="21" /><NameCon UId="24" Name="a" /></Wire>
<Wire UId="26"><IdentCon UId="22" /><NameCon UId="24" Name="b" /></Wire>
<Wire UId="27"><IdentCon UId="23" /><NameCon UId="24" Name="c" /></Wire></Wires>"""


def test_what_the_text_of_an_operand_does_not_say_is_kept() -> None:
    network, net, copy = through_model(LITERALS)
    assert same_content(net, copy)
    assert network.extension_data is not None
    assert network.extension_data.data == []
    (part,) = network.nodes
    assert isinstance(part, Block)
    assert [pin.input.expression for pin in part.parameters.inputs if pin.input is not None] == ["0", "0", '"DB".x']


@given(st.lists(st.integers(0, 60), unique=True, max_size=12))
def test_numbers_in_short_form(numbers: list[int]) -> None:
    texts = [str(number) for number in numbers]
    usual = [str(number) for number in range(21, 21 + len(texts))]
    assert lengthened(shortened(texts, usual), usual) == texts


@pytest.mark.parametrize("text", ["x", "1-", "5-3", "1-999999999", "3 3", "1-2 2-3"])
def test_damaged_numbers_are_the_usual_ones(text: str) -> None:
    usual = ["21", "22", "23", "24"]
    assert lengthened(text, usual) == usual
