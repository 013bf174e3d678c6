"""One CASE for each part of a chart: proven equal, whatever its branches are, under both orders of a scan."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc import loads
from plcopen_sfc import model as m
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, Language, Style, lower
from plcopen_sfc.lowering.construction import Constructed, construct
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.net import Net, NetStep
from plcopen_sfc.semantics.profile import PROFILES
from tests.analysis.nets import block_chart, chart_of
from tests.languages.networks.build import output
from tests.lowering.charts import act, boolean, pou_with
from tests.sweeps import examples

PARALLEL = "S1>S2+S10 S2>S3 S10>S11 S3+S11>S4 S4>S1"


def chain(text: str, initial: str = "S1", conditions: dict[int, str] | None = None) -> m.Pou:
    """A chart like ``S1>S2+S3``: transition 1 waits for c1, each step drives an output of its own."""
    return driven(chart_of(text, initial), conditions or {})


def driven(chart: m.SfcNetwork, conditions: dict[int, str]) -> m.Pou:
    for number, transition in enumerate(chart.transitions, 1):
        transition.condition = m.Expression(text=f"c{number}")
    for step in chart.steps:
        act(chart, step, f"q{step.name}")
    pou = pou_with(chart)
    for number, text in conditions.items():
        chart.transitions[number - 1].condition = m.Expression(text=text)
    return pou


def lowered(pou: m.Pou, construction: Construction = Construction.REGIONS, profile: str = "iec") -> Constructed:
    chart = pou.sfc
    assert chart is not None
    return construct(pou, chart, Dialect.IEC, LoweringRules(PROFILES[profile], construction=construction))


def verdict(
    pou: m.Pou, construction: Construction = Construction.REGIONS, profile: str = "iec", cap: int = 5_000
) -> Verdict:
    made = lowered(pou, construction, profile)
    assert {path.removesuffix("._x") for path in made.step_flags} == {s.path for s in steps_of(pou)}
    return equivalent(pou, made.pou, profile, step_flags=made.step_flags, cap=cap, runs=20)


def steps_of(pou: m.Pou) -> tuple[NetStep, ...]:
    assert pou.sfc is not None
    return Net.of(pou.sfc).steps


def text_of(made: Constructed) -> str:
    return text_of_pou(made.pou)


def text_of_pou(pou: m.Pou) -> str:
    assert isinstance(pou.body, m.StBody)
    return pou.body.text


CHARTS = {
    "one block": (PARALLEL, "S1"),
    "three branches, one of a single step": ("S1>S2+S3+S4 S2>S5 S3>S6 S5+S6+S4>S1", "S1"),
    "a block in a branch": ("S1>S2+S3 S3>S4+S5 S4+S5>S6 S2+S6>S1", "S1"),
    "a block behind a block": ("S1>S2+S3 S2+S3>S4 S4>S5+S6 S5+S6>S1", "S1"),
    "branches that never end": ("S1>S2+S3 S2>S4 S4>S2 S3>S5", "S1"),
    "two forks and two joins": ("S1>S2+S3 S1>S4+S5 S2>S4 S3>S5 S4+S5>S6 S2+S5>S1 S6>S1", "S1"),
    "selection inside a branch": ("S1>S2+S3 S2>S4 S2>S5 S4>S6 S5>S6 S3+S6>S1", "S1"),
    "exit behind the join in priority": ("S1>S2+S3 S2>S4 S3+S4>S1 S4>S2", "S1"),
    "exit before the join in priority": ("S1>S2+S3 S2>S4 S4>S2 S3+S4>S1", "S1"),
    "exits of both branches": ("S1>S2+S3 S4>S2 S2>S4 S3>S5 S4+S5>S1 S5>S3 S2+S3>S1", "S1"),
    "exit into a block": ("S1>S2+S3 S2>S4+S5 S4+S5>S2 S2+S3>S1", "S1"),
    "two sequences": ("S1>S2 S2>S1 S5>S6 S6>S7 S7>S5", "S1+S5"),
    "two sequences, one with a block": ("S1>S2 S2>S1 S5>S6+S7 S6+S7>S5", "S1+S5"),
    "one step at a time": ("S1>S2 S1>S3 S2>S1 S3>S1", "S1"),
    "a step that is left and entered at once": ("S1>S1 S1>S2+S3 S2>S2 S2+S3>S1", "S1"),
    "a branch that can end, so that the join waits for ever": ("S1>S2+S3 S2>S4 S4> S3+S4>S1", "S1"),
    "two sequences, one that ends": ("S1>S2 S2>S1 S5>S6 S6> S6>S5", "S1+S5"),
    "a step with the number of no step": ("S0>S1+S2 S1+S2>S0", "S0"),
}


@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("name", CHARTS)
def test_parts_of_every_kind(name: str, profile: str) -> None:
    found = verdict(chain(*CHARTS[name]), profile=profile)
    assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["iec", "codesys"])
@settings(deadline=None, max_examples=examples(12))
@given(seed=st.integers(0, 10_000), size=st.integers(3, 9))
def test_random_charts_of_blocks(profile: str, seed: int, size: int) -> None:
    pou = driven(block_chart(seed, size), {})
    found = verdict(pou, profile=profile)
    assert found.kind is not VerdictKind.DIFFERENT, str(found)


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_conditions_see_other_parts_as_they_were(profile: str) -> None:
    """S10 becomes active in the scan in which S2 is left: a CASE must not see what another one has just done."""
    watching = {2: "c2 AND S10.X", 3: "c3 AND NOT S3.X"}
    assert verdict(chain(PARALLEL, conditions=watching), profile=profile).kind is VerdictKind.PROVEN
    sequences = chain("S1>S2 S2>S1 S5>S6 S6>S5", "S1+S5", {1: "c1 AND S5.X", 3: "S2.X", 4: "S1.X AND c4"})
    assert verdict(sequences, profile=profile).kind is VerdictKind.PROVEN


@pytest.mark.parametrize("construction", list(Construction))
def test_the_time_of_a_step_begins_anew_when_it_is_entered_again(construction: Construction) -> None:
    pou = chain("S1>S2 S2>S2 S2>S2 S2>S1", conditions={4: "S2.T >= T#30ms"})
    assert verdict(pou, construction, "iec").kind is VerdictKind.PROVEN
    # where nothing ends the time there are as many states as there are times
    assert not verdict(pou, construction, "codesys", cap=200).different


def test_the_time_of_a_step_that_one_transition_leaves_and_another_one_enters() -> None:
    pou = chain("S1>S2 S2>S1", "S1+S2", conditions={2: "S2.T >= T#30ms"})
    assert verdict(pou, Construction.BITS).kind is VerdictKind.PROVEN


def test_the_text_of_a_block() -> None:
    assert text_of(lowered(chain(PARALLEL))).startswith(
        """\
