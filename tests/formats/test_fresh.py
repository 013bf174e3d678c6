"""A file written from the model alone says all that the original says, but for a list of exceptions with reasons."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from tests.corpus import ROOT
from tests.samples import ALL_PARAMS, FIXTURE_PARAMS, TC6, assert_same, local, params, tree_of

Fact = tuple[str, str, str]
"""Path of an element with the names on the way, attribute (or ``#text``, or "" for the element itself), value."""

XSI = "{http://www.w3.org/2001/XMLSchema-instance}"
BLOCK_PARTS = ("inVariable", "outVariable", "variable", "contact", "coil")


@dataclass(frozen=True)
class FreshDifference:
    """`attribute` = `value` of `element` is left out. No attribute: the element itself, where it is empty."""

    elements: tuple[str, ...]
    attribute: str
    values: tuple[str, ...]
    reason: str

    def covers(self, fact: Fact) -> bool:
        element = fact[0].rpartition("/")[2].partition("[")[0]
        return element in self.elements and fact[1] == self.attribute and fact[2] in self.values


STATES_DEFAULT = "states what the schema says for a missing attribute"
HAS_NOTHING = "an optional element with nothing in it"

LEFT_OUT = (
    FreshDifference(("step",), "initialStep", ("false",), STATES_DEFAULT),
    FreshDifference((*BLOCK_PARTS, "step", "condition", "actionBlock"), "negated", ("false",), STATES_DEFAULT),
    FreshDifference(("inOutVariable",), "negatedIn", ("false",), STATES_DEFAULT),
    FreshDifference(("inOutVariable",), "negatedOut", ("false",), STATES_DEFAULT),
    FreshDifference(BLOCK_PARTS, "edge", ("none",), STATES_DEFAULT),
    FreshDifference(BLOCK_PARTS, "storage", ("none",), STATES_DEFAULT),
    FreshDifference(("inOutVariable",), "edgeIn", ("none",), STATES_DEFAULT),
    FreshDifference(("inOutVariable",), "edgeOut", ("none",), STATES_DEFAULT),
    FreshDifference(("inOutVariable",), "storageIn", ("none",), STATES_DEFAULT),
    FreshDifference(("inOutVariable",), "storageOut", ("none",), STATES_DEFAULT),
    FreshDifference(("variable",), "hidden", ("false",), STATES_DEFAULT),
    FreshDifference(("action",), "qualifier", ("N",), STATES_DEFAULT),
    FreshDifference(("globalVars", "localVars"), "constant", ("false",), STATES_DEFAULT),
    FreshDifference(("localVars", "inputVars", "outputVars"), "retain", ("false",), STATES_DEFAULT),
    FreshDifference(("actions", "transitions"), "", ("",), HAS_NOTHING),
    FreshDifference(("addData",), "", ("",), HAS_NOTHING),
    FreshDifference(
        ("project",),
        f"{XSI}schemaLocation",
        tuple(f"{TC6[0]} {location}" for location in (TC6[0], "tc6_xml_v10_b.xsd")),
        "TC6 1.01 has no place for what we carry: unknown attributes stand in our XML comment",
    ),
)

ADDED = (
    FreshDifference(("action",), "localId", ("0",), "TC6 2.0 requires it; the file left it out"),
    FreshDifference(("relPosition",), "", ("",), "TC6 2.0 requires it of an action; the file left it out"),
    FreshDifference(("relPosition",), "x", ("0",), "TC6 2.0 requires it of an action; the file left it out"),
    FreshDifference(("relPosition",), "y", ("0",), "TC6 2.0 requires it of an action; the file left it out"),
    FreshDifference(("pouInstance",), "typeName", ("",), "TC6 2.0 requires it; the file left it out"),
)


def facts(data: bytes) -> Counter[Fact]:
    """Everything that a file says. White space between elements, comments and the order of attributes say nothing."""
    found: Counter[Fact] = Counter()

    def walk(element: etree._Element, path: str) -> None:
        if not isinstance(element.tag, str):
            return
        # an action of a block may lack the id that it is written with
        name = element.get("name") or (element.get("localId") if local(element) != "action" else None)
        path += f"/{etree.QName(element).localname}" + (f"[{name}]" if name else "")
        found[path, "", ""] += 1
        for key, value in element.attrib.items():
            found[path, str(key), str(value)] += 1
        text = (element.text or "") + "".join(child.tail or "" for child in element)
        if text.strip():
            is_indented = local(element) == "attribute" and "\n" in text.replace(text.strip(), "", 1)
            found[path, "#text", text.strip() if len(element) or is_indented else text] += 1
        for child in element:
            walk(child, path)

    walk(tree_of(data), "")
    return found


class Written:
    """A file, and the one that is written from its model alone."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.data = path.read_bytes()
        self.project = sfc.loads(self.data)
        self.fresh = sfc.dumps(self.project, fresh=True)

    def exchanged(self) -> tuple[Counter[Fact], Counter[Fact]]:
        """Content of the file that the regenerated one lacks, and the reverse."""
        old, new = facts(self.data), facts(self.fresh)
        return old - new, new - old


@pytest.fixture(scope="module", params=params(5))
def written(request: pytest.FixtureRequest) -> Written:
    """Each file once for all tests."""
    return Written(request.param)


@pytest.mark.slow
def test_a_fresh_file_means_the_same(written: Written) -> None:
    again = sfc.loads(written.fresh)
    if written.path.name == "example.xml":  # its actions lack the ids that they are written with
        assert_same(again, written.project)
    else:
        assert again == written.project
    assert sfc.dumps(again, fresh=True) == written.fresh


def test_a_fresh_file_says_all_but_the_documented_exceptions(written: Written) -> None:
    lost, added = written.exchanged()
    assert [fact for fact in lost if not any(e.covers(fact) for e in LEFT_OUT)] == []
    assert [fact for fact in added if not any(e.covers(fact) for e in ADDED)] == []


def test_a_fresh_file_keeps_the_order_of_elements(written: Written) -> None:
    if any(d.code == "SFC108" for d in written.project.diagnostics):
        pytest.skip("an action block that belongs to no step is kept, and so written last")
    old, new = order(written.data), order(written.fresh)
    assert [name for name in old if name.partition("[")[0] not in MAY_BE_EMPTY] == [
        name for name in new if name.partition("[")[0] not in MAY_BE_EMPTY
    ]


MAY_BE_EMPTY = {"actions", "transitions", "addData", "relPosition"}


def order(data: bytes) -> list[str]:
    elements = (e for e in tree_of(data).iter() if isinstance(e.tag, str))
    return [f"{local(e)}[{e.get('name') or e.get('refLocalId') or ''}]" for e in elements]


@pytest.mark.slow
@pytest.mark.corpus
def test_no_exception_is_written_down_without_need() -> None:
    """Over all files: an exception that no file needs is no longer one. (Only with the corpus.)"""
    if len(ALL_PARAMS) == len(FIXTURE_PARAMS) + 1:
        pytest.skip("no corpus beside the repository")
    files = [param.values[0] for param in ALL_PARAMS]
    unseen = [(index, one) for index, group in enumerate((LEFT_OUT, ADDED)) for one in group]
    for path in sorted(files, key=lambda path: path.stat().st_size):  # type: ignore[union-attr]
        if unseen:
            changes = Written(path).exchanged()  # type: ignore[arg-type]
            unseen = [(index, one) for index, one in unseen if not any(one.covers(fact) for fact in changes[index])]
    assert unseen == []


def test_the_exceptions_are_documented() -> None:
    text = (ROOT / "docs" / "formats" / "_fresh_exceptions.md").read_text("utf-8")
    for one in (*LEFT_OUT, *ADDED):
        for name in (*one.elements, one.attribute.removeprefix(XSI)):
            assert not name or f"`{name}`" in text, name
