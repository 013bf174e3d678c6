"""Actions of a GRAFCET in blocks of their own: one behind the evolutions, and one in each of them where they repeat."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import LoweredPou, States, lower
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.grafcets import pou_with
from tests.lowering.random_grafcets import random_calm_grafcet, random_grafcet
from tests.lowering.test_drive import sections
from tests.lowering.test_grafcet import ONCE, REFUSALS, SHORT
from tests.semantics.charts.rig import chain
from tests.semantics.charts.test_grafcet import action, seed_chain

FORMS = [("flipflop", "FBD"), ("flipflop", "LD"), ("flipflop", "ST"), ("case", "ST"), ("bits", "ST")]
PROFILES = [ONCE, SHORT]
EVENT = "cannot be in a block of their own: conditions of transitions ask for"


def seed() -> m.Pou:
    return pou_with(seed_chain(), "B1 B2 B3 B4 B5", "Q1 Q2 Q3")


def blocks(lowered: LoweredPou) -> dict[str, m.Pou]:
    return {pou.name: pou for pou in lowered.project.pous if pou.name != lowered.pou.name}


def compare(pou: m.Pou) -> int:
    """How many forms can hold the chart; all of them are proven."""
    held = 0
    for profile in PROFILES:
        for construction, language in FORMS:
            try:
                lowered = lower(pou, construction, language=language, profile=profile, actions="block")
            except LoweringError as refused:
                if any(why in refused.message for why in (*REFUSALS, EVENT)):
                    continue
                raise
            assert lowered.proof is not None
            assert lowered.proof.kind is VerdictKind.PROVEN, f"{profile.name} {construction}: {lowered.proof}"
            held += 1
    return held


@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_one_block_drives_what_the_seed_has(construction: str, language: str) -> None:
    lowered = lower(seed(), construction, language=language, profile=ONCE, actions="block", lang="de")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    (block,) = blocks(lowered).values()
    assert block.name == "Ablauf_Ansteuerung"
    found = sections(block)
    assert found["output"] == ["Q1", "Q2", "Q3"]
    assert sorted(found["input"]) == ["B5", "X1", "X2", "X2_alt", "X3", "X4", "X4_alt"]
    assert "inOut" not in found


@pytest.mark.parametrize(("construction", "language"), [("case", "ST"), ("bits", "ST"), ("flipflop", "ST")])
def test_stored_actions_have_a_block_in_the_loop(construction: str, language: str) -> None:
    lowered = lower(seed(), construction, language=language, profile=SHORT, actions="block")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    made = blocks(lowered)
    assert list(made) == ["Ablauf_StoredActions", "Ablauf_Actions"]
    assert sections(made["Ablauf_StoredActions"])["output"] == ["Q2"]
    assert sections(made["Ablauf_Actions"])["output"] == ["Q1", "Q3"]
    body = lowered.pou.body
    assert isinstance(body, m.StBody)
    assert body.text.index("StoredActions(") < body.text.index("END_REPEAT") < body.text.rindex("Actions(")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["onActivation", "onDeactivation"])
@pytest.mark.parametrize("step", ["1", "2"])
def test_stored_actions(kind: str, step: str) -> None:
    """Of initial steps too, and where the next condition asks for what they write."""
    chart = chain("1", "2", "3", conditions="a;Q OR b;b")
    chart.step(step).actions = [action(kind, "Q", value="NOT Q"), action(kind, "n", value="(n + 1) MOD 3")]
    assert compare(pou_with(chart, "a b", "Q n:INT")) >= 8


@pytest.mark.parametrize("first", ["0", "1"])
@pytest.mark.parametrize("states", list(States))
def test_the_initial_step_is_activated_whatever_its_state_is(states: States, first: str) -> None:
    """The copy of the state starts with a value too, which can be that of the initial step."""
    chart = chain(first, "2", conditions="a;Q")
    chart.step(first).actions = [action("onActivation", "Q", value="NOT Q")]
    lowered = lower(pou_with(chart, "a", "Q"), "case", language="ST", profile=SHORT, actions="block", states=states)
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN


@pytest.mark.slow
@pytest.mark.parametrize("event", ["↑a", "a AND b", "↓(a AND X2)"])
def test_events_are_seen_before_the_transitions(event: str) -> None:
    chart = chain("1", "2", conditions="a;b")
    chart.step("2").actions = [action("onEvent", "Q", condition=event, value="NOT Q")]
    assert compare(pou_with(chart, "a b", "Q")) >= 8


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["continuous", "conditional", "delayed", "limited"])
def test_continuous_actions_and_those_of_the_standard(kind: str) -> None:
    """Times are those of steps, which the chain has; the block is told when they are over."""
    chart = chain("1", "2", "3", conditions="↑a;b;↑a")
    fields = {"conditional": {"condition": "b"}}.get(kind, {"duration": "T#20ms"} if kind != "continuous" else {})
    chart.step("2").actions = [action(kind, "Q", **fields)]
    chart.step("3").actions = [
        action("continuous", "Q"),
        m.ActionAssociation(id=90, target="S", qualifier=m.Qualifier.P1),
        m.ActionAssociation(id=91, target="R", qualifier=m.Qualifier.SD, duration="T#20ms"),
    ]
    chart.step("1").actions = [m.ActionAssociation(id=92, target="R", qualifier=m.Qualifier.R)]
    assert compare(pou_with(chart, "a b", "Q R S")) >= 8


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 3])
def test_random_grafcets(seed: int) -> None:
    compare(random_grafcet(seed))
    assert compare(random_calm_grafcet(seed)) >= 4


@pytest.mark.parametrize("target", ["plcopen-2.01", "codesys", "simaticml", "scl", "iec-text"])
def test_blocks_come_back_from_the_file(target: str) -> None:
    forms = [("flipflop", "FBD", ONCE)] if target not in ("scl", "iec-text") else []
    for construction, language, profile in [*forms, ("case", "ST", SHORT)]:
        lowered = lower(
            seed(), construction, language=language, profile=profile, actions="block", target=target, verify=False
        )
        again = sfc.loads(sfc.dumps(lowered.project, format=target))
        code = resolve(again, "Ablauf")
        found = equivalent(seed(), code, profile, left_out=lowered.left_out, step_flags=lowered.step_flags)
        assert found.kind is VerdictKind.PROVEN, str(found)


def test_what_must_be_known_before_the_transitions_is_refused() -> None:
    chart = chain("1", "2", conditions="a;Q")
    chart.step("2").actions = [action("onEvent", "Q", condition="↑b", value="NOT Q")]
    with pytest.raises(LoweringError, match="conditions of transitions ask for Q"):
        lower(pou_with(chart, "a b", "Q"), "bits", profile=ONCE, actions="block")
    chart.transitions[1].condition = m.Expression(text="b")
    chart.step("2").actions = [action("onEvent", "Q", condition="↑b", value="X1")]
    with pytest.raises(LoweringError, match="they ask for steps, by X1"):
        lower(pou_with(chart, "a b", "Q"), "bits", profile=ONCE, actions="block")
    chart.step("2").actions = []
    assert list(blocks(lower(pou_with(chart, "a b", "Q"), "bits", profile=ONCE, actions="block"))) == []
