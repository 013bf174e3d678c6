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

from plcopen_sfc.formats.simaticml.conditions import condition_body
from plcopen_sfc.formats.simaticml.networks_reader import operand_hints, read_flgnet
from plcopen_sfc.formats.simaticml.networks_writer import write_flgnet
from plcopen_sfc.formats.simaticml.operands import parse_operand, read_operand, write_operand
from plcopen_sfc.formats.simaticml.reading import NotUnderstoodError, same
from plcopen_sfc.languages.networks.conditions import condition_expression
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model import BodyCondition, Dialect, Expression, LogicNetwork, SfcNetwork
from tests.formats.simaticml.documents import parsed, real_documents


def networks() -> list[etree._Element]:
    return [net for path in real_documents() for net in parsed(path.read_bytes()).iter("{*}FlgNet")]


@pytest.mark.corpus
@pytest.mark.slow
def test_networks_of_the_corpus_are_written_as_they_were() -> None:
    """Most of them to the last id; what is not is kept beside the model."""
    fates: Counter[str] = Counter()
    for net in networks():
        try:
            fields = {"nodes": read_flgnet(net), "carried": {"attributes": operand_hints(net)}}
        except NotUnderstoodError:
            fates["opaque"] += 1
            continue
        copy = etree.Element("FlgNet")
        write_flgnet(copy, LogicNetwork.model_validate(fields))
        fates["same" if same(net, copy) else "kept"] += 1
        again = LogicNetwork.model_validate({**fields, "nodes": read_flgnet(copy)}) if len(copy) else None
        assert again is None or len(again.nodes) == len(fields["nodes"])
    if not fates:
        pytest.skip("no corpus beside the repository")
    total = fates.total()
    assert fates["same"] / total > 0.8
    assert fates["opaque"] / total < 0.03


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
    """What an expression is where variables have these values."""
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
    text = print_node(tree, Dialect.SCL)
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
