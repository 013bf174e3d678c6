"""Profiles: their choices, which one a project gets, and that the documentation tells all of them."""

from __future__ import annotations

import re
from dataclasses import fields, replace
from enum import StrEnum
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import ModelError
from plcopen_sfc.model import (
    ActionAssociation,
    ActionKind,
    Dialect,
    FileHeader,
    Pou,
    PouKind,
    Project,
    Qualifier,
    SfcBody,
    SfcFlag,
)
from plcopen_sfc.semantics.profile import (
    PROFILES,
    ActionControl,
    BooleanTargets,
    Evolution,
    Profile,
    ScanOrder,
    default_profile,
    profile,
)
from tests.semantics.charts.rig import MS, Rig, chain

ROOT = Path(__file__).parents[3]


def test_a_profile_by_its_name_or_itself() -> None:
    assert profile("CODESYS") is PROFILES["codesys"]
    own = replace(PROFILES["iec"], name="ours")
    assert profile(own) is own
    with pytest.raises(ModelError, match="no profile 'plc'"):
        profile("plc")


def test_names_are_keys() -> None:
    assert all(found.name == name for name, found in PROFILES.items())
    assert list(PROFILES) == ["iec", "codesys", "codesys23", "s7graph", "grafcet", "matiec", "beremiz"]


@pytest.mark.parametrize(
    ("dialect", "name"),
    [(Dialect.IEC, "iec"), (Dialect.CODESYS, "codesys"), (Dialect.TWINCAT, "codesys"), (Dialect.SCL, "s7graph")],
)
def test_the_dialect_of_a_project_decides(dialect: Dialect, name: str) -> None:
    assert default_profile(Project(name="p", dialect=dialect)).name == name


@pytest.mark.parametrize(
    ("fixture", "name"),
    [("plcopen", "iec"), ("codesys", "codesys"), ("simaticml", "s7graph")],
)
def test_the_format_of_a_file_decides(fixture: str, name: str) -> None:
    found = sorted(path for path in (ROOT / "fixtures").rglob("*.xml") if fixture in str(path.relative_to(ROOT)))
    if not found:
        pytest.skip(f"there is no fixture like {fixture}")
    assert default_profile(sfc.load(found[0])).name == name


@pytest.mark.parametrize(
    ("fixture", "name"),
    [("codesys23/distribution_belt.EXP", "codesys23"), ("plcopen/filling_station_2.01.xml", "beremiz")],
)
def test_json_keeps_the_tool_of_the_file_that_was_saved(fixture: str, name: str) -> None:
    saved = sfc.loads(sfc.dumps(sfc.load(ROOT / "fixtures" / fixture), format="json"))
    again = sfc.loads(sfc.dumps(saved, format="json", fresh=True))
    assert [default_profile(each).name for each in (saved, again)] == [name, name]


@pytest.mark.parametrize(
    ("company", "product", "version", "name"),
    [
        ("Beremiz", "Beremiz", "1", "beremiz"),
        ("Müller", "OpenPLC project", "2.3", "beremiz"),
        ("Unknown", "Unnamed", "1", "beremiz"),
        ("Unbekannt", "Unbenannt", "1", "beremiz"),
        ("Unknown", "Unnamed", "2.0", "iec"),
        ("Müller", "Mixer", "1", "iec"),
    ],
)
def test_the_header_of_a_tc6_file_tells_projects_of_beremiz(
    company: str, product: str, version: str, name: str
) -> None:
    project = Project(name="p", header=FileHeader(company=company, product=product, version=version))
    assert default_profile(project).name == "iec"  # nothing was read: nobody said which tool it is for
    read = sfc.loads(sfc.dumps(project, format="plcopen"), format="plcopen")
    assert default_profile(read).name == name


def test_a_project_with_actions_of_grafcet_is_one() -> None:
    chart = chain("1", "2")
    chart.step("1").actions = [ActionAssociation(id=1, kind=ActionKind.CONTINUOUS, target="Q")]
    project = Project(name="p", pous=[Pou(name="G1", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])])
    assert default_profile(project).name == "grafcet"


@pytest.mark.parametrize(
    "choices",
    [
        {"max_evolutions": 0},
        {"evolution": Evolution.UNTIL_STABLE, "order": ScanOrder.ACTIONS_FIRST},
        {"graph_parameters": True},
        {"action_control": ActionControl.SEQUENTIAL},
        {"boolean_targets": BooleanTargets.WHEN_DECIDED},
    ],
)
def test_choices_that_contradict_each_other_are_refused(choices: dict[str, object]) -> None:
    with pytest.raises(ModelError):
        Profile(name="ours", **choices)  # type: ignore[arg-type]


def test_time_can_stand_still_during_a_pause() -> None:
    own = replace(PROFILES["codesys"], pause_stops_time=True)
    chart = chain("A", "B")
    chart.step("A").actions = [ActionAssociation(id=1, qualifier=Qualifier.L, target="Q", duration="T#30ms")]
    rig = Rig(chart, own, variables="c1 c2 Q SFCPause", dialect=Dialect.CODESYS).scan(2)
    rig.scan(10, SFCPause=True)
    rig.scan(SFCPause=False)
    assert (rig["A.t"], rig["Q"]) == (20 * MS, True)
    assert rig.scan()["Q"] is False


def test_initial_steps_need_not_count_as_entered() -> None:
    for name, expected in (("iec", True), ("codesys", True), ("matiec", False)):
        chart = chain("A", "B")
        chart.step("A").actions = [ActionAssociation(id=1, qualifier=Qualifier.P, target="Q")]
        assert Rig(chart, name, variables="c1 c2 Q").scan()["Q"] is expected


def test_the_initial_situation_may_be_held_for_a_scan() -> None:
    held = replace(PROFILES["iec"], initial_situation_held=True)
    rig = Rig(chain("A", "B", conditions="TRUE FALSE"), held)
    assert [rig.scan().active for _ in range(2)] == ["A", "B"]


def _shown(value: object) -> str:
    match value:
        case frozenset():
            if value == PROFILES["iec"].qualifiers:
                return "those of IEC"
            known = sorted(str(item) for item in value if isinstance(item, Qualifier | SfcFlag))
            return " ".join(known) if value else "none"
        case bool():
            return "yes" if value else "no"
        case StrEnum():
            return value.value.replace("_", " ")
    return str(value)


def test_the_documentation_has_the_profiles_as_they_are() -> None:
    text = (ROOT / "docs" / "semantics.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `(\w+)` \| (.*) \|$", text, re.MULTILINE))
    for field in fields(Profile):
        if field.name == "name":
            continue
        values = [_shown(getattr(found, field.name)) for found in PROFILES.values()]
        assert rows.get(field.name) == " | ".join(values)
