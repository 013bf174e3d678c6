"""Networks for the tools that they are for: blocks, pins, sheets, and what comes back from the files."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.formats.codesys.codesys_codec import validate_codesys
from plcopen_sfc.languages.networks import draw_fbd
from plcopen_sfc.languages.networks.element_places import on_one_sheet
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering import LoweredPou, lower
from tests.corpus import XSD
from tests.lowering.charts import act, pou_with, training_chain
from tests.sweeps import examples

TARGETS = ["plcopen-1.01", "plcopen-2.0", "plcopen-2.01", "codesys", "simaticml"]


def project() -> m.Project:
    """A chain with flip-flops, edges and timers in its actions."""
    chart = training_chain().sfc
    assert chart is not None
    chart.steps[1].comment = "Cylinder moves out"
    chart.transitions[1].comment = "Cylinder is out"
    act(chart, chart.steps[1], "Q4", m.Qualifier.SD, duration="T#20ms")
    act(chart, chart.steps[3], "Q4", m.Qualifier.R)
    for qualifier in (m.Qualifier.P, m.Qualifier.P0):
        act(chart, chart.steps[2], "Q5", qualifier)
    return m.Project(name="Plant", pous=[pou_with(chart)])


def written(target: str, language: str, **options: str) -> tuple[LoweredPou, bytes]:
    lowered = lower(project(), "flipflop", language=language, target=target, verify=False, **options)  # type: ignore[arg-type]
    return lowered, sfc.dumps(lowered.project, format=target, partial=True)


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize("target", TARGETS)
def test_what_comes_back_from_the_file_is_proven(target: str, language: str, profile: str) -> None:
    lowered, content = written(target, language, profile=profile, init="Init")
    found = equivalent(project(), sfc.loads(content), profile, fixed=lowered.at_rest)
    assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize("target", ["plcopen-1.01", "plcopen-2.0", "plcopen-2.01", "codesys"])
def test_files_are_valid(target: str, language: str) -> None:
    _, content = written(target, language, lang="de")
    assert validate_codesys(content) == []
    names = {
        "plcopen-1.01": "plcopen/TC6_XML_V10_B.xsd",
        "plcopen-2.0": "plcopen/tc6_xml_v200.xsd",
        "plcopen-2.01": "plcopen/tc6_xml_v201.xsd",
    }
    path = XSD / names.get(target, "")
    if target not in names or not path.is_file():
        pytest.skip("the official schema is not here")
    schema = etree.XMLSchema(etree.parse(str(path)))
    assert schema.validate(etree.fromstring(content)), schema.error_log


def parts(content: bytes) -> list[tuple[str, list[tuple[str, dict[str, str]]]]]:
    """The networks of a file of TIA Portal: their titles, and their parts with operands and wired pins."""
    tree = etree.fromstring(content)
    found = []
    for unit in tree.iter("{*}SW.Blocks.CompileUnit"):
        title = "".join(unit.xpath(".//MultilingualText[@CompositionName='Title']//Text/text()"))
        accesses = {access.get("UId"): access.iter("{*}Component") for access in unit.iter("{*}Access")}
        operands = {number: "".join(c.get("Name") for c in names) for number, names in accesses.items()}
        pins: dict[str, dict[str, str]] = {}
        for wire in unit.iter("{*}Wire"):
            ends = list(wire)
            for end in ends:
                if etree.QName(end).localname == "NameCon":
                    other = next((operands[e.get("UId")] for e in ends if e.get("UId") in operands), "")
                    pins.setdefault(end.get("UId"), {})[end.get("Name")] = other
        found.append((title, [(p.get("Name"), pins.get(p.get("UId"), {})) for p in unit.iter("{*}Part")]))
    return found


@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_tia_portal_gets_one_network_for_each_step(language: str) -> None:
    _, content = written("simaticml", language, lang="de", init="Init")
    networks = parts(content)
    for number in range(1, 5):
        title = f"Schritt {number}" + (" – Initialschritt" if number == 1 else "")
        (boxes,) = [boxes for name, boxes in networks if name == title]
        (flip_flop,) = [pins for name, pins in boxes if name == "Sr"]
        assert flip_flop["operand"] == f"X{number}"
        assert {"s", "r1", "operand"} == set(flip_flop)
    assert b"nodes" not in content, "all is said in networks"
    assert [name for name, _ in networks][:4] == [f"Transition S{n} -> S{n % 4 + 1}" for n in range(1, 5)]


def test_tia_portal_knows_every_box_and_type() -> None:
    _, content = written("simaticml", "FBD")
    text = content.decode("utf-8-sig")
    assert set(re.findall(r'Datatype="([^"]+)"', text)) == {"Bool", "TON_TIME"}
    assert set(re.findall(r'Part Name="([^"]+)"', text)) == {"A", "O", "Coil", "Sr", "TON", "PBox", "NBox"}
    assert 'Datatype="TON_TIME" Version="1.0"' in text
    assert re.search(r'<Part Name="TON" UId="\d+" Version="1.0">|<Part Name="TON" Version="1.0" UId="\d+">', text)
    assert '<TemplateValue Name="time_type" Type="Type">Time</TemplateValue>' in text
    assert "Cylinder moves out" in text
    assert "Cylinder is out" in text
    assert "OpenCon" not in re.sub(r'<NameCon UId="\d+" Name="ET" />\s*<OpenCon', "", text)


def test_codesys_gets_its_own_pins_and_knows_what_is_called() -> None:
    lowered, content = written("codesys", "FBD")
    body = lowered.pou.body
    assert isinstance(body, m.FbdBody)
    (sheet,) = body.networks
    blocks = [node for node in sheet.nodes if isinstance(node, m.Block) and node.type_name == "RS"]
    assert blocks
    for block in blocks:
        assert [pin.name for pin in block.parameters.inputs] == ["SET", "RESET1"]
        assert block.call is m.BlockCall.FUNCTION_BLOCK
    assert [node.id // 10**10 for node in sheet.nodes] == sorted(node.id // 10**10 for node in sheet.nodes)
    assert b"networktitle" not in content


def test_a_ladder_of_codesys_has_one_pair_of_rails_and_titles() -> None:
    lowered, content = written("codesys", "LD")
    body = lowered.pou.body
    assert isinstance(body, m.LdBody)
    (sheet,) = body.networks
    assert [node.id for node in sheet.nodes if isinstance(node, m.LeftPowerRail)] == [0]
    assert [node.id for node in sheet.nodes if isinstance(node, m.RightPowerRail)] == [2**31 - 2]
    titles = [m.plain(node.alternative_text) for node in sheet.nodes if isinstance(node, m.VendorElement)]
    assert titles[4:8] == ["Step 1 – initial step", "Step 2", "Step 3", "Step 4"]
    assert content.count(b"networktitle") == len(titles)


def boxes_of(sheet: m.LogicNetwork) -> list[tuple[float, float, float, float]]:
    return [(*n.position, n.position[0] + (n.width or 0), n.position[1] + (n.height or 0)) for n in sheet.nodes]


@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_nothing_covers_anything_else_on_the_sheet(language: str) -> None:
    lowered, _ = written("plcopen-2.01", language)
    body = lowered.pou.body
    assert isinstance(body, m.FbdBody | m.LdBody)
    (sheet,) = body.networks
    boxes = boxes_of(sheet)
    for index, (left, top, right, bottom) in enumerate(boxes):
        for other in boxes[index + 1 :]:
            assert right <= other[0] or other[2] <= left or bottom <= other[1] or other[3] <= top
    orders = [node.execution_order for node in sheet.nodes if node.execution_order]
    assert sorted(orders) == list(range(1, len(orders) + 1))
    titles = [m.plain(node.content).splitlines() for node in sheet.nodes if isinstance(node, m.CommentBox)]
    assert ["Step 2", "Cylinder moves out"] in titles


@pytest.mark.parametrize("language", ["FBD", "LD", "ST", "IL"])
def test_a_chart_that_does_nothing_is_code_that_does_nothing(language: str) -> None:
    body = m.SfcBody(chart=m.SfcNetwork())
    alone = m.Project(name="Plant", pous=[m.Pou(name="Main", kind=m.PouKind.PROGRAM, bodies=[body])])
    for target in TARGETS:
        if language == "IL" and target == "simaticml":
            continue  # has no instruction list
        lowered = lower(alone, "flipflop", language=language, target=target, verify=False)
        assert lowered.language == language
        assert sfc.loads(sfc.dumps(lowered.project, format=target, partial=True)).pou("Main").sfc is None


@pytest.mark.parametrize("form", ["plcopen-2.01", "codesys"])
def test_networks_of_others_stand_below_each_other_in_files_of_tc6(form: str) -> None:
    """Who lowers without a target saves networks; other tools than ours see the sheet only."""
    lowered = lower(project(), "flipflop", verify=False)
    body = lowered.pou.body
    assert isinstance(body, m.FbdBody)
    assert len(body.networks) > 4
    content = sfc.dumps(lowered.project, format=form)
    bare = re.sub(rb'<data name="urn:plcopen-sfc.*?</data>', b"", content, flags=re.DOTALL)
    again = sfc.loads(bare)
    (sheet,) = again.pous[0].body.networks  # type: ignore[union-attr]
    orders = [node.execution_order for node in sheet.nodes if node.execution_order]
    assert sorted(orders) == list(range(1, len(orders) + 1))
    found = equivalent(project(), again, "iec")
    assert found.kind is VerdictKind.PROVEN, str(found)


NAMES = st.sampled_from(["a", "b", "c"])
TERMS = st.recursive(
    NAMES,
    lambda inner: st.builds("({} {} {})".format, inner, st.sampled_from(["AND", "OR"]), inner),
    max_leaves=5,
)


@settings(deadline=None, max_examples=examples(40))
@given(st.lists(st.lists(TERMS, min_size=1, max_size=3), min_size=1, max_size=4), st.sampled_from([None, Tool.CODESYS]))
def test_a_sheet_holds_all_networks_in_their_order(groups: list[list[str]], tool: Tool | None) -> None:
    networks = []
    for number, terms in enumerate(groups):
        lines = [f"q{number}_{place} := {term};" for place, term in enumerate(terms)]
        drawn = draw_fbd(parse_statements("\n".join(lines)).tree.statements)
        for network in drawn.body.networks:
            network.title = f"N{number}"
            networks.append(network)
    before = [network.model_copy(deep=True) for network in networks]
    sheet = on_one_sheet(networks, tool)
    assert networks == before
    sinks = sorted((n for n in sheet.nodes if isinstance(n, m.OutputVariable)), key=lambda n: n.execution_order or 0)
    expected = [f"q{number}_{place}" for number, terms in enumerate(groups) for place in range(len(terms))]
    assert [node.expression for node in sinks] == expected
    assert all(a.position[1] < b.position[1] for a, b in pairwise(sinks))
    ids = [node.id for node in sheet.nodes]
    assert len(set(ids)) == len(ids)


def test_the_dominance_is_that_of_the_tool(tmp_path: Path) -> None:
    """Reset wins: ``RS`` of IEC 61131-3 and CODESYS, ``Sr`` of TIA Portal."""
    for target, name in (("plcopen-2.01", "RS"), ("codesys", "RS"), ("simaticml", "Sr")):
        _, content = written(target, "FBD")
        path = tmp_path / f"{target}.xml"
        path.write_bytes(content)
        text = content.decode("utf-8-sig")
        assert f'"{name}"' in text
        assert not {"SR", "Rs"} & set(re.findall(r'(?:typeName|Part Name)="([^"]+)"', text))


@pytest.mark.parametrize("target", ["plcopen-2.01", "codesys", "simaticml"])
def test_numbers_that_are_written_under_a_condition_keep_their_values(target: str) -> None:
    plant = project()
    pou = plant.pous[0]
    assert pou.interface is not None
    assert pou.sfc is not None
    pou.interface.sections[1].variables.append(m.Variable(name="n", type=m.ElementaryType(name=m.Elementary.INT)))
    body = m.StBody(text="IF B5 THEN n := n + 1; END_IF; IF n > 3 THEN n := 1; END_IF;")
    pou.sfc.steps[1].actions.append(m.ActionAssociation(id=pou.sfc.new_id(), qualifier=m.Qualifier.N, body=body))
    lowered = lower(plant, "flipflop", language="FBD", target=target, profile="iec", verify=False)
    again = sfc.loads(sfc.dumps(lowered.project, format=target, partial=True), format=target)
    found = equivalent(plant, again, "iec", cap=5_000, runs=20)
    assert found.kind is VerdictKind.PROVEN, str(found)
