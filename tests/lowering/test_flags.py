"""The SFC flags of CODESYS do in lowered code what they do in a chart."""

from __future__ import annotations

from random import Random

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, Language, lower
from plcopen_sfc.lowering.construction import construct
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.profile import PROFILES
from tests.analysis.nets import block_chart
from tests.lowering.charts import act, boolean, pou_with, training_chain
from tests.lowering.test_exact import FORMS, verdict

STRING = m.StringType()


def chain_with(*flags: str, outputs: tuple[str, ...] = (), texts: tuple[str, ...] = ()) -> m.Pou:
    """The training chain with flags as inputs, and others as outputs: Boolean ones and texts."""
    pou = training_chain()
    assert pou.interface is not None
    pou.interface.sections[0].variables += [boolean(flag) for flag in flags]
    pou.interface.sections[1].variables += [boolean(flag) for flag in outputs]
    pou.interface.sections[1].variables += [m.Variable(name=flag, type=STRING) for flag in texts]
    return pou


def with_memories(pou: m.Pou) -> m.Pou:
    """The same with actions that remember something in every way."""
    chart = pou.sfc
    assert chart is not None
    assert pou.interface is not None
    timed = {m.Qualifier.SD, m.Qualifier.DS, m.Qualifier.L}
    for number, qualifier in enumerate([m.Qualifier.SD, m.Qualifier.DS, m.Qualifier.L, m.Qualifier.P], 1):
        act(chart, chart.steps[1], f"M{number}", qualifier, duration="T#20ms" if qualifier in timed else None)
        pou.interface.sections[1].variables.append(boolean(f"M{number}"))
    return pou


def lowered_text(pou: m.Pou, construction: Construction = Construction.BITS) -> str:
    chart = pou.sfc
    assert chart is not None
    rules = LoweringRules(PROFILES["codesys"], construction=construction)
    made = construct(pou, chart, Dialect.CODESYS, rules)
    body = made.pou.body
    assert isinstance(body, m.StBody)
    return body.text


@pytest.mark.slow
@pytest.mark.parametrize(
    "flags", [("SFCInit",), ("SFCReset",), ("SFCInit", "SFCReset"), ("SFCPause",), ("SFCInit", "SFCPause")]
)
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_what_sets_a_chart_back_and_stops_it(
    flags: tuple[str, ...], construction: Construction, language: Language
) -> None:
    found = verdict(chain_with(*flags), construction, language, "codesys")
    assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.parametrize("flag", ["SFCInit", "SFCReset"])
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_what_actions_remember_ends(flag: str, construction: Construction, language: Language) -> None:
    found = verdict(with_memories(chain_with(flag)), construction, language, "codesys")
    assert not found.different, str(found)


RESTING = """PROGRAM Main
VAR_INPUT a, b, SFCReset, SFCInit : BOOL; END_VAR
VAR_OUTPUT q, r : BOOL; END_VAR
INITIAL_STEP Rest: {rest} END_STEP
STEP Run: {run} END_STEP
TRANSITION FROM Rest TO Run := a; END_TRANSITION
TRANSITION FROM Run TO Rest := b; END_TRANSITION
END_PROGRAM"""


@pytest.mark.parametrize(
    ("rest", "run"),
    [
        ("q(D, T#30ms); r(SD, T#20ms);", "r(R);"),
        ("q(SL, T#30ms); r(L, T#30ms);", "q(SL, T#20ms);"),
        ("q(DS, T#30ms); r(S);", "q(R); r(R);"),
    ],
)
@pytest.mark.parametrize(
    ("construction", "language"),
    [("case", "ST"), ("bits", "ST"), ("flipflop", "ST"), ("flipflop", "FBD"), ("flipflop", "LD")],
)
def test_timed_actions_of_initial_steps_are_set_back(rest: str, run: str, construction: str, language: str) -> None:
    """The step of the action is active again in the scan in which it is set back."""
    project = sfc.loads(RESTING.format(rest=rest, run=run).encode(), format="iec-text")
    proof = lower(project, construction, language=language, profile="codesys").proof
    assert proof is not None
    assert proof.proven, str(proof)
    assert {"SFCReset", "SFCInit"} <= set(proof.inputs)


