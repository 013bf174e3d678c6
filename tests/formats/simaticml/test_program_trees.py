"""Networks are read from light trees, equal ones once: nothing that the document has is lost on the way."""

from __future__ import annotations

import gc

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.formats.simaticml.element_reader import VERBATIM, DocumentReading, NotUnderstoodError, same_content
from plcopen_sfc.formats.simaticml.lad_fbd_networks import read_flgnet_body, read_network
from plcopen_sfc.formats.simaticml.program_comparison import parse_program, program_text
from plcopen_sfc.formats.simaticml.tia_versions import DEFAULT
from plcopen_sfc.model import Block, FbdBody, LdBody, LogicNetwork
from tests.documents.exports import FIXTURES

BOX = '<Part Name="Strange" UId="22" />'
WIRE = '<Wires><Wire UId="23"><IdentCon UId="21" /><NameCon UId="22" Name="a" /></Wire></Wires>'


def literal(value: str) -> str:
    return (
        '<Access Scope="LiteralConstant" UId="21"><Constant><ConstantType>Int</ConstantType>'
        f"<ConstantValue>{value}</ConstantValue></Constant></Access>"
    )


def net(parts: str, wires: str = WIRE) -> etree._Element:
    return etree.fromstring(
        f"<FlgNet>\n  <Parts>\n    {parts}\n  </Parts>\n  {wires}\n</FlgNet>", etree.XMLParser(strip_cdata=False)
    )


def read(element: etree._Element) -> LogicNetwork:
    return LogicNetwork.model_validate(read_network(DocumentReading(DEFAULT), element))


def operand(network: LogicNetwork) -> str | None:
    (block,) = network.nodes
    assert isinstance(block, Block)
    pin = block.parameters.inputs[0].input
    return pin.expression if pin is not None else None


TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=["Cs", "Cc"]), max_size=6)


@given(
    st.lists(TEXTS, min_size=1, max_size=3),
    st.sampled_from(["", "<!-- said -->", "<![CDATA[<&>]]>"]),
    st.sampled_from(["", "\n  ", "\r\n"]),
)
@settings(deadline=None)
def test_the_light_tree_has_every_text_and_attribute(texts: list[str], between: str, indent: str) -> None:
    """Only comments and blanks between elements are not there; neither are counted elsewhere."""
    root = etree.Element("{urn:n}a")
    for text in texts:
        child = etree.SubElement(root, "{urn:n}b", {"name": text})
        child.text = text
    source = etree.tostring(root, encoding="unicode").replace("</ns0:b>", f"{between}</ns0:b>{indent}")
    given_root = etree.fromstring(source, etree.XMLParser(strip_cdata=False))
    tree = parse_program(program_text(given_root))
    assert [child.tag for child in tree] == ["{urn:n}b"] * len(texts)
    assert [child.get("name") for child in tree] == [child.get("name") for child in given_root]
    assert [child.text or "" for child in tree] == ["".join(map(str, child.itertext())) for child in given_root]
    if "<!--" not in between:
        assert same_content(given_root, tree)


def test_what_stands_behind_a_comment_is_read() -> None:
    network = read(net(literal("1<!-- and -->2") + BOX))
    assert operand(network) == "12"
    assert network.extension_data is None or network.extension_data.data == []


def test_a_processing_instruction_is_kept() -> None:
    owner = etree.Element("Transition", ProgrammingLanguage="LAD")
    owner.append(net(literal("1") + "<?mark it?>" + BOX))
    ctx = DocumentReading(DEFAULT)
    body = read_flgnet_body(ctx, owner)
    assert "<?mark it?>" in body["content"]
    assert [diagnostic.code for diagnostic in ctx.diagnostics] == ["XML221"]
    with pytest.raises(NotUnderstoodError):
        read(owner[0])


def test_numbers_of_parts_without_wires_are_kept() -> None:
    network = read(net('<Part Name="Strange" UId="25" />', ""))
    assert network.extension_data is not None
    assert network.extension_data.attributes == {"UId numbers": "25"}


def test_blanks_in_a_value_are_content() -> None:
    network = read(net(f'{literal("1")}<Part Name="Calc" UId="22"><Equation>  </Equation></Part>'))
    (block,) = network.nodes
    assert block.extension_data is not None
    assert block.extension_data.attributes["Equation"] == "  "


def test_what_we_would_write_otherwise_is_kept_as_it_stands() -> None:
    network = read(net(literal("1").replace("<ConstantType>Int</ConstantType>", "") + BOX))
    assert network.extension_data is not None
    assert [data.name for data in network.extension_data.data] == [VERBATIM]


def test_equal_networks_have_objects_of_their_own() -> None:
    one, other = read(net(literal("1") + BOX)), read(net(literal("1") + BOX))
    assert one == other
    (block,) = one.nodes
    assert isinstance(block, Block)
    block.parameters.inputs.clear()
    assert operand(other) == operand(read(net(literal("1") + BOX))) == "1"


@pytest.mark.slow
def test_documents_loaded_one_after_the_other_keep_their_content() -> None:
    """Only the document that was loaded last has its tree still, and one that somebody reads."""
    names = ("FB_Drill", "FB_Motor", "Machine", "FB_Drill_DB")
    alone = {}
    for name in names:
        project = sfc.load(FIXTURES / f"{name}.xml")
        project.read_all()
        alone[name] = project
    together = {name: sfc.load(FIXTURES / f"{name}.xml") for name in names}
    assert together["FB_Motor"].pous[0].interface == alone["FB_Motor"].pous[0].interface
    sfc.load(FIXTURES / "FC_Release.xml")
    gc.collect()
    for name in names:
        assert together[name] == alone[name]
        assert together[name].diagnostics == alone[name].diagnostics


def test_an_edit_of_a_document_does_not_show_in_the_next_load() -> None:
    first, before = sfc.load(FIXTURES / "FC_Release.xml"), sfc.load(FIXTURES / "FC_Release.xml")
    before.read_all()
    networks = [net for body in first.pous[0].bodies if isinstance(body, FbdBody | LdBody) for net in body.networks]
    assert networks
    for network in networks:
        network.nodes.clear()
    assert sfc.load(FIXTURES / "FC_Release.xml") == before != first
