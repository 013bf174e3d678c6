"""Start values of the elements of arrays: one value of the array in the model."""

from __future__ import annotations

import re
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.simaticml.block_interfaces import read_member, write_member
from plcopen_sfc.formats.simaticml.element_reader import DocumentReading
from plcopen_sfc.formats.simaticml.element_writer import DocumentWriting
from plcopen_sfc.formats.simaticml.nested_start_values import write_elements
from plcopen_sfc.formats.simaticml.tia_versions import DEFAULT
from plcopen_sfc.model import Project, Variable
from plcopen_sfc.model.types import ArrayType, ArrayValue
from plcopen_sfc.report import ConversionReport
from tests.formats.simaticml.documents import parsed, real_documents

Values = dict[tuple[int, ...], str]


def member(type: str, values: Values) -> etree._Element:
    element = etree.Element("Member", {"Name": "x", "Datatype": type})
    for path, value in values.items():
        holder = etree.SubElement(element, "Subelement", {"Path": ",".join(map(str, path))})
        etree.SubElement(holder, "StartValue").text = value
    return element


def written(variable: Variable) -> etree._Element:
    holder = etree.Element("Section")
    ctx = DocumentWriting(Project(), DEFAULT, {}, ConversionReport(), WriteOptions())
    write_member(ctx, holder, variable)
    return holder[0]


def read(element: etree._Element) -> Variable:
    return Variable.model_validate(read_member(DocumentReading(DEFAULT), element))


@st.composite
def arrays(draw: st.DrawFn) -> tuple[str, Values]:
    """The type of an array and the start values of some of its elements, in their order."""
    lower = st.integers(-2, 3)
    bounds = [(first, first + draw(st.integers(0, 3))) for first in draw(st.lists(lower, min_size=1, max_size=3))]
    places = product(*(range(first, last + 1) for first, last in bounds))
    values = {place: draw(st.sampled_from("012")) for place in places if draw(st.booleans())}
    return f"Array[{', '.join(f'{a}..{b}' for a, b in bounds)}] of Int", values


@settings(deadline=None)
@given(array=arrays())
def test_start_values_of_elements_come_back(array: tuple[str, Values]) -> None:
    element = member(*array)
    variable = read(element)
    assert variable.extension_data is None or not variable.extension_data.elements
    assert etree.tostring(written(variable)) == etree.tostring(element)


def test_runs_are_repeated_and_gaps_have_no_value() -> None:
    variable = read(member("Array[0..1, 1..3] of Int", {(0, 1): "7", (0, 2): "7", (1, 3): "9"}))
    assert isinstance(variable.initial, ArrayValue)
    items = [(item.repetitions, item.value.text) for item in variable.initial.items if item.value.kind == "simple"]
    assert items == [("2", "7"), ("3", None), (None, "9")]


@pytest.mark.parametrize(
    "element",
    [
        member("Array[0..2] of Int", {(5,): "1"}),
        member("Array[0..2] of Int", {(2,): "1", (0,): "2"}),
        member("Array[0..2, 0..2] of Int", {(0,): "1"}),
        member("Array[0..#N] of Int", {(0,): "1"}),
        member("Int", {(0,): "1"}),
        member("Array[0..2] of Int", {(0,): ""}),
    ],
)
def test_other_start_values_are_kept_as_they_are(element: etree._Element) -> None:
    variable = read(element)
    assert variable.initial is None
    assert variable.extension_data is not None
    assert len(variable.extension_data.elements) == len(element)


def test_values_of_other_tools() -> None:
    array = ArrayType.model_validate({"dimensions": [{"lower": "1", "upper": "4"}], "base": "INT"})
    value = ArrayValue.model_validate({"items": [{"value": "1"}, {"value": "0", "repetitions": "3"}]})
    holder = etree.Element("Member")
    assert write_elements(holder, array, value)
    assert [element.get("Path") for element in holder] == ["1", "2", "3", "4"]
    too_many = ArrayValue.model_validate({"items": [{"value": "0", "repetitions": "5"}]})
    assert not write_elements(etree.Element("Member"), array, too_many)


@pytest.mark.slow
@pytest.mark.corpus
def test_start_values_of_the_corpus_are_in_the_model() -> None:
    """But for those of arrays in structures in arrays, whose paths begin with the index of the outer array."""
    seen = kept = 0
    for path in real_documents():
        for element in parsed(path.read_bytes()).iter("{*}Member"):
            if element.find("{*}Subelement") is not None and element.get("Datatype", "").startswith("Array["):
                variable = read(element)
                seen += 1
                kept += variable.initial is None
    if not seen:
        pytest.skip("no corpus beside the repository")
    assert (seen, kept) == (10, 7)


MEMBERS = {
    "Mode": "Int",
    "Long": "DInt",
    "Sub": "Int",
    "ARRAY[0..1] OF Mode": "Array[0..1] of Int",
    "ARRAY[0..1] OF Long": "Array[0..1] of DInt",
    "STRUCT a : Mode; END_STRUCT": "Struct",
    "Part": '"Part"',
    "INT": "Int",
}


@pytest.mark.parametrize("type_", MEMBERS)
def test_members_in_an_interface_have_the_types_of_their_data_type(type_: str) -> None:
    """A first value of one member lists them all in the block, where they are what the PLC data type says."""
    text = f"""TYPE
      Mode : (Auto := 5, Hand := 7); Long : (Idle := 0, Run := 1) DINT; Sub : INT(0..10);
      Part : STRUCT e : Mode; END_STRUCT;
      Rec : STRUCT n : INT := 3; m : {type_}; END_STRUCT;
    END_TYPE
    FUNCTION_BLOCK Main VAR r : Rec := (n := 9); END_VAR r.n := 1; END_FUNCTION_BLOCK"""
    data = sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="simaticml", partial=True).decode()
    found = re.findall(r'<Member Name="m" Datatype="([^>]*?)"(?: ?/)?>', data)
    assert found == [MEMBERS[type_].replace('"', "&quot;")] * 2
    assert '"Mode"' not in data.replace("&quot;", '"').split("SW.Blocks.FB")[1]


@pytest.mark.parametrize("bounds", [("0", "99999999999999999999"), ("3", "1"), ("0", "999999999")])
def test_arrays_of_any_size_are_tried(bounds: tuple[str, str]) -> None:
    array = ArrayType.model_validate({"dimensions": [{"lower": bounds[0], "upper": bounds[1]}], "base": "INT"})
    value = ArrayValue.model_validate(
        {"items": [{"value": {"kind": "simple"}, "repetitions": "500000"}, {"value": "7"}]}
    )
    holder = etree.Element("Member")
    assert write_elements(holder, array, value) == (bounds[1] == "999999999")
    assert [element.get("Path") for element in holder] == ["500000"] * len(holder)
