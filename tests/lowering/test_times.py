"""Times of actions: variables, and several for one qualifier."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.semantics.inputs import RandomInputs
from tests.lowering.charts import act, boolean, pou_with
from tests.lowering.test_exact import FORMS, verdict

MS = 1_000_000
TIMED = [m.Qualifier(name) for name in ("L", "D", "SD", "DS", "SL")]


def two_times(qualifier: m.Qualifier, first: str, second: str) -> m.Pou:
    """Two neighbours with the same action for different times, then a step that resets it."""
    chart = m.SfcNetwork()
    a, b, c = (chart.add_step(name, initial=name == "A") for name in "ABC")
    for number, (source, target) in enumerate([(a, b), (b, c), (c, a)], 1):
        chart.add_transition(source, target, f"c{number}")
    act(chart, a, "Q", qualifier, duration=first)
    act(chart, b, "Q", qualifier, duration=second)
    act(chart, c, "Q", m.Qualifier.R)
    pou = pou_with(chart)
    assert pou.interface is not None
    kind = m.ElementaryType(name=m.Elementary.TIME)
    inner = m.VariableSection(kind=m.SectionKind.LOCAL)
    inner.variables = [m.Variable(name="Long", type=kind, initial=m.SimpleValue(text="T#30ms")), boolean("unused")]
    pou.interface.sections.append(inner)
    return pou


@pytest.mark.parametrize("qualifier", TIMED)
@pytest.mark.parametrize(("first", "second"), [("T#10ms", "T#20ms"), ("T#20ms", "T#10ms"), ("Long", "Long")])
def test_times_of_neighbours(qualifier: m.Qualifier, first: str, second: str) -> None:
    for construction, language in FORMS[1::2]:
        found = verdict(two_times(qualifier, first, second), construction, language, "iec")
        assert not found.different, f"{construction} {language}: {found}"


@pytest.mark.parametrize("qualifier", TIMED)
def test_a_time_that_changes_meanwhile(qualifier: m.Qualifier) -> None:
    pou = two_times(qualifier, "Long", "Long")
    chart = pou.sfc
    assert chart is not None
    chart.steps[0].main_action = m.StBody(text="IF c2 THEN Long := T#10ms; ELSE Long := T#20ms; END_IF;")
    for construction, language in FORMS[::3]:
        found = verdict(pou, construction, language, "codesys")
        assert not found.different, f"{construction} {language}: {found}"


CHANGING = """PROGRAM Main
VAR_INPUT go : BOOL; time : TIME; END_VAR
VAR_OUTPUT q, p : BOOL; END_VAR
INITIAL_STEP A: {first} END_STEP
TRANSITION FROM A TO B := {condition}; END_TRANSITION
STEP B: {second} END_STEP
TRANSITION FROM B TO A := go; END_TRANSITION
END_PROGRAM"""


@pytest.mark.slow
@pytest.mark.parametrize(("construction", "language"), [("flipflop", "FBD"), ("flipflop", "LD"), ("case", "ST")])
@pytest.mark.parametrize(
    ("profile", "parts"),
    [
        ("iec", {"condition": "A.t >= time OR go"}),
        ("iec", {"first": "q(D, time); p(L, time);"}),
        ("iec", {"first": "q(R);", "second": "q(SD, time); p(DS, time);"}),
        ("matiec", {"first": "q(R);", "second": "q(SD, time);"}),
        ("matiec", {"first": "q(SD, time);", "second": "q(R);"}),
        ("codesys", {"first": "q(N);", "second": "p(N);"}),
    ],
    ids=str,
)
def test_a_time_that_changes_while_it_runs(
    profile: str, parts: dict[str, str], construction: str, language: str
) -> None:
    text = CHANGING.format(**{"first": "", "condition": "go", "second": "q(N);"} | parts)
    project = sfc.loads(text.encode(), format="iec-text")
    chart = project.pou("Main").sfc
    assert chart is not None
    if profile == "codesys":
        chart.step("A").min_time = chart.step("B").min_time = "time"
    code = sfc.lower(project, construction, language=language, profile=profile, verify=False).project
    for seed in range(8):
        run = RandomInputs(seed, hold=(1, 5), ranges={"time": (0, 80 * MS)})
        first, second = (
            sfc.simulate(each, pou="Main", inputs=run, scans=120, profile=profile, record=["q", "p"])
            for each in (project, code)
        )
        for name in ("q", "p"):
            assert list(first[name]) == list(second[name]), f"{name}, seed {seed}"


SHARED = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR q : BOOL; END_VAR
INITIAL_STEP S0: Act(N); END_STEP
TRANSITION FROM S0 TO S1 := a; END_TRANSITION
STEP S1: q({qualifier}, T#50ms); END_STEP
TRANSITION FROM S1 TO S2 := b; END_TRANSITION
STEP S2: q(N); END_STEP
TRANSITION FROM S2 TO S0 := a; END_TRANSITION
ACTION Act: q := b; END_ACTION
END_FUNCTION_BLOCK"""


@pytest.mark.parametrize("qualifier", ["SL", "SD", "DS"])
def test_a_stored_time_of_an_output_that_others_write_too(qualifier: str) -> None:
    """Code for matiec calls the timer twice in a scan: what it put out the first time is another value."""
    project = sfc.loads(SHARED.format(qualifier=qualifier).encode(), format="iec-text")
    assert sfc.lower(project.pou("Main"), "bits", profile="matiec").proof.proven
