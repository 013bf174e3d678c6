"""Every project is the same after it was written as text and read again: all fields, ids, drawings and the header."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, given, settings

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.profile import default_profile
from tests.corpus import corpus_files, require_corpus
from tests.lowering.grafcets import pou_with
from tests.samples import FIXTURES, accepting, fixture_files
from tests.semantics.charts.rig import chain
from tests.semantics.charts.test_grafcet import action
from tests.strategies import projects
from tests.sweeps import some_files, some_of

OWN = sorted((FIXTURES / "iectext").iterdir())
CORPUS = some_files([path for kind in ("plcopen", "codesys") for path in corpus_files(kind)], 2)
TEXTS = [path for path in corpus_files("iectext") if path.suffix in (".sfc", ".txt", ".test")]


def as_text(project: m.Project) -> bytes:
    return sfc.dumps(accepting(project), format="iec-text", fresh=True, partial=True)


def findings(project: m.Project) -> list[str]:
    """Complaints of the reader; program text that is wrong was so before."""
    return [str(d) for d in project.diagnostics if d.code not in ("IEC110", "IEC111") and d.severity is Severity.ERROR]


def assert_comes_back(project: m.Project) -> m.Project:
    data = as_text(project)
    back = sfc.loads(data, format="iec-text")
    assert back == project
    assert as_text(back) == data
    return back


@pytest.mark.slow
@pytest.mark.parametrize("path", fixture_files(), ids=lambda path: path.name)
def test_every_fixture_comes_back_from_text(path: Path) -> None:
    project = sfc.load(path)
    back = assert_comes_back(project)
    charts = {d.code for d in project.diagnostics}
    assert [f for f in findings(back) if not any(code in f for code in charts)] == []


@pytest.mark.parametrize("path", OWN, ids=lambda path: path.name)
def test_our_texts_come_back_byte_for_byte_and_written_anew(path: Path) -> None:
    project = sfc.load(path)
    assert project.diagnostics == ()
    assert sfc.dumps(project) == path.read_bytes()
    assert_comes_back(project)


@pytest.mark.slow
@pytest.mark.parametrize("path", some_of(fixture_files(), 2), ids=lambda path: path.name)
def test_there_and_back_to_the_format_of_the_file(path: Path) -> None:
    """Conversion to text loses nothing, so the file that is written from the text is the one written from the model."""
    project = sfc.load(path)
    assert project.source is not None
    text, report = sfc.convert(accepting(project), "iec-text", partial=True)
    assert report.with_outcome(Outcome.DROPPED) == []
    assert report.with_outcome(Outcome.KEPT)
    back = accepting(sfc.loads(text))
    own = project.source.format
    assert sfc.dumps(back, format=own, partial=True) == sfc.dumps(
        sfc.loads(sfc.dumps(project, format="json", partial=True)), format=own, partial=True
    )


@pytest.mark.corpus
@pytest.mark.slow
@pytest.mark.parametrize("path", some_of(CORPUS, 2), ids=lambda path: path.name)
def test_the_corpus_comes_back_from_text(path: Path) -> None:
    require_corpus()
    try:
        project = sfc.load(path)
    except sfc.SfcError as error:
        pytest.skip(f"cannot be read in its own format: {error.message}")
    assert_comes_back(project)


@pytest.mark.corpus
@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.name)
def test_texts_of_others_load_and_come_back(path: Path) -> None:
    require_corpus()
    project = sfc.load(path)
    assert [chart.name for chart in project.charts()]
    assert sfc.dumps(project) == path.read_bytes()
    assert_comes_back(project)


def test_inputs_of_a_grafcet_with_an_address_come_back_from_text() -> None:
    """Text keeps the terms of IEC 60848 in pragmas, so that the variables stay what they are too."""
    chart = chain("1", "2", conditions="a;b")
    chart.step("1").actions = [action("onActivation", "Q", value="NOT Q")]
    pou = pou_with(chart, "a b", "Q")
    assert pou.interface is not None
    pou.interface.sections[0].variables[0].address = "%IX0.0"
    project = m.Project(pous=[pou])
    assert default_profile(project).name == "grafcet"
    assert_comes_back(project)


@settings(
    max_examples=int(os.environ.get("PLCOPEN_SFC_EXAMPLES", "5")) * 3,
    phases=[Phase.explicit, Phase.generate],
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    derandomize=True,
)
@given(projects())
def test_random_projects_come_back_from_text(project: m.Project) -> None:
    assert_comes_back(project)