// Transitions
T3_4 := step_number_S2 = 3 AND step_number_S10 = 11 AND c4;

// Step sequence from S2
CASE step_number_S2 OF
    2: // Step 2
        IF c2 THEN
            step_number_S2 := 3;
        END_IF;
    3: // Step 3
        ; // until the simultaneous branches are joined
END_CASE;

// Step sequence from S10
CASE step_number_S10 OF
    10: // Step 10
        IF c3 THEN
            step_number_S10 := 11;
        END_IF;
    11: // Step 11
        ; // until the simultaneous branches are joined
END_CASE;

// Step sequence from S1
CASE step_number OF
    1: // Step 1 – initial step
        IF c1 THEN
            step_number := 101;
            step_number_S2 := 2;
            step_number_S10 := 10;
        END_IF;

    4: // Step 4
        IF c5 THEN
            step_number := 1;
        END_IF;

    101: // simultaneous branches from S2, S10
        IF T3_4 THEN
            step_number := 4;
            step_number_S2 := 0;
            step_number_S10 := 0;
        END_IF;
END_CASE;
"""
    )


def test_a_branch_of_one_step_needs_no_case() -> None:
    pou = chain("S1>S2+S3 S2>S4 S4+S3>S1")
    text = text_of(lowered(pou))
    assert "step_number_S3" not in text, "it is active while the others wait"
    assert "qS3 := step_number = 101;" in text
    assert verdict(pou).kind is VerdictKind.PROVEN


@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize(
    "edges",
    [
        "S1>S2+S3 S2+S3>S1",
        "S1>S2+S3 S1>S2+S3 S2+S3>S1 S2+S3>S4 S4>S1",
        "S1>S2+S3 S2+S3>S4 S4>S5+S6+S7 S5>S5 S5+S6+S7>S1",
        "S1>S2+S3 S2>S4+S5 S4+S5>S6 S6+S3>S1",
    ],
)
def test_branches_of_one_step_have_no_state_of_their_own(edges: str, profile: str) -> None:
    """Also with conditions, times and code of steps that ask for them."""
    pou = chain(edges)
    assert pou.sfc is not None
    for step in pou.sfc.steps[1:3]:
        step.entry_action = m.StBody(text="n := (n + 1) MOD 3;") if profile == "codesys" else None
        step.main_action = m.StBody(text="k := NOT k;") if profile == "codesys" else None
    act(pou.sfc, pou.sfc.step("S3"), "late", m.Qualifier.D, duration="T#20ms")
    act(pou.sfc, pou.sfc.step("S2"), "early", m.Qualifier.L, duration="T#10ms")
    assert pou.interface is not None
    pou.interface.sections[1].variables += [boolean(name) for name in ("late", "early", "k")]
    pou.interface.sections[1].variables.append(m.Variable(name="n", type=m.ElementaryType(name=m.Elementary.INT)))
    assert "step_number_S3" not in text_of(lowered(pou, profile=profile))
    assert verdict(pou, profile=profile).kind is VerdictKind.PROVEN


def test_sequences_that_do_not_ask_for_each_other_need_one_variable_each() -> None:
    assert text_of(lowered(chain("S1>S2 S2>S1 S5>S6 S6>S5", "S1+S5"))).startswith(
        """\
