"""Faults that mutants have found, in a minimal form: the files in `fixtures/broken`."""

from __future__ import annotations

import io
import re
from contextlib import suppress
from pathlib import Path
from zipfile import ZipFile

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from tests.fuzz.mutation import MutatedFile
from tests.fuzz.trial import faults
from tests.samples import FIXTURES, UNREADABLE

FORMATS = {
    **{".st": "iec-text", ".json": "json", ".exp": "codesys23", ".gct": "grafcet-text", ".grafcet": "grafcet"},
    ".xml": "plcopen",
    ".csv": "csv",
    ".scl": "scl",
    ".export": "codesys-export",
}
BROKEN = FIXTURES / "broken"


@pytest.mark.parametrize(
    "path", sorted(path for path in BROKEN.iterdir() if path.name not in UNREADABLE), ids=lambda path: path.name
)
def test_nothing_but_own_errors_comes_of_a_broken_file_and_nothing_is_lost(path: Path) -> None:
    mutant = MutatedFile(FORMATS[path.suffix.casefold()], path.name, path.read_bytes())
    assert faults(mutant, *range(9)) == []


@pytest.mark.parametrize(
    ("name", "line", "place", "why"),
    [
        ("value_of_another_kind.json", 13, "pous.0.bodies.0.SFC.chart.steps.1.name", "is not a text"),
        ("delay_that_is_no_time.gct", 7, None, ""),
        (
            "added_configuration_with_a_field_of_nobody.xml",
            14,
            "Plant",
            "configurations.0.torque is no field of the model",
        ),
        ("no_headings.csv", 1, None, ""),
        ("quote_without_end.csv", 3, None, ""),
    ],
)
def test_what_does_not_fit_the_model_has_its_line(name: str, line: int, place: str | None, why: str) -> None:
    with pytest.raises(sfc.FormatError) as caught:
        sfc.load(BROKEN / name, format=FORMATS[Path(name).suffix])
    location = caught.value.location
    assert (location.file, location.line, location.path) == (str(BROKEN / name), line, place)
    assert why in caught.value.message


def test_an_export_with_an_id_of_5000_digits_is_written() -> None:
    data = (FIXTURES / "codesys-export" / "mixer.export").read_bytes()
    damaged = re.sub(rb'(<Single Name="Id" Type="[^"]*">)[^<]*', rb"\g<1>" + b"1" * 5000, data)
    assert damaged != data
    assert sfc.dumps(sfc.loads(damaged), fresh=True, partial=True)


def test_a_type_without_its_end_is_kept_and_told() -> None:
    project = sfc.load(BROKEN / "type_without_its_end.st")
    converted = sfc.convert(project, fresh=True)
    assert b"Recipe : STRUCT amount : INT" in converted.data
    assert [item.what for item in converted.report.losses] == ["error"]
    with pytest.raises(sfc.LossError):
        sfc.dumps(project, fresh=True, strict=True)


def test_times_that_are_none_are_read_as_they_are() -> None:
    project = sfc.load(BROKEN / "step_times_that_are_none.EXP")
    step = next(project.charts()).chart.steps[0]
    assert (step.max_time, step.min_time) == ("after lunch", "5 s")


def test_a_condition_without_wires_comes_back_through_every_version() -> None:
    project = sfc.load(BROKEN / "condition_without_wires.xml")
    project.accept_errors()
    back = sfc.loads(sfc.dumps(project, format="plcopen-1.01", partial=True))
    assert next(back.charts()).chart.transitions[0].condition == next(project.charts()).chart.transitions[0].condition


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
def test_wires_from_nothing_come_from_nothing_in_every_format(target: str) -> None:
    back = sfc.loads(sfc.dumps(sfc.load(BROKEN / "wires_from_nothing.json"), format=target, partial=True))
    nodes = [node for network in back.pou("Lamps").bodies[0].networks for node in network.nodes]
    assert [node.expression for node in nodes] == ["green", "red"]
    starts = {wire.source for node in nodes for wire in node.input.connections}
    assert len(starts) == 2
    assert not starts & {node.id for node in nodes}


@pytest.mark.parametrize("target", ["codesys", "codesys23", "plcopen", "iec-text"])
def test_transitions_from_steps_that_are_not_there_are_told_or_written(target: str) -> None:
    chart = m.SfcNetwork(
        steps=[m.Step(id=1, name="Idle", initial=True), m.Step(id=5, name="Fill"), m.Step(id=7, name="Drain")],
        transitions=[
            m.Transition(id=10 + place, sources=[source], targets=[to], condition=m.Expression(text="x"))
            for place, (source, to) in enumerate([(1, 5), (4, 5), (7, 1), (6, 1)])
        ],
    )
    pou = m.Pou(name="Main", kind=m.PouKind.PROGRAM, bodies=[m.SfcBody(chart=chart)])
    with suppress(sfc.SfcError):
        assert sfc.dumps(sfc.Project(name="Plant", pous=[pou]), format=target, partial=True)


