"""Random projects: SCL, with our own comments for the rest, gives them back as they were."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.scl.scl_codec import CODEC
from plcopen_sfc.formats.text_encoding import decode_text
from plcopen_sfc.report import LOSSES, ConversionReport
from tests import strategies as random_model
from tests.languages.declarations import test_model as sayable
from tests.sweeps import examples

QUICK = settings(max_examples=examples(40), deadline=None, suppress_health_check=list(HealthCheck))


@pytest.mark.slow
@given(random_model.projects())
@QUICK
def test_any_project_comes_back(project: m.Project) -> None:
    project.dialect = m.Dialect.SCL
    report = ConversionReport()
    data = CODEC.write(project, WriteOptions(), report)
    assert CODEC.read(data).project == project
    unsaid = data.decode("utf-8-sig").count("// {plcopen_sfc ")
    assert len(report.with_outcome(sfc.Outcome.EXTENSION_DATA, sfc.Outcome.TRANSLATED, *LOSSES)) >= unsaid


def without_first_comment(sections: list[m.VariableSection]) -> list[m.VariableSection]:
    """`sections` without the comment in the place where TIA Portal has that of the block."""
    for section in sections[:1]:
        section.comment = None
    return sections


blocks = st.builds(
    m.Pou,
    name=sayable.names,
    kind=st.sampled_from([m.PouKind.FUNCTION_BLOCK, m.PouKind.ORGANIZATION_BLOCK]),
    interface=st.builds(m.Interface, sections=st.lists(sayable.sections, max_size=3).map(without_first_comment)),
    bodies=st.sampled_from(["", "   ;", "\t#x := 1;\n\n\t// ä\n"]).map(lambda text: [m.StBody(text=text)]),
    comment=st.none() | sayable.comments,
    title=st.none() | sayable.lines,
)
data_blocks = st.builds(
    m.DataBlock,
    name=sayable.names,
    interface=st.builds(
        m.Interface,
        sections=st.lists(sayable.sections.filter(lambda s: s.variables), min_size=1, max_size=2).map(
            without_first_comment
        ),
    ),
    comment=st.none() | sayable.comments,
)
projects = st.builds(
    m.Project,
    dialect=st.just(m.Dialect.SCL),
    pous=st.lists(blocks, max_size=3),
    data_blocks=st.lists(data_blocks, max_size=2),
)


@pytest.mark.slow
@given(projects, projects, st.sampled_from([b"\n", b"\r\n"]))
@QUICK
def test_no_edit_is_lost(one: m.Project, other: m.Project, newline: bytes) -> None:
    data = CODEC.write(one, WriteOptions(), ConversionReport()).replace(b"\r\n", newline)
    project = sfc.loads(data, format="scl")
    assert project == one
    project.pous, project.data_blocks = other.pous, other.data_blocks
    saved = sfc.dumps(project, partial=True)
    assert sfc.loads(saved, format="scl") == project
    project.pous, project.data_blocks = one.pous, one.data_blocks
    assert sfc.dumps(project) == data


@given(st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
def test_any_bytes_have_a_text_that_says_them(data: bytes) -> None:
    source = decode_text(data)
    assert source.encode(source.text) == (data, False)
    assert sfc.dumps(sfc.loads(data, format="scl")) == data