// Step sequence from S1
CASE step_number OF
    1: // Step 1 – initial step
        IF c1 THEN
            step_number := 2;
        END_IF;
    2: // Step 2
        IF c2 THEN
            step_number := 1;
        END_IF;
END_CASE;

// Step sequence from S5
CASE step_number_S5 OF
    5: // Step 5 – initial step
        IF c3 THEN
            step_number_S5 := 6;
"""
    )


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_an_input_starts_all_parts_anew(profile: str) -> None:
    for text, initial in ((PARALLEL, "S1"), ("S1>S2 S2>S1 S5>S6 S6>S5", "S1+S5"), CHARTS["exit into a block"]):
        pou = chain(text, initial)
        regions, bits = (lower(pou, form, init="Init", profile=profile) for form in ("regions", "bits"))
        found = equivalent(regions.pou, bits.pou, profile)
        assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_what_a_condition_executes_is_executed_only_where_it_is_tried(profile: str) -> None:
    """A condition that counts is evaluated while its transition is enabled and no competing one before it fires."""
    counting = "n := n + 1;\nready := n >= {} AND {};"
    texts = {
        "S1>S2 S1>S3 S1>S1 S2>S1 S3>S1": (2, 3),
        "S1>S2+S3 S2>S4 S4>S2 S3+S4>S1": (3, 4),
    }
    for text, positions in texts.items():
        pou = chain(text)
        assert pou.interface is not None
        pou.interface.sections[1].variables += [
            m.Variable(name="n", type=m.ElementaryType(name=m.Elementary.INT)),
            boolean("ready"),
        ]
        assert pou.sfc is not None
        for limit, position in enumerate(positions, 1):
            body = m.StBody(text=counting.format(limit, f"c{position}"))
            pou.sfc.transitions[position - 1].condition = m.BodyCondition(body=body, name="ready")
        for form in (Construction.AUTO, Construction.BITS):
            made = lowered(pou, form, profile)
            found = equivalent(pou, made.pou, profile, step_flags=made.step_flags, cap=400, runs=20)
            assert not found.different, str(found)


@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("construction", list(Construction))
def test_wires_from_steps_are_followed_before_transitions(construction: Construction, profile: str) -> None:
    pou = chain("S1>S2 S2>S1")
    assert pou.sfc is not None
    assert pou.interface is not None
    pou.interface.sections[1].variables.append(boolean("y"))
    pou.sfc.logic = [output(90, "y", (pou.sfc.step("S1").id, "x"))]
    assert verdict(pou, construction, profile).kind is VerdictKind.PROVEN


def test_reports_know_of_steps_that_are_left_and_entered_at_once() -> None:
    for text in ("S1>S1 S1>S2 S2>S1", "S1>S2+S3 S2>S2 S2+S3>S1"):
        pou = chain(text)
        assert pou.interface is not None
        pou.interface.sections[1].variables.append(boolean("SFCTrans"))
        found = verdict(pou, Construction.AUTO, "codesys")
        assert found.kind is VerdictKind.PROVEN, str(found)
        assert "SFCTrans" in found.compared


def test_a_name_cannot_end_the_comment_that_it_stands_in() -> None:
    pou = chain("S1>S2 S2>S1")
    assert pou.sfc is not None
    pou.sfc.steps[1].name = "Fill\nq := TRUE;"
    assert "    2: // Step Fill q := TRUE;\n" in text_of(lowered(pou))
    rules = LoweringRules(PROFILES["iec"], construction=Construction.FLIPFLOP, language=Language.ST)
    flipflops = construct(pou, pou.sfc, Dialect.IEC, rules)
    assert "\n// Step Fill q := TRUE;\n" in text_of(flipflops)


def test_what_is_not_built_of_parts_is_refused_and_becomes_bits() -> None:
    for text, initial, why in (
        ("S1>S2+S3 S2>S1 S3>S1", "S1", "connected with its outside"),
        ("S1>S2 S2>S1 S3>S1", "S1", "step S3 can never become active"),
        ("S1>S2 S2>S1", "S1+S2", "both initial"),
        ("S1>S2+S3 S2+S3>S4+S5 S4+S5>S1", "S1", "ends simultaneous branches and starts others"),
    ):
        pou = chain(text, initial)
        with pytest.raises(LoweringError, match=why):
            lowered(pou)
        made = lowered(pou, Construction.AUTO)
        if text != "S1>S2 S2>S1 S3>S1":  # one CASE holds steps that nothing leads to
            assert made.construction is Construction.BITS
            assert why in made.why


@pytest.mark.parametrize("states", ["numbers", "enumeration"])
@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_a_block_inside_a_macro_step_inside_a_branch(profile: str, states: str) -> None:
    inner = chart_of("E>A+B A>C B+C>X", "E")
    outer = chart_of("S1>M+S2 M>S3 S2>S4 S3+S4>S1", "S1")
    outer.step("M").macro = m.Macro(body=m.SfcBody(chart=inner))
    for number, transition in enumerate([*inner.transitions, *outer.transitions], 1):
        transition.condition = m.Expression(text=f"c{number}")
    act(outer, outer.step("M"), "q")
    act(inner, inner.step("C"), "r")
    pou = pou_with(outer)
    assert pou.interface is not None
    pou.interface.sections[0].variables = [boolean(f"c{number}") for number in range(1, 8)]
    pou.interface.sections[1].variables.append(boolean("r"))
    lowered = lower(pou, states=states, profile=profile)
    assert lowered.construction is Construction.REGIONS
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)
    if states == "enumeration":
        assert "    Ablauf_Step#M_X: // Step M.X\n" in text_of_pou(lowered.pou)


def test_what_is_chosen_can_hold_what_is_asked_for() -> None:
    several, single = chain(PARALLEL), chain("S1>S2 S2>S1")
    for pou in (several, single):
        drawn = lower(pou, language="FBD", verify=False)
        assert (drawn.construction, drawn.why) == (Construction.FLIPFLOP, "flip-flops are what FBD can hold")
        placed = lower(pou, flags="%MX20.0", verify=False)
        assert (placed.construction, placed.why) == (Construction.BITS, "there are to be step flags at %MX20.0")
    assert lower(several, modes=["select"]).construction is Construction.REGIONS
    assert lower(single, modes=["select"]).construction is Construction.CASE
    assert lower(single, style="classic", verify=False).construction is Construction.CASE
    classic = lower(several, style="classic", verify=False)
    assert classic.construction is Construction.FLIPFLOP
    assert classic.why.startswith("textbooks have flip-flops for it")


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_a_chart_that_ends_has_a_state_of_no_step(profile: str) -> None:
    pou = chain("S1>S2 S2>S1 S2>")
    made = lowered(pou, Construction.AUTO, profile)
    assert (made.construction, made.why) == (Construction.CASE, "at most one step is active at a time")
    assert verdict(pou, Construction.CASE, profile).kind is VerdictKind.PROVEN
    assert pou.sfc is not None
    rules = LoweringRules(PROFILES[profile], construction=Construction.CASE, style=Style.CLASSIC)
    with pytest.raises(LoweringError, match="end of a chart"):
        construct(pou, pou.sfc, Dialect.IEC, rules)


def test_the_most_readable_form_that_is_exact_says_why() -> None:
    made = lowered(chain("S1>S2 S2>S1"), Construction.AUTO)
    assert (made.construction, made.why) == (Construction.CASE, "exactly one step is active at a time")
    made = lowered(chain(PARALLEL), Construction.AUTO)
    assert made.construction is Construction.REGIONS
    assert "S1 -> S2+S10" in made.why


@pytest.mark.parametrize(
    ("second", "construction"),
    [("NOT a AND b", "case"), ("b", "bits"), ("NOT (a OR b)", "case"), ("t.Q AND NOT a", "case")],
)
def test_competing_conditions_that_exclude_each_other_keep_the_case(second: str, construction: str) -> None:
    """The compiler matiec lets competing transitions fire together; those of most charts cannot be TRUE at once."""
    pou = chain("S1>S2 S1>S3 S2>S1 S3>S1", conditions={1: "a", 2: second})
    assert pou.interface is not None
    pou.interface.sections[0].variables += [boolean("a"), boolean("b")]
    timer = m.Variable(name="t", type=m.DerivedType(name="TON"))
    pou.interface.sections.append(m.VariableSection(kind=m.SectionKind.LOCAL, variables=[timer]))
    made = lower(pou, profile="matiec", free_inputs="all")
    assert made.construction == construction
    assert made.proof is not None
    assert made.proof.kind is VerdictKind.PROVEN, str(made.proof)


def test_what_steps_do_is_in_a_case_also_where_a_condition_asks_for_it() -> None:
    """The CASE comes right behind what it takes: conditions that ask for it are executed before or behind both."""
    text = """PROGRAM Main
