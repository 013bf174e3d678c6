"""Charts that force others, in the order of their hierarchy, together with a restart and with blocks."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.lowering import LoweredPou, lower
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.simulation import simulate
from plcopen_sfc.semantics.subjects import resolve
from tests.corpus import require_official_schema
from tests.formats.simaticml.official import official, outer_parts, without_namespace
from tests.lowering.grafcets import pou_with
from tests.lowering.test_grafcet import ONCE, SHORT, emergency_stop_of_the_seed
from tests.semantics.charts.rig import chain
from tests.semantics.charts.test_grafcet import action

FORMS = [("flipflop", "FBD"), ("flipflop", "LD"), ("flipflop", "ST"), ("bits", "ST"), ("regions", "ST")]
PROFILES = [ONCE, SHORT]


def forcing(chart: str, situation: str, *steps: str) -> m.ActionAssociation:
    order = m.ForcingOrder.model_validate({"chart": chart, "situation": situation, "steps": list(steps)})
    return m.ActionAssociation(id=9, kind=m.ActionKind.FORCING, forcing=order)


def three_levels() -> m.Pou:
    """Step 21 forces G2 into step 11, which empties G1: within one evolution, whatever the order of the charts is."""
    top, middle, low = chain("20", "21", conditions="a;b"), chain("10", "11", conditions="c;NOT c"), chain("1", "2")
    top.step("21").actions = [forcing("G2", "explicit", "11")]
    middle.step("11").actions = [forcing("G1", "{}")]
    low.step("1").actions = [action("onActivation", "R", value="TRUE")]
    low.step("2").actions = [action("continuous", "Q"), action("onActivation", "S", value="TRUE")]
    charts = [m.PartialChart(name=f"G{n}", chart=each) for n, each in enumerate((low, middle, top), 1)]
    return pou_with(m.SfcNetwork(partial_charts=charts), "a b c c1 c2", "Q R S")


def proven(lowered: LoweredPou) -> bool:
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)
    return True


@pytest.mark.slow
@pytest.mark.parametrize("profile", PROFILES, ids=lambda profile: profile.name)
@pytest.mark.parametrize("pou", [three_levels(), emergency_stop_of_the_seed()], ids=["three levels", "seed"])
def test_with_what_starts_the_chain_anew_all_forms_do_the_same(pou: m.Pou, profile: Profile) -> None:
    """The proof compares them with the chart at rest; with the inputs that were added, with each other."""
    options = {"init": "Init", "stop": "NOT Guard", "reset_actions": True}
    made = {
        form: lower(pou, form[0], language=form[1], profile=profile, **options)  # type: ignore[arg-type]
        for form in FORMS
    }
    assert all(proven(each) for each in made.values())
    bits = made["bits", "ST"]
    for each in list(made.values())[:3]:
        found = equivalent(bits.project, each.project, profile)
        assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.slow
@pytest.mark.parametrize("profile", PROFILES, ids=lambda profile: profile.name)
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_in_blocks_and_by_the_hierarchy(construction: str, language: str, profile: Profile) -> None:
    for pou in (three_levels(), emergency_stop_of_the_seed()):
        assert proven(lower(pou, construction, language=language, profile=profile, actions="block"))


@pytest.mark.parametrize("actions", ["inline", "block"])
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_a_restart_ends_what_is_stored_only_where_that_is_wanted(
    construction: str, language: str, actions: str
) -> None:
    """Then it is as at the start, where initial steps may store something."""
    rows: list[dict[str, object]] = [{}, {"c1": True}, {"c1": False, "Init": True}, {}, {"Init": False}]
    for reset, expected in ((False, [False, True, True, True, True]), (True, [False, True, False, False, False])):
        lowered = lower(
            three_levels(),
            construction,
            language=language,
            profile=ONCE,
            init="Init",
            reset_actions=reset,
            actions=actions,
            verify=False,
        )
        code = resolve(lowered.project, "Ablauf")
        trace = simulate(code.project, pou="Ablauf", inputs=lambda scan, _: rows[scan], scans=5, profile=ONCE)
        assert trace["S"] == expected
        assert trace["R"] == [True] * 5
        assert trace["Q"] == [False, True, False, False, False]


def test_charts_above_stand_before_those_below() -> None:
    lowered = lower(three_levels(), "flipflop", profile=ONCE)
    body = lowered.pou.body
    assert isinstance(body, m.FbdBody)
    titles = [str(network.title) for network in body.networks if str(network.title).startswith("Step ")]
    numbers = [int("".join(filter(str.isdigit, title.split("–")[0].rpartition(".")[2]))) for title in titles]
    assert numbers == [20, 21, 10, 11, 1, 2]


@pytest.mark.slow
@pytest.mark.parametrize("first", ["Ablauf", "Other"])
@pytest.mark.parametrize("target", ["plcopen-2.01", "simaticml"])
def test_several_blocks_of_one_project(target: str, first: str) -> None:
    """Each has an emergency stop above its chain; one is lowered after the other, in any order."""
    other = three_levels()
    other.name = "Other"
    original = m.Project(pous=[emergency_stop_of_the_seed(), other])
    done = lower(original, "flipflop", pou=first, profile=SHORT, target=target, verify=False)
    rest = next(pou.name for pou in original.pous if pou.name != first)
    again = lower(done.project, "flipflop", pou=rest, profile=SHORT, target=target, verify=False)
    read = sfc.loads(sfc.dumps(again.project, format=target))
    for made in (done, again):
        found = equivalent(
            resolve(original, made.pou.name),
            resolve(read, made.pou.name),
            SHORT,
            left_out=made.left_out,
            step_flags=made.step_flags,
        )
        assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.slow
@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_networks_that_jump_back_are_valid_by_the_official_schemas(language: str, tmp_path: Path) -> None:
    pou = emergency_stop_of_the_seed()
    made = {
        target: lower(pou, "flipflop", language=language, profile=SHORT, target=target, actions="block", verify=False)
        for target in ("plcopen-2.01", "simaticml")
    }
    content = sfc.dumps(made["plcopen-2.01"].project, format="plcopen-2.01")
    schema = etree.XMLSchema(etree.parse(require_official_schema("2.01")))
    assert b"<jump " in content
    assert schema.validate(etree.fromstring(content)), schema.error_log
    sfc.save(made["simaticml"].project, f"{tmp_path}/", format="simaticml")
    parts = [part for path in sorted(tmp_path.rglob("*.xml")) for part in outer_parts(etree.parse(path).getroot())]
    assert any(element.find(".//{*}LabelDeclaration") is not None for _, _, element in parts)
    for kind, number, element in parts:
        schema = official(kind, number)
        assert schema.validate(without_namespace(element)), schema.error_log
