"""``plcopen-sfc renumber``."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import plcopen_sfc as sfc
from tests.samples import FIXTURES

DRILL = FIXTURES / "simaticml" / "FB_Drill.xml"
CHAIN = FIXTURES / "training-chain" / "codesys.xml"


def test_steps_with_numbers_get_others_and_every_connection_follows(cli, tmp_path: Path) -> None:
    path = Path(shutil.copy(DRILL, tmp_path))
    outcome = cli("renumber", path, "--start", "10", "--increment", "10", "--json")
    assert (outcome.code, outcome.err) == (0, "")
    before, after = (sfc.load(each).pou("FB_Drill").chart for each in (DRILL, path))
    assert after.labels() == before.labels()
    numbers = sorted(step.number for step in after.steps)
    assert numbers == list(range(10, 10 * len(numbers) + 1, 10))
    assert {each["name"]: each["number"] for each in json.loads(outcome.out)["changed"]} == {
        step.name: step.number for step in after.steps
    }
    told = {each["name"]: (each["old"], each["number"]) for each in json.loads(outcome.out)["transitions"]}
    numbers_of = [{chart.label(each): each.number for each in chart.transitions} for chart in (before, after)]
    assert told == {name: (old, numbers_of[1][name]) for name, old in numbers_of[0].items()}
    shown = cli("renumber", path, "--start", "1").out
    assert f"{len(told)} of {len(told)} transitions have other numbers" in shown


def test_names_made_of_numbers(cli, tmp_path: Path) -> None:
    path = Path(shutil.copy(CHAIN, tmp_path))
    shown = cli("renumber", path, "--names", "N{number:02}", "--start", "5", "--dry-run")
    assert shown.code == 0
    assert "N05" in shown.out
    assert path.read_bytes() == CHAIN.read_bytes()
    written = cli("renumber", path, "--names", "N{number:02}", "--start", "5")
    assert "4 of 4 steps have other numbers or names" in written.out
    assert [step.name for step in next(sfc.load(path).charts()).chart.steps] == ["N05", "N06", "N07", "N08"]


def test_numbers_of_a_grafcet_are_names(cli, tmp_path: Path) -> None:
    """Over all partial charts; M20, E20 and S20 of a macro-step stay, and conditions and orders follow."""
    press = FIXTURES / "grafcet" / "press.gct"
    path = Path(shutil.copy(press, tmp_path))
    outcome = cli("renumber", path, "--start", "100", "--increment", "10", "--json")
    changed = {each["old"]: each["name"] for each in json.loads(outcome.out)["changed"]}
    before, after = ([step.name for step in sfc.load(each).steps()] for each in (press, path))
    assert [changed.get(name, name) for name in before] == after
    assert sorted(changed.values()) == [str(100 + 10 * place) for place in range(len(changed))]
    assert {name for name in after if not name.isdecimal()} == {"M20", "E20", "S20"}
    assert not sfc.check(sfc.load(path), select=["VAR01", "HIE", "CND08"])


def test_what_cannot_be_numbered_is_an_error(cli) -> None:
    sorting = FIXTURES / "codesys" / "sorting_conveyor.xml"
    for file, arguments, message in (
        (sorting, [], "there is no chart with numbers"),
        (CHAIN, ["--names", "S"], "gets this name too"),
        (CHAIN, ["--names", "{x}"], "is no form of names"),
        (CHAIN, ["--names", "S{number}", "--pou", "Nil"], "there is no chart 'Nil'"),
    ):
        outcome = cli("renumber", file, *arguments, "--dry-run")
        assert (outcome.code, outcome.out) == (2, "")
        assert message in outcome.err