VAR_INPUT c : BOOL; END_VAR
VAR a, b : BOOL; END_VAR
INITIAL_STEP Wait: END_STEP
STEP Up: RaiseA(N); END_STEP
STEP Down: LowerA(N); END_STEP
STEP Go: RaiseB(N); END_STEP
STEP Stop: LowerB(N); END_STEP
TRANSITION FROM Wait TO (Up, Go) := c; END_TRANSITION
TRANSITION FROM Up TO Down := b; END_TRANSITION
TRANSITION FROM Go TO Stop := b; END_TRANSITION
TRANSITION FROM (Down, Stop) TO Wait := a AND NOT c; END_TRANSITION
ACTION RaiseA: a := TRUE; END_ACTION
ACTION LowerA: a := b; END_ACTION
ACTION RaiseB: b := TRUE; END_ACTION
ACTION LowerB: b := c; END_ACTION
END_PROGRAM
"""
    lowered = lower(loads(text.encode(), format="iec-text"), Construction.REGIONS, profile="matiec")
    assert isinstance(lowered.pou.body, m.StBody)
    begin = lowered.pou.body.text.index("// Actions of the active steps from Up")
    assert lowered.pou.body.text[begin:].rstrip() == (
        """// Actions of the active steps from Up
CASE step_number_Up OF
    2: // Step Up
        // Action RaiseA
        a := TRUE;
    3: // Step Down
        // Action LowerA
        a := b;
END_CASE;

// Actions of the active steps from Go
CASE step_number_Go OF
    4: // Step Go
        // Action RaiseB
        b := TRUE;
    5: // Step Stop
        // Action LowerB
        b := c;
END_CASE;"""
    )
    assert lowered.proof is not None
    assert lowered.proof.proven
