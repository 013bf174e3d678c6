"""Sequencers of S7-GRAPH as code for every target: written, read back, and compared with the chart."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, LoweredPou
from plcopen_sfc.semantics.subjects import resolve
from tests.corpus import corpus_files, require_corpus
from tests.lowering.sequencers import act, block, guarded
from tests.sweeps import WHOLE

FORMATS = ["simaticml", "scl", "codesys", "plcopen", "iec-text"]
FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"
FIXTURE = FIXTURES / "simaticml-plc"
DRILL = FIXTURES / "simaticml" / "FB_Drill.xml"


def read_back(chart: m.Project, lowered: LoweredPou, format: str, *, cap: int = 3_000, runs: int = 3) -> VerdictKind:
    data = sfc.dumps(lowered.project, format=format, partial=True)
    again = resolve(sfc.loads(data, format=format), lowered.pou.name)
    assert again.pou.sfc is None
    found = equivalent(
        resolve(chart, lowered.pou.name),
        again,
        "s7graph",
        step_flags=lowered.step_flags,
        fixed=lowered.at_rest,
        cap=cap,
        runs=runs,
        scans=80,
    )
    assert not found.different, str(found)
    return found.kind


@pytest.mark.slow
@pytest.mark.parametrize("format", FORMATS)
def test_every_target_holds_the_code(format: str) -> None:
    chart = guarded(
        act("D", duration="T#20ms"), act("S", "P", "V1"), act("R", "P", "A1"), act("N", "R", interlock=True)
    )
    project = block(chart, "ok fault ACK_EF", "P Q R ERR_FLT")
    lowered = sfc.lower(project, profile="s7graph", target=format, verify=False)
    assert lowered.construction is Construction.CASE
    assert read_back(project, lowered, format, cap=20_000) is VerdictKind.PROVEN


@pytest.mark.parametrize("format", FORMATS)
def test_every_target_holds_several_cases_with_names_of_steps(format: str) -> None:
    project = sfc.load(DRILL)
    lowered = sfc.lower(project, target=format, states="constants", verify=False)
    assert lowered.construction is Construction.REGIONS
    body = lowered.pou.body
    assert isinstance(body, m.StBody)
    assert "#step_number := #PARALLEL_Drill;" in body.text
    comment = {"plcopen": "(* {} *)", "iec-text": "(* {} *)", "codesys": "// {}"}.get(format, "REGION {}")
    assert comment.format("Step sequence from Lamp off") in body.text
    data = sfc.dumps(lowered.project, format=format, partial=True)
    again = sfc.loads(data, format=format).pou("FB_Drill")
    states = {v.name for v in again.variables() if v.name.startswith("step_number") and not v.name.endswith("_old")}
    assert states == {"step_number", "step_number_Lamp_off"}  # Drill and Cool end together


@pytest.mark.slow
@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize("format", ["simaticml", "codesys", "plcopen"])
def test_networks_in_files(format: str, language: str) -> None:
    chart = guarded(act("D", duration="T#20ms"), act("S", "P", "V1"), act("N", "R", interlock=True))
    project = block(chart, "ok fault", "P Q R ERR_FLT")
    lowered = sfc.lower(project, "fup", profile="s7graph", language=language, target=format, verify=False)
    read_back(project, lowered, format, cap=300)


@pytest.mark.slow
@pytest.mark.parametrize("format", FORMATS)
def test_the_drilling_machine(format: str) -> None:
    project = sfc.load(FIXTURE)
    lowered = sfc.lower(project, pou="FB_Drilling", target=format, verify=False)
    read_back(project, lowered, format, cap=50)


def test_german_titles() -> None:
    lowered = sfc.lower(sfc.load(FIXTURE), pou="FB_Drilling", lang="de", verify=False)
    body = lowered.pou.body
    assert isinstance(body, m.StBody)
    titles = [line for line in body.text.splitlines() if line.startswith("//")]
    assert "// Befehle und Betriebsart" in titles
    assert "// Schritt Release: Aktionen beim Verlassen" in titles
    assert "// Clamp: Schutz" in titles
    assert "// Cool: Kühlmittel fehlt" in titles


def station(asking: str) -> m.Project:
    """The drilling machine, and a block that asks for something of its steps."""
    project = sfc.load(FIXTURE)
    body = project.pou("FB_Chips").body
    assert isinstance(body, m.StBody)
    body.text += f"\n{asking}\n"
    body.markup = None
    return project


@pytest.mark.slow
@pytest.mark.parametrize("format", ["simaticml", "scl"])
def test_data_of_steps_that_other_blocks_read_stay_where_they_were(format: str) -> None:
    asking = '#chips := "FB_Drilling_DB".Drill.X AND "FB_Drilling_DB".Drill.T > T#1s OR "FB_Drilling_DB".Home.S1;'
    project = station(asking)
    lowered = sfc.lower(project, pou="FB_Drilling", target=format, verify=False)
    body = lowered.pou.body
    assert isinstance(body, m.StBody)
    assert "#Drill.X := #X3;\n#Drill.T := #X3_T;\n#Home.S1 := #X1 AND NOT #X1_old;" in body.text
    read_back(project, lowered, format, cap=50)


@pytest.mark.parametrize("asking", ['#chips := "FB_Drilling_DB".Drill.X;', '"FC"("FB_Drilling_DB".Drill);'])
def test_data_of_steps_that_the_target_cannot_show_are_refused(asking: str) -> None:
    with pytest.raises(LoweringError, match="Drill"):
        sfc.lower(station(asking), pou="FB_Drilling", target="codesys", verify=False)


UNKNOWN_FUNCTION = {"FB_GraphSample"}
"""Blocks that call functions which their file does not hold: nobody can run them."""

WITH_TIMES = {"FB_R134a_GRAPH"}
"""Blocks that ask for times of steps: they are lowered to a CASE."""

LARGEST = 9
"""It takes as long as the others together, and has nothing that they do not have."""

BROKEN = {"STATIONXSKFIXTURENR_FIXTURENAME_Sequence"}
"""Templates with a connection to nothing."""


@pytest.mark.slow
@pytest.mark.parametrize("number", [number for number in range(11) if WHOLE or number != LARGEST])
def test_blocks_of_the_corpus(number: int) -> None:
    require_corpus()
    texts = ((path, path.read_bytes()) for path in corpus_files("simaticml"))
    distinct = {text: path for path, text in texts if b"</Graph>" in text and b"<Document" in text}
    path = list(distinct.values())[number]
    project = sfc.load(path)
    charts = [pou for pou in project.pous if pou.sfc is not None]
    for pou in charts:
        if pou.name in BROKEN:
            with pytest.raises(LoweringError, match="not read completely"):
                sfc.lower(project, pou=pou.name, verify=False)
            continue
        at_rest = ["S_ON"] if number % 2 or pou.name in WITH_TIMES else []
        lowered = sfc.lower(project, pou=pou.name, at_rest=at_rest, verify=False)
        one_by_one = at_rest and pou.sfc is not None and pou.sfc.steps
        assert lowered.construction is (Construction.CASE if one_by_one else Construction.BITS)
        if pou.name not in UNKNOWN_FUNCTION:
            read_back(project, lowered, FORMATS[1 + number % 4], cap=30, runs=2)
