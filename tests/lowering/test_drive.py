"""Actions in a block of their own, which gets the step flags and drives the outputs."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import LoweredPou, lower
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.charts import act, boolean, pou_with, training_chain
from tests.lowering.test_flags import chain_with, with_memories

FORMS = [("flipflop", "FBD"), ("flipflop", "LD"), ("flipflop", "ST"), ("bits", "ST"), ("case", "ST")]
TARGETS = ["plcopen-2.01", "codesys", "simaticml", "scl", "iec-text"]


def project() -> m.Project:
    """A chain with actions of every kind that is a variable."""
    chart = training_chain().sfc
    assert chart is not None
    act(chart, chart.steps[1], "Q4", m.Qualifier.SD, duration="T#20ms")
    act(chart, chart.steps[3], "Q4", m.Qualifier.R)
    act(chart, chart.steps[2], "Q5", m.Qualifier.P)
    return m.Project(name="Anlage", pous=[pou_with(chart)])


def with_text() -> m.Project:
    """A chain whose actions read and write variables of their POU, in text."""
    chart = training_chain().sfc
    assert chart is not None
    pou = pou_with(chart)
    assert pou.interface is not None
    number = m.ElementaryType(name=m.Elementary.INT)
    local = [m.Variable(name="count", type=number), m.Variable(name="limit", type=number), boolean("seen")]
    pou.interface.sections.append(m.VariableSection(kind=m.SectionKind.LOCAL, variables=local))
    pou.actions.append(m.Action(name="CountUp", body=m.StBody(text="IF count < 3 THEN count := count + 1; END_IF;")))
    pou.actions.append(m.Action(name="Look", body=m.StBody(text="seen := count = 2 AND NOT B5;")))
    act(chart, chart.steps[1], "CountUp", m.Qualifier.P1)
    act(chart, chart.steps[2], "Look")
    return m.Project(pous=[pou])


def sections(pou: m.Pou) -> dict[str, list[str]]:
    assert pou.interface is not None
    return {section.kind.value: [variable.name for variable in section.variables] for section in pou.interface.sections}


def block_of(lowered: LoweredPou) -> m.Pou:
    return next(pou for pou in lowered.project.pous if pou.name != lowered.pou.name)


@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_it_does_what_the_chart_does(construction: str, language: str, profile: str) -> None:
    lowered = lower(
        project(), construction, language=language, profile=profile, actions="block", init="Init", reset_actions=True
    )
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    body = lowered.pou.body
    assert body is not None
    assert body.language == language
    assert block_of(lowered).body is not None


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_both_blocks_come_back_from_the_file(construction: str, language: str, target: str) -> None:
    if language != "ST" and target in ("scl", "iec-text"):
        pytest.skip("text has no networks")
    lowered = lower(project(), construction, language=language, actions="block", target=target, verify=False)
    again = sfc.loads(sfc.dumps(lowered.project, format=target, partial=True))
    found = equivalent(project(), resolve(again, "Ablauf"), "iec")
    assert found.kind is VerdictKind.PROVEN, str(found)
    assert {pou.name for pou in again.pous} == {"Ablauf", "Ablauf_Actions"}


def test_the_block_gets_what_it_reads_and_gives_what_it_drives() -> None:
    for construction, language in FORMS:
        lowered = lower(project(), construction, language=language, actions="block")
        found = sections(block_of(lowered))
        assert sorted(found["input"]) == ["B5", "X1", "X2", "X3", "X4"]
        assert sorted(found["output"]) == ["Q1", "Q2", "Q3", "Q4", "Q5"]
        assert "inOut" not in found
        assert "Actions" in sections(lowered.pou)["local"]


def test_texts_read_and_write_variables_of_their_pou() -> None:
    lowered = lower(with_text(), "bits", actions="block")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    found = sections(block_of(lowered))
    assert "count" in found["inOut"]
    assert "limit" not in [name for names in found.values() for name in names]
    # networks show no parameter that goes in and out: an output keeps what only the block writes
    drawn = lower(with_text(), "flipflop", actions="block")
    assert drawn.proof is not None
    assert drawn.proof.kind is VerdictKind.PROVEN
    assert "count" in sections(block_of(drawn))["output"]
    shared = with_text()
    chart = shared.pous[0].sfc
    assert chart is not None
    chart.steps[3].entry_action = m.StBody(text="count := 0;")
    with pytest.raises(LoweringError, match="read and written"):
        lower(shared, "flipflop", actions="block", profile="codesys")
    both = lower(shared, "bits", actions="block", profile="codesys")
    assert both.proof is not None
    assert both.proof.kind is VerdictKind.PROVEN


def test_flags_that_stand_elsewhere_are_not_passed_on() -> None:
    for target in ("codesys", "simaticml", "plcopen-2.01"):
        for flags in ("M20.0", "Steps"):
            lowered = lower(project(), "bits", actions="block", flags=flags, target=target)
            assert lowered.proof is not None
            assert lowered.proof.kind is VerdictKind.PROVEN
            found = sections(block_of(lowered))
            assert found["input"] == ["B5"]
            assert found.get("external", []) == (["X1", "X2", "X3", "X4"] if target == "plcopen-2.01" else [])


def test_tia_portal_is_told_of_every_parameter() -> None:
    lowered = lower(project(), "flipflop", actions="block", target="simaticml", lang="de")
    content = sfc.dumps(lowered.project, format="simaticml", partial=True).decode("utf-8-sig")
    assert '<CallInfo Name="Ablauf_Ansteuerung" BlockType="FB">' in content
    for name, section in (("X1", "Input"), ("B5", "Input"), ("Q1", "Output")):
        assert f'<Parameter Name="{name}" Section="{section}" Type="Bool" />' in content
    assert 'Datatype="&quot;Ablauf_Ansteuerung&quot;"' in content


def test_outputs_stand_beside_their_pins() -> None:
    lowered = lower(project(), "flipflop", actions="block", target="plcopen-2.01")
    body = lowered.pou.body
    assert isinstance(body, m.FbdBody)
    nodes = body.networks[0].nodes
    (call,) = [node for node in nodes if isinstance(node, m.Block) and node.instance == "Actions"]
    sinks = [node for node in nodes if isinstance(node, m.OutputVariable) and node.expression.startswith("Q")]
    rows = {v.name: call.position[1] + (v.output.position or (0, 0))[1] for v in call.parameters.outputs if v.output}
    assert {sink.expression for sink in sinks} == rows.keys()
    for sink in sinks:
        assert sink.position[0] > call.position[0] + (call.width or 0)
        assert sink.position[1] + 10 == rows[sink.expression]


def test_what_must_stay_in_its_pou_is_refused() -> None:
    original = project()
    pou = original.pous[0]
    assert pou.interface is not None
    timer = m.Variable(name="timer", type=m.DerivedType(name="TON"))
    pou.interface.sections.append(m.VariableSection(kind=m.SectionKind.LOCAL, variables=[timer]))
    pou.actions.append(m.Action(name="Wait", body=m.StBody(text="timer(IN := TRUE, PT := T#1s);")))
    chart = pou.sfc
    assert chart is not None
    act(chart, chart.steps[1], "Wait")
    with pytest.raises(LoweringError, match="instance of a function block"):
        lower(original, "bits", actions="block")
    with pytest.raises(LoweringError, match="block of their own"):
        lower(project(), "case", style="classic", actions="block")
    lowered = lower(project(), "flipflop", style="classic", actions="block", init="Init")
    assert block_of(lowered).name == "Ablauf_Actions"


def test_the_name_of_the_block_is_free() -> None:
    original = project()
    original.pous.append(m.Pou(name="Ablauf_Actions", kind=m.PouKind.FUNCTION_BLOCK))
    lowered = lower(original, "bits", pou="Ablauf", actions="block")
    assert [pou.name for pou in lowered.project.pous] == ["Ablauf", "Ablauf_Actions_2", "Ablauf_Actions"]


@pytest.mark.slow
@pytest.mark.parametrize("flags", [("SFCInit",), ("SFCReset",), ("SFCInit", "SFCReset", "SFCTip"), ("SFCPause",)])
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_flags_of_codesys_end_the_actions_of_the_block(
    flags: tuple[str, ...], construction: str, language: str
) -> None:
    """The block is told, forgets what it remembers, and is left in the scan of SFCInit."""
    pou = chain_with(*flags) if flags == ("SFCPause",) else with_memories(chain_with(*flags))
    lowered = lower(pou, construction, language=language, profile="codesys", actions="block")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)


@pytest.mark.slow
@pytest.mark.parametrize("target", ["plcopen-2.01", "codesys", "simaticml"])
@pytest.mark.parametrize("language", ["FBD", "LD", "ST"])
def test_flags_and_blocks_come_back_from_the_file(language: str, target: str) -> None:
    original = m.Project(pous=[with_memories(chain_with("SFCInit", "SFCReset"))])
    lowered = lower(
        original, "flipflop", language=language, profile="codesys", actions="block", target=target, verify=False
    )
    again = sfc.loads(sfc.dumps(lowered.project, format=target, partial=True))
    found = equivalent(original, resolve(again, "Ablauf"), "codesys")
    assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.slow
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_actions_that_steps_control_one_by_one(construction: str, language: str) -> None:
    """As matiec has them. The chain keeps the times of steps, and tells the block."""
    lowered = lower(project(), construction, language=language, profile="matiec", actions="block")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)
    original = project()
    chart = original.pous[0].sfc
    assert chart is not None
    act(chart, chart.steps[2], "Q5", m.Qualifier.D, duration="T#20ms")
    act(chart, chart.steps[1], "Q5", m.Qualifier.L, duration="T#20ms")
    timed = lower(original, construction, language=language, profile="matiec", actions="block", verify=False)
    found = equivalent(original, resolve(timed.project, "Ablauf"), "matiec", cap=500, runs=5)
    assert not found.different, str(found)
    assert {"X2_time_ET", "X3_time_ET"} <= set(sections(block_of(timed))["input"])
