"""As many things in the model as elements in the file."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.formats.simaticml.network_boxes import INVERTED
from plcopen_sfc.model import Block, FbdBody, Label, LdBody, LeftPowerRail, LogicNetwork, Project
from plcopen_sfc.model.types import SimpleValue
from tests.formats.simaticml.documents import CORPUS_PARAMS, FIXTURE_PARAMS, parsed

SAMPLE = [*FIXTURE_PARAMS, *CORPUS_PARAMS[::8]]
"""Other tests read all documents too; here every eighth is enough."""


def count(root: etree._Element, path: str) -> int:
    """How many elements there are: a path of local names from anywhere."""
    found = root.xpath("/" + "".join(f"/*[local-name()='{name}']" for name in path.strip("/").split("/")))
    assert isinstance(found, list)
    return len(found)


def networks(project: Project) -> list[LogicNetwork]:
    bodies = [body for pou in project.pous for body in pou.bodies if isinstance(body, LdBody | FbdBody)]
    return [network for body in bodies for network in body.networks]


@pytest.mark.parametrize("path", SAMPLE)
def test_objects_and_members(path: Path) -> None:
    root = parsed(path.read_bytes())
    project = sfc.load(path)
    kinds = [etree.QName(child).localname for child in root if isinstance(child.tag, str)]
    assert len(project.pous) == sum(kind in ("SW.Blocks.FB", "SW.Blocks.FC", "SW.Blocks.OB") for kind in kinds)
    assert len(project.data_blocks) == sum(kind.startswith("SW.Blocks.") and kind.endswith("DB") for kind in kinds)
    assert len(project.data_types) == kinds.count("SW.Types.PlcStruct")
    assert len(project.tag_tables) == kinds.count("SW.Tags.PlcTagTable")
    assert sum(len(table.tags) for table in project.tag_tables) == count(root, "/SW.Tags.PlcTag")
    assert sum(len(table.constants) for table in project.tag_tables) == count(root, "/SW.Tags.PlcUserConstant")
    interfaces = [pou.interface for pou in project.pous] + [block.interface for block in project.data_blocks]
    variables = [variable for interface in interfaces if interface is not None for variable in interface.variables()]
    for element in ("Member", "Member/StartValue", "Member/Comment"):
        expected = count(root, f"/Interface/Sections/Section/{element}")
        expected -= count(root, f"/SW.Types.PlcStruct/AttributeList/Interface/Sections/Section/{element}")
        found = {
            "Member": len(variables),
            "Member/StartValue": sum(isinstance(variable.initial, SimpleValue) for variable in variables),
            "Member/Comment": sum(variable.comment is not None for variable in variables),
        }
        assert found[element] == expected, element


@pytest.mark.parametrize("path", SAMPLE)
def test_networks_and_their_parts(path: Path) -> None:
    root = parsed(path.read_bytes())
    project = sfc.load(path)
    project.read_all()
    if any(diagnostic.code in ("XML220", "XML221") for diagnostic in project.diagnostics):
        pytest.skip("a network that is no part of the model")
    units = [
        unit
        for unit in root.iter("{*}SW.Blocks.CompileUnit")
        if (unit.findtext("{*}AttributeList/{*}ProgrammingLanguage") or "").removeprefix("F_") in ("LAD", "FBD")
    ]
    assert len(networks(project)) == len(units)
    parts = sum(len(list(unit.iter("{*}Part", "{*}Call"))) for unit in units)
    nodes = [node for network in networks(project) for node in network.nodes]
    added = [node for node in nodes if isinstance(node, LeftPowerRail | Label) or is_inverter(node)]
    assert len(nodes) - len(added) == parts


def is_inverter(node: object) -> bool:
    return isinstance(node, Block) and node.extension_data is not None and INVERTED in node.extension_data.attributes
