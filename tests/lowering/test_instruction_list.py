"""Lowered code in instruction list: proven, in every format that has it, and refused where none has."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.model import IlBody

FIXTURES = Path("fixtures")


@pytest.mark.slow
@pytest.mark.parametrize("construction", ["flipflop", "bits"])
@pytest.mark.parametrize(
    ("file", "pou"),
    [("plcopen/filling_station_2.01.xml", "CapStation"), ("grafcet/two_cylinders.gct", "Zylinder")],
)
def test_charts_are_instructions(file: str, pou: str, construction: str) -> None:
    lowered = sfc.lower(sfc.load(FIXTURES / file), construction, pou=pou, language="IL")
    assert isinstance(lowered.pou.body, IlBody)
    assert lowered.proof is not None
    assert lowered.proof.equal


def test_comments_of_the_chart_are_those_of_the_instructions() -> None:
    text = (FIXTURES / "grafcet/four_steps.gct").read_text(encoding="utf-8").replace("STEP 2", 'STEP 2 "Antrieb ein"')
    lowered = sfc.lower(sfc.loads(text.encode()), "fup", style="classic", language="IL", verify=False)
    assert isinstance(lowered.pou.body, IlBody)
    assert "(* Antrieb ein *)" in lowered.pou.body.text
    assert lowered.losses == ()


@pytest.mark.parametrize("target", ["plcopen-2.01", "codesys", "codesys23", "iec-text"])
def test_a_file_with_instructions_does_what_the_chart_does(target: str, tmp_path: Path) -> None:
    chain = sfc.load(FIXTURES / "training-chain/plcopen_2.01.xml")
    lowered = sfc.lower(chain, "flipflop", language="IL", target=target)
    report = sfc.save(lowered, tmp_path / "chain", format=target, partial=True)
    assert all(str(verdict).startswith("equal") for verdict in report.compared.values())
    body = sfc.load(tmp_path / "chain").pou("Ablauf").body
    assert isinstance(body, IlBody)
    assert "LD X1\nAND B1\nST T1_2" in body.text.replace("\r", "")


@pytest.mark.parametrize(("name", "usual"), [("FUP", "FBD"), ("kop", "LD"), ("AWL", "IL"), ("SCL", "ST"), ("il", "IL")])
def test_languages_have_their_german_names(name: str, usual: str) -> None:
    chain = sfc.load(FIXTURES / "training-chain/plcopen_2.01.xml")
    lowered = sfc.lower(chain, "FUP", language=name, verify=False)
    body = lowered.pou.body
    assert body is not None
    assert (lowered.construction, body.language) == ("flipflop", usual)


@pytest.mark.parametrize("target", ["simaticml", "scl", "twincat"])
def test_a_target_without_instruction_list_is_refused(target: str) -> None:
    chain = sfc.load(FIXTURES / "training-chain/plcopen_2.01.xml")
    with pytest.raises(LoweringError, match=f"{target} has no bodies in instruction list"):
        sfc.lower(chain, "flipflop", language="IL", target=target)
    with pytest.raises(LoweringError, match="case is structured text, it cannot be in instruction list"):
        sfc.lower(chain, "case", language="IL")


@pytest.mark.parametrize("language", ["IL", "FBD", "LD", "ST"])
def test_nothing_is_kept_that_nothing_reads(language: str) -> None:
    """Under matiec each L remembers its step; where the output is FALSE otherwise, nothing asks for that."""
    station = sfc.load(FIXTURES / "plcopen/filling_station_2.01.xml")
    lowered = sfc.lower(station, "flipflop", pou="CapStation", language=language, profile="matiec", verify=False)
    names = {variable.name for variable in lowered.pou.variables()}
    assert {"X_Turn", "X_Turn_time"} <= names
    assert "Turn_before" not in names


STATION = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR_OUTPUT q, r : BOOL; END_VAR
VAR t : TON; END_VAR
INITIAL_STEP S1: A1(N); END_STEP
STEP S2: A2(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
ACTION A1: {} END_ACTION
ACTION A2: {} END_ACTION
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(("construction", "language"), [("auto", "ST"), ("bits", "IL")])
@pytest.mark.parametrize(
    "actions",
    [
        ("t(IN := a, PT := T#5m); q := t.Q;", "r := q;"),
        ("CAL t(IN := a, PT := T#5m)\nLD t.Q\nST q", "LD q\nST r"),
    ],
    ids=["ST", "IL"],
)
def test_timers_in_actions_are_proven_in_any_language(
    actions: tuple[str, str], construction: str, language: str
) -> None:
    """A timer of a step that was left would otherwise be another one in each scan."""
    chart = sfc.loads(STATION.format(*actions).encode(), format="iec-text")
    lowered = sfc.lower(chart, construction, language=language)
    assert lowered.proof is not None
    assert lowered.proof.proven
    assert lowered.proof.states < 50
