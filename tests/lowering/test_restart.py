"""Starting again: an input, a general reset condition, and what becomes of stored actions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import LoweredPou, lower
from plcopen_sfc.semantics.simulation import simulate
from tests.lowering.charts import boolean, pou_with, training_chain
from tests.sweeps import examples

FORMS = [("flipflop", "ST"), ("flipflop", "FBD"), ("flipflop", "LD"), ("case", "ST"), ("bits", "ST")]


def project() -> m.Project:
    return m.Project(name="Anlage", pous=[training_chain()])


def parallel_chart() -> m.Project:
    """S1, then S2 and S3 at once, then S1 again."""
    chart = m.SfcNetwork()
    first, left, right = (chart.add_step(f"S{n}", initial=n == 1) for n in (1, 2, 3))
    for transition, condition in (
        (chart.add_transition(first, [left, right]), "a"),
        (chart.add_transition([left, right], first), "b"),
    ):
        transition.condition = m.Expression(text=condition)
    return m.Project(pous=[pou_with(chart)])


def run(lowered: LoweredPou, inputs: Sequence[Mapping[str, bool]], profile: str) -> list[dict[str, object]]:
    """The outputs and what tells of steps, scan by scan."""
    trace = simulate(
        lowered.project,
        inputs=lambda scan, _: inputs[scan],
        scans=len(inputs),
        profile=profile,
    )
    told = [column.name for column in trace.columns if column.name[0] in "XQ" or column.name == "step_number"]
    return [{name: trace[name][scan] for name in told} for scan in range(len(inputs))]


KEYS = sorted((*form, profile) for form in FORMS for profile in ("iec", "codesys"))


@cache
def made(construction: str, language: str, profile: str) -> LoweredPou:
    """The chain with an input and a condition that restart it. Many tests run it, none edits it."""
    return lower(
        project(), construction, language=language, profile=profile, init="Init", stop="NOT NOT_AUS", reset_actions=True
    )


@pytest.mark.parametrize(("construction", "language", "profile"), KEYS)
def test_at_rest_the_code_does_what_the_chart_does(construction: str, language: str, profile: str) -> None:
    lowered = made(construction, language, profile)
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    assert lowered.left_out == "Restart"
    assert [v.name for v in lowered.pou.interface.variables() if v.name in ("Init", "NOT_AUS")] == ["Init", "NOT_AUS"]


SCANS = st.lists(st.fixed_dictionaries({name: st.booleans() for name in ("B1", "B2", "B3", "B4", "B5")}), max_size=12)


@cache
def made_without_condition(construction: str, language: str) -> LoweredPou:
    return lower(
        project(), construction, language=language, profile="codesys", init="Init", reset_actions=True, verify=False
    )


@settings(deadline=None, max_examples=examples(25))
@given(st.sampled_from(KEYS), SCANS, SCANS, st.integers(1, 3), st.booleans())
def test_afterwards_the_chain_goes_on_as_if_it_had_just_begun(
    key: tuple[str, str, str],
    before: list[dict[str, bool]],
    after: list[dict[str, bool]],
    held: int,
    emergency: bool,
) -> None:
    lowered, profile = made(*key), key[2]
    calm = {"Init": False, "NOT_AUS": True}
    pressed = {"NOT_AUS": False} if emergency else {"Init": True}
    stopped = [dict.fromkeys(("B1", "B2", "B3", "B4", "B5"), True) | calm | pressed] * held
    sequence = [*({**row, **calm} for row in before), *stopped, *({**row, **calm} for row in after)]
    seen = run(lowered, sequence, profile)
    for row in seen[len(before) : len(before) + held]:
        assert row["Q1"] is True
        assert row["Q2"] is row["Q3"] is False
        assert row.get("step_number", 1) == 1
    fresh = run(lowered, [{**row, **calm} for row in after], profile) if after else []
    assert seen[len(before) + held :] == fresh


@settings(deadline=None, max_examples=examples(25))
@given(st.sampled_from(FORMS), SCANS, st.randoms(use_true_random=False))
def test_starting_anew_is_what_sfc_reset_does(
    form: tuple[str, str], scans: list[dict[str, bool]], random: Random
) -> None:
    """SFCReset of CODESYS sets the initial step, ends stored actions, and lets no transition fire."""
    original = project()
    assert original.pous[0].interface is not None
    original.pous[0].interface.sections[0].variables.append(boolean("SFCReset"))
    pressed = [random.random() < 0.3 for _ in scans]
    inputs = [row | {"SFCReset": reset} for row, reset in zip(scans, pressed, strict=True)]
    trace = simulate(original, inputs=lambda scan, _: inputs[scan], scans=len(inputs), profile="codesys")
    found = run(
        made_without_condition(*form),
        [row | {"Init": reset} for row, reset in zip(scans, pressed, strict=True)],
        "codesys",
    )
    for scan, row in enumerate(found):
        assert {name: row[name] for name in ("Q1", "Q2", "Q3")} == {n: trace[n][scan] for n in ("Q1", "Q2", "Q3")}


def test_all_steps_of_parallel_branches_are_left() -> None:
    for construction, language in (("flipflop", "FBD"), ("bits", "ST")):
        for profile in ("iec", "codesys"):
            lowered = lower(parallel_chart(), construction, language=language, profile=profile, stop="HALT")
            inputs = [{"a": True, "b": False, "HALT": False}] * 3 + [{"HALT": True}]
            seen = run(lowered, inputs, profile)
            assert [seen[-2][f"X{n}"] for n in (1, 2, 3)] == [False, True, True]
            assert [seen[-1][f"X{n}"] for n in (1, 2, 3)] == [True, False, False]


@pytest.mark.slow
def test_stored_actions_stay_unless_they_are_to_end() -> None:
    inputs = [{"B1": True}, {"B1": False, "Init": True}, {"Init": False}]
    for construction, language in FORMS:
        for ends in (False, True):
            lowered = lower(project(), construction, language=language, init="Init", reset_actions=ends)
            assert [row["Q2"] for row in run(lowered, inputs, "iec")] == [True, not ends, not ends]


def test_an_input_of_this_name_is_used() -> None:
    original = project()
    assert original.pous[0].interface is not None
    original.pous[0].interface.sections[0].variables.append(boolean("Init"))
    lowered = lower(original, "flipflop", init="init")
    assert lowered.pou.interface is not None
    assert [v.name for v in lowered.pou.interface.variables()].count("Init") == 1
    assert "init" not in [v.name for v in lowered.pou.interface.variables()]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"init": "S1"}, "name of a step"),
        ({"init": "Ablauf"}, "something else"),
        ({"init": "a AND b"}, "no name"),
        ({"stop": "NOT ("}, "no condition"),
        ({"init": "Number"}, "no BOOL"),
    ],
)
def test_what_is_no_condition_is_refused(options: dict[str, str], message: str) -> None:
    original = project()
    assert original.pous[0].interface is not None
    number = m.Variable(name="Number", type=m.ElementaryType(name=m.Elementary.INT))
    original.pous[0].interface.sections[0].variables.append(number)
    with pytest.raises(LoweringError, match=message):
        lower(original, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_step_bits_say_at_one_place_what_they_are_when_the_chain_starts_anew(profile: str) -> None:
    body = lower(project(), "bits", profile=profile, init="Init", verify=False).pou.body
    assert isinstance(body, m.StBody)
    paragraphs = body.text.split("\n\n")
    expected = ["IF Init THEN", "X1 := TRUE;", "X2 := FALSE;", "X3 := FALSE;", "X4 := FALSE;", "END_IF;"]
    found = [[line.strip() for line in each.splitlines()][1:] for each in paragraphs]
    at = found.index(expected)
    assert [each.splitlines()[0] for each in paragraphs[at - 1 : at + 1]] == [
        "// Steps that become active",
        "// Restart the sequence",
    ]
    assert found[at - 1] == [
        "X1 := T4_1 OR X1 AND NOT T1_2;",
        "X2 := T1_2 OR X2 AND NOT T2_3;",
        "X3 := T2_3 OR X3 AND NOT T3_4;",
        "X4 := T3_4 OR X4 AND NOT T4_1;",
    ]


@pytest.mark.parametrize("style", ["exact", "classic"])
def test_an_input_that_the_chart_reads_does_not_restart_it(style: str) -> None:
    text = b"""PROGRAM Main
    VAR_INPUT a : BOOL; b : BOOL; END_VAR
    VAR_OUTPUT q : BOOL; END_VAR
    INITIAL_STEP S0: END_STEP
    STEP S1: q(N); END_STEP
    TRANSITION FROM S0 TO S1 := a; END_TRANSITION
    TRANSITION FROM S1 TO S0 := b; END_TRANSITION
    END_PROGRAM"""
    with pytest.raises(LoweringError, match="a cannot restart the chart"):
        sfc.lower(sfc.loads(text, format="iec-text"), "case", style=style, init="a", language="ST")
