"""Markup of TC6 in SimaticML files and the reverse: kept as data, and markup again in a file of its format."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.formats.plcopen.tc6_versions import validate_tc6
from plcopen_sfc.formats.xml.extension_data import KEPT_MARKUP, Markup, exchange_markup, markup_of
from plcopen_sfc.model.base import ExtensionData, ForeignData
from tests.samples import FIXTURES, accepting

OTHERS = [
    "codesys/sorting_conveyor.xml",
    "codesys/distribution_belt.xml",
    "twincat/press_station.xml",
]


def extension_data_in(thing: Any) -> Iterator[ExtensionData]:
    """Foreign data of the objects of a project, but for drawings, of which SimaticML has none."""
    if isinstance(thing, ExtensionData):
        yield thing
    elif isinstance(thing, m.Model):
        for name in type(thing).model_fields:
            if name != "drawing":
                yield from extension_data_in(getattr(thing, name))
    elif isinstance(thing, list):
        for item in thing:
            yield from extension_data_in(item)


def contents(project: m.Project, *, put_away: bool = False) -> list[str]:
    """Foreign data that is kept as it is, and that which is `put_away`."""
    found = [extension_data.model_copy(deep=True) for extension_data in extension_data_in(project)]
    for extension_data in found:
        extension_data.data = [
            data for data in extension_data.data if put_away or not data.name.startswith(KEPT_MARKUP)
        ]
    return sorted(extension_data.model_dump_json() for extension_data in found if extension_data != ExtensionData())


@pytest.mark.slow
@pytest.mark.parametrize("source", OTHERS)
def test_what_is_carried_comes_back_through_simaticml(source: str) -> None:
    project = accepting(sfc.load(FIXTURES / source))
    there = sfc.loads(sfc.dumps(project, format="simaticml", partial=True))
    assert markup_of(there) is Markup.TC6
    assert contents(there) == contents(project)
    data = sfc.dumps(there, format="codesys", partial=True)
    assert f"{KEPT_MARKUP}:tc6".encode() not in data
    assert [d for d in validate_tc6(data) if d.severity == "error"] == []
    assert contents(sfc.loads(data)) == contents(project)


AUTHOR = b"<HeaderAuthor>somebody</HeaderAuthor>"


@pytest.mark.slow
@pytest.mark.parametrize("form", ["codesys", "plcopen-2.01", "plcopen-1.01", "json", "iec-text"])
def test_what_tia_portal_adds_to_a_project_of_others_is_no_markup_of_theirs(form: str) -> None:
    project = sfc.load(FIXTURES / "codesys" / "distribution_belt.xml")
    data = sfc.dumps(project, format="simaticml", partial=True)
    before, mark, block = data.partition(b"<SW.Blocks.F")  # before it stand copies of global variables
    edited = sfc.loads(before + mark + block.replace(b"</AttributeList>", AUTHOR + b"</AttributeList>", 1))
    (away,) = (
        extension_data.model_dump_json()
        for extension_data in extension_data_in(edited)
        if "HeaderAuthor" in extension_data.model_dump_json()
    )
    assert f"{KEPT_MARKUP}:simaticml" in away
    other = sfc.dumps(edited, format=form, partial=True)
    if form.startswith(("codesys", "plcopen")):
        assert [d for d in validate_tc6(other) if d.severity == "error"] == []
    back = sfc.loads(other, format=form.partition("-")[0] if form.startswith("plcopen") else form)
    assert contents(edited, put_away=True) == contents(back, put_away=True)
    assert sfc.dumps(back, format="simaticml", partial=True).count(AUTHOR) == 1


@pytest.mark.slow
def test_an_edit_of_a_simaticml_file_with_a_project_of_others_is_two_lines(tmp_path: Path) -> None:
    data = sfc.dumps(sfc.load(FIXTURES / "codesys" / "distribution_belt.xml"), format="simaticml", partial=True)
    path = tmp_path / "belt.xml"
    path.write_bytes(data)
    project = sfc.load(path)
    assert sfc.dumps(project) == data
    chart = next(iter(project.charts())).chart
    chart.steps[0].comment = "neu"
    sfc.save(project, path, partial=True)
    before, after = data.splitlines(), path.read_bytes().splitlines()
    assert len(before) == len(after)
    # and the chart as it was in CODESYS, in one comment
    assert sum(one != other for one, other in zip(before, after, strict=True)) == 2
    assert contents(sfc.load(path)) == contents(sfc.loads(data))


TEXT = st.text(st.characters(codec="utf-8", exclude_categories=["Cs"]), max_size=8)
DATA = st.builds(ForeignData, name=TEXT.filter(lambda name: not name.startswith(KEPT_MARKUP)), content=TEXT)
EXTENSION_DATA = st.builds(
    ExtensionData,
    data=st.lists(DATA, max_size=2),
    attributes=st.dictionaries(TEXT, TEXT, max_size=2),
    elements=st.lists(TEXT, max_size=2),
)


@given(EXTENSION_DATA, st.sampled_from([(Markup.TC6, Markup.SIMATICML), (Markup.SIMATICML, Markup.TC6)]))
@settings(deadline=None)
def test_what_is_put_away_is_taken_out_as_it_was(
    extension_data: ExtensionData, families: tuple[Markup, Markup]
) -> None:
    own, wanted = families
    step = m.Step(id=1, name="S", extension_data=extension_data.model_copy(deep=True))
    exchange_markup(step, own, own)
    assert step.extension_data == extension_data
    exchange_markup(step, own, wanted)
    assert step.extension_data is not None
    assert step.extension_data.attributes == {}
    assert step.extension_data.elements == []
    assert [data.name for data in step.extension_data.data] == [f"{KEPT_MARKUP}:{own}"]
    exchange_markup(step, wanted, own)
    assert step.extension_data == extension_data


@given(EXTENSION_DATA.filter(lambda extension_data: extension_data != ExtensionData()), EXTENSION_DATA)
@settings(deadline=None)
def test_markup_of_both_changes_places(mine: ExtensionData, theirs: ExtensionData) -> None:
    step = m.Step(id=1, name="S", extension_data=mine.model_copy(deep=True))
    exchange_markup(step, Markup.TC6, Markup.SIMATICML)
    assert step.extension_data is not None
    step.extension_data.attributes |= theirs.attributes
    step.extension_data.elements += theirs.elements
    step.extension_data.data += theirs.data
    both = step.extension_data.model_copy(deep=True)
    exchange_markup(step, Markup.SIMATICML, Markup.TC6)
    rest = [data for data in step.extension_data.data if not data.name.startswith(KEPT_MARKUP)]
    assert step.extension_data.model_copy(update={"data": rest}) == mine
    exchange_markup(step, Markup.TC6, Markup.SIMATICML)
    key = lambda data: (data.name, data.content)  # noqa: E731
    assert sorted(step.extension_data.data, key=key) == sorted(both.data, key=key)
    assert step.extension_data.attributes == both.attributes


@pytest.mark.parametrize("content", ["", "<kept", "{}", f'<kept xmlns="{KEPT_MARKUP}">{{"data": 3}}</kept>'])
def test_damaged_data_stays(content: str) -> None:
    data = ForeignData(name=f"{KEPT_MARKUP}:tc6", content=content)
    step = m.Step(id=1, name="S", extension_data=ExtensionData(data=[data]))
    exchange_markup(step, Markup.SIMATICML, Markup.TC6)
    assert step.extension_data is not None
    assert data in step.extension_data.data
