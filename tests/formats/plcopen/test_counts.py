"""Nothing is overlooked: as many objects in the model as elements in the file, counted by XPath."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from lxml import etree
from pydantic import BaseModel

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.model.base import ExtensionData
from tests.samples import params, tree_of

GUIDS = {
    "entry_action": "a6b08bd8-b696-47e3-9cbf-7408b61c9ff8",
    "main_action": "700a583f-b4d4-43e4-8c14-629c7cd3bec8",
    "exit_action": "a2621e18-7de3-4ea6-ae6d-89e9e0b7befd",
    "min_time": "cacf1a68-236e-47c2-b7b1-1cf9199718cb",
    "max_time": "b693554c-1b01-4a8d-afde-9e3a46f7465d",
}


def objects(thing: object) -> Iterator[BaseModel]:
    """Every object of a model, wherever it is."""
    if isinstance(thing, BaseModel):
        yield thing
        for name in type(thing).model_fields:
            yield from objects(getattr(thing, name))
    elif isinstance(thing, list | tuple):
        for item in thing:
            yield from objects(item)
    elif isinstance(thing, dict):
        yield from objects(list(thing.values()))


def carried_roots(found: list[BaseModel], namespace: str) -> list[etree._Element]:
    """Trees of the kept markup. Markup has ``tc6`` for the namespace of any version of TC6."""
    texts = [
        text
        for one in found
        if isinstance(one, ExtensionData)
        for text in (*one.elements, *(data.content for data in one.data))
    ]
    return [etree.fromstring(f"<x>{text}</x>".replace('xmlns="tc6"', f'xmlns="{namespace}"')) for text in texts]


class Count:
    """Numbers of elements by XPath, over the file without what is kept."""

    def __init__(self, root: etree._Element, extension_data: list[etree._Element]) -> None:
        self.namespace = etree.QName(root).namespace
        self.root = root
        self.extension_data = extension_data

    def __call__(self, path: str) -> int:
        """How many elements `path` finds; names of TC6 have the prefix ``p:``."""
        names = {"p": self.namespace}
        query = f"count(.//{path})"
        here = int(self.root.xpath(query, namespaces=names))  # type: ignore[arg-type]
        return here - sum(int(c.xpath(query, namespaces=names)) for c in self.extension_data)  # type: ignore[arg-type]


@pytest.mark.parametrize("path", params(7))
def test_as_many_objects_as_elements(path: Path) -> None:
    # where rows of the source were rewritten, the elements are those that the tool executes
    project = sfc.load(path, as_tool=b'"rewritten"' in path.read_bytes())
    found = list(objects(project))
    root = tree_of(path.read_bytes())
    count = Count(root, carried_roots(found, etree.QName(root).namespace or ""))
    kinds = Counter(type(one) for one in found)
    symbols = Counter(one.kind for one in found if isinstance(one, m.Symbol))
    nodes = Counter(one.kind for one in found if isinstance(one, m.network.NodeBase))

    # POUs and where they stand
    assert len(project.pous) == count("p:pou")
    places = Counter(pou.place.partition("/")[0] for pou in project.pous)
    assert places[""] == count("p:types/p:pous/p:pou")
    assert places["application"] == count("p:data[contains(@name,'/application')]/p:resource/p:addData/p:data/p:pou")
    assert places["configuration"] == count("p:configuration/p:resource/p:addData/p:data/p:pou")
    assert len(project.data_types) == count("p:dataType")
    assert kinds[m.Action] == count("p:actions/p:action")
    assert kinds[m.NamedTransition] == count("p:transitions/p:transition")
    assert kinds[m.Method] == count("*[local-name()='Method']")

    # charts
    assert kinds[m.SfcNetwork] == count("p:SFC")
    assert symbols[m.SymbolKind.STEP] == count("p:step")
    assert symbols[m.SymbolKind.MACRO_STEP] == count("p:macroStep")
    assert kinds[m.Step] == count("p:step") + count("p:macroStep")
    assert symbols[m.SymbolKind.TRANSITION] == count("p:SFC/p:transition")
    assert symbols[m.SymbolKind.JUMP] == count("p:jumpStep")
    assert symbols[m.SymbolKind.ACTION_BLOCK] == count("p:actionBlock")
    assert kinds[m.ActionAssociation] == count("p:actionBlock/p:action")
    for bar in ("selectionDivergence", "selectionConvergence", "simultaneousDivergence", "simultaneousConvergence"):
        assert symbols[m.SymbolKind(bar)] == count(f"p:{bar}"), bar
    assert symbols[m.SymbolKind.EXPRESSION] + nodes["input"] == count("p:inVariable")
    drawn = [t for one in found if isinstance(one, m.SfcNetwork) for t in one.transitions]
    several = sum(
        len(one.transitions or [0]) for one in found if isinstance(one, m.Symbol) and one.kind == "transition"
    )
    assert len(drawn) == several

    # bodies
    inline = sum(
        isinstance(t.condition, m.Expression) and symbol.condition is None
        for one in found
        if isinstance(one, m.SfcNetwork) and one.drawing is not None
        for symbol in one.drawing.symbols
        if symbol.kind is m.SymbolKind.TRANSITION
        for t in [one.transition((symbol.transitions or [symbol.id])[0])]
    )
    assert kinds[m.StBody] + inline == count("p:ST")
    assert kinds[m.FbdBody] == count("p:FBD")
    assert kinds[m.LdBody] == count("p:LD")
    assert kinds[m.IlBody] == count("p:IL")
    for element, kind in (
        *((name, name) for name in "block contact coil leftPowerRail rightPowerRail jump label return".split()),
        *((name, name) for name in "connector continuation vendorElement".split()),
        ("outVariable", "output"),
        ("inOutVariable", "inOut"),
        ("error", "error"),
    ):
        assert nodes[kind] == count(f"p:{element}"), element
    assert nodes["comment"] == count("*[not(self::p:pou)]/p:comment[@localId]")

    # declarations and instances
    assert kinds[m.BlockVariable] == count("p:variable[@formalParameter]")
    repeated = "ancestor::*[local-name()='MixedAttrsVarList']"  # the list holds them too
    assert kinds[m.Variable] == count(f"p:variable[p:type][not({repeated})]")
    assert kinds[m.AccessVariable] == count("p:accessVariable")
    assert kinds[m.ConfigVariable] == count("p:configVariable")
    assert kinds[m.Task] == count("p:task")
    assert kinds[m.PouInstance] == count("p:pouInstance")
    assert kinds[m.Configuration] == count("p:configuration")
    assert kinds[m.Resource] == count("p:resource")

    # what CODESYS says of steps
    steps = [one for one in found if isinstance(one, m.Step)]
    for name, guid in GUIDS.items():
        counted = count(f"p:step//attribute[@guid='{guid}'][normalize-space()]")
        assert sum(getattr(step, name) is not None for step in steps) == counted, name


@pytest.mark.parametrize("path", params(1))
def test_everything_that_is_wired_stays_wired(path: Path) -> None:
    project = sfc.load(path)
    found = list(objects(project))
    root = tree_of(path.read_bytes())
    count = Count(root, carried_roots(found, etree.QName(root).namespace or ""))
    # the pins of conditions stand at their symbols, and of wired conditions at the condition too
    assert sum(isinstance(one, m.Connection) for one in found) == count("p:connection[@refLocalId]")
    assert sum(len(one.points) for one in found if isinstance(one, m.Connection)) == count("p:connection/p:position")