@pytest.mark.parametrize("flags", ["SFCReset", "SFCInit", "SFCReset, SFCInit"])
@pytest.mark.parametrize(
    "run", ["q(N);", "q(N); r(L, T#20ms);", "q(N); r(S);", "q(N); r(SD, T#20ms);", "q(N); Other(N);"]
)
@pytest.mark.parametrize(("construction", "language"), [("case", "ST"), ("bits", "ST"), ("flipflop", "FBD")])
def test_variables_that_others_could_write_are_set_back(flags: str, run: str, construction: str, language: str) -> None:
    """Outputs are global variables in most plants: no assignment in every scan resets them."""
    text = RESTING.format(rest="", run=run).replace("SFCReset, SFCInit", flags)
    text = text.replace("VAR_OUTPUT q", "VAR_OUTPUT RETAIN q")
    text = text.replace("END_PROGRAM", "ACTION Other: r := a AND NOT q; END_ACTION END_PROGRAM")
    proof = lower(sfc.loads(text.encode(), format="iec-text"), construction, language=language, profile="codesys").proof
    assert proof is not None
    assert proof.proven, str(proof)


@pytest.mark.slow
@pytest.mark.parametrize("flags", [("SFCTip", "SFCTipMode"), ("SFCTip",), ("SFCTipMode",), ("SFCTip", "SFCReset")])
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_step_by_step(flags: tuple[str, ...], construction: Construction, language: Language) -> None:
    pou = chain_with(*flags)
    chart = pou.sfc
    assert chart is not None
    chart.steps[1].min_time = "T#20ms"
    found = verdict(pou, construction, language, "codesys")
    assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_reports(construction: Construction, language: Language) -> None:
    pou = chain_with("SFCInit", "SFCPause", outputs=("SFCTrans",), texts=("SFCCurrentStep",))
    found = verdict(pou, construction, language, "codesys")
    assert found.kind is VerdictKind.PROVEN, str(found)
    assert {"SFCTrans", "SFCCurrentStep"} <= set(found.compared)


@pytest.mark.parametrize("flags", [("SFCReset",), ("SFCInit", "SFCTip", "SFCTipMode")])
def test_a_case_that_reports_transitions_has_one_state(flags: tuple[str, ...]) -> None:
    made = lower(chain_with(*flags, outputs=("SFCTrans",)), "case", profile="codesys")
    assert made.proof is not None
    assert made.proof.proven, str(made.proof)
    assert "SFCTrans" in made.proof.compared
    assert not [variable.name for variable in made.pou.variables() if variable.name.startswith("next_")]


@pytest.mark.slow
@pytest.mark.parametrize("condition", ["B2 AND (B3 OR NOT B4)", "B2 OR SFCError AND B3"])
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_maximum_times(construction: Construction, language: Language, condition: str) -> None:
    texts = ["SFCErrorStep", "SFCErrorPOU", *(["SFCErrorAnalyzation"] if language is Language.ST else [])]
    pou = chain_with("SFCEnableLimit", "SFCQuitError", outputs=("SFCError",), texts=tuple(texts))
    chart = pou.sfc
    assert chart is not None
    chart.steps[1].max_time = "T#10ms"
    chart.steps[2].max_time = "T#10ms"
    chart.steps[2].min_time = "T#5ms"
    chart.transitions[1].condition = m.Expression(text=condition)
    found = verdict(pou, construction, language, "codesys")
    assert not found.different, str(found)
    assert {"SFCError", *texts} <= set(found.compared)


