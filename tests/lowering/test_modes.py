"""Operating modes: at rest the chain does what the chart does; each mode does what it says."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import LoweredPou, lower
from plcopen_sfc.semantics.simulation import simulate
from tests.lowering.charts import act, pou_with, training_chain
from tests.sweeps import examples

FORMS = [("flipflop", "ST"), ("flipflop", "FBD"), ("flipflop", "LD"), ("case", "ST"), ("bits", "ST")]
MODES = ("enable", "single-step", "advance", "select")
SENSORS = ("B1", "B2", "B3", "B4")
PROFILES = ("iec", "codesys")


def project() -> m.Project:
    return m.Project(name="Anlage", pous=[training_chain()])


def parallel() -> m.Project:
    """S1, then S2 and S3 at once; S2 or S4 is left for S4 or S1 alone."""
    chart = m.SfcNetwork()
    first, left, right, last = (chart.add_step(f"S{n}", initial=n == 1) for n in (1, 2, 3, 4))
    chart.add_transition(first, [left, right], "a")
    chart.add_transition([left, right], last, "b")
    chart.add_transition(last, first, "c")
    return m.Project(pous=[pou_with(chart)])


KEYS = sorted((form, profile) for form in FORMS for profile in PROFILES)


@cache
def made(form: tuple[str, str], profile: str, modes: tuple[str, ...] = MODES) -> LoweredPou:
    """The chain with these modes. Many tests run it, none edits it."""
    return lower(project(), form[0], language=form[1], profile=profile, init="Init", modes=modes)


def active(lowered: LoweredPou, inputs: Sequence[Mapping[str, object]], profile: str) -> list[list[int]]:
    """The numbers of the steps that are active at the end of each scan."""
    assert lowered.pou.interface is not None
    declared = {variable.name for variable in lowered.pou.interface.variables()}
    rest: dict[str, object] = {**dict.fromkeys(declared & {*SENSORS, "a", "b", "c"}, False), **lowered.at_rest}
    trace = simulate(
        lowered.project,
        inputs=lambda scan, _: {**rest, **inputs[scan]},
        scans=len(inputs),
        profile=profile,
    )
    if "step_number" in trace:
        return [[int(trace["step_number"][scan])] for scan in range(len(inputs))]
    flags = [column.name for column in trace.columns if column.name[0] == "X" and column.name[1:].isdigit()]
    return [[int(name[1:]) for name in flags if trace[name][scan]] for scan in range(len(inputs))]


@pytest.mark.slow
@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("mode", [*MODES, "all"])
def test_at_rest_it_is_the_chart(form: tuple[str, str], profile: str, mode: str) -> None:
    modes = MODES if mode == "all" else (mode,)
    lowered = made(form, profile, modes)
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    assert lowered.at_rest["Init"] is False
    assert lowered.at_rest.get("Enable", True) is True


def pressed(pushes: Iterable[bool], **held: object) -> list[dict[str, object]]:
    return [{**held, "Advance": push} for push in pushes]


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(40))
@given(st.sampled_from(KEYS), st.lists(st.booleans(), min_size=1, max_size=15), st.booleans())
def test_a_push_leads_exactly_one_step_on(
    key: tuple[tuple[str, str], str], pushes: list[bool], with_conditions: bool
) -> None:
    """In a ring of four, whatever the conditions: with them all must be TRUE."""
    lowered, profile = made(*key), key[1]
    held: dict[str, object] = {"WithoutConditions": True}
    if with_conditions:
        held = {"SingleStep": True, **dict.fromkeys(SENSORS, True)}
    seen = active(lowered, pressed(pushes, **held), profile)
    edges = [now and not before for before, now in zip([False, *pushes], pushes, strict=False)]
    late = 1 if profile == "codesys" else 0  # where actions come first, steps change in the next scan
    expected = [[1 + sum(edges[: max(0, scan + 1 - late)]) % 4] for scan in range(len(pushes))]
    assert seen == expected


@pytest.mark.parametrize("key", KEYS)
def test_single_steps_wait_for_their_conditions(key: tuple[tuple[str, str], str]) -> None:
    lowered, profile = made(*key), key[1]
    rows: list[dict[str, object]] = [
        {"SingleStep": True, "B1": True},
        {"SingleStep": True, "B1": False, "Advance": True},
        {"SingleStep": True, "B1": True, "Advance": True},
        {"SingleStep": True, "B1": True},
        {"SingleStep": True, "B1": True, "Advance": True},
        {"SingleStep": True},
    ]
    assert active(lowered, rows, profile)[-1] == [2]
    assert active(lowered, rows[:4], profile)[-1] == [1]


@pytest.mark.parametrize("key", KEYS)
def test_nothing_fires_without_enable(key: tuple[tuple[str, str], str]) -> None:
    lowered, profile = made(*key), key[1]
    locked = {"Enable": False, **dict.fromkeys(SENSORS, True)}
    rows = [*([locked] * 3), {**locked, "WithoutConditions": True, "Advance": True}, {"B1": True}, {}]
    seen = active(lowered, rows, profile)
    assert seen[:4] == [[1]] * 4
    assert seen[-1] == [2]


@settings(deadline=None, max_examples=examples(40))
@given(
    st.sampled_from(KEYS),
    st.lists(st.fixed_dictionaries({name: st.booleans() for name in SENSORS}), max_size=6),
    st.integers(-1, 6),
)
def test_a_selected_step_is_the_only_active_one(
    key: tuple[tuple[str, str], str], before: list[dict[str, object]], number: int
) -> None:
    """From whatever step, while all conditions are TRUE; numbers of no step do nothing."""
    lowered, profile = made(*key), key[1]
    sensors = dict.fromkeys(SENSORS, number in range(1, 5))
    selected = {**sensors, "Select": True, "SelectedStep": number}
    seen = active(lowered, [*before, selected], profile)
    if number in range(1, 5):
        assert seen[-1] == [number]
        held = active(lowered, [*before, selected, {"Select": True, "SelectedStep": number}], profile)
        assert held[-1] == [number]
    else:
        # transitions of the scan before still move the chain where actions come first
        assert seen == active(lowered, [*before, {}], profile)


@pytest.mark.parametrize("key", KEYS)
def test_starting_anew_is_stronger_than_selecting(key: tuple[tuple[str, str], str]) -> None:
    lowered, profile = made(*key), key[1]
    assert active(lowered, [{"Init": True, "Select": True, "SelectedStep": 3}, {"Select": True}], profile)[-1] == [1]


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("form", [("flipflop", "FBD"), ("bits", "ST")])
def test_parallel_steps(form: tuple[str, str], profile: str) -> None:
    lowered = lower(parallel(), form[0], language=form[1], profile=profile, modes=MODES)
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    rows = pressed([True, False, False], WithoutConditions=True)
    rest: list[dict[str, object]] = [{"Select": True, "SelectedStep": 4}, {}]
    seen = active(lowered, [*rows, *rest], profile)
    assert seen[2] == [2, 3]
    assert seen[-1] == [4]
    again = active(lowered, [*rows, {}, *pressed([True, False], WithoutConditions=True)], profile)
    assert again[-1] == [4]


@pytest.mark.slow
@pytest.mark.parametrize("target", ["plcopen-2.01", "codesys", "simaticml"])
@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_networks_with_modes_come_back_from_files(target: str, language: str) -> None:
    lowered = lower(project(), "flipflop", language=language, target=target, modes=MODES, lang="de", verify=False)
    again = sfc.loads(sfc.dumps(lowered.project, format=target, partial=True))
    found = equivalent(project(), again, "iec", fixed=lowered.at_rest)
    assert found.kind is VerdictKind.PROVEN, str(found)
    assert set(lowered.at_rest) == {"Freigabe", "Einzelschritt", "OhneBedingungen", "Weiterschalten", "Anwahl"}


def test_a_push_leads_one_step_on_in_the_textbook_chain_too() -> None:
    """The step before the one before must be left: else it runs through the whole chain."""
    for language in ("ST", "FBD"):
        lowered = lower(project(), "flipflop", style="classic", language=language, init="Init", modes=["advance"])
        rows: list[dict[str, object]] = [{"Init": True}, *pressed([False, True, True, False, False])]
        seen = active(lowered, [{"WithoutConditions": True, **row} for row in rows], "iec")
        assert seen[-1] == [2]


def driven() -> m.Project:
    """Simultaneous branches and a sequence of its own beside them, with an output for each step."""
    chart = m.SfcNetwork()
    first, left, right = (chart.add_step(f"S{n}", initial=n == 1) for n in (1, 2, 3))
    inner = chart.add_step("Inner")
    beside, behind = chart.add_step("Beside", initial=True), chart.add_step("Behind")
    chart.add_transition(first, [left, right], "a")
    chart.add_transition(left, inner, "b")
    chart.add_transition([inner, right], first, "c")
    chart.add_transition(beside, behind, "b")
    chart.add_transition(behind, beside, "c")
    for step in chart.steps:
        act(chart, step, f"Q_{step.name}")
    return m.Project(pous=[pou_with(chart)])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("profile", "states"),
    [("iec", "numbers"), ("iec", "constants"), ("codesys", "numbers"), ("codesys", "enumeration")],
)
def test_selecting_is_the_same_in_every_construction(profile: str, states: str) -> None:
    """Of several regions too: all that step bits and CASEs can do together is searched, with every number."""
    modes = ["select"]
    bits = lower(driven(), "bits", profile=profile, init="Init", modes=modes, verify=False)
    made = lower(driven(), "regions", profile=profile, init="Init", modes=modes, states=states)
    assert made.proof is not None
    assert made.proof.kind is VerdictKind.PROVEN
    found = equivalent(bits.project, made.project, profile)
    assert found.kind is VerdictKind.PROVEN, str(found)
    wrong = lower(driven(), "bits", profile=profile, init="Init", verify=False)
    assert equivalent(wrong.project, made.project, profile).kind is VerdictKind.DIFFERENT


def test_an_enumeration_is_selected_by_numbers() -> None:
    made = lower(project(), "case", modes=["select"], states="enumeration")
    bits = lower(project(), "bits", modes=["select"])
    found = equivalent(bits.project, made.project, "iec")
    assert found.kind is VerdictKind.PROVEN, str(found)
    assert "SelectedStep: INT" in sfc.dumps(made.project, format="iec-text").decode().replace(" :", ":")


@pytest.mark.parametrize(("construction", "language"), [("flipflop", "FBD"), ("bits", "ST"), ("regions", "ST")])
def test_the_report_and_the_code_tell_the_numbers_of_steps(construction: str, language: str) -> None:
    made = lower(driven(), construction, language=language, modes=["select"], verify=False)
    assert made.step_numbers == {"S1": 1, "S2": 2, "S3": 3, "Inner": 4, "Beside": 5, "Behind": 6}
    assert made.as_dict()["step_numbers"] == made.step_numbers
    assert "4 Inner, 5 Beside" in str(made)
    body = made.code
    if isinstance(body, m.StBody):
        assert "// Operating modes\n// 1 = S1\n" in body.text
        assert "// 4 = Inner\n// 5 = Beside\n// 6 = Behind\nSelecting" in body.text
    else:
        assert isinstance(body, m.FbdBody)
        assert any(sheet.comment and "\n4 = Inner\n" in str(sheet.comment) for sheet in body.networks)
    plain = lower(project(), construction, language=language, modes=["select"], verify=False)
    assert "= S1" not in str(plain.code)  # their names say them


def test_numbers_are_told_where_the_code_has_them() -> None:
    assert lower(project(), "case", verify=False).step_numbers == {"S1": 1, "S2": 2, "S3": 3, "S4": 4}
    assert lower(project(), "bits", verify=False).step_numbers == {}
    assert "steps are selected" not in str(lower(project(), "case", verify=False))


def test_names_that_are_taken_get_a_number() -> None:
    original = project()
    assert original.pous[0].interface is not None
    taken = m.Variable(name="Enable", type=m.ElementaryType(name=m.Elementary.BOOL))
    original.pous[0].interface.sections[0].variables.append(taken)
    lowered = lower(original, "case", modes=["enable"])
    assert lowered.at_rest == {"Enable_2": True}


def test_what_cannot_be_stepped_by_hand_is_refused() -> None:
    regions = lower(parallel(), "regions", modes=["enable", "advance"])
    assert regions.proof is not None
    assert regions.proof.kind is VerdictKind.PROVEN
    with pytest.raises(LoweringError, match="no step that could be selected"):
        lower(m.SfcNetwork(), "bits", modes=["select"])
    with pytest.raises(LoweringError, match="search for stability"):
        lower(project(), "bits", modes=["single-step"], profile="grafcet")