def test_a_grafcet_with_a_transition_from_nowhere_is_told_or_written() -> None:
    project = sfc.load(FIXTURES / "grafcet" / "four_steps.gct")
    next(project.charts()).chart.transitions[0].sources = [999]
    with suppress(sfc.SfcError):
        assert sfc.dumps(project, format="scl", partial=True)


def test_numbers_of_5000_digits_are_read_and_written_as_texts(tmp_path: Path) -> None:
    lines = (FIXTURES / "steplist" / "mixer.csv").read_text(encoding="utf-8-sig").splitlines()
    cells = lines[1].split(";")
    cells[lines[0].split(";").index("Number")] = "1" * 5000
    listed = "\n".join([lines[0], ";".join(cells), *lines[2:]])
    assert "LST105" in {finding.code for finding in sfc.loads(listed.encode(), format="csv").diagnostics}
    project = sfc.load(FIXTURES / "steplist" / "mixer.csv")
    next(project.charts()).chart.steps[0].comment = "1" * 5000
    back = sfc.loads(sfc.dumps(project, format="xlsx", partial=True), format="xlsx")
    assert next(back.charts()).chart.steps[0].comment == "1" * 5000


def test_a_part_without_a_name_is_damaged() -> None:
    data = (FIXTURES / "simaticml" / "FB_Drill.xml").read_bytes()
    damaged = re.sub(rb'<Part Name="[^"]*"', b"<Part", data)
    assert damaged != data
    with suppress(sfc.SfcError):
        sfc.loads(damaged).read_all()


def test_extension_data_of_a_body_with_an_unknown_field_have_their_line() -> None:
    """The name of the field was `content_comment`; no body has such a field."""
    data = sfc.dumps(sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml"), format="plcopen-2.01", partial=True)
    place = data.index(b"<SFC")
    place = data.index(b"<field name=", data.index(b"</SFC>", place))
    damaged = data[:place] + re.sub(rb'name="\w+"', b'name="(*"', data[place:], count=1)
    with pytest.raises(sfc.SfcError) as caught:
        sfc.loads(damaged).read_all()
    assert caught.value.location.line


def test_a_start_value_of_something_that_has_none_yet_is_an_own_error() -> None:
    with pytest.raises(sfc.SimulationError, match="gets its own start value later"):
        sfc.simulate(sfc.load(BROKEN / "start_value_of_itself.st"), pou="Mixer", scans=1)


def test_a_file_header_with_an_unknown_attribute_and_an_unknown_element_is_kept() -> None:
    data = (FIXTURES / "plcopen" / "filling_station_2.01.xml").read_bytes()
    damaged = re.sub(rb"<fileHeader ([^>]*?)/>", rb'<fileHeader odd="1" \1><odd/></fileHeader>', data)
    assert damaged != data
    project = sfc.loads(damaged)
    assert (project.header.extension_data.attributes, len(project.header.extension_data.elements)) == ({"odd": "1"}, 1)
    assert sfc.dumps(project) == damaged


def test_variables_of_an_action_are_those_of_its_pou() -> None:
    project = sfc.load(BROKEN / "variables_of_an_action.st")
    assert [(each.code, each.location.line) for each in project.diagnostics] == [("IEC108", 4)]
    assert [variable.name for variable in project.pous[0].interface.variables()] == ["x", "speed"]


def test_a_workbook_whose_formats_cannot_be_written_again_keeps_its_sheets() -> None:
    pytest.importorskip("openpyxl")
    book = io.BytesIO()
    with ZipFile(FIXTURES / "steplist" / "mixer.xlsx") as old, ZipFile(book, "w") as new:
        for name in old.namelist():
            new.writestr(name, re.sub(rb'(<pageMargins left=")[^"]*', rb"\g<1>" + b"1" * 400, old.read(name)))
    project = sfc.loads(book.getvalue())
    edited = next(project.charts()).chart.steps[0]
    edited.comment = "edited"
    written = sfc.convert(project)
    assert [(item.outcome, item.what) for item in written.report.losses] == [(sfc.Outcome.APPROXIMATED, "file")]
    assert next(sfc.loads(written.data).charts()).chart.steps[0].comment == "edited"


def test_settings_without_flags_are_written_to_an_export() -> None:
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    for chart in project.charts():
        chart.chart.settings = m.SfcSettings(use_defaults=False)
    back = sfc.loads(sfc.dumps(project, format="codesys-export", partial=True))
    assert {chart.chart.settings.use_defaults for chart in back.charts() if chart.chart.settings} == {False}