@pytest.mark.slow
def test_parallel_steps_under_flags() -> None:
    chart = m.SfcNetwork()
    a, b, c, d = (chart.add_step(name, initial=name == "A") for name in "ABCD")
    chart.add_transition(a, [b, c], "c1")
    chart.add_transition(b, d, "c2")
    chart.add_transition([d, c], a, "c3")
    act(chart, b, "Q", m.Qualifier.S)
    act(chart, d, "P", m.Qualifier.P)
    b.max_time = "T#10ms"
    pou = pou_with(chart)
    assert pou.interface is not None
    pou.interface.sections[0].variables += [boolean(flag) for flag in ("SFCInit", "SFCReset", "SFCPause")]
    pou.interface.sections[1].variables += [boolean("SFCError"), m.Variable(name="SFCCurrentStep", type=STRING)]
    for construction, language in [*FORMS, (Construction.REGIONS, Language.ST)]:
        if construction is not Construction.CASE:
            found = verdict(pou, construction, language, "codesys")
            assert not found.different, f"{construction} {language}: {found}"


def test_a_chart_without_flags_has_no_code_for_them() -> None:
    plain = lowered_text(training_chain())
    assert "SFC" not in plain
    unused = training_chain()
    assert unused.sfc is not None
    unused.sfc.settings = m.SfcSettings(flags={flag: m.FlagUse(use=False) for flag in m.SfcFlag})
    assert lowered_text(unused) == plain


def test_flags_without_effect_cost_nothing() -> None:
    pou = training_chain()
    plain = lowered_text(pou)
    alone = chain_with("SFCEnableLimit", "SFCQuitError", texts=("SFCErrorStep",))
    assert lowered_text(alone) == plain, "they need SFCError"


def test_flags_that_only_the_tool_declares_are_declared() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.settings = m.SfcSettings(flags={m.SfcFlag.INIT: m.FlagUse(use=True)})
    rules = LoweringRules(PROFILES["codesys"], construction=Construction.BITS)
    made = construct(pou, chart, Dialect.CODESYS, rules)
    assert made.pou.interface is not None
    local = [s for s in made.pou.interface.sections if s.kind is m.SectionKind.LOCAL]
    assert "SFCInit" in [variable.name for section in local for variable in section.variables]


@pytest.mark.parametrize("declared", [True, False])
def test_flags_that_are_local_are_tried_in_the_proof(declared: bool) -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    assert pou.interface is not None
    if declared:
        local = m.VariableSection(kind=m.SectionKind.LOCAL, variables=[boolean("SFCInit")])
        pou.interface.sections.append(local)
    chart.settings = m.SfcSettings(flags={m.SfcFlag.INIT: m.FlagUse(use=True)})
    lowered = lower(m.Project(pous=[pou]), "bits", profile="codesys")
    assert lowered.proof is not None
    assert lowered.proof.proven
    assert "SFCInit" in lowered.proof.inputs
    assert lowered.pou.interface is not None
    assert "SFCInit" not in [v.name for v in lowered.pou.interface.variables(m.SectionKind.INPUT)]
    assert "SFCInit" in equivalent(pou, lowered).inputs
    body = lowered.pou.body
    assert isinstance(body, m.StBody)
    body.text = body.text.replace("IF SFCInit THEN", "IF FALSE THEN", 1)
    assert equivalent(pou, lowered).different


