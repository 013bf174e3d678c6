"""Objects are found in the files that they stand in."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import Location, LoweringError

FIXTURES = Path(__file__).parents[2] / "fixtures"
BROKEN = FIXTURES / "broken" / "transition_without_condition.xml"


def test_objects_have_the_line_that_the_file_has_them_in() -> None:
    project = sfc.load(BROKEN)
    lines = BROKEN.read_text(encoding="utf-8").splitlines()
    (step,) = project.locations_of(["POU StirTank / step Stir"])
    assert step.file == str(BROKEN)
    assert step.line is not None
    assert 'name="Stir"' in lines[step.line - 1]


def test_variables_and_types_of_a_text_have_their_lines(tmp_path: Path) -> None:
    path = tmp_path / "plant.st"
    path.write_text(
        "TYPE\n  Part : STRUCT\n    Size : INT;\n  END_STRUCT;\nEND_TYPE\nVAR_GLOBAL\n  g : BOOL;\nEND_VAR\n"
        "PROGRAM Main\nVAR\n  (* first *)\n  a : INT;\n  b,\n  c : BOOL := TRUE;\nEND_VAR\na := 1;\nEND_PROGRAM\n",
        encoding="utf-8",
    )
    paths = ["type Part", "g", "POU Main", "POU Main / a", "POU Main / b", "POU Main / c", "POU Main / d"]
    assert [place.line for place in sfc.load(path).locations_of(paths)] == [2, 7, 9, 12, 13, 14, 9]


def test_what_is_unknown_has_the_line_of_what_is_around_it_or_none() -> None:
    project = sfc.load(BROKEN)
    around, inside, nowhere = project.locations_of(
        ["POU StirTank / step Stir", "POU StirTank / step Stir / whatever", "POU Nobody"]
    )
    assert inside.line == around.line
    assert nowhere == Location(str(BROKEN), path="POU Nobody")
    assert sfc.Project().locations_of(["POU StirTank"]) == [Location(path="POU StirTank")]


def test_an_error_of_lowering_has_file_and_line() -> None:
    with pytest.raises(LoweringError) as refused:
        sfc.lower(sfc.load(BROKEN), verify=False)
    assert refused.value.location.file == str(BROKEN)
    assert refused.value.location.line


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("codesys23/distribution_belt.EXP", {"POU Ablauf / step Pendel_Hin": "STEP Pendel_Hin",
                                             "POU Ablauf / transition Pendel_Zaehlen -> Pruefen": "TRANSITION",
                                             "POU Ablauf / Wartezeit": "Wartezeit", "POU Ablauf": "PROGRAM"}),
        ("scl/filling_line.scl", {"POU FB_Fill": "FUNCTION_BLOCK", "POU FB_Fill / busy": "busy"}),
        ("twincat-belt", {"POU Ablauf_Band / step Pendel_Warten": '<o t="SFCStep">',
                          "POU Ablauf_Band / byModus": "byModus",
                          "POU Ablauf_Band / transition Pendel_Zaehlen -> Zurueck_Platz1": '<o t="SFCTransition">',
                          "POU Ablauf_Band": "PROGRAM"}),
        ("codesys-export/mixer.export", {"POU Mischer / Fuellstand": "Fuellstand", "POU Mischer": "Mischer"}),
    ],
)  # fmt: skip
def test_objects_of_each_tool_have_their_lines(name: str, words: dict[str, str]) -> None:
    project = sfc.load(FIXTURES / name)
    for place, word in zip(project.locations_of(words), words.values(), strict=True):
        assert place.file is not None
        assert place.line is not None
        lines = Path(place.file).read_text(encoding="cp1252").splitlines()
        assert word in lines[place.line - 1], place