def with_table(*, declared: bool) -> m.Pou:
    """A chart that uses the table of the analysis, and shows what is in it."""
    outputs = ("SFCError", "First", "Second", "Value", "Empty")
    pou = chain_with("SFCQuitError", "SFCInit", outputs=outputs)
    chart = pou.sfc
    assert chart is not None
    assert pou.interface is not None
    chart.steps[1].max_time = "T#10ms"
    chart.transitions[1].condition = m.Expression(text="B2 AND (B3 OR NOT B4)")
    table = m.SfcFlag.ERROR_ANALYZATION_TABLE
    shown = [
        f"First := {table.variable}[0].name = 'B2';",
        f"Second := {table.variable}[1].name = 'B4';",
        f"Value := {table.variable}[1].value;",
        f"Empty := {table.variable}[2].name = '';",
    ]
    for step in chart.steps:
        step.main_action = m.StBody(text=" ".join(shown))
    if declared:
        kind = m.ArrayType(dimensions=[m.Dimension(lower="0", upper="15")], base=m.DerivedType(name="ExpressionResult"))
        local = m.VariableSection(kind=m.SectionKind.LOCAL, variables=[m.Variable(name=table.variable, type=kind)])
        pou.interface.sections.append(local)
    else:
        flags = (table, m.SfcFlag.ERROR, m.SfcFlag.QUIT_ERROR, m.SfcFlag.INIT)
        chart.settings = m.SfcSettings(flags={flag: m.FlagUse(use=True) for flag in flags})
    return pou


@pytest.mark.slow
@pytest.mark.parametrize("declared", [True, False])
@pytest.mark.parametrize("construction", ["bits", "case", "flipflop"])
def test_the_table_of_the_analysis(construction: str, declared: bool) -> None:
    """The project gets the type of its rows, which is part of a library of CODESYS."""
    lowered = lower(m.Project(pous=[with_table(declared=declared)]), construction, language="ST", profile="codesys")
    assert lowered.proof is not None
    assert not lowered.proof.different, str(lowered.proof)
    assert {"First", "Second", "Value", "Empty"} <= set(lowered.proof.compared)
    assert [kind.name for kind in lowered.project.data_types] == ["ExpressionResult"]
    body = lowered.pou.body
    assert isinstance(body, m.StBody)
    assert "SFCErrorAnalyzationTable[table_row].name := 'B2';" in body.text


def test_the_table_is_no_other_variable_and_is_not_drawn() -> None:
    with pytest.raises(LoweringError, match="declared with another type"):
        lowered_text(chain_with(outputs=("SFCError", "SFCErrorAnalyzationTable")))
    with pytest.raises(LoweringError, match="cannot be drawn"):
        lower(m.Project(pous=[with_table(declared=False)]), "flipflop", profile="codesys")


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_random_charts_under_random_flags(seed: int) -> None:
    random = Random(seed)  # noqa: S311
    chart = block_chart(seed, 6)
    for number, transition in enumerate(chart.transitions, 1):
        transition.condition = m.Expression(text=f"c{number % 4}")
    for step in chart.steps:
        if random.random() < 0.6:
            act(chart, step, random.choice(["q1", "q2"]), m.Qualifier(random.choice(["N", "S", "R", "P", "P1", "P0"])))
    pou = pou_with(chart)
    assert pou.interface is not None
    flags = random.sample(["SFCInit", "SFCReset", "SFCPause", "SFCTip", "SFCTipMode"], 2)
    pou.interface.sections[0].variables += [boolean(flag) for flag in flags]
    pou.interface.sections[1].variables.append(m.Variable(name="SFCCurrentStep", type=STRING))
    for construction, language in [FORMS[seed % 3], (Construction.AUTO, Language.ST), FORMS[4]]:
        found = verdict(pou, construction, language, "codesys")
        assert not found.different, f"{flags} {construction} {language}: {found}"


ALSO_WRITTEN = """PROGRAM Main
VAR_INPUT a, b, SFCInit : BOOL; END_VAR
VAR_OUTPUT r : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: Turn(N); END_STEP
STEP S3: r(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S3 := b; END_TRANSITION
TRANSITION FROM S3 TO S1 := a; END_TRANSITION
ACTION Turn: r := NOT r; END_ACTION
END_PROGRAM"""


@pytest.mark.parametrize("construction", ["case", "bits", "flipflop"])
def test_an_output_that_another_action_writes_stays_when_the_chart_is_set_back(construction: str) -> None:
    project = sfc.loads(ALSO_WRITTEN.encode(), format="iec-text")
    proof = lower(project, construction, profile="codesys").proof
    assert proof is not None
    assert proof.proven, str(proof)
